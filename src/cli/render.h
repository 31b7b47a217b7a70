/* nocturne render: what its files share. */
#ifndef NOC_CLI_RENDER_H
#define NOC_CLI_RENDER_H

#include "cli.h"

typedef struct render_args {
    cli_args common;
    const char *output;
    int frames;
    double time; /* s; 0: no limit */
    int threads;
    bool stats;
    int preset; /* noc_preset */
    int show;   /* 0: the picture, else 1 + noc_aov */
    const char *show_range, *influence_obj;
    noc_channel_params range;
    const char *camera_name;
    noc_camera_params camera;
    const char *size, *exposure;
    noc_render_params render;
    noc_display_params display;
    noc_import_params import;
    noc_builtin_params builtin;
} render_args;

/* One run of the command: inputs to picture. */
typedef struct render_job {
    render_args *args;
    noc_log *log;
    noc_scene *scene;
    noc_device *device;
    noc_view *view;
    noc_image *image;
    noc_channel *shown; /* --show */
    void *room;         /* memory that the picture and its file will take, held while frames are rendered */
    noc_camera camera;
    bool far_away; /* the camera is, and it was said */
    noc_scene_info scene_info;
    noc_report *report;                                              /* on the inputs; NULL without any */
    noc_frame_stats last;                                            /* of the last complete frame */
    double started, loaded, ready, rendered;                         /* wall clock */
    int frames;                                                      /* complete */
    double frame_seconds, cpu_seconds, pass_seconds[NOC_PASS_COUNT]; /* summed over complete frames */
    double floor_seconds;                                            /* trace floor of one frame; 0: not measured */
} render_job;

/* camera.c */
int cli_choose_camera(render_args *args); /* of the recipe, where the words say no other */
int cli_check_camera(const render_args *args);

/* show.c */
int cli_parse_show(render_args *args);
noc_status cli_write_view(render_job *job, const noc_image_meta *meta);
void cli_print_view_kind(const render_job *job, bool numbers); /* what the file holds; ends the line */
void cli_print_view(const render_job *job);

/* report.c */
void cli_print_summary(const render_job *job);
void cli_print_stats(const render_job *job);
void cli_warn_of_picture(const render_job *job); /* once it is written */
noc_status cli_write_picture(render_job *job);   /* with all of its metadata */

#endif
