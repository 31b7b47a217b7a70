/* What light structures cost when lights change: 200 cars with four lights each among windows and lamps.
 *
 *   bench_follow [LIGHTS [WIDTH HEIGHT]]     default: 100000 640 360
 *
 * CPU milliseconds, medians: a frame of `ris` of the scene at rest; what the light set takes to follow a commit that
 * moves all cars, one that switches all windows and lamps off, on, or dims them; and to be made from nothing. Shares
 * are those of the frame. The commit itself is not in them. Visibility-aware boxes are left out. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "light/set.h"

#include <math.h>

enum { CARS = 200, LAMPS = 4, ROUNDS = 9 };

static float unit(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.f;
}

static noc_light lamp_of(int car, int lamp, double time, double side) {
    double x = fmod(37.0 * car + 10 * time, side), y = 32.0 * (car % (int)(side / 32)) + 26;
    noc_light l = { .kind = NOC_LIGHT_SPOT,
                    .moving = true,
                    .position = { x + (lamp < 2 ? 4 : 0), y + (lamp & 1), 0.7 },
                    .direction = { lamp < 2 ? 1 : -1, 0, -0.1 },
                    .inner_deg = 15,
                    .outer_deg = 50 };
    for (int k = 0; k < 3; k++)
        l.emission[k] = lamp < 2 ? 8000 : k ? 10 : 150;
    return l;
}

/* Windows of 32 m of street after street, a lamp for every twenty, and cars between them. */
static noc_scene *city_with_cars(int lights, double side) {
    noc_scene *s = noc_scene_create(NULL);
    uint32_t r = 5;
    double corners[] = { 0, 0, 0, side, 0, 0, side, side, 0, 0, side, 0 };
    noc_material grey = { .albedo = { 0.3f, 0.3f, 0.3f }, .roughness = 1 };
    noc_mesh ground = { .vertex_count = 4,
                        .positions = corners,
                        .triangle_count = 2,
                        .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                        .material = noc_scene_add_material(s, &grey) };
    noc_scene_add_mesh(s, &ground);
    for (int i = 0; i < lights; i++) {
        bool lamp = i % 20 == 0;
        noc_light l = { .kind = lamp ? NOC_LIGHT_SPHERE : NOC_LIGHT_PARALLELOGRAM,
                        .position = { side * unit(&r), 32 * floor(side / 32 * unit(&r)), lamp ? 6 : 2 + 20 * unit(&r) },
                        .edge_u = { 1.2, 0, 0 },
                        .edge_v = { 0, 0, i & 1 ? 1.5 : -1.5 },
                        .radius = 0.15 };
        for (int k = 0; k < 3; k++)
            l.emission[k] = lamp ? 8000 : 5 + 20 * unit(&r);
        noc_scene_add_light(s, &l);
    }
    for (int i = 0; i < CARS * LAMPS; i++) {
        noc_light l = lamp_of(i / LAMPS, i % LAMPS, 0, side);
        noc_scene_add_light(s, &l);
    }
    noc_scene_commit(s);
    return s;
}

typedef struct picker {
    const char *name;
    noc_candidates candidates;
    int share;
} picker;

static const picker pickers[] = {
    { "power", NOC_CANDIDATES_POWER, 1 },
    { "influence", NOC_CANDIDATES_INFLUENCE, 1 },
    { "influence, shared", NOC_CANDIDATES_INFLUENCE, 8 },
    { "light-bvh", NOC_CANDIDATES_LIGHT_BVH, 1 },
    { "lists", NOC_CANDIDATES_LISTS, 1 },
};
_Static_assert(NOC_COUNT(pickers) == NOC_CANDIDATES_COUNT, "every picker but uniform, and influence twice");

typedef struct bench {
    noc_scene *scene;
    int lights;
    double side, time;
    noc_pool *pool;
    noc_render_params params;
} bench;

static double frame_ms(const bench *b) {
    double ms[ROUNDS] = { 0 };
    noc_view *v = own_view(b->scene, 0, NULL);
    noc_camera c = { .eye = { 40, 20, 12 }, .target = { 300, 300, 0 }, .up = { 0, 0, 1 }, .fov_deg = 50 };
    for (int i = -1; i < ROUNDS; i++) {
        noc_frame_stats stats;
        if (noc_view_render(v, &c, &b->params, NULL) != NOC_OK)
            exit(1);
        noc_view_get_stats(v, &stats);
        if (i >= 0)
            ms[i] = 1e3 * stats.cpu_seconds;
    }
    close_view(v);
    return bench_median(ms, ROUNDS);
}

static void move_cars(bench *b) {
    b->time += 0.1;
    for (int i = 0; i < CARS * LAMPS; i++) {
        noc_light l = lamp_of(i / LAMPS, i % LAMPS, b->time, b->side);
        if (noc_scene_move_light(b->scene, b->lights + i, &l) != NOC_OK)
            exit(1);
    }
}

static void light_windows(bench *b, float emission) {
    for (int i = 0; i < b->lights; i++)
        if (noc_scene_set_emission(b->scene, i, (float[3]){ emission, emission, emission }) != NOC_OK)
            exit(1);
}

enum { MOVED, SWITCHED, DIMMED, EDITS };

static void edit(bench *b, int what, int round) {
    if (what == MOVED)
        move_cars(b);
    else
        light_windows(b, what == DIMMED ? 10.f + (float)round : round & 1 ? 15 : 0);
    if (noc_scene_commit(b->scene) != NOC_OK)
        exit(1);
}

static double get_ms(const bench *b, noc_light_set *set, noc_light_sources *from) {
    double before = noc_cpu_seconds();
    if (noc_light_set_get(set, b->params.candidates, &b->params, from) != NOC_OK)
        exit(1);
    return 1e3 * (noc_cpu_seconds() - before);
}

static void row(bench *b, const picker *p) {
    double ms[EDITS][ROUNDS], made, frame;
    b->params.candidates = p->candidates;
    b->params.influence_cluster = p->share;
    frame = frame_ms(b);
    noc_light_set *set = noc_light_set_create(b->scene, b->pool, NULL, NULL, NULL);
    noc_light_sources from = { 0 };
    made = get_ms(b, set, &from);
    for (int what = 0; what < EDITS; what++)
        for (int i = 0; i < ROUNDS; i++) {
            edit(b, what, i);
            ms[what][i] = get_ms(b, set, &from);
        }
    noc_light_set_release(set, &from);
    noc_light_set_destroy(set);
    printf("%9d  %-18s frame %8.1f ms | moved", b->lights, p->name, frame);
    for (int what = 0; what < EDITS; what++) {
        double median = bench_median(ms[what], ROUNDS);
        printf(" %8.3f ms %6.2f%%%s", median, 100 * median / frame,
               what == MOVED      ? " | switched"
               : what == SWITCHED ? " | dimmed"
                                  : "");
    }
    printf(" | made %8.1f ms\n", made);
    fflush(stdout);
}

int main(int argc, char **argv) {
    bench b = { .lights = argc > 1 ? atoi(argv[1]) : 100000, .params = noc_render_default_params() };
    b.params.width = argc > 3 ? atoi(argv[2]) : 640;
    b.params.height = argc > 3 ? atoi(argv[3]) : 360;
    b.params.method = NOC_METHOD_RIS;
    if (b.lights < 1 || b.params.width < 1 || b.params.height < 1) {
        fprintf(stderr, "usage: bench_follow [LIGHTS [WIDTH HEIGHT]]\n");
        return 2;
    }
    b.side = fmax(64, 3 * sqrt((double)b.lights));
    b.scene = city_with_cars(b.lights, b.side);
    b.pool = noc_pool_create(0);
    for (size_t i = 0; i < sizeof(pickers) / sizeof(*pickers); i++)
        row(&b, &pickers[i]);
    noc_pool_destroy(b.pool);
    noc_scene_destroy(b.scene);
    return 0;
}
