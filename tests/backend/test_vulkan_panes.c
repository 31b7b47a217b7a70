/* Surfaces that let light through, on the Vulkan backend beside the CPU's. render-test_through has what is right. */
#include "all_kinds.h"
#include "same_frames.h"

static noc_log *messages; /* of all tests */

static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

static const struct row {
    const char *name;
    noc_method method;
    noc_candidates candidates;
    noc_bias bias;
    bool spatial, final_ray, map;
} rows[] = {
    { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, true, true, false },
    { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, true, true, false },
    { "reference, no rays", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, true, false, false },
    { "is", NOC_METHOD_IS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, true, true, false },
    { "ris, power, map", NOC_METHOD_RIS, NOC_CANDIDATES_POWER, NOC_BIAS_MIS, true, true, true },
    { "ris, no rays", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_MIS, true, false, false },
    { "ris, influence", NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_MIS, true, true, false },
    { "ris, lists", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, NOC_BIAS_MIS, true, true, false },
    { "ris, lists, no rays", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, NOC_BIAS_MIS, true, false, false },
    { "restir, pairwise", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, false },
    { "restir, mis", NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER, NOC_BIAS_MIS, true, true, false },
    { "restir, counted", NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_COUNTED, true, true, false },
    { "restir, biased", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_BIASED, true, true, false },
    { "restir, lists", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, NOC_BIAS_PAIRWISE, true, true, false },
    { "restir, lists, time alone", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, NOC_BIAS_PAIRWISE, false, true, false },
};

static noc_render_params params_of(const struct row *r) {
    noc_render_params p = all_kinds_params(r->method, r->map);
    p.candidates = r->candidates;
    p.bias = r->bias;
    p.spatial = r->spatial;
    p.final_ray = r->final_ray;
    p.rays = 20;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        p.aovs |= 1u << aov;
        p.aovs = noc_render_check(&p, NULL) == NOC_OK ? p.aovs : p.aovs & ~(1u << aov);
    }
    return p;
}

static int first_with_holes(const noc_scene *scene) {
    size_t i = 0;
    while (i + 1 < scene->materials.len && !scene->materials.data[i].cutout)
        i++;
    return (int)i;
}

/* Before frame number f: a car and its pane move, one pane lets more through, one is added, an instance goes. */
static void edit(noc_scene *scene, int car, int f) {
    noc_instance in = { 1, { 1.5, 0, 0, 4 - 0.4 * f, 0, 1.5, 0, -4, 0, 0, 1.5, 0 } };
    if (f == 1)
        assert_int_equal(noc_scene_set_transform(scene, car, in.transform), NOC_OK);
    if (f == 2) {
        noc_material m = scene->materials.data[first_with_holes(scene)];
        assert_true(m.cutout && m.transmittance == 0.2f);
        m.transmittance = 0.9f;
        assert_int_equal(noc_scene_set_material(scene, first_with_holes(scene), &m), NOC_OK);
        add_pane(scene, 0.3f, 0, 0, (double[]){ 0, -8, 1 }, 3, 3, false);
    }
    if (f == 3)
        assert_int_equal(noc_scene_remove_instance(scene, car), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
}

static void frames_have_the_same_bits(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        int car;
        noc_scene *scene = all_kinds_with(true, &car);
        noc_render_params p = params_of(&rows[i]);
        twins t;
        open_twins(scene, true, messages, &t);
        for (int f = 0; f < 4; f++) {
            edit(scene, car, f);
            expect_same_frame(&t, &camera, &p, rows[i].name);
            expect_same_views(&t, p.aovs, rows[i].name);
        }
        if (p.method != NOC_METHOD_HEADLIGHT)
            assert_true(t.weakened > 500);
        close_twins(&t);
        noc_scene_destroy(scene);
    }
}

/* With rays of each machine's own the pictures are one but for what grazes an edge; and rays can be traced again. */
static void rays_agree(void **state) {
    int car;
    noc_scene *scene = all_kinds_with(true, &car);
    noc_render_params p = all_kinds_params(NOC_METHOD_RIS, false);
    noc_trace_floor floor;
    twins t;
    (void)state;
    p.width = p.height = 128;
    open_twins(scene, false, messages, &t);
    for (int f = 0; f < 2; f++) {
        assert_int_equal(noc_view_render(t.cpu, &camera, &p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(t.gpu, &camera, &p, NULL), NOC_OK);
    }
    noc_image *a = noc_view_image(t.cpu), *b = noc_view_image(t.gpu);
    assert_true(a && b);
    size_t off = 0;
    double sums[2] = { 0, 0 };
    for (size_t i = 0; i < (size_t)3 * 128 * 128; i++) {
        sums[0] += a->rgb[i];
        sums[1] += b->rgb[i];
        off += fabsf(a->rgb[i] - b->rgb[i]) > 1e-3f * (a->rgb[i] + b->rgb[i] + 1e-3f);
    }
    print_message("# %zu of %d numbers differ, means by %.2g\n", off, 3 * 128 * 128, sums[1] / sums[0] - 1);
    assert_true(off < 3 * 128 * 128 / 500 && fabs(sums[1] / sums[0] - 1) < 1e-3);
    noc_image_destroy(a);
    noc_image_destroy(b);
    assert_int_equal(noc_view_trace_floor(t.gpu, &camera, &p, NULL, &floor), NOC_OK);
    close_twins(&t);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_have_the_same_bits),
        cmocka_unit_test(rays_agree),
    };
    messages = noc_log_create(NULL);
    int failed = 0;
    if (has_vulkan(messages))
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    else
        printf("1..0 # SKIP no Vulkan device traces rays here\n");
    noc_log_destroy(messages);
    return failed;
}
