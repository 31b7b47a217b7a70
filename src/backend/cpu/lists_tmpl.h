/* Light lists (core/lists.h), included by kernels.c: a tile's list is built (list_build.h), then every pixel chooses
 * among its entries. */
#ifndef NOC_CPU_LISTS_H
#define NOC_CPU_LISTS_H

#include "backend/cpu/list_build_tmpl.h"
#include "core/list_rays.h"

static void list_candidates(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y,
                            rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        reservoir r = reservoir_empty();
        if (ctx->at.lists->list.count && ANY(on)) {
            reservoir q = ris_list(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l),
                                   ctx->at.lists->list.count);
            r = reservoir_sel(on, q, r);
        }
        r.m = sel(on, K(F32(ctx->frame->draws)), K(0.0f));
        reservoir_store(out, l, r);
    }
}

/* ---- several rays: core/list_rays.h ---- */

FN list_prior prior_load(CTX u1 i) { return (list_prior){ ctx->at.priors->share[i], ctx->at.priors->expect[i] }; }

FN real entry_weight(CTX u32 i) { return real_gather(ctx->at.lists->list.weight, i); }
FN u32 entry_lights(CTX u1 first, int l, u1 count) {
    uint32_t at[LANES];
    for (uint32_t i = 0; i < LANES; i++)
        at[i] = ctx->at.lists->list.light[NOC_MIN(first + (uint32_t)l + i, count - 1)];
    return uload(at);
}
FN void sketch_store(CTX u1 first, int l, list_sketch k) {
    const real field[SKETCH_WORDS - 1] = { k.middle.x, k.middle.y, k.middle.z, k.radius,  k.normal.x,
                                           k.normal.y, k.normal.z, k.shine.x,  k.shine.y, k.shine.z };
    for (int i = 0; i < SKETCH_WORDS - 1; i++)
        rstore(ctx->at.lists->sketches[i] + first + l, field[i]);
    ustore(ctx->at.lists->shapes + first + l, k.shape);
}
FN u1 sketch_shape(CTX u1 i) { return ctx->at.lists->shapes[i]; }
FN list_sketch sketch_load(CTX u1 i) {
    const float(*k)[LIST_ROOM] = ctx->at.lists->sketches;
    return (list_sketch){ V3(K(k[0][i]), K(k[1][i]), K(k[2][i])), K(k[3][i]), V3(K(k[4][i]), K(k[5][i]), K(k[6][i])),
                          KU(sketch_shape(ctx, i)), V3(K(k[7][i]), K(k[8][i]), K(k[9][i])) };
}
FN u32 entry_light(CTX u32 i) { return word_gather(ctx->at.lists->list.light, i); }
FN void summed_store(CTX u1 i, real sum) { rstore(ctx->at.asked->summed[i] + ctx->at.lane, sum); }
FN real summed_at(CTX u32 i) {
    return real_gather(ctx->at.asked->summed[0] + ctx->at.lane, i * KU(BLOCK) + lane_numbers(0));
}
FN void drawn_store(CTX u32 ray, mask on, u32 entry, real times) {
    uint32_t k[LANES], e[LANES];
    float t[LANES];
    ustore(k, ray);
    ustore(e, entry);
    rstore(t, times);
    for (uint32_t bits = lane_bits(on); bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        ctx->at.asked->entry[k[l]][ctx->at.lane + l] = e[l];
        ctx->at.asked->times[k[l]][ctx->at.lane + l] = t[l];
    }
}
FN real drawn_times(CTX u1 ray) { return rload(ctx->at.asked->times[ray] + ctx->at.lane); }
FN real found_p(CTX u1 ray) { return rload(ctx->at.found[ray].r.p + ctx->at.lane); }
FN real found_w(CTX u1 ray) { return rload(ctx->at.found[ray].r.w + ctx->at.lane); }

static void fill_list(const struct core_context *ctx) {
    light_list *list = &ctx->at.lists->list;
    const frame_constants *f = ctx->frame;
    list_size size =
        list_fill(ctx, (list_size){ list->count, list->copies }, f->list + f->tail, f->shadow_rays, f->draws);
    list->count = size.count;
    list->copies = size.copies;
    list_sketches(ctx, size.count);
}

static list_sums sums_load(const list_asked *a, int l) {
    return (list_sums){ rload(a->all + l), rload(a->bright + l) };
}

static void list_share(const struct core_context *tile, const gblock *g, uint32_t lanes, int x, int y, float brightness,
                       const priors *of, list_asked *out) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.priors = of;
    ctx->at.asked = out;
    memset(out->entry, 0, sizeof(out->entry));
    memset(out->times, 0, sizeof(out->times));
    out->most = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        u32 key = key_of(ctx, x, y, l), rays = KU(0u);
        list_sums sums = { K(0.0f), K(0.0f) };
        real n = K(0.0f);
        ctx->at.lane = l;
        if (ANY(on)) {
            u1 count = ctx->at.lists->list.count;
            sums = list_weigh(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), on, key, count);
            n = list_draws(sums, (f1)ctx->frame->shadow_rays, brightness, rng(key, KU(DIM_LIST_RAYS)));
            rays = list_share_out(ctx, sums, count, n, rng(key, KU(DIM_LIST_START)));
        }
        rstore(out->all + l, sums.all);
        rstore(out->bright + l, sums.bright);
        rstore(out->n + l, n);
        for (uint32_t i = 0, r[LANES]; i < LANES; i++) {
            ustore(r, rays);
            out->most = NOC_MAX(out->most, (int)r[i]);
        }
    }
}

static void list_ray_of(const struct core_context *tile, const gblock *g, int x, int y, list_asked *asked, int k,
                        rblock *out) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.asked = asked;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        list_ray r =
            list_ask(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), sums_load(asked, l), rload(asked->n + l),
                     key_of(ctx, x, y, l), uload(asked->entry[k] + l), rload(asked->times[k] + l));
        ustore(out->light + l, r.light);
        rstore(out->u + l, r.u);
        rstore(out->v + l, r.v);
        rstore(out->w + l, r.w);
        rstore(out->p + l, r.p);
    }
}

static void list_show(const struct core_context *tile, int x, int y, list_asked *asked, uint32_t ray[BLOCK]) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.asked = asked;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        ustore(ray + l,
               list_shown(ctx, (u1)asked->most, rload(asked->n + l), rng(key_of(ctx, x, y, l), KU(DIM_LIST_SHOWN))));
    }
}

static void list_keep(const struct core_context *tile, int x, int y, const ray_draw *found, int rays,
                      uint32_t ray[BLOCK], float w[BLOCK]) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.found = found;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        list_kept kept = list_resample(ctx, (u1)rays, rng(key_of(ctx, x, y, l), KU(DIM_LIST_KEPT)));
        ustore(ray + l, kept.ray);
        rstore(w + l, kept.w);
    }
}

static void list_mix(const struct core_context *tile, const float m[BLOCK], float reused[BLOCK]) {
    for (int l = 0; l < BLOCK; l += LANES)
        rstore(reused + l, list_reused(rload(m + l), (f1)tile->frame->draws));
}

#endif
