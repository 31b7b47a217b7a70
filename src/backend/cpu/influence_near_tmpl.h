/* Searching the hierarchy of influence volumes (light/influence.h), 16 children or volumes at a time; included by
 * kernels.c. All volumes that could hold a point of the box, and some more; always in the same order. */
#ifndef NOC_CPU_INFLUENCE_NEAR_H
#define NOC_CPU_INFLUENCE_NEAR_H

#include "core/influence.h"

_Static_assert((int)NOC_INFLUENCE_WIDTH == (int)BLOCK, "nodes and leaves are looked at in whole vectors");

FN influence influence_gather(const noc_influence_volume *volumes, u32 index) {
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

/* The region of a query in every lane. */
FN influence_region region_splat(const noc_near_query *q) {
    return influence_box(splat3(q->lo), splat3(q->hi), splat3(q->n), K(q->back));
}

/* Is lo..hi within reach of the region, and not wholly behind its surfaces? Their normals are the same to 1e-5, and the
 * coordinates have their own precision, hence the 2 cm. */
FN mask box_near(v3 lo, v3 hi, influence_region r, real reach) {
    v3 a = sub3(lo, r.hi);
    v3 b = sub3(r.lo, hi);
    v3 d = V3(max_(max_(a.x, b.x), K(0.0f)), max_(max_(a.y, b.y), K(0.0f)), max_(max_(a.z, b.z), K(0.0f)));
    EXACT real front =
        max_(r.n.x * lo.x, r.n.x * hi.x) + max_(r.n.y * lo.y, r.n.y * hi.y) + max_(r.n.z * lo.z, r.n.z * hi.z);
    return and_(and_(reach > K(0.0f), dot3(d, d) <= reach * reach), front >= r.back - K(0.02f) - K(1e-4f) * reach);
}

/* Children of a node that could hold a point. */
static uint32_t children_near(const noc_influence_node *node, influence_region r, real scale) {
    uint32_t bits = 0;
    for (int l = 0; l < BLOCK; l += LANES)
        bits |= mbits(box_near(load3(node->lo, l), load3(node->hi, l), r, rload(node->root + l) * scale)) << l;
    return bits;
}

/* Could the volume hold a point? Those that face away from the whole box cannot. */
FN mask volume_near(influence a, influence_region r, real scale) {
    v3 size = fill3(a.size);
    return and_(box_near(sub3(a.c, size), add3(a.c, size), r, a.root * scale), influence_shines(a, r));
}

/* A group for the next volume, begun where the last one is full. NULL: no memory. */
static noc_near_group *group_with_room(noc_near *out) {
    if (out->count % BLOCK == 0) {
        if (!array_reserve(&out->groups, out->groups.len + 1)) {
            out->no_memory = true;
            return NULL;
        }
        noc_near_group *g = &out->groups.data[out->groups.len++];
        memset(g, 0, sizeof(*g));
    }
    return &out->groups.data[out->groups.len - 1];
}

/* The volumes of a leaf that could hold a point, close together: every group of points looks at them. */
static void leaf_near(const noc_influence *v, const noc_influence_half *h, size_t leaf, influence_region r, real scale,
                      noc_near *out) {
    uint32_t first = h->first + (uint32_t)leaf * BLOCK, found = 0;
    ALIGNED float turn[BLOCK];
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 i = KU(first) + lane_numbers(l);
        influence a = influence_gather(v->volumes, selu(i < KU(h->first + h->count), i, KU(v->volume_count)));
        found |= mbits(volume_near(a, r, scale)) << l;
        rstore(turn + l, influence_turn(a));
    }
    for (; found; found &= found - 1) {
        int lane = __builtin_ctz(found);
        uint32_t volume = first + (uint32_t)lane;
        const noc_influence_volume *a = &v->volumes[volume];
        noc_near_group *g = group_with_room(out);
        if (!g)
            return;
        size_t at = out->count++ % BLOCK;
        for (int k = 0; k < 3; k++) {
            g->c[k][at] = a->c[k];
            g->m[k][at] = a->m[k];
        }
        g->size[at] = a->size;
        g->root[at] = a->root;
        g->turn[at] = turn[lane];
        g->lights[at] = v->first ? (float)(v->first[volume + 1] - v->first[volume]) : 1;
        g->volume[at] = volume;
    }
}

FN influence group_load(const noc_near_group *g, int l) {
    influence a;
    a.c = load3(g->c, l);
    a.size = rload(g->size + l);
    a.m = load3(g->m, l);
    a.root = rload(g->root + l);
    return a;
}

/* Rounding must not lose what the exact test would take. */
FN real with_margin(float scale) { return K(scale * 1.00001f); }

static void half_near(const noc_influence *v, const noc_influence_half *h, const noc_near_query *q, influence_region r,
                      noc_near *out) {
    struct {
        int level;
        size_t node;
    } stack[NOC_INFLUENCE_LEVELS * BLOCK];
    int depth = 0;
    real scale = with_margin(q->scale);
    if (!h->levels)
        return;
    stack[depth++].level = h->levels - 1, stack[0].node = 0;
    while (depth) {
        int level = stack[--depth].level;
        size_t node = stack[depth].node;
        for (uint32_t bits = children_near(&h->nodes[h->level_at[level] + node], r, scale); bits; bits &= bits - 1) {
            size_t child = node * BLOCK + (size_t)__builtin_ctz(bits);
            if (level) {
                stack[depth].level = level - 1;
                stack[depth++].node = child;
                continue;
            }
            leaf_near(v, h, child, r, scale, out);
            if (out->count > q->most) {
                out->over = true;
                return;
            }
        }
    }
}

static void influence_near(const noc_influence *v, const noc_near_query *q, noc_near *out) {
    influence_region r = region_splat(q);
    out->count = out->groups.len = 0;
    out->over = out->no_memory = false;
    for (int i = 0; i < NOC_HALVES && q->lo[0] <= q->hi[0] && !out->over; i++)
        half_near(v, &v->half[i], q, r, out);
}

#endif
