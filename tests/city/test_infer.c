/* Lamps placed by a rule, and a ground for cities without. */
#include "lamp_scene.h"

#include "../told.h"

static double nearest_pair(const noc_scene *scene) {
    double best = INFINITY;
    for (size_t i = 0; i < scene->lights.len; i++)
        for (size_t k = 0; k < i; k++)
            best = fmin(best, hypot((double)scene->lights.data[i].p[0] - scene->lights.data[k].p[0],
                                    (double)scene->lights.data[i].p[1] - scene->lights.data[k].p[1]));
    return best;
}

static int infer(noc_scene *scene) {
    int lights;
    assert_int_equal(city_infer_lamps(scene, &defaults, NULL, NULL, &lights), NOC_OK);
    return lights;
}

static bool stop_at_third(void *user, const char *what, double done) {
    int *calls = user;
    assert_string_equal(what, "lamps");
    assert_true(done >= 0 && done <= 1);
    return ++*calls < 3;
}

/* Placing by a rule tells its progress, and ends early when it is told to. */
static void test_infer_cancelled(void **state) {
    (void)state;
    int all = 0;
    for (int cancel = 0; cancel < 2; cancel++) {
        noc_scene *scene = noc_scene_create(NULL);
        for (int i = 0; i < 200; i++)
            add_building(scene, i * 50, 0, i * 50 + 30, 30, 0, 10);
        city_add_ground(scene, NULL, 0);
        int lights, calls = 0;
        noc_progress progress = { stop_at_third, &calls };
        noc_status status = city_infer_lamps(scene, &defaults, cancel ? &progress : NULL, NULL, &lights);
        assert_int_equal(status, cancel ? NOC_ERR_CANCELLED : NOC_OK);
        if (!cancel)
            all = lights;
        else
            assert_true(calls == 3 && lights > 0 && lights < all / 2);
        noc_scene_destroy(scene);
    }
}

static void test_infer_roads(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    add_plane(scene, NOC_CLASS_SIDEWALK, -300, -20, 300, 20, 0, 0);
    add_plane(scene, NOC_CLASS_ROAD, -300, -4, 0, 4, .01, 0);
    add_plane(scene, NOC_CLASS_ROAD, 0, -4, 300, 4, .01, 0); /* the seam between the two is no kerb */
    add_building(scene, 100, 4.2, 200, 20, 0, 10);
    int lights = infer(scene);
    assert_int_equal(lights, scene->lights.len);
    assert_int_equal(lights, scene->lights_inferred);
    assert_true(lights >= 17 && lights <= 40);
    assert_true(nearest_pair(scene) > 25);
    int north = 0;
    for (int i = 0; i < lights; i++) {
        const float *p = scene->lights.data[i].p;
        assert_true(fabsf(p[1]) < 5.5f); /* the head hangs over the kerb */
        assert_false(p[1] > 4.2f && p[0] > 100 && p[0] < 200);
        north += p[1] > 0;
    }
    assert_true(north > 3 && lights - north > 3);
    /* the same again */
    noc_scene *again = noc_scene_create(NULL);
    add_plane(again, NOC_CLASS_SIDEWALK, -300, -20, 300, 20, 0, 0);
    add_plane(again, NOC_CLASS_ROAD, -300, -4, 0, 4, .01, 0);
    add_plane(again, NOC_CLASS_ROAD, 0, -4, 300, 4, .01, 0);
    add_building(again, 100, 4.2, 200, 20, 0, 10);
    assert_int_equal(infer(again), lights);
    assert_memory_equal(again->lights.data, scene->lights.data, (size_t)lights * sizeof(noc_light_record));
    noc_scene_destroy(again);
    noc_scene_destroy(scene);
}

static void test_infer_buildings(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            add_building(scene, i * 50, k * 50, i * 50 + 30, k * 50 + 30, 0, 10);
    city_add_ground(scene, NULL, 0);
    int lights = infer(scene);
    assert_true(lights >= 30);
    assert_true(nearest_pair(scene) > 20);
    for (int i = 0; i < lights; i++) {
        const float *p = scene->lights.data[i].p;
        double x = fmod(p[0] + 500, 50), y = fmod(p[1] + 500, 50);
        assert_false(p[0] > 0 && p[0] < 180 && p[1] > 0 && p[1] < 180 && x < 30 && y < 30);
        assert_float_equal(p[2], 6, .1);
    }
    noc_scene_destroy(scene);
    scene = noc_scene_create(NULL); /* nothing there: nothing placed */
    assert_int_equal(infer(scene), 0);
    noc_scene_destroy(scene);
}

/* Walls that stand over the ground are extended down to it: buildings side by side with feet at different heights. */
static void test_skirts(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(NULL);
    for (int i = 0; i < 20; i++)
        add_building(scene, i * 9, 0, i * 9 + 8, 8, 50 + .9 * (i % 3), 60);
    city_add_ground(scene, NULL, 0);
    int under = 0;
    for (int i = 0; i < 20; i++) { /* the south wall, in its middle */
        double x = i * 9 + 4, foot = 50 + .9 * (i % 3), ground, lowest = foot;
        assert_true(noc_scene_ground(scene, x, -.01, &ground));
        for (size_t t = 0; t < scene->triangle_light.len; t++)
            for (int k = 0; k < 3; k++) {
                const float *v = scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + (size_t)k];
                bool wall = scene->materials.data[scene->triangle_material.data[t]].cls == NOC_CLASS_WALL;
                if (wall && fabs(v[0] - x) < 4.5 && fabs(v[1]) < .01)
                    lowest = fmin(lowest, v[2]);
            }
        under += ground < foot - .01;
        assert_true(lowest < ground);
    }
    assert_true(under > 3); /* else there was nothing to extend */
    noc_scene_destroy(scene);
}

static void test_add_ground(void **state) {
    noc_scene *scene = noc_scene_create(NULL); /* level: one plane */
    add_building(scene, 0, 0, 30, 30, 7, 20);
    add_building(scene, 100, 50, 130, 80, 7, 20);
    city_add_ground(scene, NULL, 0);
    double z;
    assert_true(noc_scene_ground(scene, 60, 40, &z));
    assert_float_equal(z, 7 - .02, 1e-4);
    assert_true(noc_scene_ground(scene, -55, -55, &z) && !noc_scene_ground(scene, -500, 0, &z));
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_int_equal(info.triangles_by_class[NOC_CLASS_TERRAIN] - scene->backdrop_count, 2);
    assert_true(scene->backdrop_count > 0 && scene->backdrop_count < 100);
    double far = 0; /* the land runs on to the horizon, and the bounds do not know it */
    for (size_t i = 0; i < scene->positions.len; i += 3)
        far = fmax(far, fabs(scene->positions.data[i]));
    assert_true(far > 8000 && info.bounds_max[0] < 200 && info.bounds_min[0] > -70);
    noc_scene_destroy(scene);

    scene = noc_scene_create(NULL); /* a slope of 5 percent with a street, a dormer, and a building at a wrong height */
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++)
            add_building(scene, i * 40, k * 40, i * 40 + 15, k * 40 + 15, 200 + i * 2, 212 + i * 2);
    add_building(scene, 205, 205, 208, 208, 222, 225);
    add_building(scene, 130, 30, 135, 35, 0, 5);
    add_plane(scene, NOC_CLASS_ROAD, 0, 20, 300, 26, 200, .05);
    city_add_ground(scene, NULL, 0);
    for (double x = 1; x < 290; x += 1) {
        assert_true(noc_scene_ground(scene, x, 23, &z));
        assert_float_equal(z, 200 + .05 * x, 1e-3); /* the street, not covered by the ground */
        assert_true(noc_scene_ground(scene, x, 110, &z));
        assert_float_equal(z, 200 + .05 * x, 1.2);
    }
    assert_true(noc_scene_ground(scene, 206, 206, &z) && z < 212);
    noc_scene_destroy(scene);
    scene = noc_scene_create(NULL);
    city_add_ground(scene, NULL, 0); /* nothing to stand under */
    assert_int_equal(scene->indices.len, 0);
    noc_scene_destroy(scene);
}

/* A stack of `count` planes, each a centimetre lower than the one before it: at how many points the ground under it is
 * looked at. */
static double points_of_stack(int count) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    noc_scene *scene = noc_scene_create(log);
    *told = 0;
    for (int i = 0; i < count; i++)
        add_plane(scene, NOC_CLASS_ROAD, 0, 0, 2000, 2000, 100 - .01 * i, 0);
    city_ground *g = city_ground_start(scene, NULL, 0);
    assert_non_null(g);
    double points = (double)city_ground_points(g), away;
    assert_float_equal(city_ground_height(g, 1000, 900, &away), 100 - .01 * (count - 1), 1e-3);
    assert_float_equal(away, 0, 1e-3);
    city_ground_lay(g, NULL, 0);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return points;
}

/* However many large triangles lie over one another, the points at which they are looked at are bounded; few triangles
 * are looked at twice a cell. */
static void test_ground_is_bounded(void **state) {
    (void)state;
    double one = points_of_stack(1);
    assert_true(one > 2 * 400 * 400 / 2);
    assert_float_equal(points_of_stack(100), 100 * one, .5);
    assert_string_equal(told, "");
    double bounded = points_of_stack(2000);
    print_message("# %.0f points of one, %.0f of 2000\n", one, bounded);
    assert_true(2000 * one > 2e8 && bounded < 1.02e8);
    assert_non_null(strstr(told, "it is found in steps 2."));
}

/* Roads that lie over one another: a triangle's edges are looked at beside all others. Beyond a bound the rule ends,
 * and says so. */
static void test_infer_is_bounded(void **state) {
    (void)state;
    for (int many = 0; many < 2; many++) {
        noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
        noc_scene *scene = noc_scene_create(log);
        *told = 0;
        for (int i = 0; i < (many ? 5000 : 50); i++)
            add_plane(scene, NOC_CLASS_ROAD, -100, -4 - 1e-4 * i, 100, 4, 0, 0);
        assert_true(infer(scene) >= (many ? 0 : 8));
        assert_int_equal(strstr(told, "lamps by a rule end after") != NULL, many);
        noc_scene_destroy(scene);
        noc_log_destroy(log);
    }
}

/* Walls that are long needles, each over a part of all others: rays look at hundreds of them. */
static void test_infer_is_bounded_by_walls(void **state) {
    (void)state;
    size_t most = noc_ground_most_looks;
    noc_ground_most_looks = 5000000;
    for (int many = 0; many < 2; many++) {
        noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
        noc_scene *scene = noc_scene_create(log);
        *told = 0;
        noc_material wall = noc_class_material(NOC_CLASS_WALL);
        int material = noc_scene_add_material(scene, &wall);
        for (int i = 0; i < (many ? 2000 : 4); i++) {
            double a = i * 2.4, b = a + 2, c = a + 4, r = 5000;
            double xyz[] = { r * sin(a), r * cos(a), 0, r * sin(b), r * cos(b), 0, r * sin(c), r * cos(c), 9 };
            noc_mesh mesh = { .vertex_count = 3,
                              .positions = xyz,
                              .triangle_count = 1,
                              .indices = (uint32_t[]){ 0, 1, 2 },
                              .material = material };
            assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
        }
        infer(scene);
        assert_int_equal(strstr(told, "lamps by a rule end after") != NULL, many);
        /* one more lamp at most: some hundred rays */
        assert_true(!many || noc_ground_looked(scene) < 5000000 + 2000u * 200 + 1000u * 2000);
        noc_scene_destroy(scene);
        noc_log_destroy(log);
    }
    noc_ground_most_looks = most;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_infer_cancelled),  cmocka_unit_test(test_infer_roads),
        cmocka_unit_test(test_infer_buildings),  cmocka_unit_test(test_skirts),
        cmocka_unit_test(test_add_ground),       cmocka_unit_test(test_ground_is_bounded),
        cmocka_unit_test(test_infer_is_bounded), cmocka_unit_test(test_infer_is_bounded_by_walls),
    };
    return cmocka_run_group_tests_name("city/infer", tests, NULL, NULL);
}
