/* The built-in scenes: the same for the same seed, of the sizes asked for, faces outwards, lights where they stand or
 * hang. */
#include "../test.h"

#include "scene/scene.h"

#include <math.h>
#include <nocturne/option.h>
#include <nocturne/import.h>

static char last_error[1024];

static void on_message(void *user, noc_log_level level, const char *text) {
    if (level == NOC_LOG_ERROR)
        snprintf(last_error, sizeof(last_error), "%s", text);
}

static noc_scene *make(const char *name, uint32_t seed, int lights) {
    noc_scene *scene = noc_scene_create(NULL);
    noc_builtin_params params = noc_builtin_default_params();
    params.seed = seed;
    params.lights = lights;
    params.city.size = 150;
    assert_int_equal(noc_scene_add_builtin(scene, name, &params), NOC_OK);
    return scene;
}

static bool same(const noc_scene *a, const noc_scene *b) {
    return a->positions.len == b->positions.len && a->indices.len == b->indices.len && a->lights.len == b->lights.len &&
           !memcmp(a->positions.data, b->positions.data, a->positions.len * sizeof(float)) &&
           !memcmp(a->indices.data, b->indices.data, a->indices.len * sizeof(uint32_t)) &&
           !memcmp(a->lights.data, b->lights.data, a->lights.len * sizeof(noc_light_record));
}

static void test_deterministic(void **state) {
    for (const char *const *name = noc_builtin_names(); *name; name++) {
        noc_scene *a = make(*name, 1, 500), *b = make(*name, 1, 500), *c = make(*name, 2, 500);
        bool seeded = !strcmp(*name, "mess") || !strcmp(*name, "cityscape");
        assert_true(same(a, b));
        assert_int_equal(same(a, c), !seeded);
        noc_scene_destroy(a);
        noc_scene_destroy(b);
        noc_scene_destroy(c);
    }
}

static void test_sizes(void **state) {
    static const struct {
        const char *name;
        size_t triangles[2], lights[2];
    } table[] = {
        { "cityscape", { 200000, 800000 }, { 4000, 9000 } },
        { "mess", { 100000, 500000 }, { 3000, 3000 } },
        { "single", { 20000, 150000 }, { 1, 1 } },
        { "atrium", { 200000, 300000 }, { 1, 1 } },
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        noc_scene *scene = make(table[i].name, 1, 3000);
        noc_scene_info info;
        noc_scene_get_info(scene, &info);
        assert_in_range(info.triangles, table[i].triangles[0], table[i].triangles[1]);
        assert_in_range(info.lights, table[i].lights[0], table[i].lights[1]);
        assert_int_equal(info.triangles_dropped, 0);
        for (size_t k = 0; k < scene->positions.len; k++)
            assert_true(isfinite(scene->positions.data[k]));
        for (size_t k = 0; k < scene->lights.len; k++)
            assert_true((scene->lights.data[k].e[0] > 0 || noc_window_of(scene, (uint32_t)k)) &&
                        scene->light_names.data[k]);
        noc_scene_destroy(scene);
    }
}

static void test_cameras(void **state) {
    for (const char *const *name = noc_builtin_names(); *name; name++) {
        noc_scene *scene = make(*name, 1, 200);
        noc_camera own, street;
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_OWN, 16. / 9, &own), NOC_OK);
        assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 16. / 9, &street), NOC_OK);
        bool has_own = strcmp(*name, "city") != 0;
        assert_int_equal(memcmp(own.eye, street.eye, sizeof(own.eye)) == 0, !has_own);
        double top;
        if (noc_scene_top(scene, own.eye[0], own.eye[1], &top)) /* nothing but sky over it */
            assert_true(top < own.eye[2] - 0.5);
        noc_scene_destroy(scene);
    }
}

/* By the divergence theorem; bottoms that are missing lie in z = 0 and would add nothing. */
static double volume(const noc_scene *s, const noc_scene_mesh *m) {
    double sum = 0;
    for (uint32_t t = m->first_triangle; t < m->first_triangle + m->triangle_count; t++) {
        const float *p[3];
        for (uint32_t i = 0; i < 3; i++)
            p[i] = &s->positions.data[3 * (size_t)s->indices.data[3 * t + i]];
        for (int k = 0; k < 3; k++)
            sum += (double)p[0][k] *
                   ((double)p[1][(k + 1) % 3] * p[2][(k + 2) % 3] - (double)p[1][(k + 2) % 3] * p[2][(k + 1) % 3]) / 6;
    }
    return sum;
}

static void test_faces_outwards(void **state) {
    static const struct {
        const char *scene, *mesh;
        double least, most;
        size_t count;
    } table[] = {
        { "mess", "object", 0.002, 1.6, 40 },
        { "single", "knot", 0.5, 2.5, 1 },
        { "single", "plinth", 2, 4.2, 1 },
    };
    for (size_t i = 0; i < NOC_COUNT(table); i++) {
        noc_scene *s = make(table[i].scene, 1, 10);
        size_t found = 0;
        for (size_t m = 0; m < s->meshes.len; m++)
            if (!strcmp(s->meshes.data[m].name, table[i].mesh)) {
                double v = volume(s, &s->meshes.data[m]);
                assert_true(v > table[i].least && v < table[i].most);
                found++;
            }
        assert_true(found >= table[i].count);
        noc_scene_destroy(s);
    }
}

/* Distance of p to the nearest triangle that shows no light, of those whose plane it stands over. */
static double distance_to_surface(const noc_scene *s, const double p[3]) {
    double least = INFINITY;
    for (size_t t = 0; t < s->triangle_light.len; t++) {
        if (s->triangle_light.data[t] != NOC_NO_LIGHT)
            continue;
        double v[3][3], n[3], u[3], w[3], d = 0, n2 = 0, inside = INFINITY;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                v[i][k] = (double)s->positions.data[3 * (size_t)s->indices.data[3 * t + (size_t)i] + (size_t)k] - p[k];
        for (int k = 0; k < 3; k++)
            u[k] = v[1][k] - v[0][k], w[k] = v[2][k] - v[0][k];
        for (int k = 0; k < 3; k++)
            n[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
        for (int k = 0; k < 3; k++)
            d += n[k] * v[0][k], n2 += n[k] * n[k];
        for (int i = 0; i < 3; i++) { /* signed area of the triangle that p makes with each edge */
            const double *a = v[i], *b = v[(i + 1) % 3];
            double area = 0;
            for (int k = 0; k < 3; k++)
                area += n[k] * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
            inside = fmin(inside, area);
        }
        if (n2 > 0 && inside > -1e-9 * n2)
            least = fmin(least, fabs(d) / sqrt(n2));
    }
    return least;
}

/* Lights of the mess touch what they stand on; there are as many as asked for, of the kinds that are promised. */
static void test_mess(void **state) {
    static const int counts[] = { 1, 7, 3000, 20001 };
    double flux[NOC_COUNT(counts)] = { 0 };
    for (size_t c = 0; c < NOC_COUNT(counts); c++) {
        noc_scene *s = make("mess", 3, counts[c]);
        assert_int_equal(s->lights.len, counts[c]);
        for (size_t i = 0; i < s->lights.len; i++) {
            const noc_light_record *r = &s->lights.data[i];
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += (double)r->e[k];
            flux[c] += sum * r->area;
            assert_true(counts[c] <= 20000 || r->kind == NOC_LIGHT_PARALLELOGRAM || r->kind == NOC_LIGHT_TRIANGLE);
            if (counts[c] != 3000 || i % 50)
                continue;
            bool flat = r->kind == NOC_LIGHT_PARALLELOGRAM || r->kind == NOC_LIGHT_TRIANGLE;
            double p[3]; /* the middle of the edge that it stands on, or the centre; a disc leans back by 53 degrees */
            for (int k = 0; k < 3; k++)
                p[k] = (double)r->p[k] + (flat ? 0.5 * (double)r->a[k] : 0);
            assert_true(distance_to_surface(s, p) < (flat                        ? 0.003
                                                     : r->kind == NOC_LIGHT_DISC ? 0.75 * r->radius
                                                                                 : 1.1 * r->radius));
        }
        noc_scene_destroy(s);
    }
    assert_true(flux[2] / flux[3] > 0.9 && flux[2] / flux[3] < 1.1); /* shared among them */
}

/* Party lights hang from their cables. */
static void test_cityscape(void **state) {
    noc_scene *s = make("cityscape", 1, 1);
    size_t bulbs = 0, spots = 0, coloured = 0;
    for (size_t i = 0; i < s->lights.len; i++) {
        const noc_light_record *r = &s->lights.data[i];
        spots += !strcmp(s->light_names.data[i], "coloured floodlight");
        if (strcmp(s->light_names.data[i], "party light"))
            continue;
        coloured += r->e[0] > 3 * r->e[1] || r->e[1] > 3 * r->e[0] || r->e[2] > 3 * r->e[0];
        if (bulbs++ % 40)
            continue;
        double least = INFINITY;
        for (size_t t = 0; t < s->triangle_light.len; t++)
            if (s->triangle_light.data[t] == NOC_NO_LIGHT) {
                const float *v = &s->positions.data[3 * (size_t)s->indices.data[3 * t]];
                double d = 0;
                for (int k = 0; k < 3; k++)
                    d += pow((double)v[k] - r->p[k], 2);
                least = fmin(least, sqrt(d));
            }
        assert_true(least < 2 * r->radius);
        assert_in_range((int)(r->p[2] * 10), 47, 62);
    }
    assert_in_range(bulbs, 1500, 6000);
    assert_true(coloured > bulbs / 2);
    assert_true(spots > 50);
    noc_scene_destroy(s);
}

static void test_wrong(void **state) {
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = on_message });
    noc_scene *scene = noc_scene_create(log);
    assert_int_equal(noc_scene_add_builtin(scene, "village", NULL), NOC_ERR_ARGUMENT);
    for (const char *const *name = noc_builtin_names(); *name; name++)
        assert_non_null(strstr(last_error, *name));
    noc_builtin_params params = noc_builtin_default_params();
    for (int i = 0; i < 3; i++) {
        params.lights = i == 0 ? 0 : i == 1 ? -5 : 1000001;
        assert_int_equal(noc_scene_add_builtin(scene, "mess", &params), NOC_ERR_ARGUMENT);
        assert_int_equal(scene->indices.len, 0);
    }
    const noc_camera bad[] = { { .up = { 0, 0, 1 }, .fov_deg = 50 },
                               { .target = { 1 }, .fov_deg = 50 },
                               { .target = { 1 }, .up = { 0, 0, 1 }, .fov_deg = 0 },
                               { .target = { NAN }, .up = { 0, 0, 1 }, .fov_deg = 50 } };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_int_equal(noc_scene_set_camera(scene, &bad[i]), NOC_ERR_ARGUMENT);
    const char *inputs[] = { "builtin:single" }, *unknown[] = { "builtin:village" };
    assert_int_equal(noc_scene_load(scene, unknown, 1, NULL, NULL), NOC_ERR_ARGUMENT);
    noc_scene_destroy(scene);
    scene = noc_scene_create(log);
    assert_int_equal(noc_scene_load(scene, inputs, 1, NULL, NULL), NOC_OK);
    assert_int_equal(scene->lights.len, 1);
    assert_int_equal(noc_scene_add_builtin(scene, "mess", NULL), NOC_ERR_ARGUMENT); /* committed */
    noc_scene_destroy(scene);
    noc_log_destroy(log);
}

/* As inputs: with the params of all inputs, before files, and with a camera that people say. */
static void test_as_input(void **state) {
    (void)state;
    noc_scene *one = noc_scene_create(NULL), *other = noc_scene_create(NULL);
    noc_builtin_params builtin = noc_builtin_default_params();
    noc_import_params params = noc_import_default_params();
    char keys[2][NOC_CONTENT_KEY];
    builtin.lights = 77;
    builtin.seed = 5;
    params.builtin = &builtin;
    assert_int_equal(noc_scene_load(one, (const char *[]){ "builtin:mess" }, 1, &params, NULL), NOC_OK);
    assert_int_equal(noc_scene_add_builtin(other, "mess", &builtin), NOC_OK);
    assert_int_equal(noc_scene_commit(other), NOC_OK);
    noc_scene_content(one, keys[0]);
    noc_scene_content(other, keys[1]);
    assert_string_equal(keys[0], keys[1]);
    noc_scene_destroy(other);

    noc_camera camera = { .fov_deg = 7 }, own;
    bool far_away = true;
    assert_int_equal(noc_scene_camera(one, NOC_VIEWPOINT_OWN, 1.5, &own), NOC_OK);
    assert_int_equal(noc_scene_place_camera(one, NULL, 1.5, &camera, &far_away), NOC_OK);
    assert_memory_equal(&camera, &own, sizeof(own));
    assert_false(far_away);
    noc_camera_params place = { .eye = "1,2,30", .target = "1,2,0", .fov = 40 };
    assert_int_equal(noc_scene_place_camera(one, &place, 1.5, &camera, &far_away), NOC_OK);
    assert_true(camera.eye[2] == 30 && camera.up[1] == 1 && camera.fov_deg == 40 && !far_away);
    place.eye = "1,2,3e4";
    assert_int_equal(noc_scene_place_camera(one, &place, 1.5, &camera, &far_away), NOC_OK);
    assert_true(far_away);
    static const char *const wrong[] = { NULL, "1,2", "1e9,0,0" };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        place.eye = wrong[i];
        assert_int_equal(noc_scene_place_camera(one, &place, 1.5, &camera, NULL), NOC_ERR_ARGUMENT);
        assert_true(camera.eye[2] == 3e4); /* as it was */
    }
    noc_scene_destroy(one);

    const noc_option *size = noc_city_options();
    assert_string_equal(noc_option_needs_input(size, (const char *[]){ "builtin:mess" }, 1), "builtin:city");
    assert_null(noc_option_needs_input(size, (const char *[]){ "a.gml", "builtin:city" }, 2));
    assert_null(noc_option_needs_input(noc_render_options(), NULL, 0));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_deterministic),  cmocka_unit_test(test_sizes),    cmocka_unit_test(test_cameras),
        cmocka_unit_test(test_faces_outwards), cmocka_unit_test(test_mess),     cmocka_unit_test(test_cityscape),
        cmocka_unit_test(test_wrong),          cmocka_unit_test(test_as_input),
    };
    return cmocka_run_group_tests_name("city/scenes", tests, NULL, NULL);
}
