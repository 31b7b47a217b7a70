/* Memory that is refused to a renderer: every allocation of its making and of its frames, alone and with all later
 * ones. It ends in a status and one message; the next frame with memory is the one that follows a cancelled frame, or a
 * first one. */
#include "../memory.h"
#include "rooms.h"

enum { WIDTH = 36, HEIGHT = 20, STANDING = 20, MOVING = 4 };

static noc_light moving_light(int i, int frame) {
    return (noc_light){ .kind = NOC_LIGHT_SPHERE,
                        .position = { -4 + 2.5 * i + 0.5 * frame, 1, 2.5 },
                        .radius = 0.2,
                        .emission = { 40, 30, 20 },
                        .moving = true };
}

static void pose(noc_scene *s, int frame) {
    for (int i = 0; i < MOVING; i++) {
        noc_light l = moving_light(i, frame);
        assert_int_equal(noc_scene_move_light(s, STANDING + i, &l), NOC_OK);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
}

/* A floor, a wall, screens between, one of them an instance, lamps and lit windows that stand, and some lights that
 * move. */
static noc_scene *yard(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    noc_mesh screen = { .vertex_count = 3,
                        .positions = (double[]){ 0, 0, 0, 1, 0, 0, 0, 0, 2 },
                        .triangle_count = 1,
                        .indices = (uint32_t[]){ 0, 1, 2 },
                        .material = grey,
                        .model = noc_scene_add_model(s, "screen") };
    noc_instance stands = { .model = screen.model, .transform = { 1, 0, 0, 3, 0, 1, 0, -2, 0, 0, 1, 0 } };
    assert_int_equal(noc_scene_add_mesh(s, &screen), 0);
    assert_int_equal(noc_scene_add_instance(s, &stands), 0);
    add_floor(s, grey, 0, 0, 0, 10);
    QUAD(s, grey, -8, 6, 0, 16, 0, 0, 0, 0, 6);
    for (int i = 0; i < 6; i++)
        QUAD(s, grey, -6 + 2 * i, 1 - i % 3, 0, 1, 0, 0, 0, 0, 2);
    for (int i = 0; i < STANDING; i++) {
        noc_light lamp = { .kind = NOC_LIGHT_DISC,
                           .position = { -7 + 0.7 * i, 3 - 2 * (i % 3), 3.5 },
                           .direction = { 0, 0, -1 },
                           .radius = 0.15,
                           .emission = { 60, 50, 40 } };
        noc_light window = { .kind = NOC_LIGHT_PARALLELOGRAM,
                             .position = { -7 + 0.7 * i, 5.99, 1 + i % 4 },
                             .edge_u = { 0.5, 0, 0 },
                             .edge_v = { 0, 0, 0.6 },
                             .emission = { 20, 15, 10 } };
        assert_int_equal(noc_scene_add_light(s, i % 2 ? &lamp : &window), i);
    }
    for (int i = 0; i < MOVING; i++) {
        noc_light l = moving_light(i, 0);
        assert_int_equal(noc_scene_add_light(s, &l), STANDING + i);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

typedef struct config {
    const char *name;
    noc_method method;
    noc_candidates candidates;
    bool reuse, boxes;
    uint32_t aovs;
} config;

#define SEEN (1u << NOC_AOV_RAYS | 1u << NOC_AOV_LIGHT | 1u << NOC_AOV_NORMAL | 1u << NOC_AOV_VARIANCE)
static const config configs[] = {
    { "reference", NOC_METHOD_REFERENCE },
    { "ris, uniform", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM },
    { "ris, power", NOC_METHOD_RIS, NOC_CANDIDATES_POWER },
    { "ris, lists", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS },
    { "ris, influence with boxes and views", NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, .boxes = true, .aovs = SEEN },
    { "restir, influence", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, .reuse = true },
    { "restir, light-bvh", NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, .reuse = true },
    { "restir, lists", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, .reuse = true },
};

static noc_render_params params_of(const config *c) {
    noc_render_params p = measure(WIDTH, HEIGHT, c->method);
    p.candidates = c->candidates;
    p.temporal = p.spatial = c->reuse;
    p.influence_boxes = c->boxes ? NOC_INFLUENCE_VISIBLE : NOC_INFLUENCE_SPHERE;
    p.influence_cluster = c->boxes ? 2 : 1;
    p.aovs = c->aovs;
    p.sky = 0.01;
    return p;
}

static noc_view *two_threads(const noc_scene *s, noc_log *log) { return own_view(s, 2, log); }

/* The picture's bits: of one frame, as every frame here starts the mean anew. */
typedef struct picture {
    float rgb[3 * WIDTH * HEIGHT];
} picture;

static picture picture_of(noc_view *r) {
    noc_image *image = noc_view_image(r);
    picture p;
    assert_non_null(image);
    memcpy(p.rgb, image->rgb, sizeof(p.rgb));
    noc_image_destroy(image);
    return p;
}

static bool same(const picture *a, const picture *b) { return !memcmp(a, b, sizeof(*a)); }

static const noc_camera *camera(void) {
    static noc_camera c;
    c = look(0, -9, 3, 0, 2, 1.5, 60);
    return &c;
}

static picture next_frame(noc_view *r, const noc_render_params *p) {
    assert_int_equal(noc_view_render(r, camera(), p, NULL), NOC_OK);
    return picture_of(r);
}

static bool go_on(void *user, const char *what, double done) { return done < *(double *)user; }

/* Cancels a frame at its beginning, or where its last stage begins: half of it where frames are reused in time and
 * space. */
static void cancelled_frame(noc_view *r, const noc_render_params *p, double done) {
    noc_progress progress = { go_on, &done };
    assert_int_equal(noc_view_render(r, camera(), p, &progress), NOC_ERR_CANCELLED);
}

/* ---- a renderer and its first frame ---- */

static void first_frame(const config *c) {
    noc_scene *s = yard();
    noc_render_params p = params_of(c);
    noc_log *log = counting_log();
    noc_view *untouched = two_threads(s, NULL), *dropped = two_threads(s, NULL);
    picture first = next_frame(untouched, &p);
    cancelled_frame(dropped, &p, 0);
    picture second = next_frame(dropped, &p);
    assert_false(same(&first, &second));
    bool reached;
    FOR_EVERY_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_view *r = two_threads(s, log);
        noc_status status = r ? noc_view_render(r, camera(), &p, NULL) : NOC_ERR_MEMORY;
        reached = end_refusal();
        if (status == NOC_OK) {
            picture now = picture_of(r);
            assert_unharmed(same(&now, &first), c->name);
        } else {
            assert_refused(status, c->name);
        }
        if (r) {
            picture now = next_frame(r, &p);
            assert_true(status == NOC_OK || same(&now, &first) || same(&now, &second));
            noc_view_reset(r);
            now = next_frame(r, &p);
            assert_true(same(&now, &first));
        }
        close_view(r);
    }
    close_view(untouched);
    close_view(dropped);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

static void test_first_frame(void **state) {
    for (size_t i = 0; i < NOC_COUNT(configs); i++)
        first_frame(&configs[i]);
}

/* ---- a frame after lights have moved ---- */

static noc_view *after_one_frame(noc_scene *s, const noc_render_params *p, noc_log *log) {
    pose(s, 0);
    noc_view *r = two_threads(s, log);
    next_frame(r, p);
    pose(s, 1);
    return r;
}

/* The frame after one that was cancelled there. */
static picture after_cancelling(noc_scene *s, const noc_render_params *p, double done) {
    noc_view *r = after_one_frame(s, p, NULL);
    cancelled_frame(r, p, done);
    picture now = next_frame(r, p);
    close_view(r);
    return now;
}

static void moved_frame(const config *c) {
    noc_scene *s = yard();
    noc_render_params p = params_of(c);
    noc_log *log = counting_log();
    picture early = after_cancelling(s, &p, 0), late = c->reuse ? after_cancelling(s, &p, 0.5) : early;
    noc_view *untouched = after_one_frame(s, &p, NULL);
    picture second = next_frame(untouched, &p);
    bool reached;
    int refused = 0;
    FOR_EVERY_REFUSAL(reached) {
        noc_view *r = after_one_frame(s, &p, log);
        begin_refusal(n, later);
        noc_status status = noc_view_render(r, camera(), &p, NULL);
        reached = end_refusal();
        picture now = status == NOC_OK ? picture_of(r) : next_frame(r, &p);
        if (status == NOC_OK) {
            assert_unharmed(same(&now, &second), c->name);
        } else {
            assert_refused(status, c->name);
            assert_true(same(&now, &early) || same(&now, &late));
            refused++;
        }
        close_view(r);
    }
    if (c->candidates == NOC_CANDIDATES_LISTS || c->candidates == NOC_CANDIDATES_INFLUENCE ||
        c->candidates == NOC_CANDIDATES_LIGHT_BVH)
        assert_true(refused > 0); /* what is built over moved lights is built anew */
    close_view(untouched);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

static void test_moved_frame(void **state) {
    for (size_t i = 0; i < NOC_COUNT(configs); i++)
        moved_frame(&configs[i]);
}

/* ---- frames at rest ---- */

/* What passes need is there after some frames: the others ask for no memory. One thread, so that it is always the same
 * scratch that a tile finds. */
static void test_at_rest(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(configs); i++) {
        noc_scene *s = yard();
        noc_view *r = own_view(s, 1, NULL);
        noc_render_params p = params_of(&configs[i]);
        for (int frame = 0; frame < 12; frame++) {
            noc_refuse_allocation(UINT64_MAX, false);
            assert_int_equal(noc_view_render(r, camera(), &p, NULL), NOC_OK);
            uint64_t asked = noc_allocations();
            noc_refuse_allocation(0, false);
            if (frame > 7 && asked)
                fail_msg("%s: frame %d asks for memory %d times", configs[i].name, frame, (int)asked);
            assert_true(frame || asked);
        }
        close_view(r);
        noc_scene_destroy(s);
    }
}

/* ---- what is read from a renderer, and its trace floor ---- */

static noc_status read_all(noc_view *r, const noc_render_params *p) {
    noc_trace_floor floor;
    noc_image *image = noc_view_image(r);
    noc_channel *normal = image ? noc_view_aov(r, NOC_AOV_NORMAL) : NULL;
    noc_status status = normal ? noc_view_trace_floor(r, camera(), p, NULL, &floor) : NOC_ERR_MEMORY;
    noc_image_destroy(image);
    noc_channel_destroy(normal);
    return status;
}

static void test_reading(void **state) {
    noc_scene *s = yard();
    noc_log *log = counting_log();
    noc_render_params p = params_of(&configs[4]);
    noc_view *r = two_threads(s, log);
    bool reached;
    next_frame(r, &p);
    FOR_EACH_REFUSAL(reached) {
        begin_refusal(n, later);
        noc_status status = read_all(r, &p);
        reached = end_refusal();
        if (status != NOC_OK)
            assert_refused(status, "reading");
        assert_true(status == NOC_OK || reached);
        assert_int_equal(read_all(r, &p), NOC_OK);
    }
    close_view(r);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

/* A frame that asks for views which there is no memory for leaves those of the frame before. */
static void test_views(void **state) {
    noc_scene *s = yard();
    noc_log *log = counting_log();
    noc_render_params one = params_of(&configs[4]), others = one;
    one.aovs = 1u << NOC_AOV_NORMAL;
    others.aovs = SEEN & ~one.aovs;
    noc_view *r = two_threads(s, log);
    bool reached;
    int refused = 0;
    FOR_EACH_REFUSAL(reached) {
        next_frame(r, &one);
        begin_refusal(n, later);
        noc_status status = noc_view_render(r, camera(), &others, NULL);
        reached = end_refusal();
        if (status == NOC_OK)
            continue;
        assert_refused(status, "views");
        noc_channel *normal = noc_view_aov(r, NOC_AOV_NORMAL);
        assert_non_null(normal);
        noc_channel_destroy(normal);
        refused++;
    }
    assert_true(refused > 0);
    close_view(r);
    noc_log_destroy(log);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_first_frame), cmocka_unit_test(test_moved_frame),
                                        cmocka_unit_test(test_at_rest), cmocka_unit_test(test_reading),
                                        cmocka_unit_test(test_views) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
