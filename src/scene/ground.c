/* Vertical rays against the scene, for standing lamps and cameras on it.
 *
 * A uniform grid over x and y. Most triangles lie in a compressed list a cell (offsets, ids), made at the first query;
 * those added later hang on chains over the same cells, until there are as many as the lists hold: then the grid is made
 * anew. So a caller may ask, add, and ask again (every lamp does) at a constant cost a triangle.
 *
 * Queries may come from several threads once the scene is no longer changed: bringing the grid up to date is locked. */
#include "scene/scene.h"

#include <float.h>
#include <math.h>
#include <pthread.h>

typedef struct ground_link {
    uint32_t triangle;
    uint32_t next; /* in links, or NO_LINK */
} ground_link;

#define NO_LINK UINT32_MAX

struct noc_ground {
    double min[2], inv_cell[2];
    int nx, ny;
    uint32_t *offsets; /* nx * ny + 1 */
    uint32_t *ids;
    uint32_t *chains;  /* first link a cell; NULL until a triangle is added */
    NOC_ARRAY(ground_link) links;
    size_t listed;     /* triangles the lists were made of */
    size_t covered;    /* triangles of the scene seen so far; atomic, stored last */
};

static pthread_mutex_t ground_lock = PTHREAD_MUTEX_INITIALIZER;

void noc_ground_free(struct noc_ground *g) {
    if (!g)
        return;
    free(g->offsets);
    free(g->ids);
    free(g->chains);
    array_free(&g->links);
    free(g);
}

static const float *corner(const noc_scene *scene, size_t t, int i) {
    return scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + i];
}

static const noc_material *material_of(const noc_scene *scene, size_t t) {
    return &scene->materials.data[scene->triangle_material.data[t]];
}

/* Something a vertical ray can hit: the shapes of lamps do not count (a lamp does not stand on another's globe), nor what
 * is not rendered. Exactly vertical triangles have no area from above. */
static bool is_obstacle(const noc_scene *scene, size_t t) {
    const noc_material *m = material_of(scene, t);
    if (t - scene->backdrop_first < scene->backdrop_count) /* unsigned: what comes before is far beyond */
        return false;
    if (m->cls == NOC_CLASS_CLOSURE || (m->cls == NOC_CLASS_LAMP && (m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0)))
        return false;
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    return ((double)b[0] - a[0]) * ((double)c[1] - a[1]) != ((double)b[1] - a[1]) * ((double)c[0] - a[0]);
}

/* What a lamp or a person stands on. Water is no ground; a bridge's deck is, where it is given as road or sidewalk. */
#define GROUND_CLASSES                                                                                                 \
    (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_GREEN | 1u << NOC_CLASS_GROUND)

/* The plane is covered with copies of the grid: what lies outside belongs to the cell that it would have in its copy. Lamps that
 * reach beyond their city so fill all cells evenly; in border cells each would be asked about all the others. */
static int64_t cell_of(const struct noc_ground *g, int axis, double x) {
    double c = floor((x - g->min[axis]) * g->inv_cell[axis]);
    return c > -1e15 && c < 1e15 ? (int64_t)c : 0;
}

static size_t wrapped(int64_t cell, int n) { return (size_t)(cell % n + (cell % n < 0 ? n : 0)); }

static size_t index_of(const struct noc_ground *g, int64_t x, int64_t y) {
    return wrapped(y, g->ny) * (size_t)g->nx + wrapped(x, g->nx);
}

static void cells_of(const struct noc_ground *g, const noc_scene *scene, size_t t, int64_t lo[2], int64_t hi[2]) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    for (int k = 0; k < 2; k++) {
        int n = k ? g->ny : g->nx;
        lo[k] = cell_of(g, k, NOC_MIN(a[k], NOC_MIN(b[k], c[k])));
        hi[k] = NOC_MIN(cell_of(g, k, NOC_MAX(a[k], NOC_MAX(b[k], c[k]))), lo[k] + n - 1); /* each cell once */
    }
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Lamps are added while rays are asked for, along one street after the other: they do not say how large the city is. */
static bool is_city(const noc_scene *scene, size_t t) {
    return t - scene->backdrop_first >= scene->backdrop_count && material_of(scene, t)->cls != NOC_CLASS_LAMP;
}

/* Bounds of nearly all triangles of the city, from a sample: one stray triangle far away must not make the cells too
 * large. Of all triangles where there are none but lamps'. */
enum { SAMPLES = 4096 };
static void grid_bounds(struct noc_ground *g, const noc_scene *scene, size_t triangles, float xs[2][SAMPLES], double size[2]) {
    size_t city = 0, n = 0, seen = 0;
    for (size_t t = 0; t < triangles; t++)
        city += is_city(scene, t);
    size_t all = city ? city : triangles, samples = NOC_MIN(all, (size_t)SAMPLES);
    for (size_t t = 0; t < triangles && n < samples; t++) {
        if (city && !is_city(scene, t))
            continue;
        if (seen++ == n * all / samples) {
            for (int k = 0; k < 2; k++)
                xs[k][n] = corner(scene, t, (int)(n % 3))[k];
            n++;
        }
    }
    for (int k = 0; k < 2; k++) {
        qsort(xs[k], n, sizeof(float), compare_floats);
        double lo = n ? xs[k][n / 50] : 0, hi = n ? xs[k][n - 1 - n / 50] : 0, margin = (hi - lo) * 0.08 + 1;
        g->min[k] = lo - margin;
        size[k] = hi - lo + 2 * margin;
    }
}

/* Sets the resolution and counts the list entries it needs. */
static size_t set_resolution(struct noc_ground *g, const noc_scene *scene, const double size[2], double cells) {
    double edge = sqrt(size[0] * size[1] / cells);
    g->nx = (int)NOC_CLAMP(size[0] / edge, 1, 4096);
    g->ny = (int)NOC_CLAMP(size[1] / edge, 1, 4096);
    g->inv_cell[0] = g->nx / size[0];
    g->inv_cell[1] = g->ny / size[1];
    size_t entries = 0;
    for (size_t t = 0; t < g->listed; t++) {
        int64_t lo[2], hi[2];
        if (!is_obstacle(scene, t))
            continue;
        cells_of(g, scene, t, lo, hi);
        entries += (size_t)(hi[0] - lo[0] + 1) * (size_t)(hi[1] - lo[1] + 1);
    }
    return entries;
}

/* Lays an empty grid; returns the list entries it needs. */
static size_t lay_grid(struct noc_ground *g, const noc_scene *scene, size_t triangles, float xs[2][SAMPLES]) {
    double size[2], cells = NOC_CLAMP((double)triangles / 2, 1, 4e6);
    g->listed = g->covered = triangles;
    grid_bounds(g, scene, triangles, xs, size);
    size_t entries = set_resolution(g, scene, size, cells);
    while (entries > 8 * (triangles + 1024) && cells > 16) { /* large triangles: coarser */
        cells /= 4;
        entries = set_resolution(g, scene, size, cells);
    }
    return entries;
}

/* NULL: memory was refused. */
static struct noc_ground *ground_build(const noc_scene *scene, size_t triangles) {
    struct noc_ground *g = noc_calloc(1, sizeof(*g));
    float (*samples)[SAMPLES] = noc_alloc(2 * sizeof(*samples));
    size_t n = 0;
    if (g && samples) {
        size_t entries = lay_grid(g, scene, triangles, samples);
        n = (size_t)g->nx * (size_t)g->ny;
        g->offsets = noc_calloc(n + 1, sizeof(*g->offsets));
        g->ids = noc_alloc(entries * sizeof(*g->ids));
    }
    free(samples);
    if (!g || !g->offsets || !g->ids) {
        noc_ground_free(g);
        return NULL;
    }
    for (int fill = 0; fill < 2; fill++) {
        for (size_t t = 0; t < triangles; t++) {
            int64_t lo[2], hi[2];
            if (!is_obstacle(scene, t))
                continue;
            cells_of(g, scene, t, lo, hi);
            for (int64_t y = lo[1]; y <= hi[1]; y++)
                for (int64_t x = lo[0]; x <= hi[0]; x++) {
                    size_t c = index_of(g, x, y);
                    if (fill)
                        g->ids[--g->offsets[c]] = (uint32_t)t;
                    else
                        g->offsets[c]++;
                }
        }
        if (!fill) /* counts to ends; filling turns ends into beginnings */
            for (size_t c = 1; c <= n; c++)
                g->offsets[c] += g->offsets[c - 1];
    }
    return g;
}

/* Hangs the triangles added since onto the grid; false if the grid should rather be made anew, or memory was refused. */
static bool chain_new(struct noc_ground *g, const noc_scene *scene, size_t triangles) {
    if (triangles - g->covered + g->links.len > g->listed + 4096)
        return false;
    if (!g->chains) {
        size_t n = (size_t)g->nx * (size_t)g->ny;
        if (!(g->chains = noc_alloc(n * sizeof(*g->chains))))
            return false;
        memset(g->chains, 0xff, n * sizeof(*g->chains));
    }
    for (size_t t = g->covered; t < triangles; t++) {
        int64_t lo[2], hi[2];
        if (!is_obstacle(scene, t))
            continue;
        cells_of(g, scene, t, lo, hi);
        if (g->links.len > 4 * (g->listed + 4096)) /* large triangles on a fine grid */
            return false;
        for (int64_t y = lo[1]; y <= hi[1]; y++)
            for (int64_t x = lo[0]; x <= hi[0]; x++) {
                uint32_t *first = &g->chains[index_of(g, x, y)];
                ground_link link = { (uint32_t)t, *first };
                if (!array_push(&g->links, link))
                    return false;
                *first = (uint32_t)g->links.len - 1;
            }
    }
    __atomic_store_n(&g->covered, triangles, __ATOMIC_RELEASE);
    return true;
}

static void tell_refusal(const noc_scene *scene) {
    if (scene->committed)
        noc_error(scene->log, NOC_ERR_MEMORY, "scene: no memory to find the ground of %zu triangles", scene->triangle_light.len);
    else
        noc_scene_out_of_memory((noc_scene *)scene);
}

/* The grid, up to date with the scene; NULL where memory is refused, which is reported. It is a cache, so a const scene may get
 * one. */
static const struct noc_ground *ground_of(const noc_scene *scene) {
    struct noc_ground **slot = &((noc_scene *)scene)->ground;
    struct noc_ground *g = __atomic_load_n(slot, __ATOMIC_ACQUIRE);
    size_t triangles = scene->triangle_light.len;
    if (g && __atomic_load_n(&g->covered, __ATOMIC_ACQUIRE) == triangles)
        return g;
    if (scene->no_memory && !scene->committed)
        return NULL;
    pthread_mutex_lock(&ground_lock);
    g = *slot;
    if (g && g->covered != triangles && !chain_new(g, scene, triangles)) {
        /* no other thread is reading the old grid: it is stale, and everyone who sees that waits at the lock */
        *slot = NULL;
        noc_ground_free(g);
        g = NULL;
    }
    if (!g) {
        g = ground_build(scene, triangles);
        __atomic_store_n(slot, g, __ATOMIC_RELEASE);
    }
    pthread_mutex_unlock(&ground_lock);
    if (!g)
        tell_refusal(scene);
    return g;
}

noc_status noc_ground_ready(const noc_scene *scene) { return ground_of(scene) ? NOC_OK : NOC_ERR_MEMORY; }

/* Twice the signed area of (a, b, p). Exactly antisymmetric in a and b, so that a point on, or very near, an edge that two
 * triangles share lies in at least one of them. */
static double edge(const float *a, const float *b, double x, double y) {
    bool swapped = a[0] > b[0] || (a[0] == b[0] && a[1] > b[1]);
    const float *p = swapped ? b : a, *q = swapped ? a : b;
    double e = ((double)q[0] - p[0]) * (y - p[1]) - ((double)q[1] - p[1]) * (x - p[0]);
    return swapped ? -e : e;
}

static bool triangle_height(const noc_scene *scene, size_t t, double x, double y, double *z) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    double u = edge(b, c, x, y), v = edge(c, a, x, y), w = edge(a, b, x, y), sum = u + v + w;
    bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    if (!inside || sum == 0)
        return false;
    double lo = NOC_MIN(a[2], NOC_MIN(b[2], c[2])), hi = NOC_MAX(a[2], NOC_MAX(b[2], c[2]));
    double h = (u * a[2] + v * b[2] + w * c[2]) / sum;
    *z = NOC_CLAMP(h, lo, hi);
    return true;
}

static void consider(const noc_scene *scene, size_t t, uint32_t classes, double x, double y, double *best) {
    double h;
    if ((classes >> material_of(scene, t)->cls & 1) && triangle_height(scene, t, x, y, &h) && h > *best)
        *best = h;
}

bool noc_scene_highest(const noc_scene *scene, uint32_t classes, double x, double y, double *z) {
    if (!(fabs(x) < 1e8 && fabs(y) < 1e8) || !scene->triangle_light.len)
        return false;
    const struct noc_ground *g = ground_of(scene);
    if (!g)
        return false;
    size_t c = index_of(g, cell_of(g, 0, x), cell_of(g, 1, y));
    double best = -DBL_MAX;
    for (uint32_t i = g->offsets[c]; i < g->offsets[c + 1]; i++)
        consider(scene, g->ids[i], classes, x, y, &best);
    for (uint32_t l = g->chains ? g->chains[c] : NO_LINK; l != NO_LINK; l = g->links.data[l].next)
        consider(scene, g->links.data[l].triangle, classes, x, y, &best);
    if (best == -DBL_MAX)
        return false;
    *z = best;
    return true;
}

size_t noc_ground_load(const noc_scene *scene, double x, double y) {
    const struct noc_ground *g = ground_of(scene);
    if (!g)
        return 0;
    size_t c = index_of(g, cell_of(g, 0, x), cell_of(g, 1, y)), n = g->offsets[c + 1] - g->offsets[c];
    for (uint32_t l = g->chains ? g->chains[c] : NO_LINK; l != NO_LINK; l = g->links.data[l].next)
        n++;
    return n;
}

bool noc_scene_ground(const noc_scene *scene, double x, double y, double *z) {
    if (!scene || !z)
        return false;
    return noc_scene_highest(scene, GROUND_CLASSES, x, y, z);
}

bool noc_scene_top(const noc_scene *scene, double x, double y, double *z) {
    return noc_scene_highest(scene, UINT32_MAX, x, y, z);
}
