/* core/warp.h: from the unit square to discs, cones and hemispheres; the same bits in all three readers. */
#ifndef CORE_WARP_H
#define CORE_WARP_H

#include "core/dialect.h"

/* (cos, sin) of 2 pi t for t in [0, 1], in x and y; z is 0. Taylor polynomials on an eighth of the circle, error <
 * 4e-7. */
FN v3 circle(real t) {
    u32 q = to_u32(t * K(4.0f) + K(0.5f));
    EXACT real x = (t - to_real(q) * K(0.25f)) * K(6.28318530717959f);
    EXACT real x2 = x * x;
    EXACT real s = x * (K(1.0f) + x2 * (K(-0.166666667f) + x2 * (K(8.33333333e-3f) + x2 * K(-1.98412698e-4f))));
    EXACT real c =
        K(1.0f) + x2 * (K(-0.5f) + x2 * (K(4.16666667e-2f) + x2 * (K(-1.38888889e-3f) + x2 * K(2.48015873e-5f))));
    mask odd = (q & KU(1u)) == KU(1u);
    mask back = ((q + KU(1u)) & KU(2u)) == KU(2u); /* quadrants 1 and 2: cosine negated */
    mask low = (q & KU(2u)) == KU(2u);             /* quadrants 2 and 3: sine negated */
    real cs = sel(odd, s, c);
    real sn = sel(odd, c, s);
    cs = sel(back, K(0.0f) - cs, cs);
    sn = sel(low, K(0.0f) - sn, sn);
    return V3(cs, sn, K(0.0f));
}

/* atan2(y, x) / 2 pi for y >= 0, so 0 to 1/2; circle's inverse. A polynomial that interpolates the arc tangent at
 * Chebyshev's points; relative error < 3e-7, also next to 0. */
FN real turn_of(real x, real y) {
    real ax = abs_(x);
    mask steep = y > ax;
    EXACT real r = min_(ax, y) / max_(max_(ax, y), K(1e-30f));
    EXACT real r2 = r * r;
    EXACT real low =
        K(1.68996617e-2f) +
        r2 * (K(-1.18679531e-2f) + r2 * (K(6.70641109e-3f) + r2 * (K(-2.50370606e-3f) + r2 * K(4.40267693e-4f))));
    EXACT real a = r * (K(0.15915494f) +
                        r2 * (K(-5.30511756e-2f) + r2 * (K(3.18180526e-2f) + r2 * (K(-2.2596497e-2f) + r2 * low))));
    a = sel(steep, K(0.25f) - a, a);
    return sel(x < K(0.0f), K(0.5f) - a, a);
}

/* x u + y v + z n for an orthonormal frame (u, v, n) around the unit vector n (Duff et al. 2017, "Building an
 * Orthonormal Basis, Revisited"). */
FN v3 around(v3 n, real x, real y, real z) {
    real s = sel(n.z < K(0.0f), K(-1.0f), K(1.0f));
    EXACT real a = K(-1.0f) / (s + n.z);
    EXACT real b = n.x * n.y * a;
    EXACT real ux = K(1.0f) + s * n.x * n.x * a;
    EXACT real uy = s * b;
    EXACT real uz = K(0.0f) - s * n.x;
    EXACT real vy = s + n.y * n.y * a;
    EXACT real vz = K(0.0f) - n.y;
    EXACT real rx = x * ux + y * b + z * n.x;
    EXACT real ry = x * uy + y * vy + z * n.y;
    EXACT real rz = x * uz + y * vz + z * n.z;
    return V3(rx, ry, rz);
}

/* Cosine-distributed direction around n: density cos / pi. */
FN v3 cosine_hemisphere(v3 n, real u, real v) {
    v3 cs = circle(v);
    real r = sqrt_(u);
    return around(n, r * cs.x, r * cs.y, sqrt_(max_(K(1.0f) - u, K(0.0f))));
}

#endif
