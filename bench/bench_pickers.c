/* Light pickers: build times over random cities of lights, and what the point queries of a view find.
 *
 *   bench_pickers                                          build seconds and bytes a light, 1k to 1M lights
 *   bench_pickers SCENE VIEW [WIDTH HEIGHT [INFLUENCE]]    lights found a pixel: share that finds none, median, 99th percentile */
#include "bench_scene.h"

#include "backend/embree/embree.h"
#include "light/bound.h"

#include <math.h>

static float unit(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.f;
}

/* Windows on the fronts of blocks, and a lamp for every twenty of them. */
static noc_scene *random_city(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    uint32_t r = 5;
    double side = 3 * sqrt((double)lights);
    double floor[] = { 0, 0, 0, side, 0, 0, side, side, 0, 0, side, 0 };
    noc_material grey = { .albedo = { 0.3f, 0.3f, 0.3f }, .roughness = 1 };
    noc_mesh ground = { .vertex_count = 4, .positions = floor, .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 }, .material = noc_scene_add_material(s, &grey) };
    noc_scene_add_mesh(s, &ground);
    for (int i = 0; i < lights; i++) {
        double x = side * unit(&r), y = side * unit(&r), z = 2 + 20 * unit(&r);
        noc_light l = { .kind = i % 20 ? NOC_LIGHT_PARALLELOGRAM : NOC_LIGHT_SPHERE, .position = { x, y, i % 20 ? z : 6 },
                        .edge_u = { i & 1 ? 1.2 : 0, i & 1 ? 0 : 1.2, 0 }, .edge_v = { 0, 0, i & 2 ? 1.5 : -1.5 },
                        .radius = 0.15 };
        for (int k = 0; k < 3; k++)
            l.emission[k] = i % 20 ? 5 + 20 * unit(&r) : 8000;
        noc_scene_add_light(s, &l);
    }
    noc_scene_commit(s);
    return s;
}

static void builds(void) {
    printf("%9s %12s %12s %12s %12s %12s   bytes a light\n", "lights", "clusters, s", "power, s", "bvh, s", "S_r", "tree, s");
    for (int n = 1000; n <= 1000000; n *= 10) {
        noc_scene *s = random_city(n);
        double t0 = noc_cpu_seconds();
        noc_clusters *c = noc_clusters_create(s, NULL, NULL);
        double t1 = noc_cpu_seconds();
        noc_alias *a = noc_alias_create(s, NULL);
        double t2 = noc_cpu_seconds();
        noc_influence *v = noc_influence_create(s, NULL);
        double t3 = noc_cpu_seconds();
        noc_tree *t = noc_tree_create(s, NULL);
        double t4 = noc_cpu_seconds();
        if (c && a && v && t)
            printf("%9d %12.4f %12.4f %12.4f %12.3f %12.4f   %zu %zu %zu %zu (depth %d)\n", n, t1 - t0, t2 - t1, t3 - t2,
                   v->scale, t4 - t3, c->bytes / (size_t)n, a->bytes / (size_t)n, v->bytes / (size_t)n, t->bytes / (size_t)n,
                   t->depth);
        noc_tree_destroy(t);
        noc_clusters_destroy(c);
        noc_alias_destroy(a);
        noc_influence_destroy(v);
        noc_scene_destroy(s);
    }
}

static int by_value(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static int found(const char *spec, noc_view view, int width, int height, double scale) {
    noc_scene *s = bench_scene(spec, NULL);
    void *state = NULL;
    if (!s || noc_backend_embree.create(s, &(noc_renderer_params){ 0 }, NULL, &state) != NOC_OK)
        return 1;
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    noc_camera c;
    if (noc_scene_camera(s, view, (double)width / height, &c) != NOC_OK)
        return 1;
    noc_frame f = { .params = &p };
    noc_make_frame_camera(&c, &p, 0, &f.camera);
    noc_backend_embree.resize(state, width, height, 1);
    noc_stage primary = { .passes = 1u << NOC_PASS_PRIMARY };
    noc_backend_embree.stage(state, &f, &primary, NULL, 0, 1);
    noc_influence *v = noc_influence_create(s, NULL);
    const frame_buffers *b = &((embree_state *)state)->b;
    size_t blocks = (size_t)b->blocks_x * b->blocks_y, n = 0, none = 0;
    uint32_t *counts = noc_alloc(blocks * BLOCK * sizeof(*counts));
    noc_found found = { 0 };
    double start = noc_cpu_seconds(), near = 0;
    for (size_t i = 0; i < blocks; i++) {
        const gblock *g = &b->g[0][i];
        noc_query q = { { g->px, g->py, g->pz }, { g->nx, g->ny, g->nz }, lanes_with_surface(g), scale > 0 ? (float)scale : v->scale };
        noc_influence_query(v, &q, &found);
        near += (double)found.near.len;
        for (int l = 0; l < BLOCK; l++)
            if (q.lanes >> l & 1) {
                none += !found.count[l];
                counts[n++] = found.count[l];
            }
    }
    double spent = noc_cpu_seconds() - start;
    qsort(counts, n, sizeof(*counts), by_value);
    if (n)
        printf("S_r %.3f (found: %.3f), %zu pixels with a surface: %.3f%% find no light, median %u, 90%% %u, 99%% %u, most %u; queries %.2f s, "
               "%.1f lights near a block\n", scale > 0 ? scale : v->scale, v->scale, n, 100.0 * (double)none / (double)n, counts[n / 2],
               counts[n * 9 / 10], counts[n * 99 / 100], counts[n - 1], spent, near / (double)blocks);
    free(counts);
    noc_found_free(&found);
    noc_influence_destroy(v);
    noc_backend_embree.destroy(state);
    noc_scene_destroy(s);
    return 0;
}

int main(int argc, char **argv) {
    if (argc > 2)
        return found(argv[1], bench_view(argv[2]), argc > 4 ? atoi(argv[3]) : 960, argc > 4 ? atoi(argv[4]) : 540,
                     argc > 5 ? atof(argv[5]) : 0);
    builds();
    return 0;
}
