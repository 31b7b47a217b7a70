/* What files say of themselves, without their pixels. */
#include "../files.h"
#include "../memory.h"

#include "image/internal.h"

#include <fcntl.h>
#include <sys/stat.h>

static char folder[200] = "/tmp/noc-metadata-XXXXXX";

static int make_folder(void **state) { return mkdtemp(folder) ? 0 : -1; }
static int remove_folder(void **state) { return rmdir(folder); }

static const char *path_of(const char *name) {
    static char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static const char *const names[] = { "a.png", "a.exr" };
static const char *const keys[] = { "Title", "place", "nothing" };
static const char *const values[] = { "a night", "48.1 \xc2\xb0N", "" };

static void write_pictures(noc_log *log) {
    noc_image *image = noc_image_create(9, 5, log);
    for (size_t i = 0; i < NOC_COUNT(names); i++)
        assert_int_equal(noc_image_write(image, path_of(names[i]), NULL, &(noc_image_meta){ 3, keys, values }, log),
                         NOC_OK);
    noc_image_destroy(image);
}

static void remove_pictures(void) {
    for (size_t i = 0; i < NOC_COUNT(names); i++)
        assert_int_equal(unlink(path_of(names[i])), 0);
}

static void what_was_written_is_read(void **state) {
    write_pictures(NULL);
    for (size_t i = 0; i < NOC_COUNT(names); i++) {
        char *text;
        for (size_t k = 0; k < 3; k++) {
            assert_int_equal(noc_image_read_text(path_of(names[i]), keys[k], &text, NULL), NOC_OK);
            assert_string_equal(text, values[k]);
            free(text);
        }
        assert_int_equal(noc_image_read_text(path_of(names[i]), "Titl", &text, NULL), NOC_OK);
        assert_null(text);
        assert_int_equal(noc_image_read_text(path_of(names[i]), "channels", &text, NULL), NOC_OK);
        assert_null(text); /* of another type */
    }
    remove_pictures();
    (void)state;
}

/* Cut short anywhere, and with any byte changed, a file says what it said, something else or nothing. */
static void broken_files_are_read_as_far_as_they_go(void **state) {
    write_pictures(NULL);
    for (size_t i = 0; i < NOC_COUNT(names); i++) {
        uint8_t data[4096];
        FILE *f = fopen(path_of(names[i]), "rb");
        size_t size = fread(data, 1, sizeof(data), f), found = 0;
        fclose(f);
        for (size_t cut = 0; cut < 2 * size; cut++) {
            f = fopen(path_of("cut"), "wb");
            if (cut >= size)
                data[cut - size] ^= 0xff;
            fwrite(data, 1, cut < size ? cut : size, f);
            if (cut >= size)
                data[cut - size] ^= 0xff;
            fclose(f);
            char *text;
            noc_status status = noc_image_read_text(path_of("cut"), "place", &text, NULL);
            assert_true(status == NOC_OK || (status == NOC_ERR_FORMAT && !text));
            found += text && !strcmp(text, values[1]);
            free(text);
        }
        assert_true(found > size / 2 && found < 2 * size);
    }
    unlink(path_of("cut"));
    remove_pictures();
    (void)state;
}

static void other_files_are_refused_once(void **state) {
    noc_log *log = counting_log();
    char *text;
    assert_int_equal(mkfifo(path_of("pipe"), 0600), 0);
    FILE *f = fopen(path_of("text"), "wb");
    fputs("a text", f);
    fclose(f);
    static const struct {
        const char *name;
        noc_status status;
    } files[] = { { "none", NOC_ERR_IO }, { "pipe", NOC_ERR_IO }, { "", NOC_ERR_IO }, { "text", NOC_ERR_FORMAT } };
    for (size_t i = 0; i < NOC_COUNT(files); i++) {
        refusing.errors = 0;
        assert_int_equal(noc_image_read_text(path_of(files[i].name), "a", &text, log), files[i].status);
        assert_true(refusing.errors == 1 && !text);
    }
    unlink(path_of("pipe"));
    unlink(path_of("text"));
    noc_log_destroy(log);
    (void)state;
}

static void memory_is_refused(void **state) {
    noc_log *log = counting_log();
    write_pictures(log);
    for (size_t i = 0; i < NOC_COUNT(names); i++) {
        bool reached;
        FOR_EVERY_REFUSAL(reached) {
            char *text;
            begin_refusal(n, later);
            noc_status status = noc_image_read_text(path_of(names[i]), "Title", &text, log);
            reached = end_refusal();
            if (status)
                assert_refused(status, names[i]);
            assert_true(!text == (status != NOC_OK));
            free(text);
        }
    }
    remove_pictures();
    noc_log_destroy(log);
    (void)state;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_written_is_read),
        cmocka_unit_test(broken_files_are_read_as_far_as_they_go),
        cmocka_unit_test(other_files_are_refused_once),
        cmocka_unit_test(memory_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
