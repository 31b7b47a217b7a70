/* Rasters of the ground: blocks of pixels on one lattice, whatever part of it is asked for. */
#include "measure/readings.h"

#include <math.h>
#include <nocturne/import.h>
#include <stdio.h>

#define MOST_PIXELS 1e8
#define MOST_COLUMN 1e9 /* pixels from the CRS's origin: their numbers are of 32 bits */

/* What the blocks of a raster are made with. */
typedef struct raster_work {
    measuring m;
    noc_raster_params params;
    noc_raster *raster;
    int32_t west, south; /* of the raster's first pixel, on the lattice */
    int32_t x, y;        /* of the block's first pixel */
    uint32_t seed;       /* that was asked for */
    uint32_t of[BLOCK_AREA];
    tally tallies[BLOCK_AREA];
    bool counts[BLOCK_AREA]; /* the pixel lies in the raster */
    double xyz[BLOCK_AREA][3], xy[BLOCK_AREA][2];
    noc_hit hits[BLOCK_AREA];
} raster_work;

/* ---- the lattice ---- */

static bool has_crs(const noc_scene *scene, const noc_raster_params *p) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    return p->crs || *info.given_crs;
}

static noc_status find_crs(raster_work *w) {
    const noc_scene *scene = w->m.view->scene;
    if (!has_crs(scene, &w->params))
        return NOC_OK;
    w->raster->wkt = noc_scene_crs_wkt(scene, w->params.crs);
    return w->raster->wkt ? NOC_OK : NOC_ERR_ARGUMENT;
}

/* The scene's bounds, from above, in the raster's CRS. */
static noc_status find_extent(const noc_scene *scene, const noc_raster_params *p, double extent[4]) {
    enum { ALONG = 5 };
    noc_scene_info info;
    double xyz[ALONG * ALONG][3];
    noc_scene_get_info(scene, &info);
    for (int i = 0; i < ALONG * ALONG; i++) {
        double s[2] = { i % ALONG / (ALONG - 1.0), i / ALONG / (ALONG - 1.0) };
        for (int k = 0; k < 2; k++)
            xyz[i][k] = info.bounds_min[k] + s[k] * (info.bounds_max[k] - info.bounds_min[k]);
        xyz[i][2] = info.bounds_min[2];
    }
    noc_status status =
        has_crs(scene, p) ? noc_scene_from_local_all(scene, p->crs, &xyz[0][0], (size_t)ALONG * ALONG) : NOC_OK;
    for (int k = 0; k < 4; k++)
        extent[k] = k < 2 ? INFINITY : -INFINITY;
    for (int i = 0; i < ALONG * ALONG; i++)
        for (int k = 0; k < 2; k++) {
            extent[k] = fmin(extent[k], xyz[i][k]);
            extent[2 + k] = fmax(extent[2 + k], xyz[i][k]);
        }
    return status;
}

static noc_status check(const noc_scene *scene, const noc_raster_params *p, double extent[4], noc_log *log) {
    if (!(p->step > 0 && p->step < 1e9))
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: a pixel of %g is none", p->step);
    if (!(fabs(p->height) < 1e4))
        return noc_error(log, NOC_ERR_ARGUMENT, "measure: %g m over the ground is not near it", p->height);
    bool all = p->extent[0] == 0 && p->extent[1] == 0 && p->extent[2] == 0 && p->extent[3] == 0;
    memcpy(extent, p->extent, 4 * sizeof(*extent));
    noc_status status = all ? find_extent(scene, p, extent) : NOC_OK;
    if (status != NOC_OK)
        return status;
    if (!(extent[0] < extent[2] && extent[1] < extent[3]))
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "measure: west %.10g, south %.10g, east %.10g, north %.10g is no extent", extent[0], extent[1],
                         extent[2], extent[3]);
    for (int k = 0; k < 4; k++)
        if (!(fabs(extent[k]) / p->step < MOST_COLUMN))
            return noc_error(log, NOC_ERR_ARGUMENT, "measure: %.10g lies too far out for pixels of %g", extent[k],
                             p->step);
    double pixels = ceil((extent[2] - extent[0]) / p->step) * ceil((extent[3] - extent[1]) / p->step);
    return pixels <= MOST_PIXELS
               ? NOC_OK
               : noc_error(log, NOC_ERR_ARGUMENT,
                           "measure: %.3g pixels of %g are more than %g: a smaller extent, or larger pixels", pixels,
                           p->step, MOST_PIXELS);
}

/* A multiple of step that is one but for rounding stays it. */
static int32_t lower(double x, double step) { return (int32_t)floor(x / step + 1e-6); }
static int32_t upper(double x, double step) { return (int32_t)ceil(x / step - 1e-6); }

static noc_status make_raster(raster_work *w, const double extent[4], noc_log *log) {
    const noc_raster_params *p = &w->params;
    w->west = lower(extent[0], p->step);
    w->south = lower(extent[1], p->step);
    int32_t east = NOC_MAX(upper(extent[2], p->step), w->west + 1);
    int32_t north = NOC_MAX(upper(extent[3], p->step), w->south + 1);
    noc_raster *r = w->raster = noc_calloc(1, sizeof(*r));
    if (!r)
        return noc_no_memory(log, "measure");
    r->width = east - w->west;
    r->height = north - w->south;
    r->west = w->west * p->step;
    r->north = north * p->step;
    r->step = p->step;
    size_t area = (size_t)r->width * (size_t)r->height;
    r->lux = noc_alloc_large(area, sizeof(float));
    r->error = noc_alloc_large(area, sizeof(float));
    r->share = noc_calloc(area, sizeof(float));
    if (!r->lux || !r->error || !r->share)
        return noc_error(log, NOC_ERR_MEMORY, "measure: no memory for a raster of %d x %d pixels", r->width, r->height);
    for (size_t i = 0; i < area; i++)
        r->lux[i] = r->error[i] = NAN;
    return NOC_OK;
}

static uint32_t ground_classes(const noc_scene *scene) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    for (int c = 0; c < NOC_CLASS_COUNT; c++)
        if (NOC_RASTER_GROUND >> c & 1 && info.triangles_by_class[c])
            return NOC_RASTER_GROUND;
    return 1u << NOC_CLASS_OTHER;
}

/* ---- a block ---- */

/* The ground at a place of each pixel, another one a frame: what is read is the pixel's mean. */
static noc_status place(void *user, uint32_t frame, noc_receiver *receivers, bool *some) {
    raster_work *w = user;
    const noc_scene *scene = w->m.view->scene;
    for (uint32_t i = 0; i < BLOCK_AREA; i++) {
        int32_t x = w->x + (int32_t)(i % BLOCK_PIXELS), y = w->y + BLOCK_PIXELS - 1 - (int32_t)(i / BLOCK_PIXELS);
        double at[2];
        spread_2d(mix(mix(w->seed, (uint32_t)x), (uint32_t)y), frame, at);
        w->xyz[i][0] = (x + at[0]) * w->params.step;
        w->xyz[i][1] = (y + at[1]) * w->params.step;
        w->xyz[i][2] = 0;
    }
    noc_status status =
        w->raster->wkt ? noc_scene_to_local_all(scene, w->params.crs, &w->xyz[0][0], BLOCK_AREA) : NOC_OK;
    for (int i = 0; i < BLOCK_AREA; i++)
        for (int k = 0; k < 2; k++) /* what has no place is looked for where there is nothing */
            w->xy[i][k] = fabs(w->xyz[i][k]) < 1e6 ? w->xyz[i][k] : 9e6;
    status = status ? status
                    : noc_view_cast_down(w->m.view, (const double(*)[2])w->xy, BLOCK_AREA, w->params.classes, w->hits);
    for (int i = 0; i < BLOCK_AREA && !status; i++) {
        const noc_hit *h = &w->hits[i];
        double p[3] = { h->place[0], h->place[1], h->place[2] + w->params.height };
        receivers[i] =
            h->hit ? meter_receiver(&w->m, p, (const double[3]){ 0, 0, 1 }) : (noc_receiver){ .material = NO_SURFACE };
        *some = *some || h->hit;
    }
    return status;
}

/* Where a pixel of the block lies in the raster; false: it does not. */
static bool lies_at(const raster_work *w, int i, size_t *at) {
    const noc_raster *r = w->raster;
    int32_t x = w->x + i % BLOCK_PIXELS - w->west, y = w->y + BLOCK_PIXELS - 1 - i / BLOCK_PIXELS - w->south;
    *at = (size_t)(r->height - 1 - y) * (size_t)r->width + (size_t)x;
    return x >= 0 && y >= 0 && x < r->width && y < r->height;
}

/* Few samples may miss what is rare, such as the sky's brightest draws: then the spread of a dark pixel is too small,
 * and its mean too low. So its error is at least that by the mean variance of neighbours in the block that are dark,
 * too. */
static double pooled_error(const raster_work *w, int i, double own) {
    enum { REACH = 3 };
    const double dark = 5 * w->m.params.least;
    int cx = i % BLOCK_PIXELS, cy = i / BLOCK_PIXELS;
    double variance = 0, count = 0;
    if (!w->tallies[i].samples || w->tallies[i].mean >= dark)
        return own;
    for (int y = NOC_MAX(cy - REACH, 0); y <= NOC_MIN(cy + REACH, BLOCK_PIXELS - 1); y++)
        for (int x = NOC_MAX(cx - REACH, 0); x <= NOC_MIN(cx + REACH, BLOCK_PIXELS - 1); x++) {
            const tally *t = &w->tallies[y * BLOCK_PIXELS + x];
            if (t->samples < 2 || t->mean >= dark)
                continue;
            variance += t->squares / (t->samples - 1.0);
            count++;
        }
    return count > 0 ? fmax(own, sqrt(variance / count / w->tallies[i].samples)) : own;
}

static noc_status keep(raster_work *w, uint32_t frames) {
    noc_raster *r = w->raster;
    noc_status status = NOC_OK;
    for (int i = 0; i < BLOCK_AREA && !status; i++) {
        size_t at;
        if (!lies_at(w, i, &at))
            continue;
        noc_reading of = reading_of(&w->tallies[i], frames);
        of.error = pooled_error(w, i, of.error);
        r->lux[at] = (float)of.lux;
        r->error[at] = (float)of.error;
        r->share[at] = (float)of.share;
        status = note_reading(&w->m, &of);
    }
    return status;
}

static noc_status measure_one(raster_work *w, int32_t bx, int32_t by) {
    block b = { .width = BLOCK_PIXELS,
                .height = BLOCK_PIXELS,
                .seed = mix(mix(w->seed, (uint32_t)bx), (uint32_t)by),
                .of = w->of,
                .counts = w->counts,
                .count = BLOCK_AREA,
                .tallies = w->tallies,
                .place = place,
                .user = w };
    w->x = bx * BLOCK_PIXELS;
    w->y = by * BLOCK_PIXELS;
    for (int i = 0; i < BLOCK_AREA; i++) {
        size_t at;
        w->counts[i] = lies_at(w, i, &at);
    }
    noc_status status = measure_block(&w->m, &b);
    return status ? status : keep(w, b.frames);
}

static int32_t block_of(int32_t pixel) {
    return pixel >= 0 ? pixel / BLOCK_PIXELS : -((-pixel + BLOCK_PIXELS - 1) / BLOCK_PIXELS);
}

static noc_status measure_all(raster_work *w) {
    int32_t x0 = block_of(w->west), x1 = block_of(w->west + w->raster->width - 1);
    int32_t y0 = block_of(w->south), y1 = block_of(w->south + w->raster->height - 1);
    double blocks = (x1 - x0 + 1.0) * (y1 - y0 + 1.0), done = 0;
    noc_status status = NOC_OK;
    for (int32_t y = y1; y >= y0 && !status; y--)
        for (int32_t x = x0; x <= x1 && !status; x++, done++) {
            w->m.from = done / blocks;
            w->m.to = (done + 1) / blocks;
            status = measure_one(w, x, y);
        }
    return status;
}

noc_raster *noc_measure_raster(noc_view *view, const noc_raster_params *raster, const noc_measure_params *params,
                               const noc_progress *progress, noc_measure_info *info) {
    if (!view) {
        noc_null(NULL, __func__);
        return NULL;
    }
    raster_work *w = noc_calloc(1, sizeof(*w));
    if (!w) {
        noc_no_memory(view->log, "measure");
        return NULL;
    }
    double extent[4];
    w->params = raster ? *raster : noc_raster_default_params();
    if (!w->params.classes)
        w->params.classes = ground_classes(view->scene);
    for (uint32_t i = 0; i < BLOCK_AREA; i++)
        w->of[i] = i;
    noc_status status = measuring_begin(&w->m, view, params, progress);
    status = status ? status : check(view->scene, &w->params, extent, view->log);
    status = status ? status : make_raster(w, extent, view->log);
    w->seed = w->m.render.seed;
    status = status ? status : find_crs(w);
    status = status ? status : measure_all(w);
    measuring_end(&w->m, info);
    noc_raster *made = w->raster;
    if (status) {
        noc_raster_destroy(made);
        made = NULL;
    }
    free(w);
    return made;
}

void noc_raster_destroy(noc_raster *r) {
    if (!r)
        return;
    free(r->lux);
    free(r->error);
    free(r->share);
    free(r->wkt);
    free(r);
}
