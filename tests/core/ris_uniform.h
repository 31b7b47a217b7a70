/* Streaming RIS over lights that a pixel draws for itself, in the dialect: what tests and benches take reservoirs from,
 * and hold others against. */
#ifndef NOC_TEST_RIS_UNIFORM_H
#define NOC_TEST_RIS_UNIFORM_H

#include "core/reservoir.h"

/* Streaming RIS over `count` lights picked uniformly, m candidates: W = (1/m) sum(p_hat / pmf) / p_hat(chosen), pmf =
 * 1/count over (light) times 1 over the unit square. count > 0. */
FN reservoir ris_uniform(CTX surf s, u32 key, u32 count, int m) {
    reservoir_builder st = builder_empty();
    for (int i = 0; i < m; i++) {
        u32 dim = KU(DIM_CANDIDATE + 3u * U32(i));
        u32 id = scale_u32(rng_bits(key, dim), count);
        u32 place = rng_bits(key, dim + KU(1u));
        real u = unit_low(place);
        real v = unit_high(place);
        real p = target(PASS s, light_load(PASS id), u, v);
        st = builder_add(st, id, u, v, p, p, K(1.0f), K(0.0f), rng(key, dim + KU(2u)));
    }
    return builder_end(st, to_real(count) / K(F32(m)));
}

#endif
