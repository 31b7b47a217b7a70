/* core/primary.h: what a camera's rays hit becomes receivers. A machine traces the ray of each pixel (frame_direction
 * of core/camera.h), loads the triangle that it hits, and has receiver_of_hit place the receiver; where the material
 * has a texture, hit_texel is the receiver's albedo. Includers supply light_load and texel_load. */
#ifndef CORE_PRIMARY_H
#define CORE_PRIMARY_H

#include "core/camera.h"
#include "core/hit.h"
#include "core/placement.h"
#include "core/receiver.h"
#include "core/reservoir.h"
#include "core/texture.h"

/* Square of the distance between the rays of two rows, 1 from the eye: of lanes 0 and 4 of the pixel's block. */
FN real rays_apart2(v3 first, v3 below) {
    v3 apart = sub3(below, first);
    return dot3(apart, apart);
}

/* Nearest hit of a ray: the triangle's corners in the mesh's coordinates, and the hit's place on it. */
struct ray_hit {
    corners at;
    real u; /* barycentric, of the second and the third corner */
    real v;
    real far_; /* distance in lengths of d */
    v3 d;      /* direction of the ray */
    u32 material;
    u32 light; /* that the triangle is of, or NO_LIGHT */
};

#ifndef CORE_GLSL
typedef struct ray_hit ray_hit;
#endif

/* The light whose emitting side is seen, or NO_LIGHT. front: the triangle's front is. A dark light and the back of a
 * one-sided one are surfaces like others. */
FN u32 light_seen(CTX u32 id, mask front) {
    mask some = id != KU(NO_LIGHT);
    u32 seen = KU(NO_LIGHT);
    if (ANY(some)) {
        light l = light_load(PASS selu(some, id, KU(0u)));
        mask side = or_(front, (l.flags & KU(LIGHT_TWO_SIDED)) != KU(0u));
        mask shines = or_(or_(l.e.x > K(0.0f), l.e.y > K(0.0f)), l.e.z > K(0.0f));
        seen = selu(and_(and_(some, side), shines), id, seen);
    }
    return seen;
}

/* placed: an instance shows the triangle, where m places it. */
FN receiver receiver_of_hit(CTX ray_hit h, mask placed, placement m) {
    receiver r;
    r.p = hit_point(h.at, h.u, h.v);
    v3 n = hit_normal(h.at);
    if (ANY(placed)) {
        r.p = sel3(placed, placed_point(m, r.p), r.p);
        n = sel3(placed, placed_normal(m, n), n);
    }
    mask front = dot3(n, h.d) < K(0.0f);
    r.n = mul3(n, sel(front, K(1.0f), K(-1.0f)));
    EXACT real depth = h.far_ * sqrt_(dot3(h.d, h.d));
    r.depth = depth;
    r.material = h.material;
    r.light = light_seen(PASS h.light, front);
    return r;
}

/* How wide a pixel is along the surface at the hit, in the corners' unit. n: the receiver's normal; apart2: of
 * rays_apart2; scale2: of placement_scale2, 1 where no instance shows the triangle. */
FN real hit_width(ray_hit h, v3 n, real apart2, real scale2) {
    real d2 = dot3(h.d, h.d);
    real toward = abs_(dot3(n, h.d));
    EXACT real least = K(0.01f) * sqrt_(d2);
    EXACT real width = h.far_ * sqrt_(apart2 * d2 / scale2) / max_(toward, least);
    return width;
}

/* Albedo at the hit as core/texel.h packs it: the material's times that of texture `place`. */
FN u32 hit_texel(CTX ray_hit h, u32 place, image_corners at, real width, v3 albedo) {
    real level = texture_level(PASS place, h.at, at, width);
    v3 a = texture_albedo(PASS place, image_at(at.u, h.u, h.v), image_at(at.v, h.u, h.v), level);
    return texel_pack(tint3(a, albedo));
}

#endif
