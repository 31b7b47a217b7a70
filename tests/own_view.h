/* A view on a device of its own. */
#ifndef NOC_OWN_VIEW_H
#define NOC_OWN_VIEW_H

#include <nocturne/render.h>

static noc_backend_id own_backend = NOC_BACKEND_EMBREE; /* of views to come */

/* threads: 0: one a core. NULL after reporting an error. */
static inline noc_view *own_view(const noc_scene *scene, int threads, noc_log *log) {
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = threads, .backend = own_backend }, log);
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
