/* The visibility cache in the dialect test: included by dialect_kernel.h. Slots count from LEARNED_FIRST. */
#ifndef DIALECT_LEARNED_H
#define DIALECT_LEARNED_H

/* Two runs of cells, in words of memory from 0 on; one key falls into each, and those that crowd them. */
#define DIALECT_CELLS 16u

FN u1 cell_load(CTX u1 cell, u1 word) { return word_load(PASS cell * CELL_WORDS + word); }
FN void cell_store(CTX u1 cell, u1 word, u1 x) { word_store(PASS cell * CELL_WORDS + word, x); }

/* Key of one of many places, seen from 1 to 1000 m. */
FN1 cell_key dialect_cell(CTX u1 item, u1 i) {
    f3 p = F3(tile_real(item, 3u * i) * 2000.0f - 1000.0f, tile_real(item, 3u * i + 1u) * 2000.0f - 1000.0f,
              tile_real(item, 3u * i + 2u) * 100.0f - 20.0f);
    f3 n = F3(tile_real(item, i + 500u) - 0.5f, tile_real(item, i + 600u) - 0.5f, tile_real(item, i + 700u) - 0.5f);
    return cell_key_of(p, n, cell_level(cell_side(FRAME.camera, 1.0f + 999.0f * tile_real(item, i + 800u))));
}

/* Slots 0 to 4: keys; 5 to 11: the table after observations from more cells, of more lights, than it has room for. */
CALL void dialect_cells(CTX u1 item) {
    cell_key k = dialect_cell(PASS item, 0u);
    u1 hash = 0u;
    u1 known = 0u;
    for (u1 i = 0u; i < DIALECT_CELLS * CELL_WORDS; i++)
        word_store(PASS i, 0u);
    for (u1 i = 0u; i < 60u; i++) {
        u1 cell = cell_claim(PASS dialect_cell(PASS item, tile_bits(item, 900u + i) % 24u), DIALECT_CELLS, i / 2u);
        for (u1 l = 0u; l < 12u; l++) {
            u1 asked = 1u + (tile_bits(item, 1000u + 12u * i + l) & 0x3ffu);
            cell_count(PASS cell, 5u * l + (i & 3u), asked, shr(asked, i & 3u));
        }
    }
    for (u1 i = 0u; i < DIALECT_CELLS * CELL_WORDS; i++)
        hash = hash_u1(hash + word_load(PASS i));
    for (u1 i = 0u; i < 24u; i++)
        if (cell_find(PASS dialect_cell(PASS item, i), DIALECT_CELLS) != NO_CELL)
            known++;
    /* one that is there, and counts that are about to be halved */
    u1 cell = cell_claim(PASS k, DIALECT_CELLS, 100u);
    cell_store(PASS cell, CELL_ASKED, MOST_ASKED_ALL + tile_bits(item, 2000u) % 3u);
    cell_store(PASS cell, CELL_SEEN, shr(tile_bits(item, 2001u), 13));
    cell_count(PASS cell, 7u, 1025u, shr(tile_bits(item, 2002u), 22));
    cell_count(PASS cell, 7u, 9u, 3u);
    put_u1(PASS item, LEARNED_FIRST, k.place);
    put_u1(PASS item, LEARNED_FIRST + 1, k.check);
    put_u1(PASS item, LEARNED_FIRST + 2, cell_lane(shr(tile_bits(item, 2003u), 16) | 0x8000u));
    put_u1(PASS item, LEARNED_FIRST + 3, cell_turn(F3(tile_real(item, 1u) - 0.5f, tile_real(item, 2u) - 0.5f, 0.2f)));
    put_u1(PASS item, LEARNED_FIRST + 4, cell_run(k, DIALECT_CELLS));
    put_u1(PASS item, LEARNED_FIRST + 5, hash);
    put_u1(PASS item, LEARNED_FIRST + 6, known);
    put_u1(PASS item, LEARNED_FIRST + 7, cell_find(PASS k, DIALECT_CELLS));
    put_u1(PASS item, LEARNED_FIRST + 8, cell_load(PASS cell, CELL_ASKED));
    put_u1(PASS item, LEARNED_FIRST + 9, cell_load(PASS cell, CELL_COUNTS + cell_light(PASS cell, 7u)));
    put_u1(PASS item, LEARNED_FIRST + 10, bits_of_f1(cell_visibility(PASS cell, 7u)));
    put_u1(PASS item, LEARNED_FIRST + 11, bits_of_f1(cell_visibility(PASS cell, 8u)));
}

#endif
