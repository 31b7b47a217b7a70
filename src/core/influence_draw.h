/* core/influence_draw.h: candidates of points that have asked the influence volumes (core/influence.h), drawn for many
 * points at once and kept side by side in memory, as those of core/presampled.h are.
 *
 * A set is 16 m samples (light, u, v): the first b rows of 16 come from the lights that the points of its 16 lanes
 * list, the last u from all lights. Samples are stratified over the list, and over all lights, in their order. A
 * pixel takes the m samples of its lane: candidate i is any of the 16 of its row alike, for the set is turned at
 * random. Pixels that ask as one share several sets, each of them one; where 16 pixels do not ask as one, they have a
 * set of their own, whose lanes draw from a list each.
 *
 * The density of a sample is that of core/influence.h, whichever way it came: of those drawn from all lights it is
 * asked whether the lane's points list them, once a set. Includers supply the bridges. */
#ifndef CORE_INFLUENCE_DRAW_H
#define CORE_INFLUENCE_DRAW_H

#include "core/influence.h"
#include "core/influence_limits.h"
#include "core/presampled.h"

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

/* The light that these bits choose from lists; from all n_l lights where a point lists none. */
FN u32 influence_from_list(CTX influence_asked a, u32 bits, u32 n_l) {
    u32 id = scale_u32(bits, n_l);
    mask any = a.count > KU(0u);
    if (ANY(any))
        id = selu(any, influence_found(PASS a.from + scale_u32(bits, a.count)), id);
    return id;
}

/* The sample at that lane of row `row` of a set, drawn from what the lane's points list. key: of the set; share: an
 * even share of all of its samples from lists (presample_share); inverse: 1 / pmf of what is listed. */
FN presample_pick influence_draw(CTX influence_asked a, u1 key, u1 row, u32 lane, u1 share, u32 n_l, real inverse) {
    u32 j = presample_at(key, row, lane);
    presample_pick k;
    k.light = influence_from_list(PASS a, presample_bits(key, j, share), n_l);
    k.place = presample_place(key, j);
    k.inverse = inverse;
    return k;
}

/* Does the point list the lights of that volume, v of that influence_turn? strongest: of those that hold it the ones
 * that give it `least`. */
FN mask influence_lists(CTX u32 volume, influence v, real turn, influence_asked a, real scale, b1 strongest) {
    mask held = and_(influence_holds(v, a.r, scale), a.count > KU(0u));
    if (strongest && ANY(held))
        held = and_(held, influence_gives(v, turn, a.r) >= a.least);
    if (ANY(held))
        held = and_(held, influence_seen(PASS volume, a.r));
    return held;
}

/* 1 / pmf of a light, given whether the point lists it. */
FN real influence_inverse(mask listed, influence_asked a, u32 n_l, int m, int every) {
    EXACT real inverse = K(1.0f) / influence_pmf(listed, a.count, n_l, m, every);
    return inverse;
}

#endif
