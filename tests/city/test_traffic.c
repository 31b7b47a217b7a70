/* Cars along roads: in their lanes, the right way, on the ground, and the same in whatever order roads come. */
#include "test.h"

#include "city/traffic/traffic.h"

#include <math.h>

#define SLOPE 0.03

static noc_scene *scene;
static noc_traffic_params params;

/* A plain of 2 km that rises to the north. */
static void make_plain(void) {
    const double half = 1000, z = SLOPE * half;
    const double p[12] = { -half, -half, -z, half, -half, -z, half, half, z, -half, half, z };
    const uint32_t t[6] = { 0, 1, 2, 0, 2, 3 };
    const noc_material terrain = noc_class_material(NOC_CLASS_TERRAIN);
    noc_scene_destroy(scene);
    scene = noc_scene_create(NULL);
    noc_mesh mesh = { 4, p, 2, t, noc_scene_add_material(scene, &terrain), 0, 0, "plain" };
    assert_int_equal(noc_scene_add_mesh(scene, &mesh), 0);
}

static size_t drive_here(const geo_road *roads, size_t count) {
    const noc_progress progress = { 0 };
    size_t cars;
    city_traffic *traffic = city_traffic_create(scene, &params);
    assert_non_null(traffic);
    assert_int_equal(city_traffic_roads(traffic, roads, count, &progress, &cars), NOC_OK);
    city_traffic_destroy(traffic);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(cars, scene->cars.len);
    return cars;
}

static size_t drive(const geo_road *roads, size_t count) {
    make_plain();
    return drive_here(roads, count);
}

static geo_road road_of(const char *id, const double *xyz, size_t points) {
    return (geo_road){ .id = id,
                       .name = "",
                       .cls = GEO_ROAD_PRIMARY,
                       .motor = true,
                       .width = 7,
                       .speed = 36,
                       .point_count = points,
                       .xyz = xyz };
}

static const float *at(size_t car, double time) {
    assert_int_equal(noc_scene_set_time(scene, time), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene->instances.data[scene->cars.data[car].instance].transform;
}

static const double north[] = { 0, -500, NAN, 0, 500, NAN };

static void test_lanes(void **state) {
    params = noc_traffic_default_params();
    for (int side = 0; side < 2; side++) {
        params.side = side ? NOC_DRIVE_LEFT : NOC_DRIVE_RIGHT;
        geo_road road = road_of("way/1", north, 2);
        size_t cars = drive(&road, 1), up = 0;
        assert_true(cars >= 32 && cars <= 35); /* 1 km at 60 m, both ways: 33.3 */
        for (size_t i = 0; i < cars; i++) {
            const float *m = at(i, 3);
            bool to_north = m[4] > 0;
            up += to_north;
            assert_true(fabsf(m[0]) < 1e-3f && fabsf(m[4]) > .999f); /* along the road */
            double right = (to_north ? 1 : -1) * (double)m[3];
            if (fabs(right - (side ? -1.75 : 1.75)) > .01)
                fail_msg("a car is %g m right of the middle", right);
            assert_true(fabs(m[11] - SLOPE * m[7]) < .01 && m[10] > .99f);
            float y = m[7];
            m = at(i, 4);
            if (fabsf(m[7]) < 480 && fabsf(y) < 480)
                assert_true(fabs((m[7] - y) * (to_north ? 1 : -1) - 10) < .05); /* 36 km/h */
        }
        assert_true(up > 14 && up < 19);
    }
}

/* Of two lanes a way, the outer ones at the kerbs. One way: all of it. */
static void test_more_lanes(void **state) {
    params = noc_traffic_default_params();
    geo_road road = road_of("way/1", north, 2);
    road.width = 14;
    road.lanes = 4;
    size_t cars = drive(&road, 1), outer = 0;
    assert_true(cars >= 64 && cars <= 70);
    for (size_t i = 0; i < cars; i++) {
        const float *m = at(i, 0);
        double right = (m[4] > 0 ? 1 : -1) * (double)m[3];
        outer += fabs(right - 5.25) < .01;
        assert_true(fabs(right - 5.25) < .01 || fabs(right - 1.75) < .01);
    }
    assert_true(outer > cars / 3 && outer < 2 * cars / 3);
    road.oneway = -1; /* against the line */
    road.lanes = 1;
    road.width = 4;
    cars = drive(&road, 1);
    assert_true(cars >= 16 && cars <= 17);
    for (size_t i = 0; i < cars; i++)
        assert_true(fabsf(at(i, 0)[3]) < .01f && at(i, 0)[4] < -.99f);
}

/* A street in three ways, one drawn the other way round, and one that turns off: the street goes straight on. */
static void test_chain(void **state) {
    static const double a[] = { 0, -300, NAN, 0, -100, NAN }, b[] = { 5, 100, NAN, 0, 0, NAN, 0, -100, NAN },
                        c[] = { 5, 100, NAN, 5, 300, NAN }, d[] = { 0, -100, NAN, 200, -100, NAN };
    params = noc_traffic_default_params();
    geo_road roads[] = { road_of("way/1", a, 2), road_of("way/2", b, 3), road_of("way/3", c, 2),
                         road_of("way/4", d, 2) };
    size_t cars = drive(roads, 4);
    assert_int_equal(scene->routes.len, 4); /* both ways of the street, and of what turns off */
    for (size_t i = 0; i < cars; i++) {
        const noc_scene_route *r = &scene->routes.data[scene->cars.data[i].route];
        double period = scene->stops.data[r->first + r->count - 1].seconds;
        int jumps = 0;
        float before[3] = { 0 };
        for (double t = 0; t < period; t += 1) {
            const float *m = at(i, t);
            jumps += t > 0 && hypot(m[3] - before[0], m[7] - before[1]) > 12;
            before[0] = m[3], before[1] = m[7];
        }
        assert_true(jumps <= 1); /* where it starts anew */
    }
}

static int compare_floats(const void *a, const void *b) { return memcmp(a, b, 12 * sizeof(float)); }

static void transforms(float (*out)[12]) {
    for (size_t i = 0; i < scene->cars.len; i++)
        memcpy(out[i], scene->instances.data[scene->cars.data[i].instance].transform, sizeof(*out));
    qsort(out, scene->cars.len, sizeof(*out), compare_floats);
}

static void test_order(void **state) {
    enum { MOST = 200 };
    static float first[MOST][12], second[MOST][12];
    static const double b[] = { 100, -500, NAN, 120, 500, NAN }, c[] = { -500, 20, NAN, 500, 20, NAN };
    params = noc_traffic_default_params();
    geo_road roads[] = { road_of("way/1", north, 2), road_of("way/2", b, 2), road_of("way/3", c, 2) };
    const geo_road turned[] = { roads[2], roads[0], roads[1] };
    size_t cars = drive(roads, 3);
    assert_true(cars < MOST && cars > 90);
    transforms(first);
    assert_int_equal(drive(turned, 3), cars);
    transforms(second);
    assert_memory_equal(first, second, cars * sizeof(*first));
    params.seed++;
    drive(roads, 3);
    transforms(second);
    assert_true(memcmp(first, second, cars * sizeof(*first)));
}

static void test_left_out(void **state) {
    static const double far[] = { 5000, 0, NAN, 6000, 0, NAN }, half[] = { 900, 0, NAN, 1500, 0, NAN };
    params = noc_traffic_default_params();
    geo_road road = road_of("way/1", north, 2);
    road.tunnel = true;
    assert_int_equal(drive(&road, 1), 0);
    road.tunnel = false;
    road.motor = false;
    assert_int_equal(drive(&road, 1), 0);
    road = road_of("way/1", far, 2);
    assert_int_equal(drive(&road, 1), 0);
    road = road_of("way/1", half, 2); /* nobody drives beyond the city */
    params.spacing = 10;
    for (size_t i = 0, cars = drive(&road, 1); i < cars; i++)
        assert_true(at(i, 1)[3] < 1010);
}

/* A bridge goes straight from end to end, whatever lies below it. */
static void test_bridge(void **state) {
    static const double hill[] = { -50, -100, 60, 50, -100, 60, 50, 100, 60, -50, 100, 60 };
    static const uint32_t t[6] = { 0, 1, 2, 0, 2, 3 };
    params = noc_traffic_default_params();
    for (int bridge = 0; bridge < 2; bridge++) {
        const noc_material green = noc_class_material(NOC_CLASS_GREEN);
        geo_road road = road_of("way/1", north, 2);
        road.bridge = bridge;
        make_plain();
        noc_mesh mesh = { 4, hill, 2, t, noc_scene_add_material(scene, &green), 0, 0, "hill" };
        assert_true(noc_scene_add_mesh(scene, &mesh) > 0);
        size_t cars = drive_here(&road, 1), over = 0;
        for (size_t i = 0; i < cars; i++) {
            const float *m = at(i, 0);
            bool high = fabs(m[11] - SLOPE * m[7]) > 5;
            over += high;
            assert_true(!high || fabsf(m[7]) < 110);
        }
        assert_true(bridge ? over == 0 : over > 2);
    }
}

/* The built-in city has some too, in its streets, and none unless they are asked for. */
static void test_builtin(void **state) {
    static const char *const inputs[] = { "builtin:city" };
    noc_import_params p = noc_import_default_params();
    noc_builtin_params small = noc_builtin_default_params();
    small.city.size = 300;
    p.builtin = &small;
    for (int on = 0; on < 2; on++) {
        p.traffic = on ? NOC_SWITCH_ON : NOC_SWITCH_AUTO;
        noc_scene_destroy(scene);
        scene = noc_scene_create(NULL);
        assert_int_equal(noc_scene_load(scene, inputs, 1, &p, NULL), NOC_OK);
        assert_true(on ? scene->cars.len > 10 : !scene->cars.len);
        for (size_t i = 0; i < scene->cars.len; i++) {
            const float *m = scene->instances.data[scene->cars.data[i].instance].transform;
            double z;
            assert_true(noc_scene_highest(scene, 1u << NOC_CLASS_ROAD, m[3], m[7], &z) && fabs(m[11] - z) < .02);
        }
    }
}

/* Thousands of times across the city: too much for a track, and for a road's lanes. */
static void test_too_long(void **state) {
    enum { POINTS = 6200 };
    static double xyz[POINTS][3];
    const size_t part = POINTS;
    const geo_track track = { "track", 1, &part, xyz[0], NULL };
    const char *reason = "", *examples;
    bool repaired;
    size_t cars, count;
    for (size_t i = 0; i < POINTS; i++)
        memcpy(xyz[i], (double[]){ i % 2 ? 990 : -990, 0.1 * (double)i - 310, NAN }, sizeof(xyz[i]));
    make_plain();
    geo_issues *issues = geo_issues_create();
    city_traffic *traffic = city_traffic_create(scene, &params);
    assert_int_equal(city_traffic_follow(traffic, &track, issues, &cars), NOC_OK);
    assert_int_equal(cars, 0);
    assert_int_equal(geo_issues_count(issues), 1);
    assert_true(geo_issues_get(issues, 0, &reason, &repaired, &count, &examples));
    assert_string_equal(reason, "track too long to drive, or one too many");
    city_traffic_destroy(traffic);
    geo_issues_destroy(issues);
    const geo_road road = road_of("way/1", xyz[0], POINTS);
    assert_int_equal(drive_here(&road, 1), 0);
    assert_int_equal(scene->stops.len, 0);
}

/* A car that stands for a day is a few stops, and goes on when it is time. */
static void test_standing(void **state) {
    enum { POINTS = 86402 };
    static double xyz[POINTS][3], seconds[POINTS];
    const size_t part = POINTS;
    const geo_track track = { "track", 1, &part, xyz[0], seconds };
    size_t cars;
    for (size_t i = 0; i < POINTS; i++) {
        double y = i == 0 ? -20 : i + 1 == POINTS ? 20 : 0;
        memcpy(xyz[i], (double[]){ i % 2 ? .01 : 0, y, NAN }, sizeof(xyz[i]));
        seconds[i] = (double)i;
    }
    make_plain();
    geo_issues *issues = geo_issues_create();
    city_traffic *traffic = city_traffic_create(scene, &params);
    assert_int_equal(city_traffic_follow(traffic, &track, issues, &cars), NOC_OK);
    assert_int_equal(cars, 1);
    city_traffic_destroy(traffic);
    geo_issues_destroy(issues);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_true(scene->stops.len < 16);
    assert_true(fabs(at(0, .5)[7] + 10) < .1 && fabs(at(0, 1000)[7]) < .1 && fabs(at(0, 86399)[7]) < .1);
    assert_true(fabs(at(0, 86400.5)[7] - 10) < .1);
}

static int finish(void **state) {
    noc_scene_destroy(scene);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_lanes),    cmocka_unit_test(test_more_lanes),
                                        cmocka_unit_test(test_chain),    cmocka_unit_test(test_order),
                                        cmocka_unit_test(test_left_out), cmocka_unit_test(test_bridge),
                                        cmocka_unit_test(test_builtin),  cmocka_unit_test(test_too_long),
                                        cmocka_unit_test(test_standing) };
    return cmocka_run_group_tests(tests, NULL, finish);
}
