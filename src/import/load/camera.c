/* A camera where people say it is. */
#include "import/import.h"
#include "scene/scene.h"

#include <math.h>
#include <nocturne/path.h>
#include <nocturne/text.h>

#define FAR_AWAY 20 /* extents of the scene */

#define NOWHERE 100          /* extents, */
#define NOWHERE_METRES 100e3 /* and this far: nothing of the scene is seen from there */

static double distance_from(const noc_scene_info *scene, const double p[3]) {
    double distance = 0;
    for (int k = 0; k < 3; k++)
        distance = hypot(distance, p[k] - (scene->bounds_min[k] + scene->bounds_max[k]) / 2);
    return distance;
}

static noc_status to_local(const noc_scene *scene, const char *crs, double xyz[3]) {
    return noc_scene_to_local(scene, strcmp(crs, "scene") ? crs : NULL, xyz);
}

/* How far the eye were if its first two numbers were exchanged; INFINITY where they then are no place. */
static double exchanged_distance(const noc_scene *scene, const noc_scene_info *info, const char *crs,
                                 const double eye[3]) {
    double p[3] = { eye[1], eye[0], eye[2] };
    bool degrees = fabs(p[0]) <= 360 && fabs(p[1]) <= 360;
    if (!crs || (degrees && (fabs(p[0]) > 180 || fabs(p[1]) > 90)))
        return INFINITY;
    return to_local(scene, crs, p) ? INFINITY : distance_from(info, p);
}

/* A camera that is somewhat far away is warned of; one that is nowhere near draws an empty picture, which is an error.
 */
static noc_status check_distance(const noc_scene *scene, const char *crs, const double given[3], const double eye[3],
                                 bool *far_away) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    double extent = 0, distance = distance_from(&info, eye);
    for (int k = 0; k < 3; k++)
        extent = hypot(extent, info.bounds_max[k] - info.bounds_min[k]);
    if (!(distance > FAR_AWAY * extent))
        return NOC_OK;
    *far_away = true;
    bool nowhere = distance > NOWHERE * extent && distance > NOWHERE_METRES;
    double exchanged = nowhere ? exchanged_distance(scene, &info, crs, given) : INFINITY;
    if (exchanged <= FAR_AWAY * extent)
        return noc_error(
            scene->log, NOC_ERR_ARGUMENT,
            "the camera is %.6g km away from a scene of %.1f km; with the first two numbers of --eye exchanged "
            "it is %.1f km away: longitude comes before latitude, and easting before northing, whatever the CRS says",
            distance / 1000, extent / 1000, exchanged / 1000);
    const char *hint = crs                     ? "are eye and --camera-crs right?"
                       : info.crs && *info.crs ? "are these coordinates of the scene's CRS? then add --camera-crs scene"
                                               : "eye is in metres from the scene's origin";
    if (nowhere)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "the camera is %.6g km away from a scene of %.1f km: %s",
                         distance / 1000, extent / 1000, hint);
    noc_warn(scene->log, "the camera is %.6g km away from a scene of %.1f km: %s", distance / 1000, extent / 1000,
             hint);
    return NOC_OK;
}

static noc_status parse(const noc_scene *scene, const char *name, const char *text, double out[3]) {
    return text && noc_text_numbers(text, ',', 3, out)
               ? NOC_OK
               : noc_error(scene->log, NOC_ERR_ARGUMENT, "camera: %s: \"%.60s\" is not X,Y,Z", name, text ? text : "");
}

static noc_status place(const noc_scene *scene, const noc_camera_params *params, noc_camera *camera, bool *far_away) {
    noc_status status = parse(scene, "eye", params->eye, camera->eye);
    status = status ? status : parse(scene, "target", params->target, camera->target);
    double given[3];
    memcpy(given, camera->eye, sizeof(given));
    camera->fov_deg = params->fov > 0 ? params->fov : 50;
    if (!status && params->crs) {
        status = to_local(scene, params->crs, camera->eye);
        status = status ? status : to_local(scene, params->crs, camera->target);
    }
    status = status ? status : check_distance(scene, params->crs, given, camera->eye, far_away);
    /* Looking straight down or up, "up" is north. */
    double dx = camera->target[0] - camera->eye[0], dy = camera->target[1] - camera->eye[1],
           dz = camera->target[2] - camera->eye[2];
    if (!status && hypot(dx, dy) < 1e-6 * fabs(dz))
        memcpy(camera->up, (double[3]){ 0, 1, 0 }, sizeof(camera->up));
    return status;
}

noc_status noc_scene_place_camera(const noc_scene *scene, const noc_camera_params *params, double aspect,
                                  noc_camera *camera, bool *far_away) {
    if (!scene || !camera)
        return noc_null(scene ? scene->log : NULL, "noc_scene_place_camera");
    bool ignored;
    const noc_camera_params defaults = noc_camera_default_params();
    params = params ? params : &defaults;
    far_away = far_away ? far_away : &ignored;
    *far_away = false;
    noc_camera placed = noc_camera_default();
    noc_status status = params->photo_points
                            ? noc_scene_photo_camera(scene, params->photo_points, params->crs, &placed, NULL)
                        : params->eye || params->target ? place(scene, params, &placed, far_away)
                                                        : noc_scene_camera(scene, params->viewpoint, aspect, &placed);
    if (!status && params->fov > 0)
        placed.fov_deg = params->fov;
    if (!status)
        *camera = placed;
    return status;
}

noc_status noc_scene_place_path(const noc_scene *scene, const noc_path_key *keys, size_t count, bool loop,
                                double seconds, double aspect, noc_camera_path **path) {
    if (!scene || !keys || !path)
        return noc_null(scene ? scene->log : NULL, "noc_scene_place_path");
    *path = NULL;
    if (!count || count > NOC_PATH_MOST_KEYS)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "camera path: it has %zu keys, must have 1 to %d", count,
                         NOC_PATH_MOST_KEYS);
    noc_camera_key *placed = noc_calloc(count, sizeof(*placed));
    noc_status status = placed ? NOC_OK : noc_no_memory(scene->log, "camera path");
    for (size_t i = 0; i < count && !status; i++) {
        placed[i] = (noc_camera_key){ .seconds = keys[i].seconds, .hour = keys[i].hour };
        status = noc_scene_place_camera(scene, &keys[i].camera, aspect, &placed[i].camera, NULL);
    }
    if (!status)
        status = noc_camera_path_create(placed, count, loop, seconds, scene->log, path);
    free(placed);
    return status;
}
