/* Ray tracing structures of a scene, and how they follow its edits.
 *
 * What is there when a view first looks is one part, built at once and traced first: scenes that are not edited cost
 * what a single structure does. Bodies of lamps are traced next (bodies.c). A structure above it holds instances of
 * models, and meshes that were added later, as instances that stand where they are. It is small, and made anew whenever
 * something in it moves. Meshes that were added together are built together; parts grow by joining, so that there are
 * few. A mesh that is removed costs the part that it lies in.
 *
 * Robust structures hold the corners of their triangles, so the scene's arrays are read by builds only, and may move
 * afterwards. */
#include "backend/embree/embree.h"

static void let_go(embree_part *part) {
    if (!part || --part->holders)
        return;
    for (int layer = 0; layer < LAYERS; layer++) {
        if (part->rtc[layer])
            rtcReleaseScene(part->rtc[layer]);
        array_free(&part->first[layer]);
    }
    free(part);
}

static embree_part *held(embree_part *part) {
    part->holders++;
    return part;
}

static void release_parts(embree_parts *parts) {
    for (size_t i = 0; i < parts->len; i++)
        let_go(parts->data[i]);
    array_free(parts);
}

static void release_generation(embree_generation *g) {
    for (int layer = 0; layer < LAYERS; layer++) {
        if (g->top[layer])
            rtcReleaseScene(g->top[layer]);
        for (size_t i = 0; i < g->above[layer].len; i++)
            let_go(g->above[layer].data[i].part);
        array_free(&g->above[layer]);
    }
    let_go(g->base);
    *g = (embree_generation){ 0 };
}

void noc_embree_release_parts(embree_structure *s) {
    release_generation(&s->now);
    release_generation(&s->past);
    release_parts(&s->world);
    release_parts(&s->models);
    if (s->bodies)
        rtcReleaseScene(s->bodies);
}

static bool no_memory(embree_structure *s) {
    noc_embree_fail(s, RTC_ERROR_OUT_OF_MEMORY, NULL);
    return false;
}

RTCScene noc_embree_new_scene(embree_structure *s) {
    RTCScene rtc = rtcNewScene(s->device->device);
    if (!rtc) {
        noc_embree_fail(s, rtcGetDeviceError(s->device->device), "no scene");
        return NULL;
    }
    /* Robust: without it rays slip through the edges between walls, and every slip is a bright pixel in a dark room. */
    rtcSetSceneFlags(rtc, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(rtc, RTC_BUILD_QUALITY_MEDIUM);
    return rtc;
}

static bool attach_triangles(embree_structure *s, embree_part *part, embree_layer layer, size_t first, size_t count) {
    const noc_scene *scene = s->scene;
    if (!count)
        return true;
    if (!array_push(&part->first[layer], (uint32_t)first))
        return no_memory(s);
    RTCGeometry geometry = rtcNewGeometry(s->device->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry)
        return !noc_embree_fail(s, rtcGetDeviceError(s->device->device), "no geometry");
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene->positions.data, 0, 12,
                               scene->positions.len / 3);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->indices.data, 12 * first,
                               12, count);
    if (layer == LAYER_THROUGH)
        noc_embree_let_through(geometry, first);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(part->rtc[layer], geometry);
    rtcReleaseGeometry(geometry);
    return !s->failed;
}

/* A geometry for each run of triangles without a gap. */
static bool build_layer(embree_structure *s, uint32_t model, embree_part *part, embree_layer layer) {
    const noc_scene *scene = s->scene;
    size_t first = 0, end = 0;
    if (!(part->rtc[layer] = noc_embree_new_scene(s)))
        return false;
    for (size_t i = part->of.first_mesh; i < part->of.end_mesh; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        if (!noc_part_has(scene, m, model) || noc_mesh_lets_through(scene, m) != (layer == LAYER_THROUGH))
            continue;
        if (m->first_triangle != end) {
            if (!attach_triangles(s, part, layer, first, end - first))
                return false;
            first = m->first_triangle;
        }
        end = (size_t)m->first_triangle + m->triangle_count;
    }
    if (!attach_triangles(s, part, layer, first, end - first))
        return false;
    rtcCommitScene(part->rtc[layer]);
    return !s->failed;
}

static bool lets_through(const noc_scene *scene, uint32_t model, const noc_part *part) {
    for (size_t i = part->first_mesh; i < part->end_mesh; i++)
        if (noc_part_has(scene, &scene->meshes.data[i], model) && noc_mesh_lets_through(scene, &scene->meshes.data[i]))
            return true;
    return false;
}

static bool build_part(embree_structure *s, uint32_t model, embree_part *part) {
    return build_layer(s, model, part, LAYER_SOLID) &&
           (!lets_through(s->scene, model, &part->of) || build_layer(s, model, part, LAYER_THROUGH));
}

/* One part of the meshes first to end, held once; NULL where it fails. */
static embree_part *make_part(embree_structure *s, uint32_t model, size_t first, size_t end) {
    embree_part *part = noc_calloc(1, sizeof(*part));
    if (!part) {
        no_memory(s);
        return NULL;
    }
    part->of = (noc_part){ .first_mesh = first, .end_mesh = end };
    part->holders = 1;
    noc_part_count(s->scene, model, &part->of);
    if (build_part(s, model, part))
        return part;
    let_go(part);
    return NULL;
}

/* Plans the world's parts; where only instances have moved they stay. */
static size_t plan_world(const embree_structure *s, noc_part *planned, bool *keep) {
    size_t count = s->world.len;
    for (size_t i = 0; i < count; i++) {
        planned[count + 1 + i] = s->world.data[i]->of;
        keep[i] = true;
    }
    if (count && s->geometry == s->scene->versions.geometry)
        return count;
    return noc_parts_plan(s->scene, planned + count + 1, count, planned, keep);
}

/* The world's parts as they are now: those that have not changed are held. */
static bool make_world(embree_structure *s, embree_parts *out) {
    size_t count = 0;
    noc_part *planned = noc_calloc(2 * s->world.len + 1, sizeof(*planned));
    bool *keep = noc_calloc(s->world.len + 1, sizeof(*keep));
    bool ok = planned && keep && array_reserve(out, s->world.len + 1);
    if (ok)
        count = plan_world(s, planned, keep);
    else
        no_memory(s);
    for (size_t i = 0; ok && i < count; i++) {
        embree_part *part =
            keep[i] ? held(s->world.data[i]) : make_part(s, 0, planned[i].first_mesh, planned[i].end_mesh);
        ok = part != NULL;
        if (ok)
            out->data[out->len++] = part;
    }
    free(planned);
    free(keep);
    return ok;
}

/* The structure of a model, built when an instance or body first shows it; NULL where that fails. */
static embree_part *part_of_model(embree_structure *s, uint32_t model) {
    embree_part **slot = &s->models.data[model - 1];
    const noc_scene_model *m = &s->scene->models.data[model - 1];
    if (!*slot)
        *slot = make_part(s, model, m->first_mesh, m->end_mesh ? m->end_mesh : s->scene->meshes.len);
    return *slot;
}

static bool add_above(embree_structure *s, embree_generation *g, embree_layer layer, embree_part *part,
                      uint32_t instance, const float transform[12]) {
    if (!part)
        return false;
    if (!part->of.triangles || !part->rtc[layer])
        return true;
    if (!array_push(&g->above[layer], (embree_above){ part, instance }))
        return no_memory(s);
    held(part);
    RTCGeometry geometry = rtcNewGeometry(s->device->device, RTC_GEOMETRY_TYPE_INSTANCE);
    if (!geometry)
        return !noc_embree_fail(s, rtcGetDeviceError(s->device->device), "no instance");
    rtcSetGeometryInstancedScene(geometry, part->rtc[layer]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, transform);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(g->top[layer], geometry);
    rtcReleaseGeometry(geometry);
    return !s->failed;
}

static bool make_top(embree_structure *s, const embree_parts *world, embree_layer layer, embree_generation *g) {
    static const float standing[12] = { [0] = 1, [5] = 1, [10] = 1 };
    const noc_scene *scene = s->scene;
    bool ok = (g->top[layer] = noc_embree_new_scene(s)) != NULL;
    for (size_t i = 1; ok && i < world->len; i++)
        ok = add_above(s, g, layer, world->data[i], NO_INSTANCE, standing);
    for (size_t i = 0; ok && i < scene->instances.len; i++) {
        const noc_scene_instance *in = &scene->instances.data[i];
        if (in->model)
            ok = add_above(s, g, layer, part_of_model(s, in->model), (uint32_t)i, in->transform);
    }
    if (ok && layer == LAYER_THROUGH && !g->above[layer].len) {
        rtcReleaseScene(g->top[layer]);
        g->top[layer] = NULL;
    } else if (ok) {
        rtcCommitScene(g->top[layer]);
    }
    return ok && !s->failed;
}

static bool has_instances(const noc_scene *scene) {
    for (size_t i = 0; i < scene->instances.len; i++)
        if (scene->instances.data[i].model)
            return true;
    return false;
}

static bool make_generation(embree_structure *s, const embree_parts *world, embree_generation *g) {
    g->base = held(world->data[0]);
    if (world->len == 1 && !has_instances(s->scene))
        return true;
    return make_top(s, world, LAYER_SOLID, g) && make_top(s, world, LAYER_THROUGH, g);
}

static bool make_bodies(embree_structure *s) {
    const noc_scene *scene = s->scene;
    if (s->bodies || !scene->bodies.len)
        return true;
    for (size_t i = 0; i < scene->bodies.len; i++)
        if (!part_of_model(s, scene->bodies.data[i].model))
            return false;
    if (noc_embree_build_bodies(s))
        return true;
    if (s->bodies)
        rtcReleaseScene(s->bodies);
    s->bodies = NULL;
    return false;
}

static bool fit_models(embree_structure *s) {
    size_t models = s->scene->models.len;
    if (!array_reserve(&s->models, models))
        return no_memory(s);
    while (s->models.len < models)
        s->models.data[s->models.len++] = NULL;
    return true;
}

noc_status noc_embree_follow(embree_structure *s) {
    embree_parts world = { 0 };
    embree_generation made = { 0 };
    s->failed = NOC_OK;
    atomic_store(&s->refused, false);
    bool ok = noc_embree_room(s->device->threads, 0) || no_memory(s);
    if (!ok || !make_world(s, &world) || !fit_models(s) || !make_bodies(s) || !make_generation(s, &world, &made)) {
        release_generation(&made);
        release_parts(&world);
        return s->failed;
    }
    release_generation(&s->past);
    release_parts(&s->world);
    s->past = s->now;
    s->now = made;
    s->world = world;
    s->geometry = s->scene->versions.geometry;
    s->instances = s->scene->versions.instances;
    return NOC_OK;
}
