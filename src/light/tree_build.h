/* light/tree_build: how the nodes of a light tree come about; for tree.c. */
#ifndef NOC_LIGHT_TREE_BUILD_H
#define NOC_LIGHT_TREE_BUILD_H

#include "light/tree.h"

/* As noc_light_bound, in groups of four: what the heuristic adds up. */
typedef struct tree_light {
    float p[4]; /* centre, radius */
    float n[4]; /* way it faces, intensity */
} tree_light;

typedef struct tree_build {
    noc_tree *tree;
    const noc_scene *scene;
    noc_pool *pool;     /* NULL: none */
    tree_light *lights; /* reordered as the tree splits them */
    uint32_t *ids;      /* of them */
    tree_light *spare;  /* as many again */
    uint32_t *spare_ids;
    struct tree_scratch *scratch; /* of nodes that all threads work on; NULL where none has so many lights */
    bool no_memory;               /* was refused in noc_tree_grow: the tree is no good */
} tree_build;

/* For parts of so many lights at most; false: no memory. */
bool noc_tree_make_scratch(tree_build *b, size_t lights);
void noc_tree_free_scratch(tree_build *b);

/* fn for every chunk of [first, end): the same chunks whatever the threads. */
typedef void tree_chunk_fn(void *ctx, size_t chunk, uint32_t first, uint32_t end);
void noc_tree_chunks(noc_pool *pool, uint32_t first, uint32_t end, tree_chunk_fn *fn, void *ctx);
enum { NOC_TREE_CHUNK = 16384 };

/* Builds a part of at least one light: pairs, paths and the depth of b->tree; returns what its parent keeps of it. */
noc_tree_child noc_tree_grow(tree_build *b, const noc_tree_part *part);

/* What a parent keeps of lights [first, end); without a link. */
noc_tree_child noc_tree_bound_lights(const tree_build *b, uint32_t first, uint32_t end);

/* Bounds the pairs of a part anew and leaves their turns as they are; lights are in the order of its leaves. *cost: the
 * heuristic's, over all its nodes, as a share of the root's. */
noc_tree_child noc_tree_bound(tree_build *b, const noc_tree_part *part, double *cost);

#endif
