#include "light/clusters.h"

#include "light/bound.h"

#include <math.h>

enum { CHUNK = 4096, CURVE_BITS = 12, SAMPLE = 1024 };

/* Work on all items in chunks, by the pool where there is one. */
typedef struct build {
    const noc_scene *scene;
    noc_clusters *c;
    int half;
    size_t lights;               /* that may be of the half: those of the scene, or those that move */
    noc_light_key *keys, *spare; /* lights of the half in the order of the curve; id: their numbers in the scene */
    uint32_t *first;             /* a cluster: its first key; one more at the end */
    size_t items, count;
    float lo[3], scale, reach;
    int level; /* being made from the one below */
    void (*work)(struct build *b, size_t item);
} build;

static void run_chunk(void *arg, size_t chunk, int worker) {
    build *b = arg;
    (void)worker;
    size_t end = NOC_MIN((chunk + 1) * CHUNK, b->items);
    for (size_t i = chunk * CHUNK; i < end; i++)
        b->work(b, i);
}

static void run(build *b, noc_pool *pool, size_t items, void (*work)(build *, size_t)) {
    size_t chunks = (items + CHUNK - 1) / CHUNK;
    b->items = items;
    b->work = work;
    if (pool && chunks > 1)
        noc_pool_run(pool, chunks, run_chunk, b);
    else
        for (size_t i = 0; i < chunks; i++)
            run_chunk(b, i, 0);
}

/* ---- order ---- */

/* Face of the cube that a direction points through; 6 for none. */
static unsigned face(const float n[3]) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabsf(n[k]) > fabsf(n[axis]))
            axis = k;
    return n[axis] == 0 ? 6 : 2u * (unsigned)axis + (n[axis] < 0);
}

/* Place along Hilbert's curve through a cube of 2^CURVE_BITS cells a side: what follows each other on it lies together,
 * with no leaps, so that 16 in a row make a small sphere. J. Skilling 2004, "Programming the Hilbert curve", AIP Conf.
 * Proc. 707. */
static uint64_t hilbert(uint32_t x[3]) {
    const uint32_t top = 1u << (CURVE_BITS - 1);
    for (uint32_t q = top; q > 1; q >>= 1)
        for (int k = 0; k < 3; k++) {
            uint32_t low = q - 1, t = (x[0] ^ x[k]) & low;
            if (x[k] & q)
                x[0] ^= low;
            else {
                x[0] ^= t;
                x[k] ^= t;
            }
        }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t t = 0;
    for (uint32_t q = top; q > 1; q >>= 1)
        if (x[2] & q)
            t ^= q - 1;
    return noc_spread_bits(x[0] ^ t) << 2 | noc_spread_bits(x[1] ^ t) << 1 | noc_spread_bits(x[2] ^ t);
}

/* Number of a light in the scene. */
static uint32_t light_of(const build *b, size_t i) {
    return b->half == NOC_MOVING ? b->scene->moving.data[i] : (uint32_t)i;
}

/* What a light's score goes by: the greatest intensity, cd. Of one with a profile that is not its peak: off the narrow
 * beam of a headlamp it would be scored far too high, and take the places of what shines there. 0 for dark lights
 * alone, as what has no score is never drawn. */
static float strength_of(const noc_scene *scene, uint32_t light) {
    const noc_light_record *l = &scene->lights.data[light];
    uint32_t profile = (l->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE;
    float peak = noc_light_intensity(l);
    return profile && l->area > 0 ? peak * (scene->profiles.data[profile - 1].strength / l->area) : peak;
}

/* Made anew each time: those of all lights would take more memory than what is made of them. */
static noc_light_bound bound_of(const build *b, uint32_t light) {
    return noc_bound_light(&b->scene->lights.data[light]);
}

/* By the way they face, then along the curve: groups of any level face alike. */
static void make_key(build *b, size_t i) {
    const noc_light_bound l = bound_of(b, b->keys[i].id);
    uint32_t x[3];
    for (int k = 0; k < 3; k++)
        x[k] = (uint32_t)NOC_CLAMP((l.p[k] - b->lo[k]) * b->scale, 0, (float)((1 << CURVE_BITS) - 1));
    b->keys[i].key = (uint64_t)face(l.n) << (3 * CURVE_BITS) | hilbert(x);
}

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The cube that the curve runs through: three times what nine of ten lights span, by a sample of them, so that a moon
 * or a stray lamp does not squeeze the city into one cell of it. */
static void span_lights(build *b) {
    float sample[SAMPLE], size = 0;
    size_t n = NOC_MIN(b->count, (size_t)SAMPLE);
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < n; i++)
            sample[i] = bound_of(b, b->keys[i * b->count / n].id).p[k];
        qsort(sample, n, sizeof(*sample), by_size);
        float low = n ? sample[n / 20] : 0, high = n ? sample[n - 1 - n / 20] : 0;
        b->lo[k] = 0.5f * (low + high);
        size = fmaxf(size, 3 * (high - low));
    }
    for (int k = 0; k < 3; k++)
        b->lo[k] -= 0.5f * size;
    b->reach = size;
    b->scale = size > 0 ? (float)(1 << CURVE_BITS) / size : 0;
}

static void sort_lights(build *b, noc_pool *pool) {
    span_lights(b);
    run(b, pool, b->count, make_key);
    noc_sort_keys(b->keys, b->spare, b->count);
}

/* ---- groups ---- */

/* Do both face alike enough to share a cone? */
static bool alike(const noc_light_bound *a, const noc_light_bound *b) {
    bool any_a = a->n[0] == 0 && a->n[1] == 0 && a->n[2] == 0, any_b = b->n[0] == 0 && b->n[1] == 0 && b->n[2] == 0;
    if (any_a || any_b)
        return any_a == any_b;
    return a->n[0] * b->n[0] + a->n[1] * b->n[1] + a->n[2] * b->n[2] > 0.7f;
}

/* Lights further apart than that are not one cluster: places are told to 1/511 of its radius. */
static bool near(const build *b, const noc_light_bound *x, const noc_light_bound *y) {
    float d2 = 0;
    for (int k = 0; k < 3; k++)
        d2 += (x->p[k] - y->p[k]) * (x->p[k] - y->p[k]);
    return d2 <= b->reach * b->reach;
}

/* Clusters that lights are still put into. Where neighbours face every which way, each light looks for one of its kind,
 * so that clusters become full; none stays open for more than OPEN_FOR lights of the curve, so that they stay small. */
enum { OPEN = 8, OPEN_FOR = 8 * NOC_CLUSTER_LIGHTS };

typedef struct open_cluster {
    noc_light_key keys[NOC_CLUSTER_LIGHTS];
    noc_light_bound leads; /* of the first of them */
    uint32_t count;
    size_t since; /* place on the curve of the first one */
} open_cluster;

typedef struct gathering {
    open_cluster open[OPEN];
    noc_light_key *to;
    uint32_t *first;
    size_t clusters, lights; /* that are closed */
} gathering;

static void close_cluster(gathering *g, open_cluster *c) {
    g->first[g->clusters++] = (uint32_t)g->lights;
    memcpy(g->to + g->lights, c->keys, c->count * sizeof(*c->keys));
    g->lights += c->count;
    c->count = 0;
}

/* The open cluster that light i of the curve belongs into. */
static open_cluster *cluster_for(const build *b, gathering *g, size_t i) {
    const noc_light_bound l = bound_of(b, b->keys[i].id);
    open_cluster *oldest = NULL;
    for (int k = 0; k < OPEN; k++) {
        open_cluster *c = &g->open[k];
        if (c->count && (i - c->since >= OPEN_FOR || !near(b, &c->leads, &l)))
            close_cluster(g, c);
        if (c->count && alike(&c->leads, &l))
            return c;
        if (!oldest || !c->count || (oldest->count && c->since < oldest->since))
            oldest = c;
    }
    if (oldest->count)
        close_cluster(g, oldest);
    oldest->since = i;
    oldest->leads = l;
    return oldest;
}

/* Puts the lights of each cluster side by side, and where it begins into first: room for one entry more than there are
 * lights. Returns how many there are. */
static size_t gather(build *b) {
    gathering g = { .to = b->spare, .first = b->first };
    for (size_t i = 0; i < b->count; i++) {
        open_cluster *c = cluster_for(b, &g, i);
        c->keys[c->count++] = b->keys[i];
        if (c->count == NOC_CLUSTER_LIGHTS)
            close_cluster(&g, c);
    }
    for (int k = 0; k < OPEN; k++)
        if (g.open[k].count)
            close_cluster(&g, &g.open[k]);
    g.first[g.clusters] = (uint32_t)g.lights;
    b->spare = b->keys;
    b->keys = g.to;
    return g.clusters;
}

/* What a node is made from: lights, or nodes. */
typedef struct part {
    float p[3], radius, n[3], cos_cone, power;
} part;

/* Sphere and cone around the parts, into lane `lane`. */
static void close_node(noc_cluster_block *block, int lane, const part *parts, int count) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, n[3] = { 0 },
          power = 0;
    bool any = false;
    for (int i = 0; i < count; i++) {
        power += parts[i].power;
        any = any || parts[i].cos_cone <= -1;
        for (int k = 0; k < 3; k++) {
            lo[k] = fminf(lo[k], parts[i].p[k] - parts[i].radius);
            hi[k] = fmaxf(hi[k], parts[i].p[k] + parts[i].radius);
            n[k] += parts[i].n[k];
        }
    }
    float c[3], radius = 0, len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), angle = 0;
    any = any || !(len > 1e-3f);
    for (int k = 0; k < 3; k++) {
        c[k] = 0.5f * (lo[k] + hi[k]);
        n[k] = any ? (float)(k == 2) : n[k] / len;
    }
    for (int i = 0; i < count; i++) {
        const part *q = &parts[i];
        float d[3] = { q->p[0] - c[0], q->p[1] - c[1], q->p[2] - c[2] };
        radius = fmaxf(radius, sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + q->radius);
        if (!any)
            angle = fmaxf(angle, acosf(NOC_CLAMP(q->n[0] * n[0] + q->n[1] * n[1] + q->n[2] * n[2], -1.f, 1.f)) +
                                     acosf(q->cos_cone));
    }
    /* outwards of rounding */
    float cone = any || angle > 3.1f ? -1 : cosf(angle) - 1e-5f;
    block->x[lane] = c[0];
    block->y[lane] = c[1];
    block->z[lane] = c[2];
    block->radius[lane] = radius * 1.0001f;
    block->ax[lane] = n[0];
    block->ay[lane] = n[1];
    block->az[lane] = n[2];
    block->cos_cone[lane] = cone;
    block->sin_cone[lane] = sqrtf(fmaxf(0, 1 - cone * cone));
    block->power[lane] = power;
}

/* The upper half of an intensity's float, rounded up: never infinite, and 0 for dark lights alone. */
static uint32_t half_intensity(float x) {
    uint32_t bits;
    if (!(x > 0))
        return 0;
    x = NOC_CLAMP(x, 1e-30f, 1e30f);
    memcpy(&bits, &x, sizeof(bits));
    return (bits + 0xffff) & 0xffff0000u;
}

static float full_intensity(uint32_t shine) {
    float x;
    shine &= 0xffff0000u;
    memcpy(&x, &shine, sizeof(x));
    return x;
}

static uint32_t octahedron(const float n[3]) {
    float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]), x = n[0] / sum, y = n[1] / sum;
    if (n[2] < 0) {
        float folded = (1 - fabsf(y)) * (x < 0 ? -1.f : 1.f);
        y = (1 - fabsf(x)) * (y < 0 ? -1.f : 1.f);
        x = folded;
    }
    return (uint32_t)(127.5f + 127 * x) << 8 | (uint32_t)(127.5f + 127 * y);
}

static void make_cluster(build *b, size_t i) {
    noc_cluster_block *block = &b->c->level[0][i / 16];
    noc_light_block *out = &b->c->lights[i];
    part parts[NOC_CLUSTER_LIGHTS] = { 0 };
    int count = (int)(b->first[i + 1] - b->first[i]), lane = (int)(i % 16);
    for (int j = 0; j < count; j++) {
        uint32_t id = b->keys[b->first[i] + (uint32_t)j].id;
        const noc_light_bound l = bound_of(b, id);
        bool any = face(l.n) == 6;
        out->id[j] = id;
        out->shine[j] = half_intensity(strength_of(b->scene, id)) | (any ? 0 : octahedron(l.n));
        parts[j] = (part){ { l.p[0], l.p[1], l.p[2] },
                           l.radius,
                           { l.n[0], l.n[1], l.n[2] },
                           any ? -1 : 1,
                           full_intensity(out->shine[j]) };
    }
    close_node(block, lane, parts, count);
    float centre[3] = { block->x[lane], block->y[lane], block->z[lane] }, r = block->radius[lane];
    for (int j = 0; j < count; j++) {
        out->place[j] = parts[j].cos_cone <= -1 ? 1u << 31 : 0;
        for (int k = 0; k < 3; k++) {
            float t = r > 0 ? (parts[j].p[k] - centre[k]) / r : 0;
            out->place[j] |= (uint32_t)NOC_CLAMP(512 + 511 * t, 0.f, 1023.f) << (10 * k);
        }
    }
    for (int j = count; j < NOC_CLUSTER_LIGHTS; j++)
        out->id[j] = out->id[0];
}

static void make_node(build *b, size_t i) {
    const noc_cluster_block *below = &b->c->level[b->level - 1][i];
    part parts[16] = { 0 };
    int count = (int)NOC_MIN((size_t)16, b->c->nodes[b->level - 1] - 16 * i);
    for (int j = 0; j < count; j++)
        parts[j] = (part){ { below->x[j], below->y[j], below->z[j] },
                           below->radius[j],
                           { below->ax[j], below->ay[j], below->az[j] },
                           below->cos_cone[j],
                           below->power[j] };
    close_node(&b->c->level[b->level][i / 16], (int)(i % 16), parts, count);
}

static bool allocate(noc_clusters *c, size_t count) {
    c->count = count;
    bool ok = (c->lights = noc_alloc_large(count, sizeof(*c->lights))) != NULL;
    c->bytes = count * sizeof(*c->lights);
    for (size_t n = count; ok && n; n = n > NOC_CLUSTER_ROOTS ? (n + 15) / 16 : 0) {
        size_t blocks = (n + 15) / 16;
        c->nodes[c->levels] = n;
        ok = (c->level[c->levels++] = noc_alloc_large(blocks, sizeof(**c->level))) != NULL;
        c->bytes += blocks * sizeof(**c->level);
    }
    return ok;
}

static bool make_all(build *b, noc_pool *pool) {
    for (size_t i = 0; i < b->lights; i++)
        if (noc_light_half(&b->scene->lights.data[light_of(b, i)]) == b->half)
            b->keys[b->count++].id = light_of(b, i);
    if (!b->count)
        return true;
    sort_lights(b, pool);
    if (!(b->first = noc_alloc_large(b->count + 1, sizeof(*b->first))))
        return false;
    size_t count = gather(b);
    if (!allocate(b->c, count))
        return false;
    run(b, pool, count, make_cluster);
    for (b->level = 1; b->level < b->c->levels; b->level++)
        run(b, pool, b->c->nodes[b->level], make_node);
    return true;
}

noc_clusters *noc_clusters_create(const noc_scene *scene, int half, noc_pool *pool, noc_log *log) {
    size_t all = half == NOC_MOVING ? scene->moving.len : scene->lights.len;
    build b = { .scene = scene,
                .half = half,
                .lights = all,
                .c = noc_calloc(1, sizeof(*b.c)),
                .keys = noc_alloc_large(all, sizeof(*b.keys)),
                .spare = noc_alloc_large(all, sizeof(*b.spare)) };
    if (!b.c || !b.keys || !b.spare || !make_all(&b, pool)) {
        noc_error(log, NOC_ERR_MEMORY, "light clusters: no memory for %zu lights", all);
        noc_clusters_destroy(b.c);
        b.c = NULL;
    }
    free(b.keys);
    free(b.spare);
    free(b.first);
    return b.c;
}

/* ---- lights that are switched ---- */

static void relight_cluster(build *b, size_t i) {
    noc_light_block *lights = &b->c->lights[i];
    float power = 0;
    for (int j = 0; j < NOC_CLUSTER_LIGHTS && (!j || lights->id[j] != lights->id[0]); j++) {
        float intensity = strength_of(b->scene, lights->id[j]);
        lights->shine[j] = half_intensity(intensity) | (lights->shine[j] & 0xffff);
        power += full_intensity(lights->shine[j]);
    }
    b->c->level[0][i / 16].power[i % 16] = power;
}

static void relight_node(build *b, size_t i) {
    const noc_cluster_block *below = &b->c->level[b->level - 1][i];
    int count = (int)NOC_MIN((size_t)16, b->c->nodes[b->level - 1] - 16 * i);
    float power = 0;
    for (int j = 0; j < count; j++)
        power += below->power[j];
    b->c->level[b->level][i / 16].power[i % 16] = power;
}

void noc_clusters_relight(noc_clusters *c, const noc_scene *scene, noc_pool *pool) {
    build b = { .scene = scene, .c = c };
    run(&b, pool, c->count, relight_cluster);
    for (b.level = 1; b.level < c->levels; b.level++)
        run(&b, pool, c->nodes[b.level], relight_node);
}

void noc_clusters_destroy(noc_clusters *c) {
    if (!c)
        return;
    for (int i = 0; i < NOC_CLUSTER_LEVELS; i++)
        free(c->level[i]);
    free(c->lights);
    free(c);
}
