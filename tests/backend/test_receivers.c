/* Receivers need not come from a camera: the passes of a frame find the light on points that are given. */
#include "../render/rooms.h"
#include "cpu_view.h"

enum { SIDE = 3 };
static const float lamp[3] = { 0.5f, 0.25f, 4 };
static const float candela = 900, albedo = 0.4f;

/* A floor, a point lamp over it, and a screen that keeps its light from x < -1.5. */
static noc_scene *yard(int *grey) {
    noc_scene *s = noc_scene_create(NULL);
    *grey = matte(s, albedo);
    add_floor(s, *grey, 0, 0, 0, 30);
    QUAD(s, *grey, -1, -20, 0, 0, 40, 0, 0, 0, 20);
    assert_true(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_POINT,
                                                     .emission = { candela, candela, candela },
                                                     .position = { lamp[0], lamp[1], lamp[2] } }) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* 3 x 3 points, the first column of them behind the screen; they look up, but for one that looks down. */
static void grid(int grey, noc_receiver out[SIDE * SIDE]) {
    for (int i = 0; i < SIDE * SIDE; i++)
        out[i] = (noc_receiver){ .p = { (float)(i % SIDE) * 2.5f - 2, (float)(i / SIDE) * 3 - 3, 0.85f },
                                 .n = { 0, 0, i == 5 ? -1 : 1 },
                                 .material = (uint32_t)grey };
}

static double lux(const noc_receiver *r) {
    double d[3] = { lamp[0] - r->p[0], lamp[1] - r->p[1], lamp[2] - r->p[2] };
    double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    return r->p[0] < -1 ? 0 : fmax(candela * d[2] * r->n[2] / (d2 * sqrt(d2)), 0);
}

/* A frame of so many points, or of what the camera sees. */
static void make(cpu_view *v, const noc_camera *c, noc_method method, uint32_t epoch, const noc_receiver *points) {
    noc_render_params p = measure(SIDE, SIDE, method);
    noc_plan plan;
    noc_frame f = { .params = &p, .plan = &plan, .receivers = points, .epoch = epoch };
    noc_plan_make(&p, false, -1, false, &plan);
    noc_make_frame_constants(&p, 0, false, &f.constants);
    noc_make_frame_camera(c, &p, 0, &f.constants.camera);
    f.constants.previous = f.constants.camera;
    assert_int_equal(noc_backend_embree.resize(v, SIDE, SIDE, plan.sets), NOC_OK);
    for (int i = 0; i < plan.count; i++)
        assert_int_equal(noc_backend_embree.stage(v, &f, &plan.stages[i], NULL, 0, 1), NOC_OK);
    assert_int_equal(noc_backend_embree.accumulate(v, &f), NOC_OK);
}

static void passes_light_points(void **state) {
    (void)state;
    int grey;
    noc_scene *s = yard(&grey);
    noc_receiver points[SIDE * SIDE];
    grid(grey, points);
    cpu_view *v = open_cpu_view(s, 2, NULL);
    assert_non_null(v);
    noc_camera c = look(0, -10, 20, 0, 0, 0, 60); /* what is matte looks the same from anywhere */
    for (int method = NOC_METHOD_REFERENCE; method <= NOC_METHOD_RESTIR; method++) {
        make(v, &c, (noc_method)method, (uint32_t)method + 1, points);
        noc_image *image = noc_image_create(SIDE, SIDE, NULL);
        noc_backend_embree.read(v, image);
        for (int i = 0; i < SIDE * SIDE; i++) {
            double want = lux(&points[i]) * albedo / M_PI;
            assert_true(fabs(luma(image->rgb + 3 * i) - want) <= 1e-4 * want);
        }
        noc_image_destroy(image);
    }
    close_cpu_view(v);
    noc_scene_destroy(s);
}

/* What a camera's frame saw of an instance moves with it; points that the next frame is given do not. */
static void points_are_of_no_instance(void **state) {
    (void)state;
    int grey;
    noc_scene *s = yard(&grey);
    int car = noc_scene_add_model(s, "car");
    assert_int_equal(car, 1);
    assert_true(noc_scene_add_mesh(s, &(noc_mesh){ .vertex_count = 3,
                                                   .positions = (double[]){ -9, -9, 0, 9, -9, 0, 9, 9, 0 },
                                                   .triangle_count = 1,
                                                   .indices = (uint32_t[]){ 0, 1, 2 },
                                                   .material = grey,
                                                   .model = car }) >= 0);
    noc_instance in = { .model = car, .transform = { 1, [5] = 1, [10] = 1, [11] = 0.5 } };
    assert_int_equal(noc_scene_add_instance(s, &in), 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_receiver points[SIDE * SIDE];
    grid(grey, points);
    cpu_view *v = open_cpu_view(s, 2, NULL);
    noc_camera c = look(4, 0, 12, 4, 0.1, 0, 20);
    for (int given = 0; given < 2; given++) {
        make(v, &c, NOC_METHOD_RESTIR, (uint32_t)given + 1, given ? points : NULL);
        gblock now = v->b.g[0][0], moved;
        in.transform[3] += 2;
        assert_int_equal(noc_scene_set_transform(s, 0, in.transform), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_cpu_follow(v->world), NOC_OK);
        const gblock *then = noc_cpu_taken_back(v, 0, &now, &moved);
        assert_true(fabs(now.px[0] - then->px[0] - (given ? 0 : 2)) < 1e-5);
    }
    close_cpu_view(v);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(passes_light_points),
                                        cmocka_unit_test(points_are_of_no_instance) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
