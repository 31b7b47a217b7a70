/* Lights of all kinds and surfaces, by dice, for tests of what is weighed in brief. With a profile for those that can
 * have one. */
#ifndef NOC_TEST_ANY_LIGHT_H
#define NOC_TEST_ANY_LIGHT_H

#include "core_test.h"

#include "core/surface.h"

/* One profile: its head, and a table of one step, which sends more ahead than aside and nothing back. */
FN profile_cell profile_load(CTX u32 place) {
    if (place == 0)
        return (profile_cell){ real_of_bits(1), real_of_bits(1u << 16 | 1), 4, .25f };
    return (profile_cell){ .4f, .4f, .1f, .1f };
}

static inline light any_light(dice *d, u32 kind, bool profile) {
    light l = { .kind = kind, .e = V3((float)uniform(d, 1, 50), (float)uniform(d, 1, 50), (float)uniform(d, 1, 50)) };
    l.a = random_in_box(d, 1);
    l.b = random_in_box(d, 1);
    if (kind == LIGHT_DISC) {
        v3 a = random_direction(d), n = random_direction(d);
        l.radius = (float)uniform(d, .1, 1);
        l.a = mul3(normalised(cross3(a, n)), l.radius);
        l.b = mul3(normalised(cross3(l.a, a)), l.radius);
    } else if (kind == LIGHT_SPHERE || kind == LIGHT_POINT) {
        l.radius = kind == LIGHT_SPHERE ? (float)uniform(d, .05, 1) : 0;
        l.a = profile ? V3(1, 0, 0) : l.a;
        l.b = profile ? V3(0, 1, 0) : l.b;
    } else if (kind == LIGHT_SPOT) {
        l.a = mul3(random_direction(d), 2);
        l.b = V3(-.5f, 0, 0);
    } else {
        v3 c = add3(l.a, l.b), e = sub3(l.a, l.b);
        float longest = max_(max_(dot3(l.a, l.a), dot3(l.b, l.b)), dot3(e, e));
        l.radius = sqrtf(kind == LIGHT_TRIANGLE ? longest : max_(longest, dot3(c, c)));
    }
    l.flags = kind != LIGHT_SPHERE && kind != LIGHT_POINT && uniform(d, 0, 1) < .3 ? LIGHT_TWO_SIDED : 0;
    if (profile && (kind == LIGHT_SPHERE || kind == LIGHT_POINT || kind == LIGHT_DISC)) {
        l.flags |= 1 << LIGHT_PROFILE;
        l.area = .4f;
    }
    return l;
}

static inline surf any_surface(dice *d, bool glossy) {
    surf s = { .n = random_direction(d), .wo = random_direction(d), .albedo = V3(.5f, .3f, .2f) };
    double rough = uniform(d, .05, 1);
    if (dot3(s.n, s.wo) < 0)
        s.wo = mul3(s.wo, -1);
    s.alpha = (float)(rough * rough);
    s.f0 = glossy ? .05f : 0;
    return s;
}

#endif
