/* Map files through GDAL: which files it may open, how, and what becomes of its messages. */
#include "import/map_source.h"
#include "import/map_parts.h"

#if NOC_HAVE_GDAL

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_http.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
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

/* What GDAL's GeoJSON reader says of a geometry that it leaves out ("Invalid 'x' coordinate. Type is not double ...", "Invalid Point
 * object. ..."): its feature then has no place, and is counted so. */
static bool is_of_one_geometry(const char *text) { return !strncmp(text, "Invalid ", 8) && !strstr(text, "Feature"); }

static void CPL_STDCALL on_gdal_error(CPLErr level, CPLErrorNum code, const char *text) {
    map_source *m = CPLGetErrorHandlerUserData();
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
static CPLHTTPResult *refuse_fetch(const char *url, CSLConstList options, GDALProgressFunc progress, void *progress_data,
                                   CPLHTTPFetchWriteFunc write, void *write_data, void *user) {
    map_source *m = user;
    if (!m->link[0])
        snprintf(m->link, sizeof(m->link), "%s", url);
    CPLHTTPResult *none = CPLCalloc(1, sizeof(*none)); /* NULL would leave it to curl after all */
    none->nStatus = 1;
    none->pszErrBuf = CPLStrdup("nothing is fetched");
    return none;
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
    { "CPL_CURL_ENABLE_VSIMEM", "NO" },
    { "GDAL_DISABLE_READDIR_ON_OPEN", "NO" },   /* a Shapefile's other parts are found */
    { "GDAL_PAM_ENABLED", "NO" },               /* no .aux.xml, neither read nor written */
    { "OGR_SQLITE_LOAD_EXTENSIONS", NULL },
    { "OGR_SQLITE_PRAGMA", "trusted_schema=OFF" }, /* no views or triggers over functions that touch files */
    { "OGR_SQLITE_LIST_VIRTUAL_OGR", "NO" },
    { "SHAPE_RESTORE_SHX", "NO" },
    { "SQLITE_USE_OGR_VFS", "NO" },
};

static void gdal_enter(map_source *m) {
    pthread_once(&gdal_once, gdal_start);
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        CPLSetThreadLocalConfigOption(gdal_settings[i].key, gdal_settings[i].value);
    CPLSetThreadLocalConfigOption("CPL_TMPDIR", map_temporary_folder());
    CPLPushErrorHandlerEx(on_gdal_error, m);
    CPLHTTPPushFetchCallback(refuse_fetch, m);
}

static void gdal_leave(void) {
    CPLHTTPPopFetchCallback();
    CPLPopErrorHandler();
    CPLErrorReset();
    for (size_t i = 0; i < NOC_COUNT(gdal_settings); i++)
        CPLSetThreadLocalConfigOption(gdal_settings[i].key, NULL);
    CPLSetThreadLocalConfigOption("CPL_TMPDIR", NULL);
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

/* The path itself, /vsigzip/path or /vsizip/{path}/member; *plain in the first case. A name that begins with /vsi is that of a
 * file here: what GDAL would make of it is kept away by the slashes. */
static noc_status gdal_path(noc_stream *stream, noc_log *log, char **path, bool *plain) {
    const char *name = noc_stream_name(stream);
    const char *slash = *name != '/' ? "./" : !strncmp(name, "/vsi", 4) ? "/./" : ""; /* "http://x" stays a file's name */
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

/* The module of "CREATE VIRTUAL TABLE name USING module"; NULL where the text is not just that. */
static const char *module_of(const char *sql) {
    static const char begin[] = "CREATE VIRTUAL TABLE ", using[] = "USING ";
    if (strncasecmp(sql, begin, strlen(begin)))
        return NULL;
    const char *p = sql + strlen(begin);
    p += strspn(p, " \t\r\n");
    char quote = *p == '[' ? ']' : *p && strchr("\"'`", *p) ? *p : 0;
    const char *end = quote ? strchr(p + 1, quote) : p + strcspn(p, " \t\r\n");
    p = end ? end + (quote != 0) : sql + strlen(sql);
    p += strspn(p, " \t\r\n");
    return strncasecmp(p, using, strlen(using)) ? NULL : p + strlen(using);
}

/* Virtual tables let a file's author open other files by name (VirtualText, VirtualOGR, ...). Indexes are all that is in use. */
static noc_status check_virtual_tables(map_source *m) {
    static const char *const harmless[] = { "rtree", "rtree_i32", "fts3", "fts4", "fts5" };
    OGRLayerH tables = GDALDatasetExecuteSQL(m->dataset, "SELECT sql FROM sqlite_master WHERE sql LIKE 'CREATE VIRTUAL%'", NULL, NULL);
    noc_status status = NOC_OK;
    OGRFeatureH row;
    while (tables && !status && (row = OGR_L_GetNextFeature(tables))) {
        const char *module = module_of(OGR_F_GetFieldAsString(row, 0));
        size_t n = module ? strspn(module, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") : 0;
        bool known = false;
        for (size_t i = 0; i < NOC_COUNT(harmless); i++)
            known = known || (strlen(harmless[i]) == n && !strncasecmp(harmless[i], module, n));
        if (!known)
            status = noc_error(m->log, NOC_ERR_UNSUPPORTED, "%s: %s: a virtual table (%.*s) may open other files: not read", m->name,
                               m->format, module ? (int)n : 7, module ? module : "unclear");
        OGR_F_Destroy(row);
    }
    if (tables)
        GDALDatasetReleaseResultSet(m->dataset, tables);
    return status;
}

/* ---- opening ---- */

noc_status map_source_error(const map_source *m) {
    return noc_error(m->log, NOC_ERR_FORMAT, "%s: %s: %s", m->name, m->format, m->error[0] ? m->error : "not readable");
}

noc_status map_source_open(map_source *m, noc_stream *stream, const map_format *format, bool anywhere, noc_log *log) {
    static const char *const osm_options[] = { "CONFIG_FILE=" OSM_CONFIG_PATH, "COMPRESS_NODES=YES", NULL };
    static const char *const immutable[] = { "IMMUTABLE=YES", NULL }, *const none[] = { NULL };
    *m = (map_source){ .name = noc_stream_name(stream), .format = format->name, .log = log };
    bool plain, copied = false;
    char *path = NULL;
    gdal_enter(m);
    noc_status status = gdal_path(stream, log, &path, &plain);
    if (!status && plain && format->kind == MAP_SHAPEFILE)
        status = map_check_shapefile(m->name, anywhere, log);
    if (!status && plain && format->kind == MAP_GEOPACKAGE) {
        status = map_copy_geopackage(m->name, anywhere, log, &m->copy);
        copied = m->copy != NULL;
    }
    if (copied && !status) {
        free(path);
        path = noc_format("%s/" MAP_COPY_NAME, m->copy);
        status = path ? NOC_OK : noc_no_memory(log, m->name);
    }
    if (!status) {
        const char *const *options = format->kind == MAP_OSM ? osm_options : format->kind == MAP_GEOPACKAGE && !copied ? immutable : none;
        m->dataset = GDALOpenEx(path, GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, format->drivers, options, NULL);
        if (m->dataset && m->link[0])
            m->error[0] = 0; /* that it was not fetched is said below */
        status = m->dataset && !m->error[0] ? NOC_OK : map_source_error(m);
    }
    if (!status && format->kind == MAP_GEOPACKAGE)
        status = check_virtual_tables(m);
    if (m->link[0])
        noc_warn(log, "%s: its CRS is a link (%s), which is not followed: taken as longitudes and latitudes, unless --crs says otherwise",
                 m->name, m->link);
    free(path);
    return status;
}

void map_source_close(map_source *m) {
    if (m->dataset)
        GDALClose(m->dataset);
    gdal_leave();
    map_remove_copy(m->copy);
    free(m->copy);
}

#endif
