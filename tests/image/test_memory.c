/* Memory that is refused to the reading and writing of pictures: each allocation, alone and with all later ones. It
 * ends in NOC_ERR_MEMORY and one message, and leaves no file. */
#include "../files.h"
#include "../memory.h"

#include "image/internal.h"

static char folder[200];
static noc_log *log_;

static const char *path_of(const char *name) {
    static char path[300];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static noc_image *picture(float shift) {
    noc_image *image = noc_image_create(40, 30, log_);
    assert_non_null(image);
    assert_true(image_add_mask(image, log_));
    for (int i = 0; i < 40 * 30 * 3; i++)
        image->rgb[i] = shift + (float)(i % 17);
    image->emitter[7] = 1;
    return image;
}

static const noc_image_meta meta = { 2, (const char *const[]){ "Title", "place" },
                                     (const char *const[]){ "a night", "48.1 \xc2\xb0N" } };

static void writing(void **state) {
    static const char *const names[] = { "a.png", "a.exr" };
    noc_image *image = picture(0.5f);
    for (size_t i = 0; i < NOC_COUNT(names); i++) {
        bool reached;
        FOR_EACH_REFUSAL(reached) {
            begin_refusal(n, later);
            noc_status status = noc_image_write(image, path_of(names[i]), NULL, &meta, log_);
            reached = end_refusal();
            if (status == NOC_OK)
                assert_unharmed(true, names[i]); /* what killed runs left is not looked for */
            else
                assert_refused(status, names[i]);
            assert_int_equal(files_in(folder), status == NOC_OK);
            if (status == NOC_OK) {
                noc_image *again = noc_image_read(path_of(names[i]), log_, NULL);
                assert_non_null(again);
                noc_image_destroy(again);
                unlink(path_of(names[i]));
            }
        }
    }
    noc_image_destroy(image);
}

static void reading(void **state) {
    static const char *const names[] = { "a.png", "a.exr" };
    noc_image *image = picture(0.5f);
    for (size_t i = 0; i < NOC_COUNT(names); i++) {
        assert_int_equal(noc_image_write(image, path_of(names[i]), NULL, &meta, log_), NOC_OK);
        noc_image *whole = noc_image_read(path_of(names[i]), log_, NULL);
        bool reached;
        FOR_EACH_REFUSAL(reached) {
            begin_refusal(n, later);
            noc_image *read = noc_image_read(path_of(names[i]), log_, NULL);
            reached = end_refusal();
            if (read)
                assert_unharmed(!memcmp(read->rgb, whole->rgb, 40 * 30 * 3 * sizeof(float)), names[i]);
            else
                assert_refused(NOC_ERR_MEMORY, names[i]);
            assert_true(reached ? !read : read != NULL);
            noc_image_destroy(read);
        }
        noc_image_destroy(whole);
        unlink(path_of(names[i]));
    }
    noc_image_destroy(image);
}

static noc_status compare(const noc_image *x, const noc_image *r, noc_channel *channel) {
    noc_comparison comparison;
    uint8_t *rgb = NULL;
    int width, height;
    noc_status status = noc_image_compare(x, r, NULL, &comparison, log_);
    if (!status)
        status = noc_image_difference(x, r, NULL, &rgb, &width, &height, log_);
    if (!status)
        status = noc_image_write_srgb8(rgb, width, height, path_of("d.png"), &meta, log_);
    free(rgb);
    if (!status)
        status = noc_channel_write(channel, path_of("c.png"), NULL, &meta, log_);
    if (!status)
        status = noc_channel_write(channel, path_of("c.exr"), NULL, &meta, log_);
    return status;
}

static void comparing_and_channels(void **state) {
    noc_image *x = picture(0.5f), *r = picture(0.75f);
    noc_channel *channel = noc_channel_create(40, 30, 1, log_);
    assert_non_null(channel);
    channel->value[3] = 5;
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = compare(x, r, channel);
        reached = end_refusal();
        if (status == NOC_OK)
            assert_unharmed(true, "comparing");
        else
            assert_refused(status, "comparing");
        unlink(path_of("d.png"));
        unlink(path_of("c.png"));
        unlink(path_of("c.exr"));
        assert_int_equal(files_in(folder), 0);
    }
    noc_channel_destroy(channel);
    noc_image_destroy(x);
    noc_image_destroy(r);
}

/* What has no log to tell it says it by its value. */
static void made_and_shown(void **state) {
    noc_image *image = picture(0.5f);
    uint8_t rgb[40 * 30 * 3] = { 99 };
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_image *made = noc_image_create(4, 3, log_);
        if (!made)
            assert_refused(NOC_ERR_MEMORY, "image");
        noc_image_destroy(made);
        reached = end_refusal();
        begin_refusal(n, later);
        noc_channel *channel = noc_channel_create(4, 3, 3, log_);
        if (!channel)
            assert_refused(NOC_ERR_MEMORY, "channel");
        noc_channel_destroy(channel);
        reached = end_refusal() || reached;
    }
    begin_refusal(1, true);
    double ev100 = noc_image_auto_ev100(image);
    noc_status status = noc_image_to_srgb8(image, NULL, rgb);
    end_refusal();
    assert_true(ev100 != ev100);
    assert_int_equal(status, NOC_ERR_MEMORY);
    assert_int_equal(rgb[0], 99);
    assert_int_equal(noc_image_to_srgb8(image, NULL, rgb), NOC_OK);
    noc_image_destroy(image);
}

static int make_folder(void **state) {
    snprintf(folder, sizeof(folder), "/tmp/noc-image-memory-XXXXXX");
    log_ = counting_log();
    return !mkdtemp(folder);
}

static int remove_folder(void **state) {
    noc_log_destroy(log_);
    return rmdir(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(writing), cmocka_unit_test(reading),
                                        cmocka_unit_test(comparing_and_channels), cmocka_unit_test(made_and_shown) };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
