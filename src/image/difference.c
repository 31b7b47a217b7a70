/* The difference of two pictures, for people. */
#include "image/colormap.h"
#include "image/internal.h"

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

noc_status noc_image_difference(const noc_image *x, const noc_image *r, const char *unit, uint8_t **out, int *width,
                                int *height, noc_log *log) {
    if (!x || !r || !out || !width || !height)
        return noc_null(log, __func__);
    noc_status status = image_check_pair(x, r, log);
    if (status != NOC_OK)
        return status;
    size_t n = image_pixels(x);
    int scale = NOC_MAX(x->width / 640, 1);
    canvas c = { .width = NOC_MAX(x->width, colorbar_min_width(scale)), .height = x->height + colorbar_height(scale) };
    double *d = noc_alloc_large(n, sizeof(*d));
    c.rgb = noc_alloc(3 * (size_t)c.width * (size_t)c.height);
    if (!d || !c.rgb) {
        free(d);
        free(c.rgb);
        return noc_error(log, NOC_ERR_MEMORY, "difference: no memory for %d x %d pixels", c.width, c.height);
    }
    double limit = scale_of(x, r, d, n);
    free(d);
    colormap map;
    colormap_init(&map, COLORMAP_DIVERGING);
    canvas_fill(&c, 0, 0, c.width, c.height, (const uint8_t[3]){ 24, 24, 28 });
    size_t margin = (size_t)(c.width - x->width) / 2; /* a picture narrower than its legend stands in the middle */
    for (size_t i = 0; i < n; i++) {
        double v = image_luminance(x->rgb + 3 * i) - image_luminance(r->rgb + 3 * i);
        size_t column = i % (size_t)x->width, row = i / (size_t)x->width;
        memcpy(c.rgb + 3 * (row * (size_t)c.width + margin + column), colormap_at(&map, 0.5 + 0.5 * v / limit), 3);
    }
    char title[80];
    snprintf(title, sizeof(title), "picture - reference [%s]", unit ? unit : "cd/m\xb2");
    colorbar bar = { .map = &map, .low = -limit, .high = limit, .title = title };
    colorbar_draw(&c, 0, x->height, c.width, scale, &bar);
    *out = c.rgb;
    *width = c.width;
    *height = c.height;
    return NOC_OK;
}
