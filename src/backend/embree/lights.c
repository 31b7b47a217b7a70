/* What candidates are drawn from: made when a frame first asks for it, and kept with the renderer. */
#include "backend/embree/embree.h"

enum { MAX_DRAWS = 1024 + PICK_AHEAD };

static noc_status prepare_lists(embree_state *s) {
    noc_clusters *c = noc_clusters_create(s->scene, s->log);
    bool ok = c != NULL;
    for (int i = 0; i < s->worker_count && ok; i++)
        ok = (s->workers[i].lists.scores = noc_alloc_large(c->padded, sizeof(float))) != NULL ||
             noc_error(s->log, NOC_ERR_MEMORY, "light lists: no memory for %zu clusters", c->padded) == NOC_OK;
    if (ok) {
        s->clusters = c;
        return NOC_OK;
    }
    for (int i = 0; i < s->worker_count; i++) {
        free(s->workers[i].lists.scores);
        s->workers[i].lists.scores = NULL;
    }
    noc_clusters_destroy(c);
    return NOC_ERR_MEMORY;
}

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

noc_status noc_embree_prepare_lights(embree_state *s, const noc_render_params *p) {
    if (p->method != NOC_METHOD_RIS && p->method != NOC_METHOD_RESTIR)
        return NOC_OK;
    switch (p->candidates) {
    case NOC_CANDIDATES_UNIFORM: return NOC_OK;
    case NOC_CANDIDATES_LISTS: return s->clusters ? NOC_OK : prepare_lists(s);
    case NOC_CANDIDATES_POWER:
        if (!s->alias && !(s->alias = noc_alias_create(s->scene, s->log)))
            return NOC_ERR_MEMORY;
        break;
    case NOC_CANDIDATES_BVH:
        if (!s->influence && !(s->influence = noc_influence_create(s->scene, s->log)))
            return NOC_ERR_MEMORY;
        break;
    case NOC_CANDIDATES_TREE:
        if (!s->tree && !(s->tree = noc_tree_create(s->scene, s->log)))
            return NOC_ERR_MEMORY;
        break;
    }
    return prepare_picks(s);
}

void noc_embree_release_lights(embree_state *s) {
    noc_clusters_destroy(s->clusters);
    noc_alias_destroy(s->alias);
    noc_influence_destroy(s->influence);
    noc_tree_destroy(s->tree);
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        free(w->lists.scores);
        free(w->picks.light);
        free(w->picks.inverse);
        noc_found_free(&w->found);
    }
}

size_t noc_embree_light_bytes(const embree_state *s) {
    size_t bytes = s->clusters ? s->clusters->bytes : 0;
    bytes += s->alias ? s->alias->bytes : 0;
    bytes += s->influence ? s->influence->bytes : 0;
    bytes += s->tree ? s->tree->bytes : 0;
    return bytes;
}
