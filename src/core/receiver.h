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

FN mask receives(receiver r) { return r.material != KU(NO_SURFACE); }

#endif
