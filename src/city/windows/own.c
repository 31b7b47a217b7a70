/* Windows that a model has itself: which of their surfaces are panes that are seen from outside, and which of those
 * belong together. Models of level of detail 3 give windows as bodies, with frames, reveals and backs. */
#include "city/windows/parts.h"

#define LEAST 0.08     /* m2 of a pane */
#define FILLED 0.45    /* share of the rectangle around a pane that it fills: frames do not */
#define WHOLE 0.98     /* from here on it is that rectangle */
#define DOWN -0.3      /* a pane does not look further down than this; of its normal */
#define TOGETHER 0.2   /* m between panes of one window */
#define NEAR_WALL 0.8  /* m: a wall whose plane is so near says which way is out */
#define BESIDE 1.5     /* m: so far beside the pane it may lie */
#define COVERED 0.4    /* m: a pane that another surface of a window stands so near before is not seen */
#define SHOP_WIDTH 2.0 /* m: a window of a shop is so wide, and its foot so near the ground */

typedef struct glass {
    uint32_t facet, window; /* window: the first of those that belong together */
    double lo[3], hi[3];
} glass;

static double gap_of(const double a_lo[3], const double a_hi[3], const double b_lo[3], const double b_hi[3]) {
    double gap = 0;
    for (int k = 0; k < 3; k++)
        gap = fmax(gap, fmax(a_lo[k] - b_hi[k], b_lo[k] - a_hi[k]));
    return gap;
}

/* Does it look out of the building, as the walls near it do? Without any it does. */
static bool looks_out(const facet *f, const glass *g, const wall_facets *walls) {
    double votes = 0;
    for (size_t i = 0; i < walls->pieces.len; i++) {
        const wall_piece *w = &walls->pieces.data[i];
        double d[3], side = dot3(w->n, f->plane.n);
        sub3(f->plane.c, w->t.p[0], d);
        double off = fabs(dot3(d, w->n));
        if (fabs(side) > 0.7 && off <= NEAR_WALL && gap_of(g->lo, g->hi, w->lo, w->hi) <= BESIDE)
            votes += side * w->area / (0.1 + off);
    }
    return votes >= 0;
}

static bool is_glass(const wall_facets *panes, const facet *f, const glass *g, const wall_facets *walls,
                     const city_cover *bodies) {
    double filled = f->area / ((f->hi[0] - f->lo[0]) * (f->hi[1] - f->lo[1]));
    if (f->area < LEAST || filled < FILLED || f->plane.n[2] < DOWN || !looks_out(f, g, walls))
        return false;
    const wall_piece *p = &panes->pieces.data[panes->by_facet.data[f->first]]; /* its largest */
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = (p->t.p[0][k] + p->t.p[1][k] + p->t.p[2][k]) / 3;
    return !city_cover_meets(bodies, middle, f->plane.n, 0.005, COVERED);
}

static uint32_t root_of(glass *g, uint32_t i) {
    while (g[i].window != i)
        i = g[i].window = g[g[i].window].window;
    return i;
}

static int by_place(const void *a, const void *b) {
    const glass *x = a, *y = b;
    if (x->lo[0] != y->lo[0])
        return x->lo[0] < y->lo[0] ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

/* Panes close to each other are one window: the first of them is its number, its box in `box`. */
static void join_windows(glass *g, size_t count, glass *box) {
    for (size_t i = 0; i < count; i++)
        g[i].window = (uint32_t)i;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count && g[j].lo[0] <= g[i].hi[0] + TOGETHER; j++)
            if (gap_of(g[i].lo, g[i].hi, g[j].lo, g[j].hi) <= TOGETHER) {
                uint32_t a = root_of(g, (uint32_t)i), b = root_of(g, (uint32_t)j);
                g[NOC_MAX(a, b)].window = NOC_MIN(a, b);
            }
    memcpy(box, g, count * sizeof(*g));
    for (size_t i = 0; i < count; i++) {
        glass *b = &box[root_of(g, (uint32_t)i)];
        for (int k = 0; k < 3; k++) {
            b->lo[k] = fmin(b->lo[k], g[i].lo[k]);
            b->hi[k] = fmax(b->hi[k], g[i].hi[k]);
        }
    }
}

static void set_rectangle(city_window *w, const facet *f) {
    for (int k = 0; k < 3; k++) {
        w->corner[k] = f->plane.c[k] + f->lo[0] * f->plane.u[k] + f->lo[1] * f->plane.v[k];
        w->edge_u[k] = (f->hi[0] - f->lo[0]) * f->plane.u[k];
        w->edge_v[k] = (f->hi[1] - f->lo[1]) * f->plane.v[k];
    }
}

static void set_triangle(city_window *w, const wall_triangle *t) {
    memcpy(w->corner, t->p[0], sizeof(w->corner));
    sub3(t->p[1], t->p[0], w->edge_u);
    sub3(t->p[2], t->p[0], w->edge_v);
}

/* A pane is one light where it is a rectangle, else one a triangle; all of a window are lit as one. */
static bool add_pane(const wall_facets *panes, const facet *f, const city_window *shine, bool leads,
                     city_own_windows *out) {
    bool whole = f->area >= WHOLE * (f->hi[0] - f->lo[0]) * (f->hi[1] - f->lo[1]);
    for (uint32_t i = 0; i < f->count; i++) {
        const wall_piece *p = &panes->pieces.data[panes->by_facet.data[f->first + i]];
        city_own_pane pane = {
            .first = (uint32_t)out->triangles.len, .whole = whole, .leads = leads && !i, .part = i > 0, .window = *shine
        };
        if (whole)
            set_rectangle(&pane.window, f);
        else
            set_triangle(&pane.window, &p->t);
        if ((!whole || !i) && !array_push(&out->panes, pane))
            return false;
        if (!array_push(&out->triangles, p->given))
            return false;
        out->panes.data[out->panes.len - 1].count++;
    }
    return true;
}

static city_window shine_of(const glass *box, const double lo[3], const building_use *use,
                            const noc_window_params *params) {
    bool shop = box->lo[2] - lo[2] < SHOP_WIDTH &&
                hypot(box->hi[0] - box->lo[0], box->hi[1] - box->lo[1]) > SHOP_WIDTH && use->shops;
    city_window w = { .kind = shop           ? NOC_WINDOW_SHOP
                              : use->offices ? NOC_WINDOW_OFFICE
                                             : NOC_WINDOW_FLAT,
                      .storey = (int)floor((box->lo[2] - lo[2]) / params->storey_height) };
    w.hash = use->hash;
    for (int k = 0; k < 3; k++)
        w.hash = city_window_hash(w.hash, city_window_step(box->lo[k] - lo[k]));
    city_window_shine(&w, use, city_window_hash(use->hash, (uint64_t)w.storey), w.hash, params);
    return w;
}

static bool find(const char *id, noc_building_use told, const wall_facets *panes, const wall_facets *walls,
                 const city_cover *bodies, const noc_window_params *params, city_own_windows *out) {
    size_t count = 0;
    building_box b = building_box_of(walls->pieces.len ? walls : panes);
    building_use use = city_building_use(id, told, b.hi[2] - b.lo[2], b.width);
    glass *g = noc_alloc(NOC_MAX(2 * panes->facets.len, 1u) * sizeof(*g));
    if (!g)
        return false;
    for (size_t i = 0; i < panes->facets.len; i++) {
        const facet *f = &panes->facets.data[i];
        glass now = { (uint32_t)i, 0, { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
        for (uint32_t j = f->first; j < f->first + f->count; j++)
            for (int k = 0; k < 3; k++) {
                now.lo[k] = fmin(now.lo[k], panes->pieces.data[panes->by_facet.data[j]].lo[k]);
                now.hi[k] = fmax(now.hi[k], panes->pieces.data[panes->by_facet.data[j]].hi[k]);
            }
        if (is_glass(panes, f, &now, walls, bodies))
            g[count++] = now;
    }
    qsort(g, count, sizeof(*g), by_place);
    glass *box = g + panes->facets.len;
    join_windows(g, count, box);
    bool ok = true;
    for (size_t i = 0; ok && i < count; i++) {
        uint32_t root = root_of(g, (uint32_t)i);
        city_window shine = shine_of(&box[root], b.lo, &use, params);
        ok = add_pane(panes, &panes->facets.data[g[i].facet], &shine, root == i, out);
    }
    free(g);
    return ok;
}

noc_status city_own_windows_find(const char *id, noc_building_use told, const wall_triangle *panes, size_t count,
                                 const wall_triangle *walls, size_t wall_count, const noc_window_params *params,
                                 city_own_windows *out) {
    wall_facets f = { 0 }, w = { 0 };
    city_cover *bodies = NULL;
    out->panes.len = out->triangles.len = 0;
    float *xyz = noc_alloc(NOC_MAX(9 * count, 1u) * sizeof(*xyz));
    for (size_t i = 0; xyz && i < 9 * count; i++)
        xyz[i] = (float)panes[i / 9].p[i % 9 / 3][i % 3];
    bool ok = xyz && (bodies = city_cover_create(xyz, count, NULL)) && wall_facets_find(panes, count, &f) &&
              wall_facets_find(walls, wall_count, &w) && find(id, told, &f, &w, bodies, params, out);
    free(xyz);
    city_cover_destroy(bodies);
    wall_facets_free(&f);
    wall_facets_free(&w);
    return ok ? NOC_OK : NOC_ERR_MEMORY;
}

void city_own_windows_free(city_own_windows *w) {
    array_free(&w->panes);
    array_free(&w->triangles);
}
