/* What the host and the shaders of the Vulkan backend both know: records in buffers, and the record of addresses that
 * each dispatch gets. All of them have scalar layout: 4-byte scalars and 8-byte addresses without gaps. */
#ifndef NOC_VULKAN_RECORDS_H
#define NOC_VULKAN_RECORDS_H

#include "core/blocks.h"
#include "core/frame.h"
#include "core/records.h"

/* An instance of a model. */
struct vk_instance_record {
    placement_rows transform; /* model to world */
    uint32_t lights;          /* place of its lights' numbers in the table of such */
};

/* What lets light through of a material. */
struct vk_pane_record {
    float transmittance;
    uint32_t holes; /* place of the texture whose holes it has, + 1; 0: none */
};

/* Masks of instances: surfaces that block light, and those that let it through. */
#define VK_MASK_SOLID 1u
#define VK_MASK_THROUGH 2u

#define VK_REFERENCE_CHUNKS 64u /* of lights, that a dispatch sums up */
#define VK_REFERENCE_RAYS 8u    /* of a pixel, that are traced at once */

#define VK_COUNTERS 64 /* of each kind; invocations spread over them */
#define VK_COUNT_RAYS 0
#define VK_COUNT_DROPPED 1
#define VK_COUNT_UNLEARNED 2 /* cells of tiles whose observations had no room */
#define VK_COUNT_UNLISTED 3  /* groups of points whose lights had no room: influence */
#define VK_COUNT_KINDS 4

/* Fields of a dispatch's record: ADDRESS(type in shaders, name), then WORD(type, name). */
#define VK_BINDING(ADDRESS, WORD)                                                                                      \
    ADDRESS(Frame, frame)                                                                                              \
    ADDRESS(Lights, lights)      /* as they are */                                                                     \
    ADDRESS(Lights, past_lights) /* as they were when the source's reservoirs were made */                             \
    ADDRESS(Materials, materials)                                                                                      \
    ADDRESS(Floats, profiles)                                                                                          \
    ADDRESS(Words, texels)                                                                                             \
    ADDRESS(Words, indices)                                                                                            \
    ADDRESS(Floats, positions)                                                                                         \
    ADDRESS(Words, triangle_material)                                                                                  \
    ADDRESS(Words, triangle_light)                                                                                     \
    ADDRESS(Words, triangle_facade) /* number + 1; 0: none */                                                          \
    ADDRESS(Facades, facades)                                                                                          \
    ADDRESS(Words, facade_cells)                                                                                       \
    ADDRESS(Words, image_places)  /* of each material the place of its texture + 1; 0: none */                         \
    ADDRESS(Words, image_corners) /* 2 floats a vertex as bits; 0xffffffff: its mesh has none */                       \
    ADDRESS(Panes, panes)         /* of each material; none: no surface lets light through */                          \
    ADDRESS(Instances, instances) /* bodies of lamps, then instances */                                                \
    ADDRESS(Backs, backs)         /* of each instance */                                                               \
    ADDRESS(Words, instance_lights)                                                                                    \
    ADDRESS(Entries, entries)                                                                                          \
    ADDRESS(Words, alias)                                                                                              \
    ADDRESS(Words, tree)                                                                                               \
    ADDRESS(Floats, environment)                                                                                       \
    ADDRESS(Floats, backdrop)                                                                                          \
    ADDRESS(Words, environment_slots)                                                                                  \
    ADDRESS(Floats, environment_sines)                                                                                 \
    ADDRESS(Floats, given) /* receivers in place of what a camera sees */                                              \
    ADDRESS(SurfaceBlocks, surfaces)                                                                                   \
    ADDRESS(SurfaceBlocks, previous)                                                                                   \
    ADDRESS(Words, instance) /* that each pixel sees */                                                                \
    ADDRESS(ReservoirBlocks, source)                                                                                   \
    ADDRESS(ReservoirBlocks, target)                                                                                   \
    ADDRESS(Words, source_visible)                                                                                     \
    ADDRESS(Words, target_visible)                                                                                     \
    ADDRESS(ColourBlocks, colour)                                                                                      \
    ADDRESS(ColourBlocks, picture)                                                                                     \
    ADDRESS(Coverages, coverage)                                                                                       \
    ADDRESS(RayBlocks, rays)                                                                                           \
    ADDRESS(Words, answers)                                                                                            \
    ADDRESS(Floats, through) /* transmittance on the way of each ray that arrived, while panes is there */             \
    ADDRESS(HitBlocks, hits)                                                                                           \
    ADDRESS(SampleRows, samples)                                                                                       \
    ADDRESS(Words, scratch)  /* of a band of the picture */                                                            \
    ADDRESS(Words, clusters) /* a head of 16 words a hierarchy: shaders/list_tile.glsl */                              \
    ADDRESS(Words, volumes)  /* influence volumes: influence_memory.h */                                               \
    ADDRESS(Words, found)    /* surfaces by the number of lights that they found */                                    \
    ADDRESS(Words, learned)  /* the visibility cache, and the next two: list_memory.h */                               \
    ADDRESS(Words, observed)                                                                                           \
    ADDRESS(Floats, block_bright)                                                                                      \
    ADDRESS(Words, counters)                                                                                           \
    ADDRESS(Words, view_rays) /* a count; the others as noc_views.made has what views gather */                        \
    ADDRESS(Floats, view_lights)                                                                                       \
    ADDRESS(Floats, view_density)                                                                                      \
    ADDRESS(Floats, view_lux)                                                                                          \
    ADDRESS(Floats, view_group)                                                                                        \
    ADDRESS(Floats, view_placed)                                                                                       \
    ADDRESS(Floats, view_expected)                                                                                     \
    ADDRESS(Floats, view_emitters)                                                                                     \
    ADDRESS(Floats, emitter_labels) /* of each light */                                                                \
    ADDRESS(Words, view_triangles)  /* that each pixel sees */                                                         \
    WORD(uint32_t, light_count)                                                                                        \
    WORD(uint32_t, triangle_count)                                                                                     \
    WORD(uint32_t, facade_triangles) /* that triangle_facade is of */                                                  \
    WORD(uint32_t, textured)         /* 1: materials have textures, and meshes places in them */                       \
    WORD(uint32_t, weakens)          /* 1: light is weakened by `through` */                                           \
    WORD(uint32_t, instanced)        /* 1: the instance that each pixel sees is kept */                                \
    WORD(uint32_t, moved)            /* 1: instances may have been elsewhere in the frame before */                    \
    WORD(uint32_t, slots)            /* pixels of the blocks whose rays are kept at once: rays of one slot */          \
    WORD(uint32_t, blocks_y)                                                                                           \
    WORD(uint32_t, draws)   /* candidates a pixel */                                                                   \
    WORD(uint32_t, subsets) /* of candidates that are drawn before the frame, and rows of each */                      \
    WORD(uint32_t, subset_rows)                                                                                        \
    WORD(uint32_t, alias_count)                                                                                        \
    WORD(uint32_t, tree_root)                                                                                          \
    WORD(uint32_t, tree_depth)                                                                                         \
    WORD(uint32_t, sky_turns) /* rays to the sky at most */                                                            \
    WORD(uint32_t, dimension) /* of reuse: DIM_TEMPORAL, or DIM_SPATIAL + 64 a pass */                                 \
    WORD(uint32_t, first_row) /* of blocks, at which this dispatch begins, and how many its band has */                \
    WORD(uint32_t, rows)                                                                                               \
    WORD(uint32_t, first)         /* ray, or chunk of lights, at which this dispatch begins; or which of two it is */  \
    WORD(uint32_t, views)         /* VK_VIEW_ bits of what is gathered */                                              \
    WORD(uint32_t, light_colours) /* core/measured.h */                                                                \
    WORD(uint32_t, by_power)      /* 1: candidates are drawn by power */                                               \
    WORD(uint32_t, fresh)         /* 1: the mean begins with this frame */                                             \
    WORD(float, share)            /* of this frame in the mean */                                                      \
    WORD(float, ray_offset)                                                                                            \
    WORD(uint32_t, tiles_x)                                                                                            \
    WORD(uint32_t, tile_words) /* lists, influence: of each tile in scratch; and where what comes after them is */     \
    WORD(uint32_t, pixels_at)                                                                                          \
    WORD(uint32_t, found_bins)                                                                                         \
    WORD(uint32_t, pool_room) /* influence: lights that the pool of a band has room for */                             \
    WORD(uint32_t, list_flags)                                                                                         \
    WORD(uint32_t, list_room)     /* entries of a list at most */                                                      \
    WORD(uint32_t, observed_rows) /* that there is room for */                                                         \
    WORD(uint32_t, cells)         /* of the visibility cache, and its time */                                          \
    WORD(uint32_t, learn_time)

#define VK_VIEW_RAYS 1u
#define VK_VIEW_DENSITY 2u
#define VK_VIEW_LUX 4u
#define VK_VIEW_GROUP 8u
#define VK_VIEW_PLACED 16u
#define VK_VIEW_EMITTERS 32u
#define VK_VIEW_TRIANGLES 64u
#define VK_VIEW_LIGHTS 128u
#define VK_VIEW_EXPECTED 256u
#define VK_NO_TRIANGLE 0xffffffffu

#define VK_ANSWER_NONE 0u   /* of a ray: there is none */
#define VK_ANSWER_WANTED 1u /* to be traced; afterwards: something is in the way */
#define VK_ANSWER_CLEAR 2u  /* nothing is in the way */

#if !defined(CORE_GLSL)
/* An entry of the TLAS: what its gl_InstanceCustomIndexEXT stands for. */
struct vk_entry {
    uint64_t order;    /* address of the scene's triangle numbers, by gl_PrimitiveID */
    uint32_t instance; /* whose motion is known; 0xffffffff: the world, and bodies of lamps */
    uint32_t placed;   /* record of the instance or body; 0xffffffff: the world */
};

typedef struct vk_instance_record vk_instance_record;
typedef struct vk_pane_record vk_pane_record;
typedef struct vk_entry vk_entry;
RECORD_SIZE(vk_instance_record, 13);
RECORD_SIZE(vk_pane_record, 2);
RECORD_SIZE(vk_entry, 4);

#define VK_ADDRESS_FIELD(type, name) uint64_t name;
#define VK_WORD_FIELD(type, name) type name;
typedef struct vk_binding {
    VK_BINDING(VK_ADDRESS_FIELD, VK_WORD_FIELD)
} vk_binding;
#endif

#endif
