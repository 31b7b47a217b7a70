/* Lamps along the roads of a map, from files to a scene: when there are some, and where. */
#include "../told.h"

#include "import/load/load.h"
#include "noc_config.h"
#include <nocturne/nocturne.h>

#include <math.h>

#if NOC_HAVE_GDAL

static char folder[] = "/tmp/noc-road-lamps-XXXXXX";
#include "../folder.h"
static noc_log *log_;
static noc_scene *scene;
static noc_report *report;

static void forget(void) {
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    report = NULL;
    scene = NULL;
}

static noc_import_params params_of(noc_switch infer, bool isolate) {
    noc_import_params params = noc_import_default_params();
    params.infer_lamps = infer;
    params.windows = NOC_SWITCH_OFF;
    params.isolate = isolate;
    params.scene_crs = "EPSG:25832";
    return params;
}

static void load_params(const noc_import_params *params, const char *a, const char *b) {
    const char *paths[] = { a, b };
    forget();
    *told = 0;
    scene = noc_scene_create(log_);
    if (noc_scene_load(scene, paths, b ? 2 : 1, params, &report))
        fail_msg("%s", noc_log_last_error(log_));
}

/* Returns how many lamps are inferred. */
static size_t load(noc_switch infer, const char *a, const char *b) {
    const noc_import_params params = params_of(infer, false);
    noc_report_totals totals;
    noc_scene_info info;
    load_params(&params, a, b);
    noc_scene_get_info(scene, &info);
    noc_report_get_totals(report, &totals);
    assert_int_equal(totals.lamps_inferred, info.lights_inferred);
    return totals.lamps_inferred;
}

/* Those whose easting and northing, less 690000 and 5330000, lie in the box. */
static size_t within(double x0, double y0, double x1, double y1, bool inferred) {
    size_t n = 0;
    for (size_t i = 0; i < scene->lights.len; i++) {
        noc_light_info light;
        double xyz[3];
        noc_scene_get_light(scene, i, &light);
        memcpy(xyz, light.light.position, sizeof(xyz));
        assert_int_equal(noc_scene_from_local(scene, NULL, xyz), NOC_OK);
        double x = xyz[0] - 690000, y = xyz[1] - 5330000;
        n += light.light.inferred == inferred && x >= x0 && x <= x1 && y >= y0 && y <= y1;
    }
    return n;
}

#define FEATURE(id, properties, geometry)                                                                              \
    "{\"type\":\"Feature\",\"properties\":{\"@id\":\"" id "\"," properties "},\"geometry\":{" geometry "}}"
#define LINE(id, properties, points) FEATURE(id, properties, "\"type\":\"LineString\",\"coordinates\":[" points "]")
#define MAP(features)                                                                                                  \
    "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":"                             \
    "\"urn:ogc:def:crs:EPSG::25832\"}},\"features\":[" features "]}"
#define LAMP(id, place) FEATURE(id, "\"highway\":\"street_lamp\"", "\"type\":\"Point\",\"coordinates\":" place)
#define LIT(id) LINE(id, "\"highway\":\"residential\",\"lit\":\"yes\"", "[690000,5330000],[690240,5330000]")
#define DARK(id) LINE(id, "\"highway\":\"residential\"", "[690000,5330100],[690240,5330100]")
#define FAR_LAMP LAMP("node/1", "[690120,5330300]")
#define NEAR_LAMP LAMP("node/2", "[690001,5330004]")

/* Along what is lit and has none, whether lamps are mapped elsewhere or not. */
static void when(void **state) {
    const char *plain = write_file("plain.json", MAP(LIT("way/1") "," DARK("way/2")));
    const char *lamps = write_file("lamps.json", MAP(LIT("way/1") "," DARK("way/2") "," FAR_LAMP "," NEAR_LAMP));
    assert_int_equal(load(NOC_SWITCH_AUTO, plain, NULL), 10);
    assert_int_equal(within(-5, -10, 245, 10, true), 10);
    assert_int_equal(load(NOC_SWITCH_ON, plain, NULL), 10);
    assert_int_equal(load(NOC_SWITCH_OFF, plain, NULL), 0);
    assert_int_equal(load(NOC_SWITCH_OFF, lamps, NULL), 0);
    assert_int_equal(load(NOC_SWITCH_AUTO, lamps, NULL), 8);
    assert_non_null(strstr(told, "8 lamps placed along 1 lit street of the map that has none of its own there"));
    assert_int_equal(load(NOC_SWITCH_ON, lamps, NULL), 8); /* two spacings from the street's own there is none */
    assert_int_equal(within(48, -10, 245, 10, true), 8);
    assert_int_equal(within(-10, -10, 400, 400, false), 2);
    noc_report_totals totals;
    noc_report_get_totals(report, &totals);
    assert_int_equal(totals.lamps_mapped, 2);
}

/* The helper tells the same, two files of one road hold one, and what other files hold changes nothing. */
static void stable(void **state) {
    const char *one = write_file("one.json", MAP(LIT("way/1")));
    const char *two = write_file("two.json", MAP(DARK("way/2") "," LIT("way/1")));
    noc_light_info light[2];
    for (int i = 0; i < 2; i++) {
        const noc_import_params params = params_of(NOC_SWITCH_AUTO, i);
        load_params(&params, one, i ? two : NULL);
        assert_int_equal(scene->lights_inferred, 10);
        noc_scene_get_light(scene, 3, &light[i]);
    }
    assert_string_equal(light[1].light.name, scene->light_names.data[3]);
    assert_true(!memcmp(light[0].light.position, light[1].light.position, sizeof(light[0].light.position)));
}

#define POND(id, tags)                                                                                                 \
    FEATURE(id, tags,                                                                                                  \
            "\"type\":\"Polygon\",\"coordinates\":[[[690100,5329900],[690200,5329900],[690200,5330090],"               \
            "[690100,5330090],[690100,5329900]],[[690140,5329990],[690140,5330010],[690160,5330010],"                  \
            "[690160,5329990],[690140,5329990]]]")

/* Not over water, but on its island, and on a bridge. */
static void water(void **state) {
    const char *pond = write_file("pond.json", MAP(LIT("way/1") "," POND("way/3", "\"natural\":\"water\"")));
    const char *land = write_file("land.json", MAP(LIT("way/1") "," POND("way/3", "\"natural\":\"wood\"")));
    const char *bridge =
        write_file("bridge.json",
                   MAP(LINE("way/1", "\"highway\":\"residential\",\"lit\":\"yes\",\"bridge\":\"yes\"",
                            "[690000,5330000],[690240,5330000]") "," POND("way/3", "\"waterway\":\"riverbank\"")));
    for (int isolate = 0; isolate < 2; isolate++) {
        const noc_import_params params = params_of(NOC_SWITCH_AUTO, isolate);
        load_params(&params, pond, NULL);
        assert_int_equal(within(100, -10, 200, 10, true), within(140, -10, 160, 10, true));
        assert_int_equal(within(140, -10, 160, 10, true), 1);
        assert_true(scene->lights_inferred >= 7);
        load_params(&params, land, NULL);
        assert_int_equal(within(100, -10, 200, 10, true), 4);
        load_params(&params, bridge, NULL);
        assert_int_equal(within(100, -10, 200, 10, true), 4);
    }
}

/* A valley 12 m deep from x 40 to 100, as terrain. */
static const char *valley(void) {
    static const double x[] = { -20, 40, 50, 90, 100, 260 }, z[] = { 40, 40, 28, 28, 40, 40 };
    char text[3000], *end = text;
    end += sprintf(end, "{\"type\":\"CityJSON\",\"version\":\"2.0\",\"metadata\":{\"referenceSystem\":"
                        "\"https://www.opengis.net/def/crs/EPSG/0/25832\"},\"transform\":{\"scale\":[1,1,1],"
                        "\"translate\":[690000,5330000,0]},\"CityObjects\":{\"t\":{\"type\":\"TINRelief\",\"geometry\":"
                        "[{\"type\":\"CompositeSurface\",\"lod\":\"1\",\"boundaries\":[");
    for (int i = 0; i < 5; i++)
        end += sprintf(end, "%s[[%d,%d,%d]],[[%d,%d,%d]]", i ? "," : "", 2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3,
                       2 * i + 1);
    end += sprintf(end, "]}]}},\"vertices\":[");
    for (int i = 0; i < 12; i++)
        end += sprintf(end, "%s[%g,%d,%g]", i ? "," : "", x[i / 2], i % 2 ? 150 : -150, z[i / 2]);
    sprintf(end, "]}");
    return write_file("valley.city.json", text);
}

#define LAMP_AT(id, keys, place)                                                                                       \
    FEATURE(id, keys "\"highway\":\"street_lamp\"", "\"type\":\"Point\",\"coordinates\":[" place "]")
#define DECK "\"highway\":\"primary\",\"bridge\":\"yes\",\"layer\":\"1\""
/* clang-format off */
#define BRIDGE_AND_LAMPS                                                                                               \
    MAP(LINE("way/1", DECK, "[690000,5330000],[690080,5330000]") ","                                                   \
        LAMP_AT("node/1", "%s", "690040,5330005") ","                                                                  \
        LAMP_AT("node/2", "\"ele\":\"50\",", "690040,5330060") ","                                                     \
        LAMP_AT("node/3", "\"ele\":\"50\",", "690040,5329940"))
/* clang-format on */

/* A lamp with an elevation on the deck of a map's bridge does not lift the ground beneath it. */
static void ground_under_a_bridge(void **state) {
    static const char *const ele[] = { "", "\"ele\":\"57\"," };
    double z[2], at[2];
    (void)state;
    for (int told_one = 0; told_one < 2; told_one++) {
        char text[3000];
        snprintf(text, sizeof(text), BRIDGE_AND_LAMPS, ele[told_one]);
        const noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
        load_params(&params, write_file("deck.json", text), NULL);
        at[0] = 690040 - scene->origin[0];
        at[1] = 5330005 - scene->origin[1];
        assert_true(noc_scene_ground(scene, at[0], at[1], &z[told_one]));
    }
    assert_float_equal(z[0], z[1], .01);
}

/* Height of the light near a place, by its easting and northing less 690000 and 5330000; NaN: there is none. */
static double height_of(double x, double y) {
    for (size_t i = 0; i < scene->lights.len; i++) {
        const float *p = scene->lights.data[i].p;
        if (hypot(p[0] + scene->origin[0] - 690000 - x, p[1] + scene->origin[1] - 5330000 - y) < 2.5)
            return p[2] + scene->origin[2];
    }
    return NAN;
}

#define HIGH(id, more, place)                                                                                          \
    FEATURE(id, "\"highway\":\"street_lamp\",\"height\":\"6\"" more, "\"type\":\"Point\",\"coordinates\":" place)
#define APPROACHES                                                                                                     \
    LINE("way/1", "\"highway\":\"residential\"", "[690000,5330000],[690039,5330000]")                                  \
    "," LINE("way/3", "\"highway\":\"residential\"",                                                                   \
             "[690101,5330000],[690240,5330000]") "," LINE("way/4", "\"highway\":\"residential\"",                     \
                                                           "[690070,5329900],[690070,5330100]")
#define BRIDGE(lit)                                                                                                    \
    LINE("way/2", "\"highway\":\"residential\",\"bridge\":\"yes\",\"layer\":\"1\"" lit,                                \
         "[690039,5330000],[690101,5330000]")

/* Lamps of a bridge stand on its deck, on the pavement beside it, too, and those of the street below do not. */
static void bridge_over_a_valley(void **state) {
    const char *terrain = valley();
    const char *map =
        write_file("valley.json",
                   MAP(APPROACHES "," BRIDGE("") "," HIGH("node/1", "", "[690055,5330004]") "," HIGH(
                       "node/2", "", "[690085,5329998]") "," HIGH("node/3", "",
                                                                  "[690066,5330040]") "," HIGH("node/4", "",
                                                                                               "[690020,5330004]")));
    const char *lit = write_file("lit.json", MAP(APPROACHES "," BRIDGE(",\"lit\":\"yes\"")));
    for (int surfaces = 0; surfaces < 2; surfaces++) {
        noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
        params.map_surfaces = surfaces ? NOC_SWITCH_ON : NOC_SWITCH_OFF;
        load_params(&params, terrain, map);
        assert_true(fabs(height_of(55, 4) - 45.98) < 0.06); /* 6 m over the deck at 40 m; the ground is at 28 m */
        assert_true(fabs(height_of(85, -2) - 45.98) < 0.06);
        assert_true(fabs(height_of(66, 40) - 33.98) < 0.06);
        assert_true(fabs(height_of(20, 4) - 45.98) < 0.06);
        const noc_report_line *line = noc_report_get_file(report, 1)->lines;
        assert_string_equal(line->reason, "lamp on a bridge of a map: put on its deck");
        assert_string_equal(line->examples, "node/1, node/2");
        load_params(&params, terrain, lit);
        assert_true(scene->lights.len >= 2);
        for (size_t i = 0; i < scene->lights.len; i++)
            assert_true(fabs(scene->lights.data[i].p[2] + scene->origin[2] - 45.98) < 0.06);
    }
    noc_import_params params = params_of(NOC_SWITCH_AUTO, false); /* the surface of the bridge makes no hill */
    params.map_surfaces = NOC_SWITCH_ON;
    load_params(&params, terrain, map);
    double z;
    assert_true(
        noc_scene_highest(scene, 1u << NOC_CLASS_TERRAIN, 690065 - scene->origin[0], 5330000 - scene->origin[1], &z));
    assert_true(fabs(z + scene->origin[2] - 28) < 0.01);
}

/* Whether lamps near a bridge stand on its deck at 40 m, and what is told of it. Street 4 runs below at x 70. */
static void beside_a_bridge(void **state) {
    static const char on[] = "lamp on a bridge of a map: put on its deck",
                      at_edge[] = "lamp beside the carriageway of a bridge of a map: put on its deck",
                      beside[] = "lamp beside a bridge of a map: left on the ground",
                      over[] = "lamp at a bridge of a map and a road below it: put on the deck",
                      below[] = "lamp at a bridge of a map and a road below it: left on the ground";
    static const struct {
        double x, y;
        const char *ele;
        double foot;
        const char *reason; /* NULL: nothing is told */
    } rows[] = {
        { 55, 2, "", 40, on },
        { 55, 8, "", 40, at_edge }, /* 5.25 m off the carriageway, which is 5.5 m wide */
        { 55, -8.5, "", 40, at_edge },
        { 55, 9.5, "", 28, beside },
        { 55, 12, "", 28, beside },
        { 55, 14, "", 28, NULL },
        { 70, 4, "", 40, over }, /* over the carriageway of the street */
        { 73.5, 1, "", 40, over },
        { 73.5, 5, "", 28, below }, /* nearer to the street */
        { 74.5, 4, "", 40, over },
        { 73.5, 20, "", 28, NULL },
        { 55, 8, ",\"ele\":\"39\"", 40, on },
        { 55, 2, ",\"ele\":\"28\"", 28, NULL },
        { 74.5, 4, ",\"ele\":\"28\"", 28, NULL },
    };
    const noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char text[3000];
        snprintf(text, sizeof(text),
                 MAP(APPROACHES "," BRIDGE("") "," FEATURE("node/1", "\"highway\":\"street_lamp\",\"height\":\"6\"%s",
                                                           "\"type\":\"Point\",\"coordinates\":[%.1f,%.1f]")),
                 rows[i].ele, 690000 + rows[i].x, 5330000 + rows[i].y);
        load_params(&params, valley(), write_file("edge.json", text));
        const noc_report_file *file = noc_report_get_file(report, 1);
        const char *reason = file->line_count ? file->lines[0].reason : NULL;
        double foot = height_of(rows[i].x, rows[i].y) - 5.98;
        if (fabs(foot - rows[i].foot) > .06 || !reason != !rows[i].reason || (reason && strcmp(reason, rows[i].reason)))
            fail_msg("%g, %g%s: %g, %s", rows[i].x, rows[i].y, rows[i].ele, foot, reason ? reason : "nothing");
    }
}

#define FOOTBRIDGE LINE("way/2", "\"highway\":\"footway\",\"bridge\":\"yes\"", "[690039,5330000],[690101,5330000]")
#define STREET_BELOW LINE("way/4", "\"highway\":\"residential\"", "[690070,5329900],[690070,5330100]")

/* A footbridge has no pavement; a lamp on the deck looks at the bridge, not at the road that is nearer below. */
static void on_a_footbridge(void **state) {
    noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
    params.each_lamp = true;
    const char *map =
        write_file("foot.json", MAP(FOOTBRIDGE "," STREET_BELOW "," HIGH("node/1", "", "[690055,5330003]") "," HIGH(
                                    "node/2", "", "[690055,5330006]") "," HIGH("node/3", "", "[690071,5330002]")));
    load_params(&params, valley(), map);
    assert_true(fabs(height_of(55, 3) - 45.98) < .06);
    assert_true(fabs(height_of(71, 2) - 45.98) < .06);
    bool low = false;
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_report_lamp *lamp = noc_report_get_lamp(report, i);
        noc_light_info light;
        noc_scene_get_light(scene, lamp->light, &light);
        low = low || (!strcmp(light.light.name, "node/2") && light.centre[2] + scene->origin[2] < 35);
        if (!strcmp(light.light.name, "node/3"))
            assert_true(fabs(remainder(lamp->direction - 180, 360)) < 1);
    }
    assert_true(low);
}

#define PIECE(id, more, from, to)                                                                                      \
    LINE(id, "\"highway\":\"residential\",\"bridge\":\"yes\"" more, "[6900" from ",5330000],[690" to ",5330000]")
#define SAME_MAP(middle)                                                                                               \
    MAP(APPROACHES "," middle "," HIGH("node/1", "", "[690055,5330004]") "," HIGH("node/2", "", "[690085,5329998]"))

/* A bridge of several ways has one deck, whatever ends in the air: pieces of other layers, drawn the other way, with
 * stairs at a joint; a ramp that leaves it is between. Over a street that meets it the deck is on the ground. */
static void bridge_of_pieces(void **state) {
    static const struct {
        const char *middle;
        double first, second; /* heights of the two lamps' feet */
    } rows[] = {
        { PIECE("way/2", "", "39", "070") "," PIECE("way/5", "", "70", "101"), 40, 40 },
        { PIECE("way/2", "", "39", "047") "," PIECE("way/5", ",\"layer\":\"2\"", "71", "047") "," PIECE("way/6", "",
                                                                                                        "71", "101"),
          40, 40 },
        { PIECE("way/2", "", "39", "070") "," PIECE("way/5", "", "70",
                                                    "101") "," LINE("way/7", "\"highway\":\"steps\"",
                                                                    "[690070,5330000],[690070,5330020]"),
          40, 40 },
        { PIECE("way/2", "", "39", "070") "," PIECE("way/5", "", "70",
                                                    "101") "," LINE("way/7", "\"highway\":\"residential\"",
                                                                    "[690070,5330000],[690070,5330020]"),
          28 + 12 * 15. / 31, 28 + 12 * 15. / 31 },
        /* the ramp comes down 31 m beside the middle, where all three pieces are 31 m long: (40 + 40 + 28) / 3 = 36 */
        { PIECE("way/2", "", "39", "070") "," PIECE("way/5", "", "70", "101") "," LINE(
              "way/7", "\"highway\":\"residential\",\"bridge\":\"yes\"", "[690070,5330000],[690070,5330031]"),
          40 - 4 * 16. / 31, 40 - 4 * 16. / 31 },
        /* it joins a way that is not cut */
        { PIECE("way/2", "", "39", "101") "," LINE("way/7", "\"highway\":\"residential\",\"bridge\":\"yes\"",
                                                   "[690085,5330031],[690070,5330031]"),
          40, 40 },
    };
    (void)state;
    for (size_t i = 0; i < 2 * NOC_COUNT(rows); i++) {
        char text[4000];
        snprintf(text, sizeof(text), SAME_MAP("%s"), rows[i / 2].middle);
        noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
        params.map_surfaces = i % 2 ? NOC_SWITCH_ON : NOC_SWITCH_OFF;
        load_params(&params, valley(), write_file("pieces.json", text));
        double first = height_of(55, 4) - 5.98, second = height_of(85, -2) - 5.98, z;
        if (fabs(first - rows[i / 2].first) > .1 || fabs(second - rows[i / 2].second) > .1)
            fail_msg("row %zu: %g, %g", i / 2, first, second);
        if (i % 2 && (!noc_scene_highest(scene, 1u << NOC_CLASS_ROAD, 690055 - scene->origin[0],
                                         5330000 - scene->origin[1], &z) ||
                      fabs(z + scene->origin[2] - rows[i / 2].first) > .1))
            fail_msg("row %zu: surface at %g", i / 2, z + scene->origin[2]);
    }
}

static void box(void **state) {
    const char *plain =
        write_file("plain.json", MAP(LIT("way/1") "," LINE("way/9", "\"highway\":\"residential\",\"lit\":\"yes\"",
                                                           "[691000,5330000],[691240,5330000]")));
    noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
    params.bbox = "690100,5329900,690300,5330100";
    load_params(&params, plain, NULL);
    assert_int_equal(within(100, -100, 300, 100, true), scene->lights.len);
    assert_int_equal(scene->lights.len, 6);
}

/* A lamp that is mapped looks across the road of the map. */
static void facing(void **state) {
    const char *map = write_file("facing.json", MAP(DARK("way/1") "," LAMP("node/5", "[690100,5330095.8]")));
    load(NOC_SWITCH_AUTO, map, NULL);
    assert_int_equal(scene->lights.len, 1);
    assert_int_equal(within(99.9, 96.3, 100.1, 98, false), 1); /* its arm reaches north */
}

static size_t by_chance(void) {
    noc_report_totals totals;
    noc_report_get_totals(report, &totals);
    return totals.lamps_assumed[NOC_LAMP_DIRECTION];
}

/* Lamps whose direction nothing tells are counted: none beside a road of a map, all without one; nor are round ones. */
static void facing_by_chance(void **state) {
    const char *beside = "[690100,5330095.8]", *far = "[690120,5330300]";
    char text[3000];
    for (int i = 0; i < 4; i++) {
        bool road = i & 1, lantern = i & 2;
        const char *tags =
            lantern ? "\"highway\":\"street_lamp\",\"lamp_type\":\"lantern\"" : "\"highway\":\"street_lamp\"";
        snprintf(text, sizeof(text),
                 MAP("%s" FEATURE("node/1", "%s", "\"type\":\"Point\",\"coordinates\":%s") "," FEATURE(
                     "node/2", "%s", "\"type\":\"Point\",\"coordinates\":[690150,5330105]")),
                 road ? DARK("way/1") "," : "", tags, road ? beside : far, tags);
        load(NOC_SWITCH_AUTO, write_file("chance.json", text), NULL);
        assert_int_equal(scene->lights.len, 2);
        assert_int_equal(by_chance(), road || lantern ? 0 : 2);
    }
    noc_import_params params = params_of(NOC_SWITCH_AUTO, false);
    params.strict = true;
    for (int chosen = 0; chosen < 2; chosen++) {
        params.lamp_chosen = 7u | (chosen ? 1u << NOC_LAMP_DIRECTION : 0);
        const char *path = write_file("chance.json", MAP(FAR_LAMP));
        forget();
        *told = 0;
        scene = noc_scene_create(log_);
        assert_int_equal(noc_scene_load(scene, &path, 1, &params, &report), chosen ? NOC_OK : NOC_ERR_FORMAT);
        assert_true(chosen || strstr(told, "guessed at: 1; 1 x lamp facing by chance"));
    }
}

/* A dozen lamps of one street, and 2 km of other lit streets, which they do not silence: in two files or in one. */
static void a_dozen(void **state) {
    char lamps[4000] = "", roads[8000] = "", both[12000], text[12200];
    size_t n = 0, m = 0;
    for (int i = 0; i < 12; i++)
        n += (size_t)snprintf(lamps + n, sizeof(lamps) - n, "%s" LAMP("node/%d", "[%d,5330004]"), i ? "," : "", i,
                              690010 + 20 * i);
    for (int i = 0; i < 10; i++) /* the last but one is a part of the one before */
        m += (size_t)snprintf(roads + m, sizeof(roads) - m,
                              "%s" LINE("way/%d", "\"highway\":\"residential\",\"lit\":\"yes\",\"name\":\"S%d\"",
                                        "[%d,%d],[%d,%d]"),
                              i ? "," : "", i, i == 8 ? 7 : i, i == 8 ? 690240 : 690000,
                              5330000 + 100 * (i == 8 ? 7 : i), i == 8 ? 690480 : 690240,
                              5330000 + 100 * (i == 8 ? 7 : i));
    snprintf(text, sizeof(text), MAP("%s"), lamps);
    const char *of_lamps = write_file("dozen.json", text);
    snprintf(text, sizeof(text), MAP("%s"), roads);
    const char *of_roads = write_file("streets.json", text);
    snprintf(both, sizeof(both), "%s,%s", lamps, roads);
    snprintf(text, sizeof(text), MAP("%s"), both);
    const char *of_both = write_file("both.json", text);
    for (int files = 1; files <= 2; files++) {
        assert_int_equal(load(NOC_SWITCH_AUTO, files == 1 ? of_both : of_roads, files == 1 ? NULL : of_lamps), 90);
        assert_int_equal(within(-50, -20, 500, 20, true), 0);
        assert_int_equal(within(-50, -20, 500, 20, false), 12);
        assert_non_null(
            strstr(told, "90 lamps placed along 8 lit streets of the map that have none of their own there"));
    }
    assert_int_equal(load(NOC_SWITCH_OFF, of_both, NULL), 0);
}

/* What is made up is an error, unless it is asked for. */
static void strict(void **state) {
    const char *paths[] = { write_file("plain.json", MAP(LIT("way/1"))),
                            write_file("lamps.json", MAP(LIT("way/1") "," FAR_LAMP)) };
    static const char *const why[] = { "no lamps in the inputs, 10 placed by a rule",
                                       "lit streets without lamps, 10 placed by a rule" };
    for (int asked = 0; asked < 2; asked++)
        for (int lamps = 0; lamps < 2; lamps++) {
            noc_import_params params = params_of(asked ? NOC_SWITCH_ON : NOC_SWITCH_AUTO, false);
            params.strict = true;
            params.lamp_chosen = ~0u;
            forget();
            *told = 0;
            scene = noc_scene_create(log_);
            assert_int_equal(noc_scene_load(scene, paths + lamps, 1, &params, &report),
                             asked ? NOC_OK : NOC_ERR_FORMAT);
            assert_true(asked || strstr(told, why[lamps]));
        }
}

static int start(void **state) {
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    return mkdtemp(folder) ? 0 : -1;
}

static int finish(void **state) {
    forget();
    noc_log_destroy(log_);
    return remove_folder();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bridge_over_a_valley),
        cmocka_unit_test(beside_a_bridge),
        cmocka_unit_test(ground_under_a_bridge),
        cmocka_unit_test(on_a_footbridge),
        cmocka_unit_test(bridge_of_pieces),
        cmocka_unit_test(when),
        cmocka_unit_test(stable),
        cmocka_unit_test(water),
        cmocka_unit_test(box),
        cmocka_unit_test(facing),
        cmocka_unit_test(facing_by_chance),
        cmocka_unit_test(strict),
        cmocka_unit_test(a_dozen),
    };
    return cmocka_run_group_tests_name("import/road_lamps", tests, start, finish);
}

#else

int main(void) {
    puts("1..0 # SKIP no GDAL");
    return 0;
}

#endif
