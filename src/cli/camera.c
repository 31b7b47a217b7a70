#include "render.h"

#include <math.h>
#include <string.h>

int cli_parse_camera(render_job *job) {
    const render_args *args = job->args;
    if (args->eye && !cli_parse_numbers(args->eye, ',', 3, job->eye))
        return cli_usage(&cli_render, "--eye: \"%.60s\" is not X,Y,Z", args->eye);
    if (args->target && !cli_parse_numbers(args->target, ',', 3, job->target))
        return cli_usage(&cli_render, "--target: \"%.60s\" is not X,Y,Z", args->target);
    if (!args->eye != !args->target)
        return cli_usage(&cli_render, "--%s needs --%s too", args->eye ? "eye" : "target",
                         args->eye ? "target" : "eye");
    if (args->eye && cli_given(&args->common, "view"))
        return cli_usage(&cli_render, "--view and --eye exclude each other");
    if (args->camera_crs && !args->eye)
        return cli_usage(&cli_render, "--camera-crs is for --eye and --target");
    if (!args->eye)
        return CLI_OK;
    /* Local coordinates go as far as the library's cameras; those of a CRS may have a zone before them. */
    double limit = args->camera_crs ? 1e9 : 1e7;
    for (int k = 0; k < 3; k++)
        if (!(fabs(job->eye[k]) < limit && fabs(job->target[k]) < limit))
            return cli_usage(&cli_render, "--%s: \"%.60s\" is more than %g km away",
                             fabs(job->eye[k]) < limit ? "target" : "eye",
                             fabs(job->eye[k]) < limit ? args->target : args->eye, limit / 1000);
    if (!memcmp(job->eye, job->target, sizeof(job->eye)))
        return cli_usage(&cli_render, "--eye and --target are the same place");
    return CLI_OK;
}

#define FAR_AWAY 20 /* extents of the scene */

#define NOWHERE 100          /* extents, */
#define NOWHERE_METRES 100e3 /* and this far: nothing of the scene is seen from there */

static double distance_from(const noc_scene_info *scene, const double p[3]) {
    double distance = 0;
    for (int k = 0; k < 3; k++)
        distance = hypot(distance, p[k] - (scene->bounds_min[k] + scene->bounds_max[k]) / 2);
    return distance;
}

/* How far the eye were if its first two numbers were exchanged; INFINITY where they then are no place. */
static double exchanged_distance(const render_job *job) {
    const char *crs = job->args->camera_crs;
    double p[3] = { job->eye[1], job->eye[0], job->eye[2] };
    bool degrees = fabs(p[0]) <= 360 && fabs(p[1]) <= 360;
    if (!crs || (degrees && (fabs(p[0]) > 180 || fabs(p[1]) > 90)))
        return INFINITY;
    noc_status status = noc_scene_to_local(job->scene, strcmp(crs, "scene") ? crs : NULL, p);
    return status ? INFINITY : distance_from(&job->scene_info, p);
}

/* A camera that is somewhat far away is warned of; one that is nowhere near draws an empty picture, which is an error.
 */
static noc_status check_distance(render_job *job) {
    const noc_scene_info *scene = &job->scene_info;
    double extent = 0, distance = distance_from(scene, job->camera.eye);
    for (int k = 0; k < 3; k++)
        extent = hypot(extent, scene->bounds_max[k] - scene->bounds_min[k]);
    bool nowhere = distance > NOWHERE * extent && distance > NOWHERE_METRES;
    if (!(distance > FAR_AWAY * extent) || (job->args->common.quiet && !nowhere))
        return NOC_OK;
    job->far_away = true;
    double exchanged = nowhere ? exchanged_distance(job) : INFINITY;
    if (exchanged <= FAR_AWAY * extent) {
        cli_error(
            "the camera is %.6g km away from a scene of %.1f km; with the first two numbers of --eye exchanged "
            "it is %.1f km away: longitude comes before latitude, and easting before northing, whatever the CRS says",
            distance / 1000, extent / 1000, exchanged / 1000);
        return NOC_ERR_ARGUMENT;
    }
    const char *hint = job->args->camera_crs ? "are eye and --camera-crs right?"
                       : scene->crs && *scene->crs
                           ? "are these coordinates of the scene's CRS? then add --camera-crs scene"
                           : "eye is in metres from the scene's origin";
    cli_error("%sthe camera is %.6g km away from a scene of %.1f km: %s", nowhere ? "" : "warning: ", distance / 1000,
              extent / 1000, hint);
    return nowhere ? NOC_ERR_ARGUMENT : NOC_OK;
}

noc_status cli_place_camera(render_job *job) {
    const render_args *args = job->args;
    job->camera = noc_camera_default();
    if (!args->eye) {
        noc_status status = noc_scene_camera(job->scene, (noc_viewpoint)args->view,
                                             (double)args->render.width / args->render.height, &job->camera);
        if (status)
            return status;
        if (args->fov > 0)
            job->camera.fov_deg = args->fov;
        return NOC_OK;
    }
    memcpy(job->camera.eye, job->eye, sizeof(job->eye));
    memcpy(job->camera.target, job->target, sizeof(job->target));
    job->camera.fov_deg = args->fov > 0 ? args->fov : 50;
    if (args->camera_crs) {
        const char *crs = strcmp(args->camera_crs, "scene") ? args->camera_crs : NULL;
        noc_status status = noc_scene_to_local(job->scene, crs, job->camera.eye);
        status = status ? status : noc_scene_to_local(job->scene, crs, job->camera.target);
        if (status)
            return status;
    }
    noc_status status = check_distance(job);
    if (status)
        return status;
    /* Looking straight down or up, "up" is north. */
    double dx = job->camera.target[0] - job->camera.eye[0], dy = job->camera.target[1] - job->camera.eye[1],
           dz = job->camera.target[2] - job->camera.eye[2];
    if (hypot(dx, dy) < 1e-6 * fabs(dz))
        memcpy(job->camera.up, (double[3]){ 0, 1, 0 }, sizeof(job->camera.up));
    return NOC_OK;
}
