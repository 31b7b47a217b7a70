/* document.c: the CityJSON reader, and what holds for all objects of a value: CRS, transform, vertices, templates. */
#include "import/cityjson/cityjson.h"

#include <math.h>

/* ---- probe ---- */

static bool probe(const char *head, size_t size) {
    const char *p = head + (size >= 3 && !memcmp(head, "\xef\xbb\xbf", 3) ? 3 : 0);
    p += strspn(p, " \t\r\n\x1e");
    return *p == '{' && (strstr(p, "\"CityJSON\"") || strstr(p, "\"CityJSONFeature\"") || strstr(p, "\"CityObjects\""));
}

/* ---- parts of a value ---- */

const char *cj_text(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static void no_memory(cj_reading *r) { cg_no_memory(r->parser); }

/* A number of a list; NaN for what is none. */
static double item(const json_t *list, size_t i) {
    const json_t *value = json_array_get(list, i);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static bool read_three(cj_reading *r, const json_t *transform, const char *key, double out[3]) {
    const json_t *list = json_object_get(transform, key);
    for (size_t i = 0; i < 3; i++)
        out[i] = item(list, i);
    if (json_array_size(list) == 3 && isfinite(out[0] + out[1] + out[2]))
        return true;
    cg_fail(r->parser, NOC_ERR_FORMAT, "\"transform\".\"%s\" is not a list of three numbers", key);
    return false;
}

/* Of a head; each feature is transformed as the last head says. */
static void read_transform(cj_reading *r, const json_t *root) {
    const json_t *transform = json_object_get(root, "transform");
    r->transformed = transform != NULL;
    for (int i = 0; i < 3; i++) {
        r->scale[i] = 1;
        r->translate[i] = 0;
    }
    if (transform && read_three(r, transform, "scale", r->scale))
        read_three(r, transform, "translate", r->translate);
}

/* Points out of a list that is let go: it takes ten times as much. */
static void read_points(cj_reading *r, json_t *in, const char *key, const double *scale, const double *translate,
                        cj_points *out) {
    const json_t *list = json_object_get(in, key);
    *out = (cj_points){ 0 };
    if (!json_is_array(list)) {
        cg_fail(r->parser, NOC_ERR_FORMAT, "\"%s\" is %s", key, list ? "not a list" : "missing");
        return;
    }
    size_t count = json_array_size(list);
    if (!(out->xyz = noc_calloc(count + 1, 3 * sizeof(double)))) {
        no_memory(r);
        return;
    }
    out->count = count;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++)
            out->xyz[3 * i + k] = item(json_array_get(list, i), k) * scale[k] + translate[k];
    json_object_del(in, key);
}

static void free_points(cj_points *points) {
    free(points->xyz);
    *points = (cj_points){ 0 };
}

static void read_templates(cj_reading *r, json_t *root) {
    static const double one[3] = { 1, 1, 1 }, zero[3] = { 0 };
    json_t *all = json_object_get(root, "geometry-templates");
    free_points(&r->template_vertices);
    json_decref(r->templates);
    r->templates = NULL;
    if (!all)
        return;
    read_points(r, all, "vertices-templates", one, zero, &r->template_vertices);
    r->templates = json_incref(json_object_get(all, "templates"));
    if (!r->parser->status && !json_is_array(r->templates))
        cg_fail(r->parser, NOC_ERR_FORMAT, "\"geometry-templates\".\"templates\" is %s",
                r->templates ? "not a list" : "missing");
}

static void read_crs(cj_reading *r, const json_t *root) {
    const char *name = cj_text(json_object_get(root, "metadata"), "referenceSystem");
    r->srs = *name ? cg_srs(r->parser, name, r->parser->place) : CG_NONE;
}

static void tell_format(const cj_reading *r) {
    static const char *const names[][2] = { { "CityJSON", "CityJSONSeq" },
                                            { "CityJSON 1.0", "CityJSONSeq 1.0" },
                                            { "CityJSON 1.1", "CityJSONSeq 1.1" },
                                            { "CityJSON 2.0", "CityJSONSeq 2.0" } };
    *r->parser->format = names[r->version][r->sequence];
}

static void read_version(cj_reading *r, const json_t *root) {
    static const char *const known[] = { "1.0", "1.1", "2.0" };
    const char *version = cj_text(root, "version");
    r->version = 0;
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        if (!strncmp(version, known[i], 3))
            r->version = (int)i + 1;
    tell_format(r);
    if (*version && strncmp(version, "1.", 2) && strncmp(version, "2.", 2))
        cg_fail(r->parser, NOC_ERR_UNSUPPORTED, "CityJSON %.20s; versions 1.0, 1.1 and 2.0 are read", version);
}

/* ---- values ---- */

static void read_head(cj_reading *r, json_t *root) {
    r->sequence |= r->seen_head;
    read_version(r, root);
    if (!r->parser->status)
        read_transform(r, root);
    if (!r->parser->status)
        read_templates(r, root);
    if (!r->parser->status)
        read_crs(r, root);
    if (!r->parser->status)
        cj_looks_read(r, root, &r->head_looks);
    r->seen_head = true;
}

static void read_objects(cj_reading *r, json_t *root) {
    json_t *objects = json_object_get(root, "CityObjects");
    if (!json_is_object(objects)) {
        cg_fail(r->parser, NOC_ERR_FORMAT, "\"CityObjects\" is %s", objects ? "not an object" : "missing");
        return;
    }
    if (json_object_size(objects) && !r->transformed && r->version != 1) {
        cg_fail(r->parser, NOC_ERR_FORMAT,
                "\"transform\" is missing, without which vertices of CityJSON from 1.1 on have no place");
        return;
    }
    for (size_t i = json_object_size(objects); i < r->values.objects; i++)
        geo_issue(r->parser->sink->issues, GEO_SKIPPED, "object whose id is given twice, of which the last is taken",
                  "");
    read_points(r, root, "vertices", r->scale, r->translate, &r->vertices);
    if (!r->parser->status)
        cj_objects(r, objects);
    free_points(&r->vertices);
}

static void read_value(cj_reading *r, json_t *root) {
    const char *type = cj_text(root, "type");
    bool feature = !strcmp(type, "CityJSONFeature");
    if (!feature && strcmp(type, "CityJSON")) {
        cg_fail(r->parser, NOC_ERR_FORMAT, "\"type\" is \"%.40s\", not \"CityJSON\"%s", type,
                r->seen_head ? " or \"CityJSONFeature\"" : "");
        return;
    }
    if (feature && !r->seen_head) {
        cg_fail(r->parser, NOC_ERR_FORMAT, "a CityJSONFeature before the CityJSON that says where it is");
        return;
    }
    if (feature && !r->sequence) {
        r->sequence = true;
        tell_format(r);
    }
    if (feature)
        cj_looks_read(r, root, &r->own_looks);
    else
        read_head(r, root);
    if (!r->parser->status)
        read_objects(r, root);
}

static noc_status read_all(cj_reading *r) {
    json_t *root;
    while (!r->parser->status && (root = cj_values_next(&r->values))) {
        const char *name = noc_stream_name(r->values.stream);
        if (r->seen_head)
            noc_snprintf(r->place, sizeof(r->place), "%s:%lu", name, r->values.first_line);
        r->parser->place = r->seen_head ? r->place : name;
        read_value(r, root);
        json_decref(root);
    }
    if (!r->parser->status)
        r->parser->status = r->values.status;
    if (!r->parser->status && !r->seen_head)
        cg_fail(r->parser, NOC_ERR_FORMAT, "no CityJSON in this file");
    return r->parser->status ? r->parser->status : cg_parser_end(r->parser);
}

static noc_status read_cityjson(noc_stream *stream, const noc_import_params *params, geo_sink *sink,
                                const char **format) {
    *format = "CityJSON";
    cj_reading r = { .values = { .stream = stream, .sink = sink }, .srs = CG_NONE };
    if (!(r.parser = cg_parser_create(stream, params, sink, format)))
        return NOC_ERR_MEMORY;
    noc_status status = read_all(&r);
    json_decref(r.templates);
    free_points(&r.template_vertices);
    cj_looks_free(&r.head_looks);
    cj_looks_free(&r.own_looks);
    map_free(&r.known_looks);
    cj_values_free(&r.values);
    cg_parser_destroy(r.parser);
    return status;
}

const noc_reader noc_reader_cityjson = {
    .name = "CityJSON", .reads = NOC_READS_CITY, .probe = probe, .read = read_cityjson
};
