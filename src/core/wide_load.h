/* core/wide_load.h: lights from 64-byte records into lanes. C only, for dialect.h's scalar and wide readers.
 *
 * A record is one cache line of 16 floats, the fields of struct light in their order: p kind | a radius | b flags | e
 * area. Each lane loads its own record, four floats at a time, and four registers are turned by a transposition inside
 * 128-bit parts: no gathers, and a quarter of a record that is not looked at costs nothing. records must be 64-byte
 * aligned. */
#ifndef CORE_WIDE_LOAD_H
#define CORE_WIDE_LOAD_H

#include "core/reservoir.h"

#include <string.h>

#define LIGHT_RECORD_FLOATS 16

#if defined(CORE_LANES)

/* Four fields of all lanes, of records that are `stride` floats apart (a multiple of 4). */
typedef struct {
    real f[4];
} wide_quad;

#if CORE_LANES == 16 && defined(__AVX512F__)

#define WIDE_IN_REGISTERS 1
typedef __m512 wide_row;
#define wide_unpacklo _mm512_unpacklo_ps
#define wide_unpackhi _mm512_unpackhi_ps
#define wide_shuffle _mm512_shuffle_ps
/* Part i of the row: the quarter of the record of lane 4 i + j. */
FN wide_row wide_row_load(const float *quarter, size_t stride, const uint32_t at[16], int j) {
    __m512 r = _mm512_castps128_ps512(_mm_load_ps(quarter + (size_t)at[j] * stride));
    r = _mm512_insertf32x4(r, _mm_load_ps(quarter + (size_t)at[4 + j] * stride), 1);
    r = _mm512_insertf32x4(r, _mm_load_ps(quarter + (size_t)at[8 + j] * stride), 2);
    return _mm512_insertf32x4(r, _mm_load_ps(quarter + (size_t)at[12 + j] * stride), 3);
}

#elif CORE_LANES == 8 && defined(__AVX2__)

#define WIDE_IN_REGISTERS 1
typedef __m256 wide_row;
#define wide_unpacklo _mm256_unpacklo_ps
#define wide_unpackhi _mm256_unpackhi_ps
#define wide_shuffle _mm256_shuffle_ps
FN wide_row wide_row_load(const float *quarter, size_t stride, const uint32_t at[8], int j) {
    __m256 r = _mm256_castps128_ps256(_mm_load_ps(quarter + (size_t)at[j] * stride));
    return _mm256_insertf128_ps(r, _mm_load_ps(quarter + (size_t)at[4 + j] * stride), 1);
}

#elif CORE_LANES == 4 && defined(__x86_64__)

#define WIDE_IN_REGISTERS 1
typedef __m128 wide_row;
#define wide_unpacklo _mm_unpacklo_ps
#define wide_unpackhi _mm_unpackhi_ps
#define wide_shuffle _mm_shuffle_ps
FN wide_row wide_row_load(const float *quarter, size_t stride, const uint32_t at[4], int j) {
    return _mm_load_ps(quarter + (size_t)at[j] * stride);
}

#endif

#if CORE_LANES == 4 && defined(__aarch64__)
FN wide_quad wide_quad_load(const float *quarter, size_t stride, const uint32_t *at) {
    float32x4_t r0 = vld1q_f32(quarter + (size_t)at[0] * stride), r1 = vld1q_f32(quarter + (size_t)at[1] * stride);
    float32x4_t r2 = vld1q_f32(quarter + (size_t)at[2] * stride), r3 = vld1q_f32(quarter + (size_t)at[3] * stride);
    float64x2_t even01 = vreinterpretq_f64_f32(vtrn1q_f32(r0, r1)), even23 = vreinterpretq_f64_f32(vtrn1q_f32(r2, r3));
    float64x2_t odd01 = vreinterpretq_f64_f32(vtrn2q_f32(r0, r1)), odd23 = vreinterpretq_f64_f32(vtrn2q_f32(r2, r3));
    wide_quad q = { { (real)vtrn1q_f64(even01, even23), (real)vtrn1q_f64(odd01, odd23),
                      (real)vtrn2q_f64(even01, even23), (real)vtrn2q_f64(odd01, odd23) } };
    return q;
}
#elif defined(WIDE_IN_REGISTERS)
FN wide_quad wide_quad_load(const float *quarter, size_t stride, const uint32_t *at) {
    wide_row r0 = wide_row_load(quarter, stride, at, 0), r1 = wide_row_load(quarter, stride, at, 1);
    wide_row r2 = wide_row_load(quarter, stride, at, 2), r3 = wide_row_load(quarter, stride, at, 3);
    wide_row lo01 = wide_unpacklo(r0, r1), lo23 = wide_unpacklo(r2, r3);
    wide_row hi01 = wide_unpackhi(r0, r1), hi23 = wide_unpackhi(r2, r3);
    wide_quad q = { { (real)wide_shuffle(lo01, lo23, 0x44), (real)wide_shuffle(lo01, lo23, 0xee),
                      (real)wide_shuffle(hi01, hi23, 0x44), (real)wide_shuffle(hi01, hi23, 0xee) } };
    return q;
}
#else
FN wide_quad wide_quad_load(const float *quarter, size_t stride, const uint32_t *at) {
    float f[4][CORE_LANES];
    for (int i = 0; i < CORE_LANES; i++)
        for (int k = 0; k < 4; k++)
            f[k][i] = quarter[(size_t)at[i] * stride + k];
    wide_quad q;
    memcpy(&q, f, sizeof(q));
    return q;
}
#endif

FN light light_from_records(const float *records, u32 index) {
    uint32_t at[CORE_LANES];
    memcpy(at, &index, sizeof(at));
    __asm__("" : "+m"(at)); /* through memory: taking a vector apart in registers is slower */
    wide_quad p = wide_quad_load(records, LIGHT_RECORD_FLOATS, at),
              a = wide_quad_load(records + 4, LIGHT_RECORD_FLOATS, at);
    wide_quad b = wide_quad_load(records + 8, LIGHT_RECORD_FLOATS, at),
              e = wide_quad_load(records + 12, LIGHT_RECORD_FLOATS, at);
    light l = { V3(p.f[0], p.f[1], p.f[2]), (u32)p.f[3], V3(a.f[0], a.f[1], a.f[2]), a.f[3],
                V3(b.f[0], b.f[1], b.f[2]), (u32)b.f[3], V3(e.f[0], e.f[1], e.f[2]), e.f[3] };
    return l;
}

FN profile_cell profile_from_cells(const float *cells, u32 place) {
    uint32_t at[CORE_LANES];
    memcpy(at, &place, sizeof(at));
    __asm__("" : "+m"(at));
    wide_quad q = wide_quad_load(cells, 4, at);
    profile_cell c = { q.f[0], q.f[1], q.f[2], q.f[3] };
    return c;
}

FN void light_prefetch(const float *records, u32 index) {
    uint32_t at[CORE_LANES];
    memcpy(at, &index, sizeof(at));
    __asm__("" : "+m"(at));
    for (int i = 0; i < CORE_LANES; i++)
        __builtin_prefetch(records + (size_t)at[i] * LIGHT_RECORD_FLOATS);
}

#else /* scalar: struct light is the record */

FN light light_from_records(const float *records, u32 index) {
    light l;
    memcpy(&l, records + (size_t)index * LIGHT_RECORD_FLOATS, sizeof(l));
    return l;
}

FN profile_cell profile_from_cells(const float *cells, u32 place) {
    profile_cell c;
    memcpy(&c, cells + (size_t)place * 4, sizeof(c));
    return c;
}

FN void light_prefetch(const float *records, u32 index) {
    __builtin_prefetch(records + (size_t)index * LIGHT_RECORD_FLOATS);
}

#endif

#endif
