/* core/wide.h: what wide C needs beside operators, per instruction set. Included by dialect.h only. */
#ifndef CORE_WIDE_H
#define CORE_WIDE_H

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#if CORE_LANES == 16 && defined(__AVX512F__)

FN real sel(mask c, real a, real b) {
    return (real)_mm512_mask_blend_ps(_mm512_movepi32_mask((__m512i)c), (__m512)b, (__m512)a);
}
FN u32 selu(mask c, u32 a, u32 b) {
    return (u32)_mm512_mask_blend_epi32(_mm512_movepi32_mask((__m512i)c), (__m512i)b, (__m512i)a);
}
FN real sqrt_(real a) { return (real)_mm512_sqrt_ps((__m512)a); }
#define ANY(c) (_mm512_movepi32_mask((__m512i)(c)) != 0)

#elif CORE_LANES == 8 && defined(__AVX2__)

FN real sel(mask c, real a, real b) { return (real)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)c); }
FN u32 selu(mask c, u32 a, u32 b) { return (u32)_mm256_blendv_epi8((__m256i)b, (__m256i)a, (__m256i)c); }
FN real sqrt_(real a) { return (real)_mm256_sqrt_ps((__m256)a); }
#define ANY(c) (_mm256_movemask_ps((__m256)(c)) != 0)

#else

FN real sel(mask c, real a, real b) { return (real)(((mask)a & c) | ((mask)b & ~c)); }
FN u32 selu(mask c, u32 a, u32 b) { return (u32)(((mask)a & c) | ((mask)b & ~c)); }
FN real sqrt_(real a) {
    real r;
    for (int i = 0; i < CORE_LANES; i++)
        r[i] = sqrtf(a[i]);
    return r;
}
FN bool wide_any(mask c) {
    int32_t any = 0;
    for (int i = 0; i < CORE_LANES; i++)
        any |= c[i];
    return any != 0;
}
#define ANY(c) wide_any(c)

#endif

FN real to_real(u32 u) { return __builtin_convertvector((mask)u, real); }
FN u32 to_u32(real f) { return (u32)__builtin_convertvector(f, mask); }

#endif
