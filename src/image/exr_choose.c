/* OpenEXR, reading: which part and which layer of a file is the picture. */
#include "image/exr.h"

#include <nocturne/text.h>

/* The channel `end` of a layer, whose name with its dot is the first n bytes of `layer`. */
static const exr_attr_chlist_entry_t *find_channel(const exr_attr_chlist_t *list, const char *layer, size_t n,
                                                   const char *end) {
    for (int i = 0; i < list->num_channels; i++) {
        const char *name = list->entries[i].name.str;
        if (strncmp(name, layer, n) == 0 && strcmp(name + n, end) == 0)
            return &list->entries[i];
    }
    return NULL;
}

/* Is this the channel R of a layer that has G and B too? The length of the layer's name and its dot in *n. */
static bool begins_layer(const exr_attr_chlist_t *list, const char *channel, size_t *n) {
    const char *dot = strrchr(channel, '.');
    *n = dot ? (size_t)(dot + 1 - channel) : 0;
    return dot && strcmp(dot, ".R") == 0 && find_channel(list, channel, *n, "G") &&
           find_channel(list, channel, *n, "B");
}

/* A list for people, of which not all may be told. */
typedef struct names {
    char text[600];
    size_t length;
    int count, told;
} names;

static void tell(names *list, const char *kind, const char *name, int length) {
    if (++list->count > 8)
        return;
    list->length += (size_t)noc_snprintf(list->text + list->length, sizeof(list->text) - list->length, "%s%s%.*s",
                                         list->told++ ? ", " : "", kind, NOC_MIN(length, 60), name);
}

static const char *told(names *list) {
    if (list->count > list->told)
        noc_snprintf(list->text + list->length, sizeof(list->text) - list->length, " and %d more",
                     list->count - list->told);
    return noc_text_clean(list->text, sizeof(list->text), list->text);
}

/* Layers with R, G and B, each a name and a dot; the last one is kept in r. */
static int find_layers(exr_reader *r, const exr_attr_chlist_t *list, names *layers) {
    size_t n;
    for (int i = 0; i < list->num_channels; i++) {
        const char *name = list->entries[i].name.str;
        if (!begins_layer(list, name, &n))
            continue;
        tell(layers, "", name, n > 1 ? (int)n - 1 : 1);
        noc_snprintf(r->layer, sizeof(r->layer), "%.*s", (int)n, name);
    }
    return layers->count;
}

static bool refuse_sampling(exr_reader *r, const exr_attr_chlist_t *list) {
    for (int i = 0; i < list->num_channels; i++)
        if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1) {
            r->status = noc_error(r->log, NOC_ERR_UNSUPPORTED, "%s: EXR: channel '%s' is subsampled, which is not read",
                                  r->name, list->entries[i].name.str);
            return true;
        }
    return false;
}

/* The picture of a part: its channels R, G, B or Y, or else the one layer that has R, G and B. */
static bool choose_layer(exr_reader *r, const exr_attr_chlist_t *list) {
    names layers = { 0 };
    bool rgb = find_channel(list, "", 0, "R") && find_channel(list, "", 0, "G") && find_channel(list, "", 0, "B");
    *r->layer = 0;
    r->layout = EXR_RGB;
    if (!rgb && find_channel(list, "", 0, "Y"))
        r->layout = find_channel(list, "", 0, "RY") && find_channel(list, "", 0, "BY") ? EXR_CHROMA : EXR_GREY;
    else if (!rgb && !find_layers(r, list, &layers))
        return false;
    if (layers.count > 1) {
        r->status = noc_error(r->log, NOC_ERR_FORMAT,
                              "%s: EXR: %d layers have channels R, G and B: %s. One of them is read, from a file that "
                              "holds it alone, or as R, G and B without a layer's name",
                              r->name, layers.count, told(&layers));
        return false;
    }
    r->has_mask = find_channel(list, r->layer, strlen(r->layer), "emitter") != NULL;
    return !refuse_sampling(r, list);
}

/* Names of the parts, or of the channels of a file's only one. */
static void tell_contents(exr_reader *r, int count, names *there) {
    for (int part = 0; part < count; part++) {
        const exr_attribute_t *name = NULL;
        const exr_attr_chlist_t *list = NULL;
        if (exr_get_channels(r->context, part, &list) != EXR_ERR_SUCCESS)
            continue;
        if (count > 1 && exr_get_attribute_by_name(r->context, part, "name", &name) == EXR_ERR_SUCCESS &&
            name->type == EXR_ATTR_STRING)
            tell(there, "the part ", name->string->str, name->string->length);
        for (int i = 0; count == 1 && i < list->num_channels; i++)
            tell(there, "", list->entries[i].name.str, list->entries[i].name.length);
    }
}

static void refuse_all(exr_reader *r, int count, bool flat) {
    names there = { 0 };
    tell_contents(r, count, &there);
    const char *text = told(&there);
    if (flat)
        r->status = noc_error(r->log, NOC_ERR_FORMAT, "%s: EXR: has neither channels R, G, B nor Y%s%s", r->name,
                              *text ? "; there are " : "", text);
    else
        r->status = noc_error(r->log, NOC_ERR_UNSUPPORTED, "%s: EXR: deep pixels are not read%s%s", r->name,
                              *text ? "; there are " : "", text);
}

bool exr_choose(exr_reader *r) {
    int count = 0;
    if (!exr_ok(r, exr_get_count(r->context, &count)))
        return false;
    bool flat = false;
    for (r->part = 0; r->part < count; r->part++) { /* the first flat one with a picture */
        exr_storage_t storage;
        const exr_attr_chlist_t *list = NULL;
        if (!exr_ok(r, exr_get_storage(r->context, r->part, &storage)) ||
            !exr_ok(r, exr_get_channels(r->context, r->part, &list)))
            return false;
        r->tiled = storage == EXR_STORAGE_TILED;
        if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
            continue;
        flat = true;
        if (choose_layer(r, list) || r->status != NOC_OK)
            return r->status == NOC_OK;
    }
    refuse_all(r, count, flat);
    return false;
}
