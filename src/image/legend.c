/* What stands under a channel's picture: a bar with its numbers, or names. */
#include "image/legend.h"

#include <math.h>

const uint8_t legend_ground[3] = { 24, 24, 28 }, legend_none[3] = { 92, 92, 96 };
static const uint8_t ink[3] = { 224, 224, 224 };

/* ---- bars ---- */

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

enum { HALF = 1 << 16 };

/* Numbers that ends are found from: the bits of floats that are not negative rise as they do. */
static bool counts(const noc_channel *c, bool logarithmic, size_t i, uint32_t *bits) {
    float v = c->value[i];
    memcpy(bits, &v, sizeof(v));
    return isfinite(v) && (logarithmic ? v > 1e-30f : v >= 0);
}

/* The k-th smallest of them. high: how many have these upper halves; low: room for so many. */
static float smallest(const noc_channel *c, bool logarithmic, size_t k, const uint32_t *high, uint32_t *low) {
    uint32_t upper = 0, lower = 0, bits;
    float v;
    while (k >= high[upper])
        k -= high[upper++];
    memset(low, 0, HALF * sizeof(*low));
    for (size_t i = 0; i < channel_pixels(c); i++)
        if (counts(c, logarithmic, i, &bits) && bits >> 16 == upper)
            low[bits & (HALF - 1)]++;
    while (k >= low[lower])
        k -= low[lower++];
    bits = upper << 16 | lower;
    memcpy(&v, &bits, sizeof(v));
    return v;
}

/* All but the lowest and highest half percent of the numbers (on a logarithmic bar: of those above 0). */
static bool find_most(const noc_channel *c, bool logarithmic, double *least, double *most) {
    uint32_t *high = noc_calloc(2 * HALF, sizeof(*high)), bits;
    size_t n = 0;
    if (!high)
        return false;
    for (size_t i = 0; i < channel_pixels(c); i++)
        if (counts(c, logarithmic, i, &bits)) {
            high[bits >> 16]++;
            n++;
        }
    *least = n ? smallest(c, logarithmic, n / 200, high, high + HALF) : 1;
    *most = n ? smallest(c, logarithmic, n - 1 - n / 200, high, high + HALF) : 1;
    free(high);
    return true;
}

/* Are ends still those of numbers that reach from least to most? Those of a long logarithmic bar may be a tenth of it
 * off, which is no clear difference there. */
bool legend_holds(const noc_bar *last, bool logarithmic, double least, double most) {
    if (!last || last->logarithmic != logarithmic || !(last->high > last->low))
        return false;
    double slack = logarithmic ? fmax(1.25, pow(last->high / last->low, 0.1)) : 1.25;
    bool upper = most <= slack * last->high && most >= last->high / 3;
    return upper && (!logarithmic || (least >= last->low / slack && least <= 3 * slack * last->low));
}

/* Ends of the colour bar: what was asked for, those of the picture before, or round numbers around nearly all. */
static noc_status find_ends(const noc_channel *c, const noc_channel_params *p, colorbar *bar, noc_log *log) {
    bar->logarithmic = p->scale == NOC_BAR_OF_CHANNEL ? c->scale == NOC_CHANNEL_LOG : p->scale == NOC_BAR_LOG;
    bar->low = p->low;
    bar->high = p->high;
    if (bar->low != bar->high) {
        if (isfinite(bar->low) && isfinite(bar->high) && bar->low < bar->high && (bar->low > 0 || !bar->logarithmic))
            return NOC_OK;
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: a legend from %g to %g cannot be drawn: it must rise%s", c->name,
                         bar->low, bar->high, bar->logarithmic ? ", and begin above 0" : "");
    }
    double least, most;
    if (!find_most(c, bar->logarithmic, &least, &most))
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for the numbers of its legend", c->name);
    if (bar->line_count) {
        least = fmin(least, bar->lines[0]);
        most = fmax(most, bar->lines[bar->line_count - 1]);
    }
    if (legend_holds(p->last, bar->logarithmic, least, most)) {
        bar->low = p->last->low;
        bar->high = p->last->high;
        return NOC_OK;
    }
    bar->low = bar->logarithmic ? round_down(least) : 0;
    bar->high = most > 0 ? round_up(most) : 1;
    if (!(bar->high > bar->low))
        bar->high = 10 * bar->low;
    return NOC_OK;
}

static noc_status check_isolines(const noc_channel *c, const noc_channel_params *p, noc_log *log) {
    return isolines_good(&p->isolines)
               ? NOC_OK
               : noc_error(log, NOC_ERR_ARGUMENT, "%s: isolines are at most %d numbers above 0, rising", c->name,
                           NOC_ISOLINES);
}

static noc_status make_bar(legend *l, const noc_channel_params *p, noc_log *log) {
    colorbar *bar = &l->bar;
    noc_status status = check_isolines(l->channel, p, log);
    if (status)
        return status;
    bar->map = colormap_of(COLORMAP_SEQUENTIAL);
    bar->title = l->channel->title;
    bar->lines = l->lines;
    bar->line_count = (size_t)p->isolines.count;
    memcpy(l->lines, p->isolines.value, bar->line_count * sizeof(double));
    status = find_ends(l->channel, p, bar, log);
    if (!status && !p->isolines.count && p->isolines.round) {
        size_t n = colorbar_ticks(bar, l->lines, (size_t)NOC_MAX(p->isolines.round, 2));
        bool first = n && !(l->lines[0] > 0); /* nothing passes 0 */
        memmove(l->lines, l->lines + first, (n - first) * sizeof(double));
        bar->line_count = n - first;
    }
    return status;
}

noc_status noc_channel_bar(const noc_channel *channel, const noc_channel_params *params, noc_bar *bar, noc_log *log) {
    const noc_channel_params none = { 0 };
    legend l = { .channel = channel };
    if (!channel || !bar)
        return noc_null(log, __func__);
    *bar = (noc_bar){ 0 };
    if (!channel_has_bar(channel))
        return noc_error(log, NOC_ERR_ARGUMENT, "%s: has no colour bar", channel->name);
    noc_status status = make_bar(&l, params ? params : &none, log);
    if (status)
        return status;
    bar->low = l.bar.low;
    bar->high = l.bar.high;
    bar->logarithmic = l.bar.logarithmic;
    bar->tick_count = (int)colorbar_ticks(&l.bar, bar->ticks, NOC_BAR_TICKS);
    bar->isoline_count = (int)l.bar.line_count;
    memcpy(bar->isolines, l.lines, l.bar.line_count * sizeof(double));
    return NOC_OK;
}

void noc_bar_colour(double at, uint8_t rgb[3]) {
    if (rgb)
        memcpy(rgb, colormap_at(colormap_of(COLORMAP_SEQUENTIAL), at), 3);
}

/* ---- names ---- */

static uint32_t number_of(const noc_channel *c, size_t i) {
    return c->label_numbers ? c->label_numbers[i] : (uint32_t)i;
}

/* Place of a number among those with names; label_count: it has none. */
static size_t place_of(const noc_channel *c, uint32_t number) {
    if (!c->label_numbers)
        return NOC_MIN(number, c->label_count);
    size_t i = 0;
    while (i < c->label_count && c->label_numbers[i] != number)
        i++;
    return i;
}

/* A colour for a number that is a name: of many hues, neither dark nor grey. Those that have names of their own are
 * few: their hues lie a golden angle apart, with three lightnesses in turn, so that those of near hues differ in that.
 */
void noc_label_colour(const noc_channel *c, uint32_t label, uint8_t rgb[3]) {
    if (!rgb)
        return;
    if (c && channel_has_names(c) && c->label_colours && place_of(c, label) < c->label_count) {
        memcpy(rgb, c->label_colours[place_of(c, label)], 3);
        return;
    }
    if (c && channel_has_names(c) && !c->label_numbers && label < c->label_count) {
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

/* Names of the labels that a picture shows, in columns, and grey for none. In units of scale. */
enum { MARGIN = 6, GAP = 4, SWATCH = 9, LINE = SWATCH + GAP };

static bool find_names(legend *l, int width) {
    const noc_channel *c = l->channel;
    l->count = 1;
    l->column = text_width("none", l->scale);
    l->seen = noc_calloc(c->label_count, sizeof(*l->seen));
    if (!l->seen)
        return false;
    uint32_t last = UINT32_MAX;
    for (size_t i = 0; i < channel_pixels(c); i++) {
        uint32_t number = c->value[i] >= 0 ? (uint32_t)fminf(c->value[i], 4e9f) : last;
        size_t place = number == last ? c->label_count : place_of(c, last = number);
        if (place < c->label_count)
            l->seen[place] = true;
    }
    for (size_t i = 0; i < c->label_count; i++)
        if (l->seen[i]) {
            l->count++;
            l->column = NOC_MAX(l->column, text_width(c->labels[i], l->scale));
        }
    l->column += (SWATCH + 4 * GAP) * l->scale;
    l->columns = NOC_CLAMP((width - 2 * MARGIN * l->scale) / l->column, 1, l->count);
    return true;
}

static void draw_names(const legend *l, canvas *c, int y) {
    const noc_channel *channel = l->channel;
    int left = (c->width - l->columns * l->column) / 2, at = 0, scale = l->scale;
    y += MARGIN * scale;
    text_draw(c, (c->width - text_width(channel->title, scale)) / 2, y, channel->title, scale, ink);
    y += (TEXT_HEIGHT + GAP) * scale;
    for (size_t i = 0; i <= channel->label_count; i++) {
        bool last = i == channel->label_count;
        uint8_t rgb[3];
        if (!last && !l->seen[i])
            continue;
        if (last)
            memcpy(rgb, legend_none, 3);
        else
            noc_label_colour(channel, number_of(channel, i), rgb);
        int column = left + at % l->columns * l->column, row = y + at / l->columns * LINE * scale;
        canvas_fill(c, column, row, SWATCH * scale, SWATCH * scale, rgb);
        text_draw(c, column + (SWATCH + GAP) * scale, row + scale, last ? "none" : channel->labels[i], scale, ink);
        at++;
    }
}

/* ---- both ---- */

noc_status legend_make(legend *l, const noc_channel *c, const noc_channel_params *p, int width, noc_log *log) {
    *l = (legend){ .channel = c, .scale = NOC_MAX(c->width / 640, 1) };
    if (channel_has_bar(c))
        return make_bar(l, p, log);
    if (channel_has_names(c) && !find_names(l, NOC_MAX(width, colorbar_min_width(l->scale))))
        return noc_error(log, NOC_ERR_MEMORY, "%s: no memory for its legend", c->name);
    return NOC_OK;
}

void legend_free(legend *l) { free(l->seen); }

int legend_height(const legend *l) {
    int rows = l->columns ? (l->count + l->columns - 1) / l->columns : 0;
    return l->seen ? l->scale * (2 * MARGIN + TEXT_HEIGHT + GAP + rows * LINE) : colorbar_height(&l->bar, l->scale);
}

double legend_reach(const noc_channel *c) {
    float most = 0;
    if (c->components == 1 || !*c->unit)
        return 0;
    for (size_t i = 0; i < 3 * channel_pixels(c); i++)
        if (i % 3 < 2 && isfinite(c->value[i]))
            most = fmaxf(most, fabsf(c->value[i]));
    return most > 0 ? round_up(most) : 1;
}

/* Labels without names and vectors have no bar: what stands for a number that is none is said instead. */
void legend_draw(const legend *l, canvas *c, int y) {
    const noc_channel *channel = l->channel;
    int scale = l->scale, middle = y + (colorbar_height(NULL, scale) - TEXT_HEIGHT * scale) / 2;
    char grey[64] = "grey: none";
    double reach = legend_reach(channel);
    if (reach > 0)
        noc_snprintf(grey, sizeof(grey), "full colour: %g %s, grey: none", reach, channel->unit);
    if (channel_has_bar(channel)) {
        colorbar_draw(c, 0, y, c->width, scale, &l->bar);
    } else if (l->seen) {
        draw_names(l, c, y);
    } else {
        text_draw(c, (c->width - text_width(channel->title, scale)) / 2, middle - 8 * scale, channel->title, scale,
                  ink);
        text_draw(c, (c->width - text_width(grey, scale)) / 2, middle + 8 * scale, grey, scale, ink);
    }
}
