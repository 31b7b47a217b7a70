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

FN list_prior prior_load(CTX u1 at) { return (list_prior){ ctx->at.priors->share[at], ctx->at.priors->expect[at] }; }
FN list_priors prior_row(CTX u1 row, int l) {
    return (list_priors){ rload(ctx->at.priors->share + 16 * row + l), rload(ctx->at.priors->expect + 16 * row + l) };
}

FN real entry_weight(CTX u32 i) { return real_gather(ctx->at.lists->list.weight, i); }
FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count) {
    uint32_t at[LANES];
    for (uint32_t i = 0; i < LANES; i++)
        at[i] = ctx->at.lists->list.light[NOC_MIN(((uint32_t)l + i) * rows + row, count - 1)];
    return uload(at);
}
FN void sketch_store(CTX u1 row, int l, list_sketch k) {
    const real field[SKETCH_WORDS] = { k.middle.x, k.middle.y, k.middle.z, k.radius,  k.normal.x, k.normal.y,
                                       k.normal.z, k.size,     k.shine.x,  k.shine.y, k.shine.z,  real_of_bits(k.shape),
                                       k.beside.x, k.beside.y, k.beside.z, k.level };
    for (int i = 0; i < SKETCH_WORDS; i++)
        ustore(ctx->at.lists->sketches[i] + 16 * row + l, bits_of_real(field[i]));
}
#define SKETCH_FIELDS(word)                                                                                            \
    (list_sketch) {                                                                                                    \
        V3(real_of_bits(word(0)), real_of_bits(word(1)), real_of_bits(word(2))), real_of_bits(word(3)),                \
            V3(real_of_bits(word(4)), real_of_bits(word(5)), real_of_bits(word(6))), real_of_bits(word(7)), word(11),  \
            V3(real_of_bits(word(8)), real_of_bits(word(9)), real_of_bits(word(10))),                                  \
            V3(real_of_bits(word(12)), real_of_bits(word(13)), real_of_bits(word(14))), real_of_bits(word(15))         \
    }
FN list_sketch sketch_row(CTX u1 row, int l) {
#define ROW_WORD(i) uload(ctx->at.lists->sketches[i] + 16 * row + l)
    return SKETCH_FIELDS(ROW_WORD);
#undef ROW_WORD
}
FN list_sketch sketch_load(CTX u1 at) {
#define PLACE_WORD(i) KU(ctx->at.lists->sketches[i][at])
    return SKETCH_FIELDS(PLACE_WORD);
#undef PLACE_WORD
}
FN u32 entry_light(CTX u32 i) { return word_gather(ctx->at.lists->list.light, i); }

/* ---- faces ---- */

FN surf seen_surf(const seen_block *b, int l) {
    surf s;
    s.p = V3(rload(b->p[0] + l), rload(b->p[1] + l), rload(b->p[2] + l));
    s.n = V3(rload(b->n[0] + l), rload(b->n[1] + l), rload(b->n[2] + l));
    s.wo = V3(rload(b->wo[0] + l), rload(b->wo[1] + l), rload(b->wo[2] + l));
    s.albedo = V3(rload(b->albedo[0] + l), rload(b->albedo[1] + l), rload(b->albedo[2] + l));
    s.f0 = rload(b->f0 + l);
    s.alpha = rload(b->alpha + l);
    return s;
}
FN void seen_store(seen_block *b, int l, surf s, real depth) {
    const v3 three[4] = { s.p, s.n, s.wo, s.albedo };
    float(*const to[4])[BLOCK] = { b->p, b->n, b->wo, b->albedo };
    for (int i = 0; i < 4; i++) {
        rstore(to[i][0] + l, three[i].x);
        rstore(to[i][1] + l, three[i].y);
        rstore(to[i][2] + l, three[i].z);
    }
    rstore(b->f0 + l, s.f0);
    rstore(b->alpha + l, s.alpha);
    rstore(b->depth + l, depth);
}
FN face_pixels face_pixels_load(CTX int l) {
    const seen_block *b = &ctx->at.asked->seen;
    return (face_pixels){ seen_surf(b, l), rload(b->depth + l) };
}
FN face_pixel face_pixel_load(CTX u1 at) {
    const seen_block *b = &ctx->at.asked->seen;
    return (face_pixel){ F3(b->p[0][at], b->p[1][at], b->p[2][at]),
                         F3(b->n[0][at], b->n[1][at], b->n[2][at]),
                         F3(b->wo[0][at], b->wo[1][at], b->wo[2][at]),
                         F3(b->albedo[0][at], b->albedo[1][at], b->albedo[2][at]),
                         b->f0[at],
                         b->alpha[at],
                         b->depth[at] };
}
FN mask face_lanes(CTX u1 pixels, int l) { return mload(pixels, l); }
FN void far_store(CTX u1 face, u1 row, int l, real sum) { rstore(ctx->at.asked->face[face].far[row] + l, sum); }
FN f1 far_sum(CTX u1 face, u1 row, u1 column) { return ctx->at.asked->face[face].far[row][column]; }
FN void column_store(CTX u1 face, u1 column, f1 sum) { ctx->at.asked->face[face].column[column] = sum; }
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near) {
    uint32_t *bits = &ctx->at.asked->face[face].near[row];
    *bits = (l ? *bits : 0) | lane_bits(near) << l;
}
FN u1 near_bits_load(CTX u1 face, u1 row) { return ctx->at.asked->face[face].near[row]; }
FN void face_store(CTX u1 number, list_face f, face_sums sums) {
    list_asked *a = ctx->at.asked;
    a->face[number].pixels = f.pixels;
    for (uint32_t bits = f.pixels; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        a->face_of[l] = number;
        a->all[l] = sums.all;
        a->bright[l] = sums.bright;
    }
}
FN u1 pixels_of_face(CTX u1 face) { return ctx->at.asked->face[face].pixels; }
FN void near_entry_store(CTX u1 i, u1 entry, u1 at, u1 pixels) {
    ctx->at.asked->near[i] = (near_record){ entry, (uint16_t)at, (uint16_t)pixels };
}
FN u1 near_entry(CTX u1 i) { return ctx->at.asked->near[i].entry; }
FN u1 near_place(CTX u1 i) { return ctx->at.asked->near[i].place; }
FN mask near_pixels(CTX u1 i) { return mload(ctx->at.asked->near[i].pixels, ctx->at.lane); }
FN u32 near_entry_at(CTX u32 i) { return word_gather(ctx->at.asked->near, i * KU(2u)); }
FN u32 face_words(u32 face) { return face * KU(sizeof(face_weights) / 4); }
FN real far_at(CTX u32 face, u32 row, u32 column) {
    return real_gather(ctx->at.asked->face[0].far, face_words(face) + row * KU(16u) + column);
}
FN real column_at(CTX u32 face, u32 column) {
    return real_gather(ctx->at.asked->face[0].column, face_words(face) + column);
}
FN void summed_store(CTX u1 i, real sum) { rstore(ctx->at.asked->summed[i] + ctx->at.lane, sum); }
FN real summed_at(CTX u32 i) {
    return real_gather(ctx->at.asked->summed[0] + ctx->at.lane, i * KU(BLOCK) + lane_numbers(0));
}
FN void drawn_store(CTX u32 ray, mask on, list_drawn d) {
    list_asked *a = ctx->at.asked;
    uint32_t k[LANES], e[LANES];
    float t[LANES], w[LANES];
    ustore(k, ray);
    ustore(e, d.entry);
    rstore(t, d.times);
    rstore(w, d.weighed);
    for (uint32_t bits = lane_bits(on); bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        a->entry[k[l]][ctx->at.lane + l] = e[l];
        a->times[k[l]][ctx->at.lane + l] = t[l];
        a->weighed[k[l]][ctx->at.lane + l] = w[l];
    }
}
FN real drawn_times(CTX u1 ray) {
    float times[LANES];
    for (int l = 0; l < LANES; l++)
        times[l] = ctx->at.found[ray].times[ctx->at.lane + l];
    return rload(times);
}
FN list_found found_of(CTX u32 ray) {
    uint32_t of[LANES], entry[LANES];
    float times[LANES], w[LANES], p[LANES];
    ustore(of, ray);
    for (int i = 0, l = ctx->at.lane; i < LANES; i++, l++) {
        const ray_draw *d = &ctx->at.found[of[i]];
        entry[i] = d->entry[l];
        times[i] = d->times[l];
        w[i] = d->r.w[l];
        p[i] = d->r.p[l];
    }
    return (list_found){ uload(entry), rload(times), rload(w), rload(p) };
}
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
        mask on = mload(lanes, l);
        u32 key = key_of(ctx, x, y, l);
        list_sums far = sums_load(out, l);
        ctx->at.lane = l;
        list_sums sums = list_weigh(ctx, seen_surf(&out->seen, l), key, near);
        sums.all = sel(on, sums.all + far.all, K(0.0f));
        sums.bright = sel(on, sums.bright + far.bright, K(0.0f));
        real n = list_draws(sums, list_asks((f1)ctx->frame->shadow_rays, mload(out->fresh, l)), brightness,
                            rng(key, KU(DIM_LIST_RAYS)));
        rstore(out->all + l, sums.all);
        rstore(out->bright + l, sums.bright);
        rstore(out->n + l, n);
        ustore(rays + l,
               list_share_out(ctx, sums.all, near, uload(out->face_of + l), rows, n, rng(key, KU(DIM_LIST_START))));
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
