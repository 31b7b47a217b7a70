/* Vertical rays against the scene, for standing lamps and cameras on it.
 *
 * Grids over x and y, one a level: their cells are twice as large from level to level. A triangle lies on the level
 * whose cells are just as large as it is, or larger: in four cells at most. Cells are found by a hash, so what a ray
 * looks at depends on what lies near it, and not on how far the scene reaches: lamps on two continents cost what those
 * of two towns do.
 *
 * Most triangles lie in a compressed list a bucket (offsets, ids), made at the first query; those added later hang on
 * chains over the same buckets, until there are as many as the lists hold: then all is made anew. So a caller may ask,
 * add, and ask again (every lamp does) at a constant cost a triangle.
 *
 * Where many long and thin triangles overlap (a fan over a large round place), each is in the finer cells that it does
 * touch instead. Long lists are sorted by the highest corner, so that a ray through a stack of triangles ends at the
 * first that no other reaches over.
 *
 * Bodies of lamps lie in cells of their own (body.c).
 *
 * Queries may come from several threads while the scene is not changed: bringing the grids up to date is locked. Models
 * and their instances are no ground, which does not move.
 */
#include "scene/scene.h"

#include <float.h>
#include <math.h>
#include <pthread.h>

typedef struct ground_link {
    uint32_t triangle;
    uint32_t next; /* in links, or NO_LINK */
} ground_link;

#define NO_LINK UINT32_MAX
#define LEVELS 48
#define FINEST -22 /* cells are 2^(level + FINEST) m large: from a quarter of a micrometre to more than any scene */

struct noc_ground {
    uint64_t secret;
    uint64_t levels;          /* bit: a triangle lies there */
    uint32_t classes[LEVELS]; /* of the triangles that lie on each */
    double cells_a_metre[LEVELS];
    size_t buckets;    /* a power of two */
    uint32_t *offsets; /* buckets + 1 */
    uint32_t *ids;
    uint32_t *chains; /* first link a bucket; NULL until a triangle is added */
    NOC_ARRAY(ground_link) links;
    size_t listed;  /* triangles the lists were made of */
    size_t covered; /* triangles of the scene seen so far; atomic, stored last */
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

/* Something a vertical ray can hit: the shapes of lamps do not count (a lamp does not stand on another's globe), nor
 * what is not rendered. Exactly vertical triangles have no area from above. */
static bool is_obstacle(const noc_scene *scene, size_t t) {
    const noc_material *m = material_of(scene, t);
    if (m->cls == NOC_CLASS_CLOSURE ||
        (m->cls == NOC_CLASS_LAMP && (m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0)))
        return false;
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    return ((double)b[0] - a[0]) * ((double)c[1] - a[1]) != ((double)b[1] - a[1]) * ((double)c[0] - a[0]);
}

/* The next obstacle of the city from triangle t on; `end` if there is none before. mesh: the one that t is of. */
static size_t next_obstacle(const noc_scene *scene, size_t *mesh, size_t t, size_t end) {
    while (t < end) {
        const noc_scene_mesh *m = &scene->meshes.data[*mesh];
        size_t mesh_end = (size_t)m->first_triangle + m->triangle_count;
        for (; noc_mesh_in_city(scene, m) && t < mesh_end; t++)
            if (is_obstacle(scene, t))
                return t;
        t = mesh_end;
        ++*mesh;
    }
    return end;
}

/* What a lamp or a person stands on. Water is no ground; a bridge's deck is, where it is given as road or sidewalk. */
#define GROUND_CLASSES                                                                                                 \
    (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_GREEN |               \
     1u << NOC_CLASS_GROUND)

/* Keyed with what a file's author does not know: places far apart that share a bucket cannot be chosen. What lies over
 * one place shares one all the same. */
static size_t bucket_of(const struct noc_ground *g, int level, int64_t x, int64_t y) {
    uint64_t h =
        (uint64_t)x * 0x9e3779b97f4a7c15u + (uint64_t)y * 0xc2b2ae3d27d4eb4fu + (uint64_t)level * 0x165667b19e3779f9u;
    h = (h ^ g->secret) * 0xd6e8feb86659fd93u;
    return (h ^ h >> 32) & (g->buckets - 1);
}

enum { MOST_CELLS = 128 };
#define CROWDED 1024 /* triangles of a bucket, beyond which they are put into finer cells */
#define LONG 64      /* triangles of a bucket, beyond which they are sorted */

/* The buckets that a triangle is in, 1 to 4, and its level. */
static int buckets_of(const struct noc_ground *g, const noc_scene *scene, size_t t, size_t buckets[MOST_CELLS],
                      int *level) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    double lo[2], hi[2];
    int n = 0, exponent;
    for (int k = 0; k < 2; k++) {
        lo[k] = NOC_MIN(a[k], NOC_MIN(b[k], c[k]));
        hi[k] = NOC_MAX(a[k], NOC_MAX(b[k], c[k]));
    }
    frexp(NOC_MAX(hi[0] - lo[0], hi[1] - lo[1]), &exponent); /* it is smaller than 2^exponent */
    *level = NOC_CLAMP(exponent - FINEST, 0, LEVELS - 1);
    double scale = g->cells_a_metre[*level];
    for (int64_t y = (int64_t)floor(lo[1] * scale); y <= (int64_t)floor(hi[1] * scale); y++)
        for (int64_t x = (int64_t)floor(lo[0] * scale); x <= (int64_t)floor(hi[0] * scale); x++)
            buckets[n++] = bucket_of(g, *level, x, y);
    return n;
}

/* Widens [lo, hi] by the x at which the line from a to b has that y, where it reaches it. */
static void widen_at(const double *a, const double *b, double y, double *lo, double *hi) {
    if ((a[1] < y) == (b[1] < y))
        return;
    double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    *lo = NOC_MIN(*lo, x);
    *hi = NOC_MAX(*hi, x);
}

/* The cells of a level that a triangle touches, row by row; more than MOST_CELLS: too many. */
static int touched(const struct noc_ground *g, const noc_scene *scene, size_t t, int level,
                   size_t buckets[MOST_CELLS]) {
    double p[3][2], scale = g->cells_a_metre[level], side = 1 / scale;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            p[i][k] = corner(scene, t, i)[k];
    double first = floor(NOC_MIN(p[0][1], NOC_MIN(p[1][1], p[2][1])) * scale);
    double last = floor(NOC_MAX(p[0][1], NOC_MAX(p[1][1], p[2][1])) * scale);
    int n = 0;
    for (double y = first; y <= last && n <= MOST_CELLS; y++) {
        double lo = INFINITY, hi = -INFINITY, slack;
        for (int i = 0; i < 3; i++) {
            const double *a = p[i], *b = p[(i + 1) % 3];
            if (a[1] >= y * side && a[1] <= (y + 1) * side) {
                lo = NOC_MIN(lo, a[0]);
                hi = NOC_MAX(hi, a[0]);
            }
            widen_at(a, b, y * side, &lo, &hi);
            widen_at(a, b, (y + 1) * side, &lo, &hi);
        }
        slack = 1e-9 * (fabs(lo) + fabs(hi)); /* of rounding: a cell too many does no harm */
        for (double x = floor((lo - slack) * scale); x <= floor((hi + slack) * scale); x++) {
            if (n == MOST_CELLS)
                return MOST_CELLS + 1;
            buckets[n++] = bucket_of(g, level, (int64_t)x, (int64_t)y);
        }
    }
    return n;
}

/* As buckets_of; in the finest cells that are few enough where one of those is crowded. counts: of each bucket, NULL:
 * none is. */
static int sparse_buckets_of(const struct noc_ground *g, const noc_scene *scene, size_t t, const uint32_t *counts,
                             size_t buckets[MOST_CELLS], int *level) {
    int n = buckets_of(g, scene, t, buckets, level);
    bool crowded = false;
    for (int i = 0; i < n && counts; i++)
        crowded = crowded || counts[buckets[i]] > CROWDED;
    size_t finer[MOST_CELLS];
    for (int m; crowded && *level > 0 && (m = touched(g, scene, t, *level - 1, finer)) > 0 && m <= MOST_CELLS;
         --*level) {
        memcpy(buckets, finer, (size_t)m * sizeof(*finer));
        n = m;
    }
    return n;
}

static void note_level(struct noc_ground *g, int level, noc_class cls) {
    g->levels |= 1ull << level;
    g->classes[level] |= 1u << cls;
}

static void count_all(struct noc_ground *g, const noc_scene *scene, size_t triangles, const uint32_t *counts) {
    size_t mesh = 0, buckets[MOST_CELLS];
    int level;
    for (size_t t = next_obstacle(scene, &mesh, 0, triangles); t < triangles;
         t = next_obstacle(scene, &mesh, t + 1, triangles))
        for (int n = sparse_buckets_of(g, scene, t, counts, buckets, &level); n--;)
            g->offsets[buckets[n]]++;
}

static void fill_all(struct noc_ground *g, const noc_scene *scene, size_t triangles, const uint32_t *counts) {
    size_t mesh = 0, buckets[MOST_CELLS];
    int level;
    for (size_t t = next_obstacle(scene, &mesh, 0, triangles); t < triangles;
         t = next_obstacle(scene, &mesh, t + 1, triangles)) {
        for (int n = sparse_buckets_of(g, scene, t, counts, buckets, &level); n--;)
            g->ids[--g->offsets[buckets[n]]] = (uint32_t)t;
        note_level(g, level, material_of(scene, t)->cls);
    }
}

typedef struct ranked_triangle {
    float top; /* height of its highest corner */
    uint32_t id;
} ranked_triangle;

static float top_of(const noc_scene *scene, size_t t) {
    float a = corner(scene, t, 0)[2], b = corner(scene, t, 1)[2], c = corner(scene, t, 2)[2];
    return NOC_MAX(a, NOC_MAX(b, c));
}

static int compare_ranked(const void *a, const void *b) {
    const ranked_triangle *x = a, *y = b;
    return x->top != y->top ? (x->top < y->top) - (x->top > y->top) : (x->id > y->id) - (x->id < y->id);
}

/* Sorts each list of more than LONG triangles, the highest first. Returns false if memory was refused. */
static bool sort_long_lists(struct noc_ground *g, const noc_scene *scene) {
    size_t most = 0;
    for (size_t b = 0; b < g->buckets; b++)
        most = NOC_MAX(most, (size_t)(g->offsets[b + 1] - g->offsets[b]));
    if (most <= LONG)
        return true;
    ranked_triangle *ranked = noc_alloc(most * sizeof(*ranked));
    if (!ranked)
        return false;
    for (size_t b = 0; b < g->buckets; b++) {
        uint32_t *ids = g->ids + g->offsets[b], n = g->offsets[b + 1] - g->offsets[b];
        if (n <= LONG)
            continue;
        for (uint32_t i = 0; i < n; i++)
            ranked[i] = (ranked_triangle){ top_of(scene, ids[i]), ids[i] };
        qsort(ranked, n, sizeof(*ranked), compare_ranked);
        for (uint32_t i = 0; i < n; i++)
            ids[i] = ranked[i].id;
    }
    free(ranked);
    return true;
}

/* NULL: memory was refused. */
static struct noc_ground *ground_build(const noc_scene *scene, size_t triangles) {
    struct noc_ground *g = noc_calloc(1, sizeof(*g));
    if (!g)
        return NULL;
    g->secret = base_secret();
    for (int level = 0; level < LEVELS; level++)
        g->cells_a_metre[level] = ldexp(1, -(level + FINEST));
    g->listed = g->covered = triangles;
    for (g->buckets = 1024; g->buckets < triangles;)
        g->buckets *= 2;
    g->offsets = noc_calloc(g->buckets + 1, sizeof(*g->offsets));
    uint32_t *counts = NULL;
    bool good = g->offsets != NULL;
    if (good)
        count_all(g, scene, triangles, NULL);
    for (size_t i = 0; good && i < g->buckets && !counts; i++)
        if (g->offsets[i] > CROWDED) {
            counts = g->offsets;
            g->offsets = noc_calloc(g->buckets + 1, sizeof(*g->offsets));
            good = g->offsets != NULL;
        }
    if (good && counts)
        count_all(g, scene, triangles, counts);
    for (size_t i = 1; good && i <= g->buckets; i++) /* counts to ends; filling turns ends into beginnings */
        g->offsets[i] += g->offsets[i - 1];
    good = good && (g->ids = noc_alloc(g->offsets[g->buckets] * sizeof(*g->ids)));
    if (good)
        fill_all(g, scene, triangles, counts);
    free(counts);
    if (good && sort_long_lists(g, scene))
        return g;
    noc_ground_free(g);
    return NULL;
}

/* Hangs the triangles added since onto the grids; false if they should rather be made anew, or memory was refused. */
static bool chain_new(struct noc_ground *g, const noc_scene *scene, size_t triangles) {
    if (triangles - g->covered + g->links.len > g->listed + 4096)
        return false;
    if (!g->chains) {
        if (!(g->chains = noc_alloc(g->buckets * sizeof(*g->chains))))
            return false;
        memset(g->chains, 0xff, g->buckets * sizeof(*g->chains));
    }
    size_t mesh = noc_scene_mesh_of(scene, g->covered), t = next_obstacle(scene, &mesh, g->covered, triangles);
    for (; t < triangles; t = next_obstacle(scene, &mesh, t + 1, triangles)) {
        size_t buckets[MOST_CELLS];
        int level;
        for (int n = buckets_of(g, scene, t, buckets, &level); n--;) {
            ground_link link = { (uint32_t)t, g->chains[buckets[n]] };
            if (!array_push(&g->links, link))
                return false;
            g->chains[buckets[n]] = (uint32_t)g->links.len - 1;
        }
        note_level(g, level, material_of(scene, t)->cls);
    }
    __atomic_store_n(&g->covered, triangles, __ATOMIC_RELEASE);
    return true;
}

static void tell_refusal(const noc_scene *scene) {
    if (scene->committed)
        noc_error(scene->log, NOC_ERR_MEMORY, "scene: no memory to find the ground of %zu triangles",
                  scene->triangle_light.len);
    else
        noc_scene_out_of_memory((noc_scene *)scene);
}

/* The grid, up to date with the scene; NULL where memory is refused, which is reported. It is a cache, so a const scene
 * may get one. */
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

/* Twice the signed area of (a, b, p). Exactly antisymmetric in a and b, so that a point on, or very near, an edge that
 * two triangles share lies in at least one of them. */
static double edge(const float *a, const float *b, double x, double y) {
    bool swapped = a[0] > b[0] || (a[0] == b[0] && a[1] > b[1]);
    const float *p = swapped ? b : a, *q = swapped ? a : b;
    double e = ((double)q[0] - p[0]) * (y - p[1]) - ((double)q[1] - p[1]) * (x - p[0]);
    return swapped ? -e : e;
}

static bool triangle_height(const noc_scene *scene, size_t t, double x, double y, double *z) {
    const float *a = corner(scene, t, 0), *b = corner(scene, t, 1), *c = corner(scene, t, 2);
    if (x < NOC_MIN(a[0], NOC_MIN(b[0], c[0])) || x > NOC_MAX(a[0], NOC_MAX(b[0], c[0])) ||
        y < NOC_MIN(a[1], NOC_MIN(b[1], c[1])) || y > NOC_MAX(a[1], NOC_MAX(b[1], c[1])))
        return false; /* as nearly all are */
    double u = edge(b, c, x, y), v = edge(c, a, x, y), w = edge(a, b, x, y), sum = u + v + w;
    bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    if (!inside || sum == 0)
        return false;
    double lo = NOC_MIN(a[2], NOC_MIN(b[2], c[2])), hi = NOC_MAX(a[2], NOC_MAX(b[2], c[2]));
    double h = (u * a[2] + v * b[2] + w * c[2]) / sum;
    *z = NOC_CLAMP(h, lo, hi);
    return true;
}

typedef struct vertical_ray {
    const noc_scene *scene;
    double x, y;
    uint32_t classes;
    double below; /* what is not lower does not count */
    double best;  /* -DBL_MAX: none yet */
    size_t looked_at, most;
} vertical_ray;

static void consider(vertical_ray *r, size_t t) {
    double h;
    r->looked_at++;
    if ((r->classes >> material_of(r->scene, t)->cls & 1) && triangle_height(r->scene, t, r->x, r->y, &h) &&
        h > r->best && h < r->below)
        r->best = h;
}

/* Returns false if it has ended early, as there were more triangles than it may look at. */
static bool cast(vertical_ray *r) {
    const struct noc_ground *g = ground_of(r->scene);
    for (uint64_t levels = g ? g->levels : 0; levels; levels &= levels - 1) {
        int level = __builtin_ctzll(levels);
        if (!(g->classes[level] & r->classes))
            continue;
        double scale = g->cells_a_metre[level];
        size_t b = bucket_of(g, level, (int64_t)floor(r->x * scale), (int64_t)floor(r->y * scale));
        uint32_t first = g->offsets[b], end = g->offsets[b + 1];
        bool sorted = end - first > LONG;
        for (uint32_t i = first; i < end && !(sorted && r->best >= top_of(r->scene, g->ids[i])); i++) {
            if (r->looked_at == r->most)
                return false;
            consider(r, g->ids[i]);
        }
        for (uint32_t l = g->chains ? g->chains[b] : NO_LINK; l != NO_LINK; l = g->links.data[l].next) {
            if (r->looked_at == r->most)
                return false;
            consider(r, g->links.data[l].triangle);
        }
    }
    return true;
}

/* ---- what all rays of a load may look at ---- */

size_t noc_ground_most_looks = 30000000; /* half a second; the cities measured take 5 million at most */
#define LOOKS_A_TRIANGLE 200
#define LOOKS_A_RAY 32 /* in the densest city of those measured they are 30 where most lies over one another */
#define RAY_LOOKS 8    /* as many as a ray costs that finds nothing to look at */

/* Casts the ray of a scene that may not be committed yet, and so is being made of files. */
static void cast_within(vertical_ray *r) {
    if (r->scene->committed) {
        cast(r);
        return;
    }
    noc_ground_work *work = &((noc_scene *)r->scene)->ground_work;
    size_t rays = __atomic_add_fetch(&work->rays, 1, __ATOMIC_RELAXED),
           looks = __atomic_load_n(&work->looks, __ATOMIC_RELAXED),
           all = noc_ground_most_looks + LOOKS_A_TRIANGLE * r->scene->triangle_light.len + LOOKS_A_RAY * rays;
    r->most = all > looks ? NOC_MAX(all - looks, (size_t)LOOKS_A_RAY) : (size_t)LOOKS_A_RAY;
    if (!cast(r))
        __atomic_add_fetch(&work->cut, 1, __ATOMIC_RELAXED);
    __atomic_add_fetch(&work->looks, r->looked_at, __ATOMIC_RELAXED);
}

size_t noc_ground_looked(const noc_scene *scene) {
    return __atomic_load_n(&scene->ground_work.looks, __ATOMIC_RELAXED) +
           RAY_LOOKS * __atomic_load_n(&scene->ground_work.rays, __ATOMIC_RELAXED);
}

bool noc_scene_highest(const noc_scene *scene, uint32_t classes, double x, double y, double *z) {
    if (!(fabs(x) < 1e8 && fabs(y) < 1e8))
        return false;
    vertical_ray r = {
        .scene = scene, .x = x, .y = y, .classes = classes, .below = DBL_MAX, .best = -DBL_MAX, .most = SIZE_MAX
    };
    if (scene->triangle_light.len)
        cast_within(&r);
    if (classes >> NOC_CLASS_LAMP & 1)
        noc_bodies_highest(scene, x, y, &r.best);
    if (r.best == -DBL_MAX)
        return false;
    *z = r.best;
    return true;
}

bool noc_scene_highest_below(const noc_scene *scene, uint32_t classes, double x, double y, double below, double *z) {
    if (!(fabs(x) < 1e8 && fabs(y) < 1e8))
        return false;
    vertical_ray r = {
        .scene = scene, .x = x, .y = y, .classes = classes, .below = below, .best = -DBL_MAX, .most = SIZE_MAX
    };
    if (scene->triangle_light.len)
        cast_within(&r);
    if (r.best == -DBL_MAX)
        return false;
    *z = r.best;
    return true;
}

bool noc_scene_has_classes(const noc_scene *scene, uint32_t classes) {
    const struct noc_ground *g = scene->triangle_light.len ? ground_of(scene) : NULL;
    uint32_t there = scene->bodies.len ? 1u << NOC_CLASS_LAMP : 0;
    for (int level = 0; g && level < LEVELS; level++)
        there |= g->classes[level];
    return there & classes;
}

size_t noc_ground_load(const noc_scene *scene, double x, double y) {
    vertical_ray r = {
        .scene = scene, .x = x, .y = y, .classes = UINT32_MAX, .below = DBL_MAX, .best = -DBL_MAX, .most = SIZE_MAX
    };
    cast(&r);
    return r.looked_at;
}

bool noc_scene_ground(const noc_scene *scene, double x, double y, double *z) {
    if (!scene || !z)
        return false;
    noc_scene_lock_read(scene);
    bool hit = noc_scene_highest(scene, GROUND_CLASSES, x, y, z);
    noc_scene_unlock_read(scene);
    return hit;
}

bool noc_scene_top(const noc_scene *scene, double x, double y, double *z) {
    return noc_scene_highest(scene, UINT32_MAX, x, y, z);
}
