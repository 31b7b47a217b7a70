/* nocturne render: what its files share. */
#ifndef NOC_CLI_RENDER_H
#define NOC_CLI_RENDER_H

#include "cli.h"

/* --animate and its options */
typedef struct animation_args {
    bool on, overwrite;
    const char *path;
    double fps, duration; /* s; 0: what the path, or the number of pictures, says */
    int samples, segment;
    int film; /* noc_switch */
    const char *part_text;
    cli_part part; /* once it is checked */
} animation_args;

/* Of render; view begins with the same. */
typedef struct render_args {
    cli_args common;
    const cli_command *command; /* that they are arguments of */
    const char *output;
    int frames;
    double time; /* s; 0: no limit */
    noc_device_params device;
    bool stats;
    bool smooth;
    int preset; /* noc_preset */
    int show;   /* 0: the picture, else 1 + noc_aov */
    const char *show_range, *isolines;
    const char *influence_obj;
    noc_channel_params range;
    const char *camera_name;
    noc_camera_params camera;
    const char *size, *exposure;
    noc_render_params render;
    noc_display_params display;
    noc_import_params import;
    noc_builtin_params builtin;
    animation_args animation;
} render_args;

/* One run of the command: inputs to picture. */
typedef struct render_job {
    render_args *args;
    noc_log *log;
    noc_scene *scene;
    noc_device *device;
    noc_view *view;
    noc_smoother *smoother;    /* of an animation; NULL: without --smooth */
    const noc_image *smoothed; /* of the last frame; the smoother's */
    bool still;                /* the picture of all frames is smoothed when it is written */
    noc_image *image;
    uint32_t *label_numbers; /* of labels; NULL: 0, 1, ... */
    noc_channel *shown;      /* --show */
    char **labels;           /* that stand for its numbers where they are the scene's; label_count of them */
    size_t label_count;
    const char *file; /* that the picture goes to */
    int averaged;     /* frames in it */
    char *animation;  /* of an animation's picture, for its metadata; NULL: it is none */
    void *room;       /* memory that the picture and its file will take, held while frames are rendered */
    noc_camera camera;
    bool far_away; /* the camera is, and it was said */
    noc_scene_info scene_info;
    noc_report *report;                                              /* on the inputs; NULL without any */
    noc_frame_stats last;                                            /* of the last complete frame */
    double started, loaded, ready, rendered;                         /* wall clock */
    int frames;                                                      /* complete */
    double frame_seconds, cpu_seconds, pass_seconds[NOC_PASS_COUNT]; /* summed over complete frames */
    noc_trace_floor floor;                                           /* of one frame; 0: not measured */
} render_job;

/* render.c */
noc_status cli_start_view(render_job *job);
noc_status cli_smooth(render_job *job); /* the frame that is complete, with --smooth */
void cli_add_stats(render_job *job);    /* of a frame that is complete */
bool cli_is_failure(noc_status status); /* and no interruption */

/* animate.c: a picture for each step along a path */
const noc_option *cli_animation_options(void); /* fields of animation_args */
int cli_check_animation(render_args *args);    /* fills animation.part, too */
int cli_animate(render_job *job);              /* once the scene is there; returns the exit status */

/* series.c: the files of an animation */
typedef struct cli_series {
    char *prefix, *suffix; /* around the number */
    int digits;            /* of it, at least */
} cli_series;
/* Of what -o says: a name with one %d or %04d in it, or FILM.mp4, whose pictures lie in the folder FILM-frames. CLI_OK,
 * or CLI_USAGE after reporting. */
int cli_series_parse(const char *output, cli_series *series);
void cli_series_free(cli_series *series);
char *cli_series_file(const cli_series *series, int number); /* free() it */
char *cli_series_film(const cli_series *series);             /* the film of such pictures; free() it */
bool cli_is_film(const char *output);
/* Reports the first of the pictures that would replace a file the scene is made of. CLI_OK, or CLI_FAILURE. */
int cli_series_check(const cli_series *series, int pictures, const noc_scene *scene);
/* Makes the folder of a film's pictures; NOC_ERR_IO after reporting. alone: no other process uses the folder, so that
 * an interruption removes it while it is empty. *folder is its path then, for cli_series_leave_folder; else unchanged.
 */
noc_status cli_series_make_folder(const cli_series *series, bool alone, char **folder);
void cli_series_leave_folder(char *folder); /* removes it if it is empty, and frees the path; NULL: does nothing */
/* Removes the pictures and their folder, once the film is there. */
void cli_series_remove(const cli_series *series, int pictures);

/* film.c */
char *cli_find_ffmpeg(void); /* free() it; NULL: it is not in the folders of PATH */
bool cli_file_holds(const char *file, const char *text);
/* A film of the pictures from number 1 on, so many a second, with the comment in its metadata. It appears under its
 * name when it is whole. Another process may make the same film, and remove its pictures, meanwhile: that is NOC_OK.
 * NOC_ERR_CANCELLED, or NOC_ERR_IO after reporting it. */
noc_status cli_make_film(const char *ffmpeg, const cli_series *series, int pictures, double fps, const char *name,
                         const char *comment);

/* city.c: what render and view share. */
const noc_option *cli_camera_options(void); /* --camera, which names one of the recipe */
const noc_option *cli_exposure_options(void);
/* Options of pictures, for commands whose estimate is one of its own. */
extern const char *const cli_of_pictures[];
/* Sets the bit 1u << noc_class of each class that the text names, NULL: of none. CLI_OK, or CLI_USAGE after reporting
 * one that there is not. */
int cli_parse_classes(const cli_command *command, const char *option, const char *text, uint32_t *bits);
/* All that can be wrong with inputs, camera, preset, exposure and device, before any file is read; once the camera is
 * chosen. CLI_OK, or an exit status after reporting. */
int cli_check_city(render_args *args);
/* Loads all inputs, and switches those of a built city. report may be NULL. */
noc_status cli_load_city(render_args *args, noc_scene *scene, const noc_progress *progress, noc_report **report);

/* camera.c */
int cli_choose_camera(render_args *args); /* of the recipe, where the words say no other */
int cli_check_camera(const render_args *args);
void cli_tell_photo(const render_args *args, const noc_scene *scene); /* how well its camera fits */

/* show.c */
const noc_option *cli_show_options(void);
/* --show and its bar, once the preset is used. CLI_OK or CLI_USAGE. */
int cli_parse_show(render_args *args);
void cli_drop_view(render_job *job); /* the one that was written last */
noc_status cli_write_view(render_job *job, const noc_image_meta *meta);
void cli_print_view_kind(const render_job *job, bool numbers); /* what the file holds; ends the line */
void cli_print_view(const render_job *job);

/* report.c */
char *cli_options_text(const render_args *args); /* all that decides a picture but inputs and camera; free() it */
void cli_print_summary(const render_job *job);
void cli_print_stats(const render_job *job);
void cli_warn_of_picture(const render_job *job); /* once it is written */
noc_status cli_write_picture(render_job *job);   /* with all of its metadata */

#endif
