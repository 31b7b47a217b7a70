/* The public API without what may be left out: logs, params, reports, progress. What fails must say so by its status.
 */
#include "../test.h"
#include "../own_view.h"

#include <nocturne/nocturne.h>

static void test_images(void **state) {
    char path[] = "/tmp/nocturne-api-XXXXXX.png";
    int fd = mkstemps(path, 4);
    assert_true(fd >= 0);
    close(fd);
    assert_null(noc_image_create(0, 5, NULL));
    noc_image *a = noc_image_create(4, 3, NULL), *other = noc_image_create(3, 3, NULL);
    uint8_t rgb[4 * 3 * 3], *picture = NULL;
    for (int i = 0; i < 4 * 3 * 3; i++)
        a->rgb[i] = (float)(1 + i % 5);
    uint8_t given[4 * 3 * 3];
    noc_image_to_srgb8(a, NULL, rgb);
    noc_image_to_srgb8(a, &noc_display_default_params(), given);
    assert_memory_equal(rgb, given, sizeof(rgb));
    assert_int_equal(noc_image_write(a, path, NULL, NULL, NULL), NOC_OK);
    assert_int_equal(noc_image_write_srgb8(rgb, 4, 3, path, NULL, NULL), NOC_OK);
    assert_int_equal(noc_image_write(a, "/nonexistent/x.png", NULL, NULL, NULL), NOC_ERR_IO);
    assert_int_equal(noc_image_check_path(path, NULL), NOC_OK);
    assert_int_equal(noc_image_check_path("/nonexistent/x.png", NULL), NOC_ERR_IO);
    noc_image *read = noc_image_read(path, NULL, NULL);
    assert_int_equal(read->width, 4);
    assert_null(noc_image_read("/nonexistent/x.png", NULL, NULL));
    noc_comparison none, defaults;
    assert_int_equal(noc_image_compare(a, a, NULL, &none, NULL), NOC_OK);
    assert_int_equal(noc_image_compare(a, a, &noc_compare_default_params(), &defaults, NULL), NOC_OK);
    assert_true(none.ceiling == defaults.ceiling && none.all.mean_r == defaults.all.mean_r);
    assert_int_equal(noc_image_compare(a, other, NULL, &none, NULL), NOC_ERR_ARGUMENT);
    int width, height;
    assert_int_equal(noc_image_difference(a, a, NULL, &picture, &width, &height, NULL), NOC_OK);
    free(picture);
    assert_int_not_equal(noc_image_difference(a, other, NULL, &picture, &width, &height, NULL), NOC_OK);
    noc_image_destroy(a);
    noc_image_destroy(other);
    noc_image_destroy(read);
    noc_image_destroy(NULL);
    unlink(path);
}

static void test_scenes(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    double xyz[3] = { 0 };
    noc_camera camera;
    assert_int_equal(noc_scene_add_material(scene, &(noc_material){ .roughness = 7 }), -1);
    assert_int_equal(noc_scene_add_mesh(scene, &(noc_mesh){ .material = 9 }), -1);
    assert_int_equal(noc_scene_add_light(scene, &(noc_light){ .kind = NOC_LIGHT_SPHERE }), -1);
    assert_int_equal(noc_scene_set_crs(scene, NULL, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_to_local(scene, "EPSG:25832", xyz), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, 1, &camera), NOC_ERR_ARGUMENT);
    assert_null(own_view(scene, 0, NULL));
    assert_null(own_view(NULL, 0, NULL));
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_add_city(scene, NULL), NOC_ERR_ARGUMENT);
    noc_view *renderer = own_view(scene, 0, NULL);
    assert_non_null(renderer);
    assert_null(noc_view_image(renderer));
    noc_render_params params = noc_render_default_params();
    params.width = 0;
    assert_int_equal(noc_view_render(renderer, &noc_camera_default(), &params, NULL), NOC_ERR_ARGUMENT);
    /* eye is target */
    assert_int_equal(noc_view_render(renderer, &noc_camera_default(), NULL, NULL), NOC_ERR_ARGUMENT);
    close_view(renderer);
    close_view(NULL);
    noc_scene_destroy(scene);
}

static void test_files(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    const char *missing = "/nonexistent/city.gml";
    assert_int_equal(noc_scene_load(scene, &missing, 1, NULL, NULL), NOC_ERR_IO);
    noc_scene_destroy(scene);
    scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, NULL, 0, NULL, NULL), NOC_ERR_ARGUMENT);
    noc_import_params params = noc_import_default_params();
    memcpy(&params.obj_up, &(int){ -1 }, sizeof(int));
    assert_int_equal(noc_scene_load(scene, &missing, 1, &params, NULL), NOC_ERR_ARGUMENT);
    noc_scene_destroy(scene);
    assert_int_equal(noc_inspect(NULL, missing, NULL, NULL), NOC_ERR_IO);
    assert_int_equal(noc_report_file_count(NULL), 0);
    assert_null(noc_report_get_file(NULL, 0));
    noc_report_destroy(NULL);
}

static void test_options(void **state) {
    noc_render_params params = noc_render_default_params();
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        assert_int_equal(noc_option_set(o, &params, "no value of any", NULL), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_option_set(o, &params, NULL, NULL),
                         o->kind == NOC_OPTION_BOOL ? NOC_OK : NOC_ERR_ARGUMENT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_images), cmocka_unit_test(test_scenes),
                                        cmocka_unit_test(test_files), cmocka_unit_test(test_options) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
