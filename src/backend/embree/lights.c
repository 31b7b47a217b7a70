/* What candidates are drawn from: made when a frame first asks for it, and kept with the renderer. */
#include "backend/embree/embree.h"

enum { MAX_DRAWS = 1024 + PICK_AHEAD };

static noc_status prepare_picks(embree_state *s) {
    for (int i = 0; i < s->worker_count; i++) {
        pick_block *p = &s->workers[i].picks;
        if (!p->light)
            p->light = noc_alloc_large(MAX_DRAWS, sizeof(*p->light));
        if (!p->inverse)
            p->inverse = noc_alloc_large(MAX_DRAWS, sizeof(*p->inverse));
        if (!p->light || !p->inverse)
            return noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory for light candidates");
    }
    return NOC_OK;
}

static noc_status prepare_tree_items(embree_state *s) {
    for (int i = 0; i < 2 * s->worker_count; i++) {
        tree_items *t = &s->workers[i / 2].tree_items[i % 2];
        t->pair = t->pair ? t->pair : noc_alloc_large(TREE_ITEMS, sizeof(*t->pair));
        t->what = t->what ? t->what : noc_alloc_large(TREE_ITEMS, sizeof(*t->what));
        t->pmf = t->pmf ? t->pmf : noc_alloc_large(TREE_ITEMS, sizeof(*t->pmf));
        if (!t->pair || !t->what || !t->pmf)
            return noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory for light candidates");
    }
    return NOC_OK;
}

static noc_status prepare_found(embree_state *s) {
    s->found_bins = (uint32_t)NOC_MIN(s->scene->lights.len, (size_t)FOUND_MOST) + 1;
    for (int i = 0; i < s->worker_count; i++) {
        uint64_t **counts = &s->workers[i].found_counts;
        if (!*counts && !(*counts = noc_alloc_large(s->found_bins, sizeof(**counts))))
            return noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory to count the lights that are found");
    }
    return NOC_OK;
}

static bool draws_candidates(const noc_render_params *p) {
    return p->method == NOC_METHOD_RIS || p->method == NOC_METHOD_RESTIR;
}

/* Boxes and shared volumes are made for one S_r. Volumes of one light each serve them all, but one that is to be found
 * must have been: it takes far longer to find than volumes to make, so it is not where S_r was set. */
static bool serves(const noc_influence_params *have, const noc_influence_params *want) {
    if (have->cluster != want->cluster || have->boxes != want->boxes)
        return false;
    return have->scale == want->scale || (want->scale > 0 && want->cluster <= 1 && !want->boxes);
}

static noc_status prepare_influence(embree_state *s, const noc_render_params *p) {
    noc_influence_params want = { .cluster = p->influence_cluster,
                                  .scale = p->influence,
                                  .probe = noc_embree_probe,
                                  .user = s,
                                  .boxes = p->influence_boxes == NOC_INFLUENCE_VISIBLE,
                                  .pool = s->pool };
    if (s->influence && serves(&s->influence_params, &want))
        return NOC_OK;
    double start = noc_wall_seconds();
    noc_influence_destroy(s->influence);
    s->influence = noc_influence_create(s->scene, &want, s->log);
    s->influence_params = want;
    s->light_seconds[NOC_CANDIDATES_INFLUENCE] = noc_wall_seconds() - start;
    return s->influence ? NOC_OK : NOC_ERR_MEMORY;
}

noc_status noc_embree_influence(void *state, const noc_render_params *params, const struct noc_influence **volumes) {
    embree_state *s = state;
    noc_status status = prepare_influence(s, params);
    *volumes = s->influence;
    return status;
}

static noc_status prepare(embree_state *s, const noc_render_params *p) {
    noc_status status;
    switch (p->candidates) {
    case NOC_CANDIDATES_UNIFORM: return NOC_OK;
    case NOC_CANDIDATES_LISTS:
        return s->clusters || (s->clusters = noc_clusters_create(s->scene, s->pool, s->log)) ? NOC_OK : NOC_ERR_MEMORY;
    case NOC_CANDIDATES_POWER:
        if (!s->alias && !(s->alias = noc_alias_create(s->scene, s->log)))
            return NOC_ERR_MEMORY;
        break;
    case NOC_CANDIDATES_INFLUENCE:
        status = prepare_influence(s, p);
        if (status == NOC_OK)
            status = prepare_found(s);
        if (status != NOC_OK)
            return status;
        break;
    case NOC_CANDIDATES_LIGHT_BVH:
        if (!s->tree && !(s->tree = noc_tree_create(s->scene, s->pool, s->log)))
            return NOC_ERR_MEMORY;
        if (prepare_tree_items(s) != NOC_OK)
            return NOC_ERR_MEMORY;
        break;
    }
    return prepare_picks(s);
}

/* Bytes of the structure for these candidates, 0 where it is not there. */
static size_t bytes_of(const embree_state *s, noc_candidates candidates) {
    switch (candidates) {
    case NOC_CANDIDATES_UNIFORM: return 0;
    case NOC_CANDIDATES_LISTS: return s->clusters ? s->clusters->bytes : 0;
    case NOC_CANDIDATES_POWER: return s->alias ? s->alias->bytes : 0;
    case NOC_CANDIDATES_INFLUENCE: return s->influence ? s->influence->bytes : 0;
    case NOC_CANDIDATES_LIGHT_BVH: return s->tree ? s->tree->bytes : 0;
    }
    return 0;
}

noc_status noc_embree_prepare_lights(embree_state *s, const noc_render_params *p) {
    if (!draws_candidates(p))
        return NOC_OK;
    double start = noc_wall_seconds();
    size_t before = bytes_of(s, p->candidates);
    noc_status status = prepare(s, p);
    if (p->candidates != NOC_CANDIDATES_INFLUENCE && bytes_of(s, p->candidates) != before)
        s->light_seconds[p->candidates] = noc_wall_seconds() - start;
    return status;
}

void noc_embree_release_lights(embree_state *s) {
    noc_clusters_destroy(s->clusters);
    noc_alias_destroy(s->alias);
    noc_influence_destroy(s->influence);
    noc_tree_destroy(s->tree);
    free(s->past_lights);
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free(w->picks.light);
        free(w->picks.inverse);
        noc_found_free(&w->found);
        free(w->found_counts);
        for (int k = 0; k < 2; k++) {
            free(w->tree_items[k].pair);
            free(w->tree_items[k].what);
            free(w->tree_items[k].pmf);
        }
    }
}

void noc_embree_forget_found(embree_state *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        if (w->found_counts)
            memset(w->found_counts, 0, s->found_bins * sizeof(*w->found_counts));
    }
}

size_t noc_embree_light_bytes(const embree_state *s) {
    size_t bytes = 0;
    for (int c = 0; c <= NOC_CANDIDATES_LIGHT_BVH; c++)
        bytes += bytes_of(s, (noc_candidates)c);
    return bytes;
}

static size_t scene_bytes(const noc_scene *s) {
    return s->positions.len * sizeof(float) +
           (s->indices.len + s->triangle_material.len + s->triangle_light.len) * sizeof(uint32_t) +
           s->material_records.len * sizeof(noc_material_record) + s->lights.len * sizeof(noc_light_record);
}

/* Surfaces of the frame that found so many lights. */
static uint64_t surfaces_finding(const embree_state *s, uint32_t lights) {
    uint64_t sum = 0;
    for (int i = 0; i < s->worker_count; i++)
        sum += s->workers[i].found_counts ? s->workers[i].found_counts[lights] : 0;
    return sum;
}

/* The number of lights that a share of the surfaces does not exceed. */
static uint32_t percentile(const embree_state *s, uint64_t surfaces, double share) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < s->found_bins; i++)
        if ((sum += surfaces_finding(s, i)) > share * (double)surfaces)
            return i;
    return 0;
}

void noc_embree_light_stats(void *state, const noc_render_params *p, noc_light_stats *out) {
    const embree_state *s = state;
    out->lights = s->scene->lights.len;
    out->scene_bytes = scene_bytes(s->scene) + noc_embree_build_bytes(s);
    if (!p || !draws_candidates(p))
        return;
    out->candidates = p->candidates;
    out->build_seconds = s->light_seconds[p->candidates];
    out->bytes = bytes_of(s, p->candidates);
    if (p->candidates != NOC_CANDIDATES_INFLUENCE || !s->influence)
        return;
    out->influence = p->influence > 0 ? p->influence : s->influence->scale;
    out->volumes = s->influence->volume_count;
    out->volumes_seconds = s->influence->seconds[NOC_STEP_VOLUMES];
    out->tuning_seconds = s->influence->seconds[NOC_STEP_TUNING];
    out->hierarchy_seconds = s->influence->seconds[NOC_STEP_HIERARCHY];
    out->boxes_seconds = s->influence->seconds[NOC_STEP_BOXES];
    for (uint32_t k = 0; k < s->found_bins; k++)
        out->surfaces += surfaces_finding(s, k);
    if (!out->surfaces)
        return;
    out->found_none = (double)surfaces_finding(s, 0) / (double)out->surfaces;
    out->found_median = percentile(s, out->surfaces, 0.5);
    out->found_99 = percentile(s, out->surfaces, 0.99);
}
