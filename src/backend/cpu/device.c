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

/* 2^-19 of the largest coordinate, at most 0.1 mm: where a scene is small, so are the gaps in it. Vertices are rounded
 * to 2^-24 of theirs. */
static float least_stand_off(const noc_scene *scene) {
    float largest = 0;
    for (size_t i = 0; i < scene->positions.len; i++)
        largest = NOC_MAX(largest, fabsf(scene->positions.data[i]));
    return NOC_MIN(largest * 0x1p-19f, 1e-4f);
}

void noc_cpu_world_destroy(void *state) {
    cpu_world *w = state;
    if (!w)
        return;
    noc_light_set_destroy(w->lights);
    if (w->rays)
        w->device->tracer->release(w->rays);
    free(w);
}

noc_status noc_cpu_world_create(void *device, const noc_scene *scene, void **state) {
    cpu_device *d = device;
    double start = noc_wall_seconds();
    cpu_world *w = noc_calloc(1, sizeof(*w));
    if (!w)
        return noc_no_memory(d->log, "world");
    *w = (cpu_world){ .device = d, .scene = scene, .log = d->log, .stand_off = least_stand_off(scene) };
    noc_status status = d->tracer->build(d->rays, scene, d->log, &w->rays);
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
