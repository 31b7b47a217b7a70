/* A building's walls to its windows. */
#include "city/windows/parts.h"

/* Places in a building are told by the corner of the box around its walls, in steps of this; the offset keeps round
 * numbers away from where a step ends. */
#define PLACE_STEP 0.1 /* m */
#define PLACE_OFFSET 0.0371

building_box building_box_of(const wall_facets *f) {
    building_box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 0 };
    for (size_t i = 0; i < f->pieces.len; i++)
        for (int k = 0; k < 3; k++) {
            b.lo[k] = fmin(b.lo[k], f->pieces.data[i].lo[k]);
            b.hi[k] = fmax(b.hi[k], f->pieces.data[i].hi[k]);
        }
    for (size_t i = 0; i < f->facets.len; i++)
        b.width = fmax(b.width, f->facets.data[i].hi[0] - f->facets.data[i].lo[0]);
    return b;
}

uint64_t city_window_step(double x) { return (uint64_t)(int64_t)floor((x + PLACE_OFFSET) / PLACE_STEP); }

/* Numbers that a window shares with none, with its neighbour, with its storey. */
static void give_light(city_window *w, const building_box *b, const building_use *use,
                       const noc_window_params *params) {
    uint64_t h = use->hash;
    for (int k = 0; k < 3; k++)
        h = city_window_hash(h, city_window_step(w->corner[k] + 0.5 * (w->edge_u[k] + w->edge_v[k]) - b->lo[k]));
    w->hash = h;
    uint64_t storey = city_window_hash(use->hash, (uint64_t)floor((w->corner[2] - b->lo[2]) / params->storey_height));
    /* the facade's own number is by where it faces and stands: both ends of a pair see the same */
    double n[3];
    cross3(w->edge_u, w->edge_v, n);
    double level = hypot(n[0], n[1]), d = 0;
    for (int k = 0; k < 2; k++)
        d += (w->corner[k] - b->lo[k]) * n[k] / level;
    uint64_t pair = city_window_hash(storey, city_window_step(d));
    pair = city_window_hash(pair, (uint64_t)(int64_t)floor(8 * atan2(n[1], n[0]) + 0.37));
    pair = city_window_hash(pair, (uint64_t)(w->column / 2));
    city_window_shine(w, use, storey, pair, params);
}

/* Takes the windows from `first` on that another wall hides away; returns how many. Of more than so many looks at walls
 * the windows that are left count as hidden. */
static size_t drop_hidden(city_window_list *list, size_t first, const city_cover *cover, size_t *looks, size_t most) {
    size_t kept = first;
    for (size_t i = first; i < list->len && *looks < most; i++)
        if (!city_cover_hides(cover, &list->data[i], looks))
            list->data[kept++] = list->data[i];
    size_t hidden = list->len - kept;
    list->len = kept;
    return hidden;
}

/* What the windows of a building may cost: looks at pieces of wall, and at groups of them, that facets are found by,
 * and tests of pieces under cells. A piece takes up to 111 and 41 in the cities of shared/data. */
#define MOST_LOOKS 2000000u
#define LOOKS_A_PIECE 400u
#define MOST_TESTS 5000000u
#define TESTS_A_PIECE 400u

/* What the windows of a building are made by. */
typedef struct window_maker {
    const building_box *box;
    const building_use *use;
    const noc_window_params *params;
    const city_cover *cover;
    size_t looks, most_looks;
    size_t tests, most_tests; /* of triangles under cells */
} window_maker;

/* The windows that a facade shall have, behind those that there are. False: no memory. */
static bool find_windows(window_maker *m, const wall_facets *f, const strip *s, city_facade *facade,
                         city_windows *out) {
    size_t first = out->list.len, hidden = 0;
    bool crowded = m->looks >= m->most_looks || m->tests >= m->most_tests;
    if (!crowded) {
        if (!wall_cells_find(f, s, m->params, m->use, m->box->lo[2], &m->tests, m->most_tests, facade, &out->list))
            return false;
        hidden = drop_hidden(&out->list, first, m->cover, &m->looks, m->most_looks);
        crowded = m->looks >= m->most_looks || m->tests >= m->most_tests;
    }
    out->crowded += crowded;
    facade->windows = out->list.len - first;
    facade->verdict = facade->windows ? NOC_WALL_TAKEN : hidden || crowded ? NOC_WALL_PARTY : NOC_WALL_SMALL;
    return true;
}

/* Of a triangle, as it was given. */
static void note_facade(city_windows *out, uint32_t triangle, const city_facade *facade) {
    out->verdicts.data[triangle] = (uint8_t)facade->verdict;
    out->of.data[triangle] = (uint32_t)out->facades.len;
}

static bool add_facade(const wall_facets *f, const strip *s, window_maker *m, city_windows *out) {
    city_facade facade = { .verdict = NOC_WALL_SMALL };
    const facet *front = &f->facets.data[s->parts[0].facet];
    size_t first = out->list.len;
    for (size_t i = 0; i < s->count; i++)
        facade.area += f->facets.data[s->parts[i].facet].area;
    if (m->use->bare)
        facade.verdict = NOC_WALL_BARE;
    else if (fabs(front->plane.n[2]) > sin(m->params->tilt * M_PI / 180))
        facade.verdict = NOC_WALL_TILTED;
    else if (facade.area >= m->params->min_area && !find_windows(m, f, s, &facade, out))
        return false;
    for (size_t i = first; i < out->list.len; i++) {
        out->list.data[i].facade = (uint32_t)out->facades.len;
        give_light(&out->list.data[i], m->box, m->use, m->params);
    }
    for (size_t i = 0; i < s->count; i++) {
        const facet *a = &f->facets.data[s->parts[i].facet];
        for (uint32_t k = a->first; k < a->first + a->count; k++)
            note_facade(out, f->pieces.data[f->by_facet.data[k]].given, &facade);
    }
    return array_push(&out->facades, facade);
}

noc_status city_windows_make(const char *id, noc_building_use told, const wall_triangle *walls, size_t count,
                             const noc_window_params *params, const city_cover *cover, size_t looks,
                             city_windows *out) {
    wall_facets f = { 0 };
    wall_strips strips = { 0 };
    out->list.len = out->facades.len = out->verdicts.len = out->of.len = out->crowded = 0;
    f.most_looks = MOST_LOOKS + LOOKS_A_PIECE * count;
    bool ok = wall_facets_find(walls, count, &f) && wall_strips_find(&f, params->cell, &strips) &&
              array_reserve(&out->verdicts, NOC_MAX(count, 1u)) && array_reserve(&out->of, NOC_MAX(count, 1u));
    for (size_t i = 0; ok && i < count; i++) {
        out->verdicts.data[i] = NOC_WALL_SMALL;
        out->of.data[i] = CITY_NO_FACADE;
    }
    out->verdicts.len = out->of.len = ok ? count : 0;
    building_box b = building_box_of(&f);
    building_use use = city_building_use(id, told, b.hi[2] - b.lo[2], b.width);
    window_maker m = { .box = &b, .use = &use, .params = params, .cover = cover, .most_looks = looks };
    m.most_tests = MOST_TESTS + TESTS_A_PIECE * count;
    if (f.cut) { /* its walls are too many over one another to be told apart */
        out->crowded++;
        strips.first.len = 0;
    }
    for (size_t i = 0; ok && i + 1 < strips.first.len; i++) {
        strip s = wall_strip_get(&f, &strips, i);
        ok = add_facade(&f, &s, &m, out);
    }
    wall_strips_free(&strips);
    wall_facets_free(&f);
    return ok ? NOC_OK : NOC_ERR_MEMORY;
}

void city_windows_free(city_windows *w) {
    array_free(&w->list);
    array_free(&w->facades);
    array_free(&w->verdicts);
    array_free(&w->of);
}
