/* core/neighbours.h: which other pixels' reservoirs a pixel reuses: those around it, and the one of the previous frame
 * that saw the same surface.
 *
 * Places of neighbours are drawn once a block of 4x4 pixels, keyed by the block's number in the picture: pixels next to
 * each other read reservoirs next to each other, and their bias rays are nearly parallel. Each pixel still has its own
 * set of neighbours, chosen without regard to any sample. Includers supply FRAME: core/frame.h. */
#ifndef CORE_NEIGHBOURS_H
#define CORE_NEIGHBOURS_H

#include "core/camera.h"
#include "core/random.h"
#include "core/receiver.h"
#include "core/warp.h"

/* A pixel, which may lie outside the picture. */
struct pixel {
    u32 x;
    u32 y;
    mask inside;
};

#ifndef CORE_GLSL
typedef struct pixel pixel;
#endif

/* The pixel that holds (x, y). */
FN pixel pixel_of(CTX real x, real y) {
    pixel p;
    p.inside = and_(and_(x >= K(0.0f), x < K(F32(FRAME.width))), and_(y >= K(0.0f), y < K(F32(FRAME.height))));
    p.x = to_u32(sel(p.inside, x, K(0.0f)));
    p.y = to_u32(sel(p.inside, y, K(0.0f)));
    return p;
}

/* Of the block of 4x4 pixels that (x, y) lies in. */
FN u32 neighbour_key(CTX u32 x, u32 y) {
    u32 block = shr(y, 2) * KU(FRAME.blocks_x) + shr(x, 2);
    return rng_key(KU(FRAME.seed ^ 0x5bd1e995u), block, KU(FRAME.index));
}

/* From a pixel of that block to its neighbour, in whole pixels in x and y: evenly over a disc, never 0. dim: two
 * dimensions from there on. */
FN v3 neighbour_offset(CTX u32 key, u32 dim) {
    EXACT real radius = K(FRAME.radius) * sqrt_(rng(key, dim));
    v3 c = circle(rng(key, dim + KU(1u)));
    EXACT real dx = radius * c.x;
    EXACT real dy = radius * c.y;
    real x = nearest(dx);
    real y = nearest(dy);
    x = sel(and_(x == K(0.0f), y == K(0.0f)), K(1.0f), x);
    return V3(x, y, K(0.0f));
}

FN pixel neighbour_place(CTX u32 x, u32 y, v3 offset) {
    return pixel_of(PASS to_real(x) + offset.x, to_real(y) + offset.y);
}

/* The pixel that saw r in the previous frame. r is as it was then: what stands on a moved instance is taken back by the
 * instance's motion before. */
FN pixel history_place(CTX receiver r) {
    v3 q = camera_project(camera_of(FRAME.previous), r.p);
    pixel p = pixel_of(PASS q.x, q.y);
    p.inside = and_(p.inside, q.z > K(0.0f));
    return p;
}

/* Is b on a surface like that of a, seen from about the same distance? */
FN mask receivers_alike(CTX receiver a, receiver b) {
    real cosine = dot3(a.n, b.n);
    real off = dot3(a.n, sub3(b.p, a.p));
    mask same = and_(cosine >= K(FRAME.reject_normal), abs_(off) <= K(FRAME.reject_depth) * a.depth);
    return and_(receives(b), same);
}

#endif
