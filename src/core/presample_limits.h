/* core/presample_limits.h: how many candidates a frame draws for its blocks to share (core/presampled.h), and which of
 * them a block has. */
#ifndef CORE_PRESAMPLE_LIMITS_H
#define CORE_PRESAMPLE_LIMITS_H

#include "core/random.h"

#define PRESAMPLES 65536u /* of a frame at most */

/* How many subsets a frame of so many blocks has: an eighth of its candidates are drawn, or few. */
FN1 u1 presample_subsets(u1 m, u1 blocks) {
    u1 most = PRESAMPLES / (16u * m);
    u1 few = blocks / 8u;
    if (few < 128u)
        few = 128u;
    return minu1(most, few);
}

/* Of a subset, or of a block with `of_block`: no pixel's. */
FN1 u1 presample_key(u1 seed, u1 number, u1 frame, u1 of_block) {
    return hash_u1(2u * number + of_block + hash_u1(frame + hash_u1((seed ^ 0x2c1b3c6du) + 0x68bc21ebu)));
}

/* Which of so many subsets a block, or a set of influence, of that number has. */
FN1 u1 presample_subset(u1 seed, u1 number, u1 frame, u1 subsets) {
    return high_u1(presample_key(seed, number, frame, 1u), subsets);
}

#endif
