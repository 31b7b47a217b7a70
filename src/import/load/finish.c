/* What a scene is given as a whole, whatever it was made of: the map around it, and what its classes are made of. */
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
    scene->wet = wet;
    return status;
}
