/* core/tree.h: draws from a light tree (core/tree_node.h), and the probability with which a draw is a given light. The
 * draws of a point go down together: tree_step shares those that come to a pair out between its children. Who has room
 * for a list of pairs does all draws of many points a level at a time (backend/cpu/tree_draws_tmpl.h); tree_draw goes
 * the way of one draw alone and gives the same bits. The turns to every light are kept as bits, so that pmf can take
 * the way of its draws. Includers supply tree_load(CTX pair). */
#ifndef CORE_TREE_H
#define CORE_TREE_H

#include "core/tree_node.h"

FN tree_pair tree_load(CTX u32 i);

/* What becomes of the draws of a point that come to a pair. */
struct tree_step {
    u32 to_a; /* of the draws, the first ones; the others go to b */
    u32 link_a;
    u32 link_b;
    real pmf_a; /* of each of them */
    real pmf_b;
};

#ifndef CORE_GLSL
typedef struct tree_step tree_step;
#endif

/* count: draws that come to pair `at`, each with probability pmf. key: the pixel's. */
FN tree_step tree_go(CTX v3 p, v3 n, u32 key, u32 at, u32 count, real pmf) {
    tree_step w;
    tree_pair pair = tree_load(PASS at);
    tree_shares s = tree_choose(p, n, pair);
    mask b = KU(1u) == KU(1u);
    w.to_a = tree_split(s, count, tree_number(key, at));
    w.link_a = pair.a.link;
    w.link_b = pair.b.link;
    EXACT real pmf_a = pmf * tree_share_of(s, not_(b));
    EXACT real pmf_b = pmf * tree_share_of(s, b);
    w.pmf_a = pmf_a;
    w.pmf_b = pmf_b;
    return w;
}

/* A way that ends at that leaf. */
FN pick tree_arrived(u32 link, real pmf) {
    pick p;
    p.light = link & KU(~TREE_LEAF);
    EXACT real inverse = K(1.0f) / max_(pmf, K(1e-30f));
    p.inverse = inverse;
    return p;
}

/* Draw i of m, i < m < 2^16. link: the tree's root. depth: turns on the tree's longest way. */
FN pick tree_draw(CTX v3 p, v3 n, u32 key, u32 link, u32 m, u32 i, int depth) {
    real pmf = K(1.0f);
    u32 at = link;
    u32 first = KU(0u); /* of the draws that come here, and how many they are */
    u32 count = m;
    for (int turn = 0; turn < depth; turn++) {
        mask inner = (at & KU(TREE_LEAF)) == KU(0u);
        if (ANY(inner)) {
            tree_step w = tree_go(PASS p, n, key, selu(inner, at, KU(0u)), count, pmf);
            mask b = i - first >= w.to_a;
            pmf = sel(inner, sel(b, w.pmf_b, w.pmf_a), pmf);
            at = selu(inner, selu(b, w.link_b, w.link_a), at);
            first = first + selu(b, w.to_a, KU(0u));
            count = selu(b, count - w.to_a, w.to_a);
        }
    }
    return tree_arrived(at, pmf);
}

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
