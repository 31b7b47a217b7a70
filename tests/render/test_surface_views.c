/* Views of surfaces, held to the scene. */
#include "views.h"

/* The last frame's surfaces: each pixel's depth leads to the floor, whose class and object it tells; emitters are
 * surfaces too. */
static void surfaces_that_are_seen(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    int road = noc_scene_add_material(s, &(noc_material){
                                             .albedo = { 0.2f, 0.2f, 0.2f }, .roughness = 1, .cls = NOC_CLASS_ROAD });
    noc_mesh floor = { .vertex_count = 4,
                       .positions = (double[]){ -9, -9, 0, 9, -9, 0, 9, 9, 0, -9, 9, 0 },
                       .triangle_count = 2,
                       .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                       .material = road,
                       .name = "A7" };
    assert_true(noc_scene_add_mesh(s, &floor) >= 0);
    noc_light lamp = { .kind = NOC_LIGHT_PARALLELOGRAM,
                       .position = { -2, 1, 2 },
                       .edge_u = { 3, 0, 0 },
                       .edge_v = { 0, 0, 2 },
                       .emission = { 9, 9, 9 },
                       .name = "sign" }; /* faces -y, where the camera is */
    assert_true(noc_scene_add_light(s, &lamp) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS,
                               1u << NOC_AOV_DEPTH | 1u << NOC_AOV_NORMAL | 1u << NOC_AOV_CLASS | 1u << NOC_AOV_OBJECT);
    noc_camera c = look(1, -10, 4, 0, 0, 1.5, 60);
    noc_view *r = rendered(s, &c, &p, 2, 1);
    noc_channel *depth = view(r, NOC_AOV_DEPTH), *normal = view(r, NOC_AOV_NORMAL), *cls = view(r, NOC_AOV_CLASS),
                *object = view(r, NOC_AOV_OBJECT);
    assert_int_equal(cls->label_count, NOC_LABEL_COUNT);
    for (int i = 0; i < NOC_CLASS_COUNT; i++)
        assert_string_equal(cls->labels[i], noc_class_name((noc_class)i));
    assert_int_equal(cls->label_count, NOC_CLASS_COUNT + NOC_WALL_VERDICT_COUNT - 1);
    for (size_t i = 0; i < cls->label_count; i++)
        assert_true(cls->labels[i] && *cls->labels[i]);
    assert_true(!object->labels && !object->label_count);
    int none = 0, floors = 0, signs = 0;
    for (int i = 0; i < N; i++) {
        const float *n = normal->value + 3 * i;
        double xyz[3], pixel[2] = { i % W + 0.5, i / W + 0.5 };
        if (cls->value[i] < 0) {
            assert_true(depth->value[i] == -1 && object->value[i] == -1 && n[0] == 0 && n[1] == 0 && n[2] == 0);
            none++;
            continue;
        }
        assert_int_equal(noc_camera_unproject(&c, W, H, pixel, depth->value[i], xyz), NOC_OK);
        const char *name = noc_scene_object_name(s, (size_t)object->value[i]);
        if (cls->value[i] == NOC_CLASS_ROAD) {
            assert_string_equal(name, "A7");
            assert_true(fabs(xyz[2]) < 1e-3 && n[2] == 1);
            floors++;
        } else {
            assert_int_equal(cls->value[i], NOC_CLASS_LAMP);
            assert_string_equal(name, "sign");
            assert_true(fabs(xyz[1] - 1) < 1e-3 && n[1] == -1);
            signs++;
        }
    }
    assert_true(none > 50 && floors > 200 && signs > 10);
    noc_channel_destroy(depth);
    noc_channel_destroy(normal);
    noc_channel_destroy(cls);
    noc_channel_destroy(object);
    close_view(r);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_that_are_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
