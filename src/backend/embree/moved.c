/* Lights that move: what is built over lights follows them, and the previous frame's are kept for temporal reuse. */
#include "backend/embree/embree.h"

/* Does a frame with these parameters leave reservoirs to one that may see other lights? */
static bool needs_past(const embree_state *s, const noc_render_params *p) {
    return s->scene->moving.len && p->method == NOC_METHOD_RESTIR && p->temporal && p->bias != NOC_BIAS_BIASED;
}

static void forget_alias(embree_state *s) {
    noc_alias_destroy(s->alias);
    s->alias = NULL;
}

noc_status noc_embree_follow_lights(embree_state *s, const noc_render_params *p) {
    const noc_scene *scene = s->scene;
    if (needs_past(s, p) && !s->past_lights &&
        !(s->past_lights = noc_alloc_large(scene->lights.len, sizeof(*s->past_lights))))
        return noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory for the previous frame's %zu lights",
                         scene->lights.len);
    if (s->moves == scene->moves)
        return NOC_OK;
    if (s->tree && noc_tree_refit(s->tree, scene, s->log) != NOC_OK) {
        noc_tree_destroy(s->tree);
        s->tree = NULL;
        return NOC_ERR_MEMORY;
    }
    noc_clusters_destroy(s->clusters);
    s->clusters = NULL;
    noc_influence_destroy(s->influence);
    s->influence = NULL;
    if (s->power_changes != scene->power_changes) /* it does not know where lights are */
        forget_alias(s);
    s->moves = scene->moves;
    s->power_changes = scene->power_changes;
    return NOC_OK;
}

void noc_embree_keep_lights(embree_state *s) {
    const noc_scene *scene = s->scene;
    if (!s->past_lights || (s->past_filled && s->past_moves == scene->moves))
        return;
    if (!s->past_filled)
        memcpy(s->past_lights, scene->lights.data, scene->lights.len * sizeof(*s->past_lights));
    for (size_t i = 0; i < scene->moving.len; i++)
        s->past_lights[scene->moving.data[i]] = scene->lights.data[scene->moving.data[i]];
    s->past_filled = true;
    s->past_moves = scene->moves;
}

struct core_context noc_embree_past(const embree_state *s, const struct core_context *now) {
    struct core_context past = *now;
    if (s->past_filled && s->past_moves != s->scene->moves)
        past.lights = s->past_lights;
    return past;
}

size_t noc_embree_past_bytes(const embree_state *s) {
    return s->past_lights ? s->scene->lights.len * sizeof(*s->past_lights) : 0;
}
