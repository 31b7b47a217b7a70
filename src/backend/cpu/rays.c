/* Rays of a view: what the tracer answers, and the book-keeping around it. */
#include "backend/cpu/cpu.h"

#include <math.h>

static void keep(cpu_view *s, worker *w, const rayblock *rays, const uint32_t *light, uint32_t valid, int together,
                 bool primary) {
    if (!s->recording || w->record.lost)
        return;
    if (w->record.count == w->record.room) {
        size_t room = w->record.room ? w->record.room * 2 : 4096;
        packet *more = noc_alloc_large(room, sizeof(*more));
        if (!more) {
            w->record.lost = true;
            return;
        }
        if (w->record.count)
            memcpy(more, w->record.packets, w->record.count * sizeof(*more));
        free(w->record.packets);
        w->record.packets = more;
        w->record.room = room;
    }
    packet *p = &w->record.packets[w->record.count++];
    *p = (packet){ .block = { .rays = *rays, .valid = valid }, .together = together, .primary = primary };
    if (light)
        memcpy(p->block.light, light, sizeof(p->block.light));
}

static void count_rays(worker *w, float *counts, uint32_t valid) {
    w->rays_shadow += (uint64_t)__builtin_popcount(valid);
    for (int l = 0; counts && l < BLOCK; l++)
        counts[l] += (float)(valid >> l & 1);
}

void noc_cpu_trace_occlusion(cpu_view *s, worker *w, noc_ray_world in, shadow_block *blocks, int count) {
    for (int first = 0; first < count; first += MANY_BLOCKS) {
        int n = NOC_MIN(MANY_BLOCKS, count - first);
        for (int i = 0; i < n; i++) {
            shadow_block *b = &blocks[first + i];
            count_rays(w, b->counts, b->valid);
            keep(s, w, &b->rays, b->light, b->valid, n - i, false);
        }
        s->world->device->tracer->occluded(s->world->rays, in, blocks + first, n);
    }
}

/* From a model's coordinates to the scene's; n keeps its direction, not its length. */
static void place_hit(const float m[12], double p[3], double n[3]) {
    double q[3], t[3];
    for (int k = 0; k < 3; k++) {
        q[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
        t[k] = m[4 * k] * n[0] + m[4 * k + 1] * n[1] + m[4 * k + 2] * n[2];
    }
    memcpy(p, q, sizeof(q));
    memcpy(n, t, sizeof(t));
}

/* The hit point from its triangle in doubles: in its plane to half a unit in the last place, however large the
 * triangle. o + t d would be off by the precision of t. */
static void fill_hit(const noc_scene *scene, const rayblock *rays, const hitblock *h, int l, gblock *g) {
    uint32_t prim = h->triangle[l];
    const uint32_t *v = scene->indices.data + 3 * (size_t)prim;
    const float *a = scene->positions.data + 3 * (size_t)v[0], *b = scene->positions.data + 3 * (size_t)v[1],
                *c = scene->positions.data + 3 * (size_t)v[2];
    double e[3], f[3], p[3], toward = 0;
    for (int k = 0; k < 3; k++) {
        e[k] = (double)b[k] - a[k];
        f[k] = (double)c[k] - a[k];
        p[k] = a[k] + h->u[l] * e[k] + h->v[l] * f[k];
    }
    double n[3] = { e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0] };
    uint32_t light = scene->triangle_light.data[prim];
    if (h->instance[l] != NO_INSTANCE) {
        const noc_scene_instance *in = &scene->instances.data[h->instance[l]];
        place_hit(in->transform, p, n);
        light = light != NOC_NO_LIGHT ? in->lights[light] : light;
    }
    double d[3] = { rays->d[0][l], rays->d[1][l], rays->d[2][l] };
    double inv = 1 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        toward += n[k] * d[k];
    bool front = toward < 0;
    inv = front ? inv : -inv;
    g->px[l] = (float)p[0];
    g->py[l] = (float)p[1];
    g->pz[l] = (float)p[2];
    g->nx[l] = (float)(n[0] * inv);
    g->ny[l] = (float)(n[1] * inv);
    g->nz[l] = (float)(n[2] * inv);
    g->depth[l] = (float)(h->t[l] * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    g->material[l] = scene->triangle_material.data[prim];
    if (light != NOC_NO_LIGHT && !front && !(scene->lights.data[light].flags & LIGHT_TWO_SIDED))
        light = NOC_NO_LIGHT; /* the dark back of a one-sided emitter */
    g->light[l] = light;
}

static void closest(const cpu_world *world, noc_ray_world in, const rayblock *rays, float far, uint32_t valid,
                    bool coherent, hitblock *hits) {
    world->device->tracer->closest(world->rays, in, rays, far, valid, coherent, hits);
}

void noc_cpu_primary(cpu_view *s, worker *w, const rayblock *rays, uint32_t valid, gblock *g, float *object,
                     uint32_t *instance) {
    hitblock h;
    *g = (gblock){ 0 };
    memset(g->material, 0xff, sizeof(g->material));
    memset(g->light, 0xff, sizeof(g->light));
    w->rays_primary += (uint64_t)__builtin_popcount(valid);
    keep(s, w, rays, NULL, valid, 1, true);
    closest(s->world, NOC_RAYS_NOW, rays, INFINITY, valid, true, &h);
    if (instance)
        memcpy(instance, h.instance, sizeof(h.instance));
    for (int l = 0; l < BLOCK; l++)
        if (h.triangle[l] != NO_HIT) {
            fill_hit(s->scene, rays, &h, l, g);
            if (object)
                object[l] = (float)noc_scene_object_of(s->scene, h.triangle[l]);
        }
}

void noc_cpu_probe(void *user, noc_probes *p) {
    rayblock rays;
    hitblock h;
    memcpy(rays.o, p->o, sizeof(rays.o));
    memcpy(rays.d, p->d, sizeof(rays.d));
    closest(user, NOC_RAYS_STANDING, &rays, 1, 0xffff, false, &h); /* what moves is not remembered */
    for (int l = 0; l < BLOCK; l++)
        p->t[l] = h.triangle[l] != NO_HIT ? h.t[l] : 1;
}

/* Packets of one worker are traced in runs of so many by whoever is free. */
enum { REPLAY_RUN = 64 };

struct replay {
    cpu_view *s;
    struct replay_item {
        const packet *first;
        size_t count;
    } * items;
};

static void replay_run(void *ctx, size_t item, int index) {
    struct replay *r = ctx;
    const packet *p = r->items[item].first, *end = p + r->items[item].count;
    shadow_block many[MANY_BLOCKS];
    (void)index;
    while (p < end) {
        int n = (int)NOC_MIN((ptrdiff_t)p->together, end - p);
        if (p->primary) {
            hitblock hits;
            closest(r->s->world, NOC_RAYS_NOW, &p->block.rays, INFINITY, p->block.valid, true, &hits);
        } else {
            for (int i = 0; i < n; i++)
                many[i] = p[i].block;
            r->s->world->device->tracer->occluded(r->s->world->rays, NOC_RAYS_NOW, many, n);
        }
        p += n;
    }
}

noc_status noc_cpu_replay_rays(cpu_view *s, double *seconds) {
    NOC_ARRAY(struct replay_item) items = { 0 };
    bool whole = true;
    for (int i = 0; i < s->worker_count; i++) {
        const worker *w = &s->workers[i];
        whole = whole && !w->record.lost;
        for (size_t k = 0; whole && k < w->record.count; k += REPLAY_RUN)
            whole = array_push(&items, (struct replay_item){ w->record.packets + k,
                                                             NOC_MIN((size_t)REPLAY_RUN, w->record.count - k) });
    }
    if (whole) {
        struct replay r = { s, items.data };
        double start = noc_wall_seconds();
        noc_pool_run(s->pool, items.len, replay_run, &r);
        *seconds = noc_wall_seconds() - start;
    }
    array_free(&items);
    return whole ? NOC_OK
                 : noc_error(s->log, NOC_ERR_MEMORY, "render: no memory to keep the rays of a frame of %d x %d",
                             s->b.width, s->b.height);
}
