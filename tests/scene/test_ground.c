/* Vertical queries: against brute force, on shared edges, by class, while meshes are being added, from several threads.
 */
#include "../test.h"

#include "scene/scene.h"

#include <math.h>

static uint32_t state;

static double uniform(double lo, double hi) {
    state = state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (state >> 8) / 16777216.0;
}

static int material(noc_scene *scene, noc_class cls) {
    noc_material m = noc_class_material(cls);
    return noc_scene_add_material(scene, &m);
}

static void add_triangle(noc_scene *scene, int mat, const double xyz[9]) {
    noc_mesh mesh = {
        .vertex_count = 3, .positions = xyz, .triangle_count = 1, .indices = (uint32_t[]){ 0, 1, 2 }, .material = mat
    };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
}

static void add_plane(noc_scene *scene, int mat, double x0, double y0, double x1, double y1, double z) {
    double xyz[12] = { x0, y0, z, x1, y0, z, x1, y1, z, x0, y1, z };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = mat };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
}

static void test_classes(void **ctx) {
    static const struct {
        noc_class cls;
        bool ground, top;
    } table[NOC_CLASS_COUNT] = {
        { NOC_CLASS_OTHER, false, true },    { NOC_CLASS_WALL, false, true },
        { NOC_CLASS_ROOF, false, true },     { NOC_CLASS_GROUND, true, true },
        { NOC_CLASS_CLOSURE, false, false }, { NOC_CLASS_WINDOW, false, true },
        { NOC_CLASS_DOOR, false, true },     { NOC_CLASS_INSTALLATION, false, true },
        { NOC_CLASS_TERRAIN, true, true },   { NOC_CLASS_ROAD, true, true },
        { NOC_CLASS_SIDEWALK, true, true },  { NOC_CLASS_GREEN, true, true },
        { NOC_CLASS_TREE, false, true },     { NOC_CLASS_WATER, false, true },
        { NOC_CLASS_BRIDGE, false, true },   { NOC_CLASS_FURNITURE, false, true },
        { NOC_CLASS_LAMP, false, true },     { NOC_CLASS_VEHICLE, false, true },
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        noc_scene *scene = noc_scene_create(NULL);
        add_plane(scene, material(scene, table[i].cls), 0, 0, 4, 4, 7);
        double z = -1;
        assert_int_equal(noc_scene_ground(scene, 1, 2, &z), table[i].ground);
        assert_true(z == (table[i].ground ? 7 : -1)); /* untouched where there is none */
        z = -1;
        assert_int_equal(noc_scene_top(scene, 1, 2, &z), table[i].top);
        assert_true(z == (table[i].top ? 7 : -1));
        noc_scene_destroy(scene);
    }
}

static void test_highest_wins(void **ctx) {
    noc_scene *scene = noc_scene_create(NULL);
    double z;
    assert_false(noc_scene_ground(scene, 0, 0, &z));
    add_plane(scene, material(scene, NOC_CLASS_TERRAIN), -50, -50, 50, 50, 1);
    add_plane(scene, material(scene, NOC_CLASS_ROAD), -5, -50, 5, 50, 1.25);
    add_plane(scene, material(scene, NOC_CLASS_ROOF), -5, -5, 5, 5, 9);
    noc_light globe = { .kind = NOC_LIGHT_SPHERE, .position = { 20, 20, 5 }, .radius = 0.5, .emission = { 1, 1, 1 } };
    assert_true(noc_scene_add_light(scene, &globe) >= 0);
    for (int committed = 0; committed < 2; committed++) {
        assert_true(noc_scene_ground(scene, 0, 0, &z) && z == 1.25);
        assert_true(noc_scene_ground(scene, 5, 0, &z) && z == 1.25); /* the border belongs to it */
        assert_true(noc_scene_ground(scene, 5.001, 0, &z) && z == 1);
        assert_true(noc_scene_top(scene, 0, 0, &z) && z == 9);
        assert_true(noc_scene_top(scene, 20, 20, &z) && z == 1); /* not the globe */
        assert_false(noc_scene_ground(scene, 51, 0, &z));
        assert_false(noc_scene_top(scene, 0, -50.01, &z));
        assert_false(noc_scene_ground(scene, NAN, 0, &z));
        assert_false(noc_scene_ground(scene, 0, INFINITY, &z));
        assert_false(noc_scene_ground(scene, 1e300, 0, &z));
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
    }
    noc_scene_destroy(scene);
}

/* The same question without a grid, in exact terms of the triangle's own plane. */
static bool brute_force(const noc_scene *scene, double x, double y, double *z) {
    bool found = false;
    for (size_t t = 0; t < scene->indices.len / 3; t++) {
        const float *p[3];
        for (int i = 0; i < 3; i++)
            p[i] = scene->positions.data + 3 * (size_t)scene->indices.data[3 * t + i];
        double d[3], sum = 0;
        for (int i = 0; i < 3; i++) {
            const float *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
            d[i] = ((double)b[0] - a[0]) * (y - a[1]) - ((double)b[1] - a[1]) * (x - a[0]);
            sum += d[i];
        }
        if (sum == 0 || d[0] / sum < 0 || d[1] / sum < 0 || d[2] / sum < 0)
            continue;
        double h = (d[0] * p[0][2] + d[1] * p[1][2] + d[2] * p[2][2]) / sum;
        if (!found || h > *z)
            *z = h;
        found = true;
    }
    return found;
}

static void compare_at_random(const noc_scene *scene, double extent, int count) {
    for (int i = 0; i < count; i++) {
        double x = uniform(-extent, extent), y = uniform(-extent, extent), a = 0, b = 0;
        bool want = brute_force(scene, x, y, &a), got = noc_scene_top(scene, x, y, &b);
        assert_int_equal(want, got);
        if (want)
            assert_true(fabs(a - b) < 1e-6 * (1 + fabs(a)));
    }
}

/* Random triangles from a centimetre to the whole extent, some far out; asked after each of many additions. */
static void test_random(void **ctx) {
    state = 17;
    noc_scene *scene = noc_scene_create(NULL);
    int mat = material(scene, NOC_CLASS_ROOF);
    for (int i = 0; i < 6000; i++) {
        double size = pow(10, uniform(-2, i % 97 ? 1 : 2.5)), xyz[9];
        double cx = uniform(-200, 200), cy = uniform(-200, 200);
        if (i % 500 == 0)
            cx += 1e6;
        for (int k = 0; k < 3; k++) {
            xyz[3 * k] = cx + uniform(-size, size);
            xyz[3 * k + 1] = cy + uniform(-size, size);
            xyz[3 * k + 2] = uniform(0, 30);
        }
        add_triangle(scene, mat, xyz);
        if (i % 40 == 0)
            compare_at_random(scene, 260, 4);
    }
    compare_at_random(scene, 260, 300);
    noc_scene_destroy(scene);
}

/* A fan and a grid with irrational coordinates: every point on an inner edge is covered. */
static void test_watertight(void **ctx) {
    state = 5;
    noc_scene *scene = noc_scene_create(NULL);
    int mat = material(scene, NOC_CLASS_TERRAIN);
    enum { N = 24 };
    double p[N + 1][N + 1][3];
    for (int j = 0; j <= N; j++)
        for (int i = 0; i <= N; i++) {
            p[j][i][0] = i * 3.7 + uniform(-1, 1) + 4321.1;
            p[j][i][1] = j * 2.9 + uniform(-1, 1) - 7654.3;
            p[j][i][2] = uniform(0, 2);
        }
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) {
            double a[9], b[9];
            for (int k = 0; k < 3; k++) {
                a[k] = p[j][i][k], a[3 + k] = p[j][i + 1][k], a[6 + k] = p[j + 1][i + 1][k];
                b[k] = p[j][i][k], b[3 + k] = p[j + 1][i + 1][k], b[6 + k] = p[j + 1][i][k];
            }
            add_triangle(scene, mat, a);
            add_triangle(scene, mat, b);
        }
    double z;
    for (int j = 1; j < N; j++)
        for (int i = 1; i < N; i++) {
            assert_true(noc_scene_ground(scene, (float)p[j][i][0], (float)p[j][i][1], &z));
            for (int s = 0; s < 50; s++) {
                double t = uniform(0, 1), edge[3][2] = { { p[j][i + 1][0], p[j][i + 1][1] },
                                                         { p[j + 1][i][0], p[j + 1][i][1] },
                                                         { p[j + 1][i + 1][0], p[j + 1][i + 1][1] } };
                for (int e = 0; e < 3; e++) {
                    double x = p[j][i][0] * (1 - t) + edge[e][0] * t, y = p[j][i][1] * (1 - t) + edge[e][1] * t;
                    assert_true(noc_scene_ground(scene, x, y, &z) && z >= 0 && z <= 2);
                }
            }
        }
    noc_scene_destroy(scene);
}

/* As a lamp importer does: ask, add a pole, ask. Large triangles come in between too. */
static void test_ask_and_add(void **ctx) {
    state = 3;
    noc_scene *scene = noc_scene_create(NULL);
    int road = material(scene, NOC_CLASS_ROAD), pole = material(scene, NOC_CLASS_LAMP);
    double z;
    for (int j = 0; j < 60; j++)
        for (int i = 0; i < 60; i++)
            add_plane(scene, road, i * 10 - 300, j * 10 - 300, i * 10 - 290, j * 10 - 290, i);
    for (int i = 0; i < 20000; i++) {
        double x = uniform(-300, 300), y = uniform(-300, 300), want = floor((x + 300) / 10);
        assert_true(noc_scene_ground(scene, x, y, &z) && (z == want || fabs(x - 10 * round(x / 10)) < 1e-4));
        add_plane(scene, pole, x, y, x + 0.1, y + 0.1, z + 5);
        double top;
        assert_true(noc_scene_top(scene, x + 0.05, y + 0.05, &top) && top >= z + 5);
    }
    for (int i = 0; i < 20; i++) {
        add_plane(scene, road, -2000, -2000, 2000, 2000, 100 + i);
        assert_true(noc_scene_ground(scene, 0, 0, &z) && z == 100 + i);
        assert_true(noc_scene_ground(scene, -1999, 1999, &z) && z == 100 + i);
    }
    noc_scene_destroy(scene);
}

/* A wide scene of few triangles, and many lamps placed along one of its edges: a ray must not look at all of them. */
static void test_wide(void **ctx) {
    enum { LAMPS = 20000, EACH = 3 };
    noc_scene *scene = noc_scene_create(NULL);
    int ground = material(scene, NOC_CLASS_GROUND), wall = material(scene, NOC_CLASS_WALL),
        lamp = material(scene, NOC_CLASS_LAMP);
    add_plane(scene, ground, 0, 0, 1e6, 1e6, 0);
    add_triangle(scene, wall, (double[]){ 0, 0, 0, 1e6, 0, 0, 1e6, 0, 100 });
    double looked = 0, z;
    for (int i = 0; i < LAMPS; i++) {
        double x = 10 + 28.0 * i;
        looked += (double)noc_ground_load(scene, x, 10);
        assert_true(noc_scene_ground(scene, x, 10, &z) && z == 0);
        for (int k = 0; k < EACH; k++)
            add_triangle(scene, lamp, (double[]){ x, 10, k, x + .2, 10, k, x, 10.2, k });
    }
    /* all that are there: LAMPS / 2 * EACH a ray. Twenty times less is what a grid over the whole gives. */
    assert_true(looked / LAMPS < LAMPS / 2.0 * EACH / 20);
    noc_scene_destroy(scene);
}

typedef struct asked {
    const noc_scene *scene;
    int wrong[64];
} asked;

static void ask(void *ctx, size_t item, int worker) {
    asked *a = ctx;
    for (int i = 0; i < 500; i++) {
        double x = (double)item + 0.5, z = -1;
        a->wrong[item] += !noc_scene_ground(a->scene, x, i % 64 + 0.5, &z) || z != (double)item;
    }
}

static void test_threads(void **ctx) {
    noc_scene *scene = noc_scene_create(NULL);
    int mat = material(scene, NOC_CLASS_GREEN);
    for (int i = 0; i < 64; i++)
        add_plane(scene, mat, i, 0, i + 1, 64, i);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    asked a = { scene, { 0 } };
    noc_pool *pool = noc_pool_create(4);
    noc_pool_run(pool, 64, ask, &a); /* the first query of all comes from several threads at once */
    noc_pool_destroy(pool);
    for (int i = 0; i < 64; i++)
        assert_int_equal(a.wrong[i], 0);
    noc_scene_destroy(scene);
}

/* Lamps that reach far beyond their city: none is asked about all the others. */
static void test_beyond(void **ctx) {
    enum { LAMPS = 5000 };
    noc_scene *scene = noc_scene_create(NULL);
    int ground = material(scene, NOC_CLASS_GROUND), lamp = material(scene, NOC_CLASS_LAMP);
    for (int i = 0; i < 2000; i++)
        add_plane(scene, ground, i % 50 * 10, i / 50 * 10, i % 50 * 10 + 10, i / 50 * 10 + 10, 0);
    double looked = 0, z;
    for (int i = 0; i < LAMPS; i++) {
        double x = -3000 - uniform(0, 6000), y = uniform(-4000, 4000);
        looked += (double)noc_ground_load(scene, x, y);
        assert_false(noc_scene_ground(scene, x, y, &z));
        add_plane(scene, lamp, x, y, x + 0.1, y + 0.1, 5);
        assert_true(noc_scene_top(scene, x + 0.05, y + 0.05, &z) && z == 5);
    }
    assert_true(looked / LAMPS < 20);
    noc_scene_destroy(scene);
}

/* Two towns' lamps, and each town as far from the other as a scene reaches: a ray costs as if there were one town
 * alone. */
static void test_two_continents(void **ctx) {
    enum { LAMPS = 5000 };
    noc_scene *scene = noc_scene_create(NULL);
    int lamp = material(scene, NOC_CLASS_LAMP);
    double looked = 0, z;
    for (int i = 0; i < LAMPS; i++)
        for (int k = 0; k < 2; k++) {
            double x = (k ? 6e6 : 0) + i % 70 * 30, y = (k ? -1e6 : 0) + i / 70 * 30;
            looked += (double)noc_ground_load(scene, x + .5, y + .5);
            add_plane(scene, lamp, x, y, x + 1, y + 1, 5);
            assert_true(noc_scene_top(scene, x + .5, y + .5, &z) && z == 5);
        }
    assert_true(looked / LAMPS / 2 < 20);
    noc_scene_destroy(scene);
}

/* A ray through a stack looks at its top, whatever lies below; at all of it for a class that only the lowest has. */
static void test_stack(void **ctx) {
    noc_scene *scene = noc_scene_create(NULL);
    int roof = material(scene, NOC_CLASS_ROOF), road = material(scene, NOC_CLASS_ROAD);
    add_plane(scene, road, -50, -50, 50, 50, -1);
    for (int i = 0; i < 1000; i++) /* in no order */
        add_plane(scene, roof, -50, -50, 50, 50, i * 37 % 1000);
    double z;
    assert_true(noc_scene_top(scene, 3, 4, &z) && z == 999);
    assert_true(noc_scene_ground(scene, 3, 4, &z) && z == -1);
    assert_true(noc_ground_load(scene, 3, 4) < 20);
    noc_scene_destroy(scene);
}

/* Long and thin triangles over one place, as those of a large round surface: a ray looks at few of them, and finds what
 * all of them hold. */
static void test_thin(void **ctx) {
    enum { SPIKES = 20000, RAYS = 400 };
    noc_scene *scene = noc_scene_create(NULL);
    int ground = material(scene, NOC_CLASS_GROUND);
    double *xyz = noc_alloc(9 * SPIKES * sizeof(*xyz)), looked = 0;
    uint32_t *indices = noc_alloc(3 * SPIKES * sizeof(*indices));
    for (int i = 0; i < SPIKES; i++) {
        double angle = 2 * M_PI * i / SPIKES, width = 2 * M_PI / SPIKES, r[3] = { 300, 1000, 300 };
        for (int k = 0; k < 3; k++) {
            xyz[9 * i + 3 * k] = r[k] * cos(angle + width * k * .7);
            xyz[9 * i + 3 * k + 1] = r[k] * sin(angle + width * k * .7);
            xyz[9 * i + 3 * k + 2] = uniform(0, 5);
            indices[3 * i + k] = (uint32_t)(3 * i + k);
        }
    }
    noc_mesh mesh = {
        .vertex_count = 3 * SPIKES, .positions = xyz, .triangle_count = SPIKES, .indices = indices, .material = ground
    };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
    compare_at_random(scene, 1000, RAYS);
    for (int i = 0; i < RAYS; i++)
        looked += (double)noc_ground_load(scene, uniform(-1000, 1000), uniform(-1000, 1000));
    print_message("# %.0f of %d triangles a ray\n", looked / RAYS, SPIKES);
    assert_true(looked / RAYS < SPIKES / 20);
    free(xyz);
    free(indices);
    noc_scene_destroy(scene);
}

/* A thousand triangles reach to one height over one place, so that no ray can know the highest before it has looked at
 * all. What all rays look at before the commit is bounded, and those that end early are counted. */
static void test_looks_are_bounded(void **ctx) {
    (void)ctx;
    enum { N = 1000, RAYS = 2000 };
    size_t most = noc_ground_most_looks;
    noc_scene *scene = noc_scene_create(NULL);
    int mat = material(scene, NOC_CLASS_TERRAIN);
    for (int i = 0; i < N; i++)
        add_triangle(scene, mat, (double[]){ -100, -100 - .01 * i, 0, 100, -100, 0, 0, 200, 10 });
    noc_ground_most_looks = 0;
    double z;
    for (int i = 0; i < RAYS; i++)
        assert_true(noc_scene_ground(scene, -1 + .001 * i, 0, &z));
    size_t looked = noc_ground_looked(scene);
    assert_true(looked <= 200 * N + (32 + 8) * RAYS + 32 && looked > 200 * N);
    assert_true(scene->ground_work.cut > RAYS / 2 && scene->ground_work.cut < RAYS);
    noc_ground_most_looks = most;
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    looked = noc_ground_looked(scene);
    assert_true(noc_scene_ground(scene, 0, 0, &z));
    assert_int_equal(noc_ground_looked(scene), looked); /* who looks around later may look as long as it takes */
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_classes),        cmocka_unit_test(test_highest_wins),
        cmocka_unit_test(test_random),         cmocka_unit_test(test_watertight),
        cmocka_unit_test(test_ask_and_add),    cmocka_unit_test(test_threads),
        cmocka_unit_test(test_wide),           cmocka_unit_test(test_beyond),
        cmocka_unit_test(test_two_continents), cmocka_unit_test(test_looks_are_bounded),
        cmocka_unit_test(test_thin),           cmocka_unit_test(test_stack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
