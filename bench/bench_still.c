/* Smoothed stills (nocturne/smooth.h): what is off in them, beside the mean of the same frames, and what they cost.
 *
 *   bench_still [SCENE [VIEW [WIDTH HEIGHT [FOLDER]]]]     default: city street 960 540
 *
 * SCENE and VIEW as bench_scene has them. Pictures are of so many frames of so many rays, over lists of 64 + 128, all
 * of the same places in pixels. Each is compared with the mean of 64 frames of 8 rays and another seed, by luminance
 * where no emitter is seen: relMSE is the mean of d^2 / (r^2 + .01 (cd/m2)^2), luminance up to 10 cd/m2; "most" is
 * without the worst 1 % of pixels, "mean" over that of the reference, "told" what the smoothed picture says of its own
 * error, beside what it is. "moving" is what the smoother for moving pictures makes of the same frames. FOLDER: where
 * the pictures are written to. */
#include "bench_scene.h"

#include "base/base.h"

#include <math.h>

enum { REFERENCE = 64 };
#define CEILING 10 /* cd/m2 */

typedef struct bench {
    noc_scene *scene;
    noc_device *device;
    noc_log *log;
    noc_camera camera;
    noc_render_params params;
    noc_display_params display;
    noc_image *reference;
    double *errors; /* a pixel */
    const char *folder;
    size_t pixels;
} bench;

typedef struct figures {
    double relmse, most, mean;
} figures;

static double luminance(const float *c) { return fmin(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2], CEILING); }

static figures compare(const bench *b, const noc_image *image) {
    double sum = 0, most = 0, of[2] = { 0 };
    size_t n = 0;
    for (size_t i = 0; i < b->pixels; i++) {
        double x = luminance(image->rgb + 3 * i), r = luminance(b->reference->rgb + 3 * i);
        if (b->reference->emitter[i])
            continue;
        b->errors[n] = (x - r) * (x - r) / (r * r + .01);
        sum += b->errors[n++];
        of[0] += x;
        of[1] += r;
    }
    qsort(b->errors, n, sizeof(*b->errors), bench_by_size);
    size_t kept = n * 99 / 100;
    for (size_t i = 0; i < kept; i++)
        most += b->errors[i];
    return (figures){ sum / (double)n, most / (double)kept, of[0] / of[1] };
}

/* A view of so many frames; smoother: takes each, or NULL. */
static noc_view *render(const bench *b, int frames, int rays, noc_smoother *smoother) {
    noc_render_params p = b->params;
    p.shadow_rays = rays;
    p.aovs = smoother ? NOC_SMOOTH_AOVS : noc_still_aovs(&p);
    noc_view *v = noc_view_create(b->device, b->scene);
    for (int i = 0; i < frames; i++)
        if (noc_view_render(v, &b->camera, &p, NULL) || (smoother && !noc_smoother_step(smoother, v, NULL)))
            exit(1);
    return v;
}

static void write_picture(const bench *b, const noc_image *image, int frames, int rays, const char *what) {
    char path[512];
    snprintf(path, sizeof(path), "%s/%dx%d %s.png", b->folder, frames, rays, what);
    if (b->folder && noc_image_write(image, path, &b->display, NULL, b->log))
        exit(1);
}

static figures moving(const bench *b, int frames, int rays) {
    noc_smoother *smoother = noc_smoother_create(b->device);
    noc_view *v = render(b, frames, rays, smoother);
    const noc_image *image = noc_smoother_step(smoother, v, NULL);
    if (!image)
        exit(1);
    figures f = compare(b, image);
    noc_view_destroy(v);
    noc_smoother_destroy(smoother);
    return f;
}

static void measure(const bench *b, int frames, int rays) {
    double before = noc_cpu_seconds();
    noc_view *v = render(b, frames, rays, NULL);
    double rendered = noc_cpu_seconds();
    noc_image *smoothed = noc_view_smoothed(v);
    double after = noc_cpu_seconds();
    noc_image *image = noc_view_image(v);
    if (!smoothed || !image)
        exit(1);
    figures raw = compare(b, image), of = compare(b, smoothed), m = moving(b, frames, rays);
    printf("%4d x %d  %7.4f %7.4f %6.3f  %7.4f %7.4f %6.3f   %5.3f of %5.3f  %7.4f %7.4f %6.3f  %7.2f %5.2f\n", frames,
           rays, raw.relmse, raw.most, raw.mean, of.relmse, of.most, of.mean, smoothed->smoothed_error, sqrt(of.relmse),
           m.relmse, m.most, m.mean, rendered - before, after - rendered);
    fflush(stdout);
    write_picture(b, image, frames, rays, "frames");
    write_picture(b, smoothed, frames, rays, "smoothed");
    noc_image_destroy(image);
    noc_image_destroy(smoothed);
    noc_view_destroy(v);
}

int main(int argc, char **argv) {
    static const int rows[][2] = { { 1, 1 }, { 1, 8 }, { 2, 2 },  { 2, 4 }, { 4, 1 },
                                   { 4, 2 }, { 4, 8 }, { 16, 1 }, { 16, 8 } };
    bench b = { .log = bench_log(), .params = noc_render_default_params(), .display = noc_display_default_params() };
    b.params.width = argc > 4 ? atoi(argv[3]) : 960;
    b.params.height = argc > 4 ? atoi(argv[4]) : 540;
    b.params.jitter = false;
    b.folder = argc > 5 ? argv[5] : NULL;
    b.pixels = (size_t)b.params.width * (size_t)b.params.height;
    b.errors = malloc(b.pixels * sizeof(*b.errors));
    b.scene = bench_scene(argc > 1 ? argv[1] : "city", b.log);
    b.device = noc_device_create(NULL, b.log);
    if (!b.errors || !b.scene || !b.device ||
        noc_scene_camera(b.scene, bench_view(argc > 2 ? argv[2] : "street"), (double)b.params.width / b.params.height,
                         &b.camera))
        return 1;
    b.params.seed = 99;
    noc_view *v = render(&b, REFERENCE, 8, NULL);
    b.reference = noc_view_image(v);
    noc_view_destroy(v);
    b.params.seed = 7;
    b.display.auto_exposure = false;
    b.display.ev100 = noc_image_auto_ev100(b.reference);
    write_picture(&b, b.reference, REFERENCE, 8, "reference");
    printf("# frames, rays: relMSE, most, mean | smoothed: relMSE, most, mean, told | moving: relMSE, most, mean | "
           "CPU-s, of that smoothing\n");
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        measure(&b, rows[i][0], rows[i][1]);
    noc_image_destroy(b.reference);
    noc_device_destroy(b.device);
    noc_scene_destroy(b.scene);
    noc_log_destroy(b.log);
    free(b.errors);
    return 0;
}
