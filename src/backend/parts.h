/* Which meshes of a scene are built into one ray tracing structure, and which structures an edit makes stale: the same
 * policy for every ray tracer.
 *
 * The world is a few parts, each a run of meshes. The first part is what was there at first. Meshes that are added
 * later become a part of their own; parts are joined while one is not twice as large as the next, so there are few. A
 * mesh that is removed makes the part stale that it is in. A model is one part. */
#ifndef NOC_PARTS_H
#define NOC_PARTS_H

#include "scene/scene.h"

typedef struct noc_part {
    size_t first_mesh, end_mesh;      /* of the scene; meshes of other models among them are not its own */
    size_t meshes, triangles, newest; /* its own that are not removed; the greatest `made` of them */
} noc_part;

/* Returns true if rays meet the mesh in a part of that model (0: the world). */
bool noc_part_has(const noc_scene *scene, const noc_scene_mesh *mesh, uint32_t model);
/* Sets meshes, triangles and newest to what the scene has now. */
void noc_part_count(const noc_scene *scene, uint32_t model, noc_part *part);
/* Plans the world's parts: out has room for count + 1. keep[i] is set where out[i] is have[i] unchanged. Returns how
 * many there are, at least 1. */
size_t noc_parts_plan(const noc_scene *scene, const noc_part *have, size_t count, noc_part *out, bool *keep);

/* How far shadow rays stand off surfaces at least (core/shadow.h), which follows the largest coordinate that rays meet.
 * Zero-initialise. */
typedef struct noc_ray_scale {
    size_t vertices; /* of the scene that are known */
    uint32_t made;   /* last version of geometry that is known */
    float largest;   /* coordinate */
    float offset;    /* m */
} noc_ray_scale;

/* Takes in what is new in the scene. It stays as it is where something is removed. */
void noc_ray_scale_follow(const noc_scene *scene, noc_ray_scale *scale);

#endif
