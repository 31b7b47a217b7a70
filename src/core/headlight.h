/* core/headlight.h: what a lamp at the eye shows, to find one's way by in a dark city. It is no light of the scene: no
 * ray is sent and no light is asked. A surface is as bright as what it reflects, by how it faces the eye and a little
 * by how it lies, so that the sides of an edge differ; what is far fades into the haze over the horizon. */
#ifndef CORE_HEADLIGHT_H
#define CORE_HEADLIGHT_H

#include "core/sky.h"

#define HEADLIGHT_LEVEL 2.0f   /* cd/m2 of white that is near and faces the eye */
#define HEADLIGHT_REACH 400.0f /* m: half as bright there */

/* depth: m from the eye. zenith: of the sky, whose horizon is the haze before what is far. */
FN v3 headlight_shade(surf s, real depth, real zenith) {
    real facing = min_(abs_(dot3(s.n, s.wo)), K(1.0f));
    v3 key = V3(K(0.3841f), K(-0.5122f), K(0.7682f)); /* of length 1: from above, the south and the east */
    EXACT real lies = K(0.5f) + K(0.5f) * dot3(s.n, key);
    EXACT real turned = K(0.3f) + K(0.45f) * facing + K(0.25f) * lies;
    EXACT real clear = K(HEADLIGHT_REACH) / (K(HEADLIGHT_REACH) + depth);
    EXACT real level = K(HEADLIGHT_LEVEL) * turned * clear;
    v3 haze = mul3(sky_above(K(0.0f), zenith), K(1.0f) - clear);
    /* what is black, as asphalt, glass and metal are, is still seen */
    EXACT real least = K(0.06f) + K(0.5f) * s.f0;
    return add3(mul3(add3(mul3(s.albedo, K(1.0f) - least), fill3(least)), level), haze);
}

#endif
