/* The built-in city: the same for the same seed, in its bounds, lit as asked, nothing floating, nothing in one place
 * twice. */
#include "../test.h"

#include "scene/scene.h"

#include <math.h>

static int messages;

static void count_message(void *user, noc_log_level level, const char *text) { messages += level == NOC_LOG_ERROR; }

static noc_scene *city(double size, double lit, uint32_t seed) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_city_params params = noc_city_default_params();
    params.size = size;
    params.seed = seed;
    assert_int_equal(noc_scene_add_city(scene, &params), NOC_OK);
    noc_window_params windows = noc_window_default_params();
    windows.lit_windows = lit;
    noc_scene_light_windows(scene, &windows);
    return scene;
}

static size_t shining(const noc_scene *scene) {
    size_t n = 0;
    for (size_t i = 0; i < scene->lights.len; i++)
        n += scene->lights.data[i].e[0] > 0;
    return n;
}

static bool same(const noc_scene *a, const noc_scene *b) {
    return a->positions.len == b->positions.len && a->indices.len == b->indices.len && a->lights.len == b->lights.len &&
           !memcmp(a->positions.data, b->positions.data, a->positions.len * sizeof(float)) &&
           !memcmp(a->indices.data, b->indices.data, a->indices.len * sizeof(uint32_t)) &&
           !memcmp(a->triangle_material.data, b->triangle_material.data, a->triangle_material.len * sizeof(uint32_t)) &&
           !memcmp(a->lights.data, b->lights.data, a->lights.len * sizeof(noc_light_record));
}

static void test_deterministic(void **state) {
    noc_scene *a = city(300, 0.35, 1), *b = city(300, 0.35, 1), *c = city(300, 0.35, 2);
    assert_true(same(a, b));
    assert_false(same(a, c));
    noc_scene_destroy(a);
    noc_scene_destroy(b);
    noc_scene_destroy(c);
}

static void check_sane(const noc_scene *scene, double size) {
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_int_equal(info.triangles_dropped, 0);
    assert_int_equal(info.lights_inferred, 0);
    for (size_t i = 0; i < scene->positions.len; i++)
        assert_true(isfinite(scene->positions.data[i]));
    for (int k = 0; k < 2; k++) /* crowns of the outermost trees may lean out */
        assert_true(info.bounds_min[k] > -size / 2 - 3 && info.bounds_max[k] < size / 2 + 3);
    assert_true(info.bounds_min[2] > -10 && info.bounds_max[2] < 120);
    for (size_t i = 0; i < scene->lights.len; i++)
        assert_true((scene->lights.data[i].e[0] > 0 || noc_window_of(scene, (uint32_t)i)) &&
                    scene->light_names.data[i]);
}

static void test_sizes(void **state) {
    static const struct {
        double size;
        size_t triangles[2], lights[2];
    } table[] = {
        { 150, { 10000, 80000 }, { 150, 2000 } },
        { 420, { 150000, 450000 }, { 4000, 10000 } },
        { 800, { 600000, 2000000 }, { 14000, 36000 } },
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++)
        for (uint32_t seed = 1; seed < (i == 2 ? 2 : 6); seed++) {
            noc_scene *scene = city(table[i].size, 0.35, seed);
            size_t triangles = scene->indices.len / 3;
            assert_in_range(triangles, table[i].triangles[0], table[i].triangles[1]);
            assert_in_range(shining(scene), table[i].lights[0], table[i].lights[1]);
            check_sane(scene, table[i].size);
            noc_scene_destroy(scene);
        }
}

static void test_large(void **state) {
    noc_scene *scene = city(1500, 0.35, 3);
    assert_in_range(shining(scene), 45000, 110000);
    check_sane(scene, 1500);
    noc_scene_destroy(scene);
}

static size_t named(const noc_scene *scene, const char *name) {
    size_t n = 0;
    for (size_t i = 0; i < scene->lights.len; i++)
        n += !strcmp(scene->light_names.data[i], name);
    return n;
}

/* Of flats and offices as many are lit as is asked for, of shops three times as many. */
static void test_lit_share(void **state) {
    static const double shares[] = { 0, 0.1, 0.35, 0.8, 1 };
    for (size_t i = 0; i < NOC_COUNT(shares); i++) {
        noc_scene *scene = city(420, shares[i], 7);
        double windows[2] = { 0 }, lit[2] = { 0 };
        for (size_t k = 0; k < scene->windows.len; k++) {
            const noc_scene_window *w = &scene->windows.data[k];
            bool shop = w->kind == NOC_WINDOW_SHOP;
            windows[shop]++;
            lit[shop] += scene->lights.data[w->light].e[0] > 0;
        }
        assert_true(windows[0] > 5000 && windows[1] > 100);
        assert_true(fabs(lit[0] / windows[0] - shares[i]) < 0.04);
        assert_true(fabs(lit[1] / windows[1] - fmin(3 * shares[i], 1)) < 0.1);
        assert_true(named(scene, "lamp") > 200);
        noc_scene_destroy(scene);
    }
}

/* Lamps hang where lamps hang, over ground they stand on, and give the light they are meant to. */
static void test_lamps(void **state) {
    noc_scene *scene = city(420, 0.35, 1);
    size_t globes = 0, arms = 0;
    for (size_t i = 0; i < scene->lights.len; i++) {
        const noc_light_record *r = &scene->lights.data[i];
        if (strcmp(scene->light_names.data[i], "lamp"))
            continue;
        double z, luminance = 0.2126 * r->e[0] + 0.7152 * r->e[1] + 0.0722 * r->e[2],
                  lumens = M_PI * luminance * r->area;
        assert_true(noc_scene_ground(scene, r->p[0], r->p[1], &z));
        double height = r->p[2] - z;
        if (r->kind == NOC_LIGHT_SPHERE) {
            globes++;
            assert_true(height > 3.9 && height < 5);
            assert_true(lumens > 3000 && lumens < 4000);
        } else {
            arms++;
            assert_int_equal(r->kind, NOC_LIGHT_DISC);
            assert_true(height > 8 && height < 9.1);
            assert_true(lumens > 8000 && lumens < 12000);
            assert_true(r->a[0] * r->b[1] - r->a[1] * r->b[0] < 0); /* faces down */
            assert_true(r->e[0] > 3 * r->e[2]);                     /* sodium */
        }
    }
    assert_true(globes > 100 && arms > 60);
    noc_scene_destroy(scene);
}

/* ---- rays ---- */

typedef struct hit {
    double t;
    uint32_t triangle;
} hit;

/* The two nearest hits in [from, to]; nearest first. Light shapes count unless skip_lights. */
static int nearest(const noc_scene *s, const double o[3], const double d[3], double from, double to, bool skip_lights,
                   hit out[2]) {
    int n = 0;
    for (size_t t = 0; t < s->indices.len / 3; t++) {
        if (skip_lights && s->triangle_light.data[t] != NOC_NO_LIGHT)
            continue;
        const float *p[3];
        double e1[3], e2[3], h[3], q[3], w[3];
        for (int i = 0; i < 3; i++)
            p[i] = s->positions.data + 3 * (size_t)s->indices.data[3 * t + i];
        for (int k = 0; k < 3; k++)
            e1[k] = (double)p[1][k] - p[0][k], e2[k] = (double)p[2][k] - p[0][k], w[k] = o[k] - p[0][k];
        for (int k = 0; k < 3; k++)
            h[k] = d[(k + 1) % 3] * e2[(k + 2) % 3] - d[(k + 2) % 3] * e2[(k + 1) % 3];
        double det = e1[0] * h[0] + e1[1] * h[1] + e1[2] * h[2];
        if (fabs(det) < 1e-12)
            continue;
        double u = (w[0] * h[0] + w[1] * h[1] + w[2] * h[2]) / det;
        if (u < 0 || u > 1)
            continue;
        for (int k = 0; k < 3; k++)
            q[k] = w[(k + 1) % 3] * e1[(k + 2) % 3] - w[(k + 2) % 3] * e1[(k + 1) % 3];
        double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det,
               at = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
        if (v < 0 || u + v > 1 || at < from || at > to)
            continue;
        hit fresh = { at, (uint32_t)t };
        if (n == 0 || at < out[0].t) {
            out[1] = out[0];
            out[0] = fresh;
            n = NOC_MIN(n + 1, 2);
        } else if (n == 1 || at < out[1].t) {
            out[1] = fresh;
            n = 2;
        }
    }
    return n;
}

/* Before every window there is air, and beyond its edges something that it is fixed to. */
static void test_windows_on_walls(void **state) {
    noc_scene *scene = city(240, 0.35, 4);
    size_t checked = 0, stride = scene->windows.len / 120 + 1;
    for (size_t i = 0; i < scene->windows.len; i += stride) {
        const noc_light_record *r = &scene->lights.data[scene->windows.data[i].light];
        if (scene->windows.data[i].kind == NOC_WINDOW_SHOP)
            continue;
        double n[3], l = 0, back[3];
        for (int k = 0; k < 3; k++)
            n[k] = (double)r->a[(k + 1) % 3] * r->b[(k + 2) % 3] - (double)r->a[(k + 2) % 3] * r->b[(k + 1) % 3],
            l += n[k] * n[k];
        for (int k = 0; k < 3; k++)
            n[k] /= sqrt(l), back[k] = -n[k];
        bool open = false;
        for (int j = 0; j < 3; j++) { /* a bar of the frame may be before one of the points */
            double f[2] = { 0.2 + 0.27 * j, 0.25 + 0.13 * j }, o[3];
            hit h[2] = { 0 };
            for (int k = 0; k < 3; k++)
                o[k] = r->p[k] + f[0] * r->a[k] + f[1] * r->b[k];
            open = open || nearest(scene, o, n, 1e-3, 0.6, false, h) == 0;
        }
        assert_true(open);
        for (int j = 0; j < 4; j++) {
            static const double beyond[4][2] = { { -0.06, 0.5 }, { 1.06, 0.5 }, { 0.5, -0.06 }, { 0.5, 1.06 } };
            double o[3];
            hit h[2] = { 0 };
            for (int k = 0; k < 3; k++)
                o[k] = r->p[k] + beyond[j][0] * r->a[k] + beyond[j][1] * r->b[k] + 0.25 * n[k];
            assert_true(nearest(scene, o, back, 0, 0.3, true, h) > 0);
        }
        checked++;
    }
    assert_true(checked > 80);
    noc_scene_destroy(scene);
}

static uint32_t random_state = 99;

static double uniform(double lo, double hi) {
    random_state = random_state * 1664525u + 1013904223u;
    return lo + (hi - lo) * (random_state >> 8) / 16777216.0;
}

/* Where a ray from the open air first meets something, it must not meet another material at the same distance. (Houses
 * of a row do share a wall; nobody sees it.) */
static void test_no_surface_twice(void **state) {
    noc_scene *scene = city(240, 0.35, 5);
    int hits = 0, twice = 0;
    for (int i = 0; i < 700; i++) {
        double o[3] = { uniform(-110, 110), uniform(-110, 110), uniform(1, 60) }, d[3], l = 0, z;
        for (int k = 0; k < 3; k++)
            d[k] = uniform(-1, 1), l += d[k] * d[k];
        if (l < 0.1 || (noc_scene_top(scene, o[0], o[1], &z) && z > o[2]))
            continue;
        hit h[2];
        int n = nearest(scene, o, d, 0, 1e9, false, h);
        hits += n > 0;
        twice += n == 2 && h[1].t - h[0].t < 1e-5 &&
                 scene->triangle_material.data[h[0].triangle] != scene->triangle_material.data[h[1].triangle];
    }
    assert_true(hits > 200);
    assert_int_equal(twice, 0);
    noc_scene_destroy(scene);
}

static void test_bad_params(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = count_message });
    noc_scene *scene = noc_scene_create(log);
    noc_city_params bad[4];
    for (int i = 0; i < 4; i++)
        bad[i] = (noc_city_params)noc_city_default_params();
    bad[0].size = 149.9, bad[1].size = 5000.1, bad[2].size = NAN, bad[3].size = -420;
    for (int i = 0; i < 4; i++) {
        messages = 0;
        assert_int_equal(noc_scene_add_city(scene, &bad[i]), NOC_ERR_ARGUMENT);
        assert_int_equal(messages, 1);
    }
    assert_int_equal(scene->indices.len + scene->lights.len + scene->materials.len, 0);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    messages = 0;
    assert_int_equal(noc_scene_add_city(scene, &noc_city_default_params()), NOC_ERR_ARGUMENT);
    assert_int_equal(messages, 1);
    assert_int_equal(scene->materials.len, 0);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

static void test_no_params(void **state) {
    noc_scene *given = noc_scene_create(NULL), *none = noc_scene_create(NULL);
    assert_int_equal(noc_scene_add_city(given, &noc_city_default_params()), NOC_OK);
    assert_int_equal(noc_scene_add_city(none, NULL), NOC_OK);
    assert_int_equal(none->positions.len, given->positions.len);
    assert_memory_equal(none->positions.data, given->positions.data, given->positions.len * sizeof(float));
    noc_scene_destroy(given);
    noc_scene_destroy(none);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_deterministic),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_lit_share),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_windows_on_walls),
        cmocka_unit_test(test_no_surface_twice),
        cmocka_unit_test(test_bad_params),
        cmocka_unit_test(test_no_params),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
