/* Who lights this, of surfaces that differ: classes, textures; and lights that do: profiles, a map around the scene. */
#include "asking.h"

#include <nocturne/photometry.h>

static noc_patch quad_half(float x, float y, float dx, float dy, uint32_t material) {
    return (
        noc_patch){ { x, y, 0 }, { dx, 0, 0 }, { 0, dy, 0 }, { 0, 0, 1 }, fabsf(dx * dy) / 2, material, .level = 0 };
}

/* ---- classes ---- */

/* A house in the light of one lamp far away: each class has the cosine law, a window of a thousandth of it, too. */
static void classes_have_their_closed_form(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int wall = grey_of(s, NOC_CLASS_WALL), roof = grey_of(s, NOC_CLASS_ROOF), pane = grey_of(s, NOC_CLASS_WINDOW);
    QUAD(s, wall, -5, 0, 0, 10, 0, 0, 0, 0, 4);
    QUAD(s, roof, -5, 0, 4, 10, 0, 0, 0, 8, 0);
    QUAD(s, pane, 6, 0, 0, .3, 0, 0, 0, 0, .4);
    point_light(s, 0, -3000, 4000, 25e6f * 100); /* 100 lx square to it */
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_patch parts[] = {
        { { -5, 0, 0 }, { 10, 0, 0 }, { 0, 0, 4 }, { 0, -1, 0 }, 40, (uint32_t)wall, .level = 0 },
        { { -5, 0, 4 }, { 10, 0, 0 }, { 0, 8, 0 }, { 0, 0, 1 }, 80, (uint32_t)roof, .level = 0 },
        { { 6, 0, 0 }, { .3f, 0, 0 }, { 0, 0, .4f }, { 0, -1, 0 }, .12f, (uint32_t)pane, .level = 0 }
    };
    noc_view *view = own_view(s, 2, NULL);
    noc_region *region = region_of(parts, 3);
    noc_render_params p = no_sky(1);
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ &p, NULL });
    noc_influence_class c[NOC_CLASS_COUNT];
    noc_influence_sum sum;
    size_t found;
    assert_int_equal(noc_ranking_get_classes(r, c, NOC_CLASS_COUNT, &found), NOC_ERR_ARGUMENT); /* nothing yet */
    assert_int_equal(noc_ranking_refine(r, NULL, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get_classes(r, c, NOC_CLASS_COUNT, &found), NOC_OK);
    assert_int_equal(found, 3);
    assert_true(c[0].cls == NOC_CLASS_ROOF && fabs(c[0].lux.value - 80) < 0.3 && fabs(c[0].weight - 80) < 1e-3);
    assert_true(c[1].cls == NOC_CLASS_WALL && fabs(c[1].lux.value - 60) < 0.3 && fabs(c[1].weight - 40) < 1e-3);
    assert_true(c[2].cls == NOC_CLASS_WINDOW && fabs(c[2].lux.value - 60) < 0.3 && fabs(c[2].weight - .12) < 1e-5);
    assert_int_equal(noc_ranking_get(r, NULL, 0, NULL, &sum), NOC_OK);
    assert_true(fabs(sum.lux.value - (80 * 80 + 60 * 40.12) / 120.12) < 4 * sum.lux.error + 0.2);
    assert_int_equal(noc_ranking_get_classes(r, c, 1, &found), NOC_OK);
    assert_int_equal(found, 1);
    noc_ranking_destroy(r);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

/* Illuminance of a polygon of 1 cd/m2 at the origin, whose normal is up (Lambert 1760): half the sum over its edges of
 * the angle that each spans times the vertical part of the unit normal of the plane through it and the origin. */
static double lambert(double (*v)[3], int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) {
        const double *a = v[i], *b = v[(i + 1) % count];
        double c[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
        double sine = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        sum += atan2(sine, cosine) * c[2] / sine;
    }
    return fabs(sum) / 2;
}

/* One lamp and one window, each known in closed form: the window stands beside the sums unless it is counted, and with
 * the lamp off it is told all the same. */
static void windows_stand_beside(void **state) {
    (void)state;
    double pane[4][3] = { { -1, 4, 1 }, { 1, 4, 1 }, { 1, 4, 2.5 }, { -1, 4, 2.5 } };
    double lamp = 300 / 36.0, window = 25 * lambert(pane, 4);
    noc_scene *s = noc_scene_create(NULL);
    int road = grey_of(s, NOC_CLASS_ROAD);
    int glow = noc_scene_add_material(
        s, &(noc_material){ .roughness = 1, .emission = { 25, 25, 25 }, .two_sided = true, .cls = NOC_CLASS_WINDOW });
    add_floor(s, road, 0, 0, 0, 40);
    QUAD(s, glow, -1, 4, 1, 2, 0, 0, 0, 0, 1.5);
    point_light(s, 0, 0, 6, 300);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_patch y = point_at(0, 0, 0);
    y.material = (uint32_t)road;
    noc_view *view = own_view(s, 2, NULL);
    noc_region *region = region_of(&y, 1);
    noc_render_params p = no_sky(1);
    double eye[3] = { 0, -9, 5 }, seen[2];
    for (int counted = 0; counted < 2; counted++) {
        noc_ranking_params params = { .render = &p, .eye = eye, .count_windows = counted };
        noc_ranking *r = noc_ranking_create(view, region, &params);
        noc_influence_row rows[2];
        noc_influence_sum sum;
        noc_influence_class c;
        size_t found;
        assert_int_equal(noc_ranking_refine(r, &(noc_ranking_target){ .rays = (uint64_t)all_samples(200000) }, NULL),
                         0);
        assert_int_equal(noc_ranking_get(r, rows, 2, &found, &sum), NOC_OK);
        const noc_influence_kind *by_lamp = &sum.kinds[NOC_EMITTER_LAMP], *by_window = &sum.kinds[NOC_EMITTER_WINDOW];
        double all = lamp + counted * window, near = SANITIZED ? .05 : 2e-3;
        assert_true(fabs(by_lamp->lux.value - lamp) < 1e-5 * lamp && by_lamp->emitters == 1);
        assert_true(fabs(by_window->lux.value - window) < near * window && by_window->emitters == 1);
        assert_true(fabs(sum.lux.value - all) < near * all && sum.windows_counted == counted);
        assert_true(found == 1 + (size_t)counted && sum.emitters == found && fabs(sum.rest.value) < 1e-9);
        assert_true(rows[0].emitter.kind == NOC_EMITTER_LAMP && fabs(rows[0].share.value - lamp / all) < near);
        assert_true(fabs(by_lamp->share.value - lamp / all) < near);
        assert_true(counted ? fabs(by_window->share.value - window / all) < near : isnan(by_window->share.value));
        assert_int_equal(noc_ranking_get_classes(r, &c, 1, &found), NOC_OK);
        assert_true(fabs(c.lux.value - sum.lux.value) < 1e-9 && fabs(c.lamps.value - by_lamp->lux.value) < 1e-9);
        assert_true(fabs(c.windows.value - by_window->lux.value) < 1e-9);
        seen[counted] = sum.luminance.value;
        noc_ranking_destroy(r);
    }
    assert_true(seen[0] > .1 && seen[1] > seen[0] * 1.02); /* the window's gloss and light */
    assert_int_equal(noc_scene_set_emission(s, 0, (float[3]){ 0 }), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ .render = &p });
    noc_influence_sum sum;
    size_t found;
    assert_int_equal(noc_ranking_refine(r, &(noc_ranking_target){ .error = .01 }, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(r, NULL, 0, &found, &sum), NOC_OK);
    assert_true(sum.lux.value == 0 && sum.emitters == 0 && sum.kinds[NOC_EMITTER_WINDOW].lux.value > .5 * window);
    noc_ranking_destroy(r);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

/* One lamp over a wide floor: its share is certain, and the lux is as sure as it is asked to be. */
static void errors_bound_the_lux(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int floor = grey_of(s, NOC_CLASS_ROAD);
    QUAD(s, floor, -100, -100, 0, 200, 0, 0, 0, 200, 0);
    point_light(s, 0, 0, 8, 1000);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, NULL);
    noc_patch part = {
        { -100, -100, 0 }, { 200, 0, 0 }, { 0, 200, 0 }, { 0, 0, 1 }, 40000, (uint32_t)floor, .level = 0
    };
    noc_region *region = region_of(&part, 1);
    noc_render_params p = no_sky(1);
    for (double error = .1; error > .009; error /= 10) {
        noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ .render = &p });
        noc_influence_sum sum;
        assert_int_equal(noc_ranking_refine(r, &(noc_ranking_target){ .error = error }, NULL), NOC_OK);
        assert_int_equal(noc_ranking_get(r, NULL, 0, NULL, &sum), NOC_OK);
        assert_true(sum.lux.error > 0 && sum.lux.error <= error * sum.lux.value);
        noc_ranking_destroy(r);
    }
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

/* Of a class that is a hundredth of the region, intervals hold the truth as often as they say, and so do totals. */
static void errors_of_classes_cover(void **state) {
    (void)state;
    noc_scene *s = crowd(400);
    uint32_t other = (uint32_t)grey_of(s, NOC_CLASS_ROAD);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, NULL);
    noc_patch parts[] = { quad_half(-6, -4, 12, 8, 0), quad_half(6, 4, -12, -8, 0), quad_half(-3, 2, 1, 1, other) };
    noc_region *region = region_of(parts, 3), *small = region_of(parts + 2, 1);
    noc_render_params p = no_sky(99991);
    answer all = ask(view, region, &p, 6000000), alone = ask(view, small, &p, 3000000);
    int inside[2] = { 0, 0 }, of = samples(200);
    for (int seed = 1; seed <= of; seed++) {
        noc_influence_class c[2];
        noc_influence_sum sum;
        size_t found;
        p.seed = (uint32_t)seed * 7919;
        noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ &p, NULL });
        assert_int_equal(noc_ranking_refine(r, NULL, NULL), NOC_OK);
        assert_int_equal(noc_ranking_get_classes(r, c, 2, &found), NOC_OK);
        assert_int_equal(noc_ranking_get(r, NULL, 0, NULL, &sum), NOC_OK);
        assert_true(found == 2 && c[1].cls == NOC_CLASS_ROAD);
        inside[0] += fabs(c[1].lux.value - alone.sum.lux.value) < 1.96 * c[1].lux.error;
        inside[1] += fabs(sum.lux.value - all.sum.lux.value) < 1.96 * sum.lux.error;
        noc_ranking_destroy(r);
    }
    print_message("# %d %% of a small class, %d %% of totals within 1.96 standard errors\n", 100 * inside[0] / of,
                  100 * inside[1] / of);
    for (int i = 0; i < 2; i++)
        assert_true(SANITIZED || (inside[i] > (0.95 - slack(0.05)) * of && (inside[i] < of || is_quick())));
    noc_region_destroy(region);
    noc_region_destroy(small);
    close_view(view);
    noc_scene_destroy(s);
}

/* ---- textures ---- */

enum { TEXELS = 64, WIDTH = 48, HEIGHT = 32 };

/* A wall of 8 m x 8 m at y = 0, in patches of 8 x 8 texels of different grey and noise in them; 10 lx. */
static noc_scene *papered(void) {
    static unsigned char rgb[3 * TEXELS * TEXELS];
    noc_scene *s = noc_scene_create(NULL);
    for (int i = 0; i < TEXELS * TEXELS; i++)
        for (int c = 0; c < 3; c++)
            rgb[3 * i + c] = (unsigned char)(20 + (i / 8 * 37 + i / (8 * TEXELS) * 91) % 150 + (i * 7919 >> 3) % 40);
    int texture =
        noc_scene_add_texture(s, &(noc_texture){ TEXELS, TEXELS, rgb, .linear = true, .wrap = NOC_WRAP_CLAMP });
    const double xyz[] = { -4, 0, -4, 4, 0, -4, 4, 0, 4, -4, 0, 4 };
    const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
    noc_material m = { .albedo = { .9f, .8f, .7f }, .roughness = 1, .cls = NOC_CLASS_WALL, .texture = texture };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = noc_scene_add_material(s, &m),
                      .uv = uv,
                      .name = "wall" };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    point_light(s, 0, -1000, 0, 1e7f);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static double seen(noc_view *view, const noc_scene *s, const noc_camera *c, const noc_render_params *p,
                   const char *words) {
    noc_region *region =
        noc_region_find(view, s, words, &(noc_region_params){ .camera = c, .width = WIDTH, .height = HEIGHT }, NULL);
    noc_ranking *r = noc_ranking_create(view, region, &(noc_ranking_params){ p, c->eye });
    noc_influence_sum sum;
    assert_int_equal(noc_ranking_refine(r, NULL, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(r, NULL, 0, NULL, &sum), NOC_OK);
    noc_ranking_destroy(r);
    noc_region_destroy(region);
    return sum.luminance.value;
}

/* Pixels near by and so far off that several texels lie in one, and askew: their luminance is that of the picture. */
static void a_texture_is_seen_as_in_the_picture(void **state) {
    (void)state;
    noc_scene *s = papered();
    noc_view *view = own_view(s, 1, NULL);
    noc_render_params p = measure(WIDTH, HEIGHT, NOC_METHOD_REFERENCE);
    const noc_camera cameras[] = { look(0, -3, 0, 0.4, 0, 0.2, 40), look(0, -40, 0, 0, 0, 0, 9),
                                   look(-9, -4, 1, 0, 0, 0, 40) };
    double least = 1e9, most = 0;
    for (size_t k = 0; k < NOC_COUNT(cameras); k++) {
        noc_image *image = render(s, &cameras[k], &p, 1);
        for (int i = 5; i < WIDTH * HEIGHT; i += 61) {
            char words[40];
            double shown = luma(image->rgb + 3 * i);
            if (!(shown > 0))
                continue;
            snprintf(words, sizeof(words), "pixel:%d,%d", i % WIDTH, i / WIDTH);
            double told = seen(view, s, &cameras[k], &p, words);
            if (fabs(told - shown) > 0.02 * shown)
                fail_msg("camera %zu, %s: %g cd/m2 told, %g shown", k, words, told, shown);
            least = fmin(least, shown);
            most = fmax(most, shown);
        }
        noc_image_destroy(image);
    }
    assert_true(most > 2 * least); /* else this says nothing */
    close_view(view);
    noc_scene_destroy(s);
}

/* The wall as an object: the mean over it, of which the reference has pixels. */
static void triangles_have_their_texture(void **state) {
    (void)state;
    noc_scene *s = papered();
    noc_view *view = own_view(s, 1, NULL);
    noc_render_params p = measure(64, 64, NOC_METHOD_REFERENCE);
    noc_camera c = look(0, -1000, 0, 0, 0, 0, 2 * atan(4 / 1000.0) * 180 / M_PI);
    noc_image *image = render(s, &c, &p, 1);
    double shown = 0;
    for (int i = 0; i < 64 * 64; i++)
        shown += luma(image->rgb + 3 * i) / (64 * 64);
    double told = seen(view, s, &c, &p, "object:wall");
    if (fabs(told - shown) > 0.02 * shown)
        fail_msg("%g cd/m2 told, %g shown", told, shown);
    noc_image_destroy(image);
    close_view(view);
    noc_scene_destroy(s);
}

/* ---- profiles, and a map around the scene ---- */

/* Lamps with an uneven profile, turned each to another side, among the crowd's walls. */
static noc_scene *luminaires(int count) {
    static const double c[] = { 0, 90, 180, 270 }, gamma[] = { 0, 30, 60, 90 };
    static const double cd[] = { 100, 150, 220, 0, 100, 120, 80, 0, 100, 60, 40, 0, 100, 90, 70, 0 };
    noc_profile *profile = NULL;
    noc_scene *s = crowd(0);
    assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ NULL, 4, 4, c, gamma, cd, 0 }, &profile), NOC_OK);
    int number = noc_scene_add_profile(s, profile);
    for (int i = 0; i < count; i++) {
        noc_light l = { .kind = NOC_LIGHT_POINT,
                        .position = { -7 + 14.0 * (i % 9) / 8, -5 + 10.0 * (i / 9) / 5, 2 + 0.2 * (i % 5) },
                        .direction = { 0.2, 0, -1 },
                        .c0 = { cos(i), sin(i), 0 },
                        .profile = number,
                        .emission = { 200 + 20.0f * (float)(i % 7), 250, 100 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_profile_destroy(profile);
    return s;
}

/* Bright in the west, low; 1/20 of it elsewhere. */
static void set_map(noc_scene *s) {
    enum { ROWS = 32 };
    noc_image *map = noc_image_create(2 * ROWS, ROWS, NULL);
    for (int i = 0; i < 2 * ROWS * ROWS; i++)
        for (int k = 0; k < 3; k++)
            map->rgb[3 * i + k] = i / (2 * ROWS) > 10 && i % (2 * ROWS) < 6 ? 20 : 1;
    assert_int_equal(noc_scene_set_environment(s, map), NOC_OK);
    noc_image_destroy(map);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

static void profiles_and_maps_are_those_of_brute_force(void **state) {
    (void)state;
    for (int map = 0; map < 2; map++) {
        noc_scene *s = luminaires(map ? 30 : 90); /* all looked at; drawn from the tree */
        if (map)
            set_map(s);
        noc_view *view = own_view(s, 2, NULL);
        noc_camera c = from_above();
        noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_REFERENCE);
        p.environment_light = map;
        bool sees[SIDE * SIDE];
        noc_region *region = pixels(view, &c, false, sees);
        int frames = map ? 60 : 12;
        double all = by_reference(s, view, &c, &p, sees, ALL_LIGHTS, frames);
        double sky = map ? by_reference(s, view, &c, &p, sees, NO_LIGHTS, frames) : 0;
        answer a = ask(view, region, &p, 2000000);
        print_message("# lux %g of %g, sky %g of %g\n", a.sum.lux.value, all, a.sum.sky.value, sky);
        assert_true(off(a.sum.lux, all) < 4);
        assert_true(map ? (SANITIZED || sky > 0.1 * all) && off(a.sum.sky, sky) < 4 &&
                              off(a.sum.sky_share, sky / all) < 4
                        : !(a.sum.sky.value > 0));
        p.environment_light = false;
        for (size_t i = 0; i < 4; i++) {
            double truth = by_reference(s, view, &c, &p, sees, (int)a.rows[i].emitter.light, 12);
            assert_true(off(a.rows[i].lux, truth) < 4 && off(a.rows[i].share, truth / all) < 4);
            assert_true(SANITIZED || a.rows[i].lux.error < 0.01 * truth);
        }
        noc_region_destroy(region);
        close_view(view);
        noc_scene_destroy(s);
    }
}

/* A point below such a lamp has I cos / d2 exactly. */
static void a_point_has_the_profile_s_candela(void **state) {
    (void)state;
    noc_scene *s = luminaires(60);
    noc_view *view = own_view(s, 1, NULL);
    noc_camera c = look(1.3, -2.1, 9, 1.3, -2, 0, 0.01);
    noc_render_params p = measure(4, 4, NOC_METHOD_REFERENCE);
    noc_image *image = render(s, &c, &p, 1);
    noc_patch y = point_at(1.3, -2, 0);
    noc_region *region = region_of(&y, 1);
    answer a = ask(view, region, &p, 0);
    assert_true(fabs(a.sum.lux.value * 0.5 / M_PI - luma(image->rgb)) < 2e-3 * luma(image->rgb) + 4 * a.sum.lux.error);
    noc_image_destroy(image);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(classes_have_their_closed_form),
                                        cmocka_unit_test(windows_stand_beside),
                                        cmocka_unit_test(errors_of_classes_cover),
                                        cmocka_unit_test(errors_bound_the_lux),
                                        cmocka_unit_test(a_texture_is_seen_as_in_the_picture),
                                        cmocka_unit_test(triangles_have_their_texture),
                                        cmocka_unit_test(profiles_and_maps_are_those_of_brute_force),
                                        cmocka_unit_test(a_point_has_the_profile_s_candela) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
