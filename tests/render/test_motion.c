/* Motion vectors (NOC_AOV_MOTION): held to the cameras' own projections, to a car's way, and to rest. */
#include "views.h"

#include <string.h>

enum { CAR = 1 };

/* A floor, a wall, and a car: a box of one quad, that stands at (x, -4). */
static noc_scene *yard(int *car) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, .5f);
    add_floor(s, grey, 0, 0, 0, 20);
    QUAD(s, grey, -8, 6, 0, 16, 0, 0, 0, 0, 5);
    assert_int_equal(noc_scene_add_model(s, "car"), CAR);
    noc_mesh side = { .vertex_count = 4,
                      .positions = (double[]){ -1.5, 0, 0, 1.5, 0, 0, 1.5, 0, 1.5, -1.5, 0, 1.5 },
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = grey,
                      .model = CAR,
                      .name = "side" };
    assert_true(noc_scene_add_mesh(s, &side) >= 0);
    noc_instance in = { .model = CAR, .transform = { 1, 0, 0, 0, 0, 1, 0, -4, 0, 0, 1, 0 } };
    *car = noc_scene_add_instance(s, &in);
    assert_true(*car >= 0);
    point_light(s, 0, -2, 4, 100);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* Places of a pixel's surface now and then by the cameras' own functions. moved: of a car, in x, m. */
static void expect(const noc_camera *now, const noc_camera *then, const noc_render_params *p, const float *depth, int i,
                   double moved, double out[3]) {
    double at[2] = { i % p->width + .5, i / p->width + .5 }, xyz[3];
    assert_int_equal(noc_camera_unproject(now, p->width, p->height, at, depth[i], xyz), NOC_OK);
    xyz[0] -= moved;
    assert_true(noc_camera_project(then, p->width, p->height, xyz, out, NULL));
    double sight[3], length = 0;
    out[2] = 0;
    for (int k = 0; k < 3; k++) {
        out[k] -= k < 2 ? at[k] : 0;
        sight[k] = then->target[k] - then->eye[k];
        length += sight[k] * sight[k];
    }
    for (int k = 0; k < 3; k++)
        out[2] += (xyz[k] - then->eye[k]) * sight[k] / sqrt(length);
}

static int hold(noc_view *v, const noc_camera *now, const noc_camera *then, const noc_render_params *p, int car_object,
                double moved, int *on_car) {
    noc_channel *motion = view(v, NOC_AOV_MOTION), *depth = view(v, NOC_AOV_DEPTH), *object = view(v, NOC_AOV_OBJECT);
    int some = 0;
    *on_car = 0;
    for (int i = 0; i < p->width * p->height; i++) {
        const float *m = motion->value + 3 * i;
        double want[3];
        if (depth->value[i] < 0) {
            assert_true(m[0] == 0 && m[1] == 0 && m[2] == 0);
            continue;
        }
        bool car = (int)object->value[i] == car_object;
        expect(now, then, p, depth->value, i, car ? moved : 0, want);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(m[k] - want[k]) < 2e-3 * (1 + fabs(want[k])));
        some++;
        *on_car += car;
    }
    noc_channel_destroy(motion);
    noc_channel_destroy(depth);
    noc_channel_destroy(object);
    return some;
}

static noc_render_params asked(void) {
    return with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS,
                1u << NOC_AOV_MOTION | 1u << NOC_AOV_DEPTH | 1u << NOC_AOV_OBJECT);
}

static int object_of_car(noc_view *v, const noc_scene *s) {
    noc_channel *object = view(v, NOC_AOV_OBJECT);
    int found = -1;
    for (int i = 0; i < N; i++) {
        const char *name = object->value[i] < 0 ? NULL : noc_scene_object_name(s, (size_t)object->value[i]);
        if (name && !strcmp(name, "side"))
            found = (int)object->value[i];
    }
    noc_channel_destroy(object);
    return found;
}

/* Nothing is known of the first frame; then nothing moves, also with jitter, by not a bit. */
static void rests(void **state) {
    int car;
    noc_scene *s = yard(&car);
    noc_render_params p = asked();
    p.jitter = true;
    noc_camera c = along();
    noc_view *v = rendered(s, &c, &p, 1, 1);
    for (int frame = 0; frame < 3; frame++) {
        noc_channel *motion = view(v, NOC_AOV_MOTION), *depth = view(v, NOC_AOV_DEPTH);
        for (int i = 0; i < N; i++) {
            const float *m = motion->value + 3 * i;
            assert_true(m[0] == 0 && m[1] == 0 && (m[2] > 0) == (frame > 0 && depth->value[i] > 0));
        }
        noc_channel_destroy(motion);
        noc_channel_destroy(depth);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    }
    noc_view_reset(v);
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    noc_channel *motion = view(v, NOC_AOV_MOTION);
    for (int i = 0; i < 3 * N; i++)
        assert_true(motion->value[i] == 0);
    noc_channel_destroy(motion);
    close_view(v);
    noc_scene_destroy(s);
}

/* Whether or not reservoirs are reused, and while the picture's size changes. */
static void camera_moves(void **state) {
    int car, on_car;
    noc_scene *s = yard(&car);
    noc_camera from = along(), to = look(1.8, -9.5, 4.2, .5, 0, 2.2, 58);
    for (int restir = 0; restir < 2; restir++) {
        noc_render_params p = asked();
        p.method = restir ? NOC_METHOD_RESTIR : NOC_METHOD_RIS;
        noc_view *v = rendered(s, &from, &p, 2, 1);
        assert_int_equal(noc_view_render(v, &to, &p, NULL), NOC_OK);
        assert_true(hold(v, &to, &from, &p, -1, 0, &on_car) > N / 2);
        p.width = 20;
        p.height = 12;
        assert_int_equal(noc_view_render(v, &from, &p, NULL), NOC_OK);
        assert_true(hold(v, &from, &to, &p, -1, 0, &on_car) > N / 8);
        close_view(v);
    }
    noc_scene_destroy(s);
}

static void move_car(noc_scene *s, int car, double x) {
    const double there[12] = { 1, 0, 0, x, 0, 1, 0, -4, 0, 0, 1, 0 };
    assert_int_equal(noc_scene_set_transform(s, car, there), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* A car and the camera at once; two commits between the frames of a view, of which the first was seen by another. */
static void car_moves(void **state) {
    int car, on_car;
    noc_scene *s = yard(&car);
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 1 }, NULL);
    noc_view *v = noc_view_create(device, s), *other = noc_view_create(device, s);
    noc_render_params p = asked();
    noc_camera from = along(), to = look(1.2, -9.8, 4.1, .1, 0, 2.4, 60);
    assert_int_equal(noc_view_render(v, &from, &p, NULL), NOC_OK);
    int object = object_of_car(v, s);
    assert_true(object >= 0);
    move_car(s, car, .75);
    assert_int_equal(noc_view_render(v, &to, &p, NULL), NOC_OK);
    assert_true(hold(v, &to, &from, &p, object, .75, &on_car) > N / 2 && on_car > 20);
    assert_int_equal(noc_view_render(v, &to, &p, NULL), NOC_OK); /* it stands again */
    assert_true(hold(v, &to, &to, &p, object, 0, &on_car) > N / 2 && on_car > 20);
    move_car(s, car, 0);
    assert_int_equal(noc_view_render(other, &to, &p, NULL), NOC_OK);
    move_car(s, car, -.5);
    assert_int_equal(noc_view_render(v, &to, &p, NULL), NOC_OK);
    noc_channel *motion = view(v, NOC_AOV_MOTION), *seen = view(v, NOC_AOV_OBJECT);
    for (int i = 0; i < N; i++) {
        const float *m = motion->value + 3 * i;
        assert_true(m[0] == 0 && m[1] == 0 && (m[2] > 0) == (seen->value[i] >= 0 && (int)seen->value[i] != object));
    }
    noc_channel_destroy(motion);
    noc_channel_destroy(seen);
    noc_view_destroy(v);
    noc_view_destroy(other);
    noc_device_destroy(device);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rests),
        cmocka_unit_test(camera_moves),
        cmocka_unit_test(car_moves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
