/* Buffers, and what goes between them and the host. Every buffer has an allocation of its own: there are some 60, where
 * each driver allows 4,096. What there is one a model of, shares buffers (blas.c). */
#include "backend/vulkan/vulkan.h"

#include <nocturne/text.h>

enum { READBACK_BYTES = 16 << 20, LARGE_BYTES = 64 << 20 };

static const VkMemoryPropertyFlags wanted[][2] = {
    /* the best, and what will do */
    [VK_PLACE_DEVICE] = { VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0 },
    [VK_PLACE_SHARED] = { VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
                              VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT },
    [VK_PLACE_READBACK] = { VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
                                VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT },
};

/* Returns the number of the first memory type with these flags, UINT32_MAX: none. */
static uint32_t memory_type(const vk_device *d, uint32_t types, VkMemoryPropertyFlags flags) {
    for (uint32_t i = 0; i < d->memory.memoryTypeCount; i++)
        if (types >> i & 1 && (d->memory.memoryTypes[i].propertyFlags & flags) == flags)
            return i;
    return UINT32_MAX;
}

static VkResult allocate(vk_device *d, vk_place place, vk_buffer *b) {
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(d->device, b->buffer, &need);
    uint32_t type = memory_type(d, need.memoryTypeBits, wanted[place][0]);
    VkMemoryAllocateFlagsInfo flags = { .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT };
    VkMemoryAllocateInfo info = { .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .pNext = &flags,
                                  .allocationSize = need.size,
                                  .memoryTypeIndex = type };
    if (noc_allocation_refused())
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkResult result =
        type == UINT32_MAX ? VK_ERROR_OUT_OF_DEVICE_MEMORY : vkAllocateMemory(d->device, &info, NULL, &b->memory);
    if (result == VK_SUCCESS)
        return result;
    info.memoryTypeIndex = memory_type(d, need.memoryTypeBits, wanted[place][1]);
    if (info.memoryTypeIndex == type || info.memoryTypeIndex == UINT32_MAX)
        return result;
    return vkAllocateMemory(d->device, &info, NULL, &b->memory);
}

/* Of the memory that buffers of the device lie in: all, and what is free of it as far as the driver tells. */
static void find_room(const vk_device *d, VkDeviceSize *all, VkDeviceSize *free) {
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT
    };
    VkPhysicalDeviceMemoryProperties2 now = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
                                              .pNext = &budget };
    uint32_t type = memory_type(d, UINT32_MAX, wanted[VK_PLACE_DEVICE][0]);
    uint32_t heap = type == UINT32_MAX ? 0 : d->memory.memoryTypes[type].heapIndex;
    *all = d->memory.memoryHeaps[heap].size;
    VkDeviceSize most = *all, used = d->bytes;
    if (d->budgeted) {
        vkGetPhysicalDeviceMemoryProperties2(d->physical, &now);
        most = NOC_MIN(most, budget.heapBudget[heap]);
        used = budget.heapUsage[heap];
    }
    *free = most > used ? most - used : 0;
}

VkDeviceSize noc_vk_free_bytes(const vk_device *d) {
    VkDeviceSize all, free;
    find_room(d, &all, &free);
    return NOC_MIN(free, all);
}

noc_status noc_vk_check_room(vk_device *d, VkDeviceSize bytes, VkDeviceSize given_back, const char *what) {
    VkDeviceSize all, free;
    char need[32], has[32], left[32];
    if (bytes < LARGE_BYTES)
        return NOC_OK;
    find_room(d, &all, &free);
    if (bytes <= free + given_back)
        return NOC_OK;
    return noc_error(d->log, NOC_ERR_MEMORY, "vulkan: %s, %s: out of device memory, %s of %s are free (%s)", what,
                     noc_text_bytes(need, bytes), noc_text_bytes(left, NOC_MIN(free + given_back, all)),
                     noc_text_bytes(has, all), d->name);
}

/* Before a buffer is asked for: drivers promise more than they have, and the machine dies of it later. */
static noc_status check_buffer(vk_device *d, VkDeviceSize bytes, const char *what) {
    char need[32], most[32];
    if (bytes <= d->largest)
        return noc_vk_check_room(d, bytes, 0, what);
    return noc_error(d->log, NOC_ERR_MEMORY, "vulkan: %s, %s: the device gives %s at once (%s)", what,
                     noc_text_bytes(need, bytes), noc_text_bytes(most, d->largest), d->name);
}

void noc_vk_free_buffer(vk_device *d, vk_buffer *b) {
    if (b->buffer && d->uploading)
        noc_vk_settle(d); /* what is recorded may write to it */
    if (b->buffer)
        vkDestroyBuffer(d->device, b->buffer, NULL);
    if (b->memory)
        vkFreeMemory(d->device, b->memory, NULL);
    if (b->address)
        d->bytes -= b->bytes;
    *b = (vk_buffer){ 0 };
}

noc_status noc_vk_make_buffer(vk_device *d, VkDeviceSize bytes, VkBufferUsageFlags usage, vk_place place,
                              const char *what, vk_buffer *b) {
    *b = (vk_buffer){ 0 };
    noc_status status = check_buffer(d, bytes, what);
    if (status != NOC_OK)
        return status;
    b->bytes = bytes;
    VkBufferCreateInfo info = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                .usage = usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                         VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                         VK_BUFFER_USAGE_TRANSFER_SRC_BIT };
    VkResult result = vkCreateBuffer(d->device, &info, NULL, &b->buffer);
    if (result == VK_SUCCESS)
        result = allocate(d, place, b);
    if (result == VK_SUCCESS)
        result = vkBindBufferMemory(d->device, b->buffer, b->memory, 0);
    if (result == VK_SUCCESS && place != VK_PLACE_DEVICE)
        result = vkMapMemory(d->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped);
    if (result != VK_SUCCESS) {
        char text[128], need[32];
        noc_vk_free_buffer(d, b);
        noc_snprintf(text, sizeof(text), "%s, %s", what, noc_text_bytes(need, bytes));
        return noc_vk_failed(d, result, text);
    }
    VkBufferDeviceAddressInfo address = { .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, .buffer = b->buffer };
    b->address = vkGetBufferDeviceAddress(d->device, &address);
    d->bytes += bytes;
    return NOC_OK;
}

noc_status noc_vk_memory_create(vk_device *d) {
    VkCommandBufferAllocateInfo info = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = d->commands,
                                         .commandBufferCount = 1 };
    VkFenceCreateInfo fence = { .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO };
    noc_status status =
        noc_vk_make_buffer(d, (VkDeviceSize)VK_UPLOADS * VK_UPLOAD_BYTES, 0, VK_PLACE_SHARED, "staging", &d->staging);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, READBACK_BYTES, 0, VK_PLACE_READBACK, "reading back", &d->readback);
    for (int i = 0; i < VK_UPLOADS && status == NOC_OK; i++) {
        VkResult result = vkAllocateCommandBuffers(d->device, &info, &d->uploads[i].commands);
        if (result == VK_SUCCESS)
            result = vkCreateFence(d->device, &fence, NULL, &d->uploads[i].fence);
        if (result != VK_SUCCESS)
            status = noc_vk_failed(d, result, "making commands");
    }
    return status;
}

void noc_vk_memory_destroy(vk_device *d) {
    for (int i = 0; i < VK_UPLOADS; i++)
        if (d->uploads[i].fence)
            vkDestroyFence(d->device, d->uploads[i].fence, NULL);
    noc_vk_free_buffer(d, &d->staging);
    noc_vk_free_buffer(d, &d->readback);
}

/* ---- uploads ---- */

void noc_vk_barrier(VkCommandBuffer commands) {
    VkMemoryBarrier barrier = { .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT };
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1,
                         &barrier, 0, NULL, 0, NULL);
}

static VkResult wait_for(vk_device *d, vk_upload *u) {
    VkResult result = u->pending ? vkWaitForFences(d->device, 1, &u->fence, VK_TRUE, UINT64_MAX) : VK_SUCCESS;
    u->pending = false;
    return result;
}

noc_status noc_vk_open_upload(vk_device *d, VkCommandBuffer *commands) {
    vk_upload *u = &d->uploads[d->upload];
    *commands = u->commands;
    if (d->uploading)
        return NOC_OK;
    VkCommandBufferBeginInfo begin = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT };
    VkResult result = wait_for(d, u);
    if (result == VK_SUCCESS)
        result = vkBeginCommandBuffer(u->commands, &begin);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "uploading");
    noc_vk_barrier(u->commands); /* frames in flight may still read what is written now */
    u->used = 0;
    d->uploading = true;
    return NOC_OK;
}

static VkResult submit_upload(vk_device *d) {
    vk_upload *u = &d->uploads[d->upload];
    if (!d->uploading)
        return VK_SUCCESS;
    noc_vk_barrier(u->commands);
    VkSubmitInfo submit = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &u->commands };
    VkResult result = vkEndCommandBuffer(u->commands);
    if (result == VK_SUCCESS)
        result = vkResetFences(d->device, 1, &u->fence);
    if (result == VK_SUCCESS)
        result = vkQueueSubmit(d->queue, 1, &submit, u->fence);
    d->uploading = false;
    u->pending = result == VK_SUCCESS;
    d->upload = (d->upload + 1) % VK_UPLOADS;
    return result;
}

noc_status noc_vk_submit_upload(vk_device *d) {
    VkResult result = submit_upload(d);
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(d, result, "uploading");
}

void noc_vk_settle(vk_device *d) {
    submit_upload(d);
    vkQueueWaitIdle(d->queue);
}

noc_status noc_vk_write(vk_device *d, const vk_buffer *to, VkDeviceSize at, const void *data, size_t bytes) {
    const char *from = data;
    while (bytes) {
        VkCommandBuffer commands;
        noc_status status = noc_vk_open_upload(d, &commands);
        if (status != NOC_OK)
            return status;
        vk_upload *u = &d->uploads[d->upload];
        VkDeviceSize place = (VkDeviceSize)d->upload * VK_UPLOAD_BYTES + u->used;
        size_t n = NOC_MIN(bytes, (size_t)(VK_UPLOAD_BYTES - u->used));
        if (n) {
            memcpy((char *)d->staging.mapped + place, from, n);
            vkCmdCopyBuffer(commands, d->staging.buffer, to->buffer, 1, &(VkBufferCopy){ place, at, n });
            u->used += (n + 15) / 16 * 16;
        }
        from += n;
        at += n;
        bytes -= n;
        if (bytes && (status = noc_vk_submit_upload(d)) != NOC_OK)
            return status;
    }
    return NOC_OK;
}

noc_status noc_vk_wait_idle(vk_device *d) {
    noc_status status = noc_vk_submit_upload(d);
    if (status != NOC_OK)
        return status;
    VkResult result = vkQueueWaitIdle(d->queue);
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(d, result, "waiting for the device");
}

noc_status noc_vk_read(vk_device *d, const vk_buffer *from, VkDeviceSize at, void *data, size_t bytes) {
    noc_status status = NOC_OK;
    for (size_t done = 0; done < bytes && status == NOC_OK;) {
        VkCommandBuffer commands;
        size_t n = NOC_MIN(bytes - done, (size_t)READBACK_BYTES);
        if ((status = noc_vk_open_upload(d, &commands)) != NOC_OK)
            break;
        vkCmdCopyBuffer(commands, from->buffer, d->readback.buffer, 1, &(VkBufferCopy){ at + done, 0, n });
        status = noc_vk_wait_idle(d);
        if (status == NOC_OK)
            memcpy((char *)data + done, d->readback.mapped, n);
        done += n;
    }
    return status;
}
