/* Colour maps along curves in Oklab (Ottosson 2020), where distance is close to what eyes see. */
#include "image/colormap.h"
#include "image/internal.h"

#include <math.h>
#include <pthread.h>

typedef struct lab {
    double l, a, b;
} lab;

/* Oklab to linear sRGB, by its definition. */
static void lab_to_linear(lab c, double rgb[3]) {
    double l = c.l + 0.3963377774 * c.a + 0.2158037573 * c.b;
    double m = c.l - 0.1055613458 * c.a - 0.0638541728 * c.b;
    double s = c.l - 0.0894841775 * c.a - 1.2914855480 * c.b;
    l *= l * l;
    m *= m * m;
    s *= s * s;
    rgb[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
    rgb[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
    rgb[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
}

static lab polar(double l, double chroma, double degrees) {
    double h = degrees * M_PI / 180;
    return (lab){ l, chroma * cos(h), chroma * sin(h) };
}

/* Chosen so that both lines stay inside the sRGB gamut with the strongest ends. */
static lab diverging(double t) {
    double s = fabs(2 * t - 1);
    return polar(0.96 - 0.48 * s, 0.19 * s, t < 0.5 ? 260 : 28);
}

/* Hue runs from 280 degrees (indigo) over 0 (crimson) to 105 (yellow), chroma is largest in the middle, within the
 * gamut. */
static lab sequential(double t) { return polar(0.14 + 0.82 * t, 0.03 + 0.47 * t * (1 - t) + 0.05 * t, -80 + 185 * t); }

static double distance(lab p, lab q) {
    return sqrt((p.l - q.l) * (p.l - q.l) + (p.a - q.a) * (p.a - q.a) + (p.b - q.b) * (p.b - q.b));
}

/* Walks the curve in small steps and takes a colour at equal lengths. */
static void walk(lab (*curve)(double), lab out[COLORMAP_SIZE]) {
    enum { STEPS = 1 << 14 };
    double total = 0;
    for (int i = 0; i < STEPS; i++)
        total += distance(curve((double)i / STEPS), curve((i + 1.0) / STEPS));
    double length = 0;
    int next = 0;
    for (int i = 0; i < STEPS; i++) {
        double step = distance(curve((double)i / STEPS), curve((i + 1.0) / STEPS));
        for (double at; next < COLORMAP_SIZE && (at = total * next / (COLORMAP_SIZE - 1)) <= length + step; next++)
            out[next] = curve((i + (at - length) / step) / STEPS);
        length += step;
    }
    while (next < COLORMAP_SIZE) /* rounding may leave out the last */
        out[next++] = curve(1);
}

void colormap_init(colormap *map, colormap_kind kind) {
    lab points[COLORMAP_SIZE];
    walk(kind == COLORMAP_DIVERGING ? diverging : sequential, points);
    srgb8_table table;
    srgb8_table_init(&table);
    for (int i = 0; i < COLORMAP_SIZE; i++) {
        double rgb[3];
        lab_to_linear(points[i], rgb);
        for (int k = 0; k < 3; k++)
            map->rgb[i][k] = srgb8_encode(&table, (float)rgb[k]);
    }
}

static colormap maps[2];
static void make_maps(void) {
    colormap_init(&maps[COLORMAP_DIVERGING], COLORMAP_DIVERGING);
    colormap_init(&maps[COLORMAP_SEQUENTIAL], COLORMAP_SEQUENTIAL);
}

const colormap *colormap_of(colormap_kind kind) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, make_maps);
    return &maps[kind];
}

void colormap_polar(double lightness, double chroma, double hue, uint8_t out[3]) {
    double rgb[3];
    lab_to_linear(polar(lightness, chroma, hue * 180 / M_PI), rgb);
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)(255 * srgb_encode(NOC_CLAMP(rgb[k], 0.0, 1.0)) + 0.5);
}

const uint8_t *colormap_at(const colormap *map, double t) {
    if (!(t > 0))
        return map->rgb[0];
    return map->rgb[t < 1 ? (int)(t * (COLORMAP_SIZE - 1) + 0.5) : COLORMAP_SIZE - 1];
}

void canvas_fill(canvas *c, int x, int y, int width, int height, const uint8_t rgb[3]) {
    int x1 = NOC_MIN(x + width, c->width), y1 = NOC_MIN(y + height, c->height);
    for (int j = NOC_MAX(y, 0); j < y1; j++)
        for (int i = NOC_MAX(x, 0); i < x1; i++)
            memcpy(c->rgb + 3 * ((size_t)j * (size_t)c->width + (size_t)i), rgb, 3);
}

/* Layout in units of scale. */
enum { MARGIN = 6, GAP = 3, BAR = 10, TICK = 3, MIN_WIDTH = 260, TICKS = 16 };

/* Numbers of lines have a second row for those that would touch others. */
static int rows_of(const colorbar *bar) { return bar && bar->line_count ? 2 : 1; }

int colorbar_height(const colorbar *bar, int scale) {
    return scale * (MARGIN + TEXT_HEIGHT + GAP + BAR + TICK + rows_of(bar) * (GAP + TEXT_HEIGHT) + MARGIN);
}
int colorbar_min_width(int scale) { return scale * MIN_WIDTH; }

/* Linear: the smallest of 1, 2, 5 times 10^k that gives at most max ticks. */
static size_t linear_ticks(double low, double high, double *ticks, size_t max) {
    static const double steps[] = { 1, 2, 5, 10 };
    double range = high - low, power = pow(10, floor(log10(range / (double)max))), step = 0;
    for (size_t i = 0; i < NOC_COUNT(steps); i++) {
        step = steps[i] * power;
        if (floor(high / step + 1e-9) - ceil(low / step - 1e-9) + 1 <= (double)max)
            break;
    }
    size_t n = 0;
    for (double k = ceil(low / step - 1e-9); k * step <= high + 1e-9 * range && n < max; k++)
        ticks[n++] = k * step + 0.0; /* no -0 */
    return n;
}

/* Logarithmic: 1, 2, 5 of every decade where there is room, else 1 of every n-th decade. */
static size_t log_ticks(double low, double high, double *ticks, size_t max) {
    static const double steps[] = { 1, 2, 5 };
    int first = (int)floor(log10(low)), last = (int)floor(log10(high) + 1e-9);
    double decades = log10(high) - log10(low); /* their quotient need not be a number */
    size_t n = 0;
    bool fine = 3 * decades + 1 <= (double)max;
    int stride = fine ? 1 : (int)ceil((decades + 1) / (double)max);
    for (int k = first; k <= last; k += stride)
        for (size_t i = 0; i < (fine ? NOC_COUNT(steps) : 1) && n < max; i++) {
            double v = steps[i] * pow(10, k);
            if (v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9))
                ticks[n++] = v;
        }
    return n;
}

size_t colorbar_ticks(const colorbar *bar, double *ticks, size_t max) {
    if (max < 2 || !(bar->high > bar->low) || !isfinite(bar->high - bar->low) || (bar->logarithmic && !(bar->low > 0)))
        return 0;
    return bar->logarithmic ? log_ticks(bar->low, bar->high, ticks, max)
                            : linear_ticks(bar->low, bar->high, ticks, max);
}

double colorbar_position(const colorbar *bar, double v) {
    return bar->logarithmic ? log(v / bar->low) / log(bar->high / bar->low) : (v - bar->low) / (bar->high - bar->low);
}

const uint8_t *colormap_ink(const uint8_t on[3]) {
    static const uint8_t light[3] = { 236, 246, 255 }, dark[3] = { 10, 14, 34 };
    return 3 * on[0] + 6 * on[1] + on[2] > 10 * 150 ? dark : light;
}

static const uint8_t ground[3] = { 24, 24, 28 }, ink[3] = { 224, 224, 224 };

/* Where numbers of a row stand, in pixels. */
enum { MOST_NUMBERS = NOC_ISOLINES + 2 };
typedef struct row {
    int from[MOST_NUMBERS], to[MOST_NUMBERS], count;
} row;

/* Takes a place in the row, unless it would touch another. */
static bool takes(row *r, int from, int to) {
    for (int i = 0; i < r->count; i++)
        if (from < r->to[i] && to > r->from[i])
            return false;
    r->from[r->count] = from;
    r->to[r->count++] = to;
    return true;
}

/* Values with a tick each, and those that have room with their number: the ends of a bar with lines come first. */
static size_t list_numbers(const colorbar *bar, int length, int scale, double *values) {
    if (!bar->line_count)
        return colorbar_ticks(bar, values, (size_t)NOC_CLAMP(length / (40 * scale), 2, TICKS));
    size_t n = 0;
    values[n++] = bar->low;
    values[n++] = bar->high;
    for (size_t i = 0; i < bar->line_count && n < MOST_NUMBERS; i++)
        if (bar->lines[i] > bar->low && bar->lines[i] < bar->high)
            values[n++] = bar->lines[i];
    return n;
}

/* Numbers under a bar whose upper left corner that is. */
static void draw_numbers(canvas *c, int left, int y, int length, int scale, const colorbar *bar) {
    double values[MOST_NUMBERS];
    size_t n = list_numbers(bar, length, scale, values);
    row rows[2] = { { .count = 0 }, { .count = 0 } };
    for (size_t i = 0; i < n; i++) {
        char text[32];
        noc_snprintf(text, sizeof(text), "%.6g", values[i]);
        double share = colorbar_position(bar, values[i]);
        int at = left + (int)(share * (length - 1) + 0.5), width = text_width(text, scale);
        int from = at + scale / 2 - width / 2;
        canvas_fill(c, at - scale / 2, y, scale, TICK * scale, ink);
        if (bar->line_count && i > 1)
            canvas_fill(c, at - scale / 2, y - BAR * scale, scale, BAR * scale,
                        colormap_ink(colormap_at(bar->map, share)));
        for (int k = 0; k < rows_of(bar); k++)
            if (takes(&rows[k], from, from + width + 4 * scale)) {
                text_draw(c, from, y + (TICK + GAP + k * (TEXT_HEIGHT + GAP)) * scale, text, scale, ink);
                break;
            }
    }
}

void colorbar_draw(canvas *c, int x, int y, int width, int scale, const colorbar *bar) {
    canvas_fill(c, x, y, width, colorbar_height(bar, scale), ground);
    /* room for half a number at either end */
    int side = 24 * scale, left = x + side, length = NOC_MAX(width - 2 * side, 1);
    y += MARGIN * scale;
    text_draw(c, x + (width - text_width(bar->title, scale)) / 2, y, bar->title, scale, ink);
    y += (TEXT_HEIGHT + GAP) * scale;
    for (int i = 0; i < length; i++)
        canvas_fill(c, left + i, y, 1, BAR * scale, colormap_at(bar->map, (i + 0.5) / length));
    draw_numbers(c, left, y + BAR * scale, length, scale, bar);
}
