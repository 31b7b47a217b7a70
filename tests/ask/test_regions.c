/* Regions by what people call them: places, pixels, objects, streets and polygons; and what is said where one is wrong.
 */
#include "../render/rooms.h"

#include "scene/region.h"

#include <nocturne/influence.h>
#include <nocturne/text.h>
#include <unistd.h>

static char told[512];
static void keep_message(void *user, noc_log_level level, const char *text) {
    (void)user;
    if (level <= NOC_LOG_WARN)
        noc_snprintf(told, sizeof(told), "%s", text);
}

#define Q(name, m, px, py, pz, ax, ay, az, bx, by, bz)                                                                 \
    named_quad(s, m, name, (double[3]){ px, py, pz }, (double[3]){ ax, ay, az }, (double[3]){ bx, by, bz })

/* Terrain, a road of 6 m along x with a car on it, a house with a wall towards it and a roof, a pane of glass over the
 * terrain, and a street's name. */
static noc_scene *town(noc_log *log) {
    noc_scene *s = noc_scene_create(log);
    int terrain = grey_of(s, NOC_CLASS_TERRAIN), road = grey_of(s, NOC_CLASS_ROAD), wall = grey_of(s, NOC_CLASS_WALL),
        roof = grey_of(s, NOC_CLASS_ROOF), car = grey_of(s, NOC_CLASS_VEHICLE);
    Q("ground", terrain, -50, -50, 0, 100, 0, 0, 0, 100, 0);
    Q("way/1", road, -40, 3, 0.02, 80, 0, 0, 0, -6, 0); /* wound downwards */
    Q("house 7", wall, -5, 6, 0, 10, 0, 0, 0, 0, 4);
    Q("house 7", roof, -5, 6, 4, 10, 0, 0, 0, 8, 0);
    Q("car", car, 0, -1, 1, 4, 0, 0, 0, 2, 0);
    int glass = noc_scene_add_material(s, &(noc_material){
                                              .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1, .transmittance = 0.7f });
    Q("pane", glass, -6, -6, 2, 2, 0, 0, 0, 2, 0);
    point_light(s, 0, 0, 6, 100);
    const double line[] = { -40, 0, NAN, 40, 0, NAN };
    assert_true(noc_scene_add_street(s, &(noc_scene_street){ "Main Street", "way/1", 6, 0, 0 }, line, 2));
    static const char *const others[] = { "M\xc3\xbcllerstra\xc3\x9f"
                                          "e",
                                          "Hinterstr.",
                                          "Gro\xc3\x9f"
                                          "e Gasse" };
    for (size_t i = 0; i < NOC_COUNT(others); i++)
        assert_true(noc_scene_add_street(s, &(noc_scene_street){ others[i], "way/2", 6, 0, 0 }, line, 2));
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

typedef struct world {
    noc_log *log;
    noc_scene *scene;
    noc_view *view;
    noc_camera camera;
} world;

static int open_world(void **state) {
    static world w;
    w.log = noc_log_create(&(noc_log_params){ NOC_LOG_WARN, keep_message, NULL });
    w.scene = town(w.log);
    w.view = own_view(w.scene, 2, w.log);
    w.camera = look(0, 0, 40, 0, 0, 0, 20);
    w.camera.up[1] = 1, w.camera.up[2] = 0;
    *state = &w;
    return w.view == NULL;
}

static int close_world(void **state) {
    world *w = *state;
    close_view(w->view);
    noc_scene_destroy(w->scene);
    noc_log_destroy(w->log);
    return 0;
}

static noc_region *find(const world *w, const char *text, noc_region_info *info) {
    noc_region_params p = { .camera = &w->camera, .width = 100, .height = 100, .files = true };
    told[0] = 0;
    noc_region *r = noc_region_find(w->view, w->scene, text, &p, w->log);
    noc_region_get_info(r, info);
    return r;
}

static void places_face_as_they_are_said(void **state) {
    const world *w = *state;
    noc_region_info i;
    noc_region *r = find(w, "point:20,20", &i);
    assert_true(i.point && fabs(i.centre[2]) < 1e-6 && r->patches.data[0].n[2] > 0.999f);
    noc_region_destroy(r);
    r = find(w, "point:20,0", &i); /* the road above the terrain */
    assert_true(i.point && fabs(i.centre[2] - 0.02) < 1e-6 && r->patches.data[0].n[2] > 0.999f);
    noc_region_destroy(r);
    r = find(w, "point:1,2,3,0,-2,0", &i);
    assert_true(i.point && i.centre[2] == 3 && r->patches.data[0].n[1] == -1);
    noc_region_destroy(r);
    r = find(w, "pixel:50,50", &i);
    assert_true(i.point && fabs(i.centre[0]) < 0.2 && fabs(i.centre[1]) < 0.2 && i.centre[2] < 1.001);
    noc_region_destroy(r);
    r = find(w, "pixel:12,87", &i); /* the pane and what is seen through it, as much as each is in the picture */
    assert_true(i.patches == 2 && fabs(r->patches.data[0].weight - 0.3) < 1e-6 && r->patches.data[0].p[2] == 2);
    assert_true(fabs(r->patches.data[1].weight - 0.7) < 1e-6 && r->patches.data[1].p[2] == 0);
    noc_region_destroy(r);
    r = find(w, "rect:10,10,59,19", &i);
    assert_int_equal(i.patches, 500);
    noc_region_destroy(r);
}

/* On the equator at the middle of zone 32: 500000 E, 0 N by the definition of UTM, and scaled by 0.9996 there. */
static void points_in_another_crs(void **state) {
    const world *w = *state;
    noc_scene *s = noc_scene_create(w->log);
    int terrain = grey_of(s, NOC_CLASS_TERRAIN);
    assert_int_equal(noc_scene_set_crs(s, "EPSG:32632", (double[3]){ 500000, 0, 0 }), NOC_OK);
    Q("ground", terrain, -50, -50, 0, 100, 0, 0, 0, 100, 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    const world other = { w->log, s, own_view(s, 2, w->log), w->camera };
    const double east = 0.9996 * 6378137 * 1e-4 * M_PI / 180;
    static const struct {
        const char *text;
        double x, z;
    } points[] = { { "point:9.0001,0,EPSG:4326", 1, 0 },
                   { "point:9.0001,0,3, OGC:CRS84", 1, 3 },
                   { "point:9.0001,0,3,0,0,-1,EPSG:4326", 1, 3 },
                   { "point:500000,0", 0, 0 } };
    for (size_t k = 0; k < NOC_COUNT(points); k++) {
        noc_region_info i;
        noc_region *r = find(&other, points[k].text, &i);
        if (!r)
            fail_msg("%s: %s", points[k].text, told);
        assert_true(fabs(i.centre[0] - points[k].x * east) < 1e-3 && fabs(i.centre[1]) < 1e-3);
        assert_true(fabs(i.centre[2] - points[k].z) < 1e-3);
        noc_region_destroy(r);
    }
    static const struct {
        const char *text, *says;
    } wrong[] = { { "point:-600000,0", "in EPSG:32632 it lies more than 1000 km away" },
                  { "point:0,50,EPSG:4326", "whose CRS is EPSG:32632" },
                  { "point:9.0001,0,EPSG:4326x", "EPSG:4326x" } };
    for (size_t k = 0; k < NOC_COUNT(wrong); k++) {
        noc_region_info i;
        assert_null(find(&other, wrong[k].text, &i));
        if (!strstr(told, wrong[k].says))
            fail_msg("%s: %s", wrong[k].text, told);
    }
    close_view(other.view);
    noc_scene_destroy(s);
}

static void objects_are_their_surfaces_by_area(void **state) {
    const world *w = *state;
    noc_region_info i;
    noc_region *r = find(w, "object:house 7", &i);
    assert_int_equal(i.patches, 4);
    assert_true(fabs(i.weight - 40 - 80) < 1e-3);
    noc_region_destroy(r);
    noc_region_params p = { .classes = 1u << NOC_CLASS_WALL };
    r = noc_region_find(w->view, w->scene, "object:house 7", &p, w->log);
    noc_region_get_info(r, &i);
    assert_true(i.patches == 2 && fabs(i.weight - 40) < 1e-3 && r->patches.data[0].n[1] < -0.999f);
    noc_region_destroy(r);
    r = find(w, "object:way/1", &i); /* what lies on the ground faces up */
    assert_true(r->patches.data[0].n[2] > 0.999f && fabs(i.weight - 480) < 1e-2);
    noc_region_destroy(r);
    p.classes = 1u << NOC_CLASS_WINDOW;
    assert_null(noc_region_find(w->view, w->scene, "object:house 7", &p, w->log));
    assert_non_null(strstr(told, "no such surfaces"));
}

/* Points of streets and polygons lie on what is seen from above, through the car, and stand for their area. */
static void ground_is_what_is_seen_from_above(void **state) {
    const world *w = *state;
    noc_region_info i;
    noc_region *r = find(w, "street:main street", &i);
    assert_true(fabs(i.weight / 480 - 1) < 0.03 && i.patches > 5000);
    for (size_t k = 0; k < r->patches.len; k++)
        assert_true(fabsf(r->patches.data[k].p[1]) <= 3 && fabsf(r->patches.data[k].p[2] - 0.02f) < 1e-5f);
    noc_region_destroy(r);
    r = find(w, "polygon:POLYGON((-10 5, 10 5, 10 20, -10 20, -10 5), (6 6, 8 6, 8 8, 6 8, 6 6))", &i);
    assert_true(fabs(i.weight / (300 - 80 - 4) - 1) < 0.03); /* the house covers its ground, a hole is none */
    noc_region_destroy(r);
    r = find(w, "polygon:MULTIPOLYGON Z (((30 10 5, 40 10 5, 40 20 5)), ((-40 10 1, -30 10 1, -40 20 1)))", &i);
    assert_true(fabs(i.weight / 100 - 1) < 0.03);
    noc_region_destroy(r);
}

/* A ring of a million corners, in the time that the ground takes; and one that crosses itself is its odd parts. */
static void polygons_may_have_many_corners(void **state) {
    const world *w = *state;
    enum { CORNERS = 1000000, PLACE = 32 };
    char *text = malloc(PLACE * (size_t)CORNERS + 64), *at = text;
    at += sprintf(at, "polygon:POLYGON((");
    for (int i = 0; i < CORNERS; i++) {
        double bearing = 2 * M_PI * i / CORNERS, r = 10 + 0.001 * (i % 7);
        at += sprintf(at, "%s%.6f %.6f", i ? ", " : "", 25 + r * cos(bearing), 30 + r * sin(bearing));
    }
    strcpy(at, "))");
    noc_region_info i;
    noc_region *r = find(w, text, &i);
    assert_true(fabs(i.weight / (M_PI * 100) - 1) < 0.03);
    noc_region_destroy(r);
    free(text);
    r = find(w, "polygon:POLYGON((10 20, 30 40, 30 20, 10 40))", &i); /* an hourglass */
    assert_true(fabs(i.weight / 200 - 1) < 0.03);
    noc_region_destroy(r);
}

/* As people write names: what is taken is said. A name that is there is taken without a word. */
static void streets_are_found_as_people_spell_them(void **state) {
    const world *w = *state;
    static const char *const spelt[][2] = { { "MAIN  street", "Main Street" },
                                            { "Muellerstr.", "M\xc3\xbcllerstra" },
                                            { "mullerstrasse", "M\xc3\xbcllerstra" },
                                            { "Mu\xcc\x88llerstr", "M\xc3\xbc" },
                                            { "Hinterstra\xc3\x9f"
                                              "e",
                                              "Hinterstr." },
                                            { "Grosse-Gasse", "Gro\xc3\x9f" } };
    for (size_t i = 0; i < NOC_COUNT(spelt); i++) {
        noc_region_info info;
        char text[64], says[64];
        noc_snprintf(text, sizeof(text), "street:%s", spelt[i][0]);
        noc_snprintf(says, sizeof(says), "is taken for \"%s", spelt[i][1]);
        noc_region *r = find(w, text, &info);
        if (!r || !strstr(told, says))
            fail_msg("%s: %s", text, told);
        noc_region_destroy(r);
    }
    noc_region_info info;
    noc_region_destroy(find(w,
                            "street:m\xc3\xbcllerstra\xc3\x9f"
                            "e",
                            &info));
    assert_string_equal(told, "");
    static const char *const folded[][2] = { { "\xc4\x8c"
                                               "esk\xc3\xa1 t\xc5\x99\xc3\xad"
                                               "da",
                                               "ceska trida" },
                                             { "\xc5\x81\xc3\xb3"
                                               "d\xc5\xba",
                                               "lodz" } };
    for (size_t i = 0; i < NOC_COUNT(folded); i++) {
        char *name = noc_text_fold(folded[i][0], true);
        assert_string_equal(name, folded[i][1]);
        free(name);
    }
}

/* A box of 2 m, its lowest corner there, whose faces look outwards. */
static void box(noc_scene *s, int m, const char *name, double x, double y, double z) {
    Q(name, m, x, y, z, 0, 2, 0, 2, 0, 0);
    Q(name, m, x, y, z + 2, 2, 0, 0, 0, 2, 0);
    Q(name, m, x, y, z, 2, 0, 0, 0, 0, 2);
    Q(name, m, x, y + 2, z, 0, 0, 2, 2, 0, 0);
    Q(name, m, x, y, z, 0, 0, 2, 0, 2, 0);
    Q(name, m, x + 2, y, z, 0, 2, 0, 0, 0, 2);
}

static void buried_places_say_why(void **state) {
    const world *w = *state;
    noc_scene *s = noc_scene_create(w->log);
    int terrain = grey_of(s, NOC_CLASS_TERRAIN), bridge = grey_of(s, NOC_CLASS_BRIDGE);
    Q("ground", terrain, -50, -50, 0, 100, 0, 0, 0, 100, 0);
    Q("bridge", bridge, -50, -20, 5, 100, 0, 0, 0, 5, 0);
    box(s, grey_of(s, NOC_CLASS_WALL), "house 7", 10, 10, 0);
    box(s, grey_of(s, NOC_CLASS_LAMP), "way/1", 20, 10, 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *view = own_view(s, 2, w->log);
    static const struct {
        double at[3];
        const char *says;
    } places[] = { { { 11, 11, 1 }, "inside a building, house 7" },
                   { { 11.5, 10.5, 0 }, "inside a building, house 7" },
                   { { 21, 11, 0 }, "inside a lamp's pole or head" },
                   { { 0, 0, -0.3 }, "below the ground by 0.3 m" },
                   { { 0, 0, 0 }, "" },
                   { { 0, 0, 2 }, "" },
                   { { 0, -17, 1 }, "" },
                   { { 11, 11, 3 }, "" } };
    for (size_t i = 0; i < NOC_COUNT(places); i++) {
        char text[128];
        assert_int_equal(noc_view_buried(view, s, places[i].at, text, sizeof(text)), NOC_OK);
        assert_string_equal(text, places[i].says);
    }
    close_view(view);
    noc_scene_destroy(s);
}

static void wrong_ones_say_what_is_wrong(void **state) {
    const world *w = *state;
    static const struct {
        const char *text, *says;
    } wrong[] = {
        { "point:1e300,0", "more than 1000 km away" },
        { "point:0,0,1e308", "more than 1000 km away" },
        { "point:0,0,3,1e-320,0,0", "faces nowhere" },
        { "polygon:POLYGON((1e12 1e12, 2e12 1e12, 1e12 2e12))", "more than 1000 km away" },
        { "polygon:", "needs a file, or WKT" },
        { "polygon:POLYGON EMPTY", "POLYGON" },
        { "pont:1,2", "is it point: ?" },
        { "what", "does not begin with point:" },
        { "point:1", "is not X,Y" },
        { "point:1,x", "is not X,Y" },
        { "point:4000,0", "no surface" },
        { "point:0,0,1,0,0,0", "faces nowhere" },
        { "pixel:100,0", "outside of a picture of 100 x 100" },
        { "rect:0,0,5", "is not X0,Y0,X1,Y1" },
        { "object:house 6", "is it \"house 7\"?" },
        { "object:", "no object \"\"" },
        { "street:Main Stret", "is it \"Main Street\"?" },
        { "street:zzzzzzzzz", "among 4; the first is \"Gro" },
        { "street:gasse", "is it \"Gro\xc3\x9f"
                          "e Gasse\"?" },
        { "street:Strasse", "is it \"Hinterstr.\" or \"M\xc3\xbcllerstra\xc3\x9f"
                            "e\"?" },
        { "street:house 7", "is an object of the model and no street of a map: ask for object:house 7" },
        { "street:", "among 4; the first is" },
        { "point:a,b", "point:a,b is not X,Y" },
        { "polygon:/no/such/file", "/no/such/file" },
        { "polygon:0,0,1,1", "0,0,1,1 is no file; corners are written as WKT" },
        { "polygon:POLYGON((0 0, 1 1))", "less than three" },
        { "polygon:POLYGON((0 0, 1 1, 2 2", "does not end" },
        { "polygon:POLYGON((0 0, 1 1, 2 0)", "do not match" },
        { "polygon:POINT(1 2)", "neither GeoJSON nor" },
        { "polygon:POLYGON((0 0, a b, 2 0))", "not two numbers" },
        { "polygon:POLYGON((400 0, 401 0, 401 1))", "no ground" },
    };
    for (size_t k = 0; k < NOC_COUNT(wrong); k++) {
        noc_region_info i;
        noc_region *r = find(w, wrong[k].text, &i);
        if (r || !strstr(told, wrong[k].says))
            print_message("# %s: %s\n", wrong[k].text, told);
        assert_null(r);
        assert_non_null(strstr(told, wrong[k].says));
    }
    assert_null(noc_region_find(w->view, w->scene, "polygon:/etc/passwd", &(noc_region_params){ 0 }, w->log));
    assert_non_null(strstr(told, "needs WKT")); /* no file unless files are allowed */
    assert_null(noc_region_find(w->view, w->scene, "pixel:1,1", &(noc_region_params){ 0 }, w->log));
    assert_non_null(strstr(told, "need a camera"));
}

static void files_of_polygons(void **state) {
    (void)state;
    static const struct {
        const char *text;
        size_t rings;
        const char *crs;
    } files[] = {
        { "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,0]]]}", 1, "OGC:CRS84" },
        { "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:25833\"}},"
          "\"features\":[{\"type\":\"Feature\",\"geometry\":{\"type\":\"MultiPolygon\",\"coordinates\":"
          "[[[[0,0,9],[1,0,9],[1,1,9]]],[[[5,5],[6,5],[6,6]]]]}},{\"type\":\"Feature\",\"geometry\":null}]}",
          2, "EPSG:25833" },
        { "{\"type\":\"Polygon\",\"coordinates\":[[[392000,5820000],[392010,5820000],[392010,5820010]]]}", 1, "" },
        { " polygon ((0 0, 1 0, 1 1))", 1, "" },
        { "{\"type\":\"Point\",\"coordinates\":[0,0]}", 0, "" },
        { "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0]]]}", 0, "" },
        { "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[\"a\",0],[1,1]]]}", 0, "" },
        { "{\"type\":", 0, "" },
        { "", 0, "" },
    };
    char path[] = "/tmp/noc-rings-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    for (size_t i = 0; i < NOC_COUNT(files); i++) {
        noc_rings rings;
        size_t size = strlen(files[i].text);
        assert_int_equal(ftruncate(fd, 0), 0);
        assert_true(pwrite(fd, files[i].text, size, 0) == (ssize_t)size);
        noc_status status = noc_rings_read(path, &rings, NULL);
        assert_int_equal(status == NOC_OK, files[i].rings > 0);
        assert_int_equal(rings.count, files[i].rings);
        assert_string_equal(rings.crs, files[i].crs);
        for (size_t k = 0; k < rings.count; k++)
            assert_int_equal(rings.size[k], 3);
        noc_rings_free(&rings);
    }
    close(fd);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_face_as_they_are_said),
        cmocka_unit_test(objects_are_their_surfaces_by_area),
        cmocka_unit_test(ground_is_what_is_seen_from_above),
        cmocka_unit_test(polygons_may_have_many_corners),
        cmocka_unit_test(streets_are_found_as_people_spell_them),
        cmocka_unit_test(buried_places_say_why),
        cmocka_unit_test(wrong_ones_say_what_is_wrong),
        cmocka_unit_test(files_of_polygons),
        cmocka_unit_test(points_in_another_crs),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
