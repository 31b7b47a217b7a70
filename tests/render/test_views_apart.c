/* What no view may change, and what may not change a view. */
#include "views.h"
#include "../own_view.h"

static noc_render_params any(int i) {
    static const noc_candidates from[] = { NOC_CANDIDATES_INFLUENCE, NOC_CANDIDATES_LISTS, NOC_CANDIDATES_LIGHT_BVH,
                                           NOC_CANDIDATES_POWER };
    noc_render_params p = with(i < 4    ? NOC_METHOD_RESTIR
                               : i < 6  ? NOC_METHOD_RIS
                               : i == 6 ? NOC_METHOD_REFERENCE
                                        : NOC_METHOD_IS,
                               from[i % 4], ALL);
    p.width = 45; /* neither a multiple of 4 nor of 16 */
    p.height = 31;
    p.jitter = true;
    p.sky = 0.05;
    p.list = 6;
    p.tail = 5;
    if (p.method == NOC_METHOD_IS || p.method == NOC_METHOD_REFERENCE || i % 4 > 1)
        p.aovs &= ~(1u << NOC_AOV_LIGHTS);
    if (p.method == NOC_METHOD_IS || p.candidates != NOC_CANDIDATES_LISTS)
        p.aovs &= ~(1u << NOC_AOV_EXPECTED);
    if (p.method == NOC_METHOD_REFERENCE)
        p.aovs &= 1u << NOC_AOV_RAYS | MOMENTS | 1u << NOC_AOV_GROUP | 1u << NOC_AOV_PLACED | 1u << NOC_AOV_LUMINANCE |
                  1u << NOC_AOV_ILLUMINANCE | 15u << NOC_AOV_INFLUENTIAL;
    return p;
}
enum { KINDS = 8 };

static void assert_same_views(noc_view *a, noc_view *b, uint32_t aovs) {
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(aovs >> aov & 1))
            continue;
        noc_channel *v = view(a, (noc_aov)aov), *w = view(b, (noc_aov)aov);
        assert_memory_equal(v->value, w->value, sizeof(float) * (size_t)v->width * v->height);
        noc_channel_destroy(v);
        noc_channel_destroy(w);
    }
}

static void same_on_every_instruction_set_and_number_of_threads(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int i = 0; i < KINDS; i++) {
        noc_render_params p = any(i), forced = p;
        noc_view *a = rendered(s, &c, &p, 3, 1), *b = rendered(s, &c, &p, 3, 3);
        assert_same_views(a, b, p.aovs);
        close_view(b);
        for (forced.isa = NOC_ISA_SCALAR; forced.isa < NOC_ISA_COUNT; forced.isa++) {
            if (!noc_isa_runs(forced.isa))
                continue;
            b = rendered(s, &c, &forced, 3, 2);
            assert_same_views(a, b, p.aovs);
            close_view(b);
        }
        close_view(a);
    }
    noc_scene_destroy(s);
}

static void the_picture_is_the_same(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int i = 0; i < KINDS; i++) {
        noc_render_params p = any(i), without = p;
        without.aovs = 0;
        noc_view *a = rendered(s, &c, &without, 4, 2), *b = own_view(s, 0, NULL);
        noc_image *x = noc_view_image(a);
        for (int frame = 0; frame < 4; frame++) /* asked for in turn */
            assert_int_equal(noc_view_render(b, &c, frame % 2 ? &p : &without, NULL), NOC_OK);
        noc_image *y = noc_view_image(b);
        assert_memory_equal(x->rgb, y->rgb, sizeof(float) * 3 * (size_t)x->width * x->height);
        noc_image_destroy(x);
        noc_image_destroy(y);
        close_view(a);
        close_view(b);
    }
    noc_scene_destroy(s);
}

static void scenes_of_nothing(void **state) {
    (void)state;
    noc_camera c = along();
    for (int kind = 0; kind < 2; kind++) {
        noc_scene *s = noc_scene_create(NULL);
        if (kind)
            add_floor(s, matte(s, 0.5f), 0, 0, 0, 20);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        for (int i = 0; i < KINDS; i++) {
            noc_render_params p = any(i);
            noc_view *r = rendered(s, &c, &p, 2, 2);
            for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
                if (p.aovs >> aov & 1)
                    noc_channel_destroy(view(r, (noc_aov)aov));
            close_view(r);
        }
        noc_scene_destroy(s);
    }
}

/* ---- errors ---- */

static void drop(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

static void wrong_requests(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *s = street(3);
    noc_camera c = along();
    noc_view *r = own_view(s, 0, log);
    static const struct {
        noc_method method;
        noc_candidates candidates;
        uint32_t aovs;
        const char *says;
    } bad[] = {
        { NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_IS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_LIGHTS, "\"lights\": only" },
        { NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_EXPECTED, "\"expected\": only" },
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_LISTS, 1u << NOC_AOV_EXPECTED, "\"expected\": only" },
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_DENSITY, "\"density\": the reference" },
        { NOC_METHOD_REFERENCE, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_WEIGHT, "\"weight\": the reference" },
        { NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_COUNT, "aovs is 0x" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        noc_render_params p = with(bad[i].method, bad[i].candidates, bad[i].aovs);
        assert_int_equal(noc_render_check(&p, log), NOC_ERR_ARGUMENT);
        assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
        assert_non_null(strstr(noc_log_last_error(log), bad[i].says));
    }
    noc_render_params p = with(NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, 1u << NOC_AOV_ERROR);
    p.accumulate = false;
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "\"error\": frames must be accumulated"));
    assert_null(noc_view_aov(r, NOC_AOV_LIGHT)); /* before the first frame */
    p.aovs = 1u << NOC_AOV_LIGHT;
    assert_int_equal(noc_view_render(r, &c, &p, NULL), NOC_OK);
    assert_null(noc_view_aov(r, NOC_AOV_WEIGHT));
    assert_non_null(strstr(noc_log_last_error(log), "did not keep the view \"weight\""));
    assert_null(noc_view_aov(r, NOC_AOV_COUNT));
    assert_null(noc_view_aov(r, (noc_aov)-1));
    noc_channel_destroy(view(r, NOC_AOV_LIGHT));
    noc_view_reset(r);
    assert_null(noc_view_aov(r, NOC_AOV_LIGHT));
    assert_string_equal(noc_aov_name((noc_aov)99), "unknown");
    close_view(r);
    noc_scene_destroy(s);
    noc_log_destroy(log);
}

static bool stop_late(void *user, const char *what, double done) {
    (void)what, (void)done;
    return --*(int *)user > 0;
}

static uint64_t memory_of(noc_view *r) {
    noc_frame_stats stats;
    noc_view_get_stats(r, &stats);
    return stats.memory_bytes;
}

/* What a dropped frame had gathered is forgotten with it, and what the last complete one kept stays, whichever views
 * the dropped one asked for. */
static void cancelled_frames(void **state) {
    (void)state;
    noc_scene *s = street(30);
    noc_camera c = along();
    for (int kind = 0; kind < 2; kind++) {
        noc_render_params p = any(kind);
        p.width = 160;
        p.height = 96;
        noc_view *a = rendered(s, &c, &p, 3, 1), *b = rendered(s, &c, &p, 3, 1);
        noc_render_params other = p;
        for (int i = 0; i < 9; i++) {
            int n = 1 + i / 3 * 20;
            other.aovs = i % 3 == 0 ? p.aovs : i % 3 == 1 ? 0 : 1u << NOC_AOV_RAYS | 1u << NOC_AOV_DEPTH;
            assert_int_equal(noc_view_render(b, &c, &other, &(noc_progress){ stop_late, &n }), NOC_ERR_CANCELLED);
            assert_same_views(a, b, p.aovs);
        }
        assert_int_equal(noc_view_render(a, &c, &p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(b, &c, &other, NULL), NOC_OK);
        assert_true(memory_of(a) > memory_of(b)); /* which has dropped the others */
        close_view(a);
        close_view(b);
    }
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_on_every_instruction_set_and_number_of_threads),
        cmocka_unit_test(the_picture_is_the_same),
        cmocka_unit_test(scenes_of_nothing),
        cmocka_unit_test(wrong_requests),
        cmocka_unit_test(cancelled_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
