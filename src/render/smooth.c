/* A smoother: its memory, and the order of its kernels over the rows of a frame. */
#include "render/smooth.h"

#include <string.h>

struct noc_smoother {
    noc_device *device;
    const noc_view *view; /* whose frames are taken: compared, never followed */
    uint64_t number;      /* of the last one taken; 0: none */
    smooth_frame frames[2];
    int last;          /* of frames: that of the last step */
    int rested;        /* steps in a row that were still */
    bool held;         /* frames[last] is of a complete step */
    int width, height; /* of what follows */
    float *scratch;
    noc_image *image;
};

/* Planes of floats, several numbers a pixel counted as so many. */
enum { FRAME_PLANES = 7 + LIGHT_HELD + SHOWN_HELD, SCRATCH_PLANES = 9 + 2 * 4 };

noc_smoother *noc_smoother_create(noc_device *device) {
    noc_smoother *s = device ? noc_calloc(1, sizeof(*s)) : NULL;
    if (device && !s)
        noc_no_memory(device->log, "smoother");
    if (s)
        s->device = device;
    return s;
}

static void free_frame(smooth_frame *f) {
    free(f->inverse);
    *f = (smooth_frame){ 0 };
}

void noc_smoother_destroy(noc_smoother *s) {
    if (!s)
        return;
    for (int i = 0; i < 2; i++)
        free_frame(&s->frames[i]);
    free(s->scratch);
    noc_image_destroy(s->image);
    free(s);
}

void noc_smoother_reset(noc_smoother *s) {
    if (!s)
        return;
    s->held = false;
    s->number = 0;
}

static bool make_frame(smooth_frame *f, int width, int height) {
    if (f->width == width && f->height == height)
        return true;
    free_frame(f);
    size_t n = (size_t)width * (size_t)height;
    float *at = noc_alloc_large(n, FRAME_PLANES * sizeof(float));
    if (!at)
        return false;
    *f = (smooth_frame){ .width = width,
                         .height = height,
                         .inverse = at,
                         .slope_x = at + n,
                         .slope_y = at + 2 * n,
                         .normal = { at + 3 * n, at + 4 * n, at + 5 * n },
                         .what = (uint32_t *)(at + 6 * n),
                         .light = (float(*)[LIGHT_HELD])(at + 7 * n),
                         .shown = (float(*)[SHOWN_HELD])(at + (7 + LIGHT_HELD) * n) };
    return true;
}

/* Room for a frame of this size; what is known of the last one stays. */
static noc_status make_room(noc_smoother *s, int width, int height) {
    bool ok = make_frame(&s->frames[1 - s->last], width, height);
    if (ok && (s->width != width || s->height != height)) {
        free(s->scratch);
        noc_image_destroy(s->image);
        s->width = s->height = 0;
        s->scratch = noc_alloc_large((size_t)width * (size_t)height, SCRATCH_PLANES * sizeof(float));
        s->image = noc_image_create(width, height, s->device->log);
        if (s->image) {
            s->image->coverage = noc_alloc_large((size_t)width * (size_t)height, 4 * sizeof(float));
            s->image->emitter = noc_alloc((size_t)width * (size_t)height);
        }
        ok = s->scratch && s->image && s->image->coverage && s->image->emitter;
        s->width = ok ? width : 0;
        s->height = ok ? height : 0;
    }
    if (ok)
        return NOC_OK;
    noc_smoother_reset(s);
    return noc_error(s->device->log, NOC_ERR_MEMORY, "smoother: no memory for a picture of %d x %d", width, height);
}

static smooth_planes planes_at(float *at, size_t n) { return (smooth_planes){ at, at + n, at + 2 * n, at + 3 * n }; }

static smooth_step make_step(noc_smoother *s, const noc_view *view, const noc_smooth_params *params) {
    const noc_last_frame *last = &view->last;
    smooth_frame *now = &s->frames[1 - s->last];
    bool follows = s->held && s->view == view && last->connected && last->number == s->number + 1;
    size_t n = (size_t)now->width * (size_t)now->height;
    float *at = s->scratch;
    now->camera = last->camera;
    smooth_step step = { .now = *now,
                         .then = follows ? &s->frames[s->last] : NULL,
                         .rows = { .rgb = { at, at + n, at + 2 * n },
                                   .reflects = { at + 3 * n, at + 4 * n, at + 5 * n },
                                   .normal = { now->normal[0], now->normal[1], now->normal[2] },
                                   .depth = now->inverse,
                                   .motion = { at + 6 * n, at + 7 * n, at + 8 * n },
                                   .what = now->what },
                         .planes = { planes_at(at + 9 * n, n), planes_at(at + 13 * n, n) },
                         .image = s->image,
                         .params = params,
                         .still = follows && last->still };
    step.rested = step.still ? s->rested + 1 : 0;
    for (int i = 0; i < SUM_SQUARES; i++)
        step.sums[i] = at + (13 + (size_t)i) * n;
    return step;
}

static const smooth_rows *rows_of(noc_isa asked) {
    noc_isa isa = noc_rows_isa(asked);
#if defined(__x86_64__)
    if (isa == NOC_ISA_AVX512)
        return &noc_smooth_rows_avx512;
    if (isa == NOC_ISA_AVX2)
        return &noc_smooth_rows_avx2;
#endif
    (void)isa;
    return &noc_smooth_rows_baseline;
}

typedef struct row_run {
    const smooth_step *step;
    void (*kernels[2])(const smooth_step *s, int y); /* the second one may be NULL */
} row_run;

static void run_row(const void *ctx, int y) {
    const row_run *run = ctx;
    for (int i = 0; i < 2 && run->kernels[i]; i++)
        run->kernels[i](run->step, y);
}

static void run_rows(const noc_smoother *s, const smooth_step *step, row_run run) {
    run.step = step;
    noc_device_rows(s->device, step->now.height, run_row, &run);
}

static noc_status check(const noc_smoother *s, const noc_view *view, const noc_smooth_params *p) {
    noc_log *log = s->device->log;
    if (!view)
        return noc_null(log, "noc_smoother_step");
    if (view->device != s->device)
        return noc_error(log, NOC_ERR_ARGUMENT, "smoother: the view is of another device");
    if (p->history < 1 || p->history > 256 || p->passes < 0 || p->passes > MOST_PASSES)
        return noc_error(log, NOC_ERR_ARGUMENT, "smoother: history is %d, must be in 1..256, passes %d, in 0..%d",
                         p->history, p->passes, MOST_PASSES);
    if (!view->last.there)
        return noc_error(log, NOC_ERR_ARGUMENT, "smoother: the view has no frame, or the last one was dropped");
    if (!view->last.motion)
        return noc_error(log, NOC_ERR_ARGUMENT,
                         "smoother: the view's frame has no motion: its aovs lack NOC_SMOOTH_AOVS");
    return NOC_OK;
}

/* As noc_view_image has it, or exposure would be metered otherwise while a picture moves: a pixel, and those around.
 * What emitters add is remembered for a few frames: pixels that have some of it are theirs, too. */
static void mark_emitters(noc_image *image, const uint32_t *what) {
    int width = image->width, height = image->height;
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        image->emitter[i] = image->coverage[4 * i + 3] > 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            if ((what[(size_t)y * (size_t)width + (size_t)x] & 3) != NOC_ROW_EMITTER)
                continue;
            for (int j = NOC_MAX(y - 1, 0); j <= NOC_MIN(y + 1, height - 1); j++)
                for (int i = NOC_MAX(x - 1, 0); i <= NOC_MIN(x + 1, width - 1); i++)
                    image->emitter[(size_t)j * (size_t)width + (size_t)i] = 1;
        }
}

static void smooth(noc_smoother *s, noc_view *view, const noc_smooth_params *params) {
    smooth_step step = make_step(s, view, params);
    const smooth_rows *rows = rows_of(view->last.isa);
    noc_view_rows(view, &step.rows);
    run_rows(s, &step, (row_run){ .kernels = { rows->shape, rows->gather } });
    run_rows(s, &step, (row_run){ .kernels = { rows->settle } });
    for (; step.pass < params->passes; step.pass++)
        run_rows(s, &step, (row_run){ .kernels = { rows->filter } });
    run_rows(s, &step, (row_run){ .kernels = { rows->make } });
    run_rows(s, &step, (row_run){ .kernels = { rows->show } });
    mark_emitters(s->image, step.now.what);
    s->image->smoothed = true;
    s->last = 1 - s->last;
    s->held = true;
    s->rested = NOC_MIN(step.rested, 1 << 20);
    s->view = view;
    s->number = view->last.number;
}

const noc_image *noc_smoother_step(noc_smoother *s, noc_view *view, const noc_smooth_params *params) {
    const noc_smooth_params defaults = noc_smooth_default_params();
    params = params ? params : &defaults;
    if (!s || check(s, view, params))
        return NULL;
    bool again = s->held && s->view == view && s->number == view->last.number;
    if (again)
        return s->image;
    if (make_room(s, view->width, view->height))
        return NULL;
    smooth(s, view, params);
    return s->image;
}
