/* Bridge between core/ and blocks of pixels: loads, stores, masks and light records for CORE_LANES lanes (scalar: 1).
 */
#ifndef NOC_CPU_LANES_H
#define NOC_CPU_LANES_H

#include "backend/cpu/kernels.h"

#include "core/alias.h"
#include "core/camera.h"
#include "core/random.h"
#include "core/reservoir.h"
#include "core/receiver.h"
#include "core/reuse.h"
#include "core/shadow.h"
#include "core/sky.h"
#include "core/texture.h"
#include "core/wide_load.h"

#include <string.h>

#if defined(CORE_LANES)
FN real rload(const float *p) {
    real r;
    memcpy(&r, p, sizeof(r));
    return r;
}
FN u32 uload(const uint32_t *p) {
    u32 r;
    memcpy(&r, p, sizeof(r));
    return r;
}
FN mask mload(uint32_t lanes, int first) {
    u32 bit;
    for (int i = 0; i < LANES; i++)
        bit[i] = 1u << i;
    return (mask)((KU(lanes >> first) & bit) != KU(0u));
}
#else
FN real rload(const float *p) { return *p; }
FN u32 uload(const uint32_t *p) { return *p; }
FN mask mload(uint32_t lanes, int first) { return lanes >> first & 1; }
#endif
FN uint32_t mbits(mask m) { return lane_bits(m); }
FN void rstore(float *p, real v) { memcpy(p, &v, sizeof(v)); }
FN void ustore(uint32_t *p, u32 v) { memcpy(p, &v, sizeof(v)); }

/* Pixel of the lanes from `first` in the block whose lane 0 is (x, y). */
FN u32 lane_numbers(int first) {
    uint32_t n[LANES];
    for (int i = 0; i < LANES; i++)
        n[i] = (uint32_t)(first + i);
    return uload(n);
}
FN u32 lane_x(int x, int first) { return KU((uint32_t)x) + (lane_numbers(first) & KU(3u)); }
FN u32 lane_y(int y, int first) { return KU((uint32_t)y) + shr(lane_numbers(first), 2); }

FN u32 key_in(const struct core_context *ctx, int x, int y, int first, uint32_t frame) {
    u32 pixel = lane_y(y, first) * KU(ctx->frame->width) + lane_x(x, first);
    return rng_key(KU(ctx->frame->seed), pixel, KU(frame));
}
FN u32 key_of(const struct core_context *ctx, int x, int y, int first) {
    return key_in(ctx, x, y, first, ctx->frame->index);
}

FN light light_load(CTX u32 i) { return light_from_records((const float *)ctx->lights, i); }

/* Words of memory, one a lane. */
FN u32 word_gather(const void *base, u32 index) {
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
    return (u32)_mm512_i32gather_epi32((__m512i)index, base, 4);
#elif defined(CORE_LANES) && CORE_LANES == 8 && defined(__AVX2__)
    return (u32)_mm256_i32gather_epi32(base, (__m256i)index, 4);
#else
    uint32_t at[LANES];
    ustore(at, index);
    for (int i = 0; i < LANES; i++)
        at[i] = ((const uint32_t *)base)[at[i]];
    return uload(at);
#endif
}
FN real real_gather(const void *base, u32 index) {
    u32 bits = word_gather(base, index);
    real r;
    memcpy(&r, &bits, sizeof(r));
    return r;
}

FN alias_slot slot_gather(const noc_alias_slot *slots, u32 i) {
    u32 at = shl(i, 2);
    alias_slot s;
    s.keep = real_gather(slots, at);
    s.other = word_gather(slots, at + KU(1u));
    s.inverse = real_gather(slots, at + KU(2u));
    s.inverse_other = real_gather(slots, at + KU(3u));
    return s;
}
FN alias_slot alias_load(CTX u32 i) { return slot_gather(ctx->alias->slots, i); }

FN v3 texel_gather(const float *texels, u32 i) {
    u32 at = i * KU(3u);
    return V3(real_gather(texels, at), real_gather(texels, at + KU(1u)), real_gather(texels, at + KU(2u)));
}

FN v3 environment_texel(CTX u32 i) { return texel_gather(ctx->environment->light, i); }
FN v3 backdrop_texel(CTX u32 i) { return texel_gather(ctx->environment->texels, i); }
FN alias_slot environment_slot(CTX u32 i) { return slot_gather(ctx->map_light->texels->slots, i); }
FN real environment_sine(CTX u32 row) { return real_gather(ctx->map_light->sines, row); }

FN profile_cell profile_load(CTX u32 place) { return profile_from_cells(ctx->profiles, place); }

/* The same light in every lane. */
FN light light_splat(CTX uint32_t i) { return light_of_record(ctx->lights[i]); }

/* Element `field` of each lane's material record. */
FN real material_field(const noc_material_record *base, u32 index, int field) {
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
    return (real)_mm512_i32gather_ps((__m512i)shl(index, 3), (const float *)base + field, 4);
#else
    float f[LANES];
    uint32_t at[LANES];
    ustore(at, index);
    for (int i = 0; i < LANES; i++)
        f[i] = ((const float *)(base + at[i]))[field];
    return rload(f);
#endif
}

/* What surfaces are made of. Most blocks see one material, which then is loaded once. */
FN surf_material materials_load(const noc_material_record *base, u32 index) {
    uint32_t at[LANES];
    ustore(at, index);
    if (!ANY(index != KU(at[0])))
        return material_of_record(base[at[0]]);
    surf_material m;
    m.albedo = V3(material_field(base, index, 0), material_field(base, index, 1), material_field(base, index, 2));
    m.f0 = material_field(base, index, 3);
    m.alpha = material_field(base, index, 7);
    return m;
}

FN u32 texel_load(CTX u32 place) {
#if defined(CORE_LANES) && CORE_LANES == 16 && defined(__AVX512F__)
    return (u32)_mm512_i32gather_epi32((__m512i)place, (const int *)ctx->texels, 4);
#else
    uint32_t t[LANES], at[LANES];
    ustore(at, place);
    for (int i = 0; i < LANES; i++)
        t[i] = ctx->texels[at[i]];
    return uload(t);
#endif
}

FN receiver receiver_load(const gblock *g, int l) {
    receiver r;
    r.p = V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l));
    r.n = V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l));
    r.depth = rload(g->depth + l);
    r.material = uload(g->material + l);
    r.light = uload(g->light + l);
    return r;
}

FN void receiver_store(gblock *g, int l, receiver r) {
    rstore(g->px + l, r.p.x);
    rstore(g->py + l, r.p.y);
    rstore(g->pz + l, r.p.z);
    rstore(g->nx + l, r.n.x);
    rstore(g->ny + l, r.n.y);
    rstore(g->nz + l, r.n.z);
    rstore(g->depth + l, r.depth);
    ustore(g->material + l, r.material);
    ustore(g->light + l, r.light);
}

/* The receiving surfaces, seen from eye. */
FN surf surf_load(CTX const gblock *g, int l, const float eye[3]) {
    v3 p = V3(rload(g->px + l), rload(g->py + l), rload(g->pz + l));
    v3 n = V3(rload(g->nx + l), rload(g->ny + l), rload(g->nz + l));
    u32 m = uload(g->material + l), texel = KU(0u);
    m = selu(m == KU(NO_SURFACE), KU(0u), m);
    if (ctx->texels)
        texel = uload(g->texel + l);
    return surf_of_receiver(p, n, splat3(eye), materials_load(ctx->materials, m), texel,
                            (ctx->frame->flags & FRAME_MATTE) != 0);
}

FN reservoir reservoir_load(const rblock *b, int l) {
    reservoir r;
    r.light = uload(b->light + l);
    r.u = rload(b->u + l);
    r.v = rload(b->v + l);
    r.w = rload(b->w + l);
    r.m = rload(b->m + l);
    r.p = rload(b->p + l);
    return r;
}

FN void reservoir_store(rblock *b, int l, reservoir r) {
    ustore(b->light + l, r.light);
    rstore(b->u + l, r.u);
    rstore(b->v + l, r.v);
    rstore(b->w + l, r.w);
    rstore(b->m + l, r.m);
    rstore(b->p + l, r.p);
}

/* Lanes whose sample has to be asked about. visible: lanes of which it is known to be seen. */
FN uint32_t lanes_that_ask(const rblock *b, uint32_t visible) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l += LANES)
        lanes |= mbits(resolve_asks(reservoir_load(b, l), mload(visible, l))) << l;
    return lanes;
}

FN void block_samples(rblock *b, uint32_t blocked) {
    for (int l = 0; l < BLOCK; l += LANES)
        rstore(b->w + l, reservoir_blocked(reservoir_load(b, l), mload(blocked, l)).w);
}

FN void ray_store(rayblock *b, int l, v3 o, v3 d) {
    rstore(b->o[0] + l, o.x);
    rstore(b->o[1] + l, o.y);
    rstore(b->o[2] + l, o.z);
    rstore(b->d[0] + l, d.x);
    rstore(b->d[1] + l, d.y);
    rstore(b->d[2] + l, d.z);
}

#endif
