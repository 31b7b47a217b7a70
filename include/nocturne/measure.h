/* nocturne/measure.h: illuminance at points and on grids of the ground, as a luxmeter reads it.
 *
 * Readings are those of direct light: of lamps and whatever else the scene has that shines, and of the sky where the
 * parameters have one. Each is unbiased, and comes with its standard error, by samples that are independent of each
 * other: docs/measure.md. What a surface reflects does not count. */
#ifndef NOCTURNE_MEASURE_H
#define NOCTURNE_MEASURE_H

#include <nocturne/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a meter is: how much it takes of light from a direction w, of radiance L. e is the angle of w from the zenith, a
 * its azimuth against the meter's. */
typedef enum noc_response {
    NOC_RESPONSE_PLANE,        /* the integral of L max(0, n.w): illuminance on a plane */
    NOC_RESPONSE_SEMICYLINDER, /* of L (1 + cos a) sin e / pi: semicylindrical, EN 13201-3 */
    NOC_RESPONSE_CYLINDER,     /* of L sin e / pi: cylindrical, EN 12464 */
    NOC_RESPONSE_HEMISPHERE,   /* of L (1 + cos e) / 4: hemispherical, EN 13201-3 */
    NOC_RESPONSE_COUNT
} noc_response;

NOC_API const char *noc_response_name(noc_response response); /* "plane", "semicylinder", ... */

typedef struct noc_meter {
    double place[3];  /* local metres */
    double normal[3]; /* of any length but 0: a plane's; a half cylinder faces its azimuth; unused by the others */
    noc_response response;
} noc_meter;

typedef struct noc_reading {
    double lux, error; /* and its standard error; NaN: nothing was read there */
    double share;      /* of its area where there is such ground: 1 of a meter at a point */
    uint32_t samples;
} noc_reading;

/* When measuring may end: each block of readings goes on until three of four are as good as asked for, or have so many
 * samples. The others are those on which an edge of a shadow falls: their errors are told, too. */
typedef struct noc_measure_params {
    const noc_render_params *render; /* sky, environment_*, seed, isa; NULL: the defaults */
    double error;                    /* relative standard error of a reading; default 0.05 */
    double least;                    /* lx: what is darker need be no better than that error of this; default 0.1 */
    int samples;                     /* at most, of a reading; default 1024; at least 8 are taken */
} noc_measure_params;

#define NOC_MEASURE_DEFAULTS(set) set(render, NULL) set(error, 0.05) set(least, 0.1) set(samples, 1024)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_measure_params, noc_measure_default_params, NOC_MEASURE_DEFAULTS)
#else
#define noc_measure_default_params() ((noc_measure_params){ NOC_MEASURE_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* What an order to measure came to. */
typedef struct noc_measure_info {
    size_t readings;    /* that there are */
    size_t short_of_it; /* of them: those whose error is more than was asked for */
    double mean_error;  /* lx: standard error of the mean of all readings, each weighed by its share */
    double error;       /* median relative standard error of readings over `least`; 0: there are none */
    uint64_t samples;
    double seconds; /* wall clock */
} noc_measure_info;

/* Reads `count` meters. Neighbours in the list that stand within 16 m of each other share the search for their lights.
 * The view's thread asks, and the view forgets its picture; it should be one of its own. The result is the same for any
 * number of threads. params and info may be NULL. NOC_ERR_ARGUMENT after reporting a meter that has no place or faces
 * nowhere, and parameters that make no sense; NOC_ERR_MEMORY; NOC_ERR_CANCELLED. */
NOC_API noc_status noc_measure_points(noc_view *view, const noc_meter *meters, size_t count,
                                      const noc_measure_params *params, const noc_progress *progress,
                                      noc_reading *readings, noc_measure_info *info);

/* A raster over the ground, north up, of square pixels whose corners are multiples of `step` in its CRS. */
typedef struct noc_raster_params {
    const char *crs;  /* any that PROJ reads; NULL: noc_scene_info.given_crs, local metres where that is "" */
    double step;      /* of a pixel, in units of the CRS; default 1 */
    double extent[4]; /* west, south, east, north, in the CRS; widened to whole pixels. All 0: the scene's bounds */
    uint32_t classes; /* surfaces that count, 1u << noc_class each; 0: the ground, NOC_RASTER_GROUND, and in a scene
                         that has no such surface what has no class */
    double height;    /* m over them that the meter is held; default 0.003: over the steps of 2 mm between surfaces that
                         are laid over each other, which would shade it from light that comes at a low angle */
} noc_raster_params;

#define NOC_RASTER_GROUND                                                                                              \
    (1u << NOC_CLASS_TERRAIN | 1u << NOC_CLASS_ROAD | 1u << NOC_CLASS_SIDEWALK | 1u << NOC_CLASS_GREEN |               \
     1u << NOC_CLASS_WATER | 1u << NOC_CLASS_BRIDGE | 1u << NOC_CLASS_GROUND)

#define NOC_RASTER_DEFAULTS(set) set(crs, NULL) set(step, 1) set(classes, 0) set(height, 0.003)
#ifdef __cplusplus
NOC_DEFAULT_PARAMS(noc_raster_params, noc_raster_default_params, NOC_RASTER_DEFAULTS)
#else
#define noc_raster_default_params() ((noc_raster_params){ NOC_RASTER_DEFAULTS(NOC_DEFAULT_IN_C) })
#endif

/* Rows from the north. A pixel is the mean over the part of its area that is such ground; NaN: none of it is. */
typedef struct noc_raster {
    int width, height;
    double west, north, step; /* in the CRS */
    char *wkt;                /* the CRS without its heights, noc_scene_crs_wkt; NULL: local metres */
    float *lux, *error;       /* and its standard error; width * height */
    float *share;             /* of the pixel that is such ground, 0 to 1: lux times share is what its area gets */
} noc_raster;

/* Measures the horizontal illuminance of the ground, in blocks of 64 x 64 pixels that lie on the same lattice whatever
 * the extent is: so a pixel is the same to the bit in any raster of this step, CRS and seed that has it, and for any
 * number of threads. Otherwise as noc_measure_points. NULL after reporting why. */
NOC_API noc_raster *noc_measure_raster(noc_view *view, const noc_raster_params *raster,
                                       const noc_measure_params *params, const noc_progress *progress,
                                       noc_measure_info *info);
NOC_API void noc_raster_destroy(noc_raster *raster); /* NULL is allowed */

/* Writes a cloud optimized GeoTIFF: lux, its standard error and the share as three bands of floats, nodata NaN, with
 * the CRS, units and overviews. The items, NULL-ended pairs of a name and a text, become its metadata; they may be
 * NULL. The file appears when it is complete. NOC_ERR_UNSUPPORTED after reporting that this build, or machine, has no
 * GDAL. */
NOC_API noc_status noc_raster_write(const noc_raster *raster, const char *path, const char *const (*items)[2],
                                    noc_log *log);

/* What a set of readings says: of pixels of a raster, or points of a region. */
typedef struct noc_lux_figures {
    size_t readings;
    double least, mean, most; /* the mean weighs each reading by its share. Of noisy readings least is too low, and most
                                 too high: noc_measure_least */
    double uniformity;        /* least / mean, too low as it is; NaN where the mean is 0 */
    double low, median, high; /* 5, 50 and 95 % of the readings are at most that */
} noc_lux_figures;

/* Of `count` illuminances, and the shares that they weigh in the mean (NULL: each as much). NaN do not count.
 * NOC_ERR_MEMORY. */
NOC_API noc_status noc_lux_figures_of(const float *lux, const float *share, size_t count, noc_lux_figures *out,
                                      noc_log *log);

/* The least illuminance of a list of meters. The least of noisy readings is too low: it is chosen by its noise. */
typedef struct noc_lux_least {
    size_t meter;      /* the one that is chosen */
    double lux, error; /* what it reads, by samples that had no part in the choice, and its standard error */
    double low, high;  /* lx: the least of all lies between, by three standard errors of each that may be it */
    size_t candidates; /* meters that may be the least, by the same. 1: its place is resolved */
    uint32_t samples;  /* of lux. A lux of 0 with error 0: so many found no light, which is not proof of none */
    double uniformity; /* Uo: lux / mean; NaN where the mean is 0 */
    double uniformity_error;
} noc_lux_least;

/* Chooses the least of meters that noc_measure_points has read, by their readings, and its info: those that may be it
 * are measured again, each time fewer of them by more new samples, until one is left, or they are known to lie within
 * params.error of each other, or five times. Then it is measured by samples of its own. So lux is unbiased for that
 * meter; where candidates are left, the least may be another's, and lower: `low`. It and the mean are independent.
 * NOC_ERR_ARGUMENT where no meter has been read; otherwise as noc_measure_points. */
NOC_API noc_status noc_measure_least(noc_view *view, const noc_meter *meters, size_t count, const noc_reading *readings,
                                     const noc_measure_info *info, const noc_measure_params *params,
                                     const noc_progress *progress, noc_lux_least *out);

#ifdef __cplusplus
}
#endif
#endif
