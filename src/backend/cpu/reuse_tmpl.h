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

/* ---- fetching ---- */

/* The 4x4 pixels that begin at pixel (x, y) of the block tl; those to the right, below and beside that are in tr, bl
 * and br. */
typedef struct shifted {
    size_t tl, tr, bl, br; /* blocks */
    int x, y;
} shifted;

/* Words of an array of a block each, `stride` words apart. */
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
FN u32 shifted_places(shifted s) {
    u32 x = (lane_numbers(0) & KU(3u)) + KU((uint32_t)s.x), y = (lane_numbers(0) >> 2) + KU((uint32_t)s.y);
    return ((y & KU(3u)) << 2 | (x & KU(3u))) | (x & KU(4u)) << 2;
}
FN void shifted_words(const void *words, size_t stride, shifted s, void *out) {
    const int *w = words;
    __m512i at = (__m512i)shifted_places(s);
    __m512i r =
        _mm512_permutex2var_epi32(_mm512_load_si512(w + s.tl * stride), at, _mm512_load_si512(w + s.tr * stride));
    if (s.y) {
        __m512i below =
            _mm512_permutex2var_epi32(_mm512_load_si512(w + s.bl * stride), at, _mm512_load_si512(w + s.br * stride));
        r = _mm512_mask_mov_epi32(r, (__mmask16)(0xffff0000u >> 4 * s.y), below);
    }
    _mm512_store_si512(out, r);
}
#else
FN void shifted_words(const void *words, size_t stride, shifted s, void *out) {
    const uint32_t *w = words;
    for (int row = 0; row < BLOCK_SIDE; row++) {
        bool below = row + s.y >= BLOCK_SIDE;
        size_t from = (size_t)((row + s.y) & 3) * BLOCK_SIDE;
        uint32_t both[2 * BLOCK_SIDE];
        memcpy(both, w + (below ? s.bl : s.tl) * stride + from, BLOCK_SIDE * 4);
        memcpy(both + BLOCK_SIDE, w + (below ? s.br : s.tr) * stride + from, BLOCK_SIDE * 4);
        memcpy((uint32_t *)out + row * BLOCK_SIDE, both + s.x, BLOCK_SIDE * 4);
    }
}
#endif

/* Where the pixels from (x, y) on lie; those outside the picture are taken from anywhere. */
FN shifted shifted_from(const frame_constants *f, int x, int y) {
    int most_x = (int)f->blocks_x - 1, most_y = (int)(f->height - 1) / BLOCK_SIDE;
    int left = x >> 2, top = y >> 2; /* rounded down */
    size_t x0 = (size_t)NOC_CLAMP(left, 0, most_x), x1 = (size_t)NOC_CLAMP(left + 1, 0, most_x);
    size_t y0 = (size_t)NOC_CLAMP(top, 0, most_y) * f->blocks_x,
           y1 = (size_t)NOC_CLAMP(top + 1, 0, most_y) * f->blocks_x;
    return (shifted){ y0 + x0, y0 + x1, y1 + x0, y1 + x1, x & 3, y & 3 };
}

static void fetch_neighbours(const struct core_context *ctx, const gblock *g, const rblock *r, const gblock *here,
                             uint32_t wanted, int x, int y, neighbour *n) {
    const frame_constants *f = ctx->frame;
    shifted from = shifted_from(f, x, y);
    const size_t gs = sizeof(gblock) / 4, rs = sizeof(rblock) / 4;
    float *const surfaces[] = { n->g.px, n->g.py, n->g.pz, n->g.nx, n->g.ny, n->g.nz };
    for (size_t k = 0; k < NOC_COUNT(surfaces); k++)
        shifted_words((const float *)g + k * BLOCK, gs, from, surfaces[k]);
    shifted_words(g->material, gs, from, n->g.material);
    n->lanes = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 px = KU((uint32_t)x) + (lane_numbers(l) & KU(3u)), py = KU((uint32_t)y) + shr(lane_numbers(l), 2);
        mask inside = and_(px < KU(f->width), py < KU(f->height)); /* negative ones are large */
        mask on =
            and_(and_(inside, mload(wanted, l)), receivers_alike(ctx, receiver_load(here, l), receiver_load(&n->g, l)));
        n->lanes |= mbits(on) << l;
    }
    if (!n->lanes)
        return;
    if (ctx->texels)
        shifted_words(g->texel, gs, from, n->g.texel);
    rblock there;
    float *const words[] = { (float *)there.light, there.u, there.v, there.w, there.m, there.p };
    for (size_t k = 0; k < NOC_COUNT(words); k++)
        shifted_words((const float *)r + k * BLOCK, rs, from, words[k]);
    for (int l = 0; l < BLOCK; l += LANES)
        reservoir_store(&n->r, l, reservoir_sel(mload(n->lanes, l), reservoir_load(&there, l), reservoir_empty()));
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
