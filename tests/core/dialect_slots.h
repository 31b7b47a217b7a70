/* Slots of the dialect test: each file of functions has its own, one after the other. */
#ifndef DIALECT_SLOTS_H
#define DIALECT_SLOTS_H

#define KERNEL_SLOTS 179 /* dialect_kernel.h */
#define FRAME_FIRST KERNEL_SLOTS
#define FRAME_SLOTS 61 /* dialect_frame.h */
#define ITEM_SLOTS (FRAME_FIRST + FRAME_SLOTS)

#endif
