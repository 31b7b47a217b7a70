/* What the option table says that a change makes a view forget (noc_option.resets) is what it forgets, and nothing that
 * is kept makes a picture wrong. */
#include "../own_view.h"
#include "unbiased.h"

#include <nocturne/option.h>

enum { SIDE = 24, BEFORE = 3 };

/* A floor with walls to hide behind, and more lamps than a list holds. */
static noc_scene *yard(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.6f);
    add_floor(s, grey, 0, 0, 0, 20);
    for (int i = -2; i <= 2; i++)
        QUAD(s, grey, 3 * i - 1, 0.5 * i, 0, 2, 0.7, 0, 0, 0, 4);
    for (int i = 0; i < 100; i++)
        assert_true(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_SPHERE,
                                                         .radius = 0.1,
                                                         .emission = { 90, 80 + i % 9, 60 },
                                                         .position = { i % 10 - 5, i / 10 - 5, 2 + 0.1 * (i % 7) } }) >=
                    0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_camera above(void) { return look(2, -13, 5, 0, 0, 0.5, 60); }

static noc_render_params basic(noc_method method) {
    noc_render_params p = measure(SIDE, SIDE, method);
    p.jitter = true;
    p.sky = 0.01;
    p.spatial = false;
    p.shadow_rays = 3;
    p.aovs = method == NOC_METHOD_RESTIR ? 1u << NOC_AOV_CONFIDENCE : 0;
    return p;
}

/* Another value than p's. */
static void change(const noc_option *o, noc_render_params *p) {
    char *field = (char *)p + o->offset;
    switch (o->kind) {
    case NOC_OPTION_BOOL: *(bool *)field = !*(bool *)field; break;
    case NOC_OPTION_REAL: *(double *)field = *(double *)field == o->min ? (o->min + o->max) / 2 : o->min; break;
    case NOC_OPTION_CHOICE: *(int *)field = !*(int *)field; break;
    default: *(int *)field += *(int *)field == (int)o->max ? -1 : 1; break;
    }
}

static void frame(noc_view *v, const noc_render_params *p) {
    noc_camera c = above();
    assert_int_equal(noc_view_render(v, &c, p, NULL), NOC_OK);
}

static uint64_t frames_of(noc_view *v) {
    noc_frame_stats stats;
    noc_view_get_stats(v, &stats);
    return stats.frames;
}

static float most_confidence(noc_view *v) {
    noc_channel *m = noc_view_aov(v, NOC_AOV_CONFIDENCE);
    float most = 0;
    assert_non_null(m);
    for (int i = 0; i < m->width * m->height; i++)
        most = NOC_MAX(most, m->value[i]);
    noc_channel_destroy(m);
    return most;
}

static noc_view *rendered(const noc_scene *s, const noc_render_params *p, int frames) {
    noc_view *v = own_view(s, 2, NULL);
    assert_non_null(v);
    for (int i = 0; i < frames; i++)
        frame(v, p);
    return v;
}

static bool equal(noc_view *a, noc_view *b) {
    noc_image *x = noc_view_image(a), *y = noc_view_image(b);
    assert_int_equal(x->width, y->width);
    bool same = !memcmp(x->rgb, y->rgb, sizeof(float) * 3 * (size_t)x->width * x->height);
    noc_image_destroy(x);
    noc_image_destroy(y);
    return same;
}

/* Is b the mean of a's `count` frames and the one of c? */
static bool goes_on(noc_view *a, noc_view *c, noc_view *b, int count) {
    noc_image *x = noc_view_image(a), *y = noc_view_image(c), *z = noc_view_image(b);
    double off = 0;
    for (size_t i = 0; i < 3 * (size_t)z->width * z->height; i++) {
        double mean = x->rgb[i] + (y->rgb[i] - x->rgb[i]) / (count + 1);
        off = fmax(off, fabs(mean - z->rgb[i]) / (1e-6 + fabs(mean)));
    }
    noc_image_destroy(x);
    noc_image_destroy(y);
    noc_image_destroy(z);
    return off < 1e-4;
}

static void check_option(const noc_scene *s, const noc_option *o, noc_render_params p) {
    noc_render_params q = p, alone;
    char why[80];
    change(o, &q);
    q.aovs = q.method == NOC_METHOD_RESTIR ? p.aovs : 0;
    if (noc_option_idle(o, noc_render_options(), &p, why, sizeof(why)) &&
        noc_option_idle(o, noc_render_options(), &q, why, sizeof(why)))
        return;
    noc_view *before = rendered(s, &p, BEFORE), *after = rendered(s, &p, BEFORE), *single = rendered(s, &p, BEFORE);
    noc_view *fresh = rendered(s, &q, 1);
    frame(after, &q);
    alone = q;
    alone.accumulate = false;
    frame(single, &alone);
    bool mean = o->resets & NOC_RESETS_MEAN;
    if (frames_of(after) != (mean ? 1 : BEFORE + 1))
        fail_msg("%s: %d frames in the mean", o->name, (int)frames_of(after));
    if (mean && !equal(after, single))
        fail_msg("%s: the mean does not start anew", o->name);
    if (!mean && !goes_on(before, single, after, BEFORE))
        fail_msg("%s: the mean does not go on", o->name);
    if ((o->resets == NOC_RESETS_ALL) != equal(after, fresh))
        fail_msg("%s: %s", o->name, o->resets == NOC_RESETS_ALL ? "something is remembered" : "all is forgotten");
    if (p.method == NOC_METHOD_RESTIR && q.method == NOC_METHOD_RESTIR && q.temporal && !q.spatial && q.history > 0) {
        bool kept = most_confidence(after) > (float)q.draws;
        if (kept == !!(o->resets & NOC_RESETS_RESERVOIRS))
            fail_msg("%s: reservoirs are %s", o->name, kept ? "kept" : "lost");
    }
    close_view(before);
    close_view(after);
    close_view(single);
    close_view(fresh);
}

static void rows_are_true(void **state) {
    (void)state;
    noc_scene *s = yard();
    for (const noc_option *o = noc_render_options(); o->name; o++) {
        noc_render_params lists = basic(NOC_METHOD_RESTIR), spatial = lists, drawn = lists, plain = lists;
        spatial.spatial = true;
        drawn.candidates = NOC_CANDIDATES_INFLUENCE;
        plain.visibility_reuse = false;
        check_option(s, o, lists);
        check_option(s, o, spatial);
        check_option(s, o, drawn);
        check_option(s, o, plain);
        check_option(s, o, basic(NOC_METHOD_RIS));
        check_option(s, o, basic(NOC_METHOD_REFERENCE));
    }
    noc_scene_destroy(s);
}

/* A mean that was left for single frames is gone: it begins with the first frame that is accumulated again. */
static void a_mean_that_was_left_begins_anew(void **state) {
    (void)state;
    noc_scene *s = yard();
    noc_render_params p = basic(NOC_METHOD_RIS), alone = p;
    alone.accumulate = false;
    noc_view *a = rendered(s, &p, BEFORE), *b = rendered(s, &p, BEFORE);
    frame(a, &alone);
    frame(b, &alone);
    frame(a, &p);
    frame(b, &alone);
    assert_int_equal(frames_of(a), 1);
    assert_true(equal(a, b));
    close_view(a);
    close_view(b);
    noc_scene_destroy(s);
}

/* What is learned of visibility is of places in the scene: another size, and rays go where they found light before. */
static void sizes_keep_what_was_learned(void **state) {
    (void)state;
    noc_scene *s = yard();
    static const int sides[] = { SIDE - 5, SIDE + 60, SIDE };
    noc_render_params p = basic(NOC_METHOD_RIS), q = p;
    noc_view *v = rendered(s, &p, 4);
    for (size_t i = 0; i < NOC_COUNT(sides); i++) {
        q.width = q.height = sides[i];
        frame(v, &q);
        assert_int_equal(frames_of(v), 1);
        noc_view *fresh = rendered(s, &q, 1);
        assert_false(equal(v, fresh));
        close_view(fresh);
    }
    noc_view_reset(v);
    frame(v, &p);
    noc_view *fresh = rendered(s, &p, 1);
    assert_true(equal(v, fresh));
    close_view(fresh);
    close_view(v);
    noc_scene_destroy(s);
}

/* Are the camera's rays traced in a frame of these parameters? Pictures of `all`, which traces them each time for a
 * view of what they hit, are the same to the bit. */
static bool traces(noc_view *v, noc_view *all, const noc_camera *c, noc_render_params p) {
    noc_frame_stats stats;
    assert_int_equal(noc_view_render(v, c, &p, NULL), NOC_OK);
    noc_view_get_stats(v, &stats);
    assert_true(!stats.rays_primary || stats.rays_primary == (uint64_t)p.width * (uint64_t)p.height);
    p.aovs |= 1u << NOC_AOV_OBJECT;
    assert_int_equal(noc_view_render(all, c, &p, NULL), NOC_OK);
    assert_true(equal(v, all));
    return stats.rays_primary > 0;
}

static bool refuse(void *user, const char *what, double done) {
    (void)what;
    (void)done;
    return --*(int *)user > 0;
}

/* The G-buffer is kept while nothing moves: neither the camera and what it sees, nor places in pixels. */
static void surfaces_are_kept_while_nothing_moves(void **state) {
    (void)state;
    for (int method = NOC_METHOD_RIS; method <= NOC_METHOD_RESTIR; method++) {
        noc_scene *s = yard();
        noc_camera c = above(), aside = look(3, -13, 5, 0, 0, 0.5, 60);
        noc_render_params p = basic(method), q = p;
        p.aovs = 0;
        p.spatial = true;
        noc_view *v = own_view(s, 1, NULL), *all = own_view(s, 1, NULL); /* one thread: the same tiles are dropped */
        assert_true(traces(v, all, &c, p) && traces(v, all, &c, p));     /* with jitter */
        p.jitter = false;
        assert_true(traces(v, all, &c, p));
        for (int i = 0; i < 3; i++)
            assert_false(traces(v, all, &c, p));
        p.aovs = 1u << NOC_AOV_MOTION | 1u << NOC_AOV_NORMAL;
        assert_false(traces(v, all, &c, p));
        p.aovs = 1u << NOC_AOV_CLASS;
        assert_true(traces(v, all, &c, p));
        p.aovs = 0;
        assert_true(traces(v, all, &aside, p) && traces(v, all, &c, p));
        assert_false(traces(v, all, &c, p));
        QUAD(s, 0, -1, -2, 0, 2, 0, 0, 0, 0, 2);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_true(traces(v, all, &c, p));
        assert_false(traces(v, all, &c, p));
        q = p;
        q.width = q.height = SIDE + 9;
        assert_true(traces(v, all, &c, q) && traces(v, all, &c, p));
        assert_false(traces(v, all, &c, p));
        int left = 2; /* a frame that is dropped, of another place */
        noc_progress stop = { refuse, &left };
        assert_int_equal(noc_view_render(v, &aside, &p, &stop), NOC_ERR_CANCELLED);
        left = 2;
        assert_int_equal(noc_view_render(all, &aside, &p, &stop), NOC_ERR_CANCELLED);
        assert_true(traces(v, all, &c, p));
        noc_view_reset(v);
        noc_view_reset(all);
        assert_true(traces(v, all, &c, p));
        close_view(v);
        close_view(all);
        noc_scene_destroy(s);
    }
}

/* A view that is reset is as a new one, also where the frames after it do not learn what those before it did. */
static void a_reset_view_is_as_new(void **state) {
    (void)state;
    noc_scene *s = yard();
    for (int i = 0; i < 3; i++) {
        noc_render_params p = basic(NOC_METHOD_RIS), q = p;
        q.learn = i != 1;
        q.final_ray = i != 2;
        noc_view *v = rendered(s, &p, 4), *fresh = rendered(s, &q, 1);
        noc_view_reset(v);
        frame(v, &q);
        assert_true(equal(v, fresh));
        close_view(v);
        close_view(fresh);
    }
    noc_scene_destroy(s);
}

/* AOVs, and options that are idle, are forgotten nowhere. */
static void idle_options_and_aovs_reset_nothing(void **state) {
    (void)state;
    noc_scene *s = yard();
    noc_render_params p = basic(NOC_METHOD_RIS), q = p;
    noc_view *a = rendered(s, &p, BEFORE + 2), *b = rendered(s, &p, BEFORE);
    q.radius = 3;
    q.bias = NOC_BIAS_BIASED;
    q.rays = 5;
    q.aovs = 1u << NOC_AOV_DEPTH | 1u << NOC_AOV_RAYS;
    frame(b, &q);
    frame(b, &p);
    assert_int_equal(frames_of(b), BEFORE + 2);
    assert_true(equal(a, b));
    close_view(a);
    close_view(b);
    noc_scene_destroy(s);
}

/* Reservoirs that outlive a change of options are right in the frames after it. */
static void what_is_kept_is_unbiased(void **state) {
    (void)state;
    noc_scene *s = yard();
    result reference = measure_reference(s, false, NULL, samples(300));
    const config lists = { .method = NOC_METHOD_RESTIR,
                           .temporal = true,
                           .bias = NOC_BIAS_PAIRWISE,
                           .rays = true,
                           .reuse = true,
                           .list = 16 };
    noc_view *v = own_view(s, 2, NULL);
    noc_camera c = camera_at(0, false);
    int wrong = 0;
    for (int kind = 0; kind < 4; kind++) {
        static const char *const names[] = { "lists, then uniform", "uniform, then lists", "8 draws, then 2",
                                             "frames, then neighbours too" };
        result x = { 0 };
        for (int run = 0; run < samples(600); run++) {
            noc_render_params p = params_of(&lists, (uint32_t)run * 7919 + 17), q = p;
            *(kind == 1 ? &p : &q) = p;
            if (kind == 0)
                q.candidates = NOC_CANDIDATES_UNIFORM;
            if (kind == 1)
                p.candidates = NOC_CANDIDATES_UNIFORM;
            if (kind == 2) {
                p.candidates = q.candidates = NOC_CANDIDATES_UNIFORM;
                q.draws = 2;
            }
            if (kind == 3)
                q.spatial = true;
            noc_view_reset(v);
            for (int f = 0; f < 6; f++)
                assert_int_equal(noc_view_render(v, &c, f < 4 ? &p : &q, NULL), NOC_OK);
            for (int at = 0; at < CHECKS; at++)
                add_picture(&x.at[at], v);
        }
        wrong += !agrees(names[kind], &x, &reference);
    }
    close_view(v);
    noc_scene_destroy(s);
    assert_int_equal(wrong, 0);
}

/* noc_view_restart: the mean is that of the frames since then, and those are what they would have been without it. */
static void a_restart_begins_the_mean_alone(void **state) {
    enum { ALL = 4, AFTER = 2, NUMBERS = 3 * SIDE * SIDE };
    noc_scene *s = yard();
    noc_render_params p = basic(NOC_METHOD_RESTIR), alone = p;
    noc_view *v = own_view(s, 1, NULL), *single = own_view(s, 1, NULL);
    double mean[NUMBERS] = { 0 };
    alone.accumulate = false;
    for (int i = 0; i < ALL; i++) {
        if (i == AFTER)
            noc_view_restart(v);
        frame(v, &p);
        frame(single, &alone);
        assert_int_equal(frames_of(v), 1 + i % AFTER);
        noc_image *image = noc_view_image(single);
        for (int k = 0; k < NUMBERS && i >= AFTER; k++)
            mean[k] += (double)image->rgb[k] / (ALL - AFTER);
        noc_image_destroy(image);
    }
    noc_image *image = noc_view_image(v);
    for (int k = 0; k < NUMBERS; k++)
        assert_true(fabs((double)image->rgb[k] - mean[k]) <= 1e-5 * (1 + mean[k]));
    noc_image_destroy(image);
    close_view(v);
    close_view(single);
    noc_scene_destroy(s);
    (void)state;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_true),
        cmocka_unit_test(a_mean_that_was_left_begins_anew),
        cmocka_unit_test(sizes_keep_what_was_learned),
        cmocka_unit_test(surfaces_are_kept_while_nothing_moves),
        cmocka_unit_test(a_reset_view_is_as_new),
        cmocka_unit_test(idle_options_and_aovs_reset_nothing),
        cmocka_unit_test(what_is_kept_is_unbiased),
        cmocka_unit_test(a_restart_begins_the_mean_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
