/* core/reservoir.h: weighted reservoir sampling and resampled importance sampling (Talbot et al. 2005; Bitterli et al.
 * 2020, Algorithms 2 to 6). Includers supply the bridge light_load(CTX i). */
#ifndef CORE_RESERVOIR_H
#define CORE_RESERVOIR_H

#include "core/random.h"
#include "core/surface.h"

/* What survives a pass: a sample, its unbiased contribution weight W, and how many candidates stand behind it. */
struct reservoir {
    u32 light;
    real u;
    real v;
    real w; /* W; 0: no sample */
    real m; /* M */
    real p; /* p_hat of the sample at its own pixel, unshadowed */
};

/* A reservoir being filled. */
struct reservoir_builder {
    u32 light;
    real u;
    real v;
    real p; /* target of the sample held */
    real w_sum;
    real m;
    real tag; /* whatever the caller wants to remember of the sample held */
};

#ifndef CORE_GLSL
typedef struct reservoir reservoir;
typedef struct reservoir_builder reservoir_builder;
FN light light_load(CTX u32 i); /* static inline where it is defined, so that wide code pays for what it uses only */
#endif

FN reservoir_builder builder_empty(void) {
    reservoir_builder s;
    s.light = KU(0u);
    s.u = K(0.5f);
    s.v = K(0.5f);
    s.p = K(0.0f);
    s.w_sum = K(0.0f);
    s.m = K(0.0f);
    s.tag = K(0.0f);
    return s;
}

FN reservoir reservoir_empty(void) {
    reservoir r;
    r.light = KU(0u);
    r.u = K(0.5f);
    r.v = K(0.5f);
    r.w = K(0.0f);
    r.m = K(0.0f);
    r.p = K(0.0f);
    return r;
}

FN reservoir reservoir_sel(mask c, reservoir a, reservoir b) {
    reservoir r;
    r.light = selu(c, a.light, b.light);
    r.u = sel(c, a.u, b.u);
    r.v = sel(c, a.v, b.v);
    r.w = sel(c, a.w, b.w);
    r.m = sel(c, a.m, b.m);
    r.p = sel(c, a.p, b.p);
    return r;
}

/* Offers a sample of resampling weight w >= 0 that stands for m candidates; xi in [0, 1). */
FN reservoir_builder builder_add(reservoir_builder s, u32 id, real u, real v, real p, real w, real m, real tag,
                                 real xi) {
    EXACT real sum = s.w_sum + w;
    mask take = xi * sum < w;
    s.w_sum = sum;
    s.light = selu(take, id, s.light);
    s.u = sel(take, u, s.u);
    s.v = sel(take, v, s.v);
    s.p = sel(take, p, s.p);
    s.tag = sel(take, tag, s.tag);
    s.m = s.m + m;
    return s;
}

/* W = scale * w_sum / p_hat. */
FN reservoir builder_end(reservoir_builder s, real scale) {
    reservoir r;
    r.light = s.light;
    r.u = s.u;
    r.v = s.v;
    r.m = s.m;
    r.p = s.p;
    mask held = s.p > K(0.0f);
    EXACT real w = scale * s.w_sum / sel(held, s.p, K(1.0f));
    r.w = sel(and_(held, w < K(1e30f)), w, K(0.0f));
    return r;
}

#endif
