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
    assert_int_equal(v->components, aov == NOC_AOV_NORMAL ? 3 : 1);
    for (size_t i = 0; v->components == 1 && i < (size_t)v->width * v->height; i++)
        assert_true(isfinite(v->value[i]) && (v->value[i] >= 0 || v->value[i] == -1));
    return v;
}

#endif
