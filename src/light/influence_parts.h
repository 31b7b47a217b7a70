/* Building influence volumes: what the parts share. */
#ifndef NOC_LIGHT_INFLUENCE_PARTS_H
#define NOC_LIGHT_INFLUENCE_PARTS_H

#include "light/influence.h"

/* Items over the pool, or one after the other where there is none. */
static inline void noc_influence_run(noc_pool *pool, size_t items, void (*fn)(void *ctx, size_t item, int worker),
                                     void *ctx) {
    if (pool) {
        noc_pool_run(pool, items, fn, ctx);
        return;
    }
    for (size_t i = 0; i < items; i++)
        fn(ctx, i, 0);
}

/* Lights on their way into volumes of their own. */
typedef struct influence_lights {
    noc_influence *influence;
    const noc_scene *scene;
    noc_pool *pool; /* NULL: none */
    bool sides;     /* lights that face alike shall follow each other */
    uint32_t count;
    uint32_t *ids; /* of the scene */
    noc_light_bound *bounds;
    noc_light_key *keys;           /* twice as many */
    size_t first_id, first_volume; /* where they go */
} influence_lights;

/* For so many lights at most; false: no memory. */
bool noc_influence_make_lights(influence_lights *l, size_t room) NOC_MUST_USE;
void noc_influence_free_lights(influence_lights *l);
/* Writes ids and volumes in order, those that shine before those that do not. Returns how many shine. */
uint32_t noc_influence_put(influence_lights *l);

/* influence_half.c: room for the nodes over a half's volumes, in place of what it has. false: no memory. */
bool noc_influence_make_half(noc_influence_half *half) NOC_MUST_USE;
/* Bounds and roots of all nodes, from the volumes. */
void noc_influence_bound_half(const noc_influence *influence, const noc_influence_half *half, noc_pool *pool);

/* influence_follow.c: how strong the lights are that stand. */
noc_influence_mean noc_influence_mean_of(const noc_influence *influence);
/* The volume that holds nothing, for lights without another; bytes. */
void noc_influence_end(noc_influence *influence);

/* influence_tune.c: S_r for this scene, and the influence's rule, from so many volumes of one light each, which all
 * shine. 0: memory was refused. */
float noc_influence_tune(noc_influence *influence, uint32_t first, uint32_t count, const noc_scene *scene,
                         const noc_influence_params *params);

/* influence_visible.c: makes the boxes, in place of what there is. false: memory was refused. */
bool noc_influence_probe(noc_influence *influence, const noc_scene *scene,
                         const noc_influence_params *params) NOC_MUST_USE;

#endif
