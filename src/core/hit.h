/* core/hit.h: the point where a ray meets a triangle, and the triangle's normal there.
 *
 * o + t d is off by the precision of t. The point of given barycentric coordinates lies in the triangle's plane, to
 * half a unit in the last place of its own coordinates however large the triangle is, where sums and products keep what
 * rounding takes from them: they are pairs of numbers that stand for their sum (Dekker 1971, "A Floating-Point
 * Technique for Extending the Available Precision"; Knuth, "The Art of Computer Programming", volume 2, 4.2.2). */
#ifndef CORE_HIT_H
#define CORE_HIT_H

#include "core/dialect.h"

struct twofold {
    real high; /* the rounded value */
    real low;  /* what it lacks */
};

struct corners {
    v3 a;
    v3 b;
    v3 c;
};

#ifndef CORE_GLSL
typedef struct twofold twofold;
typedef struct corners corners;
#endif

FN twofold exact_sum(real a, real b) {
    twofold s;
    EXACT real high = a + b;
    EXACT real of_b = high - a;
    EXACT real of_a = high - of_b;
    EXACT real low = (a - of_a) + (b - of_b);
    s.high = high;
    s.low = low;
    return s;
}

/* The upper half of a number's digits. |a| < 2^115. */
FN real upper_digits(real a) {
    EXACT real scaled = a * K(4097.0f);
    EXACT real rest = scaled - a;
    EXACT real high = scaled - rest;
    return high;
}

FN twofold exact_product(real a, real b) {
    twofold s;
    EXACT real high = a * b;
    real ah = upper_digits(a);
    real bh = upper_digits(b);
    EXACT real al = a - ah;
    EXACT real bl = b - bh;
    EXACT real low = ((ah * bh - high) + ah * bl + al * bh) + al * bl;
    s.high = high;
    s.low = low;
    return s;
}

/* One coordinate of a + u (b - a) + v (c - a). */
FN real hit_coordinate(real a, real b, real c, real u, real v) {
    twofold e = exact_sum(b, K(0.0f) - a);
    twofold f = exact_sum(c, K(0.0f) - a);
    twofold ue = exact_product(u, e.high);
    twofold vf = exact_product(v, f.high);
    twofold s = exact_sum(ue.high, vf.high);
    twofold p = exact_sum(a, s.high);
    EXACT real low = ((ue.low + vf.low) + (u * e.low + v * f.low)) + (s.low + p.low);
    EXACT real sum = p.high + low;
    return sum;
}

FN v3 hit_point(corners t, real u, real v) {
    return V3(hit_coordinate(t.a.x, t.b.x, t.c.x, u, v), hit_coordinate(t.a.y, t.b.y, t.c.y, u, v),
              hit_coordinate(t.a.z, t.b.z, t.c.z, u, v));
}

/* a d - b c, where the two products may be all but equal. */
FN real twofold_difference(twofold a, twofold d, twofold b, twofold c) {
    twofold p = exact_product(a.high, d.high);
    twofold q = exact_product(b.high, c.high);
    twofold s = exact_sum(p.high, K(0.0f) - q.high);
    EXACT real lost = (a.low * d.high + a.high * d.low) - (b.low * c.high + b.high * c.low);
    EXACT real low = ((p.low - q.low) + s.low) + lost;
    EXACT real sum = s.high + low;
    return sum;
}

/* Unit normal of the side from which the corners are seen counter-clockwise. Thin triangles have one as good as
 * others'.
 */
FN v3 hit_normal(corners t) {
    twofold ex = exact_sum(t.b.x, K(0.0f) - t.a.x);
    twofold ey = exact_sum(t.b.y, K(0.0f) - t.a.y);
    twofold ez = exact_sum(t.b.z, K(0.0f) - t.a.z);
    twofold fx = exact_sum(t.c.x, K(0.0f) - t.a.x);
    twofold fy = exact_sum(t.c.y, K(0.0f) - t.a.y);
    twofold fz = exact_sum(t.c.z, K(0.0f) - t.a.z);
    v3 n =
        V3(twofold_difference(ey, fz, ez, fy), twofold_difference(ez, fx, ex, fz), twofold_difference(ex, fy, ey, fx));
    real most = max_(abs_(n.x), max_(abs_(n.y), abs_(n.z))); /* squares of what is small or large do not fit */
    EXACT real scale = K(1.0f) / max_(most, K(1e-37f));
    n = mul3(n, scale);
    EXACT real inv = K(1.0f) / sqrt_(max_(dot3(n, n), K(1e-37f)));
    return mul3(n, inv);
}

#endif
