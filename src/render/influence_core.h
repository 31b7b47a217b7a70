/* core/ as rankings and views read it: one light and one point at a time. */
#ifndef NOC_RENDER_INFLUENCE_CORE_H
#define NOC_RENDER_INFLUENCE_CORE_H

#include "light/environment.h"
#include "light/tree.h"

#include "core/frame.h"

/* What core's bridge functions read. */
struct core_context {
    const frame_constants *frame;
    const light_record *lights;
    const float *profiles;
    const noc_tree *tree;
    const noc_environment *environment;
    const noc_map_light *map_light;
    const uint32_t *texels;
};

#include "core/shading.h"
#include "core/texture.h"
#include "core/tree.h"

FN light light_load(CTX u32 i) { return light_of_record(ctx->lights[i]); }
FN profile_cell profile_load(CTX u32 place) {
    profile_cell c;
    memcpy(&c, ctx->profiles + 4 * (size_t)place, sizeof(c));
    return c;
}
FN tree_pair tree_load(CTX u32 i) {
    tree_pair p;
    memcpy(&p, ctx->tree->pairs + i, sizeof(p));
    return p;
}
FN u32 texel_load(CTX u32 place) { return ctx->texels[place]; }
FN v3 environment_texel(CTX u32 i) { return splat3(ctx->environment->light + 3 * (size_t)i); }
FN v3 backdrop_texel(CTX u32 i) { return splat3(ctx->environment->texels + 3 * (size_t)i); }
FN real environment_sine(CTX u32 row) { return ctx->map_light->sines[row]; }
FN alias_slot environment_slot(CTX u32 i) {
    alias_slot s;
    memcpy(&s, ctx->map_light->texels->slots + i, sizeof(s));
    return s;
}

FN alias_slot alias_load(CTX u32 i) { return environment_slot(PASS i); } /* there is no other table */

/* Illuminance of a surface with normal n by one place on a light, were nothing between, lx. */
static inline float light_lux(light_sample s, v3 n) {
    float lux = luminance(s.le) * dot3(n, s.wi);
    return lux > 0 && lux < 1e30f ? lux : 0;
}

#endif
