/* light/clusters: lights in groups of up to 16 that lie close together and face alike, for choosing by the group
 * (core/lists.h). Lights without emission are left out: they cannot add anything. */
#ifndef NOC_LIGHT_CLUSTERS_H
#define NOC_LIGHT_CLUSTERS_H

#include "scene/scene.h"

enum { NOC_CLUSTER_LIGHTS = 16, NOC_CLUSTER_PAD = 16 };

/* One array a field, padded with clusters of no power to a multiple of NOC_CLUSTER_PAD, 64-byte aligned. */
typedef struct noc_clusters {
    size_t count, padded;
    float *x, *y, *z, *radius;     /* sphere around the lights, shapes included */
    float *ax, *ay, *az;           /* axis of the cone of the directions they face */
    float *cos_cone, *sin_cone;    /* half angle of that cone; -1, 0: every direction */
    float *power;                  /* sum of the lights' greatest intensities, cd */
    uint32_t *first;               /* into ids; count + 1 entries */
    uint32_t *ids;                 /* lights, cluster by cluster */
    float *intensity;              /* greatest intensity of each of them, cd: parallel to ids */
    size_t bytes;
} noc_clusters;

/* Returns NULL after reporting that memory was refused. */
noc_clusters *noc_clusters_create(const noc_scene *scene, noc_log *log);
void noc_clusters_destroy(noc_clusters *clusters); /* NULL is allowed */

#endif
