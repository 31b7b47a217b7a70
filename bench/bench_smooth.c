/* Smoothing of moving pictures (nocturne/smooth.h): what it costs, and what is off in its pictures beside those of
 * single frames and of means over several, while the camera moves.
 *
 *   bench_smooth [SCENE [WIDTH HEIGHT [MOVE [FOLDER]]]]     default: city 320 180, all moves
 *
 * SCENE as bench_scene has it. From the street camera, at 30 pictures a second: a camera at rest, a walk (1.5 m/s), a
 * drive (15 m/s), a look round (15 degrees a second) and a fast turn (90). Each picture is compared with the mean of
 * many frames from the same place: relMSE of luminance up to 10 cd/m2 without pixels that see an emitter (e = 1 % of
 * the mean), RMSE-8 of the displayed pictures at one exposure, and flicker: the RMSE-8 of the difference of two
 * pictures in a row against that of their references. Bias is the mean over that of the reference. Times are CPU ms a
 * picture. FOLDER: where the pictures are written to. */
#include "bench_scene.h"

#include "base/base.h"

#include <math.h>

enum { WARM = 24, MEASURED = 4, CONVERGED = 64 };
#define CEILING 10 /* cd/m2 */

typedef struct move {
    const char *name;
    double forward, turn; /* m and degrees a picture */
} move;

static const move moves[] = { { "rest", 0, 0 },
                              { "walk, 1.5 m/s", 1.5 / 30, 0 },
                              { "drive, 15 m/s", 15. / 30, 0 },
                              { "look, 15 deg/s", 0, 15. / 30 },
                              { "turn, 90 deg/s", 0, 90. / 30 } };

typedef struct way {
    const char *name;
    noc_preset preset;
    int samples; /* frames averaged in a picture */
    bool smooth;
    noc_smooth_params params;
} way;

static const way ways[] = {
    { "interactive", NOC_PRESET_INTERACTIVE, 1, false, { 0 } },
    { "interactive, 2 frames", NOC_PRESET_INTERACTIVE, 2, false, { 0 } },
    { "interactive, 4 frames", NOC_PRESET_INTERACTIVE, 4, false, { 0 } },
    { "still", NOC_PRESET_STILL, 1, false, { 0 } },
    { "interactive, smoothed", NOC_PRESET_INTERACTIVE, 1, true, { NOC_SMOOTH_DEFAULTS(NOC_DEFAULT_IN_C) } },
    { "still, smoothed", NOC_PRESET_STILL, 1, true, { NOC_SMOOTH_DEFAULTS(NOC_DEFAULT_IN_C) } },
    { "interactive, accumulated alone", NOC_PRESET_INTERACTIVE, 1, true, { 32, 0, false } },
    { "interactive, without antialias", NOC_PRESET_INTERACTIVE, 1, true, { 32, 5, false } },
};

typedef struct bench {
    noc_scene *scene;
    noc_device *device;
    noc_log *log;
    noc_camera start;
    noc_render_params params;
    noc_display_params display;
    noc_image *references[MEASURED];
    const char *folder;
    size_t pixels;
} bench;

static noc_camera camera_at(const bench *b, const move *m, int picture) {
    noc_camera c = b->start;
    double angle = m->turn * picture * M_PI / 180, cs = cos(angle), sn = sin(angle), d[3], length = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = c.target[k] - c.eye[k];
        length += d[k] * d[k];
    }
    for (int k = 0; k < 3; k++)
        c.eye[k] += m->forward * picture * d[k] / sqrt(length);
    c.target[0] = c.eye[0] + cs * d[0] - sn * d[1];
    c.target[1] = c.eye[1] + sn * d[0] + cs * d[1];
    c.target[2] = c.eye[2] + d[2];
    return c;
}

/* Clamped, as compare does beside: what lies right at a lamp outweighs all else. */
static double luminance(const float *c) { return fmin(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2], CEILING); }

static double relmse(const bench *b, const noc_image *x, const noc_image *r) {
    double mean = 0, sum = 0;
    size_t n = 0;
    for (size_t i = 0; i < b->pixels; i++)
        if (!r->emitter[i]) {
            mean += luminance(r->rgb + 3 * i);
            n++;
        }
    double e = .01 * mean / (double)n;
    for (size_t i = 0; i < b->pixels; i++)
        if (!r->emitter[i]) {
            double a = luminance(x->rgb + 3 * i), c = luminance(r->rgb + 3 * i);
            sum += (a - c) * (a - c) / (c * c + e * e);
        }
    return sum / (double)n;
}

static double bias(const bench *b, const noc_image *x, const noc_image *r) {
    double of[2] = { 0 };
    for (size_t i = 0; i < b->pixels; i++)
        if (!r->emitter[i]) {
            of[0] += luminance(x->rgb + 3 * i);
            of[1] += luminance(r->rgb + 3 * i);
        }
    return of[0] / of[1];
}

/* Of a - c, of two pictures each; c may be NULL. */
static double rmse8(const bench *b, const uint8_t *const a[2], const uint8_t *const c[2]) {
    double sum = 0;
    for (size_t i = 0; i < 3 * b->pixels; i++) {
        double d = a[0][i] - (double)a[1][i] - (c ? c[0][i] - (double)c[1][i] : 0);
        sum += d * d;
    }
    return sqrt(sum / (double)(3 * b->pixels));
}

static uint8_t *shown(const bench *b, const noc_image *image) {
    uint8_t *rgb = malloc(3 * b->pixels);
    if (!rgb || noc_image_to_srgb8(image, &b->display, rgb))
        exit(1);
    return rgb;
}

static noc_image *converge(const bench *b, const noc_camera *camera) {
    noc_render_params p = noc_render_default_params();
    p.width = b->params.width;
    p.height = b->params.height;
    noc_view *v = noc_view_create(b->device, b->scene);
    for (int i = 0; i < CONVERGED; i++)
        if (noc_view_render(v, camera, &p, NULL))
            exit(1);
    noc_image *image = noc_view_image(v);
    noc_view_destroy(v);
    return image;
}

static void write_picture(const bench *b, const noc_image *image, const char *what, const move *m, int picture) {
    char path[512];
    snprintf(path, sizeof(path), "%s/%.4s %s %d.png", b->folder, m->name, what, picture);
    if (noc_image_write(image, path, &b->display, NULL, b->log))
        exit(1);
}

typedef struct figures {
    double relmse, rmse8, flicker, bias, ms, smooth_ms;
} figures;

static void measure(const bench *b, const way *w, const move *m, const noc_image *image, int i, uint8_t **last,
                    figures *f) {
    uint8_t *now = shown(b, image), *reference = shown(b, b->references[i]);
    f->relmse += relmse(b, image, b->references[i]) / MEASURED;
    f->bias += bias(b, image, b->references[i]) / MEASURED;
    f->rmse8 += rmse8(b, (const uint8_t *const[]){ now, reference }, NULL) / MEASURED;
    if (i) {
        uint8_t *before = shown(b, b->references[i - 1]);
        f->flicker += rmse8(b, (const uint8_t *const[]){ now, *last }, (const uint8_t *const[]){ reference, before }) /
                      (MEASURED - 1);
        free(before);
    }
    if (b->folder)
        write_picture(b, image, w->name, m, i);
    free(reference);
    free(*last);
    *last = now;
}

static figures run(const bench *b, const way *w, const move *m) {
    figures f = { 0 };
    noc_render_params p = b->params;
    noc_render_use_preset(&p, w->preset);
    p.aovs = w->smooth ? NOC_SMOOTH_AOVS : 0;
    noc_view *view = noc_view_create(b->device, b->scene);
    noc_smoother *smoother = noc_smoother_create(b->device);
    uint8_t *last = NULL;
    for (int i = 0; i < WARM + MEASURED; i++) {
        noc_camera camera = camera_at(b, m, i);
        double before = noc_cpu_seconds();
        noc_view_restart(view);
        for (int k = 0; k < w->samples; k++)
            if (noc_view_render(view, &camera, &p, NULL))
                exit(1);
        double middle = noc_cpu_seconds();
        const noc_image *smoothed = w->smooth ? noc_smoother_step(smoother, view, &w->params) : NULL;
        double after = noc_cpu_seconds();
        noc_image *image = w->smooth ? NULL : noc_view_image(view);
        if (i >= WARM) {
            measure(b, w, m, image ? image : smoothed, i - WARM, &last, &f);
            f.ms += 1e3 * (after - before) / MEASURED;
            f.smooth_ms += 1e3 * (after - middle) / MEASURED;
        }
        noc_image_destroy(image);
    }
    free(last);
    noc_smoother_destroy(smoother);
    noc_view_destroy(view);
    return f;
}

int main(int argc, char **argv) {
    bench b = { .log = bench_log(), .params = noc_render_default_params(), .display = noc_display_default_params() };
    b.params.width = argc > 3 ? atoi(argv[2]) : 320;
    b.params.height = argc > 3 ? atoi(argv[3]) : 180;
    size_t count = sizeof(moves) / sizeof(*moves), only = argc > 4 ? (size_t)atoi(argv[4]) : count;
    b.folder = argc > 5 ? argv[5] : NULL;
    b.pixels = (size_t)b.params.width * (size_t)b.params.height;
    b.scene = bench_scene(argc > 1 ? argv[1] : "city", b.log);
    b.device = noc_device_create(NULL, b.log);
    if (!b.scene || !b.device ||
        noc_scene_camera(b.scene, NOC_VIEWPOINT_STREET, (double)b.params.width / b.params.height, &b.start))
        return 1;
    printf("# %-31s  relMSE  RMSE-8  flicker  bias   CPU ms  of that smoothing\n", "");
    for (size_t k = 0; k < count; k++) {
        if (only < count && k != only)
            continue;
        for (int i = 0; i < MEASURED; i++) {
            noc_camera camera = camera_at(&b, &moves[k], WARM + i);
            b.references[i] = converge(&b, &camera);
        }
        b.display.auto_exposure = false;
        b.display.ev100 = noc_image_auto_ev100(b.references[0]);
        printf("%s\n", moves[k].name);
        for (size_t i = 0; i < sizeof(ways) / sizeof(*ways); i++) {
            figures f = run(&b, &ways[i], &moves[k]);
            printf("  %-31s  %6.3f  %6.2f  %7.2f  %5.3f  %6.1f  %6.1f\n", ways[i].name, f.relmse, f.rmse8, f.flicker,
                   f.bias, f.ms, f.smooth_ms);
            fflush(stdout);
        }
        for (int i = 0; i < MEASURED; i++) {
            if (b.folder)
                write_picture(&b, b.references[i], "reference", &moves[k], i);
            noc_image_destroy(b.references[i]);
        }
    }
    noc_device_destroy(b.device);
    noc_scene_destroy(b.scene);
    noc_log_destroy(b.log);
    return 0;
}
