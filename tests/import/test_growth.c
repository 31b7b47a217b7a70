/* What a city costs as it grows, in bytes that are counted: of the scene, of a view of it after its first frames (light
 * structures, without its pixels), and of the ray tracing structure. Each limit is a tenth over what is held today, so
 * that none creeps up; that of the ray tracing structure, which Embree makes by the processor, is half over it. */
#include "../own_view.h"
#include "../test.h"

#include <nocturne/nocturne.h>

#include <math.h>
#include <unistd.h>

enum { SIDE = 32, WIDTH = 32, HEIGHT = 18 };

typedef struct cost {
    double scene, view, structure, lights, windows, triangles;
} cost;

static cost cost_of(noc_scene *scene) {
    noc_scene_info info;
    noc_view *view = own_view(scene, 1, NULL);
    noc_render_params p = noc_render_default_params();
    noc_camera camera;
    noc_frame_stats stats;
    p.width = WIDTH;
    p.height = HEIGHT;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, (double)WIDTH / HEIGHT, &camera), NOC_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(noc_view_render(view, &camera, &p, NULL), NOC_OK);
    noc_view_get_stats(view, &stats);
    noc_scene_get_info(scene, &info);
    close_view(view);
    return (cost){ .scene = (double)info.memory_bytes,
                   .view = (double)(stats.memory_bytes - stats.picture_bytes - stats.structure_bytes),
                   .structure = (double)stats.structure_bytes,
                   .lights = (double)info.lights,
                   .windows = (double)info.windows,
                   .triangles = (double)(info.triangles - info.instance_triangles) };
}

static cost cost_of_files(const char *const *paths, size_t count, noc_switch windows, double lit) {
    noc_log *log = noc_log_create(NULL);
    noc_scene *scene = noc_scene_create(log);
    noc_import_params params = noc_import_default_params();
    params.infer_lamps = NOC_SWITCH_OFF;
    params.windows = windows;
    params.window.lit_windows = lit;
    if (noc_scene_load(scene, paths, count, &params, NULL))
        fail_msg("%s", noc_log_last_error(log));
    cost c = cost_of(scene);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return c;
}

static FILE *begin(char path[40], const char *suffix) {
    snprintf(path, 40, "/tmp/nocturne-growth-XXXXXX%s", suffix);
    int file = mkstemps(path, (int)strlen(suffix));
    assert_true(file >= 0);
    FILE *f = fdopen(file, "w");
    assert_non_null(f);
    return f;
}

/* Rows of houses of 10 m by 8 m, 9 m high, on land as large as that of all. */
static void write_houses(char path[40], int count) {
    FILE *f = begin(path, ".city.json");
    fputs("{\"type\": \"CityJSON\", \"version\": \"1.1\", \"metadata\": {\"referenceSystem\": "
          "\"https://www.opengis.net/def/crs/EPSG/0/25832\"},\n\"transform\": {\"scale\": [1, 1, 1], \"translate\": "
          "[690000, 5330000, 500]},\n\"CityObjects\": {\n\"land\": {\"type\": \"LandUse\", \"geometry\": [{\"type\": "
          "\"MultiSurface\", \"lod\": \"1\", \"boundaries\": [[[0, 1, 2, 3]]]}]}",
          f);
    for (int k = 0; k < count; k++) {
        int v = 4 + 8 * k;
        fprintf(f,
                ",\n\"b%d\": {\"type\": \"Building\", \"geometry\": [{\"type\": \"MultiSurface\", \"lod\": \"2\", "
                "\"boundaries\": [",
                k);
        for (int i = 0; i < 4; i++)
            fprintf(f, "[[%d, %d, %d, %d]], ", v + i, v + (i + 1) % 4, v + 4 + (i + 1) % 4, v + 4 + i);
        fprintf(f, "[[%d, %d, %d, %d]]]}]}", v + 4, v + 5, v + 6, v + 7);
    }
    fprintf(f, "},\n\"vertices\": [[-10, -10, 0], [%d, -10, 0], [%d, %d, 0], [-10, %d, 0]", 25 * SIDE, 25 * SIDE,
            25 * SIDE, 25 * SIDE);
    for (int k = 0; k < count; k++)
        for (int corner = 0; corner < 8; corner++) {
            int x = 25 * (k % SIDE) + (corner % 4 == 1 || corner % 4 == 2 ? 10 : 0);
            fprintf(f, ", [%d, %d, %d]", x, 20 * (k / SIDE) + (corner % 4 >= 2 ? 8 : 0), corner < 4 ? 0 : 9);
        }
    fputs("]}\n", f);
    assert_int_equal(fclose(f), 0);
}

/* Lamps on the land, as dense as they are many. */
static void write_lamps(char path[40], int columns, int rows) {
    FILE *f = begin(path, ".geojson");
    fputs("{\"type\": \"FeatureCollection\", \"crs\": {\"type\": \"name\", \"properties\": {\"name\": "
          "\"urn:ogc:def:crs:EPSG::25832\"}}, \"features\": [",
          f);
    for (int i = 0; i < columns * rows; i++)
        fprintf(f,
                "%s{\"type\": \"Feature\", \"properties\": {\"highway\": \"street_lamp\"}, \"geometry\": {\"type\": "
                "\"Point\", \"coordinates\": [%.3f, %.3f]}}",
                i ? ",\n" : "", 690000 + 20. * SIDE * (i % columns) / columns,
                5330000 + 20. * SIDE * (i / columns) / rows);
    fputs("]}\n", f);
    assert_int_equal(fclose(f), 0);
}

/* Bytes a thing, by what as many again cost. */
static void expect(const char *what, const cost *one, const cost *two, double things, const cost *most) {
    double scene = (two->scene - one->scene) / things, view = (two->view - one->view) / things,
           structure = (two->structure - one->structure) / things;
    print_message("# %s: %.1f bytes of the scene, %.1f of the view, %.1f of the ray tracing structure\n", what, scene,
                  view, structure);
    assert_true(scene <= 1.1 * most->scene);
    assert_true(view <= 1.1 * most->view);
    assert_true(structure <= 1.5 * most->structure);
}

static void test_lamps(void **state) {
    (void)state;
    cost c[2];
    char land[40], lamps[40];
    write_houses(land, 1);
    for (int i = 0; i < 2; i++) {
        write_lamps(lamps, 64, 32 << i);
        c[i] = cost_of_files((const char *const[]){ land, lamps }, 2, NOC_SWITCH_OFF, 0);
        unlink(lamps);
        assert_true(c[i].lights == 64 * (32 << i));
    }
    unlink(land);
    expect("a lamp", &c[0], &c[1], 64 * 32, &(cost){ 160, 15, 64 });
}

static void test_houses(void **state) {
    (void)state;
    cost bare[2], dark[2], lit[2];
    for (int i = 0; i < 2; i++) {
        char path[40];
        write_houses(path, SIDE * (SIDE / 2) << i);
        const char *input = path;
        bare[i] = cost_of_files(&input, 1, NOC_SWITCH_OFF, 0);
        dark[i] = cost_of_files(&input, 1, NOC_SWITCH_ON, 0);
        lit[i] = cost_of_files(&input, 1, NOC_SWITCH_ON, 1);
        unlink(path);
    }
    assert_true(dark[1].windows > 10 * SIDE * SIDE && lit[1].windows == dark[1].windows);
    expect("a triangle of a wall or roof", &bare[0], &bare[1], bare[1].triangles - bare[0].triangles,
           &(cost){ 67, 0, 77 });
    expect("a dark window", &bare[1], &dark[1], dark[1].windows, &(cost){ 196, 15, 185 });
    expect("a lit window more than a dark one", &dark[1], &lit[1], dark[1].windows, &(cost){ 0, 0, 0 });
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_lamps), cmocka_unit_test(test_houses) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
