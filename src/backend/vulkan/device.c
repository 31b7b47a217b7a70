/* The Vulkan device: which one is taken, what it must have, and what is reported where it lacks something. */
#include "backend/vulkan/vulkan.h"

#include <stdio.h>

#define LAYER "VK_LAYER_KHRONOS_validation"
enum { MOST_DEVICES = 16 };

/* What every device must have, by the names that error messages use. */
static const char *const extensions[] = {
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
};

/* ---- errors ---- */

static const char *result_text(VkResult result) {
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
    case VK_ERROR_DEVICE_LOST: return "the device was lost";
    case VK_ERROR_INITIALIZATION_FAILED: return "initialisation failed";
    case VK_ERROR_INCOMPATIBLE_DRIVER: return "no driver";
    case VK_ERROR_TOO_MANY_OBJECTS: return "too many allocations";
    case VK_ERROR_EXTENSION_NOT_PRESENT: return "an extension is missing";
    case VK_ERROR_FEATURE_NOT_PRESENT: return "a feature is missing";
    case VK_ERROR_LAYER_NOT_PRESENT: return "a layer is missing";
    default: return NULL;
    }
}

noc_status noc_vk_failed(vk_device *d, VkResult result, const char *what) {
    bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                  result == VK_ERROR_TOO_MANY_OBJECTS;
    noc_status status = memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    const char *text = result_text(result);
    if (d->lost)
        return status;
    d->lost = result == VK_ERROR_DEVICE_LOST;
    if (text)
        return noc_error(d->log, status, "vulkan: %s: %s (%s)", what, text, d->name);
    return noc_error(d->log, status, "vulkan: %s: error %d (%s)", what, (int)result, d->name);
}

/* ---- the instance ---- */

static bool has_layer(void) {
    VkLayerProperties layers[64];
    uint32_t count = NOC_COUNT(layers);
    VkResult result = vkEnumerateInstanceLayerProperties(&count, layers);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(layers[i].layerName, LAYER))
            return true;
    return false;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT type,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    vk_device *d = user;
    (void)severity;
    if (type & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT) /* others are the loader's remarks about drivers */
        noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: validation: %s", data->pMessage);
    return VK_FALSE;
}

/* Finds the Vulkan loader. */
static noc_status find_loader(vk_device *d) {
    if (volkInitialize() != VK_SUCCESS)
        return noc_error(d->log, NOC_ERR_UNSUPPORTED,
                         "vulkan: no Vulkan loader (libvulkan.so.1) on this machine: install libvulkan1");
    if (volkGetInstanceVersion() < VK_API_VERSION_1_2)
        return noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: the Vulkan loader is older than 1.2");
    return NOC_OK;
}

static noc_status make_instance(vk_device *d, bool validate) {
    const char *layers[] = { LAYER }, *names[] = { VK_EXT_DEBUG_UTILS_EXTENSION_NAME };
    VkDebugUtilsMessengerCreateInfoEXT messages = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = d,
    };
    VkApplicationInfo app = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                              .pApplicationName = "nocturne",
                              .apiVersion = VK_API_VERSION_1_2 };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validate ? &messages : NULL,
        .pApplicationInfo = &app,
        .enabledLayerCount = validate,
        .ppEnabledLayerNames = layers,
        .enabledExtensionCount = validate,
        .ppEnabledExtensionNames = names,
    };
    VkResult result = vkCreateInstance(&info, NULL, &d->instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: no Vulkan driver on this machine");
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "making an instance");
    volkLoadInstance(d->instance);
    if (validate && (result = vkCreateDebugUtilsMessengerEXT(d->instance, &messages, NULL, &d->messenger)))
        return noc_vk_failed(d, result, "listening to validation");
    return NOC_OK;
}

/* ---- which device ---- */

static bool has_extension(const VkExtensionProperties *have, uint32_t count, const char *name) {
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(have[i].extensionName, name))
            return true;
    return false;
}

/* Returns the first of `extensions` that the device lacks, NULL: it has all. */
static const char *missing_extension(VkPhysicalDevice physical) {
    uint32_t count = 0;
    const char *missing = NULL;
    VkExtensionProperties *have = NULL;
    if (vkEnumerateDeviceExtensionProperties(physical, NULL, &count, NULL) == VK_SUCCESS)
        have = noc_calloc(count + 1, sizeof(*have));
    if (!have || vkEnumerateDeviceExtensionProperties(physical, NULL, &count, have) != VK_SUCCESS)
        count = 0;
    for (size_t i = 0; i < NOC_COUNT(extensions) && !missing; i++)
        if (!have || !has_extension(have, count, extensions[i]))
            missing = extensions[i];
    free(have);
    return missing;
}

/* Returns the number of a queue family that computes, UINT32_MAX: none. */
static uint32_t compute_family(VkPhysicalDevice physical, uint32_t *bits) {
    VkQueueFamilyProperties families[16];
    uint32_t count = NOC_COUNT(families);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t i = 0; i < count; i++)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            *bits = families[i].timestampValidBits;
            return i;
        }
    return UINT32_MAX;
}

/* Features that are switched on; asked for first, to see whether they are there. */
typedef struct features {
    VkPhysicalDeviceRayTracingPipelineFeaturesKHR rays;
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structures;
    VkPhysicalDeviceVulkan12Features v12;
    VkPhysicalDeviceFeatures2 all;
} features;

static void chain(features *f) {
    *f = (features){ 0 };
    f->rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR;
    f->structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
    f->structures.pNext = &f->rays;
    f->v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    f->v12.pNext = &f->structures;
    f->all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    f->all.pNext = &f->v12;
}

/* Fills `why` with what the device lacks; "" if it can render. */
static void find_fault(VkPhysicalDevice physical, const VkPhysicalDeviceProperties *p, char why[128]) {
    uint32_t bits;
    features f;
    why[0] = 0;
    if (p->apiVersion < VK_API_VERSION_1_2) {
        noc_snprintf(why, 128, "its driver speaks Vulkan %u.%u, 1.2 is needed", VK_API_VERSION_MAJOR(p->apiVersion),
                     VK_API_VERSION_MINOR(p->apiVersion));
        return;
    }
    const char *missing = missing_extension(physical);
    if (missing) {
        noc_snprintf(why, 128, "its driver has no ray tracing (%s is missing)", missing);
        return;
    }
    chain(&f);
    vkGetPhysicalDeviceFeatures2(physical, &f.all);
    missing = !f.rays.rayTracingPipeline            ? "rayTracingPipeline"
              : !f.structures.accelerationStructure ? "accelerationStructure"
              : !f.v12.bufferDeviceAddress          ? "bufferDeviceAddress"
              : !f.v12.scalarBlockLayout            ? "scalarBlockLayout"
                                                    : NULL;
    if (missing)
        noc_snprintf(why, 128, "its driver lacks the feature %s", missing);
    else if (compute_family(physical, &bits) == UINT32_MAX)
        noc_snprintf(why, 128, "it has no queue that computes");
}

static int rank(VkPhysicalDeviceType type) {
    return type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU     ? 4
           : type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? 3
           : type == VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU    ? 2
           : type == VK_PHYSICAL_DEVICE_TYPE_CPU            ? 0
                                                            : 1;
}

/* Takes the best device that can render. */
static noc_status choose(vk_device *d) {
    VkPhysicalDevice all[MOST_DEVICES];
    uint32_t count = MOST_DEVICES;
    char why[128] = "", name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE] = "";
    int best = -1;
    VkResult result = vkEnumeratePhysicalDevices(d->instance, &count, all);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return noc_vk_failed(d, result, "listing devices");
    for (uint32_t i = 0; i < count; i++) {
        VkPhysicalDeviceProperties p;
        char fault[128];
        vkGetPhysicalDeviceProperties(all[i], &p);
        find_fault(all[i], &p, fault);
        if (fault[0]) {
            memcpy(why, fault, sizeof(why));
            memcpy(name, p.deviceName, sizeof(name));
        } else if (rank(p.deviceType) > best) {
            best = rank(p.deviceType);
            d->physical = all[i];
        }
    }
    if (best >= 0)
        return NOC_OK;
    if (!count)
        return noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: no Vulkan device on this machine");
    return noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: no device can trace rays: %s: %s", name, why);
}

static void describe(vk_device *d) {
    uint32_t bits = 0;
    d->rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
    d->structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR;
    d->structures.pNext = &d->rays;
    VkPhysicalDeviceProperties2 p = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                      .pNext = &d->structures };
    vkGetPhysicalDeviceProperties2(d->physical, &p);
    vkGetPhysicalDeviceMemoryProperties(d->physical, &d->memory);
    d->family = compute_family(d->physical, &bits);
    d->software = p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    d->tick = p.properties.limits.timestampPeriod * 1e-9;
    d->tick_mask = bits >= 64 ? UINT64_MAX : ((uint64_t)1 << bits) - 1;
    memcpy(d->name, p.properties.deviceName, sizeof(d->name));
    noc_snprintf(d->path, sizeof(d->path), "vulkan, %s", d->name);
}

static noc_status make_device(vk_device *d) {
    features f;
    float priority = 1;
    describe(d);
    chain(&f);
    f.rays.rayTracingPipeline = f.structures.accelerationStructure = VK_TRUE;
    f.v12.bufferDeviceAddress = f.v12.scalarBlockLayout = VK_TRUE;
    VkDeviceQueueCreateInfo queue = { .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = d->family,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority };
    VkDeviceCreateInfo info = { .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &f.all,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = NOC_COUNT(extensions),
                                .ppEnabledExtensionNames = extensions };
    VkResult result = vkCreateDevice(d->physical, &info, NULL, &d->device);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "opening the device");
    vkGetDeviceQueue(d->device, d->family, 0, &d->queue);
    VkCommandPoolCreateInfo pool = { .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = d->family };
    result = vkCreateCommandPool(d->device, &pool, NULL, &d->commands);
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(d, result, "making commands");
}

void noc_vk_device_destroy(void *device) {
    vk_device *d = device;
    if (!d)
        return;
    noc_vk_forget_host_device(d);
    if (d->device) {
        vkDeviceWaitIdle(d->device);
        noc_vk_pipelines_destroy(d);
        noc_vk_memory_destroy(d);
        vkDestroyCommandPool(d->device, d->commands, NULL);
        vkDestroyDevice(d->device, NULL);
    }
    if (d->messenger)
        vkDestroyDebugUtilsMessengerEXT(d->instance, d->messenger, NULL);
    if (d->instance)
        vkDestroyInstance(d->instance, NULL);
    noc_pool_destroy(d->pool);
    pthread_mutex_destroy(&d->lock);
    pthread_mutex_destroy(&d->host_lock);
    free(d);
}

noc_status noc_vk_device_create(const noc_device_params *params, noc_log *log, void **device) {
    vk_device *d = noc_calloc(1, sizeof(*d));
    if (!d)
        return noc_no_memory(log, "device");
    d->log = log;
    d->params = *params;
    pthread_mutex_init(&d->lock, NULL);
    pthread_mutex_init(&d->host_lock, NULL);
    noc_status status = (d->pool = noc_pool_create(params->threads)) ? NOC_OK : noc_no_memory(log, "device");
    if (status == NOC_OK)
        status = find_loader(d);
    if (status == NOC_OK)
        status = make_instance(d, getenv("NOCTURNE_VULKAN_VALIDATION") != NULL && has_layer());
    if (status == NOC_OK)
        status = choose(d);
    if (status == NOC_OK)
        status = make_device(d);
    if (status == NOC_OK)
        status = noc_vk_memory_create(d);
    if (status == NOC_OK)
        status = noc_vk_pipelines_create(d);
    if (status != NOC_OK) {
        noc_vk_device_destroy(d);
        return status;
    }
    *device = d;
    return NOC_OK;
}

const noc_backend noc_backend_vulkan = {
    .name = "vulkan",
    .device_create = noc_vk_device_create,
    .device_destroy = noc_vk_device_destroy,
    .world_create = noc_vk_world_create,
    .world_destroy = noc_vk_world_destroy,
    .view_create = noc_vk_view_create,
    .view_destroy = noc_vk_view_destroy,
    .bytes_a_pixel = noc_vk_bytes_a_pixel,
    .resize = noc_vk_view_resize,
    .stage = noc_vk_stage,
    .accumulate = noc_vk_accumulate,
    .read = noc_vk_read_picture,
    .aov = noc_vk_read_aov,
    .rows = noc_vk_rows,
    .run = noc_vk_run,
    .stats = noc_vk_stats,
    .light_stats = noc_vk_light_stats,
    .influence = noc_vk_influence,
    .cast = noc_vk_cast,
    .ask = noc_vk_ask,
    .clear = noc_vk_clear,
    .record = noc_vk_record,
    .replay = noc_vk_replay,
};
