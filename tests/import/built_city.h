/* A city with all that a scene has, saved to a file and loaded again. */
#ifndef NOC_TEST_BUILT_CITY_H
#define NOC_TEST_BUILT_CITY_H

#include "../test.h"
#include "../own_view.h"

#include "scene/scene.h"

#include <nocturne/nocturne.h>

#include <unistd.h>

static char folder[] = "/tmp/noc-built-XXXXXX", path[64];

static inline int set_up(void **state) {
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof(path), "%s/city.noct", folder);
    return 0;
}

static inline int tear_down(void **state) {
    (void)state;
    unlink(path);
    return rmdir(folder);
}

/* Two frames of a small picture, by the default method. */
static inline noc_image *picture(const noc_scene *scene, const noc_camera *camera) {
    noc_render_params params = noc_render_default_params();
    noc_view *view = own_view(scene, 2, NULL);
    params.width = 64;
    params.height = 36;
    assert_non_null(view);
    for (int i = 0; i < 2; i++)
        assert_int_equal(noc_view_render(view, camera, &params, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    assert_non_null(image);
    close_view(view);
    return image;
}

static inline noc_scene *load_again(noc_report **report) {
    const char *inputs[] = { path };
    noc_scene *scene = noc_scene_create(NULL);
    assert_non_null(scene);
    assert_int_equal(noc_scene_load(scene, inputs, 1, NULL, report), NOC_OK);
    return scene;
}

static inline const char *city_file(void) {
    static char name[4096];
    snprintf(name, sizeof(name), "%s/tests/cli/city.gml", getenv("NOC_SOURCE"));
    return name;
}

static inline void add_car(noc_scene *s, int group, int profile) {
    noc_material red = noc_class_material(NOC_CLASS_VEHICLE), glow = red;
    glow.emission[0] = 300;
    int model = noc_scene_add_model(s, "car");
    const double corners[12] = { -2, -1, 0, 2, -1, 0, 2, 1, 0, 0, 0, 2 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = corners,
                      .triangle_count = 3,
                      .indices = (uint32_t[]){ 0, 1, 3, 1, 2, 3, 2, 0, 3 },
                      .material = noc_scene_add_material(s, &red),
                      .model = model,
                      .name = "body" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    mesh.material = noc_scene_add_material(s, &glow);
    mesh.triangle_count = 1;
    mesh.name = NULL;
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    noc_light lamp = { .kind = NOC_LIGHT_DISC,
                       .position = { 2, 0, 1 },
                       .direction = { 1, 0, 0 },
                       .radius = .1,
                       .emission = { 700, 700, 600 },
                       .model = model,
                       .profile = profile,
                       .group = group };
    assert_true(noc_scene_add_light(s, &lamp) >= 0);
    noc_scene_stop stops[] = { { 0, { -20, -10, 0 }, 0 }, { 9, { 20, -10, 0 }, 40 } };
    int route = noc_scene_add_route(s, stops, 2);
    stops[1].seconds = 3600e9; /* an hour, of a track that tells nanoseconds */
    int slow = noc_scene_add_route(s, stops, 2);
    for (int i = 0; i < 3; i++)
        assert_true(noc_scene_add_car(s, model, i < 2 ? route : slow, 2.0 * i, 2.6));
    assert_int_equal(noc_scene_remove_instance(s, 1), NOC_OK);
}

/* Lights of all kinds, of groups and with a profile, moving ones, a map around: then a city with windows. */
static inline noc_scene *make_city(noc_report **report) {
    noc_scene *s = noc_scene_create(NULL);
    noc_profile *cobra;
    float rgb[3 * 8] = { 0 };
    for (int i = 0; i < 24; i++)
        rgb[i] = .01f * (float)i;
    assert_int_equal(noc_scene_set_environment(s, &(noc_image){ .width = 4, .height = 2, .rgb = rgb }), NOC_OK);
    assert_int_equal(noc_scene_set_crs(s, "EPSG:25832", (double[3]){ 678000, 5403000, 400 }), NOC_OK);
    int street = noc_scene_add_group(s, "street"), other = noc_scene_add_group(s, NULL);
    assert_int_equal(noc_profile_builtin(NULL, "cobra-head", &cobra), NOC_OK);
    int profile = noc_scene_add_profile(s, cobra);
    noc_profile_destroy(cobra);
    add_car(s, other, profile);
    noc_light light = { .position = { 3, -4, 7 },
                        .edge_u = { 1, 0, 0 },
                        .edge_v = { 0, -1, 0 },
                        .direction = { 0, 0, -1 },
                        .radius = .2,
                        .inner_deg = 20,
                        .outer_deg = 40,
                        .emission = { 900, 800, 500 } };
    for (int kind = 0; kind < NOC_LIGHT_KIND_COUNT; kind++) {
        light.kind = (noc_light_kind)kind;
        light.name = kind % 2 ? "odd" : NULL;
        light.group = kind % 3 ? street : 0;
        light.moving = kind == NOC_LIGHT_POINT;
        light.inferred = kind == NOC_LIGHT_DISC;
        light.profile = kind == NOC_LIGHT_SPHERE ? profile : 0;
        light.position[0] += 2;
        assert_true(noc_scene_add_light(s, &light) >= 0);
    }
    const char *inputs[] = { city_file() };
    noc_import_params params = noc_import_default_params();
    noc_luminaire_rule rule = noc_luminaire_default_rule();
    rule.place = "rules.yaml:3";
    rule.tilt = 10;
    params.wet = true;
    params.luminaires = &rule;
    params.luminaire_count = 1;
    assert_int_equal(noc_scene_load(s, inputs, 1, &params, report), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_true(info.windows > 3 && info.windows_lit > 0 && info.cars == 2 && info.instances == 2 && info.models == 1);
    assert_true(s->groups.len >= 2 && s->profiles.len && s->walls.len && s->moving.len && s->backdrop_count);
    return s;
}

static const noc_camera in_street = { .eye = { 25, -22, 12 }, .target = { 3, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

static inline void stage_edits(noc_scene *s) {
    noc_window_params windows = noc_window_default_params();
    noc_material wall = noc_class_material(NOC_CLASS_WALL), sign = wall;
    sign.emission[1] = 50;
    wall.albedo[0] = .9f;
    windows.lit_windows = 1;
    assert_int_equal(noc_scene_set_windows(s, &windows), NOC_OK);
    assert_int_equal(noc_scene_set_group(s, 1, (float[]){ .5f, 1, 2 }), NOC_OK);
    assert_int_equal(noc_scene_set_class_material(s, NOC_CLASS_WALL, &wall), NOC_OK);
    assert_int_equal(noc_scene_set_time(s, 4), NOC_OK);
    assert_int_equal(noc_scene_remove_light(s, NOC_LIGHT_DISC), NOC_OK);
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = (double[]){ 0, -9, 1, 4, -9, 1, 0, -9, 4 },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = noc_scene_add_material(s, &sign),
                      .group = 2,
                      .name = "sign" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    noc_light lamp = { .kind = NOC_LIGHT_SPHERE, .position = { 1, 1, 9 }, .radius = .1, .emission = { 5, 5, 5 } };
    assert_true(noc_scene_add_light(s, &lamp) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

#endif
