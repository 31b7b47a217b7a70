/* Buildings of maps: outlines become blocks on the ground, with the heights that they tell, where no model has one. */
#include "test.h"

#include "import/load/load.h"
#include "noc_config.h"
#include <nocturne/nocturne.h>

#include <math.h>

#if NOC_HAVE_GDAL

static char folder[] = "/tmp/noc-footprints-XXXXXX";
#include "../folder.h"
#include "../told.h"
static noc_log *log_;
static noc_scene *scene;
static noc_report *report;

static void forget(void) {
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    report = NULL;
    scene = NULL;
}

static noc_switch surfaces = NOC_SWITCH_AUTO;

static noc_status load(bool footprints, bool isolate, const char *a, const char *b) {
    const char *paths[] = { a, b };
    noc_import_params params = noc_import_default_params();
    params.infer_lamps = params.windows = NOC_SWITCH_OFF;
    params.footprints = footprints;
    params.isolate = isolate;
    params.scene_crs = "EPSG:25832";
    params.map_surfaces = surfaces;
    forget();
    scene = noc_scene_create(log_);
    return noc_scene_load(scene, paths, b ? 2 : 1, &params, &report);
}

static void load_well(const char *a, const char *b) {
    if (load(true, true, a, b) != NOC_OK)
        fail_msg("%s", noc_log_last_error(log_));
}

static void load_as(bool footprints, const char *path) {
    if (load(footprints, true, path, NULL) != NOC_OK)
        fail_msg("%s", noc_log_last_error(log_));
}

static size_t line(size_t file, const char *reason) {
    const noc_report_file *f = noc_report_get_file(report, file);
    for (size_t i = 0; i < f->line_count; i++)
        if (!strcmp(f->lines[i].reason, reason))
            return f->lines[i].count;
    return 0;
}

typedef struct seen {
    size_t meshes, wall_triangles, roof_triangles;
    double low, high, roof_area;
} seen;

/* Of the building whose id is this one. */
static seen look(const char *id) {
    seen s = { .low = INFINITY, .high = -INFINITY };
    for (size_t m = 0; m < scene->meshes.len; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        noc_class cls = scene->materials.data[mesh->material].cls;
        if (!mesh->name || strcmp(mesh->name, id))
            continue;
        s.meshes++;
        for (size_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count; t++) {
            const float *p[3];
            for (size_t k = 0; k < 3; k++) {
                p[k] = scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + k];
                s.low = fmin(s.low, (double)p[k][2]);
                s.high = fmax(s.high, (double)p[k][2]);
            }
            double twice =
                (double)((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
            s.wall_triangles += cls == NOC_CLASS_WALL;
            s.roof_triangles += cls == NOC_CLASS_ROOF;
            s.roof_area += cls == NOC_CLASS_ROOF ? twice / 2 : 0;
        }
    }
    return s;
}

#define FEATURE(id, properties, rings)                                                                                 \
    "{\"type\":\"Feature\",\"id\":" id ",\"properties\":{" properties "},\"geometry\":{\"type\":\"Polygon\","          \
    "\"coordinates\":[" rings "]}}"
#define MAP(name, features)                                                                                            \
    "{\"type\":\"FeatureCollection\",\"name\":\"" name "\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":"       \
    "\"urn:ogc:def:crs:EPSG::25832\"}},\"features\":[" features "]}"
/* Squares of 10 m; one is drawn clockwise, and one has a yard of 4 m. */
#define SQUARE "[[690000,5330000],[690010,5330000],[690010,5330010],[690000,5330010],[690000,5330000]]"
#define BACKWARDS "[[690020,5330000],[690020,5330010],[690030,5330010],[690030,5330000],[690020,5330000]]"
#define YARD                                                                                                           \
    "[[690040,5330000],[690050,5330000],[690050,5330010],[690040,5330010],[690040,5330000]],"                          \
    "[[690043,5330003],[690047,5330003],[690047,5330007],[690043,5330007],[690043,5330003]]"
#define FAR "[[690080,5330000],[690090,5330000],[690090,5330010],[690080,5330010],[690080,5330000]]"

/* clang-format off */
static const char town[] = MAP("areas",
    FEATURE("1", "\"building\":\"yes\",\"height\":\"12 m\"", SQUARE) ","
    FEATURE("2", "\"building\":\"house\",\"building:levels\":\"2\",\"roof:height\":\"1.5\"", BACKWARDS) ","
    FEATURE("3", "\"building\":\"yes\",\"height\":\"20\",\"min_height\":\"8\"", YARD) ","
    FEATURE("4", "\"building\":\"yes\"", FAR) ","
    FEATURE("5", "\"building\":\"no\"", FAR) ","
    FEATURE("6", "\"building:part\":\"yes\",\"height\":\"90\"", FAR) ","
    FEATURE("7", "\"landuse\":\"grass\"", FAR));
/* clang-format on */

static void test_blocks(void **state) {
    load_well(write_file("town.geojson", town), NULL);
    const noc_report_file *f = noc_report_get_file(report, 0);
    assert_int_equal(f->buildings, 4);
    assert_int_equal(f->lod_used[1], 4);
    assert_int_equal(f->polygons_by_class[NOC_CLASS_WALL], 4 + 4 + 8 + 4);
    seen s = look("feature 1");
    assert_float_equal(s.high - s.low, 12, 1e-4);
    assert_int_equal(s.wall_triangles, 8);
    assert_float_equal(s.roof_area, 100, 1e-2);
    s = look("feature 2"); /* the roof faces up, whichever way the outline runs */
    assert_float_equal(s.high - s.low, 7.5, 1e-4);
    assert_float_equal(s.roof_area, 100, 1e-2);
    s = look("feature 3");
    assert_float_equal(s.high - s.low, 12, 1e-4);
    assert_float_equal(s.roof_area, 100 - 16, 1e-2);
    s = look("feature 4");
    assert_float_equal(s.high - s.low, 9, 1e-4);
    assert_int_equal(line(0, "height of a building, by --building-height"), 1);
    assert_int_equal(look("feature 5").meshes + look("feature 6").meshes + look("feature 7").meshes, 0);
    assert_int_equal(f->map_areas, 7);
    /* the same in this process; and nothing without the option */
    size_t triangles = f->triangles;
    assert_int_equal(load(true, false, write_file("town.geojson", town), NULL), NOC_OK);
    assert_int_equal(noc_report_get_file(report, 0)->triangles, triangles);
    assert_int_equal(load(false, true, write_file("town.geojson", town), NULL), NOC_OK);
    assert_int_equal(noc_report_get_file(report, 0)->triangles, 0);
}

/* Walls face outwards: what they enclose is positive. */
static void test_facing(void **state) {
    load_well(write_file("town.geojson", town), NULL);
    double x = 0;
    for (size_t m = 0; m < scene->meshes.len; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        if (!mesh->name || strcmp(mesh->name, "feature 2") ||
            scene->materials.data[mesh->material].cls != NOC_CLASS_WALL)
            continue;
        double volume = 0;
        const float *o = scene->positions.data + 3 * (size_t)scene->indices.data[3 * mesh->first_triangle];
        for (size_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count; t++) {
            double p[3][3];
            for (size_t k = 0; k < 9; k++)
                p[k / 3][k % 3] =
                    (double)(scene->positions.data[3 * (size_t)scene->indices.data[3 * t + k / 3] + k % 3] - o[k % 3]);
            volume += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
                      p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
                      p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        }
        assert_true(volume / 6 > 0);
        x = volume;
    }
    assert_true(x > 0);
}

/* Only where no model stands, and at the height of the terrain. */
static void test_model_and_terrain(void **state) {
    const char *model = write_file(
        "model.json",
        "{\"type\":\"CityJSON\",\"version\":\"1.0\",\"metadata\":{\"referenceSystem\":\"EPSG:25832\"},"
        "\"CityObjects\":{\"roof\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":2,"
        "\"boundaries\":[[[0,1,2,3]]],\"semantics\":{\"surfaces\":[{\"type\":\"RoofSurface\"}],\"values\":[0]}}]},"
        "\"tin\":{\"type\":\"TINRelief\",\"geometry\":[{\"type\":\"CompositeSurface\",\"lod\":1,"
        "\"boundaries\":[[[4,5,6]],[[4,6,7]]]}]}},\"vertices\":["
        "[690002,5330002,460],[690008,5330002,460],[690008,5330008,460],[690002,5330008,460],"
        "[689900,5329900,450],[690200,5329900,450],[690200,5330100,450],[689900,5330100,450]]}");
    load_well(write_file("town.geojson", town), model);
    assert_int_equal(look("feature 1").meshes, 0);
    assert_int_equal(line(0, "outline of a building that a city model has"), 1);
    seen s = look("feature 2");
    assert_float_equal(s.low, 450, 1e-3);
    assert_float_equal(s.high, 457.5, 1e-3);
    s = look("feature 3");
    assert_float_equal(s.low, 458, 1e-3);
    assert_int_equal(noc_report_get_file(report, 0)->buildings, 3);
}

/* A layer whose name says what it holds. */
static void test_layer(void **state) {
    load_well(write_file("layer.geojson", MAP("Buildings 2020", FEATURE("1", "\"NUM_FLOORS\":4", SQUARE))), NULL);
    seen s = look("feature 1");
    assert_float_equal(s.high - s.low, 12, 1e-4);
    assert_int_equal(load(true, true, write_file("layer.geojson", MAP("trees", FEATURE("1", "\"a\":4", SQUARE))), NULL),
                     NOC_OK);
    assert_int_equal(noc_report_get_file(report, 0)->buildings, 0);
}

/* Heights in feet: the storeys tell. */
static void test_units(void **state) {
    for (int feet = 0; feet < 2; feet++) {
        char text[8000];
        size_t n = (size_t)snprintf(text, sizeof(text), "{\"type\":\"FeatureCollection\",\"features\":[");
        for (int i = 0; i < 12; i++)
            n += (size_t)snprintf(text + n, sizeof(text) - n,
                                  "%s{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\",\"height\":%d,"
                                  "\"building:levels\":%d},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[[%.4f,"
                                  "48.1],[%.4f,48.1],[%.4f,48.1001],[%.4f,48.1]]]}}",
                                  i ? "," : "", (feet ? 10 : 3) * (2 + i % 3), 2 + i % 3, 11.5 + i * 0.001,
                                  11.5001 + i * 0.001, 11.5001 + i * 0.001, 11.5 + i * 0.001);
        snprintf(text + n, sizeof(text) - n, "]}");
        *told = 0;
        load_well(write_file("feet.geojson", text), NULL);
        assert_true((strstr(told, "are heights in feet? Times 0.3048 it would be 3.05 m") != NULL) == (feet == 1));
    }
}

/* What the tags say of the use reaches the windows, by the helper and without it. */
static void test_use(void **state) {
    static const char *const tags[] = { "\"building\":\"garage\"", "\"building\":\"apartments\"",
                                        "\"building\":\"yes\",\"amenity\":\"place_of_worship\"",
                                        "\"building\":\"yes\"" };
    char text[4000];
    size_t n = (size_t)snprintf(text, sizeof(text), "{\"type\":\"FeatureCollection\",\"features\":[");
    for (size_t i = 0; i < NOC_COUNT(tags); i++)
        n += (size_t)snprintf(text + n, sizeof(text) - n,
                              "%s{\"type\":\"Feature\",\"properties\":{%s},\"geometry\":{\"type\":\"Polygon\","
                              "\"coordinates\":[[[%.4f,48.1],[%.4f,48.1],[%.4f,48.1003],[%.4f,48.1]]]}}",
                              i ? "," : "", tags[i], 11.5 + .001 * (double)i, 11.5005 + .001 * (double)i,
                              11.5005 + .001 * (double)i, 11.5 + .001 * (double)i);
    snprintf(text + n, sizeof(text) - n, "]}");
    const char *path = write_file("uses.geojson", text);
    for (int isolate = 0; isolate < 2; isolate++) {
        noc_import_params params = noc_import_default_params();
        params.infer_lamps = NOC_SWITCH_OFF;
        params.footprints = true;
        params.isolate = isolate;
        forget();
        scene = noc_scene_create(log_);
        assert_int_equal(noc_scene_load(scene, &path, 1, &params, &report), NOC_OK);
        const noc_window_counts *c = &noc_report_get_file(report, 0)->windows;
        static const noc_building_use uses[] = { NOC_USE_BARE, NOC_USE_FLATS, NOC_USE_DARK, NOC_USE_UNKNOWN };
        for (size_t i = 0; i < NOC_COUNT(uses); i++)
            assert_int_equal(c->buildings[uses[i]], 1);
        assert_int_equal(c->walls[NOC_WALL_BARE], 3);
        assert_true(c->walls[NOC_WALL_TAKEN] == 9 && c->windows > 50);
    }
}

static void test_osm(void **state) {
    static const char osm[] =
        "<?xml version='1.0'?><osm version='0.6'>"
        "<node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.1' lon='11.5002'/>"
        "<node id='3' lat='48.1002' lon='11.5002'/><node id='4' lat='48.1002' lon='11.5'/>"
        "<node id='5' lat='48.10005' lon='11.50005'/><node id='6' lat='48.10005' lon='11.50015'/>"
        "<node id='7' lat='48.10015' lon='11.50015'/><node id='8' lat='48.1003' lon='11.5004'>"
        "<tag k='highway' v='street_lamp'/></node>"
        "<node id='9' lat='48.1' lon='11.501'/><node id='10' lat='48.1' lon='11.5012'/>"
        "<node id='11' lat='48.1002' lon='11.5012'/>"
        "<way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='4'/><nd ref='1'/></way>"
        "<way id='2'><nd ref='5'/><nd ref='6'/><nd ref='7'/><nd ref='5'/></way>"
        "<way id='3'><nd ref='9'/><nd ref='10'/><nd ref='11'/><nd ref='9'/>"
        "<tag k='building' v='yes'/><tag k='building:levels' v='5'/></way>"
        "<relation id='7'><member type='way' ref='1' role='outer'/><member type='way' ref='2' role='inner'/>"
        "<tag k='type' v='multipolygon'/><tag k='building' v='yes'/><tag k='height' v='30'/></relation></osm>";
    load_well(write_file("town.osm", osm), NULL);
    const noc_report_file *f = noc_report_get_file(report, 0);
    assert_int_equal(f->buildings, 2);
    assert_int_equal(f->lamps, 1);
    assert_int_equal(f->buildings_unread, 0);
    seen s = look("relation/7");
    assert_float_equal(s.high - s.low, 30, 1e-4);
    assert_int_equal(s.wall_triangles, 2 * (4 + 3));
    s = look("way/3");
    assert_float_equal(s.high - s.low, 15, 1e-4);
}

/* What is left of buildings and streets has its causes, where they are read; a square is a street that is. */
static void test_left(void **state) {
    static const char osm[] =
        "<?xml version='1.0'?><osm version='0.6'>"
        "<node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.1' lon='11.5004'/>"
        "<node id='3' lat='48.1003' lon='11.5004'/><node id='4' lat='48.1004' lon='11.5'/>"
        "<way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='1'/><tag k='building' v='yes'/></way>"
        "<way id='2'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='1'/><tag k='building:part' v='yes'/></way>"
        "<way id='3'><nd ref='1'/><nd ref='2'/><nd ref='3'/><tag k='building' v='yes'/></way>"
        "<way id='4'><nd ref='1'/><nd ref='3'/><nd ref='4'/><nd ref='1'/><tag k='highway' v='pedestrian'/>"
        "<tag k='area' v='yes'/></way>"
        "<way id='5'><nd ref='1'/><nd ref='2'/><tag k='highway' v='construction'/></way></osm>";
    const char *path = write_file("left.osm", osm);
    for (int footprints = 1; footprints >= 0; footprints--) {
        noc_import_params params = noc_import_default_params();
        params.footprints = footprints;
        told[0] = 0;
        forget();
        scene = noc_scene_create(log_);
        noc_scene_load(scene, &path, 1, &params, &report);
        const char *wanted = footprints
                                 ? ": 1 part of a building, which lies in its outline; 1 outline that is not whole or "
                                   "underground; 1 street or path that is an area or not in use are not read\n"
                                 : ": 3 buildings; 1 street or path that is an area or not in use are not read: of "
                                   "maps only lamps and roads are read, and with --footprints buildings\n";
        if (!strstr(told, wanted))
            fail_msg("%s", told);
        assert_int_equal(noc_report_get_file(report, 0)->streets_unread, 1);
    }
}

/* A canopy alone on a map is no ground; a lamp whose head is below its bottom stands in free air, a taller one does
 * not. */
static void test_canopy(void **state) {
    char text[1200];
    (void)state;
    for (int height = 4; height < 8; height += 3) {
        snprintf(text, sizeof(text),
                 "<osm version=\"0.6\"><node id=\"1\" lat=\"52.3410\" lon=\"9.5320\"/>"
                 "<node id=\"2\" lat=\"52.3410\" lon=\"9.5324\"/><node id=\"3\" lat=\"52.3412\" lon=\"9.5324\"/>"
                 "<node id=\"4\" lat=\"52.3412\" lon=\"9.5320\"/><node id=\"21\" lat=\"52.3411\" lon=\"9.5322\">"
                 "<tag k=\"highway\" v=\"street_lamp\"/><tag k=\"height\" v=\"%d\"/></node>"
                 "<node id=\"22\" lat=\"52.34095\" lon=\"9.5322\"><tag k=\"highway\" v=\"street_lamp\"/></node>"
                 "<way id=\"100\"><nd ref=\"1\"/><nd ref=\"2\"/><nd ref=\"3\"/><nd ref=\"4\"/><nd ref=\"1\"/>"
                 "<tag k=\"building\" v=\"roof\"/><tag k=\"height\" v=\"8\"/><tag k=\"min_height\" v=\"6\"/></way>"
                 "</osm>",
                 height);
        load_as(true, write_file("canopy.osm", text));
        assert_int_equal(scene->lights.len, height < 6 ? 2 : 1);
        assert_int_equal(line(0, "lamp inside a building, further than 3 m from its outside"), height > 6);
        assert_float_equal(scene->lights.data[0].p[2], height < 6 ? 4 : 6, .05);
    }
}

static size_t of_class(noc_class cls) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    return info.triangles_by_class[cls];
}

#define AREA(id, key, value)                                                                                           \
    "<way id='" id "'><nd ref='4'/><nd ref='5'/><nd ref='7'/><nd ref='4'/><tag k='" key "' v='" value "'/></way>"

/* Roads, water and lawns of a map have surfaces where its buildings are drawn, and lamps stand on them; else where that
 * is asked for. */
static void test_map_surfaces(void **state) {
    static const char osm[] =
        "<?xml version='1.0'?><osm version='0.6'>"
        "<node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.1' lon='11.5004'/>"
        "<node id='3' lat='48.1003' lon='11.5004'/><node id='4' lat='48.0998' lon='11.4999'/>"
        "<node id='5' lat='48.0998' lon='11.5006'/><node id='6' lat='48.0998' lon='11.5002'>"
        "<tag k='highway' v='street_lamp'/></node><node id='7' lat='48.1005' lon='11.5006'/>"
        "<way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='1'/><tag k='building' v='yes'/></way>"
        "<way id='2'><nd ref='4'/><nd ref='5'/><tag k='highway' v='residential'/></way>"
        "<way id='3'><nd ref='5'/><nd ref='7'/><tag k='highway' v='footway'/></way>" AREA("4", "natural", "water")
            AREA("5", "leisure", "park") AREA("6", "landuse", "construction") "</osm>";
    const char *path = write_file("streets.osm", osm);
    noc_report_totals t;
    for (int wanted = NOC_SWITCH_OFF; wanted <= NOC_SWITCH_AUTO; wanted++)
        for (int footprints = 0; footprints < 2; footprints++) {
            surfaces = (noc_switch)wanted;
            load_as(footprints, path);
            bool drawn = wanted == NOC_SWITCH_ON || (wanted == NOC_SWITCH_AUTO && footprints);
            noc_report_get_totals(report, &t);
            assert_int_equal(t.roads_drawn, drawn ? 2 : 0);
            assert_int_equal(of_class(NOC_CLASS_ROAD) > 0, drawn);
            assert_int_equal(of_class(NOC_CLASS_SIDEWALK) > 0, drawn);
            assert_int_equal(of_class(NOC_CLASS_WATER) > 0, drawn);
            assert_int_equal(of_class(NOC_CLASS_GREEN) > 0, drawn);
            assert_int_equal(t.lamps_mapped, 1);
        }
    surfaces = NOC_SWITCH_AUTO;
}

/* A building of two ways around a yard, a lake, a square, a lawn, and a river that is a line. */
static const char areas_osm[] =
    "<?xml version='1.0'?><osm version='0.6'>"
    "<node id='1' lat='48.1' lon='11.5'/><node id='2' lat='48.1' lon='11.5004'/>"
    "<node id='3' lat='48.1004' lon='11.5004'/><node id='4' lat='48.1004' lon='11.5'/>"
    "<node id='5' lat='48.1001' lon='11.5001'/><node id='6' lat='48.1001' lon='11.5003'/>"
    "<node id='7' lat='48.1003' lon='11.5003'/><node id='8' lat='48.1' lon='11.501'/>"
    "<node id='9' lat='48.1004' lon='11.501'/><node id='10' lat='48.1004' lon='11.5006'/>"
    "<way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/></way><way id='2'><nd ref='1'/><nd ref='4'/><nd ref='3'/></way>"
    "<way id='3'><nd ref='5'/><nd ref='6'/><nd ref='7'/><nd ref='5'/></way>"
    "<way id='4'><nd ref='8'/><nd ref='9'/><nd ref='10'/><nd ref='8'/><tag k='natural' v='water'/></way>"
    "<way id='5'><nd ref='3'/><nd ref='2'/><nd ref='10'/><nd ref='3'/><tag k='highway' v='pedestrian'/>"
    "<tag k='area' v='yes'/></way>"
    "<way id='6'><nd ref='2'/><nd ref='8'/><nd ref='10'/><nd ref='2'/><tag k='leisure' v='park'/></way>"
    "<way id='7'><nd ref='2'/><nd ref='8'/><tag k='waterway' v='river'/></way>"
    "<way id='8'><nd ref='2'/><nd ref='8'/><tag k='highway' v='residential'/></way>"
    "<relation id='9'><member type='way' ref='1' role='outer'/><member type='way' ref='2' role='outer'/>"
    "<member type='way' ref='3' role='inner'/><tag k='type' v='multipolygon'/><tag k='building' v='yes'/>"
    "<tag k='height' v='30'/></relation></osm>";

#define NODE(id, lat, lon) "{\"type\":\"node\",\"id\":" id ",\"lat\":" lat ",\"lon\":" lon "},"
#define WAY(id, nodes, tags) "{\"type\":\"way\",\"id\":" id ",\"nodes\":[" nodes "],\"tags\":{" tags "}}"
#define MEMBER(id, role) "{\"type\":\"way\",\"ref\":" id ",\"role\":\"" role "\""
#define AT(lat, lon) "{\"lat\":" lat ",\"lon\":" lon "}"
#define BUILDING "\"tags\":{\"type\":\"multipolygon\",\"building\":\"yes\",\"height\":\"30\"}}"
#define RELATION(members) "{\"type\":\"relation\",\"id\":9,\"members\":[" members "]," BUILDING
#define ANSWER(elements) "{\"version\":0.6,\"generator\":\"Overpass API\",\"elements\":[" elements "]}"

/* clang-format off */
#define NODES                                                                                                          \
    NODE("1", "48.1", "11.5") NODE("2", "48.1", "11.5004") NODE("3", "48.1004", "11.5004")                             \
    NODE("4", "48.1004", "11.5") NODE("5", "48.1001", "11.5001") NODE("6", "48.1001", "11.5003")                       \
    NODE("7", "48.1003", "11.5003") NODE("8", "48.1", "11.501") NODE("9", "48.1004", "11.501")                         \
    NODE("10", "48.1004", "11.5006")
#define WAYS                                                                                                           \
    WAY("4", "8,9,10,8", "\"natural\":\"water\"") ","                                                                \
    WAY("5", "3,2,10,3", "\"highway\":\"pedestrian\",\"area\":\"yes\"") ","                                         \
    WAY("6", "2,8,10,2", "\"leisure\":\"park\"") "," WAY("7", "2,8", "\"waterway\":\"river\"") ","                 \
    WAY("8", "2,8", "\"highway\":\"residential\"")
static const char by_ways[] = ANSWER(NODES
    WAY("1", "1,2,3", "") "," WAY("2", "1,4,3", "") "," WAY("3", "5,6,7,5", "") "," WAYS ","
    RELATION(MEMBER("1", "outer") "}," MEMBER("2", "outer") "}," MEMBER("3", "inner") "}"));
static const char by_geometry[] = ANSWER(NODES WAYS ","
    RELATION(
    MEMBER("1", "outer") ",\"geometry\":[" AT("48.1", "11.5") "," AT("48.1", "11.5004") ","
        AT("48.1004", "11.5004") "]},"
    MEMBER("3", "inner") ",\"geometry\":[" AT("48.1001", "11.5001") "," AT("48.1001", "11.5003") ","
        AT("48.1003", "11.5003") "," AT("48.1001", "11.5001") "]},"
    MEMBER("2", "outer") ",\"geometry\":[" AT("48.1", "11.5") "," AT("48.1004", "11.5") ","
        AT("48.1004", "11.5004") "]}"));
/* clang-format on */

/* The same from Overpass, whose relations come with their ways, or with the geometry of those. */
static void test_overpass(void **state) {
    static const char *const answers[] = { by_ways, by_geometry };
    static const noc_class classes[] = { NOC_CLASS_WALL,  NOC_CLASS_ROOF, NOC_CLASS_WATER,
                                         NOC_CLASS_GREEN, NOC_CLASS_ROAD, NOC_CLASS_SIDEWALK };
    load_well(write_file("areas.osm", areas_osm), NULL);
    size_t triangles[NOC_COUNT(classes)];
    seen house = look("relation/9");
    for (size_t i = 0; i < NOC_COUNT(classes); i++)
        assert_true((triangles[i] = of_class(classes[i])) > 0);
    assert_int_equal(house.wall_triangles, 2 * (4 + 3));
    for (size_t k = 0; k < NOC_COUNT(answers); k++) {
        load_well(write_file("areas.json", answers[k]), NULL);
        const noc_report_file *f = noc_report_get_file(report, 0);
        seen s = look("relation/9");
        for (size_t i = 0; i < NOC_COUNT(classes); i++)
            assert_int_equal(of_class(classes[i]), triangles[i]);
        assert_int_equal(s.wall_triangles, house.wall_triangles);
        assert_float_equal(s.roof_area, house.roof_area, 1e-2);
        assert_float_equal(s.high - s.low, 30, 1e-4);
        assert_true(f->buildings == 1 && f->buildings_unread == 0 && f->roads == 1 && f->line_count == 1);
    }
}

/* clang-format off */
static const char left_out[] = ANSWER(NODES
    WAY("4", "8,9,77,8", "\"natural\":\"water\"") ","
    WAY("5", "1,2,3,1", "\"building\":\"yes\"") ","
    "{\"type\":\"way\",\"id\":6,\"nodes\":[1,2,3,1],\"tags\":{\"landuse\":\"grass\"},"
        "\"geometry\":[" AT("1", "2") ",null," AT("1", "3") "," AT("1", "2") "]},"
    RELATION(MEMBER("5", "outer") "}," MEMBER("99", "inner") "}") ","
    RELATION(MEMBER("1", "outer") ",\"geometry\":[" AT("48.1", "11.5") "," AT("48.1", "11.5004") "]}"));
/* clang-format on */

/* What cannot be drawn is counted by its reason. */
static void test_overpass_left_out(void **state) {
    load_well(write_file("left.json", left_out), NULL);
    assert_int_equal(line(0, "area without the points of its outline: ask for it with \"out geom\""), 3);
    assert_int_equal(line(0, "multipolygon whose ways do not close"), 1);
    assert_true(look("way/5").meshes && !look("relation/9").meshes);
    assert_true(!of_class(NOC_CLASS_WATER) && !of_class(NOC_CLASS_GREEN));
    assert_int_equal(noc_report_get_file(report, 0)->buildings_unread, 2);
}

static int start(void **state) {
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    return !mkdtemp(folder);
}

static int finish(void **state) {
    forget();
    noc_log_destroy(log_);
    return remove_folder();
}
#endif

int main(void) {
#if NOC_HAVE_GDAL
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blocks),       cmocka_unit_test(test_facing),   cmocka_unit_test(test_model_and_terrain),
        cmocka_unit_test(test_layer),        cmocka_unit_test(test_osm),      cmocka_unit_test(test_canopy),
        cmocka_unit_test(test_left),         cmocka_unit_test(test_units),    cmocka_unit_test(test_use),
        cmocka_unit_test(test_map_surfaces), cmocka_unit_test(test_overpass), cmocka_unit_test(test_overpass_left_out),
    };
    return cmocka_run_group_tests_name("import/footprints", tests, start, finish);
#else
    print_message("1..0 # SKIP without GDAL\n");
    return 0;
#endif
}
