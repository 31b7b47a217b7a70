/* Windows of the built-in city that are switched: the pictures are those of a city that was made so. */
#include "rooms.h"

#include <nocturne/import.h>

enum { W = 96, H = 64 };

static noc_scene *load(const noc_window_params *windows, noc_switch make) {
    noc_scene *s = noc_scene_create(NULL);
    noc_builtin_params builtin = noc_builtin_default_params();
    noc_import_params p = noc_import_default_params();
    builtin.city.size = 150;
    p.builtin = &builtin;
    p.window = *windows;
    p.windows = make;
    assert_int_equal(noc_scene_load(s, (const char *const[]){ "builtin:city" }, 1, &p, NULL), NOC_OK);
    return s;
}

static noc_image *picture(noc_scene *s) {
    noc_camera camera;
    assert_int_equal(noc_scene_camera(s, NOC_VIEWPOINT_STREET, (double)W / H, &camera), NOC_OK);
    noc_render_params p = measure(W, H, NOC_METHOD_RIS);
    return render(s, &camera, &p, 2);
}

static bool same(const noc_image *a, const noc_image *b) { return !memcmp(a->rgb, b->rgb, sizeof(float) * 3 * W * H); }

static void switched_as_made(void **state) {
    (void)state;
    static const noc_window_params cases[] = {
        { .lit_windows = 0.9, .hour = 21, .seed = 1 },
        { .lit_windows = 0.35, .hour = 3, .seed = 1 },
        { .lit_windows = 0.35, .hour = 21, .seed = 12 },
        { .lit_windows = 0, .hour = 21, .seed = 1 },
    };
    noc_window_params usual = noc_window_default_params();
    noc_scene *s = load(&usual, NOC_SWITCH_AUTO);
    noc_image *before = picture(s);
    noc_scene_info was;
    noc_scene_get_info(s, &was);
    assert_true(was.windows > 500 && was.windows_lit > was.windows / 4);
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        noc_window_params to = usual;
        to.lit_windows = cases[i].lit_windows;
        to.hour = cases[i].hour;
        to.seed = cases[i].seed;
        noc_scene *made = load(&to, NOC_SWITCH_AUTO);
        assert_int_equal(noc_scene_set_windows(s, &to), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_scene_info now, want;
        noc_scene_get_info(s, &now);
        noc_scene_get_info(made, &want);
        assert_int_equal(now.windows_lit, want.windows_lit);
        assert_int_equal(now.windows, was.windows);
        assert_int_equal(now.windows_lit == 0, to.lit_windows == 0);
        assert_int_not_equal(now.windows_lit, was.windows_lit);
        noc_image *a = picture(s), *b = picture(made);
        assert_true(same(a, b));
        assert_false(same(a, before));
        noc_image_destroy(a);
        noc_image_destroy(b);
        noc_scene_destroy(made);
    }
    assert_int_equal(noc_scene_set_windows(s, &usual), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_image *back = picture(s);
    assert_true(same(back, before));
    noc_image_destroy(back);
    noc_image_destroy(before);
    noc_scene_destroy(s);
}

static void without_windows(void **state) {
    (void)state;
    noc_window_params all = noc_window_default_params();
    all.lit_windows = 1;
    noc_scene *s = load(&all, NOC_SWITCH_OFF);
    noc_scene_info info;
    noc_scene_get_info(s, &info);
    assert_int_equal(info.windows, 0);
    assert_true(info.triangles_by_class[NOC_CLASS_WINDOW] > 1000);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(switched_as_made), cmocka_unit_test(without_windows) };
    return cmocka_run_group_tests_name("render/builtin_windows", tests, NULL, NULL);
}
