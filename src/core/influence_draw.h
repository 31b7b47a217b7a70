/* core/influence_draw.h: candidates of a point that has asked the influence volumes (core/influence.h). Includers
 * supply the bridges. A backend that has memory to wait for may take influence_candidate apart: the light of every
 * candidate first, then those that were drawn from all lights get their densities. */
#ifndef CORE_INFLUENCE_DRAW_H
#define CORE_INFLUENCE_DRAW_H

#include "core/influence.h"

/* What a point asked with, and found. */
struct influence_asked {
    influence_region r;
    real least; /* lux */
    u32 count;  /* lights that it lists: so many from place `from` of the list of found lights on */
    u32 from;
};

#ifndef CORE_GLSL
typedef struct influence_asked influence_asked;
#endif

FN u32 influence_found(CTX u32 place); /* a light; place 0 is always there */
FN u32 influence_volume(CTX u32 id);   /* of a light */
FN influence influence_load(CTX u32 volume);
FN mask influence_seen(CTX u32 volume, influence_region r); /* does its box meet the region? true where it has none */

/* Is candidate i drawn from all lights? */
FN1 b1 influence_from_all(int i, int every) { return i % every == 0; }

/* The light of candidate i. n_l: lights of the scene. */
FN u32 influence_light(CTX influence_asked a, u32 key, u32 n_l, int i, int every) {
    u32 bits = rng_bits(key, KU(DIM_CANDIDATE + 3u * U32(i)));
    u32 id = scale_u32(bits, n_l);
    if (!influence_from_all(i, every)) {
        mask any = a.count > KU(0u);
        if (ANY(any))
            id = selu(any, influence_found(PASS a.from + scale_u32(bits, a.count)), id);
    }
    return id;
}

/* Does the point list the lights of that volume, v? strongest: of those that hold it the ones that give it `least`. */
FN mask influence_lists(CTX u32 volume, influence v, influence_asked a, real scale, b1 strongest) {
    mask held = and_(influence_holds(v, a.r, scale), a.count > KU(0u));
    if (strongest)
        held = and_(held, influence_gives(v, influence_turn(v), a.r) >= a.least);
    if (ANY(held))
        held = and_(held, influence_seen(PASS volume, a.r));
    return held;
}

/* Candidate i of m. */
FN pick influence_candidate(CTX influence_asked a, u32 key, u32 n_l, real scale, b1 strongest, int i, int m,
                            int every) {
    pick p;
    p.light = influence_light(PASS a, key, n_l, i, every);
    mask listed = a.count > KU(0u);
    if (influence_from_all(i, every)) {
        u32 volume = influence_volume(PASS p.light);
        listed = influence_lists(PASS volume, influence_load(PASS volume), a, scale, strongest);
    }
    EXACT real inverse = K(1.0f) / influence_pmf(listed, a.count, n_l, m, every);
    p.inverse = inverse;
    return p;
}

#endif
