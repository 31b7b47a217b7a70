/* core/shading.h: what a pixel's colour is made of: the emitter that it sees, its samples' light, the sky's light, and
 * the sky or the map behind everything. Includers supply FRAME: core/frame.h. */
#ifndef CORE_SHADING_H
#define CORE_SHADING_H

#include "core/camera.h"
#include "core/environment.h"
#include "core/reservoir.h"
#include "core/shadow.h"
#include "core/sky.h"

#define SKY_REACH 1e7f /* m: further than any scene */
#define SKY_REACH_BACK 1e-7f

/* May it be added to a picture? False for NaN. */
FN mask colour_finite(v3 c) { return abs_(c.x) + abs_(c.y) + abs_(c.z) < K(1e30f); }

/* Does a pixel see an emitter? id: its receiver's light. */
FN mask sees_emitter(u32 id) { return id != KU(NO_LIGHT); }

/* What a pixel's colour begins with: the emitter that it sees, where those are shown. */
FN v3 emitter_shade(CTX u32 id) {
    v3 e = fill3(K(0.0f));
    mask on = sees_emitter(id);
    if ((FRAME.flags & FRAME_EMITTERS) != 0u)
        if (ANY(on))
            e = sel3(on, light_shown(light_load(PASS selu(on, id, KU(0u)))), e);
    return e;
}

/* The light of a reservoir's sample, unshadowed. l: its light. */
FN v3 sample_shade(CTX surf s, reservoir r, light l) {
    return mul3(reflected(s, shining_sample(PASS l, s.p, r.u, r.v)), r.w);
}

/* What it lights the surface with, lx: without what that reflects. */
FN real sample_lux(CTX surf s, reservoir r, light l) {
    light_sample of = shining_sample(PASS l, s.p, r.u, r.v);
    EXACT real lux = luminance(of.le) * max_(dot3(s.n, of.wi), K(0.0f)) * r.w;
    return lux;
}

/* How many rays go to the sky: SKY_RAYS where this frame's lights brought less than the sky may, c: there its noise is
 * all the noise there is, and no time went into shadow rays. It is settled before any of them is traced, so it adds no
 * bias. */
FN u32 sky_turns(CTX v3 c) {
    real bright = K(FRAME.sky);
    if ((FRAME.flags & FRAME_MAP_LIGHTS) != 0u)
        bright = K(FRAME.environment_level);
    return selu(luminance(c) < bright, KU(U32(SKY_RAYS)), KU(1u));
}

/* A ray that leaves the scene, from place `number` of the pixel's sequence. key: of the pixel, frame 0. least: as in
 * shadow_segment. */
FN segment sky_ray(CTX surf s, u32 key, u32 number, real least) {
    mask on = dot3(s.n, s.n) > K(0.5f);
    s.n = sel3(on, s.n, V3(K(0.0f), K(0.0f), K(1.0f)));
    segment r;
    r.o = add3(s.p, mul3(s.n, ray_offset(max_abs3(s.p), least)));
    v3 d;
    if ((FRAME.flags & FRAME_MAP_LIGHTS) != 0u) {
        d = environment_ray(PASS s, key, number);
    } else {
        v3 at = sky_numbers(key, number);
        d = sky_direction(s, at.x, at.y);
    }
    EXACT real dx = d.x * K(SKY_REACH);
    EXACT real dy = d.y * K(SKY_REACH);
    EXACT real dz = d.z * K(SKY_REACH);
    r.d = V3(dx, dy, dz);
    return r;
}

/* What comes along such a ray where it is free, and what it counts, of `share` of the pixel's rays. */
struct sky_arrival {
    v3 d;
    v3 radiance;
    real w; /* share / density */
};

#ifndef CORE_GLSL
typedef struct sky_arrival sky_arrival;
#endif

FN sky_arrival sky_arrives(CTX surf s, v3 way, real share) {
    EXACT real dx = way.x * K(SKY_REACH_BACK);
    EXACT real dy = way.y * K(SKY_REACH_BACK);
    EXACT real dz = way.z * K(SKY_REACH_BACK);
    sky_arrival a;
    a.d = V3(dx, dy, dz);
    real p;
    if ((FRAME.flags & FRAME_MAP_LIGHTS) != 0u) {
        v3 radiance = environment_radiance(PASS a.d);
        p = environment_ray_density(PASS s, a.d, radiance);
        a.radiance = mul3(radiance, K(FRAME.environment_scale));
    } else {
        p = sky_density(s, a.d);
        a.radiance = sky_radiance(a.d, K(FRAME.sky));
    }
    mask some = p > K(0.0f);
    EXACT real w = sel(some, share / sel(some, p, K(1.0f)), K(0.0f));
    a.w = w;
    return a;
}

/* What of it is reflected, and what it lights the surface with, lx. */
FN v3 sky_shade(CTX surf s, v3 way, real share) {
    sky_arrival a = sky_arrives(PASS s, way, share);
    v3 f = reflect(s, a.d);
    EXACT real x = f.x * a.radiance.x * a.w;
    EXACT real y = f.y * a.radiance.y * a.w;
    EXACT real z = f.z * a.radiance.z * a.w;
    return V3(x, y, z);
}

FN real sky_lux(CTX surf s, v3 way, real share) {
    sky_arrival a = sky_arrives(PASS s, way, share);
    EXACT real lux = luminance(a.radiance) * max_(dot3(s.n, a.d), K(0.0f)) * a.w;
    return lux;
}

/* The sky behind pixel (x, y). */
FN v3 sky_behind(CTX u32 x, u32 y) {
    v3 d = frame_direction(PASS x, y);
    EXACT real inv = K(1.0f) / sqrt_(dot3(d, d));
    d = mul3(d, inv);
    v3 behind;
    if ((FRAME.flags & FRAME_ENVIRONMENT) != 0u)
        behind = environment_backdrop(PASS d);
    else
        behind = sky_backdrop(d, K(FRAME.sky));
    return behind;
}

#endif
