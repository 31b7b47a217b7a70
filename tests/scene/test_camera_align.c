/* The camera of a photograph, from places and pixels that a known camera made. */
#include "../test.h"

#include <math.h>
#include <nocturne/scene.h>

enum { W = 4000, H = 3000, MOST = 12 };

static double uniform(void) {
    static uint32_t seed = 7;
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

static double between(double a, double b) { return a + (b - a) * uniform(); }
static double normal(void) { return sqrt(-2 * log(uniform() + 1e-9)) * cos(2 * M_PI * uniform()); }

static double apart(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static noc_camera some_camera(void) {
    double yaw = between(0, 2 * M_PI), pitch = between(-.5, .3);
    noc_camera c = { .eye = { between(-500, 500), between(-500, 500), between(2, 80) },
                     .up = { between(-.1, .1), between(-.1, .1), 1 },
                     .fov_deg = between(20, 85) };
    c.target[0] = c.eye[0] + cos(yaw) * cos(pitch);
    c.target[1] = c.eye[1] + sin(yaw) * cos(pitch);
    c.target[2] = c.eye[2] + sin(pitch);
    return c;
}

/* Places that it sees, 20 to 120 m away, well spread over the picture, with so many pixels of noise. */
static void see(const noc_camera *c, noc_camera_point *points, int count, double noise) {
    for (int i = 0; i < count; i++) {
        double pixel[2] = { W * (i % 2 ? between(.55, .95) : between(.05, .45)),
                            H * (i / 2 % 2 ? between(.55, .95) : between(.05, .45)) };
        assert_int_equal(noc_camera_unproject(c, W, H, pixel, between(20, 120), points[i].xyz), NOC_OK);
        points[i].pixel[0] = pixel[0] + noise * normal();
        points[i].pixel[1] = pixel[1] + noise * normal();
    }
}

static void finds_the_camera_of_four_to_twelve_points(void **state) {
    (void)state;
    for (int count = 4; count <= MOST; count++)
        for (int i = 0; i < 12; i++) {
            noc_camera made = some_camera(), found;
            noc_camera_point points[MOST];
            double residual = -1;
            see(&made, points, count, 0);
            assert_int_equal(noc_camera_align(points, (size_t)count, W, H, NULL, &found, &residual, NULL), NOC_OK);
            if (apart(made.eye, found.eye) > .05)
                print_message("# %d points: %g m off, residual %g, fov %g for %g\n", count, apart(made.eye, found.eye),
                              residual, found.fov_deg, made.fov_deg);
            assert_true(residual >= 0 && residual < .01);
            assert_true(apart(made.eye, found.eye) < .05 && fabs(made.fov_deg - found.fov_deg) < .05);
            for (int k = 0; k < count; k++) {
                double pixel[2];
                assert_true(noc_camera_project(&found, W, H, points[k].xyz, pixel, NULL));
                assert_true(hypot(pixel[0] - points[k].pixel[0], pixel[1] - points[k].pixel[1]) < .05);
            }
        }
}

/* By a hand that clicks two pixels off, as they say. */
static void noise_moves_it_a_little(void **state) {
    (void)state;
    double sum = 0, residuals = 0, worst = 0;
    enum { CASES = 40, COUNT = 8 };
    for (int i = 0; i < CASES; i++) {
        noc_camera made = some_camera(), found;
        noc_camera_point points[COUNT];
        double residual;
        see(&made, points, COUNT, 2);
        assert_int_equal(noc_camera_align(points, COUNT, W, H, NULL, &found, &residual, NULL), NOC_OK);
        sum += apart(made.eye, found.eye) / CASES;
        worst = fmax(worst, apart(made.eye, found.eye));
        residuals += residual * residual / CASES;
    }
    print_message("# 2 pixels off: eye %.2f m off on average, %.2f m at worst; residual %.2f\n", sum, worst,
                  sqrt(residuals));
    assert_true(sum < 1.5);
    /* 2 sqrt 2 pixels a point, less what seven unknowns take of 16 numbers */
    double expected = 2 * M_SQRT2 * sqrt((2 * COUNT - 7) / (2.0 * COUNT));
    assert_true(fabs(sqrt(residuals) - expected) < .2 * expected);
}

static void a_start_is_used_and_a_bad_one_harms_nothing(void **state) {
    (void)state;
    for (int i = 0; i < 10; i++) {
        noc_camera made = some_camera(), start = some_camera(), found;
        noc_camera_point points[6];
        see(&made, points, 6, 0);
        assert_int_equal(noc_camera_align(points, 6, W, H, i % 2 ? &start : &made, &found, NULL, NULL), NOC_OK);
        assert_true(apart(made.eye, found.eye) < .05);
    }
}

/* A facade that is seen aslant. */
static void a_plane_is_enough(void **state) {
    (void)state;
    for (int count = 4; count <= 10; count += 2)
        for (int i = 0; i < 10; i++) {
            noc_camera made = { .eye = { between(-30, -10), -40, between(1, 10) },
                                .target = { between(5, 10), 0, between(8, 15) },
                                .up = { 0, 0, 1 },
                                .fov_deg = between(40, 80) };
            noc_camera found;
            noc_camera_point points[10];
            for (int k = 0; k < count; k++) {
                points[k] = (noc_camera_point){ .xyz = { (k & 1 ? 14 : -6) + between(-4, 4), 0,
                                                         (k & 2 ? 14 : 2) + between(-2, 2) } };
                assert_true(noc_camera_project(&made, W, H, points[k].xyz, points[k].pixel, NULL));
            }
            assert_int_equal(noc_camera_align(points, (size_t)count, W, H, NULL, &found, NULL, NULL), NOC_OK);
            if (apart(made.eye, found.eye) > .1)
                print_message("# plane, %d points: %g m off\n", count, apart(made.eye, found.eye));
            assert_true(apart(made.eye, found.eye) < .1);
        }
}

static void assert_refused(const noc_camera_point *points, size_t count, const char *why) {
    noc_log *log = noc_log_create(NULL);
    noc_camera camera = { .fov_deg = 77 };
    double residual = -7;
    assert_int_equal(noc_camera_align(points, count, W, H, NULL, &camera, &residual, log), NOC_ERR_ARGUMENT);
    if (!strstr(noc_log_last_error(log), why))
        print_message("# %s\n", noc_log_last_error(log));
    assert_non_null(strstr(noc_log_last_error(log), why));
    assert_true(camera.fov_deg == 77 && residual == -7);
    noc_log_destroy(log);
}

static void what_decides_nothing_is_refused(void **state) {
    (void)state;
    noc_camera made = some_camera();
    noc_camera_point points[8], odd[8];
    see(&made, points, 8, 0);
    assert_refused(points, 3, "must be 4");
    memcpy(odd, points, sizeof(odd));
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            odd[i].xyz[k] = points[0].xyz[k] + i * (k + 1);
    assert_refused(odd, 8, "places lie on a line");
    memcpy(odd, points, sizeof(odd));
    for (int i = 0; i < 8; i++)
        odd[i].pixel[1] = 2 * odd[i].pixel[0];
    assert_refused(odd, 8, "pixels lie on a line");
    for (int i = 0; i < 8; i++)
        odd[i] = points[0];
    assert_refused(odd, 8, "line");
    memcpy(odd, points, sizeof(odd));
    odd[3].xyz[1] = NAN;
    assert_refused(odd, 8, "point 4");
    odd[3] = points[3];
    odd[2].pixel[0] = INFINITY;
    assert_refused(odd, 8, "point 3");
    memcpy(odd, points, sizeof(odd));
    for (int i = 0; i < 8; i++)
        memcpy(odd[i].pixel, points[(3 * i + 1) % 8].pixel, sizeof(odd[i].pixel));
    assert_refused(odd, 8, "no camera sees");
    /* a facade seen squarely: nearer with a wider lens is the same picture */
    made = (noc_camera){ .eye = { 0, -40, 8 }, .target = { 0, 0, 8 }, .up = { 0, 0, 1 }, .fov_deg = 50 };
    for (int i = 0; i < 8; i++) {
        odd[i] = (noc_camera_point){ .xyz = { i % 2 ? 12 : -12 + i, 0, i & 2 ? 16 : 1 + i } };
        assert_true(noc_camera_project(&made, W, H, odd[i].xyz, odd[i].pixel, NULL));
    }
    assert_refused(odd, 8, "many cameras");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_camera_of_four_to_twelve_points),
        cmocka_unit_test(noise_moves_it_a_little),
        cmocka_unit_test(a_start_is_used_and_a_bad_one_harms_nothing),
        cmocka_unit_test(a_plane_is_enough),
        cmocka_unit_test(what_decides_nothing_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
