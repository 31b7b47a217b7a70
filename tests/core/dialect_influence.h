/* Influence volumes in the dialect test: included by dialect_kernel.h. Slots count from INFLUENCE_FIRST. */
#ifndef DIALECT_INFLUENCE_H
#define DIALECT_INFLUENCE_H

/* ---- influence volumes ---- */

FN influence influence_load(CTX u32 volume) {
    influence v;
    u32 key = hash_u32(volume + KU(8u));
    v.c = any_v3(key, KU(0u));
    v.m = mul3(unit3(any_v3(key, KU(6u))), K(3.0f));
    v.size = rng(key, KU(12u));
    v.root = rng(key, KU(13u)) * K(60.0f);
    return v;
}
FN u32 influence_found(CTX u32 place) { return place * KU(7u); }
FN u32 influence_volume(CTX u32 id) { return shr(id, 1); }
FN mask influence_seen(CTX u32 volume, influence_region r) { return (volume & KU(3u)) != KU(0u); }

/* Slots 0 to 4: one is drawn from all lights, one from those that are listed. */
FN void influence_draws(CTX u32 item, u32 key, surf s) {
    influence_asked a;
    a.r = influence_point(s.p, s.n);
    a.least = rng(key, KU(3200u)) * K(0.01f);
    a.count = shr(rng_bits(key, KU(3201u)), 28);
    a.from = shr(rng_bits(key, KU(3202u)), 26);
    pick all = influence_candidate(PASS a, key, KU(KERNEL_LIGHTS), K(8.0f), true, 0, 32, 4);
    pick listed = influence_candidate(PASS a, key, KU(KERNEL_LIGHTS), K(8.0f), true, 1, 32, 4);
    put_u32(PASS item, INFLUENCE_FIRST + 0, all.light);
    put_real(PASS item, INFLUENCE_FIRST + 1, all.inverse);
    put_u32(PASS item, INFLUENCE_FIRST + 2, listed.light);
    put_real(PASS item, INFLUENCE_FIRST + 3, listed.inverse);
    mask held = influence_lists(PASS all.light, influence_load(PASS all.light), a, K(50.0f), false);
    put_u32(PASS item, INFLUENCE_FIRST + 4, selu(held, KU(1u), KU(0u)));
}

/* ---- of tiles ---- */

/* Words 0 and 1: how many volumes were added, a hash of them; from 16 on: bins. */
#define BIN_WORDS 16u

FN near_half near_half_load(CTX u1 k) {
    near_half h;
    h.levels = 2u - k;
    h.first = 150u * k;
    h.end = 150u + 50u * k;
    return h;
}
FN near_children near_children_load(CTX u1 k, u1 level, u1 node, u1 l) {
    near_children c;
    u32 key = hash_u32(lane_places(l) + KU(1000u * k + 500u * level + 16u * node));
    c.lo = any_v3(key, KU(0u));
    c.hi = add3(c.lo, mul3(V3(rng(key, KU(6u)), rng(key, KU(7u)), rng(key, KU(8u))), K(200.0f)));
    c.root = max_(rng(key, KU(9u)) * K(60.0f) - K(6.0f), K(0.0f));
    return c;
}
FN influence near_volumes_load(CTX u1 first, u1 end) {
    u32 i = lane_places(first);
    influence v = influence_load(PASS i);
    v.root = sel(i < KU(end), v.root, K(0.0f));
    return v;
}
FN void near_clear(CTX u1 list) {
    word_store(PASS 0u, 0u);
    word_store(PASS 1u, list);
}
FN u1 near_count(CTX u1 list) { return word_load(PASS 0u); }
FN b1 near_add(CTX u1 list, u1 volume) {
    word_store(PASS 0u, word_load(PASS 0u) + 1u);
    word_store(PASS 1u, word_load(PASS 1u) * 31u + volume);
    return true;
}
FN rule_bin rule_bin_load(CTX u1 i) {
    rule_bin b;
    b.lights = f1_of_bits(word_load(PASS BIN_WORDS + 4u * i));
    b.e = f1_of_bits(word_load(PASS BIN_WORDS + 4u * i + 1u));
    b.e2 = f1_of_bits(word_load(PASS BIN_WORDS + 4u * i + 2u));
    b.unused = 0.0f;
    return b;
}
FN void rule_bin_store(CTX u1 i, rule_bin b) {
    word_store(PASS BIN_WORDS + 4u * i, bits_of_f1(b.lights));
    word_store(PASS BIN_WORDS + 4u * i + 1u, bits_of_f1(b.e));
    word_store(PASS BIN_WORDS + 4u * i + 2u, bits_of_f1(b.e2));
}

FN1 u1 tile_bits(u1 item, u1 i) {
    u1 x = (item * 64u + i + 1u) * 0x9e3779b9u;
    x = x ^ shr(x, 15);
    x = x * 0x85ebca6bu;
    x = x ^ shr(x, 13);
    x = x * 0xc2b2ae35u;
    return x ^ shr(x, 16);
}
FN1 f1 tile_real(u1 item, u1 i) { return F32(shr(tile_bits(item, i), 8)) * 5.9604644775390625e-8f; }

/* Slots 5 to 7: a search; 8, 9: the rule. */
FN void dialect_volumes(CTX u1 item) {
    near_query q;
    q.lo =
        F3(tile_real(item, 0u) * 200.0f - 100.0f, tile_real(item, 1u) * 200.0f - 100.0f, tile_real(item, 2u) * 20.0f);
    q.hi = F3(q.lo.x + tile_real(item, 3u) * 10.0f, q.lo.y + tile_real(item, 4u) * 10.0f, q.lo.z + 0.5f);
    q.n = F3(0.6f, 0.0f, 0.8f);
    q.back = q.lo.x * 0.6f;
    q.scale = 1.0f + tile_real(item, 5u) * 3.0f;
    q.most = 3u;
    b1 all = influence_near(PASS 0u, q);
    u1 fits = 0u;
    if (all)
        fits = 1u;
    put_u1(PASS item, INFLUENCE_FIRST + 5, near_count(PASS 0u));
    put_u1(PASS item, INFLUENCE_FIRST + 6, word_load(PASS 1u));
    put_u1(PASS item, INFLUENCE_FIRST + 7, fits);
    influence_rule rule;
    for (u1 k = 0u; k < U32(RULE_SHARES); k++)
        rule.seen[k] = 0.1f + 0.2f * F32(k);
    rule.floor_ = 0.05f;
    rule_range range = rule_begin(PASS 1e-4f);
    for (u1 i = 0u; i < 30u; i++) {
        f1 x = tile_real(item, 6u + i);
        EXACT f1 e = x * x * x * x * 20.0f;
        rule_add(PASS range, 1.0f + F32(i & 3u), e);
    }
    put_u1(PASS item, INFLUENCE_FIRST + 8, bits_of_f1(rule_best(PASS range, rule, F32(KERNEL_LIGHTS), 4.0f)));
    put_u1(PASS item, INFLUENCE_FIRST + 9, bits_of_f1(rule_limit(PASS range, 20.0f)));
}

#endif
