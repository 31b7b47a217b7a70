#include "viewer/legend.h"

#include "viewer/option.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    STEPS = 17,      /* colours of a bar */
    NAMELESS = 4096, /* numbers without names that are looked for */
    LISTED = 24      /* of those, at most */
};

static json_t *hex(const uint8_t rgb[3]) {
    char text[8];
    snprintf(text, sizeof(text), "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    return json_string(text);
}

static bool add_bar(json_t *to, const noc_channel *channel, const noc_channel_params *params, noc_log *log) {
    noc_bar bar;
    if (noc_channel_bar(channel, params, &bar, log))
        return false;
    json_t *colours = json_array();
    for (int i = 0; i < STEPS; i++) {
        uint8_t rgb[3];
        noc_bar_colour((double)i / (STEPS - 1), rgb);
        json_array_append_new(colours, hex(rgb));
    }
    json_object_set_new(to, "low", json_real(bar.low));
    json_object_set_new(to, "high", json_real(bar.high));
    json_object_set_new(to, "log", json_boolean(bar.logarithmic));
    json_object_set_new(to, "colours", colours);
    return true;
}

/* The numbers that are seen, with their names where they have any. Of many nameless ones nobody reads a list. */
static bool add_labels(json_t *to, const noc_channel *channel) {
    size_t count = channel->labels ? channel->label_count : NAMELESS, found = 0;
    size_t pixels = (size_t)channel->width * (size_t)channel->height;
    json_t *labels = json_array();
    bool *seen = calloc(count + 1, sizeof(*seen)); /* the last one: of numbers beyond */
    for (size_t i = 0; seen && i < pixels; i++)
        if (channel->value[i] >= 0)
            seen[channel->value[i] < (float)count ? (size_t)channel->value[i] : count] = true;
    for (size_t i = 0; seen && i <= count; i++)
        found += seen[i];
    bool listed = seen && (channel->labels || (found <= LISTED && !seen[count]));
    for (size_t i = 0; listed && i < count; i++)
        if (seen[i]) {
            uint8_t rgb[3];
            char number[24];
            noc_label_colour(channel, (uint32_t)i, rgb);
            snprintf(number, sizeof(number), "%zu", i);
            json_array_append_new(labels,
                                  json_pack("{s:s, s:i, s:o}", "text", channel->labels ? channel->labels[i] : number,
                                            "number", (int)i, "colour", hex(rgb)));
        }
    json_object_set_new(to, "labels", labels);
    free(seen);
    return seen != NULL;
}

json_t *legend_of(const noc_channel *channel, const noc_channel_params *params, noc_log *log) {
    char title[200];
    bool bar = channel->components == 1 && channel->scale != NOC_CHANNEL_LABELS;
    json_t *legend =
        json_pack("{s:s, s:s}", "title", viewer_utf8(title, sizeof(title), channel->title), "unit", channel->unit);
    if (!legend)
        return NULL;
    bool done = bar                        ? add_bar(legend, channel, params, log)
                : channel->components == 1 ? add_labels(legend, channel)
                                           : true;
    if (!done) {
        json_decref(legend);
        return NULL;
    }
    return legend;
}
