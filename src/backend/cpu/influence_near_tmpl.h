/* Bridge between core/influence_near.h and the hierarchies of influence volumes (light/influence.h), 16 children or
 * volumes at a time; included by kernels.c. */
#ifndef NOC_CPU_INFLUENCE_NEAR_H
#define NOC_CPU_INFLUENCE_NEAR_H

#include "core/influence_near.h"

_Static_assert((int)NOC_INFLUENCE_WIDTH == 16 && (int)NOC_HALVES == (int)NEAR_HALVES &&
                   NOC_INFLUENCE_LEVELS * 15 + 1 <= NEAR_STACK,
               "the hierarchies are those that are searched");

FN influence influence_load(CTX u32 index) {
    const noc_influence_volume *volumes = ctx->influence->volumes;
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

FN v3 load3(const float a[3][BLOCK], int l) { return V3(rload(a[0] + l), rload(a[1] + l), rload(a[2] + l)); }

FN near_half near_half_load(CTX u1 k) {
    const noc_influence_half *h = &ctx->influence->half[k];
    return (near_half){ (u1)h->levels, h->first, h->first + h->count };
}

FN near_children boxes_load(const noc_influence_node *n, int l) {
    return (near_children){ load3(n->lo, l), load3(n->hi, l), rload(n->root + l) };
}
FN near_children near_children_load(CTX u1 k, u1 level, u1 node, u1 l) {
    const noc_influence_half *h = &ctx->influence->half[k];
    return boxes_load(&h->nodes[h->level_at[level] + node], (int)l);
}

FN influence near_volumes_load(CTX u1 first, u1 end) {
    u32 i = KU(first) + lane_numbers(0);
    return influence_load(ctx, selu(i < KU(end), i, KU(ctx->influence->volume_count)));
}

FN void near_ask_ahead(CTX u1 first) {
    for (int i = 0; i < BLOCK; i += 2) /* two to a line */
        __builtin_prefetch(ctx->influence->volumes + first + i);
}

/* Some lanes of a value, one after the other from `to` on; behind them up to LANES words may be written, too. */
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
typedef __mmask16 lane_order;
FN lane_order lanes_of(u1 bits) { return (__mmask16)bits; }
FN void lanes_pack(void *to, u32 v, lane_order lanes) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(lanes, (__m512i)v));
}
#elif defined(CORE_LANES) && CORE_LANES == 8 && defined(__AVX2__) && defined(__BMI2__)
typedef __m256i lane_order;
FN lane_order lanes_of(u1 bits) {
    uint64_t bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100u, bytes)));
}
FN void lanes_pack(void *to, u32 v, lane_order lanes) {
    _mm256_storeu_si256(to, _mm256_permutevar8x32_epi32((__m256i)v, lanes));
}
#else
typedef u1 lane_order;
FN lane_order lanes_of(u1 bits) { return bits; }
FN void lanes_pack(void *to, u32 v, lane_order lanes) {
    uint32_t from[LANES], *out = to;
    for (ustore(from, v); lanes; lanes &= lanes - 1)
        *out++ = from[low_bit(lanes)];
}
#endif

FN noc_near *near_list(CTX u1 list) { return &ctx->at.volumes->near[list]; }
FN float *near_field(CTX u1 list, int field, u1 place) {
    const noc_near *near = near_list(ctx, list);
    return near->data + (size_t)field * near->room + place;
}
FN real near_real(CTX u1 list, int field, u1 first) { return rload(near_field(ctx, list, field, first)); }

FN void near_clear(CTX u1 list) {
    noc_near *near = near_list(ctx, list);
    near->count = near->packs.len = 0;
    near->no_memory = false;
}

FN u1 near_count(CTX u1 list) { return (u1)near_list(ctx, list)->count; }

/* Volumes stand close together: every group of points looks at them. */
FN b1 near_add(CTX u1 list, u1 first, u1 bits, influence v, real turn) {
    noc_near *near = near_list(ctx, list);
    if (near->count + 3 * BLOCK > near->room && !noc_near_grow(near)) {
        near->no_memory = true;
        return false;
    }
    const real fields[] = { v.c.x, v.c.y, v.c.z, v.size, v.m.x, v.m.y, v.m.z, v.root, turn };
    _Static_assert(sizeof(fields) / sizeof(*fields) == NOC_NEAR_ID, "all fields but the last");
    lane_order lanes = lanes_of(bits);
    u1 at = near_count(ctx, list);
    for (int k = 0; k < NOC_NEAR_ID; k++)
        lanes_pack(near_field(ctx, list, k, at), bits_of_real(fields[k]), lanes);
    lanes_pack(near_field(ctx, list, NOC_NEAR_ID, at), KU(first) + lane_numbers(0), lanes);
    at += bit_count(bits);
    for (int l = 0; l < BLOCK; l += LANES) { /* what is behind the last one holds nothing */
        rstore(near_field(ctx, list, NOC_NEAR_ROOT, at + (u1)l), K(0.0f));
        rstore(near_field(ctx, list, NOC_NEAR_ID, at + (u1)l), K(0.0f));
    }
    near->count = at;
    return true;
}

FN v3 near_three(CTX u1 list, int field, u1 first) {
    return V3(near_real(ctx, list, field, first), near_real(ctx, list, field + 1, first),
              near_real(ctx, list, field + 2, first));
}
FN influence near_load(CTX u1 list, u1 first) {
    influence a;
    a.c = near_three(ctx, list, NOC_NEAR_C, first);
    a.size = near_real(ctx, list, NOC_NEAR_SIZE, first);
    a.m = near_three(ctx, list, NOC_NEAR_M, first);
    a.root = near_real(ctx, list, NOC_NEAR_ROOT, first);
    return a;
}
FN real near_turn(CTX u1 list, u1 first) { return near_real(ctx, list, NOC_NEAR_TURN, first); }
FN u32 near_ids(CTX u1 list, u1 first) { return bits_of_real(near_real(ctx, list, NOC_NEAR_ID, first)); }
FN f1 near_lights(CTX u1 list, u1 place) {
    const uint32_t *first = ctx->influence->first;
    u1 volume = bits_of_f1(*near_field(ctx, list, NOC_NEAR_ID, place));
    return first ? (float)(first[volume + 1] - first[volume]) : 1;
}
FN b1 near_lost(CTX u1 list) { return near_list(ctx, list)->no_memory; }

FN void near_pack_store(CTX u1 list, u1 pack, f3 lo, f3 hi, f1 root) {
    noc_near *near = near_list(ctx, list);
    if (pack % BLOCK == 0) {
        if (near->no_memory || !array_reserve(&near->packs, near->packs.len + 1)) {
            near->no_memory = true;
            return;
        }
        near->packs.data[near->packs.len++] = (noc_influence_node){ .root = { 0 } };
    }
    if (near->no_memory)
        return;
    noc_influence_node *n = &near->packs.data[pack / BLOCK];
    const float box[2][3] = { { lo.x, lo.y, lo.z }, { hi.x, hi.y, hi.z } };
    for (int k = 0; k < 3; k++) {
        n->lo[k][pack % BLOCK] = box[0][k];
        n->hi[k][pack % BLOCK] = box[1][k];
    }
    n->root[pack % BLOCK] = root;
}
FN near_children near_packs_load(CTX u1 list, u1 first) {
    return boxes_load(&near_list(ctx, list)->packs.data[first / BLOCK], (int)(first % BLOCK));
}

/* A query as light/influence.h keeps it, and as core/ does. */
FN1 near_query query_of_record(const noc_near_query *have) {
    near_query q;
    _Static_assert(sizeof(q) == sizeof(*have), "records are core's");
    memcpy(&q, have, sizeof(q));
    return q;
}
FN1 noc_near_query record_of_query(near_query have) {
    noc_near_query q;
    memcpy(&q, &have, sizeof(q));
    return q;
}

#endif
