/* core/lists.h: light lists. A tile of the picture gathers its strongest lights, each with weight 1, and a tail of
 * draws from all the others, each with weight 1 / (expected number of times it is drawn); every pixel of the tile
 * evaluates them all. sum(weight * f) over the entries is then an unbiased estimate of the sum over all lights,
 * whatever the scores were, as long as a score is only 0 where no light of the cluster can reach any point of the tile.
 * Here: that bound, and the pixel's choice among the entries. Building the list is the backend's (it sorts). */
#ifndef CORE_LISTS_H
#define CORE_LISTS_H

#include "core/cones.h"
#include "core/reservoir.h"

struct list_entry {
    u32 light;
    real weight;
};

#ifndef CORE_GLSL
typedef struct list_entry list_entry;
FN list_entry list_entry_load(CTX int i);
#endif

/* Place on the light that entry i is evaluated at: the R2 sequence over the entries, shifted for each pixel (M. Roberts
 * 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"). Each place alone is uniform. */
FN real list_u_at(u32 shift, u32 i) { return unit_real(shift + KU(3242174889u) * i); }
FN real list_v_at(u32 shift, u32 i) { return unit_real(shift + KU(2447445414u) * i); }
FN real list_u(u32 shift, int i) { return list_u_at(shift, KU(U32(i))); }
FN real list_v(u32 shift, int i) { return list_v_at(shift, KU(U32(i))); }

/* One sample of all the entries: chosen in proportion to weight * p_hat, so W = sum(weight * p_hat) / p_hat(chosen). */
FN resv ris_list(CTX surf s, u32 key, int count) {
    stream st = stream_empty();
    u32 shift_u = rng_bits(key, KU(DIM_CANDIDATE));
    u32 shift_v = rng_bits(key, KU(DIM_CANDIDATE + 1u));
    for (int i = 0; i < count; i++) {
        list_entry e = list_entry_load(PASS i);
        real u = list_u(shift_u, i);
        real v = list_v(shift_v, i);
        real p = target(s, light_load(PASS e.light), u, v);
        st =
            stream_add(st, e.light, u, v, p, p * e.weight, K(0.0f), K(0.0f), rng(key, KU(DIM_CANDIDATE + 2u + U32(i))));
    }
    return stream_end(st, K(1.0f));
}

#endif
