/* core/wide.h: what wide C needs beside operators, per instruction set. Included by dialect.h only. */
#ifndef CORE_WIDE_H
#define CORE_WIDE_H

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#if CORE_LANES == 16 && defined(__AVX512F__)

/* Comparisons give vectors: a ternary logic operation is one instruction less than the way back to a mask register. */
FN real sel(mask c, real a, real b) {
    return (real)_mm512_ternarylogic_epi32((__m512i)c, (__m512i)a, (__m512i)b, 0xca);
}
FN u32 selu(mask c, u32 a, u32 b) { return (u32)_mm512_ternarylogic_epi32((__m512i)c, (__m512i)a, (__m512i)b, 0xca); }
FN real sqrt_(real a) { return (real)_mm512_sqrt_ps((__m512)a); }
FN real min_(real a, real b) { return (real)_mm512_min_ps((__m512)a, (__m512)b); }
FN real max_(real a, real b) { return (real)_mm512_max_ps((__m512)a, (__m512)b); }
FN u32 high_u32(u32 a, u32 b) {
    __m512i even = _mm512_srli_epi64(_mm512_mul_epu32((__m512i)a, (__m512i)b), 32);
    __m512i odd = _mm512_mul_epu32(_mm512_srli_epi64((__m512i)a, 32), _mm512_srli_epi64((__m512i)b, 32));
    return (u32)_mm512_mask_blend_epi32(0xaaaa, even, odd);
}
#define ANY(c) (_mm512_movepi32_mask((__m512i)(c)) != 0)

#elif CORE_LANES == 8 && defined(__AVX2__)

FN real sel(mask c, real a, real b) { return (real)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)c); }
FN u32 selu(mask c, u32 a, u32 b) { return (u32)_mm256_blendv_epi8((__m256i)b, (__m256i)a, (__m256i)c); }
FN real sqrt_(real a) { return (real)_mm256_sqrt_ps((__m256)a); }
FN real min_(real a, real b) { return (real)_mm256_min_ps((__m256)a, (__m256)b); }
FN real max_(real a, real b) { return (real)_mm256_max_ps((__m256)a, (__m256)b); }
FN u32 high_u32(u32 a, u32 b) {
    __m256i even = _mm256_srli_epi64(_mm256_mul_epu32((__m256i)a, (__m256i)b), 32);
    __m256i odd = _mm256_mul_epu32(_mm256_srli_epi64((__m256i)a, 32), _mm256_srli_epi64((__m256i)b, 32));
    return (u32)_mm256_blend_epi32(even, odd, 0xaa);
}
#define ANY(c) (_mm256_movemask_ps((__m256)(c)) != 0)

#else

FN real sel(mask c, real a, real b) { return (real)(((mask)a & c) | ((mask)b & ~c)); }
FN u32 selu(mask c, u32 a, u32 b) { return (u32)(((mask)a & c) | ((mask)b & ~c)); }
#if CORE_LANES == 4 && defined(__SSE2__)
FN real sqrt_(real a) { return (real)_mm_sqrt_ps((__m128)a); }
FN real min_(real a, real b) { return (real)_mm_min_ps((__m128)a, (__m128)b); }
FN real max_(real a, real b) { return (real)_mm_max_ps((__m128)a, (__m128)b); }
#define ANY(c) (_mm_movemask_ps((__m128)(c)) != 0)
#elif CORE_LANES == 4 && defined(__aarch64__)
FN real sqrt_(real a) { return (real)vsqrtq_f32((float32x4_t)a); }
FN real min_(real a, real b) { return sel(a < b, a, b); } /* vminq gives NaN where either is */
FN real max_(real a, real b) { return sel(a > b, a, b); }
#define ANY(c) (vmaxvq_u32((uint32x4_t)(c)) != 0)
#else
FN real sqrt_(real a) {
    real r;
    for (int i = 0; i < CORE_LANES; i++)
        r[i] = sqrtf(a[i]);
    return r;
}
FN real min_(real a, real b) { return sel(a < b, a, b); }
FN real max_(real a, real b) { return sel(a > b, a, b); }
FN bool wide_any(mask c) {
    int32_t any = 0;
    for (int i = 0; i < CORE_LANES; i++)
        any |= c[i];
    return any != 0;
}
#define ANY(c) wide_any(c)
#endif
#if CORE_LANES == 4 && defined(__aarch64__)
FN u32 high_u32(u32 a, u32 b) {
    uint64x2_t low = vmull_u32(vget_low_u32((uint32x4_t)a), vget_low_u32((uint32x4_t)b));
    uint64x2_t high = vmull_high_u32((uint32x4_t)a, (uint32x4_t)b);
    return (u32)vuzp2q_u32(vreinterpretq_u32_u64(low), vreinterpretq_u32_u64(high));
}
#else
FN u32 high_u32(u32 a, u32 b) {
    u32 r;
    for (int i = 0; i < CORE_LANES; i++)
        r[i] = (uint32_t)((uint64_t)a[i] * b[i] >> 32);
    return r;
}
#endif

#endif

FN real abs_(real a) { return (real)((u32)a & KU(0x7fffffffu)); }
FN real to_real(u32 u) { return __builtin_convertvector((mask)u, real); }
FN u32 to_u32(real f) { return (u32) __builtin_convertvector(f, mask); }
FN real real_of_bits(u32 bits) { return (real)bits; }
FN u32 bits_of_real(real x) { return (u32)x; }

/* Bit i: lane i. */
FN u1 lane_bits(mask m) {
#if CORE_LANES == 16 && defined(__AVX512F__)
    return (u1)_mm512_movepi32_mask((__m512i)m);
#elif CORE_LANES == 8 && defined(__AVX2__)
    return (u1)_mm256_movemask_ps((__m256)m);
#elif CORE_LANES == 4 && defined(__x86_64__)
    return (u1)_mm_movemask_ps((__m128)m);
#elif CORE_LANES == 4 && defined(__aarch64__)
    const uint32_t bit[4] = { 1, 2, 4, 8 };
    return vaddvq_u32(vandq_u32((uint32x4_t)m, vld1q_u32(bit)));
#else
    u1 bits = 0;
    for (int i = 0; i < CORE_LANES; i++)
        bits |= (m[i] ? 1u : 0u) << i;
    return bits;
#endif
}

/* Of values that are not NaN. */
FN f1 lane_max(real a) {
#if CORE_LANES == 16 && defined(__AVX512F__)
    return _mm512_reduce_max_ps((__m512)a);
#elif CORE_LANES == 4 && defined(__aarch64__)
    return vmaxvq_f32((float32x4_t)a);
#else
    f1 most = a[0];
    for (int i = 1; i < CORE_LANES; i++)
        most = most > a[i] ? most : a[i];
    return most;
#endif
}

FN u1 lane_sum(u32 a) {
    u1 sum = 0;
    for (int i = 0; i < CORE_LANES; i++)
        sum += a[i];
    return sum;
}

#endif
