/* Facets to strips: a curved wall, which comes in narrow facets side by side, is unrolled. */
#include "city/windows/parts.h"

#define UPRIGHT 0.05 /* of a normal: curved walls are unrolled where they lean less */

typedef struct end {
    double p[2], lo, hi; /* where a facet begins or ends, seen from above; its heights */
} end;

/* The way a facet's side looks from above. */
static end end_of(const facet *f, int right) {
    double u = right ? f->hi[0] : f->lo[0];
    return (end){ { f->plane.c[0] + u * f->plane.u[0], f->plane.c[1] + u * f->plane.u[1] },
                  f->plane.c[2] + f->lo[1],
                  f->plane.c[2] + f->hi[1] };
}

typedef struct join {
    double turn; /* cosine of the angle between the facets */
    uint32_t left, right;
} join;

static int compare_joins(const void *a, const void *b) {
    const join *x = a, *y = b;
    if (x->turn != y->turn)
        return x->turn > y->turn ? -1 : 1;
    if (x->left != y->left)
        return x->left < y->left ? -1 : 1;
    return (x->right > y->right) - (x->right < y->right);
}

/* Does the facet b go on where a ends? */
static bool goes_on(const facet *a, const facet *b) {
    end x = end_of(a, 1), y = end_of(b, 0);
    double shared = fmin(x.hi, y.hi) - fmax(x.lo, y.lo), least = fmin(x.hi - x.lo, y.hi - y.lo);
    return hypot(x.p[0] - y.p[0], x.p[1] - y.p[1]) <= WINDOW_MERGE_MM / 1000 && shared >= 0.5 * least &&
           dot3(a->plane.n, b->plane.n) >= cos(WINDOW_CURVE_DEG * M_PI / 180);
}

typedef struct start_item {
    double x;
    uint32_t facet;
} start_item;

static int compare_starts(const void *a, const void *b) {
    const start_item *x = a, *y = b;
    if (x->x != y->x)
        return x->x < y->x ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

typedef NOC_ARRAY(join) join_list;

/* All joins of narrow, upright facets: candidates begin where another ends, so they are found by their x. */
static bool find_joins(const wall_facets *f, double cell, join_list *joins) {
    size_t n = 0;
    start_item *starts = noc_alloc(NOC_MAX(f->facets.len, 1u) * sizeof(*starts));
    if (!starts)
        return false;
    for (size_t i = 0; i < f->facets.len; i++) {
        const facet *a = &f->facets.data[i];
        if (fabs(a->plane.n[2]) < UPRIGHT && a->hi[0] - a->lo[0] < WINDOW_CURVE_CELLS * cell)
            starts[n++] = (start_item){ end_of(a, 0).p[0], (uint32_t)i };
    }
    qsort(starts, n, sizeof(*starts), compare_starts);
    bool ok = true;
    for (size_t i = 0; i < n; i++) {
        const facet *a = &f->facets.data[starts[i].facet];
        double x = end_of(a, 1).p[0];
        size_t low = 0, high = n;
        while (low < high) {
            size_t middle = (low + high) / 2;
            if (starts[middle].x < x - WINDOW_MERGE_MM / 1000)
                low = middle + 1;
            else
                high = middle;
        }
        for (size_t j = low; ok && j < n && starts[j].x <= x + WINDOW_MERGE_MM / 1000; j++) {
            const facet *b = &f->facets.data[starts[j].facet];
            if (a != b && goes_on(a, b))
                ok = array_push(joins, (join){ dot3(a->plane.n, b->plane.n), starts[i].facet, starts[j].facet });
        }
    }
    free(starts);
    return ok;
}

/* From a facet on to the right; what is in a strip has no way back into one. */
static bool unroll(const wall_facets *f, uint32_t *after, bool *taken, uint32_t at, wall_strips *out) {
    double s = 0;
    for (; at != NO_FACET && !taken[at]; at = after[at]) {
        taken[at] = true;
        if (!array_push(&out->parts, (strip_part){ at, s }))
            return false;
        s += f->facets.data[at].hi[0] - f->facets.data[at].lo[0];
    }
    return array_push(&out->first, (uint32_t)out->parts.len);
}

bool wall_strips_find(const wall_facets *f, double cell, wall_strips *out) {
    size_t n = f->facets.len;
    join_list joins = { 0 };
    uint32_t *after = noc_alloc(NOC_MAX(n, 1u) * sizeof(*after));
    bool *taken = noc_calloc(NOC_MAX(n, 1u), sizeof(*taken)), *led = noc_calloc(NOC_MAX(n, 1u), sizeof(*led));
    out->parts.len = out->first.len = 0;
    bool ok = after && taken && led && array_push(&out->first, 0) && find_joins(f, cell, &joins);
    for (size_t i = 0; ok && i < n; i++)
        after[i] = NO_FACET;
    if (ok && joins.len)
        qsort(joins.data, joins.len, sizeof(*joins.data), compare_joins);
    for (size_t i = 0; ok && i < joins.len; i++) {
        const join *j = &joins.data[i];
        if (after[j->left] == NO_FACET && !led[j->right]) {
            after[j->left] = j->right;
            led[j->right] = true;
        }
    }
    for (int closed = 0; closed < 2; closed++) /* rings, which begin nowhere, are cut at their first facet */
        for (size_t i = 0; ok && i < n; i++)
            if (!taken[i] && (closed || !led[i]))
                ok = unroll(f, after, taken, (uint32_t)i, out);
    array_free(&joins);
    free(after);
    free(taken);
    free(led);
    return ok;
}

void wall_strips_free(wall_strips *s) {
    array_free(&s->parts);
    array_free(&s->first);
}

strip wall_strip_get(const wall_facets *f, const wall_strips *s, size_t index) {
    strip r = { .parts = s->parts.data + s->first.data[index],
                .count = s->first.data[index + 1] - s->first.data[index],
                .lo = INFINITY,
                .hi = -INFINITY };
    for (size_t i = 0; i < r.count; i++) {
        const facet *a = &f->facets.data[r.parts[i].facet];
        r.length = r.parts[i].s + a->hi[0] - a->lo[0];
        r.lo = fmin(r.lo, a->plane.c[2] + a->lo[1]);
        r.hi = fmax(r.hi, a->plane.c[2] + a->hi[1]);
    }
    return r;
}

void wall_strip_place(const wall_facets *f, const strip *s, double along, double t, double p[3],
                      const wall_plane **at) {
    size_t i = 0;
    while (i + 1 < s->count && s->parts[i + 1].s <= along)
        i++;
    const facet *a = &f->facets.data[s->parts[i].facet];
    double u = along - s->parts[i].s + a->lo[0], v = t - a->plane.c[2];
    for (int k = 0; k < 3; k++)
        p[k] = a->plane.c[k] + u * a->plane.u[k] + v * a->plane.v[k];
    if (at)
        *at = &a->plane;
}
