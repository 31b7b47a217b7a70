/* A reader of a small line-based format made for tests of the importer's sink, and runs of the importer with it.
 *
 *     FAKE [city|lamps|mesh]
 *     crs [name]
 *     object kind id lod      end
 *     polygon class x y z x y z ...
 *     many class x y count      a strip of so many triangles, eastwards
 *     lamp x y [z] [#id]     #7#8 is called #8, too
 *     fail | slow
 *     hold bytes             until the file ends
 */
#ifndef NOC_TEST_FAKE_READER_H
#define NOC_TEST_FAKE_READER_H

#include "import/load/load.h"
#include "../test.h"

#include <math.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>

#define assert_close(a, b, tolerance)                                                                                  \
    do {                                                                                                               \
        double a_ = (a), b_ = (b);                                                                                     \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                                           \
            fail_msg("%s is %.12g, not %.12g", #a, a_, b_);                                                            \
    } while (0)

/* ---- the fake reader ---- */

static atomic_int reads; /* files that were read, not only probed */

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
        return sink->polygon(sink->ctx,
                             &(geo_polygon){
                                 .cls = (noc_class)cls, .id = "poly", .ring_count = 1, .ring_size = &n, .xyz = v });
    }
    if (sscanf(line, "many %d %lf %lf %d", &cls, &v[0], &v[1], &lod) == 4) {
        noc_status status = NOC_OK;
        for (int i = 0; i < lod && !status; i++) {
            size_t n = 3;
            double x = v[0] + i * .5, xyz[9] = { x, v[1], 370, x + .5, v[1], 370, x, v[1] + 1, 370 };
            status =
                sink->polygon(sink->ctx,
                              &(geo_polygon){
                                  .cls = (noc_class)cls, .id = "many", .ring_count = 1, .ring_size = &n, .xyz = xyz });
        }
        return status;
    }
    if (!strncmp(line, "lamp ", 5)) {
        size_t n = numbers(line + 5, v, 3);
        geo_lamp lamp = { .xyz = { v[*swap], v[!*swap], n > 2 ? v[2] : NAN },
                          .height = NAN,
                          .direction = NAN,
                          .lumens = NAN,
                          .watts = NAN,
                          .kelvin = NAN,
                          .rgb = { -1, -1, -1 },
                          .id = strchr(line, '#') ? strchr(line, '#') : "",
                          .ref = strrchr(line, '#') };
        return sink->lamp(sink->ctx, &lamp);
    }
    if (!strcmp(line, "fail"))
        return noc_error(sink->log, NOC_ERR_FORMAT, "%s:1: made to fail", file);
    if (!strcmp(line, "slow"))
        return sink->progress(sink->ctx, 0.5) ? NOC_OK : NOC_ERR_CANCELLED;
    return NOC_OK;
}

static atomic_int holding, most_holding; /* files that hold memory at once */

static bool hold(noc_stream *stream, double bytes) {
    bool fits = import_fits(noc_stream_budget(stream), bytes);
    int now = atomic_fetch_add(&holding, 1) + 1, most = atomic_load(&most_holding);
    while (now > most && !atomic_compare_exchange_weak(&most_holding, &most, now))
        ;
    usleep(30000); /* so that others may come */
    return fits;
}

static noc_status fake_read(noc_stream *stream, const noc_import_params *params, geo_sink *sink, const char **format) {
    (void)params;
    static _Thread_local char text[100000]; /* files may be read at once */
    size_t size = 0, got;
    do {
        assert_int_equal(noc_stream_read(stream, text + size, sizeof(text) - 1 - size, &got), NOC_OK);
        size += got;
    } while (got);
    text[size] = 0;
    reads++;
    *format = "fake";
    bool swap = false, held = false;
    noc_status status = NOC_OK;
    for (char *line = text, *end; *line && !status; line = end + 1) {
        end = strchr(line, '\n');
        *end = 0;
        double bytes;
        if (sscanf(line, "hold %lf", &bytes) == 1 && !held) {
            held = true;
            assert_true(hold(stream, bytes));
        }
        status = fake_line(sink, line, &swap, noc_stream_name(stream));
    }
    if (held)
        atomic_fetch_sub(&holding, 1);
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
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = xyz,
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = noc_scene_add_material(scene, &shining) };
    reads++;
    *format = "fake mesh";
    return noc_scene_add_mesh(scene, &mesh) >= 0 ? NOC_OK : NOC_ERR_FORMAT;
}

static const noc_reader city_reader = {
    .name = "fake city", .reads = NOC_READS_CITY, .probe = probe_city, .read = fake_read
};
static const noc_reader lamp_reader = {
    .name = "fake lamps", .reads = NOC_READS_LAMPS, .probe = probe_lamps, .read = fake_read
};
static const noc_reader mesh_reader = {
    .name = "fake mesh", .reads = NOC_READS_MESH, .probe = probe_mesh, .read_mesh = fake_mesh
};
static const noc_reader missing_reader = { .name = "fake absent",
                                           .probe = probe_missing,
                                           .missing = "this build lacks it" };
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
    char last_warning[1000];
};

static void on_message(void *user, noc_log_level level, const char *text) {
    struct run *r = user;
    r->errors += level == NOC_LOG_ERROR;
    r->warnings += level == NOC_LOG_WARN;
    if (level == NOC_LOG_WARN)
        snprintf(r->last_warning, sizeof(r->last_warning), "%s", text);
}

static inline void start(struct run *r) {
    *r = (struct run){ 0 };
    r->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message, .user = r });
    r->scene = noc_scene_create(r->log);
}

static inline void load_with(struct run *r, noc_import_params params, bool inspect, size_t count,
                             const char *const *paths) {
    reads = 0;
    r->status = load_inputs(r->scene, fakes, paths, count, &params, inspect, &r->report);
    noc_scene_get_info(r->scene, &r->info);
    /* an error is reported once, or not at all where there is none; cancelling is none */
    assert_int_equal(r->errors, r->status && r->status != NOC_ERR_CANCELLED ? 1 : 0);
}

static inline void finish(struct run *r) {
    noc_scene_destroy(r->scene);
    noc_report_destroy(r->report);
    noc_log_destroy(r->log);
}

#define PATHS(...)                                                                                                     \
    sizeof((const char *[]){ __VA_ARGS__ }) / sizeof(char *), (const char *[]) { __VA_ARGS__ }
#define LOAD(r, params, ...) (start(r), load_with(r, params, false, PATHS(__VA_ARGS__)))
/* Windows have tests of their own. */
static inline noc_import_params without_windows(void) {
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    return p;
}
#define DEFAULTS without_windows()

static inline bool has_line(const noc_report_file *f, const char *reason, size_t count) {
    for (size_t i = 0; i < f->line_count; i++)
        if (!strcmp(f->lines[i].reason, reason))
            return f->lines[i].count == count;
    return false;
}

/* A house of 10 m in Ingolstadt (UTM 32): a wall, a roof, a floor, a closure surface. */
#define HOUSE_AT(id, x0, x1, y0, y1)                                                                                   \
    "object 0 " id " 2\n"                                                                                              \
    "polygon 1 " x0 " " y0 " 370 " x1 " " y0 " 370 " x1 " " y0 " 380 " x0 " " y0 " 380\n"                              \
    "polygon 2 " x0 " " y0 " 380 " x1 " " y0 " 380 " x1 " " y1 " 380 " x0 " " y1 " 380\n"                              \
    "polygon 3 " x0 " " y0 " 370 " x0 " " y1 " 370 " x1 " " y1 " 370 " x1 " " y0 " 370\n"                              \
    "polygon 4 " x0 " " y0 " 370 " x0 " " y1 " 370 " x0 " " y1 " 380 " x0 " " y0 " 380\n"                              \
    "end\n"
#define HOUSE HOUSE_AT("house", "678000.5", "678010.5", "5404000.5", "5404010.5")
#define CITY "FAKE city\ncrs EPSG:25832\n" HOUSE
/* the same corner as longitude and latitude: lies within 20 m of the house */
#define NEAR_LAMP "FAKE lamps\ncrs OGC:CRS84\nlamp 11.42278 48.76231\n"

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

#endif
