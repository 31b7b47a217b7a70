/* Frames that are run in pieces: the same bits, and the caller breaks them off between any two of these. */
#include "all_kinds.h"

#include "backend/vulkan/vulkan.h"
#include "render/device.h"
#include "render/view.h"

#include "test.h"

enum { FRAMES = 3 };

static noc_log *device_log;
static noc_device *device;
static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

static vk_pace *pace_of(noc_view *v) { return &((vk_view *)v->state)->pace; }

/* Every invocation takes a second, as far as is known: a piece is a row of blocks, or of tiles. */
static void expect_long(noc_view *v) {
    vk_pace *p = pace_of(v);
    for (int pass = 0; pass < NOC_PASS_COUNT; pass++)
        for (int shader = 0; shader < VK_SHADER_COUNT; shader++)
            p->cost[pass][shader] = 1;
}

/* What a frame's caller was asked. */
typedef struct caller {
    int calls, last; /* last: at which it breaks the frame off; 0: at none */
    bool again;      /* what is done may begin anew */
    double done;
} caller;

static bool count(void *user, const char *what, double done) {
    caller *c = user;
    (void)what;
    assert_true((done >= c->done || c->again) && done <= 1);
    c->done = done;
    assert_true(!c->last || c->calls < c->last); /* it is not asked again */
    return ++c->calls != c->last;
}

static noc_status render_cut(noc_view *v, const noc_render_params *p, caller *c) {
    c->calls = 0;
    c->done = 0;
    expect_long(v);
    return noc_view_render(v, &camera, p, &(noc_progress){ count, c });
}

static void expect_same_pictures(const char *what, noc_view *a, noc_view *b) {
    noc_image *one = noc_view_image(a), *other = noc_view_image(b);
    assert_true(one && other);
    size_t n = (size_t)one->width * (size_t)one->height;
    if (memcmp(one->rgb, other->rgb, 3 * n * sizeof(float)) != 0 || memcmp(one->emitter, other->emitter, n) != 0 ||
        memcmp(one->coverage, other->coverage, 4 * n * sizeof(float)) != 0)
        fail_msg("%s: the pictures differ", what);
    noc_image_destroy(one);
    noc_image_destroy(other);
}

static void expect_same_counts(const char *what, noc_view *a, noc_view *b) {
    noc_frame_stats one, other;
    noc_view_get_stats(a, &one);
    noc_view_get_stats(b, &other);
    if (one.rays_primary != other.rays_primary || one.rays_shadow != other.rays_shadow || one.dropped != other.dropped)
        fail_msg("%s: %zu rays, not %zu", what, (size_t)other.rays_shadow, (size_t)one.rays_shadow);
}

static noc_render_params params_of(noc_method method, noc_candidates candidates, noc_bias bias) {
    noc_render_params p = all_kinds_params(method, false);
    p.candidates = candidates;
    p.bias = bias ? bias : p.bias;
    p.height = 42; /* the last row of tiles has three rows of blocks, the last of which is cut */
    return p;
}

/* bytes: that a band of the cut one may take. Returns how often the caller of the last frame was asked. */
static int same_as_whole(const char *what, const noc_scene *scene, const noc_render_params *p, size_t bytes) {
    size_t *band = &((vk_device *)device->state)->band_bytes, before = *band;
    noc_view *whole = noc_view_create(device, scene), *cut = noc_view_create(device, scene);
    caller c = { 0 };
    assert_true(whole && cut);
    for (int f = 0; f < FRAMES; f++) {
        assert_int_equal(noc_view_render(whole, &camera, p, NULL), NOC_OK);
        *band = bytes ? bytes : before;
        assert_int_equal(render_cut(cut, p, &c), NOC_OK);
        *band = before;
        const vk_picture *b = &((const vk_view *)cut->state)->b;
        if (bytes && p->candidates != NOC_CANDIDATES_LISTS)
            assert_in_range(b->ray_room, 1, (size_t)b->blocks_x * b->blocks_y * BLOCK);
        expect_same_pictures(what, whole, cut);
        expect_same_counts(what, whole, cut);
    }
    noc_view_destroy(whole);
    noc_view_destroy(cut);
    return c.calls;
}

static const struct {
    const char *name;
    noc_method method;
    noc_candidates candidates;
    noc_bias bias;
    bool panes, in_space;
} kinds[] = {
    { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, 0, false, true },
    { "light-bvh", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, 0, false, true },
    { "pairwise", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true },
    { "influence", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_PAIRWISE, false, true },
    { "lists", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 0, true, true },
    { "lists, reuse", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, NOC_BIAS_PAIRWISE, false, true },
    { "lists, reuse in time", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, NOC_BIAS_MIS, true, false },
    { "mis", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, false, true },
    { "counted", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_COUNTED, true, true },
    { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, 0, true, true },
};

static void pieces_have_the_same_bits(void **state) {
    int car;
    (void)state;
    noc_scene *scenes[2] = { all_kinds_with(false, &car), all_kinds_with(true, &car) };
    for (size_t i = 0; i < NOC_COUNT(kinds); i++) {
        noc_render_params p = params_of(kinds[i].method, kinds[i].candidates, kinds[i].bias);
        p.spatial = kinds[i].in_space;
        int calls = same_as_whole(kinds[i].name, scenes[kinds[i].panes], &p, 0);
        print_message("# %s: asked %d times\n", kinds[i].name, calls);
        assert_true(calls > 2 * 11); /* at least two passes a row of blocks */
    }
    noc_scene_destroy(scenes[0]);
    noc_scene_destroy(scenes[1]);
}

/* Bands of a picture are cut, too, and have the bits of one that has no bands. No more rays are kept than the picture
 * has pixels. */
static void pieces_of_bands(void **state) {
    int car;
    (void)state;
    noc_scene *scenes[2] = { all_kinds_with(false, &car), all_kinds_with(true, &car) };
    for (size_t i = 3; i < NOC_COUNT(kinds); i++) {
        noc_render_params p = params_of(kinds[i].method, kinds[i].candidates, kinds[i].bias);
        p.spatial = kinds[i].in_space;
        same_as_whole(kinds[i].name, scenes[kinds[i].panes], &p, 1);
    }
    noc_scene_destroy(scenes[0]);
    noc_scene_destroy(scenes[1]);
}

/* The mean stays as it was, and the next frames are those of a view that begins. */
static void broken_off_between_pieces(void **state) {
    int car;
    (void)state;
    noc_scene *scene = all_kinds(&car);
    for (size_t i = 4; i < 6; i++) {
        noc_render_params p = params_of(kinds[i].method, kinds[i].candidates, kinds[i].bias);
        p.spatial = kinds[i].in_space;
        noc_view *whole = noc_view_create(device, scene), *cut = noc_view_create(device, scene);
        caller c = { 0 };
        int last = 1;
        assert_int_equal(noc_view_render(whole, &camera, &p, NULL), NOC_OK);
        do {
            noc_view_reset(cut);
            assert_int_equal(noc_view_render(cut, &camera, &p, NULL), NOC_OK);
            expect_same_pictures("a view that begins", whole, cut);
            c.last = last;
            last += 7;
            if (render_cut(cut, &p, &c) == NOC_OK)
                break;
            assert_int_equal(c.calls, c.last);
            expect_same_pictures("broken off", whole, cut);
        } while (last < 1000);
        print_message("# %s: broken off at calls up to %d\n", kinds[i].name, last - 14);
        assert_in_range(last, 50, 999);
        noc_view_destroy(whole);
        noc_view_destroy(cut);
    }
    noc_scene_destroy(scene);
}

/* Short frames are not cut, nor waited for: those of which that is known. */
static void short_frames_are_whole(void **state) {
    noc_render_params p = params_of(NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, 0);
    int car;
    (void)state;
    noc_scene *scene = all_kinds(&car);
    noc_view *v = noc_view_create(device, scene);
    caller c = { 0 };
    assert_int_equal(noc_view_render(v, &camera, &p, &(noc_progress){ count, &c }), NOC_OK);
    assert_true(c.calls > 2); /* nothing was known yet */
    vk_pace *pace = pace_of(v);
    for (int pass = 0; pass < NOC_PASS_COUNT; pass++)
        for (int shader = 0; shader < VK_SHADER_COUNT; shader++)
            pace->cost[pass][shader] = NOC_MIN(pace->cost[pass][shader], 1e-12);
    c = (caller){ 0 };
    assert_int_equal(noc_view_render(v, &camera, &p, &(noc_progress){ count, &c }), NOC_OK);
    assert_in_range(c.calls, 1, 2); /* stages */
    noc_view_destroy(v);
    noc_scene_destroy(scene);
}

/* The trace floor of a frame is cut as the frame is, and either half can be broken off. */
static void floors_are_cut(void **state) {
    noc_render_params p = params_of(NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, 0);
    int car, last = 1;
    (void)state;
    noc_scene *scene = all_kinds_with(true, &car);
    noc_view *v = noc_view_create(device, scene);
    for (noc_status status = NOC_ERR_CANCELLED; status != NOC_OK; last += 9) {
        noc_trace_floor floor = { -1, -1 };
        caller c = { .last = last, .again = true };
        expect_long(v);
        status = noc_view_trace_floor(v, &camera, &p, &(noc_progress){ count, &c }, &floor);
        assert_true(status == NOC_OK || (status == NOC_ERR_CANCELLED && c.calls == last));
        assert_true((floor.wall_seconds >= 0) == (status == NOC_OK));
    }
    print_message("# broken off at calls up to %d\n", last - 18);
    assert_in_range(last, 200, 400); /* the frame's, and a row of each of its 5 steps with rays twice */
    noc_view_destroy(v);
    noc_scene_destroy(scene);
}

/* More steps with rays than a command buffer has room for. */
static void a_floor_of_many_steps(void **state) {
    enum { LIGHTS = 1024 };
    noc_render_params p = params_of(NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, 0);
    noc_trace_floor floor = { -1, -1 };
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 12);
    add_pane(s, 0.5f, 0, 0, (double[]){ -6, -6, 2.5 }, 9, 9, true); /* a second step for each */
    for (int i = 0; i < LIGHTS; i++) {
        noc_light l = crowd_light(i, -2);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    p.width = p.height = 8;
    p.rays = LIGHTS;
    noc_view *v = noc_view_create(device, s);
    assert_int_equal(noc_view_trace_floor(v, &camera, &p, NULL, &floor), NOC_OK);
    const vk_view *state_of = v->state;
    assert_true(floor.wall_seconds > 0);
    assert_in_range(state_of->flights[state_of->flight].steps, 1, VK_STEPS);
    noc_view_destroy(v);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_have_the_same_bits),
        cmocka_unit_test(pieces_of_bands),
        cmocka_unit_test(broken_off_between_pieces),
        cmocka_unit_test(short_frames_are_whole),
        cmocka_unit_test(floors_are_cut),
        cmocka_unit_test(a_floor_of_many_steps),
    };
    device_log = noc_log_create(NULL);
    device = noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, device_log);
    if (!device) {
        printf("1..0 # SKIP %s\n", noc_log_last_error(device_log));
        noc_log_destroy(device_log);
        return 0;
    }
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_device_destroy(device);
    noc_log_destroy(device_log);
    return failed;
}
