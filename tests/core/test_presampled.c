/* core/presampled.h: candidates that blocks of pixels share. What chooses is near to the target, and 0 only where the
 * target is; each sample of a subset is as probable as the other for each pixel; and what is chosen is divided by the
 * very weight that chose it, near and far lights of all kinds mixed. */
#include "no_rays.h"
#include "core_test.h"

#include "core/presampled.h"

#include "base/base.h"

enum { M = 12 };

struct core_context {
    light light[M]; /* of candidate i */
    uint32_t place[M];
    float inverse[M], weighed[M];
};

#define MINE ((struct core_context *)(uintptr_t)ctx)
/* Light 0 is drawn three times in four, light 1 once, light 2 never. */
FN alias_slot alias_load(CTX u32 i) {
    (void)ctx;
    return (alias_slot){ i == 0 ? 1 : i == 1 ? 0.75f : 0, 0, i == 0 ? 4 / 3.f : i == 1 ? 4 : 0, 4 / 3.f };
}
FN light light_load(CTX u32 i) { return ctx->light[i]; }
FN presample_pick presample_pick_load(CTX u32 i) { return (presample_pick){ i, ctx->place[i], ctx->inverse[i] }; }
FN presample presample_load(CTX int i) {
    return presample_of(ctx->light[i], unit_low(ctx->place[i]), unit_high(ctx->place[i]));
}
FN real presample_inverse(CTX int i) { return ctx->inverse[i]; }
FN void weighed_store(CTX int i, real sum) { MINE->weighed[i] = sum; }
FN real weighed_load(CTX int i) { return ctx->weighed[i]; }
FN real weighed_at(CTX u32 i) { return ctx->weighed[i]; }
FN pick pick_load(CTX int i) { return (pick){ (u32)i, ctx->inverse[i] }; }
#include "any_light.h"

/* Puts the light so many radii (m for a point) away, now and then where it crosses the horizon. */
static void place_light(dice *d, light *l, surf s, double radii) {
    float away = (l->radius > 0 ? l->radius : 1) * (float)radii;
    v3 w = random_direction(d);
    if (uniform(d, 0, 1) < .3)
        w = normalised(sub3(w, mul3(s.n, dot3(w, s.n) - (float)(uniform(d, -1.2, 2.5) / radii))));
    l->p = add3(s.p, mul3(w, away));
}

/* ---- near to the target ---- */

typedef struct ratios {
    double least, most; /* of what chooses over the target */
    int near, far, missed, beyond;
} ratios;

/* At the border of near and far, and beyond it. */
static ratios look_at(bool glossy, u32 kind, bool profile) {
    enum { TRIALS = 40000 };
    const struct core_context none = { 0 }, *ctx = &none;
    dice d = { 5 };
    ratios r = { .least = 1e30 };
    for (int i = 0; i < TRIALS; i++) {
        surf s = any_surface(&d, glossy);
        sketch_surf q = sketch_surf_of(s);
        light l = any_light(&d, kind, profile);
        double border = kind == LIGHT_SPHERE ? (double)sqrtf(q.reach) : 2;
        place_light(&d, &l, s, border * uniform(&d, .6, 1.6) * (i % 3 ? 1 : 9));
        float u = (float)uniform(&d, 0, 1), v = (float)uniform(&d, 0, 1), p = target(PASS s, l, u, v);
        presample_steer about = presample_look(s, q, presample_of(l, u, v));
        if (about.near) {
            r.near++;
            continue;
        }
        r.missed += p > 0 && !(about.p > 0);
        if (!(p > 0) || !(about.p > 0))
            continue;
        double ratio = (double)(about.p / p);
        r.far++;
        r.least = fmin(r.least, ratio);
        r.most = fmax(r.most, ratio);
        r.beyond += ratio < .5 || ratio > 2;
    }
    print_message("# kind %u%s: %d near, %d far, %d missed; %.4f to %.4f of the target, %d beyond twice\n", kind,
                  glossy ? ", glossy" : "", r.near, r.far, r.missed, r.least, r.most, r.beyond);
    return r;
}

/* Flat lights and points are asked for at their own places: the same but for the root. */
static void places(void **state) {
    (void)state;
    for (u32 kind = LIGHT_DISC; kind <= LIGHT_POINT; kind++) {
        ratios r = look_at(false, kind, false);
        assert_true(r.far > 5000 && (kind == LIGHT_POINT || r.near > 1000));
        /* what is seen edge on may be on the other side by a rounding */
        assert_true(r.missed <= 1 && r.least > .98 && r.most < 1.02);
        r = look_at(true, kind, false);
        assert_true(r.missed <= 1 && r.least > .5 && r.most < 1.02);
    }
}

static void spheres(void **state) {
    (void)state;
    ratios r = look_at(false, LIGHT_SPHERE, false);
    assert_true(r.near > 1000 && r.far > 5000 && r.missed == 0 && r.beyond < r.far / 50);
    r = look_at(true, LIGHT_SPHERE, false);
    assert_true(r.missed == 0 && r.beyond < r.far / 20);
}

static void beams_are_always_asked(void **state) {
    (void)state;
    assert_int_equal(look_at(false, LIGHT_SPOT, false).far, 0);
    assert_int_equal(look_at(false, LIGHT_DISC, true).far, 0);
    assert_int_equal(look_at(false, LIGHT_SPHERE, true).far, 0);
    assert_int_equal(look_at(false, LIGHT_POINT, true).far, 0);
}

/* ---- what chose it divides it ---- */

/* Deviation of the mean over all choices from the candidates' mean of f / pmf, f red light; and what it were if the
 * target divided, though it did not choose. */
static void mean_over_choices(bool glossy, double *off, double *off_by_targets) {
    enum { CHOICES = 6000 };
    static struct core_context context;
    struct core_context *ctx = &context;
    dice d = { 31 };
    *off = *off_by_targets = 0;
    for (int trial = 0; trial < 40; trial++) {
        surf s = any_surface(&d, glossy);
        double want = 0, have = 0, other = 0, sum = 0;
        for (u32 i = 0; i < M; i++) {
            double radii = i % 3 == 0 ? uniform(&d, .5, 2) : i % 3 == 1 ? uniform(&d, 1.9, 2.1) : 40;
            light *l = &ctx->light[i];
            *l = any_light(&d, i % 6, i >= 6);
            place_light(&d, l, s, radii);
            if (dot3(s.n, sub3(l->p, s.p)) < 0)
                l->p = add3(l->p, mul3(s.n, -2 * dot3(s.n, sub3(l->p, s.p))));
            l->e = mul3(l->e, (float)(radii * radii)); /* so that each matters */
            ctx->place[i] = (uint32_t)roll(&d);
            ctx->inverse[i] = (float)uniform(&d, .3, 3);
            v3 f = reflected(s, shining_sample(PASS * l, s.p, unit_low(ctx->place[i]), unit_high(ctx->place[i])));
            want += (double)(f.x * ctx->inverse[i]) / M;
        }
        for (int k = 0; k < CHOICES; k++) {
            reservoir r = ris_presampled(PASS s, ((float)k + .5f) / CHOICES, M);
            reservoir again = ris_presampled_twice(PASS s, ((float)k + .5f) / CHOICES, M);
            assert_memory_equal(&r, &again, sizeof(r));
            assert_true(r.m == M);
            if (!(r.w > 0))
                continue;
            double f = (double)reflected(s, shining_sample(PASS ctx->light[r.light], s.p, r.u, r.v)).x;
            sum = (double)ctx->weighed[M - 1];
            have += f * (double)r.w / CHOICES;
            other += f * sum / (M * (double)r.p) / CHOICES;
        }
        if (!(want > 0))
            continue;
        *off = fmax(*off, fabs(have / want - 1));
        *off_by_targets = fmax(*off_by_targets, fabs(other / want - 1));
    }
    print_message("# off by %.5f at most; if targets divided, by %.4f\n", *off, *off_by_targets);
}

static void chosen_by_what_divides(void **state) {
    (void)state;
    double off, by_targets;
    mean_over_choices(false, &off, &by_targets);
    assert_true(off < .002);
    mean_over_choices(true, &off, &by_targets);
    assert_true(off < .002 && by_targets > .004);
}

/* ---- which samples ---- */

/* A pixel's candidate i is any of the subset's samples 16 i to 16 i + 15 alike, and the bits that choose a light are
 * even over all numbers. */
static void samples_are_alike(void **state) {
    (void)state;
    assert_true(presample_subsets(32, 1000000) == PRESAMPLES / 512 && presample_subsets(1, 8000) == 1000);
    assert_true(presample_subsets(1024, 1000000) == PRESAMPLES / 16384 && presample_subsets(1, 80) == 128);
    double met[16] = { 0 }, chi2 = 0;
    for (u1 subset = 0; subset < 16000; subset++) {
        u1 key = presample_key(3, subset, 1, 0), seen = 0;
        met[presample_turned(key, 5)]++;
        for (u1 i = 32; i < 48; i++) {
            assert_true(presample_turned(key, i) >= 32 && presample_turned(key, i) < 48);
            seen |= 1u << (presample_turned(key, i) - 32);
            assert_true(presample_at(key, 2, presample_turned(key, i) & 15) == i);
        }
        assert_true(seen == 0xffff);
    }
    for (int l = 0; l < 16; l++)
        chi2 += (met[l] - 1000) * (met[l] - 1000) / 1000;
    assert_true(chi2 < 15 + 5 * sqrt(30));
    enum { TILES = 20000, BINS = 64, N = 512 };
    for (u32 i = 0; i < N; i += 511) {
        double bins[BINS] = { 0 }, off = 0;
        for (u1 tile = 0; tile < TILES; tile++)
            bins[presample_bits(presample_key(9, tile, 4, 0), i, presample_share(N)) >> 26]++;
        for (int k = 0; k < BINS; k++)
            off += (bins[k] - (double)TILES / BINS) * (bins[k] - (double)TILES / BINS) / ((double)TILES / BINS);
        assert_true(off < BINS - 1 + 5 * sqrt(2.0 * (BINS - 1)));
    }
}

/* Samples are drawn as often as their inverses say, none of a table that is empty. */
static void draws_follow_their_probabilities(void **state) {
    const struct core_context *ctx = NULL;
    (void)state;
    enum { SUBSETS = 500, N = 80, LIGHTS = 3 };
    double even[LIGHTS] = { 0 }, power[LIGHTS] = { 0 };
    for (u1 subset = 0; subset < SUBSETS; subset++)
        for (u32 i = 0; i < N; i++) {
            u1 key = presample_key(5, subset, 2, 0);
            presample_pick a = presample_draw(key, i, N, LIGHTS), b = presample_draw_power(ctx, key, i, N, LIGHTS);
            even[a.light] += (double)a.inverse / LIGHTS;
            power[b.light] += (double)b.inverse * (b.light ? 0.25 : 0.75);
            assert_true(a.place == b.place && a.inverse == LIGHTS);
            assert_true(presample_draw_power(ctx, key, i, N, 0).inverse == 0);
        }
    /* stratified, so better than a binomial's */
    for (int l = 0; l < LIGHTS; l++)
        assert_true(fabs(even[l] / (SUBSETS * N) - 1 / 3.) < 0.01);
    assert_true(fabs(power[0] / (SUBSETS * N) - 0.75) < 0.01 && fabs(power[1] / (SUBSETS * N) - 0.25) < 0.01);
    assert_true(power[2] == 0);
}

/* Each rank is one sample's; plain ones come first, in their order. */
static void plain_samples_come_first(void **state) {
    (void)state;
    dice d = { 8 };
    for (int trial = 0; trial < 200; trial++) {
        enum { N = 96 };
        bool plain[N];
        u1 all = 0, before = 0, plain_rank = 0, late_rank = 0;
        for (int i = 0; i < N; i++)
            all += plain[i] = trial > 1 ? uniform(&d, 0, 1) < 0.7 : trial;
        for (u32 i = 0; i < N; i++) {
            u32 rank = presample_rank(plain[i], i, before, all);
            assert_int_equal(rank, plain[i] ? plain_rank++ : all + late_rank++);
            before += plain[i];
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places),
        cmocka_unit_test(spheres),
        cmocka_unit_test(beams_are_always_asked),
        cmocka_unit_test(chosen_by_what_divides),
        cmocka_unit_test(samples_are_alike),
        cmocka_unit_test(draws_follow_their_probabilities),
        cmocka_unit_test(plain_samples_come_first),
    };
    return cmocka_run_group_tests_name("core/presampled", tests, NULL, NULL);
}
