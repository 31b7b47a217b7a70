/* Exposure, tone mapping, the sRGB transfer. */
#include "test.h"

#include "image/internal.h"

#include <nocturne/luminaire.h>

#include <math.h>

static uint32_t seed = 1;
static double uniform(void) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

static void srgb_known_values(void **state) {
    (void)state;
    /* IEC 61966-2-1, by hand: (linear, code). */
    static const double known[][2] = { { 0, 0 },
                                       { 1, 1 },
                                       { 0.5, 0.7353569830524495 },
                                       { 0.18, 0.46135612950044164 },
                                       { 0.001, 0.01292 },
                                       { 0.0031308, 0.040449936 } };
    for (size_t i = 0; i < NOC_COUNT(known); i++) {
        assert_true(fabs(srgb_encode(known[i][0]) - known[i][1]) < 1e-6);
        assert_true(fabs(srgb_decode(known[i][1]) - known[i][0]) < 1e-6);
    }
    for (int i = 0; i <= 1000; i++)
        assert_true(fabs(srgb_encode(srgb_decode(i / 1000.0)) - i / 1000.0) < 1e-6);
}

static void srgb8_rounds_to_nearest(void **state) {
    (void)state;
    srgb8_table table;
    srgb8_table_init(&table);
    for (int i = 0; i < 256; i++)
        assert_int_equal(srgb8_encode(&table, (float)srgb_decode(i / 255.0)), i);
    for (int i = 0; i < 20000; i++) {
        double x = i / 19999.0, exact = 255 * srgb_encode(x);
        if (fabs(exact - floor(exact) - 0.5) > 1e-4) /* at a tie, float decides */
            assert_int_equal(srgb8_encode(&table, (float)x), (int)floor(exact + 0.5));
    }
    assert_int_equal(srgb8_encode(&table, -1), 0);
    assert_int_equal(srgb8_encode(&table, NAN), 0);
    assert_int_equal(srgb8_encode(&table, INFINITY), 255);
}

static const noc_tonemap maps[] = { NOC_TONEMAP_FILMIC, NOC_TONEMAP_REINHARD, NOC_TONEMAP_LINEAR };

static void curves_rise_within_range(void **state) {
    (void)state;
    for (size_t k = 0; k < NOC_COUNT(maps); k++) {
        assert_true(tonemap_curve(maps[k], 0) == 0);
        double last = 0;
        for (double x = 1e-8; x < 1e12; x *= 1.01) {
            double y = tonemap_curve(maps[k], x);
            assert_true(y >= last && y <= 1);
            if (y < 0.999 && maps[k] != NOC_TONEMAP_LINEAR)
                assert_true(y > last);
            last = y;
        }
        assert_true(last > 0.999);
    }
    /* What the filmic curve was solved for. */
    assert_true(fabs(tonemap_curve(NOC_TONEMAP_FILMIC, 0.18) - 0.18) < 1e-4);
    assert_true(fabs(tonemap_curve(NOC_TONEMAP_FILMIC, 16) - 1) < 1e-4);
    double slope = log(tonemap_curve(NOC_TONEMAP_FILMIC, 0.1818) / tonemap_curve(NOC_TONEMAP_FILMIC, 0.1782)) /
                   log(0.1818 / 0.1782);
    assert_true(fabs(slope - 1.05) < 1e-3);
}

static noc_display_params tonemapped(noc_tonemap tonemap) {
    noc_display_params p = noc_display_default_params();
    p.tonemap = tonemap;
    p.white_kelvin = 0;
    return p;
}

static double luminance_share(const float c[3]) { return image_luminance(c) / (double)fmaxf(c[0], fmaxf(c[1], c[2])); }

/* Any colour: more exposure never darkens a channel, and ends in white, but for the purest ones; greys stay grey. */
static void colours_rise_to_white(void **state) {
    (void)state;
    for (size_t k = 0; k < 2; k++)
        for (int i = 0; i < 200; i++) {
            float colour[3] = { (float)uniform(), (float)uniform(), (float)(i % 5 ? uniform() : 0) };
            bool grey = i % 7 == 0;
            if (grey)
                colour[1] = colour[2] = colour[0];
            uint8_t last[3] = { 0 };
            for (double ev = 12; ev > -30; ev -= 0.5) {
                display_map d;
                uint8_t out[3];
                noc_display_params p = tonemapped(maps[k]);
                display_init(&d, &p, ev);
                display_pixel(&d, colour, out);
                for (int c = 0; c < 3; c++)
                    assert_true(out[c] >= last[c]);
                assert_true(!grey || (out[0] == out[1] && out[1] == out[2]));
                memcpy(last, out, 3);
            }
            assert_true(luminance_share(colour) < 0.4 || (last[0] >= 254 && last[1] >= 254 && last[2] >= 254));
        }
}

/* The order of the channels is kept, and the place of the middle one between the others: that is hue. */
static void hue_holds(void **state) {
    (void)state;
    const float sodium[3] = { 1, 0.5f, 0.05f };
    for (double ev = 4; ev > -6; ev -= 0.25) {
        display_map d;
        uint8_t out[3];
        display_init(&d, NULL, ev);
        display_pixel(&d, sodium, out);
        assert_true(out[0] >= out[1] && out[1] >= out[2]);
        double v[3];
        for (int k = 0; k < 3; k++)
            v[k] = srgb_decode(out[k] / 255.0);
        if (v[0] - v[2] > 0.2) /* enough colour left to measure in 8 bits */
            assert_true(fabs((v[1] - v[2]) / (v[0] - v[2]) - 0.45 / 0.95) < 0.04);
    }
}

/* A window of 3000 K (Planck's colour in Rec.709, about 1 : 0.53 : 0.19) that shines four stops above white is bright
 * and still clearly warm; a thousand times white it is as good as white. */
static void warm_stays_warm(void **state) {
    (void)state;
    const float warm[3] = { 1, 0.53f, 0.19f };
    display_map d;
    uint8_t window[3], lamp[3];
    display_init(&d, NULL, -log2(1.2 * 16));
    display_pixel(&d, warm, window);
    assert_true(window[0] > 250 && window[0] - window[2] > 45);
    display_init(&d, NULL, -log2(1.2 * 1000));
    display_pixel(&d, warm, lamp);
    assert_true(lamp[2] > 250);
}

/* A tail lamp is red however bright it is, and blue light blue; sodium's lamp, of a black body of 2050 K, is white. */
static void pure_stays_pure(void **state) {
    (void)state;
    const float red[3] = { 1, 0, 0 }, blue[3] = { 0, 0, 1 };
    float sodium[3];
    noc_kelvin_rgb(2050, sodium);
    display_map d;
    uint8_t out[3];
    display_init(&d, NULL, -20);
    display_pixel(&d, red, out);
    assert_true(out[0] > 250 && out[1] < 90 && out[2] < 90);
    display_pixel(&d, blue, out);
    assert_true(out[2] > 250 && out[1] < 90 && out[0] < 90);
    display_pixel(&d, sodium, out);
    assert_true(out[0] > 250 && out[1] > 240 && out[2] > 240);
}

/* The black body that the camera is set to is grey, and of the same luminance; without a word colours are as they are.
 */
static void white_is_balanced(void **state) {
    (void)state;
    for (double kelvin = 2500; kelvin <= 15000; kelvin += 500) {
        noc_display_params p = { .tonemap = NOC_TONEMAP_LINEAR, .white_kelvin = kelvin };
        float lamp[3], day[3];
        uint8_t out[3], as_is[3];
        noc_kelvin_rgb(kelvin, lamp);
        noc_kelvin_rgb(6500, day);
        display_map d;
        display_init(&d, &p, 0.5);
        display_pixel(&d, lamp, out);
        p.white_kelvin = 0;
        display_init(&d, &p, 0.5);
        display_pixel(&d, day, as_is);
        for (int k = 0; k < 3; k++)
            assert_true(abs(out[k] - as_is[k]) <= 1);
    }
    /* beyond them, where a black body has no blue, it stays at the ends */
    const double beyond[][2] = { { 1e-300, 2500 }, { 1500, 2500 }, { INFINITY, 15000 } };
    for (int i = 0; i < 3; i++) {
        display_map d[2];
        for (int k = 0; k < 2; k++)
            display_init(&d[k], &(noc_display_params){ .white_kelvin = beyond[i][k] }, 0.5);
        assert_memory_equal(d[0].scale, d[1].scale, sizeof(d[0].scale));
    }
}

/* By default a street under LED lamps of 4000 K is nearly neutral, one of 3000 K is warm, and sodium is orange: codes
 * of a grey surface at code 188 of white. Without white balance it is 3000 K that is orange. */
static void nights_are_balanced(void **state) {
    (void)state;
    static const struct {
        double white, kelvin;
        int least, most; /* of red over blue, in codes */
    } seen[] = {
        { -1, 4000, -25, 0 }, { -1, 3700, -1, 1 }, { -1, 3000, 30, 60 }, { -1, 2000, 150, 220 }, { 0, 3000, 110, 160 }
    };
    for (size_t i = 0; i < NOC_COUNT(seen); i++) {
        noc_display_params p = noc_display_default_params();
        float lamp[3];
        uint8_t out[3];
        display_map d;
        p.tonemap = NOC_TONEMAP_LINEAR;
        p.white_kelvin = seen[i].white < 0 ? p.white_kelvin : seen[i].white;
        noc_kelvin_rgb(seen[i].kelvin, lamp);
        display_init(&d, &p, 0.737); /* 1.2 * 2^0.737 is 2 */
        display_pixel(&d, lamp, out);
        if (out[0] - out[2] < seen[i].least || out[0] - out[2] > seen[i].most)
            fail_msg("%g K: %d %d %d", seen[i].kelvin, out[0], out[1], out[2]);
    }
}

/* EV100 = log2(N^2 / t) - log2(S / 100). */
static void cameras_say_their_exposure(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double ev100;
    } good[] = { { "f/1,1,iso100", 0 },
                 { "f/2,1/4,iso100", 4 },
                 { "f/4,1/15,100", 7.906891 },
                 { "2.8,1/30,iso1600", 3.877744 },
                 { "f/8,0.5,iso400", 5 },
                 { "4.18", 4.18 },
                 { "-3", -3 } };
    static const char *const bad[] = { "f/2.8,1/30",     "f/0,1/30,iso100",  "f/2,1/0,iso100", "f/2,-1,iso100", "31",
                                       "f/2,1/4,iso0",   "f/2,1/4,iso100,1", "f/2,1/4,isox",   "1,2",           "",
                                       "f/nan,1,iso100", "f/1e9,1,iso100" };
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        double ev = NAN;
        assert_null(noc_exposure_read(good[i].text, &ev));
        assert_true(fabs(ev - good[i].ev100) < 1e-6);
    }
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        double ev = 1;
        assert_non_null(noc_exposure_read(bad[i], &ev));
        assert_true(ev == 1);
    }
}

static void linear_is_exact(void **state) {
    (void)state;
    noc_image *a = noc_image_create(2, 1, NULL);
    noc_display_params p = { .ev100 = 3, .tonemap = NOC_TONEMAP_LINEAR };
    /* 1.2 * 2^3 cd/m2 is white; half of that is code 188. */
    for (int k = 0; k < 3; k++) {
        a->rgb[k] = 9.6f;
        a->rgb[3 + k] = 4.8f;
    }
    uint8_t out[6];
    noc_image_to_srgb8(a, &p, out);
    assert_int_equal(out[0], 255);
    assert_int_equal(out[4], 188);
    noc_image_destroy(a);
}

/* A street at night: black sky, dim facades, a lit road, a few emitters with a mask. */
static noc_image *night(int width, int height, bool mask) {
    noc_image *a = noc_image_create(width, height, NULL);
    if (mask)
        assert_true(image_add_mask(a, NULL));
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            size_t i = (size_t)(y * width + x);
            double v = y < height / 2 ? 0 : y < 3 * height / 4 ? 0.1 : 1;
            v *= 0.5 + uniform();
            if (uniform() < 0.01) {
                v = 5000;
                if (mask)
                    a->emitter[i] = 1;
            }
            for (int k = 0; k < 3; k++)
                a->rgb[3 * i + (size_t)k] = (float)v;
        }
    return a;
}

static void exposure_scales_with_the_light(void **state) {
    (void)state;
    for (int mask = 0; mask < 2; mask++) {
        noc_image *a = night(300, 200, mask);
        double ev = noc_image_auto_ev100(a);
        for (int k = -20; k <= 20; k += 4) {
            noc_image scaled = *a;
            scaled.rgb = noc_alloc(image_pixels(a) * 3 * sizeof(float));
            for (size_t i = 0; i < 3 * image_pixels(a); i++)
                scaled.rgb[i] = ldexpf(a->rgb[i], k);
            assert_true(fabs(noc_image_auto_ev100(&scaled) - ev - k) < 1e-9);
            free(scaled.rgb);
        }
        noc_image_destroy(a);
    }
}

static void exposure_meters_what_is_lit(void **state) {
    (void)state;
    noc_image *a = night(600, 400, true);
    double ev = noc_image_auto_ev100(a);
    /* The road, around 1 cd/m2, is shown neither dark nor burnt. */
    noc_display_params p = noc_display_default_params();
    uint8_t *out = noc_alloc(600 * 400 * 3);
    noc_image_to_srgb8(a, &p, out);
    double mean = 0;
    for (size_t i = 320 * 600; i < 400 * 600; i++)
        mean += out[3 * i + 1] / (80.0 * 600);
    assert_true(mean > 90 && mean < 215);
    free(out);
    /* Emitters count for nothing: a thousand times brighter ones change nothing. */
    for (size_t i = 0; i < image_pixels(a); i++)
        for (int k = 0; k < 3 && a->emitter[i]; k++)
            a->rgb[3 * i + (size_t)k] *= 1000;
    assert_true(fabs(noc_image_auto_ev100(a) - ev) < 1e-12);
    /* Nor does a black sky of any size. */
    noc_image *b = noc_image_create(600, 1600, NULL);
    assert_true(image_add_mask(b, NULL));
    size_t at = image_pixels(b) - image_pixels(a);
    memcpy(b->rgb + 3 * at, a->rgb, image_pixels(a) * 3 * sizeof(float));
    memcpy(b->emitter + at, a->emitter, image_pixels(a));
    assert_true(fabs(noc_image_auto_ev100(b) - ev) < 0.2);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

/* Seen from afar: ground under a faint sky, and lamps whose pools cover a share of it. The night stays dark whatever
 * that share is, and the pools are neither dark nor all white. */
static void exposure_keeps_the_night_dark(void **state) {
    (void)state;
    static const double shares[] = { 0.001, 0.005, 0.01, 0.03, 0.1, 0.3 };
    for (size_t i = 0; i < NOC_COUNT(shares); i++) {
        noc_image *a = noc_image_create(512, 400, NULL);
        assert_true(image_add_mask(a, NULL));
        size_t pools = 2 * (size_t)(shares[i] * 200 + 0.5); /* rows of light: no cell is half of one */
        for (size_t y = 0; y < 400; y++)
            for (size_t x = 0; x < 512; x++) {
                bool lit = pools ? y < pools : y < 2 && x < 128;
                for (size_t k = 0; k < 3; k++)
                    a->rgb[3 * (512 * y + x) + k] = lit ? 1.f : 0.005f;
            }
        uint8_t *out = noc_alloc(512 * 400 * 3);
        noc_image_to_srgb8(a, NULL, out);
        uint8_t pool = out[0], ground = out[3 * (512 * 400 - 1)];
        if (ground > 32 || pool < 100 || pool > 252)
            fail_msg("pools on %g of the picture: ground %u, pools %u of 255", shares[i], ground, pool);
        free(out);
        noc_image_destroy(a);
    }
}

/* Without a mask a few emitters move the exposure by less than two stops. */
static void exposure_stands_emitters_without_mask(void **state) {
    (void)state;
    seed = 1;
    noc_image *a = night(256, 200, true);
    seed = 1;
    noc_image *b = night(256, 200, false);
    assert_true(fabs(noc_image_auto_ev100(a) - noc_image_auto_ev100(b)) < 2);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

static void exposure_of_odd_pictures_is_sane(void **state) {
    (void)state;
    noc_image *a = noc_image_create(40, 30, NULL);
    double black = noc_image_auto_ev100(a);
    assert_true(black == 3);
    a->rgb[0] = NAN;
    a->rgb[5] = INFINITY;
    assert_true(noc_image_auto_ev100(a) == black);
    for (size_t i = 0; i < 3 * image_pixels(a); i++)
        a->rgb[i] = -1;
    assert_true(noc_image_auto_ev100(a) == black);
    for (size_t i = 0; i < 3 * image_pixels(a); i++)
        a->rgb[i] = 1e-44f;
    assert_true(isfinite(noc_image_auto_ev100(a)));
    /* Every pixel an emitter: then they are metered after all. */
    assert_true(image_add_mask(a, NULL));
    memset(a->emitter, 1, image_pixels(a));
    for (size_t i = 0; i < 3 * image_pixels(a); i++)
        a->rgb[i] = 100;
    assert_true(fabs(noc_image_auto_ev100(a) - log2(100 / (1.2 * 0.27))) < 1e-6);
    noc_image_destroy(a);
}

static double shown_ev100(const noc_image *image, const noc_display_params *params) {
    double ev100;
    assert_true(display_ev100(image, params, &ev100));
    return ev100;
}

static void compensation_brightens(void **state) {
    (void)state;
    noc_image *a = night(64, 64, false);
    noc_display_params p = noc_display_default_params();
    double ev = shown_ev100(a, &p);
    p.compensation = 1.5;
    assert_true(fabs(shown_ev100(a, &p) - (ev - 1.5)) < 1e-12);
    p.auto_exposure = false;
    p.ev100 = 7;
    assert_true(shown_ev100(a, &p) == 7);
    p.ev100 = NAN;
    assert_true(isfinite(shown_ev100(a, &p)));
    noc_image_destroy(a);
}

/* A row: a window that covers pixel 0 whole and pixel 1 by a quarter, at 100 times white, beside a wall of a tenth of
 * white; and far away, a lamp that covers a quarter of pixel 4 alone. */
static void edges_of_windows_are_mixed_after_the_curve(void **state) {
    (void)state;
    noc_image *a = noc_image_create(6, 1, NULL);
    noc_display_params p = { .ev100 = -log2(IMAGE_SATURATION), .tonemap = NOC_TONEMAP_LINEAR }; /* 1 cd/m2 is white */
    static const float share[6] = { 1, 0.25f, 0, 0, 0.25f, 0 };
    a->coverage = calloc(6 * 4, sizeof(float));
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 3; k++) {
            a->coverage[4 * i + k] = 100 * share[i];
            a->rgb[3 * i + k] = 100 * share[i] + 0.1f * (1 - share[i]);
        }
        a->coverage[4 * i + 3] = share[i];
    }
    uint8_t with[18], without[18];
    noc_image_to_srgb8(a, &p, with);
    free(a->coverage);
    a->coverage = NULL;
    noc_image_to_srgb8(a, &p, without);
    for (int i = 0; i < 6; i++) { /* 0.25 * 1 + 0.75 * 0.1 by the standard's formula is code 154.4 */
        int want = i == 1 ? 154 : without[3 * i];
        if (i != 4)
            assert_int_equal(with[3 * i], want);
    }
    assert_int_equal(without[3], 255);
    /* The lamp fills a quarter at most: a sixteenth is mixed, the rest is its glare. */
    assert_in_range(with[12], 248, 254);
    noc_image_destroy(a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(srgb_known_values),
        cmocka_unit_test(srgb8_rounds_to_nearest),
        cmocka_unit_test(curves_rise_within_range),
        cmocka_unit_test(colours_rise_to_white),
        cmocka_unit_test(hue_holds),
        cmocka_unit_test(warm_stays_warm),
        cmocka_unit_test(pure_stays_pure),
        cmocka_unit_test(white_is_balanced),
        cmocka_unit_test(nights_are_balanced),
        cmocka_unit_test(cameras_say_their_exposure),
        cmocka_unit_test(linear_is_exact),
        cmocka_unit_test(exposure_scales_with_the_light),
        cmocka_unit_test(exposure_meters_what_is_lit),
        cmocka_unit_test(exposure_keeps_the_night_dark),
        cmocka_unit_test(exposure_stands_emitters_without_mask),
        cmocka_unit_test(exposure_of_odd_pictures_is_sane),
        cmocka_unit_test(compensation_brightens),
        cmocka_unit_test(edges_of_windows_are_mixed_after_the_curve),
    };
    return cmocka_run_group_tests_name("image display", tests, NULL, NULL);
}
