/* Rays of a view: what the tracer answers, and the book-keeping around it. */
#include "backend/cpu/cpu.h"

#include "core/hit.h"
#include "scene/facade.h"

#include <math.h>

static void keep(const cpu_view *s, worker *w, const packet *p) {
    if (w->record.lost)
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
    w->record.packets[w->record.count++] = *p;
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
            if (s->recording)
                keep(s, w, &(packet){ .block = *b, .together = n - i, .kind = PACKET_SHADOW, .in = in });
        }
        s->world->device->tracer->occluded(s->world->rays, in, blocks + first, n);
    }
}

static void gather_image(const noc_scene *scene, uint32_t triangle, int l, struck_block *out) {
    float at[3][2];
    if (!noc_scene_image_corners(scene, triangle, at))
        return;
    out->texture[l] = scene->textures.data[scene->materials.data[out->material[l]].texture - 1].place;
    for (int corner = 0; corner < 3; corner++)
        for (int k = 0; k < 2; k++)
            out->image[corner][k][l] = at[corner][k];
    out->textured |= 1u << l;
}

static void gather_instance(const noc_scene *scene, uint32_t instance, int l, struck_block *out) {
    float m[12];
    noc_placed_transform(scene, instance, m);
    for (int k = 0; k < 12; k++)
        out->transform[k][l] = m[k];
    if (out->light[l] != NOC_NO_LIGHT)
        out->light[l] = noc_placed_light(scene, instance, out->light[l]);
    out->placed |= 1u << l;
}

/* Where the hit is on a window in the wall: of what that is made, and its light. */
static bool gather_window(const noc_scene *scene, const noc_facade_record *facade, int l, struck_block *out) {
    corners at;
    v3 *const to[] = { &at.a, &at.b, &at.c };
    for (int corner = 0; corner < 3; corner++)
        *to[corner] = V3(out->at[corner][0][l], out->at[corner][1][l], out->at[corner][2][l]);
    v3 p = hit_point(at, out->u[l], out->v[l]);
    uint32_t light = noc_facade_light(scene, facade, (const float[]){ p.x, p.y, p.z });
    if (light == NOC_NO_LIGHT)
        return false;
    out->material[l] = facade->material;
    out->light[l] = light;
    return true;
}

static void gather_hit(const noc_scene *scene, const hitblock *h, int l, struck_block *out) {
    uint32_t triangle = h->triangle[l];
    const uint32_t *v = scene->indices.data + 3 * (size_t)triangle;
    for (int corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++)
            out->at[corner][k][l] = scene->positions.data[3 * (size_t)v[corner] + (size_t)k];
    out->u[l] = h->u[l];
    out->v[l] = h->v[l];
    out->t[l] = h->t[l];
    out->material[l] = scene->triangle_material.data[triangle];
    out->light[l] = scene->triangle_light.data[triangle];
    out->lanes |= 1u << l;
    const noc_facade_record *facade = h->instance[l] == NO_INSTANCE ? noc_scene_facade_of(scene, triangle) : NULL;
    if (facade && gather_window(scene, facade, l, out))
        return;
    if (h->instance[l] != NO_INSTANCE)
        gather_instance(scene, h->instance[l], l, out);
    if (scene->texels.len)
        gather_image(scene, triangle, l, out);
}

static void closest(const cpu_world *world, noc_ray_world in, const rayblock *rays, float far, uint32_t valid,
                    bool coherent, const uint32_t *chance, hitblock *hits) {
    world->device->tracer->closest(world->rays, in, rays, far, valid, coherent, chance, hits);
}

bool noc_cpu_through(const cpu_view *s, worker *w, const shadow_block *blocks, int count, float (*out)[BLOCK]) {
    if (!s->world->device->tracer->through(s->world->rays, blocks, count, out))
        return false;
    for (int i = 0; i < count && s->recording; i++)
        keep(s, w, &(packet){ .block = blocks[i], .together = count - i, .kind = PACKET_THROUGH });
    return true;
}

static void keep_primary(const cpu_view *s, worker *w, const rayblock *rays, const uint32_t *chance, uint32_t valid) {
    packet p = { .block = { .rays = *rays, .valid = valid }, .together = 1, .kind = PACKET_PRIMARY };
    memcpy(p.block.light, chance, sizeof(p.block.light));
    keep(s, w, &p);
}

void noc_cpu_primary(const stage_run *run, worker *w, const rayblock *rays, const uint32_t *chance, uint32_t valid,
                     size_t at) {
    cpu_view *s = run->s;
    hitblock h;
    struck_block found = { 0 };
    w->rays_primary += (uint64_t)__builtin_popcount(valid);
    if (s->recording)
        keep_primary(s, w, rays, chance, valid);
    closest(s->world, NOC_RAYS_NOW, rays, INFINITY, valid, true, chance, &h);
    for (int l = 0; s->b.instance && l < BLOCK; l++) /* bodies stay where they are, as the world does */
        s->b.instance[at][l] = h.instance[l] < NOC_BODIES ? h.instance[l] : NO_INSTANCE;
    for (int l = 0; l < BLOCK; l++)
        if (h.triangle[l] != NO_HIT) {
            gather_hit(s->scene, &h, l, &found);
            noc_views_note_triangle(&s->b.views, s->scene, h.triangle[l], h.instance[l], at, l);
        }
    run->k->hits(&run->ctx, rays, &found, &s->b.g[run->frame->gbuffer][at]);
}

void noc_cpu_probe(void *user, noc_probes *p) {
    rayblock rays;
    hitblock h;
    memcpy(rays.o, p->o, sizeof(rays.o));
    memcpy(rays.d, p->d, sizeof(rays.d));
    closest(user, NOC_RAYS_STANDING, &rays, 1, 0xffff, false, NULL, &h); /* what moves is not remembered */
    for (int l = 0; l < BLOCK; l++)
        p->t[l] = h.triangle[l] != NO_HIT ? h.t[l] : 1;
}

/* Packets of one worker are traced in runs of so many by whoever is free. */
enum { REPLAY_RUN = 64 };

struct replay {
    cpu_view *s;
    const noc_progress *progress;
    size_t count;
    atomic_size_t done;
    atomic_bool cancelled;
    struct replay_item {
        const packet *first;
        size_t count;
    } * items;
};

/* Traces n packets that were one call. */
static void replay_call(const cpu_world *world, const packet *p, int n) {
    shadow_block many[MANY_BLOCKS];
    float through[MANY_BLOCKS][BLOCK];
    hitblock hits;
    if (p->kind == PACKET_PRIMARY) {
        closest(world, p->in, &p->block.rays, INFINITY, p->block.valid, true, p->block.light, &hits);
        return;
    }
    for (int i = 0; i < n; i++)
        many[i] = p[i].block;
    if (p->kind == PACKET_SHADOW)
        world->device->tracer->occluded(world->rays, p->in, many, n);
    else
        world->device->tracer->through(world->rays, many, n, through);
}

static bool goes_on(const noc_progress *progress, double done) {
    return !progress || !progress->update || progress->update(progress->user, "the trace floor", done);
}

static void replay_run(void *ctx, size_t item, int index) {
    struct replay *r = ctx;
    const packet *p = r->items[item].first, *end = p + r->items[item].count;
    if (atomic_load_explicit(&r->cancelled, memory_order_relaxed))
        return;
    while (p < end) {
        int n = (int)NOC_MIN((ptrdiff_t)p->together, end - p);
        replay_call(r->s->world, p, n);
        p += n;
    }
    size_t done = atomic_fetch_add(&r->done, 1) + 1;
    if (index == 0 && !goes_on(r->progress, (double)done / (double)r->count))
        atomic_store(&r->cancelled, true);
}

/* False: the caller breaks it off. */
static bool replay_all(struct replay *r, noc_trace_floor *floor) {
    if (!goes_on(r->progress, 0))
        return false;
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    noc_pool_run(r->s->pool, r->count, replay_run, r);
    if (atomic_load(&r->cancelled))
        return false;
    *floor = (noc_trace_floor){ noc_wall_seconds() - wall, noc_cpu_seconds() - cpu };
    return true;
}

noc_status noc_cpu_replay_rays(cpu_view *s, const noc_progress *progress, noc_trace_floor *floor) {
    NOC_ARRAY(struct replay_item) items = { 0 };
    bool whole = true, complete = true;
    for (int i = 0; i < s->worker_count; i++) {
        const worker *w = &s->workers[i];
        whole = whole && !w->record.lost;
        for (size_t k = 0; whole && k < w->record.count; k += REPLAY_RUN)
            whole = array_push(&items, (struct replay_item){ w->record.packets + k,
                                                             NOC_MIN((size_t)REPLAY_RUN, w->record.count - k) });
    }
    if (whole) {
        struct replay r = { .s = s, .progress = progress, .count = items.len, .items = items.data };
        complete = replay_all(&r, floor);
    }
    array_free(&items);
    if (!complete)
        return NOC_ERR_CANCELLED;
    return whole ? NOC_OK
                 : noc_error(s->log, NOC_ERR_MEMORY, "render: no memory to keep the rays of a frame of %d x %d",
                             s->b.width, s->b.height);
}
