/* core/cones.h: bounds of surfaces and of lights (a sphere and a cone of directions), and how strongly the lights of one bound
 * could shine on the surfaces of another: what choosing lights by the group goes by. */
#ifndef CORE_CONES_H
#define CORE_CONES_H

#include "core/dialect.h"

/* Points p within `radius` of c, with normals within the cone (cosine and sine of its half angle) around axis. Used for
 * receivers and for lights. */
struct cone_bound {
    v3 c;
    real radius;
    v3 axis;
    real cos_cone;
    real sin_cone;
};

#ifndef CORE_GLSL
typedef struct cone_bound cone_bound;
#endif

/* cos(max(0, a - b)) from the cosines and sines of angles in [0, pi]. */
FN real cos_less(real cos_a, real sin_a, real cos_b, real sin_b) {
    EXACT real c = cos_a * cos_b + sin_a * sin_b;
    return sel(cos_a >= cos_b, K(1.0f), c);
}

FN real sin_of(real c) { return sqrt_(max_(K(1.0f) - c * c, K(0.0f))); }

/* Upper bound of the cosine between a normal of the bound and the direction to any point within `reach` (its sine and
 * cosine as an angle) of direction d. */
FN real cosine_bound(cone_bound b, v3 d, real cos_reach, real sin_reach) {
    real c = dot3(b.axis, d);
    c = cos_less(c, sin_of(c), b.cos_cone, b.sin_cone);
    return cos_less(c, sin_of(c), cos_reach, sin_reach);
}

/* Illuminance (lux) that the lights, of `power` candela in all, could give the receivers: 0 only if none of them can reach
 * any. The bound is loose where both spheres are close; the cosines have floors, for it must not be far too small. */
FN real cluster_score(cone_bound receivers, cone_bound lights, real power) {
    v3 d = sub3(lights.c, receivers.c);
    real d2 = dot3(d, d);
    real size = receivers.radius + lights.radius;
    real size2 = size * size;
    mask apart = d2 > size2 * K(1.0001f);
    real inv = K(1.0f) / sqrt_(max_(d2, K(1e-20f)));
    d = mul3(d, inv);
    real sin_reach = min_(size * inv, K(1.0f));
    real cos_reach = sin_of(sin_reach);
    real r = cosine_bound(receivers, d, cos_reach, sin_reach);
    real e = cosine_bound(lights, mul3(d, K(-1.0f)), cos_reach, sin_reach);
    mask never = and_(apart, or_(r < K(-1e-3f), e < K(-1e-3f)));
    r = sel(apart, max_(r, K(0.05f)), K(1.0f));
    e = sel(apart, max_(e, K(0.05f)), K(1.0f));
    real score = min_(power * r * e / max_(max_(d2, size2), K(1e-6f)), K(1e30f));
    return sel(never, K(0.0f), score);
}

#endif
