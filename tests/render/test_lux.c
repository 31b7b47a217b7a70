/* Luminance and illuminance against what can be computed by hand. */
#include "views.h"

#include <nocturne/photometry.h>

enum { BOTH = 1u << NOC_AOV_LUMINANCE | 1u << NOC_AOV_ILLUMINANCE };

static noc_scene *done(noc_scene *s) {
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* Every method, and every picker that it has. */
typedef struct way {
    noc_method method;
    noc_candidates candidates;
} way;
static const way ways[] = {
    { NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS },  { NOC_METHOD_IS, NOC_CANDIDATES_UNIFORM },
    { NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM },      { NOC_METHOD_RIS, NOC_CANDIDATES_POWER },
    { NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE },    { NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH },
    { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS },        { NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM },
    { NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS },     { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH },
    { NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE }, { NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER },
};

/* lux: of the floor's place q, by hand. */
typedef double (*law)(const double q[3], const void *what);

static void hold(noc_scene *s, law lux, const void *what, double albedo, double slack) {
    noc_camera c = look(0, -12, 9, 0, 0, 0, 50);
    for (size_t k = 0; k < NOC_COUNT(ways); k++) {
        noc_render_params p = with(ways[k].method, ways[k].candidates, BOTH);
        p.neighbours = 1; /* of more some are drawn, and it would be so in the mean alone */
        noc_view *r = rendered(s, &c, &p, 2, 2);
        noc_channel *e = view(r, NOC_AOV_ILLUMINANCE), *l = view(r, NOC_AOV_LUMINANCE);
        assert_string_equal(e->unit, "lx");
        assert_string_equal(l->unit, "cd/m2");
        int lit = 0;
        for (int i = N / 2; i < N; i++) {
            double q[3], by_hand;
            floor_point(&c, &p, i % W, i / W, 0, q);
            by_hand = lux(q, what);
            lit += by_hand > 0.1;
            assert_true(fabs(e->value[i] - by_hand) < slack * (by_hand + 1));
            assert_true(fabs(l->value[i] - e->value[i] * albedo / M_PI) < 1e-5 * (by_hand + 1));
        }
        assert_true(lit > N / 4);
        noc_channel_destroy(e);
        noc_channel_destroy(l);
        close_view(r);
    }
    noc_scene_destroy(s);
}

/* E = I cos / d^2 under 300 cd at a height of 6 m, whatever the floor reflects. */
static double of_point(const double q[3], const void *what) {
    (void)what;
    double d2 = (q[0] - 1) * (q[0] - 1) + (q[1] - 2) * (q[1] - 2) + 36;
    return 300 * 6 / (d2 * sqrt(d2));
}

static void point_over_floors(void **state) {
    (void)state;
    static const float albedo[] = { 0.5f, 0.04f, 1 };
    for (size_t i = 0; i < NOC_COUNT(albedo); i++) {
        noc_scene *s = noc_scene_create(NULL);
        add_floor(s, matte(s, albedo[i]), 0, 0, 0, 60);
        point_light(s, 1, 2, 6, 300);
        hold(done(s), of_point, NULL, albedo[i], 2e-5);
    }
}

/* E = I(C, gamma) cos / d^2 of a measured distribution of 1000 lm, uneven around its axis. */
static double of_profile(const double q[3], const void *what) {
    double dx = q[0], dy = q[1], d2 = dx * dx + dy * dy + 25, d = sqrt(d2);
    double c = atan2(dy, dx) * 180 / M_PI, gamma = acos(5 / d) * 180 / M_PI;
    double cd = noc_profile_intensity(what, c < 0 ? c + 360 : c, gamma) / noc_profile_flux(what, 0, 180, NAN);
    return 1000 * cd * 5 / (d * d2);
}

static void profile_over_a_floor(void **state) {
    (void)state;
    static const double c[] = { 0, 90, 180, 270 }, gamma[] = { 0, 30, 60, 90 };
    static const double cd[] = { 100, 150, 220, 0, 100, 120, 80, 0, 100, 60, 40, 0, 100, 90, 70, 0 };
    noc_profile *profile = NULL;
    noc_scene *s = noc_scene_create(NULL);
    assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ NULL, 4, 4, c, gamma, cd, 0 }, &profile), NOC_OK);
    add_floor(s, matte(s, 0.3f), 0, 0, 0, 60);
    noc_light l = { .kind = NOC_LIGHT_POINT,
                    .position = { 0, 0, 5 },
                    .direction = { 0, 0, -1 },
                    .c0 = { 1, 0, 0 },
                    .profile = noc_scene_add_profile(s, profile),
                    .emission = { 1000, 1000, 1000 } };
    assert_true(noc_scene_add_light(s, &l) >= 0);
    hold(done(s), of_profile, profile, 0.3, 2e-3);
    noc_profile_destroy(profile);
}

/* An open floor under the sky alone: luminance z (1 + 3 (1 - sin h)^4) at the height h gives 1.2 pi z. */
static void open_sky(void **state) {
    (void)state;
    noc_camera c = look(0, -12, 9, 0, 0, 0, 50);
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.25f), 0, 0, 0, 60);
    done(s);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, BOTH);
    p.sky = 0.1;
    noc_view *r = rendered(s, &c, &p, 400, 2);
    noc_channel *e = view(r, NOC_AOV_ILLUMINANCE), *l = view(r, NOC_AOV_LUMINANCE);
    double mean = 0;
    for (int i = N / 2; i < N; i++) {
        mean += e->value[i] / (N / 2);
        assert_true(fabs(e->value[i] / (1.2 * M_PI * 0.1) - 1) < 0.02);
        assert_true(fabs(l->value[i] / (e->value[i] * 0.25 / M_PI) - 1) < 1e-4);
    }
    assert_true(fabs(mean / (1.2 * M_PI * 0.1) - 1) < 1e-3);
    noc_channel_destroy(e);
    noc_channel_destroy(l);
    close_view(r);
    noc_scene_destroy(s);
}

/* An emitter has its own luminance and is not lit; beyond the floor there is no surface, but a sky. */
static void emitters_and_sky(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 9);
    noc_light panel = { .kind = NOC_LIGHT_PARALLELOGRAM, /* faces -y, where the camera is */
                        .position = { -2, 1, 2 },
                        .edge_u = { 3, 0, 0 },
                        .edge_v = { 0, 0, 2 },
                        .emission = { 900, 900, 900 } };
    assert_true(noc_scene_add_light(s, &panel) >= 0);
    done(s);
    noc_camera c = look(1, -10, 4, 0, 0, 1.5, 60);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, BOTH | 1u << NOC_AOV_CLASS);
    p.sky = 0.05;
    noc_view *r = rendered(s, &c, &p, 4, 1);
    noc_channel *e = view(r, NOC_AOV_ILLUMINANCE), *l = view(r, NOC_AOV_LUMINANCE), *cls = view(r, NOC_AOV_CLASS);
    int panels = 0, sky = 0;
    for (int i = 0; i < N; i++) {
        bool shines = cls->value[i] == NOC_CLASS_LAMP, nothing = cls->value[i] < 0;
        panels += shines;
        sky += nothing;
        assert_int_equal(e->value[i] < 0, shines || nothing);
        if (shines)
            assert_true(fabs(l->value[i] - 900) < 1e-2);
        if (nothing)
            assert_true(l->value[i] > 0.0012 && l->value[i] < 0.21);
    }
    assert_true(panels > 10 && sky > 10);
    noc_channel_destroy(e);
    noc_channel_destroy(l);
    noc_channel_destroy(cls);
    close_view(r);
    noc_scene_destroy(s);
}

/* Where no candidate of a light can be kept, the number would be too low, and there is none: black paint, also under
 * gloss; red paint under a blue light, but not under one that has some red. */
static void surfaces_that_cannot_tell(void **state) {
    (void)state;
    static const struct {
        noc_material floor;
        float light[3];
        bool told;
    } cases[] = {
        { { .albedo = { 0, 0, 0 }, .roughness = 1 }, { 9, 9, 9 }, false },
        { { .albedo = { 0, 0, 0 }, .f0 = 0.04f, .roughness = 0.3f }, { 9, 9, 9 }, false },
        { { .albedo = { 0.5f, 0, 0 }, .roughness = 1 }, { 0, 0, 9 }, false },
        { { .albedo = { 0.5f, 0, 0 }, .roughness = 1 }, { 0.1f, 5, 9 }, true },
        { { .albedo = { 0.01f, 0.01f, 0.01f }, .roughness = 1 }, { 0, 0, 9 }, true },
    };
    noc_camera c = look(0, -12, 9, 0, 0, 0, 50);
    for (size_t k = 0; k < NOC_COUNT(cases); k++) {
        noc_scene *s = noc_scene_create(NULL);
        add_floor(s, noc_scene_add_material(s, &cases[k].floor), 0, 0, 0, 60);
        noc_light l = { .kind = NOC_LIGHT_POINT, .position = { 1, 2, 6 } };
        memcpy(l.emission, cases[k].light, sizeof(l.emission));
        int light = noc_scene_add_light(s, &l);
        noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_POWER, BOTH);
        noc_view *r = rendered(done(s), &c, &p, 1, 1);
        for (int turn = 0; turn < 2; turn++) { /* then the light is white, which all but black tell */
            noc_channel *e = view(r, NOC_AOV_ILLUMINANCE);
            double cd = luma(turn ? (const float[]){ 2, 2, 2 } : cases[k].light);
            for (int i = N / 2; i < N; i++) {
                double q[3];
                floor_point(&c, &p, i % W, i / W, 0, q);
                if (!(turn ? cases[k].floor.albedo[0] > 0 : cases[k].told))
                    assert_true(e->value[i] == -1);
                else
                    assert_true(fabs(e->value[i] / (of_point(q, NULL) / 300 * cd) - 1) < 1e-4);
            }
            noc_channel_destroy(e);
            assert_int_equal(noc_scene_set_emission(s, light, (float[3]){ 2, 2, 2 }), NOC_OK);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
            assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
        }
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* A wet floor under a street of lamps. */
static noc_scene *wet(float f0) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material floor = { .albedo = { 0.05f, 0.05f, 0.05f }, .f0 = f0, .roughness = 0.25f };
    add_floor(s, noc_scene_add_material(s, &floor), 0, 0, 0, 60);
    for (int i = 0; i < 40; i++)
        point_light(s, i % 4 * 6 - 9, i / 4 * 5 - 20, 6, 300);
    return done(s);
}

/* relMSE of illuminance of single frames, against the law of the inverse square. */
static double lux_error(const noc_scene *s, noc_candidates candidates, bool gloss) {
    noc_camera c = look(0, -12, 3, 0, 0, 1, 50);
    noc_render_params p = with(NOC_METHOD_RIS, candidates, 1u << NOC_AOV_ILLUMINANCE);
    double sum = 0;
    p.gloss = gloss;
    p.accumulate = false;
    for (uint32_t seed = 1; seed <= 8; seed++) {
        p.seed = seed;
        noc_view *r = rendered(s, &c, &p, 1, 1);
        noc_channel *e = view(r, NOC_AOV_ILLUMINANCE);
        for (int i = N * 3 / 4; i < N; i++) {
            double q[3], lux = 0;
            floor_point(&c, &p, i % W, i / W, 0, q);
            for (int k = 0; k < 40; k++) {
                double x = k % 4 * 6 - 9 - q[0], y = k / 4 * 5 - 20 - q[1], d2 = x * x + y * y + 36;
                lux += 300 * 6 / (d2 * sqrt(d2));
            }
            sum += pow(e->value[i] / lux - 1, 2);
        }
        noc_channel_destroy(e);
        close_view(r);
    }
    return sum / (8.0 * N / 4);
}

/* Without gloss a frame is that of matte surfaces, to the bit; and of a wet street illuminance is found with less
 * noise, for light is not sampled for what mirrors. */
static void gloss_is_left_out(void **state) {
    (void)state;
    noc_camera c = look(0, -12, 3, 0, 0, 1, 50);
    noc_scene *s[2] = { wet(0.02f), wet(0) };
    for (size_t k = 0; k < NOC_COUNT(ways); k++) {
        noc_image *image[3];
        for (int i = 0; i < 3; i++) { /* wet without gloss, matte, wet */
            noc_render_params p = with(ways[k].method, ways[k].candidates, 0);
            p.gloss = i > 0;
            noc_view *r = rendered(s[i == 1], &c, &p, 2, 2);
            image[i] = noc_view_image(r);
            assert_non_null(image[i]);
            close_view(r);
        }
        assert_memory_equal(image[0]->rgb, image[1]->rgb, 3 * N * sizeof(float));
        assert_memory_not_equal(image[0]->rgb, image[2]->rgb, 3 * N * sizeof(float));
        for (int i = 0; i < 3; i++)
            noc_image_destroy(image[i]);
    }
    static const noc_candidates some[] = { NOC_CANDIDATES_UNIFORM, NOC_CANDIDATES_LIGHT_BVH, NOC_CANDIDATES_LISTS };
    for (size_t k = 0; k < NOC_COUNT(some); k++) {
        double glossy = lux_error(s[0], some[k], true), matte = lux_error(s[0], some[k], false);
        print_message("# relMSE of illuminance of one frame: %.3g with gloss, %.3g without\n", glossy, matte);
        assert_true(matte < 0.5 * glossy);
    }
    noc_scene_destroy(s[0]);
    noc_scene_destroy(s[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_over_floors), cmocka_unit_test(profile_over_a_floor),
        cmocka_unit_test(open_sky),          cmocka_unit_test(emitters_and_sky),
        cmocka_unit_test(gloss_is_left_out), cmocka_unit_test(surfaces_that_cannot_tell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
