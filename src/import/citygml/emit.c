/* emit.c: complete objects to the sink; surfaces that other objects refer to into the store. */
#include "import/citygml/citygml.h"

#include <math.h>
#include <stdio.h>

void cg_stop(cg_parser *p, noc_status status) {
    if (!status || p->status)
        return;
    p->status = status; /* the sink has reported it */
    if (p->xml)
        XML_StopParser(p->xml, XML_FALSE);
}

/* ---- coordinates ---- */

/* Tells the sink the CRS of what comes next. Polygons without one take the first that the file names. */
void cg_tell_crs(cg_parser *p, uint32_t srs) {
    if (srs == CG_NONE && p->srs_count)
        srs = 0;
    if (srs == p->sink_srs)
        return;
    p->sink_srs = srs;
    p->lat_first = false;
    const char *place = srs == CG_NONE ? noc_stream_name(p->stream) : p->srs[srs].place;
    cg_stop(p, p->sink->crs(p->sink->ctx, srs == CG_NONE ? NULL : p->srs[srs].name, place, &p->lat_first));
}

/* Latitude comes first in geographic CRSs and hardly elsewhere, where it would be no latitude. */
static bool in_degrees(const cg_parser *p, const double *point) {
    return p->lat_first && fabs(point[0]) <= 180 && fabs(point[1]) <= 90;
}

/* Metres east and north of a point, a degree, on the GRS 80 ellipsoid. */
static void metres_a_degree(double latitude, double *east, double *north) {
    const double a = 6378137, e2 = 0.00669438002290, degree = 0.017453292519943295;
    double sine = sin(latitude * degree), w = 1 - e2 * sine * sine;
    *east = a / sqrt(w) * cos(latitude * degree) * degree;
    *north = a * (1 - e2) / (w * sqrt(w)) * degree;
}

void cg_metres(const cg_parser *p, const double *point, double *east, double *north) {
    *east = *north = 1;
    if (in_degrees(p, point))
        metres_a_degree(point[1], east, north);
}

/* A prototype's point: turned and scaled, in metres about the reference point. */
void cg_place_point(const cg_parser *p, const cg_implicit *implicit, double *point) {
    const double *m = implicit->matrix;
    double local[3], anchor[3];
    for (int i = 0; i < 3; i++)
        local[i] = m[4 * i] * point[0] + m[4 * i + 1] * point[1] + m[4 * i + 2] * point[2] + m[4 * i + 3];
    anchor[0] = implicit->point[p->lat_first ? 1 : 0];
    anchor[1] = implicit->point[p->lat_first ? 0 : 1];
    anchor[2] = implicit->point[2];
    double east, north;
    cg_metres(p, anchor, &east, &north);
    point[0] = anchor[0] + (fabs(east) > 1e-6 ? local[0] / east : 0);
    point[1] = anchor[1] + local[1] / north;
    point[2] = anchor[2] + local[2];
}

/* Counts the points of an instance, of which a few bytes can place millions. */
static void count_instance(cg_parser *p, const cg_polygon *polygon) {
    for (uint32_t r = 0; r < polygon->ring_count; r++)
        p->instanced += (double)polygon->ring_size[r];
    cg_stop(p, import_affords_instances(noc_stream_budget(p->stream), p->instanced, noc_stream_name(p->stream),
                                        p->sink->log));
}

/* Into p->out, p->out_rings: easting northing height, turned over where asked. p->status tells where memory is refused.
 */
void cg_transform(cg_parser *p, const cg_polygon *polygon, const cg_implicit *implicit, bool flip) {
    p->out.len = p->out_rings.len = p->out_uv.len = 0;
    if (implicit)
        count_instance(p, polygon);
    if (p->status)
        return;
    const double *in = polygon->xyz;
    const float *uv = polygon->uv;
    for (uint32_t r = 0; r < polygon->ring_count; r++) {
        size_t points = polygon->ring_size[r], first = p->out.len, numbers = 3 * points;
        if (!array_push(&p->out_rings, points) || !array_append(&p->out, in, numbers)) {
            cg_no_memory(p);
            return;
        }
        size_t places = 2 * points;
        if (uv && !array_append(&p->out_uv, uv, places)) {
            cg_no_memory(p);
            return;
        }
        for (size_t i = 0; uv && flip && i < points; i++)
            memcpy(p->out_uv.data + p->out_uv.len - 2 * (i + 1), uv + 2 * i, 2 * sizeof(*uv));
        uv = uv ? uv + 2 * points : NULL;
        for (size_t i = 0; flip && i < points; i++)
            memcpy(p->out.data + first + 3 * i, in + 3 * (points - 1 - i), 3 * sizeof(double));
        in += numbers;
    }
    for (size_t i = 0; i < p->out.len; i += 3) {
        double *point = p->out.data + i;
        if (implicit) {
            cg_place_point(p, implicit, point);
        } else if (p->lat_first) {
            double latitude = point[0];
            point[0] = point[1];
            point[1] = latitude;
        }
    }
}

/* ---- classes ---- */

/* Of a polygon that says nothing of itself: up is roof, down is ground, the rest wall. */
static noc_class class_by_normal(const cg_parser *p) {
    const double *xyz = p->out.data;
    double east, north, n[3] = { 0 };
    cg_metres(p, xyz, &east, &north);
    size_t points = p->out_rings.data[0];
    for (size_t i = 0; i < points; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            double scale = k == 0 ? east : k == 1 ? north : 1;
            a[k] = (xyz[3 * i + k] - xyz[k]) * scale;
            b[k] = (xyz[3 * ((i + 1) % points) + k] - xyz[k]) * scale;
        }
        n[0] += a[1] * b[2] - a[2] * b[1];
        n[1] += a[2] * b[0] - a[0] * b[2];
        n[2] += a[0] * b[1] - a[1] * b[0];
    }
    double steep = 0.25 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]); /* walls lean by less than 15 degrees */
    return n[2] > steep ? NOC_CLASS_ROOF : n[2] < -steep ? NOC_CLASS_GROUND : NOC_CLASS_WALL;
}

static noc_class class_of(const cg_parser *p, const cg_geometry *g) {
    const cg_feature *feature = &p->object.features.data[g->feature];
    const cg_feature_type *type = feature->type;
    geo_kind kind = p->object.features.data[0].type->kind;
    if (feature->function >= 0)
        return (noc_class)feature->function;
    if (kind == GEO_BRIDGE)
        return type->part == CG_PART_OPENING || type->cls == NOC_CLASS_CLOSURE ? (noc_class)type->cls
                                                                               : NOC_CLASS_BRIDGE;
    if (kind != GEO_BUILDING || type->part != CG_PART_BODY)
        return (noc_class)type->cls;
    return g->role == CG_ROLE_FOOTPRINT   ? NOC_CLASS_GROUND
           : g->role == CG_ROLE_ROOF_EDGE ? NOC_CLASS_ROOF
                                          : class_by_normal(p);
}

/* ---- objects ---- */

void cg_emit_begin(cg_parser *p) {
    const cg_feature *feature = &p->object.features.data[0];
    int lod = feature->type->kind == GEO_TERRAIN ? -1 : p->selection.lod;
    if (p->status || p->object_open)
        return;
    geo_object object = { .kind = feature->type->kind,
                          .id = feature->id,
                          .lod = lod,
                          .use = p->object.use,
                          .storeys = p->object.storeys,
                          .outline = lod == 0 && feature->type->kind == GEO_BUILDING };
    p->object_open = true;
    cg_stop(p, p->sink->begin_object(p->sink->ctx, &object));
}

void cg_emit_end(cg_parser *p) {
    if (!p->object_open)
        return;
    p->object_open = false;
    if (!p->status)
        cg_stop(p, p->sink->end_object(p->sink->ctx));
}

void cg_emit_polygon(cg_parser *p, const cg_polygon *polygon, uint32_t geometry, bool flip) {
    const cg_geometry *g = &p->object.geometries.data[geometry];
    cg_tell_crs(p, g->implicit ? g->implicit->srs : polygon->srs);
    cg_emit_begin(p);
    if (p->status)
        return;
    cg_transform(p, polygon, g->implicit, flip);
    if (p->status)
        return;
    geo_polygon out = { .cls = class_of(p, g),
                        .id = cg_report_id(p, polygon->id, g->feature),
                        .ring_count = p->out_rings.len,
                        .ring_size = p->out_rings.data,
                        .xyz = p->out.data,
                        .appearance = cg_appearance_of(p, polygon->material, polygon->texture),
                        .uv = p->out_uv.len ? p->out_uv.data : NULL };
    if (p->status)
        return;
    cg_stop(p, p->sink->polygon(p->sink->ctx, &out));
    p->emitted++;
}

void cg_emit_shown(cg_parser *p) {
    cg_selection *s = &p->selection;
    for (size_t i = 0; s->shown && i < s->items.len && !p->status; i++) {
        const cg_item *item = &s->items.data[i];
        p->twins += item->twin;
        if (item->twin)
            geo_issue(p->sink->issues, GEO_REPAIRED, "polygon given twice",
                      cg_report_id(p, item->polygon->id, p->object.geometries.data[item->geometry].feature));
        if (!item->shown)
            continue;
        cg_emit_polygon(p, item->polygon, item->geometry, item->flip);
        if (item->stored && !p->object.geometries.data[item->geometry].implicit)
            item->polygon->shown = CG_EMITTED;
    }
    cg_emit_end(p);
}

#define LEFT_OUT " left out, no geometry"

size_t cg_kinds_told(const cg_parser *p) { return geo_issues_like(p->sink->issues, LEFT_OUT); }

/* An object of which nothing is drawn is named by what it says it is, so that nothing hides behind the others. */
static void left_out(cg_parser *p, const char *under) {
    const cg_object *object = &p->object;
    if (p->pass > 1 && object->features.data[0].type->kind == GEO_TERRAIN)
        return; /* which every pass sees */
    const char *cls = cg_attribute_get(object, 0, "class"), *function = cg_attribute_get(object, 0, "function");
    char reason[200];
    if ((cls || function) && cg_kinds_told(p) >= CG_MAX_KINDS)
        cls = function = NULL;
    snprintf(reason, sizeof(reason), "%s" LEFT_OUT "%s%s%.40s%s%s%.40s%s", object->features.data[0].type->name, under,
             cls ? " (class '" : "", cls ? cls : "", cls ? "'" : "",
             function ? cls ? ", function '" : " (function '" : "", function ? function : "",
             function ? "')"
             : cls    ? ")"
                      : "");
    geo_issue(p->sink->issues, GEO_SKIPPED, reason, cg_report_id(p, NULL, 0));
}

static void emit_object(cg_parser *p) {
    cg_selection *s = &p->selection;
    for (size_t i = 0; i < s->missing.len; i++)
        geo_issue(p->sink->issues, GEO_SKIPPED, "unresolved xlink", s->missing.data[i]);
    if (s->tangled)
        geo_issue(p->sink->issues, GEO_SKIPPED, "xlinks that lead in circles", cg_report_id(p, NULL, 0));
    p->dropped += s->duplicates;
    if (cg_emit_lamp(p))
        return;
    cg_emit_installed_lamps(p);
    if (!s->shown && !s->duplicates)
        left_out(p, s->above ? " at or under the level of detail asked for" : "");
    if (!cg_emit_blocks(p))
        cg_emit_shown(p);
}

/* ---- the store ---- */

/* NULL: memory was refused. */
static cg_polygon *copy_polygon(cg_store *store, cg_polygon *polygon) {
    if (polygon->copy)
        return polygon->copy;
    cg_polygon *copy = arena_alloc(&store->arena, sizeof(*copy));
    size_t *sizes = arena_alloc(&store->arena, polygon->ring_count * sizeof(size_t));
    size_t points = 0;
    for (uint32_t r = 0; r < polygon->ring_count; r++)
        points += polygon->ring_size[r];
    double *xyz = arena_alloc(&store->arena, 3 * points * sizeof(double));
    float *uv = polygon->uv ? arena_alloc(&store->arena, 2 * points * sizeof(float)) : NULL;
    const char *id = arena_strdup(&store->arena, polygon->id);
    if (store->arena.refused)
        return NULL;
    memcpy(sizes, polygon->ring_size, polygon->ring_count * sizeof(size_t));
    memcpy(xyz, polygon->xyz, 3 * points * sizeof(double));
    *copy = *polygon;
    copy->id = id;
    copy->ring_size = sizes;
    copy->xyz = xyz;
    if (uv)
        copy->uv = memcpy(uv, polygon->uv, 2 * points * sizeof(float));
    copy->shown = 0;
    return polygon->copy = copy;
}

/* Moves the surfaces that an id led to, from position `first` of the selection, into the store. */
static void store_items(cg_parser *p, size_t first, cg_stored *stored) {
    cg_selection *s = &p->selection;
    size_t before = stored->items.cap * sizeof(cg_item), bytes = (s->items.len - first) * sizeof(cg_item);
    cg_affords(p, p->store.arena.bytes + p->store.item_bytes + s->items.cap * sizeof(cg_item) + bytes,
               "what xlinks lead to, of this object");
    if (p->status)
        return;
    if (!array_reserve(&stored->items, stored->items.len + s->items.len - first)) {
        cg_no_memory(p);
        return;
    }
    p->store.item_bytes += stored->items.cap * sizeof(cg_item) - before;
    for (size_t i = first; i < s->items.len; i++) {
        cg_item item = s->items.data[i];
        if (!item.polygon)
            continue;
        bool shown = item.stored ? item.elsewhere : item.polygon->shown == p->selections;
        cg_item kept = { .polygon = item.stored ? item.polygon : copy_polygon(&p->store, item.polygon),
                         .flip = item.flip,
                         .local = item.local,
                         .elsewhere = shown };
        if (!kept.polygon || !array_push(&stored->items, kept)) {
            cg_no_memory(p);
            return;
        }
    }
    s->items.len = first;
    stored->found = true;
}

/* Keeps what other objects want of this one. */
static void collect(cg_parser *p) {
    bool selected = false;
    for (size_t i = 0; i < p->object.targets.len && !p->status; i++) {
        const cg_target *target = &p->object.targets.data[i];
        uint64_t index;
        if (!map_get(&p->store.wanted, target->id, &index) || p->store.entries.data[index].found)
            continue;
        if (!selected) { /* to know which of them the object shows by itself */
            cg_resolve(p);
            cg_select(p);
            selected = true;
        }
        size_t first = p->selection.items.len;
        cg_follow(p, target->id, 0, false);
        store_items(p, first, &p->store.entries.data[index]);
        cg_affords(p, p->store.arena.bytes + p->store.item_bytes, "what objects share, to this one");
    }
}

static void want_missing(cg_parser *p) {
    if (!cg_in_turn(p))
        return;
    uint64_t index;
    for (size_t i = 0; i < p->selection.missing.len; i++) {
        if (map_get(&p->store.wanted, p->selection.missing.data[i], &index))
            continue;
        if (!array_push(&p->store.entries, (cg_stored){ 0 }) ||
            !map_put(&p->store.wanted, p->selection.missing.data[i], p->store.entries.len - 1, NULL)) {
            cg_no_memory(p);
            return;
        }
    }
    if (!array_push(&p->deferred, p->ordinal))
        cg_no_memory(p);
    cg_affords(p, p->store.wanted.keys.bytes + p->store.entries.len * sizeof(cg_stored),
               "references between objects, to this one");
}

void cg_store_free(cg_store *store) {
    for (size_t i = 0; i < store->entries.len; i++)
        array_free(&store->entries.data[i].items);
    array_free(&store->entries);
    map_free(&store->wanted);
    arena_free(&store->arena);
}

/* The first pass shows every object that is complete in itself; the second gathers what the others refer to, and shows
 * those whose references led backwards; the third shows the rest. */
static void finish_object(cg_parser *p) {
    if (p->pass == 2)
        collect(p);
    bool turn =
        p->pass == 1 || (p->deferred_next < p->deferred.len && p->deferred.data[p->deferred_next] == p->ordinal);
    if (!turn || p->status)
        return;
    if (p->pass > 1)
        p->deferred_next++;
    cg_resolve(p);
    if (p->status)
        return;
    if (p->selection.missing.len && p->pass == 1) {
        want_missing(p);
    } else if (p->selection.missing.len && p->pass == 2) {
        p->deferred.data[p->deferred_kept++] = p->ordinal;
    } else {
        cg_select(p);
        if (!p->status)
            emit_object(p);
    }
}

void cg_object_end(cg_parser *p) {
    cg_spread_materials(p);
    if (p->object.features.data[0].type->kind == GEO_TERRAIN) {
        for (size_t i = 0; i < p->object.surfaces.len; i++)
            cg_issue(p, GEO_SKIPPED, "unresolved xlink", p->object.surfaces.data[i].href);
        if (!p->object_open)
            left_out(p, "");
        cg_emit_end(p);
    } else {
        cg_fill_heights(p);
        finish_object(p);
    }
    cg_object_clear(&p->object);
}
