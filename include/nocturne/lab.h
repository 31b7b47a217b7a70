/* nocturne/lab.h: the laboratory: how far a method or a setting is from the truth, and what time it takes
 * (docs/experiments.md).
 *
 * Three ways lead in. noc_lab_reference and noc_lab_measure compare one configuration under one camera with a
 * reference: nothing is written, figures come back frame by frame. A noc_lab_timer asks for the time alone, of several
 * configurations in turn, as `nocturne bench` does. A noc_lab runs a spec, which is what `nocturne experiment`
 * reads: many configurations under many cameras, into a folder of rows, pictures, plots and a report. What an earlier
 * run left in the folder is gone on with.
 *
 * Seconds are of the frames alone: cpu is process CPU time, wall the clock's. So nothing else should work in the
 * process meanwhile. A noc_lab belongs to one thread at a time; specs are only read once they are there. */
#ifndef NOCTURNE_LAB_H
#define NOCTURNE_LAB_H

#include <nocturne/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- one configuration ---- */

/* What a spec's configurations begin as: the renderer's defaults for pictures of this size, but without sky and jitter.
 * Light sampling is what is judged, not the edges of surfaces. */
NOC_API noc_render_params noc_lab_render_params(int width, int height);

/* Noise of a reference itself, on pixels that see no emitter, and on all: relMSE (of luminances clamped to the ceiling,
 * too), and the standard error of its mean luminance as a share of it. NaN: not known. Errors near it say nothing. */
typedef struct noc_lab_noise {
    double relmse, relmse_clamped, relmse_all, relmse_clamped_all, mean, mean_all;
} noc_lab_noise;

typedef struct noc_lab_reference_params {
    int frames;     /* that it is the mean of; default 16 */
    double ceiling; /* cd/m2, of the clamped noise; default 10 */
    noc_progress progress;
} noc_lab_reference_params;

#define NOC_LAB_REFERENCE_DEFAULTS(set) set(frames, 16) set(ceiling, 10)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_lab_reference_params, noc_lab_reference_default_params, NOC_LAB_REFERENCE_DEFAULTS)
#else
#define noc_lab_reference_default_params() ((noc_lab_reference_params){ NOC_LAB_REFERENCE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* A reference: the mean of frames by these render params, accumulate set. Those of specs are by the method reference
 * and have a seed of their own (4711), so that no configuration shares its random numbers. *image is the caller's;
 * noise may be NULL. scene must be committed. NOC_ERR_CANCELLED: progress said so, and no picture is left. */
NOC_API noc_status noc_lab_reference(noc_device *device, const noc_scene *scene, const noc_camera *camera,
                                     const noc_render_params *render, const noc_lab_reference_params *params,
                                     noc_image **image, noc_lab_noise *noise, noc_log *log);

/* What was measured of one frame. */
typedef struct noc_lab_frame {
    int frame;                    /* from 1 */
    double cpu_total, wall_total; /* s, from the first frame to this one; those of this one are in stats */
    noc_comparison alone;         /* the frame by itself against the reference: rmse, relmse, bias, ... */
    noc_comparison mean;          /* the mean of the frames so far */
    noc_frame_stats stats;
    noc_light_stats lights; /* of the structure that candidates are drawn from */
} noc_lab_frame;

typedef struct noc_lab_measure_params {
    int frames;     /* at most; default 20 */
    double seconds; /* of process CPU time, after which it ends; 0, the default: frames decide */
    noc_compare_params compare;
    noc_progress progress;
} noc_lab_measure_params;

#define NOC_LAB_MEASURE_DEFAULTS(set)                                                                                  \
    set(frames, 20) set(compare.ceiling, 10) set(compare.display.auto_exposure, true)                                  \
        set(compare.display.tonemap, NOC_TONEMAP_FILMIC)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_lab_measure_params, noc_lab_measure_default_params, NOC_LAB_MEASURE_DEFAULTS)
#else
#define noc_lab_measure_default_params() ((noc_lab_measure_params){ NOC_LAB_MEASURE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Renders frames in a fresh view and compares each with the reference, which must have the size that render says; NULL
 * params are the defaults. Each frame is rendered by itself (accumulate does not count), and the mean is made beside
 * it, so one run gives both figures. frames has room for params->frames of them; *count, which may be NULL, is how many
 * there are, also where a status says why there are no more. Where no other view of the scene is on the device, the
 * first frame pays for all that is built once, as in a spec's runs. */
NOC_API noc_status noc_lab_measure(noc_device *device, const noc_scene *scene, const noc_camera *camera,
                                   const noc_render_params *render, const noc_image *reference,
                                   const noc_lab_measure_params *params, noc_lab_frame *frames, size_t *count,
                                   noc_log *log);

/* ---- time alone ---- */

/* What is timed: frames of a scene on a device, without a reference. */
typedef struct noc_lab_case {
    noc_device *device; /* this and the scene must outlive the timer */
    const noc_scene *scene;
    noc_camera camera;
    noc_render_params render;
    bool floor; /* the trace floor, too, of one more frame after each that counts */
} noc_lab_case;

/* Of one case: medians over its frames, each number by itself. */
typedef struct noc_lab_times {
    size_t frames; /* that count */
    double wall_seconds, cpu_seconds;
    double pass_seconds[NOC_PASS_COUNT]; /* thread seconds, as in noc_frame_stats */
    size_t floors;                       /* trace floors; 0: the next is 0 */
    noc_trace_floor floor;
    noc_frame_stats first; /* of the very first frame, which makes what the others find there, and does not count */
    noc_frame_stats last;
    noc_light_stats lights; /* of the last frame */
} noc_lab_times;

/* Times cases against each other: in a round each of them renders a frame, so that whatever else the machine does falls
 * on all of them alike. A timer belongs to one thread at a time. log may be NULL; it must outlive the timer. NULL: no
 * memory, reported. */
typedef struct noc_lab_timer noc_lab_timer;
NOC_API noc_lab_timer *noc_lab_timer_create(noc_log *log);
NOC_API void noc_lab_timer_destroy(noc_lab_timer *timer);
/* A case more, numbered from 0 in their order: makes its view, and renders two frames that do not count. progress may
 * be NULL. After an error, and NOC_ERR_CANCELLED, it is not there. */
NOC_API noc_status noc_lab_timer_add(noc_lab_timer *timer, const noc_lab_case *of, const noc_progress *progress);
/* One frame more of each case, every second round in reverse order. What was measured before an error, and
 * NOC_ERR_CANCELLED, counts. */
NOC_API noc_status noc_lab_timer_round(noc_lab_timer *timer, const noc_progress *progress);
/* NOC_ERR_ARGUMENT where there is none of that index. */
NOC_API noc_status noc_lab_timer_get(const noc_lab_timer *timer, size_t index, noc_lab_times *times);

/* ---- specs ---- */

typedef struct noc_lab_spec noc_lab_spec;

/* Reads a spec, JSON as docs/experiments.md tells. All that can be wrong with it is one reported error here, and
 * NOC_ERR_FORMAT; NOC_ERR_IO is of a file that cannot be read, be it the spec or an input that it names. Options that
 * change nothing where they stand are warned of. *spec is the caller's. */
NOC_API noc_status noc_lab_spec_read(const char *path, noc_lab_spec **spec, noc_log *log);
/* The same of a text. path is what messages call it, files are named as seen from its folder, and its name without the
 * ending is the title where the spec has none; nothing is read there. */
NOC_API noc_status noc_lab_spec_parse(const char *text, const char *path, noc_lab_spec **spec, noc_log *log);
NOC_API void noc_lab_spec_destroy(noc_lab_spec *spec);

/* All texts belong to the spec. */
typedef struct noc_lab_spec_info {
    const char *name; /* of its file, without the folder and the ending */
    const char *title;
    int width, height; /* of the pictures */
    int repetitions;
    size_t scenes, cameras, configurations;
    noc_device_params device; /* that the spec names; backend auto, threads 0 and NULL where it does not */
} noc_lab_spec_info;
typedef struct noc_lab_camera_info {
    const char *name, *scene; /* each camera is of one scene */
    int motion;               /* frames that it moves for, of which the last is measured; 0: it stands still */
} noc_lab_camera_info;
typedef struct noc_lab_config_info {
    const char *name;
    const noc_render_params *render;
    int frames;     /* at most */
    double seconds; /* CPU seconds after which it ends; 0: frames decide */
} noc_lab_config_info;
NOC_API void noc_lab_spec_get_info(const noc_lab_spec *spec, noc_lab_spec_info *info);
/* NOC_ERR_ARGUMENT where there is none of that index. */
NOC_API noc_status noc_lab_spec_get_camera(const noc_lab_spec *spec, size_t index, noc_lab_camera_info *info);
NOC_API noc_status noc_lab_spec_get_config(const noc_lab_spec *spec, size_t index, noc_lab_config_info *info);

/* ---- the runs of a spec ---- */

typedef enum noc_lab_stage {
    NOC_LAB_LOADING,   /* a scene */
    NOC_LAB_REFERENCE, /* rendering one */
    NOC_LAB_MEASURING
} noc_lab_stage;

typedef struct noc_lab_progress {
    noc_lab_stage stage;
    double done; /* 0..1, of the scene, of the reference, of all runs */
    double left; /* seconds; below 0: not known */
    /* loading: the scene's name, then what is read or built, NULL when that is over; of a reference: "scene, camera";
     * else the configuration
     */
    const char *what;
    int frame, frames; /* the frame that is rendered, from 1, and how many there will be at most */
} noc_lab_progress;

typedef struct noc_lab_params {
    const char *folder; /* that all is written to, made where it is missing; needed */
    const char *cache;  /* that references are kept in; NULL: nocturne in the user's cache folder */
    /* Several processes may share a spec and a folder: this one measures part `part`, from 1, of `parts` alone, into a
     * table of its own. 0, 0: all. Parts are blocks of runs in the order of cameras. */
    int part, parts;
    noc_device_params device; /* whatever the spec names; its device text must outlive the lab */
    /* May be NULL. Called from the thread that works; return false to end the work, which can be gone on with. */
    bool (*progress)(void *user, const noc_lab_progress *progress);
    /* A line about what goes on, such as that a reference is made and how long it will take; may be NULL. */
    void (*note)(void *user, const char *text);
    void *user;
} noc_lab_params;

#define NOC_LAB_DEFAULTS(set) set(device.backend, NOC_BACKEND_EMBREE)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_lab_params, noc_lab_default_params, NOC_LAB_DEFAULTS)
#else
#define noc_lab_default_params() ((noc_lab_params){ NOC_LAB_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

typedef struct noc_lab noc_lab;

/* Takes the folder, which belongs to one noc_lab at a time, and reads the rows that are there. spec and log must
 * outlive it; the texts of params are copied. */
NOC_API noc_status noc_lab_create(const noc_lab_spec *spec, const noc_lab_params *params, noc_lab **lab, noc_log *log);
NOC_API void noc_lab_destroy(noc_lab *lab);
/* Measures all that is not there yet, and keeps each row in results.csv as soon as it is measured. After any failure
 * and NOC_ERR_CANCELLED, the next call, of this noc_lab or of another with the same folder, goes on from there. */
NOC_API noc_status noc_lab_run(noc_lab *lab);
/* Writes report.md, summary.md and their plots. After a noc_lab_run that came to its end, of all runs. */
NOC_API noc_status noc_lab_write_report(noc_lab *lab);
/* Makes results.csv and the report of the tables of all parts, as one process would have them. Call with the params of
 * a part, once its noc_lab, whose run came to its end, is destroyed: the part that ends last joins. *joined: they are
 * there. false, with NOC_OK: other parts work in the folder, or rows are missing. Waits while another process joins. */
NOC_API noc_status noc_lab_join(const noc_lab_spec *spec, const noc_lab_params *params, bool *joined, noc_log *log);

typedef struct noc_lab_state {
    const char *folder; /* the lab's */
    size_t rows;        /* in results.csv, of this spec */
    size_t rows_made;   /* of them: by this noc_lab */
    int reference_lost; /* frames of a reference that was being made when the run ended: it is not kept */
    int reference_frames;
} noc_lab_state;
NOC_API void noc_lab_get_state(const noc_lab *lab, noc_lab_state *state);

/* One row of results.csv. */
typedef struct noc_lab_row {
    const char *scene, *camera, *configuration; /* the spec's */
    int repetition, frame;                      /* from 1 */
    bool mean;                                  /* of the mean of the frames so far, else of the frame alone */
    const double *values;                       /* by noc_lab_columns; the lab's */
} noc_lab_row;
/* Names of the values of a row, NULL-ended: "wall_s", "cpu_s", ..., as in the head of results.csv. */
NOC_API const char *const *noc_lab_columns(void);
/* The index-th row that is there, camera by camera, run by run, frame by frame; false where there are no more. */
NOC_API bool noc_lab_get_row(const noc_lab *lab, size_t index, noc_lab_row *row);

#ifdef __cplusplus
}
#endif
#endif
