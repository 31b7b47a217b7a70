/* light/learned: which lights are seen from where, learned from the shadow rays of earlier frames. The scene is cut
 * into cubic cells, each with counts for the lights that were asked for from the surfaces in it that face one of six
 * ways. Cells come in sizes of powers of two; a renderer asks for those that suit a surface's distance
 * (core/learned.h). Being in world space, it survives a moving camera. It only ever guides where rays go
 * (core/lists.h), so no picture's mean depends on its being right. */
#ifndef NOC_LIGHT_LEARNED_H
#define NOC_LIGHT_LEARNED_H

#include "base/base.h"
#include "core/learned.h"

#include <stdint.h>

typedef struct noc_cell {
    uint32_t word[CELL_WORDS];
} noc_cell;

typedef struct noc_learned {
    noc_cell *cells;
    size_t count; /* power of two */
    uint32_t time;
} noc_learned;

/* What the rays from one cell to one light found out. */
typedef struct noc_observation {
    uint32_t light;
    uint16_t asked, seen; /* 1 <= asked, seen <= asked */
} noc_observation;

/* Those of one cell from one tile, in their order. */
typedef struct noc_cell_observations {
    cell_key cell;
    uint32_t count;
    const noc_observation *data;
    struct noc_cell_observations *next; /* noc_learned_add's own */
} noc_cell_observations;

/* Those of one tile. */
typedef struct noc_observations {
    noc_cell_observations *cells;
    size_t count;
} noc_observations;

/* Room for the cells of a picture of so many tiles of 16 x 16 pixels. NULL after reporting that memory was refused. */
noc_learned *noc_learned_create(size_t tiles, noc_log *log);
void noc_learned_destroy(noc_learned *learned); /* NULL is allowed */
void noc_learned_forget(noc_learned *learned);
size_t noc_learned_cells(size_t tiles); /* a power of two */
/* Has room for a picture of so many tiles at least, and keeps all that is known. NOC_ERR_MEMORY after reporting it:
 * then all is as it was. */
noc_status noc_learned_fit(noc_learned *learned, size_t tiles, noc_log *log) NOC_MUST_USE;

/* NULL where nothing is known. Threads may look while nobody adds. */
const noc_cell *noc_learned_find(const noc_learned *learned, cell_key key);
/* Visibility expected of a light, 0..1; cell may be NULL. */
float noc_cell_visibility(const noc_cell *cell, uint32_t light);

/* Takes in a frame's observations, in their order: the outcome is the same for any number of threads. */
void noc_learned_add(noc_learned *learned, noc_pool *pool, const noc_observations *tiles, size_t count);

#endif
