/* What finding facets of a building's walls, and windows on them, may cost. */
#include "city/windows/parts.h"
#include "../test.h"
#include <math.h>

/* Triangles for facets, and how many of them and of groups of them are looked at until those are found. */
static size_t looked_at(const wall_triangle *t, size_t count, size_t facets) {
    wall_facets f = { 0 };
    assert_true(wall_facets_find(t, count, &f));
    size_t looked = f.looked_at;
    print_message("# %zu triangles, %zu facets: %zu looks\n", count, f.facets.len, looked);
    assert_int_equal(f.facets.len, facets);
    assert_int_equal(f.by_facet.len, count);
    wall_facets_free(&f);
    return looked;
}

enum { MANY = 6000 };

static void set_triangle(wall_triangle *t, const double a[3], const double b[3], const double c[3]) {
    memcpy(t->p[0], a, sizeof(t->p[0]));
    memcpy(t->p[1], b, sizeof(t->p[1]));
    memcpy(t->p[2], c, sizeof(t->p[2]));
}

/* A wall of many pieces is found at a cost a piece: walls that stand across one place, that lie on one another, and
 * that stand side by side. */
static void test_many_pieces(void **state) {
    (void)state;
    static wall_triangle star[MANY], stack[MANY], row[MANY];
    for (int i = 0; i < MANY; i++) {
        double angle = 2 * M_PI * i / MANY, c = cos(angle), s = sin(angle), x = .001 * i;
        set_triangle(&star[i], (double[]){ 500 * c, 500 * s, 0 }, (double[]){ 1000 * c, 1000 * s, 0 },
                     (double[]){ 1000 * c, 1000 * s, 10 });
        set_triangle(&stack[i], (double[]){ x, 0, 0 }, (double[]){ x + 50, 0, 0 }, (double[]){ x + 50, 0, 50 });
        set_triangle(&row[i], (double[]){ 2 * i, 0, 0 }, (double[]){ 2 * i + 1, 0, 0 }, (double[]){ 2 * i + 1, 0, 9 });
    }
    assert_true(looked_at(star, MANY, MANY) < 40 * MANY);
    assert_true(looked_at(stack, MANY, 1) < 40 * MANY);
    assert_true(looked_at(row, MANY, MANY) < 40 * MANY);
}

/* Pieces whose boxes lie over one another and that do not touch, as the teeth of a comb: facets take pairs of them all.
 * Beyond a bound the building has no windows, which is counted; a part of them has as many as ever. */
static void test_bounded_pairs(void **state) {
    (void)state;
    enum { FEW = 100 };
    static wall_triangle comb[MANY];
    const noc_window_params p = noc_window_default_params();
    city_windows out = { 0 };
    for (int i = 0; i < MANY; i++)
        set_triangle(&comb[i], (double[]){ i, 0, 0 }, (double[]){ i + .5, 0, 0 }, (double[]){ i + 1000., 0, 1000 });
    assert_int_equal(city_windows_make("b", NOC_USE_FLATS, comb, MANY, &p, NULL, SIZE_MAX, &out), NOC_OK);
    assert_int_equal(out.crowded, 1);
    assert_int_equal(out.list.len + out.facades.len, 0);
    assert_int_equal(out.verdicts.len, MANY);
    assert_int_equal(city_windows_make("b", NOC_USE_FLATS, comb, FEW, &p, NULL, SIZE_MAX, &out), NOC_OK);
    assert_int_equal(out.crowded, 0);
    assert_int_equal(out.facades.len, FEW);
    city_windows_free(&out);
}

/* Large pieces across one another: hardly two lie in one plane, but groups of them may, wherever one looks. */
static void test_bounded_groups(void **state) {
    (void)state;
    enum { COUNT = 3 * MANY };
    static wall_triangle tangle[COUNT];
    const noc_window_params p = noc_window_default_params();
    city_windows out = { 0 };
    uint32_t die = 1;
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 9; k++) {
            die = 1664525 * die + 1013904223;
            tangle[i].p[k / 3][k % 3] = (double)(die >> 8) * 0x1p-24 * 100;
        }
    assert_int_equal(city_windows_make("b", NOC_USE_FLATS, tangle, COUNT, &p, NULL, SIZE_MAX, &out), NOC_OK);
    assert_int_equal(out.crowded, 1);
    assert_int_equal(out.list.len, 0);
    city_windows_free(&out);
}

/* A wall of many triangles under each of its cells: tests of those are bounded, too. */
static void test_bounded_tests(void **state) {
    (void)state;
    enum { LAYERS = 4000 };
    static wall_triangle layers[LAYERS];
    const noc_window_params p = noc_window_default_params();
    city_windows out = { 0 };
    for (int i = 0; i < LAYERS; i++) /* holes between them: no cell is all wall before the last is tested */
        set_triangle(&layers[i], (double[]){ 0, 0, 0 }, (double[]){ 2000, 0, .01 * i },
                     (double[]){ 2000, 0, .01 * i + 60 });
    assert_int_equal(city_windows_make("b", NOC_USE_FLATS, layers, LAYERS, &p, NULL, SIZE_MAX, &out), NOC_OK);
    assert_int_equal(out.crowded, 1);
    city_windows_free(&out);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_many_pieces),
        cmocka_unit_test(test_bounded_pairs),
        cmocka_unit_test(test_bounded_groups),
        cmocka_unit_test(test_bounded_tests),
    };
    return cmocka_run_group_tests_name("city/facets", tests, NULL, NULL);
}
