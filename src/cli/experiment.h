/* nocturne experiment: what its files share. */
#ifndef NOC_CLI_EXPERIMENT_H
#define NOC_CLI_EXPERIMENT_H

#include "render.h"

enum { EXPERIMENT_KEY = 33, EXPERIMENT_TIMES = 8, EXPERIMENT_ROWS = 1000000 };

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

typedef struct experiment_camera {
    const char *name;
    render_args args; /* view, eye, target, camera-crs, fov */
    double eye[3], target[3];
} experiment_camera;

typedef struct experiment_config {
    const char *name;
    noc_render_params params;
    int frames;
    int entry, choice; /* of the spec's list; where it stands for several choices, which of them, else -1 */
} experiment_config;

/* Noise of a reference itself: estimated relMSE. NaN: not known. */
typedef struct experiment_noise { double relmse, clamped, relmse_all, clamped_all; } experiment_noise;

enum { EXPERIMENT_ALONE, EXPERIMENT_ACCUMULATED, EXPERIMENT_MODES }; /* values of "accumulate": false, true, both */
enum { EXPERIMENT_CLAMPED, EXPERIMENT_RELMSE, EXPERIMENT_RMSE8 };    /* of "figure" */

typedef struct experiment_spec {
    const char *path;
    const char *title, *note, *size, *crop;
    int width, height;
    int crop_box[4];          /* x, y, width, height; width 0: chosen by the pictures */
    int frames, repetitions;
    int accumulate;
    uint32_t seed;            /* of the first repetition */
    int figure;
    bool all_pixels;          /* figures of plots and of time to error: all pixels, else those that see no emitter */
    double ceiling;
    double times[EXPERIMENT_TIMES]; /* CPU seconds */
    size_t time_count;
    struct { int frames; noc_render_params params; } reference;
    experiment_scene *scenes;
    experiment_camera *cameras;
    experiment_config *configs;
    size_t scene_count, camera_count, config_count;
    char **texts;             /* owned: all that the others point at */
    size_t text_count;
} experiment_spec;

/* Columns of results.csv that are numbers, after those that tell which row it is. */
enum {
    COL_WALL, COL_CPU, COL_WALL_TOTAL, COL_CPU_TOTAL,
    COL_RMSE8, COL_RELMSE, COL_CLAMPED, COL_BIAS,                 /* pixels that see no emitter */
    COL_RMSE8_ALL, COL_RELMSE_ALL, COL_CLAMPED_ALL, COL_BIAS_ALL, /* all pixels, in the same order */
    COL_BUILD, COL_MEMORY, COL_RAYS, COL_DROPPED, COL_COUNT
};

typedef struct experiment_row {
    bool done;
    double values[COL_COUNT];
} experiment_row;

/* One configuration under one camera, one repetition of it. */
typedef struct experiment_run {
    size_t scene, camera, config;
    int repetition; /* from 0 */
    char key[EXPERIMENT_KEY];                /* content hash of all that the figures depend on */
    experiment_row *rows[EXPERIMENT_MODES];  /* frames of them; NULL where the mode is not asked for */
} experiment_run;

/* A row of an earlier session. */
typedef struct experiment_stored {
    char key[EXPERIMENT_KEY];
    int mode, frame;
    bool claimed;
    double values[COL_COUNT];
} experiment_stored;

typedef struct experiment_crop { int x, y, width, height, scale, columns; bool made; } experiment_crop;

typedef struct experiment_lab {
    experiment_args *args;
    experiment_spec spec;
    char *folder, *cache;
    int lock;                 /* of the folder */
    noc_log *log;
    FILE *csv;
    experiment_stored *stored;
    size_t stored_count;
    experiment_run *runs;     /* scene by scene, camera, repetition, configuration */
    size_t run_count;
    size_t rows_total, rows_done, rows_old; /* old: of earlier sessions */
    double started;
    char path[32];            /* code that ran: "avx2 x8" */
    /* of the present scene and camera */
    noc_scene *scene;
    noc_image *reference;
    noc_camera camera;
    char reference_key[EXPERIMENT_KEY];
    /* kept for the report */
    noc_scene_info *scene_infos; /* a scene */
    experiment_crop *crops;      /* a scene and camera */
    experiment_noise *noises;    /* a scene and camera */
} experiment_lab;

/* experiment_spec.c */
int experiment_read_spec(experiment_spec *spec, const char *path); /* CLI_OK, or an exit status after reporting */
void experiment_free_spec(experiment_spec *spec);

/* experiment_member.c: one member of a JSON object to one field, by the option tables. Reported with its place. */
struct json_t;
int experiment_wrong(const experiment_spec *spec, const char *place, const char *fmt, ...) NOC_PRINTF(3, 4);
const noc_option *experiment_option(const cli_set *sets, const char *name, size_t *offset);
int experiment_set(experiment_spec *spec, const char *place, const cli_set *sets, const char *const *others, void *params,
                   const char *name, struct json_t *value); /* others: names that are right here but no options */
char *experiment_keep(experiment_spec *spec, char *text); /* now owned by the spec */

/* experiment_scene.c */
int experiment_load_scene(experiment_lab *lab, size_t scene);
int experiment_make_reference(experiment_lab *lab, size_t scene, size_t camera); /* camera placed, reference read or rendered */
void experiment_run_key(const experiment_lab *lab, experiment_run *run);
noc_render_params experiment_params(const experiment_lab *lab, const experiment_run *run);
const char *experiment_machine(void);

/* experiment_noise.c: kept beside the reference. half: the mean of its first frames, NULL where it has one frame alone. */
experiment_noise experiment_measure_noise(const experiment_lab *lab, const noc_image *half, int half_frames);
void experiment_keep_noise(const char *reference, const experiment_noise *noise);
experiment_noise experiment_read_noise(const char *reference);

/* experiment_run.c */
int experiment_measure(experiment_lab *lab, experiment_run *run);
char *experiment_picture(const experiment_lab *lab, const experiment_run *run); /* path of its first frame; free() it */

/* experiment_table.c */
int experiment_open_table(experiment_lab *lab);
void experiment_claim(experiment_lab *lab, experiment_run *run); /* rows of earlier sessions */
int experiment_append(experiment_lab *lab, const experiment_run *run, int mode, int frame); /* frame from 1 */
int experiment_tidy_table(experiment_lab *lab); /* at the end: leaves out rows of other settings */

/* experiment_series.c: means over repetitions; NaN where there is nothing. frame from 1. */
typedef struct experiment_series { const experiment_lab *lab; size_t scene, camera, config; int mode; } experiment_series;
double experiment_at(const experiment_series *s, int column, int frame);
int experiment_column(const experiment_spec *spec); /* of the spec's figure */
const char *experiment_figure(const experiment_spec *spec); /* in words, with its unit */
double experiment_median(const experiment_series *s, int column); /* over frames and repetitions, the first frame left out */
double experiment_time_to(const experiment_series *s, int column, double error); /* CPU seconds; 0: at the first frame already */
double experiment_error_after(const experiment_series *s, int column, double seconds);
experiment_run *experiment_find_run(const experiment_lab *lab, size_t scene, size_t camera, size_t config, int repetition);

/* experiment_plot.c: error over "frames" or "cpu" as SVG; name is the file's, in the folder. */
int experiment_plot(const experiment_lab *lab, size_t scene, size_t camera, int mode, bool over_time, const char *name);

/* experiment_crops.c */
int experiment_make_crops(experiment_lab *lab, size_t scene, size_t camera, const char *name);

/* experiment_report.c */
int experiment_write_report(experiment_lab *lab);
char *experiment_slug(const experiment_lab *lab, size_t scene, size_t camera); /* "city-street"; free() it */
FILE *experiment_create(const experiment_lab *lab, const char *name, char **temporary);
int experiment_finish(const experiment_lab *lab, FILE *file, const char *name, char *temporary); /* renames; frees temporary */

#endif
