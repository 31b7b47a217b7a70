/* One configuration frame by frame against a reference, and the reference. */
#include "lab/measure.h"

#include <math.h>

/* The image becomes the mean of the frames so far. */
static void average(double *sum, int frame, noc_image *image) {
    size_t n = (size_t)image->width * (size_t)image->height * 3;
    for (size_t i = 0; i < n; i++) {
        sum[i] = frame > 1 ? sum[i] + image->rgb[i] : image->rgb[i];
        image->rgb[i] = (float)(sum[i] / frame);
    }
}

typedef struct frame_now {
    bool (*progress)(void *user, int frame, double done);
    void *user;
    int frame;
} frame_now;

static bool tell(void *user, const char *what, double done) {
    const frame_now *now = user;
    return !now->progress || now->progress(now->user, now->frame, done);
}

static noc_status take(const lab_loop *loop, noc_view *view, int frame, bool *last) {
    noc_frame_stats stats;
    noc_light_stats lights;
    noc_view_get_stats(view, &stats);
    noc_view_light_stats(view, &lights);
    *last = false;
    if (!loop->rendered(loop->user, frame, &stats, &lights, last) && !loop->sum)
        return NOC_OK;
    noc_status status = loop->seen ? loop->seen(loop->user, frame, view) : NOC_OK;
    noc_image *image = status ? NULL : noc_view_image(view);
    if (!image)
        return status ? status : NOC_ERR_MEMORY; /* reported by the view */
    status = loop->take(loop->user, frame, false, image);
    if (!status && loop->sum) {
        average(loop->sum, frame, image);
        status = loop->take(loop->user, frame, true, image);
    }
    noc_image_destroy(image);
    return status;
}

noc_status lab_run_loop(const lab_loop *loop) {
    noc_render_params params = loop->params;
    params.accumulate = false;
    noc_view *view = noc_view_create(loop->device, loop->scene);
    noc_status status = view ? NOC_OK : NOC_ERR_MEMORY;
    frame_now now = { loop->progress, loop->user, 1 };
    for (bool last = false; !status && !last; now.frame++) {
        noc_camera camera;
        status = tell(&now, "", 0) ? loop->prepare(loop->user, now.frame, &camera)
                                   : noc_cancelled(loop->log, "lab: cancelled");
        status = status ? status : noc_view_render(view, &camera, &params, &(noc_progress){ tell, &now });
        status = status ? status : take(loop, view, now.frame, &last);
    }
    noc_view_destroy(view);
    return status;
}

typedef struct measuring {
    const noc_camera *camera;
    const noc_image *reference;
    const noc_lab_measure_params *params;
    noc_lab_frame *frames;
    size_t count; /* that are whole */
    noc_log *log;
} measuring;

static noc_status same_camera(void *user, int frame, noc_camera *camera) {
    *camera = *((const measuring *)user)->camera;
    return NOC_OK;
}

static bool measure_progress(void *user, int frame, double done) {
    const noc_lab_measure_params *p = ((const measuring *)user)->params;
    return !p->progress.update || p->progress.update(p->progress.user, "frames", (frame - 1 + done) / p->frames);
}

static bool measure_rendered(void *user, int frame, const noc_frame_stats *stats, const noc_light_stats *lights,
                             bool *last) {
    measuring *m = user;
    noc_lab_frame *now = &m->frames[frame - 1];
    const noc_lab_frame *before = frame > 1 ? now - 1 : NULL;
    *now = (noc_lab_frame){ .frame = frame,
                            .cpu_total = stats->cpu_seconds + (before ? before->cpu_total : 0),
                            .wall_total = stats->wall_seconds + (before ? before->wall_total : 0),
                            .stats = *stats,
                            .lights = *lights };
    *last = frame == m->params->frames || (m->params->seconds > 0 && now->cpu_total >= m->params->seconds);
    return true;
}

static noc_status measure_take(void *user, int frame, bool mean, const noc_image *image) {
    measuring *m = user;
    noc_lab_frame *now = &m->frames[frame - 1];
    noc_status status =
        noc_image_compare(image, m->reference, &m->params->compare, mean ? &now->mean : &now->alone, m->log);
    m->count += !status && mean;
    return status;
}

noc_status noc_lab_measure(noc_device *device, const noc_scene *scene, const noc_camera *camera,
                           const noc_render_params *render, const noc_image *reference,
                           const noc_lab_measure_params *params, noc_lab_frame *frames, size_t *count, noc_log *log) {
    const noc_lab_measure_params defaults = noc_lab_measure_default_params();
    params = params ? params : &defaults;
    if (count)
        *count = 0;
    if (!device || !scene || !camera || !reference || !frames)
        return noc_null(log, "noc_lab_measure");
    if (params->frames < 1 || !(params->seconds >= 0))
        return noc_error(log, NOC_ERR_ARGUMENT, "noc_lab_measure: %d frames, %g s", params->frames, params->seconds);
    noc_render_params own = render ? *render : noc_lab_render_params(reference->width, reference->height);
    if (own.width != reference->width || own.height != reference->height)
        return noc_error(log, NOC_ERR_ARGUMENT, "noc_lab_measure: a reference of %d x %d for pictures of %d x %d",
                         reference->width, reference->height, own.width, own.height);
    double *sum = noc_alloc_large((size_t)own.width * (size_t)own.height, 3 * sizeof(double));
    if (!sum)
        return noc_no_memory(log, "noc_lab_measure");
    measuring m = { camera, reference, params, frames, 0, log };
    noc_status status = lab_run_loop(&(lab_loop){ .device = device,
                                                  .scene = scene,
                                                  .params = own,
                                                  .sum = sum,
                                                  .log = log,
                                                  .user = &m,
                                                  .prepare = same_camera,
                                                  .progress = measure_progress,
                                                  .rendered = measure_rendered,
                                                  .take = measure_take });
    free(sum);
    if (count)
        *count = m.count;
    return status;
}

/* ---- references ----
 *
 * The first n of its N frames are kept on the way; their mean is off from the whole mean by a variance of
 * s^2 (1/n - 1/N), and the whole mean from the truth by s^2 / N. The standard error of its mean luminance, which bias
 * is judged by, is that of the means of equal parts of its frames. */

/* The running mean of luminance after each of a few equal parts of the frames; [0]: of pixels that see no emitter, [1]:
 * of all. */
enum { PARTS = 8 };
typedef struct batches {
    double mean[2][PARTS + 1];
    int frames[PARTS + 1], count;
} batches;

static void add_batch(batches *b, const noc_image *image, int frames) {
    double sum[2] = { 0, 0 }, pixels[2] = { 0, 0 };
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
        const float *p = image->rgb + 3 * i;
        double y = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        for (int all = image->emitter && image->emitter[i]; all < 2; all++) {
            sum[all] += y;
            pixels[all]++;
        }
    }
    b->count++;
    b->frames[b->count] = frames;
    for (int all = 0; all < 2; all++)
        b->mean[all][b->count] = pixels[all] > 0 ? sum[all] / pixels[all] : NAN;
}

/* Standard error of the last mean, as a share of it: the parts' own means follow from the running ones. */
static double mean_error(const batches *b, int all) {
    double whole = b->mean[all][b->count], squares = 0;
    if (b->count < 2 || !(whole > 0))
        return NAN;
    int frames = b->frames[b->count];
    for (int i = 1; i <= b->count; i++) {
        int n = b->frames[i] - b->frames[i - 1];
        double before = i > 1 ? b->frames[i - 1] * b->mean[all][i - 1] : 0,
               own = (b->frames[i] * b->mean[all][i] - before) / n;
        squares += n * (own - whole) * (own - whole);
    }
    return sqrt(squares / (b->count - 1) / frames) / whole;
}

/* half: the mean of its first frames, NULL where it has one frame alone. */
static noc_status measure_noise(const lab_making *m, const noc_image *whole, const noc_image *half, int half_frames,
                                const batches *b, noc_lab_noise *noise) {
    *noise = (noc_lab_noise){ NAN, NAN, NAN, NAN, mean_error(b, 0), mean_error(b, 1) };
    noc_compare_params params = noc_compare_default_params();
    params.ceiling = m->ceiling;
    noc_comparison c;
    noc_status status = half ? noc_image_compare(half, whole, &params, &c, m->log) : NOC_OK;
    if (status || !half)
        return status;
    double share = (double)half_frames / (m->frames - half_frames);
    noise->relmse = share * c.dark.relmse;
    noise->relmse_clamped = share * c.dark_clamped.relmse;
    noise->relmse_all = share * c.all.relmse;
    noise->relmse_clamped_all = share * c.all_clamped.relmse;
    return NOC_OK;
}

noc_status lab_render_reference(const lab_making *m, noc_image **out, noc_lab_noise *noise) {
    noc_render_params params = m->params;
    params.accumulate = true;
    noc_view *view = noc_view_create(m->device, m->scene);
    noc_status status = view ? NOC_OK : NOC_ERR_MEMORY;
    int halfway = m->frames / 2, parts = NOC_MIN(m->frames, PARTS);
    batches b = { .count = 0 };
    noc_image *half = NULL, *whole = NULL;
    frame_now now = { m->progress, m->user, 1 };
    for (; !status && now.frame <= m->frames; now.frame++) {
        status = noc_view_render(view, m->camera, &params, &(noc_progress){ tell, &now });
        if (!status && m->rendered)
            m->rendered(m->user, now.frame);
        bool part_ends = (long long)now.frame * parts / m->frames > b.count;
        if (status || (!part_ends && now.frame != halfway && now.frame != m->frames))
            continue;
        noc_image *image = noc_view_image(view);
        if (!image)
            status = NOC_ERR_MEMORY; /* reported by the view */
        if (image && part_ends)
            add_batch(&b, image, now.frame);
        if (now.frame == halfway)
            half = image;
        else if (now.frame == m->frames)
            whole = image;
        else
            noc_image_destroy(image);
    }
    noc_view_destroy(view);
    if (!status && noise)
        status = measure_noise(m, whole, half, halfway, &b, noise);
    noc_image_destroy(half);
    if (status)
        noc_image_destroy(whole);
    else
        *out = whole;
    return status;
}

static bool reference_progress(void *user, int frame, double done) {
    const noc_lab_reference_params *p = user;
    return !p->progress.update || p->progress.update(p->progress.user, "reference", (frame - 1 + done) / p->frames);
}

noc_status noc_lab_reference(noc_device *device, const noc_scene *scene, const noc_camera *camera,
                             const noc_render_params *render, const noc_lab_reference_params *params, noc_image **image,
                             noc_lab_noise *noise, noc_log *log) {
    noc_lab_reference_params own = params ? *params : noc_lab_reference_default_params();
    if (!device || !scene || !camera || !render || !image)
        return noc_null(log, "noc_lab_reference");
    *image = NULL;
    if (own.frames < 1 || !(own.ceiling > 0))
        return noc_error(log, NOC_ERR_ARGUMENT, "noc_lab_reference: %d frames, clamped to %g cd/m2", own.frames,
                         own.ceiling);
    return lab_render_reference(&(lab_making){ .device = device,
                                               .scene = scene,
                                               .camera = camera,
                                               .params = *render,
                                               .frames = own.frames,
                                               .ceiling = own.ceiling,
                                               .log = log,
                                               .user = &own,
                                               .progress = reference_progress },
                                image, noise);
}
