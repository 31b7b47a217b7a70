/* A view: the buffers of its picture on the device. */
#include "backend/vulkan/vulkan.h"
#include "core/presample_limits.h"

#include <math.h>
#include <nocturne/text.h>

/* Bytes a pixel of each kind of buffer, by the records that shaders use. */
enum {
    SURFACE_BYTES = sizeof(gblock) / BLOCK,
    RESERVOIR_BYTES = sizeof(rblock) / BLOCK,
    COLOUR_BYTES = sizeof(cblock) / BLOCK,
    RAY_BYTES = sizeof(rayblock) / BLOCK,
    ANSWER_BYTES = 4,
    THROUGH_BYTES = 4,
    HIT_BYTES = 20, /* triangle, entry, u, v, t */
    COVERAGE_BYTES = 16,
};

size_t noc_vk_bytes_a_pixel(int sets, uint32_t aovs) {
    (void)sets;
    return noc_vk_views_bytes(aovs) + COLOUR_BYTES + COVERAGE_BYTES;
}

static void free_picture(vk_device *d, vk_picture *b) {
    vk_buffer *const buffers[] = { &b->surfaces[0],   &b->surfaces[1], &b->colour,        &b->picture,
                                   &b->coverage,      &b->rays,        &b->answers,       &b->through,
                                   &b->hits,          &b->instance,    &b->reservoirs[0], &b->reservoirs[1],
                                   &b->reservoirs[2], &b->visible[0],  &b->visible[1],    &b->visible[2] };
    for (size_t i = 0; i < NOC_COUNT(buffers); i++)
        noc_vk_free_buffer(d, buffers[i]);
    *b = (vk_picture){ 0 };
}

static size_t slots_of(const vk_picture *b) { return (size_t)b->blocks_x * b->blocks_y * BLOCK; }

/* What a picture takes whatever its method is, without reservoirs. */
enum { FIXED_BYTES = 2 * SURFACE_BYTES + 2 * COLOUR_BYTES + COVERAGE_BYTES + RAY_BYTES + ANSWER_BYTES + HIT_BYTES };
enum { PICTURE_TEXT = 96 };

/* A picture of this size, for messages: with one of its shape that the device has memory for, where it has not enough
 * for it. An eighth is left to what depends on the plan. given_back: bytes that this view frees before. */
static void describe_picture(const vk_view *v, int width, int height, int sets, VkDeviceSize given_back,
                             char text[PICTURE_TEXT]) {
    const vk_device *d = v->device;
    double room = (double)(noc_vk_free_bytes(d) + given_back) * 7 / 8 / (FIXED_BYTES + sets * (RESERVOIR_BYTES + 4));
    double pixels = NOC_MIN(room, (double)d->largest / SURFACE_BYTES);
    double scale = sqrt(pixels / ((double)width * (double)height));
    int fits_wide = (int)(width * scale) & ~3, fits_high = (int)(height * scale) & ~3;
    if (scale < 1 && fits_wide && fits_high)
        noc_snprintf(text, PICTURE_TEXT, "a picture of %d x %d (%d x %d would fit)", width, height, fits_wide,
                     fits_high);
    else
        noc_snprintf(text, PICTURE_TEXT, "a picture of %d x %d", width, height);
}

/* A buffer of the picture: `each` bytes a pixel. */
static noc_status make(vk_view *v, size_t each, vk_buffer *out) {
    char what[PICTURE_TEXT];
    describe_picture(v, v->b.width, v->b.height, v->b.sets, v->b.bytes, what);
    noc_status status = noc_vk_make_buffer(v->device, slots_of(&v->b) * each, 0, VK_PLACE_DEVICE, what, out);
    v->b.bytes += status == NOC_OK ? slots_of(&v->b) * each : 0;
    return status;
}

static noc_status make_picture(vk_view *v) {
    vk_picture *b = &v->b;
    const struct {
        vk_buffer *buffer;
        size_t bytes;
    } all[] = { { &b->surfaces[0], SURFACE_BYTES }, { &b->surfaces[1], SURFACE_BYTES }, { &b->colour, COLOUR_BYTES },
                { &b->picture, COLOUR_BYTES },      { &b->coverage, COVERAGE_BYTES },   { &b->hits, HIT_BYTES } };
    noc_status status = NOC_OK;
    for (size_t i = 0; i < NOC_COUNT(all) && status == NOC_OK; i++)
        status = make(v, all[i].bytes, all[i].buffer);
    return status;
}

/* What the device must have for a picture of this size and the rays of its pixels. Other rays and scratch are a matter
 * of the plan. */
static noc_status check_room(const vk_view *v, int width, int height, int sets) {
    const vk_picture *b = &v->b;
    bool other = b->width != width || b->height != height;
    size_t pixels = (((size_t)width + 3) & ~(size_t)3) * (((size_t)height + 3) & ~(size_t)3);
    size_t each = (other ? FIXED_BYTES : 0) + (size_t)(sets - (other ? 0 : b->sets)) * (RESERVOIR_BYTES + 4);
    char what[PICTURE_TEXT];
    describe_picture(v, width, height, sets, b->bytes, what);
    return noc_vk_check_room(v->device, pixels * each, other ? b->bytes : 0, what);
}

static noc_status resize(vk_view *v, int width, int height, int sets) {
    vk_picture *b = &v->b;
    noc_status status = noc_vk_finish_flights(v);
    if (status == NOC_OK)
        status = check_room(v, width, height, sets);
    if (status != NOC_OK)
        return status;
    if (b->width != width || b->height != height) {
        free_picture(v->device, b);
        noc_vk_views_free(v);
        noc_vk_free_mean(v);
        b->width = width;
        b->height = height;
        b->blocks_x = ((uint32_t)width + BLOCK_SIDE - 1) / BLOCK_SIDE;
        b->blocks_y = ((uint32_t)height + BLOCK_SIDE - 1) / BLOCK_SIDE;
        status = make_picture(v);
    }
    for (; b->sets < sets && status == NOC_OK; b->sets++) {
        status = make(v, RESERVOIR_BYTES, &b->reservoirs[b->sets]);
        if (status == NOC_OK)
            status = make(v, 4, &b->visible[b->sets]);
    }
    if (status != NOC_OK)
        free_picture(v->device, b);
    return status;
}

noc_status noc_vk_view_resize(void *view, int width, int height, int sets) {
    vk_view *v = view;
    noc_status status = noc_vk_enter(v->device);
    if (status != NOC_OK)
        return status;
    status = resize(v, width, height, sets);
    pthread_mutex_unlock(&v->device->lock);
    return status;
}

/* Bytes of a ray and its answers. */
static size_t bytes_a_ray(const vk_picture *b) {
    return RAY_BYTES + ANSWER_BYTES + (b->through.bytes ? THROUGH_BYTES : 0);
}

static noc_status fit_rays(vk_view *v, size_t rays) {
    vk_picture *b = &v->b;
    noc_status status = noc_vk_finish_flights(v);
    b->bytes -= b->ray_room * bytes_a_ray(b);
    noc_vk_free_buffer(v->device, &b->rays);
    noc_vk_free_buffer(v->device, &b->answers);
    noc_vk_free_buffer(v->device, &b->through);
    b->ray_room = 0;
    if (status == NOC_OK)
        status = noc_vk_make_buffer(v->device, rays * RAY_BYTES, 0, VK_PLACE_DEVICE, "the rays of a frame", &b->rays);
    if (status == NOC_OK)
        status =
            noc_vk_make_buffer(v->device, rays * ANSWER_BYTES, 0, VK_PLACE_DEVICE, "the rays of a frame", &b->answers);
    if (status == NOC_OK && v->scene->lets_through)
        status =
            noc_vk_make_buffer(v->device, rays * THROUGH_BYTES, 0, VK_PLACE_DEVICE, "the rays of a frame", &b->through);
    if (status != NOC_OK)
        return status;
    b->ray_room = rays;
    b->bytes += rays * bytes_a_ray(b);
    return NOC_OK;
}

noc_status noc_vk_fit_buffer(vk_view *v, size_t bytes, const char *what, vk_buffer *b) {
    if (b->bytes >= bytes)
        return NOC_OK;
    noc_status status = noc_vk_finish_flights(v);
    noc_vk_free_buffer(v->device, b);
    return status == NOC_OK ? noc_vk_make_buffer(v->device, bytes, 0, VK_PLACE_DEVICE, what, b) : status;
}

/* Scratch is that of one band: where it is the least that there is, it grows with the picture's width alone. */
static noc_status check_scratch(const vk_view *v, size_t scratch) {
    enum { A_TILE = 16, SPARE = 8 << 20 }; /* px; bytes that do not depend on the width */
    VkDeviceSize most = NOC_MIN(v->device->largest, noc_vk_free_bytes(v->device) + v->scratch.bytes);
    char need[32], has[32];
    if (scratch <= NOC_MAX(most, v->device->band_bytes))
        return NOC_OK;
    int wide = (int)((double)v->b.width * ((double)most - SPARE) / (double)scratch) / A_TILE * A_TILE;
    return noc_error(
        v->log, NOC_ERR_MEMORY,
        "vulkan: a picture of %d x %d with these options needs %s at once, the device has %s: one that is %d "
        "wide would fit (%s)",
        v->b.width, v->b.height, noc_text_bytes(need, scratch), noc_text_bytes(has, most), NOC_MAX(wide, A_TILE),
        v->device->name);
}

noc_status noc_vk_view_fit(vk_view *v, size_t rays, size_t scratch) {
    vk_picture *b = &v->b;
    noc_status status = check_scratch(v, scratch);
    size_t most = v->device->rays.maxRayDispatchInvocationCount;
    if (status != NOC_OK)
        return status;
    if (rays > most) /* one a pixel: bands have no more */
        return noc_error(v->log, NOC_ERR_MEMORY,
                         "vulkan: a picture of %d x %d has more pixels than the device traces rays at once, %zu",
                         b->width, b->height, most);
    if (b->ray_room < rays || (v->scene->lets_through && !b->through.bytes))
        status = fit_rays(v, NOC_MAX(rays, b->ray_room));
    if (status == NOC_OK)
        status = noc_vk_fit_buffer(v, scratch, "scratch of a frame", &v->scratch);
    if (status == NOC_OK && v->scene->instances.len && !b->instance.bytes)
        status = make(v, 4, &b->instance);
    return status;
}

/* Lights that the frame before did not have are dark in it. */
static noc_status grow_past(vk_view *v, size_t room) {
    vk_device *d = v->device;
    vk_buffer more;
    VkCommandBuffer commands;
    VkDeviceSize have = v->past.filled ? v->past.room * sizeof(light_record) : 0;
    noc_status status =
        noc_vk_make_buffer(d, room * sizeof(light_record), 0, VK_PLACE_DEVICE, "the previous frame's lights", &more);
    if (status != NOC_OK)
        return status;
    if ((status = noc_vk_open_upload(d, &commands)) != NOC_OK) {
        noc_vk_free_buffer(d, &more);
        return status;
    }
    vkCmdFillBuffer(commands, more.buffer, 0, VK_WHOLE_SIZE, 0);
    noc_vk_barrier(commands);
    if (have)
        vkCmdCopyBuffer(commands, v->past_lights.buffer, more.buffer, 1, &(VkBufferCopy){ .size = have });
    status = noc_vk_wait_idle(d);
    noc_vk_free_buffer(d, status == NOC_OK ? &v->past_lights : &more);
    if (status != NOC_OK)
        return status;
    v->past_lights = more;
    v->past.room = room;
    return NOC_OK;
}

noc_status noc_vk_view_begin_past(vk_view *v, const noc_plan *plan) {
    size_t room = noc_past_begin(&v->past, v->scene, plan);
    noc_status status = room > v->past.room ? grow_past(v, room) : NOC_OK;
    noc_past_check(&v->past, v->scene, &v->world->placings, plan);
    return status;
}

noc_status noc_vk_view_fit_samples(vk_view *v, uint32_t rows) {
    enum { ROW_BYTES = 17 * 4 * BLOCK }; /* sample_row of the shaders */
    v->subsets = presample_subsets(rows, v->b.blocks_x * v->b.blocks_y);
    v->subset_rows = rows;
    if (v->samples.bytes)
        return NOC_OK;
    return noc_vk_make_buffer(v->device, PRESAMPLES / BLOCK * ROW_BYTES, 0, VK_PLACE_DEVICE, "candidates", &v->samples);
}

/* ---- views ---- */

static void free_flight(vk_device *d, vk_flight *f) {
    if (f->fence)
        vkDestroyFence(d->device, f->fence, NULL);
    if (f->times)
        vkDestroyQueryPool(d->device, f->times, NULL);
    if (f->commands)
        vkFreeCommandBuffers(d->device, d->commands, 1, &f->commands);
    noc_vk_free_buffer(d, &f->constants);
    noc_vk_free_buffer(d, &f->counts);
}

static noc_status make_flight(vk_device *d, vk_flight *f) {
    VkCommandBufferAllocateInfo commands = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = d->commands,
                                             .commandBufferCount = 1 };
    VkFenceCreateInfo fence = { .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO };
    VkQueryPoolCreateInfo times = { .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                    .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                    .queryCount = VK_STEPS + 1 };
    VkResult result = vkAllocateCommandBuffers(d->device, &commands, &f->commands);
    if (result == VK_SUCCESS)
        result = vkCreateFence(d->device, &fence, NULL, &f->fence);
    if (result == VK_SUCCESS)
        result = vkCreateQueryPool(d->device, &times, NULL, &f->times);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "making a view");
    noc_status status = noc_vk_make_buffer(d, VK_CONSTANTS_BYTES + VK_STEPS * sizeof(vk_binding), 0, VK_PLACE_SHARED,
                                           "a view", &f->constants);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, VK_COUNT_KINDS * VK_COUNTERS * 4, 0, VK_PLACE_READBACK, "a view", &f->counts);
    return status;
}

static void destroy(vk_view *v) {
    vk_device *d = v->device;
    noc_vk_finish_flights(v);
    noc_vk_settle(d);
    for (int i = 0; i < VK_FRAMES; i++)
        free_flight(d, &v->flights[i]);
    free_picture(d, &v->b);
    noc_vk_views_free(v);
    noc_vk_free_mean(v);
    noc_vk_forget_rays(v);
    noc_vk_free_buffer(d, &v->samples);
    noc_vk_free_buffer(d, &v->found);
    noc_vk_free_buffer(d, &v->scratch);
    noc_vk_free_learning(v);
    noc_vk_free_buffer(d, &v->given);
    array_free(&v->steps);
    noc_vk_free_buffer(d, &v->counters);
    noc_vk_free_buffer(d, &v->past_lights);
}

void noc_vk_view_destroy(void *view) {
    vk_view *v = view;
    if (!v)
        return;
    noc_vk_forget_host_view(v);
    noc_light_set_release(v->world->lights_set, &v->sources);
    pthread_mutex_lock(&v->device->lock);
    destroy(v);
    pthread_mutex_unlock(&v->device->lock);
    free(v);
}

noc_status noc_vk_view_create(void *world, void **view) {
    vk_world *w = world;
    vk_device *d = w->device;
    vk_view *v = noc_calloc(1, sizeof(*v));
    if (!v)
        return noc_no_memory(w->log, "view");
    *v = (vk_view){ .world = w, .device = d, .scene = w->scene, .log = w->log };
    noc_status status = noc_vk_enter(d);
    if (status != NOC_OK) {
        free(v);
        return status;
    }
    status = noc_vk_make_buffer(d, VK_COUNT_KINDS * VK_COUNTERS * 4, 0, VK_PLACE_DEVICE, "a view", &v->counters);
    for (int i = 0; i < VK_FRAMES && status == NOC_OK; i++)
        status = make_flight(d, &v->flights[i]);
    pthread_mutex_unlock(&d->lock);
    if (status != NOC_OK) {
        noc_vk_view_destroy(v);
        return status;
    }
    *view = v;
    return NOC_OK;
}
