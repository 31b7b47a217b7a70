/* lab: what was measured, as curves: means over repetitions, or one of them; NaN where there is nothing. Frames count
 * from 1. */
#ifndef NOC_LAB_SERIES_H
#define NOC_LAB_SERIES_H

#include "lab/session.h"

typedef struct lab_series {
    const lab_session *lab;
    size_t camera, config;
    int mode;
    int only; /* of one repetition, from 1; 0: means of all */
} lab_series;

int lab_last(const lab_series *s); /* last frame that is there; 0: none */
double lab_at(const lab_series *s, int column, int frame);
/* A figure of a series (given what it is asked for), and the standard error of its mean over the repetitions: NaN where
 * they are fewer than two, or one of them lacks it. */
typedef double lab_asked(const lab_series *s, int column, double what);
double lab_error_of(const lab_series *s, lab_asked *asked, int column, double what);
double lab_error_at(const lab_series *s, int column, int frame); /* of lab_at */
int lab_column(const lab_spec *spec);                            /* of the spec's figure */
/* over frames and repetitions, the first frame left out; needs lab_session.values */
double lab_median(const lab_series *s, int column);
lab_asked lab_time_to;     /* CPU seconds to an error; 0: at the first frame already */
lab_asked lab_error_after; /* CPU seconds */
/* CPU seconds of one frame: of the last where the camera moves, else the mean of all but the first */
lab_asked lab_frame_time;
lab_series lab_timed(const lab_session *lab, size_t camera, size_t config); /* that frame times are taken of */

/* The figures that stand for a run in a table. */
enum { LAB_POINTS = 6 };
typedef struct lab_point {
    int mode, frame; /* 0: the last */
} lab_point;
int lab_points(const lab_spec *spec, size_t camera, lab_point out[LAB_POINTS]);
double lab_at_point(const lab_session *lab, size_t camera, size_t config, lab_point point, int column, double *error);
/* writes into text and returns it */
const char *lab_point_name(const lab_spec *spec, size_t camera, lab_point point, char text[48]);

#endif
