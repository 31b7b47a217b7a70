/* core/list_limits.h: sizes that light lists are bounded by, for those that make room for them. */
#ifndef CORE_LIST_LIMITS_H
#define CORE_LIST_LIMITS_H

#define LIST_ENTRIES 128 /* lights that are listed, and as many that are drawn */
#define LIST_ROOM 256    /* entries of a list */

/* Clusters of lights: most levels, and most nodes of the highest one. */
#define LIST_LEVELS 8
#define LIST_ROOTS 256

/* Most pieces of a tile's surfaces that lights are scored at, two a block; most nodes that are opened, of each level
 * and of the lowest; so few that all are; steps that scores are told apart by. */
#define LIST_PATCHES 32
#define OPENED_NODES 96
#define OPENED_CLUSTERS 192
#define FEW_NODES 64
#define SCORE_STEPS 1020

/* Most groups of 16 that a list is chosen from, one for scratch after them, and most places that are chosen at once. */
#define LIST_GROUPS (LIST_ROOTS / 16 + LIST_LEVELS * OPENED_NODES + OPENED_CLUSTERS)
#define LIST_SPARE LIST_GROUPS
#define LIST_CHOSEN 256

/* Rows of 16 entries; faces of a block (core/list_faces.h). */
#define LIST_ROWS (LIST_ROOM / 16)
#define LIST_FACES 16

/* Shapes of lights in brief (core/list_sketch.h), and words of a sketch. */
#define SKETCH_ROUND 1u
#define SKETCH_FLAT 2u
#define SKETCH_TWO_SIDED 3u
#define SKETCH_SPOT 4u
#define SKETCH_PROFILE 5u /* and above */
#define SKETCH_NUMBER 3
#define SKETCH_WORDS 16

#endif
