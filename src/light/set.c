#include "light/set.h"

#include <pthread.h>

/* Influence volumes for one set of parameters. */
typedef struct volumes {
    noc_influence *influence;
    noc_influence_params params;
    int holders;
} volumes;

struct noc_light_set {
    const noc_scene *scene;
    noc_log *log;
    noc_pool *pool;
    noc_probe_fn *probe;
    void *user;
    pthread_mutex_t lock;
    noc_clusters *clusters[NOC_HALVES];
    noc_alias *alias;
    noc_tree *tree;
    noc_map_light *map;
    uint64_t map_known; /* version of the scene's map that it is of */
    /* Those that are held, and the last ones that were asked for. */
    NOC_ARRAY(volumes) volumes;
    const noc_influence *last;
    uint64_t numbers;         /* of volumes, that have been given out */
    noc_scene_versions known; /* of the scene, that these know of */
    double seconds[NOC_CANDIDATES_COUNT];
};

noc_light_set *noc_light_set_create(const noc_scene *scene, noc_pool *pool, noc_probe_fn *probe, void *user,
                                    noc_log *log) {
    noc_light_set *set = noc_calloc(1, sizeof(*set));
    if (!set) {
        noc_no_memory(log, "lights");
        return NULL;
    }
    *set = (noc_light_set){
        .scene = scene, .log = log, .pool = pool, .probe = probe, .user = user, .known = scene->versions
    };
    pthread_mutex_init(&set->lock, NULL);
    return set;
}

static void drop_clusters(noc_light_set *set, int half) {
    noc_clusters_destroy(set->clusters[half]);
    set->clusters[half] = NULL;
}

static void drop_volumes(noc_light_set *set) {
    for (size_t i = 0; i < set->volumes.len; i++)
        noc_influence_destroy(set->volumes.data[i].influence);
    set->volumes.len = 0;
    set->last = NULL;
}

void noc_light_set_destroy(noc_light_set *set) {
    if (!set)
        return;
    drop_clusters(set, NOC_STANDING);
    drop_clusters(set, NOC_MOVING);
    noc_alias_destroy(set->alias);
    noc_tree_destroy(set->tree);
    noc_map_light_destroy(set->map);
    drop_volumes(set);
    array_free(&set->volumes);
    pthread_mutex_destroy(&set->lock);
    free(set);
}

/* ---- lights that have changed ---- */

/* What is different since structures were made, or last followed. */
typedef struct changes {
    bool others;             /* lights were added or removed, and N may be another */
    bool moving;             /* that half has changed in any way */
    bool emission, standing; /* what lights emit; of the static half too */
    bool anew;               /* the static half is made of other lights */
} changes;

static changes changes_since(const noc_scene_versions *known, const noc_scene_versions *now) {
    changes c = { .others = known->lights != now->lights, .standing = known->standing != now->standing };
    c.emission = c.others || known->emission != now->emission;
    c.moving = c.emission || known->moved != now->moved;
    c.anew = known->settled != now->settled;
    return c;
}

static noc_status follow_tree(noc_light_set *set, changes c) {
    noc_status status = NOC_OK;
    if (set->tree && !c.anew) {
        if (c.moving)
            status = noc_tree_refit(set->tree, set->scene, c.others, set->log);
        if (status == NOC_OK && c.emission && c.standing)
            noc_tree_relight(set->tree, set->scene, set->pool);
        if (status == NOC_OK)
            return NOC_OK;
    }
    noc_tree_destroy(set->tree);
    set->tree = NULL;
    return status;
}

/* Those of the moving half are hundreds: they are made anew with every change, when a frame asks for them. */
static void follow_clusters(noc_light_set *set, changes c) {
    if (c.anew)
        drop_clusters(set, NOC_STANDING);
    else if (c.standing && set->clusters[NOC_STANDING])
        noc_clusters_relight(set->clusters[NOC_STANDING], set->scene, set->pool);
    if (c.moving)
        drop_clusters(set, NOC_MOVING);
}

/* Do volumes serve the lights that there are now? */
static noc_status follow_volumes(noc_light_set *set, volumes *v, changes c) {
    noc_status status = NOC_OK;
    if (c.standing)
        status = noc_influence_relight(v->influence, set->scene, &v->params, set->log);
    if (status == NOC_OK && c.moving)
        status = noc_influence_move(v->influence, set->scene, c.others, set->log);
    return status;
}

static noc_status follow_all_volumes(noc_light_set *set, changes c) {
    noc_status status = NOC_OK;
    for (size_t i = 0; i < set->volumes.len && !c.anew && status == NOC_OK; i++) {
        volumes *v = &set->volumes.data[i];
        status = follow_volumes(set, v, c);
        c.anew = noc_influence_lacks_scale(v->influence, &v->params);
    }
    if (c.anew || status != NOC_OK)
        drop_volumes(set);
    return status;
}

/* Nobody reads what is changed here: it is done by the first frame after a commit, and commits wait for frames. */
static noc_status follow(noc_light_set *set) {
    changes c = changes_since(&set->known, &set->scene->versions);
    if (!c.moving && !c.standing)
        return NOC_OK;
    set->known = set->scene->versions;
    if (c.emission) { /* it does not know where lights are */
        noc_alias_destroy(set->alias);
        set->alias = NULL;
    }
    follow_clusters(set, c);
    noc_status tree = follow_tree(set, c), all_volumes = follow_all_volumes(set, c);
    return tree != NOC_OK ? tree : all_volumes;
}

/* ---- influence volumes ---- */

static volumes *held_volumes(noc_light_set *set, uint64_t number) {
    for (size_t i = 0; i < set->volumes.len; i++)
        if (set->volumes.data[i].influence->number == number)
            return &set->volumes.data[i];
    return NULL;
}

/* Boxes and shared volumes are made for one S_r. Volumes of one light each serve them all, but one that is to be found
 * must have been: it takes far longer to find than volumes to make, so it is not where S_r was set. */
static bool serves(const noc_influence_params *have, const noc_influence_params *want) {
    if (have->cluster != want->cluster || have->boxes != want->boxes)
        return false;
    return have->scale == want->scale || (want->scale > 0 && want->cluster <= 1 && !want->boxes);
}

/* Those that nobody holds and that were not asked for last go. */
static void forget_volumes(noc_light_set *set) {
    size_t kept = 0;
    for (size_t i = 0; i < set->volumes.len; i++) {
        volumes *v = &set->volumes.data[i];
        if (v->holders || v->influence == set->last)
            set->volumes.data[kept++] = *v;
        else
            noc_influence_destroy(v->influence);
    }
    set->volumes.len = kept;
}

static noc_status get_influence(noc_light_set *set, const noc_render_params *p, noc_light_sources *out) {
    noc_influence_params want = { .cluster = p->influence_cluster,
                                  .scale = p->influence,
                                  .probe = set->probe,
                                  .user = set->user,
                                  .boxes = p->influence_boxes == NOC_INFLUENCE_VISIBLE,
                                  .pool = set->pool };
    volumes *v = NULL;
    for (size_t i = 0; i < set->volumes.len && !v; i++)
        if (serves(&set->volumes.data[i].params, &want))
            v = &set->volumes.data[i];
    if (!v) {
        set->last = NULL;
        forget_volumes(set);
        double start = noc_wall_seconds();
        noc_influence *made = noc_influence_create(set->scene, &want, set->log);
        if (!made)
            return NOC_ERR_MEMORY;
        made->number = ++set->numbers;
        if (!array_push(&set->volumes, (volumes){ made, want, 0 })) {
            noc_influence_destroy(made);
            return noc_no_memory(set->log, "lights");
        }
        set->seconds[NOC_CANDIDATES_INFLUENCE] = noc_wall_seconds() - start;
        v = &set->volumes.data[set->volumes.len - 1];
    }
    v->holders++;
    set->last = out->influence = v->influence;
    out->volumes = v->influence->number;
    return NOC_OK;
}

static void let_go(noc_light_set *set, noc_light_sources *sources) {
    volumes *v = held_volumes(set, sources->volumes);
    if (v)
        v->holders--;
    *sources = (noc_light_sources){ 0 };
}

void noc_light_set_note(const noc_influence *v, const noc_render_params *p, noc_light_stats *out) {
    out->influence = p->influence > 0 ? p->influence : v->scale;
    out->volumes = v->volume_count;
    out->volumes_seconds = v->seconds[NOC_STEP_VOLUMES];
    out->tuning_seconds = v->seconds[NOC_STEP_TUNING];
    out->hierarchy_seconds = v->seconds[NOC_STEP_HIERARCHY];
    out->boxes_seconds = v->seconds[NOC_STEP_BOXES];
}

/* The number of lights that a share of the surfaces does not exceed. */
static uint32_t percentile(uint64_t (*count)(const void *user, uint32_t lights), const void *user, uint32_t bins,
                           double surfaces) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < bins; i++)
        if ((double)(sum += count(user, i)) > surfaces)
            return i;
    return 0;
}

void noc_light_set_note_found(uint64_t (*count)(const void *user, uint32_t lights), const void *user, uint32_t bins,
                              noc_light_stats *out) {
    out->surfaces = 0;
    for (uint32_t i = 0; i < bins; i++)
        out->surfaces += count(user, i);
    if (!out->surfaces)
        return;
    double surfaces = (double)out->surfaces;
    out->found_none = (double)count(user, 0) / surfaces;
    out->found_median = percentile(count, user, bins, 0.5 * surfaces);
    out->found_99 = percentile(count, user, bins, 0.99 * surfaces);
}

/* ---- what a frame asks for ---- */

static noc_status make(noc_light_set *set, noc_candidates candidates, const noc_render_params *p,
                       noc_light_sources *out) {
    double start = noc_wall_seconds();
    bool made = false;
    switch (candidates) {
    case NOC_CANDIDATES_COUNT:
    case NOC_CANDIDATES_UNIFORM: break;
    case NOC_CANDIDATES_LISTS:
        made = !set->clusters[NOC_STANDING];
        for (int half = 0; half < NOC_HALVES; half++) {
            noc_clusters **c = &set->clusters[half];
            if (!*c && !(*c = noc_clusters_create(set->scene, half, set->pool, set->log)))
                return NOC_ERR_MEMORY;
        }
        break;
    case NOC_CANDIDATES_POWER:
        made = !set->alias;
        if (made && !(set->alias = noc_alias_create(set->scene, set->log)))
            return NOC_ERR_MEMORY;
        break;
    case NOC_CANDIDATES_INFLUENCE: return get_influence(set, p, out);
    case NOC_CANDIDATES_LIGHT_BVH:
        made = !set->tree;
        if (made && !(set->tree = noc_tree_create(set->scene, set->pool, set->log)))
            return NOC_ERR_MEMORY;
        break;
    }
    if (made)
        set->seconds[candidates] = noc_wall_seconds() - start;
    for (int half = 0; half < NOC_HALVES; half++)
        out->clusters[half] = set->clusters[half];
    out->alias = set->alias;
    out->tree = set->tree;
    return NOC_OK;
}

noc_status noc_light_set_get(noc_light_set *set, noc_candidates candidates, const noc_render_params *params,
                             noc_light_sources *sources) {
    pthread_mutex_lock(&set->lock);
    let_go(set, sources);
    noc_status status = follow(set);
    if (status == NOC_OK)
        status = make(set, candidates, params, sources);
    pthread_mutex_unlock(&set->lock);
    return status;
}

void noc_light_set_release(noc_light_set *set, noc_light_sources *sources) {
    pthread_mutex_lock(&set->lock);
    let_go(set, sources);
    pthread_mutex_unlock(&set->lock);
}

/* A map that is another one was set between frames, so nobody reads that of the old one. */
noc_status noc_light_set_map(noc_light_set *set, const noc_map_light **map) {
    pthread_mutex_lock(&set->lock);
    if (set->map_known != set->scene->versions.environment) {
        noc_map_light_destroy(set->map);
        set->map = NULL;
    }
    set->map_known = set->scene->versions.environment;
    if (!set->map)
        set->map = noc_map_light_create(set->scene, set->log);
    *map = set->map;
    pthread_mutex_unlock(&set->lock);
    return *map ? NOC_OK : NOC_ERR_MEMORY;
}

size_t noc_light_set_map_bytes(noc_light_set *set) {
    pthread_mutex_lock(&set->lock);
    size_t bytes = set->map ? set->map->bytes : 0;
    pthread_mutex_unlock(&set->lock);
    return bytes;
}

static size_t bytes_of(const noc_light_set *set, noc_candidates candidates) {
    size_t bytes = 0;
    switch (candidates) {
    case NOC_CANDIDATES_COUNT:
    case NOC_CANDIDATES_UNIFORM: return 0;
    case NOC_CANDIDATES_LISTS:
        for (int half = 0; half < NOC_HALVES; half++)
            bytes += set->clusters[half] ? set->clusters[half]->bytes : 0;
        return bytes;
    case NOC_CANDIDATES_POWER: return set->alias ? set->alias->bytes : 0;
    case NOC_CANDIDATES_INFLUENCE:
        for (size_t i = 0; i < set->volumes.len; i++)
            bytes += set->volumes.data[i].influence->bytes;
        return bytes;
    case NOC_CANDIDATES_LIGHT_BVH: return set->tree ? set->tree->bytes : 0;
    }
    return 0;
}

size_t noc_light_set_bytes(noc_light_set *set, noc_candidates candidates) {
    pthread_mutex_lock(&set->lock);
    size_t bytes = bytes_of(set, candidates);
    pthread_mutex_unlock(&set->lock);
    return bytes;
}

double noc_light_set_seconds(noc_light_set *set, noc_candidates candidates) {
    pthread_mutex_lock(&set->lock);
    double seconds = set->seconds[candidates];
    pthread_mutex_unlock(&set->lock);
    return seconds;
}
