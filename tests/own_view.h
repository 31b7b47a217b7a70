/* A view on a device of its own. */
#ifndef NOC_OWN_VIEW_H
#define NOC_OWN_VIEW_H

#include <nocturne/render.h>
#include <stdlib.h>
#include <string.h>

static noc_backend_id own_backend = NOC_BACKEND_EMBREE; /* of views to come */

/* The device of a test program's views: on Vulkan where NOC_TEST_BACKEND says so (tests/backend/on_vulkan.sh). */
static inline noc_device *own_device(int threads, noc_log *log) {
    const char *name = getenv("NOC_TEST_BACKEND");
    noc_backend_id backend = name && !strcmp(name, "vulkan") ? NOC_BACKEND_VULKAN : own_backend;
    return noc_device_create(&(noc_device_params){ .threads = threads, .backend = backend }, log);
}

/* threads: 0: one a core. NULL after reporting an error. */
static inline noc_view *own_view(const noc_scene *scene, int threads, noc_log *log) {
    noc_device *device = own_device(threads, log);
    noc_view *view = noc_view_create(device, scene);
    if (!view)
        noc_device_destroy(device);
    return view;
}

static inline void close_view(noc_view *view) {
    noc_device *device = noc_view_device(view);
    noc_view_destroy(view);
    noc_device_destroy(device);
}

#endif
