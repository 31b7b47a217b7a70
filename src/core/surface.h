/* core/surface.h: the receiving point and what it reflects: Lambert plus one isotropic GGX lobe (Walter et al. 2007; Smith
 * shadowing, height-correlated: Heitz 2014, eq. 99; Schlick 1994 Fresnel). Both parts work on the side that is seen. */
#ifndef CORE_SURFACE_H
#define CORE_SURFACE_H

#include "core/light.h"

struct surf {
    v3 p;
    v3 n;       /* unit, on the viewer's side */
    v3 wo;      /* unit, towards the viewer */
    v3 albedo;
    real f0;    /* 0: purely diffuse */
    real alpha; /* GGX alpha, roughness squared */
};

#ifndef CORE_GLSL
typedef struct surf surf;
#endif

FN real glossy(surf s, v3 wi, real nl) {
    v3 h = add3(wi, s.wo);
    real h2 = max_(dot3(h, h), K(1e-12f));
    h = mul3(h, K(1.0f) / sqrt_(h2));
    real nv = max_(dot3(s.n, s.wo), K(1e-4f));
    real nh = dot3(s.n, h);
    real vh = max_(dot3(s.wo, h), K(0.0f));
    real a2 = s.alpha * s.alpha;
    EXACT real q = nh * nh * (a2 - K(1.0f)) + K(1.0f);
    EXACT real d = a2 / max_(K(CORE_PI) * q * q, K(1e-20f));
    EXACT real gl = nl * sqrt_(a2 + nv * nv * (K(1.0f) - a2));
    EXACT real gv = nv * sqrt_(a2 + nl * nl * (K(1.0f) - a2));
    real c = K(1.0f) - vh;
    real c2 = c * c;
    EXACT real fr = s.f0 + (K(1.0f) - s.f0) * (c2 * c2 * c);
    EXACT real f = d * fr * K(0.5f) / max_(gl + gv, K(1e-10f));
    return f;
}

/* f_r * cos(theta), 1/sr. */
FN v3 reflect(surf s, v3 wi) {
    real nl = max_(dot3(s.n, wi), K(0.0f));
    EXACT real kd = (K(1.0f) - s.f0) * K(CORE_INV_PI) * nl;
    v3 f = mul3(s.albedo, kd);
    mask shiny = and_(s.f0 > K(0.0f), nl > K(0.0f));
    if (ANY(shiny))
        f = add3(f, fill3(sel(shiny, glossy(s, wi, nl) * nl, K(0.0f))));
    return f;
}

/* Unshadowed reflected radiance over the unit square of one light, linear rgb, cd/m2. */
FN v3 reflected(surf s, light_sample l) { return tint3(reflect(s, l.wi), l.le); }

/* The target p_hat: its luminance. NaN (from overflow) counts as 0. */
FN real target(surf s, light l, real u, real v) {
    real p = luminance(reflected(s, sample_light(l, s.p, u, v)));
    return sel(and_(p > K(0.0f), p < K(1e30f)), p, K(0.0f));
}

#endif
