/* core/environment.h: a picture of all that is around the scene, as background and as light.
 *
 * The picture is equirectangular: its rows go from the zenith down to the nadir in even steps of the angle, its columns
 * once around, clockwise as seen from above. It is kept twice. What is seen is interpolated. What lights may be
 * a smaller copy, and is constant in a texel, so that texels are drawn by an alias table over luminance times solid
 * angle, and a place in one uniformly by solid angle: the density of a direction is then its texel's luminance over the
 * map's power, whichever texel it is. Includers supply the bridges environment_texel, environment_slot,
 * environment_sine and backdrop_texel. */
#ifndef CORE_ENVIRONMENT_H
#define CORE_ENVIRONMENT_H

#include "core/alias.h"
#include "core/frame.h"
#include "core/sky.h"

FN v3 environment_texel(CTX u32 i);        /* of what lights, linear Rec.709 as in the file */
FN alias_slot environment_slot(CTX u32 i); /* of what lights: light is the texel */
FN real environment_sine(CTX u32 row);     /* of the elevation of that row's upper edge; there is one row more */
FN v3 backdrop_texel(CTX u32 i);           /* of what is seen */

/* Where the unit direction d lies on the map, in x and y: 0 to 1 from the left and from the top. turn: of the map's
 * left edge, counter-clockwise from x, 0 to 1. */
FN v3 environment_place(v3 d, real turn) {
    real t = turn_of(d.x, abs_(d.y));
    t = sel(d.y < K(0.0f), K(1.0f) - t, t);
    EXACT real u = turn - t;
    u = sel(u < K(0.0f), u + K(1.0f), u);
    EXACT real across2 = d.x * d.x + d.y * d.y;
    EXACT real v = turn_of(d.z, sqrt_(across2)) * K(2.0f);
    return V3(u, v, K(0.0f));
}

/* The other way round; z is the sine of the elevation. */
FN v3 environment_direction(real u, real z, real turn) {
    EXACT real t = turn - u;
    t = sel(t < K(0.0f), t + K(1.0f), t);
    v3 cs = circle(min_(max_(t, K(0.0f)), K(1.0f)));
    EXACT real r2 = K(1.0f) - z * z;
    real r = sqrt_(max_(r2, K(0.0f)));
    return V3(r * cs.x, r * cs.y, z);
}

/* Which of count cells the place is in. */
FN u32 environment_cell(real place, u32 count) {
    u32 i = to_u32(place * to_real(count));
    return selu(i < count, i, count - KU(1u));
}

/* What comes from the unit direction d, as light, and its density among drawn directions, 1/sr. Next to a texel's edge
 * rounding may take the neighbour: by some 1e-7 of a turn, which draws do as well. */
FN v3 environment_radiance(CTX v3 d) {
    v3 at = environment_place(d, K(FRAME.environment_turn));
    u32 column = environment_cell(at.x, KU(FRAME.environment_width));
    u32 row = environment_cell(at.y, KU(FRAME.environment_height));
    return environment_texel(PASS row * KU(FRAME.environment_width) + column);
}

FN real environment_density(CTX v3 radiance) {
    EXACT real p = luminance(radiance) * K(FRAME.environment_inverse_power);
    return p;
}

/* A direction drawn from the map. bits choose the alias table's slot, xi whether its own texel is kept, place where in
 * the texel; all are independent. */
FN v3 environment_draw(CTX u32 bits, real xi, u32 place) {
    u32 width = KU(FRAME.environment_width);
    u32 i = scale_u32(bits, width * KU(FRAME.environment_height));
    alias_slot s = environment_slot(PASS i);
    i = selu(xi < s.keep, i, s.other);
    /* texels are fewer than 2^23: the quotient lies further from whole numbers than it is rounded */
    EXACT real quotient = (to_real(i) + K(0.5f)) / to_real(width);
    u32 row = to_u32(quotient);
    real upper = environment_sine(PASS row);
    real lower = environment_sine(PASS row + KU(1u));
    EXACT real z = upper + (lower - upper) * unit_high(place);
    EXACT real u = (to_real(i - row * width) + unit_low(place)) / to_real(width);
    return environment_direction(u, z, K(FRAME.environment_turn));
}

/* A direction for light from all around: half of them drawn from the map, half as sky_direction draws. `number` is a
 * place in the pixel's sequence, key is of the pixel and frame 0. */
FN v3 environment_ray(CTX surf s, u32 key, u32 number) {
    u32 a = sky_bits_x(key, number);
    real b = unit_real(sky_bits_y(key, number));
    u32 rest = shl(a, 1);
    v3 of_surface = sky_direction(s, unit_real(rest), b);
    u32 place = hash_u32(rng_bits(key, KU(DIM_ENVIRONMENT)) + number);
    return sel3(a < KU(0x80000000u), environment_draw(PASS rest, b, place), of_surface);
}

/* Density of environment_ray, 1/sr: of both ways together (the balance heuristic; Veach and Guibas 1995). */
FN real environment_ray_density(CTX surf s, v3 d, v3 radiance) {
    EXACT real p = K(0.5f) * (sky_density(s, d) + environment_density(PASS radiance));
    return p;
}

/* What is seen in the unit direction d, bilinear between the centres of texels, cd/m2. */
FN v3 environment_backdrop(CTX v3 d) {
    v3 at = environment_place(d, K(FRAME.environment_turn));
    u32 width = KU(FRAME.backdrop_width);
    u32 height = KU(FRAME.backdrop_height);
    EXACT real x = at.x * to_real(width) + K(0.5f);
    EXACT real y = min_(max_(at.y * to_real(height) - K(0.5f), K(0.0f)), to_real(height - KU(1u)));
    u32 right = to_u32(x);
    u32 upper = to_u32(y);
    real s = x - to_real(right);
    real t = y - to_real(upper);
    right = selu(right < width, right, KU(0u));
    u32 left = selu(right == KU(0u), width - KU(1u), right - KU(1u));
    upper = selu(upper < height, upper, height - KU(1u));
    u32 lower = selu(upper + KU(1u) < height, upper + KU(1u), upper);
    v3 a = backdrop_texel(PASS upper * width + left);
    v3 b = backdrop_texel(PASS upper * width + right);
    v3 c = backdrop_texel(PASS lower * width + left);
    v3 e = backdrop_texel(PASS lower * width + right);
    a = add3(mul3(a, K(1.0f) - s), mul3(b, s));
    c = add3(mul3(c, K(1.0f) - s), mul3(e, s));
    return mul3(add3(mul3(a, K(1.0f) - t), mul3(c, t)), K(FRAME.environment_scale));
}

#endif
