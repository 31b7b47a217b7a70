/* Channels: numbers that are no colours, in colours with a legend, or as they are. */
#include "image/legend.h"

#include <math.h>

noc_channel *noc_channel_create(int width, int height, int components, noc_log *log) {
    if (!image_size_allowed(width, height) || (components != 1 && components != 3)) {
        noc_error(log, NOC_ERR_ARGUMENT, "channel: %d x %d pixels of %d components: sides are 1..%d, components 1 or 3",
                  width, height, components, NOC_IMAGE_MAX_SIDE);
        return NULL;
    }
    noc_channel *channel = noc_calloc(1, sizeof(*channel));
    if (!channel) {
        noc_no_memory(log, "channel");
        return NULL;
    }
    float *value = image_alloc_pixels(width, height, (size_t)components * sizeof(float), log);
    if (!value) {
        free(channel);
        return NULL;
    }
    for (size_t i = 0; components == 1 && i < (size_t)width * (size_t)height; i++)
        value[i] = -1;
    *channel = (noc_channel){
        .width = width, .height = height, .components = components, .value = value, .name = "", .unit = "", .title = ""
    };
    return channel;
}

void noc_channel_destroy(noc_channel *channel) {
    if (!channel)
        return;
    free(channel->value);
    free(channel);
}

static void vector_colour(const float *v, double reach, uint8_t rgb[3]) {
    bool some = v[0] != 0 || v[1] != 0 || v[2] != 0;
    memcpy(rgb, legend_none, 3);
    for (int k = 0; some && k < 3; k++) {
        float of = reach > 0 ? (k < 2 ? v[k] / (float)reach : 0) : v[k];
        rgb[k] = (uint8_t)(NOC_CLAMP(0.5f + 0.5f * of, 0.0f, 1.0f) * 255 + 0.5f); /* false for NaN: 0 */
    }
}

/* Colours of one channel's numbers. */
typedef struct painter {
    const noc_channel *c;
    const colormap *map;
    bool logarithmic;
    float low, per; /* on the bar, or of logarithms: its low end, and entries of the map a unit */
    double reach;
    struct {
        uint32_t label;
        uint8_t rgb[3];
        bool known;
    } labels[1024]; /* that were asked for lately */
} painter;

static void painter_init(painter *p, const noc_channel *c, const colorbar *bar) {
    *p = (painter){
        .c = c, .map = colormap_of(COLORMAP_SEQUENTIAL), .logarithmic = bar->logarithmic, .reach = legend_reach(c)
    };
    if (!channel_has_bar(c))
        return;
    double low = bar->logarithmic ? log2(bar->low) : bar->low, high = bar->logarithmic ? log2(bar->high) : bar->high;
    p->low = (float)low;
    p->per = (float)((COLORMAP_SIZE - 1) / (high - low));
}

static const uint8_t *paint_label(painter *p, uint32_t label) {
    size_t at = label % NOC_COUNT(p->labels);
    if (!p->labels[at].known || p->labels[at].label != label) {
        p->labels[at].label = label;
        p->labels[at].known = true;
        noc_label_colour(p->c, label, p->labels[at].rgb);
    }
    return p->labels[at].rgb;
}

static const uint8_t *paint(painter *p, float value) {
    if (!isfinite(value) || value < 0)
        return legend_none;
    if (p->c->scale == NOC_CHANNEL_LABELS)
        return paint_label(p, (uint32_t)fminf(value, 4e9f));
    float at = (p->logarithmic ? log2f(value) : value) - p->low; /* of 0: -inf */
    at = at * p->per + 0.5f;
    return p->map->rgb[at > 0 ? NOC_MIN((int)fminf(at, COLORMAP_SIZE), COLORMAP_SIZE - 1) : 0];
}

/* The channel's pixels, the first at x in the canvas. */
static void paint_all(painter *p, canvas *to, int x) {
    const noc_channel *c = p->c;
    for (int row = 0; row < c->height; row++) {
        uint8_t *rgb = to->rgb + 3 * ((size_t)row * (size_t)to->width + (size_t)x);
        size_t first = (size_t)row * (size_t)c->width;
        for (size_t i = first; i < first + (size_t)c->width; i++, rgb += 3)
            if (c->components == 3)
                vector_colour(c->value + 3 * i, p->reach, rgb);
            else
                memcpy(rgb, paint(p, c->value[i]), 3);
    }
}

static noc_status colour(const legend *l, const noc_channel_params *p, canvas *c, noc_log *log) {
    const noc_channel *channel = l->channel;
    bool picture = p->part != NOC_CHANNEL_LEGEND, below = p->part != NOC_CHANNEL_PICTURE;
    c->width = picture ? channel->width : NOC_MAX(channel->width, p->legend_width);
    if (below)
        c->width = NOC_MAX(c->width, colorbar_min_width(l->scale));
    c->height = (picture ? channel->height : 0) + (below ? legend_height(l) : 0);
    c->rgb = noc_alloc_large((size_t)c->width * (size_t)c->height, 3);
    painter *brush = noc_alloc(sizeof(*brush));
    if (!c->rgb || !brush) {
        free(brush);
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", channel->name, c->width, c->height);
    }
    canvas_fill(c, 0, 0, c->width, c->height, legend_ground);
    painter_init(brush, channel, &l->bar);
    int x = (c->width - channel->width) / 2; /* a picture narrower than its legend stands in the middle */
    if (picture)
        paint_all(brush, c, x);
    free(brush);
    noc_status status = picture && l->bar.line_count ? isolines_draw(l, c, x, log) : NOC_OK;
    if (below)
        legend_draw(l, c, picture ? channel->height : 0);
    return status;
}

noc_status noc_channel_to_srgb8(const noc_channel *channel, const noc_channel_params *params, uint8_t **out, int *width,
                                int *height, noc_log *log) {
    static const noc_channel_params defaults = { 0 };
    const noc_channel_params *p = params ? params : &defaults;
    if (!channel || !out || !width || !height)
        return noc_null(log, __func__);
    legend l;
    canvas c = { 0 };
    noc_status status = legend_make(&l, channel, p, NOC_MAX(channel->width, p->legend_width), log);
    if (status == NOC_OK) {
        status = colour(&l, p, &c, log);
        legend_free(&l);
    }
    if (status != NOC_OK) {
        free(c.rgb);
        return status;
    }
    *out = c.rgb;
    *width = c.width;
    *height = c.height;
    return NOC_OK;
}

/* "0 other, 1 wall, ...", with the colours that stand for them; NULL: no memory. */
static char *list_labels(const noc_channel *c, bool coloured) {
    enum { AROUND = 40 }; /* number, colour and what parts them */
    size_t size = 1, at = 0;
    for (size_t i = 0; i < c->label_count; i++)
        size += strlen(c->labels[i]) + AROUND;
    char *text = noc_calloc(size, 1);
    for (size_t i = 0; text && i < c->label_count; i++) {
        uint32_t number = c->label_numbers ? c->label_numbers[i] : (uint32_t)i;
        uint8_t rgb[3];
        noc_label_colour(c, number, rgb);
        at += (size_t)noc_snprintf(text + at, size - at, "%s%u %s", i ? ", " : "", number, c->labels[i]);
        if (coloured)
            at += (size_t)noc_snprintf(text + at, size - at, " #%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    }
    return text;
}

static noc_status write_coloured(const noc_channel *channel, const char *path, const noc_channel_params *params,
                                 const meta_list *meta, noc_log *log) {
    uint8_t *rgb;
    int width, height;
    output o;
    noc_status status = noc_channel_to_srgb8(channel, params, &rgb, &width, &height, log);
    if (status != NOC_OK)
        return status;
    if (!image_size_allowed(width, height))
        status = noc_error(log, NOC_ERR_ARGUMENT, "%s: %d x %d pixels, with the legend, cannot be written", path, width,
                           height);
    status = status ? status : output_open(&o, path, log);
    if (status == NOC_OK)
        status = output_close(&o, image_write_png(&o, rgb, width, height, meta, log), log);
    free(rgb);
    return status;
}

static noc_status write_numbers(const noc_channel *channel, const char *path, const meta_list *meta, noc_log *log) {
    output o;
    noc_status status = output_open(&o, path, log);
    return status ? status : output_close(&o, image_write_exr_channel(&o, channel, meta, log), log);
}

noc_status noc_channel_write(const noc_channel *channel, const char *path, const noc_channel_params *params,
                             const noc_image_meta *meta, noc_log *log) {
    if (!channel || !path)
        return noc_null(log, __func__);
    if (!image_size_allowed(channel->width, channel->height))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a channel of %d x %d pixels cannot be written", path,
                         channel->width, channel->height);
    bool exr = image_path_ends_in(path, ".exr");
    if (!exr && !image_path_ends_in(path, ".png"))
        return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: the name's ending does not tell a format: use .png or .exr",
                         path);
    meta_list list = { 0 };
    meta_add(&list, "Software", "Nocturne %s", NOC_VERSION);
    meta_add(&list, "channel", "%s", channel->name);
    if (exr)
        meta_add(&list, "units", "%s", channel->unit);
    char *labels = channel_has_names(channel) ? list_labels(channel, !exr) : NULL;
    if (channel_has_names(channel))
        meta_add_long(&list, "labels", labels);
    noc_status status = meta_add_all(&list, meta, path, log);
    if (status == NOC_OK)
        status = exr ? write_numbers(channel, path, &list, log) : write_coloured(channel, path, params, &list, log);
    meta_free(&list);
    free(labels);
    return status;
}
