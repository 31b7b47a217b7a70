/* core/list_rays.h: a pixel never asks for more rays than there is room for, however its random numbers round. */
#include "../test.h"
#include "no_profiles.h"

#include <math.h>

enum { ENTRIES = 200, RAYS = 64 };
struct core_context {
    float *summed;
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
FN void summed_store(CTX u1 i, real sum) { ctx->summed[i] = sum; }
FN real summed_at(CTX u32 i) { return ctx->summed[i]; }
FN real drawn_times(CTX u1 ray) { return 0; }
FN real found_p(CTX u1 ray) { return 0; }
FN real found_w(CTX u1 ray) { return 0; }
FN void drawn_store(CTX u32 ray, mask on, u32 entry, real times) {
    if (!on)
        return;
    if (ray >= ctx->room)
        fail_msg("ray %u, where there is room for %u", ray, ctx->room);
    *ctx->rays = ray + 1;
    ctx->times[ray] = (double)times; /* each draw of an entry tells the ray anew */
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
            float summed[ENTRIES + 1];
            uint32_t drawn = 0;
            double times[2 * RAYS] = { 0 }, all = 0;
            const struct core_context context = { summed, &drawn, 2 * rays, times }, *ctx = &context;
            list_sums sums = { .all = 0, .bright = 0 };
            summed[0] = 0;
            for (uint32_t k = 0; k < ENTRIES; k++)
                summed[k + 1] = sums.all += 0.1f + (float)(k * 37 % 11);
            float n = list_draws(sums, (float)rays, 0.01f, roundings[i]);
            uint32_t made = list_share_out(PASS sums, ENTRIES, n, 1 - roundings[i]);
            for (uint32_t k = 0; k < made; k++)
                all += times[k];
            assert_true(made <= 2 * rays && made == drawn && all == (double)n);
        }
}

/* Entries without a weight are never drawn, at the ends neither, and a goal past the end is of the last one with some.
 */
static void searched(void **state) {
    float summed[ENTRIES + 1];
    const struct core_context context = { .summed = summed }, *ctx = &context;
    for (uint32_t count = 1; count <= ENTRIES; count += 1 + count / 7) {
        float end = 0;
        uint32_t last = 0;
        for (uint32_t k = 0; k < count; k++) {
            bool some = k % 3 == 1 || count < 3;
            summed[k] = end;
            end += some ? (float)(1 + k % 5) : 0;
            last = some ? k : last;
        }
        summed[count] = end;
        for (float goal = 0; goal < end; goal += 0.5f) {
            u32 entry = list_entry_at(PASS count, end, goal);
            assert_true(entry < count && summed[entry] <= goal && goal < summed[entry + 1]);
        }
        assert_int_equal(list_entry_at(PASS count, end, end), last);
        assert_int_equal(list_entry_at(PASS count, end, 1.001f * end), last);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(most_draws),
        cmocka_unit_test(fewer_draws),
        cmocka_unit_test(rays_have_room),
        cmocka_unit_test(searched),
    };
    return cmocka_run_group_tests_name("core/list_rays", tests, NULL, NULL);
}
