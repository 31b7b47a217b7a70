/* Overpass JSON: nodes with lat and lon, ways and relations with a center or a geometry. */
#include "import/map/overpass.h"
#include "import/map/osm_ways.h"

#include <math.h>

static bool probe(const char *head, size_t size) {
    const char *p = head;
    if (size >= 3 && !memcmp(p, "\xef\xbb\xbf", 3))
        p += 3;
    while (*p == ' ' || *p == '\n' || *p == '\r' || *p == '\t')
        p++;
    return *p == '{' && strstr(p, "\"elements\"") && !strstr(p, "\"FeatureCollection\"") &&
           (strstr(p, "\"osm3s\"") || strstr(p, "\"generator\"") || strstr(p, "\"node\"") || strstr(p, "\"way\"") ||
            strstr(p, "\"relation\""));
}

bool overpass_number(const json_t *object, const char *key, double *out) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_number(value))
        return false;
    *out = json_number_value(value);
    return true;
}

/* The place of an element: its own, its center, or the middle of its geometry's box. */
static bool place_of(const json_t *element, double *lon, double *lat) {
    if (overpass_number(element, "lon", lon) && overpass_number(element, "lat", lat))
        return true;
    const json_t *center = json_object_get(element, "center");
    if (center && overpass_number(center, "lon", lon) && overpass_number(center, "lat", lat))
        return true;
    double w, s, e, n;
    const json_t *box = json_object_get(element, "bounds");
    if (box && overpass_number(box, "minlon", &w) && overpass_number(box, "minlat", &s) &&
        overpass_number(box, "maxlon", &e) && overpass_number(box, "maxlat", &n)) {
        *lon = (w + e) / 2;
        *lat = (s + n) / 2;
        return true;
    }
    return false;
}

/* Does any element say that it is a lamp? Where none does, in a file that is named as lamps, every node is one. */
static bool any_lamp(json_t *elements) {
    size_t count = json_array_size(elements);
    for (size_t i = 0; i < count; i++) {
        const char *key;
        json_t *value;
        json_object_foreach(json_object_get(json_array_get(elements, i), "tags"), key,
                            value) if (json_is_string(value) &&
                                       lamp_verdict_of(NULL, &(lamp_tag){ key, json_string_value(value) }, 1, false) !=
                                           LAMP_NONE) return true;
    }
    return false;
}

bool overpass_is(const json_t *element, const char *type) {
    const char *is = json_string_value(json_object_get(element, "type"));
    return is && !strcmp(is, type);
}

static bool is_node(const json_t *element) { return overpass_is(element, "node"); }

static void count_way(const json_t *element, geo_features *features) {
    osm_way way = OSM_NEITHER;
    const char *key;
    json_t *value;
    json_object_foreach(json_object_get(element, "tags"), key, value) if (json_is_string(value)) {
        osm_way one = osm_way_of(key, json_string_value(value));
        way = NOC_MAX(way, one);
    }
    osm_count_way(features, way);
}

bool overpass_collect(json_t *element, overpass_tags *list) {
    list->tags.len = 0;
    const char *type = json_string_value(json_object_get(element, "type")), *key;
    json_t *id = json_object_get(element, "id"), *value;
    snprintf(list->id, sizeof(list->id), "%.16s/%" JSON_INTEGER_FORMAT, type ? type : "element",
             json_integer_value(id));
    bool kept = array_push(&list->tags, (lamp_tag){ "@id", list->id });
    json_object_foreach(json_object_get(element, "tags"), key, value) if (json_is_string(value)) kept =
        kept && array_push(&list->tags, (lamp_tag){ key, json_string_value(value) });
    return kept;
}

static noc_status emit(json_t *elements, lamp_writer *w) {
    overpass_tags list = { 0 };
    noc_status status = NOC_OK;
    size_t count = json_array_size(elements);
    for (size_t i = 0; i < count && !status; i++) {
        json_t *element = json_array_get(elements, i);
        if (is_node(element))
            w->seen.total[GEO_POINTS]++;
        else
            count_way(element, &w->seen);
        if (w->inventory ? !is_node(element) : !json_object_size(json_object_get(element, "tags")))
            continue;
        double xyz[3] = { NAN, NAN, NAN };
        if (!place_of(element, &xyz[0], &xyz[1]))
            xyz[0] = xyz[1] = NAN;
        status = !overpass_collect(element, &list) ? noc_no_memory(w->sink->log, w->place)
                                                   : lamp_writer_point(w, list.tags.data, list.tags.len, list.id, xyz);
        if (!status && i % 1024 == 0 && w->sink->progress &&
            !w->sink->progress(w->sink->ctx, (double)i / (double)count))
            status = NOC_ERR_CANCELLED;
    }
    array_free(&list.tags);
    return status;
}

typedef struct source {
    noc_stream *stream;
    noc_status status; /* of the stream: already reported */
    double cost;       /* of what was parsed so far, in bytes */
    noc_log *log;
} source;

static size_t pull(void *buffer, size_t size, void *user) {
    source *s = user;
    size_t got = 0;
    s->status = noc_stream_read(s->stream, buffer, size, &got);
    s->cost += import_json_cost(buffer, got);
    if (!s->status)
        s->status =
            import_affords(noc_stream_budget(s->stream), s->cost, noc_stream_name(s->stream), "its JSON", s->log);
    return s->status ? (size_t)-1 : got;
}

static noc_status read_overpass(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                                const char **format) {
    *format = "Overpass JSON";
    lamp_writer w;
    noc_status status = lamp_writer_start(&w, sink, noc_stream_name(stream), params);
    if (status)
        return status;
    w.geographic = true;
    source from = { .stream = stream, .log = sink->log };
    json_error_t error;
    json_t *root = import_json_load(pull, &from, 0, &error);
    if (!root) {
        lamp_writer_free(&w);
        return from.status ? from.status : import_json_error(&error, noc_stream_name(stream), sink->log);
    }
    json_t *elements = json_object_get(root, "elements"), *remark = json_object_get(root, "remark");
    if (!json_is_array(elements)) {
        status = noc_error(sink->log, NOC_ERR_FORMAT, "%s: \"elements\" is not a list", w.place);
    } else {
        /* the server says here that it ran out of time or memory, and sent what it had */
        if (json_is_string(remark)) {
            noc_warn(sink->log, "%s: incomplete answer: %s", w.place, json_string_value(remark));
            geo_issue(sink->issues, GEO_SKIPPED, "incomplete answer of the server", "remark");
        }
        status = lamp_writer_crs(&w, LAMP_WGS84);
        w.inventory = sink->named_lamps && !any_lamp(elements);
        if (!status)
            status = emit(elements, &w);
        if (!status)
            status = overpass_shapes(elements, &w);
        if (!status)
            status = lamp_writer_end(&w);
    }
    json_decref(root);
    lamp_writer_free(&w);
    return status;
}

const noc_reader noc_reader_overpass = {
    .name = "Overpass JSON", .reads = NOC_READS_LAMPS, .probe = probe, .read = read_overpass
};
