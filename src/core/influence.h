/* core/influence.h: influence volumes (Gardishyan 2025, Algorithm 3). A light's volume holds the points nearer to its
 * shape than S_r sqrt(I), I its greatest luminous intensity (radiance times area for flat lights, times the disc's area
 * for spheres, the intensity itself for points and spots): further away it gives less than 1 / S_r^2 lux. One-sided
 * lights and spots have the half of it that they face, and a volume does not hold a surface that the whole light is
 * behind. Lights that share a volume have a sphere around all of them, and the largest of their I.
 *
 * Of m candidates of a surface point every `every`th, the first one too, is drawn from all lights alike (u of them),
 * the others from the N_f lights that the point lists (b of them): those whose volumes hold it, or of those the ones
 * that give it at least so many lux. Whichever way a candidate came, its density is (b g / N_f + u / N_L) / (b + u), g
 * = 1 exactly if its own light is listed. Where none is, all are drawn from all lights. What is listed may differ from
 * point to point: it is known before anything is drawn. Points that lie close together ask as one: their volumes are
 * those that reach the box around them. "Holds the point" then means that, for the draws from all lights too, and
 * densities stay exact. */
#ifndef CORE_INFLUENCE_H
#define CORE_INFLUENCE_H

#include "core/pick.h"

/* A record of 8 floats. Lights without emission have root = 0: their volumes hold nothing. */
struct influence {
    v3 c;
    real size; /* radius of the sphere around the light or lights */
    v3 m;      /* they all shine into the half space dot(m, p - c) >= -1; 0: every way */
    real root; /* square root of I */
};

#ifndef CORE_GLSL
typedef struct influence influence;
#endif

/* Points of surfaces that ask together: the box around them, the normal that they have in common on the side that is
 * seen (0: none), and their least dot(n, point) (where n = 0: -infinity). A volume holds them if it would hold a point
 * of the box. */
struct influence_region {
    v3 lo;
    v3 hi;
    v3 n;
    real back;
    v3 middle;    /* of the box */
    real spread2; /* mean square of its points' distance from there, if they lie evenly in it */
    real spread;  /* its root */
};

#ifndef CORE_GLSL
typedef struct influence_region influence_region;
#endif

FN influence_region influence_box(v3 lo, v3 hi, v3 n, real back) {
    influence_region r;
    v3 h = mul3(sub3(hi, lo), K(0.5f));
    r.lo = lo;
    r.hi = hi;
    r.n = n;
    r.back = back;
    EXACT v3 middle = add3(lo, h);
    EXACT real h2 = dot3(h, h) * K(0.333f);
    r.middle = middle;
    r.spread2 = h2;
    r.spread = sqrt_(h2);
    return r;
}

FN influence_region influence_point(v3 p, v3 n) { return influence_box(p, p, n, dot3(n, p)); }

/* Does what the volume's lights shine into reach the region? */
FN mask influence_shines(influence v, influence_region r) {
    v3 a = sub3(r.lo, v.c);
    v3 b = sub3(r.hi, v.c);
    EXACT real front = max_(v.m.x * a.x, v.m.x * b.x) + max_(v.m.y * a.y, v.m.y * b.y) + max_(v.m.z * a.z, v.m.z * b.z);
    return front >= K(-1.0f);
}

/* Does the volume hold the region with that S_r? */
FN mask influence_holds(influence v, influence_region r, real scale) {
    v3 a = sub3(r.lo, v.c);
    v3 b = sub3(r.hi, v.c);
    v3 d = V3(max_(max_(a.x, K(0.0f) - b.x), K(0.0f)), max_(max_(a.y, K(0.0f) - b.y), K(0.0f)),
              max_(max_(a.z, K(0.0f) - b.z), K(0.0f)));
    EXACT real reach = v.size + scale * v.root;
    mask faces = and_(influence_shines(v, r), dot3(r.n, v.c) + v.size > r.back);
    return and_(and_(v.root > K(0.0f), dot3(d, d) <= reach * reach), faces);
}

/* 1 / length of m, which influence_gives wants to be told; 0 where the lights shine every way. */
FN real influence_turn(influence v) {
    real m2 = dot3(v.m, v.m);
    EXACT real length = sqrt_(max_(m2, K(1e-30f)));
    EXACT real turn = K(1.0f) / length;
    return sel(m2 > K(0.0f), turn, K(0.0f));
}

/* What one light of the volume gives the region's points on average where it is seen, about, lux: I over the squared
 * distance (that of the box's centre and a third of its squared half diagonal, if the points lie evenly in it), by the
 * cosines at both ends, where there are normals, to half the sizes of box and light. */
FN real influence_gives(influence v, real turn, influence_region r) {
    v3 d = sub3(v.c, r.middle);
    EXACT real far = sqrt_(max_(dot3(d, d) + r.spread2, K(1e-30f)));
    EXACT real slack = (r.spread + v.size) * K(0.5f);
    EXACT real cos_m = slack - dot3(v.m, d) * turn;
    EXACT real cos_n = slack + dot3(r.n, d);
    EXACT real w = K(1.0f) / far;
    cos_m = sel(turn > K(0.0f), min_(max_(cos_m * w, K(0.0f)), K(1.0f)), K(1.0f));
    cos_n = sel(dot3(r.n, r.n) > K(0.0f), min_(max_(cos_n * w, K(0.0f)), K(1.0f)), K(1.0f));
    EXACT real s = v.root / max_(far - v.size, v.root * K(1e-3f));
    EXACT real lux = (s * s) * (cos_m * cos_n);
    return lux;
}

/* What visibility-aware volumes (Algorithm 4) ask as well. */
FN mask influence_meets(v3 lo, v3 hi, influence_region r) {
    return and_(and_(and_(r.hi.x >= lo.x, r.lo.x <= hi.x), and_(r.hi.y >= lo.y, r.lo.y <= hi.y)),
                and_(r.hi.z >= lo.z, r.lo.z <= hi.z));
}

/* Draws from all lights among m, of a point that volumes of n_f lights hold. */
FN u32 influence_uniform(u32 n_f, int m, int every) {
    return selu(n_f > KU(0u), KU(U32((m + every - 1) / every)), KU(U32(m)));
}

/* pmf of a light, given whether its volume holds the point. */
FN real influence_pmf(mask held, u32 n_f, u32 n_l, int m, int every) {
    real u = to_real(influence_uniform(n_f, m, every));
    real b = K(F32(m)) - u;
    real f = sel(held, b / max_(to_real(n_f), K(1.0f)), K(0.0f));
    EXACT real p = (f + u / to_real(n_l)) / K(F32(m));
    return p;
}

#endif
