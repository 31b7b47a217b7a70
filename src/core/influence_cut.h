/* core/influence_cut.h: the pixels of a tile in sixteens, each of which chooses among one set of samples
 * (core/influence_draw.h).
 *
 * A block whose pixels ask as one is a sixteen as it is. The pixels of the other blocks are sorted by their group and
 * cut every 16 pixels, so there are no more sixteens than blocks. Sixteens of one group share sets; one whose pixels do
 * not ask as one has a set of its own. Includers supply the bridges. */
#ifndef CORE_INFLUENCE_CUT_H
#define CORE_INFLUENCE_CUT_H

#include "core/influence_limits.h"

#define CUT_MIXED 0xffffu /* in place of a group: the pixels have several */
#define CUT_SEVERAL 0xffu /* in place of a block: the pixels are of several */

struct influence_sixteen {
    u1 group; /* or CUT_MIXED */
    u1 block; /* its pixels are all of that block that see a surface; or CUT_SEVERAL: */
    u1 first; /* they are `count` sorted pixels from that place on */
    u1 count;
    u1 set; /* number in the tile */
};

#ifndef CORE_GLSL
typedef struct influence_sixteen influence_sixteen;
#endif

FN u1 cut_lanes(CTX u1 block);          /* pixels that see a surface, as bits */
FN u1 cut_group(CTX u1 block, u1 lane); /* the group of such a pixel: 1 to groups - 1 */
/* Scratch: a number for each group, and for `groups`. */
FN void cut_place_store(CTX u1 group, u1 place);
FN u1 cut_place(CTX u1 group);
FN void cut_pixel_store(CTX u1 place, u1 pixel); /* sorted: 16 * block + lane */
FN u1 cut_pixel(CTX u1 place);
FN void sixteen_store(CTX u1 i, influence_sixteen s);
FN influence_sixteen sixteen_load(CTX u1 i);

/* The group of all of a block's lanes, of which there are some, or CUT_MIXED. */
FN u1 cut_group_of(CTX u1 block, u1 lanes) {
    u1 group = cut_group(PASS block, low_bit(lanes));
    u1 found = group;
    for (u1 bits = lanes; bits != 0u && found == group; bits = bits & (bits - 1u))
        if (cut_group(PASS block, low_bit(bits)) != group)
            found = CUT_MIXED;
    return found;
}

FN1 influence_sixteen sixteen_of(u1 group, u1 block, u1 first, u1 count) {
    influence_sixteen s;
    s.group = group;
    s.block = block;
    s.first = first;
    s.count = count;
    s.set = 0u;
    return s;
}

/* Sorts the pixels of these blocks by group; returns how many. */
FN u1 cut_sort(CTX u1 mixed, u1 groups) {
    u1 count = 0u;
    for (u1 k = 0u; k <= groups; k++)
        cut_place_store(PASS k, 0u);
    for (u1 blocks = mixed; blocks != 0u; blocks = blocks & (blocks - 1u)) {
        u1 i = low_bit(blocks);
        for (u1 bits = cut_lanes(PASS i); bits != 0u; bits = bits & (bits - 1u)) {
            u1 k = cut_group(PASS i, low_bit(bits)) + 1u;
            cut_place_store(PASS k, cut_place(PASS k) + 1u);
            count++;
        }
    }
    for (u1 k = 0u; k < groups; k++)
        cut_place_store(PASS k + 1u, cut_place(PASS k + 1u) + cut_place(PASS k));
    for (u1 blocks = mixed; blocks != 0u; blocks = blocks & (blocks - 1u)) {
        u1 i = low_bit(blocks);
        for (u1 bits = cut_lanes(PASS i); bits != 0u; bits = bits & (bits - 1u)) {
            u1 k = cut_group(PASS i, low_bit(bits));
            u1 place = cut_place(PASS k);
            cut_pixel_store(PASS place, i * 16u + low_bit(bits));
            cut_place_store(PASS k, place + 1u);
        }
    }
    return count;
}

FN u1 cut_group_at(CTX u1 place) {
    u1 pixel = cut_pixel(PASS place);
    return cut_group(PASS shr(pixel, 4), pixel & 15u);
}

/* Sixteens by group; those of one group keep their order. */
FN void cut_order(CTX u1 n) {
    for (u1 i = 1u; i < n; i++) { /* few, and mostly in order */
        influence_sixteen s = sixteen_load(PASS i);
        u1 k = i;
        b1 on = true;
        while (k > 0u && on) {
            influence_sixteen before = sixteen_load(PASS k - 1u);
            on = before.group > s.group;
            if (on) {
                sixteen_store(PASS k, before);
                k--;
            }
        }
        sixteen_store(PASS k, s);
    }
}

/* Cuts a tile of so many blocks and groups; returns how many sixteens there are, in the order of their groups. */
FN u1 cut_tile(CTX u1 blocks, u1 groups) {
    u1 mixed = 0u;
    u1 n = 0u;
    for (u1 i = 0u; i < blocks; i++) {
        u1 lanes = cut_lanes(PASS i);
        if (lanes != 0u) {
            u1 group = cut_group_of(PASS i, lanes);
            if (group == CUT_MIXED) {
                mixed = mixed | shl(1u, i);
            } else {
                sixteen_store(PASS n, sixteen_of(group, i, 0u, 16u));
                n++;
            }
        }
    }
    u1 left = cut_sort(PASS mixed, groups);
    for (u1 first = 0u; first < left; first = first + 16u) {
        u1 count = minu1(left - first, 16u);
        u1 group = cut_group_at(PASS first);
        if (cut_group_at(PASS first + count - 1u) != group)
            group = CUT_MIXED;
        sixteen_store(PASS n, sixteen_of(group, CUT_SEVERAL, first, count));
        n++;
    }
    cut_order(PASS n);
    return n;
}

/* Gives n sixteens their sets; returns how many sets there are. */
FN u1 cut_sets(CTX u1 n) {
    u1 sets = 0u;
    u1 end = 0u;
    for (u1 first = 0u; first < n; first = end) {
        u1 group = sixteen_load(PASS first).group;
        end = first + 1u;
        while (group != CUT_MIXED && end < n && sixteen_load(PASS end).group == group)
            end++;
        u1 own = influence_sets(end - first);
        for (u1 i = first; i < end; i++) {
            influence_sixteen s = sixteen_load(PASS i);
            s.set = sets + (i - first) % own;
            sixteen_store(PASS i, s);
        }
        sets = sets + own;
    }
    return sets;
}

#endif
