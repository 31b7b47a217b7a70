/* Tables and maps whose columns say little: named as lamps, with columns mapped, units in headers, and kinds in values.
 */
#include "lamp_sink.h"

#include "import/lamps/tags.h"
#include "noc_config.h"

static noc_status read_with(lamp_sink *s, const char *text, bool named, const char *map) {
    noc_import_params params = noc_import_default_params();
    if (map)
        params.lamp_columns = (noc_texts){ .text = { map }, .count = 1 };
    lamp_sink_start(s);
    s->sink.named_lamps = named;
    return read_lamps_text(s, text, &params);
}

static const geo_column *column(const lamp_sink *s, const char *name) {
    for (size_t i = 0; i < s->columns.len; i++)
        if (!strcmp(s->columns.data[i].name, name))
            return &s->columns.data[i];
    fail_msg("no column %s", name);
    return NULL;
}

static void expect_column(const lamp_sink *s, const char *name, const char *field, const char *unit,
                          const char *example) {
    const geo_column *c = column(s, name);
    assert_string_equal(c->field, field);
    assert_string_equal(c->unit, unit);
    assert_string_equal(c->example, example);
}

/* ---- keys ---- */

static void test_units_of_keys(void **state) {
    static const struct {
        const char *key;
        lamp_field field;
        double scale;
        const char *unit;
    } keys[] = {
        { "Height (ft)", LAMP_FIELD_HEIGHT, .3048, "ft" },
        { "MOUNT_HT_FT", LAMP_FIELD_HEIGHT, .3048, "ft" },
        { "mounting height [feet]", LAMP_FIELD_HEIGHT, .3048, "ft" },
        { "Pole Height in Feet", LAMP_FIELD_HEIGHT, .3048, "ft" },
        { "MOUNT_HT", LAMP_FIELD_HEIGHT, 1, "m" },
        { "Masth\xc3\xb6he [m]", LAMP_FIELD_HEIGHT, 1, "m" },
        { "pole_hgt_cm", LAMP_FIELD_HEIGHT, .01, "cm" },
        { "Power (kW)", LAMP_FIELD_WATTS, 1000, "kW" },
        { "Lichtstrom [klm]", LAMP_FIELD_LUMENS, 1000, "klm" },
        { "lamp_power_w", LAMP_FIELD_WATTS, 1, "W" },
        { "elevation_ft", LAMP_FIELD_ELEVATION, .3048, "ft" },
        { "CCT (K)", LAMP_FIELD_KELVIN, 1, "K" },
        { "lamp_type", LAMP_FIELD_TYPE, 1, "" },
        { "light", LAMP_FIELD_NONE, 1, "" },
        { "weight", LAMP_FIELD_NONE, 1, "" },
        { "Height (lm)", LAMP_FIELD_NONE, 1, "" },
        { "ft", LAMP_FIELD_NONE, 1, "" },
        { "\xe9\xab\x98\xe3\x81\x95", LAMP_FIELD_NONE, 1, "" },
    };
    for (size_t i = 0; i < NOC_COUNT(keys); i++) {
        lamp_meaning m = lamp_meaning_of(keys[i].key);
        if (m.field != keys[i].field || fabs(m.scale - keys[i].scale) > 1e-12 || strcmp(m.unit, keys[i].unit))
            fail_msg("%s: field %d, %g %s", keys[i].key, m.field, m.scale, m.unit);
    }
}

static void test_units_in_tables(void **state) {
    lamp_sink s;
    assert_int_equal(read_with(&s,
                               "id,lon,lat,lamp_type,MOUNT_HT_FT,Power (kW),flux lumineux klm,elevation_ft\n"
                               "a,8,50,LED,30,0.1,12,1000\nb,8,50.1,LED,9 m,70 W,4000 lm,\nc,8,50.2,LED,\"25'\",,,\n",
                               false, NULL),
                     NOC_OK);
    const geo_lamp *a = lamp_by_id(&s, "a"), *b = lamp_by_id(&s, "b"), *c = lamp_by_id(&s, "c");
    assert_float_equal(a->height, 9.144, 1e-9);
    assert_float_equal(a->watts, 100, 1e-9);
    assert_float_equal(a->lumens, 12000, 1e-9);
    assert_float_equal(a->xyz[2], 304.8, 1e-9);
    assert_float_equal(b->height, 9, 1e-9); /* a value's own unit goes before the header's */
    assert_float_equal(b->watts, 70, 1e-9);
    assert_float_equal(b->lumens, 4000, 1e-9);
    assert_float_equal(c->height, 7.62, 1e-9);
    expect_column(&s, "MOUNT_HT_FT", "height", "ft", "30");
    lamp_sink_end(&s);
}

/* ---- named by the user ---- */

static char *many_points(size_t count) {
    char *text = noc_alloc(64 * (count + 1)), *at = text + sprintf(text, "fid,longitude,latitude,ward\n");
    for (size_t i = 0; i < count; i++)
        at += sprintf(at, "%zu,%.6f,%.6f,%zu\n", i, -79.4 + 1e-5 * (double)i, 43.65 + 1e-6 * (double)(i % 700), i % 44);
    return text;
}

static void test_named_csv(void **state) {
    char *text = many_points(5000);
    lamp_sink s;
    assert_int_equal(read_with(&s, text, false, NULL), NOC_ERR_FORMAT);
    assert_non_null(strstr(s.error, "5000 points"));
    assert_non_null(strstr(s.error, "--lamps"));
    assert_int_equal(s.lamps.len, 0);
    lamp_sink_end(&s);
    assert_int_equal(read_with(&s, text, true, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 5000);
    assert_int_equal(s.points, 5000);
    assert_string_equal(s.crs, "OGC:CRS84");
    expect_column(&s, "longitude", "lon", "", "-79.400000");
    expect_column(&s, "ward", "", "", "0");
    assert_int_equal(column(&s, "ward")->values, 5000);
    lamp_sink_end(&s);
    free(text);
    static const char power[] = "lat,lon,power,status\n50,8,70,ok\n50,9,100,removed\n50,10,40,\n";
    assert_int_equal(read_with(&s, power, false, NULL), NOC_ERR_FORMAT);
    lamp_sink_end(&s);
    assert_int_equal(read_with(&s, power, true, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 2); /* one is gone */
    assert_float_equal(s.lamps.data[0].watts, 70, 0);
    assert_int_equal(issue_count(&s, "not in use"), 1);
    lamp_sink_end(&s);
}

/* Fields that are not UTF-8 are Windows-1252; what is told of them is UTF-8. */
static void test_windows_1252(void **state) {
    lamp_sink s;
    lamp_sink_start(&s);
    const char *table = "lat,lon,lumens,stra\xdf"
                        "e,\x80,gr\xc3\xbcn\n"
                        "52\xb0 30' N,13.5,3000,Hauptstra\xdf"
                        "e,\x93x\x94\xff,gr\xc3\xbcn\n";
    assert_int_equal(read_lamps_text(&s, table, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    assert_float_equal(s.lamps.data[0].xyz[1], 52.5, 1e-9);
    assert_string_equal(column(&s, "straße")->example, "Hauptstraße");
    assert_string_equal(column(&s, "€")->example, "“x”ÿ");
    assert_string_equal(column(&s, "grün")->example, "grün");
    lamp_sink_end(&s);
}

static void test_looked_at(void **state) { /* by info: no error, and the columns are told */
    lamp_sink s;
    lamp_sink_start(&s);
    s.sink.inspect = true;
    assert_int_equal(read_lamps_text(&s, "lat,lon,power\n50,8,70\n50,9,100\n", NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 0);
    assert_int_equal(s.points, 2);
    assert_int_equal(s.columns.len, 3);
    expect_column(&s, "power", "watts", "W", "70");
    lamp_sink_end(&s);
}

static void test_mapped(void **state) {
    static const char text[] = "A Nr,B,C,D,E,Gr\xc3\xb6\xc3\x9f"
                               "e,height\n1,8,50,30,70,LED,5\n2,8,51,,2 kW,SON,6\n";
    lamp_sink s;
    assert_int_equal(read_with(&s, text, true, NULL), NOC_ERR_FORMAT); /* where are they? it has ... */
    assert_non_null(strstr(s.error, "A Nr, B, C"));
    assert_non_null(strstr(s.error, "--lamp-columns"));
    lamp_sink_end(&s);
    assert_int_equal(read_with(&s, text, true, "lon=B,lat=C,height_ft=D,watt=e,source=grosse,ID=a_nr"), NOC_OK);
    const geo_lamp *one = lamp_by_id(&s, "1"), *two = lamp_by_id(&s, "2");
    assert_float_equal(one->height, 9.144, 1e-9); /* before the column that the words know */
    assert_float_equal(two->height, 6, 0);        /* which stands in where the mapped one is blank */
    assert_float_equal(one->watts, 70, 0);
    assert_float_equal(two->watts, 2000, 0);
    assert_int_equal(two->source, GEO_SOURCE_SODIUM);
    assert_true(column(&s, "D")->mapped && !column(&s, "height")->mapped);
    expect_column(&s, "D", "height", "ft", "30");
    lamp_sink_end(&s);
    /* what is mapped away from its own meaning loses it */
    assert_int_equal(read_with(&s, "lon,lat,lamp_type\n8,50,150\n", false, "watts=LampType"), NOC_OK);
    assert_float_equal(s.lamps.data[0].watts, 150, 0);
    lamp_sink_end(&s);
}

/* A heading's unit holds for a mapped column, too, unless the field names one. */
static void test_mapped_units(void **state) {
    static const struct {
        const char *heading, *map;
        double height;
        int warnings;
    } cases[] = {
        { "Mount Height (ft)", "height=Mount Height (ft)", 9.144, 0 },
        { "POLE (ft)", "height=POLE (ft)", 9.144, 0 },
        { "heightft", "height=HeightFt", 9.144, 0 },
        { "Shaft", "height=Shaft", 30, 0 },
        { "Mast [m]", "height=Mast [m]", 30, 0 },
        { "POLE (ft)", "height_ft=POLE (ft)", 9.144, 0 },
        { "POLE (ft)", "height_m=POLE (ft)", 30, 1 },
        { "Mast [m]", "height_ft=Mast [m]", 9.144, 1 },
        { "Shaft", "height_m=Shaft", 30, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char text[200];
        lamp_sink s;
        snprintf(text, sizeof(text), "Lat,Lon,Lamp Type,%s\n50,8,LED,30\n", cases[i].heading);
        assert_int_equal(read_with(&s, text, false, cases[i].map), NOC_OK);
        if (fabs(s.lamps.data[0].height - cases[i].height) > 1e-9 || s.warnings != cases[i].warnings)
            fail_msg("%s: %g m, %d warnings", cases[i].map, s.lamps.data[0].height, s.warnings);
        if (cases[i].warnings)
            assert_non_null(strstr(s.warning, cases[i].heading));
        lamp_sink_end(&s);
    }
    lamp_sink s;
    assert_int_equal(read_with(&s, "Lat,Lon,Nennwert (kW)\n50,8,0.1\n", true, "watts=Nennwert (kW)"), NOC_OK);
    assert_float_equal(s.lamps.data[0].watts, 100, 1e-9);
    expect_column(&s, "Nennwert (kW)", "watts", "kW", "0.1");
    lamp_sink_end(&s);
}

/* The decimal sign of a file tells what parts thousands in it. */
static void test_thousands(void **state) {
    static const struct {
        const char *text;
        double lumens, height;
        size_t told;
    } cases[] = {
        { "lat;lon;lumens;height\n50,12;8,34;12.000;8,5\n", 12000, 8.5, 0 },
        { "lat;lon;lumens;height\n50,12;8,34;1.234,5;8\n", 1234.5, 8, 0 },
        { "lat;lon;lumens;height\n50,12;8,34;12.5;8,250\n", 12.5, 8.25, 0 },
        { "lat,lon,lumens,height (mm)\n50.12,8.34,\"12,000\",\"8,500\"\n", 12000, 8.5, 0 },
        { "lat,lon,lumens,height (mm)\n50.12,8.34,\"12,000.5\",8500\n", 12000.5, 8.5, 0 },
        /* both signs are decimal ones: no evidence, but told */
        { "lat;lon;lumens;height\n50.12;8.34;12.000;8,5\n", 12, 8.5, 1 },
        { "lat;lon;lumens;height\n50;8;12.000;8\n", 12, 8, 1 },
        { "lat;lon;lumens;height\n50.12;8.34;120;8,500\n", 120, NAN, 0 }, /* 8500 m: no lamp is that high */
        { "lat;lon;lumens;height\n50,12;8,34;120;1.200\n", 120, NAN, 0 },
        { "lat;lon;lumens;height (ft)\n50.12;8.34;120;1.200\n", 120, NAN, 0 }, /* 0.37 m: nor that low */
        { "lat;lon;lumens;height\n50.12;8.34;120;0.5\n", 120, .5, 0 },
        { "lat;lon;lumens;height\n50;8;120;8\n", 120, 8, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        lamp_sink s;
        assert_int_equal(read_with(&s, cases[i].text, false, NULL), NOC_OK);
        const geo_lamp *l = &s.lamps.data[0];
        bool none = isnan(cases[i].height), height = none ? isnan(l->height) : fabs(l->height - cases[i].height) < 1e-9;
        if (fabs(l->lumens - cases[i].lumens) > 1e-9 || !height || issue_count(&s, "height of a lamp") != none ||
            issue_count(&s, "thousands") != cases[i].told)
            fail_msg("case %zu: %g lm, %g m, %zu told", i, l->lumens, l->height, issue_count(&s, "thousands"));
        lamp_sink_end(&s);
    }
    lamp_sink s;
    assert_int_equal(read_with(&s,
                               "lat,lon,lamp_type,status\n50,8,LED,demontiert\n50,9,LED,abgebaut\n50,10,LED,r\xc3\xbc"
                               "ckgebaut\n"
                               "50,11,LED,in Betrieb\n",
                               false, NULL),
                     NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    lamp_sink_end(&s);
}

/* The first identity is the id, the next one is kept beside it. */
static void test_refs(void **state) {
    lamp_sink s;
    assert_int_equal(read_with(&s, "ref,id,lat,lon,lamp_type\n17,object/17,50,8,LED\n,b,50,9,LED\nc,c,50,10,LED\n",
                               false, NULL),
                     NOC_OK);
    assert_string_equal(lamp_by_id(&s, "object/17")->ref, "17");
    assert_string_equal(lamp_by_id(&s, "b")->ref, "");
    assert_string_equal(lamp_by_id(&s, "c")->ref, "");
    lamp_sink_end(&s);
}

static void say(void *user, noc_log_level level, const char *text) { snprintf(user, 400, "%s", text); }

static void test_bad_maps(void **state) {
    static const struct {
        const char *map, *part;
    } bad[] = {
        { "heigth=A", "no field \"heigth\"; the fields are height, lumens, watts" },
        { "height", "not FIELD=COLUMN" },
        { "=A", "not FIELD=COLUMN" },
        { "height=", "not FIELD=COLUMN" },
        { "height=A,", "not FIELD=COLUMN" },
        { "height=A,watts=a", "named twice" },
        { "height_kg=A", "no field" },
        { "height_lm=A", "no field" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        char text[400] = "";
        noc_log *log = noc_log_create(&(noc_log_params){ .message = say, .user = text });
        noc_import_params params = noc_import_default_params();
        params.lamp_columns = (noc_texts){ .text = { bad[i].map }, .count = 1 };
        assert_int_equal(lamp_mapping_check(&params, log), NOC_ERR_ARGUMENT);
        if (!strstr(text, bad[i].part))
            fail_msg("%s: \"%s\"", bad[i].map, text);
        noc_log_destroy(log);
    }
}

/* ---- maps ---- */

#define POINT(props, x, y)                                                                                             \
    "{\"type\":\"Feature\",\"properties\":{" props "},\"geometry\":{\"type\":\"Point\",\"coordinates\":[" x "," y "]}}"
#define COLLECTION(features) "{\"type\":\"FeatureCollection\",\"features\":[" features "]}"

static void expect_lamps(const char *text, bool named, noc_status status, size_t lamps) {
    lamp_sink s;
    noc_status got = read_with(&s, text, named, NULL);
    if (got != status || s.lamps.len != lamps)
        fail_msg("status %d, %zu lamps of %.200s", got, s.lamps.len, text);
    lamp_sink_end(&s);
}

/* A column that is called Typ and no more names the source; it does not make its rows lamps. */
static void test_bare_type(void **state) {
    lamp_sink s;
    assert_int_equal(
        read_with(
            &s, "id,lat,lon,Typ,wattage,masthoehe\na,50,8,LED,50,8\nb,50,9,Quecksilberdampf,80,8\nc,50,10,Kegel,80,8\n",
            false, NULL),
        NOC_OK);
    assert_int_equal(lamp_by_id(&s, "a")->source, GEO_SOURCE_LED);
    assert_int_equal(lamp_by_id(&s, "b")->source, GEO_SOURCE_MERCURY);
    assert_int_equal(lamp_by_id(&s, "c")->source, GEO_SOURCE_UNKNOWN);
    assert_int_equal(lamp_by_id(&s, "c")->type, GEO_LAMP_STREET);
    lamp_sink_end(&s);
    /* what is surely the lamp's first */
    assert_int_equal(read_with(&s, "lat,lon,lamp_type,type\n50,8,HPS,LED\n", false, NULL), NOC_OK);
    assert_int_equal(s.lamps.data[0].source, GEO_SOURCE_SODIUM);
    lamp_sink_end(&s);
    expect_lamps("lat,lon,type\n50,8,LED\n", false, NOC_ERR_FORMAT, 0);
    expect_lamps("lat,lon,wattage\n50,8,70\n", false, NOC_ERR_FORMAT, 0);
    expect_lamps("lat,lon,mast height\n50,8,7\n", false, NOC_ERR_FORMAT, 0);
    expect_lamps("lat,lon,wattage,mast height\n50,8,70,7\n", false, NOC_OK, 1);
}

static void test_kinds_in_values(void **state) {
    static const struct {
        const char *text;
        int word;
    } words[] = {
        { "Lichtmast mit Auslegerleuchte", 2 },
        { "Stra\xc3\x9f"
          "enlaterne",
          2 },
        { "Street Light - LED", 2 },
        { "lampadaire", 2 },
        { "\xe8\xa1\x97\xe7\x81\xaf", 2 },
        { "Wandleuchte", 1 },
        { "Zur Laterne", 1 },
        { "Lantern", 1 },
        { "Laternengasse", 1 },
        { "Leuchtreklame", 0 },
        { "Schaltschrank", 0 },
        { "Traffic light", 0 },
        { "", 0 },
        { NULL, 0 },
    };
    for (size_t i = 0; i < NOC_COUNT(words); i++)
        if (lamp_object_word(words[i].text) != words[i].word)
            fail_msg("%s: %d", words[i].text, lamp_object_word(words[i].text));
    /* most values of a column name street lamps: the rest of its rows are none */
    expect_lamps("lon,lat,bezeichnung\n8,50,Lichtmast mit Auslegerleuchte\n8,51,Lichtmast\n8,52,Schaltschrank\n"
                 "8,53,Wandleuchte\n",
                 false, NOC_OK, 3);
    /* kinds of furniture: the one that is a lamp beyond doubt */
    expect_lamps("lon,lat,Objektart\n8,50,Bank\n8,51,Papierkorb\n8,52,Lichtmast\n8,53,Poller\n", false, NOC_OK, 1);
    /* inns and streets with lanterns in their names, and one lamp shop */
    expect_lamps("lon,lat,name\n8,50,Zur Laterne\n8,51,Laternengasse\n8,52,Leuchten Meier\n", false, NOC_ERR_FORMAT, 0);
    expect_lamps("lon,lat,type,name\n8,50,inn,Zur Laterne\n8,51,shop,Leuchten Meier\n", false, NOC_ERR_FORMAT, 0);
    if (!NOC_HAVE_GDAL)
        return;
    expect_lamps(COLLECTION(POINT("\"a\":1,\"art\":\"Lichtmast mit Auslegerleuchte\"", "8",
                                  "50") "," POINT("\"art\":\"Lichtmast\"", "8", "51")),
                 false, NOC_OK, 2);
    lamp_sink s;
    assert_int_equal(read_with(&s, COLLECTION(POINT("\"text\":\"Lichtmast mit Auslegerleuchte\"", "8", "50")), false,
                               NULL),
                     NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    expect_column(&s, "text", "kind", "", "Lichtmast mit Auslegerleuchte");
    lamp_sink_end(&s);
}

static void test_named_maps(void **state) {
    if (!NOC_HAVE_GDAL)
        skip();
    static const char two[] = COLLECTION(POINT("\"ht\":\"8\",\"n\":1", "8", "50") "," POINT("\"ht\":\"9\"", "8", "51"));
    expect_lamps(two, false, NOC_ERR_FORMAT, 0);
    expect_lamps(two, true, NOC_OK, 2);
    expect_lamps(COLLECTION(POINT("\"highway\":\"stop\"", "8", "50")), true, NOC_OK, 1);
    static const char area[] =
        COLLECTION("{\"type\":\"Feature\",\"properties\":{\"a\":1},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                   "[[[8,50],[8.1,50],[8.1,50.1],[8,50]]]}}");
    expect_lamps(area, false, NOC_OK, 0);
    expect_lamps(area, true, NOC_ERR_FORMAT, 0); /* it holds no points */
    lamp_sink s;
    assert_int_equal(read_with(&s, two, true, "height_ft=HT"), NOC_OK);
    assert_float_equal(s.lamps.data[0].height, 8 * .3048, 1e-9);
    lamp_sink_end(&s);
    /* an extract of OpenStreetMap holds everything: its tags decide, where they tell of lamps at all */
#define OSM(nodes) "<?xml version='1.0'?>\n<osm version=\"0.6\">\n" nodes "</osm>\n"
#define NODE(id, k, v)                                                                                                 \
    "<node id=\"" id "\" lat=\"50.5\" lon=\"8." id "\" version=\"1\"><tag k=\"" k "\" v=\"" v "\"/></node>\n"
    expect_lamps(OSM(NODE("1", "highway", "street_lamp") NODE("2", "shop", "bakery")), true, NOC_OK, 1);
    expect_lamps(OSM(NODE("1", "lamp_ht", "5") NODE("2", "lamp_ht", "6")), true, NOC_OK, 2);
    expect_lamps(OSM(NODE("1", "lamp_ht", "5")), false, NOC_OK, 0);
}

static void test_named_overpass(void **state) {
#define ELEMENT(id, tags) "{\"type\":\"node\",\"id\":" id ",\"lat\":50." id ",\"lon\":8" tags "}"
#define ANSWER(elements) "{\"version\":0.6,\"elements\":[" elements "]}"
    static const char bare[] = ANSWER(ELEMENT("1", "") "," ELEMENT("2", ""));
    expect_lamps(bare, false, NOC_OK, 0);
    expect_lamps(bare, true, NOC_OK, 2); /* "out skel": places alone */
    expect_lamps(ANSWER(ELEMENT("1", ",\"tags\":{\"highway\":\"street_lamp\"}") "," ELEMENT("2", "")), true, NOC_OK, 1);
}

/* Columns that are called as sources are, and hold ids or readings of sensors: no sources, and nothing to guess at.
 * Codes that come again are told, and so is what is not understood beside what is. */
static void test_ids(void **state) {
    static const struct {
        const char *table;
        const char *column, *field; /* NULL: it is no table of lamps */
        size_t unread;
    } rows[] = {
        { "id,lon,lat,Lamp1,wattage\nA,9.5,51.3,L-0012,70\nB,9.501,51.3,L-0013,70\nC,9.502,51.3,L-0014,50\n", "Lamp1",
          "", 0 },
        { "id,lon,lat,lamp\nA,9.5,51.3,1001\nB,9.501,51.3,1002\nC,9.502,51.3,1003\n", "lamp", "", 0 },
        { "id,lon,lat,lamp_id\nA,9.5,51.3,L-1\nB,9.501,51.3,L-2\nC,9.502,51.3,L-3\n", "lamp_id", "id", 0 },
        { "id,lon,lat,lamp,luminaire\nA,9.5,51.3,LED,x-17\nB,9.501,51.3,LED,x-18\nC,9.502,51.3,HPS,x-19\n", "luminaire",
          "", 0 },
        { "station,lon,lat,Lamp1,Lamp2\nA,9.5,51.3,.35,12\nB,9.501,51.3,.4,13\nC,9.502,51.3,.2,14\n", NULL, NULL, 0 },
        { "id,lon,lat,lamp\nA,9.5,51.3,3\nB,9.501,51.3,3\nC,9.502,51.3,4\nD,9.503,51.3,4\n", "lamp", "", 4 },
        { "id,lon,lat,lamp\nA,9.5,51.3,XQ-1\nB,9.501,51.3,XQ-2\nC,9.502,51.3,XQ-3\nD,9.503,51.3,LED\n", "lamp",
          "source", 3 },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char path[] = "/tmp/noc-ids-XXXXXX";
        int fd = mkstemp(path);
        size_t n = strlen(rows[i].table), unread = 0;
        assert_true(fd >= 0 && write(fd, rows[i].table, n) == (ssize_t)n && !close(fd));
        noc_report *report = NULL;
        const noc_import_params params = noc_import_default_params();
        assert_int_equal(noc_inspect(NULL, path, &params, &report), NOC_OK);
        const noc_report_file *file = noc_report_get_file(report, 0);
        assert_int_equal(file->lamps > 0, rows[i].field != NULL);
        for (size_t k = 0; k < file->line_count; k++)
            unread += strstr(file->lines[k].reason, "not understood") ? file->lines[k].count : 0;
        assert_int_equal(unread, rows[i].unread);
        for (size_t k = 0; k < file->column_count && rows[i].field; k++)
            if (!strcmp(file->columns[k].name, rows[i].column))
                assert_string_equal(file->columns[k].field, rows[i].field);
        noc_report_destroy(report);
        unlink(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ids),
        cmocka_unit_test(test_units_of_keys),
        cmocka_unit_test(test_units_in_tables),
        cmocka_unit_test(test_named_csv),
        cmocka_unit_test(test_windows_1252),
        cmocka_unit_test(test_looked_at),
        cmocka_unit_test(test_mapped),
        cmocka_unit_test(test_bad_maps),
        cmocka_unit_test(test_mapped_units),
        cmocka_unit_test(test_refs),
        cmocka_unit_test(test_thousands),
        cmocka_unit_test(test_bare_type),
        cmocka_unit_test(test_kinds_in_values),
        cmocka_unit_test(test_named_maps),
        cmocka_unit_test(test_named_overpass),
    };
    return cmocka_run_group_tests_name("import/lamp_tables", tests, NULL, NULL);
}
