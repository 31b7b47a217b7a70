/* Exposure and tone mapping: how a picture in cd/m2 is shown. None of this enters a measurement except RMSE-8. */
#include "image/internal.h"

#include <nocturne/luminaire.h>

#include <math.h>

/* Automatic exposure
 *
 * A picture of a night is mostly dark, with pools of light and a few emitters a thousand times brighter than what they
 * light. What lamps light decides; what only the sky lights stays dark, however much of the picture it covers. So:
 *   1. Luminance is averaged over a grid of at most METER_CELLS a side, which takes the noise out of few samples.
 * Pixels of the emitter mask do not count, unless nothing else is lit. Of a picture without a mask the brightest
 *      METER_TRIM of the lit cells are left out: emitters, glare.
 *   2. The lit cells are ranked. The one that METER_BRIGHT of them stay under is shown at METER_BRIGHT_AT of white, as
 * far as a street is lit, that is the lit road: a stop over mid-grey, as photographers have it (docs/defaults.md).
 *   3. Seen from afar, lamps light a hundredth of a picture, and rank METER_BRIGHT lies in the dark between them. The
 * cell at METER_PEAK, then the middle of a lamp's pool, is never shown above METER_PEAK_AT of white: the tone map takes
 * that just before it burns. This is the floor of the exposure. Ranks scale with the picture: 2^k times the light is k
 * more EV. Without any light the answer is METER_BLACK. */
#define METER_CELLS 256
#define METER_TRIM 0.08
#define METER_BRIGHT 0.95
#define METER_BRIGHT_AT 0.27
#define METER_PEAK 0.9995
#define METER_PEAK_AT 3.5
#define METER_BLACK 3.0

static int compare_float(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Mean luminance of the lit cells, unsorted; returns their number. */
static size_t meter_cells(const noc_image *image, bool use_mask, float *cells) {
    int side = (NOC_MAX(image->width, image->height) + METER_CELLS - 1) / METER_CELLS;
    size_t lit = 0;
    for (int y0 = 0; y0 < image->height; y0 += side)
        for (int x0 = 0; x0 < image->width; x0 += side) {
            double sum = 0;
            size_t count = 0;
            for (int y = y0; y < NOC_MIN(y0 + side, image->height); y++)
                for (int x = x0; x < NOC_MIN(x0 + side, image->width); x++) {
                    size_t i = (size_t)y * (size_t)image->width + (size_t)x;
                    if ((use_mask && image->emitter[i]) || !image_finite(image->rgb + 3 * i))
                        continue;
                    sum += NOC_MAX(image_luminance(image->rgb + 3 * i), 0);
                    count++;
                }
            if (sum > 0 && sum < HUGE_VAL)
                cells[lit++] = (float)(sum / (double)count);
        }
    return lit;
}

/* Of n sorted cells the one at a rank between 0 and 1, between two by interpolation. */
static double cell_at(const float *cells, size_t n, double rank) {
    double at = rank * (double)(n - 1);
    size_t i = (size_t)at, next = NOC_MIN(i + 1, n - 1);
    return cells[i] + (at - (double)i) * ((double)cells[next] - cells[i]);
}

double noc_image_auto_ev100(const noc_image *image) {
    if (!image)
        return METER_BLACK;
    float *cells = noc_alloc(METER_CELLS * METER_CELLS * sizeof(float));
    if (!cells)
        return NAN;
    size_t lit = meter_cells(image, image->emitter != NULL, cells);
    bool masked = image->emitter && lit;
    if (!lit && image->emitter)
        lit = meter_cells(image, false, cells);
    qsort(cells, lit, sizeof(float), compare_float);
    if (!masked)
        lit -= (size_t)(METER_TRIM * (double)lit);
    double white = 0;
    if (lit)
        white = NOC_MAX(cell_at(cells, lit, METER_BRIGHT) / METER_BRIGHT_AT,
                        cell_at(cells, lit, METER_PEAK) / METER_PEAK_AT);
    free(cells);
    return white > 0 ? log2(white / IMAGE_SATURATION) : METER_BLACK;
}

bool display_ev100(const noc_image *image, const noc_display_params *params, double *ev100) {
    noc_display_params p = params ? *params : noc_display_default_params();
    double metered = p.auto_exposure ? noc_image_auto_ev100(image) : 0;
    double ev = p.auto_exposure ? metered - p.compensation : p.ev100;
    *ev100 = isfinite(ev) ? NOC_CLAMP(ev, -100.0, 100.0) : METER_BLACK;
    return !isnan(metered);
}

const char *tonemap_name(noc_tonemap tonemap) {
    switch (tonemap) {
    case NOC_TONEMAP_FILMIC: return "filmic";
    case NOC_TONEMAP_REINHARD: return "reinhard";
    case NOC_TONEMAP_LINEAR: return "linear";
    }
    return "linear";
}

/* The filmic curve is (a x^2 + b x) / (c x^2 + d x + 1), with b the slope of its toe (0.7: blacks gently deepened) and
 * a, c, d solved from three conditions: mid-grey 0.18 stays where it is, the contrast there is 1.05 (slope in log-log),
 * and white is reached at 16, 6.5 stops above mid-grey. a d > b c and a, b > 0, so it rises everywhere. */
#define FILMIC_A 6.553
#define FILMIC_B 0.7
#define FILMIC_C 6.359
#define FILMIC_D 3.742

double tonemap_curve(noc_tonemap tonemap, double x) {
    switch (tonemap) {
    case NOC_TONEMAP_FILMIC: {
        if (x > 1e6) /* where x^2 means nothing more */
            return 1;
        double y = x * (FILMIC_A * x + FILMIC_B) / (x * (FILMIC_C * x + FILMIC_D) + 1);
        return NOC_MIN(y, 1);
    }
    case NOC_TONEMAP_REINHARD: return x > 1e9 ? 1 : x / (1 + x);
    case NOC_TONEMAP_LINEAR: break;
    }
    return NOC_MIN(x, 1);
}

/* Colder black bodies have no blue in Rec.709, by which the channel would be divided. */
double display_white(const noc_display_params *params) {
    return params && params->white_kelvin > 0 ? NOC_CLAMP(params->white_kelvin, 2500, 15000) : DISPLAY_WHITE;
}

/* White balance scales the channels, as cameras do (von Kries' rule with the screen's primaries). Luminance 1 of the
 * white that is asked for becomes luminance 1 of the screen's. */
void display_init(display_map *d, const noc_display_params *params, double ev100) {
    float from[3], to[3];
    noc_kelvin_rgb(display_white(params), from);
    noc_kelvin_rgb(DISPLAY_WHITE, to);
    d->tonemap = params ? params->tonemap : NOC_TONEMAP_FILMIC;
    for (int k = 0; k < 3; k++)
        d->scale[k] = exp2(-ev100) / IMAGE_SATURATION * ((double)to[k] / (double)from[k]);
    srgb8_table_init(&d->srgb);
}

/* Exposed value at which a quarter of the chroma has gone: warm windows and pools stay warm, lamps themselves turn
 * white. */
#define DESATURATION 6.0
/* But tail lamps stay red: a colour whose luminance is less than PURE of a grey's with the same peak keeps all but
 * PURE_WHITE of its chroma, one of MIXED or more may lose it all. Red is at .21 and blue at .07, a black body of 2000
 * K, sodium, at .41. */
#define PURE 0.22
#define MIXED 0.38
#define PURE_WHITE 0.06

static double most_white(const double v[3], double peak) {
    double luminance = (0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]) / peak;
    double t = NOC_CLAMP((luminance - PURE) / (MIXED - PURE), 0, 1);
    return PURE_WHITE + (1 - PURE_WHITE) * t * t * (3 - 2 * t);
}

/* The curve is applied to the largest component, and the others keep their ratio to it, so hue holds (a curve a channel
 * turns sodium lamps lemon). Film and eyes see a strong coloured light as white: the colour is mixed with white of the
 * same peak by (p / (p + DESATURATION))^2, nothing at mid-grey, a quarter at p = DESATURATION, and nearly all of it far
 * above; a pure colour keeps most of it. Both factors rise with exposure, so every channel does. The linear tone map
 * shows what is there, clipped. */
static void display_linear(const display_map *d, const float rgb[3], double v[3]) {
    double peak = 0;
    bool finite = image_finite(rgb);
    for (int k = 0; k < 3; k++) {
        v[k] = finite ? NOC_MAX(rgb[k] * d->scale[k], 0) : 0;
        peak = NOC_MAX(peak, v[k]);
    }
    if (d->tonemap == NOC_TONEMAP_LINEAR || !(peak > 0))
        return;
    double level = tonemap_curve(d->tonemap, peak);
    double white = peak / (peak + DESATURATION);
    white = (peak > 1e9 ? 1 : white * white) * most_white(v, peak);
    for (int k = 0; k < 3; k++) {
        double ratio = v[k] / peak;
        v[k] = level * (ratio + (1 - ratio) * white);
    }
}

void display_pixel(const display_map *d, const float rgb[3], uint8_t out[3]) {
    double v[3];
    display_linear(d, rgb, v);
    for (int k = 0; k < 3; k++)
        out[k] = srgb8_encode(&d->srgb, (float)v[k]);
}

/* How far the emitter in pixel i is an area, not a point: the square of the largest share that one covers within a
 * pixel. A lamp that fills no pixel is a point whose glare is its brightness: a mean after the curve would put it out.
 */
static double area_of_emitter(const noc_image *image, size_t i) {
    int x = (int)(i % (size_t)image->width), y = (int)(i / (size_t)image->width);
    float most = 0;
    for (int v = NOC_MAX(y - 1, 0); v <= NOC_MIN(y + 1, image->height - 1); v++)
        for (int u = NOC_MAX(x - 1, 0); u <= NOC_MIN(x + 1, image->width - 1); u++)
            most = fmaxf(most, image->coverage[4 * ((size_t)v * (size_t)image->width + (size_t)u) + 3]);
    return (double)most * most;
}

/* A pixel that an emitter covers in part: both parts go through the curve, and are then mixed. */
static void display_covered(const display_map *d, const noc_image *image, size_t i, uint8_t out[3]) {
    const float *rgb = image->rgb + 3 * i, *emitted = image->coverage + 4 * i;
    float share = emitted[3], on[3], off[3];
    double area = area_of_emitter(image, i), mean[3], v[3], w[3];
    for (int k = 0; k < 3; k++) {
        on[k] = emitted[k] / share;
        off[k] = (rgb[k] - emitted[k]) / (1 - share);
    }
    display_linear(d, rgb, mean);
    display_linear(d, on, v);
    display_linear(d, off, w);
    for (int k = 0; k < 3; k++) {
        double mixed = share * NOC_MIN(v[k], 1) + (1 - share) * NOC_MIN(w[k], 1);
        out[k] = srgb8_encode(&d->srgb, (float)(area * mixed + (1 - area) * NOC_MIN(mean[k], 1)));
    }
}

noc_status noc_image_to_srgb8(const noc_image *image, const noc_display_params *params, uint8_t *out) {
    if (!image || !out)
        return NOC_ERR_ARGUMENT;
    const noc_display_params defaults = noc_display_default_params();
    params = params ? params : &defaults;
    display_map d;
    double ev100;
    if (!display_ev100(image, params, &ev100))
        return NOC_ERR_MEMORY;
    display_init(&d, params, ev100);
    size_t n = image_pixels(image);
    for (size_t i = 0; i < n; i++) {
        float share = image->coverage ? image->coverage[4 * i + 3] : 0;
        if (share > 0 && share < 1)
            display_covered(&d, image, i, out + 3 * i);
        else
            display_pixel(&d, image->rgb + 3 * i, out + 3 * i);
    }
    return NOC_OK;
}
