/* Lane loops of reuse (core/neighbours.h, core/reuse.h), included by kernels_tmpl.c. */
#ifndef NOC_CPU_REUSE_H
#define NOC_CPU_REUSE_H

#include "core/combine.h"
#include "core/neighbours.h"

FN mask neighbour_on(CTX int i) { return mload(ctx->at.combining->n[i].lanes, ctx->at.lane); }
FN reservoir neighbour_resv(CTX int i) { return reservoir_load(&ctx->at.combining->n[i].r, ctx->at.lane); }
FN surf neighbour_surf(CTX int i) {
    const combining *b = ctx->at.combining;
    return surf_load(ctx, &b->n[i].g, ctx->at.lane, b->eye->eye);
}
FN real neighbour_answer(CTX int i) {
    const combining *b = ctx->at.combining;
    int l = ctx->at.lane;
    return reuse_answer(rload(b->p_at[i] + l), mload(b->asked[i], l), mload(b->unoccluded[i], l));
}

static uint32_t history_places(const struct core_context *ctx, const gblock *g, uint32_t x[BLOCK], uint32_t y[BLOCK]) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        receiver r = receiver_load(g, l);
        pixel p = history_place(ctx, r);
        ustore(x + l, p.x);
        ustore(y + l, p.y);
        lanes |= mbits(and_(p.inside, receives(r))) << l;
    }
    return lanes;
}

static reservoir_builder held_load(const held_block *b, int l) {
    reservoir_builder s;
    s.light = uload(b->light + l);
    s.u = rload(b->u + l);
    s.v = rload(b->v + l);
    s.p = rload(b->p + l);
    s.w_sum = rload(b->w_sum + l);
    s.m = rload(b->m + l);
    s.tag = rload(b->tag + l);
    return s;
}

static void held_store(held_block *b, int l, reservoir_builder s) {
    ustore(b->light + l, s.light);
    rstore(b->u + l, s.u);
    rstore(b->v + l, s.v);
    rstore(b->p + l, s.p);
    rstore(b->w_sum + l, s.w_sum);
    rstore(b->m + l, s.m);
    rstore(b->tag + l, s.tag);
}

/* The frame's context with its cursors at lane l of b. */
FN struct core_context context_at(const struct core_context *frame, const combining *b, int l) {
    struct core_context c = *frame;
    c.at.combining = b;
    c.at.lane = l;
    return c;
}

static void combine_begin(const struct core_context *frame, combining *b) {
    for (int l = 0; l < BLOCK; l += LANES) {
        struct core_context c = context_at(frame, b, l), *ctx = &c;
        surf s = surf_load(ctx, b->g, l, ctx->frame->camera.eye);
        held_store(&b->held, l,
                   reuse_begin(ctx, s, reservoir_load(b->own, l), key_of(ctx, b->x, b->y, l), KU(b->dim), b->k));
    }
}

static void combine_ask(const struct core_context *there, combining *b) {
    memset(b->asked, 0, sizeof(b->asked));
    for (int l = 0; l < BLOCK; l += LANES) {
        struct core_context c = context_at(there, b, l), *ctx = &c;
        reservoir_builder held = held_load(&b->held, l);
        light li = light_load(ctx, held.light);
        for (int i = 0; i < b->k; i++) {
            real p = reuse_target(ctx, i, held, li);
            rstore(b->p_at[i] + l, p);
            b->asked[i] |= mbits(reuse_asks(held, i, p)) << l;
        }
    }
}

static void combine_end(const struct core_context *frame, combining *b, rblock *out) {
    uint32_t own = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        struct core_context c = context_at(frame, b, l), *ctx = &c;
        surf s = surf_load(ctx, b->g, l, ctx->frame->camera.eye);
        combined r = reuse_end(ctx, s, reservoir_load(b->own, l), held_load(&b->held, l), key_of(ctx, b->x, b->y, l),
                               KU(b->dim), b->k);
        reservoir_store(out, l, r.r);
        own |= mbits(r.own) << l;
    }
    b->visible &= own;
}

#endif
