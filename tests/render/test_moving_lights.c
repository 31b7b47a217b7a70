/* Lights that move: frames under a moving camera have the reference's mean whatever the candidates and the reuse; a
 * scene whose lights were moved looks like one that was made with them there; and what a frame accumulates starts anew.
 */
#include "unbiased.h"
#include "../own_view.h"

enum { MOVING = 24 };

static double turn(double x) { return x - floor(x); }

/* A light that moves, in a frame: each jumps metres from frame to frame, turns around, and some flicker. */
static noc_light light_at(int i, int frame) {
    double a = turn(0.618 * i + 0.23 * frame), b = turn(0.387 * i + 0.41 * frame),
           c = 2 * M_PI * turn(0.71 * i + 0.3 * frame);
    float power = 1 + (float)((i + frame) % 3);
    noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                    .moving = true,
                    .position = { -9 + 17 * a, -7 + 12 * b, 3.4 + 2.5 * turn(0.17 * i) },
                    .edge_u = { 0.8 * cos(c), 0.8 * sin(c), 0 },
                    .edge_v = { 0.2 * sin(c), -0.2 * cos(c), 0.7 },
                    .direction = { cos(c), sin(c), -0.6 },
                    .radius = 0.25,
                    .inner_deg = 25,
                    .outer_deg = 60,
                    .emission = { 30 * power, 25 * power, 15 * power } };
    if (i % 7 == 3 && frame % 2)
        memset(l.emission, 0, sizeof(l.emission)); /* out, every other frame */
    return l;
}

static void pose(noc_scene *s, int frame) {
    for (int i = 0; i < MOVING; i++) {
        noc_light l = light_at(i, frame);
        assert_int_equal(noc_scene_move_light(s, 2 * i + 1, &l), NOC_OK);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* Boxes in a yard that throw shadows, weak lights that stand, and between them those that move. */
static noc_scene *crossing(int frame) {
    noc_scene *s = noc_scene_create(NULL);
    int wall = matte(s, 0.5f);
    int wet =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.15f, 0.16f, 0.2f }, .f0 = 0.05f, .roughness = 0.3f });
    add_floor(s, wet, 0, 0, 0, 15);
    QUAD(s, wall, -10, 8, 0, 20, 0, 0, 0, 0, 8);
    for (int i = 0; i < 8; i++) {
        double x = -8 + 4.2 * (i % 4), y = 3 - 5 * (i / 4);
        QUAD(s, wall, x, y, 0, 1.5, 0, 0, 0, 0, 2.5);
        QUAD(s, wall, x + 1.5, y, 0, 0, 1.5, 0, 0, 0, 2.5);
    }
    for (int i = 0; i < MOVING; i++) {
        noc_light stands = { .kind = NOC_LIGHT_PARALLELOGRAM,
                             .position = { -9 + 0.75 * i, 7.99, 1 + i % 4 },
                             .edge_u = { 0.5, 0, 0 },
                             .edge_v = { 0, 0, 0.6 },
                             .emission = { 20, 15, 10 } };
        noc_light moves = light_at(i, frame);
        assert_int_equal(noc_scene_add_light(s, &stands), 2 * i);
        assert_int_equal(noc_scene_add_light(s, &moves), 2 * i + 1);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

#define RESTIR(rule) NOC_METHOD_RESTIR, NOC_BIAS_##rule, .temporal = true, .spatial = true
static const config configs[] = {
    { "ris, uniform", NOC_METHOD_RIS, .reuse = true },
    { "ris, power", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_POWER },
    { "ris, light-bvh", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_LIGHT_BVH },
    { "ris, influence", NOC_METHOD_RIS, .reuse = true, .picker = NOC_CANDIDATES_INFLUENCE },
    { "ris, lists of 12", NOC_METHOD_RIS, .reuse = true, .list = 12 },
    { "pairwise + rays, uniform", RESTIR(PAIRWISE), .rays = true, .reuse = true },
    { "pairwise + rays, power", RESTIR(PAIRWISE), .rays = true, .reuse = true, .picker = NOC_CANDIDATES_POWER },
    { "pairwise + rays, light-bvh", RESTIR(PAIRWISE), .rays = true, .reuse = true, .picker = NOC_CANDIDATES_LIGHT_BVH },
    { "pairwise + rays, influence", RESTIR(PAIRWISE), .rays = true, .reuse = true, .picker = NOC_CANDIDATES_INFLUENCE },
    { "pairwise + rays, lists of 12", RESTIR(PAIRWISE), .rays = true, .reuse = true, .list = 12 },
    { "pairwise + rays in time, lists of 12", NOC_METHOD_RESTIR, NOC_BIAS_PAIRWISE, .temporal = true, .rays = true,
      .reuse = true, .list = 12, .shadow_rays = 4 },
    { "pairwise unshadowed, uniform", RESTIR(PAIRWISE) },
    { "mis + rays, uniform", RESTIR(MIS), .rays = true, .reuse = true },
    { "mis + rays, lists of 12", RESTIR(MIS), .rays = true, .reuse = true, .list = 12 },
    { "counted + rays, uniform", RESTIR(COUNTED), .rays = true, .reuse = true },
};

static void unbiased_on_the_move(void **state) {
    (void)state;
    noc_scene *s = crossing(0);
    result reference = measure_reference(s, true, pose, samples(500));
    int wrong = 0;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        result x = measure_runs(s, &configs[i], true, pose, samples(700));
        wrong += !agrees(configs[i].name, &x, &reference);
    }
    noc_scene_destroy(s);
    assert_int_equal(wrong, 0);
}

static noc_image *pictured(noc_view *r, const noc_render_params *p, int frame) {
    noc_camera cam = camera_at(frame, true);
    assert_int_equal(noc_view_render(r, &cam, p, NULL), NOC_OK);
    noc_image *image = noc_view_image(r);
    assert_non_null(image);
    return image;
}

static void assert_same_picture(noc_image *a, noc_image *b) {
    assert_memory_equal(a->rgb, b->rgb, sizeof(float) * 3 * W * H);
    noc_image_destroy(a);
    noc_image_destroy(b);
}

/* Nothing that a renderer has built for lights where they were is left: same bits as a scene made with them where they
 * are. Trees are refitted, not built as they would be, so that other candidates are drawn from them. */
static void moved_is_as_if_made_there(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        if (!configs[i].list && configs[i].picker == NOC_CANDIDATES_LIGHT_BVH)
            continue;
        noc_render_params p = params_of(&configs[i], 5);
        noc_scene *moved = crossing(1), *made = crossing(4);
        noc_view *a = own_view(moved, 0, NULL), *b = own_view(made, 0, NULL);
        for (int f = 1; f <= 3; f++) {
            pose(moved, f);
            noc_image_destroy(pictured(a, &p, f));
        }
        pose(moved, 4);
        noc_view_reset(a);
        assert_same_picture(pictured(a, &p, 4), pictured(b, &p, 4));
        close_view(a);
        close_view(b);
        noc_scene_destroy(moved);
        noc_scene_destroy(made);
    }
}

/* Threads and instruction sets change no bit, the refitted tree's candidates and the previous frame's lights included.
 */
static void same_bits_on_the_move(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        noc_render_params p = params_of(&configs[i], 8), q = p;
        noc_scene *s = crossing(0), *t = crossing(0);
        noc_view *a = own_view(s, 1, NULL);
        noc_view *b = own_view(t, 3, NULL);
        q.isa = NOC_ISA_SCALAR;
        for (int f = 1; f <= 4; f++) {
            pose(s, f);
            pose(t, f);
            assert_same_picture(pictured(a, &p, f), pictured(b, &q, f));
        }
        close_view(a);
        close_view(b);
        noc_scene_destroy(s);
        noc_scene_destroy(t);
    }
}

static void accumulation_starts_anew(void **state) {
    (void)state;
    noc_scene *s = crossing(1);
    noc_view *r = own_view(s, 0, NULL);
    noc_render_params p = params_of(&configs[9], 3);
    noc_frame_stats stats;
    p.accumulate = true;
    for (int i = 0; i < 3; i++)
        noc_image_destroy(pictured(r, &p, 1));
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.frames, 3);
    pose(s, 1); /* they are there */
    noc_image_destroy(pictured(r, &p, 1));
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.frames, 4);
    pose(s, 2);
    noc_image_destroy(pictured(r, &p, 1));
    noc_view_get_stats(r, &stats);
    assert_int_equal(stats.frames, 1);
    close_view(r);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accumulation_starts_anew),
        cmocka_unit_test(moved_is_as_if_made_there),
        cmocka_unit_test(same_bits_on_the_move),
        cmocka_unit_test(unbiased_on_the_move),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
