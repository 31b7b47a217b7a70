/* core/tree.h: the probability with which a draw from a light tree (core/tree_node.h) is a given light. The turns to
 * every light are kept as bits, so that pmf can take the way of its draws. Includers supply tree_load(CTX pair). */
#ifndef CORE_TREE_H
#define CORE_TREE_H

#include "core/tree_node.h"

FN tree_pair tree_load(CTX u32 i);

/* link: the tree's root. path: the turns to a light, bit i is 1 where turn i goes to the second child. depth: turns on
 * the tree's longest way. */
FN real tree_pmf(CTX v3 p, v3 n, u32 link, u32 path, int depth) {
    real pmf = K(1.0f);
    u32 at = link;
    u32 left = path;
    for (int i = 0; i < depth; i++) {
        mask inner = (at & KU(TREE_LEAF)) == KU(0u);
        if (ANY(inner)) {
            tree_pair pair = tree_load(PASS selu(inner, at, KU(0u)));
            mask b = (left & KU(1u)) != KU(0u);
            EXACT real next = pmf * tree_share_of(tree_choose(p, n, pair), b);
            pmf = sel(inner, next, pmf);
            at = selu(inner, selu(b, pair.b.link, pair.a.link), at);
            left = shr(left, 1);
        }
    }
    return pmf;
}

#endif
