/* What a map beside a picture shows: the scene from above, cars and their tracks. */
#include "rooms.h"

#include "scene/scene.h"

#include <nocturne/map.h>

static noc_status cast(void *user, const noc_ray *rays, size_t count, noc_hit *hits) {
    return noc_view_cast(user, rays, count, hits);
}

static int of_class(noc_scene *s, noc_class cls) {
    noc_material m = noc_class_material(cls);
    return noc_scene_add_material(s, &m);
}

/* A road of 20 x 20 m, a roof of 4 x 6 m at a height of 5 m, north-east of the middle. */
static noc_scene *block(void) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, of_class(s, NOC_CLASS_ROAD), 0, 0, 0, 10);
    QUAD(s, of_class(s, NOC_CLASS_ROOF), 2, 2, 5, 4, 0, 0, 0, 6, 0);
    return s;
}

static void shows_the_scene_from_above(void **state) {
    (void)state;
    enum { W = 24, H = 24 };
    noc_scene *s = block();
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, NULL);
    noc_map_params p = { { -12, -12 }, { 12, 12 }, W, H, INFINITY };
    float height[W * H];
    uint8_t cls[W * H];
    int object[W * H], roofs = 0, roads = 0, nothing = 0;
    assert_int_equal(noc_scene_map(s, &p, cast, view, NULL, height, cls, object), NOC_OK);
    for (int i = 0; i < W * H; i++) {
        double x = i % W + .5 - 12, y = 12 - (i / W + .5);
        bool roof = x > 2 && x < 6 && y > 2 && y < 8, road = !roof && fabs(x) < 10 && fabs(y) < 10;
        assert_int_equal(cls[i], roof ? NOC_CLASS_ROOF : road ? NOC_CLASS_ROAD : NOC_MAP_NOTHING);
        assert_true(roof || road ? fabsf(height[i] - (roof ? 5 : 0)) < 1e-4f : isnan(height[i]));
        assert_int_equal(object[i], roof ? 1 : road ? 0 : -1);
        roofs += roof;
        roads += road;
        nothing += !roof && !road;
    }
    assert_true(roofs == 24 && roads == 400 - 24 && nothing == W * H - 400);
    p.from = 4; /* under the roof */
    assert_int_equal(noc_scene_map(s, &p, cast, view, NULL, NULL, cls, NULL), NOC_OK);
    for (int i = 0; i < W * H; i++)
        assert_int_not_equal(cls[i], NOC_CLASS_ROOF);
    p.max[0] = p.min[0];
    assert_int_equal(noc_scene_map(s, &p, cast, view, NULL, height, NULL, NULL), NOC_ERR_ARGUMENT);
    p = (noc_map_params){ { -12, -12 }, { 12, NAN }, W, H, INFINITY };
    assert_int_equal(noc_scene_map(s, &p, cast, view, NULL, height, NULL, NULL), NOC_ERR_ARGUMENT);
    p = (noc_map_params){ { -12, -12 }, { 12, 12 }, 0, H, INFINITY };
    assert_int_equal(noc_scene_map(s, &p, cast, view, NULL, height, NULL, NULL), NOC_ERR_ARGUMENT);
    close_view(view);
    noc_scene_destroy(s);
}

static bool stop(void *user, const char *what, double done) {
    (void)what, (void)done;
    return --*(int *)user > 0;
}

static void can_be_cancelled(void **state) {
    (void)state;
    noc_scene *s = block();
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 1, NULL);
    noc_map_params p = { { -12, -12 }, { 12, 12 }, 1000, 200, INFINITY };
    int left = 3;
    noc_progress progress = { stop, &left };
    assert_int_equal(noc_scene_map(s, &p, cast, view, &progress, NULL, NULL, NULL), NOC_ERR_CANCELLED);
    close_view(view);
    noc_scene_destroy(s);
}

static void tells_where_cars_are_and_what_they_drive(void **state) {
    (void)state;
    noc_scene *s = block();
    int model = noc_scene_add_model(s, "car"), red = matte(s, .3f);
    noc_mesh body = { .vertex_count = 3,
                      .positions = (double[]){ 0, 0, 1, 1, 0, 1, 0, 1, 1 },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = red,
                      .model = model };
    assert_true(noc_scene_add_mesh(s, &body) >= 0);
    /* east for 10 m in 10 s, then another part: north for 8 m in 4 s */
    const noc_scene_stop stops[] = {
        { 0, { -5, -5, 0 }, 0 }, { 10, { 5, -5, 0 }, 10 }, { 10, { 8, -4, 0 }, 0 }, { 14, { 8, 4, 0 }, 8 }
    };
    int route = noc_scene_add_route(s, stops, 4);
    assert_true(noc_scene_add_car(s, model, route, 2, 2) && noc_scene_add_car(s, model, route, 12, 2));
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_car_info car;
    assert_int_equal(noc_scene_get_car(s, 0, &car), NOC_OK);
    assert_true(fabs(car.place[0] + 3) < 1e-6 && fabs(car.place[1] + 5) < 1e-6 && fabs(car.heading) < 1e-6);
    assert_int_equal(car.track, route);
    assert_int_equal(noc_scene_get_car(s, 1, &car), NOC_OK);
    assert_true(fabs(car.place[0] - 8) < 1e-6 && fabs(car.place[1]) < 1e-6 && fabs(car.heading - M_PI / 2) < 1e-6);
    assert_int_equal(car.instance, 1);
    assert_int_equal(noc_scene_set_time(s, 3), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_scene_get_car(s, 0, &car), NOC_OK);
    assert_true(fabs(car.place[0]) < 1e-6);
    assert_int_equal(noc_scene_get_car(s, 2, &car), NOC_ERR_ARGUMENT);
    noc_track_stop have[4];
    assert_int_equal(noc_scene_track_count(s), 1);
    assert_int_equal(noc_scene_get_track(s, 0, have, 4), 4);
    assert_int_equal(noc_scene_get_track(s, 0, NULL, 0), 4);
    assert_int_equal(noc_scene_get_track(s, 1, have, 4), 0);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(have[i].begins, i % 2 == 0);
        assert_true(have[i].seconds == stops[i].seconds && fabs(have[i].place[0] - stops[i].p[0]) < 1e-6);
    }
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shows_the_scene_from_above),
        cmocka_unit_test(can_be_cancelled),
        cmocka_unit_test(tells_where_cars_are_and_what_they_drive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
