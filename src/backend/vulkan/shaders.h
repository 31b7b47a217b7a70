/* The shaders of the Vulkan backend, each a file of shaders/ that the build compiles and embeds. */
#ifndef NOC_VULKAN_SHADERS_H
#define NOC_VULKAN_SHADERS_H

/* COMPUTE(name): shaders/name.comp. TRACE(name): shaders/name.rgen with its miss and closest-hit shader. PANES(name,
 * of): shaders/name.rgen and its any-hit shader, with the miss and the closest-hit shader of another. */
#define VK_SHADERS(COMPUTE, TRACE, PANES)                                                                              \
    TRACE(trace_closest)                                                                                               \
    TRACE(trace_occlusion)                                                                                             \
    PANES(trace_meeting, trace_closest)                                                                                \
    PANES(trace_through, trace_through)                                                                                \
    COMPUTE(primary_ask)                                                                                               \
    COMPUTE(primary_use)                                                                                               \
    COMPUTE(place)                                                                                                     \
    COMPUTE(presample_uniform)                                                                                         \
    COMPUTE(presample_power)                                                                                           \
    COMPUTE(candidates_shared)                                                                                         \
    COMPUTE(candidates_tree)                                                                                           \
    COMPUTE(influence_groups)                                                                                          \
    COMPUTE(influence_near)                                                                                            \
    COMPUTE(influence_look)                                                                                            \
    COMPUTE(influence_rule)                                                                                            \
    COMPUTE(influence_place)                                                                                           \
    COMPUTE(influence_draw)                                                                                            \
    COMPUTE(influence_candidates)                                                                                      \
    COMPUTE(resolve_ask)                                                                                               \
    COMPUTE(resolve_use)                                                                                               \
    COMPUTE(temporal_ask)                                                                                              \
    COMPUTE(temporal_use)                                                                                              \
    COMPUTE(spatial_ask)                                                                                               \
    COMPUTE(spatial_use)                                                                                               \
    COMPUTE(emitters)                                                                                                  \
    COMPUTE(shade_use)                                                                                                 \
    COMPUTE(reference_sums)                                                                                            \
    COMPUTE(reference_entries)                                                                                         \
    COMPUTE(reference_ask)                                                                                             \
    COMPUTE(reference_use)                                                                                             \
    COMPUTE(headlight)                                                                                                 \
    COMPUTE(sky_ask)                                                                                                   \
    COMPUTE(sky_use)                                                                                                   \
    COMPUTE(list_strongest)                                                                                            \
    COMPUTE(list_tail)                                                                                                 \
    COMPUTE(list_fill)                                                                                                 \
    COMPUTE(list_candidates)                                                                                           \
    COMPUTE(list_fresh)                                                                                                \
    COMPUTE(list_share)                                                                                                \
    COMPUTE(list_ask)                                                                                                  \
    COMPUTE(list_use)                                                                                                  \
    COMPUTE(list_note)                                                                                                 \
    COMPUTE(list_sources)                                                                                              \
    COMPUTE(list_resample)                                                                                             \
    COMPUTE(list_shade)                                                                                                \
    COMPUTE(learn_bright)                                                                                              \
    COMPUTE(learn_sort)                                                                                                \
    COMPUTE(learn_count)                                                                                               \
    COMPUTE(mean)

#define VK_SHADER_NAME(name) VK_SHADER_##name,
#define VK_PANES_NAME(name, of) VK_SHADER_##name,
typedef enum vk_shader { VK_SHADERS(VK_SHADER_NAME, VK_SHADER_NAME, VK_PANES_NAME) VK_SHADER_COUNT } vk_shader;

#endif
