/* legend: what the colours of a picture of numbers mean, for the page to draw beside it. */
#ifndef NOC_VIEWER_LEGEND_H
#define NOC_VIEWER_LEGEND_H

#include <jansson.h>
#include <nocturne/image.h>
#include <nocturne/scene.h>

enum { LEGEND_NAMES = 12, LEGEND_TEXT = 64 };

typedef struct legend_names {
    char text[LEGEND_NAMES][LEGEND_TEXT];
    const char *list[LEGEND_NAMES]; /* into text */
    uint32_t number[LEGEND_NAMES];
} legend_names;

/* Names a channel's numbers, which are lights of the scene: those that most pixels have, the most first. The names
 * must outlive the channel. false: no memory. */
bool legend_name_lights(legend_names *names, noc_channel *channel, const noc_scene *scene);

/* `legend` of stats, as docs/viewer-protocol.md has it. NULL: no memory, or what the params say cannot be. */
json_t *legend_of(const noc_channel *channel, const noc_channel_params *params, noc_log *log);
json_t *legend_of_difference(const noc_bar *bar); /* NULL: no memory */

#endif
