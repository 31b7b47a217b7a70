/* Light pickers: CPU seconds and bytes a light of their structures, over random cities of 1k to 1M lights. */
#include "bench_scene.h"

#include "base/base.h"
#include "light/alias.h"
#include "light/clusters.h"
#include "light/influence.h"
#include "light/tree.h"

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
    noc_mesh ground = { .vertex_count = 4,
                        .positions = floor,
                        .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                        .material = noc_scene_add_material(s, &grey) };
    noc_scene_add_mesh(s, &ground);
    for (int i = 0; i < lights; i++) {
        double x = side * unit(&r), y = side * unit(&r), z = 2 + 20 * unit(&r);
        noc_light l = { .kind = i % 20 ? NOC_LIGHT_PARALLELOGRAM : NOC_LIGHT_SPHERE,
                        .position = { x, y, i % 20 ? z : 6 },
                        .edge_u = { i & 1 ? 1.2 : 0, i & 1 ? 0 : 1.2, 0 },
                        .edge_v = { 0, 0, i & 2 ? 1.5 : -1.5 },
                        .radius = 0.15 };
        for (int k = 0; k < 3; k++)
            l.emission[k] = i % 20 ? 5 + 20 * unit(&r) : 8000;
        noc_scene_add_light(s, &l);
    }
    noc_scene_commit(s);
    return s;
}

static void builds(void) {
    noc_pool *pool = noc_pool_create(0);
    printf("%9s %12s %12s %12s %12s %12s %12s   bytes a light\n", "lights", "clusters, s", "power, s", "influence, s",
           "S_r", "tree, s", "wall");
    for (int n = 1000; n <= 1000000; n *= 10) {
        noc_scene *s = random_city(n);
        double t0 = noc_cpu_seconds();
        noc_clusters *c = noc_clusters_create(s, NOC_STANDING, NULL, NULL);
        double t1 = noc_cpu_seconds();
        noc_alias *a = noc_alias_create(s, NULL);
        double t2 = noc_cpu_seconds();
        noc_influence *v = noc_influence_create(s, NULL, NULL);
        double t3 = noc_cpu_seconds();
        double wall = noc_wall_seconds();
        noc_tree *t = noc_tree_create(s, pool, NULL);
        double t4 = noc_cpu_seconds();
        wall = noc_wall_seconds() - wall;
        if (c && a && v && t)
            printf("%9d %12.4f %12.4f %12.4f %12.3f %12.4f %12.4f   %zu %zu %zu %zu (depth %d)\n", n, t1 - t0, t2 - t1,
                   t3 - t2, v->scale, t4 - t3, wall, c->bytes / (size_t)n, a->bytes / (size_t)n, v->bytes / (size_t)n,
                   t->bytes / (size_t)n, t->depth);
        noc_tree_destroy(t);
        noc_clusters_destroy(c);
        noc_alias_destroy(a);
        noc_influence_destroy(v);
        noc_scene_destroy(s);
    }
    noc_pool_destroy(pool);
}

int main(void) {
    builds();
    return 0;
}
