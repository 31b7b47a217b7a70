/* core/tree.h: stochastic descent of a light tree (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
 * Adaptive Tree Splitting"; for real time: Moreau, Pharr and Clarberg 2019). A node bounds its lights by a sphere and a cone
 * of the directions they face and knows the sum of their intensities; at each node one child is chosen in proportion to
 * a bound of what it could give the surface. A child is only left out for certain where none of its lights can
 * reach the surface. Every leaf is one light, and the turns to it are kept as bits, so that pmf can take the same way.
 * Includers supply tree_load(CTX node). */
#ifndef CORE_TREE_H
#define CORE_TREE_H

#include "core/cones.h"
#include "core/pick.h"

struct tree_node {
    cone_bound bound;
    real power;  /* sum of the intensities, cd */
    u32 child;   /* the first of two neighbouring nodes; 0: a leaf */
    u32 light;   /* leaves only */
};

#ifndef CORE_GLSL
typedef struct tree_node tree_node;
#endif
FN tree_node tree_load(CTX u32 i);

/* A surface point is a bound of size 0. */
FN cone_bound tree_receiver(v3 p, v3 n) {
    cone_bound r;
    r.c = p;
    r.radius = K(0.0f);
    r.axis = n;
    r.cos_cone = K(1.0f);
    r.sin_cone = K(0.0f);
    return r;
}

/* What the lights of a node could give the surface: 0 only if none of them can reach it. As core/cones.h's cluster_score,
 * with lower floors: there a floor guards a whole cluster against a loose bound; here it would give the windows beside a
 * window in a wall, which shine past that wall, more draws than those across the street. Inside a node the distance is taken
 * as half its size. */
FN real tree_score(cone_bound y, cone_bound lights, real power) {
    v3 d = sub3(lights.c, y.c);
    real d2 = dot3(d, d);
    real size2 = lights.radius * lights.radius;
    mask apart = d2 > size2 * K(1.0001f);
    real inv = K(1.0f) / sqrt_(max_(d2, K(1e-20f)));
    d = mul3(d, inv);
    real sin_reach = min_(lights.radius * inv, K(1.0f));
    real cos_reach = sin_of(sin_reach);
    real r = cosine_bound(y, d, cos_reach, sin_reach);
    real e = cosine_bound(lights, mul3(d, K(-1.0f)), cos_reach, sin_reach);
    mask never = and_(apart, or_(r < K(-1e-3f), e < K(-1e-3f)));
    r = sel(apart, max_(r, K(2e-3f)), K(1.0f));
    e = sel(apart, max_(e, K(2e-3f)), K(1.0f));
    real score = min_(power * r * e / max_(max_(d2, size2 * K(0.25f)), K(1e-6f)), K(1e30f));
    return sel(never, K(0.0f), score);
}

/* Probability of the first of two children. Where neither can reach the surface, any will do. Where both can, neither is
 * left out by rounding. */
FN real tree_share(cone_bound y, tree_node a, tree_node b) {
    real ia = tree_score(y, a.bound, a.power);
    real ib = tree_score(y, b.bound, b.power);
    mask none = ia + ib <= K(0.0f);
    ia = sel(none, K(1.0f), ia);
    ib = sel(none, K(1.0f), ib);
    EXACT real share = ia / (ia + ib);
    real safe = min_(max_(share, K(1e-6f)), K(0.999999f));
    return sel(and_(ia > K(0.0f), ib > K(0.0f)), safe, share);
}

/* bits: random ones; depth: turns on the tree's longest way. The tree has a light. */
FN pick tree_draw(CTX v3 p, v3 n, u32 bits, int depth) {
    cone_bound y = tree_receiver(p, n);
    tree_node at = tree_load(PASS KU(0u));
    real pmf = K(1.0f);
    for (int i = 0; i < depth; i++) {
        mask inner = at.child != KU(0u);
        if (ANY(inner)) {
            tree_node a = tree_load(PASS at.child);
            tree_node b = tree_load(PASS selu(inner, at.child + KU(1u), KU(0u)));
            real share = tree_share(y, a, b);
            mask first = rng(bits, KU(U32(i))) < share;
            real turn = sel(first, share, K(1.0f) - share);
            EXACT real next = pmf * turn;
            pmf = sel(inner, next, pmf);
            at.light = selu(inner, selu(first, a.light, b.light), at.light);
            at.child = selu(inner, selu(first, a.child, b.child), at.child);
        }
    }
    pick r;
    r.light = at.light;
    r.inverse = K(1.0f) / max_(pmf, K(1e-30f));
    return r;
}

/* path: the turns to a light, bit i is 1 where turn i goes to the second child. */
FN real tree_pmf(CTX v3 p, v3 n, u32 path, int depth) {
    cone_bound y = tree_receiver(p, n);
    tree_node at = tree_load(PASS KU(0u));
    real pmf = K(1.0f);
    u32 left = path;
    for (int i = 0; i < depth; i++) {
        mask inner = at.child != KU(0u);
        if (ANY(inner)) {
            tree_node a = tree_load(PASS at.child);
            tree_node b = tree_load(PASS selu(inner, at.child + KU(1u), KU(0u)));
            real share = tree_share(y, a, b);
            mask first = (left & KU(1u)) == KU(0u);
            real turn = sel(first, share, K(1.0f) - share);
            EXACT real next = pmf * turn;
            pmf = sel(inner, next, pmf);
            at.child = selu(inner, selu(first, a.child, b.child), at.child);
            left = shr(left, 1);
        }
    }
    return pmf;
}

#endif
