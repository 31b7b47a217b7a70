/* core/list_rays.h: a pixel never asks for more rays than there is room for, however its random numbers round. */
#include "../test.h"
#include "no_profiles.h"

#include <math.h>

enum { ENTRIES = 200, RAYS = 64 };
struct core_context {
    float *weighed;
    uint32_t *rays, room; /* rays: how many were drawn */
    double *times;
};

#include "no_lists.h"

FN light light_load(CTX u32 i) { return (light){ .kind = LIGHT_POINT }; }
FN light light_splat(CTX u1 i) { return light_load(PASS i); }
FN list_entry entry_load(CTX u1 i) { return (list_entry){ i, 1 }; }
FN list_prior prior_load(CTX u1 i) { return (list_prior){ 0 }; }
FN u32 entry_lights(CTX u1 first, int l, u1 count) { return first; }
FN void sketch_store(CTX u1 first, int l, list_sketch k) {}
FN list_sketch sketch_load(CTX u1 i) { return (list_sketch){ .radius = 0 }; }
FN u1 sketch_shape(CTX u1 i) { return SKETCH_NONE; }
FN u32 entry_light(CTX u32 i) { return i; }
FN real entry_weight(CTX u32 i) { return 1; }
FN void weighed_store(CTX u1 i, real weighed) { ctx->weighed[i] = weighed; }
FN real weighed_load(CTX u1 i) { return ctx->weighed[i]; }
FN real weighed_at(CTX u32 i) { return ctx->weighed[i]; }
FN real drawn_times(CTX u1 ray) { return 0; }
FN real found_p(CTX u1 ray) { return 0; }
FN real found_w(CTX u1 ray) { return 0; }
FN void drawn_store(CTX u32 ray, mask on, u32 entry, real times) {
    if (!on)
        return;
    if (ray >= ctx->room)
        fail_msg("ray %u, where there is room for %u", ray, ctx->room);
    *ctx->rays = ray + 1;
    *ctx->times += (double)times;
}

/* What random numbers become: the largest, and what is around where a sum of it rounds up. */
static const float roundings[] = { 0, .25f, .5f, 1 - 0x1p-10f, 1 - 0x1p-19f, 1 - 0x1p-20f, 1 - 0x1p-21f, 1 - 0x1p-24f };

/* A pixel that nothing is known of but that no light gets through asks for all that it may. */
static void most_draws(void **state) {
    for (uint32_t rays = 1; rays <= RAYS; rays++)
        for (size_t i = 0; i < sizeof(roundings) / sizeof(*roundings); i++) {
            list_sums sums = { .all = 100, .bright = 0 };
            float n = list_draws(sums, (float)rays, 0.01f, roundings[i]);
            if (n != 2 * (float)rays)
                fail_msg("%g draws of %u at %.9g", (double)n, 2 * rays, (double)roundings[i]);
        }
}

/* Fewer are rounded both ways, to what is asked for on average; none are asked for where there is no light. */
static void fewer_draws(void **state) {
    enum { STEPS = 1000 };
    EXACT float unknown = LEARNED_UNKNOWN / learned_pull(LEARNED_UNKNOWN);
    list_sums sums = { .all = 1, .bright = 4 * unknown / 2.3f };
    double mean = 0;
    for (int i = 0; i < STEPS; i++)
        mean += (double)list_draws(sums, 4, 0, ((float)i + .5f) / STEPS) / STEPS;
    assert_true(fabs(mean - 2.3) < .002);
    sums.all = 0;
    assert_true(list_draws(sums, 4, 1, .9f) == 0);
}

static void rays_have_room(void **state) {
    for (uint32_t rays = 1; rays <= RAYS; rays++)
        for (size_t i = 0; i < sizeof(roundings) / sizeof(*roundings); i++) {
            float weighed[ENTRIES];
            uint32_t drawn = 0;
            double times = 0;
            const struct core_context context = { weighed, &drawn, 2 * rays, &times }, *ctx = &context;
            list_sums sums = { .all = 0, .bright = 0 };
            for (uint32_t k = 0; k < ENTRIES; k++)
                sums.all += weighed[k] = 0.1f + (float)(k * 37 % 11);
            float n = list_draws(sums, (float)rays, 0.01f, roundings[i]);
            uint32_t made = list_share_out(PASS sums, ENTRIES, n, 1 - roundings[i]);
            assert_true(made <= 2 * rays && made == drawn && times == (double)n);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(most_draws),
        cmocka_unit_test(fewer_draws),
        cmocka_unit_test(rays_have_room),
    };
    return cmocka_run_group_tests_name("core/list_rays", tests, NULL, NULL);
}
