/* Error figures against values worked out by hand, the difference picture, colour maps and colour bars. */
#include "test.h"

#include "image/colormap.h"
#include "image/internal.h"

#include <math.h>

static noc_log *log_;

static int set_up(void **state) {
    (void)state;
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = NULL });
    return log_ ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    noc_log_destroy(log_);
    return 0;
}

static void quiet(void *user, noc_log_level level, const char *text) {
    (void)level;
    (void)text;
    ++*(int *)user;
}

static noc_image *greys(int width, int height, const double *values) {
    noc_image *a = noc_image_create(width, height, log_);
    for (int i = 0; i < width * height; i++)
        for (int k = 0; k < 3; k++)
            a->rgb[3 * i + k] = (float)values[i];
    return a;
}

#define NEAR(a, b) assert_true(fabs((a) - (b)) <= 1e-5 * fabs(b) + 1e-12)

static const double values_x[] = { 2, 1, 40, 0 }, values_r[] = { 1, 1, 20, 2 };

static void figures_by_hand(void **state) {
    (void)state;
    noc_image *x = greys(4, 1, values_x), *r = greys(4, 1, values_r);
    assert_true(image_add_mask(r, log_));
    r->emitter[2] = 1;
    noc_compare_params p = noc_compare_default_params();
    p.display = (noc_display_params){ .ev100 = 2, .tonemap = NOC_TONEMAP_LINEAR }; /* white at 4.8 cd/m2 */
    noc_comparison c;
    assert_int_equal(noc_image_compare(x, r, &p, &c, log_), NOC_OK);
    assert_true(c.has_mask);
    assert_true(c.ceiling == 10);

    assert_int_equal(c.all.pixels, 4);
    NEAR(c.all.mean_x, 43 / 4.0);
    NEAR(c.all.mean_r, 24 / 4.0);
    NEAR(c.all.bias, 43 / 24.0);
    NEAR(c.all.rmse, sqrt((1 + 0 + 400 + 4) / 4.0));
    double e = 0.06 * 0.06;
    NEAR(c.all.relmse, (1 / (1 + e) + 400 / (400 + e) + 4 / (4 + e)) / 4);
    /* Codes of 2/4.8, 1/4.8, white, 0 against 1/4.8, 1/4.8, white, 2/4.8, worked out from the standard's formula. */
    double codes[3] = { 173, 126, 0 };
    NEAR(c.all.rmse8, sqrt((pow(codes[0] - codes[1], 2) + pow(codes[0] - codes[2], 2)) / 4));

    NEAR(c.ev100, 2.0);
    /* as PNG are read: white is 1, whatever the exposure. Only the last pixel differs: black, white */
    p.relative = true;
    assert_int_equal(noc_image_compare(x, r, &p, &c, log_), NOC_OK);
    NEAR(c.all.rmse8, sqrt(255 * 255 / 4.0));
    p.relative = false;
    assert_int_equal(noc_image_compare(x, r, &p, &c, log_), NOC_OK);

    NEAR(c.all_clamped.mean_x, 13 / 4.0);
    NEAR(c.all_clamped.mean_r, 14 / 4.0);
    NEAR(c.all_clamped.rmse, sqrt(5 / 4.0));

    assert_int_equal(c.dark.pixels, 3);
    NEAR(c.dark.bias, 3 / 4.0);
    NEAR(c.dark.rmse, sqrt(5 / 3.0));
    e = pow(0.01 * 4 / 3, 2);
    NEAR(c.dark.relmse, (1 / (1 + e) + 4 / (4 + e)) / 3);
    NEAR(c.dark_clamped.rmse, c.dark.rmse);
    noc_image_destroy(x);
    noc_image_destroy(r);
}

/* Pixels that the reference leaves black: each adds (x / e)^2, and what they add is told apart. */
static void unlit_pixels_are_counted(void **state) {
    static const double x_of[] = { 3, 0, 1, 0.5, 1 }, r_of[] = { 0, 0, 4, 0, 0 };
    noc_image *x = greys(5, 1, x_of), *r = greys(5, 1, r_of);
    assert_true(image_add_mask(r, log_));
    r->emitter[0] = 1;
    noc_comparison c;
    noc_compare_params p = noc_compare_default_params();
    p.ceiling = 2;
    assert_int_equal(noc_image_compare(x, r, &p, &c, log_), NOC_OK);
    double e = 0.01 * 4 / 5, dark = 0.01, clamped = 0.01 * 2 / 5;
    assert_int_equal(c.all.unlit, 3);
    NEAR(c.all.relmse_unlit, (9 + 0.25 + 1) / (e * e) / 5);
    NEAR(c.all.relmse, (9 + 0.25 + 1) / (e * e) / 5 + 9 / (16 + e * e) / 5);
    assert_int_equal(c.dark.unlit, 2);
    NEAR(c.dark.relmse_unlit, (0.25 + 1) / (dark * dark) / 4);
    assert_int_equal(c.all_clamped.unlit, 3);
    NEAR(c.all_clamped.relmse_unlit, (4 + 0.25 + 1) / (clamped * clamped) / 5);
    assert_int_equal(noc_image_compare(r, x, NULL, &c, log_), NOC_OK); /* lit in the reference alone */
    assert_true(c.all.unlit == 0 && c.all.relmse_unlit == 0);
    noc_image_destroy(x);
    noc_image_destroy(r);
}

static void without_a_mask_dark_is_all(void **state) {
    (void)state;
    noc_image *x = greys(2, 2, values_x), *r = greys(2, 2, values_r);
    assert_true(image_add_mask(x, log_)); /* only the reference's counts */
    memset(x->emitter, 1, 4);
    noc_comparison c;
    assert_int_equal(noc_image_compare(x, r, NULL, &c, log_), NOC_OK);
    assert_false(c.has_mask);
    assert_memory_equal(&c.all, &c.dark, sizeof(c.all));
    assert_memory_equal(&c.all_clamped, &c.dark_clamped, sizeof(c.all));
    noc_image_destroy(x);
    noc_image_destroy(r);
}

static void equal_and_black_pictures(void **state) {
    (void)state;
    noc_image *r = greys(4, 1, values_r), *black = noc_image_create(4, 1, log_);
    noc_comparison c;
    assert_int_equal(noc_image_compare(r, r, NULL, &c, log_), NOC_OK);
    assert_true(c.all.rmse == 0 && c.all.relmse == 0 && c.all.rmse8 == 0 && c.all.bias == 1);
    assert_int_equal(noc_image_compare(black, black, NULL, &c, log_), NOC_OK);
    assert_true(c.all.rmse == 0 && c.all.relmse == 0 && c.all.bias == 1);
    assert_int_equal(noc_image_compare(r, black, NULL, &c, log_), NOC_OK);
    assert_true(isinf(c.all.bias));
    assert_int_equal(noc_image_compare(black, r, NULL, &c, log_), NOC_OK);
    assert_true(c.all.bias == 0);
    /* A mask over everything leaves no dark pixels: no figures, and the count says so. */
    assert_true(image_add_mask(r, log_));
    memset(r->emitter, 1, 4);
    assert_int_equal(noc_image_compare(black, r, NULL, &c, log_), NOC_OK);
    assert_int_equal(c.dark.pixels, 0);
    assert_true(c.dark.rmse == 0);
    noc_image_destroy(r);
    noc_image_destroy(black);
}

/* Both are shown with the reference's exposure: a picture of twice the light is not metered down to it. */
static void exposure_is_the_references(void **state) {
    (void)state;
    noc_image *x = greys(4, 1, (const double[]){ 2, 2, 2, 2 }), *r = greys(4, 1, (const double[]){ 1, 1, 1, 1 });
    noc_comparison c;
    assert_int_equal(noc_image_compare(x, r, NULL, &c, log_), NOC_OK);
    uint8_t a[12], b[12];
    noc_display_params p = { .ev100 = noc_image_auto_ev100(r) };
    noc_image_to_srgb8(x, &p, a);
    noc_image_to_srgb8(r, &p, b);
    assert_true(a[0] > b[0]);
    NEAR(c.all.rmse8, (double)(a[0] - b[0]));
    noc_image_destroy(x);
    noc_image_destroy(r);
}

static void what_cannot_be_compared(void **state) {
    (void)state;
    int errors = 0;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = quiet, .user = &errors });
    noc_image *x = noc_image_create(4, 2, log), *r = noc_image_create(2, 4, log), *s = noc_image_create(4, 2, log);
    noc_comparison c;
    uint8_t *out = NULL;
    int width, height;
    assert_int_equal(noc_image_compare(x, r, NULL, &c, log), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "4 x 2 and 2 x 4"));
    assert_int_equal(noc_image_difference(x, r, NULL, &out, &width, &height, log), NOC_ERR_ARGUMENT);
    assert_null(out);
    noc_compare_params p = noc_compare_default_params();
    p.ceiling = 0;
    assert_int_equal(noc_image_compare(x, s, &p, &c, log), NOC_ERR_ARGUMENT);
    x->rgb[3 * 5 + 1] = NAN;
    x->rgb[3 * 7] = -INFINITY;
    assert_int_equal(noc_image_compare(x, s, NULL, &c, log), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "2 pixels of the picture are not finite, the first at 1, 1"));
    assert_int_equal(noc_image_compare(s, x, NULL, &c, log), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "of the reference"));
    assert_int_equal(errors, 5);
    noc_image_destroy(x);
    noc_image_destroy(r);
    noc_image_destroy(s);
    noc_log_destroy(log);
}

static double cube_root_response(const uint8_t rgb[3], double lab[3]) {
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = srgb_decode(rgb[k] / 255.0);
    double x = 0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2], y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2],
           z = 0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2];
    double n[3] = { x / 0.9505, y, z / 1.089 };
    for (int k = 0; k < 3; k++)
        n[k] = n[k] > 0.008856 ? cbrt(n[k]) : 7.787 * n[k] + 16 / 116.0;
    lab[0] = 116 * n[1] - 16;
    lab[1] = 500 * (n[0] - n[1]);
    lab[2] = 200 * (n[1] - n[2]);
    return lab[0];
}

/* Judged in CIELAB, a space the maps were not made in: lightness is monotone, and steps are even within a factor. */
static void maps_are_even(void **state) {
    (void)state;
    enum { STEPS = 32 };
    for (int kind = 0; kind < 2; kind++) {
        colormap map;
        colormap_init(&map, kind ? COLORMAP_SEQUENTIAL : COLORMAP_DIVERGING);
        double smallest = 1e9, largest = 0, last[3], lab[3];
        for (int i = 0; i <= STEPS; i++) {
            cube_root_response(colormap_at(&map, (double)i / STEPS), lab);
            if (i) {
                double d = sqrt(pow(lab[0] - last[0], 2) + pow(lab[1] - last[1], 2) + pow(lab[2] - last[2], 2));
                smallest = fmin(smallest, d);
                largest = fmax(largest, d);
                assert_true(kind == 0 && i > STEPS / 2 ? lab[0] < last[0] : lab[0] > last[0]);
            }
            memcpy(last, lab, sizeof(last));
        }
        assert_true(smallest > 1);
        assert_true(largest / smallest < 2.5);
    }
}

static void diverging_map_is_fair(void **state) {
    (void)state;
    colormap map;
    colormap_init(&map, COLORMAP_DIVERGING);
    const uint8_t *low = colormap_at(&map, -3), *middle = colormap_at(&map, 0.5), *high = colormap_at(&map, 7);
    assert_true(low[2] > low[0] + 50);
    assert_true(high[0] > high[2] + 50);
    assert_true(middle[0] > 230 && abs(middle[0] - middle[2]) < 4);
    for (int i = 1; i <= 16; i++) {
        double a[3], b[3];
        cube_root_response(colormap_at(&map, 0.5 - i / 32.0), a);
        cube_root_response(colormap_at(&map, 0.5 + i / 32.0), b);
        assert_true(fabs(a[0] - b[0]) < 8);
    }
    assert_ptr_equal(colormap_at(&map, NAN), map.rgb[0]);
    assert_ptr_equal(colormap_at(&map, 1), map.rgb[COLORMAP_SIZE - 1]);
}

static void ticks_are_round(void **state) {
    (void)state;
    double t[16];
    colorbar bar = { .low = -0.37, .high = 0.37 };
    assert_int_equal(colorbar_ticks(&bar, t, 5), 3);
    NEAR(t[0], -0.2);
    assert_true(t[1] == 0 && !signbit(t[1]));
    NEAR(t[2], 0.2);
    bar = (colorbar){ .low = 0, .high = 100 };
    assert_int_equal(colorbar_ticks(&bar, t, 6), 6);
    NEAR(t[5], 100.0);
    bar = (colorbar){ .low = 0.1, .high = 100, .logarithmic = true };
    assert_int_equal(colorbar_ticks(&bar, t, 16), 10);
    NEAR(t[1], 0.2);
    NEAR(t[9], 100.0);
    assert_int_equal(colorbar_ticks(&bar, t, 5), 4);
    NEAR(t[1], 1.0);
    bar = (colorbar){ .low = 1, .high = 1 };
    assert_int_equal(colorbar_ticks(&bar, t, 5), 0);
    bar = (colorbar){ .low = 0, .high = 1, .logarithmic = true };
    assert_int_equal(colorbar_ticks(&bar, t, 5), 0);
    /* Any range: few, rising, inside. */
    for (int i = 0; i < 2000; i++) {
        double low = (i % 13 - 6) * pow(10, i % 9 - 4), high = low + pow(1.7, i % 40 - 20);
        bar = (colorbar){ .low = low, .high = high };
        size_t n = colorbar_ticks(&bar, t, 7);
        assert_in_range(n, 1, 7);
        for (size_t k = 0; k < n; k++)
            assert_true(t[k] >= low - 1e-6 * (high - low) && t[k] <= high + 1e-6 * (high - low) &&
                        (!k || t[k] > t[k - 1]));
    }
}

static void text_is_drawn(void **state) {
    (void)state;
    uint8_t rgb[20 * 9 * 3] = { 0 };
    canvas c = { rgb, 20, 9 };
    const uint8_t ink[3] = { 255, 255, 255 };
    assert_int_equal(text_width("", 3), 0);
    assert_int_equal(text_width("10", 2), 22);
    text_draw(&c, 1, 1, "1", 1, ink);
    int lit = 0;
    for (size_t i = 0; i < 20 * 9; i++)
        lit += rgb[3 * i] == 255;
    assert_int_equal(lit, 10); /* 1 + 2 + 4 + 3 */
    static const uint8_t white[3] = { 255, 255, 255 };
    /* a letter is drawn by either, and as many bytes as UTF-8 has are one */
    uint8_t one[3 * 10 * 8] = { 0 }, two[3 * 10 * 8] = { 0 };
    text_draw(&(canvas){ one, 10, 8 }, 1, 1, "\xd7", 1, white);
    assert_int_equal(noc_text_srgb8(two, 10, 8, 1, 1, "\xc3\x97", 1, white), 5);
    assert_memory_equal(one, two, sizeof(one));
    /* the last is cut short */
    assert_int_equal(noc_text_srgb8(NULL, 0, 0, 0, 0, "a\xe2\x82\xac\xc2", 2, white), 2 * 17);
    assert_int_equal(noc_text_srgb8(NULL, 0, 0, 0, 0, "", 2, white), 0);
    uint8_t street[3 * 40 * 8] = { 0 }, plain[3 * 40 * 8] = { 0 }; /* Straße, élan: the font has plain letters alone */
    assert_int_equal(noc_text_srgb8(street, 40, 8, 0, 0,
                                    "a\xc3\x9f"
                                    "e \xc3\xa9",
                                    1, white),
                     6 * 6 - 1);
    text_draw(&(canvas){ plain, 40, 8 }, 0, 0, "asse e", 1, white);
    assert_memory_equal(street, plain, sizeof(plain));
    text_draw(&c, -3, -3, "clipped at every side \x01", 4, ink); /* no crash: ASan watches */
}

static bool is_close(const uint8_t a[3], const uint8_t b[3]) {
    return abs(a[0] - b[0]) < 4 && abs(a[1] - b[1]) < 4 && abs(a[2] - b[2]) < 4;
}

static void difference_picture(void **state) {
    (void)state;
    enum { W = 400, H = 100 };
    noc_image *x = noc_image_create(W, H, log_), *r = noc_image_create(W, H, log_);
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < 3; k++) {
            r->rgb[3 * i + k] = 2;
            x->rgb[3 * i + k] = i % W < 100 ? 1 : i % W < 200 ? 3 : 2;
        }
    for (int k = 0; k < 3; k++)
        x->rgb[3 * 350 + k] = 1e6f; /* one firefly does not fade the rest */
    uint8_t *out;
    int width, height;
    assert_int_equal(noc_image_difference(x, r, NULL, &out, &width, &height, log_), NOC_OK);
    assert_int_equal(width, W);
    assert_true(height > H);
    colormap map;
    colormap_init(&map, COLORMAP_DIVERGING);
    assert_memory_equal(out + 3 * 50, colormap_at(&map, 0), 3);
    assert_memory_equal(out + 3 * 150, colormap_at(&map, 1), 3);
    assert_memory_equal(out + 3 * 250, colormap_at(&map, 0.5), 3);
    assert_memory_equal(out + 3 * 350, colormap_at(&map, 1), 3);
    /* The legend holds both ends of the map and letters. */
    size_t low = 0, high = 0, ink = 0;
    for (size_t i = (size_t)W * H; i < (size_t)width * (size_t)height; i++) {
        low += is_close(out + 3 * i, colormap_at(&map, 0));
        high += is_close(out + 3 * i, colormap_at(&map, 1));
        ink += out[3 * i] == 224 && out[3 * i + 1] == 224;
    }
    assert_true(low > 5 && high > 5 && ink > 200);
    free(out);
    noc_image_destroy(x);
    noc_image_destroy(r);
}

/* Picture and legend apart are the whole, and the bar tells its ends and colours; ends stay as long as they fit. */
static void difference_parts(void **state) {
    noc_image *x = noc_image_create(1300, 3, NULL), *r = noc_image_create(1300, 3, NULL);
    static const noc_channel_part parts[] = { NOC_CHANNEL_WHOLE, NOC_CHANNEL_PICTURE, NOC_CHANNEL_LEGEND };
    uint8_t *out[3];
    int width[3], height[3];
    noc_bar bar, next;
    int errors = 0;
    (void)state;
    for (int i = 0; i < 3 * 3 * 1300; i++) {
        x->rgb[i] = (float)(i / 3 % 1300);
        r->rgb[i] = 650;
    }
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_image_difference(x, r, &(noc_difference_params){ .part = parts[i] }, &out[i], &width[i],
                                              &height[i], NULL),
                         NOC_OK);
    assert_true(height[1] == 3 && width[0] == 1300 && height[0] == 3 + height[2]);
    assert_memory_equal(out[0], out[1], (size_t)3 * 3 * 1300);
    assert_memory_equal(out[0] + (size_t)3 * 3 * 1300, out[2], (size_t)3 * 1300 * (size_t)height[2]);
    assert_int_equal(noc_image_difference_bar(x, r, NULL, &bar, NULL), NOC_OK);
    assert_true(bar.low == -bar.high && bar.high > 600 && bar.high <= 650 && bar.tick_count > 2 && !bar.logarithmic);
    for (int i = 0; i < 1300; i += 77) {
        uint8_t rgb[3];
        noc_difference_colour(0.5 + 0.5 * (i - 650) / bar.high, rgb);
        for (int k = 0; k < 3; k++)
            assert_true(abs(rgb[k] - out[0][3 * i + k]) < 3);
    }
    for (int i = 0; i < 3 * 3 * 1300; i++)
        r->rgb[i] = 500;
    assert_int_equal(noc_image_difference_bar(x, r, &(noc_difference_params){ .last = &bar }, &next, NULL), NOC_OK);
    assert_true(next.high == bar.high); /* it now is 786 */
    assert_int_equal(noc_image_difference_bar(x, r, &(noc_difference_params){ .limit = 20 }, &next, NULL), NOC_OK);
    assert_true(next.high == 20 && next.low == -20);
    assert_int_equal(noc_image_difference_bar(x, r, &(noc_difference_params){ .last = &next }, &next, NULL), NOC_OK);
    assert_true(next.high > 700);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = quiet, .user = &errors });
    assert_int_equal(noc_image_difference_bar(x, r, &(noc_difference_params){ .limit = -1 }, &next, log),
                     NOC_ERR_ARGUMENT);
    noc_log_destroy(log);
    for (int i = 0; i < 3; i++)
        free(out[i]);
    noc_image_destroy(x);
    noc_image_destroy(r);
}

static void difference_of_tiny_and_equal_pictures(void **state) {
    (void)state;
    noc_image *a = noc_image_create(1, 1, log_);
    uint8_t *out;
    int width, height;
    assert_int_equal(noc_image_difference(a, a, NULL, &out, &width, &height, log_), NOC_OK);
    assert_true(width >= colorbar_min_width(1));
    colormap map;
    colormap_init(&map, COLORMAP_DIVERGING);
    size_t neutral = 0;
    for (int i = 0; i < width; i++)
        neutral += memcmp(out + 3 * i, colormap_at(&map, 0.5), 3) == 0;
    assert_int_equal(neutral, 1);
    free(out);
    noc_image_destroy(a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_by_hand),
        cmocka_unit_test(unlit_pixels_are_counted),
        cmocka_unit_test(without_a_mask_dark_is_all),
        cmocka_unit_test(equal_and_black_pictures),
        cmocka_unit_test(exposure_is_the_references),
        cmocka_unit_test(what_cannot_be_compared),
        cmocka_unit_test(maps_are_even),
        cmocka_unit_test(diverging_map_is_fair),
        cmocka_unit_test(ticks_are_round),
        cmocka_unit_test(text_is_drawn),
        cmocka_unit_test(difference_picture),
        cmocka_unit_test(difference_parts),
        cmocka_unit_test(difference_of_tiny_and_equal_pictures),
    };
    return cmocka_run_group_tests_name("image compare", tests, set_up, tear_down);
}
