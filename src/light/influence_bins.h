/* light/influence_bins: the bridge between core/influence_rule.h and the records of light/influence_rule.h. Includers
 * define before it what gives the bins of a context: RULE_BINS_OF(ctx). */
#ifndef NOC_LIGHT_INFLUENCE_BINS_H
#define NOC_LIGHT_INFLUENCE_BINS_H

#include "core/influence_rule.h"
#include "light/influence_rule.h"

_Static_assert((int)NOC_RULE_SHARES == (int)RULE_SHARES && (int)NOC_RULE_BINS == (int)RULE_BINS &&
                   sizeof(noc_influence_rule) == sizeof(influence_rule) &&
                   sizeof(noc_influence_bin) == sizeof(rule_bin),
               "records are the rule's");

FN rule_bin rule_bin_load(CTX u1 i) {
    rule_bin bin;
    __builtin_memcpy(&bin, &RULE_BINS_OF(ctx)->bin[i], sizeof(bin));
    return bin;
}
FN void rule_bin_store(CTX u1 i, rule_bin bin) { __builtin_memcpy(&RULE_BINS_OF(ctx)->bin[i], &bin, sizeof(bin)); }

FN1 influence_rule rule_of_record(const noc_influence_rule *have) {
    influence_rule r;
    __builtin_memcpy(&r, have, sizeof(r));
    return r;
}

#endif
