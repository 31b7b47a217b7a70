/* core/blocks.h: pixels in memory. They lie in blocks of 4x4, an array of 16 for every value, so that a wide pass loads
 * neighbouring pixels from consecutive memory and 16 primary rays are one coherent packet. Lane = (y & 3) * 4 + (x &
 * 3). */
#ifndef CORE_BLOCKS_H
#define CORE_BLOCKS_H

#include "core/records.h"

#define BLOCK_SIDE 4
#define BLOCK 16
#define NO_SURFACE 0xffffffffu /* instead of a material: sky */

#if defined(CORE_GLSL)
#define ALIGNED
#else
#define ALIGNED _Alignas(64)
#endif

/* What a pixel's ray saw. Positions are local metres. */
struct gblock {
    ALIGNED float px[BLOCK];
    float py[BLOCK];
    float pz[BLOCK];
    float nx[BLOCK]; /* geometric normal on the viewer's side; 0 where there is no surface */
    float ny[BLOCK];
    float nz[BLOCK];
    float depth[BLOCK];       /* distance from the eye */
    uint32_t material[BLOCK]; /* NO_SURFACE: sky */
    uint32_t light[BLOCK];    /* light whose emitting side is seen, or NO_LIGHT */
    uint32_t texel[BLOCK];    /* albedo that is not the material's, as core/texture.h packs it; 0: none */
};

/* Reservoirs: see core/reservoir.h for the fields. */
struct rblock {
    ALIGNED uint32_t light[BLOCK];
    float u[BLOCK];
    float v[BLOCK];
    float w[BLOCK];
    float m[BLOCK];
    float p[BLOCK];
};

/* Colours: linear Rec.709, cd/m2. */
struct cblock {
    ALIGNED float rgb[3][BLOCK];
};

/* Segments from o to o + d. */
struct rayblock {
    ALIGNED float o[3][BLOCK];
    float d[3][BLOCK];
};

#if !defined(CORE_GLSL)
typedef struct gblock gblock;
typedef struct rblock rblock;
typedef struct cblock cblock;
typedef struct rayblock rayblock;

RECORD_SIZE(gblock, 10 * BLOCK);
RECORD_FIELD(gblock, px, 0);
RECORD_FIELD(gblock, py, BLOCK);
RECORD_FIELD(gblock, pz, 2 * BLOCK);
RECORD_FIELD(gblock, nx, 3 * BLOCK);
RECORD_FIELD(gblock, ny, 4 * BLOCK);
RECORD_FIELD(gblock, nz, 5 * BLOCK);
RECORD_FIELD(gblock, depth, 6 * BLOCK);
RECORD_FIELD(gblock, material, 7 * BLOCK);
RECORD_FIELD(gblock, light, 8 * BLOCK);
RECORD_FIELD(gblock, texel, 9 * BLOCK);

RECORD_SIZE(rblock, 6 * BLOCK);
RECORD_FIELD(rblock, light, 0);
RECORD_FIELD(rblock, u, BLOCK);
RECORD_FIELD(rblock, v, 2 * BLOCK);
RECORD_FIELD(rblock, w, 3 * BLOCK);
RECORD_FIELD(rblock, m, 4 * BLOCK);
RECORD_FIELD(rblock, p, 5 * BLOCK);

RECORD_SIZE(cblock, 3 * BLOCK);
RECORD_SIZE(rayblock, 6 * BLOCK);
RECORD_FIELD(rayblock, o, 0);
RECORD_FIELD(rayblock, d, 3 * BLOCK);
#endif

#endif
