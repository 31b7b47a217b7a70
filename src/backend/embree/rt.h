/* Embree 3.13 and 4 behind the same few calls.
 *
 * Shadow rays never ask for coherent traversal, though packets to one light would gain by it in open streets:
 * rtcOccluded16 of 3.13.5 then never returned from a packet of ordinary rays (compact structure, the built-in city). */
#ifndef NOC_EMBREE_RT_H
#define NOC_EMBREE_RT_H

#include "noc_config.h"

/* A context of a query: filters of geometries are handed it back, and find what else their caller put behind it in a
 * struct that begins with one. */
#if NOC_EMBREE >= 4
#include <embree4/rtcore.h>

typedef struct RTCRayQueryContext rt_context;

/* coherent: all rays go about the same way. */
static inline void rt_intersect16_in(rt_context *context, const int *valid, RTCScene scene, struct RTCRayHit16 *rays,
                                     bool coherent) {
    struct RTCIntersectArguments args;
    rtcInitRayQueryContext(context);
    rtcInitIntersectArguments(&args);
    args.context = context;
    args.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, rays, &args);
}

static inline void rt_intersect1(RTCScene scene, struct RTCRayHit *ray) { rtcIntersect1(scene, ray, NULL); }

static inline void rt_occluded1(RTCScene scene, struct RTCRay *ray) { rtcOccluded1(scene, ray, NULL); }

static inline void rt_occluded16_in(rt_context *context, const int *valid, RTCScene scene, struct RTCRay16 *rays) {
    struct RTCOccludedArguments args;
    rtcInitRayQueryContext(context);
    rtcInitOccludedArguments(&args);
    args.context = context;
    rtcOccluded16(valid, scene, rays, &args);
}

#else
#include <embree3/rtcore.h>

typedef struct RTCIntersectContext rt_context;

/* coherent: all rays go about the same way. */
static inline void rt_intersect16_in(rt_context *context, const int *valid, RTCScene scene, struct RTCRayHit16 *rays,
                                     bool coherent) {
    rtcInitIntersectContext(context);
    context->flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, context, rays);
}

static inline void rt_intersect1(RTCScene scene, struct RTCRayHit *ray) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray);
}

static inline void rt_occluded1(RTCScene scene, struct RTCRay *ray) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, ray);
}

static inline void rt_occluded16_in(rt_context *context, const int *valid, RTCScene scene, struct RTCRay16 *rays) {
    rtcInitIntersectContext(context);
    rtcOccluded16(valid, scene, context, rays);
}

/* Rays of no common direction, all at once: Embree 3 takes them down its tree together, which is a third faster than
 * packets of 16 once there are a hundred or so (bench/bench_rays). Embree 4 has no such call. */
#define RT_STREAMS 1
static inline void rt_occluded_stream(RTCScene scene, struct RTCRay *rays, unsigned count) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1M(scene, &context, rays, count, sizeof(*rays));
}
#endif

static inline void rt_intersect16(const int *valid, RTCScene scene, struct RTCRayHit16 *rays, bool coherent) {
    rt_context context;
    rt_intersect16_in(&context, valid, scene, rays, coherent);
}

static inline void rt_occluded16(const int *valid, RTCScene scene, struct RTCRay16 *rays) {
    rt_context context;
    rt_occluded16_in(&context, valid, scene, rays);
}

#endif
