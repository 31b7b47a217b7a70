/* core/influence_rule.h: which lights are best listed at a point, from what they would give it.
 *
 * Of m draws b come from a list of n lights and u from all N. A light that is seen and gives e lux adds e^2 n / b to
 * the second moment of the estimate if it is listed, e^2 N / u if it is not; and what shows is that over the square of
 * what arrives in all. Which lights are seen is not known beforehand. Where the strongest is hidden, the square of the
 * others' light is all there is to compare with, and a list that was made for the strongest alone leaves just those to
 * the draws from all lights. So the rule takes the mean over what may be hidden: each light is seen with probability v,
 * independently. Places differ in how much they see, so v takes several values, and the loss is the mean over them.
 * With lights in order, e_1 >= e_2 ..., the strongest that is seen is j with probability v (1 - v)^(j - 1), what
 * arrives then is about
 *
 *     L_j = e_j + v sum_{l > j} e_l + floor,
 *
 * and the loss of a list of the first n is, but for what no list changes,
 *
 *     n / b sum_{i <= n} a_i - N / u sum_{i <= n} a_i,    a_i = e_i^2 (sum_{j < i} v (1 - v)^(j - 1) / L_j^2 + (1 -
 * v)^(i - 1) / L_i^2).
 *
 * The floor is light that is too little to be seen. Lights come in bins of half an octave; a bin adds up its lights in
 * their order. The rule steers the noise only: whatever it says, densities are exact. Includers supply rule_bin_load
 * and rule_bin_store. */
#ifndef CORE_INFLUENCE_RULE_H
#define CORE_INFLUENCE_RULE_H

#include "core/dialect.h"

/* a float's bits above the shift: two bins an octave */
#define RULE_SHARES 4
#define RULE_BINS 48
#define RULE_SHIFT 22

struct influence_rule {
    /* v, of as many surface points each: a light that they face is seen with that probability */
    f1 seen[RULE_SHARES];
    f1 floor_; /* lux */
};

/* Sums over the lights of a bin. */
struct rule_bin {
    f1 lights;
    f1 e;
    f1 e2;
    f1 unused;
};

/* Where the bins lie: bits of the least e in the first one, shifted; no list goes below `least`, which is over 0. */
struct rule_range {
    u1 base;
    f1 least;
};

#ifndef CORE_GLSL
typedef struct influence_rule influence_rule;
typedef struct rule_bin rule_bin;
typedef struct rule_range rule_range;
#endif

FN rule_bin rule_bin_load(CTX u1 i);
FN void rule_bin_store(CTX u1 i, rule_bin bin);

FN1 rule_range rule_from(f1 least) {
    rule_range r;
    r.base = shr(bits_of_f1(least), RULE_SHIFT);
    r.least = least;
    return r;
}

FN1 rule_bin rule_bin_empty(void) {
    rule_bin none;
    none.lights = 0.0f;
    none.e = 0.0f;
    none.e2 = 0.0f;
    none.unused = 0.0f;
    return none;
}

/* Empties the bins. */
FN1 rule_range rule_begin(CTX f1 least) {
    for (u1 i = 0u; i < U32(RULE_BINS); i++)
        rule_bin_store(PASS i, rule_bin_empty());
    return rule_from(least);
}

/* The bin of lights that give e lux: 0 is the weakest. */
FN1 u1 rule_place(rule_range r, f1 e) {
    u1 bits = shr(bits_of_f1(e), RULE_SHIFT);
    u1 place = 0u;
    if (bits > r.base)
        place = minu1(bits - r.base, U32(RULE_BINS) - 1u);
    return place;
}

/* A bin with so many lights more that give e lux each. */
FN1 rule_bin rule_bin_add(rule_bin bin, f1 lights, f1 e) {
    EXACT f1 all = lights * e;
    EXACT f1 squares = all * e;
    bin.lights = bin.lights + lights;
    bin.e = bin.e + all;
    bin.e2 = bin.e2 + squares;
    return bin;
}

/* Lights that give e lux each. */
FN1 void rule_add(CTX rule_range r, f1 lights, f1 e) {
    u1 i = rule_place(r, e);
    rule_bin_store(PASS i, rule_bin_add(rule_bin_load(PASS i), lights, e));
}

/* The least e of bin i. */
FN1 f1 rule_edge(rule_range r, u1 i) { return max1(f1_of_bits(shl(r.base + i, RULE_SHIFT)), r.least); }

/* The least e that lists no more lights than `most`, or those of one bin. */
FN1 f1 rule_limit(CTX rule_range r, f1 most) {
    u1 i = U32(RULE_BINS) - 1u;
    f1 lights = rule_bin_load(PASS i).lights;
    b1 on = true;
    while (i > 0u && on) {
        lights = lights + rule_bin_load(PASS i - 1u).lights;
        on = lights <= most;
        if (on)
            i--;
    }
    return rule_edge(r, i);
}

/* Chance that so many lights are hidden, each for itself. */
FN1 f1 rule_hidden(f1 seen, f1 lights) {
    f1 all = 1.0f;
    for (f1 k = 0.5f; k < lights && all > 1e-4f; k = k + 1.0f)
        all = all * (1.0f - seen);
    return all;
}

/* The least e on the list with the least loss, of n_l lights in the scene and draws of which every `every`th is from
 * all of them; 0: it has all lights that there are, and there might be use for more. */
FN1 f1 rule_best(CTX rule_range r, influence_rule rule, f1 n_l, f1 every) {
    f1 beyond[RULE_BINS]; /* what all weaker bins give */
    f1 chance[RULE_SHARES];
    f1 sum = 0.0f;
    f1 gone = 0.0f;
    f1 a = 0.0f;
    f1 lights = 0.0f;
    f1 least = 0.0f;
    u1 best = U32(RULE_BINS); /* none */
    u1 last = U32(RULE_BINS);
    for (u1 i = 0u; i < U32(RULE_BINS); i++) {
        beyond[i] = sum;
        sum = sum + rule_bin_load(PASS i).e;
    }
    for (u1 k = 0u; k < U32(RULE_SHARES); k++)
        chance[k] = 1.0f / F32(RULE_SHARES);
    for (u1 above = U32(RULE_BINS); above > 0u; above--) {
        u1 i = above - 1u;
        rule_bin bin = rule_bin_load(PASS i);
        if (bin.lights > 0.0f) {
            EXACT f1 e = bin.e / bin.lights;
            f1 now = 0.0f;
            f1 then = 0.0f;
            for (u1 k = 0u; k < U32(RULE_SHARES); k++) {
                f1 hidden = 0.0f;
                f1 inverse = 0.0f;
                if (chance[k] > 1e-4f)
                    hidden = rule_hidden(rule.seen[k], bin.lights);
                EXACT f1 all = e + rule.seen[k] * (beyond[i] + bin.e - e) + rule.floor_;
                EXACT f1 square = all * all;
                EXACT f1 one = 1.0f / square;
                if (all > 0.0f)
                    inverse = one;
                EXACT f1 now_k = chance[k] * inverse;
                EXACT f1 then_k = chance[k] * (1.0f - hidden) * inverse;
                now = now + now_k;
                then = then + then_k;
                chance[k] = chance[k] * hidden;
            }
            EXACT f1 more = bin.e2 * (gone + now);
            a = a + more;
            gone = gone + then;
            lights = lights + bin.lights;
            last = i;
            EXACT f1 loss = a * (lights / (every - 1.0f) - n_l);
            if (loss < least) {
                least = loss;
                best = i;
            }
        }
    }
    f1 found = 0.0f;
    if (best > 0u && best < U32(RULE_BINS) && best != last)
        found = rule_edge(r, best);
    return found;
}

#endif
