#include "vulkan_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* Drivers leak a little and are unloaded before leaks are looked for, so that no suppression can name them: what is
 * allocated inside the loader's calls is not counted. */
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#define THEIRS(call) (__lsan_disable(), ours_again(call))
static VkResult ours_again(VkResult result) {
    __lsan_enable();
    return result;
}
#else
#define THEIRS(call) (call)
#endif

#define LAYER "VK_LAYER_KHRONOS_validation"

struct vulkan_state {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
};

/* What one dispatch makes and frees again. */
typedef struct job {
    VkDevice device;
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkShaderModule module;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkDescriptorPool descriptors;
    VkDescriptorSet set;
    VkCommandPool commands;
    VkFence fence;
} job;

static bool fail(vulkan_run *run, const char *what, VkResult result) {
    snprintf(run->why, sizeof(run->why), "%s (VkResult %d)", what, (int)result);
    return false;
}

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        VkResult result_ = THEIRS(call);                                                                               \
        if (result_ != VK_SUCCESS)                                                                                     \
            return fail(run, #call, result_);                                                                          \
    } while (0)

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT type,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    vulkan_run *run = user;
    (void)severity;
    if (!(type & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT))
        return VK_FALSE; /* the loader's own remarks about drivers */
    run->messages++;
    fprintf(stderr, "# %s\n", data->pMessage);
    return VK_FALSE;
}

static bool has_layer(void) {
    VkLayerProperties layers[64];
    uint32_t count = 64;
    VkResult result = THEIRS(vkEnumerateInstanceLayerProperties(&count, layers));
    if (result != VK_SUCCESS && result != VK_INCOMPLETE)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (!strcmp(layers[i].layerName, LAYER))
            return true;
    return false;
}

static bool make_instance(vulkan_run *run) {
    struct vulkan_state *s = run->state;
    run->validated = has_layer();
    const char *layers[] = { LAYER }, *extensions[] = { VK_EXT_DEBUG_UTILS_EXTENSION_NAME };
    VkDebugUtilsMessengerCreateInfoEXT messages = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = run,
    };
    VkApplicationInfo app = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_2 };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = run->validated ? &messages : NULL,
        .pApplicationInfo = &app,
        .enabledLayerCount = run->validated,
        .ppEnabledLayerNames = layers,
        .enabledExtensionCount = run->validated,
        .ppEnabledExtensionNames = extensions,
    };
    TRY(vkCreateInstance(&info, NULL, &s->instance));
    if (run->validated) {
        PFN_vkCreateDebugUtilsMessengerEXT create =
            (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(s->instance, "vkCreateDebugUtilsMessengerEXT");
        TRY(create(s->instance, &messages, NULL, &s->messenger));
    }
    return true;
}

static bool make_device(vulkan_run *run, uint32_t number) {
    struct vulkan_state *s = run->state;
    VkPhysicalDevice devices[16];
    uint32_t count = 16;
    VkResult result = THEIRS(vkEnumeratePhysicalDevices(s->instance, &count, devices));
    if ((result != VK_SUCCESS && result != VK_INCOMPLETE) || number >= count)
        return fail(run, "no such device", result);
    s->physical = devices[number];
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(s->physical, &properties);
    snprintf(run->device, sizeof(run->device), "%s", properties.deviceName);
    run->software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    VkQueueFamilyProperties families[16];
    count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(s->physical, &count, families);
    for (s->family = 0; s->family < count; s->family++)
        if (families[s->family].queueFlags & VK_QUEUE_COMPUTE_BIT)
            break;
    if (s->family == count)
        return fail(run, "no compute queue", VK_ERROR_FEATURE_NOT_PRESENT);
    float priority = 1;
    VkDeviceQueueCreateInfo queue = { .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = s->family,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority };
    VkDeviceCreateInfo info = { .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue };
    TRY(vkCreateDevice(s->physical, &info, NULL, &s->device));
    vkGetDeviceQueue(s->device, s->family, 0, &s->queue);
    return true;
}

bool vulkan_open(vulkan_run *run, uint32_t device) {
    memset(run, 0, sizeof(*run));
    run->state = calloc(1, sizeof(*run->state));
    if (run->state && make_instance(run) && make_device(run, device))
        return true;
    vulkan_close(run);
    return false;
}

void vulkan_close(vulkan_run *run) {
    struct vulkan_state *s = run->state;
    if (!s)
        return;
    if (s->device)
        vkDestroyDevice(s->device, NULL);
    if (s->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(s->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(s->instance, s->messenger, NULL);
    }
    if (s->instance)
        vkDestroyInstance(s->instance, NULL);
    free(s);
    run->state = NULL;
}

static bool make_buffer(vulkan_run *run, job *j, size_t bytes) {
    VkBufferCreateInfo info = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT };
    TRY(vkCreateBuffer(j->device, &info, NULL, &j->buffer));
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(j->device, j->buffer, &need);
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(run->state->physical, &memory);
    VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0;
    while (type < memory.memoryTypeCount &&
           !((need.memoryTypeBits >> type & 1) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted))
        type++;
    if (type == memory.memoryTypeCount)
        return fail(run, "no memory that the host sees", VK_ERROR_FEATURE_NOT_PRESENT);
    VkMemoryAllocateInfo allocate = { .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                      .allocationSize = need.size,
                                      .memoryTypeIndex = type };
    TRY(vkAllocateMemory(j->device, &allocate, NULL, &j->memory));
    TRY(vkBindBufferMemory(j->device, j->buffer, j->memory, 0));
    return true;
}

/* Between the host's memory and the buffer. */
static bool copy(vulkan_run *run, job *j, void *host, size_t bytes, bool in) {
    void *mapped;
    TRY(vkMapMemory(j->device, j->memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    memcpy(in ? mapped : host, in ? host : mapped, bytes);
    vkUnmapMemory(j->device, j->memory);
    return true;
}

static bool make_pipeline(vulkan_run *run, job *j, const uint32_t *spirv, size_t spirv_bytes, uint32_t push_bytes) {
    VkShaderModuleCreateInfo module = { .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = spirv_bytes,
                                        .pCode = spirv };
    TRY(vkCreateShaderModule(j->device, &module, NULL, &j->module));
    VkDescriptorSetLayoutBinding binding = { .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                             .descriptorCount = 1,
                                             .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT };
    VkDescriptorSetLayoutCreateInfo set = { .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = 1,
                                            .pBindings = &binding };
    TRY(vkCreateDescriptorSetLayout(j->device, &set, NULL, &j->set_layout));
    VkPushConstantRange range = { .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = push_bytes };
    VkPipelineLayoutCreateInfo layout = { .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = 1,
                                          .pSetLayouts = &j->set_layout,
                                          .pushConstantRangeCount = push_bytes > 0,
                                          .pPushConstantRanges = &range };
    TRY(vkCreatePipelineLayout(j->device, &layout, NULL, &j->layout));
    VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = { .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                   .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                   .module = j->module,
                   .pName = "main" },
        .layout = j->layout,
    };
    TRY(vkCreateComputePipelines(j->device, VK_NULL_HANDLE, 1, &pipeline, NULL, &j->pipeline));
    return true;
}

static bool make_set(vulkan_run *run, job *j) {
    VkDescriptorPoolSize size = { VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1 };
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size
    };
    TRY(vkCreateDescriptorPool(j->device, &pool, NULL, &j->descriptors));
    VkDescriptorSetAllocateInfo allocate = { .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = j->descriptors,
                                             .descriptorSetCount = 1,
                                             .pSetLayouts = &j->set_layout };
    TRY(vkAllocateDescriptorSets(j->device, &allocate, &j->set));
    VkDescriptorBufferInfo buffer = { j->buffer, 0, VK_WHOLE_SIZE };
    VkWriteDescriptorSet write = { .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .dstSet = j->set,
                                   .descriptorCount = 1,
                                   .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                   .pBufferInfo = &buffer };
    vkUpdateDescriptorSets(j->device, 1, &write, 0, NULL);
    return true;
}

static bool dispatch(vulkan_run *run, job *j, const void *push, uint32_t push_bytes, uint32_t groups) {
    VkCommandPoolCreateInfo pool = { .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .queueFamilyIndex = run->state->family };
    TRY(vkCreateCommandPool(j->device, &pool, NULL, &j->commands));
    VkCommandBufferAllocateInfo allocate = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = j->commands,
                                             .commandBufferCount = 1 };
    VkCommandBuffer command;
    TRY(vkAllocateCommandBuffers(j->device, &allocate, &command));
    VkCommandBufferBeginInfo begin = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT };
    TRY(vkBeginCommandBuffer(command, &begin));
    vkCmdBindPipeline(command, VK_PIPELINE_BIND_POINT_COMPUTE, j->pipeline);
    vkCmdBindDescriptorSets(command, VK_PIPELINE_BIND_POINT_COMPUTE, j->layout, 0, 1, &j->set, 0, NULL);
    if (push_bytes)
        vkCmdPushConstants(command, j->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes, push);
    vkCmdDispatch(command, groups, 1, 1);
    VkMemoryBarrier barrier = { .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                .dstAccessMask = VK_ACCESS_HOST_READ_BIT };
    vkCmdPipelineBarrier(command, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0,
                         NULL, 0, NULL);
    TRY(vkEndCommandBuffer(command));
    VkFenceCreateInfo fence = { .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO };
    TRY(vkCreateFence(j->device, &fence, NULL, &j->fence));
    VkSubmitInfo submit = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &command };
    TRY(vkQueueSubmit(run->state->queue, 1, &submit, j->fence));
    TRY(vkWaitForFences(j->device, 1, &j->fence, VK_TRUE, UINT64_MAX));
    return true;
}

bool vulkan_compute(vulkan_run *run, const uint32_t *spirv, size_t spirv_bytes, const void *push, uint32_t push_bytes,
                    uint32_t groups, void *out, size_t out_bytes) {
    job j = { .device = run->state->device };
    bool ok = make_buffer(run, &j, out_bytes) && copy(run, &j, out, out_bytes, true) &&
              make_pipeline(run, &j, spirv, spirv_bytes, push_bytes) && make_set(run, &j) &&
              dispatch(run, &j, push, push_bytes, groups);
    ok = ok && copy(run, &j, out, out_bytes, false);
    vkDeviceWaitIdle(j.device);
    vkDestroyFence(j.device, j.fence, NULL);
    vkDestroyCommandPool(j.device, j.commands, NULL);
    vkDestroyDescriptorPool(j.device, j.descriptors, NULL);
    vkDestroyPipeline(j.device, j.pipeline, NULL);
    vkDestroyPipelineLayout(j.device, j.layout, NULL);
    vkDestroyDescriptorSetLayout(j.device, j.set_layout, NULL);
    vkDestroyShaderModule(j.device, j.module, NULL);
    vkDestroyBuffer(j.device, j.buffer, NULL);
    vkFreeMemory(j.device, j.memory, NULL);
    return ok;
}
