/* Surfaces of the roads of maps, against what ribbons of their width cover. */
#include "../test.h"

#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

typedef double height_fn(double x, double y);

static double level(double x, double y) {
    (void)x;
    (void)y;
    return 3;
}
/* Folds of 20 % that no place along a road meets. */
static double folded(double x, double y) { return 0.2 * fabs(fmod(x + 1000.37, 13.1) - 6.55) + 0.05 * y; }

/* Ground over -side..side, through f at points a metre apart. */
static noc_scene *land(height_fn *f, int side) {
    noc_scene *s = noc_scene_create(NULL);
    int n = 2 * side + 1;
    double *xyz = calloc((size_t)(3 * n * n), sizeof(*xyz));
    uint32_t *index = calloc((size_t)(6 * n * n), sizeof(*index));
    size_t count = 0;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            double *p = xyz + 3 * (y * n + x);
            p[0] = x - side;
            p[1] = y - side;
            p[2] = f(p[0], p[1]);
            uint32_t a = (uint32_t)(y * n + x), b = a + 1, c = a + (uint32_t)n, d = c + 1;
            if (x + 1 < n && y + 1 < n) {
                memcpy(index + count, (uint32_t[]){ a, b, d, a, d, c }, 6 * sizeof(*index));
                count += 6;
            }
        }
    noc_material m = noc_class_material(NOC_CLASS_TERRAIN);
    noc_mesh mesh = { .vertex_count = (size_t)(n * n),
                      .positions = xyz,
                      .triangle_count = count / 3,
                      .indices = index,
                      .material = noc_scene_add_material(s, &m) };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0);
    free(xyz);
    free(index);
    return s;
}

static geo_road road_of(geo_road_class cls, double width, const double *xyz, size_t count) {
    return (geo_road){ .id = "way/1",
                       .name = "",
                       .cls = cls,
                       .motor = true,
                       .width = width,
                       .speed = NAN,
                       .point_count = count,
                       .xyz = xyz };
}

static city_paved pave(noc_scene *s, const geo_road *roads, size_t count) {
    city_paved p;
    assert_int_equal(city_pave_roads(s, roads, count, NULL, &p), NOC_OK);
    return p;
}

static bool top(const noc_scene *s, noc_class cls, double x, double y, double *z) {
    return noc_scene_highest(s, 1u << cls, x, y, z);
}

/* Area of triangles of that class as seen from above; all of them face upwards. */
static double area_of(const noc_scene *s, noc_class cls) {
    double sum = 0;
    for (size_t t = 0; t < s->indices.len / 3; t++) {
        const float *c[3];
        if (s->materials.data[s->triangle_material.data[t]].cls != cls)
            continue;
        for (int k = 0; k < 3; k++)
            c[k] = s->positions.data + 3 * (size_t)s->indices.data[3 * t + (size_t)k];
        double twice =
            (double)(c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (double)(c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
        assert_true(twice > 0);
        sum += twice / 2;
    }
    return sum;
}

/* Width times length, and half a polygon of 12 corners beyond each end; some centimetres over the ground. */
static void straight_road(void **state) {
    (void)state;
    double z;
    noc_scene *s = land(level, 50);
    const double line[] = { -30, 5, NAN, 10, 5, NAN, 20, 5, NAN };
    geo_road r = road_of(GEO_ROAD_MINOR, 6, line, 3);
    city_paved p = pave(s, &r, 1);
    assert_int_equal(p.roads, 1);
    double ends = 12 * 9 * sin(M_PI / 6) / 2;
    assert_true(fabs(area_of(s, NOC_CLASS_ROAD) - (300 + ends)) < 0.01);
    assert_true(p.triangles < 60); /* the land is flat: no more than it takes */
    assert_true(top(s, NOC_CLASS_ROAD, 0, 7.9, &z) && z > 3.01 && z < 3.1);
    assert_true(top(s, NOC_CLASS_ROAD, -32.5, 5, &z));
    assert_false(top(s, NOC_CLASS_ROAD, 0, 8.1, &z));
    assert_string_equal(s->meshes.data[1].name, "way/1");
    noc_scene_destroy(s);
}

/* A bend has no gap on its outside, and reaches out no further than the mitre; a hairpin does not spike. */
static void bends(void **state) {
    (void)state;
    double z;
    noc_scene *s = land(level, 60);
    const double line[] = { -30, 0, NAN, 0, 0, NAN, 0, 30, NAN }, pin[] = { 30, -40, NAN, 30, -10, NAN, 31, -40, NAN };
    geo_road roads[] = { road_of(GEO_ROAD_MINOR, 4, line, 3), road_of(GEO_ROAD_MINOR, 4, pin, 3) };
    assert_int_equal(pave(s, roads, 2).roads, 2);
    for (double t = 0; t < 1.95; t += 0.1) {
        assert_true(top(s, NOC_CLASS_ROAD, t, -t, &z));
        assert_true(top(s, NOC_CLASS_ROAD, -t, t, &z));
    }
    assert_false(top(s, NOC_CLASS_ROAD, 2.1, -2.1, &z));
    assert_false(top(s, NOC_CLASS_ROAD, 30.5, -5.5, &z));
    noc_scene_destroy(s);
}

/* The ground pokes through nowhere, however it is folded. */
static void folds(void **state) {
    (void)state;
    noc_scene *s = land(folded, 60);
    const double line[] = { -50, -20, NAN, -10, 30, NAN, 45, 10, NAN };
    geo_road r = road_of(GEO_ROAD_PRIMARY, 9, line, 3);
    pave(s, &r, 1);
    size_t tried = 0;
    for (double x = -50; x < 46; x += 0.37)
        for (double y = -20; y < 31; y += 0.41) {
            double road, ground;
            if (!top(s, NOC_CLASS_ROAD, x, y, &road) || !top(s, NOC_CLASS_TERRAIN, x, y, &ground))
                continue;
            tried++;
            if (road < ground || road > ground + 0.8)
                fail_msg("%g %g: the road lies at %g, the ground at %g", x, y, road, ground);
        }
    assert_true(tried > 5000);
    noc_scene_destroy(s);
}

/* Two roads that cross are seen one above the other, the wider class on top, whatever comes first. */
static void crossings(void **state) {
    (void)state;
    const double east[] = { -30, 0, NAN, 30, 0, NAN }, north[] = { 0, -30, NAN, 0, 30, NAN };
    for (int turn = 0; turn < 2; turn++) {
        noc_scene *s = land(level, 50);
        geo_road roads[2];
        roads[turn] = road_of(GEO_ROAD_PATH, 3, east, 2);
        roads[1 - turn] = road_of(GEO_ROAD_PRIMARY, 7, north, 2);
        assert_int_equal(pave(s, roads, 2).roads, 2);
        double road, path;
        assert_true(top(s, NOC_CLASS_ROAD, 1, 1, &road));
        assert_true(top(s, NOC_CLASS_SIDEWALK, 1, 1, &path));
        assert_true(road > path + 0.01);
        noc_scene_destroy(s);
    }
}

/* What is not drawn is counted; a road ends where the ground does; a bridge goes on. */
static void left_out(void **state) {
    (void)state;
    double z;
    const double line[] = { 0, 0, NAN, 100, 0, NAN }, away[] = { 300, 0, NAN, 400, 0, NAN },
                 far[] = { 0, 0, NAN, 9e6, 0, NAN };
    noc_scene *s = land(level, 50);
    geo_road roads[] = { road_of(GEO_ROAD_RAIL, NAN, line, 2), road_of(GEO_ROAD_TRACK, NAN, line, 2),
                         road_of(GEO_ROAD_MINOR, 5, line, 2),  road_of(GEO_ROAD_MINOR, 5, line, 2),
                         road_of(GEO_ROAD_MINOR, 5, away, 2),  road_of(GEO_ROAD_MINOR, 5, far, 2) };
    roads[2].tunnel = true;
    city_paved p = pave(s, roads, 6);
    assert_int_equal(p.roads, 1);
    assert_int_equal(p.unpaved, 2);
    assert_int_equal(p.tunnels, 1);
    assert_int_equal(p.off_ground, 1);
    assert_int_equal(p.too_many, 1);
    assert_true(top(s, NOC_CLASS_ROAD, 45, 0, &z));
    assert_false(top(s, NOC_CLASS_ROAD, 52, 0, &z));
    geo_road bridge = road_of(GEO_ROAD_MINOR, 5, line, 2);
    bridge.bridge = true;
    pave(s, &bridge, 1);
    assert_true(top(s, NOC_CLASS_ROAD, 90, 0, &z) && fabs(z - 3) < 0.1);
    noc_scene_destroy(s);
}

/* An area is as large as it is, faces upwards whichever way it goes round, follows the ground and ends with it. */
static void areas(void **state) {
    (void)state;
    size_t made;
    for (int way = 0; way < 2; way++) {
        const double ring[] = { -20, -10, 0, 15, -10, 0, 15, 12, 0, -20, 12, 0, -20, -10, 0 },
                     back[] = { -20, -10, 0, -20, 12, 0, 15, 12, 0, 15, -10, 0, -20, -10, 0 };
        const size_t size = 5;
        geo_triangles t = { 0 };
        assert_true(geo_triangulate(&(geo_polygon){ NOC_CLASS_GREEN, "a", 1, &size, way ? back : ring }, &t, NULL));
        noc_scene *s = land(folded, 60);
        assert_int_equal(city_lay_area(s, &t, NOC_CLASS_GREEN, 0.01, NULL, &made), NOC_OK);
        assert_true(made > 100);
        assert_true(fabs(area_of(s, NOC_CLASS_GREEN) - 35 * 22) < 0.1);
        for (double x = -19; x < 15; x += 1.7)
            for (double y = -9; y < 12; y += 1.3) {
                double green, ground;
                assert_true(top(s, NOC_CLASS_GREEN, x, y, &green));
                assert_true(top(s, NOC_CLASS_TERRAIN, x, y, &ground));
                assert_true(fabs(green - ground) < 0.25); /* edges of 4 m over folds of 40 % */
            }
        noc_scene_destroy(s);
        s = land(level, 10);
        assert_int_equal(city_lay_area(s, &t, NOC_CLASS_WATER, 0.01, NULL, &made), NOC_OK);
        double in = area_of(s, NOC_CLASS_WATER);
        assert_true(in > 300 && in <= 400.1);
        noc_scene_destroy(s);
        geo_triangles_free(&t);
    }
}

static bool stop(void *user, const char *what, double done) {
    (void)user;
    (void)what;
    (void)done;
    return false;
}

/* An area that reaches far beyond the ground is cut down to it, not split all over; it can be stopped. */
static void large_area(void **state) {
    (void)state;
    const double far = 2e5, ring[] = { -far, -far, 0, far, -far, 0, far, far, 0, -far, far, 0, -far, -far, 0 };
    const size_t size = 5;
    size_t made;
    geo_triangles t = { 0 };
    assert_true(geo_triangulate(&(geo_polygon){ NOC_CLASS_GREEN, "a", 1, &size, ring }, &t, NULL));
    noc_scene *s = land(level, 60);
    assert_int_equal(city_lay_area(s, &t, NOC_CLASS_GREEN, 0.01, NULL, &made), NOC_OK);
    double in = area_of(s, NOC_CLASS_GREEN);
    assert_true(in > 100 * 100 && in <= 120 * 120.1);
    assert_true(made < 10000);
    assert_int_equal(city_lay_area(s, &t, NOC_CLASS_GREEN, 0.01, &(noc_progress){ stop, NULL }, &made),
                     NOC_ERR_CANCELLED);
    noc_scene_destroy(s);
    geo_triangles_free(&t);
}

static void refused_and_cancelled(void **state) {
    (void)state;
    const double line[] = { -30, 5, NAN, 10, 25, NAN, 20, 5, NAN };
    geo_road r = road_of(GEO_ROAD_MINOR, 6, line, 3);
    city_paved p;
    noc_scene *s = land(level, 40);
    assert_int_equal(city_pave_roads(s, &r, 1, &(noc_progress){ stop, NULL }, &p), NOC_ERR_CANCELLED);
    noc_scene_destroy(s);
    noc_status status = NOC_ERR_MEMORY;
    for (uint64_t n = 1; status; n++) {
        s = land(level, 10);
        double z;
        noc_scene_ground(s, 0, 0, &z);
        noc_refuse_allocation(n, false);
        status = city_pave_roads(s, &r, 1, NULL, &p);
        noc_refuse_allocation(0, false);
        assert_true(status == NOC_OK || status == NOC_ERR_MEMORY);
        assert_true(n < 500);
        noc_scene_destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_road), cmocka_unit_test(bends),
        cmocka_unit_test(folds),         cmocka_unit_test(crossings),
        cmocka_unit_test(areas),         cmocka_unit_test(large_area),
        cmocka_unit_test(left_out),      cmocka_unit_test(refused_and_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
