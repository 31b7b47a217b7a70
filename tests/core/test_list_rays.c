/* core/list_rays.h: a pixel never asks for more rays than there is room for, however its random numbers round. */
#include "no_profiles.h"

#include <math.h>

#include "given_list.h"

enum { ENTRIES = 200, RAYS = 64 };

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

/* Entries whose weights do not add up without rounding: the first ones are near, and all the others far. */
static void make_weights(struct core_context *c, uint32_t count, uint32_t near, float (*weight)(uint32_t)) {
    uint32_t rows = list_rows(count);
    float sum = 0;
    c->count = count;
    c->summed[0] = 0;
    for (uint32_t i = 0; i < near; i++) {
        c->near_entry[i] = i;
        c->summed[i + 1] = c->summed[i] + weight(i);
    }
    for (uint32_t column = 0; column < 16; column++) {
        float down = 0;
        c->column[0][column] = sum;
        for (uint32_t row = 0; row < rows; row++) {
            uint32_t i = column * rows + row;
            c->far[0][row][column] = down;
            down += i >= near && i < count ? weight(i) : 0;
        }
        c->far[0][rows][column] = down;
        sum += down;
    }
    c->column[0][16] = sum;
}

static float uneven(uint32_t i) { return 0.1f + (float)(i * 37 % 11); }

static void rays_have_room(void **state) {
    static struct core_context context;
    struct core_context *ctx = &context;
    for (uint32_t rays = 1; rays <= RAYS; rays++)
        for (size_t i = 0; i < 3 * sizeof(roundings) / sizeof(*roundings); i++) {
            uint32_t near = i % 3 * (ENTRIES / 2);
            float rounding = roundings[i / 3];
            double all = 0;
            make_weights(ctx, ENTRIES, near, uneven);
            list_sums sums = { .all = ctx->summed[near] + ctx->column[0][16] };
            float n = list_draws(sums, (float)rays, 0.01f, rounding);
            ctx->room = 2 * rays;
            uint32_t made = list_share_out(PASS sums.all, near, 0, list_rows(ENTRIES), n, 1 - rounding);
            for (uint32_t k = 0; k < made; k++)
                all += (double)ctx->drawn[k].times;
            assert_true(made <= 2 * rays && made == ctx->rays && all == (double)n);
        }
}

static float some_empty(uint32_t i) { return i % 3 == 1 ? (float)(1 + i % 5) : 0; }

/* Entries without a weight are never drawn, at the ends neither, and a goal past the end is of the last one with some.
 */
static void searched(void **state) {
    static struct core_context context;
    struct core_context *ctx = &context;
    for (uint32_t count = 2; count <= ENTRIES; count += 1 + count / 7) {
        uint32_t rows = list_rows(count), last = (count - 2) / 3 * 3 + 1;
        float *const s = ctx->summed, (*const far)[16] = ctx->far[0];
        make_weights(ctx, count, count, some_empty);
        float end = s[count];
        for (float goal = 0; goal < end; goal += 0.5f) {
            list_drawn d = near_at(PASS count, end, goal);
            assert_true(s[d.entry] <= goal && goal < s[d.entry + 1]);
            assert_true(d.weighed == some_empty(d.entry));
        }
        assert_int_equal(near_at(PASS count, end, end).entry, last);
        assert_int_equal(near_at(PASS count, end, 1.001f * end).entry, last);
        make_weights(ctx, count, 0, some_empty);
        assert_true(ctx->column[0][16] == end);
        for (float goal = 0; goal < end; goal += 0.5f) {
            list_drawn d = far_entry_at(PASS 0, rows, end, goal);
            uint32_t column = d.entry / rows, row = d.entry % rows;
            float rest = goal - ctx->column[0][column];
            assert_true(d.entry < count && far[row][column] <= rest && rest < far[row + 1][column]);
            assert_true(d.weighed == some_empty(d.entry));
        }
        assert_int_equal(far_entry_at(PASS 0, rows, end, end).entry, last);
        assert_int_equal(far_entry_at(PASS 0, rows, end, 1.001f * end).entry, last);
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
