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

static bool moves(const noc_scene *scene, size_t i) { return scene->lights.data[i].flags & NOC_LIGHT_MOVES; }

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

/* Those that stand and emit anything, then all that move. Returns how many stand. */
static uint32_t take_lights(tree_build *b) {
    uint32_t all = (uint32_t)b->scene->lights.len, n = 0, standing = 0;
    noc_tree_chunks(b->pool, 0, all, bound_chunk, b);
    for (int moving = 0; moving < 2; moving++) {
        for (uint32_t i = 0; i < all; i++) {
            if (moves(b->scene, i) != (bool)moving || !(moving || b->spare[i].n[3] > 0))
                continue;
            b->lights[n] = b->spare[i];
            b->ids[n++] = i;
        }
        standing = moving ? standing : n;
    }
    b->tree->lights = n;
    return standing;
}

static void keep_cost(tree_build *b) {
    if (b->tree->moving.count && !b->no_memory)
        noc_tree_bound(b, &b->tree->moving, &b->tree->built_cost);
}

static void grow(tree_build *b, uint32_t standing) {
    noc_tree *t = b->tree;
    uint32_t moving = t->lights - standing;
    bool both = standing && moving;
    noc_tree_part still = { .count = standing, .base = both };
    t->moving =
        (noc_tree_part){ .first = standing, .count = moving, .base = both ? standing : 0, .path = both, .depth = both };
    still.depth = both;
    noc_tree_child root[2] = { { .link = 0 }, { .link = 0 } };
    if (standing)
        root[0] = noc_tree_grow(b, &still);
    if (moving)
        root[1] = noc_tree_grow(b, &t->moving);
    if (both)
        t->pairs[0] = (noc_tree_pair){ { root[0], root[1] } };
    t->root = both ? 0 : root[standing ? 0 : 1].link;
    if (moving)
        memcpy(t->order, b->ids + standing, moving * sizeof(*t->order));
    keep_cost(b);
}

noc_tree *noc_tree_create(const noc_scene *scene, noc_pool *pool, noc_log *log) {
    size_t all = scene->lights.len, moving = 0;
    noc_tree *t = noc_calloc(1, sizeof(*t));
    tree_build b = { .tree = t, .scene = scene, .pool = pool };
    bool ok = t && make_build(&b, all);
    uint32_t standing = ok ? take_lights(&b) : 0;
    moving = ok ? t->lights - standing : 0;
    ok = ok && (t->pairs = noc_alloc_large(t->lights, sizeof(*t->pairs))) &&
         (t->paths = noc_alloc_large(all + 1, sizeof(*t->paths))) &&
         (t->order = noc_alloc_large(moving, sizeof(*t->order)));
    if (ok) {
        t->bytes = t->lights * sizeof(*t->pairs) + (all + 1) * sizeof(*t->paths) + moving * sizeof(*t->order);
        memset(t->paths, 0xff, (all + 1) * sizeof(*t->paths));
        if (t->lights)
            grow(&b, standing);
    }
    free_build(&b);
    if (ok && !b.no_memory)
        return t;
    noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %zu lights", all);
    noc_tree_destroy(t);
    return NULL;
}

noc_status noc_tree_refit(noc_tree *t, const noc_scene *scene, noc_log *log) {
    noc_tree_part part = t->moving;
    if (!part.count)
        return NOC_OK;
    tree_build b = { .tree = t, .scene = scene };
    part.first = 0;
    if (!make_build(&b, part.count)) {
        free_build(&b);
        return noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %u moving lights", part.count);
    }
    memcpy(b.ids, t->order, part.count * sizeof(*b.ids));
    for (uint32_t i = 0; i < part.count; i++)
        b.lights[i] = light_of(&scene->lights.data[b.ids[i]]);
    double cost;
    noc_tree_child root = noc_tree_bound(&b, &part, &cost);
    if (cost > grown * t->built_cost) {
        root = noc_tree_grow(&b, &part);
        memcpy(t->order, b.ids, part.count * sizeof(*t->order));
        if (!b.no_memory)
            noc_tree_bound(&b, &part, &t->built_cost);
    }
    if (part.depth)
        t->pairs[0].child[1] = root;
    free_build(&b);
    return b.no_memory ? noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %u moving lights", part.count)
                       : NOC_OK;
}

void noc_tree_destroy(noc_tree *t) {
    if (!t)
        return;
    free(t->pairs);
    free(t->paths);
    free(t->order);
    free(t);
}
