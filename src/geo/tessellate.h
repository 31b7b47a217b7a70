/* tessellate: the GLU tessellator, kept in one place. */
#ifndef NOC_GEO_TESSELLATE_H
#define NOC_GEO_TESSELLATE_H

#include "geo/geo.h"

typedef struct tessellation {
    bool ok;
    bool tangled;     /* not ok, as its rings cross more often than those of any surveyed polygon */
    bool no_memory;   /* not ok, as memory was refused */
    size_t crossings; /* places where rings cross; a vertex was made there */
    size_t touches;   /* places where two points of the rings meet */
} tessellation;

/* Cuts rings (uv: 2 a point, rings one after the other) into triangles appended to out->indices, counter-clockwise in
 * uv. Point i is vertex first_vertex + i of out->xyz. One ring is filled where it winds an odd number of times; with
 * holes, which run clockwise, what the exterior covers more often than they do. Vertices at crossings are appended to
 * out->xyz, and those of the cuts that large polygons are divided by. The time grows as n log n. */
tessellation tessellate(const double *uv, const size_t *ring_size, size_t ring_count, geo_triangles *out,
                        size_t first_vertex);

#endif
