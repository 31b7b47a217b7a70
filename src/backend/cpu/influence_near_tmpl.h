/* Bridge between core/influence_near.h and the hierarchies of influence volumes (light/influence.h), 16 children or
 * volumes at a time; included by kernels.c. */
#ifndef NOC_CPU_INFLUENCE_NEAR_H
#define NOC_CPU_INFLUENCE_NEAR_H

#include "core/influence_near.h"

_Static_assert((int)NOC_INFLUENCE_WIDTH == 16 && (int)NOC_HALVES == (int)NEAR_HALVES &&
                   NOC_INFLUENCE_LEVELS * 15 + 1 <= NEAR_STACK,
               "the hierarchies are those that are searched");

FN influence influence_load(CTX u32 index) {
    const noc_influence_volume *volumes = ctx->influence->volumes;
    influence v;
#if defined(CORE_LANES)
    uint32_t at[CORE_LANES];
    memcpy(at, &index, sizeof(at));
    __asm__("" : "+m"(at)); /* as in core/wide_load.h */
    wide_quad c = wide_quad_load(volumes->c, 8, at), m = wide_quad_load(volumes->m, 8, at);
    v.c = V3(c.f[0], c.f[1], c.f[2]);
    v.size = c.f[3];
    v.m = V3(m.f[0], m.f[1], m.f[2]);
    v.root = m.f[3];
#else
    memcpy(&v, volumes + index, sizeof(v));
#endif
    return v;
}

FN v3 load3(const float a[3][BLOCK], int l) { return V3(rload(a[0] + l), rload(a[1] + l), rload(a[2] + l)); }

FN near_half near_half_load(CTX u1 k) {
    const noc_influence_half *h = &ctx->influence->half[k];
    return (near_half){ (u1)h->levels, h->first, h->first + h->count };
}

FN near_children near_children_load(CTX u1 k, u1 level, u1 node, u1 l) {
    const noc_influence_half *h = &ctx->influence->half[k];
    const noc_influence_node *n = &h->nodes[h->level_at[level] + node];
    return (near_children){ load3(n->lo, (int)l), load3(n->hi, (int)l), rload(n->root + l) };
}

FN influence near_volumes_load(CTX u1 first, u1 end) {
    u32 i = KU(first) + lane_numbers(0);
    return influence_load(ctx, selu(i < KU(end), i, KU(ctx->influence->volume_count)));
}

FN void near_clear(CTX u1 list) {
    noc_near *near = &ctx->at.volumes->near[list];
    near->count = near->groups.len = 0;
    near->no_memory = false;
}

FN u1 near_count(CTX u1 list) { return (u1)ctx->at.volumes->near[list].count; }

/* Volumes stand close together: every group of points looks at them. */
FN b1 near_add(CTX u1 list, u1 volume) {
    const noc_influence *v = ctx->influence;
    const noc_influence_volume *a = &v->volumes[volume];
    noc_near *near = &ctx->at.volumes->near[list];
    size_t at = near->count % BLOCK;
    if (!at) {
        if (!array_reserve(&near->groups, near->groups.len + 1)) {
            near->no_memory = true;
            return false;
        }
        memset(&near->groups.data[near->groups.len++], 0, sizeof(noc_near_group));
    }
    noc_near_group *g = &near->groups.data[near->groups.len - 1];
    for (int k = 0; k < 3; k++) {
        g->c[k][at] = a->c[k];
        g->m[k][at] = a->m[k];
    }
    g->size[at] = a->size;
    g->root[at] = a->root;
    g->lights[at] = v->first ? (float)(v->first[volume + 1] - v->first[volume]) : 1;
    g->volume[at] = volume;
    near->count++;
    return true;
}

FN influence group_load(const noc_near_group *g, int l) {
    influence a;
    a.c = load3(g->c, l);
    a.size = rload(g->size + l);
    a.m = load3(g->m, l);
    a.root = rload(g->root + l);
    return a;
}

/* What is near the query, with influence_turn of each volume. False: not all of it. */
static bool look_near(const struct core_context *ctx, u1 list, const noc_near_query *q) {
    noc_near *near = &ctx->at.volumes->near[list];
    bool all = influence_near(ctx, list,
                              (near_query){ { q->lo[0], q->lo[1], q->lo[2] },
                                            { q->hi[0], q->hi[1], q->hi[2] },
                                            { q->n[0], q->n[1], q->n[2] },
                                            q->back,
                                            q->scale,
                                            q->most });
    for (size_t i = 0; i < near->groups.len; i++)
        for (int l = 0; l < BLOCK; l += LANES)
            rstore(near->groups.data[i].turn + l, influence_turn(group_load(&near->groups.data[i], l)));
    return all;
}

#endif
