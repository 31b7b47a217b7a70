/* nocturne experiment: what its plots share. */
#ifndef NOC_CLI_EXPERIMENT_SVG_H
#define NOC_CLI_EXPERIMENT_SVG_H

#include "experiment.h"

enum { SVG_COLOURS = 7 };
extern const char *const svg_colours[SVG_COLOURS]; /* on light ground; classes l0, l1, ... (lines) and m0, m1, ... (areas) swap them */

/* A logarithmic axis: values lo to hi, and where they lie, px. */
typedef struct svg_axis { double lo, hi, from, to; } svg_axis;

/* Configurations of one entry of the spec share marker and dashes, those of one choice the colour; without choices each has
 * all of its own. */
typedef struct svg_style { int colour, marker; const char *dash; } svg_style;

svg_style svg_style_of(const experiment_spec *spec, size_t config);
double svg_place(const svg_axis *axis, double v);
void svg_widen(svg_axis *axis); /* out to round numbers, so that at least two ticks are there */
void svg_text(FILE *out, const char *text, int limit); /* escaped, cut after so many characters */
void svg_head(FILE *out, int width, int height);
void svg_marker(FILE *out, const svg_style *style, double x, double y); /* four shapes, filled, then hollow */
/* Lines across the plot at round values, and their numbers; other is the other axis. Numbers thin out where they would touch. */
void svg_grid(FILE *out, const svg_axis *axis, bool vertical, const svg_axis *other);

#endif
