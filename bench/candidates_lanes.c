/* The bench's candidate loop for one instruction set: NAME is the function, CORE_LANES the width (none: scalar). */
#include "candidates.h"

#include "core/light.h"
#include "core/wide_load.h"

struct core_context {
    const candidates_job *job;
    int layout;
};

FN real load(const float *from, size_t at) {
    real r;
    memcpy(&r, from + at, sizeof(r));
    return r;
}

FN real gather(const float *from, u32 index) {
#if !defined(CORE_LANES)
    return from[index];
#elif CORE_LANES == 16 && defined(__AVX512F__)
    return (real)_mm512_i32gather_ps((__m512i)index, from, 4);
#elif CORE_LANES == 8 && defined(__AVX2__)
    return (real)_mm256_i32gather_ps(from, (__m256i)index, 4);
#else
    real r;
    for (int i = 0; i < LANES; i++)
        r[i] = from[index[i]];
    return r;
#endif
}

FN u32 as_u32(real r) {
    u32 u;
    memcpy(&u, &r, sizeof(u));
    return u;
}

FN light light_load(CTX u32 i) {
    if (ctx->layout != LAYOUT_SOA)
        return light_from_records(ctx->job->records, i);
    const float *const *f = ctx->job->soa;
    light l;
    l.p = V3(gather(f[0], i), gather(f[1], i), gather(f[2], i));
    l.kind = as_u32(gather(f[3], i));
    l.a = V3(gather(f[4], i), gather(f[5], i), gather(f[6], i));
    l.radius = gather(f[7], i);
    l.b = V3(gather(f[8], i), gather(f[9], i), gather(f[10], i));
    l.flags = as_u32(gather(f[11], i));
    l.e = V3(gather(f[12], i), gather(f[13], i), gather(f[14], i));
    l.area = gather(f[15], i);
    return l;
}

#include "../tests/core/no_profiles.h"
#include "../tests/core/ris_uniform.h"

static inline __attribute__((always_inline)) uint64_t run(const candidates_job *job, int layout) {
    struct core_context ctx = { job, layout };
    uint64_t sum = 0;
    for (uint32_t first = 0; first < job->surface_count; first += LANES) {
        surf s;
        const float *const *f = job->surfaces;
        s.p = V3(load(f[0], first), load(f[1], first), load(f[2], first));
        s.n = V3(load(f[3], first), load(f[4], first), load(f[5], first));
        s.wo = V3(load(f[6], first), load(f[7], first), load(f[8], first));
        s.albedo = V3(load(f[9], first), load(f[10], first), load(f[11], first));
        s.f0 = load(f[12], first);
        s.alpha = K(0.3f);
        uint32_t pixel[LANES];
        for (int i = 0; i < LANES; i++)
            pixel[i] = first + (uint32_t)i;
        u32 lane;
        memcpy(&lane, pixel, sizeof(lane));
        u32 key = rng_key(KU(1u), lane, KU(0u));
        reservoir r = ris_uniform(&ctx, s, key, KU(job->lights), job->m);
        uint32_t id[LANES], w[LANES];
        memcpy(id, &r.light, sizeof(id));
        memcpy(w, &r.w, sizeof(w));
        for (int i = 0; i < LANES; i++)
            sum += (uint64_t)id[i] * 2654435761u + w[i];
    }
    return sum;
}

uint64_t NAME(const candidates_job *job, int layout) {
    return layout == LAYOUT_SOA ? run(job, LAYOUT_SOA) : run(job, LAYOUT_RECORDS);
}
