/* light/influence_rule: records of the rule that says which lights are best listed at a point (core/influence_rule.h).
 */
#ifndef NOC_LIGHT_INFLUENCE_RULE_H
#define NOC_LIGHT_INFLUENCE_RULE_H

#include <stdint.h>

enum { NOC_RULE_SHARES = 4, NOC_RULE_BINS = 48 }; /* RULE_SHARES, RULE_BINS */

typedef struct noc_influence_rule { /* struct influence_rule */
    float seen[NOC_RULE_SHARES];
    float floor; /* lux */
} noc_influence_rule;

typedef struct noc_influence_bin { /* struct rule_bin */
    float lights, e, e2, unused;
} noc_influence_bin;

/* Bin 0 is the weakest. */
typedef struct noc_influence_bins {
    noc_influence_bin bin[NOC_RULE_BINS];
} noc_influence_bins;

#endif
