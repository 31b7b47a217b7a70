/* Which distribution a lamp has: what a rule says, the user's for all, or a built-in one by its fitting. They go to the
 * scene when the first lamp wants them. */
#include "city/lamp.h"

#include <math.h>
#include <stdio.h>

typedef struct kept_profile {
    noc_profile *profile;
    int index; /* in the scene; 0: not there yet */
    size_t lights;
    bool round;                   /* alike all around its axis */
    char *name, *path;            /* of files; NULL: of built-in ones */
    double lumens, watts, kelvin; /* of files; NaN: not told */
} kept_profile;

struct city_profiles {
    noc_scene *scene;
    NOC_ARRAY(kept_profile) of; /* CITY_PROFILES of kinds, and those of rules */
    bool own;
};

/* Limits of what hangs over streets: bollards have some 200 lm, high masts 200,000; bare globes send a half upward. */
#define LEAST_LUMENS 100
#define MOST_LUMENS 500000
#define MOST_UPWARD (2. / 3)

#define ROUND                                                                                                          \
    0.05 /* of the peak, by which planes of one that is alike all around differ: measured ones do a little             \
          */

static bool is_round(const noc_profile *profile) {
    noc_profile_info info;
    noc_profile_get_info(profile, &info);
    for (int g = 0; g < info.gamma_count; g++) {
        double least = INFINITY, most = 0;
        for (int c = 0; c < info.c_count; c++) {
            least = NOC_MIN(least, info.cd[c * info.gamma_count + g]);
            most = NOC_MAX(most, info.cd[c * info.gamma_count + g]);
        }
        if (most - least > ROUND * info.peak)
            return false;
    }
    return true;
}

/* Reads a file, and reports one that can be no street light. */
static noc_status load(kept_profile *k, const char *path, noc_log *log) {
    noc_profile_info info;
    noc_status status = noc_profile_load(log, path, &k->profile);
    if (status)
        return status;
    noc_profile_get_info(k->profile, &info);
    k->lumens = info.lumens;
    k->watts = info.watts > 0 ? info.watts : NAN;
    k->kelvin = info.kelvin > 0 ? info.kelvin : NAN;
    if (info.upward > MOST_UPWARD)
        noc_warn(log, "%s: sends %.0f %% of its light upward, as no street light does", path, 100 * info.upward);
    if (info.lumens < LEAST_LUMENS || info.lumens > MOST_LUMENS)
        noc_warn(
            log,
            "%s: its flux is %.3g lm, which no street light has: lamps that tell neither lumens nor watts shine with "
            "that, so is it a distribution for a flux that is said elsewhere?",
            path, info.lumens);
    return NOC_OK;
}

city_profiles *city_profiles_create(noc_scene *scene, const char *file, noc_status *status) {
    city_profiles *p = noc_calloc(1, sizeof(*p));
    *status = p && array_reserve(&p->of, CITY_PROFILES) ? NOC_OK : noc_scene_out_of_memory(scene);
    if (!*status) {
        p->of.len = CITY_PROFILES;
        memset(p->of.data, 0, CITY_PROFILES * sizeof(*p->of.data));
        p->scene = scene;
        p->own = file && *file;
        const char *slash = p->own ? strrchr(file, '/') : NULL;
        p->of.data[CITY_PROFILE_OWN].name = p->own ? noc_strdup(slash ? slash + 1 : file) : NULL;
        *status = !p->own || p->of.data[CITY_PROFILE_OWN].name ? NOC_OK : noc_scene_out_of_memory(scene);
    }
    if (!*status && p->own)
        *status = load(&p->of.data[CITY_PROFILE_OWN], file, scene->log);
    if (!*status)
        return p;
    city_profiles_destroy(p);
    return NULL;
}

void city_profiles_destroy(city_profiles *p) {
    for (size_t i = 0; p && i < p->of.len; i++) {
        noc_profile_destroy(p->of.data[i].profile);
        free(p->of.data[i].name);
        free(p->of.data[i].path);
    }
    if (p)
        array_free(&p->of);
    free(p);
}

static const char *name_of(const city_profiles *p, size_t i) {
    return p->of.data[i].name ? p->of.data[i].name : noc_profile_builtin_name((int)i);
}

int city_profiles_builtin(const char *name) {
    for (int i = 0; noc_profile_builtin_name(i); i++)
        if (!strcmp(noc_profile_builtin_name(i), name))
            return i + 1;
    return 0;
}

noc_status city_profiles_read(city_profiles *p, const char *path, const char *name, int *number) {
    for (size_t i = CITY_PROFILES; i < p->of.len; i++)
        if (!strcmp(p->of.data[i].path, path)) {
            *number = (int)i + 1;
            return NOC_OK;
        }
    kept_profile made = { .name = noc_strdup(name), .path = noc_strdup(path) };
    bool room = made.name && made.path && array_reserve(&p->of, p->of.len + 1);
    noc_status status = room ? load(&made, path, p->scene->log) : noc_scene_out_of_memory(p->scene);
    if (!status) {
        p->of.data[p->of.len++] = made;
        *number = (int)p->of.len;
        return NOC_OK;
    }
    free(made.name);
    free(made.path);
    return status;
}

static size_t chosen(const city_profiles *p, city_profile_kind kind, int ruled) {
    return ruled > 0 ? (size_t)ruled - 1 : p->own ? CITY_PROFILE_OWN : (size_t)kind;
}

void city_profiles_file(const city_profiles *p, geo_fitting *f) {
    size_t i = p && f->profile != GEO_NO_PROFILE ? chosen(p, CITY_PROFILE_COBRA_HEAD, f->profile) : 0;
    if (i < CITY_PROFILE_OWN)
        return;
    f->file_lumens = p->of.data[i].lumens;
    f->file_watts = p->of.data[i].watts;
    f->file_kelvin = p->of.data[i].kelvin;
}

bool city_profile_is_round(const city_profiles *p, city_profile_kind kind, int ruled) {
    return p->of.data[chosen(p, kind, ruled)].round;
}

const char *city_profile_name(const city_profiles *p, city_profile_kind kind, int ruled) {
    size_t i = p ? chosen(p, kind, ruled) : 0;
    return p ? name_of(p, i) : "";
}

/* Turns c0 about the axis, counter-clockwise as seen from behind it: the way that C goes. */
static void turn(double degrees, const double axis[3], double c0[3]) {
    double angle = degrees * M_PI / 180, length = 0, c90[3];
    for (int k = 0; k < 3; k++)
        length += axis[k] * axis[k];
    for (int k = 0; k < 3; k++) /* c0 x axis */
        c90[k] = (c0[(k + 1) % 3] * axis[(k + 2) % 3] - c0[(k + 2) % 3] * axis[(k + 1) % 3]) / sqrt(length);
    for (int k = 0; k < 3; k++)
        c0[k] = cos(angle) * c0[k] + sin(angle) * c90[k];
}

bool city_profile_give(city_profiles *p, city_profile_kind kind, const geo_fitting *ruled, const double street[3],
                       noc_light *light) {
    size_t i = chosen(p, kind, ruled->profile);
    kept_profile *k = &p->of.data[i];
    if (!k->profile && noc_profile_builtin(NULL, name_of(p, i), &k->profile)) {
        noc_scene_out_of_memory(p->scene); /* there is one of each name */
        return false;
    }
    if (!k->index) {
        k->round = is_round(k->profile);
        k->index = noc_scene_add_profile(p->scene, k->profile);
    }
    if (k->index < 1)
        return false;
    k->lights++;
    light->profile = k->index;
    noc_profile_orient(k->profile, light->direction, street, light->c0);
    if (isfinite(ruled->turn))
        turn(ruled->turn, light->direction, light->c0);
    return true;
}

void city_profiles_tell(const city_profiles *p, char *text, size_t size) {
    size_t n = 0;
    *text = 0;
    for (size_t i = 0; p && i < p->of.len; i++)
        if (p->of.data[i].lights && n < size)
            n += (size_t)noc_snprintf(text + n, size - n, "%s%s %zu", n ? ", " : "", name_of(p, i),
                                      p->of.data[i].lights);
}
