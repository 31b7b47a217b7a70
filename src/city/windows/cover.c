/* Walls of all buildings in a grid seen from above, for short rays before windows. */
#include "city/windows/parts.h"

#define CELL 6.0       /* m */
#define LEVELS 2       /* of cells: those of the second are WIDER times as large */
#define WIDER 16       /* times */
#define MOST_CELLS 256 /* that one wall is put into: one that needs more of the largest is in all */
#define SLACK 0.01     /* m around a wall */
#define BEGIN 0.1      /* m: what faces as the window does and is nearer is its own wall, given twice */

/* A triangle's corners. */
typedef struct cover_wall {
    float p[3][3];
} cover_wall;

struct city_cover {
    NOC_ARRAY(cover_wall) walls;
    uint32_t *first; /* of each bucket, and the end */
    NOC_ARRAY(uint32_t) ids;
    NOC_ARRAY(uint32_t) everywhere;
    size_t buckets; /* a power of two */
    const noc_scene *ground;
};

#define GROUND (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_GREEN)
#define GROUND_BEFORE 0.4 /* m: where the ground before a window is looked for */
#define GROUND_OVER 0.05  /* m that it may lie over the window's foot */

static size_t bucket_of(const city_cover *c, int level, long x, long y) {
    uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)level << 62;
    return (size_t)((h ^ h >> 29) * 0xbf58476d1ce4e5b9u >> 20) & (c->buckets - 1);
}

static double cell_of(int level) { return level ? WIDER * CELL : CELL; }

/* Seen from above: the box around a wall, and the strip along its longest side that it lies in, lo <= n . p <= hi. */
typedef struct wall_outline {
    double box[2][2], n[2], lo, hi;
} wall_outline;

static wall_outline outline_of(const cover_wall *w) {
    double p[3][2], longest = -1;
    wall_outline o = { { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } }, { 0 }, INFINITY, -INFINITY };
    for (int i = 0; i < 6; i++)
        p[i / 2][i % 2] = (double)w->p[i / 2][i % 2];
    for (int i = 0; i < 3; i++) {
        const double *a = p[i], *b = p[(i + 1) % 3];
        double length = hypot(b[0] - a[0], b[1] - a[1]);
        if (length > longest) {
            longest = length;
            o.n[0] = length > 0 ? (b[1] - a[1]) / length : 0;
            o.n[1] = length > 0 ? (a[0] - b[0]) / length : 0;
        }
        for (int k = 0; k < 2; k++) {
            o.box[0][k] = fmin(o.box[0][k], a[k] - SLACK);
            o.box[1][k] = fmax(o.box[1][k], a[k] + SLACK);
        }
    }
    for (int i = 0; i < 3; i++) {
        double d = o.n[0] * p[i][0] + o.n[1] * p[i][1];
        o.lo = fmin(o.lo, d - SLACK);
        o.hi = fmax(o.hi, d + SLACK);
    }
    return o;
}

/* The cells of a row that the wall may be in, from *first to *last. */
static void cells_of_row(const wall_outline *o, double cell, double row, double *first, double *last) {
    double lo = o->box[0][0], hi = o->box[1][0];
    if (fabs(o->n[0]) > 1e-6) {
        double low = fmax(row * cell, o->box[0][1]), high = fmin((row + 1) * cell, o->box[1][1]);
        double y = o->n[1] * low, z = o->n[1] * high;
        double a = (o->lo - fmax(y, z)) / o->n[0], b = (o->hi - fmin(y, z)) / o->n[0];
        lo = fmax(lo, fmin(a, b));
        hi = fmin(hi, fmax(a, b));
    }
    *first = floor(lo / cell);
    *last = floor(hi / cell);
}

/* The buckets of the cells of a level that the wall may be in; more than MOST_CELLS: too many. */
static int buckets_of(const city_cover *c, const wall_outline *o, int level, size_t buckets[MOST_CELLS]) {
    double cell = cell_of(level), end = floor(o->box[1][1] / cell);
    int n = 0;
    for (double row = floor(o->box[0][1] / cell); row <= end; row++) {
        double first, last;
        cells_of_row(o, cell, row, &first, &last);
        if ((double)n + last - first + 1 > MOST_CELLS)
            return MOST_CELLS + 1;
        for (double x = first; x <= last; x++)
            buckets[n++] = bucket_of(c, level, (long)x, (long)row);
    }
    return n;
}

/* 0: it is too large. */
static int place_of(const city_cover *c, const cover_wall *w, size_t buckets[MOST_CELLS]) {
    wall_outline o = outline_of(w);
    for (int level = 0; level < LEVELS; level++) {
        int n = buckets_of(c, &o, level, buckets);
        if (n <= MOST_CELLS)
            return n;
    }
    return 0;
}

static bool fill(city_cover *c) {
    size_t buckets[MOST_CELLS], sum;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < c->walls.len; i++) {
            int n = place_of(c, &c->walls.data[i], buckets);
            if (!n && !pass && !array_push(&c->everywhere, (uint32_t)i))
                return false;
            while (n--)
                if (pass)
                    c->ids.data[c->first[buckets[n]]++] = (uint32_t)i;
                else
                    c->first[buckets[n] + 1]++;
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

/* The edges of a wall from its first corner, and its normal, which is no unit vector. */
static void span(const cover_wall *w, double a[3], double b[3], double n[3]) {
    for (int k = 0; k < 3; k++) {
        a[k] = (double)w->p[1][k] - w->p[0][k];
        b[k] = (double)w->p[2][k] - w->p[0][k];
    }
    cross3(a, b, n);
}

static bool is_upright(const cover_wall *w) {
    double a[3], b[3], n[3];
    span(w, a, b, n);
    return hypot(n[0], n[1]) > fabs(n[2]);
}

city_cover *city_cover_create(const float *xyz, size_t triangles, const noc_scene *ground) {
    city_cover *c = noc_calloc(1, sizeof(*c));
    cover_wall wall;
    bool ok = c != NULL;
    for (size_t i = 0; ok && i < triangles; i++) {
        memcpy(&wall, xyz + 9 * i, sizeof(wall));
        ok = !is_upright(&wall) || array_push(&c->walls, wall);
    }
    if (ok)
        for (c->buckets = 64; c->buckets < c->walls.len; c->buckets *= 2)
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
    array_free(&c->walls);
    free(c->first);
    array_free(&c->ids);
    array_free(&c->everywhere);
    free(c);
}

/* Intersects the ray o + x d, d a unit vector, with the wall. Returns true if the hit distance x is within range, m.
 * *along is negative where the wall faces the ray's origin. */
static bool meet(const cover_wall *w, const double o[3], const double d[3], const double range[2], double *x,
                 double *along) {
    double a[3], b[3], n[3], s[3], q[3], r[3];
    span(w, a, b, n);
    *along = dot3(n, d);
    if (*along * *along < 0.04 * dot3(n, n) || *along == 0)
        return false;
    for (int k = 0; k < 3; k++)
        s[k] = o[k] - w->p[0][k];
    *x = -dot3(n, s) / *along;
    if (!(*x >= range[0] && *x <= range[1]))
        return false;
    cross3(d, b, q);
    cross3(s, a, r);
    double f = 1 / dot3(a, q), u = f * dot3(s, q), v = f * dot3(d, r);
    return u >= -1e-6 && v >= -1e-6 && u + v <= 1 + 1e-6;
}

/* A ray over a range of distances, and which hits count. */
typedef struct short_ray {
    const double *o, *d;
    double range[2];
    bool skip_own; /* hits of walls that face as d does count only beyond BEGIN: nearer is the window's own wall */
    size_t looks;  /* walls tested so far */
} short_ray;

static bool meets_one(const city_cover *c, const uint32_t *ids, size_t count, short_ray *r) {
    double x, along;
    for (size_t i = 0; i < count; i++) {
        r->looks++;
        if (meet(&c->walls.data[ids[i]], r->o, r->d, r->range, &x, &along) &&
            !(r->skip_own && along >= 0 && x <= BEGIN))
            return true;
    }
    return false;
}

static bool meets_any(const city_cover *c, short_ray *r) {
    double a[2], b[2];
    for (int k = 0; k < 2; k++) {
        double p = r->o[k] + r->range[0] * r->d[k], q = r->o[k] + r->range[1] * r->d[k];
        a[k] = fmin(p, q);
        b[k] = fmax(p, q);
    }
    for (int level = 0; level < LEVELS; level++) {
        double cell = cell_of(level);
        for (long j = (long)floor(a[1] / cell); j <= (long)floor(b[1] / cell); j++)
            for (long i = (long)floor(a[0] / cell); i <= (long)floor(b[0] / cell); i++) {
                size_t at = bucket_of(c, level, i, j);
                if (meets_one(c, c->ids.data + c->first[at], c->first[at + 1] - c->first[at], r))
                    return true;
            }
    }
    return meets_one(c, c->everywhere.data, c->everywhere.len, r);
}

bool city_cover_meets(const city_cover *c, const double o[3], const double d[3], double from, double to) {
    return meets_any(c, &(short_ray){ .o = o, .d = d, .range = { from, to } });
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

bool city_cover_hides(const city_cover *c, const city_window *w, size_t *looks) {
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
        short_ray r = { o, d, { -WINDOW_PARTY_BEHIND_M, WINDOW_PARTY_M }, .skip_own = true };
        bool met = meets_any(c, &r);
        *looks += r.looks;
        if (met)
            return true;
    }
    return false;
}
