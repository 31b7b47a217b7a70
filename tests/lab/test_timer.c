/* Frames timed in turn: what is told of them is what there is of them, by any order of the calls. */
#include "../test.h"

#include "base/base.h"

#include <nocturne/nocturne.h>

enum { SIDE = 24 };

static noc_scene *single(void) {
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_builtin(scene, "single", NULL), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene;
}

static noc_lab_case of(noc_device *device, const noc_scene *scene, noc_method method, bool floor) {
    noc_lab_case one = {
        .device = device, .scene = scene, .render = noc_lab_render_params(SIDE, SIDE), .floor = floor
    };
    one.render.method = method;
    one.render.jitter = true; /* else the camera's rays are traced once */
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 1, &one.camera), NOC_OK);
    return one;
}

static void rounds(void **state) {
    (void)state;
    noc_scene *scene = single();
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 2 }, NULL);
    noc_lab_timer *timer = noc_lab_timer_create(NULL);
    noc_lab_case with = of(device, scene, NOC_METHOD_RIS, true), less = of(device, scene, NOC_METHOD_IS, false);
    noc_lab_times times;
    assert_int_equal(noc_lab_timer_get(timer, 0, &times), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_lab_timer_round(timer, NULL), NOC_OK); /* of nothing */
    assert_int_equal(noc_lab_timer_add(timer, &with, NULL), NOC_OK);
    assert_int_equal(noc_lab_timer_get(timer, 0, &times), NOC_OK);
    assert_true(times.frames == 0 && times.wall_seconds == 0 && times.floors == 0 && times.floor.wall_seconds == 0);
    assert_true(times.first.wall_seconds > 0 && times.first.frames == 1 && times.last.frames == 2);
    assert_int_equal(noc_lab_timer_add(timer, &less, NULL), NOC_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(noc_lab_timer_round(timer, NULL), NOC_OK);
    for (size_t i = 0; i < 2; i++) {
        double passes = 0;
        assert_int_equal(noc_lab_timer_get(timer, i, &times), NOC_OK);
        assert_int_equal(times.frames, 3);
        assert_true(times.wall_seconds > 0 && times.cpu_seconds > 0);
        for (int p = 0; p < NOC_PASS_COUNT; p++)
            passes += times.pass_seconds[p];
        assert_true(passes > 0 && times.pass_seconds[NOC_PASS_PRIMARY] > 0);
        assert_int_equal(times.last.rays_primary, SIDE * SIDE);
        assert_int_equal(times.floors, i ? 0 : 3);
        assert_true(i ? times.floor.wall_seconds == 0 : times.floor.wall_seconds > 0 && times.floor.cpu_seconds > 0);
        assert_true(times.lights.lights == 1);
    }
    assert_int_equal(noc_lab_timer_get(timer, 2, &times), NOC_ERR_ARGUMENT);
    noc_lab_timer_destroy(timer);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
}

static bool stop(void *user, const char *what, double done) {
    (void)what, (void)done;
    return --*(int *)user > 0;
}

/* What a case that cannot be measured leaves: the others, as they were. */
static void refused(void **state) {
    (void)state;
    noc_scene *scene = single();
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 1 }, NULL);
    noc_lab_timer *timer = noc_lab_timer_create(NULL);
    noc_lab_case good = of(device, scene, NOC_METHOD_IS, true), bad = good;
    noc_lab_times times;
    int left = 1;
    noc_progress never = { stop, &left };
    bad.render.draws = 0;
    assert_int_equal(noc_lab_timer_add(timer, &bad, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_lab_timer_add(timer, &good, &never), NOC_ERR_CANCELLED);
    assert_int_equal(noc_lab_timer_add(timer, &good, NULL), NOC_OK);
    assert_int_equal(noc_lab_timer_round(timer, NULL), NOC_OK);
    left = 1;
    assert_int_equal(noc_lab_timer_round(timer, &never), NOC_ERR_CANCELLED);
    assert_int_equal(noc_lab_timer_get(timer, 0, &times), NOC_OK);
    assert_true(times.frames == 1 && times.floors == 1);
    assert_int_equal(noc_lab_timer_get(timer, 1, &times), NOC_ERR_ARGUMENT);
    bad.scene = NULL;
    assert_int_equal(noc_lab_timer_add(timer, &bad, NULL), NOC_ERR_ARGUMENT);
    noc_lab_timer_destroy(timer);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(rounds), cmocka_unit_test(refused) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
