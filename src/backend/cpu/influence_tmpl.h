/* Candidates from influence volumes (core/influence_find.h, light/influence.h), included by kernels.c. */
#ifndef NOC_CPU_INFLUENCE_H
#define NOC_CPU_INFLUENCE_H

#include "backend/cpu/influence_near_tmpl.h"

#include "core/influence_find.h"

#define RULE_BINS_OF(ctx) (&(ctx)->at.volumes->bins)
#include "light/influence_bins.h"

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

/* ---- what the points find ---- */

FN u1 points_pending(CTX u1 block) { return ctx->at.volumes->pending[block]; }
FN void points_ask(CTX u1 block, u1 bits, u1 group) {
    noc_found *f = ctx->at.volumes;
    f->pending[block] &= ~bits;
    for (; bits; bits &= bits - 1)
        f->of[block][low_bit(bits)] = (uint16_t)group;
}
FN f3 point_place(CTX u1 block, u1 lane) {
    const gblock *g = ctx->at.tile[block];
    return (f3){ g->px[lane], g->py[lane], g->pz[lane] };
}
FN f3 point_normal(CTX u1 block, u1 lane) {
    const gblock *g = ctx->at.tile[block];
    return (f3){ g->nx[lane], g->ny[lane], g->nz[lane] };
}
FN v3 point_places(CTX u1 block, u1 l) {
    const gblock *g = ctx->at.tile[block];
    return V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l));
}
FN v3 point_normals(CTX u1 block, u1 l) {
    const gblock *g = ctx->at.tile[block];
    return V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l));
}

FN near_query group_load(CTX u1 group) { return query_of_record(&ctx->at.volumes->group[group].query); }
FN void group_store(CTX u1 group, near_query q, u1 from, u1 count) {
    ctx->at.volumes->group[group] = (noc_found_group){ record_of_query(q), count, from };
}

FN b1 gives_room(CTX u1 list) {
    noc_found *f = ctx->at.volumes;
    size_t packs = f->near[list].count / BLOCK + 1;
    return array_reserve(&f->looked, packs) && array_reserve(&f->gives, packs * BLOCK);
}
FN void looked_store(CTX u1 i, u1 pack) { ctx->at.volumes->looked.data[i] = pack; }
FN u1 looked_load(CTX u1 i) { return ctx->at.volumes->looked.data[i]; }
FN void gives_store(CTX u1 first, real gives) { rstore(ctx->at.volumes->gives.data + first, gives); }
FN real gives_load(CTX u1 first) { return rload(ctx->at.volumes->gives.data + first); }
FN f1 gives_at(CTX u1 place) { return ctx->at.volumes->gives.data[place]; }

FN u1 found_next(CTX u1 group) {
    (void)group;
    return (u1)ctx->at.volumes->ids.len;
}
FN b1 found_add(CTX u1 list, u1 first, u1 bits) {
    const noc_influence *v = ctx->influence;
    noc_found *f = ctx->at.volumes;
    u32 volumes = near_ids(ctx, list, first);
    if (!v->first) {
        if (!array_reserve(&f->ids, f->ids.len + BLOCK))
            return false;
        u32 ids = word_gather(v->ids, selu(mload(bits, 0), volumes, KU(0u)));
        lanes_pack(f->ids.data + f->ids.len, ids, lanes_of(bits));
        f->ids.len += bit_count(bits);
        return true;
    }
    uint32_t volume[LANES];
    for (ustore(volume, volumes); bits; bits &= bits - 1) {
        uint32_t begin = v->first[volume[low_bit(bits)]], end = v->first[volume[low_bit(bits)] + 1];
        if (!array_reserve(&f->ids, f->ids.len + end - begin))
            return false;
        for (uint32_t k = begin; k < end; k++)
            f->ids.data[f->ids.len++] = v->ids[k];
    }
    return true;
}

/* What the points of a tile find. */
static void find_influence(const struct core_context *frame, const gblock *const *g, const uint32_t *lanes, int n,
                           noc_found *f) {
    struct core_context c = *frame, *ctx = &c;
    const noc_influence *v = ctx->influence;
    c.at.volumes = f;
    c.at.tile = g;
    memset(f->of, 0, sizeof(f->of));
    memcpy(f->pending, lanes, (size_t)n * sizeof(*lanes));
    f->no_memory = !array_reserve(&f->ids, 1);
    if (f->no_memory)
        return;
    f->ids.data[0] = 0; /* where lanes look that found nothing */
    f->ids.len = 1;
    f->groups = (int)influence_find(ctx, (u1)n, near_asks(ctx->frame->influence, v->scale), v->usual,
                                    rule_of_record(&v->rule), (float)v->count, (float)ctx->frame->uniform_every);
    f->no_memory = !f->groups;
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

/* The volumes of lights that were drawn from all, once a frame. */
static void influence_volumes(const struct core_context *ctx, int m, const presample_row *rows,
                              presample_volumes *out) {
    for (int i = 0; i < m; i++)
        for (int l = 0; l < BLOCK; l += LANES) {
            u32 id = influence_volume(ctx, uload(rows[i].light + l));
            influence v = influence_load(ctx, id);
            const v3 three[2] = { v.c, v.m };
            float(*const to[2])[BLOCK] = { out[i].c, out[i].m };
            for (int k = 0; k < 2; k++) {
                rstore(to[k][0] + l, three[k].x);
                rstore(to[k][1] + l, three[k].y);
                rstore(to[k][2] + l, three[k].z);
            }
            rstore(out[i].size + l, v.size);
            rstore(out[i].root + l, v.root);
            rstore(out[i].turn + l, influence_turn(v));
            ustore(out[i].id + l, id);
        }
}

FN influence volumes_load(const presample_volumes *p, int l) {
    influence v;
    v.c = load3(p->c, l);
    v.size = rload(p->size + l);
    v.m = load3(p->m, l);
    v.root = rload(p->root + l);
    return v;
}

/* Samples that are drawn from all lights get their densities, by whether the lanes' points list them. */
FN void weigh_uniform(CTX influence_asked a, const noc_near_query *q, int l, int m, real in, real out,
                      const presample_volumes *volumes, presample_row *rows) {
    for (int i = 0; i < m; i++) {
        const presample_volumes *p = &volumes[i];
        mask held = influence_lists(ctx, uload(p->id + l), volumes_load(p, l), rload(p->turn + l), a, K(q->scale),
                                    q->least > 0);
        rstore(rows[i].inverse + l, sel(held, in, out));
    }
}

/* A set of samples for pixels of these groups, a lane each; shared: samples that are drawn from all lights. */
static void draw_influence(const struct core_context *frame, const noc_found *f, const uint16_t of[BLOCK],
                           uint32_t number, int m, const presample_row *shared, const presample_volumes *volumes,
                           presample_row *rows) {
    struct core_context c = *frame, *ctx = &c;
    int every = (int)ctx->frame->uniform_every, listed = (int)influence_listed((u1)m, (u1)every);
    u1 key = presample_key(ctx->frame->seed, number, ctx->frame->index, 0);
    u1 share = listed ? presample_share((u1)listed * BLOCK) : 0;
    asking a;
    c.at.volumes = (noc_found *)f; /* is read */
    asking_of(f, of, &a);
    memcpy(rows + listed, shared, (size_t)(m - listed) * sizeof(*rows));
    for (int l = 0; l < BLOCK; l += LANES) {
        influence_asked q = asked_load(&a, l);
        u32 all = KU(ctx->influence->count);
        real in = influence_inverse(q.count > KU(0u), q, all, m, every);
        real out = influence_inverse(mload(0, l), q, all, m, every);
        for (int i = 0; i < listed; i++) {
            presample_pick k = influence_draw(ctx, q, key, (u1)i, lane_numbers(l), share, all, in);
            light_prefetch((const float *)ctx->lights, k.light);
            ustore(rows[i].light + l, k.light);
            ustore(rows[i].place + l, k.place);
            rstore(rows[i].inverse + l, k.inverse);
        }
        weigh_uniform(ctx, q, &f->group[0].query, l, m - listed, in, out, volumes, rows + listed);
    }
    for (int i = 0; i < listed; i++)
        brief_samples(ctx, &rows[i]);
}

#endif
