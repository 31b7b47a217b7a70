/* core/surface.h: the receiving point and what it reflects: a diffuse part plus one isotropic GGX lobe (Walter et al.
 * 2007; Smith shadowing, height-correlated: Heitz 2014, eq. 99; Schlick 1994 Fresnel). Without gloss (f0 = 0) the
 * diffuse part is Lambert's. Under gloss it is what the gloss leaves of light on its way in and out (the matte part of
 * Kelemen and Szirmay-Kalos 2001), so that no surface reflects more than it gets, also where a bright wall is seen at a
 * grazing angle. Reciprocal. Both parts work on the side that is seen. */
#ifndef CORE_SURFACE_H
#define CORE_SURFACE_H

#include "core/light.h"
#include "core/texel.h"

struct surf {
    v3 p;
    v3 n;  /* unit, on the viewer's side */
    v3 wo; /* unit, towards the viewer */
    v3 albedo;
    real f0;    /* 0: purely diffuse */
    real alpha; /* GGX alpha, roughness squared */
};

/* What a surface is made of. */
struct surf_material {
    v3 albedo;
    real f0;
    real alpha;
};

#ifndef CORE_GLSL
typedef struct surf surf;
typedef struct surf_material surf_material;
#endif

/* From memory, the same material in every lane. */
FN surf_material material_of_record(material_record r) {
    surf_material m;
    m.albedo = splat3(r.albedo);
    m.f0 = K(r.f0);
    m.alpha = K(r.alpha);
    return m;
}

/* A receiver's surface as seen from eye; n = 0 where there is no receiver, and nothing is reflected. texel: its albedo
 * where that is not the material's (core/texel.h), or 0. matte: without gloss (FRAME_MATTE). */
FN surf surf_of_receiver(v3 p, v3 n, v3 eye, surf_material m, u32 texel, b1 matte) {
    surf s;
    s.p = p;
    s.n = n;
    v3 d = sub3(eye, p);
    EXACT real inv = K(1.0f) / sqrt_(max_(dot3(d, d), K(1e-20f)));
    s.wo = mul3(d, inv);
    s.albedo = m.albedo;
    mask there = texel != KU(0u);
    if (ANY(there))
        s.albedo = sel3(there, texel_albedo(texel), s.albedo);
    s.f0 = m.f0;
    if (matte)
        s.f0 = K(0.0f);
    s.alpha = m.alpha;
    return s;
}

/* (1 - x)^5. */
FN real schlick_weight(real x) {
    real c = K(1.0f) - x;
    EXACT real c2 = c * c;
    EXACT real f = c2 * c2 * c;
    return f;
}

/* The glossy lobe over cos(theta), 1/sr. */
FN real glossy(surf s, v3 wi, real nl) {
    v3 h = add3(wi, s.wo);
    real h2 = max_(dot3(h, h), K(1e-12f));
    EXACT real inv = K(1.0f) / sqrt_(h2);
    h = mul3(h, inv);
    v3 nxh = cross3(s.n, h);
    real nv = max_(dot3(s.n, s.wo), K(1e-4f));
    real nh = dot3(s.n, h);
    real vh = max_(dot3(s.wo, h), K(0.0f));
    EXACT real a2 = s.alpha * s.alpha;
    EXACT real q = nh * nh * a2 + dot3(nxh, nxh); /* 1 + nh^2 (a2 - 1) without cancellation */
    EXACT real d = a2 / max_(K(CORE_PI) * q * q, K(1e-20f));
    EXACT real gl = nl * sqrt_(a2 + nv * nv * (K(1.0f) - a2));
    EXACT real gv = nv * sqrt_(a2 + nl * nl * (K(1.0f) - a2));
    EXACT real fr = s.f0 + (K(1.0f) - s.f0) * schlick_weight(vh);
    EXACT real f = d * fr * K(0.5f) / max_(gl + gv, K(1e-10f));
    return f;
}

/* The diffuse part under gloss, relative to Lambert's: (1 - E(nl)) (1 - E(nv)) / (1 - mean of E), where
 * E(c) = f0 + (1 - f0) k (1 - c)^3 bounds the share that the lobe reflects from above; k was fitted to integrals of the
 * lobe over roughness 0.05 to 1 (tests/core/test_surface.c holds the sum at or under 1). */
FN real under_gloss(surf s, real nl) {
    EXACT real k = K(1.0f) / (K(1.0f) + s.alpha * (K(13.0f) + K(9.0f) * s.alpha));
    real ci = K(1.0f) - nl;
    real co = K(1.0f) - max_(dot3(s.n, s.wo), K(0.0f));
    EXACT real in_ = K(1.0f) - k * (ci * ci * ci);
    EXACT real out_ = K(1.0f) - k * (co * co * co);
    EXACT real share = (K(1.0f) - s.f0) / (K(1.0f) - k * K(0.1f)) * out_ * in_;
    return share;
}

/* f_r * cos(theta) = albedo * diffuse + gloss, 1/sr. */
struct lobes {
    real diffuse;
    real gloss;
};

#ifndef CORE_GLSL
typedef struct lobes lobes;
#endif

FN lobes reflect_lobes(surf s, v3 wi) {
    lobes f;
    real nl = max_(dot3(s.n, wi), K(0.0f));
    f.diffuse = K(CORE_INV_PI) * nl;
    f.gloss = K(0.0f);
    mask shiny = and_(s.f0 > K(0.0f), nl > K(0.0f));
    if (ANY(shiny)) {
        EXACT real kd = f.diffuse * under_gloss(s, nl);
        EXACT real ks = glossy(s, wi, nl) * nl;
        f.diffuse = sel(shiny, kd, f.diffuse);
        f.gloss = sel(shiny, ks, f.gloss);
    }
    return f;
}

/* f_r * cos(theta), 1/sr. */
FN v3 reflect_both(surf s, lobes f) { return add3(mul3(s.albedo, f.diffuse), fill3(f.gloss)); }
FN v3 reflect(surf s, v3 wi) { return reflect_both(s, reflect_lobes(s, wi)); }

/* Unshadowed reflected radiance over the unit square of one light, linear rgb, cd/m2. */
FN v3 reflected(surf s, light_sample l) { return tint3(reflect(s, l.wi), l.le); }

/* The target p_hat of a sample of a light: its luminance. NaN and what overflows count as 0. */
FN real target_of(surf s, light_sample ls, lobes f) {
    EXACT real p = luminance(tint3(s.albedo, ls.le)) * f.diffuse;
    mask shiny = f.gloss > K(0.0f);
    if (ANY(shiny)) {
        EXACT real both = p + luminance(ls.le) * f.gloss;
        p = sel(shiny, both, p);
    }
    return sel(and_(p > K(0.0f), p < K(1e30f)), p, K(0.0f));
}

FN real target(CTX surf s, light l, real u, real v) {
    light_sample ls = shining_sample(PASS l, s.p, u, v);
    return target_of(s, ls, reflect_lobes(s, ls.wi));
}

#endif
