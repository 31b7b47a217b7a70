/* A Vulkan device that refuses memory, at each thing that is made in turn: one error, nothing left behind, and then the
 * same picture as if nothing had been. */
#include "all_kinds.h"
#include "vulkan_fault.h"

#include "render/device.h"
#include "render/view.h"

#define AOV(name) (1u << NOC_AOV_##name)

static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

static noc_render_params small_params(noc_method method, noc_candidates candidates) {
    noc_render_params p = all_kinds_params(method, false);
    p.width = p.height = 16;
    p.candidates = candidates;
    p.rays = 4;
    return p;
}

/* What is refused was told once: by whom, for what, and how much of it. */
static void expect_refusal(const char *name, noc_status status) {
    char when[160];
    snprintf(when, sizeof(when), "%s, %s is refused as number %ld", name, fault.refused, fault.refuse_from);
    if (status != NOC_ERR_MEMORY)
        fail_msg("%s: status %d, told:\n%s", when, status, told);
    if (strcmp(fault.refused, "vkAllocateMemory") != 0)
        EXPECT_TOLD(when, "vulkan: ", "out of");
    else
        EXPECT_TOLD(when, "vulkan: ", strstr(told, " bytes: ") ? " bytes: " : "B: ", ": out of device memory (");
}

static noc_image *picture_of(noc_view *v, const noc_render_params *p) {
    noc_view_reset(v);
    for (int f = 0; f < 2; f++)
        assert_int_equal(noc_view_render(v, &camera, p, NULL), NOC_OK);
    noc_image *image = noc_view_image(v);
    assert_non_null(image);
    return image;
}

/* The view's picture of the scene as it is, and the one that was kept of a view to which nothing was refused; NULL:
 * none was kept, and another view makes it. */
static void expect_same_picture(const char *name, noc_device *device, noc_scene *scene, noc_view *v,
                                const noc_render_params *p, const noc_image *kept) {
    noc_view *other = kept ? NULL : noc_view_create(device, scene);
    noc_image *a = picture_of(v, p), *b = other ? picture_of(other, p) : NULL;
    if (memcmp(a->rgb, kept ? kept->rgb : b->rgb, 3 * sizeof(float) * (size_t)p->width * (size_t)p->height) != 0)
        fail_msg("%s, %s refused as number %ld: another picture than without", name, fault.refused, fault.refuse_from);
    noc_image_destroy(a);
    noc_image_destroy(b);
    noc_view_destroy(other);
}

/* ---- trials ---- */

typedef struct trial {
    const char *name;
    noc_render_params first, then; /* `first` is not refused; without a size there is no such frame */
    void (*edit)(noc_scene *scene, int car, long number);
    bool floor, panes;
    int step; /* from one number to the next that is refused; 0: 1 */
} trial;

/* The view, made while nothing is refused, where the trial has a first frame. */
static noc_view *begin(const trial *t, noc_device *device, noc_scene *scene) {
    if (!t->first.width)
        return NULL;
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    assert_int_equal(noc_view_render(v, &camera, &t->first, NULL), NOC_OK);
    return v;
}

static noc_status go_on(const trial *t, noc_device *device, noc_scene *scene, noc_view **v) {
    noc_trace_floor floor;
    if (!*v && !(*v = noc_view_create(device, scene)))
        return NOC_ERR_MEMORY;
    noc_status status = t->floor ? noc_view_trace_floor(*v, &camera, &t->then, NULL, &floor)
                                 : noc_view_render(*v, &camera, &t->then, NULL);
    if (status == NOC_OK)
        status = noc_view_render(*v, &camera, &t->then, NULL);
    noc_image *image = status == NOC_OK ? noc_view_image(*v) : NULL;
    noc_image_destroy(image);
    return status == NOC_OK && !image ? noc_log_last_status(messages) : status;
}

/* Returns false if nothing was refused: the trial has come to its end. */
static bool refuse_one(const trial *t, noc_device *device, noc_scene *scene, int car, const noc_image *kept,
                       long number) {
    noc_view *v = begin(t, device, scene);
    if (t->edit) {
        t->edit(scene, car, number);
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
    }
    fault_none();
    fault.refuse_from = number;
    noc_status status = go_on(t, device, scene, &v);
    fault.refuse_from = LONG_MAX;
    bool refused = fault.refused;
    if (refused) {
        fault.refuse_from = number;
        expect_refusal(t->name, status);
        fault.refuse_from = LONG_MAX;
    } else {
        assert_int_equal(status, NOC_OK);
    }
    if (!v)
        v = noc_view_create(device, scene);
    assert_non_null(v);
    expect_same_picture(t->name, device, scene, v, &t->then, kept);
    noc_view_destroy(v);
    expect_silence(t->name);
    return refused;
}

/* A picture of a device of its own. */
static noc_image *picture_without(const trial *t, noc_scene *scene) {
    noc_device *device = open_vulkan();
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    noc_image *image = picture_of(v, &t->then);
    noc_view_destroy(v);
    noc_device_destroy(device);
    return image;
}

static void run_trial(const trial *t) {
    const int step = NOC_MAX(t->step, 1) * (SANITIZED ? 5 : 1);
    int car;
    noc_scene *scene = all_kinds_with(t->panes, &car);
    fault_none();
    noc_image *kept = t->edit ? NULL : picture_without(t, scene);
    noc_device *device = open_vulkan();
    assert_non_null(device);
    long objects = fault.objects, memory = fault.memory, number = 1;
    for (; refuse_one(t, device, scene, car, kept, number); number += step)
        if (fault.objects != objects || fault.memory != memory)
            fail_msg("%s, %s is refused as number %ld: %ld objects and %ld allocations are left", t->name,
                     fault.refused, number, fault.objects - objects, fault.memory - memory);
    print_message("# %s: refused up to number %ld\n", t->name, number - step);
    assert_true(number > step);
    noc_device_destroy(device);
    noc_image_destroy(kept);
    noc_scene_destroy(scene);
    expect_nothing_left(t->name);
}

static void devices_are_refused(void **state) {
    noc_device *device = NULL;
    long number = 1;
    (void)state;
    if (!has_vulkan())
        skip();
    for (; !device; number++) {
        fault_none();
        fault.refuse_from = number;
        device = open_vulkan();
        if (!device)
            expect_refusal("a device", noc_log_last_status(messages));
        if (!device)
            expect_nothing_left("a device");
    }
    print_message("# a device: %ld refusals\n", number - 2);
    assert_true(number > 2);
    noc_device_destroy(device);
    expect_nothing_left("a device");
    expect_silence("a device");
}

static void frames_are_refused(void **state) {
    trial trials[] = {
        { .name = "restir", .then = small_params(NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER) },
        { .name = "lists", .then = small_params(NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS), .step = 3 },
        { .name = "a tree", .then = small_params(NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH), .step = 7 },
        { .name = "views", .then = small_params(NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM), .step = 3 },
        { .name = "panes", .then = small_params(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM), .panes = true, .step = 2 },
    };
    (void)state;
    if (!has_vulkan())
        skip();
    trials[3].then.aovs = ((1u << NOC_AOV_COUNT) - 1) & ~(AOV(LIGHTS) | AOV(EXPECTED));
    for (size_t i = 0; i < NOC_COUNT(trials); i++)
        run_trial(&trials[i]);
}

static void other_sizes_are_refused(void **state) {
    trial t = { .name = "a larger picture", .then = small_params(NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS) };
    (void)state;
    if (!has_vulkan())
        skip();
    t.first = t.then;
    t.then.width = 40;
    run_trial(&t);
}

/* A model that moves, another one, a mesh, a material and a light: every array grows. */
static void edit_all(noc_scene *scene, int car, long number) {
    noc_instance in = { 1, { 1.5, 0, 0, -4, 0, 1.5, 0, -4 + 0.1 * (double)(number % 7), 0, 0, 1.5, 0 } };
    noc_light l = crowd_light((int)(70 + number % 7), -3);
    int model = noc_scene_add_model(scene, "sign");
    noc_instance sign = { model, { 1, 0, 0, -6 + 0.1 * (double)number, 0, 1, 0, -3, 0, 0, 1, 0 } };
    assert_int_equal(noc_scene_set_transform(scene, car, in.transform), NOC_OK);
    add_board(scene, 0, model, 0.3, false);
    add_board(scene, 0, 0, 1 + 0.05 * (double)number, false);
    assert_true(noc_scene_add_light(scene, &l) >= 0 && noc_scene_add_instance(scene, &sign) >= 0);
}

static void edits_are_refused(void **state) {
    trial t = { .name = "edits", .then = small_params(NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM), .edit = edit_all };
    (void)state;
    if (!has_vulkan())
        skip();
    t.first = t.then;
    run_trial(&t);
}

static void the_trace_floor_is_refused(void **state) {
    trial t = { .name = "the trace floor",
                .then = small_params(NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM),
                .floor = true };
    (void)state;
    if (!has_vulkan())
        skip();
    t.first = t.then;
    run_trial(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(devices_are_refused),        cmocka_unit_test(frames_are_refused),
        cmocka_unit_test(other_sizes_are_refused),    cmocka_unit_test(edits_are_refused),
        cmocka_unit_test(the_trace_floor_is_refused),
    };
    messages = open_messages();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
