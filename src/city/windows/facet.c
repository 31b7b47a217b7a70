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

/* Which pieces touch which: pairs, found by a sweep along the longer level axis. */
typedef struct pair {
    uint32_t a, b;
} pair;
typedef struct pairs {
    NOC_ARRAY(pair) list;
    uint32_t *first, *next_to; /* of each piece: its neighbours are next_to[first[i]] to next_to[first[i + 1]] */
} pairs;

/* Of a piece's box, across the sweep and up: the least coordinates, and the greatest with their signs turned. Rounded
 * outwards, so that the sweep, which reads these alone, passes none over that boxes_touch would keep. */
typedef float sweep_box __attribute__((vector_size(16)));
typedef int64_t sweep_mask __attribute__((vector_size(16)));
#define OUTWARDS 1e-6 /* of the size of a coordinate, and more than floats lose */

typedef struct sweep_item {
    sweep_box box;
    double lo, hi; /* along the sweep */
    uint32_t piece;
} sweep_item;

static int compare_items(const void *a, const void *b) {
    const sweep_item *x = a, *y = b;
    if (x->lo != y->lo)
        return x->lo < y->lo ? -1 : 1;
    return (x->piece > y->piece) - (x->piece < y->piece);
}

static sweep_item item_of(const wall_piece *p, int axis, size_t piece) {
    const double least[4] = { p->lo[!axis], p->lo[2], -p->hi[!axis], -p->hi[2] };
    sweep_item item = { .lo = p->lo[axis], .hi = p->hi[axis], .piece = (uint32_t)piece };
    for (int k = 0; k < 4; k++)
        item.box[k] = (float)(least[k] - OUTWARDS * fabs(least[k]));
    return item;
}

static bool boxes_touch(const wall_piece *a, const wall_piece *b) {
    for (int k = 0; k < 3; k++)
        if (a->lo[k] - b->hi[k] > WINDOW_MERGE_MM / 1000 || b->lo[k] - a->hi[k] > WINDOW_MERGE_MM / 1000)
            return false;
    return true;
}

/* Of the item with those that come behind it. planes: of each piece. */
static bool pairs_of(const wall_facets *f, const sweep_item *item, const sweep_item *end, const wall_plane *planes,
                     pairs *out) {
    const float merge = (float)(1.001 * WINDOW_MERGE_MM / 1000);
    const sweep_box most = { merge - item->box[2], merge - item->box[3], merge - item->box[0], merge - item->box[1] };
    const wall_piece *a = &f->pieces.data[item->piece];
    for (const sweep_item *other = item + 1; other < end && other->lo <= item->hi + WINDOW_MERGE_MM / 1000; other++) {
        sweep_mask far = (sweep_mask)(other->box > most);
        if (far[0] | far[1])
            continue;
        const wall_piece *b = &f->pieces.data[other->piece];
        if (boxes_touch(a, b) && touch(a, b, &planes[item->piece], &planes[other->piece]) &&
            !array_push(&out->list, (pair){ item->piece, other->piece }))
            return false;
    }
    return true;
}

static bool find_pairs(const wall_facets *f, size_t count, const wall_plane *planes, pairs *out) {
    sweep_item *items = noc_alloc_large(NOC_MAX(count, 1u), sizeof(*items)); /* aligned */
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    if (!items)
        return false;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], f->pieces.data[i].lo[k]);
            hi[k] = fmax(hi[k], f->pieces.data[i].hi[k]);
        }
    int axis = hi[1] - lo[1] > hi[0] - lo[0];
    for (size_t i = 0; i < count; i++)
        items[i] = item_of(&f->pieces.data[i], axis, i);
    qsort(items, count, sizeof(*items), compare_items);
    bool ok = true;
    for (size_t i = 0; ok && i < count; i++)
        ok = pairs_of(f, &items[i], items + count, planes, out);
    free(items);
    return ok;
}

/* From pairs to lists of neighbours. */
static bool list_neighbours(size_t count, pairs *p) {
    p->first = noc_calloc(count + 2, sizeof(*p->first));
    p->next_to = noc_alloc((2 * p->list.len + 1) * sizeof(*p->next_to));
    if (!p->first || !p->next_to)
        return false;
    for (size_t i = 0; i < p->list.len; i++) {
        p->first[p->list.data[i].a + 2]++;
        p->first[p->list.data[i].b + 2]++;
    }
    for (size_t i = 2; i < count + 2; i++)
        p->first[i] += p->first[i - 1];
    for (size_t i = 0; i < p->list.len; i++) {
        p->next_to[p->first[p->list.data[i].a + 1]++] = p->list.data[i].b;
        p->next_to[p->first[p->list.data[i].b + 1]++] = p->list.data[i].a;
    }
    return true;
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

/* From a piece on all that hangs together in its plane. */
static bool grow(wall_facets *w, const pairs *p, const wall_plane *plane, uint32_t seed) {
    uint32_t number = (uint32_t)w->facets.len;
    facet f = { .first = (uint32_t)w->by_facet.len };
    w->pieces.data[seed].facet = number;
    if (!array_push(&w->by_facet, seed))
        return false;
    for (size_t done = f.first; done < w->by_facet.len; done++) {
        uint32_t at = w->by_facet.data[done];
        for (uint32_t i = p->first[at]; i < p->first[at + 1]; i++) {
            wall_piece *b = &w->pieces.data[p->next_to[i]];
            if (b->facet != NO_FACET || !in_plane(plane, b))
                continue;
            b->facet = number;
            if (!array_push(&w->by_facet, p->next_to[i]))
                return false;
        }
    }
    f.count = (uint32_t)w->by_facet.len - f.first;
    settle_facet(w, &f);
    return array_push(&w->facets, f);
}

bool wall_facets_find(const wall_triangle *walls, size_t count, wall_facets *out) {
    size_t some = 0;
    pairs p = { 0 };
    out->pieces.len = out->facets.len = out->by_facet.len = 0;
    if (!array_reserve(&out->pieces, count))
        return false;
    for (size_t i = 0; i < count; i++)
        out->pieces.data[out->pieces.len++] = piece_of(&walls[i], (uint32_t)i);
    if (count)
        qsort(out->pieces.data, count, sizeof(*out->pieces.data), compare_pieces);
    while (some < count && out->pieces.data[some].area > 1e-6)
        some++;
    wall_plane *planes = noc_alloc(NOC_MAX(some, 1u) * sizeof(*planes));
    for (size_t i = 0; planes && i < some; i++)
        planes[i] = wall_plane_make(out->pieces.data[i].t.p[0], out->pieces.data[i].n);
    bool ok = planes && find_pairs(out, some, planes, &p) && list_neighbours(some, &p);
    for (size_t i = 0; ok && i < some; i++)
        ok = out->pieces.data[i].facet != NO_FACET || grow(out, &p, &planes[i], (uint32_t)i);
    free(planes);
    array_free(&p.list);
    free(p.first);
    free(p.next_to);
    return ok;
}

void wall_facets_free(wall_facets *f) {
    array_free(&f->pieces);
    array_free(&f->facets);
    array_free(&f->by_facet);
}
