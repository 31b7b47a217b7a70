/* Lookups of textures against sums in doubles: levels of 4 x 2, 2 x 1 and 1 x 1 texels of known albedos. */
#include "core_test.h"

#include "core/records.h"

static uint32_t words[TEXTURE_HEAD + 11];
FN u32 texel_load(CTX u32 place) {
    (void)ctx;
    assert_true(place < sizeof(words) / sizeof(*words));
    return words[place];
}

#include "core/texture.h"

#define PASS_NONE ((const struct core_context *)NULL),

static const int sides[3][2] = { { 4, 2 }, { 2, 1 }, { 1, 1 } };
static double albedos[11]; /* red; green is half of it, blue a quarter */

static void make(uint32_t wrap) {
    dice die = { 3 };
    words[0] = 3 | wrap << 8;
    for (uint32_t l = 0, place = TEXTURE_HEAD; l < 3; l++) {
        words[1 + 2 * l] = place;
        words[2 + 2 * l] = (uint32_t)sides[l][0] | (uint32_t)sides[l][1] << 16;
        place += (uint32_t)(sides[l][0] * sides[l][1]);
    }
    for (int i = 0; i < 11; i++) {
        float a = (float)uniform(&die, 0.02, 0.9);
        words[TEXTURE_HEAD + (uint32_t)i] = texel_pack(V3(a, a / 2, a / 4));
        double root = floor(sqrt((double)a) * 1023 + 0.5) / 1023;
        albedos[i] = root * root;
    }
}

/* The texel of a column or row, whatever lies beyond the edges. */
static int texel_of(uint32_t wrap, int i, int count) {
    if (wrap == WRAP_REPEAT)
        return ((i % count) + count) % count;
    if (wrap == WRAP_CLAMP)
        return i < 0 ? 0 : i >= count ? count - 1 : i;
    i = ((i % (2 * count)) + 2 * count) % (2 * count);
    return i < count ? i : 2 * count - 1 - i;
}

static double in_level(uint32_t wrap, int level, double u, double v) {
    int first = level == 0 ? 0 : level == 1 ? 8 : 10, w = sides[level][0], h = sides[level][1];
    double x = u * w - 0.5, y = (1 - v) * h - 0.5, sum = 0;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            int column = (int)floor(x) + k, row = (int)floor(y) + i;
            double share = (1 - fabs(x - column)) * (1 - fabs(y - row));
            sum += share * albedos[first + texel_of(wrap, row, h) * w + texel_of(wrap, column, w)];
        }
    return sum;
}

static void test_lookups(void **state) {
    (void)state;
    dice die = { 1 };
    for (uint32_t wrap = WRAP_REPEAT; wrap <= WRAP_CLAMP; wrap++) {
        make(wrap);
        for (int i = 0; i < 100000; i++) {
            double u = uniform(&die, -3, 3), v = uniform(&die, -3, 3), level = uniform(&die, -0.5, 3);
            double at = fmin(fmax(level, 0), 2);
            int fine = (int)at;
            double share = at - fine, want = (1 - share) * in_level(wrap, fine, u, v);
            want += share > 0 ? share * in_level(wrap, fine + 1, u, v) : 0;
            v3 have = texture_albedo(PASS_NONE 0, (float)u, (float)v, (float)level);
            assert_true(fabs(have.x - want) < 2e-5);
            assert_true(fabs(have.y - want / 2) < 2e-3 && fabs(have.z - want / 4) < 2e-3); /* packed anew */
        }
    }
}

/* Places that are no numbers, or farther out than floats can tell, read nothing that is not there. */
static void test_far_places(void **state) {
    (void)state;
    const float far[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 4e6f, -0.0f, 1, 0x1.fffffep-1f, -1e-30f };
    for (uint32_t wrap = WRAP_REPEAT; wrap <= WRAP_CLAMP; wrap++) {
        make(wrap);
        for (size_t i = 0; i < sizeof(far) / sizeof(*far); i++)
            for (size_t k = 0; k < sizeof(far) / sizeof(*far); k++) {
                texture_albedo(PASS_NONE 0, far[i], far[k], 0);
                texture_albedo(PASS_NONE 0, 0, far[k], far[i]);
            }
    }
}

/* The first row of an image is at the top, where v is 1, and its first column at the left, where u is 0. */
static void test_way_up(void **state) {
    (void)state;
    make(WRAP_CLAMP);
    assert_close(texture_albedo(PASS_NONE 0, 0, 1, 0).x, albedos[0], 1e-5);
    assert_close(texture_albedo(PASS_NONE 0, 1, 1, 0).x, albedos[3], 1e-5);
    assert_close(texture_albedo(PASS_NONE 0, 0, 0, 0).x, albedos[4], 1e-5);
    assert_close(texture_albedo(PASS_NONE 0, 1, 0, 0).x, albedos[7], 1e-5);
}

/* A pixel as wide as 2^n texels looks at level n. The image lies twice on 8 m x 2 m, so that a texel is 1 m x 1 m. */
static void test_levels(void **state) {
    (void)state;
    make(WRAP_REPEAT);
    corners t = { V3(10, 20, 5), V3(18, 20, 5), V3(10, 20, 7) };
    image_corners at = { V3(0, 2, 0), V3(0, 0, 1) };
    for (double width = 0.01; width < 1000; width *= 1.1) {
        double level = texture_level(PASS_NONE 0, t, at, (float)width), want = width > 1 ? log2(width) : 0;
        assert_true(fabs(level - want) < 0.045);
    }
    corners flat = { t.a, t.a, t.a };
    assert_true(texture_level(PASS_NONE 0, flat, at, 1) <= 60);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lookups),
        cmocka_unit_test(test_far_places),
        cmocka_unit_test(test_way_up),
        cmocka_unit_test(test_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
