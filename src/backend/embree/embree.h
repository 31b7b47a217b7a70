/* Embree behind the tracer's table: one device, shared by the structures of all scenes. */
#ifndef NOC_EMBREE_H
#define NOC_EMBREE_H

#include "backend/cpu/tracer.h"
#include "backend/embree/rt.h"
#include "backend/parts.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/types.h>

typedef struct embree_structure embree_structure;

typedef struct embree_device {
    noc_log *log;
    RTCDevice device;
    int threads;
    pthread_mutex_t lock;      /* held while a structure is built or released */
    embree_structure *current; /* that one: Embree tells errors and memory a device, not a scene */
} embree_device;

/* Surfaces that block light, and those that let it through, are traced one after the other: the first as if there were
 * no others. */
typedef enum embree_layer { LAYER_SOLID, LAYER_THROUGH, LAYERS } embree_layer;

typedef struct embree_part {
    noc_part of;
    RTCScene rtc[LAYERS];              /* LAYER_THROUGH: NULL where there is none */
    NOC_ARRAY(uint32_t) first[LAYERS]; /* of each geometry of rtc, its first triangle in the scene */
    int holders;
} embree_part;

typedef NOC_ARRAY(embree_part *) embree_parts;

/* The scene at one time: the world's first part is traced by itself, all else as instances in a structure above. */
typedef struct embree_above {
    embree_part *part;
    uint32_t instance; /* NO_INSTANCE: a later part of the world */
} embree_above;

typedef struct embree_generation {
    embree_part *base;
    RTCScene top[LAYERS];                  /* NULL: there is nothing but the base's */
    NOC_ARRAY(embree_above) above[LAYERS]; /* by geometry of top */
} embree_generation;

struct embree_structure {
    embree_device *device;
    const noc_scene *scene;
    embree_generation now, past;  /* past: NULLs before the scene has changed */
    embree_parts world;           /* parts of it in the order of their meshes; the first is now's base */
    embree_parts models;          /* NULL for those that no instance or body has shown */
    RTCScene bodies;              /* of lamps; NULL: there are none */
    uint64_t geometry, instances; /* versions of the scene that `now` knows */
    _Atomic ssize_t bytes;        /* held by Embree */
    atomic_bool refused;          /* memory that it asked for */
    noc_status failed;            /* first error of the last build, which has been told */
};

/* structure.c: while the structure is the device's current one */
noc_status noc_embree_follow(embree_structure *s);
void noc_embree_release_parts(embree_structure *s);
/* embree.c */
noc_status noc_embree_fail(embree_structure *s, enum RTCError code, const char *text);

RTCScene noc_embree_new_scene(embree_structure *s); /* NULL after reporting */
/* bodies.c: of models that are built. false after reporting. */
bool noc_embree_build_bodies(embree_structure *s);

/* room.c */
/* Is there memory for a block of so many bytes, and all that TBB may take beside it? threads: of a build. */
bool noc_embree_room(int threads, size_t bytes);
/* Can TBB's threads be started? */
bool noc_embree_room_for_threads(int threads);
/* A packet of a block's rays, numbered by their lanes. */
static inline void embree_fill_rays(const rayblock *rays, float far, struct RTCRay16 *r) {
    memcpy(r->org_x, rays->o, sizeof(rays->o));
    memcpy(r->dir_x, rays->d[0], sizeof(rays->d[0]));
    memcpy(r->dir_y, rays->d[1], sizeof(rays->d[1]));
    memcpy(r->dir_z, rays->d[2], sizeof(rays->d[2]));
    for (unsigned l = 0; l < BLOCK; l++) {
        r->tnear[l] = r->time[l] = 0;
        r->tfar[l] = far;
        r->mask[l] = UINT32_MAX;
        r->id[l] = l;
        r->flags[l] = 0;
    }
}

/* through.c: filters of geometries whose surfaces let light through. first: their first triangle in the scene. */
void noc_embree_let_through(RTCGeometry geometry, size_t first);
/* Finds hits nearer than those that h has, of rays as embree_fill_rays numbers them. chance: as noc_tracer.closest. */
void noc_embree_meet(RTCScene scene, const noc_scene *of, const int *valid, const uint32_t *chance,
                     struct RTCRayHit16 *h);
/* Multiplies `through` by what the scene lets through of each segment. */
void noc_embree_trace_through(RTCScene scene, const noc_scene *of, const rayblock *rays, uint32_t valid,
                              float through[BLOCK]);
/* many.c: noc_tracer.occluded. Segments that lead to one light are traced side by side, the others as a stream
 * (bench/bench_rays has the gain). */
void noc_embree_trace_many(RTCScene scene, shadow_block *blocks, int count);

#endif
