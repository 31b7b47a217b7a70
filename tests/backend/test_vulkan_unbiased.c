/* Unbiased combinations on the Vulkan device, by rays of its own, against the reference of the CPU. Few rows: the bits
 * between rays are the CPU's (test_vulkan.c), whose rows hold the rest (render/test_unbiased.c). */
#include "../render/unbiased.h"

#include "../own_view.h"

/* A floor, a wall with windows, and a screen that shadows them. */
static noc_scene *court(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    add_floor(s, grey, 0, 0, 0, 14);
    QUAD(s, grey, -10, 10, 0, 20, 0, 0, 0, 0, 10);
    QUAD(s, grey, -6, 3, 0, 9, 1, 0, 0, 0, 4);
    for (int i = 0; i < 40; i++) {
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                        .position = { -9.5 + 1.9 * (i % 10), 9.99, 0.8 + 2.2 * (i / 10) },
                        .edge_u = { 0.7, 0, 0 },
                        .edge_v = { 0, 0, 0.9 },
                        .emission = { 3.f + (float)(i * 7 % 11), 4.f, 1.f + (float)(i % 5) } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static void pairwise_with_rays(void **state) {
    static const config row = { "pairwise + rays on Vulkan",
                                NOC_METHOD_RESTIR,
                                NOC_BIAS_PAIRWISE,
                                .temporal = true,
                                .spatial = true,
                                .rays = true,
                                .reuse = true };
    noc_device_info info;
    noc_log *log = noc_log_create(NULL);
    (void)state;
    if (noc_device_find(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, &info, log) != NOC_OK) {
        print_message("# skipped: %s\n", noc_log_last_error(log));
        noc_log_destroy(log);
        skip();
    }
    noc_scene *s = court();
    result reference = measure_reference(s, true, NULL, samples(600));
    own_backend = NOC_BACKEND_VULKAN;
    result x = measure_runs(s, &row, true, NULL, samples(200));
    own_backend = NOC_BACKEND_EMBREE;
    assert_true(agrees(row.name, &x, &reference));
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(pairwise_with_rays) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
