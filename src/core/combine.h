/* core/combine.h: a pixel's combination of reservoirs by the rules of core/reuse.h.
 *
 * A machine gathers k neighbours and, for each pixel, calls reuse_begin, then reuse_target for each neighbour, traces
 * the rays that reuse_asks for, from the neighbour to the sample held, and calls reuse_end. Includers supply FRAME and
 * what they have gathered:
 *
 *     neighbour_on(CTX i)       there is one: it is on a surface like the pixel's
 *     neighbour_resv(CTX i)     its reservoir, of m = w = 0 where there is none
 *     neighbour_surf(CTX i)     its surface, as its own camera saw it
 *     neighbour_answer(CTX i)   reuse_answer: target of the sample held at neighbour i
 *
 * With bias rays (FRAME_BIAS_RAYS) a reservoir's target includes visibility at its own pixel: every reservoir that is
 * reused has either an unoccluded sample or W = 0. Then a neighbour's p_j needs one shadow ray from the neighbour;
 * visibility at the receiving pixel need not be in the weights, since a sample that is occluded there counts as nothing
 * whatever its weight. Without bias rays the targets are unshadowed: unbiased without visibility reuse, biased with. */
#ifndef CORE_COMBINE_H
#define CORE_COMBINE_H

#include "core/frame.h"
#include "core/reuse.h"

/* What survives. own: it is the pixel's own sample, so what was known of its visibility still holds. */
struct combined {
    reservoir r;
    mask own;
};

#ifndef CORE_GLSL
typedef struct combined combined;
#endif
FN mask neighbour_on(CTX int i);
FN reservoir neighbour_resv(CTX int i);
FN surf neighbour_surf(CTX int i);
FN real neighbour_answer(CTX int i);

/* The choice of neighbour i, and of the pixel's own sample. dim: DIM_TEMPORAL, or DIM_SPATIAL + 64 a pass. */
FN real reuse_choice(u32 key, u32 dim, int i) { return rng(key, dim + KU(3u * U32(i) + 2u)); }
FN real reuse_own_choice(u32 key, u32 dim) { return rng(key, dim + KU(3u * U32(MAX_NEIGHBOURS))); }

/* Neighbour i's target at the pixel. */
FN real reuse_offered(CTX surf s, reservoir q) {
    mask has = q.w > K(0.0f);
    real p = K(0.0f);
    if (ANY(has))
        p = sel(has, target(PASS s, light_load(PASS q.light), q.u, q.v), K(0.0f));
    return p;
}

/* The sample that neighbours are asked about: pairwise the pixel's own, else one that is chosen among all by 1/M. The
 * tag is 0 for the pixel's own, i + 1 for neighbour i's. */
FN reservoir_builder reuse_begin(CTX surf s, reservoir own, u32 key, u32 dim, int k) {
    if (FRAME.bias == BIAS_PAIRWISE) {
        reservoir_builder held = builder_empty();
        held.light = own.light;
        held.u = own.u;
        held.v = own.v;
        held.p = own.p;
        held.w_sum = own.w;
        held.m = own.m;
        return held;
    }
    EXACT real w_own = own.m * own.p * own.w;
    reservoir_builder st = builder_add(builder_empty(), own.light, own.u, own.v, own.p, w_own, own.m, K(0.0f), K(0.0f));
    for (int i = 0; i < k; i++) {
        reservoir q = neighbour_resv(PASS i);
        real p = reuse_offered(PASS s, q);
        EXACT real w = q.m * p * q.w;
        st = builder_add(st, q.light, q.u, q.v, p, w, q.m, K(F32(i + 1)), reuse_choice(key, dim, i));
    }
    return st;
}

/* Target of the sample held at neighbour i, unshadowed. l: its light as it was when the neighbour's reservoir was made.
 */
FN real reuse_target(CTX int i, reservoir_builder held, light l) {
    mask on = neighbour_on(PASS i);
    real p = K(0.0f);
    if (ANY(on))
        p = sel(on, target(PASS neighbour_surf(PASS i), l, held.u, held.v), K(0.0f));
    return p;
}

/* Is a ray from neighbour i to the sample held wanted? The neighbour that a sample came from sees it. p: reuse_target.
 */
FN mask reuse_asks(reservoir_builder held, int i, real p) {
    return and_(held.w_sum > K(0.0f), and_(held.tag != K(F32(i + 1)), p > K(0.0f)));
}

/* What the answer makes of the target. */
FN real reuse_answer(real p, mask asked, mask clear) { return sel(and_(asked, not_(clear)), K(0.0f), p); }

FN combined reuse_pairwise(CTX surf s, reservoir own, u32 key, u32 dim, int k) {
    real m_n = K(0.0f);
    for (int i = 0; i < k; i++)
        m_n = m_n + neighbour_resv(PASS i).m;
    real inv = mis_scale(K(1.0f), m_n);
    real m_c = sel(m_n > K(0.0f), K(0.0f), K(1.0f));
    reservoir_builder st = builder_empty();
    for (int i = 0; i < k; i++) {
        reservoir q = neighbour_resv(PASS i);
        EXACT real share = q.m * inv;
        m_c = m_c + pair_canonical(share, m_n, neighbour_answer(PASS i), own.m, own.p);
        real p = reuse_offered(PASS s, q);
        real w = sel(q.w > K(0.0f), pair_weight(share, m_n, q.p, own.m, p, q.w), K(0.0f));
        st = builder_add(st, q.light, q.u, q.v, p, w, q.m, K(F32(i + 1)), reuse_choice(key, dim, i));
    }
    st = builder_add(st, own.light, own.u, own.v, own.p, m_c * own.p * own.w, own.m, K(0.0f),
                     reuse_own_choice(key, dim));
    combined c;
    c.r = builder_end(st, K(1.0f));
    c.own = st.tag == K(0.0f);
    return c;
}

/* The balance rule's, or by 1/M. */
FN combined reuse_weighed(CTX reservoir own, reservoir_builder held, int k) {
    real source = K(1.0f);
    real all = held.m;
    if (FRAME.bias == BIAS_MIS) {
        source = held.p;
        EXACT real mine = own.m * held.p;
        all = mine;
        for (int i = 0; i < k; i++) {
            real p = neighbour_answer(PASS i);
            EXACT real sum = all + neighbour_resv(PASS i).m * p;
            all = sum;
            source = sel(held.tag == K(F32(i + 1)), p, source);
        }
    }
    combined c;
    c.r = builder_end(held, mis_scale(source, all));
    c.own = held.tag == K(0.0f);
    return c;
}

FN combined reuse_end(CTX surf s, reservoir own, reservoir_builder held, u32 key, u32 dim, int k) {
    if (FRAME.bias == BIAS_PAIRWISE)
        return reuse_pairwise(PASS s, own, key, dim, k);
    return reuse_weighed(PASS own, held, k);
}

#endif
