/* The Khronos validation layer beside frames of every kind: it is silent, and a planted error is heard. */
#include "all_kinds.h"
#include "vulkan_fault.h"

#include "render/device.h"

static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

/* A device with the layer; NULL after saying why there is none. */
static noc_device *open_validated(void) {
    noc_device *device = has_vulkan() ? open_vulkan() : NULL;
    if (device && !*told)
        return device;
    if (device)
        print_message("# skipped: %s", told);
    noc_device_destroy(device);
    *told = 0;
    return NULL;
}

static void a_planted_error_is_heard(void **state) {
    noc_device *device = open_validated();
    VkBufferCreateInfo info = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = 0, /* what no buffer may have */
                                .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT };
    VkBuffer buffer = VK_NULL_HANDLE;
    (void)state;
    if (!device)
        skip();
    VkDevice d = ((vk_device *)device->state)->device;
    for (int again = 0; again < 2; again++) { /* the messenger lives as long as the device */
        if (vkCreateBuffer(d, &info, NULL, &buffer) == VK_SUCCESS)
            vkDestroyBuffer(d, buffer, NULL);
        EXPECT_TOLD("a buffer of no bytes", "vulkan: validation: ", "VUID-VkBufferCreateInfo-size-00912");
    }
    noc_device_destroy(device);
    expect_silence("the device goes");
}

static bool cancel(void *user, const char *what, double done) {
    (void)user, (void)what, (void)done;
    return false;
}

static void render_two(noc_view *v, const noc_render_params *p, const char *name) {
    for (int f = 0; f < 2; f++)
        assert_int_equal(noc_view_render(v, &camera, p, NULL), NOC_OK);
    noc_image *image = noc_view_image(v);
    assert_non_null(image);
    noc_image_destroy(image);
    expect_silence(name);
}

static void move_and_add(noc_scene *scene, int car) {
    noc_instance in = { 1, { 1.5, 0, 0, -4, 0, 1.5, 0, -3, 0, 0, 1.5, 0 } };
    noc_light l = crowd_light(70, -3);
    assert_int_equal(noc_scene_set_transform(scene, car, in.transform), NOC_OK);
    add_board(scene, 0, 0, 1, false);
    assert_true(noc_scene_add_light(scene, &l) >= 0);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
}

static void frames_are_valid(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        noc_candidates candidates;
        bool views, map, panes;
    } plans[] = { { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, false, false, false },
                  { "restir", NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER, false, false, false },
                  { "a tree, a map", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, false, true, false },
                  { "lists", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, false, false },
                  { "lists, views", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, true, false, false },
                  { "panes", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, false, true },
                  { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, false, false, false } };
    noc_device *device = open_validated();
    noc_trace_floor floor;
    int car;
    (void)state;
    if (!device)
        skip();
    for (size_t i = 0; i < NOC_COUNT(plans); i++) {
        noc_scene *scene = all_kinds_with(plans[i].panes, &car);
        noc_image *map = plans[i].map ? bright_map() : NULL;
        if (map)
            assert_int_equal(noc_scene_set_environment(scene, map), NOC_OK);
        noc_image_destroy(map);
        noc_view *v = noc_view_create(device, scene);
        assert_non_null(v);
        noc_render_params p = all_kinds_params(plans[i].method, plans[i].map);
        p.width = p.height = 24;
        p.candidates = plans[i].candidates;
        p.rays = 4;
        p.aovs = plans[i].views ? (1u << NOC_AOV_COUNT) - 1 : 0;
        render_two(v, &p, plans[i].name);
        assert_int_equal(noc_view_render(v, &camera, &p, &(noc_progress){ cancel, NULL }), NOC_ERR_CANCELLED);
        move_and_add(scene, car);
        p.width = 40;
        *told = 0; /* that it was cancelled */
        render_two(v, &p, plans[i].name);
        assert_int_equal(noc_view_trace_floor(v, &camera, &p, NULL, &floor), NOC_OK);
        noc_view_destroy(v);
        noc_scene_destroy(scene);
        expect_silence(plans[i].name);
    }
    noc_device_destroy(device);
    expect_silence("the device goes");
    expect_nothing_left("frames");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planted_error_is_heard),
        cmocka_unit_test(frames_are_valid),
    };
    setenv("NOCTURNE_VULKAN_VALIDATION", "1", 1);
    messages = open_messages();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
