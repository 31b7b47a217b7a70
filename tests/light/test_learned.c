/* Learned visibility: cells, counts, and the same table for any number of threads. */
#include "../test.h"

#include "light/learned.h"

#include <math.h>

static const float up[3] = { 0, 0, 1 }, down[3] = { 0, 0, -1 }, east[3] = { 1, 0, 0 };

static void keys(void **state) {
    (void)state;
    const float a[3] = { 0.1f, 0.2f, 0 }, near[3] = { 0.2f, 0.3f, 0 }, far[3] = { 9, 0.2f, 0 };
    uint64_t key = noc_cell_key(a, up, 1);
    assert_true(key == noc_cell_key(near, up, 1));
    assert_true(key != noc_cell_key(far, up, 1));
    assert_true(key != noc_cell_key(a, down, 1));
    assert_true(key != noc_cell_key(a, east, 1));
    assert_true(key != noc_cell_key(a, up, 2));
    /* A floor at a round height lies in one layer of cells, whatever rounding does to it. */
    for (int level = -3; level < 8; level++) {
        const float under[3] = { 0.1f, 0.2f, -1e-5f }, over[3] = { 0.1f, 0.2f, 1e-5f };
        assert_true(noc_cell_key(under, up, level) == noc_cell_key(over, up, level));
    }
    /* Far out and in odd places too there is a key. */
    const float odd[3] = { 1e7f, -1e7f, 3e7f };
    assert_true(noc_cell_key(odd, east, -40) != 0);
}

static void counts(void **state) {
    (void)state;
    noc_pool *pool = noc_pool_create(1);
    noc_learned *t = noc_learned_create(1, NULL);
    uint64_t key = noc_cell_key((const float[3]){ 0 }, up, 0);
    assert_null(noc_learned_find(t, key));
    assert_true(noc_cell_visibility(NULL, 7) == 0.5f);
    noc_observation s[] = { { key, 7, 10, 10 }, { key, 8, 10, 0 } };
    noc_learned_add(t, pool, &(noc_observations){ s, 2 }, 1);
    const noc_cell *c = noc_learned_find(t, key);
    assert_non_null(c);
    /* (seen + 2 * 0.5) / (asked + 2), where 0.5 is what all lights of the cell came to */
    assert_float_equal(noc_cell_visibility(c, 7), 11.0 / 12, 1e-6);
    assert_float_equal(noc_cell_visibility(c, 8), 1.0 / 12, 1e-6);
    assert_float_equal(noc_cell_visibility(c, 9), 0.5, 1e-6);
    for (int i = 0; i < 5000; i++) /* counts stay in range, and old ones fade */
        noc_learned_add(t, pool, &(noc_observations){ &(noc_observation){ key, 8, 1000, 1000 }, 1 }, 1);
    c = noc_learned_find(t, key);
    assert_true(noc_cell_visibility(c, 8) > 0.98f && noc_cell_visibility(c, 8) <= 1);
    noc_learned_forget(t);
    assert_null(noc_learned_find(t, key));
    noc_learned_destroy(t);
    noc_pool_destroy(pool);
}

/* More cells and lights than there is room for: the newest are there, nothing is out of range. */
static void crowds(void **state) {
    (void)state;
    noc_pool *pools[2] = { noc_pool_create(1), noc_pool_create(3) };
    noc_learned *t[2] = { noc_learned_create(1, NULL), noc_learned_create(1, NULL) };
    enum { MANY = 40000 };
    noc_observation *s = noc_calloc(MANY, sizeof(*s));
    uint32_t x = 1;
    for (int frame = 0; frame < 3; frame++) {
        for (int i = 0; i < MANY; i++) {
            x = x * 1664525 + 1013904223;
            const float p[3] = { (float)(x >> 22), (float)(x >> 12 & 1023), 0 };
            s[i] = (noc_observation){ noc_cell_key(p, up, 4), x >> 8 & 1023, 8, (uint16_t)(x & 7) };
        }
        for (int k = 0; k < 2; k++)
            noc_learned_add(t[k], pools[k], &(noc_observations){ s, MANY }, 1);
        assert_memory_equal(t[0]->cells, t[1]->cells, t[0]->bytes);
    }
    for (size_t i = 0; i < t[0]->count; i++)
        for (uint32_t light = 0; t[0]->cells[i].key && light < 1024; light += 31) {
            float v = noc_cell_visibility(&t[0]->cells[i], light);
            assert_true(v > 0 && v < 1);
        }
    assert_non_null(noc_learned_find(t[0], s[MANY - 1].cell));
    free(s);
    for (int k = 0; k < 2; k++) {
        noc_learned_destroy(t[k]);
        noc_pool_destroy(pools[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(keys), cmocka_unit_test(counts), cmocka_unit_test(crowds) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
