/* An OBJ whose up axis was taken for another: suggested where its shape says so, and nowhere else. */
#include "../test.h"

#include <nocturne/import.h>
#include <stdio.h>
#include <unistd.h>

static char path[] = "/tmp/nocturne-up-XXXXXX";
static char last_warning[600];
static int warnings;

static void on_message(void *user, noc_log_level level, const char *text) {
    warnings += level == NOC_LOG_WARN;
    if (level == NOC_LOG_WARN)
        snprintf(last_warning, sizeof(last_warning), "%s", text);
}

typedef struct box {
    double lo[3], size[3];
} box;

/* count boxes, `step` apart, nx in a row; x east, y north, z up, written with y or z up. */
static void write_boxes(box b, int nx, int count, double step, bool z_up) {
    static const int faces[6][4] = { { 0, 1, 3, 2 }, { 4, 6, 7, 5 }, { 0, 4, 5, 1 },
                                     { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 5, 7, 3 } };
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < 8; c++) {
            double x = b.lo[0] + i % nx * step + (c & 1 ? b.size[0] : 0),
                   y = b.lo[1] + i / nx * step + (c & 2 ? b.size[1] : 0);
            double z = b.lo[2] + (c & 4 ? b.size[2] + i % 5 * b.size[2] / 5 : 0);
            fprintf(f, "v %.3f %.3f %.3f\n", x, z_up ? y : z, z_up ? z : -y);
        }
        for (int k = 0; k < 6; k++)
            fprintf(f, "f %d %d %d %d\n", 8 * i + 1 + faces[k][0], 8 * i + 1 + faces[k][1], 8 * i + 1 + faces[k][2],
                    8 * i + 1 + faces[k][3]);
    }
    fclose(f);
}

static int warnings_of(bool read_z_up) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_import_params params = noc_import_default_params();
    params.obj_up = read_z_up ? NOC_OBJ_UP_Z : NOC_OBJ_UP_Y;
    warnings = 0;
    *last_warning = 0;
    assert_int_equal(noc_inspect(log, path, &params, NULL), NOC_OK);
    noc_log_destroy(log);
    return warnings;
}

static void test_up(void **state) {
    static const struct {
        const char *what;
        box b;
        int nx, count;
        double step;
        bool told; /* where it is read the wrong way round; the right way nothing is ever said */
    } cases[] = {
        { "a city about its origin", { { -500, -500, 0 }, { 12, 10, 15 } }, 40, 1600, 25, true },
        { "a city in a map's coordinates", { { 678000, 5403000, 370 }, { 12, 10, 15 } }, 40, 1600, 25, true },
        { "three houses in a map's coordinates", { { 678000, 5403000, 370 }, { 12, 10, 15 } }, 3, 3, 25, true },
        { "a house", { { 0, 0, 0 }, { 12, 10, 8 } }, 1, 1, 0, false },
        { "a tower of 400 m", { { 0, 0, 0 }, { 60, 55, 400 } }, 1, 1, 0, false },
        { "a slab of 320 m", { { 0, 0, 0 }, { 120, 40, 320 } }, 1, 1, 0, false },
        { "a row of towers", { { 0, 0, 0 }, { 50, 50, 300 } }, 10, 10, 80, false },
        { "a front of 30 m", { { 0, 0, 0 }, { 60, 1, 30 } }, 1, 1, 0, false },
        { "a street", { { 0, 0, 0 }, { 12, 10, 15 } }, 10, 20, 30, false },
        { "a town in the mountains", { { 0, 0, 2200 }, { 12, 10, 15 } }, 10, 100, 25, false },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        for (int up = 0; up < 2; up++) {
            write_boxes(cases[i].b, cases[i].nx, cases[i].count, cases[i].step, up);
            if (warnings_of(up) != 0)
                fail_msg("%s: %s", cases[i].what, last_warning);
            int said = warnings_of(!up);
            if (said != cases[i].told)
                fail_msg("%s, read the wrong way: %s", cases[i].what, last_warning);
            if (said)
                assert_non_null(strstr(last_warning, up ? "--obj-up z" : "--obj-up y"));
        }
    /* one stray vertex far away changes nothing */
    write_boxes(cases[3].b, 10, 100, 30, false);
    FILE *f = fopen(path, "a");
    fputs("v 0 90000 0\nf 1 2 801\n", f);
    fclose(f);
    assert_int_equal(warnings_of(false), 0);
}

/* Lamps over a mesh without classes: those on a roof are told of; an elevation says where their feet are. */
static void test_roofs(void **state) {
    char lamps[] = "/tmp/nocturne-up-lamps-XXXXXX";
    assert_true(mkstemp(lamps) >= 0);
    for (int with_ele = 0; with_ele < 2; with_ele++) {
        FILE *f = fopen(path, "w");
        fputs("v 500000 5400000 370\nv 500100 5400000 370\nv 500100 5400100 370\nv 500000 5400100 370\nf 1 2 3 4\n"
              "v 500040 5400040 380\nv 500060 5400040 380\nv 500060 5400060 380\nv 500040 5400060 380\nf 5 6 7 8\n",
              f);
        fclose(f);
        f = fopen(lamps, "w");
        fprintf(f, "lamp_id,x,y,lamp_type%s\na,500050,5400050,LED%s\nb,500010,5400010,LED%s\nc,500080,5400080,LED%s\n",
                with_ele ? ",ele" : "", with_ele ? ",370" : "", with_ele ? ",370" : "", with_ele ? ",370" : "");
        fclose(f);
        noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
        noc_scene *scene = noc_scene_create(log);
        noc_import_params params = noc_import_default_params();
        params.obj_up = NOC_OBJ_UP_Z;
        params.crs = "EPSG:25832";
        warnings = 0;
        assert_int_equal(noc_scene_load(scene, (const char *[]){ path, lamps }, 2, &params, NULL), NOC_OK);
        if (with_ele)
            assert_null(strstr(last_warning, "roofs"));
        else
            assert_non_null(
                strstr(last_warning, "1 of 3 lamps that stand on surfaces without a class stand 2 m or more above"));
        *last_warning = 0;
        noc_scene_destroy(scene);
        noc_log_destroy(log);
    }
    unlink(lamps);
}

static int set_up(void **state) { return mkstemp(path) >= 0 ? 0 : -1; }
static int tear_down(void **state) { return unlink(path); }

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_up), cmocka_unit_test(test_roofs) };
    return cmocka_run_group_tests_name("import/obj_up", tests, set_up, tear_down);
}
