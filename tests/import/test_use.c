/* What buildings are for, by codes and words. Expected uses are read off the lists that docs/windows.md names: ALKIS
 * object catalogue, CityGML 2.0 annex C, PLATEAU's codelists, INSPIRE, OpenStreetMap, BAG. */
#include "city_sink.h"

#include "import/use.h"

static city_sink sink;

static int finish(void **state) {
    city_clear(&sink);
    sink.reader = NULL;
    return 0;
}

static void test_codes(void **state) {
    static const struct {
        const char *key, *value;
        noc_building_use use;
    } rows[] = {
        { "function", "31001_1010", NOC_USE_FLATS },   /* Wohnhaus */
        { "function", "31001_1121", NOC_USE_MIXED },   /* Wohngebaeude mit Handel */
        { "function", "31001_2020", NOC_USE_OFFICES }, /* Buerogebaeude */
        { "function", "31001_2051", NOC_USE_SHOPS },   /* Kaufhaus */
        { "function", "31001_2112", NOC_USE_DARK },    /* Betriebsgebaeude */
        { "function", "31001_2463", NOC_USE_BARE },    /* Garage */
        { "function", "31001_2723", NOC_USE_BARE },    /* Schuppen */
        { "function", "31001_3021", NOC_USE_OFFICES }, /* Schule */
        { "function", "31001_3041", NOC_USE_DARK },    /* Kirche */
        { "function", "31001_9998", NOC_USE_UNKNOWN },
        { "function", "51009_1610", NOC_USE_BARE }, /* Ueberdachung */
        { "function", "1000", NOC_USE_FLATS },
        { "function", "1080", NOC_USE_MIXED },   /* residential and commercial */
        { "function", "1120", NOC_USE_OFFICES }, /* office building */
        { "function", "1160", NOC_USE_SHOPS },   /* department store */
        { "function", "1179", NOC_USE_UNKNOWN }, /* not in the list */
        { "function", "1320", NOC_USE_DARK },    /* factory */
        { "usage", "1630", NOC_USE_BARE },       /* garage */
        { "usage", "2220", NOC_USE_DARK },       /* church */
        { "function", "2310", NOC_USE_OFFICES }, /* hospital */
        { "class", "1030", NOC_USE_SHOPS },      /* business, trade: as a function residential and administration */
        { "class", "1080", NOC_USE_DARK },       /* church institution: as a function residential and commercial */
        { "class", "3001", NOC_USE_UNKNOWN },    /* PLATEAU: an ordinary building */
        { "class", "3003", NOC_USE_BARE },       /* one without walls */
        { "usage", "401", NOC_USE_OFFICES },
        { "usage", "411", NOC_USE_FLATS },
        { "usage", "414", NOC_USE_MIXED },
        { "usage", "441", NOC_USE_DARK },
        { "usage", "461", NOC_USE_UNKNOWN },
        { "building", "apartments", NOC_USE_FLATS },
        { "building", "Semidetached_House", NOC_USE_FLATS },
        { "building", "supermarket", NOC_USE_SHOPS },
        { "building", "church", NOC_USE_DARK },
        { "building", "garages", NOC_USE_BARE },
        { "building", "yes", NOC_USE_UNKNOWN },
        { "building", "", NOC_USE_UNKNOWN },
        { "building", " ", NOC_USE_UNKNOWN },
        { "building", "house apartments", NOC_USE_UNKNOWN },
        { "usage", "http://inspire.ec.europa.eu/codelist/CurrentUseValue/office", NOC_USE_OFFICES },
        { "usage", "individualResidence", NOC_USE_FLATS },
        { "usage", "ancillary", NOC_USE_BARE },
        { "gebruiksdoel", "winkelfunctie", NOC_USE_SHOPS },
        { "function", "Freistehender Wohnblock", NOC_USE_FLATS },
        { "function", "B\xc3\xbcrogeb\xc3\xa4ude", NOC_USE_OFFICES },
        { "function", "Stall", NOC_USE_BARE },
        { "function", "Installation", NOC_USE_UNKNOWN },
        { "function", "99999999999999999999999999", NOC_USE_UNKNOWN },
        { "function", "_", NOC_USE_UNKNOWN },
        { "function", "/", NOC_USE_UNKNOWN },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_building_use use = building_use_told(rows[i].key, rows[i].value);
        if (use != rows[i].use)
            fail_msg("%s \"%s\": %s", rows[i].key, rows[i].value, noc_building_use_name(use));
    }
    char text[4000];
    memset(text, 'x', sizeof(text));
    text[sizeof(text) - 1] = 0;
    assert_int_equal(building_use_told("usage", text), NOC_USE_UNKNOWN);
}

#define SQUARE                                                                                                         \
    "<b:lod1MultiSurface><g:MultiSurface><g:surfaceMember><g:Polygon><g:exterior><g:LinearRing>"                       \
    "<g:posList>0 0 0 1 0 0 1 1 0 0 0 0</g:posList></g:LinearRing></g:exterior></g:Polygon></g:surfaceMember>"         \
    "</g:MultiSurface></b:lod1MultiSurface>"
#define MODEL(inside)                                                                                                  \
    "<CityModel xmlns='http://www.opengis.net/citygml/2.0' xmlns:b='http://www.opengis.net/citygml/building/2.0' "     \
    "xmlns:g='http://www.opengis.net/gml'><cityObjectMember><b:Building>" inside                                       \
    "</b:Building></cityObjectMember></CityModel>"
#define PART(inside) "<b:consistsOfBuildingPart><b:BuildingPart>" inside "</b:BuildingPart></b:consistsOfBuildingPart>"

/* The building before its parts, functions before usages before classes; what says nothing hides nothing. */
static void test_citygml(void **state) {
    static const struct {
        const char *text;
        noc_building_use use;
    } rows[] = {
        { MODEL(SQUARE), NOC_USE_UNKNOWN },
        { MODEL("<b:class>1080</b:class>" SQUARE), NOC_USE_DARK },
        { MODEL("<b:class>1080</b:class><b:function>1000</b:function><b:usage>1120</b:usage>" SQUARE), NOC_USE_FLATS },
        { MODEL("<b:class>1000</b:class><b:usage>1120</b:usage>" SQUARE), NOC_USE_OFFICES },
        { MODEL("<b:function>31001_9998</b:function><b:usage>1120</b:usage>" SQUARE), NOC_USE_OFFICES },
        { MODEL("<g:name>garage</g:name>" SQUARE), NOC_USE_UNKNOWN },
        { MODEL(PART("<b:function>1630</b:function>" SQUARE)), NOC_USE_BARE },
        { MODEL("<b:class>1000</b:class>" PART("<b:function>1630</b:function>" SQUARE)), NOC_USE_FLATS },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        assert_int_equal(city_read_bytes(&sink, rows[i].text, strlen(rows[i].text), 3), NOC_OK);
        assert_int_equal(sink.objects.len, 1);
        if (sink.objects.data[0].use != rows[i].use)
            fail_msg("%zu: %s", i, noc_building_use_name(sink.objects.data[0].use));
    }
}

static void test_cityjson(void **state) {
    static const char text[] =
        "{\"type\":\"CityJSON\",\"version\":\"1.1\",\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},"
        "\"CityObjects\":{\"a\":{\"type\":\"Building\",\"attributes\":{\"class\":\"1080\",\"function\":[\"1160\"]},"
        "\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"2\",\"boundaries\":[[[0,1,2]]]}]}},"
        "\"vertices\":[[0,0,0],[1,0,0],[1,1,0]]}";
    sink.reader = &noc_reader_cityjson;
    assert_int_equal(city_read_bytes(&sink, text, strlen(text), 3), NOC_OK);
    assert_int_equal(sink.objects.len, 1);
    assert_int_equal(sink.objects.data[0].use, NOC_USE_SHOPS);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_codes), cmocka_unit_test_teardown(test_citygml, finish),
                                        cmocka_unit_test_teardown(test_cityjson, finish) };
    return cmocka_run_group_tests_name("import/use", tests, NULL, NULL);
}
