/* core/sky.h: a faint clear night sky over a lit city.
 *
 * Luminance at the zenith is given; it grows towards the horizon by a factor of 4, as light pollution does (Garstang 1989
 * finds 3 to 6 over towns), and turns from bluish to the warm grey of lamps seen through haze. Under the horizon lies dark
 * country: a tenth of the zenith. No moon, no stars. */
#ifndef CORE_SKY_H
#define CORE_SKY_H

#include "core/dialect.h"

/* Radiance (luminance in cd/m2, linear Rec.709) from the unit direction d, for `zenith` cd/m2 straight up. */
FN v3 sky_radiance(v3 d, real zenith) {
    real z = max_(d.z, K(0.0f));
    real c = K(1.0f) - z;
    real c2 = c * c;
    EXACT real glow = K(3.0f) * c2 * c2;
    /* both tints have luminance 1 */
    v3 blue = V3(K(0.62f), K(1.0f), K(2.1189f));
    v3 warm = V3(K(1.33f), K(0.95f), K(0.5236f));
    v3 up = add3(blue, mul3(warm, glow));
    real below = max_(K(1.0f) + d.z * K(8.0f), K(0.025f));
    EXACT real scale = zenith * sel(d.z < K(0.0f), below, K(1.0f));
    return mul3(up, scale);
}

#endif
