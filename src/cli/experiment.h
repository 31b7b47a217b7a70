/* nocturne experiment: what its files share. */
#ifndef NOC_CLI_EXPERIMENT_H
#define NOC_CLI_EXPERIMENT_H

#include "render.h"

enum {
    EXPERIMENT_KEY = 33,
    EXPERIMENT_TIMES = 8,
    EXPERIMENT_POINTS = 6,
    EXPERIMENT_VALUES = 32,
    EXPERIMENT_FRAMES = 100000,
    EXPERIMENT_ROWS = 1000000,
    EXPERIMENT_BYTES = 1 << 20 /* of a spec */,
    EXPERIMENT_INPUTS = 10000 /* of a scene */,
    EXPERIMENT_NUMBERS = 64 /* of a list */,
    EXPERIMENT_ENTRIES = 1000 /* scenes, cameras and configurations, each */,
    EXPERIMENT_REPETITIONS = 4 /* where a spec says nothing: what a figure is worth shows in its spread */
};

typedef struct experiment_args {
    cli_args common;
    const char *output, *cache;
    int threads;
} experiment_args;

typedef struct experiment_scene {
    const char *name;
    const char **inputs; /* files: as seen from the working folder */
    size_t input_count;
    noc_import_params import;
    noc_builtin_params builtin;
} experiment_scene;

/* Where a camera stands: a view derived from the scene, or eye and target. */
typedef struct experiment_pose {
    render_args args; /* view, eye, target, camera-crs, fov */
    double eye[3], target[3];
} experiment_pose;

/* Parts of a camera's picture that are shown enlarged below it, in frames of a colour each. */
enum { EXPERIMENT_INSETS = 4 };
typedef struct experiment_inset {
    const char *name, *text;
    int box[4]; /* x, y, width, height */
} experiment_inset;

/* A camera of one scene. One that moves arrives at its pose in its last frame, which is the one that is measured: so
 * one reference serves the camera at rest and all motions that end there. */
typedef struct experiment_camera {
    const char *name;
    size_t scene;
    experiment_pose pose;
    int frames; /* of the motion; 0: at rest */
    const char *dolly_text;
    double dolly[3]; /* travelled in the motion: right, forward, up, m */
    /* turned about the target and about the eye in the motion, degrees, counter-clockwise from above */
    double orbit, pan;
    int cut; /* so many of the first frames show what `before` sees */
    experiment_pose before;
    experiment_inset insets[EXPERIMENT_INSETS];
    int inset_count;
} experiment_camera;

typedef struct experiment_config {
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
} experiment_config;

/* Noise of a reference itself: estimated relMSE, and standard error of its mean as a share of it. NaN: not known. */
typedef struct experiment_noise {
    double relmse, clamped, relmse_all, clamped_all, mean, mean_all;
} experiment_noise;

/* A reference's running mean of luminance after each of a few equal parts of its frames; [1]: all pixels. */
enum { EXPERIMENT_BATCHES = 8 };
typedef struct experiment_batches {
    double mean[2][EXPERIMENT_BATCHES + 1];
    int frames[EXPERIMENT_BATCHES + 1], count;
} experiment_batches;

enum { EXPERIMENT_ALONE, EXPERIMENT_ACCUMULATED, EXPERIMENT_MODES }; /* values of "accumulate": false, true, both */
enum { EXPERIMENT_CLAMPED, EXPERIMENT_RELMSE, EXPERIMENT_RMSE8 };    /* of "figure" */

typedef struct experiment_spec {
    const char *path;
    bool quiet; /* no warnings */
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
    int accumulate;
    uint32_t seed; /* of the first repetition */
    int figure;
    bool all_pixels; /* figures of plots and of time to error: all pixels, else those that see no emitter */
    double ceiling;
    double times[EXPERIMENT_TIMES]; /* CPU seconds */
    size_t time_count;
    struct {
        int frames;
        noc_render_params params;
    } reference;
    experiment_scene *scenes;
    experiment_camera *cameras; /* scene by scene */
    experiment_config *configs;
    size_t scene_count, camera_count, config_count;
    void **kept; /* owned: all that the others point at */
    size_t kept_count;
} experiment_spec;

/* Columns of results.csv that are numbers, after those that tell which row it is. */
enum {
    COL_WALL,
    COL_CPU,
    COL_WALL_TOTAL,
    COL_CPU_TOTAL,
    COL_RMSE8,
    COL_RELMSE,
    COL_CLAMPED,
    COL_BIAS,
    COL_UNLIT,
    COL_RELMSE_UNLIT, /* pixels that see no emitter */
    /* all, likewise */
    COL_RMSE8_ALL,
    COL_RELMSE_ALL,
    COL_CLAMPED_ALL,
    COL_BIAS_ALL,
    COL_UNLIT_ALL,
    COL_RELMSE_UNLIT_ALL,
    COL_BUILD,
    COL_MEMORY,
    COL_RAYS,
    COL_DROPPED,
    /* of the structure that candidates are drawn from: seconds to build, and of them in volumes, tuning,
     * hierarchy and boxes, bytes, bytes of the scene and its ray tracing structure, and
     * for bvh S_r, the share of surfaces that no light was found for, median and 99th percentile of those found */
    COL_LIGHT_BUILD,
    COL_VOLUMES,
    COL_TUNING,
    COL_HIERARCHY,
    COL_BOXES,
    COL_LIGHT_BYTES,
    COL_SCENE_BYTES,
    COL_INFLUENCE,
    COL_FOUND_NONE,
    COL_FOUND_MEDIAN,
    COL_FOUND_99,
    COL_COUNT
};

typedef struct experiment_row {
    bool done;
    double values[COL_COUNT];
} experiment_row;

/* One configuration under one camera, one repetition of it. */
typedef struct experiment_run {
    size_t camera, config;
    int repetition;           /* from 0 */
    char key[EXPERIMENT_KEY]; /* hash of all that the figures depend on */
    /* count of them, frame by frame; those that were not measured are not done */
    experiment_row *rows[EXPERIMENT_MODES];
    int count, room;
} experiment_run;

/* A row of an earlier session. */
typedef struct experiment_stored {
    char key[EXPERIMENT_KEY];
    int mode, frame;
    bool claimed;
    double values[COL_COUNT];
} experiment_stored;

typedef struct experiment_crop {
    int x, y, width, height, scale, columns;
} experiment_crop;

typedef struct experiment_lab {
    experiment_args *args;
    experiment_spec spec;
    char *folder, *cache;
    int lock; /* of the folder */
    noc_log *log;
    FILE *csv;
    experiment_stored *stored;
    size_t stored_count;
    experiment_run *runs; /* camera by camera, repetition, configuration */
    size_t run_count, runs_done;
    size_t rows_done, rows_old;     /* old: of earlier sessions */
    size_t rows_broken, rows_twice; /* of results.csv, as it was */
    double started, reference_seconds;
    size_t references_made, cameras_done;
    int reference_lost; /* frames of a reference that was interrupted: it is not kept */
    char path[32];      /* code that ran: "avx2 x8" */
    double *sum;        /* room for the mean of a picture */
    /* of the present scene and camera */
    noc_scene *scene;
    char content[NOC_CONTENT_KEY];
    noc_image *reference;
    noc_camera camera, before; /* at its pose, and before the cut */
    char reference_key[EXPERIMENT_KEY];
    /* kept for the report */
    noc_scene_info *scene_infos; /* a scene */
    experiment_crop *crops;      /* a camera */
    experiment_noise *noises;    /* a camera */
} experiment_lab;

/* experiment_spec.c */
/* CLI_OK, or an exit status after reporting */
int experiment_read_spec(experiment_spec *spec, const char *path, bool quiet);
void experiment_free_spec(experiment_spec *spec);
char *experiment_spec_name(const char *path); /* "a/methods.json" is "methods"; free() it */

/* experiment_member.c: one member of a JSON object to one field, by the option tables. Reported with its place. */
struct json_t;
int experiment_wrong(const experiment_spec *spec, const char *place, const char *fmt, ...) NOC_PRINTF(3, 4);
/* CLI_OK, or that there are too many, reported. */
int experiment_too_many(const experiment_spec *spec, const char *place, size_t count, size_t most, const char *what);
const noc_option *experiment_option(const cli_set *sets, const char *name, size_t *offset);
int experiment_set(experiment_spec *spec, const char *place, const cli_set *sets, const char *const *others,
                   void *params, const char *name, struct json_t *value);
int experiment_set_all(experiment_spec *spec, const char *place, struct json_t *object, const cli_set *sets,
                       const char *const *others, void *params); /* others: names that are right here but no options */
int experiment_read_name(experiment_spec *spec, const char *place, struct json_t *object, const char **name);
void *experiment_keep(experiment_spec *spec, void *memory); /* now owned by the spec */
void *experiment_longer(void *array, size_t size);          /* realloc that ends the program when memory is gone */

void experiment_warn_of_idle(const experiment_spec *spec, struct json_t *root); /* of options that change nothing */

/* experiment_camera.c */
const noc_option *experiment_camera_options(void); /* of render's options, those that place a camera */
/* added to the spec's */
int experiment_read_cameras(experiment_spec *spec, const char *place, struct json_t *cameras, size_t scene);
int experiment_place_cameras(experiment_lab *lab, size_t camera); /* once its scene is there */
noc_camera experiment_camera_at(const experiment_lab *lab, size_t camera, int frame);

/* experiment_config.c: shared holds what all configurations have in common, and is what they begin as. */
int experiment_read_shared(experiment_spec *spec, struct json_t *object, experiment_config *shared);
int experiment_read_config(experiment_spec *spec, const char *place, struct json_t *object,
                           const experiment_config *shared, size_t entry);

/* experiment_scene.c */
int experiment_load_scene(experiment_lab *lab, size_t scene);
int experiment_make_reference(experiment_lab *lab, size_t camera); /* camera placed, reference read or rendered */
void experiment_run_key(const experiment_lab *lab, experiment_run *run);
noc_render_params experiment_params(const experiment_lab *lab, const experiment_run *run);
const char *experiment_machine(void);

/* experiment_noise.c: kept beside the reference. half: the mean of its first frames, NULL where it has one frame alone.
 */
experiment_noise experiment_measure_noise(const experiment_lab *lab, const noc_image *half, int half_frames,
                                          const experiment_batches *batches);
void experiment_add_batch(experiment_batches *batches, const noc_image *so_far, int frames);
void experiment_keep_noise(const char *reference, const experiment_noise *noise);
experiment_noise experiment_read_noise(const char *reference);
/* a sentence; NULL where no such pixel is; free() it */
char *experiment_unlit(const experiment_lab *lab, size_t camera);

/* experiment_run.c */
int experiment_measure(experiment_lab *lab, experiment_run *run);
int experiment_shown_mode(const experiment_spec *spec, size_t camera); /* of pictures that are shown */
char *experiment_picture(const experiment_lab *lab, const char *key, int mode, int frame); /* path; free() it */

/* experiment_table.c */
int experiment_open_table(experiment_lab *lab);
void experiment_claim(experiment_lab *lab, experiment_run *run); /* rows of earlier sessions */
/* frame from 1; made where it is not there */
experiment_row *experiment_row_of(experiment_run *run, int mode, int frame);
int experiment_append(experiment_lab *lab, const experiment_run *run, int mode, int frame); /* frame from 1 */
int experiment_tidy_table(experiment_lab *lab); /* at the end: leaves out rows of other settings */

/* experiment_series.c: means over repetitions, or one of them; NaN where there is nothing. frame from 1. */
typedef struct experiment_series {
    const experiment_lab *lab;
    size_t camera, config;
    int mode;
    int only; /* of one repetition, from 1; 0: means of all */
} experiment_series;
bool experiment_has_mode(const experiment_spec *spec, size_t camera, int mode);
int experiment_frames(const experiment_spec *spec, size_t camera, size_t config); /* at most */
bool experiment_measures(const experiment_spec *spec, size_t camera, size_t config, int frame);
int experiment_last(const experiment_series *s); /* last frame that is there; 0: none */
double experiment_at(const experiment_series *s, int column, int frame);
/* A figure of a series (given what it is asked for), and the standard error of its mean over the repetitions: NaN where
 * they are fewer than two, or one of them lacks it. */
typedef double experiment_asked(const experiment_series *s, int column, double what);
double experiment_error_of(const experiment_series *s, experiment_asked *asked, int column, double what);
double experiment_error_at(const experiment_series *s, int column, int frame); /* of experiment_at */
int experiment_column(const experiment_spec *spec);                            /* of the spec's figure */
const char *experiment_figure(const experiment_spec *spec);                    /* in words, with its unit */
/* over frames and repetitions, the first frame left out */
double experiment_median(const experiment_series *s, int column);
experiment_asked experiment_time_to;     /* CPU seconds to an error; 0: at the first frame already */
experiment_asked experiment_error_after; /* CPU seconds */
/* CPU seconds of one frame: of the last where the camera moves, else the mean of all but the first */
experiment_asked experiment_frame_time;
experiment_run *experiment_find_run(const experiment_lab *lab, size_t camera, size_t config, int repetition);

/* experiment_plot.c: error over "frames" or "cpu" as SVG; name is the file's, in the folder. */
int experiment_plot(const experiment_lab *lab, size_t camera, int mode, bool over_time, const char *name);

/* experiment_summary.c: the figures that stand for a run in a table. */
typedef struct experiment_point {
    int mode, frame; /* 0: the last */
} experiment_point;
int experiment_points(const experiment_spec *spec, size_t camera, experiment_point out[EXPERIMENT_POINTS]);
double experiment_at_point(const experiment_lab *lab, size_t camera, size_t config, experiment_point point, int column,
                           double *error);
const char *experiment_point_name(const experiment_spec *spec, size_t camera, experiment_point point);
/* that frame times are taken of */
experiment_series experiment_timed(const experiment_lab *lab, size_t camera, size_t config);
void experiment_view_name(FILE *out, const experiment_spec *spec, size_t camera); /* scene and camera, in Markdown */
char *experiment_row_name(const experiment_lab *lab, size_t config);              /* of its entry; free() it */
int experiment_write_summary(experiment_lab *lab);

/* experiment_charts.c: one SVG over all cameras, where the configurations are not too many. */
bool experiment_has_bars(const experiment_spec *spec); /* frame times */
int experiment_bars(const experiment_lab *lab, const char *name);
bool experiment_has_dots(const experiment_spec *spec); /* errors */
int experiment_dots(const experiment_lab *lab, const char *name);

/* experiment_sheet.c: a contact sheet, a labelled panel a picture: its crop, or all of it above its insets. */
typedef struct experiment_sheet {
    const experiment_crop *crop;
    const experiment_camera *camera;
    uint8_t *rgb;                                  /* owned */
    int width, height;                             /* px */
    int panel_width, panel_height, picture_height; /* without and with the label and the insets */
} experiment_sheet;
int experiment_start_sheet(experiment_sheet *sheet, const experiment_crop *crop, const experiment_camera *camera,
                           size_t panels);
/* rgb: 8-bit, of a whole picture so wide; NULL: the label alone. */
void experiment_add_panel(experiment_sheet *sheet, size_t panel, const uint8_t *rgb, int width, const char *label);
const char *experiment_inset_colour(int inset);                                /* "red" */
bool experiment_read_box(const char *text, int width, int height, int box[4]); /* "x,y,width,height" inside a picture */

/* experiment_crops.c: name is that of one shown frame's sheet; free() it. */
char *experiment_sheet_name(const experiment_lab *lab, size_t camera, int frame);
int experiment_make_crops(experiment_lab *lab, size_t camera);
bool experiment_shows(const experiment_spec *spec, size_t camera, int frame);

/* experiment_report.c */
int experiment_write_report(experiment_lab *lab);
char *experiment_slug(const experiment_lab *lab, size_t camera); /* "1-city-street"; free() it */
/* as it reads, in Markdown: what would be markup of it or of HTML is escaped */
void experiment_text(FILE *out, const char *text);
void experiment_cell(FILE *out, const char *text); /* text, and a number, in a cell of a Markdown table */
void experiment_number(FILE *out, double v, const char *fmt);
/* With its standard error behind it, "1.23 \302\261 0.04": two digits of it, and none where there is none. after may be
 * "". */
void experiment_print_spread(FILE *out, double v, double error, const char *fmt);
void experiment_spread(FILE *out, double v, double error, const char *fmt, const char *after); /* in a cell */
/* ends the line of the head: one column to the left, others to the right */
void experiment_table_rule(FILE *out, size_t columns);
FILE *experiment_create(const experiment_lab *lab, const char *name, char **temporary);
/* renames; frees temporary */
int experiment_finish(const experiment_lab *lab, FILE *file, const char *name, char *temporary);
void experiment_discard(FILE *file, char *temporary); /* instead of finishing: nothing is left */

#endif
