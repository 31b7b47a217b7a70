/* Ray tracing structures of a scene on the device, and how they follow its edits.
 *
 * Parts of the world and models are built as backend/parts.h plans them. A part is one bottom-level structure (BLAS),
 * or several where it has more triangles than a driver takes at once. Above them lies one TLAS of the parts of the
 * world and of the instances of models. It is built again whenever one of them changes, and never refitted: a build is
 * as fast, and traces faster. That of the scene before stays for rays of the past. */
#include "backend/vulkan/vulkan.h"

enum { BLAS_TRIANGLES = 8 << 20 };

static VkDeviceSize aligned(VkDeviceSize size, VkDeviceSize to) { return (size + to - 1) / to * to; }

/* ---- parts ---- */

/* Frames in flight may trace a part that goes: they are waited for. */
static void let_go(vk_device *d, vk_part *part) {
    if (!part || --part->holders)
        return;
    noc_vk_settle(d);
    for (int layer = 0; layer < VK_LAYERS; layer++) {
        for (size_t i = 0; i < part->blas[layer].len; i++)
            noc_vk_free_blas(d, &part->blas[layer].data[i]);
        array_free(&part->blas[layer]);
    }
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

/* Puts the numbers of a part's triangles that are of the layer into `order`; returns how many there are. */
static size_t triangles_of(const noc_scene *scene, uint32_t model, vk_layer layer, const vk_part *part,
                           uint32_t *order) {
    size_t count = 0;
    for (size_t i = part->of.first_mesh; i < part->of.end_mesh; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        if (!noc_part_has(scene, m, model) || noc_mesh_lets_through(scene, m) != (layer == VK_LAYER_THROUGH))
            continue;
        for (uint32_t k = 0; k < m->triangle_count; k++)
            order[count++] = m->first_triangle + k;
    }
    return count;
}

/* The triangles of a part, as a BLAS each BLAS_TRIANGLES of a layer. */
static noc_status build_part(vk_world *w, uint32_t model, vk_part *part) {
    noc_status status = NOC_OK;
    uint32_t *order = noc_alloc_large(NOC_MAX(part->of.triangles, (size_t)1), sizeof(*order));
    if (!order)
        return noc_no_memory(w->log, "vulkan");
    for (vk_layer layer = VK_LAYER_SOLID; layer < VK_LAYERS; layer++) {
        size_t count = triangles_of(w->scene, model, layer, part, order);
        for (size_t first = 0; first < count && status == NOC_OK; first += BLAS_TRIANGLES)
            status = noc_vk_build_blas(w, layer, order + first, NOC_MIN(count - first, (size_t)BLAS_TRIANGLES),
                                       &part->blas[layer]);
    }
    free(order);
    return status;
}

static noc_status make_part(vk_world *w, uint32_t model, size_t first, size_t end, vk_part **out) {
    const noc_progress *progress = w->structure.progress;
    if (progress && progress->update && !progress->update(progress->user, "the ray tracing structure", 0))
        return NOC_ERR_CANCELLED;
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
    const noc_scene_model *m = &w->scene->models.data[model - 1];
    noc_status status =
        *slot ? NOC_OK : make_part(w, model, m->first_mesh, m->end_mesh ? m->end_mesh : w->scene->meshes.len, slot);
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

static bool add_layer(top *t, const vk_blas_list *list, uint32_t mask, vk_entry entry, const float transform[12]) {
    for (size_t i = 0; i < list->len; i++) {
        const vk_blas *b = &list->data[i];
        VkAccelerationStructureInstanceKHR in = { .instanceCustomIndex = (uint32_t)t->entries.len & 0xffffff,
                                                  .mask = mask & 0xff,
                                                  .flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR,
                                                  .accelerationStructureReference = b->address };
        memcpy(in.transform.matrix, transform, sizeof(in.transform.matrix));
        entry.order = noc_vk_piece_address(&b->order);
        if (!array_push(&t->instances, in) || !array_push(&t->entries, entry))
            return false;
    }
    return true;
}

static bool add_part(top *t, vk_part *part, vk_entry entry, const float transform[12]) {
    if (!add_layer(t, &part->blas[VK_LAYER_SOLID], VK_MASK_SOLID, entry, transform) ||
        !add_layer(t, &part->blas[VK_LAYER_THROUGH], VK_MASK_THROUGH, entry, transform) || !array_push(&t->held, part))
        return false;
    held(part);
    return true;
}

static noc_status gather_bodies(vk_world *w, top *t) {
    const noc_scene *scene = w->scene;
    for (size_t i = 0; i < scene->bodies.len; i++) {
        vk_part *part = NULL;
        float m[12];
        noc_body_transform(&scene->bodies.data[i], m);
        noc_status status = part_of_model(w, scene->bodies.data[i].model, &part);
        if (status != NOC_OK)
            return status;
        if (!add_part(t, part, (vk_entry){ 0, NO_INSTANCE, (uint32_t)i }, m))
            return noc_no_memory(w->log, "vulkan");
    }
    return NOC_OK;
}

static noc_status gather_top(vk_world *w, const vk_parts *world, top *t) {
    static const float standing[12] = { [0] = 1, [5] = 1, [10] = 1 };
    const noc_scene *scene = w->scene;
    noc_status status = NOC_OK;
    bool ok = true;
    for (size_t i = 0; ok && i < world->len; i++)
        ok = add_part(t, world->data[i], (vk_entry){ 0, NO_INSTANCE, NO_INSTANCE }, standing);
    if (ok && (status = gather_bodies(w, t)) != NOC_OK)
        return status;
    for (size_t i = 0; ok && i < scene->instances.len; i++) {
        const noc_scene_instance *in = &scene->instances.data[i];
        vk_part *part = NULL;
        if (!in->model)
            continue;
        if ((status = part_of_model(w, in->model, &part)) != NOC_OK)
            return status;
        ok = add_part(t, part, (vk_entry){ 0, (uint32_t)i, (uint32_t)(scene->bodies.len + i) }, in->transform);
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
        status = noc_vk_make_buffer(d, sizes.accelerationStructureSize,
                                    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR, VK_PLACE_DEVICE,
                                    "the ray tracing structure", &t->store);
    if (status == NOC_OK)
        status =
            noc_vk_make_structure(d, info.type, &t->store, 0, sizes.accelerationStructureSize, &t->structure, &address);
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
    noc_vk_let_go_of_chunk(d, s->open);
    noc_vk_free_buffer(d, &s->instances);
    noc_vk_free_buffer(d, &s->entries);
    noc_vk_free_buffer(d, &s->scratch);
    if (s->sets)
        vkDestroyDescriptorPool(d->device, s->sets, NULL);
}

static size_t bytes_of_layer(const vk_blas_list *list) {
    size_t bytes = 0;
    for (size_t i = 0; i < list->len; i++)
        bytes += list->data[i].store.bytes + list->data[i].order.bytes;
    return bytes;
}

static size_t bytes_of(const vk_parts *parts) {
    size_t bytes = 0;
    for (size_t i = 0; i < parts->len; i++)
        for (int layer = 0; parts->data[i] && layer < VK_LAYERS; layer++)
            bytes += bytes_of_layer(&parts->data[i]->blas[layer]);
    return bytes;
}

size_t noc_vk_structure_bytes(const vk_world *w) {
    const vk_structure *s = &w->structure;
    return bytes_of(&s->world) + bytes_of(&s->models) + s->tlas[0].store.bytes + s->tlas[1].store.bytes +
           s->instances.bytes + s->entries.bytes + s->scratch.bytes;
}
