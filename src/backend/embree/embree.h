/* Embree behind the tracer's table: one device, shared by the structures of all scenes. */
#ifndef NOC_EMBREE_H
#define NOC_EMBREE_H

#include "backend/cpu/tracer.h"
#include "backend/embree/rt.h"

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

struct embree_structure {
    embree_device *device;
    const noc_scene *scene;
    RTCScene rtc;
    _Atomic ssize_t bytes; /* held by Embree */
    atomic_bool refused;   /* memory that it asked for */
    noc_status failed;     /* its first error, which has been told */
};

/* room.c */
/* Is there memory for a block of so many bytes, and all that TBB may take beside it? threads: of a build. */
bool noc_embree_room(int threads, size_t bytes);
/* Can TBB's threads be started? */
bool noc_embree_room_for_threads(int threads);
/* many.c: noc_tracer.occluded. Segments that lead to one light are traced side by side, the others as a stream
 * (bench/bench_rays has the gain). */
void noc_embree_trace_many(RTCScene scene, segment_block *blocks, int count);

#endif
