/* core/pick.h: what a light picker answers. Every picker has `draw`, which gives a pick, and `pmf`, which gives the
 * probability that a draw is this light, side by side: 1 / inverse of a draw is the pmf of its light. */
#ifndef CORE_PICK_H
#define CORE_PICK_H

#include "core/random.h"

struct pick {
    u32 light;
    real inverse; /* 1 / pmf; 0: nothing was picked */
};

#ifndef CORE_GLSL
typedef struct pick pick;
#endif

#endif
