/* core/combine.h: a pixel's combination of reservoirs by the rules of core/reuse.h.
 *
 * A machine gathers k neighbours and, for each pixel, calls reuse_begin, then reuse_target for each neighbour that is
 * asked, traces the rays that reuse_asks for, from that neighbour to the sample held, and calls reuse_end. Pairwise one
 * neighbour is asked, which reuse_partner names for each pixel; else all are. Neighbour i is the i-th draw, and k the
 * number of draws, present or not: what a pixel gets depends on no other pixel. Includers supply FRAME and what they
 * have gathered:
 *
 *     neighbour_some(CTX i)     false only if no lane has it; then it is skipped, which changes no bit
 *     neighbour_on(CTX i)       there is one: it is on a surface like the pixel's
 *     neighbour_resv(CTX i)     its reservoir, of m = w = 0 where there is none
 *     neighbour_resv_of(CTX i)  the same, of a number that differs from pixel to pixel
 *     neighbour_surf(CTX i)     surface of the i-th that is asked, as its own camera saw it
 *     neighbour_answer(CTX i)   reuse_answer: target of the sample held at the i-th that is asked
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
FN b1 neighbour_some(CTX int i);
FN mask neighbour_on(CTX int i);
FN reservoir neighbour_resv(CTX int i);
FN surf neighbour_surf(CTX int i);
FN real neighbour_answer(CTX int i);
FN reservoir neighbour_resv_of(CTX u32 i);

/* Pairwise, so many of the neighbours' samples are looked at: REUSE_DRAWS drawn among more than that. */
#define REUSE_DRAWS 2

/* The choice of neighbour i, and of the pixel's own sample. dim: DIM_TEMPORAL, or DIM_SPATIAL + 64 a pass. */
FN real reuse_choice(u32 key, u32 dim, int i) { return rng(key, dim + KU(DIM_NEIGHBOUR(i) + 2u)); }
FN real reuse_own_choice(u32 key, u32 dim) { return rng(key, dim + KU(DIM_OWN)); }
/* Which neighbours are drawn, and which one is asked about the pixel's own sample. */
FN real reuse_draws_start(u32 key, u32 dim) { return rng(key, dim + KU(DIM_OWN + 1u)); }
FN real reuse_partner_choice(u32 key, u32 dim) { return rng(key, dim + KU(DIM_OWN + 2u)); }

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
        if (!neighbour_some(PASS i))
            continue;
        reservoir q = neighbour_resv(PASS i);
        real p = reuse_offered(PASS s, q);
        EXACT real w = q.m * p * q.w;
        st = builder_add(st, q.light, q.u, q.v, p, w, q.m, K(F32(i + 1)), reuse_choice(key, dim, i));
    }
    return st;
}

/* Number of neighbours that are asked. */
FN int reuse_asked(CTX int k) { return FRAME.bias == BIAS_PAIRWISE && k > 1 ? 1 : k; }

/* Sum of the neighbours' M. */
FN real reuse_sum_m(CTX int k) {
    real m_n = K(0.0f);
    for (int i = 0; i < k; i++)
        if (neighbour_some(PASS i))
            m_n = m_n + neighbour_resv(PASS i).m;
    return m_n;
}

/* Pairwise: the neighbour that is asked, drawn in proportion to M. */
FN u32 reuse_partner(CTX u32 key, u32 dim, int k) {
    u32 partner = KU(0u);
    if (k > 1) {
        EXACT real at = reuse_partner_choice(key, dim) * reuse_sum_m(PASS k);
        real before = K(0.0f);
        for (int i = 0; i < k; i++) {
            if (!neighbour_some(PASS i))
                continue;
            real m = neighbour_resv(PASS i).m;
            partner = selu(and_(m > K(0.0f), before <= at), KU(U32(i)), partner);
            before = before + m;
        }
    }
    return partner;
}

/* Target of the sample held at the i-th neighbour that is asked, unshadowed. on: there is one. l: its light as it was
 * when the neighbour's reservoir was made. */
FN real reuse_target(CTX int i, mask on, reservoir_builder held, light l) {
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

/* A neighbour's sample is offered. times: what stands for it, over its chance to be offered. */
FN reservoir_builder reuse_offer(CTX reservoir_builder st, surf s, reservoir q, real share, real m_n, real m_c,
                                 real times, real tag, real xi) {
    real p = reuse_offered(PASS s, q);
    EXACT real w = sel(q.w > K(0.0f), pair_weight(share, m_n, q.p, m_c, p, q.w), K(0.0f)) * times;
    return builder_add(st, q.light, q.u, q.v, p, w, K(0.0f), tag, xi);
}

/* What a neighbour's sample brings at its own pixel, by its M: about what it will weigh at another. */
FN real reuse_mass(reservoir q) {
    EXACT real w = q.m * q.p * q.w;
    return w;
}

/* REUSE_DRAWS of the neighbours are offered, in proportion to their mass, with one random start. */
FN reservoir_builder reuse_offer_drawn(CTX surf s, real m_n, real m_c, u32 key, u32 dim, int k) {
    real total = K(0.0f);
    for (int i = 0; i < k; i++)
        if (neighbour_some(PASS i))
            total = total + reuse_mass(neighbour_resv(PASS i));
    real inv = mis_scale(K(1.0f), m_n);
    EXACT real step = total * K(1.0f / F32(REUSE_DRAWS));
    EXACT real at = reuse_draws_start(key, dim) * step;
    reservoir_builder st = builder_empty();
    for (int d = 0; d < REUSE_DRAWS; d++) {
        u32 drawn = KU(0u);
        real mass = K(0.0f);
        real before = K(0.0f);
        for (int i = 0; i < k; i++) {
            if (!neighbour_some(PASS i))
                continue;
            real of = reuse_mass(neighbour_resv(PASS i));
            mask here = and_(of > K(0.0f), before <= at);
            drawn = selu(here, KU(U32(i)), drawn);
            mass = sel(here, of, mass);
            before = before + of;
        }
        reservoir q = neighbour_resv_of(PASS drawn);
        EXACT real share = q.m * inv;
        st = reuse_offer(PASS st, s, q, share, m_n, m_c, mis_scale(step, mass), K(F32(d + 1)),
                         reuse_choice(key, dim, d));
        at = at + step;
    }
    return st;
}

FN combined reuse_pairwise(CTX surf s, reservoir own, real m_n, u32 key, u32 dim, int k) {
    reservoir_builder st = builder_empty();
    if (k > REUSE_DRAWS) {
        st = reuse_offer_drawn(PASS s, m_n, own.m, key, dim, k);
    } else {
        real inv = mis_scale(K(1.0f), m_n);
        for (int i = 0; i < k; i++) {
            if (!neighbour_some(PASS i))
                continue;
            reservoir q = neighbour_resv(PASS i);
            EXACT real share = q.m * inv;
            st = reuse_offer(PASS st, s, q, share, m_n, own.m, K(1.0f), K(F32(i + 1)), reuse_choice(key, dim, i));
        }
    }
    real m_c = K(1.0f);
    if (k > 0)
        m_c = pair_canonical(K(1.0f), m_n, neighbour_answer(PASS 0), own.m, own.p);
    EXACT real m_all = m_n + own.m;
    EXACT real w_own = m_c * own.p * own.w;
    st = builder_add(st, own.light, own.u, own.v, own.p, w_own, m_all, K(0.0f), reuse_own_choice(key, dim));
    combined c;
    c.r = builder_end(st, K(1.0f));
    c.own = st.tag == K(0.0f);
    return c;
}

/* Sum of the sources' M, each times its target of the sample held: the balance rule's. */
FN real reuse_balance(CTX reservoir own, reservoir_builder held, int k) {
    EXACT real all = own.m * held.p;
    for (int i = 0; i < k; i++)
        if (neighbour_some(PASS i)) {
            EXACT real sum = all + neighbour_resv(PASS i).m * neighbour_answer(PASS i);
            all = sum;
        }
    return all;
}

/* Sum of M over the sources whose target of the sample held is not 0. The pixel's own is not, or nothing is held. */
FN real reuse_count(CTX reservoir own, int k) {
    real all = own.m;
    for (int i = 0; i < k; i++)
        if (neighbour_some(PASS i))
            all = all + sel(neighbour_answer(PASS i) > K(0.0f), neighbour_resv(PASS i).m, K(0.0f));
    return all;
}

/* Target of the sample held at its source. */
FN real reuse_source(CTX reservoir_builder held, int k) {
    real source = held.p;
    for (int i = 0; i < k; i++)
        if (neighbour_some(PASS i))
            source = sel(held.tag == K(F32(i + 1)), neighbour_answer(PASS i), source);
    return source;
}

/* One sample chosen among all by M, and then weighed. */
FN combined reuse_weighed(CTX reservoir own, reservoir_builder held, int k) {
    real scale = K(0.0f);
    if (FRAME.bias == BIAS_MIS)
        scale = mis_scale(reuse_source(PASS held, k), reuse_balance(PASS own, held, k));
    else if (FRAME.bias == BIAS_COUNTED)
        scale = mis_scale(K(1.0f), reuse_count(PASS own, k));
    else
        scale = mis_scale(K(1.0f), held.m);
    combined c;
    c.r = builder_end(held, scale);
    c.own = held.tag == K(0.0f);
    return c;
}

/* The combination; the pixel's own reservoir as it is where no neighbour has M > 0. */
FN combined reuse_end(CTX surf s, reservoir own, reservoir_builder held, u32 key, u32 dim, int k) {
    real m_n = reuse_sum_m(PASS k);
    mask some = m_n > K(0.0f);
    combined c;
    if (FRAME.bias == BIAS_PAIRWISE)
        c = reuse_pairwise(PASS s, own, m_n, key, dim, k);
    else
        c = reuse_weighed(PASS own, held, k);
    c.r = reservoir_sel(some, c.r, own);
    c.own = or_(not_(some), c.own);
    return c;
}

#endif
