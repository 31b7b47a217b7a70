/* Slots of the dialect test: each file of functions has its own, one after the other. */
#ifndef DIALECT_SLOTS_H
#define DIALECT_SLOTS_H

#define KERNEL_SLOTS 203 /* dialect_kernel.h */
#define FRAME_FIRST KERNEL_SLOTS
#define FRAME_SLOTS 135 /* dialect_frame.h */
#define INFLUENCE_FIRST (FRAME_FIRST + FRAME_SLOTS)
#define INFLUENCE_SLOTS 17 /* dialect_influence.h */
#define LEARNED_FIRST (INFLUENCE_FIRST + INFLUENCE_SLOTS)
#define LEARNED_SLOTS 12 /* dialect_learned.h */
#define LISTS_FIRST (LEARNED_FIRST + LEARNED_SLOTS)
#define LISTS_SLOTS 125 /* dialect_lists.h */
#define TEXTURES_FIRST (LISTS_FIRST + LISTS_SLOTS)
#define TEXTURES_SLOTS 17 /* dialect_textures.h */
#define PRESAMPLED_FIRST (TEXTURES_FIRST + TEXTURES_SLOTS)
#define PRESAMPLED_SLOTS 32 /* dialect_presampled.h */
#define PRIMARY_FIRST (PRESAMPLED_FIRST + PRESAMPLED_SLOTS)
#define PRIMARY_SLOTS 24 /* dialect_primary.h */
#define ITEM_SLOTS (PRIMARY_FIRST + PRIMARY_SLOTS)
#define TILE_WORDS 3840 /* of memory for a tile */

#endif
