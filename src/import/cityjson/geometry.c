/* geometry.c: nested lists of vertices to polygons, with the meaning of each. Of an object's geometries of a level
 * (1.2, 1.3: both 1) the one of the most detail is taken. */
#include "import/cityjson/cityjson.h"

#include <math.h>

#define LEVELS 5
#define ASK 4096 /* surfaces that are read before progress is asked */

typedef struct builder {
    cj_reading *r;
    cg_frame frame; /* of the polygon that is read: feature, geometry, CRS */
    const cj_points *points;
    cg_implicit *implicit;
    uint32_t feature;    /* the object */
    const char *id;      /* its, for reports */
    const json_t *types; /* of the geometry's semantics */
    uint32_t *features;  /* of each of them: CG_NONE until it is met */
    size_t type_count;
    uint8_t lod, role;
    bool meaning; /* the geometry has semantics */
    size_t last;  /* semantics of the polygon before; a geometry of the parser is a run of equal ones */
    bool open;    /* there is one */
    size_t surfaces;
    bool flawed, semantics_flawed; /* counted once a geometry */
    cj_themes themes;
    size_t path[3]; /* of the surface that is read, in the lists; depth of them are in use */
    int depth;
} builder;

static void issue(const builder *b, geo_issue_kind kind, const char *reason) {
    geo_issue(b->r->parser->sink->issues, kind, reason, b->id);
}

static void not_nested(builder *b) {
    if (!b->flawed)
        issue(b, GEO_SKIPPED, "boundaries that are not nested as their type has it");
    b->flawed = true;
}

/* ---- polygons ---- */

static const double *point_of(const builder *b, const json_t *index) {
    json_int_t i = json_integer_value(index);
    return json_is_integer(index) && i >= 0 && (uint64_t)i < b->points->count ? b->points->xyz + 3 * i : NULL;
}

/* That something stands at: NULL also where it is no number. */
static const double *place_of(const builder *b, const json_t *geometry) {
    const double *xyz = point_of(b, json_array_get(json_object_get(geometry, "boundaries"), 0));
    return xyz && isfinite(xyz[0] + xyz[1] + xyz[2]) ? xyz : NULL;
}

static void read_ring(builder *b, const json_t *ring, const json_t *texture, bool exterior) {
    cg_parser *p = b->r->parser;
    size_t count = json_array_size(ring);
    cg_ring_begin(p, exterior, NULL);
    if (p->xyz.len + 3 * count > cg_most_numbers)
        p->ring_fault = "polygon with too many points";
    for (size_t i = 0; i < count && !p->ring_fault; i++) {
        const double *xyz = point_of(b, json_array_get(ring, i));
        if (!xyz)
            p->ring_fault = "vertex that is not there";
        else if (!isfinite(xyz[0] + xyz[1] + xyz[2]))
            p->ring_fault = "coordinates that are not numbers";
        else if (!array_append(&p->xyz, xyz, (size_t)3))
            cg_no_memory(p);
    }
    /* Rings of CityJSON are not closed, those of CityGML are. */
    if (!p->ring_fault && count > 2 && !json_equal(json_array_get(ring, 0), json_array_get(ring, count - 1)) &&
        !array_append(&p->xyz, point_of(b, json_array_get(ring, 0)), (size_t)3))
        cg_no_memory(p);
    if (!p->status)
        cj_ring_texture(b->r, &b->themes, texture);
    if (!p->status)
        cg_ring_end(p, &b->frame);
}

/* What the semantics say the surface is: its feature. The object's own, where they say nothing. CG_NONE: it is left
 * out. */
static uint32_t feature_of(builder *b, size_t semantics) {
    static const char *const otherwise[][2] = { { "TransportationMarking", "Marking" },
                                                { "TransportationHole", "Marking" } };
    cg_parser *p = b->r->parser;
    const json_t *surface = json_array_get(b->types, semantics);
    if (b->features[semantics] != CG_NONE)
        return b->features[semantics];
    const char *name = cj_text(surface, "type");
    for (size_t i = 0; i < NOC_COUNT(otherwise); i++)
        if (!strcmp(name, otherwise[i][0]))
            name = otherwise[i][1];
    const cg_feature_type *type = cg_feature_type_of(name);
    if (!type || type->part == CG_PART_BODY || type->part == CG_PART_INSTALLATION || type->part == CG_PART_SPACE ||
        type->part == CG_PART_GROUP)
        return b->features[semantics] = b->feature;
    uint32_t feature = cg_feature_add(p, type, "", b->feature);
    if (feature == CG_NONE)
        return CG_NONE;
    const char *function = cj_text(surface, "function");
    p->object.features.data[feature].first_geometry = p->object.features.data[feature].end_geometry = 0;
    if (*function)
        cg_word_add(p, feature, "function", function);
    return b->features[semantics] = feature;
}

/* Where the polygon goes: false if it is left out. `semantics` is type_count where it has none. */
static bool choose_geometry(builder *b, size_t semantics) {
    cg_parser *p = b->r->parser;
    if (b->open && semantics == b->last)
        return b->frame.geometry != CG_NONE;
    uint32_t feature = semantics < b->type_count ? feature_of(b, semantics) : b->feature;
    b->open = true;
    b->last = semantics;
    b->frame.geometry = CG_NONE;
    if (feature == CG_NONE || p->status || !cg_object_room(p))
        return false;
    b->frame.feature = feature;
    b->frame.geometry = (uint32_t)p->object.geometries.len;
    const cg_geometry geometry = { b->lod, b->role, feature, b->implicit };
    if (!array_push(&p->object.geometries, geometry))
        cg_no_memory(p);
    return !p->status;
}

static void read_surface(builder *b, const json_t *rings, const json_t *value) {
    cg_parser *p = b->r->parser;
    size_t semantics = b->type_count;
    if (json_is_integer(value) && json_integer_value(value) >= 0 &&
        (uint64_t)json_integer_value(value) < b->type_count) {
        semantics = (size_t)json_integer_value(value);
    } else if (b->meaning && value && !json_is_null(value)) {
        if (!b->semantics_flawed)
            issue(b, GEO_GUESSED, "semantics that are not there");
        b->semantics_flawed = true;
    }
    if (!json_array_size(rings)) {
        not_nested(b);
        return;
    }
    if (!choose_geometry(b, semantics))
        return;
    const json_t *texture = cj_texture_at(&b->themes, b->path, b->depth);
    cg_polygon_begin(p, NULL, false);
    p->polygon_material = cj_material_at(&b->themes, b->path, b->depth);
    for (size_t i = 0; i < json_array_size(rings) && !p->status; i++)
        read_ring(b, json_array_get(rings, i), json_array_get(texture, i), i == 0);
    if (!p->status)
        cg_polygon_end(p, &b->frame);
    if (!p->status && ++b->surfaces % ASK == 0 && !p->sink->progress(p->sink->ctx, noc_stream_progress(p->stream)))
        p->status = NOC_ERR_CANCELLED;
}

/* depth 1: a list of surfaces; 2: of shells; 3: of solids. */
static void walk(builder *b, const json_t *boundaries, const json_t *values, int depth) {
    if (!json_is_array(boundaries)) {
        not_nested(b);
        return;
    }
    for (size_t i = 0; i < json_array_size(boundaries) && !b->r->parser->status; i++) {
        const json_t *part = json_array_get(boundaries, i), *value = json_array_get(values, i);
        if (depth == 2 && i > 0) {
            issue(b, GEO_SPARED, "shell of a hollow in a solid, left out, it is inside");
            break;
        }
        b->path[b->depth - depth] = i;
        if (depth == 1)
            read_surface(b, part, value);
        else
            walk(b, part, value, depth - 1);
    }
}

/* ---- geometries ---- */

/* 2.2 is 22; -1: it does not say. Numbers are of CityJSON 1.0, texts of later ones. */
static int level_of(const json_t *geometry) {
    const json_t *lod = json_object_get(geometry, "lod");
    double value;
    if (json_is_number(lod))
        value = json_number_value(lod);
    else if (!json_is_string(lod) || !noc_parse_double(json_string_value(lod), &value))
        return -1;
    return value >= 0 ? (int)lround(10 * fmin(value, LEVELS - 0.1)) : -1;
}

/* How deep its lists of surfaces lie; 0: it has none. */
static int depth_of(const char *type) {
    static const char *const types[][2] = { { "MultiSurface", "CompositeSurface" },
                                            { "Solid", "" },
                                            { "MultiSolid", "CompositeSolid" } };
    for (size_t i = 0; i < NOC_COUNT(types) && *type; i++)
        if (!strcmp(type, types[i][0]) || !strcmp(type, types[i][1]))
            return (int)i + 1;
    return 0;
}

static bool is_instance(const json_t *geometry) { return !strcmp(cj_text(geometry, "type"), "GeometryInstance"); }

/* What an instance places; the geometry itself where it is none; NULL: a template that is not there. */
static const json_t *content_of(const cj_reading *r, const json_t *geometry) {
    if (!is_instance(geometry))
        return geometry;
    const json_t *template = json_object_get(geometry, "template");
    json_int_t i = json_integer_value(template);
    return json_is_integer(template) && i >= 0 ? json_array_get(r->templates, (size_t)i) : NULL;
}

static bool place_instance(builder *b, const json_t *geometry) {
    cg_parser *p = b->r->parser;
    const double *point = place_of(b, geometry);
    const json_t *matrix = json_object_get(geometry, "transformationMatrix");
    if (!point) {
        issue(b, GEO_SKIPPED, "implicit geometry without a reference point");
        return false;
    }
    if (!cg_object_room(p))
        return false;
    if (!(b->implicit = arena_alloc(&p->object.arena, sizeof(*b->implicit)))) {
        cg_no_memory(p);
        return false;
    }
    bool good = json_array_size(matrix) == 16;
    for (size_t i = 0; i < 16; i++) {
        const json_t *value = json_array_get(matrix, i);
        good = good && json_is_number(value);
        b->implicit->matrix[i] = good ? json_number_value(value) : 0;
    }
    for (size_t i = 0; i < 16 && !good; i++)
        b->implicit->matrix[i] = i % 5 == 0;
    if (!good && matrix)
        issue(b, GEO_GUESSED, "transformation matrix that is not 4 x 4, left out");
    memcpy(b->implicit->point, point, sizeof(b->implicit->point));
    b->implicit->srs = b->r->srs;
    b->implicit->has_point = true;
    b->points = &b->r->template_vertices;
    return true;
}

/* Lamps may be points; of other objects points and lines are not drawn. */
static void read_other(builder *b, const json_t *geometry) {
    cg_object *object = &b->r->parser->object;
    const char *type = cj_text(geometry, "type");
    bool points = !strcmp(type, "MultiPoint");
    const double *point = place_of(b, geometry);
    if (points && point && b->feature == 0 && cg_may_be_lamp(object->features.data[0].type)) {
        if (!object->has_point)
            memcpy(object->point, point, sizeof(object->point));
        object->has_point = true;
        object->point_srs = b->r->srs;
    } else {
        issue(b, GEO_SKIPPED,
              points                             ? "points, which are not drawn"
              : !strcmp(type, "MultiLineString") ? "lines, which are not drawn"
                                                 : "geometry of a type that is not known");
    }
}

static void read_geometry(cj_reading *r, uint32_t feature, const char *id, const json_t *geometry, int level) {
    builder b = { .r = r,
                  .frame = { .feature = feature, .geometry = CG_NONE, .srs = r->srs },
                  .points = &r->vertices,
                  .feature = feature,
                  .id = id,
                  .lod = (uint8_t)(level / 10) };
    const json_t *content = content_of(r, geometry), *semantics = json_object_get(content, "semantics");
    int depth = depth_of(cj_text(content, "type"));
    if (content != geometry && !place_instance(&b, geometry))
        return;
    b.types = json_object_get(semantics, "surfaces");
    b.type_count = json_array_size(b.types);
    b.meaning = json_is_object(semantics);
    bool building = r->parser->object.features.data[feature].type->kind == GEO_BUILDING;
    b.role = b.meaning || depth == 1 ? CG_ROLE_SURFACES : CG_ROLE_SOLID;
    if (building && b.lod == 0 && !b.meaning)
        b.role = CG_ROLE_FOOTPRINT;
    if (!(b.features = noc_calloc(b.type_count + 1, sizeof(*b.features)))) {
        cg_no_memory(r->parser);
        return;
    }
    memset(b.features, 0xff, b.type_count * sizeof(*b.features));
    b.themes = cj_themes_of(content == geometry && r->own_looks.there ? &r->own_looks : &r->head_looks, content);
    b.depth = depth;
    walk(&b, json_object_get(content, "boundaries"), json_object_get(semantics, "values"), depth);
    if (b.themes.missing)
        issue(&b, GEO_GUESSED, "material, texture or place in one that is not there");
    free(b.features);
}

/* The best of each level. Terrain has no levels that its parts could differ in: the best at or under the highest asked
 * for, or the lowest that there is. */
static void find_best(const cj_reading *r, const json_t *list, bool terrain, int best[LEVELS]) {
    int highest = -1, lowest = -1;
    for (int i = 0; i < LEVELS; i++)
        best[i] = -1;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *content = content_of(r, json_array_get(list, i));
        int level = level_of(content);
        if (level < 0 || !depth_of(cj_text(content, "type")))
            continue;
        best[level / 10] = NOC_MAX(best[level / 10], level);
        lowest = lowest < 0 ? level : NOC_MIN(lowest, level);
        highest = level / 10 <= r->parser->max_lod ? NOC_MAX(highest, level) : highest;
    }
    int only = highest < 0 ? lowest : highest;
    for (int i = 0; terrain && i < LEVELS; i++)
        best[i] = only >= 0 && only / 10 == i ? only : -1;
}

void cj_geometries(cj_reading *r, uint32_t feature, const json_t *list) {
    cg_parser *p = r->parser;
    int best[LEVELS];
    const char *id = cg_report_id(p, NULL, feature);
    find_best(r, list, p->object.features.data[0].type->kind == GEO_TERRAIN, best);
    for (size_t i = 0; i < json_array_size(list) && !p->status; i++) {
        const json_t *geometry = json_array_get(list, i), *content = content_of(r, geometry);
        builder b = { .r = r, .points = &r->vertices, .feature = feature, .id = id };
        if (!content) {
            issue(&b, GEO_SKIPPED, "template that is not there");
        } else if (!depth_of(cj_text(content, "type"))) {
            read_other(&b, geometry);
        } else {
            int level = level_of(content);
            if (level < 0) {
                issue(&b, GEO_GUESSED, "geometry without a level of detail, always drawn");
                level = 10 * p->max_lod;
            } else if (level != best[level / 10]) {
                continue;
            }
            read_geometry(r, feature, id, geometry, level);
        }
    }
}
