/* Profiles for tests: some send nothing upward, some send only that, some are narrow, some uneven all around. */
#ifndef NOC_TEST_PROFILES_H
#define NOC_TEST_PROFILES_H

#include "../test.h"

#include <math.h>
#include <nocturne/scene.h>

enum { TEST_PROFILES = 6 };

/* Adds them; the first one's index. */
static inline int add_test_profiles(noc_scene *s) {
    static const double to[TEST_PROFILES] = { 90, 180, 35, 90, 180, 62.5 }, from[TEST_PROFILES] = { 0, 0, 0, 0, 90, 0 };
    int first = 0;
    for (int i = 0; i < TEST_PROFILES; i++) {
        double c[24], gamma[20], cd[24 * 20];
        int planes = i == 1 || i == 2 ? 1 : 24;
        for (int p = 0; p < planes; p++) {
            c[p] = 15 * p;
            for (int k = 0; k < 20; k++) {
                gamma[k] = from[i] + (to[i] - from[i]) * k / 19;
                double peak = exp(-pow((gamma[k] - from[i] - .7 * (to[i] - from[i])) / 12, 2));
                cd[20 * p + k] = 10 + 200 * peak * (1.01 + cos((c[p] + 40 * i) * M_PI / 180));
            }
        }
        noc_profile *profile = NULL;
        assert_int_equal(noc_profile_create(NULL, &(noc_profile_params){ NULL, planes, 20, c, gamma, cd, 0 }, &profile),
                         NOC_OK);
        int index = noc_scene_add_profile(s, profile);
        assert_true(index > 0);
        first = i ? first : index;
        noc_profile_destroy(profile);
    }
    return first;
}

/* One for every other light of the kinds that have some; lumens are about what its radiance would have given. */
static inline void give_profile(noc_light *l, uint32_t i, int first) {
    if (l->kind != NOC_LIGHT_POINT && l->kind != NOC_LIGHT_SPHERE && l->kind != NOC_LIGHT_DISC)
        return;
    if (i / 12 % 2)
        return;
    l->profile = first + (int)(i / 24 % TEST_PROFILES);
    for (int k = 0; k < 3; k++)
        l->c0[k] = cos(i + 2.0 * k);
}

#endif
