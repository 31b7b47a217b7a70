/* Channels: numbers in colours, and as they are in files. */
#include "../test.h"

#include "image/colormap.h"
#include "image/internal.h"

#include <math.h>

static void drop(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }
static noc_log *quiet(void) { return noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop }); }

/* 300 wide, so that no legend is wider. */
enum { W = 300, H = 4 };
static noc_channel *ramp(noc_channel_scale scale, float from, float step) {
    noc_channel *c = noc_channel_create(W, H, 1, NULL);
    assert_non_null(c);
    for (int i = 0; i < W * H; i++)
        assert_true(c->value[i] == -1);
    c->name = "ramp";
    c->unit = "m";
    c->title = "a ramp [m]";
    c->scale = scale;
    for (int i = 0; i < W * H; i++)
        c->value[i] = from + step * (float)(i % W);
    return c;
}

typedef struct shown {
    uint8_t *rgb;
    int width, height;
} shown;
static shown show(const noc_channel *c, double low, double high) {
    shown s;
    assert_int_equal(noc_channel_to_srgb8(c, &(noc_channel_params){ low, high }, &s.rgb, &s.width, &s.height, NULL),
                     NOC_OK);
    assert_true(s.width == W && s.height == H + colorbar_height(1));
    return s;
}

static bool is(const shown *s, int x, const uint8_t rgb[3]) { return !memcmp(s->rgb + 3 * x, rgb, 3); }

static void colours_follow_the_bar(void **state) {
    (void)state;
    colormap map;
    colormap_init(&map, COLORMAP_SEQUENTIAL);
    noc_channel *c = ramp(NOC_CHANNEL_LINEAR, 0, 1);
    shown s = show(c, 50, 250);
    assert_true(is(&s, 0, colormap_at(&map, 0)) && is(&s, 50, colormap_at(&map, 0)) &&
                is(&s, 250, colormap_at(&map, 1)));
    assert_true(is(&s, 150, colormap_at(&map, 0.5)) && is(&s, 299, colormap_at(&map, 1)));
    free(s.rgb);
    c->scale = NOC_CHANNEL_LOG; /* 1, 10, 100 are even steps */
    s = show(c, 1, 100);
    assert_true(is(&s, 0, colormap_at(&map, 0)) && is(&s, 1, colormap_at(&map, 0)) &&
                is(&s, 10, colormap_at(&map, 0.5)) && is(&s, 100, colormap_at(&map, 1)));
    free(s.rgb);
    noc_channel_destroy(c);
}

/* Round ends around the numbers: 299 ends at 300; from .5 to 299.5 by decades of 1, 2, 5. */
static void ends_are_found(void **state) {
    (void)state;
    noc_channel *c = ramp(NOC_CHANNEL_LINEAR, 0, 1);
    shown found = show(c, 0, 0), told = show(c, 0, 300);
    assert_memory_equal(found.rgb, told.rgb, 3 * (size_t)found.width * found.height);
    free(found.rgb);
    free(told.rgb);
    c->scale = NOC_CHANNEL_LOG;
    for (int i = 0; i < W * H; i++)
        c->value[i] = 0.6f + (float)(i % W);
    found = show(c, 0, 0);
    told = show(c, 1, 300); /* the lowest half percent, .6, is left out */
    assert_memory_equal(found.rgb, told.rgb, 3 * (size_t)found.width * found.height);
    free(found.rgb);
    free(told.rgb);
    noc_channel_destroy(c);
}

/* Numbers that are all alike, all zero, absent, or not numbers at all. */
static void any_numbers(void **state) {
    (void)state;
    static const float values[] = { 0, 1, 5, 1e-38f, 3e38f, -1, NAN, INFINITY, 1e-45f };
    for (size_t i = 0; i < NOC_COUNT(values); i++)
        for (noc_channel_scale scale = NOC_CHANNEL_LINEAR; scale <= NOC_CHANNEL_LABELS; scale++) {
            noc_channel *c = ramp(scale, values[i], 0);
            shown s = show(c, 0, 0);
            bool grey = !(values[i] >= 0) || isinf(values[i]);
            assert_int_equal(is(&s, 7, (const uint8_t[]){ 92, 92, 96 }), grey);
            free(s.rgb);
            noc_channel_destroy(c);
        }
}

/* Names: the same number has the same colour in every picture, and neighbours differ visibly. */
static void labels(void **state) {
    (void)state;
    noc_channel *a = ramp(NOC_CHANNEL_LABELS, 0, 1), *b = ramp(NOC_CHANNEL_LABELS, 299, -1);
    shown x = show(a, 0, 0), y = show(b, 0, 0);
    int alike = 0;
    for (int i = 0; i < W; i++) {
        assert_true(is(&x, i, y.rgb + 3 * (W - 1 - i)));
        for (int j = 0; j < i; j++) {
            int d = 0;
            for (int k = 0; k < 3; k++)
                d += abs(x.rgb[3 * i + k] - x.rgb[3 * j + k]);
            alike += d < 12;
        }
    }
    assert_true(alike < W * (W - 1) / 2 / 100); /* few pairs of 300 names look alike */
    free(x.rgb);
    free(y.rgb);
    noc_channel_destroy(a);
    noc_channel_destroy(b);
}

static bool has_colour(const shown *s, int from_row, const uint8_t rgb[3]) {
    for (int i = from_row * s->width; i < s->height * s->width; i++)
        if (is(s, i, rgb))
            return true;
    return false;
}

/* Labels that have names: the legend shows those that are seen, and what grey is; colours do not depend on what is
 * seen. */
static void labels_with_names(void **state) {
    enum { NAMES = 18 }; /* as many as there are classes */
    static const char *const names[NAMES] = { "nought", "one", "two", "a", "b", "c", "d", "e", "f",
                                              "g",      "h",   "i",   "j", "k", "l", "m", "n", "the last" };
    static const uint8_t grey[3] = { 92, 92, 96 };
    uint8_t colour[NAMES + 1][3];
    noc_channel *c = ramp(NOC_CHANNEL_LABELS, 0, 1);
    shown all, some;
    c->labels = names;
    c->label_count = NAMES;
    for (int i = 0; i < W * H; i++)
        c->value[i] = (float)(i % (NAMES + 1)); /* the last has no name */
    assert_int_equal(noc_channel_to_srgb8(c, NULL, &all.rgb, &all.width, &all.height, NULL), NOC_OK);
    memcpy(colour, all.rgb, sizeof(colour));
    for (int i = 0; i < NAMES; i++) {
        assert_true(has_colour(&all, H, colour[i]));
        for (int j = 0; j < i; j++) {
            int d = 0;
            for (int k = 0; k < 3; k++)
                d += abs(colour[i][k] - colour[j][k]);
            assert_true(d >= 40);
        }
    }
    assert_true(has_colour(&all, H, grey) && !has_colour(&all, H, colour[NAMES]));
    for (int i = 0; i < W * H; i++)
        c->value[i] = i % 3 == 0 ? 2 : i % 3 == 1 ? -1 : NAMES;
    assert_int_equal(noc_channel_to_srgb8(c, NULL, &some.rgb, &some.width, &some.height, NULL), NOC_OK);
    assert_true(is(&some, 0, colour[2]) && is(&some, 1, grey) && is(&some, 2, colour[NAMES]) &&
                some.height < all.height);
    for (int i = 0; i <= NAMES; i++)
        assert_int_equal(has_colour(&some, H, colour[i]), i == 2);
    free(all.rgb);
    free(some.rgb);
    noc_channel_destroy(c);
}

static void files(void **state) {
    (void)state;
    char exr[] = "/tmp/nocturne-channel-XXXXXX.exr", png[] = "/tmp/nocturne-channel-XXXXXX.png";
    int fd[2] = { mkstemps(exr, 4), mkstemps(png, 4) };
    assert_true(fd[0] >= 0 && fd[1] >= 0);
    close(fd[0]);
    close(fd[1]);
    noc_channel *c = ramp(NOC_CHANNEL_LINEAR, 0.125f, 0.25f);
    c->value[5] = -1;
    c->value[6] = NAN;
    const char *keys[] = { "camera" }, *values[] = { "street" };
    assert_int_equal(noc_channel_write(c, exr, NULL, &(noc_image_meta){ 1, keys, values }, NULL), NOC_OK);
    bool linear = false;
    noc_image *read = noc_image_read(exr, NULL, &linear); /* a single channel Y is read as grey */
    assert_true(read && linear && read->width == W && read->height == H);
    assert_string_equal(read->channel, "ramp");
    for (int i = 0; i < W * H; i++)
        assert_true(read->rgb[3 * i] == (i == 5 || i == 6 ? -1 : c->value[i]));
    noc_image_destroy(read);
    char text[8192];
    FILE *f = fopen(exr, "rb");
    size_t n = fread(text, 1, sizeof(text), f);
    fclose(f);
    static const char *const told[] = { "units", "channel", "ramp", "camera", "street", "Software" };
    for (size_t i = 0; i < NOC_COUNT(told); i++)
        assert_non_null(memmem(text, n, told[i], strlen(told[i])));
    assert_null(memmem(text, n, "cd/m2", 5));
    assert_int_equal(noc_channel_write(c, png, NULL, NULL, NULL), NOC_OK);
    read = noc_image_read(png, NULL, &linear);
    assert_true(read && !linear && read->width == W && read->height == H + colorbar_height(1));
    assert_string_equal(read->channel, "ramp");
    noc_image_destroy(read);
    noc_channel_destroy(c);
    unlink(exr);
    unlink(png);
}

static void what_cannot_be(void **state) {
    (void)state;
    noc_log *log = quiet();
    noc_channel *c = ramp(NOC_CHANNEL_LOG, 1, 1);
    static const noc_channel_params wrong[] = { { 2, 1 }, { 0, 1 }, { -1, 1 }, { 1, INFINITY }, { NAN, 1 } };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        uint8_t *rgb = NULL;
        int width, height;
        assert_int_equal(noc_channel_to_srgb8(c, &wrong[i], &rgb, &width, &height, log), NOC_ERR_ARGUMENT);
        assert_null(rgb);
        assert_non_null(strstr(noc_log_last_error(log), "cannot be drawn"));
    }
    assert_int_equal(noc_channel_write(c, "/tmp/a.tiff", NULL, NULL, log), NOC_ERR_UNSUPPORTED);
    assert_int_equal(noc_channel_write(c, "/nowhere/a.exr", NULL, NULL, log), NOC_ERR_IO);
    assert_int_equal(noc_channel_write(c, "/nowhere/a.png", NULL, NULL, log), NOC_ERR_IO);
    assert_null(noc_channel_create(0, 3, 1, log));
    assert_null(noc_channel_create(3, NOC_IMAGE_MAX_SIDE + 1, 1, log));
    assert_null(noc_channel_create(3, 3, 2, log));
    noc_channel_destroy(NULL);
    noc_channel_destroy(c);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_follow_the_bar),
        cmocka_unit_test(ends_are_found),
        cmocka_unit_test(any_numbers),
        cmocka_unit_test(labels),
        cmocka_unit_test(labels_with_names),
        cmocka_unit_test(files),
        cmocka_unit_test(what_cannot_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
