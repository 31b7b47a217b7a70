/* Several built cities as one scene: each is read into a scene of its own, and that is appended. */
#include "import/built/built.h"
#include "city/city.h"
#include "scene/join.h"
#include "scene/keep.h"

#include <math.h>

/* What the first of them decides, and what of all of them goes together. */
typedef struct joining {
    importer *im;
    noc_joiner *joiner;
    const char *const *paths;
    size_t count, at;
    noc_import_params params; /* with our progress */
    double land, lands;       /* heights of the land around them [m], summed, and how many */
    noc_material land_look;
    bool lit_elsewhere; /* all are */
} joining;

static bool update(void *user, const char *what, double done) {
    const joining *j = user;
    const noc_progress *progress = &j->im->params->progress;
    return progress->update(progress->user, what, ((double)j->at + done) / (double)j->count);
}

static bool same_text(const char *a, const char *b) { return a == b || (a && b && !strcmp(a, b)); }

static noc_status no_memory(const joining *j) { return noc_no_memory(j->im->log, j->paths[j->at]); }

static noc_status check_head(const joining *j, const noc_scene *from) {
    const noc_scene *to = j->im->scene;
    const char *path = j->paths[j->at], *first = j->paths[0];
    if (!same_text(to->crs_name, from->crs_name) || !same_text(to->crs_kept, from->crs_kept))
        return noc_error(j->im->log, NOC_ERR_ARGUMENT,
                         "%s: is built in %s, and %s in %s: build them with the same --scene-crs", path,
                         from->crs_name ? from->crs_name : "no CRS", first, to->crs_name ? to->crs_name : "no CRS");
    if (to->wet != from->wet)
        return noc_error(j->im->log, NOC_ERR_ARGUMENT, "%s: is built %s, and %s %s: build them alike", path,
                         from->wet ? "wet" : "dry", first, to->wet ? "wet" : "dry");
    return NOC_OK;
}

static void take_classes(noc_scene *to, const noc_scene *from) {
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        if (from->class_said >> c & 1 && !(to->class_said >> c & 1)) {
            to->class_looks[c] = from->class_looks[c];
            to->class_said |= 1u << c;
        }
}

/* Land around one would lie over the others: there will be one around all, at the mean of their heights. */
static void take_land(joining *j, const noc_scene *from) {
    if (!from->backdrop_count)
        return;
    uint32_t corner = from->indices.data[3 * ((size_t)from->backdrop_first + from->backdrop_count - 1)];
    if (!(j->lands > 0))
        j->land_look = from->materials.data[from->triangle_material.data[from->backdrop_first]];
    j->land += (double)from->positions.data[3 * (size_t)corner + 2] + from->origin[2] - j->im->scene->origin[2];
    j->lands++;
}

static noc_status append(joining *j, noc_scene *from, const noc_report *report) {
    noc_scene *to = j->im->scene;
    double shift[3];
    noc_status status = j->at ? check_head(j, from) : built_copy_head(from, to) ? NOC_OK : no_memory(j);
    if (status)
        return status;
    for (int k = 0; k < 3; k++)
        shift[k] = from->origin[k] - to->origin[k];
    bool *taken = noc_calloc(from->windows.len + 1, sizeof(*taken));
    if (!taken)
        return no_memory(j);
    take_land(j, from);
    take_classes(to, from);
    to->triangles_dropped += from->triangles_dropped;
    to->triangles_flat += from->triangles_flat;
    j->lit_elsewhere = j->lit_elsewhere && from->lit_elsewhere;
    if (!to->environment) {
        to->environment = from->environment;
        from->environment = NULL;
    }
    status = noc_joiner_add(j->joiner, from, shift, NULL, j->paths[j->at], j->paths[0], taken);
    if (!status && !built_join_report(j->im->report, report, taken, from->windows.len))
        status = no_memory(j);
    free(taken);
    return status;
}

static noc_status read_one(joining *j) {
    noc_scene *scene = noc_scene_create(j->im->log);
    noc_report *report = report_create();
    noc_status status = !scene ? NOC_ERR_MEMORY : report ? NOC_OK : no_memory(j);
    double room = j->im->memory - (double)noc_scene_bytes(j->im->scene);
    importer one = {
        .log = j->im->log, .scene = scene, .params = &j->params, .memory = NOC_MAX(room, 0), .report = report
    };
    if (!status)
        status = built_read(&one, j->paths[j->at]);
    status = status ? status : append(j, scene, report);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    return status;
}

/* From the rim of all of them on. Level land has its corners alone, as that of a city that is built at once. */
static noc_status surround(const joining *j) {
    enum { STEPS = 64 };
    noc_scene *to = j->im->scene;
    double level = j->land / j->lands, rim[4 * STEPS * 3], *p = rim;
    const double *lo = to->bounds_min, *hi = to->bounds_max;
    bool even = true;
    if (!(lo[0] < hi[0] && lo[1] < hi[1]))
        return NOC_OK;
    for (int side = 0; side < 4; side++)
        for (int i = 0; i < STEPS; i++, p += 3) {
            double u = side % 2 ? side == 1 : side ? 1 - (double)i / STEPS : (double)i / STEPS;
            double v = side % 2 ? (side == 1 ? (double)i / STEPS : 1 - (double)i / STEPS) : side == 2;
            double inside[2] = { NOC_CLAMP(u, 1e-4, 1 - 1e-4), NOC_CLAMP(v, 1e-4, 1 - 1e-4) };
            p[0] = lo[0] + u * (hi[0] - lo[0]);
            p[1] = lo[1] + v * (hi[1] - lo[1]);
            if (!noc_scene_highest(to, 1u << NOC_CLASS_TERRAIN, lo[0] + inside[0] * (hi[0] - lo[0]),
                                   lo[1] + inside[1] * (hi[1] - lo[1]), &p[2]))
                p[2] = level;
            even = even && fabs(p[2] - level) < 1e-3;
        }
    size_t count = even ? 4 : NOC_COUNT(rim) / 3;
    for (size_t i = 0; even && i < count; i++) {
        memmove(rim + 3 * i, rim + 3 * STEPS * i, 3 * sizeof(*rim));
        rim[3 * i + 2] = level;
    }
    int material = noc_scene_add_material(to, &j->land_look);
    if (material >= 0)
        city_add_surroundings(to, rim, count, material);
    return to->no_memory || material < 0 ? NOC_ERR_MEMORY : NOC_OK;
}

noc_status built_read_all(importer *im, const char *const *paths, size_t count) {
    joining j = { .im = im, .paths = paths, .count = count, .params = *im->params, .lit_elsewhere = true };
    if (j.params.progress.update)
        j.params.progress = (noc_progress){ update, &j };
    j.joiner = noc_joiner_create(im->scene);
    noc_status status = j.joiner ? NOC_OK : NOC_ERR_MEMORY;
    for (; j.at < count && !status; j.at += !status)
        status = read_one(&j);
    if (!status && j.lands > 0)
        status = surround(&j);
    im->scene->lit_elsewhere = !status && j.lit_elsewhere;
    status = status ? status : noc_joiner_finish(j.joiner);
    noc_joiner_destroy(j.joiner);
    if (status)
        noc_kept_forget(im->scene);
    return status;
}
