/* Facades: windows that lie in walls, without triangles of their own. */
#include "scene/facade.h"

#include "core/facade.h"

#include <math.h>

uint32_t noc_scene_add_facade(noc_scene *s, const noc_facade *facade) {
    size_t first = s->facade_cells.len, cells = (size_t)facade->columns * facade->rows;
    if (s->facades.len >= INT32_MAX || first + cells >= NO_CELL || !array_reserve(&s->facades, s->facades.len + 1) ||
        !array_reserve(&s->facade_cells, first + cells)) {
        noc_scene_out_of_memory(s);
        return 0;
    }
    noc_facade_record r = { .first = (uint32_t)first,
                            .columns = facade->columns,
                            .rows = facade->rows,
                            .material = (uint32_t)facade->material,
                            .mesh = (uint32_t)facade->mesh };
    double column = 0, row = 0;
    for (int k = 0; k < 3; k++) {
        column += facade->along[k] * facade->along[k];
        row += facade->up[k] * facade->up[k];
    }
    for (int k = 0; k < 3; k++) {
        r.origin[k] = (float)facade->origin[k];
        r.along[k] = (float)(facade->along[k] / column);
        r.up[k] = (float)(facade->up[k] / row);
    }
    for (size_t i = 0; i < cells; i++)
        s->facade_cells.data[s->facade_cells.len++] = NOC_NO_LIGHT;
    s->facades.data[s->facades.len++] = r;
    return (uint32_t)s->facades.len;
}

#define NEAR_AN_EDGE 1e-3 /* of a cell: places of a window that are so far beyond an edge are taken for beyond it */

typedef struct cell_range {
    int64_t lo[2], hi[2]; /* columns, rows; hi is the last one */
} cell_range;

/* The cells that corner + s u + t v reaches over, for s and t of 0 to 1. */
static cell_range cells_of(const noc_facade_record *f, const double corner[3], const double u[3], const double v[3]) {
    cell_range r;
    for (int axis = 0; axis < 2; axis++) {
        const float *to = axis ? f->up : f->along;
        double at = 0, of_u = 0, of_v = 0;
        for (int k = 0; k < 3; k++) {
            at += (corner[k] - (double)f->origin[k]) * (double)to[k];
            of_u += u[k] * (double)to[k];
            of_v += v[k] * (double)to[k];
        }
        r.lo[axis] = (int64_t)floor(at + fmin(of_u, 0) + fmin(of_v, 0) + NEAR_AN_EDGE);
        r.hi[axis] = (int64_t)floor(at + fmax(of_u, 0) + fmax(of_v, 0) - NEAR_AN_EDGE);
    }
    return r;
}

bool noc_scene_facade_takes(const noc_scene *s, uint32_t facade, const noc_light *shape) {
    const noc_facade_record *f = &s->facades.data[facade - 1];
    cell_range r = cells_of(f, shape->position, shape->edge_u, shape->edge_v);
    if (r.lo[0] < 0 || r.lo[1] < 0 || r.hi[0] >= f->columns || r.hi[1] >= f->rows)
        return false;
    for (int64_t row = r.lo[1]; row <= r.hi[1]; row++)
        for (int64_t column = r.lo[0]; column <= r.hi[0]; column++)
            if (s->facade_cells.data[f->first + (size_t)row * f->columns + (size_t)column] != NOC_NO_LIGHT)
                return false;
    return true;
}

void noc_facade_put(noc_scene *s, uint32_t facade, uint32_t light) {
    const noc_facade_record *f = &s->facades.data[facade - 1];
    const noc_light_record *l = &s->lights.data[light];
    double corner[3], u[3], v[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = (double)l->p[k];
        u[k] = (double)l->a[k];
        v[k] = (double)l->b[k];
    }
    cell_range r = cells_of(f, corner, u, v);
    for (int64_t row = NOC_MAX(r.lo[1], 0); row <= NOC_MIN(r.hi[1], (int64_t)f->rows - 1); row++)
        for (int64_t column = NOC_MAX(r.lo[0], 0); column <= NOC_MIN(r.hi[0], (int64_t)f->columns - 1); column++)
            s->facade_cells.data[f->first + (size_t)row * f->columns + (size_t)column] = light;
}

uint32_t noc_facade_light(const noc_scene *s, const noc_facade_record *f, const float p[3]) {
    const v3 at = V3(p[0], p[1], p[2]);
    uint32_t cell = facade_cell(facade_of_record(*f), at);
    uint32_t light = cell == NO_CELL ? NOC_NO_LIGHT : s->facade_cells.data[cell];
    if (light == NOC_NO_LIGHT)
        return light;
    const noc_light_record *l = &s->lights.data[light];
    return window_covers(splat3(l->p), splat3(l->a), splat3(l->b), at) ? light : NOC_NO_LIGHT;
}

/* Number + 1 of the first facade that triangles from *t to the end are of, and *t behind its run of triangles; 0: there
 * is none. */
static uint32_t next_facade(const noc_scene *s, size_t *t, size_t end) {
    const uint32_t *of = s->triangle_facade.data;
    end = NOC_MIN(end, s->triangle_facade.len);
    while (*t < end && !of[*t])
        ++*t;
    uint32_t found = *t < end ? of[*t] : 0;
    while (found && *t < end && of[*t] == found)
        ++*t;
    return found;
}

size_t noc_facade_windows(const noc_scene *s, const noc_scene_mesh *m) {
    size_t count = 0, t = m->first_triangle, end = t + m->triangle_count;
    for (uint32_t f; (f = next_facade(s, &t, end)) != 0;)
        count += (size_t)s->facades.data[f - 1].columns * s->facades.data[f - 1].rows;
    return NOC_MIN(count, s->windows.len);
}

static void remove_windows(noc_scene *s, const noc_facade_record *f, noc_changes *c) {
    for (size_t i = f->first; i < f->first + (size_t)f->columns * f->rows; i++) {
        uint32_t light = s->facade_cells.data[i];
        noc_scene_window *window = light == NOC_NO_LIGHT ? NULL : noc_window_of(s, light);
        s->facade_cells.data[i] = NOC_NO_LIGHT;
        if (!window || window->removed)
            continue; /* it was in the cell before, too */
        noc_light_release(s, light, c);
        window->removed = true;
    }
}

void noc_facades_remove(noc_scene *s, const noc_scene_mesh *m, noc_changes *c) {
    size_t t = m->first_triangle, end = t + m->triangle_count;
    for (uint32_t f; (f = next_facade(s, &t, end)) != 0;) {
        remove_windows(s, &s->facades.data[f - 1], c);
        s->facades_changed = s->versions.geometry + 1;
    }
}
