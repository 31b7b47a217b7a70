/* Faces are checked in the text, before Assimp sees them. Indices count from 1 over the whole file; negative ones count
 * back from the last vertex before the face. */
#include "import/mesh/obj_faces.h"

#include <stdio.h>

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

const char *obj_statement_end(const char *p, const char *stop) {
    for (;;) {
        const char *newline = memchr(p, '\n', (size_t)(stop - p));
        if (!newline)
            return stop;
        const char *last = newline;
        while (last > p && last[-1] == '\r')
            last--;
        if (last == p || last[-1] != '\\')
            return newline;
        p = newline + 1;
    }
}

/* Is it a statement of this keyword? */
static bool is_a(const char *p, const char *end, const char *keyword) {
    size_t n = strlen(keyword);
    return (size_t)(end - p) > n && !memcmp(p, keyword, n) && (is_blank(p[n]) || p[n] == '\\');
}

/* What the indices of a face may be. */
typedef struct face_limits {
    long long so_far, all; /* vertices before the face, and in the file */
    const obj_numbers *bad;
    bool places;                         /* in textures are of use */
    long long places_so_far, all_places; /* the same of those */
    geo_issues *issues;
    size_t line;
} face_limits;

static int compare_numbers(const void *a, const void *b) {
    long long x = *(const long long *)a, y = *(const long long *)b;
    return (x > y) - (x < y);
}

/* One index, at least one digit, of so many things; NULL where it is none, or that of no such thing. */
static const char *read_index(const char *p, const char *end, long long so_far, long long all, long long *index) {
    bool negative = p < end && *p == '-';
    long long value = 0;
    const char *digits = p += negative;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        value = value > 1000000000000 ? value : value * 10 + (*p - '0');
    if (p == digits || value < 1 || value > (negative ? so_far : all))
        return NULL;
    *index = negative ? so_far + 1 - value : value;
    return p;
}

/* That of a vertex which is a good one. */
static const char *check_index(const char *p, const char *end, const face_limits *limits) {
    long long value = 0;
    const obj_numbers *bad = limits->bad;
    p = read_index(p, end, limits->so_far, limits->all, &value);
    return p && bad->len && bsearch(&value, bad->data, bad->len, sizeof(value), compare_numbers) ? NULL : p;
}

static bool is_separator(char c) { return is_blank(c) || c == '\n' || c == '\\'; }

/* How many corners a face has, 0 where one is not there. What stands behind slashes is blanked out, but for places that
 * are there. *placed: all of them are; *lost: one is told, and not there. */
static size_t plain_corners(char *p, char *end, const face_limits *limits, bool *placed, bool *lost) {
    *placed = limits->places;
    *lost = false;
    for (size_t n = 0;; n++) {
        while (p < end && is_separator(*p))
            p++;
        if (p == end)
            return n;
        const char *behind = check_index(p, end, limits);
        if (!behind)
            return 0;
        p += behind - p;
        long long place;
        bool told = limits->places && p + 1 < end && *p == '/' && p[1] != '/' && !is_separator(p[1]);
        const char *kept = told ? read_index(p + 1, end, limits->places_so_far, limits->all_places, &place) : NULL;
        *lost = *lost || (told && !kept);
        *placed = *placed && kept;
        p += kept ? kept - p : 0;
        for (; p < end && !is_separator(*p); p++) { /* /vt, //vn, /vt/vn */
            if (*p != '/' && *p != '-' && !(*p >= '0' && *p <= '9' && p > behind))
                return 0;
            *p = ' ';
        }
    }
}

static void blank(char *from, char *to) {
    for (; from < to; from++)
        *from = *from == '\n' ? '\n' : ' ';
}

static void take_indent(char *p, char *begin, char *end) {
    while (end > begin && end[-1] == '\r')
        end--;
    memmove(p, begin, (size_t)(end - begin));
    memset(p + (end - begin), ' ', (size_t)(begin - p));
}

static void strip_places(char *p, char *end) {
    for (bool behind = false; p < end; p++) {
        behind = !is_separator(*p) && (behind || *p == '/');
        *p = behind ? ' ' : *p;
    }
}

/* Returns whether a face remains of it. */
static bool plain_face(char *begin, char *end, const face_limits *limits) {
    bool placed, lost;
    char id[32], *remark = memchr(begin, '#', (size_t)(end - begin));
    if (remark)
        blank(remark, end);
    bool there = true;
    size_t corners = plain_corners(begin + 1, end, limits, &placed, &lost);
    if (corners < 3) {
        for (const char *p = begin + 1; p < end && there; p++)
            there = is_separator(*p);
        there = there || corners;
        snprintf(id, sizeof(id), "line %zu", limits->line);
        geo_issue(limits->issues, GEO_SKIPPED,
                  there ? "face of fewer than three vertices" : "face with an index that is not there", id);
        blank(begin, end);
    } else if (lost) {
        snprintf(id, sizeof(id), "line %zu", limits->line);
        geo_issue(limits->issues, GEO_GUESSED, "face with texture coordinates that are not there", id);
    }
    if (limits->places && !placed)
        strip_places(begin, end); /* Assimp wants them of all corners, or of none */
    return corners >= 3;
}

size_t obj_plain_faces(char *data, size_t size, bool places, const obj_numbers *bad, geo_issues *issues) {
    char *stop = data + size;
    face_limits limits = { .bad = bad, .places = places, .issues = issues, .line = 1 };
    size_t faces = 0;
    for (const char *p = data, *end; p < stop; p = end + (end < stop)) {
        end = obj_statement_end(p, stop);
        while (p < end && is_blank(*p))
            p++;
        limits.all += is_a(p, end, "v");
        limits.all_places += is_a(p, end, "vt");
    }
    for (char *p = data, *end; p < stop; p = end + (end < stop)) {
        char *begin = p;
        end = p + (obj_statement_end(p, stop) - p);
        while (begin < end && is_blank(*begin))
            begin++;
        limits.so_far += is_a(begin, end, "v");
        limits.places_so_far += is_a(begin, end, "vt");
        bool unused = end - begin >= 2 && begin[0] == 'v' && (begin[1] == 't' || begin[1] == 'n' || begin[1] == 'p') &&
                      !(places && is_a(begin, end, "vt"));
        if (unused)
            blank(begin, end);
        else if (is_a(begin, end, "f"))
            faces += plain_face(begin, end, &limits);
        for (const char *c = p; c < end; c++)
            limits.line += *c == '\n';
        limits.line++;
        if (begin > p)
            take_indent(p, begin, end);
    }
    return faces;
}
