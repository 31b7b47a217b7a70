/* The index of tiles: a GeoJSON, which is read again, and a GeoPackage of the same for programs that know maps. */
#include "base/output.h"
#include "import/import.h"
#include "import/load/load.h"

#include <math.h>
#include <nocturne/text.h>
#include <nocturne/tiles.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#define NAME "index.geojson"
#define HEAD "{\"type\": \"FeatureCollection\", \"name\": \"nocturne-tiles\""

/* ---- writing ---- */

/* UTF-8. */
static void put_text(FILE *out, const char *text) {
    json_t *string = json_string_nocheck(text);
    if (!string || json_dumpf(string, out, JSON_ENCODE_ANY))
        fputs("\"\"", out);
    json_decref(string);
}

static void put_entry(FILE *out, const noc_tile_entry *t) {
    static const int corner[5][2] = { { 0, 1 }, { 2, 1 }, { 2, 3 }, { 0, 3 }, { 0, 1 } };
    const double *e = t->info.extent;
    fputs("{\"type\": \"Feature\", \"properties\": {\"location\": ", out);
    put_text(out, t->location);
    fprintf(out,
            ", \"buildings\": %llu, \"windows\": %llu, \"lamps\": %llu, \"triangles\": %llu, \"bytes\": %llu}, "
            "\"geometry\": {\"type\": \"Polygon\", \"coordinates\": [[",
            t->info.buildings, t->info.windows, t->info.lamps, t->info.triangles, t->bytes);
    for (int i = 0; i < 5; i++)
        fprintf(out, "%s[%.17g, %.17g]", i ? ", " : "", e[corner[i][0]], e[corner[i][1]]);
    fputs("]]}}", out);
}

/* As programs know it that read a "crs" in a GeoJSON: "EPSG:25832" as a URN. */
static void put_crs(FILE *out, const char *crs) {
    const char *colon = strchr(crs, ':');
    bool code = colon && colon > crs && !strchr(colon + 1, ':') && strspn(colon + 1, "0123456789") == strlen(colon + 1);
    char urn[80];
    noc_snprintf(urn, sizeof(urn), "urn:ogc:def:crs:%.*s::%s", code ? (int)(colon - crs) : 0, crs,
                 code ? colon + 1 : "");
    fputs(",\n\"crs\": {\"type\": \"name\", \"properties\": {\"name\": ", out);
    put_text(out, code ? urn : crs);
    fputs("}}", out);
}

static noc_status write_geojson(const char *path, const char *crs, const noc_tile_entry *entries, size_t count,
                                noc_log *log) {
    output o;
    noc_status status = output_open(&o, path, log);
    if (status)
        return status;
    fputs(HEAD, o.file);
    if (crs)
        put_crs(o.file, crs);
    fputs(",\n\"features\": [", o.file);
    for (size_t i = 0; i < count; i++) {
        fputs(i ? ",\n" : "\n", o.file);
        put_entry(o.file, &entries[i]);
    }
    fputs("\n]}\n", o.file);
    return output_close(&o, ferror(o.file) ? output_failed(&o, log) : NOC_OK, log);
}

noc_status noc_tiles_write(const char *folder, const char *crs, const noc_tile_entry *entries, size_t count,
                           noc_log *log) {
    if (!folder || (count && !entries))
        return noc_null(log, __func__);
    for (size_t i = 0; i < count; i++)
        for (const char *c = entries[i].location; *c; c += noc_text_utf8(c))
            if (!noc_text_utf8(c))
                return noc_error(log, NOC_ERR_ARGUMENT, "%s/%s: cannot name %s, which is no UTF-8: rename that tile",
                                 folder, NAME, entries[i].location);
    char *path = noc_format("%s/%s", folder, NAME), *package = noc_format("%s/index.gpkg", folder);
    noc_status status = path && package ? write_geojson(path, crs, entries, count, log) : noc_no_memory(log, folder);
    if (!status)
        status = map_write_package(path, package, log);
    free(path);
    free(package);
    return status;
}

/* ---- reading ---- */

static bool is_index(const char *path) {
    char head[sizeof(HEAD)] = "";
    struct stat st;
    FILE *in = !stat(path, &st) && S_ISREG(st.st_mode) ? fopen(path, "rb") : NULL;
    size_t n = in ? fread(head, 1, sizeof(HEAD) - 1, in) : 0;
    if (in)
        fclose(in);
    return n == sizeof(HEAD) - 1 && !memcmp(head, HEAD, n);
}

/* The path of the index that it stands for; NULL: none, or no memory. free() it. */
static char *find_index(const char *path) {
    struct stat st;
    size_t n = strlen(path);
    bool package = n >= 5 && !strcmp(path + n - 5, ".gpkg");
    char *index = NULL;
    if (stat(path, &st))
        return NULL;
    if (S_ISDIR(st.st_mode))
        index = noc_format("%s%s%s", path, n && path[n - 1] == '/' ? "" : "/", NAME);
    else
        index = package ? noc_format("%.*s.geojson", (int)n - 5, path) : noc_strdup(path);
    if (index && is_index(index))
        return index;
    free(index);
    return NULL;
}

bool noc_tiles_is(const char *path) {
    char *index = path ? find_index(path) : NULL;
    free(index);
    return index != NULL;
}

static size_t pull(void *buffer, size_t size, void *user) {
    size_t n = fread(buffer, 1, size, user);
    return n || !ferror((FILE *)user) ? n : (size_t)-1;
}

/* The box in the index's CRS: of so many points on its rim. */
static noc_status box_to(const load_box *box, const char *crs, noc_log *log, double lo[2], double hi[2]) {
    enum { STEPS = 16 };
    double rim[4 * STEPS * 3] = { 0 };
    noc_status status = NOC_OK;
    for (int i = 0; i < 4 * STEPS; i++) {
        double t = (double)(i % STEPS) / STEPS, u = i / STEPS == 0   ? t
                                                    : i / STEPS == 1 ? 1
                                                    : i / STEPS == 2 ? 1 - t
                                                                     : 0;
        double v = i / STEPS == 0 ? 0 : i / STEPS == 1 ? t : i / STEPS == 2 ? 1 : 1 - t;
        rim[3 * i] = box->lo[0] + u * (box->hi[0] - box->lo[0]);
        rim[3 * i + 1] = box->lo[1] + v * (box->hi[1] - box->lo[1]);
    }
    if (box->crs && !crs)
        return noc_error(log, NOC_ERR_ARGUMENT, "bbox: the tiles have no CRS, so the box cannot have one");
    geo_crs *to = box->crs ? geo_crs_create_plain(crs, NAME, log, &status) : NULL;
    geo_transform *t = to ? geo_transform_create(box->crs, to, log, &status) : NULL;
    if (t)
        geo_transform_points(t, rim, 4 * STEPS);
    geo_transform_destroy(t);
    geo_crs_destroy(to);
    for (int k = 0; k < 2; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (int i = 0; i < 4 * STEPS; i++) {
            lo[k] = fmin(lo[k], rim[3 * i + k]);
            hi[k] = fmax(hi[k], rim[3 * i + k]);
        }
    }
    return status;
}

typedef struct finding {
    const char *index;
    noc_log *log;
    double lo[2], hi[2];
    NOC_ARRAY(char *) paths;
    size_t bytes;
} finding;

static noc_status wrong(const finding *f, size_t i) {
    return noc_error(f->log, NOC_ERR_FORMAT, "%s: feature %zu is no tile: it needs a rectangle and a location below it",
                     f->index, i + 1);
}

/* Locations stay below the index's folder. */
static bool stays_below(const char *location) {
    if (!location || !*location || *location == '/')
        return false;
    for (const char *at = location; at; at = strchr(at, '/'), at = at ? at + 1 : NULL)
        if (!strncmp(at, "..", 2) && (at[2] == '/' || !at[2]))
            return false;
    return true;
}

static noc_status take_feature(finding *f, size_t i, json_t *feature) {
    const char *location = json_string_value(json_object_get(json_object_get(feature, "properties"), "location"));
    json_t *ring = json_array_get(json_object_get(json_object_get(feature, "geometry"), "coordinates"), 0);
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (size_t k = 0; k < json_array_size(ring); k++)
        for (size_t axis = 0; axis < 2; axis++) {
            double x = json_number_value(json_array_get(json_array_get(ring, k), axis));
            lo[axis] = fmin(lo[axis], x);
            hi[axis] = fmax(hi[axis], x);
        }
    if (!stays_below(location) || !(lo[0] <= hi[0]))
        return wrong(f, i);
    if (lo[0] > f->hi[0] || hi[0] < f->lo[0] || lo[1] > f->hi[1] || hi[1] < f->lo[1])
        return NOC_OK;
    const char *slash = strrchr(f->index, '/');
    char *path = noc_format("%.*s%s", slash ? (int)(slash + 1 - f->index) : 0, f->index, location);
    f->bytes += path ? strlen(path) + 1 : 0;
    if (path && array_push(&f->paths, path))
        return NOC_OK;
    free(path);
    return noc_no_memory(f->log, f->index);
}

/* "EPSG:25832" of a URN. */
static void crs_of(json_t *root, char *out, size_t size) {
    static const char urn[] = "urn:ogc:def:crs:";
    const char *name =
        json_string_value(json_object_get(json_object_get(json_object_get(root, "crs"), "properties"), "name"));
    const char *at = name && !strncmp(name, urn, strlen(urn)) ? name + strlen(urn) : NULL,
               *code = at ? strstr(at, "::") : NULL;
    if (code)
        noc_snprintf(out, size, "%.*s:%s", (int)(code - at), at, code + 2);
    else
        noc_snprintf(out, size, "%s", name ? name : "");
}

static noc_status take_all(finding *f, json_t *root, const char *bbox) {
    const noc_import_params params = { .bbox = bbox };
    load_box box;
    char crs[2000];
    crs_of(root, crs, sizeof(crs));
    noc_status status = box_read(&params, f->log, &box);
    for (int k = 0; k < 2; k++) {
        f->lo[k] = -INFINITY;
        f->hi[k] = INFINITY;
    }
    if (!status && box.on)
        status = box_to(&box, *crs ? crs : NULL, f->log, f->lo, f->hi);
    json_t *features = json_object_get(root, "features");
    for (size_t i = 0; i < json_array_size(features) && !status; i++)
        status = take_feature(f, i, json_array_get(features, i));
    if (!status && !f->paths.len)
        status = noc_error(f->log, NOC_ERR_ARGUMENT, "%s: none of its %zu tiles %s%.200s", f->index,
                           json_array_size(features), box.on ? "meets the bbox " : "is there", box.on ? bbox : "");
    box_free(&box);
    return status;
}

/* One block: a list and its texts. */
static noc_status hand_over(const finding *f, char ***paths, size_t *count) {
    size_t list = (f->paths.len + 1) * sizeof(char *);
    char **out = noc_calloc(1, list + f->bytes), *text = (char *)out + list;
    if (!out)
        return noc_no_memory(f->log, f->index);
    for (size_t i = 0; i < f->paths.len; i++) {
        size_t n = strlen(f->paths.data[i]) + 1;
        out[i] = memcpy(text, f->paths.data[i], n);
        text += n;
    }
    *paths = out;
    *count = f->paths.len;
    return NOC_OK;
}

noc_status noc_tiles_find(const char *index, const char *bbox, noc_log *log, char ***paths, size_t *count) {
    if (!index || !paths || !count)
        return noc_null(log, __func__);
    *paths = NULL;
    *count = 0;
    char *found = find_index(index);
    FILE *in = found ? fopen(found, "rb") : NULL;
    if (!in) {
        free(found);
        return noc_error(log, NOC_ERR_FORMAT, "%s: is no index of tiles, as nocturne build --each writes them", index);
    }
    json_error_t error;
    finding f = { .index = found, .log = log };
    json_t *root = import_json_load(pull, in, 0, &error);
    noc_status status = root ? take_all(&f, root, bbox) : import_json_error(&error, found, log);
    status = status ? status : hand_over(&f, paths, count);
    json_decref(root);
    fclose(in);
    for (size_t i = 0; i < f.paths.len; i++)
        free(f.paths.data[i]);
    array_free(&f.paths);
    free(found);
    return status;
}
