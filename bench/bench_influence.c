/* Candidates from influence volumes: frame times against uniform ones, and error by S_r.
 *
 *   bench_influence [SCENE [VIEW [WIDTH HEIGHT [FRAMES [METHOD REFERENCE SEEDS S_R...]]]]]
 *
 * default: city street 640 360 9
 *
 * Without a REFERENCE two renderers, restir at M = 32 and restir at M = 32 from volumes, make frames in turn in one
 * process and so meet the same disturbances; times are medians of CPU seconds. The first frame of each, without a
 * history, is not counted.
 *
 * REFERENCE is a picture of the same view without pixel jitter and sky ("nocturne render --no-jitter --sky 0").
 * With one, the error of the mean of FRAMES frames from volumes is told for each S_r that is given (0: found by the
 * program), with METHOD ris or restir: RMSE-8, and relMSE clamped to 10 cd/m2 on pixels that see no emitter; means
 * and standard errors over SEEDS seeds, and what they would be if each had the CPU time of the first S_r, by how
 * the error falls from half of the frames to all. Frames of all of them are made in turn by one thread each; the
 * time is the CPU time of the fastest frame of all seeds, which is what disturbances add least to. There may be 16
 * S_r. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include <math.h>

enum { MOST_FRAMES = 256, MOST_SEEDS = 64 };

typedef struct measured {
    noc_view *r;
    noc_render_params params;
    double cpu[MOST_FRAMES], pass[NOC_PASS_COUNT][MOST_FRAMES];
} measured;

static noc_render_params params_of(int width, int height, noc_method method, noc_candidates candidates) {
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.method = method;
    p.candidates = candidates;
    p.sky = 0;
    p.jitter = false;
    return p;
}

static bool times(const noc_scene *scene, const noc_camera *camera, int width, int height, int frames, noc_log *log) {
    static measured side[2];
    double pass[2][NOC_PASS_COUNT], cpu[2];
    noc_light_stats found;
    bool ok = true;
    for (int i = 0; i < 2; i++) {
        side[i].params =
            params_of(width, height, NOC_METHOD_RESTIR, i ? NOC_CANDIDATES_INFLUENCE : NOC_CANDIDATES_UNIFORM);
        side[i].r = own_view(scene, 0, log);
        ok = ok && side[i].r && noc_view_render(side[i].r, camera, &side[i].params, NULL) == NOC_OK;
    }
    for (int f = 0; ok && f < frames; f++)
        for (int i = 0; ok && i < 2; i++) {
            noc_frame_stats stats;
            ok = noc_view_render(side[i].r, camera, &side[i].params, NULL) == NOC_OK;
            noc_view_get_stats(side[i].r, &stats);
            side[i].cpu[f] = stats.cpu_seconds;
            for (int k = 0; k < NOC_PASS_COUNT; k++)
                side[i].pass[k][f] = stats.pass_seconds[k];
        }
    if (ok) {
        for (int i = 0; i < 2; i++) {
            cpu[i] = bench_median(side[i].cpu, frames);
            for (int k = 0; k < NOC_PASS_COUNT; k++)
                pass[i][k] = bench_median(side[i].pass[k], frames);
            printf("%-8s %8.1f CPU ms a frame |", i ? "influence" : "uniform", 1e3 * cpu[i]);
            for (int k = 0; k < NOC_PASS_COUNT; k++)
                if (pass[i][k] > 0)
                    printf(" %s %.1f", noc_pass_name((noc_pass)k), 1e3 * pass[i][k]);
            printf("\n");
        }
        noc_view_light_stats(side[1].r, &found);
        printf("frames %.3f, candidates %.3f of uniform's; S_r %.3f, found: median %u, 99%% %u, none %.2f%%\n",
               cpu[1] / cpu[0],
               (pass[1][NOC_PASS_FIND_LIGHTS] + pass[1][NOC_PASS_CANDIDATES_INFLUENCE]) /
                   pass[0][NOC_PASS_CANDIDATES_UNIFORM],
               found.influence, found.found_median, found.found_99, 100 * found.found_none);
    }
    for (int i = 0; i < 2; i++)
        close_view(side[i].r);
    return ok;
}

/* Mean and standard error of n values. */
typedef struct spread {
    double mean, error;
} spread;

static spread spread_of(const double *x, int n) {
    spread s = { 0, 0 };
    for (int i = 0; i < n; i++)
        s.mean += x[i] / n;
    for (int i = 0; i < n; i++)
        s.error += (x[i] - s.mean) * (x[i] - s.mean);
    s.error = n > 1 ? sqrt(s.error / (n - 1) / n) : 0;
    return s;
}

/* Volumes with one S_r. Errors of the mean of half of the frames, and of all of them, a seed each. */
enum { HALF, ALL, MOMENTS, MOST_SCALES = 16 };
typedef struct erring {
    noc_view *r;
    noc_render_params params;
    double rmse8[MOMENTS][MOST_SEEDS], relmse[MOMENTS][MOST_SEEDS], fastest; /* CPU s of a frame */
} erring;

static bool compare(erring *e, const noc_image *want, int moment, int seed, noc_log *log) {
    noc_compare_params c = noc_compare_default_params();
    noc_comparison figures = { 0 };
    noc_image *have = noc_view_image(e->r);
    bool ok = have && noc_image_compare(have, want, &c, &figures, log) == NOC_OK;
    noc_image_destroy(have);
    e->rmse8[moment][seed] = figures.all.rmse8;
    e->relmse[moment][seed] = figures.dark_clamped.relmse;
    return ok;
}

/* Frames of all of them in turn, so that they meet the same disturbances. */
static bool run_seed(erring *e, int n, const noc_camera *camera, const noc_image *want, int frames, int seed,
                     noc_log *log) {
    bool ok = true;
    for (int i = 0; i < n; i++) {
        e[i].params.seed = (uint32_t)seed + 1;
        noc_view_reset(e[i].r);
    }
    for (int f = 0; ok && f < frames; f++)
        for (int i = 0; ok && i < n; i++) {
            noc_frame_stats stats;
            ok = noc_view_render(e[i].r, camera, &e[i].params, NULL) == NOC_OK;
            noc_view_get_stats(e[i].r, &stats);
            e[i].fastest = fmin(e[i].fastest, stats.cpu_seconds);
            for (int moment = HALF; ok && moment <= ALL; moment++)
                if (f + 1 == (moment == HALF ? frames / 2 : frames))
                    ok = compare(&e[i], want, moment, seed, log);
        }
    return ok;
}

/* What the error of a mean of frames becomes in `time` times their CPU time, by how it fell from half of them to all.
 */
static double in_time(double half, double all, double time) {
    return all * pow(time, all > 0 && half > all ? log2(all / half) : 0);
}

static void print_erring(const erring *e, const erring *first, int seeds) {
    noc_light_stats found;
    spread rmse8[MOMENTS], relmse[MOMENTS];
    double time = first->fastest / e->fastest;
    noc_view_light_stats(e->r, &found);
    for (int m = 0; m < MOMENTS; m++) {
        rmse8[m] = spread_of(e->rmse8[m], seeds);
        relmse[m] = spread_of(e->relmse[m], seeds);
    }
    printf(
        "S_r %8.3f%s  RMSE-8 %6.2f +- %.2f  relMSE %.4f +- %.4f  %.1f CPU ms, the fastest frame | in the first one's "
        "time: %6.2f %.4f | found: median %u, 99%% %u, none %.2f%%\n",
        found.influence, e->params.influence > 0 ? "  " : " *", rmse8[ALL].mean, rmse8[ALL].error, relmse[ALL].mean,
        relmse[ALL].error, 1e3 * e->fastest, in_time(rmse8[HALF].mean, rmse8[ALL].mean, time),
        in_time(relmse[HALF].mean, relmse[ALL].mean, time), found.found_median, found.found_99, 100 * found.found_none);
}

static bool errors(const noc_scene *scene, const noc_camera *camera, noc_render_params p, const char *path, int frames,
                   int seeds, char **scales, noc_log *log) {
    static erring e[MOST_SCALES];
    bool linear, ok = true;
    int n = 0;
    noc_image *want = noc_image_read(path, log, &linear);
    if (!want)
        return false;
    for (; ok && scales[n]; n++) {
        e[n].params = p;
        e[n].params.influence = atof(scales[n]);
        e[n].fastest = INFINITY;
        e[n].r = own_view(scene, 1, log);
        ok = e[n].r && noc_view_render(e[n].r, camera, &e[n].params, NULL) == NOC_OK; /* builds the structures */
    }
    for (int seed = 0; ok && seed < seeds; seed++)
        ok = run_seed(e, n, camera, want, frames, seed, log);
    for (int i = 0; i < n; i++) {
        if (ok)
            print_erring(&e[i], &e[0], seeds);
        close_view(e[i].r);
    }
    noc_image_destroy(want);
    return ok;
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "city", *view = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 640, height = argc > 4 ? atoi(argv[4]) : 360;
    int frames = argc > 5 ? atoi(argv[5]) : 9;
    noc_method method = argc > 6 && !strcmp(argv[6], "restir") ? NOC_METHOD_RESTIR : NOC_METHOD_RIS;
    int seeds = argc > 8 ? atoi(argv[8]) : 1;
    if (width < 1 || height < 1 || frames < 1 || frames > MOST_FRAMES || argc == 7 || argc == 8 || seeds < 1 ||
        seeds > MOST_SEEDS) {
        fprintf(stderr,
                "usage: bench_influence [SCENE [VIEW [WIDTH HEIGHT [FRAMES [METHOD REFERENCE SEEDS S_R...]]]]]\n");
        return 2;
    }
    if (argc > 9 + MOST_SCALES) {
        fprintf(stderr, "bench_influence: %d values of S_r are given, and %d is the most that it compares\n", argc - 9,
                MOST_SCALES);
        return 2;
    }
    noc_log *log = bench_log();
    noc_scene *scene = bench_scene(spec, log);
    noc_camera camera;
    bool ok = scene && noc_scene_camera(scene, bench_view(view), (double)width / height, &camera) == NOC_OK;
    if (ok && argc > 8)
        ok = errors(scene, &camera, params_of(width, height, method, NOC_CANDIDATES_INFLUENCE), argv[7], frames, seeds,
                    argv + 9, log);
    else if (ok)
        ok = times(scene, &camera, width, height, frames, log);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return ok ? 0 : 1;
}
