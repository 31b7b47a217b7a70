/* Bottom-level ray tracing structures (BLAS), each of some triangles. They are built in memory of their own and copied,
 * compacted, to where they stay. Small ones share buffers there, so that any number of models needs few of the
 * allocations that a driver allows. */
#include "backend/vulkan/vulkan.h"

static VkDeviceSize aligned(VkDeviceSize size, VkDeviceSize to) { return (size + to - 1) / to * to; }

/* ---- pieces of shared buffers ---- */

enum { PIECE_ALIGNMENT = 256, FIRST_CHUNK = 64 << 10, LARGEST_CHUNK = 8 << 20 };

void noc_vk_let_go_of_chunk(vk_device *d, vk_chunk *chunk) {
    if (!chunk || --chunk->holders)
        return;
    noc_vk_free_buffer(d, &chunk->buffer);
    free(chunk);
}

/* Returns a buffer of so many bytes that the caller holds, NULL after reporting why there is none. */
static vk_chunk *make_chunk(vk_device *d, VkDeviceSize bytes) {
    vk_chunk *chunk = noc_calloc(1, sizeof(*chunk));
    if (!chunk) {
        noc_no_memory(d->log, "vulkan");
        return NULL;
    }
    chunk->holders = 1;
    if (noc_vk_make_buffer(d, bytes, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR, VK_PLACE_DEVICE,
                           "the ray tracing structure", &chunk->buffer) == NOC_OK)
        return chunk;
    free(chunk);
    return NULL;
}

/* The open chunk, from which pieces are cut, is one with room for so many bytes; each is twice as large as the last. */
static bool open_chunk(vk_device *d, vk_chunk **open, VkDeviceSize bytes) {
    VkDeviceSize last = *open ? (*open)->buffer.bytes : FIRST_CHUNK / 2;
    if (*open && (*open)->used + bytes <= last)
        return true;
    vk_chunk *chunk = make_chunk(d, NOC_MAX(bytes, NOC_MIN(2 * last, (VkDeviceSize)LARGEST_CHUNK)));
    if (!chunk)
        return false;
    noc_vk_let_go_of_chunk(d, *open);
    *open = chunk;
    return true;
}

/* A large piece has a buffer of its own. */
static noc_status cut_piece(vk_device *d, vk_chunk **open, VkDeviceSize bytes, vk_piece *piece) {
    if (bytes >= LARGEST_CHUNK / 8) {
        vk_chunk *chunk = make_chunk(d, bytes);
        *piece = (vk_piece){ chunk, 0, bytes };
        return chunk ? NOC_OK : NOC_ERR_MEMORY;
    }
    if (!open_chunk(d, open, bytes))
        return NOC_ERR_MEMORY;
    *piece = (vk_piece){ *open, (*open)->used, bytes };
    (*open)->holders++;
    (*open)->used = aligned((*open)->used + bytes, PIECE_ALIGNMENT);
    return NOC_OK;
}

VkDeviceAddress noc_vk_piece_address(const vk_piece *p) { return p->chunk->buffer.address + p->at; }

void noc_vk_free_blas(vk_device *d, vk_blas *b) {
    if (b->structure)
        vkDestroyAccelerationStructureKHR(d->device, b->structure, NULL);
    noc_vk_let_go_of_chunk(d, b->store.chunk);
    noc_vk_let_go_of_chunk(d, b->order.chunk);
}

/* ---- the order of triangles ---- */

/* Sorts numbers of triangles so that halves of any run of 2^n of them lie apart along the run's longest axis. A
 * builder that splits runs in the middle without looking, as Mesa's software device does, then makes a good tree. */
typedef struct sorting {
    const float (*centres)[3]; /* of triangles, three times */
    uint32_t *order;
} sorting;

static int widest_axis(const sorting *s, size_t first, size_t end) {
    float lo[3] = { 3e38f, 3e38f, 3e38f }, hi[3] = { -3e38f, -3e38f, -3e38f };
    for (size_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], s->centres[s->order[i]][k]);
            hi[k] = NOC_MAX(hi[k], s->centres[s->order[i]][k]);
        }
    int axis = hi[1] - lo[1] > hi[0] - lo[0];
    return hi[2] - lo[2] > hi[axis] - lo[axis] ? 2 : axis;
}

/* Moves the triangles of first to end so that none before `middle` lies behind one from there on (Hoare's selection).
 */
static void split_at(const sorting *s, size_t first, size_t end, size_t middle, int axis) {
    ptrdiff_t low = (ptrdiff_t)first, high = (ptrdiff_t)end - 1, at = (ptrdiff_t)middle;
    while (low < high) {
        float pivot = s->centres[s->order[low + (high - low) / 2]][axis];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (s->centres[s->order[i]][axis] < pivot)
                i++;
            while (s->centres[s->order[j]][axis] > pivot)
                j--;
            if (i > j)
                break;
            uint32_t t = s->order[i];
            s->order[i++] = s->order[j];
            s->order[j--] = t;
        }
        if (at > j && at < i)
            return;
        if (at <= j)
            high = j;
        else
            low = i;
    }
}

static void sort_run(const sorting *s, size_t first, size_t end) {
    while (end - first > 2) {
        size_t middle = first + (end - first) / 2;
        split_at(s, first, end, middle, widest_axis(s, first, end));
        sort_run(s, first, middle);
        first = middle;
    }
}

/* Sorts the order of a part's triangles for a builder that does not. */
static noc_status sort_triangles(vk_world *w, uint32_t *order, size_t count) {
    const noc_scene *s = w->scene;
    uint32_t *numbers = noc_alloc_large(count, sizeof(*numbers)), *copy = noc_alloc_large(count, sizeof(*copy));
    float(*centres)[3] = noc_alloc_large(count, sizeof(*centres));
    bool ok = numbers && copy && centres;
    for (size_t i = 0; ok && i < count; i++) {
        const uint32_t *v = s->indices.data + 3 * (size_t)order[i];
        numbers[i] = (uint32_t)i;
        copy[i] = order[i];
        for (int k = 0; k < 3; k++)
            centres[i][k] = s->positions.data[3 * (size_t)v[0] + (size_t)k] +
                            s->positions.data[3 * (size_t)v[1] + (size_t)k] +
                            s->positions.data[3 * (size_t)v[2] + (size_t)k];
    }
    if (ok)
        sort_run(&(sorting){ (const float(*)[3])centres, numbers }, 0, count);
    for (size_t i = 0; ok && i < count; i++)
        order[i] = copy[numbers[i]];
    free(numbers);
    free(copy);
    free(centres);
    return ok ? NOC_OK : noc_no_memory(w->log, "vulkan");
}

/* ---- building ---- */

noc_status noc_vk_make_structure(vk_device *d, VkAccelerationStructureTypeKHR type, const vk_buffer *store,
                                 VkDeviceSize at, VkDeviceSize bytes, VkAccelerationStructureKHR *structure,
                                 VkDeviceAddress *address) {
    VkAccelerationStructureCreateInfoKHR info = { .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
                                                  .buffer = store->buffer,
                                                  .offset = at,
                                                  .size = bytes,
                                                  .type = type };
    VkResult result = vkCreateAccelerationStructureKHR(d->device, &info, NULL, structure);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "the ray tracing structure");
    VkAccelerationStructureDeviceAddressInfoKHR of = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, .accelerationStructure = *structure
    };
    *address = vkGetAccelerationStructureDeviceAddressKHR(d->device, &of);
    return NOC_OK;
}

/* What a build of one BLAS needs until it is done. */
typedef struct building {
    vk_buffer indices, scratch, store;
    VkAccelerationStructureKHR structure; /* as it is built */
    VkQueryPool query;
    VkAccelerationStructureGeometryKHR geometry;
    VkAccelerationStructureBuildGeometryInfoKHR info;
    VkAccelerationStructureBuildRangeInfoKHR range;
} building;

static void free_building(vk_device *d, building *b) {
    noc_vk_free_buffer(d, &b->indices);
    noc_vk_free_buffer(d, &b->scratch);
    if (b->structure)
        vkDestroyAccelerationStructureKHR(d->device, b->structure, NULL);
    noc_vk_free_buffer(d, &b->store);
    if (b->query)
        vkDestroyQueryPool(d->device, b->query, NULL);
}

/* Uploads the corners of `count` triangles in their order, and the order itself. */
static noc_status upload_triangles(vk_world *w, const uint32_t *order, size_t count, vk_blas *blas, building *b) {
    vk_device *d = w->device;
    noc_status status = cut_piece(d, &w->structure.open, 4 * (VkDeviceSize)count, &blas->order);
    if (status == NOC_OK)
        status = noc_vk_write(d, &blas->order.chunk->buffer, blas->order.at, order, 4 * count);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, 12 * (VkDeviceSize)count,
                                    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR,
                                    VK_PLACE_DEVICE, "triangles", &b->indices);
    enum { RUN = 4096 };
    uint32_t corners[RUN][3];
    for (size_t first = 0; first < count && status == NOC_OK; first += RUN) {
        size_t n = NOC_MIN(count - first, (size_t)RUN);
        for (size_t i = 0; i < n; i++)
            memcpy(corners[i], w->scene->indices.data + 3 * (size_t)order[first + i], sizeof(corners[i]));
        status = noc_vk_write(d, &b->indices, 12 * (VkDeviceSize)first, corners, 12 * n);
    }
    return status;
}

/* Opaque triangles call no any-hit shader; others call it once each. */
static void describe_build(const vk_world *w, vk_layer layer, size_t count, building *b) {
    b->geometry = (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .flags =
            layer == VK_LAYER_SOLID ? VK_GEOMETRY_OPAQUE_BIT_KHR : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR,
        .geometry.triangles = { .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
                                .vertexFormat = VK_FORMAT_R32G32B32_SFLOAT,
                                .vertexData.deviceAddress = w->positions.buffer.address,
                                .vertexStride = 12,
                                .maxVertex = (uint32_t)(w->scene->positions.len / 3 - 1),
                                .indexType = VK_INDEX_TYPE_UINT32,
                                .indexData.deviceAddress = b->indices.address },
    };
    b->info = (VkAccelerationStructureBuildGeometryInfoKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR,
        .flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR |
                 VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR,
        .mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR,
        .geometryCount = 1,
        .pGeometries = &b->geometry,
    };
    b->range = (VkAccelerationStructureBuildRangeInfoKHR){ .primitiveCount = (uint32_t)count };
}

/* Builds, and asks for the size that the structure needs. */
static noc_status build(vk_world *w, vk_layer layer, size_t count, building *b) {
    vk_device *d = w->device;
    VkDeviceSize align = NOC_MAX(d->structures.minAccelerationStructureScratchOffsetAlignment, 1);
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR
    };
    describe_build(w, layer, count, b);
    vkGetAccelerationStructureBuildSizesKHR(d->device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &b->info,
                                            &b->range.primitiveCount, &sizes);
    VkDeviceAddress address;
    noc_status status =
        noc_vk_make_buffer(d, sizes.accelerationStructureSize, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR,
                           VK_PLACE_DEVICE, "building the ray tracing structure", &b->store);
    if (status == NOC_OK)
        status = noc_vk_make_structure(d, b->info.type, &b->store, 0, b->store.bytes, &b->structure, &address);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, sizes.buildScratchSize + align, 0, VK_PLACE_DEVICE,
                                    "building the ray tracing structure", &b->scratch);
    VkQueryPoolCreateInfo query = { .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                    .queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR,
                                    .queryCount = 1 };
    VkCommandBuffer commands;
    VkResult result = status == NOC_OK ? vkCreateQueryPool(d->device, &query, NULL, &b->query) : VK_SUCCESS;
    if (result != VK_SUCCESS)
        status = noc_vk_failed(d, result, "building the ray tracing structure");
    if (status == NOC_OK)
        status = noc_vk_open_upload(d, &commands);
    if (status != NOC_OK)
        return status;
    b->info.dstAccelerationStructure = b->structure;
    b->info.scratchData.deviceAddress = aligned(b->scratch.address, align);
    const VkAccelerationStructureBuildRangeInfoKHR *range = &b->range;
    noc_vk_barrier(commands);
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &b->info, &range);
    noc_vk_barrier(commands);
    vkCmdResetQueryPool(commands, b->query, 0, 1);
    vkCmdWriteAccelerationStructuresPropertiesKHR(commands, 1, &b->structure, query.queryType, b->query, 0);
    return noc_vk_wait_idle(d);
}

/* Copies what was built to where it stays, in the size that it needs. */
static noc_status compact(vk_world *w, const building *b, vk_blas *blas) {
    vk_device *d = w->device;
    VkDeviceSize need = 0;
    VkCommandBuffer commands;
    VkResult result = vkGetQueryPoolResults(d->device, b->query, 0, 1, sizeof(need), &need, sizeof(need),
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "building the ray tracing structure");
    noc_status status = cut_piece(d, &w->structure.open, need ? need : b->store.bytes, &blas->store);
    if (status == NOC_OK)
        status = noc_vk_make_structure(d, b->info.type, &blas->store.chunk->buffer, blas->store.at, blas->store.bytes,
                                       &blas->structure, &blas->address);
    if (status == NOC_OK)
        status = noc_vk_open_upload(d, &commands);
    if (status != NOC_OK)
        return status;
    VkCopyAccelerationStructureInfoKHR copy = { .sType = VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR,
                                                .src = b->structure,
                                                .dst = blas->structure,
                                                .mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR };
    vkCmdCopyAccelerationStructureKHR(commands, &copy);
    return noc_vk_wait_idle(d);
}

noc_status noc_vk_build_blas(vk_world *w, vk_layer layer, uint32_t *order, size_t count, vk_blas_list *list) {
    vk_device *d = w->device;
    building b = { 0 };
    if (!array_push(list, (vk_blas){ 0 }))
        return noc_no_memory(w->log, "vulkan");
    vk_blas *blas = &list->data[list->len - 1];
    noc_status status = d->software ? sort_triangles(w, order, count) : NOC_OK;
    if (status == NOC_OK)
        status = upload_triangles(w, order, count, blas, &b);
    if (status == NOC_OK)
        status = build(w, layer, count, &b);
    if (status == NOC_OK)
        status = compact(w, &b, blas);
    free_building(d, &b);
    return status;
}
