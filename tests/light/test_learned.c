/* Learned visibility: cells, counts, the same table for any number of threads, and more room. */
#include "../test.h"

#include "light/learned.h"

#include <math.h>

static const f3 up = { 0, 0, 1 }, down = { 0, 0, -1 }, east = { 1, 0, 0 };

/* Key of a cell with sides of 2^level m. */
static cell_key key_at(float x, float y, float z, f3 n, int level) {
    return cell_key_of((f3){ x, y, z }, n, cell_level(ldexpf(1, level)));
}

static void keys(void **state) {
    (void)state;
    cell_key key = key_at(0.1f, 0.2f, 0, up, 1);
    assert_true(cell_same(key, key_at(0.2f, 0.3f, 0, up, 1)));
    assert_false(cell_same(key, key_at(9, 0.2f, 0, up, 1)));
    assert_false(cell_same(key, key_at(0.1f, 0.2f, 0, down, 1)));
    assert_false(cell_same(key, key_at(0.1f, 0.2f, 0, east, 1)));
    assert_false(cell_same(key, key_at(0.1f, 0.2f, 0, up, 2)));
    /* Borders lie at 0.63 of a side. */
    assert_true(cell_same(key_at(1.25f, 0, 0, up, 1), key_at(-0.7f, 0, 0, up, 1)));
    assert_false(cell_same(key_at(1.27f, 0, 0, up, 1), key_at(-0.7f, 0, 0, up, 1)));
    /* A floor at a round height lies in one layer of cells, whatever rounding does to it. */
    for (int level = -3; level < 8; level++)
        assert_true(cell_same(key_at(0.1f, 0.2f, -1e-5f, up, level), key_at(0.1f, 0.2f, 1e-5f, up, level)));
    /* Far out and in odd places too there is a key, and sides stay within bounds. */
    assert_true(key_at(1e7f, -1e7f, 3e7f, east, -40).check != 0);
    assert_int_equal(cell_level(0), cell_level(1e-6f));
    assert_int_equal(cell_level(INFINITY), cell_level(1e9f));
    /* The side is the nearest power of two. */
    assert_int_equal(cell_level(1.4f), cell_level(1));
    assert_int_equal(cell_level(1.42f), cell_level(2));
}

/* Both words tell cells apart: neither is the same for many of them. */
static void keys_spread(void **state) {
    (void)state;
    enum { SIDE = 64, KEYS = SIDE * SIDE };
    size_t same = 0, runs[128] = { 0 };
    cell_key *key = noc_calloc(KEYS, sizeof(*key));
    for (int i = 0; i < KEYS; i++) {
        key[i] = key_at((float)(i % SIDE), (float)(i / SIDE), 0, up, 0);
        runs[key[i].place % 128]++;
        for (int k = 0; k < i; k++)
            same += (key[k].place == key[i].place) + (key[k].check == key[i].check);
    }
    assert_true(same < 16); /* of 8 M pairs of words 0.004 are expected */
    for (int i = 0; i < 128; i++)
        assert_in_range(runs[i], 10, 70); /* 32 are expected */
    free(key);
}

static void add(noc_learned *t, noc_pool *pool, cell_key key, const noc_observation *data, uint32_t count) {
    noc_cell_observations cell = { .cell = key, .count = count, .data = data };
    noc_learned_add(t, pool, &(noc_observations){ &cell, 1 }, 1);
}

static void counts(void **state) {
    (void)state;
    noc_pool *pool = noc_pool_create(1);
    noc_learned *t = noc_learned_create(1, NULL);
    cell_key key = key_at(0, 0, 0, up, 0);
    assert_null(noc_learned_find(t, key));
    assert_true(noc_cell_visibility(NULL, 7) == 0.5f);
    add(t, pool, key, (const noc_observation[]){ { 7, 10, 10 }, { 8, 10, 0 } }, 2);
    const noc_cell *c = noc_learned_find(t, key);
    assert_non_null(c);
    /* (seen + 2 * 0.5) / (asked + 2), where 0.5 is what all lights of the cell came to */
    assert_float_equal(noc_cell_visibility(c, 7), 11.0 / 12, 1e-6);
    assert_float_equal(noc_cell_visibility(c, 8), 1.0 / 12, 1e-6);
    assert_float_equal(noc_cell_visibility(c, 9), 0.5, 1e-6);
    for (int i = 0; i < 5000; i++) /* counts stay in range, and old ones fade */
        add(t, pool, key, &(noc_observation){ 8, 1000, 1000 }, 1);
    c = noc_learned_find(t, key);
    assert_true(noc_cell_visibility(c, 8) > 0.98f && noc_cell_visibility(c, 8) <= 1);
    assert_in_range(c->word[CELL_ASKED], 1 << 19, (1 << 20) + 2000);
    noc_learned_forget(t);
    assert_null(noc_learned_find(t, key));
    noc_learned_destroy(t);
    noc_pool_destroy(pool);
}

enum { MANY = 40000 };

/* Tiles of eight cells with an observation each: anywhere in so many metres, of so many lights. */
static void observe(uint32_t *x, uint32_t metres, uint32_t lights, noc_observation *data, noc_cell_observations *cells,
                    noc_observations *tiles) {
    for (int i = 0; i < MANY; i++) {
        *x = *x * 1664525 + 1013904223;
        data[i] = (noc_observation){ (*x >> 8) % lights, 8, (uint16_t)(*x & 7) };
        cells[i] = (noc_cell_observations){
            .cell = key_at((float)((*x >> 22) % metres), (float)((*x >> 12 & 1023) % metres), 0, up, 4),
            .count = 1,
            .data = &data[i],
        };
        tiles[i / 8] = (noc_observations){ &cells[i / 8 * 8], 8 };
    }
}

/* More cells and lights than there is room for: the newest are there, nothing is out of range. */
static void crowds(void **state) {
    (void)state;
    noc_pool *pools[2] = { noc_pool_create(1), noc_pool_create(3) };
    noc_learned *t[2] = { noc_learned_create(1, NULL), noc_learned_create(1, NULL) };
    noc_observation *s = noc_calloc(MANY, sizeof(*s));
    noc_cell_observations *cells = noc_calloc(MANY, sizeof(*cells));
    noc_observations *tiles = noc_calloc(MANY / 8, sizeof(*tiles));
    uint32_t x = 1;
    for (int frame = 0; frame < 3; frame++) {
        observe(&x, 1024, 1024, s, cells, tiles);
        for (int k = 0; k < 2; k++)
            noc_learned_add(t[k], pools[k], tiles, MANY / 8);
        assert_memory_equal(t[0]->cells, t[1]->cells, t[0]->count * sizeof(*t[0]->cells));
    }
    for (size_t i = 0; i < t[0]->count; i++)
        for (uint32_t light = 0; t[0]->cells[i].word[CELL_CHECK] && light < 1024; light += 31) {
            float v = noc_cell_visibility(&t[0]->cells[i], light);
            assert_true(v > 0 && v < 1);
        }
    assert_non_null(noc_learned_find(t[0], cells[MANY - 1].cell));
    free(s);
    free(cells);
    free(tiles);
    for (int k = 0; k < 2; k++) {
        noc_learned_destroy(t[k]);
        noc_pool_destroy(pools[k]);
    }
}

/* Every observation is taken in once, in the order of tiles: the last tile's light has the place. */
static void in_order(void **state) {
    (void)state;
    noc_pool *pool = noc_pool_create(2);
    noc_learned *t = noc_learned_create(1, NULL);
    cell_key key[2] = { key_at(0, 0, 0, up, 0), key_at(5, 0, 0, up, 0) };
    enum { TILES = 200 };
    noc_observation data[TILES][2];
    noc_cell_observations cells[TILES][2];
    noc_observations tiles[TILES];
    for (uint32_t i = 0; i < TILES; i++) {
        for (int k = 0; k < 2; k++) {
            data[i][k] = (noc_observation){ 1000 + i, 4, 1 };
            cells[i][k] = (noc_cell_observations){ .cell = key[k], .count = 1, .data = &data[i][k] };
        }
        tiles[i] = (noc_observations){ cells[i], 2 };
    }
    noc_learned_add(t, pool, tiles, TILES);
    for (int k = 0; k < 2; k++) {
        const noc_cell *c = noc_learned_find(t, key[k]);
        assert_non_null(c);
        assert_int_equal(c->word[CELL_ASKED], 4 * TILES);
        assert_int_equal(c->word[CELL_SEEN], TILES);
        bool last = false;
        for (uint32_t i = 0; i < CELL_LIGHTS; i++)
            last = last || c->word[CELL_LIGHT + i] == 1000 + TILES - 1;
        assert_true(last);
    }
    noc_learned_destroy(t);
    noc_pool_destroy(pool);
}

/* A larger picture has more cells: what was known is known, word for word, and there is room for more. */
static void grows(void **state) {
    (void)state;
    enum { LARGE = 4000 };
    noc_pool *pool = noc_pool_create(2);
    noc_learned *t = noc_learned_create(1, NULL);
    noc_observation *s = noc_calloc(MANY, sizeof(*s));
    noc_cell_observations *cells = noc_calloc(MANY, sizeof(*cells));
    noc_observations *tiles = noc_calloc(MANY / 8, sizeof(*tiles));
    uint32_t x = 1;
    observe(&x, 1024, 16, s, cells, tiles);
    noc_learned_add(t, pool, tiles, MANY / 8);
    size_t small = t->count, known = 0, now = 0;
    noc_cell *before = noc_alloc(small * sizeof(*before));
    memcpy(before, t->cells, small * sizeof(*before));
    assert_int_equal(noc_learned_fit(t, LARGE, NULL), NOC_OK);
    assert_true(t->count >= 4 * LARGE && t->count > small);
    for (size_t i = 0; i < small; i++) {
        cell_key key = { before[i].word[CELL_PLACE], before[i].word[CELL_CHECK] };
        if (!key.check)
            continue;
        const noc_cell *c = noc_learned_find(t, key);
        assert_non_null(c);
        assert_memory_equal(c, &before[i], sizeof(*c));
        known++;
    }
    assert_true(known > small / 2); /* it was crowded */
    observe(&x, 1024, 16, s, cells, tiles);
    noc_learned_add(t, pool, tiles, MANY / 8);
    for (size_t i = 0; i < t->count; i++)
        now += t->cells[i].word[CELL_CHECK] != 0;
    assert_true(now > small); /* the room is used */
    size_t large = t->count;
    assert_int_equal(noc_learned_fit(t, 1, NULL), NOC_OK);
    assert_int_equal(t->count, large); /* a smaller picture takes nothing away */
    free(before);
    free(s);
    free(cells);
    free(tiles);
    noc_learned_destroy(t);
    noc_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys),   cmocka_unit_test(keys_spread), cmocka_unit_test(counts),
        cmocka_unit_test(crowds), cmocka_unit_test(in_order),    cmocka_unit_test(grows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
