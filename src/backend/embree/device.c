/* The ray tracing structure and the rays: the only rtc* calls. */
#include "backend/embree/embree.h"

#include <math.h>
#include <stdio.h>

/* One message, whatever follows from the first error. */
static noc_status fail(embree_state *s, enum RTCError code, const char *text) {
    if (s->failed)
        return s->failed;
    if (code == RTC_ERROR_OUT_OF_MEMORY || atomic_load(&s->refused))
        return s->failed =
                   noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory for the ray tracing structure of %zu triangles",
                             s->scene->indices.len / 3);
    return s->failed = noc_error(s->log, NOC_ERR_UNSUPPORTED, "embree: %s", text && *text ? text : "unknown error");
}

static void report(void *user, enum RTCError code, const char *text) {
    if (code != RTC_ERROR_NONE)
        fail(user, code, text);
}

/* Of a block that Embree takes or has given back. False: Embree gives up, in order, before it takes it. */
static bool allow(void *user, ssize_t bytes, bool post) {
    embree_state *s = user;
    if (bytes > 0 && !post && !noc_embree_room(s, (size_t)bytes)) {
        atomic_store(&s->refused, true);
        return false;
    }
    atomic_fetch_add(&s->build_bytes, bytes);
    return true;
}

/* 2^-19 of the largest coordinate, at most 0.1 mm: where a scene is small, so are the gaps in it. Vertices are rounded
 * to 2^-24 of theirs. */
static float least_stand_off(const noc_scene *scene) {
    float largest = 0;
    for (size_t i = 0; i < scene->positions.len; i++)
        largest = NOC_MAX(largest, fabsf(scene->positions.data[i]));
    return NOC_MIN(largest * 0x1p-19f, 1e-4f);
}

static void attach_triangles(embree_state *s) {
    const noc_scene *scene = s->scene;
    size_t triangles = scene->indices.len / 3;
    RTCGeometry geometry = triangles ? rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
    if (!geometry)
        return;
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene->positions.data, 0, 12,
                               scene->positions.len / 3);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->indices.data, 0, 12,
                               triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(s->rtc, geometry);
    rtcReleaseGeometry(geometry);
}

noc_status noc_embree_build(embree_state *s) {
    double start = noc_wall_seconds();
    char config[64];
    if (!noc_embree_room_for_threads(s))
        return s->failed = noc_error(s->log, NOC_ERR_MEMORY,
                                     "embree: no memory for its threads, or a limit of their number "
                                     "(ulimit -u)");
    if (!noc_embree_room(s, 0))
        return fail(s, RTC_ERROR_OUT_OF_MEMORY, NULL);
    /* The cache is for surfaces that are subdivided; it would take 128 MB. */
    snprintf(config, sizeof(config), "threads=%d,tessellation_cache_size=0", noc_pool_threads(s->pool));
    s->device = rtcNewDevice(config);
    if (!s->device)
        return fail(s, rtcGetDeviceError(NULL), "no device");
    rtcSetDeviceErrorFunction(s->device, report, s);
    rtcSetDeviceMemoryMonitorFunction(s->device, allow, s);
    s->rtc = rtcNewScene(s->device);
    if (!s->rtc)
        return fail(s, rtcGetDeviceError(s->device), "no scene");
    /* Robust: without it rays slip through the edges between walls, and every slip is a bright pixel in a dark room. */
    rtcSetSceneFlags(s->rtc, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(s->rtc, RTC_BUILD_QUALITY_MEDIUM);
    attach_triangles(s);
    s->stand_off = least_stand_off(s->scene);
    if (!s->failed)
        rtcCommitScene(s->rtc);
    s->build_seconds = noc_wall_seconds() - start;
    return s->failed;
}

void noc_embree_release(embree_state *s) {
    if (s->rtc)
        rtcReleaseScene(s->rtc);
    if (s->device)
        rtcReleaseDevice(s->device);
    s->rtc = NULL;
    s->device = NULL;
}

static void lane_mask(uint32_t valid, int out[BLOCK]) {
    for (int l = 0; l < BLOCK; l++)
        out[l] = -(int)(valid >> l & 1);
}

static void fill_rays(const rayblock *rays, float far, struct RTCRay16 *r) {
    memcpy(r->org_x, rays->o, sizeof(rays->o));
    memcpy(r->dir_x, rays->d[0], sizeof(rays->d[0]));
    memcpy(r->dir_y, rays->d[1], sizeof(rays->d[1]));
    memcpy(r->dir_z, rays->d[2], sizeof(rays->d[2]));
    for (int l = 0; l < BLOCK; l++) {
        r->tnear[l] = 0;
        r->time[l] = 0;
        r->tfar[l] = far;
        r->mask[l] = UINT32_MAX;
        r->id[l] = 0;
        r->flags[l] = 0;
    }
}

static void keep(embree_state *s, worker *w, const rayblock *rays, const uint32_t *light, uint32_t valid, int together,
                 bool primary) {
    if (!s->recording || w->packets_lost)
        return;
    if (w->packet_count == w->packet_room) {
        size_t room = w->packet_room ? w->packet_room * 2 : 4096;
        packet *more = noc_alloc_large(room, sizeof(*more));
        if (!more) {
            w->packets_lost = true;
            return;
        }
        if (w->packet_count)
            memcpy(more, w->packets, w->packet_count * sizeof(*more));
        free(w->packets);
        w->packets = more;
        w->packet_room = room;
    }
    packet *p = &w->packets[w->packet_count++];
    *p = (packet){ .block = { .rays = *rays, .valid = valid }, .together = together, .primary = primary };
    if (light)
        memcpy(p->block.light, light, sizeof(p->block.light));
}

static void count_rays(worker *w, float *counts, uint32_t valid) {
    w->rays_shadow += (uint64_t)__builtin_popcount(valid);
    for (int l = 0; counts && l < BLOCK; l++)
        counts[l] += (float)(valid >> l & 1);
}

void noc_embree_free_many(embree_state *s, worker *w, segment_block *blocks, int count) {
    for (int first = 0; first < count; first += MANY_BLOCKS) {
        int n = NOC_MIN(MANY_BLOCKS, count - first);
        for (int i = 0; i < n; i++) {
            segment_block *b = &blocks[first + i];
            count_rays(w, b->counts, b->valid);
            keep(s, w, &b->rays, b->light, b->valid, n - i, false);
        }
        noc_embree_trace_many(s->rtc, blocks + first, n);
    }
}

/* The hit point from its triangle in doubles: in its plane to half a unit in the last place, however large the
 * triangle. o + t d would be off by the precision of t. */
static void fill_hit(const noc_scene *scene, const struct RTCRayHit16 *h, int l, gblock *g) {
    uint32_t prim = h->hit.primID[l];
    const uint32_t *v = scene->indices.data + 3 * (size_t)prim;
    const float *a = scene->positions.data + 3 * (size_t)v[0], *b = scene->positions.data + 3 * (size_t)v[1],
                *c = scene->positions.data + 3 * (size_t)v[2];
    double e[3], f[3], p[3], toward = 0;
    for (int k = 0; k < 3; k++) {
        e[k] = (double)b[k] - a[k];
        f[k] = (double)c[k] - a[k];
        p[k] = a[k] + h->hit.u[l] * e[k] + h->hit.v[l] * f[k];
    }
    double n[3] = { e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0] };
    double d[3] = { h->ray.dir_x[l], h->ray.dir_y[l], h->ray.dir_z[l] };
    double inv = 1 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        toward += n[k] * d[k];
    bool front = toward < 0;
    inv = front ? inv : -inv;
    g->px[l] = (float)p[0];
    g->py[l] = (float)p[1];
    g->pz[l] = (float)p[2];
    g->nx[l] = (float)(n[0] * inv);
    g->ny[l] = (float)(n[1] * inv);
    g->nz[l] = (float)(n[2] * inv);
    g->depth[l] = (float)(h->ray.tfar[l] * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    g->material[l] = scene->triangle_material.data[prim];
    uint32_t light = scene->triangle_light.data[prim];
    if (light != NOC_NO_LIGHT && !front && !(scene->lights.data[light].flags & 1))
        light = NOC_NO_LIGHT; /* the dark back of a one-sided emitter */
    g->light[l] = light;
}

void noc_embree_primary(embree_state *s, worker *w, const rayblock *rays, uint32_t valid, gblock *g, float *object) {
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRayHit16 h;
    *g = (gblock){ 0 };
    memset(g->material, 0xff, sizeof(g->material));
    memset(g->light, 0xff, sizeof(g->light));
    w->rays_primary += (uint64_t)__builtin_popcount(valid);
    keep(s, w, rays, NULL, valid, 1, true);
    lane_mask(valid, lanes);
    fill_rays(rays, INFINITY, &h.ray);
    memset(h.hit.geomID, 0xff, sizeof(h.hit.geomID));
    memset(h.hit.instID, 0xff, sizeof(h.hit.instID));
    rt_intersect16(lanes, s->rtc, &h, true);
    for (int l = 0; l < BLOCK; l++)
        if (valid >> l & 1 && h.hit.geomID[l] != RTC_INVALID_GEOMETRY_ID) {
            fill_hit(s->scene, &h, l, g);
            if (object)
                object[l] = (float)noc_scene_object_of(s->scene, h.hit.primID[l]);
        }
}

void noc_embree_probe(void *user, noc_probes *p) {
    const embree_state *s = user;
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRayHit16 h;
    rayblock rays;
    memcpy(rays.o, p->o, sizeof(rays.o));
    memcpy(rays.d, p->d, sizeof(rays.d));
    lane_mask(0xffff, lanes);
    fill_rays(&rays, 1, &h.ray);
    memset(h.hit.geomID, 0xff, sizeof(h.hit.geomID));
    memset(h.hit.instID, 0xff, sizeof(h.hit.instID));
    rt_intersect16(lanes, s->rtc, &h, false);
    for (int l = 0; l < BLOCK; l++)
        p->t[l] = h.hit.geomID[l] != RTC_INVALID_GEOMETRY_ID ? h.ray.tfar[l] : 1;
}

/* Packets of one worker are traced in runs of so many by whoever is free. */
enum { REPLAY_RUN = 64 };

struct replay {
    embree_state *s;
    struct replay_item {
        const packet *first;
        size_t count;
    } * items;
};

static void replay_primary(embree_state *s, const segment_block *b) {
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRayHit16 h;
    lane_mask(b->valid, lanes);
    fill_rays(&b->rays, INFINITY, &h.ray);
    memset(h.hit.geomID, 0xff, sizeof(h.hit.geomID));
    rt_intersect16(lanes, s->rtc, &h, true);
}

static void replay_run(void *ctx, size_t item, int index) {
    struct replay *r = ctx;
    const packet *p = r->items[item].first, *end = p + r->items[item].count;
    segment_block many[MANY_BLOCKS];
    (void)index;
    while (p < end) {
        int n = (int)NOC_MIN((ptrdiff_t)p->together, end - p);
        if (p->primary) {
            replay_primary(r->s, &p->block);
        } else {
            for (int i = 0; i < n; i++)
                many[i] = p[i].block;
            noc_embree_trace_many(r->s->rtc, many, n);
        }
        p += n;
    }
}

noc_status noc_embree_replay(embree_state *s, double *seconds) {
    NOC_ARRAY(struct replay_item) items = { 0 };
    bool whole = true;
    for (int i = 0; i < s->worker_count; i++) {
        const worker *w = &s->workers[i];
        whole = whole && !w->packets_lost;
        for (size_t k = 0; whole && k < w->packet_count; k += REPLAY_RUN)
            whole = array_push(&items, (struct replay_item){ w->packets + k,
                                                             NOC_MIN((size_t)REPLAY_RUN, w->packet_count - k) });
    }
    if (whole) {
        struct replay r = { s, items.data };
        double start = noc_wall_seconds();
        noc_pool_run(s->pool, items.len, replay_run, &r);
        *seconds = noc_wall_seconds() - start;
    }
    array_free(&items);
    return whole ? NOC_OK
                 : noc_error(s->log, NOC_ERR_MEMORY, "embree: no memory to keep the rays of a frame of %d x %d",
                             s->b.width, s->b.height);
}

size_t noc_embree_build_bytes(const embree_state *s) {
    ssize_t bytes = atomic_load(&((embree_state *)s)->build_bytes);
    return bytes > 0 ? (size_t)bytes : 0;
}
