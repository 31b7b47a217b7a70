/* core/random.h: every random number is a pure function of (seed, pixel, frame, dimension). */
#ifndef CORE_RANDOM_H
#define CORE_RANDOM_H

#include "core/dialect.h"

/* A 32-bit finaliser of two multiplications (constants by C. Wellons' search for low bias). */
FN u32 hash_u32(u32 x) {
    x = x ^ shr(x, 16);
    x = x * KU(0x7feb352du);
    x = x ^ shr(x, 15);
    x = x * KU(0x846ca68bu);
    x = x ^ shr(x, 16);
    return x;
}

/* The same of a value that is one for all lanes. */
FN1 u1 hash_u1(u1 x) {
    x = x ^ shr(x, 16);
    x = x * 0x7feb352du;
    x = x ^ shr(x, 15);
    x = x * 0x846ca68bu;
    return x ^ shr(x, 16);
}

/* One key a pixel and frame; seed and frame are uniform. */
FN u32 rng_key(u32 seed, u32 pixel, u32 frame) {
    return hash_u32(pixel + hash_u32(frame + hash_u32(seed + KU(0x68bc21ebu))));
}

FN u32 rng_bits(u32 key, u32 dimension) { return hash_u32(key + dimension * KU(0x9e3779b9u)); }

/* [0, 1), 24 bits. */
FN real unit_real(u32 bits) { return to_real(shr(bits, 8)) * K(5.9604644775390625e-8f); }
FN real rng(u32 key, u32 dimension) { return unit_real(rng_bits(key, dimension)); }

/* Two 16-bit numbers in (0, 1) from one draw: centres of a 65536 x 65536 grid's cells. */
FN real unit_low(u32 bits) { return (to_real(bits & KU(0xffffu)) + K(0.5f)) * K(1.52587890625e-5f); }
FN real unit_high(u32 bits) { return (to_real(shr(bits, 16)) + K(0.5f)) * K(1.52587890625e-5f); }

/* floor(bits * n / 2^32): uniform in [0, n) to within n / 2^32. */
FN u32 scale_u32(u32 bits, u32 n) { return high_u32(bits, n); }

/* Dimensions, so that no two uses share one. */
#define DIM_JITTER 0u
#define DIM_SKY 2u         /* and the next one, of frame 0: every frame goes on from there */
#define DIM_LIST 4u        /* of a tile, not of a pixel, and of frame 0: every frame goes on from there */
#define DIM_THROUGH 5u     /* then a number a triangle: core/through.h */
#define DIM_ENVIRONMENT 6u /* of frame 0: every frame goes on from there */
#define DIM_TEMPORAL 8u    /* as DIM_SPATIAL, but for the places */
#define DIM_RAYS 16u       /* reference only: no reuse beside it */
#define DIM_SPATIAL 64u    /* + 64 a pass, + those below */
#define DIM_CANDIDATE 512u /* + 3 a candidate */
#define DIM_PICK 4096u     /* + 1 a candidate: pickers that need a second number */

/* Of a combination (core/combine.h): three of neighbour i, 2 for its place and 1 for its choice, and three of the pixel
 * itself, which come after those of 16 neighbours. All are below 64 for 20 neighbours. */
#define DIM_OWN 48u
#define DIM_NEIGHBOUR(i) (3u * U32(i) + (U32(i) < 16u ? 0u : 3u))

/* Of pixels that choose among the entries of a list; they draw no other candidates. */
#define DIM_LIST_PLACE 512u  /* and the next one: where on their lights entries are looked at */
#define DIM_LIST_CHOICE 514u /* + 1 an entry: one is chosen */
#define DIM_LIST_RAYS 514u   /* several rays are shared out: how many, */
#define DIM_LIST_START 515u  /* where they start, */
#define DIM_LIST_SHOWN 516u  /* which of them stands for the pixel in views, */
#define DIM_LIST_KEPT 517u   /* and which becomes its reservoir */

/* Start of the tail of a tile's list, as a share of 2^32: anywhere, and from frame to frame on along the golden ratio's
 * sequence, so that the mean of some frames has met the lights as evenly as one frame with so many draws. number: the
 * tile's in the picture, row by row. */
FN u32 tail_start(u32 seed, u32 number, u32 frame) {
    return rng_bits(rng_key(seed, number, KU(0u)), KU(DIM_LIST)) + frame * KU(2654435769u);
}

#endif
