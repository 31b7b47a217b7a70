/* The passes of a stage as dispatches: which shader runs over what, and what it reads and writes, so that barriers
 * follow from data. A pass with rays is three steps: `ask` writes segments, a ray tracing pipeline answers them, `use`
 * reads the answers. */
#ifndef NOC_VULKAN_SCHEDULE_H
#define NOC_VULKAN_SCHEDULE_H

#include "backend/vulkan/records.h"
#include "backend/vulkan/shaders.h"
#include "core/frame.h"
#include "render/plan.h"

/* What dispatches work on: a bit each. Reservoirs are told apart by their set. Counters are left out: invocations only
 * add to them. */
typedef enum vk_resource {
    VK_RESOURCE_SURFACES,
    VK_RESOURCE_PREVIOUS,
    VK_RESOURCE_SET, /* and the next NOC_RESERVOIR_SETS - 1 */
    VK_RESOURCE_COLOUR = VK_RESOURCE_SET + NOC_RESERVOIR_SETS,
    VK_RESOURCE_PICTURE,
    VK_RESOURCE_COVERAGE,
    VK_RESOURCE_RAYS,
    VK_RESOURCE_ANSWERS,
    VK_RESOURCE_THROUGH, /* transmittances on the way of rays */
    VK_RESOURCE_HITS,
    VK_RESOURCE_SAMPLES,
    VK_RESOURCE_SCRATCH,
    VK_RESOURCE_VIEWS,    /* what views gather */
    VK_RESOURCE_CACHE,    /* of the lights' visibility */
    VK_RESOURCE_OBSERVED, /* what it will learn */
    VK_RESOURCE_BRIGHT,
    VK_RESOURCE_COUNT
} vk_resource;

typedef enum vk_domain {
    VK_DOMAIN_PIXELS,
    VK_DOMAIN_RAYS,    /* of `slots` rays a pixel */
    VK_DOMAIN_SUBSETS, /* of candidates that blocks share: a work group each */
    VK_DOMAIN_TILES,   /* a work group each */
    VK_DOMAIN_BLOCKS,  /* 16 invocations each */
    VK_DOMAIN_LAYERS,  /* of pixels, one for each of `slots` rays */
    VK_DOMAIN_ROWS,    /* of observations */
    VK_DOMAIN_RUNS,    /* of cells of the visibility cache: 16 invocations each */
    VK_DOMAIN_ONE,     /* work group */
} vk_domain;

typedef struct vk_step {
    vk_shader shader;
    uint32_t reads, writes; /* bits 1 << vk_resource */
    vk_domain domain;
    int slots;          /* rays a pixel */
    int source, target; /* sets of reservoirs */
    uint32_t dimension; /* of reuse */
    uint32_t first;
    uint32_t first_row, rows; /* of blocks: its band of the picture; rows 0: all */
    bool band;                /* its rays are kept for the band alone */
    bool past;                /* rays are traced against the scene of the frame before */
    bool wait;                /* a barrier comes before it */
    noc_pass pass;
} vk_step;

/* What is known of a frame before it is recorded. */
typedef struct vk_facts {
    const frame_constants *constants;
    bool history; /* reservoirs of the frame before can be reused */
    bool past;    /* they were made with rays against the past scene */
    bool sky;     /* the sky, or a map, lights */
    bool given;   /* receivers are given */
    bool views;   /* shaders gather for views */
    bool panes;   /* surfaces let light through */
    uint32_t lights, blocks_x, blocks_y;
    uint32_t tile_words; /* lists: of a tile in scratch */
    size_t band_bytes;   /* that scratch and rays of a band may take */
} vk_facts;

typedef NOC_ARRAY(vk_step) vk_steps;

/* Appends the steps of a stage. False where memory is refused. */
bool noc_vk_schedule(const noc_plan *plan, const noc_stage *stage, const vk_facts *facts, vk_steps *steps);
/* Appends those that add the frame to the picture, and what it observed to what is learned. */
bool noc_vk_schedule_mean(const noc_plan *plan, const vk_facts *facts, vk_steps *steps);
/* Rays that any step has room for, and bytes of scratch that a band takes. */
size_t noc_vk_ray_room(const vk_steps *steps, const vk_facts *facts);
size_t noc_vk_scratch_bytes(const noc_plan *plan, const vk_facts *facts);

static inline size_t noc_vk_step_rays(const vk_step *s, uint32_t blocks_x, uint32_t blocks_y) {
    return (size_t)s->slots * blocks_x * (s->band ? s->rows : blocks_y) * BLOCK;
}
/* Words of a tile with lists from hierarchies of so many levels at most: list_memory.h. */
uint32_t noc_vk_tile_words(int levels);
static inline uint32_t noc_vk_tiles(uint32_t blocks) { return (blocks + 3) / 4; }

/* What was read and written since the last barrier. */
typedef struct vk_hazards {
    uint32_t read, written;
} vk_hazards;

/* Sets `wait` of a step that must wait for earlier ones. */
void noc_vk_find_wait(vk_hazards *hazards, vk_step *step);

#endif
