/* Radiance pictures: what bytes stand for, how lines are written and which way they go, colours, and what is refused.
 */
#include "../test.h"
#include "../memory.h"

#include "image/internal.h"

#include <math.h>
#include <sys/prctl.h>

static char last_error[400];
static int error_count;

static void hear(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level == NOC_LOG_ERROR) {
        error_count++;
        snprintf(last_error, sizeof(last_error), "%s", text);
    }
}

typedef struct file {
    uint8_t data[32768];
    size_t size;
} file;

static void add(file *f, const void *bytes, size_t n) {
    assert_true(f->size + n <= sizeof(f->data));
    memcpy(f->data + f->size, bytes, n);
    f->size += n;
}
static void add_text(file *f, const char *text) { add(f, text, strlen(text)); }

static noc_image *read_file(const file *f, noc_status *status) {
    uint8_t *copy = malloc(f->size + 1); /* so that reading beyond its end is seen */
    noc_log *log = noc_log_create(&(noc_log_params){ .message = hear });
    memcpy(copy, f->data, f->size);
    error_count = 0;
    bool linear = false;
    noc_image *image = image_read_memory(copy, f->size, "test", log, &linear);
    assert_int_equal(error_count, !image);
    assert_true(!image || linear);
    *status = image ? NOC_OK : noc_log_last_status(log);
    noc_log_destroy(log);
    free(copy);
    return image;
}

static noc_image *read_well(const file *f) {
    noc_status status;
    noc_image *image = read_file(f, &status);
    if (!image)
        fail_msg("%s", last_error);
    return image;
}

/* (m + 1/2) 2^(e - 136), over the product of exposures; an exponent of 0 is black. */
static void numbers(void **state) {
    (void)state;
    static const uint8_t pixels[] = { 128, 64, 0, 129, 255, 255, 255, 128, 9, 9, 9, 0, 200, 1, 3, 140 };
    file f = { .size = 0 };
    add_text(&f, "#?RADIANCE\n# a remark\nEXPOSURE=4\nFORMAT=32-bit_rle_rgbe\r\nEXPOSURE= .5\n\n-Y 2 +X 2\n");
    add(&f, pixels, sizeof(pixels));
    noc_image *image = read_well(&f);
    assert_int_equal(image->width, 2);
    assert_int_equal(image->height, 2);
    const double want[] = { 128.5 / 128, 64.5 / 128, 0.5 / 128, 255.5 / 256, 255.5 / 256, 255.5 / 256,
                            0,           0,          0,         200.5 * 16,  1.5 * 16,    3.5 * 16 };
    for (int i = 0; i < 12; i++)
        assert_true(image->rgb[i] == (float)(want[i] / 2));
    noc_image_destroy(image);
}

/* A row in runs is the row; #?RGBE is as good a beginning. */
static void rows_in_runs(void **state) {
    (void)state;
    static const uint8_t runs[] = {
        2, 2, 0, 10, 138, 7, 3, 1, 2, 3, 135, 9, 10, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 138, 130
    };
    file packed = { .size = 0 }, plain = { .size = 0 };
    add_text(&packed, "#?RGBE\n\n-Y 1 +X 10\n");
    add_text(&plain, "#?RGBE\n\n-Y 1 +X 10\n");
    add(&packed, runs, sizeof(runs));
    for (int x = 0; x < 10; x++)
        add(&plain, (uint8_t[]){ 7, (uint8_t)(x < 3 ? x + 1 : 9), (uint8_t)(x + 1), 130 }, 4);
    noc_image *a = read_well(&packed), *b = read_well(&plain);
    assert_memory_equal(a->rgb, b->rgb, 30 * sizeof(float));
    noc_image_destroy(a);
    noc_image_destroy(b);
}

static void near(const noc_image *image, int at, double r, double g, double b, double tolerance) {
    const double want[] = { r, g, b };
    for (int k = 0; k < 3; k++)
        if (!(fabs(image->rgb[3 * at + k] - want[k]) <= tolerance))
            fail_msg("pixel %d: %g, not %g", at, image->rgb[3 * at + k], want[k]);
}

/* Runs of before 1991: n of the pixel before, and behind that 256 n, and the flat line that they are. */
static void old_runs(void **state) {
    (void)state;
    file f = { .size = 0 };
    add_text(&f, "#?RADIANCE\n\n-Y 2 +X 600\n");
    add(&f, (uint8_t[]){ 128, 64, 0, 129, 1, 1, 1, 86, 1, 1, 1, 2, 9, 9, 9, 129 }, 16);   /* 1 + 86 + 512, and one */
    add(&f, (uint8_t[]){ 2, 2, 200, 129, 2, 2, 201, 129, 1, 1, 1, 3, 4, 4, 4, 129 }, 16); /* no line by channel */
    add(&f, (uint8_t[]){ 1, 1, 1, 81, 1, 1, 1, 2, 8, 8, 8, 129 }, 12);
    noc_image *image = read_well(&f);
    for (int x = 0; x < 599; x++)
        near(image, x, 128.5 / 128, 64.5 / 128, .5 / 128, 0);
    near(image, 599, 9.5 / 128, 9.5 / 128, 9.5 / 128, 0);
    near(image, 600, 2.5 / 128, 2.5 / 128, 200.5 / 128, 0);
    for (int x = 601; x < 605; x++)
        near(image, x, 2.5 / 128, 2.5 / 128, 201.5 / 128, 0);
    for (int x = 605; x < 1199; x++)
        near(image, x, 4.5 / 128, 4.5 / 128, 4.5 / 128, 0);
    near(image, 1199, 8.5 / 128, 8.5 / 128, 8.5 / 128, 0);
    noc_image_destroy(image);
}

/* Pixels of 3 columns and 2 rows, numbered as they follow each other in the file. */
static void eight_orders(void **state) {
    (void)state;
    static const struct {
        const char *size;
        uint8_t at[6]; /* from the top left on, rows from the top: which of the file */
    } cases[] = { { "-Y 2 +X 3", { 0, 1, 2, 3, 4, 5 } }, { "-Y 2 -X 3", { 2, 1, 0, 5, 4, 3 } },
                  { "+Y 2 +X 3", { 3, 4, 5, 0, 1, 2 } }, { "+Y 2 -X 3", { 5, 4, 3, 2, 1, 0 } },
                  { "+X 3 -Y 2", { 0, 2, 4, 1, 3, 5 } }, { "+X 3 +Y 2", { 1, 3, 5, 0, 2, 4 } },
                  { "-X 3 -Y 2", { 4, 2, 0, 5, 3, 1 } }, { "-X 3 +Y 2", { 5, 3, 1, 4, 2, 0 } } };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        file f = { .size = 0 };
        add_text(&f, "#?RADIANCE\nVIEW= -vtv -vh 45 -vv 30\n\n");
        add_text(&f, cases[i].size);
        add_text(&f, "\n");
        for (int k = 0; k < 6; k++)
            add(&f, (uint8_t[]){ (uint8_t)(128 + k), 0, 0, 136 }, 4);
        noc_image *image = read_well(&f);
        assert_int_equal(image->width, 3);
        assert_int_equal(image->height, 2);
        for (int k = 0; k < 6; k++)
            if (image->rgb[3 * k] != (float)(128.5 + cases[i].at[k]))
                fail_msg("%s: pixel %d is %g", cases[i].size, k, image->rgb[3 * k]);
        noc_image_destroy(image);
    }
}

/* A column of 9 in runs by channel, beside one that is all of one pixel. */
static void columns_in_runs(void **state) {
    (void)state;
    file f = { .size = 0 };
    add_text(&f, "#?RADIANCE\n\n+X 2 +Y 9\n");
    add(&f, (uint8_t[]){ 2, 2, 0, 9, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9, 137, 0, 137, 0, 137, 136 }, 20);
    add(&f, (uint8_t[]){ 2, 2, 0, 9, 137, 7, 137, 0, 137, 0, 137, 136 }, 12);
    noc_image *image = read_well(&f);
    for (int y = 0; y < 9; y++) {
        near(image, 2 * y, 9 - y + .5, .5, .5, 0);
        near(image, 2 * y + 1, 7.5, .5, .5, 0);
    }
    noc_image_destroy(image);
}

/* Both kinds of lines multiply each other, whichever comes first. */
static void colour_corrections(void **state) {
    (void)state;
    file f = { .size = 0 };
    add_text(&f, "#?RADIANCE\nCOLORCORR= 2 1 .5\nEXPOSURE=4\nCOLORCORR=\t1 4  1 \n\n-Y 1 +X 1\n");
    add(&f, (uint8_t[]){ 128, 128, 128, 136 }, 4);
    noc_image *image = read_well(&f);
    near(image, 0, 128.5 / 8, 128.5 / 16, 128.5 / 2, 0);
    noc_image_destroy(image);
}

/* X, Y, Z of .94922, .99609, 1.08984 by Lindbloom's matrix for sRGB, and R, G, B of ACEScg by the Academy's. */
static void other_colours(void **state) {
    (void)state;
    file f = { .size = 0 };
    add_text(&f, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\nEXPOSURE=2\n\n-Y 1 +X 1\n");
    add(&f, (uint8_t[]){ 121, 127, 139, 129 }, 4);
    noc_image *image = read_well(&f);
    near(image, 0, .50072, .49696, .50090, 5e-4);
    noc_image_destroy(image);
    f.size = 0;
    add_text(&f, "#?RADIANCE\nPRIMARIES= .713 .293 .165 .83 .128 .044 .32168 .33767\nFORMAT=32-bit_rle_rgbe\n"
                 "\n-Y 1 +X 2\n");
    add(&f, (uint8_t[]){ 200, 100, 50, 136, 99, 99, 99, 136 }, 8);
    image = read_well(&f);
    near(image, 0, 1.70505 * 200.5 - .62179 * 100.5 - .08326 * 50.5, -.13026 * 200.5 + 1.1408 * 100.5 - .01055 * 50.5,
         -.024 * 200.5 - .12897 * 100.5 + 1.15297 * 50.5, .01);
    near(image, 1, 99.5, 99.5, 99.5, 1e-4);
    noc_image_destroy(image);
    f.size = 0; /* Rec. 709 said aloud */
    add_text(&f, "#?RADIANCE\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3127 .329\n\n-Y 1 +X 1\n");
    add(&f, (uint8_t[]){ 200, 100, 50, 136 }, 4);
    image = read_well(&f);
    near(image, 0, 200.5, 100.5, 50.5, 1e-4);
    noc_image_destroy(image);
}

static void what_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *head;
        const char *body;
        size_t size;
        noc_status status;
        const char *message;
    } cases[] = {
        { "#?RADIANCE\nFORMAT=32-bit_rle_luve\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_UNSUPPORTED, "32-bit_rle_rgbe" },
        { "#?RADIANCE\nGAMMA=2.2\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_UNSUPPORTED, "GAMMA" },
        { "#?RADIANCE\n\n+Y 1 -Y 1\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\n- 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\nY 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\n+Z 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\n-Y -1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "outside 1..32768" },
        { "#?RADIANCE\n\n-Y 1 +X 32769\n", "abcd", 4, NOC_ERR_FORMAT, "outside 1..32768" },
        { "#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "COLORCORR" },
        { "#?RADIANCE\nCOLORCORR=1 1 0\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "COLORCORR" },
        { "#?RADIANCE\nPRIMARIES=1 0 0 1 0 0 .3\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "eight numbers" },
        { "#?RADIANCE\nPRIMARIES=1 0 0 1 0 0 .3 .3 .3\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "eight numbers" },
        { "#?RADIANCE\nPRIMARIES=1 0 0 1 .5 .5 .3 .3\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "on one line" },
        { "#?RADIANCE\nPRIMARIES=1 0 0 1 0 0 .3 0\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "no luminance" },
        { "#?RADIANCE\n\n-Y 1 +X 0\n", "abcd", 4, NOC_ERR_FORMAT, "outside 1..32768" },
        { "#?RADIANCE\n\n-Y 1 +X 1 2\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "EXPOSURE" },
        { "#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "EXPOSURE" },
        { "#?RADIANCE\n", "", 0, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\n-Y 2 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "cannot be in a file" },
        { "#?RADIANCE\n\n-Y 32768 +X 32768\n", "abcd", 4, NOC_ERR_FORMAT, "cannot be in a file" },
        { "#?RADIANCE\n\n-Y 1 +X 2\n", "\1\1\1\1abcd", 8, NOC_ERR_FORMAT, "begins with a run" },
        { "#?RADIANCE\n\n-Y 1 +X 2\n", "abcd\1\1\1\2", 8, NOC_ERR_FORMAT, "longer than its line" },
        { "#?RADIANCE\n\n-Y 1 +X 9\n", "abcd\1\1\1\1\1\1\1\1", 12, NOC_ERR_FORMAT, "longer than its line" },
        { "#?RADIANCE\n\n-Y 1 +X 9\n", "abcd\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\1", 20, NOC_ERR_FORMAT,
          "longer than its line" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xb\x8a\1\x8a\1\x8a\1\x8a\1", 12, NOC_ERR_FORMAT, "another length" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\x8b\1\x8a\1\x8a\1\x8a\1", 12, NOC_ERR_FORMAT,
          "longer than the picture" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\x8a\1\x8a\1\x8a\1\5a", 12, NOC_ERR_FORMAT, "cut short" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\0\1\x8a\1\x8a\1\x8a\1", 12, NOC_ERR_FORMAT, "cut short" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "abcdabcdabcdabcd", 16, NOC_ERR_FORMAT, "ends before its last line" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        file f = { .size = 0 };
        noc_status status;
        add_text(&f, cases[i].head);
        add(&f, cases[i].body, cases[i].size);
        assert_null(read_file(&f, &status));
        if (status != cases[i].status || !strstr(last_error, cases[i].message))
            fail_msg("case %zu: status %d, %s", i, status, last_error);
    }
}

/* Lines of 12 bytes for 32,768 pixels make 2,048 of them, and no more: 400 kB would become 13 GB. */
static void old_runs_have_an_end(void **state) {
    (void)state;
    for (int lines = 2048; lines <= 2049; lines++) {
        file f = { .size = 0 };
        noc_status status;
        add_text(&f, lines == 2048 ? "#?RADIANCE\n\n-Y 2048 +X 32768\n" : "#?RADIANCE\n\n-Y 2049 +X 32768\n");
        for (int y = 0; y < lines; y++) /* the first one is too long: memory is all that is asked for here */
            add(&f, (uint8_t[]){ 9, 9, 9, 129, 1, 1, 1, 255, 1, 1, 1, 128 }, 12);
        assert_null(read_file(&f, &status));
        assert_int_equal(status, NOC_ERR_FORMAT);
        assert_non_null(strstr(last_error, lines == 2048 ? "longer than its line" : "cannot be in a file"));
    }
}

/* One that holds more than its size said, as if it had grown meanwhile: the name of this thread. */
static void longer_than_its_size(void **state) {
    (void)state;
    char before[16];
    noc_log *log = noc_log_create(&(noc_log_params){ .message = hear });
    assert_int_equal(prctl(PR_GET_NAME, before), 0);
    assert_int_equal(prctl(PR_SET_NAME, "#?RADIANCE"), 0);
    assert_null(noc_image_read("/proc/thread-self/comm", log, NULL));
    assert_non_null(strstr(last_error, "HDR: its header does not end"));
    assert_int_equal(prctl(PR_SET_NAME, before), 0);
    noc_log_destroy(log);
}

static void memory_is_refused(void **state) {
    (void)state;
    file f = { .size = 0 };
    noc_status status = NOC_ERR_MEMORY;
    add_text(&f, "#?RADIANCE\n\n-Y 1 +X 1\nabcd");
    for (uint64_t n = 3; status; n++) { /* behind those of the log */
        noc_refuse_allocation(n, false);
        noc_image *image = read_file(&f, &status);
        noc_refuse_allocation(0, false);
        noc_image_destroy(image);
        assert_true(status == NOC_OK || status == NOC_ERR_MEMORY);
        assert_true(n < 20);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers),
        cmocka_unit_test(rows_in_runs),
        cmocka_unit_test(old_runs),
        cmocka_unit_test(eight_orders),
        cmocka_unit_test(columns_in_runs),
        cmocka_unit_test(colour_corrections),
        cmocka_unit_test(other_colours),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(old_runs_have_an_end),
        cmocka_unit_test(longer_than_its_size),
        cmocka_unit_test(memory_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
