/* core/fan.h: places on a parallelogram or triangle, uniform in the solid angle that it covers.
 *
 * A parallelogram is two spherical triangles that share a corner B, a triangle is one. u sweeps an arc from B over
 * them, with an even share of the solid angle behind it (Arvo 1995, "Stratified sampling of spherical triangles"); v
 * goes along the arc, evenly in the cosine of the angle from B. For the triangle A, B, C of unit vectors, with D =
 * det(A, B, C),
 *
 *     tan(E / 2) = D / (1 + A.B + B.C + A.C)            (Van Oosterom and Strackee 1983),
 *
 * and the same of A, B and a point C' of the side A C says where C' is that cuts off the solid angle E: it is A
 * mirrored at
 *
 *     M = (D cos(E / 2) - (A.C + B.C) sin(E / 2)) A + (1 + A.B) sin(E / 2) C.
 *
 * So no angle is a difference of others, and small and thin triangles lose no digits; D comes from the height over the
 * plane. The place is a mean of the corners with weights that are not negative: it always lies on the light. */
#ifndef CORE_FAN_H
#define CORE_FAN_H

#include "core/warp.h"

struct fan {
    v3 d;   /* from the receiver to the place */
    real s; /* the place is q + s a + t b */
    real t;
    real angle; /* solid angle of the whole, sr */
};

#ifndef CORE_GLSL
typedef struct fan fan;
#endif

FN real inverse_length(v3 a) {
    EXACT real inv = K(1.0f) / sqrt_(max_(dot3(a, a), K(1e-20f)));
    return inv;
}

/* The corners q, q + a, q + a + b, q + b where `whole`, else the triangle q, q + a, q + b; the receiver lies at 0, the
 * volume is that of q, a and b and not negative. */
FN fan sample_fan(v3 q, v3 a, v3 b, mask whole, real volume, real u, real v) {
    fan r;
    v3 first = add3(q, a);
    v3 last = add3(q, b);
    v3 middle = sel3(whole, add3(first, b), last);
    real i_q = inverse_length(q);
    real i_first = inverse_length(first);
    real i_middle = inverse_length(middle);
    real i_last = inverse_length(last);
    v3 apex = mul3(q, i_q);
    v3 n_first = mul3(first, i_first);
    v3 n_middle = mul3(middle, i_middle);
    v3 n_last = mul3(last, i_last);
    real c_first = dot3(apex, n_first);
    real c_middle = dot3(apex, n_middle);
    real c_last = dot3(apex, n_last);
    real c_one = dot3(n_first, n_middle);
    real c_two = dot3(n_middle, n_last);
    EXACT real base = volume * i_q * i_middle;
    EXACT real d_one = base * i_first;
    EXACT real d_two = sel(whole, base * i_last, K(0.0f));
    real h_one = turn_of(K(1.0f) + c_first + (c_middle + c_one), d_one); /* half of the solid angle */
    real h_two = sel(whole, turn_of(K(1.0f) + c_middle + (c_last + c_two), d_two), K(0.0f));
    EXACT real swept = u * (h_one + h_two);
    mask one = or_(swept <= h_one, not_(whole));
    v3 from = sel3(one, n_first, n_middle);
    v3 to = sel3(one, n_middle, n_last);
    real c_from = sel(one, c_first, c_middle);
    real c_to = sel(one, c_middle, c_last);
    real c_side = sel(one, c_one, c_two);
    real det = sel(one, d_one, d_two);
    v3 half_angle = circle(min_(max_(sel(one, swept, swept - h_one), K(0.0f)), K(0.5f)));
    EXACT real m_from = det * half_angle.x - (c_side + c_to) * half_angle.y;
    EXACT real m_to = (K(1.0f) + c_from) * half_angle.y;
    m_from = max_(m_from, K(0.0f));
    m_to = max_(m_to, K(0.0f));
    EXACT real m2 = m_from * m_from + m_to * m_to + K(2.0f) * m_from * m_to * c_side;
    m2 = max_(m2, K(1e-30f));
    EXACT real k = K(2.0f) * (m_from + m_to * c_side) / m2;
    EXACT real w_from = k * m_from - K(1.0f);
    EXACT real w_to = k * m_to;
    w_from = max_(w_from, K(0.0f));
    w_to = max_(w_to, K(0.0f));
    v3 end = add3(mul3(from, w_from), mul3(to, w_to));
    v3 sum = add3(apex, end);
    v3 gap = sub3(apex, end);
    real far = max_(dot3(sum, sum) * K(0.5f), K(1e-20f)); /* 1 + cosine and 1 - cosine of the arc */
    real near = dot3(gap, gap) * K(0.5f);
    real c_end = sel(near < far, K(1.0f) - near, far - K(1.0f));
    EXACT real along = v * near;
    EXACT real share = v * (K(2.0f) - along) / far;
    real t = sqrt_(max_(share, K(0.0f)));
    EXACT real w_apex = (K(1.0f) - along) - t * c_end;
    EXACT real p_apex = max_(w_apex, K(0.0f)) * i_q;
    EXACT real p_from = w_from * t * sel(one, i_first, i_middle);
    EXACT real p_to = w_to * t * sel(one, i_middle, i_last);
    EXACT real scale = K(1.0f) / max_(p_apex + p_from + p_to, K(1e-30f));
    EXACT real at_from = p_from * scale;
    EXACT real at_to = p_to * scale;
    r.s = at_from + sel(and_(one, whole), at_to, K(0.0f));
    r.t = at_to + sel(one, K(0.0f), at_from);
    EXACT real x = q.x + (a.x * r.s + b.x * r.t);
    EXACT real y = q.y + (a.y * r.s + b.y * r.t);
    EXACT real z = q.z + (a.z * r.s + b.z * r.t);
    r.d = V3(x, y, z);
    EXACT real angle = (h_one + h_two) * K(4.0f * CORE_PI);
    r.angle = angle;
    return r;
}

#endif
