/* core/list_sketch.h: a light of a tile's list in brief, made once a tile, and what a surface gets of it from afar,
 * about. That steers only: a pixel, or several that see alike (core/list_faces.h), weighs the entries of its list by
 * it, and what it then chooses is evaluated in full (core/light.h) and divided by the very weight that chose it
 * (core/list_rays.h).
 *
 * From afar is beyond SKETCH_FAR radii of what the light lies in. About where a glossy surface mirrors the eye it is so
 * far that the light is narrower than the lobe; and with a profile so far that the intensity hardly turns. What the
 * sketch gives is 0 only where no place of the light reaches any of the surfaces, and no place of a flat light brings
 * more than four times of it: a surface that sees the light edge on takes the mean of the cosine at its middle and at
 * the farthest it may reach, and so does one beside the cone of a spot. A profile's intensity is the one towards it,
 * but no less than a quarter of the largest around in its table, nor than a 64th of its peak. */
#ifndef CORE_LIST_SKETCH_H
#define CORE_LIST_SKETCH_H

#include "core/list_limits.h"
#include "core/reservoir.h"

#define SKETCH_FAR 3.0f
#define SKETCH_FAR_GLOSSY 1.5f   /* radii, over alpha */
#define SKETCH_MIRROR 3.0f       /* widths from where the surface mirrors the eye */
#define SKETCH_FAR_PROFILE 16.0f /* radii, so that directions are within PROFILE_AROUND */
#define SKETCH_PEAK 0.015625f    /* of the largest intensity, at least */

struct list_sketch {
    v3 middle;
    real radius; /* m around the middle */
    v3 normal;   /* of flat lights, the side that shines; as long as the area, m2. Spot, profile: the record's a */
    real size;   /* flat, spot: that length; profile: the radius of what its intensity is told at each place of, m */
    u32 shape;   /* SKETCH_ROUND, ...; a profile's number in bits SKETCH_NUMBER and up */
    v3 shine;    /* parts of luminance in cd/m2 (flat), cd (round, spot) or lm (profile), by channel */
    v3 beside;   /* profile: the record's b */
    real level;  /* spot: o; profile: its least intensity here, cd/lm; else 0 */
};

/* A surface as sketches are looked at from. */
struct sketch_surf {
    real reach; /* radii that are afar, squared */
    v3 tint;    /* albedo over pi */
    real nv;
    mask shiny;
    real matte; /* core/surface.h, under_gloss: what is left of diffuse light, and k */
    real k;
    real alpha2;
    real gloss; /* alpha2 / (2 pi) */
    real slope; /* Smith's visibility term is about 1 / 2 over slope * nl + level */
    real level;
};

#ifndef CORE_GLSL
typedef struct list_sketch list_sketch;
typedef struct sketch_surf sketch_surf;
#endif

FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count); /* of places l to l + LANES - 1 of a row of a list of so
                                                            * many rows and entries; where there is none, some light */
FN void sketch_store(CTX u1 row, int l, list_sketch k);    /* of these places */
FN list_sketch sketch_load(CTX u1 place);                  /* in every lane; place: 16 a row */

/* Rows of 16 that a list of so many entries has, and where an entry lies in them (core/list_faces.h). */
FN1 u1 list_rows(u1 count) { return (count + 15u) / 16u; }
FN1 u1 entry_place(u1 i, u1 rows) { return i % rows * 16u + i / rows; }

/* ---- making them ---- */

FN list_sketch sketch_of(light l) {
    list_sketch k;
    mask disc = l.kind == KU(LIGHT_DISC);
    mask tri = l.kind == KU(LIGHT_TRIANGLE);
    mask sphere = l.kind == KU(LIGHT_SPHERE);
    mask round = or_(sphere, is_point(l));
    mask cornered = or_(tri, l.kind == KU(LIGHT_PARALLELOGRAM));
    real share = sel(cornered, sel(tri, K(1.0f / 3.0f), K(0.5f)), K(0.0f));
    EXACT real fx = (l.a.x + l.b.x) * share;
    EXACT real fy = (l.a.y + l.b.y) * share;
    EXACT real fz = (l.a.z + l.b.z) * share;
    EXACT real ax = l.a.x - fx;
    EXACT real ay = l.a.y - fy;
    EXACT real az = l.a.z - fz;
    EXACT real bx = l.b.x - fx;
    EXACT real by = l.b.y - fy;
    EXACT real bz = l.b.z - fz;
    v3 far = V3(fx, fy, fz);
    v3 beside = V3(ax, ay, az);
    v3 above = V3(bx, by, bz);
    k.middle = add3(l.p, far);
    real corner = sqrt_(max_(dot3(far, far), max_(dot3(beside, beside), dot3(above, above))));
    k.radius = sel(cornered, corner, sel(is_point(l), K(0.0f), l.radius));
    real size = sel(round, K(0.0f), sel(disc, K(CORE_PI), sel(tri, K(0.5f), K(1.0f))));
    k.normal = mul3(cross3(l.a, l.b), size);
    k.size = sqrt_(dot3(k.normal, k.normal));
    EXACT real face = K(CORE_PI) * l.radius * l.radius;
    face = sel(and_(sphere, profile_of(l) == KU(0u)), face, K(1.0f));
    EXACT real red = l.e.x * K(0.2126f) * face;
    EXACT real green = l.e.y * K(0.7152f) * face;
    EXACT real blue = l.e.z * K(0.0722f) * face;
    k.shine = V3(red, green, blue);
    u32 sided = selu((l.flags & KU(LIGHT_TWO_SIDED)) != KU(0u), KU(SKETCH_TWO_SIDED), KU(SKETCH_FLAT));
    k.shape = selu(round, KU(SKETCH_ROUND), sided);
    k.beside = l.b;
    k.level = K(0.0f);
    mask spot = l.kind == KU(LIGHT_SPOT);
    mask profiled = profile_of(l) != KU(0u);
    if (ANY(or_(spot, profiled))) {
        k.shape = selu(spot, KU(SKETCH_SPOT), k.shape);
        k.shape = selu(profiled, KU(SKETCH_PROFILE) | shl(profile_of(l), SKETCH_NUMBER), k.shape);
        k.normal = sel3(or_(spot, profiled), l.a, k.normal);
        k.size = sel(spot, sqrt_(dot3(l.a, l.a)), sel(profiled, sel(disc, l.radius, K(0.0f)), k.size));
        k.level = sel(spot, l.b.x, sel(profiled, l.area * K(SKETCH_PEAK), K(0.0f)));
    }
    return k;
}

/* Of all entries of the tile's list. */
FN1 void list_sketches(CTX u1 count) {
    u1 rows = list_rows(count);
    EACH_GROUP(row, 0u, rows)
    EACH16(l)
    sketch_store(PASS row, l, sketch_of(light_load(PASS entry_lights(PASS row, l, rows, count))));
}

/* ---- looking at them ---- */

/* 1 over the root of x, from 1e-37 to 1e37, to a five-hundredth: a guess by the exponent's half and one step of
 * Newton's. No division and no root, and the same bits on every machine. */
FN real quick_inverse_root(real x) {
    real y = real_of_bits(KU(0x5f375a86u) - shr(bits_of_real(x), 1));
    EXACT real z = y * (K(1.5f) - K(0.5f) * x * y * y);
    return z;
}

FN sketch_surf sketch_surf_of(surf s) {
    sketch_surf q;
    q.shiny = s.f0 > K(0.0f);
    q.tint = mul3(s.albedo, K(CORE_INV_PI));
    q.nv = dot3(s.n, s.wo);
    EXACT real narrow = K(SKETCH_FAR_GLOSSY) / max_(s.alpha, K(1e-3f));
    real radii = sel(q.shiny, max_(narrow, K(SKETCH_FAR)), K(SKETCH_FAR));
    q.reach = radii * radii;
    real nv = max_(q.nv, K(1e-4f));
    EXACT real k = K(1.0f) / (K(1.0f) + s.alpha * (K(13.0f) + K(9.0f) * s.alpha));
    real co = K(1.0f) - max_(q.nv, K(0.0f));
    EXACT real matte = (K(1.0f) - s.f0) / (K(1.0f) - k * K(0.1f)) * (K(1.0f) - k * (co * co * co));
    q.matte = matte;
    q.k = k;
    q.alpha2 = s.alpha * s.alpha;
    EXACT real gloss = q.alpha2 * K(0.5f * CORE_INV_PI);
    q.gloss = gloss;
    EXACT real slope = K(2.0f) * nv * (K(1.0f) - s.alpha) + s.alpha;
    q.slope = slope;
    EXACT real level = nv * s.alpha;
    q.level = level;
    return q;
}

/* The glossy lobe over cos(theta), about; wi: unit, about, at the cosine n_wi. The visibility term is the one
 * that E. Hammon 2017 ("PBR Diffuse Lighting for GGX+Smith Microsurfaces") has for Smith's: no roots. */
FN real sketch_gloss(surf s, sketch_surf q, v3 wi, real n_wi, real nl) {
    v3 h = add3(wi, s.wo);
    real h2 = max_(dot3(h, h), K(1e-6f));
    EXACT real nh = n_wi + q.nv;
    EXACT real wide = max_(h2 - nh * nh * (K(1.0f) - q.alpha2), q.alpha2 * h2);
    EXACT real vh = K(0.5f) * h2 * quick_inverse_root(h2);
    EXACT real fresnel = s.f0 + (K(1.0f) - s.f0) * schlick_weight(min_(vh, K(1.0f)));
    real inv = quick_inverse_root(wide * wide * (q.slope * nl + q.level));
    EXACT real f = q.gloss * (h2 * h2) * fresnel * (inv * inv);
    return f;
}

/* How far the middle is, squared. */
FN real sketch_distance2(list_sketch k, v3 y) {
    v3 w = sub3(k.middle, y);
    return max_(dot3(w, w), K(1e-12f));
}

/* Is it near for some surface around? */
FN mask sketch_near(surf s, sketch_surf q, list_sketch k, real d2, real around) {
    EXACT real wide = k.radius + K(2.0f) * around;
    real wide2 = wide * wide;
    EXACT real turned = K(SKETCH_FAR_PROFILE) * (k.size + around);
    mask near = or_(d2 < K(SKETCH_FAR * SKETCH_FAR) * wide2, and_(k.shape >= KU(SKETCH_PROFILE), d2 < turned * turned));
    mask close = and_(q.shiny, d2 < q.reach * wide2);
    if (ANY(close)) {
        v3 w = sub3(k.middle, s.p);
        real inv = quick_inverse_root(d2);
        v3 h = add3(mul3(w, inv), s.wo);
        EXACT real nh = dot3(s.n, w) * inv + q.nv;
        EXACT real beside = (dot3(h, h) - nh * nh) * d2;
        near = or_(near, and_(close, beside < K(SKETCH_MIRROR * SKETCH_MIRROR) * wide2));
    }
    return near;
}

/* About the target of any place on the light, which is not near, for surfaces no farther than `around` from s (m) whose
 * normals' angles to that of s have no larger sine than `spread`. */
FN real sketch_target(CTX surf s, sketch_surf q, list_sketch k, real d2, real around, real spread) {
    v3 w = sub3(k.middle, s.p);
    real inv = quick_inverse_root(d2);
    EXACT real better = inv * (K(1.5f) - K(0.5f) * d2 * inv * inv); /* lobes are narrow */
    inv = better;
    v3 wi = mul3(w, inv);
    real facing = k.level - dot3(k.normal, wi);
    facing = sel(k.shape == KU(SKETCH_TWO_SIDED), abs_(facing), facing);
    EXACT real behind = K(0.5f) * (facing + k.size * around * inv);
    facing = sel(k.shape == KU(SKETCH_ROUND), K(1.0f), max_(facing, max_(behind, K(0.0f))));
    mask beam = k.shape >= KU(SKETCH_SPOT);
    if (ANY(beam)) {
        mask spot = k.shape == KU(SKETCH_SPOT);
        facing = sel(spot, min_(facing, K(1.0f)), facing);
        facing = sel(spot, facing * facing, facing);
        mask profiled = and_(beam, not_(spot));
        if (ANY(profiled)) { /* there may be none */
            u32 number = selu(profiled, shr(k.shape, SKETCH_NUMBER), KU(1u));
            v3 away = sub3(fill3(K(0.0f)), wi);
            facing = sel(profiled, profile_about(PASS number, k.normal, k.beside, away, k.level), facing);
        }
    }
    real n_wi = dot3(s.n, wi);
    EXACT real rim = K(0.5f) * (n_wi + ((k.radius + around) * inv + spread));
    real nl = max_(n_wi, max_(rim, K(0.0f)));
    EXACT real got = facing * nl * (inv * inv);
    EXACT real f = k.shine.x * q.tint.x + k.shine.y * q.tint.y + k.shine.z * q.tint.z;
    if (ANY(q.shiny)) {
        real ci = K(1.0f) - nl;
        EXACT real diffuse = f * q.matte * (K(1.0f) - q.k * (ci * ci * ci));
        EXACT real both = diffuse + (k.shine.x + k.shine.y + k.shine.z) * sketch_gloss(s, q, wi, n_wi, nl);
        f = sel(q.shiny, both, f);
    }
    EXACT real p = got * f;
    return sel(p > K(0.0f), min_(p, K(1e30f)), K(0.0f));
}

#endif
