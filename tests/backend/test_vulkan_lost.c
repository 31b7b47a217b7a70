/* A Vulkan device that is lost, at each submission and wait in turn: one error, what was read last stays with the
 * number of its frames, and later calls refuse. */
#include "all_kinds.h"
#include "vulkan_fault.h"

#include "render/device.h"
#include "render/view.h"

enum { FRAMES = 4, READ = 2 }; /* frames rendered; the one after which the picture is read */

static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

static noc_render_params params_of(noc_method method, noc_candidates candidates) {
    noc_render_params p = all_kinds_params(method, false);
    p.width = p.height = 16;
    p.candidates = candidates;
    return p;
}

static uint64_t frames_of(noc_view *v) {
    noc_frame_stats stats;
    noc_view_get_stats(v, &stats);
    return stats.frames;
}

static void expect_same(const char *when, const noc_image *a, const noc_image *b) {
    size_t n = (size_t)a->width * (size_t)a->height;
    if (a->width != b->width || a->height != b->height || memcmp(a->rgb, b->rgb, 3 * n * sizeof(float)) != 0 ||
        memcmp(a->emitter, b->emitter, n) != 0 || memcmp(a->coverage, b->coverage, 4 * n * sizeof(float)) != 0)
        fail_msg("%s: what is left is not the picture that was read", when);
}

static bool cut; /* frames are run in pieces */

static bool go_on(void *user, const char *what, double done) { return true; }

/* In pieces of a row of blocks, or whole. */
static noc_status render_one(noc_view *v, const noc_render_params *p) {
    vk_pace *pace = &((vk_view *)v->state)->pace;
    for (int pass = 0; pass < NOC_PASS_COUNT && cut; pass++)
        for (int shader = 0; shader < VK_SHADER_COUNT; shader++)
            pace->cost[pass][shader] = 1;
    return noc_view_render(v, &camera, p, cut ? &(noc_progress){ go_on, NULL } : NULL);
}

/* Renders, and reads after READ frames. *complete: frames that were rendered. */
static noc_status render_and_read(noc_device *device, noc_scene *scene, const noc_render_params *p, noc_view **v,
                                  uint64_t *complete, bool *read) {
    noc_status status = NOC_OK;
    if (!(*v = noc_view_create(device, scene)))
        return noc_log_last_status(messages);
    for (int f = 0; f < FRAMES && status == NOC_OK; f++) {
        status = render_one(*v, p);
        *complete += status == NOC_OK;
        if (status != NOC_OK || f + 1 != READ)
            continue;
        noc_image *image = noc_view_image(*v);
        status = image ? NOC_OK : noc_log_last_status(messages);
        *read = image;
        noc_image_destroy(image);
    }
    return status;
}

/* The means of 1, 2, ... frames. */
static void make_means(noc_scene *scene, const noc_render_params *p, noc_image *means[FRAMES]) {
    fault_none();
    noc_device *device = open_vulkan();
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    for (int f = 0; f < FRAMES; f++) {
        assert_int_equal(noc_view_render(v, &camera, p, NULL), NOC_OK);
        assert_non_null(means[f] = noc_view_image(v));
    }
    noc_view_destroy(v);
    noc_device_destroy(device);
}

/* Each of the calls says in one line that the device was lost, and returns. */
static void expect_later_calls(const char *when, noc_device *device, noc_scene *scene, noc_view *v,
                               const noc_render_params *p) {
    noc_render_params larger = *p;
    noc_trace_floor floor;
    larger.width = 24;
    assert_null(noc_view_create(device, scene));
    EXPECT_TOLD(when, "vulkan: the device was lost before");
    if (!v)
        return;
    for (noc_aov aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (p->aovs >> aov & 1 && frames_of(v)) {
            noc_channel *channel = noc_view_aov(v, aov);
            if (channel)
                expect_silence(when);
            else
                EXPECT_TOLD(when, "view \"", noc_aov_name(aov));
            noc_channel_destroy(channel);
        }
    assert_int_equal(noc_view_render(v, &camera, p, NULL), NOC_ERR_LOST);
    EXPECT_TOLD(when, "vulkan: the device was lost before");
    assert_int_equal(noc_view_trace_floor(v, &camera, p, NULL, &floor), NOC_ERR_LOST);
    EXPECT_TOLD(when, "vulkan: the device was lost before");
    assert_int_equal(noc_view_render(v, &camera, &larger, NULL), NOC_ERR_LOST);
    EXPECT_TOLD(when, "vulkan: the device was lost before");
    assert_null(noc_view_image(v)); /* the picture went with its size */
    expect_silence(when);
}

/* So many frames are left, and the mean of them, as often as it is asked for. */
static void expect_left(const char *when, noc_view *v, uint64_t frames, noc_image *const means[FRAMES]) {
    for (int again = 0; again < 2; again++) {
        uint64_t told_frames = frames_of(v);
        if (told_frames != frames)
            fail_msg("%s: %d frames are left, not %d", when, (int)told_frames, (int)frames);
        noc_image *left = noc_view_image(v);
        assert_true((left != NULL) == (frames > 0));
        if (left)
            expect_same(when, means[frames - 1], left);
        noc_image_destroy(left);
    }
    expect_silence(when);
}

/* keeps: the view reads the mean itself, after each frame. Returns false if the device was not lost: all is done. */
static bool lose(noc_scene *scene, const noc_render_params *p, bool keeps, noc_image *const means[FRAMES],
                 long number) {
    noc_view *v = NULL;
    uint64_t complete = 0;
    bool read = false;
    char when[80];
    snprintf(when, sizeof(when), "%s, lost at use %ld", keeps ? "kept" : "read", number);
    fault_none();
    noc_device *device = open_vulkan();
    assert_non_null(device);
    ((vk_device *)device->state)->keep_seconds = keeps ? 0 : 1e9;
    fault.used = 0;
    fault.lost_from = number;
    noc_status status = render_and_read(device, scene, p, &v, &complete, &read);
    if (v)
        frames_of(v); /* waits for the last frame */
    bool lost = fault.used >= number;
    if (lost) {
        assert_true(status == NOC_ERR_LOST || (status == NOC_OK && complete == FRAMES));
        EXPECT_TOLD(when, "vulkan: ", "the device was lost (");
        if (v)
            expect_left(when, v, keeps ? complete : read ? READ : 0, means);
        expect_later_calls(when, device, scene, v, p);
    } else {
        assert_int_equal(status, NOC_OK);
    }
    noc_view_destroy(v);
    noc_device_destroy(device);
    expect_silence(when);
    expect_nothing_left(when);
    return lost;
}

/* Every device compiles its shaders, so that of a plan with many of them not every use is tried. */
static void lose_in_turn(const noc_render_params *p, bool keeps, long step) {
    noc_image *means[FRAMES];
    long number = 1;
    int car;
    noc_scene *scene = all_kinds(&car);
    make_means(scene, p, means);
    while (lose(scene, p, keeps, means, number))
        number += step;
    print_message("# lost up to use %ld\n", number - step);
    assert_true(number > step);
    for (int f = 0; f < FRAMES; f++)
        noc_image_destroy(means[f]);
    noc_scene_destroy(scene);
}

static void what_was_read_stays(void **state) {
    noc_render_params p = params_of(NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM);
    (void)state;
    if (!has_vulkan())
        skip();
    lose_in_turn(&p, false, 1);
}

static void what_is_kept_stays(void **state) {
    noc_render_params p = params_of(NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM);
    (void)state;
    if (!has_vulkan())
        skip();
    lose_in_turn(&p, true, 1);
    p = params_of(NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS);
    lose_in_turn(&p, true, 11);
}

/* The device may be lost in any piece of a frame. */
static void lost_between_pieces(void **state) {
    noc_render_params p = params_of(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM);
    (void)state;
    if (!has_vulkan())
        skip();
    cut = true;
    lose_in_turn(&p, true, 37);
    cut = false;
}

static void views_of_a_lost_device(void **state) {
    noc_render_params p = params_of(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM);
    (void)state;
    if (!has_vulkan())
        skip();
    p.aovs = 1u << NOC_AOV_DEPTH | 1u << NOC_AOV_LUMINANCE | 1u << NOC_AOV_ERROR | 1u << NOC_AOV_DENSITY;
    lose_in_turn(&p, true, 11);
}

/* A mean that begins anew does not come back as the one that was read before. */
static void an_older_mean_is_gone(void **state) {
    noc_render_params p = params_of(NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM);
    noc_camera other = camera;
    int car;
    (void)state;
    if (!has_vulkan())
        skip();
    noc_scene *scene = all_kinds(&car);
    fault_none();
    noc_device *device = open_vulkan();
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    for (int f = 0; f < 3; f++)
        assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_OK);
    noc_image_destroy(noc_view_image(v));
    other.eye[0] = 1;
    for (int f = 0; f < 3; f++)
        assert_int_equal(noc_view_render(v, &other, &p, NULL), NOC_OK);
    fault.lost_from = 0;
    assert_null(noc_view_image(v));
    EXPECT_TOLD("a new mean", "vulkan: ", "the device was lost (");
    assert_int_equal(frames_of(v), 0);
    assert_null(noc_view_image(v));
    expect_silence("a new mean");
    noc_view_destroy(v);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    expect_nothing_left("a new mean");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_read_stays),   cmocka_unit_test(what_is_kept_stays),
        cmocka_unit_test(lost_between_pieces),   cmocka_unit_test(views_of_a_lost_device),
        cmocka_unit_test(an_older_mean_is_gone),
    };
    messages = open_messages();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
