/* core/through.h: surfaces that light passes in part. Transmittances along a way multiply. A camera's ray meets such a
 * surface with the probability of what it does not let through, so that the mean of what rays meet is that of what is
 * seen: surface over surface, as alpha has it (Porter and Duff 1984, "Compositing Digital Images", `over`). Whether a
 * ray does is a matter of its key and the triangle alone, not of the order in which a tracer looks at triangles.
 * Includers supply texel_load. */
#ifndef CORE_THROUGH_H
#define CORE_THROUGH_H

#include "core/random.h"
#include "core/texture.h"

/* Texel of so many that the place is in; a: within 0..1. */
FN u32 texel_under(u32 count, real a) {
    EXACT real x = a * to_real(count);
    u32 i = to_u32(sel(and_(x >= K(0.0f), x < K(65536.0f)), x, K(0.0f)));
    return selu(i < count, i, count - KU(1u));
}

/* Has the texture at `place` a hole there? u and v as texture_albedo has them. */
FN mask texture_hole(CTX u32 place, real u, real v) {
    u32 wrap = shr(texel_load(PASS place), 8);
    u32 first = texel_load(PASS place + KU(1u));
    u32 size = texel_load(PASS place + KU(2u));
    u32 width = size & KU(0xffffu);
    u32 x = texel_under(width, image_wrap(wrap, u));
    EXACT real down = K(1.0f) - image_wrap(wrap, v);
    u32 y = texel_under(shr(size, 16), down);
    return (texel_load(PASS first + y * width + x) & KU(TEXEL_HOLE)) != KU(0u);
}

/* Does a camera's ray of that key meet the triangle? */
FN mask ray_meets(u32 key, u32 triangle, real transmittance) {
    u32 of_ray = rng_bits(key, KU(DIM_THROUGH));
    return unit_real(hash_u32(of_ray + triangle * KU(0x9e3779b9u))) >= transmittance;
}

#endif
