/* A Vulkan device that refuses: functions of the driver are replaced where volk keeps them, each time they are loaded
 * (the linker's --wrap=volkLoadInstance). What is made and freed is counted; no production code knows of it. */
#ifndef NOC_TEST_VULKAN_FAULT_H
#define NOC_TEST_VULKAN_FAULT_H

#include "../told.h"
#include "backend/vulkan/vulkan.h"

#include <limits.h>

static struct {
    long objects, memory, most_memory; /* that live: of all kinds but memory, and allocations */
    long made, refuse_from; /* objects and allocations made so far; the number of the first that is refused */
    bool memory_alone;      /* allocations alone are numbered and refused */
    const char *refused;    /* the function that refused first; NULL: none has */
    long used, lost_from;   /* submissions and waits so far; the number of the first that finds the device lost */
} fault;

static void fault_none(void) {
    fault.made = fault.used = 0;
    fault.refuse_from = fault.lost_from = LONG_MAX;
    fault.refused = NULL;
    fault.memory_alone = false;
}

/* Returns true if what is asked for now is refused. */
static bool fault_refuses(const char *function, bool memory) {
    if (fault.memory_alone && !memory)
        return false;
    bool refuses = ++fault.made >= fault.refuse_from;
    if (refuses && !fault.refused)
        fault.refused = function;
    return refuses;
}

static bool fault_loses(void) { return ++fault.used >= fault.lost_from; }

/* Of each: the driver's function, and what stands in its place. */
#define MAKER(create, destroy, type, info, live)                                                                       \
    static PFN_##create driver_##create;                                                                               \
    static PFN_##destroy driver_##destroy;                                                                             \
    static VKAPI_ATTR VkResult VKAPI_CALL fault_##create(VkDevice d, const info *i, const VkAllocationCallbacks *a,    \
                                                         type *out) {                                                  \
        if (fault_refuses(#create, &fault.live == &fault.memory))                                                      \
            return VK_ERROR_OUT_OF_DEVICE_MEMORY;                                                                      \
        VkResult result = driver_##create(d, i, a, out);                                                               \
        fault.live += result == VK_SUCCESS;                                                                            \
        fault.most_memory = NOC_MAX(fault.most_memory, fault.memory);                                                  \
        return result;                                                                                                 \
    }                                                                                                                  \
    static VKAPI_ATTR void VKAPI_CALL fault_##destroy(VkDevice d, type object, const VkAllocationCallbacks *a) {       \
        fault.live -= object != VK_NULL_HANDLE;                                                                        \
        driver_##destroy(d, object, a);                                                                                \
    }
#define MAKERS(M)                                                                                                      \
    M(vkAllocateMemory, vkFreeMemory, VkDeviceMemory, VkMemoryAllocateInfo, memory)                                    \
    M(vkCreateBuffer, vkDestroyBuffer, VkBuffer, VkBufferCreateInfo, objects)                                          \
    M(vkCreateAccelerationStructureKHR, vkDestroyAccelerationStructureKHR, VkAccelerationStructureKHR,                 \
      VkAccelerationStructureCreateInfoKHR, objects)                                                                   \
    M(vkCreateFence, vkDestroyFence, VkFence, VkFenceCreateInfo, objects)                                              \
    M(vkCreateQueryPool, vkDestroyQueryPool, VkQueryPool, VkQueryPoolCreateInfo, objects)                              \
    M(vkCreateShaderModule, vkDestroyShaderModule, VkShaderModule, VkShaderModuleCreateInfo, objects)                  \
    M(vkCreateCommandPool, vkDestroyCommandPool, VkCommandPool, VkCommandPoolCreateInfo, objects)                      \
    M(vkCreateDescriptorPool, vkDestroyDescriptorPool, VkDescriptorPool, VkDescriptorPoolCreateInfo, objects)          \
    M(vkCreateDescriptorSetLayout, vkDestroyDescriptorSetLayout, VkDescriptorSetLayout,                                \
      VkDescriptorSetLayoutCreateInfo, objects)                                                                        \
    M(vkCreatePipelineLayout, vkDestroyPipelineLayout, VkPipelineLayout, VkPipelineLayoutCreateInfo, objects)          \
    M(vkCreatePipelineCache, vkDestroyPipelineCache, VkPipelineCache, VkPipelineCacheCreateInfo, objects)
MAKERS(MAKER)

static PFN_vkMapMemory driver_vkMapMemory;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkMapMemory(VkDevice d, VkDeviceMemory m, VkDeviceSize at, VkDeviceSize n,
                                                        VkMemoryMapFlags flags, void **out) {
    return fault_refuses("vkMapMemory", false) ? VK_ERROR_OUT_OF_HOST_MEMORY
                                               : driver_vkMapMemory(d, m, at, n, flags, out);
}

/* Pipelines stay with their device, so they are refused, and not counted. */
static PFN_vkCreateComputePipelines driver_vkCreateComputePipelines;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkCreateComputePipelines(VkDevice d, VkPipelineCache cache, uint32_t n,
                                                                     const VkComputePipelineCreateInfo *info,
                                                                     const VkAllocationCallbacks *a, VkPipeline *out) {
    return fault_refuses("vkCreateComputePipelines", false)
               ? VK_ERROR_OUT_OF_DEVICE_MEMORY
               : driver_vkCreateComputePipelines(d, cache, n, info, a, out);
}

static PFN_vkCreateRayTracingPipelinesKHR driver_vkCreateRayTracingPipelinesKHR;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkCreateRayTracingPipelinesKHR(
    VkDevice d, VkDeferredOperationKHR op, VkPipelineCache cache, uint32_t n,
    const VkRayTracingPipelineCreateInfoKHR *info, const VkAllocationCallbacks *a, VkPipeline *out) {
    return fault_refuses("vkCreateRayTracingPipelinesKHR", false)
               ? VK_ERROR_OUT_OF_DEVICE_MEMORY
               : driver_vkCreateRayTracingPipelinesKHR(d, op, cache, n, info, a, out);
}

static PFN_vkAllocateCommandBuffers driver_vkAllocateCommandBuffers;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkAllocateCommandBuffers(VkDevice d,
                                                                     const VkCommandBufferAllocateInfo *info,
                                                                     VkCommandBuffer *out) {
    if (!fault_refuses("vkAllocateCommandBuffers", false))
        return driver_vkAllocateCommandBuffers(d, info, out);
    *out = VK_NULL_HANDLE;
    return VK_ERROR_OUT_OF_HOST_MEMORY;
}

static PFN_vkQueueSubmit driver_vkQueueSubmit;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkQueueSubmit(VkQueue q, uint32_t n, const VkSubmitInfo *info,
                                                          VkFence fence) {
    if (fault_loses())
        return VK_ERROR_DEVICE_LOST;
    return fault_refuses("vkQueueSubmit", false) ? VK_ERROR_OUT_OF_HOST_MEMORY
                                                 : driver_vkQueueSubmit(q, n, info, fence);
}

/* What is in flight is finished all the same: it is this process that plays the device. */
static PFN_vkQueueWaitIdle driver_vkQueueWaitIdle;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkQueueWaitIdle(VkQueue q) {
    VkResult result = driver_vkQueueWaitIdle(q);
    return fault_loses() ? VK_ERROR_DEVICE_LOST : result;
}

static PFN_vkWaitForFences driver_vkWaitForFences;
static VKAPI_ATTR VkResult VKAPI_CALL fault_vkWaitForFences(VkDevice d, uint32_t n, const VkFence *fences, VkBool32 all,
                                                            uint64_t time) {
    VkResult result = driver_vkWaitForFences(d, n, fences, all, time);
    return fault_loses() ? VK_ERROR_DEVICE_LOST : result;
}

static void (*fault_more)(void); /* what else a test replaces; NULL: nothing */

#define REPLACE(function)                                                                                              \
    do {                                                                                                               \
        driver_##function = function;                                                                                  \
        function = fault_##function;                                                                                   \
    } while (0)
#define REPLACE_BOTH(create, destroy, type, info, live)                                                                \
    REPLACE(create);                                                                                                   \
    REPLACE(destroy);

void __real_volkLoadInstance(VkInstance instance);
void __wrap_volkLoadInstance(VkInstance instance);
void __wrap_volkLoadInstance(VkInstance instance) {
    __real_volkLoadInstance(instance);
    MAKERS(REPLACE_BOTH)
    REPLACE(vkMapMemory);
    REPLACE(vkCreateComputePipelines);
    REPLACE(vkCreateRayTracingPipelinesKHR);
    REPLACE(vkAllocateCommandBuffers);
    REPLACE(vkQueueSubmit);
    REPLACE(vkQueueWaitIdle);
    REPLACE(vkWaitForFences);
    if (fault_more)
        fault_more();
}

/* ---- what is said ---- */

static inline size_t lines_told(void) {
    size_t lines = 0;
    for (const char *c = told; *c; c++)
        lines += *c == '\n';
    return lines;
}

/* There was one error, and it has these parts; it is forgotten. */
static inline void expect_told(const char *when, const char *const *parts, size_t count) {
    bool right = lines_told() == 1;
    for (size_t i = 0; i < count; i++)
        right = right && strstr(told, parts[i]);
    if (!right)
        fail_msg("%s: not one error with \"%s\" and so on, but:\n%s", when, parts[0], told);
    *told = 0;
}
#define EXPECT_TOLD(when, ...)                                                                                         \
    expect_told(when, (const char *const[]){ __VA_ARGS__ }, NOC_COUNT(((const char *const[]){ __VA_ARGS__ })))

static inline void expect_silence(const char *when) {
    if (*told)
        fail_msg("%s: was told:\n%s", when, told);
}

static noc_log *messages; /* of all tests: kept in `told` */

static inline noc_log *open_messages(void) {
    fault_none();
    return noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
}

/* Returns true if a Vulkan device traces rays here; says why not. */
static inline bool has_vulkan(void) {
    noc_device_info info;
    fault.objects = fault.memory = 0; /* of a test that failed */
    bool has = noc_device_find(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, &info, messages) == NOC_OK;
    if (!has)
        print_message("# skipped: %s\n", noc_log_last_error(messages));
    *told = 0;
    return has;
}

static inline noc_device *open_vulkan(void) {
    return noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, messages);
}

static inline void expect_nothing_left(const char *when) {
    if (fault.objects || fault.memory)
        fail_msg("%s: %ld objects and %ld allocations are left", when, fault.objects, fault.memory);
}

#endif
