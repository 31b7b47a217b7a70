/* Building influence volumes: their order, and the lights that share one. Every step is linear but the radix sort,
 * which is linear for keys of 64 bits. */
#include "light/influence_parts.h"

#include "light/bound.h"

#include <math.h>

enum { CHUNK = 4096 };

/* Lights in one order. */
typedef struct sorting {
    const influence_lights *l;
    noc_light_key *keys;
    size_t count, first;     /* first: of their volumes */
    float lo[3], size, most; /* of their centres: corner and largest edge; largest intensity */
} sorting;

/* ---- order ---- */

static void measure(sorting *b) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < b->count; i++) {
        const noc_light_bound *a = &b->l->bounds[b->keys[i].id];
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
    sorting *b = ctx;
    (void)worker;
    float scale = b->size > 0 ? 1048575.f / b->size : 0;
    bool sides = b->l->sides;
    size_t end = NOC_MIN((item + 1) * CHUNK, b->count);
    for (size_t i = item * CHUNK; i < end; i++) {
        const noc_light_bound *a = &b->l->bounds[b->keys[i].id];
        uint64_t m = 0, smaller = 0;
        if (a->intensity > 0)
            smaller = (uint64_t)NOC_CLAMP(ilogbf(b->most) - ilogbf(a->intensity), 0, 15);
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
    const sorting *b = ctx;
    noc_influence *v = b->l->influence;
    (void)worker;
    size_t end = NOC_MIN((item + 1) * CHUNK, b->count);
    for (size_t i = item * CHUNK; i < end; i++) {
        uint32_t light = b->l->ids[b->keys[i].id];
        v->ids[b->l->first_id + b->first + i] = light;
        v->volume_of[light] = (uint32_t)(b->l->first_volume + b->first + i);
        v->volumes[b->l->first_volume + b->first + i] = volume_of(&b->l->bounds[b->keys[i].id]);
    }
}

/* Those of the lights that shine, or do not. Returns how many. */
static size_t put(const influence_lights *l, size_t first, bool shining) {
    sorting b = { .l = l, .keys = l->keys, .first = first };
    for (uint32_t i = 0; i < l->count; i++)
        if ((l->bounds[i].intensity > 0) == shining)
            b.keys[b.count++].id = i;
    if (!b.count)
        return 0;
    size_t chunks = (b.count + CHUNK - 1) / CHUNK;
    measure(&b);
    noc_influence_run(l->pool, chunks, key_chunk, &b);
    noc_sort_keys(b.keys, b.keys + l->count, b.count);
    noc_influence_run(l->pool, chunks, volume_chunk, &b);
    return b.count;
}

static void bound_chunk(void *ctx, size_t item, int worker) {
    const influence_lights *l = ctx;
    (void)worker;
    size_t end = NOC_MIN((item + 1) * CHUNK, (size_t)l->count);
    for (size_t i = item * CHUNK; i < end; i++)
        l->bounds[i] = noc_bound_light(&l->scene->lights.data[l->ids[i]]);
}

bool noc_influence_make_lights(influence_lights *l, size_t room) {
    l->ids = noc_alloc_large(room + 1, sizeof(*l->ids));
    l->bounds = noc_alloc_large(room + 1, sizeof(*l->bounds));
    l->keys = noc_alloc_large(2 * room + 1, sizeof(*l->keys));
    return l->ids && l->bounds && l->keys;
}

void noc_influence_free_lights(influence_lights *l) {
    free(l->ids);
    free(l->bounds);
    free(l->keys);
}

uint32_t noc_influence_put(influence_lights *l) {
    noc_influence_run(l->pool, (l->count + CHUNK - 1) / CHUNK, bound_chunk, l);
    size_t shining = put(l, 0, true);
    put(l, shining, false);
    return (uint32_t)shining;
}

/* ---- sharing ---- */

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

/* bounds: of each light of the scene. */
static noc_influence_volume shared_volume(const noc_influence *of, const noc_light_bound *bounds, uint32_t begin,
                                          uint32_t end, const float lo[3], const float hi[3]) {
    const noc_light_bound *first = &bounds[of->ids[begin]];
    noc_influence_volume v = { .c = { 0 } };
    float back = 0, most = 0;
    for (int k = 0; k < 3; k++)
        v.c[k] = 0.5f * (lo[k] + hi[k]);
    for (uint32_t i = begin; i < end; i++) {
        const noc_light_bound *a = &bounds[of->ids[i]];
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

/* Algorithm 5 without its quadratic search: lights that follow each other in Morton order. Those that move keep their
 * own. */
static void share_volumes(noc_influence *v, const noc_light_bound *bounds, int most) {
    uint32_t n = 0;
    for (uint32_t i = 0, end; i < v->listed; i = end) {
        const noc_light_bound *first = &bounds[v->ids[i]];
        float lo[3], hi[3];
        if (i == v->stand)
            v->half[NOC_MOVING].first = n;
        memcpy(lo, first->p, sizeof(lo));
        memcpy(hi, first->p, sizeof(hi));
        for (end = i + 1; end < v->stand && end - i < (uint32_t)most; end++) {
            const noc_light_bound *a = &bounds[v->ids[end]];
            if (!joins(first, a, lo, hi, v->scale))
                break;
            for (int k = 0; k < 3; k++) {
                lo[k] = NOC_MIN(lo[k], a->p[k]);
                hi[k] = NOC_MAX(hi[k], a->p[k]);
            }
        }
        noc_influence_volume shared = end == i + 1 ? v->volumes[i] : shared_volume(v, bounds, i, end, lo, hi);
        for (uint32_t k = i; k < end; k++)
            v->volume_of[v->ids[k]] = n;
        v->first[n] = i;
        v->volumes[n++] = shared; /* n <= i */
    }
    v->first[n] = v->listed;
    v->volume_count = n;
    if (v->stand == v->listed)
        v->half[NOC_MOVING].first = n;
    v->half[NOC_STANDING].count = v->half[NOC_MOVING].first;
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

/* What a part of building took since the clock was `since`. */
static double end_step(noc_influence *v, int step, double since) {
    double now = noc_wall_seconds();
    v->seconds[step] += now - since;
    return now;
}

/* Lights of one half, in order of their indices. */
static void take_half(influence_lights *l, int half) {
    const noc_light_record *records = l->scene->lights.data;
    l->count = 0;
    for (uint32_t i = 0; i < l->scene->lights.len; i++)
        if (noc_light_half(&records[i]) == half)
            l->ids[l->count++] = i;
}

static bool share(noc_influence *v, const noc_scene *scene, const noc_influence_params *params) {
    noc_light_bound *bounds = noc_alloc_large(scene->lights.len + 1, sizeof(*bounds));
    v->first = noc_alloc_large((size_t)v->listed + 1, sizeof(*v->first));
    bool ok = bounds && v->first;
    if (ok) {
        for (size_t i = 0; i < v->listed; i++)
            bounds[v->ids[i]] = noc_bound_light(&scene->lights.data[v->ids[i]]);
        share_volumes(v, bounds, params->cluster);
        v->first = trim(v->first, (size_t)v->volume_count + 1, sizeof(*v->first));
        v->volumes = trim(v->volumes, (size_t)v->volume_count + 1, sizeof(*v->volumes));
    }
    free(bounds);
    return ok;
}

/* S_r, from those that stand, and only where none of them shines from those that move. */
static bool find_scale(noc_influence *v, const noc_scene *scene, const noc_influence_params *params) {
    int half = v->shining[NOC_STANDING] ? NOC_STANDING : NOC_MOVING;
    uint32_t shining = v->shining[half];
    const noc_influence_half *h = &v->half[half];
    v->scale = noc_influence_scale(params->scale);
    if (v->scale > 0)
        return true;
    v->scale = 1;
    v->found = shining > 0;
    if (v->found)
        v->scale = noc_influence_tune(v, h->first, shining, scene, params);
    v->found_scale = v->scale;
    v->found_floor = v->rule.floor;
    return v->scale > 0;
}

/* The root of the volume in the middle of those that shine. */
static float usual_root(const noc_influence *v) {
    const noc_influence_half *h = &v->half[v->shining[NOC_STANDING] ? NOC_STANDING : NOC_MOVING];
    uint32_t shining = 0;
    while (shining < h->count && v->volumes[h->first + shining].root > 0)
        shining++;
    return shining ? v->volumes[h->first + shining / 2].root : 0;
}

static bool build(noc_influence *v, influence_lights *l, const noc_influence_params *params) {
    double since = noc_wall_seconds();
    for (int half = 0; half < NOC_HALVES; half++) {
        take_half(l, half);
        l->first_id = l->first_volume = v->listed;
        v->shining[half] = noc_influence_put(l);
        v->half[half] = (noc_influence_half){ .first = v->listed, .count = l->count };
        v->listed += l->count;
        v->stand = half == NOC_STANDING ? l->count : v->stand;
    }
    v->volume_count = v->listed;
    since = end_step(v, NOC_STEP_VOLUMES, since);
    if (!find_scale(v, l->scene, params))
        return false;
    if (v->found)
        since = end_step(v, NOC_STEP_TUNING, since);
    if (params->cluster > 1) {
        if (!share(v, l->scene, params))
            return false;
        since = end_step(v, NOC_STEP_VOLUMES, since);
    }
    v->usual = v->built_usual = usual_root(v);
    v->was = noc_influence_mean_of(v);
    for (int half = 0; half < NOC_HALVES; half++) {
        if (!noc_influence_make_half(&v->half[half]))
            return false;
        noc_influence_bound_half(v, &v->half[half], params->pool);
    }
    since = end_step(v, NOC_STEP_HIERARCHY, since);
    if (!params->boxes || !v->stand)
        return true;
    bool ok = noc_influence_probe(v, l->scene, params);
    end_step(v, NOC_STEP_BOXES, since);
    return ok;
}

noc_influence *noc_influence_create(const noc_scene *scene, const noc_influence_params *params, noc_log *log) {
    size_t all = scene->lights.len;
    noc_influence *v = noc_calloc(1, sizeof(*v));
    params = params ? params : &(noc_influence_params){ 0 };
    influence_lights l = { .influence = v, .scene = scene, .pool = params->pool, .sides = params->cluster > 1 };
    bool ok = noc_influence_make_lights(&l, all) && v && (v->volumes = noc_alloc_large(all + 1, sizeof(*v->volumes))) &&
              (v->ids = noc_alloc_large(all + 1, sizeof(*v->ids))) &&
              (v->volume_of = noc_alloc_large(all + 1, sizeof(*v->volume_of)));
    if (ok) {
        v->count = (uint32_t)all;
        memset(v->volume_of, 0xff, (all + 1) * sizeof(*v->volume_of));
        ok = build(v, &l, params);
    }
    if (ok)
        noc_influence_end(v);
    noc_influence_free_lights(&l);
    if (ok)
        return v;
    noc_error(log, NOC_ERR_MEMORY, "influence volumes: no memory for %zu lights", all);
    noc_influence_destroy(v);
    return NULL;
}
