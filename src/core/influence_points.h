/* core/influence_points.h: points of surfaces that ask the influence volumes as one: which do, and the query that they
 * make. */
#ifndef CORE_INFLUENCE_POINTS_H
#define CORE_INFLUENCE_POINTS_H

#include "core/influence.h"

#define INFLUENCE_CLOSE 0.125f /* points are close that are within so much of the reach of the median light */
#define INFLUENCE_TILE 16384u  /* volumes that a tile looks through at most; more, and each group looks for its own */
#define NEAR_SAME_NORMAL 1e-5f /* normals that differ by so much in each coordinate count as one */
#define NEAR_NO_LIMIT 0xffffffffu /* of volumes */
#define NEAR_INFINITY 0x7f800000u /* bits */

/* Points that look together: the box around them, the normal that they all have (0: not the same), and their least
 * dot(n, point) (where n = 0: -infinity). */
struct near_query {
    f3 lo;
    f3 hi;
    f3 n;
    f1 back;
    f1 scale; /* S_r */
    f1 least; /* lights that give less lux there are left out; 0: none */
    u1 most;  /* stops at more volumes than that */
};

#ifndef CORE_GLSL
typedef struct near_query near_query;
#endif

FN influence_region near_region(near_query q) {
    return influence_box(spread3(q.lo), spread3(q.hi), spread3(q.n), K(q.back));
}

/* Of no point yet. */
FN1 near_query near_none(f1 scale, f1 least, u1 most) {
    f1 far = f1_of_bits(NEAR_INFINITY);
    near_query q;
    q.lo = F3(far, far, far);
    q.hi = F3(-far, -far, -far);
    q.n = F3(0.0f, 0.0f, 0.0f);
    q.back = far;
    q.scale = scale;
    q.least = least;
    q.most = most;
    return q;
}

/* The query of a point that asks, with the S_r that was set, or the one that was found for the scene (fixed 0): lights
 * that give less than at the edge of their volumes are left out then. */
FN1 near_query near_asks(f1 fixed_scale, f1 found_scale) {
    f1 scale = found_scale;
    EXACT f1 least = 1.0f / (found_scale * found_scale);
    if (fixed_scale > 0.0f) {
        scale = fixed_scale;
        least = 0.0f;
    }
    return near_none(scale, least, NEAR_NO_LIMIT);
}

FN1 b1 near_same(f1 a, f1 b) { return max1(a - b, b - a) <= NEAR_SAME_NORMAL; }

/* With a point p more, on a surface of normal n. */
FN1 near_query near_add_point(near_query q, f3 p, f3 n) {
    if (q.lo.x > q.hi.x)
        q.n = n;
    b1 same = near_same(q.n.x, n.x) && near_same(q.n.y, n.y) && near_same(q.n.z, n.z);
    q.lo = F3(min1(q.lo.x, p.x), min1(q.lo.y, p.y), min1(q.lo.z, p.z));
    q.hi = F3(max1(q.hi.x, p.x), max1(q.hi.y, p.y), max1(q.hi.z, p.z));
    if (!same) {
        q.n = F3(0.0f, 0.0f, 0.0f);
        q.back = -f1_of_bits(NEAR_INFINITY);
    }
    q.back = min1(q.back, dot1(q.n, p));
    return q;
}

/* With the box of b; the normal is nobody's. */
FN1 near_query near_join(near_query q, near_query b) {
    q.lo = F3(min1(q.lo.x, b.lo.x), min1(q.lo.y, b.lo.y), min1(q.lo.z, b.lo.z));
    q.hi = F3(max1(q.hi.x, b.hi.x), max1(q.hi.y, b.hi.y), max1(q.hi.z, b.hi.z));
    q.back = -f1_of_bits(NEAR_INFINITY);
    return q;
}

/* Do points at q of normals m ask with the one at p of normal n: are they close, and face about the same way? */
FN mask points_close(v3 p, v3 n, v3 q, v3 m, f1 close) {
    v3 d = sub3(q, p);
    return and_(dot3(d, d) <= K(close * close), dot3(n, m) > K(0.9f));
}

#endif
