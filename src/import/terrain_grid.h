/* terrain_grid: a grid of heights as triangles, few where it is flat and many where it is not (right-triangulated
 * irregular network, Evans, Kirkpatrick and Townsend 2001). */
#ifndef NOC_IMPORT_TERRAIN_GRID_H
#define NOC_IMPORT_TERRAIN_GRID_H

#include "base/base.h"

#define TERRAIN_MOST 4097 /* samples on a side */

typedef struct terrain_grid {
    size_t width, height; /* 1 to TERRAIN_MOST */
    float *z;             /* row by row; NaN: there is no ground */
    size_t size;          /* of the square around it: a power of two */
    float *error;         /* size + 1 squared: what leaving a sample out costs, with all that it would take along */
} terrain_grid;

/* Bytes that terrain_grid_measure takes. */
double terrain_grid_bytes(size_t width, size_t height);
/* False: memory was refused. */
bool terrain_grid_measure(terrain_grid *g) NOC_MUST_USE;
/* Triangles whose error is at most so much; edges of holes are as fine as the grid. */
size_t terrain_grid_count(const terrain_grid *g, double error);
/* The smallest error from `error` on, roughly, with no more than so many triangles, or than twice as many as the edges
 * of holes take. */
double terrain_grid_error(const terrain_grid *g, double error, size_t triangles);
/* corners: column and row of each. False from emit ends it. */
bool terrain_grid_emit(const terrain_grid *g, double error, bool (*emit)(void *ctx, const uint32_t corners[3][2]),
                       void *ctx);
void terrain_grid_free(terrain_grid *g);

#endif
