/* A smoothed still: its planes, and the order of its kernels over the rows of the picture. */
#include "render/still.h"

#include <math.h>
#include <string.h>

#define BIT(aov) (1u << NOC_AOV_##aov)

static bool has_lists(const noc_render_params *p) {
    return (p->method == NOC_METHOD_RIS || p->method == NOC_METHOD_RESTIR) && p->candidates == NOC_CANDIDATES_LISTS;
}

uint32_t noc_still_aovs(const noc_render_params *params) {
    const noc_render_params defaults = noc_render_default_params();
    const noc_render_params *p = params ? params : &defaults;
    if (p->method == NOC_METHOD_HEADLIGHT)
        return 0;
    return BIT(ILLUMINANCE) | BIT(NORMAL) | (has_lists(p) ? BIT(EXPECTED) : 0) | (p->accumulate ? BIT(VARIANCE) : 0);
}

/* Planes of floats that the kernels write to, and those of the frame. */
enum { PLANES = 8, FRAME_PLANES = 11 };

typedef struct still {
    noc_view *view;
    noc_image *image;
    noc_channel *illuminance, *expected, *variance;
    float *planes, *frame;
    still_step step;
} still;

static noc_status check(const noc_view *v) {
    const noc_render_params *p = &v->history.params;
    if (!v->width || !v->history.accumulated || !v->last.there)
        return noc_error(v->log, NOC_ERR_ARGUMENT, "still: the view has no frame, or the last one was dropped");
    uint32_t needed = noc_still_aovs(p);
    if (!needed)
        return noc_error(v->log, NOC_ERR_ARGUMENT, "still: the headlight method has no noise to be smoothed");
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (needed & ~p->aovs & 1u << aov)
            return noc_error(v->log, NOC_ERR_ARGUMENT,
                             "still: the view's frames have no \"%s\": their aovs lack noc_still_aovs",
                             noc_aov_name((noc_aov)aov));
    return NOC_OK;
}

/* Rays of a pixel in all frames. */
static int rays_of(const noc_view *v) {
    const noc_render_params *p = &v->history.params;
    int frame = has_lists(p) ? p->shadow_rays : p->method == NOC_METHOD_REFERENCE ? p->rays : 1;
    return (int)fmin((double)frame * (double)v->history.accumulated, 1 << 20);
}

static noc_status take(still *s) {
    noc_view *v = s->view;
    uint32_t aovs = v->history.params.aovs;
    size_t n = (size_t)v->width * (size_t)v->height;
    s->image = noc_view_image(v);
    s->illuminance = s->image ? noc_view_aov(v, NOC_AOV_ILLUMINANCE) : NULL;
    if (!s->illuminance)
        return NOC_ERR_MEMORY; /* or the device's loss, which is reported */
    s->expected = aovs & BIT(EXPECTED) ? noc_view_aov(v, NOC_AOV_EXPECTED) : NULL;
    s->variance = aovs & BIT(VARIANCE) ? noc_view_aov(v, NOC_AOV_VARIANCE) : NULL;
    s->planes = noc_alloc_large(n, PLANES * sizeof(float));
    s->frame = noc_alloc_large(n, FRAME_PLANES * sizeof(float));
    if (!s->planes || !s->frame)
        return noc_error(v->log, NOC_ERR_MEMORY, "still: no memory for a picture of %d x %d", v->width, v->height);
    return NOC_OK;
}

/* The last frame's surfaces; a pixel that saw an emitter in any frame is one. */
static void look(still *s) {
    noc_view *v = s->view;
    size_t n = (size_t)v->width * (size_t)v->height;
    float *f = s->frame, *p = s->planes;
    uint32_t *what = (uint32_t *)(f + 10 * n);
    noc_frame_rows rows = { .reflects = { f, f + n, f + 2 * n },
                            .normal = { f + 3 * n, f + 4 * n, f + 5 * n },
                            .depth = f + 6 * n,
                            .what = what };
    noc_view_rows(v, &rows);
    for (size_t i = 0; i < n; i++) {
        what[i] = s->image->coverage[4 * i + 3] > 0 ? NOC_ROW_EMITTER : what[i];
        p[6 * n + i] = s->expected ? s->expected->value[i] : 0;
        p[7 * n + i] = s->variance && v->history.accumulated > 1 ? s->variance->value[i] : -1;
    }
    s->step = (still_step){ .width = v->width,
                            .height = v->height,
                            .frames = (int)NOC_MIN(v->history.accumulated, (uint64_t)1 << 20),
                            .rays = rays_of(v),
                            .camera = v->last.camera,
                            .reflects = { f, f + n, f + 2 * n },
                            .normal = { f + 3 * n, f + 4 * n, f + 5 * n },
                            .inverse = f + 6 * n,
                            .slope_x = f + 7 * n,
                            .slope_y = f + 8 * n,
                            .told = f + 9 * n,
                            .what = what,
                            .illuminance = s->illuminance->value,
                            .y = p,
                            .r = p + n,
                            .b = p + 2 * n,
                            .variance = p + 3 * n,
                            .pilot = p + 4 * n,
                            .deviation = p + 5 * n,
                            .expected = p + 6 * n,
                            .frame_variance = p + 7 * n,
                            .rgb = s->image->rgb };
}

static const still_rows *rows_for(noc_isa isa) {
#if defined(__x86_64__)
    if (isa == NOC_ISA_AVX512)
        return &noc_still_rows_avx512;
    if (isa == NOC_ISA_AVX2)
        return &noc_still_rows_avx2;
#endif
    (void)isa;
    return &noc_still_rows_baseline;
}

typedef struct row_run {
    const still_step *step;
    void (*kernel)(const still_step *s, int y);
} row_run;

static void run_row(const void *ctx, int y) {
    const row_run *run = ctx;
    run->kernel(run->step, y);
}

static void run_rows(const still *s, void (*kernel)(const still_step *s, int y)) {
    noc_device_rows(s->view->device, s->step.height, run_row, &(row_run){ &s->step, kernel });
}

/* The root of the mean relative squared error of surfaces. */
static double error_of(const still_step *s) {
    double sum = 0;
    size_t n = (size_t)s->width * (size_t)s->height, surfaces = 0;
    for (size_t i = 0; i < n; i++)
        if ((s->what[i] & 3) == NOC_ROW_SURFACE) {
            sum += s->told[i];
            surfaces++;
        }
    return surfaces ? sqrt(sum / (double)surfaces) : 0;
}

static void smooth(still *s) {
    const still_rows *rows = rows_for(noc_rows_isa(s->view->last.isa));
    look(s);
    run_rows(s, rows->split);
    run_rows(s, rows->vary);
    run_rows(s, rows->guess);
    run_rows(s, rows->fit);
    s->image->smoothed = true;
    s->image->smoothed_error = error_of(&s->step);
}

noc_image *noc_view_smoothed(noc_view *view) {
    still s = { .view = view };
    if (!view || check(view))
        return NULL;
    if (take(&s)) {
        noc_image_destroy(s.image);
        s.image = NULL;
    } else {
        smooth(&s);
    }
    noc_channel_destroy(s.illuminance);
    noc_channel_destroy(s.expected);
    noc_channel_destroy(s.variance);
    free(s.planes);
    free(s.frame);
    return s.image;
}
