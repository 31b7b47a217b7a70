/* Lamps from maps: OpenStreetMap XML and PBF, GeoJSON, ArcGIS JSON, GML, GeoPackage, Shapefile and FlatGeobuf through
 * GDAL, and CSV without it.
 *
 * The format is known from the content, and only its driver may open the file, so no name and no content can make GDAL
 * fetch something or run another driver. GDAL's messages never reach stderr: the first failure becomes our error. */
#include "import/lamps/tags.h"
#include "import/map/features.h"
#include "import/map/columns.h"
#include "import/map/osm_ways.h"
#include "import/map/outlines.h"

#include <math.h>
#include <stdio.h>

static bool has(const char *head, size_t size, const char *text) {
    return head && memmem(head, size, text, strlen(text)) != NULL;
}

static bool probe_osm_xml(const char *head, size_t size) {
    return has(head, size, "<osm ") || has(head, size, "<osm>");
}

static bool probe_pbf(const char *head, size_t size) { return has(head, NOC_MIN(size, 64), "OSMHeader"); }

/* Moves past what may stand before the first brace. false: there is none. */
static bool skip_to_brace(const char **head, size_t *size) {
    const char *p = *head, *end = p + *size;
    if (*size >= 3 && !memcmp(p, "\xef\xbb\xbf", 3))
        p += 3;
    while (p < end && (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t' || *p == '\x1e'))
        p++;
    *head = p;
    *size = (size_t)(end - p);
    return p < end && *p == '{';
}

/* What ArcGIS servers answer to f=json. Fields, which come before the features, may be all that is in sight. */
static bool probe_arcgis(const char *p, size_t size) {
    return skip_to_brace(&p, &size) && !has(p, size, "\"FeatureCollection\"") &&
           (has(p, size, "\"esriGeometry") || has(p, size, "\"esriFieldType"));
}

static bool probe_geojson(const char *p, size_t size) {
    if (!skip_to_brace(&p, &size) || probe_arcgis(p, size))
        return false;
    /* not CityJSON, which is told by its own reader or by none */
    return !has(p, size, "\"CityJSON") && (has(p, size, "\"FeatureCollection\"") || has(p, size, "\"Feature\"") ||
                                           (has(p, size, "\"coordinates\"") && has(p, size, "\"geometry\"")));
}

static bool probe_gml(const char *head, size_t size) {
    return has(head, size, "FeatureCollection") && has(head, size, "http://www.opengis.net/gml");
}

static bool probe_gpkg(const char *head, size_t size) { return size >= 16 && !memcmp(head, "SQLite format 3", 16); }

/* Its index (.shx) begins alike: behind the head, at byte 100, lies the place of a shape, which is 50, where a
 * Shapefile has its number, which is 1. */
static bool probe_shp(const char *head, size_t size) {
    bool index = size >= 104 && !memcmp(head + 100, "\0\0\0\x32", 4);
    return !index && size >= 32 && !memcmp(head, "\0\0\x27\x0a", 4) && !memcmp(head + 28, "\xe8\x03\0\0", 4);
}

static bool probe_fgb(const char *head, size_t size) { return size >= 8 && !memcmp(head, "fgb\3fgb", 7); }

static const map_format formats[] = {
    { "OpenStreetMap XML", { "OSM" }, probe_osm_xml, MAP_OSM },
    { "OpenStreetMap PBF", { "OSM" }, probe_pbf, MAP_OSM },
    { "GeoJSON", { "GeoJSON", "GeoJSONSeq" }, probe_geojson, MAP_GEOJSON },
    { "ArcGIS JSON", { "ESRIJSON" }, probe_arcgis, MAP_ARCGIS },
    { "GML", { "GML" }, probe_gml, MAP_GML },
    { "GeoPackage", { "GPKG" }, probe_gpkg, MAP_GEOPACKAGE },
    { "Shapefile", { "ESRI Shapefile" }, probe_shp, MAP_SHAPEFILE },
    { "FlatGeobuf", { "FlatGeobuf" }, probe_fgb, MAP_FLATGEOBUF },
};

static const map_format *find_format(const char *head, size_t size) {
    for (size_t i = 0; i < NOC_COUNT(formats); i++)
        if (formats[i].probe(head, size))
            return &formats[i];
    return NULL;
}

static bool probe(const char *head, size_t size) { return find_format(head, size) || lamp_csv_probe(head, size); }

static noc_status read_head(noc_stream *stream, char *head, size_t size, size_t *len) {
    *len = 0;
    noc_status status = noc_stream_rewind(stream);
    for (size_t got = 1; !status && got && *len < size - 1; *len += got)
        status = noc_stream_read(stream, head + *len, size - 1 - *len, &got);
    head[*len] = 0;
    return status;
}

#if NOC_HAVE_GDAL

/* ---- features ---- */

noc_status map_no_memory(const map_reading *m) { return noc_no_memory(m->writer.sink->log, m->writer.place); }

static void tag_buffer_clear(tag_buffer *b) {
    for (size_t i = 0; i < b->owned.len; i++)
        free(b->owned.data[i]);
    b->owned.len = b->tags.len = 0;
}

static void tag_buffer_free(tag_buffer *b) {
    tag_buffer_clear(b);
    array_free(&b->tags);
    array_free(&b->owned);
}

/* A quoted string of a "key"=>"value" list, unescaped in place; position after it, NULL if there is none. */
static char *hstore_string(char *p, char **out) {
    while (*p && *p != '"')
        p++;
    if (!*p)
        return NULL;
    char *to = *out = ++p;
    for (; *p && *p != '"'; p++) {
        if (*p == '\\' && p[1])
            p++;
        *to++ = *p;
    }
    bool closed = *p == '"';
    *to = 0;
    return closed ? p + 1 : NULL;
}

/* The text, whose memory it takes; NULL where that is refused. */
static char *own(tag_buffer *b, char *text) {
    if (text && array_push(&b->owned, text))
        return text;
    free(text);
    b->refused = true;
    return NULL;
}

static void add_tag(tag_buffer *b, const char *key, const char *value) {
    if (!array_push(&b->tags, (lamp_tag){ key, value }))
        b->refused = true;
}

static void add_hstore(tag_buffer *b, const char *text) {
    char *p = own(b, noc_strdup(text)), *key, *value;
    while (p && (p = hstore_string(p, &key)) && (p = hstore_string(p, &value)))
        add_tag(b, key, value);
}

/* False: memory was refused. */
bool map_collect_fields(OGRFeatureH feature, OGRFeatureDefnH defn, bool osm, tag_buffer *b) {
    tag_buffer_clear(b);
    int count = gdal.OGR_FD_GetFieldCount(defn);
    for (int i = 0; i < count; i++) {
        if (!gdal.OGR_F_IsFieldSetAndNotNull(feature, i))
            continue;
        const char *key = gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(defn, i));
        if (strstr(key, MAP_GML_CRS) || strstr(key, MAP_GML_BROKEN))
            continue;
        const char *text = gdal.OGR_F_GetFieldAsString(feature, i);
        if (!strcmp(key, "all_tags") || !strcmp(key, "other_tags")) {
            add_hstore(b, text);
            continue;
        }
        char *value = own(b, noc_format("%s%s", osm && !strcmp(key, "osm_id") ? "node/" : "", text));
        if (value)
            add_tag(b, key, value);
    }
    snprintf(b->id, sizeof(b->id), "feature %lld", (long long)gdal.OGR_F_GetFID(feature));
    for (size_t i = 0; i < b->tags.len; i++) { /* a whole one: a part of it cannot be searched for */
        const lamp_tag *tag = &b->tags.data[i];
        if (!strcmp(tag->key, "gml_id") && *tag->value && strlen(tag->value) < sizeof(b->id))
            noc_snprintf(b->id, sizeof(b->id), "%s", tag->value);
    }
    return !b->refused;
}

/* The place of a feature: of its point, or, for a lamp drawn as something else, the middle of its box. */
static bool place_of(OGRFeatureH feature, double xyz[3], bool *is_point) {
    OGRGeometryH g = gdal.OGR_F_GetGeometryRef(feature);
    *is_point = false;
    if (!g || gdal.OGR_G_IsEmpty(g))
        return false;
    OGRwkbGeometryType type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(g));
    if (type == wkbMultiPoint || type == wkbGeometryCollection) {
        g = gdal.OGR_G_GetGeometryCount(g) == 1 ? gdal.OGR_G_GetGeometryRef(g, 0) : g;
        type = gdal.OGR_GT_Flatten(gdal.OGR_G_GetGeometryType(g));
    }
    if (type == wkbPoint) {
        *is_point = true;
        xyz[0] = gdal.OGR_G_GetX(g, 0);
        xyz[1] = gdal.OGR_G_GetY(g, 0);
        xyz[2] = gdal.OGR_G_Is3D(g) ? gdal.OGR_G_GetZ(g, 0) : NAN;
        return true;
    }
    OGREnvelope box;
    gdal.OGR_G_GetEnvelope(g, &box);
    xyz[0] = (box.MinX + box.MaxX) / 2;
    xyz[1] = (box.MinY + box.MaxY) / 2;
    xyz[2] = NAN;
    return true;
}

static int dimension_of(OGRFeatureH feature) {
    OGRGeometryH g = gdal.OGR_F_GetGeometryRef(feature);
    return g ? NOC_CLAMP(gdal.OGR_G_GetDimension(g), GEO_POINTS, GEO_AREAS) : GEO_POINTS;
}

/* The layer's CRS as AUTHORITY:CODE or WKT, behind GEO_CRS_TAKEN where the file names none; NULL if there is none;
 * free() it. False: memory was refused. */
static bool layer_crs(OGRLayerH layer, bool named, bool *geographic, char **crs) {
    OGRSpatialReferenceH srs = gdal.OGR_L_GetSpatialRef(layer);
    *geographic = srs && gdal.OSRIsGeographic(srs);
    *crs = NULL;
    if (!srs)
        return true;
    const char *authority = gdal.OSRGetAuthorityName(srs, NULL), *code = gdal.OSRGetAuthorityCode(srs, NULL);
    if (authority && code)
        return (*crs = noc_format("%s%s:%s", named ? "" : (char[]){ GEO_CRS_TAKEN, 0 }, authority, code)) != NULL;
    char *wkt = NULL;
    const char *const options[] = { "FORMAT=WKT2_2018", NULL };
    bool told = gdal.OSRExportToWktEx(srs, &wkt, options) == OGRERR_NONE && wkt && *wkt;
    *crs = told ? noc_strdup(wkt) : NULL;
    gdal.VSIFree(wkt);
    return *crs || !told;
}

/* GeoJSON that names no CRS is WGS 84 by its standard; municipal exports break that. If most of the first places are
 * not on Earth in degrees, --crs says what they are; without it the end of the reading is an error. */
static bool looks_projected(OGRLayerH layer) {
    size_t inside = 0, outside = 0;
    OGRFeatureH feature;
    gdal.OGR_L_ResetReading(layer);
    while (inside + outside < 200 && (feature = gdal.OGR_L_GetNextFeature(layer))) {
        double p[3];
        bool is_point;
        if (place_of(feature, p, &is_point)) {
            bool on_earth = fabs(p[0]) <= 180 && fabs(p[1]) <= 90;
            inside += on_earth;
            outside += !on_earth;
        }
        gdal.OGR_F_Destroy(feature);
    }
    gdal.OGR_L_ResetReading(layer);
    return outside > inside;
}

/* Tells the sink a CRS as a GML names it, and where. */
static noc_status tell_gml_crs(map_reading *m, size_t number) {
    const map_gml_crs *crs = &m->source.gml_crs.data[number];
    const geo_sink *sink = m->writer.sink;
    bool lat_first = false; /* GDAL has exchanged what it knows to be exchanged */
    char *place = noc_format("%s:%zu", m->writer.place, crs->line);
    noc_status status = place ? sink->crs(sink->ctx, crs->name, place, &lat_first) : map_no_memory(m);
    free(place);
    return status;
}

/* Of a GML with several CRSs: sets that of the next feature. */
static noc_status take_feature_crs(map_reading *m, OGRFeatureH feature) {
    if (!m->source.gml_several)
        return NOC_OK;
    long long number = -1;
    bool told = m->crs_field >= 0 && gdal.OGR_F_IsFieldSetAndNotNull(feature, m->crs_field) &&
                noc_parse_int(gdal.OGR_F_GetFieldAsString(feature, m->crs_field), &number) && number >= 0 &&
                (size_t)number < m->source.gml_crs.len;
    m->writer.no_crs = !told;
    if (!told || m->crs_now == (int)number)
        return NOC_OK;
    m->crs_now = (int)number;
    return tell_gml_crs(m, (size_t)number);
}

/* A field that gml_places.c made, which may lie in another; -1: there is none. */
static int made_field(OGRFeatureDefnH defn, const char *name) {
    int count = gdal.OGR_FD_GetFieldCount(defn);
    for (int i = 0; i < count; i++)
        if (strstr(gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(defn, i)), name))
            return i;
    return -1;
}

static noc_status start_layer(map_reading *m, OGRLayerH layer) {
    if (m->format->kind == MAP_OSM) {
        m->writer.geographic = true;
        return lamp_writer_crs(&m->writer, LAMP_WGS84);
    }
    char *crs;
    if (!layer_crs(layer, m->source.crs_named && !m->source.link[0], &m->writer.geographic, &crs))
        return map_no_memory(m);
    const geo_sink *sink = m->writer.sink;
    m->writer.geographic = (m->writer.geographic && !sink->given_metres) || sink->given_degrees;
    const char *given = m->params ? m->params->crs : NULL;
    if (m->source.gml_several) {
        free(crs);
        m->writer.geographic = false;
        return NOC_OK; /* take_feature_crs */
    }
    if (!crs && m->source.gml_crs.len)
        return tell_gml_crs(m, 0);
    bool replaced = crs && m->writer.geographic && given && m->format->kind == MAP_GEOJSON && looks_projected(layer);
    if (replaced)
        m->writer.geographic = false;
    noc_status status = lamp_writer_crs(&m->writer, replaced ? NULL : crs);
    free(crs);
    return status;
}

/* Lamps by their tags; else, if the columns are those of an inventory of lamps, every feature. False: memory was
 * refused. */
static bool layer_kind(OGRLayerH layer, lamp_keys *keys, bool *tags, lamp_writer *w) {
    OGRFeatureDefnH defn = gdal.OGR_L_GetLayerDefn(layer);
    int count = gdal.OGR_FD_GetFieldCount(defn);
    const char **names = noc_calloc((size_t)count + 1, sizeof(*names));
    if (!names)
        return false;
    *tags = false;
    for (int i = 0; i < count; i++) {
        names[i] = gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(defn, i));
        *tags |= lamp_key_tells(names[i]) || !strcmp(names[i], "other_tags") || !strcmp(names[i], "all_tags");
    }
    w->inventory = !*tags && lamp_columns_tell(keys, names, (size_t)count);
    w->asked = !*tags && !w->inventory && lamp_columns_ask(keys, names, (size_t)count) && !w->sink->named_lamps;
    w->inventory = w->inventory || w->asked;
    free(names);
    return true;
}

/* A feature that is neither a single point nor a lamp. */
static void leave(map_reading *m, OGRFeatureH feature, const double xyz[3]) {
    OGREnvelope box;
    char id[64];
    snprintf(id, sizeof(id), "feature %lld", (long long)gdal.OGR_F_GetFID(feature));
    gdal.OGR_G_GetEnvelope(gdal.OGR_F_GetGeometryRef(feature), &box);
    bool somewhere = isfinite(xyz[0]) && isfinite(xyz[1]);
    lamp_writer_unread(&m->writer, dimension_of(feature), id,
                       somewhere ? (double[]){ box.MinX, box.MaxX, box.MinY, box.MaxY } : NULL);
}

/* Sets what of the next feature keeps it from its place. */
static noc_status take_place(map_reading *m, OGRFeatureH feature) {
    bool broken = m->broken_field >= 0 && gdal.OGR_F_IsFieldSetAndNotNull(feature, m->broken_field);
    m->writer.broken = broken ? m->broken : NULL;
    if (broken)
        snprintf(m->broken, sizeof(m->broken), "%s", gdal.OGR_F_GetFieldAsString(feature, m->broken_field));
    return take_feature_crs(m, feature);
}

static noc_status read_feature(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn) {
    bool shape = false;
    noc_status taken = take_place(m, feature);
    if (!taken && !m->writer.no_crs)
        taken = map_read_shape(m, feature, defn, &shape);
    if (taken || shape) {
        m->writer.seen.total[dimension_of(feature)] += shape;
        return taken;
    }
    double xyz[3] = { NAN, NAN, NAN };
    bool is_point, placed = place_of(feature, xyz, &is_point);
    if (placed && is_point && m->writer.sink->named_tracks && m->format->kind != MAP_OSM) {
        noc_status read = map_read_track_point(m, feature, defn, xyz, &shape);
        if (read || shape) {
            m->writer.seen.total[GEO_POINTS] += shape;
            return read;
        }
    }
    bool table = m->writer.inventory || m->writer.strange;
    m->writer.seen.total[dimension_of(feature)] += placed;
    if (table && !is_point && (placed || m->writer.strange)) {
        if (placed)
            leave(m, feature, xyz);
        return NOC_OK;
    }
    if (!map_collect_fields(feature, defn, m->format->kind == MAP_OSM, &m->tags))
        return map_no_memory(m);
    size_t before = m->writer.lamps, points = m->writer.points;
    noc_status status = lamp_writer_point(&m->writer, m->tags.tags.data, m->tags.tags.len, m->tags.id, xyz);
    if (!status && placed && !is_point && m->writer.points == points) {
        m->writer.features--; /* that might have been a lamp */
        leave(m, feature, xyz);
    }
    if (!status && m->writer.lamps > before && !is_point)
        geo_issue(m->writer.sink->issues, GEO_GUESSED, "lamp drawn as a line or an area: put in its middle",
                  m->tags.id);
    return status;
}

static noc_status read_features(map_reading *m, OGRLayerH layer) {
    OGRFeatureDefnH defn = gdal.OGR_L_GetLayerDefn(layer);
    GIntBig total = m->format->kind == MAP_OSM ? 0 : gdal.OGR_L_GetFeatureCount(layer, FALSE);
    OGRFeatureH feature;
    size_t n = 0;
    noc_status status = NOC_OK;
    m->crs_field = made_field(defn, MAP_GML_CRS);
    m->broken_field = made_field(defn, MAP_GML_BROKEN);
    while (!status && (feature = gdal.OGR_L_GetNextFeature(layer))) {
        status = read_feature(m, feature, defn);
        gdal.OGR_F_Destroy(feature);
        if (++n % 1024 == 0 && !status && m->writer.sink->progress &&
            !m->writer.sink->progress(m->writer.sink->ctx, total > 0 ? NOC_MIN((double)n / (double)total, 1) : 0))
            status = NOC_ERR_CANCELLED;
    }
    if (!status && m->source.error[0])
        status = map_source_error(&m->source);
    return status;
}

/* Do the values of the layer's points say what they are? */
static noc_status read_kinds(map_reading *m, OGRLayerH layer) {
    OGRFeatureDefnH defn = gdal.OGR_L_GetLayerDefn(layer);
    OGRFeatureH feature;
    bool kept = true;
    lamp_kinds_free(&m->writer.kinds);
    m->writer.kinds = (lamp_kinds){ 0 };
    gdal.OGR_L_ResetReading(layer);
    while (kept && (feature = gdal.OGR_L_GetNextFeature(layer))) {
        double xyz[3];
        bool is_point;
        if (place_of(feature, xyz, &is_point) && is_point)
            kept = map_collect_fields(feature, defn, false, &m->tags) &&
                   lamp_kinds_count(&m->writer.kinds, m->tags.tags.data, m->tags.tags.len);
        gdal.OGR_F_Destroy(feature);
    }
    gdal.OGR_L_ResetReading(layer);
    lamp_kinds_decide(&m->writer.kinds);
    return kept ? NOC_OK : map_no_memory(m);
}

/* Looks at the first values of columns of status, where the layer has one. */
static noc_status read_statuses(map_reading *m, OGRLayerH layer) {
    enum { FEATURES = 1000 };
    OGRFeatureDefnH defn = gdal.OGR_L_GetLayerDefn(layer);
    OGRFeatureH feature;
    bool any = false, kept = true;
    for (int i = 0; i < gdal.OGR_FD_GetFieldCount(defn) && !any; i++) {
        const char *name = gdal.OGR_Fld_GetNameRef(gdal.OGR_FD_GetFieldDefn(defn, i));
        any = lamp_keys_meaning(m->writer.keys, name).field == LAMP_FIELD_STATUS;
    }
    if (!any)
        return NOC_OK;
    gdal.OGR_L_ResetReading(layer);
    for (int n = 0; n < FEATURES && kept && (feature = gdal.OGR_L_GetNextFeature(layer)); n++) {
        kept = map_collect_fields(feature, defn, false, &m->tags);
        for (size_t i = 0; i < m->tags.tags.len && kept; i++)
            lamp_keys_flag(m->writer.keys, &m->tags.tags.data[i]);
        gdal.OGR_F_Destroy(feature);
    }
    gdal.OGR_L_ResetReading(layer);
    return kept ? NOC_OK : map_no_memory(m);
}

/* What tells that a layer's points are lamps: the user, tags, columns, values, or nothing. */
static noc_status judge(map_reading *m, OGRLayerH layer) {
    bool tags;
    noc_status status = NOC_OK;
    lamp_writer *w = &m->writer;
    if (!layer_kind(layer, w->keys, &tags, w))
        return map_no_memory(m);
    w->kinds.any = w->strange = false;
    if (w->sink->named_lamps)
        w->inventory = m->format->kind != MAP_OSM;
    else if (!w->inventory && !tags) {
        status = read_kinds(m, layer);
        w->inventory = w->kinds.any || w->kinds.models;
        w->strange = !w->inventory;
    }
    if (!status && w->inventory && m->format->kind != MAP_OSM)
        status = read_statuses(m, layer);
    return status;
}

static noc_status read_layer(map_reading *m, OGRLayerH layer) {
    lamp_writer *w = &m->writer;
    int columns = gdal.OGR_FD_GetFieldCount(gdal.OGR_L_GetLayerDefn(layer));
    if (columns > MAP_MOST_COLUMNS)
        return map_columns_refuse(w->place, m->format->name, w->sink->log);
    noc_status status = judge(m, layer);
    m->building_layer = w->sink->footprint && outline_layer(gdal.OGR_L_GetName(layer));
    if (!status && (!w->strange || w->sink->inspect || w->sink->footprint || w->sink->road))
        status = start_layer(m, layer);
    if (!status)
        status = read_features(m, layer);
    if (!status)
        status = map_end_tracks(m);
    /* an extract of OpenStreetMap holds all kinds of points: only where no tag tells of lamps all of them are meant */
    if (!status && m->format->kind == MAP_OSM && w->sink->named_lamps && !w->lamps) {
        w->inventory = true;
        w->features = 0;
        w->seen = (geo_features){ 0 };
        gdal.OGR_L_ResetReading(layer);
        status = read_features(m, layer);
    }
    return status;
}

static noc_status read_layers(map_reading *m) {
    if (m->format->kind == MAP_OSM) {
        map_choose_layers(m, "points");
        OGRLayerH points = gdal.GDALDatasetGetLayerByName(m->source.dataset, "points");
        noc_status status = points ? read_layer(m, points) : map_source_error(&m->source);
        if (!status && (m->writer.sink->footprint || m->writer.sink->road))
            status = map_read_osm_shapes(m);
        if (!status)
            status = osm_count_ways(m->stream, m->format->probe == probe_pbf, m->writer.sink, &m->writer.seen);
        m->writer.seen.buildings -= NOC_MIN(m->writer.seen.buildings, m->writer.footprints);
        m->writer.seen.streets -= NOC_MIN(m->writer.seen.streets, m->writer.streets);
        return status;
    }
    noc_status status = NOC_OK;
    int count = gdal.GDALDatasetGetLayerCount(m->source.dataset);
    for (int i = 0; i < count && !status; i++)
        status = read_layer(m, gdal.GDALDatasetGetLayer(m->source.dataset, i));
    return status;
}

/* GDAL takes all of a GeoJSON in the file's CRS, and so may the user. */
static noc_status refuse_odd_crs(const map_reading *m) {
    const geo_sink *sink = m->writer.sink;
    if (!m->source.odd_crs[0] || sink->given_metres || sink->given_degrees)
        return NOC_OK;
    return noc_error(sink->log, NOC_ERR_FORMAT,
                     "%s: GeoJSON: %s: one file has one CRS; write a file for each, or pass --file-crs FILE=CRS if all "
                     "of it is in that one",
                     m->writer.place, m->source.odd_crs);
}

static noc_status read_map(noc_stream *stream, const map_format *format, const noc_import_params *params,
                           geo_sink *sink) {
    map_reading m = { .format = format, .stream = stream, .params = params, .crs_now = -1 };
    noc_status status = lamp_writer_start(&m.writer, sink, noc_stream_name(stream), params);
    if (status)
        return status;
    status = map_source_open(&m.source, stream, format, params && params->allow_outside, sink->log);
    if (!status && m.source.link[0] && !(params && params->crs))
        geo_issue(sink->issues, GEO_GUESSED, "CRS that is a link, not followed: longitudes and latitudes instead",
                  "crs");
    if (m.source.unpaired[0])
        geo_issue(sink->issues, GEO_SKIPPED,
                  "rows and shapes of a Shapefile that are not in both, its .dbf and its .shx", m.source.unpaired);
    if (m.source.strange_count)
        geo_issues_add(sink->issues, GEO_SKIPPED, "geometry of a type that GeoJSON has not", m.source.strange_count,
                       m.source.strange);
    if (!status)
        status = refuse_odd_crs(&m);
    if (!status)
        status = read_layers(&m);
    status = status ? status : map_source_check(&m.source, stream);
    map_source_close(&m.source);
    tag_buffer_free(&m.tags);
    array_free(&m.rings);
    array_free(&m.xyz);
    array_free(&m.times);
    track_rows_free(&m.rows);
    if (!status)
        status = lamp_writer_end(&m.writer);
    lamp_writer_free(&m.writer);
    return status;
}

#else

static noc_status read_map(noc_stream *stream, const map_format *format, const noc_import_params *params,
                           geo_sink *sink) {
    return noc_error(sink->log, NOC_ERR_UNSUPPORTED, "%s: %s needs GDAL, which this build is without",
                     noc_stream_name(stream), format->name);
}

#endif

static noc_status read_vector(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                              const char **format) {
    char head[8192];
    size_t len;
    noc_status status = read_head(stream, head, sizeof(head), &len);
    if (status)
        return status;
    const map_format *found = find_format(head, len);
    *format = found ? found->name : "CSV";
    return found ? read_map(stream, found, params, sink) : lamp_csv_read(stream, params, sink, format);
}

static bool foreign(const char *head, size_t size) { return NOC_HAVE_GDAL && find_format(head, size); }

/* All but OpenStreetMap and GeoJSON. */
static bool without_crs(const char *head, size_t size) {
    const map_format *f = find_format(head, size);
    return !f || (f->kind != MAP_OSM && f->kind != MAP_GEOJSON);
}

/* Never `missing`: CSV needs no GDAL, and the others say so one by one. */
const noc_reader noc_reader_vector = {
    .name = "OpenStreetMap, GeoJSON and GeoJSONSeq, ArcGIS JSON, GML, GeoPackage, Shapefile, FlatGeobuf, CSV",
    .reads = NOC_READS_LAMPS,
    .probe = probe,
    .probe_named = lamp_csv_probe_table,
    .read = read_vector,
    .foreign = foreign,
    .without_crs = without_crs,
    .load = gdal_load
};
