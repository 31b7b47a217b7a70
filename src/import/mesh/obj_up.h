/* obj_up: is the right axis of an OBJ taken for the one that points up? The file does not say. */
#ifndef NOC_OBJ_UP_H
#define NOC_OBJ_UP_H

#include "import/import.h"

/* Of all vertices and triangles, x east, y north, z up as the file is read. Zero-initialise. */
typedef struct obj_spread {
    size_t count;
    double mean[3], square[3]; /* running mean, and sum of squared deviations */
    double area[3];            /* m2 of the triangles, seen along each axis */
} obj_spread;

void obj_spread_add(obj_spread *s, const double *xyz, size_t vertices, const uint32_t *indices, size_t triangles);
/* Warns where the height that this reading gives is hardly one, and the other axis would give a city's. */
void obj_check_up(const obj_spread *s, bool z_up, const char *path, noc_log *log);

#endif
