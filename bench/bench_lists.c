/* Light lists: what building them costs, and how far one frame that uses them is from the truth.
 *
 *   bench_lists [SCENE [VIEW [WIDTH HEIGHT [FRAMES [REFERENCE.exr [REFERENCE_FRAMES]]]]]]
 *
 * SCENE may also be lamps:N, N windows and lamps on a plain of boxes. First the structure: seconds and bytes a light;
 * then microseconds a tile for the list alone, and for what its pixels do to choose among its entries (one thread, the
 * least and the median of FRAMES rounds over all tiles, where nothing is learned yet), as in both presets. With a
 * reference, relMSE of single frames of ris with one ray (mean over FRAMES seeds): of the choice alone (no shadows:
 * against the unshadowed truth) and of the picture, clamped to 10 cd/m2 and not. A reference that is not there yet is
 * rendered by lists of 128 + 128, REFERENCE_FRAMES of them, with and without shadows (REFERENCE.exr.free.exr). */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "../tests/backend/cpu_view.h"
#include "core/learned.h"
#include "core/random.h"

#include <math.h>
#include <unistd.h>

static float unit(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.f;
}

static void add_box(noc_scene *s, int material, double x, double y, double side, double height) {
    double p[24];
    for (int i = 0; i < 8; i++) {
        p[3 * i] = x + (i & 1 ? side : 0);
        p[3 * i + 1] = y + (i & 2 ? side : 0);
        p[3 * i + 2] = i & 4 ? height : 0;
    }
    noc_mesh m = { .vertex_count = 8,
                   .positions = p,
                   .triangle_count = 10,
                   .material = material,
                   .indices = (uint32_t[]){ 0, 1, 5, 0, 5, 4, 1, 3, 7, 1, 7, 5, 3, 2, 6,
                                            3, 6, 7, 2, 0, 4, 2, 4, 6, 4, 5, 7, 4, 7, 6 } };
    noc_scene_add_mesh(s, &m);
}

/* Boxes of 12 m on a grid of 25 m, a hundred lights each: windows on the four walls, one light in ten a lamp in the
 * street. */
static noc_scene *lamps(int lights, noc_log *log) {
    noc_scene *s = noc_scene_create(log);
    uint32_t r = 5;
    int boxes = (int)ceil(sqrt(lights / 100.0));
    double side = 25.0 * boxes;
    noc_material grey = { .albedo = { 0.3f, 0.3f, 0.3f }, .roughness = 1 };
    int material = noc_scene_add_material(s, &grey);
    noc_mesh ground = { .vertex_count = 4,
                        .positions = (double[]){ 0, 0, 0, side, 0, 0, side, side, 0, 0, side, 0 },
                        .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                        .material = material };
    noc_scene_add_mesh(s, &ground);
    for (int b = 0, i = 0; b < boxes * boxes; b++) {
        double x = 25.0 * (b % boxes) + 6, y = 25.0 * (b / boxes) + 6, height = 6 + 30 * unit(&r) * unit(&r);
        add_box(s, material, x, y, 12, height);
        for (int end = (int)((double)lights * (b + 1) / (boxes * boxes)); i < end; i++) {
            noc_light l = { .kind = i % 10 ? NOC_LIGHT_PARALLELOGRAM : NOC_LIGHT_SPHERE, .radius = 0.1 };
            double along = 11 * unit(&r), up = 1 + (height - 2.5) * unit(&r), out = 0.02;
            double at[4][2] = { { x + along, y - out },
                                { x + 12 + out, y + along },
                                { x + 12 - along, y + 12 + out },
                                { x - out, y + 12 - along } };
            double way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
            int wall = (int)(4 * unit(&r)) & 3;
            bool lamp = !(i % 10);
            l.position[0] = lamp ? x - 6 + 25 * unit(&r) : at[wall][0];
            l.position[1] = lamp ? y - 3 : at[wall][1];
            l.position[2] = lamp ? 5 : up;
            l.edge_u[0] = 0.9 * way[wall][0];
            l.edge_u[1] = 0.9 * way[wall][1];
            l.edge_v[2] = 1.2;
            for (int k = 0; k < 3; k++)
                l.emission[k] = lamp ? 3000 : 2 + 30 * unit(&r) * unit(&r);
            noc_scene_add_light(s, &l);
        }
    }
    return noc_scene_commit(s) == NOC_OK ? s : NULL;
}

static noc_render_params params_of(int width, int height, noc_method method, int list, bool shadows) {
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.method = method;
    p.candidates = NOC_CANDIDATES_LISTS;
    p.list = p.tail = list;
    p.final_ray = shadows;
    p.visibility_reuse = false;
    p.rays = 1;
    p.sky = 0;
    p.jitter = false; /* what is judged is light sampling, not the edges of surfaces */
    return p;
}

/* The rays of a tile's blocks over its list. */
static void share_tile(cpu_view *e, const struct core_context *frame, const gblock *const *g, const uint32_t *lanes,
                       int blocks) {
    struct core_context ctx = *frame;
    list_pass *lists = e->workers[0].lists;
    const light_list *list = &lists->build.list;
    priors *of = &lists->rays.cell[0].priors;
    ctx.at.lists = &lists->build;
    e->kernels->list_fill(&ctx);
    for (uint32_t i = 0, at = 0; i < list->count; i++, at = next_place(at, list->count)) {
        list_prior b = list_prior_of(list->weight[i], LEARNED_UNKNOWN);
        of->share[at] = b.share;
        of->expect[at] = b.expect;
    }
    for (int i = 0; i < blocks; i++)
        if (lanes[i] && list->count)
            e->kernels->list_share(&ctx, g[i], lanes[i], 4 * i, 0, 1, of, &lists->rays.asked);
}

/* Time of the lists alone: primary hits once, then every tile's list in one thread. */
static bool time_lists(const noc_scene *s, const noc_camera *camera, int width, int height, int rounds, int list,
                       int tail, int rays) {
    void *state = NULL;
    if (!(state = open_cpu_view(s, 0, NULL)))
        return false;
    cpu_view *e = state;
    noc_render_params p = params_of(width, height, NOC_METHOD_RIS, list, true);
    p.tail = tail;
    p.shadow_rays = rays;
    noc_plan plan = { .stages = { { .passes = { NOC_PASS_PRIMARY }, .count = 1 } },
                      .count = 1,
                      .draws = true,
                      .candidates = p.candidates };
    noc_frame f = { .params = &p, .plan = &plan };
    noc_make_frame_constants(&p, 0, false, &f.constants);
    noc_make_frame_camera(camera, &p, 0, &f.constants.camera);
    noc_backend_embree.resize(state, width, height, 1);
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    if (noc_cpu_prepare_lights(e, &plan, &p) != NOC_OK ||
        noc_backend_embree.stage(state, &f, &plan.stages[0], NULL, 0, 1) != NOC_OK)
        return false;
    wall = noc_wall_seconds();
    cpu = noc_cpu_seconds();
    noc_clusters *c = noc_clusters_create(s, NOC_STANDING, e->pool, NULL);
    wall = noc_wall_seconds() - wall;
    cpu = noc_cpu_seconds() - cpu;
    printf("%zu lights, %zu clusters: built in %.3f s (CPU %.3f s), %.1f bytes a light\n", s->lights.len, c->count,
           wall, cpu, (double)c->bytes / (double)s->lights.len);
    noc_clusters_destroy(c);
    const frame_buffers *b = &e->b;
    struct core_context ctx = { .frame = &f.constants,
                                .lights = s->lights.data,
                                .light_count = (uint32_t)s->lights.len,
                                .materials = s->material_records.data,
                                .clusters = { e->sources.clusters[0], e->sources.clusters[1] } };
    double *us = noc_alloc((size_t)rounds * sizeof(*us)), entries = 0;
    double *shared = noc_alloc((size_t)rounds * sizeof(*shared));
    list_pass *lists = e->workers[0].lists;
    size_t tiles = 0;
    for (int round = 0; round < rounds; round++) {
        double sharing = 0;
        tiles = 0;
        entries = 0;
        double start = noc_cpu_seconds();
        for (int t = 0; t < b->tiles_x * b->tiles_y; t++) {
            const gblock *g[TILE_BLOCKS * TILE_BLOCKS];
            uint32_t lanes[TILE_BLOCKS * TILE_BLOCKS], any = 0;
            int n = 0, x0 = t % b->tiles_x * TILE_BLOCKS, y0 = t / b->tiles_x * TILE_BLOCKS;
            for (int y = y0; y < NOC_MIN(y0 + TILE_BLOCKS, b->blocks_y); y++)
                for (int x = x0; x < NOC_MIN(x0 + TILE_BLOCKS, b->blocks_x); x++, n++) {
                    g[n] = &b->g[0][(size_t)y * (size_t)b->blocks_x + (size_t)x];
                    lanes[n] = lanes_with_surface(g[n]);
                    any |= lanes[n];
                }
            if (!any)
                continue;
            u32 key = rng_key(1, (uint32_t)t, (uint32_t)round);
            e->kernels->list_build(&ctx, g, lanes, n, rng_bits(key, DIM_LIST), &lists->build);
            entries += lists->build.list.count;
            tiles++;
            double before = noc_cpu_seconds();
            share_tile(e, &ctx, g, lanes, n);
            sharing += noc_cpu_seconds() - before;
        }
        us[round] = 1e6 * (noc_cpu_seconds() - start - sharing) / (double)NOC_MAX(tiles, 1);
        shared[round] = 1e6 * sharing / (double)NOC_MAX(tiles, 1);
    }
    qsort(us, (size_t)rounds, sizeof(*us), bench_by_size);
    qsort(shared, (size_t)rounds, sizeof(*shared), bench_by_size);
    printf("%zu tiles, %.1f entries each: built in %.2f (%.2f) us a tile, rays shared out in %.2f (%.2f) (%s)\n", tiles,
           entries / (double)NOC_MAX(tiles, 1), us[0], us[rounds / 2], shared[0], shared[rounds / 2], e->kernels->name);
    free(us);
    free(shared);
    close_cpu_view(state);
    return true;
}

static noc_image *reference(const noc_scene *s, const noc_camera *camera, int width, int height, int frames,
                            const char *path, bool shadows, noc_log *log) {
    bool linear;
    if (!access(path, R_OK))
        return noc_image_read(path, log, &linear);
    noc_render_params p = params_of(width, height, NOC_METHOD_RIS, 128, shadows);
    p.seed = 4711;
    noc_view *r = own_view(s, 0, log);
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

static void errors(const noc_scene *s, const noc_camera *camera, const noc_render_params *params, const noc_image *want,
                   int frames, const char *name, noc_log *log) {
    noc_render_params p = *params;
    noc_view *r = own_view(s, 0, log);
    double clamped = 0, raw = 0, bias = 0, cpu = 0;
    int done = 0;
    for (; r && done < frames; done++) {
        p.seed = (uint32_t)done + 1;
        if (noc_view_render(r, camera, &p, NULL) != NOC_OK)
            break;
        noc_image *have = noc_view_image(r);
        noc_compare_params c = noc_compare_default_params();
        noc_comparison figures = { 0 };
        noc_image_compare(have, want, &c, &figures, log);
        noc_image_destroy(have);
        noc_frame_stats stats;
        noc_view_get_stats(r, &stats);
        clamped += figures.dark_clamped.relmse;
        raw += figures.dark.relmse;
        bias += figures.dark.bias;
        cpu += stats.cpu_seconds;
    }
    if (done)
        printf("%-22s relMSE %.4f (unclamped %.4f), bias %+.2f%%, %.0f ms CPU a frame\n", name, clamped / done,
               raw / done, 100 * (bias / done - 1), 1e3 * cpu / done);
    fflush(stdout);
    close_view(r);
}

int main(int argc, char **argv) {
    const char *spec = argc > 1 ? argv[1] : "city", *view = argc > 2 ? argv[2] : "street";
    int width = argc > 4 ? atoi(argv[3]) : 960, height = argc > 4 ? atoi(argv[4]) : 540;
    int frames = argc > 5 ? atoi(argv[5]) : 5, most = argc > 7 ? atoi(argv[7]) : 256;
    if (width < 1 || height < 1 || frames < 1 || most < 1) {
        fprintf(stderr,
                "usage: bench_lists [SCENE [VIEW [WIDTH HEIGHT [FRAMES [REFERENCE.exr [REFERENCE_FRAMES]]]]]]\n");
        return 2;
    }
    noc_log *log = bench_log();
    noc_scene *s =
        strncmp(spec, "lamps:", 6) ? bench_scene(spec, log) : lamps(NOC_CLAMP(atoi(spec + 6), 1, 50000000), log);
    noc_camera camera;
    bool ok = s && noc_scene_camera(s, bench_view(view), (double)width / height, &camera) == NOC_OK &&
              time_lists(s, &camera, width, height, frames, 32, 32, 4) &&
              time_lists(s, &camera, width, height, frames, 64, 128, 8);
    for (int shadows = 0; ok && argc > 6 && shadows < 2; shadows++) {
        char *path = noc_format(shadows ? "%s" : "%s.free.exr", argv[6]);
        noc_image *want = reference(s, &camera, width, height, most, path, shadows, log);
        free(path);
        if (!(ok = want != NULL))
            break;
        noc_render_params lists = params_of(width, height, NOC_METHOD_RIS, 32, shadows);
        noc_render_params all = params_of(width, height, NOC_METHOD_REFERENCE, 32, shadows);
        errors(s, &camera, &lists, want, frames, shadows ? "32 + 32, one ray" : "32 + 32, no shadows", log);
        if (s->lights.len * (size_t)width * (size_t)height < 4000000000u)
            errors(s, &camera, &all, want, frames, shadows ? "all lights, one ray" : "all lights, no shadows", log);
        noc_image_destroy(want);
    }
    noc_scene_destroy(s);
    noc_log_destroy(log);
    return ok ? 0 : 1;
}
