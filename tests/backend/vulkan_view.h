/* A view of the Vulkan backend beside one of the CPU, whose tracer answers the rays of both: then everything that is
 * computed between rays must have the same bits. */
#ifndef NOC_TEST_VULKAN_VIEW_H
#define NOC_TEST_VULKAN_VIEW_H

#include "backend/vulkan/vulkan.h"
#include "core/random.h"
#include "cpu_view.h"
#include "render/device.h"
#include "render/view.h"

#include "test.h"

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        noc_status status_ = (call);                                                                                   \
        if (status_ != NOC_OK)                                                                                         \
            return status_;                                                                                            \
    } while (0)

typedef struct twins {
    noc_device *cpu_device, *device;
    noc_view *cpu, *gpu; /* of one scene */
    vk_answerer answerer;
    size_t weakened; /* rays that the CPU's tracer has answered with a transmittance between 0 and 1 */
} twins;

static inline cpu_view *cpu_of(const twins *t) { return t->cpu->state; }
static inline vk_view *gpu_of(const twins *t) { return t->gpu->state; }

/* Where each triangle is in the BLAS of an entry: the numbers that hits have. */
typedef struct hit_numbers {
    uint32_t *entry; /* of the scene's triangles: of all; of models', of their part's */
    uint32_t *at;
} hit_numbers;

static inline uint32_t entries_of(const vk_part *p) {
    uint32_t n = 0;
    for (int layer = 0; layer < VK_LAYERS; layer++)
        n += (uint32_t)p->blas[layer].len;
    return n;
}

static inline void number_part(const vk_world *w, const vk_part *part, uint32_t number, uint32_t *order,
                               hit_numbers *n) {
    for (int layer = 0; layer < VK_LAYERS; layer++)
        for (size_t k = 0; k < part->blas[layer].len; k++, number++) {
            const vk_piece *b = &part->blas[layer].data[k].order;
            assert_int_equal(noc_vk_read(w->device, &b->chunk->buffer, b->at, order, (size_t)b->bytes), NOC_OK);
            for (uint32_t p = 0; p < b->bytes / 4; p++) {
                n->entry[order[p]] = number;
                n->at[order[p]] = p;
            }
        }
}

static inline hit_numbers find_numbers(const vk_world *w) {
    const vk_parts *parts = &w->structure.tlas[w->structure.now].held;
    size_t triangles = w->scene->indices.len / 3;
    hit_numbers n = { noc_calloc(triangles, 4), noc_calloc(triangles, 4) };
    uint32_t *order = noc_calloc(triangles, 4), number = 0;
    assert_true(n.entry && n.at && order);
    for (size_t i = 0; i < parts->len; i++) {
        bool world = i < w->structure.world.len;
        number_part(w, parts->data[i], world ? number : 0, order, &n);
        number += world ? entries_of(parts->data[i]) : 0;
    }
    free(order);
    return n;
}

static inline uint32_t entries_of_model(const vk_world *w, uint32_t model) {
    return model ? entries_of(w->structure.models.data[model - 1]) : 0;
}

/* The entry of an instance: entries of the world come first, then those of bodies, and of instances, in their order. */
static inline uint32_t entry_of(const vk_world *w, const hit_numbers *n, uint32_t triangle, uint32_t instance) {
    uint32_t entry = 0;
    if (instance == NO_INSTANCE)
        return n->entry[triangle];
    for (size_t i = 0; i < w->structure.world.len; i++)
        entry += entries_of(w->structure.world.data[i]);
    uint32_t bodies = noc_is_body(instance) ? instance - NOC_BODIES : (uint32_t)w->scene->bodies.len;
    for (uint32_t i = 0; i < bodies; i++)
        entry += entries_of_model(w, w->scene->bodies.data[i].model);
    for (uint32_t i = 0; i < instance && !noc_is_body(instance); i++)
        entry += entries_of_model(w, w->scene->instances.data[i].model);
    return entry + n->entry[triangle];
}

/* By which the camera's rays of a block meet panes. */
static inline void keys_of(const vk_view *v, size_t block, uint32_t key[BLOCK]) {
    const frame_constants *c = v->flights[v->flight].constants.mapped;
    uint32_t x = (uint32_t)block % v->b.blocks_x * 4, y = (uint32_t)block / v->b.blocks_x * 4;
    for (uint32_t l = 0; l < BLOCK; l++)
        key[l] = rng_key(c->seed, (y + l / 4) * c->width + x + l % 4, c->index);
}

/* Nearest hits of a block's rays by the CPU's tracer, as a ray tracing shader leaves them. */
static inline void answer_closest(const twins *t, const hit_numbers *numbers, const rayblock *rays,
                                  const uint32_t *chance, const uint32_t *wanted, uint32_t out[5][BLOCK]) {
    const cpu_world *w = cpu_of(t)->world;
    hitblock h;
    uint32_t valid = 0;
    for (int l = 0; l < BLOCK; l++)
        valid |= (uint32_t)(wanted[l] == VK_ANSWER_WANTED) << l;
    w->device->tracer->closest(w->rays, NOC_RAYS_NOW, rays, INFINITY, valid, true, chance, &h);
    for (int l = 0; l < BLOCK; l++) {
        out[0][l] = NO_HIT;
        if (h.triangle[l] == NO_HIT)
            continue;
        out[0][l] = numbers->at[h.triangle[l]];
        out[1][l] = entry_of(gpu_of(t)->world, numbers, h.triangle[l], h.instance[l]);
        memcpy(&out[2][l], &h.u[l], 4);
        memcpy(&out[3][l], &h.v[l], 4);
        memcpy(&out[4][l], &h.t[l], 4);
    }
}

static inline void answer_occlusion(const twins *t, bool past, const rayblock *rays, uint32_t *answers) {
    const cpu_world *w = cpu_of(t)->world;
    shadow_block b = { .rays = *rays };
    for (int l = 0; l < BLOCK; l++)
        b.valid |= (uint32_t)((answers[l] & 3) == VK_ANSWER_WANTED) << l;
    w->device->tracer->occluded(w->rays, past ? NOC_RAYS_PAST : NOC_RAYS_NOW, &b, 1);
    for (int l = 0; l < BLOCK; l++)
        if (b.unoccluded >> l & 1)
            answers[l] = (answers[l] & ~3u) | VK_ANSWER_CLEAR;
}

/* Transmittances of segments that nothing blocks; of the others anything may be there. */
static inline void answer_through(twins *t, const rayblock *rays, const uint32_t *answers, float *through) {
    const cpu_world *w = cpu_of(t)->world;
    shadow_block b = { .rays = *rays };
    for (int l = 0; l < BLOCK; l++)
        b.unoccluded |= (uint32_t)((answers[l] & 3) == VK_ANSWER_CLEAR) << l;
    if (!w->device->tracer->through(w->rays, &b, 1, (float(*)[BLOCK])(void *)through))
        for (int l = 0; l < BLOCK; l++)
            through[l] = 1;
    for (int l = 0; l < BLOCK; l++)
        t->weakened += through[l] > 0 && through[l] < 1;
}

static inline noc_status answer_by_cpu(void *user, const vk_step *step) {
    twins *t = user;
    vk_view *v = gpu_of(t);
    size_t blocks = noc_vk_step_rays(step, v->b.blocks_x, v->b.blocks_y) / BLOCK;
    rayblock *rays = noc_alloc_large(blocks, sizeof(*rays));
    uint32_t(*answers)[BLOCK] = noc_alloc_large(blocks, sizeof(*answers));
    uint32_t(*hits)[5][BLOCK] = noc_alloc_large(blocks, sizeof(*hits));
    float(*through)[BLOCK] = noc_calloc(blocks, sizeof(*through));
    uint32_t key[BLOCK];
    assert_true(rays && answers && hits && through);
    bool closest = step->shader == VK_SHADER_trace_closest || step->shader == VK_SHADER_trace_meeting;
    bool weakens = step->shader == VK_SHADER_trace_through;
    assert_true(v->scene->lets_through || step->shader == VK_SHADER_trace_closest ||
                step->shader == VK_SHADER_trace_occlusion); /* scenes without panes have none of it */
    hit_numbers numbers = { NULL, NULL };
    if (closest)
        numbers = find_numbers(v->world);
    TRY(noc_vk_read(v->device, &v->b.rays, 0, rays, blocks * sizeof(*rays)));
    TRY(noc_vk_read(v->device, &v->b.answers, 0, answers, blocks * sizeof(*answers)));
    for (size_t i = 0; i < blocks; i++) {
        keys_of(v, i, key);
        if (closest)
            answer_closest(t, &numbers, &rays[i], key, answers[i], hits[i]);
        else if (weakens)
            answer_through(t, &rays[i], answers[i], through[i]);
        else
            answer_occlusion(t, step->past, &rays[i], answers[i]);
    }
    if (closest)
        TRY(noc_vk_write(v->device, &v->b.hits, 0, hits, blocks * sizeof(*hits)));
    else if (weakens)
        TRY(noc_vk_write(v->device, &v->b.through, 0, through, blocks * sizeof(*through)));
    else
        TRY(noc_vk_write(v->device, &v->b.answers, 0, answers, blocks * sizeof(*answers)));
    free(rays);
    free(answers);
    free(hits);
    free(through);
    free(numbers.entry);
    free(numbers.at);
    return NOC_OK;
}

/* Returns true if a Vulkan device traces rays here; says why not. */
static inline bool has_vulkan(noc_log *log) {
    noc_device_info info;
    bool has = noc_device_find(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, &info, log) == NOC_OK;
    if (!has)
        print_message("# skipped: %s\n", noc_log_last_error(log));
    return has;
}

/* There must be a Vulkan device. */
static inline void open_twins(const noc_scene *scene, bool same_rays, noc_log *log, twins *t) {
    *t = (twins){ .cpu_device = noc_device_create(NULL, log),
                  .device = noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, log) };
    assert_true(t->cpu_device && t->device);
    t->cpu = noc_view_create(t->cpu_device, scene);
    t->gpu = noc_view_create(t->device, scene);
    assert_true(t->cpu && t->gpu);
    t->answerer = (vk_answerer){ answer_by_cpu, t };
    if (same_rays)
        gpu_of(t)->answerer = &t->answerer;
}

static inline void close_twins(twins *t) {
    noc_view_destroy(t->cpu);
    noc_view_destroy(t->gpu);
    noc_device_destroy(t->cpu_device);
    noc_device_destroy(t->device);
}

/* Words of a buffer of the picture's blocks, inside the picture, that differ. each: words a pixel. */
static inline size_t differing(const twins *t, const void *cpu, const vk_buffer *gpu, size_t each) {
    vk_view *v = gpu_of(t);
    size_t blocks = (size_t)v->b.blocks_x * v->b.blocks_y, bytes = blocks * each * BLOCK * 4, n = 0;
    uint32_t *device = noc_alloc_large(bytes / 4, 4);
    const uint32_t *host = cpu;
    assert_non_null(device);
    assert_int_equal(noc_vk_read(v->device, gpu, 0, device, bytes), NOC_OK);
    for (size_t i = 0; i < bytes / 4; i++) {
        size_t block = i / (each * BLOCK), l = i % BLOCK;
        int x = (int)(block % v->b.blocks_x) * 4 + (int)(l & 3), y = (int)(block / v->b.blocks_x) * 4 + (int)(l >> 2);
        bool off = x < v->b.width && y < v->b.height && host[i] != device[i];
        if (off && getenv("FIELDS") && n < 30)
            print_message("# pixel %d %d word %zu: %08x %08x  %g %g\n", x, y, i / BLOCK % each, host[i], device[i],
                          *(const float *)&host[i], *(float *)&device[i]);
        n += off;
    }
    free(device);
    return n;
}

#endif
