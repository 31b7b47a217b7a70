/* Sketches of a list's lights and the faces of a block in the dialect test: included by dialect_lists.h. */
#ifndef DIALECT_FACES_H
#define DIALECT_FACES_H

FN u1 entry_in(u1 at, u1 rows) { return (at & 15u) * rows + shr(at, 4); }
FN list_prior prior_load(CTX u1 at) {
    u1 i = entry_in(at, list_rows(PIXEL_ENTRIES));
    list_prior b = list_prior_of(entry_load(PASS i & 31u).weight, learned_visibility(F32(i & 7u), F32(i & 3u), 0.375f));
    if (i >= PIXEL_ENTRIES) {
        b.share = 0.0f;
        b.expect = 0.0f;
    }
    return b;
}
FN list_priors prior_row(CTX u1 row, int l) {
    u32 i = lane_places(U32(l)) * KU(list_rows(PIXEL_ENTRIES)) + KU(row);
    list_priors b;
    mask some = i < KU(PIXEL_ENTRIES);
    b.share = sel(some, K(0.25f) + rng(i, KU(3u)), K(0.0f));
    b.expect = sel(some, rng(i, KU(4u)), K(0.0f));
    return b;
}
FN u32 entry_light(CTX u32 i) { return i * KU(37u) + KU(ITEM_COUNT & 15u); }
FN u32 entry_lights(CTX u1 row, int l, u1 rows, u1 count) {
    return entry_light(PASS lane_places(U32(l)) * KU(rows) + KU(row));
}
FN u1 sketch_word(CTX u1 at, u1 field) { return FAKE_SKETCHES + 32u * field + at; }
FN void sketch_store(CTX u1 row, int l, list_sketch k) {
    u1 at = 16u * row + U32(l);
    words_store(PASS sketch_word(PASS at, 0u), bits_of_real(k.middle.x));
    words_store(PASS sketch_word(PASS at, 1u), bits_of_real(k.middle.y));
    words_store(PASS sketch_word(PASS at, 2u), bits_of_real(k.middle.z));
    words_store(PASS sketch_word(PASS at, 3u), bits_of_real(k.radius));
    words_store(PASS sketch_word(PASS at, 4u), bits_of_real(k.normal.x));
    words_store(PASS sketch_word(PASS at, 5u), bits_of_real(k.normal.y));
    words_store(PASS sketch_word(PASS at, 6u), bits_of_real(k.normal.z));
    words_store(PASS sketch_word(PASS at, 7u), bits_of_real(k.size));
    words_store(PASS sketch_word(PASS at, 8u), bits_of_real(k.shine.x));
    words_store(PASS sketch_word(PASS at, 9u), bits_of_real(k.shine.y));
    words_store(PASS sketch_word(PASS at, 10u), bits_of_real(k.shine.z));
    words_store(PASS sketch_word(PASS at, 11u), k.shape);
    words_store(PASS sketch_word(PASS at, 12u), bits_of_real(k.beside.x));
    words_store(PASS sketch_word(PASS at, 13u), bits_of_real(k.beside.y));
    words_store(PASS sketch_word(PASS at, 14u), bits_of_real(k.beside.z));
    words_store(PASS sketch_word(PASS at, 15u), bits_of_real(k.level));
}
FN real sketch_field(CTX u1 row, int l, u1 field) {
    return real_of_bits(words_load(PASS sketch_word(PASS 16u * row + U32(l), field)));
}
FN list_sketch sketch_row(CTX u1 row, int l) {
    list_sketch k;
    k.middle = V3(sketch_field(PASS row, l, 0u), sketch_field(PASS row, l, 1u), sketch_field(PASS row, l, 2u));
    k.radius = sketch_field(PASS row, l, 3u);
    k.normal = V3(sketch_field(PASS row, l, 4u), sketch_field(PASS row, l, 5u), sketch_field(PASS row, l, 6u));
    k.size = sketch_field(PASS row, l, 7u);
    k.shine = V3(sketch_field(PASS row, l, 8u), sketch_field(PASS row, l, 9u), sketch_field(PASS row, l, 10u));
    k.shape = words_load(PASS sketch_word(PASS 16u * row + U32(l), 11u));
    k.beside = V3(sketch_field(PASS row, l, 12u), sketch_field(PASS row, l, 13u), sketch_field(PASS row, l, 14u));
    k.level = sketch_field(PASS row, l, 15u);
    return k;
}
FN list_sketch sketch_load(CTX u1 at) {
    list_sketch k;
    k.middle = spread3(word3_load(PASS sketch_word(PASS at, 0u), 32u));
    k.radius = K(f1_of_bits(word_load(PASS sketch_word(PASS at, 3u))));
    k.normal = spread3(word3_load(PASS sketch_word(PASS at, 4u), 32u));
    k.size = K(f1_of_bits(word_load(PASS sketch_word(PASS at, 7u))));
    k.shine = spread3(word3_load(PASS sketch_word(PASS at, 8u), 32u));
    k.shape = KU(word_load(PASS sketch_word(PASS at, 11u)));
    k.beside = spread3(word3_load(PASS sketch_word(PASS at, 12u), 32u));
    k.level = K(f1_of_bits(word_load(PASS sketch_word(PASS at, 15u))));
    return k;
}

/* ---- faces of a tile ---- */

FN face_pixel face_pixel_load(CTX u1 at) {
    face_pixel q;
    q.p = word3_load(PASS FAKE_SEEN + at, 16u);
    q.n = word3_load(PASS FAKE_SEEN + 48u + at, 16u);
    q.wo = word3_load(PASS FAKE_SEEN + 96u + at, 16u);
    q.albedo = word3_load(PASS FAKE_SEEN + 144u + at, 16u);
    q.f0 = f1_of_bits(word_load(PASS FAKE_SEEN + 192u + at));
    q.alpha = f1_of_bits(word_load(PASS FAKE_SEEN + 208u + at));
    q.depth = f1_of_bits(word_load(PASS FAKE_SEEN + 224u + at));
    return q;
}
FN real seen_field(CTX u1 field, int l) { return real_of_bits(words_load(PASS FAKE_SEEN + 16u * field + U32(l))); }
FN v3 seen_three(CTX u1 field, int l) {
    return V3(seen_field(PASS field, l), seen_field(PASS field + 1u, l), seen_field(PASS field + 2u, l));
}
FN face_pixels face_pixels_load(CTX int l) {
    face_pixels q;
    q.s.p = seen_three(PASS 0u, l);
    q.s.n = seen_three(PASS 3u, l);
    q.s.wo = seen_three(PASS 6u, l);
    q.s.albedo = seen_three(PASS 9u, l);
    q.s.f0 = seen_field(PASS 12u, l);
    q.s.alpha = seen_field(PASS 13u, l);
    q.depth = seen_field(PASS 14u, l);
    return q;
}
FN mask face_lanes(CTX u1 pixels, int l) { return (KU(pixels) & KU(1u) << lane_places(U32(l))) != KU(0u); }
FN u1 far_word(u1 face, u1 row) { return FAKE_FAR + 64u * face + 16u * minu1(row, 3u); }
FN void far_store(CTX u1 face, u1 row, int l, real sum) {
    words_store(PASS far_word(face, row) + U32(l), bits_of_real(sum));
}
FN f1 far_sum(CTX u1 face, u1 row, u1 column) { return f1_of_bits(word_load(PASS far_word(face, row) + column)); }
FN void column_store(CTX u1 face, u1 column, f1 sum) {
    word_store(PASS FAKE_COLUMNS + 17u * face + column, bits_of_f1(sum));
}
FN void near_bits_store(CTX u1 face, u1 row, int l, mask near) {
    u1 at = FAKE_BITS + 4u * face + row;
    u1 bits = 0u;
    if (l > 0)
        bits = word_load(PASS at);
    word_store(PASS at, bits | lane_bits(near) << U32(l));
}
FN u1 near_bits_load(CTX u1 face, u1 row) { return word_load(PASS FAKE_BITS + 4u * face + row); }
FN void face_store(CTX u1 number, list_face f, face_sums sums) {
    word_store(PASS FAKE_BITS + 4u * number + 3u, f.pixels);
}
FN u1 pixels_of_face(CTX u1 number) { return word_load(PASS FAKE_BITS + 4u * number + 3u); }
FN void near_entry_store(CTX u1 i, u1 entry, u1 at, u1 pixels) {
    word_store(PASS FAKE_NEAR + 3u * i, entry);
    word_store(PASS FAKE_NEAR + 3u * i + 1u, at);
    word_store(PASS FAKE_NEAR + 3u * i + 2u, pixels);
}

/* Slots 101 to 109: the first face of a block, and what is near for some of its faces. */
FN1 void tile_faces(CTX u1 item) {
    for (u1 i = 0u; i < 16u; i++) {
        list_point q = tile_point(PASS 0u, i);
        list_material m = list_material_load(PASS q.material & tile_bits(item, 380u));
        f3 wo = unit1(F3(0.0f - q.p.x, 0.0f - q.p.y, 5.0f - q.p.z));
        EXACT f1 tilt = q.n.x + 0.01f * tile_real(item, 390u + i);
        f3 n = unit1(F3(tilt, q.n.y, q.n.z));
        f1 field[15];
        field[0] = q.p.x;
        field[1] = q.p.y;
        field[2] = q.p.z;
        field[3] = n.x;
        field[4] = n.y;
        field[5] = n.z;
        field[6] = wo.x;
        field[7] = wo.y;
        field[8] = wo.z;
        field[9] = m.albedo.x;
        field[10] = m.albedo.y;
        field[11] = m.albedo.z;
        field[12] = m.f0;
        field[13] = m.alpha;
        field[14] = q.depth;
        for (u1 k = 0u; k < 15u; k++)
            word_store(PASS FAKE_SEEN + 16u * k + i, bits_of_f1(field[k]));
    }
    for (u1 row = 0u; row < list_rows(PIXEL_ENTRIES); row++)
        EACH16(l) {
            list_sketch k = sketch_of(any_light(hash_u32(lane_places(16u * row + U32(l)) + KU(item))));
            k.middle = mul3(k.middle, K(9.0f));
            sketch_store(PASS row, l, k);
        }
    u1 pixels = tile_bits(item, 381u) | 1u;
    list_face f = face_of(PASS pixels & 0xffffu);
    face_sums sums = weigh_face(PASS 0u, f, list_rows(PIXEL_ENTRIES));
    put_u1(PASS item, LISTS_FIRST + 101, f.pixels);
    put_f1(PASS item, LISTS_FIRST + 102, f.around);
    put_f1(PASS item, LISTS_FIRST + 103, f.spread);
    put_f1(PASS item, LISTS_FIRST + 104, sums.all);
    put_f1(PASS item, LISTS_FIRST + 105, sums.bright);
    put_f1(PASS item, LISTS_FIRST + 106, f1_of_bits(word_load(PASS FAKE_COLUMNS + (tile_bits(item, 382u) & 15u))));
    face_store(PASS 0u, f, sums);
    face_store(PASS 1u, f, sums);
    for (u1 row = 0u; row < list_rows(PIXEL_ENTRIES); row++)
        word_store(PASS FAKE_BITS + 4u + row, tile_bits(item, 383u + row) & 0x5555u);
    u1 near = near_entries(PASS 2u, list_rows(PIXEL_ENTRIES));
    u1 all = 0u;
    for (u1 i = 0u; i < 3u * near; i++)
        all = all * 31u + word_load(PASS FAKE_NEAR + i);
    put_u1(PASS item, LISTS_FIRST + 107, near);
    put_u1(PASS item, LISTS_FIRST + 108, all);
    put_u1(PASS item, LISTS_FIRST + 109, weigh_faces(PASS f.pixels, list_rows(PIXEL_ENTRIES)));
}

#endif
