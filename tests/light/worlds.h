/* Worlds of random lights, for the tests of what draws them. */
#ifndef NOC_TEST_WORLDS_H
#define NOC_TEST_WORLDS_H

#include "../render/rooms.h"
#include "profiles.h"

#include "core/random.h"
#include "core/surface.h"

static const float *cells_; /* of the world that is looked at */
FN profile_cell profile_load(CTX u32 place) {
    profile_cell c;
    memcpy(&c, cells_ + (size_t)place * 4, sizeof(c));
    return c;
}

static uint32_t state_ = 1;
static inline uint32_t bits(void) { return state_ = hash_u32(state_ + 0x9e3779b9u); }
static inline float real_in(float lo, float hi) { return lo + (hi - lo) * unit_real(bits()); }

typedef enum { MIXED, DARK_ONES, ONE_PLACE, ALL_DARK } sort;

/* Lights of all kinds in a street's shape, with a floor for S_r to be found on. */
static inline noc_scene *world(uint32_t lights, sort what) {
    noc_scene *s = noc_scene_create(NULL);
    float half = 10 + 2 * sqrtf((float)lights);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, half);
    int profiles = add_test_profiles(s);
    for (uint32_t i = 0; i < lights; i++) {
        noc_light l = { .kind = (noc_light_kind)((i + i / 6) % NOC_LIGHT_KIND_COUNT),
                        .radius = real_in(0.05f, 0.4f),
                        .inner_deg = 20,
                        .outer_deg = 50 }; /* kinds of even and of odd lights alike */
        bool dark = what == ALL_DARK || (what == DARK_ONES && i % 3 != 1);
        float strong = i % 50 == 17 ? 3000 : 3;
        for (int k = 0; k < 3; k++) {
            l.position[k] = what == ONE_PLACE ? 3 : k == 2 ? real_in(0.5f, 15) : real_in(-half, half);
            l.edge_u[k] = real_in(-1, 1);
            l.edge_v[k] = real_in(-1, 1);
            l.direction[k] = real_in(-1, 1) - (k == 2 ? 1.2f : 0);
            l.emission[k] = dark ? 0 : real_in(0.1f, 1) * strong;
        }
        give_profile(&l, i, profiles);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->lights.len, lights);
    for (uint32_t i = 0; i < lights; i += 7)
        s->lights.data[i].flags |= LIGHT_TWO_SIDED; /* two-sided */
    return s;
}

static inline surf random_surf(float half) {
    float a = real_in(0, 6.28f), up = real_in(-0.3f, 1), r = sqrtf(fmaxf(1 - up * up, 0));
    surf s = { .p = { real_in(-half, half), real_in(-half, half), real_in(0, 12) }, .albedo = { 0.4f, 0.5f, 0.3f } };
    s.n = V3(r * cosf(a), r * sinf(a), up);
    s.wo = s.n;
    return s;
}

static inline double shine(const noc_scene *s, surf y, uint32_t i) {
    light l;
    memcpy(&l, &s->lights.data[i], sizeof(l));
    cells_ = s->profile_cells.data;
    return target(NULL, y, l, 0.3f, 0.6f);
}

static const struct {
    uint32_t lights;
    sort what;
} worlds[] = {
    { 1, MIXED },       { 2, MIXED },       { 3, DARK_ONES }, { 9, ONE_PLACE }, { 50, MIXED },
    { 300, DARK_ONES }, { 500, ONE_PLACE }, { 1000, MIXED },  { 20, ALL_DARK }, { 100000, MIXED },
};

#endif
