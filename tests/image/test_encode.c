/* Pictures encoded into memory: what comes back, what is refused, and memory that is. */
#include "../memory.h"

#include "image/internal.h"

#include <math.h>

static noc_log *log_;
static noc_image_encoder *encoder;

enum { W = 65, H = 34 };
static uint8_t picture[3 * W * H];

static int set_up(void **state) {
    log_ = counting_log();
    encoder = noc_image_encoder_create(log_);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int k = 0; k < 3; k++)
                picture[3 * (y * W + x) + k] = (uint8_t)(128 + 90 * sin(x * 0.11 + k) * cos(y * 0.07));
    return encoder ? 0 : -1;
}

static int tear_down(void **state) {
    noc_image_encoder_destroy(encoder);
    noc_log_destroy(log_);
    return 0;
}

static double worst_of(noc_image_codec codec, int quality) {
    const uint8_t *data;
    size_t size;
    pixel_bytes got;
    assert_int_equal(noc_image_encode_srgb8(encoder, codec, quality, picture, W, H, &data, &size), NOC_OK);
    assert_int_equal(pixels_read(data, size, "again", 0, log_, &got), NOC_OK);
    assert_int_equal(got.width, W);
    assert_int_equal(got.height, H);
    double sum = 0;
    for (size_t i = 0; i < sizeof(picture); i++)
        sum += pow((double)got.rgb[i] - picture[i], 2);
    free(got.rgb);
    return sqrt(sum / sizeof(picture));
}

static void png_keeps_every_byte(void **state) {
    assert_true(noc_image_codec_built(NOC_IMAGE_PNG));
    assert_true(worst_of(NOC_IMAGE_PNG, 0) == 0);
    assert_true(worst_of(NOC_IMAGE_PNG, 0) == 0); /* from the same memory */
}

static void jpeg_loses_by_its_quality(void **state) {
    const uint8_t *data;
    size_t size, larger;
    if (!noc_image_codec_built(NOC_IMAGE_JPEG)) {
        assert_int_equal(noc_image_encode_srgb8(encoder, NOC_IMAGE_JPEG, 90, picture, W, H, &data, &size),
                         NOC_ERR_UNSUPPORTED);
        assert_null(data);
        skip();
    }
    assert_int_equal(noc_image_encode_srgb8(encoder, NOC_IMAGE_JPEG, 95, picture, W, H, &data, &larger), NOC_OK);
    assert_int_equal(noc_image_encode_srgb8(encoder, NOC_IMAGE_JPEG, 40, picture, W, H, &data, &size), NOC_OK);
    assert_true(size < larger);
    double fine = worst_of(NOC_IMAGE_JPEG, 95), coarse = worst_of(NOC_IMAGE_JPEG, 40);
    assert_true(fine > 0 && fine < 3 && fine < coarse && coarse < 12);
}

static void what_cannot_be_is_refused(void **state) {
    static const struct {
        noc_image_codec codec;
        int quality, width, height;
        const char *says;
    } wrong[] = {
        { NOC_IMAGE_PNG, 0, 0, 4, "0 x 4 pixels" },      { NOC_IMAGE_PNG, 0, 4, NOC_IMAGE_MAX_SIDE + 1, "pixels" },
        { (noc_image_codec)7, 90, 4, 4, "no codec" },    { NOC_IMAGE_JPEG, 0, 4, 4, "quality is 0, must be in 1..100" },
        { NOC_IMAGE_JPEG, 101, 4, 4, "quality is 101" },
    };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        const uint8_t *data = picture;
        size_t size = 1;
        assert_int_equal(noc_image_encode_srgb8(encoder, wrong[i].codec, wrong[i].quality, picture, wrong[i].width,
                                                wrong[i].height, &data, &size),
                         NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log_), wrong[i].says));
        assert_null(data);
        assert_int_equal(size, 0);
    }
}

static void refused_memory(void **state) {
    for (int codec = NOC_IMAGE_JPEG; codec <= NOC_IMAGE_PNG; codec++) {
        if (!noc_image_codec_built((noc_image_codec)codec))
            continue;
        bool reached;
        FOR_EACH_REFUSAL(reached) {
            const uint8_t *data = NULL;
            size_t size;
            begin_refusal(n, later);
            noc_image_encoder *own = noc_image_encoder_create(log_);
            noc_status status =
                own ? noc_image_encode_srgb8(own, (noc_image_codec)codec, 90, picture, W, H, &data, &size)
                    : NOC_ERR_MEMORY;
            reached = end_refusal();
            if (status)
                assert_refused(status, "encoding");
            assert_true(!status == (data != NULL));
            noc_image_encoder_destroy(own);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(png_keeps_every_byte),
        cmocka_unit_test(jpeg_loses_by_its_quality),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(refused_memory),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
