/* Built cities as seeds: OUT/noct/NAME, of a scene with nothing, one with all but profiles, and one with a profile. */
#include "fuzz.h"

#include <nocturne/built.h>

#include <stdio.h>

static void save(noc_scene *s, const char *out, const char *name, const char *recipe) {
    char path[4096];
    snprintf(path, sizeof(path), "%s/noct/%s", out, name);
    FUZZ_REQUIRE(!noc_scene_commit(s));
    FUZZ_REQUIRE(!noc_scene_save(s, path, &(noc_save_params){ NULL, recipe }));
    noc_scene_destroy(s);
}

static const double corners[] = { -5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0, -5, -5, 4, 5, -5, 4 };

static int add_mesh(noc_scene *s, const uint32_t indices[6], noc_class cls, int model, int group) {
    noc_material material = noc_class_material(cls);
    material.emission[0] = model ? 20 : 0;
    noc_mesh mesh = { .vertex_count = 6,
                      .positions = corners,
                      .triangle_count = 2,
                      .indices = indices,
                      .material = noc_scene_add_material(s, &material),
                      .model = model,
                      .group = group,
                      .name = noc_class_name(cls) };
    int index = noc_scene_add_mesh(s, &mesh);
    FUZZ_REQUIRE(index >= 0);
    return index;
}

static void add_lights(noc_scene *s, int group, int profile) {
    noc_light light = { .position = { 0, 0, 3 },
                        .edge_u = { 1, 0, 0 },
                        .edge_v = { 0, -1, 0 },
                        .direction = { 0, 0, -1 },
                        .radius = .2,
                        .inner_deg = 20,
                        .outer_deg = 40,
                        .emission = { 900, 800, 500 },
                        .name = "lamp",
                        .group = group };
    for (int kind = 0; kind < NOC_LIGHT_KIND_COUNT; kind++) {
        light.kind = (noc_light_kind)kind;
        light.moving = kind == NOC_LIGHT_POINT;
        light.profile = kind == NOC_LIGHT_SPHERE ? profile : 0;
        FUZZ_REQUIRE(noc_scene_add_light(s, &light) >= 0);
    }
}

static void add_cars(noc_scene *s, int group) {
    static const noc_scene_stop stops[] = { { 0, { -5, 0, 0 }, 0 }, { 1, { 5, 0, 0 }, 10 }, { 2, { 5, 5, 0 }, 15 } };
    int model = noc_scene_add_model(s, "car"), route = noc_scene_add_route(s, stops, NOC_COUNT(stops));
    add_mesh(s, (const uint32_t[]){ 0, 1, 4, 1, 5, 4 }, NOC_CLASS_VEHICLE, model, group);
    FUZZ_REQUIRE(noc_scene_add_car(s, model, route, 0, 2.6) && noc_scene_add_car(s, model, route, .5, 2.6));
    FUZZ_REQUIRE(!noc_scene_remove_instance(s, 0));
}

static void add_window(noc_scene *s) {
    static const uint32_t both[] = { 0, 1 };
    int mesh = add_mesh(s, (const uint32_t[]){ 0, 1, 5, 0, 5, 4 }, NOC_CLASS_WINDOW, 0, 0);
    noc_pane pane = { .triangles = both,
                      .triangle_count = 2,
                      .shape = { .kind = NOC_LIGHT_PARALLELOGRAM, .edge_u = { 10, 0, 0 }, .edge_v = { 0, 0, 4 } },
                      .window = { .emission = { 30, 20, 10 }, .level = .1f } };
    FUZZ_REQUIRE(noc_scene_add_window(s, mesh, &pane) && noc_scene_reserve_walls(s));
    s->walls.data[0] = NOC_WALL_TAKEN;
}

void built_seeds(const char *out) {
    save(noc_scene_create(NULL), out, "nothing", NULL);
    noc_scene *s = noc_scene_create(NULL);
    FUZZ_REQUIRE(!noc_scene_set_crs(s, "EPSG:25832", (const double[]){ 678000, 5403000, 370 }));
    int group = noc_scene_add_group(s, "street");
    add_mesh(s, (const uint32_t[]){ 0, 1, 2, 0, 2, 3 }, NOC_CLASS_GROUND, 0, 0);
    add_lights(s, group, 0);
    add_cars(s, group);
    add_window(s);
    float sky[3 * 8] = { 1, 2, 3 };
    FUZZ_REQUIRE(!noc_scene_set_environment(s, &(noc_image){ .width = 4, .height = 2, .rgb = sky }));
    save(s, out, "all", "nocturne: 1\ncameras: { a: { view: street } }\n");
    noc_profile *profile;
    s = noc_scene_create(NULL);
    FUZZ_REQUIRE(!noc_profile_builtin(NULL, "wall", &profile));
    add_lights(s, 0, noc_scene_add_profile(s, profile));
    noc_profile_destroy(profile);
    save(s, out, "profile", NULL);
}
