/* The only rtc* calls, with structure.c and many.c. */
#include "backend/cpu/backend.h"
#include "backend/embree/embree.h"

#include <math.h>
#include <stdio.h>

/* ---- errors and memory ---- */

/* One message, whatever follows from the first error. */
noc_status noc_embree_fail(embree_structure *s, enum RTCError code, const char *text) {
    noc_log *log = s->device->log;
    if (s->failed)
        return s->failed;
    if (code == RTC_ERROR_OUT_OF_MEMORY || atomic_load(&s->refused))
        return s->failed =
                   noc_error(log, NOC_ERR_MEMORY, "embree: no memory for the ray tracing structure of %zu triangles",
                             s->scene->indices.len / 3);
    return s->failed = noc_error(log, NOC_ERR_UNSUPPORTED, "embree: %s", text && *text ? text : "unknown error");
}

static void report(void *user, enum RTCError code, const char *text) {
    embree_device *d = user;
    if (code != RTC_ERROR_NONE && d->current)
        noc_embree_fail(d->current, code, text);
}

/* Of a block that Embree takes or has given back. False: Embree gives up, in order, before it takes it. */
static bool allow(void *user, ssize_t bytes, bool post) {
    embree_device *d = user;
    embree_structure *s = d->current;
    if (bytes > 0 && !post && !noc_embree_room(d->threads, (size_t)bytes)) {
        if (s)
            atomic_store(&s->refused, true);
        return false;
    }
    if (s)
        atomic_fetch_add(&s->bytes, bytes);
    return true;
}

static void enter(embree_structure *s) {
    pthread_mutex_lock(&s->device->lock);
    s->device->current = s;
}

static void leave(embree_structure *s) {
    s->device->current = NULL;
    pthread_mutex_unlock(&s->device->lock);
}

/* ---- the device ---- */

static void close_device(void *device) {
    embree_device *d = device;
    if (d->device)
        rtcReleaseDevice(d->device);
    pthread_mutex_destroy(&d->lock);
    free(d);
}

static noc_status open_device(int threads, noc_log *log, void **device) {
    char config[64];
    if (!noc_embree_room_for_threads(threads))
        return noc_error(log, NOC_ERR_MEMORY,
                         "embree: no memory for its threads, or a limit of their number (ulimit -u)");
    embree_device *d = noc_calloc(1, sizeof(*d));
    if (!d || !noc_embree_room(threads, 0)) {
        free(d);
        return noc_error(log, NOC_ERR_MEMORY, "embree: no memory for its device");
    }
    *d = (embree_device){ .log = log, .threads = threads };
    pthread_mutex_init(&d->lock, NULL);
    /* The cache is for surfaces that are subdivided; it would take 128 MB. */
    snprintf(config, sizeof(config), "threads=%d,tessellation_cache_size=0", threads);
    d->device = rtcNewDevice(config);
    if (!d->device) {
        noc_status status = rtcGetDeviceError(NULL) == RTC_ERROR_OUT_OF_MEMORY ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
        close_device(d);
        return noc_error(log, status, "embree: no device");
    }
    rtcSetDeviceErrorFunction(d->device, report, d);
    rtcSetDeviceMemoryMonitorFunction(d->device, allow, d);
    *device = d;
    return NOC_OK;
}

/* ---- structures ---- */

static void release_structure(void *structure) {
    embree_structure *s = structure;
    enter(s);
    noc_embree_release_parts(s);
    leave(s);
    free(s);
}

static noc_status follow(void *structure) {
    embree_structure *s = structure;
    if (s->geometry == s->scene->versions.geometry && s->instances == s->scene->versions.instances)
        return NOC_OK;
    enter(s);
    noc_status status = noc_embree_follow(s);
    leave(s);
    return status;
}

static noc_status build_structure(void *device, const noc_scene *scene, noc_log *log, void **structure) {
    embree_structure *s = noc_calloc(1, sizeof(*s));
    if (!s)
        return noc_no_memory(log, "embree");
    s->device = device;
    s->scene = scene;
    enter(s);
    noc_status status = noc_embree_follow(s);
    leave(s);
    if (status == NOC_OK)
        *structure = s;
    else
        release_structure(s);
    return status;
}

static size_t bytes_of(const void *structure) {
    ssize_t bytes = atomic_load(&((embree_structure *)structure)->bytes);
    return bytes > 0 ? (size_t)bytes : 0;
}

/* ---- rays ---- */

static void no_hits(struct RTCRayHit16 *h) {
    memset(h->hit.geomID, 0xff, sizeof(h->hit.geomID));
    memset(h->hit.instID, 0xff, sizeof(h->hit.instID));
}

/* The part that a ray met, and the number of what shows it. above: instID of the hit. */
static const embree_part *part_of(const embree_structure *s, const embree_generation *g, embree_layer layer,
                                  uint32_t above, uint32_t *instance) {
    *instance = NO_INSTANCE;
    if (above == RTC_INVALID_GEOMETRY_ID)
        return g->base;
    bool body = noc_is_body(above);
    *instance = body ? above : g->above[layer].data[above].instance;
    return body ? s->models.data[s->scene->bodies.data[above - NOC_BODIES].model - 1]
                : g->above[layer].data[above].part;
}

/* Copies what a packet has hit; lanes that it missed keep what they have. */
static void take_hits(const embree_structure *s, const embree_generation *g, embree_layer layer,
                      const struct RTCRayHit16 *h, uint32_t valid, hitblock *hits) {
    for (int l = 0; l < BLOCK; l++) {
        if (!(valid >> l & 1) || h->hit.geomID[l] == RTC_INVALID_GEOMETRY_ID)
            continue;
        uint32_t above = h->hit.instID[0][l];
        const embree_part *part = part_of(s, g, layer, above, &hits->instance[l]);
        hits->triangle[l] = h->hit.primID[l] + part->first[layer].data[h->hit.geomID[l]];
        hits->u[l] = h->hit.u[l];
        hits->v[l] = h->hit.v[l];
        hits->t[l] = h->ray.tfar[l];
    }
}

static void closest(void *structure, noc_ray_world in, const rayblock *rays, float far, uint32_t valid, bool coherent,
                    const uint32_t *chance, hitblock *hits) {
    const embree_structure *s = structure;
    const embree_generation *g = in == NOC_RAYS_PAST ? &s->past : &s->now;
    const bool all = in != NOC_RAYS_STANDING;
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRayHit16 h;
    for (int l = 0; l < BLOCK; l++) {
        lanes[l] = -(int)(valid >> l & 1);
        hits->triangle[l] = NO_HIT;
        hits->instance[l] = NO_INSTANCE;
        hits->u[l] = hits->v[l] = 0;
        hits->t[l] = far;
    }
    embree_fill_rays(rays, far, &h.ray);
    no_hits(&h);
    rt_intersect16(lanes, g->base->rtc[LAYER_SOLID], &h, coherent);
    if (s->bodies)
        rt_intersect16(lanes, s->bodies, &h, coherent);
    if (g->top[LAYER_SOLID] && all)
        rt_intersect16(lanes, g->top[LAYER_SOLID], &h, coherent);
    take_hits(s, g, LAYER_SOLID, &h, valid, hits);
    const RTCScene through[] = { g->base->rtc[LAYER_THROUGH], g->top[LAYER_THROUGH] };
    if (!all || (!through[0] && !through[1]))
        return;
    no_hits(&h);
    for (int i = 0; i < 2; i++)
        if (through[i])
            noc_embree_meet(through[i], s->scene, lanes, chance, &h);
    take_hits(s, g, LAYER_THROUGH, &h, valid, hits);
}

static bool through(void *structure, const shadow_block *blocks, int count, float (*out)[BLOCK]) {
    const embree_structure *s = structure;
    const RTCScene layers[] = { s->now.base->rtc[LAYER_THROUGH], s->now.top[LAYER_THROUGH] };
    if (!layers[0] && !layers[1])
        return false;
    for (int i = 0; i < count; i++) {
        for (int l = 0; l < BLOCK; l++)
            out[i][l] = 1;
        for (int k = 0; k < 2; k++)
            if (layers[k])
                noc_embree_trace_through(layers[k], s->scene, &blocks[i].rays, blocks[i].unoccluded, out[i]);
    }
    return true;
}

/* Traces what nothing has blocked so far. */
static void trace_rest(RTCScene scene, shadow_block *blocks, int count) {
    uint32_t valid[MANY_BLOCKS];
    for (int i = 0; i < count; i++) {
        valid[i] = blocks[i].valid;
        blocks[i].valid = blocks[i].unoccluded;
    }
    noc_embree_trace_many(scene, blocks, count);
    for (int i = 0; i < count; i++)
        blocks[i].valid = valid[i];
}

static void occluded(void *structure, noc_ray_world in, shadow_block *blocks, int count) {
    const embree_structure *s = structure;
    const embree_generation *g = in == NOC_RAYS_PAST ? &s->past : &s->now;
    noc_embree_trace_many(g->base->rtc[LAYER_SOLID], blocks, count);
    if (s->bodies)
        trace_rest(s->bodies, blocks, count);
    if (g->top[LAYER_SOLID] && in != NOC_RAYS_STANDING)
        trace_rest(g->top[LAYER_SOLID], blocks, count);
}

static const noc_tracer tracer = { .name = "embree",
                                   .open = open_device,
                                   .close = close_device,
                                   .build = build_structure,
                                   .release = release_structure,
                                   .follow = follow,
                                   .bytes = bytes_of,
                                   .closest = closest,
                                   .occluded = occluded,
                                   .through = through };

static noc_status create(const noc_device_params *params, int number, noc_log *log, void **device) {
    return noc_cpu_device_create(&tracer, params, log, device);
}

const noc_backend noc_backend_embree = { .device_create = create, NOC_CPU_BACKEND };
