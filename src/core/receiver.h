/* core/receiver.h: what is lit: a point of a surface, as the G-buffer holds it. A camera's rays are one source of them.
 */
#ifndef CORE_RECEIVER_H
#define CORE_RECEIVER_H

#include "core/blocks.h"
#include "core/dialect.h"

struct receiver {
    v3 p;         /* local metres */
    v3 n;         /* unit, geometric, on the side that is looked at; 0: there is no surface */
    real depth;   /* distance from the eye */
    u32 material; /* NO_SURFACE: none */
    u32 light;    /* whose emitting side is seen, or NO_LIGHT */
};

#ifndef CORE_GLSL
typedef struct receiver receiver;
#endif

FN receiver receiver_none(void) {
    receiver r;
    r.p = fill3(K(0.0f));
    r.n = fill3(K(0.0f));
    r.depth = K(0.0f);
    r.material = KU(NO_SURFACE);
    r.light = KU(NO_LIGHT);
    return r;
}

/* A receiver that is given. eye: what its depth is measured from. */
FN receiver receiver_given(v3 p, v3 n, u32 material, v3 eye) {
    receiver r;
    r.p = p;
    r.n = n;
    v3 d = sub3(p, eye);
    r.depth = sqrt_(dot3(d, d));
    r.material = material;
    r.light = KU(NO_LIGHT);
    return r;
}

FN receiver receiver_sel(mask c, receiver a, receiver b) {
    receiver r;
    r.p = sel3(c, a.p, b.p);
    r.n = sel3(c, a.n, b.n);
    r.depth = sel(c, a.depth, b.depth);
    r.material = selu(c, a.material, b.material);
    r.light = selu(c, a.light, b.light);
    return r;
}

FN mask receives(receiver r) { return r.material != KU(NO_SURFACE); }

#endif
