/* lab: a spec as it was read (read.h), and what it asks for. */
#ifndef NOC_LAB_SPEC_H
#define NOC_LAB_SPEC_H

#include "base/base.h"

#include <nocturne/lab.h>
#include <nocturne/option.h>
#include <nocturne/recipe.h>
#include <nocturne/text.h>

enum {
    LAB_TIMES = 8,
    LAB_VALUES = 32,
    LAB_FRAMES = 100000,
    LAB_ROWS = 1000000,
    LAB_BYTES = 1 << 20 /* of a spec */,
    LAB_INPUTS = 10000 /* of a scene */,
    LAB_NUMBERS = 64 /* of a list */,
    LAB_ENTRIES = 1000 /* scenes, cameras and configurations, each */,
    LAB_REPETITIONS = 4 /* where a spec says nothing: what a figure is worth shows in its spread */,
    LAB_NAME = 80 /* bytes of a name in the spec; a configuration's may have a value of an option in it */,
    LAB_TEXT = 400 /* room for two names and some words between them */
};

typedef struct lab_scene {
    const char *name;
    const char **inputs; /* files: as seen from the working folder */
    size_t input_count;
    noc_import_params import;
    noc_builtin_params builtin;
    noc_recipe *recipe; /* among its inputs, whose texts it holds; NULL: none */
    bool optional;      /* left out where an input is absent */
} lab_scene;

/* A scene that was left out, and the input that is absent. */
typedef struct lab_absent {
    const char *name, *input;
} lab_absent;

/* Parts of a camera's picture that are shown enlarged below it, in frames of a colour each. */
enum { LAB_INSETS = 4 };
typedef struct lab_inset {
    const char *name, *text;
    int box[4]; /* x, y, width, height */
} lab_inset;

/* A camera of one scene. One that moves arrives at its pose in its last frame, which is the one that is measured: so
 * one reference serves the camera at rest and all motions that end there. */
typedef struct lab_camera {
    const char *name;
    size_t scene;
    noc_camera_params pose;
    int frames; /* of the motion; 0: at rest */
    const char *dolly_text;
    double dolly[3]; /* travelled in the motion: right, forward, up, m */
    /* turned about the target and about the eye in the motion, degrees, counter-clockwise from above */
    double orbit, pan;
    double fps; /* cars drive 1 / fps s from frame to frame, and arrive in the last; 0: they stand */
    int cut;    /* so many of the first frames show what `before` sees */
    noc_camera_params before;
    lab_inset insets[LAB_INSETS];
    int inset_count;
} lab_camera;

typedef struct lab_config {
    const char *name;
    noc_render_params params;
    int preset;               /* noc_preset that params were set by; of no meaning where the spec gives none */
    int frames;               /* at most, where seconds says when to stop */
    double seconds;           /* process CPU time after which it stops; 0: frames decide */
    size_t entry;             /* of the spec's list */
    int choice;               /* where the entry stands for several values of an option, which of them, else -1 */
    const noc_option *option; /* that option; NULL where there is none */
    const char *value;
    const char *pattern; /* the entry's name as the spec has it: "ris, *" */
} lab_config;

enum { LAB_ALONE, LAB_ACCUMULATED, LAB_MODES }; /* values of "accumulate": false, true, both */
enum { LAB_CLAMPED, LAB_RELMSE, LAB_RMSE8 };    /* of "figure" */

typedef struct noc_lab_spec {
    const char *path, *name; /* "a/methods.json" and "methods" */
    noc_log *log;            /* while it is read */
    const char *title, *note, *size, *crop;
    int width, height;
    int crop_box[4]; /* x, y, width, height; width 0: chosen by the pictures */
    int frames, repetitions;
    double seconds;
    /* frames that are measured, rising; none: all, or those of a rising distance under seconds */
    int *measured;
    size_t measured_count;
    int *shown; /* frames whose pictures are shown beside the reference, rising */
    size_t shown_count;
    bool light_view; /* the shown frames' lights (NOC_AOV_LIGHT) are shown, too */
    int accumulate;
    uint32_t seed; /* of the first repetition */
    noc_device_params device;
    int figure;
    bool all_pixels; /* figures of plots and of time to error: all pixels, else those that see no emitter */
    double ceiling;
    double times[LAB_TIMES]; /* CPU seconds */
    size_t time_count;
    struct {
        int frames;
        noc_render_params params;
    } reference;
    lab_scene *scenes;
    lab_absent *absent;  /* of the spec's scenes those that are left out */
    lab_camera *cameras; /* scene by scene */
    lab_config *configs;
    size_t scene_count, absent_count, camera_count, config_count;
    noc_arena arena; /* of all that the others point at */
} lab_spec;

bool lab_among(const char *const *names, const char *name); /* NULL-ended; may be NULL */

bool lab_has_mode(const lab_spec *spec, size_t camera, int mode);
int lab_frames(const lab_spec *spec, size_t camera, size_t config); /* at most */
bool lab_measures(const lab_spec *spec, size_t camera, size_t config, int frame);
bool lab_shows(const lab_spec *spec, size_t camera, int frame);
int lab_shown_mode(const lab_spec *spec, size_t camera); /* of pictures that are shown */

/* These write into text and return it. */
const char *lab_view_name(const lab_spec *spec, size_t camera, char text[LAB_TEXT]); /* "city, street" */
const char *lab_slug(const lab_spec *spec, size_t camera, char text[LAB_TEXT]);      /* "1-city-street" */
const char *lab_row_name(const lab_spec *spec, size_t config, char text[LAB_TEXT]);  /* of its entry */
const char *lab_figure(const lab_spec *spec, char text[LAB_TEXT]);                   /* in words, with its unit */

#endif
