/* Shapes and materials of lights that were removed, for lights that are added: scenes whose lights come and go stay as
 * large as they were.
 *
 * Shapes of a kind have equal numbers of vertices and triangles, so one takes another's place in the arrays. Those of
 * the first commit are left out: what structures hold of it is large, and dear to make anew. */
#include "scene/scene.h"

#include <math.h>

static const struct {
    uint8_t vertices, triangles;
} shapes[NOC_SHAPE_KINDS] = { [NOC_LIGHT_SPHERE] = { 42, 80 },
                              [NOC_LIGHT_DISC] = { 24, 22 },
                              [NOC_LIGHT_TRIANGLE] = { 3, 1 },
                              [NOC_LIGHT_PARALLELOGRAM] = { 4, 2 } };

static int shape_kind(size_t vertices, size_t triangles) {
    for (int kind = 0; kind < NOC_SHAPE_KINDS; kind++)
        if (shapes[kind].vertices == vertices && shapes[kind].triangles == triangles)
            return kind;
    return -1; /* triangles of it had no area */
}

static void forget(noc_scene *s, size_t triangles, size_t vertices) {
    s->positions.len = 3 * vertices;
    s->indices.len = 3 * triangles;
    s->triangle_material.len = s->triangle_light.len = triangles;
    s->triangles_dropped = s->triangles_flat = 0;
}

noc_status noc_shape_stage(noc_scene *s, const noc_mesh *shape, uint32_t light, const char *name, bool *staged) {
    int kind = shape_kind(shape->vertex_count, shape->triangle_count);
    noc_slots *slots = kind < 0 ? NULL : &s->shapes[kind];
    *staged = false;
    if (!slots || slots->taken == slots->free.len)
        return NOC_OK;
    if (!s->reshaped)
        s->reshaped = noc_scene_create_arrays();
    noc_scene *to = s->reshaped;
    if (!to || !noc_scene_reserve_mesh(to, shape) || !array_reserve(&to->reshapes, to->reshapes.len + 1))
        return noc_scene_out_of_memory(s);
    double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    size_t first = to->triangle_light.len, vertices = to->positions.len / 3;
    noc_scene_push_triangles(to, shape, lo, hi);
    if (to->triangle_light.len - first < shape->triangle_count) {
        forget(to, first, vertices);
        return NOC_OK;
    }
    for (size_t t = first; t < to->triangle_light.len; t++)
        to->triangle_light.data[t] = light;
    for (int k = 0; k < 3; k++) {
        to->bounds_min[k] = NOC_MIN(to->bounds_min[k], lo[k]);
        to->bounds_max[k] = NOC_MAX(to->bounds_max[k], hi[k]);
    }
    to->meshes.data[to->meshes.len++] = (noc_scene_mesh){ .first_triangle = (uint32_t)first,
                                                          .triangle_count = (uint32_t)shape->triangle_count,
                                                          .first_vertex = (uint32_t)vertices,
                                                          .material = shape->material,
                                                          .name = name };
    to->reshapes.data[to->reshapes.len++] = noc_slot_next(slots, 0);
    noc_slot_take(slots);
    *staged = true;
    return NOC_OK;
}

static void reshape(noc_scene *s, const noc_scene *from, const noc_scene_mesh *shape, noc_scene_mesh *m) {
    size_t count = shape->triangle_count,
           vertices = noc_mesh_end_vertex(s, (size_t)(m - s->meshes.data)) - m->first_vertex;
    memcpy(s->positions.data + 3 * (size_t)m->first_vertex, from->positions.data + 3 * (size_t)shape->first_vertex,
           3 * vertices * sizeof(float));
    for (size_t i = 0; i < 3 * count; i++)
        s->indices.data[3 * (size_t)m->first_triangle + i] =
            from->indices.data[3 * (size_t)shape->first_triangle + i] - shape->first_vertex + m->first_vertex;
    for (size_t t = 0; t < count; t++) {
        s->triangle_material.data[m->first_triangle + t] = (uint32_t)shape->material;
        s->triangle_light.data[m->first_triangle + t] = from->triangle_light.data[shape->first_triangle + t];
    }
    m->material = shape->material;
    m->name = shape->name;
    m->removed = false;
    m->made = (uint32_t)s->versions.geometry + 1;
    noc_material_use(s, m);
}

void noc_shapes_put(noc_scene *s, noc_changes *c) {
    noc_scene *from = s->reshaped;
    if (!from)
        return;
    for (size_t i = 0; i < from->meshes.len; i++)
        reshape(s, from, &from->meshes.data[i], &s->meshes.data[from->reshapes.data[i]]);
    for (int k = 0; k < 3; k++) {
        s->bounds_min[k] = NOC_MIN(s->bounds_min[k], from->bounds_min[k]);
        s->bounds_max[k] = NOC_MAX(s->bounds_max[k], from->bounds_max[k]);
    }
    if (from->meshes.len)
        c->geometry = c->mesh_left = c->ground_left = true;
    noc_scene_destroy(from);
    s->reshaped = NULL;
}

void noc_shape_release(noc_scene *s, size_t mesh) {
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    int kind = shape_kind(noc_mesh_end_vertex(s, mesh) - m->first_vertex, m->triangle_count);
    if (s->committed && mesh >= s->first_later && kind >= 0)
        s->shapes[kind].released.data[s->shapes[kind].released.len++] = (uint32_t)mesh;
}

void noc_material_use(noc_scene *s, const noc_scene_mesh *m) {
    uint32_t *uses = &s->material_uses.data[m->material];
    *uses += *uses != NOC_NOT_OF_LIGHTS;
}

void noc_material_drop(noc_scene *s, const noc_scene_mesh *m) {
    uint32_t *uses = &s->material_uses.data[m->material];
    if (*uses != NOC_NOT_OF_LIGHTS && !--*uses)
        s->light_materials.released.data[s->light_materials.released.len++] = (uint32_t)m->material;
}
