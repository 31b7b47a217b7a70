/* Shapes of Overpass JSON: lines that are roads, areas that are buildings, water, lawns or squares. A way has its
 * points in its geometry ("out geom") or in nodes of the answer; a relation in those of its members, which are joined
 * to rings.
 */
#include "import/map/outlines.h"
#include "import/map/overpass.h"
#include "import/map/roads.h"

#include <math.h>
#include <stdio.h>

/* Of a relation: joining its ways looks at all pairs, and each may be the answer's longest. */
enum { MOST_MEMBERS = 2000, MOST_POINTS = 1 << 20 };

/* A row of points, from `first` in shape_list.xyz on. */
typedef struct part {
    size_t first, count;
    bool inner, used;
} part;

typedef struct shape_list {
    lamp_writer *w;
    json_t *elements;
    noc_map known; /* numbers of nodes and ways among the elements, by "node/12" */
    bool all_known;
    overpass_tags tags;
    NOC_ARRAY(double) xyz; /* of the ways at hand */
    size_t missing;        /* points of them that the answer does not have */
    NOC_ARRAY(part) parts;
    NOC_ARRAY(double) ring_xyz;
    NOC_ARRAY(part) rings; /* in ring_xyz */
    NOC_ARRAY(double) area_xyz;
    NOC_ARRAY(size_t) area_rings;
} shape_list;

/* ---- points ---- */

static bool know_elements(shape_list *list) {
    size_t count = json_array_size(list->elements);
    for (size_t i = 0; i < count && !list->all_known; i++) {
        const json_t *element = json_array_get(list->elements, i);
        const char *type = json_string_value(json_object_get(element, "type"));
        char id[40];
        snprintf(id, sizeof(id), "%.8s/%" JSON_INTEGER_FORMAT, type ? type : "",
                 json_integer_value(json_object_get(element, "id")));
        bool wanted = overpass_is(element, "node") || overpass_is(element, "way");
        if (wanted && !map_put(&list->known, id, i, NULL))
            return false;
    }
    list->all_known = true;
    return true;
}

/* *element: NULL where the answer does not have it. False: memory was refused. */
static bool find(shape_list *list, const char *type, const json_t *id, json_t **element) {
    char key[40];
    uint64_t at;
    *element = NULL;
    if (!know_elements(list))
        return false;
    snprintf(key, sizeof(key), "%s/%" JSON_INTEGER_FORMAT, type, json_integer_value(id));
    if (map_get(&list->known, key, &at))
        *element = json_array_get(list->elements, (size_t)at);
    return true;
}

static bool add_point(shape_list *list, const json_t *at) {
    double xyz[3] = { NAN, NAN, NAN };
    bool placed = overpass_number(at, "lon", &xyz[0]) && overpass_number(at, "lat", &xyz[1]);
    list->missing += !placed;
    return !placed || array_append(&list->xyz, xyz, (size_t)3);
}

/* Adds the points of a way, or of a member: its geometry, else its nodes that are there. False: memory was refused. */
static bool trace(shape_list *list, const json_t *way) {
    const json_t *geometry = json_object_get(way, "geometry"), *nodes = json_object_get(way, "nodes");
    bool kept = true;
    for (size_t i = 0; i < json_array_size(geometry) && kept; i++)
        kept = add_point(list, json_array_get(geometry, i));
    for (size_t i = 0; i < json_array_size(nodes) && !json_array_size(geometry) && kept; i++) {
        json_t *node;
        kept = find(list, "node", json_array_get(nodes, i), &node) && add_point(list, node);
    }
    return kept;
}

/* ---- roads ---- */

static noc_status emit_road(shape_list *list) {
    geo_road road;
    if (!list->w->sink->road || list->xyz.len < 6 || /* "out tags", "out center": it stays unread */
        !road_read(list->tags.tags.data, list->tags.tags.len, &road))
        return NOC_OK;
    road.id = list->tags.id;
    road.point_count = list->xyz.len / 3;
    road.xyz = list->xyz.data;
    *(road.cls == GEO_ROAD_RAIL ? &list->w->rails : &list->w->streets) += 1;
    return list->w->sink->road(list->w->sink->ctx, &road);
}

/* ---- areas ---- */

/* What tags make of an area: a building, or something of a class. */
typedef struct area_kind {
    bool building;
    noc_class cls;
} area_kind;

static bool kind_of(const shape_list *list, area_kind *kind) {
    const lamp_tag *tags = list->tags.tags.data;
    const geo_sink *sink = list->w->sink;
    int verdict = outline_verdict(tags, list->tags.tags.len);
    *kind = (area_kind){ verdict > 0, NOC_CLASS_OTHER };
    if (verdict < 0)
        kind->cls = area_class(tags, list->tags.tags.len);
    return kind->building ? sink->footprint != NULL : kind->cls != NOC_CLASS_OTHER && sink->area;
}

/* Is a closed way with these tags an area, as GDAL has it for other files of OpenStreetMap (source.c)? */
static bool encloses(const shape_list *list) {
    static const char *const keys[] = { "building", "natural", "landuse", "waterway",
                                        "leisure",  "place",   "amenity", "area:highway" };
    bool area = false;
    for (size_t i = 0; i < list->tags.tags.len; i++) {
        const lamp_tag *tag = &list->tags.tags.data[i];
        if (!strcmp(tag->key, "area"))
            return strcmp(tag->value, "no");
        for (size_t k = 0; k < NOC_COUNT(keys); k++)
            area = area || !strcmp(tag->key, keys[k]);
    }
    return area;
}

static void leave(const shape_list *list, const char *reason) {
    geo_issue(list->w->sink->issues, GEO_SKIPPED, reason, list->tags.id);
}

static bool same_place(const double *a, const double *b) { return a[0] == b[0] && a[1] == b[1]; }

/* Adds a closed ring to the polygon, without the point that closes it. */
static bool add_ring(shape_list *list, const double *xyz, size_t count) {
    size_t first = list->area_xyz.len, numbers = 3 * (count - 1);
    if (!array_append(&list->area_xyz, xyz, numbers))
        return false;
    for (size_t i = first; i < list->area_xyz.len; i += 3)
        list->area_xyz.data[i + 2] = 0;
    return array_push(&list->area_rings, count - 1);
}

static noc_status emit_polygon(shape_list *list, const area_kind *kind) {
    const geo_sink *sink = list->w->sink;
    if (!kind->building)
        return sink->area(sink->ctx, &(geo_polygon){ kind->cls, list->tags.id, list->area_rings.len,
                                                     list->area_rings.data, list->area_xyz.data });
    geo_footprint footprint = { .id = list->tags.id };
    outline_read(list->tags.tags.data, list->tags.tags.len, &footprint);
    footprint.bare = false; /* OpenStreetMap's are metres */
    footprint.ring_count = list->area_rings.len;
    footprint.ring_size = list->area_rings.data;
    footprint.xyz = list->area_xyz.data;
    return sink->footprint(sink->ctx, &footprint);
}

static noc_status emit_outline(shape_list *list, const area_kind *kind) {
    list->area_xyz.len = list->area_rings.len = 0;
    if (!add_ring(list, list->xyz.data, list->xyz.len / 3))
        return noc_no_memory(list->w->sink->log, list->w->place);
    list->w->footprints += kind->building;
    return emit_polygon(list, kind);
}

static noc_status emit_way(shape_list *list, json_t *way) {
    const json_t *nodes = json_object_get(way, "nodes");
    size_t count = json_array_size(nodes);
    area_kind kind;
    list->xyz.len = list->missing = 0;
    if (!trace(list, way))
        return noc_no_memory(list->w->sink->log, list->w->place);
    const double *xyz = list->xyz.data;
    size_t points = list->xyz.len / 3;
    bool closed = points > 3 && same_place(xyz, xyz + 3 * (points - 1));
    closed = closed || (count > 3 && json_equal(json_array_get(nodes, 0), json_array_get(nodes, count - 1)));
    if (!closed || !encloses(list))
        return emit_road(list);
    if (!kind_of(list, &kind))
        return NOC_OK;
    if (!list->missing && points > 3)
        return emit_outline(list, &kind);
    leave(list, "area without the points of its outline: ask for it with \"out geom\"");
    return NOC_OK;
}

/* ---- relations ---- */

/* False: memory was refused. */
static bool take_member(shape_list *list, const json_t *member) {
    const char *role = json_string_value(json_object_get(member, "role"));
    part p = { .first = list->xyz.len, .inner = role && !strcmp(role, "inner") };
    json_t *way = NULL;
    if (!overpass_is(member, "way"))
        return true;
    bool own = json_array_size(json_object_get(member, "geometry")) > 0;
    if (!own && !find(list, "way", json_object_get(member, "ref"), &way))
        return false;
    if (!trace(list, own ? member : way))
        return false;
    p.count = (list->xyz.len - p.first) / 3;
    list->missing += p.count < 2;
    return array_push(&list->parts, p);
}

/* Goes on with a part that begins or ends where the ring does. False: memory was refused. *on: there was one. */
static bool go_on(shape_list *list, part *ring, bool *on) {
    const double *end = list->ring_xyz.data + 3 * (ring->first + ring->count - 1);
    *on = false;
    for (size_t i = 0; i < list->parts.len && !*on; i++) {
        part *p = &list->parts.data[i];
        const double *xyz = list->xyz.data + p->first;
        if (p->used || p->inner != ring->inner || same_place(xyz, xyz + 3 * (p->count - 1)))
            continue;
        bool forth = same_place(xyz, end), back = same_place(xyz + 3 * (p->count - 1), end);
        if (!(forth || back))
            continue;
        *on = p->used = true;
        for (size_t k = 1; k < p->count; k++)
            if (!array_append(&list->ring_xyz, xyz + 3 * (forth ? k : p->count - 1 - k), (size_t)3))
                return false;
        ring->count += p->count - 1;
    }
    return true;
}

/* Joins the parts to rings. *closed: all are. False: memory was refused. */
static bool join(shape_list *list, bool *closed) {
    *closed = true;
    for (size_t i = 0; i < list->parts.len && *closed; i++) {
        part *p = &list->parts.data[i], ring = { list->ring_xyz.len / 3, p->count, p->inner, true };
        bool on = true;
        if (p->used)
            continue;
        p->used = true;
        size_t numbers = 3 * p->count;
        if (!array_append(&list->ring_xyz, list->xyz.data + p->first, numbers))
            return false;
        do {
            const double *xyz = list->ring_xyz.data + 3 * ring.first;
            *closed = ring.count > 3 && same_place(xyz, xyz + 3 * (ring.count - 1));
            if (!*closed && !go_on(list, &ring, &on))
                return false;
        } while (!*closed && on);
        if (!array_push(&list->rings, ring))
            return false;
    }
    return true;
}

/* Does the ring hold the point? By the crossings of a line that leaves it to the east. */
static bool holds(const shape_list *list, const part *ring, const double *p) {
    const double *xyz = list->ring_xyz.data + 3 * ring->first;
    bool in = false;
    for (size_t i = 0; i + 1 < ring->count; i++) {
        const double *a = xyz + 3 * i, *b = a + 3;
        if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]))
            in = !in;
    }
    return in;
}

/* Each outer ring is a polygon, with the inner ones that it holds. */
static noc_status emit_rings(shape_list *list, const area_kind *kind) {
    noc_status status = NOC_OK;
    const double *xyz = list->ring_xyz.data;
    for (size_t i = 0; i < list->rings.len && !status; i++) {
        const part *outer = &list->rings.data[i];
        if (outer->inner)
            continue;
        list->area_xyz.len = list->area_rings.len = 0;
        bool kept = add_ring(list, xyz + 3 * outer->first, outer->count);
        for (size_t k = 0; k < list->rings.len && kept; k++) {
            const part *inner = &list->rings.data[k];
            if (inner->inner && holds(list, outer, xyz + 3 * inner->first))
                kept = add_ring(list, xyz + 3 * inner->first, inner->count);
        }
        status = kept ? emit_polygon(list, kind) : noc_no_memory(list->w->sink->log, list->w->place);
    }
    return status;
}

static noc_status emit_relation(shape_list *list, const json_t *relation) {
    const json_t *members = json_object_get(relation, "members");
    area_kind kind;
    bool multipolygon = false, kept = true, closed = false;
    for (size_t i = 0; i < list->tags.tags.len; i++)
        multipolygon = multipolygon || (!strcmp(list->tags.tags.data[i].key, "type") &&
                                        !strcmp(list->tags.tags.data[i].value, "multipolygon"));
    if (!multipolygon || !kind_of(list, &kind))
        return NOC_OK;
    if (json_array_size(members) > MOST_MEMBERS) {
        leave(list, "multipolygon of more than 2000 ways");
        return NOC_OK;
    }
    list->xyz.len = list->missing = list->parts.len = list->ring_xyz.len = list->rings.len = 0;
    for (size_t i = 0; i < json_array_size(members) && kept && list->xyz.len / 3 <= MOST_POINTS; i++)
        kept = take_member(list, json_array_get(members, i));
    if (kept && list->xyz.len / 3 > MOST_POINTS) {
        leave(list, "multipolygon of more than a million points");
        return NOC_OK;
    }
    bool whole = !list->missing && list->parts.len;
    if (kept && whole)
        kept = join(list, &closed);
    if (!kept)
        return noc_no_memory(list->w->sink->log, list->w->place);
    if (!whole)
        leave(list, "area without the points of its outline: ask for it with \"out geom\"");
    else if (!closed)
        leave(list, "multipolygon whose ways do not close");
    if (!closed)
        return NOC_OK;
    list->w->footprints += kind.building;
    return emit_rings(list, &kind);
}

static noc_status emit(shape_list *list, json_t *element) {
    bool way = overpass_is(element, "way");
    if (!(way || overpass_is(element, "relation")) || !json_object_size(json_object_get(element, "tags")))
        return NOC_OK;
    if (!overpass_collect(element, &list->tags))
        return noc_no_memory(list->w->sink->log, list->w->place);
    return way ? emit_way(list, element) : emit_relation(list, element);
}

noc_status overpass_shapes(json_t *elements, lamp_writer *w) {
    shape_list list = { .w = w, .elements = elements };
    const geo_sink *sink = w->sink;
    noc_status status = NOC_OK;
    size_t count = sink->road || sink->area || sink->footprint ? json_array_size(elements) : 0;
    for (size_t i = 0; i < count && !status; i++) {
        status = emit(&list, json_array_get(elements, i));
        if (!status && i % 1024 == 0 && sink->progress && !sink->progress(sink->ctx, 1))
            status = NOC_ERR_CANCELLED;
    }
    w->seen.streets -= NOC_MIN(w->seen.streets, w->streets);
    w->seen.buildings -= NOC_MIN(w->seen.buildings, w->footprints);
    map_free(&list.known);
    array_free(&list.tags.tags);
    array_free(&list.xyz);
    array_free(&list.parts);
    array_free(&list.ring_xyz);
    array_free(&list.rings);
    array_free(&list.area_xyz);
    array_free(&list.area_rings);
    return status;
}
