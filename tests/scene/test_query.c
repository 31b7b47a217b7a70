/* What a scene tells of itself: lights, objects, pixels and places. */
#include "../render/rooms.h"
#include "scene/scene.h"

#define assert_close(a, b, e) assert_true(fabs((double)(a) - (double)(b)) <= (e))

static noc_light_info light_of(const noc_scene *s, size_t i) {
    noc_light_info info;
    assert_int_equal(noc_scene_get_light(s, i, &info), NOC_OK);
    return info;
}

static void lights_are_listed(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    noc_light lights[] = {
        { .kind = NOC_LIGHT_POINT, .position = { 1, 2, 3 }, .emission = { 10, 10, 10 }, .name = "p" },
        { .kind = NOC_LIGHT_SPHERE,
          .position = { 4, 5, 6 },
          .radius = 0.5,
          .emission = { 100, 100, 100 },
          .inferred = true },
        { .kind = NOC_LIGHT_DISC,
          .position = { 0, 0, 8 },
          .radius = 0.2,
          .direction = { 0, 0, -3 },
          .emission = { 0, 100, 0 } },
        { .kind = NOC_LIGHT_PARALLELOGRAM,
          .position = { 1, 1, 1 },
          .edge_u = { 2, 0, 0 },
          .edge_v = { 0, 3, 0 },
          .emission = { 5, 5, 5 } },
        { .kind = NOC_LIGHT_SPOT,
          .position = { 1, 2, 3 },
          .direction = { 0, -4, 0 },
          .inner_deg = 60,
          .outer_deg = 90,
          .emission = { 10, 10, 10 } },
    };
    for (int i = 0; i < 5; i++)
        assert_int_equal(noc_scene_add_light(s, &lights[i]), i);
    int shop = noc_scene_add_material(s, &(noc_material){ .roughness = 1, .emission = { 7, 7, 7 }, .two_sided = true });
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = (double[]){ 0, 0, 0, 3, 0, 0, 0, 3, 0 },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = shop,
                      .name = "shop" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_int_equal(info.lights, 6);
    /* By hand: 4 pi I, 4 pi^2 r^2 L, pi L A, twice that from two sides. */
    assert_close(light_of(s, 0).lumens, 40 * M_PI, 1e-4);
    assert_string_equal(light_of(s, 0).light.name, "p");
    assert_close(light_of(s, 1).lumens, 4 * M_PI * M_PI * 0.25 * 100, 1e-2);
    assert_true(light_of(s, 1).light.inferred && !light_of(s, 0).light.inferred);
    assert_close(light_of(s, 2).lumens, M_PI * 71.52 * M_PI * 0.04, 1e-3);
    assert_close(light_of(s, 2).light.direction[2], -1, 1e-6);
    assert_close(light_of(s, 3).lumens, M_PI * 5 * 6, 1e-3);
    assert_close(light_of(s, 3).centre[1], 2.5, 1e-6);
    assert_close(light_of(s, 3).light.direction[2], 1, 1e-6);
    /* 2 pi I over the cosines: 1 from 1/2 to 1, the square of twice the cosine from 0 to 1/2 */
    assert_close(light_of(s, 4).lumens, 2 * M_PI * 10 * (0.5 + 0.5 / 3), 1e-3);
    assert_close(light_of(s, 4).light.direction[1], -1, 1e-6);
    assert_close(light_of(s, 4).light.inner_deg, 60, 1e-4);
    assert_close(light_of(s, 4).light.outer_deg, 90, 1e-4);
    assert_true(light_of(s, 5).two_sided);
    assert_close(light_of(s, 5).lumens, 2 * M_PI * 7 * 4.5, 1e-3);
    assert_close(light_of(s, 5).centre[0], 1, 1e-6);
    assert_string_equal(light_of(s, 5).light.name, "shop");
    noc_light_info none;
    assert_int_equal(noc_scene_get_light(s, 6, &none), NOC_ERR_ARGUMENT);
    noc_scene_destroy(s);
}

static void add_piece(noc_scene *s, int material, const char *name, double z) {
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = (double[]){ 0, 0, z, 1, 0, z, 0, 1, z },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = material,
                      .name = name };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
}

static void pieces_of_an_object_are_one(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int m = matte(s, 0.5f);
    static const char *const names[] = { "a", "a", "b", NULL, NULL, "b" };
    static const size_t want[] = { 0, 0, 2, 3, 4, 5 };
    for (int i = 0; i < 6; i++)
        add_piece(s, m, names[i], i);
    for (uint32_t i = 0; i < 6; i++) {
        size_t object = noc_scene_object_of(s, i, NO_INSTANCE);
        assert_int_equal(object, want[i]);
        const char *name = noc_scene_object_name(s, object);
        assert_true(names[i] ? name && !strcmp(name, names[i]) : !name);
    }
    assert_null(noc_scene_object_name(s, 6));
    noc_scene_destroy(s);
}

/* Against the frame's own camera, for cameras that look along, up, and straight down. */
static void pixels_and_places(void **state) {
    noc_camera cameras[] = { look(1, -10, 4, 0, 0, 2.5, 60), look(500000, 7, 2, 500003, 9, 300, 20),
                             look(0, 0, 50, 0, 0, 0, 90) };
    noc_render_params p = measure(64, 40, NOC_METHOD_RIS);
    for (size_t i = 0; i < NOC_COUNT(cameras); i++) {
        const noc_camera *c = &cameras[i];
        frame_camera f;
        noc_make_frame_camera(c, &p, 0, &f);
        double pixel[2] = { 10.25, 31.5 }, xyz[3], back[2], distance;
        assert_int_equal(noc_camera_unproject(c, 64, 40, pixel, 12, xyz), NOC_OK);
        double sx = 2 * pixel[0] / 64 - 1, sy = 1 - 2 * pixel[1] / 40, d[3], length = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = f.forward[k] + sx * f.right[k] + sy * f.up[k];
            length += d[k] * d[k];
        }
        for (int k = 0; k < 3; k++)
            assert_close(xyz[k], c->eye[k] + 12 * d[k] / sqrt(length), 1e-4);
        assert_true(noc_camera_project(c, 64, 40, xyz, back, &distance));
        assert_close(back[0], pixel[0], 1e-6);
        assert_close(back[1], pixel[1], 1e-6);
        assert_close(distance, 12, 1e-6);
        double behind[3];
        for (int k = 0; k < 3; k++)
            behind[k] = 2 * c->eye[k] - xyz[k];
        assert_false(noc_camera_project(c, 64, 40, behind, back, NULL));
    }
    noc_camera nowhere = look(1, 2, 3, 1, 2, 3, 60);
    double xyz[3], pixel[2] = { 1, 1 };
    assert_int_equal(noc_camera_unproject(&nowhere, 64, 40, pixel, 1, xyz), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_camera_unproject(&cameras[0], 0, 40, pixel, 1, xyz), NOC_ERR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(lights_are_listed),
                                        cmocka_unit_test(pieces_of_an_object_are_one),
                                        cmocka_unit_test(pixels_and_places) };
    return cmocka_run_group_tests_name("scene query", tests, NULL, NULL);
}
