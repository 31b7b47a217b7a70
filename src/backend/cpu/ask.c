/* What estimates apart from frames ask: lights to draw from, and whether anything is in the way. */
#include "backend/cpu/cpu.h"

noc_status noc_cpu_ask(void *state, const noc_render_params *p, bool tree, noc_asking *out) {
    cpu_view *s = state;
    noc_light_sources sources = { 0 }; /* nothing of a tree is held */
    const noc_environment *e = s->scene->environment;
    noc_status status = noc_cpu_follow(s->world);
    *out = (noc_asking){ .pool = s->pool, .ray_offset = s->world->scale.offset };
    if (status == NOC_OK && tree)
        status = noc_light_set_get(s->world->lights, NOC_CANDIDATES_LIGHT_BVH, p, &sources);
    out->tree = sources.tree;
    if (status == NOC_OK && e && p->environment_light && e->power > 0)
        status = noc_light_set_map(s->world->lights, &out->map_light);
    return status;
}

void noc_cpu_clear(void *state, const noc_sight *sights, size_t count, float *clear) {
    const cpu_world *w = ((cpu_view *)state)->world;
    shadow_block blocks[MANY_BLOCKS];
    float through[MANY_BLOCKS][BLOCK];
    for (size_t first = 0; first < count; first += (size_t)MANY_BLOCKS * BLOCK) {
        int used = 0;
        for (; used < MANY_BLOCKS && first + (size_t)used * BLOCK < count; used++) {
            shadow_block *b = &blocks[used];
            const noc_sight *of = &sights[first + (size_t)used * BLOCK];
            size_t lanes = NOC_MIN((size_t)BLOCK, count - first - (size_t)used * BLOCK);
            *b = (shadow_block){ .valid = (uint32_t)((1u << lanes) - 1) };
            for (size_t l = 0; l < lanes; l++) {
                b->light[l] = of[l].light;
                for (int k = 0; k < 3; k++) {
                    b->rays.o[k][l] = of[l].o[k];
                    b->rays.d[k][l] = of[l].d[k];
                }
            }
        }
        w->device->tracer->occluded(w->rays, NOC_RAYS_NOW, blocks, used);
        bool weak = w->device->tracer->through(w->rays, blocks, used, through);
        for (int i = 0; i < used * BLOCK && first + (size_t)i < count; i++) {
            bool arrives = blocks[i / BLOCK].unoccluded >> i % BLOCK & 1;
            clear[first + (size_t)i] = !arrives ? 0 : weak ? through[i / BLOCK][i % BLOCK] : 1;
        }
    }
}
