/* Radiance pictures (.hdr), reading: red, green and blue, or CIE X, Y and Z, with a common exponent, a byte each (Ward
 * 1991, "Real Pixels", Graphics Gems II), in any of the eight orders of pixels, lines plain, or in runs as Radiance
 * wrote them before 1991 or since. What EXPOSURE and COLORCORR lines say is taken back, so that numbers are those that
 * were there before. */
#include "image/internal.h"

#include <math.h>

#define LONGEST_HEADER 65536
#define MOST_IN_OLD_RUNS ((size_t)1 << 26) /* pixels of a picture whose lines may all be such runs */

typedef struct hdr_reader {
    const uint8_t *data;
    size_t size, at;
    const char *name;
    noc_log *log;
    double factor[3]; /* that the picture's components were multiplied by */
    bool xyz;
    bool has_space, convert;
    colour_space space;
    double to_working[3][3];
    int width, height;
    bool columns;                 /* lines are columns */
    bool from_bottom, from_right; /* are first */
    size_t line, lines;           /* pixels of one, and how many there are */
    char fault[160];
} hdr_reader;

bool image_is_hdr(const uint8_t *data, size_t size) {
    return size >= 6 && (memcmp(data, "#?RGBE", 6) == 0 || memcmp(data, "#?RADI", 6) == 0);
}

static noc_image *wrong(const hdr_reader *r, const char *what) {
    noc_error(r->log, strstr(what, "not read") ? NOC_ERR_UNSUPPORTED : NOC_ERR_FORMAT, "%s: HDR: %s", r->name, what);
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

/* Exactly so many numbers with blanks between them. */
static bool read_numbers(const char *text, double *to, int count) {
    char number[64];
    for (int i = 0; i < count; i++) {
        text += strspn(text, " \t");
        size_t n = strcspn(text, " \t");
        noc_snprintf(number, sizeof(number), "%.*s", (int)NOC_MIN(n, sizeof(number) - 1), text);
        if (!noc_parse_double(number, &to[i]))
            return false;
        text += n;
    }
    return !text[strspn(text, " \t")];
}

/* Lines multiply each other. */
static bool take_factors(hdr_reader *r, const double by[3]) {
    for (int k = 0; k < 3; k++) {
        if (!(by[k] > 0 && by[k] < 1e30 && r->factor[k] * by[k] > 1e-30 && r->factor[k] * by[k] < 1e30))
            return false;
        r->factor[k] *= by[k];
    }
    return true;
}

static bool is_word(const char *text, const char *word) {
    size_t n = strlen(word);
    return strncmp(text, word, n) == 0 && !text[n + strspn(text + n, " \t")];
}

static const char *take_line(hdr_reader *r, const char *line) {
    const char *text;
    double v[8];
    if ((text = value_of(line, "FORMAT"))) {
        r->xyz = is_word(text, "32-bit_rle_xyze");
        return r->xyz || is_word(text, "32-bit_rle_rgbe")
                   ? NULL
                   : "a format other than 32-bit_rle_rgbe and 32-bit_rle_xyze, which is not read";
    }
    if ((text = value_of(line, "EXPOSURE")))
        return read_numbers(text, v, 1) && take_factors(r, (double[]){ v[0], v[0], v[0] })
                   ? NULL
                   : "an EXPOSURE that is no positive number";
    if ((text = value_of(line, "COLORCORR")))
        return read_numbers(text, v, 3) && take_factors(r, v) ? NULL : "a COLORCORR that is not three positive numbers";
    if ((text = value_of(line, "PRIMARIES"))) {
        r->has_space = read_numbers(text, v, 8);
        memcpy(r->space.xy, v, sizeof(v));
        return r->has_space ? NULL : "PRIMARIES that are not eight numbers";
    }
    if ((text = value_of(line, "GAMMA")) && !(read_numbers(text, v, 1) && v[0] == 1))
        return "a GAMMA other than 1, which is not read";
    return NULL;
}

static bool is_axis(const char *text) {
    return (text[0] == '+' || text[0] == '-') && (text[1] == 'X' || text[1] == 'Y');
}

/* The line behind the header: "-Y 480 +X 640" are rows from the top, each from the left. */
static const char *read_size(hdr_reader *r) {
    char line[200], axis[2][3], rest;
    long long side[2];
    if (!next_line(r, line, sizeof(line)) ||
        sscanf(line, "%2s %9lld %2s %9lld %c", axis[0], &side[0], axis[1], &side[1], &rest) != 4)
        return "its header does not end in its size";
    if (!is_axis(axis[0]) || !is_axis(axis[1]) || axis[0][1] == axis[1][1])
        return "its header does not end in its size";
    if (!(side[0] >= 1 && side[1] >= 1 && side[0] <= NOC_IMAGE_MAX_SIDE && side[1] <= NOC_IMAGE_MAX_SIDE))
        return "its sides are outside 1..32768";
    r->columns = axis[0][1] == 'X';
    r->from_bottom = axis[r->columns][0] == '+';
    r->from_right = axis[!r->columns][0] == '-';
    r->height = (int)side[r->columns];
    r->width = (int)side[!r->columns];
    r->lines = (size_t)side[0];
    r->line = (size_t)side[1];
    return NULL;
}

static const char *read_header(hdr_reader *r) {
    char line[200];
    const char *fault = NULL;
    while (!fault && next_line(r, line, sizeof(line)) && *line)
        fault = take_line(r, line);
    if (fault)
        return fault;
    r->convert = r->xyz || r->has_space; /* PRIMARIES are those of R, G and B */
    if (r->convert)
        fault = r->xyz ? colour_from_xyz(NULL, r->to_working) : colour_from_rgb(&r->space, r->to_working);
    if (!fault)
        return read_size(r);
    noc_snprintf(r->fault, sizeof(r->fault), "PRIMARIES are of no use: %s", fault);
    return r->fault;
}

/* One channel of a line, run by run: a byte over 128 repeats the next one, another copies so many. */
static bool read_runs(hdr_reader *r, uint8_t *to) {
    for (size_t x = 0; x < r->line;) {
        if (r->at >= r->size)
            return false;
        size_t n = r->data[r->at++];
        bool run = n > 128;
        n -= run ? 128 : 0;
        if (!n || n > r->line - x || r->size - r->at < (run ? 1 : n))
            return false;
        if (run)
            memset(to + x, r->data[r->at++], n);
        else
            memcpy(to + x, r->data + r->at, n);
        r->at += run ? 0 : n;
        x += n;
    }
    return true;
}

/* Pixel by pixel; 1, 1, 1, n repeats the one before n times, and another such behind it 256 n times. */
static const char *read_pixels(hdr_reader *r, uint8_t *planes) {
    unsigned shift = 0;
    for (size_t x = 0, n; x < r->line; x += n) {
        if (r->size - r->at < 4)
            return "it ends before its last line";
        const uint8_t *p = r->data + r->at;
        bool run = p[0] == 1 && p[1] == 1 && p[2] == 1;
        n = run ? (size_t)p[3] << shift : 1;
        r->at += 4;
        if (run && x == 0)
            return "a line that begins with a run";
        if (n > r->line - x || shift > 16)
            return "a run that is longer than its line";
        for (size_t k = 0; k < 4; k++)
            memset(planes + k * r->line + x, run ? planes[k * r->line + x - 1] : p[k], n);
        shift = run ? shift + 8 : 0;
    }
    return NULL;
}

/* Into four planes. */
static const char *read_line(hdr_reader *r, uint8_t *planes) {
    const uint8_t *p = r->data + r->at;
    bool by_channel = r->line >= 8 && r->line < 32768 && r->size - r->at >= 4 && p[0] == 2 && p[1] == 2 && p[2] < 128;
    if (!by_channel)
        return read_pixels(r, planes);
    if (((size_t)p[2] << 8 | p[3]) != r->line)
        return "a line of another length than the header says";
    r->at += 4;
    for (size_t k = 0; k < 4; k++)
        if (!read_runs(r, planes + k * r->line))
            return "a line that is cut short, or longer than the picture";
    return NULL;
}

/* The pixels of the k-th line to where they are in the picture. */
static void take_pixels(const hdr_reader *r, const uint8_t *planes, size_t k, float *rgb) {
    for (size_t j = 0; j < r->line; j++) {
        size_t x = r->columns ? k : j, y = r->columns ? j : k;
        x = r->from_right ? (size_t)r->width - 1 - x : x;
        y = r->from_bottom ? (size_t)r->height - 1 - y : y;
        int exponent = planes[3 * r->line + j];
        double unit = exponent ? ldexp(1, exponent - 128 - 8) : 0, from[3], to[3];
        for (size_t i = 0; i < 3; i++) /* the middle of what is rounded to that byte, as Radiance has it */
            from[i] = (planes[i * r->line + j] + 0.5) * unit / r->factor[i];
        if (r->convert)
            colour_apply(r->to_working, from, to);
        for (size_t i = 0; i < 3; i++)
            rgb[3 * (y * (size_t)r->width + x) + i] = (float)(r->convert ? to : from)[i];
    }
}

/* Bytes that a line has at least: what cannot be there gets no memory. Runs by channel have two for 127 pixels of each
 * and four more; those of before 1991 are a pixel and up to two runs, which a small file of great cost could be made
 * of.
 */
static size_t least_line(const hdr_reader *r) {
    bool large = r->line * r->lines > MOST_IN_OLD_RUNS;
    size_t packed = large ? 4 + 8 * ((r->line + 126) / 127) : r->line <= 256 ? 8 : 12;
    return NOC_MIN(4 * r->line, packed);
}

noc_image *image_read_hdr(const uint8_t *data, size_t size, const char *name, noc_log *log) {
    hdr_reader r = { .data = data, .size = size, .name = name, .log = log, .factor = { 1, 1, 1 } };
    const char *fault = read_header(&r);
    if (fault)
        return wrong(&r, fault);
    if ((size - r.at) / least_line(&r) < r.lines)
        return wrong(&r, "its lines cannot be in a file of its size");
    noc_image *image = noc_image_create(r.width, r.height, log);
    uint8_t *planes = image ? noc_alloc(4 * r.line) : NULL;
    if (image && !planes)
        noc_no_memory(log, name);
    for (size_t k = 0; planes && k < r.lines && !fault; k++) {
        fault = read_line(&r, planes);
        if (!fault)
            take_pixels(&r, planes, k, image->rgb);
    }
    if (fault)
        wrong(&r, fault);
    if (fault || !planes) {
        noc_image_destroy(image);
        image = NULL;
    }
    free(planes);
    return image;
}
