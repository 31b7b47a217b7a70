/* light/influence_rule: which lights are best listed at a point, from what they would give it.
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
 *     n / b sum_{i <= n} a_i - N / u sum_{i <= n} a_i,
 *     a_i = e_i^2 (sum_{j < i} v (1 - v)^(j - 1) / L_j^2 + (1 - v)^(i - 1) / L_i^2).
 *
 * The floor is light that is too little to be seen. Lights come in bins of half an octave. The rule steers the noise
 * only: whatever it says, densities are exact. */
#ifndef NOC_LIGHT_INFLUENCE_RULE_H
#define NOC_LIGHT_INFLUENCE_RULE_H

#include "base/base.h"

#include <math.h>
#include <string.h>

/* a float's bits above the shift: two bins an octave */
enum { NOC_RULE_SHARES = 4, NOC_RULE_BINS = 48, NOC_RULE_SHIFT = 22 };

typedef struct noc_influence_rule {
    /* v, of as many surface points each: a light that they face is seen with that probability */
    float seen[NOC_RULE_SHARES];
    float floor; /* lux */
} noc_influence_rule;

typedef struct noc_influence_bin { /* sums */
    float lights, e, e2, unused;
} noc_influence_bin;

/* Bin 0 is the weakest. */
typedef struct noc_influence_bins {
    noc_influence_bin bin[NOC_RULE_BINS];
    uint32_t base; /* bits of the least e in bin 0, shifted */
    float least;   /* no list goes below that */
} noc_influence_bins;

static inline uint32_t noc_rule_bits(float e) {
    uint32_t bits;
    memcpy(&bits, &e, sizeof(bits));
    return bits >> NOC_RULE_SHIFT;
}

/* least > 0. */
static inline void noc_rule_begin(noc_influence_bins *b, float least) {
    memset(b->bin, 0, sizeof(b->bin));
    b->base = noc_rule_bits(least);
    b->least = least;
}

/* Lights that give e lux each. */
static inline void noc_rule_add(noc_influence_bins *b, float lights, float e) {
    uint32_t bits = noc_rule_bits(e);
    noc_influence_bin *bin = &b->bin[bits > b->base ? NOC_MIN(bits - b->base, (uint32_t)NOC_RULE_BINS - 1) : 0];
    float all = lights * e;
    bin->lights += lights;
    bin->e += all;
    bin->e2 += all * e;
}

/* The least e of bin i. */
static inline float noc_rule_edge(const noc_influence_bins *b, int i) {
    uint32_t bits = (b->base + (uint32_t)i) << NOC_RULE_SHIFT;
    float e;
    memcpy(&e, &bits, sizeof(e));
    return fmaxf(e, b->least);
}

/* The least e that lists no more lights than `most`, or those of one bin. */
static inline float noc_rule_limit(const noc_influence_bins *b, float most) {
    int i = NOC_RULE_BINS - 1;
    for (float lights = b->bin[i].lights; i > 0 && (lights += b->bin[i - 1].lights) <= most;)
        i--;
    return noc_rule_edge(b, i);
}

/* Chance that so many lights are hidden, each for itself. */
static inline float noc_rule_hidden(float seen, float lights) {
    float all = 1;
    for (float k = 0.5f; k < lights && all > 1e-4f; k++)
        all *= 1 - seen;
    return all;
}

/* The least e on the list with the least loss; 0: it has all lights that there are, and there might be use for more. */
static inline float noc_rule_best(const noc_influence_bins *b, float n_l, int every, noc_influence_rule rule) {
    float sum = 0, beyond[NOC_RULE_BINS], gone = 0, chance[NOC_RULE_SHARES], a = 0, lights = 0, least = 0;
    int best = -1, last = -1;
    for (int i = 0; i < NOC_RULE_BINS; i++) {
        beyond[i] = sum;
        sum += b->bin[i].e;
    }
    for (int k = 0; k < NOC_RULE_SHARES; k++)
        chance[k] = 1.0f / NOC_RULE_SHARES;
    for (int i = NOC_RULE_BINS - 1; i >= 0; i--) {
        const noc_influence_bin *bin = &b->bin[i];
        if (bin->lights == 0)
            continue;
        float e = bin->e / bin->lights, now = 0, then = 0;
        for (int k = 0; k < NOC_RULE_SHARES; k++) {
            float hidden = chance[k] > 1e-4f ? noc_rule_hidden(rule.seen[k], bin->lights) : 0;
            float all = e + rule.seen[k] * (beyond[i] + bin->e - e) + rule.floor,
                  inverse = all > 0 ? 1 / (all * all) : 0;
            now += chance[k] * inverse;
            then += chance[k] * (1 - hidden) * inverse;
            chance[k] *= hidden;
        }
        a += bin->e2 * (gone + now);
        gone += then;
        lights += bin->lights;
        last = i;
        float loss = a * (lights / (float)(every - 1) - n_l);
        if (loss < least) {
            least = loss;
            best = i;
        }
    }
    if (best <= 0 || best == last)
        return 0;
    return noc_rule_edge(b, best);
}

#endif
