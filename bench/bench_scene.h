/* What the frame benches share: scenes and views from their command lines, medians. */
#ifndef NOC_BENCH_SCENE_H
#define NOC_BENCH_SCENE_H

#include <nocturne/nocturne.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void bench_tell(void *user, noc_log_level level, const char *text) {
    (void)user;
    (void)level;
    fprintf(stderr, "%s\n", text);
}

/* Warnings and errors go to stderr. */
static inline noc_log *bench_log(void) {
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = bench_tell });
}

/* "city" or "city:METRES" is the built-in city, anything else files to load as one scene, with commas between them.
 * NULL after saying why. */
static inline noc_scene *bench_scene(const char *spec, noc_log *log) {
    noc_scene *scene = noc_scene_create(log);
    noc_city_params city = noc_city_default_params();
    noc_status status;
    if (!strncmp(spec, "city", 4) && (spec[4] == ':' || !spec[4])) {
        if (spec[4] == ':')
            city.size = atof(spec + 5);
        status = noc_scene_add_city(scene, &city);
        status = status == NOC_OK ? noc_scene_commit(scene) : status;
    } else {
        const char *paths[16];
        size_t count = 0;
        char *copy = strdup(spec);
        for (char *rest = copy, *path; copy && count < 16 && (path = strtok_r(rest, ",", &rest));)
            paths[count++] = path;
        status = noc_scene_load(scene, paths, count, NULL, NULL);
        free(copy);
    }
    if (status == NOC_OK)
        return scene;
    noc_scene_destroy(scene);
    return NULL;
}

static inline noc_viewpoint bench_view(const char *name) {
    return !strcmp(name, "aerial")     ? NOC_VIEWPOINT_AERIAL
           : !strcmp(name, "overview") ? NOC_VIEWPOINT_OVERVIEW
           : !strcmp(name, "own")      ? NOC_VIEWPOINT_OWN
                                       : NOC_VIEWPOINT_STREET;
}

static inline int bench_by_size(const void *a, const void *b) {
    double d = *(const double *)a - *(const double *)b;
    return (d > 0) - (d < 0);
}

/* Sorts x. */
static inline double bench_median(double *x, int n) {
    qsort(x, (size_t)n, sizeof(*x), bench_by_size);
    return x[n / 2];
}

#endif
