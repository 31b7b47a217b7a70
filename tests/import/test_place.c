/* Where the scene's origin comes to lie, and what is said about places that make no sense. Small CityGML files. */
#include "../test.h"

#include "import/load/load.h"

#include <math.h>

static char path[] = "/tmp/nocturne-place-XXXXXX";
static int warnings, errors;
static char last_warning[600];

static void on_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    errors += level == NOC_LOG_ERROR;
    warnings += level == NOC_LOG_WARN;
    if (level == NOC_LOG_WARN)
        snprintf(last_warning, sizeof(last_warning), "%s", text);
}

/* A city of square roofs, 10 m wide, at these corners. */
static void write_city(const char *crs, const double (*xy)[2], size_t count) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(
        f,
        "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0' "
        "xmlns:g='http://www.opengis.net/gml'><g:boundedBy><g:Envelope %s%s%s/></g:boundedBy>",
        *crs ? "srsName='" : "", crs, *crs ? "'" : "");
    for (size_t i = 0; i < count; i++) {
        double x = xy[i][0], y = xy[i][1];
        fprintf(
            f,
            "<cityObjectMember><b:Building g:id='b%zu'><b:boundedBy><b:RoofSurface><b:lod2MultiSurface><g:MultiSurface>"
            "<g:surfaceMember><g:Polygon><g:exterior><g:LinearRing><g:posList>%.9g %.9g 5 %.9g %.9g 5 %.9g %.9g 5 %.9g "
            "%.9g 5 %.9g %.9g 5</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember></g:MultiSurface>"
            "</b:lod2MultiSurface></b:RoofSurface></b:boundedBy></b:Building></cityObjectMember>",
            i, x, y, x + 10, y, x + 10, y + 10, x, y + 10, x, y);
    }
    fputs("</CityModel>", f);
    fclose(f);
}

static noc_status load(const noc_import_params *params, bool inspect, double origin[3], double hi[2]) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_scene *scene = noc_scene_create(log);
    const char *paths[] = { path };
    noc_report *report = NULL;
    warnings = errors = 0;
    *last_warning = 0;
    noc_status status = load_inputs(scene, noc_readers, paths, 1, params, inspect, &report);
    for (int k = 0; k < 3; k++)
        origin[k] = scene->origin[k];
    const noc_report_file *file = noc_report_get_file(report, 0);
    for (int k = 0; k < 2 && file; k++)
        hi[k] = file->extent_max[k];
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return status;
}

static noc_import_params unlit(void) {
    noc_import_params p = noc_import_default_params();
    p.infer_lamps = false;
    return p;
}

static void expect_origin(const char *crs, const double (*xy)[2], size_t count, double x, double y, int said) {
    double origin[3], hi[2];
    noc_import_params p = unlit();
    write_city(crs, xy, count);
    assert_int_equal(load(&p, false, origin, hi), NOC_OK);
    assert_true(fabs(origin[0] - x) <= 20 && fabs(origin[1] - y) <= 20);
    assert_int_equal(warnings, 1 + said); /* one says that nothing shines */
}

#define CITY(...) (const double[][2]){ __VA_ARGS__ }, sizeof((const double[][2]){ __VA_ARGS__ }) / sizeof(double[2])

static void test_origin(void **state) {
    (void)state;
    /* the first object's, where nothing speaks against it */
    expect_origin("EPSG:25832", CITY({ 678000, 5403000 }, { 678900, 5403000 }, { 678500, 5403900 }), 678000, 5403000,
                  0);
    /* a stray at the beginning, at the end, and alone with one building */
    expect_origin("EPSG:25832", CITY({ 0, 0 }, { 678000, 5403000 }, { 678100, 5403000 }), 678000, 5403000, 1);
    expect_origin("EPSG:25832", CITY({ 678000, 5403000 }, { 678100, 5403000 }, { 0, 0 }), 678000, 5403000, 1);
    expect_origin("EPSG:25832", CITY({ 0, 0 }, { 678000, 5403000 }), 678000, 5403000, 1);
    /* a stray within the CRS's area is outvoted */
    expect_origin("EPSG:25832", CITY({ 400000, 5700000 }, { 678000, 5403000 }, { 678100, 5403000 }), 678000, 5403000,
                  1);
    expect_origin("", CITY({ 0, 0 }, { 678000, 5403000 }, { 678100, 5403000 }), 678000, 5403000, 1);
    /* axes are told by those that come after the stray, too */
    expect_origin("EPSG:25832", CITY({ 0, 0 }, { 5403000, 678000 }, { 5403000, 678100 }), 678000, 5403000, 2);
}

/* Places beyond the Earth are left out, and not counted in the extent. */
static void test_extent(void **state) {
    (void)state;
    double origin[3], hi[2];
    const double far[][2] = { { 1e300, 1e300 }, { 678000, 5403000 }, { 678100, 5403000 } };
    noc_import_params p = unlit();
    for (int with_crs = 0; with_crs < 2; with_crs++) {
        write_city(with_crs ? "EPSG:25832" : "", far, 3);
        assert_int_equal(load(&p, true, origin, hi), NOC_OK);
        assert_true(hi[0] == 678110 && hi[1] == 5403010);
        assert_int_equal(load(&p, false, origin, hi), NOC_OK);
        assert_true(origin[0] > 677000 && origin[0] < 679000);
    }
}

/* --crs and --scene-crs are looked at even where nothing needs them; a scene's CRS far from the data is said. */
static void test_options(void **state) {
    (void)state;
    double origin[3], hi[2];
    write_city("EPSG:25832", CITY({ 678000, 5403000 }));
    noc_import_params p = unlit();
    for (int i = 0; i < 3; i++) {
        p.crs = i == 0 ? "nonsense" : NULL;
        p.scene_crs = i == 1 ? "nonsense" : i == 2 ? "EPSG:4326" : NULL;
        for (int inspect = 0; inspect < 2; inspect++) {
            assert_int_equal(load(&p, inspect, origin, hi), NOC_ERR_ARGUMENT);
            assert_int_equal(errors, 1);
        }
    }
    p.crs = NULL;
    p.scene_crs = "EPSG:32633"; /* the zone beside it */
    assert_int_equal(load(&p, false, origin, hi), NOC_OK);
    assert_int_equal(warnings, 1);
    p.scene_crs = "EPSG:32640"; /* so far away that its metres are none */
    assert_int_equal(load(&p, false, origin, hi), NOC_OK);
    assert_int_equal(warnings, 3);
}

static int set_up(void **state) {
    (void)state;
    return mkstemp(path) >= 0 ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    return unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_origin), cmocka_unit_test(test_extent),
                                        cmocka_unit_test(test_options) };
    return cmocka_run_group_tests_name("import/place", tests, set_up, tear_down);
}
