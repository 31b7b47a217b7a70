/* Radiance pictures (.hdr), reading: red, green and blue with a common exponent, a byte each (Ward 1991, "Real Pixels",
 * Graphics Gems II), rows plain or run by run as Radiance has written them since 1991. What EXPOSURE lines say is taken
 * back, so that numbers are those that were there before. */
#include "image/internal.h"

#include <math.h>

#define LONGEST_HEADER 65536

typedef struct hdr_reader {
    const uint8_t *data;
    size_t size, at;
    const char *name;
    noc_log *log;
    double exposure;
    int width, height;
} hdr_reader;

bool image_is_hdr(const uint8_t *data, size_t size) {
    return size >= 6 && (memcmp(data, "#?RGBE", 6) == 0 || memcmp(data, "#?RADI", 6) == 0);
}

static noc_image *wrong(const hdr_reader *r, noc_status status, const char *what) {
    noc_error(r->log, status, "%s: HDR: %s", r->name, what);
    return NULL;
}

/* The next line of the header, without its end; false where there is none. Longer ones are cut. */
static bool next_line(hdr_reader *r, char *line, size_t room) {
    size_t most = NOC_MIN(r->size, (size_t)LONGEST_HEADER), n = 0;
    if (r->at >= most)
        return false;
    const uint8_t *from = r->data + r->at, *end = memchr(from, '\n', most - r->at);
    if (!end)
        return false;
    n = (size_t)(end - from);
    r->at += n + 1;
    n -= n && from[n - 1] == '\r';
    n = NOC_MIN(n, room - 1);
    memcpy(line, from, n);
    line[n] = 0;
    return !memchr(line, 0, n);
}

/* A line's value where it is of that key. */
static const char *value_of(const char *line, const char *key) {
    size_t n = strlen(key);
    return strncmp(line, key, n) == 0 && line[n] == '=' ? line + n + 1 + strspn(line + n + 1, " \t") : NULL;
}

static const char *read_header(hdr_reader *r) {
    char line[200];
    const char *text;
    double v;
    while (next_line(r, line, sizeof(line)) && *line) {
        if ((text = value_of(line, "FORMAT")) && strncmp(text, "32-bit_rle_rgbe", 15))
            return "a format other than 32-bit_rle_rgbe, which is not read";
        if ((text = value_of(line, "EXPOSURE"))) {
            if (!noc_parse_double(text, &v) ||
                !(v > 0 && v < 1e30 && r->exposure * v > 1e-30 && r->exposure * v < 1e30))
                return "an EXPOSURE that is no positive number";
            r->exposure *= v;
        }
    }
    long long height, width;
    char sign_y[3], sign_x[3], rest;
    if (!next_line(r, line, sizeof(line)) ||
        sscanf(line, "%2s %9lld %2s %9lld %c", sign_y, &height, sign_x, &width, &rest) != 4)
        return "its header does not end in its size";
    if (strcmp(sign_y, "-Y") || strcmp(sign_x, "+X"))
        return "rows that do not go from the top, or not from the left, which is not read";
    if (!(width >= 1 && height >= 1 && width <= NOC_IMAGE_MAX_SIDE && height <= NOC_IMAGE_MAX_SIDE))
        return "its sides are outside 1..32768";
    r->width = (int)width;
    r->height = (int)height;
    return NULL;
}

/* One channel of a row, run by run: a byte over 128 repeats the next one, another copies so many. */
static bool read_runs(hdr_reader *r, uint8_t *to) {
    for (int x = 0; x < r->width;) {
        if (r->at >= r->size)
            return false;
        int n = r->data[r->at++];
        bool run = n > 128;
        n -= run ? 128 : 0;
        if (!n || n > r->width - x || r->size - r->at < (run ? 1u : (size_t)n))
            return false;
        if (run)
            memset(to + x, r->data[r->at++], (size_t)n);
        else
            memcpy(to + x, r->data + r->at, (size_t)n);
        r->at += run ? 0 : (size_t)n;
        x += n;
    }
    return true;
}

/* Into four planes. */
static const char *read_row(hdr_reader *r, uint8_t *planes) {
    size_t left = r->size - r->at, width = (size_t)r->width;
    const uint8_t *p = r->data + r->at;
    if (width >= 8 && width < 32768 && left >= 4 && p[0] == 2 && p[1] == 2 && p[2] == width >> 8 &&
        p[3] == (width & 255)) {
        r->at += 4;
        for (size_t k = 0; k < 4; k++)
            if (!read_runs(r, planes + k * width))
                return "a row that is cut short, or longer than the picture is wide";
        return NULL;
    }
    if (left < 4 * width)
        return "it ends before its last row";
    for (size_t x = 0; x < width; x++, p += 4) {
        if (p[0] == 1 && p[1] == 1 && p[2] == 1)
            return "runs as before 1991, which are not read";
        for (size_t k = 0; k < 4; k++)
            planes[k * width + x] = p[k];
    }
    r->at += 4 * width;
    return NULL;
}

static void take_row(const hdr_reader *r, const uint8_t *planes, float *rgb) {
    size_t width = (size_t)r->width;
    for (size_t x = 0; x < width; x++) {
        int exponent = planes[3 * width + x];
        double unit = exponent ? ldexp(1, exponent - 128 - 8) / r->exposure : 0;
        for (size_t k = 0; k < 3; k++) /* the middle of what is rounded to that byte, as Radiance has it */
            rgb[3 * x + k] = (float)((planes[k * width + x] + 0.5) * unit);
    }
}

noc_image *image_read_hdr(const uint8_t *data, size_t size, const char *name, noc_log *log) {
    hdr_reader r = { .data = data, .size = size, .name = name, .log = log, .exposure = 1 };
    const char *fault = read_header(&r);
    if (fault)
        return wrong(&r, strstr(fault, "not read") ? NOC_ERR_UNSUPPORTED : NOC_ERR_FORMAT, fault);
    /* a row of runs has two bytes for 127 pixels of a channel, and four more: what cannot be there gets no memory */
    size_t least = NOC_MIN(4 * (size_t)r.width, 4 + 8 * (((size_t)r.width + 126) / 127));
    if ((size - r.at) / least < (size_t)r.height)
        return wrong(&r, NOC_ERR_FORMAT, "its rows cannot be in a file of its size");
    noc_image *image = noc_image_create(r.width, r.height, log);
    uint8_t *planes = image ? noc_alloc(4 * (size_t)r.width) : NULL;
    if (image && !planes)
        noc_no_memory(log, name);
    for (int y = 0; planes && y < r.height && !fault; y++) {
        fault = read_row(&r, planes);
        if (!fault)
            take_row(&r, planes, image->rgb + 3 * (size_t)y * (size_t)r.width);
    }
    if (fault)
        wrong(&r, strstr(fault, "not read") ? NOC_ERR_UNSUPPORTED : NOC_ERR_FORMAT, fault);
    if (fault || !planes) {
        noc_image_destroy(image);
        image = NULL;
    }
    free(planes);
    return image;
}
