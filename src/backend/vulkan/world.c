/* A scene on the device: its arrays, and how they follow edits. Arrays are uploaded by the ranges that changed; where
 * one has no room left it is made anew. */
#include "backend/vulkan/vulkan.h"

/* ---- arrays ---- */

static void free_array(vk_device *d, vk_array *a) {
    noc_vk_free_buffer(d, &a->buffer);
    a->filled = 0;
}

/* Makes a buffer with room for `bytes`; what was in an earlier one is lost. */
static noc_status make_room(vk_world *w, vk_array *a, size_t bytes, VkBufferUsageFlags usage, const char *what) {
    vk_device *d = w->device;
    size_t room = a->buffer.bytes ? bytes + bytes / 4 : bytes;
    if (a->buffer.bytes) {
        noc_status status = noc_vk_wait_idle(d); /* frames in flight read it */
        if (status != NOC_OK)
            return status;
        free_array(d, a);
    }
    return noc_vk_make_buffer(d, NOC_MAX(room, (size_t)64), usage, VK_PLACE_DEVICE, what, &a->buffer);
}

/* Brings the array to `bytes` bytes of data, of which first to end have changed and all beyond `filled` are new. */
static noc_status fill(vk_world *w, vk_array *a, const void *data, size_t bytes, size_t first, size_t end,
                       VkBufferUsageFlags usage, const char *what) {
    noc_status status = NOC_OK;
    if (!a->buffer.bytes || a->buffer.bytes < bytes) {
        status = make_room(w, a, bytes, usage, what);
        first = 0;
        end = bytes;
    }
    if (bytes > a->filled) {
        first = first < end ? NOC_MIN(first, a->filled) : a->filled;
        end = bytes;
    }
    if (status == NOC_OK && first < end)
        status = noc_vk_write(w->device, &a->buffer, first, (const char *)data + first, end - first);
    if (status == NOC_OK)
        a->filled = bytes;
    return status;
}

#define FILL(array, of, range, what)                                                                                   \
    fill(w, &w->array, (of).data, (of).len * sizeof(*(of).data), (range).first * sizeof(*(of).data),                   \
         (range).end * sizeof(*(of).data), 0, what)

static const noc_range nothing = { 0, 0 };

enum { VK_ARRAYS = 25 };
static void arrays_of(vk_world *w, vk_array *out[VK_ARRAYS]) {
    vk_array *const all[] = { &w->positions,
                              &w->indices,
                              &w->triangle_material,
                              &w->triangle_light,
                              &w->triangle_facade,
                              &w->facades,
                              &w->facade_cells,
                              &w->materials,
                              &w->lights,
                              &w->profiles,
                              &w->texels,
                              &w->image_places,
                              &w->image_corners,
                              &w->panes,
                              &w->instances,
                              &w->instance_lights,
                              &w->backs,
                              &w->backdrop,
                              &w->environment,
                              &w->environment_slots,
                              &w->environment_sines,
                              &w->alias,
                              &w->tree,
                              &w->clusters,
                              &w->volumes };
    _Static_assert(NOC_COUNT(all) == VK_ARRAYS, "all arrays");
    memcpy(out, all, sizeof(all));
}

/* An upload failed: what arrays hold is not known. Those that are filled next are filled from their beginning. */
static void forget_filled(vk_world *w) {
    vk_array *arrays[VK_ARRAYS];
    arrays_of(w, arrays);
    for (size_t i = 0; i < VK_ARRAYS; i++)
        arrays[i]->filled = 0;
}

/* ---- geometry ---- */

/* Triangles and vertices that commits after version `made` filled. */
static void changed_ranges(const noc_scene *s, uint64_t made, noc_range *triangles, noc_range *vertices) {
    *triangles = *vertices = (noc_range){ SIZE_MAX, 0 };
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->made <= made)
            continue;
        triangles->first = NOC_MIN(triangles->first, m->first_triangle);
        triangles->end = NOC_MAX(triangles->end, (size_t)m->first_triangle + m->triangle_count);
        vertices->first = NOC_MIN(vertices->first, m->first_vertex);
        vertices->end = NOC_MAX(vertices->end, noc_mesh_end_vertex(s, i));
    }
}

/* Places in images, two numbers a vertex: all bits set where the vertex's mesh has none, whatever its material has. */
static noc_status fill_image_corners(vk_world *w) {
    const noc_scene *s = w->scene;
    size_t vertices = s->positions.len / 3;
    if (!s->uv.len)
        return NOC_OK;
    float(*uv)[2] = noc_alloc_large(vertices, sizeof(*uv));
    if (!uv)
        return noc_no_memory(w->log, "vulkan");
    memset(uv, 0xff, vertices * sizeof(*uv));
    for (size_t i = 0; i < s->meshes.len; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->uv)
            memcpy(uv[m->first_vertex], s->uv.data + 2 * (size_t)(m->uv - 1),
                   (noc_mesh_end_vertex(s, i) - m->first_vertex) * sizeof(*uv));
    }
    noc_status status =
        fill(w, &w->image_corners, uv, vertices * sizeof(*uv), 0, vertices * sizeof(*uv), 0, "places in images");
    free(uv);
    return status;
}

/* They stay as they are but for windows that go with a wall. */
static noc_status fill_facades(vk_world *w) {
    const noc_scene *s = w->scene;
    noc_range all = { 0, s->facade_cells.len };
    if (!s->facades.len)
        return NOC_OK;
    noc_status status = FILL(triangle_facade, s->triangle_facade, nothing, "facades");
    if (status == NOC_OK)
        status = FILL(facades, s->facades, nothing, "facades");
    return status
               ? status
               : FILL(facade_cells, s->facade_cells, s->facades_changed > w->seen.geometry ? all : nothing, "facades");
}

static noc_status follow_geometry(vk_world *w) {
    const noc_scene *s = w->scene;
    noc_range t, v;
    if (w->filled && w->seen.geometry == s->versions.geometry)
        return NOC_OK;
    changed_ranges(s, w->filled ? w->seen.geometry : 0, &t, &v);
    noc_range corners = { 3 * t.first, 3 * t.end };
    if (t.first >= t.end)
        t = v = corners = nothing;
    noc_status status = fill(w, &w->positions, s->positions.data, s->positions.len * 4, 12 * v.first, 12 * v.end,
                             VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR, "vertices");
    if (status == NOC_OK)
        status = FILL(indices, s->indices, corners, "triangles");
    if (status == NOC_OK)
        status = FILL(triangle_material, s->triangle_material, t, "triangles");
    if (status == NOC_OK)
        status = FILL(triangle_light, s->triangle_light, t, "triangles");
    if (status == NOC_OK)
        status = fill_facades(w);
    if (status == NOC_OK)
        status = fill_image_corners(w);
    return status;
}

/* ---- materials, lights, maps ---- */

/* Returns true if the scene's dirty ranges are all that changed since the world followed it. */
static bool one_commit_behind(const vk_world *w) {
    return w->filled && w->seen.commits + 1 == w->scene->versions.commits;
}

static noc_range since(const vk_world *w, noc_range dirty, size_t count) {
    return one_commit_behind(w) ? dirty : (noc_range){ 0, count };
}

static noc_status fill_image_places(vk_world *w) {
    const noc_scene *s = w->scene;
    uint32_t *places = s->texels.len ? noc_calloc(s->materials.len, sizeof(*places)) : NULL;
    if (!s->texels.len)
        return NOC_OK;
    if (!places)
        return noc_no_memory(w->log, "vulkan");
    for (size_t i = 0; i < s->materials.len; i++)
        if (s->materials.data[i].texture)
            places[i] = s->textures.data[s->materials.data[i].texture - 1].place + 1;
    noc_status status = fill(w, &w->image_places, places, s->materials.len * sizeof(*places), 0,
                             s->materials.len * sizeof(*places), 0, "materials");
    free(places);
    return status;
}

static noc_status fill_panes(vk_world *w) {
    const noc_scene *s = w->scene;
    if (!s->lets_through)
        return NOC_OK;
    vk_pane_record *panes = noc_calloc(s->materials.len, sizeof(*panes));
    if (!panes)
        return noc_no_memory(w->log, "vulkan");
    for (size_t i = 0; i < s->materials.len; i++) {
        const noc_material *m = &s->materials.data[i];
        panes[i].transmittance = m->transmittance;
        if (m->cutout && m->texture && s->uv.len)
            panes[i].holes = s->textures.data[m->texture - 1].place + 1;
    }
    size_t bytes = s->materials.len * sizeof(*panes);
    noc_status status = fill(w, &w->panes, panes, bytes, 0, bytes, 0, "materials");
    free(panes);
    return status;
}

static noc_status follow_materials(vk_world *w) {
    const noc_scene *s = w->scene;
    if (w->filled && w->seen.materials == s->versions.materials && w->seen.geometry == s->versions.geometry)
        return NOC_OK;
    noc_status status =
        FILL(materials, s->material_records, since(w, s->dirty_materials, s->material_records.len), "materials");
    if (status == NOC_OK)
        status = FILL(texels, s->texels, nothing, "textures");
    if (status == NOC_OK)
        status = fill_image_places(w);
    return status == NOC_OK ? fill_panes(w) : status;
}

static noc_status follow_lights(vk_world *w) {
    const noc_scene *s = w->scene;
    const noc_scene_versions *now = &s->versions, *then = &w->seen;
    if (w->filled && now->lights == then->lights && now->moved == then->moved && now->emission == then->emission)
        return NOC_OK;
    noc_status status = FILL(lights, s->lights, since(w, s->dirty_lights, s->lights.len), "lights");
    return status == NOC_OK ? FILL(profiles, s->profile_cells, nothing, "light profiles") : status;
}

static noc_status follow_environment(vk_world *w) {
    const noc_environment *e = w->scene->environment;
    if (!e || (w->filled && w->seen.environment == w->scene->versions.environment))
        return NOC_OK;
    size_t seen = (size_t)e->width * (size_t)e->height * 12,
           lights = (size_t)e->light_width * (size_t)e->light_height * 12;
    noc_status status = fill(w, &w->backdrop, e->texels, seen, 0, seen, 0, "the environment map");
    return status == NOC_OK ? fill(w, &w->environment, e->light, lights, 0, lights, 0, "the environment map") : status;
}

/* ---- instances ---- */

/* Transforms, and the lights' numbers of all bodies and instances, one after the other. */
static noc_status follow_instances(vk_world *w) {
    const noc_scene *s = w->scene;
    size_t bodies = s->bodies.len, count = bodies + s->instances.len, lights = 0;
    if (!count || (w->filled && w->seen.instances == s->versions.instances && w->seen.lights == s->versions.lights))
        return NOC_OK;
    for (size_t i = 0; i < bodies; i++)
        lights += s->models.data[s->bodies.data[i].model - 1].shown;
    for (size_t i = 0; i < s->instances.len; i++)
        if (s->instances.data[i].model)
            lights += s->models.data[s->instances.data[i].model - 1].lights.len;
    vk_instance_record *records = noc_calloc(count, sizeof(*records));
    uint32_t *numbers = noc_calloc(lights + 1, sizeof(*numbers));
    bool ok = records && numbers;
    lights = 0;
    for (size_t i = 0; ok && i < bodies; i++) {
        const noc_scene_body *b = &s->bodies.data[i];
        noc_body_transform(b, records[i].transform.m);
        records[i].lights = (uint32_t)lights;
        for (uint32_t k = 0; k < s->models.data[b->model - 1].shown; k++)
            numbers[lights++] = b->light + k;
    }
    for (size_t i = 0; ok && i < s->instances.len; i++) {
        const noc_scene_instance *in = &s->instances.data[i];
        size_t n = in->model ? s->models.data[in->model - 1].lights.len : 0;
        memcpy(records[bodies + i].transform.m, in->transform, sizeof(in->transform));
        records[bodies + i].lights = (uint32_t)lights;
        if (n)
            memcpy(numbers + lights, in->lights, n * sizeof(*numbers));
        lights += n;
    }
    noc_status status = ok ? NOC_OK : noc_no_memory(w->log, "vulkan");
    if (ok)
        status = fill(w, &w->instances, records, count * sizeof(*records), 0, count * sizeof(*records), 0, "instances");
    if (status == NOC_OK)
        status = fill(w, &w->instance_lights, numbers, (lights + 1) * 4, 0, (lights + 1) * 4, 0, "instances");
    free(records);
    free(numbers);
    return status;
}

/* ---- the world ---- */

static noc_status follow_arrays(vk_world *w) {
    noc_status status = follow_geometry(w);
    if (status == NOC_OK)
        status = follow_materials(w);
    if (status == NOC_OK)
        status = follow_lights(w);
    if (status == NOC_OK)
        status = follow_environment(w);
    return status == NOC_OK ? follow_instances(w) : status;
}

/* The ray tracing structure, and the ways of instances back to where they were. */
static noc_status follow_shape(vk_world *w, const noc_progress *progress) {
    if (!noc_placings_reserve(&w->placings, w->scene))
        return noc_no_memory(w->log, "world");
    w->structure.progress = progress;
    noc_status status = w->filled ? noc_vk_structure_follow(w) : noc_vk_structure_create(w);
    w->structure.progress = NULL;
    if (status != NOC_OK)
        return status;
    noc_placings_follow(&w->placings, w->scene);
    noc_ray_scale_follow(w->scene, &w->scale);
    return NOC_OK;
}

static noc_status fill_backs(vk_world *w) {
    size_t bytes = w->placings.back.len * sizeof(*w->placings.back.data);
    return bytes ? fill(w, &w->backs, w->placings.back.data, bytes, 0, bytes, 0, "instances") : NOC_OK;
}

noc_status noc_vk_world_follow(vk_world *w, const noc_progress *progress) {
    const noc_scene_versions *now = &w->scene->versions;
    if (w->filled && !memcmp(&w->seen, now, sizeof(*now)))
        return NOC_OK;
    noc_status status = follow_arrays(w);
    if (status == NOC_OK && (!w->filled || w->placings.shape != noc_scene_shape(now)))
        status = follow_shape(w, progress);
    if (status == NOC_OK && (!w->filled || noc_scene_shape(&w->seen) != noc_scene_shape(now)))
        status = fill_backs(w);
    if (status == NOC_OK)
        status = noc_vk_submit_upload(w->device);
    if (status != NOC_OK) {
        forget_filled(w);
        return status;
    }
    w->seen = *now;
    w->filled = true;
    return NOC_OK;
}

static noc_status fill_alias(vk_world *w, vk_array *a, const noc_alias *alias) {
    size_t bytes = (size_t)alias->count * sizeof(*alias->slots);
    return fill(w, a, alias->slots, bytes, 0, bytes, 0, "the alias table");
}

static noc_status fill_tree(vk_world *w, const noc_tree *tree) {
    size_t bytes = tree->lights > 1 ? ((size_t)tree->lights - 1) * sizeof(*tree->pairs) : 0;
    return fill(w, &w->tree, tree->pairs, bytes, 0, bytes, 0, "the light tree");
}

static noc_status fill_clusters(vk_world *w, const noc_light_sources *sources) {
    size_t bytes;
    void *words = noc_vk_pack_clusters((const noc_clusters *const *)sources->clusters, &bytes);
    if (!words)
        return noc_no_memory(w->log, "vulkan");
    noc_status status = fill(w, &w->clusters, words, bytes, 0, bytes, 0, "clusters of lights");
    free(words);
    return status;
}

static noc_status fill_influence(vk_world *w, const noc_influence *influence) {
    size_t bytes;
    void *words = noc_vk_pack_influence(influence, &bytes);
    if (!words)
        return noc_no_memory(w->log, "vulkan");
    noc_status status = fill(w, &w->volumes, words, bytes, 0, bytes, 0, "influence volumes");
    free(words);
    return status;
}

noc_status noc_vk_world_fill_sources(vk_world *w, const noc_light_sources *sources, const noc_map_light *map) {
    const vk_sources_key key = { w->seen.commits,
                                 sources->influence ? sources->influence->number : 0,
                                 sources->alias,
                                 sources->tree,
                                 map,
                                 { sources->clusters[0], sources->clusters[1] } };
    noc_status status = NOC_OK;
    if (!memcmp(&key, &w->drawn_from, sizeof(key)))
        return NOC_OK;
    w->drawn_from = (vk_sources_key){ 0 }; /* until all is there */
    if (sources->alias && sources->alias->count)
        status = fill_alias(w, &w->alias, sources->alias);
    if (status == NOC_OK && sources->tree)
        status = fill_tree(w, sources->tree);
    if (status == NOC_OK && (sources->clusters[0] || sources->clusters[1]))
        status = fill_clusters(w, sources);
    if (status == NOC_OK && sources->influence)
        status = fill_influence(w, sources->influence);
    if (status == NOC_OK && map)
        status = fill_alias(w, &w->environment_slots, map->texels);
    if (status == NOC_OK && map) {
        size_t bytes = ((size_t)w->scene->environment->light_height + 1) * sizeof(float);
        status = fill(w, &w->environment_sines, map->sines, bytes, 0, bytes, 0, "the environment map");
    }
    if (status == NOC_OK)
        status = noc_vk_submit_upload(w->device);
    if (status == NOC_OK)
        w->drawn_from = key;
    return status;
}

size_t noc_vk_world_bytes(const vk_world *w) {
    return (size_t)(w->positions.buffer.bytes + w->indices.buffer.bytes + w->triangle_material.buffer.bytes +
                    w->triangle_light.buffer.bytes + w->triangle_facade.buffer.bytes + w->facades.buffer.bytes +
                    w->facade_cells.buffer.bytes + w->materials.buffer.bytes + w->lights.buffer.bytes) +
           noc_vk_structure_bytes(w);
}

void noc_vk_world_destroy(void *world) {
    vk_world *w = world;
    if (!w)
        return;
    vk_device *d = w->device;
    vk_array *arrays[VK_ARRAYS];
    arrays_of(w, arrays);
    noc_light_set_destroy(w->lights_set);
    noc_vk_forget_host_world(w);
    pthread_mutex_lock(&d->lock);
    noc_vk_settle(d);
    for (size_t i = 0; i < VK_ARRAYS; i++)
        free_array(d, arrays[i]);
    noc_vk_structure_destroy(w);
    noc_placings_free(&w->placings);
    pthread_mutex_unlock(&d->lock);
    free(w);
}

noc_status noc_vk_world_create(void *device, const noc_scene *scene, void **world) {
    vk_device *d = device;
    double start = noc_wall_seconds();
    vk_world *w = noc_calloc(1, sizeof(*w));
    if (!w)
        return noc_no_memory(d->log, "world");
    *w = (vk_world){ .device = d, .scene = scene, .log = d->log };
    noc_status status = noc_vk_enter(d);
    if (status != NOC_OK) {
        free(w);
        return status;
    }
    status = noc_vk_world_follow(w, NULL);
    if (status == NOC_OK)
        status = noc_vk_wait_idle(d);
    pthread_mutex_unlock(&d->lock);
    w->build_seconds = noc_wall_seconds() - start;
    if (status == NOC_OK && !(w->lights_set = noc_light_set_create(scene, d->pool, NULL, NULL, d->log)))
        status = NOC_ERR_MEMORY;
    if (status != NOC_OK) {
        noc_vk_world_destroy(w);
        return status;
    }
    *world = w;
    return NOC_OK;
}
