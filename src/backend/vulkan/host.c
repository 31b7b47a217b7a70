/* Questions of the host that no frame is made for: picking, walking, who lights this. They come from many threads, a
 * few rays at a time, and wait for their answers, so the CPU backend answers them. Its structure of a scene is built
 * when the first question is asked. */
#include "backend/vulkan/vulkan.h"

/* Opens what is missing of the CPU backend's device, world and view. */
static noc_status open_host(vk_view *v) {
    vk_device *d = v->device;
    vk_world *w = v->world;
    const noc_backend *cpu = &noc_backend_embree;
    noc_status status = NOC_OK;
    if (v->host)
        return NOC_OK;
    pthread_mutex_lock(&d->host_lock);
    if (!d->host)
        status = cpu->device_create(&d->params, 0, d->log, &d->host);
    if (status == NOC_OK && !w->host)
        status = cpu->world_create(d->host, w->scene, &w->host);
    if (status == NOC_OK)
        status = cpu->view_create(w->host, &v->host);
    pthread_mutex_unlock(&d->host_lock);
    return status;
}

void noc_vk_forget_host_view(vk_view *v) {
    if (v->host)
        noc_backend_embree.view_destroy(v->host);
    v->host = NULL;
}

void noc_vk_forget_host_world(vk_world *w) {
    if (w->host)
        noc_backend_embree.world_destroy(w->host);
    w->host = NULL;
}

void noc_vk_forget_host_device(vk_device *d) {
    if (d->host)
        noc_backend_embree.device_destroy(d->host);
    d->host = NULL;
}

void noc_vk_run(void *device, size_t items, void (*fn)(void *ctx, size_t item, int worker), void *ctx) {
    noc_pool_run(((vk_device *)device)->pool, items, fn, ctx);
}

noc_status noc_vk_cast(void *view, const noc_ray *rays, size_t count, noc_hit *hits) {
    vk_view *v = view;
    noc_status status = open_host(v);
    return status == NOC_OK ? noc_backend_embree.cast(v->host, rays, count, hits) : status;
}

noc_status noc_vk_ask(void *view, const noc_render_params *params, bool tree, noc_asking *out) {
    vk_view *v = view;
    noc_status status = open_host(v);
    return status == NOC_OK ? noc_backend_embree.ask(v->host, params, tree, out) : status;
}

void noc_vk_clear(void *view, const noc_sight *sights, size_t count, float *clear) {
    noc_backend_embree.clear(((vk_view *)view)->host, sights, count, clear);
}

noc_status noc_vk_influence(void *view, const noc_render_params *params, const struct noc_influence **volumes) {
    vk_view *v = view;
    noc_status status = open_host(v);
    return status == NOC_OK ? noc_backend_embree.influence(v->host, params, volumes) : status;
}
