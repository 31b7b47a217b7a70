/* Every function of src/core on random input, in the dialect itself: compiled as scalar C, as wide C and as GLSL. One
 * item is one set of inputs, made from its number alone; what the functions answer goes out through the bridge, slot by
 * slot. What works on values that are one for a tile has each item as a tile. Includers supply put_real(CTX item, slot,
 * x) and put_u32(CTX item, slot, x), put_u1(CTX item, slot, x) for tiles, words of memory for a tile by word_load(CTX
 * i) and word_store(CTX i, x), i below TILE_WORDS, words_load(CTX first) and words_store(CTX first, x) of as many as
 * there are lanes, in C words_row(CTX first), where they lie, and lane_places(first): first, first + 1, ... of the
 * lanes; ITEM_COUNT, how many items there are. ITEM_SLOTS is the number of slots. */
#ifndef DIALECT_KERNEL_H
#define DIALECT_KERNEL_H

#include "dialect_slots.h"

#define FRAME dialect_frame
#include "core/dialect.h"
#include "core/frame.h"

/* Of the item at hand: what functions of core read that take no item. */
#if defined(CORE_GLSL)
frame_constants dialect_frame;
u32 dialect_key;
real dialect_sums[2];
real dialect_weight;
u32 dialect_entries;
u1 dialect_item_of; /* the tile at hand */
#else
static frame_constants dialect_frame;
static u32 dialect_key;
static real dialect_sums[2]; /* of the reference method: what its chunks sum up to, its entries */
static real dialect_weight;
static u32 dialect_entries;
static u1 dialect_item_of; /* the tile at hand */
#endif
#include "core/camera.h"
#include "core/light.h"
#include "core/random.h"

#define KERNEL_LIGHTS 1000u

/* Signed, of a magnitude that differs from item to item: 1/16 to 4096. */
FN real any_real(u32 key, u32 dim) {
    real x = rng(key, dim) * K(2.0f) - K(1.0f);
    u32 size = shr(rng_bits(key, dim + KU(1u)), 28);
    real scale =
        sel(size < KU(4u), K(0.0625f), sel(size < KU(10u), K(8.0f), sel(size < KU(14u), K(256.0f), K(4096.0f))));
    return x * scale;
}

FN v3 any_v3(u32 key, u32 dim) {
    return V3(any_real(key, dim), any_real(key, dim + KU(2u)), any_real(key, dim + KU(4u)));
}

FN v3 unit3(v3 a) {
    real d2 = dot3(a, a);
    EXACT real inv = K(1.0f) / sqrt_(max_(d2, K(1e-12f)));
    return mul3(a, inv);
}

FN light any_light(u32 key) {
    light l;
    l.p = any_v3(key, KU(0u));
    l.kind = scale_u32(rng_bits(key, KU(6u)), KU(6u));
    l.a = mul3(any_v3(key, KU(7u)), K(0.01f));
    l.b = mul3(any_v3(key, KU(13u)), K(0.01f));
    l.radius = rng(key, KU(19u)) * K(2.0f);
    l.flags = shr(rng_bits(key, KU(20u)), 31);
    l.e = mul3(V3(rng(key, KU(21u)), rng(key, KU(22u)), rng(key, KU(23u))), K(5000.0f));
    l.area = K(1.0f);
    return l;
}

/* Ten heads of all poles, then whatever: 30 steps of gamma by 40 of C at most, windows 9 cells behind each 1,200th. */
FN profile_cell profile_load(CTX u32 place) {
    profile_cell c;
    u32 key = hash_u32(place + KU(78u));
    mask head = place < KU(10u);
    mask window = and_(place >= KU(10u), place - (place / KU(1200u)) * KU(1200u) == KU(9u));
    u32 pole = scale_u32(rng_bits(key, KU(7u)), KU(3u));
    u32 rows = KU(2u) + scale_u32(rng_bits(key, KU(0u)), KU(28u));
    u32 columns = KU(1u) + scale_u32(rng_bits(key, KU(1u)), KU(40u));
    real last = K(0.05f) + K(0.45f) * rng(key, KU(2u));
    EXACT real per_turn = to_real(rows) / last;
    c.near_ = sel(head, real_of_bits(place * KU(1200u) + KU(10u)), rng(key, KU(3u)));
    c.next = sel(head, real_of_bits(shl(pole, PROFILE_POLE) | shl(rows, 16) | columns), rng(key, KU(4u)));
    c.far_ = sel(head, per_turn, rng(key, KU(5u)));
    c.last = sel(head, last, rng(key, KU(6u)));
    c.near_ = sel(window, K(0.3f) * c.near_, c.near_);
    c.far_ = sel(window, K(60.0f) * c.far_, c.far_);
    return c;
}

FN light light_load(CTX u32 i) { return any_light(hash_u32(i + KU(77u))); }

#include "core/reuse.h" /* GLSL wants the bridge above it */
#include "core/shadow.h"
#include "core/sky.h"
#include "core/alias.h"
#include "core/given.h"
#include "core/influence_find.h"
#include "core/learned_cells.h"
#include "core/tree.h"
#include "ris_uniform.h"

FN surf any_surf(u32 key) {
    surf s;
    s.p = any_v3(key, KU(0u));
    s.n = unit3(any_v3(key, KU(6u)));
    s.wo = unit3(any_v3(key, KU(12u)));
    s.wo = sel3(dot3(s.n, s.wo) < K(0.0f), sub3(fill3(K(0.0f)), s.wo), s.wo);
    s.albedo = V3(rng(key, KU(18u)), rng(key, KU(19u)), rng(key, KU(20u)));
    real f0 = rng(key, KU(21u)) * K(2.0f) - K(1.0f);
    s.f0 = max_(f0, K(0.0f)); /* half of them are diffuse */
    real rough = K(0.05f) + K(0.95f) * rng(key, KU(22u));
    s.alpha = rough * rough;
    return s;
}

FN alias_slot alias_load(CTX u32 i) {
    alias_slot s;
    u32 key = hash_u32(i + KU(5u));
    s.keep = rng(key, KU(0u));
    s.other = scale_u32(rng_bits(key, KU(1u)), KU(KERNEL_LIGHTS));
    s.inverse = rng(key, KU(2u)) * K(1000.0f);
    s.inverse_other = rng(key, KU(3u)) * K(1000.0f);
    return s;
}

/* A map of 1000 x 500 texels that lights, and of 2000 x 1000 that are seen. */
FN v3 environment_texel(CTX u32 i) {
    u32 key = hash_u32(i + KU(15u));
    return mul3(V3(rng(key, KU(0u)), rng(key, KU(1u)), rng(key, KU(2u))), K(2.0f));
}
FN v3 backdrop_texel(CTX u32 i) {
    u32 key = hash_u32(i + KU(16u));
    return V3(rng(key, KU(0u)), rng(key, KU(1u)), rng(key, KU(2u)));
}
FN alias_slot environment_slot(CTX u32 i) {
    alias_slot s;
    u32 key = hash_u32(i + KU(17u));
    s.keep = rng(key, KU(0u));
    s.other = scale_u32(rng_bits(key, KU(1u)), KU(500000u));
    s.inverse = K(0.0f);
    s.inverse_other = K(0.0f);
    return s;
}
FN real environment_sine(CTX u32 row) { return K(1.0f) - to_real(row) * K(0.004f); }

/* A whole tree of 127 pairs. */
FN tree_child any_child(u32 i) {
    tree_child c;
    u32 key = hash_u32(i + KU(6u));
    c.c = any_v3(key, KU(0u));
    c.radius = rng(key, KU(6u)) * K(100.0f);
    c.axis_xy = rng_bits(key, KU(7u));
    c.axis_cone = rng_bits(key, KU(8u));
    c.power = rng(key, KU(14u)) * K(100.0f);
    c.link = selu(i < KU(127u), i, i | KU(TREE_LEAF));
    return c;
}
FN tree_pair tree_load(CTX u32 i) {
    tree_pair p;
    p.a = any_child(i * KU(2u) + KU(1u));
    p.b = any_child(i * KU(2u) + KU(2u));
    return p;
}

FN pick pick_load(CTX int i) {
    pick p;
    p.light = KU(37u * U32(i));
    p.inverse = K(1.0f + F32(i));
    return p;
}

FN void put_v3(CTX u32 item, int slot, v3 a) {
    put_real(PASS item, slot, a.x);
    put_real(PASS item, slot + 1, a.y);
    put_real(PASS item, slot + 2, a.z);
}

FN void put_sample(CTX u32 item, int slot, light_sample s) {
    put_v3(PASS item, slot, s.wi);
    put_real(PASS item, slot + 3, s.dist);
    put_v3(PASS item, slot + 4, s.le);
}

FN void put_resv(CTX u32 item, int slot, reservoir r) {
    put_u32(PASS item, slot, r.light);
    put_real(PASS item, slot + 1, r.u);
    put_real(PASS item, slot + 2, r.v);
    put_real(PASS item, slot + 3, r.w);
    put_real(PASS item, slot + 4, r.m);
    put_real(PASS item, slot + 5, r.p);
}

/* Slots 0 to 19. */
CALL void numbers(CTX u32 item, u32 key) {
    u32 bits = rng_bits(key, KU(1000u));
    real t = rng(key, KU(1001u));
    put_u32(PASS item, 0, bits);
    put_real(PASS item, 1, t);
    put_real(PASS item, 2, unit_low(bits));
    put_real(PASS item, 3, unit_high(bits));
    put_u32(PASS item, 4, scale_u32(bits, rng_bits(key, KU(1002u))));
    put_u32(PASS item, 5, scale_u32(bits, KU(1000u)));
    put_v3(PASS item, 6, circle(t));
    v3 n = unit3(any_v3(key, KU(1010u)));
    put_v3(PASS item, 9, around(n, t, rng(key, KU(1003u)), rng(key, KU(1004u))));
    put_v3(PASS item, 12, cosine_hemisphere(n, t, rng(key, KU(1005u))));
    put_v3(PASS item, 15, cross3(n, any_v3(key, KU(1020u))));
    put_real(PASS item, 18, luminance(any_v3(key, KU(1030u))));
    put_real(PASS item, 19, sqrt_(t));
}

/* Slots 20 to 54: 7 a kind; 55: a light of any kind. */
CALL void lights(CTX u32 item, u32 key, v3 y, light any) {
    light l = any;
    real u = rng(key, KU(2000u));
    real v = rng(key, KU(2001u));
    for (int kind = 0; kind < 5; kind++) {
        l.kind = KU(U32(kind));
        put_sample(PASS item, 20 + 7 * kind, sample_light(l, y, u, v));
    }
    put_real(PASS item, 55, sample_light(any, y, u, v).dist);
}

/* Slots 163 to 169: a spot that is somewhere between its cones. */
CALL void spots(CTX u32 item, u32 key, v3 y, light any) {
    light l = any;
    l.kind = KU(LIGHT_SPOT);
    l.a = mul3(unit3(l.a), K(1.7f));
    l.b = V3(rng(key, KU(2008u)) * K(3.0f) - K(1.0f), K(0.0f), K(0.0f));
    put_sample(PASS item, 163, sample_light(l, y, rng(key, KU(2002u)), rng(key, KU(2003u))));
}

/* Slots 179 to 202: lights of the kinds that have a profile, 7 a kind; what a light shows; a target. */
CALL void profiles(CTX u32 item, u32 key, surf s, light any) {
    light l = any;
    real u = rng(key, KU(2008u));
    real v = rng(key, KU(2009u));
    l.flags = l.flags | shl(KU(1u) + scale_u32(rng_bits(key, KU(2007u)), KU(10u)), LIGHT_PROFILE);
    for (int i = 0; i < 3; i++) {
        l.kind = KU(U32(i) + U32(i) / 2u * 2u);
        put_sample(PASS item, 179 + 7 * i, shining_sample(PASS l, s.p, u, v));
    }
    put_real(PASS item, 200, luminance(light_shown(l)));
    /* profiled and plain lights side by side */
    l.flags = selu(u < K(0.5f), l.flags, any.flags);
    put_real(PASS item, 201, target(PASS s, l, u, v));
    put_real(PASS item, 202, luminance(light_shown(l)));
}

/* Slots 141 to 161: flat lights sampled by solid angle, 7 a kind; 162: turn_of. */
CALL void close_lights(CTX u32 item, u32 key, v3 y, light any) {
    light l = any;
    l.radius = K(1e6f);
    for (int kind = 0; kind < 3; kind++) {
        l.kind = KU(U32(kind) + LIGHT_DISC);
        put_sample(PASS item, 141 + 7 * kind, sample_light(l, y, rng(key, KU(2002u)), rng(key, KU(2003u))));
    }
    put_real(PASS item, 162, turn_of(any_real(key, KU(2004u)), abs_(any_real(key, KU(2006u)))));
}

/* Slots 56 to 70. */
CALL void surfaces(CTX u32 item, u32 key, surf s, light any) {
    v3 wi = unit3(any_v3(key, KU(2010u)));
    put_v3(PASS item, 56, reflect(s, wi));
    surf d = s;
    d.f0 = K(0.0f);
    put_v3(PASS item, 59, reflect(d, wi));
    put_real(PASS item, 62, target(PASS s, any, rng(key, KU(2020u)), rng(key, KU(2021u))));
    camera c;
    c.eye = any_v3(key, KU(2030u));
    c.forward = unit3(any_v3(key, KU(2036u)));
    c.right = any_v3(key, KU(2042u));
    c.up = any_v3(key, KU(2048u));
    EXACT real right2 = K(1.0f) / dot3(c.right, c.right);
    EXACT real up2 = K(1.0f) / dot3(c.up, c.up);
    c.inv_right2 = right2;
    c.inv_up2 = up2;
    c.width = K(1280.0f);
    c.height = K(720.0f);
    put_v3(PASS item, 63, camera_project(c, s.p));
    put_v3(PASS item, 66, camera_direction(c, rng(key, KU(2054u)) * K(1280.0f), rng(key, KU(2055u)) * K(720.0f)));
    put_real(PASS item, 69, abs_(wi.x));
    put_real(PASS item, 70, to_real(to_u32(abs_(s.p.x))));
}

/* Slots 71 to 95. */
CALL void reservoirs(CTX u32 item, u32 key, surf s) {
    reservoir one = ris_uniform(PASS s, key, KU(KERNEL_LIGHTS), 1);
    reservoir r = ris_uniform(PASS s, key + KU(1u), KU(KERNEL_LIGHTS), 16);
    put_resv(PASS item, 71, one);
    put_resv(PASS item, 77, r);
    put_resv(PASS item, 83, reservoir_cap(r, K(7.0f)));
    reservoir_builder st = builder_empty();
    st = builder_add(st, one.light, one.u, one.v, one.p, one.p * one.w, one.m, K(1.0f), rng(key, KU(3000u)));
    st = builder_add(st, r.light, r.u, r.v, r.p, r.p * r.w * r.m, r.m, K(2.0f), rng(key, KU(3001u)));
    put_resv(PASS item, 89, builder_end(st, K(1.0f) / st.m));
    put_real(PASS item, 95, st.tag);
}

/* Slots 96 to 103. */
CALL void reuse(CTX u32 item, u32 key) {
    real p_i = rng(key, KU(3010u));
    real p_q = max_(rng(key, KU(3011u)) * K(2.0f) - K(1.0f), K(0.0f));
    real m_n = rng(key, KU(3012u)) * K(100.0f);
    real m_c = rng(key, KU(3013u)) * K(32.0f);
    real share = rng(key, KU(3014u));
    put_real(PASS item, 96, mis_scale(p_q, m_n));
    put_real(PASS item, 97, mis_scale(p_i, p_q));
    put_real(PASS item, 98, pair_share(m_n, p_i, m_c, p_q));
    put_real(PASS item, 99, pair_weight(share, m_n, p_i, m_c, p_q, rng(key, KU(3015u)) * K(900.0f)));
    put_real(PASS item, 100, pair_canonical(share, m_n, p_i, m_c, p_q));
    put_real(PASS item, 101, min_(p_i, p_q));
    put_real(PASS item, 102, max_(p_i, p_q));
    put_u32(PASS item, 103, selu(p_i < p_q, item, key));
}

/* Slots 104 to 125. */
CALL void rays(CTX u32 item, u32 key, surf s, light any) {
    segment g = shadow_segment(s.p, s.n, any, rng(key, KU(3020u)), rng(key, KU(3021u)), K(1e-4f));
    put_v3(PASS item, 104, g.o);
    put_v3(PASS item, 107, g.d);
    put_v3(PASS item, 110, sky_radiance(s.n, rng(key, KU(3022u))));
    put_real(PASS item, 113, ray_offset(max_abs3(mul3(s.p, K(100.0f))), K(1e-4f)));
    v3 at = sky_numbers(key, item);
    put_real(PASS item, 114, at.x);
    put_real(PASS item, 115, at.y);
    v3 d = sky_direction(s, at.x, at.y);
    put_v3(PASS item, 116, d);
    put_v3(PASS item, 119, visible_normal_direction(s, at.x, at.y));
    put_real(PASS item, 122, sky_density(s, unit3(any_v3(key, KU(3030u)))));
    put_v3(PASS item, 123, sky_backdrop(s.n, rng(key, KU(3022u))));
}

/* Slots 126 to 140. */
CALL void pickers(CTX u32 item, u32 key, surf s) {
    u32 bits = rng_bits(key, KU(3060u));
    pick a = alias_draw(PASS KU(KERNEL_LIGHTS), bits, rng(key, KU(3061u)));
    put_u32(PASS item, 126, a.light);
    put_real(PASS item, 127, a.inverse);
    put_real(PASS item, 128, alias_pmf(PASS a.light));
    tree_shares t = tree_choose(s.p, s.n, tree_load(PASS shr(bits, 26)));
    put_u32(PASS item, 129, tree_split(t, shr(bits, 22), tree_number(key, shr(bits, 26))));
    put_real(PASS item, 130, tree_share_of(t, (bits & KU(1u)) != KU(0u)));
    put_real(PASS item, 131, tree_pmf(PASS s.p, s.n, KU(0u), bits, 7));
    influence v;
    v.c = add3(s.p, any_v3(key, KU(3070u)));
    v.m = mul3(unit3(any_v3(key, KU(3076u))), K(3.0f));
    v.size = rng(key, KU(3082u));
    v.root = rng(key, KU(3083u)) * K(100.0f);
    v3 corner = any_v3(key, KU(3084u));
    corner = V3(max_(s.p.x, corner.x), max_(s.p.y, corner.y), max_(s.p.z, corner.z));
    influence_region y = influence_box(s.p, corner, s.n, dot3(s.n, s.p));
    mask held = and_(influence_holds(v, y, rng(key, KU(3090u))), influence_meets(v.c, add3(v.c, fill3(K(40.0f))), y));
    u32 n_f = shr(bits, 27);
    put_real(PASS item, 132, sel(held, influence_gives(v, influence_turn(v), y), K(0.0f)));
    put_real(PASS item, 133, influence_pmf(held, n_f, KU(KERNEL_LIGHTS), 32, 4));
    put_u32(PASS item, 134, influence_uniform(n_f, 30, 4));
    put_resv(PASS item, 135, ris_given(PASS s, key, 8));
}

/* Slots 170 to 178. */
CALL void picked(CTX u32 item, u32 key, surf s) {
    pick a = alias_draw(PASS KU(KERNEL_LIGHTS), rng_bits(key, KU(3102u)), rng(key, KU(3103u)));
    put_u32(PASS item, 170, a.light);
    put_real(PASS item, 171, a.inverse);
    u32 bits = rng_bits(key, KU(3100u));
    tree_step w = tree_go(PASS s.p, s.n, key, shr(bits, 25) & KU(63u), shr(bits, 22), rng(key, KU(3101u)));
    put_u32(PASS item, 172, w.to_a);
    put_u32(PASS item, 173, w.link_a);
    put_u32(PASS item, 174, w.link_b);
    put_real(PASS item, 175, w.pmf_a);
    put_real(PASS item, 176, w.pmf_b);
    pick t = tree_draw(PASS s.p, s.n, key, KU(0u), KU(32u), bits & KU(31u), 7);
    put_u32(PASS item, 177, t.light);
    put_real(PASS item, 178, t.inverse);
}

#include "dialect_frame.h"
#include "dialect_influence.h"
#include "dialect_learned.h"
#include "dialect_lists.h"
#include "dialect_presampled.h"
#include "dialect_textures.h"
#include "dialect_primary.h"

/* Parts of an item. A shader has one of them: the time that drivers compile for grows faster than the shader. */
CALL void dialect_lights(CTX u32 item) {
    u32 key = rng_key(KU(5u), item, KU(9u));
    surf s = any_surf(hash_u32(key + KU(1u)));
    light any = any_light(hash_u32(key + KU(2u)));
    numbers(PASS item, key);
    lights(PASS item, key, s.p, any);
    close_lights(PASS item, key, s.p, any);
    spots(PASS item, key, s.p, any);
    profiles(PASS item, key, s, any);
    surfaces(PASS item, key, s, any);
    rays(PASS item, key, s, any);
}

CALL void dialect_reservoirs(CTX u32 item) {
    u32 key = rng_key(KU(5u), item, KU(9u));
    surf s = any_surf(hash_u32(key + KU(1u)));
    reservoirs(PASS item, key, s);
    reuse(PASS item, key);
    pickers(PASS item, key, s);
    picked(PASS item, key, s);
    presampling(PASS item, key, s);
}

CALL void dialect_frames(CTX u32 item) {
    u32 key = rng_key(KU(5u), item, KU(9u));
    frame_item(PASS item, key, any_surf(hash_u32(key + KU(1u))));
    primaries(PASS item, key);
}

CALL void dialect_draws(CTX u32 item) {
    u32 key = rng_key(KU(5u), item, KU(9u));
    surf s = any_surf(hash_u32(key + KU(1u)));
    influence_draws(PASS item, key, s);
    lists_item(PASS item, key, s);
    textures(PASS item, key);
}

FN void dialect_item(CTX u32 item) {
    dialect_lights(PASS item);
    dialect_reservoirs(PASS item);
    dialect_frames(PASS item);
    dialect_draws(PASS item);
}

FN void dialect_tile(CTX u1 item) {
    dialect_frame = dialect_constants(BIAS_BIASED);
    dialect_volumes(PASS item);
    dialect_cells(PASS item);
}

FN void dialect_tile_lists(CTX u1 item) {
    dialect_frame = dialect_constants(BIAS_BIASED);
    lists_tile(PASS item);
}

#endif
