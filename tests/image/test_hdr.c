/* Radiance pictures: what bytes stand for, both ways in which rows are written, and what is refused. */
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
    uint8_t data[4096];
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

static void what_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *head;
        const char *body;
        size_t size;
        noc_status status;
        const char *message;
    } cases[] = {
        { "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_UNSUPPORTED, "32-bit_rle_rgbe" },
        { "#?RADIANCE\n\n+Y 1 +X 1\n", "abcd", 4, NOC_ERR_UNSUPPORTED, "from the top" },
        { "#?RADIANCE\n\n-Y 1 +X 0\n", "abcd", 4, NOC_ERR_FORMAT, "outside 1..32768" },
        { "#?RADIANCE\n\n-Y 1 +X 1 2\n", "abcd", 4, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "EXPOSURE" },
        { "#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "EXPOSURE" },
        { "#?RADIANCE\n", "", 0, NOC_ERR_FORMAT, "does not end in its size" },
        { "#?RADIANCE\n\n-Y 2 +X 1\n", "abcd", 4, NOC_ERR_FORMAT, "cannot be in a file" },
        { "#?RADIANCE\n\n-Y 32768 +X 32768\n", "abcd", 4, NOC_ERR_FORMAT, "cannot be in a file" },
        { "#?RADIANCE\n\n-Y 1 +X 2\n", "abcd\1\1\1\1", 8, NOC_ERR_UNSUPPORTED, "before 1991" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\x8b\1\x8a\1\x8a\1\x8a\1", 12, NOC_ERR_FORMAT,
          "longer than the picture" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\x8a\1\x8a\1\x8a\1\5a", 12, NOC_ERR_FORMAT, "cut short" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "\2\2\0\xa\0\1\x8a\1\x8a\1\x8a\1", 12, NOC_ERR_FORMAT, "cut short" },
        { "#?RADIANCE\n\n-Y 1 +X 10\n", "abcdabcdabcdabcd", 16, NOC_ERR_FORMAT, "ends before its last row" },
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
        cmocka_unit_test(numbers),           cmocka_unit_test(rows_in_runs),
        cmocka_unit_test(what_is_refused),   cmocka_unit_test(longer_than_its_size),
        cmocka_unit_test(memory_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
