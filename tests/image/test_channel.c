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
    assert_true(s.width == W && s.height == H + colorbar_height(NULL, 1));
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

/* The legend stands apart at the same pixels, and its numbers, and the colours, can be asked for. */
static void parts(void **state) {
    (void)state;
    noc_channel *c = ramp(NOC_CHANNEL_LOG, 0.6f, 1);
    static const noc_channel_part kinds[] = { NOC_CHANNEL_WHOLE, NOC_CHANNEL_PICTURE, NOC_CHANNEL_LEGEND };
    shown s[3];
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_channel_to_srgb8(c, &(noc_channel_params){ .part = kinds[i] }, &s[i].rgb, &s[i].width,
                                              &s[i].height, NULL),
                         NOC_OK);
    assert_true(s[1].height == H && s[2].height == colorbar_height(NULL, 1) && s[0].height == H + s[2].height);
    assert_memory_equal(s[0].rgb, s[1].rgb, (size_t)3 * W * H);
    assert_memory_equal(s[0].rgb + 3 * W * H, s[2].rgb, (size_t)3 * W * s[2].height);
    noc_bar bar;
    assert_int_equal(noc_channel_bar(c, NULL, &bar, NULL), NOC_OK);
    assert_true(bar.logarithmic && bar.low == 1 && bar.high == 300 && bar.tick_count >= 3 && !bar.isoline_count);
    for (int i = 0; i < bar.tick_count; i++)
        assert_true(bar.ticks[i] >= 1 && bar.ticks[i] <= 300 && (!i || bar.ticks[i] > bar.ticks[i - 1]));
    const noc_channel_params widest = { 5e-324, 1.7e308, .scale = NOC_BAR_LOG };
    assert_int_equal(noc_channel_bar(c, &widest, &bar, NULL), NOC_OK);
    assert_true(bar.tick_count >= 3);
    for (int i = 1; i < bar.tick_count; i++)
        assert_true(bar.ticks[i] > bar.ticks[i - 1]);
    assert_int_equal(noc_channel_bar(c, NULL, &bar, NULL), NOC_OK);
    for (int i = 0; i < W; i += 7) {
        uint8_t rgb[3];
        noc_bar_colour(log(c->value[i] / bar.low) / log(bar.high / bar.low), rgb);
        for (int k = 0; k < 3; k++)
            assert_true(abs(rgb[k] - s[1].rgb[3 * i + k]) < 3);
    }
    for (int i = 0; i < 3; i++)
        free(s[i].rgb);
    shown wide;
    assert_int_equal(noc_channel_to_srgb8(c, &(noc_channel_params){ .part = NOC_CHANNEL_LEGEND, .legend_width = 700 },
                                          &wide.rgb, &wide.width, &wide.height, NULL),
                     NOC_OK);
    assert_int_equal(wide.width, 700);
    free(wide.rgb);
    c->scale = NOC_CHANNEL_LABELS;
    assert_int_equal(noc_channel_to_srgb8(c, NULL, &wide.rgb, &wide.width, &wide.height, NULL), NOC_OK);
    for (int i = 0; i < W; i++) {
        uint8_t rgb[3];
        noc_label_colour(i % 2 ? c : NULL, (uint32_t)c->value[i], rgb);
        assert_true(is(&wide, i, rgb));
    }
    free(wide.rgb);
    noc_channel_destroy(c);
}

/* A scale that is not the channel's. */
static void other_scales(void **state) {
    (void)state;
    noc_channel *lin = ramp(NOC_CHANNEL_LINEAR, 1, 1), *log_ = ramp(NOC_CHANNEL_LOG, 1, 1);
    for (int i = 0; i < 2; i++) {
        shown a, b;
        noc_channel *from = i ? lin : log_;
        assert_int_equal(noc_channel_to_srgb8(from, &(noc_channel_params){ .scale = i ? NOC_BAR_LOG : NOC_BAR_LINEAR },
                                              &a.rgb, &a.width, &a.height, NULL),
                         NOC_OK);
        assert_int_equal(noc_channel_to_srgb8(i ? log_ : lin, NULL, &b.rgb, &b.width, &b.height, NULL), NOC_OK);
        assert_memory_equal(a.rgb, b.rgb, (size_t)3 * a.width * a.height);
        free(a.rgb);
        free(b.rgb);
    }
    noc_channel_destroy(lin);
    noc_channel_destroy(log_);
}

/* Pixels of letters in a legend between two rows and two columns. */
static int letters(const shown *s, int y0, int y1, int x0, int x1) {
    int count = 0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            count += s->rgb[3 * (y * s->width + x)] == 224;
    return count;
}

/* A bar with lines says both of its ends, and has a second row for numbers that would touch others. */
static void numbers_of_lines(void **state) {
    (void)state;
    static const noc_isolines lines[] = { { { 5, 20 }, .count = 2 }, { { 5, 5.3, 20 }, .count = 3 } };
    const colorbar bar = { .line_count = 1 };
    int top = colorbar_height(NULL, 1) - 6, bottom = colorbar_height(&bar, 1) - 6;
    noc_channel *c = ramp(NOC_CHANNEL_LOG, 0.6f, 1);
    for (int i = 0; i < 2; i++) {
        shown s;
        const noc_channel_params p = { 1, 300, .isolines = lines[i], .part = NOC_CHANNEL_LEGEND };
        assert_int_equal(noc_channel_to_srgb8(c, &p, &s.rgb, &s.width, &s.height, NULL), NOC_OK);
        assert_int_equal(s.height, bottom + 6);
        assert_true(letters(&s, top - TEXT_HEIGHT, top, 0, 40) && letters(&s, top - TEXT_HEIGHT, top, W - 40, W));
        assert_int_equal(letters(&s, top, bottom, 0, W) > 0, i);
        free(s.rgb);
    }
    noc_channel_destroy(c);
}

/* Lines lie where numbers pass their values, through noise too, and not at steps; the legend's bar is wide enough. */
static void isolines(void **state) {
    (void)state;
    enum { SIDE = 260 };
    noc_channel *c = noc_channel_create(SIDE, SIDE, 1, NULL);
    assert_non_null(c);
    c->name = c->title = "slope";
    uint32_t h = 1;
    for (int i = 0; i < SIDE * SIDE; i++) { /* 0.25 a pixel to the right, and a step of 100 below the middle */
        h = h * 1664525u + 1013904223u;
        c->value[i] = 0.25f * (float)(i % SIDE) + (i / SIDE < SIDE / 2 ? 0 : 100) + 0.05f * (float)(h >> 24) / 255;
    }
    noc_channel_params p = { .isolines = { { 20, 40, 400 }, .count = 3 }, .part = NOC_CHANNEL_PICTURE };
    uint8_t *rgb[2];
    int width, height;
    assert_int_equal(noc_channel_to_srgb8(c, &p, &rgb[0], &width, &height, NULL), NOC_OK);
    noc_bar bar;
    assert_int_equal(noc_channel_bar(c, &p, &bar, NULL), NOC_OK);
    assert_true(bar.high >= 400 && bar.isoline_count == 3 && bar.isolines[2] == 400);
    p = (noc_channel_params){ bar.low, bar.high, .part = NOC_CHANNEL_PICTURE };
    assert_int_equal(noc_channel_to_srgb8(c, &p, &rgb[1], &width, &height, NULL), NOC_OK);
    int at[2] = { 0 }, lower = 0, stray = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        if (!memcmp(rgb[0] + 3 * i, rgb[1] + 3 * i, 3))
            continue;
        if (y > SIDE / 2 + 8)
            lower++;
        else if (abs(x - 80) <= 2)
            at[0]++;
        else if (abs(x - 160) <= 2)
            at[1]++;
        else
            stray++;
    }
    assert_true(at[0] > SIDE / 2 - 20 && at[1] > SIDE / 2 - 20);
    assert_int_equal(lower, 0);
    assert_true(stray < 400); /* the two values that are written beside them */
    free(rgb[0]);
    free(rgb[1]);
    assert_int_equal(noc_channel_bar(c, &(noc_channel_params){ .isolines.round = 5 }, &bar, NULL), NOC_OK);
    assert_true(bar.isoline_count >= 2 && bar.isoline_count <= 5 && bar.isolines[0] > 0);
    noc_channel_destroy(c);
}

/* Words of isolines: what is read is written so that the same is read again; what is no such words changes nothing. */
static void isolines_in_words(void **state) {
    static const struct {
        const char *text, *written;
        int count, round;
    } good[] = { { "5,7.5,10,20", "5,7.5,10,20", 4, 0 },
                 { "5,", "5,", 1, 0 },
                 { "6", "6", 0, 6 },
                 { "0", "0", 0, 0 },
                 { "0.1,", "0.1,", 1, 0 },
                 { "1,2,", "1,2", 2, 0 },
                 { "1e-3,1e3", "0.001,1000", 2, 0 } };
    static const char *const wrong[] = { "",    ",",  "5,3", "5,5", "0,1",  "-1,1",  "-1",
                                         "2.5", "33", "lx",  "1;2", "1,,2", "nan,1", "1,inf" };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        noc_isolines lines;
        char text[200];
        assert_true(noc_isolines_parse(good[i].text, &lines));
        assert_true(lines.count == good[i].count && lines.round == good[i].round);
        assert_int_equal(noc_isolines_text(&lines, text, sizeof(text)), strlen(good[i].written));
        assert_string_equal(text, good[i].written);
    }
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        noc_isolines lines = { { 7 }, .count = 1 };
        if (noc_isolines_parse(wrong[i], &lines))
            fail_msg("\"%s\" was read", wrong[i]);
        assert_true(lines.count == 1 && lines.value[0] == 7);
    }
    char many[40 * NOC_ISOLINES] = "";
    noc_isolines all = { .count = NOC_ISOLINES }, read;
    for (int i = 0; i < NOC_ISOLINES; i++)
        all.value[i] = 1e-5 * (i + 1) + 1.0 / 3e7;
    assert_true(noc_isolines_text(&all, many, sizeof(many)) < (int)sizeof(many));
    assert_true(noc_isolines_parse(many, &read) && read.count == NOC_ISOLINES);
    strcat(many, ",9");
    assert_false(noc_isolines_parse(many, &read));
}

/* Ends of a bar that follows numbers: they stay through noise, and go along when the numbers leave them. */
static void bars_settle(void **state) {
    (void)state;
    for (int logarithmic = 0; logarithmic < 2; logarithmic++) {
        noc_bar last = { .low = 0 }, now;
        noc_channel_params p = { .last = &last };
        static const float highest[] = { 90, 104, 93, 118, 40, 101 }; /* of numbers from 0.9 up */
        for (size_t i = 0; i < NOC_COUNT(highest); i++) {
            noc_channel *c =
                ramp(logarithmic ? NOC_CHANNEL_LOG : NOC_CHANNEL_LINEAR, 0.9f, (highest[i] - 0.9f) / (W - 1));
            assert_int_equal(noc_channel_bar(c, &p, &now, NULL), NOC_OK);
            if (i)
                assert_true(now.low == last.low && now.high == last.high);
            shown s;
            assert_int_equal(noc_channel_to_srgb8(c, &p, &s.rgb, &s.width, &s.height, NULL), NOC_OK);
            free(s.rgb);
            last = now;
            noc_channel_destroy(c);
        }
        static const float other[] = { 400, 20 };
        for (size_t i = 0; i < 2; i++) {
            noc_channel *c =
                ramp(logarithmic ? NOC_CHANNEL_LOG : NOC_CHANNEL_LINEAR, 0.9f, (other[i] - 0.9f) / (W - 1));
            noc_bar anew;
            assert_int_equal(noc_channel_bar(c, &p, &now, NULL), NOC_OK);
            assert_int_equal(noc_channel_bar(c, NULL, &anew, NULL), NOC_OK);
            assert_true(now.high == anew.high && now.low == anew.low && now.high != last.high);
            last = now;
            noc_channel_destroy(c);
        }
    }
}

/* Names of some labels alone: those stand in the legend, in the colour that they would have without. */
static void names_of_some(void **state) {
    (void)state;
    static const char *const names[] = { "lamp 7", "lamp 200", "not seen" };
    static const uint32_t numbers[] = { 7, 200, 5000 };
    noc_channel *c = ramp(NOC_CHANNEL_LABELS, 0, 1);
    shown plain, named;
    assert_int_equal(noc_channel_to_srgb8(c, NULL, &plain.rgb, &plain.width, &plain.height, NULL), NOC_OK);
    c->labels = names;
    c->label_numbers = numbers;
    c->label_count = 3;
    assert_int_equal(noc_channel_to_srgb8(c, NULL, &named.rgb, &named.width, &named.height, NULL), NOC_OK);
    assert_memory_equal(plain.rgb, named.rgb, (size_t)3 * W * H);
    for (int i = 0; i < W; i++) {
        bool there = false;
        for (int k = W * H; k < named.width * named.height; k++)
            there |= is(&named, k, named.rgb + 3 * i);
        assert_int_equal(there, i == 7 || i == 200);
    }
    free(plain.rgb);
    free(named.rgb);
    noc_channel_destroy(c);
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
    assert_true(read && !linear && read->width == W && read->height == H + colorbar_height(NULL, 1));
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
    static const noc_channel_params no_lines[] = { { .isolines = { { 2, 1 }, .count = 2 } },
                                                   { .isolines = { { 0 }, .count = 1 } },
                                                   { .isolines = { { 1, 2 }, .count = -1 } },
                                                   { .isolines = { { 1, 2 }, .count = NOC_ISOLINES + 1 } },
                                                   { .isolines.round = -1 },
                                                   { .isolines.round = NOC_ISOLINES + 1 } };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        uint8_t *rgb = NULL;
        int width, height;
        assert_int_equal(noc_channel_to_srgb8(c, &wrong[i], &rgb, &width, &height, log), NOC_ERR_ARGUMENT);
        assert_null(rgb);
        assert_non_null(strstr(noc_log_last_error(log), "cannot be drawn"));
    }
    noc_bar bar;
    for (size_t i = 0; i < NOC_COUNT(no_lines); i++) {
        assert_int_equal(noc_channel_bar(c, &no_lines[i], &bar, log), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), "isolines are"));
    }
    c->scale = NOC_CHANNEL_LABELS;
    assert_int_equal(noc_channel_bar(c, NULL, &bar, log), NOC_ERR_ARGUMENT);
    c->scale = NOC_CHANNEL_LOG;
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
        cmocka_unit_test(names_of_some),
        cmocka_unit_test(parts),
        cmocka_unit_test(other_scales),
        cmocka_unit_test(isolines),
        cmocka_unit_test(numbers_of_lines),
        cmocka_unit_test(isolines_in_words),
        cmocka_unit_test(bars_settle),
        cmocka_unit_test(files),
        cmocka_unit_test(what_cannot_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
