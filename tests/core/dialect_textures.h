/* Textures in the dialect test: slots from TEXTURES_FIRST on. */
#ifndef DIALECT_TEXTURES_H
#define DIALECT_TEXTURES_H

/* Textures wherever one asks: heads of 1 to 8 levels, of sides that are no powers of two, then any texels. */
FN u32 texel_load(CTX u32 place) {
    u32 key = hash_u32(place + KU(79u));
    u32 at = place & KU(TEXTURE_HEAD - 1u);
    mask head = place < KU(64u * TEXTURE_HEAD);
    u32 kind = (KU(1u) + scale_u32(rng_bits(key, KU(0u)), KU(8u))) | shl(scale_u32(rng_bits(key, KU(1u)), KU(3u)), 8);
    u32 size = (KU(1u) + scale_u32(rng_bits(key, KU(2u)), KU(300u))) |
               shl(KU(1u) + scale_u32(rng_bits(key, KU(3u)), KU(300u)), 16);
    u32 first = KU(64u * TEXTURE_HEAD) + shr(rng_bits(key, KU(4u)), 8);
    u32 word = selu(at == KU(0u), kind, selu((at & KU(1u)) == KU(1u), first, size));
    return selu(head, word, rng_bits(key, KU(5u)));
}

#include "core/texture.h"

/* Slots 0 to 16. */
CALL void textures(CTX u32 item, u32 key) {
    u32 place = scale_u32(rng_bits(key, KU(4900u)), KU(64u)) * KU(TEXTURE_HEAD);
    corners t;
    t.a = any_v3(key, KU(4910u));
    t.b = any_v3(key, KU(4920u));
    t.c = any_v3(key, KU(4930u));
    image_corners at;
    at.u = any_v3(key, KU(4940u));
    at.v = any_v3(key, KU(4950u));
    real u = image_at(at.u, rng(key, KU(4960u)), rng(key, KU(4961u)));
    real v = image_at(at.v, rng(key, KU(4960u)), rng(key, KU(4961u)));
    real level = texture_level(PASS place, t, at, rng(key, KU(4962u)));
    put_real(PASS item, TEXTURES_FIRST, level);
    v3 a = texture_albedo(PASS place, u, v, level);
    put_v3(PASS item, TEXTURES_FIRST + 1, a);
    put_v3(PASS item, TEXTURES_FIRST + 4, texture_albedo(PASS place, rng(key, KU(4963u)), v, K(-1.0f)));
    put_u32(PASS item, TEXTURES_FIRST + 7, texel_pack(a));
    put_v3(PASS item, TEXTURES_FIRST + 8, texel_albedo(rng_bits(key, KU(4964u))));
    put_real(PASS item, TEXTURES_FIRST + 11, rough_log2(abs_(u) + K(1e-3f)));
    put_real(PASS item, TEXTURES_FIRST + 12, whole_under(u));
    for (int wrap = 0; wrap < 3; wrap++)
        put_real(PASS item, TEXTURES_FIRST + 13 + wrap, image_wrap(KU(U32(wrap)), u));
    texel_pair pair = texels_at(KU(WRAP_REPEAT), KU(17u), rng(key, KU(4965u)));
    put_u32(PASS item, TEXTURES_FIRST + 16, pair.low * KU(17u) + pair.high);
}

#endif
