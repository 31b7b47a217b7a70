/* Error figures of a picture against a reference: docs/estimator.md, "Error figures". */
#include "image/internal.h"

#include <math.h>

/* Sums over a set of pixels. */
typedef struct sums {
    double x, r, squared, squared8;
    size_t pixels;
} sums;

/* One set: a choice of pixels (all, or those away from emitters), raw or clamped. */
typedef struct set {
    bool dark, clamped;
    sums sums;
    double relative; /* sum of (x - r)^2 / (r^2 + e^2), second pass */
    double unlit;    /* of pixels that are black in r alone */
    size_t unlit_pixels;
} set;

noc_status image_check_pair(const noc_image *x, const noc_image *r, noc_log *log) {
    if (x->width != r->width || x->height != r->height)
        return noc_error(log, NOC_ERR_ARGUMENT, "compare: the pictures differ in size: %d x %d and %d x %d", x->width,
                         x->height, r->width, r->height);
    for (int k = 0; k < 2; k++) {
        const noc_image *image = k ? r : x;
        if (image->smoothed)
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "compare: the %s is smoothed: it is for display, and for no figures",
                             k ? "reference" : "picture");
        size_t n = image_pixels(image), bad = 0, first = 0;
        for (size_t i = n; i-- > 0;)
            if (!image_finite(image->rgb + 3 * i)) {
                bad++;
                first = i;
            }
        if (bad)
            return noc_error(log, NOC_ERR_ARGUMENT,
                             "compare: %zu pixels of the %s are not finite, the first at %zu, %zu: there is "
                             "no error figure",
                             bad, k ? "reference" : "picture", first % (size_t)image->width,
                             first / (size_t)image->width);
    }
    return NOC_OK;
}

/* Scaled down to the ceiling's luminance: the hue stays. */
static void clamp_pixel(const float rgb[3], double ceiling, float out[3]) {
    double y = image_luminance(rgb), scale = y > ceiling ? ceiling / y : 1;
    for (int k = 0; k < 3; k++)
        out[k] = (float)(rgb[k] * scale);
}

static double squared8(const display_map *d, const float a[3], const float b[3]) {
    uint8_t p[3], q[3];
    display_pixel(d, a, p);
    display_pixel(d, b, q);
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (double)(p[k] - q[k]) * (p[k] - q[k]);
    return sum;
}

static void add_pixel(sums *s, const float x[3], const float r[3], double e8) {
    double yx = image_luminance(x), yr = image_luminance(r);
    s->x += yx;
    s->r += yr;
    s->squared += (yx - yr) * (yx - yr);
    s->squared8 += e8;
    s->pixels++;
}

static double ratio(double a, double b) { return b != 0 ? a / b : a == 0 ? 1 : copysign(HUGE_VAL, a); }

/* relMSE needs the mean first. Where picture and reference are both black a term is 0, whatever e is. */
static void add_relative(set *s, const float x[3], const float r[3], double e) {
    double yx = image_luminance(x), yr = image_luminance(r), d = (yx - yr) * (yx - yr);
    if (!(d > 0))
        return;
    s->relative += d / (yr * yr + e * e);
    if (yr == 0) {
        s->unlit += d / (e * e);
        s->unlit_pixels++;
    }
}

static noc_metrics metrics_of(const set *s) {
    if (s->sums.pixels == 0)
        return (noc_metrics){ 0 };
    double n = (double)s->sums.pixels;
    return (noc_metrics){ .rmse8 = sqrt(s->sums.squared8 / (3 * n)),
                          .rmse = sqrt(s->sums.squared / n),
                          .relmse = s->relative / n,
                          .bias = ratio(s->sums.x, s->sums.r),
                          .mean_x = s->sums.x / n,
                          .mean_r = s->sums.r / n,
                          .pixels = s->sums.pixels,
                          .unlit = s->unlit_pixels,
                          .relmse_unlit = s->unlit / n };
}

/* Calls for both passes: sums first (second = false), then relMSE with each set's own e. */
static void pass_over(const noc_image *x, const noc_image *r, double ceiling, const display_map *d, set sets[4],
                      bool second) {
    size_t n = image_pixels(x);
    double e[4];
    for (int k = 0; k < 4; k++)
        e[k] = sets[k].sums.pixels ? 0.01 * sets[k].sums.r / (double)sets[k].sums.pixels : 0;
    for (size_t i = 0; i < n; i++) {
        const float *px = x->rgb + 3 * i, *pr = r->rgb + 3 * i;
        float cx[3], cr[3];
        clamp_pixel(px, ceiling, cx);
        clamp_pixel(pr, ceiling, cr);
        bool emitter = r->emitter && r->emitter[i];
        double raw8 = second ? 0 : squared8(d, px, pr), clamped8 = second ? 0 : squared8(d, cx, cr);
        for (int k = 0; k < 4; k++) {
            if (sets[k].dark && emitter)
                continue;
            const float *a = sets[k].clamped ? cx : px, *b = sets[k].clamped ? cr : pr;
            if (second)
                add_relative(&sets[k], a, b, e[k]);
            else
                add_pixel(&sets[k].sums, a, b, sets[k].clamped ? clamped8 : raw8);
        }
    }
}

noc_status noc_image_compare(const noc_image *x, const noc_image *r, const noc_compare_params *params,
                             noc_comparison *out, noc_log *log) {
    if (!x || !r || !out)
        return noc_null(log, __func__);
    noc_compare_params p = params ? *params : noc_compare_default_params();
    if (!(p.ceiling > 0))
        return noc_error(log, NOC_ERR_ARGUMENT, "compare: the ceiling must be above 0 cd/m2, not %g", p.ceiling);
    noc_status status = image_check_pair(x, r, log);
    if (status != NOC_OK)
        return status;
    display_map d;
    double ev100;
    if (!display_ev100(r, &p.display, &ev100)) /* both as the reference is shown */
        return noc_no_memory(log, "compare");
    if (p.relative) { /* they have been displayed already */
        ev100 = -log2(IMAGE_SATURATION);
        p.display = (noc_display_params){ .tonemap = NOC_TONEMAP_LINEAR };
    }
    display_init(&d, &p.display, ev100);
    set sets[4] = { { .dark = false }, { .clamped = true }, { .dark = true }, { .dark = true, .clamped = true } };
    pass_over(x, r, p.ceiling, &d, sets, false);
    pass_over(x, r, p.ceiling, &d, sets, true);
    *out = (noc_comparison){ .all = metrics_of(&sets[0]),
                             .all_clamped = metrics_of(&sets[1]),
                             .dark = metrics_of(&sets[2]),
                             .dark_clamped = metrics_of(&sets[3]),
                             .ceiling = p.ceiling,
                             .ev100 = ev100,
                             .has_mask = r->emitter != NULL };
    return NOC_OK;
}
