/* Looks at a file's first objects before the scene's place is settled: a sink between the reader and the importer's
 * own, which keeps what comes until there is enough of it, and from then on passes everything through. So one stray
 * object at the beginning does not decide where the whole city lies. */
#include "import/load/load.h"

#include <math.h>

#define ENOUGH_OBJECTS 64
#define FEW_OBJECTS 8 /* that are enough where they are large */
#define FEW_POINTS 10000
#define ENOUGH_POINTS 200000 /* of however few */

/* What a reader emitted, in its order. Texts and arrays in the arena. */
typedef struct ahead_event {
    enum {
        AHEAD_BEGIN,
        AHEAD_POLYGON,
        AHEAD_END,
        AHEAD_LAMP,
        AHEAD_FOOTPRINT,
        AHEAD_ROAD,
        AHEAD_AREA,
        AHEAD_TRACK
    } kind;
    source_crs *source;
    union {
        geo_object object;
        geo_polygon polygon;
        geo_lamp lamp;
        geo_footprint footprint;
        geo_road road;
        geo_track track;
    } u;
} ahead_event;

struct look_ahead {
    reading *reading;
    geo_sink sink; /* where everything goes in the end */
    geo_sides sides;
    bool passing;
    bool in_object, sampled; /* in an object whose place is known */
    size_t points;
    noc_arena arena;
    NOC_ARRAY(ahead_event) events;
    NOC_ARRAY(place_sample) samples;
};

static noc_status replay(struct look_ahead *a, const ahead_event *e) {
    a->reading->source = e->source;
    switch (e->kind) {
    case AHEAD_BEGIN: return a->sink.begin_object(a->sink.ctx, &e->u.object);
    case AHEAD_POLYGON: return a->sink.polygon(a->sink.ctx, &e->u.polygon);
    case AHEAD_END: return a->sink.end_object(a->sink.ctx);
    case AHEAD_FOOTPRINT: return a->sink.footprint(a->sink.ctx, &e->u.footprint);
    case AHEAD_ROAD: return a->sink.road(a->sink.ctx, &e->u.road);
    case AHEAD_AREA: return a->sink.area(a->sink.ctx, &e->u.polygon);
    case AHEAD_TRACK: return a->sink.track(a->sink.ctx, &e->u.track);
    case AHEAD_LAMP: break;
    }
    return a->sink.lamp(a->sink.ctx, &e->u.lamp);
}

noc_status ahead_release(struct look_ahead *a) {
    if (a->passing)
        return NOC_OK;
    a->passing = true;
    source_crs *source = a->reading->source;
    noc_status status = a->reading->im->placed ? NOC_OK : place_settle(a->reading, a->samples.data, a->samples.len);
    for (size_t i = 0; i < a->events.len && !status; i++)
        status = replay(a, &a->events.data[i]);
    a->reading->source = source;
    array_free(&a->events);
    array_free(&a->samples);
    arena_free(&a->arena);
    return status;
}

static noc_status no_memory(struct look_ahead *a) { return noc_no_memory(a->reading->log, a->reading->in->path); }

/* An event whose texts and arrays were put into the arena. */
static noc_status push(struct look_ahead *a, ahead_event e) {
    e.source = a->reading->source;
    return !a->arena.refused && array_push(&a->events, e) ? NOC_OK : no_memory(a);
}

/* Coordinates need a CRS, even if the file names none. */
static noc_status ensure_source(struct look_ahead *a) {
    return a->reading->source ? NOC_OK : place_crs(a->reading, NULL, a->reading->in->path, NULL);
}

/* One sample an object: what has many polygons counts no more than what has one. */
static noc_status keep_points(struct look_ahead *a, const double *xyz, size_t count, const char *id) {
    place_sample s = { .source = a->reading->source, .id = id };
    if (!(a->in_object && a->sampled) && place_centre(xyz, count, s.xyz)) {
        if (!array_push(&a->samples, s))
            return no_memory(a);
        a->sampled = true;
    }
    a->points += count;
    bool enough = a->samples.len >= ENOUGH_OBJECTS || a->points >= ENOUGH_POINTS ||
                  (a->samples.len >= FEW_OBJECTS && a->points >= FEW_POINTS);
    return enough ? ahead_release(a) : NOC_OK;
}

static noc_status on_crs(void *ctx, const char *srs_name, const char *place, bool *lat_first) {
    struct look_ahead *a = ctx;
    return a->sink.crs(a->sink.ctx, srs_name, place, lat_first);
}

static noc_status on_heights(void *ctx, double metres) {
    struct look_ahead *a = ctx;
    return a->sink.heights(a->sink.ctx, metres);
}

static double on_height_unit(void *ctx) {
    struct look_ahead *a = ctx;
    return a->sink.height_unit(a->sink.ctx);
}

static noc_status on_appearance(void *ctx, const geo_appearance *appearance, uint32_t *number) {
    struct look_ahead *a = ctx;
    return a->sink.appearance(a->sink.ctx, appearance, number);
}

static noc_status on_begin_object(void *ctx, const geo_object *object) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.begin_object(a->sink.ctx, object);
    ahead_event e = { .kind = AHEAD_BEGIN, .u.object = *object };
    e.u.object.id = arena_strdup(&a->arena, object->id);
    a->in_object = true;
    a->sampled = false;
    return push(a, e);
}

static noc_status on_end_object(void *ctx) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.end_object(a->sink.ctx);
    a->in_object = false;
    return push(a, (ahead_event){ .kind = AHEAD_END });
}

/* A copy in the arena; its sum goes to *points. */
static size_t *keep_sizes(struct look_ahead *a, const size_t *sizes, size_t count, size_t *points) {
    size_t *kept = arena_alloc(&a->arena, (count + 1) * sizeof(*kept));
    *points = 0;
    for (size_t i = 0; i < count && kept; i++)
        *points += kept[i] = sizes[i];
    return kept;
}

static double *keep_numbers(struct look_ahead *a, const double *numbers, size_t count) {
    double *kept = arena_alloc(&a->arena, (count + 1) * sizeof(*kept));
    if (kept && count)
        memcpy(kept, numbers, count * sizeof(*kept));
    return kept;
}

static float *keep_places(struct look_ahead *a, const float *uv, size_t count) {
    float *kept = arena_alloc(&a->arena, (count + 1) * sizeof(*kept));
    if (kept && count)
        memcpy(kept, uv, count * sizeof(*kept));
    return kept;
}

static noc_status keep_polygon(struct look_ahead *a, ahead_event e) {
    const geo_polygon *polygon = &e.u.polygon;
    noc_status status = ensure_source(a);
    if (status)
        return status;
    size_t count;
    e.u.polygon.ring_size = keep_sizes(a, polygon->ring_size, polygon->ring_count, &count);
    e.u.polygon.xyz = keep_numbers(a, polygon->xyz, 3 * count);
    e.u.polygon.uv = polygon->uv ? keep_places(a, polygon->uv, 2 * count) : NULL;
    e.u.polygon.id = arena_strdup(&a->arena, polygon->id);
    status = push(a, e);
    return status ? status : keep_points(a, e.u.polygon.xyz, count, e.u.polygon.id);
}

static noc_status on_polygon(void *ctx, const geo_polygon *polygon) {
    struct look_ahead *a = ctx;
    return a->passing ? a->sink.polygon(a->sink.ctx, polygon)
                      : keep_polygon(a, (ahead_event){ .kind = AHEAD_POLYGON, .u.polygon = *polygon });
}

static noc_status on_area(void *ctx, const geo_polygon *area) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.area(a->sink.ctx, area);
    a->in_object = false;
    return keep_polygon(a, (ahead_event){ .kind = AHEAD_AREA, .u.polygon = *area });
}

static noc_status on_lamp(void *ctx, const geo_lamp *lamp) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.lamp(a->sink.ctx, lamp);
    noc_status status = ensure_source(a);
    if (status)
        return status;
    ahead_event e = { .kind = AHEAD_LAMP, .u.lamp = *lamp };
    e.u.lamp.id = arena_strdup(&a->arena, lamp->id);
    e.u.lamp.ref = arena_strdup(&a->arena, lamp->ref ? lamp->ref : "");
    e.u.lamp.tags = arena_strdup(&a->arena, lamp->tags);
    status = push(a, e);
    a->in_object = false;
    return status ? status : keep_points(a, lamp->xyz, 1, e.u.lamp.id ? e.u.lamp.id : "");
}

static noc_status on_footprint(void *ctx, const geo_footprint *footprint) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.footprint(a->sink.ctx, footprint);
    noc_status status = ensure_source(a);
    if (status)
        return status;
    size_t count;
    ahead_event e = { .kind = AHEAD_FOOTPRINT, .u.footprint = *footprint };
    e.u.footprint.ring_size = keep_sizes(a, footprint->ring_size, footprint->ring_count, &count);
    e.u.footprint.xyz = keep_numbers(a, footprint->xyz, 3 * count);
    e.u.footprint.id = arena_strdup(&a->arena, footprint->id);
    status = push(a, e);
    a->in_object = false;
    return status ? status : keep_points(a, e.u.footprint.xyz, count, e.u.footprint.id);
}

static noc_status on_track(void *ctx, const geo_track *track) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.track(a->sink.ctx, track);
    noc_status status = ensure_source(a);
    if (status)
        return status;
    size_t count;
    ahead_event e = { .kind = AHEAD_TRACK, .u.track = *track };
    e.u.track.part_size = keep_sizes(a, track->part_size, track->part_count, &count);
    e.u.track.xyz = keep_numbers(a, track->xyz, 3 * count);
    e.u.track.seconds = track->seconds ? keep_numbers(a, track->seconds, count) : NULL;
    e.u.track.id = arena_strdup(&a->arena, track->id);
    status = push(a, e);
    a->in_object = false;
    return status ? status : keep_points(a, e.u.track.xyz, count, e.u.track.id);
}

static noc_status on_road(void *ctx, const geo_road *road) {
    struct look_ahead *a = ctx;
    if (a->passing)
        return a->sink.road(a->sink.ctx, road);
    noc_status status = ensure_source(a);
    if (status)
        return status;
    ahead_event e = { .kind = AHEAD_ROAD, .u.road = *road };
    double *xyz = arena_alloc(&a->arena, road->point_count * 3 * sizeof(*xyz));
    e.u.road.id = arena_strdup(&a->arena, road->id);
    e.u.road.name = arena_strdup(&a->arena, road->name);
    if (a->arena.refused)
        return no_memory(a);
    memcpy(xyz, road->xyz, road->point_count * 3 * sizeof(*xyz));
    e.u.road.xyz = xyz;
    status = push(a, e);
    a->in_object = false;
    return status ? status : keep_points(a, xyz, road->point_count, e.u.road.id);
}

static noc_status on_columns(void *ctx, size_t points, const geo_column *columns, size_t count) {
    struct look_ahead *a = ctx;
    return a->sink.columns(a->sink.ctx, points, columns, count);
}

static noc_status on_features(void *ctx, const geo_features *features) {
    struct look_ahead *a = ctx;
    return a->sink.features(a->sink.ctx, features);
}

static bool on_progress(void *ctx, double done) {
    struct look_ahead *a = ctx;
    return a->sink.progress(a->sink.ctx, done);
}

/* Where the place is settled, the sink's own. */
static geo_sink *on_side(void *ctx) {
    struct look_ahead *a = ctx;
    return a->passing ? a->sink.sides->create(a->sink.ctx) : NULL;
}

static noc_status on_take(void *ctx, geo_sink *side) {
    struct look_ahead *a = ctx;
    return a->sink.sides->take(a->sink.ctx, side);
}

struct look_ahead *ahead_create(reading *r, geo_sink *sink) {
    struct look_ahead *a = noc_calloc(1, sizeof(*a));
    if (!a)
        return NULL;
    a->reading = r;
    a->sink = *sink;
    sink->ctx = a;
    sink->crs = on_crs;
    sink->heights = on_heights;
    sink->height_unit = on_height_unit;
    sink->appearance = a->sink.appearance ? on_appearance : NULL;
    sink->begin_object = on_begin_object;
    sink->polygon = on_polygon;
    sink->end_object = on_end_object;
    sink->lamp = on_lamp;
    sink->footprint = a->sink.footprint ? on_footprint : NULL;
    sink->road = a->sink.road ? on_road : NULL;
    sink->area = a->sink.area ? on_area : NULL;
    sink->track = on_track;
    sink->columns = on_columns;
    sink->features = on_features;
    sink->progress = on_progress;
    if (sink->sides) {
        a->sides = *sink->sides;
        a->sides.create = on_side;
        a->sides.take = on_take;
        sink->sides = &a->sides;
    }
    return a;
}

void ahead_destroy(struct look_ahead *a) {
    if (!a)
        return;
    array_free(&a->events);
    array_free(&a->samples);
    arena_free(&a->arena);
    free(a);
}
