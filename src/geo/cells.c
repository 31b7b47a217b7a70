#include "geo/geo.h"

#include <math.h>

bool geo_cells_create(geo_cells *cells, size_t points, double edge) {
    *cells = (geo_cells){ .size = 1024, .edge = edge };
    while (cells->size < points)
        cells->size *= 2;
    cells->first = noc_calloc(cells->size, sizeof(*cells->first));
    cells->next = noc_calloc(points, sizeof(*cells->next));
    if (cells->first && cells->next)
        return true;
    geo_cells_free(cells);
    return false;
}

uint32_t *geo_cells_at(const geo_cells *cells, const double xy[2], int neighbour) {
    int64_t x = (int64_t)floor(xy[0] / cells->edge) + neighbour % 3 - 1,
            y = (int64_t)floor(xy[1] / cells->edge) + neighbour / 3 - 1;
    uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u + (uint64_t)y * 0xc2b2ae3d27d4eb4fu;
    return &cells->first[(h ^ h >> 32) & (cells->size - 1)];
}

void geo_cells_add(geo_cells *cells, const double xy[2], size_t index) {
    uint32_t *head = geo_cells_at(cells, xy, 4);
    cells->next[index] = *head;
    *head = (uint32_t)index + 1;
}

void geo_cells_free(geo_cells *cells) {
    free(cells->first);
    free(cells->next);
    *cells = (geo_cells){ 0 };
}
