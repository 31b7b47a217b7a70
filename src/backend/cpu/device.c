/* A device's threads and ray tracer, and the worlds on it. */
#include "backend/cpu/cpu.h"

#include <math.h>

void noc_cpu_device_destroy(void *state) {
    cpu_device *d = state;
    if (!d)
        return;
    if (d->rays)
        d->tracer->close(d->rays);
    noc_pool_destroy(d->pool);
    free(d);
}

noc_status noc_cpu_device_create(const noc_tracer *tracer, const noc_device_params *params, noc_log *log,
                                 void **state) {
    cpu_device *d = noc_calloc(1, sizeof(*d));
    if (!d || !(d->pool = noc_pool_create(params->threads))) {
        free(d);
        return noc_no_memory(log, "device");
    }
    d->log = log;
    d->tracer = tracer;
    noc_status status = tracer->open(noc_pool_threads(d->pool), log, &d->rays);
    if (status != NOC_OK) {
        noc_cpu_device_destroy(d);
        return status;
    }
    *state = d;
    return NOC_OK;
}

void noc_cpu_run(void *device, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx) {
    noc_pool_run(((cpu_device *)device)->pool, items, fn, ctx);
}

/* 2^-19 of the largest coordinate, at most 0.1 mm: where a scene is small, so are the gaps in it. Vertices are rounded
 * to 2^-24 of theirs. It looks at what is new only, and stays as it is where something is removed. */
static void find_ray_offset(cpu_world *w) {
    const noc_scene *s = w->scene;
    for (size_t mesh = 0; mesh < s->meshes.len; mesh++) {
        const noc_scene_mesh *m = &s->meshes.data[mesh];
        if ((m->first_vertex >= w->vertices || m->made > w->made) && !m->model && !noc_mesh_closes(s, m))
            for (size_t i = 3 * (size_t)s->meshes.data[mesh].first_vertex; i < 3 * noc_mesh_end_vertex(s, mesh); i++)
                w->largest = NOC_MAX(w->largest, fabsf(s->positions.data[i]));
    }
    for (size_t i = 0; i < s->instances.len; i++) {
        double box[2][3] = { { 0 } };
        if (s->instances.data[i].model)
            noc_join_instance_bounds(s, &s->instances.data[i], box[0], box[1]);
        for (int k = 0; k < 6; k++)
            w->largest = NOC_MAX(w->largest, fabsf((float)box[k / 3][k % 3]));
    }
    w->vertices = s->positions.len / 3;
    w->made = (uint32_t)s->versions.geometry;
    w->ray_offset = NOC_MIN(w->largest * 0x1p-19f, 1e-4f);
}

static bool copy_places(const noc_scene *scene, cpu_places *to) {
    if (!array_reserve(to, scene->instances.len))
        return false;
    to->len = scene->instances.len;
    for (size_t i = 0; i < to->len; i++) {
        const noc_scene_instance *in = &scene->instances.data[i];
        to->data[i].model = in->model;
        memcpy(to->data[i].transform, in->transform, sizeof(in->transform));
    }
    return true;
}

static noc_status follow(cpu_world *w) {
    uint64_t shape = noc_cpu_shape(&w->scene->versions);
    if (w->shape == shape)
        return NOC_OK;
    if (!array_reserve(&w->places[1], w->scene->instances.len))
        return noc_no_memory(w->log, "world");
    noc_status status = w->device->tracer->follow(w->rays);
    if (status != NOC_OK)
        return status;
    cpu_places then = w->places[0];
    w->places[0] = w->places[1];
    w->places[1] = then;
    w->past = w->shape;
    w->shape = shape;
    find_ray_offset(w);
    return copy_places(w->scene, &w->places[0]) ? NOC_OK : NOC_ERR_MEMORY; /* there is room */
}

noc_status noc_cpu_follow(cpu_world *w) {
    pthread_mutex_lock(&w->lock);
    noc_status status = follow(w);
    pthread_mutex_unlock(&w->lock);
    return status;
}

void noc_cpu_world_destroy(void *state) {
    cpu_world *w = state;
    if (!w)
        return;
    noc_light_set_destroy(w->lights);
    if (w->rays)
        w->device->tracer->release(w->rays);
    for (int i = 0; i < 2; i++)
        array_free(&w->places[i]);
    pthread_mutex_destroy(&w->lock);
    free(w);
}

noc_status noc_cpu_world_create(void *device, const noc_scene *scene, void **state) {
    cpu_device *d = device;
    double start = noc_wall_seconds();
    cpu_world *w = noc_calloc(1, sizeof(*w));
    if (!w)
        return noc_no_memory(d->log, "world");
    *w = (cpu_world){ .device = d, .scene = scene, .log = d->log };
    pthread_mutex_init(&w->lock, NULL);
    w->shape = w->past = noc_cpu_shape(&scene->versions);
    find_ray_offset(w);
    noc_status status = d->tracer->build(d->rays, scene, d->log, &w->rays);
    if (status == NOC_OK && !copy_places(scene, &w->places[0]))
        status = noc_no_memory(d->log, "world");
    w->build_seconds = noc_wall_seconds() - start;
    if (status == NOC_OK && !(w->lights = noc_light_set_create(scene, d->pool, noc_cpu_probe, w, d->log)))
        status = NOC_ERR_MEMORY;
    if (status != NOC_OK) {
        noc_cpu_world_destroy(w);
        return status;
    }
    *state = w;
    return NOC_OK;
}

size_t noc_cpu_rays_bytes(const cpu_world *w) { return w->device->tracer->bytes(w->rays); }
