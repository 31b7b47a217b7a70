/* legend: what the colours of a picture of numbers mean, for the page to draw beside it. */
#ifndef NOC_VIEWER_LEGEND_H
#define NOC_VIEWER_LEGEND_H

#include <jansson.h>
#include <nocturne/image.h>

/* `legend` of stats, as docs/viewer.md has it. NULL: no memory, or what the params say cannot be. */
json_t *legend_of(const noc_channel *channel, const noc_channel_params *params, noc_log *log);

#endif
