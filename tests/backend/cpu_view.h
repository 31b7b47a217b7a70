/* A view of the CPU backend, for tests and benches that look inside. */
#ifndef NOC_TEST_CPU_VIEW_H
#define NOC_TEST_CPU_VIEW_H

#include "backend/cpu/cpu.h"

/* NULL after reporting an error. */
static inline cpu_view *open_cpu_view(const noc_scene *scene, int threads, noc_log *log) {
    const noc_backend *b = &noc_backend_embree;
    void *device = NULL, *world = NULL, *view = NULL;
    if (b->device_create(&(noc_device_params){ .threads = threads }, 0, log, &device) ||
        b->world_create(device, scene, &world) || b->view_create(world, &view)) {
        if (world)
            b->world_destroy(world);
        if (device)
            b->device_destroy(device);
        return NULL;
    }
    return view;
}

static inline void close_cpu_view(cpu_view *view) {
    const noc_backend *b = &noc_backend_embree;
    cpu_world *world = view->world;
    cpu_device *device = world->device;
    b->view_destroy(view);
    b->world_destroy(world);
    b->device_destroy(device);
}

#endif
