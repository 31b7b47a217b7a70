/* core/surface.h: what a surface reflects is reciprocal, never negative, and never more than it gets. */
#include "core_test.h"
#include "core/surface.h"
#include "core/warp.h"
#include "no_profiles.h"

static surf make_surface(v3 wo, float albedo, float f0, float roughness) {
    return (surf){
        .n = { 0, 0, 1 }, .wo = wo, .albedo = { albedo, albedo, albedo }, .f0 = f0, .alpha = roughness * roughness
    };
}

/* A direction `cosine` over the surface. */
static v3 tilted(double cosine, double turn) {
    double s = sqrt(1 - cosine * cosine);
    return V3((float)(s * cos(turn)), (float)(s * sin(turn)), (float)cosine);
}

static double ggx_density(double cosine, double alpha) {
    double a2 = alpha * alpha, t = cosine * cosine * (a2 - 1) + 1;
    return a2 / (M_PI * t * t);
}

/* Reflected share of light that comes evenly from everywhere: the integral of f_r cos over the hemisphere, half of the
 * samples by the cosine, half by GGX normals, weighed by the balance heuristic. Its standard error goes to *error. */
static double furnace(surf s, uint64_t seed, int pairs, double *error) {
    dice d = { seed };
    mean total = { 0 };
    for (int i = 0; i < 2 * pairs; i++) {
        double u = uniform(&d, 0, 1), turn = uniform(&d, 0, 2 * M_PI);
        v3 wi;
        if (i & 1) {
            wi = tilted(sqrt(1 - u), turn);
        } else {
            double a2 = (double)s.alpha * s.alpha;
            v3 h = tilted(sqrt((1 - u) / (1 + (a2 - 1) * u)), turn);
            wi = sub3(mul3(h, 2 * dot3(h, s.wo)), s.wo);
        }
        double f = 0;
        if (wi.z > 0) {
            v3 h = normalised(add3(wi, s.wo));
            double by_cosine = wi.z / M_PI;
            double by_normal = ggx_density(h.z, s.alpha) * h.z / (4 * fmax(dot3(h, s.wo), 1e-9));
            f = reflect(s, wi).x / (0.5 * (by_cosine + by_normal));
        }
        mean_add(&total, f);
    }
    *error = mean_error(&total);
    return mean_of(&total);
}

static void test_white_lambert_reflects_all(void **state) {
    for (int i = 1; i <= 10; i++) {
        double error, e = furnace(make_surface(tilted(i / 10.0, 1), 1, 0, 0.5f), (uint64_t)i, 200000, &error);
        assert_true(fabs(e - 1) < 4 * error);
        e = furnace(make_surface(tilted(i / 10.0, 1), 0.3f, 0, 0.5f), (uint64_t)i, 200000, &error);
        assert_true(fabs(e - 0.3) < 4 * error);
    }
}

/* White, with gloss of any kind, seen from anywhere: at most all of it. */
static void test_energy(void **state) {
    static const float f0s[] = { 0.02f, 0.04f, 0.2f, 0.5f, 1 }, roughs[] = { 0.05f, 0.15f, 0.4f, 0.7f, 1 };
    static const double cosines[] = { 0.02, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1 };
    double most = 0, least = 2;
    for (int f = 0; f < 5; f++)
        for (int r = 0; r < 5; r++)
            for (int c = 0; c < 8; c++) {
                double error, e = furnace(make_surface(tilted(cosines[c], 2), 1, f0s[f], roughs[r]), 11, 20000, &error);
                if (e - 4 * error > 1)
                    fail_msg("f0 %g, roughness %g, cosine %g reflects %g +- %g", f0s[f], roughs[r], cosines[c], e,
                             error);
                most = fmax(most, e);
                if (f < 2 && cosines[c] > 0.3)
                    least = fmin(least, e);
            }
    print_message("# white under gloss reflects at most %.3f; white walls (f0 <= 0.04), not grazing: at least %.3f\n",
                  most, least);
    assert_true(least > 0.8);
    /* a smooth mirror gives back what Fresnel says */
    double error, mirror = furnace(make_surface(tilted(0.8, 0), 0, 1, 0.05f), 12, 50000, &error);
    assert_true(fabs(mirror - 1) < 0.01 + 4 * error);
    double want = 0.04 + 0.96 * pow(1 - 0.5, 5);
    double pane = furnace(make_surface(tilted(0.5, 0), 0, 0.04f, 0.05f), 13, 50000, &error);
    assert_true(fabs(pane - want) < 0.02 * want + 4 * error);
    /* the test can fail: Lambert and gloss simply added reflect more than they get */
    surf wall = make_surface(tilted(0.1, 0), 1, 0.04f, 0.15f);
    surf only_gloss = wall;
    only_gloss.albedo = fill3(0);
    assert_true((1 - 0.04) + furnace(only_gloss, 14, 50000, &error) > 1 + 4 * error);
}

static void test_reciprocity(void **state) {
    dice d = { 1 };
    for (int i = 0; i < 200000; i++) {
        v3 a = tilted(uniform(&d, 0.01, 1), uniform(&d, 0, 7)), b = tilted(uniform(&d, 0.01, 1), uniform(&d, 0, 7));
        float f0 = roll(&d) % 3 ? (float)uniform(&d, 0, 1) : 0, rough = (float)uniform(&d, 0.05, 1);
        double ab = reflect(make_surface(a, 0.5f, f0, rough), b).y / b.z;
        double ba = reflect(make_surface(b, 0.5f, f0, rough), a).y / a.z;
        assert_true(ab >= 0 && isfinite(ab));
        if (fabs(ab - ba) > 2e-4 * (ab + ba))
            fail_msg("f0 %g, roughness %g: %g there, %g back", f0, rough, ab, ba);
    }
}

/* The lobe against its formula in doubles: no digits are lost where it is narrow. */
static void test_gloss_is_accurate(void **state) {
    dice d = { 2 };
    double worst = 0;
    for (int i = 0; i < 200000; i++) {
        float f0 = (float)uniform(&d, 0.02, 1), rough = (float)uniform(&d, 0.05, 1);
        double alpha = (double)(rough * rough), a2 = alpha * alpha;
        v3 wo = tilted(uniform(&d, 0.05, 1), uniform(&d, 0, 7));
        v3 h = tilted(1 / sqrt(1 + a2 * uniform(&d, 0, 4)), uniform(&d, 0, 7)); /* near the peak */
        v3 wi = normalised(sub3(mul3(h, 2 * dot3(h, wo)), wo));
        if (wi.z < 0.05f)
            continue;
        double hx = (double)wi.x + wo.x, hy = (double)wi.y + wo.y, hz = (double)wi.z + wo.z;
        double len = sqrt(hx * hx + hy * hy + hz * hz), nh = hz / len, vh = (hx * wo.x + hy * wo.y + hz * wo.z) / len;
        double sin2 = (hx * hx + hy * hy) / (len * len), q = nh * nh * a2 + sin2;
        double dist = a2 / (M_PI * q * q), nl = wi.z, nv = wo.z;
        double vis = 0.5 / (nl * sqrt(a2 + nv * nv * (1 - a2)) + nv * sqrt(a2 + nl * nl * (1 - a2)));
        double want = dist * vis * (f0 + (1 - f0) * pow(1 - vh, 5)) * nl;
        double have = reflect(make_surface(wo, 0, f0, rough), wi).x;
        worst = fmax(worst, fabs(have - want) / want);
    }
    print_message("# gloss: worst relative error near its peak %.3g\n", worst);
    assert_true(worst < 2e-3);
}

static void test_nothing_from_behind(void **state) {
    dice d = { 3 };
    for (int i = 0; i < 10000; i++) {
        surf s = make_surface(tilted(uniform(&d, 0, 1), 1), 1, (float)uniform(&d, 0, 1), (float)uniform(&d, 0.05, 1));
        v3 f = reflect(s, tilted(-uniform(&d, 0, 1), uniform(&d, 0, 7)));
        assert_true(f.x == 0 && f.y == 0 && f.z == 0);
        f = reflect(s, sub3(fill3(0), s.wo)); /* straight through: no half vector */
        assert_true(finite3(f));
    }
}

/* The target is the luminance of what is shaded. */
static void test_target_is_luminance(void **state) {
    dice d = { 4 };
    for (int i = 0; i < 100000; i++) {
        light l = { .p = random_in_box(&d, 5),
                    .kind = (uint32_t)(roll(&d) % (LIGHT_SPOT + 1)),
                    .a = random_in_box(&d, 1),
                    .b = random_in_box(&d, 1),
                    .radius = 0.3f,
                    .flags = LIGHT_TWO_SIDED,
                    .e = { 50, 100, 20 } };
        surf s = { .p = random_in_box(&d, 5),
                   .n = random_direction(&d),
                   .albedo = { .9f, .2f, .4f },
                   .f0 = roll(&d) & 1 ? 0.04f : 0,
                   .alpha = 0.3f };
        s.wo = random_direction(&d);
        if (dot3(s.n, s.wo) < 0)
            s.wo = mul3(s.wo, -1);
        float u = (float)uniform(&d, 0, 1), v = (float)uniform(&d, 0, 1);
        double want = luminance(reflected(s, sample_light(l, s.p, u, v)));
        assert_close(target(NULL, s, l, u, v), want, 2e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_white_lambert_reflects_all),
        cmocka_unit_test(test_energy),
        cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_gloss_is_accurate),
        cmocka_unit_test(test_nothing_from_behind),
        cmocka_unit_test(test_target_is_luminance),
    };
    return cmocka_run_group_tests_name("surface", tests, NULL, NULL);
}
