/* Lamps from Overpass JSON: the same places as the map they were made from, ways with centers, broken answers. */
#include "lamp_sink.h"

static void test_helsinki(void **state) {
    REQUIRE_SHARED(shared, "data/lights/helsinki/helsinki_street_lamps_overpass.json");
    char json[4096];
    snprintf(json, sizeof(json), "%s", shared);
    lamp_sink a, b;
    lamp_sink_start(&a);
    assert_int_equal(read_lamps(&a, json, NULL), NOC_OK);
    assert_string_equal(a.format, "Overpass JSON");
    assert_string_equal(a.crs, "OGC:CRS84");
    assert_int_equal(a.lamps.len, 586);
    assert_int_equal(a.errors, 0);
    REQUIRE_SHARED(pbf, "data/lights/helsinki/Helsinki.osm.pbf");
    lamp_sink_start(&b);
    noc_status status = read_lamps(&b, pbf, NULL);
    if (status == NOC_OK) { /* a build without GDAL says so */
        assert_int_equal(b.lamps.len, 586);
        for (size_t i = 0; i < a.lamps.len; i++) {
            const geo_lamp *l = lamp_by_id(&b, a.lamps.data[i].id);
            assert_float_equal(l->xyz[0], a.lamps.data[i].xyz[0], 1e-6);
            assert_float_equal(l->xyz[1], a.lamps.data[i].xyz[1], 1e-6);
        }
    } else {
        assert_int_equal(status, NOC_ERR_UNSUPPORTED);
    }
    lamp_sink_end(&a);
    lamp_sink_end(&b);
}

static void test_neukoelln(void **state) {
    REQUIRE_SHARED(path, "data/lights/berlin_neukoelln/neukoelln_street_lamps_overpass.json.gz");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 4983);
    assert_int_equal(lamp_by_id(&s, "node/885598686")->mount, GEO_MOUNT_WALL);
    size_t gas = 0;
    for (size_t i = 0; i < s.lamps.len; i++)
        gas += s.lamps.data[i].source == GEO_SOURCE_GAS && s.lamps.data[i].type == GEO_LAMP_LANTERN;
    assert_int_equal(gas, 123); /* lamp_type=gaslight */
    lamp_sink_end(&s);
}

static const char answer[] =
    "{\"version\": 0.6, \"generator\": \"test\", \"elements\": [\n"
    "{\"type\": \"node\", \"id\": 1, \"lat\": 50.5, \"lon\": 8.25, \"tags\": {\"highway\": \"street_lamp\", "
    "\"height\": \"16 ft\",\n"
    "  \"light:count\": \"2\", \"light:direction\": \"NNE\", \"light:colour\": \"#ff8000\", "
    "\"light:method\": \"LED\"}},\n"
    "{\"type\": \"way\", \"id\": 2, \"center\": {\"lat\": 50.6, \"lon\": 8.5}, "
    "\"tags\": {\"highway\": \"street_lamp\"}},\n"
    "{\"type\": \"relation\", \"id\": 3, \"bounds\": {\"minlat\": 50, \"minlon\": 8, \"maxlat\": 51, \"maxlon\": 9},\n"
    "  \"tags\": {\"light_source\": \"floodlight\", \"light:lumen\": \"12,000 lm\", \"ele\": \"120.5\"}},\n"
    "{\"type\": \"way\", \"id\": 4, \"nodes\": [1], \"tags\": {\"highway\": \"street_lamp\"}},\n"
    "{\"type\": \"node\", \"id\": 5, \"lat\": 95, \"lon\": 8, \"tags\": {\"highway\": \"street_lamp\"}},\n"
    "{\"type\": \"node\", \"id\": 6, \"lat\": 50, \"lon\": 8, \"tags\": {\"disused:highway\": \"street_lamp\"}},\n"
    "{\"type\": \"node\", \"id\": 7, \"lat\": 50, \"lon\": 8, \"tags\": {\"highway\": \"street_lamp\", "
    "\"indoor\": \"yes\"}},\n"
    "{\"type\": \"node\", \"id\": 8, \"lat\": 50, \"lon\": 8, \"tags\": {\"amenity\": \"bench\"}},\n"
    "{\"type\": \"node\", \"id\": 9, \"lat\": \"x\", \"lon\": [], \"tags\": {\"highway\": \"street_lamp\"}},\n"
    "{\"type\": 5, \"id\": {}, \"tags\": []}, null, 7, \"text\", [],\n"
    "{\"type\": \"node\", \"id\": 10, \"lat\": 0, \"lon\": 0, \"tags\": {\"highway\": \"street_lamp\", "
    "\"height\": 3}}\n"
    "]}\n";

static void test_elements(void **state) {
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, answer, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 3);
    const geo_lamp *l = lamp_by_id(&s, "node/1");
    assert_float_equal(l->height, 4.8768, 1e-9);
    assert_float_equal(l->direction, 22.5, 1e-9);
    assert_int_equal(l->count, 2);
    assert_int_equal(l->source, GEO_SOURCE_LED);
    assert_float_equal(l->rgb[0], 1, 1e-6);
    assert_float_equal(l->rgb[1], .2158605, 1e-5);
    assert_true(isnan(l->xyz[2]) && isnan(l->lumens) && isnan(l->kelvin));
    l = lamp_by_id(&s, "way/2");
    assert_float_equal(l->xyz[0], 8.5, 1e-12);
    assert_float_equal(l->xyz[1], 50.6, 1e-12);
    l = lamp_by_id(&s, "relation/3");
    assert_int_equal(l->type, GEO_LAMP_FLOOD);
    assert_float_equal(l->lumens, 12000, 1e-9);
    assert_float_equal(l->xyz[2], 120.5, 1e-9);
    assert_int_equal(issue_count(&s, "without a place"), 2);
    assert_int_equal(issue_count(&s, "out of range"), 1);
    assert_int_equal(issue_count(&s, "not in use"), 1);
    assert_int_equal(issue_count(&s, "indoors"), 1);
    assert_int_equal(issue_count(&s, "0, 0"), 1);
    lamp_sink_end(&s);
}

/* Cut anywhere: one clear error with the file's name, and no other outcome. */
static void test_cut(void **state) {
    size_t size = strlen(answer);
    while (answer[size - 1] != '}')
        size--;
    for (size_t n = 100; n < size; n += 13) {
        lamp_sink s;
        lamp_sink_start(&s);
        const char *path = temp_file(answer, n);
        assert_int_equal(read_lamps(&s, path, NULL), NOC_ERR_FORMAT);
        assert_int_equal(s.errors, 1);
        assert_non_null(strstr(s.error, path));
        lamp_sink_end(&s);
    }
}

static void test_cancel(void **state) {
    lamp_sink s;
    lamp_sink_start(&s);
    s.cancel_after = 1;
    assert_int_equal(read_lamps_text(&s, answer, NULL), NOC_ERR_CANCELLED);
    assert_int_equal(s.lamps.len, 1);
    lamp_sink_end(&s);
}

static int tear_down(void **state) { return unlink(temp_file("", 0)); }

static void test_ways(void **state) {
    (void)state;
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(
        read_lamps_text(
            &s,
            "{\"generator\": \"test\", \"elements\": [\n"
            "{\"type\": \"node\", \"id\": 1, \"lat\": 50.5, \"lon\": 8.25, \"tags\": {\"highway\": \"street_lamp\"}},\n"
            "{\"type\": \"way\", \"id\": 2, \"tags\": {\"building\": \"yes\"}},\n"
            "{\"type\": \"way\", \"id\": 3, \"tags\": {\"highway\": \"residential\"}},\n"
            "{\"type\": \"way\", \"id\": 4, \"tags\": {\"highway\": \"street_lamp\"}}]}",
            NULL),
        NOC_OK);
    assert_int_equal(issue_count(&s, "building that is not read"), 1);
    assert_int_equal(issue_count(&s, "street or path that is not read"), 1);
    assert_non_null(strstr(s.warning, "1 building, 1 street or path are not read"));
    lamp_sink_end(&s);
}

static size_t outline_points;
static noc_status count_footprint(void *ctx, const geo_footprint *footprint) {
    (void)ctx;
    outline_points += footprint->ring_size[0];
    return NOC_OK;
}

/* A short file whose relation asks again and again for one long way. */
static void test_long_relation(void **state) {
    (void)state;
    enum { POINTS = 1100, MEMBERS = 1000, ROOM = 40 * (POINTS + MEMBERS) + 400 };
    char *text = malloc(ROOM);
    for (int members = 1; members <= MEMBERS; members += MEMBERS - 1) {
        int n = snprintf(text, ROOM,
                         "{\"generator\": \"test\", \"elements\": [{\"type\": \"way\", \"id\": 1, "
                         "\"tags\": {\"note\": \"long\"}, \"geometry\": [");
        for (int i = 0; i <= POINTS; i++)
            n += snprintf(text + n, ROOM - (size_t)n, "%s{\"lat\": %.6f, \"lon\": %.6f}", i ? "," : "",
                          50 + 1e-3 * sin(2 * M_PI * (i % POINTS) / POINTS),
                          8 + 1e-3 * cos(2 * M_PI * (i % POINTS) / POINTS));
        n += snprintf(text + n, ROOM - (size_t)n,
                      "]}, {\"type\": \"relation\", \"id\": 2, \"tags\": {\"type\": \"multipolygon\", "
                      "\"building\": \"yes\"}, \"members\": [");
        for (int i = 0; i < members; i++)
            n += snprintf(text + n, ROOM - (size_t)n, "%s{\"type\": \"way\", \"ref\": 1}", i ? "," : "");
        n += snprintf(text + n, ROOM - (size_t)n, "]}]}");
        assert_true(n < ROOM);
        lamp_sink s;
        lamp_sink_start(&s);
        s.sink.footprint = count_footprint;
        outline_points = 0;
        assert_int_equal(read_lamps_text(&s, text, NULL), NOC_OK);
        assert_int_equal(outline_points, members == 1 ? POINTS : 0);
        assert_int_equal(issue_count(&s, "more than a million points"), members > 1);
        lamp_sink_end(&s);
    }
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_helsinki),      cmocka_unit_test(test_neukoelln), cmocka_unit_test(test_ways),
        cmocka_unit_test(test_elements),      cmocka_unit_test(test_cut),       cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_long_relation),
    };
    return cmocka_run_group_tests_name("import/overpass", tests, NULL, tear_down);
}
