/* Lamps from maps: OpenStreetMap XML and PBF, GeoJSON, GeoPackage, Shapefile and FlatGeobuf through GDAL, and CSV without it.
 *
 * The format is known from the content, and only its driver may open the file, so no name and no content can make GDAL
 * fetch something or run another driver. GDAL's messages never reach stderr: the first failure becomes our error. */
#include "import/lamp_tags.h"
#include "noc_config.h"

#include <math.h>
#include <stdio.h>

static bool has(const char *head, size_t size, const char *text) {
    return head && memmem(head, size, text, strlen(text)) != NULL;
}

typedef struct map_format {
    const char *name;
    const char *drivers[3]; /* GDAL's, ended by NULL */
    bool (*probe)(const char *head, size_t size);
    bool osm;
} map_format;

static bool probe_osm_xml(const char *head, size_t size) { return has(head, size, "<osm ") || has(head, size, "<osm>"); }

static bool probe_pbf(const char *head, size_t size) { return has(head, NOC_MIN(size, 64), "OSMHeader"); }

static bool probe_geojson(const char *head, size_t size) {
    const char *p = head, *end = head + size;
    if (size >= 3 && !memcmp(p, "\xef\xbb\xbf", 3))
        p += 3;
    while (p < end && (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t' || *p == '\x1e'))
        p++;
    if (p == end || *p != '{')
        return false;
    size = (size_t)(end - p);
    /* not CityJSON, which is told by its own reader or by none */
    return !has(p, size, "\"CityJSON") && (has(p, size, "\"FeatureCollection\"") || has(p, size, "\"Feature\"") ||
                                           (has(p, size, "\"coordinates\"") && has(p, size, "\"geometry\"")));
}

static bool probe_gpkg(const char *head, size_t size) { return size >= 16 && !memcmp(head, "SQLite format 3", 16); }

static bool probe_shp(const char *head, size_t size) {
    return size >= 32 && !memcmp(head, "\0\0\x27\x0a", 4) && !memcmp(head + 28, "\xe8\x03\0\0", 4);
}

static bool probe_fgb(const char *head, size_t size) { return size >= 8 && !memcmp(head, "fgb\3fgb", 7); }

static const map_format formats[] = {
    { "OpenStreetMap XML", { "OSM" }, probe_osm_xml, true },
    { "OpenStreetMap PBF", { "OSM" }, probe_pbf, true },
    { "GeoJSON", { "GeoJSON", "GeoJSONSeq" }, probe_geojson, false },
    { "GeoPackage", { "GPKG" }, probe_gpkg, false },
    { "Shapefile", { "ESRI Shapefile" }, probe_shp, false },
    { "FlatGeobuf", { "FlatGeobuf" }, probe_fgb, false },
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

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <pthread.h>
#include <unistd.h>

/* ---- GDAL, kept quiet ---- */

typedef struct gdal_errors {
    char text[512]; /* of the first failure, "" if none */
    size_t warnings;
} gdal_errors;

/* Cuts long numbers in a message: files may hold some of hundreds of digits. */
static void shorten_numbers(char *text) {
    enum { LONGEST = 40 };
    char *out = text;
    size_t digits = 0;
    for (const char *p = text; *p; p++) {
        digits = *p >= '0' && *p <= '9' ? digits + 1 : 0;
        if (digits <= LONGEST)
            *out++ = *p;
        else if (digits <= LONGEST + 3)
            *out++ = '.';
    }
    *out = 0;
}

/* What GDAL's GeoJSON reader says of a geometry that it leaves out ("Invalid 'x' coordinate. Type is not double ...", "Invalid Point
 * object. ..."): its feature then has no place, and is counted so. */
static bool is_of_one_geometry(const char *text) { return !strncmp(text, "Invalid ", 8) && !strstr(text, "Feature"); }

static void CPL_STDCALL on_gdal_error(CPLErr level, CPLErrorNum code, const char *text) {
    gdal_errors *errors = CPLGetErrorHandlerUserData();
    if (level < CE_Failure || (level == CE_Failure && is_of_one_geometry(text))) {
        errors->warnings += level >= CE_Warning;
        return;
    }
    if (!errors->text[0])
        snprintf(errors->text, sizeof(errors->text), "%s", *text ? text : "unknown failure");
    for (char *p = errors->text; *p; p++) /* one line */
        if ((unsigned char)*p < ' ')
            *p = ' ';
    shorten_numbers(errors->text);
    (void)code;
}

static const char osm_config[] = "closed_ways_are_polygons=\n"
                                 "attribute_name_laundering=no\n"
                                 "report_all_nodes=no\nreport_all_ways=no\n"
                                 "[points]\nosm_id=yes\nall_tags=yes\n"
                                 "[lines]\nosm_id=yes\nall_tags=yes\n"
                                 "[multipolygons]\nosm_id=yes\nall_tags=yes\n"
                                 "[multilinestrings]\nosm_id=yes\nall_tags=yes\n"
                                 "[other_relations]\nosm_id=yes\nall_tags=yes\n";
#define OSM_CONFIG_PATH "/vsimem/nocturne/osmconf.ini"

static pthread_once_t gdal_once = PTHREAD_ONCE_INIT;

static void gdal_start(void) {
    OGRRegisterAll();
    VSILFILE *f = VSIFileFromMemBuffer(OSM_CONFIG_PATH, (GByte *)osm_config, sizeof(osm_config) - 1, FALSE);
    if (f)
        VSIFCloseL(f);
}

static const struct {
    const char *key, *value;
} gdal_settings[] = {
    { "CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO" }, /* nothing is written beside the input */
    { "GDAL_DISABLE_READDIR_ON_OPEN", "NO" },   /* a Shapefile's other parts are found */
    { "OGR_SQLITE_LOAD_EXTENSIONS", NULL },
    { "SHAPE_RESTORE_SHX", "NO" },
    { "SQLITE_USE_OGR_VFS", "NO" },
};

static void gdal_enter(gdal_errors *errors) {
    pthread_once(&gdal_once, gdal_start);
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        CPLSetThreadLocalConfigOption(gdal_settings[i].key, gdal_settings[i].value);
    const char *tmp = getenv("TMPDIR");
    CPLSetThreadLocalConfigOption("CPL_TMPDIR", tmp && *tmp ? tmp : "/tmp");
    *errors = (gdal_errors){ 0 };
    CPLPushErrorHandlerEx(on_gdal_error, errors);
}

static void gdal_leave(void) {
    CPLPopErrorHandler();
    CPLErrorReset();
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        CPLSetThreadLocalConfigOption(gdal_settings[i].key, NULL);
    CPLSetThreadLocalConfigOption("CPL_TMPDIR", NULL);
}

/* ---- where GDAL finds the bytes of a stream ---- */

/* Archives are read once to their end, because GDAL takes a truncated one for a short file. */
static noc_status check_archive(noc_stream *stream) {
    char *buffer = noc_alloc(1 << 16);
    size_t got = 1;
    noc_status status = noc_stream_rewind(stream);
    while (!status && got)
        status = noc_stream_read(stream, buffer, 1 << 16, &got);
    free(buffer);
    return status;
}

/* The path itself, /vsigzip/path or /vsizip/{path}/member. */
static noc_status gdal_path(noc_stream *stream, char **path) {
    const char *name = noc_stream_name(stream);
    const char *slash = *name == '/' ? "" : "./"; /* "http://x" as a file's name stays a file's name */
    noc_status status = NOC_OK;
    if (access(name, F_OK)) { /* path!member */
        const char *bang = name + strlen(name);
        char *archive = NULL;
        while (bang > name) {
            if (*bang == '!') {
                free(archive);
                archive = noc_format("%.*s", (int)(bang - name), name);
                if (!access(archive, F_OK))
                    break;
            }
            bang--;
        }
        *path = noc_format("/vsizip/{%s%s}/%s", slash, archive ? archive : name, *bang == '!' ? bang + 1 : "");
        free(archive);
        status = check_archive(stream);
    } else {
        unsigned char magic[2] = { 0 };
        FILE *f = fopen(name, "rb");
        bool gzip = f && fread(magic, 1, 2, f) == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
        if (f)
            fclose(f);
        *path = noc_format("%s%s%s", gzip ? "/vsigzip/" : "", slash, name);
        if (gzip)
            status = check_archive(stream);
    }
    return status;
}

/* ---- features ---- */

typedef struct tag_buffer {
    NOC_ARRAY(lamp_tag) tags;
    NOC_ARRAY(char *) owned;
    char id[64];
} tag_buffer;

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

static void add_hstore(tag_buffer *b, const char *text) {
    char *p = noc_strdup(text), *key, *value;
    array_push(&b->owned, p);
    while ((p = hstore_string(p, &key)) && (p = hstore_string(p, &value)))
        array_push(&b->tags, (lamp_tag){ key, value });
}

static void collect_fields(OGRFeatureH feature, OGRFeatureDefnH defn, bool osm, tag_buffer *b) {
    tag_buffer_clear(b);
    int count = OGR_FD_GetFieldCount(defn);
    for (int i = 0; i < count; i++) {
        if (!OGR_F_IsFieldSetAndNotNull(feature, i))
            continue;
        const char *key = OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(defn, i));
        const char *text = OGR_F_GetFieldAsString(feature, i);
        if (!strcmp(key, "all_tags") || !strcmp(key, "other_tags")) {
            add_hstore(b, text);
            continue;
        }
        char *value = osm && !strcmp(key, "osm_id") ? noc_format("node/%s", text) : noc_strdup(text);
        array_push(&b->owned, value);
        array_push(&b->tags, (lamp_tag){ key, value });
    }
    snprintf(b->id, sizeof(b->id), "feature %lld", (long long)OGR_F_GetFID(feature));
}

/* The place of a feature: of its point, or, for a lamp drawn as something else, the middle of its box. */
static bool place_of(OGRFeatureH feature, double xyz[3], bool *is_point) {
    OGRGeometryH g = OGR_F_GetGeometryRef(feature);
    *is_point = false;
    if (!g || OGR_G_IsEmpty(g))
        return false;
    OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(g));
    if (type == wkbMultiPoint || type == wkbGeometryCollection) {
        g = OGR_G_GetGeometryCount(g) == 1 ? OGR_G_GetGeometryRef(g, 0) : g;
        type = wkbFlatten(OGR_G_GetGeometryType(g));
    }
    if (type == wkbPoint) {
        *is_point = true;
        xyz[0] = OGR_G_GetX(g, 0);
        xyz[1] = OGR_G_GetY(g, 0);
        xyz[2] = OGR_G_Is3D(g) ? OGR_G_GetZ(g, 0) : NAN;
        return true;
    }
    OGREnvelope box;
    OGR_G_GetEnvelope(g, &box);
    xyz[0] = (box.MinX + box.MaxX) / 2;
    xyz[1] = (box.MinY + box.MaxY) / 2;
    xyz[2] = NAN;
    return true;
}

typedef struct map_reading {
    const map_format *format;
    noc_stream *stream;
    const noc_import_params *params;
    lamp_writer writer;
    gdal_errors errors;
    tag_buffer tags;
    GDALDatasetH dataset;
} map_reading;

static noc_status report(const map_reading *m) {
    return noc_error(m->writer.sink->log, NOC_ERR_FORMAT, "%s: %s: %s", m->writer.place, m->format->name,
                     m->errors.text[0] ? m->errors.text : "not readable");
}

/* The layer's CRS as AUTHORITY:CODE or WKT, NULL if it names none; free() it. */
static char *layer_crs(OGRLayerH layer, bool *geographic) {
    OGRSpatialReferenceH srs = OGR_L_GetSpatialRef(layer);
    *geographic = srs && OSRIsGeographic(srs);
    if (!srs)
        return NULL;
    const char *authority = OSRGetAuthorityName(srs, NULL), *code = OSRGetAuthorityCode(srs, NULL);
    if (authority && code)
        return noc_format("%s:%s", authority, code);
    char *wkt = NULL, *copy = NULL;
    const char *const options[] = { "FORMAT=WKT2_2018", NULL };
    if (OSRExportToWktEx(srs, &wkt, options) == OGRERR_NONE && wkt && *wkt)
        copy = noc_strdup(wkt);
    CPLFree(wkt);
    return copy;
}

/* GeoJSON that names no CRS is WGS 84 by its standard; municipal exports break that. If most of the first places are not
 * on Earth in degrees, --crs says what they are; without it the end of the reading is an error. */
static bool looks_projected(OGRLayerH layer) {
    size_t inside = 0, outside = 0;
    OGRFeatureH feature;
    OGR_L_ResetReading(layer);
    while (inside + outside < 200 && (feature = OGR_L_GetNextFeature(layer))) {
        double p[3];
        bool is_point;
        if (place_of(feature, p, &is_point)) {
            bool on_earth = fabs(p[0]) <= 180 && fabs(p[1]) <= 90;
            inside += on_earth;
            outside += !on_earth;
        }
        OGR_F_Destroy(feature);
    }
    OGR_L_ResetReading(layer);
    return outside > inside;
}

static noc_status start_layer(map_reading *m, OGRLayerH layer) {
    if (m->format->osm) {
        m->writer.geographic = true;
        return lamp_writer_crs(&m->writer, LAMP_WGS84);
    }
    char *crs = layer_crs(layer, &m->writer.geographic);
    const char *given = m->params ? m->params->crs : NULL;
    bool replaced = crs && m->writer.geographic && given && !strcmp(m->format->name, "GeoJSON") && looks_projected(layer);
    if (replaced)
        m->writer.geographic = false;
    noc_status status = lamp_writer_crs(&m->writer, replaced ? NULL : crs);
    free(crs);
    return status;
}

/* Lamps by their tags; else, if the columns are those of an inventory of lamps, every feature. */
static void layer_kind(OGRLayerH layer, lamp_keys *keys, bool *tags, bool *inventory) {
    OGRFeatureDefnH defn = OGR_L_GetLayerDefn(layer);
    int count = OGR_FD_GetFieldCount(defn);
    const char **names = noc_calloc((size_t)count + 1, sizeof(*names));
    *tags = false;
    for (int i = 0; i < count; i++) {
        names[i] = OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(defn, i));
        *tags |= lamp_key_tells(names[i]) || !strcmp(names[i], "other_tags") || !strcmp(names[i], "all_tags");
    }
    *inventory = !*tags && lamp_columns_tell(keys, names, (size_t)count);
    free(names);
}

static noc_status read_feature(map_reading *m, OGRFeatureH feature, OGRFeatureDefnH defn) {
    double xyz[3] = { NAN, NAN, NAN };
    bool is_point, placed = place_of(feature, xyz, &is_point);
    bool table = m->writer.inventory || m->writer.strange;
    if (table && !is_point && (placed || m->writer.strange)) {
        if (m->writer.inventory)
            geo_issue(m->writer.sink->issues, false, "line or area in a table of lamps", "");
        return NOC_OK;
    }
    collect_fields(feature, defn, m->format->osm, &m->tags);
    size_t before = m->writer.lamps;
    noc_status status = lamp_writer_point(&m->writer, m->tags.tags.data, m->tags.tags.len, m->tags.id, xyz);
    if (!status && m->writer.lamps > before && !is_point)
        geo_issue(m->writer.sink->issues, true, "lamp drawn as a line or an area: put in its middle", m->tags.id);
    return status;
}

static noc_status read_features(map_reading *m, OGRLayerH layer) {
    OGRFeatureDefnH defn = OGR_L_GetLayerDefn(layer);
    GIntBig total = m->format->osm ? 0 : OGR_L_GetFeatureCount(layer, FALSE);
    OGRFeatureH feature;
    size_t n = 0;
    noc_status status = NOC_OK;
    while (!status && (feature = OGR_L_GetNextFeature(layer))) {
        status = read_feature(m, feature, defn);
        OGR_F_Destroy(feature);
        if (++n % 1024 == 0 && !status && m->writer.sink->progress &&
            !m->writer.sink->progress(m->writer.sink->ctx, total > 0 ? NOC_MIN((double)n / (double)total, 1) : 0))
            status = NOC_ERR_CANCELLED;
    }
    if (!status && m->errors.text[0])
        status = report(m);
    return status;
}

/* Do the values of the layer's points say what they are? */
static void read_kinds(map_reading *m, OGRLayerH layer) {
    OGRFeatureDefnH defn = OGR_L_GetLayerDefn(layer);
    OGRFeatureH feature;
    lamp_kinds_free(&m->writer.kinds);
    m->writer.kinds = (lamp_kinds){ 0 };
    OGR_L_ResetReading(layer);
    while ((feature = OGR_L_GetNextFeature(layer))) {
        double xyz[3];
        bool is_point;
        if (place_of(feature, xyz, &is_point) && is_point) {
            collect_fields(feature, defn, false, &m->tags);
            lamp_kinds_count(&m->writer.kinds, m->tags.tags.data, m->tags.tags.len);
        }
        OGR_F_Destroy(feature);
    }
    OGR_L_ResetReading(layer);
    lamp_kinds_decide(&m->writer.kinds);
}

/* What tells that a layer's points are lamps: the user, tags, columns, values, or nothing. */
static void judge(map_reading *m, OGRLayerH layer) {
    bool tags;
    lamp_writer *w = &m->writer;
    layer_kind(layer, w->keys, &tags, &w->inventory);
    w->kinds.any = w->strange = false;
    if (w->sink->named_lamps)
        w->inventory = !m->format->osm;
    else if (!w->inventory && !tags) {
        read_kinds(m, layer);
        w->inventory = w->kinds.any;
        w->strange = !w->kinds.any;
    }
}

static noc_status read_layer(map_reading *m, OGRLayerH layer) {
    lamp_writer *w = &m->writer;
    judge(m, layer);
    noc_status status = w->strange ? NOC_OK : start_layer(m, layer);
    if (!status)
        status = read_features(m, layer);
    /* an extract of OpenStreetMap holds all kinds of points: only where no tag tells of lamps all of them are meant */
    if (!status && m->format->osm && w->sink->named_lamps && !w->lamps) {
        w->inventory = true;
        w->features = 0;
        OGR_L_ResetReading(layer);
        status = read_features(m, layer);
    }
    return status;
}

static noc_status read_layers(map_reading *m) {
    if (m->format->osm) { /* points alone: the geometries of ways and relations are not assembled */
        OGRLayerH none = GDALDatasetExecuteSQL(m->dataset, "SET interest_layers = points", NULL, NULL);
        if (none)
            GDALDatasetReleaseResultSet(m->dataset, none);
        OGRLayerH points = GDALDatasetGetLayerByName(m->dataset, "points");
        return points ? read_layer(m, points) : report(m);
    }
    noc_status status = NOC_OK;
    int count = GDALDatasetGetLayerCount(m->dataset);
    for (int i = 0; i < count && !status; i++)
        status = read_layer(m, GDALDatasetGetLayer(m->dataset, i));
    return status;
}

static noc_status read_map(noc_stream *stream, const map_format *format, const noc_import_params *params, geo_sink *sink) {
    map_reading m = { .format = format, .stream = stream, .params = params,
                      .writer = lamp_writer_start(sink, noc_stream_name(stream), params) };
    char *path;
    noc_status status = gdal_path(stream, &path);
    if (!status) {
        gdal_enter(&m.errors);
        const char *const osm_options[] = { "CONFIG_FILE=" OSM_CONFIG_PATH, "COMPRESS_NODES=YES", NULL };
        m.dataset = GDALOpenEx(path, GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, format->drivers,
                               format->osm ? osm_options : NULL, NULL);
        status = m.dataset && !m.errors.text[0] ? read_layers(&m) : report(&m);
        if (m.dataset)
            GDALClose(m.dataset);
        gdal_leave();
        tag_buffer_free(&m.tags);
    }
    free(path);
    if (!status)
        status = lamp_writer_end(&m.writer);
    lamp_writer_free(&m.writer);
    return status;
}

#else

static noc_status read_map(noc_stream *stream, const map_format *format, const noc_import_params *params, geo_sink *sink) {
    return noc_error(sink->log, NOC_ERR_UNSUPPORTED, "%s: %s needs GDAL, which this build is without", noc_stream_name(stream),
                     format->name);
}

#endif

static noc_status read_vector(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    char head[8192];
    size_t len;
    noc_status status = read_head(stream, head, sizeof(head), &len);
    if (status)
        return status;
    const map_format *found = find_format(head, len);
    *format = found ? found->name : "CSV";
    return found ? read_map(stream, found, params, sink) : lamp_csv_read(stream, params, sink, format);
}

/* Never `missing`: CSV needs no GDAL, and the others say so one by one. */
const noc_reader noc_reader_vector = { .name = "OpenStreetMap, GeoJSON, CSV", .reads = NOC_READS_LAMPS, .probe = probe,
                                       .probe_named = lamp_csv_probe_table, .read = read_vector };
