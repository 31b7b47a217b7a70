/* Pieces of wall to facets: what lies in one plane and touches. */
#include "city/windows/parts.h"

static int compare_doubles(const double *a, const double *b, int n) {
    for (int i = 0; i < n; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

/* Its corners in the same order, the least one first. */
static wall_triangle turned(const wall_triangle *t) {
    int first = 0;
    for (int i = 1; i < 3; i++)
        if (compare_doubles(t->p[i], t->p[first], 3) < 0)
            first = i;
    wall_triangle r;
    for (int i = 0; i < 3; i++)
        memcpy(r.p[i], t->p[(first + i) % 3], sizeof(r.p[i]));
    return r;
}

/* Large ones first, for they tell a plane best. */
static int compare_pieces(const void *a, const void *b) {
    const wall_piece *x = a, *y = b;
    if (x->area != y->area)
        return x->area > y->area ? -1 : 1;
    int c = compare_doubles(x->t.p[0], y->t.p[0], 9);
    return c ? c : (x->given > y->given) - (x->given < y->given);
}

wall_plane wall_plane_make(const double c[3], const double n[3]) {
    wall_plane p;
    double length = sqrt(dot3(n, n)), level = hypot(n[0], n[1]);
    for (int k = 0; k < 3; k++) {
        p.c[k] = c[k];
        p.n[k] = n[k] / length;
    }
    bool flat = !(level > 1e-9 * length);
    p.u[0] = flat ? 1 : -n[1] / level;
    p.u[1] = flat ? 0 : n[0] / level;
    p.u[2] = 0;
    cross3(p.n, p.u, p.v);
    return p;
}

double wall_plane_at(const wall_plane *plane, const double p[3], double uv[2]) {
    double d[3];
    sub3(p, plane->c, d);
    uv[0] = dot3(d, plane->u);
    uv[1] = dot3(d, plane->v);
    return dot3(d, plane->n);
}

static wall_piece piece_of(const wall_triangle *given, uint32_t index) {
    wall_piece p = { .t = turned(given), .given = index, .facet = NO_FACET };
    double a[3], b[3], n[3], longest = 0;
    sub3(p.t.p[1], p.t.p[0], a);
    sub3(p.t.p[2], p.t.p[0], b);
    cross3(a, b, n);
    double length = sqrt(dot3(n, n));
    for (int i = 0; i < 3; i++) {
        double d[3];
        sub3(p.t.p[(i + 1) % 3], p.t.p[i], d);
        longest = fmax(longest, sqrt(dot3(d, d)));
    }
    p.area = 0.5 * length;
    p.thin = longest > 0 ? length / longest : 0;
    for (int k = 0; k < 3; k++) {
        p.n[k] = length > 0 ? n[k] / length : 0;
        p.lo[k] = fmin(fmin(p.t.p[0][k], p.t.p[1][k]), p.t.p[2][k]);
        p.hi[k] = fmax(fmax(p.t.p[0][k], p.t.p[1][k]), p.t.p[2][k]);
    }
    return p;
}

/* Is a gap between two triangles, seen in the plane of the first, wider than GAP? One of their sides then parts them.
 */
static bool apart(const double a[3][2], const double b[3][2]) {
    for (int of = 0; of < 2; of++)
        for (int i = 0; i < 3; i++) {
            const double(*t)[2] = of ? b : a;
            double x = t[(i + 1) % 3][1] - t[i][1], y = t[i][0] - t[(i + 1) % 3][0];
            double gap = WINDOW_GAP_MM / 1000 * sqrt(x * x + y * y); /* d are as many times as long, too */
            double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
            if (!(gap > 0))
                continue;
            for (int k = 0; k < 3; k++) {
                double d[2] = { a[k][0] * x + a[k][1] * y, b[k][0] * x + b[k][1] * y };
                for (int j = 0; j < 2; j++) {
                    lo[j] = NOC_MIN(lo[j], d[j]);
                    hi[j] = NOC_MAX(hi[j], d[j]);
                }
            }
            if (lo[0] - hi[1] > gap || lo[1] - hi[0] > gap)
                return true;
        }
    return false;
}

/* Does all of b lie in the plane, facing as it does? A sliver's own normal tells little. */
static bool in_plane(const wall_plane *plane, const wall_piece *b) {
    double uv[2], least = b->thin < 2 * WINDOW_MERGE_MM / 1000 ? 0 : cos(WINDOW_MERGE_DEG * M_PI / 180);
    bool in = dot3(plane->n, b->n) > least;
    for (int i = 0; in && i < 3; i++)
        in = fabs(wall_plane_at(plane, b->t.p[i], uv)) <= WINDOW_MERGE_MM / 1000;
    return in;
}

/* Of two whose boxes do. */
static bool touch(const wall_piece *a, const wall_piece *b, const wall_plane *of_a, const wall_plane *of_b) {
    double p[3][2], q[3][2];
    if (!(dot3(a->n, b->n) > 0))
        return false;
    const wall_plane *plane = a->area >= b->area ? of_a : of_b; /* of the larger one */
    if (!in_plane(plane, plane == of_a ? b : a))
        return false;
    for (int i = 0; i < 3; i++) {
        wall_plane_at(plane, a->t.p[i], p[i]);
        wall_plane_at(plane, b->t.p[i], q[i]);
    }
    return !apart(p, q);
}

static bool boxes_touch(const wall_piece *a, const wall_piece *b) {
    for (int k = 0; k < 3; k++)
        if (a->lo[k] - b->hi[k] > WINDOW_MERGE_MM / 1000 || b->lo[k] - a->hi[k] > WINDOW_MERGE_MM / 1000)
            return false;
    return true;
}

/* Pieces are taken into a facet in an order of their own: along the longer level axis. */
typedef struct ordered_piece {
    double lo;
    uint32_t piece;
} ordered_piece;

static int compare_ordered(const void *a, const void *b) {
    const ordered_piece *x = a, *y = b;
    if (x->lo != y->lo)
        return x->lo < y->lo ? -1 : 1;
    return (x->piece > y->piece) - (x->piece < y->piece);
}

/* What facets grow by. */
typedef struct growth {
    wall_facets *facets;
    wall_plane *planes; /* of each piece */
    uint32_t *rank;     /* of each piece in the order */
    near_pieces *near;
    near_found found;
} growth;

static void free_growth(growth *g) {
    free(g->planes);
    free(g->rank);
    near_pieces_free(g->near);
    array_free(&g->found);
}

static bool rank_pieces(const wall_piece *pieces, size_t count, uint32_t *rank) {
    ordered_piece *items = noc_alloc(NOC_MAX(count, 1u) * sizeof(*items));
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    if (!items)
        return false;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], pieces[i].lo[k]);
            hi[k] = fmax(hi[k], pieces[i].hi[k]);
        }
    int axis = hi[1] - lo[1] > hi[0] - lo[0];
    for (size_t i = 0; i < count; i++)
        items[i] = (ordered_piece){ pieces[i].lo[axis], (uint32_t)i };
    qsort(items, count, sizeof(*items), compare_ordered);
    for (size_t i = 0; i < count; i++)
        rank[items[i].piece] = (uint32_t)i;
    free(items);
    return true;
}

static bool start_growth(growth *g, size_t count) {
    const wall_piece *pieces = g->facets->pieces.data;
    g->planes = noc_alloc(NOC_MAX(count, 1u) * sizeof(*g->planes));
    g->rank = noc_alloc(NOC_MAX(count, 1u) * sizeof(*g->rank));
    if (!g->planes || !g->rank || !(g->near = near_pieces_make(pieces, count)))
        return false;
    for (size_t i = 0; i < count; i++)
        g->planes[i] = wall_plane_make(pieces[i].t.p[0], pieces[i].n);
    return rank_pieces(pieces, count, g->rank);
}

static int compare_ranks(const void *a, const void *b, void *ranks) {
    const uint32_t *rank = ranks, x = rank[*(const uint32_t *)a], y = rank[*(const uint32_t *)b];
    return (x > y) - (x < y);
}

/* Of two pieces; the one that comes first in the order is the first. */
static bool ranked_touch(const growth *g, uint32_t a, uint32_t b) {
    const wall_piece *pieces = g->facets->pieces.data;
    uint32_t first = g->rank[a] < g->rank[b] ? a : b, second = first == a ? b : a;
    return boxes_touch(&pieces[first], &pieces[second]) &&
           touch(&pieces[first], &pieces[second], &g->planes[first], &g->planes[second]);
}

/* Plane and extent of a facet whose pieces are known. */
static void settle_facet(const wall_facets *w, facet *f) {
    double n[3] = { 0 }, c[3] = { 0 };
    f->area = 0;
    for (uint32_t i = f->first; i < f->first + f->count; i++) {
        const wall_piece *p = &w->pieces.data[w->by_facet.data[i]];
        f->area += p->area;
        for (int k = 0; k < 3; k++) {
            n[k] += p->area * p->n[k];
            c[k] += p->area * (p->t.p[0][k] + p->t.p[1][k] + p->t.p[2][k]) / 3;
        }
    }
    for (int k = 0; k < 3; k++)
        c[k] /= f->area;
    f->plane = wall_plane_make(c, n);
    for (int k = 0; k < 2; k++) {
        f->lo[k] = INFINITY;
        f->hi[k] = -INFINITY;
    }
    for (uint32_t i = f->first; i < f->first + f->count; i++)
        for (int j = 0; j < 3; j++) {
            double uv[2];
            wall_plane_at(&f->plane, w->pieces.data[w->by_facet.data[i]].t.p[j], uv);
            for (int k = 0; k < 2; k++) {
                f->lo[k] = fmin(f->lo[k], uv[k]);
                f->hi[k] = fmax(f->hi[k], uv[k]);
            }
        }
}

static bool add_piece(growth *g, uint32_t piece, uint32_t number) {
    g->facets->pieces.data[piece].facet = number;
    near_pieces_take(g->near, piece);
    return array_push(&g->facets->by_facet, piece);
}

/* What lies in the plane and touches a piece, as far as it has no facet. */
static bool add_neighbours(growth *g, uint32_t at, const wall_plane *plane, uint32_t number) {
    const wall_piece *pieces = g->facets->pieces.data;
    if (!near_pieces_find(g->near, &pieces[at], plane, &g->found, &g->facets->looked_at))
        return false;
    size_t kept = 0;
    g->facets->cut = g->facets->most_looks && g->facets->looked_at > g->facets->most_looks;
    for (size_t i = 0; i < g->found.len; i++) {
        uint32_t b = g->found.data[i];
        if (in_plane(plane, &pieces[b]) && ranked_touch(g, at, b))
            g->found.data[kept++] = b;
    }
    if (kept)
        qsort_r(g->found.data, kept, sizeof(*g->found.data), compare_ranks, g->rank);
    bool ok = true;
    for (size_t i = 0; ok && i < kept; i++)
        ok = add_piece(g, g->found.data[i], number);
    return ok;
}

/* From a piece on all that hangs together in its plane. */
static bool grow(growth *g, uint32_t seed) {
    wall_facets *w = g->facets;
    uint32_t number = (uint32_t)w->facets.len;
    facet f = { .first = (uint32_t)w->by_facet.len };
    bool ok = add_piece(g, seed, number);
    for (size_t done = f.first; ok && done < w->by_facet.len && !w->cut; done++)
        ok = add_neighbours(g, w->by_facet.data[done], &g->planes[seed], number);
    if (!ok)
        return false;
    f.count = (uint32_t)w->by_facet.len - f.first;
    settle_facet(w, &f);
    return array_push(&w->facets, f);
}

bool wall_facets_find(const wall_triangle *walls, size_t count, wall_facets *out) {
    size_t some = 0;
    growth g = { .facets = out };
    out->pieces.len = out->facets.len = out->by_facet.len = out->looked_at = 0;
    out->cut = false;
    if (!array_reserve(&out->pieces, count))
        return false;
    for (size_t i = 0; i < count; i++)
        out->pieces.data[out->pieces.len++] = piece_of(&walls[i], (uint32_t)i);
    if (count)
        qsort(out->pieces.data, count, sizeof(*out->pieces.data), compare_pieces);
    while (some < count && out->pieces.data[some].area > 1e-6)
        some++;
    bool ok = start_growth(&g, some);
    for (size_t i = 0; ok && i < some && !out->cut; i++)
        ok = out->pieces.data[i].facet != NO_FACET || grow(&g, (uint32_t)i);
    free_growth(&g);
    return ok;
}

void wall_facets_free(wall_facets *f) {
    array_free(&f->pieces);
    array_free(&f->facets);
    array_free(&f->by_facet);
}
