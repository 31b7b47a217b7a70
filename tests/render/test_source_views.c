/* Views of where light comes from, held to the lights. */
#include "views.h"

enum { SOURCES = 1u << NOC_AOV_GROUP | 1u << NOC_AOV_PLACED, LAMPS = 5, MOST = 12 };

/* Height 1 m, a row along x. Of candela k + 1; those of odd k are inferred. */
static double lamp_x(int k, int lamps) { return -8 + 16.0 * k / (lamps - 1); }

/* A matte floor under point lights, which are of the groups in turn. */
static noc_scene *row(int lamps, int groups) {
    noc_scene *s = noc_scene_create(NULL);
    int of[MOST];
    for (int i = 0; i < groups; i++)
        assert_int_equal(of[i] = noc_scene_add_group(s, NULL), i + 1);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    for (int k = 0; k < lamps; k++) {
        noc_light l = { .kind = NOC_LIGHT_POINT,
                        .position = { lamp_x(k, lamps), 0, 1 },
                        .emission = { 1.f + (float)k, 1.f + (float)k, 1.f + (float)k },
                        .inferred = k & 1,
                        .group = of[k % groups] };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* Illuminance by lamp k, by the inverse square law. */
static double lux(const double p[3], int k, int lamps) {
    double dx = lamp_x(k, lamps) - p[0], d2 = dx * dx + p[1] * p[1] + 1;
    return (1 + k) / (d2 * sqrt(d2));
}

static int largest(const double *of, int count, double *second) {
    int most = 0;
    for (int i = 1; i < count; i++)
        most = of[i] > of[most] ? i : most;
    *second = 0;
    for (int i = 0; i < count; i++)
        *second = i != most ? NOC_MAX(*second, of[i]) : *second;
    return most;
}

/* clear: so many times the light of the next one makes a pixel's answer sure. */
static void hold_to_the_law(noc_view *r, const noc_camera *c, const noc_render_params *p, int lamps, int groups,
                            double clear) {
    noc_channel *group = view(r, NOC_AOV_GROUP), *placed = view(r, NOC_AOV_PLACED);
    int sure = 0, none = 0;
    assert_int_equal(group->scale, NOC_CHANNEL_LABELS);
    assert_true(!group->labels && placed->label_count == NOC_PLACED_COUNT && placed->labels && placed->label_colours);
    for (int i = 0; i < N; i++) {
        double q[3], by_group[MOST] = { 0 }, by_place[2] = { 0 }, second;
        assert_int_equal(group->value[i] < 0, placed->value[i] < 0);
        if (group->value[i] < 0) { /* beyond the floor */
            none++;
            continue;
        }
        floor_point(c, p, i % W, i / W, 0, q);
        for (int k = 0; k < lamps; k++) {
            by_group[k % groups] += lux(q, k, lamps);
            by_place[k & 1] += lux(q, k, lamps);
        }
        int most = largest(by_group, groups, &second);
        if (by_group[most] > clear * second) {
            assert_int_equal((int)group->value[i], most + 1);
            sure++;
        }
        most = largest(by_place, 2, &second);
        if (by_place[most] > clear * second)
            assert_int_equal((int)placed->value[i], most ? NOC_PLACED_INFERRED : NOC_PLACED_MAPPED);
    }
    assert_true(sure > N / 10 && none > 0 && none < N / 2);
    noc_channel_destroy(group);
    noc_channel_destroy(placed);
}

static noc_camera above(void) { return look(0.3, -14, 9, 0, 0, 0, 60); }

static void what_brings_the_most_light(void **state) {
    (void)state;
    static const struct {
        noc_method method;
        noc_candidates candidates;
        int frames;
        double clear;
    } cases[] = {
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, 1, 1.0001 }, { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 64, 1.7 },
        { NOC_METHOD_RIS, NOC_CANDIDATES_POWER, 200, 2.5 },        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, 1200, 2 },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, 1200, 2 },
    };
    noc_camera c = above();
    for (size_t k = 0; k < NOC_COUNT(cases); k++)
        for (int groups = 2; groups <= LAMPS; groups += LAMPS - 2) {
            noc_scene *s = row(LAMPS, groups);
            noc_render_params p = with(cases[k].method, cases[k].candidates, SOURCES);
            noc_view *r = rendered(s, &c, &p, cases[k].frames, 2);
            hold_to_the_law(r, &c, &p, LAMPS, groups, cases[k].clear);
            close_view(r);
            noc_scene_destroy(s);
        }
}

/* More groups than a pixel has room for: who leads by more than an eighth of the light is known. */
static void more_groups_than_places(void **state) {
    (void)state;
    noc_camera c = above();
    noc_scene *s = row(MOST, MOST);
    noc_render_params p = with(NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, SOURCES);
    noc_view *r = rendered(s, &c, &p, 3, 2);
    noc_channel *group = view(r, NOC_AOV_GROUP);
    int sure = 0;
    for (int i = 0; i < N; i++) {
        double q[3], by[MOST], all = 0, second;
        if (group->value[i] < 0)
            continue;
        floor_point(&c, &p, i % W, i / W, 0, q);
        for (int k = 0; k < MOST; k++)
            all += by[k] = lux(q, k, MOST);
        int most = largest(by, MOST, &second);
        if (by[most] < second + all / 7)
            continue;
        assert_int_equal((int)group->value[i], most + 1);
        sure++;
    }
    assert_true(sure > N / 10);
    noc_channel_destroy(group);
    close_view(r);
    noc_scene_destroy(s);
}

/* An emitter that is seen is of its own group; one that is out brings nothing, and the other's light begins anew. */
static void emitters_and_groups_that_go_out(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int sign = noc_scene_add_group(s, "sign"), lamp = noc_scene_add_group(s, "lamp");
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 9);
    noc_light panel = { .kind = NOC_LIGHT_PARALLELOGRAM, /* faces -y, where the camera is */
                        .position = { -2, 1, 2 },
                        .edge_u = { 3, 0, 0 },
                        .edge_v = { 0, 0, 2 },
                        .emission = { 900, 900, 900 },
                        .group = sign };
    noc_light point = { .kind = NOC_LIGHT_POINT, .position = { 0, -3, 3 }, .emission = { 1, 1, 1 }, .group = lamp };
    assert_true(noc_scene_add_light(s, &panel) >= 0 && noc_scene_add_light(s, &point) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, SOURCES | 1u << NOC_AOV_CLASS);
    noc_camera c = look(1, -10, 4, 0, 0, 1.5, 60);
    noc_view *r = rendered(s, &c, &p, 8, 1);
    for (int out = 0; out < 2; out++) {
        noc_channel *group = view(r, NOC_AOV_GROUP), *placed = view(r, NOC_AOV_PLACED), *cls = view(r, NOC_AOV_CLASS);
        int panels = 0, by[3] = { 0 };
        for (int i = 0; i < N; i++) {
            bool seen = cls->value[i] == NOC_CLASS_LAMP;
            panels += seen;
            if (seen && out)
                assert_int_equal(group->value[i], -1);
            else if (seen)
                assert_true(group->value[i] == sign && placed->value[i] == NOC_PLACED_OTHER);
            else if (group->value[i] >= 0)
                by[(int)group->value[i]]++;
        }
        assert_true(panels > 10 && !by[0]);
        assert_true(out ? by[sign] == 0 && by[lamp] > 200 : by[sign] > 200);
        noc_channel_destroy(group);
        noc_channel_destroy(placed);
        noc_channel_destroy(cls);
        assert_int_equal(noc_scene_set_group(s, sign, (float[3]){ 0 }), NOC_OK);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    }
    close_view(r);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_brings_the_most_light),
        cmocka_unit_test(more_groups_than_places),
        cmocka_unit_test(emitters_and_groups_that_go_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
