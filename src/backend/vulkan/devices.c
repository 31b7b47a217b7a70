/* The Vulkan devices of this machine, and what those lack that cannot render. */
#include "backend/vulkan/vulkan.h"

#include <stdio.h>

enum { MOST_DEVICES = 16, OLDEST_LLVMPIPE = 25 };

const char *const noc_vk_extensions[VK_EXTENSIONS] = {
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
};

/* Of volk's functions, which are the process's, and of: */
static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;
static VkInstance kept; /* never destroyed: drivers stay loaded, and NVIDIA's fails to load after some sixty times */

static const char *load_instance(const VkInstanceCreateInfo *info, VkInstance *instance) {
    if (volkInitialize() != VK_SUCCESS)
        return "no Vulkan loader on this machine (libvulkan.so.1, Debian's libvulkan1)";
    if (volkGetInstanceVersion() < VK_API_VERSION_1_2)
        return "the Vulkan loader is older than 1.2";
    switch (vkCreateInstance(info, NULL, instance)) {
    case VK_SUCCESS: volkLoadInstance(*instance); break;
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return "no Vulkan driver on this machine (of NVIDIA, or Debian's mesa-vulkan-drivers)";
    case VK_ERROR_OUT_OF_HOST_MEMORY: /* the loader's answer to a manifest that is no JSON, too */
        return "out of memory, or a driver's manifest is broken (VK_LOADER_DEBUG=error names it)";
    case VK_ERROR_LAYER_NOT_PRESENT: return "no validation layer on this machine";
    default: return "the Vulkan loader makes no instance";
    }
    const VkInstanceCreateInfo plain = { .sType = info->sType, .pApplicationInfo = info->pApplicationInfo };
    if (!kept && vkCreateInstance(&plain, NULL, &kept) != VK_SUCCESS)
        kept = VK_NULL_HANDLE;
    return NULL;
}

const char *noc_vk_make_instance(const VkDebugUtilsMessengerCreateInfoEXT *messages, VkInstance *instance) {
    const char *layer = VK_VALIDATION_LAYER, *debug = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkApplicationInfo app = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                              .pApplicationName = "nocturne",
                              .apiVersion = VK_API_VERSION_1_2 };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = messages,
        .pApplicationInfo = &app,
        .enabledLayerCount = messages != NULL,
        .ppEnabledLayerNames = &layer,
        .enabledExtensionCount = messages != NULL,
        .ppEnabledExtensionNames = &debug,
    };
    pthread_mutex_lock(&loading);
    const char *why = load_instance(&info, instance);
    pthread_mutex_unlock(&loading);
    return why;
}

bool noc_vk_has_extension(VkPhysicalDevice physical, const char *name) {
    uint32_t count = 0;
    bool has = false;
    VkExtensionProperties *have = NULL;
    if (vkEnumerateDeviceExtensionProperties(physical, NULL, &count, NULL) == VK_SUCCESS)
        have = noc_calloc(count + 1, sizeof(*have));
    if (!have || vkEnumerateDeviceExtensionProperties(physical, NULL, &count, have) != VK_SUCCESS)
        count = 0;
    for (uint32_t i = 0; i < count && !has; i++)
        has = !strcmp(have[i].extensionName, name);
    free(have);
    return has;
}

/* Returns the first of the extensions that the device lacks, NULL: it has all. */
static const char *missing_extension(VkPhysicalDevice physical) {
    for (size_t i = 0; i < VK_EXTENSIONS; i++)
        if (!noc_vk_has_extension(physical, noc_vk_extensions[i]))
            return noc_vk_extensions[i];
    return NULL;
}

uint32_t noc_vk_compute_family(VkPhysicalDevice physical, uint32_t *bits) {
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

void noc_vk_chain_features(vk_features *f) {
    *f = (vk_features){ 0 };
    f->rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR;
    f->structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
    f->structures.pNext = &f->rays;
    f->v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    f->v12.pNext = &f->structures;
    f->all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    f->all.pNext = &f->v12;
}

/* Mesa's driver that runs on the processor had ray tracing before it was sound. */
static bool is_old_llvmpipe(const VkPhysicalDeviceDriverProperties *driver) {
    int major = 0;
    return driver->driverID == VK_DRIVER_ID_MESA_LLVMPIPE && sscanf(driver->driverInfo, "Mesa %d", &major) == 1 &&
           major < OLDEST_LLVMPIPE;
}

/* Fills d->why with what the device lacks; "" if it can render. */
static void find_fault(VkPhysicalDevice physical, uint32_t version, const VkPhysicalDeviceDriverProperties *driver,
                       noc_device_info *d) {
    uint32_t bits;
    vk_features f;
    if (version < VK_API_VERSION_1_2) {
        noc_snprintf(d->why, sizeof(d->why), "its driver has Vulkan %u.%u, 1.2 is needed",
                     VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version));
        return;
    }
    if (is_old_llvmpipe(driver)) {
        noc_snprintf(d->why, sizeof(d->why), "its driver is too old to trace rays: Mesa %d or later is needed",
                     OLDEST_LLVMPIPE);
        return;
    }
    const char *missing = missing_extension(physical);
    if (missing) {
        noc_snprintf(d->why, sizeof(d->why), "no ray tracing: %s is missing (an older GPU, or an older driver)",
                     missing);
        return;
    }
    noc_vk_chain_features(&f);
    vkGetPhysicalDeviceFeatures2(physical, &f.all);
    missing = !f.rays.rayTracingPipeline            ? "rayTracingPipeline"
              : !f.structures.accelerationStructure ? "accelerationStructure"
              : !f.v12.bufferDeviceAddress          ? "bufferDeviceAddress"
              : !f.v12.scalarBlockLayout            ? "scalarBlockLayout"
                                                    : NULL;
    if (missing)
        noc_snprintf(d->why, sizeof(d->why), "its driver lacks the feature %s", missing);
    else if (noc_vk_compute_family(physical, &bits) == UINT32_MAX)
        noc_snprintf(d->why, sizeof(d->why), "it has no queue that computes");
}

static noc_device_kind kind_of(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return NOC_DEVICE_DISCRETE;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return NOC_DEVICE_INTEGRATED;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return NOC_DEVICE_VIRTUAL;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return NOC_DEVICE_SOFTWARE;
    default: return NOC_DEVICE_OTHER;
    }
}

static void describe(VkPhysicalDevice physical, noc_device_info *d) {
    VkPhysicalDeviceDriverProperties driver = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES };
    VkPhysicalDeviceProperties2 more = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver };
    VkPhysicalDeviceProperties p;
    vkGetPhysicalDeviceProperties(physical, &p);
    *d = (noc_device_info){ .kind = kind_of(p.deviceType) };
    noc_snprintf(d->name, sizeof(d->name), "%s", p.deviceName[0] ? p.deviceName : "unnamed device");
    if (p.apiVersion >= VK_API_VERSION_1_2) {
        vkGetPhysicalDeviceProperties2(physical, &more);
        noc_snprintf(d->driver, sizeof(d->driver), "%.60s %.60s", driver.driverName, driver.driverInfo);
    }
    find_fault(physical, p.apiVersion, &driver, d);
    d->usable = !d->why[0];
}

/* Returns how many there are, of which the first MOST_DEVICES are in `all`. */
static uint32_t list_physical(VkInstance instance, VkPhysicalDevice all[MOST_DEVICES]) {
    uint32_t count = MOST_DEVICES;
    VkResult result = vkEnumeratePhysicalDevices(instance, &count, all);
    return result == VK_SUCCESS || result == VK_INCOMPLETE ? count : 0;
}

VkPhysicalDevice noc_vk_physical_device(VkInstance instance, int number) {
    VkPhysicalDevice all[MOST_DEVICES];
    return number >= 0 && (uint32_t)number < list_physical(instance, all) ? all[number] : VK_NULL_HANDLE;
}

size_t noc_vk_devices(noc_device_info *devices, size_t capacity) {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice all[MOST_DEVICES];
    const char *why = noc_vk_make_instance(NULL, &instance);
    uint32_t count = why ? 0 : list_physical(instance, all);
    for (uint32_t i = 0; i < count && i < capacity; i++)
        describe(all[i], &devices[i]);
    if (instance)
        vkDestroyInstance(instance, NULL);
    if (!count && capacity) {
        devices[0] = (noc_device_info){ .usable = false };
        noc_snprintf(devices[0].why, sizeof(devices[0].why), "%s", why ? why : "no Vulkan device on this machine");
    }
    return NOC_MAX(count, 1);
}
