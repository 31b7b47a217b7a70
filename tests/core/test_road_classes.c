/* Roads as drivers see them: the average luminance coefficient Q0 and the specular factor S1 of the materials, by the
 * formulas of CIE 144:2001 from core/surface.h, against the classes R1 to R4 of dry roads and W1 to W4 of wet ones, and
 * against what docs/defaults.md tells of them. */
#include "core_test.h"
#include "core/surface.h"
#include "no_profiles.h"
#include "scene/scene.h"

#include <nocturne/nocturne.h>

/* The observer looks down by 1 degree along x, so a lamp ahead is at x > 0. */
static double coefficient(const noc_material *m, double x, double y) {
    noc_material_record r = noc_material_record_of(m);
    double down = M_PI / 180, l = sqrt(x * x + y * y + 1);
    surf s = { .n = { 0, 0, 1 },
               .wo = { (float)-cos(down), 0, (float)sin(down) },
               .albedo = { r.albedo[0], r.albedo[1], r.albedo[2] },
               .f0 = r.f0,
               .alpha = r.alpha };
    return luminance(reflect(s, V3((float)(x / l), (float)(y / l), (float)(1 / l)))) * l; /* over cos(gamma) */
}

/* q over the solid angle of lamps up to 4 heights behind, 12 ahead and 3 to each side, the area of r-tables. */
static double average(const noc_material *m) {
    enum { ALONG = 640, ACROSS = 240 };
    double sum = 0, all = 0;
    for (int i = 0; i < ALONG; i++)
        for (int j = 0; j < ACROSS; j++) {
            double x = (i + .5) / ALONG * 16 - 4, y = (j + .5) / ACROSS * 6 - 3;
            double solid = pow(x * x + y * y + 1, -1.5);
            sum += coefficient(m, x, y) * solid;
            all += solid;
        }
    return sum / all;
}

/* r(0, 2) / r(0, 0), r = q cos(gamma)^3. */
static double specular(const noc_material *m) { return coefficient(m, 2, 0) * pow(5, -1.5) / coefficient(m, 0, 0); }

/* A matte surface has q = albedo / pi everywhere, and so S1 = 5^-1.5: the formulas are known to be right. */
static void test_matte(void **state) {
    const noc_material m = { .albedo = { .3f, .3f, .3f }, .roughness = 1 };
    assert_close(average(&m), .3 / M_PI, 1e-5);
    assert_close(specular(&m), .0894427, 1e-5);
}

enum { TOLERANCE = 7 }; /* % of both */

static bool near(double have, double want) { return fabs(have - want) <= TOLERANCE / 100. * want; }

static noc_material surface_of(const noc_road_class *c) {
    return (noc_material){ .albedo = { c->albedo, c->albedo, c->albedo }, .f0 = c->f0, .roughness = c->roughness };
}

static const noc_road_class *class_of(const char *name) {
    for (const noc_road_class *c = noc_road_classes(); c->name; c++)
        if (!strcmp(c->name, name))
            return c;
    fail_msg("no class %s", name);
    return NULL;
}

/* Where the classes begin: S1 of dry roads, of wet ones Frederiksen and Sorensen's S1', which is computed of S1 and Q0
 * (W. van Bommel, Road Lighting, Springer 2015, tables 12.2 and 12.3). */
static const double limits[2][5] = { { 0, .42, .85, 1.35, INFINITY }, { 0, 4.5, 7.2, 9.8, 12 } };

static void test_each_class_is_met(void **state) {
    int count = 0;
    for (const noc_road_class *c = noc_road_classes(); c->name; c++, count++) {
        noc_material m = surface_of(c);
        double q0 = average(&m), s1 = specular(&m);
        print_message("# %s: albedo %g, f0 %g, roughness %g: Q0 %.3f for %g, S1 %.2f for %g\n", c->name,
                      (double)c->albedo, (double)c->f0, (double)c->roughness, q0, c->q0, s1, c->s1);
        if (!near(q0, c->q0) || !near(s1, c->s1))
            fail_msg("%s: Q0 %.4f for %g, S1 %.3f for %g", c->name, q0, c->q0, s1, c->s1);
        const double *at = limits[*c->name == 'W'] + (c->name[1] - '1');
        assert_true(s1 >= at[0] && s1 < at[1]);
    }
    assert_int_equal(count, 8);
}

/* The test can fail: no class is another one. */
static void test_classes_differ(void **state) {
    for (const noc_road_class *c = noc_road_classes(); c->name; c++)
        for (const noc_road_class *d = noc_road_classes(); d->name; d++) {
            noc_material m = surface_of(d);
            assert_true(c == d || !near(average(&m), c->q0) || !near(specular(&m), c->s1));
        }
}

/* docs/defaults.md has a row of each class, with the digits of the table and what is computed here. */
static void test_docs_tell_each_class(void **state) {
    char path[4096], row[200];
    static char text[200000];
    snprintf(path, sizeof(path), "%s/docs/defaults.md", getenv("NOC_SOURCE") ? getenv("NOC_SOURCE") : ".");
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    text[fread(text, 1, sizeof(text) - 1, f)] = 0;
    fclose(f);
    for (const noc_road_class *c = noc_road_classes(); c->name; c++) {
        noc_material m = surface_of(c), rained = noc_material_wet(&m);
        double s1 = specular(&m), wet = specular(&rained);
        int n = snprintf(row, sizeof(row), "| %s | %g, %g, %g | %.3f | %.*f | %g | %g |", c->name, (double)c->albedo,
                         (double)c->f0, (double)c->roughness, average(&m), s1 < 2 ? 2 : 1, s1, c->q0, c->s1);
        if (*c->name == 'R')
            snprintf(row + n, sizeof(row) - (size_t)n, " %.3f, %.1f |", average(&rained), wet);
        if (!strstr(text, row))
            fail_msg("docs/defaults.md has no row %s", row);
    }
}

static void check_dry(const noc_material *m) {
    const noc_road_class *r3 = class_of("R3");
    assert_true(near(average(m), r3->q0) && near(specular(m), r3->s1));
}

static void test_dry_road_is_r3(void **state) {
    noc_material road = noc_class_material(NOC_CLASS_ROAD), r3 = surface_of(class_of("R3"));
    check_dry(&road);
    assert_memory_equal(road.albedo, r3.albedo, sizeof(road.albedo));
    assert_true(road.f0 == r3.f0 && road.roughness == r3.roughness);
}

/* Its carriageway is the darkest of its materials of class road, the others are markings. */
static void test_road_of_the_builtin_city_is_r3(void **state) {
    noc_scene *s = noc_scene_create(NULL);
    noc_city_params p = noc_city_default_params();
    noc_material road = { .albedo = { 1, 1, 1 } }, m;
    p.size = 150;
    assert_int_equal(noc_scene_add_city(s, &p), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    for (size_t i = 0; i < s->materials.len; i++) {
        m = s->materials.data[i];
        if (m.cls == NOC_CLASS_ROAD && m.albedo[1] < road.albedo[1])
            road = m;
    }
    check_dry(&road);
    noc_scene_destroy(s);
}

/* After rain the default road is as light as W2; its S1 is that of no mirror. */
static void test_wet_road_is_as_light_as_w2(void **state) {
    noc_material road = noc_class_material(NOC_CLASS_ROAD), wet = noc_material_wet(&road), mirror = wet;
    double q0 = average(&wet), s1 = specular(&wet);
    assert_true(near(q0, class_of("W2")->q0));
    assert_true(s1 > 4.5 && s1 < 12);
    mirror.roughness = .15f; /* the test can fail: a film without grains is lighter than W4, in a narrow streak */
    assert_true(average(&mirror) > .247);
}

/* W1 to W4 are wet: rain makes nothing else of them. */
static void test_wet_classes_stay(void **state) {
    for (const noc_road_class *c = noc_road_classes(); c->name; c++) {
        noc_material m = surface_of(c), wet = noc_material_wet(&m);
        assert_true((*c->name == 'W') == !memcmp(&m, &wet, sizeof(m)));
    }
    noc_material nearly = surface_of(class_of("W2"));
    nearly.roughness = .6f;
    assert_true(noc_material_wet(&nearly).albedo[0] < nearly.albedo[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_matte),
        cmocka_unit_test(test_each_class_is_met),
        cmocka_unit_test(test_classes_differ),
        cmocka_unit_test(test_docs_tell_each_class),
        cmocka_unit_test(test_dry_road_is_r3),
        cmocka_unit_test(test_road_of_the_builtin_city_is_r3),
        cmocka_unit_test(test_wet_road_is_as_light_as_w2),
        cmocka_unit_test(test_wet_classes_stay),
    };
    return cmocka_run_group_tests_name("road-classes", tests, NULL, NULL);
}
