/* core/reservoir.h and core/reuse.h: resampling is unbiased where docs/estimator.md says so, and the tests can tell. */
#include "core_test.h"
#include "core/light.h"
#include "no_profiles.h"

enum { LIGHTS = 40 };
struct core_context {
    light lights[LIGHTS];
};
FN light light_load(CTX u32 i) { return ctx->lights[i]; }

#include "core/reuse.h"
#include "ris_uniform.h"

/* ---- candidates: a street's worth of lights of all kinds over a glossy surface ---- */

static void make_lights(struct core_context *ctx) {
    dice d = { 21 };
    for (int i = 0; i < LIGHTS; i++) {
        v3 p = add3(random_in_box(&d, 4), V3(0, 0, 4.5f));
        light *l = &ctx->lights[i];
        *l = (light){
            .p = p, .kind = (uint32_t)i % (LIGHT_SPOT + 1), .radius = 0.3f, .e = { (float)uniform(&d, 5, 300), 20, 40 }
        };
        if (l->kind == LIGHT_POINT)
            continue;
        v3 a = random_direction(&d);
        l->a = mul3(a, 0.5f);
        l->b = mul3(normalised(cross3(a, random_direction(&d))), 0.5f);
        if (cross3(l->a, l->b).z > 0)
            l->b = mul3(l->b, -1); /* faces down */
    }
}

static surf make_surface(void) {
    return (surf){ .p = { 0.3f, -0.2f, 0 },
                   .n = { 0, 0, 1 },
                   .wo = normalised(V3(0.6f, 0.1f, 0.5f)),
                   .albedo = { .3f, .5f, .2f },
                   .f0 = 0.05f,
                   .alpha = 0.2f };
}

/* What is estimated is red light, while the target is luminance: W must be right for every function, not for the
 * target. */
static double red(const struct core_context *ctx, surf s, reservoir r) {
    return r.w > 0 ? reflected(s, sample_light(ctx->lights[r.light], s.p, r.u, r.v)).x * (double)r.w : 0;
}

static double exhaustive_red(const struct core_context *ctx, surf s) {
    enum { SIDE = 400 };
    double sum = 0;
    for (int k = 0; k < LIGHTS; k++)
        for (int i = 0; i < SIDE; i++)
            for (int j = 0; j < SIDE; j++)
                sum += reflected(s, sample_light(ctx->lights[k], s.p, (i + 0.5f) / SIDE, (j + 0.5f) / SIDE)).x;
    return sum / (SIDE * SIDE);
}

/* RIS with lights picked in proportion to `weight`, told that their probability was pmf. */
static reservoir ris_from(const struct core_context *ctx, surf s, dice *d, const double *weight, const double *pmf,
                          int m) {
    reservoir_builder st = builder_empty();
    for (int i = 0; i < m; i++) {
        double x = uniform(d, 0, 1);
        uint32_t id = 0;
        while (id < LIGHTS - 1 && x >= weight[id])
            x -= weight[id++];
        float u = (float)uniform(d, 0, 1), v = (float)uniform(d, 0, 1), p = target(ctx, s, ctx->lights[id], u, v);
        st = builder_add(st, id, u, v, p, p / (float)pmf[id], 1, 0, (float)uniform(d, 0, 0.99999994));
    }
    return builder_end(st, 1.0f / (float)m);
}

static void test_ris_is_unbiased(void **state) {
    struct core_context ctx;
    make_lights(&ctx);
    surf s = make_surface();
    double truth = exhaustive_red(&ctx, s);
    static const int sizes[] = { 1, 4, 32 };
    for (int k = 0; k < 3; k++) {
        mean m = { 0 };
        for (uint32_t i = 0; i < 200000; i++)
            mean_add(&m, red(&ctx, s, ris_uniform(&ctx, s, rng_key(3, i, 1), LIGHTS, sizes[k])));
        print_message("# M = %d: %.5g +- %.2g, exhaustive %.5g\n", sizes[k], mean_of(&m), mean_error(&m), truth);
        assert_true(mean_off(&m, truth) < 4);
    }
    /* any pmf is as good, as long as it is the one that was drawn from */
    double uneven[LIGHTS], even[LIGHTS], sum = 0;
    for (int i = 0; i < LIGHTS; i++)
        sum += uneven[i] = 1 + i % 7;
    for (int i = 0; i < LIGHTS; i++) {
        uneven[i] /= sum;
        even[i] = 1.0 / LIGHTS;
    }
    mean right = { 0 }, wrong = { 0 };
    dice d = { 22 };
    for (int i = 0; i < 200000; i++) {
        mean_add(&right, red(&ctx, s, ris_from(&ctx, s, &d, uneven, uneven, 8)));
        mean_add(&wrong, red(&ctx, s, ris_from(&ctx, s, &d, uneven, even, 8)));
    }
    assert_true(mean_off(&right, truth) < 4);
    print_message("# a wrong pmf is off by %.0f standard errors\n", mean_off(&wrong, truth));
    assert_true(mean_off(&wrong, truth) > 8); /* the test can fail */
}

static void test_ris_of_one_light_and_of_none_that_shines(void **state) {
    struct core_context ctx;
    make_lights(&ctx);
    surf s = make_surface();
    ctx.lights[0] = (light){ .p = { 0, 0, 2 }, .kind = LIGHT_POINT, .e = { 100, 100, 100 } };
    for (uint32_t i = 0; i < 1000; i++) {
        reservoir r = ris_uniform(&ctx, s, rng_key(1, i, 0), 1, 4);
        assert_true(r.light == 0 && r.m == 4);
        assert_close(r.w, 1, 1e-5);
    }
    s.n = V3(0, 0, -1); /* turned away from all of them */
    s.p.z = -10;
    s.wo.z = -s.wo.z;
    reservoir r = ris_uniform(&ctx, s, rng_key(1, 1, 0), LIGHTS, 32);
    assert_true(r.w == 0 && r.m == 32);
}

/* Samples are held in proportion to their weights; those of weight 0 never. */
static void test_stream_is_proportional(void **state) {
    static const float weights[] = { 0, 1, 2, 0, 4, 0.5f, 0 };
    uint32_t held[7] = { 0 };
    dice d = { 23 };
    enum { N = 300000 };
    for (int i = 0; i < N; i++) {
        reservoir_builder st = builder_empty();
        for (uint32_t k = 0; k < 7; k++)
            st = builder_add(st, k, 0, 0, 1, weights[k], 2, (float)k,
                             k == 1 && i % 2 ? 0 : (float)uniform(&d, 0, 0.99999994));
        assert_true(st.m == 14 && st.w_sum == 7.5f && st.tag == (float)st.light);
        held[st.light]++;
    }
    for (int k = 0; k < 7; k++) {
        double p = weights[k] / 7.5, error = sqrt(p * (1 - p) / N);
        assert_true(fabs((double)held[k] / N - p) <= 4 * error);
    }
}

/* Weights that are no numbers leave an empty reservoir, never a NaN. */
static void test_nothing_odd_comes_out(void **state) {
    static const float odd[] = { NAN, INFINITY, 0, 1e30f, 1, 1e-40f };
    for (int i = 0; i < 6 * 6 * 6; i++) {
        reservoir_builder st = builder_add(builder_empty(), 1, 0, 0, odd[i % 6], odd[i / 6 % 6], 1, 0, 0.5f);
        reservoir r = builder_end(st, odd[i / 36]);
        assert_true(r.w >= 0 && r.w < 1.1e30f);
    }
    assert_true(builder_end(builder_empty(), 1).w == 0 && reservoir_empty().w == 0);
    assert_true(pair_share(0, 0, 0, 0) == 0 && pair_share(5, 0, 3, 0) == 0 && pair_share(0, 1, 3, 1) == 0);
    assert_true(mis_scale(0, 0) == 0);
}

/* ---- reuse: a world of few samples and few pixels, where the truth is a sum ---- */

enum { SAMPLES = 6, PIXELS = 4 };
typedef struct toy {
    float p[PIXELS][SAMPLES]; /* targets; pixel 0 is where the reservoirs are combined */
    bool seen[PIXELS][SAMPLES];
    double f[SAMPLES]; /* what is estimated, at pixel 0 */
    int m[PIXELS];     /* candidates of each */
} toy;

/* Neighbours that cannot make samples pixel 0 needs, and others that like them too much. */
static const toy plain = {
    .p = { { 1, 2, 3, 0.5f, 0, 1 }, { 0, 0, 5, 4, 2, 1 }, { 3, 0.1f, 0, 0, 1, 0 }, { 1, 1, 1, 1, 1, 1 } },
    .seen = { { 1, 1, 1, 1, 1, 1 }, { 1, 1, 1, 1, 1, 1 }, { 1, 1, 1, 1, 1, 1 }, { 1, 1, 1, 1, 1, 1 } },
    .f = { 2, 1, 3, 1, 0, 0.5 },
    .m = { 2, 3, 1, 5 },
};
static const toy shadowed = {
    .p = { { 1, 2, 3, 0.5f, 0, 1 }, { 2, 1, 5, 4, 2, 1 }, { 3, 0.5f, 1, 2, 1, 1 }, { 1, 1, 1, 1, 1, 1 } },
    .seen = { { 1, 1, 1, 1, 1, 1 }, { 0, 1, 0, 1, 1, 1 }, { 1, 0, 0, 1, 0, 1 }, { 0, 1, 0, 0, 1, 1 } },
    .f = { 2, 1, 3, 1, 0, 0.5 },
    .m = { 2, 3, 1, 5 },
};

static double truth_of(const toy *t) {
    double sum = 0;
    for (int i = 0; i < SAMPLES; i++)
        sum += t->f[i];
    return sum;
}

/* One pixel's own reservoir: uniform candidates, then its visibility ray. */
static reservoir initial(const toy *t, int pixel, dice *d) {
    reservoir_builder st = builder_empty();
    for (int i = 0; i < t->m[pixel]; i++) {
        uint32_t id = (uint32_t)(roll(d) % SAMPLES);
        st = builder_add(st, id, 0, 0, t->p[pixel][id], t->p[pixel][id] * SAMPLES, 1, 0,
                         (float)uniform(d, 0, 0.99999994));
    }
    reservoir r = builder_end(st, 1.0f / (float)t->m[pixel]);
    if (!t->seen[pixel][r.light])
        r.w = 0;
    return r;
}

typedef enum mode { BIASED, MIS, PAIRWISE, CARELESS, COUNTED } mode;

/* Target of x at a pixel as the combination knows it: with visibility there where bias rays are on. */
static float target_at(const toy *t, int pixel, uint32_t x, bool rays) {
    return rays && !t->seen[pixel][x] ? 0 : t->p[pixel][x];
}

/* Combination of r[0] (canonical) with the others at pixel 0. CARELESS counts only the neighbours that brought
 * something. */
static reservoir combine(const toy *t, const reservoir *r, mode how, bool rays, dice *d) {
    reservoir_builder st = builder_empty();
    if (how == PAIRWISE) {
        float m_n = 0, m_c = 0;
        for (int i = 1; i < PIXELS; i++)
            m_n += r[i].m;
        for (int i = 1; i < PIXELS; i++) {
            uint32_t x = r[i].light;
            float share = r[i].m / m_n;
            float w = pair_weight(share, m_n, target_at(t, i, x, rays), r[0].m, target_at(t, 0, x, rays), r[i].w);
            st = builder_add(st, x, 0, 0, t->p[0][x], w, r[i].m, (float)i, (float)uniform(d, 0, 0.99999994));
            m_c += pair_canonical(share, m_n, target_at(t, i, r[0].light, rays), r[0].m,
                                  target_at(t, 0, r[0].light, rays));
        }
        st = builder_add(st, r[0].light, 0, 0, r[0].p, m_c * r[0].p * r[0].w, r[0].m, 0,
                         (float)uniform(d, 0, 0.99999994));
        return builder_end(st, 1);
    }
    for (int i = 0; i < PIXELS; i++) {
        float p = t->p[0][r[i].light], w = r[i].m * p * r[i].w;
        st = builder_add(st, r[i].light, 0, 0, p, w, how == CARELESS && w == 0 ? 0 : r[i].m, (float)i,
                         (float)uniform(d, 0, 0.99999994));
    }
    if (how != MIS && how != COUNTED)
        return builder_end(st, mis_scale(1, st.m));
    float all = 0, held = 0;
    for (int i = 0; i < PIXELS; i++) {
        float p = target_at(t, i, st.light, rays);
        all += how == COUNTED ? (p > 0 ? r[i].m : 0) : r[i].m * p;
        held = st.tag == (float)i ? p : held;
    }
    return builder_end(st, mis_scale(how == COUNTED ? 1 : held, all));
}

/* Mean of f W over many combinations; twice: what one combination leaves is capped and meets new neighbours. */
static mean simulate(const toy *t, mode how, bool rays, bool twice, uint64_t seed) {
    dice d = { seed };
    mean out = { 0 };
    for (int i = 0; i < 300000; i++) {
        reservoir r[PIXELS];
        for (int k = 0; k < PIXELS; k++)
            r[k] = initial(t, k, &d);
        reservoir y = combine(t, r, how, rays, &d);
        if (twice) {
            for (int k = 1; k < PIXELS; k++)
                r[k] = initial(t, k, &d);
            r[0] = reservoir_cap(y, 4);
            if (!t->seen[0][r[0].light])
                r[0].w = 0;
            y = combine(t, r, how, rays, &d);
        }
        mean_add(&out, y.w > 0 && t->seen[0][y.light] ? t->f[y.light] * (double)y.w : 0);
    }
    return out;
}

static void expect(const char *what, const toy *t, mode how, bool rays, bool twice, bool unbiased) {
    mean m = simulate(t, how, rays, twice, 31 + (uint64_t)how);
    double off = mean_off(&m, truth_of(t));
    print_message("# %s: %.4f +- %.4f of %.4f (%.1f standard errors)\n", what, mean_of(&m), mean_error(&m), truth_of(t),
                  off);
    if (unbiased)
        assert_true(off < 4);
    else
        assert_true(off > 10);
}

static void test_reuse_without_shadows(void **state) {
    expect("1/M", &plain, BIASED, false, false, false);
    expect("1/M without empty neighbours", &plain, CARELESS, false, false, false);
    expect("mis", &plain, MIS, false, false, true);
    expect("counted", &plain, COUNTED, false, false, true);
    expect("pairwise", &plain, PAIRWISE, false, false, true);
    expect("mis, twice", &plain, MIS, false, true, true);
    expect("counted, twice", &plain, COUNTED, false, true, true);
    expect("pairwise, twice", &plain, PAIRWISE, false, true, true);
}

/* Visibility reuse makes V a part of the sources' targets: only combinations that ask for it stay unbiased. */
static void test_reuse_with_shadows(void **state) {
    expect("shadows, 1/M", &shadowed, BIASED, false, false, false);
    expect("shadows, mis without bias rays", &shadowed, MIS, false, false, false);
    expect("shadows, pairwise without bias rays", &shadowed, PAIRWISE, false, false, false);
    expect("shadows, counted without bias rays", &shadowed, COUNTED, false, false, false);
    expect("shadows, counted with bias rays", &shadowed, COUNTED, true, false, true);
    expect("shadows, counted with bias rays, twice", &shadowed, COUNTED, true, true, true);
    expect("shadows, mis with bias rays", &shadowed, MIS, true, false, true);
    expect("shadows, pairwise with bias rays", &shadowed, PAIRWISE, true, false, true);
    expect("shadows, mis with bias rays, twice", &shadowed, MIS, true, true, true);
    expect("shadows, pairwise with bias rays, twice", &shadowed, PAIRWISE, true, true, true);
}

/* The MIS weights of any sample add up to 1 where anything can make it, and are M_i / M where all targets agree. */
static void test_pairwise_weights_sum_to_one(void **state) {
    dice d = { 41 };
    for (int i = 0; i < 200000; i++) {
        enum { N = 5 };
        float p[N], m[N], p_q = roll(&d) % 5 ? (float)uniform(&d, 0, 10) : 0, m_c = (float)(1 + roll(&d) % 32), m_n = 0;
        bool same = roll(&d) % 4 == 0;
        for (int k = 0; k < N; k++) {
            m[k] = (float)(roll(&d) % 100);
            p[k] = same ? p_q : roll(&d) % 3 ? (float)uniform(&d, 0, 10) : 0;
            m_n += m[k];
        }
        if (m_n == 0)
            continue;
        float sum = 0, canonical = 0;
        for (int k = 0; k < N; k++) {
            float share = m[k] / m_n, w = pair_weight(share, m_n, p[k], m_c, p_q, 1);
            if (p_q > 0)
                sum += w / p_q;
            canonical += pair_canonical(share, m_n, p[k], m_c, p_q);
            if (same && p_q > 0)
                assert_true(fabsf(w / p_q - m[k] / (m_n + m_c)) < 1e-5f);
        }
        if (p_q > 0)
            assert_true(fabsf(sum + canonical - 1) < 1e-5f);
        else
            assert_true(canonical >= 0 && canonical < 1 + 1e-5f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ris_is_unbiased),
        cmocka_unit_test(test_ris_of_one_light_and_of_none_that_shines),
        cmocka_unit_test(test_stream_is_proportional),
        cmocka_unit_test(test_nothing_odd_comes_out),
        cmocka_unit_test(test_reuse_without_shadows),
        cmocka_unit_test(test_reuse_with_shadows),
        cmocka_unit_test(test_pairwise_weights_sum_to_one),
    };
    return cmocka_run_group_tests_name("reservoir", tests, NULL, NULL);
}
