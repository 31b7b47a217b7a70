/* Candidates from influence volumes (core/influence.h, light/influence.h), included by kernels.c.
 *
 * A block looks at the volumes near it, 16 volumes against its box, then 16 points against each volume that is left. A point
 * settles for the S_r that draws best there (influence_best): less than the scene's beside a lamp, and what a wider query
 * gives in the dark, where the next lamp is far away. With an S_r that the user gave, every point has that one. */
#ifndef NOC_EMBREE_INFLUENCE_H
#define NOC_EMBREE_INFLUENCE_H

#include "core/influence.h"

enum { INFLUENCE_RUNGS = 4, WIDER_VOLUMES = 512 };

/* The same volume in every lane. */
FN influence influence_splat(const noc_influence_volume *a) {
    influence v;
    v.c = splat3(a->c);
    v.size = K(a->size);
    v.m = splat3(a->m);
    v.root = K(a->root);
    return v;
}

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

FN mask box_gather_holds(const noc_influence_box *boxes, u32 index, v3 p) {
    u32 at = index * KU(6u);
    v3 lo = V3(real_gather(boxes, at), real_gather(boxes, at + KU(1u)), real_gather(boxes, at + KU(2u)));
    v3 hi = V3(real_gather(boxes, at + KU(3u)), real_gather(boxes, at + KU(4u)), real_gather(boxes, at + KU(5u)));
    return influence_inside(lo, hi, p);
}

/* The lines of records of so many floats, and of words, that lanes will ask for. */
FN void record_prefetch(const float *records, size_t stride, u32 index) {
    uint32_t at[LANES];
    ustore(at, index);
    for (int i = 0; i < LANES; i++)
        __builtin_prefetch(records + (size_t)at[i] * stride);
}
FN void word_prefetch(const uint32_t *base, u32 index) { record_prefetch((const float *)base, 1, index); }

FN v3 point_load(const gblock *g, int l) { return V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l)); }
FN v3 normal_load(const gblock *g, int l) { return V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l)); }

/* ---- what the points find ---- */

/* Volumes of a group whose spheres come near the box of a query. */
static uint32_t group_near(const noc_near_group *g, const noc_near_query *q) {
    uint32_t bits = 0;
    for (int i = 0; i < 16; i += LANES) {
        real x = rload(g->x + i), y = rload(g->y + i), z = rload(g->z + i), r = rload(g->reach + i);
        real dx = max_(max_(K(q->lo[0]) - x, x - K(q->hi[0])), K(0.0f));
        real dy = max_(max_(K(q->lo[1]) - y, y - K(q->hi[1])), K(0.0f));
        real dz = max_(max_(K(q->lo[2]) - z, z - K(q->hi[2])), K(0.0f));
        bits |= mbits(and_(r >= K(0.0f), dx * dx + dy * dy + dz * dz <= r * r)) << i;
    }
    return bits;
}

static uint32_t lights_of(const noc_influence *v, uint32_t volume) {
    return v->first ? v->first[volume + 1] - v->first[volume] : 1;
}

/* The S_r that the points need for each volume, a row a volume, and the squares of what lights within `scale` give them.
 * Returns the number of rows. */
static uint32_t look_closer(const noc_influence *v, const gblock *g, const noc_near *near, const noc_near_query *q,
                            noc_found *f, float squares[BLOCK]) {
    uint32_t rows = 0;
    array_reserve(&f->needs, near->count * BLOCK);
    array_reserve(&f->volumes, near->count);
    memset(squares, 0, BLOCK * sizeof(*squares));
    for (size_t i = 0; i < near->groups.len; i++) {
        const noc_near_group *group = &near->groups.data[i];
        for (uint32_t bits = group_near(group, q); bits; bits &= bits - 1) {
            uint32_t volume = group->volume[__builtin_ctz(bits)], any = 0;
            real lights = K((float)lights_of(v, volume));
            influence a = influence_splat(&v->volumes[volume]);
            const noc_influence_box *box = v->boxes ? &v->boxes[v->box_of[volume]] : NULL;
            for (int l = 0; l < BLOCK; l += LANES) {
                v3 p = point_load(g, l);
                real needs = influence_needs(a, p, normal_load(g, l));
                if (box)
                    needs = sel(influence_inside(splat3(box->lo), splat3(box->hi), p), needs, INFLUENCE_NEVER);
                mask within = needs <= K(q->scale);
                EXACT real e2 = sel(within, lights * influence_square(needs), K(0.0f));
                rstore(f->needs.data + (size_t)rows * BLOCK + l, needs);
                rstore(squares + l, rload(squares + l) + e2);
                any |= mbits(within) << l;
            }
            f->volumes.data[rows] = volume;
            rows += any != 0;
        }
    }
    return rows;
}

/* Points of `lanes` take the best S_r up to that of the query; returns those that wanted more. */
static uint32_t settle(const noc_influence *v, noc_found *f, const float squares[BLOCK], float scale, int every, uint32_t lanes) {
    uint32_t left = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        real best = influence_best(rload(squares + l), K((float)v->count), every);
        mask on = mload(lanes, l), more = best > K(scale);
        rstore(f->scale + l, sel(on, sel(more, K(scale), best), rload(f->scale + l)));
        left |= mbits(and_(on, more)) << l;
    }
    return left;
}

/* Writes the lights that the points of `lanes` have within their scales. Volumes that hold all of them go to the shared part
 * while `share` says so. */
static void take_lights(const noc_influence *v, noc_found *f, uint32_t rows, uint32_t lanes, bool share) {
    uint32_t own[BLOCK], shared = 0;
    for (int l = 0; l < BLOCK; l++)
        own[l] = lanes >> l & 1 ? 0 : f->count[l] - f->shared[l]; /* others keep what they have */
    for (uint32_t i = 0; i < rows; i++) {
        const float *needs = f->needs.data + (size_t)i * BLOCK;
        uint32_t held = 0, volume = f->volumes.data[i];
        for (int l = 0; l < BLOCK; l += LANES)
            held |= mbits(rload(needs + l) <= rload(f->scale + l)) << l;
        held &= lanes;
        if (!held)
            continue;
        uint32_t first = v->first ? v->first[volume] : volume, end = first + lights_of(v, volume);
        for (uint32_t k = first; k < end; k++) {
            uint32_t id = v->ids[k];
            if (share && held == lanes) {
                f->ids.data[shared++] = id;
                continue;
            }
            for (int l = 0; l < BLOCK; l++) {
                f->ids.data[f->rows + own[l] * BLOCK + (uint32_t)l] = id; /* stays if it is counted */
                own[l] += held >> l & 1;
            }
        }
    }
    for (int l = 0; l < BLOCK; l++)
        if (lanes >> l & 1) {
            f->shared[l] = shared;
            f->count[l] = shared + own[l];
        }
}

static uint32_t lights_in_rows(const noc_influence *v, const noc_found *f, uint32_t rows) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < rows; i++)
        n += lights_of(v, f->volumes.data[i]);
    return n;
}

/* What each point of `lanes` finds. near: volumes near a box that holds the block's, or NULL. */
static void influence_find(const noc_influence *v, const gblock *g, uint32_t lanes, float fixed, int every,
                           const noc_near *near, noc_found *f) {
    const float *const p[3] = { g->px, g->py, g->pz }, *const n[3] = { g->nx, g->ny, g->nz };
    float scale = fixed > 0 ? fixed : v->scale;
    ALIGNED float squares[BLOCK];
    uint32_t pending = lanes, room = 0;
    memset(f->count, 0, sizeof(f->count));
    memset(f->shared, 0, sizeof(f->shared));
    f->wider = 0;
    for (int rung = 0; rung < INFLUENCE_RUNGS && pending; rung++, scale *= 4) {
        noc_near_query q = noc_near_none(scale, rung ? WIDER_VOLUMES : SIZE_MAX);
        noc_near_add(&q, p, n, pending);
        if (rung || !near) {
            noc_influence_near(v, &q, &f->near);
            near = &f->near;
        }
        if (near->over)
            break; /* so many are no help: the points keep what they have */
        uint32_t asked = pending, rows = look_closer(v, g, near, &q, f, squares), lights = lights_in_rows(v, f, rows);
        pending = settle(v, f, squares, scale, every, asked);
        for (int l = 0; l < BLOCK && fixed > 0; l++)
            f->scale[l] = fixed;
        if (!rung)
            f->rows = lights; /* room for all of them to be shared */
        room = NOC_MAX(room, lights + 1);
        array_reserve(&f->ids, (size_t)f->rows + (size_t)room * BLOCK);
        take_lights(v, f, rows, asked, !rung);
        f->wider |= rung ? asked : 0;
        if (fixed > 0)
            break;
    }
}

/* ---- draws ---- */

/* Uniform draws of a block's lanes from l on get their densities: the light's own volume is asked. `ahead` draws at a time,
 * so that memory is waited for once. */
static void weigh_uniform(const noc_influence *v, const gblock *g, const noc_found *f, int l, int m, int every, real in, real out,
                          pick_block *picks) {
    enum { AHEAD = 16 };
    u32 volume[AHEAD];
    v3 p = point_load(g, l), n = normal_load(g, l);
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
            mask held = and_(influence_needs(influence_gather(v->volumes, volume[k]), p, n) <= scale, any);
            if (v->boxes && ANY(held))
                held = and_(held, box_gather_holds(v->boxes, word_gather(v->box_of, volume[k]), p));
            rstore(picks->inverse[i] + l, sel(held, in, out));
        }
    }
}

static void influence_draw(const struct core_context *ctx, const gblock *g, const noc_found *f, int x, int y, int m,
                           pick_block *out) {
    const noc_influence *v = ctx->influence;
    int every = ctx->frame->params->uniform_every;
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l), count = uload(f->count + l), shared = uload(f->shared + l), all = KU(v->count);
        u32 own = KU(f->rows) + lane_numbers(l);
        mask any = count > KU(0u);
        real p_in = K(1.0f) / influence_pmf(any, count, all, m, every);
        real p_out = K(1.0f) / influence_pmf(mload(0, l), count, all, m, every);
        for (int i = 0; i < m; i++) {
            u32 bits = rng_bits(key, KU(DIM_CANDIDATE + 3u * U32(i)));
            u32 id = scale_u32(bits, all);
            if (i % every == 0) {
                word_prefetch(v->volume_of, id);
            } else if (ANY(any)) {
                u32 at = scale_u32(bits, count);
                at = selu(at < shared, at, own + (at - shared) * KU(16u));
                id = selu(any, word_gather(f->ids.data, selu(any, at, own)), id);
                rstore(out->inverse[i] + l, sel(any, p_in, p_out));
            } else {
                rstore(out->inverse[i] + l, p_out);
            }
            ustore(out->light[i] + l, id);
        }
        weigh_uniform(v, g, f, l, m, every, p_in, p_out, out);
    }
}

static void pick_influence(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                           const noc_near *near, noc_found *found, pick_block *out) {
    influence_find(ctx->influence, g, lanes, (float)ctx->frame->params->influence,
                   ctx->frame->params->uniform_every, near, found);
    influence_draw(ctx, g, found, x, y, m, out);
}

#endif
