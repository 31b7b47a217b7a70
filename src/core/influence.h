/* core/influence.h: influence volumes (Gardishyan 2025, Algorithm 3). A light's volume is the ball of radius S_r sqrt(I)
 * around its centre, I its greatest luminous intensity (radiance times area for flat lights, times the disc's area for
 * spheres, the intensity itself for points): further away it gives less than 1 / S_r^2 lux. One-sided lights have the half
 * of the ball that they face, and a volume does not hold a surface that the whole light is behind.
 *
 * Of m candidates of a surface point every `every`th, the first one too, is drawn from all lights alike (u of them), the
 * others from the lights whose volumes hold the point (b of them). Whichever way a candidate came, its density is
 * (b g / N_f + u / N_L) / (b + u), g = 1 exactly if its own volume holds the point. Where no volume does, all are drawn
 * from all lights. */
#ifndef CORE_INFLUENCE_H
#define CORE_INFLUENCE_H

#include "core/pick.h"

struct influence {
    v3 c;
    real size;   /* radius of the light itself */
    v3 n;        /* way it faces; 0: every way */
    real root;   /* square root of its intensity; 0: no volume */
};

#ifndef CORE_GLSL
typedef struct influence influence;
#endif

/* n: the surface's normal on the side that is seen. */
FN mask influence_holds(influence v, v3 p, v3 n, real scale) {
    v3 d = sub3(p, v.c);
    real r = v.root * scale;
    mask near = and_(dot3(d, d) <= r * r, v.root > K(0.0f));
    return and_(near, and_(dot3(v.n, d) >= K(0.0f), dot3(n, d) < v.size));
}

/* Draws from all lights among m, of a point that n_f volumes hold. */
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
