/* The built-in scenes by name. */
#include "city/city.h"
#include "city/builtin/kit.h"

static noc_status city(noc_scene *scene, const noc_builtin_params *params, bool windows) {
    return town_build(scene, &params->city, &(town_style){ .windows = windows, .often = 1 });
}

static const struct {
    const char *name;
    noc_status (*add)(noc_scene *scene, const noc_builtin_params *params, bool windows);
} scenes[] = {
    { "city", city },           { "cityscape", scene_cityscape }, { "mess", scene_mess },
    { "single", scene_single }, { "atrium", scene_atrium },
};

const char *const *noc_builtin_names(void) {
    static const char *const names[] = { "city", "cityscape", "mess", "single", "atrium", NULL };
    _Static_assert(NOC_COUNT(names) == NOC_COUNT(scenes) + 1, "every scene has its name in both lists");
    return names;
}

noc_status city_add_builtin(noc_scene *scene, const char *name, const noc_builtin_params *params, bool windows) {
    noc_builtin_params defaults = noc_builtin_default_params();
    params = params ? params : &defaults;
    if (scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "builtin:%.40s: the scene is committed", name);
    for (size_t i = 0; i < NOC_COUNT(scenes); i++)
        if (!strcmp(name, scenes[i].name))
            return scenes[i].add(scene, params, windows);
    char names[256] = "";
    for (size_t i = 0, n = 0; i < NOC_COUNT(scenes); i++)
        n += (size_t)noc_snprintf(names + n, sizeof(names) - n, "%sbuiltin:%s", i ? ", " : "", scenes[i].name);
    return noc_error(scene->log, NOC_ERR_ARGUMENT, "builtin:%.40s: no such scene; there are %s", name, names);
}

noc_status noc_scene_add_builtin(noc_scene *scene, const char *name, const noc_builtin_params *params) {
    if (!scene || !name)
        return noc_null(scene ? scene->log : NULL, __func__);
    return city_add_builtin(scene, name, params, true);
}
