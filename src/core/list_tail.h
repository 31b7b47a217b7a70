/* core/list_tail.h: a line of whole numbers that the tail of a list is drawn from. Each score has a part of it, in
 * proportion to the score and never 0 where the score is not; draws are an equal number of steps apart. All that
 * decides where a draw falls is whole, so it is the same on every machine, and the weight of what is found is the
 * reciprocal of the probability with which it is found: rounding moves probabilities, not means. */
#ifndef CORE_LIST_TAIL_H
#define CORE_LIST_TAIL_H

#include "core/list_groups.h"

/* Draws on a line of parts: every `step` one, from `first` on. rest: what rounding took from `first`, 0 to 1. The line
 * is as long as all steps, so that a draw may fall beyond its last part. */
struct tail_line {
    u1 step;
    u1 first;
    f1 rest;
};

/* A place among 16, and where in it: 0 to 1. place 16: none. */
struct list_place {
    u1 place;
    f1 at;
};

#ifndef CORE_GLSL
typedef struct tail_line tail_line;
typedef struct list_place list_place;
#endif

/* A power of two, with which scores that add up to about `total` have parts that add up to less than 2^31. */
FN1 f1 tail_scale(f1 total) { return f1_of_bits(minu1(283u - shr(bits_of_f1(total), 23), 254u) << 23); }

/* The parts of scores. */
FN u32 tail_parts(real score, f1 scale) {
    EXACT real part = score * K(scale);
    return to_u32(part) + selu(score > K(0.0f), KU(1u), KU(0u));
}

FN1 u1 tail_part(f1 score, f1 scale) {
    EXACT f1 part = score * scale;
    return U32(part) + U32(score > 0.0f);
}

/* all: parts of the line. start: 32 bits (core/random.h, tail_start). */
FN1 tail_line tail_line_of(u1 all, u1 draws, u1 start) {
    tail_line line;
    line.step = (all + draws - 1u) / draws;
    line.first = high_u1(start, line.step);
    EXACT f1 rest = F32(shr(start * line.step, 8)) * 5.9604644775390625e-8f;
    line.rest = rest;
    return line;
}

/* The place of a group where part number `goal` of the group's lies. */
FN1 list_place tail_place(CTX u1 group, f1 scale, u1 goal, f1 rest) {
    list_place p;
    u1 left = goal;
    u1 i = 0u;
    u1 part = tail_part(score_at(PASS group, 0u), scale);
    while (left >= part && i < 15u) {
        left = left - part;
        i++;
        part = tail_part(score_at(PASS group, i), scale);
    }
    EXACT f1 at = (F32(left) + rest) / F32(part);
    p.place = i;
    p.at = min1(at, 1.0f);
    return p;
}

/* The weight of a light that was found with probability `share` below a place of that score. */
FN1 f1 tail_weight(tail_line line, f1 score, f1 scale, f1 share) {
    EXACT f1 weight = F32(line.step) / F32(tail_part(score, scale)) / share;
    return weight;
}

#endif
