/* A city with a map around it, by the files of both. */
#include "../memory.h"
#include "../told.h"

#include <nocturne/nocturne.h>

#include <math.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-map-XXXXXX", path[64], city[4096];

static void write_map(const char *name, int width, int height) {
    noc_image *map = noc_image_create(width, height, NULL);
    assert_non_null(map);
    for (int i = 0; i < 3 * width * height; i++)
        map->rgb[i] = 2;
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    assert_int_equal(noc_image_write(map, path, NULL, NULL, NULL), NOC_OK);
    noc_image_destroy(map);
}

static noc_status load(noc_log *log, noc_scene **scene) {
    const char *inputs[] = { city };
    noc_import_params params = noc_import_default_params();
    params.environment = path;
    *scene = noc_scene_create(log);
    return *scene ? noc_scene_load(*scene, inputs, 1, &params, NULL) : NOC_ERR_MEMORY;
}

static void test_map(void **state) {
    (void)state;
    noc_scene *scene;
    noc_scene_info info;
    char with[NOC_CONTENT_KEY], without[NOC_CONTENT_KEY];
    write_map("even.exr", 32, 16);
    assert_int_equal(load(NULL, &scene), NOC_OK);
    noc_scene_get_info(scene, &info);
    noc_scene_content(scene, with);
    assert_true(info.environment_width == 32 && fabs(info.environment_lux - 2 * M_PI) < 1e-4 && info.triangles > 0);
    assert_int_equal(noc_scene_set_environment(scene, NULL), NOC_OK);
    noc_scene_content(scene, without);
    assert_string_not_equal(with, without);
    noc_scene_destroy(scene);
}

/* A map around it lights a city without lamps. */
static void test_no_lamps(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    write_map("even.exr", 32, 16);
    for (int with = 0; with < 2; with++) {
        noc_import_params params = noc_import_default_params();
        noc_scene *scene = noc_scene_create(log);
        params.environment = with ? path : NULL;
        params.infer_lamps = NOC_SWITCH_OFF;
        told[0] = 0;
        assert_int_equal(noc_scene_load(scene, (const char *[]){ city }, 1, &params, NULL), NOC_OK);
        assert_int_equal(!strstr(told, "nothing in the scene shines"), with);
        noc_scene_destroy(scene);
    }
    noc_log_destroy(log);
}

static void expect_error(noc_status want, const char *says) {
    noc_log *log = counting_log();
    noc_scene *scene;
    noc_status status = load(log, &scene);
    if (status != want || !strstr(noc_log_last_error(log), says))
        fail_msg("status %d, \"%s\" does not say \"%s\"", status, noc_log_last_error(log), says);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static void test_wrong(void **state) {
    (void)state;
    write_map("square.exr", 16, 16);
    expect_error(NOC_ERR_ARGUMENT, "square.exr: a picture of 16 x 16 pixels is not equirectangular");
    write_map("even.png", 32, 16);
    expect_error(NOC_ERR_FORMAT, "even.png: a PNG holds no luminances");
    snprintf(path, sizeof(path), "%s/gone.exr", folder);
    expect_error(NOC_ERR_IO, "gone.exr");
}

static void test_memory(void **state) {
    (void)state;
    noc_log *log = counting_log();
    noc_scene *scene;
    noc_scene_info info;
    bool reached;
    write_map("even.exr", 8, 4);
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = load(log, &scene);
        reached = end_refusal();
        if (status)
            assert_true(status == NOC_ERR_MEMORY && refusing.errors == 1); /* OpenEXR has words of its own for it */
        else
            assert_int_equal(refusing.errors, 0);
        noc_scene_get_info(scene, &info);
        assert_true(status || info.environment_width == 8);
        noc_scene_destroy(scene);
    }
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_map), cmocka_unit_test(test_no_lamps),
                                        cmocka_unit_test(test_wrong), cmocka_unit_test(test_memory) };
    const char *source = getenv("NOC_SOURCE");
    assert_non_null(mkdtemp(folder));
    snprintf(city, sizeof(city), "%s/tests/cli/city.gml", source ? source : ".");
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    char command[96];
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command) ? 1 : failed;
}
