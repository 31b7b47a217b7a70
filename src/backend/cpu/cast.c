/* Rays of whoever picks, measures or walks: nearest hits (render/hit.c). They leave the view as it is. */
#include "backend/cpu/cpu.h"

#include <math.h>

enum { ALONE = 256 / BLOCK, ITEM = 32 }; /* blocks that the calling thread traces itself; that a thread takes at once */

typedef struct casting {
    const cpu_world *world;
    const noc_ray *rays;
    size_t count;
    noc_hit *hits;
} casting;

static void cast_block(const casting *c, size_t first) {
    int count = (int)NOC_MIN((size_t)BLOCK, c->count - first);
    rayblock rays = { 0 };
    hitblock hits;
    float far = 0;
    for (int l = 0; l < count; l++) {
        const noc_ray *ray = &c->rays[first + (size_t)l];
        double length = noc_ray_length(ray);
        for (int k = 0; k < 3; k++) {
            rays.o[k][l] = (float)ray->origin[k];
            rays.d[k][l] = (float)(ray->direction[k] / length);
        }
        far = fmaxf(far, (float)ray->far);
    }
    uint32_t valid = (1u << count) - 1;
    c->world->device->tracer->closest(c->world->rays, NOC_RAYS_NOW, &rays, far, valid, false, NULL, &hits);
    for (int l = 0; l < count; l++) {
        noc_hit *out = &c->hits[first + (size_t)l];
        noc_met met = { hits.triangle[l], hits.instance[l], hits.u[l], hits.v[l] };
        *out = (noc_hit){ .material = -1, .object = -1, .instance = -1, .light = -1 };
        if (hits.triangle[l] != NO_HIT && hits.t[l] <= c->rays[first + (size_t)l].far)
            noc_describe_hit(c->world->scene, &c->rays[first + (size_t)l], &met, out);
    }
}

static void cast_item(void *ctx, size_t item, int index) {
    const casting *c = ctx;
    size_t end = NOC_MIN(c->count, (item + 1) * ITEM * BLOCK);
    (void)index;
    for (size_t first = item * ITEM * BLOCK; first < end; first += BLOCK)
        cast_block(c, first);
}

noc_status noc_cpu_cast(void *state, const noc_ray *rays, size_t count, noc_hit *hits) {
    cpu_view *s = state;
    noc_status status = noc_cpu_follow(s->world);
    if (status != NOC_OK)
        return status;
    casting c = { s->world, rays, count, hits };
    if (count > ALONE * BLOCK)
        noc_pool_run(s->pool, (count + ITEM * BLOCK - 1) / (ITEM * BLOCK), cast_item, &c);
    else
        for (size_t first = 0; first < count; first += BLOCK)
            cast_block(&c, first);
    return NOC_OK;
}
