/* Pictures against what can be computed by hand: units and geometry end to end. */
#include "rooms.h"
#include "../own_view.h"

static noc_scene *scene_done(noc_scene *s) {
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* Of one light every sample is the same, and so is every way to combine them; of one neighbour none is drawn. */
static noc_render_params exact(int width, int height, noc_method method) {
    noc_render_params p = measure(width, height, method);
    p.neighbours = 1;
    return p;
}

/* E = I cos^3 / h^2 under a point luminaire; L = E albedo / pi. Exact in one frame: one light, no occlusion. */
static void point_over_plane(void **state) {
    (void)state;
    for (double far = 0; far <= 5000; far += 5000) {
        noc_scene *s = noc_scene_create(NULL);
        add_floor(s, matte(s, 0.5f), far, -far, 0, 40);
        double h = 6, intensity = 300;
        noc_light l = { .kind = NOC_LIGHT_POINT, .position = { far + 1, -far + 2, h }, .emission = { 300, 300, 300 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
        scene_done(s);
        noc_camera c = look(far, -far - 12, 9, far, -far, 0, 50);
        for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
            noc_render_params p = exact(48, 32, (noc_method)m);
            noc_image *image = render(s, &c, &p, 2);
            for (int y = 12; y < 32; y += 3)
                for (int x = 0; x < 48; x += 5) {
                    double q[3];
                    floor_point(&c, &p, x, y, 0, q);
                    double dx = q[0] - far - 1, dy = q[1] + far - 2, cosine = h / sqrt(dx * dx + dy * dy + h * h);
                    double e = intensity * cosine * cosine * cosine / (h * h);
                    double got = luma(image->rgb + 3 * (y * 48 + x));
                    assert_true(fabs(got - e * 0.5 / M_PI) < (far > 0 ? 2e-3 : 2e-5) * e);
                }
            noc_image_destroy(image);
        }
        noc_scene_destroy(s);
    }
}

/* A spot h over a plane, upright and tilted: E = I f^2 cos / d^2 by glTF's KHR_lights_punctual, f = (cos t - cos o) /
 * (cos i - cos o) between the cones, 1 within and 0 beyond. Straight down, the plane's illuminance sums up to the flux,
 * 2 pi I (1 - cos o - 2/3 (cos i - cos o)). */
static void spot_over_plane(void **state) {
    (void)state;
    for (int tilted = 0; tilted < 2; tilted++) {
        noc_scene *s = noc_scene_create(NULL);
        add_floor(s, matte(s, 0.5f), 0, 0, 0, 40);
        double h = 5, intensity = 700, inner = 25, outer = 50;
        double ci = cos(inner * M_PI / 180), co = cos(outer * M_PI / 180);
        noc_light l = { .kind = NOC_LIGHT_SPOT,
                        .position = { 0, 0, h },
                        .direction = { 0.4 * tilted, 0.2 * tilted, -1 },
                        .inner_deg = inner,
                        .outer_deg = outer,
                        .emission = { 700, 700, 700 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
        scene_done(s);
        double side = 16, length = sqrt(1 + 0.2 * tilted), area = side * side / (64 * 64);
        noc_camera c = look(0, 0, 100, 0, 0, 0, 2 * 180 / M_PI * atan(side / 2 / 100));
        c.up[1] = 1, c.up[2] = 0;
        for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
            noc_render_params p = exact(64, 64, (noc_method)m);
            noc_image *image = render(s, &c, &p, 1);
            double flux = 0;
            int inside = 0, between = 0, outside = 0;
            for (int y = 0; y < 64; y++)
                for (int x = 0; x < 64; x++) {
                    double q[3];
                    floor_point(&c, &p, x, y, 0, q);
                    double d2 = q[0] * q[0] + q[1] * q[1] + h * h, cosine = h / sqrt(d2);
                    double t = (l.direction[0] * q[0] + l.direction[1] * q[1] + h) / (length * sqrt(d2));
                    double f = t >= ci ? 1 : t <= co ? 0 : (t - co) / (ci - co), e = intensity * f * f * cosine / d2;
                    double got = luma(image->rgb + 3 * (y * 64 + x)) * M_PI / 0.5;
                    assert_true(fabs(got - e) < 5e-5 * intensity / (h * h));
                    flux += got * area;
                    inside += f == 1, between += f > 0 && f < 1, outside += f == 0;
                }
            assert_true(inside > 200 && between > 500 && outside > 500);
            assert_true(tilted || fabs(flux / (2 * M_PI * intensity * (1 - co - (ci - co) * 2 / 3)) - 1) < 2e-3);
            noc_image_destroy(image);
        }
        noc_scene_destroy(s);
    }
}

/* Illuminance factor of a rectangle [x0, x1] x [y0, y1] at height h, parallel to the plane, facing down: E = L F' with
 * F' = pi * form factor, summed from its corners (Howell, configuration factor B-4). */
static double corner(double x, double y, double h) {
    double a = sqrt(h * h + x * x), b = sqrt(h * h + y * y);
    return 0.5 * (x / a * atan(y / a) + y / b * atan(x / b));
}

static double rectangle(double x0, double x1, double y0, double y1, double h) {
    return corner(x1, y1, h) - corner(x0, y1, h) - corner(x1, y0, h) + corner(x0, y0, h);
}

static void rectangle_over_plane(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.4f), 0, 0, 0, 30);
    /* faces down: edge_u x edge_v = -z */
    noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                    .position = { -1, -2, 3 },
                    .edge_u = { 0, 4, 0 },
                    .edge_v = { 3, 0, 0 },
                    .emission = { 50, 50, 50 } };
    assert_true(noc_scene_add_light(s, &l) >= 0);
    scene_done(s);
    noc_camera c = look(0, -9, 2.5, 0, 0, 0, 60);
    for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
        noc_render_params p = exact(32, 16, (noc_method)m);
        p.temporal = false; /* frames independent: their spread says how far off the mean may be */
        int frames = 400;
        noc_view *r = own_view(s, 0, NULL);
        double sum[32 * 16] = { 0 }, square[32 * 16] = { 0 };
        p.accumulate = false;
        for (int i = 0; i < frames; i++) {
            assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
            noc_image *image = noc_view_image(r);
            for (int k = 0; k < 32 * 16; k++) {
                double v = luma(image->rgb + 3 * k);
                sum[k] += v;
                square[k] += v * v;
            }
            noc_image_destroy(image);
        }
        close_view(r);
        int checked = 0;
        for (int y = 8; y < 16; y++)
            for (int x = 1; x < 32; x += 3) {
                double q[3];
                floor_point(&c, &p, x, y, 0, q);
                int k = y * 32 + x;
                double mean = sum[k] / frames, error = sqrt(fmax(square[k] / frames - mean * mean, 0) / frames);
                double want = 50 * rectangle(-1 - q[0], 2 - q[0], -2 - q[1], 2 - q[1], 3) * 0.4 / M_PI;
                assert_true(fabs(mean - want) < 5 * error + 2e-5 * want);
                assert_true(error < 0.05 * want); /* tight enough to mean something */
                checked++;
            }
        assert_true(checked > 50);
    }
    noc_scene_destroy(s);
}

/* E = I(C, gamma) cos / d^2 under a lamp of 1000 lm whose profile is uneven around its axis, by every method. */
static void profile_over_plane(void **state) {
    (void)state;
    double c[] = { 0, 90, 180, 270 }, gamma[] = { 0, 30, 60, 90 }, cd[16];
    for (int i = 0; i < 16; i++)
        cd[i] = i % 4 == 3 ? 0 : (1 + i / 4) * (1 + i % 4);
    noc_profile *profile = NULL;
    assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ NULL, 4, 4, c, gamma, cd, 0 }, &profile), NOC_OK);
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    noc_light l = { .kind = NOC_LIGHT_POINT,
                    .position = { 0.5, -1, 4 },
                    .direction = { 0, 0, -1 },
                    .c0 = { 0, 1, 0 },
                    .profile = noc_scene_add_profile(s, profile),
                    .emission = { 1000, 1000, 1000 } };
    assert_true(noc_scene_add_light(s, &l) >= 0);
    scene_done(s);
    noc_camera eye = look(0, -6, 5, 0, 0, 0, 60);
    for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
        noc_render_params p = exact(32, 24, (noc_method)m);
        noc_image *image = render(s, &eye, &p, 1);
        for (int y = 10; y < 24; y++)
            for (int x = 0; x < 32; x++) {
                double q[3];
                floor_point(&eye, &p, x, y, 0, q);
                double dx = q[0] - .5, dy = q[1] + 1, d2 = dx * dx + dy * dy + 16;
                /* C 0 is +y, and C turns counter-clockwise from above: C 90 is -x */
                double at = atan2(-dx, dy) * 180 / M_PI, g = acos(4 / sqrt(d2)) * 180 / M_PI;
                double lux = 1000 * noc_profile_intensity(profile, at, g) / noc_profile_flux(profile, 0, 180, NAN) * 4 /
                             (d2 * sqrt(d2));
                double got = luma(image->rgb + 3 * (y * 32 + x)) * M_PI / 0.5;
                if (fabs(got - lux) > 2e-4 * lux + 1e-3)
                    fail_msg("method %d, C %g, gamma %g: %g lx, not %g", m, at, g, got, lux);
            }
        noc_image_destroy(image);
    }
    noc_profile_destroy(profile);
    noc_scene_destroy(s);
}

/* A floor lit with 100 lx by a far small lamp reads 100 lx: pi L / albedo. */
static void hundred_lux(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.25f), 0, 0, 0, 5);
    noc_light l = { .kind = NOC_LIGHT_SPHERE, .position = { 0, 0, 100 }, .radius = 0.5 };
    /* E = L pi r^2 / d^2 on the axis of a sphere */
    for (int k = 0; k < 3; k++)
        l.emission[k] = (float)(100 * 100.0 * 100.0 / (M_PI * 0.5 * 0.5));
    assert_true(noc_scene_add_light(s, &l) >= 0);
    scene_done(s);
    noc_camera c = look(0, -1, 4, 0, 0, 0, 3);
    for (int m = NOC_METHOD_REFERENCE; m <= NOC_METHOD_RESTIR; m++) {
        noc_render_params p = exact(8, 8, (noc_method)m);
        noc_image *image = render(s, &c, &p, 64);
        double mean = 0;
        for (int k = 0; k < 64; k++)
            mean += luma(image->rgb + 3 * k) / 64;
        assert_true(fabs(mean * M_PI / 0.25 - 100) < 0.05);
        noc_image_destroy(image);
    }
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_over_plane),   cmocka_unit_test(spot_over_plane), cmocka_unit_test(rectangle_over_plane),
        cmocka_unit_test(profile_over_plane), cmocka_unit_test(hundred_lux),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
