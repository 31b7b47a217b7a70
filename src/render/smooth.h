/* render/smooth: what a smoother keeps, and its kernels, which work on rows of finished frames. */
#ifndef NOC_SMOOTH_INTERNAL_H
#define NOC_SMOOTH_INTERNAL_H

#include "render/view.h"

#include <nocturne/smooth.h>

/* Numbers a pixel. Light is what surfaces get, without their textures: the mean over the frames that are remembered,
 * how many those are, the luminance of the mean over the last few of them, the second moment of the first mean's. Shown
 * is the picture: what surfaces and sky have where no emitter is before them, frames, what emitters add and their
 * share. */
enum { LIGHT_FRAMES = 3, LIGHT_RECENT, LIGHT_SQUARES, LIGHT_HELD };
enum { SHOWN_FRAMES = 3, SHOWN_EMITTER = 4, SHOWN_SHARE = 7, SHOWN_HELD };
enum { RECENT = 4 }; /* frames */
enum { AROUND = 3 }; /* pixels: windows in which what changes is told from noise are so wide on each side */
enum { FEW = 4 };    /* frames: with fewer of them variance is taken from the window */
enum { MOST_PASSES = 6 };

/* Sums over such windows; the last one is of squares of SUM_FRAME. */
typedef enum smooth_sum { SUM_CHANGE, SUM_KNOWN, SUM_PIXELS, SUM_FRAME, SUM_SQUARES, SUMS } smooth_sum;

/* Luminance, red and blue, which give green; and the variance of the luminance. */
typedef struct smooth_planes {
    float *y, *r, *b, *variance;
} smooth_planes;

/* What is kept of a frame for the next one. */
typedef struct smooth_frame {
    int width, height;
    frame_camera camera;
    float *inverse;           /* 1 / depth along the view, 1/m; under 0: of an emitter; 0: there is no surface */
    float *slope_x, *slope_y; /* its change a pixel to the right and down, in the surface's plane */
    float *normal[3];
    uint32_t *what;
    float (*light)[LIGHT_HELD], (*shown)[SHOWN_HELD];
} smooth_frame;

/* A step, as kernels see it. */
typedef struct smooth_step {
    smooth_frame now;
    const smooth_frame *then; /* NULL: there is none that motion leads to */
    noc_frame_rows rows; /* depth lies where now.inverse comes to lie; rgb in the end is the picture of this frame */
    float *sums[SUM_SQUARES]; /* lie where planes[1] comes to lie */
    smooth_planes planes[2];
    noc_image *image;
    const noc_smooth_params *params;
    bool still; /* neither camera nor scene have changed */
    int rested; /* steps in a row that were still */
    int pass;   /* of the filter; then how many there were */
} smooth_step;

/* Each does a row of the picture. What it reads of other rows, the kernels before it have written. */
typedef struct smooth_rows {
    void (*shape)(const smooth_step *s, int y);  /* inverse depths and slopes */
    void (*gather)(const smooth_step *s, int y); /* light: that of before along the motion, and this frame's; sums of
                                                    the row */
    void (*settle)(const smooth_step *s, int y); /* where light has changed, what is old is forgotten; planes[0] */
    void (*filter)(const smooth_step *s, int y); /* planes[pass & 1] to the others */
    void (*make)(const smooth_step *s, int y);   /* the picture of this frame: rows.rgb */
    void (*show)(const smooth_step *s, int y);   /* accumulated */
} smooth_rows;

extern const smooth_rows noc_smooth_rows_baseline, noc_smooth_rows_avx2, noc_smooth_rows_avx512;

#endif
