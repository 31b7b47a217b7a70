#include "render/device.h"

noc_device *noc_device_create(const noc_device_params *params, noc_log *log) {
    noc_device_params defaults = noc_device_default_params();
    noc_device_info info;
    params = params ? params : &defaults;
    if (noc_device_find(params, &info, log))
        return NULL;
    noc_device *d = noc_calloc(1, sizeof(*d));
    if (!d) {
        noc_no_memory(log, "device");
        return NULL;
    }
    d->log = log;
    d->info = info;
    d->backend = noc_backend_of(info.backend);
    if (d->backend->device_create(params, info.number, log, &d->state) != NOC_OK) {
        free(d);
        return NULL;
    }
    if (params->backend == NOC_BACKEND_AUTO)
        noc_info(log, "device: %s, %s", noc_backend_name(info.backend), info.name);
    pthread_mutex_init(&d->lock, NULL);
    return d;
}

const noc_device_info *noc_device_get_info(const noc_device *device) { return device ? &device->info : NULL; }

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

/* ---- rows ---- */

enum { BAND = 8 };
typedef struct band_run {
    int rows;
    void (*row)(const void *ctx, int y);
    const void *ctx;
} band_run;

static void run_band(void *arg, size_t band, int index) {
    const band_run *run = arg;
    (void)index;
    for (int y = (int)band * BAND; y < NOC_MIN((int)(band + 1) * BAND, run->rows); y++)
        run->row(run->ctx, y);
}

void noc_device_rows(const noc_device *d, int rows, void (*row)(const void *ctx, int y), const void *ctx) {
    d->backend->run(d->state, ((size_t)rows + BAND - 1) / BAND, run_band, &(band_run){ rows, row, ctx });
}
