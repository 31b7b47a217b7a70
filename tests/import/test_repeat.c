/* What is named twice shines once: files, objects of overlapping tiles, lamps. Held by the flux of the scene. */
#include "fake_reader.h"

/* Lumens of all lights: pi L A, of one side or of a sphere's whole surface. */
static double flux(const noc_scene *scene) {
    double sum = 0;
    for (size_t i = 0; i < scene->lights.len; i++)
        sum += noc_light_flux(&scene->lights.data[i]);
    return sum;
}

static noc_report_totals totals_of(const struct run *r) {
    noc_report_totals t;
    noc_report_get_totals(r->report, &t);
    return t;
}

static void test_files(void **state) {
    (void)state;
    struct run r;
    char spelled[300], linked[300], copied[300];
    const char *lamps = file("near.lamps", NEAR_LAMP), *mesh = file("shining.mesh", "FAKE mesh\n");
    LOAD(&r, DEFAULTS, lamps, mesh);
    double once = flux(r.scene);
    assert_true(once > 0);
    finish(&r);
    snprintf(spelled, sizeof(spelled), "%s/./near.lamps", folder);
    snprintf(linked, sizeof(linked), "%s/linked", folder);
    snprintf(copied, sizeof(copied), "%s", file("copy", NEAR_LAMP));
    assert_int_equal(symlink("near.lamps", linked), 0);
    const char *again[] = { lamps, spelled, linked, copied, mesh };
    for (size_t i = 0; i < NOC_COUNT(again); i++) {
        LOAD(&r, DEFAULTS, lamps, mesh, again[i]);
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.warnings, 1);
        assert_non_null(strstr(r.last_warning, "taken once"));
        assert_float_equal(flux(r.scene) / once, 1, 1e-6);
        assert_int_equal(reads, 2);
        const noc_report_file *f = noc_report_get_file(r.report, 2);
        assert_true(has_line(f, i == 3 ? "copy of another file" : "file that is named twice", 1));
        assert_string_equal(f->lines[0].examples, i < 4 ? lamps : mesh);
        finish(&r);
    }
    /* of one size, and different at its end; and of a scene that is built in */
    LOAD(&r, DEFAULTS, file("x", "FAKE lamps\ncrs EPSG:25832\nlamp 678000 5404000\n"),
         file("y", "FAKE lamps\ncrs EPSG:25832\nlamp 678000 5404009\n"));
    assert_int_equal(r.warnings, 0);
    assert_int_equal(r.info.lights, 2);
    finish(&r);
    LOAD(&r, DEFAULTS, "builtin:single");
    once = flux(r.scene);
    finish(&r);
    LOAD(&r, DEFAULTS, "builtin:single", "builtin:single");
    assert_float_equal(flux(r.scene) / once, 1, 1e-6);
    finish(&r);
}

#define A HOUSE_AT("1", "678000.5", "678010.5", "5404000.5", "5404010.5")
#define B HOUSE_AT("2", "678020.5", "678030.5", "5404000.5", "5404010.5")
#define C HOUSE_AT("1", "678040.5", "678050.5", "5404000.5", "5404010.5") /* another house of the same id */
#define TILE "FAKE city\ncrs EPSG:25832\n"

static void test_objects(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *one, *two;
        size_t houses, repeated;
    } cases[] = {
        { TILE A B, TILE B C, 3, 1 }, /* tiles that overlap; the id 1 means two houses */
        /* the house anew, some decimetres larger (another level of detail), under its id; and under another: two */
        { TILE A B, TILE HOUSE_AT("2", "678020.3", "678030.7", "5404000.4", "5404010.5"), 2, 1 },
        { TILE A B, TILE HOUSE_AT("3", "678020.3", "678030.7", "5404000.4", "5404010.5"), 3, 0 },
        /* equal corners, another id */
        { TILE A, TILE HOUSE_AT("other", "678000.5", "678010.5", "5404000.5", "5404010.5"), 1, 1 },
        { TILE A, TILE HOUSE_AT("1", "678000.5", "678010.5", "5404010.5", "5404020.5"), 2, 0 }, /* the neighbour */
        { TILE A,
          TILE "object 3 1 2\npolygon 1 678000.5 5404000.5 370 678010.5 5404000.5 370 678010.5 5404010.5 380\nend\n", 2,
          0 },
        { TILE A A B, TILE, 2, 1 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        noc_import_params p = DEFAULTS;
        p.infer_lamps = NOC_SWITCH_OFF;
        LOAD(&r, p, file("one", cases[i].one), file("two", cases[i].two));
        assert_int_equal(r.status, NOC_OK);
        size_t given = 0, polygons = 0, triangles = 0;
        for (size_t f = 0; f < 2; f++) {
            given += noc_report_get_file(r.report, f)->objects;
            polygons += noc_report_get_file(r.report, f)->polygons;
            triangles += noc_report_get_file(r.report, f)->triangles;
        }
        assert_int_equal(given, cases[i].houses + cases[i].repeated);
        assert_int_equal(totals_of(&r).objects_repeated, cases[i].repeated);
        assert_int_equal(totals_of(&r).skipped, cases[i].repeated);
        assert_int_equal(polygons, i == 5 ? 5 : 4 * cases[i].houses); /* case 5: a fence of one polygon */
        assert_int_equal(triangles, i == 5 ? 7 : 6 * cases[i].houses);
        assert_int_equal(r.info.triangles_by_class[NOC_CLASS_ROOF], i == 5 ? 2 : 2 * cases[i].houses);
        finish(&r);
    }
}

/* An object that is too large to be held is told by its first part, and nothing of it is left behind. */
static void test_large_object(void **state) {
    (void)state;
    struct run r;
    static const char *const strips[] = { "678000 5404000", "678000 5404500" };
    for (int i = 0; i < 2; i++) {
        char one[300], two[300];
        snprintf(one, sizeof(one), TILE "object 1 dem -1\nmany 8 %s 600000\nend\n", strips[0]);
        snprintf(two, sizeof(two),
                 TILE "object 1 dem2 -1\nmany 8 %s 600000\nend\nobject 1 x -1\nmany 8 678000 5404900 5\nend\n",
                 strips[i]);
        LOAD(&r, DEFAULTS, file("one", one), file("two", two));
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(totals_of(&r).objects_repeated, i == 0);
        assert_int_equal(r.info.triangles_by_class[NOC_CLASS_TERRAIN], 600005 + (i == 0 ? 0 : 600000));
        finish(&r);
    }
}

static void test_lamps(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *one, *two;
        size_t lamps, repeated;
    } cases[] = {
        { "lamp 678000 5404000\n", "lamp 678000.05 5404000\n", 1, 1 }, /* the decimals of degrees */
        { "lamp 678000 5404000\n", "lamp 678000.5 5404000\n", 2, 0 },
        { "lamp 678000 5404000 #7\n", "lamp 678000.5 5404000 #7\n", 1, 1 }, /* one id, surveyed twice */
        { "lamp 678000 5404000 #7\n", "lamp 678000.5 5404000 #8\n", 2, 0 },
        { "lamp 678000 5404000 #7#8\n", "lamp 678000.5 5404000 #8\n", 1, 1 }, /* what is an id here is a ref there */
        { "lamp 678000 5404000 #8\n", "lamp 678000.5 5404000 #7#8\n", 1, 1 },
        { "lamp 678000 5404000 #7#8\n", "lamp 678000.5 5404000 #9#8\n", 1, 1 },
        { "lamp 678000 5404000 #7#8\n", "lamp 678000.5 5404000 #7#9\n", 2, 0 },
        { "lamp 678000 5404000 #7\n", "lamp 678005 5404000 #7\n", 2, 0 },                /* an id that both files use */
        { "lamp 678000 5404000\nlamp 678000 5404000\n", "lamp 678009 5404000\n", 3, 0 }, /* two on one pole */
        { "lamp 678000 5404000\nlamp 678000 5404000\n",
          "lamp 678000 5404000\nlamp 678000 5404000\nlamp 678003 5404000\n", 3, 2 },
        { "lamp 677999.99 5403999.99\n", "lamp 678000.01 5404000.01\n", 1, 1 }, /* across the border of a cell */
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char one[300], two[300];
        snprintf(one, sizeof(one), "FAKE lamps\ncrs EPSG:25832\n%s", cases[i].one);
        snprintf(two, sizeof(two), "FAKE lamps\ncrs EPSG:25832\n%s", cases[i].two);
        LOAD(&r, DEFAULTS, file("one", one), file("two", two));
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.info.lights, cases[i].lamps);
        assert_float_equal(flux(r.scene) / (5000.0 * (double)cases[i].lamps), 1, 1e-3);
        assert_int_equal(totals_of(&r).lamps_repeated, cases[i].repeated);
        assert_int_equal(totals_of(&r).lamps_mapped, cases[i].lamps);
        assert_int_equal(totals_of(&r).lamps_dropped, 0);
        finish(&r);
    }
}

/* Lamps in turn at a few points of one square metre, in one file; and as many beside them in another. What is compared
 * grows with their number alone. */
static void test_lamps_in_turn(void **state) {
    (void)state;
    enum { LAMPS = 3000 };
    static const size_t points[] = { 1, 2, 60, 90 };
    for (size_t c = 0; c < NOC_COUNT(points); c++) {
        input inputs[2] = { { .path = "one" }, { .path = "two" } };
        importer im = { .inputs = inputs, .input_count = 2 };
        for (size_t i = 0; i < 2 * LAMPS; i++) {
            pending_lamp p = { .lamp = { .id = "", .ref = "" }, .input = i / LAMPS };
            p.lamp.xyz[0] = 0.001 * (double)(i % points[c]) + (i < LAMPS ? 0.1 : 0.8);
            assert_true(array_push(&im.lamps, p));
        }
        assert_int_equal(repeat_lamps(&im), NOC_OK);
        assert_int_equal(im.lamps.len, 2 * LAMPS);
        assert_in_range(im.lamp_looks, LAMPS, 2 * LAMPS * NOC_MIN(4 * points[c], 2 * 64));
        array_free(&im.lamps);
    }
}

/* A building that its file holds twice brings its lamps twice; two rows of a table are two lamps. */
static void test_lamps_of_objects(void **state) {
    (void)state;
    static const struct {
        const char *id;
        int body_heads;
        double x;
        size_t kept;
    } second[] = {
        { "lamp", 1, 5, 1 },
        { "lamp", 0, 5, 2 },
        { "other", 1, 5, 2 },
        { "lamp", 1, 5.01, 2 },
    };
    for (size_t i = 0; i < NOC_COUNT(second); i++) {
        input in = { .path = "one", .issues = geo_issues_create() };
        importer im = { .inputs = &in, .input_count = 1 };
        pending_lamp a = { .lamp = { .id = "lamp", .ref = "", .xyz = { 5 }, .body_heads = 1 } }, b = a;
        b.lamp.id = second[i].id;
        b.lamp.body_heads = second[i].body_heads;
        b.lamp.xyz[0] = second[i].x;
        assert_true(array_push(&im.lamps, a) && array_push(&im.lamps, b));
        assert_int_equal(repeat_lamps(&im), NOC_OK);
        assert_int_equal(im.lamps.len, second[i].kept);
        assert_int_equal(in.file.lamps_repeated, 2 - second[i].kept);
        array_free(&im.lamps);
        geo_issues_destroy(in.issues);
    }
}

/* Lamps along a street, every `step` m from x on, half a metre aside where x is not 0; the last `far` of them 10 m to
 * the side. */
static const char *street(const char *name, size_t count, double step, double x, size_t far) {
    char text[4000];
    size_t n = (size_t)sprintf(text, "FAKE lamps\ncrs EPSG:25832\n");
    for (size_t i = 0; i < count; i++)
        n += (size_t)sprintf(text + n, "lamp %.2f %.2f\n", 678000 + x + step * (double)i,
                             i >= count - far ? 5404010.0
                             : x > 0          ? 5404000.5
                                              : 5404000.0);
    return file(name, text);
}

/* Two files of the same lamps, some way apart, are told; lamps that stand as near in their own file, and files that
 * share a few, are not. */
static void test_doubles(void **state) {
    (void)state;
    static const struct {
        size_t count;
        double step, apart;
        size_t far;
        const char *says;
    } cases[] = {
        { 40, 25, 1.5, 2, "38 of 40 lamps of " },
        { 40, 25, 2.9, 20, "20 of 40 lamps of " },
        { 40, 25, 1.5, 21, NULL },
        { 40, 25, 3.5, 0, NULL },
        { 40, 3, 1.5, 0, NULL },
        { 40, 5, 1.6, 0, "40 of 40 lamps of " },
        { 2, 25, 1.5, 0, NULL },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        struct run r;
        const char *other = street("other", cases[i].count, cases[i].step, 0, 0);
        const char *one = street("one", cases[i].count, cases[i].step, cases[i].apart, cases[i].far);
        LOAD(&r, DEFAULTS, one, other);
        assert_int_equal(r.status, NOC_OK);
        if (r.warnings != (cases[i].says != NULL))
            fail_msg("case %zu: %d warnings, %s", i, r.warnings, r.last_warning);
        if (cases[i].says)
            assert_true(strstr(r.last_warning, cases[i].says) && strstr(r.last_warning, one) &&
                        strstr(r.last_warning, other));
        assert_int_equal(r.info.lights, 2 * cases[i].count);
        finish(&r);
    }
    /* a file of few lamps beside a city's: its share counts, whichever comes first */
    for (int first = 0; first < 2; first++) {
        struct run r;
        const char *all = street("all", 80, 25, 0, 0), *few = street("few", 10, 25, 101.5, 0);
        LOAD(&r, DEFAULTS, first ? all : few, first ? few : all);
        assert_int_equal(r.warnings, 1);
        assert_non_null(strstr(r.last_warning, "10 of 10 lamps of "));
        finish(&r);
    }
}

/* The 53 buildings one by one, beside the file that holds all of them: nothing is added. */
static void test_ingolstadt(void **state) {
    (void)state;
    REQUIRE_SHARED(found, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz");
    char city[4096];
    snprintf(city, sizeof(city), "%s", found);
    REQUIRE_SHARED(one, "data/cities/ingolstadt/lod3/4018106/4018106.gml.gz");
    size_t walls[2], repeated[2];
    for (int i = 0; i < 2; i++) {
        noc_scene *scene = noc_scene_create(NULL);
        noc_report *report;
        noc_report_totals t;
        noc_scene_info info;
        noc_import_params p = DEFAULTS;
        p.infer_lamps = NOC_SWITCH_OFF;
        assert_int_equal(noc_scene_load(scene, (const char *[]){ city, one }, i ? 2 : 1, &p, &report), NOC_OK);
        noc_report_get_totals(report, &t);
        noc_scene_get_info(scene, &info);
        walls[i] = info.triangles_by_class[NOC_CLASS_WINDOW] + info.triangles_by_class[NOC_CLASS_ROOF];
        repeated[i] = t.objects_repeated;
        noc_report_destroy(report);
        noc_scene_destroy(scene);
    }
    assert_int_equal(walls[0], walls[1]);
    assert_int_equal(repeated[1], repeated[0] + 1);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_files),         cmocka_unit_test(test_objects),
                                        cmocka_unit_test(test_large_object),  cmocka_unit_test(test_lamps),
                                        cmocka_unit_test(test_lamps_in_turn), cmocka_unit_test(test_lamps_of_objects),
                                        cmocka_unit_test(test_doubles),       cmocka_unit_test(test_ingolstadt) };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
