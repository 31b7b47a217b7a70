/* Channels: numbers that are no colours, in colours with a legend, or as they are. */
#include "image/colormap.h"
#include "image/internal.h"

#include <math.h>

static const uint8_t ground[3] = { 24, 24, 28 }, ink[3] = { 224, 224, 224 }, none[3] = { 92, 92, 96 };

noc_channel *noc_channel_create(int width, int height, int components, noc_log *log) {
    if (!image_size_allowed(width, height) || (components != 1 && components != 3)) {
        noc_error(log, NOC_ERR_ARGUMENT, "channel: %d x %d pixels of %d components: sides are 1..%d, components 1 or 3", width, height,
                  components, NOC_IMAGE_MAX_SIDE);
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
    *channel = (noc_channel){ .width = width, .height = height, .components = components, .value = value, .name = "", .unit = "", .title = "" };
    return channel;
}

void noc_channel_destroy(noc_channel *channel) {
    if (!channel)
        return;
    free(channel->value);
    free(channel);
}

static bool has_bar(const noc_channel *c) { return c->scale != NOC_CHANNEL_LABELS && c->components == 1; }
static size_t pixels_of(const noc_channel *c) { return (size_t)c->width * (size_t)c->height; }

static int compare_float(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Round numbers that are not below, and not above, v > 0. */
static double round_up(double v) {
    static const double steps[] = { 1, 1.5, 2, 3, 4, 5, 6, 8, 10 };
    double power = pow(10, floor(log10(v)));
    size_t i = 0;
    while (i + 1 < NOC_COUNT(steps) && v > steps[i] * power * (1 + 1e-6))
        i++;
    return steps[i] * power;
}
static double round_down(double v) {
    static const double steps[] = { 1, 2, 5 };
    double power = pow(10, floor(log10(v)));
    size_t i = NOC_COUNT(steps) - 1;
    while (i > 0 && v < steps[i] * power * (1 - 1e-6))
        i--;
    return steps[i] * power;
}

/* Ends of the colour bar: what was asked for, or round numbers around all but the lowest and highest half percent of the
 * numbers (on a logarithmic bar: of those above 0). */
static noc_status range_of(const noc_channel *c, const noc_channel_params *p, colorbar *bar, noc_log *log) {
    bar->logarithmic = c->scale == NOC_CHANNEL_LOG;
    bar->low = p ? p->low : 0;
    bar->high = p ? p->high : 0;
    if (bar->low != bar->high) {
        if (isfinite(bar->low) && isfinite(bar->high) && bar->low < bar->high && (bar->low > 0 || !bar->logarithmic))
            return NOC_OK;
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a legend from %g to %g cannot be drawn: it must rise%s", c->name, bar->low,
                         bar->high, bar->logarithmic ? ", and begin above 0" : "");
    }
    float *sorted = noc_alloc_large(pixels_of(c), sizeof(*sorted));
    if (!sorted)
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", c->name, c->width, c->height);
    size_t n = 0;
    for (size_t i = 0; i < pixels_of(c); i++)
        if (isfinite(c->value[i]) && (bar->logarithmic ? c->value[i] > 1e-30f : c->value[i] >= 0))
            sorted[n++] = c->value[i];
    qsort(sorted, n, sizeof(*sorted), compare_float);
    double least = n ? sorted[n / 200] : 1, most = n ? sorted[n - 1 - n / 200] : 1;
    free(sorted);
    bar->low = bar->logarithmic ? round_down(least) : 0;
    bar->high = most > 0 ? round_up(most) : 1;
    if (!(bar->high > bar->low))
        bar->high = 10 * bar->low;
    return NOC_OK;
}

/* A colour for a number that is a name: of many hues, neither dark nor grey. */
static void label_colour(uint32_t label, uint8_t rgb[3]) {
    uint32_t h = (label + 1) * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    h ^= h >> 16;
    double l = 0.55 + 0.35 * ((h >> 8 & 255) / 255.0), hue = (h & 255) / 256.0 * 2 * M_PI;
    colormap_polar(l, 0.11 + 0.05 * ((h >> 16 & 255) / 255.0), hue, rgb);
}

static void colour_of(const noc_channel *c, const colorbar *bar, float value, uint8_t rgb[3]) {
    if (!isfinite(value) || value < 0)
        memcpy(rgb, none, 3);
    else if (c->scale == NOC_CHANNEL_LABELS)
        label_colour((uint32_t)fmin(value, 4e9), rgb);
    else if (bar->logarithmic)
        memcpy(rgb, colormap_at(bar->map, value > 0 ? log(value / bar->low) / log(bar->high / bar->low) : 0), 3);
    else
        memcpy(rgb, colormap_at(bar->map, (value - bar->low) / (bar->high - bar->low)), 3);
}

static void vector_colour(const float *v, uint8_t rgb[3]) {
    bool some = v[0] != 0 || v[1] != 0 || v[2] != 0;
    memcpy(rgb, none, 3);
    for (int k = 0; some && k < 3; k++)
        rgb[k] = (uint8_t)(NOC_CLAMP(0.5f + 0.5f * v[k], 0.0f, 1.0f) * 255 + 0.5f); /* false for NaN: 0 */
}

/* Labels and vectors have no bar: what stands for a number that is none is said instead. */
static void draw_legend(canvas *c, int y, int scale, const noc_channel *channel, const colorbar *bar) {
    static const char *const grey = "grey: none";
    if (has_bar(channel)) {
        colorbar_draw(c, 0, y, c->width, scale, bar);
        return;
    }
    int middle = y + (colorbar_height(scale) - TEXT_HEIGHT * scale) / 2;
    text_draw(c, (c->width - text_width(channel->title, scale)) / 2, middle - 8 * scale, channel->title, scale, ink);
    text_draw(c, (c->width - text_width(grey, scale)) / 2, middle + 8 * scale, grey, scale, ink);
}

noc_status noc_channel_to_srgb8(const noc_channel *channel, const noc_channel_params *params, uint8_t **out, int *width,
                                int *height, noc_log *log) {
    if (!channel || !out || !width || !height)
        return noc_null(log, __func__);
    colormap map;
    colorbar bar = { .map = &map, .title = channel->title };
    noc_status status = !has_bar(channel) ? NOC_OK : range_of(channel, params, &bar, log);
    if (status != NOC_OK)
        return status;
    int scale = NOC_MAX(channel->width / 640, 1);
    canvas c = { .width = NOC_MAX(channel->width, colorbar_min_width(scale)), .height = channel->height + colorbar_height(scale) };
    c.rgb = noc_alloc_large((size_t)c.width * (size_t)c.height, 3);
    if (!c.rgb)
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", channel->name, c.width, c.height);
    colormap_init(&map, COLORMAP_SEQUENTIAL);
    canvas_fill(&c, 0, 0, c.width, c.height, ground);
    size_t margin = (size_t)(c.width - channel->width) / 2; /* a picture narrower than its legend stands in the middle */
    for (size_t i = 0; i < pixels_of(channel); i++) {
        size_t column = i % (size_t)channel->width, row = i / (size_t)channel->width;
        uint8_t *rgb = c.rgb + 3 * (row * (size_t)c.width + margin + column);
        if (channel->components == 3)
            vector_colour(channel->value + 3 * i, rgb);
        else
            colour_of(channel, &bar, channel->value[i], rgb);
    }
    draw_legend(&c, channel->height, scale, channel, &bar);
    *out = c.rgb;
    *width = c.width;
    *height = c.height;
    return NOC_OK;
}

static noc_status write_coloured(const noc_channel *channel, const char *path, const noc_channel_params *params,
                                 const noc_image_meta *meta, noc_log *log) {
    uint8_t *rgb;
    int width, height;
    noc_status status = noc_channel_to_srgb8(channel, params, &rgb, &width, &height, log);
    if (status != NOC_OK)
        return status;
    status = noc_image_write_srgb8(rgb, width, height, path, meta, log);
    free(rgb);
    return status;
}

static noc_status write_numbers(const noc_channel *channel, const char *path, const noc_image_meta *meta, noc_log *log) {
    meta_list list = { 0 };
    output o;
    meta_add(&list, "Software", "Nocturne %s", NOC_VERSION);
    meta_add(&list, "channel", "%s", channel->name);
    meta_add(&list, "units", "%s", channel->unit);
    noc_status status = meta_add_all(&list, meta, path, log);
    if (status == NOC_OK)
        status = output_open(&o, path, log);
    if (status == NOC_OK)
        status = output_close(&o, image_write_exr_channel(&o, channel, &list, log), log);
    meta_free(&list);
    return status;
}

noc_status noc_channel_write(const noc_channel *channel, const char *path, const noc_channel_params *params,
                             const noc_image_meta *meta, noc_log *log) {
    if (!channel || !path)
        return noc_null(log, __func__);
    if (!image_size_allowed(channel->width, channel->height))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a channel of %d x %d pixels cannot be written", path, channel->width,
                         channel->height);
    if (image_path_ends_in(path, ".exr"))
        return write_numbers(channel, path, meta, log);
    if (image_path_ends_in(path, ".png"))
        return write_coloured(channel, path, params, meta, log);
    return noc_error(log, NOC_ERR_UNSUPPORTED, "%s: the name's ending does not tell a format: use .png or .exr", path);
}
