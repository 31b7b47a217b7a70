/* core/tree_node.h: stochastic descent of a light tree (Conty Estevez and Kulla 2018, "Importance Sampling of Many
 * Lights with Adaptive Tree Splitting"; for real time: Moreau, Pharr and Clarberg 2019). A node bounds its lights by a
 * sphere and a cone of the directions they face and knows the sum of their intensities; draws are shared out between
 * the two children of a node in proportion to a bound of what each could give the surface. A child is only left out for
 * certain where none of its lights can reach the surface. Every leaf is one light.
 *
 * Two children are one cache line, and are looked at once for all draws that come by: of n draws, floor(n s + u) go to
 * the child with the smaller share s, with a random u for each pixel and pair. So a light of probability p gets n p
 * draws on average (by induction on its way), and the numbers of draws are stratified. */
#ifndef CORE_TREE_NODE_H
#define CORE_TREE_NODE_H

#include "core/pick.h"

#define TREE_LEAF 0x80000000u /* set in the link of a child that is one light */

struct tree_child {
    v3 c; /* sphere around the lights */
    real radius;
    u32 axis_xy;   /* axis of the cone of the directions they face, as tree_unit reads it: x low, y high */
    u32 axis_cone; /* z low; high: sine of half the cone's half angle, 65535 for 1. Every direction: axis 0, sine 1 */
    real power;    /* sum of their intensities, cd */
    u32 link;      /* a light and TREE_LEAF, or the pair of its children */
};

#ifndef CORE_GLSL
typedef struct tree_child tree_child;
#endif

struct tree_pair {
    tree_child a;
    tree_child b;
};

/* How a pair's draws are shared out. */
struct tree_shares {
    real less; /* probability of the child that is less likely, at most 1/2 */
    mask less_is_b;
};

#ifndef CORE_GLSL
typedef struct tree_pair tree_pair;
typedef struct tree_shares tree_shares;
#endif
/* -1 to 1 in steps of 1 / 32767, 0 exactly. */
FN real tree_unit(u32 bits) {
    EXACT real x = (to_real(bits & KU(0xffffu)) - K(32767.0f)) * K(3.0518509e-5f);
    return x;
}

/* What the lights of a child could give the surface at p with normal n: 0 only if none of them can reach it. As
 * core/cones.h's cone_score, with lower floors: there a floor guards a whole cluster against a loose bound; here it
 * would give the windows beside a window in a wall, which shine past that wall, more draws than those across the
 * street. Inside a node the distance is taken as half its size. Cosines and sines stay multiplied by the distance or
 * its square, which saves most of the divisions and roots. */
FN real tree_score(v3 p, v3 n, tree_child l) {
    v3 d = sub3(l.c, p);
    real d2 = dot3(d, d);
    real size2 = l.radius * l.radius;
    mask apart = d2 > size2 * K(1.0001f);
    real w = K(1.0f) / max_(max_(d2, size2 * K(0.25f)), K(1e-6f));
    /* times the cosine of the sphere's half angle; its sine: the radius */
    real reach = sqrt_(max_(d2 - size2, K(0.0f)));

    real cr = dot3(n, d); /* at the receiver */
    EXACT real sr2 = d2 - cr * cr;
    EXACT real turned = cr * reach + sqrt_(max_(sr2, K(0.0f))) * l.radius;
    real r = sel(cr >= reach, d2, turned) * w;

    v3 axis = V3(tree_unit(l.axis_xy), tree_unit(shr(l.axis_xy, 16)), tree_unit(l.axis_cone));
    real h = to_real(shr(l.axis_cone, 16)) * K(1.5259022e-5f); /* half angles keep narrow cones narrow */
    EXACT real h2 = h * h;
    real sin_cone = K(2.0f) * h * sqrt_(max_(K(1.0f) - h2, K(0.0f)));
    EXACT real cone = K(1.0f) - K(2.0f) * h2;
    /* at the lights: first turned towards the surface by the cone, then by the sphere */
    real ce = K(0.0f) - dot3(axis, d);
    EXACT real se2 = d2 - ce * ce;
    real se = sqrt_(max_(se2, K(0.0f)));
    EXACT real c1 = ce * cone + se * sin_cone;
    EXACT real s1 = se * cone - ce * sin_cone;
    EXACT real facing = c1 * reach + s1 * l.radius;
    real e = sel(or_(s1 < K(0.0f), c1 >= reach), d2, facing) * w;

    mask never = and_(apart, or_(r < K(-1e-3f), e < K(-1e-3f)));
    r = sel(apart, max_(r, K(2e-3f)), K(1.0f));
    e = sel(apart, max_(e, K(2e-3f)), K(1.0f));
    return sel(never, K(0.0f), min_(l.power * r * e * w, K(1e30f)));
}

/* Where neither child can reach the surface, any will do. Where both can, neither is left out by rounding. */
FN tree_shares tree_choose(v3 p, v3 n, tree_pair at) {
    real ia = tree_score(p, n, at.a);
    real ib = tree_score(p, n, at.b);
    mask none = ia + ib <= K(0.0f);
    ia = sel(none, K(1.0f), ia);
    ib = sel(none, K(1.0f), ib);
    tree_shares s;
    real low = min_(ia, ib);
    EXACT real share = low / (ia + ib);
    s.less = sel(low > K(0.0f), max_(share, K(1e-6f)), K(0.0f));
    s.less_is_b = ib < ia;
    return s;
}

FN real tree_share_of(tree_shares s, mask b) {
    real more = K(1.0f) - s.less;
    return sel(b, sel(s.less_is_b, s.less, more), sel(s.less_is_b, more, s.less));
}

/* How many of n draws (below 2^16) go to child a. u in [0, 1). */
FN u32 tree_split(tree_shares s, u32 n, real u) {
    EXACT real x = to_real(n) * s.less + u;
    u32 fewer = to_u32(min_(x, to_real(n)));
    return selu(s.less_is_b, n - fewer, fewer);
}

/* The number that splits a pixel's draws at pair i. */
FN real tree_number(u32 key, u32 i) { return rng(key, i + KU(DIM_PICK)); }

#endif
