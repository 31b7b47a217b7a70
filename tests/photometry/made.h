/* Files of luminaires made of a function of the direction, for tests. */
#ifndef NOC_TEST_MADE_H
#define NOC_TEST_MADE_H

#include "test.h"

#include "photometry/photometry.h"

#include <math.h>

typedef struct made {
    char text[1 << 18];
    size_t len;
} made;

__attribute__((format(printf, 2, 3))) static inline void put(made *m, const char *fmt, ...) {
    va_list ap;
    va_start(ap, fmt);
    int n = vsnprintf(m->text + m->len, sizeof(m->text) - m->len, fmt, ap);
    va_end(ap);
    assert_true(n >= 0 && (size_t)n < sizeof(m->text) - m->len);
    m->len += (size_t)n;
}

/* cd towards C and gamma, degrees: as symmetric as asked for. */
typedef enum { ABOUT_AXIS, QUARTERS, HALVES, HALVES_ACROSS, NO_SYMMETRY, SYMMETRIES } symmetry;
static inline double made_cd(symmetry s, double c, double gamma) {
    double x = cos(c * M_PI / 180), y = sin(c * M_PI / 180), t = cos(gamma * M_PI / 180);
    double around = s == ABOUT_AXIS      ? 0
                    : s == QUARTERS      ? .3 * x * x
                    : s == HALVES        ? .3 * x
                    : s == HALVES_ACROSS ? .3 * y
                                         : .3 * x + .2 * y;
    return 1000 * (1.2 + .5 * t) * (1 + around * (1 - t * t));
}

/* Rows of numbers. */
static inline void put_steps(made *m, double from, double to, double step) {
    for (double x = from; x < to + 1e-9; x += step)
        put(m, "%g ", x);
    put(m, "\n");
}

static inline int count_steps(double from, double to, double step) { return (int)lround((to - from) / step) + 1; }

/* A file of type C between these angles, without the lines before TILT. factor: intensities are divided by it. */
static inline void put_ies(made *m, symmetry s, double from, double to, double factor) {
    put(m, "TILT=NONE\n1 -1 1 37 %d 1 2 .1 .2 0\n1 1 50\n", count_steps(from, to, 15));
    put_steps(m, 0, 180, 5);
    put_steps(m, from, to, 15);
    for (double c = from; c < to + 1e-9; c += 15)
        for (double g = 0; g <= 180; g += 5)
            put(m, "%.9g%c", made_cd(s, c, g) / factor, g == 180 ? '\n' : ' ');
}

/* Isym by the symmetry; the lamps' lumens and LOR as given. */
static inline void put_eulumdat(made *m, symmetry s, double lumens, double lor) {
    static const int isym[] = { 1, 4, 2, 3, 0 };
    static const double from[] = { 0, 0, 0, 270, 0 }, to[] = { 0, 90, 180, 450, 345 };
    put(m, "Maker\n1\n%d\n24\n15\n37\n5\nreport\nA lamp\nno\nfile\ndate\n", isym[s]);
    put(m, "300\n200\n100\n250\n150\n0\n0\n0\n0\n100\n%g\n1\n0\n1\n1\nLED\n%g\n3000\n80\n50\n", lor, lumens);
    for (int i = 0; i < 10; i++)
        put(m, "0.5\n");
    for (int i = 0; i < 24; i++)
        put(m, "%d\n", 15 * i);
    for (int i = 0; i < 37; i++)
        put(m, "%d\n", 5 * i);
    for (double c = from[s]; c < to[s] + 1e-9; c += 15)
        for (double g = 0; g <= 180; g += 5)
            put(m, "%.9g\n", made_cd(s, c, g) * 1000 / lumens);
}

static inline noc_profile *read_made(const made *m) {
    noc_profile *p = NULL;
    noc_status status = noc_profile_read(NULL, m->text, m->len, "made", &p);
    assert_int_equal(status, NOC_OK);
    assert_non_null(p);
    return p;
}

#endif
