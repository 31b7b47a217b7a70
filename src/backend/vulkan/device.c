/* The Vulkan device, and what is reported of it. */
#include "backend/vulkan/vulkan.h"

#include <stdio.h>

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
    const char *text = result_text(result);
    if (d->lost)
        return NOC_ERR_LOST;
    d->lost = result == VK_ERROR_DEVICE_LOST;
    noc_status status = d->lost ? NOC_ERR_LOST : memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    if (text)
        return noc_error(d->log, status, "vulkan: %s: %s (%s)", what, text, d->name);
    return noc_error(d->log, status, "vulkan: %s: error %d (%s)", what, (int)result, d->name);
}

noc_status noc_vk_enter(vk_device *d) {
    pthread_mutex_lock(&d->lock);
    if (!d->lost)
        return NOC_OK;
    pthread_mutex_unlock(&d->lock);
    return noc_error(d->log, NOC_ERR_LOST, "vulkan: the device was lost before, and renders no more (%s)", d->name);
}

/* ---- the instance ---- */

static bool has_layer(void) {
    VkLayerProperties layers[64];
    uint32_t count = NOC_COUNT(layers);
    VkResult result = vkEnumerateInstanceLayerProperties(&count, layers);
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(layers[i].layerName, VK_VALIDATION_LAYER))
            return true;
    return false;
}

static bool validates(noc_log *log) {
    const char *value = getenv("NOCTURNE_VULKAN_VALIDATION");
    bool asked = value && *value && strcmp(value, "0"), has = asked && has_layer();
    if (asked && !has)
        noc_warn(log, "vulkan: NOCTURNE_VULKAN_VALIDATION has no effect: no validation layer on this machine");
    return has;
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

static noc_status make_instance(vk_device *d, bool validate) {
    VkDebugUtilsMessengerCreateInfoEXT messages = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = d,
    };
    const char *why = noc_vk_make_instance(validate ? &messages : NULL, &d->instance);
    if (why)
        return noc_error(d->log, NOC_ERR_UNSUPPORTED, "vulkan: %s", why);
    VkResult result =
        validate ? vkCreateDebugUtilsMessengerEXT(d->instance, &messages, NULL, &d->messenger) : VK_SUCCESS;
    return result == VK_SUCCESS ? NOC_OK : noc_vk_failed(d, result, "listening to validation");
}

/* ---- the device ---- */

/* Returns true if quotients and roots are to be the device's, whether or not it rounds them as the CPU does. */
static bool asks_for_speed(noc_log *log) {
    const char *rounding = getenv("NOCTURNE_VULKAN_ROUNDING");
    if (!rounding || !strcmp(rounding, "ieee"))
        return false;
    if (!strcmp(rounding, "device"))
        return true;
    noc_warn(log, "NOCTURNE_VULKAN_ROUNDING: \"%s\" is neither ieee nor device; ieee is taken", rounding);
    return false;
}

static void describe(vk_device *d) {
    uint32_t bits = 0;
    VkPhysicalDeviceMaintenance3Properties pieces = { .sType =
                                                          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES };
    VkPhysicalDeviceMaintenance4Properties buffers = { .sType =
                                                           VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES,
                                                       .maxBufferSize = UINT64_MAX };
    VkPhysicalDeviceMemoryProperties2 memory = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2 };
    d->rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR;
    d->structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR;
    d->structures.pNext = &d->rays;
    d->rays.pNext = &pieces;
    if (noc_vk_has_extension(d->physical, VK_KHR_MAINTENANCE_4_EXTENSION_NAME))
        pieces.pNext = &buffers;
    VkPhysicalDeviceProperties2 p = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                      .pNext = &d->structures };
    vkGetPhysicalDeviceProperties2(d->physical, &p);
    d->structures.pNext = d->rays.pNext = NULL;
    d->largest = NOC_MIN(pieces.maxMemoryAllocationSize, buffers.maxBufferSize);
    d->budgeted = noc_vk_has_extension(d->physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    vkGetPhysicalDeviceMemoryProperties2(d->physical, &memory);
    d->memory = memory.memoryProperties;
    d->family = noc_vk_compute_family(d->physical, &bits);
    d->software = p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    d->constants.rounds = d->software || asks_for_speed(d->log);
    d->tick = p.properties.limits.timestampPeriod * 1e-9;
    d->tick_mask = bits >= 64 ? UINT64_MAX : ((uint64_t)1 << bits) - 1;
    memcpy(d->name, p.properties.deviceName, sizeof(d->name));
}

static noc_status make_device(vk_device *d) {
    vk_features f;
    float priority = 1;
    describe(d);
    noc_vk_chain_features(&f);
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
                                .enabledExtensionCount = VK_EXTENSIONS,
                                .ppEnabledExtensionNames = noc_vk_extensions };
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
        noc_vk_settle(d);
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

noc_status noc_vk_device_create(const noc_device_params *params, int number, noc_log *log, void **device) {
    vk_device *d = noc_calloc(1, sizeof(*d));
    if (!d)
        return noc_no_memory(log, "device");
    d->log = log;
    d->params = *params;
    d->constants = (vk_constants){ .list_workers = 256, .share_workers = 64 };
    d->band_bytes = (size_t)256 << 20;
    d->keep_seconds = 10;
    d->pool_most = UINT32_MAX;
    pthread_mutex_init(&d->lock, NULL);
    pthread_mutex_init(&d->host_lock, NULL);
    noc_status status = (d->pool = noc_pool_create(params->threads)) ? NOC_OK : noc_no_memory(log, "device");
    if (status == NOC_OK)
        status = make_instance(d, validates(log));
    if (status == NOC_OK && !(d->physical = noc_vk_physical_device(d->instance, number)))
        status = noc_error(log, NOC_ERR_UNSUPPORTED, "vulkan: device %d has gone", number);
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
    .devices = noc_vk_devices,
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
    .lost = noc_vk_lost,
    .rows = noc_vk_rows,
    .run = noc_vk_run,
    .stats = noc_vk_stats,
    .finish = noc_vk_finish,
    .light_stats = noc_vk_light_stats,
    .influence = noc_vk_influence,
    .cast = noc_vk_cast,
    .ask = noc_vk_ask,
    .clear = noc_vk_clear,
    .record = noc_vk_record,
    .replay = noc_vk_replay,
};
