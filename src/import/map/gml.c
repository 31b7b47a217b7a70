/* GML as servers of features (WFS) give it. GDAL takes it from memory: beside a file it would look for schemas, and
 * write one. */
#include "import/map/source.h"

#if NOC_HAVE_GDAL

#include <ctype.h>
#include <stdio.h>

/* The number in the attribute of the first 4 KB; -1: there is none. */
static long long number_of(const char *content, const char *attribute) {
    const char *at = strstr(content, attribute), *value = at ? at + strlen(attribute) : NULL;
    long long n = -1;
    char digits[20] = "";
    if (!at || at - content > 4096 || sscanf(value, "=%*1[\"']%19[0-9]", digits) != 1 || !noc_parse_int(digits, &n))
        return -1;
    return n;
}

/* EPSG:25832, urn:ogc:def:crs:EPSG::25832 and http://www.opengis.net/def/crs/EPSG/0/25832 are names; GDAL would open
 * what is none. */
static bool is_crs_name(const char *value, size_t n) {
    static const char *const begins[] = {
        "EPSG:", "OGC:", "CRS:", "urn:", "http://www.opengis.net/", "https://www.opengis.net/"
    };
    bool known = false;
    for (size_t i = 0; i < NOC_COUNT(begins); i++)
        known = known || (n > strlen(begins[i]) && !strncasecmp(value, begins[i], strlen(begins[i])));
    for (size_t i = 0; i < n; i++)
        known = known && (isalnum((unsigned char)value[i]) || strchr(":/.#_-,", value[i]));
    return known;
}

static noc_status check_crs_names(const char *content, const char *name, noc_log *log) {
    static const char key[] = "srsName";
    for (const char *p = content; (p = strstr(p, key));) {
        p += strlen(key);
        p += strspn(p, " \t\r\n=");
        char quote = *p;
        const char *end = quote == '"' || quote == '\'' ? strchr(p + 1, quote) : NULL;
        if (end && !is_crs_name(p + 1, (size_t)(end - p - 1)))
            return noc_error(log, NOC_ERR_FORMAT, "%s: GML: \"%.*s\" is no name of a CRS", name,
                             (int)NOC_MIN(end - p - 1, 200), p + 1);
    }
    return NOC_OK;
}

noc_status map_gml_open(map_source *m, noc_stream *stream, char **path) {
    size_t size;
    noc_status status = noc_stream_rewind(stream);
    status = status ? status : noc_stream_read_all(stream, m->log, &m->content, &size);
    if (status)
        return status;
    if (strstr(m->content, "<!DOCTYPE") || strlen(m->content) != size)
        return noc_error(m->log, NOC_ERR_FORMAT, "%s: GML: %s", m->name,
                         strlen(m->content) != size ? "it holds a 0" : "a document type, which GML has none of");
    if ((status = check_crs_names(m->content, m->name, m->log)))
        return status;
    for (char *p = m->content; (p = strstr(p, "schemaLocation"));)
        memcpy(p, "schema_nowhere", 14); /* which no reader goes to */
    long long all = number_of(m->content, "numberMatched"), here = number_of(m->content, "numberReturned");
    if (here >= 0 && all > here)
        noc_warn(m->log, "%s: the server had %lld features and gave %lld: ask it for the others (startIndex, count)",
                 m->name, all, here);
    if ((status = map_gml_look_at_places(m)))
        return status;
    size = strlen(m->content);
    snprintf(m->memory, sizeof(m->memory), "/vsimem/nocturne/%p.gml", (void *)m);
    VSILFILE *f = gdal.VSIFileFromMemBuffer(m->memory, (GByte *)m->content, size, FALSE);
    if (f)
        gdal.VSIFCloseL(f);
    free(*path);
    *path = f ? noc_strdup(m->memory) : NULL;
    return *path ? NOC_OK : noc_no_memory(m->log, m->name);
}

void map_gml_close(map_source *m) {
    if (!m->memory[0])
        return;
    gdal.VSIUnlink(m->memory);
    memcpy(strrchr(m->memory, '.'), ".gfs", 5); /* that GDAL has written */
    gdal.VSIUnlink(m->memory);
}

#endif
