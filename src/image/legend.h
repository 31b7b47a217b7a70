/* legend: what stands under a channel's picture, and the colours that it explains. */
#ifndef NOC_IMAGE_LEGEND_H
#define NOC_IMAGE_LEGEND_H

#include "image/colormap.h"
#include "image/internal.h"

/* Numbers on a bar; labels that have names. Neither: vectors, and labels without names. */
static inline bool channel_has_bar(const noc_channel *c) {
    return c->scale != NOC_CHANNEL_LABELS && c->components == 1;
}
static inline bool channel_has_names(const noc_channel *c) {
    return c->scale == NOC_CHANNEL_LABELS && c->components == 1 && c->labels && c->label_count;
}
static inline size_t channel_pixels(const noc_channel *c) { return (size_t)c->width * (size_t)c->height; }

typedef struct legend {
    const noc_channel *channel;
    colorbar bar; /* where the channel has one */
    double lines[NOC_ISOLINES];
    int scale;                  /* of letters */
    bool *seen;                 /* label_count of them; NULL where labels have no names */
    int count, columns, column; /* of names; column: pixels */
} legend;

/* Of a picture so wide. What cannot be is reported; else legend_free. */
noc_status legend_make(legend *l, const noc_channel *c, const noc_channel_params *p, int width, noc_log *log);
int legend_height(const legend *l);
void legend_draw(const legend *l, canvas *c, int y); /* across the canvas */
void legend_free(legend *l);

/* Vectors that have a unit are no directions: the largest x or y that is shown; 0: they are directions. */
double legend_reach(const noc_channel *c);

/* Does a bar keep the ends of the picture before, when the numbers now reach from least to most? */
bool legend_holds(const noc_bar *last, bool logarithmic, double least, double most);

extern const uint8_t legend_ground[3], legend_none[3]; /* behind it; of pixels without a value */

/* isolines.c: lines and their values over the channel's picture, whose first pixel is at x in the canvas. */
bool isolines_good(const noc_isolines *lines);
noc_status isolines_draw(const legend *l, canvas *c, int x, noc_log *log);

#endif
