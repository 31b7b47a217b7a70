/* The user's own body for lamps: heads and whole ones, where their light is, and what is no body. */
#include "test.h"

#include "import/load/load.h"
#include <nocturne/nocturne.h>

#include <math.h>

static char folder[] = "/tmp/noc-body-XXXXXX";
#include "../folder.h"
static char lamps[300], told[1000], warned[1000];
static noc_log *log_;
static noc_scene *scene;

static void hear(void *user, noc_log_level level, const char *text) {
    if (level == NOC_LOG_ERROR)
        snprintf(told, sizeof(told), "%s", text);
    if (level == NOC_LOG_WARN)
        snprintf(warned, sizeof(warned), "%s", text);
}

static noc_status load(const char *body, bool isolate) {
    const char *paths[] = { lamps };
    noc_import_params params = noc_import_default_params();
    params.lamp_body = body;
    params.isolate = isolate;
    params.crs = "EPSG:25832";
    noc_scene_destroy(scene);
    scene = noc_scene_create(log_);
    return noc_scene_load(scene, paths, 1, &params, NULL);
}

static void load_well(const char *body, bool isolate) {
    if (load(body, isolate))
        fail_msg("%s", told);
}

/* A mast of 5 m with a hood 2 m before it; y is up, and it looks along z. A quarter of it marks its light. */
#define MAST "o mast\nv -.1 0 0\nv .1 0 0\nv 0 5 0\nf 1 2 3\n"
#define HOOD "o hood\nv -.1 5 2\nv .1 5 2\nv 0 5 2.2\nf 4 5 6\n"
#define MARK "o Light\nv -.1 4 2\nv .1 4 2\nv -.1 4 2.2\nv .1 4 2.2\nf 7 8 9\nf 8 9 10\n"

static const double *place(size_t instance) {
    static double row[3];
    for (int k = 0; k < 3; k++)
        row[k] = scene->instances.data[instance].transform[4 * k + 3];
    return row;
}

/* Where the transform takes a direction of the model. */
static void turn(size_t instance, const double from[3], double to[3]) {
    for (int r = 0; r < 3; r++) {
        to[r] = 0;
        for (int c = 0; c < 3; c++)
            to[r] += (double)scene->instances.data[instance].transform[4 * r + c] * from[c];
    }
}

/* Of bodies, so without the disc that shines. */
static size_t lamp_triangles(void) {
    size_t n = 0;
    for (size_t m = 0; m < scene->meshes.len; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        bool lamp = scene->materials.data[mesh->material].cls == NOC_CLASS_LAMP;
        n += lamp && scene->triangle_light.data[mesh->first_triangle] == NOC_NO_LIGHT ? mesh->triangle_count : 0;
    }
    return n;
}

/* The lamp is 8 m high and faces east: so is the model, and its light hangs 4 m (twice its 2) east of the foot. */
static void whole(void **state) {
    const char *path = write_file("whole.obj", MAST HOOD MARK);
    for (int isolate = 0; isolate < 2; isolate++) {
        load_well(path, isolate);
        assert_int_equal(scene->instances.len, 1);
        double up[3], front[3], light[3];
        const double *foot = place(0);
        turn(0, (double[]){ 0, 0, 1 }, up);
        turn(0, (double[]){ 0, -1, 0 }, front);
        assert_true(fabs(up[2] - 2) < 1e-5 && fabs(front[0] - 2) < 1e-5 && fabs(front[1]) < 1e-5);
        for (int k = 0; k < 3; k++)
            light[k] = scene->lights.data[0].p[k] - foot[k];
        assert_true(fabs(light[0] - 4.2) < 1e-3 && fabs(light[1]) < 1e-3 && fabs(light[2] - 8) < 1e-3);
        assert_int_equal(lamp_triangles(), 2); /* the mark is not shown, and nothing of ours is */
        assert_false(scene->lights.data[0].flags & NOC_LIGHT_MOVES);
    }
}

/* A head hangs above its light, as it is, on a pole of ours. */
static void head(void **state) {
    load_well(write_file("head.obj", "o hood\nv -.1 0 0\nv .1 0 0\nv 0 0 .4\nf 1 2 3\n"), false);
    double up[3], front[3];
    assert_int_equal(scene->instances.len, 1);
    turn(0, (double[]){ 0, 0, 1 }, up);
    turn(0, (double[]){ 0, -1, 0 }, front);
    assert_true(fabs(up[2] - 1) < 1e-6 && fabs(front[0] - 1) < 1e-6);
    const double *at = place(0);
    assert_true(fabs(at[0] - scene->lights.data[0].p[0]) < 1e-5 &&
                fabs(at[2] - .01 - scene->lights.data[0].p[2]) < 1e-4);
    assert_true(lamp_triangles() > 10);
    assert_null(strstr(warned, "reaches"));
    load_well(write_file("head.obj", "o hood\nv -100 0 0\nv 100 0 0\nv 0 0 400\nf 1 2 3\n"), false); /* in mm */
    assert_non_null(strstr(warned, "head reaches 400 m from where it shines"));
}

/* The picture's light is the lamp's alone. */
static void glowing(void **state) {
    char path[300];
    write_file("glow.mtl", "newmtl glow\nKe 9 9 9\nKd 1 0 0\n");
    snprintf(path, sizeof(path), "%s",
             write_file("glow.obj", "mtllib glow.mtl\nusemtl glow\no a\nv 0 0 0\nv 1 0 0\n"
                                    "v 0 0 1\nf 1 2 3\n"));
    load_well(path, false);
    assert_int_equal(scene->lights.len, 1);
}

static void wrong(void **state) {
    const struct {
        const char *name, *text, *says;
    } cases[] = {
        { "map.json", "{\"type\":\"FeatureCollection\",\"features\":[]}", "--lamp-body is an OBJ" },
        { "mark.obj", "o light\nv 0 1 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\n", "has no triangles" },
        { "low.obj", MAST "o light\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 4 5 6\n", "above its foot" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        told[0] = 0;
        assert_int_not_equal(load(write_file(cases[i].name, cases[i].text), false), NOC_OK);
        assert_non_null(strstr(told, cases[i].says));
        assert_non_null(strstr(told, cases[i].name));
    }
    told[0] = 0;
    assert_int_equal(load("/nowhere/lamp.obj", false), NOC_ERR_IO);
    assert_non_null(strstr(told, "/nowhere/lamp.obj"));
}

/* Lamps on walls have no pole, so a body with one is not theirs. */
static void on_walls(void **state) {
    FILE *f = fopen(lamps, "w");
    fputs("id,x,y,height,direction,lamp_mount\nA,690000,5330000,8,90,wall\n", f);
    fclose(f);
    load_well(write_file("whole.obj", MAST HOOD MARK), false);
    assert_int_equal(scene->instances.len, 0);
    load_well(write_file("head.obj", MAST), false);
    assert_int_equal(scene->instances.len, 1);
}

static int start(void **state) {
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = hear });
    if (!mkdtemp(folder))
        return -1;
    snprintf(lamps, sizeof(lamps), "%s",
             write_file("lamps.csv", "id,x,y,height,direction,lamp_type\nA,690000,5330000,8,90,led\n"));
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
        cmocka_unit_test(whole), cmocka_unit_test(head),     cmocka_unit_test(glowing),
        cmocka_unit_test(wrong), cmocka_unit_test(on_walls),
    };
    return cmocka_run_group_tests_name("import/body", tests, start, finish);
}
