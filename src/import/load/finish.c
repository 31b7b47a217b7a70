/* What a scene is given as a whole, whatever it was made of: the map around it, and what its classes, and materials
 * that inputs name, are made of. */
#include "import/load/load.h"

#include "scene/scene.h"

noc_status finish_environment(noc_scene *scene, const char *path) {
    bool linear;
    noc_image *map = noc_image_read(path, scene->log, &linear);
    if (!map)
        return noc_log_last_status(scene->log);
    noc_status status = linear
                            ? noc_scene_name_environment(scene, map, path)
                            : noc_error(scene->log, NOC_ERR_FORMAT,
                                        "%s: a PNG holds no luminances: an environment is an EXR or HDR picture", path);
    noc_image_destroy(map);
    return status;
}

/* What a class is made of: as its scene, which may be a built city, was told before, else by default. */
static noc_material made_of(const noc_scene *scene, noc_class cls) {
    return scene->class_said >> cls & 1 ? scene->class_looks[cls] : noc_class_material(cls);
}

/* Some of the names that inputs give, for people. */
static void list_names(const noc_scene *s, char *out, size_t size) {
    size_t n = 0, told = 0;
    *out = 0;
    for (size_t i = 0; i < s->material_names.len && told < 8 && n + 70 < size; i++) {
        const char *name = s->material_names.data[i];
        if (!name || noc_scene_find_material(s, name, 0) != (int)i)
            continue;
        n += (size_t)noc_snprintf(out + n, size - n, "%s\"%.60s\"", told ? ", " : "; there are ", name);
        told++;
    }
}

/* now: the scene's materials, with the images that wait for the commit. */
static noc_status set_named(noc_scene *scene, const noc_named_material *to, noc_material *now) {
    int at = noc_scene_find_material(scene, to->name, 0);
    noc_status status = NOC_OK;
    if (at < 0) {
        char names[600];
        list_names(scene, names, sizeof(names));
        noc_warn(scene->log, "materials-by-name: no input names one \"%.60s\"%s", to->name, names);
    }
    for (; at >= 0 && !status; at = noc_scene_find_material(scene, to->name, at + 1)) {
        noc_material m = now[at];
        if (to->albedo[0] >= 0) {
            memcpy(m.albedo, to->albedo, sizeof(m.albedo));
            m.texture = 0;
        }
        m.f0 = to->f0 >= 0 ? to->f0 : m.f0;
        m.roughness = to->roughness >= 0 ? to->roughness : m.roughness;
        m = to->metalness >= 0 ? noc_material_metal(&m, to->metalness) : m;
        status = noc_scene_set_material(scene, at, &m);
        now[at] = m;
    }
    return status;
}

static noc_status set_all_named(noc_scene *scene, const noc_import_params *params) {
    noc_status status = NOC_OK;
    noc_material *now = noc_alloc(scene->materials.len * sizeof(*now));
    if (!now)
        return noc_no_memory(scene->log, "import");
    for (size_t i = 0; i < scene->materials.len; i++)
        now[i] = scene->materials.data[i];
    for (size_t i = 0; i < scene->edits.len; i++)
        if (scene->edits.data[i].kind == NOC_EDIT_MATERIAL)
            now[scene->edits.data[i].index] = scene->edits.data[i].material;
    for (size_t i = 0; i < params->named_material_count && !status; i++)
        status = params->named_materials[i].name
                     ? set_named(scene, &params->named_materials[i], now)
                     : noc_error(scene->log, NOC_ERR_ARGUMENT, "import: named_materials[%zu] has no name", i);
    free(now);
    return status;
}

/* Classes of what is made of triangles in the scene, models among it; of lamps also where they have bodies. */
static uint32_t classes_of(const noc_scene *scene) {
    uint32_t there = scene->bodies.len ? 1u << NOC_CLASS_LAMP : 0;
    for (size_t t = 0; t < scene->triangle_material.len; t++)
        there |= 1u << scene->materials.data[scene->triangle_material.data[t]].cls;
    return there;
}

static void warn_of_idle(const noc_scene *scene, uint32_t said) {
    uint32_t idle = said ? said & ~classes_of(scene) : 0;
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        if (idle >> c & 1)
            noc_warn(scene->log, "materials: nothing in the scene is of the class %s", noc_class_name((noc_class)c));
}

noc_status finish_materials(noc_scene *scene, const noc_import_params *params) {
    static const noc_class rained[] = { NOC_CLASS_ROAD, NOC_CLASS_SIDEWALK, NOC_CLASS_TERRAIN, NOC_CLASS_GROUND };
    noc_material of[NOC_CLASS_COUNT];
    uint32_t said = 0;
    noc_status status = NOC_OK;
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        of[c] = made_of(scene, (noc_class)c);
    for (size_t i = 0; i < params->material_count; i++) {
        noc_class cls = params->materials[i].cls;
        if ((unsigned)cls >= NOC_CLASS_COUNT)
            return noc_error(scene->log, NOC_ERR_ARGUMENT, "import: materials[%zu] is of class %d", i, (int)cls);
        of[cls] = params->materials[i];
        said |= 1u << cls;
    }
    warn_of_idle(scene, said);
    bool wet = params->wet || scene->wet;
    for (size_t i = 0; i < NOC_COUNT(rained) && wet; i++) {
        if (scene->wet && !(said >> rained[i] & 1))
            continue; /* it is wet already */
        of[rained[i]] = noc_material_wet(&of[rained[i]]);
        said |= 1u << rained[i];
    }
    for (int c = 0; c < NOC_CLASS_COUNT && !status; c++)
        if (said >> c & 1)
            status = noc_scene_set_class_material(scene, (noc_class)c, &of[c]);
    if (!status && params->named_material_count)
        status = set_all_named(scene, params);
    scene->wet = wet;
    return status;
}
