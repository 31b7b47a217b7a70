/* Vertices are parsed in double precision, lose the offset, and are written back, with micrometres where they had one.
 */
#include "import/mesh/obj_offset.h"
#include "import/mesh/obj_faces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FAR 4096.0  /* from here on the step of a float is above half a millimetre */
#define SAMPLE 1023 /* vertices that are looked at: their median, so that a stray one at zero does not decide */
#define MOST 1e12   /* m; what the fixed decimals below hold */
#define MOST_FLOAT 1e38
#define MOST_PLACE 1e6 /* noc_mesh.uv */
#define NUMBER_SIZE 24 /* "-1000000000000.000000" and a blank */

#define MOST_NUMBERS 7 /* in a vertex: place, weight or colour, and one too many */

/* Behind a keyword. */
static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\\'; }

static bool is_vertex(const char *line, const char *end) {
    return end - line >= 2 && line[0] == 'v' && is_blank(line[1]);
}

static bool is_place(const char *line, const char *end) {
    return end - line >= 3 && line[0] == 'v' && line[1] == 't' && is_blank(line[2]);
}

/* A number as every parser reads it: no sign but -, a digit first. */
static bool is_plain(const char *p, const char *end) {
    while (p < end && (*p == ' ' || *p == '\t'))
        p++;
    p += p < end && *p == '-';
    return p < end && *p >= '0' && *p <= '9';
}

/* Numbers behind a keyword of so many letters; how many. *plain: the text says just that, in plain numbers. */
static int parse_numbers(const char *line, const char *end, int keyword, double v[MOST_NUMBERS], bool *plain) {
    char joined[512];
    size_t length = (size_t)(end - line);
    *plain = *line == 'v' && !memchr(line, '\\', length);
    if (!*plain && length < sizeof(joined)) { /* lines that backslashes join */
        for (size_t i = 0; i < length; i++)
            joined[i] = line[i] == '\\' || line[i] == '\n' || line[i] == '\r' ? ' ' : line[i];
        line = joined;
        end = joined + length;
    }
    const char *remark = memchr(line, '#', (size_t)(end - line)), *p = line + keyword, *next;
    int n = 0;
    for (end = remark ? remark : end; n < MOST_NUMBERS && (next = noc_scan_double(p, end, &v[n])); p = next) {
        *plain = *plain && is_plain(p, end) && isfinite(v[n]);
        n++;
    }
    while (p < end && (*p == ' ' || *p == '\t' || *p == '\r'))
        p++;
    *plain = *plain && p == end && !remark;
    return n;
}

/* The place of a vertex; false, and zeros, where it has none. */
static bool parse_vertex(const char *line, const char *end, double xyz[3], bool *plain) {
    double v[MOST_NUMBERS];
    int n = parse_numbers(line, end, 1, v, plain);
    double w = n == 4 ? v[3] : 1; /* a homogeneous vertex; five numbers and more are a colour behind the place */
    bool good = n >= 3 && w != 0;
    *plain = *plain && (n == 3 || n == 6);
    for (int k = 0; k < 3 && good; k++)
        good = fabs(xyz[k] = v[k] / w) < MOST_FLOAT; /* false for NaN, too */
    if (!good)
        memset(xyz, 0, 3 * sizeof(*xyz));
    *plain = *plain && good;
    return good;
}

/* The same of a place in a texture. One number is that of a texture along a line. */
static bool parse_place(const char *line, const char *end, double uv[2], bool *plain) {
    double v[MOST_NUMBERS] = { 0 };
    int n = parse_numbers(line, end, 2, v, plain);
    bool good = n >= 1 && n <= 3 && fabs(v[0]) < MOST_PLACE && fabs(v[1]) < MOST_PLACE; /* false for NaN, too */
    uv[0] = good ? v[0] : 0;
    uv[1] = good && n > 1 ? v[1] : 0;
    *plain = *plain && good && n >= 2;
    return good;
}

/* The next statement without its indent; *end is behind its last byte, *next where the one after it begins. */
static const char *next_statement(const char *p, const char *stop, const char **end, const char **next) {
    *end = obj_statement_end(p, stop);
    *next = *end < stop ? *end + 1 : stop;
    while (p < *end && (*p == ' ' || *p == '\t'))
        p++;
    return p;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Finds the offset, and whether all vertices are plain already. */
static void find_offset(const char *data, size_t size, bool places, double offset[3], bool *plain) {
    double sample[3][SAMPLE];
    size_t n = 0;
    *plain = true;
    for (const char *p = data, *stop = data + size, *end, *next; p < stop && (n < SAMPLE || *plain); p = next) {
        const char *line = next_statement(p, stop, &end, &next);
        double xyz[3];
        bool this_plain;
        if (places && is_place(line, end)) {
            parse_place(line, end, xyz, &this_plain);
            *plain = *plain && this_plain && line == p;
        }
        if (!is_vertex(line, end))
            continue;
        bool good = parse_vertex(line, end, xyz, &this_plain);
        *plain = *plain && this_plain && line == p;
        if (n == SAMPLE || !good)
            continue;
        for (int k = 0; k < 3; k++)
            sample[k][n] = xyz[k];
        n++;
    }
    for (int k = 0; k < 3 && n; k++) {
        qsort(sample[k], n, sizeof(double), by_value);
        double median = sample[k][n / 2];
        offset[k] = fabs(median) >= FAR && fabs(median) <= MOST ? round(median) : 0;
    }
}

static char *write_fixed(char *out, double x) {
    char digits[NUMBER_SIZE];
    int n = 0;
    uint64_t u = (uint64_t)llround(fabs(x) * 1e6);
    *out++ = ' ';
    if (x < 0 && u)
        *out++ = '-';
    while (u || n < 7) {
        if (n == 6)
            digits[n++] = '.';
        digits[n++] = (char)('0' + u % 10);
        u /= 10;
        if (n == 8 && !u)
            break;
    }
    while (n)
        *out++ = digits[--n];
    return out;
}

typedef struct text_buffer {
    char *data;
    size_t size, cap;
} text_buffer;

static bool reserve(text_buffer *b, size_t more) {
    if (b->cap - b->size >= more)
        return true;
    size_t cap = b->cap + b->cap / 4 + more;
    char *grown = noc_realloc(b->data, cap);
    if (!grown)
        return false;
    b->data = grown;
    b->cap = cap;
    return true;
}

/* " x y z" less the offset; room for 3 * NUMBER_SIZE is there. */
static char *write_place(char *to, const double xyz[3], const double offset[3]) {
    for (int k = 0; k < 3; k++) {
        double x = xyz[k] - offset[k];
        if (offset[k] != 0 && fabs(x) <= MOST)
            to = write_fixed(to, x);
        else
            to += noc_snprintf(to, NUMBER_SIZE, " %.9g", x); /* what a float holds */
    }
    return to;
}

noc_status obj_plain_vertices(char **data, size_t *size, bool places, double offset[3], obj_numbers *bad,
                              geo_issues *issues, const char *name, noc_log *log) {
    memset(offset, 0, 3 * sizeof(*offset));
    bool plain;
    find_offset(*data, *size, places, offset, &plain);
    if (plain && offset[0] == 0 && offset[1] == 0 && offset[2] == 0)
        return NOC_OK;
    text_buffer out = { 0 };
    size_t line_number = 1;
    long long number = 0;
    bool memory = reserve(&out, *size + 1);
    for (const char *p = *data, *stop = *data + *size, *end, *next; p < stop && memory; p = next) {
        const char *line = next_statement(p, stop, &end, &next), *from = line;
        memory = reserve(&out, (size_t)(next - line) + 3 * NUMBER_SIZE + 2);
        bool rewritten = memory && places && is_place(line, end);
        if (rewritten) {
            double uv[2];
            if (!parse_place(line, end, uv, &plain)) {
                char id[32];
                snprintf(id, sizeof(id), "line %zu", line_number);
                geo_issue(issues, GEO_GUESSED, "texture coordinates that are no numbers, taken as 0", id);
            }
            out.size += (size_t)noc_snprintf(out.data + out.size, 3 * NUMBER_SIZE, "vt %.9g %.9g", uv[0], uv[1]);
        } else if (memory && is_vertex(line, end)) {
            double xyz[3];
            number++;
            if (!parse_vertex(line, end, xyz, &plain)) {
                char id[32];
                snprintf(id, sizeof(id), "line %zu", line_number);
                geo_issue(issues, GEO_SKIPPED, "vertex that is not three numbers", id);
                memory = array_push(bad, number);
            }
            out.data[out.size] = 'v';
            out.size = (size_t)(write_place(out.data + out.size + 1, xyz, offset) - out.data);
            rewritten = true;
        }
        for (; rewritten && from < end; from++) /* joined lines stay that many */
            if (*from == '\n')
                out.data[out.size++] = '\n';
        for (const char *c = p; c < next; c++)
            line_number += *c == '\n';
        if (memory) {
            memcpy(out.data + out.size, from, (size_t)(next - from));
            out.size += (size_t)(next - from);
        }
    }
    if (!memory) {
        free(out.data);
        return noc_no_memory(log, name);
    }
    out.data[out.size] = 0;
    free(*data);
    *data = out.data;
    *size = out.size;
    return NOC_OK;
}
