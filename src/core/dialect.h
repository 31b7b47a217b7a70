/* core/dialect.h: one language, three readers.
 *
 * Everything in src/core is written so that it is scalar C, C with LANES values in each variable, and GLSL. The reader
 * is chosen before inclusion: CORE_GLSL (a shader), CORE_LANES = 4, 8 or 16 (wide GNU C), or neither (scalar C).
 *
 * Rules: functions are pure and return structs, no pointers, no out-parameters. Operators work on real and u32; vectors
 * go through add3, mul3, dot3, ... A choice that depends on data is sel(mask, a, b), with and_/or_/not_ on masks; a
 * real branch only as `if (ANY(mask))` around work that sel then picks from, or on what is uniform. Loops have uniform
 * bounds. Literals are K(0.5f) and KU(7u), uniform integers K(F32(n)) and KU(U32(n)). No enum, static, union, typedef,
 * cast, ternary or compound literal outside this file; no identifiers that GLSL reserves (sample, buffer, filter,
 * input, output, half, patch, smooth, flat, active, common). Resources come through bridge functions that take CTX,
 * which is a context pointer in C and nothing in GLSL. EXACT marks variables whose rounding must be the same
 * everywhere. Compile with -ffp-contract=off and never with -ffast-math.
 *
 * f1, u1, b1 and f3 are values that are one for a whole tile or block, whatever the lanes: float, uint32_t, bool and
 * three floats. On them if, while, ternary-free expressions with && and || are allowed, and literals are plain. K(f1),
 * KU(u1) and spread3(f3) spread them over the lanes. FN1 marks functions of such values only, CALL those that are so
 * long that they stay calls. What is looked at 16 at a time is walked by EACH16(l), which gives the first of LANES
 * places that a lane value holds; lane_bits, lane_sum and lane_max bring lanes back to one value. Writing goes through
 * bridge functions, too. Work on a tile that a shader's work group may share out is walked by EACH_GROUP and
 * EACH_INDEX, with SETTLE between what one worker stores and another one loads. */
#ifndef CORE_DIALECT_H
#define CORE_DIALECT_H

#if defined(CORE_GLSL)

#define FN
#define FN1
#define CALL
#define EXACT precise
#define CTX
#define PASS
#define real float
#define u32 uint
#define mask bool
#define v3 vec3
#define K(x) (x)
#define KU(x) (x)
#define F32(x) float(x)
#define U32(x) uint(x)
#define V3(x, y, z) vec3(x, y, z)
#define sel(c, a, b) ((c) ? (a) : (b))
#define selu(c, a, b) ((c) ? (a) : (b))
#define and_(a, b) ((a) && (b))
#define or_(a, b) ((a) || (b))
#define not_(a) (!(a))
#define ANY(c) (c)
#define SELDOM(c) (c) /* a condition that compilers lay out for being false */
#define sqrt_ sqrt
#define abs_ abs
#define to_real(u) float(u)
#define to_u32(f) uint(f)
#define shl(a, n) ((a) << (n))
#define shr(a, n) ((a) >> (n))
#define real_of_bits uintBitsToFloat
#define bits_of_real floatBitsToUint
#define LANES 1
#define lane_bits(c) ((c) ? 1u : 0u)
#define lane_sum(a) (a)
#define lane_max(a) (a)
#define f1 float
#define u1 uint
#define b1 bool
#define f3 vec3
#define F3(x, y, z) vec3(x, y, z)
#define sqrt1 sqrt
#define floor1 floor
#define f1_of_bits uintBitsToFloat
#define bits_of_f1 floatBitsToUint
#define bit_count(a) uint(bitCount(a))
#define low_bit(a) uint(findLSB(a))
#define high_u1 high_u32
float min1(float a, float b) { return a < b ? a : b; }
float max1(float a, float b) { return a > b ? a : b; }
uint minu1(uint a, uint b) { return a < b ? a : b; }
float min_(float a, float b) { return a < b ? a : b; } /* b where either is NaN */
float max_(float a, float b) { return a > b ? a : b; }
uint high_u32(uint a, uint b) {
    uint high, low;
    umulExtended(a, b, high, low);
    return high;
}

#else /* C */
#define SELDOM(c) __builtin_expect((c) ? 1 : 0, 0)

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define FN static inline __attribute__((always_inline)) /* a call would pass structs through memory */
#define FN1 static inline
#define CALL static __attribute__((noinline, unused))
#define EXACT
#define CTX const struct core_context *ctx,
#define PASS ctx,
#define F32(x) ((float)(x))
#define U32(x) ((uint32_t)(x))
#define shl(a, n) ((a) << (n))
#define shr(a, n) ((a) >> (n))

struct core_context; /* the includer's own: what its bridge functions read */

typedef float f1;
typedef uint32_t u1;
typedef bool b1;
typedef struct {
    f1 x, y, z;
} f3;
#define F3(x, y, z) ((f3){ x, y, z })
FN1 f1 sqrt1(f1 a) { return sqrtf(a); }
FN1 f1 floor1(f1 a) { return floorf(a); }
FN1 f1 min1(f1 a, f1 b) { return a < b ? a : b; }
FN1 f1 max1(f1 a, f1 b) { return a > b ? a : b; }
FN1 u1 minu1(u1 a, u1 b) { return a < b ? a : b; }
FN1 u1 bit_count(u1 a) { return (u1)__builtin_popcount(a); }
FN1 u1 low_bit(u1 a) { return (u1)__builtin_ctz(a); }
FN1 u1 high_u1(u1 a, u1 b) { return (u1)((uint64_t)a * b >> 32); }
FN1 f1 f1_of_bits(u1 bits) {
    f1 x;
    __builtin_memcpy(&x, &bits, sizeof(x));
    return x;
}
FN1 u1 bits_of_f1(f1 x) {
    u1 bits;
    __builtin_memcpy(&bits, &x, sizeof(bits));
    return bits;
}

#if defined(CORE_LANES)

#define LANES CORE_LANES
typedef float real __attribute__((vector_size(4 * CORE_LANES)));
typedef uint32_t u32 __attribute__((vector_size(4 * CORE_LANES)));
typedef int32_t mask __attribute__((vector_size(4 * CORE_LANES)));
#define K(x) real_in_lanes((float)(x))
#define KU(x) u32_in_lanes((uint32_t)(x))
#if CORE_LANES == 4
#define IN_LANES(x)                                                                                                    \
    { x, x, x, x }
#elif CORE_LANES == 8
#define IN_LANES(x)                                                                                                    \
    { x, x, x, x, x, x, x, x }
#else
#define IN_LANES(x)                                                                                                    \
    { x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x }
#endif
/* {0} + x would be an addition, for it makes 0 of -0 */
FN real real_in_lanes(float x) { return (real)IN_LANES(x); }
FN u32 u32_in_lanes(uint32_t x) { return (u32)IN_LANES(x); }
/* sel, selu, min_, max_, abs_, sqrt_, high_u32, to_real, to_u32, ANY, lane_bits, lane_sum, lane_max for this
 * instruction set */
#include "core/wide.h"
#define and_(a, b) ((a) & (b))
#define or_(a, b) ((a) | (b))
#define not_(a) (~(a))

#else /* scalar */

#define LANES 1
typedef float real;
typedef uint32_t u32;
typedef bool mask;
#define K(x) (x)
#define KU(x) (x)
FN real sel(mask c, real a, real b) { return c ? a : b; }
FN u32 selu(mask c, u32 a, u32 b) { return c ? a : b; }
FN real sqrt_(real a) { return sqrtf(a); }
FN real abs_(real a) { return fabsf(a); }
FN real min_(real a, real b) { return a < b ? a : b; }
FN real max_(real a, real b) { return a > b ? a : b; }
FN u32 high_u32(u32 a, u32 b) { return (u32)((uint64_t)a * b >> 32); }
FN real to_real(u32 u) { return (float)(int32_t)u; }
FN u32 to_u32(real f) { return (u32)(int32_t)f; }
FN real real_of_bits(u32 bits) { return f1_of_bits(bits); }
FN u32 bits_of_real(real x) { return bits_of_f1(x); }
FN u1 lane_bits(mask c) { return c ? 1u : 0u; }
FN u1 lane_sum(u32 a) { return a; }
FN f1 lane_max(real a) { return a; }
#define and_(a, b) ((a) && (b))
#define or_(a, b) ((a) || (b))
#define not_(a) (!(a))
#define ANY(c) (c)

#endif

typedef struct {
    real x, y, z;
} v3;
#define V3(x, y, z) ((v3){ x, y, z })

#endif

/* An array of three uniform floats. */
#define splat3(a) V3(K((a)[0]), K((a)[1]), K((a)[2]))

/* Places l, l + 1, ..., l + LANES - 1 of 16; and what one value has added up to in all rounds, or the largest that it
 * has been. A shader whose work groups share out the 16 defines all three before inclusion: one round, and a sum or a
 * maximum over the group. */
#ifndef EACH16
#define EACH16(l) for (int l = 0; l < 16; l += LANES)
#define EACH16_SUM(x) (x)
#define EACH16_MAX(x) (x)
#endif

/* Workers: one does everything in order, in C and in a shader whose invocations have a tile each. A shader whose work
 * group shares a tile defines these before inclusion, and then calls its functions with all of its invocations.
 * EACH_INDEX shares out the numbers below n. EACH_GROUP shares out groups of 16 places, and every place of a group has
 * its worker, always the same one: what that worker has stored there, it may load without SETTLE. FROM_FIRST(x) is x of
 * the one worker for which FIRST_WORKER is true. */
#ifndef EACH_INDEX
#define EACH_INDEX(i, n) for (u1 i = 0u; i < (n); i++)
#define EACH_GROUP(g, begin, end) for (u1 g = (begin); g < (end); g++)
#define SETTLE
#define FIRST_WORKER true
#define FROM_FIRST(x) (x)
#endif

/* to_real takes values below 2^31, to_u32 truncates values in [0, 2^31). min_ and max_ give b where either is NaN.
 * high_u32 and high_u1 are the upper half of the 64-bit product. low_bit: number of the lowest bit that is set, of a
 * value other than 0. */

FN v3 add3(v3 a, v3 b) { return V3(a.x + b.x, a.y + b.y, a.z + b.z); }
FN v3 sub3(v3 a, v3 b) { return V3(a.x - b.x, a.y - b.y, a.z - b.z); }
FN v3 mul3(v3 a, real s) { return V3(a.x * s, a.y * s, a.z * s); }
FN v3 tint3(v3 a, v3 b) { return V3(a.x * b.x, a.y * b.y, a.z * b.z); }
FN v3 sel3(mask c, v3 a, v3 b) { return V3(sel(c, a.x, b.x), sel(c, a.y, b.y), sel(c, a.z, b.z)); }
FN v3 fill3(real s) { return V3(s, s, s); }
FN v3 spread3(f3 a) { return V3(K(a.x), K(a.y), K(a.z)); }

FN1 f1 dot1(f3 a, f3 b) {
    EXACT f1 d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
}

FN real dot3(v3 a, v3 b) {
    EXACT real d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
}

FN v3 cross3(v3 a, v3 b) {
    EXACT real x = a.y * b.z - a.z * b.y;
    EXACT real y = a.z * b.x - a.x * b.z;
    EXACT real z = a.x * b.y - a.y * b.x;
    return V3(x, y, z);
}

/* To the nearest whole number, the even one of two; |a| < 2^22. */
FN real nearest(real a) {
    EXACT real high = a + K(12582912.0f);
    EXACT real whole = high - K(12582912.0f);
    return whole;
}

/* Luminance of linear Rec.709. */
FN real luminance(v3 c) {
    EXACT real y = K(0.2126f) * c.x + K(0.7152f) * c.y + K(0.0722f) * c.z;
    return y;
}

#define CORE_PI 3.14159265358979f
#define CORE_INV_PI 0.318309886183791f

#endif
