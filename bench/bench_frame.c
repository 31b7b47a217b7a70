/* Time of a frame by pass, the trace floor, and their ratio.
 *
 *   bench_frame [SCENE [VIEW [WIDTH HEIGHT [FRAMES [VARIANT]]]]]     default: city street 1920 1080 4, all variants
 *
 * VARIANT: only those whose name holds it. M = 32, k = 5, no sky, uniform candidates unless the name says another
 * picker (lists: 32 + 32). Wall seconds are the median over the frames after the first (which has no history); pass
 * times are thread seconds. The floor is traced after each frame from the very rays of that frame. */
#include "bench_scene.h"
#include "../tests/own_view.h"

typedef struct variant {
    const char *name;
    noc_method method;
    noc_bias bias;
    bool rays, spatial, temporal;
    noc_isa isa;
    noc_candidates candidates;
} variant;

static const variant variants[] = {
    { "ris", NOC_METHOD_RIS },
    { "restir biased", NOC_METHOD_RESTIR, NOC_BIAS_BIASED, false, true, true },
    { "restir mis", NOC_METHOD_RESTIR, NOC_BIAS_MIS, false, true, true },
    { "restir pairwise", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, false, true, true },
    { "restir mis + rays", NOC_METHOD_RESTIR, NOC_BIAS_MIS, true, true, true },
    { "restir pairwise + rays", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, true, true },
    { "restir pairwise, influence", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, false, true, true,
      .candidates = NOC_CANDIDATES_INFLUENCE },
    { "pairwise + rays, influence", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, true, true,
      .candidates = NOC_CANDIDATES_INFLUENCE },
    { "restir pairwise, power", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, false, true, true,
      .candidates = NOC_CANDIDATES_POWER },
    { "restir pairwise, light-bvh", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, false, true, true,
      .candidates = NOC_CANDIDATES_LIGHT_BVH },
    { "ris, lists", NOC_METHOD_RIS, .candidates = NOC_CANDIDATES_LISTS },
    { "pairwise + rays, lists", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, true, true,
      .candidates = NOC_CANDIDATES_LISTS },
    { "restir pairwise, scalar", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, false, true, true, NOC_ISA_SCALAR },
};

static bool measure(const noc_scene *scene, const noc_camera *camera, const variant *v, int width, int height,
                    int frames) {
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.method = v->method;
    p.bias = v->bias;
    p.bias_rays = v->rays;
    p.spatial = v->spatial;
    p.temporal = v->temporal;
    p.isa = v->isa;
    p.candidates = v->candidates;
    p.sky = 0;
    noc_view *r = own_view(scene, 0, NULL);
    noc_trace_floor traced;
    double wall[64], floor[64], pass[NOC_PASS_COUNT] = { 0 };
    noc_frame_stats stats;
    bool ok = r && noc_view_render(r, camera, &p, NULL) == NOC_OK;
    for (int i = 0; ok && i < frames; i++) {
        ok = noc_view_render(r, camera, &p, NULL) == NOC_OK;
        noc_view_get_stats(r, &stats);
        wall[i] = stats.wall_seconds;
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            pass[k] += stats.pass_seconds[k] / frames;
        ok = ok && noc_view_trace_floor(r, camera, &p, NULL, &traced) == NOC_OK;
        floor[i] = traced.wall_seconds;
    }
    if (ok) {
        double w = bench_median(wall, frames), f = bench_median(floor, frames), total = 0;
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            total += pass[k];
        printf("%-26s %7.1f ms  floor %7.1f ms  ratio %4.2f  %5.1f M rays  %s |", v->name, 1e3 * w, 1e3 * f, w / f,
               1e-6 * (double)(stats.rays_primary + stats.rays_shadow), stats.path);
        for (int k = 0; k < NOC_PASS_COUNT; k++)
            if (pass[k] > 0)
                printf(" %s %.0f%% %.0f ms", noc_pass_name((noc_pass)k), 100 * pass[k] / total, 1e3 * pass[k]);
        printf("\n");
        fflush(stdout);
    }
    close_view(r);
    return ok;
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "city", *view = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 1920, height = argc > 4 ? atoi(argv[4]) : 1080;
    int frames = argc > 5 ? atoi(argv[5]) : 4;
    const char *only = argc > 6 ? argv[6] : "";
    if (width < 1 || height < 1 || frames < 1 || frames > 64) {
        fprintf(stderr, "usage: bench_frame [SCENE [VIEW [WIDTH HEIGHT [FRAMES [VARIANT]]]]]\n");
        return 2;
    }
    noc_log *log = bench_log();
    noc_scene *scene = bench_scene(spec, log);
    noc_camera camera;
    if (!scene || noc_scene_camera(scene, bench_view(view), (double)width / height, &camera) != NOC_OK)
        return 1;
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    noc_view *r = own_view(scene, 0, log);
    noc_frame_stats stats;
    if (!r)
        return 1;
    noc_view_get_stats(r, &stats);
    printf("%s, %s, %d x %d: %zu triangles, %zu lights, built in %.0f ms\n", spec, view, width, height, info.triangles,
           info.lights, 1e3 * stats.build_seconds);
    close_view(r);
    bool ok = true;
    for (size_t i = 0; ok && i < sizeof(variants) / sizeof(variants[0]); i++)
        ok = !strstr(variants[i].name, only) || measure(scene, &camera, &variants[i], width, height, frames);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return ok ? 0 : 1;
}
