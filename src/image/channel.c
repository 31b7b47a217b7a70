/* Channels: numbers that are no colours, in colours with a legend, or as they are. */
#include "image/colormap.h"
#include "image/internal.h"

#include <math.h>

static const uint8_t ground[3] = { 24, 24, 28 }, ink[3] = { 224, 224, 224 }, none[3] = { 92, 92, 96 };

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

static bool has_bar(const noc_channel *c) { return c->scale != NOC_CHANNEL_LABELS && c->components == 1; }
static bool has_names(const noc_channel *c) {
    return c->scale == NOC_CHANNEL_LABELS && c->components == 1 && c->labels && c->label_count;
}
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

/* Ends of the colour bar: what was asked for, or round numbers around all but the lowest and highest half percent of
 * the numbers (on a logarithmic bar: of those above 0). */
static noc_status range_of(const noc_channel *c, const noc_channel_params *p, colorbar *bar, noc_log *log) {
    bar->logarithmic = c->scale == NOC_CHANNEL_LOG;
    bar->low = p ? p->low : 0;
    bar->high = p ? p->high : 0;
    if (bar->low != bar->high) {
        if (isfinite(bar->low) && isfinite(bar->high) && bar->low < bar->high && (bar->low > 0 || !bar->logarithmic))
            return NOC_OK;
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a legend from %g to %g cannot be drawn: it must rise%s", c->name,
                         bar->low, bar->high, bar->logarithmic ? ", and begin above 0" : "");
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

/* A colour for a number that is a name: of many hues, neither dark nor grey. Those that have names of their own are
 * few: their hues lie a golden angle apart, with three lightnesses in turn, so that those of near hues differ in that.
 */
static void label_colour(const noc_channel *c, uint32_t label, uint8_t rgb[3]) {
    if (has_names(c) && label < c->label_count && c->label_colours) {
        memcpy(rgb, c->label_colours[label], 3);
        return;
    }
    if (has_names(c) && label < c->label_count) {
        static const double lightness[3] = { 0.72, 0.52, 0.88 };
        colormap_polar(lightness[label % 3], 0.13, fmod(label * 2.399963229728653 - 1.2, 2 * M_PI), rgb);
        return;
    }
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
        label_colour(c, (uint32_t)fmin(value, 4e9), rgb);
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

/* Names of the labels that a picture shows, in columns, and grey for none. In units of scale. */
enum { MARGIN = 6, GAP = 4, SWATCH = 9, LINE = SWATCH + GAP };
typedef struct names {
    bool *seen;                 /* label_count of them; NULL where labels have no names */
    int count, columns, column; /* column: pixels */
} names;

static bool names_of(const noc_channel *c, int width, int scale, names *n) {
    *n = (names){ .count = 1, .column = text_width("none", scale) };
    if (!has_names(c))
        return true;
    n->seen = noc_calloc(c->label_count, sizeof(*n->seen));
    if (!n->seen)
        return false;
    for (size_t i = 0; i < pixels_of(c); i++)
        if (c->value[i] >= 0 && c->value[i] < (double)c->label_count)
            n->seen[(size_t)c->value[i]] = true;
    for (size_t i = 0; i < c->label_count; i++)
        if (n->seen[i]) {
            n->count++;
            n->column = NOC_MAX(n->column, text_width(c->labels[i], scale));
        }
    n->column += (SWATCH + 4 * GAP) * scale;
    n->columns = NOC_CLAMP((width - 2 * MARGIN * scale) / n->column, 1, n->count);
    return true;
}

static int names_height(const names *n, int scale) {
    return scale * (2 * MARGIN + TEXT_HEIGHT + GAP + (n->count + n->columns - 1) / n->columns * LINE);
}

static void draw_names(canvas *c, int y, int scale, const noc_channel *channel, const names *n) {
    int left = (c->width - n->columns * n->column) / 2, at = 0;
    y += MARGIN * scale;
    text_draw(c, (c->width - text_width(channel->title, scale)) / 2, y, channel->title, scale, ink);
    y += (TEXT_HEIGHT + GAP) * scale;
    for (size_t i = 0; i <= channel->label_count; i++) {
        bool last = i == channel->label_count;
        uint8_t rgb[3];
        if (!last && !n->seen[i])
            continue;
        if (last)
            memcpy(rgb, none, 3);
        else
            label_colour(channel, (uint32_t)i, rgb);
        int column = left + at % n->columns * n->column, row = y + at / n->columns * LINE * scale;
        canvas_fill(c, column, row, SWATCH * scale, SWATCH * scale, rgb);
        text_draw(c, column + (SWATCH + GAP) * scale, row + scale, last ? "none" : channel->labels[i], scale, ink);
        at++;
    }
}

/* Labels without names and vectors have no bar: what stands for a number that is none is said instead. */
static void draw_legend(canvas *c, int y, int scale, const noc_channel *channel, const colorbar *bar, const names *n) {
    static const char *const grey = "grey: none";
    if (has_bar(channel)) {
        colorbar_draw(c, 0, y, c->width, scale, bar);
        return;
    }
    if (n->seen) {
        draw_names(c, y, scale, channel, n);
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
    canvas c = { .width = NOC_MAX(channel->width, colorbar_min_width(scale)) };
    names n;
    if (names_of(channel, c.width, scale, &n)) {
        c.height = channel->height + (n.seen ? names_height(&n, scale) : colorbar_height(scale));
        c.rgb = noc_alloc_large((size_t)c.width * (size_t)c.height, 3);
    }
    if (!c.rgb) {
        free(n.seen);
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for %d x %d pixels", channel->name, channel->width,
                         channel->height);
    }
    colormap_init(&map, COLORMAP_SEQUENTIAL);
    canvas_fill(&c, 0, 0, c.width, c.height, ground);
    /* a picture narrower than its legend stands in the middle */
    size_t margin = (size_t)(c.width - channel->width) / 2;
    for (size_t i = 0; i < pixels_of(channel); i++) {
        size_t column = i % (size_t)channel->width, row = i / (size_t)channel->width;
        uint8_t *rgb = c.rgb + 3 * (row * (size_t)c.width + margin + column);
        if (channel->components == 3)
            vector_colour(channel->value + 3 * i, rgb);
        else
            colour_of(channel, &bar, channel->value[i], rgb);
    }
    draw_legend(&c, channel->height, scale, channel, &bar, &n);
    free(n.seen);
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
        uint8_t rgb[3];
        label_colour(c, (uint32_t)i, rgb);
        at += (size_t)noc_snprintf(text + at, size - at, "%s%zu %s", i ? ", " : "", i, c->labels[i]);
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
    char *labels = has_names(channel) ? list_labels(channel, !exr) : NULL;
    if (has_names(channel))
        meta_add_long(&list, "labels", labels);
    noc_status status = meta_add_all(&list, meta, path, log);
    if (status == NOC_OK)
        status = exr ? write_numbers(channel, path, &list, log) : write_coloured(channel, path, params, &list, log);
    meta_free(&list);
    free(labels);
    return status;
}
