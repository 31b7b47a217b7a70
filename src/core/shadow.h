/* core/shadow.h: the segment between a surface and a sample of a light that nothing may block.
 *
 * Both ends stand off their surfaces, along the normals, by a distance that follows the coordinates' precision: 4 * 2^-23 of
 * the largest coordinate (4 to 8 units in the last place: rounding of the point itself, of the vertices and of the traversal
 * each take about one), never under 0.1 mm. A window 1 cm off its wall is told apart from it up to 20 km from the origin. */
#ifndef CORE_SHADOW_H
#define CORE_SHADOW_H

#include "core/surface.h"

struct segment {
    v3 o; /* beginning */
    v3 d; /* end - beginning */
};

#ifndef CORE_GLSL
typedef struct segment segment;
#endif

FN real max_abs3(v3 a) { return max_(abs_(a.x), max_(abs_(a.y), abs_(a.z))); }

/* How far to stand off a surface where coordinates are as large as that, m. */
FN real stand_off(real largest) { return max_(K(1e-4f), largest * K(4.76837158203125e-7f)); }

/* n: unit normal of the receiving surface at p, on the side that is lit. */
FN segment shadow_segment(v3 p, v3 n, light l, real u, real v) {
    light_sample s = sample_light(l, p, u, v);
    v3 x = add3(p, mul3(s.wi, s.dist));
    mask point = l.kind == KU(LIGHT_POINT);
    mask round = l.kind == KU(LIGHT_SPHERE);
    v3 m = sel3(round, sub3(x, l.p), cross3(l.a, l.b));
    real m2 = dot3(m, m);
    real side = sel(dot3(m, s.wi) > K(0.0f), K(-1.0f), K(1.0f));
    real inv = side / sqrt_(max_(m2, K(1e-30f)));
    real eps = stand_off(max_(max_abs3(p), max_abs3(x)));
    v3 end = add3(x, mul3(m, sel(point, K(0.0f), inv * eps)));
    segment r;
    r.o = add3(p, mul3(n, eps));
    r.d = sub3(end, r.o);
    return r;
}

#endif
