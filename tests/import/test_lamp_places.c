/* Places in tables: degrees as people write them, tables in UTF-16, tables without a header, and columns that places
 * could not be read from. */
#include "lamp_sink.h"

#include "import/lamps/tags.h"
#include "import/lamps/utf16.h"
#include <nocturne/nocturne.h>

static char folder[] = "/tmp/noc-lamp-places-XXXXXX";
#include "../folder.h"

static void test_coordinates(void **state) {
    static const struct {
        const char *text;
        double value;
    } good[] = {
        { "45\xc2\xb0"
          "8'41.3\"N",
          45.144805556 },
        { "7\xc2\xb0"
          "26'20.5\"E",
          7.439027778 },
        { "7\xb0 26' 20,5\" W", -7.439027778 }, /* Latin-1, decimal comma */
        { "N 45\xc2\xb0 8\xe2\x80\xb2 41.3\xe2\x80\xb3", 45.144805556 },
        { "45\xc2\xba 8\xe2\x80\x99 41.3\xe2\x80\x9d S", -45.144805556 },
        { "-45:08:41.3", -45.144805556 },
        { "45 8 41.3 N", 45.144805556 },
        { "45d08m41.3s", 45.144805556 },
        { "45 deg 8 min 41.3 sec", 45.144805556 },
        { "45\xc2\xb0"
          "8'41.3''n",
          45.144805556 },
        { "7\xc2\xb0"
          "26.3417'E",
          7.439028333 },
        { "7\xc2\xb0"
          "26'",
          7.433333333 },
        { "52.5\xc2\xb0", 52.5 },
        { "52.5\xb0 S", -52.5 },
        { "W13.4", -13.4 },
        { "13,4", 13.4 },
        { "-94.49075022", -94.49075022 },
        { "+7", 7 },
        { "1.5e2", 150 },
        { "5404000.25", 5404000.25 },
    };
    static const char *const bad[] = { "",
                                       "x",
                                       "45\xc2\xb0"
                                       "61'0\"N",
                                       "N",
                                       "45 8 61",
                                       "500000 4649776",
                                       "45N8",
                                       "45.5 8 41.3",
                                       "12 Main",
                                       NULL };
    double v;
    for (size_t i = 0; i < NOC_COUNT(good); i++)
        if (!lamp_coordinate(good[i].text, &v) || fabs(v - good[i].value) > 1e-8)
            fail_msg("%s: %.9f", good[i].text, v);
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        if (lamp_coordinate(bad[i], &v))
            fail_msg("%s is %g", bad[i], v);
    static const char *const pairs[] = { "45\xc2\xb0"
                                         "8'41.3\"N, 7\xc2\xb0"
                                         "26'20.5\"E",
                                         "7\xc2\xb0"
                                         "26'20.5\"E 45\xc2\xb0"
                                         "8'41.3\"N",
                                         "(N45.144805556; E7.439027778)" };
    for (size_t i = 0; i < NOC_COUNT(pairs); i++) {
        double lat, lon;
        assert_true(lamp_coordinates(pairs[i], &lat, &lon));
        assert_float_equal(lat, 45.144805556, 1e-8);
        assert_float_equal(lon, 7.439027778, 1e-8);
    }
    double lat, lon;
    assert_false(lamp_coordinates("45.1, 7.4", &lat, &lon)); /* as two numbers are read */
}

static void test_dms(void **state) {
    REQUIRE_SHARED(path, "data/cases3/dms.csv");
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps(&s, path, NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 6);
    for (size_t i = 0; i < s.lamps.len; i++) {
        assert_float_equal(s.lamps.data[i].xyz[0], 7 + 26 / 60. + 20.5 / 3600, 1e-9);
        assert_float_equal(s.lamps.data[i].xyz[1], 45 + 8 / 60. + (41.3 + .9 * (double)i) / 3600, 1e-9);
    }
    lamp_sink_end(&s);
}

/* Text of ASCII, and of characters that UTF-8 has as two bytes, in two bytes a character. */
static const char *write_wide(const char *text, bool big, bool mark) {
    const char *path = in_folder("wide.csv");
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    unsigned first = 0xfeff;
    for (const unsigned char *p = (const unsigned char *)text - mark; mark || *p; mark = false) {
        unsigned c = mark ? first : *p;
        if (!mark && c >= 0xc2) {
            c = (c & 31) << 6 | (p[1] & 63);
            p++;
        }
        p++;
        fputc((int)(big ? c >> 8 : c & 255), f);
        fputc((int)(big ? c & 255 : c >> 8), f);
    }
    assert_int_equal(fclose(f), 0);
    return path;
}

static void test_utf16(void **state) {
    char *text = noc_alloc(2000000), *at = text; /* more than one piece */
    at += sprintf(at, "id\tlon\tlat\tlamp_type\tMasth\xc3\xb6he\n");
    enum { COUNT = 20000 };
    for (int i = 0; i < COUNT; i++)
        at += sprintf(at, "L\xc3\xb6%d\t9.5\t%.5f\tLED\t8,5\n", i, 51 + 1e-5 * i);
    for (int big = 0; big < 2; big++)
        for (int mark = 0; mark < 2; mark++) {
            lamp_sink s;
            lamp_sink_start(&s);
            assert_int_equal(read_lamps(&s, write_wide(text, big, mark), NULL), NOC_OK);
            assert_int_equal(s.lamps.len, COUNT);
            assert_string_equal(s.lamps.data[COUNT - 1].id, "L\xc3\xb6"
                                                            "19999");
            assert_float_equal(s.lamps.data[COUNT - 1].xyz[1], 51 + 1e-5 * (COUNT - 1), 1e-9);
            assert_float_equal(s.lamps.data[7].height, 8.5, 1e-9);
            lamp_sink_end(&s);
        }
    free(text);
}

/* Pieces may end within a character; halves of pairs that are alone are none. */
static void test_utf16_pieces(void **state) {
    static const char in[] = "a\0\x3d\xd8\xa1\xdc\x3d\xd8z\0\xa1\xdc\xac\x20";
    static const char want[] = "a\xf0\x9f\x92\xa1\xef\xbf\xbdz\xef\xbf\xbd\xe2\x82\xac";
    for (size_t piece = 1; piece < sizeof(in); piece++) {
        char out[100];
        size_t n = 0;
        utf16 u = { .order = UTF16_LITTLE };
        for (size_t i = 0; i < sizeof(in) - 1; i += piece)
            n += utf16_decode(&u, in + i, NOC_MIN(piece, sizeof(in) - 1 - i), out + n);
        assert_int_equal(n, sizeof(want) - 1);
        assert_memory_equal(out, want, n);
    }
    assert_int_equal(utf16_order_of("id,lon,lat,lamp_type", 20), UTF16_NOT);
    assert_int_equal(utf16_order_of("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 16), UTF16_NOT);
    assert_int_equal(utf16_order_of("\xff", 1), UTF16_NOT);
}

static size_t read_mapped(lamp_sink *s, const char *text, const char *map) {
    noc_import_params params = noc_import_default_params();
    params.lamp_columns = (noc_texts){ .text = { map }, .count = 1 };
    params.crs = "EPSG:25832";
    lamp_sink_start(s);
    s->sink.named_lamps = true;
    assert_int_equal(read_lamps_text(s, text, &params), NOC_OK);
    return s->lamps.len;
}

/* The first line is a row where what it has in the columns of places is a place. */
static void test_headless(void **state) {
    static const struct {
        const char *text, *map;
        size_t lamps;
        double x, y; /* of the first */
    } rows[] = {
        { "a,9.51,51.31,70\nb,9.52,51.32,70\nc,9.53,51.33,70\n", "lon=9.51,lat=51.31", 3, 9.51, 51.31 },
        { "a,9.51,51.31,70\nb,9.52,51.32,70\nc,9.53,51.33,70\n", "lon=#2,lat=#3,watts=#4", 3, 9.51, 51.31 },
        { "a;9,51;51,31\nb;9,52;51,32\n", "lon=#2,lat=#3", 2, 9.51, 51.31 },
        { "a,535000,5684000\nb,535010,5684000\n", "x=#2,y=#3", 2, 535000, 5684000 },
        { "a,POINT (9.51 51.31)\nb,POINT (9.52 51.32)\n", "wkt=#2", 2, 9.51, 51.31 },
        { "a,\"51.31, 9.51\"\nb,\"51.32, 9.52\"\n", "latlon=#2", 2, 9.51, 51.31 },
        { "a,9\xc2\xb0"
          "30'0\"E,51\xc2\xb0"
          "15'0\"N\nb,9\xc2\xb0"
          "31'0\"E,51\xc2\xb0"
          "15'0\"N\n",
          "lon=#2,lat=#3", 2, 9.5, 51.25 },
        { "1,2,3\na,9.51,51.31\nb,9.52,51.32\n", "lon=2,lat=3", 2, 9.51, 51.31 }, /* a header of numbers */
        { "id,east,north\na,9.51,51.31\nb,9.52,51.32\n", "lon=#2,lat=#3", 2, 9.51, 51.31 },
        { "id,east,north\na,9.51,51.31\nb,9.52,51.32\n", "lon=east,lat=north", 2, 9.51, 51.31 },
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        lamp_sink s;
        size_t lamps = read_mapped(&s, rows[i].text, rows[i].map);
        if (!lamps)
            fail_msg("%s: none: %s", rows[i].map, s.error);
        if (lamps != rows[i].lamps || fabs(s.lamps.data[0].xyz[0] - rows[i].x) > 1e-9 ||
            fabs(s.lamps.data[0].xyz[1] - rows[i].y) > 1e-9)
            fail_msg("%s: %zu lamps, %g %g", rows[i].map, lamps, s.lamps.data[0].xyz[0], s.lamps.data[0].xyz[1]);
        lamp_sink_end(&s);
    }
    REQUIRE_SHARED(path, "data/cases3/kc_headerless.csv");
    noc_import_params params = noc_import_default_params();
    params.lamp_columns = (noc_texts){ .text = { "lon=-94.49075022,lat=38.9128811" }, .count = 1 };
    params.lamps = (noc_texts){ .text = { path }, .count = 1 };
    noc_report *report;
    noc_scene *scene = noc_scene_create(NULL);
    assert_int_equal(noc_scene_load(scene, NULL, 0, &params, &report), NOC_OK);
    assert_int_equal(noc_report_get_file(report, 0)->lamps, 4);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

/* Values in the first row are no names: they hide no status, and one that nothing names is read by its words. */
static void test_headless_status(void **state) {
    static const struct {
        const char *text, *map;
        size_t lamps, left, inactive;
    } rows[] = {
        { "a,9.51,51.31,in Betrieb\nb,9.52,51.31,abgebaut\nc,9.53,51.31,geplant\n", "lon=#2,lat=#3", 1, 2, 0 },
        { "a,9.51,51.31,abgebaut\nb,9.52,51.31,in Betrieb\n", "lon=#2,lat=#3", 1, 1, 0 },
        { "a,9.51,51.31,nicht in Betrieb\nb,9.52,51.31,ok\n", "lon=#2,lat=#3", 1, 1, 0 },
        { "a,9.51,51.31,in Betrieb\nb,9.52,51.31,abgebaut\n", "lon=#2,lat=#3,status=#4", 1, 0, 1 },
        { "a,9.51,51.31,removed,1\nb,9.52,51.31,no,0\n", "lon=#2,lat=#3,status=#5", 1, 0, 1 },
        { "a,9.51,51.31,Planned Parenthood at Main St\n", "lon=#2,lat=#3", 1, 0, 0 },
    };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        lamp_sink s;
        size_t lamps = read_mapped(&s, rows[i].text, rows[i].map);
        size_t left = issue_count(&s, "column without a name"), inactive = issue_count(&s, "(removed, disused");
        if (lamps != rows[i].lamps || left != rows[i].left || inactive != rows[i].inactive)
            fail_msg("%zu: %zu lamps, %zu left out, %zu not in use", i, lamps, left, inactive);
        lamp_sink_end(&s);
    }
}

static const char *field_of(const lamp_sink *s, const char *name) {
    for (size_t i = 0; i < s->columns.len; i++)
        if (!strcmp(s->columns.data[i].name, name))
            return s->columns.data[i].field;
    fail_msg("no column %s", name);
    return NULL;
}

/* A column is read as a place only where places were read from it. */
static void test_read_as(void **state) {
    lamp_sink s;
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, "id,lon,lat,lamp_type\na,east,north,LED\nb,?,?,LED\n", NULL), NOC_OK);
    assert_int_equal(s.lamps.len, 0);
    assert_int_equal(issue_count(&s, "lamp without a place"), 2);
    assert_string_equal(field_of(&s, "lon"), "");
    assert_string_equal(field_of(&s, "lat"), "");
    assert_string_equal(field_of(&s, "lamp_type"), "source");
    lamp_sink_end(&s);
    lamp_sink_start(&s);
    assert_int_equal(read_lamps_text(&s, "id,lon,lat,x,y,lamp_type\na,9.5,51.3,7,8,LED\nb,?,?,7,8,LED\n", NULL),
                     NOC_OK);
    assert_int_equal(s.lamps.len, 1);
    assert_string_equal(field_of(&s, "lon"), "lon");
    assert_string_equal(field_of(&s, "lat"), "lat");
    assert_string_equal(field_of(&s, "x"), "");
    lamp_sink_end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coordinates),  cmocka_unit_test(test_dms),      cmocka_unit_test(test_utf16),
        cmocka_unit_test(test_utf16_pieces), cmocka_unit_test(test_headless), cmocka_unit_test(test_headless_status),
        cmocka_unit_test(test_read_as),
    };
    assert_non_null(mkdtemp(folder));
    int failed = cmocka_run_group_tests_name("import lamp places", tests, NULL, NULL);
    return remove_folder() || failed;
}
