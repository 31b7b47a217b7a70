/* Faces are checked in the text, before Assimp sees them; remarks behind them go too, for it takes them for indices. Indices count from 1 over the whole file; negative ones count back
 * from the last element before the face. */
#include "import/obj_faces.h"

#include <stdio.h>

typedef struct totals { long long v[3]; } totals; /* vertices, texture places, normals */

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Behind the last byte of a statement: of its line, or of the lines that backslashes join to it. */
static char *statement_end(char *p, char *stop) {
    for (;;) {
        char *newline = memchr(p, '\n', (size_t)(stop - p));
        if (!newline)
            return stop;
        char *last = newline;
        while (last > p && last[-1] == '\r')
            last--;
        if (last == p || last[-1] != '\\')
            return newline;
        p = newline + 1;
    }
}

/* Counts the statement if it is an element; else returns whether it is a face. */
static bool take(const char *p, const char *end, totals *t) {
    size_t n = (size_t)(end - p);
    if (n < 2)
        return false;
    if (p[0] == 'v' && is_blank(p[1]))
        t->v[0]++;
    else if (n > 2 && p[0] == 'v' && p[1] == 't' && is_blank(p[2]))
        t->v[1]++;
    else if (n > 2 && p[0] == 'v' && p[1] == 'n' && is_blank(p[2]))
        t->v[2]++;
    return p[0] == 'f' && is_blank(p[1]);
}

/* One index, at least one digit; NULL where it is none or out of range. */
static const char *check_index(const char *p, const char *end, long long so_far, long long all) {
    bool negative = p < end && *p == '-';
    long long value = 0;
    const char *digits = p += negative;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        value = value > 1000000000000 ? value : value * 10 + (*p - '0');
    return p > digits && value >= 1 && value <= (negative ? so_far : all) ? p : NULL;
}

static bool is_separator(char c) { return is_blank(c) || c == '\n' || c == '\\'; }

static bool is_whole(const char *p, const char *end, const totals *so_far, const totals *all) {
    while (p < end) {
        while (p < end && is_separator(*p))
            p++;
        if (p == end || *p == '#')
            return true;
        for (int k = 0; k < 3; k++) { /* v, v/vt, v//vn, v/vt/vn */
            bool absent = k == 1 && p < end && *p == '/';
            if (!absent && !(p = check_index(p, end, so_far->v[k], all->v[k])))
                return false;
            if (p == end || *p != '/')
                break;
            p++;
        }
        if (p < end && !is_separator(*p))
            return false;
    }
    return true;
}

static void blank(char *from, char *to) {
    for (; from < to; from++)
        *from = *from == '\n' ? '\n' : ' ';
}

void obj_drop_bad_faces(char *data, size_t size, geo_issues *issues) {
    totals all = { { 0 } }, so_far = { { 0 } };
    char *stop = data + size;
    for (int pass = 0; pass < 2; pass++) {
        size_t line = 1;
        for (char *p = data; p < stop;) {
            char *end = statement_end(p, stop), *begin = p;
            while (begin < end && is_blank(*begin))
                begin++;
            bool face = take(begin, end, pass ? &so_far : &all);
            if (pass && face && !is_whole(begin + 1, end, &so_far, &all)) {
                char id[32];
                snprintf(id, sizeof(id), "line %zu", line);
                geo_issue(issues, false, "face with an index that is not there", id);
                blank(begin, end);
            }
            char *remark = face && pass ? memchr(begin, '#', (size_t)(end - begin)) : NULL;
            if (remark)
                blank(remark, end);
            for (char *c = p; pass && c < end; c++)
                line += *c == '\n';
            line++;
            p = end < stop ? end + 1 : stop;
        }
    }
}
