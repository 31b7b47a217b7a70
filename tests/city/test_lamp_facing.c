/* Directions of lamps that nothing tells: which lamps' light depends on the choice, and so are counted. */
#include "lamp_scene.h"

#include <stdio.h>
#include <unistd.h>

static city_lamp_tally tally;
static bool told_by_chance;

static void told(void *user, const city_lamp_light *light) { told_by_chance = light->by_chance; }

/* Stands the lamp on the plane of that class, without profiles or with them. Returns how many are by chance. */
static size_t stand(noc_scene *scene, const geo_lamp *lamp, city_profiles *profiles) {
    city_lamp_params params = defaults;
    tally = (city_lamp_tally){ 0 };
    params.tally = &tally;
    params.profiles = profiles;
    params.told = told;
    assert_true(city_add_lamp(scene, lamp, &params, false, NULL) > 0);
    assert_int_equal(told_by_chance, tally.by_chance);
    return tally.by_chance;
}

static void count(const char *name, const geo_lamp *lamp, noc_scene *scene, city_profiles *profiles, size_t bare,
                  size_t profiled) {
    geo_lamp l = *lamp;
    static double x; /* lamps do not stand on one another */
    for (int i = 0; i < 2; i++) {
        l.xyz[0] = -90 + x;
        x += 4;
        size_t n = stand(scene, &l, i ? profiles : NULL);
        if (n != (i ? profiled : bare))
            fail_msg("%s, %s: %zu", name, i ? "with profiles" : "bare", n);
    }
}

/* What tells the direction: tags, a road, a building; lamps of one place alike. */
static void told_directions(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_status status;
    city_profiles *profiles = city_profiles_create(scene, NULL, &status);
    add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 0, 0);
    add_plane(scene, NOC_CLASS_ROAD, -100, 50, 100, 58, .1, 0);
    add_building(scene, -100, -60, 100, -50, 0, 10);
    geo_lamp lamp = lamp_at(0, 0);
    count("in a field", &lamp, scene, profiles, 1, 1);
    lamp.direction = 0;
    count("tagged", &lamp, scene, profiles, 0, 0);
    lamp = lamp_at(0, 48);
    count("beside a road", &lamp, scene, profiles, 0, 0);
    lamp = lamp_at(0, 54);
    count("on a road", &lamp, scene, profiles, 1, 1);
    lamp = lamp_at(0, -47);
    count("beside a building", &lamp, scene, profiles, 0, 0);
    lamp = lamp_at(0, 20);
    for (int i = 0; i < 3; i++) /* moved apart, each is its own */
        assert_int_equal(stand(scene, &lamp, profiles), 1);
    city_profiles_destroy(profiles);
    noc_scene_destroy(scene);
}

/* Whose light is the same whichever way it faces is no guess. */
static void round_lamps(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_status status;
    city_profiles *profiles = city_profiles_create(scene, NULL, &status);
    add_plane(scene, NOC_CLASS_TERRAIN, -400, -400, 400, 400, 0, 0);
    geo_fitting fitting = geo_no_fitting();
    geo_lamp lamp = lamp_at(0, 0);
    lamp.fitting = &fitting;
    lamp.type = GEO_LAMP_LANTERN;
    count("a post top", &lamp, scene, profiles, 0, 0);
    lamp.count = 2; /* 0.4 m off the pole */
    count("two lanterns", &lamp, scene, profiles, 0, 0);
    fitting.profile = city_profiles_builtin("cobra-head");
    count("a lantern with a road's distribution", &lamp, scene, profiles, 0, 1);
    lamp.count = 0;
    lamp.type = GEO_LAMP_FLOOD;
    fitting.profile = 0;
    count("a floodlight", &lamp, scene, profiles, 1, 1);
    fitting.tilt = 0;
    count("a floodlight that looks down", &lamp, scene, profiles, 0, 0);
    lamp.type = GEO_LAMP_STREET;
    fitting.profile = city_profiles_builtin("post-top");
    count("on an arm", &lamp, scene, profiles, 1, 1);
    fitting.arm = 0;
    count("without an arm", &lamp, scene, profiles, 0, 0);
    fitting.tilt = 10;
    count("tilted", &lamp, scene, profiles, 1, 1);
    fitting.shape = NOC_LAMP_POINT;
    count("a tilted point", &lamp, scene, profiles, 0, 1);
    fitting = geo_no_fitting();
    lamp.mount = GEO_MOUNT_SUSPENDED;
    count("over the middle of a street", &lamp, scene, profiles, 0, 1);
    city_profiles_destroy(profiles);
    noc_scene_destroy(scene);
}

/* Whether planes of a file are alike. */
static void round_files(void **state) {
    static const struct {
        double second; /* of 100 cd in the other plane */
        size_t by_chance;
    } rows[] = { { 100, 0 }, { 96, 0 }, { 90, 1 } };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char path[] = "/tmp/noc-facing-XXXXXX", text[300];
        int file = mkstemp(path);
        assert_true(file >= 0);
        int n = snprintf(text, sizeof(text),
                         "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 2 1 2 0 0 0\n1 1 20\n0 90\n0 90\n100 100\n100 %g\n",
                         rows[i].second);
        assert_int_equal(write(file, text, (size_t)n), n);
        close(file);
        noc_scene *scene = noc_scene_create(NULL);
        noc_status status;
        city_profiles *profiles = city_profiles_create(scene, path, &status);
        assert_non_null(profiles);
        add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 0, 0);
        geo_lamp lamp = lamp_at(0, 0);
        lamp.type = GEO_LAMP_LANTERN;
        if (stand(scene, &lamp, profiles) != rows[i].by_chance)
            fail_msg("%g cd", rows[i].second);
        city_profiles_destroy(profiles);
        noc_scene_destroy(scene);
        unlink(path);
    }
}

/* A modelled lamp's light stays where it is; one head off its middle tells the direction. */
static void modelled(void **state) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_status status;
    city_profiles *profiles = city_profiles_create(scene, NULL, &status);
    add_plane(scene, NOC_CLASS_TERRAIN, -100, -100, 100, 100, 0, 0);
    geo_lamp lamp = lamp_at(0, 0);
    lamp.xyz[2] = 0;
    lamp.body_heads = 1;
    lamp.head_radius = .2f;
    lamp.head[0][2] = 5;
    assert_int_equal(stand(scene, &lamp, profiles), 1);
    assert_int_equal(stand(scene, &lamp, NULL), 0);
    lamp.head_globe = true;
    assert_int_equal(stand(scene, &lamp, profiles), 0);
    lamp.head_globe = false;
    lamp.head[0][0] = 1;
    assert_int_equal(stand(scene, &lamp, profiles), 0);
    city_profiles_destroy(profiles);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(told_directions),
        cmocka_unit_test(round_lamps),
        cmocka_unit_test(round_files),
        cmocka_unit_test(modelled),
    };
    return cmocka_run_group_tests_name("city/lamp_facing", tests, NULL, NULL);
}
