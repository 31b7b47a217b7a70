/* The Vulkan backend beside the CPU's, on a device that traces rays. */
#include "vulkan_view.h"

#include <nocturne/nocturne.h>

static noc_scene *builtin(const char *name) {
    noc_log *log = noc_log_create(NULL);
    noc_scene *scene = noc_scene_create(log);
    noc_builtin_params params = noc_builtin_default_params();
    assert_int_equal(noc_scene_add_builtin(scene, name, &params), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene;
}

/* Renders frames on both machines; what is between rays has the same bits in every buffer. */
static void expect_same_bits(twins *t, const noc_render_params *p, int frames, const char *name) {
    noc_camera camera;
    assert_int_equal(noc_scene_camera(t->cpu->scene, NOC_VIEWPOINT_STREET, (double)p->width / p->height, &camera),
                     NOC_OK);
    noc_view_reset(t->cpu);
    noc_view_reset(t->gpu);
    for (int f = 0; f < frames; f++) {
        assert_int_equal(noc_view_render(t->cpu, &camera, p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(t->gpu, &camera, p, NULL), NOC_OK);
        const frame_buffers *c = &cpu_of(t)->b;
        const vk_picture *g = &gpu_of(t)->b;
        size_t surfaces = differing(t, c->g[t->cpu->history.gbuffer], &g->surfaces[t->gpu->history.gbuffer], 10);
        int set = cpu_of(t)->shaded_set;
        size_t reservoirs = p->method == NOC_METHOD_HEADLIGHT || p->method == NOC_METHOD_REFERENCE
                                ? 0
                                : differing(t, c->r[set], &g->reservoirs[set], 6);
        size_t colour = differing(t, c->colour, &g->colour, 3), picture = differing(t, c->picture, &g->picture, 3);
        if (surfaces || reservoirs || colour || picture)
            print_message("# %s, frame %d: words that differ: surfaces %zu, reservoirs %zu, colour %zu, picture %zu\n",
                          name, f, surfaces, reservoirs, colour, picture);
        assert_int_equal(surfaces + reservoirs + colour + picture, 0);
    }
}

static void plans_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        noc_candidates candidates;
        noc_bias bias;
        bool bias_rays, visibility, final_ray;
        int passes;
    } plans[] = {
        { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "is", NOC_METHOD_IS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, power", NOC_METHOD_RIS, NOC_CANDIDATES_POWER, NOC_BIAS_PAIRWISE, true, false, true, 1 },
        { "ris, light-bvh", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, no rays", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, false, 1 },
        { "biased", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_BIASED, true, true, true, 1 },
        { "mis", NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER, NOC_BIAS_MIS, true, true, true, 2 },
        { "mis, no bias rays", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, false, false, true, 1 },
        { "pairwise", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "pairwise, two passes", NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_PAIRWISE, true, true, true, 2 },
        { "pairwise, no bias rays", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, false, true, true,
          1 },
    };
    noc_scene *scene = builtin("mess");
    noc_log *log = noc_log_create(NULL);
    twins t;
    (void)state;
    if (!open_twins(scene, true, log, &t))
        skip();
    for (size_t i = 0; i < NOC_COUNT(plans); i++) {
        noc_render_params p = noc_render_default_params();
        p.width = 62;
        p.height = 45;
        p.method = plans[i].method;
        p.candidates = plans[i].candidates;
        p.bias = plans[i].bias;
        p.bias_rays = plans[i].bias_rays;
        p.visibility_reuse = plans[i].visibility;
        p.final_ray = plans[i].final_ray;
        p.passes = plans[i].passes;
        p.rays = 20;
        expect_same_bits(&t, &p, p.method == NOC_METHOD_REFERENCE ? 1 : 3, plans[i].name);
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plans_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
