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

/* Says why not. */
static bool has_vulkan(void) {
    noc_device_info info;
    noc_log *log = noc_log_create(NULL);
    bool has = noc_device_find(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, &info, log) == NOC_OK;
    if (!has)
        print_message("# skipped: %s\n", noc_log_last_error(log));
    noc_log_destroy(log);
    return has;
}

static void pairwise_with_rays(void **state) {
    static const config row = { "pairwise + rays on Vulkan",
                                NOC_METHOD_RESTIR,
                                NOC_BIAS_PAIRWISE,
                                .temporal = true,
                                .spatial = true,
                                .rays = true,
                                .reuse = true };
    (void)state;
    if (!has_vulkan())
        skip();
    noc_scene *s = court();
    result reference = measure_reference(s, true, NULL, samples(600));
    own_backend = NOC_BACKEND_VULKAN;
    result x = measure_runs(s, &row, true, NULL, samples(200));
    own_backend = NOC_BACKEND_EMBREE;
    assert_true(agrees(row.name, &x, &reference));
    noc_scene_destroy(s);
}

/* Reuse over light lists, with learned visibility: both machines have the reference's mean. Their pictures differ as
 * other seeds' do, because rays that graze an edge draw other lists; the means of many frames do not. */
static void lists_on_both_machines(void **state) {
    config row = { "pairwise + rays over lists on Vulkan",
                   NOC_METHOD_RESTIR,
                   NOC_BIAS_PAIRWISE,
                   .temporal = true,
                   .spatial = true,
                   .rays = true,
                   .reuse = true,
                   .list = 8 };
    (void)state;
    if (!has_vulkan())
        skip();
    noc_scene *s = court();
    result reference = measure_reference(s, true, NULL, samples(600));
    own_backend = NOC_BACKEND_VULKAN;
    result gpu = measure_runs(s, &row, true, NULL, samples(400));
    own_backend = NOC_BACKEND_EMBREE;
    bool agree = agrees(row.name, &gpu, &reference);
    row.name = "pairwise + rays over lists on the CPU";
    result cpu = measure_runs(s, &row, true, NULL, samples(400));
    agree &= agrees(row.name, &cpu, &reference);
    agree &= agrees("Vulkan against the CPU, over lists", &gpu, &cpu);
    assert_true(agree);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(pairwise_with_rays),
                                        cmocka_unit_test(lists_on_both_machines) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
