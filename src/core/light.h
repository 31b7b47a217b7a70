/* core/light.h: the kinds of light, each a map from the unit square to what a receiving point gets.
 *
 * A sample is (light, u, v), u and v in the unit square. light_sample returns the direction and distance to the point
 * that (u, v) stands for as seen from y, and `le`: radiance times the Jacobian of that map, so that the light's
 * contribution to reflected radiance is the integral over the unit square of f_r * cos(theta_y) * le * V. For flat
 * lights the map is uniform in area from afar (le = L cos(theta_l) A / d^2) and in solid angle from close by (le = L *
 * angle, core/fan.h); which one is a matter of the receiver and the light alone, never of (u, v). For spheres it is
 * uniform in the solid angle of the visible cone (le = L * angle; Shirley, Wang and Zimmerman 1996, section 3.2): so
 * nothing makes 1 / d^2 spikes but points and spots, for which it is constant (le = I / d^2). Emission is one-sided
 * unless flagged.
 *
 * A spot is a point whose intensity is I f^2, f = clamp(s cos(t) + o, 0, 1), at an angle t from its axis: I within the
 * inner cone, 0 beyond the outer one (KHR_lights_punctual, "Inner and Outer Cone Angles").
 *
 * Points, spheres and discs may have a profile (core/profile.h): `e` is then their flux in lumens. shining_sample gives
 * a sample with it: le = e I / d^2, with I in cd/lm towards y. A disc is sampled by its area at any distance, and I and
 * d are those of the place on it: no cosine is divided by, for intensity is what was measured, not radiance. A sphere
 * is sampled as ever, and I and d are those of its centre. So the shape softens shadows, and the light's flux is that
 * of the profile. Seen itself, its shape is as bright as a Lambertian one of that flux. */
#ifndef CORE_LIGHT_H
#define CORE_LIGHT_H

#include "core/fan.h"
#include "core/profile.h"
#include "core/records.h"

/* Flat lights are sampled by solid angle where p is nearer than so many times `radius`; discs, which lose a fifth of
 * their samples by it, nearer than so many. */
#define LIGHT_CLOSE 2.0f
#define LIGHT_CLOSE_DISC 1.5f

struct light {
    v3 p; /* centre or corner */
    u32 kind;
    v3 a;        /* edge u; disc: first radius vector; spot: its axis, s long */
    real radius; /* triangle, parallelogram: the longest way between two corners */
    v3 b;        /* edge v; disc: second radius vector; faces a x b; spot: o, then both angles, which only C reads */
    u32 flags;
    v3 e; /* radiance, cd/m2; point: intensity, cd; spot: its greatest; with a profile: flux, lm */
    real area;
};

struct light_sample {
    v3 wi;     /* unit, from y towards the light */
    real dist; /* m */
    v3 le;     /* 0 where the light cannot reach y */
};

#ifndef CORE_GLSL
typedef struct light light;
typedef struct light_sample light_sample;
#endif

#if !defined(CORE_GLSL) && !defined(CORE_LANES)
#define LIGHT_FIELD(field) (offsetof(struct light, field) == offsetof(struct light_record, field))
_Static_assert(sizeof(struct light) == sizeof(struct light_record) && LIGHT_FIELD(kind) && LIGHT_FIELD(a) &&
                   LIGHT_FIELD(radius) && LIGHT_FIELD(b) && LIGHT_FIELD(flags) && LIGHT_FIELD(e) && LIGHT_FIELD(area),
               "a scalar light is its record");
#endif

/* From memory, the same light in every lane. */
FN light light_of_record(light_record r) {
    light l;
    l.p = splat3(r.p);
    l.kind = KU(r.kind);
    l.a = splat3(r.a);
    l.radius = K(r.radius);
    l.b = splat3(r.b);
    l.flags = KU(r.flags);
    l.e = splat3(r.e);
    l.area = K(r.area);
    return l;
}

/* A place without extent, that no shape shows. */
FN mask is_point(light l) { return l.kind >= KU(LIGHT_POINT); }

FN u32 profile_of(light l) { return shr(l.flags & KU(LIGHT_PROFILE_BITS), LIGHT_PROFILE); }

FN light_sample sample_round(light l, v3 y, real u, real v) {
    light_sample s;
    v3 w = sub3(l.p, y);
    EXACT real d2 = dot3(w, w);
    real r2 = l.radius * l.radius;
    mask outside = d2 > r2 * K(1.000001f);
    real inv = K(1.0f) / sqrt_(max_(d2, K(1e-20f)));
    v3 axis = mul3(w, inv);
    real sin2 = sel(outside, r2 / max_(d2, K(1e-20f)), K(0.0f));
    real cos_max = sqrt_(max_(K(1.0f) - sin2, K(0.0f)));
    EXACT real cap = sin2 / (K(1.0f) + cos_max); /* 1 - cos_max without cancellation */
    EXACT real k = u * cap;                      /* 1 - cos(theta) */
    EXACT real st2 = k * (K(2.0f) - k);
    real st = sqrt_(max_(st2, K(0.0f)));
    v3 cs = circle(v);
    s.wi = around(axis, st * cs.x, st * cs.y, K(1.0f) - k);
    EXACT real h2 = r2 - d2 * st2;
    EXACT real t = (K(1.0f) - k) * (d2 * inv) - sqrt_(max_(h2, K(0.0f)));
    s.dist = t;
    real angle = K(2.0f * CORE_PI) * cap;
    s.le = mul3(l.e, sel(outside, angle, K(0.0f)));
    return s;
}

/* A flat light from close by. A disc is what lies in it of the square around it: a fifth of the places give nothing. */
FN light_sample sample_close(light l, v3 y, real u, real v) {
    light_sample s;
    mask disc = l.kind == KU(LIGHT_DISC);
    v3 q = sub3(l.p, y);
    v3 a = sel3(disc, mul3(l.a, K(2.0f)), l.a);
    v3 b = sel3(disc, mul3(l.b, K(2.0f)), l.b);
    real volume = K(0.0f) - dot3(cross3(a, b), q);
    EXACT real qx = q.x - (l.a.x + l.b.x);
    EXACT real qy = q.y - (l.a.y + l.b.y);
    EXACT real qz = q.z - (l.a.z + l.b.z);
    q = sel3(disc, V3(qx, qy, qz), q);
    mask lit = or_(volume > K(0.0f), (l.flags & KU(LIGHT_TWO_SIDED)) != KU(0u));
    fan f = sample_fan(q, a, b, l.kind != KU(LIGHT_TRIANGLE), abs_(volume), u, v);
    EXACT real x = f.s * K(2.0f) - K(1.0f);
    EXACT real z = f.t * K(2.0f) - K(1.0f);
    EXACT real r2 = x * x + z * z;
    lit = and_(lit, or_(not_(disc), r2 < K(1.0f)));
    EXACT real d2 = max_(dot3(f.d, f.d), K(1e-12f));
    real dist = sqrt_(d2);
    EXACT real inv = K(1.0f) / dist;
    s.wi = mul3(f.d, inv);
    s.dist = dist;
    s.le = mul3(l.e, sel(lit, f.angle, K(0.0f)));
    return s;
}

FN light_sample sample_flat(light l, v3 y, real u, real v) {
    light_sample s;
    real su = u;
    real sv = v;
    real share = K(1.0f); /* area / |a x b|; 0 for points and spots */
    real bare = K(0.0f);  /* 1 for points and spots */
    mask plain = or_(l.kind == KU(LIGHT_PARALLELOGRAM), l.kind == KU(LIGHT_SPHERE)); /* spheres: see sample_light */
    if (ANY(not_(plain))) {
        mask disc = l.kind == KU(LIGHT_DISC);
        mask tri = l.kind == KU(LIGHT_TRIANGLE);
        mask point = is_point(l);
        mask fold = and_(tri, (u + v) > K(1.0f));
        su = sel(fold, K(1.0f) - u, u);
        sv = sel(fold, K(1.0f) - v, v);
        if (ANY(disc)) {
            v3 cs = circle(v);
            real r = sqrt_(u);
            su = sel(disc, r * cs.x, su);
            sv = sel(disc, r * cs.y, sv);
        }
        su = sel(point, K(0.0f), su);
        sv = sel(point, K(0.0f), sv);
        share = sel(disc, K(CORE_PI), sel(tri, K(0.5f), sel(point, K(0.0f), share)));
        bare = sel(point, K(1.0f), bare);
    }
    v3 w = sub3(l.p, y);
    EXACT real dx = w.x + (l.a.x * su + l.b.x * sv);
    EXACT real dy = w.y + (l.a.y * su + l.b.y * sv);
    EXACT real dz = w.z + (l.a.z * su + l.b.z * sv);
    v3 d = V3(dx, dy, dz);
    EXACT real d2 = max_(dot3(d, d), K(1e-12f));
    real dist = sqrt_(d2);
    EXACT real inv = K(1.0f) / dist;
    EXACT real facing = K(0.0f) - dot3(cross3(l.a, l.b), d);
    mask both = (l.flags & KU(LIGHT_TWO_SIDED)) != KU(0u);
    facing = sel(both, abs_(facing), max_(facing, K(0.0f)));
    mask spot = l.kind == KU(LIGHT_SPOT);
    if (ANY(spot)) {
        EXACT real f = l.b.x - dot3(l.a, d) * inv;
        f = min_(max_(f, K(0.0f)), K(1.0f));
        bare = sel(spot, f * f, bare);
    }
    EXACT real g = (share * facing * inv + bare) * (inv * inv);
    s.wi = mul3(d, inv);
    s.dist = dist;
    s.le = mul3(l.e, g);
    EXACT real reach = l.radius * K(LIGHT_CLOSE);
    real w2 = dot3(w, w);
    mask close = w2 < reach * reach;
    if (ANY(close)) {
        EXACT real disc_reach = l.radius * K(LIGHT_CLOSE_DISC);
        close = and_(close, or_(l.kind != KU(LIGHT_DISC), w2 < disc_reach * disc_reach));
        close = and_(close, profile_of(l) == KU(0u));
        light_sample c = sample_close(l, y, u, v);
        s.wi = sel3(close, c.wi, s.wi);
        s.dist = sel(close, c.dist, s.dist);
        s.le = sel3(close, c.le, s.le);
    }
    return s;
}

/* Without its profile. */
FN light_sample sample_light(light l, v3 y, real u, real v) {
    mask round = l.kind == KU(LIGHT_SPHERE);
    light_sample s;
    s.wi = fill3(K(0.0f));
    s.dist = K(0.0f);
    s.le = fill3(K(0.0f));
    if (ANY(not_(round)))
        s = sample_flat(l, y, u, v);
    if (ANY(round)) {
        light_sample r = sample_round(l, y, u, v);
        s.wi = sel3(round, r.wi, s.wi);
        s.dist = sel(round, r.dist, s.dist);
        s.le = sel3(round, r.le, s.le);
    }
    return s;
}

/* A sample's le where the light has a profile. */
CALL v3 profiled_le(CTX light l, light_sample s, v3 y, mask on) {
    mask round = l.kind == KU(LIGHT_SPHERE);
    v3 w = sub3(l.p, y);
    v3 d = sel3(round, w, mul3(s.wi, s.dist));
    EXACT real d2 = max_(dot3(d, d), K(1e-12f));
    real cd = profile_towards(PASS selu(on, profile_of(l), KU(1u)), l.a, l.b, sub3(fill3(K(0.0f)), d));
    mask reaches = or_(not_(round), d2 > l.radius * l.radius * K(1.000001f));
    EXACT real g = cd / d2;
    return mul3(l.e, sel(reaches, g, K(0.0f)));
}

FN light_sample shining_sample(CTX light l, v3 y, real u, real v) {
    light_sample s = sample_light(l, y, u, v);
    mask on = (l.flags & KU(LIGHT_PROFILE_BITS)) != KU(0u);
    if (SELDOM(ANY(on)))
        s.le = sel3(on, profiled_le(PASS l, s, y, on), s.le);
    return s;
}

/* What its shape shows of it, cd/m2. */
FN v3 light_shown(light l) {
    mask on = (l.flags & KU(LIGHT_PROFILE_BITS)) != KU(0u);
    v3 e = l.e;
    if (ANY(on)) {
        real sides = sel(l.kind == KU(LIGHT_SPHERE), K(4.0f), K(1.0f));
        EXACT real per_lumen = K(0.101321184f) / max_(sides * l.radius * l.radius, K(1e-12f));
        e = sel3(on, mul3(e, per_lumen), e);
    }
    return e;
}

#endif
