/* Ground that is made up runs through what is surveyed: lamps with an elevation, feet of buildings. And elevations that
 * cannot be believed are told of. */
#include "fake_reader.h"

static double ground_at(const noc_scene *scene, double x, double y) {
    double z = NAN;
    assert_true(noc_scene_ground(scene, x - scene->origin[0], y - scene->origin[1], &z));
    return z;
}

/* Houses in a row along a street that falls by 3 %, their feet at 370 and below; lamps before them. */
static double slope(double x) { return 370 - .03 * (x - 678000); }

static const char *row_of_high_houses(char *text, size_t size, int count, double height) {
    size_t n = (size_t)snprintf(text, size, "FAKE city\ncrs EPSG:25832\n");
    for (int i = 0; i < count; i++) {
        double x = 678000 + 30 * i, z = slope(x + 5);
        n += (size_t)snprintf(text + n, size - n,
                              "object 0 h%d 2\npolygon 3 %g 5404000 %g %g 5404010 %g %g 5404010 %g %g 5404000 %g\n"
                              "polygon 1 %g 5404000 %g %g 5404000 %g %g 5404000 %g %g 5404000 %g\nend\n",
                              i, x, z, x, z, x + 10, z, x + 10, z, x, z, x + 10, z, x + 10, z + height, x, z + height);
    }
    return file("row", text);
}

static const char *row_of_houses(char *text, size_t size) { return row_of_high_houses(text, size, 10, 8); }

/* Twelve lamps 12 m before the houses, `above` the slope; the last one `slip` more. */
static const char *row_of_lamps(char *text, size_t size, double above, double slip) {
    size_t n = (size_t)snprintf(text, size, "FAKE lamps\ncrs EPSG:25832\n");
    for (int i = 0; i < 12; i++) {
        double x = 678000 + 23 * i;
        n += (size_t)snprintf(text + n, size - n, "lamp %g 5403988 %.3f #l%d\n", x,
                              slope(x) + above + (i == 11 ? slip : 0), i);
    }
    return file("row.lamps", text);
}

static void test_followed(void **state) {
    (void)state;
    struct run r;
    char houses[4000], lamps[2000];
    static const double above[] = { 0, .8, -1.2 };
    for (size_t k = 0; k < NOC_COUNT(above); k++) {
        LOAD(&r, DEFAULTS, row_of_houses(houses, sizeof(houses)), row_of_lamps(lamps, sizeof(lamps), above[k], 0));
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.warnings, 0);
        for (int i = 0; i < 12; i++) {
            double x = 678000 + 23 * i, z = ground_at(r.scene, x, 5403988);
            assert_close(z, slope(x) + above[k] - .02, .02); /* it lies 2 cm below what stands on it */
        }
        /* between two lamps it runs between them, and far away it is the city's */
        for (int i = 0; i < 11; i++) {
            double x = 678000 + 23 * (i + .5), z = ground_at(r.scene, x, 5403988);
            assert_close(z, slope(x) + above[k], .1 + .35 * fabs(above[k]));
        }
        assert_close(ground_at(r.scene, 678150, 5404064), slope(678150), .35);
        assert_int_equal(noc_report_get_file(r.report, 1)->line_count, 0);
        finish(&r);
    }
    /* two lamps a metre apart on two levels, as on a wall: between them, and no spike */
    LOAD(&r, DEFAULTS, row_of_houses(houses, sizeof(houses)),
         file("wall.lamps", "FAKE lamps\ncrs EPSG:25832\nlamp 678100 5403985 366.4\nlamp 678101 5403985 367.6\n"
                            "lamp 678103.5 5403985.5 366.5\n"));
    assert_int_equal(r.status, NOC_OK);
    for (double x = 678080; x < 678120; x += .5)
        for (double y = 5403965; y < 5404000; y += .5)
            assert_close(ground_at(r.scene, x, y), 367, 2);
    finish(&r);
    /* one slip of the pen is told of, and does not dent the ground */
    LOAD(&r, DEFAULTS, row_of_houses(houses, sizeof(houses)), row_of_lamps(lamps, sizeof(lamps), 0, 100));
    assert_int_equal(r.status, NOC_OK);
    assert_true(has_line(noc_report_get_file(r.report, 1),
                         "lamp whose elevation is more than 3 m off the ground: stood on the ground", 1));
    assert_string_equal(noc_report_get_file(r.report, 1)->lines[0].examples, "#l11");
    assert_close(ground_at(r.scene, 678253, 5403988), slope(678253), .3);
    finish(&r);
}

/* Heights that are all off alike are of another system: a warning, and the ground stays the city's, terrain or not. */
static void test_other_system(void **state) {
    (void)state;
    struct run r;
    char houses[4000], lamps[2000], terrain[5000];
    for (int with_terrain = 0; with_terrain < 2; with_terrain++)
        for (int below = 0; below < 2; below++) {
            const char *city = row_of_houses(houses, sizeof(houses));
            if (with_terrain) {
                snprintf(terrain, sizeof(terrain),
                         "%sobject 1 dem -1\npolygon 8 677900 5403900 373 678400 5403900 358 678400 5404100 358 "
                         "677900 5404100 373\nend\n",
                         houses);
                city = file("row", terrain);
            }
            LOAD(&r, DEFAULTS, city, row_of_lamps(lamps, sizeof(lamps), below ? -47.3 : 47.3, 0));
            assert_int_equal(r.status, NOC_OK);
            assert_int_equal(r.warnings, 1);
            assert_non_null(strstr(r.last_warning, "row.lamps: its 12 lamps with a height lie some 47."));
            assert_non_null(strstr(r.last_warning, below ? "below" : "above"));
            assert_int_equal(noc_report_get_file(r.report, 1)->line_count, 1);
            assert_int_equal(noc_report_get_file(r.report, 1)->lines[0].count, 12);
            assert_false(noc_report_get_file(r.report, 1)->lines[0].lossless);
            for (int i = 0; i < 12; i++)
                assert_close(ground_at(r.scene, 678000 + 23 * i, 5403988), slope(678000 + 23 * i), .5);
            assert_int_equal(r.info.lights, 12);
            finish(&r);
        }
}

/* On a bridge over the ground: on its deck, where the elevation says so; under it where it does not. */
static void test_bridge(void **state) {
    (void)state;
    struct run r;
    const char *text =
        "FAKE city\ncrs EPSG:25832\nobject 1 dem -1\n"
        "polygon 8 677900 5403900 370 678100 5403900 370 678100 5404100 370 "
        "677900 5404100 370\nend\nobject 6 b -1\npolygon 14 677990 5403990 378 678010 5403990 378 678010 5404010 378 "
        "677990 5404010 378\nend\n";
    LOAD(&r, DEFAULTS, file("bridge", text),
         file("l", "FAKE lamps\ncrs EPSG:25832\nlamp 678002 5404002 378.1\nlamp 677996 5404000 370\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(noc_report_get_file(r.report, 1)->line_count, 0);
    assert_close(r.scene->lights.data[0].p[2], 384, .02);
    assert_close(r.scene->lights.data[1].p[2], 376, .02);
    finish(&r);
}

/* Lamps without an elevation stand on the deck of a model's bridge, as on those of maps, also at its edge; not on a
 * beam, nor on a tunnel, nor under the bridge where their elevation says so. */
static void test_bridge_untold(void **state) {
    (void)state;
    static const struct {
        const char *lamp;
        double z;
        const char *counted; /* NULL: nothing */
    } cases[] = {
        { "678002 5404002", 384, "lamp on a bridge of a model: put on its deck" },
        { "678009.5 5404009.5", 384, "lamp on a bridge of a model: put on its deck" },
        { "678002 5404002 380.5", 384, "lamp on a bridge of a model: put on its deck" },
        { "678002 5404002 378.5", 384, NULL },
        { "678002 5404002 371", 376, NULL },
        { "678030 5404000", 376, NULL },
        { "678050.5 5404000", 376, "lamp under a part of a bridge of a model: left on the ground" },
        { "678070 5404000", 376, NULL },
    };
    const char *text =
        "FAKE city\ncrs EPSG:25832\nobject 1 dem -1\n"
        "polygon 8 677900 5403900 370 678100 5403900 370 678100 5404100 370 677900 5404100 370\nend\nobject 6 b -1\n"
        "polygon 14 677990 5403990 378 678010 5403990 378 678010 5404010 378 677990 5404010 378\n"
        "polygon 14 678050 5403990 379 678051 5403990 379 678051 5404010 379 678050 5404010 379\nend\n"
        "object 6 t -1\npolygon 14 678060 5403990 366 678080 5403990 366 678080 5404010 366 678060 5404010 366\nend\n";
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        struct run r;
        char lamps[200];
        snprintf(lamps, sizeof(lamps), "FAKE lamps\ncrs EPSG:25832\nlamp %s #l\n", cases[i].lamp);
        LOAD(&r, DEFAULTS, file("bridge", text), file("l", lamps));
        assert_int_equal(r.status, NOC_OK);
        const noc_report_file *f = noc_report_get_file(r.report, 1);
        assert_int_equal(f->line_count, cases[i].counted ? 1 : 0);
        assert_true(!cases[i].counted || has_line(f, cases[i].counted, 1));
        assert_close(r.scene->lights.data[0].p[2], cases[i].z, .02);
        finish(&r);
    }
}

/* The 40 lamps of Ingolstadt were surveyed with their elevation; the model has no terrain. */
static void test_ingolstadt(void **state) {
    (void)state;
    REQUIRE_SHARED(found, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz");
    char city[4096], line[500];
    snprintf(city, sizeof(city), "%s", found);
    REQUIRE_SHARED(lamps, "data/lights/ingolstadt/ingolstadt_street_lamps.geojson");
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, (const char *[]){ city, lamps }, 2, NULL, NULL), NOC_OK);
    FILE *f = fopen(lamps, "r");
    double ele = 0, x = 0, y = 0, worst = 0;
    size_t n = 0;
    while (fgets(line, sizeof(line), f)) {
        sscanf(line, " \"ele\": %lf", &ele);
        sscanf(line, " \"utm32_x\": %lf", &x);
        if (sscanf(line, " \"utm32_y\": %lf", &y) == 1) {
            worst = NOC_MAX(worst, fabs(ground_at(scene, x, y) - ele));
            if (getenv("NOC_SHOW"))
                printf("# %zu %.3f\n", n, ground_at(scene, x, y) - ele);
            n++;
        }
    }
    fclose(f);
    assert_int_equal(n, 40);
    assert_true(worst < .1);
    noc_scene_destroy(scene);
}

static size_t walls(const struct run *r) {
    noc_scene_info info;
    assert_int_equal(r->status, NOC_OK);
    noc_scene_get_info(r->scene, &info);
    return info.triangles_by_class[NOC_CLASS_WALL];
}

/* Walls of a built-in scene stand on its own ground: no ground of ours closes their doors and shops. Its lamps count.
 */
static void test_built_in(void **state) {
    (void)state;
    struct run r;
    char houses[4000];
    LOAD(&r, DEFAULTS, "builtin:city");
    noc_group_info groups[32];
    noc_report_totals totals;
    int lamps = noc_scene_find_group(r.scene, "lamps");
    assert_true(lamps > 0 && noc_scene_groups(r.scene, groups, 32) <= 32 && groups[lamps].lights > 300);
    noc_report_get_totals(r.report, &totals);
    assert_int_equal(totals.lamps_mapped, groups[lamps].lights);
    size_t alone = walls(&r);
    finish(&r);
    LOAD(&r, DEFAULTS, row_of_houses(houses, sizeof(houses)));
    size_t row = walls(&r);
    finish(&r);
    LOAD(&r, DEFAULTS, "builtin:city", row_of_houses(houses, sizeof(houses)));
    size_t both = walls(&r);
    finish(&r);
    assert_true(alone > 1000 && both >= alone && both <= alone + row + 40);
}

/* The median height of ten buildings and more is hardly one of buildings, and the unit that it may be in is offered. */
static void test_units(void **state) {
    static const struct {
        int houses;
        double height;
        const char *told; /* NULL: nothing */
    } rows[] = {
        { 10, 8, NULL },
        { 10, 2.1, NULL },
        { 10, 59, NULL },
        { 9, 80, NULL }, /* too few */
        { 10, 80,
          "the median height of a building, of 10, is 80 m, which is hardly one: are heights in feet? "
          "Times 0.3048 it would be 24.4 m" },
        { 10, 250, "are heights in decimetres? Times 0.1 it would be 25 m" },
        { 10, 800, "are heights in centimetres? Times 0.01 it would be 8 m" },
        { 10, 8000, "are heights in millimetres? Times 0.001 it would be 8 m" },
        { 10, .8, "are heights in metres, converted as if they were feet? Times 3.2808 it would be 2.62 m" },
        { 10, .012, "are heights in kilometres? Times 1000 it would be 12 m" },
        { 10, .25,
          "the median height of a building, of 10, is 0.25 m, which is hardly one: in which unit are heights?" },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        struct run r;
        char houses[4000], lamps[2000];
        LOAD(&r, DEFAULTS, row_of_high_houses(houses, sizeof(houses), rows[i].houses, rows[i].height),
             row_of_lamps(lamps, sizeof(lamps), 0, 0));
        assert_int_equal(r.status, NOC_OK);
        if (r.warnings != (rows[i].told != NULL) || (rows[i].told && !strstr(r.last_warning, rows[i].told)))
            fail_msg("%g m: %d warnings: %s", rows[i].height, r.warnings, r.last_warning);
        finish(&r);
    }
}

/* Long walls that cross in one small file: what is drawn under them is bounded, and told. */
static void test_long_feet(void **state) {
    (void)state;
    enum { WALLS = 900 };
    char *text = noc_alloc(100 * WALLS + 100);
    size_t n = (size_t)sprintf(text, "FAKE city\ncrs EPSG:25832\nobject 0 b 1\n");
    for (int i = 0; i < WALLS; i++) {
        double a = M_PI * i / WALLS, x = 500 * cos(a), y = 500 * sin(a);
        n += (size_t)sprintf(text + n, "polygon 1 %.0f %.0f %g %.0f %.0f %g %.0f %.0f 9 %.0f %.0f 9\n", 678000 - x,
                             5404000 - y, i % 7 * .2, 678000 + x, 5404000 + y, i % 5 * .2, 678000 + x, 5404000 + y,
                             678000 - x, 5404000 - y);
    }
    sprintf(text + n, "end\n");
    struct run r;
    noc_import_params p = DEFAULTS;
    p.infer_lamps = NOC_SWITCH_OFF;
    LOAD(&r, p, file("long", text));
    assert_int_equal(r.status, NOC_OK);
    size_t feet = 0;
    for (size_t m = 0; m < r.scene->meshes.len; m++) {
        const char *name = r.scene->meshes.data[m].name;
        feet += name && !strcmp(name, "foundations") ? r.scene->meshes.data[m].triangle_count : 0;
    }
    print_message("# %zu triangles under %d walls\n", feet, WALLS);
    assert_true(feet > 100000 && feet < 2 * (100000 + 8 * WALLS) + 4 * WALLS); /* 300,000 without the bound */
    finish(&r);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_followed),      cmocka_unit_test(test_other_system),
                                        cmocka_unit_test(test_bridge),        cmocka_unit_test(test_long_feet),
                                        cmocka_unit_test(test_bridge_untold), cmocka_unit_test(test_built_in),
                                        cmocka_unit_test(test_units),         cmocka_unit_test(test_ingolstadt) };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
