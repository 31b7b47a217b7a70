/* Roads of maps: what their tags say, from OpenStreetMap, Overpass and GeoJSON alike, by the helper and without it. */
#include "test.h"

#include "import/load/load.h"
#include "lamp_sink.h"
#include "noc_config.h"
#include <nocturne/nocturne.h>

typedef struct road_sink {
    lamp_sink lamps;
    NOC_ARRAY(geo_road) roads;
} road_sink;

static noc_status on_road(void *ctx, const geo_road *road) {
    road_sink *s = ctx;
    geo_road copy = *road;
    double *xyz = arena_alloc(&s->lamps.names, road->point_count * 3 * sizeof(*xyz));
    memcpy(xyz, road->xyz, road->point_count * 3 * sizeof(*xyz));
    copy.xyz = xyz;
    copy.id = arena_strdup(&s->lamps.names, road->id);
    copy.name = arena_strdup(&s->lamps.names, road->name);
    assert_true(array_push(&s->roads, copy));
    return NOC_OK;
}

static void start(road_sink *s, const char *text) {
    *s = (road_sink){ 0 };
    lamp_sink_start(&s->lamps);
    s->lamps.sink.road = on_road;
    assert_int_equal(read_lamps_text(&s->lamps, text, NULL), NOC_OK);
}

static void end(road_sink *s) {
    array_free(&s->roads);
    lamp_sink_end(&s->lamps);
}

#define NODES                                                                                                          \
    "<node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.101' lon='11.5'/><node id='3' lat='48.101' "             \
    "lon='11.502'/>"
#define TAG(k, v) "<tag k='" k "' v='" v "'/>"
#define WAY(id, tags) "<way id='" id "'><nd ref='1'/><nd ref='2'/><nd ref='3'/>" tags "</way>"
#define OSM(ways) "<osm version='0.6'>" NODES ways "</osm>"

static void check_main_street(const geo_road *r, const char *id) {
    assert_string_equal(r->id, id);
    assert_string_equal(r->name, "Main Street");
    assert_int_equal(r->cls, GEO_ROAD_PRIMARY);
    assert_true(r->link && r->bridge && r->motor && !r->tunnel && !r->roundabout);
    assert_int_equal(r->lanes, 3);
    assert_int_equal(r->lanes_forward, 2);
    assert_int_equal(r->lanes_backward, 0);
    assert_int_equal(r->oneway, -1);
    assert_int_equal(r->layer, 1);
    assert_int_equal(r->lit, GEO_LIT_YES);
    assert_true(fabs(r->width - 8.5) < 1e-9 && fabs(r->speed - 48.28032) < 1e-9);
    assert_int_equal(r->point_count, 3);
    assert_true(r->xyz[0] == 11.5 && r->xyz[1] == 48.1 && isnan(r->xyz[2]) && r->xyz[6] == 11.502);
}

#define JSON_TAGS                                                                                                      \
    "\"highway\":\"primary_link\",\"lanes\":\"3\",\"lanes:forward\":\"2\",\"oneway\":\"-1\",\"maxspeed\":\"30 mph\","  \
    "\"width\":\"8.5 m\",\"lit\":\"yes\",\"name\":\"Main Street\",\"bridge\":\"viaduct\",\"layer\":\"1\""
#define JSON_NODES                                                                                                     \
    "{\"type\":\"node\",\"id\":1,\"lat\":48.1,\"lon\":11.5},{\"type\":\"node\",\"id\":2,\"lat\":48.101,\"lon\":11.5}," \
    "{\"type\":\"node\",\"id\":3,\"lat\":48.101,\"lon\":11.502}"

static void overpass(void **state) {
    road_sink s;
    start(&s, "{\"generator\":\"x\",\"elements\":[" JSON_NODES
              ",{\"type\":\"way\",\"id\":4,\"nodes\":[1,2,77,3],\"tags\":{" JSON_TAGS "}},"
              "{\"type\":\"way\",\"id\":5,\"geometry\":[{\"lat\":48.1,\"lon\":11.5},null,{\"lat\":48.101,\"lon\":11.5},"
              "{\"lat\":48.101,\"lon\":11.502}],\"tags\":{" JSON_TAGS "}},"
              "{\"type\":\"way\",\"id\":6,\"center\":{\"lat\":48.1,\"lon\":11.5},\"tags\":{" JSON_TAGS "}}]}");
    assert_int_equal(s.roads.len, 2);
    check_main_street(&s.roads.data[0], "way/4");
    check_main_street(&s.roads.data[1], "way/5");
    assert_int_equal(issue_count(&s.lamps, "street or path"), 1); /* without a place */
    end(&s);
}

#if NOC_HAVE_GDAL

static void files(void **state) {
    road_sink s;
    start(&s, OSM(WAY("4", TAG("highway", "primary_link") TAG("lanes", "3") TAG("lanes:forward", "2")
                               TAG("oneway", "-1") TAG("maxspeed", "30 mph") TAG("width", "8.5 m") TAG("lit", "yes")
                                   TAG("name", "Main Street") TAG("bridge", "viaduct") TAG("layer", "1"))));
    assert_int_equal(s.roads.len, 1);
    check_main_street(&s.roads.data[0], "way/4");
    end(&s);
    start(&s,
          "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\","
          "\"properties\":{\"@id\":\"way/9\"," JSON_TAGS
          "},\"geometry\":{\"type\":\"MultiLineString\",\"coordinates\":[[[11.5,48.1],[11.5,48.101],[11.502,48.101]],"
          "[[11.5,48.1],[11.5,48.101]]]}}]}");
    assert_int_equal(s.roads.len, 2);
    check_main_street(&s.roads.data[0], "way/9");
    assert_int_equal(s.roads.data[1].point_count, 2);
    end(&s);
}

/* One tag or two, and what becomes of them. */
static void tags(void **state) {
    road_sink s;
    start(&s, OSM(WAY("1", TAG("highway", "residential") TAG("lit", "no") TAG("maxspeed", "DE:zone:30"))
                      WAY("2", TAG("highway", "motorway") TAG("maxspeed", "none") TAG("lit", "disused"))
                          WAY("3", TAG("highway", "motorway") TAG("oneway", "no") TAG("lit", "sunset-sunrise"))
                              WAY("4", TAG("highway", "tertiary") TAG("junction", "roundabout"))
                                  WAY("5", TAG("highway", "service") TAG("access", "no") TAG("motor_vehicle", "yes"))
                                      WAY("6", TAG("highway", "living_street") TAG("access", "private"))
                                          WAY("7", TAG("highway", "footway") TAG("covered", "yes"))
                                              WAY("8", TAG("railway", "tram") TAG("highway", "residential"))
                                                  WAY("9", TAG("railway", "rail") TAG("tunnel", "yes"))));
    assert_int_equal(s.roads.len, 9);
    const geo_road *r = s.roads.data - 1;
    assert_true(r[1].cls == GEO_ROAD_MINOR && r[1].lit == GEO_LIT_NO && r[1].speed == 30 && !r[1].oneway);
    assert_true(r[2].cls == GEO_ROAD_MOTORWAY && r[2].oneway == 1 && isnan(r[2].speed) && r[2].lit == GEO_LIT_NO);
    assert_true(r[3].oneway == 0 && r[3].lit == GEO_LIT_YES);
    assert_true(r[4].roundabout && r[4].oneway == 1 && r[4].lit == GEO_LIT_UNKNOWN);
    assert_true(r[5].motor && !r[6].motor && r[6].cls == GEO_ROAD_LIVING);
    assert_true(r[7].tunnel && !r[7].motor && r[7].cls == GEO_ROAD_PATH);
    assert_true(r[8].cls == GEO_ROAD_MINOR && r[9].cls == GEO_ROAD_RAIL && r[9].tunnel);
    end(&s);
}

/* What is no road that one could light. */
static void others(void **state) {
    static const char *const not_roads[] = { OSM(WAY("1", TAG("highway", "construction"))),
                                             OSM(WAY("1", TAG("highway", "platform"))),
                                             OSM(WAY("1", TAG("highway", "service_link"))),
                                             OSM(WAY("1", TAG("railway", "abandoned"))),
                                             OSM(WAY("1", TAG("waterway", "river"))) };
    for (size_t i = 0; i < NOC_COUNT(not_roads); i++) {
        road_sink s;
        start(&s, not_roads[i]);
        assert_int_equal(s.roads.len, 0);
        end(&s);
    }
}

/* Numbers that would be of use to nobody. */
static void numbers(void **state) {
    road_sink s;
    start(&s, OSM(WAY("1", TAG("highway", "road") TAG("lanes", "400") TAG("width", "9999") TAG("maxspeed", "9999")
                               TAG("layer", "-5000"))
                      WAY("2", TAG("highway", "road") TAG("lanes", "x") TAG("width", "-3") TAG("maxspeed", "0"))));
    assert_int_equal(s.roads.len, 2);
    for (size_t i = 0; i < 2; i++) {
        const geo_road *r = &s.roads.data[i];
        assert_true(!r->lanes && isnan(r->width) && isnan(r->speed) && !r->layer);
    }
    end(&s);
}

/* The helper tells what the process itself reads. */
static void load(void **state) {
    static const char text[] = OSM(WAY("1", TAG("highway", "residential") TAG("lit", "yes"))
                                       WAY("2", TAG("highway", "residential")) WAY("3", TAG("railway", "rail")));
    const char *path = temp_file(text, sizeof(text) - 1);
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR });
    for (int isolate = 0; isolate < 2; isolate++) {
        noc_import_params params = noc_import_default_params();
        noc_report *report = NULL;
        params.isolate = isolate;
        assert_int_equal(noc_inspect(log, path, &params, &report), NOC_OK);
        const noc_report_file *f = noc_report_get_file(report, 0);
        assert_true(f->roads == 2 && f->roads_lit == 1 && f->railways == 1);
        /* a thousandth of a degree of a meridian, two thousandths of the parallel of 48.101: 111.2 m and 149.1 m */
        assert_true(fabs(f->road_metres_lit - 260.1) < 1 && fabs(f->road_metres - 520.2) < 2);
        noc_report_destroy(report);
        params.infer_lamps = NOC_SWITCH_OFF; /* nobody wants them */
        assert_int_equal(noc_inspect(log, path, &params, &report), NOC_OK);
        f = noc_report_get_file(report, 0);
        assert_true(!f->roads && f->streets_unread == 2);
        noc_report_destroy(report);
    }
    noc_log_destroy(log);
}

#endif

static int tear_down(void **state) { return unlink(temp_file("", 0)); }

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overpass),
#if NOC_HAVE_GDAL
        cmocka_unit_test(files),
        cmocka_unit_test(tags),
        cmocka_unit_test(others),
        cmocka_unit_test(numbers),
        cmocka_unit_test(load),
#endif
    };
    return cmocka_run_group_tests_name("import/roads", tests, NULL, tear_down);
}
