/* light/influence_rule: the S_r that draws best at a point, from what its lights would give it.
 *
 * Of m draws b come from a list of n lights and u from all N. A light that is seen and gives e lux adds e^2 n / b to the second
 * moment of the estimate if it is listed, e^2 N / u if it is not; and what shows is that over the square of what arrives in
 * all. Which lights are seen is not known beforehand. Where the strongest is hidden, the square of the others' light is all
 * there is to compare with, and a list that was made for the strongest alone leaves just those to the draws from all lights. So
 * the rule takes the mean over what may be hidden: each light is seen with probability v, independently. With lights in order,
 * e_1 >= e_2 ..., the strongest that is seen is j with probability v (1 - v)^(j - 1), what arrives then is about
 *
 *     L_j = e_j + v sum_{l > j} e_l + floor,
 *
 * and the loss of a list of the first n is, but for what no list changes,
 *
 *     n / b sum_{i <= n} a_i - N / u sum_{i <= n} a_i,    a_i = e_i^2 (sum_{j < i} v (1 - v)^(j - 1) / L_j^2 + (1 - v)^(i - 1) / L_i^2).
 *
 * The floor is light that is too little to be seen. Lights come in bins, a quarter of an octave of S_r each. The rule steers the
 * noise only: whatever S_r it says, densities are exact. */
#ifndef NOC_LIGHT_INFLUENCE_RULE_H
#define NOC_LIGHT_INFLUENCE_RULE_H

#include "base/base.h"

#include <math.h>
#include <string.h>

enum { NOC_RULE_BINS = 48, NOC_RULE_SHIFT = 21 }; /* a float's bits above the shift: four bins an octave */

typedef struct noc_influence_rule {
    float seen;  /* v: a light that a surface faces is seen from it with that probability */
    float floor; /* lux */
} noc_influence_rule;

/* Bin 0 is the last to be listed. */
typedef struct noc_influence_bins {
    float lights[NOC_RULE_BINS], e[NOC_RULE_BINS], e2[NOC_RULE_BINS]; /* sums */
    uint32_t top; /* bits of the S_r in bin 0, shifted */
} noc_influence_bins;

static inline uint32_t noc_rule_bits(float scale) {
    uint32_t bits;
    memcpy(&bits, &scale, sizeof(bits));
    return bits >> NOC_RULE_SHIFT;
}

/* No light needs more than `scale`. */
static inline void noc_rule_begin(noc_influence_bins *b, float scale) {
    memset(b, 0, sizeof(*b));
    b->top = noc_rule_bits(scale);
}

/* Lights that need the S_r `needs`, and give e lux each. */
static inline void noc_rule_add(noc_influence_bins *b, float needs, float lights, float e) {
    uint32_t at = noc_rule_bits(needs > 0 ? needs : 0);
    at = b->top > at ? NOC_MIN(b->top - at, (uint32_t)NOC_RULE_BINS - 1) : 0;
    b->lights[at] += lights;
    b->e[at] += lights * e;
    b->e2[at] += lights * e * e;
}

/* The S_r of bin i's far end. */
static inline float noc_rule_edge(const noc_influence_bins *b, int i) {
    uint32_t bits = (b->top - (uint32_t)i + 1) << NOC_RULE_SHIFT;
    float scale;
    memcpy(&scale, &bits, sizeof(scale));
    return scale;
}

/* The largest S_r that lists no more lights than `most`, or those of one bin. */
static inline float noc_rule_limit(const noc_influence_bins *b, float most) {
    int i = NOC_RULE_BINS - 1;
    for (float lights = b->lights[i]; i > 0 && (lights += b->lights[i - 1]) <= most;)
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

/* The S_r of the list with the least loss; INFINITY: all lights that there are, and there might be use for more. */
static inline float noc_rule_best(const noc_influence_bins *b, float n_l, int every, noc_influence_rule rule) {
    float seen = rule.seen, floor = rule.floor;
    float beyond[NOC_RULE_BINS], sum = 0, gone = 0, chance = 1, a = 0, lights = 0, least = 0;
    int best = -1, last = -1;
    for (int i = 0; i < NOC_RULE_BINS; i++) {
        beyond[i] = sum;
        sum += b->e[i];
    }
    for (int i = NOC_RULE_BINS - 1; i >= 0; i--) {
        if (b->lights[i] == 0)
            continue;
        float e = b->e[i] / b->lights[i], hidden = chance > 1e-4f ? noc_rule_hidden(seen, b->lights[i]) : 0;
        float all = e + seen * (beyond[i] + b->e[i] - e) + floor, inverse = all > 0 ? 1 / (all * all) : 0;
        a += b->e2[i] * (gone + chance * inverse);
        gone += chance * (1 - hidden) * inverse;
        chance *= hidden;
        lights += b->lights[i];
        last = i;
        float loss = a * (lights / (float)(every - 1) - n_l);
        if (loss < least) {
            least = loss;
            best = i;
        }
    }
    if (best <= 0 || best == last)
        return INFINITY;
    return noc_rule_edge(b, best);
}

#endif
