/* core/list_sketch.h: what weighs a far light is near to what the light brings and 0 only where it brings nothing; and
 * rays over a list are divided by the very weight that chose them, near and far lights mixed. */
#include "given_list.h"
#include "core_test.h"

#include "base/base.h"

enum { ENTRIES = 24 };

#include "any_light.h"

/* Puts the light's middle so many radii away from the surface (m for a point), now and then where it is seen edge on.
 */
static void place_light(dice *d, light *l, surf s, double radii) {
    list_sketch k = sketch_of(*l);
    float r = k.radius > 0 ? k.radius : 1, away = r * (float)radii;
    v3 w = random_direction(d);
    if (uniform(d, 0, 1) < .3) {
        w = sub3(w, mul3(s.n, dot3(w, s.n) - (float)(uniform(d, -1.2, 2.5) / radii)));
        w = normalised(w);
    }
    l->p = add3(l->p, sub3(add3(s.p, mul3(w, away)), k.middle));
}

/* ---- near to the target ---- */

typedef struct ratios {
    double most; /* of the target at any place over the sketch */
    mean mean;   /* of the mean target over the sketch, of lights that are wholly before the surface */
    int near, missed, far, beyond; /* beyond: four times the sketch somewhere */
} ratios;

static ratios look_at_lights(bool glossy, const u32 *kinds, int count, bool profile) {
    enum { TRIALS = 30000, STEPS = 6 };
    const struct core_context none = { 0 }, *ctx = &none;
    dice d = { 5 };
    ratios r = { 0 };
    for (int i = 0; i < TRIALS; i++) {
        surf s = any_surface(&d, glossy);
        sketch_surf q = sketch_surf_of(s);
        light l = any_light(&d, kinds[i % count], profile);
        place_light(&d, &l, s, (double)sqrtf(q.reach) * uniform(&d, .98, 1.1) * (i % 3 ? 1 : 8));
        list_sketch k = sketch_of(l);
        float d2 = sketch_distance2(k, s.p), most = 0;
        double sum = 0;
        if (sketch_near(s, q, k, d2, 0)) {
            r.near++;
            continue;
        }
        for (int j = 0; j < STEPS * STEPS; j++) {
            float p = target(PASS s, l, ((float)(j % STEPS) + .5f) / STEPS, ((float)(j / STEPS) + .5f) / STEPS);
            most = max_(most, p);
            sum += (double)p / (STEPS * STEPS);
        }
        float about = sketch_target(PASS s, q, k, d2, 0, 0);
        r.missed += most > 0 && !(about > 0);
        if (!(about > 0))
            continue;
        r.far++;
        r.most = fmax(r.most, (double)(most / about));
        r.beyond += most > 4 * about;
        if (dot3(s.n, sub3(k.middle, s.p)) > k.radius)
            mean_add(&r.mean, sum / (double)about);
    }
    print_message("# %d near, %d far, %d missed; target over sketch: %.3f +- %.3f, at most %.2f, beyond 4: %d\n",
                  r.near, r.far, r.missed, mean_of(&r.mean), mean_error(&r.mean) * sqrt(r.mean.n), r.most, r.beyond);
    return r;
}

static const u32 extended[] = { LIGHT_DISC, LIGHT_TRIANGLE, LIGHT_PARALLELOGRAM, LIGHT_SPHERE };

static void matte_surfaces(void **state) {
    (void)state;
    ratios r = look_at_lights(false, extended, 4, false);
    assert_true(r.near > 1000 && r.far > 5000);
    assert_int_equal(r.missed, 0);
    assert_true(fabs(mean_of(&r.mean) - 1) < .03 && r.most < 4);
}

/* A narrow lobe at a grazing angle is narrower still beside its plane. */
static void glossy_surfaces(void **state) {
    (void)state;
    ratios r = look_at_lights(true, extended, 4, false);
    assert_true(r.near > 1000 && r.far > 5000);
    assert_int_equal(r.missed, 0);
    assert_true(fabs(mean_of(&r.mean) - 1) < .1 && r.beyond < r.far / 300);
}

/* Points are never near, and have no size that their places could differ by. */
static void points(void **state) {
    const u32 point = LIGHT_POINT;
    (void)state;
    ratios r = look_at_lights(false, &point, 1, false);
    assert_true(r.near == 0 && r.missed == 0 && r.most < 1.02 && fabs(mean_of(&r.mean) - 1) < .01);
    r = look_at_lights(true, &point, 1, false);
    assert_true(r.near == 0 && r.missed == 0 && r.most < 2);
}

/* A spot's cone, and what a profile sends which way. */
static void beams(void **state) {
    static const u32 spot = LIGHT_SPOT, shaped[] = { LIGHT_POINT, LIGHT_DISC, LIGHT_SPHERE };
    (void)state;
    for (int glossy = 0; glossy < 2; glossy++) {
        ratios r = look_at_lights(glossy, &spot, 1, false);
        assert_true(r.near == 0 && r.missed == 0 && r.most < (glossy ? 2 : 1.2));
        r = look_at_lights(glossy, shaped, 3, true);
        assert_true(r.far > 5000 && r.missed == 0 && r.beyond < r.far / 200);
        assert_true(glossy || (r.most < 4 && fabs(mean_of(&r.mean) - 1) < .1));
    }
}

static void inverse_roots(void **state) {
    double most = 0;
    (void)state;
    for (double x = 1e-37; x < 1e37; x *= 1.01)
        most = fmax(most, fabs((double)quick_inverse_root((float)x) * sqrt((double)(float)x) - 1));
    print_message("# off by %.5f at most\n", most);
    assert_true(most < .002);
}

/* ---- what chose it divides it ---- */

/* Near lights, far ones, some at the border of both, spots and profiles; a third of them are hidden. */
static void make_list(struct core_context *ctx, dice *d, surf s) {
    sketch_surf q = sketch_surf_of(s);
    ctx->count = ENTRIES;
    for (u32 i = 0; i < ENTRIES; i++) {
        light *l = &ctx->light[i];
        double radii = i % 4 == 0 ? uniform(d, 0.6, 1.8) : i % 4 == 1 ? 2 : i % 4 == 2 ? (double)sqrtf(q.reach) : 60;
        *l = any_light(d, i % 6, i % 7 == 3);
        place_light(d, l, s, radii);
        if (dot3(s.n, sub3(sketch_of(*l).middle, s.p)) < 0)
            l->p = add3(l->p, mul3(s.n, -2 * dot3(s.n, sub3(sketch_of(*l).middle, s.p))));
        l->e = mul3(l->e, (float)(radii * radii)); /* so that each matters */
        ctx->weight[i] = 1 + .5f * (float)(i % 3);
        ctx->visibility[i] = .25f * (float)(i % 5);
    }
    list_sketches(PASS ENTRIES);
}

/* A block of pixels `wide` metres apart that turn by so much from one to the next, with s in its middle. */
static void make_block(struct core_context *ctx, surf s, float wide, float turn) {
    v3 across = normalised(fabsf(s.n.x) < .7f ? cross3(s.n, V3(1, 0, 0)) : cross3(s.n, V3(0, 1, 0)));
    v3 along = cross3(s.n, across), eye = add3(s.p, mul3(s.wo, 400 * max_(wide, .001f)));
    for (int i = 0; i < 16; i++) {
        float x = (float)(i % 4) - 1.5f, y = (float)(i / 4) - 1.5f;
        v3 p = add3(s.p, add3(mul3(across, wide * x), mul3(along, wide * y)));
        v3 n = normalised(add3(s.n, mul3(across, turn * x))), wo = normalised(sub3(eye, p));
        ctx->pixel[i] = (face_pixel){ { p.x, p.y, p.z },
                                      { n.x, n.y, n.z },
                                      { wo.x, wo.y, wo.z },
                                      { s.albedo.x * (i & 1 ? 1 : .1f), s.albedo.y, s.albedo.z },
                                      s.f0,
                                      s.alpha,
                                      400 * max_(wide, .001f) };
    }
}

/* Deviations of the mean over all starts of the draws from the sum over the entries, as shares of it: with the weights
 * of list_ask, and with what they would be if the target were what divides. Of all pixels of a block. */
static void mean_over_starts(bool glossy, float wide, float turn, double *off, double *off_by_targets) {
    enum { STARTS = 2000 };
    static struct core_context context;
    struct core_context *ctx = &context;
    dice d = { 31 };
    double far = 0, near = 0, faces = 0;
    *off = *off_by_targets = 0;
    for (int trial = 0; trial < 10; trial++) {
        surf s = any_surface(&d, glossy);
        u1 rows = list_rows(ENTRIES);
        make_list(ctx, &d, s);
        make_block(ctx, s, wide, turn);
        u1 entries = weigh_faces(PASS 0xffff, rows), seen = 0;
        near += entries;
        far += ENTRIES - entries;
        for (u1 face = 0; seen != 0xffff; face++) {
            assert_true(ctx->pixels[face] && !(seen & ctx->pixels[face]));
            seen |= ctx->pixels[face];
            faces++;
            for (u1 left = ctx->pixels[face]; left; left &= left - 1) {
                u32 key = (u32)roll(&d);
                double want = 0, have = 0, other = 0;
                ctx->place = low_bit(left);
                s = face_pixels_load(PASS(int) ctx->place).s;
                list_sums sums = given_sums(PASS s, key, face, entries);
                u32 u = rng_bits(key, DIM_LIST_PLACE), v = rng_bits(key, DIM_LIST_PLACE + 1);
                for (u32 i = 0; i < ENTRIES; i++)
                    want +=
                        i % 3
                            ? (double)(target(PASS s, ctx->light[i], list_u(u, i), list_v(v, i)) * entry_weight(PASS i))
                            : 0;
                for (int k = 0; k < STARTS; k++) {
                    ctx->rays = 0;
                    list_share_out(PASS sums.all, entries, face, rows, 5, ((float)k + .5f) / STARTS);
                    for (u32 i = 0; i < ctx->rays; i++) {
                        list_drawn *one = &ctx->drawn[i];
                        list_ray r = list_ask(PASS s, sums, 5, key, *one, ctx->light[one->entry]);
                        double brings = one->entry % 3 ? (double)(r.p * r.w) / STARTS : 0;
                        float prior = list_prior_of(ctx->weight[one->entry], ctx->visibility[one->entry]).share;
                        have += brings;
                        if (r.p > 0)
                            other += brings * (double)(one->weighed / (r.p * prior));
                    }
                }
                *off = fmax(*off, fabs(have / want - 1));
                *off_by_targets = fmax(*off_by_targets, fabs(other / want - 1));
            }
        }
    }
    print_message("# %.1f faces, %.1f near, %.1f far: off by %.5f at most; if targets divided, by %.3f\n", faces / 10,
                  near / 10, far / 10, *off, *off_by_targets);
    assert_true(near > 50 && far > 30);
}

static void chosen_by_what_divides(void **state) {
    static const float blocks[][2] = { { 0, 0 }, { .02f, 0 }, { .1f, .01f }, { .02f, .2f } };
    (void)state;
    for (int i = 0; i < 8; i++) {
        double off, off_by_targets;
        mean_over_starts(i & 1, blocks[i / 2][0], blocks[i / 2][1], &off, &off_by_targets);
        assert_true(off < .008);
        assert_true(off_by_targets > .02);
    }
}

/* What a face weighs as 0 no pixel of it sees, wherever it looks on the light. */
static void none_missed(void **state) {
    enum { STEPS = 5 };
    static struct core_context context;
    struct core_context *ctx = &context;
    dice d = { 8 };
    size_t none = 0, asked = 0;
    (void)state;
    for (int trial = 0; trial < 3000; trial++) {
        surf s = any_surface(&d, trial & 1);
        double wide = uniform(&d, 0, .3);
        ctx->count = ENTRIES;
        for (u32 i = 0; i < ENTRIES; i++) {
            ctx->light[i] = any_light(&d, i % 6, i % 4 == 3);
            ctx->weight[i] = 1;
            place_light(&d, &ctx->light[i], s, uniform(&d, 2, 8));
            if (i % 2) { /* beside the plane of the light */
                list_sketch k = sketch_of(ctx->light[i]);
                float beside = dot3(k.normal, sub3(k.middle, s.p)) / max_(dot3(k.normal, k.normal), 1e-6f);
                ctx->light[i].p = sub3(ctx->light[i].p, mul3(k.normal, beside + (float)uniform(&d, -wide, wide)));
            }
        }
        list_sketches(PASS ENTRIES);
        make_block(ctx, s, (float)wide, (float)uniform(&d, 0, .02));
        weigh_faces(PASS 0xffff, list_rows(ENTRIES));
        for (u1 face = 0, seen = 0; seen != 0xffff; seen |= ctx->pixels[face++])
            for (u1 at = 0; at < 16 * list_rows(ENTRIES); at++) {
                u1 entry = given_entry(PASS at), row = at / 16, column = at % 16;
                bool near = near_bits_load(PASS face, row) >> column & 1;
                if (near || entry >= ENTRIES || ctx->far[face][row + 1][column] > ctx->far[face][row][column])
                    continue;
                none++;
                for (u1 left = ctx->pixels[face]; left; left &= left - 1)
                    for (int j = 0; j < STEPS * STEPS; j++, asked++)
                        assert_true(target(PASS face_pixels_load(PASS(int) low_bit(left)).s, ctx->light[entry],
                                           ((float)(j % STEPS) + .5f) / STEPS,
                                           ((float)(j / STEPS) + .5f) / STEPS) == 0);
            }
    }
    print_message("# %zu entries that weigh nothing, %zu places\n", none, asked);
    assert_true(none > 1000);
}

/* One wall is one face; a wall and what stands in front of it are two; of a mirror each pixel sees something else. */
static void faces_of_blocks(void **state) {
    static struct core_context context;
    struct core_context *ctx = &context;
    dice d = { 3 };
    surf s = any_surface(&d, false);
    (void)state;
    make_block(ctx, s, .02f, 0);
    assert_int_equal(face_of(PASS 0xffff).pixels, 0xffff);
    assert_int_equal(face_of(PASS 0x0ff1).pixels, 0x0ff1);
    for (int i = 0; i < 16; i += 2)
        ctx->pixel[i].depth *= 1.2f;
    assert_int_equal(face_of(PASS 0xffff).pixels, 0xaaaa);
    assert_int_equal(face_of(PASS 0x5555).pixels, 0x5555);
    s.f0 = .04f;
    s.alpha = .001f;
    make_block(ctx, s, .02f, 0);
    assert_int_equal(bit_count(face_of(PASS 0xffff).pixels), 1);
    make_block(ctx, s, .0f, 0);
    assert_int_equal(face_of(PASS 0xffff).pixels, 0xffff);
    ctx->pixel[3].alpha = .5f;
    assert_int_equal(face_of(PASS 0xffff).pixels, 0xfff7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matte_surfaces), cmocka_unit_test(glossy_surfaces), cmocka_unit_test(points),
        cmocka_unit_test(beams),          cmocka_unit_test(inverse_roots),   cmocka_unit_test(chosen_by_what_divides),
        cmocka_unit_test(none_missed),    cmocka_unit_test(faces_of_blocks),
    };
    return cmocka_run_group_tests_name("core/list_sketch", tests, NULL, NULL);
}
