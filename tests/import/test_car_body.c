/* The user's own bodies for cars: how they stand, which way they look, where their lamps are, and what is no body. */
#include "test.h"

#include "scene/scene.h"
#include <nocturne/nocturne.h>

#include <math.h>

static char folder[] = "/tmp/noc-car-XXXXXX";
#include "../folder.h"
static char track[300], told[1000];
static noc_log *log_;
static noc_scene *scene;

static void hear(void *user, noc_log_level level, const char *text) { snprintf(told, sizeof(told), "%s", text); }

/* A plain at 3 m; the track goes 200 m north, from the middle. */
static noc_status load(const char *body, double length, bool isolate) {
    const double p[12] = { -500, -500, 3, 500, -500, 3, 500, 500, 3, -500, 500, 3 };
    const uint32_t t[6] = { 0, 1, 2, 0, 2, 3 };
    const noc_material terrain = noc_class_material(NOC_CLASS_TERRAIN);
    noc_import_params params = noc_import_default_params();
    params.crs = "EPSG:25832";
    params.tracks = (noc_texts){ { track }, 1 };
    params.cars.bodies = (noc_texts){ { body }, 1 };
    params.cars.body_length = length;
    params.isolate = isolate;
    noc_scene_destroy(scene);
    scene = noc_scene_create(log_);
    assert_int_equal(noc_scene_set_crs(scene, "EPSG:25832", (double[3]){ 690000, 5330000, 0 }), NOC_OK);
    noc_mesh mesh = { 4, p, 2, t, noc_scene_add_material(scene, &terrain), 0, 0, "plain" };
    assert_int_equal(noc_scene_add_mesh(scene, &mesh), 0);
    told[0] = 0;
    return noc_scene_load(scene, (const char *[]){ track }, 1, &params, NULL);
}

static void load_well(const char *body, double length, bool isolate) {
    if (load(body, length, isolate))
        fail_msg("%s", told);
}

/* y is up and the front looks along z: 4 m long from z = 1 on, 2 m wide around x = 10, 1.5 m high from y = -0.2 on. Its
 * bonnet ends at 0.9 m, and its front slopes: at the ground it is 0.4 m before where it is at the bonnet. */
#define CAR                                                                                                            \
    "o car\nv 9 -.2 1\nv 11 -.2 1\nv 11 1.3 1\nv 9 1.3 1\nv 9 -.2 5\nv 11 -.2 5\nv 11 .7 4.6\nv 9 .7 4.6\n"            \
    "f 1 4 3 2\nf 5 6 7 8\nf 3 4 8 7\nf 1 2 6 5\nf 2 3 7 6\nf 1 5 8 4\n"

/* Where a light of the car is, as the car sees it: 0 and 1 are of the right side, a headlamp and a tail lamp. */
static void light_at(int i, double out[3]) {
    noc_light_info light;
    const float *m = scene->instances.data[scene->cars.data[0].instance].transform;
    assert_int_equal(noc_scene_get_light(scene, noc_scene_instance_light(scene, 0, (size_t)i), &light), NOC_OK);
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int r = 0; r < 3; r++)
            out[k] += (double)m[4 * r + k] * (light.centre[r] - (double)m[4 * r + 3]);
    }
}

static void assert_near(const double have[3], double x, double y, double z) {
    if (fabs(have[0] - x) > 2e-3 || fabs(have[1] - y) > 2e-3 || fabs(have[2] - z) > 2e-3)
        fail_msg("%g %g %g is not %g %g %g", have[0], have[1], have[2], x, y, z);
}

/* It stands on its lowest point and looks along its way; lamps lie before the surface, 1.4 m apart. */
static void stands(void **state) {
    const char *path = write_file("car.obj", CAR);
    for (int isolate = 0; isolate < 2; isolate++) {
        load_well(path, 0, isolate);
        assert_int_equal(scene->cars.len, 1);
        assert_int_equal(noc_scene_set_time(scene, 5), NOC_OK);
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        const float *m = scene->instances.data[0].transform;
        double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, at[3];
        noc_join_instance_bounds(scene, &scene->instances.data[0], lo, hi);
        assert_true(fabsf(m[4] - 1) < 1e-4f && fabsf(m[3]) < .5f); /* north */
        assert_near((double[]){ hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2] }, 2, 4.02, 1.5);
        assert_true(fabs(lo[2] - 3) < 1e-3);
        assert_true(fabs((double)m[7] - (lo[1] + hi[1]) / 2) < .03);
        light_at(0, at); /* .44 of 1.5 m high; the lamp's lower rim, at .6 m, is .267 m behind the bumper */
        assert_near(at, 2 - .4 * .6 / .9 + .02, -.7, .66);
        light_at(2, at);
        assert_near(at, 2 - .4 * .6 / .9 + .02, .7, .66);
        light_at(1, at); /* not above the middle */
        assert_near(at, -2.02, -.7, .75);
    }
}

/* What its meshes are called says where the lamps are, on the other side, too. */
static void marked(void **state) {
    load_well(write_file("marked.obj", CAR "o Head_Light.L\nv 10.5 .3 5.1\nv 10.7 .3 5.1\nv 10.6 .5 5.1\nf 9 10 11\n"
                                           "o TAILLAMPS\nv 9.1 .8 .9\nv 9.3 .8 .9\nv 9.2 1 .9\nv 10.7 .8 .9\n"
                                           "v 10.9 .8 .9\nv 10.8 1 .9\nf 12 13 14\nf 15 16 17\n"),
              0, false);
    double at[3]; /* the middle of all is at z = 3 */
    light_at(0, at);
    assert_near(at, 2.1 + .02, -.6, .6);
    light_at(2, at);
    assert_near(at, 2.1 + .02, .6, .6);
    light_at(1, at);
    assert_near(at, -2.1 - .02, -.8, 1.1);
}

static void scaled(void **state) {
    double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    load_well(write_file("car.obj", CAR), 8, false);
    noc_join_instance_bounds(scene, &scene->instances.data[0], lo, hi);
    assert_true(fabs(hi[0] - lo[0] - 4) < 1e-3 && fabs(hi[2] - lo[2] - 3) < 1e-3);
    assert_true(fabs(scene->cars.data[0].axles - .58 * 8) < 1e-6);
}

/* The picture's light is the car's lamps' alone, in the group of cars; all of it is a vehicle. */
static void glowing(void **state) {
    char path[300];
    write_file("glow.mtl", "newmtl glow\nKe 9 9 9\nKd 1 0 0\n");
    snprintf(path, sizeof(path), "%s", write_file("glow.obj", "mtllib glow.mtl\nusemtl glow\n" CAR));
    load_well(path, 0, false);
    assert_int_equal(scene->lights.len, 4);
    size_t vehicles = 0;
    for (size_t m = 0; m < scene->meshes.len; m++)
        vehicles += scene->materials.data[scene->meshes.data[m].material].cls == NOC_CLASS_VEHICLE;
    assert_int_equal(vehicles, 2); /* with halogen lamps, and with LEDs */
}

static void wrong(void **state) {
    const struct {
        const char *name, *text, *says;
    } cases[] = {
        { "map.json", "{\"type\":\"FeatureCollection\",\"features\":[]}", "--car-body is an OBJ" },
        { "big.obj", "v 0 0 0\nv 100 0 0\nv 0 100 400\nf 1 2 3\n", "is 400 m long" },
        { "flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "is 0 m long" },
        { "points.obj", "v 0 0 0\n", "points.obj" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        assert_int_not_equal(load(write_file(cases[i].name, cases[i].text), 0, false), NOC_OK);
        if (!strstr(told, cases[i].says) || !strstr(told, cases[i].name))
            fail_msg("%s: %s", cases[i].name, told);
    }
    load_well(write_file("wide.obj", "v 0 0 0\nv 5 0 0\nv 0 1 2\nf 1 2 3\n"), 0, false);
    assert_non_null(strstr(told, "wider (5 m) than it is long (2 m)"));
    assert_int_equal(load("/nowhere/car.obj", 0, false), NOC_ERR_IO);
    assert_non_null(strstr(told, "/nowhere/car.obj"));
}

static int start(void **state) {
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = hear });
    if (!mkdtemp(folder))
        return -1;
    snprintf(track, sizeof(track), "%s", write_file("track.csv", "x,y\n690000,5330000\n690000,5330200\n"));
    return 0;
}

static int finish(void **state) {
    noc_scene_destroy(scene);
    noc_log_destroy(log_);
    return remove_folder();
}

int main(void) {
    if (!strstr(noc_features(), "assimp")) {
        puts("1..0 # SKIP no Assimp");
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stands),  cmocka_unit_test(marked), cmocka_unit_test(scaled),
        cmocka_unit_test(glowing), cmocka_unit_test(wrong),
    };
    return cmocka_run_group_tests_name("import/car_body", tests, start, finish);
}
