/* Ground as it is seen from above: points of a grid, one in each cell at a random place. */
#include "ask/ask.h"

#include <math.h>

enum { CHUNK = 8192 }; /* places at once */

static uint64_t key_of(int32_t x, int32_t y) { return (uint64_t)(uint32_t)x << 32 | (uint32_t)y; }

/* The cell's place; the same wherever it is asked for. */
static void place_of(uint64_t key, double step, double out[2]) {
    uint64_t h = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 29) * 0xbf58476d1ce4e5b9u;
    out[0] = ((double)(int32_t)(key >> 32) + (double)(h >> 40) * 0x1p-24) * step;
    out[1] = ((double)(int32_t)(uint32_t)key + (double)(h >> 16 & 0xffffff) * 0x1p-24) * step;
}

static noc_status push(const asked *a, ask_cells *cells, uint64_t key) {
    return array_push(&cells->keys, key) ? NOC_OK : noc_no_memory(a->log, "region");
}

static double distance2(const double p[2], const float *a, const float *b) {
    double u[2] = { (double)b[0] - a[0], (double)b[1] - a[1] }, w[2] = { p[0] - a[0], p[1] - a[1] };
    double length2 = u[0] * u[0] + u[1] * u[1], t = length2 > 0 ? (w[0] * u[0] + w[1] * u[1]) / length2 : 0;
    t = NOC_CLAMP(t, 0, 1);
    w[0] -= t * u[0];
    w[1] -= t * u[1];
    return w[0] * w[0] + w[1] * w[1];
}

noc_status ask_add_line(const asked *a, const noc_street *street, double beside, ask_cells *cells) {
    double step = cells->step;
    noc_status status = NOC_OK;
    for (size_t i = 0; i + 1 < street->point_count && !status; i++) {
        const float *p = street->points + 2 * i, *q = p + 2;
        int32_t x0 = (int32_t)floor((fminf(p[0], q[0]) - beside) / step), y0;
        int32_t x1 = (int32_t)floor((fmaxf(p[0], q[0]) + beside) / step), y1;
        y0 = (int32_t)floor((fminf(p[1], q[1]) - beside) / step);
        y1 = (int32_t)floor((fmaxf(p[1], q[1]) + beside) / step);
        for (int32_t x = x0; x <= x1 && !status; x++)
            for (int32_t y = y0; y <= y1 && !status; y++) {
                double at[2];
                place_of(key_of(x, y), step, at);
                if (distance2(at, p, q) <= beside * beside)
                    status = push(a, cells, key_of(x, y));
            }
    }
    return status;
}

/* A side of a polygon, its lower end first. */
typedef struct side {
    double low[2], high[2];
} side;

typedef struct sides {
    NOC_ARRAY(side) of;
} sides;

static int by_low_end(const void *a, const void *b) {
    const side *x = a, *y = b;
    return x->low[1] < y->low[1] ? -1 : x->low[1] > y->low[1];
}

/* Level ones are left out: no line to the side crosses them. */
static noc_status sides_of(const asked *a, const noc_rings *rings, sides *out) {
    const double *xy = rings->xy;
    for (size_t r = 0; r < rings->count; xy += 2 * rings->size[r++])
        for (size_t i = 0, n = rings->size[r], j = n - 1; i < n; j = i++) {
            bool up = xy[2 * j + 1] < xy[2 * i + 1];
            const double *low = xy + 2 * (up ? j : i), *high = xy + 2 * (up ? i : j);
            side s = { { low[0], low[1] }, { high[0], high[1] } };
            if (low[1] < high[1] && !array_push(&out->of, s))
                return noc_no_memory(a->log, "region");
        }
    if (out->of.len)
        qsort(out->of.data, out->of.len, sizeof(side), by_low_end);
    return NOC_OK;
}

/* Is it to the right of an odd number of sides? */
static bool inside(const side *of, size_t count, const double p[2]) {
    bool in = false;
    for (size_t i = 0; i < count; i++) {
        const double *a = of[i].low, *b = of[i].high;
        if (a[1] <= p[1] && p[1] < b[1] && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            in = !in;
    }
    return in;
}

/* Row by row, with the sides that a row meets. */
noc_status ask_add_rings(const asked *a, const noc_rings *rings, ask_cells *cells) {
    sides all = { 0 }, met = { 0 };
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY }, step = cells->step;
    noc_status status = sides_of(a, rings, &all);
    for (size_t i = 0; i < all.of.len; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], fmin(all.of.data[i].low[k], all.of.data[i].high[k]));
            hi[k] = fmax(hi[k], fmax(all.of.data[i].low[k], all.of.data[i].high[k]));
        }
    size_t next = 0;
    for (int32_t y = all.of.len ? (int32_t)floor(lo[1] / step) : 0; all.of.len && y * step <= hi[1] && !status; y++) {
        size_t left = 0;
        for (size_t i = 0; i < met.of.len; i++)
            if (met.of.data[i].high[1] > y * step)
                met.of.data[left++] = met.of.data[i];
        met.of.len = left;
        for (; next < all.of.len && all.of.data[next].low[1] <= (y + 1) * step && !status; next++)
            status = array_push(&met.of, all.of.data[next]) ? NOC_OK : noc_no_memory(a->log, "region");
        for (int32_t x = (int32_t)floor(lo[0] / step); x * step <= hi[0] && !status; x++) {
            double at[2];
            place_of(key_of(x, y), step, at);
            if (inside(met.of.data, met.of.len, at))
                status = push(a, cells, key_of(x, y));
        }
    }
    array_free(&all.of);
    array_free(&met.of);
    return status;
}

static int by_key(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

noc_status ask_add_ground(const asked *a, ask_cells *cells, uint32_t classes, size_t *found) {
    double(*xy)[2] = noc_alloc(CHUNK * sizeof(*xy));
    noc_hit *hits = noc_alloc(CHUNK * sizeof(*hits));
    noc_status status = xy && hits ? NOC_OK : noc_no_memory(a->log, "region");
    size_t covered = 0;
    *found = 0;
    if (cells->keys.len)
        qsort(cells->keys.data, cells->keys.len, sizeof(uint64_t), by_key);
    for (size_t i = 0; i < cells->keys.len && !status;) {
        size_t n = 0;
        for (; i < cells->keys.len && n < CHUNK; i++)
            if (!i || cells->keys.data[i] != cells->keys.data[i - 1])
                place_of(cells->keys.data[i], cells->step, xy[n++]);
        status = noc_view_cast_down(a->view, xy, n, classes, hits);
        for (size_t k = 0; k < n && !status; k++) {
            if (!hits[k].hit) {
                covered += hits[k].material >= 0;
                continue;
            }
            noc_patch p = noc_hit_patch(&hits[k], cells->step * cells->step, NULL, NULL);
            status = noc_region_add(a->to, &p, 1);
            ++*found;
        }
    }
    if (*found)
        noc_region_leave_out(a->to, covered);
    free(xy);
    free(hits);
    return status;
}
