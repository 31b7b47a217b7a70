/* core/placement.h: where instances of models are, and where they were in the frame before. */
#ifndef CORE_PLACEMENT_H
#define CORE_PLACEMENT_H

#include "core/receiver.h"

/* Rows of an instance's transform, a rotation times a scale, and its translation. */
struct placement {
    v3 x;
    v3 y;
    v3 z;
    v3 at;
};

#ifndef CORE_GLSL
typedef struct placement placement;
#endif

/* From memory, the same in every lane: rows of 3x4. */
FN placement placement_of_rows(placement_rows r) {
    placement m;
    m.x = V3(K(r.m[0]), K(r.m[1]), K(r.m[2]));
    m.y = V3(K(r.m[4]), K(r.m[5]), K(r.m[6]));
    m.z = V3(K(r.m[8]), K(r.m[9]), K(r.m[10]));
    m.at = V3(K(r.m[3]), K(r.m[7]), K(r.m[11]));
    return m;
}

FN v3 placed_point(placement m, v3 p) {
    EXACT real x = dot3(m.x, p) + m.at.x;
    EXACT real y = dot3(m.y, p) + m.at.y;
    EXACT real z = dot3(m.z, p) + m.at.z;
    return V3(x, y, z);
}

FN v3 placed_normal(placement m, v3 n) {
    v3 t = V3(dot3(m.x, n), dot3(m.y, n), dot3(m.z, n));
    real length = sqrt_(dot3(t, t));
    EXACT real x = t.x / length;
    EXACT real y = t.y / length;
    EXACT real z = t.z / length;
    return V3(x, y, z);
}

/* Square of the transform's scale. */
FN real placement_scale2(placement m) {
    v3 column = V3(m.x.x, m.y.x, m.z.x);
    return dot3(column, column);
}

/* A receiver on an instance as it was in the frame before. from: where the instance's origin is now; back: the turn
 * and the scale from now to then, and where the origin was. Differences to the origin keep the digits that coordinates
 * of a city would lose. */
FN receiver receiver_back(receiver r, v3 from, placement back) {
    r.p = placed_point(back, sub3(r.p, from));
    r.n = placed_normal(back, r.n);
    return r;
}

#endif
