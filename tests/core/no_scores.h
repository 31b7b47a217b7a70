/* For programs that score no clusters: bridges of their scores, that nothing asks. */
#ifndef NOC_TEST_NO_SCORES_H
#define NOC_TEST_NO_SCORES_H

#include "core/list_scores.h"

#include <stddef.h>

FN real score_load(CTX u1 group, int l) { return 0; }
FN void score_store(CTX u1 group, int l, real score) {}
FN f1 score_at(CTX u1 group, u1 place) { return 0; }
FN void score_clear(CTX u1 group, u1 place) {}
FN const float *score_row(CTX u1 group) { return NULL; }
FN list_node node_load(CTX u1 part, u1 level, u1 block, int l) { return (list_node){ 0 }; }
FN list_brief brief_load(CTX u1 part, u1 cluster, int l) { return (list_brief){ 0 }; }
FN list_cluster cluster_load(CTX u1 part, u1 cluster) { return (list_cluster){ 0 }; }

#endif
