/* nocturne measure: what its files share. */
#ifndef NOC_CLI_MEASURE_H
#define NOC_CLI_MEASURE_H

#include "render.h"

/* Arguments of render that it takes, too, and its own. */
typedef struct measure_args {
    render_args render;
    const char *points;
    noc_texts regions;
    const char *extent, *crs, *on;
    double grid, height; /* in units of the CRS; m */
    int response;        /* noc_response */
    double error;
    int samples;
    bool json, count_windows;
} measure_args;

typedef struct measure_job {
    measure_args *args;
    noc_log *log;
    noc_scene *scene;
    noc_scene_info info;
    noc_report *report;
    noc_device *device;
    noc_view *view;
    noc_camera camera;
    noc_measure_params params;
    noc_raster_params raster;
    noc_progress progress;
    const char *lead; /* printed before the next answer */
} measure_job;

/* measure_points.c: --points */
noc_status measure_points(measure_job *job);

/* measure_out.c: figures of regions and of the raster, which it writes */
noc_status measure_regions(measure_job *job);
noc_status measure_raster(measure_job *job);

#endif
