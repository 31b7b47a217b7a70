/* colormap: perceptually uniform colour maps, and colour bars with numbers. 8-bit sRGB. */
#ifndef NOC_COLORMAP_H
#define NOC_COLORMAP_H

#include "base/base.h"
#include <nocturne/image.h>

/* Equal steps of t are equal steps of colour in Oklab.
 * DIVERGING: two straight lines of equal length from near-white in the middle (t = 0.5) to blue (0) and red (1) of the
 * same lightness, so neither sign looks larger. SEQUENTIAL: from nearly black indigo over crimson and orange to pale
 * yellow, with lightness rising all along, so it also reads in grey. */
typedef enum colormap_kind { COLORMAP_DIVERGING, COLORMAP_SEQUENTIAL } colormap_kind;

#define COLORMAP_SIZE 1025 /* odd: the middle is an entry */
typedef struct colormap {
    uint8_t rgb[COLORMAP_SIZE][3];
} colormap;

void colormap_init(colormap *map, colormap_kind kind);
const colormap *colormap_of(colormap_kind kind);           /* made once */
const uint8_t *colormap_at(const colormap *map, double t); /* t is clamped to 0..1; NaN gives the entry of 0 */

/* One colour of Oklab by lightness 0..1, chroma, and hue in radians, as near as sRGB has it. */
void colormap_polar(double lightness, double chroma, double hue, uint8_t rgb[3]);

/* A picture to draw into; rgb belongs to the caller. What falls outside is not drawn. */
typedef struct canvas {
    uint8_t *rgb;
    int width, height;
} canvas;
void canvas_fill(canvas *c, int x, int y, int width, int height, const uint8_t rgb[3]);

/* text.c: 5 x 7 pixel letters in cells of 6, times scale. ASCII; Latin-1 superscript two (0xb2) and multiplication sign
 * (0xd7). Unknown characters are drawn as a box. g, p, q and y reach two pixels below TEXT_HEIGHT. */
#define TEXT_HEIGHT NOC_TEXT_HEIGHT
int text_width(const char *s, int scale);
void text_draw(canvas *c, int x, int y, const char *s, int scale, const uint8_t rgb[3]);

/* A horizontal colour bar with ticks at round values, numbers under them, and a title above. */
typedef struct colorbar {
    const colormap *map;
    double low, high; /* values at the ends; low < high, and 0 < low where logarithmic */
    bool logarithmic;
    const char *title;   /* with the unit: "luminance [cd/m\xb2]" */
    const double *lines; /* marked in the bar, with numbers in place of round ones; NULL: none */
    size_t line_count;
} colorbar;
double colorbar_position(const colorbar *bar, double v); /* 0 at its low end, 1 at its high one */
/* The ink that is read on that colour. */
const uint8_t *colormap_ink(const uint8_t on[3]);
int colorbar_height(const colorbar *bar, int scale); /* pixels it takes; NULL: one without lines */
int colorbar_min_width(int scale);                   /* under this numbers may touch */
/* Fills width x colorbar_height pixels from (x, y): background, bar, ticks, text. */
void colorbar_draw(canvas *c, int x, int y, int width, int scale, const colorbar *bar);
/* Ticks at 1, 2 or 5 times a power of ten: at most max of them into ticks, rising; returns their number. */
size_t colorbar_ticks(const colorbar *bar, double *ticks, size_t max);

#endif
