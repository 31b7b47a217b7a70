/* Points and normals of hits against doubles: random triangles, very large ones, and very thin ones. */
#include "core_test.h"

#include "core/hit.h"

enum { TRIES = 200000 };

static dice die = { 1 };
static double unit(void) { return uniform(&die, 0, 1); }

typedef struct shape {
    const char *name;
    double place, size,
        thin; /* where corners lie, how long edges are, and the third corner's distance to the first edge */
} shape;

static v3 near_place(double place, double size) {
    return V3((float)((2 * unit() - 1) * place + (2 * unit() - 1) * size),
              (float)((2 * unit() - 1) * place + (2 * unit() - 1) * size), (float)((2 * unit() - 1) * size));
}

static corners any_triangle(const shape *s) {
    corners t = { near_place(s->place, 0), near_place(0, s->size), near_place(0, s->size) };
    t.b = add3(t.a, t.b);
    if (s->thin > 0) {
        double at = unit();
        v3 side = near_place(0, s->thin * s->size);
        t.c = add3(add3(t.a, mul3(sub3(t.b, t.a), (float)at)), side);
    } else {
        t.c = add3(t.a, t.c);
    }
    return t;
}

static void exactly(corners t, double u, double v, double p[3], double n[3]) {
    const float *a = &t.a.x, *b = &t.b.x, *c = &t.c.x;
    long double e[3], f[3], m[3];
    for (int k = 0; k < 3; k++) {
        e[k] = (long double)b[k] - a[k];
        f[k] = (long double)c[k] - a[k];
        p[k] = (double)(a[k] + u * e[k] + v * f[k]);
    }
    m[0] = e[1] * f[2] - e[2] * f[1];
    m[1] = e[2] * f[0] - e[0] * f[2];
    m[2] = e[0] * f[1] - e[1] * f[0];
    long double inv = 1 / sqrtl(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    for (int k = 0; k < 3; k++)
        n[k] = (double)(m[k] * inv);
}

static double ulp(double x) { return ldexp(1, ilogb(fmax(fabs(x), 1e-30)) - 23); }

static void hits_are_those_of_doubles(void **state) {
    static const shape shapes[] = { { "a wall", 500, 10, 0 },      { "a plain", 3000, 10000, 0 },
                                    { "a country", 1e6, 3e5, 0 },  { "a bolt", 500, 0.01, 0 },
                                    { "a blade", 500, 100, 1e-4 }, { "a long blade", 1000, 10000, 1e-3 } };
    (void)state;
    for (size_t i = 0; i < sizeof(shapes) / sizeof(*shapes); i++) {
        double worst_point = 0, worst_normal = 0;
        for (int k = 0; k < samples(TRIES); k++) {
            corners t = any_triangle(&shapes[i]);
            float u = (float)unit(), v = (float)((1 - u) * unit());
            double p[3], n[3];
            exactly(t, u, v, p, n);
            if (!isfinite(n[0]))
                continue;
            v3 q = hit_point(t, u, v), m = hit_normal(t);
            for (int c = 0; c < 3; c++) {
                worst_point = fmax(worst_point, fabs((&q.x)[c] - p[c]) / ulp(p[c]));
                worst_normal = fmax(worst_normal, fabs((&m.x)[c] - n[c]));
            }
        }
        print_message("# %-13s point within %.3f units in the last place, normal within %.2g\n", shapes[i].name,
                      worst_point, worst_normal);
        assert_true(worst_point <= 0.51);
        assert_true(worst_normal < 2.5e-7);
    }
}

/* A triangle of no extent has a normal of 0, and nothing is infinite. */
static void points_have_no_normal(void **state) {
    (void)state;
    corners t = { V3(1, 2, 3), V3(1, 2, 3), V3(1, 2, 3) };
    v3 n = hit_normal(t), p = hit_point(t, 0.3f, 0.3f);
    assert_true(n.x == 0 && n.y == 0 && n.z == 0);
    assert_true(p.x == 1 && p.y == 2 && p.z == 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_are_those_of_doubles),
        cmocka_unit_test(points_have_no_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
