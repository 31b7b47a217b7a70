/* Facades: which triangles of walls are of one, and the windows in its cells. */
#include "scene/keep.h"

#include "core/facade.h"

void noc_keep_facades(noct_writer *w, const noc_scene *s) {
    noct_put_array(w, "facades", s->facades.data, s->facades.len, sizeof(noc_facade_record));
    noct_put_array(w, "cells", s->facade_cells.data, s->facade_cells.len, sizeof(uint32_t));
    noct_put_array(w, "fronts", s->triangle_facade.data, s->triangle_facade.len, sizeof(uint32_t));
}

/* Cells lie one facade after the other. */
static bool facade_fits(const noc_scene *s, const noc_facade_record *f, size_t cell) {
    size_t left = s->facade_cells.len - cell;
    return f->first == cell && f->columns >= 1 && f->rows >= 1 && f->rows <= left && f->columns <= left / f->rows &&
           f->material < s->materials.len && f->mesh < s->meshes.len && noc_kept_finite(f->origin, 3, 1e7f) &&
           noc_kept_finite(f->along, 3, 1e6f) && noc_kept_finite(f->up, 3, 1e6f);
}

static bool check_fronts(const void *ctx, size_t first, size_t end) {
    const noc_scene *s = ctx;
    bool ok = true;
    for (size_t i = first; i < end; i++)
        ok &= s->triangle_facade.data[i] <= s->facades.len;
    return ok;
}

/* A cell has the light of a window of its facade, a parallelogram, which no triangle shows. Commits rely on it that a
 * light goes with one mesh or facade alone. */
static bool cells_fit(const noc_scene *s, const uint32_t *facade_of) {
    for (size_t i = 0; i < s->facades.len; i++) {
        const noc_facade_record *f = &s->facades.data[i];
        for (size_t c = f->first; c < f->first + (size_t)f->columns * f->rows; c++) {
            uint32_t light = s->facade_cells.data[c];
            if (light != NOC_NO_LIGHT && (light >= s->lights.len || facade_of[light] != i + 1 ||
                                          s->lights.data[light].kind != LIGHT_PARALLELOGRAM))
                return false;
        }
    }
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        for (size_t t = m->first_triangle; !m->model && t < (size_t)m->first_triangle + m->triangle_count; t++)
            if (s->triangle_light.data[t] != NOC_NO_LIGHT && facade_of[s->triangle_light.data[t]])
                return false;
    }
    return true;
}

static noc_status check_windows(noct_file *f, const noc_scene *s) {
    uint32_t *facade_of = noc_calloc(NOC_MAX(s->lights.len, 1u), sizeof(*facade_of)); /* number + 1 of each light's */
    if (!facade_of)
        return noct_no_memory(f);
    for (size_t i = 0; i < s->windows.len && !f->status; i++) {
        const noc_scene_window *w = &s->windows.data[i];
        if (w->facade > s->facades.len)
            noct_wrong(f, "window %zu is in a facade that there is not", i);
        else if (!w->removed)
            facade_of[w->light] = w->facade;
    }
    if (!f->status && !cells_fit(s, facade_of))
        noct_wrong(f, "a cell of a facade shows what is no window of it");
    free(facade_of);
    return f->status;
}

noc_status noc_kept_facades(noct_file *f, noc_scene *s) {
    size_t facades, cells, fronts, cell = 0;
    noc_facade_record *of = noct_array(f, "facades", sizeof(*of), &facades);
    uint32_t *light = noct_array(f, "cells", sizeof(*light), &cells),
             *front = noct_array(f, "fronts", sizeof(*front), &fronts);
    if (f->status || facades > INT32_MAX || cells >= NO_CELL || fronts > s->triangle_light.len)
        return noct_wrong(f, "it has %zu facades of %zu cells", facades, cells);
    array_borrow(&s->facades, of, facades);
    array_borrow(&s->facade_cells, light, cells);
    array_borrow(&s->triangle_facade, front, fronts);
    for (size_t i = 0; i < facades; i++) {
        if (!facade_fits(s, &of[i], cell))
            return noct_wrong(f, "facade %zu is none", i);
        cell += (size_t)of[i].columns * of[i].rows;
    }
    if (cell != cells || !noct_each(f, fronts, check_fronts, s))
        return noct_wrong(f, "it has cells or walls of no facade");
    return f->status ? f->status : check_windows(f, s);
}
