/* Pictures that others name: which format, and JPEG by libjpeg-turbo. */
#include "image/pixels.h"

#include "image/internal.h"

#include "noc_config.h"

#if NOC_HAVE_JPEG
#include <turbojpeg.h>
#endif

static bool begins(const uint8_t *data, size_t size, const char *with, size_t length) {
    return size >= length && !memcmp(data, with, length);
}

static bool is_png(const uint8_t *data, size_t size) { return begins(data, size, "\x89PNG\r\n\x1a\n", 8); }
static bool is_jpeg(const uint8_t *data, size_t size) { return begins(data, size, "\xff\xd8\xff", 3); }

static noc_status check_size(const char *name, noc_log *log, int width, int height) {
    if (width >= 1 && height >= 1 && width <= PIXELS_SIDE && height <= PIXELS_SIDE &&
        (size_t)width * (size_t)height <= PIXELS_COUNT)
        return NOC_OK;
    return noc_error(log, NOC_ERR_FORMAT, "%s: %d x %d pixels; up to %d a side and %u in all are read", name, width,
                     height, PIXELS_SIDE, PIXELS_COUNT);
}

static noc_status no_format(const char *name, noc_log *log) {
    return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: neither PNG nor JPEG", name);
}

#if NOC_HAVE_JPEG

static noc_status jpeg_error(tjhandle jpeg, const char *name, noc_log *log) {
    return noc_error(log, NOC_ERR_FORMAT, "%s: JPEG: %s", name, tjGetErrorStr2(jpeg));
}

/* out NULL: the size alone. */
static noc_status read_jpeg(const uint8_t *data, size_t size, const char *name, noc_log *log, int *width, int *height,
                            pixel_bytes *out) {
    tjhandle jpeg = noc_allocation_refused() ? NULL : tjInitDecompress();
    int subsampling, colours;
    if (!jpeg)
        return noc_no_memory(log, name);
    noc_status status = NOC_OK;
    if (tjDecompressHeader3(jpeg, data, size, width, height, &subsampling, &colours))
        status = jpeg_error(jpeg, name, log);
    else
        status = check_size(name, log, *width, *height);
    if (!status && out) {
        out->rgb = noc_alloc_large((size_t)*width * (size_t)*height, 3);
        /* a file of many passes over the picture is refused: it is small, and takes hours */
        if (!out->rgb)
            status = noc_no_memory(log, name);
        else if (tjDecompress2(jpeg, data, size, out->rgb, *width, 0, *height, TJPF_RGB,
                               TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT))
            status = tjGetErrorCode(jpeg) == TJERR_WARNING ? NOC_OK : jpeg_error(jpeg, name, log);
        out->damaged = !status && tjGetErrorCode(jpeg) == TJERR_WARNING;
    }
    tjDestroy(jpeg);
    return status;
}

#else

static noc_status read_jpeg(const uint8_t *data, size_t size, const char *name, noc_log *log, int *width, int *height,
                            pixel_bytes *out) {
    return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: JPEG, which this build does not read", name);
}

#endif

noc_status pixels_size(const uint8_t *data, size_t size, const char *name, noc_log *log, int *width, int *height) {
    if (is_jpeg(data, size))
        return read_jpeg(data, size, name, log, width, height, NULL);
    if (!is_png(data, size))
        return no_format(name, log);
    if (size < 24 || memcmp(data + 12, "IHDR", 4))
        return noc_error(log, NOC_ERR_FORMAT, "%s: PNG: it has no head", name);
    uint32_t side[2];
    for (int i = 0; i < 2; i++) {
        const uint8_t *b = data + 16 + 4 * i;
        side[i] = (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
    }
    *width = (int)NOC_MIN(side[0], (uint32_t)INT32_MAX);
    *height = (int)NOC_MIN(side[1], (uint32_t)INT32_MAX);
    return check_size(name, log, *width, *height);
}

noc_status pixels_read(const uint8_t *data, size_t size, const char *name, int cutoff, noc_log *log, pixel_bytes *out) {
    *out = (pixel_bytes){ 0 };
    noc_status status = pixels_size(data, size, name, log, &out->width, &out->height);
    if (!status && is_jpeg(data, size))
        status = read_jpeg(data, size, name, log, &out->width, &out->height, out);
    else if (!status)
        status = image_read_png8(data, size, name, cutoff, log, out);
    if (status) {
        free(out->rgb);
        free(out->holes);
        out->rgb = out->holes = NULL;
    }
    return status;
}
