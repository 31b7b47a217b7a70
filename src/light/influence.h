/* light/influence: a hierarchy over the lights' influence volumes (core/influence.h), for point queries.
 *
 * Volumes scale with S_r, so the hierarchy does not know it: a node holds the box of its lights' centres and the largest
 * sqrt(intensity), and is entered if the box comes nearer than S_r times that. Lights are sorted by size first and Morton
 * code then, so that few large volumes do not blow up the nodes of many small ones. */
#ifndef NOC_LIGHT_INFLUENCE_H
#define NOC_LIGHT_INFLUENCE_H

#include "scene/scene.h"

enum { NOC_INFLUENCE_WIDTH = 8, NOC_INFLUENCE_LEVELS = 12, NOC_QUERY_POINTS = 16 };

/* Children side by side; those that are not there have root = 0. */
typedef struct noc_influence_node {
    float lo[3][NOC_INFLUENCE_WIDTH], hi[3][NOC_INFLUENCE_WIDTH], root[NOC_INFLUENCE_WIDTH];
} noc_influence_node;

typedef struct noc_influence_volume { /* struct influence of core/influence.h */
    float c[3], size, n[3], root;
} noc_influence_volume;

typedef struct noc_influence {
    uint32_t count;                                 /* lights of the scene, those without emission too */
    noc_influence_volume *volumes;                  /* one a light */
    uint32_t *ids;                                  /* lights in the hierarchy's order */
    noc_influence_node *nodes[NOC_INFLUENCE_LEVELS]; /* level 0: children are single lights; the last level has one node */
    int levels;                                     /* 0: no light emits anything */
    float scale;                                    /* S_r that was found for the scene, sqrt(m2 / cd) */
    size_t bytes;
} noc_influence;

/* Lights that a query found for each of its points. */
typedef struct noc_found {
    uint32_t count[NOC_QUERY_POINTS];
    NOC_ARRAY(uint32_t) near; /* of all points' box */
    NOC_ARRAY(uint32_t) ids;  /* NOC_QUERY_POINTS a row: entry j of point l is ids[j * NOC_QUERY_POINTS + l] */
} noc_found;

typedef struct noc_query {
    const float *p[3], *n[3]; /* NOC_QUERY_POINTS values each */
    uint32_t lanes;           /* points that are asked for */
    float scale;              /* S_r */
} noc_query;

/* Returns NULL after reporting that memory was refused. */
noc_influence *noc_influence_create(const noc_scene *scene, noc_log *log);
void noc_influence_destroy(noc_influence *influence); /* NULL is allowed */

/* Exactly the lights whose volumes hold each point. found starts zeroed, and is used again and again. */
void noc_influence_query(const noc_influence *influence, const noc_query *query, noc_found *found);
void noc_found_free(noc_found *found);

/* m candidates a point into rows light[i], inverse[i] (1 / pmf); keys: rng_key of each point. The scene has lights. */
void noc_influence_draw(const noc_influence *influence, const noc_query *query, const noc_found *found,
                        const uint32_t keys[NOC_QUERY_POINTS], int m, int every, uint32_t (*light)[NOC_QUERY_POINTS],
                        float (*inverse)[NOC_QUERY_POINTS]);
float noc_influence_pmf(const noc_influence *influence, const noc_query *query, const noc_found *found, int point, int m,
                        int every, uint32_t light);

#endif
