/* core/reuse.h: how reservoirs are combined at a pixel q. p_j(x) is the target of sample x at pixel j, times visibility
 * there where bias rays are on. The canonical reservoir c is q's own; neighbours come from other pixels or from the
 * last frame.
 *
 * - biased (Bitterli 2020, Alg. 4): w_i = M_i p_q(x_i) W_i, W = w_sum / (p_q(y) sum M_j).
 * - counted (Bitterli 2020, Alg. 6; Hlavova 2025, Alg. 6): the same weights, W = w_sum / (p_q(y) Z), where Z is the sum
 *   of M_j over those pixels that could have made y: p_j(y) > 0.
 * - mis (Bitterli 2020, section 4.3): the same weights, W = w_sum / p_q(y) * p_s(y) / sum_j M_j p_j(y), y from s.
 * - pairwise: w_i = m_i p_q(x_i) W_i with m_i = s_i a_i(x_i), m_c = sum_i s_i (1 - a_i(x_c)), where s_i = M_i / M_N is
 *   the neighbour's share of M_N = sum of the neighbours' M and a_i(x) = M_N p_i(x) / (M_N p_i(x) + M_c p_q(x)): the
 *   balance heuristic between c and each neighbour in turn. sum m = 1 for every x, and m_i = M_i / M where all targets
 *   agree (after Bitterli 2022, section 9.1; Lin et al. 2022, eq. 36 to 38, with confidence weights).
 */
#ifndef CORE_REUSE_H
#define CORE_REUSE_H

#include "core/reservoir.h"

/* W with its weight when the 1/M or the balance rule is used: see above. held: p_s(y); all: sum_j M_j p_j(y). */
FN real mis_scale(real held, real all) { return sel(all > K(0.0f), held / sel(all > K(0.0f), all, K(1.0f)), K(0.0f)); }

/* a_i(x): the neighbour's share against the canonical one. Where neither can make x it is 0. */
FN real pair_share(real m_n, real p_i, real m_c, real p_q) {
    EXACT real mine = m_n * p_i;
    EXACT real all = mine + m_c * p_q;
    return mis_scale(mine, all);
}

/* Resampling weight of neighbour i in pairwise MIS: share s_i, targets of x_i at i and at q, and W_i. */
FN real pair_weight(real share, real m_n, real p_i, real m_c, real p_q, real w_i) {
    EXACT real w = share * pair_share(m_n, p_i, m_c, p_q) * p_q * w_i;
    return w;
}

/* What neighbour i leaves of the canonical sample's MIS weight; the sum over neighbours is m_c. Where neither can make
 * x_c the canonical one keeps its share, so that m_c = 1 without any neighbour that could. */
FN real pair_canonical(real share, real m_n, real p_i_of_c, real m_c, real p_q_of_c) {
    EXACT real m = share * (K(1.0f) - pair_share(m_n, p_i_of_c, m_c, p_q_of_c));
    return m;
}

/* Cap of M for history. */
FN reservoir reservoir_cap(reservoir r, real m_max) {
    r.m = min_(r.m, m_max);
    return r;
}

/* Is a ray wanted that tells whether the sample is seen from its own pixel? visible: it is known to be. */
FN mask resolve_asks(reservoir r, mask visible) { return and_(r.w > K(0.0f), not_(visible)); }

/* No sample is left where its ray is blocked; M and the rest stay. */
FN reservoir reservoir_blocked(reservoir r, mask blocked) {
    r.w = sel(blocked, K(0.0f), r.w);
    return r;
}

#endif
