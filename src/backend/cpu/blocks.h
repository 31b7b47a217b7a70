/* Pixels on the CPU: blocks of 4x4, an array of 16 for every value, so that a wide pass loads neighbouring pixels from
 * consecutive memory and 16 primary rays are one coherent packet. Lane = (y & 3) * 4 + (x & 3). */
#ifndef NOC_CPU_BLOCKS_H
#define NOC_CPU_BLOCKS_H

#include <stdint.h>

enum { BLOCK = 16, BLOCK_SIDE = 4 };
#define NO_SURFACE UINT32_MAX
#define ALIGNED _Alignas(64)

/* What the primary ray saw. Positions are local metres. */
typedef struct gblock {
    ALIGNED float px[BLOCK], py[BLOCK], pz[BLOCK];
    float nx[BLOCK], ny[BLOCK], nz[BLOCK]; /* geometric normal on the viewer's side; 0 where there is no surface */
    float depth[BLOCK];                    /* distance from the eye */
    uint32_t material[BLOCK];              /* NO_SURFACE: sky */
    uint32_t light[BLOCK];                 /* light whose emitting side is seen, or NOC_NO_LIGHT */
} gblock;

/* Reservoirs: see core/reservoir.h for the fields. */
typedef struct rblock {
    ALIGNED uint32_t light[BLOCK];
    float u[BLOCK], v[BLOCK], w[BLOCK], m[BLOCK], p[BLOCK];
} rblock;

_Static_assert(sizeof(gblock) == 9 * 4 * BLOCK && sizeof(rblock) == 6 * 4 * BLOCK, "blocks are arrays without gaps");

typedef struct cblock {
    ALIGNED float rgb[3][BLOCK];
} cblock;

/* Segments from o to o + d; those of the lanes in `valid` are traced. */
typedef struct rayblock {
    ALIGNED float o[3][BLOCK], d[3][BLOCK];
} rayblock;

#endif
