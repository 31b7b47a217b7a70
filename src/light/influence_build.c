/* Building influence volumes: their order, the lights that share one, and the hierarchy over them. Every step is linear
 * but the radix sort, which is linear for keys of 64 bits. */
#include "light/influence_parts.h"

#include "light/bound.h"

#include <math.h>

enum { WIDTH = NOC_INFLUENCE_WIDTH, LEVELS = NOC_INFLUENCE_LEVELS, CHUNK = 4096 };

typedef struct build {
    const noc_scene *scene;
    const noc_influence_params *params;
    noc_influence *v;
    noc_light_bound *bounds; /* a light of the scene */
    noc_light_key *keys;     /* the lights that shine, then room for as many */
    double since;            /* clock, at the end of the last step */
    float lo[3], size, most; /* of their centres: corner and largest edge; largest intensity */
} build;

static void bound_chunk(void *ctx, size_t item, int worker) {
    build *b = ctx;
    (void)worker;
    size_t end = NOC_MIN((item + 1) * CHUNK, b->scene->lights.len);
    for (size_t i = item * CHUNK; i < end; i++)
        b->bounds[i] = noc_bound_light(&b->scene->lights.data[i]);
}

/* ---- order ---- */

static void measure(build *b, size_t n) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < n; i++) {
        const noc_light_bound *a = &b->bounds[b->keys[i].id];
        b->most = NOC_MAX(b->most, a->intensity);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], a->p[k]);
            hi[k] = NOC_MAX(hi[k], a->p[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        b->lo[k] = lo[k];
        b->size = NOC_MAX(b->size, hi[k] - lo[k]);
    }
}

/* Size class (a factor of 2 in intensity), side where lights are to share volumes, Morton code. */
static void key_chunk(void *ctx, size_t item, int worker) {
    build *b = ctx;
    (void)worker;
    float scale = b->size > 0 ? 1048575.f / b->size : 0;
    bool sides = b->params->cluster > 1;
    size_t end = NOC_MIN((item + 1) * CHUNK, (size_t)b->v->shining);
    for (size_t i = item * CHUNK; i < end; i++) {
        const noc_light_bound *a = &b->bounds[b->keys[i].id];
        uint64_t m = 0, smaller = (uint64_t)NOC_CLAMP(ilogbf(b->most) - ilogbf(a->intensity), 0, 15);
        for (int k = 0; k < 3; k++)
            m |= noc_spread_bits((uint64_t)((a->p[k] - b->lo[k]) * scale)) << k;
        if (sides)
            m = m >> 3 | noc_side(a->n) << 57;
        b->keys[i].key = (m | smaller << 60) & ~(sides ? 0xffffull : 0xffffffull); /* enough, and faster to sort */
    }
}

/* ---- volumes ---- */

static noc_influence_volume volume_of(const noc_light_bound *b) {
    noc_influence_volume v = { .size = b->radius * 1.0001f, .root = sqrtf(b->intensity) };
    for (int k = 0; k < 3; k++) {
        v.c[k] = b->p[k];
        v.m[k] = 1000 * b->n[k]; /* a millimetre behind the light */
    }
    return v;
}

static void volume_chunk(void *ctx, size_t item, int worker) {
    build *b = ctx;
    noc_influence *v = b->v;
    (void)worker;
    size_t end = NOC_MIN((item + 1) * CHUNK, (size_t)v->shining);
    for (size_t i = item * CHUNK; i < end; i++) {
        v->ids[i] = b->keys[i].id;
        v->volume_of[v->ids[i]] = (uint32_t)i;
        v->volumes[i] = volume_of(&b->bounds[v->ids[i]]);
    }
}

/* May a light come into the volume of lights whose box of centres is lo..hi? Its volume must be similar: as large to a
 * factor of 1.5, shining the same way, and most of it in common. */
static bool joins(const noc_light_bound *first, const noc_light_bound *a, const float lo[3], const float hi[3],
                  float scale) {
    float d2 = 0, cos = 0, reach = scale * sqrtf(first->intensity);
    bool any = first->n[0] == 0 && first->n[1] == 0 && first->n[2] == 0;
    for (int k = 0; k < 3; k++) {
        float d = NOC_MAX(hi[k], a->p[k]) - NOC_MIN(lo[k], a->p[k]);
        d2 += d * d;
        cos += first->n[k] * a->n[k];
    }
    bool same_way = any ? a->n[0] == 0 && a->n[1] == 0 && a->n[2] == 0 : cos > 0.9999f;
    return same_way && d2 <= 0.25f * reach * reach && a->intensity <= 2.25f * first->intensity &&
           first->intensity <= 2.25f * a->intensity;
}

static noc_influence_volume shared_volume(const build *b, uint32_t begin, uint32_t end, const float lo[3],
                                          const float hi[3]) {
    const noc_light_bound *first = &b->bounds[b->v->ids[begin]];
    noc_influence_volume v = { .c = { 0 } };
    float back = 0, most = 0;
    for (int k = 0; k < 3; k++)
        v.c[k] = 0.5f * (lo[k] + hi[k]);
    for (uint32_t i = begin; i < end; i++) {
        const noc_light_bound *a = &b->bounds[b->v->ids[i]];
        float d2 = 0, behind = 0;
        for (int k = 0; k < 3; k++) {
            float d = v.c[k] - a->p[k];
            d2 += d * d;
            behind += first->n[k] * d;
        }
        v.size = NOC_MAX(v.size, (sqrtf(d2) + a->radius) * 1.0001f);
        back = NOC_MAX(back, behind);
        most = NOC_MAX(most, a->intensity);
    }
    v.root = sqrtf(most);
    for (int k = 0; k < 3; k++)
        v.m[k] = first->n[k] / (back * 1.0001f + 0.001f);
    return v;
}

/* Algorithm 5 without its quadratic search: lights that follow each other in Morton order. */
static void share_volumes(build *b) {
    noc_influence *v = b->v;
    uint32_t n = 0;
    for (uint32_t i = 0, end; i < v->shining; i = end) {
        const noc_light_bound *first = &b->bounds[v->ids[i]];
        float lo[3], hi[3];
        memcpy(lo, first->p, sizeof(lo));
        memcpy(hi, first->p, sizeof(hi));
        for (end = i + 1; end < v->shining && end - i < (uint32_t)b->params->cluster; end++) {
            const noc_light_bound *a = &b->bounds[v->ids[end]];
            if (!joins(first, a, lo, hi, v->scale))
                break;
            for (int k = 0; k < 3; k++) {
                lo[k] = NOC_MIN(lo[k], a->p[k]);
                hi[k] = NOC_MAX(hi[k], a->p[k]);
            }
        }
        noc_influence_volume shared = end == i + 1 ? v->volumes[i] : shared_volume(b, i, end, lo, hi);
        for (uint32_t k = i; k < end; k++)
            v->volume_of[v->ids[k]] = n;
        v->first[n] = i;
        v->volumes[n++] = shared; /* n <= i */
    }
    v->first[n] = v->shining;
    v->volume_count = n;
}

/* ---- hierarchy ---- */

static void grow(float lo[3], float hi[3], const float a[3], const float b[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = NOC_MIN(lo[k], a[k]);
        hi[k] = NOC_MAX(hi[k], b[k]);
    }
}

/* Box and largest root of child i of a level. */
static float bound_child(const noc_influence *v, int level, size_t i, float lo[3], float hi[3]) {
    float root = 0;
    if (!level) {
        size_t end = NOC_MIN((i + 1) * WIDTH, (size_t)v->volume_count);
        for (size_t j = i * WIDTH; j < end; j++) {
            const noc_influence_volume *a = &v->volumes[j];
            float from[3] = { a->c[0] - a->size, a->c[1] - a->size, a->c[2] - a->size };
            float to[3] = { a->c[0] + a->size, a->c[1] + a->size, a->c[2] + a->size };
            grow(lo, hi, from, to);
            root = NOC_MAX(root, a->root);
        }
        return root;
    }
    const noc_influence_node *n = &v->nodes[level - 1][i];
    for (int s = 0; s < WIDTH && n->root[s] > 0; s++) {
        float from[3] = { n->lo[0][s], n->lo[1][s], n->lo[2][s] }, to[3] = { n->hi[0][s], n->hi[1][s], n->hi[2][s] };
        grow(lo, hi, from, to);
        root = NOC_MAX(root, n->root[s]);
    }
    return root;
}

static bool build_levels(noc_influence *v) {
    size_t children = ((size_t)v->volume_count + WIDTH - 1) / WIDTH;
    for (int level = 0; level < LEVELS; level++) {
        size_t nodes = (children + WIDTH - 1) / WIDTH;
        noc_influence_node *to = v->nodes[level] = noc_alloc_large(nodes, sizeof(*to));
        if (!to)
            return false;
        v->bytes += nodes * sizeof(*to);
        v->levels = level + 1;
        for (size_t i = 0; i < children; i++) {
            float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
            to[i / WIDTH].root[i % WIDTH] = bound_child(v, level, i, lo, hi);
            for (int k = 0; k < 3; k++) {
                to[i / WIDTH].lo[k][i % WIDTH] = lo[k];
                to[i / WIDTH].hi[k][i % WIDTH] = hi[k];
            }
        }
        if (nodes == 1)
            return true;
        children = nodes;
    }
    return false; /* 16^9 lights do not fit in memory */
}

/* ---- all of it ---- */

/* What sharing has left of an array of `have` records that now holds `count`. */
static void *trim(void *data, size_t count, size_t size) {
    void *less = noc_alloc_large(count, size);
    if (!less)
        return data;
    memcpy(less, data, count * size);
    free(data);
    return less;
}

/* A step of building ends: what it took since the one before it. */
static void end_step(build *b, int step) {
    double now = noc_wall_seconds();
    b->v->seconds[step] += now - b->since;
    b->since = now;
}

static bool build_volumes(build *b) {
    noc_influence *v = b->v;
    noc_pool *pool = b->params->pool;
    measure(b, v->shining);
    noc_influence_run(pool, (v->shining + CHUNK - 1) / CHUNK, key_chunk, b);
    noc_sort_keys(b->keys, b->keys + v->count, v->shining);
    noc_influence_run(pool, (v->shining + CHUNK - 1) / CHUNK, volume_chunk, b);
    v->volume_count = v->shining;
    end_step(b, NOC_STEP_VOLUMES);
    v->scale = noc_influence_scale(b->params->scale);
    if (!(v->scale > 0)) {
        v->scale = noc_influence_tune(v, b->scene, b->params);
        end_step(b, NOC_STEP_TUNING);
    }
    if (!(v->scale > 0))
        return false;
    if (b->params->cluster > 1) {
        v->first = noc_alloc_large((size_t)v->shining + 1, sizeof(*v->first));
        if (!v->first)
            return false;
        share_volumes(b);
        v->first = trim(v->first, (size_t)v->volume_count + 1, sizeof(*v->first));
        v->volumes = trim(v->volumes, (size_t)v->volume_count + 1, sizeof(*v->volumes));
        v->bytes += ((size_t)v->volume_count + 1) * sizeof(*v->first);
        end_step(b, NOC_STEP_VOLUMES);
    }
    bool ok = build_levels(v);
    end_step(b, NOC_STEP_HIERARCHY);
    if (!ok || !b->params->boxes)
        return ok;
    ok = noc_influence_probe(v, b->scene, b->params);
    end_step(b, NOC_STEP_BOXES);
    return ok;
}

noc_influence *noc_influence_create(const noc_scene *scene, const noc_influence_params *params, noc_log *log) {
    size_t all = scene->lights.len;
    noc_influence *v = noc_calloc(1, sizeof(*v));
    build b = {
        .scene = scene, .params = params ? params : &(noc_influence_params){ 0 }, .v = v, .since = noc_wall_seconds()
    };
    b.bounds = noc_alloc_large(all + 1, sizeof(*b.bounds));
    b.keys = noc_alloc_large(2 * all + 1, sizeof(*b.keys));
    bool ok = v && b.bounds && b.keys && (v->volumes = noc_alloc_large(all + 1, sizeof(*v->volumes))) &&
              (v->ids = noc_alloc_large(all + 1, sizeof(*v->ids))) &&
              (v->volume_of = noc_alloc_large(all + 1, sizeof(*v->volume_of)));
    if (ok) {
        v->count = (uint32_t)all;
        v->scale = 1;
        noc_influence_run(b.params->pool, (all + CHUNK - 1) / CHUNK, bound_chunk, &b);
        for (size_t i = 0; i < all; i++)
            if (b.bounds[i].intensity > 0)
                b.keys[v->shining++].id = (uint32_t)i;
        ok = !v->shining || build_volumes(&b);
    }
    if (ok) {
        v->volumes[v->volume_count] = (noc_influence_volume){ .size = -INFINITY };
        for (size_t i = 0; i < all; i++)
            if (!(b.bounds[i].intensity > 0))
                v->volume_of[i] = v->volume_count;
        v->bytes +=
            ((size_t)v->volume_count + 1) * sizeof(*v->volumes) + (all + 1) * (sizeof(*v->ids) + sizeof(*v->volume_of));
    }
    free(b.bounds);
    free(b.keys);
    if (ok)
        return v;
    noc_error(log, NOC_ERR_MEMORY, "influence volumes: no memory for %zu lights", all);
    noc_influence_destroy(v);
    return NULL;
}
