/* Lane loops of the reference method (core/reference.h), included by kernels_tmpl.c. */
#ifndef NOC_CPU_REFERENCE_H
#define NOC_CPU_REFERENCE_H

#include "core/reference.h"

FN light light_of_all(CTX uint32_t i) { return light_splat(ctx, i); }
FN bool light_shines(CTX uint32_t i) {
    const float *e = ctx->lights[i].e;
    return e[0] > 0 || e[1] > 0 || e[2] > 0;
}
FN void sum_put(CTX uint32_t chunk, real x) { rstore(ctx->at.reference->sums[chunk] + ctx->at.lane, x); }
FN real sum_load(CTX uint32_t chunk) { return rload(ctx->at.reference->sums[chunk] + ctx->at.lane); }

static void put_entries(CTX mask on, uint32_t id, real w) {
    reference_scratch *e = ctx->at.reference;
    float value[LANES];
    rstore(value, w);
    for (uint32_t bits = mbits(on); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits), l = ctx->at.lane + i;
        uint32_t at = e->count[l];
        if (at >= ctx->frame->rays)
            continue;
        e->light[at][l] = id;
        e->w[at][l] = value[i];
        e->count[l]++;
    }
}
FN void entry_put(CTX mask on, uint32_t i, real w) { put_entries(ctx, on, i, w); }

static void reference(const struct core_context *frame, const gblock *g, uint32_t lanes, int x, int y,
                      reference_scratch *e) {
    struct core_context c = *frame;
    const struct core_context *ctx = &c;
    c.at.reference = e;
    memset(e->count, 0, sizeof(e->count));
    for (int l = 0; l < BLOCK; l += LANES) {
        c.at.lane = l;
        if (lanes >> l & ((1u << LANES) - 1))
            reference_entries(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l),
                              ctx->light_count);
    }
}

static void reference_places(const struct core_context *ctx, int x, int y, rblock *r) {
    for (int l = 0; l < BLOCK; l += LANES) {
        v3 at = reference_place(key_of(ctx, x, y, l), uload(r->light + l));
        rstore(r->u + l, at.x);
        rstore(r->v + l, at.y);
    }
}

#endif
