/* lab: what plots are drawn with. */
#ifndef NOC_LAB_SVG_H
#define NOC_LAB_SVG_H

#include "lab/spec.h"

enum { SVG_COLOURS = 7, SVG_MARKERS = 8 };
/* on light ground; classes l0, l1, ... (lines) and m0, m1, ... (areas) swap them */
extern const char *const svg_colours[SVG_COLOURS];

/* A logarithmic axis: values lo to hi, and where they lie, px. */
typedef struct svg_axis {
    double lo, hi, from, to;
} svg_axis;

/* Configurations of one entry of the spec share marker and dashes, those that have the same value of the same option
 * the colour; where no entry stands for several values, each has all of its own. dot: marker where rows tell entries
 * apart already, so that the value alone decides. */
typedef struct svg_style {
    int colour, marker, dot;
    const char *dash;
} svg_style;

bool svg_is_new_value(const lab_spec *spec, size_t config); /* of an option: no configuration before it has it */

svg_style svg_style_of(const lab_spec *spec, size_t config);
double svg_place(const svg_axis *axis, double v);
double svg_inside(const svg_axis *axis, double v);                         /* the same, no further than its ends */
void svg_whisker(FILE *out, int colour, double from, double to, double y); /* a spread along x */
void svg_widen(svg_axis *axis);                        /* out to round numbers, so that at least two ticks are there */
void svg_text(FILE *out, const char *text, int limit); /* escaped, cut after so many characters */
void svg_head(FILE *out, int width, int height);
void svg_marker(FILE *out, const svg_style *style, double x, double y); /* four shapes, filled, then hollow */
/* Lines across the plot at 1, 2, 5, 10, ... and at the upper end. All have numbers where there is room for them, else
 * powers of ten alone, and the upper end. other is the other axis. */
void svg_grid(FILE *out, const svg_axis *axis, bool vertical, const svg_axis *other);

#endif
