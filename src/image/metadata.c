/* What a picture's metadata says, without its pixels: of the file's beginning alone, where the writers of this room put
 * it. */
#include "image/internal.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#define MOST_HEAD (1u << 20) /* bytes that are looked at */

typedef struct head {
    uint8_t *data;
    size_t size;
} head;

/* The text from `at` on up to a zero byte before `end`; *after is behind that. NULL: there is none. */
static const char *text_before(const head *h, size_t at, size_t end, size_t *after) {
    const uint8_t *zero = at < end ? memchr(h->data + at, 0, end - at) : NULL;
    *after = zero ? (size_t)(zero + 1 - h->data) : end;
    return zero ? (const char *)h->data + at : NULL;
}

/* Of a chunk tEXt or iTXt in [at, end) that has this keyword: where its text begins; 0: it is another one, or packed.
 */
static size_t png_value(const head *h, size_t at, size_t end, bool international, const char *key) {
    const char *keyword = text_before(h, at, end, &at);
    if (!keyword || strcmp(keyword, key))
        return 0;
    if (!international)
        return at;
    if (end - at < 2 || h->data[at])
        return 0;
    at += 2;
    const char *language = text_before(h, at, end, &at), *translated = text_before(h, at, end, &at);
    return language && translated ? at : 0;
}

static size_t find_png(const head *h, const char *key, size_t *length) {
    for (size_t at = 8; h->size - at >= 12;) {
        const uint8_t *p = h->data + at;
        size_t size = (size_t)p[0] << 24 | (size_t)p[1] << 16 | (size_t)p[2] << 8 | p[3];
        if (size > h->size - at - 12 || !memcmp(p + 4, "IDAT", 4))
            break;
        bool text = !memcmp(p + 4, "tEXt", 4), international = !memcmp(p + 4, "iTXt", 4);
        size_t value = text || international ? png_value(h, at + 8, at + 8 + size, international, key) : 0;
        if (value) {
            *length = at + 8 + size - value;
            return value;
        }
        at += 12 + size;
    }
    return 0;
}

static size_t find_exr(const head *h, const char *key, size_t *length) {
    const char *name, *type;
    for (size_t at = 8; (name = text_before(h, at, h->size, &at)) && *name;) {
        if (!(type = text_before(h, at, h->size, &at)) || h->size - at < 4)
            break;
        const uint8_t *p = h->data + at;
        size_t size = (size_t)p[0] | (size_t)p[1] << 8 | (size_t)p[2] << 16 | (size_t)p[3] << 24;
        at += 4;
        if (size > h->size - at)
            break;
        if (!strcmp(name, key) && !strcmp(type, "string")) {
            *length = size;
            return at;
        }
        at += size;
    }
    return 0;
}

static noc_status read_head(const char *path, head *h, noc_log *log) {
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    noc_status status = NOC_OK;
    if (fd < 0 || fstat(fd, &st))
        status = noc_error(log, NOC_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    else if (!S_ISREG(st.st_mode))
        status = noc_error(log, NOC_ERR_IO, "%s: not a regular file", path);
    size_t most = status ? 0 : NOC_MIN((size_t)st.st_size, (size_t)MOST_HEAD);
    if (!status && !(h->data = noc_alloc(most + 1)))
        status = noc_no_memory(log, path);
    while (!status && h->size < most) {
        ssize_t n = read(fd, h->data + h->size, most - h->size);
        if (n < 0 && errno != EINTR)
            status = noc_error(log, NOC_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
        else if (n == 0)
            most = h->size; /* it got shorter */
        else
            h->size += n > 0 ? (size_t)n : 0;
    }
    if (fd >= 0)
        close(fd);
    return status;
}

size_t image_find_text(const uint8_t *data, size_t size, const char *key, size_t *length) {
    head h = { (uint8_t *)(uintptr_t)data, size };
    image_format format = size < 8 ? IMAGE_UNKNOWN : image_probe(data, size);
    return format == IMAGE_PNG ? find_png(&h, key, length) : format == IMAGE_EXR ? find_exr(&h, key, length) : 0;
}

noc_status noc_image_read_text(const char *path, const char *key, char **text, noc_log *log) {
    if (!path || !key || !text)
        return noc_null(log, __func__);
    *text = NULL;
    head h = { 0 };
    noc_status status = read_head(path, &h, log);
    image_format format = status ? IMAGE_UNKNOWN : image_probe(h.data, h.size);
    if (!status && (format == IMAGE_UNKNOWN || format == IMAGE_HDR))
        status = noc_error(log, NOC_ERR_FORMAT, "%s: neither a PNG nor an OpenEXR file", path);
    size_t length = 0, at = status ? 0 : image_find_text(h.data, h.size, key, &length);
    if (at && !(*text = noc_strndup((const char *)h.data + at, length)))
        status = noc_no_memory(log, path);
    free(h.data);
    return status;
}
