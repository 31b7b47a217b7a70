/* Built cities: what was saved is what is loaded, to the bit of a picture; and what is no built city is one error. */
#include "../test.h"
#include "../own_view.h"

#include "scene/scene.h"

#include <nocturne/nocturne.h>

#include <unistd.h>

static char folder[] = "/tmp/noc-built-XXXXXX", path[64];

static int set_up(void **state) {
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof(path), "%s/city.noct", folder);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static const noc_camera from_above = {
    .eye = { 60, -80, 70 }, .target = { 0, 0, 0 }, .up = { 0, 0, 1 }, .fov_deg = 60
};

/* Two frames of a small picture, by the default method. */
static noc_image *picture(const noc_scene *scene, const noc_camera *camera) {
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

static void assert_same_picture(const noc_scene *a, const noc_scene *b, const noc_camera *camera) {
    noc_image *x = picture(a, camera), *y = picture(b, camera);
    assert_int_equal(x->width, y->width);
    assert_memory_equal(x->rgb, y->rgb, sizeof(float) * 3 * (size_t)x->width * (size_t)x->height);
    assert_false(noc_image_is_black(x));
    noc_image_destroy(x);
    noc_image_destroy(y);
}

static void assert_same_info(const noc_scene *a, const noc_scene *b) {
    noc_scene_info x, y;
    char p[NOC_CONTENT_KEY], q[NOC_CONTENT_KEY];
    noc_scene_get_info(a, &x);
    noc_scene_get_info(b, &y);
    assert_string_equal(x.crs, y.crs);
    assert_string_equal(x.given_crs, y.given_crs);
    x.crs = y.crs = x.given_crs = y.given_crs = NULL;
    x.memory_bytes = y.memory_bytes = 0;
    assert_memory_equal(&x, &y, sizeof(x));
    noc_scene_content(a, p);
    noc_scene_content(b, q);
    assert_string_equal(p, q);
    assert_int_equal(a->meshes.len, b->meshes.len);
    for (size_t i = 0; i < a->meshes.len; i++)
        if (a->meshes.data[i].name)
            assert_string_equal(a->meshes.data[i].name, b->meshes.data[i].name);
        else
            assert_null(b->meshes.data[i].name);
    for (size_t i = 0; i < a->lights.len; i++) {
        noc_light_info l, m;
        noc_scene_get_light(a, i, &l);
        noc_scene_get_light(b, i, &m);
        assert_int_equal(!l.light.name, !m.light.name);
        if (l.light.name)
            assert_string_equal(l.light.name, m.light.name);
        l.light.name = m.light.name = NULL;
        assert_memory_equal(&l, &m, sizeof(l));
    }
}

static noc_scene *load_again(const noc_report **report) {
    const char *inputs[] = { path };
    noc_scene *scene = noc_scene_create(NULL);
    assert_non_null(scene);
    assert_int_equal(noc_scene_load(scene, inputs, 1, NULL, (noc_report **)report), NOC_OK);
    return scene;
}

static void test_builtin(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_builtin(scene, "city", NULL), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_ERR_ARGUMENT); /* not committed */
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_save(scene, path, NULL), NOC_OK);
    assert_true(noc_built_is(path));
    noc_scene *again = load_again(NULL);
    assert_same_info(scene, again);
    assert_same_picture(scene, again, &from_above);
    noc_scene_destroy(scene);
    noc_scene_destroy(again);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_builtin) };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
