/* Draws from a light tree for the pixels of a block, included by picks.h: all pixels go down together, a level at a
 * time. An item is a pixel at a pair of nodes with some of its draws; whatever pixels they belong to, LANES items are
 * split at once, and their pairs are known, and asked for, long before they are needed. Which item is split when does
 * not matter: the result is that of core/tree.h, to the bit. */
#ifndef NOC_CPU_TREE_DRAWS_H
#define NOC_CPU_TREE_DRAWS_H

#include "core/tree.h"

enum { TREE_AHEAD = 32 };

/* Pairs are records of 16 floats. */
FN tree_pair tree_load(CTX u32 i) {
#if defined(CORE_LANES)
    const float *records = (const float *)ctx->tree->pairs;
    uint32_t at[CORE_LANES];
    memcpy(at, &i, sizeof(at));
    __asm__("" : "+m"(at)); /* as in core/wide_load.h */
    wide_quad a = wide_quad_load(records, 16, at), b = wide_quad_load(records + 4, 16, at);
    wide_quad c = wide_quad_load(records + 8, 16, at), d = wide_quad_load(records + 12, 16, at);
    return (tree_pair){ { V3(a.f[0], a.f[1], a.f[2]), a.f[3], (u32)b.f[0], (u32)b.f[1], b.f[2], (u32)b.f[3] },
                        { V3(c.f[0], c.f[1], c.f[2]), c.f[3], (u32)d.f[0], (u32)d.f[1], d.f[2], (u32)d.f[3] } };
#else
    tree_pair p;
    memcpy(&p, ctx->tree->pairs + i, sizeof(p));
    return p;
#endif
}

/* table[lane], lane < BLOCK. */
FN u32 block_word(const void *table, u32 lane) {
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
    return (u32)_mm512_permutexvar_epi32((__m512i)lane, _mm512_loadu_si512(table));
#elif defined(CORE_LANES) && CORE_LANES == 8 && defined(__AVX2__)
    __m256i low = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(table), (__m256i)lane);
    __m256i high = _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i *)table + 1), (__m256i)lane);
    return selu(lane > KU(7u), (u32)high, (u32)low);
#else
    return word_gather(table, lane);
#endif
}
FN real block_real(const float *table, u32 lane) {
    u32 bits = block_word(table, lane);
    real r;
    memcpy(&r, &bits, sizeof(r));
    return r;
}

/* Appends the items whose lanes are on, in order. Up to LANES places after them may be overwritten. */
FN void tree_append(tree_items *to, uint32_t on, u32 pair, u32 what, real pmf) {
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
    __mmask16 k = (__mmask16)on;
    _mm512_storeu_si512(to->pair + to->count, _mm512_maskz_compress_epi32(k, (__m512i)pair));
    _mm512_storeu_si512(to->what + to->count, _mm512_maskz_compress_epi32(k, (__m512i)what));
    _mm512_storeu_ps(to->pmf + to->count, _mm512_maskz_compress_ps(k, (__m512)pmf));
#elif defined(CORE_LANES) && CORE_LANES == 8 && defined(__AVX2__)
    uint64_t bytes = _pdep_u64(on, 0x0101010101010101u) * 0xff;
    __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100u, bytes)));
    _mm256_storeu_si256((__m256i *)(to->pair + to->count), _mm256_permutevar8x32_epi32((__m256i)pair, order));
    _mm256_storeu_si256((__m256i *)(to->what + to->count), _mm256_permutevar8x32_epi32((__m256i)what, order));
    _mm256_storeu_ps(to->pmf + to->count, _mm256_permutevar8x32_ps((__m256)pmf, order));
#else
    uint32_t pairs[LANES], whats[LANES], at = to->count;
    float pmfs[LANES];
    ustore(pairs, pair);
    ustore(whats, what);
    rstore(pmfs, pmf);
    for (uint32_t bits = on; bits; bits &= bits - 1, at++) {
        int l = __builtin_ctz(bits);
        to->pair[at] = pairs[l];
        to->what[at] = whats[l];
        to->pmf[at] = pmfs[l];
    }
#endif
    to->count += (uint32_t)__builtin_popcount(on);
}

/* The draws of an item: pixel, first draw, how many. */
#define TREE_WHAT(lane, first, count) ((lane) | shl(first, 4) | shl(count, 16))

/* Items whose way ends at a light. */
static void tree_arrive(uint32_t on, u32 link, u32 what, real pmf, pick_block *out) {
    uint32_t lights[LANES], whats[LANES];
    float inverse[LANES];
    pick p = tree_arrived(link, pmf);
    ustore(lights, p.light);
    ustore(whats, what);
    rstore(inverse, p.inverse);
    for (; on; on &= on - 1) {
        int l = __builtin_ctz(on);
        uint32_t lane = whats[l] & 15, first = whats[l] >> 4 & 0xfff, end = first + (whats[l] >> 16);
        for (uint32_t i = first; i < end; i++) {
            out->light[i][lane] = lights[l];
            out->inverse[i][lane] = inverse[l];
        }
    }
}

static void tree_down(const struct core_context *ctx, const gblock *g, const uint32_t *keys, const tree_items *from,
                      tree_items *to, pick_block *out) {
    to->count = 0;
    for (uint32_t i = 0; i < from->count; i += LANES) {
        for (int l = 0; l < LANES; l++)
            __builtin_prefetch(ctx->tree->pairs + from->pair[i + TREE_AHEAD + (uint32_t)l]);
        mask on = lane_numbers(0) < KU(from->count - i);
        u32 at = selu(on, uload(from->pair + i), KU(0u)), what = uload(from->what + i);
        u32 lane = what & KU(15u), first = shr(what, 4) & KU(0xfffu), count = selu(on, shr(what, 16), KU(0u));
        v3 p = V3(block_real(g->px, lane), block_real(g->py, lane), block_real(g->pz, lane));
        v3 n = V3(block_real(g->nx, lane), block_real(g->ny, lane), block_real(g->nz, lane));
        tree_step w = tree_go(ctx, p, n, block_word(keys, lane), at, count, rload(from->pmf + i));
        for (int side = 0; side < 2; side++) {
            u32 draws = side ? count - w.to_a : w.to_a, link = side ? w.link_b : w.link_a;
            real pmf = side ? w.pmf_b : w.pmf_a;
            mask any = draws != KU(0u), leaf = (link & KU(TREE_LEAF)) != KU(0u);
            u32 share = TREE_WHAT(lane, side ? first + w.to_a : first, draws);
            tree_arrive(mbits(and_(any, leaf)), link, share, pmf, out);
            tree_append(to, mbits(and_(any, not_(leaf))), link, share, pmf);
        }
    }
}

static void pick_tree(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, int m,
                      tree_items items[2], pick_block *out) {
    const noc_tree *t = ctx->tree;
    ALIGNED uint32_t keys[BLOCK];
    items[0].count = 0;
    for (int l = 0; l < BLOCK; l += LANES)
        ustore(keys + l, key_of(ctx, x, y, l));
    for (; lanes; lanes &= lanes - 1) {
        uint32_t l = (uint32_t)__builtin_ctz(lanes);
        if (!t->lights || t->root & TREE_LEAF) {
            for (int i = 0; i < m; i++) {
                out->light[i][l] = t->lights ? t->root & ~TREE_LEAF : 0;
                out->inverse[i][l] = t->lights ? 1 : 0;
            }
            continue;
        }
        tree_items *q = &items[0];
        q->pair[q->count] = t->root;
        q->what[q->count] = TREE_WHAT(l, 0u, (uint32_t)m);
        q->pmf[q->count++] = 1;
    }
    for (int from = 0; items[from].count; from = 1 - from)
        tree_down(ctx, g, keys, &items[from], &items[1 - from], out);
}

#endif
