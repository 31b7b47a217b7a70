#include "viewer/legend.h"

#include "viewer/option.h"
#include "viewer/wire.h"

#include <inttypes.h>
#include <nocturne/text.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    STEPS = 17,      /* colours of a bar */
    NAMELESS = 4096, /* numbers without names that are looked for */
    LISTED = 24      /* of those, at most */
};

/* ---- lights by name ---- */

static size_t number_at(const noc_channel *channel, size_t pixel) {
    float v = channel->value[pixel];
    return v >= 0 ? (size_t)v : SIZE_MAX;
}

/* A lamp's id says which it is; what has none is told by its number. */
static void name_light(char *text, size_t size, const noc_scene *scene, size_t light) {
    noc_light_info info;
    char name[LEGEND_TEXT - 24] = "";
    bool there = !noc_scene_get_light(scene, light, &info) && !info.removed;
    if (there && info.light.name)
        noc_text_clean(name, sizeof(name), info.light.name);
    if (there && info.lamp && strpbrk(name, "0123456789"))
        snprintf(text, size, "%s", name);
    else
        snprintf(text, size, "%s %zu", *name ? name : there && info.lamp ? "lamp" : "light", light);
}

bool legend_name_lights(legend_names *names, noc_channel *channel, const noc_scene *scene) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    size_t slots = info.light_slots, pixels = (size_t)channel->width * (size_t)channel->height, count = 0;
    uint32_t *seen = calloc(slots + 1, sizeof(*seen));
    if (!seen)
        return false;
    for (size_t i = 0; i < pixels; i++)
        if (number_at(channel, i) < slots)
            seen[number_at(channel, i)]++;
    for (; count < LEGEND_NAMES; count++) {
        size_t most = slots; /* whose count is 0 */
        for (size_t i = 0; i < slots; i++)
            if (seen[i] > seen[most])
                most = i;
        if (most == slots)
            break;
        seen[most] = 0;
        name_light(names->text[count], LEGEND_TEXT, scene, most);
        names->list[count] = names->text[count];
        names->number[count] = (uint32_t)most;
    }
    free(seen);
    channel->labels = names->list;
    channel->label_numbers = names->number;
    channel->label_count = count;
    return true;
}

/* ---- as JSON ---- */

static json_t *hex(const uint8_t rgb[3]) {
    char text[8];
    snprintf(text, sizeof(text), "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    return json_string(text);
}

static void set_bar(json_t *to, const noc_bar *bar, void (*colour)(double at, uint8_t rgb[3])) {
    json_t *colours = json_array(), *lines = json_array();
    for (int i = 0; i < STEPS; i++) {
        uint8_t rgb[3];
        colour((double)i / (STEPS - 1), rgb);
        json_array_append_new(colours, hex(rgb));
    }
    for (int i = 0; i < bar->isoline_count; i++)
        json_array_append_new(lines, json_real(bar->isolines[i]));
    json_object_set_new(to, "low", json_real(bar->low));
    json_object_set_new(to, "high", json_real(bar->high));
    json_object_set_new(to, "log", json_boolean(bar->logarithmic));
    json_object_set_new(to, "colours", colours);
    json_object_set_new(to, "isolines", lines);
}

static bool add_bar(json_t *to, const noc_channel *channel, const noc_channel_params *params, noc_log *log) {
    noc_bar bar;
    if (noc_channel_bar(channel, params, &bar, log))
        return false;
    set_bar(to, &bar, noc_bar_colour);
    return true;
}

json_t *legend_of_difference(const noc_bar *bar) {
    json_t *legend = json_pack("{s:s, s:s}", "title", "difference: this - reference", "unit", "cd/m\u00b2");
    if (legend)
        set_bar(legend, bar, noc_difference_colour);
    return legend;
}

static void add_label(json_t *to, const noc_channel *channel, uint32_t number, const char *name) {
    char text[24];
    uint8_t rgb[3];
    snprintf(text, sizeof(text), "%" PRIu32, number);
    noc_label_colour(channel, number, rgb);
    json_array_append_new(to, json_pack("{s:o, s:i, s:o}", "text", wire_text(name ? name : text), "number", (int)number,
                                        "colour", hex(rgb)));
}

/* Names of some numbers: they are those that are seen. */
static void add_named(json_t *labels, const noc_channel *channel) {
    for (size_t i = 0; i < channel->label_count; i++)
        add_label(labels, channel, channel->label_numbers[i], channel->labels[i]);
}

/* The numbers that are seen, with their names where they have any. Of many nameless ones nobody reads a list. */
static bool add_seen(json_t *labels, const noc_channel *channel) {
    size_t count = channel->labels ? channel->label_count : NAMELESS, found = 0;
    size_t pixels = (size_t)channel->width * (size_t)channel->height;
    bool *seen = calloc(count + 1, sizeof(*seen)); /* the last one: of numbers beyond */
    for (size_t i = 0; seen && i < pixels; i++)
        if (channel->value[i] >= 0)
            seen[channel->value[i] < (float)count ? (size_t)channel->value[i] : count] = true;
    for (size_t i = 0; seen && i <= count; i++)
        found += seen[i];
    bool listed = seen && (channel->labels || (found <= LISTED && !seen[count]));
    for (size_t i = 0; listed && i < count; i++)
        if (seen[i])
            add_label(labels, channel, (uint32_t)i, channel->labels ? channel->labels[i] : NULL);
    free(seen);
    return seen != NULL;
}

static bool add_labels(json_t *to, const noc_channel *channel) {
    json_t *labels = json_array();
    json_object_set_new(to, "labels", labels);
    if (!channel->label_numbers)
        return add_seen(labels, channel);
    add_named(labels, channel);
    return true;
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
