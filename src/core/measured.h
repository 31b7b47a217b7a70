/* core/measured.h: what views measure; surfaces whose illuminance can be measured. Where a light has nothing of the
 * colours that a surface reflects diffusely, none of its candidates is ever kept, however much it lights; and what
 * gloss alone keeps says next to nothing. */
#ifndef CORE_MEASURED_H
#define CORE_MEASURED_H

#include "core/dialect.h"

/* Bits for the components of a colour that are above 0. */
FN u32 colour_components(v3 c) {
    u32 bits = selu(c.x > K(0.0f), KU(1u), KU(0u));
    bits = bits | selu(c.y > K(0.0f), KU(2u), KU(0u));
    return bits | selu(c.z > K(0.0f), KU(4u), KU(0u));
}

/* colours: bit n is set where a light has the components n. */
FN mask lux_measurable(u1 colours, v3 albedo) {
    u32 reflected = colour_components(albedo), missed = KU(0u);
    for (u1 of = 1u; of < 8u; of++)
        if ((colours >> of & 1u) != 0u)
            missed = selu((KU(of) & reflected) == KU(0u), KU(1u), missed);
    return missed == KU(0u);
}

/* What a sample adds to an illuminance, unless it is no number that can be added. */
FN mask lux_adds(real e) { return and_(e >= K(0.0f), e < K(1e30f)); }

/* How often a light is expected among `draws` candidates, by the inverse of its probability. */
FN real expected_draws(u1 draws, real inverse) {
    EXACT real times = K(F32(draws)) / inverse;
    return times;
}

/* The same of a list that holds it several times, by the weight of its first entry. */
FN real expected_entries(real weight, u1 copies) {
    EXACT real times = K(1.0f) / (weight * K(F32(copies)));
    return times;
}

#endif
