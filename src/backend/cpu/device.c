/* A device's threads and ray tracer, and the worlds on it. */
#include "backend/cpu/cpu.h"

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

static noc_status follow(cpu_world *w) {
    if (w->placings.shape == noc_scene_shape(&w->scene->versions))
        return NOC_OK;
    if (!noc_placings_reserve(&w->placings, w->scene))
        return noc_no_memory(w->log, "world");
    noc_status status = w->device->tracer->follow(w->rays);
    if (status != NOC_OK)
        return status;
    noc_placings_follow(&w->placings, w->scene);
    noc_ray_scale_follow(w->scene, &w->scale);
    return NOC_OK;
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
    noc_placings_free(&w->placings);
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
    noc_ray_scale_follow(w->scene, &w->scale);
    noc_status status = d->tracer->build(d->rays, scene, d->log, &w->rays);
    if (status == NOC_OK && !noc_placings_reserve(&w->placings, scene))
        status = noc_no_memory(d->log, "world");
    if (status == NOC_OK)
        noc_placings_follow(&w->placings, scene);
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
