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

/* Is its keyword as long as that, whose letters are looked at elsewhere? */
static bool ends_at(const statement *s, size_t n) {
    return (size_t)(s->end - s->begin) > n && (is_blank(s->begin[n]) || s->begin[n] == '\\');
}

static bool is_vertex(const statement *s) { return *s->begin == 'v' && ends_at(s, 1); }

static bool is_place(const statement *s) { return *s->begin == 'v' && ends_at(s, 2) && s->begin[1] == 't'; }

/* What the statements of a chunk say, to be taken in their order. */
typedef struct found {
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(double) uv;
    NOC_ARRAY(uint32_t) faces, corners, uv_index;
    NOC_ARRAY(struct run) runs;
    geo_issues *issues; /* NULL: none */
    bool refused;       /* memory */
} found;

typedef struct reading {
    obj_text *t;
    bool places; /* those in textures are of use */
    found *slots;
    geo_issues *issues;
    const char *group, *material;
    bool open; /* the last mesh takes the next face */
} reading;

static void tell(found *f, geo_issue_kind kind, const char *reason, const statement *s) {
    char id[32];
    snprintf(id, sizeof(id), "line %zu", s->line);
    f->issues = f->issues ? f->issues : geo_issues_create();
    f->refused = f->refused || !f->issues;
    geo_issue(f->issues, kind, reason, id);
}

/* What was told of a chunk. false: memory was refused to something of it. */
static bool take_told(const reading *r, found *f) {
    if (f->issues)
        geo_issues_merge(r->issues, f->issues);
    geo_issues_destroy(f->issues);
    f->issues = NULL;
    return !f->refused;
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

static void read_vertices(void *ctx, const obj_chunk *chunk, size_t slot) {
    const reading *r = ctx;
    found *f = &r->slots[slot];
    f->xyz.len = f->uv.len = 0;
    for (statement s = { .next = chunk->begin, .line = chunk->line }; s.next < chunk->end && !f->refused;) {
        next_statement(&s, chunk->end);
        if (s.begin == s.end)
            continue;
        if (is_vertex(&s)) {
            double xyz[3];
            if (!parse_vertex(&s, xyz))
                tell(f, GEO_SKIPPED, "vertex that is not three numbers", &s);
            f->refused = !array_append(&f->xyz, xyz, 3) || f->refused;
        } else if (r->places && is_place(&s)) {
            double uv[2];
            if (!parse_place(&s, uv))
                tell(f, GEO_GUESSED, "texture coordinates that are no numbers, taken as 0", &s);
            f->refused = !array_append(&f->uv, uv, 2) || f->refused;
        }
    }
}

static bool take_vertices(void *ctx, obj_chunk *chunk, size_t slot) {
    reading *r = ctx;
    obj_text *t = r->t;
    found *f = &r->slots[slot];
    chunk->vertices = t->xyz.len / 3;
    chunk->uv = t->uv.len / 2;
    return take_told(r, f) && array_append(&t->xyz, f->xyz.data, f->xyz.len) &&
           array_append(&t->uv, f->uv.data, f->uv.len) && t->xyz.len <= 3 * MOST_THINGS && t->uv.len <= 2 * MOST_THINGS;
}

/* ---- faces ---- */

/* A statement that may begin another mesh, and the faces up to the next such. */
typedef struct run {
    enum { GOES_ON, OBJECT, GROUP, MATERIAL } kind;
    const char *name; /* in the text */
    size_t length;
    size_t first_face, first_corner; /* of the chunk */
    bool faces, placed;              /* there is one, be it left out, and one that has places */
} run;

typedef struct reading_faces {
    found *f;
    const obj_text *t;
    bool places;
    size_t vertices, uv; /* before the face */
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
    const obj_text *t = r->t;
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
        f.memory = f.corners < MOST_THINGS && array_push(&r->f->corners, index) &&
                   (!r->places || array_push(&r->f->uv_index, kept ? place : OBJ_NOWHERE));
        f.corners++;
    }
    f.corners = 0;
    return f;
}

static void read_face(const reading_faces *r, const statement *s) {
    found *to = r->f;
    run *last = &to->runs.data[to->runs.len - 1];
    const char *begin = s->begin + 1, *remark = memchr(begin, '#', (size_t)(s->end - begin));
    const char *end = remark ? remark : s->end;
    size_t first = to->corners.len, first_uv = to->uv_index.len;
    last->faces = true;
    face f = read_corners(r, begin, end);
    if (!f.memory || f.corners < 3) {
        bool empty = true;
        for (const char *p = begin; p < end && empty; p++)
            empty = is_separator(*p);
        tell(to, GEO_SKIPPED,
             empty || f.corners ? "face of fewer than three vertices" : "face with an index that is not there", s);
        to->corners.len = first;
        to->uv_index.len = first_uv;
        to->refused = to->refused || !f.memory;
        return;
    }
    if (f.lost)
        tell(to, GEO_GUESSED, "face with texture coordinates that are not there", s);
    for (size_t i = first_uv; i < to->uv_index.len && !f.placed; i++)
        to->uv_index.data[i] = OBJ_NOWHERE; /* all of a face's, or none */
    last->placed = last->placed || f.placed;
    to->refused = !array_push(&to->faces, (uint32_t)f.corners) || to->refused;
}

/* What stands behind the keyword is the name: all of it, or the first word. */
static void read_name(found *f, const statement *s, size_t keyword, int kind) {
    const char *p = s->begin + keyword, *end = s->end;
    while (p < end && is_separator(*p))
        p++;
    const char *stop = p;
    while (kind == OBJECT && stop < end && !is_separator(*stop))
        stop++;
    for (stop = kind == OBJECT ? stop : end; stop > p && is_separator(stop[-1]);)
        stop--;
    run begun = { .name = p, .length = (size_t)(stop - p), .first_face = f->faces.len, .first_corner = f->corners.len };
    begun.kind = kind;
    f->refused = (stop > p && !array_push(&f->runs, begun)) || f->refused;
}

static void read_faces(void *ctx, const obj_chunk *chunk, size_t slot) {
    const reading *all = ctx;
    found *f = &all->slots[slot];
    reading_faces r = { .f = f, .t = all->t, .places = all->places, .vertices = chunk->vertices, .uv = chunk->uv };
    f->faces.len = f->corners.len = f->uv_index.len = f->runs.len = 0;
    f->refused = !array_push(&f->runs, (run){ .kind = GOES_ON });
    for (statement s = { .next = chunk->begin, .line = chunk->line }; s.next < chunk->end && !f->refused;) {
        next_statement(&s, chunk->end);
        switch (s.begin < s.end ? *s.begin : 0) {
        case 'v':
            r.vertices += is_vertex(&s);
            r.uv += is_place(&s);
            break;
        case 'f':
            if (ends_at(&s, 1))
                read_face(&r, &s);
            break;
        case 'u':
            if (ends_at(&s, 6) && !memcmp(s.begin, "usemtl", 6))
                read_name(f, &s, 6, MATERIAL);
            break;
        case 'g':
            if (ends_at(&s, 1))
                read_name(f, &s, 1, GROUP);
            break;
        case 'o':
            if (ends_at(&s, 1))
                read_name(f, &s, 1, OBJECT);
            break;
        default: break;
        }
    }
}

/* ---- meshes ---- */

static bool open_mesh(reading *r, const char *name) {
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

/* A mesh is of one name and one material. Where the material changes, it is called as its group, else as the material.
 */
static bool change_material(reading *r, const char *name) {
    const obj_text *t = r->t;
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

/* false: no memory. */
static bool begin_run(reading *r, const run *of) {
    const char *now = of->kind == GROUP ? r->group : of->kind == MATERIAL ? r->material : NULL;
    size_t length = of->kind == GOES_ON ? 0 : strnlen(of->name, of->length);
    if (of->kind == GOES_ON || (now && strlen(now) == length && !memcmp(now, of->name, length)))
        return true;
    const char *name = arena_strndup(&r->t->names, of->name, length);
    if (!name)
        return false;
    if (of->kind == MATERIAL)
        return change_material(r, name);
    r->group = of->kind == GROUP ? name : r->group;
    return open_mesh(r, name);
}

static bool take_run(reading *r, const found *f, const run *of, size_t last_face, size_t last_corner) {
    obj_text *t = r->t;
    size_t faces = last_face - of->first_face, corners = last_corner - of->first_corner;
    if (!begin_run(r, of) || (of->faces && !r->open && !open_mesh(r, "defaultobject")))
        return false;
    if (of->placed)
        t->meshes.data[t->meshes.len - 1].placed = true;
    return t->corners.len + corners <= MOST_THINGS && array_append(&t->faces, f->faces.data + of->first_face, faces) &&
           array_append(&t->corners, f->corners.data + of->first_corner, corners) &&
           (!r->places || array_append(&t->uv_index, f->uv_index.data + of->first_corner, corners));
}

static bool take_faces(void *ctx, obj_chunk *chunk, size_t slot) {
    reading *r = ctx;
    found *f = &r->slots[slot];
    bool memory = take_told(r, f);
    for (size_t i = 0; i < f->runs.len && memory; i++) {
        const run *of = &f->runs.data[i], *next = i + 1 < f->runs.len ? of + 1 : NULL;
        memory = take_run(r, f, of, next ? next->first_face : f->faces.len, next ? next->first_corner : f->corners.len);
    }
    return memory;
}

bool obj_text_read(obj_text *t, obj_chunks *text, bool places, geo_issues *issues) {
    reading r = { .t = t, .places = places, .issues = issues, .slots = noc_calloc(text->slots, sizeof(*r.slots)) };
    bool memory = r.slots && obj_chunks_each(text, read_vertices, take_vertices, &r) &&
                  obj_chunks_each(text, read_faces, take_faces, &r);
    for (size_t i = 0; r.slots && i < text->slots; i++) {
        found *f = &r.slots[i];
        array_free(&f->xyz);
        array_free(&f->uv);
        array_free(&f->faces);
        array_free(&f->corners);
        array_free(&f->uv_index);
        array_free(&f->runs);
        geo_issues_destroy(f->issues);
    }
    free(r.slots);
    return memory;
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
