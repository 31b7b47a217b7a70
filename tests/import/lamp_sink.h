/* A sink that keeps the lamps it is given, and a log that keeps the errors, for the tests of lamp readers. */
#ifndef NOC_TEST_LAMP_SINK_H
#define NOC_TEST_LAMP_SINK_H

#include "import/import.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "../test.h"

typedef struct lamp_sink {
    geo_sink sink;
    noc_log *log;
    NOC_ARRAY(geo_lamp) lamps;
    noc_arena names;
    char crs[256];
    char error[1024], warning[1024]; /* the last ones */
    const char *format;
    size_t points;
    NOC_ARRAY(geo_column) columns; /* texts in names */
    int errors, warnings;
    bool crs_taken;
    size_t cancel_after; /* lamps; 0: never */
} lamp_sink;

static void sink_message(void *user, noc_log_level level, const char *text) {
    lamp_sink *s = user;
    if (level == NOC_LOG_ERROR) {
        s->errors++;
        snprintf(s->error, sizeof(s->error), "%s", text);
    } else if (level == NOC_LOG_WARN) {
        s->warnings++;
        snprintf(s->warning, sizeof(s->warning), "%s", text);
    }
}

static noc_status sink_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    lamp_sink *s = ctx;
    assert_non_null(srs_name);
    assert_non_null(place);
    s->crs_taken = *srs_name == GEO_CRS_TAKEN;
    snprintf(s->crs, sizeof(s->crs), "%s", srs_name + s->crs_taken);
    *lat_first = false;
    return NOC_OK;
}

static noc_status sink_lamp(void *ctx, const geo_lamp *lamp) {
    lamp_sink *s = ctx;
    assert_true(isfinite(lamp->xyz[0]) && isfinite(lamp->xyz[1]));
    assert_non_null(lamp->id);
    if (s->cancel_after && s->lamps.len >= s->cancel_after)
        return NOC_ERR_CANCELLED;
    geo_lamp copy = *lamp;
    copy.id = arena_strdup(&s->names, lamp->id);
    copy.ref = arena_strdup(&s->names, lamp->ref ? lamp->ref : "");
    assert_true(array_push(&s->lamps, copy));
    return NOC_OK;
}

static noc_status sink_columns(void *ctx, size_t points, const geo_column *columns, size_t count) {
    lamp_sink *s = ctx;
    s->points = points;
    for (size_t i = 0; i < count; i++) {
        geo_column c = columns[i];
        const char **texts[] = { &c.name, &c.field, &c.unit, &c.example };
        for (size_t k = 0; k < NOC_COUNT(texts); k++)
            *texts[k] = arena_strdup(&s->names, *texts[k]);
        assert_true(array_push(&s->columns, c));
    }
    return NOC_OK;
}

static inline void lamp_sink_start(lamp_sink *s) {
    *s = (lamp_sink){ 0 };
    s->log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = sink_message, .user = s });
    s->sink = (geo_sink){ .ctx = s,
                          .log = s->log,
                          .issues = geo_issues_create(),
                          .crs = sink_crs,
                          .lamp = sink_lamp,
                          .columns = sink_columns };
}

static inline void lamp_sink_end(lamp_sink *s) {
    array_free(&s->lamps);
    array_free(&s->columns);
    arena_free(&s->names);
    geo_issues_destroy(s->sink.issues);
    noc_log_destroy(s->log);
}

/* How often an issue whose reason contains `text` was counted. */
static inline size_t issue_count(const lamp_sink *s, const char *text) {
    size_t sum = 0;
    for (size_t i = 0; i < geo_issues_count(s->sink.issues); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        assert_true(geo_issues_get(s->sink.issues, i, &reason, &repaired, &count, &examples));
        if (strstr(reason, text))
            sum += count;
    }
    return sum;
}

static inline const geo_lamp *lamp_by_id(const lamp_sink *s, const char *id) {
    for (size_t i = 0; i < s->lamps.len; i++)
        if (!strcmp(s->lamps.data[i].id, id))
            return &s->lamps.data[i];
    fail_msg("no lamp %s among %zu", id, s->lamps.len);
    return NULL;
}

/* Probes with both readers as the importer does, and reads with the first that accepts. */
static inline noc_status read_lamps(lamp_sink *s, const char *path, const noc_import_params *params) {
    const noc_reader *const readers[] = { &noc_reader_overpass, &noc_reader_vector };
    noc_stream *stream = noc_stream_open(path, s->log, NULL);
    if (!stream)
        return NOC_ERR_IO;
    char head[4097];
    size_t len = 0, got = 1;
    noc_status status = NOC_OK;
    while (!status && got && len < sizeof(head) - 1) {
        status = noc_stream_read(stream, head + len, sizeof(head) - 1 - len, &got);
        len += got;
    }
    head[len] = 0;
    const noc_reader *reader = NULL;
    for (size_t i = 0; !status && !reader && i < NOC_COUNT(readers); i++)
        if (readers[i]->probe(head, len) ||
            (s->sink.named_lamps && readers[i]->probe_named && readers[i]->probe_named(head, len)))
            reader = readers[i];
    if (!status)
        status = noc_stream_rewind(stream);
    if (!status && !reader)
        status = noc_error(s->log, NOC_ERR_FORMAT, "%s: no known format", path);
    if (!status)
        status = reader->read(stream, params, &s->sink, &s->format);
    noc_stream_close(stream);
    return status;
}

/* Writes a temporary file; the path is static. */
static inline const char *temp_file(const void *data, size_t size) {
    static char path[256];
    const char *tmp = getenv("TMPDIR");
    snprintf(path, sizeof(path), "%s/nocturne-lamps-%d", tmp && *tmp ? tmp : "/tmp", (int)getpid());
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
    return path;
}

static inline noc_status read_lamps_text(lamp_sink *s, const char *text, const noc_import_params *params) {
    return read_lamps(s, temp_file(text, strlen(text)), params);
}

#endif
