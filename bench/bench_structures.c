/* Light structures: build time and memory.
 *
 *   bench_structures [THREADS [MOST [NAME]]]     over random cities of 1k, 10k, ... up to MOST (1000000) lights
 *
 * NAME: only the structures whose names hold it. Wall and CPU seconds and bytes a light of the alias table (power),
 * influence volumes (influence: simple, shared by up to 8 lights, visibility-aware), the tree and the clusters of the
 * lists. CPU seconds are those of a small frame that builds the structure less those of one that finds it there.
 * Visibility-aware boxes are probed against a city of blocks. "share" is bytes over what the scene and its ray tracing
 * structure hold, which is little here: twelve triangles a block and a light for each ten metres of it. */
#include "bench_scene.h"
#include "../tests/own_view.h"

static float unit(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.f;
}

static void add_block(noc_scene *s, int material, double x, double y, double w, double h) {
    static const uint32_t faces[] = { 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6,
                                      3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7, 0, 2, 1, 0, 3, 2 };
    double xyz[24];
    for (int i = 0; i < 8; i++) {
        xyz[3 * i] = x + ((i & 3) == 1 || (i & 3) == 2 ? w : 0);
        xyz[3 * i + 1] = y + ((i & 3) >= 2 ? w : 0);
        xyz[3 * i + 2] = i >= 4 ? h : 0;
    }
    noc_mesh m = { .vertex_count = 8, .positions = xyz, .triangle_count = 12, .indices = faces, .material = material };
    noc_scene_add_mesh(s, &m);
}

/* Blocks of 20 m in a grid of 32 m, on each 19 windows and, beside it, a lamp. */
static noc_scene *random_city(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    uint32_t r = 5;
    int grey = noc_scene_add_material(s, &(noc_material){ .albedo = { 0.3f, 0.3f, 0.3f }, .roughness = 1 });
    int side = 1;
    while (20 * side * side < lights)
        side++;
    double edge = 32.0 * side, floor[] = { 0, 0, 0, edge, 0, 0, edge, edge, 0, 0, edge, 0 };
    noc_mesh ground = { .vertex_count = 4,
                        .positions = floor,
                        .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                        .material = grey };
    noc_scene_add_mesh(s, &ground);
    for (int i = 0; i < lights; i++) {
        int block = i / 20, lamp = i % 20 == 0;
        double x = 32.0 * (block % side), y = 32.0 * (block / side), along = 18 * unit(&r), up = 2 + 12 * unit(&r);
        if (lamp)
            add_block(s, grey, x, y, 20, 15);
        noc_light l = { .kind = lamp ? NOC_LIGHT_SPHERE : NOC_LIGHT_PARALLELOGRAM,
                        .radius = 0.15,
                        .edge_v = { 0, 0, 1.5 } };
        bool front = i & 1; /* faces -y; else +x */
        l.edge_u[front ? 0 : 1] = 1.2;
        l.position[0] = lamp ? x + 26 : front ? x + along : x + 20.02;
        l.position[1] = lamp ? y + along : front ? y - 0.02 : y + along;
        l.position[2] = lamp ? 6 : up;
        for (int k = 0; k < 3; k++)
            l.emission[k] = lamp ? 8000 : 5 + 20 * unit(&r);
        noc_scene_add_light(s, &l);
    }
    noc_scene_commit(s);
    return s;
}

typedef struct structure {
    const char *name;
    noc_candidates candidates;
    int share;
    noc_influence_boxes boxes;
} structure;

static const structure structures[] = {
    { "power", NOC_CANDIDATES_POWER, 1, NOC_INFLUENCE_SPHERE },
    { "influence", NOC_CANDIDATES_INFLUENCE, 1, NOC_INFLUENCE_SPHERE },
    { "influence, shared", NOC_CANDIDATES_INFLUENCE, 8, NOC_INFLUENCE_SPHERE },
    { "influence, visible", NOC_CANDIDATES_INFLUENCE, 1, NOC_INFLUENCE_VISIBLE },
    { "influence, both", NOC_CANDIDATES_INFLUENCE, 8, NOC_INFLUENCE_VISIBLE },
    { "light-bvh", NOC_CANDIDATES_LIGHT_BVH, 1, NOC_INFLUENCE_SPHERE },
    { "lists", NOC_CANDIDATES_LISTS, 1, NOC_INFLUENCE_SPHERE },
};
_Static_assert(sizeof(structures) / sizeof(*structures) == NOC_CANDIDATES_COUNT + 2,
               "every picker but uniform, and influence four times");

static bool row(const noc_scene *s, int threads, const structure *what) {
    noc_view *r = own_view(s, threads, NULL);
    noc_render_params p = noc_render_default_params();
    noc_camera c = { .eye = { 26, -10, 3 }, .target = { 26, 50, 3 }, .up = { 0, 0, 1 }, .fov_deg = 50 };
    p.width = p.height = 16;
    p.method = NOC_METHOD_RIS;
    p.candidates = what->candidates;
    p.influence_cluster = what->share;
    p.influence_boxes = what->boxes;
    noc_light_stats l = { 0 };
    noc_frame_stats frame[2] = { { 0 } };
    bool ok = r != NULL;
    for (int i = 0; ok && i < 2; i++) {
        ok = noc_view_render(r, &c, &p, NULL) == NOC_OK;
        if (ok)
            noc_view_get_stats(r, &frame[i]);
    }
    if (ok) {
        noc_view_light_stats(r, &l);
        printf("%9zu  %-14s %8.4f s wall %8.4f s CPU %7.1f bytes a light, share %5.2f%%", l.lights, what->name,
               l.build_seconds, frame[0].cpu_seconds - frame[1].cpu_seconds, (double)l.bytes / (double)l.lights,
               100.0 * (double)l.bytes / (double)l.scene_bytes);
        if (l.volumes)
            printf(", S_r %.2f, %zu volumes", l.influence, l.volumes);
        printf("\n");
        fflush(stdout);
    }
    close_view(r);
    return ok;
}

int main(int argc, char **argv) {
    int threads = argc > 1 ? atoi(argv[1]) : 0, most = argc > 2 ? atoi(argv[2]) : 1000000;
    const char *name = argc > 3 ? argv[3] : "";
    bool ok = threads >= 0;
    for (int n = 1000; ok && n <= most; n *= 10) {
        noc_scene *s = random_city(n);
        for (size_t i = 0; ok && i < sizeof(structures) / sizeof(*structures); i++)
            ok = !strstr(structures[i].name, name) || row(s, threads, &structures[i]);
        noc_scene_destroy(s);
    }
    return ok ? 0 : 1;
}
