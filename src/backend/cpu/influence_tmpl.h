/* Candidates from influence volumes (core/influence.h, light/influence.h), included by kernels.c.
 *
 * Points of a tile that lie close together ask as one, 16 volumes against the box around them, and share a list of
 * lights: a hundredth of the tests, and lights that stay in the cache. Of the lights whose volumes hold them they list
 * the strongest, as many as draw best there (light/influence_rule.h). With an S_r that the user gave they list all. */
#ifndef NOC_CPU_INFLUENCE_H
#define NOC_CPU_INFLUENCE_H

#include "backend/cpu/influence_near_tmpl.h"

#include "core/influence_draw.h"

#define RULE_BINS_OF(ctx) (&(ctx)->at.volumes->bins)
#include "light/influence_bins.h"

/* Points are close that are within so much of the reach of the scene's median light. */
static const float influence_close = 0.125f;

FN u32 influence_found(CTX u32 place) { return word_gather(ctx->at.volumes->ids.data, place); }
FN u32 influence_volume(CTX u32 id) { return word_gather(ctx->influence->volume_of, id); }

FN mask influence_seen(CTX u32 volume, influence_region r) {
    const noc_influence *v = ctx->influence;
    const noc_influence_box *boxes = v->boxes;
    if (!boxes)
        return KU(0u) == KU(0u);
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

/* The region of a query in every lane. */
FN influence_region region_splat(const noc_near_query *q) {
    return influence_box(splat3(q->lo), splat3(q->hi), splat3(q->n), K(q->back));
}

/* What each volume near the query's points gives them, lux, from the query's `least` on, which is added to the bins;
 * where that is 0, 1 if it holds them. 0: nothing. False: no memory. */
static bool look_closer(const struct core_context *ctx, const noc_near *near, const noc_near_query *q, noc_found *f) {
    influence_region r = region_splat(q);
    rule_range range = rule_from(q->least);
    if (!array_reserve(&f->gives, near->groups.len * 16))
        return false;
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        for (int l = 0; l < 16; l += LANES) {
            float *to = f->gives.data + i * 16 + (size_t)l;
            influence a = group_load(group, l);
            mask held = influence_holds(a, r, K(q->scale));
            if (ANY(held))
                held = and_(held, influence_seen(ctx, uload(group->volume + l), r));
            real gives = sel(held, K(1.0f), K(0.0f));
            if (q->least > 0 && ANY(held))
                gives = sel(held, influence_gives(a, rload(group->turn + l), r), K(0.0f));
            gives = sel(gives >= K(q->least), gives, K(0.0f));
            rstore(to, gives);
            for (uint32_t bits = q->least > 0 ? mbits(gives > K(0.0f)) : 0; bits; bits &= bits - 1)
                rule_add(ctx, range, group->lights[l + __builtin_ctz(bits)], to[__builtin_ctz(bits)]);
        }
    }
    return true;
}

/* Appends the lights of volumes that give at least `least`. */
static void take_lights(const noc_influence *v, const noc_near *near, float least, noc_found *f) {
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        uint32_t bits = 0;
        for (int l = 0; l < 16; l += LANES)
            bits |= mbits(rload(f->gives.data + i * 16 + (size_t)l) >= K(least)) << l;
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

/* The points of `pending` within `close` of p that face about the same way as n. */
static uint32_t points_close(const gblock *g, uint32_t pending, v3 p, v3 n, float close) {
    uint32_t bits = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 d = sub3(V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l)), p);
        real cos = dot3(n, V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l)));
        bits |= mbits(and_(dot3(d, d) <= K(close * close), cos > K(0.9f))) << l;
    }
    return bits & pending;
}

/* The points that ask together with the first of those pending in block `first`, in that one and those after it. */
static void make_group(const gblock *const *g, uint32_t *pending, int first, int blocks, float close,
                       const noc_near_query *none, noc_found *f) {
    int lane = __builtin_ctz(pending[first]), number = f->groups++;
    const gblock *o = g[first];
    v3 p = V3(K(o->px[lane]), K(o->py[lane]), K(o->pz[lane])), n = V3(K(o->nx[lane]), K(o->ny[lane]), K(o->nz[lane]));
    noc_found_group *group = &f->group[number];
    *group = (noc_found_group){ .query = *none };
    for (int b = first; b < blocks; b++) {
        uint32_t part = pending[b] ? points_close(g[b], pending[b], p, n, close) : 0;
        if (b == first)
            part |= 1u << lane;
        if (!part)
            continue;
        noc_near_add(&group->query, (const float *const[3]){ g[b]->px, g[b]->py, g[b]->pz },
                     (const float *const[3]){ g[b]->nx, g[b]->ny, g[b]->nz }, part);
        pending[b] &= ~part;
        for (; part; part &= part - 1)
            f->of[b][__builtin_ctz(part)] = (uint16_t)number;
    }
}

/* What the points of a group find among the volumes near them. */
static void group_finds(const struct core_context *ctx, const noc_near *near, noc_found *f, noc_found_group *group) {
    const noc_influence *v = ctx->influence;
    noc_near_query *q = &group->query;
    rule_range range = rule_from(q->least);
    if (q->least > 0)
        range = rule_begin(ctx, q->least);
    f->no_memory = f->no_memory || near->no_memory || !look_closer(ctx, near, q, f);
    if (f->no_memory)
        return;
    group->from = (uint32_t)f->ids.len;
    if (q->least > 0)
        q->least =
            fmaxf(rule_best(ctx, range, rule_of_record(&v->rule), (float)v->count, (float)ctx->frame->uniform_every),
                  q->least);
    take_lights(v, near, q->least > 0 ? q->least : 1, f);
    group->count = (uint32_t)f->ids.len - group->from;
    group->from = group->count ? group->from : 0;
}

enum { TILE_VOLUMES = 16384 };

/* What the points of a tile find. Volumes are looked for once, near all of them; where that is too many, for each
 * group. */
static void influence_find(const struct core_context *frame, const gblock *const *g, const uint32_t *lanes, int n,
                           noc_found *f) {
    struct core_context c = *frame, *ctx = &c;
    const noc_influence *v = ctx->influence;
    c.at.volumes = f;
    float fixed = ctx->frame->influence, scale = fixed > 0 ? fixed : v->scale;
    float close = influence_close * scale * v->usual;
    uint32_t pending[NOC_QUERY_BLOCKS];
    noc_near_query all = noc_near_none(scale, TILE_VOLUMES), none = noc_near_none(scale, UINT32_MAX);
    none.least = fixed > 0 ? 0 : 1 / (scale * scale);
    memset(f->of, 0, sizeof(f->of));
    f->group[0] = (noc_found_group){ .query = none };
    f->groups = 1;
    f->no_memory = !array_reserve(&f->ids, 1);
    if (f->no_memory)
        return;
    f->ids.data[0] = 0; /* where lanes look that found nothing */
    f->ids.len = 1;
    memcpy(pending, lanes, (size_t)n * sizeof(*pending));
    for (int b = 0; b < n; b++)
        while (pending[b])
            make_group(g, pending, b, n, close, &none, f);
    for (int i = 1; i < f->groups; i++)
        for (int k = 0; k < 3; k++) {
            all.lo[k] = NOC_MIN(all.lo[k], f->group[i].query.lo[k]);
            all.hi[k] = NOC_MAX(all.hi[k], f->group[i].query.hi[k]);
        }
    all.back = -INFINITY;
    bool together = look_near(ctx, 0, &all) || f->near[0].no_memory;
    for (int i = 1; i < f->groups; i++) {
        if (!together)
            look_near(ctx, 1, &f->group[i].query);
        group_finds(ctx, &f->near[together ? 0 : 1], f, &f->group[i]);
    }
}

/* What the points of a block asked with, and found. */
typedef struct asking {
    ALIGNED float lo[3][BLOCK];
    ALIGNED float hi[3][BLOCK];
    ALIGNED float n[3][BLOCK];
    ALIGNED float back[BLOCK];
    ALIGNED float least[BLOCK];
    ALIGNED uint32_t count[BLOCK];
    ALIGNED uint32_t from[BLOCK];
} asking;

static void asking_of(const noc_found *f, const uint16_t of[BLOCK], asking *a) {
    for (int l = 0; l < BLOCK; l++) {
        const noc_found_group *group = &f->group[of[l]];
        for (int k = 0; k < 3; k++) {
            a->lo[k][l] = group->query.lo[k];
            a->hi[k][l] = group->query.hi[k];
            a->n[k][l] = group->query.n[k];
        }
        a->back[l] = group->query.back;
        a->least[l] = group->query.least;
        a->count[l] = group->count;
        a->from[l] = group->from;
    }
}

FN influence_asked asked_load(const asking *a, int l) {
    influence_asked q;
    q.r = influence_box(load3(a->lo, l), load3(a->hi, l), load3(a->n, l), rload(a->back + l));
    q.least = rload(a->least + l);
    q.count = uload(a->count + l);
    q.from = uload(a->from + l);
    return q;
}

/* ---- draws ---- */

/* Uniform draws of a block's lanes from l on get their densities: the light's own volume is asked. `ahead` draws at a
 * time, so that memory is waited for once. */
static void weigh_uniform(const struct core_context *ctx, influence_asked a, const noc_near_query *q, int l, int m,
                          int every, real in, real out, pick_block *picks) {
    enum { AHEAD = 16 };
    u32 volume[AHEAD];
    for (int first = 0; first < m; first += AHEAD * every) {
        int end = NOC_MIN(m, first + AHEAD * every), k = 0;
        for (int i = first; i < end; i += every, k++) {
            volume[k] = influence_volume(ctx, uload(picks->light[i] + l));
            record_prefetch(ctx->influence->volumes->c, 8, volume[k]);
        }
        k = 0;
        for (int i = first; i < end; i += every, k++) {
            mask held = influence_lists(ctx, volume[k], influence_load(ctx, volume[k]), a, K(q->scale), q->least > 0);
            rstore(picks->inverse[i] + l, sel(held, in, out));
        }
    }
}

/* Draws for a block of the tile that found that: those of influence_candidate. */
static void pick_influence(const struct core_context *frame, const noc_found *f, int block, int x, int y, int m,
                           pick_block *out) {
    struct core_context c = *frame, *ctx = &c;
    int every = (int)ctx->frame->uniform_every;
    asking a;
    c.at.volumes = (noc_found *)f; /* is read */
    asking_of(f, f->of[block], &a);
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l), all = KU(ctx->influence->count);
        influence_asked q = asked_load(&a, l);
        mask any = q.count > KU(0u);
        real p_in = K(1.0f) / influence_pmf(any, q.count, all, m, every);
        real p_out = K(1.0f) / influence_pmf(mload(0, l), q.count, all, m, every);
        for (int i = 0; i < m; i++) {
            u32 id = influence_light(ctx, q, key, all, i, every);
            if (influence_from_all(i, every))
                word_prefetch(ctx->influence->volume_of, id);
            else
                rstore(out->inverse[i] + l, sel(any, p_in, p_out));
            ustore(out->light[i] + l, id);
        }
        weigh_uniform(ctx, q, &f->group[0].query, l, m, every, p_in, p_out, out);
    }
}

#endif
