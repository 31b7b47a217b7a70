/* the laboratory: what its files share. */
#ifndef NOC_LAB_LAB_H
#define NOC_LAB_LAB_H

#include "cli/render.h"

enum {
    LAB_KEY = 33,
    LAB_TIMES = 8,
    LAB_POINTS = 6,
    LAB_VALUES = 32,
    LAB_FRAMES = 100000,
    LAB_ROWS = 1000000,
    LAB_BYTES = 1 << 20 /* of a spec */,
    LAB_INPUTS = 10000 /* of a scene */,
    LAB_NUMBERS = 64 /* of a list */,
    LAB_ENTRIES = 1000 /* scenes, cameras and configurations, each */,
    LAB_REPETITIONS = 4 /* where a spec says nothing: what a figure is worth shows in its spread */
};

typedef struct lab_args {
    cli_args common;
    const char *output, *cache;
    int threads;
} lab_args;

typedef struct lab_scene {
    const char *name;
    const char **inputs; /* files: as seen from the working folder */
    size_t input_count;
    noc_import_params import;
    noc_builtin_params builtin;
} lab_scene;

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
    int cut; /* so many of the first frames show what `before` sees */
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

/* Noise of a reference itself: estimated relMSE, and standard error of its mean as a share of it. NaN: not known. */
typedef struct lab_noise {
    double relmse, clamped, relmse_all, clamped_all, mean, mean_all;
} lab_noise;

/* A reference's running mean of luminance after each of a few equal parts of its frames; [1]: all pixels. */
enum { LAB_BATCHES = 8 };
typedef struct lab_batches {
    double mean[2][LAB_BATCHES + 1];
    int frames[LAB_BATCHES + 1], count;
} lab_batches;

enum { LAB_ALONE, LAB_ACCUMULATED, LAB_MODES }; /* values of "accumulate": false, true, both */
enum { LAB_CLAMPED, LAB_RELMSE, LAB_RMSE8 };    /* of "figure" */

typedef struct lab_spec {
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
    double times[LAB_TIMES]; /* CPU seconds */
    size_t time_count;
    struct {
        int frames;
        noc_render_params params;
    } reference;
    lab_scene *scenes;
    lab_camera *cameras; /* scene by scene */
    lab_config *configs;
    size_t scene_count, camera_count, config_count;
    void **kept; /* owned: all that the others point at */
    size_t kept_count;
} lab_spec;

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
     * for influence volumes S_r, the share of surfaces that no light was found for, median and 99th percentile of those
     * found */
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

typedef struct lab_row {
    bool done;
    double values[COL_COUNT];
} lab_row;

/* One configuration under one camera, one repetition of it. */
typedef struct lab_run {
    size_t camera, config;
    int repetition;    /* from 0 */
    char key[LAB_KEY]; /* hash of all that the figures depend on */
    /* count of them, frame by frame; those that were not measured are not done */
    lab_row *rows[LAB_MODES];
    int count, room;
} lab_run;

/* A row of an earlier session. */
typedef struct lab_stored {
    char key[LAB_KEY];
    int mode, frame;
    bool claimed;
    double values[COL_COUNT];
} lab_stored;

typedef struct lab_crop {
    int x, y, width, height, scale, columns;
} lab_crop;

typedef struct lab_session {
    lab_args *args;
    lab_spec spec;
    char *folder, *cache;
    int lock; /* of the folder */
    noc_log *log;
    FILE *csv;
    lab_stored *stored;
    size_t stored_count;
    lab_run *runs; /* camera by camera, repetition, configuration */
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
    char reference_key[LAB_KEY];
    /* kept for the report */
    noc_scene_info *scene_infos; /* a scene */
    lab_crop *crops;             /* a camera */
    lab_noise *noises;           /* a camera */
} lab_session;

/* spec.c */
/* CLI_OK, or an exit status after reporting */
int lab_read_spec(lab_spec *spec, const char *path, bool quiet);
void lab_free_spec(lab_spec *spec);
char *lab_spec_name(const char *path); /* "a/methods.json" is "methods"; free() it */

/* member.c: one member of a JSON object to one field, by the option tables. Reported with its place. */
struct json_t;
int lab_wrong(const lab_spec *spec, const char *place, const char *fmt, ...) NOC_PRINTF(3, 4);
/* CLI_OK, or that there are too many, reported. */
int lab_too_many(const lab_spec *spec, const char *place, size_t count, size_t most, const char *what);
const noc_option *lab_option(const cli_set *sets, const char *name, size_t *offset);
int lab_set(lab_spec *spec, const char *place, const cli_set *sets, const char *const *others, void *params,
            const char *name, struct json_t *value);
int lab_set_all(lab_spec *spec, const char *place, struct json_t *object, const cli_set *sets,
                const char *const *others, void *params); /* others: names that are right here but no options */
int lab_read_name(lab_spec *spec, const char *place, struct json_t *object, const char **name);
void *lab_keep(lab_spec *spec, void *memory); /* now owned by the spec */
void *lab_longer(void *array, size_t size);   /* realloc that ends the program when memory is gone */

void lab_warn_of_idle(const lab_spec *spec, struct json_t *root); /* of options that change nothing */

/* camera.c */
/* added to the spec's */
int lab_read_cameras(lab_spec *spec, const char *place, struct json_t *cameras, size_t scene);
int lab_place_cameras(lab_session *lab, size_t camera); /* once its scene is there */
noc_camera lab_camera_at(const lab_session *lab, size_t camera, int frame);

/* config.c: shared holds what all configurations have in common, and is what they begin as. */
int lab_read_shared(lab_spec *spec, struct json_t *object, lab_config *shared);
int lab_read_config(lab_spec *spec, const char *place, struct json_t *object, const lab_config *shared, size_t entry);

/* scene.c */
int lab_load_scene(lab_session *lab, size_t scene);
int lab_make_reference(lab_session *lab, size_t camera); /* camera placed, reference read or rendered */
void lab_run_key(const lab_session *lab, lab_run *run);
noc_render_params lab_params(const lab_session *lab, const lab_run *run);
const char *lab_machine(void);

/* noise.c: kept beside the reference. half: the mean of its first frames, NULL where it has one frame alone.
 */
lab_noise lab_measure_noise(const lab_session *lab, const noc_image *half, int half_frames, const lab_batches *batches);
void lab_add_batch(lab_batches *batches, const noc_image *so_far, int frames);
void lab_keep_noise(const char *reference, const lab_noise *noise);
lab_noise lab_read_noise(const char *reference);
/* a sentence; NULL where no such pixel is; free() it */
char *lab_unlit(const lab_session *lab, size_t camera);

/* run.c */
int lab_measure(lab_session *lab, lab_run *run);
int lab_shown_mode(const lab_spec *spec, size_t camera);                         /* of pictures that are shown */
char *lab_picture(const lab_session *lab, const char *key, int mode, int frame); /* path; free() it */

/* table.c */
int lab_open_table(lab_session *lab);
void lab_claim(lab_session *lab, lab_run *run); /* rows of earlier sessions */
/* frame from 1; made where it is not there */
lab_row *lab_row_of(lab_run *run, int mode, int frame);
int lab_append(lab_session *lab, const lab_run *run, int mode, int frame); /* frame from 1 */
int lab_tidy_table(lab_session *lab); /* at the end: leaves out rows of other settings */

/* series.c: means over repetitions, or one of them; NaN where there is nothing. frame from 1. */
typedef struct lab_series {
    const lab_session *lab;
    size_t camera, config;
    int mode;
    int only; /* of one repetition, from 1; 0: means of all */
} lab_series;
bool lab_has_mode(const lab_spec *spec, size_t camera, int mode);
int lab_frames(const lab_spec *spec, size_t camera, size_t config); /* at most */
bool lab_measures(const lab_spec *spec, size_t camera, size_t config, int frame);
int lab_last(const lab_series *s); /* last frame that is there; 0: none */
double lab_at(const lab_series *s, int column, int frame);
/* A figure of a series (given what it is asked for), and the standard error of its mean over the repetitions: NaN where
 * they are fewer than two, or one of them lacks it. */
typedef double lab_asked(const lab_series *s, int column, double what);
double lab_error_of(const lab_series *s, lab_asked *asked, int column, double what);
double lab_error_at(const lab_series *s, int column, int frame); /* of lab_at */
int lab_column(const lab_spec *spec);                            /* of the spec's figure */
const char *lab_figure(const lab_spec *spec);                    /* in words, with its unit */
/* over frames and repetitions, the first frame left out */
double lab_median(const lab_series *s, int column);
lab_asked lab_time_to;     /* CPU seconds to an error; 0: at the first frame already */
lab_asked lab_error_after; /* CPU seconds */
/* CPU seconds of one frame: of the last where the camera moves, else the mean of all but the first */
lab_asked lab_frame_time;
lab_run *lab_find_run(const lab_session *lab, size_t camera, size_t config, int repetition);

/* plot.c: error over "frames" or "cpu" as SVG; name is the file's, in the folder. */
int lab_plot(const lab_session *lab, size_t camera, int mode, bool over_time, const char *name);

/* summary.c: the figures that stand for a run in a table. */
typedef struct lab_point {
    int mode, frame; /* 0: the last */
} lab_point;
int lab_points(const lab_spec *spec, size_t camera, lab_point out[LAB_POINTS]);
double lab_at_point(const lab_session *lab, size_t camera, size_t config, lab_point point, int column, double *error);
const char *lab_point_name(const lab_spec *spec, size_t camera, lab_point point);
/* that frame times are taken of */
lab_series lab_timed(const lab_session *lab, size_t camera, size_t config);
void lab_view_name(FILE *out, const lab_spec *spec, size_t camera); /* scene and camera, in Markdown */
char *lab_row_name(const lab_session *lab, size_t config);          /* of its entry; free() it */
int lab_write_summary(lab_session *lab);

/* charts.c: one SVG over all cameras, where the configurations are not too many. */
bool lab_has_bars(const lab_spec *spec); /* frame times */
int lab_bars(const lab_session *lab, const char *name);
bool lab_has_dots(const lab_spec *spec); /* errors */
int lab_dots(const lab_session *lab, const char *name);

/* sheet.c: a contact sheet, a labelled panel a picture: its crop, or all of it above its insets. */
typedef struct lab_sheet {
    const lab_crop *crop;
    const lab_camera *camera;
    uint8_t *rgb;                                  /* owned */
    int width, height;                             /* px */
    int panel_width, panel_height, picture_height; /* without and with the label and the insets */
} lab_sheet;
int lab_start_sheet(lab_sheet *sheet, const lab_crop *crop, const lab_camera *camera, size_t panels);
/* rgb: 8-bit, of a whole picture so wide; NULL: the label alone. */
void lab_add_panel(lab_sheet *sheet, size_t panel, const uint8_t *rgb, int width, const char *label);
const char *lab_inset_colour(int inset);                                /* "red" */
bool lab_read_box(const char *text, int width, int height, int box[4]); /* "x,y,width,height" inside a picture */

/* crops.c: name is that of one shown frame's sheet; free() it. */
char *lab_sheet_name(const lab_session *lab, size_t camera, int frame);
int lab_make_crops(lab_session *lab, size_t camera);
bool lab_shows(const lab_spec *spec, size_t camera, int frame);

/* report.c */
int lab_write_report(lab_session *lab);
char *lab_slug(const lab_session *lab, size_t camera); /* "1-city-street"; free() it */
/* as it reads, in Markdown: what would be markup of it or of HTML is escaped */
void lab_text(FILE *out, const char *text);
void lab_cell(FILE *out, const char *text); /* text, and a number, in a cell of a Markdown table */
void lab_number(FILE *out, double v, const char *fmt);
/* With its standard error behind it, "1.23 \302\261 0.04": two digits of it, and none where there is none. after may be
 * "". */
void lab_print_spread(FILE *out, double v, double error, const char *fmt);
void lab_spread(FILE *out, double v, double error, const char *fmt, const char *after); /* in a cell */
/* ends the line of the head: one column to the left, others to the right */
void lab_table_rule(FILE *out, size_t columns);
FILE *lab_create(const lab_session *lab, const char *name, char **temporary);
/* renames; frees temporary */
int lab_finish(const lab_session *lab, FILE *file, const char *name, char *temporary);
void lab_discard(FILE *file, char *temporary); /* instead of finishing: nothing is left */

#endif
