#include "import/mesh/obj_materials.h"

/* Bytes that are taken. A material of Assimp 5.2 holds 17 names of a kilobyte, twice (measured). A corner takes two
 * bytes of text at least, and four, or with its place in a texture twice four of four, as one of a face. A vertex is
 * one of the file, and of the mesh in the making. */
enum { MATERIAL_COST = 36000, TEXT_COST = 3, FACE_COST = 8, VERTEX_COST = 64 };

typedef struct statement {
    char *begin, *end; /* what stands behind the keyword, without blanks around it */
} statement;

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Is the line [p, end) a statement of this keyword? */
static bool is_a(char *p, char *end, const char *keyword, statement *s) {
    size_t n = strlen(keyword);
    while (p < end && is_blank(*p))
        p++;
    if ((size_t)(end - p) <= n || *p != *keyword || memcmp(p, keyword, n) || !is_blank(p[n]))
        return false;
    for (p += n; p < end && is_blank(*p);)
        p++;
    while (end > p && is_blank(end[-1]))
        end--;
    *s = (statement){ p, end };
    return p < end;
}

static char *line_end(char *p, char *stop) {
    char *newline = memchr(p, '\n', (size_t)(stop - p));
    return newline ? newline : stop;
}

/* The statement's text as a string of its own; NULL where there is no memory. */
static char *text_of(const statement *s) { return noc_strndup(s->begin, (size_t)(s->end - s->begin)); }

/* Adds the materials that a library defines. false where there is no memory. */
static bool add_library(obj_folder *folder, const char *name, obj_images *images, import_budget *budget,
                        noc_map *defined) {
    size_t size;
    char *data = obj_open_library(folder, name, &size, images, NULL);
    bool memory = !folder->refused;
    if (data)
        budget->stored += (double)size;
    for (char *p = data, *stop = data ? data + size : NULL, *end; p < stop && memory; p = end + (end < stop)) {
        statement s;
        end = line_end(p, stop);
        if (is_a(p, end, "newmtl", &s)) {
            char *material = text_of(&s);
            memory = material && map_put(defined, material, 1, NULL);
            free(material);
        }
    }
    free(data);
    return memory;
}

/* ---- a look at all lines ---- */

typedef struct look {
    NOC_ARRAY(char *) asked;
    size_t lines, faces, vertices;
    bool refused;
} look;

typedef struct looking {
    look *slots;
    obj_chunks *text;
    bool places; /* in images are of use */
    size_t lines, faces, vertices;
} looking;

static void look_at(void *ctx, const obj_chunk *chunk, size_t slot) {
    const looking *all = ctx;
    look *l = &all->slots[slot];
    l->lines = l->faces = l->vertices = l->asked.len = 0;
    for (char *line = chunk->begin, *stop = chunk->end, *end; line < stop && !l->refused; line = end + (end < stop)) {
        char *p = line;
        end = line_end(line, stop);
        l->lines += end < stop;
        while (p < end && is_blank(*p))
            p++;
        size_t n = (size_t)(end - p);
        if (n < 2)
            continue;
        if (is_blank(p[1])) {
            l->faces += *p == 'f';
            l->vertices += *p == 'v';
        } else if (*p == 'v') {
            l->vertices += all->places && n > 2 && p[1] == 't' && is_blank(p[2]);
        } else if (n > 6 && (!memcmp(p, "mtllib", 6) || !memcmp(p, "usemtl", 6))) {
            l->refused = !array_push(&l->asked, line);
        }
    }
}

static bool take_look(void *ctx, obj_chunk *chunk, size_t slot) {
    looking *all = ctx;
    const look *l = &all->slots[slot];
    chunk->line = all->lines + 1;
    all->lines += l->lines;
    all->faces += l->faces;
    all->vertices += l->vertices;
    return !l->refused && array_append(&all->text->asked, l->asked.data, l->asked.len);
}

static bool look_at_all(looking *all) {
    all->slots = noc_calloc(all->text->slots, sizeof(*all->slots));
    bool memory = all->slots && obj_chunks_each(all->text, look_at, take_look, all);
    for (size_t i = 0; all->slots && i < all->text->slots; i++)
        array_free(&all->slots[i].asked);
    free(all->slots);
    return memory;
}

noc_status obj_plain_materials(obj_chunks *text, obj_folder *folder, obj_images *images, import_budget *budget,
                               geo_issues *issues, const char *name, noc_log *log) {
    looking all = { .text = text, .places = images != NULL };
    noc_map defined = { 0 }, libraries = { 0 };
    size_t undefined = 0;
    char unknown = '?'; /* a name that no library defines */
    bool memory = look_at_all(&all);
    for (size_t i = 0; i < text->asked.len && memory; i++) {
        char *p = text->asked.data[i], *end = line_end(p, text->stop);
        statement s;
        if (is_a(p, end, "mtllib", &s)) {
            char *library = text_of(&s);
            bool fresh;
            memory = library && map_put(&libraries, library, 1, &fresh) &&
                     (!fresh || add_library(folder, library, images, budget, &defined));
            if (memory && !fresh) /* Assimp would read all of it again */
                memset(p, ' ', (size_t)(end - p));
            free(library);
        }
    }
    while (unknown > '!' && map_get(&defined, (char[]){ unknown, 0 }, NULL))
        unknown--;
    for (size_t i = 0; i < text->asked.len && memory; i++) {
        char *p = text->asked.data[i], *end = line_end(p, text->stop);
        statement s;
        if (!is_a(p, end, "usemtl", &s))
            continue;
        char *material = text_of(&s);
        memory = material != NULL;
        if (memory && !map_get(&defined, material, NULL)) {
            geo_issue(issues, GEO_GUESSED, "material that is not there, the default one instead", material);
            memset(s.begin, ' ', (size_t)(s.end - s.begin));
            *s.begin = unknown;
            undefined = 1;
        }
        free(material);
    }
    double size = text->list.len ? (double)(text->stop - text->list.data[0].begin) : 0;
    double cost = size * TEXT_COST + (double)(defined.len + undefined) * MATERIAL_COST + (double)all.faces * FACE_COST +
                  (double)all.vertices * VERTEX_COST;
    map_free(&defined);
    map_free(&libraries);
    return memory ? import_affords(budget, cost, name, "its faces and materials", log) : noc_no_memory(log, name);
}
