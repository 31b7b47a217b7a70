/* What a renderer tells of its candidates: how many lights surfaces find, and the S_r that it looked for or was given.
 */
#include "rooms.h"
#include "../own_view.h"

#include <unistd.h>

static noc_camera view(double t) { return look(1 + t, -10, 4, 0.5 * t, 0, 2, 60); }

/* Point lights a few millimetres apart, and a floor before them. */
static noc_scene *bundle(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
    for (int i = 0; i < lights; i++)
        point_light(s, 1e-3 * (i % 100), 1e-3 * (i / 100), 2, 1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_light_stats stats_of(const noc_scene *s, const noc_camera *c, const noc_render_params *p) {
    noc_light_stats found;
    noc_view *r = own_view(s, 2, NULL);
    assert_int_equal(noc_view_render(r, c, p, NULL), NOC_OK);
    noc_view_light_stats(r, &found);
    close_view(r);
    return found;
}

/* With volumes that hold everything every pixel finds all lights, however many; with the least of them it finds none.
 */
static void number_of_lights_found(void **state) {
    (void)state;
    static const struct {
        int lights;
        uint32_t told;
    } cases[] = { { 3, 3 }, { 1500, 1500 }, { 4321, 4321 }, { 70000, 65536 } };
    noc_camera c = view(0), sky = look(0, 0, 50, 0, 0, 90, 60);
    noc_render_params p = measure(16, 8, NOC_METHOD_RIS);
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        noc_scene *s = bundle(cases[i].lights);
        p.influence = 1e6;
        noc_light_stats found = stats_of(s, &c, &p);
        assert_true(found.surfaces > 0 && found.found_none == 0);
        assert_int_equal(found.found_median, cases[i].told);
        assert_int_equal(found.found_99, cases[i].told);
        assert_int_equal(stats_of(s, &sky, &p).surfaces, 0);
        p.influence = 1e-300; /* less than a float can tell from 0, which is "found for the scene" */
        for (int way = 0; way < 4 && cases[i].lights < 2000; way++) {
            p.influence_boxes = way & 1 ? NOC_INFLUENCE_VISIBLE : NOC_INFLUENCE_SPHERE;
            p.influence_cluster = way & 2 ? 8 : 1;
            found = stats_of(s, &c, &p);
            assert_true(found.surfaces > 0 && found.found_none == 1 && found.influence == 1e-300);
        }
        p.influence_boxes = NOC_INFLUENCE_SPHERE;
        p.influence_cluster = 1;
        noc_scene_destroy(s);
    }
}

/* S_r that was set is not looked for; the steps of building are all of it; and what S_r was set before changes nothing.
 */
static void set_reach_is_not_looked_for(void **state) {
    (void)state;
    noc_scene *s = bundle(1500);
    noc_camera c = view(0);
    noc_render_params p = measure(16, 8, NOC_METHOD_RIS);
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    noc_light_stats automatic = stats_of(s, &c, &p);
    assert_true(automatic.tuning_seconds > 0 && automatic.volumes_seconds > 0 && automatic.hierarchy_seconds > 0);
    assert_true(automatic.boxes_seconds == 0);
    for (int way = 0; way < 4; way++) {
        p.influence = 2;
        p.influence_boxes = way & 1 ? NOC_INFLUENCE_VISIBLE : NOC_INFLUENCE_SPHERE;
        p.influence_cluster = way & 2 ? 8 : 1;
        noc_light_stats set = stats_of(s, &c, &p);
        assert_true(set.tuning_seconds == 0 && set.volumes_seconds > 0 && set.hierarchy_seconds > 0 &&
                    set.influence == 2);
        assert_true((set.boxes_seconds > 0) == (way & 1));
        double steps = set.volumes_seconds + set.hierarchy_seconds + set.boxes_seconds;
        assert_true(steps > 0 && steps <= set.build_seconds);
    }
    noc_view *r = own_view(s, 2, NULL);
    p.influence_boxes = NOC_INFLUENCE_SPHERE;
    p.influence_cluster = 1;
    const double asked[] = { 2, 0, 3, 0 };
    for (size_t i = 0; i < NOC_COUNT(asked); i++) {
        noc_light_stats found;
        p.influence = asked[i];
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
        noc_view_light_stats(r, &found);
        assert_true(found.influence == (asked[i] > 0 ? asked[i] : automatic.influence));
        assert_true((found.tuning_seconds > 0) == (i > 0)); /* found once, and kept */
    }
    close_view(r);
    noc_scene_destroy(s);
}

/* A view tells of what its own last frame drew from, when another view has followed an edit of the scene since. */
static void told_after_an_edit(void **state) {
    (void)state;
    enum { LIGHTS = 300, MORE = 20 };
    noc_scene *s = bundle(LIGHTS);
    noc_device *device = noc_device_create(NULL, NULL);
    noc_view *one = noc_view_create(device, s), *other = noc_view_create(device, s);
    noc_camera c = view(0);
    noc_render_params p = measure(16, 8, NOC_METHOD_RIS);
    noc_light_stats told;
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    p.influence_cluster = 1;
    assert_int_equal(noc_view_render(one, &c, &p, NULL), NOC_OK);
    for (int i = 0; i < MORE; i++)
        point_light(s, i, 0, 3, 1);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_view_render(other, &c, &p, NULL), NOC_OK);
    noc_view_light_stats(one, &told);
    assert_int_equal(told.volumes, LIGHTS);
    noc_view_light_stats(other, &told);
    assert_int_equal(told.volumes, LIGHTS + MORE);
    noc_view_reset(one);
    noc_view_light_stats(one, &told);
    assert_true(told.lights == LIGHTS + MORE && told.scene_bytes > 0 && !told.volumes && !told.influence);
    noc_view_destroy(one);
    noc_view_destroy(other);
    noc_device_destroy(device);
    noc_scene_destroy(s);
}

static char *volumes_of(noc_view *view, const noc_render_params *p) {
    char path[] = "/tmp/nocturne-volumes-XXXXXX", *text = noc_calloc(1 << 16, 1);
    close(mkstemp(path));
    assert_int_equal(noc_view_write_influence(view, p, path), NOC_OK);
    FILE *f = fopen(path, "r");
    assert_true(f && text && fread(text, 1, (1 << 16) - 1, f) > 0);
    fclose(f);
    unlink(path);
    return text;
}

/* Volumes that are asked for before any frame has seen an edit are of the scene as it is. */
static void volumes_after_an_edit(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    add_floor(s, grey, 0, 0, 0, 20);
    add_floor(s, grey, 0, 0, 1, 20); /* mesh 1: hides the other from the light */
    point_light(s, 0, 0, 3, 10);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_render_params p = measure(16, 8, NOC_METHOD_RIS);
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    p.influence = 2;
    p.influence_boxes = NOC_INFLUENCE_VISIBLE;
    noc_view *before = own_view(s, 2, NULL);
    assert_int_equal(noc_scene_remove_mesh(s, 1), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_view *after = own_view(s, 2, NULL);
    char *have = volumes_of(before, &p), *want = volumes_of(after, &p);
    assert_string_equal(have, want);
    free(have);
    free(want);
    close_view(before);
    close_view(after);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(number_of_lights_found),
        cmocka_unit_test(set_reach_is_not_looked_for),
        cmocka_unit_test(told_after_an_edit),
        cmocka_unit_test(volumes_after_an_edit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
