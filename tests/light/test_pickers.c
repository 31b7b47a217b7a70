/* Light pickers: draw's p is pmf's, the pmf of all lights sum to 1, and f / pmf of many draws lies within 4 standard errors
 * of the sum over all lights: for every kind of light mixed, some dark, some in one place, from 1 to 100,000 of them. The
 * sums come from every light evaluated by core/surface.h, without any picker. */
#include "../render/rooms.h"

#include "light/alias.h"
#include "light/bound.h"
#include "light/tree.h"

#include "core/alias.h"
#include "core/surface.h"
#include "core/tree.h"

struct core_context {
    const noc_alias *alias;
    const noc_tree *tree;
};

FN alias_slot alias_load(CTX u32 i) {
    alias_slot s;
    memcpy(&s, &ctx->alias->slots[i], sizeof(s));
    return s;
}

FN tree_node tree_load(CTX u32 i) {
    tree_node n;
    memcpy(&n, &ctx->tree->nodes[i], sizeof(n));
    return n;
}

/* ---- worlds ---- */

static uint32_t state_ = 1;
static uint32_t bits(void) { return state_ = hash_u32(state_ + 0x9e3779b9u); }
static float real_in(float lo, float hi) { return lo + (hi - lo) * unit_real(bits()); }

typedef enum { MIXED, DARK_ONES, ONE_PLACE, ALL_DARK } sort;

/* Lights of all kinds in a street's shape, with a floor for S_r to be found on. */
static noc_scene *world(uint32_t lights, sort what) {
    noc_scene *s = noc_scene_create(NULL);
    float half = 10 + 2 * sqrtf((float)lights);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, half);
    for (uint32_t i = 0; i < lights; i++) {
        noc_light l = { .kind = (noc_light_kind)(i % 5), .radius = real_in(0.05f, 0.4f) };
        bool dark = what == ALL_DARK || (what == DARK_ONES && i % 3 != 1);
        float strong = i % 50 == 17 ? 3000 : 3;
        for (int k = 0; k < 3; k++) {
            l.position[k] = what == ONE_PLACE ? 3 : k == 2 ? real_in(0.5f, 15) : real_in(-half, half);
            l.edge_u[k] = real_in(-1, 1);
            l.edge_v[k] = real_in(-1, 1);
            l.direction[k] = real_in(-1, 1) - (k == 2 ? 1.2f : 0);
            l.emission[k] = dark ? 0 : real_in(0.1f, 1) * strong;
        }
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(s->lights.len, lights);
    for (uint32_t i = 0; i < lights; i += 7)
        s->lights.data[i].flags |= 1; /* two-sided */
    return s;
}

static surf random_surf(float half) {
    float a = real_in(0, 6.28f), up = real_in(-0.3f, 1), r = sqrtf(fmaxf(1 - up * up, 0));
    surf s = { .p = { real_in(-half, half), real_in(-half, half), real_in(0, 12) }, .albedo = { 0.4f, 0.5f, 0.3f } };
    s.n = V3(r * cosf(a), r * sinf(a), up);
    s.wo = s.n;
    return s;
}

static double shine(const noc_scene *s, surf y, uint32_t i) {
    light l;
    memcpy(&l, &s->lights.data[i], sizeof(l));
    return target(y, l, 0.3f, 0.6f);
}

/* ---- pickers ---- */

/* A picker at one surface: m draws of that surface, and the probability of a light. */
typedef struct picker {
    const noc_scene *scene;
    const noc_alias *alias;
    const noc_tree *tree;
    surf y;
    double wrong; /* share that is added to the pmf of odd lights: a test of the test */
} picker;

enum { DRAWS = 32 };

static void look_from(picker *p, surf y) { p->y = y; }

static void draw(picker *p, pick out[DRAWS]) {
    struct core_context ctx = { p->alias, p->tree };
    for (int i = 0; i < DRAWS; i++) {
        out[i] = (pick){ 0, 0 };
        if (p->tree && p->tree->count)
            out[i] = tree_draw(&ctx, p->y.p, p->y.n, bits(), p->tree->depth);
        if (p->alias && p->alias->count)
            out[i] = alias_draw(&ctx, p->alias->count, bits(), unit_real(bits()));
    }
}

static double pmf(picker *p, uint32_t id) {
    struct core_context ctx = { p->alias, p->tree };
    double x = 0;
    if (p->tree && p->tree->count && noc_light_intensity(&p->scene->lights.data[id]) > 0)
        x = tree_pmf(&ctx, p->y.p, p->y.n, p->tree->paths[id], p->tree->depth);
    else if (p->alias && p->alias->count)
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
                fail_msg("light %u of %zu: draw's p is 1/%g, pmf %g", got[i].light, p->scene->lights.len, got[i].inverse,
                         pmf(p, got[i].light));
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

static const struct { uint32_t lights; sort what; } worlds[] = {
    { 1, MIXED }, { 2, MIXED }, { 3, DARK_ONES }, { 9, ONE_PLACE }, { 50, MIXED }, { 300, DARK_ONES }, { 500, ONE_PLACE },
    { 1000, MIXED }, { 20, ALL_DARK }, { 100000, MIXED },
};

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

/* As often as its flux says: 2 : 1 : 4 : 0 for lights of pi, pi / 2 (one-sided 1 m2 at 1 and 1/2 cd/m2), 2 pi (two-sided). */
static void power_follows_flux(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    const float y[] = { 1, 0.5f, 1, 0 };
    for (int i = 0; i < 4; i++) {
        noc_light l = { .kind = NOC_LIGHT_PARALLELOGRAM, .edge_u = { 1, 0, 0 }, .edge_v = { 0, 1, 0 },
                        .emission = { y[i], y[i], y[i] } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    s->lights.data[2].flags |= 1; /* two-sided */
    picker p = { .scene = s, .alias = noc_alias_create(s, NULL) };
    const double want[] = { 2 / 7., 1 / 7., 4 / 7., 0 };
    size_t count[4] = { 0 }, n = 0;
    for (int round = 0; round < 10000; round++) {
        pick got[DRAWS];
        draw(&p, got);
        for (int i = 0; i < DRAWS; i++, n++)
            count[got[i].light]++;
    }
    for (uint32_t i = 0; i < 4; i++) {
        assert_true(fabs(pmf(&p, i) - want[i]) < 1e-5);
        assert_true(fabs((double)count[i] / (double)n - want[i]) < 4.5 * sqrt(want[i] / (double)n) + 1e-9);
    }
    noc_alias_destroy((noc_alias *)p.alias);
    noc_scene_destroy(s);
}

static void tree(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(worlds); i++) {
        noc_scene *s = world(worlds[i].lights, worlds[i].what);
        picker p = { .tree = noc_tree_create(s, NULL) };
        assert_true(p.tree->depth <= NOC_TREE_DEPTH);
        check(s, &p, worlds[i].what != ALL_DARK);
        noc_tree_destroy((noc_tree *)p.tree);
        noc_scene_destroy(s);
    }
}

/* Lights in a row whose distances double, and 1000 in one place beside them: the way down stays within its bits, and every
 * light is at the end of its own way. */
static void tree_of_uneven_lights(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    for (int i = 0; i < 1060; i++) {
        noc_light l = { .kind = NOC_LIGHT_POINT, .position = { i < 60 ? ldexp(1e-6, i / 3) : 0, 0, 3 }, .emission = { 1, 1, 1 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    picker p = { .tree = noc_tree_create(s, NULL) };
    assert_true(p.tree->depth >= 11 && p.tree->depth <= NOC_TREE_DEPTH);
    for (uint32_t i = 0; i < 1060; i++) {
        uint32_t at = 0, path = p.tree->paths[i];
        for (; p.tree->nodes[at].child; path >>= 1)
            at = p.tree->nodes[at].child + (path & 1);
        assert_int_equal(p.tree->nodes[at].light, i);
    }
    check(s, &p, true);
    noc_tree_destroy((noc_tree *)p.tree);
    noc_scene_destroy(s);
}

/* A node's sphere and cone hold all lights below it, and its power is theirs. */
static void tree_bounds_hold(void **state) {
    (void)state;
    noc_scene *s = world(2000, MIXED);
    noc_tree *t = noc_tree_create(s, NULL);
    for (uint32_t i = 0; i < 2000; i++) {
        noc_light_bound b = noc_bound_light(&s->lights.data[i]);
        uint32_t path = t->paths[i];
        for (uint32_t at = 0;; path >>= 1) {
            const noc_tree_node *n = &t->nodes[at];
            double d2 = 0, c = 0;
            for (int k = 0; k < 3; k++) {
                d2 += (double)(b.p[k] - n->c[k]) * (b.p[k] - n->c[k]);
                c += (double)b.n[k] * n->axis[k];
            }
            bool any = b.n[0] == 0 && b.n[1] == 0 && b.n[2] == 0;
            assert_true(sqrt(d2) + b.radius <= n->radius * 1.000001);
            assert_true((any ? -1 : c) >= n->cos_cone);
            assert_true(n->power >= b.intensity * 0.9999f);
            if (!n->child)
                break;
            float both = t->nodes[n->child].power + t->nodes[n->child + 1].power;
            assert_true(fabsf(both - n->power) <= 1e-3f * n->power);
            at = n->child + (path & 1);
        }
    }
    noc_tree_destroy(t);
    noc_scene_destroy(s);
}

/* A pmf that is wrong by a fifth for every other light must not pass. */
static void wrong_pmf_is_seen(void **state) {
    (void)state;
    noc_scene *s = world(50, MIXED);
    picker all[] = { { .alias = noc_alias_create(s, NULL) }, { .tree = noc_tree_create(s, NULL) } };
    for (size_t i = 0; i < NOC_COUNT(all); i++) {
        picker *p = &all[i];
        p->scene = s;
        look_from(p, random_surf(5));
        assert_true(distance(p, 20000) < 4.5);
        p->wrong = 0.2;
        assert_true(distance(p, 20000) > 6);
        assert_true(fabs(total_pmf(p) - 1) > 1e-3);
    }
    noc_alias_destroy((noc_alias *)all[0].alias);
    noc_tree_destroy((noc_tree *)all[1].tree);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(power),
        cmocka_unit_test(power_follows_flux),
        cmocka_unit_test(tree),
        cmocka_unit_test(tree_of_uneven_lights),
        cmocka_unit_test(tree_bounds_hold),
        cmocka_unit_test(wrong_pmf_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
