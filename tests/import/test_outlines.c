/* Buildings of which a CityGML has outlines and heights alone. */
#include "city_expect.h"
#include "city_pieces.h"

#include <math.h>

/* Corners' heights of the polygons of a class, the least and the greatest; their number. */
static size_t heights_of(noc_class cls, double *low, double *high) {
    size_t count = 0;
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t i = 0; i < sink.polygons.len; i++) {
        const seen_polygon *q = &sink.polygons.data[i];
        for (size_t k = 0; k < q->points && q->cls == cls; k++) {
            *low = fmin(*low, q->xyz[3 * k + 2]);
            *high = fmax(*high, q->xyz[3 * k + 2]);
        }
        count += q->cls == cls;
    }
    return count;
}

/* A block of four walls, a roof and a ground, from a height to another; turned so that all of it looks outwards. */
static void expect_block(const char *text, double from, double to) {
    double low, high, volume = 0;
    assert_int_equal(read_text(text, 3), NOC_OK);
    assert_int_equal(city_issue(&sink, "building of an outline and a height: a block with a flat roof"), 1);
    assert_int_equal(sink.polygons.len, 6);
    assert_int_equal(heights_of(NOC_CLASS_WALL, &low, &high), 4);
    if (fabs(low - from) > 1e-9 || fabs(high - to) > 1e-9)
        fail_msg("%s: %g to %g", text, low, high);
    assert_int_equal(heights_of(NOC_CLASS_ROOF, &low, &high), 1);
    assert_true(low == high && fabs(high - to) < 1e-9);
    assert_int_equal(heights_of(NOC_CLASS_GROUND, &low, &high), 1);
    assert_true(low == high && fabs(low - from) < 1e-9);
    for (size_t i = 0; i < 6; i++) { /* the divergence theorem, by fans of triangles */
        const double *v = sink.polygons.data[i].xyz;
        for (size_t k = 1; k + 1 < sink.polygons.data[i].points; k++) {
            const double *a = v, *b = v + 3 * k, *c = v + 3 * (k + 1);
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                       a[2] * (b[0] * c[1] - b[1] * c[0])) /
                      6;
        }
    }
    assert_true(fabs(volume - 0.9 * (to - from)) < 1e-9);
}

#define FOOT(z) "<b:lod0FootPrint>" SURFACES(SQUARE("foot", "1", z)) "</b:lod0FootPrint>"
#define EDGE(z) "<b:lod0RoofEdge>" SURFACES(SQUARE("edge", "1", z)) "</b:lod0RoofEdge>"
#define HEIGHT(uom, h) "<b:measuredHeight uom='" uom "'>" h "</b:measuredHeight>"

static void test_outlines(void **state) {
    (void)state;
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("m", "7.5") FOOT("30")))), 30, 37.5);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("urn:ogc:def:uom:UCUM::[ft_i]", "10") FOOT("30")))), 30, 33.048);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("urn:ogc:def:uom:EPSG::9002", "10") FOOT("30")))), 30, 33.048);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("urn:ogc:def:uom:EPSG::9001", "10") FOOT("30")))), 30, 40);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("#m", "7.5") FOOT("30") EDGE("37")))), 30, 37.5);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("#m", "7.5") EDGE("37.5")))), 30, 37.5);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("#m", "7.5") EDGE("0")))), 0, 7.5);
    expect_block(MODEL(MEMBER(BUILDING("B", "<b:storeysAboveGround>2</b:storeysAboveGround>" FOOT("30")))), 30, 36);
    expect_block(MODEL(MEMBER(BUILDING("B", HEIGHT("#m", "9") PART("P", HEIGHT("#m", "4") FOOT("30"))))), 30, 34);
    expect_block("<CityModel" NAMESPACES(
                     "3.0", GML32) "><cityObjectMember><b:Building><con:height><con:Height>"
                                   "<con:value uom='#m'>5</con:value></con:Height></con:height><b:storeysAboveGround>1"
                                   "</b:storeysAboveGround>" LOD_SURFACES(
                                       "0", SQUARE("foot", "1", "30")) "</b:Building></cityObjectMember></CityModel>",
                 30, 35);
    /* what is told of no height stays flat, and is counted; a body wins over an outline */
    expect(MODEL(MEMBER(BUILDING("B", FOOT("30")))), 3, "foot");
    assert_int_equal(city_issue(&sink, "building that is a flat outline, without a height"), 1);
    expect(MODEL(MEMBER(BUILDING("B", HEIGHT("m", "9999") FOOT("30")))), 3, "foot");
    expect(MODEL(MEMBER(BUILDING("B", HEIGHT("m", "7") FOOT("30") LOD_SOLID("1", MEMBERS(SQUARE("a", "1", "1")))))), 3,
           "a");
    assert_int_equal(geo_issues_count(sink.sink.issues), 0);
    expect(MODEL(MEMBER(BUILDING("B", HEIGHT("m", "7") FOOT("30") LOD_SOLID("1", MEMBERS(SQUARE("a", "1", "1")))))), 0,
           "foot");
}

static void test_cityjson(void **state) {
    (void)state;
    sink.reader = &noc_reader_cityjson;
    expect_block(
        "{\"type\": \"CityJSON\", \"version\": \"1.1\", \"transform\": {\"scale\": [1, 1, 1], \"translate\": "
        "[0, 0, 0]}, \"CityObjects\": {\"B\": {\"type\": \"Building\", \"attributes\": {\"measuredHeight\": "
        "7.5}, \"geometry\": [{\"type\": \"MultiSurface\", \"lod\": \"0\", \"boundaries\": [[[0, 1, 2, 3]]]}]}}, "
        "\"vertices\": [[0, 0, 30], [0.9, 0, 30], [0.9, 1, 30], [0, 1, 30]]}",
        30, 37.5);
    sink.reader = NULL;
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_outlines), cmocka_unit_test(test_cityjson) };
    int failed = cmocka_run_group_tests_name("import/outlines", tests, NULL, NULL);
    city_clear(&sink);
    return failed;
}
