/* Searching the hierarchy of influence volumes (light/influence.h), 16 children or volumes at a time; included by kernels.c.
 * All volumes that could hold a point of the box, and some more; always in the same order. */
#ifndef NOC_EMBREE_INFLUENCE_NEAR_H
#define NOC_EMBREE_INFLUENCE_NEAR_H

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
    influence_region r;
    r.lo = splat3(q->lo);
    r.hi = splat3(q->hi);
    r.n = splat3(q->n);
    r.back = K(q->back);
    return r;
}

/* Is lo..hi within reach of the region, and not wholly behind its surfaces? Their normals are the same to 1e-5, and the
 * coordinates have their own precision, hence the 2 cm. */
FN mask box_near(v3 lo, v3 hi, influence_region r, real reach) {
    v3 a = sub3(lo, r.hi);
    v3 b = sub3(r.lo, hi);
    v3 d = V3(max_(max_(a.x, b.x), K(0.0f)), max_(max_(a.y, b.y), K(0.0f)), max_(max_(a.z, b.z), K(0.0f)));
    EXACT real front = max_(r.n.x * lo.x, r.n.x * hi.x) + max_(r.n.y * lo.y, r.n.y * hi.y) + max_(r.n.z * lo.z, r.n.z * hi.z);
    return and_(and_(reach > K(0.0f), dot3(d, d) <= reach * reach), front >= r.back - K(0.02f) - K(1e-4f) * reach);
}

/* Children of a node that could hold a point. */
static uint32_t children_near(const noc_influence_node *node, influence_region r, real scale) {
    uint32_t bits = 0;
    for (int l = 0; l < BLOCK; l += LANES)
        bits |= mbits(box_near(load3(node->lo, l), load3(node->hi, l), r, rload(node->root + l) * scale)) << l;
    return bits;
}

/* NULL: no memory. */
static noc_near_group *group_with_room(noc_near *out) {
    if (out->count % BLOCK == 0) {
        if (!array_reserve(&out->groups, out->groups.len + 1)) {
            out->no_memory = true;
            return NULL;
        }
        noc_near_group *g = &out->groups.data[out->groups.len++];
        memset(g, 0, sizeof(*g));
        for (int i = 0; i < BLOCK; i++)
            g->size[i] = -INFINITY;
    }
    return &out->groups.data[out->groups.len - 1];
}

static void keep_near(const noc_influence *v, uint32_t volume, noc_near *out) {
    const noc_influence_volume *a = &v->volumes[volume];
    noc_near_group *g = group_with_room(out);
    if (!g)
        return;
    size_t lane = out->count++ % BLOCK;
    for (int k = 0; k < 3; k++) {
        g->c[k][lane] = a->c[k];
        g->m[k][lane] = a->m[k];
    }
    g->size[lane] = a->size;
    g->root[lane] = a->root;
    g->lights[lane] = v->first ? (float)(v->first[volume + 1] - v->first[volume]) : 1;
    g->volume[lane] = volume;
}

/* Could the volume hold a point? Those that face away from the whole box cannot. */
FN mask volume_near(influence a, influence_region r, real scale) {
    v3 size = fill3(a.size);
    return and_(box_near(sub3(a.c, size), add3(a.c, size), r, a.root * scale), influence_shines(a, r));
}

static void leaf_near(const noc_influence *v, size_t leaf, influence_region r, real scale, noc_near *out) {
    uint32_t first = (uint32_t)leaf * BLOCK, bits = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 i = KU(first) + lane_numbers(l);
        influence a = influence_gather(v->volumes, selu(i < KU(v->volume_count), i, KU(v->volume_count)));
        bits |= mbits(volume_near(a, r, scale)) << l;
    }
    for (; bits; bits &= bits - 1)
        keep_near(v, first + (uint32_t)__builtin_ctz(bits), out);
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

/* What is near a box, of what is near a larger one. */
static void near_of_near(const noc_influence *v, const noc_near_query *q, const noc_near *all, noc_near *out) {
    influence_region r = region_splat(q);
    real scale = with_margin(q->scale);
    out->count = out->groups.len = 0;
    out->over = false;
    out->no_memory = all->no_memory;
    for (size_t i = 0; i < all->groups.len; i++) {
        const noc_near_group *g = &all->groups.data[i];
        uint32_t bits = 0;
        for (int l = 0; l < BLOCK; l += LANES)
            bits |= mbits(volume_near(group_load(g, l), r, scale)) << l;
        for (; bits; bits &= bits - 1)
            keep_near(v, g->volume[__builtin_ctz(bits)], out);
    }
}

static void influence_near(const noc_influence *v, const noc_near_query *q, noc_near *out) {
    struct { int level; size_t node; } stack[NOC_INFLUENCE_LEVELS * BLOCK];
    int depth = 0;
    influence_region r = region_splat(q);
    real scale = with_margin(q->scale);
    out->count = out->groups.len = 0;
    out->over = out->no_memory = false;
    if (!v->levels || q->lo[0] > q->hi[0])
        return;
    stack[depth++].level = v->levels - 1, stack[0].node = 0;
    while (depth) {
        int level = stack[--depth].level;
        size_t node = stack[depth].node;
        for (uint32_t bits = children_near(&v->nodes[level][node], r, scale); bits; bits &= bits - 1) {
            size_t child = node * BLOCK + (size_t)__builtin_ctz(bits);
            if (level) {
                stack[depth].level = level - 1;
                stack[depth++].node = child;
                continue;
            }
            leaf_near(v, child, r, scale, out);
            if (out->count > q->most) {
                out->over = true;
                return;
            }
        }
    }
}

/* ---- for all blocks of a tile ---- */

enum { TILE_VOLUMES = 4096 };

/* A side in the making: least and greatest of what each lane has seen. */
typedef struct side_lanes {
    ALIGNED float lo[3][BLOCK];
    ALIGNED float hi[3][BLOCK];
    ALIGNED float back[BLOCK];
    float n[3], offset; /* of its plane */
} side_lanes;

static void side_begin(side_lanes *s, const float n[3], float offset) {
    for (int l = 0; l < BLOCK; l++) {
        for (int k = 0; k < 3; k++) {
            s->lo[k][l] = INFINITY;
            s->hi[k][l] = -INFINITY;
        }
        s->back[l] = INFINITY;
    }
    memcpy(s->n, n, sizeof(s->n));
    s->offset = offset;
}

FN v3 point_load(const gblock *g, int l) { return V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l)); }

/* Those of `lanes` that lie in the plane of a side, to 1 m, and have its normal. */
static uint32_t side_holds(const side_lanes *s, const gblock *g, uint32_t lanes) {
    uint32_t bits = 0;
    v3 n = splat3(s->n);
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 d = sub3(V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l)), n);
        real off = dot3(n, point_load(g, l)) - K(s->offset);
        bits |= mbits(and_(max_(max_(abs_(d.x), abs_(d.y)), abs_(d.z)) <= K(NOC_SAME_NORMAL), abs_(off) <= K(1.0f))) << l;
    }
    return bits & lanes;
}

static void side_add(side_lanes *s, const gblock *g, uint32_t lanes) {
    const float *const p[3] = { g->px, g->py, g->pz };
    v3 n = splat3(s->n);
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        for (int k = 0; k < 3; k++) {
            real x = rload(p[k] + l);
            rstore(s->lo[k] + l, min_(rload(s->lo[k] + l), sel(on, x, K(INFINITY))));
            rstore(s->hi[k] + l, max_(rload(s->hi[k] + l), sel(on, x, K(-INFINITY))));
        }
        rstore(s->back + l, min_(rload(s->back + l), sel(on, dot3(n, point_load(g, l)), K(INFINITY))));
    }
}

static noc_near_query side_query(const side_lanes *s, float scale, bool plane) {
    noc_near_query q = noc_near_none(scale, TILE_VOLUMES);
    for (int l = 0; l < BLOCK; l++) {
        for (int k = 0; k < 3; k++) {
            q.lo[k] = NOC_MIN(q.lo[k], s->lo[k][l]);
            q.hi[k] = NOC_MAX(q.hi[k], s->hi[k][l]);
        }
        q.back = NOC_MIN(q.back, s->back[l]);
    }
    memcpy(q.n, s->n, sizeof(q.n));
    if (!plane)
        q.back = -INFINITY;
    return q;
}

/* The sides of a tile of n blocks. */
static void influence_around(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int n, noc_around *out) {
    const noc_render_params *params = ctx->frame->params;
    float scale = params->influence > 0 ? noc_influence_scale(params->influence) : ctx->influence->scale;
    side_lanes sides[NOC_AROUND_SIDES];
    side_begin(&sides[0], (const float[3]){ 0 }, 0);
    out->sides = 1;
    for (int i = 0; i < n; i++) {
        side_add(&sides[0], g[i], lanes[i]);
        uint32_t left = lanes[i];
        for (int side = 1; left && side < NOC_AROUND_SIDES; side++) {
            if (side == out->sides) {
                int l = __builtin_ctz(left);
                const float normal[3] = { g[i]->nx[l], g[i]->ny[l], g[i]->nz[l] };
                side_begin(&sides[side], normal, normal[0] * g[i]->px[l] + normal[1] * g[i]->py[l] + normal[2] * g[i]->pz[l]);
                out->sides++;
            }
            uint32_t part = side_holds(&sides[side], g[i], left);
            if (part)
                side_add(&sides[side], g[i], part);
            left &= ~part;
        }
    }
    for (int side = 0; side < out->sides; side++) {
        out->query[side] = side_query(&sides[side], scale, side > 0);
        out->asked[side] = false;
    }
}

/* The side that holds all points of a query: of a plane if there is one, else all. */
static int around_side(const noc_around *a, const noc_near_query *q) {
    for (int side = 1; side < a->sides; side++) {
        const noc_near_query *b = &a->query[side];
        bool inside = q->back >= b->back - 1e-3f;
        for (int k = 0; k < 3; k++)
            inside = inside && q->lo[k] >= b->lo[k] && q->hi[k] <= b->hi[k] && fabsf(q->n[k] - b->n[k]) <= NOC_SAME_NORMAL;
        if (inside)
            return side;
    }
    return 0;
}

/* What a tile has near one of its sides; NULL where that is so much that each block looks for itself. */
static const noc_near *around_near(const noc_influence *v, noc_around *a, int side) {
    noc_near *near = &a->near[side];
    if (!a->asked[side]) {
        const noc_near *all = side ? around_near(v, a, 0) : NULL;
        if (all)
            near_of_near(v, &a->query[side], all, near);
        else
            influence_near(v, &a->query[side], near);
        a->asked[side] = true;
    }
    return near->over ? NULL : near;
}

#endif
