/* A sink that writes down what a city reader says, and documents made of pieces. */
#ifndef NOC_TEST_CITY_SINK_H
#define NOC_TEST_CITY_SINK_H

#include "import/import.h"
#include "test.h"

typedef struct seen_polygon {
    noc_class cls;
    char *id, *object;
    size_t points, rings;
    double *xyz; /* all rings */
    size_t crs;  /* how many CRSs had been told by then */
} seen_polygon;

typedef struct seen_object {
    geo_kind kind;
    char *id;
    int lod;
    size_t polygons;
    noc_building_use use;
} seen_object;

typedef struct city_sink {
    geo_sink sink;
    const noc_reader *reader; /* NULL: CityGML's */
    double max_memory;        /* GB; 0: the default */
    NOC_ARRAY(seen_polygon) polygons;
    NOC_ARRAY(seen_object) objects;
    NOC_ARRAY(geo_lamp) lamps;
    NOC_ARRAY(char *) crs; /* "(none)" for NULL */
    bool lat_first;        /* answer to crs */
    double metres;         /* that the file gives as its unit of heights; 0: none */
    bool in_object;
    size_t calls, stop_at;                 /* stops at that call with NOC_ERR_CANCELLED; 0: never */
    size_t asked, asked_amid, lamps_asked; /* for progress; with new lamps since then; lamps at the last time */
    bool stop_amid;                        /* progress stops it once there are lamps */
    noc_status status;
    const char *format;
} city_sink;

static noc_status city_count(city_sink *s) { return ++s->calls == s->stop_at ? NOC_ERR_CANCELLED : NOC_OK; }

static noc_status city_heights(void *ctx, double metres) {
    city_sink *s = ctx;
    assert_true(s->crs.len > 0 && metres > 0);
    s->metres = metres;
    return NOC_OK;
}

static noc_status city_crs(void *ctx, const char *name, const char *place, bool *lat_first) {
    city_sink *s = ctx;
    assert_non_null(place);
    assert_true(array_push(&s->crs, noc_strdup(name ? name : "(none)")));
    *lat_first = s->lat_first;
    return city_count(s);
}

static noc_status city_begin(void *ctx, const geo_object *object) {
    city_sink *s = ctx;
    assert_false(s->in_object);
    s->in_object = true;
    assert_true(
        array_push(&s->objects, (seen_object){ object->kind, noc_strdup(object->id), object->lod, 0, object->use }));
    return city_count(s);
}

static noc_status city_polygon(void *ctx, const geo_polygon *polygon) {
    city_sink *s = ctx;
    assert_true(s->in_object);
    assert_true(s->crs.len > 0);
    assert_non_null(polygon->id);
    assert_true(polygon->ring_count > 0);
    seen_polygon p = {
        .cls = polygon->cls, .id = noc_strdup(polygon->id), .rings = polygon->ring_count, .crs = s->crs.len
    };
    seen_object *object = &s->objects.data[s->objects.len - 1];
    object->polygons++;
    p.object = object->id;
    for (size_t r = 0; r < polygon->ring_count; r++) {
        assert_true(polygon->ring_size[r] >= 3);
        p.points += polygon->ring_size[r];
    }
    p.xyz = noc_alloc(p.points * 3 * sizeof(double));
    memcpy(p.xyz, polygon->xyz, p.points * 3 * sizeof(double));
    assert_true(array_push(&s->polygons, p));
    return city_count(s);
}

static noc_status city_end(void *ctx) {
    city_sink *s = ctx;
    assert_true(s->in_object);
    s->in_object = false;
    return city_count(s);
}

static noc_status city_lamp(void *ctx, const geo_lamp *lamp) {
    city_sink *s = ctx;
    assert_true(array_push(&s->lamps, *lamp));
    return city_count(s);
}

static bool city_progress(void *ctx, double done) {
    city_sink *s = ctx;
    assert_true(done >= 0 && done <= 1);
    s->asked++;
    s->asked_amid += s->lamps.len > s->lamps_asked;
    s->lamps_asked = s->lamps.len;
    return !s->stop_amid || !s->lamps.len;
}

static void city_quiet(void *user, noc_log_level level, const char *text) {
    (void)user;
    (void)level;
    (void)text;
}

static void city_clear(city_sink *s) {
    for (size_t i = 0; i < s->polygons.len; i++) {
        free(s->polygons.data[i].id);
        free(s->polygons.data[i].xyz);
    }
    for (size_t i = 0; i < s->objects.len; i++)
        free(s->objects.data[i].id);
    for (size_t i = 0; i < s->crs.len; i++)
        free(s->crs.data[i]);
    array_free(&s->polygons);
    array_free(&s->objects);
    array_free(&s->lamps);
    array_free(&s->crs);
    if (s->sink.issues)
        geo_issues_destroy(s->sink.issues);
    if (s->sink.log)
        noc_log_destroy(s->sink.log);
    s->sink = (geo_sink){ 0 };
}

/* Reads a file anew into s, whose lat_first and stop_at are kept. */
static noc_status city_read(city_sink *s, const char *path, int lod) {
    city_clear(s);
    s->calls = s->asked = s->asked_amid = s->lamps_asked = 0;
    s->in_object = false;
    s->format = "";
    s->sink = (geo_sink){ .ctx = s,
                          .log = noc_log_create(&(noc_log_params){ .message = city_quiet }),
                          .issues = geo_issues_create(),
                          .crs = city_crs,
                          .heights = city_heights,
                          .begin_object = city_begin,
                          .polygon = city_polygon,
                          .end_object = city_end,
                          .lamp = city_lamp,
                          .progress = city_progress };
    noc_import_params params = noc_import_default_params();
    params.lod = lod;
    params.max_memory = s->max_memory;
    const noc_reader *reader = s->reader ? s->reader : &noc_reader_citygml;
    noc_stream *stream = noc_stream_open(path, s->sink.log, NULL);
    if (stream && s->max_memory > 0)
        noc_stream_limit(stream, &params);
    s->status = stream ? reader->read(stream, &params, &s->sink, &s->format) : NOC_ERR_IO;
    noc_stream_close(stream);
    if (s->status == NOC_OK)
        assert_false(s->in_object);
    return s->status;
}

/* Reads a document from memory. */
static inline noc_status city_read_bytes(city_sink *s, const void *data, size_t size, int lod) {
    char path[] = "/tmp/noc-city-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, data, size), (ssize_t)size);
    close(fd);
    noc_status status = city_read(s, path, lod);
    unlink(path);
    return status;
}

/* How often a reason was counted. */
static inline size_t city_issue(const city_sink *s, const char *wanted) {
    for (size_t i = 0; i < geo_issues_count(s->sink.issues); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        assert_true(geo_issues_get(s->sink.issues, i, &reason, &repaired, &count, &examples));
        if (!strcmp(reason, wanted))
            return count;
    }
    return 0;
}

/* The polygon of an id; fails if there is not exactly one. */
static inline const seen_polygon *city_find(const city_sink *s, const char *id) {
    const seen_polygon *found = NULL;
    for (size_t i = 0; i < s->polygons.len; i++) {
        if (strcmp(s->polygons.data[i].id, id))
            continue;
        assert_null(found);
        found = &s->polygons.data[i];
    }
    assert_non_null(found);
    return found;
}

/* A file below shared/data/cities, and what was counted in it by other means (shared/data/README.md). */
typedef struct city_file {
    const char *path, *format;
    size_t objects, polygons;
    size_t holes;
    const char *crs; /* NULL: one, whichever */
} city_file;

/* Reads each that is there, without any issue; skips the test where none is. */
static inline void city_files(city_sink *s, const city_file *files, size_t count) {
    size_t present = 0;
    for (size_t i = 0; i < count; i++) {
        char *relative = noc_format("data/cities/%s", files[i].path);
        const char *path = shared_path(relative);
        free(relative);
        if (!path)
            continue;
        present++;
        noc_status status = city_read(s, path, 3);
        size_t holes = 0;
        for (size_t k = 0; k < s->polygons.len; k++)
            holes += s->polygons.data[k].rings - 1;
        if (status != NOC_OK || s->polygons.len != files[i].polygons || s->objects.len != files[i].objects ||
            holes != files[i].holes || s->crs.len != 1 || (files[i].crs && strcmp(s->crs.data[0], files[i].crs)) ||
            strcmp(s->format, files[i].format))
            fail_msg("%s: %s, %zu objects, %zu polygons, %zu holes, %zu CRSs", path, s->format, s->objects.len,
                     s->polygons.len, holes, s->crs.len);
        assert_int_equal(geo_issues_count(s->sink.issues), 0);
    }
    if (!present) {
        print_message("# skipped: shared/data/cities is not here\n");
        skip();
    }
}

#endif
