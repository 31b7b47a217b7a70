/* What a map beside a picture shows. */
#include "scene/scene.h"

#include <math.h>
#include <nocturne/map.h>

enum { CELLS = 16384 };

static bool is_rectangle(const noc_map_params *p) {
    for (int k = 0; k < 2; k++)
        if (!(fabs(p->min[k]) < 1e7 && fabs(p->max[k]) < 1e7 && p->min[k] < p->max[k]))
            return false;
    return p->width >= 1 && p->width <= CELLS && p->height >= 1 && p->height <= CELLS &&
           (p->from == INFINITY || fabs(p->from) < 1e7);
}

static void tell(const noc_hit *hit, size_t i, float *height, uint8_t *cls, int *object) {
    if (height)
        height[i] = hit->hit ? (float)hit->place[2] : NAN;
    if (cls)
        cls[i] = hit->hit ? (uint8_t)hit->cls : NOC_MAP_NOTHING;
    if (object)
        object[i] = hit->hit ? hit->object : -1;
}

/* Rows from `first` on, as many as there is room for. */
static noc_status map_rows(const noc_map_params *p, double from, int first, int rows, noc_cast_fn cast, void *user,
                           noc_ray *rays, noc_hit *hits) {
    size_t width = (size_t)p->width;
    for (int row = 0; row < rows; row++)
        for (int x = 0; x < p->width; x++)
            rays[(size_t)row * width + (size_t)x] =
                (noc_ray){ { p->min[0] + (x + .5) / p->width * (p->max[0] - p->min[0]),
                             p->max[1] - (first + row + .5) / p->height * (p->max[1] - p->min[1]), from },
                           { 0, 0, -1 },
                           INFINITY };
    return cast(user, rays, (size_t)rows * width, hits);
}

noc_status noc_scene_map(const noc_scene *scene, const noc_map_params *p, noc_cast_fn cast, void *user,
                         const noc_progress *progress, float *height, uint8_t *cls, int *object) {
    if (!scene || !p || !cast)
        return noc_null(scene ? scene->log : NULL, __func__);
    if (!is_rectangle(p))
        return noc_error(scene->log, NOC_ERR_ARGUMENT,
                         "map: it must be a rectangle within 10 000 km, of 1 to %d cells a side", CELLS);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    double from = isfinite(p->from) ? p->from : info.bounds_max[2] + 1;
    int at_once = NOC_MAX(1 << 15, p->width) / p->width;
    size_t room = (size_t)at_once * (size_t)p->width;
    noc_ray *rays = noc_alloc(room * sizeof(*rays));
    noc_hit *hits = noc_alloc(room * sizeof(*hits));
    noc_status status = rays && hits ? NOC_OK : noc_no_memory(scene->log, "map");
    for (int first = 0; first < p->height && !status; first += at_once) {
        int rows = NOC_MIN(at_once, p->height - first);
        if (progress && progress->update && !progress->update(progress->user, "map", (double)first / p->height))
            status = noc_cancelled(scene->log, "map: cancelled");
        else
            status = map_rows(p, from, first, rows, cast, user, rays, hits);
        for (size_t i = 0; i < (size_t)rows * (size_t)p->width && !status; i++)
            tell(&hits[i], (size_t)first * (size_t)p->width + i, height, cls, object);
    }
    free(rays);
    free(hits);
    return status;
}

noc_status noc_scene_get_car(const noc_scene *scene, size_t index, noc_car_info *car) {
    if (!scene || !car)
        return noc_null(scene ? scene->log : NULL, __func__);
    noc_scene_lock_read(scene);
    size_t cars = scene->cars.len;
    if (index < cars) {
        const noc_scene_car *c = &scene->cars.data[index];
        double m[12];
        noc_car_pose(scene, c, scene->time, m);
        *car = (noc_car_info){ (int)c->instance, (int)c->route, { m[3], m[7], m[11] }, atan2(m[4], m[0]) };
    }
    noc_scene_unlock_read(scene);
    return index < cars ? NOC_OK
                        : noc_error(scene->log, NOC_ERR_ARGUMENT, "car %zu: the scene has %zu cars", index, cars);
}

size_t noc_scene_track_count(const noc_scene *scene) {
    if (!scene)
        return 0;
    noc_scene_lock_read(scene);
    size_t count = scene->routes.len;
    noc_scene_unlock_read(scene);
    return count;
}

size_t noc_scene_get_track(const noc_scene *scene, size_t track, noc_track_stop *stops, size_t most) {
    if (!scene)
        return 0;
    noc_scene_lock_read(scene);
    size_t count = track < scene->routes.len ? scene->routes.data[track].count : 0;
    const noc_scene_stop *of = count ? scene->stops.data + scene->routes.data[track].first : NULL;
    for (size_t i = 0; i < count && i < most && stops; i++)
        stops[i] = (noc_track_stop){ { of[i].p[0], of[i].p[1], of[i].p[2] },
                                     of[i].seconds,
                                     i == 0 || (of[i].along == 0 && of[i - 1].along > 0) };
    noc_scene_unlock_read(scene);
    return count;
}
