#include "noc_config.h"
#include "render/device.h"

static const noc_backend *const backends[] = {
    &noc_backend_embree,
#if NOC_HAVE_VULKAN
    &noc_backend_vulkan,
#endif
};

static const noc_backend *find_backend(const char *name, noc_log *log) {
    for (size_t i = 0; i < NOC_COUNT(backends); i++)
        if (!name || noc_ieq(name, backends[i]->name))
            return backends[i];
    noc_error(log, NOC_ERR_UNSUPPORTED, "device: no backend \"%s\" in this build (there is: embree)", name);
    return NULL;
}

noc_device *noc_device_create(const noc_device_params *params, noc_log *log) {
    noc_device_params defaults = noc_device_default_params();
    params = params ? params : &defaults;
    if (params->threads < 0 || params->threads > 1024) {
        noc_error(log, NOC_ERR_ARGUMENT, "device: threads is %d, must be in 0..1024", params->threads);
        return NULL;
    }
    const noc_backend *backend = find_backend(params->backend, log);
    if (!backend)
        return NULL;
    noc_device *d = noc_calloc(1, sizeof(*d));
    if (!d) {
        noc_no_memory(log, "device");
        return NULL;
    }
    d->log = log;
    d->backend = backend;
    if (backend->device_create(params, log, &d->state) != NOC_OK) {
        free(d);
        return NULL;
    }
    pthread_mutex_init(&d->lock, NULL);
    return d;
}

void noc_device_destroy(noc_device *d) {
    if (!d)
        return;
    d->backend->device_destroy(d->state);
    pthread_mutex_destroy(&d->lock);
    array_free(&d->worlds);
    free(d);
}

static noc_world *make_world(noc_device *d, const noc_scene *scene) {
    noc_world *world = array_reserve(&d->worlds, d->worlds.len + 1) ? noc_calloc(1, sizeof(*world)) : NULL;
    if (!world) {
        noc_no_memory(d->log, "view");
        return NULL;
    }
    world->scene = scene;
    if (d->backend->world_create(d->state, scene, &world->state) != NOC_OK) {
        free(world);
        return NULL;
    }
    d->worlds.data[d->worlds.len++] = world;
    return world;
}

noc_world *noc_world_enter(noc_device *d, const noc_scene *scene) {
    noc_world *world = NULL;
    pthread_mutex_lock(&d->lock);
    for (size_t i = 0; i < d->worlds.len && !world; i++)
        if (d->worlds.data[i]->scene == scene)
            world = d->worlds.data[i];
    if (!world)
        world = make_world(d, scene);
    if (world)
        world->views++;
    pthread_mutex_unlock(&d->lock);
    return world;
}

void noc_world_leave(noc_device *d, noc_world *world) {
    pthread_mutex_lock(&d->lock);
    if (--world->views == 0) {
        size_t at = 0;
        while (d->worlds.data[at] != world)
            at++;
        d->worlds.data[at] = d->worlds.data[--d->worlds.len];
        d->backend->world_destroy(world->state);
        free(world);
    }
    pthread_mutex_unlock(&d->lock);
}
