/* Map files through GDAL: which files it may open, how, and what becomes of its messages. */
#include "import/map/crs.h"
#include "import/map/parts.h"

#if NOC_HAVE_GDAL

#include <ctype.h>
#include <pthread.h>
#include <stdio.h>
#include <unistd.h>

/* ---- GDAL, kept quiet ---- */

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

/* What GDAL's GeoJSON reader says of a geometry that it leaves out ("Invalid 'x' coordinate. Type is not double ...",
 * "Invalid Point object. ..."): its feature then has no place, and is counted so. */
static bool is_of_one_geometry(const char *text) { return !strncmp(text, "Invalid ", 8) && !strstr(text, "Feature"); }

static void CPL_STDCALL on_gdal_error(CPLErr level, CPLErrorNum code, const char *text) {
    map_source *m = gdal.CPLGetErrorHandlerUserData();
    if (level < CE_Failure || (level == CE_Failure && is_of_one_geometry(text)))
        return;
    if (!m->error[0])
        snprintf(m->error, sizeof(m->error), "%s", *text ? text : "unknown failure");
    for (char *p = m->error; *p; p++) /* one line */
        if ((unsigned char)*p < ' ')
            *p = ' ';
    shorten_numbers(m->error);
    (void)code;
}

/* Takes the place of curl: a GeoJSON's CRS may be a link, and whoever writes it decides where to. */
static CPLHTTPResult *refuse_fetch(const char *url, CSLConstList options, GDALProgressFunc progress,
                                   void *progress_data, CPLHTTPFetchWriteFunc write, void *write_data, void *user) {
    map_source *m = user;
    if (!m->link[0])
        snprintf(m->link, sizeof(m->link), "%s", url);
    CPLHTTPResult *none = gdal.CPLCalloc(1, sizeof(*none)); /* NULL would leave it to curl after all */
    none->nStatus = 1;
    none->pszErrBuf = gdal.CPLStrdup("nothing is fetched");
    return none;
}

static const char osm_config[] =
    "closed_ways_are_polygons=building,natural,landuse,waterway,leisure,place,amenity,area:highway\n"
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
    gdal.OGRRegisterAll();
    VSILFILE *f = gdal.VSIFileFromMemBuffer(OSM_CONFIG_PATH, (GByte *)osm_config, sizeof(osm_config) - 1, FALSE);
    if (f)
        gdal.VSIFCloseL(f);
}

static const struct {
    const char *key, *value;
} gdal_settings[] = {
    { "CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO" }, /* nothing is written beside the input */
    { "CPL_CURL_ENABLE_VSIMEM", "NO" },
    { "GDAL_DISABLE_READDIR_ON_OPEN", "NO" }, /* a Shapefile's other parts are found */
    { "GDAL_GEOREF_SOURCES", "" },
    { "GDAL_PAM_ENABLED", "NO" },                  /* no .aux.xml, neither read nor written */
    { "OGR_SQLITE_LOAD_EXTENSIONS", "" },          /* whatever the environment says */
    { "OGR_SQLITE_PRAGMA", "trusted_schema=OFF" }, /* no views or triggers over functions that touch files */
    { "OGR_SQLITE_LIST_VIRTUAL_OGR", "NO" },
    { "SHAPE_RESTORE_SHX", "NO" },
    { "SQLITE_USE_OGR_VFS", "NO" },
};

static void gdal_enter(map_source *m) {
    pthread_once(&gdal_once, gdal_start);
    m->entered = true;
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        gdal.CPLSetThreadLocalConfigOption(gdal_settings[i].key, gdal_settings[i].value);
    gdal.CPLSetThreadLocalConfigOption("CPL_TMPDIR", scratch_place());
    gdal.CPLPushErrorHandlerEx(on_gdal_error, m);
    gdal.CPLHTTPPushFetchCallback(refuse_fetch, m);
}

static void gdal_leave(void) {
    gdal.CPLHTTPPopFetchCallback();
    gdal.CPLPopErrorHandler();
    gdal.CPLErrorReset();
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        gdal.CPLSetThreadLocalConfigOption(gdal_settings[i].key, NULL);
    gdal.CPLSetThreadLocalConfigOption("CPL_TMPDIR", NULL);
}

/* ---- where GDAL finds the bytes of a stream ---- */

/* Archives are read once to their end, because GDAL takes a truncated one for a short file. */
static noc_status check_archive(noc_stream *stream, noc_log *log) {
    char *buffer = noc_alloc(1 << 16);
    if (!buffer)
        return noc_no_memory(log, noc_stream_name(stream));
    size_t got = 1;
    noc_status status = noc_stream_rewind(stream);
    while (!status && got)
        status = noc_stream_read(stream, buffer, 1 << 16, &got);
    free(buffer);
    return status;
}

static bool is_gzip(const char *path) {
    unsigned char magic[2] = { 0 };
    FILE *f = fopen(path, "rb");
    bool gzip = f && fread(magic, 1, 2, f) == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
    if (f)
        fclose(f);
    return gzip;
}

/* The path itself, /vsigzip/path or /vsizip/{path}/member; *plain in the first case. A name that begins with /vsi is
 * that of a file here: what GDAL would make of it is kept away by the slashes. */
static noc_status gdal_path(noc_stream *stream, noc_log *log, char **path, bool *plain) {
    const char *name = noc_stream_name(stream);
    /* "http://x" stays a file's name */
    const char *slash = *name != '/' ? "./" : !strncmp(name, "/vsi", 4) ? "/./" : "";
    *plain = false;
    if (access(name, F_OK)) { /* path!member */
        const char *bang = name + strlen(name);
        char *archive = noc_strdup(name);
        if (!archive)
            return noc_no_memory(log, name);
        while (bang > name) {
            if (*bang == '!') {
                archive[bang - name] = 0;
                if (!access(archive, F_OK))
                    break;
            }
            bang--;
        }
        *path = noc_format("/vsizip/{%s%s}/%s", slash, archive, *bang == '!' ? bang + 1 : "");
        free(archive);
        return *path ? check_archive(stream, log) : noc_no_memory(log, name);
    }
    bool gzip = is_gzip(name);
    *plain = !gzip;
    *path = noc_format("%s%s%s", gzip ? "/vsigzip/" : "", slash, name);
    return !*path ? noc_no_memory(log, name) : gzip ? check_archive(stream, log) : NOC_OK;
}

/* ---- GeoPackage ---- */

/* What may be part of a name in SQLite. */
static size_t name_length(const char *p) {
    size_t n = 0;
    while (isalnum((unsigned char)p[n]) || p[n] == '_' || p[n] == '$' || (unsigned char)p[n] >= 0x80)
        n++;
    return n;
}

/* The text behind a word that blanks end, in any case; NULL where another stands there. */
static const char *behind_word(const char *p, const char *word) {
    size_t n = strlen(word), blanks = p && !strncasecmp(p, word, n) ? strspn(p + n, " \t\r\n") : 0;
    return blanks ? p + n + blanks : NULL;
}

/* The module of "VIRTUAL TABLE name USING module", NULL where the text is not just that: comments hide what SQLite
 * reads. */
static const char *module_of(const char *sql) {
    const char *p = behind_word(behind_word(sql, "VIRTUAL"), "TABLE");
    if (!p)
        return NULL;
    char quote = *p == '[' ? ']' : *p && strchr("\"'`", *p) ? *p : 0;
    const char *end = quote ? strchr(p + 1, quote) : p + name_length(p);
    if (!end)
        return NULL;
    end += quote != 0;
    return behind_word(end + strspn(end, " \t\r\n"), "USING");
}

/* SQLite reads as SQL whatever the schema's rows hold that begins with "cr", and a row's other columns tell nothing of
 * what comes of it. So each row must be plainly one of what SQLite itself writes there. */
static bool is_plain_row(const char *sql) {
    static const char *const plain[] = { "TABLE", "VIEW", "INDEX", "TRIGGER" };
    const char *p = behind_word(sql, "CREATE"), *unique = behind_word(p, "UNIQUE");
    for (size_t i = 0; i < NOC_COUNT(plain); i++)
        if (behind_word(p, plain[i]))
            return true;
    return behind_word(unique, "INDEX") != NULL;
}

/* Whether the CRSs are a view or a virtual table, which need not answer twice alike. What stands before the AS of a
 * view is its name, or hides it. */
static bool is_other_crs_table(const char *sql) {
    static const char crs[] = "gpkg_spatial_ref_sys";
    const char *create = behind_word(sql, "CREATE"), *p = behind_word(create, "VIEW"),
               *as = p ? strcasestr(p, " AS ") : NULL;
    char *head = p ? noc_strndup(p, as ? (size_t)(as - p) : strlen(p)) : NULL;
    bool is = p && (!head || strcasestr(head, crs) || strstr(head, "/*") || strstr(head, "--"));
    free(head);
    return is || (behind_word(create, "VIRTUAL") && strcasestr(sql, crs));
}

/* Virtual tables let a file's author open other files by name (VirtualText, VirtualOGR, ...). Indexes are all that is
 * in use. */
static noc_status check_schema_row(const map_source *m, const char *sql) {
    static const char *const harmless[] = { "rtree", "rtree_i32", "fts3", "fts4", "fts5" };
    if (is_other_crs_table(sql))
        return noc_error(m->log, NOC_ERR_UNSUPPORTED,
                         "%s: %s: gpkg_spatial_ref_sys is a view or a virtual table: not read", m->name, m->format);
    if (strncasecmp(sql, "cr", 2) || is_plain_row(sql))
        return NOC_OK;
    const char *module = module_of(behind_word(sql, "CREATE"));
    size_t n = module ? name_length(module) : 0;
    for (size_t i = 0; i < NOC_COUNT(harmless); i++)
        if (strlen(harmless[i]) == n && !strncasecmp(harmless[i], module, n))
            return NOC_OK;
    return noc_error(m->log, NOC_ERR_UNSUPPORTED, "%s: %s: a virtual table (%.*s) may open other files: not read",
                     m->name, m->format, module ? (int)NOC_MIN(n, 60) : 7, module ? module : "unclear");
}

static noc_status check_virtual_tables(map_source *m) {
    OGRLayerH rows =
        gdal.GDALDatasetExecuteSQL(m->dataset,
                                   "SELECT CASE typeof(sql) WHEN 'text' THEN sql ELSE 'CREATE' END FROM sqlite_master "
                                   "WHERE sql IS NOT NULL",
                                   NULL, NULL);
    noc_status status = rows ? NOC_OK : map_source_error(m);
    OGRFeatureH row;
    while (!status && (row = gdal.OGR_L_GetNextFeature(rows))) {
        status = check_schema_row(m, gdal.OGR_F_GetFieldAsString(row, 0));
        gdal.OGR_F_Destroy(row);
    }
    if (rows)
        gdal.GDALDatasetReleaseResultSet(m->dataset, rows);
    return !status && m->error[0] ? map_source_error(m) : status;
}

/* ---- opening ---- */

noc_status map_source_error(const map_source *m) {
    return noc_error(m->log, NOC_ERR_FORMAT, "%s: %s: %s", m->name, m->format, m->error[0] ? m->error : "not readable");
}

noc_status map_source_open(map_source *m, noc_stream *stream, const map_format *format, bool anywhere, noc_log *log) {
    static const char *const osm_options[] = { "CONFIG_FILE=" OSM_CONFIG_PATH, "COMPRESS_NODES=YES", NULL };
    static const char *const immutable[] = { "IMMUTABLE=YES", NULL }, *const none[] = { NULL };
    static const char *const gml_options[] = { "DOWNLOAD_SCHEMA=NO", "EXPOSE_GML_ID=YES", NULL };
    *m = (map_source){ .name = noc_stream_name(stream), .format = format->name, .log = log };
    bool copied = false;
    char *path = NULL;
    const char *why_not = gdal_load();
    if (why_not)
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: %s needs GDAL, which cannot be loaded: %s", m->name, m->format,
                         why_not);
    gdal_enter(m);
    noc_status status = gdal_path(stream, log, &path, &m->plain);
    m->parts = m->plain && format->kind == MAP_SHAPEFILE;
    if (!status && m->parts)
        status = map_check_shapefile(m->name, anywhere, noc_stream_listener(stream), log);
    if (!status && format->kind == MAP_SHAPEFILE)
        map_count_shapefile(path, m->unpaired, sizeof(m->unpaired));
    if (!status && m->plain && format->kind == MAP_GEOPACKAGE) {
        status = map_copy_geopackage(m->name, anywhere, noc_stream_budget(stream), noc_stream_listener(stream), log,
                                     &m->copy);
        copied = m->copy.path != NULL;
    }
    if (copied && !status) {
        free(path);
        path = noc_format("%s/" MAP_COPY_NAME, m->copy.path);
        status = path ? NOC_OK : noc_no_memory(log, m->name);
    }
    if (!status && format->kind == MAP_GML)
        status = map_gml_open(m, stream, &path);
    if (!status)
        status = map_check_crs(m, stream, path, format);
    if (!status) {
        const char *const *options = format->kind == MAP_OSM                     ? osm_options
                                     : format->kind == MAP_GML                   ? gml_options
                                     : format->kind == MAP_GEOPACKAGE && !copied ? immutable
                                                                                 : none;
        bool grid = format->kind == MAP_GEOTIFF;
        if (grid) { /* nothing beside it: no overviews, masks, world files */
            gdal.CPLSetThreadLocalConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
            gdal.CPLSetThreadLocalConfigOption("GDAL_GEOREF_SOURCES", "INTERNAL");
        }
        m->dataset =
            gdal.GDALOpenEx(path, (grid ? GDAL_OF_RASTER : GDAL_OF_VECTOR) | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                            format->drivers, options, NULL);
        if (m->dataset && m->link[0])
            m->error[0] = 0; /* that it was not fetched is said below */
        status = m->dataset && !m->error[0] ? NOC_OK : map_source_error(m);
    }
    if (!status && format->kind == MAP_GEOPACKAGE)
        status = check_virtual_tables(m);
    if (!status && format->kind == MAP_GEOPACKAGE)
        status = map_check_crs_rows(m);
    if (m->link[0])
        noc_warn(log,
                 "%s: its CRS is a link (%s), which is not followed: taken as longitudes and latitudes, "
                 "unless --crs says otherwise",
                 m->name, m->link);
    free(path);
    return status;
}

noc_status map_source_check(const map_source *m, noc_stream *stream) {
    enum { PIECE = 1 << 16 };
    char *piece = m->plain ? noc_alloc(PIECE) : NULL;
    noc_status status = !m->plain ? NOC_OK : piece ? noc_stream_rewind(stream) : noc_no_memory(m->log, m->name);
    for (size_t got = 1; !status && m->plain && got;)
        status = noc_stream_read(stream, piece, PIECE, &got);
    free(piece);
    return status || !m->parts ? status : map_check_told(m->name, m->log);
}

void map_source_close(map_source *m) {
    if (m->dataset)
        gdal.GDALClose(m->dataset);
    map_gml_close(m);
    free(m->content);
    array_free(&m->gml_crs);
    if (m->entered)
        gdal_leave();
    scratch_remove(&m->copy);
}

#endif
