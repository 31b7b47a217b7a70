/* The headlight: a lamp at the eye, which asks for no light of the scene. */
#include "rooms.h"

enum { W = 64, H = 48 };

static noc_scene *yard(int lamps) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f), dark = matte(s, 0.05f);
    add_floor(s, dark, 0, 0, 0, 50);
    QUAD(s, grey, -6, 5, 0, 6, 0, 0, 0, 0, 6); /* two walls that meet in an edge */
    QUAD(s, grey, 0, 5, 0, 6, 6, 0, 0, 0, 6);
    for (int i = 0; i < lamps; i++)
        point_light(s, i % 10 - 5, -2, 4 + i / 10, 50);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_render_params headlight(void) {
    noc_render_params p = noc_render_default_params();
    p.width = W;
    p.height = H;
    p.method = NOC_METHOD_HEADLIGHT;
    return p;
}

static const float *pixel(const noc_image *i, int x, int y) { return i->rgb + 3 * (y * W + x); }

static void shows_what_there_is_without_any_light(void **state) {
    (void)state;
    noc_scene *s = yard(0);
    noc_view *view = own_view(s, 1, NULL);
    noc_render_params p = headlight();
    noc_camera c = look(0, -8, 3, 0, 5, 3, 60);
    for (int i = 0; i < 4; i++)
        assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    const float *left = pixel(image, W / 2 - 8, H / 2), *right = pixel(image, W / 2 + 8, H / 2),
                *floor = pixel(image, W / 2, H - 4), *sky = pixel(image, W / 2, 2);
    assert_true(left[1] > 1.15f * right[1]); /* one faces the eye, one does not */
    assert_true(right[1] > 2 * floor[1] && floor[1] > .02f);
    assert_true(sky[1] > 0 && sky[1] < floor[1]);
    noc_image_destroy(image);
    close_view(view);
    noc_scene_destroy(s);
}

/* Straight down on grey of 0.5, 10 m away, which faces the eye. */
static void is_as_bright_as_its_formula(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 50);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    noc_render_params p = headlight();
    p.sky = 0;
    noc_camera c = look(0, 0, 10, 0, 1e-4, 0, 1);
    assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
    noc_image *image = noc_view_image(view);
    double expect = 2 * (.3 + .45 + .25 * (.5 + .5 * .7682)) * 400 / 410 * (.06 + .94 * .5);
    assert_true(fabs(pixel(image, W / 2, H / 2)[0] - expect) < 1e-3 * expect);
    noc_image_destroy(image);
    close_view(view);
    noc_scene_destroy(s);
}

static void builds_nothing_of_lights_and_sends_no_shadow_rays(void **state) {
    (void)state;
    noc_scene *s = yard(300), *none = yard(0);
    noc_view *view = own_view(s, 1, NULL), *bare = own_view(none, 1, NULL);
    noc_render_params p = headlight();
    noc_camera c = look(0, -8, 3, 0, 5, 3, 60);
    assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(bare, &c, &p, NULL), NOC_OK);
    noc_frame_stats stats;
    noc_light_stats lights;
    noc_view_get_stats(view, &stats);
    noc_view_light_stats(view, &lights);
    assert_int_equal(stats.rays_primary, W * H);
    assert_int_equal(stats.rays_shadow, 0);
    assert_int_equal(lights.bytes, 0);
    assert_true(lights.build_seconds == 0);
    noc_image *a = noc_view_image(view), *b = noc_view_image(bare);
    assert_memory_equal(a->rgb, b->rgb, W * H * 3 * sizeof(float)); /* points are not seen themselves */
    noc_image_destroy(a);
    noc_image_destroy(b);
    close_view(view);
    close_view(bare);
    noc_scene_destroy(s);
    noc_scene_destroy(none);
}

static void is_the_same_on_all_lanes_and_threads(void **state) {
    (void)state;
    noc_scene *s = yard(20);
    noc_camera c = look(-3, -8, 3, 0, 5, 3, 60);
    noc_image *first = NULL;
    for (noc_isa isa = NOC_ISA_SCALAR; isa < NOC_ISA_COUNT; isa++) {
        if (!noc_isa_runs(isa))
            continue;
        noc_render_params p = headlight();
        p.isa = isa;
        noc_view *view = own_view(s, 1 + (int)isa % 3, NULL);
        for (int i = 0; i < 3; i++)
            assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
        noc_image *image = noc_view_image(view);
        if (first)
            assert_memory_equal(first->rgb, image->rgb, W * H * 3 * sizeof(float));
        if (first)
            noc_image_destroy(image);
        else
            first = image;
        close_view(view);
    }
    noc_image_destroy(first);
    noc_scene_destroy(s);
}

static void has_views_of_surfaces_and_none_of_lights(void **state) {
    (void)state;
    noc_scene *s = yard(5);
    noc_view *view = own_view(s, 1, NULL);
    noc_camera c = look(0, -8, 3, 0, 5, 3, 60);
    const noc_aov none[] = { NOC_AOV_LIGHTS, NOC_AOV_DENSITY, NOC_AOV_LIGHT,       NOC_AOV_WEIGHT,  NOC_AOV_CONFIDENCE,
                             NOC_AOV_GROUP,  NOC_AOV_PLACED,  NOC_AOV_ILLUMINANCE, NOC_AOV_EXPECTED },
                  some[] = { NOC_AOV_DEPTH, NOC_AOV_NORMAL, NOC_AOV_CLASS, NOC_AOV_OBJECT };
    noc_render_params p = headlight();
    for (size_t i = 0; i < NOC_COUNT(none); i++) {
        p.aovs = 1u << none[i];
        assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_ERR_ARGUMENT);
    }
    for (size_t i = 0; i < NOC_COUNT(some); i++) {
        p.aovs = 1u << some[i];
        assert_int_equal(noc_view_render(view, &c, &p, NULL), NOC_OK);
        noc_channel *channel = noc_view_aov(view, some[i]);
        assert_non_null(channel);
        noc_channel_destroy(channel);
    }
    close_view(view);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shows_what_there_is_without_any_light),
        cmocka_unit_test(is_as_bright_as_its_formula),
        cmocka_unit_test(builds_nothing_of_lights_and_sends_no_shadow_rays),
        cmocka_unit_test(is_the_same_on_all_lanes_and_threads),
        cmocka_unit_test(has_views_of_surfaces_and_none_of_lights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
