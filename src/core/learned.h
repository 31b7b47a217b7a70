/* core/learned.h: what is learned of the lights' visibility, in cells of world space: which cell a surface lies in, and
 * what counts of rays say. Counts are whole numbers. */
#ifndef CORE_LEARNED_H
#define CORE_LEARNED_H

#include "core/random.h"

#define LEARNED_UNKNOWN 0.5f /* the visibility of a light that nothing is known of */
#define LEARNED_PIXELS 32.0f /* side of a cell, in pixels of the picture, about */
#define LEARNED_WORTH 2.0f   /* the prior counts as the rays of so many lights */

/* How strongly rays are drawn to a light: the root of its expected square, and something for those thought to be
 * hidden. */
FN1 f1 learned_pull(f1 visibility) { return sqrt1(visibility) + 0.1f; }

/* Visibility expected of a light: of one that so many rays asked for, seen by some of them, where all of the cell's
 * lights come to `all`; of those, a half beforehand. */
FN1 f1 learned_visibility(f1 asked, f1 seen, f1 all) {
    EXACT f1 v = (seen + LEARNED_WORTH * all) / (asked + LEARNED_WORTH);
    return v;
}

/* The prior of an entry of a list: how strongly rays are drawn to it, and what of its light is expected to
 * arrive. */
struct list_prior {
    f1 share;  /* weight * pull */
    f1 expect; /* weight * visibility */
};

#ifndef CORE_GLSL
typedef struct list_prior list_prior;
#endif

FN1 list_prior list_prior_of(f1 weight, f1 visibility) {
    list_prior b;
    EXACT f1 share = weight * learned_pull(visibility);
    EXACT f1 expect = weight * visibility;
    b.share = share;
    b.expect = expect;
    return b;
}

#endif
