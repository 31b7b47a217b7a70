/* core/sources.h: where a pixel's light comes from: what lights add to its colour, summed up by a label of the light.
 * A pixel has a few slots for labels. Where there are more labels than slots, the one with the least light is replaced
 * and leaves its sum to the new one (the Space-Saving summary of Metwally, Agrawal and El Abbadi, 2005), so that
 * whatever brings more than 1 / slots of the light has a slot, and no sum is too large by more than that. */
#ifndef CORE_SOURCES_H
#define CORE_SOURCES_H

#include "core/dialect.h"
#include "core/records.h"

#define SOURCE_SLOTS 8u   /* of groups of lights, and of how lights were placed */
#define EMITTER_SLOTS 16u /* of emitters, whose summary has the sum of the sky's light behind it */

/* Includers supply the label of slot i of the pixel at hand, below 0 where it is free, and its sum. */
FN1 f1 source_label(CTX u1 i);
FN1 f1 source_sum(CTX u1 i);

/* The slot that a label's light goes to, and the sum that is there already. */
struct source_slot {
    u1 at;
    f1 sum;
};

#ifndef CORE_GLSL
typedef struct source_slot source_slot;
#endif

FN1 source_slot source_find(CTX u1 slots, f1 label) {
    source_slot s;
    s.at = 0u;
    for (u1 i = 0u; i < slots; i++) {
        f1 held = source_label(PASS i);
        if (held == label || held < 0.0f) {
            s.at = i;
            break;
        }
        if (source_sum(PASS i) < source_sum(PASS s.at))
            s.at = i;
    }
    s.sum = 0.0f;
    if (!(source_label(PASS s.at) < 0.0f))
        s.sum = source_sum(PASS s.at);
    return s;
}

/* Labels of a light by its flags: its group, and how it was placed (noc_placed). */
FN1 f1 source_group(u1 flags) { return F32(flags >> LIGHT_GROUP); }

FN1 f1 source_placed(u1 kind, u1 flags) {
    b1 flat_ = kind == LIGHT_TRIANGLE || kind == LIGHT_PARALLELOGRAM;
    f1 placed = 1.0f;
    if (flat_ || (flags & LIGHT_MOVES) != 0u)
        placed = 0.0f;
    else if ((flags & LIGHT_INFERRED) != 0u)
        placed = 2.0f;
    return placed;
}

#endif
