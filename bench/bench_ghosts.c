/* How soon a picture forgets a car that vanishes, and sees one that appears: frames, without a mean over them, until
 * what the car's lamps light is within 5 % of a converged picture of the new state, and what is off in the first ones.
 *
 *   bench_ghosts [SCENE [WIDTH HEIGHT [AHEAD [RUNS [ROW]]]]]     default: city 240 135 14 6, all rows
 *
 * SCENE as bench_scene has it. The car stands AHEAD metres before its street camera and looks away from it; the bench's
 * camera hangs behind the car and looks at what it lights. Compared are the pixels that the car changes by a quarter or
 * more and that do not show it: the mean of their luminance against that of the converged picture, over all runs, which
 * differ in their seeds; and by blocks of 8 x 8 pixels, whose errors are averaged without their signs. Noise is in the
 * second: what it comes to in the last frames stands in the last column. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "city/traffic/traffic.h"
#include "scene/scene.h"

#include <math.h>

enum { WARM = 24, FRAMES = 32, CONVERGED = 200, BLOCK = 8, SHOWN = 5, REST = 8 };

typedef struct bench {
    noc_scene *scene;
    noc_view *view;
    noc_camera camera;
    noc_render_params params;
    int model, car; /* car: its instance, -1: none */
    double transform[12];
    noc_smoother *smoother; /* NULL: frames are looked at as they are */
    float *with, *without;  /* luminance, converged */
    unsigned char *mask;
    size_t pixels;
    int runs;
} bench;

static bool stand_car(bench *b, bool there) {
    if (there == (b->car >= 0))
        return true;
    noc_instance car = { .model = b->model };
    memcpy(car.transform, b->transform, sizeof(car.transform));
    if (there)
        b->car = noc_scene_add_instance(b->scene, &car);
    else if (noc_scene_remove_instance(b->scene, b->car))
        return false;
    else
        b->car = -1;
    return (!there || b->car >= 0) && !noc_scene_commit(b->scene);
}

static bool frame(bench *b, const noc_render_params *p, float *out) {
    if (noc_view_render(b->view, &b->camera, p, NULL))
        return false;
    const noc_image *smoothed = b->smoother ? noc_smoother_step(b->smoother, b->view, NULL) : NULL;
    noc_image *mine = out && !smoothed ? noc_view_image(b->view) : NULL;
    const noc_image *image = smoothed ? smoothed : mine;
    for (size_t i = 0; image && out && i < b->pixels; i++)
        out[i] = .2126f * image->rgb[3 * i] + .7152f * image->rgb[3 * i + 1] + .0722f * image->rgb[3 * i + 2];
    bool ok = !out || image;
    noc_image_destroy(mine);
    return ok;
}

static bool converge(bench *b, bool there, float *out) {
    noc_render_params p = noc_render_default_params();
    p.width = b->params.width;
    p.height = b->params.height;
    p.jitter = p.emitters = false;
    noc_view_reset(b->view);
    bool ok = stand_car(b, there);
    for (int i = 0; i < CONVERGED && ok; i++)
        ok = frame(b, &p, i + 1 == CONVERGED ? out : NULL);
    return ok;
}

/* Pixels that the car lights, and that do not show it. */
static bool find_mask(bench *b) {
    noc_render_params p = b->params;
    p.aovs = 1u << NOC_AOV_CLASS;
    bool ok = stand_car(b, true) && frame(b, &p, NULL);
    noc_channel *classes = ok ? noc_view_aov(b->view, NOC_AOV_CLASS) : NULL;
    size_t count = 0;
    for (size_t i = 0; classes && i < b->pixels; i++) {
        float more = fmaxf(b->with[i], b->without[i]), change = fabsf(b->with[i] - b->without[i]);
        b->mask[i] = change > .25f * more && (int)classes->value[i] != NOC_CLASS_VEHICLE;
        count += b->mask[i];
    }
    noc_channel_destroy(classes);
    printf("# %zu of %zu pixels are lit by the car\n", count, b->pixels);
    return classes && count;
}

/* Error of the mean, signed, and mean error of blocks. */
static void compare(const bench *b, const float *have, const float *want, double *mean, double *blocks) {
    double sum[2] = { 0 }, error = 0, total = 0;
    int w = b->params.width, h = b->params.height;
    for (int y0 = 0; y0 < h; y0 += BLOCK)
        for (int x0 = 0; x0 < w; x0 += BLOCK) {
            double of[2] = { 0 };
            for (int y = y0; y < y0 + BLOCK && y < h; y++)
                for (int x = x0; x < x0 + BLOCK && x < w; x++)
                    if (b->mask[y * w + x]) {
                        of[0] += have[y * w + x];
                        of[1] += want[y * w + x];
                    }
            error += fabs(of[0] - of[1]);
            total += of[1];
            sum[0] += of[0];
            sum[1] += of[1];
        }
    *mean = sum[0] / sum[1] - 1;
    *blocks = error / total;
}

/* From one state to the other, after a while in it. */
static bool change(bench *b, bool appears, uint32_t seed, double mean[FRAMES], double blocks[FRAMES]) {
    noc_render_params p = b->params;
    float *have = malloc(b->pixels * sizeof(*have));
    p.seed = seed;
    noc_view_reset(b->view);
    bool ok = have && stand_car(b, !appears);
    for (int i = 0; i < WARM && ok; i++)
        ok = frame(b, &p, NULL);
    ok = ok && stand_car(b, appears);
    for (int i = 0; i < FRAMES && ok; i++) {
        double of_mean, of_blocks;
        ok = frame(b, &p, have);
        compare(b, have, appears ? b->with : b->without, &of_mean, &of_blocks);
        mean[i] += of_mean / b->runs;
        blocks[i] += of_blocks / b->runs;
    }
    free(have);
    return ok;
}

static bool measure(bench *b, const char *name, bool appears) {
    double mean[FRAMES] = { 0 }, blocks[FRAMES] = { 0 }, rest = 0;
    int within = FRAMES;
    for (int run = 0; run < b->runs; run++)
        if (!change(b, appears, 1 + (uint32_t)run, mean, blocks))
            return false;
    for (int i = FRAMES - 1; i >= 0 && fabs(mean[i]) <= .05; i--)
        within = i;
    for (int i = FRAMES - REST; i < FRAMES; i++)
        rest += blocks[i] / REST;
    printf("%-21s %-9s %3d ", name, appears ? "appears" : "vanishes", within + 1);
    for (int i = 0; i < SHOWN; i++)
        printf(" %+6.1f%%", 100 * mean[i]);
    printf("  ");
    for (int i = 0; i < SHOWN; i++)
        printf(" %5.1f%%", 100 * blocks[i]);
    printf("  %5.1f%%\n", 100 * rest);
    fflush(stdout);
    return true;
}

static bool open_bench(bench *b, const char *spec, double ahead) {
    noc_log *log = bench_log();
    noc_traffic_params traffic = noc_traffic_default_params();
    traffic_models models = { .of = { 0 } };
    b->scene = bench_scene(spec, log);
    if (!b->scene || !traffic_our_models(b->scene, &traffic, &models) || noc_scene_commit(b->scene) ||
        noc_scene_camera(b->scene, NOC_VIEWPOINT_STREET, (double)b->params.width / b->params.height, &b->camera))
        return false;
    const double *e = b->camera.eye, *t = b->camera.target;
    double d[2] = { t[0] - e[0], t[1] - e[1] }, length = hypot(d[0], d[1]), z;
    double at[2] = { e[0] + ahead * d[0] / length, e[1] + ahead * d[1] / length };
    if (!noc_scene_ground(b->scene, at[0], at[1], &z))
        return false;
    const double rows[12] = {
        d[0] / length, -d[1] / length, 0, at[0], d[1] / length, d[0] / length, 0, at[1], 0, 0, 1, z
    };
    memcpy(b->transform, rows, sizeof(rows));
    b->model = models.of.data[0].model;
    array_free(&models.of);
    for (int k = 0; k < 2; k++) {
        b->camera.eye[k] = at[k] - 5 * d[k] / length;
        b->camera.target[k] = at[k] + 12 * d[k] / length;
    }
    b->camera.eye[2] = z + 5;
    b->camera.target[2] = z;
    b->view = own_view(b->scene, 0, log);
    return b->view != NULL;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        noc_method method;
        noc_candidates candidates;
        bool interactive, smooth;
    } rows[] = { { "restir, uniform", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, false, false },
                 { "restir, influence", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, false, false },
                 { "restir, lists", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, false, false },
                 { "preset interactive", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, true, false },
                 { "default (ris, lists)", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, false },
                 { "interactive, smoothed", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, true, true },
                 { "default, smoothed", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, true } };
    bench b = { .params = noc_render_default_params(), .car = -1 };
    b.params.width = argc > 3 ? atoi(argv[2]) : 240;
    b.params.height = argc > 3 ? atoi(argv[3]) : 135;
    b.params.accumulate = b.params.jitter = b.params.emitters = false;
    b.runs = argc > 5 ? atoi(argv[5]) : 6;
    b.pixels = (size_t)b.params.width * (size_t)b.params.height;
    b.with = malloc(b.pixels * sizeof(float));
    b.without = malloc(b.pixels * sizeof(float));
    b.mask = calloc(b.pixels, 1);
    bool ok =
        b.with && b.without && b.mask && open_bench(&b, argc > 1 ? argv[1] : "city", argc > 4 ? atof(argv[4]) : 14);
    ok = ok && converge(&b, false, b.without) && converge(&b, true, b.with) && find_mask(&b);
    printf("# until within 5 %%, error of the mean in frames 1 to %d, of blocks in those, and of blocks in the end\n",
           SHOWN);
    size_t only = argc > 6 ? (size_t)atoi(argv[6]) : sizeof(rows) / sizeof(*rows);
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows) && ok; i++)
        for (int appears = 1; appears >= 0 && ok; appears--) {
            if (only < sizeof(rows) / sizeof(*rows) && i != only)
                continue;
            if (rows[i].interactive)
                noc_render_use_preset(&b.params, NOC_PRESET_INTERACTIVE);
            else
                noc_render_use_preset(&b.params, NOC_PRESET_STILL);
            b.params.method = rows[i].method;
            b.params.candidates = rows[i].candidates;
            b.params.aovs = rows[i].smooth ? NOC_SMOOTH_AOVS : 0;
            b.smoother = rows[i].smooth ? noc_smoother_create(noc_view_device(b.view)) : NULL;
            ok = measure(&b, rows[i].name, appears);
            noc_smoother_destroy(b.smoother);
            b.smoother = NULL;
        }
    if (b.view)
        close_view(b.view);
    noc_scene_destroy(b.scene);
    free(b.with);
    free(b.without);
    free(b.mask);
    return ok ? 0 : 1;
}
