/* Values of several numbers: what is plain is computed, what is not is taken by a stated choice and counted, and what
 * makes no sense is counted and not taken. */
#include "import/lamps/tags.h"

#include "../test.h"

#include <math.h>

/* Reads tags of a lamp; *counted: the first reason that was, "" for none. */
static geo_lamp read_counted(const lamp_tag *tags, size_t count, char counted[200]) {
    geo_issues *issues = geo_issues_create();
    geo_lamp lamp = { .xyz = { 1, 2, NAN } };
    assert_true(lamp_read(NULL, tags, count, &lamp, issues));
    *counted = 0;
    for (size_t i = 0; i < geo_issues_count(issues) && !*counted; i++) {
        const char *reason, *examples;
        bool repaired;
        size_t n;
        assert_true(geo_issues_get(issues, i, &reason, &repaired, &n, &examples));
        snprintf(counted, 200, "%s", reason);
    }
    geo_issues_destroy(issues);
    return lamp;
}

typedef struct row {
    const char *text;
    double value; /* 0: none */
    int heads;
    const char *counted; /* a part of the reason; "": nothing is */
} row;

static void check(const char *key, const row *rows, size_t count, double (*of)(const geo_lamp *lamp)) {
    for (size_t i = 0; i < count; i++) {
        char counted[200];
        const geo_lamp lamp = read_counted(&(lamp_tag){ .key = key, .value = rows[i].text }, 1, counted);
        double value = of(&lamp), wanted = rows[i].value > 0 ? rows[i].value : NAN;
        bool same = isnan(wanted) ? isnan(value) : fabs(value - wanted) < 1e-6;
        bool told = *rows[i].counted ? strstr(counted, rows[i].counted) != NULL : !*counted;
        if (!same || lamp.count != rows[i].heads || !told)
            fail_msg("%s=%s: %g, %d heads, \"%s\"", key, rows[i].text, value, lamp.count, counted);
    }
}

static double watts_of(const geo_lamp *lamp) { return lamp->watts; }
static double height_of(const geo_lamp *lamp) { return lamp->height; }
static double lumens_of(const geo_lamp *lamp) { return lamp->lumens; }
static double kelvin_of(const geo_lamp *lamp) { return lamp->kelvin > 0 ? lamp->kelvin : NAN; }
static double count_of(const geo_lamp *lamp) { return lamp->count ? lamp->count : NAN; }

static void test_watts(void **state) {
    static const row rows[] = {
        { "2x70W", 70, 2, "" },
        { "2@150", 150, 2, "" },
        { "100W x 2", 100, 2, "" },
        { "100 x 2", 100, 2, "" },
        { "2x LED 36W", 36, 2, "" },
        { "50 x LED 1W", 50, 0, "" },
        { "50 x 2W", 100, 0, "" },
        { "70 W + 18 W", 88, 0, "" },
        { "70+18", 88, 0, "" },
        { "150W & 70W", 220, 0, "" },
        { "2x70W + 1x100W", 240, 0, "" },
        { "HPS 70 W + 18 W", 88, 0, "" },
        { "PL-L 36/830", 36, 0, "" },
        { "70 W 230 V 50 Hz", 70, 0, "" },
        { "70 W (2015)", 70, 0, "" },
        { "0,1 kW", 100, 0, "" },
        { "70/100", 70, 0, "first taken" },
        { "70;100", 70, 0, "first taken" },
        { "70 or 100 W", 70, 0, "first taken" },
        { "70 100", 70, 0, "first taken" },
        { "70 W, 100 W", 70, 0, "first taken" },
        { "HPS 70/100W", 70, 0, "first taken" },
        { "0.1/0.15 kW", 100, 0, "first taken" },
        { "100-150", 125, 0, "middle taken" },
        { "100 to 150 W", 125, 0, "middle taken" },
        { "HPS 100\xe2\x80\x93"
          "150 W",
          125, 0, "middle taken" },
        { "2 - 150", 150, 2, "taken as lamps" },
        { "LED -40W", 0, 0, "wattage not understood" },
        { "-40", 0, 0, "wattage not understood" },
        { "<100", 0, 0, "wattage not understood" },
        { "1000.5.2", 0, 0, "wattage not understood" },
        { "2019-05-01", 0, 0, "wattage not understood" },
        { "120/240V", 0, 0, "wattage not understood" },
        { "2x2x36 W", 0, 0, "wattage not understood" },
        { "0", 0, 0, "wattage of 0" },
        { "60%", 0, 0, "wattage not understood" },
        { "70W 50%", 70, 0, "first taken" },
        { "(2) 70W", 70, 2, "" },
        { "2 pcs 70W", 70, 2, "" },
        { "24 LED x 3W", 72, 0, "" },
        { "70\xc2\xa0W", 70, 0, "" },
        { "48 LED 350mA", 0, 0, "wattage not understood" },
        { "64 LEDs 500mA 107W", 107, 0, "" },
        { "70 LED", 70, 0, "" },
        { "LED 70 W dimmed to 50 %", 70, 0, "dimming or share of a lamp not taken" },
    };
    (void)state;
    check("lamp_wattage", rows, NOC_COUNT(rows), watts_of);
}

/* Of descriptions: diodes are no watts, and a lamp that is dimmed is at its full flux, which is told. */
static void test_dimmed_and_diodes(void **state) {
    static const char diodes[] = "without watts: flux not understood",
                      dimmed[] = "dimming or share of a lamp not taken";
    static const row rows[] = {
        { "48 LED 350mA", 0, 0, diodes },
        { "48 LED, 350 mA", 0, 0, diodes },
        { "LED 24 x 350 mA", 0, 0, diodes },
        { "LED 48 chips", 0, 0, diodes },
        { "64 LEDs", 0, 0, diodes },
        { "64 LEDs 500mA 107W", 107, 0, "" },
        { "48 LED", 48, 0, "number beside LED without a unit, taken as watts" },
        { "LED 24", 24, 0, "number beside LED without a unit, taken as watts" },
        { "LED 24 W", 24, 0, "" },
        { "HPS 250W dimmed 50%", 250, 0, dimmed },
        { "LED 70W dim to 30 %", 70, 0, dimmed },
        { "LED 70W gedimmt", 70, 0, dimmed },
        { "LED 60W 50% at night", 60, 0, dimmed },
        { "LED dimmed 40%", 0, 0, dimmed },
        { "LED 60W dimmable", 60, 0, "" },
        { "HPS 250W 230V 3A", 250, 0, "" },
    };
    (void)state;
    check("lamp_type", rows, NOC_COUNT(rows), watts_of);
}

static void test_heights(void **state) {
    static const row rows[] = {
        { "8 m (26 ft)", 8, 0, "" },
        { "16 ft 6 in", 5.0292, 0, "" },
        { "6 m LED 40 W", 6, 0, "" },
        { "6 m + 1.5 m", 7.5, 0, "" },
        { "6m/8m", 6, 0, "first taken" },
        { "6;8", 6, 0, "first taken" },
        { "8 m (20 ft)", 8, 0, "first taken" },
        { "5m50", 5, 0, "first taken" },
        { "6-8", 7, 0, "middle taken" },
        { "6 bis 8 m", 7, 0, "middle taken" },
        { "30 - 40 ft", 10.668, 0, "middle taken" },
        { "8-6", 8, 0, "first taken" },
        { "6.5.2", 0, 0, "not understood" },
        { "0", 0, 0, "height of a lamp of 0" },
        { "20\xc2\xa0"
          "ft",
          6.096, 0, "" },
        { "20\xe2\x80\xaf"
          "ft",
          6.096, 0, "" },
        { "20\xe2\x80\xb2", 6.096, 0, "" },
        { "20\xe2\x80\x99", 6.096, 0, "" },
        { "20\xc2\xb4", 6.096, 0, "" },
        { "16\xe2\x80\xb2 6\xe2\x80\xb3", 5.0292, 0, "" },
        { "16'6''", 5.0292, 0, "" },
        { "8 m/W", 0, 0, "not understood" },
    };
    (void)state;
    check("lamp_height", rows, NOC_COUNT(rows), height_of);
}

static void test_light(void **state) {
    static const row kelvin[] = {
        { "3000 K", 3000, 0, "" },
        { "830", 3000, 0, "" },
        { "3000/4000", 3000, 0, "first taken" },
        { "830/840", 3000, 0, "first taken" },
        { "2700-3000K", 2850, 0, "middle taken" },
        { "3000.5.1", 0, 0, "colour temperature not understood" },
        { "0", 0, 0, "colour temperature of 0" },
        { "3000+4000", 3000, 0, "first taken" },
    };
    static const row lumens[] = {
        { "2 x 1000 lm", 1000, 2, "" },      { "4,000 + 500", 4500, 0, "" },
        { "3000/4000", 3000, 0, "first" },   { "3000-4000 lm", 3500, 0, "middle taken" },
        { "0", 0, 0, "luminous flux of 0" }, { "4000 lm equivalent", 0, 0, "luminous flux not understood" },
        { "110 lm/W", 0, 0, "not" },         { "110 lm per W", 0, 0, "not" },
        { "4000 lm/40 W", 4000, 0, "" },     { "60%", 0, 0, "not" },
    };
    static const row counts[] = {
        { "2", 2, 2, "" },      { "1+1", 2, 2, "" },       { "1-2", 0, 0, "number of lamps on a pole not" },
        { "1;1", 0, 0, "not" }, { "1 or 2", 0, 0, "not" }, { "0", 0, 0, "number of lamps on a pole of 0" },
        { "1.5", 0, 0, "not" },
    };
    (void)state;
    check("cct", kelvin, NOC_COUNT(kelvin), kelvin_of);
    check("lumens", lumens, NOC_COUNT(lumens), lumens_of);
    check("lamp_count", counts, NOC_COUNT(counts), count_of);
}

/* Of so many lamps as a sum has terms, each has its share. */
static void test_shares(void **state) {
    const lamp_tag tags[] = { { .key = "lamp_count", .value = "2" }, { .key = "wattage", .value = "150W & 70W" } };
    char counted[200];
    (void)state;
    const geo_lamp lamp = read_counted(tags, 2, counted);
    assert_int_equal(lamp.count, 2);
    assert_float_equal(lamp.watts, 110, 1e-9);
    assert_string_equal(counted, "");
}

/* In descriptions, whose flux and colour are read, too. */
static void test_descriptions(void **state) {
    static const struct {
        const char *text;
        double watts, lumens, kelvin;
        lamp_choice choice;
    } rows[] = {
        { "HPS 150W & 70W", 220, 0, 0, LAMP_ONE },
        { "LED 40W 3000/4000K", 40, 0, 3000, LAMP_ONE },
        { "LED 70/100W 3000-5000 lm", 70, 4000, 0, LAMP_FIRST },
        { "HPS 70W SON 100W", 70, 0, 0, LAMP_FIRST },
        { "NAV-T -70", 0, 0, 0, LAMP_ONE },
        { "NAV-T70", 70, 0, 0, LAMP_ONE },
        { "NAV-T 70-4Y", 70, 0, 0, LAMP_ONE },
        { "HQL 2x125", 125, 0, 0, LAMP_ONE },
        { "LED 70W 110 lm/W", 70, 0, 0, LAMP_ONE },
        { "LED 110lm/W 70W", 70, 0, 0, LAMP_ONE },
        { "LED 60%", 0, 0, 0, LAMP_ONE },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        const lamp_model m = lamp_model_of(rows[i].text, false, 0);
        double watts = isfinite(m.watts) ? m.watts : 0, lumens = isfinite(m.lumens) ? m.lumens : 0;
        double kelvin = isfinite(m.kelvin) ? m.kelvin : 0;
        if (watts != rows[i].watts || lumens != rows[i].lumens || kelvin != rows[i].kelvin ||
            m.choice != rows[i].choice)
            fail_msg("%s: %g W, %g lm, %g K, choice %d", rows[i].text, watts, lumens, kelvin, (int)m.choice);
    }
}

/* How many heads a description tells beside its watts. */
static void test_heads(void **state) {
    static const struct {
        const char *text;
        int heads;
    } rows[] = {
        { "(2) 70W HPS", 2 }, { "2 pcs 70W HPS", 2 },  { "70W HPS x 2", 2 },
        { "HPS 70W x2", 2 },  { "70W HPS x 2.5", 0 },  { "HPS 70W (2)", 0 },
        { "70W HPS", 0 },     { "(2019) 70W HPS", 0 }, { "70W HPS x 2m", 0 },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        const lamp_model m = lamp_model_of(rows[i].text, false, 0);
        if (m.heads != rows[i].heads || m.watts != 70)
            fail_msg("%s: %d heads, %g W", rows[i].text, m.heads, m.watts);
    }
}

/* One source, or none that is understood, which is counted where the flux hangs on it. */
static void test_sources(void **state) {
    static const struct {
        const char *key, *text;
        int source;
        double watts;        /* 0: none */
        const char *counted; /* as in row */
    } rows[] = {
        { "lamp_type", "LED ersetzt HQL 125W", GEO_SOURCE_LED, 0, "" },
        { "light:lamp_type", "HPS 250W AERO", GEO_SOURCE_SODIUM, 250, "" },
        { "lamp_type", "HQL 125W ersetzt durch LED 40W", GEO_SOURCE_LED, 40, "" },
        { "lamp_type", "HPS 70W replaced by LED 30W", GEO_SOURCE_LED, 30, "" },
        { "lamp_type", "LED 30W replaces HPS 70W", GEO_SOURCE_LED, 30, "" },
        { "lamp_type", "HPS to be replaced by LED", GEO_SOURCE_SODIUM, 0, "" },
        { "lamp_type", "LED 30W (ex NAV 70)", GEO_SOURCE_LED, 30, "" },
        { "lamp_type", "was HPS 70W, now LED 30W", GEO_SOURCE_LED, 30, "" },
        { "lamp_type", "HPS -> LED 40W", GEO_SOURCE_LED, 40, "" },
        { "lamp_type", "LED 40W (250W equivalent)", GEO_SOURCE_LED, 40, "" },
        { "lamp_type", "Ex-Leuchte LED", GEO_SOURCE_LED, 0, "" },
        { "lamp_type", "mercury fluorescent 125W", GEO_SOURCE_MERCURY, 125, "" },
        { "lamp_type", "Halogen-Metalldampf 70W (HQI)", GEO_SOURCE_METAL_HALIDE, 70, "" },
        { "lamp_type", "LPS (low-pressure sodium)", GEO_SOURCE_LOW_SODIUM, 0, "" },
        { "lamp_type", "LED lamp no 5", GEO_SOURCE_LED, 0, "" },
        { "lamp_type", "Not LED", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "kein LED 40W", GEO_SOURCE_UNKNOWN, 40, "source of a lamp not" },
        { "lamp_type", "LED: no", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "ex NAV", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "HQL 125W ersetzt", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "LED/HPS", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "HPS/LPS 70W", GEO_SOURCE_UNKNOWN, 70, "source of a lamp not" },
        { "lamp_type", "LED geplant", GEO_SOURCE_UNKNOWN, 0, "source of a lamp not" },
        { "lamp_type", "BF 125W", GEO_SOURCE_UNKNOWN, 125, "source of a lamp not" },
        { "lamp_type", "IM 150W", GEO_SOURCE_UNKNOWN, 150, "source of a lamp not" },
        { "type", "BF 125W", GEO_SOURCE_UNKNOWN, 125, "source of a lamp not" },
        { "wattage", "BF 125W", GEO_SOURCE_UNKNOWN, 125, "source of a lamp not" },
        { "what", "BF 125W", GEO_SOURCE_UNKNOWN, 125, "source of a lamp not" },
        { "wattage", "125 W per lamp", GEO_SOURCE_UNKNOWN, 125, "" },
        { "wattage", "250 watts equivalent", GEO_SOURCE_UNKNOWN, 0, "wattage not understood" },
        { "wattage", "40W (250W equivalent)", GEO_SOURCE_UNKNOWN, 40, "" },
        { "wattage", "HPS 150W ersetzt durch 40W LED", GEO_SOURCE_LED, 40, "" },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char counted[200];
        const geo_lamp lamp = read_counted(&(lamp_tag){ .key = rows[i].key, .value = rows[i].text }, 1, counted);
        double watts = isfinite(lamp.watts) ? lamp.watts : 0;
        bool told = *rows[i].counted ? strstr(counted, rows[i].counted) != NULL : !*counted;
        if ((int)lamp.source != rows[i].source || watts != rows[i].watts || !told)
            fail_msg("%s=%s: source %d, %g W, \"%s\"", rows[i].key, rows[i].text, lamp.source, watts, counted);
    }
    const lamp_tag tags[] = { { .key = "lamp_type", .value = "BF 125W" }, { .key = "lumens", .value = "4500" } };
    char counted[200];
    read_counted(tags, 2, counted);
    assert_string_equal(counted, ""); /* its flux is told */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_watts),   cmocka_unit_test(test_dimmed_and_diodes),
        cmocka_unit_test(test_heights), cmocka_unit_test(test_light),
        cmocka_unit_test(test_shares),  cmocka_unit_test(test_descriptions),
        cmocka_unit_test(test_sources), cmocka_unit_test(test_heads),
    };
    return cmocka_run_group_tests_name("import/lamp_numbers", tests, NULL, NULL);
}
