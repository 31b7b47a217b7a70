/* Which distribution a lamp has: a built-in one by its fitting, or the user's for all. They go to the scene when the
 * first lamp wants them. */
#include "city/lamp.h"

#include <stdio.h>

struct city_profiles {
    noc_scene *scene;
    struct {
        noc_profile *profile;
        int index; /* in the scene; 0: not there yet */
        size_t lights;
    } of[CITY_PROFILES];
    bool own;
};

city_profiles *city_profiles_create(noc_scene *scene, const char *file, noc_status *status) {
    city_profiles *p = noc_calloc(1, sizeof(*p));
    *status = p ? NOC_OK : noc_scene_out_of_memory(scene);
    if (p) {
        p->scene = scene;
        p->own = file && *file;
    }
    if (p && p->own)
        *status = noc_profile_load(scene->log, file, &p->of[CITY_PROFILE_OWN].profile);
    if (!*status)
        return p;
    city_profiles_destroy(p);
    return NULL;
}

void city_profiles_destroy(city_profiles *p) {
    for (int i = 0; p && i < CITY_PROFILES; i++)
        noc_profile_destroy(p->of[i].profile);
    free(p);
}

static const char *name_of(int kind) { return kind == CITY_PROFILE_OWN ? "own" : noc_profile_builtin_name(kind); }

bool city_profile_give(city_profiles *p, city_profile_kind kind, const double street[3], noc_light *light) {
    int i = p->own ? CITY_PROFILE_OWN : (int)kind;
    if (!p->of[i].profile && noc_profile_builtin(NULL, name_of(i), &p->of[i].profile)) {
        noc_scene_out_of_memory(p->scene); /* there is one of each name */
        return false;
    }
    if (!p->of[i].index)
        p->of[i].index = noc_scene_add_profile(p->scene, p->of[i].profile);
    if (p->of[i].index < 1)
        return false;
    p->of[i].lights++;
    light->profile = p->of[i].index;
    noc_profile_orient(p->of[i].profile, light->direction, street, light->c0);
    return true;
}

void city_profiles_tell(const city_profiles *p, char *text, size_t size) {
    size_t n = 0;
    *text = 0;
    for (int i = 0; p && i < CITY_PROFILES; i++)
        if (p->of[i].lights && n < size)
            n += (size_t)noc_snprintf(text + n, size - n, "%s%s %zu", n ? ", " : "", name_of(i), p->of[i].lights);
}
