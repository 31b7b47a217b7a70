/* Triangulation: areas against closed forms and against the shoelace formula, orientation, and every kind of bad ring.
 */
#include "geo/geo.h"
#include "../test.h"

#include <math.h>

/* cmocka of Debian 12 compares floats only */
#define assert_close(a, b, tolerance)                                                                                  \
    do {                                                                                                               \
        double a_ = (a), b_ = (b);                                                                                     \
        if (!(fabs(a_ - b_) <= (tolerance)))                                                                           \
            fail_msg("%s is %.12g, not %.12g", #a, a_, b_);                                                            \
    } while (0)

static uint32_t random_state = 1;

static double uniform(void) { /* 0..1 */
    random_state = random_state * 1664525u + 1013904223u;
    return (double)(random_state >> 8) / (1 << 24);
}

struct result {
    bool ok;
    double area;      /* sum over triangles */
    double normal[3]; /* area-weighted sum of triangle normals */
    size_t triangles, vertices;
    geo_issues *issues;
};

static struct result run(const double *xyz, const size_t *sizes, size_t rings) {
    struct result r = { .issues = geo_issues_create() };
    geo_polygon polygon = { .id = "p", .ring_count = rings, .ring_size = sizes, .xyz = xyz };
    geo_triangles t = { 0 };
    /* something before it: results are appended */
    assert_true(array_append(&t.xyz, ((double[]){ 7, 7, 7 }), 3));
    r.ok = geo_triangulate(&polygon, &t, r.issues);
    r.triangles = t.indices.len / 3;
    r.vertices = t.xyz.len / 3 - 1;
    assert_int_equal(t.indices.len % 3, 0);
    if (!r.ok)
        assert_int_equal(t.indices.len + t.xyz.len, 3);
    for (size_t i = 0; i < t.indices.len; i += 3) {
        const double *p[3];
        for (size_t k = 0; k < 3; k++) {
            assert_in_range(t.indices.data[i + k], 1, t.xyz.len / 3 - 1);
            p[k] = t.xyz.data + 3 * (size_t)t.indices.data[i + k];
        }
        double u[3], v[3];
        for (int k = 0; k < 3; k++)
            u[k] = p[1][k] - p[0][k], v[k] = p[2][k] - p[0][k];
        double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
        for (int k = 0; k < 3; k++)
            r.normal[k] += n[k] / 2;
        r.area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
    }
    geo_triangles_free(&t);
    return r;
}

static bool has_issue(const struct result *r, const char *reason, bool repaired) {
    for (size_t i = 0; i < geo_issues_count(r->issues); i++) {
        const char *text, *examples;
        bool is_repaired;
        size_t count;
        assert_true(geo_issues_get(r->issues, i, &text, &is_repaired, &count, &examples));
        assert_string_equal(examples, "p");
        if (!strcmp(text, reason) && is_repaired == repaired)
            return true;
    }
    return false;
}

#define RUN(...) run((double[]){ __VA_ARGS__ }, (size_t[]){ sizeof((double[]){ __VA_ARGS__ }) / 24 }, 1)

/* area, facing up or not, and nothing to report */
static void expect(struct result r, double area, double up) {
    assert_true(r.ok);
    assert_close(r.area, area, 1e-9 * area);
    assert_close(r.normal[2], up * area, 1e-9 * area);
    assert_int_equal(geo_issues_count(r.issues), 0);
    geo_issues_destroy(r.issues);
}

static void expect_issue(struct result r, double area, const char *reason) {
    assert_true(r.ok);
    assert_close(r.area, area, 1e-5 * area);
    assert_true(has_issue(&r, reason, true));
    geo_issues_destroy(r.issues);
}

static void expect_skipped(struct result r, const char *reason) {
    assert_false(r.ok);
    assert_true(has_issue(&r, reason, false));
    geo_issues_destroy(r.issues);
}

static void test_simple_shapes(void **state) {
    (void)state;
    expect(RUN(0, 0, 5, 4, 0, 5, 0, 3, 5), 6, 1);
    expect(RUN(0, 0, 5, 0, 3, 5, 4, 0, 5), 6, -1);
    expect(RUN(0, 0, 1, 4, 0, 1, 4, 3, 1, 0, 3, 1), 12, 1);
    expect(RUN(0, 0, 1, 0, 3, 1, 4, 3, 1, 4, 0, 1), 12, -1);
    expect(RUN(0, 0, 1, 4, 4, 1, 0, 1, 1, -4, 4, 1), 4, 1);                  /* dart, reflex at the third point */
    expect(RUN(4, 4, 1, 0, 1, 1, -4, 4, 1, 0, 0, 1), 4, 1);                  /* the same from the next */
    expect(RUN(0, 0, 0, 3, 0, 0, 3, 1, 0, 1, 1, 0, 1, 3, 0, 0, 3, 0), 5, 1); /* L */
    /* a wall at Ingolstadt's coordinates (UTM 32), facing south */
    struct result wall = RUN(677000, 5402000, 370, 677010, 5402000, 370, 677010, 5402000, 379, 677000, 5402000, 379);
    assert_true(wall.ok);
    assert_close(wall.area, 90, 1e-6);
    assert_close(wall.normal[1], -90, 1e-6);
    assert_int_equal(wall.triangles, 2);
    geo_issues_destroy(wall.issues);
}

static void test_star(void **state) {
    (void)state;
    double p[60];
    for (int i = 0; i < 20; i++) {
        double r = i % 2 ? 1 : 3, a = i * M_PI / 10;
        p[3 * i] = r * cos(a), p[3 * i + 1] = r * sin(a), p[3 * i + 2] = 2;
    }
    /* 20 triangles of sides 3 and 1 with 18 degrees between */
    expect(run(p, (size_t[]){ 20 }, 1), 20 * 0.5 * 3 * sin(M_PI / 10), 1);
}

#define SQUARE(x, y, s) (x), (y), 0, (x) + (s), (y), 0, (x) + (s), (y) + (s), 0, (x), (y) + (s), 0
#define HOLE(x, y, s) (x), (y), 0, (x), (y) + (s), 0, (x) + (s), (y) + (s), 0, (x) + (s), (y), 0

static void test_holes(void **state) {
    (void)state;
    size_t two[] = { 4, 4 }, three[] = { 4, 4, 4 };
    expect(run((double[]){ SQUARE(0, 0, 10), HOLE(2, 2, 3) }, two, 2), 91, 1);
    expect(run((double[]){ HOLE(0, 0, 10), SQUARE(2, 2, 3) }, two, 2), 91, -1);
    expect(run((double[]){ SQUARE(0, 0, 10), HOLE(1, 1, 2), HOLE(5, 5, 4) }, three, 3), 80, 1);
    expect(run((double[]){ SQUARE(0, 0, 10), HOLE(0, 0, 2) }, two, 2), 96, 1); /* touches a corner */
    expect_issue(run((double[]){ SQUARE(0, 0, 10), SQUARE(2, 2, 3) }, two, 2), 91,
                 "interior ring turned like the exterior");
    expect_issue(run((double[]){ SQUARE(0, 0, 10), HOLE(20, 2, 3) }, two, 2), 100,
                 "interior ring outside the exterior");
    expect_issue(run((double[]){ SQUARE(0, 0, 10), HOLE(8, 2, 4) }, two, 2), 92, "self-intersecting ring");
    size_t small[] = { 4, 2 };
    expect_issue(run((double[]){ SQUARE(0, 0, 10), 1, 1, 0, 2, 2, 0 }, small, 2), 100,
                 "interior ring with too few points");
    expect_issue(run((double[]){ SQUARE(0, 0, 10), SQUARE(1, 1, 0) }, two, 2), 100, "collapsed interior ring");
    expect_issue(run((double[]){ SQUARE(0, 0, 10), HOLE(2, 2, 3), HOLE(2, 2, 3) }, three, 3), 91,
                 "interior ring given twice");
    expect_issue(run((double[]){ SQUARE(0, 0, 10), HOLE(2, 2, 3), 5, 2, 0, 2, 2, 0, 2, 5, 0, 5, 5, 0 }, three, 3), 91,
                 "interior ring given twice");
    enum { MANY = 3000 }; /* of one hole, which would all meet at its corners; and a last one that is another */
    double *many = noc_alloc(sizeof(double[12 * (MANY + 2)]));
    size_t *sizes = noc_alloc(sizeof(size_t[MANY + 2]));
    for (size_t r = 0; r < MANY + 2; r++) {
        double ring[2][12] = { { SQUARE(0, 0, 10) }, { HOLE(2, 2, 3) } }, last[12] = { HOLE(6, 6, 2) };
        memcpy(many + 12 * r, r == MANY + 1 ? last : ring[r > 0], sizeof(last));
        sizes[r] = 4;
    }
    struct result once = run(many, sizes, MANY + 2);
    assert_close(once.area, 100 - 9 - 4, 1e-9);
    assert_int_equal(once.triangles, 12 + 2 * 2 - 2);
    geo_issues_destroy(once.issues);
    expect_issue(run(many, sizes, MANY + 2), 87, "interior ring given twice");
    free(many);
    free(sizes);
    struct result nested = run((double[]){ SQUARE(0, 0, 10), HOLE(2, 2, 5), HOLE(3, 3, 1) }, three, 3);
    assert_close(nested.area, 75, 1e-9);
    geo_issues_destroy(nested.issues);
    expect_skipped(run((double[]){ SQUARE(0, 0, 10), HOLE(0, 0, 10) }, two, 2), "polygon without area");
}

static void test_repairs(void **state) {
    (void)state;
    expect_issue(RUN(0, 0, 0, 4, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0), 12, "repeated point");
    expect_issue(RUN(0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0, 0, 0, 0), 12, "repeated point");
    expect_issue(RUN(0, 0, 0, 4, 0, 0, 9, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0), 12, "spike");
    expect_issue(RUN(0, 0, 0, 9, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0), 12, "spike");  /* overshoot */
    expect_issue(RUN(0, 9, 0, 0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0), 12, "spike");  /* at the first point */
    expect_issue(RUN(0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0, 0, -2, 0), 12, "spike"); /* at the last */
    expect_issue(RUN(0, 0, 0, NAN, 1, 1, 4, 0, 0, 4, 3, 0, 0, 3, INFINITY, 0, 3, 0), 12,
                 "coordinates that are not finite");
    expect_issue(RUN(NAN, 0, 0, 0, 0, 0, 4, 0, 0, 4, 3, 0, 0, 3, 0), 12, "coordinates that are not finite");
    /* a bow tie of two equal lobes has no area by Newell: both lobes are kept */
    expect_issue(RUN(0, 0, 0, 4, 4, 0, 4, 0, 0, 0, 4, 0), 8, "self-intersecting ring");
    /* unequal lobes: crossing at (3, 3) */
    expect_issue(RUN(0, 0, 0, 4, 4, 0, 4, 0, 0, 0, 12, 0), 18 + 2, "self-intersecting ring");
    /* two triangles that meet in one point */
    expect_issue(RUN(0, 0, 0, 2, 2, 0, 0, 4, 0, 4, 4, 0, 2, 2, 0, 4, 0, 0), 8, "self-touching ring");
    /* a hole tied to the exterior by a seam */
    expect_issue(RUN(0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 0, 0, 0, 2, 2, 0, 2, 5, 0, 5, 5, 0, 5, 2, 0, 2, 2, 0), 91,
                 "self-touching ring");
    /* a pentagram by the odd rule: the star without its heart */
    double star[15];
    for (int i = 0; i < 5; i++) {
        star[3 * i] = cos(4 * M_PI * i / 5), star[3 * i + 1] = sin(4 * M_PI * i / 5), star[3 * i + 2] = 0;
    }
    double outline = 5 * sin(M_PI / 5) * (cos(2 * M_PI / 5) / cos(M_PI / 5)); /* ten triangles of radii 1 and r */
    double r = cos(2 * M_PI / 5) / cos(M_PI / 5), heart = 2.5 * r * r * sin(2 * M_PI / 5);
    expect_issue(run(star, (size_t[]){ 5 }, 1), outline - heart, "self-intersecting ring");
}

static void test_non_planar(void **state) {
    (void)state;
    /* one corner half a metre up: both triangles keep the vertices as they are */
    struct result r = RUN(0, 0, 0, 4, 0, 0, 4, 4, 0.5, 0, 4, 0);
    assert_true(r.ok);
    assert_true(has_issue(&r, "non-planar polygon", true));
    assert_close(r.normal[2], 16, 1e-9);
    assert_int_equal(r.vertices, 4);
    geo_issues_destroy(r.issues);
    /* a millimetre is survey noise */
    r = RUN(0, 0, 0, 4, 0, 0, 4, 4, 0.001, 0, 4, 0);
    assert_int_equal(geo_issues_count(r.issues), 0);
    geo_issues_destroy(r.issues);
}

static void test_skipped(void **state) {
    (void)state;
    expect_skipped(RUN(0, 0, 0, 1, 0, 0), "ring with too few points");
    expect_skipped(RUN(0, 0, 0, 1, 0, 0, 0, 0, 0), "collapsed ring");
    expect_skipped(RUN(0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0), "collapsed ring"); /* all spike */
    expect_skipped(RUN(5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5), "collapsed ring");
    expect_skipped(RUN(NAN, 0, 0, 0, NAN, 0, 0, 0, NAN), "collapsed ring");
    expect_skipped(RUN(0, 0, 0, 1e8, 0, 0, 0, 1e8, 0), "polygon wider than 1000 km");
    expect_skipped(RUN(0, 0, 0, 1e300, 0, 0, 0, -1e300, 0), "polygon wider than 1000 km");
    expect_skipped(run((double[]){ 0 }, (size_t[]){ 0 }, 0), "ring with too few points");
    expect_skipped(run((double[]){ 0 }, (size_t[]){ 0 }, 1), "ring with too few points");
    geo_issue(NULL, true, "nothing", "x"); /* allowed */
}

/* Random simple polygons (star-shaped about a point) with a star-shaped hole, in random planes far from the origin: the
 * area is the shoelace formula's, the triangles number n - 2 (and 2 more a hole), all face the ring's way. */
/* Of 20 million points at most. */
static void test_most_points(void **state) {
    (void)state;
    const size_t most = geo_most_points;
    assert_int_equal(most, 20000000);
    geo_most_points = 4;
    expect(RUN(0, 0, 5, 4, 0, 5, 4, 3, 5, 0, 3, 5), 12, 1);
    expect_skipped(RUN(0, 0, 5, 4, 0, 5, 5, 1, 5, 4, 3, 5, 0, 3, 5), "polygon of more than 20 million points");
    geo_most_points = most;
}

static void test_random_polygons(void **state) {
    (void)state;
    for (int round = 0; round < 3000; round++) {
        size_t n = 3 + (size_t)(uniform() * 40), h = round % 3 ? 0 : 3 + (size_t)(uniform() * 10);
        double p[3 * 64], area = 0, axis[2][3], offset[3];
        double a = uniform() * 6.28, b = acos(2 * uniform() - 1);
        double normal[3] = { sin(b) * cos(a), sin(b) * sin(a), cos(b) };
        axis[0][0] = -sin(a), axis[0][1] = cos(a), axis[0][2] = 0;
        for (int k = 0; k < 3; k++) {
            axis[1][k] = normal[(k + 1) % 3] * axis[0][(k + 2) % 3] - normal[(k + 2) % 3] * axis[0][(k + 1) % 3];
            offset[k] = uniform() * 1e4;
        }
        bool flip = round % 2;
        for (size_t ring = 0, at = 0; ring < (h ? 2u : 1u); ring++) {
            size_t count = ring ? h : n;
            double u0 = 0, v0 = 0, u1 = 0, v1 = 0, sum = 0;
            for (size_t i = 0; i < count; i++, at++) {
                double angle = 2 * M_PI * ((double)i + 0.8 * uniform()) / (double)count,
                       r = ring ? 0.5 + uniform() : 5 + 10 * uniform();
                if (flip != (ring == 1))
                    angle = -angle;
                double u = r * cos(angle), v = r * sin(angle);
                sum += i ? (u1 * v - u * v1) / 2 : 0;
                if (!i)
                    u0 = u, v0 = v;
                u1 = u, v1 = v;
                for (int k = 0; k < 3; k++)
                    p[3 * at + (size_t)k] = offset[k] + u * axis[0][k] + v * axis[1][k];
            }
            area += sum + (u1 * v0 - u0 * v1) / 2;
        }
        if (h && n < 12) /* the hole (radius < 1.5) must lie in the exterior (whose chords may come near) */
            continue;
        struct result r = run(p, (size_t[]){ n, h }, h ? 2 : 1);
        assert_true(r.ok);
        assert_close(r.area, fabs(area), 1e-6);
        double facing = r.normal[0] * normal[0] + r.normal[1] * normal[1] + r.normal[2] * normal[2];
        assert_close(facing, area, 1e-6);
        assert_int_equal(r.triangles, h ? n + h : n - 2);
        geo_issues_destroy(r.issues);
    }
}

/* Anything at all ends in triangles of finite vertices or in a reported skip. */
static void test_garbage(void **state) {
    (void)state;
    static const double odd[] = { 0, 1, -1, 1e-5, 1e-300, 1e10, 1e300, -1e300, NAN, INFINITY, -INFINITY, 5, 5, 5 };
    for (int round = 0; round < 20000; round++) {
        double p[3 * 60];
        size_t sizes[4], rings = 1 + (size_t)(uniform() * 3), total = 0;
        for (size_t r = 0; r < rings; r++)
            total += sizes[r] = (size_t)(uniform() * 15);
        for (size_t i = 0; i < 3 * total; i++) {
            double u = uniform();
            p[i] = round % 4 == 0   ? odd[(size_t)(u * NOC_COUNT(odd))]
                   : round % 4 == 1 ? floor(4 * u)
                   : round % 4 == 2 ? 100 * u
                   : i % 3 == 2     ? 0
                                    : floor(6 * u);
        }
        struct result r = run(p, sizes, rings);
        assert_true(r.ok ? isfinite(r.area) : geo_issues_count(r.issues) > 0);
        geo_issues_destroy(r.issues);
    }
}

#define TANGLED "polygon that crosses itself more than 1000 times, or more often than it has points"

/* A few thousand random points cross each other a million times: that is refused, not worked on for minutes. */
static void test_tangle(void **state) {
    (void)state;
    enum { N = 4000 };
    double *p = noc_alloc(sizeof(double[3 * N]));
    for (size_t i = 0; i < 3 * N; i++)
        p[i] = i % 3 == 2 ? 0 : 100 * uniform();
    expect_skipped(run(p, (size_t[]){ N }, 1), TANGLED);
    /* nor are small rings, of which a file can have many: 99 points cross some 1,600 times */
    expect_skipped(run(p, (size_t[]){ 99 }, 1), TANGLED);
    expect_skipped(run(p, (size_t[]){ 49, 50 }, 2), TANGLED);
    /* a star of seven points, each edge of which crosses two others, is cut as it is */
    static const double turn = 2 * 2 * M_PI / 7;
    double star[21] = { 0 };
    for (int i = 0; i < 7; i++)
        star[3 * i] = cos(turn * i), star[3 * i + 1] = sin(turn * i);
    struct result of_star = run(star, (size_t[]){ 7 }, 1);
    assert_true(of_star.ok && has_issue(&of_star, "self-intersecting ring", true));
    geo_issues_destroy(of_star.issues);
    /* as many points of an honest ring are no trouble: a comb of teeth a metre apart */
    for (size_t i = 0; i < N; i++) {
        double tooth = (double)(i / 4);
        p[3 * i] = tooth + 0.25 * (double)(i % 4), p[3 * i + 1] = i % 4 == 1 || i % 4 == 2 ? 50 : 1, p[3 * i + 2] = 0;
    }
    p[1] = p[3 * N - 2] = 0; /* closes below the gaps */
    double area = 0;
    for (size_t i = 0; i < N; i++) {
        size_t j = (i + 1) % N;
        area += (p[3 * i] * p[3 * j + 1] - p[3 * j] * p[3 * i + 1]) / 2;
    }
    struct result r = run(p, (size_t[]){ N }, 1);
    assert_true(r.ok);
    assert_close(r.area, fabs(area), 1e-6);
    assert_int_equal(r.triangles, N - 2);
    geo_issues_destroy(r.issues);
    free(p);
}

static void test_issue_examples(void **state) {
    (void)state;
    geo_issues *issues = geo_issues_create();
    const char *ids[] = { "a", "a", "b", NULL, "", "c", "d", "e", "f" };
    for (size_t i = 0; i < NOC_COUNT(ids); i++)
        geo_issue(issues, false, "reason", ids[i]);
    geo_issue(issues, true, "reason", "x");
    assert_int_equal(geo_issues_count(issues), 2);
    const char *reason, *examples;
    bool repaired;
    size_t count;
    assert_true(geo_issues_get(issues, 0, &reason, &repaired, &count, &examples));
    assert_int_equal(count, 9);
    assert_false(repaired);
    assert_string_equal(examples, "a, b, c, d, e");
    geo_issues_destroy(issues);
}

static double shoelace(const double *p, size_t n) {
    double area = 0;
    for (size_t i = 0; i < n; i++) {
        const double *a = p + 3 * i, *b = p + 3 * ((i + 1) % n);
        area += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    return area;
}

/* A star whose rays cross any line by the thousand, with a star-shaped hole and small ones between: too much for one
 * sweep, so it is divided. Its area is that of the rings, no triangle is flipped, and nothing is said of the cuts. */
static void test_large(void **state) {
    (void)state;
    enum { N = 60000, HOLE = 20000, SMALL = 100 };
    size_t sizes[2 + SMALL] = { N, HOLE }, total = N + HOLE;
    double *p = noc_alloc(sizeof(double[3 * (N + HOLE + 3 * SMALL)])), area = 0;
    for (size_t i = 0; i < N; i++) {
        double angle = 2 * M_PI * (double)i / N, r = 200 + 300 * uniform();
        p[3 * i] = r * cos(angle), p[3 * i + 1] = r * sin(angle), p[3 * i + 2] = 5;
    }
    for (size_t i = 0; i < HOLE; i++) {
        double angle = -2 * M_PI * (double)i / HOLE, r = 100 * (1 - .9 * uniform()), *q = p + 3 * (N + i);
        q[0] = r * cos(angle), q[1] = r * sin(angle), q[2] = 5;
    }
    for (size_t h = 0; h < SMALL; h++, total += 3) {
        double angle = 2 * M_PI * (double)h / SMALL, x = 150 * cos(angle), y = 150 * sin(angle);
        memcpy(p + 3 * total, (double[]){ x, y, 5, x, y + 1, 5, x + 1, y, 5 }, sizeof(double[9]));
        sizes[2 + h] = 3;
    }
    for (size_t r = 0, at = 0; r < 2 + SMALL; at += sizes[r++])
        area += shoelace(p + 3 * at, sizes[r]);
    struct result r = run(p, sizes, 2 + SMALL);
    assert_true(r.vertices > total); /* of the cuts: it was divided */
    assert_true(r.vertices < total + total / 4);
    expect(r, area, 1);
    expect(run(p, sizes, 1), shoelace(p, N), 1);
    free(p);
}

/* There and back again, begun in the middle: each point is a spike once those behind it are gone. */
static void test_long_spike(void **state) {
    (void)state;
    enum { N = 300000 };
    double *p = noc_alloc(sizeof(double[3 * N]));
    for (size_t i = 0; i < N; i++) {
        size_t at = (i + N / 4) % N;
        p[3 * i] = (double)(at < N / 2 ? at : N - at), p[3 * i + 1] = p[3 * i + 2] = 0;
    }
    expect_skipped(run(p, (size_t[]){ N }, 1), "collapsed ring");
    free(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simple_shapes),  cmocka_unit_test(test_star),
        cmocka_unit_test(test_holes),          cmocka_unit_test(test_repairs),
        cmocka_unit_test(test_non_planar),     cmocka_unit_test(test_skipped),
        cmocka_unit_test(test_most_points),    cmocka_unit_test(test_random_polygons),
        cmocka_unit_test(test_garbage),        cmocka_unit_test(test_tangle),
        cmocka_unit_test(test_large),          cmocka_unit_test(test_long_spike),
        cmocka_unit_test(test_issue_examples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
