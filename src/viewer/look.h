/* look: what one picture is set to: an estimator, a display and a mode, by the names of options. All that is set stands
 * in the option tables, so that no name is typed twice. */
#ifndef NOC_VIEWER_LOOK_H
#define NOC_VIEWER_LOOK_H

#include "viewer/viewer.h"

#include <jansson.h>

typedef struct look {
    noc_render_params render; /* size and aovs are the session's: look_params */
    noc_display_params display;
    noc_channel_params channel; /* how numbers become colours */
    int show;                   /* 0: the picture, else 1 + noc_aov */
    int preset;                 /* noc_preset that was set last */
    bool smooth;                /* moving pictures are smoothed, for display alone */
    int frames;                 /* in the mean, then the picture rests; 0: without end */
} look;

/* What a viewer's looks begin with. */
look look_default(const viewer_source *source);

/* Of all looks: options in the order in which they are shown, each as docs/viewer-protocol.md has it, with the value of
 * `begin` as its default. NULL: no memory. Modes: of the choices of show. */
json_t *look_schema(const look *begin);
json_t *look_modes(void);
/* Name to text of all options; and name to reason of those that change no picture as the others are. */
json_t *look_values(const look *look);
json_t *look_idle(const look *look, bool has_map);

/* Sets an option. false: the look is as it was, and why says what is wrong. A look that a frame would refuse is never
 * made. */
bool look_set(look *look, const char *name, const char *value, char *why, size_t size);
/* The text of an option's value; the length, as snprintf has it. -1: there is no such option. */
int look_get(const look *look, const char *name, char *text, size_t size);

bool look_has_bar(const look *look); /* it shows numbers on a colour bar */
/* What a frame of that size is rendered with. */
noc_render_params look_params(const look *look, int width, int height);
/* The words that say the look beside `command`, of which the recipe and the program's defaults have their part: options
 * that differ, one word each for name and value, to be quoted. The caller frees the list and each word. NULL: no
 * memory.
 */
char **look_words(const look *look, const noc_recipe *recipe, bool has_map, size_t *count);

#endif
