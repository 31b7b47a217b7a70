/* Polygons for regions: GeoJSON (RFC 7946, and the "crs" of what came before it) and WKT, from a file or a text. */
#include "import/import.h"

#include <nocturne/influence.h>

#include <ctype.h>
#include <math.h>

enum { DEEPEST = 16, LARGEST = 64 << 20 }; /* bytes of a file */

typedef struct reading {
    noc_log *log;
    const char *name; /* for messages */
    NOC_ARRAY(double) xy;
    NOC_ARRAY(size_t) size;
    char crs[NOC_RINGS_CRS];
} reading;

static noc_status fault(const reading *r, const char *what) {
    return noc_error(r->log, NOC_ERR_FORMAT, "%.400s: %s", r->name, what);
}

static noc_status add_point(reading *r, double x, double y) {
    if (!isfinite(x) || !isfinite(y))
        return fault(r, "a coordinate is not finite");
    return array_push(&r->xy, x) && array_push(&r->xy, y) ? NOC_OK : noc_no_memory(r->log, r->name);
}

/* Of the points since so many; a last one that is the first again is none. */
static noc_status end_ring(reading *r, size_t from) {
    size_t n = (r->xy.len - from) / 2;
    const double *a = r->xy.data + from;
    if (n > 1 && a[0] == a[2 * n - 2] && a[1] == a[2 * n - 1]) {
        n--;
        r->xy.len -= 2;
    }
    if (n < 3)
        return fault(r, "a ring has less than three places");
    return array_push(&r->size, n) ? NOC_OK : noc_no_memory(r->log, r->name);
}

/* ---- GeoJSON ---- */

static noc_status json_rings(reading *r, const json_t *rings) {
    noc_status status = json_is_array(rings) ? NOC_OK : fault(r, "coordinates of a polygon are no list");
    for (size_t i = 0; i < json_array_size(rings) && !status; i++) {
        const json_t *ring = json_array_get(rings, i);
        size_t from = r->xy.len;
        for (size_t k = 0; k < json_array_size(ring) && !status; k++) {
            const json_t *p = json_array_get(ring, k), *x = json_array_get(p, 0), *y = json_array_get(p, 1);
            bool numbers = json_is_number(x) && json_is_number(y);
            status = numbers ? add_point(r, json_number_value(x), json_number_value(y))
                             : fault(r, "a place is not two numbers");
        }
        status = status ? status : end_ring(r, from);
    }
    return status;
}

static noc_status json_geometry(reading *r, const json_t *v, int depth) {
    static const char *const lists[] = { "features", "geometries" };
    const char *type = json_string_value(json_object_get(v, "type"));
    noc_status status = NOC_OK;
    if (depth > DEEPEST)
        return fault(r, "it is nested too deeply");
    if (type && !strcmp(type, "Polygon"))
        return json_rings(r, json_object_get(v, "coordinates"));
    const json_t *parts = json_object_get(v, "coordinates");
    for (size_t i = 0; type && !strcmp(type, "MultiPolygon") && i < json_array_size(parts) && !status; i++)
        status = json_rings(r, json_array_get(parts, i));
    for (size_t l = 0; l < NOC_COUNT(lists); l++) {
        parts = json_object_get(v, lists[l]);
        for (size_t i = 0; i < json_array_size(parts) && !status; i++)
            status = json_geometry(r, json_array_get(parts, i), depth + 1);
    }
    v = json_object_get(v, "geometry");
    return status || !v ? status : json_geometry(r, v, depth + 1);
}

typedef struct text_left {
    const char *text;
    size_t left;
} text_left;

static size_t pull(void *buffer, size_t size, void *user) {
    text_left *t = user;
    size_t n = NOC_MIN(size, t->left);
    memcpy(buffer, t->text, n);
    t->text += n;
    t->left -= n;
    return n;
}

static noc_status read_json(reading *r, const char *text, size_t size) {
    text_left left = { text, size };
    json_error_t error;
    json_t *root = import_json_load(pull, &left, 0, &error);
    if (!root)
        return import_json_error(&error, r->name, r->log);
    const json_t *crs = json_object_get(json_object_get(json_object_get(root, "crs"), "properties"), "name");
    noc_snprintf(r->crs, sizeof(r->crs), "%s", json_string_value(crs) ? json_string_value(crs) : "");
    noc_status status = json_geometry(r, root, 0);
    bool degrees = !*r->crs && r->xy.len;
    for (size_t i = 0; i < r->xy.len; i++)
        degrees = degrees && fabs(r->xy.data[i]) <= (i % 2 ? 90 : 180);
    if (degrees) /* as RFC 7946 has it; what cannot be degrees is in the scene's CRS */
        noc_snprintf(r->crs, sizeof(r->crs), "OGC:CRS84");
    json_decref(root);
    return status;
}

/* ---- WKT ---- */

static const char *skip(const char *p) {
    while (isspace((unsigned char)*p))
        p++;
    return p;
}

/* (x y [z], x y, ...) */
static noc_status wkt_ring(reading *r, const char **at) {
    const char *p = *at + 1, *end = p + strcspn(p, ",()");
    size_t from = r->xy.len;
    for (;; p = end + 1, end = p + strcspn(p, ",()")) {
        double x, y;
        const char *next = noc_scan_double(p, end, &x);
        noc_status status = next && noc_scan_double(next, end, &y) ? add_point(r, x, y) /* what follows is a height */
                                                                   : fault(r, "a place is not two numbers");
        if (status)
            return status;
        if (*end != ',')
            break;
    }
    if (*end != ')')
        return fault(r, "a ring does not end");
    *at = end + 1;
    return end_ring(r, from);
}

/* Rings lie in parentheses of their own, however deep. */
static noc_status read_wkt(reading *r, const char *text) {
    static const char *const words[] = { "POLYGON", "MULTIPOLYGON" };
    const char *p = skip(text), *open = strchr(p, '(');
    char word[16];
    bool known = false;
    noc_snprintf(word, sizeof(word), "%.*s", open ? (int)NOC_MIN(open - p, 15) : 15, p);
    for (size_t n = strlen(word); n && (isspace((unsigned char)word[n - 1]) || word[n - 1] == 'Z'); n--)
        word[n - 1] = 0;
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        known = known || noc_ieq(word, words[i]);
    if (!known || !open)
        return fault(r, "it is neither GeoJSON nor a POLYGON or MULTIPOLYGON of WKT");
    int depth = 0;
    noc_status status = NOC_OK;
    for (p = open; *p && !status;) {
        const char *next = skip(p + 1);
        if (*p == '(' && *next != '(') {
            status = wkt_ring(r, &p);
            continue;
        }
        depth += *p == '(' ? 1 : *p == ')' ? -1 : 0;
        if (depth < 0 || depth > 3 || !(strchr("(),", *p) || isspace((unsigned char)*p)))
            return fault(r, "its parentheses do not match");
        p++;
    }
    return status ? status : depth ? fault(r, "its parentheses do not match") : NOC_OK;
}

/* ---- both ---- */

static noc_status end(reading *r, noc_status status, noc_rings *out) {
    if (!status && !r->size.len)
        status = fault(r, "it holds no polygon");
    if (!status) {
        *out = (noc_rings){ r->size.len, r->size.data, r->xy.data, { 0 } };
        memcpy(out->crs, r->crs, sizeof(out->crs));
        return NOC_OK;
    }
    array_free(&r->xy);
    array_free(&r->size);
    return status;
}

noc_status noc_rings_parse(const char *wkt, noc_rings *out, noc_log *log) {
    if (!wkt || !out)
        return noc_null(log, __func__);
    reading r = { .log = log, .name = "polygon" };
    *out = (noc_rings){ 0 };
    return end(&r, read_wkt(&r, wkt), out);
}

noc_status noc_rings_read(const char *path, noc_rings *out, noc_log *log) {
    if (!path || !out)
        return noc_null(log, __func__);
    *out = (noc_rings){ 0 };
    noc_status status;
    char *text = NULL;
    size_t size = 0;
    noc_stream *stream = noc_stream_open(path, log, &status);
    if (!stream)
        return status;
    reading r = { .log = log, .name = path };
    status = noc_stream_size(stream) > LARGEST ? fault(&r, "it is larger than 64 MiB")
                                               : noc_stream_read_all(stream, log, &text, &size);
    noc_stream_close(stream);
    if (!status)
        status = *skip(text) == '{' ? read_json(&r, text, size) : read_wkt(&r, text);
    free(text);
    return end(&r, status, out);
}

void noc_rings_free(noc_rings *rings) {
    if (!rings)
        return;
    free(rings->size);
    free(rings->xy);
    *rings = (noc_rings){ 0 };
}
