/* light/learned: which lights are seen from where, learned from the shadow rays of earlier frames. The scene is cut
 * into cubic cells, each with counts for the lights that were asked for from the surfaces in it that face one of six
 * ways. Cells come in sizes of powers of two; a renderer asks for those that suit a surface's distance. Being in world
 * space, it survives a moving camera. It only ever guides where rays go (core/lists.h), so no picture's mean depends on
 * its being right. */
#ifndef NOC_LIGHT_LEARNED_H
#define NOC_LIGHT_LEARNED_H

#include "base/base.h"

#include <stdint.h>

enum { NOC_CELL_WAYS = 4, NOC_CELL_SETS = 16, NOC_CELL_LIGHTS = NOC_CELL_WAYS * NOC_CELL_SETS };

typedef struct noc_cell {
    uint64_t key;                    /* 0: free */
    uint32_t used;                   /* time of the last observation */
    uint32_t asked_all, seen_all;    /* of all lights */
    uint32_t light[NOC_CELL_LIGHTS]; /* set by set; a place is free where asked is 0 */
    uint16_t asked[NOC_CELL_LIGHTS], seen[NOC_CELL_LIGHTS];
} noc_cell;

typedef struct noc_learned {
    noc_cell *cells;
    size_t count; /* power of two */
    uint32_t time;
    size_t bytes;
} noc_learned;

/* What the rays from one cell to one light found out. */
typedef struct noc_observation {
    uint64_t cell;
    uint32_t light;
    uint16_t asked, seen; /* 1 <= asked, seen <= asked */
} noc_observation;

/* Those of one tile, in their order. */
typedef struct noc_observations {
    const noc_observation *data;
    size_t count;
} noc_observations;

/* Room for the cells of a picture of so many tiles of 16 x 16 pixels. NULL after reporting that memory was refused. */
noc_learned *noc_learned_create(size_t tiles, noc_log *log);
void noc_learned_destroy(noc_learned *learned); /* NULL is allowed */
void noc_learned_forget(noc_learned *learned);

/* Key of the cell with sides of 2^level m that holds p, on a surface of normal n; never 0. */
uint64_t noc_cell_key(const float p[3], const float n[3], int level);
/* NULL where nothing is known. Threads may look while nobody adds. */
const noc_cell *noc_learned_find(const noc_learned *learned, uint64_t key);
/* Visibility expected of a light, 0..1; cell may be NULL. */
float noc_cell_visibility(const noc_cell *cell, uint32_t light);

/* Takes in a frame's observations, in their order: the outcome is the same for any number of threads. */
void noc_learned_add(noc_learned *learned, noc_pool *pool, const noc_observations *tiles, size_t count);

#endif
