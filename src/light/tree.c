#include "light/tree.h"

#include "core/tree_node.h"
#include "light/bound.h"
#include "light/tree_build.h"

/* A refitted tree is built anew when its cost has grown by this. */
static const double grown = 1.5;

static tree_light light_of(const noc_light_record *record) {
    noc_light_bound b = noc_bound_light(record);
    return (tree_light){ { b.p[0], b.p[1], b.p[2], b.radius }, { b.n[0], b.n[1], b.n[2], b.intensity } };
}

static void bound_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    const tree_build *b = ctx;
    const noc_light_record *records = b->scene->lights.data;
    (void)chunk;
    for (uint32_t i = first; i < end; i++)
        b->spare[i] = light_of(&records[i]);
}

static void free_build(tree_build *b) {
    free(b->lights);
    free(b->ids);
    free(b->spare);
    free(b->spare_ids);
    noc_tree_free_scratch(b);
}

static bool make_build(tree_build *b, size_t lights) {
    b->lights = noc_alloc_large(lights + 1, sizeof(*b->lights));
    b->ids = noc_alloc_large(lights + 1, sizeof(*b->ids));
    b->spare = noc_alloc_large(lights + 1, sizeof(*b->spare));
    b->spare_ids = noc_alloc_large(lights + 1, sizeof(*b->spare_ids));
    return b->lights && b->ids && b->spare && b->spare_ids && noc_tree_make_scratch(b, lights);
}

/* How many lights of a tree are of which kind, in the order in which they come. */
typedef struct kinds {
    uint32_t shining, dark, moving; /* shining, dark: and standing */
} kinds;

/* Dark lights that stand are taken as if all had the same intensity: where they are is all that is known of them. */
static uint32_t take(tree_build *b, int half, bool shining) {
    uint32_t n = 0, at = b->tree->lights;
    for (uint32_t i = 0; i < b->scene->lights.len; i++) {
        bool shines = b->spare[i].n[3] > 0;
        if (noc_light_half(&b->scene->lights.data[i]) != half || (half == NOC_STANDING && shines != shining))
            continue;
        b->lights[at + n] = b->spare[i];
        if (half == NOC_STANDING && !shining)
            b->lights[at + n].n[3] = 1;
        b->ids[at + n++] = i;
    }
    b->tree->lights += n;
    return n;
}

static kinds take_lights(tree_build *b) {
    kinds k;
    noc_tree_chunks(b->pool, 0, (uint32_t)b->scene->lights.len, bound_chunk, b);
    k.shining = take(b, NOC_STANDING, true);
    k.dark = take(b, NOC_STANDING, false);
    k.moving = take(b, NOC_MOVING, true);
    return k;
}

static void keep_cost(tree_build *b) {
    if (b->tree->moving.count && !b->no_memory)
        noc_tree_bound(b, &b->tree->moving, &b->tree->built_cost);
}

/* The trees of those that shine and of those that are dark under a pair that has its place before theirs. */
static noc_tree_child join_standing(tree_build *b, kinds k, uint32_t base, int depth) {
    noc_tree_part shining = { .count = k.shining, .base = base + 1, .depth = depth + 1 };
    noc_tree_part dark = {
        .first = k.shining, .count = k.dark, .base = base + k.shining, .path = 1u << depth, .depth = depth + 1
    };
    noc_tree_child root = noc_tree_bound_lights(b, 0, k.shining + k.dark), a = noc_tree_grow(b, &shining);
    b->tree->pairs[base] = (noc_tree_pair){ { a, noc_tree_grow(b, &dark) } };
    root.link = base;
    return root;
}

static void grow(tree_build *b, kinds k) {
    noc_tree *t = b->tree;
    uint32_t standing = k.shining + k.dark;
    bool both = standing && k.moving;
    noc_tree_part still = { .count = standing, .base = both, .depth = both };
    t->moving = (noc_tree_part){
        .first = standing, .count = k.moving, .base = both ? standing : 0, .path = both, .depth = both
    };
    noc_tree_child root[2] = { { .link = 0 }, { .link = 0 } };
    if (standing)
        root[0] = k.shining && k.dark ? join_standing(b, k, both, both) : noc_tree_grow(b, &still);
    if (k.moving)
        root[1] = noc_tree_grow(b, &t->moving);
    if (both)
        t->pairs[0] = (noc_tree_pair){ { root[0], root[1] } };
    t->root = both ? 0 : root[standing ? 0 : 1].link;
    if (k.moving)
        memcpy(t->order, b->ids + standing, k.moving * sizeof(*t->order));
    keep_cost(b);
    if (k.dark && !b->no_memory)
        noc_tree_relight(t, b->scene, b->pool);
}

static size_t tree_bytes(const noc_tree *t, size_t places) {
    return t->lights * sizeof(*t->pairs) + (places + 1) * sizeof(*t->paths) + t->moving.count * sizeof(*t->order);
}

noc_tree *noc_tree_create(const noc_scene *scene, noc_pool *pool, noc_log *log) {
    size_t all = scene->lights.len;
    noc_tree *t = noc_calloc(1, sizeof(*t));
    tree_build b = { .tree = t, .scene = scene, .pool = pool };
    bool ok = t && make_build(&b, all);
    kinds k = { 0 };
    if (ok)
        k = take_lights(&b);
    ok = ok && (t->pairs = noc_alloc_large(t->lights, sizeof(*t->pairs))) &&
         (t->paths = noc_alloc_large(all + 1, sizeof(*t->paths))) &&
         (t->order = noc_alloc_large(k.moving, sizeof(*t->order)));
    if (ok) {
        t->places = (uint32_t)all;
        memset(t->paths, 0xff, (all + 1) * sizeof(*t->paths));
        if (t->lights)
            grow(&b, k);
        t->bytes = tree_bytes(t, all);
    }
    free_build(&b);
    if (ok && !b.no_memory)
        return t;
    noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %zu lights", all);
    noc_tree_destroy(t);
    return NULL;
}

/* ---- lights that have changed ---- */

/* Room for other lights that move, in order of their indices; what stands has its pairs before theirs. */
static bool take_others(noc_tree *t, const noc_scene *scene, uint32_t moving) {
    uint32_t standing = t->lights - t->moving.count, n = 0;
    for (uint32_t i = 0; i < t->moving.count; i++)
        t->paths[t->order[i]] = NOC_TREE_NO_PATH;
    bool ok = noc_resize_large(&t->pairs, standing, (size_t)standing + moving, sizeof(*t->pairs)) &&
              noc_resize_large(&t->paths, t->places, scene->lights.len + 1, sizeof(*t->paths)) &&
              noc_resize_large(&t->order, 0, moving, sizeof(*t->order));
    for (uint32_t i = 0; ok && i < scene->lights.len; i++) {
        if (i >= t->places)
            t->paths[i] = NOC_TREE_NO_PATH;
        if (noc_light_half(&scene->lights.data[i]) == NOC_MOVING)
            t->order[n++] = i;
    }
    t->moving.count = moving;
    t->lights = standing + moving;
    t->places = (uint32_t)scene->lights.len;
    t->bytes = tree_bytes(t, scene->lights.len);
    return ok;
}

static noc_status refit_moving(noc_tree *t, const noc_scene *scene, bool others, noc_log *log) {
    noc_tree_part part = t->moving;
    tree_build b = { .tree = t, .scene = scene };
    noc_tree_child root;
    double cost = INFINITY;
    part.first = 0;
    if (!make_build(&b, part.count)) {
        free_build(&b);
        return noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %u moving lights", part.count);
    }
    memcpy(b.ids, t->order, part.count * sizeof(*b.ids));
    for (uint32_t i = 0; i < part.count; i++)
        b.lights[i] = light_of(&scene->lights.data[b.ids[i]]);
    if (!others)
        root = noc_tree_bound(&b, &part, &cost);
    if (others || cost > grown * t->built_cost) {
        root = noc_tree_grow(&b, &part);
        memcpy(t->order, b.ids, part.count * sizeof(*t->order));
        if (!b.no_memory)
            noc_tree_bound(&b, &part, &t->built_cost);
    }
    if (part.depth)
        t->pairs[0].child[1] = root;
    else
        t->root = root.link;
    free_build(&b);
    return b.no_memory ? noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %u moving lights", part.count)
                       : NOC_OK;
}

noc_status noc_tree_refit(noc_tree *t, const noc_scene *scene, bool others, noc_log *log) {
    uint32_t moving = t->moving.count, have = moving;
    if (others) {
        moving = 0;
        for (size_t i = 0; i < scene->lights.len; i++)
            moving += noc_light_half(&scene->lights.data[i]) == NOC_MOVING;
    }
    if (!have != !moving) { /* the top pair comes or goes */
        noc_tree *fresh = noc_tree_create(scene, NULL, log);
        if (!fresh)
            return NOC_ERR_MEMORY;
        noc_tree old = *t;
        *t = *fresh;
        *fresh = old;
        noc_tree_destroy(fresh);
        return NOC_OK;
    }
    if (others && !take_others(t, scene, moving))
        return noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %u moving lights", moving);
    return moving ? refit_moving(t, scene, others, log) : NOC_OK;
}

struct relight_run {
    noc_tree *tree;
    const noc_scene *scene;
};

static void relight_leaves(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    const struct relight_run *r = ctx;
    (void)chunk;
    for (uint32_t i = first; i < end; i++)
        for (int k = 0; k < 2; k++) {
            noc_tree_child *c = &r->tree->pairs[i].child[k];
            if (c->link & TREE_LEAF)
                c->power = noc_light_intensity(&r->scene->lights.data[c->link & ~TREE_LEAF]);
        }
}

void noc_tree_relight(noc_tree *t, const noc_scene *scene, noc_pool *pool) {
    struct relight_run run = { t, scene };
    if (t->lights < 2)
        return;
    noc_tree_chunks(pool, 0, t->lights - 1, relight_leaves, &run);
    for (uint32_t i = t->lights - 1; i-- > 0;) /* pairs lie before those below them */
        for (int k = 0; k < 2; k++) {
            noc_tree_child *c = &t->pairs[i].child[k];
            if (!(c->link & TREE_LEAF))
                c->power = t->pairs[c->link].child[0].power + t->pairs[c->link].child[1].power;
        }
}

void noc_tree_destroy(noc_tree *t) {
    if (!t)
        return;
    free(t->pairs);
    free(t->paths);
    free(t->order);
    free(t);
}
