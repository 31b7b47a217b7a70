/* The map around a scene: an equirectangular picture, made fit for being seen and for lighting. */
#include "scene/scene.h"

#include <math.h>

#define BRIGHTEST 1e9f /* the sun's disc has some 1.6e9 cd/m2 */

double noc_environment_sine(int row, int rows) { return row == rows ? -1 : cos(M_PI * row / rows); }

/* Solid angle of a row of texels, by its share of the sphere's height. */
static double row_share(int row, int rows) {
    return noc_environment_sine(row, rows) - noc_environment_sine(row + 1, rows);
}

/* Half as wide and high; each texel is the mean of four over their solid angles, so that no light is lost. */
static void halve(float *to, const float *from, int width, int height) {
    for (int y = 0; y < height / 2; y++) {
        double upper = row_share(2 * y, height), lower = row_share(2 * y + 1, height), share = upper / (upper + lower);
        const float *a = from + 6 * (size_t)width * (size_t)y, *b = a + 3 * (size_t)width;
        for (int x = 0; x < width / 2; x++, a += 6, b += 6, to += 3)
            for (int k = 0; k < 3; k++) {
                double above = ((double)a[k] + a[k + 3]) / 2, below = ((double)b[k] + b[k + 3]) / 2;
                to[k] = (float)(below + (above - below) * share);
            }
    }
}

static bool can_be_halved(int width, int height) { return width % 2 == 0 && height % 2 == 0; }

/* How many are not light, and are taken for something else. */
static size_t take_texels(float *to, const float *from, size_t count) {
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        bool wrong = false;
        for (size_t k = 3 * i; k < 3 * i + 3; k++) {
            float v = from[k];
            to[k] = v >= 0 && isfinite(v) ? fminf(v, BRIGHTEST) : 0;
            wrong = wrong || to[k] != v;
        }
        bad += wrong;
    }
    return bad;
}

static void measure_light(noc_environment *e) {
    for (int y = 0; y < e->light_height; y++) {
        double upper = noc_environment_sine(y, e->light_height), lower = noc_environment_sine(y + 1, e->light_height);
        double sum = 0, open = fmax(upper, 0), shut = fmax(lower, 0);
        const float *c = e->light + 3 * (size_t)y * (size_t)e->light_width;
        for (int x = 0; x < e->light_width; x++, c += 3)
            sum += 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        sum *= 2 * M_PI / e->light_width;
        e->power += sum * (upper - lower);
        e->lux += sum * (open * open - shut * shut) / 2;
    }
}

/* Takes *texels of width x height down to at most `most` columns, where that can be; what it held is freed then.
 * keep: what *texels points to is left to its owner. */
static bool reduce(float **texels, int *width, int *height, int most, bool keep) {
    while (*width > most && can_be_halved(*width, *height)) {
        float *less = noc_alloc_large((size_t)(*width / 2) * (size_t)(*height / 2), 3 * sizeof(float));
        if (!less) {
            if (!keep)
                free(*texels);
            *texels = NULL;
            return false;
        }
        halve(less, *texels, *width, *height);
        if (!keep)
            free(*texels);
        keep = false;
        *texels = less;
        *width /= 2;
        *height /= 2;
    }
    return true;
}

void noc_environment_free(noc_environment *e) {
    if (!e)
        return;
    if (e->light != e->texels)
        free(e->light);
    free(e->texels);
    free(e);
}

noc_environment *noc_environment_make(const noc_image *map, size_t *bad) {
    noc_environment *e = noc_calloc(1, sizeof(*e));
    if (!e)
        return NULL;
    e->given = e->width = map->width;
    e->height = map->height;
    e->texels = noc_alloc_large((size_t)e->width * (size_t)e->height, 3 * sizeof(float));
    bool room = e->texels != NULL;
    if (room) {
        *bad = take_texels(e->texels, map->rgb, (size_t)e->width * (size_t)e->height);
        room = reduce(&e->texels, &e->width, &e->height, NOC_ENVIRONMENT_SEEN, false);
    }
    if (room) {
        e->light = e->texels;
        e->light_width = e->width;
        e->light_height = e->height;
        room = reduce(&e->light, &e->light_width, &e->light_height, NOC_ENVIRONMENT_LIGHTS, true);
    }
    if (!room) {
        noc_environment_free(e);
        return NULL;
    }
    measure_light(e);
    size_t texels = (size_t)e->width * (size_t)e->height;
    size_t lights = e->light == e->texels ? 0 : (size_t)e->light_width * (size_t)e->light_height;
    e->bytes = (texels + lights) * 3 * sizeof(float);
    return e;
}

/* Whether it can be taken down to as few texels as are drawn from. */
bool noc_environment_fits(int width, int height) {
    while (width > NOC_ENVIRONMENT_LIGHTS && can_be_halved(width, height)) {
        width /= 2;
        height /= 2;
    }
    return (int64_t)width * height < NOC_ENVIRONMENT_TEXELS;
}

noc_status noc_scene_name_environment(noc_scene *scene, const noc_image *map, const char *name) {
    noc_environment *e = NULL;
    size_t bad = 0;
    if (map && (map->height < 1 || map->width % 2 || map->width / 2 != map->height))
        return noc_error(scene->log, NOC_ERR_ARGUMENT,
                         "%s: a picture of %d x %d pixels is not equirectangular: that is twice as wide as high", name,
                         map->width, map->height);
    if (map && !noc_environment_fits(map->width, map->height))
        return noc_error(scene->log, NOC_ERR_ARGUMENT,
                         "%s: a picture of %d x %d pixels is too large, and cannot be halved to below %d", name,
                         map->width, map->height, NOC_ENVIRONMENT_TEXELS);
    if (map && !(e = noc_environment_make(map, &bad)))
        return noc_error(scene->log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", name, map->width, map->height);
    if (bad)
        noc_warn(scene->log, "%s: %zu of %zu pixels are negative, not finite or over 1e9, and are taken as 0 or 1e9",
                 name, bad, (size_t)map->width * (size_t)map->height);
    noc_scene_lock_commit(scene); /* frames read it */
    noc_environment *before = scene->environment;
    scene->environment = e;
    scene->versions.environment++;
    scene->versions.commits += scene->committed;
    noc_scene_unlock_commit(scene);
    noc_environment_free(before);
    return NOC_OK;
}

noc_status noc_scene_set_environment(noc_scene *scene, const noc_image *map) {
    if (!scene || (map && !map->rgb))
        return noc_null(scene ? scene->log : NULL, __func__);
    return noc_scene_name_environment(scene, map, "environment");
}
