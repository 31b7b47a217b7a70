/* Light pickers: draw's p is pmf's, the pmf of all lights sum to 1, and f / pmf of many draws lies within 4 standard
 * errors of the sum over all lights: for every kind of light mixed, some dark, some in one place, from 1 to 100,000 of
 * them. The sums come from every light evaluated by core/surface.h, without any picker. */
#include "worlds.h"

#include "light/alias.h"
#include "light/bound.h"

#include "core/alias.h"

struct core_context {
    const noc_alias *alias;
};

FN alias_slot alias_load(CTX u32 i) {
    alias_slot s;
    memcpy(&s, &ctx->alias->slots[i], sizeof(s));
    return s;
}

/* ---- pickers ---- */

/* A picker at one surface: m draws of that surface, and the probability of a light. */
typedef struct picker {
    const noc_scene *scene;
    const noc_alias *alias;
    surf y;
    double wrong; /* share that is added to the pmf of odd lights: a test of the test */
} picker;

enum { DRAWS = 32 };

static void look_from(picker *p, surf y) { p->y = y; }

static void draw(picker *p, pick out[DRAWS]) {
    struct core_context ctx = { p->alias };
    for (int i = 0; i < DRAWS; i++) {
        out[i] = (pick){ 0, 0 };
        if (p->alias && p->alias->count)
            out[i] = alias_draw(&ctx, p->alias->count, bits(), unit_real(bits()));
    }
}

static double pmf(picker *p, uint32_t id) {
    struct core_context ctx = { p->alias };
    double x = 0;
    if (p->alias && p->alias->count)
        x = alias_pmf(&ctx, id);
    return x * (1 + (id & 1 ? p->wrong : 0));
}

static void draws_are_pmf(picker *p) {
    pick got[DRAWS];
    for (int round = 0; round < 20; round++) {
        draw(p, got);
        for (int i = 0; i < DRAWS; i++) {
            if (!(got[i].inverse > 0))
                continue;
            assert_true(got[i].light < p->scene->lights.len);
            double x = pmf(p, got[i].light) * got[i].inverse;
            if (!(fabs(x - 1) < 1e-5))
                fail_msg("light %u of %zu: draw's p is 1/%g, pmf %g", got[i].light, p->scene->lights.len,
                         got[i].inverse, pmf(p, got[i].light));
        }
    }
}

/* Of `rounds` sets of draws, the distance of their mean estimate from the sum, in standard errors. */
static double distance(picker *p, int rounds) {
    size_t n = p->scene->lights.len;
    double want = 0, sum = 0, square = 0;
    for (uint32_t i = 0; i < n; i++)
        want += shine(p->scene, p->y, i);
    for (int r = 0; r < rounds; r++) {
        pick got[DRAWS];
        double x = 0;
        draw(p, got);
        for (int i = 0; i < DRAWS; i++)
            if (got[i].inverse > 0)
                x += shine(p->scene, p->y, got[i].light) / pmf(p, got[i].light) / DRAWS;
        sum += x;
        square += x * x;
    }
    double mean = sum / rounds, error = sqrt(fmax(square / rounds - mean * mean, 0) / rounds);
    return fabs(mean - want) / fmax(error, 1e-5 * want + 1e-30);
}

static double total_pmf(picker *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->scene->lights.len; i++)
        sum += pmf(p, i);
    return sum;
}

static void check(const noc_scene *s, picker *p, bool draws_anything) {
    size_t n = s->lights.len;
    float half = 10 + 2 * sqrtf((float)n);
    p->scene = s;
    for (int surface = 0; surface < 6; surface++) {
        look_from(p, random_surf(surface < 3 ? NOC_MIN(half, 15) : half));
        draws_are_pmf(p);
        assert_true(fabs(total_pmf(p) - (draws_anything ? 1 : 0)) < 1e-4);
        if (surface < 3) {
            double z = distance(p, n > 10000 ? 15000 : 5000);
            if (!(z < 4.5))
                fail_msg("%zu lights, surface %d: %.1f standard errors from the sum over all lights", n, surface, z);
        }
    }
}

static void power(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(worlds); i++) {
        noc_scene *s = world(worlds[i].lights, worlds[i].what);
        picker p = { .alias = noc_alias_create(s, NULL) };
        check(s, &p, worlds[i].what != ALL_DARK);
        for (uint32_t k = 0; k < s->lights.len; k++) {
            float e = s->lights.data[k].e[0] + s->lights.data[k].e[1] + s->lights.data[k].e[2];
            assert_int_equal(pmf(&p, k) > 0, e > 0);
        }
        noc_alias_destroy((noc_alias *)p.alias);
        noc_scene_destroy(s);
    }
}

/* As often as its flux says: 2 : 1 : 4 : 0 : 6 for lights of pi, pi / 2 (one-sided 1 m2 at 1 and 1/2 cd/m2), 2 pi
 * (two-sided), and a spot of 9/4 cd whose cones are 60 and 90 degrees wide: 2 pi 9/4 (1/2 + 1/6) = 3 pi. */
static void power_follows_flux(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    const float y[] = { 1, 0.5f, 1, 0 };
    for (int i = 0; i < 4; i++) {
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM,
                        .edge_u = { 1, 0, 0 },
                        .edge_v = { 0, 1, 0 },
                        .emission = { y[i], y[i], y[i] } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    noc_light spot = { .kind = NOC_LIGHT_SPOT,
                       .direction = { 0, 0, -1 },
                       .inner_deg = 60,
                       .outer_deg = 90,
                       .emission = { 2.25f, 2.25f, 2.25f } };
    assert_true(noc_scene_add_light(s, &spot) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    s->lights.data[2].flags |= LIGHT_TWO_SIDED; /* two-sided */
    picker p = { .scene = s, .alias = noc_alias_create(s, NULL) };
    const double want[] = { 2 / 13., 1 / 13., 4 / 13., 0, 6 / 13. };
    size_t count[5] = { 0 }, n = 0;
    for (int round = 0; round < 10000; round++) {
        pick got[DRAWS];
        draw(&p, got);
        for (int i = 0; i < DRAWS; i++, n++)
            count[got[i].light]++;
    }
    for (uint32_t i = 0; i < 5; i++) {
        assert_true(fabs(pmf(&p, i) - want[i]) < 1e-5);
        assert_true(fabs((double)count[i] / (double)n - want[i]) < 4.5 * sqrt(want[i] / (double)n) + 1e-9);
    }
    noc_alias_destroy((noc_alias *)p.alias);
    noc_scene_destroy(s);
}

/* A pmf that is wrong by a fifth for every other light must not pass. */
static void wrong_pmf_is_seen(void **state) {
    (void)state;
    noc_scene *s = world(50, MIXED);
    picker p = { .scene = s, .alias = noc_alias_create(s, NULL) };
    look_from(&p, random_surf(5));
    assert_true(distance(&p, 100000) < 4.5);
    p.wrong = 0.2;
    assert_true(distance(&p, 100000) > 6);
    assert_true(fabs(total_pmf(&p) - 1) > 1e-3);
    noc_alias_destroy((noc_alias *)p.alias);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(power),
        cmocka_unit_test(power_follows_flux),
        cmocka_unit_test(wrong_pmf_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
