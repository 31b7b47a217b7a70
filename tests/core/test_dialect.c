/* One source, three readers: every function of src/core gives the same bits as scalar C, as C of 4, 8 and 16 lanes, and
 * as GLSL on Mesa's software device; on others it stays within a tolerance. */
#include "../test.h"
#include "dialect_slots.h"

#include <math.h>
#include <stdbool.h>

#define ITEMS 16384u

void dialect_run_1(uint32_t *out, uint32_t items);
void dialect_run_4(uint32_t *out, uint32_t items);
#if defined(HAVE_X86_WIDE)
void dialect_run_8(uint32_t *out, uint32_t items);
void dialect_run_16(uint32_t *out, uint32_t items);
#endif

#if defined(HAVE_VULKAN)
#include "dialect_draws.h"
#include "dialect_frames.h"
#include "dialect_lights.h"
#include "dialect_reservoirs.h"
#include "dialect_tile.h"
#include "dialect_tile_lists.h"
#include "vulkan_run.h"
#endif

/* First slot of each group of dialect_kernel.h, for messages. */
static const struct {
    int first;
    const char *name;
} groups[] = {
    { 0, "random bits" },
    { 1, "rng" },
    { 2, "unit_low" },
    { 3, "unit_high" },
    { 4, "scale_u32" },
    { 6, "circle" },
    { 9, "around" },
    { 12, "cosine_hemisphere" },
    { 15, "cross3" },
    { 18, "luminance" },
    { 19, "sqrt_" },
    { 20, "sphere" },
    { 27, "disc" },
    { 34, "triangle" },
    { 41, "parallelogram" },
    { 48, "point" },
    { 55, "sample_light" },
    { 56, "reflect, glossy" },
    { 59, "reflect, diffuse" },
    { 62, "target" },
    { 63, "camera_project" },
    { 66, "camera_direction" },
    { 69, "abs_" },
    { 70, "to_u32" },
    { 71, "ris_uniform, 1 candidate" },
    { 77, "ris_uniform" },
    { 83, "reservoir_cap" },
    { 89, "builder" },
    { 95, "builder tag" },
    { 96, "mis_scale" },
    { 98, "pair_share" },
    { 99, "pair_weight" },
    { 100, "pair_canonical" },
    { 101, "min_, max_" },
    { 103, "selu" },
    { 104, "shadow_segment, begin" },
    { 107, "shadow_segment, way" },
    { 110, "sky_radiance" },
    { 113, "ray_offset" },
    { 114, "sky_numbers" },
    { 116, "sky_direction" },
    { 119, "visible_normal_direction" },
    { 122, "sky_density" },
    { 123, "sky_backdrop" },
    { 126, "alias_draw" },
    { 128, "alias_pmf" },
    { 129, "tree_split" },
    { 130, "tree_share_of" },
    { 131, "tree_pmf" },
    { 132, "influence_gives" },
    { 133, "influence_pmf" },
    { 134, "influence_uniform" },
    { 135, "ris_given" },
    { 141, "disc, close" },
    { 148, "triangle, close" },
    { 155, "parallelogram, close" },
    { 162, "turn_of" },
    { 163, "spot" },
    { 170, "alias_draw, other numbers" },
    { 172, "tree_go" },
    { 177, "tree_draw" },
    { FRAME_FIRST, "neighbour_key" },
    { FRAME_FIRST + 1, "neighbour_offset" },
    { FRAME_FIRST + 3, "neighbour_place" },
    { FRAME_FIRST + 6, "history_place" },
    { FRAME_FIRST + 9, "receivers_alike" },
    { FRAME_FIRST + 10, "nearest" },
    { FRAME_FIRST + 11, "reuse, biased" },
    { FRAME_FIRST + 25, "reuse, mis" },
    { FRAME_FIRST + 39, "reuse, pairwise" },
    { FRAME_FIRST + 53, "reservoir_blocked" },
    { FRAME_FIRST + 59, "resolve_asks" },
    { FRAME_FIRST + 60, "reuse_answer" },
    { FRAME_FIRST + 61, "reference_entries" },
    { FRAME_FIRST + 65, "sample_shade" },
    { FRAME_FIRST + 68, "sky_turns" },
    { FRAME_FIRST + 69, "sky_ray" },
    { FRAME_FIRST + 72, "sky_shade" },
    { FRAME_FIRST + 75, "sky_behind" },
    { FRAME_FIRST + 78, "moments_add" },
    { FRAME_FIRST + 79, "mean_add" },
    { FRAME_FIRST + 80, "colour_finite" },
    { FRAME_FIRST + 81, "hit_point" },
    { FRAME_FIRST + 84, "hit_normal" },
    { FRAME_FIRST + 87, "emitter_shade" },
    { FRAME_FIRST + 90, "sees_emitter" },
    { FRAME_FIRST + 91, "environment_place" },
    { FRAME_FIRST + 93, "environment_direction" },
    { FRAME_FIRST + 96, "environment_cell" },
    { FRAME_FIRST + 97, "environment_radiance" },
    { FRAME_FIRST + 100, "environment_draw" },
    { FRAME_FIRST + 103, "environment_ray" },
    { FRAME_FIRST + 106, "environment_ray_density" },
    { FRAME_FIRST + 107, "environment_backdrop" },
    { FRAME_FIRST + 110, "sky_turns, map" },
    { FRAME_FIRST + 111, "sky_ray, map" },
    { FRAME_FIRST + 112, "sky_shade, map" },
    { FRAME_FIRST + 115, "sky_behind, map" },
    { FRAME_FIRST + 118, "headlight_shade" },
    { FRAME_FIRST + 121, "reuse, counted" },
    { INFLUENCE_FIRST, "influence_from_list" },
    { INFLUENCE_FIRST + 1, "influence_inverse" },
    { INFLUENCE_FIRST + 2, "presample_at, influence_listed, influence_sets" },
    { INFLUENCE_FIRST + 3, "influence_inverse, of what is listed" },
    { INFLUENCE_FIRST + 4, "influence_lists" },
    { INFLUENCE_FIRST + 5, "influence_near" },
    { INFLUENCE_FIRST + 8, "rule_best" },
    { INFLUENCE_FIRST + 9, "rule_limit" },
    { INFLUENCE_FIRST + 10, "influence_groups" },
    { INFLUENCE_FIRST + 12, "influence_find" },
    { LEARNED_FIRST, "cell_key_of" },
    { LEARNED_FIRST + 2, "cell_lane" },
    { LEARNED_FIRST + 3, "cell_turn" },
    { LEARNED_FIRST + 4, "cell_run" },
    { LEARNED_FIRST + 5, "cell_claim, cell_count" },
    { LEARNED_FIRST + 6, "cell_find" },
    { LEARNED_FIRST + 8, "cell_count" },
    { LEARNED_FIRST + 10, "cell_visibility" },
    { LISTS_FIRST, "list_u" },
    { LISTS_FIRST + 1, "list_v" },
    { LISTS_FIRST + 2, "ris_list" },
    { LISTS_FIRST + 8, "list_weigh" },
    { LISTS_FIRST + 10, "list_draws" },
    { LISTS_FIRST + 11, "list_share_out, past the end" },
    { LISTS_FIRST + 13, "list_share_out" },
    { LISTS_FIRST + 15, "list_ask" },
    { LISTS_FIRST + 20, "list_shown" },
    { LISTS_FIRST + 21, "list_resample" },
    { LISTS_FIRST + 23, "list_reused" },
    { LISTS_FIRST + 24, "root_of_squares" },
    { LISTS_FIRST + 25, "tenth" },
    { LISTS_FIRST + 26, "brief_unpack" },
    { LISTS_FIRST + 34, "patch_gloss" },
    { LISTS_FIRST + 35, "make_patches" },
    { LISTS_FIRST + 36, "pixels_in_front" },
    { LISTS_FIRST + 37, "bound_patch" },
    { LISTS_FIRST + 50, "bound_gloss" },
    { LISTS_FIRST + 52, "score_sum" },
    { LISTS_FIRST + 53, "scores_over" },
    { LISTS_FIRST + 54, "places_over" },
    { LISTS_FIRST + 55, "score_step" },
    { LISTS_FIRST + 56, "cut_scores" },
    { LISTS_FIRST + 58, "place_at" },
    { LISTS_FIRST + 60, "groups_sum" },
    { LISTS_FIRST + 61, "lay_line" },
    { LISTS_FIRST + 62, "tail_line_of" },
    { LISTS_FIRST + 63, "score_nodes" },
    { LISTS_FIRST + 65, "score_lights" },
    { LISTS_FIRST + 67, "way_down" },
    { LISTS_FIRST + 69, "learned_pull" },
    { LISTS_FIRST + 70, "learned_visibility" },
    { LISTS_FIRST + 71, "list_prior_of" },
    { LISTS_FIRST + 73, "list_build and list_fill" },
    { LISTS_FIRST + 78, "sketch_surf_of" },
    { LISTS_FIRST + 79, "sketch_of" },
    { LISTS_FIRST + 90, "sketch_target" },
    { LISTS_FIRST + 91, "sketch_gloss" },
    { LISTS_FIRST + 92, "quick_inverse_root" },
    { LISTS_FIRST + 93, "join_patches" },
    { LISTS_FIRST + 101, "face_of" },
    { LISTS_FIRST + 104, "weigh_face" },
    { LISTS_FIRST + 107, "near_entries" },
    { LISTS_FIRST + 109, "weigh_faces" },
    { LISTS_FIRST + 110, "tail_place" },
    { LISTS_FIRST + 112, "tail_weight" },
    { LISTS_FIRST + 113, "list_stand_in" },
    { LISTS_FIRST + 119, "list_resampled" },
    { TEXTURES_FIRST, "texture_level" },
    { TEXTURES_FIRST + 1, "texture_albedo" },
    { TEXTURES_FIRST + 4, "texture_albedo, first level" },
    { TEXTURES_FIRST + 7, "texel_pack" },
    { TEXTURES_FIRST + 8, "texel_albedo" },
    { TEXTURES_FIRST + 11, "rough_log2" },
    { TEXTURES_FIRST + 12, "whole_under" },
    { TEXTURES_FIRST + 13, "image_wrap" },
    { TEXTURES_FIRST + 16, "texels_at" },
    { PRESAMPLED_FIRST, "presample_of" },
    { PRESAMPLED_FIRST + 13, "presample_look" },
    { PRESAMPLED_FIRST + 15, "presample_key, presample_subsets" },
    { PRESAMPLED_FIRST + 16, "presample_bits" },
    { PRESAMPLED_FIRST + 17, "presample_choice" },
    { PRESAMPLED_FIRST + 18, "presample_place" },
    { PRESAMPLED_FIRST + 19, "presample_turned" },
    { PRESAMPLED_FIRST + 20, "presample_plain" },
    { PRESAMPLED_FIRST + 21, "ris_presampled" },
    { PRESAMPLED_FIRST + 28, "presample_draw" },
    { PRESAMPLED_FIRST + 29, "presample_draw_power" },
    { PRESAMPLED_FIRST + 31, "presample_rank, presample_subset" },
    { PRIMARY_FIRST, "receiver_of_hit, place" },
    { PRIMARY_FIRST + 3, "receiver_of_hit, normal" },
    { PRIMARY_FIRST + 6, "receiver_of_hit, depth" },
    { PRIMARY_FIRST + 7, "light_seen" },
    { PRIMARY_FIRST + 8, "frame_direction" },
    { PRIMARY_FIRST + 10, "rays_apart2" },
    { PRIMARY_FIRST + 11, "placement_scale2" },
    { PRIMARY_FIRST + 12, "hit_width" },
    { PRIMARY_FIRST + 13, "hit_texel" },
    { PRIMARY_FIRST + 14, "surf_of_receiver" },
    { PRIMARY_FIRST + 21, "receiver_sel" },
    { PRIMARY_FIRST + 22, "facade_cell" },
    { PRIMARY_FIRST + 23, "window_covers" },
};

static const int frame_integers[] = { 0,  3,  4,  5,  6,  7,  8,  9,  11, 17, 23,  25,  31,  37, 39,
                                      45, 51, 53, 59, 62, 64, 68, 80, 90, 96, 110, 121, 127, 133 };
static const int list_integers[] = { 2,  11, 12, 13, 14, 15, 20, 21,  35,  36,  53,  54,  56,  57, 58,
                                     61, 62, 67, 73, 74, 75, 89, 101, 107, 108, 109, 110, 113, 119 };

static bool holds_integers(int slot) {
    for (size_t i = 0; i < sizeof(frame_integers) / sizeof(frame_integers[0]); i++)
        if (slot == FRAME_FIRST + frame_integers[i])
            return true;
    for (size_t i = 0; i < sizeof(list_integers) / sizeof(list_integers[0]); i++)
        if (slot == LISTS_FIRST + list_integers[i])
            return true;
    return slot == 0 || slot == 4 || slot == 5 || slot == 71 || slot == 77 || slot == 83 || slot == 89 || slot == 103 ||
           slot == 126 || slot == 129 || slot == 134 || slot == 135 || slot == 170 || (slot >= 172 && slot <= 174) ||
           slot == 177 || slot == TEXTURES_FIRST + 7 || slot == TEXTURES_FIRST + 16 || slot == INFLUENCE_FIRST ||
           slot == PRESAMPLED_FIRST + 15 || slot == PRESAMPLED_FIRST + 16 || slot == PRESAMPLED_FIRST + 18 ||
           slot == PRESAMPLED_FIRST + 19 || slot == PRESAMPLED_FIRST + 21 || slot == INFLUENCE_FIRST + 2 ||
           slot == PRESAMPLED_FIRST + 28 || slot == PRESAMPLED_FIRST + 29 || slot == PRESAMPLED_FIRST + 31 ||
           slot == PRIMARY_FIRST + 7 || slot == PRIMARY_FIRST + 13 || slot >= PRIMARY_FIRST + 21 ||
           (slot >= INFLUENCE_FIRST + 4 && slot < LISTS_FIRST);
}

static const char *group_name(int slot) {
    const char *name = "";
    for (size_t i = 0; i < sizeof(groups) / sizeof(groups[0]) && groups[i].first <= slot; i++)
        name = groups[i].name;
    return name;
}

static float as_float(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof(f));
    return f;
}

/* The same bits; any NaN is as good as another, and devices may flush subnormal numbers to 0. */
static bool same(uint32_t a, uint32_t b, bool integer, bool flushes) {
    if (a == b)
        return true;
    if (integer)
        return false;
    float x = as_float(a), y = as_float(b);
    return (isnan(x) && isnan(y)) || (flushes && fabsf(x) < 1.2e-38f && fabsf(y) < 1.2e-38f);
}

static uint32_t *run(void (*kernel)(uint32_t *, uint32_t)) {
    uint32_t *out = calloc((size_t)ITEMS * ITEM_SLOTS, sizeof(*out));
    assert_non_null(out);
    kernel(out, ITEMS);
    return out;
}

/* What scalar C answers, for all tests. */
static uint32_t *scalar;

static int run_scalar(void **state) {
    (void)state;
    scalar = run(dialect_run_1);
    return 0;
}

static int free_scalar(void **state) {
    (void)state;
    free(scalar);
    return 0;
}

static void expect_same(const char *what, const uint32_t *have, const uint32_t *want, bool flushes) {
    size_t different = 0;
    for (int slot = 0; slot < ITEM_SLOTS; slot++) {
        size_t here = 0;
        for (size_t i = 0, at = (size_t)slot * ITEMS; i < ITEMS; i++, at++) {
            if (same(have[at], want[at], holds_integers(slot), flushes))
                continue;
            if (!here++)
                print_message("# %s: slot %d (%s), item %zu: %08x (%.9g), scalar C has %08x (%.9g)\n", what, slot,
                              group_name(slot), i, (unsigned)have[at], as_float(have[at]), (unsigned)want[at],
                              as_float(want[at]));
        }
        different += here;
    }
    print_message("# %s: %zu of %zu values differ from scalar C\n", what, different, (size_t)ITEMS * ITEM_SLOTS);
    assert_int_equal(different, 0);
}

/* The comparison would be worth nothing if the kernel answered the same everywhere. */
static void test_kernel_is_alive(void **state) {
    const uint32_t *out = scalar;
    for (int slot = 0; slot < ITEM_SLOTS; slot++) {
        size_t equal = 0, bad = 0;
        for (size_t i = 0, at = (size_t)slot * ITEMS; i < ITEMS; i++, at++) {
            equal += out[at] == out[(size_t)slot * ITEMS];
            bad += !holds_integers(slot) && !isfinite(as_float(out[at]));
        }
        /* 8: z of circle; the others: M */
        bool constant = slot == 8 || slot == 75 || slot == 81 || slot == 87 || slot == 93 || slot == 139 ||
                        slot == LISTS_FIRST + 6 || slot == LISTS_FIRST + 123 || slot == PRESAMPLED_FIRST + 25;
        if (!constant && equal == ITEMS)
            fail_msg("slot %d (%s) is constant", slot, group_name(slot));
        if (bad)
            fail_msg("slot %d (%s): %zu values are NaN or infinite", slot, group_name(slot), bad);
    }
}

static void compare_wide(const char *name, void (*kernel)(uint32_t *, uint32_t)) {
    uint32_t *have = run(kernel);
    expect_same(name, have, scalar, false);
    free(have);
}

static void test_4_lanes(void **state) { compare_wide("4 lanes", dialect_run_4); }

#if defined(HAVE_X86_WIDE)
static void test_8_lanes(void **state) {
    if (!__builtin_cpu_supports("avx2")) {
        print_message("# skipped: this machine has no AVX2\n");
        skip();
    }
    compare_wide("8 lanes", dialect_run_8);
}

static void test_16_lanes(void **state) {
    if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) {
        print_message("# skipped: this machine has no AVX-512\n");
        skip();
    }
    compare_wide("16 lanes", dialect_run_16);
}
#endif

#if defined(HAVE_VULKAN)
/* Devices that flush denormal numbers, which some of the kernel's scores are: relative 1e-3 for nearly all values;
 * where a choice tips over, the whole reservoir is another one. */
static void expect_close(const char *what, const uint32_t *have, const uint32_t *want) {
    size_t off = 0;
    for (int slot = 0; slot < ITEM_SLOTS; slot++)
        for (size_t i = 0, at = (size_t)slot * ITEMS; i < ITEMS; i++, at++) {
            float x = as_float(have[at]), y = as_float(want[at]);
            off += !same(have[at], want[at], holds_integers(slot), true) &&
                   (holds_integers(slot) || !(fabsf(x - y) <= 1e-3f * fabsf(y) + 1e-5f));
        }
    double share = (double)off / ((double)ITEMS * ITEM_SLOTS);
    print_message("# %s: %.3g of the values are off\n", what, share);
    assert_true(share < 1e-3);
}

#define PART(code)                                                                                                     \
    { #code, code, sizeof(code) }
static const struct {
    const char *name;
    const uint32_t *spirv;
    size_t bytes;
} parts[] = { PART(dialect_lights), PART(dialect_reservoirs), PART(dialect_frames),
              PART(dialect_draws),  PART(dialect_tile),       PART(dialect_tile_lists) };

/* Each writes its slots and keeps the others. */
static bool dialect_shader(vulkan_run *gpu, const uint32_t *spirv, size_t bytes, uint32_t *have) {
    uint32_t push = ITEMS;
    return vulkan_compute(gpu, spirv, bytes, &push, sizeof(push), (ITEMS + 63) / 64, have,
                          (size_t)ITEMS * ITEM_SLOTS * sizeof(*have));
}

static void test_glsl(void **state) {
    const uint32_t *want = scalar;
    uint32_t *have = calloc((size_t)ITEMS * ITEM_SLOTS, sizeof(*have));
    assert_non_null(have);
    vulkan_run gpu;
    uint32_t number = 0;
    for (; vulkan_open(&gpu, number); number++) {
        print_message("# %s%s\n", gpu.device, gpu.validated ? "" : " (without the validation layer)");
        size_t i = 0, count = sizeof(parts) / sizeof(*parts);
        while (i < count && dialect_shader(&gpu, parts[i].spirv, parts[i].bytes, have))
            i++;
        if (i < count)
            print_message("# %s: %s\n", parts[i].name, gpu.why);
        vulkan_close(&gpu);
        assert_true(i == count);
        assert_int_equal(gpu.messages, 0);
        if (gpu.software)
            expect_same(gpu.device, have, want, true);
        else
            expect_close(gpu.device, have, want);
    }
    free(have);
    if (!number) {
        print_message("# skipped: no Vulkan device: %s\n", gpu.why);
        skip();
    }
}
#else
static void test_glsl(void **state) {
    print_message("# skipped: built without Vulkan or without glslangValidator\n");
    skip();
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kernel_is_alive),
        cmocka_unit_test(test_4_lanes),
#if defined(HAVE_X86_WIDE)
        cmocka_unit_test(test_8_lanes),
        cmocka_unit_test(test_16_lanes),
#endif
        cmocka_unit_test(test_glsl),
    };
    return cmocka_run_group_tests_name("dialect", tests, run_scalar, free_scalar);
}
