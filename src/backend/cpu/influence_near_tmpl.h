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
        noc_near_group *fresh = &near->groups.data[near->groups.len++];
        memset(fresh->root, 0, sizeof(fresh->root)); /* what is behind the last one holds nothing */
        memset(fresh->volume, 0, sizeof(fresh->volume));
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

/* A query as light/influence.h keeps it, and as core/ does. */
FN1 near_query query_of_record(const noc_near_query *have) {
    near_query q;
    _Static_assert(sizeof(q) == sizeof(*have), "records are core's");
    memcpy(&q, have, sizeof(q));
    return q;
}
FN1 noc_near_query record_of_query(near_query have) {
    noc_near_query q;
    memcpy(&q, &have, sizeof(q));
    return q;
}

FN b1 near_lost(CTX u1 list) { return ctx->at.volumes->near[list].no_memory; }

FN noc_near_group *near_group(CTX u1 list, u1 place) { return &ctx->at.volumes->near[list].groups.data[place / BLOCK]; }
FN u1 near_id(CTX u1 list, u1 place) { return near_group(ctx, list, place)->volume[place % BLOCK]; }
FN f1 near_lights(CTX u1 list, u1 place) { return near_group(ctx, list, place)->lights[place % BLOCK]; }
FN u32 near_ids(CTX u1 list, u1 first) { return uload(near_group(ctx, list, first)->volume + first % BLOCK); }
FN real near_turn(CTX u1 list, u1 first) { return rload(near_group(ctx, list, first)->turn + first % BLOCK); }
FN void near_turn_store(CTX u1 list, u1 first, real turn) {
    rstore(near_group(ctx, list, first)->turn + first % BLOCK, turn);
}
FN influence near_load(CTX u1 list, u1 first) {
    const noc_near_group *g = near_group(ctx, list, first);
    int l = (int)(first % BLOCK);
    influence a;
    a.c = load3(g->c, l);
    a.size = rload(g->size + l);
    a.m = load3(g->m, l);
    a.root = rload(g->root + l);
    return a;
}

#endif
