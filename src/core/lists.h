/* core/lists.h: light lists. A tile of the picture gathers its strongest lights, each with weight 1, and a tail of
 * draws from all the others, each with weight 1 / (expected number of times it is drawn); every pixel of the tile
 * evaluates them all. sum(weight * f) over the entries is then an unbiased estimate of the sum over all lights,
 * whatever the scores were, as long as a score is only 0 where no light of the cluster can reach any point of the tile.
 * core/list_build.h makes the list; here is the pixel's choice among its entries. */
#ifndef CORE_LISTS_H
#define CORE_LISTS_H

#include "core/list_build.h"
#include "core/reservoir.h"

FN light light_splat(CTX u1 i); /* the same light in every lane */

/* Place on the light that entry i is evaluated at: the R2 sequence over the entries, shifted for each pixel (M. Roberts
 * 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"). Each place alone is uniform. */
FN real list_u(u32 shift, u32 i) { return unit_real(shift + KU(3242174889u) * i); }
FN real list_v(u32 shift, u32 i) { return unit_real(shift + KU(2447445414u) * i); }

/* One sample of all the entries: chosen in proportion to weight * p_hat, so W = sum(weight * p_hat) / p_hat(chosen). */
FN reservoir ris_list(CTX surf s, u32 key, u1 count) {
    reservoir_builder st = builder_empty();
    u32 shift_u = rng_bits(key, KU(DIM_LIST_PLACE));
    u32 shift_v = rng_bits(key, KU(DIM_LIST_PLACE + 1u));
    for (u1 i = 0u; i < count; i++) {
        list_entry e = entry_load(PASS i);
        real u = list_u(shift_u, KU(i));
        real v = list_v(shift_v, KU(i));
        real p = target(PASS s, light_splat(PASS e.light), u, v);
        st =
            builder_add(st, KU(e.light), u, v, p, p * K(e.weight), K(0.0f), K(0.0f), rng(key, KU(DIM_LIST_CHOICE + i)));
    }
    return builder_end(st, K(1.0f));
}

#endif
