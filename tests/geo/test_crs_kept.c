/* What PROJ found is found once: the same numbers come of it, on any thread, and it does not grow without bound. */
#include "geo/crs_kept.h"
#include "geo/geo.h"
#include "../test.h"

#include <pthread.h>

/* A point of Ingolstadt from one CRS to UTM 33, by way of what may be kept. */
static void transform(const char *from, double xyz[3]) {
    geo_crs *a = geo_crs_create_plain(from, NULL, NULL, NULL), *b = geo_crs_create("EPSG:25833", NULL, NULL, NULL);
    double lonlat[2] = { 0 };
    assert_true(a && b);
    assert_true(geo_crs_lonlat(a, xyz[0], xyz[1], lonlat));
    geo_transform *t = geo_transform_create(a, b, NULL, NULL);
    assert_non_null(t);
    assert_int_equal(geo_transform_points(t, xyz, 1), 0);
    xyz[2] = lonlat[0];
    geo_transform_destroy(t);
    geo_crs_destroy(a);
    geo_crs_destroy(b);
}

static const struct {
    const char *crs;
    double xyz[3];
} places[] = {
    { "EPSG:25832", { 678000, 5404000, 0 } },
    { "EPSG:31468", { 4458000, 5402000, 0 } }, /* DHDN: one of several ways between the datums, by place */
    { "+proj=utm +zone=32 +ellps=bessel +towgs84=598.1,73.7,418.2,0.202,0.045,-2.455,6.7", { 678000, 5404000, 0 } },
};

static void test_same_again(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(places); i++) {
        double first[3], again[3];
        memcpy(first, places[i].xyz, sizeof(first));
        memcpy(again, places[i].xyz, sizeof(again));
        size_t before = crs_kept_count();
        transform(places[i].crs, first);
        assert_int_equal(crs_kept_count(), before + 2); /* to degrees and to UTM 33 */
        transform(places[i].crs, again);
        assert_int_equal(crs_kept_count(), before + 2);
        assert_memory_equal(first, again, sizeof(first));
    }
}

/* A definition is one by its letters: what reads alike is not taken for it. */
static void test_others_are_others(void **state) {
    (void)state;
    double a[3] = { 678000, 5404000, 0 }, b[3] = { 678000, 5404000, 0 };
    transform("+proj=utm +zone=32 +ellps=GRS80", a);
    transform("+proj=utm +zone=31 +ellps=GRS80", b);
    assert_true(a[2] - b[2] > 5.9 && a[2] - b[2] < 6.1); /* zones are 6 degrees wide */
}

static void test_bounded(void **state) {
    (void)state;
    double first[3] = { 678000, 5404000, 0 }, again[3] = { 678000, 5404000, 0 };
    transform("EPSG:25832", first);
    for (int i = 0; i < 60; i++) {
        char text[100];
        double p[3] = { 678000, 5404000, 0 };
        snprintf(text, sizeof(text), "+proj=tmerc +lon_0=%g +x_0=500000 +ellps=GRS80", 9 + i * .01);
        transform(text, p);
    }
    size_t before = crs_kept_count();
    transform("EPSG:25832", again);
    assert_int_equal(crs_kept_count(), before + 2); /* it had gone */
    assert_memory_equal(first, again, sizeof(first));
}

static void *work(void *into) {
    double(*results)[3] = into;
    for (int k = 0; k < 8; k++)
        for (size_t i = 0; i < NOC_COUNT(places); i++) {
            memcpy(results[i], places[i].xyz, sizeof(results[i]));
            transform(places[i].crs, results[i]);
        }
    return NULL;
}

static void test_threads(void **state) {
    (void)state;
    enum { THREADS = 4 };
    pthread_t threads[THREADS];
    double results[THREADS][NOC_COUNT(places)][3], alone[NOC_COUNT(places)][3];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, work, results[i]), 0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    work(alone);
    for (int i = 0; i < THREADS; i++)
        assert_memory_equal(results[i], alone, sizeof(alone));
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_same_again), cmocka_unit_test(test_others_are_others),
                                        cmocka_unit_test(test_bounded), cmocka_unit_test(test_threads) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
