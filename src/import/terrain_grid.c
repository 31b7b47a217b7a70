#include "import/terrain_grid.h"

#include <math.h>

#define MOST_ERROR 1e5 /* m */

/* Samples stand in a square whose side is a power of two. It is split into triangles whose longest side is halved again
 * and again, at a sample. A sample in the middle of such a side costs the distance to that side, or more: what the
 * samples cost that come next and would stand on its triangles' other sides. So no triangle is split whose neighbour is
 * not, and there are no cracks. */

static float at(const terrain_grid *g, size_t x, size_t y) {
    return x < g->width && y < g->height ? g->z[y * g->width + x] : NAN;
}

static float *error_at(const terrain_grid *g, size_t x, size_t y) { return &g->error[y * (g->size + 1) + x]; }

static size_t square(size_t width, size_t height) {
    size_t size = 1;
    while (size + 1 < NOC_MAX(width, height))
        size *= 2;
    return size;
}

double terrain_grid_bytes(size_t width, size_t height) {
    double side = (double)square(width, height) + 1;
    return sizeof(float) * side * side;
}

/* Of a sample in the middle of the side from a to b. Where some of the three are there and some are not, an edge of the
 * ground runs, which is kept. */
static float own_error(float a, float b, float middle) {
    int missing = !isfinite(a) + !isfinite(b) + !isfinite(middle);
    return missing == 3 ? 0 : missing ? INFINITY : fabsf(middle - (a + b) / 2);
}

static void widen(const terrain_grid *g, float *error, size_t x, size_t y, size_t step) {
    if (x >= step && x + step <= g->size && y >= step && y + step <= g->size) {
        *error = fmaxf(*error, fmaxf(*error_at(g, x - step, y - step), *error_at(g, x + step, y - step)));
        *error = fmaxf(*error, fmaxf(*error_at(g, x - step, y + step), *error_at(g, x + step, y + step)));
        return;
    }
    for (int k = 0; k < 4; k++) { /* at the square's sides */
        size_t i = k & 1 ? x + step : x - step, j = k & 2 ? y + step : y - step;
        if (i <= g->size && j <= g->size) /* or wrapped */
            *error = fmaxf(*error, *error_at(g, i, j));
    }
}

/* Middles of the sides of cells of 2 s. */
static void measure_sides(const terrain_grid *g, size_t s) {
    for (size_t y = 0; y <= g->size; y += s)
        for (size_t x = (y / s) % 2 ? 0 : s; x <= g->size; x += 2 * s) {
            bool level = (x / s) % 2;
            float *error = error_at(g, x, y), z = at(g, x, y);
            *error =
                level ? own_error(at(g, x - s, y), at(g, x + s, y), z) : own_error(at(g, x, y - s), at(g, x, y + s), z);
            if (s > 1)
                widen(g, error, x, y, s / 2);
        }
}

/* Middles of cells of 2 s: of the diagonal that leads through the middle of the next larger cell. */
static void measure_middles(const terrain_grid *g, size_t s) {
    for (size_t y = s; y <= g->size; y += 2 * s)
        for (size_t x = s; x <= g->size; x += 2 * s) {
            bool falls = (x / (2 * s)) % 2 == (y / (2 * s)) % 2;
            float *error = error_at(g, x, y), z = at(g, x, y);
            *error = falls ? own_error(at(g, x - s, y - s), at(g, x + s, y + s), z)
                           : own_error(at(g, x - s, y + s), at(g, x + s, y - s), z);
            *error = fmaxf(*error, fmaxf(*error_at(g, x - s, y), *error_at(g, x + s, y)));
            *error = fmaxf(*error, fmaxf(*error_at(g, x, y - s), *error_at(g, x, y + s)));
        }
}

bool terrain_grid_measure(terrain_grid *g) {
    g->size = square(g->width, g->height);
    g->error = noc_alloc_large((g->size + 1) * (g->size + 1), sizeof(*g->error));
    for (size_t s = 1; g->error && 2 * s <= g->size; s *= 2) {
        measure_sides(g, s);
        measure_middles(g, s);
    }
    return g->error != NULL;
}

typedef struct walk {
    const terrain_grid *g;
    double error;
    size_t count;
    bool (*emit)(void *ctx, const uint32_t corners[3][2]);
    void *ctx;
} walk;

/* a and b end the longest side, c lies opposite. */
static bool split(walk *w, const uint32_t a[2], const uint32_t b[2], const uint32_t c[2]) {
    const uint32_t middle[2] = { (a[0] + b[0]) / 2, (a[1] + b[1]) / 2 };
    bool smallest = (a[0] + b[0]) % 2 || (a[1] + b[1]) % 2;
    if (!smallest && (double)*error_at(w->g, middle[0], middle[1]) > w->error)
        return split(w, c, a, middle) && split(w, b, c, middle);
    if (!isfinite(at(w->g, a[0], a[1])) || !isfinite(at(w->g, b[0], b[1])) || !isfinite(at(w->g, c[0], c[1])))
        return true;
    w->count++;
    const uint32_t corners[3][2] = { { a[0], a[1] }, { b[0], b[1] }, { c[0], c[1] } };
    return !w->emit || w->emit(w->ctx, corners);
}

static bool split_square(walk *w) {
    const uint32_t n = (uint32_t)w->g->size, p[4][2] = { { 0, 0 }, { n, n }, { n, 0 }, { 0, n } };
    return split(w, p[0], p[1], p[2]) && split(w, p[1], p[0], p[3]);
}

size_t terrain_grid_count(const terrain_grid *g, double error) {
    walk w = { .g = g, .error = error };
    split_square(&w);
    return w.count;
}

double terrain_grid_error(const terrain_grid *g, double error, size_t triangles) {
    enum { STEPS = 8 };
    double low = error, high = error;
    if (terrain_grid_count(g, error) <= triangles)
        return error;
    triangles = NOC_MAX(triangles, 2 * terrain_grid_count(g, MOST_ERROR)); /* edges of holes cost what they cost */
    for (high = fmax(2 * high, 1e-3); high < MOST_ERROR && terrain_grid_count(g, high) > triangles; high *= 2)
        low = high;
    for (int i = 0; i < STEPS; i++) {
        double middle = (low + high) / 2;
        if (terrain_grid_count(g, middle) > triangles)
            low = middle;
        else
            high = middle;
    }
    return high;
}

bool terrain_grid_emit(const terrain_grid *g, double error, bool (*emit)(void *ctx, const uint32_t corners[3][2]),
                       void *ctx) {
    walk w = { .g = g, .error = error, .emit = emit, .ctx = ctx };
    return split_square(&w);
}

void terrain_grid_free(terrain_grid *g) {
    free(g->z);
    free(g->error);
    *g = (terrain_grid){ 0 };
}
