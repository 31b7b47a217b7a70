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

/* A point and a normal of a model, where the instance has them. */
static void place_hit(const float m[12], float p[3], float n[3]) {
    float q[3], t[3], length = 0;
    for (int k = 0; k < 3; k++) {
        q[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
        t[k] = m[4 * k] * n[0] + m[4 * k + 1] * n[1] + m[4 * k + 2] * n[2];
        length += t[k] * t[k];
    }
    for (int k = 0; k < 3; k++) {
        p[k] = q[k];
        n[k] = t[k] / sqrtf(length);
    }
}

static void gather_corners(const noc_scene *scene, const hitblock *h, cornerblock *out) {
    for (int l = 0; l < BLOCK; l++) {
        const uint32_t *v = h->triangle[l] != NO_HIT ? scene->indices.data + 3 * (size_t)h->triangle[l] : NULL;
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 3; k++)
                out->at[corner][k][l] = v ? scene->positions.data[3 * (size_t)v[corner] + (size_t)k] : 0;
        out->u[l] = v ? h->u[l] : 0;
        out->v[l] = v ? h->v[l] : 0;
    }
}

/* Does an emitter show light to this side? What is dark, as the back of a one-sided one or a window where nobody is, is
 * a surface like others. */
static bool shows(const noc_light_record *l, float side) {
    return (side > 0 || l->flags & LIGHT_TWO_SIDED) && (l->e[0] > 0 || l->e[1] > 0 || l->e[2] > 0);
}

/* The receiver of lane l, whose point and normal are those of its triangle; its normal is turned to the viewer. */
static void end_hit(const noc_scene *scene, const rayblock *rays, const hitblock *h, int l, gblock *g) {
    uint32_t prim = h->triangle[l], light = scene->triangle_light.data[prim];
    float p[3] = { g->px[l], g->py[l], g->pz[l] }, n[3] = { g->nx[l], g->ny[l], g->nz[l] }, toward = 0, d2 = 0;
    if (h->instance[l] != NO_INSTANCE) {
        const noc_scene_instance *in = &scene->instances.data[h->instance[l]];
        place_hit(in->transform, p, n);
        light = light != NOC_NO_LIGHT ? in->lights[light] : light;
    }
    for (int k = 0; k < 3; k++) {
        toward += n[k] * rays->d[k][l];
        d2 += rays->d[k][l] * rays->d[k][l];
    }
    float side = toward < 0 ? 1 : -1;
    g->px[l] = p[0];
    g->py[l] = p[1];
    g->pz[l] = p[2];
    g->nx[l] = side * n[0];
    g->ny[l] = side * n[1];
    g->nz[l] = side * n[2];
    g->depth[l] = h->t[l] * sqrtf(d2);
    g->material[l] = scene->triangle_material.data[prim];
    if (light != NOC_NO_LIGHT && !shows(&scene->lights.data[light], side))
        light = NOC_NO_LIGHT;
    g->light[l] = light;
}

/* What the block sees of textures, as its albedos. Rays of two rows are as far from each other as a pixel is high. */
static void look_up(const cpu_view *s, const rayblock *rays, const hitblock *h, const cornerblock *corners, gblock *g) {
    const noc_scene *scene = s->scene;
    struct core_context ctx = { .materials = scene->material_records.data, .texels = scene->texels.data };
    imageblock image = { 0 };
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++) {
        if (h->triangle[l] == NO_HIT)
            continue;
        float at[3][2];
        if (!noc_scene_image_corners(scene, h->triangle[l], at))
            continue;
        float apart = 0, toward = 0, d2 = 0, scale2 = 1;
        const float n[3] = { g->nx[l], g->ny[l], g->nz[l] };
        for (int k = 0; k < 3; k++) {
            float a = rays->d[k][4] - rays->d[k][0];
            apart += a * a;
            toward += n[k] * rays->d[k][l];
            d2 += rays->d[k][l] * rays->d[k][l];
        }
        if (h->instance[l] != NO_INSTANCE) {
            const float *m = scene->instances.data[h->instance[l]].transform;
            scale2 = m[0] * m[0] + m[4] * m[4] + m[8] * m[8];
        }
        image.place[l] = scene->textures.data[scene->materials.data[g->material[l]].texture - 1].place;
        image.width[l] = h->t[l] * sqrtf(apart * d2 / scale2) / NOC_MAX(fabsf(toward), 0.01f * sqrtf(d2));
        for (int corner = 0; corner < 3; corner++)
            for (int k = 0; k < 2; k++)
                image.at[corner][k][l] = at[corner][k];
        lanes |= 1u << l;
    }
    if (lanes)
        s->kernels->texels(&ctx, corners, &image, lanes, g);
}

static void closest(const cpu_world *world, noc_ray_world in, const rayblock *rays, float far, uint32_t valid,
                    bool coherent, hitblock *hits) {
    world->device->tracer->closest(world->rays, in, rays, far, valid, coherent, hits);
}

void noc_cpu_primary(cpu_view *s, worker *w, const rayblock *rays, uint32_t valid, gblock *g, float *object,
                     float *wall, uint32_t *instance) {
    hitblock h;
    noc_cpu_no_receivers(g);
    w->rays_primary += (uint64_t)__builtin_popcount(valid);
    keep(s, w, rays, NULL, valid, 1, true);
    closest(s->world, NOC_RAYS_NOW, rays, INFINITY, valid, true, &h);
    if (instance)
        memcpy(instance, h.instance, sizeof(h.instance));
    cornerblock corners;
    gather_corners(s->scene, &h, &corners);
    s->kernels->hits(&corners, g);
    for (int l = 0; l < BLOCK; l++)
        if (h.triangle[l] != NO_HIT) {
            end_hit(s->scene, rays, &h, l, g);
            if (object)
                object[l] = (float)noc_scene_object_of(s->scene, h.triangle[l]);
            noc_wall_verdict verdict = wall ? noc_scene_wall(s->scene, h.triangle[l]) : NOC_WALL_UNSEEN;
            if (verdict)
                wall[l] = (float)(NOC_CLASS_COUNT + (int)verdict - 1);
        }
    if (s->scene->texels.len)
        look_up(s, rays, &h, &corners, g);
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

noc_status noc_cpu_replay_rays(cpu_view *s, noc_trace_floor *floor) {
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
        double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
        noc_pool_run(s->pool, items.len, replay_run, &r);
        *floor = (noc_trace_floor){ noc_wall_seconds() - wall, noc_cpu_seconds() - cpu };
    }
    array_free(&items);
    return whole ? NOC_OK
                 : noc_error(s->log, NOC_ERR_MEMORY, "render: no memory to keep the rays of a frame of %d x %d",
                             s->b.width, s->b.height);
}
