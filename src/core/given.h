/* core/given.h: streaming RIS over candidates that a picker has drawn. Includers supply pick_load(CTX i), candidate i
 * of the pixel. */
#ifndef CORE_GIVEN_H
#define CORE_GIVEN_H

#include "core/pick.h"
#include "core/reservoir.h"

FN pick pick_load(CTX int i);

/* W = (1/m) sum(p_hat / pmf) / p_hat(chosen); draws that picked nothing count in m. */
FN reservoir ris_given(CTX surf s, u32 key, int m) {
    reservoir_builder st = builder_empty();
    for (int i = 0; i < m; i++) {
        u32 dim = KU(DIM_CANDIDATE + 3u * U32(i));
        u32 place = rng_bits(key, dim + KU(1u));
        real u = unit_low(place);
        real v = unit_high(place);
        pick c = pick_load(PASS i);
        real p = target(PASS s, light_load(PASS c.light), u, v);
        EXACT real w = p * c.inverse;
        st = builder_add(st, c.light, u, v, p, w, K(1.0f), K(0.0f), rng(key, dim + KU(2u)));
    }
    return builder_end(st, K(1.0f) / K(F32(m)));
}

#endif
