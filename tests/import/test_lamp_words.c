/* What is understood of a lamp's tags and columns: quantities, directions, words, and which of them make a lamp. */
#include "import/lamps/tags.h"

#include "../test.h"

#include <math.h>

static void test_quantities(void **state) {
    static const struct {
        const char *text;
        lamp_unit unit;
        double value;
        int times;
    } good[] = {
        { "5", LAMP_METRES, 5, 1 },          { "5.5 m", LAMP_METRES, 5.5, 1 },
        { "5,5m", LAMP_METRES, 5.5, 1 },     { "16 ft", LAMP_METRES, 4.8768, 1 },
        { "16'", LAMP_METRES, 4.8768, 1 },   { "16'6\"", LAMP_METRES, 5.0292, 1 },
        { "450 cm", LAMP_METRES, 4.5, 1 },   { "~8", LAMP_METRES, 8, 1 },
        { "8;6", LAMP_METRES, 8, 1 },        { "70 W", LAMP_WATTS, 70, 1 },
        { "2x70 W", LAMP_WATTS, 70, 2 },     { "0,25 kW", LAMP_WATTS, 250, 1 },
        { "0,150 kW", LAMP_WATTS, 150, 1 },  { "3,000 K", LAMP_KELVIN, 3000, 1 },
        { "2700K", LAMP_KELVIN, 2700, 1 },   { "12,000 lm", LAMP_LUMENS, 12000, 1 },
        { "4.2 klm", LAMP_LUMENS, 4200, 1 }, { "2 x 1000 lm", LAMP_LUMENS, 1000, 2 },
    };
    static const char *const bad[] = { "", "high", "N/A", "5 apples", "-3", "m", "nan", "1e999", "x5", "--", "''" };
    double v;
    int times;
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        assert_true(lamp_quantity(good[i].text, good[i].unit, 1, 0, &v, &times));
        assert_float_equal(v, good[i].value, 1e-9);
        assert_int_equal(times, good[i].times);
    }
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_false(lamp_quantity(bad[i], LAMP_METRES, 1, 0, &v, &times));
}

static void test_directions(void **state) {
    static const struct {
        const char *text;
        double degrees;
    } good[] = { { "0", 0 },           { "360", 0 },          { "135.5", 135.5 }, { "N", 0 },
                 { "nnw", 337.5 },     { "South-West", 225 }, { "90 deg", 90 },   { "-90", 270 },
                 { "45\xc2\xb0", 45 }, { "45 Grad", 45 },     { "45 (NE)", 45 } };
    static const char *const bad[] = { "",       "both",    "forward", "0-360", "90;270", "400",    "NNNW",
                                       "50 gon", "0.5 rad", "1e2",     "12:30", "2x45",   "45.5.1", "45%" };
    double v;
    for (size_t i = 0; i < NOC_COUNT(good); i++) {
        assert_true(lamp_direction(good[i].text, &v));
        assert_float_equal(v, good[i].degrees, 1e-9);
    }
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_false(lamp_direction(bad[i], &v));
}

static geo_lamp read_one(const char *key, const char *value) {
    geo_lamp lamp = { .xyz = { 1, 2, NAN } };
    lamp_tag tag = { key, value };
    assert_true(lamp_read(NULL, &tag, 1, &lamp, NULL));
    return lamp;
}

static void test_languages(void **state) {
    static const struct {
        const char *text;
        int source;
    } rows[] = {
        { "lampada a ioduri metallici 70 W", GEO_SOURCE_METAL_HALIDE },
        { "monimetalli 70 W", GEO_SOURCE_METAL_HALIDE },
        { "metalhalogen 70W", GEO_SOURCE_METAL_HALIDE },
        { "multivapores met\u00e1licos", GEO_SOURCE_METAL_HALIDE },
        { "Halogen-Metalldampf 150 W", GEO_SOURCE_METAL_HALIDE },
        { "lampa sodowa 150W", GEO_SOURCE_SODIUM },
        { "suurpainenatrium 100 W", GEO_SOURCE_SODIUM },
        { "h\u00f6gtrycksnatrium 70 W", GEO_SOURCE_SODIUM },
        { "l\u00e5gtrycksnatrium 35 W", GEO_SOURCE_LOW_SODIUM },
        { "elohopea 125 W", GEO_SOURCE_MERCURY },
        { "kvicksilver", GEO_SOURCE_MERCURY },
        { "kvikks\u00f8lv 125W", GEO_SOURCE_MERCURY },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++)
        if (read_one("lamp_type", rows[i].text).source != (unsigned)rows[i].source)
            fail_msg("%s: %d", rows[i].text, read_one("lamp_type", rows[i].text).source);
}

static void test_words(void **state) {
    static const struct {
        const char *key, *value;
        int source;
    } sources[] = {
        { "light:method", "LED", GEO_SOURCE_LED },
        { "lamp_type", "high_pressure_sodium", GEO_SOURCE_SODIUM },
        { "LIGHTTYPE_DESC", "HPS-High Pressure Sodium", GEO_SOURCE_SODIUM },
        { "Leuchtmittel", "Natriumdampf-Hochdruck", GEO_SOURCE_SODIUM },
        { "lamp_type", "SON-T", GEO_SOURCE_SODIUM },
        { "light:method", "mercury", GEO_SOURCE_MERCURY },
        { "Lampentyp", "HQL 80", GEO_SOURCE_MERCURY },
        { "lamp_type", "metal-halide", GEO_SOURCE_METAL_HALIDE },
        { "type_lampe", "Iodures m\xc3\xa9talliques", GEO_SOURCE_METAL_HALIDE },
        { "lamp_type", "fluorescent", GEO_SOURCE_FLUORESCENT },
        { "lamp_type", "incandescent", GEO_SOURCE_INCANDESCENT },
        { "lamp_type", "gaslight", GEO_SOURCE_GAS },
        { "lamp_type", "electric", GEO_SOURCE_UNKNOWN },
        { "lampsoort", "hogedruknatrium", GEO_SOURCE_SODIUM },
        { "highway", "led", GEO_SOURCE_UNKNOWN },
    };
    for (size_t i = 0; i < NOC_COUNT(sources); i++)
        assert_int_equal(read_one(sources[i].key, sources[i].value).source, sources[i].source);
    assert_int_equal(read_one("lamp_mount", "bent_mast").mount, GEO_MOUNT_POLE);
    assert_int_equal(read_one("support", "wall_mounted").mount, GEO_MOUNT_WALL);
    assert_int_equal(read_one("lamp_mount", "suspended").mount, GEO_MOUNT_SUSPENDED);
    assert_int_equal(read_one("light_source", "floodlight").type, GEO_LAMP_FLOOD);
    assert_int_equal(read_one("LampType", "Double Acorn").type, GEO_LAMP_LANTERN);
    assert_float_equal(read_one("light:colour", "warm_white").kelvin, 3000, 0);
    assert_float_equal(read_one("light:colour", "2700K").kelvin, 2700, 0);
    assert_float_equal(read_one("lichtkleur", "840").kelvin, 4000, 0);
    assert_true(read_one("light:colour", "blue").rgb[2] > 0);
    assert_true(isnan(read_one("colour", "white").kelvin)); /* of the pole */
    assert_float_equal(read_one("colour", "4000 K").kelvin, 4000, 0);
    assert_float_equal(read_one("Masth\xc3\xb6he", "7,5").height, 7.5, 1e-9);
    assert_float_equal(read_one("Masth\xf6he", "7,5").height, 7.5, 1e-9); /* Latin-1 */
    assert_float_equal(read_one("lightPower", "2x36 W").watts, 36, 0);
    assert_int_equal(read_one("lightPower", "2x36 W").count, 2);
    assert_true(isnan(read_one("power", "pole").watts));
    assert_true(isnan(read_one("height", "4000").height));
    /* codes of Philips, Osram and the LBS, in a column that is called type */
    static const struct {
        const char *codes[12];
        int source;
    } coded[] = {
        { { "PL", "PLL", "PL-L", "PL-T", "PLC", "PL36W", "TL", "TL-D", "TLD", "TL5", "QL", "TC-D" },
          GEO_SOURCE_FLUORESCENT },
        { { "SON", "SON-T", "SON/T", "SON70", "HPS", "NAV", "NAV-T", "HST", "HSE-T", "SONT150" }, GEO_SOURCE_SODIUM },
        { { "CDM", "CDM-T", "CPO", "CPO-TW", "MH", "MH150", "HIT", "HIE", "HQI" }, GEO_SOURCE_METAL_HALIDE },
        { { "HQL", "HPL", "HPL-N", "HME", "HQL80" }, GEO_SOURCE_MERCURY },
        { { "SOX", "SOX-E", "SOX35", "LST" }, GEO_SOURCE_LOW_SODIUM },
        { { "LED", "LED36" }, GEO_SOURCE_LED },
        { { "PLZ", "NAVY", "PL1", "P 36", "HITACHI", "TCP" }, GEO_SOURCE_UNKNOWN },
    };
    for (size_t i = 0; i < NOC_COUNT(coded); i++)
        for (size_t k = 0; k < NOC_COUNT(coded[i].codes) && coded[i].codes[k]; k++)
            if ((int)read_one("lamp_type", coded[i].codes[k]).source != coded[i].source ||
                (int)read_one("type", coded[i].codes[k]).source != coded[i].source)
                fail_msg("%s: %d, %d", coded[i].codes[k], read_one("lamp_type", coded[i].codes[k]).source,
                         read_one("type", coded[i].codes[k]).source);
    static const char *const low[] = { "low pressure sodium", "SOX 55", "LPS (low-pressure sodium)",
                                       "Natriumdampf-Niederdruck" };
    for (size_t i = 0; i < NOC_COUNT(low); i++)
        assert_int_equal(read_one("lamp_type", low[i]).source, GEO_SOURCE_LOW_SODIUM);
}

static void test_verdicts(void **state) {
    static const struct {
        const char *key, *value;
        lamp_verdict verdict;
    } one[] = {
        { "highway", "street_lamp", LAMP_ACTIVE },
        { "man_made", "street_lamp", LAMP_ACTIVE },
        { "light_source", "lantern", LAMP_ACTIVE },
        { "highway", "bus_stop;street_lamp", LAMP_ACTIVE },
        { "highway", "street_lamps", LAMP_NONE },
        { "highway", "", LAMP_NONE },
        { "abandoned:highway", "street_lamp", LAMP_INACTIVE },
        { "highway", "residential", LAMP_NONE },
        { "light_source", "aviation", LAMP_NONE },
    };
    for (size_t i = 0; i < NOC_COUNT(one); i++)
        assert_int_equal(lamp_verdict_of(NULL, &(lamp_tag){ one[i].key, one[i].value }, 1, false), one[i].verdict);
    static const struct {
        const char *key, *value;
        lamp_verdict verdict;
    } row[] = {
        { "ASSETSTATUS_DESC", "Active", LAMP_ACTIVE },
        { "ASSETSTATUS_DESC", "Inactive", LAMP_INACTIVE },
        { "Status",
          "au\xc3\x9f"
          "er Betrieb",
          LAMP_INACTIVE },
        { "Zustand", "demontiert", LAMP_INACTIVE },
        { "Zustand", "gut", LAMP_ACTIVE },
        { "Betriebsstatus", "in Betrieb", LAMP_ACTIVE },
        { "Betriebsstatus", "nicht in Betrieb", LAMP_INACTIVE },
        { "Zustand",
          "zur\xc3\xbc"
          "ckgebaut",
          LAMP_INACTIVE },
        { "statut",
          "D\xc3\xa9pos\xc3\xa9"
          "e",
          LAMP_INACTIVE },
        { "Situaci\xc3\xb3n", "Desmontada", LAMP_INACTIVE },
        { "stato", "Rimosso", LAMP_INACTIVE },
        { "Situa\xc3\xa7\xc3\xa3o", "Desativado", LAMP_INACTIVE },
        { "stav",
          "Zru\xc5\xa1"
          "eno",
          LAMP_INACTIVE },
        { "Stan", "usuni\xc4\x99ty", LAMP_INACTIVE },
        { "Driftstatus", "Nedlagt", LAMP_INACTIVE },
        { "Tila", "Poistettu", LAMP_INACTIVE },
        { "toestand", "niet in gebruik", LAMP_INACTIVE },
        { "WHYINACTIVE", "N/A", LAMP_ACTIVE },
        { "WHYINACTIVE", "Knocked down", LAMP_INACTIVE },
        { "INOPERATION", "6/3/2013 0:00:00", LAMP_ACTIVE },
        { "INOPERATION", "NO", LAMP_INACTIVE },
        { "disused", "yes", LAMP_INACTIVE },
    };
    for (size_t i = 0; i < NOC_COUNT(row); i++)
        assert_int_equal(lamp_verdict_of(NULL, &(lamp_tag){ row[i].key, row[i].value }, 1, true), row[i].verdict);
    static const char *const inventory[] = { "OBJECTID", "LampType" },
                             *const masts[] = { "STRAAT", "MASTNUMMER", "MASTLENGTE" },
                             *const trees[] = { "id", "height", "species", "status", "support" };
    assert_true(lamp_columns_tell(NULL, inventory, 2));
    assert_true(lamp_columns_tell(NULL, masts, 3));
    assert_false(lamp_columns_tell(NULL, trees, 5));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quantities), cmocka_unit_test(test_directions), cmocka_unit_test(test_languages),
        cmocka_unit_test(test_words),      cmocka_unit_test(test_verdicts),
    };
    return cmocka_run_group_tests_name("import/lamp_words", tests, NULL, NULL);
}
