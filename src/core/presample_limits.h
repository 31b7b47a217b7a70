/* core/presample_limits.h: how many candidates a frame draws for its blocks to share (core/presampled.h). */
#ifndef CORE_PRESAMPLE_LIMITS_H
#define CORE_PRESAMPLE_LIMITS_H

#include "core/dialect.h"

#define PRESAMPLES 65536u /* of a frame at most */

/* How many subsets a frame of so many blocks has: an eighth of its candidates are drawn, or few. */
FN1 u1 presample_subsets(u1 m, u1 blocks) {
    u1 most = PRESAMPLES / (16u * m);
    u1 few = blocks / 8u;
    if (few < 128u)
        few = 128u;
    return minu1(most, few);
}

#endif
