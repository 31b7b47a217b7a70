/* Cameras of a spec: where they stand, and how they come there. */
#include "lab/cameras.h"

#include <math.h>

#define C lab_camera
static const noc_option path_rows[] = {
    { "frames", "Path", NOC_OPTION_INT, offsetof(C, frames), 2, LAB_FRAMES, NULL, "", "" },
    { "dolly", "Path", NOC_OPTION_TEXT, offsetof(C, dolly_text), 0, 0, NULL, "", "" },
    { "orbit", "Path", NOC_OPTION_REAL, offsetof(C, orbit), -360, 360, NULL, "degrees", "" },
    { "pan", "Path", NOC_OPTION_REAL, offsetof(C, pan), -360, 360, NULL, "degrees", "" },
    { "fps", "Path", NOC_OPTION_REAL, offsetof(C, fps), 0.001, 1e6, NULL, "", "" },
    { "cut", "Path", NOC_OPTION_INT, offsetof(C, cut), 1, LAB_FRAMES, NULL, "", "" },
    { NULL },
};
static const noc_option *path_table(void) { return path_rows; }

static const lab_options pose_options[] = { { noc_camera_options, 0, NULL }, { NULL } };
static const lab_options path_options[] = { { path_table, 0, NULL }, { NULL } };
static const noc_option inset_rows[] = {
    { "box", "Inset", NOC_OPTION_TEXT, offsetof(lab_inset, text), 0, 0, NULL, "", "" },
    { NULL },
};
static const noc_option *inset_table(void) { return inset_rows; }
static const lab_options inset_options[] = { { inset_table, 0, NULL }, { NULL } };
static const char *const inset_others[] = { "name", NULL };
static const char *const camera_others[] = { "name", "path", "insets", NULL }, *const path_others[] = { "before",
                                                                                                        NULL };

/* others: members of the object that are no options of a pose. */
static noc_status read_pose(lab_spec *spec, const char *place, json_t *object, const char *const *others,
                            noc_camera_params *pose) {
    double eye[3], target[3];
    *pose = noc_camera_default_params();
    noc_status status = lab_set_all(spec, place, object, pose_options, others, pose);
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
    return NOC_OK;
}

static noc_status read_path(lab_spec *spec, const char *place, json_t *path, C *camera) {
    noc_status status = lab_set_all(spec, place, path, path_options, path_others, camera);
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
    noc_snprintf(inner, sizeof(inner), "%s: before", place);
    return before ? read_pose(spec, inner, before, NULL, &camera->before) : NOC_OK;
}

static noc_status read_insets(lab_spec *spec, const char *place, json_t *insets, C *camera) {
    size_t i;
    json_t *object;
    if (insets && (!json_is_array(insets) || json_array_size(insets) > LAB_INSETS))
        return lab_wrong(spec, place,
                         "insets must be an array of up to %d, {\"name\": ..., \"box\": [x, y, width, height]}",
                         LAB_INSETS);
    json_array_foreach(insets, i, object) {
        lab_inset *inset = &camera->insets[i];
        char inner[96];
        noc_snprintf(inner, sizeof(inner), "%s: insets[%zu]", place, i);
        noc_status status = lab_set_all(spec, inner, object, inset_options, inset_others, inset);
        status = status ? status : lab_read_name(spec, inner, object, &inset->name);
        if (status)
            return status;
        if (!inset->text || !lab_read_box(inset->text, spec->width, spec->height, inset->box))
            return lab_wrong(spec, inner, "box must be [x, y, width, height] inside the picture of %d x %d px",
                             spec->width, spec->height);
        camera->inset_count++;
    }
    return NOC_OK;
}

static noc_status read_camera(lab_spec *spec, const char *place, json_t *object, C *camera) {
    noc_status status = read_pose(spec, place, object, camera_others, &camera->pose);
    status = status ? status : lab_read_name(spec, place, object, &camera->name);
    status = status ? status : read_insets(spec, place, json_object_get(object, "insets"), camera);
    char inner[80];
    noc_snprintf(inner, sizeof(inner), "%s: path", place);
    json_t *path = json_object_get(object, "path");
    return status || !path ? status : read_path(spec, inner, path, camera);
}

noc_status lab_read_cameras(lab_spec *spec, const char *place, json_t *cameras, size_t scene) {
    size_t count = json_array_size(cameras), first = spec->camera_count;
    if (!count)
        return lab_wrong(spec, place, "it needs cameras, an array that is not empty; here, or once for all scenes");
    noc_status few = lab_too_many(spec, place, first + count, LAB_ENTRIES, "cameras");
    if (few)
        return few;
    C *longer = noc_realloc(spec->cameras, sizeof(*spec->cameras) * (first + count));
    if (!longer)
        return lab_spec_no_memory(spec);
    spec->cameras = longer;
    char where[64];
    for (size_t i = 0; i < count; i++) {
        C *camera = &spec->cameras[spec->camera_count++];
        *camera = (C){ .scene = scene };
        noc_snprintf(where, sizeof(where), *place ? "%s: cameras[%zu]" : "%scameras[%zu]", place, i);
        noc_status status = read_camera(spec, where, json_array_get(cameras, i), camera);
        if (status)
            return status;
        for (size_t j = first; j + 1 < spec->camera_count; j++)
            if (!strcmp(spec->cameras[j].name, camera->name))
                return lab_wrong(spec, *place ? place : "cameras", "the name \"%s\" is given twice", camera->name);
    }
    return NOC_OK;
}
