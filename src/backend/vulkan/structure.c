/* Ray tracing structures of a scene on the device, and how they follow its edits.
 *
 * Parts of the world and models are built as backend/parts.h plans them. A part is one bottom-level structure (BLAS),
 * or several where it has more triangles than a driver takes at once. Above them lies one TLAS of the parts of the
 * world and of the instances of models. It is built again whenever one of them changes, and never refitted: a build is
 * as fast, and traces faster. That of the scene before stays for rays of the past. */
#include "backend/vulkan/vulkan.h"

enum { BLAS_TRIANGLES = 8 << 20 };

static VkDeviceSize aligned(VkDeviceSize size, VkDeviceSize to) { return (size + to - 1) / to * to; }

static void free_blas(vk_device *d, vk_blas *b) {
    if (b->structure)
        vkDestroyAccelerationStructureKHR(d->device, b->structure, NULL);
    noc_vk_free_buffer(d, &b->store);
    noc_vk_free_buffer(d, &b->order);
}

/* Frames in flight may trace a part that goes: they are waited for. */
static void let_go(vk_device *d, vk_part *part) {
    if (!part || --part->holders)
        return;
    vkQueueWaitIdle(d->queue);
    for (size_t i = 0; i < part->blas.len; i++)
        free_blas(d, &part->blas.data[i]);
    array_free(&part->blas);
    free(part);
}

static vk_part *held(vk_part *part) {
    part->holders++;
    return part;
}

static void release_parts(vk_device *d, vk_parts *parts) {
    for (size_t i = 0; i < parts->len; i++)
        let_go(d, parts->data[i]);
    array_free(parts);
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

/* ---- bottom-level structures ---- */

static noc_status make_structure(vk_device *d, VkAccelerationStructureTypeKHR type, VkDeviceSize bytes,
                                 vk_buffer *store, VkAccelerationStructureKHR *structure, VkDeviceAddress *address) {
    noc_status status = noc_vk_make_buffer(d, bytes, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR,
                                           VK_PLACE_DEVICE, "the ray tracing structure", store);
    if (status != NOC_OK)
        return status;
    VkAccelerationStructureCreateInfoKHR info = { .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
                                                  .buffer = store->buffer,
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
    vk_buffer indices, scratch;
    VkQueryPool query;
    VkAccelerationStructureGeometryKHR geometry;
    VkAccelerationStructureBuildGeometryInfoKHR info;
    VkAccelerationStructureBuildRangeInfoKHR range;
} building;

static void free_building(vk_device *d, building *b) {
    noc_vk_free_buffer(d, &b->indices);
    noc_vk_free_buffer(d, &b->scratch);
    if (b->query)
        vkDestroyQueryPool(d->device, b->query, NULL);
}

/* Uploads the corners of `count` triangles in their order, and the order itself. */
static noc_status upload_triangles(vk_world *w, const uint32_t *order, size_t count, vk_blas *blas, building *b) {
    vk_device *d = w->device;
    noc_status status = noc_vk_make_buffer(d, 4 * (VkDeviceSize)count, 0, VK_PLACE_DEVICE, "triangles", &blas->order);
    if (status == NOC_OK)
        status = noc_vk_write(d, &blas->order, 0, order, 4 * count);
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

static void describe_build(const vk_world *w, size_t count, building *b) {
    b->geometry = (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .flags = VK_GEOMETRY_OPAQUE_BIT_KHR,
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

/* Builds into blas, and asks for the size that it could have. */
static noc_status record_build(vk_world *w, size_t count, vk_blas *blas, building *b) {
    vk_device *d = w->device;
    VkDeviceSize align = NOC_MAX(d->structures.minAccelerationStructureScratchOffsetAlignment, 1);
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR
    };
    describe_build(w, count, b);
    vkGetAccelerationStructureBuildSizesKHR(d->device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &b->info,
                                            &b->range.primitiveCount, &sizes);
    noc_status status = make_structure(d, b->info.type, sizes.accelerationStructureSize, &blas->store, &blas->structure,
                                       &blas->address);
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
    b->info.dstAccelerationStructure = blas->structure;
    b->info.scratchData.deviceAddress = aligned(b->scratch.address, align);
    const VkAccelerationStructureBuildRangeInfoKHR *range = &b->range;
    noc_vk_barrier(commands);
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &b->info, &range);
    noc_vk_barrier(commands);
    vkCmdResetQueryPool(commands, b->query, 0, 1);
    vkCmdWriteAccelerationStructuresPropertiesKHR(commands, 1, &blas->structure, query.queryType, b->query, 0);
    return noc_vk_wait_idle(d);
}

/* Copies blas to memory of the size that it needs, if that is less. */
static noc_status compact(vk_world *w, vk_blas *blas, const building *b) {
    vk_device *d = w->device;
    VkDeviceSize need = 0;
    VkCommandBuffer commands;
    vk_blas small = { .order = blas->order };
    VkResult result = vkGetQueryPoolResults(d->device, b->query, 0, 1, sizeof(need), &need, sizeof(need),
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "building the ray tracing structure");
    if (!need || need >= blas->store.bytes)
        return NOC_OK;
    noc_status status = make_structure(d, b->info.type, need, &small.store, &small.structure, &small.address);
    if (status == NOC_OK)
        status = noc_vk_open_upload(d, &commands);
    if (status == NOC_OK) {
        VkCopyAccelerationStructureInfoKHR copy = { .sType = VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR,
                                                    .src = blas->structure,
                                                    .dst = small.structure,
                                                    .mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR };
        vkCmdCopyAccelerationStructureKHR(commands, &copy);
        status = noc_vk_wait_idle(d);
    }
    vk_blas gone = status == NOC_OK ? *blas : small;
    gone.order = (vk_buffer){ 0 };
    free_blas(d, &gone);
    if (status == NOC_OK)
        *blas = small;
    return status;
}

static noc_status build_blas(vk_world *w, uint32_t *order, size_t count, vk_part *part) {
    vk_device *d = w->device;
    building b = { 0 };
    if (!array_push(&part->blas, (vk_blas){ 0 }))
        return noc_no_memory(w->log, "vulkan");
    vk_blas *blas = &part->blas.data[part->blas.len - 1];
    noc_status status = d->software ? sort_triangles(w, order, count) : NOC_OK;
    if (status == NOC_OK)
        status = upload_triangles(w, order, count, blas, &b);
    if (status == NOC_OK)
        status = record_build(w, count, blas, &b);
    if (status == NOC_OK)
        status = compact(w, blas, &b);
    if (status != NOC_OK)
        vkQueueWaitIdle(d->queue); /* before what it uses is freed */
    free_building(d, &b);
    return status;
}

/* The triangles of a part, as a BLAS each BLAS_TRIANGLES. */
static noc_status build_part(vk_world *w, uint32_t model, vk_part *part) {
    const noc_scene *scene = w->scene;
    size_t count = 0;
    noc_status status = NOC_OK;
    uint32_t *order = noc_alloc_large(NOC_MAX(part->of.triangles, (size_t)1), sizeof(*order));
    if (!order)
        return noc_no_memory(w->log, "vulkan");
    for (size_t i = part->of.first_mesh; i < part->of.end_mesh; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        for (uint32_t k = 0; k < m->triangle_count && noc_part_has(scene, m, model); k++)
            order[count++] = m->first_triangle + k;
    }
    for (size_t first = 0; first < count && status == NOC_OK; first += BLAS_TRIANGLES)
        status = build_blas(w, order + first, NOC_MIN(count - first, (size_t)BLAS_TRIANGLES), part);
    free(order);
    return status;
}

static noc_status make_part(vk_world *w, uint32_t model, size_t first, size_t end, vk_part **out) {
    vk_part *part = noc_calloc(1, sizeof(*part));
    if (!part)
        return noc_no_memory(w->log, "vulkan");
    part->of = (noc_part){ .first_mesh = first, .end_mesh = end };
    part->holders = 1;
    noc_part_count(w->scene, model, &part->of);
    noc_status status = build_part(w, model, part);
    if (status == NOC_OK)
        *out = part;
    else
        let_go(w->device, part);
    return status;
}

/* The world's parts as they are now: those that have not changed are held. */
static noc_status make_world(vk_world *w, vk_parts *out) {
    vk_structure *s = &w->structure;
    size_t count = s->world.len;
    noc_part *have = noc_calloc(count + 1, sizeof(*have)), *planned = noc_calloc(count + 1, sizeof(*planned));
    bool *keep = noc_calloc(count + 1, sizeof(*keep));
    bool ok = have && planned && keep && array_reserve(out, count + 1);
    noc_status status = ok ? NOC_OK : noc_no_memory(w->log, "vulkan");
    for (size_t i = 0; ok && i < count; i++) {
        have[i] = s->world.data[i]->of;
        keep[i] = true;
    }
    if (ok && !(count && s->geometry == w->scene->versions.geometry))
        count = noc_parts_plan(w->scene, have, count, planned, keep);
    for (size_t i = 0; status == NOC_OK && i < count; i++) {
        vk_part *part = keep[i] ? held(s->world.data[i]) : NULL;
        if (!part)
            status = make_part(w, 0, planned[i].first_mesh, planned[i].end_mesh, &part);
        if (status == NOC_OK)
            out->data[out->len++] = part;
    }
    free(have);
    free(planned);
    free(keep);
    return status;
}

/* The part of a model, built when an instance first shows it. */
static noc_status part_of_model(vk_world *w, uint32_t model, vk_part **out) {
    vk_structure *s = &w->structure;
    if (!array_reserve(&s->models, w->scene->models.len))
        return noc_no_memory(w->log, "vulkan");
    while (s->models.len < w->scene->models.len)
        s->models.data[s->models.len++] = NULL;
    vk_part **slot = &s->models.data[model - 1];
    noc_status status = *slot ? NOC_OK : make_part(w, model, 0, w->scene->meshes.len, slot);
    *out = *slot;
    return status;
}

/* ---- the top-level structure ---- */

typedef struct top {
    NOC_ARRAY(VkAccelerationStructureInstanceKHR) instances;
    NOC_ARRAY(vk_entry) entries;
    vk_parts held;
} top;

static void free_top(vk_device *d, top *t) {
    array_free(&t->instances);
    array_free(&t->entries);
    release_parts(d, &t->held);
}

static bool add_part(top *t, vk_part *part, uint32_t instance, const float transform[12]) {
    for (size_t i = 0; i < part->blas.len; i++) {
        const vk_blas *b = &part->blas.data[i];
        VkAccelerationStructureInstanceKHR in = { .instanceCustomIndex = (uint32_t)t->entries.len & 0xffffff,
                                                  .mask = 0xff,
                                                  .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
                                                  .accelerationStructureReference = b->address };
        memcpy(in.transform.matrix, transform, sizeof(in.transform.matrix));
        vk_entry entry = { b->order.address, instance, 0 };
        if (!array_push(&t->instances, in) || !array_push(&t->entries, entry))
            return false;
    }
    if (!array_push(&t->held, part))
        return false;
    held(part);
    return true;
}

static noc_status gather_top(vk_world *w, const vk_parts *world, top *t) {
    static const float standing[12] = { [0] = 1, [5] = 1, [10] = 1 };
    const noc_scene *scene = w->scene;
    noc_status status = NOC_OK;
    bool ok = true;
    for (size_t i = 0; ok && i < world->len; i++)
        ok = add_part(t, world->data[i], UINT32_MAX, standing);
    for (size_t i = 0; ok && i < scene->instances.len; i++) {
        const noc_scene_instance *in = &scene->instances.data[i];
        vk_part *part = NULL;
        if (!in->model)
            continue;
        if ((status = part_of_model(w, in->model, &part)) != NOC_OK)
            return status;
        ok = add_part(t, part, (uint32_t)i, in->transform);
    }
    if (!ok)
        return noc_no_memory(w->log, "vulkan");
    if (t->entries.len > NOC_MIN((uint64_t)1 << 24, w->device->structures.maxInstanceCount))
        return noc_error(w->log, NOC_ERR_MEMORY, "vulkan: %zu instances are more than the device takes",
                         t->entries.len);
    return NOC_OK;
}

static VkAccelerationStructureBuildGeometryInfoKHR top_info(const vk_structure *s,
                                                            VkAccelerationStructureGeometryKHR *geometry) {
    *geometry = (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
        .geometry.instances = { .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR,
                                .data.deviceAddress = s->instances.address },
    };
    return (VkAccelerationStructureBuildGeometryInfoKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR,
        .flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR,
        .mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR,
        .geometryCount = 1,
        .pGeometries = geometry,
    };
}

static void free_tlas(vk_device *d, vk_tlas *t) {
    if (t->structure)
        vkDestroyAccelerationStructureKHR(d->device, t->structure, NULL);
    t->structure = VK_NULL_HANDLE;
    t->room = 0;
    noc_vk_free_buffer(d, &t->store);
}

static void point_set_at(vk_device *d, const vk_tlas *t) {
    VkWriteDescriptorSetAccelerationStructureKHR structure = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR,
        .accelerationStructureCount = 1,
        .pAccelerationStructures = &t->structure,
    };
    VkWriteDescriptorSet write = { .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .pNext = &structure,
                                   .dstSet = t->set,
                                   .descriptorCount = 1,
                                   .descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR };
    vkUpdateDescriptorSets(d->device, 1, &write, 0, NULL);
}

/* Sees to it that instances, entries and scratch have room, and the TLAS itself. */
static noc_status make_room(vk_world *w, vk_tlas *t, uint32_t count) {
    vk_device *d = w->device;
    vk_structure *s = &w->structure;
    VkDeviceSize align = NOC_MAX(d->structures.minAccelerationStructureScratchOffsetAlignment, 1);
    uint32_t room = NOC_MAX(count + count / 4 + 1, NOC_MAX(s->tlas[0].room, s->tlas[1].room)); /* they share buffers */
    VkAccelerationStructureGeometryKHR geometry;
    VkAccelerationStructureBuildSizesInfoKHR sizes = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR
    };
    if (t->room >= count)
        return NOC_OK;
    noc_status status = noc_vk_wait_idle(d);
    if (status != NOC_OK)
        return status;
    noc_vk_free_buffer(d, &s->instances);
    noc_vk_free_buffer(d, &s->entries);
    noc_vk_free_buffer(d, &s->scratch);
    free_tlas(d, t);
    status = noc_vk_make_buffer(d, room * sizeof(VkAccelerationStructureInstanceKHR),
                                VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR, VK_PLACE_DEVICE,
                                "instances", &s->instances);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, room * sizeof(vk_entry), 0, VK_PLACE_DEVICE, "instances", &s->entries);
    VkAccelerationStructureBuildGeometryInfoKHR info = top_info(s, &geometry);
    vkGetAccelerationStructureBuildSizesKHR(d->device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &room,
                                            &sizes);
    VkDeviceAddress address;
    if (status == NOC_OK)
        status = make_structure(d, info.type, sizes.accelerationStructureSize, &t->store, &t->structure, &address);
    if (status == NOC_OK)
        status = noc_vk_make_buffer(d, sizes.buildScratchSize + align, 0, VK_PLACE_DEVICE,
                                    "building the ray tracing structure", &s->scratch);
    if (status != NOC_OK)
        return status;
    t->room = room;
    point_set_at(d, t);
    return NOC_OK;
}

static noc_status build_top(vk_world *w, const top *t, vk_tlas *to) {
    vk_device *d = w->device;
    vk_structure *s = &w->structure;
    VkDeviceSize align = NOC_MAX(d->structures.minAccelerationStructureScratchOffsetAlignment, 1);
    VkAccelerationStructureGeometryKHR geometry;
    VkCommandBuffer commands;
    noc_status status = make_room(w, to, (uint32_t)t->entries.len);
    if (status == NOC_OK && t->entries.len)
        status = noc_vk_write(d, &s->instances, 0, t->instances.data, t->instances.len * sizeof(*t->instances.data));
    if (status == NOC_OK && t->entries.len)
        status = noc_vk_write(d, &s->entries, 0, t->entries.data, t->entries.len * sizeof(*t->entries.data));
    if (status == NOC_OK)
        status = noc_vk_open_upload(d, &commands);
    if (status != NOC_OK)
        return status;
    VkAccelerationStructureBuildGeometryInfoKHR info = top_info(s, &geometry);
    VkAccelerationStructureBuildRangeInfoKHR range = { .primitiveCount = (uint32_t)t->entries.len };
    const VkAccelerationStructureBuildRangeInfoKHR *ranges = &range;
    info.dstAccelerationStructure = to->structure;
    info.scratchData.deviceAddress = aligned(s->scratch.address, align);
    noc_vk_barrier(commands);
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &ranges);
    return noc_vk_submit_upload(d);
}

noc_status noc_vk_structure_follow(vk_world *w) {
    vk_device *d = w->device;
    vk_structure *s = &w->structure;
    vk_parts world = { 0 };
    top t = { 0 };
    int next = s->world.len ? 1 - s->now : s->now;
    noc_status status = make_world(w, &world);
    if (status == NOC_OK)
        status = gather_top(w, &world, &t);
    if (status == NOC_OK)
        status = build_top(w, &t, &s->tlas[next]);
    if (status == NOC_OK) {
        vk_parts gone = s->tlas[next].held;
        s->tlas[next].held = t.held;
        t.held = gone;
        gone = s->world;
        s->world = world;
        world = gone;
        s->now = next;
        s->geometry = w->scene->versions.geometry;
        s->moved = w->scene->versions.instances;
    }
    free_top(d, &t);
    release_parts(d, &world);
    return status;
}

noc_status noc_vk_structure_create(vk_world *w) {
    vk_device *d = w->device;
    vk_structure *s = &w->structure;
    VkDescriptorPoolSize size = { VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 2 };
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 2, .poolSizeCount = 1, .pPoolSizes = &size
    };
    VkDescriptorSetLayout layouts[] = { d->set_layout, d->set_layout };
    VkDescriptorSet sets[2];
    VkResult result = vkCreateDescriptorPool(d->device, &pool, NULL, &s->sets);
    VkDescriptorSetAllocateInfo info = { .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .descriptorPool = s->sets,
                                         .descriptorSetCount = 2,
                                         .pSetLayouts = layouts };
    if (result == VK_SUCCESS)
        result = vkAllocateDescriptorSets(d->device, &info, sets);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "making descriptors");
    s->tlas[0].set = sets[0];
    s->tlas[1].set = sets[1];
    return noc_vk_structure_follow(w);
}

void noc_vk_structure_destroy(vk_world *w) {
    vk_device *d = w->device;
    vk_structure *s = &w->structure;
    for (int i = 0; i < 2; i++) {
        release_parts(d, &s->tlas[i].held);
        free_tlas(d, &s->tlas[i]);
    }
    release_parts(d, &s->world);
    release_parts(d, &s->models);
    noc_vk_free_buffer(d, &s->instances);
    noc_vk_free_buffer(d, &s->entries);
    noc_vk_free_buffer(d, &s->scratch);
    if (s->sets)
        vkDestroyDescriptorPool(d->device, s->sets, NULL);
}

static size_t bytes_of(const vk_parts *parts) {
    size_t bytes = 0;
    for (size_t i = 0; i < parts->len; i++)
        for (size_t k = 0; parts->data[i] && k < parts->data[i]->blas.len; k++)
            bytes += parts->data[i]->blas.data[k].store.bytes + parts->data[i]->blas.data[k].order.bytes;
    return bytes;
}

size_t noc_vk_structure_bytes(const vk_world *w) {
    const vk_structure *s = &w->structure;
    return bytes_of(&s->world) + bytes_of(&s->models) + s->tlas[0].store.bytes + s->tlas[1].store.bytes +
           s->instances.bytes + s->entries.bytes + s->scratch.bytes;
}
