/* light/tree: a binary tree over the lights for stochastic descent (core/tree.h), built from the top by the surface
 * area orientation heuristic (Conty Estevez and Kulla 2018, section 4).
 *
 * Two levels: lights that move have a tree of their own, and a top pair chooses between both. So what stands is bounded
 * tightly whatever the others do, and moving them costs what they are, not what the scene is. Of those that stand the
 * ones that are dark when the tree is built have a tree, too, which nothing is drawn from until they shine: a change of
 * what lights emit only changes powers. */
#ifndef NOC_LIGHT_TREE_H
#define NOC_LIGHT_TREE_H

#include "scene/scene.h"

enum { NOC_TREE_DEPTH = 31 }; /* turns on the longest way: their bits fit in a uint32_t */
#define NOC_TREE_NO_PATH UINT32_MAX

/* 32 bytes: struct tree_child of core/tree.h. */
typedef struct noc_tree_child {
    float c[3], radius;
    uint32_t axis_xy, axis_cone;
    float power;
    uint32_t link;
} noc_tree_child;

typedef struct noc_tree_pair {
    noc_tree_child child[2];
} noc_tree_pair;
_Static_assert(sizeof(noc_tree_pair) == 64, "two children are one cache line");

/* Lights order[first, first + count) and the pairs from base on, count - 1 of them: what is below the way `path`. A
 * pair lies before the pairs below it, and what is below its first child before what is below its second. */
typedef struct noc_tree_part {
    uint32_t first, count, base, path;
    int depth; /* of the path */
} noc_tree_part;

typedef struct noc_tree {
    noc_tree_pair *pairs;
    uint32_t root;   /* link to a pair, or to the only light */
    uint32_t lights; /* in the tree */
    int depth;       /* turns on the longest way to a light */
    /* a light of the scene: bits of the turns to it, the first one lowest; NOC_TREE_NO_PATH: not here */
    uint32_t *paths;
    uint32_t places;      /* of lights in the scene: the length of paths */
    noc_tree_part moving; /* all that move */
    uint32_t *order;      /* moving.count lights in the order of their leaves */
    double built_cost;    /* of the moving part when it was last built */
    size_t bytes;
} noc_tree;

/* pool: may be NULL; the tree is the same whatever its threads. Returns NULL after reporting that memory was refused.
 */
noc_tree *noc_tree_create(const noc_scene *scene, noc_pool *pool, noc_log *log);
void noc_tree_destroy(noc_tree *tree); /* NULL is allowed */

/* After lights of the moving half have changed in any way: bounds their tree anew where it stands, or builds it anew
 * where its heuristic cost has grown by half since it was built; what stands stays as it is. others: some were added or
 * removed, for which it is built anew; where none moved before, or none does any more, the whole tree is. Lights that
 * the standing half is to take in, or to forget, want another tree. NOC_ERR_MEMORY after reporting it: then there is
 * nothing left to do with the tree but to destroy it. */
noc_status noc_tree_refit(noc_tree *tree, const noc_scene *scene, bool others, noc_log *log) NOC_MUST_USE;

/* After lights have changed what they emit: the powers of all nodes, from the leaves up. */
void noc_tree_relight(noc_tree *tree, const noc_scene *scene, noc_pool *pool);

#endif
