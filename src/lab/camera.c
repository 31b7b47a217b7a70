/* Cameras of an experiment: where they stand, and how they come there. */
#include "lab/lab.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define C lab_camera
static const noc_option path_options[] = {
    { "frames", "Path", NOC_OPTION_INT, offsetof(C, frames), 2, LAB_FRAMES, NULL, "", "" },
    { "dolly", "Path", NOC_OPTION_TEXT, offsetof(C, dolly_text), 0, 0, NULL, "", "" },
    { "orbit", "Path", NOC_OPTION_REAL, offsetof(C, orbit), -360, 360, NULL, "degrees", "" },
    { "pan", "Path", NOC_OPTION_REAL, offsetof(C, pan), -360, 360, NULL, "degrees", "" },
    { "cut", "Path", NOC_OPTION_INT, offsetof(C, cut), 1, LAB_FRAMES, NULL, "", "" },
    { NULL },
};
static const noc_option *path_table(void) { return path_options; }

static const cli_set pose_sets[] = { { noc_camera_options, 0, NULL }, { NULL } };
static const cli_set path_sets[] = { { path_table, 0, NULL }, { NULL } };
static const noc_option inset_options[] = {
    { "box", "Inset", NOC_OPTION_TEXT, offsetof(lab_inset, text), 0, 0, NULL, "", "" },
    { NULL },
};
static const noc_option *inset_table(void) { return inset_options; }
static const cli_set inset_sets[] = { { inset_table, 0, NULL }, { NULL } };
static const char *const inset_others[] = { "name", NULL };
static const char *const camera_others[] = { "name", "path", "insets", NULL }, *const path_others[] = { "before",
                                                                                                        NULL };

/* others: members of the object that are no options of a pose. */
static int read_pose(lab_spec *spec, const char *place, json_t *object, const char *const *others,
                     noc_camera_params *pose) {
    double eye[3], target[3];
    *pose = noc_camera_default_params();
    int status = lab_set_all(spec, place, object, pose_sets, others, pose);
    if (status)
        return status;
    if (!pose->eye != !pose->target)
        return lab_wrong(spec, place, "eye and target come together");
    if (pose->eye && json_object_get(object, "view"))
        return lab_wrong(spec, place, "view and eye exclude each other");
    if (pose->crs && !pose->eye)
        return lab_wrong(spec, place, "camera-crs is for eye and target");
    if (pose->eye && (!noc_text_numbers(pose->eye, ',', 3, eye) || !noc_text_numbers(pose->target, ',', 3, target)))
        return lab_wrong(spec, place, "eye and target are three numbers each, [x, y, z]");
    if (pose->eye && !memcmp(eye, target, sizeof(eye)))
        return lab_wrong(spec, place, "eye and target are the same place");
    return CLI_OK;
}

static int read_path(lab_spec *spec, const char *place, json_t *path, C *camera) {
    int status = lab_set_all(spec, place, path, path_sets, path_others, camera);
    if (status)
        return status;
    if (!camera->frames)
        return lab_wrong(spec, place, "it needs frames, how many the motion takes");
    if (camera->dolly_text && (!noc_text_numbers(camera->dolly_text, ',', 3, camera->dolly) ||
                               !(fabs(camera->dolly[0]) + fabs(camera->dolly[1]) + fabs(camera->dolly[2]) < 1e6)))
        return lab_wrong(spec, place, "dolly is [right, forward, up], metres from the first frame to the last");
    json_t *before = json_object_get(path, "before");
    if (!camera->cut != !before)
        return lab_wrong(spec, place,
                         "cut and before come together: how many frames another camera sees first, and that camera");
    if (camera->cut >= camera->frames)
        return lab_wrong(spec, place, "cut: frames must be left after it");
    char inner[96];
    snprintf(inner, sizeof(inner), "%s: before", place);
    return before ? read_pose(spec, inner, before, NULL, &camera->before) : CLI_OK;
}

static int read_insets(lab_spec *spec, const char *place, json_t *insets, C *camera) {
    size_t i;
    json_t *object;
    if (insets && (!json_is_array(insets) || json_array_size(insets) > LAB_INSETS))
        return lab_wrong(spec, place,
                         "insets must be an array of up to %d, {\"name\": ..., \"box\": [x, y, width, height]}",
                         LAB_INSETS);
    json_array_foreach(insets, i, object) {
        lab_inset *inset = &camera->insets[i];
        char inner[96];
        snprintf(inner, sizeof(inner), "%s: insets[%zu]", place, i);
        int status = lab_set_all(spec, inner, object, inset_sets, inset_others, inset);
        status = status ? status : lab_read_name(spec, inner, object, &inset->name);
        if (status)
            return status;
        if (!inset->text || !lab_read_box(inset->text, spec->width, spec->height, inset->box))
            return lab_wrong(spec, inner, "box must be [x, y, width, height] inside the picture of %d x %d px",
                             spec->width, spec->height);
        camera->inset_count++;
    }
    return CLI_OK;
}

static int read_camera(lab_spec *spec, const char *place, json_t *object, C *camera) {
    int status = read_pose(spec, place, object, camera_others, &camera->pose);
    status = status ? status : lab_read_name(spec, place, object, &camera->name);
    status = status ? status : read_insets(spec, place, json_object_get(object, "insets"), camera);
    char inner[80];
    snprintf(inner, sizeof(inner), "%s: path", place);
    json_t *path = json_object_get(object, "path");
    return status || !path ? status : read_path(spec, inner, path, camera);
}

int lab_read_cameras(lab_spec *spec, const char *place, json_t *cameras, size_t scene) {
    size_t count = json_array_size(cameras), first = spec->camera_count;
    if (!count)
        return lab_wrong(spec, place, "it needs cameras, an array that is not empty; here, or once for all scenes");
    int few = lab_too_many(spec, place, first + count, LAB_ENTRIES, "cameras");
    if (few)
        return few;
    spec->cameras = lab_longer(spec->cameras, sizeof(*spec->cameras) * (first + count));
    char where[64];
    for (size_t i = 0; i < count; i++) {
        C *camera = &spec->cameras[spec->camera_count++];
        *camera = (C){ .scene = scene };
        snprintf(where, sizeof(where), *place ? "%s: cameras[%zu]" : "%scameras[%zu]", place, i);
        int status = read_camera(spec, where, json_array_get(cameras, i), camera);
        if (status)
            return status;
        for (size_t j = first; j + 1 < spec->camera_count; j++)
            if (!strcmp(spec->cameras[j].name, camera->name))
                return lab_wrong(spec, *place ? place : "cameras", "the name \"%s\" is given twice", camera->name);
    }
    return CLI_OK;
}

int lab_place_cameras(lab_session *lab, size_t index) {
    const C *camera = &lab->spec.cameras[index];
    double aspect = (double)lab->spec.width / lab->spec.height;
    if (noc_scene_place_camera(lab->scene, &camera->pose, aspect, &lab->camera, NULL))
        return CLI_FAILURE;
    lab->before = lab->camera;
    if (camera->cut && noc_scene_place_camera(lab->scene, &camera->before, aspect, &lab->before, NULL))
        return CLI_FAILURE;
    return CLI_OK;
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
    const C *path = &lab->spec.cameras[index];
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
