/* The helper's side: reads one file as it is asked to, and sends what its reader emits. */
#include "import/load/load.h"
#include "import/remote/remote.h"

#include <malloc.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct serving {
    remote_request asked;
    remote_record out, batch; /* small records wait for others */
    size_t lamps_lost;
    int materials;
} serving;

#define BATCH (1 << 16)

static void emit(serving *s, uint32_t kind) {
    remote_add(&s->batch, kind, &s->out);
    if (s->batch.refused)
        _exit(REMOTE_NO_MEMORY);
    bool waits = kind == REMOTE_LAMP || kind == REMOTE_MATERIAL || kind == REMOTE_ISSUE || kind == REMOTE_CRS ||
                 kind == REMOTE_OBJECT || kind == REMOTE_POLYGON || kind == REMOTE_OBJECT_END ||
                 kind == REMOTE_FOOTPRINT || kind == REMOTE_ROAD || kind == REMOTE_AREA || kind == REMOTE_TRACK ||
                 kind == REMOTE_NAMED;
    if ((!waits || s->batch.bytes.len > BATCH) && !remote_send(REMOTE_FD, &s->batch))
        _exit(1); /* whoever asked is gone: so are we */
}

static void on_message(void *user, noc_log_level level, const char *text) {
    serving *s = user;
    int32_t n = (int32_t)level;
    remote_put(&s->out, &n, sizeof(n));
    remote_put_text(&s->out, text);
    emit(s, REMOTE_LOG);
}

/* Axes: foreign readers give easting first, whatever the CRS says, so no answer is waited for. */
static noc_status on_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    serving *s = ctx;
    remote_put_text(&s->out, srs_name);
    remote_put_text(&s->out, place);
    emit(s, REMOTE_CRS);
    *lat_first = false;
    return NOC_OK;
}

static noc_status on_heights(void *ctx, double metres) {
    serving *s = ctx;
    remote_put(&s->out, &metres, sizeof(metres));
    emit(s, REMOTE_HEIGHTS);
    return NOC_OK;
}

static noc_status on_begin_object(void *ctx, const geo_object *object) {
    serving *s = ctx;
    remote_object o = { (int32_t)object->kind, object->lod };
    remote_put(&s->out, &o, sizeof(o));
    remote_put_text(&s->out, object->id);
    emit(s, REMOTE_OBJECT);
    return NOC_OK;
}

static void put_rings(serving *s, size_t count, const size_t *sizes, const double *xyz) {
    size_t points = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t size = sizes[i];
        remote_put(&s->out, &size, sizeof(size));
        points += sizes[i];
    }
    remote_put(&s->out, xyz, points * 3 * sizeof(double));
}

static noc_status on_polygon(void *ctx, const geo_polygon *polygon) {
    serving *s = ctx;
    uint64_t numbers[] = { (uint64_t)polygon->cls, polygon->ring_count };
    remote_put(&s->out, numbers, sizeof(numbers));
    remote_put_text(&s->out, polygon->id);
    put_rings(s, polygon->ring_count, polygon->ring_size, polygon->xyz);
    emit(s, REMOTE_POLYGON);
    return NOC_OK;
}

static noc_status on_footprint(void *ctx, const geo_footprint *f) {
    serving *s = ctx;
    remote_footprint r = { f->ring_count, f->height,      f->min_height, f->levels,
                           f->min_level,  f->roof_height, f->use,        f->bare };
    remote_put(&s->out, &r, sizeof(r));
    remote_put_text(&s->out, f->id);
    put_rings(s, f->ring_count, f->ring_size, f->xyz);
    emit(s, REMOTE_FOOTPRINT);
    return NOC_OK;
}

static noc_status on_road(void *ctx, const geo_road *road) {
    serving *s = ctx;
    remote_put(&s->out, road, sizeof(*road));
    remote_put_text(&s->out, road->id);
    remote_put_text(&s->out, road->name);
    remote_put(&s->out, road->xyz, road->point_count * 3 * sizeof(double));
    emit(s, REMOTE_ROAD);
    return NOC_OK;
}

static noc_status on_track(void *ctx, const geo_track *track) {
    serving *s = ctx;
    uint64_t head[2] = { track->part_count, track->seconds != NULL };
    size_t points = 0;
    for (size_t i = 0; i < track->part_count; i++)
        points += track->part_size[i];
    remote_put(&s->out, head, sizeof(head));
    remote_put_text(&s->out, track->id);
    put_rings(s, track->part_count, track->part_size, track->xyz);
    if (track->seconds)
        remote_put(&s->out, track->seconds, points * sizeof(double));
    emit(s, REMOTE_TRACK);
    return NOC_OK;
}

static noc_status on_area(void *ctx, const geo_polygon *area) {
    serving *s = ctx;
    uint64_t head[2] = { area->ring_count, (uint64_t)area->cls };
    remote_put(&s->out, head, sizeof(head));
    remote_put_text(&s->out, area->id);
    put_rings(s, area->ring_count, area->ring_size, area->xyz);
    emit(s, REMOTE_AREA);
    return NOC_OK;
}

static noc_status on_end_object(void *ctx) {
    emit(ctx, REMOTE_OBJECT_END);
    return NOC_OK;
}

static noc_status on_lamp(void *ctx, const geo_lamp *lamp) {
    serving *s = ctx;
    remote_put(&s->out, lamp, sizeof(*lamp));
    remote_put_text(&s->out, lamp->id);
    remote_put_text(&s->out, lamp->ref);
    remote_put_text(&s->out, lamp->tags);
    emit(s, REMOTE_LAMP);
    return NOC_OK;
}

static bool on_progress(void *ctx, double done) {
    serving *s = ctx;
    remote_put(&s->out, &done, sizeof(done));
    emit(s, REMOTE_PROGRESS);
    return true;
}

static noc_status on_columns(void *ctx, size_t points, const geo_column *columns, size_t count) {
    serving *s = ctx;
    uint64_t numbers[] = { points, count };
    remote_put(&s->out, numbers, sizeof(numbers));
    for (size_t i = 0; i < count; i++) {
        uint64_t values = columns[i].values;
        unsigned char mapped = columns[i].mapped;
        remote_put(&s->out, &values, sizeof(values));
        remote_put(&s->out, &mapped, sizeof(mapped));
        remote_put_text(&s->out, columns[i].name);
        remote_put_text(&s->out, columns[i].field);
        remote_put_text(&s->out, columns[i].unit);
        remote_put_text(&s->out, columns[i].example);
    }
    emit(s, REMOTE_COLUMNS);
    return NOC_OK;
}

static noc_status on_features(void *ctx, const geo_features *features) {
    serving *s = ctx;
    remote_put(&s->out, features, sizeof(*features));
    emit(s, REMOTE_FEATURES);
    return NOC_OK;
}

/* Of an image its name alone: whoever asked opens it. */
static noc_status on_material(void *ctx, const noc_material *material, const char *name, const mesh_image *image,
                              int *index) {
    serving *s = ctx;
    remote_image told = { 0 };
    if (image) {
        told = (remote_image){ .there = 1, .wrap = image->wrap, .cutoff = image->cutoff };
        memcpy(told.albedo, image->albedo, sizeof(told.albedo));
    }
    remote_put(&s->out, material, sizeof(*material));
    remote_put_text(&s->out, name);
    remote_put(&s->out, &told, sizeof(told));
    remote_put_text(&s->out, image ? image->name : "");
    emit(s, REMOTE_MATERIAL);
    *index = s->materials++;
    return NOC_OK;
}

static noc_status on_mesh(void *ctx, noc_mesh *mesh, double *positions) {
    serving *s = ctx;
    remote_mesh m = { mesh->vertex_count, mesh->triangle_count, mesh->material, mesh->uv != NULL };
    remote_put(&s->out, &m, sizeof(m));
    remote_put_text(&s->out, mesh->name);
    remote_put(&s->out, mesh->positions, mesh->vertex_count * 3 * sizeof(double));
    remote_put(&s->out, mesh->indices, mesh->triangle_count * 3 * sizeof(uint32_t));
    if (mesh->uv)
        remote_put(&s->out, mesh->uv, mesh->vertex_count * 2 * sizeof(float));
    emit(s, REMOTE_MESH);
    return NOC_OK;
}

static void on_named(void *user, const char *path) {
    serving *s = user;
    remote_put_text(&s->out, path);
    emit(s, REMOTE_NAMED);
}

/* ---- the answer ---- */

static void send_issues(serving *s, const geo_issues *issues) {
    for (size_t i = 0; i < geo_issues_count(issues); i++) {
        const char *reason, *examples;
        bool repaired;
        unsigned char kind = (unsigned char)geo_issues_kind(issues, i);
        size_t count;
        if (!geo_issues_get(issues, i, &reason, &repaired, &count, &examples))
            _exit(REMOTE_NO_MEMORY);
        remote_put(&s->out, &kind, sizeof(kind));
        remote_put(&s->out, &count, sizeof(count));
        remote_put_text(&s->out, reason);
        remote_put_text(&s->out, examples);
        emit(s, REMOTE_ISSUE);
    }
}

static void serve(serving *s) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_DEBUG, .message = on_message, .user = s });
    geo_issues *issues = geo_issues_create();
    if (!log || !issues)
        _exit(REMOTE_NO_MEMORY);
    geo_sink sink = { .ctx = s,
                      .log = log,
                      .issues = issues,
                      .lamps_lost = &s->lamps_lost,
                      .crs = on_crs,
                      .heights = on_heights,
                      .begin_object = on_begin_object,
                      .polygon = on_polygon,
                      .end_object = on_end_object,
                      .lamp = on_lamp,
                      .footprint = s->asked.sink.footprints ? on_footprint : NULL,
                      .road = s->asked.sink.roads ? on_road : NULL,
                      .area = s->asked.sink.roads ? on_area : NULL,
                      .track = on_track,
                      .progress = on_progress,
                      .columns = on_columns,
                      .features = on_features,
                      .named_lamps = s->asked.sink.named_lamps,
                      .named_tracks = s->asked.sink.named_tracks,
                      .given_metres = s->asked.sink.given_metres,
                      .given_degrees = s->asked.sink.given_degrees,
                      .inspect = s->asked.sink.inspect };
    const mesh_parts parts = { .ctx = s, .log = log, .issues = issues, .material = on_material, .mesh = on_mesh };
    const char *format = s->asked.reader->name;
    noc_status opened;
    noc_stream *stream = noc_stream_open(s->asked.path, log, &opened);
    remote_end end = { .status = (int32_t)opened };
    if (stream) {
        noc_stream_limit(stream, &s->asked.params);
        noc_stream_listen(stream, (import_listener){ on_named, s });
        end.status =
            s->asked.reader->read_parts
                ? (int32_t)s->asked.reader->read_parts(s->asked.path, stream, &s->asked.params, &parts, &format)
                : (int32_t)s->asked.reader->read(stream, &s->asked.params, &sink, &format);
        if (end.status == NOC_ERR_FORMAT && remote_short_of_memory())
            noc_warn(log,
                     "%s: the process that reads it took more than half of what it may: it may need more than the "
                     "limit --max-memory, %.3g GB",
                     s->asked.path, import_budget_of(&s->asked.params).memory / 1e9);
        end.bytes_read = noc_stream_read_bytes(stream);
        end.trailing = noc_stream_trailing(stream);
    }
    if (geo_issues_refused(issues))
        _exit(REMOTE_NO_MEMORY);
    send_issues(s, issues);
    end.lamps_lost = s->lamps_lost;
    remote_put(&s->out, &end, sizeof(end));
    remote_put_text(&s->out, format);
    emit(s, REMOTE_END);
}

int noc_reader_main(void) {
    int type;
    socklen_t size = sizeof(type);
    serving s = { 0 };
    pid_t parent;
    if (getsockopt(REMOTE_FD, SOL_SOCKET, SO_TYPE, &type, &size) || !remote_keep(&parent))
        return 1;
    mallopt(M_ARENA_MAX, 1); /* each takes addresses, of which the helper gets few */
    if (!remote_receive(REMOTE_FD, &s.asked) || parent != s.asked.sink.parent)
        /* not started by the library, or whoever started it ended before it asked to end with it */
        return s.asked.texts.refused ? REMOTE_NO_MEMORY : 1;
    if (s.asked.reader->load)
        s.asked.reader->load(); /* why it cannot be is told by who reads */
    remote_confine(s.asked.path, s.asked.reader->read_parts != NULL, &s.asked.params);
    serve(&s);
    _exit(0); /* what is left to tidy up goes with the process */
}
