/* The host's locale changes nothing: what is read, reported and written is the same where the decimal point is a comma.
 */
#include "../comma_locale.h"
#include "import/load/load.h"
#include "nocturne/nocturne.h"

#include <math.h>
#include <sys/stat.h>

static char folder[] = "/tmp/noc-locale-XXXXXX";

static const struct {
    const char *name, *text;
} files[] = {
    { "city.obj", "mtllib city.mtl\nusemtl lit\nv 500000.125 5400000.25 0.5\nv 500010.125 5400000.25 0.5\n"
                  "v 500010.125 5400020.75 0.5\n"
                  "v 500000.125 5400020.75 1.5e0\nf 1 2 3\nf 1 3 4\n" },
    { "city.mtl", "newmtl lit\nKd 0.25 0.5 0.75\nKe 1.5 2.5 3.5\n" },
    { "lamps.csv",
      "lon,lat,height,lumens,street_lamp\n15.00003,48.75210,4.5,5250.5,yes\n15.00012,48.75215,6.25,1.5e3,yes\n" },
    { "lamps.geojson",
      "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"highway\":\"street_lamp\","
      "\"height\":\"7.5\"},\"geometry\":{\"type\":\"Point\",\"coordinates\":[15.00008,48.75212]}}]}" },
    { "box.gltf",
      "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"],"
      "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"intensity\":12.5,\"color\":[0.5,0.25,"
      "0.125]}]}},\"nodes\":[{\"translation\":[1.5,2.25,"
      "-3.125],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}]}" },
};

static const char *in_folder(const char *name) {
    static char path[8][300];
    static int turn;
    turn = (turn + 1) % 8;
    snprintf(path[turn], sizeof(path[turn]), "%s/%s", folder, name);
    return path[turn];
}

static int set_up(void **state) {
    if (!mkdtemp(folder))
        return -1;
    for (size_t i = 0; i < NOC_COUNT(files); i++) {
        FILE *f = fopen(in_folder(files[i].name), "w");
        fputs(files[i].text, f);
        fclose(f);
    }
    return 0;
}

static int tear_down(void **state) {
    char command[400];
    snprintf(command, sizeof(command), "rm -r '%s'", folder);
    return system(command);
}

/* All that one import leaves behind, as text. */
typedef struct outcome {
    char text[20000];
} outcome;

static void keep(void *user, noc_log_level level, const char *text) {
    outcome *o = user;
    size_t n = strlen(o->text);
    snprintf(o->text + n, sizeof(o->text) - n, "%d %s\n", (int)level, text);
}

static void add_bytes(outcome *o, const char *what, const void *data, size_t size) {
    uint64_t h = 14695981039346656037u;
    for (size_t i = 0; i < size; i++)
        h = (h ^ ((const unsigned char *)data)[i]) * 1099511628211u;
    size_t n = strlen(o->text);
    snprintf(o->text + n, sizeof(o->text) - n, "%s %zu %016llx\n", what, size, (unsigned long long)h);
}

static void add_file(outcome *o, const char *name) {
    char data[4000];
    FILE *f = fopen(in_folder(name), "rb");
    size_t n = fread(data, 1, sizeof(data), f);
    fclose(f);
    add_bytes(o, name, data, n);
}

static void run(outcome *o) {
    memset(o, 0, sizeof(*o));
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_DEBUG, .message = keep, .user = o });
    noc_scene *scene = noc_scene_create(log);
    const char *paths[] = { in_folder("city.obj"), in_folder("lamps.csv"), in_folder("lamps.geojson"),
                            in_folder("box.gltf") };
    noc_import_params params = noc_import_default_params();
    params.crs = "+proj=utm +zone=33 +ellps=GRS80 +units=m +x_0=500000.0 +k_0=0.9996";
    params.scene_crs = "EPSG:25833";
    params.obj_up = NOC_OBJ_UP_Z;
    params.lamp_height = 0.5;
    assert_int_equal(noc_scene_load(scene, paths, 3, &params, NULL), NOC_OK);
    assert_true(scene->lights.len >= 3); /* all three were seen */
    add_bytes(o, "positions", scene->positions.data, scene->positions.len * sizeof(float));
    add_bytes(o, "lights", scene->lights.data, scene->lights.len * sizeof(*scene->lights.data));
    add_bytes(o, "materials", scene->materials.data, scene->materials.len * sizeof(*scene->materials.data));
    noc_scene_destroy(scene);
    scene = noc_scene_create(log);
    assert_int_equal(noc_scene_load(scene, &paths[3], 1, NULL, NULL), NOC_OK);
    add_bytes(o, "glTF lights", scene->lights.data, scene->lights.len * sizeof(*scene->lights.data));
    noc_scene_destroy(scene);

    params.lamp_height = 1234.5; /* refused, in words */
    scene = noc_scene_create(log);
    assert_int_equal(noc_scene_load(scene, paths, 1, &params, NULL), NOC_ERR_ARGUMENT);
    noc_scene_destroy(scene);
    noc_image *image = noc_image_create(4, 4, log);
    for (size_t i = 0; i < 48; i++)
        image->rgb[i] = 0.1f * (float)i;
    assert_int_equal(noc_image_write(image, in_folder("a.png"), NULL, NULL, log), NOC_OK);
    assert_int_equal(noc_image_write(image, in_folder("a.exr"), NULL, NULL, log), NOC_OK);
    noc_image_destroy(image);
    add_file(o, "a.png");
    add_file(o, "a.exr");
    for (const noc_option *p = noc_render_options(); p->name; p++) {
        char text[80];
        const noc_render_params defaults = noc_render_default_params();
        noc_option_get(p, &defaults, text, sizeof(text));
        keep(o, NOC_LOG_INFO, text);
    }
    noc_log_destroy(log);
}

static void nothing_depends_on_the_locale(void **state) {
    outcome point, comma;
    run(&point); /* what is told once a process is told now */
    run(&point);
    assert_non_null(strstr(point.text, "1234.5"));
    REQUIRE_COMMA_LOCALE(folder);
    char text[8];
    snprintf(text, sizeof(text), "%g", 0.5);
    assert_string_equal(text, "0,5"); /* the test tests something */
    run(&comma);
    snprintf(text, sizeof(text), "%g", 0.5);
    assert_string_equal(text, "0,5"); /* and the host's locale is as it was */
    setlocale(LC_ALL, "C");
    assert_string_equal(point.text, comma.text);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(nothing_depends_on_the_locale) };
    return cmocka_run_group_tests_name("locale", tests, set_up, tear_down);
}
