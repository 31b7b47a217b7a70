/* Shapes of maps: areas that are buildings, water, lawns or squares, lines that are roads. */
#include "import/map/features.h"
#include "import/map/outlines.h"
#include "import/map/osm_ways.h"
#include "import/map/roads.h"

#if NOC_HAVE_GDAL

#include <math.h>
#include <stdio.h>

/* ---- buildings ---- */

static bool add_ring(map_reading *m, OGRGeometryH ring) {
    int count = gdal.OGR_G_GetPointCount(ring);
    size_t first = m->xyz.len;
    for (int i = 0; i < count; i++) {
        const double xyz[3] = { gdal.OGR_G_GetX(ring, i), gdal.OGR_G_GetY(ring, i), 0 };
        if (!array_append(&m->xyz, xyz, (size_t)3))
            return false;
    }
    bool closed = count > 1 && !memcmp(m->xyz.data + first, m->xyz.data + m->xyz.len - 3, 2 * sizeof(double));
    m->xyz.len -= closed ? 3 : 0;
    size_t points = (m->xyz.len - first) / 3;
    if (points >= 3)
        return array_push(&m->rings, points);
    m->xyz.len = first;
    return true;
}

/* Into m->rings and m->xyz: no rings where it is none. */
static noc_status take_polygon(map_reading *m, OGRGeometryH polygon) {
    int rings = gdal.OGR_G_GetGeometryCount(polygon);
    m->rings.len = m->xyz.len = 0;
    for (int i = 0; i < rings; i++) {
        if (!add_ring(m, gdal.OGR_G_GetGeometryRef(polygon, i)))
            return map_no_memory(m);
        if (!m->rings.len) {
            geo_issue(m->writer.sink->issues, GEO_SKIPPED, "ring with too few points", m->tags.id);
            return NOC_OK;
        }
    }
    return NOC_OK;
}

/* Hands on a polygon of a building, or, where that is NULL, an area of that class. */
static noc_status emit_polygon(map_reading *m, OGRGeometryH polygon, geo_footprint *footprint, noc_class cls) {
    const geo_sink *sink = m->writer.sink;
    noc_status status = take_polygon(m, polygon);
    if (status || !m->rings.len)
        return status;
    const geo_polygon area = { cls, m->tags.id, m->rings.len, m->rings.data, m->xyz.data };
    if (!footprint)
        return sink->area(sink->ctx, &area);
    footprint->ring_count = m->rings.len;
    footprint->ring_size = m->rings.data;
    footprint->xyz = m->xyz.data;
    return sink->footprint(sink->ctx, footprint);
}

static noc_status emit_area(map_reading *m, OGRGeometryH g, OGRwkbGeometryType type, geo_footprint *footprint,
                            noc_class cls) {
    noc_status status = NOC_OK;
    if (type == wkbPolygon)
        return emit_polygon(m, g, footprint, cls);
    for (int i = 0; i < gdal.OGR_G_GetGeometryCount(g) && !status; i++)
        status = emit_polygon(m, gdal.OGR_G_GetGeometryRef(g, i), footprint, cls);
    return status;
}

/* Of OpenStreetMap: is the area one of its streets and paths, as osm_count_ways counts them? */
static bool is_street(const map_reading *m) {
    osm_way way = OSM_NEITHER;
    for (size_t i = 0; i < m->tags.tags.len; i++) {
        osm_way one = osm_way_of(m->tags.tags.data[i].key, m->tags.tags.data[i].value);
        way = NOC_MAX(way, one);
    }
    return way == OSM_STREET;
}

static noc_status read_area(map_reading *m, OGRGeometryH g, OGRwkbGeometryType type, bool *is) {
    const geo_sink *sink = m->writer.sink;
    int verdict = outline_verdict(m->tags.tags.data, m->tags.tags.len);
    noc_class cls = verdict < 0 && sink->area ? area_class(m->tags.tags.data, m->tags.tags.len) : NOC_CLASS_OTHER;
    m->writer.streets += cls != NOC_CLASS_OTHER && is_street(m);
    if (cls != NOC_CLASS_OTHER)
        return emit_area(m, g, type, NULL, cls);
    if (!sink->footprint || verdict == 0 || (verdict < 0 && !m->building_layer))
        return NOC_OK;
    *is = true;
    geo_footprint footprint = { .id = m->tags.id };
    outline_read(m->tags.tags.data, m->tags.tags.len, &footprint);
    footprint.bare = footprint.bare && m->format->kind != MAP_OSM; /* there they are metres */
    m->writer.footprints++;
    return emit_area(m, g, type, &footprint, NOC_CLASS_OTHER);
}

/* ---- roads ---- */

static noc_status emit_line(map_reading *m, OGRGeometryH line, geo_road *road) {
    int count = gdal.OGR_G_GetPointCount(line);
    if (count < 2)
        return NOC_OK;
    m->xyz.len = 0;
    for (int i = 0; i < count; i++) {
        const double xyz[3] = { gdal.OGR_G_GetX(line, i), gdal.OGR_G_GetY(line, i), NAN };
        if (!array_append(&m->xyz, xyz, (size_t)3))
            return map_no_memory(m);
    }
    road->point_count = (size_t)count;
    road->xyz = m->xyz.data;
    return m->writer.sink->road(m->writer.sink->ctx, road);
}

static noc_status read_road(map_reading *m, OGRGeometryH g, OGRwkbGeometryType type, bool *is) {
    geo_road road;
    *is = road_read(m->tags.tags.data, m->tags.tags.len, &road);
    if (!*is && m->writer.sink->named_tracks && m->format->kind != MAP_OSM) { /* what it is says the user */
        *is = true;
        road = (geo_road){ .name = "", .cls = GEO_ROAD_MINOR, .motor = true, .width = NAN, .speed = NAN };
    }
    if (!*is)
        return NOC_OK;
    road.id = m->tags.id;
    *(road.cls == GEO_ROAD_RAIL ? &m->writer.rails : &m->writer.streets) += 1;
    noc_status status = NOC_OK;
    if (type == wkbLineString)
        return emit_line(m, g, &road);
    for (int i = 0; i < gdal.OGR_G_GetGeometryCount(g) && !status; i++)
        status = emit_line(m, gdal.OGR_G_GetGeometryRef(g, i), &road);
    return status;
}

/* As OpenStreetMap calls it, where the feature says so. */
static void name_shape(map_reading *m) {
    for (size_t i = 0; i < m->tags.tags.len; i++) {
        const lamp_tag *tag = &m->tags.tags.data[i];
        bool osm = m->format->kind == MAP_OSM, way = !strcmp(tag->key, "osm_way_id");
        if (osm && way)
            snprintf(m->tags.id, sizeof(m->tags.id), "way/%.40s", tag->value);
        else if (osm && !strcmp(tag->key, "osm_id"))
            snprintf(m->tags.id, sizeof(m->tags.id), "%s/%.40s", m->lines ? "way" : "relation", tag->value);
        else if (!osm && !strcmp(tag->key, "@id"))
            snprintf(m->tags.id, sizeof(m->tags.id), "%.60s", tag->value);
    }
}

noc_status map_read_shape(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn, bool *is) {
    OGRGeometryH g = gdal.OGR_F_GetGeometryRef(feature);
    OGRwkbGeometryType type = g ? gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(g)) : wkbUnknown;
    bool area = type == wkbPolygon || type == wkbMultiPolygon,
         line = type == wkbLineString || type == wkbMultiLineString;
    *is = false;
    const geo_sink *sink = m->writer.sink;
    bool wanted = (area && (sink->footprint || sink->area)) || (line && sink->road);
    if (!wanted || gdal.OGR_G_IsEmpty(g))
        return NOC_OK;
    if (!map_collect_fields(feature, defn, false, &m->tags))
        return map_no_memory(m);
    m->lines = line;
    name_shape(m);
    if (line && sink->named_tracks && m->format->kind != MAP_OSM) {
        noc_status status = map_read_timed_line(m, feature, defn, is);
        if (status || *is)
            return status;
    }
    return area ? read_area(m, g, type, is) : read_road(m, g, type, is);
}

/* ---- OpenStreetMap ---- */

void map_choose_layers(map_reading *m, const char *layers) {
    char command[80];
    snprintf(command, sizeof(command), "SET interest_layers = %s", layers);
    OGRLayerH none = gdal.GDALDatasetExecuteSQL(m->source.dataset, command, NULL, NULL);
    if (none)
        gdal.GDALDatasetReleaseResultSet(m->source.dataset, none);
}

/* GDAL reads the file once, and only for the layers that are asked for before: so this is the file anew. */
noc_status map_read_osm_shapes(map_reading *m) {
    const geo_sink *sink = m->writer.sink;
    map_source_close(&m->source);
    noc_status status =
        map_source_open(&m->source, m->stream, m->format, m->params && m->params->allow_outside, sink->log);
    if (status)
        return status;
    map_choose_layers(m, sink->road ? "lines,multipolygons" : "multipolygons");
    OGRFeatureH feature;
    OGRLayerH layer;
    size_t n = 0;
    while (!status && (feature = gdal.GDALDatasetGetNextFeature(m->source.dataset, &layer, NULL, NULL, NULL))) {
        bool is;
        status = map_read_shape(m, feature, gdal.OGR_L_GetLayerDefn(layer), &is);
        gdal.OGR_F_Destroy(feature);
        if (++n % 1024 == 0 && !status && sink->progress && !sink->progress(sink->ctx, 0.5))
            status = NOC_ERR_CANCELLED;
    }
    return !status && m->source.error[0] ? map_source_error(&m->source) : status;
}

#endif
