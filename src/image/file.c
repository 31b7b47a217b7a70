/* Reading and writing picture files: which format, and whole files to memory. */
#include "image/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

bool image_path_ends_in(const char *path, const char *ending) {
    size_t n = strlen(path), m = strlen(ending);
    return n > m && noc_ieq(path + n - m, ending);
}

static noc_status bad_ending(const char *path, const char *endings, noc_log *log) {
    return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: the name's ending does not tell a format: use %s", path, endings);
}

bool image_size_allowed(int width, int height) {
    return width >= 1 && height >= 1 && width <= NOC_IMAGE_MAX_SIDE && height <= NOC_IMAGE_MAX_SIDE;
}

/* Not-a-number and infinity never reach a file: black is written in their place, and said. */
static void warn_non_finite(const noc_image *image, const char *path, noc_log *log) {
    size_t bad = 0, n = image_pixels(image);
    for (size_t i = 0; i < n; i++)
        bad += !image_finite(image->rgb + 3 * i);
    if (bad)
        noc_warn(log, "%s: %zu of %zu pixels are not finite and are written as 0", path, bad, n);
}

static noc_status write_png(const uint8_t *rgb, int width, int height, const char *path, const meta_list *meta,
                            noc_log *log) {
    output o;
    noc_status status = output_open(&o, path, log);
    if (status != NOC_OK)
        return status;
    return output_close(&o, image_write_png(&o, rgb, width, height, meta, log), log);
}

static noc_status write_exr(const noc_image *image, const char *path, const meta_list *meta, noc_log *log) {
    output o;
    noc_status status = output_open(&o, path, log);
    if (status != NOC_OK)
        return status;
    return output_close(&o, image_write_exr(&o, image, meta, log), log);
}

static noc_status write_displayed(const noc_image *image, const char *path, const noc_display_params *display,
                                  const meta_list *meta, noc_log *log) {
    uint8_t *rgb = noc_alloc_large(image_pixels(image), 3);
    if (!rgb)
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", path, image->width, image->height);
    noc_status status = noc_image_to_srgb8(image, display, rgb); /* with an exposure that was metered before */
    if (status == NOC_OK)
        status = write_png(rgb, image->width, image->height, path, meta, log);
    free(rgb);
    return status;
}

noc_status noc_image_write(const noc_image *image, const char *path, const noc_display_params *display,
                           const noc_image_meta *meta, noc_log *log) {
    if (!image || !path)
        return noc_null(log, __func__);
    if (!image_size_allowed(image->width, image->height))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a picture of %d x %d pixels cannot be written", path, image->width,
                         image->height);
    bool png = image_path_ends_in(path, ".png");
    if (!png && !image_path_ends_in(path, ".exr"))
        return bad_ending(path, ".png or .exr", log);
    noc_display_params shown = display ? *display : noc_display_default_params();
    double ev100 = 0;
    if (png && !display_ev100(image, &shown, &ev100))
        return noc_no_memory(log, path);
    meta_list list = { 0 };
    meta_add(&list, "Software", "Nocturne %s", NOC_VERSION);
    if (png) {
        /* The exposure in effect, so that what is shown can be traced back to cd/m2. */
        shown.auto_exposure = false;
        shown.ev100 = ev100;
        meta_add(&list, "ev100", "%.4f", ev100);
        meta_add(&list, "tonemap", "%s", tonemap_name(shown.tonemap));
        meta_add(&list, "white-balance", "%g K", display_white(&shown));
    } else {
        meta_add(&list, "units", "cd/m2");
    }
    if (image->smoothed)
        meta_add(&list, "smoothed", "for display");
    if (image->smoothed && image->smoothed_error > 0)
        meta_add(&list, "smoothed-error", "%.2g", image->smoothed_error);
    noc_status status = meta_add_all(&list, meta, path, log);
    if (status == NOC_OK) {
        warn_non_finite(image, path, log);
        status = png ? write_displayed(image, path, &shown, &list, log) : write_exr(image, path, &list, log);
    }
    meta_free(&list);
    return status;
}

noc_status noc_image_write_srgb8(const uint8_t *rgb, int width, int height, const char *path,
                                 const noc_image_meta *meta, noc_log *log) {
    if (!rgb || !path)
        return noc_null(log, __func__);
    if (!image_size_allowed(width, height))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a picture of %d x %d pixels cannot be written", path, width,
                         height);
    if (!image_path_ends_in(path, ".png"))
        return bad_ending(path, ".png", log);
    meta_list list = { 0 };
    meta_add(&list, "Software", "Nocturne %s", NOC_VERSION);
    noc_status status = meta_add_all(&list, meta, path, log);
    if (status == NOC_OK)
        status = write_png(rgb, width, height, path, &list, log);
    meta_free(&list);
    return status;
}

image_format image_probe(const uint8_t *data, size_t size) {
    static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' }, exr[4] = { 0x76, 0x2f, 0x31, 0x01 };
    if (size >= sizeof(png) && memcmp(data, png, sizeof(png)) == 0)
        return IMAGE_PNG;
    if (size >= sizeof(exr) && memcmp(data, exr, sizeof(exr)) == 0)
        return IMAGE_EXR;
    return image_is_hdr(data, size) ? IMAGE_HDR : IMAGE_UNKNOWN;
}

noc_image *image_read_memory(const uint8_t *data, size_t size, const char *name, noc_log *log, bool *is_linear) {
    image_format f = image_probe(data, size);
    if (is_linear)
        *is_linear = f == IMAGE_EXR || f == IMAGE_HDR;
    if (f == IMAGE_PNG)
        return image_read_png(data, size, name, log);
    if (f == IMAGE_EXR)
        return image_read_exr(data, size, name, log);
    if (f == IMAGE_HDR)
        return image_read_hdr(data, size, name, log);
    noc_error(log, NOC_ERR_FORMAT, "%s: not a PNG, OpenEXR or Radiance HDR file", name);
    return NULL;
}

/* The whole file; its first bytes are looked at before the rest is given memory. */
static uint8_t *read_file(FILE *file, const char *path, size_t *size, noc_log *log) {
    struct stat st;
    uint8_t head[8];
    if (fstat(fileno(file), &st) != 0 || (!S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode))) {
        noc_error(log, NOC_ERR_IO, "%s: not a regular file", path);
        return NULL;
    }
    size_t got = fread(head, 1, sizeof(head), file);
    if (ferror(file)) {
        noc_error(log, NOC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
        return NULL;
    }
    if (image_probe(head, got) == IMAGE_UNKNOWN) {
        noc_error(log, NOC_ERR_FORMAT, "%s: not a PNG, OpenEXR or Radiance HDR file", path);
        return NULL;
    }
    *size = NOC_MAX((size_t)st.st_size, got); /* a file may grow meanwhile, and those of /proc have a size of 0 */
    uint8_t *data = noc_alloc_large(*size, 1);
    if (!data) {
        noc_error(log, NOC_ERR_MEMORY, "%s: no memory for its %zu bytes", path, *size);
        return NULL;
    }
    memcpy(data, head, got);
    if (fread(data + got, 1, *size - got, file) != *size - got) {
        noc_error(log, NOC_ERR_IO, "%s: cannot be read: %s", path, ferror(file) ? strerror(errno) : "it got shorter");
        free(data);
        return NULL;
    }
    return data;
}

noc_image *noc_image_read(const char *path, noc_log *log, bool *is_linear) {
    if (!path) {
        noc_null(log, __func__);
        return NULL;
    }
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe without a writer must not block */
    FILE *file = fd >= 0 ? fdopen(fd, "rb") : NULL;
    if (!file) {
        noc_error(log, NOC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
        if (fd >= 0)
            close(fd);
        return NULL;
    }
    size_t size;
    uint8_t *data = read_file(file, path, &size, log);
    fclose(file);
    if (!data)
        return NULL;
    noc_image *image = image_read_memory(data, size, path, log, is_linear);
    free(data);
    return image;
}
