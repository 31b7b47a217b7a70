/* parse.c: from XML events to one top-level object at a time. */
#include "import/citygml/citygml.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static size_t line_of(const cg_parser *p) { return p->lines + XML_GetCurrentLineNumber(p->xml); }

noc_status cg_fail(cg_parser *p, noc_status status, const char *fmt, ...) {
    if (p->status)
        return p->status;
    char cause[512];
    va_list ap;
    va_start(ap, fmt);
    noc_vsnprintf(cause, sizeof(cause), fmt, ap);
    va_end(ap);
    if (!p->xml)
        return p->status = noc_error(p->sink->log, status, "%s: %s", p->place, cause);
    p->status = noc_error(p->sink->log, status, "%s:%zu: %s", noc_stream_name(p->stream), line_of(p), cause);
    XML_StopParser(p->xml, XML_FALSE);
    return p->status;
}

bool cg_in_turn(cg_parser *p) {
    if (p->ahead)
        cg_stop(p, NOC_ERR_UNSUPPORTED);
    return !p->ahead;
}

double cg_progress(const cg_parser *p) {
    return p->ahead || !p->pass ? 0 : p->pass == 1 ? noc_stream_progress(p->stream) : 1;
}

noc_status cg_no_memory(cg_parser *p) { return cg_fail(p, NOC_ERR_MEMORY, "out of memory"); }

void cg_issue(cg_parser *p, geo_issue_kind kind, const char *reason, const char *id) {
    if (p->pass == 1)
        geo_issue(p->sink->issues, kind, reason, id);
}

void cg_affords(cg_parser *p, size_t bytes, const char *what) {
    const import_budget *budget = noc_stream_budget(p->stream);
    if (p->status || import_fits(budget, (double)bytes))
        return;
    char named[160];
    noc_snprintf(named, sizeof(named), "%s (\"%.80s\")", what, cg_report_id(p, NULL, 0));
    cg_stop(p, import_affords(budget, (double)bytes, noc_stream_name(p->stream), named, p->sink->log));
}

bool cg_object_room(cg_parser *p) {
    const cg_object *o = &p->object;
    size_t bytes = o->arena.bytes + o->features.len * sizeof(cg_feature) + o->geometries.len * sizeof(cg_geometry) +
                   o->surfaces.len * sizeof(cg_surface) + o->targets.len * sizeof(cg_target) +
                   o->attributes.len * sizeof(cg_attribute);
    cg_affords(p, bytes, "an object");
    return !p->status;
}

void cg_object_clear(cg_object *object) {
    arena_free(&object->arena);
    map_free(&object->ids);
    object->steps = 0;
    object->features.len = object->geometries.len = object->surfaces.len = object->targets.len =
        object->attributes.len = 0;
    object->has_point = object->other_function = false;
    object->use = NOC_USE_UNKNOWN;
    object->use_rank = 0;
    object->storeys = 0;
}

void cg_object_free(cg_object *object) {
    cg_object_clear(object);
    array_free(&object->features);
    array_free(&object->geometries);
    array_free(&object->surfaces);
    array_free(&object->targets);
    array_free(&object->attributes);
}

/* ---- attributes ---- */

typedef struct attributes {
    const char *id, *href, *srs_name, *srs_dimension, *orientation, *code_space, *decimal, *cs, *ts, *uom, *name;
} attributes;

static attributes read_attributes(const XML_Char **list) {
    attributes a = { 0 };
    for (; *list; list += 2) {
        const char *name = list[0], *value = list[1];
        switch (*name) {
        case 'h': /* "http://...\nlocal" */
            if (!strncmp(name, "http://www.opengis.net/gml", 26) && !strcmp(cg_local_name(name), "id"))
                a.id = value;
            else if (!strcmp(name, "http://www.w3.org/1999/xlink\nhref"))
                a.href = value;
            break;
        case 's':
            if (!strcmp(name, "srsName"))
                a.srs_name = value;
            else if (!strcmp(name, "srsDimension"))
                a.srs_dimension = value;
            break;
        case 'o':
            if (!strcmp(name, "orientation"))
                a.orientation = value;
            break;
        case 'd':
            if (!strcmp(name, "decimal"))
                a.decimal = value;
            break;
        case 'c':
            if (!strcmp(name, "codeSpace"))
                a.code_space = value;
            else if (!strcmp(name, "cs"))
                a.cs = value;
            break;
        case 't':
            if (!strcmp(name, "ts"))
                a.ts = value;
            break;
        case 'u':
            if (!strcmp(name, "uom"))
                a.uom = value;
            break;
        case 'n':
            if (!strcmp(name, "name"))
                a.name = value;
            break;
        default: break;
        }
    }
    return a;
}

uint32_t cg_srs(cg_parser *p, const char *name, const char *place) {
    for (uint32_t i = 0; i < p->srs_count; i++)
        if (!strcmp(p->srs[i].name, name))
            return i;
    if (!cg_in_turn(p))
        return 0;
    if (p->srs_count == CG_MAX_CRS) {
        cg_fail(p, NOC_ERR_FORMAT, "more than %d coordinate reference systems in one file", CG_MAX_CRS);
        return 0;
    }
    p->srs[p->srs_count].name = arena_strdup(&p->persistent, name);
    p->srs[p->srs_count].place = arena_strdup(&p->persistent, place);
    if (p->persistent.refused) {
        cg_no_memory(p);
        return 0;
    }
    return p->srs_count++;
}

static uint32_t intern_srs(cg_parser *p, const char *name) {
    char *place = noc_format("%s:%zu", noc_stream_name(p->stream), line_of(p));
    if (!place)
        cg_no_memory(p);
    uint32_t srs = place ? cg_srs(p, name, place) : 0;
    free(place);
    return srs;
}

static void inherit_geometry(cg_parser *p, cg_frame *frame, const attributes *a) {
    long long dimension;
    if (a->srs_name && *a->srs_name)
        frame->srs = intern_srs(p, a->srs_name);
    if (noc_parse_int(a->srs_dimension, &dimension))
        frame->dimension = dimension == 2 || dimension == 3 ? (uint32_t)dimension : 99;
}

/* ---- elements ---- */

static void add_reference(cg_parser *p, const cg_frame *frame, const char *href) {
    cg_object *object = &p->object;
    if (href[0] != '#' || !href[1]) {
        cg_issue(p, GEO_SKIPPED, href[0] == '#' || !href[0] ? "unresolved xlink" : "xlink into another file", href);
        return;
    }
    if (!cg_object_room(p))
        return;
    cg_surface surface = { .href = arena_strdup(&object->arena, href + 1),
                           .geometry = frame->geometry,
                           .flip = frame->flip };
    if (!surface.href || !array_push(&object->surfaces, surface))
        cg_no_memory(p);
}

/* The element has an id that references may lead to. */
static void remember_id(cg_parser *p, cg_frame *frame, const char *id) {
    frame->first_surface = (uint32_t)p->object.surfaces.len;
    if (!id || p->object.features.data[0].type->kind == GEO_TERRAIN)
        return;
    if (!(frame->id = arena_strdup(&p->object.arena, id)))
        cg_no_memory(p);
}

static bool start_root(cg_parser *p, const cg_frame *frame, const char *name) {
    if (frame->name.code == CG_MODEL || frame->name.code == CG_FEATURE)
        return true;
    const char *local = cg_local_name(name);
    int length = local == name ? 0 : (int)(local - 1 - name);
    if (!strcmp(local, "CityModel"))
        cg_fail(p, NOC_ERR_UNSUPPORTED, "CityModel of the namespace \"%.*s\"; CityGML 1.0, 2.0 and 3.0 are read",
                length, name);
    else
        cg_fail(p, NOC_ERR_FORMAT, "not CityGML: the root element is <%s>", local);
    return false;
}

static bool see_version(cg_parser *p, int version) {
    static const char *const formats[] = { "CityGML", "CityGML 1.0", "CityGML 2.0", "CityGML 3.0" };
    if (version > 3) {
        cg_fail(p, NOC_ERR_UNSUPPORTED, "CityGML %d; versions 1.0, 2.0 and 3.0 are read", version);
        return false;
    }
    p->version = version;
    *p->format = formats[version];
    return true;
}

uint32_t cg_feature_add(cg_parser *p, const cg_feature_type *type, const char *id, uint32_t parent) {
    if (type->part == CG_PART_INTERIOR) {
        char reason[80];
        snprintf(reason, sizeof(reason), "%s left out, it is inside", type->name);
        cg_issue(p, GEO_SPARED, reason, id ? id : "");
        return CG_NONE;
    }
    if (type->part == CG_PART_UNREAD) {
        cg_issue(p, GEO_SKIPPED,
                 type->kind == GEO_TERRAIN ? "relief that is not triangulated" : "object type that is not read",
                 id && *id ? id : type->name);
        return CG_NONE;
    }
    if (parent == CG_NONE) {
        cg_object_clear(&p->object);
        p->ordinal++;
    } else if (!cg_object_room(p)) {
        return CG_NONE;
    }
    cg_feature feature = { .type = type,
                           .id = id ? arena_strdup(&p->object.arena, id) : "",
                           .parent = parent,
                           .function = -1,
                           .first_geometry = (uint32_t)p->object.geometries.len };
    if (feature.id && array_push(&p->object.features, feature))
        return (uint32_t)p->object.features.len - 1;
    cg_no_memory(p);
    return CG_NONE;
}

static bool start_feature(cg_parser *p, cg_frame *frame, const attributes *a) {
    const cg_feature_type *type = &cg_feature_types[frame->name.value];
    if (p->in_polygon)
        return false;
    if (type->part == CG_PART_GROUP)
        return frame->feature == CG_NONE;
    uint32_t feature = cg_feature_add(p, type, a->id, frame->feature);
    if (feature == CG_NONE)
        return false;
    frame->feature = feature;
    frame->geometry = CG_NONE;
    frame->flip = frame->in_reference_point = frame->in_point = false;
    return true;
}

static bool start_geometry_property(cg_parser *p, cg_frame *frame, const attributes *a) {
    if (frame->feature == CG_NONE || frame->geometry != CG_NONE || !cg_object_room(p) ||
        p->object.features.data[frame->feature].type->part == CG_PART_SPACE)
        return false;
    cg_geometry geometry = { .lod = frame->name.value >> 4, .role = frame->name.value & 15, .feature = frame->feature };
    const cg_feature_type *type = p->object.features.data[frame->feature].type;
    bool surfaces = geometry.role == CG_ROLE_SURFACES && geometry.lod == 0;
    if (surfaces && type->kind == GEO_BUILDING && type->part == CG_PART_BODY)
        geometry.role = CG_ROLE_FOOTPRINT; /* of 3.0, whose edges of roofs are surfaces of a roof */
    if (geometry.role == CG_ROLE_FOOTPRINT || geometry.role == CG_ROLE_ROOF_EDGE)
        geometry.lod = 0; /* flat outlines, whatever level they claim */
    frame->geometry = (uint32_t)p->object.geometries.len;
    if (!array_push(&p->object.geometries, geometry))
        cg_no_memory(p);
    else if (a->href)
        add_reference(p, frame, a->href);
    return true;
}

static bool start_implicit(cg_parser *p, cg_frame *frame) {
    cg_implicit *implicit = arena_alloc(&p->object.arena, sizeof(*implicit));
    if (!implicit) {
        cg_no_memory(p);
        return false;
    }
    for (int i = 0; i < 4; i++)
        implicit->matrix[i * 5] = 1;
    implicit->srs = frame->srs;
    p->object.geometries.data[frame->geometry].implicit = implicit;
    frame->first_surface = (uint32_t)p->object.surfaces.len;
    return true;
}

static cg_implicit *implicit_of(cg_parser *p, const cg_frame *frame) {
    return frame->geometry == CG_NONE ? NULL : p->object.geometries.data[frame->geometry].implicit;
}

static bool start_polygon(cg_parser *p, cg_frame *frame, const attributes *a) {
    if (frame->geometry == CG_NONE || p->in_polygon)
        return false;
    remember_id(p, frame, a->id);
    const char *id = frame->id;
    if (!id && a->id) {
        p->terrain_id.len = 0;
        if (!array_append(&p->terrain_id, a->id, strlen(a->id) + 1))
            cg_no_memory(p);
        id = p->terrain_id.data;
    }
    cg_polygon_begin(p, id, frame->name.value == CG_SIMPLE);
    return true;
}

static bool start_coordinates(cg_parser *p, const cg_frame *frame, const attributes *a) {
    if (!p->in_ring && !frame->in_reference_point && !frame->in_point)
        return false;
    if (a->srs_name) /* given this late, it holds for the whole polygon */
        for (uint32_t i = p->depth; i-- > 0 && p->frames[i].geometry != CG_NONE;)
            if (p->frames[i].name.code == CG_POLYGON)
                p->frames[i].srs = frame->srs;
    p->text = CG_TEXT_NUMBERS;
    if (frame->name.code == CG_COORDINATES)
        cg_numbers_begin(&p->numbers, a->decimal ? *a->decimal : '.', a->cs ? *a->cs : ',', a->ts ? *a->ts : ' ');
    else
        cg_numbers_begin(&p->numbers, '.', 0, 0);
    return true;
}

static bool start_envelope(cg_parser *p, const attributes *a) {
    /* model or object / boundedBy / Envelope: the srsName holds for all that follows in the first. */
    if (a->srs_name && *a->srs_name && p->depth >= 3 && p->frames[p->depth - 2].name.code == CG_BOUNDED_BY)
        p->frames[p->depth - 3].srs = intern_srs(p, a->srs_name);
    return false;
}

/* Is it kept what it is called? */
static bool says_of_itself(const cg_parser *p, uint32_t feature) {
    return feature == 0 || cg_may_be_lamp(p->object.features.data[feature].type);
}

static void start_word(cg_parser *p, const attributes *a) {
    const char *space = a->code_space ? a->code_space : "";
    p->text = CG_TEXT_WORD;
    p->word_len = 0;
    p->plateau_code = strstr(space, "geospatial.jp") || (*space == '.' && strstr(space, "codelists/"));
    p->foreign_code = *space && !p->plateau_code && !strstr(space, "sig3d") && !strstr(space, "citygml") &&
                      !strstr(space, "opengis") && !strstr(space, "CityFurniture_");
    snprintf(p->uom, sizeof(p->uom), "%s", a->uom ? a->uom : "");
}

static bool start_exterior(cg_parser *p, const cg_frame *frame, const attributes *a) {
    if (p->in_polygon || frame->geometry == CG_NONE)
        return p->in_polygon;
    if (a->href) /* a solid's shell */
        add_reference(p, frame, a->href);
    return true;
}

/* Returns false to skip the element with all in it. */
static bool enter(cg_parser *p, cg_frame *frame, cg_frame *parent, const char *name, const XML_Char **list) {
    cg_code code = frame->name.code;
    bool plain = code == CG_PLAIN && parent && parent->name.code == CG_MEMBER && frame->name.version;
    if (code == CG_FOREIGN || plain) {
        cg_unread(p, frame, parent, name);
        return false;
    }
    attributes a = read_attributes(list);
    bool in_geometry = frame->geometry != CG_NONE;
    switch (code) {
    case CG_FEATURE: return start_feature(p, frame, &a);
    case CG_GEOMETRY_PROPERTY: return start_geometry_property(p, frame, &a);
    case CG_FUNCTION:
        if (frame->feature == CG_NONE || in_geometry)
            return false;
        start_word(p, &a);
        return true;
    case CG_LABEL:
        if (frame->feature == CG_NONE || in_geometry || !says_of_itself(p, frame->feature))
            return false;
        start_word(p, &a);
        return true;
    case CG_ATTRIBUTE: return cg_attribute_start(p, frame, a.name);
    case CG_ATTRIBUTE_NAME:
    case CG_ATTRIBUTE_VALUE:
        if (frame->in_attribute || (parent && parent->name.code == CG_HEIGHT && frame->feature != CG_NONE))
            start_word(p, &a);
        return true;
    case CG_POINT:
        frame->in_point = in_geometry && frame->feature == 0 && !p->in_polygon && !frame->in_reference_point &&
                          !implicit_of(p, frame) && cg_may_be_lamp(p->object.features.data[0].type);
        inherit_geometry(p, frame, &a);
        return true;
    case CG_IMPLICIT: return in_geometry && !implicit_of(p, frame) && start_implicit(p, frame);
    case CG_MATRIX:
        p->text = implicit_of(p, frame) ? CG_TEXT_NUMBERS : CG_TEXT_NONE;
        cg_numbers_begin(&p->numbers, '.', 0, 0);
        return implicit_of(p, frame) != NULL;
    case CG_REFERENCE_POINT:
        frame->in_reference_point = implicit_of(p, frame) != NULL && !p->in_polygon;
        return frame->in_reference_point;
    case CG_ENVELOPE: return start_envelope(p, &a);
    case CG_SURFACE_PROPERTY:
    case CG_RELATIVE_GEOMETRY:
        if (in_geometry && !p->in_polygon && a.href)
            add_reference(p, frame, a.href);
        return in_geometry && !p->in_polygon;
    case CG_AGGREGATE:
    case CG_ORIENTABLE:
        if (!in_geometry || p->in_polygon)
            return false;
        inherit_geometry(p, frame, &a);
        remember_id(p, frame, a.id);
        if (code == CG_ORIENTABLE && a.orientation && !strcmp(a.orientation, "-"))
            frame->flip = !frame->flip;
        return true;
    case CG_POLYGON: inherit_geometry(p, frame, &a); return start_polygon(p, frame, &a);
    case CG_EXTERIOR:
    case CG_INTERIOR: return start_exterior(p, frame, &a);
    case CG_RING:
        if (!p->in_polygon || p->in_ring)
            return false;
        cg_ring_begin(p, parent->name.code != CG_INTERIOR, a.id);
        return true;
    case CG_ARC: p->ring_curved = true; return p->in_ring;
    case CG_POS_LIST:
    case CG_POS:
    case CG_COORDINATES: inherit_geometry(p, frame, &a); return start_coordinates(p, frame, &a);
    default: /* models, members, boundedBy */ return true;
    }
}

void cg_start_element(void *user, const XML_Char *name, const XML_Char **list) {
    cg_parser *p = user;
    if (p->status)
        return;
    if (p->depth + p->skip >= CG_MAX_DEPTH) {
        cg_fail(p, NOC_ERR_FORMAT, "elements nested deeper than %d", CG_MAX_DEPTH);
        return;
    }
    if (p->skip) {
        p->skip++;
        return;
    }
    cg_frame *parent = p->depth ? &p->frames[p->depth - 1] : NULL;
    cg_frame *frame = &p->frames[p->depth++];
    *frame = parent ? *parent : (cg_frame){ .feature = CG_NONE, .geometry = CG_NONE, .srs = CG_NONE };
    frame->id = NULL;
    frame->of_points = false;
    frame->first_polygon = p->polygons;
    frame->name = cg_names_get(&p->names, name);
    p->text = CG_TEXT_NONE;
    if (!parent && !start_root(p, frame, name))
        return;
    if (frame->name.version && !p->version && !see_version(p, frame->name.version))
        return;
    if (!enter(p, frame, parent, name, list)) {
        p->depth--;
        p->skip = 1;
    }
}

/* ---- ends of elements ---- */

static void end_point(cg_parser *p, const cg_frame *frame) {
    cg_object *object = &p->object;
    cg_numbers_end(&p->numbers);
    size_t count = p->numbers.values.len;
    if (p->numbers.bad || (count != 2 && count != 3) || object->has_point)
        return;
    object->has_point = true;
    object->point_srs = frame->srs;
    object->point[2] = NAN;
    memcpy(object->point, p->numbers.values.data, count * sizeof(double));
}

static void end_position(cg_parser *p, const cg_frame *frame) {
    if (frame->in_point) {
        end_point(p, frame);
        return;
    }
    if (!frame->in_reference_point) {
        cg_ring_add(p, frame->name.code, frame->dimension);
        return;
    }
    cg_implicit *implicit = implicit_of(p, frame);
    cg_numbers_end(&p->numbers);
    size_t count = p->numbers.values.len;
    if (p->numbers.bad || (count != 2 && count != 3))
        return; /* no point: counted at the end of the implicit geometry */
    memcpy(implicit->point, p->numbers.values.data, count * sizeof(double));
    implicit->has_point = true;
    implicit->srs = frame->srs;
}

static void end_matrix(cg_parser *p, const cg_frame *frame) {
    cg_numbers_end(&p->numbers);
    size_t count = p->numbers.values.len;
    if (!p->numbers.bad && (count == 16 || count == 12))
        memcpy(implicit_of(p, frame)->matrix, p->numbers.values.data, count * sizeof(double));
    else
        cg_issue(p, GEO_GUESSED, "transformation matrix that is not 4 x 4, left out",
                 cg_report_id(p, NULL, frame->feature));
}

static void end_implicit(cg_parser *p, const cg_frame *frame) {
    const char *id = cg_report_id(p, NULL, frame->feature);
    if (frame->first_surface == p->object.surfaces.len) {
        cg_issue(p, GEO_SKIPPED, "implicit geometry in an external file", id);
    } else if (!implicit_of(p, frame)->has_point) {
        cg_issue(p, GEO_SKIPPED, "implicit geometry without a reference point", id);
        p->object.surfaces.len = frame->first_surface;
        while (p->object.targets.len && p->object.targets.data[p->object.targets.len - 1].first >= frame->first_surface)
            p->object.targets.len--;
    }
}

void cg_word_add(cg_parser *p, uint32_t index, const char *key, const char *word) {
    cg_feature *feature = &p->object.features.data[index];
    cg_note_building(p, index, key, word);
    if (says_of_itself(p, index))
        cg_attribute_add(p, index, key, word, false);
    bool furniture = feature->type->kind == GEO_FURNITURE;
    bool function = !strcmp(key, "function") || !strcmp(key, "usage") || !strcmp(key, "class");
    long long code;
    if (!function || (furniture && p->foreign_code && noc_parse_int(word, &code)))
        return;
    if (feature->function < 0)
        feature->function = cg_function_class(feature->type, word, p->plateau_code);
    p->object.other_function |=
        furniture && index == 0 && !p->plateau_code && feature->function < 0 && cg_standard_function(word);
}

static void end_word(cg_parser *p, const cg_frame *frame, const char *key) {
    p->word[p->word_len] = 0;
    cg_word_add(p, frame->feature, key, p->word);
}

void cg_end_element(void *user, const XML_Char *name) {
    cg_parser *p = user;
    if (p->status)
        return;
    if (p->skip) {
        p->skip--;
        return;
    }
    const cg_frame *frame = &p->frames[p->depth - 1];
    bool outer_flip = p->depth > 1 && p->frames[p->depth - 2].flip;
    switch ((cg_code)frame->name.code) {
    case CG_POS_LIST:
    case CG_POS:
    case CG_COORDINATES: end_position(p, frame); break;
    case CG_MATRIX: end_matrix(p, frame); break;
    case CG_FUNCTION:
    case CG_LABEL: end_word(p, frame, cg_local_name(name)); break;
    case CG_ATTRIBUTE_NAME:
    case CG_ATTRIBUTE_VALUE: cg_attribute_end(p, frame); break;
    case CG_AGGREGATE: cg_tin_end(p, frame); break;
    case CG_RING: cg_ring_end(p, frame); break;
    case CG_POLYGON: cg_polygon_end(p, frame); break;
    case CG_IMPLICIT: end_implicit(p, frame); break;
    case CG_FEATURE:
        if (frame->feature != CG_NONE)
            p->object.features.data[frame->feature].end_geometry = (uint32_t)p->object.geometries.len;
        if (frame->feature == 0)
            cg_object_end(p);
        break;
    default: break;
    }
    const cg_target target = { .id = frame->id,
                               .first = frame->first_surface,
                               .flip = outer_flip,
                               .count = (uint32_t)p->object.surfaces.len - frame->first_surface };
    if (p->numbers.refused || (frame->id && !array_push(&p->object.targets, target)))
        cg_no_memory(p);
    p->text = CG_TEXT_NONE;
    p->depth--;
}

void cg_characters(void *user, const XML_Char *text, int size) {
    cg_parser *p = user;
    if (p->skip || p->text == CG_TEXT_NONE || p->status)
        return;
    if (p->text == CG_TEXT_NUMBERS) {
        cg_numbers_add(&p->numbers, text, (size_t)size);
        return;
    }
    size_t room = sizeof(p->word) - 1 - p->word_len, n = NOC_MIN((size_t)size, room);
    memcpy(p->word + p->word_len, text, n);
    p->word_len += (uint32_t)n;
}
