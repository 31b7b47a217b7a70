/* Influence volumes of lights that have changed. */
#include "light/influence_parts.h"

enum { CHUNK = 4096 };

/* Boxes serve lights that reach further by that than those they were made for: rays went so far. */
static const float beyond = 1.25f;

static uint32_t lights_end(const noc_influence *v, uint32_t volume) {
    return v->first ? v->first[volume + 1] : volume + 1;
}
static uint32_t lights_begin(const noc_influence *v, uint32_t volume) { return v->first ? v->first[volume] : volume; }

noc_influence_mean noc_influence_mean_of(const noc_influence *v) {
    const noc_influence_half *h = &v->half[NOC_STANDING];
    noc_influence_mean m = { 0, 0 };
    for (uint32_t i = h->first; i < h->first + h->count; i++) {
        uint32_t lights = v->volumes[i].root > 0 ? lights_end(v, i) - lights_begin(v, i) : 0;
        m.shining += lights;
        m.root += (double)lights * v->volumes[i].root;
    }
    m.root /= m.shining ? m.shining : 1;
    return m;
}

static size_t node_bytes(const noc_influence_half *h) {
    return h->levels ? (h->level_at[h->levels - 1] + 1) * sizeof(*h->nodes) : 0;
}

void noc_influence_end(noc_influence *v) {
    size_t volumes = (size_t)v->volume_count + 1;
    v->volumes[v->volume_count] = (noc_influence_volume){ .root = 0 };
    for (uint32_t i = 0; i < v->count; i++)
        v->volume_of[i] = NOC_MIN(v->volume_of[i], v->volume_count);
    v->bytes = volumes * sizeof(*v->volumes) + ((size_t)v->count + 1) * (sizeof(*v->ids) + sizeof(*v->volume_of)) +
               (v->first ? volumes * sizeof(*v->first) : 0) + node_bytes(&v->half[0]) + node_bytes(&v->half[1]);
    if (v->boxes) {
        v->box_of[v->volume_count] = v->box_count;
        v->bytes +=
            ((size_t)v->box_count + 1) * (sizeof(*v->boxes) + sizeof(*v->box_reach)) + volumes * sizeof(*v->box_of);
    }
}

/* ---- lights that move ---- */

/* Another number of lights moves, or the scene has places for more. */
static bool make_room(noc_influence *v, const noc_scene *scene, uint32_t moving) {
    const noc_influence_half *h = &v->half[NOC_MOVING];
    size_t volumes = (size_t)h->first + moving + 1, lights = scene->lights.len;
    bool ok = noc_resize_large(&v->volumes, h->first, volumes, sizeof(*v->volumes)) &&
              noc_resize_large(&v->ids, v->stand, lights + 1, sizeof(*v->ids)) &&
              noc_resize_large(&v->volume_of, v->count, lights + 1, sizeof(*v->volume_of)) &&
              (!v->first || noc_resize_large(&v->first, h->first + 1, volumes, sizeof(*v->first))) &&
              (!v->boxes || noc_resize_large(&v->box_of, h->first, volumes, sizeof(*v->box_of)));
    for (size_t i = 0; ok && i < lights; i++)
        if (i >= v->count || v->volume_of[i] >= h->first)
            v->volume_of[i] = UINT32_MAX; /* noc_influence_end sets it */
    v->count = ok ? (uint32_t)lights : v->count;
    return ok;
}

static uint32_t count_moving(const noc_scene *scene) {
    uint32_t n = 0;
    for (size_t i = 0; i < scene->lights.len; i++)
        n += noc_light_half(&scene->lights.data[i]) == NOC_MOVING;
    return n;
}

noc_status noc_influence_move(noc_influence *v, const noc_scene *scene, bool others, noc_log *log) {
    noc_influence_half *h = &v->half[NOC_MOVING];
    uint32_t moving = others ? count_moving(scene) : h->count;
    influence_lights l = { .influence = v, .scene = scene, .first_id = v->stand, .first_volume = h->first };
    if (!moving && !h->count && v->count == scene->lights.len)
        return NOC_OK;
    bool ok = noc_influence_make_lights(&l, moving) && (!others || make_room(v, scene, moving));
    if (ok && others) {
        for (uint32_t i = 0; i < v->count; i++)
            if (noc_light_half(&scene->lights.data[i]) == NOC_MOVING)
                l.ids[l.count++] = i;
        h->count = moving;
        v->listed = v->stand + moving;
        v->volume_count = h->first + moving;
        ok = noc_influence_make_half(h);
    } else if (ok) { /* from the least index on: what the order is made of must not be the order before */
        for (; l.count < moving; l.count++)
            l.keys[l.count].key = v->ids[v->stand + l.count];
        if (moving)
            noc_sort_keys(l.keys, l.keys + moving, moving);
        for (uint32_t i = 0; i < moving; i++)
            l.ids[i] = (uint32_t)l.keys[i].key;
    }
    if (ok) {
        v->shining[NOC_MOVING] = noc_influence_put(&l);
        for (uint32_t i = 0; i < moving; i++) {
            if (v->first)
                v->first[h->first + i + 1] = v->stand + i + 1;
            if (v->boxes)
                v->box_of[h->first + i] = v->box_count;
        }
        noc_influence_bound_half(v, h, NULL);
        if (others)
            noc_influence_end(v);
    }
    noc_influence_free_lights(&l);
    return ok ? NOC_OK : noc_error(log, NOC_ERR_MEMORY, "influence volumes: no memory for %u moving lights", moving);
}

/* ---- lights that stand ---- */

typedef struct relighting {
    noc_influence *v;
    const noc_scene *scene;
} relighting;

static void light_chunk(void *ctx, size_t chunk, int worker) {
    const relighting *r = ctx;
    noc_influence *v = r->v;
    size_t end = NOC_MIN((chunk + 1) * CHUNK, (size_t)v->half[NOC_STANDING].count);
    (void)worker;
    for (size_t i = chunk * CHUNK; i < end; i++) {
        float most = 0;
        for (uint32_t k = lights_begin(v, (uint32_t)i); k < lights_end(v, (uint32_t)i); k++)
            most = NOC_MAX(most, noc_light_intensity(&r->scene->lights.data[v->ids[k]]));
        v->volumes[i].root = sqrtf(most);
    }
}

/* S_r and what goes with it keep what they are to the lights. */
static void follow_lights(noc_influence *v) {
    noc_influence_mean was = v->was, now = noc_influence_mean_of(v);
    v->shining[NOC_STANDING] = now.shining;
    if (!was.shining)
        v->usual = (float)now.root;
    if (!was.shining || !now.shining)
        return;
    double times = now.root / was.root, all = times * times * now.shining / was.shining;
    v->usual = (float)(v->built_usual * times);
    if (!v->found)
        return;
    v->scale = (float)NOC_CLAMP(v->found_scale / sqrt(all), 1e-6, 1e6);
    v->rule.floor = (float)(v->found_floor * all);
}

static bool boxes_too_small(const noc_influence *v) {
    const noc_influence_half *h = &v->half[NOC_STANDING];
    for (uint32_t i = 0; v->boxes && i < h->count; i++)
        if (v->scale * v->volumes[i].root > beyond * v->box_reach[v->box_of[i]])
            return true;
    return false;
}

noc_status noc_influence_relight(noc_influence *v, const noc_scene *scene, const noc_influence_params *params,
                                 noc_log *log) {
    relighting r = { v, scene };
    noc_influence_half *h = &v->half[NOC_STANDING];
    noc_influence_run(params->pool, ((size_t)h->count + CHUNK - 1) / CHUNK, light_chunk, &r);
    follow_lights(v);
    noc_influence_bound_half(v, h, params->pool);
    if (!boxes_too_small(v))
        return NOC_OK;
    if (!noc_influence_probe(v, scene, params))
        return noc_error(log, NOC_ERR_MEMORY, "influence volumes: no memory for the boxes of %u lights", v->stand);
    noc_influence_end(v);
    return NOC_OK;
}

bool noc_influence_lacks_scale(const noc_influence *v, const noc_influence_params *params) {
    return !v->found && !(params->scale > 0) && (v->shining[NOC_STANDING] || v->shining[NOC_MOVING]);
}
