/* A device and its worlds: what views share. */
#ifndef NOC_DEVICE_H
#define NOC_DEVICE_H

#include "render/backend.h"

#include <pthread.h>

/* A scene on a device. There is one as long as a view looks at the scene. */
typedef struct noc_world {
    const noc_scene *scene;
    void *state; /* the backend's */
    int views;
} noc_world;

struct noc_device {
    noc_log *log;
    const noc_backend *backend;
    noc_device_info info;
    void *state; /* the backend's */
    pthread_mutex_t lock;
    NOC_ARRAY(noc_world *) worlds;
};

/* The scene's world, made where there is none; NULL after reporting an error. */
noc_world *noc_world_enter(noc_device *device, const noc_scene *scene);
void noc_world_leave(noc_device *device, noc_world *world);

/* Calls row(ctx, y) for each y below `rows` by the device's threads, several rows at a time, so that threads seldom
 * meet. */
void noc_device_rows(const noc_device *device, int rows, void (*row)(const void *ctx, int y), const void *ctx);

#endif
