/* core/texture.h: albedos of images, as receivers see them: bilinear in a level of a pyramid of halves, linear between
 * two levels. The level is that whose texels are as large as a pixel is where its ray meets the surface: the footprint
 * of a ray cone (Akenine-Moeller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones").
 *
 * Textures lie in one array of words. A texture begins with a head: its levels and from bit 8 on what is beyond its
 * edges, then for each level the place of its first texel and its width, from bit 16 on its height. Then come the
 * texels (core/texel.h), rows from the top. Includers supply texel_load. */
#ifndef CORE_TEXTURE_H
#define CORE_TEXTURE_H

#include "core/hit.h"
#include "core/texel.h"

/* Where a triangle's corners are in an image: corner by corner in x, y and z. */
struct image_corners {
    v3 u;
    v3 v;
};

/* The texels around a place on one axis: the nearest two, and the share of the second. */
struct texel_pair {
    u32 low;
    u32 high;
    real share;
};

#ifndef CORE_GLSL
typedef struct image_corners image_corners;
typedef struct texel_pair texel_pair;
FN u32 texel_load(CTX u32 place);
#else
uint texel_load(uint place);
#endif

/* Within 0.09 of the logarithm to base 2, and without a step; a > 0. */
FN real rough_log2(real a) {
    u32 bits = bits_of_real(a);
    real whole = to_real(shr(bits, 23)) - K(127.0f);
    real rest = real_of_bits((bits & KU(0x7fffffu)) | KU(0x3f800000u)) - K(1.0f);
    EXACT real log = whole + rest;
    return log;
}

/* At the barycentric coordinates of the second and the third corner. */
FN real image_at(v3 corner, real s, real t) {
    EXACT real at = corner.x + (corner.y - corner.x) * s + (corner.z - corner.x) * t;
    return at;
}

/* Level of the pyramid, 0 the whole image and not rounded, on a triangle of texture `place` where a pixel is so wide:
 * width in the corners' unit, along the surface. */
FN real texture_level(CTX u32 place, corners t, image_corners at, real width) {
    v3 n = cross3(sub3(t.b, t.a), sub3(t.c, t.a));
    u32 size = texel_load(PASS place + KU(2u));
    EXACT real across = (at.u.y - at.u.x) * (at.v.z - at.v.x) - (at.u.z - at.u.x) * (at.v.y - at.v.x);
    EXACT real texels = abs_(across) * to_real(size & KU(0xffffu)) * to_real(shr(size, 16));
    EXACT real area = sqrt_(max_(dot3(n, n), K(1e-30f)));
    EXACT real covered = texels / area * width * width;
    EXACT real level = K(0.5f) * rough_log2(min_(max_(covered, K(1.0f)), K(1e30f)));
    return level;
}

/* Largest whole number under a; |a| < 2^22. */
FN real whole_under(real a) {
    real n = nearest(a);
    return sel(n > a, n - K(1.0f), n);
}

/* A place in an image, its sides 0 and 1, brought into it. */
FN real image_wrap(u32 wrap, real a) {
    EXACT real once = a - whole_under(a);
    EXACT real half_ = a * K(0.5f);
    EXACT real twice = K(2.0f) * (half_ - whole_under(half_));
    real back = K(2.0f) - twice;
    real mirrored = sel(twice > K(1.0f), back, twice);
    real clamped = min_(max_(a, K(0.0f)), K(1.0f));
    return sel(wrap == KU(WRAP_REPEAT), once, sel(wrap == KU(WRAP_MIRROR), mirrored, clamped));
}

/* a: within 0..1, of `count` texels. */
FN texel_pair texels_at(u32 wrap, u32 count, real a) {
    texel_pair p;
    u32 last = count - KU(1u);
    EXACT real x = a * to_real(count) + K(0.5f);
    x = sel(and_(x >= K(0.0f), x < K(65536.0f)), x, K(0.0f)); /* what is no number stays in the image, too */
    u32 i = to_u32(x);
    EXACT real share = x - to_real(i);
    i = selu(i < count, i, count);
    mask around = wrap == KU(WRAP_REPEAT);
    p.low = selu(i == KU(0u), selu(around, last, KU(0u)), i - KU(1u));
    p.high = selu(i == count, selu(around, KU(0u), last), i);
    p.share = share;
    return p;
}

FN v3 between(v3 a, v3 b, real share) {
    EXACT real x = a.x + (b.x - a.x) * share;
    EXACT real y = a.y + (b.y - a.y) * share;
    EXACT real z = a.z + (b.z - a.z) * share;
    return V3(x, y, z);
}

/* In one level; u to the right, v downwards, within 0..1. */
FN v3 texture_in_level(CTX u32 place, u32 level, u32 wrap, real u, real v) {
    u32 head = place + KU(1u) + level + level;
    u32 first = texel_load(PASS head);
    u32 size = texel_load(PASS head + KU(1u));
    u32 width = size & KU(0xffffu);
    texel_pair x = texels_at(wrap, width, u);
    texel_pair y = texels_at(wrap, shr(size, 16), v);
    u32 upper = first + y.low * width;
    u32 lower = first + y.high * width;
    v3 a =
        between(texel_albedo(texel_load(PASS upper + x.low)), texel_albedo(texel_load(PASS upper + x.high)), x.share);
    v3 b =
        between(texel_albedo(texel_load(PASS lower + x.low)), texel_albedo(texel_load(PASS lower + x.high)), x.share);
    return between(a, b, y.share);
}

/* Albedo at (u, v), the image's lower left corner (0, 0) and its upper right one (1, 1). */
FN v3 texture_albedo(CTX u32 place, real u, real v, real level) {
    u32 kind = texel_load(PASS place);
    u32 last = (kind & KU(0xffu)) - KU(1u);
    u32 wrap = shr(kind, 8);
    real x = image_wrap(wrap, u);
    EXACT real y = K(1.0f) - image_wrap(wrap, v);
    real at = min_(level, to_real(last));
    at = sel(at > K(0.0f), at, K(0.0f));
    u32 fine = to_u32(at);
    u32 coarse = selu(fine < last, fine + KU(1u), last);
    EXACT real share = at - to_real(fine);
    v3 a = texture_in_level(PASS place, fine, wrap, x, y);
    mask more = share > K(0.0f);
    if (ANY(more))
        a = sel3(more, between(a, texture_in_level(PASS place, coarse, wrap, x, y), share), a);
    return a;
}

#endif
