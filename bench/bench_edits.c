/* What edits of a scene cost: the commit, and what the next frame takes beyond the one after it, in CPU ms.
 *
 *   bench_edits [SCENE [WIDTH HEIGHT [ROUNDS [CANDIDATES [METHOD]]]]]     default: city 640 360 5 lists ris
 *
 * SCENE is city, city:METRES or mess:LIGHTS, with 200 cars of four lights each around the camera and every second other
 * light in a group. Medians over the rounds. */
#include "bench_scene.h"
#include "../tests/own_view.h"

#include "scene/scene.h"
#include <nocturne/option.h>

#include <math.h>

enum { CARS = 200, MOST = 64 };

typedef struct bench {
    noc_scene *scene;
    noc_camera camera;
    noc_view *view;
    noc_render_params params;
    double z[CARS]; /* of the ground below them */
    int group, cars[CARS], mesh, lamp, base_mesh, round;
    uint32_t windows;
} bench;

static bool make_car(noc_scene *s, int *model) {
    static const double corners[8][3] = { { -2, -.9, .3 },  { 2, -.9, .3 },  { 2, .9, .3 },  { -2, .9, .3 },
                                          { -2, -.9, 1.5 }, { 2, -.9, 1.5 }, { 2, .9, 1.5 }, { -2, .9, 1.5 } };
    static const uint32_t faces[36] = { 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6,
                                        3, 0, 4, 3, 4, 7, 4, 5, 6, 4, 6, 7, 0, 3, 2, 0, 2, 1 };
    noc_material paint = noc_class_material(NOC_CLASS_VEHICLE);
    *model = noc_scene_add_model(s, "car");
    noc_mesh body = { .vertex_count = 8,
                      .positions = corners[0],
                      .triangle_count = 12,
                      .indices = faces,
                      .material = noc_scene_add_material(s, &paint),
                      .model = *model };
    bool ok = *model > 0 && noc_scene_add_mesh(s, &body) >= 0;
    for (int i = 0; ok && i < 4; i++) {
        bool ahead = i < 2;
        noc_light lamp = { .kind = NOC_LIGHT_DISC,
                           .position = { ahead ? 2.02 : -2.02, i % 2 ? -.7 : .7, .7 },
                           .direction = { ahead ? 1 : -1, 0, -.05 },
                           .radius = .08,
                           .emission = { ahead ? 20000 : 800, ahead ? 19000 : 20, ahead ? 16000 : 10 },
                           .model = *model };
        ok = noc_scene_add_light(s, &lamp) >= 0;
    }
    return ok;
}

/* Cars on a grid around the place that is looked at, further on from round to round. */
static void place(bench *b, int car, double out[12]) {
    double yaw = .4 * car, c = cos(yaw), s = sin(yaw), x = b->camera.target[0] + 7 * (car % 20 - 10),
           y = b->camera.target[1] + 7 * (car / 20 - 5), on = .4 * b->round;
    if (!b->view)
        noc_scene_ground(b->scene, x, y,
                         &b->z[car]); /* asked once: edits may have the next query make its grids anew */
    double rows[12] = { c, -s, 0, x + on, s, c, 0, y, 0, 0, 1, b->z[car] };
    memcpy(out, rows, sizeof(rows));
}

static bool open_scene(bench *b, const char *spec) {
    noc_builtin_params params = noc_builtin_default_params();
    const char *number = strchr(spec, ':');
    bool city = !strncmp(spec, "city", 4);
    int model;
    if (number && city)
        params.city.size = atof(number + 1);
    else if (number)
        params.lights = atoi(number + 1);
    noc_scene *s = b->scene = noc_scene_create(bench_log());
    if (!s || noc_scene_add_builtin(s, city ? "city" : "mess", &params) != NOC_OK || !make_car(s, &model))
        return false;
    b->group = noc_scene_add_group(s, "windows");
    for (size_t i = 0; i < s->lights.len; i += 2, b->windows++) /* as if they had been added so */
        s->lights.data[i].flags |= (uint32_t)b->group << NOC_LIGHT_GROUP;
    b->base_mesh = 0;
    if (noc_scene_commit(s) != NOC_OK ||
        noc_scene_camera(s, city ? NOC_VIEWPOINT_STREET : NOC_VIEWPOINT_OWN, 16 / 9., &b->camera) != NOC_OK)
        return false;
    bool ok = true;
    for (int i = 0; ok && i < CARS; i++) {
        noc_instance in = { .model = model };
        place(b, i, in.transform);
        ok = (b->cars[i] = noc_scene_add_instance(s, &in)) >= 0;
    }
    return ok && noc_scene_commit(s) == NOC_OK;
}

/* ---- edits, each back or on with every round ---- */

static bool none(bench *b) { return b != NULL; }

static bool camera(bench *b) {
    b->camera.eye[0] += .05;
    return true;
}

static bool one_light(bench *b) {
    return noc_scene_set_emission(b->scene, 1, (float[3]){ 100 + (float)b->round, 90, 50 }) == NOC_OK;
}

static bool a_group(bench *b) {
    float scale = b->round % 2 ? 1 : .3f;
    return noc_scene_set_group(b->scene, b->group, (float[3]){ scale, scale, scale }) == NOC_OK;
}

static bool a_class(bench *b) {
    noc_material m = noc_class_material(NOC_CLASS_WALL);
    m.albedo[0] = b->round % 2 ? .2f : .6f;
    return noc_scene_set_class_material(b->scene, NOC_CLASS_WALL, &m) == NOC_OK;
}

static bool a_car(bench *b) {
    double to[12];
    place(b, 0, to);
    return noc_scene_set_transform(b->scene, b->cars[0], to) == NOC_OK;
}

static bool all_cars(bench *b) {
    double to[12];
    for (int i = 0; i < CARS; i++) {
        place(b, i, to);
        if (noc_scene_set_transform(b->scene, b->cars[i], to) != NOC_OK)
            return false;
    }
    return true;
}

static bool add_mesh(bench *b) {
    double x = b->camera.target[0], y = b->camera.target[1], z = b->camera.target[2];
    double corners[9] = { x, y, z, x + 1, y, z, x, y + 1 + b->round, z + 1 };
    noc_mesh m = {
        .vertex_count = 3, .positions = corners, .triangle_count = 1, .indices = (uint32_t[]){ 0, 1, 2 }, .material = 0
    };
    return (b->mesh = noc_scene_add_mesh(b->scene, &m)) >= 0;
}

static bool remove_added(bench *b) { return noc_scene_remove_mesh(b->scene, b->mesh) == NOC_OK; }

static bool add_lamp(bench *b) {
    noc_light l = { .kind = NOC_LIGHT_SPHERE, .radius = .2, .emission = { 900, 800, 500 } };
    memcpy(l.position, b->camera.target, sizeof(l.position));
    return (b->lamp = noc_scene_add_light(b->scene, &l)) >= 0;
}

static bool remove_lamp(bench *b) { return noc_scene_remove_light(b->scene, b->lamp) == NOC_OK; }

static bool remove_first(bench *b) {
    while (noc_scene_remove_mesh(b->scene, b->base_mesh) != NOC_OK) /* those that show lights go with them */
        b->base_mesh++;
    b->base_mesh++;
    return true;
}

static const struct {
    const char *name;
    bool (*edit)(bench *b);
} edits[] = {
    { "none", none },
    { "camera moved", camera },
    { "emission of one light", one_light },
    { "a group of half of the lights", a_group },
    { "material of a class", a_class },
    { "one car of 200 moved", a_car },
    { "200 cars moved", all_cars },
    { "mesh added", add_mesh },
    { "that mesh removed", remove_added },
    { "lamp with a shape added", add_lamp },
    { "that lamp removed", remove_lamp },
    { "mesh of the start removed", remove_first },
};

static double frame(bench *b) {
    double start = noc_cpu_seconds();
    return noc_view_render(b->view, &b->camera, &b->params, NULL) == NOC_OK ? noc_cpu_seconds() - start : NAN;
}

static bool measure(bench *b, int rounds) {
    enum { ROWS = sizeof(edits) / sizeof(edits[0]) };
    static double commit[ROWS][MOST], next[ROWS][MOST], after[ROWS][MOST];
    for (b->round = 0; b->round < rounds; b->round++)
        for (size_t i = 0; i < ROWS; i++) {
            double start = noc_cpu_seconds();
            if (!edits[i].edit(b) || noc_scene_commit(b->scene) != NOC_OK)
                return false;
            commit[i][b->round] = noc_cpu_seconds() - start;
            next[i][b->round] = frame(b);
            after[i][b->round] = frame(b);
        }
    for (size_t i = 0; i < ROWS; i++) {
        double c = bench_median(commit[i], rounds), n = bench_median(next[i], rounds),
               a = bench_median(after[i], rounds);
        printf("| %-30s | %8.2f | %8.1f | %8.1f | %+8.1f |\n", edits[i].name, 1e3 * c, 1e3 * n, 1e3 * a, 1e3 * (n - a));
    }
    return true;
}

/* text NULL: as it is */
static bool set(noc_render_params *p, const char *name, const char *text, noc_log *log) {
    const noc_option *o = noc_render_options();
    while (strcmp(o->name, name))
        o++;
    return !text || noc_option_set(o, p, text, log) == NOC_OK;
}

int main(int argc, char **argv) {
    bench b = { .params = noc_render_default_params() };
    int rounds = argc > 4 ? atoi(argv[4]) : 5;
    rounds = rounds < 1 ? 1 : rounds > MOST ? MOST : rounds;
    b.params.width = argc > 3 ? atoi(argv[2]) : 640;
    b.params.height = argc > 3 ? atoi(argv[3]) : 360;
    noc_log *log = bench_log();
    if (!set(&b.params, "candidates", argc > 5 ? argv[5] : NULL, log) ||
        !set(&b.params, "method", argc > 6 ? argv[6] : NULL, log) || !open_scene(&b, argc > 1 ? argv[1] : "city") ||
        !(b.view = own_view(b.scene, 1, log)))
        return EXIT_FAILURE;
    frame(&b);
    frame(&b);
    noc_scene_info info;
    noc_scene_get_info(b.scene, &info);
    printf("%s, %d x %d: %zu triangles, %zu lights, %u in the group\n", argc > 1 ? argv[1] : "city", b.params.width,
           b.params.height, info.triangles, info.lights, b.windows);
    printf("| edit | commit, ms | next frame | the one after | difference |\n");
    bool done = measure(&b, rounds);
    close_view(b.view);
    noc_scene_destroy(b.scene);
    return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
