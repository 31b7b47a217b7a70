/* What lamps say in free text: descriptions in any column, lists of directions, yes and no, and values that nobody
 * understands. */
#include "lamp_sink.h"

#include "import/lamps/tags.h"
#include "noc_config.h"
#include <nocturne/nocturne.h>

static char folder[] = "/tmp/noc-lamp-models-XXXXXX";
#include "../folder.h"

static void test_descriptions(void **state) {
    static const struct {
        const char *text;
        int source;
        double watts; /* 0: none */
        int heads;
        double kelvin, lumens;
        bool alone; /* in a column that says nothing of lamps, too */
    } rows[] = {
        { "HPS 250W AERO", GEO_SOURCE_SODIUM, 250, 0, 0, 0, true },
        { "LED, 38 WATT", GEO_SOURCE_LED, 38, 0, 0, 0, true },
        { "NAV-T 70", GEO_SOURCE_SODIUM, 70, 0, 0, 0, true },
        { "2x36W PL-L", GEO_SOURCE_FLUORESCENT, 36, 2, 0, 0, true },
        { "SON 150", GEO_SOURCE_SODIUM, 150, 0, 0, 0, true },
        { "SON-T150", GEO_SOURCE_SODIUM, 150, 0, 0, 0, true },
        { "150W HPS", GEO_SOURCE_SODIUM, 150, 0, 0, 0, true },
        { "150 HPS", GEO_SOURCE_SODIUM, 150, 0, 0, 0, true },
        { "MH-175", GEO_SOURCE_METAL_HALIDE, 175, 0, 0, 0, true },
        { "Metal Halide 400", GEO_SOURCE_METAL_HALIDE, 400, 0, 0, 0, true },
        { "400 WATT MERCURY VAPOR", GEO_SOURCE_MERCURY, 400, 0, 0, 0, true },
        { "High Pressure Sodium (100 Watts)", GEO_SOURCE_SODIUM, 100, 0, 0, 0, true },
        { "SOX-E 36", GEO_SOURCE_LOW_SODIUM, 36, 0, 0, 0, true },
        { "HQL125", GEO_SOURCE_MERCURY, 125, 0, 0, 0, true },
        { "2 \xc3\x97 58 W TL-D/840", GEO_SOURCE_FLUORESCENT, 58, 2, 4000, 0, true },
        { "3 * 70W CDM-T", GEO_SOURCE_METAL_HALIDE, 70, 3, 0, 0, true },
        { "LED 28,5 W 3000K", GEO_SOURCE_LED, 28.5, 0, 3000, 0, true },
        { "LED 4500 lm 2700 K", GEO_SOURCE_LED, 0, 0, 2700, 4500, true },
        { "PL-T 42", GEO_SOURCE_FLUORESCENT, 42, 0, 0, 0, false }, /* a pole of that number, elsewhere */
        { "Natriumdampf-Hochdruck 70 W", GEO_SOURCE_SODIUM, 70, 0, 0, 0, true },
        { "vapeur de sodium 100 W", GEO_SOURCE_SODIUM, 100, 0, 0, 0, true },
        { "High Pressure Sodium", GEO_SOURCE_SODIUM, 0, 0, 0, 0, true },
        { "LED", GEO_SOURCE_LED, 0, 0, 0, 0, true },
        { "Twin head LED 40W", GEO_SOURCE_LED, 40, 2, 0, 0, true },
        { "Double Acorn", GEO_SOURCE_UNKNOWN, 0, 2, 0, 0, false },
        { "38 WATT", GEO_SOURCE_UNKNOWN, 38, 0, 0, 0, true },
        { "0.1 kW HPS", GEO_SOURCE_SODIUM, 100, 0, 0, 0, true },
        { "LED36", GEO_SOURCE_LED, 0, 0, 0, 0, true }, /* so many diodes */
        { "HPS 240V", GEO_SOURCE_SODIUM, 0, 0, 0, 0, true },
        { "100 W Main Street", GEO_SOURCE_UNKNOWN, 100, 0, 0, 0, false },
        { "LED upgrade done in 2014", GEO_SOURCE_LED, 0, 0, 0, 0, false },
        { "Gas", GEO_SOURCE_GAS, 0, 0, 0, 0, false },
        { "PL", GEO_SOURCE_FLUORESCENT, 0, 0, 0, 0, false },
        { "MH", GEO_SOURCE_METAL_HALIDE, 0, 0, 0, 0, false },
        { "Smith & Son", GEO_SOURCE_SODIUM, 0, 0, 0, 0, false },
        { "Harbour 12", GEO_SOURCE_UNKNOWN, 0, 0, 0, 0, false },
        { "", GEO_SOURCE_UNKNOWN, 0, 0, 0, 0, false },
        { "x x 3x x2 2x", GEO_SOURCE_UNKNOWN, 0, 0, 0, 0, false },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        const lamp_model m = lamp_model_of(rows[i].text, false, 0);
        double watts = isfinite(m.watts) ? m.watts : 0, kelvin = isfinite(m.kelvin) ? m.kelvin : 0;
        double lumens = isfinite(m.lumens) ? m.lumens : 0;
        if (m.source != rows[i].source || watts != rows[i].watts || m.heads != rows[i].heads ||
            kelvin != rows[i].kelvin || lumens != rows[i].lumens || lamp_model_stands_alone(&m) != rows[i].alone)
            fail_msg("\"%s\": source %d, %g W, %d heads, %g K, %g lm, alone %d", rows[i].text, m.source, watts, m.heads,
                     kelvin, lumens, lamp_model_stands_alone(&m));
    }
}

static void read_text(lamp_sink *s, const char *text, const char *map, bool named) {
    noc_import_params params = noc_import_default_params();
    if (map)
        params.lamp_columns = (noc_texts){ .text = { map }, .count = 1 };
    lamp_sink_start(s);
    s->sink.named_lamps = named;
    assert_int_equal(read_lamps_text(s, text, &params), NOC_OK);
}

/* One column may give both; it may be called anything, and what is called by its name goes before. */
static void test_columns(void **state) {
    lamp_sink s;
    read_text(&s,
              "id,lon,lat,wattage,lamp_model,DESCR,PLANNED\n"
              "a,8,50,\"LED, 38 WATT\",,,\n"
              "b,8,50.1,,HPS 250W AERO,,LED 60W\n"
              "c,8,50.2,,,NAV-T 70,\n"
              "d,8,50.3,100,,2x36W PL-L,\n"
              "e,8,50.4,70 SON,,LED 20W,\n"
              "f,8,50.5,36,2x36W PL-L,,\n"
              "g,8,50.6,72,2x36W PL-L,,\n"
              "h,8,50.7,,,100 W Main Street,LED 60W\n",
              NULL, true);
    static const struct {
        const char *id;
        int source;
        double watts;
        int count;
    } want[] = {
        { "a", GEO_SOURCE_LED, 38, 0 },         { "b", GEO_SOURCE_SODIUM, 250, 0 },
        { "c", GEO_SOURCE_SODIUM, 70, 0 },      { "d", GEO_SOURCE_FLUORESCENT, 100, 0 },
        { "e", GEO_SOURCE_SODIUM, 70, 0 },      { "f", GEO_SOURCE_FLUORESCENT, 36, 2 },
        { "g", GEO_SOURCE_FLUORESCENT, 72, 0 }, /* of both */
        { "h", GEO_SOURCE_UNKNOWN, 0, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(want); i++) {
        const geo_lamp *l = lamp_by_id(&s, want[i].id);
        if ((int)l->source != want[i].source || l->count != want[i].count ||
            (want[i].watts > 0 ? l->watts != want[i].watts : isfinite(l->watts)))
            fail_msg("%s: source %d, %g W, %d heads", want[i].id, l->source, l->watts, l->count);
    }
    assert_int_equal(issue_count(&s, "not understood"), 0);
    assert_string_equal(s.columns.data[5].name, "DESCR");
    assert_string_equal(s.columns.data[5].field, "description");
    assert_string_equal(s.columns.data[6].field, ""); /* PLANNED */
    lamp_sink_end(&s);
}

/* Issues in their order: "4 x reason", a line each. */
static const char *issues_of(const lamp_sink *s) {
    static char text[2000];
    *text = 0;
    for (size_t i = 0, n = 0; i < geo_issues_count(s->sink.issues); i++) {
        const char *reason, *examples;
        bool repaired;
        size_t count;
        assert_true(geo_issues_get(s->sink.issues, i, &reason, &repaired, &count, &examples));
        n += (size_t)snprintf(text + n, sizeof(text) - n, "%zu x %s (%s)\n", count, reason, examples);
    }
    return text;
}

static void test_by_value(void **state) {
    char text[4000];
    size_t n = (size_t)snprintf(text, sizeof(text), "id,lon,lat,lamp_type,direction\n");
    static const char *const types[] = { "Opal", "B2", "Opal", "Opal", "Z9", "Q\"\"1", "B2", "LED", "R", "S", "T", "" };
    for (size_t i = 0; i < NOC_COUNT(types); i++)
        n += (size_t)snprintf(text + n, sizeof(text) - n, "a%zu,8,%g,\"%s\",%s\n", i, 50 + .001 * (double)i, types[i],
                              i ? "90" : "both");
    lamp_sink s;
    read_text(&s, text, NULL, false);
    assert_string_equal(issues_of(&s), "1 x direction of a lamp not understood: \"both\" (a0)\n"
                                       "3 x source of a lamp not understood: \"Opal\" (a0)\n"
                                       "2 x source of a lamp not understood: \"B2\" (a1)\n"
                                       "1 x source of a lamp not understood: \"Z9\" (a4)\n"
                                       "1 x source of a lamp not understood: \"Q 1\" (a5)\n"
                                       "1 x source of a lamp not understood: \"R\" (a8)\n"
                                       "2 x source of a lamp not understood: other values ()\n");
    lamp_sink_end(&s);
    read_text(&s, "id,lon,lat,IS_STREETLIGHT\na,8,50,Yes\nb,8,50.1,maybe\nc,8,50.2,LED 40W\nd,8,50.3,?\n", NULL, false);
    assert_int_equal(s.lamps.len, 3);
    assert_string_equal(issues_of(&s), "1 x point that has no lamp by its own word (d)\n"
                                       "1 x neither yes nor no to whether there is a lamp: \"maybe\" (b)\n");
    lamp_sink_end(&s);
}

/* A status that is not understood shines, and is told; yes and no count where all of a column are such. */
static void test_statuses(void **state) {
    lamp_sink s;
    read_text(&s,
              "id,lon,lat,lamp_type,status\na,8,50,LED,Active\nb,8,50.1,LED,Knocked down\nc,8,50.2,LED,burned out\n"
              "d,8,50.3,LED,in storage\ne,8,50.4,LED,Hors d'usage\nf,8,50.5,LED,hors service\ng,8,50.6,LED,xyz\n"
              "h,8,50.7,LED,xyz\ni,8,50.8,LED,N\nj,8,50.9,LED,0\nk,8,51,LED,\nl,8,51.1,LED,en service\n",
              NULL, false);
    assert_int_equal(s.lamps.len, 7);
    assert_string_equal(issues_of(&s), "5 x lamp not in use (removed, disused or planned) (b, c, d, e, f)\n"
                                       "2 x status of a lamp not understood, taken as in use: \"xyz\" (g)\n"
                                       "1 x status of a lamp not understood, taken as in use: \"N\" (i)\n"
                                       "1 x status of a lamp not understood, taken as in use: \"0\" (j)\n");
    lamp_sink_end(&s);
    read_text(&s, "id,lon,lat,lamp_type,status\na,8,50,LED,Y\nb,8,50.1,LED,N\nc,8,50.2,LED,\n", NULL, false);
    assert_int_equal(s.lamps.len, 2);
    assert_string_equal(issues_of(&s), "1 x lamp not in use (removed, disused or planned) (b)\n");
    lamp_sink_end(&s);
    read_text(&s, "id,lon,lat,lamp_type,status\na,8,50,LED,1\nb,8,50.1,LED,0\n", NULL, false);
    assert_int_equal(s.lamps.len, 1);
    assert_int_equal(issue_count(&s, "status of a lamp by 0 and 1, where 0 is taken as not in use: \"1\""), 1);
    lamp_sink_end(&s);
#if NOC_HAVE_GDAL
    /* of a map's layer too */
    lamp_sink_start(&s);
    const char *map =
        write_file("status.geojson",
                   "{\"type\": \"FeatureCollection\", \"features\": ["
                   "{\"type\": \"Feature\", \"properties\": {\"lamp_type\": \"LED\", \"wattage\": 40, "
                   "\"status\": \"Y\"}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [8, 50]}},"
                   "{\"type\": \"Feature\", \"properties\": {\"lamp_type\": \"LED\", \"wattage\": 40, "
                   "\"status\": \"N\"}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [8, 51]}}]}");
    assert_int_equal(read_lamps(&s, map, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    lamp_sink_end(&s);
#endif
}

/* Columns that say how far lamps are dimmed, whatever they are called, and numbers that may count LEDs. */
static void test_dimming(void **state) {
    static const char *const columns[] = { "Dimmung", "dimming", "dim_level", "Dimmer", "DIM_PROFILE" };
    lamp_sink s;
    for (size_t i = 0; i < NOC_COUNT(columns); i++) {
        char text[400];
        snprintf(text, sizeof(text),
                 "id,lon,lat,lamp_type,watts,%s\na,8,50,LED,60,50%%\nb,8,50.1,LED,60,50%%\nc,8,50.2,LED,60,100 %%\n"
                 "d,8,50.3,LED,60,no\ne,8,50.4,LED,60,\n",
                 columns[i]);
        read_text(&s, text, NULL, false);
        assert_int_equal(s.lamps.len, 5);
        assert_string_equal(issues_of(&s),
                            "2 x dimming or share of a lamp not taken: it is at its full flux: \"50%\" (a)\n");
        lamp_sink_end(&s);
    }
    read_text(&s, "id,lon,lat,lamp_type,watts,dimmable,dimensions\na,8,50,LED,60,yes,50x20\n", NULL, false);
    assert_string_equal(issues_of(&s), "");
    lamp_sink_end(&s);
    read_text(&s,
              "id,lon,lat,lamp_type,watts\na,8,50,48 LED,\nb,8,50.1,LED 24,\nc,8,50.2,LED 24 W,\nd,8,50.3,LED,24\n"
              "e,8,50.4,HPS 70,\n",
              NULL, false);
    assert_float_equal(lamp_by_id(&s, "a")->watts, 48, 0);
    assert_string_equal(issues_of(&s), "1 x number beside LED without a unit, taken as watts: \"48 LED\" (a)\n"
                                       "1 x number beside LED without a unit, taken as watts: \"LED 24\" (b)\n");
    lamp_sink_end(&s);
}

/* A table of nothing but descriptions is one of lamps where half of its rows have some. */
static void test_described(void **state) {
    lamp_sink s;
    read_text(&s, "id,lon,lat,what\na,8,50,HPS 250W AERO\nb,8,50.1,\"LED, 38 WATT\"\nc,8,50.2,\nd,8,50.3,Sodium\n",
              NULL, false);
    assert_int_equal(s.lamps.len, 4);
    assert_float_equal(lamp_by_id(&s, "a")->watts, 250, 0);
    assert_int_equal(lamp_by_id(&s, "d")->source, GEO_SOURCE_SODIUM);
    lamp_sink_end(&s);
    static const char *const others[] = {
        "id,lon,lat,what\na,8,50,HPS 250W AERO\nb,8,50.1,\nc,8,50.2,Fountain\nd,8,50.3,LED 38W\ne,8,50.4,Bench\n",
        "id,lon,lat,what\na,8,50,Bench 120 W Main Street\nb,8,50.1,PL 36\n",
    };
    for (size_t i = 0; i < NOC_COUNT(others); i++) {
        lamp_sink_start(&s);
        assert_int_equal(read_lamps_text(&s, others[i], NULL), NOC_ERR_FORMAT);
        assert_non_null(strstr(s.error, "nothing tells that"));
        lamp_sink_end(&s);
    }
}

static void test_directions(void **state) {
    static const struct {
        const char *text;
        char decimal;
        int count;
        float degrees[3];
    } rows[] = {
        { "45;225", 0, 2, { 45, 225 } },  { "0;120;240", 0, 3, { 0, 120, 240 } },
        { "N/S", 0, 2, { 0, 180 } },      { "45, 225", 0, 2, { 45, 225 } },
        { "45,225", 0, 2, { 45, 225 } },  { "45,225", ',', 1, { 45.225f } },
        { "NE | SW", 0, 2, { 45, 225 } }, { "90", 0, 1, { 90 } },
        { "22,5", ',', 1, { 22.5f } },    { "22,5;202,5", ',', 2, { 22.5f, 202.5f } },
        { "both", 0, 0, { 0 } },          { "45;", 0, 0, { 0 } },
        { "45;both", 0, 0, { 0 } },       { "90-180", 0, 0, { 0 } },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        float got[GEO_HEADINGS] = { 0 };
        int count = lamp_directions(rows[i].text, rows[i].decimal, got);
        if (count != rows[i].count || memcmp(got, rows[i].degrees, (size_t)count * sizeof(*got)))
            fail_msg("%s: %d: %g %g %g", rows[i].text, count, got[0], got[1], got[2]);
    }
}

/* As many heads as directions, each looking its own way, whatever the angle between them. */
static void test_heads(void **state) {
    const char *path =
        write_file("lamps.csv", "id,lon,lat,lamp_type,lamp_height,light:direction\n"
                                "a,9.5,51.3,LED,6,45;225\nb,9.5,51.301,LED,6,0;90\nc,9.5,51.302,LED,6,200\n");
    static const struct {
        const char *id;
        double direction;
    } want[] = { { "a", 45 }, { "a", 225 }, { "b", 0 }, { "b", 90 }, { "c", 200 } };
    noc_import_params params = noc_import_default_params();
    params.each_lamp = true;
    noc_report *report;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, &path, 1, &params, &report), NOC_OK);
    for (size_t i = 0; i < NOC_COUNT(want); i++) {
        const noc_report_lamp *l = noc_report_get_lamp(report, i);
        noc_light_info light;
        assert_non_null(l);
        assert_int_equal(noc_scene_get_light(scene, l->light, &light), NOC_OK);
        assert_string_equal(light.light.name, want[i].id);
        assert_float_equal(fmod(l->direction + .5, 360) - .5, want[i].direction, .01);
    }
    assert_null(noc_report_get_lamp(report, NOC_COUNT(want)));
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

/* Lamps of a table of poles: by yes and no, whatever that is called, and by a status of that kind. */
static void test_yes_and_no(void **state) {
    static const struct {
        const char *column, *values, *map;
        bool named;
        size_t lamps, absent, inactive;
    } rows[] = {
        { "IS_STREETLIGHT", "Yes No No yes N Y", NULL, false, 3, 3, 0 },
        { "Street Light", "Y - N y", NULL, false, 2, 2, 0 }, /* one that does not say it is a pole */
        { "has_streetlight", "true false 1 0", NULL, false, 2, 2, 0 },
        { "LUMINAIRE_YN", "Y N", NULL, false, 1, 1, 0 },
        { "Leuchte vorhanden", "ja nein", NULL, false, 1, 1, 0 },
        { "HAS_LIGHT", "Yes No -", NULL, true, 2, 1, 0 },
        { "LIGHTS", "0 2 1", NULL, true, 3, 0, 0 },
        { "LIGHTS_PRESENT", "0 2 1", NULL, true, 2, 1, 0 },
        { "LAMP", "No LED Yes N F", NULL, true, 3, 2, 0 },
        { "LAMP_TYPE", "HPS Pole_only No_Light LED", NULL, true, 2, 2, 0 },
        { "IS_STREETLIGHT", "Yes No No", "status=IS_STREETLIGHT", true, 1, 2, 0 },
        { "BURNS", "Yes No N 0 1", "status=BURNS", true, 2, 0, 3 },
        { "STATUS", "Active Missing No N Not_installed No_light", NULL, true, 2, 1, 3 },
        { "InService", "Y N", NULL, true, 1, 0, 1 },
        { "IS_ACTIVE", "1 0 -", NULL, true, 2, 0, 1 },
        { "RETIRED", "N Y - 2015-03-01", NULL, true, 2, 0, 2 },
        { "Inactive", "N Y - 1", NULL, true, 2, 0, 2 },
        { "ISLAND", "Yes No", NULL, true, 2, 0, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char text[1000], copy[200], *rest = copy, *value;
        snprintf(copy, sizeof(copy), "%s", rows[i].values);
        size_t n = (size_t)snprintf(text, sizeof(text), "pole,lon,lat,%s\n", rows[i].column);
        for (int k = 0; (value = strsep(&rest, " ")); k++) {
            for (char *p = value; *p; p++)
                *p = *p == '_' ? ' ' : *p;
            n += (size_t)snprintf(text + n, sizeof(text) - n, "p%d,8,50.%d,%s\n", k, k, *value == '-' ? "" : value);
        }
        lamp_sink s;
        read_text(&s, text, rows[i].map, rows[i].named);
        size_t absent = issue_count(&s, "no lamp by its own word"), inactive = issue_count(&s, "not in use");
        if (s.lamps.len != rows[i].lamps || absent != rows[i].absent || inactive != rows[i].inactive)
            fail_msg("%s: %s: %zu lamps, %zu without, %zu not in use", rows[i].column, rows[i].values, s.lamps.len,
                     absent, inactive);
        lamp_sink_end(&s);
    }
}

#if NOC_HAVE_GDAL
static void test_seattle(void **state) {
    REQUIRE_SHARED(path, "data/cases3/seattle_poles.geojson");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 2);
    assert_string_equal(s.lamps.data[0].id, "1002");
    assert_string_equal(s.lamps.data[1].id, "1006");
    assert_int_equal(issue_count(&s, "no lamp by its own word"), 8);
    lamp_sink_end(&s);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_descriptions),
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_by_value),
        cmocka_unit_test(test_statuses),
        cmocka_unit_test(test_dimming),
        cmocka_unit_test(test_described),
        cmocka_unit_test(test_directions),
        cmocka_unit_test(test_heads),
        cmocka_unit_test(test_yes_and_no),
#if NOC_HAVE_GDAL
        cmocka_unit_test(test_seattle),
#endif
    };
    assert_non_null(mkdtemp(folder));
    int failed = cmocka_run_group_tests_name("import lamp models", tests, NULL, NULL);
    return remove_folder() || failed;
}
