/* Lane loops of reuse (core/neighbours.h, core/reuse.h), included by kernels_tmpl.c. */
#ifndef NOC_CPU_REUSE_H
#define NOC_CPU_REUSE_H

#include "core/combine.h"
#include "core/neighbours.h"

FN b1 neighbour_some(CTX int i) { return ctx->at.combining->n[i].lanes != 0; }
FN mask neighbour_on(CTX int i) { return mload(ctx->at.combining->n[i].lanes, ctx->at.lane); }
FN reservoir neighbour_resv(CTX int i) { return reservoir_load(&ctx->at.combining->n[i].r, ctx->at.lane); }
FN real neighbour_answer(CTX int i) {
    const combining *b = ctx->at.combining;
    int l = ctx->at.lane;
    return reuse_answer(rload(b->p_at[i] + l), mload(b->asked[i], l), mload(b->unoccluded[i], l));
}

/* Word `word` of neighbour `which` of each lane, words being arrays of a block. */
FN u32 neighbour_word(CTX u32 which, size_t word) {
    const uint32_t stride = sizeof(neighbour) / 4;
    u32 at = which * KU(stride) + lane_numbers(ctx->at.lane) + KU((uint32_t)(word * BLOCK));
    return word_gather(ctx->at.combining->n, at);
}
#define NEIGHBOUR_WORD(which, field) neighbour_word(ctx, which, offsetof(neighbour, field) / (4 * BLOCK))

FN reservoir neighbour_resv_of(CTX u32 i) {
    reservoir r;
    r.light = NEIGHBOUR_WORD(i, r.light);
    r.u = real_of_bits(NEIGHBOUR_WORD(i, r.u));
    r.v = real_of_bits(NEIGHBOUR_WORD(i, r.v));
    r.w = real_of_bits(NEIGHBOUR_WORD(i, r.w));
    r.m = real_of_bits(NEIGHBOUR_WORD(i, r.m));
    r.p = real_of_bits(NEIGHBOUR_WORD(i, r.p));
    return r;
}

FN surf neighbour_surf(CTX int i) {
    const combining *b = ctx->at.combining;
    return surf_load(ctx, noc_asked_surface(b, i), ctx->at.lane, b->eye->eye);
}

/* The surfaces that lanes ask, of neighbours that differ from lane to lane, into b->partner. */
FN void partner_store(CTX combining *b, u32 which) {
    int l = ctx->at.lane;
    gblock *g = &b->partner;
    ustore((uint32_t *)g->px + l, NEIGHBOUR_WORD(which, g.px));
    ustore((uint32_t *)g->py + l, NEIGHBOUR_WORD(which, g.py));
    ustore((uint32_t *)g->pz + l, NEIGHBOUR_WORD(which, g.pz));
    ustore((uint32_t *)g->nx + l, NEIGHBOUR_WORD(which, g.nx));
    ustore((uint32_t *)g->ny + l, NEIGHBOUR_WORD(which, g.ny));
    ustore((uint32_t *)g->nz + l, NEIGHBOUR_WORD(which, g.nz));
    ustore(g->material + l, NEIGHBOUR_WORD(which, g.material));
    if (ctx->texels)
        ustore(g->texel + l, NEIGHBOUR_WORD(which, g.texel));
}

/* ---- fetching ---- */

/* The 4x4 pixels that begin at pixel (x, y) of the block tl; those to the right, below and beside that are in tr, bl
 * and br. */
typedef struct shifted {
    size_t tl, tr, bl, br; /* blocks */
    int x, y;
} shifted;

/* `count` arrays of a block each that follow each other, of the blocks at `words`, which lie `stride` words apart. */
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
FN u32 shifted_places(shifted s) {
    u32 x = (lane_numbers(0) & KU(3u)) + KU((uint32_t)s.x), y = (lane_numbers(0) >> 2) + KU((uint32_t)s.y);
    return ((y & KU(3u)) << 2 | (x & KU(3u))) | (x & KU(4u)) << 2;
}
FN void shifted_words(const void *words, size_t stride, shifted s, int count, void *out) {
    const int *w = words;
    int *to = out;
    __m512i at = (__m512i)shifted_places(s);
    __mmask16 lower = (__mmask16)(0xffff0000u >> 4 * s.y);
    for (int k = 0; k < count; k++, w += BLOCK, to += BLOCK) {
        __m512i r =
            _mm512_permutex2var_epi32(_mm512_load_si512(w + s.tl * stride), at, _mm512_load_si512(w + s.tr * stride));
        __m512i below =
            _mm512_permutex2var_epi32(_mm512_load_si512(w + s.bl * stride), at, _mm512_load_si512(w + s.br * stride));
        _mm512_store_si512(to, _mm512_mask_mov_epi32(r, lower, below));
    }
}
#elif defined(CORE_LANES) && CORE_LANES == 8 && defined(__AVX2__)
FN __m256i two_rows(const uint32_t *first, const uint32_t *second) {
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_load_si128((const __m128i *)first)),
                                   _mm_load_si128((const __m128i *)second), 1);
}
/* Of each half the four words from word x of a on, and of b behind them. An instruction wants x to be a constant. */
FN __m256i words_from(__m256i a, __m256i b, int x) {
    switch (x) {
    case 0: return a;
    case 1: return _mm256_alignr_epi8(b, a, 4);
    case 2: return _mm256_alignr_epi8(b, a, 8);
    default: return _mm256_alignr_epi8(b, a, 12);
    }
}
/* x: s.x, known where this is inlined. */
FN void rows_from(const uint32_t *w, size_t stride, shifted s, const int x, int count, uint32_t *out) {
    const uint32_t *left[BLOCK_SIDE], *right[BLOCK_SIDE];
    for (int row = 0; row < BLOCK_SIDE; row++) {
        bool below = row + s.y >= BLOCK_SIDE;
        size_t from = (size_t)((row + s.y) & 3) * BLOCK_SIDE;
        left[row] = w + (below ? s.bl : s.tl) * stride + from;
        right[row] = w + (below ? s.br : s.tr) * stride + from;
    }
    for (int k = 0; k < count * BLOCK; k += BLOCK)
        for (int row = 0; row < BLOCK_SIDE; row += 2) {
            __m256i a = two_rows(left[row] + k, left[row + 1] + k), b = two_rows(right[row] + k, right[row + 1] + k);
            _mm256_store_si256((__m256i *)(out + k + row * BLOCK_SIDE), words_from(a, b, x));
        }
}
FN void shifted_words(const void *words, size_t stride, shifted s, int count, void *out) {
    switch (s.x) {
    case 0: rows_from(words, stride, s, 0, count, out); break;
    case 1: rows_from(words, stride, s, 1, count, out); break;
    case 2: rows_from(words, stride, s, 2, count, out); break;
    default: rows_from(words, stride, s, 3, count, out); break;
    }
}
#else
FN void shifted_words(const void *words, size_t stride, shifted s, int count, void *out) {
    const uint32_t *w = words;
    uint32_t *to = out;
    for (int k = 0; k < count; k++, w += BLOCK, to += BLOCK)
        for (int row = 0; row < BLOCK_SIDE; row++) {
            bool below = row + s.y >= BLOCK_SIDE;
            size_t from = (size_t)((row + s.y) & 3) * BLOCK_SIDE;
            uint32_t both[2 * BLOCK_SIDE];
            memcpy(both, w + (below ? s.bl : s.tl) * stride + from, BLOCK_SIDE * 4);
            memcpy(both + BLOCK_SIDE, w + (below ? s.br : s.tr) * stride + from, BLOCK_SIDE * 4);
            memcpy(to + row * BLOCK_SIDE, both + s.x, BLOCK_SIDE * 4);
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
    shifted_words(g->px, gs, from, 6, n->g.px); /* and all up to nz */
    shifted_words(g->material, gs, from, 1, n->g.material);
    n->lanes = 0;
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 px = KU((uint32_t)x) + (lane_numbers(l) & KU(3u)), py = KU((uint32_t)y) + shr(lane_numbers(l), 2);
        mask inside = and_(px < KU(f->width), py < KU(f->height)); /* negative ones are large */
        mask on =
            and_(and_(inside, mload(wanted, l)), receivers_alike(ctx, receiver_load(here, l), receiver_load(&n->g, l)));
        n->lanes |= mbits(on) << l;
    }
    if (!n->lanes) {
        memset(&n->r, 0, sizeof(n->r));
        return;
    }
    if (ctx->texels)
        shifted_words(g->texel, gs, from, 1, n->g.texel);
    shifted_words(r->light, rs, from, (int)(rs / BLOCK), n->r.light); /* all of it */
    for (int l = 0; l < BLOCK; l += LANES) {
        reservoir there = reservoir_sel(mload(n->lanes, l), reservoir_load(&n->r, l), reservoir_empty());
        reservoir_store(&n->r, l, there);
        light_prefetch((const float *)ctx->lights, there.light);
    }
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
    b->partners = reuse_asked(frame, b->k) < b->k;
    for (int l = 0; l < BLOCK; l += LANES) {
        struct core_context c = context_at(frame, b, l), *ctx = &c;
        surf s = surf_load(ctx, b->g, l, ctx->frame->camera.eye);
        held_store(&b->held, l,
                   reuse_begin(ctx, s, reservoir_load(b->own, l), key_of(ctx, b->x, b->y, l), KU(b->dim), b->k));
    }
}

static void combine_ask(const struct core_context *there, combining *b) {
    int asked = b->partners ? 1 : b->k;
    memset(b->asked, 0, sizeof(b->asked));
    for (int l = 0; l < BLOCK; l += LANES) {
        struct core_context c = context_at(there, b, l), *ctx = &c;
        reservoir_builder held = held_load(&b->held, l);
        mask holds = held.w_sum > K(0.0f); /* else nobody looks at the answer */
        if (!ANY(holds)) {
            for (int i = 0; i < asked; i++)
                rstore(b->p_at[i] + l, K(0.0f));
            continue;
        }
        light li = light_load(ctx, held.light);
        u32 partner = KU(0u);
        if (b->partners) {
            partner = reuse_partner(ctx, key_of(ctx, b->x, b->y, l), KU(b->dim), b->k);
            partner_store(ctx, b, partner);
        }
        for (int i = 0; i < asked; i++) {
            if (!b->partners && !neighbour_some(ctx, i))
                continue;
            mask on = b->partners ? real_of_bits(NEIGHBOUR_WORD(partner, r.m)) > K(0.0f) : neighbour_on(ctx, i);
            real p = reuse_target(ctx, i, and_(on, holds), held, li);
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
