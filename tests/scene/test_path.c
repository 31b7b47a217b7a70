/* Camera paths: through their keys, smoothly, at the times and speeds that they say. */
#include "../memory.h"

#include <math.h>
#include <nocturne/path.h>

static noc_camera_key key(double x, double y, double seconds) {
    noc_camera_key k = { .camera = noc_camera_default(), .seconds = seconds, .hour = -1 };
    k.camera.eye[0] = x;
    k.camera.eye[1] = y;
    k.camera.target[0] = x;
    k.camera.target[1] = y + 10;
    return k;
}

static noc_camera_path *make(const noc_camera_key *keys, size_t count, bool loop, double seconds) {
    noc_camera_path *path;
    assert_int_equal(noc_camera_path_create(keys, count, loop, seconds, NULL, &path), NOC_OK);
    return path;
}

static noc_camera at(const noc_camera_path *path, double seconds) {
    noc_camera c;
    assert_int_equal(noc_camera_path_at(path, seconds, &c), NOC_OK);
    return c;
}

static double apart(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void assert_camera(const noc_camera *a, const noc_camera *b) {
    assert_true(apart(a->eye, b->eye) < 1e-6 && apart(a->target, b->target) < 1e-6 && apart(a->up, b->up) < 1e-6);
    assert_true(fabs(a->fov_deg - b->fov_deg) < 1e-6);
}

static void goes_through_its_keys(void **state) {
    noc_camera_key keys[] = { key(0, 0, 0), key(3, 9, 1), key(40, 8, 2.5), key(41, -60, 9) };
    keys[1].camera.fov_deg = 20;
    keys[2].camera.eye[2] = 30;
    for (int loop = 0; loop < 2; loop++) {
        noc_camera_path *path = make(keys, 4, loop, 0);
        assert_int_equal(noc_camera_path_loops(path), loop);
        for (int i = 0; i < 4; i++) {
            noc_camera c = at(path, keys[i].seconds);
            assert_camera(&c, &keys[i].camera);
        }
        /* beyond its end: a loop begins again, another path rests */
        double end = noc_camera_path_seconds(path);
        noc_camera after = at(path, end + 1), before = at(path, -1), second = at(path, loop ? end - 1 : 0);
        assert_camera(&after, &keys[loop ? 1 : 3].camera);
        assert_camera(&before, &second);
        assert_true(loop ? end > 9 : end == 9);
        noc_camera_path_destroy(path);
    }
    (void)state;
}

/* No step is far from the one before it, and none of their differences is: no corner, no stop, no jump at a loop's end.
 * The tightest bend of these keys has a radius of metres. */
static void is_smooth(void **state) {
    noc_camera_key keys[] = { key(0, 0, -1), key(50, 0, -1), key(50, 40, -1), key(0, 50, -1), key(-20, 20, -1) };
    noc_camera_path *path = make(keys, 5, true, 100);
    enum { STEPS = 4000 };
    double before[3] = { 0 }, length = 0, longest = 0, shortest = 1e9;
    for (int i = 0; i <= STEPS + 1; i++) {
        noc_camera a = at(path, 100.0 * i / STEPS), b = at(path, 100.0 * (i + 1) / STEPS);
        double step[3], bend = 0;
        for (int k = 0; k < 3; k++) {
            step[k] = b.eye[k] - a.eye[k];
            bend += (step[k] - before[k]) * (step[k] - before[k]);
        }
        double d = apart(a.eye, b.eye);
        if (i && sqrt(bend) > 0.05 * d)
            fail_msg("a corner of %g steps at %g s", sqrt(bend) / d, 100.0 * i / STEPS);
        memcpy(before, step, sizeof(before));
        length += i < STEPS ? d : 0;
        longest = fmax(longest, d);
        shortest = fmin(shortest, d);
    }
    /* one speed all along, where target and eye move alike; longer than the polygon, not by much */
    if (longest > 1.005 * shortest)
        fail_msg("steps of %g to %g m", shortest, longest);
    double polygon = 0;
    for (int i = 0; i < 5; i++)
        polygon += apart(keys[i].camera.eye, keys[(i + 1) % 5].camera.eye);
    assert_true(length > polygon && length < 1.2 * polygon);
    noc_camera_path_destroy(path);
    (void)state;
}

/* Keys on a line: a Catmull-Rom curve over centripetal knots stays on it and never turns back, however uneven they and
 * their seconds are. */
static void never_turns_back(void **state) {
    static const double x[] = { 0, 1, 1.2, 50, 51, 200 }, t[] = { 0, 5, 5.1, 5.2, 20, 20.5 };
    noc_camera_key keys[6];
    for (int told = 0; told < 2; told++) {
        for (int i = 0; i < 6; i++)
            keys[i] = key(x[i], 0, told ? t[i] : -1);
        noc_camera_path *path = make(keys, 6, false, 0);
        double end = noc_camera_path_seconds(path), before = -1e-9;
        for (int i = 0; i <= 5000; i++) {
            noc_camera c = at(path, end * i / 5000);
            assert_true(c.eye[0] >= before - 1e-9 && c.eye[0] <= 200 + 1e-9 && fabs(c.eye[1]) < 1e-9);
            before = c.eye[0];
        }
        assert_true(before > 200 - 1e-6);
        noc_camera_path_destroy(path);
    }
    (void)state;
}

static void two_equal_keys_are_a_rest(void **state) {
    noc_camera_key keys[] = { key(0, 0, 0), key(10, 0, 2), key(10, 0, 6), key(20, 5, 8) };
    noc_camera_path *path = make(keys, 4, false, 0);
    for (double t = 2; t <= 6; t += 0.25) {
        noc_camera c = at(path, t);
        assert_camera(&c, &keys[1].camera);
    }
    noc_camera_path_destroy(path);
    path = make(keys, 1, true, 7); /* a camera that stands */
    noc_camera c = at(path, 3);
    assert_camera(&c, &keys[0].camera);
    assert_true(noc_camera_path_seconds(path) == 7 && !noc_camera_path_loops(path));
    noc_camera_path_destroy(path);
    /* in place, only the zoom moves, by even ratios */
    noc_camera_key zoom[] = { key(0, 0, -1), key(0, 0, -1) };
    zoom[0].camera.fov_deg = 2 * atan(1) * 180 / M_PI;
    zoom[1].camera.fov_deg = 2 * atan(0.25) * 180 / M_PI;
    path = make(zoom, 2, false, 2);
    c = at(path, 1);
    assert_true(fabs(tan(c.fov_deg * M_PI / 360) - 0.5) < 1e-6);
    noc_camera_path_destroy(path);
    (void)state;
}

static void turns_are_circles(void **state) {
    noc_camera camera = noc_camera_default();
    memcpy(camera.eye, (double[3]){ 100, 20, 60 }, sizeof(camera.eye));
    memcpy(camera.target, (double[3]){ 10, 20, 5 }, sizeof(camera.target));
    noc_camera_path *orbit, *pan;
    assert_int_equal(noc_camera_path_orbit(&camera, 8, NULL, &orbit), NOC_OK);
    assert_int_equal(noc_camera_path_pan(&camera, 8, NULL, &pan), NOC_OK);
    for (int i = 0; i <= 1000; i++) {
        double t = 8.0 * i / 1000, angle = 2 * M_PI * i / 1000;
        noc_camera o = at(orbit, t), p = at(pan, t);
        double eye[3] = { 10 + 90 * cos(angle), 20 + 90 * sin(angle), 60 };
        double target[3] = { 100 - 90 * cos(angle), 20 - 90 * sin(angle), 5 };
        assert_true(apart(o.eye, eye) < 0.01 && apart(o.target, camera.target) < 1e-6 &&
                    fabs(o.fov_deg - p.fov_deg) < 1e-9);
        assert_true(apart(p.target, target) < 0.01 && apart(p.eye, camera.eye) < 1e-6);
    }
    noc_camera_path_destroy(orbit);
    noc_camera_path_destroy(pan);
    (void)state;
}

/* A tower of 90 m on the way of an orbit at 60 m: the eye is over it when it comes there, at its own height elsewhere,
 * and rises and sinks no steeper than it says, with room for the curve between keys. */
static void an_orbit_clears_what_stands_in_its_way(void **state) {
    static const double corners[8][2] = { { -5, 145 },    { 5, 145 },    { 5, 155 },   { -5, 155 },
                                          { -500, -500 }, { 500, -500 }, { 500, 500 }, { -500, 500 } };
    double p[24];
    for (int i = 0; i < 8; i++)
        memcpy(p + 3 * i, (double[3]){ corners[i][0], corners[i][1], i < 4 ? 90 : 0 }, 3 * sizeof(*p));
    const uint32_t t[12] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7 };
    noc_scene *scene = noc_scene_create(NULL);
    noc_material m = noc_class_material(NOC_CLASS_ROOF);
    noc_mesh mesh = { 8, p, 4, t, noc_scene_add_material(scene, &m), 0, 0, "tower" };
    assert_int_equal(noc_scene_add_mesh(scene, &mesh), 0);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    noc_camera camera = noc_camera_default();
    memcpy(camera.eye, (double[3]){ 150, 0, 60 }, sizeof(camera.eye));
    noc_camera_path *path;
    assert_int_equal(noc_scene_orbit(scene, &camera, 360, &path), NOC_OK);
    double seconds = noc_camera_path_seconds(path);
    noc_camera before = at(path, 0);
    for (int i = 0; i <= 3600; i++) {
        noc_camera c = at(path, seconds * i / 3600);
        double over = hypot(c.eye[0], c.eye[1] - 150), rise = fabs(c.eye[2] - before.eye[2]);
        if (over < 12 && c.eye[2] < 95)
            fail_msg("%g m from the tower at %g m", over, c.eye[2]);
        assert_true(over < 160 || fabs(c.eye[2] - 60) < 0.5);
        assert_true(rise <= 0.7 * apart(c.eye, before.eye));
        before = c;
    }
    noc_camera_path_destroy(path);
    noc_scene_destroy(scene);
    (void)state;
}

static void hours_go_on_over_midnight(void **state) {
    noc_camera_key keys[] = { key(0, 0, 0), key(1, 0, 2), key(2, 0, 4), key(3, 0, 6), key(4, 0, 8) };
    noc_camera_path *path = make(keys, 5, false, 0);
    assert_true(noc_camera_path_hour(path, 3) < 0);
    noc_camera_path_destroy(path);
    keys[1].hour = 22;
    keys[3].hour = 2;
    path = make(keys, 5, false, 0);
    static const double want[] = { 22, 22, 22, 23, 0, 1, 2, 2, 2 };
    for (int t = 0; t <= 8; t++)
        assert_true(fabs(noc_camera_path_hour(path, t) - want[t]) < 1e-9);
    noc_camera_path_destroy(path);
    (void)state;
}

static void seconds_are_stretched(void **state) {
    noc_camera_key keys[] = { key(0, 0, -1), key(10, 0, 3), key(20, 0, 4) };
    noc_camera_path *path = make(keys, 3, false, 8);
    noc_camera c = at(path, 6);
    assert_true(noc_camera_path_seconds(path) == 8);
    assert_camera(&c, &keys[1].camera);
    noc_camera_path_destroy(path);
    (void)state;
}

static char last[400];
static void keep(void *user, noc_log_level level, const char *text) { snprintf(last, sizeof(last), "%s", text); }

static void what_is_no_path_is_told(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep });
    noc_camera_key good[] = { key(0, 0, 0), key(1, 0, 1), key(2, 0, 2) };
    const struct {
        int index;
        double seconds, fov, hour, x, whole;
        size_t count;
        const char *said;
    } wrong[] = {
        { 1, 1, 50, -1, 0, 0, 0, "0 keys" },           { 1, 1, 50, -1, 0, -1, 3, "must take 0 to" },
        { 1, 1, 50, -1, 0, NAN, 3, "must take 0 to" }, { 1, -1, 50, -1, 0, 0, 3, "key 2 does not tell its seconds" },
        { 2, -1, 50, -1, 0, 0, 3, "key 1 tells" },     { 1, 0, 50, -1, 0, 0, 3, "key 2 is not later" },
        { 1, NAN, 50, -1, 0, 0, 3, "key 2" },          { 1, 1, 0, -1, 0, 0, 3, "key 2 looks nowhere" },
        { 1, 1, 50, 25, 0, 0, 3, "hour 24" },          { 1, 1, 50, -1, NAN, 0, 3, "key 2 looks nowhere" },
        { 1, 1e7, 50, -1, 0, 0, 2, "key 2 is later" }, { 1, 1, 50, -1, 1e9, 0, 3, "10 000 km" },
    };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        noc_camera_key keys[3], *k = &keys[wrong[i].index];
        noc_camera_path *path = (noc_camera_path *)keys;
        memcpy(keys, good, sizeof(keys));
        k->seconds = wrong[i].seconds;
        k->hour = wrong[i].hour;
        k->camera.fov_deg = wrong[i].fov;
        k->camera.eye[0] += wrong[i].x;
        *last = 0;
        noc_status status = noc_camera_path_create(keys, wrong[i].count, false, wrong[i].whole, log, &path);
        if (status != NOC_ERR_ARGUMENT || path || !strstr(last, wrong[i].said))
            fail_msg("%zu: status %d, \"%s\"", i, status, last);
    }
    noc_log_destroy(log);
    (void)state;
}

static void memory_is_refused(void **state) {
    noc_camera_key keys[] = { key(0, 0, -1), key(9, 0, -1) };
    noc_log *log = counting_log();
    bool reached;
    FOR_EVERY_REFUSAL(reached) {
        noc_camera_path *path;
        begin_refusal(n, later);
        noc_status status = noc_camera_path_create(keys, 2, true, 0, log, &path);
        reached = end_refusal();
        if (status)
            assert_refused(status, "path");
        assert_true(!path == (status != NOC_OK));
        noc_camera_path_destroy(path);
    }
    noc_log_destroy(log);
    (void)state;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goes_through_its_keys),     cmocka_unit_test(is_smooth),
        cmocka_unit_test(never_turns_back),          cmocka_unit_test(two_equal_keys_are_a_rest),
        cmocka_unit_test(turns_are_circles),         cmocka_unit_test(an_orbit_clears_what_stands_in_its_way),
        cmocka_unit_test(hours_go_on_over_midnight), cmocka_unit_test(seconds_are_stretched),
        cmocka_unit_test(what_is_no_path_is_told),   cmocka_unit_test(memory_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
