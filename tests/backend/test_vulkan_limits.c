/* Vulkan devices that cannot render, and say why; memory that a picture does not fit into; more models than a driver
 * allows allocations. The driver's answers are changed on their way. */
#include "../render/rooms.h"
#include "render/device.h"
#include "vulkan_fault.h"

#include <nocturne/nocturne.h>

#include <sys/stat.h>
#include <unistd.h>

static const noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };

/* What the driver says otherwise; 0, NULL: nothing of that kind. */
static struct {
    uint32_t version;
    const char *without; /* extension */
    size_t feature;      /* 1 + offset in vk_features of one that is off */
    VkDriverId driver;
    const char *driver_version;
    bool no_compute, no_device;
    VkResult opening;
    VkDeviceSize heap, budget, used, piece, buffer; /* bytes */
    size_t cache;                                   /* bytes of compiled shaders */
} fake;

static PFN_vkEnumeratePhysicalDevices driver_vkEnumeratePhysicalDevices;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkEnumeratePhysicalDevices(VkInstance i, uint32_t *n,
                                                                       VkPhysicalDevice *all) {
    VkResult result = driver_vkEnumeratePhysicalDevices(i, n, all);
    *n = fake.no_device ? 0 : *n;
    return result;
}

static PFN_vkGetPhysicalDeviceProperties driver_vkGetPhysicalDeviceProperties;
static VKAPI_ATTR void VKAPI_CALL fault_vkGetPhysicalDeviceProperties(VkPhysicalDevice d,
                                                                      VkPhysicalDeviceProperties *p) {
    driver_vkGetPhysicalDeviceProperties(d, p);
    p->apiVersion = fake.version ? fake.version : p->apiVersion;
}

static PFN_vkGetPhysicalDeviceProperties2 driver_vkGetPhysicalDeviceProperties2;
static VKAPI_ATTR void VKAPI_CALL fault_vkGetPhysicalDeviceProperties2(VkPhysicalDevice d,
                                                                       VkPhysicalDeviceProperties2 *p) {
    driver_vkGetPhysicalDeviceProperties2(d, p);
    for (VkBaseOutStructure *s = p->pNext; s; s = s->pNext) {
        VkPhysicalDeviceDriverProperties *driver = (void *)s;
        VkPhysicalDeviceMaintenance3Properties *pieces = (void *)s;
        VkPhysicalDeviceMaintenance4Properties *buffers = (void *)s;
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES && fake.driver_version) {
            driver->driverID = fake.driver;
            snprintf(driver->driverInfo, sizeof(driver->driverInfo), "%s", fake.driver_version);
        }
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES && fake.piece)
            pieces->maxMemoryAllocationSize = fake.piece;
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES && fake.buffer)
            buffers->maxBufferSize = fake.buffer;
    }
}

static PFN_vkEnumerateDeviceExtensionProperties driver_vkEnumerateDeviceExtensionProperties;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkEnumerateDeviceExtensionProperties(VkPhysicalDevice d, const char *layer,
                                                                                 uint32_t *n,
                                                                                 VkExtensionProperties *all) {
    VkResult result = driver_vkEnumerateDeviceExtensionProperties(d, layer, n, all);
    for (uint32_t i = 0; all && fake.without && i < *n; i++)
        if (!strcmp(all[i].extensionName, fake.without))
            all[i].extensionName[0] = '-';
    return result;
}

static PFN_vkGetPhysicalDeviceFeatures2 driver_vkGetPhysicalDeviceFeatures2;
static VKAPI_ATTR void VKAPI_CALL fault_vkGetPhysicalDeviceFeatures2(VkPhysicalDevice d, VkPhysicalDeviceFeatures2 *f) {
    driver_vkGetPhysicalDeviceFeatures2(d, f);
    if (fake.feature)
        *(VkBool32 *)(void *)((char *)f - offsetof(vk_features, all) + fake.feature - 1) = VK_FALSE;
}

static PFN_vkGetPhysicalDeviceQueueFamilyProperties driver_vkGetPhysicalDeviceQueueFamilyProperties;
static VKAPI_ATTR void VKAPI_CALL fault_vkGetPhysicalDeviceQueueFamilyProperties(VkPhysicalDevice d, uint32_t *n,
                                                                                 VkQueueFamilyProperties *all) {
    driver_vkGetPhysicalDeviceQueueFamilyProperties(d, n, all);
    for (uint32_t i = 0; all && fake.no_compute && i < *n; i++)
        all[i].queueFlags = VK_QUEUE_TRANSFER_BIT;
}

static PFN_vkCreateDevice driver_vkCreateDevice;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkCreateDevice(VkPhysicalDevice d, const VkDeviceCreateInfo *info,
                                                           const VkAllocationCallbacks *a, VkDevice *out) {
    return fake.opening != VK_SUCCESS ? fake.opening : driver_vkCreateDevice(d, info, a, out);
}

static PFN_vkGetPhysicalDeviceMemoryProperties2 driver_vkGetPhysicalDeviceMemoryProperties2;
static VKAPI_ATTR void VKAPI_CALL fault_vkGetPhysicalDeviceMemoryProperties2(VkPhysicalDevice d,
                                                                             VkPhysicalDeviceMemoryProperties2 *m) {
    VkPhysicalDeviceMemoryBudgetPropertiesEXT *budget = m->pNext;
    driver_vkGetPhysicalDeviceMemoryProperties2(d, m);
    for (uint32_t i = 0; fake.heap && i < m->memoryProperties.memoryHeapCount; i++) {
        m->memoryProperties.memoryHeaps[i].size = fake.heap;
        if (budget) {
            budget->heapBudget[i] = fake.budget;
            budget->heapUsage[i] = fake.used;
        }
    }
}

static int caches_taken;
static PFN_vkGetPipelineCacheData driver_vkGetPipelineCacheData;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkGetPipelineCacheData(VkDevice d, VkPipelineCache c, size_t *n,
                                                                   void *data) {
    caches_taken += data != NULL;
    if (!fake.cache)
        return driver_vkGetPipelineCacheData(d, c, n, data);
    *n = fake.cache;
    if (data)
        memset(data, 1, *n);
    return VK_SUCCESS;
}

static void replace_more(void) {
    REPLACE(vkGetPipelineCacheData);
    REPLACE(vkEnumeratePhysicalDevices);
    REPLACE(vkGetPhysicalDeviceProperties);
    REPLACE(vkGetPhysicalDeviceProperties2);
    REPLACE(vkEnumerateDeviceExtensionProperties);
    REPLACE(vkGetPhysicalDeviceFeatures2);
    REPLACE(vkGetPhysicalDeviceQueueFamilyProperties);
    REPLACE(vkCreateDevice);
    REPLACE(vkGetPhysicalDeviceMemoryProperties2);
}

static void as_it_is(void) { memset(&fake, 0, sizeof(fake)); }

static int start(void **state) {
    (void)state;
    as_it_is();
    fault_none();
    *told = 0;
    return 0;
}

/* ---- devices that cannot render ---- */

/* The list has the device with this reason, and to open it by its name says so in one line. */
static void expect_unusable(const char *why) {
    noc_device_info list[8];
    size_t count = noc_devices(list, NOC_COUNT(list)), found = 0;
    for (size_t i = 0; i < NOC_MIN(count, NOC_COUNT(list)); i++)
        if (list[i].backend == NOC_BACKEND_VULKAN) {
            found++;
            if (list[i].usable || !strstr(list[i].why, why))
                fail_msg("%s: usable %d, why \"%s\" has not \"%s\"", list[i].name, list[i].usable, list[i].why, why);
        }
    assert_true(found > 0);
    assert_null(open_vulkan());
    EXPECT_TOLD(why, "vulkan: ", why);
    assert_null(noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN, .device = "0" }, messages));
    if (fake.no_device)
        EXPECT_TOLD(why, "vulkan: ", why);
    else
        EXPECT_TOLD(why, "vulkan: ", " is not usable: ", why);
}

static void devices_say_what_they_lack(void **state) {
    static const struct {
        size_t at;
        const char *name;
    } features[] = { { offsetof(vk_features, rays.rayTracingPipeline), "rayTracingPipeline" },
                     { offsetof(vk_features, structures.accelerationStructure), "accelerationStructure" },
                     { offsetof(vk_features, v12.bufferDeviceAddress), "bufferDeviceAddress" },
                     { offsetof(vk_features, v12.scalarBlockLayout), "scalarBlockLayout" } };
    char why[120];
    (void)state;
    if (!has_vulkan())
        skip();
    for (size_t i = 0; i < VK_EXTENSIONS; i++) {
        fake.without = noc_vk_extensions[i];
        snprintf(why, sizeof(why), "no ray tracing: %s is missing (an older GPU, or an older driver)", fake.without);
        expect_unusable(why);
    }
    as_it_is();
    for (size_t i = 0; i < NOC_COUNT(features); i++) {
        fake.feature = 1 + features[i].at;
        snprintf(why, sizeof(why), "its driver lacks the feature %s", features[i].name);
        expect_unusable(why);
    }
    as_it_is();
    fake.version = VK_API_VERSION_1_1;
    expect_unusable("its driver has Vulkan 1.1, 1.2 is needed");
    as_it_is();
    fake.driver = VK_DRIVER_ID_MESA_LLVMPIPE;
    fake.driver_version = "Mesa 24.3.1 (LLVM 15.0.6)";
    expect_unusable("its driver is too old to trace rays: Mesa 25 or later is needed");
    as_it_is();
    fake.no_compute = true;
    expect_unusable("it has no queue that computes");
    as_it_is();
    fake.no_device = true;
    expect_unusable("no Vulkan device on this machine");
}

/* Of Mesa 24 with another driver than llvmpipe, nothing is said. */
static void other_drivers_have_other_versions(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    fake.driver = VK_DRIVER_ID_MESA_RADV;
    fake.driver_version = "Mesa 24.3.1";
    noc_device *device = open_vulkan();
    assert_non_null(device);
    expect_silence("RADV");
    noc_device_destroy(device);
}

static void devices_that_do_not_open(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    fake.opening = VK_ERROR_INITIALIZATION_FAILED;
    assert_null(open_vulkan());
    assert_int_equal(noc_log_last_status(messages), NOC_ERR_UNSUPPORTED);
    EXPECT_TOLD("opening", "vulkan: opening the device: initialisation failed (");
    fake.opening = VK_ERROR_TOO_MANY_OBJECTS;
    assert_null(open_vulkan());
    assert_int_equal(noc_log_last_status(messages), NOC_ERR_MEMORY);
    EXPECT_TOLD("opening", "vulkan: opening the device: too many allocations (");
    expect_nothing_left("devices that do not open");
}

/* ---- memory ---- */

static noc_scene *a_floor(void) {
    noc_scene *s = noc_scene_create(messages);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 10);
    point_light(s, 0, 0, 5, 100);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* A square picture is refused with these words, and one of the size that they name is rendered afterwards. */
static void expect_no_room(int side, const char *what, const char *needs, const char *has) {
    noc_scene *scene = a_floor();
    noc_render_params p = noc_render_default_params();
    noc_device *device = open_vulkan();
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    long before = fault.memory;
    p.method = NOC_METHOD_HEADLIGHT;
    p.width = p.height = side;
    assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_ERR_MEMORY);
    const char *fits = strstr(told, " would fit)");
    while (fits && *fits != '(')
        fits--;
    assert_true(fits && sscanf(fits, "(%d x %d would", &p.width, &p.height) == 2);
    if (strstr(told, "this machine has")) /* which is not the device that is limited here */
        p.width = p.height = 64;
    EXPECT_TOLD(what, what, needs, has);
    assert_int_equal(fault.memory, before);
    assert_in_range(p.width, 64, side - 1);
    assert_int_equal(p.height, p.width);
    p.width = NOC_MIN(p.width, 1200); /* where the machine has much, that takes long */
    p.height = NOC_MIN(p.height, 1200);
    assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_OK);
    noc_view_destroy(v);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    expect_silence(what);
    expect_nothing_left(what);
}

static void pictures_beyond_the_heap(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    fake.heap = (VkDeviceSize)200 << 20;
    fake.budget = (VkDeviceSize)150 << 20;
    fake.used = (VkDeviceSize)50 << 20;
    expect_no_room(1200, "vulkan: a picture of 1200 x 1200 (", " MB: out of device memory",
                   "105 MB of 210 MB are free (");
    expect_no_room(30000, "30000 x 30000 (", " GB", ""); /* where the machine has enough for its copy, as above */
    fake.without = VK_EXT_MEMORY_BUDGET_EXTENSION_NAME;  /* then all but what this device has taken counts as free */
    expect_no_room(1200, "vulkan: a picture of 1200 x 1200 (", " MB: out of device memory", " of 210 MB are free (");
}

static void buffers_beyond_what_is_given_at_once(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    fake.piece = (VkDeviceSize)64 << 20;
    expect_no_room(1600, "vulkan: a picture of 1600 x 1600 (", " MB: the device gives 67", " at once (");
    as_it_is();
    fake.buffer = (VkDeviceSize)64 << 20;
    expect_no_room(1600, "vulkan: a picture of 1600 x 1600 (", " MB: the device gives 67", " at once (");
}

/* What one row of tiles takes grows with the picture's width, and is not cut: a width that fits is named, and does. */
static void scratch_beyond_what_is_given_at_once(void **state) {
    int wide = 0;
    (void)state;
    if (!has_vulkan())
        skip();
    fake.buffer = (VkDeviceSize)64 << 20;
    noc_scene *scene = a_floor();
    noc_render_params p = noc_render_default_params();
    noc_device *device = open_vulkan();
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    ((vk_device *)device->state)->band_bytes = 1;
    p.method = NOC_METHOD_RIS;
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    p.draws = 1024;
    p.width = 320;
    p.height = 16;
    assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_ERR_MEMORY);
    const char *named = strstr(told, "one that is ");
    assert_true(named && sscanf(named, "one that is %d wide would fit (", &wide) == 1);
    EXPECT_TOLD("scratch", "vulkan: a picture of 320 x 16 with these options needs ", " at once, the device has 67");
    assert_in_range(wide, 160, 304);
    p.width = wide;
    assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_OK);
    noc_view_destroy(v);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    expect_silence("scratch");
    expect_nothing_left("scratch");
}

/* ---- many models ---- */

enum { MODELS = 600 };

/* A wall of small boards, each a model of its own. */
static noc_scene *many_models(void) {
    noc_scene *s = a_floor();
    for (int i = 0; i < MODELS; i++) {
        int model = noc_scene_add_model(s, "board"), m = matte(s, 0.2f + 0.001f * (float)i);
        const double xyz[] = { 0, 0, 0, 0.3, 0, 0, 0.3, 0, 0.1 + 0.0003 * i, 0, 0, 0.1 + 0.0003 * i };
        noc_mesh mesh = { .vertex_count = 4,
                          .positions = xyz,
                          .triangle_count = 2,
                          .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                          .material = m,
                          .model = model };
        noc_instance in = { model, { 1, 0, 0, -6 + 0.4 * (i % 30), 0, 1, 0, 0, 0, 0, 1, 0.35 * (i / 30) } };
        assert_true(noc_scene_add_mesh(s, &mesh) >= 0 && noc_scene_add_instance(s, &in) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

/* Depths of what both machines see of a scene. */
static double share_of_other_depths(noc_scene *scene, noc_device *device) {
    noc_render_params p = noc_render_default_params();
    noc_device *cpu = noc_device_create(NULL, messages);
    noc_view *views[2] = { noc_view_create(cpu, scene), noc_view_create(device, scene) };
    noc_channel *depth[2];
    size_t other = 0, n = 160 * 120;
    p.method = NOC_METHOD_HEADLIGHT;
    p.width = 160;
    p.height = 120;
    p.aovs = 1u << NOC_AOV_DEPTH;
    for (int i = 0; i < 2; i++) {
        assert_non_null(views[i]);
        assert_int_equal(noc_view_render(views[i], &camera, &p, NULL), NOC_OK);
        assert_non_null(depth[i] = noc_view_aov(views[i], NOC_AOV_DEPTH));
    }
    for (size_t i = 0; i < n; i++)
        other += fabs((double)depth[0]->value[i] - (double)depth[1]->value[i]) > 1e-3;
    for (int i = 0; i < 2; i++) {
        noc_channel_destroy(depth[i]);
        noc_view_destroy(views[i]);
    }
    noc_device_destroy(cpu);
    return (double)other / (double)n;
}

static void models_share_allocations(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    noc_scene *scene = many_models();
    noc_device *device = open_vulkan();
    assert_non_null(device);
    fault.most_memory = 0;
    double other = share_of_other_depths(scene, device);
    print_message("# %d models: %ld allocations at most; %.4f of the depths differ\n", MODELS, fault.most_memory,
                  other);
    assert_in_range(fault.most_memory, 10, 100);
    assert_true(other < 0.005);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
    expect_silence("models");
    expect_nothing_left("models");
}

/* ---- the file of compiled shaders ---- */

/* A pipe in its place is not waited for. */
static void a_pipe_in_place_of_the_cache(void **state) {
    char folder[] = "/tmp/noc-vulkan-cache-XXXXXX", path[200];
    const char *before = getenv("XDG_CACHE_HOME");
    char *kept = before ? noc_strdup(before) : NULL;
    VkPhysicalDeviceProperties p;
    (void)state;
    if (!has_vulkan())
        skip();
    assert_non_null(mkdtemp(folder));
    noc_device *device = open_vulkan();
    vkGetPhysicalDeviceProperties(((const vk_device *)device->state)->physical, &p);
    noc_device_destroy(device);
    setenv("XDG_CACHE_HOME", folder, 1);
    snprintf(path, sizeof(path), "%s/nocturne", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    size_t at = strlen(path);
    at += (size_t)snprintf(path + at, sizeof(path) - at, "/vulkan-");
    for (size_t i = 0; i < VK_UUID_SIZE; i++)
        at += (size_t)snprintf(path + at, sizeof(path) - at, "%02x", p.pipelineCacheUUID[i]);
    snprintf(path + at, sizeof(path) - at, ".bin");
    assert_int_equal(mkfifo(path, 0600), 0);
    alarm(300); /* as if it hung */
    assert_non_null(device = open_vulkan());
    alarm(0);
    noc_device_destroy(device);
    unlink(path);
    *strrchr(path, '/') = 0;
    rmdir(path);
    rmdir(folder);
    if (kept)
        setenv("XDG_CACHE_HOME", kept, 1);
    else
        unsetenv("XDG_CACHE_HOME");
    free(kept);
}

/* A cache of 1 GiB is not written, which no reader would take; a smaller one is. */
static void a_cache_beyond_what_is_read(void **state) {
    char folder[] = "/tmp/noc-vulkan-cache-XXXXXX";
    const char *before = getenv("XDG_CACHE_HOME");
    char *kept = before ? noc_strdup(before) : NULL;
    (void)state;
    if (!has_vulkan())
        skip();
    assert_non_null(mkdtemp(folder));
    setenv("XDG_CACHE_HOME", folder, 1);
    for (int small = 0; small < 2; small++) {
        noc_device *device = open_vulkan();
        assert_non_null(device);
        ((vk_device *)device->state)->compile_seconds = 1; /* there is something to keep */
        fake.cache = small ? 4096 : (size_t)1 << 30;
        caches_taken = 0;
        noc_device_destroy(device);
        assert_int_equal(caches_taken, small);
    }
    expect_silence("caches");
    char command[200];
    snprintf(command, sizeof(command), "rm %s/nocturne/vulkan-*.bin && rmdir %s/nocturne %s", folder, folder, folder);
    assert_int_equal(system(command), 0); /* one file, and nothing else */
    if (kept)
        setenv("XDG_CACHE_HOME", kept, 1);
    else
        unsetenv("XDG_CACHE_HOME");
    free(kept);
}

/* "0" turns validation off, and says nothing where the layer is not installed. */
static void validation_is_off(void **state) {
    (void)state;
    if (!has_vulkan())
        skip();
    setenv("NOCTURNE_VULKAN_VALIDATION", "0", 1);
    noc_device *device = open_vulkan();
    unsetenv("NOCTURNE_VULKAN_VALIDATION");
    assert_non_null(device);
    assert_true(((const vk_device *)device->state)->messenger == VK_NULL_HANDLE);
    noc_device_destroy(device);
    expect_silence("no validation");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(devices_say_what_they_lack, start),
        cmocka_unit_test_setup(other_drivers_have_other_versions, start),
        cmocka_unit_test_setup(devices_that_do_not_open, start),
        cmocka_unit_test_setup(pictures_beyond_the_heap, start),
        cmocka_unit_test_setup(buffers_beyond_what_is_given_at_once, start),
        cmocka_unit_test_setup(scratch_beyond_what_is_given_at_once, start),
        cmocka_unit_test_setup(models_share_allocations, start),
        cmocka_unit_test_setup(a_pipe_in_place_of_the_cache, start),
        cmocka_unit_test_setup(a_cache_beyond_what_is_read, start),
        cmocka_unit_test_setup(validation_is_off, start),
    };
    fault_more = replace_more;
    messages = open_messages();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
