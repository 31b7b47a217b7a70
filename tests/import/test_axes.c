/* The order of axes of inputs in degrees is told by all of them together: at 11.42 E 48.75 N, which exchanged is off
 * Somalia, 5,600 km away. */
#include "fake_reader.h"

#define TOWN_X 11.42
#define TOWN_Y 48.75
#define FEW 1e-4 /* degrees, about 10 m */

static const noc_reader *const with_maps[] = { &city_reader, &lamp_reader, &noc_reader_overpass, &noc_reader_vector,
                                               NULL };

/* A closed block of a city, as latitudes and longitudes in the file's order. open: its floor is not there. */
static const char *city_of(const char *name, const char *crs, bool lon_first, bool open) {
    static const int faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                     { 1, 3, 7, 5 }, { 3, 2, 6, 7 }, { 2, 0, 4, 6 } };
    char text[4000];
    size_t n = (size_t)snprintf(text, sizeof(text), "FAKE city\ncrs %s\nobject 0 block 1\n", crs);
    for (int f = open; f < 6; f++) {
        n += (size_t)snprintf(text + n, sizeof(text) - n, "polygon %d", f == 0 ? 3 : f == 1 ? 2 : 1);
        for (int i = 0; i < 4; i++) {
            int c = faces[f][i];
            double x = TOWN_X + (c & 1) * FEW, y = TOWN_Y + (c >> 1 & 1) * FEW;
            n += (size_t)snprintf(text + n, sizeof(text) - n, " %.7f %.7f %d", lon_first ? x : y, lon_first ? y : x,
                                  (c >> 2) * 8);
        }
        n += (size_t)snprintf(text + n, sizeof(text) - n, "\n");
    }
    snprintf(text + n, sizeof(text) - n, "end\n");
    return file(name, text);
}

/* Beside the block, in the order of GeoJSON, or not. */
static const char *lamps_of(const char *name, bool wrong) {
    char text[200];
    double x = TOWN_X - FEW * (name[strlen(name) - 1] % 7 + 1), y = TOWN_Y - FEW;
    snprintf(text, sizeof(text), "FAKE lamps\ncrs =OGC:CRS84\nlamp %.7f %.7f\n", wrong ? y : x, wrong ? x : y);
    return file(name, text);
}

static const char *map_of(const char *name) {
    char text[300];
    snprintf(text, sizeof(text),
             "{\"version\": 0.6, \"generator\": \"Overpass API\", \"elements\": [{\"type\": \"node\", \"id\": 1, "
             "\"lat\": %.7f, \"lon\": %.7f, \"tags\": {\"highway\": \"street_lamp\"}}]}\n",
             TOWN_Y - 2 * FEW, TOWN_X - 2 * FEW);
    return file(name, text);
}

static const char *table_of(const char *name, bool wrong) {
    char text[200];
    double x = TOWN_X + 3 * FEW, y = TOWN_Y - FEW;
    snprintf(text, sizeof(text), "lamp_id,lon,lat,lamp_type\na,%.7f,%.7f,LED\n", wrong ? y : x, wrong ? x : y);
    return file(name, text);
}

/* Loads them, and expects the scene in the town and that input alone exchanged, by a warning that names it; NULL:
 * none. */
static void expect(const char *exchanged, size_t lights, size_t count, const char *const *paths) {
    for (size_t turn = 0; turn < count; turn++) { /* whatever the first one is */
        const char *turned[4];
        struct run r;
        noc_import_params params = DEFAULTS;
        for (size_t i = 0; i < count; i++)
            turned[i] = paths[(i + turn) % count];
        start(&r);
        r.status = load_inputs(r.scene, with_maps, turned, count, &params, false, &r.report);
        noc_scene_get_info(r.scene, &r.info);
        assert_int_equal(r.status, NOC_OK);
        assert_string_equal(r.info.crs, "EPSG:32632 (WGS 84 / UTM zone 32N)");
        assert_int_equal(r.info.lights, lights);
        assert_int_equal(r.warnings, exchanged ? 1 : 0);
        if (exchanged) {
            assert_non_null(strstr(r.last_warning, exchanged));
            assert_non_null(strstr(r.last_warning, "with latitude and longitude exchanged: done"));
        }
        for (size_t i = 0; i < count; i++) {
            const noc_report_file *f = noc_report_get_file(r.report, i);
            bool is = exchanged && strstr(f->path, exchanged);
            assert_int_equal(has_line(f, "axes exchanged to meet the other inputs", 1), is);
            assert_true(!f->has_extent || fabs(f->extent_min[0] - TOWN_X) < 0.01);
        }
        finish(&r);
    }
}
#define EXPECT(exchanged, lights, ...) expect(exchanged, lights, PATHS(__VA_ARGS__))

/* Faces that are outside as the file has them are those of a right city; one whose axes are exchanged is mirrored. */
static void test_city_or_lamps(void **state) {
    (void)state;
    const char *right = lamps_of("right", false), *wrong = lamps_of("wrong", true);
    const char *city = city_of("city", "EPSG:4326", false, false);
    EXPECT(NULL, 1, city, right);
    EXPECT("/wrong", 1, city, wrong);
    EXPECT("/turned", 1, city_of("turned", "EPSG:4326", true, false), right);
}

/* Where a city's faces tell nothing, its CRS's own order counts. */
static void test_no_faces(void **state) {
    (void)state;
    const char *wrong = lamps_of("wrong", true), *open = city_of("open", "EPSG:4326", false, true);
    EXPECT("/wrong", 1, open, wrong);
    EXPECT(NULL, 1, city_of("open84", "OGC:CRS84", true, true), lamps_of("right", false));
}

/* A map whose elements are called lat and lon is never exchanged, and more inputs are right than wrong. */
static void test_three(void **state) {
    (void)state;
    const char *right = lamps_of("right", false), *wrong = lamps_of("wrong", true), *map = map_of("map");
    const char *city = city_of("city", "EPSG:4326", false, false);
    const char *open = city_of("open", "EPSG:4326", true, true);
    EXPECT("/wrong", 2, city, wrong, map);
    EXPECT("/wrong", 2, city, right, wrong);
    EXPECT("/open", 2, open, right, map);
    EXPECT("/open", 2, open, right, lamps_of("rigth", false));
    EXPECT("/wrong", 2, wrong, map);
}

/* Both the city and the lamps are exchanged by a map. */
static void test_two_exchanged(void **state) {
    (void)state;
    struct run r;
    start(&r);
    const char *paths[] = { city_of("turned", "EPSG:4326", true, false), lamps_of("wrong", true), map_of("map") };
    noc_import_params params = DEFAULTS;
    r.status = load_inputs(r.scene, with_maps, paths, 3, &params, false, &r.report);
    noc_scene_get_info(r.scene, &r.info);
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:32632 (WGS 84 / UTM zone 32N)");
    assert_int_equal(r.info.lights, 2);
    assert_int_equal(r.warnings, 2);
    finish(&r);
}

/* Beside a city in metres lamps alone can be wrong; a table's are as a map's. */
static void test_city_in_metres(void **state) {
    (void)state;
    static char house[] = "FAKE city\ncrs EPSG:25832\n" HOUSE_AT("house", "677882", "677892", "5402490", "5402500");
    const char *city = file("city", house);
    EXPECT(NULL, 1, city_of("degrees", "EPSG:4326", false, false), table_of("t.csv", false));
    struct run r;
    for (int wrong = 0; wrong < 2; wrong++)
        for (int table = 0; table < 2; table++) {
            const char *lamps = table ? table_of("t.csv", wrong) : lamps_of("lamps", wrong);
            noc_import_params params = DEFAULTS;
            start(&r);
            r.status = load_inputs(r.scene, with_maps, (const char *[]){ city, lamps }, 2, &params, false, &r.report);
            noc_scene_get_info(r.scene, &r.info);
            assert_int_equal(r.status, NOC_OK);
            assert_int_equal(r.info.lights, 1);
            assert_int_equal(r.warnings, wrong);
            finish(&r);
        }
}

/* A guess, so that --strict refuses it. */
/* Blocks of a city, and whether their faces look outwards as the file has them; the last ones look inwards. */
static const char *blocks(const char *name, size_t count, size_t inwards, bool open) {
    char text[16000];
    size_t n = (size_t)snprintf(text, sizeof(text), "FAKE city\ncrs EPSG:4326\n");
    for (size_t b = 0; b < count; b++) {
        static const int faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                         { 1, 3, 7, 5 }, { 3, 2, 6, 7 }, { 2, 0, 4, 6 } };
        n += (size_t)snprintf(text + n, sizeof(text) - n, "object 0 block%zu 1\n", b);
        for (int f = open; f < 6; f++) {
            n += (size_t)snprintf(text + n, sizeof(text) - n, "polygon %d", f == 0 ? 3 : f == 1 ? 2 : 1);
            for (int i = 0; i < 4; i++) {
                int c = faces[f][b >= count - inwards ? 3 - i : i];
                n += (size_t)snprintf(text + n, sizeof(text) - n, " %.7f %.7f %d", TOWN_Y + (c >> 1 & 1) * FEW,
                                      TOWN_X + (double)b * 3 * FEW + (c & 1) * FEW, (c >> 2) * 8);
            }
            n += (size_t)snprintf(text + n, sizeof(text) - n, "\n");
        }
        n += (size_t)snprintf(text + n, sizeof(text) - n, "end\n");
    }
    return file(name, text);
}

/* Where city and lamps are exchanged alike, or the city is alone, its faces alone tell it. */
static void test_mirrored(void **state) {
    static const struct {
        size_t count, inwards, lines;
        bool open;
    } rows[] = { { 3, 3, 3, false }, { 3, 0, 0, false }, { 3, 2, 0, false },
                 { 3, 3, 0, true },  { 2, 2, 0, false }, { 12, 11, 11, false } };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++)
        for (int strict = 0; strict < 2; strict++) {
            struct run r;
            noc_import_params params = DEFAULTS;
            params.strict = strict;
            params.lamp_chosen = ~0u;
            LOAD(&r, params, blocks("blocks.city", rows[i].count, rows[i].inwards, rows[i].open), lamps_of("1", false));
            const noc_report_file *f = noc_report_get_file(r.report, 0);
            assert_int_equal(r.status, strict && rows[i].lines ? NOC_ERR_FORMAT : NOC_OK);
            if (rows[i].lines)
                assert_true(
                    has_line(f, "building whose faces look inwards, as those of a mirrored city do", rows[i].lines));
            bool told = strstr(r.last_warning, "look inwards");
            assert_int_equal(told, strict ? told : rows[i].lines > 0);
            finish(&r);
        }
}

static void test_strict(void **state) {
    (void)state;
    struct run r;
    noc_import_params params = DEFAULTS;
    params.strict = true;
    start(&r);
    const char *paths[] = { city_of("city", "EPSG:4326", false, false), lamps_of("wrong", true) };
    assert_int_equal(load_inputs(r.scene, with_maps, paths, 2, &params, false, &r.report), NOC_ERR_FORMAT);
    finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_city_or_lamps), cmocka_unit_test(test_no_faces),       cmocka_unit_test(test_three),
        cmocka_unit_test(test_two_exchanged), cmocka_unit_test(test_city_in_metres), cmocka_unit_test(test_strict),
        cmocka_unit_test(test_mirrored),
    };
    return cmocka_run_group_tests_name("import/axes", tests, make_folder, remove_folder);
}
