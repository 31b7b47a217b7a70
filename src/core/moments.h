/* core/moments.h: what is kept of a pixel over frames: the mean, and the squared deviations from it (Welford 1962). */
#ifndef CORE_MOMENTS_H
#define CORE_MOMENTS_H

#include "core/dialect.h"

struct moments {
    real mean;
    real squares; /* sum of squared deviations */
};

#ifndef CORE_GLSL
typedef struct moments moments;
#endif

FN moments moments_none(void) {
    moments m;
    m.mean = K(0.0f);
    m.squares = K(0.0f);
    return m;
}

/* y is the value of frame `number`, which counts from 1. */
FN moments moments_add(moments m, real y, real number) {
    EXACT real off = y - m.mean;
    EXACT real mean = m.mean + off / number;
    EXACT real squares = m.squares + off * (y - mean);
    m.mean = mean;
    m.squares = squares;
    return m;
}

/* The mean of n values with one more. share: 1 / (n + 1). */
FN real mean_add(real mean, real x, real share) {
    EXACT real m = mean + (x - mean) * share;
    return m;
}

#endif
