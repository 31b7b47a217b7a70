/* drape: triangles that lie on what has heights: each edge is split until they lie near its middle, beyond 16 m of its
 * quarters, too; and so is each that is longer than is wanted. */
#ifndef NOC_CITY_DRAPE_H
#define NOC_CITY_DRAPE_H

#include "scene/scene.h"

typedef struct drape_corner {
    double xyz[3];
} drape_corner;

typedef struct drape_piece {
    drape_corner c[3];
    int depth;
} drape_piece;

typedef struct drape {
    const noc_scene *scene;                           /* beyond its bounds nothing is made */
    double (*height)(void *user, double x, double y); /* NaN: there is none, and nothing is made */
    void *user;
    double lift;                /* m above the heights */
    double flat;                /* m that they may lie off an edge */
    double shortest, longest;   /* m: shorter edges are not split, longer ones always are */
    NOC_ARRAY(double) position; /* 3 a corner, three corners a triangle, facing upwards */
    NOC_ARRAY(uint32_t) index;
    NOC_ARRAY(drape_piece) waiting;
    size_t most;   /* triangles that are made */
    size_t pieces; /* that were looked at */
    bool no_memory;
} drape;

/* Returns true if it has as many triangles, or as much work behind it, as is allowed: what is left is not made. */
bool drape_is_full(const drape *d);
/* Adds a triangle, whose heights are not read. Returns NOC_ERR_MEMORY without a report, or NOC_ERR_CANCELLED. */
noc_status drape_triangle(drape *d, const double *const corners[3], const noc_progress *progress);
void drape_free(drape *d);

#endif
