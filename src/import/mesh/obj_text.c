#include "import/mesh/obj_text.h"

#include <math.h>
#include <stdio.h>

#define MOST 1e38      /* of a coordinate */
#define MOST_PLACE 1e6 /* noc_mesh.uv */
#define MOST_NUMBERS 7 /* in a vertex: place, weight or colour, and one too many */
#define MOST_THINGS ((size_t)UINT32_MAX - 1)

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static bool is_separator(char c) { return is_blank(c) || c == '\n' || c == '\\'; }

/* ---- statements ---- */

/* One of a line, or of the lines that backslashes join to it; without its indent. */
typedef struct statement {
    const char *begin, *end, *next; /* next: where the one after it begins */
    size_t line, lines;
} statement;

static void next_statement(statement *s, const char *stop) {
    const char *p = s->next;
    s->line += s->lines;
    s->lines = 1;
    for (const char *from = p;; s->lines++) {
        const char *newline = memchr(from, '\n', (size_t)(stop - from)), *last = newline;
        s->end = newline ? newline : stop;
        while (last && last > from && last[-1] == '\r')
            last--;
        if (!newline || last == from || last[-1] != '\\')
            break;
        from = newline + 1;
    }
    s->next = s->end < stop ? s->end + 1 : stop;
    while (p < s->end && is_blank(*p))
        p++;
    s->begin = p;
}

/* Is it a statement of this keyword? */
static bool is_a(const statement *s, const char *keyword, size_t n) {
    return (size_t)(s->end - s->begin) > n && !memcmp(s->begin, keyword, n) &&
           (is_blank(s->begin[n]) || s->begin[n] == '\\');
}

static void tell(geo_issues *issues, geo_issue_kind kind, const char *reason, const statement *s) {
    char id[32];
    snprintf(id, sizeof(id), "line %zu", s->line);
    geo_issue(issues, kind, reason, id);
}

/* ---- vertices ---- */

/* Numbers behind a keyword of so many letters; how many. */
static int parse_numbers(const statement *s, size_t keyword, double v[MOST_NUMBERS]) {
    char joined[512];
    const char *p = s->begin + keyword, *end = s->end, *next;
    size_t length = (size_t)(end - p);
    if (memchr(p, '\\', length) && length < sizeof(joined)) {
        for (size_t i = 0; i < length; i++)
            joined[i] = is_separator(p[i]) ? ' ' : p[i];
        p = joined;
        end = joined + length;
    }
    const char *remark = memchr(p, '#', (size_t)(end - p));
    int n = 0;
    for (end = remark ? remark : end; n < MOST_NUMBERS && (next = noc_scan_double(p, end, &v[n])); p = next)
        n++;
    return n;
}

/* false, and NAN, where it has no place. */
static bool parse_vertex(const statement *s, double xyz[3]) {
    double v[MOST_NUMBERS];
    int n = parse_numbers(s, 1, v);
    double w = n == 4 ? v[3] : 1; /* a homogeneous vertex; five numbers and more are a colour behind the place */
    bool good = n >= 3 && w != 0;
    for (int k = 0; k < 3 && good; k++)
        good = fabs(xyz[k] = v[k] / w) < MOST; /* false for NaN, too */
    for (int k = 0; k < 3 && !good; k++)
        xyz[k] = NAN;
    return good;
}

/* The same of a place in a texture, and zeros. One number is that of a texture along a line. */
static bool parse_place(const statement *s, double uv[2]) {
    double v[MOST_NUMBERS] = { 0 };
    int n = parse_numbers(s, 2, v);
    bool good = n >= 1 && n <= 3 && fabs(v[0]) < MOST_PLACE && fabs(v[1]) < MOST_PLACE;
    uv[0] = good ? v[0] : 0;
    uv[1] = good && n > 1 ? v[1] : 0;
    return good;
}

static bool read_vertices(obj_text *t, const char *data, size_t size, bool places, geo_issues *issues) {
    const char *stop = data + size;
    bool memory = true;
    for (statement s = { .next = data, .line = 1 }; s.next < stop && memory;) {
        next_statement(&s, stop);
        if (s.begin == s.end || *s.begin != 'v')
            continue;
        if (is_a(&s, "v", 1)) {
            double xyz[3];
            if (!parse_vertex(&s, xyz))
                tell(issues, GEO_SKIPPED, "vertex that is not three numbers", &s);
            memory = t->xyz.len < 3 * MOST_THINGS && array_append(&t->xyz, xyz, 3);
        } else if (places && is_a(&s, "vt", 2)) {
            double uv[2];
            if (!parse_place(&s, uv))
                tell(issues, GEO_GUESSED, "texture coordinates that are no numbers, taken as 0", &s);
            memory = t->uv.len < 2 * MOST_THINGS && array_append(&t->uv, uv, 2);
        }
    }
    return memory;
}

/* ---- faces ---- */

typedef struct reading_faces {
    obj_text *t;
    bool places;
    size_t vertices, uv; /* before the face */
    const char *group, *material;
    bool open; /* the last mesh takes the next face */
    geo_issues *issues;
} reading_faces;

/* One index, at least one digit, of so many things; NULL where it is none, or that of no such thing. From 0. */
static const char *read_index(const char *p, const char *end, size_t so_far, size_t all, uint32_t *index) {
    bool negative = p < end && *p == '-';
    uint64_t value = 0;
    const char *digits = p += negative;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        value = value > 1000000000000 ? value : value * 10 + (uint64_t)(*p - '0');
    if (p == digits || value < 1 || value > (negative ? so_far : all))
        return NULL;
    *index = (uint32_t)(negative ? so_far - value : value - 1);
    return p;
}

typedef struct face {
    size_t corners;    /* 0: one of them is not there */
    bool placed, lost; /* all have places; one is told, and not there */
    bool memory;
} face;

/* Puts the corners behind the others. */
static face read_corners(const reading_faces *r, const char *p, const char *end) {
    obj_text *t = r->t;
    size_t all = t->xyz.len / 3, all_uv = t->uv.len / 2;
    face f = { .placed = r->places, .memory = true };
    for (;;) {
        while (p < end && is_separator(*p))
            p++;
        if (p == end || !f.memory)
            return f;
        uint32_t index, place = OBJ_NOWHERE;
        const char *behind = read_index(p, end, r->vertices, all, &index);
        if (!behind || isnan(t->xyz.data[3 * (size_t)index]))
            break;
        p = behind;
        bool told = r->places && p + 1 < end && *p == '/' && p[1] != '/' && !is_separator(p[1]);
        const char *kept = told ? read_index(p + 1, end, r->uv, all_uv, &place) : NULL;
        f.lost = f.lost || (told && !kept);
        f.placed = f.placed && kept;
        p = kept ? kept : p;
        for (; p < end && !is_separator(*p); p++) /* /vt, //vn, /vt/vn */
            if (*p != '/' && *p != '-' && !(*p >= '0' && *p <= '9' && p > behind))
                break;
        if (p < end && !is_separator(*p))
            break;
        f.memory = f.corners < MOST_THINGS && array_push(&t->corners, index) &&
                   (!r->places || array_push(&t->uv_index, kept ? place : OBJ_NOWHERE));
        f.corners++;
    }
    f.corners = 0;
    return f;
}

static bool open_mesh(reading_faces *r, const char *name) {
    obj_text *t = r->t;
    r->open = true;
    obj_mesh *last = t->meshes.len ? &t->meshes.data[t->meshes.len - 1] : NULL;
    obj_mesh mesh = {
        .name = name, .material = r->material, .first_face = t->faces.len, .first_corner = t->corners.len
    };
    if (last && last->first_face == t->faces.len) { /* nothing is in it */
        *last = mesh;
        return true;
    }
    return array_push(&t->meshes, mesh);
}

static bool read_face(reading_faces *r, const statement *s) {
    obj_text *t = r->t;
    const char *begin = s->begin + 1, *remark = memchr(begin, '#', (size_t)(s->end - begin));
    const char *end = remark ? remark : s->end;
    size_t first = t->corners.len, first_uv = t->uv_index.len;
    if (!r->open && !open_mesh(r, "defaultobject"))
        return false;
    face f = read_corners(r, begin, end);
    bool there = f.memory && f.corners >= 3;
    if (!there) {
        bool empty = true;
        for (const char *p = begin; p < end && empty; p++)
            empty = is_separator(*p);
        tell(r->issues, GEO_SKIPPED,
             empty || f.corners ? "face of fewer than three vertices" : "face with an index that is not there", s);
        t->corners.len = first;
        t->uv_index.len = first_uv;
        return f.memory;
    }
    if (f.lost)
        tell(r->issues, GEO_GUESSED, "face with texture coordinates that are not there", s);
    for (size_t i = first_uv; i < t->uv_index.len && !f.placed; i++)
        t->uv_index.data[i] = OBJ_NOWHERE; /* all of a face's, or none */
    obj_mesh *mesh = &t->meshes.data[t->meshes.len - 1];
    mesh->placed = mesh->placed || f.placed;
    return array_push(&t->faces, (uint32_t)f.corners);
}

/* What stands behind the keyword: all of it, or the first word. NULL in *text: nothing. false: no memory. */
static bool read_name(reading_faces *r, const statement *s, size_t keyword, bool word, const char **text) {
    const char *p = s->begin + keyword, *end = s->end;
    while (p < end && is_separator(*p))
        p++;
    const char *stop = p;
    while (word && stop < end && !is_separator(*stop))
        stop++;
    for (stop = word ? stop : end; stop > p && is_separator(stop[-1]);)
        stop--;
    *text = stop > p ? arena_strndup(&r->t->names, p, (size_t)(stop - p)) : NULL;
    return !r->t->names.refused;
}

static bool same(const char *a, const char *b) { return a && b && !strcmp(a, b); }

/* A mesh is of one name and one material. Where the material changes, it is called as its group, else as the material.
 */
static bool read_material(reading_faces *r, const statement *s) {
    const obj_text *t = r->t;
    const char *name;
    if (!read_name(r, s, 6, false, &name))
        return false;
    if (!name || same(name, r->material))
        return true;
    r->material = name;
    if (!r->open)
        return true;
    obj_mesh *last = &t->meshes.data[t->meshes.len - 1];
    if (last->first_face == t->faces.len) {
        last->material = name;
        return true;
    }
    return open_mesh(r, r->group ? r->group : name);
}

static bool read_group(reading_faces *r, const statement *s) {
    const char *name;
    if (!read_name(r, s, 1, false, &name))
        return false;
    if (!name || same(name, r->group))
        return true;
    r->group = name;
    return open_mesh(r, name);
}

static bool read_object(reading_faces *r, const statement *s) {
    const char *name;
    return read_name(r, s, 1, true, &name) && (!name || open_mesh(r, name));
}

static bool read_faces(reading_faces *r, const char *data, size_t size) {
    const char *stop = data + size;
    bool memory = true;
    for (statement s = { .next = data, .line = 1 }; s.next < stop && memory;) {
        next_statement(&s, stop);
        switch (s.begin < s.end ? *s.begin : 0) {
        case 'v':
            r->vertices += is_a(&s, "v", 1);
            r->uv += is_a(&s, "vt", 2);
            break;
        case 'f': memory = !is_a(&s, "f", 1) || read_face(r, &s); break;
        case 'u': memory = !is_a(&s, "usemtl", 6) || read_material(r, &s); break;
        case 'g': memory = !is_a(&s, "g", 1) || read_group(r, &s); break;
        case 'o': memory = !is_a(&s, "o", 1) || read_object(r, &s); break;
        default: break;
        }
    }
    return memory;
}

bool obj_text_read(obj_text *t, const char *data, size_t size, bool places, geo_issues *issues) {
    reading_faces r = { .t = t, .places = places, .issues = issues };
    return read_vertices(t, data, size, places, issues) && read_faces(&r, data, size);
}

void obj_text_free(obj_text *t) {
    array_free(&t->xyz);
    array_free(&t->uv);
    array_free(&t->faces);
    array_free(&t->corners);
    array_free(&t->uv_index);
    array_free(&t->meshes);
    arena_free(&t->names);
}
