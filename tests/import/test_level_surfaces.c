/* Roads, lawns and water at heights that are none, beside buildings that tell where the ground is; blocks that begin in
 * the air. */
#include "base/base.h"
#include "scene/scene.h"

#include "../told.h"
#include "noc_config.h"

#include <math.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-level-surfaces-XXXXXX";
#include "../folder.h"
static noc_log *log_;

/* ---- a model ---- */

typedef struct model {
    char objects[12000], vertices[12000];
    int vertex_count, object_count;
} model;

static int vertex(model *m, double x, double y, double z) {
    size_t n = strlen(m->vertices);
    snprintf(m->vertices + n, sizeof(m->vertices) - n, "%s[%.3f,%.3f,%.3f]", n ? "," : "", x, y, z);
    return m->vertex_count++;
}

static void object(model *m, const char *id, const char *type, const char *boundaries) {
    size_t n = strlen(m->objects);
    snprintf(m->objects + n, sizeof(m->objects) - n,
             "%s\"%s\":{\"type\":\"%s\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[%s]}]}",
             n ? "," : "", id, type, boundaries);
}

static void flat(model *m, const char *id, const char *type, double x, double y, double z, double wide, double deep) {
    char text[100];
    int a = vertex(m, x, y, z);
    vertex(m, x + wide, y, z);
    vertex(m, x + wide, y + deep, z);
    vertex(m, x, y + deep, z);
    snprintf(text, sizeof(text), "[[%d,%d,%d,%d]]", a, a + 1, a + 2, a + 3);
    object(m, id, type, text);
}

/* An outline of 10 m by 10 m, of a building that is so high. */
static void outline(model *m, const char *id, double x, double y, double z, double high) {
    size_t n = strlen(m->objects);
    int a = vertex(m, x, y, z);
    vertex(m, x + 10, y, z);
    vertex(m, x + 10, y + 10, z);
    vertex(m, x, y + 10, z);
    snprintf(m->objects + n, sizeof(m->objects) - n,
             "%s\"%s\":{\"type\":\"Building\",\"attributes\":{\"measuredHeight\":%g},\"geometry\":[{\"type\":"
             "\"MultiSurface\",\"lod\":\"0\",\"boundaries\":[[[%d,%d,%d,%d]]]}]}",
             n ? "," : "", id, high, a, a + 1, a + 2, a + 3);
}

/* A block of 10 m by 10 m. */
static void block(model *m, double x, double y, double foot, double top) {
    char text[300], id[20];
    int a = m->vertex_count;
    for (int i = 0; i < 2; i++) {
        vertex(m, x, y, i ? top : foot);
        vertex(m, x + 10, y, i ? top : foot);
        vertex(m, x + 10, y + 10, i ? top : foot);
        vertex(m, x, y + 10, i ? top : foot);
    }
    snprintf(text, sizeof(text), "[[%d,%d,%d,%d]],[[%d,%d,%d,%d]],[[%d,%d,%d,%d]],[[%d,%d,%d,%d]],[[%d,%d,%d,%d]]", a,
             a + 1, a + 5, a + 4, a + 1, a + 2, a + 6, a + 5, a + 2, a + 3, a + 7, a + 6, a + 3, a, a + 4, a + 7, a + 4,
             a + 5, a + 6, a + 7);
    snprintf(id, sizeof(id), "block %d", m->object_count++);
    object(m, id, "Building", text);
}

/* Two rows of blocks along a street that climbs from `foot` by `climb`. */
static model street(double foot, double climb) {
    model m = { .vertex_count = 0 };
    for (int i = 0; i < 5; i++)
        for (int side = 0; side < 2; side++)
            block(&m, 20 * i, side ? 22 : 0, foot + climb * i / 4, foot + climb * i / 4 + 12);
    return m;
}

/* lamps: a table; NULL: none */
static noc_scene *load_with(const model *m, const char *lamps, const char *crs, bool strict, noc_status expected) {
    static char text[25000];
    snprintf(text, sizeof(text),
             "{\"type\":\"CityJSON\",\"version\":\"2.0\",%s\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},"
             "\"CityObjects\":{%s},\"vertices\":[%s]}",
             crs, m->objects, m->vertices);
    noc_scene *s = noc_scene_create(log_);
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    p.infer_lamps = NOC_SWITCH_OFF;
    p.strict = strict;
    p.crs = lamps ? "EPSG:25832" : NULL;
    const char *paths[] = { write_file("model.city.json", text), lamps ? write_file("lamps.csv", lamps) : NULL };
    told[0] = 0;
    if (noc_scene_load(s, paths, lamps ? 2 : 1, &p, NULL) != expected)
        fail_msg("%s", told);
    return s;
}

static noc_scene *load(const model *m, const char *crs, bool strict, noc_status expected) {
    return load_with(m, NULL, crs, strict, expected);
}

/* Lowest and highest corner of the object's surfaces. */
static void heights_of(const noc_scene *s, const char *name, double *lo, double *hi) {
    *lo = INFINITY;
    *hi = -INFINITY;
    for (size_t i = 0; i < s->meshes.len; i++)
        for (size_t v = s->meshes.data[i].first_vertex; v < noc_mesh_end_vertex(s, i); v++)
            if (s->meshes.data[i].name && !strcmp(s->meshes.data[i].name, name)) {
                *lo = NOC_MIN(*lo, (double)s->positions.data[3 * v + 2]);
                *hi = NOC_MAX(*hi, (double)s->positions.data[3 * v + 2]);
            }
    assert_true(*lo <= *hi);
}

static void expect_height(const noc_scene *s, const char *name, double lo, double hi, double slack) {
    double a, b, z = s->origin[2];
    heights_of(s, name, &a, &b);
    if (fabs(a + z - lo) > slack || fabs(b + z - hi) > slack)
        fail_msg("%s lies at %g to %g m", name, a + z, b + z);
}

#define UTM "\"metadata\":{\"referenceSystem\":\"https://www.opengis.net/def/crs/EPSG/0/25832\"},"

/* ---- heights that are none ---- */

static void laid_at_the_feet(void **state) {
    (void)state;
    model m = street(40, 0);
    flat(&m, "road", "Road", -5, 12, 0, 100, 8);
    flat(&m, "lawn", "LandUse", 12, 0, 0, 6, 10);
    flat(&m, "pond", "WaterBody", 32, 0, 0, 6, 10);
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "road", 40, 40, 0.05);
    expect_height(s, "lawn", 40, 40, 0.05);
    expect_height(s, "pond", 40, 40, 0.05);
    assert_non_null(strstr(told,
                           "3 surfaces of roads, lawns or water, such as \"road\", level at 0.00 m, 40 m below what "
                           "stands around"));
    assert_true(s->bounds_min[2] + s->origin[2] > 39);
    noc_scene_destroy(s);
    s = load(&m, "", true, NOC_ERR_FORMAT);
    assert_non_null(strstr(told, "surface at a height that is none"));
    noc_scene_destroy(s);
}

/* Where the feet climb, what is laid climbs with them. */
static void laid_along_a_slope(void **state) {
    (void)state;
    model m = street(100, 8);
    flat(&m, "low end", "Road", 0, 12, 0, 5, 8);
    flat(&m, "high end", "Road", 85, 12, 0, 5, 8);
    noc_scene *s = load(&m, UTM, false, NOC_OK);
    expect_height(s, "low end", 100.3, 100.6, 0.7);
    expect_height(s, "high end", 107.4, 107.7, 0.7);
    noc_scene_destroy(s);
}

static void laid_on_terrain(void **state) {
    (void)state;
    model m = street(40, 0);
    flat(&m, "terrain", "TINRelief", -50, -50, 38.5, 200, 150);
    flat(&m, "road", "Road", -40, 12, 0, 100, 8);
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "road", 38.52, 38.52, 0.01);
    noc_scene_destroy(s);
}

/* A ridge of terrain 8 m high across a road of two triangles; beyond it a ditch as deep. */
static double ridge(double x) { return 40 + 8 * exp(-pow((x - 30) / 10, 2)) - 8 * exp(-pow((x - 80) / 10, 2)); }

static void follows_the_terrain(void **state) {
    (void)state;
    model m = { .vertex_count = 0 };
    char boundaries[4000], *end = boundaries;
    for (int i = 0; i <= 22; i++)
        for (int side = 0; side < 2; side++)
            vertex(&m, 5 * i, 40 * side, ridge(5 * i));
    for (int i = 0; i < 22; i++)
        end += sprintf(end, "%s[[%d,%d,%d]],[[%d,%d,%d]]", i ? "," : "", 2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3,
                       2 * i + 1);
    object(&m, "terrain", "TINRelief", boundaries);
    flat(&m, "road", "Road", 2, 15, 0, 106, 10);
    noc_scene *s = load(&m, "", false, NOC_OK);
    double above[2] = { INFINITY, -INFINITY }, z, ground;
    for (int i = 0; i < 2000; i++) {
        double x = 2.5 + 105 * (i % 200) / 200. - s->origin[0], y = 15.5 + 9 * (i / 200) / 10. - s->origin[1];
        assert_true(noc_scene_highest(s, 1u << NOC_CLASS_TERRAIN, x, y, &ground));
        assert_true(noc_scene_highest(s, 1u << NOC_CLASS_ROAD, x, y, &z));
        above[0] = NOC_MIN(above[0], z - ground);
        above[1] = NOC_MAX(above[1], z - ground);
    }
    if (above[0] < -0.06 || above[1] > 0.1) /* edges of less than a metre stay, on a slope of 0.7 */
        fail_msg("the road is %g to %g m above the terrain", above[0], above[1]);
    double lo, hi;
    heights_of(s, "road", &lo, &hi);
    assert_true(fabs(hi - 48.02) < 0.15 && fabs(lo - 32.02) < 0.15);
    noc_scene_destroy(s);
}

/* Where the terrain ends the road goes on as high. */
static void laid_beyond_terrain(void **state) {
    (void)state;
    model m = { .vertex_count = 0 };
    flat(&m, "terrain", "TINRelief", 0, 0, 38.5, 50, 50);
    flat(&m, "road", "Road", 20, 12, 0, 100, 8);
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "road", 38.52, 38.52, 0.01);
    noc_scene_destroy(s);
}

/* Of a height that is not 0 many agree. */
static void another_height(void **state) {
    (void)state;
    model m = street(40, 0);
    char id[20];
    for (int i = 0; i < 12; i++) {
        snprintf(id, sizeof(id), "road %d", i);
        flat(&m, id, "Road", 8 * i, 12, -99, 8, 8);
    }
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "road 7", 40, 40, 0.05);
    noc_scene_destroy(s);
}

/* Buildings of which there are outlines alone. */
static void outlines_put_on_the_ground(void **state) {
    (void)state;
    static const double none[] = { 0, -9999, -32768, 1e6 };
    for (size_t i = 0; i < NOC_COUNT(none); i++) {
        model m = street(40, 0);
        outline(&m, "house", 100, 0, none[i], 10);
        outline(&m, "hall", 100, 22, none[i], 25);
        outline(&m, "flat one", 120, 0, none[i], 0);
        noc_scene *s = load(&m, "", false, NOC_OK);
        expect_height(s, "house", 40, 50, 0.05);
        expect_height(s, "hall", 40, 65, 0.05);
        expect_height(s, "flat one", 40, 40, 0.05);
        assert_non_null(strstr(told, "3 outlines of buildings, such as \"house\", level at 0.00 m, 40 m below"));
        assert_true(s->bounds_min[2] + s->origin[2] > 39);
        noc_scene_destroy(s);
        s = load(&m, "", true, NOC_ERR_FORMAT);
        assert_non_null(strstr(told, "outline of a building at a height that is none, put on the ground"));
        noc_scene_destroy(s);
    }
    model m = { .vertex_count = 0 };
    flat(&m, "terrain", "TINRelief", -50, -50, 38.5, 200, 150);
    outline(&m, "house", 0, 0, 0, 10);
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "house", 38.5, 48.5, 0.01);
    noc_scene_destroy(s);
    model hill = street(100, 8); /* 80 m to the top */
    outline(&hill, "low", -20, 0, 0, 10);
    outline(&hill, "high", 100, 0, 0, 10);
    s = load(&hill, UTM, false, NOC_OK);
    expect_height(s, "low", 100, 110, 0.7);
    expect_height(s, "high", 107.5, 117.5, 0.7);
    noc_scene_destroy(s);
}

/* Heights such as -9999: of flat surfaces they are missing, other ones are left out. */
static void numbers_that_stand_for_none(void **state) {
    (void)state;
    model m = street(40, 0);
    flat(&m, "road", "Road", -5, 12, -9999, 100, 8);
    flat(&m, "pond", "WaterBody", 32, 0, 1e6, 6, 10);
    block(&m, 100, 0, -9999, 52);
    noc_scene *s = load(&m, "", false, NOC_OK);
    expect_height(s, "road", 40, 40, 0.05);
    expect_height(s, "pond", 40, 40, 0.05);
    assert_true(s->bounds_min[2] + s->origin[2] > 39);
    noc_scene_destroy(s);
    s = load(&m, "", true, NOC_ERR_FORMAT);
    assert_non_null(strstr(told, "surface at a height such as -9999, taken as missing (road at -9999, pond at 1e+06)"));
    assert_non_null(strstr(told, "4 x surface with corners at heights such as -9999 (block 10 at -9999)"));
    noc_scene_destroy(s);
}

/* Of lamps, too, with a city and alone. */
static void elevations_that_are_none(void **state) {
    (void)state;
    model m = { .vertex_count = 0 };
    for (int i = 0; i < 8; i++)
        block(&m, 690000 + 20 * (i / 2), 5330000 + 22 * (i % 2), 40, 52);
    static const char text[] = "id,x,y,ele,lamp_height\na,690015,5330016,40,8\nb,690035,5330016,-9999,8\n"
                               "c,690055,5330016,1e6,8\nd,690075,5330016,-32768,8\n";
    noc_scene *s = load_with(&m, text, UTM, false, NOC_OK);
    assert_int_equal(s->lights.len, 4);
    for (size_t i = 0; i < 4; i++)
        if (fabs(s->lights.data[i].p[2] + s->origin[2] - 47.98) > 0.05)
            fail_msg("a lamp hangs at %g m", s->lights.data[i].p[2] + s->origin[2]);
    noc_scene_destroy(s);
    s = noc_scene_create(log_);
    noc_import_params p = noc_import_default_params();
    p.crs = "EPSG:25832";
    const char *path = in_folder("lamps.csv");
    noc_report *report;
    assert_int_equal(noc_scene_load(s, &path, 1, &p, &report), NOC_OK);
    for (size_t i = 0; i < 4; i++)
        assert_true(fabs(s->lights.data[i].p[2] + s->origin[2] - 47.98) < 0.05);
    const noc_report_line *line = noc_report_get_file(report, 0)->lines;
    assert_string_equal(line->reason, "elevation of a lamp such as -9999, taken as missing");
    assert_string_equal(line->examples, "b at -9999, c at 1e+06, d at -32768");
    noc_report_destroy(report);
    noc_scene_destroy(s);
}

/* ---- heights that are some ---- */

static void outlines_left_where_they_lie(void **state) {
    (void)state;
    model sea = street(1.5, 0), own = street(40, 0), far = street(40, 0), alone = { .vertex_count = 0 };
    outline(&sea, "house", 100, 0, 0, 10);
    outline(&own, "house", 100, 0, 39, 10);
    outline(&far, "house", 800, 0, 0, 10);
    outline(&alone, "house", 100, 0, 0, 10);
    const struct {
        const model *m;
        double z;
    } rows[] = { { &sea, 0 }, { &own, 39 }, { &far, 0 }, { &alone, 0 } };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_scene *s = load(rows[i].m, "", false, NOC_OK);
        expect_height(s, "house", rows[i].z, rows[i].z + 10, 1e-3);
        assert_null(strstr(told, "level at"));
        noc_scene_destroy(s);
    }
}

static void left_where_it_lies(void **state) {
    (void)state;
    model low = street(1.5, 0), lake = street(40, 0), own = street(40, 0), over = street(40, 0), far = street(40, 0);
    flat(&low, "road", "Road", -5, 12, 0, 100, 8); /* beside the sea */
    flat(&lake, "lake", "WaterBody", -300, 12, 0, 280, 8);
    flat(&own, "road", "Road", -5, 12, 39, 100, 8);
    flat(&over, "bridge", "Road", -5, 12, 60, 100, 8); /* one deck: not many */
    flat(&far, "road", "Road", 600, 12, 0, 100, 8);    /* in a valley, maybe */
    const struct {
        const model *m;
        const char *name;
        double z;
    } rows[] = {
        { &low, "road", 0 }, { &lake, "lake", 0 }, { &own, "road", 39 }, { &over, "bridge", 60 }, { &far, "road", 0 }
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_scene *s = load(rows[i].m, "", false, NOC_OK);
        expect_height(s, rows[i].name, rows[i].z, rows[i].z, 1e-3);
        assert_null(strstr(told, "level at"));
        noc_scene_destroy(s);
    }
}

/* The model and the lamps of a report (PLATEAU-SDK-for-Unity 2): lamps stand as if the road were at 40 m. */
static void lamps_of_a_report(void **state) {
    (void)state;
    const char *shared = getenv("NOC_SHARED");
    char city[300], lamps[300];
    snprintf(city, sizeof(city), "%s/data/cases3/plateau_road0.gml", shared ? shared : "");
    snprintf(lamps, sizeof(lamps), "%s/data/cases3/plateau_road0_lamps.geojson", shared ? shared : "");
    if (access(city, R_OK))
        skip();
    noc_scene *s = noc_scene_create(log_);
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    const char *paths[] = { city, lamps };
    assert_int_equal(noc_scene_load(s, paths, 2, &p, NULL), NOC_OK);
    assert_int_equal(s->lights.len, 4);
    for (size_t i = 0; i < 4; i++)
        assert_true(fabs(s->lights.data[i].p[2] + s->origin[2] - 45.95) < 0.15);
    noc_scene_destroy(s);
}

/* ---- blocks that begin in the air ---- */

static void block_in_the_air(const char *key, const char *value) {
    char text[2000];
    noc_scene *s = noc_scene_create(log_);
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    p.infer_lamps = NOC_SWITCH_OFF;
    p.footprints = true;
    snprintf(
        text, sizeof(text),
        "<osm version='0.6'><node id='1' lat='51.5' lon='-0.1'/><node id='2' lat='51.5' lon='-0.0997'/>"
        "<node id='3' lat='51.5002' lon='-0.0997'/><node id='4' lat='51.5002' lon='-0.1'/>"
        "<node id='5' lat='51.5004' lon='-0.1'/><node id='6' lat='51.5004' lon='-0.0997'/>"
        "<node id='7' lat='51.5006' lon='-0.0997'/><node id='8' lat='51.5006' lon='-0.1'/>"
        "<node id='9' lat='51.5003' lon='-0.09985'><tag k='highway' v='street_lamp'/><tag k='height' v='8'/></node>"
        "<node id='10' lat='51.5005' lon='-0.09965'><tag k='highway' v='street_lamp'/><tag k='height' v='8'/></node>"
        "<way id='1'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='4'/><nd ref='1'/><tag k='building' v='yes'/>"
        "<tag k='height' v='20'/></way><way id='2'><nd ref='5'/><nd ref='6'/><nd ref='7'/><nd ref='8'/><nd ref='5'/>"
        "<tag k='building' v='yes'/><tag k='height' v='30'/><tag k='%s' v='%s'/></way></osm>",
        key, value);
    const char *paths[] = { write_file("map.osm", text) };
    assert_int_equal(noc_scene_load(s, paths, 1, &p, NULL), NOC_OK);
    assert_int_equal(s->lights.len, 2);
    for (size_t i = 0; i < 2; i++) /* the disc of a lamp 8 m high */
        if (fabs(s->lights.data[i].p[2] + s->origin[2] - 7.98) > 0.1)
            fail_msg("a lamp hangs at %g m", s->lights.data[i].p[2]);
    double lo, hi;
    heights_of(s, "foundations", &lo, &hi); /* no skirt closes the passage */
    assert_true(hi < 1);
    heights_of(s, "ground", &lo, &hi);
    assert_true(hi - lo < 0.1);
    noc_scene_destroy(s);
}

static void blocks_in_the_air(void **state) {
    (void)state;
#if !NOC_HAVE_GDAL
    skip(); /* maps in XML are read by it */
#endif
    block_in_the_air("building:min_level", "5");
    block_in_the_air("min_level", "5");
    block_in_the_air("min_height", "15");
    block_in_the_air("min_height", "49 ft");
    block_in_the_air("building:min_height", "15 m");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laid_at_the_feet),
        cmocka_unit_test(laid_along_a_slope),
        cmocka_unit_test(laid_on_terrain),
        cmocka_unit_test(follows_the_terrain),
        cmocka_unit_test(laid_beyond_terrain),
        cmocka_unit_test(another_height),
        cmocka_unit_test(left_where_it_lies),
        cmocka_unit_test(outlines_put_on_the_ground),
        cmocka_unit_test(numbers_that_stand_for_none),
        cmocka_unit_test(outlines_left_where_they_lie),
        cmocka_unit_test(elevations_that_are_none),
        cmocka_unit_test(lamps_of_a_report),
        cmocka_unit_test(blocks_in_the_air),
    };
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(log_);
    return remove_folder() || failed;
}
