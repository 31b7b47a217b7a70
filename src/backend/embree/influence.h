/* Candidates from influence volumes (core/influence.h, light/influence.h), included by kernels.c.
 *
 * Points of a block that lie close together ask as one, 16 volumes against the box around them, and share a list of lights:
 * a sixteenth of the tests, and lights that stay in the cache. They settle for the S_r that draws best there
 * (light/influence_rule.h), the scene's or less. With an S_r that the user gave, every point has that one. */
#ifndef NOC_EMBREE_INFLUENCE_H
#define NOC_EMBREE_INFLUENCE_H

#include "backend/embree/influence_near.h"

/* Points are close that are within so much of the reach of the scene's median light. */
static const float influence_close = 0.25f;

FN mask box_gather_meets(const noc_influence *v, u32 volume, influence_region r) {
    const noc_influence_box *boxes = v->boxes;
    u32 at = word_gather(v->box_of, volume) * KU(6u);
    v3 lo = V3(real_gather(boxes, at), real_gather(boxes, at + KU(1u)), real_gather(boxes, at + KU(2u)));
    v3 hi = V3(real_gather(boxes, at + KU(3u)), real_gather(boxes, at + KU(4u)), real_gather(boxes, at + KU(5u)));
    return influence_meets(lo, hi, r);
}

/* The lines of records of so many floats, and of words, that lanes will ask for. */
FN void record_prefetch(const float *records, size_t stride, u32 index) {
    uint32_t at[LANES];
    ustore(at, index);
    for (int i = 0; i < LANES; i++)
        __builtin_prefetch(records + (size_t)at[i] * stride);
}
FN void word_prefetch(const uint32_t *base, u32 index) { record_prefetch((const float *)base, 1, index); }

/* ---- what the points find ---- */

FN influence_region region_load(const noc_found *f, int l) {
    influence_region r;
    r.lo = load3(f->lo, l);
    r.hi = load3(f->hi, l);
    r.n = load3(f->n, l);
    r.back = rload(f->back + l);
    return r;
}

/* The S_r that the query's points need for each volume near it. False: no memory. */
static bool look_closer(const noc_influence *v, const noc_near *near, const noc_near_query *q, noc_found *f) {
    influence_region r = region_splat(q);
    if (!array_reserve(&f->needs, near->groups.len * 16))
        return false;
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        for (int l = 0; l < 16; l += LANES) {
            real needs = influence_needs(group_load(group, l), r);
            if (v->boxes)
                needs = sel(box_gather_meets(v, uload(group->volume + l), r), needs, INFLUENCE_NEVER);
            rstore(f->needs.data + i * 16 + (size_t)l, needs);
        }
    }
    return true;
}

/* The S_r that draws best there, the query's or less. */
static float best_scale(const noc_influence *v, const noc_near *near, const noc_near_query *q, int every, noc_found *f) {
    influence_region r = region_splat(q);
    noc_rule_begin(&f->bins, q->scale);
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        const float *needs = f->needs.data + i * 16;
        for (int l = 0; l < 16; l += LANES) {
            ALIGNED float gives[LANES];
            uint32_t bits = mbits(rload(needs + l) <= K(q->scale));
            if (!bits)
                continue;
            rstore(gives, influence_gives(group_load(group, l), r));
            for (; bits; bits &= bits - 1) {
                int k = __builtin_ctz(bits);
                noc_rule_add(&f->bins, needs[l + k], group->lights[l + k], gives[k]);
            }
        }
    }
    return fminf(noc_rule_best(&f->bins, (float)v->count, every, v->rule), q->scale);
}

/* Appends the lights whose volumes need no more than `scale`. */
static void take_lights(const noc_influence *v, const noc_near *near, float scale, noc_found *f) {
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        uint32_t bits = 0;
        for (int l = 0; l < 16; l += LANES)
            bits |= mbits(rload(f->needs.data + i * 16 + (size_t)l) <= K(scale)) << l;
        for (; bits; bits &= bits - 1) {
            uint32_t volume = group->volume[__builtin_ctz(bits)], first = v->first ? v->first[volume] : volume;
            uint32_t end = v->first ? v->first[volume + 1] : first + 1;
            if (!array_reserve(&f->ids, f->ids.len + end - first)) {
                f->no_memory = true;
                return;
            }
            for (uint32_t k = first; k < end; k++)
                f->ids.data[f->ids.len++] = v->ids[k];
        }
    }
}

/* The points of `pending` that ask together with the first of them: those within `close` of it that face about the same way. */
static uint32_t points_close(const gblock *g, uint32_t pending, float close) {
    int first = __builtin_ctz(pending);
    v3 p = V3(K(g->px[first]), K(g->py[first]), K(g->pz[first])), n = V3(K(g->nx[first]), K(g->ny[first]), K(g->nz[first]));
    uint32_t bits = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 d = sub3(V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l)), p);
        real cos = dot3(n, V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l)));
        bits |= mbits(and_(dot3(d, d) <= K(close * close), cos > K(0.9f))) << l;
    }
    return (bits & pending) | 1u << first;
}

/* What the points of a query find; `part` are their lanes. */
static void part_finds(const noc_influence *v, const noc_near_query *q, uint32_t part, bool fixed, int every,
                       noc_around *around, noc_found *f) {
    size_t from = f->ids.len;
    const noc_near *near = around ? around_near(v, around, around_side(around, q)) : NULL;
    if (!near) {
        influence_near(v, q, &f->near);
        near = &f->near;
    }
    f->no_memory = f->no_memory || near->no_memory || !look_closer(v, near, q, f);
    if (f->no_memory)
        return;
    float settled = fixed ? q->scale : best_scale(v, near, q, every, f);
    take_lights(v, near, settled, f);
    for (uint32_t bits = part; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        f->count[l] = (uint32_t)(f->ids.len - from);
        f->from[l] = f->count[l] ? (uint32_t)from : 0;
        f->scale[l] = settled;
        for (int k = 0; k < 3; k++) {
            f->lo[k][l] = q->lo[k];
            f->hi[k][l] = q->hi[k];
            f->n[k][l] = q->n[k];
        }
        f->back[l] = q->back;
    }
}

/* What each point of `lanes` finds. around: of a tile that holds the block, or NULL. */
static void influence_find(const noc_influence *v, const gblock *g, uint32_t lanes, float fixed, int every,
                           noc_around *around, noc_found *f) {
    const float *const p[3] = { g->px, g->py, g->pz }, *const n[3] = { g->nx, g->ny, g->nz };
    float scale = fixed > 0 ? fixed : v->scale, close = influence_close * scale * v->volumes[v->volume_count / 2].root;
    memset(f->count, 0, sizeof(f->count));
    memset(f->from, 0, sizeof(f->from));
    f->no_memory = !array_reserve(&f->ids, 1);
    if (f->no_memory)
        return;
    f->ids.data[0] = 0; /* where lanes look that found nothing */
    f->ids.len = 1;
    for (uint32_t pending = lanes, part; pending && !f->no_memory; pending &= ~part) {
        part = points_close(g, pending, close);
        noc_near_query q = noc_near_none(scale, SIZE_MAX);
        noc_near_add(&q, p, n, part);
        part_finds(v, &q, part, fixed > 0, every, around, f);
    }
}

/* ---- draws ---- */

/* Uniform draws of a block's lanes from l on get their densities: the light's own volume is asked. `ahead` draws at a time,
 * so that memory is waited for once. */
static void weigh_uniform(const noc_influence *v, const noc_found *f, int l, int m, int every, real in, real out,
                          pick_block *picks) {
    enum { AHEAD = 16 };
    u32 volume[AHEAD];
    influence_region r = region_load(f, l);
    real scale = rload(f->scale + l);
    mask any = uload(f->count + l) > KU(0u);
    for (int first = 0; first < m; first += AHEAD * every) {
        int end = NOC_MIN(m, first + AHEAD * every), k = 0;
        for (int i = first; i < end; i += every, k++) {
            volume[k] = word_gather(v->volume_of, uload(picks->light[i] + l));
            record_prefetch(v->volumes->c, 8, volume[k]);
        }
        k = 0;
        for (int i = first; i < end; i += every, k++) {
            mask held = and_(influence_needs(influence_gather(v->volumes, volume[k]), r) <= scale, any);
            if (v->boxes && ANY(held))
                held = and_(held, box_gather_meets(v, volume[k], r));
            rstore(picks->inverse[i] + l, sel(held, in, out));
        }
    }
}

static void influence_draw(const struct core_context *ctx, const noc_found *f, int x, int y, int m,
                           pick_block *out) {
    const noc_influence *v = ctx->influence;
    int every = ctx->frame->params->uniform_every;
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l), count = uload(f->count + l), from = uload(f->from + l), all = KU(v->count);
        mask any = count > KU(0u);
        real p_in = K(1.0f) / influence_pmf(any, count, all, m, every);
        real p_out = K(1.0f) / influence_pmf(mload(0, l), count, all, m, every);
        for (int i = 0; i < m; i++) {
            u32 bits = rng_bits(key, KU(DIM_CANDIDATE + 3u * U32(i)));
            u32 id = scale_u32(bits, all);
            if (i % every == 0) {
                word_prefetch(v->volume_of, id);
            } else if (ANY(any)) {
                id = selu(any, word_gather(f->ids.data, from + scale_u32(bits, count)), id);
                rstore(out->inverse[i] + l, sel(any, p_in, p_out));
            } else {
                rstore(out->inverse[i] + l, p_out);
            }
            ustore(out->light[i] + l, id);
        }
        weigh_uniform(v, f, l, m, every, p_in, p_out, out);
    }
}

static void pick_influence(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                           noc_around *around, noc_found *found, pick_block *out) {
    influence_find(ctx->influence, g, lanes, noc_influence_scale(ctx->frame->params->influence),
                   ctx->frame->params->uniform_every, around, found);
    influence_draw(ctx, found, x, y, m, out);
}

#endif
