/* Illuminance by every unbiased method and picker, against the reference: as test_unbiased.c has it of pictures. What
 * is biased must be found. Of few samples the rare bright ones are not among them: the quick suite has all. */
#include "unbiased.h"

/* A glossy coloured floor, whose target is far from what it is lit with, walls, boxes that stand in the light, and
 * lights of every kind. */
static noc_scene *court(void) {
    noc_scene *s = noc_scene_create(NULL);
    int wet =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.4f, 0.1f, 0.02f }, .f0 = 0.05f, .roughness = 0.3f });
    int wall = noc_scene_add_material(s, &(noc_material){ .albedo = { 0.2f, 0.5f, 0.7f }, .roughness = 1 });
    add_floor(s, wet, 0, 0, 0, 15);
    QUAD(s, wall, -10, 6.2, 0, 20, 0, 0, 0, 0, 9); /* faces -y */
    for (int i = 0; i < 8; i++) {
        double x = -7 + 3.2 * (i % 4), y = 2 - 4 * (i / 4);
        QUAD(s, wall, x, y, 0, 1.5, 0, 0, 0, 0, 2);
        QUAD(s, wall, x, y, 2, 1.5, 0, 0, 0, 1.5, 0);
    }
    for (int i = 0; i < 60; i++) {
        noc_light l = crowd_light(i, 6);
        l.emission[i % 3] *= 4;
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static const config unbiased[] = {
    { "is", NOC_METHOD_IS, .lux = true },
    { "ris", NOC_METHOD_RIS, .reuse = true, .lux = true },
    { "ris, power", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_POWER, .lux = true },
    { "ris, influence", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_INFLUENCE, .lux = true, .times = 8 },
    { "ris, light-bvh", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_LIGHT_BVH, .lux = true },
    { "ris, lists of 12", NOC_METHOD_RIS, .list = 12, .reuse = true, .lux = true },
    { "ris, lists of 12, 1 ray", NOC_METHOD_RIS, .list = 12, .reuse = true, .shadow_rays = 1, .lux = true },
    { "pairwise + rays, lists of 12", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .spatial = true,
      .rays = true, .reuse = true, .list = 12, .lux = true },
    { "pairwise + rays in time, lists of 12, 4 rays", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true,
      .rays = true, .reuse = true, .list = 12, .shadow_rays = 4, .lux = true },
    { "mis + rays, lists of 12", NOC_METHOD_RESTIR, NOC_BIAS_MIS, .temporal = true, .spatial = true, .rays = true,
      .reuse = true, .list = 12, .shadow_rays = 3, .lux = true },
    { "mis + rays", NOC_METHOD_RESTIR, NOC_BIAS_MIS, .temporal = true, .spatial = true, .rays = true, .reuse = true,
      .lux = true },
    { "mis + rays, power", NOC_METHOD_RESTIR, NOC_BIAS_MIS, .temporal = true, .spatial = true, .rays = true,
      .reuse = true, .picker = NOC_CANDIDATES_POWER, .lux = true, .times = 8 },
    { "pairwise + rays, influence", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .spatial = true,
      .rays = true, .reuse = true, .picker = NOC_CANDIDATES_INFLUENCE, .lux = true },
    { "pairwise + rays, light-bvh", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .spatial = true,
      .rays = true, .reuse = true, .picker = NOC_CANDIDATES_LIGHT_BVH, .lux = true },
};

static const config biased[] = {
    { "biased", NOC_METHOD_RESTIR, NOC_BIAS_BIASED, .temporal = true, .spatial = true, .reuse = true, .lux = true },
    { "pairwise, no rays", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .spatial = true, .reuse = true,
      .lux = true, .times = 2 },
};

static void every_method_and_picker(void **state) {
    (void)state;
    noc_scene *s = court();
    result reference = measure_reference_of(s, false, NULL, all_samples(1500), true);
    int wrong = 0;
    for (size_t i = 0; i < NOC_COUNT(unbiased); i++) {
        result x = measure_runs(s, &unbiased[i], false, NULL, all_samples(300 * NOC_MAX(unbiased[i].times, 1)));
        wrong += !agrees(unbiased[i].name, &x, &reference);
    }
    for (size_t i = 0; i < NOC_COUNT(biased); i++) {
        result x = measure_runs(s, &biased[i], false, NULL, all_samples(300 * NOC_MAX(biased[i].times, 1)));
        double z = worst(biased[i].name, &x, &reference);
        wrong += SANITIZED ? !isfinite(z) : z <= 4;
    }
    noc_scene_destroy(s);
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(every_method_and_picker) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
