/* Backends, their devices, and which one is meant. */
#include "../test.h"
#include "render/backend.h"

#include <nocturne/option.h>

/* A machine of the thesis's kind, an old one beside it, and the driver that runs on the processor. */
static const noc_device_info list[] = {
    { NOC_BACKEND_VULKAN, 0, NOC_DEVICE_INTEGRATED, "Intel(R) UHD Graphics 630", "Mesa 25.0.7", false,
      "it lacks VK_KHR_ray_tracing_pipeline" },
    { NOC_BACKEND_VULKAN, 1, NOC_DEVICE_SOFTWARE, "llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa 25.0.7", true, "" },
    { NOC_BACKEND_VULKAN, 2, NOC_DEVICE_INTEGRATED, "Intel(R) Arc(tm) Graphics (MTL)", "Mesa 25.0.7", true, "" },
    { NOC_BACKEND_VULKAN, 3, NOC_DEVICE_DISCRETE, "NVIDIA GeForce RTX 3060", "NVIDIA 550.54", true, "" },
    { NOC_BACKEND_VULKAN, 4, NOC_DEVICE_DISCRETE, "NVIDIA GeForce GTX 1080", "NVIDIA 550.54", false,
      "it lacks VK_KHR_ray_tracing_pipeline" },
};

static void ignore(void *user, noc_log_level level, const char *text) { (void)user, (void)level, (void)text; }

/* The number of the device chosen of the first `count`, or -1 and what was reported. */
static int choose(size_t first, size_t count, const char *wanted, noc_status expected, char message[700]) {
    noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
    noc_device_info info = { .number = -1 };
    noc_status status = noc_choose_device(list + first, count, wanted, &info, log);
    assert_int_equal(status, expected);
    snprintf(message, 700, "%s", noc_log_last_error(log));
    noc_log_destroy(log);
    return info.number;
}

static void the_best_device_is_taken(void **state) {
    (void)state;
    char m[700];
    assert_int_equal(choose(0, 5, NULL, NOC_OK, m), 3);
    assert_int_equal(choose(0, 3, NULL, NOC_OK, m), 2);
    assert_int_equal(choose(0, 2, NULL, NOC_OK, m), 1);
    assert_int_equal(choose(0, 1, NULL, NOC_ERR_UNSUPPORTED, m), -1);
    assert_string_equal(m, "vulkan: no usable device: 0 Intel(R) UHD Graphics 630 (it lacks "
                           "VK_KHR_ray_tracing_pipeline)");
}

static void a_device_is_named(void **state) {
    (void)state;
    char m[700];
    assert_int_equal(choose(0, 5, "LLVM", NOC_OK, m), 1);
    assert_int_equal(choose(0, 5, "arc", NOC_OK, m), 2);
    assert_int_equal(choose(0, 5, "intel", NOC_OK, m), 2); /* not the one that is not usable */
    assert_int_equal(choose(0, 5, "1", NOC_OK, m), 1);     /* a number, though names hold it, too */
    assert_int_equal(choose(0, 5, "nvidia", NOC_OK, m), 3);
    assert_int_equal(choose(0, 5, "3060", NOC_OK, m), 3);
    assert_int_equal(choose(0, 5, "256", NOC_ERR_ARGUMENT, m), -1); /* bits of a driver */
    assert_int_equal(choose(0, 5, "256 bits", NOC_OK, m), 1);
    assert_int_equal(choose(0, 5, "1080", NOC_ERR_UNSUPPORTED, m), -1);
    assert_int_equal(choose(0, 5, "15", NOC_ERR_ARGUMENT, m), -1); /* a number that no device has, though LLVM 15 */
    assert_int_equal(choose(0, 5, "GTX 1080", NOC_ERR_UNSUPPORTED, m), -1);
    assert_string_equal(m, "vulkan: NVIDIA GeForce GTX 1080 is not usable: it lacks VK_KHR_ray_tracing_pipeline");
    assert_int_equal(choose(0, 5, "0", NOC_ERR_UNSUPPORTED, m), -1);
    assert_int_equal(choose(1, 1, "radeon", NOC_ERR_ARGUMENT, m), -1);
    assert_string_equal(
        m, "device: \"radeon\" is neither number nor part of a name; devices: 1 llvmpipe (LLVM 15.0.6, 256 "
           "bits)");
    assert_int_equal(choose(0, 5, "5", NOC_ERR_ARGUMENT, m), -1);
    assert_int_equal(choose(0, 5, "-1", NOC_ERR_ARGUMENT, m), -1);
    assert_int_equal(choose(0, 5, " ", NOC_ERR_ARGUMENT, m), -1); /* a part of nearly any name */
    assert_int_equal(choose(0, 5, "", NOC_ERR_ARGUMENT, m), -1);
    assert_string_equal(m, "device: is empty; pass a number or a part of a name");
}

static void a_name_of_several_is_refused(void **state) {
    (void)state;
    char m[700];
    assert_int_equal(choose(0, 5, "a", NOC_ERR_ARGUMENT, m), -1);
    assert_int_equal(choose(1, 3, "tm", NOC_OK, m), 2);
    assert_int_equal(choose(1, 3, "e", NOC_ERR_ARGUMENT, m), -1);
    assert_string_equal(m, "device: \"e\" is in several names, pass a number: 1 llvmpipe (LLVM 15.0.6, 256 bits), 2 "
                           "Intel(R) Arc(tm) Graphics (MTL), 3 NVIDIA GeForce RTX 3060");
    const noc_device_info twins[] = {
        { NOC_BACKEND_VULKAN, 0, NOC_DEVICE_DISCRETE, "NVIDIA L4", "NVIDIA 550.54", true, "" },
        { NOC_BACKEND_VULKAN, 1, NOC_DEVICE_DISCRETE, "NVIDIA L40", "NVIDIA 550.54", true, "" },
        { NOC_BACKEND_VULKAN, 2, NOC_DEVICE_DISCRETE, "NVIDIA L40", "NVIDIA 550.54", true, "" },
    };
    noc_device_info info;
    assert_int_equal(noc_choose_device(twins, 3, "nvidia l4", &info, NULL), NOC_OK); /* a whole name, though a part */
    assert_int_equal(info.number, 0);
    assert_int_equal(noc_choose_device(twins, 3, "L40", &info, NULL), NOC_ERR_ARGUMENT);
    assert_int_equal(noc_choose_device(twins, 3, "2", &info, NULL), NOC_OK);
    assert_int_equal(info.number, 2);
}

/* A driver that runs on the processor is no reason to leave Embree. */
static void auto_wants_a_gpu(void **state) {
    (void)state;
    assert_ptr_equal(noc_best_gpu(list, 5), &list[3]);
    assert_ptr_equal(noc_best_gpu(list, 3), &list[2]);
    assert_null(noc_best_gpu(list, 2));
    assert_null(noc_best_gpu(list, 1));
}

static void a_backend_without_devices_says_why(void **state) {
    (void)state;
    noc_device_info none = { NOC_BACKEND_VULKAN, -1, NOC_DEVICE_PROCESSOR, "", "", false, "there is no loader" }, info;
    noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
    assert_int_equal(noc_choose_device(&none, 1, NULL, &info, log), NOC_ERR_UNSUPPORTED);
    assert_string_equal(noc_log_last_error(log), "vulkan: there is no loader");
    assert_int_equal(noc_choose_device(&none, 1, "nvidia", &info, log), NOC_ERR_UNSUPPORTED);
    assert_null(noc_best_gpu(&none, 1));
    noc_log_destroy(log);
}

/* Of this machine, whatever it has. */
static void devices_are_listed(void **state) {
    (void)state;
    noc_device_info all[64], first;
    size_t count = noc_devices(all, 64);
    assert_true(count >= 2 && count <= 64);
    assert_int_equal(noc_devices(NULL, 0), count);
    assert_int_equal(noc_devices(&first, 1), count);
    assert_string_equal(first.name, all[0].name);
    assert_int_equal(all[0].backend, NOC_BACKEND_EMBREE);
    assert_int_equal(all[0].kind, NOC_DEVICE_PROCESSOR);
    for (size_t i = 0; i < count; i++) {
        const noc_device_info *d = &all[i];
        assert_int_equal(d->backend, i ? NOC_BACKEND_VULKAN : NOC_BACKEND_EMBREE);
        assert_true(d->number == (i ? (int)i - 1 : 0) || (i == 1 && count == 2 && d->number == -1));
        assert_int_equal(d->usable, !*d->why);
        assert_int_equal(d->number < 0, !*d->name);
        assert_true(d->number >= 0 || !d->usable);
    }
}

static void the_device_is_the_one_found(void **state) {
    (void)state;
    noc_log *log = noc_log_create(&(noc_log_params){ .message = ignore });
    noc_device_info info;
    assert_int_equal(noc_device_find(NULL, &info, log), NOC_OK);
    assert_int_equal(info.backend, NOC_BACKEND_EMBREE); /* the library's default */
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 1 }, log);
    assert_non_null(device);
    assert_string_equal(noc_device_get_info(device)->name, info.name);
    assert_int_equal(noc_device_get_info(device)->kind, NOC_DEVICE_PROCESSOR);
    noc_device_destroy(device);
    assert_null(noc_device_get_info(NULL));
    assert_int_equal(noc_device_find(&(noc_device_params){ .device = "nvidia" }, &info, log), NOC_ERR_ARGUMENT);
    assert_non_null(strstr(noc_log_last_error(log), "\"nvidia\" is for vulkan"));
    assert_null(noc_device_create(&(noc_device_params){ .threads = -1 }, log));
    assert_non_null(strstr(noc_log_last_error(log), "device: threads is -1, must be in 0..1024"));
    noc_log_destroy(log);
}

static void names_are_those_of_options(void **state) {
    (void)state;
    char names[64] = "";
    const noc_option *o = noc_device_options();
    while (strcmp(o->name, "backend"))
        o++;
    for (int id = 0; id < NOC_BACKEND_COUNT; id++)
        snprintf(names + strlen(names), sizeof(names) - strlen(names), "%s%s", id ? "|" : "",
                 noc_backend_name((noc_backend_id)id));
    assert_string_equal(names, o->choices);
    assert_string_equal(noc_backend_name((noc_backend_id)-1), "unknown");
    assert_string_equal(noc_device_kind_name(NOC_DEVICE_DISCRETE), "discrete");
    assert_string_equal(noc_device_kind_name(NOC_DEVICE_KIND_COUNT), "unknown");
    noc_device_params params = noc_device_default_params();
    assert_int_equal(noc_option_set(o, &params, "cpu", NULL), NOC_OK);
    assert_int_equal(params.backend, NOC_BACKEND_EMBREE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_best_device_is_taken),           cmocka_unit_test(a_device_is_named),
        cmocka_unit_test(a_name_of_several_is_refused),       cmocka_unit_test(auto_wants_a_gpu),
        cmocka_unit_test(a_backend_without_devices_says_why), cmocka_unit_test(devices_are_listed),
        cmocka_unit_test(the_device_is_the_one_found),        cmocka_unit_test(names_are_those_of_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
