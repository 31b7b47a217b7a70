/* PLY, as scanners and photogrammetry write meshes: text, and binary of either order of bytes. Coordinates are x, y and
 * z, up, in double precision where the file has it; faces of any number of corners. Colours, normals and what else
 * elements hold is passed over. It is read here, without Assimp, whose floats would round coordinates of a CRS to half
 * a metre. */
#include "import/import.h"
#include "import/mesh/polygons.h"

#include <math.h>

#define MOST_PROPERTIES 64
#define MOST_ELEMENTS 32
#define MOST_CORNERS 100000 /* of a face */

typedef enum type { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, TYPES } type;

typedef struct property {
    type of, count; /* count: of a list, TYPES where it is none */
    enum { OTHER, X, Y, Z, CORNERS } role;
} property;

typedef struct element {
    char name[32];
    uint64_t count;
    size_t property_count;
    property properties[MOST_PROPERTIES];
} element;

typedef struct ply {
    const char *name;
    noc_log *log;
    geo_issues *issues;
    const char *at, *end;
    enum { TEXT, LITTLE, BIG } kind;
    element elements[MOST_ELEMENTS];
    size_t element_count;
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices; /* room for two triangles a face */
    NOC_ARRAY(unsigned) corners; /* of the face that is read */
    cut_mesh cut;
    uint64_t vertices; /* that the header tells */
    uint64_t bad_faces;
} ply;

static bool probe(const char *head, size_t size) {
    return size > 4 && !memcmp(head, "ply", 3) && (head[3] == '\n' || head[3] == '\r') && strstr(head, "format ");
}

static noc_status broken(const ply *p, const char *why) {
    return noc_error(p->log, NOC_ERR_FORMAT, "%s: PLY: %s", p->name, why);
}

/* ---- header ---- */

static type type_of(const char *word) {
    static const char *const names[TYPES][2] = { { "char", "int8" },     { "uchar", "uint8" },   { "short", "int16" },
                                                 { "ushort", "uint16" }, { "int", "int32" },     { "uint", "uint32" },
                                                 { "float", "float32" }, { "double", "float64" } };
    for (int t = 0; t < TYPES; t++)
        if (!strcmp(word, names[t][0]) || !strcmp(word, names[t][1]))
            return (type)t;
    return TYPES;
}

/* Up to 6 words of the next line; -1 at the end. */
static int next_line(ply *p, char words[6][32]) {
    int count = 0;
    if (p->at >= p->end)
        return -1;
    const char *stop = memchr(p->at, '\n', (size_t)(p->end - p->at));
    stop = stop ? stop : p->end;
    for (const char *c = p->at; c < stop && count < 6;) {
        while (c < stop && (*c == ' ' || *c == '\t' || *c == '\r'))
            c++;
        size_t n = 0;
        for (; c < stop && *c != ' ' && *c != '\t' && *c != '\r'; c++)
            if (n < sizeof(words[0]) - 1)
                words[count][n++] = *c;
        words[count][n] = 0;
        count += n > 0;
    }
    p->at = stop < p->end ? stop + 1 : p->end;
    return count;
}

static noc_status add_property(ply *p, int words, char word[6][32]) {
    if (!p->element_count)
        return broken(p, "a property before the first element");
    element *e = &p->elements[p->element_count - 1];
    bool list = words == 5 && !strcmp(word[1], "list");
    if (e->property_count == MOST_PROPERTIES || (!list && words != 3))
        return broken(p, "a property that is not understood, or too many of them");
    property q = { type_of(word[list ? 3 : 1]), list ? type_of(word[2]) : TYPES, OTHER };
    const char *name = word[list ? 4 : 2];
    if (q.of == TYPES || (list && (q.count == TYPES || q.count >= FLOAT32)))
        return broken(p, "a property of a type that is not known");
    if (!list && !strcmp(e->name, "vertex") && name[0] >= 'x' && name[0] <= 'z' && !name[1])
        q.role = name[0] == 'x' ? X : name[0] == 'y' ? Y : Z;
    if (list && !strcmp(e->name, "face") && !strncmp(name, "vertex_ind", 10))
        q.role = CORNERS;
    e->properties[e->property_count++] = q;
    return NOC_OK;
}

static noc_status add_element(ply *p, int words, char word[6][32]) {
    long long count;
    if (words != 3 || !noc_parse_int(word[2], &count) || count < 0 || p->element_count == MOST_ELEMENTS)
        return broken(p, "an element that is not understood, or too many of them");
    element *e = &p->elements[p->element_count++];
    snprintf(e->name, sizeof(e->name), "%s", word[1]);
    e->count = (uint64_t)count;
    if (!strcmp(e->name, "vertex"))
        p->vertices = e->count;
    return NOC_OK;
}

static noc_status read_header(ply *p) {
    char word[6][32];
    int words;
    bool told = false;
    noc_status status = NOC_OK;
    next_line(p, word);
    while (!status && (words = next_line(p, word)) >= 0) {
        if (!words || !strcmp(word[0], "comment") || !strcmp(word[0], "obj_info"))
            continue;
        if (!strcmp(word[0], "end_header"))
            return told ? NOC_OK : broken(p, "no format in the header");
        if (!strcmp(word[0], "format") && words == 3) {
            told = true;
            p->kind = !strcmp(word[1], "ascii") ? TEXT : !strcmp(word[1], "binary_big_endian") ? BIG : LITTLE;
            if (p->kind == LITTLE && strcmp(word[1], "binary_little_endian") != 0)
                status = broken(p, "a format that is not known");
        } else if (!strcmp(word[0], "element")) {
            status = add_element(p, words, word);
        } else if (!strcmp(word[0], "property")) {
            status = add_property(p, words, word);
        } else {
            status = broken(p, "a line of the header that is not understood");
        }
    }
    return status ? status : broken(p, "the file ends in its header");
}

/* ---- values ---- */

static bool get_text(ply *p, double *value) {
    while (p->at < p->end && strchr(" \t\r\n", *p->at) && *p->at)
        p->at++;
    const char *next = noc_scan_double(p->at, p->end, value);
    if (next) {
        p->at = next;
        return true;
    }
    const char *word = p->at; /* "nan" */
    while (p->at < p->end && !strchr(" \t\r\n", *p->at))
        p->at++;
    *value = NAN;
    return p->at > word;
}

static bool get(ply *p, type t, double *value) {
    static const unsigned char sizes[TYPES] = { 1, 1, 2, 2, 4, 4, 4, 8 };
    unsigned char bytes[8];
    if (p->kind == TEXT)
        return get_text(p, value);
    size_t n = sizes[t];
    if ((size_t)(p->end - p->at) < n)
        return false;
    for (size_t i = 0; i < n; i++)
        bytes[i] = (unsigned char)p->at[p->kind == LITTLE ? i : n - 1 - i];
    p->at += n;
    uint64_t bits = 0;
    for (size_t i = 0; i < n; i++)
        bits |= (uint64_t)bytes[i] << (8 * i);
    float f;
    uint32_t low = (uint32_t)bits;
    switch (t) {
    case INT8: *value = (int8_t)bits; break;
    case INT16: *value = (int16_t)bits; break;
    case INT32: *value = (int32_t)low; break;
    case FLOAT32: memcpy(&f, &low, sizeof(f)), *value = (double)f; break;
    case FLOAT64: memcpy(value, &bits, sizeof(*value)); break;
    default: *value = (double)bits; break;
    }
    return true;
}

/* ---- elements ---- */

static noc_status no_memory(const ply *p) { return noc_no_memory(p->log, p->name); }

static noc_status get_list(ply *p, const property *q) {
    double count, value;
    bool face = q->role == CORNERS;
    if (!get(p, q->count, &count))
        return broken(p, "the file ends too early: is it cut?");
    if (!(count >= 0 && count <= MOST_CORNERS))
        return broken(p, "a list of a length that is none");
    p->corners.len = 0;
    for (size_t i = 0; i < (size_t)count; i++) {
        if (!get(p, q->of, &value))
            return broken(p, "the file ends too early: is it cut?");
        bool there = value >= 0 && value < (double)p->vertices;
        if (face && !array_push(&p->corners, there ? (unsigned)value : UINT32_MAX))
            return no_memory(p);
    }
    return NOC_OK;
}

static noc_status add_face(ply *p) {
    bool good = p->corners.len >= 3;
    for (size_t i = 0; i < p->corners.len; i++)
        good = good && p->corners.data[i] < p->xyz.len / 3;
    p->bad_faces += !good;
    if (!good)
        return NOC_OK;
    if (!array_reserve(&p->indices, 3 * p->cut.triangle_count + 6))
        return no_memory(p);
    p->cut.xyz = p->xyz.data;
    p->cut.indices = p->indices.data;
    cut_face(&p->cut, p->corners.data, p->corners.len);
    return p->cut.extra.no_memory ? no_memory(p) : NOC_OK;
}

static noc_status read_element(ply *p, const element *e) {
    bool vertex = !strcmp(e->name, "vertex"), face = !strcmp(e->name, "face");
    noc_status status = NOC_OK;
    for (uint64_t i = 0; i < e->count && e->property_count && !status; i++) {
        double xyz[3] = { NAN, NAN, NAN }, value;
        p->corners.len = 0;
        for (size_t k = 0; k < e->property_count && !status; k++) {
            const property *q = &e->properties[k];
            if (q->count != TYPES) {
                size_t kept = p->corners.len;
                status =
                    q->role == CORNERS || !kept ? get_list(p, q) : broken(p, "a list behind the corners of a face");
            } else if (!get(p, q->of, &value)) {
                status = broken(p, "the file ends too early: is it cut?");
            } else if (q->role != OTHER) {
                xyz[q->role - X] = value;
            }
        }
        if (!status && vertex && !array_append(&p->xyz, xyz, (size_t)3))
            status = no_memory(p);
        if (!status && face)
            status = add_face(p);
    }
    return status;
}

/* ---- the mesh ---- */

static noc_status hand_over(ply *p, const mesh_parts *parts) {
    noc_material plain = noc_class_material(NOC_CLASS_OTHER);
    size_t more = p->cut.extra.xyz.len, corners = p->cut.extra.indices.len, vertices = p->xyz.len / 3;
    p->indices.len = 3 * p->cut.triangle_count;
    if (!array_append(&p->xyz, p->cut.extra.xyz.data, more))
        return no_memory(p);
    for (size_t i = 0; i < corners; i++)
        if (!array_push(&p->indices, (uint32_t)vertices + p->cut.extra.indices.data[i]))
            return no_memory(p);
    geo_issues_add(p->issues, GEO_SKIPPED, "face with fewer than three corners, or with one that is not there",
                   (size_t)p->bad_faces, "face");
    if (!p->indices.len)
        return NOC_OK;
    int material = -1;
    noc_status status = parts->material(parts->ctx, &plain, NULL, NULL, &material);
    noc_mesh mesh = { .vertex_count = p->xyz.len / 3,
                      .positions = p->xyz.data,
                      .triangle_count = p->indices.len / 3,
                      .indices = p->indices.data,
                      .material = material };
    return status ? status : parts->mesh(parts->ctx, &mesh, p->xyz.data);
}

static noc_status read_parts(noc_stream *stream, const mesh_parts *parts, const char **format) {
    static const char *const formats[] = { "PLY (text)", "PLY (little-endian)", "PLY (big-endian)" };
    ply p = { .name = noc_stream_name(stream), .log = parts->log, .issues = parts->issues };
    char *data;
    size_t size;
    *format = "PLY";
    noc_status status = noc_stream_read_all(stream, parts->log, &data, &size);
    if (status)
        return status;
    p.at = data;
    p.end = data + size;
    p.cut = (cut_mesh){ .issues = parts->issues, .name = "face" };
    status = read_header(&p);
    if (!status)
        *format = formats[p.kind];
    if (!status && p.vertices > UINT32_MAX / 2)
        status = broken(&p, "more vertices than are read");
    for (size_t i = 0; i < p.element_count && !status; i++)
        status = read_element(&p, &p.elements[i]);
    free(data);
    if (!status)
        status = hand_over(&p, parts);
    geo_triangles_free(&p.cut.extra);
    array_free(&p.xyz);
    array_free(&p.indices);
    array_free(&p.corners);
    return status;
}

static noc_status read_mesh(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format) {
    mesh_scene to = { .scene = scene, .place = place, .issues = issues };
    const mesh_parts parts = mesh_scene_parts(&to);
    return read_parts(stream, &parts, format);
}

const noc_reader noc_reader_ply = { .name = "PLY", .reads = NOC_READS_MESH, .probe = probe, .read_mesh = read_mesh };
