/* Candidates that blocks share, in the dialect test: slots from PRESAMPLED_FIRST on. */
#ifndef DIALECT_PRESAMPLED_H
#define DIALECT_PRESAMPLED_H

#include "core/presampled.h"

#define CANDIDATES 9

#if defined(CORE_GLSL)
real dialect_weighed[CANDIDATES];
u32 dialect_shared;
#else
static real dialect_weighed[CANDIDATES];
static u32 dialect_shared; /* of the item at hand: its samples */
#endif

FN presample_pick presample_pick_load(CTX u32 i) {
    presample_pick k;
    k.light = hash_u32(i + dialect_shared);
    k.place = rng_bits(dialect_shared, i);
    k.inverse = K(1.0f) + rng(dialect_shared, i + KU(100u));
    return k;
}
FN presample presample_load(CTX int i) {
    presample_pick k = presample_pick_load(PASS KU(U32(i)));
    return presample_of(light_load(PASS k.light), unit_low(k.place), unit_high(k.place));
}
FN real presample_inverse(CTX int i) { return presample_pick_load(PASS KU(U32(i))).inverse; }
FN void weighed_store(CTX int i, real sum) { dialect_weighed[i] = sum; }
FN real weighed_load(CTX int i) { return dialect_weighed[i]; }
FN real weighed_at(CTX u32 i) {
    real x = dialect_weighed[0];
    for (int k = 1; k < CANDIDATES; k++)
        x = sel(i == KU(U32(k)), dialect_weighed[k], x);
    return x;
}

/* Slots 0 to 31. */
CALL void presampling(CTX u32 item, u32 key, surf s) {
    dialect_shared = hash_u32(key + KU(6001u));
    presample e = presample_of(any_light(dialect_shared), rng(key, KU(6002u)), rng(key, KU(6003u)));
    put_v3(PASS item, PRESAMPLED_FIRST, e.x);
    put_v3(PASS item, PRESAMPLED_FIRST + 3, e.normal);
    put_v3(PASS item, PRESAMPLED_FIRST + 6, e.shine);
    put_real(PASS item, PRESAMPLED_FIRST + 9, e.bare);
    put_real(PASS item, PRESAMPLED_FIRST + 10, e.sided);
    put_real(PASS item, PRESAMPLED_FIRST + 11, e.close2);
    put_real(PASS item, PRESAMPLED_FIRST + 12, e.radius);
    presample_steer p = presample_look(s, sketch_surf_of(s), e);
    put_real(PASS item, PRESAMPLED_FIRST + 13, p.p);
    put_real(PASS item, PRESAMPLED_FIRST + 14, sel(p.near, K(1.0f), K(0.0f)));
    u1 subset = presample_key(7u, ITEM_COUNT & 15u, 3u, 1u);
    u32 i = shr(dialect_shared, 25);
    put_u32(PASS item, PRESAMPLED_FIRST + 15, KU(subset + presample_subsets(1u + (ITEM_COUNT & 15u), 5000u)) + item);
    put_u32(PASS item, PRESAMPLED_FIRST + 16, presample_bits(subset, i, presample_share(80u)));
    put_real(PASS item, PRESAMPLED_FIRST + 17, presample_choice(subset, i));
    put_u32(PASS item, PRESAMPLED_FIRST + 18, presample_place(subset, i));
    put_u32(PASS item, PRESAMPLED_FIRST + 19, presample_turned(subset, i));
    put_real(PASS item, PRESAMPLED_FIRST + 20, sel(presample_plain(any_light(key)), K(1.0f), K(0.0f)));
    put_resv(PASS item, PRESAMPLED_FIRST + 21, ris_presampled(PASS s, rng(key, KU(6004u)), CANDIDATES));
    put_real(PASS item, PRESAMPLED_FIRST + 27, weighed_load(PASS CANDIDATES - 1));
    presample_pick even = presample_draw(subset, i, 208u, KERNEL_LIGHTS);
    presample_pick power = presample_draw_power(PASS subset, i, 208u, KERNEL_LIGHTS);
    put_u32(PASS item, PRESAMPLED_FIRST + 28, even.light + even.place);
    put_u32(PASS item, PRESAMPLED_FIRST + 29, power.light + power.place);
    put_real(PASS item, PRESAMPLED_FIRST + 30, power.inverse);
    u32 rank = presample_rank(presample_plain(light_load(PASS power.light)), i, shr(i, 1), 80u);
    put_u32(PASS item, PRESAMPLED_FIRST + 31, rank + KU(presample_subset(3u, ITEM_COUNT & 7u, 5u, 900u)));
}

#endif
