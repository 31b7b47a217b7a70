/* The difference of two pictures, for people. */
#include "image/legend.h"

#include <math.h>

static int compare_double(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Nearest-rank percentile, 0 < p <= 1. Sorts v. */
static double percentile(double *v, size_t n, double p) {
    qsort(v, n, sizeof(*v), compare_double);
    size_t rank = (size_t)ceil(p * (double)n);
    return v[NOC_CLAMP(rank, 1, n) - 1];
}

static const noc_difference_params defaults = { 0 };

/* Where the colours end: the 99th percentile of |x - r|, or the largest where fewer pixels than that differ, or 1 cd/m2
 * where none does. The rare large differences beyond it saturate and do not fade the rest. */
static double scale_of(const noc_image *x, const noc_image *r, double *d, size_t n) {
    for (size_t i = 0; i < n; i++)
        d[i] = fabs(image_luminance(x->rgb + 3 * i) - image_luminance(r->rgb + 3 * i));
    double scale = percentile(d, n, 0.99);
    if (!(scale > 0))
        scale = d[n - 1];
    return scale > 1e-30 && isfinite(scale) ? scale : 1;
}

static noc_status find_bar(const noc_image *x, const noc_image *r, const noc_difference_params *p, noc_bar *bar,
                           noc_log *log) {
    noc_status status = image_check_pair(x, r, log);
    double limit = p->limit;
    if (status)
        return status;
    if (!(limit >= 0) || !isfinite(limit))
        return noc_error(log, NOC_ERR_ARGUMENT, "difference: a legend to %g cannot be drawn", limit);
    if (!(limit > 0)) {
        double *d = noc_alloc_large(image_pixels(x), sizeof(*d));
        if (!d)
            return noc_error(log, NOC_ERR_MEMORY, "difference: no memory for %d x %d pixels", x->width, x->height);
        limit = scale_of(x, r, d, image_pixels(x));
        free(d);
        if (legend_holds(p->last, false, -limit, limit))
            limit = p->last->high;
    }
    *bar = (noc_bar){ .low = -limit, .high = limit };
    return NOC_OK;
}

noc_status noc_image_difference_bar(const noc_image *x, const noc_image *r, const noc_difference_params *params,
                                    noc_bar *bar, noc_log *log) {
    if (!x || !r || !bar)
        return noc_null(log, __func__);
    noc_status status = find_bar(x, r, params ? params : &defaults, bar, log);
    if (!status)
        bar->tick_count =
            (int)colorbar_ticks(&(colorbar){ .low = bar->low, .high = bar->high }, bar->ticks, NOC_BAR_TICKS);
    return status;
}

void noc_difference_colour(double at, uint8_t rgb[3]) {
    if (rgb)
        memcpy(rgb, colormap_at(colormap_of(COLORMAP_DIVERGING), at), 3);
}

/* A picture narrower than its legend stands in the middle. */
static void paint(const noc_image *x, const noc_image *r, double limit, canvas *c) {
    size_t margin = (size_t)(c->width - x->width) / 2;
    for (size_t i = 0; i < image_pixels(x); i++) {
        double v = image_luminance(x->rgb + 3 * i) - image_luminance(r->rgb + 3 * i);
        size_t column = i % (size_t)x->width, row = i / (size_t)x->width;
        memcpy(c->rgb + 3 * (row * (size_t)c->width + margin + column),
               colormap_at(colormap_of(COLORMAP_DIVERGING), 0.5 + 0.5 * v / limit), 3);
    }
}

noc_status noc_image_difference(const noc_image *x, const noc_image *r, const noc_difference_params *params,
                                uint8_t **out, int *width, int *height, noc_log *log) {
    const noc_difference_params *p = params ? params : &defaults;
    noc_bar ends = { .low = 0 };
    if (!x || !r || !out || !width || !height)
        return noc_null(log, __func__);
    noc_status status = find_bar(x, r, p, &ends, log);
    if (status != NOC_OK)
        return status;
    int scale = NOC_MAX(x->width / 640, 1);
    bool picture = p->part != NOC_CHANNEL_LEGEND, below = p->part != NOC_CHANNEL_PICTURE;
    canvas c = { .width = below ? NOC_MAX(x->width, colorbar_min_width(scale)) : x->width,
                 .height = (picture ? x->height : 0) + (below ? colorbar_height(NULL, scale) : 0) };
    c.rgb = noc_alloc_large((size_t)c.width * (size_t)c.height, 3);
    if (!c.rgb)
        return noc_error(log, NOC_ERR_MEMORY, "difference: no memory for %d x %d pixels", c.width, c.height);
    canvas_fill(&c, 0, 0, c.width, c.height, legend_ground);
    if (picture)
        paint(x, r, ends.high, &c);
    char title[80];
    snprintf(title, sizeof(title), "picture - reference [%s]", p->unit ? p->unit : "cd/m\xb2");
    colorbar bar = { .map = colormap_of(COLORMAP_DIVERGING), .low = ends.low, .high = ends.high, .title = title };
    if (below)
        colorbar_draw(&c, 0, picture ? x->height : 0, c.width, scale, &bar);
    *out = c.rgb;
    *width = c.width;
    *height = c.height;
    return NOC_OK;
}
