/* core/reference.h: the reference method: every light is evaluated at every pixel.
 *
 * A light's sample (u, v) is one random place a pixel, light and frame. FRAME.rays entries are laid over the lights'
 * cumulative unshadowed luminance by systematic sampling (thresholds (j + xi) T / n): a light of luminance p gets p n /
 * T entries on average, which makes one entry worth T / (n p). Several entries of one light become one of that many
 * times the weight. With no more lights than rays every light gets its own. Lights are summed in chunks, so that the
 * second walk only evaluates the chunks that hold a threshold; a machine may sum chunks in any order.
 *
 * Includers supply FRAME, light_of_all(CTX i), the same light in every lane, light_shines(CTX i), and the pixel's
 * scratch: sum_put(CTX chunk, x), sum_load(CTX chunk) and entry_put(CTX on, i, w), which adds light i with its
 * weight. */
#ifndef CORE_REFERENCE_H
#define CORE_REFERENCE_H

#include "core/frame.h"
#include "core/reservoir.h"

FN light light_of_all(CTX uint32_t i);
FN bool light_shines(CTX uint32_t i);
FN void sum_put(CTX uint32_t chunk, real x);
FN real sum_load(CTX uint32_t chunk);
FN void entry_put(CTX mask on, uint32_t i, real w);

/* Where light `id` is looked at: (u, v) in x and y. */
FN v3 reference_place(u32 key, u32 id) {
    u32 bits = rng_bits(key, KU(DIM_CANDIDATE) + id);
    return V3(unit_low(bits), unit_high(bits), K(0.0f));
}

FN real reference_target(CTX surf s, u32 key, uint32_t i) {
    if (!light_shines(PASS i)) /* a dark window */
        return K(0.0f);
    v3 at = reference_place(key, KU(i));
    return target(PASS s, light_of_all(PASS i), at.x, at.y);
}

/* Entries below the cumulative luminance c: the number of thresholds under it. */
FN u32 entries_below(real c, real per_luminance, real xi, real n) {
    EXACT real t = c * per_luminance - xi + K(1.0f);
    return to_u32(min_(max_(t, K(0.0f)), n));
}

/* Luminance of the lights of a chunk, into the pixel's scratch. */
FN void reference_sum(CTX surf s, u32 key, uint32_t chunk, uint32_t count) {
    uint32_t first = chunk * REFERENCE_CHUNK;
    real sum = K(0.0f);
    for (uint32_t i = first; i < count && i < first + REFERENCE_CHUNK; i++)
        sum = sum + reference_target(PASS s, key, i);
    sum_put(PASS chunk, sum);
}

/* Entries of a chunk whose lights come after luminance `before`. */
FN void reference_entries_of(CTX surf s, u32 key, uint32_t chunk, uint32_t count, real before, real per_luminance,
                             real xi, mask lit) {
    uint32_t first = chunk * REFERENCE_CHUNK;
    real n = K(F32(FRAME.rays));
    real sum = K(0.0f);
    u32 had = entries_below(before, per_luminance, xi, n);
    for (uint32_t i = first; i < count && i < first + REFERENCE_CHUNK; i++) {
        real p = reference_target(PASS s, key, i);
        sum = sum + p;
        u32 have = entries_below(before + sum, per_luminance, xi, n);
        mask take = and_(and_(lit, p > K(0.0f)), have != had);
        EXACT real w = to_real(have - had) / (per_luminance * sel(take, p, K(1.0f)));
        entry_put(PASS take, i, w);
        had = have;
    }
}

/* Entries by the chunks' luminances, which reference_sum has put. */
FN void reference_drawn(CTX surf s, u32 key, uint32_t count) {
    uint32_t chunks = (count + REFERENCE_CHUNK - 1u) / REFERENCE_CHUNK;
    real n = K(F32(FRAME.rays));
    real total = K(0.0f);
    for (uint32_t i = 0u; i < chunks; i++)
        total = total + sum_load(PASS i);
    mask lit = total > K(0.0f);
    EXACT real per_luminance = n / sel(lit, total, K(1.0f));
    real xi = rng(key, KU(DIM_RAYS));
    real before = K(0.0f);
    for (uint32_t i = 0u; i < chunks; i++) {
        real after = before + sum_load(PASS i);
        mask holds = entries_below(after, per_luminance, xi, n) != entries_below(before, per_luminance, xi, n);
        if (ANY(and_(lit, holds)))
            reference_entries_of(PASS s, key, i, count, before, per_luminance, xi, lit);
        before = after;
    }
}

/* An entry of every light: there are no more than rays. */
FN void reference_all(CTX surf s, u32 key, uint32_t count) {
    for (uint32_t i = 0u; i < count; i++)
        entry_put(PASS reference_target(PASS s, key, i) > K(0.0f), i, K(1.0f));
}

FN void reference_entries(CTX surf s, u32 key, uint32_t count) {
    if (count <= FRAME.rays) {
        reference_all(PASS s, key, count);
        return;
    }
    for (uint32_t i = 0u; i * REFERENCE_CHUNK < count; i++)
        reference_sum(PASS s, key, i, count);
    reference_drawn(PASS s, key, count);
}

#endif
