/* polygons: faces of meshes with more corners than three. */
#ifndef NOC_IMPORT_POLYGONS_H
#define NOC_IMPORT_POLYGONS_H

#include "geo/geo.h"

/* Triangles of a mesh in the making. extra holds those of polygons, with vertices of their own. */
typedef struct cut_mesh {
    const double *xyz; /* 3 a vertex */
    const float *uv;   /* 2 a vertex; NULL: none */
    uint32_t *indices; /* 3 a triangle; room for two triangles a face */
    size_t triangle_count;
    geo_triangles extra; /* its no_memory: of a face, which then is not there */
    geo_issues *issues;
    const char *name;
} cut_mesh;

/* Cuts a face of 3 corners and more. Quadrilaterals take the diagonal that lies inside; others go the way of surveyors'
 * polygons (geo_triangulate): concave, crossing themselves, of 100,000 corners, whatever their size. */
void cut_face(cut_mesh *m, const unsigned *corner, size_t count);

#endif
