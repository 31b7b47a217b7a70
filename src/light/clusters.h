/* light/clusters: lights in groups of up to 16 that lie close together and face alike, those groups in groups of 16,
 * and so on, for choosing by the group (core/lists.h). Dark lights are in them, with no power, for they may be switched
 * on.
 *
 * Level 0 is the clusters; a node of level k + 1 is the 16 nodes of block i of level k, i its own number; the 16 lights
 * of cluster i are light block i. So there are no pointers, and what is looked at together is one piece of memory.
 * Places that stay empty have no power. */
#ifndef NOC_LIGHT_CLUSTERS_H
#define NOC_LIGHT_CLUSTERS_H

#include "core/list_limits.h"
#include "scene/scene.h"

enum { NOC_CLUSTER_LIGHTS = 16, NOC_CLUSTER_LEVELS = LIST_LEVELS };
/* The highest level is the first of at most so many nodes. */
enum { NOC_CLUSTER_ROOTS = LIST_ROOTS };

/* Bounds of 16 nodes. */
typedef struct noc_cluster_block {
    float x[16], y[16], z[16], radius[16]; /* sphere around the lights, shapes included */
    float ax[16], ay[16], az[16];          /* axis of the cone of the directions they face */
    float cos_cone[16], sin_cone[16];      /* half angle of that cone; -1, 0: every direction */
    float power[16];                       /* sum of the lights' strengths, cd */
} noc_cluster_block;

/* The lights of a cluster, in brief. place: 10 bits a coordinate, from the sphere's centre -radius to +radius; bit 31:
 * faces every way. shine: the upper half of the strength's float (rounded up), and the way it faces, on the octahedron,
 * 8 bits a coordinate, 127 standing for 0. */
typedef struct noc_light_block {
    uint32_t id[16];
    uint32_t place[16];
    uint32_t shine[16]; /* 0: no light */
} noc_light_block;

typedef struct noc_clusters {
    size_t count; /* clusters */
    int levels;   /* at least 1 where there are clusters */
    size_t nodes[NOC_CLUSTER_LEVELS];
    noc_cluster_block *level[NOC_CLUSTER_LEVELS]; /* (nodes + 15) / 16 of them */
    noc_light_block *lights;                      /* one a cluster */
    size_t bytes;
} noc_clusters;

/* Those of the lights of one half: NOC_STANDING or NOC_MOVING of light/bound.h. Built by the pool's threads, the same
 * for any number of them; pool may be NULL. Returns NULL after reporting that memory was refused. */
noc_clusters *noc_clusters_create(const noc_scene *scene, int half, noc_pool *pool, noc_log *log);
void noc_clusters_destroy(noc_clusters *clusters); /* NULL is allowed */
/* After lights have changed what they emit, and nothing else: powers anew, in place. */
void noc_clusters_relight(noc_clusters *clusters, const noc_scene *scene, noc_pool *pool);

#endif
