/* Surfaces that let light through. Embree calls a filter at each hit on one. `meet` decides whether a camera's ray
 * stops there; `pass` multiplies a shadow ray's transmittance and lets it go on. Hits come in any order, and each
 * triangle once: a build of medium quality splits none. */
#include "backend/embree/embree.h"

struct core_context {
    const uint32_t *texels;
};

#include "core/through.h"

FN u32 texel_load(CTX u32 place) { return ctx->texels[place]; }

typedef struct passing {
    rt_context context; /* first */
    const noc_scene *scene;
    const uint32_t *chance;
    float *through;
} passing;

/* Of the surface at that place of the scene's triangle. */
static float transmittance(const noc_scene *scene, size_t triangle, float u, float v) {
    const noc_material *m = &scene->materials.data[scene->triangle_material.data[triangle]];
    float at[3][2];
    if (!m->cutout || !noc_scene_image_corners(scene, triangle, at))
        return m->transmittance;
    struct core_context ctx = { scene->texels.data };
    float x = image_at((v3){ at[0][0], at[1][0], at[2][0] }, u, v);
    float y = image_at((v3){ at[0][1], at[1][1], at[2][1] }, u, v);
    return texture_hole(&ctx, scene->textures.data[m->texture - 1].place, x, y) ? 1 : m->transmittance;
}

/* Packets lie field by field; Embree has these functions for C++ alone. */
enum { RAY_ID = 10, HIT_U = 3, HIT_V = 4, HIT_TRIANGLE = 5 };
_Static_assert(offsetof(struct RTCRay, id) == 4 * RAY_ID && offsetof(struct RTCHit, u) == 4 * HIT_U &&
                   offsetof(struct RTCHit, v) == 4 * HIT_V && offsetof(struct RTCHit, primID) == 4 * HIT_TRIANGLE,
               "Embree's fields lie in that order");

static uint32_t word(const void *packet, int field, const struct RTCFilterFunctionNArguments *a, unsigned i) {
    return ((const uint32_t *)packet)[(size_t)field * a->N + i];
}

static float number(const void *packet, int field, const struct RTCFilterFunctionNArguments *a, unsigned i) {
    return ((const float *)packet)[(size_t)field * a->N + i];
}

static float transmittance_at(const struct RTCFilterFunctionNArguments *a, const passing *p, unsigned i,
                              uint32_t *triangle) {
    *triangle = (uint32_t)(uintptr_t)a->geometryUserPtr + word(a->hit, HIT_TRIANGLE, a, i);
    return transmittance(p->scene, *triangle, number(a->hit, HIT_U, a, i), number(a->hit, HIT_V, a, i));
}

static void meet(const struct RTCFilterFunctionNArguments *a) {
    const passing *p = (const passing *)a->context;
    for (unsigned i = 0; i < a->N; i++) {
        uint32_t triangle;
        if (!a->valid[i])
            continue;
        float t = transmittance_at(a, p, i, &triangle);
        bool met = t < 1 && (!p->chance || ray_meets(p->chance[word(a->ray, RAY_ID, a, i)], triangle, t));
        a->valid[i] = met ? -1 : 0;
    }
}

static void pass(const struct RTCFilterFunctionNArguments *a) {
    const passing *p = (const passing *)a->context;
    for (unsigned i = 0; i < a->N; i++) {
        uint32_t triangle;
        if (!a->valid[i])
            continue;
        p->through[word(a->ray, RAY_ID, a, i)] *= transmittance_at(a, p, i, &triangle);
        a->valid[i] = 0;
    }
}

void noc_embree_let_through(RTCGeometry geometry, size_t first) {
    rtcSetGeometryUserData(geometry, (void *)(uintptr_t)first); // NOLINT(performance-no-int-to-ptr)
    rtcSetGeometryIntersectFilterFunction(geometry, meet);
    rtcSetGeometryOccludedFilterFunction(geometry, pass);
}

void noc_embree_meet(RTCScene scene, const noc_scene *of, const int *valid, const uint32_t *chance,
                     struct RTCRayHit16 *h) {
    passing p = { .scene = of, .chance = chance };
    rt_intersect16_in(&p.context, valid, scene, h, false);
}

void noc_embree_trace_through(RTCScene scene, const noc_scene *of, const rayblock *rays, uint32_t valid,
                              float through[BLOCK]) {
    passing p = { .scene = of, .through = through };
    ALIGNED int lanes[BLOCK];
    ALIGNED struct RTCRay16 r;
    for (int l = 0; l < BLOCK; l++)
        lanes[l] = -(int)(valid >> l & 1);
    embree_fill_rays(rays, 1, &r);
    rt_occluded16_in(&p.context, lanes, scene, &r);
}
