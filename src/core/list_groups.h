/* core/list_groups.h: scores in groups of 16, and what is computed of many groups together.
 *
 * Counts decide what is chosen, and whole numbers have no order in which they are added up. So C halves the range of
 * scores over vectors, and a work group (CORE_WORKERS) makes a histogram. The one sum of floats, groups_sum, is a tree
 * of fixed shape.
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
#ifndef CORE_GLSL
FN const float *score_row(CTX u1 group);
#endif

/* The scores of step `sure` and above are chosen, and `room` of the step below: the first ones. */
struct score_cut {
    u1 sure;
    u1 room;
};

#ifndef CORE_GLSL
typedef struct score_cut score_cut;
#endif

/* ---- sums ---- */

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

/* Of groups k, k + 16, ... below `end`, in order. */
FN real column_sum(CTX u1 k, u1 end, int l) {
    real sum = K(0.0f);
    for (u1 g = k; g < end; g += 16u) {
        EXACT real more = sum + score_load(PASS g, l);
        sum = more;
    }
    return sum;
}

#ifdef CORE_WORKERS
f1 groups_sum(u1 end);
u1 some_scores(u1 begin, u1 end);
u1 scores_over(u1 begin, u1 end, f1 t);
score_cut cut_scores(u1 begin, u1 end, u1 most);
#else

FN real quarter_sum(CTX u1 k, u1 end, int l) {
    EXACT real sum = (column_sum(PASS k, end, l) + column_sum(PASS k + 8u, end, l)) +
                     (column_sum(PASS k + 4u, end, l) + column_sum(PASS k + 12u, end, l));
    return sum;
}

/* Of groups 0 to end - 1: those that are 16 apart in order, then these 16 sums in halves, then the 16 places in halves.
 * Overwrites group LIST_SPARE. */
FN1 f1 groups_sum(CTX u1 end) {
    EACH16(l) {
        EXACT real sum = (quarter_sum(PASS 0u, end, l) + quarter_sum(PASS 2u, end, l)) +
                         (quarter_sum(PASS 1u, end, l) + quarter_sum(PASS 3u, end, l));
        score_store(PASS U32(LIST_SPARE), l, sum);
    }
    return score_sum(PASS U32(LIST_SPARE));
}

/* ---- counts ---- */

/* How many of the groups' scores are t or more. t > 0. */
FN1 u1 scores_over(CTX u1 begin, u1 end, f1 t) {
    u32 sum = KU(0u);
    for (u1 g = begin; g < end; g++)
        EACH16(l)
    sum = sum + selu(score_load(PASS g, l) >= K(t), KU(1u), KU(0u));
    return EACH16_SUM(lane_sum(sum));
}

#define LEAST_SCORE 1.17549435e-38f /* the least normal number */

FN1 u1 some_scores(CTX u1 begin, u1 end) { return scores_over(PASS begin, end, LEAST_SCORE); }

/* Which of a group's are. */
FN1 u1 places_over(CTX u1 group, f1 t) {
    u1 bits = 0u;
    EACH16(l)
    bits = bits | lane_bits(score_load(PASS group, l) >= K(t)) << l;
    return EACH16_SUM(bits);
}

/* Scores are told apart by their exponents and the top two bits of their fractions: 8 to 19 per cent. */
FN1 f1 score_step(u1 step) { return f1_of_bits(step << 21); }

/* Where the `most` largest of the scores above 0 are cut off. */
FN1 score_cut cut_scores(CTX u1 begin, u1 end, u1 most) {
    score_cut c;
    u1 low = 1u;
    u1 over = 0u;
    c.sure = U32(SCORE_STEPS); /* the lowest step known to have no more than `most` at or above it */
    while (low < c.sure) {
        u1 mid = (low + c.sure) / 2u;
        u1 n = scores_over(PASS begin, end, score_step(mid));
        if (n <= most) {
            c.sure = mid;
            over = n;
        } else
            low = mid + 1u;
    }
    c.room = most - over;
    return c;
}

#endif
#endif
