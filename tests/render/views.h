/* Small pictures with views, for the tests of views. */
#ifndef NOC_TEST_VIEWS_H
#define NOC_TEST_VIEWS_H

#include "rooms.h"
#include "../own_view.h"

enum {
    W = 40,
    H = 24,
    N = W * H,
    ALL = (1u << NOC_AOV_COUNT) - 1,
    MOMENTS = 1u << NOC_AOV_VARIANCE | 1u << NOC_AOV_ERROR
};

static inline noc_render_params with(noc_method method, noc_candidates candidates, uint32_t aovs) {
    noc_render_params p = measure(W, H, method);
    p.candidates = candidates;
    p.draws = 8;
    p.aovs = aovs;
    return p;
}

static inline noc_view *rendered(const noc_scene *s, const noc_camera *c, const noc_render_params *p, int frames,
                                 int threads) {
    noc_view *r = own_view(s, threads, NULL);
    for (int i = 0; i < frames; i++)
        assert_int_equal(noc_view_render(r, c, p, NULL), NOC_OK);
    return r;
}

/* A view of the last frame, checked for what every view promises. */
static inline noc_channel *view(noc_view *r, noc_aov aov) {
    noc_channel *v = noc_view_aov(r, aov);
    assert_non_null(v);
    assert_string_equal(v->name, noc_aov_name(aov));
    assert_int_equal(v->components, aov == NOC_AOV_NORMAL || aov == NOC_AOV_MOTION ? 3 : 1);
    for (size_t i = 0; v->components == 1 && i < (size_t)v->width * v->height; i++)
        assert_true(isfinite(v->value[i]) && (v->value[i] >= 0 || v->value[i] == -1));
    return v;
}

/* Walls, gloss, all kinds of light, emitters. */
static inline noc_scene *street(int lights) {
    noc_scene *s = noc_scene_create(NULL);
    int wall = matte(s, 0.5f);
    int wet =
        noc_scene_add_material(s, &(noc_material){ .albedo = { 0.2f, 0.15f, 0.1f }, .f0 = 0.05f, .roughness = 0.4f });
    int lamp =
        noc_scene_add_material(s, &(noc_material){
                                      .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1, .emission = { 30, 20, 10 } });
    int group = noc_scene_add_group(s, "some");
    add_floor(s, wet, 0, 0, 0, 20);
    QUAD(s, wall, -8, 6, 0, 16, 0, 0, 0, 0, 5);
    QUAD(s, wall, -3, 1, 0, 1.5, 0.5, 0, 0, 0, 3);
    QUAD(s, lamp, 0, 5.9, 1, 2, 0, 0, 0, 0, 1);
    for (int i = 0; i < lights; i++) {
        noc_light l = crowd_light(i, 5.7);
        l.group = i % 3 ? group : 0;
        l.inferred = i & 1;
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static inline noc_camera along(void) { return look(1, -10, 4, 0, 0, 2.5, 60); }

#endif
