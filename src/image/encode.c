/* Pictures as bytes in memory: PNG, and JPEG by libjpeg-turbo. */
#include "image/internal.h"

#include "noc_config.h"

#if NOC_HAVE_JPEG
#include <turbojpeg.h>
#endif

struct noc_image_encoder {
    noc_log *log;
    byte_buffer bytes;
    void *jpeg; /* made when it is first needed */
};

noc_image_encoder *noc_image_encoder_create(noc_log *log) {
    noc_image_encoder *encoder = noc_calloc(1, sizeof(*encoder));
    if (encoder)
        encoder->log = log;
    else
        noc_no_memory(log, "encoder of pictures");
    return encoder;
}

bool noc_image_codec_built(noc_image_codec codec) {
    return codec == NOC_IMAGE_PNG || (codec == NOC_IMAGE_JPEG && NOC_HAVE_JPEG);
}

#if NOC_HAVE_JPEG

static void destroy_jpeg(noc_image_encoder *encoder) {
    if (encoder->jpeg)
        tjDestroy(encoder->jpeg);
}

/* Into memory of ours, which holds the largest file that such a picture can become: the library allocates nothing for
 * the file then. */
static noc_status encode_jpeg(noc_image_encoder *encoder, int quality, const uint8_t *rgb, int width, int height) {
    unsigned long size = tjBufSize(width, height, TJSAMP_420);
    byte_buffer *bytes = &encoder->bytes;
    if (!encoder->jpeg && !noc_allocation_refused())
        encoder->jpeg = tjInitCompress();
    if (!encoder->jpeg || !array_reserve(bytes, (size_t)size))
        return noc_no_memory(encoder->log, "JPEG");
    unsigned char *to = bytes->data;
    if (tjCompress2(encoder->jpeg, rgb, width, 0, height, TJPF_RGB, &to, &size, TJSAMP_420, quality,
                    TJFLAG_NOREALLOC | TJFLAG_FASTDCT))
        return noc_error(encoder->log, NOC_ERR_MEMORY, "JPEG: %s", tjGetErrorStr2(encoder->jpeg));
    bytes->len = size;
    return NOC_OK;
}

#else

static void destroy_jpeg(noc_image_encoder *encoder) {}

static noc_status encode_jpeg(noc_image_encoder *encoder, int quality, const uint8_t *rgb, int width, int height) {
    return noc_error(encoder->log, NOC_ERR_UNSUPPORTED, "JPEG, which this build does not write");
}

#endif

void noc_image_encoder_destroy(noc_image_encoder *encoder) {
    if (!encoder)
        return;
    destroy_jpeg(encoder);
    array_free(&encoder->bytes);
    free(encoder);
}

noc_status noc_image_encode_srgb8(noc_image_encoder *encoder, noc_image_codec codec, int quality, const uint8_t *rgb,
                                  int width, int height, const uint8_t **data, size_t *size) {
    if (data)
        *data = NULL;
    if (size)
        *size = 0;
    if (!encoder || !rgb || !data || !size)
        return noc_null(encoder ? encoder->log : NULL, __func__);
    if (!image_size_allowed(width, height))
        return noc_error(encoder->log, NOC_ERR_ARGUMENT, "a picture of %d x %d pixels cannot be encoded", width,
                         height);
    if (codec != NOC_IMAGE_PNG && codec != NOC_IMAGE_JPEG)
        return noc_error(encoder->log, NOC_ERR_ARGUMENT, "there is no codec of pictures %d", (int)codec);
    if (codec == NOC_IMAGE_JPEG && (quality < 1 || quality > 100))
        return noc_error(encoder->log, NOC_ERR_ARGUMENT, "JPEG: quality is %d, must be in 1..100", quality);
    noc_status status = codec == NOC_IMAGE_PNG ? image_encode_png(&encoder->bytes, rgb, width, height, encoder->log)
                                               : encode_jpeg(encoder, quality, rgb, width, height);
    if (status)
        return status;
    *data = encoder->bytes.data;
    *size = encoder->bytes.len;
    return NOC_OK;
}
