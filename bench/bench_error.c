/* Error against the reference by method and frame.
 *
 *   bench_error [SCENE [VIEW [WIDTH HEIGHT [REFERENCE_FRAMES [CACHE [NAME]]]]]]
 *
 * default: city street 480 270 64 build
 *
 * NAME: only the variants whose names hold it. Figures: RMSE-8 and relMSE clamped to 10 cd/m2, and unclamped bias
 * (docs/estimator.md, "Error figures") on pixels that see no emitter, after 1, 2, 4, 8, 16 and 32 frames: accumulated,
 * and of that frame alone. Candidates are uniform where the name does not say what else. The reference is kept as EXR
 * in the CACHE folder under a name made of everything that it depends on: scene content, camera, size and frames. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "render/backend.h"

#include <unistd.h>

enum { STEPS = 6 };
static const int steps[STEPS] = { 1, 2, 4, 8, 16, 32 };

typedef struct variant {
    const char *name;
    noc_method method;
    noc_bias bias;
    bool rays, no_temporal;
    noc_candidates candidates;
} variant;

static const variant variants[] = {
    { "is", NOC_METHOD_IS },
    { "ris", NOC_METHOD_RIS },
    { "restir biased", NOC_METHOD_RESTIR, NOC_BIAS_BIASED },
    { "restir mis", NOC_METHOD_RESTIR, NOC_BIAS_MIS },
    { "restir mis + rays", NOC_METHOD_RESTIR, NOC_BIAS_MIS, true },
    { "restir counted", NOC_METHOD_RESTIR, NOC_BIAS_COUNTED },
    { "restir counted + rays", NOC_METHOD_RESTIR, NOC_BIAS_COUNTED, true },
    { "restir pairwise", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE },
    { "restir pairwise + rays", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true },
    { "spatial pairwise + rays", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, true },
    { "ris, power", NOC_METHOD_RIS, .candidates = NOC_CANDIDATES_POWER },
    { "ris, influence", NOC_METHOD_RIS, .candidates = NOC_CANDIDATES_INFLUENCE },
    { "ris, light-bvh", NOC_METHOD_RIS, .candidates = NOC_CANDIDATES_LIGHT_BVH },
    { "pairwise + rays, influence", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true,
      .candidates = NOC_CANDIDATES_INFLUENCE },
    { "ris, lists", NOC_METHOD_RIS, .candidates = NOC_CANDIDATES_LISTS },
    { "pairwise + rays, lists", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, .candidates = NOC_CANDIDATES_LISTS },
    { "spatial p. + rays, lists", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, true, true, NOC_CANDIDATES_LISTS },
};
_Static_assert(NOC_COUNT(variants) == NOC_CANDIDATES_COUNT + 12, "ris of every picker, and the other methods");

static uint64_t mix(uint64_t h, const void *data, size_t size) {
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 0x100000001b3u;
    return h;
}

static uint64_t content(const noc_scene *s, const noc_camera *c, const noc_render_params *p, int frames) {
    uint64_t h = mix(0xcbf29ce484222325u, s->positions.data, s->positions.len * sizeof(float));
    h = mix(h, s->indices.data, s->indices.len * sizeof(uint32_t));
    h = mix(h, s->triangle_material.data, s->triangle_material.len * sizeof(uint32_t));
    h = mix(h, s->material_records.data, s->material_records.len * sizeof(noc_material_record));
    h = mix(h, s->lights.data, s->lights.len * sizeof(noc_light_record));
    h = mix(h, c->eye, sizeof(c->eye));
    h = mix(h, c->target, sizeof(c->target));
    h = mix(h, c->up, sizeof(c->up));
    h = mix(h, &c->fov_deg, sizeof(c->fov_deg));
    int numbers[] = { p->width, p->height, p->rays, frames };
    return mix(h, numbers, sizeof(numbers));
}

static noc_render_params params_of(const variant *v, int width, int height) {
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.sky = 0;
    p.jitter = false; /* what is judged is light sampling, not the edges of surfaces */
    if (v) {
        p.method = v->method;
        p.bias = v->bias;
        p.bias_rays = v->rays;
        p.candidates = v->candidates;
        p.temporal = !v->no_temporal;
    }
    return p;
}

static noc_image *reference(const noc_scene *scene, const noc_camera *camera, int width, int height, int frames,
                            const char *cache, noc_log *log) {
    noc_render_params p = params_of(NULL, width, height);
    p.method = NOC_METHOD_REFERENCE;
    p.seed = 4711;
    char path[4096];
    snprintf(path, sizeof(path), "%s/reference-%016llx.exr", cache,
             (unsigned long long)content(scene, camera, &p, frames));
    if (!access(path, R_OK)) {
        bool linear;
        return noc_image_read(path, log, &linear);
    }
    fprintf(stderr, "rendering the reference into %s\n", path);
    noc_view *r = own_view(scene, 0, log);
    bool ok = r != NULL;
    for (int i = 0; ok && i < frames; i++)
        ok = noc_view_render(r, camera, &p, NULL) == NOC_OK;
    noc_image *image = ok ? noc_view_image(r) : NULL;
    noc_display_params display = noc_display_default_params();
    if (image)
        noc_image_write(image, path, &display, NULL, log);
    close_view(r);
    return image;
}

static bool compare(noc_view *r, const noc_image *want, noc_metrics *out, noc_log *log) {
    noc_compare_params c = noc_compare_default_params();
    noc_comparison figures = { 0 };
    noc_image *have = noc_view_image(r);
    bool ok = have && noc_image_compare(have, want, &c, &figures, log) == NOC_OK;
    noc_image_destroy(have);
    *out = figures.dark_clamped;
    out->bias = figures.dark.bias; /* clamping takes away what rare bright samples carry */
    return ok;
}

static bool measure(const noc_scene *scene, const noc_camera *camera, const variant *v, const noc_image *want,
                    noc_log *log) {
    noc_metrics figures[2][STEPS];
    double cpu = 0;
    for (int alone = 0; alone < 2; alone++) {
        noc_render_params p = params_of(v, want->width, want->height);
        p.accumulate = !alone;
        noc_view *r = own_view(scene, 0, log);
        bool ok = r != NULL;
        for (int frame = 1, at = 0; ok && at < STEPS; frame++) {
            ok = noc_view_render(r, camera, &p, NULL) == NOC_OK;
            noc_frame_stats stats;
            noc_view_get_stats(r, &stats);
            cpu += stats.cpu_seconds / (2 * steps[STEPS - 1]);
            if (ok && frame == steps[at])
                ok = compare(r, want, &figures[alone][at++], log);
        }
        close_view(r);
        if (!ok)
            return false;
    }
    for (int alone = 0; alone < 2; alone++) {
        printf("%-24s %-11s", alone ? "" : v->name, alone ? "frame alone" : "accumulated");
        for (int i = 0; i < STEPS; i++)
            printf(" | %5.1f %7.4f %+6.1f%%", figures[alone][i].rmse8, figures[alone][i].relmse,
                   100 * (figures[alone][i].bias - 1));
        printf(alone ? "\n" : " | %.0f ms CPU a frame\n", 1e3 * cpu);
    }
    fflush(stdout);
    return true;
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "city", *view = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 480, height = argc > 4 ? atoi(argv[4]) : 270;
    int frames = argc > 5 ? atoi(argv[5]) : 64;
    const char *cache = argc > 6 ? argv[6] : "build";
    if (width < 1 || height < 1 || frames < 1) {
        fprintf(stderr, "usage: bench_error [SCENE [VIEW [WIDTH HEIGHT [REFERENCE_FRAMES [CACHE [NAME]]]]]]\n");
        return 2;
    }
    noc_log *log = bench_log();
    noc_scene *scene = bench_scene(spec, log);
    noc_camera camera;
    if (!scene || noc_scene_camera(scene, bench_view(view), (double)width / height, &camera) != NOC_OK)
        return 1;
    noc_image *want = reference(scene, &camera, width, height, frames, cache, log);
    bool ok = want != NULL;
    if (ok)
        printf("%s, %s, %d x %d: RMSE-8, relMSE, bias after 1, 2, 4, 8, 16, 32 frames\n", spec, view, width, height);
    for (size_t i = 0; ok && i < sizeof(variants) / sizeof(variants[0]); i++)
        ok = !strstr(variants[i].name, argc > 7 ? argv[7] : "") || measure(scene, &camera, &variants[i], want, log);
    noc_image_destroy(want);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return ok ? 0 : 1;
}
