/* core/sky.h: the bright night sky over a lit city, and how it is sampled.
 *
 * Luminance at the zenith is given; it grows towards the horizon by a factor of 4, as light pollution does (Garstang
 * 1989 finds 3 to 6 over towns), and turns from bluish to the warm grey of lamps seen through haze. Under the horizon
 * lies dark country: a tenth of the zenith. No moon, no stars. */
#ifndef CORE_SKY_H
#define CORE_SKY_H

#include "core/random.h"
#include "core/surface.h"

/* What the sky would have at height z over the horizon (z = d.z >= 0), warm towards z = 0. */
FN v3 sky_above(real z, real scale) {
    real c = K(1.0f) - z;
    real c2 = c * c;
    EXACT real glow = K(3.0f) * c2 * c2;
    /* both tints have luminance 1 */
    v3 blue = V3(K(0.62f), K(1.0f), K(2.1189f));
    v3 warm = V3(K(1.33f), K(0.95f), K(0.5236f));
    return mul3(add3(blue, mul3(warm, glow)), scale);
}

/* Radiance (luminance in cd/m2, linear Rec.709) from the unit direction d, for `zenith` cd/m2 straight up: what lights.
 */
FN v3 sky_radiance(v3 d, real zenith) {
    real below = max_(K(1.0f) + d.z * K(8.0f), K(0.025f));
    EXACT real scale = zenith * sel(d.z < K(0.0f), below, K(1.0f));
    return sky_above(max_(d.z, K(0.0f)), scale);
}

/* The same as background. Under the horizon it is the haze over country that is not there: the horizon's colour, gone
 * smoothly within 12 degrees (sine 0.21). */
FN v3 sky_backdrop(v3 d, real zenith) {
    real t = max_(K(1.0f) + min_(d.z, K(0.0f)) * K(4.8f), K(0.0f));
    EXACT real scale = zenith * (K(0.025f) + K(0.975f) * (t * t * (K(3.0f) - K(2.0f) * t)));
    return sky_above(max_(d.z, K(0.0f)), scale);
}

/* Two numbers in [0, 1) a pixel and frame, in x and y: random in the first frame (key: of the pixel, frame 0), then
 * along the two-dimensional golden ratio's sequence (Roberts 2018: R2), which spreads the frames of a pixel evenly.
 * Each frame's numbers are uniform, so each frame is unbiased. */
FN u32 sky_bits_x(u32 key, u32 frame) { return rng_bits(key, KU(DIM_SKY)) + frame * KU(0xc13fa9a9u); }
FN u32 sky_bits_y(u32 key, u32 frame) { return rng_bits(key, KU(DIM_SKY + 1u)) + frame * KU(0x91e10da5u); }
FN v3 sky_numbers(u32 key, u32 frame) {
    return V3(unit_real(sky_bits_x(key, frame)), unit_real(sky_bits_y(key, frame)), K(0.0f));
}

/* The share of directions that are drawn for the lobe: what it reflects of all, by Fresnel's term as it is seen. */
FN real sky_gloss_share(surf s) {
    real nv = min_(max_(dot3(s.n, s.wo), K(0.0f)), K(1.0f));
    EXACT real f = s.f0 + (K(1.0f) - s.f0) * schlick_weight(nv);
    EXACT real all = f + (K(1.0f) - f) * luminance(s.albedo);
    EXACT real q = f / max_(all, K(1e-6f));
    return sel(s.f0 > K(0.0f), min_(q, K(0.9f)), K(0.0f));
}

/* Density of visible_normal_direction, 1/sr, at wi: G1(wo) D(h) / (4 n.wo). */
FN real visible_normal_density(surf s, v3 wi) {
    v3 h = add3(wi, s.wo);
    EXACT real inv = K(1.0f) / sqrt_(max_(dot3(h, h), K(1e-12f)));
    h = mul3(h, inv);
    v3 nxh = cross3(s.n, h);
    real nh = dot3(s.n, h);
    real nv = max_(dot3(s.n, s.wo), K(1e-4f));
    EXACT real a2 = s.alpha * s.alpha;
    EXACT real q = nh * nh * a2 + dot3(nxh, nxh);
    EXACT real d = a2 / max_(K(CORE_PI) * q * q, K(1e-20f));
    EXACT real p = d * K(0.5f) / (nv + sqrt_(a2 + nv * nv * (K(1.0f) - a2)));
    return p;
}

/* wo mirrored at a normal of the lobe that is visible from wo (Heitz 2018), by spherical caps (Dupuy and Benyoub 2023).
 * May lie under the surface, where nothing is reflected. */
FN v3 visible_normal_direction(surf s, real u, real v) {
    real nv = max_(dot3(s.n, s.wo), K(1e-4f));
    v3 flat_ = mul3(sub3(s.wo, mul3(s.n, nv)), s.alpha);
    v3 w = add3(flat_, mul3(s.n, nv));
    EXACT real inv = K(1.0f) / sqrt_(max_(dot3(w, w), K(1e-20f)));
    w = mul3(w, inv);
    real wz = nv * inv;
    EXACT real z = (K(1.0f) - u) * (K(1.0f) + wz) - wz;
    EXACT real r2 = K(1.0f) - z * z;
    real r = sqrt_(max_(r2, K(0.0f)));
    v3 cs = circle(v);
    v3 m = add3(around(s.n, r * cs.x, r * cs.y, z), w);
    real mz = dot3(s.n, m);
    v3 h = add3(mul3(sub3(m, mul3(s.n, mz)), s.alpha), mul3(s.n, mz));
    real h2 = dot3(h, h);
    h = sel3(h2 > K(1e-20f), mul3(h, K(1.0f) / sqrt_(max_(h2, K(1e-20f)))), s.n);
    EXACT real twice = K(2.0f) * dot3(h, s.wo);
    return sub3(mul3(h, twice), s.wo);
}

/* A direction for the sky's light: cosine-distributed, or by the lobe, chosen by u, what is left of u being used again.
 */
FN v3 sky_direction(surf s, real u, real v) {
    real q = sky_gloss_share(s);
    mask shiny = u < q;
    real rest = K(1.0f) - q;
    EXACT real left = sel(shiny, u / sel(shiny, q, K(1.0f)), (u - q) / rest);
    left = min_(max_(left, K(0.0f)), K(0.99999994f));
    v3 d = cosine_hemisphere(s.n, left, v);
    if (ANY(shiny))
        d = sel3(shiny, visible_normal_direction(s, left, v), d);
    return d;
}

/* Density of sky_direction, 1/sr: of both ways together (the balance heuristic; Veach and Guibas 1995). */
FN real sky_density(surf s, v3 wi) {
    real q = sky_gloss_share(s);
    EXACT real p = (K(1.0f) - q) * K(CORE_INV_PI) * max_(dot3(s.n, wi), K(0.0f));
    mask shiny = q > K(0.0f);
    if (ANY(shiny)) {
        EXACT real both = p + q * visible_normal_density(s, wi);
        p = sel(shiny, both, p);
    }
    return p;
}

#endif
