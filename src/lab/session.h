/* lab: the runs of a spec: what there is of them, and what they have in common.
 *
 * Arrows between the files of this room, by the headers they include (tests/layers.sh holds that there is no circle):
 *
 *     file, spec     what a spec asks for; files
 *     member         of JSON objects, by option tables    <- config, cameras <- read
 *     session        this                                 <- motion <- keys, noise, parts <- reference
 *     table          results.csv                          } <- run, parts
 *     measure        one configuration, frame by frame    }
 *     series         means over repetitions               <- charts, plot (on svg), summary (on markdown) <- report
 *     sheet          pictures side by side                <- crops
 *     parts          tables of processes that share a spec; who waits for whom
 *     lab            all of them: noc_lab_run and the others
 *     timer          by itself: time without a reference
 */
#ifndef NOC_LAB_SESSION_H
#define NOC_LAB_SESSION_H

#include "lab/spec.h"

enum { LAB_KEY = 33 };     /* of a hash */
enum { LAB_DEVICE = 500 }; /* of "vulkan, NVIDIA GeForce RTX 3060, NVIDIA 550.54" */

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
     * for influence S_r, the share of surfaces that no light was found for, median and 99th percentile of those found
     */
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
    noc_backend_id reference; /* that rendered the reference it was measured against */
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
    noc_backend_id reference;
    double values[COL_COUNT];
} lab_stored;

/* The table of a part that this session joins. */
typedef struct lab_part {
    int lock; /* its descriptor */
    char *path;
} lab_part;

/* What a scene holds, for the report. */
typedef struct lab_holdings {
    noc_scene_info info; /* its texts belong to the scene, which is gone */
    size_t buildings, lamps;
} lab_holdings;

/* What is known of a reference beside its picture. */
typedef struct lab_truth {
    noc_lab_noise noise;
    char device[LAB_DEVICE]; /* that rendered it, its backend first */
} lab_truth;

typedef struct lab_crop {
    int x, y, width, height, scale, columns;
} lab_crop;

typedef struct noc_lab {
    noc_lab_params params; /* folder and cache are the session's own below */
    const lab_spec *spec;
    char *folder, *cache;
    int lock;      /* of the folder; -1: none */
    int part_lock; /* of this part's table; -1: none */
    int guard;     /* held while parts begin or join; -1: not */
    bool joining;  /* the session makes results.csv of parts, and measures nothing */
    bool busy;     /* it does not: other parts work in the folder, */
    bool joined;   /* or another process has done it, */
    bool missing;  /* or rows or pictures are missing */
    NOC_ARRAY(lab_part) taken;
    noc_log *log;
    FILE *csv;
    NOC_ARRAY(lab_stored) stored;
    lab_run *runs; /* camera by camera, repetition, configuration */
    size_t run_count, runs_done;
    size_t runs_mine;               /* of run_count */
    size_t rows_done, rows_old;     /* old: of earlier sessions */
    size_t rows_broken, rows_twice; /* of results.csv, as it was */
    double started, reference_seconds;
    size_t references_made, cameras_done;
    int reference_lost;             /* frames of a reference that was interrupted: it is not kept */
    bool cancelled;                 /* progress said so */
    bool finished;                  /* the last run came to its end */
    char path[32];                  /* code that ran: "avx2 x8" */
    noc_device_info device;         /* that renders */
    char machine[LAB_DEVICE + 456]; /* with the device */
    char build[LAB_KEY];
    double *sum;    /* room for the mean of a picture */
    double *values; /* for a median: one a frame and repetition; while a report is written */
    /* of the present scene and camera */
    noc_scene *scene;
    char content[NOC_CONTENT_KEY];
    noc_image *reference;
    noc_camera camera, before; /* at its pose, and before the cut */
    char reference_key[LAB_KEY];
    /* kept for the report */
    lab_holdings *holdings; /* a scene */
    lab_crop *crops;        /* a camera */
    lab_truth *truths;      /* a camera */
} lab_session;

lab_run *lab_find_run(const lab_session *lab, size_t camera, size_t config, int repetition);
noc_render_params lab_params_of(const lab_session *lab, const lab_run *run);
/* frame from 1; made where it is not there. NULL after reporting that memory was refused. */
lab_row *lab_row_of(const lab_session *lab, lab_run *run, int mode, int frame);
char *lab_picture_path(const lab_session *lab, const char *key, int mode, int frame); /* free() it; NULL likewise */
char *lab_light_path(const lab_session *lab, const char *key, int frame); /* of the frame's light view; likewise */
/* Of one shown frame's sheet, or of its light view's; writes into text and returns it. */
/* Reports an error if the experiment would replace a file that the present scene is made of. */
noc_status lab_check_sources(const lab_session *lab);
const char *lab_sheet_name(const lab_spec *spec, size_t camera, int frame, bool light, char text[LAB_TEXT]);

/* Returns the backend that a device's text begins with; embree where it begins with none. */
noc_backend_id lab_backend_of(const char *device);

void lab_note(const lab_session *lab, const char *fmt, ...) NOC_PRINTF(2, 3);
bool lab_go_on(lab_session *lab, const noc_lab_progress *progress); /* false from then on where it was to end */

#endif
