/* render/still: a mean of frames with less noise, and its kernels, which work on rows. */
#ifndef NOC_STILL_INTERNAL_H
#define NOC_STILL_INTERNAL_H

#include "render/view.h"

#include <nocturne/smooth.h>

/* Numbers a pixel, in planes. Light is what a surface gets, without its texture: luminance, red and blue, which give
 * green. */
typedef struct still_step {
    int width, height;
    int frames, rays;         /* in the mean; that a pixel sent in all of them */
    frame_camera camera;      /* of the last frame, whose surfaces these are: */
    const float *reflects[3]; /* noc_frame_rows.reflects */
    const float *normal[3];
    const uint32_t *what;     /* noc_frame_rows.what; an emitter where any frame saw one */
    const float *illuminance; /* NOC_AOV_ILLUMINANCE */
    float *expected;          /* NOC_AOV_EXPECTED; then of light alone, 0: not known */
    float *frame_variance;    /* NOC_AOV_VARIANCE; -1: not known. Then of the light's mean, 0 where not known yet */
    float *inverse;           /* depth along the view; then 1 / depth, 0: no surface */
    float *slope_x, *slope_y; /* its change a pixel to the right and down, in the surface's plane */
    float *y, *r, *b;         /* light */
    float *variance;          /* of y */
    float *pilot, *deviation; /* a first estimate of y, and that one's variance */
    float *told;              /* relative squared error that is left, as estimated, at most 1 */
    float *rgb;               /* the mean picture, three a pixel; in the end the smoothed one */
} still_step;

/* Each does a row of the picture. What it reads of other rows, the kernels before it have written. */
typedef struct still_rows {
    void (*split)(const still_step *s, int y); /* light, inverse depths and slopes */
    void (*vary)(const still_step *s, int y);  /* variance */
    void (*guess)(const still_step *s, int y); /* pilot, deviation */
    void (*fit)(const still_step *s, int y);   /* told, rgb */
} still_rows;

extern const still_rows noc_still_rows_baseline, noc_still_rows_avx2, noc_still_rows_avx512;

#endif
