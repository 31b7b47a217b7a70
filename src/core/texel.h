/* core/texel.h: an albedo in a word: the root of each channel in 10 bits, red in the lowest ones, and TEXEL_THERE.
 * In a texture TEXEL_HOLE, too, where a cutout's surface has a hole. */
#ifndef CORE_TEXEL_H
#define CORE_TEXEL_H

#include "core/dialect.h"
#include "core/records.h"

/* Albedo within 0..1. */
FN u32 texel_pack(v3 a) {
    EXACT real r = sqrt_(a.x) * K(1023.0f) + K(0.5f);
    EXACT real g = sqrt_(a.y) * K(1023.0f) + K(0.5f);
    EXACT real b = sqrt_(a.z) * K(1023.0f) + K(0.5f);
    return to_u32(r) | shl(to_u32(g), 10) | shl(to_u32(b), 20) | KU(TEXEL_THERE);
}

FN v3 texel_albedo(u32 texel) {
    EXACT real r = to_real(texel & KU(1023u)) * K(1.0f / 1023.0f);
    EXACT real g = to_real(shr(texel, 10) & KU(1023u)) * K(1.0f / 1023.0f);
    EXACT real b = to_real(shr(texel, 20) & KU(1023u)) * K(1.0f / 1023.0f);
    return V3(r * r, g * g, b * b);
}

#endif
