/* Light lists in the dialect test: included by dialect_kernel.h. Slots count from LISTS_FIRST. What lies in a tile's
 * words are lists and scores, as many as the clusters below can make; surfaces and clusters come from numbers. */
#ifndef DIALECT_LISTS_H
#define DIALECT_LISTS_H

#include "core/list_rays.h"

#define FAKE_GROUPS 128u
#define FAKE_LINE (16u * (FAKE_GROUPS + 1u))
#define FAKE_RECORDS (FAKE_LINE + FAKE_GROUPS + 1u)
#define FAKE_PATCHES (FAKE_RECORDS + FAKE_GROUPS)
#define FAKE_PARENTS (FAKE_PATCHES + 16u * 6u)
#define FAKE_PIECES (FAKE_PARENTS + 128u)
#define FAKE_ENTRIES (FAKE_PIECES + 6u)
#define FAKE_ROOM 64u
#define FAKE_SKETCHES (FAKE_ENTRIES + 2u * FAKE_ROOM)
#define FAKE_SEEN (FAKE_SKETCHES + 32u * U32(SKETCH_WORDS))
#define FAKE_FAR (FAKE_SEEN + 15u * 16u) /* of three faces, and four rows, the last of what is expected */
#define FAKE_COLUMNS (FAKE_FAR + 3u * 64u)
#define FAKE_BITS (FAKE_COLUMNS + 3u * 17u)
#define FAKE_NEAR (FAKE_BITS + 3u * 4u)
#define FAKE_END (FAKE_NEAR + 3u * 32u) /* at most TILE_WORDS */

#define PIXEL_ENTRIES 20u /* of the list that pixels share their rays out over */
#define PIXEL_NEAR 12u    /* of them: the first ones */
#define PIXEL_RAYS 12

/* The tile at hand, and of the pixels at hand: what they weigh, draw and find. */
#if defined(CORE_GLSL)
u1 dialect_number;
real dialect_summed[PIXEL_NEAR + 1u];
mask dialect_near[PIXEL_NEAR];
list_drawn dialect_drawn[PIXEL_RAYS];
list_ray dialect_found[PIXEL_RAYS];
#else
static u1 dialect_number;
static real dialect_summed[PIXEL_NEAR + 1u];
static mask dialect_near[PIXEL_NEAR];
static list_drawn dialect_drawn[PIXEL_RAYS];
static list_ray dialect_found[PIXEL_RAYS];
#endif

/* ---- memory ---- */

FN1 u1 group_word(u1 group) {
    if (group == U32(LIST_SPARE))
        return 16u * FAKE_GROUPS;
    return 16u * group;
}
FN real score_load(CTX u1 group, int l) { return real_of_bits(words_load(PASS group_word(group) + U32(l))); }
FN void score_store(CTX u1 group, int l, real x) { words_store(PASS group_word(group) + U32(l), bits_of_real(x)); }
FN f1 score_at(CTX u1 group, u1 place) { return f1_of_bits(word_load(PASS group_word(group) + place)); }
FN void score_clear(CTX u1 group, u1 place) { word_store(PASS group_word(group) + place, 0u); }
#ifndef CORE_GLSL
FN const float *score_row(CTX u1 group) { return words_row(PASS group_word(group)); }
#endif
FN void parent_store(CTX u1 i, f1 score) { word_store(PASS FAKE_PARENTS + i, bits_of_f1(score)); }
FN f1 parent_load(CTX u1 i) { return f1_of_bits(word_load(PASS FAKE_PARENTS + i)); }
FN void list_group_store(CTX u1 group, list_group g) {
    word_store(PASS FAKE_RECORDS + group, g.part | shl(g.level, 4) | shl(g.block, 8));
}
FN list_group list_group_load(CTX u1 group) {
    list_group g;
    u1 x = word_load(PASS FAKE_RECORDS + group);
    g.part = x & 15u;
    g.level = shr(x, 4) & 15u;
    g.block = shr(x, 8);
    return g;
}
FN void line_store(CTX u1 group, u1 before) { word_store(PASS FAKE_LINE + group, before); }
FN u1 line_load(CTX u1 group) { return word_load(PASS FAKE_LINE + group); }
FN void entry_store(CTX u1 i, list_entry e) {
    word_store(PASS FAKE_ENTRIES + 2u * i, e.light);
    word_store(PASS FAKE_ENTRIES + 2u * i + 1u, bits_of_f1(e.weight));
}
FN list_entry entry_load(CTX u1 i) {
    list_entry e;
    e.light = word_load(PASS FAKE_ENTRIES + 2u * i);
    e.weight = f1_of_bits(word_load(PASS FAKE_ENTRIES + 2u * i + 1u));
    return e;
}

FN void word3_store(CTX u1 at, f3 a) {
    word_store(PASS at, bits_of_f1(a.x));
    word_store(PASS at + 1u, bits_of_f1(a.y));
    word_store(PASS at + 2u, bits_of_f1(a.z));
}
FN f3 word3_load(CTX u1 at, u1 stride) {
    return F3(f1_of_bits(word_load(PASS at)), f1_of_bits(word_load(PASS at + stride)),
              f1_of_bits(word_load(PASS at + 2u * stride)));
}
FN void piece_store(CTX u1 i, u1 pixels) { word_store(PASS FAKE_PIECES + i, pixels); }
FN u1 piece_load(CTX u1 i) { return word_load(PASS FAKE_PIECES + i); }
FN void patch_store(CTX u1 i, list_patch t) {
    u1 at = FAKE_PATCHES + 16u * i;
    word3_store(PASS at, t.c);
    word_store(PASS at + 3u, bits_of_f1(t.radius));
    word3_store(PASS at + 4u, t.axis);
    word_store(PASS at + 7u, bits_of_f1(t.spread));
    word_store(PASS at + 8u, bits_of_f1(t.share));
    word_store(PASS at + 9u, bits_of_f1(t.reflectance));
    word3_store(PASS at + 10u, t.wo);
    word_store(PASS at + 13u, bits_of_f1(t.gloss));
    word_store(PASS at + 14u, bits_of_f1(t.alpha2));
}
FN list_patch patch_load(CTX u1 i) {
    u1 at = FAKE_PATCHES + 16u * i;
    list_patch t;
    t.c = word3_load(PASS at, 1u);
    t.radius = f1_of_bits(word_load(PASS at + 3u));
    t.axis = word3_load(PASS at + 4u, 1u);
    t.spread = f1_of_bits(word_load(PASS at + 7u));
    t.share = f1_of_bits(word_load(PASS at + 8u));
    t.reflectance = f1_of_bits(word_load(PASS at + 9u));
    t.wo = word3_load(PASS at + 10u, 1u);
    t.gloss = f1_of_bits(word_load(PASS at + 13u));
    t.alpha2 = f1_of_bits(word_load(PASS at + 14u));
    return t;
}

/* ---- surfaces and lights of a tile ---- */

FN1 f3 tile_point3(u1 i, f1 size) {
    EXACT f1 x = tile_real(dialect_number, i) * size - 0.5f * size;
    EXACT f1 y = tile_real(dialect_number, i + 1u) * size - 0.5f * size;
    EXACT f1 z = tile_real(dialect_number, i + 2u) * size - 0.5f * size;
    return F3(x, y, z);
}
FN1 f3 tile_unit(u1 i) {
    f3 a = tile_point3(i, 2.0f);
    EXACT f1 inv = 1.0f / sqrt1(dot1(a, a) + 1e-6f);
    EXACT f1 x = a.x * inv;
    EXACT f1 y = a.y * inv;
    EXACT f1 z = a.z * inv;
    return F3(x, y, z);
}

/* Block 0 sees surfaces everywhere, 1 in places, 2 in every other tile. */
FN u1 tile_pixels(CTX u1 block) {
    if (block == 0u)
        return 0xffffu;
    if (block == 1u)
        return tile_bits(dialect_number, 100u) & 0xffffu;
    return 0x0f0fu * (dialect_number & 1u);
}
/* Every fourth tile sees something far behind, of every eighth the normals cancel out. In every fourth, blocks 0 and 1
 * lie at one place. */
FN list_point tile_point(CTX u1 block, u1 place) {
    list_point q;
    u1 material = block + place;
    if ((dialect_number & 3u) == 2u && block == 1u)
        block = 0u;
    f3 corner = tile_point3(101u + 3u * block, 20.0f);
    b1 behind = (dialect_number & 3u) == 0u && (place & 3u) > 1u;
    f3 n = tile_unit(110u + 3u * block + (place & shr(dialect_number, 4) & 1u));
    q.depth = 20.0f + 0.125f * F32(place);
    if (behind)
        q.depth = 60.0f;
    if ((dialect_number & 7u) == 7u && (place & 1u) == 0u)
        n = F3(0.0f - n.x, 0.0f - n.y, 0.0f - n.z);
    q.p = F3(corner.x + 0.5f * F32(place & 3u), corner.y + 0.5f * F32(shr(place, 2)), corner.z + q.depth);
    q.n = n;
    q.material = material & 3u;
    return q;
}
FN list_material list_material_load(CTX u1 material) {
    list_material m;
    m.albedo = F3(0.25f * F32(material), 0.5f, 0.125f);
    m.f0 = 0.0f;
    m.alpha = 0.5f;
    if ((material & 1u) != 0u) {
        m.f0 = 0.04f;
        m.alpha = 0.05f;
    }
    return m;
}

/* In most tiles two levels of lights that stand, and one of lights that move. */
FN list_top top_load(CTX u1 part) {
    list_top top;
    u1 bits = tile_bits(dialect_number, 120u + part);
    top.levels = 2u - part;
    top.nodes = 1u + bits % 5u;
    if (part == 1u)
        top.nodes = bits % 20u;
    else if ((bits & 0x700u) == 0u)
        top.nodes = 0u;
    if (top.nodes == 0u)
        top.levels = 0u;
    return top;
}
FN u32 places_key(CTX u1 of, u1 block, int l) {
    return hash_u32(lane_places(16u * block + U32(l)) + hash_u32(KU(of + 8u * (dialect_number & 1023u))));
}
/* A quarter of them are empty, and all that lie past the end. */
FN list_node node_load(CTX u1 part, u1 level, u1 block, int l) {
    list_node n;
    u32 key = places_key(PASS part + 2u * level, block, l);
    u1 end = 4096u;
    if (level == 1u - part)
        end = top_load(PASS part).nodes;
    real wide = rng(key, KU(1u));
    EXACT real x = (rng(key, KU(2u)) - K(0.5f)) * K(60.0f);
    EXACT real y = (rng(key, KU(3u)) - K(0.5f)) * K(60.0f);
    EXACT real z = (rng(key, KU(4u)) - K(0.5f)) * K(60.0f);
    n.c = V3(x, y, z);
    n.radius = rng(key, KU(5u)) * K(4.0f);
    n.axis = unit3(any_v3(key, KU(6u)));
    EXACT real cosine = wide * K(2.0f) - K(1.0f);
    EXACT real sine = sqrt_(K(1.0f) - cosine * cosine);
    n.cos_cone = cosine;
    n.sin_cone = sine;
    EXACT real power = rng(key, KU(12u)) * rng(key, KU(13u)) * K(1000.0f);
    mask some = and_(rng(key, KU(14u)) < K(0.75f), lane_places(16u * block + U32(l)) < KU(end));
    n.power = sel(some, power, K(0.0f));
    return n;
}
FN list_cluster cluster_load(CTX u1 part, u1 cluster) {
    list_cluster c;
    u1 i = 130u + 8u * cluster + 4u * part;
    c.c = tile_point3(i, 60.0f);
    c.radius = 0.25f + tile_real(dialect_number, i + 3u);
    c.power = 100.0f;
    return c;
}
FN list_brief brief_load(CTX u1 part, u1 cluster, int l) {
    list_brief b;
    u32 key = places_key(PASS 6u + part, cluster, l);
    EXACT real shine = K(1.0f) + rng(key, KU(1u)) * K(99.0f);
    u32 strong = bits_of_real(shine);
    f1 share = 0.75f;
    if ((tile_bits(dialect_number, 370u + cluster) & 7u) == 0u)
        share = 0.0f; /* all are dark */
    mask some = rng(key, KU(2u)) < K(share);
    b.place = rng_bits(key, KU(3u));
    b.shine = selu(some, (strong & KU(0xffff0000u)) | (rng_bits(key, KU(4u)) & KU(0xffffu)), KU(0u));
    return b;
}
FN u1 cluster_light(CTX u1 part, u1 cluster, u1 place) { return 4096u * part + 16u * cluster + place; }

FN light light_splat(CTX u1 i) { return any_light(hash_u32(KU(i) + KU(77u))); }

/* ---- what pixels know of entries and rays ---- */

FN void put_f1(CTX u1 item, int slot, f1 x) { put_u1(PASS item, slot, bits_of_f1(x)); }

#include "dialect_faces.h"

/* ---- what pixels weigh alone, and draw: the first entries are near, and what the others weigh comes from numbers ----
 */

FN u1 near_entry(CTX u1 i) { return i; }
FN u1 near_place(CTX u1 i) { return (i & 1u) * 16u + shr(i, 1); }
FN mask near_pixels(CTX u1 i) { return dialect_near[i]; }
FN u32 near_entry_at(CTX u32 i) { return i; }
FN real far_at(CTX u32 face, u32 row, u32 column) { return to_real(row * (row + column + face)) * K(0.125f); }
FN real column_at(CTX u32 face, u32 column) { return to_real(column * (column + face * KU(2u) + KU(3u))) * K(0.125f); }
FN real entry_weight(CTX u32 i) { return K(1.0f) + rng(i, KU(2u)); }
FN void summed_store(CTX u1 i, real sum) { dialect_summed[i] = sum; }
FN real summed_at(CTX u32 i) {
    real x = dialect_summed[0];
    for (u1 k = 1u; k <= PIXEL_NEAR; k++)
        x = sel(i == KU(k), dialect_summed[k], x);
    return x;
}
FN void drawn_store(CTX u32 ray, mask on, list_drawn d) {
    for (int k = 0; k < PIXEL_RAYS; k++) {
        mask here = and_(on, ray == KU(U32(k)));
        dialect_drawn[k].entry = selu(here, d.entry, dialect_drawn[k].entry);
        dialect_drawn[k].times = sel(here, d.times, dialect_drawn[k].times);
        dialect_drawn[k].weighed = sel(here, d.weighed, dialect_drawn[k].weighed);
    }
}
FN real drawn_times(CTX u1 ray) { return dialect_drawn[ray].times; }
FN real found_p(CTX u1 ray) { return dialect_found[ray].p; }
FN real found_w(CTX u1 ray) { return dialect_found[ray].w; }
FN list_found found_of(CTX u32 ray) {
    list_found f;
    f.entry = KU(0u);
    f.times = K(1.0f);
    f.w = K(0.0f);
    f.p = K(0.0f);
    for (int k = 0; k < PIXEL_RAYS; k++) {
        mask here = ray == KU(U32(k));
        f.entry = selu(here, dialect_drawn[k].entry, f.entry);
        f.times = sel(here, max_(dialect_drawn[k].times, K(1.0f)), f.times);
        f.w = sel(here, dialect_found[k].w, f.w);
        f.p = sel(here, dialect_found[k].p, f.p);
    }
    return f;
}

/* ---- pixels ---- */

FN light drawn_light(CTX list_drawn d) { return light_load(PASS entry_light(PASS d.entry)); }

/* Shares rays out anew; returns a number of all that were drawn. */
FN u32 draw_rays(CTX u32 item, int slot, real all_of, real n, real start) {
    for (int k = 0; k < PIXEL_RAYS; k++) {
        dialect_drawn[k].entry = KU(0u);
        dialect_drawn[k].times = K(0.0f);
        dialect_drawn[k].weighed = K(1.0f);
    }
    u32 face = item & KU(3u);
    u32 rays = list_share_out(PASS all_of, PIXEL_NEAR, face, list_rows(PIXEL_ENTRIES), n, start);
    u32 all = rays;
    for (int k = 0; k < PIXEL_RAYS; k++) {
        all = hash_u32(all + dialect_drawn[k].entry * KU(16u) + to_u32(dialect_drawn[k].times));
        all = hash_u32(all + bits_of_real(dialect_drawn[k].weighed));
    }
    put_u32(PASS item, slot, rays);
    return all;
}

/* Slots 0 to 24, and 78 to 92. The lights' numbers must not be known when a shader is compiled: it would fold their
 * values into what is computed of them, and round otherwise. */
FN void list_pixels(CTX u32 item, u32 key, surf s) {
    for (u1 i = 0u; i < PIXEL_ENTRIES; i++) {
        list_entry e;
        e.light = 37u * i + (ITEM_COUNT & 15u);
        e.weight = 1.0f + 0.5f * F32(i & 3u);
        entry_store(PASS i, e);
    }
    u32 bits = rng_bits(key, KU(5000u));
    put_real(PASS item, LISTS_FIRST, list_u(bits, shr(bits, 24)));
    put_real(PASS item, LISTS_FIRST + 1, list_v(bits, shr(bits, 24)));
    put_resv(PASS item, LISTS_FIRST + 2, ris_list(PASS s, key, PIXEL_ENTRIES));
    list_sketches(PASS PIXEL_ENTRIES);
    for (u1 i = 0u; i < PIXEL_NEAR; i++)
        dialect_near[i] = rng(key, KU(5040u + i)) < K(0.9f);
    list_sums sums = list_weigh(PASS s, key, PIXEL_NEAR);
    put_real(PASS item, LISTS_FIRST + 8, sums.all);
    put_real(PASS item, LISTS_FIRST + 9, sums.bright);
    EXACT real all = sums.all + column_at(PASS item & KU(3u), KU(16u));
    sums.all = all;
    real n = list_draws(sums, list_asks(4.0f, s.f0 > K(0.0f)), 0.75f, rng(key, KU(5002u)));
    put_real(PASS item, LISTS_FIRST + 10, n);
    /* weights that add up to less than was thought: the last draws lie past the end */
    put_u32(PASS item, LISTS_FIRST + 12,
            draw_rays(PASS item, LISTS_FIRST + 11, sums.all * K(1.5f), n, rng(key, KU(5003u))));
    put_u32(PASS item, LISTS_FIRST + 14, draw_rays(PASS item, LISTS_FIRST + 13, sums.all, n, rng(key, KU(5004u))));
    for (int k = 0; k < PIXEL_RAYS; k++) {
        mask blocked = rng(key, KU(5010u + U32(k))) < K(0.4f);
        dialect_found[k] = list_ask(PASS s, sums, n, key, dialect_drawn[k], drawn_light(PASS dialect_drawn[k]));
        dialect_found[k].w = sel(blocked, K(0.0f), dialect_found[k].w);
    }
    list_ray one = list_ask(PASS s, sums, n, key, dialect_drawn[1], drawn_light(PASS dialect_drawn[1]));
    put_u32(PASS item, LISTS_FIRST + 15, one.light);
    put_real(PASS item, LISTS_FIRST + 16, one.u);
    put_real(PASS item, LISTS_FIRST + 17, one.v);
    put_real(PASS item, LISTS_FIRST + 18, one.w);
    put_real(PASS item, LISTS_FIRST + 19, one.p);
    put_u32(PASS item, LISTS_FIRST + 20, list_shown(PASS U32(PIXEL_RAYS), n, rng(key, KU(5005u))));
    list_kept kept = list_resample(PASS U32(PIXEL_RAYS), rng(key, KU(5006u)));
    put_u32(PASS item, LISTS_FIRST + 21, kept.ray);
    put_real(PASS item, LISTS_FIRST + 22, kept.w);
    put_resv(PASS item, LISTS_FIRST + 113, list_stand_in(PASS key, U32(PIXEL_RAYS), n, rng(key, KU(5014u))));
    put_resv(PASS item, LISTS_FIRST + 119, list_resampled(PASS key, U32(PIXEL_RAYS), ris_list(PASS s, key, 3u)));
    put_real(PASS item, LISTS_FIRST + 23, list_reused(to_real(shr(bits, 22)), 32.0f));
    sketch_surf q = sketch_surf_of(s);
    list_sketch brief = sketch_of(light_load(PASS bits));
    real d2 = sketch_distance2(brief, s.p);
    put_real(PASS item, LISTS_FIRST + 78, q.reach);
    put_real(PASS item, LISTS_FIRST + 79, brief.radius);
    put_v3(PASS item, LISTS_FIRST + 80, brief.middle);
    put_v3(PASS item, LISTS_FIRST + 83, brief.normal);
    put_v3(PASS item, LISTS_FIRST + 86, brief.shine);
    put_u32(PASS item, LISTS_FIRST + 89, brief.shape);
    put_real(PASS item, LISTS_FIRST + 90, sketch_target(PASS s, q, brief, d2, rng(key, KU(5028u)), K(0.125f)));
    put_real(PASS item, LISTS_FIRST + 91, sketch_gloss(s, q, s.n, rng(key, KU(5009u)), rng(key, KU(5030u))));
    put_real(PASS item, LISTS_FIRST + 92, quick_inverse_root(d2));
    EXACT real squares = rng(key, KU(5007u)) * K(1e-6f);
    put_real(PASS item, LISTS_FIRST + 24, root_of_squares(squares, rng(key, KU(5008u))));
}

/* Slots 25 to 34. */
FN void brief_pixels(CTX u32 item, u32 key) {
    list_patch t;
    t.c = F3(1.0f, 2.0f, 3.0f);
    t.radius = 0.5f;
    t.axis = F3(0.0f, 0.6f, 0.8f);
    t.spread = 0.25f;
    t.share = 0.5f;
    t.reflectance = 0.125f;
    t.wo = F3(0.0f, 0.0f, 1.0f);
    t.gloss = 0.25f;
    t.alpha2 = 0.0625f;
    list_brief b;
    b.place = rng_bits(key, KU(5030u));
    b.shine = bits_of_real(rng(key, KU(5031u))) & KU(0xffff0000u);
    b.shine = b.shine | (rng_bits(key, KU(5032u)) & KU(0xffffu));
    brief_lights lights = brief_unpack(b, F3(-1.0f, 4.0f, 2.0f), 3.0f);
    put_real(PASS item, LISTS_FIRST + 25, tenth(b.place, 1));
    put_v3(PASS item, LISTS_FIRST + 26, lights.bound.c);
    put_v3(PASS item, LISTS_FIRST + 29, lights.bound.axis);
    put_real(PASS item, LISTS_FIRST + 32, lights.bound.spread);
    put_real(PASS item, LISTS_FIRST + 33, lights.intensity);
    put_real(PASS item, LISTS_FIRST + 34, patch_gloss(t, cone_between(patch_bound(t), lights.bound)));
}

CALL void lists_item(CTX u32 item, u32 key, surf s) {
    list_pixels(PASS item, key, s);
    brief_pixels(PASS item, key);
}

/* ---- tiles ---- */

FN void put_f3(CTX u1 item, int slot, f3 a) {
    put_f1(PASS item, slot, a.x);
    put_f1(PASS item, slot + 1, a.y);
    put_f1(PASS item, slot + 2, a.z);
}

/* Slots 35 to 51: the last patch; 93 to 100: joined with the first one. Returns how many there are. */
FN1 u1 tile_patches(CTX u1 item, f3 eye) {
    u1 patches = make_patches(PASS 3u, eye);
    list_patch t = patch_load(PASS patches - 1u);
    put_u1(PASS item, LISTS_FIRST + 35, patches);
    put_u1(PASS item, LISTS_FIRST + 36, pixels_in_front(PASS 0u, 0xffffu));
    put_f3(PASS item, LISTS_FIRST + 37, t.c);
    put_f1(PASS item, LISTS_FIRST + 40, t.radius);
    put_f3(PASS item, LISTS_FIRST + 41, t.axis);
    put_f1(PASS item, LISTS_FIRST + 44, t.spread);
    put_f1(PASS item, LISTS_FIRST + 45, t.share);
    put_f1(PASS item, LISTS_FIRST + 46, t.reflectance);
    put_f3(PASS item, LISTS_FIRST + 47, t.wo);
    put_f1(PASS item, LISTS_FIRST + 50, t.gloss);
    put_f1(PASS item, LISTS_FIRST + 51, t.alpha2);
    t = join_patches(patch_load(PASS 0u), t, eye);
    put_f3(PASS item, LISTS_FIRST + 93, t.c);
    put_f1(PASS item, LISTS_FIRST + 96, t.radius);
    put_f3(PASS item, LISTS_FIRST + 97, t.axis);
    put_f1(PASS item, LISTS_FIRST + 100, t.spread);
    return patches;
}

/* Slots 60 to 62, and 110 to 112: a line of the first groups, and one draw. */
FN1 void tile_line(CTX u1 item, u1 draws) {
    f1 total = groups_sum(PASS 7u);
    f1 scale = tail_scale(total);
    u1 all = lay_line(PASS 7u, scale);
    tail_line line = tail_line_of(all, draws + 1u, tile_bits(item, 336u));
    u1 group = tile_bits(item, 337u) % 7u;
    list_place p =
        tail_place(PASS group, scale,
                   high_u1(line_load(PASS group + 1u) - line_load(PASS group), tile_bits(item, 338u)), line.rest);
    put_f1(PASS item, LISTS_FIRST + 60, total);
    put_u1(PASS item, LISTS_FIRST + 61, all * 31u + line_load(PASS group));
    put_u1(PASS item, LISTS_FIRST + 62, line.step * 31u + line.first);
    put_u1(PASS item, LISTS_FIRST + 110, p.place);
    put_f1(PASS item, LISTS_FIRST + 111, p.at);
    put_f1(PASS item, LISTS_FIRST + 112, tail_weight(line, score_at(PASS group, p.place & 15u) + 0.5f, scale, 0.75f));
}

/* Slots 52 to 59: scores of all magnitudes in groups 0 to 6, many of them alike, and group 7 without any. */
FN1 void tile_groups(CTX u1 item) {
    for (u1 i = 0u; i < 128u; i++) {
        u1 bits = tile_bits(item, 200u + i);
        f1 x = f1_of_bits((bits & 0x01ffffffu) + 0x3f000000u);
        if ((bits & 0x0c000000u) == 0u)
            x = 1.5f;
        if ((bits & 0x30000000u) == 0u || i >= 112u)
            x = 0.0f;
        word_store(PASS i, bits_of_f1(x));
    }
    EXACT f1 t = 0.5f + tile_real(item, 330u) * 4.0f;
    u1 group = tile_bits(item, 331u) & 7u;
    f1 sum = score_sum(PASS group);
    put_f1(PASS item, LISTS_FIRST + 52, sum);
    put_u1(PASS item, LISTS_FIRST + 53, scores_over(PASS 1u, 7u, t));
    put_u1(PASS item, LISTS_FIRST + 54, places_over(PASS group, t));
    put_f1(PASS item, LISTS_FIRST + 55, score_step(300u + (tile_bits(item, 332u) & 255u)));
    score_cut c = cut_scores(PASS 0u, 8u, tile_bits(item, 333u) & 127u);
    put_u1(PASS item, LISTS_FIRST + 56, c.sure);
    put_u1(PASS item, LISTS_FIRST + 57, c.room);
    list_place p = place_at(PASS group, sum, tile_real(item, 334u) * 1.25f);
    put_u1(PASS item, LISTS_FIRST + 58, p.place);
    put_f1(PASS item, LISTS_FIRST + 59, p.at);
    tile_line(PASS item, tile_bits(item, 335u) & 31u);
}

/* Slots 63 to 68. */
FN1 void tile_scores(CTX u1 item, u1 patches) {
    u1 place = tile_bits(item, 340u) & 15u;
    score_nodes(PASS 0u, 0u, 3u, patches, 8u);
    put_f1(PASS item, LISTS_FIRST + 63, score_at(PASS 8u, place));
    put_f1(PASS item, LISTS_FIRST + 64, score_sum(PASS 8u));
    EXACT f1 score = 100.0f * tile_real(item, 341u);
    score_lights(PASS 0u, 5u, patches, score, 9u);
    put_f1(PASS item, LISTS_FIRST + 65, score_at(PASS 9u, place));
    put_f1(PASS item, LISTS_FIRST + 66, score_sum(PASS 9u));
    list_way w;
    w.group.part = 0u;
    w.group.level = 1u;
    w.group.block = 3u;
    w.p.place = place;
    w.p.at = tile_real(item, 342u);
    w.score = 1.0f;
    w.share = 0.5f;
    score_group(PASS group_below(w), patches, w.score, 10u);
    w = way_down(PASS w, 10u);
    put_u1(PASS item, LISTS_FIRST + 67, w.p.place);
    put_f1(PASS item, LISTS_FIRST + 68, w.share);
}

/* Slots 69 to 72. */
FN1 void tile_learned(CTX u1 item) {
    f1 asked = F32(tile_bits(item, 350u) & 63u);
    EXACT f1 seen = asked * tile_real(item, 351u);
    f1 visibility = learned_visibility(asked, seen, tile_real(item, 352u));
    EXACT f1 weight = 3.0f * tile_real(item, 353u);
    list_prior b = list_prior_of(weight, visibility);
    put_f1(PASS item, LISTS_FIRST + 69, learned_pull(tile_real(item, 354u)));
    put_f1(PASS item, LISTS_FIRST + 70, visibility);
    put_f1(PASS item, LISTS_FIRST + 71, b.share);
    put_f1(PASS item, LISTS_FIRST + 72, b.expect);
}

/* Slots 73 to 77: a whole list, in every eighth tile, for it takes long. */
FN1 void tile_list(CTX u1 item, f3 eye) {
    list_size size;
    size.count = 0u;
    size.copies = 0u;
    u1 all = 0u;
    f1 sum = 0.0f;
    f1 last = 0.0f;
    if ((item & 7u) == (shr(item, 3) & 7u)) {
        u1 listed = tile_bits(item, 360u) & 31u;
        u1 drawn = tile_bits(item, 361u) & 15u;
        size = list_build(PASS(item >> 6u) & 3u, eye, listed, drawn, tile_bits(item, 362u));
        size = list_fill(PASS size, FAKE_ROOM, 2u, 24u);
        for (u1 i = 0u; i < size.count; i++) {
            list_entry e = entry_load(PASS i);
            all = all * 31u + e.light;
            EXACT f1 more = sum + e.weight;
            sum = more;
            last = e.weight;
        }
    }
    put_u1(PASS item, LISTS_FIRST + 73, size.count);
    put_u1(PASS item, LISTS_FIRST + 74, size.copies);
    put_u1(PASS item, LISTS_FIRST + 75, all);
    put_f1(PASS item, LISTS_FIRST + 76, sum);
    put_f1(PASS item, LISTS_FIRST + 77, last);
}

CALL void lists_tile(CTX u1 item) {
    dialect_number = item;
    f3 eye = F3(0.0f, 0.0f, tile_real(item, 99u));
    u1 patches = tile_patches(PASS item, eye);
    tile_groups(PASS item);
    tile_scores(PASS item, patches);
    tile_learned(PASS item);
    tile_list(PASS item, eye);
    tile_faces(PASS item);
}

#endif
