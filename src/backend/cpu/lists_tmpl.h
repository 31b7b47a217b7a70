/* Light lists (core/lists.h), included by kernels.c: a tile's list is built (list_build.h), then every pixel chooses
 * among its entries. */
#ifndef NOC_CPU_LISTS_H
#define NOC_CPU_LISTS_H

#include "backend/cpu/list_build_tmpl.h"

static void list_candidates(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y,
                            rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        resv r = resv_empty();
        if (ctx->at.lists->list.count && ANY(on)) {
            resv q = ris_list(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l),
                              ctx->at.lists->list.count);
            r = resv_sel(on, q, r);
        }
        r.m = sel(on, K(F32(ctx->frame->draws)), K(0.0f));
        resv_store(out, l, r);
    }
}

/* What every entry weighs at the pixels of a block, and what they are expected to see. */
static void list_weigh(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, const beliefs *e,
                       weighed *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        real all = K(0.0f);
        real bright = K(0.0f);
        if (ANY(on)) {
            surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
            u32 key = key_of(ctx, x, y, l);
            u32 shift_u = rng_bits(key, KU(DIM_CANDIDATE));
            u32 shift_v = rng_bits(key, KU(DIM_CANDIDATE + 1u));
            for (int i = 0; i < (int)ctx->at.lists->list.count; i++) {
                real p = target(s, light_splat(ctx, ctx->at.lists->list.light[i]), list_u(shift_u, KU((uint32_t)i)),
                                list_v(shift_v, KU((uint32_t)i)));
                p = sel(on, p, K(0.0f));
                real w = p * K(e->share[i]);
                rstore(out->weight[i] + l, w);
                all = all + w;
                bright = bright + p * K(e->expect[i]);
            }
        } else {
            for (int i = 0; i < (int)ctx->at.lists->list.count; i++)
                rstore(out->weight[i] + l, K(0.0f));
        }
        rstore(out->all + l, all);
        rstore(out->bright + l, bright);
    }
}

/* Systematic draws: entry[k][l] is where the share (k + start) / n of all the weights lies, for k < n. */
static void list_draw(int count, const weighed *w, const float n[BLOCK], const float start[BLOCK],
                      uint8_t entry[][BLOCK]) {
    for (int l = 0; l < BLOCK; l += LANES) {
        real m = rload(n + l);
        real step = rload(w->all + l) / max_(m, K(1.0f));
        real next = step * rload(start + l);
        real sum = K(0.0f);
        real drawn = K(0.0f);
        float k[LANES], last[LANES];
        real held = K(0.0f);
        for (int i = 0; i < count; i++) {
            real x = rload(w->weight[i] + l);
            sum = sum + x;
            held = sel(x > K(0.0f), K(F32(i)), held);
            mask over = and_(sum > next, drawn < m);
            while (ANY(over)) {
                rstore(k, drawn);
                for (uint32_t bits = mbits(over); bits; bits &= bits - 1) {
                    int lane = __builtin_ctz(bits);
                    entry[(int)k[lane]][l + lane] = (uint8_t)i;
                }
                drawn = sel(over, drawn + K(1.0f), drawn);
                next = sel(over, next + step, next);
                over = and_(sum > next, drawn < m);
            }
        }
        rstore(k, drawn);
        rstore(last, held);
        for (int lane = 0; lane < LANES; lane++) /* what rounding has pushed past the end */
            for (int j = (int)k[lane]; j < (int)n[l + lane]; j++)
                entry[j][l + lane] = (uint8_t)last[lane];
    }
}

/* (u, v) that list_weigh used for a lane's entry. */
static void list_places(const struct core_context *ctx, int x, int y, const uint8_t entry[BLOCK], rblock *out) {
    uint32_t at[BLOCK];
    for (int l = 0; l < BLOCK; l++)
        at[l] = entry[l];
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 key = key_of(ctx, x, y, l);
        rstore(out->u + l, list_u(rng_bits(key, KU(DIM_CANDIDATE)), uload(at + l)));
        rstore(out->v + l, list_v(rng_bits(key, KU(DIM_CANDIDATE + 1u)), uload(at + l)));
    }
}

#endif
