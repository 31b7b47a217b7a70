/* core/alias.h: lights picked in proportion to their power from an alias table (Walker 1977; Vose 1991, "A Linear
 * Algorithm for Generating Random Numbers with a Given Distribution"). Slot i belongs to light i: it is drawn as often
 * as any other slot, keeps its own light with probability `keep`, and gives `other` else. Includers supply the bridge
 * alias_load(CTX i). */
#ifndef CORE_ALIAS_H
#define CORE_ALIAS_H

#include "core/pick.h"

struct alias_slot {
    real keep;
    u32 other;
    real inverse;       /* 1 / pmf of light i; 0: it is never drawn */
    real inverse_other; /* of the other one */
};

#ifndef CORE_GLSL
typedef struct alias_slot alias_slot;
#endif
FN alias_slot alias_load(CTX u32 i);

/* bits choose the slot, xi (in [0, 1), independent of them) whether its light is kept. count > 0. */
FN pick alias_draw(CTX u32 count, u32 bits, real xi) {
    u32 i = scale_u32(bits, count);
    alias_slot s = alias_load(PASS i);
    mask own = xi < s.keep;
    pick p;
    p.light = selu(own, i, s.other);
    p.inverse = sel(own, s.inverse, s.inverse_other);
    return p;
}

FN real alias_pmf(CTX u32 id) {
    real inverse = alias_load(PASS id).inverse;
    mask drawn = inverse > K(0.0f);
    return sel(drawn, K(1.0f) / sel(drawn, inverse, K(1.0f)), K(0.0f));
}

#endif
