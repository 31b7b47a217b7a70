/* Helpers of the tests of src/core: random input that does not come from the code under test, and sums with their
 * errors. */
#ifndef TESTS_CORE_TEST_H
#define TESTS_CORE_TEST_H

#include "../test.h"
#include "core/dialect.h"

#include <math.h>

/* SplitMix64, and uniform numbers from it. */
typedef struct dice {
    uint64_t state;
} dice;

static inline uint64_t roll(dice *d) {
    uint64_t z = d->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}
static inline double uniform(dice *d, double from, double to) {
    return from + (to - from) * ((double)(roll(d) >> 11) * 0x1p-53);
}

static inline v3 random_in_box(dice *d, double half) {
    return V3((float)uniform(d, -half, half), (float)uniform(d, -half, half), (float)uniform(d, -half, half));
}
static inline v3 normalised(v3 a) {
    double s = 1 / sqrt((double)a.x * a.x + (double)a.y * a.y + (double)a.z * a.z);
    return V3((float)(a.x * s), (float)(a.y * s), (float)(a.z * s));
}
static inline v3 random_direction(dice *d) {
    for (;;) {
        v3 a = random_in_box(d, 1);
        float l2 = a.x * a.x + a.y * a.y + a.z * a.z;
        if (l2 > 0.01f && l2 < 1)
            return normalised(a);
    }
}

/* Mean and the standard error of the mean. */
typedef struct mean {
    double n, sum, squares;
} mean;
static inline void mean_add(mean *m, double x) {
    m->n++;
    m->sum += x;
    m->squares += x * x;
}
static inline double mean_of(const mean *m) { return m->sum / m->n; }
static inline double mean_error(const mean *m) {
    double a = mean_of(m), v = m->squares / m->n - a * a;
    return sqrt((v > 0 ? v : 0) / (m->n - 1));
}
/* Distance of the mean from the truth, in standard errors. */
static inline double mean_off(const mean *m, double truth) {
    return fabs(mean_of(m) - truth) / (mean_error(m) + 1e-300);
}

static inline bool finite3(v3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

#define assert_close(have, want, relative)                                                                             \
    do {                                                                                                               \
        double have_ = (have), want_ = (want);                                                                         \
        if (!(fabs(have_ - want_) <= (relative)*fabs(want_)))                                                          \
            fail_msg("%s is %.9g, %s is %.9g", #have, have_, #want, want_);                                            \
    } while (0)

#endif
