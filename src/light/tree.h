/* light/tree: a binary tree over the lights for stochastic descent (core/tree.h), built from the top by the surface area
 * orientation heuristic. Lights without emission are not in it. */
#ifndef NOC_LIGHT_TREE_H
#define NOC_LIGHT_TREE_H

#include "scene/scene.h"

enum { NOC_TREE_DEPTH = 31 }; /* turns on the longest way: their bits fit in a uint32_t */

/* 48 bytes, three quarters of a cache line: struct tree_node of core/tree.h. */
typedef struct noc_tree_node {
    float c[3], radius;
    float axis[3], cos_cone;
    float sin_cone, power;
    uint32_t child, light;
} noc_tree_node;
_Static_assert(sizeof(noc_tree_node) == 48, "tree nodes have no gaps");

typedef struct noc_tree {
    noc_tree_node *nodes;   /* the root first; children lie side by side */
    uint32_t count;         /* nodes; 0: no light emits anything */
    int depth;              /* turns on the longest way to a light */
    uint32_t *paths;        /* a light of the scene: bits of the turns to it, the first one lowest */
    size_t bytes;
} noc_tree;

/* Returns NULL after reporting that memory was refused. */
noc_tree *noc_tree_create(const noc_scene *scene, noc_log *log);
void noc_tree_destroy(noc_tree *tree); /* NULL is allowed */

#endif
