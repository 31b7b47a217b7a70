/* Light lists (core/lists.h), included by kernels_tmpl.c: a tile's list is built, then every pixel chooses among its
 * entries. */
#ifndef NOC_CPU_LISTS_H
#define NOC_CPU_LISTS_H

#include "backend/cpu/list_bridge_tmpl.h"

static void build_list(const struct core_context *frame, const gblock *const *g, const uint32_t *lanes, int blocks,
                       uint32_t start, list_scratch *scratch) {
    const frame_constants *f = frame->frame;
    struct core_context tile = *frame, *ctx = &tile;
    ctx->at.tile = g;
    ctx->at.tile_pixels = lanes;
    ctx->at.lists = scratch;
    list_size size = list_build(ctx, (u1)blocks, three(f->camera.eye), f->list, f->tail, start);
    scratch->list.count = size.count;
    scratch->list.copies = size.copies;
}

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

static void share_block(const struct core_context *tile, const gblock *g, uint32_t lanes, int x, int y,
                        float brightness, const priors *of, list_asked *out) {
    struct core_context block = *tile, *ctx = &block;
    u1 rows = list_rows(ctx->at.lists->list.count);
    uint32_t rays[BLOCK];
    ctx->at.priors = of;
    ctx->at.asked = out;
    for (int l = 0; l < BLOCK; l += LANES) {
        seen_store(&out->seen, l, surf_load(ctx, g, l, ctx->frame->camera.eye), rload(g->depth + l));
        ustore(out->face_of + l, KU(0u));
        rstore(out->all + l, K(0.0f));
        rstore(out->bright + l, K(0.0f));
    }
    u1 near = weigh_faces(ctx, lanes, rows);
    out->most = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        list_sums far = sums_load(out, l);
        ctx->at.lane = l;
        list_shared q = list_share(ctx, seen_surf(&out->seen, l), key_of(ctx, x, y, l), mload(lanes, l), far, near,
                                   uload(out->face_of + l), rows,
                                   list_asks((f1)ctx->frame->shadow_rays, mload(out->fresh, l)), brightness);
        rstore(out->all + l, q.sums.all);
        rstore(out->bright + l, q.sums.bright);
        rstore(out->n + l, q.draws);
        ustore(rays + l, q.rays);
        for (int i = l; i < l + LANES; i++)
            out->most = NOC_MAX(out->most, (int)rays[i]);
    }
    for (int l = 0; l < BLOCK; l++)
        for (int k = (int)rays[l]; k < out->most; k++) {
            out->entry[k][l] = 0;
            out->times[k][l] = 0;
            out->weighed[k][l] = 1;
        }
}

static void list_ray_of(const struct core_context *tile, int x, int y, list_asked *asked, int k, ray_draw *out,
                        rayblock *way) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.asked = asked;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        surf s = seen_surf(&asked->seen, l);
        list_drawn d = { uload(asked->entry[k] + l), rload(asked->times[k] + l), rload(asked->weighed[k] + l) };
        light to = light_load(ctx, entry_light(ctx, d.entry));
        list_ray r = list_ask(ctx, s, sums_load(asked, l), rload(asked->n + l), key_of(ctx, x, y, l), d, to);
        segment between = segment_to(s.p, s.n, to, r.at, K(ctx->ray_offset));
        ustore(out->r.light + l, r.light);
        rstore(out->r.u + l, r.u);
        rstore(out->r.v + l, r.v);
        rstore(out->r.w + l, r.w);
        rstore(out->r.p + l, r.p);
        rstore(out->brings.rgb[0] + l, r.brings.x);
        rstore(out->brings.rgb[1] + l, r.brings.y);
        rstore(out->brings.rgb[2] + l, r.brings.z);
        ray_store(way, l, between.o, between.d);
    }
    for (int l = 0; l < BLOCK; l++) {
        out->entry[l] = (uint8_t)asked->entry[k][l];
        out->times[l] = (uint8_t)asked->times[k][l];
    }
}

static void stand_ins(const struct core_context *tile, int x, int y, const ray_draw *found, int rays,
                      const float n[BLOCK], rblock *out) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.found = found;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        reservoir_store(out, l, list_stand_in(ctx, key_of(ctx, x, y, l), (u1)rays, rload(n + l), rload(out->m + l)));
    }
}

static void resample_rays(const struct core_context *tile, int x, int y, const ray_draw *found, int rays, rblock *out) {
    struct core_context block = *tile, *ctx = &block;
    ctx->at.found = found;
    for (int l = 0; l < BLOCK; l += LANES) {
        ctx->at.lane = l;
        reservoir_store(out, l, list_resampled(ctx, key_of(ctx, x, y, l), (u1)rays, reservoir_load(out, l)));
    }
}

static void list_mix(const struct core_context *tile, const float m[BLOCK], float reused[BLOCK]) {
    for (int l = 0; l < BLOCK; l += LANES)
        rstore(reused + l, list_reused(rload(m + l), (f1)tile->frame->draws));
}

#endif
