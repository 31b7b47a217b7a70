/* Lights that are removed leave room, and others that take it are themselves. */
#include "../memory.h"
#include "edits.h"

static noc_light seen_at(noc_light_kind kind, double x, float emission) {
    return (noc_light){ .kind = kind,
                        .position = { x, 0, 3 },
                        .direction = { 0, 0, -1 },
                        .edge_u = { 0, 1, 0 },
                        .edge_v = { 1, 0, 0 },
                        .radius = .5,
                        .emission = { emission, 50, 50 } };
}

static noc_scene *ground_only(noc_log *log) {
    noc_scene *s = noc_scene_create(log);
    add_floor(s, matte(s, .5f), 0, 0, 0, 8);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static int add_seen(noc_scene *s, noc_light_kind kind, double x, float emission) {
    noc_light l = seen_at(kind, x, emission);
    int index = noc_scene_add_light(s, &l);
    assert_true(index >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return index;
}

static void remove_seen(noc_scene *s, int light) {
    assert_int_equal(noc_scene_remove_light(s, light), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* Lights of all kinds and colours that come and go need no more room than some of them did. */
static void lights_that_come_and_go_take_no_room(void **unused) {
    noc_scene *s = ground_only(NULL);
    noc_scene_info early = { 0 }, info;
    for (int i = 0; i < 2000; i++) {
        remove_seen(s, add_seen(s, (noc_light_kind)(i % 4), i % 7, (float)i));
        if (i == 9)
            noc_scene_get_info(s, &early);
    }
    noc_scene_get_info(s, &info);
    assert_true(info.memory_bytes <= 2 * early.memory_bytes);
    assert_int_equal(info.materials, early.materials);
    assert_int_equal(s->meshes.len, 1 + 4);
    noc_scene_destroy(s);
    (void)unused;
}

/* A light that takes another's room looks as in a scene of its own, to a view that saw the other one, too. */
static void a_light_in_the_place_of_another_is_itself(void **unused) {
    noc_camera c = look(0, -9, 4, 0, 0, 1, 60);
    noc_render_params p = measure(24, 24, NOC_METHOD_REFERENCE);
    for (int kind = 0; kind < 4; kind++) {
        noc_scene *s = ground_only(NULL), *want = ground_only(NULL);
        int stays = add_seen(s, (noc_light_kind)kind, -2, 9), goes = add_seen(s, (noc_light_kind)kind, 3, 70);
        noc_view *v = own_view(s, 1, NULL);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        remove_seen(s, goes);
        noc_light second = seen_at((noc_light_kind)kind, 20, 9), third = seen_at((noc_light_kind)kind, 2, 70);
        assert_true(noc_scene_add_light(s, &second) >= 0); /* takes the place */
        assert_true(noc_scene_add_light(s, &third) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(s->meshes.len, 4);
        add_seen(want, (noc_light_kind)kind, -2, 9);
        add_seen(want, (noc_light_kind)kind, 20, 9);
        add_seen(want, (noc_light_kind)kind, 2, 70);
        assert_alike(s, want);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        noc_view_reset(v);
        assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
        noc_image *have = noc_view_image(v), *image = render(want, &c, &p, 1);
        assert_memory_equal(have->rgb, image->rgb, sizeof(float) * 3 * 24 * 24);
        remove_seen(s, stays);
        noc_image_destroy(have);
        noc_image_destroy(image);
        close_view(v);
        noc_scene_destroy(s);
        noc_scene_destroy(want);
    }
    (void)unused;
}

static void memory_for_anothers_place_may_be_refused(void **unused) {
    noc_log *log = counting_log();
    noc_scene *want = ground_only(NULL);
    add_seen(want, NOC_LIGHT_SPHERE, 3, 70);
    noc_light l = seen_at(NOC_LIGHT_SPHERE, 3, 70);
    bool reached;
    FOR_EACH_REFUSAL(reached) {
        noc_scene *s = ground_only(log);
        remove_seen(s, add_seen(s, NOC_LIGHT_SPHERE, 1, 9));
        begin_refusal(n, later);
        bool added = noc_scene_add_light(s, &l) >= 0;
        bool done = added && noc_scene_commit(s) == NOC_OK;
        reached = end_refusal();
        assert_int_equal(refusing.errors, !done);
        if (!added)
            assert_true(noc_scene_add_light(s, &l) >= 0);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_alike(s, want);
        noc_scene_destroy(s);
    }
    noc_scene_destroy(want);
    noc_log_destroy(log);
    (void)unused;
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(lights_that_come_and_go_take_no_room),
                                        cmocka_unit_test(a_light_in_the_place_of_another_is_itself),
                                        cmocka_unit_test(memory_for_anothers_place_may_be_refused) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
