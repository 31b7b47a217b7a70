/* Readings of parts of a file before their turn, on threads of the reader's own: each has a copy of what is settled of
 * the file so far, and keeps what it reads until the file's own reading takes it over. */
#include "import/load/load.h"

struct load_side {
    geo_sink sink;
    reading reading;
    input input;       /* its own counts and issues of the file */
    source_crs *known; /* copies of the file's CRSs, whose transforms are its own */
    noc_arena arena;
    NOC_ARRAY(load_part) parts;
};

noc_status side_put(load_side *s, const load_part *part) {
    load_part copy = part_copied(&s->arena, *part);
    return !s->arena.refused && array_push(&s->parts, copy) ? NOC_OK : NOC_ERR_MEMORY;
}

static noc_status refuse_lamp(void *ctx, const geo_lamp *lamp) {
    (void)ctx;
    (void)lamp;
    return NOC_ERR_UNSUPPORTED;
}

static bool go_on(void *ctx, double done) {
    (void)ctx;
    (void)done;
    return true; /* the file's own is asked */
}

/* Is all told of the file's CRSs that its coordinates tell? */
static bool settled(const reading *r) {
    for (size_t i = 0; i < r->in->sources.len; i++) {
        const source_crs *s = r->in->sources.data[i];
        if (!s->ready || (s->crs && !s->axes_decided))
            return false;
    }
    return r->im->placed && r->in->sources.len;
}

/* A transform serves one thread. */
static bool copy_sources(load_side *s, const reading *of) {
    size_t count = of->in->sources.len;
    s->known = noc_calloc(count, sizeof(*s->known));
    if (!s->known || !array_reserve(&s->input.sources, count))
        return false;
    for (size_t i = 0; i < count; i++) {
        source_crs *to = &s->known[i];
        *to = *of->in->sources.data[i];
        to->to_scene = NULL;
        s->input.sources.data[s->input.sources.len++] = to;
        if (to->crs && !(to->to_scene = geo_transform_create(to->crs, of->im->scene_crs, NULL, NULL)))
            return false;
    }
    return true;
}

static void destroy(geo_sink *sink) {
    load_side *s = ((reading *)sink->ctx)->side;
    for (size_t i = 0; i < s->input.sources.len; i++)
        geo_transform_destroy(s->known[i].to_scene);
    free(s->known);
    array_free(&s->input.sources);
    geo_issues_destroy(s->input.issues);
    reading_free(&s->reading);
    arena_free(&s->arena);
    array_free(&s->parts);
    free(s);
}

/* The transforms are made under the lock, as all are that touch the scene's CRS. */
static geo_sink *create(void *ctx) {
    reading *of = ctx;
    load_side *s = settled(of) ? noc_calloc(1, sizeof(*s)) : NULL;
    if (!s)
        return NULL;
    s->input = (input){ .path = of->in->path, .reader = of->in->reader, .issues = geo_issues_create() };
    s->reading = (reading){ .im = of->im, .in = &s->input, .index = of->index, .side = s };
    s->sink = sink_create(&s->reading);
    s->sink.lamp = refuse_lamp;
    s->sink.progress = go_on;
    pthread_mutex_lock(&of->im->lock);
    bool made = s->input.issues && copy_sources(s, of);
    pthread_mutex_unlock(&of->im->lock);
    if (made)
        return &s->sink;
    destroy(&s->sink);
    return NULL;
}

static void forget(geo_sink *sink) {
    load_side *s = ((reading *)sink->ctx)->side;
    reading *r = &s->reading;
    for (size_t i = 0; i < NOC_CLASS_COUNT + r->group_count; i++) /* of an object that did not end */
        triangles_clear(triangles_of(r, i));
    look_end_object(r);
    r->now = (object_now){ 0 };
    free(r->object_id);
    r->object_id = NULL;
    s->input.file = (noc_report_file){ 0 };
    s->parts.len = 0;
    arena_free(&s->arena);
    geo_issues_clear(s->input.issues);
}

static void widen(noc_report_file *to, const noc_report_file *from) {
    for (int k = 0; k < 3 && from->has_extent; k++) {
        to->extent_min[k] = to->has_extent ? NOC_MIN(to->extent_min[k], from->extent_min[k]) : from->extent_min[k];
        to->extent_max[k] = to->has_extent ? NOC_MAX(to->extent_max[k], from->extent_max[k]) : from->extent_max[k];
    }
    to->has_extent = to->has_extent || from->has_extent;
}

static noc_status take(void *ctx, geo_sink *sink) {
    reading *r = ctx;
    load_side *s = ((reading *)sink->ctx)->side;
    noc_report_file *to = &r->in->file;
    const noc_report_file *from = &s->input.file;
    to->objects += from->objects;
    to->buildings += from->buildings;
    for (size_t i = 0; i < NOC_COUNT(to->lod_used); i++)
        to->lod_used[i] += from->lod_used[i];
    widen(to, from);
    geo_issues_merge(r->in->issues, s->input.issues);
    noc_status status = NOC_OK;
    for (size_t i = 0; i < s->parts.len && !status; i++)
        status = sink_hand_over(r, &s->parts.data[i]);
    forget(sink);
    return status;
}

geo_sides sides_of(int threads) { return (geo_sides){ threads, create, take, forget, destroy }; }
