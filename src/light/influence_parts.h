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

/* influence_tune.c: S_r for this scene, and the influence's rule; the volumes are one a light. 0: memory was refused.
 */
float noc_influence_tune(noc_influence *influence, const noc_scene *scene, const noc_influence_params *params);

/* influence_visible.c: makes the boxes. false: memory was refused. */
bool noc_influence_probe(noc_influence *influence, const noc_scene *scene, const noc_influence_params *params);

#endif
