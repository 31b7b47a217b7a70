/* Where the passes over light lists keep what they pass on to each other, in words; read by the host and by shaders. */
#ifndef NOC_VULKAN_LIST_MEMORY_H
#define NOC_VULKAN_LIST_MEMORY_H

#include "core/list_limits.h"

/* ---- scratch of a band: its tiles row by row, then its pixels ---- */

#define TILE_CELLS 16 /* of the visibility cache, that a tile's blocks lie in: one a block at most */

#define TILE_COUNT 0   /* entries of its list */
#define TILE_PATCHES 1 /* what list_strongest leaves for list_tail */
#define TILE_GROUPS 2
#define TILE_ENTRIES 3
#define TILE_DRAWS 4
#define TILE_CELL 8   /* of each block: the number of its cell in the tile */
#define TILE_ROW 24   /* of each cell: its row of observations */
#define TILE_LIGHT 40 /* the list, as pixels read it */
#define TILE_WEIGHT (TILE_LIGHT + LIST_ROOM)
#define TILE_CHOSEN (TILE_WEIGHT + LIST_ROOM) /* lights that are chosen, once each, and their weights */
#define TILE_CHANCE (TILE_CHOSEN + LIST_ROOM)
#define TILE_PATCH (TILE_CHANCE + LIST_ROOM) /* 15 words each */
#define TILE_GROUP (TILE_PATCH + 15 * LIST_PATCHES)
#define TILE_SCORES (TILE_GROUP + LIST_GROUPS)                 /* in the room of what is made later: */
#define TILE_SKETCHES TILE_SCORES                              /* field by field */
#define TILE_PRIORS (TILE_SKETCHES + SKETCH_WORDS * LIST_ROOM) /* of each cell: shares, expectations, by place */
#define TILE_LATER (SKETCH_WORDS * LIST_ROOM + 2 * LIST_ROOM * TILE_CELLS)

/* A pixel's words, field by field over the band. */
#define PIXEL_FRESH 0 /* 1: hardly any frame stands behind it */
#define PIXEL_ALL 1   /* list_sums */
#define PIXEL_DRAWS 2
#define PIXEL_COUNT 3 /* of its rays */
#define PIXEL_SEES 4  /* 1: a surface */
#define PIXEL_RAYS 5  /* RAY_WORDS each: */
#define RAY_DRAWN 0   /* the entry, and from bit 8 on how often it was drawn */
#define RAY_W 1       /* what it was weighed; then W, 0 where it is blocked */
#define RAY_P 2
#define RAY_BRINGS 3 /* 3 */
#define RAY_WORDS 6

/* ---- observations of a frame: a head, each tile's lights, then rows of counts, a cell of a tile each ---- */

#define SEEN_ROWS 0 /* rows that are taken */
#define SEEN_HEAD 16
#define ROW_ITEM 0   /* number of the tile, times TILE_CELLS, and of the cell in it */
#define ROW_KEY 1    /* 2 */
#define ROW_NEXT 3   /* row of the same run of cells, from 1 on; 0: none */
#define ROW_COUNTS 4 /* of each entry: rays sent, and from bit 16 on rays that arrived */

/* ---- the visibility cache: a head, cells (core/learned_cells.h), then each run's first row of observations ---- */

#define CACHE_BRIGHT 0 /* mean luminance that the last frame expected, cd/m2 */
#define CACHE_HEAD 16

/* ---- flags of a dispatch's record ---- */

#define LIST_LEARNS 1u /* the visibility cache steers rays, and learns from them */
#define LIST_FRESH 2u  /* PIXEL_FRESH is made */
#define LIST_MIXES 4u  /* a pixel's light is shared between its reservoir and its rays */
#define LIST_SHARES 8u /* pixels share several rays out over lists */

#endif
