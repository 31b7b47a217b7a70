/* The trace floor: rays of a frame are copied before they are traced, and traced again by themselves. */
#include "backend/vulkan/vulkan.h"

void noc_vk_forget_rays(vk_view *v) {
    for (size_t i = 0; i < v->kept.len; i++) {
        noc_vk_free_buffer(v->device, &v->kept.data[i].rays);
        noc_vk_free_buffer(v->device, &v->kept.data[i].answers);
    }
    array_free(&v->kept);
}

static noc_status copy(vk_view *v, VkCommandBuffer commands, const vk_buffer *from, VkDeviceSize bytes, vk_buffer *to) {
    noc_status status = noc_vk_make_buffer(v->device, bytes, 0, VK_PLACE_DEVICE, "keeping the rays of a frame", to);
    if (status == NOC_OK)
        vkCmdCopyBuffer(commands, from->buffer, to->buffer, 1, &(VkBufferCopy){ .size = bytes });
    return status;
}

noc_status noc_vk_keep_rays(vk_view *v, const vk_step *step) {
    VkCommandBuffer commands = v->flights[v->flight].commands;
    VkDeviceSize slots = noc_vk_step_rays(step, v->b.blocks_x, v->b.blocks_y);
    if (!array_push(&v->kept, (vk_kept_rays){ .step = *step }))
        return noc_no_memory(v->log, "render");
    vk_kept_rays *kept = &v->kept.data[v->kept.len - 1];
    noc_vk_barrier(commands);
    noc_status status = copy(v, commands, &v->b.rays, slots * sizeof(rayblock) / BLOCK, &kept->rays);
    if (status == NOC_OK)
        status = copy(v, commands, &v->b.answers, slots * 4, &kept->answers);
    noc_vk_barrier(commands);
    return status;
}

void noc_vk_record(void *view, bool on) {
    vk_view *v = view;
    v->recording = on;
    if (!on)
        return;
    pthread_mutex_lock(&v->device->lock);
    noc_vk_finish_flights(v);
    noc_vk_forget_rays(v);
    pthread_mutex_unlock(&v->device->lock);
}

noc_status noc_vk_replay(void *view, const noc_progress *progress, noc_trace_floor *floor) {
    vk_view *v = view;
    pthread_mutex_lock(&v->device->lock);
    noc_status status = noc_vk_finish_flights(v);
    if (status == NOC_OK && floor)
        status = noc_vk_trace_kept(v, progress, floor);
    noc_vk_forget_rays(v);
    pthread_mutex_unlock(&v->device->lock);
    return status;
}
