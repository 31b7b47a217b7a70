/* Cameras of an experiment on their way. */
#include "lab/motion.h"

#include <math.h>

noc_status lab_place_cameras(lab_session *lab, size_t index) {
    const lab_camera *camera = &lab->spec->cameras[index];
    double aspect = (double)lab->spec->width / lab->spec->height;
    noc_status status = noc_scene_place_camera(lab->scene, &camera->pose, aspect, &lab->camera, NULL);
    if (camera->fps > 0 && !lab->holdings[camera->scene].info.cars) {
        char view[LAB_TEXT];
        noc_warn(lab->log, "%s: fps has no effect: the scene has no cars that drive",
                 lab_view_name(lab->spec, index, view));
    }
    lab->before = lab->camera;
    return status || !camera->cut ? status
                                  : noc_scene_place_camera(lab->scene, &camera->before, aspect, &lab->before, NULL);
}

noc_status lab_place_cars(lab_session *lab, size_t index, int frame) {
    const lab_camera *path = &lab->spec->cameras[index];
    if (!(path->fps > 0))
        return NOC_OK;
    double arrival = lab->holdings[path->scene].info.time;
    noc_status status = noc_scene_set_time(lab->scene, arrival - (path->frames - frame) / path->fps);
    return status ? status : noc_scene_commit(lab->scene);
}

/* v turned about the vertical, counter-clockwise from above. */
static void turn(double v[3], double angle) {
    double c = cos(angle), s = sin(angle), x = v[0];
    v[0] = c * x - s * v[1];
    v[1] = s * x + c * v[1];
}

/* Sight to the right of a camera, as a unit vector. One that looks straight down has an up vector that is level. */
static void right_of(const noc_camera *camera, const double forward[3], double right[3]) {
    for (int k = 0; k < 3; k++)
        right[k] = forward[(k + 1) % 3] * camera->up[(k + 2) % 3] - forward[(k + 2) % 3] * camera->up[(k + 1) % 3];
    double length = sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
    for (int k = 0; k < 3; k++)
        right[k] /= length;
}

/* The way from the first frame to the last is gone backwards from the pose: turned about the eye, moved along the axes
 * that it has at the pose, turned about the target. */
noc_camera lab_camera_at(const lab_session *lab, size_t index, int frame) {
    const lab_camera *path = &lab->spec->cameras[index];
    if (!path->frames || frame >= path->frames)
        return lab->camera;
    if (frame <= path->cut)
        return lab->before;
    noc_camera camera = lab->camera;
    double back = -(double)(path->frames - frame) / (path->frames - 1), degrees = 3.14159265358979323846 / 180;
    double forward[3], right[3], sight[3], length = 0;
    for (int k = 0; k < 3; k++) {
        sight[k] = camera.target[k] - camera.eye[k];
        length += sight[k] * sight[k];
    }
    for (int k = 0; k < 3; k++)
        forward[k] = sight[k] / sqrt(length);
    right_of(&camera, forward, right);
    turn(sight, back * path->pan * degrees);
    for (int k = 0; k < 3; k++) {
        camera.eye[k] +=
            back * (path->dolly[0] * right[k] + path->dolly[1] * forward[k] + (k == 2 ? path->dolly[2] : 0));
        camera.target[k] = camera.eye[k] + sight[k];
    }
    turn(sight, back * path->orbit * degrees);
    turn(camera.up, back * (path->pan + path->orbit) * degrees);
    for (int k = 0; k < 3; k++)
        camera.eye[k] = camera.target[k] - sight[k];
    return camera;
}
