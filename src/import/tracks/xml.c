/* Tracks in XML, by expat: GPX 1.0 and 1.1 (tracks with their segments, and routes), and lists of points with a
 * latitude, a longitude and an `end`, as Hlavova (2025, section 5.1) has them. GPX could go through GDAL, too: that
 * drops the times of points unless it is asked for each by itself, and costs a process of its own. */
#include "import/tracks/tracks.h"
#include "import/xml.h"

#include <math.h>
#include <nocturne/text.h>

typedef struct track_xml {
    track_writer w;
    noc_stream *stream;
    XML_Parser xml;
    bool gpx, refused_entity;
    int depth, named; /* named: depth of the element whose name the track gets */
    bool in_point;
    int point_depth;
    double lat, lon, seconds;
    bool end;
    char text[80]; /* of the innermost element */
    size_t length;
} track_xml;

/* A name without its prefix. */
static const char *local(const char *name) {
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

static bool is_one_of(const char *name, const char *const *words) {
    for (; *words; words++)
        if (noc_ieq(name, *words))
            return true;
    return false;
}

static const char *const latitude[] = { "lat", "latitude", NULL }, *const longitude[] = { "lon", "lng", "long",
                                                                                          "longitude", NULL };
static const char *const yes[] = { "true", "1", "yes", NULL };

/* What a point tells of itself, in an attribute or an element of its own. */
static void take_value(track_xml *x, const char *name, const char *value) {
    double number;
    bool is_lat = is_one_of(name, latitude), is_lon = !is_lat && is_one_of(name, longitude);
    if (is_lat || is_lon)
        *(is_lat ? &x->lat : &x->lon) = noc_parse_double(value, &number) ? number : NAN;
    else if (!strcmp(name, "time"))
        x->seconds = track_time(value);
    else if (!x->gpx && !strcmp(name, "end"))
        x->end = is_one_of(value, yes);
}

static bool holds_point(const char *name, const char **attributes) {
    bool lat = false, lon = false;
    for (; *attributes; attributes += 2) {
        lat = lat || is_one_of(local(attributes[0]), latitude);
        lon = lon || is_one_of(local(attributes[0]), longitude);
    }
    return lat && lon && strcmp(name, "wpt") != 0;
}

/* A list of points has no element of a known name: who has a latitude is one. */
static void begin_point(track_xml *x, int depth) {
    if (x->in_point)
        return;
    x->in_point = true;
    x->point_depth = depth;
    x->lat = x->lon = x->seconds = NAN;
    x->end = false;
}

static void on_start(void *user, const char *full, const char **attributes) {
    track_xml *x = user;
    const char *name = local(full);
    x->depth++;
    x->length = 0;
    bool starts = x->gpx && (!strcmp(name, "trk") || !strcmp(name, "rte"));
    if (starts) {
        x->named = x->depth;
        track_begin(&x->w, "");
    }
    if (x->gpx ? !strcmp(name, "trkpt") || !strcmp(name, "rtept") : holds_point(name, attributes)) {
        begin_point(x, x->depth);
        for (; *attributes; attributes += 2)
            take_value(x, local(attributes[0]), attributes[1]);
    } else if (!x->gpx && (is_one_of(name, latitude) || is_one_of(name, longitude))) {
        begin_point(x, x->depth - 1);
    }
}

static void on_text(void *user, const char *text, int length) {
    track_xml *x = user;
    size_t n = NOC_MIN((size_t)length, sizeof(x->text) - 1 - x->length);
    memcpy(x->text + x->length, text, n);
    x->length += n;
}

static void end_point(track_xml *x) {
    x->in_point = false;
    if (!*x->w.id)
        track_begin(&x->w, "");
    track_point(&x->w, x->lon, x->lat, x->seconds);
    if (x->end)
        track_end(&x->w);
}

/* By its number and its name: names need not differ. */
static void name_track(track_xml *x) {
    char name[40];
    noc_snprintf(x->w.id, sizeof(x->w.id), "%zu %s", x->w.tracks, noc_text_clean(name, sizeof(name), x->text));
}

static void on_end(void *user, const char *full) {
    track_xml *x = user;
    const char *name = local(full);
    x->text[x->length] = 0;
    x->length = 0;
    if (x->in_point && x->depth == x->point_depth + 1)
        take_value(x, name, x->text + strspn(x->text, " \t\r\n"));
    if (x->in_point && x->depth == x->point_depth)
        end_point(x);
    if (x->gpx && !strcmp(name, "trkseg"))
        track_end_part(&x->w);
    if (x->gpx && x->depth == x->named + 1 && !strcmp(name, "name") && *x->w.id && *x->text)
        name_track(x);
    if (x->gpx && (!strcmp(name, "trk") || !strcmp(name, "rte")))
        track_end(&x->w);
    x->depth--;
}

static void refuse_entities(void *user, const XML_Char *name, int is_parameter, const XML_Char *value, int length,
                            const XML_Char *base, const XML_Char *system, const XML_Char *public_id,
                            const XML_Char *notation) {
    track_xml *x = user;
    x->refused_entity = true;
    XML_StopParser(x->xml, XML_FALSE);
}

static noc_status after_chunk(void *user) {
    track_xml *x = user;
    if (x->w.status)
        return x->w.status;
    geo_sink *sink = x->w.sink;
    return !sink->progress || sink->progress(sink->ctx, noc_stream_progress(x->stream)) ? NOC_OK : NOC_ERR_CANCELLED;
}

static noc_status xml_error(track_xml *x, xml_fault fault) {
    noc_log *log = x->w.sink->log;
    unsigned long line = XML_GetCurrentLineNumber(x->xml);
    if (fault == XML_FAULT_MEMORY)
        return noc_no_memory(log, x->w.place);
    if (fault == XML_FAULT_TAG)
        return noc_error(log, NOC_ERR_FORMAT, "%s:%lu: a tag or comment of more than 4 MB, which is not read",
                         x->w.place, line);
    if (x->refused_entity)
        return noc_error(log, NOC_ERR_FORMAT, "%s:%lu: the document declares an entity; such files are refused",
                         x->w.place, line);
    return noc_error(log, NOC_ERR_FORMAT, "%s:%lu: %s", x->w.place, line, XML_ErrorString(XML_GetErrorCode(x->xml)));
}

static noc_status parse(track_xml *x) {
    x->xml = xml_create(NULL);
    if (!x->xml)
        return noc_no_memory(x->w.sink->log, x->w.place);
    XML_SetUserData(x->xml, x);
    XML_SetElementHandler(x->xml, on_start, on_end);
    XML_SetCharacterDataHandler(x->xml, on_text);
    XML_SetEntityDeclHandler(x->xml, refuse_entities);
    xml_fault fault;
    noc_status status = xml_read(x->xml, &(xml_progress){ 0 }, x->stream, after_chunk, x, &fault);
    if (!status && fault)
        status = xml_error(x, fault);
    XML_ParserFree(x->xml);
    return status;
}

/* ---- probe ---- */

/* The root element, behind what may stand before it; NULL where the head ends first. */
static const char *find_root(const char *s) {
    while ((s = strchr(s, '<')) && (s[1] == '?' || s[1] == '!')) {
        s = !strncmp(s, "<!--", 4) ? strstr(s, "-->") : strchr(s, '>');
        if (!s)
            return NULL;
    }
    return s;
}

static bool is_gpx(const char *root) {
    size_t length = strcspn(root + 1, " \t\r\n/>");
    const char *name = root + 1;
    for (size_t i = 0; i < length; i++)
        name = root[1 + i] == ':' ? root + 2 + i : name;
    return (size_t)(root + 1 + length - name) == 3 && !strncmp(name, "gpx", 3);
}

/* Is the word there as a name of an attribute or element? */
static bool has_name(const char *text, const char *word) {
    size_t length = strlen(word);
    for (const char *at = text; (at = strstr(at, word)); at++)
        if (strchr(" \t\r\n<:", at[-1]) && (at[length] == '=' || at[length] == '>' || at[length] == ' '))
            return true;
    return false;
}

static bool probe(const char *head, size_t size) {
    const char *text = head + (size >= 3 && !memcmp(head, "\xef\xbb\xbf", 3) ? 3 : 0);
    if (text[strspn(text, " \t\r\n")] != '<')
        return false;
    const char *root = find_root(text);
    if (!root)
        return false;
    if (is_gpx(root))
        return true;
    bool lat = has_name(root + 1, "lat") || has_name(root + 1, "latitude");
    bool lon = has_name(root + 1, "lon") || has_name(root + 1, "lng") || has_name(root + 1, "longitude");
    return lat && lon && has_name(root + 1, "end");
}

static noc_status read_tracks(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                              const char **format) {
    char head[8192];
    size_t size = 0, got = 1;
    noc_status status = NOC_OK;
    for (; !status && got && size < sizeof(head) - 1; size += got)
        status = noc_stream_read(stream, head + size, sizeof(head) - 1 - size, &got);
    head[size] = 0;
    const char *root = status ? NULL : find_root(head);
    track_xml x = { .stream = stream, .gpx = root && is_gpx(root) };
    *format = x.gpx ? "GPX" : "track points in XML";
    if (!status)
        status = noc_stream_rewind(stream);
    if (!status)
        status = sink->crs(sink->ctx, TRACK_WGS84, noc_stream_name(stream), &(bool){ false });
    track_writer_start(&x.w, sink, stream);
    x.w.geographic = true;
    status = status ? status : parse(&x);
    if (!status) {
        track_end(&x.w);
        status = x.w.status;
    }
    track_writer_free(&x.w);
    return status;
}

const noc_reader noc_reader_tracks = {
    .name = "GPX, track points in XML", .reads = NOC_READS_TRACKS, .probe = probe, .read = read_tracks
};
