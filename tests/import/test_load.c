/* The importer's sink, fed by a reader of a small line-based format made for these tests, and on real files.
 *
 *     FAKE [city|lamps|mesh]
 *     crs [name]
 *     object kind id lod      end
 *     polygon class x y z x y z ...
 *     lamp x y [z]
 *     fail | slow
 */
#include "import/load.h"
#include "../test.h"

#include <math.h>
#include <sys/stat.h>

#define assert_close(a, b, tolerance)                                                                                  \
    do {                                                                                                               \
        double a_ = (a), b_ = (b);                                                                                     \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                                           \
            fail_msg("%s is %.12g, not %.12g", #a, a_, b_);                                                            \
    } while (0)

/* ---- the fake reader ---- */

static int reads; /* files that were read, not only probed */

static bool is_fake(const char *head, size_t size, const char *kind) {
    char want[16];
    snprintf(want, sizeof(want), "FAKE %s\n", kind);
    return size >= strlen(want) && !memcmp(head, want, strlen(want));
}
static bool probe_city(const char *head, size_t size) { return is_fake(head, size, "city"); }
static bool probe_lamps(const char *head, size_t size) { return is_fake(head, size, "lamps"); }
static bool probe_mesh(const char *head, size_t size) { return is_fake(head, size, "mesh"); }
static bool probe_missing(const char *head, size_t size) { return is_fake(head, size, "missing"); }

static size_t numbers(const char *text, double *out, size_t max) {
    size_t n = 0;
    for (char *end; n < max; text = end, n++) {
        out[n] = strtod(text, &end);
        if (end == text)
            break;
    }
    return n;
}

static noc_status fake_line(geo_sink *sink, char *line, bool *swap, const char *file) {
    double v[600];
    int cls, kind, lod, used;
    char text[200];
    if (!strncmp(line, "crs", 3)) {
        char *name = line + 3 + (line[3] == ' ');
        return sink->crs(sink->ctx, *name ? name : NULL, file, swap);
    }
    if (sscanf(line, "object %d %199s %d", &kind, text, &lod) == 3)
        return sink->begin_object(sink->ctx, &(geo_object){ .kind = (geo_kind)kind, .id = text, .lod = lod });
    if (!strcmp(line, "end"))
        return sink->end_object(sink->ctx);
    if (sscanf(line, "polygon %d %n", &cls, &used) == 1) {
        size_t n = numbers(line + used, v, 600) / 3;
        for (size_t i = 0; *swap && i < n; i++) {
            double x = v[3 * i];
            v[3 * i] = v[3 * i + 1], v[3 * i + 1] = x;
        }
        return sink->polygon(sink->ctx, &(geo_polygon){ .cls = (noc_class)cls, .id = "poly", .ring_count = 1,
                                                        .ring_size = &n, .xyz = v });
    }
    if (!strncmp(line, "lamp ", 5)) {
        size_t n = numbers(line + 5, v, 3);
        geo_lamp lamp = { .xyz = { v[*swap], v[!*swap], n > 2 ? v[2] : NAN }, .height = NAN, .direction = NAN, .lumens = NAN,
                          .watts = NAN, .kelvin = NAN, .rgb = { -1, -1, -1 }, .id = "lamp" };
        return sink->lamp(sink->ctx, &lamp);
    }
    if (!strcmp(line, "fail"))
        return noc_error(sink->log, NOC_ERR_FORMAT, "%s:1: made to fail", file);
    if (!strcmp(line, "slow"))
        return sink->progress(sink->ctx, 0.5) ? NOC_OK : NOC_ERR_CANCELLED;
    return NOC_OK;
}

static noc_status fake_read(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    (void)params;
    static char text[20000];
    size_t size = 0, got;
    do {
        assert_int_equal(noc_stream_read(stream, text + size, sizeof(text) - 1 - size, &got), NOC_OK);
        size += got;
    } while (got);
    text[size] = 0;
    reads++;
    *format = "fake";
    bool swap = false;
    noc_status status = NOC_OK;
    for (char *line = text, *end; *line && !status; line = end + 1) {
        end = strchr(line, '\n');
        *end = 0;
        status = fake_line(sink, line, &swap, noc_stream_name(stream));
    }
    return status;
}

static double mesh_x, mesh_y; /* where the fake mesh lies */

static noc_status fake_mesh(const char *path, noc_stream *stream, const noc_import_params *params, noc_scene *scene,
                            const mesh_place *place, geo_issues *issues, const char **format) {
    (void)path, (void)stream, (void)params, (void)issues;
    noc_material shining = noc_class_material(NOC_CLASS_OTHER);
    shining.emission[0] = 1;
    double xyz[] = { mesh_x, mesh_y, 0, mesh_x + 5, mesh_y, 0, mesh_x, mesh_y + 5, 0 };
    noc_status status = place->points(place->ctx, xyz, 3);
    if (status)
        return status;
    noc_mesh mesh = { .vertex_count = 3, .positions = xyz, .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 }, .material = noc_scene_add_material(scene, &shining) };
    reads++;
    *format = "fake mesh";
    return noc_scene_add_mesh(scene, &mesh) >= 0 ? NOC_OK : NOC_ERR_FORMAT;
}

static const noc_reader city_reader = { .name = "fake city", .reads = NOC_READS_CITY, .probe = probe_city, .read = fake_read };
static const noc_reader lamp_reader = { .name = "fake lamps", .reads = NOC_READS_LAMPS, .probe = probe_lamps, .read = fake_read };
static const noc_reader mesh_reader = { .name = "fake mesh", .reads = NOC_READS_MESH, .probe = probe_mesh, .read_mesh = fake_mesh };
static const noc_reader missing_reader = { .name = "fake absent", .probe = probe_missing, .missing = "this build lacks it" };
static const noc_reader *const fakes[] = { &city_reader, &lamp_reader, &mesh_reader, &missing_reader, NULL };

/* ---- helpers ---- */

static char folder[] = "/tmp/nocturne-load-XXXXXX";

static const char *file(const char *name, const char *text) {
    static char paths[8][256];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, 256, "%s/%s", folder, name);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
    return path;
}

struct run {
    noc_log *log;
    noc_scene *scene;
    noc_report *report;
    noc_status status;
    noc_scene_info info;
    int errors, warnings;
    char last_warning[500];
};

static void on_message(void *user, noc_log_level level, const char *text) {
    struct run *r = user;
    r->errors += level == NOC_LOG_ERROR;
    r->warnings += level == NOC_LOG_WARN;
    if (level == NOC_LOG_WARN)
        snprintf(r->last_warning, sizeof(r->last_warning), "%s", text);
}

static void start(struct run *r) {
    *r = (struct run){ 0 };
    r->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message, .user = r });
    r->scene = noc_scene_create(r->log);
}

static void load_with(struct run *r, noc_import_params params, bool inspect, size_t count, const char *const *paths) {
    reads = 0;
    r->status = load_inputs(r->scene, fakes, paths, count, &params, inspect, &r->report);
    noc_scene_get_info(r->scene, &r->info);
    /* an error is reported once, or not at all where there is none; cancelling is none */
    assert_int_equal(r->errors, r->status && r->status != NOC_ERR_CANCELLED ? 1 : 0);
}

static void finish(struct run *r) {
    noc_scene_destroy(r->scene);
    noc_report_destroy(r->report);
    noc_log_destroy(r->log);
}

#define PATHS(...) sizeof((const char *[]){ __VA_ARGS__ }) / sizeof(char *), (const char *[]){ __VA_ARGS__ }
#define LOAD(r, params, ...) (start(r), load_with(r, params, false, PATHS(__VA_ARGS__)))
#define DEFAULTS noc_import_default_params()

static noc_import_params with_crs(const char *crs, const char *scene_crs) {
    noc_import_params p = DEFAULTS;
    p.crs = crs;
    p.scene_crs = scene_crs;
    return p;
}

static bool has_line(const noc_report_file *f, const char *reason, size_t count) {
    for (size_t i = 0; i < f->line_count; i++)
        if (!strcmp(f->lines[i].reason, reason))
            return f->lines[i].count == count;
    return false;
}

/* A house of 10 m in Ingolstadt (UTM 32): a wall, a roof, a floor, a closure surface. */
#define HOUSE_AT(id, x0, x1, y0, y1)                                                                                   \
    "object 0 " id " 2\n"                                                                                              \
    "polygon 1 " x0 " " y0 " 370 " x1 " " y0 " 370 " x1 " " y0 " 380 " x0 " " y0 " 380\n"                               \
    "polygon 2 " x0 " " y0 " 380 " x1 " " y0 " 380 " x1 " " y1 " 380 " x0 " " y1 " 380\n"                               \
    "polygon 3 " x0 " " y0 " 370 " x0 " " y1 " 370 " x1 " " y1 " 370 " x1 " " y0 " 370\n"                               \
    "polygon 4 " x0 " " y0 " 370 " x0 " " y1 " 370 " x0 " " y1 " 380 " x0 " " y0 " 380\n"                               \
    "end\n"
#define HOUSE HOUSE_AT("house", "678000.5", "678010.5", "5404000.5", "5404010.5")
#define CITY "FAKE city\ncrs EPSG:25832\n" HOUSE
/* the same corner as longitude and latitude: lies within 20 m of the house */
#define NEAR_LAMP "FAKE lamps\ncrs OGC:CRS84\nlamp 11.42278 48.76231\n"

/* ---- tests ---- */

static void test_city(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("a.city", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25832 (ETRS89 / UTM zone 32N)");
    /* crs = local + origin, heights as they are */
    assert_true(r.info.origin[0] == rint(r.info.origin[0]) && r.info.origin[2] == 0);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(noc_report_file_count(r.report), 1);
    assert_null(noc_report_get_file(r.report, 1));
    assert_int_equal(f->objects, 1);
    assert_int_equal(f->buildings, 1);
    assert_int_equal(f->lod_used[2], 1);
    assert_int_equal(f->polygons, 4);
    assert_int_equal(f->polygons_by_class[NOC_CLASS_CLOSURE], 1);
    assert_int_equal(f->triangles, 6); /* the closure surface is not rendered */
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_CLOSURE], 0);
    assert_string_equal(f->format, "fake");
    assert_string_equal(f->crs_given, "EPSG:25832");
    assert_close(f->extent_min[0], 678000.5, 1e-6);
    assert_close(f->extent_max[1], 5404010.5, 1e-6);
    assert_close(f->extent_max[2], 380, 0);
    assert_int_equal(f->bytes, strlen(CITY));
    /* a mesh an object and class, named by the object */
    size_t named = 0;
    for (size_t i = 0; i < r.scene->meshes.len; i++)
        named += r.scene->meshes.data[i].name && !strcmp(r.scene->meshes.data[i].name, "house");
    assert_int_equal(named, 3);
    /* the corner is where it was */
    double lo[3] = { INFINITY, INFINITY, INFINITY };
    for (size_t i = 0; i < r.scene->meshes.len; i++) {
        const noc_scene_mesh *m = &r.scene->meshes.data[i];
        for (size_t k = 3 * (size_t)m->first_triangle; m->name && k < 3 * (size_t)(m->first_triangle + m->triangle_count); k++)
            for (int c = 0; !strcmp(m->name, "house") && c < 3; c++)
                lo[c] = NOC_MIN(lo[c], (double)r.scene->positions.data[3 * (size_t)r.scene->indices.data[k] + (size_t)c]);
    }
    assert_close(lo[0] + r.info.origin[0], 678000.5, 1e-4);
    assert_close(lo[1] + r.info.origin[1], 5404000.5, 1e-4);
    assert_close(lo[2], 370, 1e-4);
    finish(&r);
}

/* Geographic input: the scene gets the UTM zone of its place; tuples are latitude first, and the house stays 10 m. */
static void test_geographic(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("tokyo", "FAKE city\ncrs http://www.opengis.net/def/crs/EPSG/0/6697\nobject 0 b 1\n"
                                     "polygon 2 35.6812 139.7671 9 35.6812 139.7672 9 35.6813 139.7672 9 35.6813 139.7671 9\nend\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:32654 (WGS 84 / UTM zone 54N)");
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_string_equal(f->crs, "EPSG:6668 (JGD2011)");
    assert_close(f->extent_min[0], 139.7671, 1e-9);
    assert_close(f->extent_min[1], 35.6812, 1e-9);
    /* 1e-4 degrees: 9.05 m by 11.1 m there, the diagonal 14.3 m */
    float lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    const noc_scene_mesh *m = &r.scene->meshes.data[0];
    for (size_t k = 3 * (size_t)m->first_triangle; k < 3 * (size_t)(m->first_triangle + m->triangle_count); k++)
        for (int c = 0; c < 2; c++) {
            float x = r.scene->positions.data[3 * (size_t)r.scene->indices.data[k] + (size_t)c];
            lo[c] = NOC_MIN(lo[c], x), hi[c] = NOC_MAX(hi[c], x);
        }
    assert_close(hypot((double)(hi[0] - lo[0]), (double)(hi[1] - lo[1])), 14.4, 0.4);
    finish(&r);
}

static void test_axes(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *text, *reason;
        double x, y; /* of the first corner, as understood */
    } cases[] = {
        /* northing first, against practice, in a CRS that has it so by the book; and in one that has not */
        { "crs EPSG:31468\npolygon 2 5400000 4458000 0 5400000 4458009 0 5400009 4458009 0\n", "axes exchanged to fit the CRS", 4458000, 5400000 },
        { "crs EPSG:25832\npolygon 2 5404000 678000 0 5404000 678009 0 5404009 678009 0\n", "axes exchanged to fit the CRS", 678000, 5404000 },
        { "crs EPSG:5514\npolygon 2 -1043000 -743100 0 -1043000 -743000 0 -1042900 -743000 0\n", "axes exchanged to fit the CRS", -743100, -1043000 },
        /* easting first, as practically always */
        { "crs EPSG:31468\npolygon 2 4458000 5400000 0 4458009 5400000 0 4458009 5400009 0\n", NULL, 4458000, 5400000 },
        { "crs EPSG:31256\npolygon 2 3000 341000 0 3009 341000 0 3009 341009 0\n", NULL, 3000, 341000 },
        /* longitude first under a name that has latitude first: only this order has such a place */
        { "crs EPSG:4258\npolygon 2 11.4 48.7 0 11.4001 48.7 0 11.4001 48.7001 0\n", "axes exchanged to fit the CRS", 11.4, 48.7 },
        { "crs urn:ogc:def:crs:EPSG::4326\npolygon 2 150.1 -33.7 0 150.1001 -33.7 0 150.1001 -33.7001 0\n", "axes exchanged to fit the CRS", 150.1, -33.7 },
        { "crs EPSG:4326\npolygon 2 48.7 11.4 0 48.7 11.4001 0 48.7001 11.4001 0\n", NULL, 11.4, 48.7 },
        { "crs urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH\npolygon 2 32678000 5404000 0 32678009 5404000 0 32678009 5404009 0\n",
          "zone number taken off the easting", 678000, 5404000 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char text[400];
        snprintf(text, sizeof(text), "FAKE city\n%s", cases[i].text);
        LOAD(&r, DEFAULTS, file("axes", text));
        assert_int_equal(r.status, NOC_OK);
        const noc_report_file *f = noc_report_get_file(r.report, 0);
        assert_close(f->extent_min[0], cases[i].x, 1e-6);
        assert_close(f->extent_min[1], NOC_MIN(cases[i].y, f->extent_max[1]), 1e-3);
        assert_int_equal(f->line_count, cases[i].reason ? 1 : 0);
        if (cases[i].reason)
            assert_true(has_line(f, cases[i].reason, 1));
        finish(&r);
    }
    /* no order of axes helps: said once, and taken as it is */
    LOAD(&r, DEFAULTS, file("a", "FAKE city\ncrs EPSG:31466\npolygon 2 1 1 0 3 1 0 3 4 0\npolygon 2 1 1 9 3 1 9 3 4 9\nlamp 2 2\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "is it the right CRS?"));
    finish(&r);
    /* the decision is one of a file: a second file in the same CRS decides for itself */
    LOAD(&r, DEFAULTS, file("a", "FAKE city\ncrs EPSG:25832\npolygon 2 5404000 678000 0 5404000 678009 0 5404009 678009 0\n"),
         file("b", "FAKE city\ncrs EPSG:25832\npolygon 2 678000 5404000 0 678009 5404000 0 678009 5404009 0\n"));
    assert_true(has_line(noc_report_get_file(r.report, 0), "axes exchanged to fit the CRS", 1));
    assert_int_equal(noc_report_get_file(r.report, 1)->line_count, 0);
    assert_close(r.info.bounds_max[0] - r.info.bounds_min[0], 9 + 120, 1e-3); /* and the ground's margin */
    finish(&r);
}

static void test_scene_crs(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, with_crs(NULL, "EPSG:25833"), file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25833 (ETRS89 / UTM zone 33N)");
    /* any CRS to local, and the scene's own */
    double p[3] = { 678000.5, 5404000.5, 370 }, q[3] = { 1, 2, 3 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:25832", p), NOC_OK);
    assert_close(p[0], r.info.bounds_min[0], 500); /* zone 33 is turned a little; in the ground plane's margin or so */
    assert_close(p[2], 370, 0);
    assert_int_equal(noc_scene_to_local(r.scene, NULL, q), NOC_OK);
    assert_close(q[0], 1 - r.info.origin[0], 0);
    assert_close(q[2], 3, 0);
    assert_int_equal(noc_scene_to_local(r.scene, "nonsense", q), NOC_ERR_ARGUMENT);
    double nowhere[3] = { NAN, 0, 0 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:4326", nowhere), NOC_ERR_ARGUMENT);
    finish(&r);
    /* a scene's CRS is projected, in metres; and must be readable */
    LOAD(&r, with_crs(NULL, "EPSG:4326"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "EPSG:2263"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "what"), file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    /* set on the scene before: kept, with its origin */
    start(&r);
    noc_scene_set_crs(r.scene, "EPSG:25832", (double[]){ 678000, 5404000, 300 });
    load_with(&r, DEFAULTS, false, PATHS(file("a", CITY)));
    assert_int_equal(r.status, NOC_OK);
    assert_close(r.info.origin[2], 300, 0);
    double corner[3] = { 678000.5, 5404000.5, 370 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:25832", corner), NOC_OK);
    assert_close(corner[0], 0.5, 1e-6);
    assert_close(corner[2], 70, 1e-6);
    finish(&r);
}

static void test_missing_crs(void **state) {
    (void)state;
    struct run r;
    const char *local = file("local.city", "FAKE city\ncrs\n" HOUSE), *lamps = file("near.lamps", NEAR_LAMP);
    /* alone, it is local metres */
    LOAD(&r, DEFAULTS, local);
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "");
    double p[3] = { 11.4, 48.7, 0 };
    assert_int_equal(noc_scene_to_local(r.scene, "EPSG:4326", p), NOC_ERR_ARGUMENT);
    finish(&r);
    /* with one that names a CRS, in either order, it is an error that names the file and the option */
    LOAD(&r, DEFAULTS, local, lamps);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "local.city names no CRS"));
    assert_non_null(strstr(noc_log_last_error(r.log), "--crs"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", CITY), local);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "local.city names no CRS"));
    finish(&r);
    LOAD(&r, with_crs("EPSG:25832", NULL), local, lamps);
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25832 (ETRS89 / UTM zone 32N)");
    assert_int_equal(noc_report_get_file(r.report, 1)->lamps, 1);
    assert_true(r.info.lights >= 1);
    finish(&r);
    /* a name that is not understood: --crs says what to take; without it that is an error */
    const char *odd = file("odd", "FAKE city\ncrs Local Grid 7\n" HOUSE);
    LOAD(&r, with_crs("EPSG:25832", NULL), odd);
    assert_int_equal(r.status, NOC_OK);
    assert_true(r.warnings > 0);
    finish(&r);
    LOAD(&r, DEFAULTS, odd);
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "--crs"));
    finish(&r);
    LOAD(&r, with_crs("nonsense", NULL), local);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
    LOAD(&r, with_crs(NULL, "EPSG:25832"), local);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

static void test_lamps(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("far.lamps", NEAR_LAMP "lamp 12.5 48.8\nlamp 999 999\n"), file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    /* the report follows the inputs' order, though the city is read first */
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_true(has_line(f, "lamp more than 2 km outside the city", 1));
    assert_true(has_line(f, "coordinates that have no place in the scene's CRS", 1));
    assert_int_equal(f->lamps, 2);
    assert_int_equal(f->lights, r.info.lights);
    assert_int_equal(r.info.lights_inferred, 0);
    assert_int_equal(r.warnings, 0);
    finish(&r);
    /* all of them elsewhere: that is said, with the distance */
    noc_import_params p = DEFAULTS;
    p.infer_lamps = false;
    LOAD(&r, p, file("a", CITY), file("berlin", "FAKE lamps\ncrs EPSG:4326\nlamp 52.5 13.4\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 0);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "all 1 lamps lie outside"));
    finish(&r);
    /* a piece of street and lamps around it: there is a ground under them, and it does not cover the street */
    LOAD(&r, DEFAULTS, file("a", "FAKE city\ncrs EPSG:25832\nobject 2 r -1\npolygon 9 678000 5404000 370 678030 5404000 370 "
                                 "678030 5404020 370 678000 5404020 370\nend\n"),
         file("l", "FAKE lamps\ncrs EPSG:25832\nlamp 678015 5404010\nlamp 678100 5404080\nlamp 677900 5404010\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 3);
    for (size_t i = 0; i < 3; i++) {
        double height;
        assert_true(noc_scene_ground(r.scene, r.scene->lights.data[i].p[0], r.scene->lights.data[i].p[1], &height));
        assert_close(height + r.scene->origin[2], i ? 370 - .02 : 370, 1e-3);
        assert_close(r.scene->lights.data[i].p[2] - height, 6, .03);
    }
    finish(&r);
    /* lamps alone make a scene too: nothing they could be outside of */
    LOAD(&r, DEFAULTS, file("l", "FAKE lamps\ncrs EPSG:4326\nlamp 52.5 13.4\nlamp 52.6 13.4\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:32633 (WGS 84 / UTM zone 33N)");
    assert_true(r.info.lights >= 2);
    double ground, z; /* they light a ground, and all stand on it */
    for (size_t i = 0; i < r.info.lights; i++) {
        const float *at = r.scene->lights.data[i].p;
        assert_true(noc_scene_ground(r.scene, at[0], at[1], &z));
        ground = i ? ground : z;
        assert_close(z, ground, 1e-3);
        assert_close(at[2] - z, 6, 1e-3);
    }
    finish(&r);
}

static void test_inferred_lamps(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_true(r.info.lights > 0);
    assert_int_equal(r.info.lights_inferred, r.info.lights);
    assert_non_null(strstr(r.last_warning, "inferred"));
    finish(&r);
    noc_import_params p = DEFAULTS;
    p.infer_lamps = false;
    LOAD(&r, p, file("a", CITY));
    assert_int_equal(r.info.lights, 0);
    assert_int_equal(r.warnings, 1); /* a dark scene is said to be one */
    assert_non_null(strstr(r.last_warning, "nothing in the scene shines"));
    finish(&r);
    /* terrain alone is no place for lamps; that, and nothing at all, is worth a word */
    LOAD(&r, DEFAULTS, file("a", "FAKE city\ncrs EPSG:25832\npolygon 8 677900 5403900 370 678100 5403900 370 678000 5404200 370\n"));
    assert_int_equal(r.info.lights, 0);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "nothing in the scene shines"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", "FAKE city\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "nothing that can be seen"));
    finish(&r);
    /* what shines already, and what is no city, gets none */
    LOAD(&r, DEFAULTS, file("m", "FAKE mesh\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights_inferred, 0);
    assert_int_equal(r.info.lights, 1);
    assert_int_equal(r.info.triangles, 1); /* no ground either */
    assert_int_equal(noc_report_get_file(r.report, 0)->lights, 1);
    finish(&r);
}

/* A mesh names no CRS: with --crs it is in it, in doubles; without, it counts from the origin, wherever in the list it is. */
static void test_mesh_place(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = with_crs("EPSG:25832", NULL);
    const char *city = file("a", CITY "object 2 r -1\npolygon 9 678090 5403590 0 678120 5403590 0 678120 5403620 0\nend\n");
    const char *mesh = file("m", "FAKE mesh\n");
    p.infer_lamps = false;
    p.infer_lamps = false;
    mesh_x = 678100;
    mesh_y = 5403580;
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    const noc_scene_mesh *m = r.scene->meshes.data; /* the one that shines */
    while (!(r.scene->materials.data[m->material].emission[0] > 0))
        m++;
    const float *v = &r.scene->positions.data[3 * (size_t)r.scene->indices.data[3 * (size_t)m->first_triangle]];
    assert_float_equal(v[0] + r.scene->origin[0], 678100, 1e-3);
    assert_float_equal(v[1] + r.scene->origin[1], 5403580, 1e-3);
    assert_string_equal(noc_report_get_file(r.report, 0)->crs, noc_report_get_file(r.report, 1)->crs);
    assert_float_equal(noc_report_get_file(r.report, 0)->extent_max[0], 678105, 0);
    finish(&r);
    p.crs = NULL; /* map coordinates, but nobody says so */
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "from the rest of the scene"));
    finish(&r);
    LOAD(&r, p, mesh); /* alone: local metres, near a local origin */
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_float_equal(r.scene->origin[0], 678103, 1);
    assert_float_equal(r.info.bounds_max[0] + r.scene->origin[0], 678105, 1e-3);
    finish(&r);
    mesh_x = mesh_y = 0;
    LOAD(&r, p, mesh, file("l", "FAKE lamps\ncrs EPSG:25832\nlamp 678100 5403580 5\n")); /* lamps settle the place just so */
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 0);
    assert_float_equal(r.scene->origin[0], 678100, 0);
    finish(&r);
    p.crs = "EPSG:4326"; /* degrees are no metres */
    LOAD(&r, p, mesh, city);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

/* Houses without terrain stand on ground that is laid for them; with terrain they do not. */
static void test_ground(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = DEFAULTS;
    p.infer_lamps = false;
    LOAD(&r, p, file("a", CITY));
    assert_true(r.info.triangles_by_class[NOC_CLASS_TERRAIN] > 0);
    finish(&r);
    LOAD(&r, p, file("a", CITY "object 1 dem -1\npolygon 8 677900 5403900 370 678100 5403900 370 678000 5404200 370\nend\n"));
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_TERRAIN], 1);
    finish(&r);
    LOAD(&r, p, file("a", CITY "object 2 r -1\npolygon 9 677990 5403990 370 678020 5403990 370 678020 5404020 370 677990 5404020 370\nend\n"));
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_TERRAIN], 0);
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_ROAD], 2);
    finish(&r);
}

static void test_materials_vary(void **state) {
    (void)state;
    struct run r;
    char text[20000] = "FAKE city\ncrs EPSG:25832\n";
    for (int i = 0; i < 60; i++) {
        char object[300];
        snprintf(object, sizeof(object), "object 0 DEBY_%d 2\npolygon 1 %d 5404000 0 %d 5404000 0 %d 5404000 9\nend\n", 4000 + i,
                 678000 + 20 * i, 678010 + 20 * i, 678010 + 20 * i);
        strcat(text, object);
    }
    LOAD(&r, DEFAULTS, file("a", text));
    bool used[1000] = { false };
    size_t walls = 0;
    for (size_t i = 0; i < r.scene->meshes.len; i++) {
        int m = r.scene->meshes.data[i].material;
        if (r.scene->materials.data[m].cls == NOC_CLASS_WALL && !used[m]) {
            used[m] = true;
            walls++;
        }
    }
    assert_in_range(walls, PALETTE - 2, PALETTE);
    /* the same id has the same colour in every run */
    struct run again;
    LOAD(&again, DEFAULTS, file("a", text));
    for (size_t i = 0; i < 60; i++)
        assert_memory_equal(r.scene->materials.data[r.scene->meshes.data[i].material].albedo,
                            again.scene->materials.data[again.scene->meshes.data[i].material].albedo, sizeof(float[3]));
    finish(&r);
    finish(&again);
}

static void test_errors(void **state) {
    (void)state;
    struct run r;
    char absent[300];
    snprintf(absent, sizeof(absent), "%s/absent", folder);
    /* all inputs are opened before any is read */
    LOAD(&r, DEFAULTS, file("a", CITY), absent);
    assert_int_equal(r.status, NOC_ERR_IO);
    assert_int_equal(reads, 0);
    assert_int_equal(noc_report_file_count(r.report), 0);
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", CITY), file("x", "what is this\n"));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(reads, 0);
    assert_non_null(strstr(noc_log_last_error(r.log), "fake city, fake lamps"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("empty", ""));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    finish(&r);
    LOAD(&r, DEFAULTS, file("m", "FAKE missing\n"));
    assert_int_equal(r.status, NOC_ERR_UNSUPPORTED);
    assert_non_null(strstr(noc_log_last_error(r.log), "this build lacks it"));
    finish(&r);
    LOAD(&r, DEFAULTS, folder);
    assert_int_not_equal(r.status, NOC_OK);
    finish(&r);
    /* a reader's error ends it; the report holds what came before */
    LOAD(&r, DEFAULTS, file("f", CITY "fail\n"));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(noc_report_get_file(r.report, 0)->polygons, 4);
    assert_false(r.scene->committed);
    finish(&r);
    noc_import_params bad[] = { DEFAULTS, DEFAULTS, DEFAULTS, DEFAULTS };
    bad[0].lod = 5, bad[1].lamp_height = 0, bad[2].lamp_lumens = NAN, bad[3].lamp_kelvin = 10;
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        LOAD(&r, bad[i], file("a", CITY));
        assert_int_equal(r.status, NOC_ERR_ARGUMENT);
        finish(&r);
    }
    start(&r);
    load_with(&r, DEFAULTS, false, 0, NULL);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

static void test_bad_features(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("a", CITY "object 0 bad 1\npolygon 1 678000 5404000 0 678001 5404000 0\n"
                                      "polygon 1 nan nan nan nan nan nan nan nan nan\n"
                                      "polygon 1 1e9 1e30 0 1e9 1e31 0 1e30 1e30 0\n"
                                      "polygon 99 678000 5404000 0 678009 5404000 0 678009 5404009 0\nend\n"));
    assert_int_equal(r.status, NOC_OK);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(f->polygons, 5);
    assert_int_equal(f->polygons_by_class[NOC_CLASS_OTHER], 1);
    assert_true(has_line(f, "ring with too few points", 1));
    assert_true(has_line(f, "coordinates that are not finite", 1));
    assert_int_equal(f->line_count, 3);
    assert_string_equal(f->lines[0].examples, "poly");
    finish(&r);
}

struct watch {
    double last;
    int calls;
    int stop_at;
};

static bool on_progress(void *user, const char *what, double done) {
    struct watch *w = user;
    assert_non_null(what);
    assert_true(done >= w->last && done <= 1);
    w->last = done;
    return ++w->calls != w->stop_at;
}

static void test_progress(void **state) {
    (void)state;
    struct run r;
    struct watch watch = { 0 };
    noc_import_params p = DEFAULTS;
    p.progress = (noc_progress){ on_progress, &watch };
    LOAD(&r, p, file("a", CITY "slow\nslow\n"), file("b", CITY "slow\n"), file("l", NEAR_LAMP "slow\n"));
    assert_int_equal(r.status, NOC_OK);
    int calls = watch.calls;
    assert_true(calls >= 5);
    finish(&r);
    for (int stop = 1; stop <= calls; stop++) { /* wherever it is cancelled, it ends cleanly */
        watch = (struct watch){ .stop_at = stop };
        LOAD(&r, p, file("a", CITY "slow\nslow\n"), file("b", CITY "slow\n"), file("l", NEAR_LAMP "slow\n"));
        assert_int_equal(r.status, NOC_ERR_CANCELLED);
        assert_int_equal(watch.calls, stop);
        assert_false(r.scene->committed);
        finish(&r);
    }
}

static void test_inspect(void **state) {
    (void)state;
    struct run r;
    start(&r);
    load_with(&r, DEFAULTS, true, PATHS(file("l", "FAKE lamps\ncrs\nlamp 5 6 7\nlamp 8 9\n")));
    assert_int_equal(r.status, NOC_OK);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(f->lamps, 2);
    assert_int_equal(f->lights, 0);
    assert_string_equal(f->crs, "");
    assert_close(f->extent_max[1], 9, 0);
    finish(&r);
    /* a CRS that is not understood is no obstacle to looking */
    start(&r);
    load_with(&r, DEFAULTS, true, PATHS(file("o", "FAKE city\ncrs Local Grid 7\n" HOUSE)));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(noc_report_get_file(r.report, 0)->crs_given, "Local Grid 7");
    assert_string_equal(noc_report_get_file(r.report, 0)->crs, "");
    finish(&r);
}

/* Real files through the real table of readers. */
static void test_ingolstadt(void **state) {
    (void)state;
    REQUIRE_SHARED(found, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz");
    char city[4096];
    snprintf(city, sizeof(city), "%s", found);
    REQUIRE_SHARED(lamps, "data/lights/ingolstadt/ingolstadt_street_lamps.geojson");
    noc_scene *scene = noc_scene_create(NULL);
    noc_report *report;
    assert_int_equal(noc_scene_load(scene, (const char *[]){ city, lamps }, 2, NULL, &report), NOC_OK);
    const noc_report_file *f = noc_report_get_file(report, 0), *l = noc_report_get_file(report, 1);
    assert_int_equal(f->buildings, 54);
    assert_int_equal(l->lamps, 40); /* the data's own table says so, and that all lie within 99 m of the model */
    assert_true(l->lights >= 40);
    assert_in_range(f->polygons, 45000, 50696);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_int_equal(info.lights_inferred, 0);
    assert_true(info.bounds_max[2] < 440 && info.bounds_min[2] > 350);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

static void test_other_cities(void **state) {
    (void)state;
    static const struct {
        const char *path, *crs;
        size_t buildings;
    } cases[] = { { "data/cities/zurich/zurich-lod2-citygml1.gml", "EPSG:21781 (CH1903 / LV03)", 4 },
                  { "data/cities/helsinki/viikintiedepuisto.gml.gz", "EPSG:3879 (ETRS89 / GK25FIN)", 23 },
                  { "data/cities/plateau_osaka/51357309_bldg_6697_op.gml.gz", "EPSG:6668 (JGD2011)", 63 },
                  { "data/cities/nrw/LoD2_32_280_5659_1_NW.gml.gz", "EPSG:25832 (ETRS89 / UTM zone 32N)", 109 } };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        REQUIRE_SHARED(path, cases[i].path);
        noc_report *report;
        assert_int_equal(noc_inspect(NULL, path, NULL, &report), NOC_OK);
        const noc_report_file *f = noc_report_get_file(report, 0);
        assert_string_equal(f->crs, cases[i].crs);
        assert_int_equal(f->buildings, cases[i].buildings);
        noc_report_destroy(report);
    }
}

static int make_folder(void **state) {
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    char command[100];
    snprintf(command, sizeof(command), "rm -rf '%s'", folder);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_city),         cmocka_unit_test(test_geographic),      cmocka_unit_test(test_axes),
        cmocka_unit_test(test_scene_crs),    cmocka_unit_test(test_missing_crs),     cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_inferred_lamps), cmocka_unit_test(test_ground),        cmocka_unit_test(test_materials_vary),
        cmocka_unit_test(test_mesh_place),
        cmocka_unit_test(test_errors),       cmocka_unit_test(test_bad_features),    cmocka_unit_test(test_progress),
        cmocka_unit_test(test_inspect),      cmocka_unit_test(test_ingolstadt),      cmocka_unit_test(test_other_cities),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
