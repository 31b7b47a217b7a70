/* Bodies of lamps as one geometry. Embree's own instances cost 385 bytes each; a primitive of a user geometry costs
 * some 90, and is as fast (docs/measurements.md). Embree calls back where a ray enters a body's box, and the ray is
 * traced in the coordinates of its model. Bodies never change, so the structure is built once. */
#include "backend/embree/embree.h"

#include <math.h>

/* Fields of rays and hits in packets, which lie field by field. */
enum { ORIGIN, NEAR = 3, DIRECTION, FAR = 8, HIT_U = 15, HIT_V, HIT_TRIANGLE, HIT_GEOMETRY, HIT_INSTANCE };
_Static_assert(offsetof(struct RTCRayHit, ray.tnear) == 4 * NEAR &&
                   offsetof(struct RTCRayHit, ray.dir_x) == 4 * DIRECTION &&
                   offsetof(struct RTCRayHit, ray.tfar) == 4 * FAR && offsetof(struct RTCRayHit, hit.u) == 4 * HIT_U &&
                   offsetof(struct RTCRayHit, hit.instID) == 4 * HIT_INSTANCE,
               "Embree's fields lie in that order");

static void bounds(const struct RTCBoundsFunctionArguments *a) {
    const noc_scene *scene = ((const embree_structure *)a->geometryUserPtr)->scene;
    const noc_scene_body *b = &scene->bodies.data[a->primID];
    const noc_scene_model *model = &scene->models.data[b->model - 1];
    double lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    noc_join_body_box(b, model, lo, hi);
    float *out = &a->bounds_o->lower_x;
    for (int k = 0; k < 3; k++) { /* rays are turned in floats */
        double slack = 0x1p-20 * (1 + fmax(fabs(lo[k]), fabs(hi[k])));
        out[k] = (float)(lo[k] - slack);
        out[4 + k] = (float)(hi[k] + slack);
    }
}

/* Lane i of a packet of n rays, in the coordinates of a body's model. */
static void turn_ray(const noc_scene_body *b, const float *packet, unsigned n, unsigned i, struct RTCRay *r) {
    const float c = b->facing[0], s = b->facing[1];
    float x = packet[ORIGIN * n + i] - b->p[0], y = packet[(ORIGIN + 1) * n + i] - b->p[1];
    float dx = packet[DIRECTION * n + i], dy = packet[(DIRECTION + 1) * n + i];
    *r = (struct RTCRay){ .org_x = c * x + s * y,
                          .org_y = c * y - s * x,
                          .org_z = packet[(ORIGIN + 2) * n + i] - b->p[2],
                          .dir_x = c * dx + s * dy,
                          .dir_y = c * dy - s * dx,
                          .dir_z = packet[(DIRECTION + 2) * n + i],
                          .tnear = packet[NEAR * n + i],
                          .tfar = packet[FAR * n + i],
                          .mask = UINT32_MAX };
}

static void put_word(float *packet, int field, unsigned n, unsigned i, uint32_t word) {
    memcpy(packet + (size_t)field * n + i, &word, sizeof(word));
}

static void intersect(const struct RTCIntersectFunctionNArguments *a) {
    const embree_structure *s = a->geometryUserPtr;
    const noc_scene_body *b = &s->scene->bodies.data[a->primID];
    RTCScene model = s->models.data[b->model - 1]->rtc[LAYER_SOLID];
    float *packet = (float *)a->rayhit;
    for (unsigned i = 0; i < a->N; i++) {
        struct RTCRayHit h = { .hit.geomID = RTC_INVALID_GEOMETRY_ID, .hit.instID[0] = RTC_INVALID_GEOMETRY_ID };
        if (!a->valid[i])
            continue;
        turn_ray(b, packet, a->N, i, &h.ray);
        rt_intersect1(model, &h);
        if (h.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            continue;
        packet[FAR * a->N + i] = h.ray.tfar;
        packet[HIT_U * a->N + i] = h.hit.u;
        packet[HIT_V * a->N + i] = h.hit.v;
        put_word(packet, HIT_TRIANGLE, a->N, i, h.hit.primID);
        put_word(packet, HIT_GEOMETRY, a->N, i, h.hit.geomID);
        put_word(packet, HIT_INSTANCE, a->N, i, NOC_BODIES + a->primID);
    }
}

static void occlude(const struct RTCOccludedFunctionNArguments *a) {
    const embree_structure *s = a->geometryUserPtr;
    const noc_scene_body *b = &s->scene->bodies.data[a->primID];
    RTCScene model = s->models.data[b->model - 1]->rtc[LAYER_SOLID];
    float *packet = (float *)a->ray;
    for (unsigned i = 0; i < a->N; i++) {
        struct RTCRay r;
        if (!a->valid[i])
            continue;
        turn_ray(b, packet, a->N, i, &r);
        rt_occluded1(model, &r);
        if (r.tfar < 0)
            packet[FAR * a->N + i] = -INFINITY;
    }
}

bool noc_embree_build_bodies(embree_structure *s) {
    if (!(s->bodies = noc_embree_new_scene(s)))
        return false;
    RTCGeometry geometry = rtcNewGeometry(s->device->device, RTC_GEOMETRY_TYPE_USER);
    if (!geometry)
        return !noc_embree_fail(s, rtcGetDeviceError(s->device->device), "no geometry");
    rtcSetGeometryUserPrimitiveCount(geometry, (unsigned)s->scene->bodies.len);
    rtcSetGeometryUserData(geometry, s);
    rtcSetGeometryBoundsFunction(geometry, bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occlude);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(s->bodies, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(s->bodies);
    return !s->failed;
}
