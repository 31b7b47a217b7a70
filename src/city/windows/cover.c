/* Walls of all buildings in a grid seen from above, for short rays before windows. */
#include "city/windows/parts.h"

#define CELL 6.0        /* m */
#define MOST_CELLS 4096 /* that one wall is put into: a longer one is in all */
#define BEGIN 0.1       /* m: what faces as the window does and is nearer is its own wall, given twice */

struct city_cover {
    NOC_ARRAY(float) xyz; /* 9 a triangle */
    uint32_t *first;      /* of each bucket, and the end */
    NOC_ARRAY(uint32_t) ids;
    NOC_ARRAY(uint32_t) everywhere;
    size_t buckets; /* a power of two */
    const noc_scene *ground;
};

#define GROUND (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_GREEN)
#define GROUND_BEFORE 0.4 /* m: where the ground before a window is looked for */
#define GROUND_OVER 0.05  /* m that it may lie over the window's foot */

static size_t bucket_of(const city_cover *c, long x, long y) {
    uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu;
    return (size_t)((h ^ h >> 29) * 0xbf58476d1ce4e5b9u >> 20) & (c->buckets - 1);
}

typedef struct cells {
    long lo[2], hi[2];
} cells;

/* false: too many */
static bool cells_of(const float *t, cells *c) {
    for (int k = 0; k < 2; k++) {
        double lo = fmin(fmin((double)t[k], (double)t[3 + k]), (double)t[6 + k]),
               hi = fmax(fmax((double)t[k], (double)t[3 + k]), (double)t[6 + k]);
        c->lo[k] = (long)floor((lo - 0.01) / CELL);
        c->hi[k] = (long)floor((hi + 0.01) / CELL);
    }
    return (double)(c->hi[0] - c->lo[0] + 1) * (double)(c->hi[1] - c->lo[1] + 1) <= MOST_CELLS;
}

static bool is_upright(const float *t) {
    double a[3], b[3], n[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)t[3 + k] - t[k];
        b[k] = (double)t[6 + k] - t[k];
    }
    cross3(a, b, n);
    return hypot(n[0], n[1]) > fabs(n[2]);
}

/* Does the wall come near the cell, or only its box? */
static bool meets(const float *t, long x, long y) {
    double lo = INFINITY, hi = -INFINITY, a[2] = { t[0], t[1] }, b[2] = { t[3], t[4] };
    if (hypot((double)t[6] - t[0], (double)t[7] - t[1]) > hypot(b[0] - a[0], b[1] - a[1])) {
        b[0] = t[6];
        b[1] = t[7];
    }
    double n[2] = { b[1] - a[1], a[0] - b[0] }, length = hypot(n[0], n[1]), tlo = INFINITY, thi = -INFINITY;
    for (int i = 0; i < 4; i++) {
        double d = ((double)(x + (i & 1)) * CELL - a[0]) * n[0] + ((double)(y + i / 2) * CELL - a[1]) * n[1];
        lo = fmin(lo, d);
        hi = fmax(hi, d);
    }
    for (int i = 0; i < 3; i++) {
        double d = ((double)t[3 * i] - a[0]) * n[0] + ((double)t[3 * i + 1] - a[1]) * n[1];
        tlo = fmin(tlo, d);
        thi = fmax(thi, d);
    }
    return tlo <= hi + 0.01 * length && thi >= lo - 0.01 * length;
}

static bool fill(city_cover *c) {
    size_t n = c->xyz.len / 9, sum = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < n; i++) {
            const float *t = c->xyz.data + 9 * i;
            cells at;
            if (!cells_of(t, &at)) {
                if (!pass && !array_push(&c->everywhere, (uint32_t)i))
                    return false;
                continue;
            }
            for (long y = at.lo[1]; y <= at.hi[1]; y++)
                for (long x = at.lo[0]; x <= at.hi[0]; x++) {
                    if (!meets(t, x, y))
                        continue;
                    size_t b = bucket_of(c, x, y);
                    if (pass)
                        c->ids.data[c->first[b]++] = (uint32_t)i;
                    else
                        c->first[b + 1]++;
                }
        }
        if (pass)
            break;
        for (size_t b = 0; b < c->buckets; b++)
            c->first[b + 1] += c->first[b];
        sum = c->first[c->buckets];
        if (!array_reserve(&c->ids, NOC_MAX(sum, 1u)))
            return false;
        c->ids.len = sum;
    }
    memmove(c->first + 1, c->first, c->buckets * sizeof(*c->first)); /* filling moved each to its end */
    c->first[0] = 0;
    return true;
}

city_cover *city_cover_create(const float *xyz, size_t triangles, const noc_scene *ground) {
    city_cover *c = noc_calloc(1, sizeof(*c));
    size_t n = 0;
    bool ok = c != NULL;
    for (size_t i = 0; i < triangles; i++)
        n += is_upright(xyz + 9 * i);
    ok = ok && array_reserve(&c->xyz, NOC_MAX(9 * n, 1u));
    for (size_t i = 0; ok && i < triangles; i++)
        if (is_upright(xyz + 9 * i)) {
            memcpy(c->xyz.data + c->xyz.len, xyz + 9 * i, 9 * sizeof(*xyz));
            c->xyz.len += 9;
        }
    if (ok)
        for (c->buckets = 64; c->buckets < n; c->buckets *= 2)
            ;
    ok = ok && (c->first = noc_calloc(c->buckets + 1, sizeof(*c->first))) && fill(c);
    if (ok) {
        c->ground = ground;
        return c;
    }
    city_cover_destroy(c);
    return NULL;
}

void city_cover_destroy(city_cover *c) {
    if (!c)
        return;
    array_free(&c->xyz);
    free(c->first);
    array_free(&c->ids);
    array_free(&c->everywhere);
    free(c);
}

/* Where the line o + x d meets the triangle, m. false: nowhere. facing: cosine of its normal with d. */
static bool meet(const float *t, const double o[3], const double d[3], double *x, double *facing) {
    double a[3], b[3], s[3], n[3], q[3], r[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)t[3 + k] - t[k];
        b[k] = (double)t[6 + k] - t[k];
        s[k] = o[k] - t[k];
    }
    cross3(a, b, n);
    double length = sqrt(dot3(n, n)), along = dot3(n, d);
    *facing = length > 0 ? along / length : 0;
    if (fabs(*facing) < 0.2)
        return false;
    cross3(d, b, q);
    cross3(s, a, r);
    double f = 1 / dot3(a, q), u = f * dot3(s, q), v = f * dot3(d, r);
    *x = f * dot3(b, r);
    return u >= -1e-6 && v >= -1e-6 && u + v <= 1 + 1e-6;
}

/* What is asked of a wall that a line meets, so far along it. */
typedef bool meeting(double x, double facing, const double range[2]);

static bool hides(double x, double facing, const double range[2]) {
    (void)range;
    return x <= WINDOW_PARTY_M && (facing < 0 ? x > -WINDOW_PARTY_BEHIND_M : x > BEGIN);
}

static bool between(double x, double facing, const double range[2]) {
    (void)facing;
    return x > range[0] && x < range[1];
}

/* Is there a wall for which `is` holds, on the line from o along the unit vector d, between these distances? */
static bool any(const city_cover *c, const double o[3], const double d[3], const double range[2], meeting *is) {
    double a[2], b[2], x, facing;
    for (int k = 0; k < 2; k++) {
        double p = o[k] + range[0] * d[k], q = o[k] + range[1] * d[k];
        a[k] = fmin(p, q);
        b[k] = fmax(p, q);
    }
    for (long j = (long)floor(a[1] / CELL); j <= (long)floor(b[1] / CELL); j++)
        for (long i = (long)floor(a[0] / CELL); i <= (long)floor(b[0] / CELL); i++) {
            size_t at = bucket_of(c, i, j);
            for (uint32_t k = c->first[at]; k < c->first[at + 1]; k++)
                if (meet(c->xyz.data + 9 * (size_t)c->ids.data[k], o, d, &x, &facing) && is(x, facing, range))
                    return true;
        }
    for (size_t i = 0; i < c->everywhere.len; i++)
        if (meet(c->xyz.data + 9 * (size_t)c->everywhere.data[i], o, d, &x, &facing) && is(x, facing, range))
            return true;
    return false;
}

bool city_cover_meets(const city_cover *c, const double o[3], const double d[3], double from, double to) {
    return any(c, o, d, (double[]){ from, to }, between);
}

/* Is one end of the window's foot under the ground before it? d: the way it faces, level. */
static bool is_buried(const noc_scene *ground, const city_window *w, const double d[3]) {
    double z;
    for (int end = 0; end < 2; end++)
        if (noc_scene_highest(ground, GROUND, w->corner[0] + end * w->edge_u[0] + GROUND_BEFORE * d[0],
                              w->corner[1] + end * w->edge_u[1] + GROUND_BEFORE * d[1], &z) &&
            z > w->corner[2] + GROUND_OVER)
            return true;
    return false;
}

bool city_cover_hides(const city_cover *c, const city_window *w) {
    double n[3];
    if (!c)
        return false;
    cross3(w->edge_u, w->edge_v, n);
    double level = hypot(n[0], n[1]), d[3] = { n[0] / level, n[1] / level, 0 };
    if (c->ground && is_buried(c->ground, w, d))
        return true;
    for (int i = 0; i < 5; i++) {
        double u = i == 4 ? 0.5 : i & 1 ? 0.98 : 0.02, v = i == 4 ? 0.5 : i & 2 ? 0.98 : 0.02, o[3];
        for (int k = 0; k < 3; k++)
            o[k] = w->corner[k] + u * w->edge_u[k] + v * w->edge_v[k];
        if (any(c, o, d, (double[]){ -WINDOW_PARTY_BEHIND_M, WINDOW_PARTY_M }, hides))
            return true;
    }
    return false;
}
