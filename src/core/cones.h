/* core/cones.h: bounds of surfaces and of lights (a sphere and a cone of directions), and how strongly the lights of
 * one bound could shine on the surfaces of another: what choosing lights by the group goes by. */
#ifndef CORE_CONES_H
#define CORE_CONES_H

#include "core/dialect.h"

/* Points within `radius` of c, with normals within a cone around axis. spread: the sine of its half angle; 2 where that
 * is a right angle or more. Used for receivers and for lights. */
struct cone_bound {
    v3 c;
    real radius;
    v3 axis;
    real spread;
};

/* One bound as seen from another. slope, facing: upper bounds of the cosines at the receivers and at the lights; below
 * 0 only if none of the lights can reach any of the receivers. d: towards the lights, of length 1 where the spheres are
 * apart. */
struct cone_view {
    v3 d;
    real inv2; /* 1 / squared distance of the centres, or of spheres that touch, whichever is less */
    real slope;
    real facing;
};

#ifndef CORE_GLSL
typedef struct cone_bound cone_bound;
typedef struct cone_view cone_view;
#endif

/* cos(angle - a - b) <= cos(angle) + sin(a) + sin(b), and the two change sign together or the right side later: so no
 * roots but one, and what is looked at most, lights that are small and far for their distance, loses nothing. */
FN cone_view cone_between(cone_bound receivers, cone_bound lights) {
    cone_view w;
    v3 d = sub3(lights.c, receivers.c);
    real size = receivers.radius + lights.radius;
    real inv = K(1.0f) / sqrt_(max_(max_(dot3(d, d), size * size), K(1e-6f)));
    real reach = size * inv;
    w.d = mul3(d, inv);
    w.inv2 = inv * inv;
    w.slope = dot3(receivers.axis, w.d) + (reach + receivers.spread);
    w.facing = (reach + lights.spread) - dot3(lights.axis, w.d);
    return w;
}

/* A bound of cosines as part of a score: it may be loose, but must not be far too small. */
FN real cone_cosine(real bound) { return min_(max_(bound, K(0.05f)), K(1.0f)); }

/* Illuminance (lux) of the receivers by a candela of the lights, about: 0 only if none of them can reach any. */
FN real cone_score(cone_view w) {
    mask never = or_(w.slope < K(-1e-3f), w.facing < K(-1e-3f));
    return sel(never, K(0.0f), cone_cosine(w.slope) * cone_cosine(w.facing) * w.inv2);
}

#endif
