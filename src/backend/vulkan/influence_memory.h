/* Where the passes over influence volumes keep what they pass on to each other, and the volumes as shaders read them,
 * in words; read by the host and by shaders. */
#ifndef NOC_VULKAN_INFLUENCE_MEMORY_H
#define NOC_VULKAN_INFLUENCE_MEMORY_H

#include "core/influence_limits.h"

/* ---- scratch of a band: its tiles row by row; then the pool, draws and sums of weights, a share for each tile ---- */

#define FOUND_MOST_GROUPS 257u /* of a tile: one for each pixel, and that of points that did not ask */

#define FOUND_GROUPS 0u /* how many there are */
#define FOUND_SETS 1u   /* of samples */
#define FOUND_LEAVES 2u /* near the tile, or FOUND_ALL */
#define FOUND_TAKES 3u  /* lights that its groups list */
#define FOUND_FROM 4u   /* their place in the pool */
#define FOUND_BOX 5u    /* of its points: lo, hi */
#define FOUND_PIXEL 11u /* of each: its group, from bit 16 on its lane in a set of samples, from bit 20 on the set */
#define FOUND_LANE (FOUND_PIXEL + 256u) /* of each set: the groups of its 16 lanes */
#define FOUND_GROUP (FOUND_LANE + 256u) /* field by field, FOUND_MOST_GROUPS each: */
#define GROUP_LO 0u                     /* near_query; 3 */
#define GROUP_HI 3u                     /* 3 */
#define GROUP_N 6u                      /* 3 */
#define GROUP_BACK 9u
#define GROUP_LEAST 10u
#define GROUP_COUNT 11u /* lights that it lists */
#define GROUP_FROM 12u  /* their place among the tile's; then in the pool */
#define GROUP_POINTS 13u
#define GROUP_WORDS 14u
#define FOUND_LEAF (FOUND_GROUP + GROUP_WORDS * FOUND_MOST_GROUPS) /* leaves near the tile, in their order */
#define FOUND_ROOM 4096u                                           /* of them; more, and each group looks at all */
#define FOUND_WORDS (FOUND_LEAF + FOUND_ROOM)

#define FOUND_ALL 0xffffffffu
#define LEAF_MOVES 0x80000000u /* it is of the half of lights that move */

/* The pool: each group's bins of the rule (core/influence_rule.h), then, in their place, lights of all tiles. */
#define BIN_WORDS 3u
#define FOUND_POOL ((FOUND_MOST_GROUPS - 1u) * BIN_WORDS * 48u) /* of a tile; its bins are all there */
#define FOUND_SPARE (1u << 20) /* of the band beside, so that small pictures have room */

/* Samples: of each set, row by row, lights of 16 lanes, places, inverses. */
#define DRAW_WORDS 48u

/* ---- the volumes: a head, and where arrays are ---- */

#define VOLUMES_COUNT 0u /* lights of the scene */
#define VOLUMES_SCALE 1u /* S_r that was found */
#define VOLUMES_USUAL 2u /* median root */
#define VOLUMES_RULE 3u  /* noc_influence_rule: 5 */
#define VOLUMES_RECORDS 8u
#define VOLUMES_OF_LIGHT 9u
#define VOLUMES_IDS 10u
#define VOLUMES_FIRST 11u  /* 0: each has one light */
#define VOLUMES_BOX_OF 12u /* 0: none has a box */
#define VOLUMES_BOXES 13u
#define VOLUMES_HALF 16u /* of each half: */
#define HALF_FIRST 0u    /* its volumes */
#define HALF_END 1u
#define HALF_NODES 2u /* how many there are of level 0, and where; a child is 16 volumes, a leaf */
#define HALF_CHILDREN 3u
#define HALF_PARENTS 4u /* where level 1 is; 0: none */
#define HALF_WORDS 8u
#define VOLUMES_HEAD (VOLUMES_HALF + 2u * HALF_WORDS)

#define VOLUME_WORDS 8u /* noc_influence_volume */
#define NODE_WORDS 112u /* noc_influence_node */

#endif
