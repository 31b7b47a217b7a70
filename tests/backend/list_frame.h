/* Where what goes in and out of list_frame.comp lies, in words; read by C and by the shader. A tile is 16 blocks of 16
 * pixels; blocks of a tile, and tiles, lie one after the other. */
#ifndef LIST_FRAME_H
#define LIST_FRAME_H

#include "core/blocks.h"
#include "core/list_limits.h"
#include "core/random.h"

/* What work groups do: a dispatch's push constant. */
#define DISPATCH_TILES 0u  /* a list each */
#define DISPATCH_PIXELS 1u /* the rays of a block each */

#define BLOCK_FIELDS 10u /* of a gblock, a word a pixel each */

#define HEAD_TILES 0
#define HEAD_TILES_X 1
#define HEAD_WIDTH 2
#define HEAD_SEED 3
#define HEAD_FRAME 4
#define HEAD_LIST 5
#define HEAD_TAIL 6
#define HEAD_RAYS 7
#define HEAD_DRAWS 8
#define HEAD_EYE 9 /* 3 */
#define HEAD_BRIGHTNESS 12
#define HEAD_LEVELS 13
#define HEAD_TOP_NODES 14
#define HEAD_LIGHTS 15 /* from here on: places of what follows the head */
#define HEAD_MATERIALS 16
#define HEAD_BLOCKS 17
#define HEAD_CLUSTERS 18
#define HEAD_VISIBILITY 19
#define HEAD_SCRATCH 20
#define HEAD_ANSWER 21
#define HEAD_NODES 22 /* LIST_LEVELS */
#define HEAD_WORDS 32

#define SCRATCH_LINE (16 * (LIST_GROUPS + 1)) /* after the scores */
#define SCRATCH_GROUPS (SCRATCH_LINE + LIST_GROUPS + 1)
#define SCRATCH_PATCHES (SCRATCH_GROUPS + 3 * LIST_GROUPS)
#define SCRATCH_PIECES (SCRATCH_PATCHES + 16 * LIST_PATCHES)
#define SCRATCH_PARENTS (SCRATCH_PIECES + LIST_PATCHES)
#define SCRATCH_SKETCHES (SCRATCH_PARENTS + LIST_CHOSEN)
#define SCRATCH_WORDS (SCRATCH_SKETCHES + LIST_ROOM * SKETCH_WORDS)

#define RAY_ENTRY 0
#define RAY_TIMES 1
#define RAY_LIGHT 2
#define RAY_U 3
#define RAY_V 4
#define RAY_W 5
#define RAY_P 6
#define RAY_WEIGHED 7
#define RAY_WORDS 8

#define PIXEL_ALL 0
#define PIXEL_BRIGHT 1
#define PIXEL_DRAWS 2
#define PIXEL_SHOWN 3
#define PIXEL_KEPT 4
#define PIXEL_KEPT_W 5
#define PIXEL_COLOUR 6 /* 3 */
#define PIXEL_RAYS 9
#define PIXEL_WORDS (PIXEL_RAYS + 16 * RAY_WORDS)

#define ANSWER_COUNT 0
#define ANSWER_COPIES 1
#define ANSWER_LIGHT 2
#define ANSWER_WEIGHT (ANSWER_LIGHT + LIST_ROOM)
#define ANSWER_PIXELS (ANSWER_WEIGHT + LIST_ROOM)
#define ANSWER_WORDS (ANSWER_PIXELS + 256 * PIXEL_WORDS)

/* The given visibility bit of a pixel's ray: two of three are seen. */
FN mask frame_sees(u32 pixel, u32 ray) { return hash_u32(pixel * KU(16u) + ray) > KU(0x55555555u); }

#endif
