/* The CRSs of maps are looked at before GDAL reads them: grids and files of definitions that a text names are opened at
 * once. */
#include "import/map/crs.h"
#include "import/map/columns.h"

#if NOC_HAVE_GDAL

#include <ctype.h>

enum { LONGEST = 1 << 16 }; /* bytes of a CRS's text */

noc_status map_check_crs_text(const char *text, const char *name, noc_log *log) {
    char what[40];
    if (!geo_crs_text_names_file(text, what))
        return NOC_OK;
    return noc_error(log, NOC_ERR_FORMAT, "%s: the CRS \"%.200s\" may open files (%s), which a file's CRS must not",
                     name, text, what);
}

/* ---- GeoJSON ---- */

/* Finds the strings of members "crs", however deep, as the readers of GDAL would: what comments and single quotes hide
 * from one of them and not from the other is refused. So is a name that is an object: GDAL takes its text for the
 * CRS's.
 * {"type": T, "properties": {"name": N}} has two levels. */
/* A CRS as a file has it, without blanks. */
typedef struct crs_text {
    char text[120];
    size_t length; /* of all of it; 0: none */
    size_t feature;
} crs_text;

typedef struct json_scan {
    const char *name;
    noc_log *log;
    size_t depth, crs_depth; /* crs_depth: of the member that is being read, 0: none */
    bool in_string, escaped;
    bool named; /* the file's own member holds a string */
    bool cut, cut_key;
    crs_text now, of_file, own[2]; /* own: of features, the first that differ */
    size_t now_feature, feature;
    bool in_list; /* of features */
    /* Members of objects called "properties" or "attributes", and of ArcGIS JSON the objects in "fields". */
    map_columns columns;
    const char *format;
    size_t columns_depth, fields_depth; /* of what is in them; 0: in none */
    bool columns_next, fields_next;     /* such a key was read */
    size_t fields;
    size_t geometry_depth;         /* of what is in a geometry; 0: in none */
    bool geometry_next, type_next; /* such a key was read */
    char strange[200];             /* map_source.strange */
    size_t strange_count;
    uint64_t hash; /* of the string so far */
    int hex;       /* digits of \u still to come */
    unsigned code;
    size_t length; /* of the string so far, though only its begin is kept */
    char text[LONGEST];
} json_scan;

/* Those of GeoJSON, and of ArcGIS JSON. */
static bool is_crs_key(const char *text) {
    return noc_ieq(text, "crs") || noc_ieq(text, "coordRefSys") || noc_ieq(text, "wkt") || noc_ieq(text, "wkt2");
}

/* {"exceededTransferLimit": true}: the server has sent a part. Of keys only the begin is kept. */
static bool is_cut_key(const char *text) { return !strcmp(text, "exceededTransfe"); }

/* ---- CRSs of features ---- */

static void keep_crs(json_scan *s, char c) {
    if (isspace((unsigned char)c) || (!s->now.length && c == ':'))
        return;
    if (s->now.length + 1 < sizeof(s->now.text))
        s->now.text[s->now.length] = c;
    s->now.length++;
}

static bool same_crs(const crs_text *a, const crs_text *b) {
    return a->length == b->length && !strcmp(a->text, b->text);
}

/* A member has ended. Of a feature's properties one may be called so, too: that is no object. */
static void crs_ended(json_scan *s) {
    crs_text now = s->now;
    bool of_file = s->crs_depth == 1;
    s->now = (crs_text){ 0 };
    s->crs_depth = 0;
    now.text[NOC_MIN(now.length, sizeof(now.text) - 1)] = 0;
    now.feature = s->now_feature;
    if (now.text[0] != '{' || !strstr(now.text, "\"properties\""))
        return;
    if (of_file)
        s->of_file = now;
    else if (!s->own[0].length)
        s->own[0] = now;
    else if (!s->own[1].length && !same_crs(&s->own[0], &now))
        s->own[1] = now;
}

/* The file's CRS may come behind those of its features. */
static void tell_odd(const json_scan *s, char *odd, size_t size) {
    for (int i = 0; i < 2 && !*odd; i++)
        if (s->own[i].length && !same_crs(&s->own[i], &s->of_file))
            noc_snprintf(odd, size, "feature %zu has the CRS %s of its own, the file %s", s->own[i].feature,
                         s->own[i].text, s->of_file.length ? s->of_file.text : "none");
}

/* Counts the objects of the list that lies in the file's object. */
static void count_feature(json_scan *s, char c) {
    if (s->depth == 2)
        s->in_list = c == '[';
    s->feature += s->depth == 3 && s->in_list && c == '{';
}

/* Elsewhere than in a CRS only keys matter, which are short. */
static void keep(json_scan *s, char c) {
    if (s->length < (s->crs_depth ? LONGEST : 16) - 1)
        s->text[s->length] = c;
    s->length++;
    s->hash = map_column_hash(s->hash, c);
}

/* ---- columns ---- */

static noc_status key_ended(json_scan *s) {
    bool column = s->columns_depth && s->depth == s->columns_depth;
    s->columns_next =
        !s->columns_depth && !s->crs_depth && (!strcmp(s->text, "properties") || !strcmp(s->text, "attributes"));
    s->fields_next = s->depth == 1 && !strcmp(s->text, "fields");
    s->geometry_next = !s->geometry_depth && !s->columns_depth && !strcmp(s->text, "geometry");
    s->type_next = s->geometry_depth && s->depth == s->geometry_depth && !strcmp(s->text, "type");
    return column && !map_columns_add(&s->columns, s->hash) ? map_columns_refuse(s->name, s->format, s->log) : NOC_OK;
}

/* A field's definition counts by its number, its name is one of the members' as well. */
static noc_status object_begins(json_scan *s, char c) {
    if (s->columns_next && c == '{')
        s->columns_depth = s->depth;
    if (s->fields_next && c == '[')
        s->fields_depth = s->depth;
    if (s->geometry_next && c == '{')
        s->geometry_depth = s->depth;
    s->columns_next = s->fields_next = s->geometry_next = s->type_next = false;
    if (!s->fields_depth || c != '{' || s->depth != s->fields_depth + 1)
        return NOC_OK;
    s->fields++;
    return s->fields > MAP_MOST_COLUMNS ? map_columns_refuse(s->name, s->format, s->log) : NOC_OK;
}

static void object_ended(json_scan *s) {
    s->columns_depth = s->depth < s->columns_depth ? 0 : s->columns_depth;
    s->fields_depth = s->depth < s->fields_depth ? 0 : s->fields_depth;
    s->geometry_depth = s->depth < s->geometry_depth ? 0 : s->geometry_depth;
}

/* ---- geometries ---- */

/* Notes the type of a geometry that is none of RFC 7946. Of long names the begin alone is kept, which is enough. */
static void type_ended(json_scan *s) {
    static const char *const types[] = { "Point",   "MultiPoint",   "LineString",        "MultiLineString",
                                         "Polygon", "MultiPolygon", "GeometryCollection" };
    s->type_next = false;
    for (size_t i = 0; i < NOC_COUNT(types); i++)
        if (s->length == strlen(types[i]) && !strncmp(s->text, types[i], 15))
            return;
    s->strange_count++;
    char item[24];
    noc_snprintf(item, sizeof(item), "%s%.15s", *s->strange ? ", " : "", s->text);
    if (!strstr(s->strange, s->text) && strlen(s->strange) + strlen(item) < sizeof(s->strange))
        strcat(s->strange, item);
}

static noc_status string_ended(json_scan *s) {
    s->text[NOC_MIN(s->length, (s->crs_depth ? LONGEST : 16) - 1)] = 0;
    s->in_string = false;
    if (s->type_next)
        type_ended(s);
    if (!s->crs_depth)
        return NOC_OK;
    s->named = s->named || s->crs_depth == 1;
    if (s->length >= LONGEST)
        return noc_error(s->log, NOC_ERR_FORMAT, "%s: a CRS of more than %d bytes", s->name, LONGEST);
    return map_check_crs_text(s->text, s->name, s->log);
}

static void hex_digit(json_scan *s, char c) {
    int digit = isdigit((unsigned char)c) ? c - '0' : (tolower((unsigned char)c) - 'a' + 10) & 15;
    s->code = 16 * s->code + (unsigned)digit;
    if (!--s->hex)
        keep(s, s->code < 128 ? (char)s->code : '?');
}

static noc_status in_string(json_scan *s, char c) {
    static const char blanks[] = "bfnrt";
    if (s->hex) {
        hex_digit(s, c);
    } else if (s->escaped) {
        s->escaped = false;
        s->hex = c == 'u' ? 4 : 0;
        s->code = 0;
        if (c != 'u')
            keep(s, c && strchr(blanks, c) ? ' ' : c);
    } else if (c == '"') {
        return string_ended(s);
    } else if (c == '\\') {
        s->escaped = true;
    } else {
        keep(s, c);
    }
    return NOC_OK;
}

static noc_status between_strings(json_scan *s, char c) {
    noc_status status = NOC_OK;
    switch (c) {
    case '"':
        s->in_string = true;
        s->length = 0;
        s->hash = MAP_COLUMN_SEED;
        break;
    case ':':
        if (!s->crs_depth && is_crs_key(s->text)) {
            s->crs_depth = s->depth;
            s->now_feature = s->feature;
        }
        s->cut_key = !s->crs_depth && is_cut_key(s->text);
        status = key_ended(s);
        break;
    case 't': s->cut = s->cut || s->cut_key; break;
    case '{':
    case '[':
        s->depth++;
        count_feature(s, c);
        status = object_begins(s, c);
        if (s->crs_depth && s->depth > s->crs_depth + 2)
            return noc_error(s->log, NOC_ERR_FORMAT,
                             "%s: GeoJSON: a CRS in parts (PROJJSON), where its name is expected", s->name);
        break;
    case '}':
    case ']':
        s->depth -= s->depth > 0;
        if (s->depth < s->crs_depth)
            crs_ended(s);
        object_ended(s);
        break;
    case ',':
        s->geometry_next = s->type_next = false; /* it was no object */
        if (s->crs_depth && s->depth == s->crs_depth)
            crs_ended(s);
        break;
    case '\'':
    case '/':
        return noc_error(s->log, NOC_ERR_FORMAT, "%s: GeoJSON: %s outside of strings", s->name,
                         c == '/' ? "a comment" : "a single quote");
    }
    if (c != '"' && !isspace((unsigned char)c) && c != ':')
        s->text[0] = 0; /* no key */
    return status;
}

static noc_status check_character(json_scan *s, char c) {
    noc_status status = s->in_string ? in_string(s, c) : between_strings(s, c);
    if (s->crs_depth)
        keep_crs(s, c);
    return status;
}

static noc_status check_json(map_source *m, noc_stream *stream, bool *named, bool *cut) {
    enum { CHUNK = 1 << 16 };
    noc_log *log = m->log;
    json_scan *s = noc_calloc(1, sizeof(*s));
    char *buffer = noc_alloc(CHUNK);
    size_t got = 1;
    noc_status status = s && buffer ? noc_stream_rewind(stream) : noc_no_memory(log, noc_stream_name(stream));
    if (s) {
        s->name = noc_stream_name(stream);
        s->log = log;
        s->format = m->format;
    }
    while (!status && got) {
        status = noc_stream_read(stream, buffer, CHUNK, &got);
        for (size_t i = 0; i < got && !status; i++)
            status = check_character(s, buffer[i]);
    }
    if (s)
        tell_odd(s, m->odd_crs, sizeof(m->odd_crs));
    if (s) {
        memcpy(m->strange, s->strange, sizeof(m->strange));
        m->strange_count = s->strange_count;
    }
    *named = s && s->named;
    *cut = s && s->cut;
    free(s);
    free(buffer);
    return status;
}

/* ---- FlatGeobuf ---- */

/* A text of a header. GDAL puts ":" and a number behind that of an authority, and takes both for a CRS. */
static noc_status check_header_text(const char *text, const char *name, noc_log *log) {
    char *authority = noc_format("%s:0", text);
    noc_status status = authority ? map_check_crs_text(text, name, log) : noc_no_memory(log, name);
    if (!status)
        status = map_check_crs_text(authority, name, log);
    free(authority);
    return status;
}

/* Its header holds texts that end in 0, the CRS's among them. */
static noc_status check_flatgeobuf(noc_stream *stream, noc_log *log) {
    enum { BEGIN = 12, MOST = 10 << 20 }; /* GDAL reads no larger header */
    const char *name = noc_stream_name(stream);
    unsigned char begin[BEGIN];
    size_t size = 0, got = 1;
    noc_status status = noc_stream_rewind(stream);
    for (; !status && got && size < BEGIN; size += got)
        status = noc_stream_read(stream, begin + size, BEGIN - size, &got);
    if (status || size < BEGIN)
        return status; /* GDAL says what is wrong with it */
    size_t length = begin[8] | (size_t)begin[9] << 8 | (size_t)begin[10] << 16 | (size_t)begin[11] << 24;
    length = NOC_MIN(length, MOST);
    char *header = noc_alloc(length + 1);
    if (!header)
        return noc_no_memory(log, name);
    for (size = 0, got = 1; !status && got && size < length; size += got)
        status = noc_stream_read(stream, header + size, length - size, &got);
    header[size] = 0;
    for (size_t at = 0; !status && at < size; at += strlen(header + at) + 1)
        status = check_header_text(header + at, name, log);
    free(header);
    return status;
}

/* ---- Shapefile ---- */

/* The text as GDAL puts it together: what stands behind a 0 in a line is lost, and nothing stays between the lines. */
static void join_lines(char *text, size_t n) {
    size_t kept = 0;
    bool lost = false;
    for (size_t i = 0; i < n; i++) {
        bool line_ends = text[i] == '\n' || text[i] == '\r';
        lost = !line_ends && (lost || !text[i]);
        if (!line_ends && !lost)
            text[kept++] = text[i];
    }
    text[kept] = 0;
}

/* Checked as GDAL reads it today, and as a reader would that keeps the lines apart. */
static noc_status check_prj(const char *path, const char *name, noc_log *log) {
    char *text = noc_alloc(LONGEST), *apart = noc_alloc(LONGEST);
    VSILFILE *f = text && apart ? gdal.VSIFOpenL(path, "rb") : NULL;
    size_t n = f ? gdal.VSIFReadL(text, 1, LONGEST, f) : 0;
    noc_status status = text && apart ? NOC_OK : noc_no_memory(log, name);
    if (!status && !(f && (n == LONGEST || gdal.VSIFEofL(f))))
        status = noc_error(log, NOC_ERR_IO, "%s: its .prj cannot be read", name);
    if (n == LONGEST)
        status = noc_error(log, NOC_ERR_FORMAT, "%s: its .prj has more than %d bytes", name, LONGEST);
    if (!status && n) {
        for (size_t i = 0; i < n; i++)
            apart[i] = !text[i] || text[i] == '\n' || text[i] == '\r' ? ' ' : text[i];
        apart[n] = 0;
        join_lines(text, n);
        status = map_check_crs_text(text, name, log);
        status = status ? status : map_check_crs_text(apart, name, log);
    }
    if (f)
        gdal.VSIFCloseL(f);
    free(text);
    free(apart);
    return status;
}

/* Any that is called like it, in whatever case. */
static noc_status check_shapefile(const char *path, const char *name, noc_log *log) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    size_t stem = dot ? (size_t)(dot - base) : strlen(base);
    char *folder = noc_strndup(path, slash ? (size_t)(slash - path) : 0);
    if (!folder)
        return noc_no_memory(log, name);
    char **entries = gdal.VSIReadDir(*folder ? folder : slash ? "/" : ".");
    noc_status status = NOC_OK;
    for (size_t i = 0; entries && entries[i] && !status; i++) {
        if (strncasecmp(entries[i], base, stem) || !noc_ieq(entries[i] + NOC_MIN(stem, strlen(entries[i])), ".prj"))
            continue;
        char *part = noc_format("%.*s%s", (int)(base - path), path, entries[i]);
        status = part ? check_prj(part, name, log) : noc_no_memory(log, name);
        free(part);
    }
    gdal.CSLDestroy(entries);
    free(folder);
    return status;
}

noc_status map_check_crs(map_source *m, noc_stream *stream, const char *path, const map_format *format) {
    bool cut = false, arcgis;
    noc_log *log = m->log;
    m->crs_named = true;
    noc_status status = format->kind == MAP_GEOJSON  ? check_json(m, stream, &m->crs_named, &cut)
                        : format->kind == MAP_ARCGIS ? check_json(m, stream, &arcgis, &cut)
                                                     : NOC_OK;
    if (cut)
        noc_warn(log, "%s: the server gave a part of its features (exceededTransferLimit): ask it for the others",
                 noc_stream_name(stream));
    return status                           ? status
           : format->kind == MAP_FLATGEOBUF ? check_flatgeobuf(stream, log)
           : format->kind == MAP_SHAPEFILE  ? check_shapefile(path, noc_stream_name(stream), log)
                                            : NOC_OK;
}

/* ---- GeoPackage ---- */

/* The texts that a query of one column gives. As they are cast to text, none is taken for a geometry, which would have
 * a CRS. */
static noc_status check_query(map_source *m, const char *query) {
    OGRLayerH rows = gdal.GDALDatasetExecuteSQL(m->dataset, query, NULL, NULL);
    noc_status status = rows ? NOC_OK : map_source_error(m);
    OGRFeatureH row;
    while (!status && (row = gdal.OGR_L_GetNextFeature(rows))) {
        status = map_check_crs_text(gdal.OGR_F_GetFieldAsString(row, 0), m->name, m->log);
        gdal.OGR_F_Destroy(row);
    }
    if (rows)
        gdal.GDALDatasetReleaseResultSet(m->dataset, rows);
    return !status && m->error[0] ? map_source_error(m) : status;
}

static bool has_rows(map_source *m, const char *query) {
    OGRLayerH rows = gdal.GDALDatasetExecuteSQL(m->dataset, query, NULL, NULL);
    OGRFeatureH row = rows ? gdal.OGR_L_GetNextFeature(rows) : NULL;
    bool any = row != NULL;
    gdal.OGR_F_Destroy(row);
    if (rows)
        gdal.GDALDatasetReleaseResultSet(m->dataset, rows);
    return any;
}

/* What is read above must be what GDAL finds, which looks for one row: a column that is computed may be another each
 * time, and an index need not hold what the table does. The key srs_id INTEGER PRIMARY KEY has none. */
static noc_status check_plain_table(map_source *m) {
    static const struct {
        const char *query, *what;
    } others[] = {
        { "SELECT 1 FROM pragma_table_xinfo('gpkg_spatial_ref_sys') WHERE hidden <> 0",
          "a hidden or generated column" },
        { "SELECT 1 FROM pragma_index_list('gpkg_spatial_ref_sys')",
          "an index (a UNIQUE column or another key than srs_id INTEGER PRIMARY KEY is one)" },
    };
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        if (has_rows(m, others[i].query))
            return noc_error(m->log, NOC_ERR_UNSUPPORTED, "%s: %s: gpkg_spatial_ref_sys has %s: not read", m->name,
                             m->format, others[i].what);
    return m->error[0] ? map_source_error(m) : NOC_OK;
}

noc_status map_check_crs_rows(map_source *m) {
    static const char *const columns[] = { "definition", "organization", "definition_12_063" };
    noc_status status = check_plain_table(m);
    for (size_t i = 0; i < NOC_COUNT(columns) && !status; i++) {
        char *there =
            noc_format("SELECT 1 FROM pragma_table_info('gpkg_spatial_ref_sys') WHERE lower(name) = '%s'", columns[i]);
        char *query = noc_format("SELECT coalesce(CAST(%s AS TEXT), '') FROM gpkg_spatial_ref_sys", columns[i]);
        if (!there || !query)
            status = noc_no_memory(m->log, m->name);
        else if (has_rows(m, there))
            status = check_query(m, query);
        free(there);
        free(query);
    }
    return !status && m->error[0] ? map_source_error(m) : status;
}

#endif
