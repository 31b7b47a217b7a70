/* The seam to what traces rays for the CPU: one table a ray tracing library. Rays come and go in blocks of 16. */
#ifndef NOC_CPU_TRACER_H
#define NOC_CPU_TRACER_H

#include "core/blocks.h"
#include "scene/scene.h"

enum { MANY_BLOCKS = 32 }; /* whose segments are traced together */

/* Segments of 16 pixels to be traced together with those of other blocks. */
typedef struct shadow_block {
    rayblock rays;
    uint32_t light[BLOCK];      /* what each leads to: any number will do, equal ones are traced together */
    uint32_t valid, unoccluded; /* lanes to be traced; those of them that nothing blocks */
    float *counts;              /* of the block's pixels, for the AOV that counts rays, or NULL */
} shadow_block;

/* Nearest hits. */
typedef struct hitblock {
    ALIGNED uint32_t triangle[BLOCK]; /* of the scene; NO_HIT */
    uint32_t instance[BLOCK];         /* that shows the triangle: as noc_placed_transform numbers them; NO_INSTANCE */
    float u[BLOCK], v[BLOCK];         /* barycentric, of the second and the third corner */
    float t[BLOCK];                   /* along the ray's direction, in its lengths */
} hitblock;
#define NO_HIT UINT32_MAX

/* What rays are traced against. */
typedef enum noc_ray_world {
    NOC_RAYS_NOW,      /* the scene as it is */
    NOC_RAYS_PAST,     /* as it was before the structure followed it last */
    NOC_RAYS_STANDING, /* what blocks light as long as nothing is removed: no instances but bodies, nothing that
                        * lets it through */
} noc_ray_world;

typedef struct noc_tracer {
    const char *name;
    /* threads: of builds. *device is only set on success; errors are reported. */
    noc_status (*open)(int threads, noc_log *log, void **device);
    void (*close)(void *device);
    /* The ray tracing structure of a scene, which is not copied. */
    noc_status (*build)(void *device, const noc_scene *scene, noc_log *log, void **structure);
    void (*release)(void *structure);
    /* What has changed of the scene's meshes and instances; the structure is as it was where this fails. No ray is
     * traced meanwhile. */
    noc_status (*follow)(void *structure);
    size_t (*bytes)(const void *structure);
    /* coherent: the rays are a camera's. far: tfar of all rays. chance: a key a ray, by which it passes surfaces that
     * let light through (core/through.h); NULL: it meets them all but for their holes. */
    void (*closest)(void *structure, noc_ray_world in, const rayblock *rays, float far, uint32_t valid, bool coherent,
                    const uint32_t *chance, hitblock *hits);
    /* Sets `unoccluded` of up to MANY_BLOCKS blocks. Surfaces that let light through block nothing. */
    void (*occluded)(void *structure, noc_ray_world in, shadow_block *blocks, int count);
    /* Transmittance of unoccluded segments of the scene as it is. False, and nothing is written: no surface of it lets
     * light through. */
    bool (*through)(void *structure, const shadow_block *blocks, int count, float (*out)[BLOCK]);
} noc_tracer;

#endif
