/* Vertices are parsed in double precision, lose the offset, and are written back with micrometres. */
#include "import/obj_offset.h"

#include <math.h>
#include <stdlib.h>

#define FAR 4096.0     /* from here on the step of a float is above half a millimetre */
#define SAMPLE 1023    /* vertices that are looked at: their median, so that a stray one at zero does not decide */
#define MOST 1e12      /* m; what the fixed decimals below hold */
#define NUMBER_SIZE 24 /* "-1000000000000.000000" and a blank */

typedef struct vertex_line {
    const char *rest;  /* behind the three numbers */
    double xyz[3], w;  /* w: weight of a homogeneous vertex, 1 where there is none */
} vertex_line;

static bool is_vertex(const char *line, const char *end) {
    return end - line > 2 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t');
}

static bool parse_vertex(const char *line, const char *end, vertex_line *v) {
    const char *p = line + 1;
    for (int k = 0; k < 3; k++)
        if (!(p = noc_scan_double(p, end, &v->xyz[k])) || fabs(v->xyz[k]) > MOST)
            return false;
    v->rest = p;
    double fifth;
    /* four numbers: the fourth is a weight; six: a colour follows */
    p = noc_scan_double(p, end, &v->w);
    if (!p || noc_scan_double(p, end, &fifth))
        v->w = 1;
    return true;
}

/* The next line's beginning without its indent; *end is behind its last byte, *next where the one after it begins. */
static const char *next_line(const char *p, const char *stop, const char **end, const char **next) {
    const char *newline = memchr(p, '\n', (size_t)(stop - p));
    *end = newline ? newline : stop;
    *next = newline ? newline + 1 : stop;
    while (p < *end && (*p == ' ' || *p == '\t'))
        p++;
    return p;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool find_offset(const char *data, size_t size, double offset[3]) {
    double sample[3][SAMPLE];
    size_t n = 0;
    for (const char *p = data, *stop = data + size, *end, *next; p < stop && n < SAMPLE; p = next) {
        const char *line = next_line(p, stop, &end, &next);
        vertex_line v;
        if (!is_vertex(line, end))
            continue;
        if (!parse_vertex(line, end, &v))
            return false;
        for (int k = 0; k < 3; k++)
            sample[k][n] = v.xyz[k] / (v.w != 0 ? v.w : 1);
        n++;
    }
    bool any = false;
    for (int k = 0; k < 3 && n; k++) {
        qsort(sample[k], n, sizeof(double), by_value);
        double median = sample[k][n / 2];
        offset[k] = fabs(median) >= FAR && fabs(median) <= MOST ? round(median) : 0;
        any |= offset[k] != 0;
    }
    return any;
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
    char *grown = realloc(b->data, cap); /* the file's author decides how much: no abort */
    if (!grown)
        return false;
    b->data = grown;
    b->cap = cap;
    return true;
}

noc_status obj_take_offset(char **data, size_t *size, double offset[3], const char *name, noc_log *log) {
    memset(offset, 0, 3 * sizeof(*offset));
    double off[3];
    if (!find_offset(*data, *size, off))
        return NOC_OK;
    text_buffer out = { 0 };
    bool memory = reserve(&out, *size + 1), plain = true;
    for (const char *p = *data, *stop = *data + *size, *end, *next; p < stop && memory && plain; p = next) {
        const char *line = next_line(p, stop, &end, &next), *from = line;
        vertex_line v;
        memory = reserve(&out, (size_t)(next - line) + 3 * NUMBER_SIZE + 2);
        if (memory && is_vertex(line, end)) {
            plain = parse_vertex(line, end, &v);
            char *to = out.data + out.size;
            *to++ = 'v';
            for (int k = 0; k < 3 && plain; k++) {
                double x = v.xyz[k] - off[k] * v.w;
                plain = fabs(x) <= MOST;
                to = plain ? write_fixed(to, x) : to;
            }
            out.size = (size_t)(to - out.data);
            from = v.rest;
        }
        if (memory && plain) {
            memcpy(out.data + out.size, from, (size_t)(next - from));
            out.size += (size_t)(next - from);
        }
    }
    if (!memory || !plain) {
        free(out.data);
        return memory ? NOC_OK : noc_error(log, NOC_ERR_MEMORY, "%s: no memory to hold it", name);
    }
    out.data[out.size] = 0;
    free(*data);
    *data = out.data;
    *size = out.size;
    memcpy(offset, off, sizeof(off));
    return NOC_OK;
}
