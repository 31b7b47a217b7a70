/* core/list_bright.h: what the pixels of a frame expect to get from their lists, in the mean. A pixel that expects
 * little beside it need not look for more light (core/list_rays.h, list_draws). The sum has one shape on all machines:
 * the 16 pixels of a block in halves, then blocks that are BRIGHT_COLUMNS apart in order, then these columns in halves.
 */
#ifndef CORE_LIST_BRIGHT_H
#define CORE_LIST_BRIGHT_H

#include "core/dialect.h"

#define BRIGHT_COLUMNS 256u

FN f1 block_bright(CTX u1 block); /* cd/m2, of its pixels together */

FN1 f1 column_bright(CTX u1 column, u1 blocks) {
    f1 sum = 0.0f;
    for (u1 b = column; b < blocks; b += BRIGHT_COLUMNS) {
        EXACT f1 more = sum + block_bright(PASS b);
        sum = more;
    }
    return sum;
}

#endif
