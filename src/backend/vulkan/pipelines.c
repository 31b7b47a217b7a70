/* Pipelines of the embedded shaders, made when they are first needed. All of them share one layout: a TLAS as the only
 * descriptor, and one push constant, the address of the dispatch's record (records.h). What the driver compiled is kept
 * in a file of the user's cache folder. */
#include "backend/vulkan/vulkan.h"
#include "base/output.h"
#include "noc_vulkan_spirv.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_CACHE = 1 << 30 }; /* bytes of the file */

typedef struct module {
    const uint32_t *code; /* NULL: none */
    size_t bytes;
} module;

/* Code of a shader's stages: compute alone, or ray generation, miss, closest hit, and perhaps any hit. */
static const struct shader_code {
    const char *name;
    bool traces;
    module first, miss, hit, any;
} codes[VK_SHADER_COUNT] = {
#define CODE(array)                                                                                                    \
    { array, sizeof(array) }
#define COMPUTE(shader) [VK_SHADER_##shader] = { .name = #shader, .first = CODE(shader##_comp) },
#define TRACE(shader)                                                                                                  \
    [VK_SHADER_##shader] = { .name = #shader,                                                                          \
                             .traces = true,                                                                           \
                             .first = CODE(shader##_rgen),                                                             \
                             .miss = CODE(shader##_rmiss),                                                             \
                             .hit = CODE(shader##_rchit) },
#define PANES(shader, of)                                                                                              \
    [VK_SHADER_##shader] = { .name = #shader,                                                                          \
                             .traces = true,                                                                           \
                             .first = CODE(shader##_rgen),                                                             \
                             .miss = CODE(of##_rmiss),                                                                 \
                             .hit = CODE(of##_rchit),                                                                  \
                             .any = CODE(shader##_rahit) },
    VK_SHADERS(COMPUTE, TRACE, PANES)
};

/* ---- the cache on disk ---- */

/* What stands before the driver's data in the file, so that a file cut short is not handed to the driver. */
typedef struct cache_head {
    char magic[8];
    uint64_t bytes, sum;
} cache_head;

static uint64_t sum_of(const unsigned char *data, size_t bytes) {
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < bytes; i++)
        h = (h ^ data[i]) * 0x100000001b3u;
    return h;
}

/* Returns the file's path, with the folders made where `make` is set; NULL: there is none. */
static char *cache_path(const vk_device *d, bool make) {
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    VkPhysicalDeviceProperties p;
    char id[2 * VK_UUID_SIZE + 1];
    vkGetPhysicalDeviceProperties(d->physical, &p);
    for (size_t i = 0; i < VK_UUID_SIZE; i++)
        noc_snprintf(id + 2 * i, 3, "%02x", p.pipelineCacheUUID[i]);
    char *folder = cache && *cache ? noc_format("%s/nocturne", cache)
                   : home && *home ? noc_format("%s/.cache/nocturne", home)
                                   : NULL;
    if (!folder)
        return NULL;
    if (make) {
        char *slash = strrchr(folder, '/');
        *slash = 0;
        mkdir(folder, 0700);
        *slash = '/';
        mkdir(folder, 0700);
    }
    char *path = noc_format("%s/vulkan-%s.bin", folder, id);
    free(folder);
    return path;
}

/* NULL: there is no such file, or something else, which is not waited for. */
static FILE *open_cache(const char *path) {
    struct stat st;
    int fd = path ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    FILE *file = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode) ? fdopen(fd, "rb") : NULL;
    if (fd >= 0 && !file)
        close(fd);
    return file;
}

/* Returns what an earlier process has kept, NULL: nothing that can be used. */
static void *read_cache(const vk_device *d, size_t *bytes) {
    char *path = cache_path(d, false);
    FILE *file = open_cache(path);
    cache_head head;
    void *data = NULL;
    free(path);
    if (!file)
        return NULL;
    if (fread(&head, sizeof(head), 1, file) == 1 && !memcmp(head.magic, "nocvkpc", 8) && head.bytes < MOST_CACHE &&
        (data = noc_alloc((size_t)head.bytes + 1)) &&
        (fread(data, 1, (size_t)head.bytes + 1, file) != head.bytes || sum_of(data, (size_t)head.bytes) != head.sum)) {
        free(data);
        data = NULL;
    }
    *bytes = data ? (size_t)head.bytes : 0;
    fclose(file);
    return data;
}

/* Nothing is reported where it fails: the next process compiles again. */
static void write_cache(vk_device *d) {
    size_t bytes = 0;
    if (vkGetPipelineCacheData(d->device, d->cache, &bytes, NULL) != VK_SUCCESS || bytes <= 32 || /* a head alone */
        bytes >= MOST_CACHE)
        return;
    unsigned char *data = noc_alloc(bytes);
    char *path = cache_path(d, true);
    output o;
    if (data && path && vkGetPipelineCacheData(d->device, d->cache, &bytes, data) == VK_SUCCESS &&
        output_open(&o, path, NULL) == NOC_OK) {
        cache_head head = { "nocvkpc", bytes, sum_of(data, bytes) };
        bool ok = fwrite(&head, sizeof(head), 1, o.file) == 1 && fwrite(data, 1, bytes, o.file) == bytes;
        if (output_close(&o, ok ? NOC_OK : NOC_ERR_IO, NULL) != NOC_OK)
            noc_debug(d->log, "vulkan: %s was not written", path);
    }
    free(data);
    free(path);
}

/* ---- layout and binding table ---- */

static VkDeviceSize aligned(VkDeviceSize size, VkDeviceSize to) { return (size + to - 1) / to * to; }

static VkDeviceSize table_stride(const vk_device *d) {
    return aligned(d->rays.shaderGroupHandleSize, NOC_MAX(d->rays.shaderGroupBaseAlignment, 1));
}

static VkResult make_layout(vk_device *d) {
    VkDescriptorSetLayoutBinding binding = { .descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR,
                                             .descriptorCount = 1,
                                             .stageFlags = VK_SHADER_STAGE_RAYGEN_BIT_KHR };
    VkDescriptorSetLayoutCreateInfo set = { .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = 1,
                                            .pBindings = &binding };
    VkResult result = vkCreateDescriptorSetLayout(d->device, &set, NULL, &d->set_layout);
    if (result != VK_SUCCESS)
        return result;
    VkPushConstantRange range = { .stageFlags = VK_PUSH_STAGES, .size = sizeof(VkDeviceAddress) };
    VkPipelineLayoutCreateInfo layout = { .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = 1,
                                          .pSetLayouts = &d->set_layout,
                                          .pushConstantRangeCount = 1,
                                          .pPushConstantRanges = &range };
    return vkCreatePipelineLayout(d->device, &layout, NULL, &d->layout);
}

noc_status noc_vk_pipelines_create(vk_device *d) {
    VkPipelineCacheCreateInfo cache = { .sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO };
    void *kept = read_cache(d, &cache.initialDataSize);
    cache.pInitialData = kept;
    VkResult result = make_layout(d);
    if (result == VK_SUCCESS)
        result = vkCreatePipelineCache(d->device, &cache, NULL, &d->cache);
    free(kept);
    if (result != VK_SUCCESS)
        return noc_vk_failed(d, result, "making pipelines");
    return noc_vk_make_buffer(d, 3 * VK_SHADER_COUNT * table_stride(d), VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR,
                              VK_PLACE_SHARED, "the shader binding table", &d->table);
}

void noc_vk_pipelines_destroy(vk_device *d) {
    for (int i = 0; i < VK_SHADER_COUNT; i++)
        if (d->pipelines[i].pipeline)
            vkDestroyPipeline(d->device, d->pipelines[i].pipeline, NULL);
    if (d->cache) {
        if (d->compile_seconds > 0 && !d->lost)
            write_cache(d);
        vkDestroyPipelineCache(d->device, d->cache, NULL);
    }
    if (d->layout)
        vkDestroyPipelineLayout(d->device, d->layout, NULL);
    if (d->set_layout)
        vkDestroyDescriptorSetLayout(d->device, d->set_layout, NULL);
    noc_vk_free_buffer(d, &d->table);
}

/* ---- pipelines ---- */

static VkResult make_module(vk_device *d, const module *m, VkShaderModule *out) {
    VkShaderModuleCreateInfo info = { .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = m->bytes,
                                      .pCode = m->code };
    return vkCreateShaderModule(d->device, &info, NULL, out);
}

static VkPipelineShaderStageCreateInfo stage_of(VkShaderStageFlagBits kind, VkShaderModule m) {
    return (VkPipelineShaderStageCreateInfo){
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = kind, .module = m, .pName = "main"
    };
}

static VkResult make_compute(vk_device *d, const struct shader_code *code, VkPipeline *out) {
    VkShaderModule m;
    VkResult result = make_module(d, &code->first, &m);
    if (result != VK_SUCCESS)
        return result;
    const VkSpecializationMapEntry entries[] = { { 0, offsetof(vk_constants, list_workers), 4 },
                                                 { 1, offsetof(vk_constants, share_workers), 4 },
                                                 { 2, offsetof(vk_constants, rounds), 4 } };
    const VkSpecializationInfo constants = { NOC_COUNT(entries), entries, sizeof(d->constants), &d->constants };
    VkComputePipelineCreateInfo info = { .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                         .flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT, /* steps are cut */
                                         .stage = stage_of(VK_SHADER_STAGE_COMPUTE_BIT, m),
                                         .layout = d->layout };
    info.stage.pSpecializationInfo = &constants;
    result = vkCreateComputePipelines(d->device, d->cache, 1, &info, NULL, out);
    vkDestroyShaderModule(d->device, m, NULL);
    return result;
}

/* Group 0 generates rays, 1 is the miss shader, 2 the hit group. */
static VkResult make_trace(vk_device *d, const struct shader_code *code, VkPipeline *out) {
    const module *modules[] = { &code->first, &code->miss, &code->hit, &code->any };
    static const VkShaderStageFlagBits kinds[] = { VK_SHADER_STAGE_RAYGEN_BIT_KHR, VK_SHADER_STAGE_MISS_BIT_KHR,
                                                   VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR,
                                                   VK_SHADER_STAGE_ANY_HIT_BIT_KHR };
    uint32_t count = code->any.code ? 4 : 3;
    VkShaderModule made[4] = { VK_NULL_HANDLE };
    VkPipelineShaderStageCreateInfo stages[4];
    VkRayTracingShaderGroupCreateInfoKHR groups[3];
    VkResult result = VK_SUCCESS;
    for (uint32_t i = 0; i < count && result == VK_SUCCESS; i++) {
        result = make_module(d, modules[i], &made[i]);
        stages[i] = stage_of(kinds[i], made[i]);
    }
    for (uint32_t i = 0; i < 3; i++)
        groups[i] = (VkRayTracingShaderGroupCreateInfoKHR){
            .sType = VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR,
            .type = i < 2 ? VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR
                          : VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR,
            .generalShader = i < 2 ? i : VK_SHADER_UNUSED_KHR,
            .closestHitShader = i < 2 ? VK_SHADER_UNUSED_KHR : i,
            .anyHitShader = i == 2 && code->any.code ? 3 : VK_SHADER_UNUSED_KHR,
            .intersectionShader = VK_SHADER_UNUSED_KHR,
        };
    VkRayTracingPipelineCreateInfoKHR info = { .sType = VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR,
                                               .stageCount = count,
                                               .pStages = stages,
                                               .groupCount = 3,
                                               .pGroups = groups,
                                               .maxPipelineRayRecursionDepth = 1,
                                               .layout = d->layout };
    if (result == VK_SUCCESS)
        result = vkCreateRayTracingPipelinesKHR(d->device, VK_NULL_HANDLE, d->cache, 1, &info, NULL, out);
    for (uint32_t i = 0; i < count; i++)
        if (made[i])
            vkDestroyShaderModule(d->device, made[i], NULL);
    return result;
}

/* Writes the handles of the pipeline's groups into its part of the binding table. */
static VkResult fill_table(vk_device *d, vk_shader shader, vk_pipeline *p) {
    unsigned char handles[3 * 64];
    VkDeviceSize stride = table_stride(d);
    uint32_t size = d->rays.shaderGroupHandleSize;
    if (size > 64)
        return VK_ERROR_FEATURE_NOT_PRESENT;
    VkResult result = vkGetRayTracingShaderGroupHandlesKHR(d->device, p->pipeline, 0, 3, (size_t)3 * size, handles);
    if (result != VK_SUCCESS)
        return result;
    VkStridedDeviceAddressRegionKHR *regions[] = { &p->raygen, &p->miss, &p->hit };
    for (uint32_t i = 0; i < 3; i++) {
        VkDeviceSize at = (3 * (VkDeviceSize)shader + i) * stride;
        memcpy((char *)d->table.mapped + at, handles + (size_t)i * size, size);
        *regions[i] = (VkStridedDeviceAddressRegionKHR){ d->table.address + at, stride, stride };
    }
    return VK_SUCCESS;
}

noc_status noc_vk_pipeline(vk_device *d, vk_shader shader, const vk_pipeline **pipeline) {
    vk_pipeline *p = &d->pipelines[shader];
    *pipeline = p;
    if (p->pipeline)
        return NOC_OK;
    double wall = noc_wall_seconds(), cpu = noc_cpu_seconds();
    const struct shader_code *code = &codes[shader];
    VkResult result = code->traces ? make_trace(d, code, &p->pipeline) : make_compute(d, code, &p->pipeline);
    if (result == VK_SUCCESS && code->traces)
        result = fill_table(d, shader, p);
    d->compile_seconds += noc_wall_seconds() - wall;
    d->compile_cpu_seconds += noc_cpu_seconds() - cpu;
    if (result == VK_SUCCESS)
        return NOC_OK;
    char text[64];
    if (p->pipeline)
        vkDestroyPipeline(d->device, p->pipeline, NULL);
    p->pipeline = VK_NULL_HANDLE;
    noc_snprintf(text, sizeof(text), "compiling shader %s", code->name);
    return noc_vk_failed(d, result, text);
}
