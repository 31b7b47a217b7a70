/* core/list_groups.h: scores in groups of 16, and what is asked of many groups at once. These are all the operations of
 * light lists that are of a group and not of a lane: C has them over vectors, a shader one place after the other or in
 * a work group of 16, with sums in the same order.
 *
 * Includers supply the bridge below. In C, score_row is the 16 scores of a group in a row. */
#ifndef CORE_LIST_GROUPS_H
#define CORE_LIST_GROUPS_H

#include "core/dialect.h"
#include "core/list_limits.h"

FN real score_load(CTX u1 group, int l); /* places l to l + LANES - 1 */
FN void score_store(CTX u1 group, int l, real score);
FN f1 score_at(CTX u1 group, u1 place);
FN void score_clear(CTX u1 group, u1 place);
FN void chosen_store(CTX u1 i, u1 place); /* place: 16 * group + place in it */
FN u1 chosen_load(CTX u1 i);
#ifndef CORE_GLSL
FN const float *score_row(CTX u1 group);
#endif

/* (x0 + x8) + (x4 + x12) and so on, then 0 and 2, then 1 and 3: whatever the lanes. */
#ifndef CORE_GLSL
FN f1 score_sum(CTX u1 group) {
    typedef float four __attribute__((vector_size(16)));
    four a[4];
    __builtin_memcpy(a, score_row(PASS group), sizeof(a));
    four q = (a[0] + a[2]) + (a[1] + a[3]);
    return (q[0] + q[2]) + (q[1] + q[3]);
}
#else
f1 score_quarter(u1 group, u1 i) {
    EXACT f1 q = (score_at(group, i) + score_at(group, i + 8u)) + (score_at(group, i + 4u) + score_at(group, i + 12u));
    return q;
}
f1 score_sum(u1 group) {
    EXACT f1 sum =
        (score_quarter(group, 0u) + score_quarter(group, 2u)) + (score_quarter(group, 1u) + score_quarter(group, 3u));
    return sum;
}
#endif

/* How many of the groups' scores are t or more. t > 0. */
FN1 u1 scores_over(CTX u1 begin, u1 end, f1 t) {
    u32 sum = KU(0u);
    for (u1 g = begin; g < end; g++)
        EACH16(l)
    sum = sum + selu(score_load(PASS g, l) >= K(t), KU(1u), KU(0u));
    return EACH16_SUM(lane_sum(sum));
}

/* Which of a group's are. */
FN1 u1 places_over(CTX u1 group, f1 t) {
    u1 bits = 0u;
    EACH16(l)
    bits = bits | lane_bits(score_load(PASS group, l) >= K(t)) << l;
    return EACH16_SUM(bits);
}

/* Scores are told apart by their exponents and the top two bits of their fractions: 8 to 19 per cent. */
FN1 f1 score_step(u1 step) { return f1_of_bits(step << 21); }

/* Chooses the `most` largest of the scores above 0, in the order of their places; of those that share the last step the
 * first ones are taken. Returns how many. */
FN1 u1 choose_largest(CTX u1 begin, u1 end, u1 most) {
    u1 low = 1u;
    u1 high = U32(SCORE_STEPS); /* the lowest step known to have no more than `most` at or above it */
    while (low < high) {
        u1 mid = (low + high) / 2u;
        if (scores_over(PASS begin, end, score_step(mid)) <= most)
            high = mid;
        else
            low = mid + 1u;
    }
    f1 sure = score_step(high);
    f1 tie = sure;
    if (high > 1u)
        tie = score_step(high - 1u);
    u1 room = most - scores_over(PASS begin, end, sure);
    u1 n = 0u;
    for (u1 g = begin; g < end && n < most; g++) {
        u1 over = places_over(PASS g, sure);
        for (u1 bits = places_over(PASS g, tie); bits != 0u; bits = bits & (bits - 1u)) {
            u1 place = low_bit(bits);
            b1 sharing = (over >> place & 1u) == 0u;
            if (!sharing || room > 0u) {
                chosen_store(PASS n, 16u * g + place);
                n++;
                if (sharing)
                    room--;
            }
        }
    }
    return n;
}

/* Sums that keep what plain ones lose, in two numbers: as many draws as there are groups do not wear them down
 * (D. Knuth, The Art of Computer Programming 2, 4.2.2, theorem B). */
struct long_sum {
    f1 high;
    f1 low;
};

#ifndef CORE_GLSL
typedef struct long_sum long_sum;
#endif

FN1 long_sum long_add(long_sum a, f1 b) {
    long_sum s;
    EXACT f1 sum = a.high + b;
    EXACT f1 part = sum - a.high;
    EXACT f1 lost = (a.high - (sum - part)) + (b - part);
    EXACT f1 low = a.low + lost;
    EXACT f1 high = sum + low;
    EXACT f1 rest = low - (high - sum);
    s.high = high;
    s.low = rest;
    return s;
}

FN1 f1 long_difference(long_sum a, long_sum b) {
    EXACT f1 d = (a.high - b.high) + (a.low - b.low);
    return d;
}

#endif
