/* core/influence_limits.h: sets of samples that points share which ask the influence volumes as one
 * (core/influence_draw.h). */
#ifndef CORE_INFLUENCE_LIMITS_H
#define CORE_INFLUENCE_LIMITS_H

#include "core/dialect.h"

#define INFLUENCE_SETS 32u /* numbers of sets, of a tile */
#define CUT_SIXTEENS 16u   /* of a tile at most (core/influence_cut.h), and so many sets */

/* Sets that so many times 16 pixels share which ask as one. */
FN1 u1 influence_sets(u1 sixteens) { return minu1((sixteens + 3u) / 4u, 4u); }

/* How many of m candidates come from lists; the others are drawn from all lights. */
FN1 u1 influence_listed(u1 m, u1 every) { return m - (m + every - 1u) / every; }

#endif
