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

/* Slots 0 to 4: one that is drawn from a list, and what goes for all of a set. */
CALL void influence_draws(CTX u32 item, u32 key, surf s) {
    influence_asked a;
    a.r = influence_point(s.p, s.n);
    a.least = rng(key, KU(3200u)) * K(0.01f);
    a.count = shr(rng_bits(key, KU(3201u)), 28);
    a.from = shr(rng_bits(key, KU(3202u)), 26);
    u1 row = ITEM_COUNT & 31u;
    u32 at = presample_at(row + 7u, row, shr(key, 28));
    u32 all = scale_u32(presample_bits(row, at, presample_share(512u)), KU(KERNEL_LIGHTS));
    influence volume = influence_load(PASS all);
    mask held = influence_lists(PASS all, volume, influence_turn(volume), a, K(8.0f), true);
    put_u32(PASS item, INFLUENCE_FIRST + 0, influence_from_list(PASS a, rng_bits(key, KU(3203u)), KU(KERNEL_LIGHTS)));
    put_real(PASS item, INFLUENCE_FIRST + 1, influence_inverse(held, a, KU(KERNEL_LIGHTS), 32, 4));
    put_u32(PASS item, INFLUENCE_FIRST + 2, at + KU(influence_listed(row + 1u, 4u) * 64u + influence_sets(row)));
    put_real(PASS item, INFLUENCE_FIRST + 3, influence_inverse(a.count > KU(0u), a, KU(KERNEL_LIGHTS), 32, 4));
    held = influence_lists(PASS all, volume, K(0.0f), a, K(50.0f), false);
    put_u32(PASS item, INFLUENCE_FIRST + 4, selu(held, KU(1u), KU(0u)));
}

/* ---- of tiles ---- */

/* Words 0 and 1: how many volumes were added, a hash of them; from 16 on: bins. What a tile finds: from 2 on the
 * lengths of two lists, points that have not asked, a hash of which group they are in, how many lights were found, a
 * hash of them; from 256 on groups, from 1088 on two lists, then influence_turn of each, what they give, boxes of 16
 * packs of each, packs looked at, and what is on its way. */
#define LENGTH_WORDS 2u
#define PENDING_WORDS 4u
#define GROUP_OF_WORD 8u
#define LIGHTS_WORD 9u
#define LIGHTS_HASH_WORD 10u
#define BIN_WORDS 16u
#define GROUP_WORDS 256u
#define LIST_WORDS 1088u
#define TURN_WORDS 1600u
#define GIVES_WORDS 2112u
#define DIALECT_VOLUMES 256u
#define PACK_WORDS 2624u
#define LOOKED_WORDS 2848u
#define TURNED_WORDS 2864u

FN1 u1 tile_bits(u1 item, u1 i) {
    u1 x = (item * 64u + i + 1u) * 0x9e3779b9u;
    x = x ^ shr(x, 15);
    x = x * 0x85ebca6bu;
    x = x ^ shr(x, 13);
    x = x * 0xc2b2ae35u;
    return x ^ shr(x, 16);
}
FN1 f1 tile_real(u1 item, u1 i) { return F32(shr(tile_bits(item, i), 8)) * 5.9604644775390625e-8f; }

/* The same in lanes. */
FN u32 tile_bits_of(u1 item, u32 i) {
    u32 x = (KU(item * 64u + 1u) + i) * KU(0x9e3779b9u);
    x = x ^ shr(x, 15);
    x = x * KU(0x85ebca6bu);
    x = x ^ shr(x, 13);
    x = x * KU(0xc2b2ae35u);
    return x ^ shr(x, 16);
}
FN real tile_reals(u1 item, u32 i) { return to_real(shr(tile_bits_of(item, i), 8)) * K(5.9604644775390625e-8f); }

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
FN void near_ask_ahead(CTX u1 first) {}
FN void near_clear(CTX u1 list) {
    word_store(PASS LENGTH_WORDS + list, 0u);
    word_store(PASS 1u, list);
}
FN u1 near_count(CTX u1 list) { return word_load(PASS LENGTH_WORDS + list); }
FN b1 near_add(CTX u1 list, u1 first, u1 bits, influence v, real turn) {
    u1 length = near_count(PASS list);
    words_store(PASS TURNED_WORDS, bits_of_real(turn));
    for (; bits != 0u && length < DIALECT_VOLUMES; bits = bits & (bits - 1u)) {
        word_store(PASS LIST_WORDS + DIALECT_VOLUMES * list + length, first + low_bit(bits));
        word_store(PASS TURN_WORDS + DIALECT_VOLUMES * list + length, word_load(PASS TURNED_WORDS + low_bit(bits)));
        word_store(PASS 1u, word_load(PASS 1u) * 31u + first + low_bit(bits));
        length++;
    }
    word_store(PASS LENGTH_WORDS + list, length);
    return bits == 0u;
}
FN b1 near_lost(CTX u1 list) { return false; }
FN u1 pack_word(u1 list, u1 field, u1 pack) { return PACK_WORDS + 112u * list + 16u * field + pack; }
FN void near_pack_store(CTX u1 list, u1 pack, f3 lo, f3 hi, f1 root) {
    if (pack == 0u)
        for (u1 i = 0u; i < 16u; i++)
            word_store(PASS pack_word(list, 6u, i), 0u);
    word_store(PASS pack_word(list, 0u, pack), bits_of_f1(lo.x));
    word_store(PASS pack_word(list, 1u, pack), bits_of_f1(lo.y));
    word_store(PASS pack_word(list, 2u, pack), bits_of_f1(lo.z));
    word_store(PASS pack_word(list, 3u, pack), bits_of_f1(hi.x));
    word_store(PASS pack_word(list, 4u, pack), bits_of_f1(hi.y));
    word_store(PASS pack_word(list, 5u, pack), bits_of_f1(hi.z));
    word_store(PASS pack_word(list, 6u, pack), bits_of_f1(root));
}
FN real pack_number(CTX u1 list, u1 field, u1 first) {
    return real_of_bits(words_load(PASS pack_word(list, field, first)));
}
FN near_children near_packs_load(CTX u1 list, u1 first) {
    near_children c;
    c.lo = V3(pack_number(PASS list, 0u, first), pack_number(PASS list, 1u, first), pack_number(PASS list, 2u, first));
    c.hi = V3(pack_number(PASS list, 3u, first), pack_number(PASS list, 4u, first), pack_number(PASS list, 5u, first));
    c.root = pack_number(PASS list, 6u, first);
    return c;
}
FN u1 near_id(CTX u1 list, u1 place) { return word_load(PASS LIST_WORDS + DIALECT_VOLUMES * list + place); }
FN f1 near_lights(CTX u1 list, u1 place) { return 1.0f + F32(near_id(PASS list, place) & 1u); }
FN u32 near_ids(CTX u1 list, u1 first) { return words_load(PASS LIST_WORDS + DIALECT_VOLUMES * list + first); }
FN influence near_load(CTX u1 list, u1 first) {
    influence v = influence_load(PASS near_ids(PASS list, first));
    v.root = sel(lane_places(first) < KU(near_count(PASS list)), v.root, K(0.0f));
    return v;
}
FN real near_turn(CTX u1 list, u1 first) {
    return real_of_bits(words_load(PASS TURN_WORDS + DIALECT_VOLUMES * list + first));
}
FN b1 gives_room(CTX u1 list) { return true; }
FN void looked_store(CTX u1 i, u1 pack) { word_store(PASS LOOKED_WORDS + i, pack); }
FN u1 looked_load(CTX u1 i) { return word_load(PASS LOOKED_WORDS + i); }
FN void gives_store(CTX u1 first, real gives) { words_store(PASS GIVES_WORDS + first, bits_of_real(gives)); }
FN real gives_load(CTX u1 first) { return real_of_bits(words_load(PASS GIVES_WORDS + first)); }
FN f1 gives_at(CTX u1 place) { return f1_of_bits(word_load(PASS GIVES_WORDS + place)); }
FN u1 found_next(CTX u1 group) { return word_load(PASS LIGHTS_WORD); }
FN b1 found_add(CTX u1 list, u1 first, u1 bits) {
    for (; bits != 0u; bits = bits & (bits - 1u)) {
        u1 volume = near_id(PASS list, first + low_bit(bits));
        word_store(PASS LIGHTS_WORD, word_load(PASS LIGHTS_WORD) + 1u);
        word_store(PASS LIGHTS_HASH_WORD, word_load(PASS LIGHTS_HASH_WORD) * 31u + volume);
    }
    return true;
}

/* Three blocks of points on two planes, some of which stand close together. */
#define DIALECT_BLOCKS 3u
FN u1 points_pending(CTX u1 block) { return word_load(PASS PENDING_WORDS + block); }
FN void points_ask(CTX u1 block, u1 bits, u1 group) {
    word_store(PASS PENDING_WORDS + block, points_pending(PASS block) & ~bits);
    word_store(PASS GROUP_OF_WORD, hash_u1(word_load(PASS GROUP_OF_WORD) + (bits | shl(group, 16)) + block));
}
FN f3 point_place(CTX u1 block, u1 lane) {
    u1 i = 16u * block + lane;
    return F3(tile_real(dialect_item_of, 3u * i) * 6.0f, tile_real(dialect_item_of, 3u * i + 1u) * 6.0f,
              10.0f * F32(block & 1u) + tile_real(dialect_item_of, 3u * i + 2u));
}
FN f3 point_normal(CTX u1 block, u1 lane) {
    f3 n = F3(0.6f, 0.0f, 0.8f);
    if ((tile_bits(dialect_item_of, 400u + 16u * block + lane) & 3u) == 0u)
        n = F3(0.0f, 0.0f, 1.0f);
    return n;
}
FN v3 point_places(CTX u1 block, u1 l) {
    u32 i = (KU(16u * block) + lane_places(l)) * KU(3u);
    return V3(tile_reals(dialect_item_of, i) * K(6.0f), tile_reals(dialect_item_of, i + KU(1u)) * K(6.0f),
              K(10.0f * F32(block & 1u)) + tile_reals(dialect_item_of, i + KU(2u)));
}
FN v3 point_normals(CTX u1 block, u1 l) {
    mask up = (tile_bits_of(dialect_item_of, KU(400u + 16u * block) + lane_places(l)) & KU(3u)) == KU(0u);
    return sel3(up, V3(K(0.0f), K(0.0f), K(1.0f)), V3(K(0.6f), K(0.0f), K(0.8f)));
}
FN near_query group_load(CTX u1 group) {
    u1 at = GROUP_WORDS + 16u * group;
    near_query q;
    q.lo = F3(f1_of_bits(word_load(PASS at)), f1_of_bits(word_load(PASS at + 1u)), f1_of_bits(word_load(PASS at + 2u)));
    q.hi = F3(f1_of_bits(word_load(PASS at + 3u)), f1_of_bits(word_load(PASS at + 4u)),
              f1_of_bits(word_load(PASS at + 5u)));
    q.n = F3(f1_of_bits(word_load(PASS at + 6u)), f1_of_bits(word_load(PASS at + 7u)),
             f1_of_bits(word_load(PASS at + 8u)));
    q.back = f1_of_bits(word_load(PASS at + 9u));
    q.scale = f1_of_bits(word_load(PASS at + 10u));
    q.least = f1_of_bits(word_load(PASS at + 11u));
    q.most = word_load(PASS at + 12u);
    return q;
}
FN void group_store(CTX u1 group, near_query q, u1 from, u1 count) {
    u1 at = GROUP_WORDS + 16u * group;
    word_store(PASS at, bits_of_f1(q.lo.x));
    word_store(PASS at + 1u, bits_of_f1(q.lo.y));
    word_store(PASS at + 2u, bits_of_f1(q.lo.z));
    word_store(PASS at + 3u, bits_of_f1(q.hi.x));
    word_store(PASS at + 4u, bits_of_f1(q.hi.y));
    word_store(PASS at + 5u, bits_of_f1(q.hi.z));
    word_store(PASS at + 6u, bits_of_f1(q.n.x));
    word_store(PASS at + 7u, bits_of_f1(q.n.y));
    word_store(PASS at + 8u, bits_of_f1(q.n.z));
    word_store(PASS at + 9u, bits_of_f1(q.back));
    word_store(PASS at + 10u, bits_of_f1(q.scale));
    word_store(PASS at + 11u, bits_of_f1(q.least));
    word_store(PASS at + 12u, q.most);
    word_store(PASS at + 13u, from);
    word_store(PASS at + 14u, count);
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

/* Slots 10 to 16: what a tile finds, with an S_r that was set (every other item) or found. */
FN void dialect_finds(CTX u1 item, influence_rule rule) {
    f1 given_scale = 0.0f;
    u1 hash = 0u;
    u1 listed = 0u;
    dialect_item_of = item;
    for (u1 b = 0u; b < DIALECT_BLOCKS; b++)
        word_store(PASS PENDING_WORDS + b, tile_bits(item, 700u + b) & 0xffffu);
    for (u1 i = GROUP_OF_WORD; i <= LIGHTS_HASH_WORD; i++)
        word_store(PASS i, 0u);
    if ((item & 1u) == 0u)
        given_scale = 20.0f + 100.0f * tile_real(item, 800u);
    u1 groups = influence_find(PASS DIALECT_BLOCKS, near_asks(given_scale, 30.0f + 100.0f * tile_real(item, 801u)),
                               0.3f, rule, F32(KERNEL_LIGHTS), 4.0f);
    for (u1 g = 0u; g < groups; g++) {
        for (u1 i = 0u; i < 15u; i++)
            hash = hash_u1(hash + word_load(PASS GROUP_WORDS + 16u * g + i));
        listed = listed + word_load(PASS GROUP_WORDS + 16u * g + 14u);
    }
    put_u1(PASS item, INFLUENCE_FIRST + 10, groups);
    put_u1(PASS item, INFLUENCE_FIRST + 11, word_load(PASS GROUP_OF_WORD));
    put_u1(PASS item, INFLUENCE_FIRST + 12, hash);
    put_u1(PASS item, INFLUENCE_FIRST + 13, listed);
    put_u1(PASS item, INFLUENCE_FIRST + 14, word_load(PASS LIGHTS_HASH_WORD));
    put_u1(PASS item, INFLUENCE_FIRST + 15, near_count(PASS 0u));
    put_u1(PASS item, INFLUENCE_FIRST + 16, word_load(PASS GROUP_WORDS + 16u + 11u));
}

/* Slots 5 to 7: a search; 8, 9: the rule. */
CALL void dialect_volumes(CTX u1 item) {
    near_query q;
    q.lo =
        F3(tile_real(item, 0u) * 200.0f - 100.0f, tile_real(item, 1u) * 200.0f - 100.0f, tile_real(item, 2u) * 20.0f);
    q.hi = F3(q.lo.x + tile_real(item, 3u) * 10.0f, q.lo.y + tile_real(item, 4u) * 10.0f, q.lo.z + 0.5f);
    q.n = F3(0.6f, 0.0f, 0.8f);
    q.back = q.lo.x * 0.6f;
    q.scale = 1.0f + tile_real(item, 5u) * 3.0f;
    q.least = 0.0f;
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
    dialect_finds(PASS item, rule);
}

#endif
