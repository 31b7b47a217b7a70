/* Embree 3.13 and 4 behind the same few calls. */
#ifndef NOC_EMBREE_RT_H
#define NOC_EMBREE_RT_H

#include "noc_config.h"

#if NOC_EMBREE >= 4
#include <embree4/rtcore.h>

static inline void rt_intersect16(const int *valid, RTCScene scene, struct RTCRayHit16 *rays) {
    struct RTCIntersectArguments args;
    rtcInitIntersectArguments(&args);
    args.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, scene, rays, &args);
}

static inline void rt_occluded16(const int *valid, RTCScene scene, struct RTCRay16 *rays) {
    struct RTCOccludedArguments args;
    rtcInitOccludedArguments(&args);
    rtcOccluded16(valid, scene, rays, &args);
}

#else
#include <embree3/rtcore.h>

static inline void rt_intersect16(const int *valid, RTCScene scene, struct RTCRayHit16 *rays) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, rays);
}

static inline void rt_occluded16(const int *valid, RTCScene scene, struct RTCRay16 *rays) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, rays);
}
#endif

#endif
