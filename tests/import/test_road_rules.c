/* Rules and groups that ask for the kind of the road that a lamp stands beside. */
#include "test.h"

#include <math.h>
#include <nocturne/nocturne.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-road-rules-XXXXXX";
#include "../folder.h"
#include "../told.h"
static noc_log *log_;

/* Six roads, one north of the other, from west to east: the second one is the pavement of the first. */
static const struct {
    double latitude;
    const char *tags;
} roads[] = {
    { 48.7600, "<tag k='highway' v='residential'/><tag k='lit' v='no'/>" },
    { 48.76005, "<tag k='highway' v='footway'/><tag k='lit' v='no'/>" },
    { 48.7610, "<tag k='highway' v='primary'/><tag k='name' v='Ring'/><tag k='lit' v='yes'/>" },
    { 48.7620, "<tag k='highway' v='primary_link'/><tag k='lit' v='no'/>" },
    { 48.7630, "<tag k='highway' v='footway'/><tag k='lit' v='no'/>" },
    { 48.7640, "<tag k='highway' v='living_street'/><tag k='lit' v='no'/>" },
};

/* Of lamps beside the roads, the first one between a carriageway and its pavement, the last one beside none. */
static const double lamps[] = { 48.76004, 48.76095, 48.76195, 48.76298, 48.76396, 48.7635 };

static void write_map(FILE *f) {
    fputs("<osm version='0.6'>", f);
    for (int i = 0; i < 12; i++)
        fprintf(f, "<node id='%d' lat='%.5f' lon='%s'/>", i + 1, roads[i / 2].latitude, i % 2 ? "11.4240" : "11.4200");
    for (int i = 0; i < 6; i++)
        fprintf(f, "<node id='%d' lat='%.5f' lon='11.4220'><tag k='highway' v='street_lamp'/></node>", i + 21,
                lamps[i]);
    for (int i = 0; i < 6; i++)
        fprintf(f, "<way id='%d'><nd ref='%d'/><nd ref='%d'/>%s</way>", i + 31, 2 * i + 1, 2 * i + 2, roads[i].tags);
    fputs("</osm>", f);
}

static int start(void **state) {
    (void)state;
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    FILE *f = fopen(in_folder("map.osm"), "w");
    assert_non_null(f);
    write_map(f);
    return fclose(f);
}

static int end(void **state) {
    (void)state;
    unlink(in_folder("map.osm"));
    unlink(in_folder("map.geojson"));
    noc_log_destroy(log_);
    return rmdir(folder);
}

typedef struct loaded {
    noc_scene *scene;
    noc_report *report;
    size_t lights; /* slots */
} loaded;

static loaded load(const char *name, const noc_import_params *params) {
    loaded l = { .scene = noc_scene_create(log_) };
    noc_scene_info info;
    *told = 0;
    if (noc_scene_load(l.scene, (const char *[]){ in_folder(name) }, 1, params, &l.report))
        fail_msg("%s", told);
    noc_scene_get_info(l.scene, &info);
    l.lights = info.light_slots;
    return l;
}

static void unload(loaded *l) {
    noc_report_destroy(l->report);
    noc_scene_destroy(l->scene);
}

/* "125": the mapped lamps that are in the group of those; *inferred: how many of the others. */
static size_t in_group(const loaded *l, char found[16]) {
    size_t n = 0, inferred = 0;
    for (size_t i = 0; i < l->lights; i++) {
        noc_light_info light;
        assert_int_equal(noc_scene_get_light(l->scene, i, &light), NOC_OK);
        if (light.light.group != 1)
            continue;
        inferred += light.light.inferred;
        if (!light.light.inferred && n < 15)
            found[n++] = light.light.name[strlen(light.light.name) - 1];
    }
    found[n] = 0;
    return inferred;
}

static size_t assert_matches(const char *name, const char *test, noc_switch infer, const char *expected) {
    const noc_condition condition = { "road", test };
    noc_group_rule group = noc_group_default_rule();
    noc_luminaire_rule rule = noc_luminaire_default_rule();
    noc_import_params params = noc_import_default_params();
    group.name = "those";
    group.conditions = rule.conditions = &condition;
    group.condition_count = rule.condition_count = 1;
    params.groups = &group;
    params.group_count = 1;
    params.luminaires = &rule;
    params.luminaire_count = 1;
    params.infer_lamps = infer;
    loaded l = load(name, &params);
    char found[16];
    size_t inferred = in_group(&l, found);
    if (strcmp(found, expected))
        fail_msg("%s: %s: %s, not %s", name, test, found, expected);
    assert_int_equal(noc_report_get_rule(l.report, 0)->lamps, strlen(expected) + inferred);
    unload(&l);
    return inferred;
}

static void test_roads_of_a_map(void **state) {
    (void)state;
    static const char *const rows[][2] = {
        { "residential", "1" }, /* whose pavement is nearer */
        { "RESIDENTIAL", "1" },
        { "primary", "2" },
        { "primary*", "23" }, /* with its links */
        { "footway", "4" },
        { "residential|living_street", "15" },
        { "!residential", "2345" }, /* what stands beside none is not asked */
        { "absent", "6" },
        { "*", "12345" },
        { "trunk", "" },
    };
    for (size_t i = 0; i < sizeof(rows) / sizeof(*rows); i++)
        assert_int_equal(assert_matches("map.osm", rows[i][0], NOC_SWITCH_OFF, rows[i][1]), 0);
}

static void test_lamps_that_are_placed(void **state) {
    (void)state;
    assert_true(assert_matches("map.osm", "primary", NOC_SWITCH_ON, "2") > 3);
    assert_int_equal(assert_matches("map.osm", "!primary", NOC_SWITCH_ON, "1345"), 0);
}

/* Columns of other maps: in capitals, and as Geofabrik's Shapefiles have it. */
static void test_columns_of_a_map(void **state) {
    (void)state;
    static const char *const keys[] = { "highway", "HIGHWAY", "fclass" };
    for (size_t i = 0; i < 3; i++) {
        FILE *f = fopen(in_folder("map.geojson"), "w");
        assert_non_null(f);
        fprintf(f,
                "{\"type\":\"FeatureCollection\",\"features\":["
                "{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[11.4220,48.76004]},"
                "\"properties\":{\"highway\":\"street_lamp\",\"ref\":\"1\"}},"
                "{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[11.4220,48.76104]},"
                "\"properties\":{\"highway\":\"street_lamp\",\"ref\":\"2\"}},"
                "{\"type\":\"Feature\",\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[11.42,48.76],"
                "[11.424,48.76]]},\"properties\":{\"%s\":\"residential\",\"bridge\":\"F\"}},"
                "{\"type\":\"Feature\",\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[11.42,48.761],"
                "[11.424,48.761]]},\"properties\":{\"%s\":\"tertiary\",\"tunnel\":\"F\"}}]}",
                keys[i], keys[i]);
        fclose(f);
        assert_matches("map.geojson", "residential", NOC_SWITCH_OFF, "1");
        assert_matches("map.geojson", "tertiary", NOC_SWITCH_OFF, "2");
    }
}

static void assert_warned(const char *key, const char *test, const char *expected) {
    const noc_condition condition = { key, test };
    noc_luminaire_rule rule = noc_luminaire_default_rule();
    noc_import_params params = noc_import_default_params();
    rule.conditions = &condition;
    rule.condition_count = 1;
    rule.place = "town.yaml:4";
    params.luminaires = &rule;
    params.luminaire_count = 1;
    params.infer_lamps = NOC_SWITCH_OFF;
    loaded l = load("map.osm", &params);
    char line[400];
    snprintf(line, sizeof(line), "town.yaml:4: the rule matches no lamp%s\n", expected);
    if (strlen(told) < strlen(line) || strcmp(told + strlen(told) - strlen(line), line))
        fail_msg("%s: %s: %s", key, test, told);
    unload(&l);
}

static void test_what_idle_rules_may_mean(void **state) {
    (void)state;
    assert_warned("highway", "residential",
                  ": highway is asked of its own tags, and a road's kind is asked by road: residential");
    assert_warned("highway", "bus_stop", "");
    assert_warned("surface", "residential", "");
    assert_warned("road", "Main Street",
                  ": road is one of OpenStreetMap's words for the nearest road (residential, primary, ...), and a "
                  "column of that name is asked by tag:road");
    assert_warned("road", "motorway", ": no road of the inputs is of that kind");
}

/* The report of each lamp: its roads, its rules in their order, and what nothing tells of it. */
static void test_each_lamp(void **state) {
    (void)state;
    const noc_condition asks[] = { { "road", "primary" }, { "inferred", "yes" } };
    noc_luminaire_rule rules[3] = { noc_luminaire_default_rule(), noc_luminaire_default_rule(),
                                    noc_luminaire_default_rule() };
    noc_import_params params = noc_import_default_params();
    rules[0].place = "town.yaml:2";
    rules[0].height = 7.5;
    rules[1].conditions = &asks[0];
    rules[1].condition_count = 1;
    rules[1].watts = 60;
    rules[1].profile = "flood";
    rules[2].conditions = &asks[1];
    rules[2].condition_count = 1;
    rules[2].place = "town.yaml:9";
    rules[2].kelvin = 2200;
    params.luminaires = rules;
    params.luminaire_count = 3;
    params.infer_lamps = NOC_SWITCH_ON;
    loaded l = load("map.osm", &params);
    assert_null(noc_report_get_lamp(l.report, 0)); /* nobody asked */
    unload(&l);
    params.each_lamp = true;
    l = load("map.osm", &params);
    static const char *const road[] = { "residential", "primary", "primary_link", "footway", "living_street", "" };
    const noc_report_lamp *lamp;
    size_t mapped = 0, inferred = 0, before = 0;
    for (size_t i = 0; (lamp = noc_report_get_lamp(l.report, i)); i++) {
        noc_light_info light;
        assert_int_equal(noc_scene_get_light(l.scene, lamp->light, &light), NOC_OK);
        assert_true(light.lamp && (!i || lamp->light > before) && fabs(lamp->height - 7.5) < 0.05);
        before = lamp->light;
        if (light.light.inferred) {
            inferred++;
            assert_string_equal(lamp->file, "");
            assert_string_equal(lamp->road, "primary");
            assert_string_equal(lamp->rules, "town.yaml:2; rule 2; town.yaml:9");
            assert_int_equal(lamp->assumed, 1 << NOC_LAMP_EFFICACY); /* rules say all but lm/W */
            continue;
        }
        size_t number = (size_t)(light.light.name[strlen(light.light.name) - 1] - '1');
        bool ring = number == 1;
        assert_true(number < 6);
        mapped++;
        assert_string_equal(lamp->file, in_folder("map.osm"));
        assert_string_equal(lamp->road, road[number]);
        assert_string_equal(lamp->street, ring ? "Ring" : "");
        assert_string_equal(lamp->rules, ring ? "town.yaml:2; rule 2" : "town.yaml:2");
        assert_string_equal(lamp->profile, ring ? "flood" : "cobra-head");
        assert_true(ring ? lamp->watts == 60 : isnan(lamp->watts));
        bool lost = !*lamp->road; /* no road is near */
        assert_int_equal(lamp->assumed, 1 << NOC_LAMP_COLOUR | (ring ? 1 << NOC_LAMP_EFFICACY : 1 << NOC_LAMP_FLUX) |
                                            (lost ? 1 << NOC_LAMP_DIRECTION : 0));
        if (ring) /* its road is to the north */
            assert_true(fabs(remainder(lamp->direction, 360)) < 3);
    }
    assert_true(mapped == 6 && inferred > 3);
    unload(&l);
    params.luminaire_count = 0;
    l = load("map.osm", &params);
    for (size_t i = 0; (lamp = noc_report_get_lamp(l.report, i)); i++)
        assert_true((lamp->assumed & 7) == 7 && !*lamp->rules); /* of a placed one the road's class said what it is */
    unload(&l);
}

/* Who asks for the report sees the lamps that others see, whether roads are read or not. */
static void test_asking_changes_no_lamp(void **state) {
    (void)state;
    for (int infer = NOC_SWITCH_OFF; infer <= NOC_SWITCH_AUTO; infer++) {
        noc_import_params params = noc_import_default_params();
        params.infer_lamps = (noc_switch)infer;
        loaded plain = load("map.osm", &params);
        params.each_lamp = true;
        loaded asked = load("map.osm", &params);
        assert_int_equal(plain.lights, asked.lights);
        assert_non_null(noc_report_get_lamp(asked.report, 5));
        for (size_t i = 0; i < plain.lights; i++) {
            noc_light_info a, b;
            assert_int_equal(noc_scene_get_light(plain.scene, i, &a), NOC_OK);
            assert_int_equal(noc_scene_get_light(asked.scene, i, &b), NOC_OK);
            assert_memory_equal(a.light.position, b.light.position, sizeof(a.light.position));
            assert_memory_equal(a.light.direction, b.light.direction, sizeof(a.light.direction));
            assert_memory_equal(a.light.c0, b.light.c0, sizeof(a.light.c0));
        }
        unload(&plain);
        unload(&asked);
    }
}

/* Many points at once are where one by one they are; one without a place harms no other. */
static void test_places_of_many(void **state) {
    (void)state;
    noc_scene *scene = noc_scene_create(log_);
    assert_int_equal(noc_scene_set_crs(scene, "EPSG:25832", (double[3]){ 678000, 5403000, 370 }), NOC_OK);
    double many[9] = { 0, 0, 0, NAN, 0, 0, 1000, -500, 20 };
    assert_int_equal(noc_scene_from_local_all(scene, "EPSG:4326", many, 3), NOC_OK);
    for (int i = 0; i < 3; i += 2) {
        double one[3] = { i * 500, i * -250, i * 10 };
        assert_int_equal(noc_scene_from_local(scene, "EPSG:4326", one), NOC_OK);
        assert_memory_equal(one, many + 3 * i, sizeof(one));
    }
    assert_true(fabs(many[0] - 11.42) < .05 && fabs(many[1] - 48.75) < .05 && isnan(many[3]));
    noc_scene_destroy(scene);
}

int main(void) {
    if (!strstr(noc_features(), "gdal")) {
        puts("1..0 # SKIP no GDAL");
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_roads_of_a_map),         cmocka_unit_test(test_lamps_that_are_placed),
        cmocka_unit_test(test_columns_of_a_map),       cmocka_unit_test(test_each_lamp),
        cmocka_unit_test(test_places_of_many),         cmocka_unit_test(test_what_idle_rules_may_mean),
        cmocka_unit_test(test_asking_changes_no_lamp),
    };
    return cmocka_run_group_tests(tests, start, end);
}
