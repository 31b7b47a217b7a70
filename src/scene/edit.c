/* Edits of what a scene holds: each is looked at where it is called, and staged for noc_scene_commit. */
#include "scene/scene.h"

#include <math.h>

static noc_status stage(noc_scene *scene, const noc_edit *edit) {
    if (scene->no_memory)
        return NOC_ERR_MEMORY;
    return array_push(&scene->edits, *edit) ? NOC_OK : noc_scene_out_of_memory(scene);
}

static bool colour_within(const float rgb[3], float most) {
    return rgb[0] >= 0 && rgb[0] <= most && rgb[1] >= 0 && rgb[1] <= most && rgb[2] >= 0 && rgb[2] <= most;
}

/* A model's lights are made once. Groups and noc_scene_set_emission are for what they emit. */
static bool lights_model(const noc_scene *scene, int material, const noc_material *m) {
    const noc_material *have = &scene->materials.data[material];
    bool shines = noc_material_shines(m);
    if (shines == noc_material_shines(have) &&
        (!shines || (!memcmp(m->emission, have->emission, sizeof(m->emission)) && m->two_sided == have->two_sided)))
        return false;
    for (size_t i = 0; scene->models.len && i < scene->meshes.len; i++)
        if (scene->meshes.data[i].model && scene->meshes.data[i].material == material)
            return true;
    return false;
}

noc_status noc_scene_set_material(noc_scene *scene, int material, const noc_material *m) {
    if (!scene || !m)
        return noc_null(scene ? scene->log : NULL, __func__);
    const char *wrong = noc_material_fault(scene, m);
    if (material < 0 || (size_t)material >= scene->materials.len)
        wrong = "the scene has no such material, or it is not committed yet";
    else if (!wrong && (m->cls == NOC_CLASS_CLOSURE) != (scene->materials.data[material].cls == NOC_CLASS_CLOSURE))
        wrong = "a closure stays one, and nothing else becomes one";
    else if (!wrong && noc_material_lets_through(m) != noc_material_lets_through(&scene->materials.data[material]))
        wrong = "a surface that lets light through stays one, and no other becomes one";
    else if (!wrong && lights_model(scene, material, m))
        wrong = "a model is made of it, so its emission stays";
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "material %d: %s", material, wrong);
    return stage(scene, &(noc_edit){ .kind = NOC_EDIT_MATERIAL, .index = (uint32_t)material, .material = *m });
}

noc_status noc_scene_set_class_material(noc_scene *scene, noc_class cls, const noc_material *m) {
    if (!scene || !m)
        return noc_null(scene ? scene->log : NULL, __func__);
    const char *wrong = (unsigned)cls < NOC_CLASS_COUNT ? noc_material_fault(scene, m) : "there is no such class";
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "material of class %d: %s", (int)cls, wrong);
    return stage(scene, &(noc_edit){ .kind = NOC_EDIT_CLASS, .index = cls, .material = *m });
}

int noc_scene_add_group(noc_scene *scene, const char *name) {
    if (!scene) {
        noc_null(NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    if (scene->groups.len == UINT16_MAX) {
        noc_error(scene->log, NOC_ERR_UNSUPPORTED, "group %s: more than 65535 groups in a scene",
                  name ? name : "unnamed");
        return -1;
    }
    noc_scene_group group = { .scale = { 1, 1, 1 } };
    if (!noc_scene_keep_name(scene, name, &group.name))
        return -1;
    if (!array_push(&scene->groups, group)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    return (int)scene->groups.len;
}

/* Also reports that there is no such group. */
static bool group_there(const noc_scene *scene, int group) {
    bool there = group >= 1 && (size_t)group <= scene->groups.len;
    if (!there)
        noc_error(scene->log, NOC_ERR_ARGUMENT, "group %d: the scene has %zu groups", group, scene->groups.len);
    return there;
}

noc_status noc_scene_colour_group(noc_scene *scene, int group, const float rgb[3]) {
    if (!scene)
        return noc_null(NULL, __func__);
    if (!group_there(scene, group))
        return NOC_ERR_ARGUMENT;
    noc_edit edit = { .kind = NOC_EDIT_GROUP_COLOUR, .index = (uint32_t)group };
    float luminance = rgb ? 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2] : 1;
    if (rgb && !(colour_within(rgb, 1e12f) && luminance > 0))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "group %d: its colour is black, negative or not finite", group);
    for (int k = 0; k < 3 && rgb; k++)
        edit.rgb[k] = rgb[k] / luminance;
    return stage(scene, &edit);
}

noc_status noc_scene_set_group(noc_scene *scene, int group, const float scale[3]) {
    if (!scene || !scale)
        return noc_null(scene ? scene->log : NULL, __func__);
    if (!group_there(scene, group))
        return NOC_ERR_ARGUMENT;
    noc_edit edit = { .kind = NOC_EDIT_GROUP, .index = (uint32_t)group };
    memcpy(edit.rgb, scale, sizeof(edit.rgb));
    if (!colour_within(scale, 1e6f))
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "group %d: its scale must be in 0..1000000", group);
    return stage(scene, &edit);
}

int noc_scene_find_group(const noc_scene *scene, const char *name) {
    for (size_t i = 0; scene && name && i < scene->groups.len; i++)
        if (scene->groups.data[i].name && !strcmp(scene->groups.data[i].name, name))
            return (int)i + 1;
    return 0;
}

int noc_scene_group_named(noc_scene *s, const char *name) {
    int group = noc_scene_find_group(s, name);
    group = group ? group : noc_scene_add_group(s, name);
    return NOC_MAX(group, 0);
}

size_t noc_scene_groups(const noc_scene *scene, noc_group_info *groups, size_t count) {
    if (!scene)
        return 0;
    size_t all = scene->groups.len + 1;
    for (size_t i = 0; groups && i < NOC_MIN(count, all); i++) {
        static const noc_scene_group none = { .scale = { 1, 1, 1 } };
        const noc_scene_group *g = i ? &scene->groups.data[i - 1] : &none;
        groups[i] = (noc_group_info){ .name = g->name ? g->name : "" };
        memcpy(groups[i].scale, g->scale, sizeof(g->scale));
        memcpy(groups[i].colour, g->colour, sizeof(g->colour));
    }
    noc_scene_lock_read(scene);
    for (size_t i = 0; groups && i < scene->lights.len; i++) {
        const noc_light_record *r = &scene->lights.data[i];
        uint32_t group = noc_light_group(r);
        if (r->flags & NOC_LIGHT_FREE || group >= count)
            continue;
        groups[group].lights++;
        groups[group].lumens += noc_light_flux(r);
    }
    noc_scene_unlock_read(scene);
    return all;
}

/* Also reports that there is no such light. */
static const noc_light_record *light_at(const noc_scene *scene, int index) {
    if (index >= 0 && (size_t)index < scene->lights.len && !(scene->lights.data[index].flags & NOC_LIGHT_FREE))
        return &scene->lights.data[index];
    noc_error(scene->log, NOC_ERR_ARGUMENT, "light %d: the scene has no such light, or it is not committed yet", index);
    return NULL;
}

static noc_status light_error(const noc_scene *scene, int index, const char *wrong) {
    const char *name = scene->light_names.data[index];
    return noc_error(scene->log, NOC_ERR_ARGUMENT, "light %d (%s): %s", index, name ? name : "unnamed", wrong);
}

noc_status noc_scene_set_emission(noc_scene *scene, int light, const float emission[3]) {
    if (!scene || !emission)
        return noc_null(scene ? scene->log : NULL, __func__);
    if (!light_at(scene, light))
        return NOC_ERR_ARGUMENT;
    if (!colour_within(emission, 1e12f))
        return light_error(scene, light, "its emission is negative or not finite");
    noc_edit edit = { .kind = NOC_EDIT_EMISSION, .index = (uint32_t)light };
    memcpy(edit.rgb, emission, sizeof(edit.rgb));
    return stage(scene, &edit);
}

noc_status noc_scene_move_light(noc_scene *scene, int index, const noc_light *to) {
    if (!scene || !to)
        return noc_null(scene ? scene->log : NULL, __func__);
    const noc_light_record *have = light_at(scene, index);
    if (!have)
        return NOC_ERR_ARGUMENT;
    noc_light with = *to;
    with.profile = (int)((have->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE);
    const char *wrong = noc_light_fault(to);
    if (!wrong)
        wrong = noc_light_profile_fault(scene, &with);
    if (have->flags & NOC_LIGHT_OWNED)
        wrong = "it is part of a mesh or of an instance";
    else if (!(have->flags & NOC_LIGHT_MOVES))
        wrong = "it was not made to move";
    else if (have->kind != (uint32_t)to->kind)
        wrong = "a light's kind cannot change";
    if (wrong)
        return light_error(scene, index, wrong);
    noc_edit edit = { .kind = NOC_EDIT_MOVE_LIGHT,
                      .index = (uint32_t)index,
                      .light = noc_light_record_of(scene, &with) };
    edit.light.flags = have->flags;
    return stage(scene, &edit);
}

noc_status noc_scene_remove_light(noc_scene *scene, int light) {
    if (!scene)
        return noc_null(NULL, __func__);
    const noc_light_record *have = light_at(scene, light);
    if (!have)
        return NOC_ERR_ARGUMENT;
    if (have->flags & NOC_LIGHT_OWNED)
        return light_error(scene, light, "it is part of a mesh or of an instance, and goes with that");
    return stage(scene, &(noc_edit){ .kind = NOC_EDIT_REMOVE_LIGHT, .index = (uint32_t)light });
}

/* The meshes that show lights which were added as such go with those. */
static bool shows_light(const noc_scene *scene, const noc_scene_mesh *m) {
    uint32_t light = m->triangle_count ? scene->triangle_light.data[m->first_triangle] : NOC_NO_LIGHT;
    return light != NOC_NO_LIGHT && !(scene->lights.data[light].flags & NOC_LIGHT_OWNED);
}

noc_status noc_scene_remove_mesh(noc_scene *scene, int mesh) {
    if (!scene)
        return noc_null(NULL, __func__);
    const noc_scene_mesh *m = mesh >= 0 && (size_t)mesh < scene->meshes.len ? &scene->meshes.data[mesh] : NULL;
    const char *wrong = !m || m->removed        ? "the scene has no such mesh, or it is not committed yet"
                        : m->model              ? "it is part of a model"
                        : shows_light(scene, m) ? "it shows a light, and goes with that"
                                                : NULL;
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "mesh %d: %s", mesh, wrong);
    return stage(scene, &(noc_edit){ .kind = NOC_EDIT_REMOVE_MESH, .index = (uint32_t)mesh });
}
