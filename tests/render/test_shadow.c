/* Shadow rays at both ends: nothing leaks, nothing shadows itself, near the origin and far from it; one-sided emission;
 * sky. */
#include "rooms.h"
#include "../own_view.h"

#include "core/sky.h"
#include "../core/no_profiles.h"

static double sum(const noc_image *image) {
    double s = 0;
    for (int i = 0; i < image->width * image->height; i++)
        s += luma(image->rgb + 3 * i);
    return s;
}

/* A wall at y = 0 facing -y, a floor before it, and a window `off` metres before (or behind) the wall, turned by 30
 * degrees around z so that nothing is aligned with an axis. */
static noc_scene *walled(double x0, double y0, double off, double angle) {
    noc_scene *s = noc_scene_create(NULL);
    int m = matte(s, 0.5f);
    double c = cos(angle), d = sin(angle);
    QUAD(s, m, x0 - 40 * c, y0 - 40 * d, 0, 80 * c, 80 * d, 0, 0, 0, 9);
    add_floor(s, m, x0, y0, 0, 30);
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                    .position = { x0 - c + off * d, y0 - d - off * c, 1 },
                    .edge_u = { 2 * c, 2 * d, 0 },
                    .edge_v = { 0, 0, 1.5 },
                    .emission = { 10, 10, 10 } };
    assert_true(noc_scene_add_light(s, &l) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static void windows_near_walls(void **state) {
    (void)state;
    const double places[][2] = { { 0, 0 }, { 100, -60 }, { 1000, 700 }, { 10000, 0 }, { -7000, 7100 } };
    for (size_t i = 0; i < NOC_COUNT(places); i++)
        for (int turn = 0; turn < 2; turn++) {
            double x = places[i][0], y = places[i][1], angle = turn ? M_PI / 6 : 0;
            noc_camera c = look(x + 2, y - 12, 7, x, y, 0.5, 60);
            noc_render_params p = measure(96, 64, NOC_METHOD_REFERENCE);
            p.emitters = false;
            noc_scene *before = walled(x, y, 0.01, angle), *behind = walled(x, y, -0.01, angle);
            noc_image *traced = render(before, &c, &p, 4);
            p.final_ray = false;
            noc_image *open = render(before, &c, &p, 4);
            p.final_ray = true;
            noc_image *leak = render(behind, &c, &p, 4);
            assert_true(sum(open) > 1);
            for (int k = 0; k < 96 * 64 * 3; k++) {
                assert_true(traced->rgb[k] == open->rgb[k]); /* neither wall nor window blocks the window */
                assert_true(leak->rgb[k] == 0);
            }
            noc_image_destroy(traced);
            noc_image_destroy(open);
            noc_image_destroy(leak);
            noc_scene_destroy(before);
            noc_scene_destroy(behind);
        }
}

/* Lamps of every kind over bumpy ground far away: what is lit from above is lit everywhere, without acne. */
static void no_acne(void **state) {
    (void)state;
    for (int kind = 0; kind < NOC_LIGHT_KIND_COUNT; kind++)
        for (double far = 0; far <= 10000; far += 10000) {
            noc_scene *s = noc_scene_create(NULL);
            int m = matte(s, 0.5f);
            for (int i = 0; i < 8; i++) /* a shallow valley: no facet hides another from the lamp */
                QUAD(s, m, far - 8 + 2 * i, far - 20, 0.05 * (i - 4) * (i - 4), 2, 0, 0.05 * (2 * (i - 4) + 1), 0, 40,
                     0);
            noc_light l = { .kind = (noc_light_kind)kind,
                            .position = { far + 0.3, far, 9 },
                            .radius = 0.2,
                            .edge_u = { 0, 0.5, 0 },
                            .edge_v = { 0.5, 0, 0 },
                            .direction = { 0, 0, -1 },
                            .outer_deg = 90,
                            .emission = { 500, 500, 500 } };
            assert_true(noc_scene_add_light(s, &l) >= 0);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
            noc_camera c = look(far, far - 14, 12, far, far, 0, 40);
            noc_render_params p = measure(64, 48, NOC_METHOD_RIS);
            p.emitters = false;
            p.learn = false; /* what is not traced is not learned from */
            noc_image *traced = render(s, &c, &p, 3);
            p.final_ray = false;
            noc_image *open = render(s, &c, &p, 3);
            assert_true(sum(open) > 1);
            for (int k = 0; k < 64 * 48 * 3; k++)
                assert_true(traced->rgb[k] == open->rgb[k]);
            noc_image_destroy(traced);
            noc_image_destroy(open);
            noc_scene_destroy(s);
        }
}

static void expect_unshadowed(noc_scene *s, const noc_camera *c, bool dark) {
    noc_render_params p = measure(48, 32, NOC_METHOD_REFERENCE);
    p.emitters = false;
    noc_image *traced = render(s, c, &p, 2);
    p.final_ray = false;
    noc_image *open = render(s, c, &p, 2);
    assert_true(sum(open) > 1);
    int wrong = 0;
    for (int k = 0; k < 48 * 32 * 3; k++)
        /* less: surfaces in the light's plane */
        wrong += open->rgb[k] > 1e-3f && traced->rgb[k] != (dark ? 0 : open->rgb[k]);
    assert_int_equal(wrong, 0);
    noc_image_destroy(traced);
    noc_image_destroy(open);
}

/* A point light or spot in a ceiling lights the room below it; its place is a float in the ceiling's plane, level or
 * turned. */
static void point_in_a_surface(void **state) {
    (void)state;
    for (int i = 0; i < 6; i++) {
        double far = i % 3 * 3000, rise = i < 3 ? 0 : 0.25;
        noc_scene *s = noc_scene_create(NULL);
        int m = matte(s, 0.5f);
        add_floor(s, m, far, far, 0, 6);
        QUAD(s, m, far - 8, far - 8, 3 - 8 * rise, 0, 16, 0, 16, 0, 16 * rise);
        noc_light l = { .kind = i % 2 ? NOC_LIGHT_SPOT : NOC_LIGHT_POINT,
                        .position = { far + 0.5, far + 1, 3 + 0.5 * rise },
                        .direction = { 0, 0, -1 },
                        .outer_deg = 90,
                        .emission = { 100, 100, 100 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_camera c = look(far, far - 4, 1.5, far + 0.5, far, 0, 60);
        expect_unshadowed(s, &c, false);
        noc_scene_destroy(s);
    }
}

/* A model of 24 mm: its floor does not shadow itself, and a sheet 0.02 mm over the floor does. */
static void small_model(void **state) {
    (void)state;
    for (int sheet = 0; sheet < 2; sheet++) {
        noc_scene *s = noc_scene_create(NULL);
        int m = matte(s, 0.5f);
        add_floor(s, m, 0.001, 0.002, 0.003, 0.012);
        if (sheet)
            QUAD(s, m, -0.011, -0.01, 0.00302, 0.024, 0, 0, 0, 0.024, 0);
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                        .position = { 0, 0, 0.009 },
                        .edge_u = { 0, 0.002, 0 },
                        .edge_v = { 0.002, 0, 0 },
                        .emission = { 50, 50, 50 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        /* under the sheet: from between the two the floor is seen at a slant */
        noc_camera c =
            sheet ? look(0.001, -0.0095, 0.003015, 0.001, 0, 0.003, 20) : look(0.001, -0.03, 0.03, 0.001, 0, 0.003, 20);
        expect_unshadowed(s, &c, sheet);
        noc_scene_destroy(s);
    }
}

/* What leaves a lamp as it is seen: the solid angle of its pixels times its luminance is that of the true sphere or
 * disc. */
static void lamps_as_seen(void **state) {
    (void)state;
    enum { SIDE = 200, VIEWS = 24 };
    for (int kind = NOC_LIGHT_SPHERE; kind <= NOC_LIGHT_DISC; kind++) {
        noc_scene *s = noc_scene_create(NULL);
        noc_light l = {
            .kind = (noc_light_kind)kind, .radius = 0.15, .direction = { 0, 0, 1 }, .emission = { 70, 70, 70 }
        };
        assert_true(noc_scene_add_light(s, &l) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_RIS);
        double mean = 0, half = 0.25, distance = 100;
        for (int i = 0; i < VIEWS; i++) {
            double z = 0.2 + 0.8 * (i + 0.5) / VIEWS, r = sqrt(1 - z * z), t = 2.399963 * i;
            noc_camera c = look(distance * r * cos(t), distance * r * sin(t), distance * z, 0, 0, 0,
                                2 * atan(half / distance) * 180 / M_PI);
            noc_image *image = render(s, &c, &p, 1);
            double area = sum(image) / 70 * (2 * half / SIDE) * (2 * half / SIDE) / (M_PI * 0.15 * 0.15);
            if (kind == NOC_LIGHT_DISC)
                area /= z;
            assert_true(fabs(area - 1) < (kind == NOC_LIGHT_DISC ? 0.02 : 0.015));
            mean += area / VIEWS;
            noc_image_destroy(image);
        }
        print_message("# kind %d: %.4f of its flux is seen\n", kind, mean);
        assert_true(fabs(mean - 1) < 0.005);
        noc_scene_destroy(s);
    }
}

/* Light leaves the front only, unless the material says otherwise; what stands behind stays dark. */
static void one_sided(void **state) {
    (void)state;
    for (int two = 0; two < 2; two++) {
        noc_scene *s = noc_scene_create(NULL);
        noc_material glow = { .roughness = 1, .emission = { 30, 30, 30 }, .two_sided = two };
        add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
        QUAD(s, noc_scene_add_material(s, &glow), -1, 0, 1, 2, 0, 0, 0, 0, 2); /* faces -y */
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
            noc_render_params p = measure(32, 24, (noc_method)m);
            p.emitters = false;
            noc_camera front = look(0, -9, 6, 0, -4, 0, 20), back = look(0, 9, 6, 0, 4, 0, 20);
            noc_image *a = render(s, &front, &p, 4), *b = render(s, &back, &p, 4);
            assert_true(sum(a) > 1);
            assert_true(two ? fabs(sum(b) / sum(a) - 1) < 0.1 : sum(b) == 0);
            noc_image_destroy(a);
            noc_image_destroy(b);
        }
        noc_camera close = look(0, 5, 2, 0, 0, 2, 5); /* the back alone, as it shines itself */
        noc_render_params p = measure(8, 8, NOC_METHOD_RIS);
        noc_image *seen = render(s, &close, &p, 1);
        for (size_t i = 0; i < 3 * 8 * 8; i++)
            assert_true(seen->rgb[i] == (two ? 30 : 0));
        noc_image_destroy(seen);
        noc_scene_destroy(s);
    }
}

/* An open white floor under the sky alone: E = integral of L cos over the upper half; a roof takes it away. */
static void sky_light(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 1), 0, 0, 0, 50);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = measure(16, 16, NOC_METHOD_RESTIR);
    p.sky = 0.2;
    noc_camera c = look(0, -1, 5, 0, 0, 0, 20);
    noc_image *image = render(s, &c, &p, 400);
    /* L = zenith (1 + 3 (1 - z)^4): E = 2 pi zenith (1/2 + 3 / 30) */
    double want = 0.2 * 2 * (0.5 + 3.0 / 30);
    assert_true(fabs(sum(image) / 256 - want) < 0.01 * want);
    noc_image_destroy(image);
    /* Nothing else lights it: four rays a pixel. */
    noc_frame_stats stats;
    noc_view *r = own_view(s, 0, NULL);
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.rays_shadow, 4 * 256);
    close_view(r);
    noc_camera up = look(0, 0, 1, 0, 0.001, 9, 2);
    image = render(s, &up, &p, 1);
    assert_true(fabs(sum(image) / 256 - 0.2) < 1e-3); /* the zenith itself */
    assert_true(image->rgb[2] > image->rgb[0]);
    noc_image_destroy(image);
    noc_scene_destroy(s);
    s = noc_scene_create(NULL);
    int m = matte(s, 1);
    add_floor(s, m, 0, 0, 0, 50);
    for (int side = 0; side < 2; side++) {
        QUAD(s, m, -20, -20 + 40 * side, -1, 40, 0, 0, 0, 0, 21);
        QUAD(s, m, -20 + 40 * side, -20, -1, 0, 40, 0, 0, 0, 21);
    }
    add_floor(s, m, 0, 0, 20, 20);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    image = render(s, &c, &p, 50);
    assert_true(sum(image) == 0); /* a closed room: not one ray slips through its edges */
    noc_image_destroy(image);
    noc_scene_destroy(s);
}

/* Light of the sky that a floor sends towards wo, by the midpoint rule: no sampling, so nothing of core/sky.h but the
 * sky. */
static double sky_integral(surf s, double zenith) {
    enum { RINGS = 4000, TURNS = 2880 };
    double total = 0;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < TURNS; k++) {
            double z = (i + 0.5) / RINGS, r = sqrt(1 - z * z), t = 2 * M_PI * (k + 0.5) / TURNS;
            v3 d = { (float)(r * cos(t)), (float)(r * sin(t)), (float)z };
            total += luminance(tint3(reflect(s, d), sky_radiance(d, (float)zenith)));
        }
    return total * 2 * M_PI / RINGS / TURNS;
}

static double sky_on_floor(double albedo, double f0, double roughness, double height, int frames, uint32_t seed,
                           double want, double *noise) {
    noc_scene *s = noc_scene_create(NULL);
    noc_material m = { .albedo = { (float)albedo, (float)albedo, (float)albedo },
                       .f0 = (float)f0,
                       .roughness = (float)roughness };
    add_floor(s, noc_scene_add_material(s, &m), 0, 0, 0, 50);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = measure(64, 64, NOC_METHOD_RIS);
    p.sky = 0.2;
    p.seed = seed;
    noc_camera c = look(0, -10, height, 0, 0, 0, 0.05); /* so narrow that every pixel sees the same */
    noc_image *image = render(s, &c, &p, frames);
    double mean = sum(image) / 4096, square = 0;
    for (int i = 0; i < 4096; i++)
        square += pow(luma(image->rgb + 3 * i) / want - 1, 2) / 4096;
    *noise = sqrt(square);
    noc_image_destroy(image);
    noc_scene_destroy(s);
    return mean;
}

/* Matte, satin, glossy and nearly mirroring floors, black and white, seen from above and at a grazing angle: the mean
 * over independent pixels of one frame, and over frames, is the integral. */
static void sky_on_gloss(void **state) {
    (void)state;
    static const struct {
        double albedo, f0, roughness, height;
    } floors[] = {
        { 0.5, 0, 1, 6 },     { 0.8, 0.04, 0.4, 6 }, { 0.8, 0.04, 0.15, 1.5 }, { 0, 0.5, 0.3, 4 },
        { 0.3, 0.5, 0.1, 8 }, { 0, 0.04, 0.15, 6 },  { 0.05, 0.02, 0.3, 0.7 }, { 0.2, 1, 0.6, 3 },
    };
    for (size_t i = 0; i < NOC_COUNT(floors); i++) {
        double h = floors[i].height, d = sqrt(100 + h * h), noise;
        surf s = { .n = { 0, 0, 1 },
                   .wo = { 0, (float)(-10 / d), (float)(h / d) },
                   .f0 = (float)floors[i].f0,
                   .albedo = { (float)floors[i].albedo, (float)floors[i].albedo, (float)floors[i].albedo },
                   .alpha = (float)(floors[i].roughness * floors[i].roughness) };
        double want = sky_integral(s, 0.2);
        for (int frames = 1; frames <= 16; frames += 15) {
            double mean =
                sky_on_floor(floors[i].albedo, floors[i].f0, floors[i].roughness, h, frames, (uint32_t)i, want, &noise);
            double error = noise / 64; /* 4096 independent pixels */
            print_message("# albedo %g f0 %g roughness %g: %d frames %.5f of %.5f, noise %.3f\n", floors[i].albedo,
                          floors[i].f0, floors[i].roughness, frames, mean, want, noise);
            assert_true(fabs(mean / want - 1) < 4 * error + 1e-3);
            assert_true(noise < (frames == 1 ? 1 : 0.15)); /* no fireflies; frames are spread evenly */
        }
    }
}

/* Under the horizon the background fades smoothly, and meets the sky there without a step. */
static void horizon_fades(void **state) {
    (void)state;
    double last = luminance(sky_backdrop(V3(1, 0, 0), 1)), at_horizon = luminance(sky_radiance(V3(1, 0, 0), 1));
    assert_true(fabs(last - at_horizon) < 1e-6);
    for (double a = 0.1; a <= 90; a += 0.1) {
        double down = a * M_PI / 180;
        v3 d = { (float)cos(down), 0, (float)-sin(down) };
        double y = luminance(sky_backdrop(d, 1));
        assert_true(y <= last && last - y < 0.02 * at_horizon);
        assert_true(a < 15 || y < 0.05 * at_horizon);
        last = y;
        d.z = -d.z; /* above, background and light are one */
        assert_true(luminance(sky_backdrop(d, 1)) == luminance(sky_radiance(d, 1)));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(windows_near_walls), cmocka_unit_test(no_acne),       cmocka_unit_test(point_in_a_surface),
        cmocka_unit_test(small_model),        cmocka_unit_test(lamps_as_seen), cmocka_unit_test(one_sided),
        cmocka_unit_test(sky_light),          cmocka_unit_test(sky_on_gloss),  cmocka_unit_test(horizon_fades),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
