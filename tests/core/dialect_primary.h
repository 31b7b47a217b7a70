/* What camera rays hit, in the dialect test: slots from PRIMARY_FIRST on. Included after dialect_textures.h. */
#ifndef DIALECT_PRIMARY_H
#define DIALECT_PRIMARY_H

#include "core/facade.h"
#include "core/primary.h"

FN ray_hit any_hit(u32 key) {
    ray_hit h;
    h.at.a = any_v3(key, KU(5000u));
    h.at.b = add3(h.at.a, any_v3(key, KU(5010u)));
    h.at.c = add3(h.at.a, any_v3(key, KU(5020u)));
    h.u = rng(key, KU(5030u)) * K(0.5f);
    h.v = rng(key, KU(5031u)) * K(0.5f);
    h.far_ = rng(key, KU(5032u)) * K(300.0f);
    h.d = any_v3(key, KU(5033u));
    h.material = KU(3u);
    h.light = selu(rng(key, KU(5039u)) < K(0.6f), shr(rng_bits(key, KU(5040u)), 22), KU(NO_LIGHT));
    return h;
}

/* A turn about an axis between z and x, times a scale. */
FN placement any_placement(u32 key) {
    placement m;
    v3 z = unit3(add3(any_v3(key, KU(5050u)), V3(K(0.0f), K(0.0f), K(1e-3f))));
    v3 x = unit3(cross3(V3(K(0.0f), K(1.0f), K(0.0f)), z));
    real scale = K(0.25f) + rng(key, KU(5056u)) * K(3.0f);
    m.x = mul3(x, scale);
    m.y = mul3(cross3(z, x), scale);
    m.z = mul3(z, scale);
    m.at = any_v3(key, KU(5060u));
    return m;
}

/* Slots 22 and 23: of places in and around a grid, and around a window. */
FN void windows_in_walls(CTX u32 item, u32 key) {
    facade_grid f;
    f.origin = any_v3(key, KU(5120u));
    f.along = mul3(unit3(any_v3(key, KU(5130u))), K(0.4f));
    f.up = mul3(unit3(any_v3(key, KU(5140u))), K(0.3f));
    f.first = shr(rng_bits(key, KU(5150u)), 12);
    f.columns = KU(1u) + shr(rng_bits(key, KU(5151u)), 27);
    f.rows = KU(1u) + shr(rng_bits(key, KU(5152u)), 28);
    v3 off = mul3(any_v3(key, KU(5153u)), K(0.5f));
    put_u32(PASS item, PRIMARY_FIRST + 22, facade_cell(f, add3(f.origin, off)));
    v3 a = any_v3(key, KU(5160u));
    v3 b = any_v3(key, KU(5170u));
    real s = rng(key, KU(5180u)) * K(2.0f) - K(0.5f);
    real t = rng(key, KU(5181u)) * K(2.0f) - K(0.5f);
    v3 p = add3(f.origin, add3(mul3(a, s), mul3(b, t)));
    put_u32(PASS item, PRIMARY_FIRST + 23, selu(window_covers(f.origin, a, b, p), KU(1u), KU(0u)));
}

/* Slots 0 to 21. */
CALL void primaries(CTX u32 item, u32 key) {
    ray_hit h = any_hit(key);
    placement m = any_placement(key);
    mask placed = rng(key, KU(5070u)) < K(0.5f);
    receiver r = receiver_of_hit(PASS h, placed, m);
    put_v3(PASS item, PRIMARY_FIRST, r.p);
    put_v3(PASS item, PRIMARY_FIRST + 3, r.n);
    put_real(PASS item, PRIMARY_FIRST + 6, r.depth);
    put_u32(PASS item, PRIMARY_FIRST + 7, r.light);
    u32 x = scale_u32(rng_bits(key, KU(5071u)), KU(1280u));
    u32 y = scale_u32(rng_bits(key, KU(5072u)), KU(720u));
    v3 d = frame_direction(PASS x, y);
    put_real(PASS item, PRIMARY_FIRST + 8, d.x);
    put_real(PASS item, PRIMARY_FIRST + 9, d.z);
    real apart2 = rays_apart2(d, frame_direction(PASS x, y + KU(1u)));
    put_real(PASS item, PRIMARY_FIRST + 10, apart2);
    real scale2 = sel(placed, placement_scale2(m), K(1.0f));
    put_real(PASS item, PRIMARY_FIRST + 11, scale2);
    real width = hit_width(h, r.n, apart2, scale2);
    put_real(PASS item, PRIMARY_FIRST + 12, width);
    image_corners at;
    at.u = any_v3(key, KU(5080u));
    at.v = any_v3(key, KU(5090u));
    v3 albedo = V3(rng(key, KU(5100u)), rng(key, KU(5101u)), rng(key, KU(5102u)));
    u32 place = scale_u32(rng_bits(key, KU(5103u)), KU(64u)) * KU(TEXTURE_HEAD);
    u32 texel = hit_texel(PASS h, place, at, width, albedo);
    put_u32(PASS item, PRIMARY_FIRST + 13, texel);
    surf_material of;
    of.albedo = albedo;
    of.f0 = rng(key, KU(5104u));
    of.alpha = rng(key, KU(5105u));
    texel = selu(rng(key, KU(5106u)) < K(0.5f), texel, KU(0u));
    surf s = surf_of_receiver(r.p, r.n, any_v3(key, KU(5110u)), of, texel, false);
    put_v3(PASS item, PRIMARY_FIRST + 14, s.wo);
    put_v3(PASS item, PRIMARY_FIRST + 17, s.albedo);
    put_real(PASS item, PRIMARY_FIRST + 20, s.f0);
    put_u32(PASS item, PRIMARY_FIRST + 21, receiver_sel(receives(r), r, receiver_none()).light);
    windows_in_walls(PASS item, key);
}

#endif
