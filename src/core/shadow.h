/* core/shadow.h: the segment between a surface and a sample of a light that nothing may block.
 *
 * Both ends stand off their surfaces, along the normals, by a distance that follows the coordinates' precision: 4 *
 * 2^-23 of the largest coordinate (4 to 8 units in the last place: rounding of the point itself, of the vertices and of
 * the traversal each take about one), never under `least`, which is 0.1 mm in a city and less in scenes of a few metres
 * and below. A window 1 cm off its wall is told apart from it up to 20 km from the origin. A point has no normal, and
 * may lie in a surface: its end stands off towards the receiver, eight times as far, for the surface may be seen at a
 * slant. A sphere's end lies before its shape (scene/light.c), which reaches out a little further than the sphere.
 *
 * The distribution of a light with a profile was measured with its housing, so that its own body must not block it once
 * more: the end lies before the ball of LIGHT_BODY radii around its centre, which holds a lamp's head (city/lamp.c). */
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

/* A sphere's shape lies within so many radii. */
#define LIGHT_SPHERE_SHAPE 1.04f
#define LIGHT_SPHERE_BEYOND 0.0816f /* its square less 1; readers need not fold constants alike */

/* The body of a light with a profile lies within so many radii of its centre. */
#define LIGHT_BODY 2.5f

/* How far to stand off a surface where coordinates are as large as that, m. */
FN real ray_offset(real largest, real least) { return max_(least, largest * K(4.76837158203125e-7f)); }

/* n: unit normal of the receiving surface at p, on the side that is lit. s: a sample of the light as seen from p. */
FN segment segment_to(v3 p, v3 n, light l, light_sample s, real least) {
    v3 x = add3(p, mul3(s.wi, s.dist));
    mask point = is_point(l);
    mask round = l.kind == KU(LIGHT_SPHERE);
    v3 m = cross3(l.a, l.b);
    real m2 = dot3(m, m);
    real side = sel(dot3(m, s.wi) > K(0.0f), K(-1.0f), K(1.0f));
    real inv = side / sqrt_(max_(m2, K(1e-30f)));
    real eps = ray_offset(max_(max_abs3(p), max_abs3(x)), least);
    v3 end = add3(x, mul3(m, inv * eps));
    mask housed = and_((l.flags & KU(LIGHT_PROFILE_BITS)) != KU(0u), not_(point));
    mask bodiless = or_(or_(point, round), housed);
    if (ANY(bodiless)) { /* back along the ray: to the ball around the shape, or around the body */
        EXACT real rx = p.x + s.wi.x * s.dist - l.p.x;
        EXACT real ry = p.y + s.wi.y * s.dist - l.p.y;
        EXACT real rz = p.z + s.wi.z * s.dist - l.p.z;
        real toward = K(0.0f) - dot3(V3(rx, ry, rz), s.wi);
        toward = sel(housed, toward, max_(toward, K(0.0f)));
        real reach = l.radius * K(LIGHT_BODY);
        EXACT real off2 = rx * rx + ry * ry + rz * rz;
        EXACT real to_body = reach * reach - off2;
        real beyond = sel(housed, to_body, l.radius * l.radius * K(LIGHT_SPHERE_BEYOND));
        EXACT real to_ball2 = toward * toward + beyond;
        EXACT real back = sqrt_(max_(to_ball2, K(0.0f))) - toward + eps;
        back = sel(point, K(8.0f) * eps, back);
        EXACT real way = s.dist - back;
        way = max_(way, sel(housed, K(2.0f) * eps, K(0.0f))); /* from within the body, a way above the surface */
        EXACT real ex = p.x + s.wi.x * way;
        EXACT real ey = p.y + s.wi.y * way;
        EXACT real ez = p.z + s.wi.z * way;
        end = sel3(bodiless, V3(ex, ey, ez), end);
    }
    segment r;
    EXACT real ox = p.x + n.x * eps;
    EXACT real oy = p.y + n.y * eps;
    EXACT real oz = p.z + n.z * eps;
    EXACT real dx = end.x - ox;
    EXACT real dy = end.y - oy;
    EXACT real dz = end.z - oz;
    r.o = V3(ox, oy, oz);
    r.d = V3(dx, dy, dz);
    return r;
}

FN segment shadow_segment(v3 p, v3 n, light l, real u, real v, real least) {
    return segment_to(p, n, l, sample_light(l, p, u, v), least);
}

#endif
