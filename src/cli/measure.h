/* nocturne measure: what its files share. */
#ifndef NOC_CLI_MEASURE_H
#define NOC_CLI_MEASURE_H

#include "site.h"

/* Arguments of render that it takes, too, and its own. */
typedef struct measure_args {
    render_args render;
    const char *points;
    noc_texts regions;
    const char *streets;
    const char *extent, *crs, *on;
    double grid, meter_height; /* in units of the CRS; m */
    int response;              /* noc_response */
    double error;
    int samples;
    bool json, count_windows;
} measure_args;

typedef struct measure_job {
    measure_args *args;
    cli_site site;
    noc_measure_params params;
    noc_raster_params raster;
    noc_progress progress;
    const char *lead; /* printed before the next answer */
} measure_job;

/* What is told of a set of readings. */
typedef struct measure_told {
    const char *what; /* the region, or the raster's file */
    double area;      /* m2; 0: it has none */
    noc_lux_figures figures;
    noc_measure_info info;
    bool has_least; /* else its figures have the least reading alone */
    noc_lux_least least;
    double least_at[2]; /* in the scene's CRS */
    size_t left_out;    /* places where something stands on the ground */
} measure_told;

/* The meters of a file, and their places as it has them. */
typedef struct point_list {
    noc_meter *meters;
    double *xyz; /* 3 each, in the CRS; local metres once the city is open */
    double *said;
    size_t count, capacity;
} point_list;

/* measure_points.c: --points. Reads the file, before the city is open; then measures. Both report what is wrong. */
noc_status measure_read_points(const measure_args *args, point_list *list);
noc_status measure_points(measure_job *job, point_list *list);
void measure_free_points(point_list *list);

/* measure_out.c: figures of regions and of the raster, which it writes */
/* Measures a region. log: told why it has no points (NOC_ERR_ARGUMENT); NULL: nobody is. */
noc_status measure_told_region(measure_job *job, const char *region, noc_log *log, measure_told *t);
void measure_json_figures(FILE *out, const measure_job *job, const measure_told *t, const char *before); /* of each */
noc_status measure_regions(measure_job *job);
noc_status measure_raster(measure_job *job);

/* measure_streets.c: --streets, figures of all streets as a layer */
noc_status measure_streets(measure_job *job);

#endif
