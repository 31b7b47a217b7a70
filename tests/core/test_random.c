/* core/random.h and core/warp.h: even, independent, exact. */
#include "core_test.h"
#include "core/frame.h"
#include "core/random.h"
#include "core/warp.h"

/* A chi-square value of k bins as standard deviations off its mean. */
static double chi_square(const uint32_t *bins, int k, double n) {
    double sum = 0, expected = n / k;
    for (int i = 0; i < k; i++)
        sum += (bins[i] - expected) * (bins[i] - expected) / expected;
    return (sum - (k - 1)) / sqrt(2.0 * (k - 1));
}

/* The generator under test, and one that is known to be bad: without its finaliser. */
typedef uint32_t bits_fn(uint32_t pixel, uint32_t frame, uint32_t dim);
static uint32_t good(uint32_t pixel, uint32_t frame, uint32_t dim) { return rng_bits(rng_key(7, pixel, frame), dim); }
static uint32_t bad(uint32_t pixel, uint32_t frame, uint32_t dim) {
    return (pixel + frame * 0x85ebca6bu + dim * 0x9e3779b9u) * 0x01000193u;
}

/* Sets of numbers that a frame uses together: walks along pixels, frames and dimensions. */
static void walk(int axis, uint32_t i, uint32_t at[3]) {
    at[0] = 1234;
    at[1] = 5;
    at[2] = 17;
    at[axis] += i;
}

/* Worst chi-square over high, middle and low 8 bits, and over pairs of neighbours in each walk. */
static double worst_uniformity(bits_fn *bits) {
    enum { N = 1 << 17 };
    static uint32_t bins[65536];
    double worst = 0;
    for (int axis = 0; axis < 3; axis++)
        for (int shift = 0; shift < 32; shift += 8) {
            memset(bins, 0, sizeof(bins));
            for (uint32_t i = 0; i < N; i++) {
                uint32_t at[3];
                walk(axis, i, at);
                bins[bits(at[0], at[1], at[2]) >> shift & 255]++;
            }
            worst = fmax(worst, fabs(chi_square(bins, 256, N)));
            memset(bins, 0, sizeof(bins));
            for (uint32_t i = 0; i < N; i++) {
                uint32_t at[3], next[3];
                walk(axis, i, at);
                walk(axis, i + 1, next);
                uint32_t pair =
                    (bits(at[0], at[1], at[2]) >> shift & 15) << 4 | (bits(next[0], next[1], next[2]) >> shift & 15);
                bins[pair]++;
            }
            worst = fmax(worst, fabs(chi_square(bins, 256, N)));
        }
    return worst;
}

/* Worst correlation, in standard errors, between numbers `lag` apart on each axis and crosswise. */
static double worst_correlation(bits_fn *bits) {
    enum { N = 1 << 16 };
    static const uint32_t lags[] = { 1, 2, 3, 16, 64, 1280, 1281 };
    double worst = 0;
    for (int axis = 0; axis < 3; axis++)
        for (int other = 0; other < 3; other++)
            for (size_t k = 0; k < 7; k++) {
                double sum = 0;
                for (uint32_t i = 0; i < N; i++) {
                    uint32_t a[3], b[3];
                    walk(axis, i, a);
                    memcpy(b, a, sizeof(b));
                    b[other] += lags[k];
                    sum += (unit_real(bits(a[0], a[1], a[2])) - 0.5) * (unit_real(bits(b[0], b[1], b[2])) - 0.5);
                }
                worst = fmax(worst, fabs(sum / N * 12 * sqrt(N)));
            }
    return worst;
}

/* 24 values of chi-square and 63 correlations: 5 standard deviations are out of reach of a good generator. (Chi-square
 * of 255 degrees of freedom is skewed: 5 of its deviations are rarer than 1e-5.) */
static void test_uniform_and_independent(void **state) {
    assert_true(worst_uniformity(good) < 5);
    assert_true(worst_correlation(good) < 5);
    assert_true(worst_uniformity(bad) > 20); /* the tests can fail */
    assert_true(worst_correlation(bad) > 20);
}

/* The dimensions that one pixel uses are never the same number: no two of them collide, also near the wrap-around. */
static void test_keys(void **state) {
    for (uint32_t key = 0xfffffff0u; key != 16; key++)
        for (uint32_t a = 0; a < 4; a++)
            for (uint32_t b = a + 1; b < 600; b++)
                assert_true(rng_bits(key, a) != rng_bits(key, b));
    /* pixels of a frame have different keys, and a seed changes all of them */
    for (uint32_t i = 1; i < 100000; i++) {
        assert_true(rng_key(1, i, 3) != rng_key(1, i - 1, 3));
        assert_true(rng_key(1, i, 3) != rng_key(2, i, 3));
        assert_true(rng_key(1, i, 3) != rng_key(1, i, 4));
    }
}

static void test_ranges(void **state) {
    dice d = { 3 };
    assert_true(unit_real(0) == 0 && unit_real(UINT32_MAX) < 1);
    assert_true(unit_low(0) > 0 && unit_low(UINT32_MAX) < 1 && unit_high(0) > 0 && unit_high(UINT32_MAX) < 1);
    for (int i = 0; i < 100000; i++) {
        uint32_t bits = (uint32_t)roll(&d);
        assert_true(unit_real(bits) == (float)((bits >> 8) * 0x1p-24));
        assert_true(unit_low(bits) == (float)(((bits & 0xffff) + 0.5) * 0x1p-16));
        assert_true(unit_high(bits) == (float)(((bits >> 16) + 0.5) * 0x1p-16));
    }
}

static void test_scale(void **state) {
    dice d = { 4 };
    static const uint32_t edges[] = { 0,       1,          2,          3,          0xffff,    0x10000,
                                      0x10001, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff };
    for (int i = 0; i < 11; i++)
        for (int j = 0; j < 11; j++)
            assert_true(scale_u32(edges[i], edges[j]) == (uint32_t)((unsigned __int128)edges[i] * edges[j] >> 32));
    for (int i = 0; i < 1000000; i++) {
        uint32_t a = (uint32_t)roll(&d), n = (uint32_t)roll(&d) >> roll(&d) % 32;
        uint32_t s = scale_u32(a, n);
        assert_true(s == (uint32_t)floorl((long double)a * n / 4294967296.0L)); /* 64 bits of mantissa, or more */
        assert_true(s < n || n == 0);
    }
    /* even over a number of lights that is no power of two */
    uint32_t bins[1000] = { 0 };
    for (uint32_t i = 0; i < 1000000; i++)
        bins[scale_u32(good(i, 1, 512), 1000)]++;
    assert_true(fabs(chi_square(bins, 1000, 1e6)) < 5);
}

static void test_circle(void **state) {
    double worst = 0, round = 0;
    for (int i = 0; i <= 1 << 20; i++) {
        float t = (float)(i * 0x1p-20);
        v3 c = circle(t);
        worst = fmax(worst, fmax(fabs(c.x - cos(2 * M_PI * t)), fabs(c.y - sin(2 * M_PI * t))));
        round = fmax(round, fabs((double)c.x * c.x + (double)c.y * c.y - 1));
    }
    print_message("# circle: error %.3g, off the circle by %.3g\n", worst, round);
    assert_true(worst < 4e-7 && round < 8e-7);
    assert_true(circle(0).x == 1 && circle(0).y == 0 && circle(1).x == 1 && circle(0.25f).y == 1 &&
                circle(0.5f).x == -1);
}

static void test_around(void **state) {
    dice d = { 5 };
    for (int i = 0; i < 200000; i++) {
        v3 n = i < 6 ? V3(i == 0   ? 1
                          : i == 1 ? -1
                                   : 0,
                          i == 2   ? 1
                          : i == 3 ? -1
                                   : 0,
                          i == 4   ? 1
                          : i == 5 ? -1
                                   : 0)
                     : random_direction(&d);
        v3 x = around(n, 1, 0, 0), y = around(n, 0, 1, 0), z = around(n, 0, 0, 1);
        float e = 1e-6f;
        assert_true(fabsf(dot3(x, y)) < e && fabsf(dot3(x, z)) < e && fabsf(dot3(y, z)) < e);
        assert_true(fabsf(dot3(x, x) - 1) < e && fabsf(dot3(y, y) - 1) < e);
        assert_true(z.x == n.x && z.y == n.y && z.z == n.z);
        assert_true(dot3(cross3(x, y), n) > 0.99f);
    }
}

/* Moments of the cosine distribution: E[cos] = 2/3, E[cos^2] = 1/2, none along the surface. */
static void test_cosine_hemisphere(void **state) {
    dice d = { 6 };
    v3 n = random_direction(&d);
    mean c1 = { 0 }, c2 = { 0 }, across = { 0 };
    v3 t = around(n, 1, 0, 0);
    for (int i = 0; i < 400000; i++) {
        v3 w = cosine_hemisphere(n, (float)uniform(&d, 0, 1), (float)uniform(&d, 0, 1));
        double c = dot3(w, n);
        assert_true(c >= -1e-6 && fabsf(dot3(w, w) - 1) < 2e-6f);
        mean_add(&c1, c);
        mean_add(&c2, c * c);
        mean_add(&across, dot3(w, t));
    }
    assert_true(mean_off(&c1, 2.0 / 3) < 4 && mean_off(&c2, 0.5) < 4 && mean_off(&across, 0) < 4);
}

/* Numbers of a combination: no two of one pass share a dimension, and none reaches into the next pass. */
static void test_neighbours(void **state) {
    (void)state;
    uint64_t used = 0;
    for (uint32_t i = 0; i < 3 * (MAX_NEIGHBOURS + 1); i++) {
        uint32_t dim = i < 3 ? DIM_OWN + i : DIM_NEIGHBOUR(i / 3 - 1) + i % 3;
        assert_true(dim < 64 && !(used >> dim & 1));
        used |= (uint64_t)1 << dim;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uniform_and_independent),
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_neighbours),
        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_circle),
        cmocka_unit_test(test_around),
        cmocka_unit_test(test_cosine_hemisphere),
    };
    return cmocka_run_group_tests_name("random", tests, NULL, NULL);
}
