/* What a frame computes between rays, in the dialect test: included by dialect_kernel.h. Slots count from FRAME_FIRST.
 */
#ifndef DIALECT_FRAME_H
#define DIALECT_FRAME_H

#include "core/combine.h"
#include "core/headlight.h"
#include "core/hit.h"
#include "core/moments.h"
#include "core/neighbours.h"
#include "core/reference.h"
#include "core/shading.h"

FN frame_camera dialect_camera(float at) {
    frame_camera c;
    for (int i = 0; i < 3; i++) {
        c.eye[i] = at;
        c.right[i] = 0.0f;
        c.up[i] = 0.0f;
        c.forward[i] = 0.0f;
    }
    c.right[0] = 2.0f;
    c.up[2] = 1.5f;
    c.forward[1] = 1.0f;
    c.inv_right2 = 0.25f;
    c.inv_up2 = 1.0f / 2.25f;
    c.width = 1280.0f;
    c.height = 720.0f;
    c.jitter[0] = 0.25f;
    c.jitter[1] = 0.75f;
    return c;
}

FN frame_constants dialect_constants(uint32_t bias) {
    frame_constants f;
    f.camera = dialect_camera(0.5f);
    f.previous = dialect_camera(-3.0f);
    f.width = 1280u;
    f.height = 720u;
    f.blocks_x = 320u;
    f.seed = 5u;
    f.index = 9u;
    f.flags = FRAME_BIAS_RAYS | FRAME_EMITTERS;
    f.bias = bias;
    f.draws = 32u;
    f.list = 64u;
    f.tail = 128u;
    f.shadow_rays = 8u;
    f.uniform_every = 4u;
    f.rays = 7u;
    f.neighbours = 3u;
    f.influence = 0.0f;
    f.radius = 10.0f;
    f.m_max = 640.0f;
    f.reject_depth = 0.1f;
    f.reject_normal = 0.9f;
    f.sky = 0.02f;
    f.environment_width = 1000u;
    f.environment_height = 500u;
    f.backdrop_width = 2000u;
    f.backdrop_height = 1000u;
    f.environment_turn = 0.7f;
    f.environment_scale = 3.0f;
    f.environment_inverse_power = 0.02f;
    f.environment_level = 0.4f;
    return f;
}

/* Neighbours of the item at hand: often none. C skips those that no lane has, the shader skips none. */
FN mask neighbour_there(u32 i) { return rng(dialect_key, KU(4000u) + i) < K(0.5f); }
FN mask neighbour_on(CTX int i) { return neighbour_there(KU(U32(i))); }
#if defined(CORE_GLSL)
b1 neighbour_some(int i) { return true; }
#else
FN b1 neighbour_some(CTX int i) { return ANY(neighbour_on(PASS i)); }
#endif
FN reservoir neighbour_resv_of(CTX u32 i) {
    reservoir r;
    u32 key = hash_u32(dialect_key + KU(4100u) + i);
    mask there = neighbour_there(i);
    mask empty = or_(not_(there), rng(key, KU(0u)) < K(0.3f));
    r.light = scale_u32(rng_bits(key, KU(1u)), KU(KERNEL_LIGHTS));
    r.u = rng(key, KU(2u));
    r.v = rng(key, KU(3u));
    r.w = sel(empty, K(0.0f), rng(key, KU(4u)) * K(50.0f));
    r.m = sel(there, to_real(shr(rng_bits(key, KU(5u)), 26)), K(0.0f));
    r.p = sel(empty, K(0.0f), rng(key, KU(6u)) * K(5.0f));
    return r;
}
FN reservoir neighbour_resv(CTX int i) { return neighbour_resv_of(PASS KU(U32(i))); }
FN surf neighbour_surf(CTX int i) { return any_surf(hash_u32(dialect_key + KU(4200u + U32(i)))); }
FN real neighbour_answer(CTX int i) {
    u32 key = hash_u32(dialect_key + KU(4300u + U32(i)));
    return reuse_answer(rng(key, KU(0u)), rng(key, KU(1u)) < K(0.7f), rng(key, KU(2u)) < K(0.5f));
}

FN receiver any_receiver(u32 key) {
    receiver r;
    r.p = any_v3(key, KU(0u));
    r.n = unit3(any_v3(key, KU(6u)));
    r.depth = rng(key, KU(12u)) * K(100.0f);
    r.material = selu(rng(key, KU(13u)) < K(0.2f), KU(NO_SURFACE), KU(3u));
    r.light = KU(NO_LIGHT);
    return r;
}

FN u32 flag_of(mask m) { return selu(m, KU(1u), KU(0u)); }

FN void put_pixel(CTX u32 item, int slot, pixel p) {
    put_u32(PASS item, slot, p.x);
    put_u32(PASS item, slot + 1, p.y);
    put_u32(PASS item, slot + 2, flag_of(p.inside));
}

/* Slots 0 to 10. */
FN void places(CTX u32 item, u32 key) {
    u32 x = scale_u32(rng_bits(key, KU(4400u)), KU(1280u));
    u32 y = scale_u32(rng_bits(key, KU(4401u)), KU(720u));
    u32 of = neighbour_key(PASS x, y);
    v3 offset = neighbour_offset(PASS of, KU(64u));
    receiver a = any_receiver(hash_u32(key + KU(4402u)));
    receiver b = a;
    b.p = add3(a.p, mul3(any_v3(key, KU(4403u)), K(0.01f)));
    b.n = unit3(add3(a.n, mul3(any_v3(key, KU(4410u)), K(0.002f))));
    put_u32(PASS item, FRAME_FIRST, of);
    put_real(PASS item, FRAME_FIRST + 1, offset.x);
    put_real(PASS item, FRAME_FIRST + 2, offset.y);
    put_pixel(PASS item, FRAME_FIRST + 3, neighbour_place(PASS x, y, offset));
    put_pixel(PASS item, FRAME_FIRST + 6, history_place(PASS a));
    put_u32(PASS item, FRAME_FIRST + 9, flag_of(receivers_alike(PASS a, b)));
    put_real(PASS item, FRAME_FIRST + 10, nearest(any_real(key, KU(4420u))));
}

/* 14 slots: the sample that neighbours are asked about, and what survives; which of them is asked pairwise. */
FN void combination(CTX u32 item, int slot, u32 key, surf s, reservoir own) {
    reservoir_builder held = reuse_begin(PASS s, own, key, KU(64u), 3);
    put_u32(PASS item, slot, held.light);
    put_real(PASS item, slot + 1, held.u);
    put_real(PASS item, slot + 2, held.v);
    put_real(PASS item, slot + 3, held.p);
    put_real(PASS item, slot + 4, held.w_sum);
    put_real(PASS item, slot + 5, held.m);
    combined c = reuse_end(PASS s, own, held, key, KU(64u), 3);
    put_resv(PASS item, slot + 6, c.r);
    put_u32(PASS item, slot + 12, flag_of(c.own) + shl(reuse_partner(PASS key, KU(64u), 3), 1));
    real p = reuse_target(PASS 1, neighbour_on(PASS 1), held, light_load(PASS held.light));
    put_real(PASS item, slot + 13, sel(reuse_asks(held, 1, p), p, K(0.0f)));
}

/* Slots 11 to 60 and 121 to 134. */
FN void combinations(CTX u32 item, u32 key, surf s) {
    reservoir own = reservoir_cap(ris_uniform(PASS s, key, KU(KERNEL_LIGHTS), 8), rng(key, KU(4502u)) * K(12.0f));
    combination(PASS item, FRAME_FIRST + 11, key, s, own);
    dialect_frame.bias = BIAS_MIS;
    combination(PASS item, FRAME_FIRST + 25, key, s, own);
    dialect_frame.bias = BIAS_PAIRWISE;
    combination(PASS item, FRAME_FIRST + 39, key, s, own);
    dialect_frame.bias = BIAS_COUNTED;
    combination(PASS item, FRAME_FIRST + 121, key, s, own);
    dialect_frame.bias = BIAS_PAIRWISE;
    put_resv(PASS item, FRAME_FIRST + 53, reservoir_blocked(own, rng(key, KU(4500u)) < K(0.5f)));
    put_u32(PASS item, FRAME_FIRST + 59, flag_of(resolve_asks(own, rng(key, KU(4501u)) < K(0.5f))));
    put_real(PASS item, FRAME_FIRST + 60, neighbour_answer(PASS 0));
}

FN bool light_shines(CTX uint32_t i) { return i % 5u != 3u; }
FN light light_of_all(CTX uint32_t i) { return any_light(hash_u32(KU(i) + KU(77u))); }
FN void sum_put(CTX uint32_t chunk, real x) { dialect_sums[chunk] = x; }
FN real sum_load(CTX uint32_t chunk) { return dialect_sums[chunk]; }
FN void entry_put(CTX mask on, uint32_t i, real w) {
    dialect_weight = dialect_weight + sel(on, w, K(0.0f));
    dialect_entries = selu(on, hash_u32(dialect_entries + KU(i)), dialect_entries);
}

/* Slots 61 to 64. */
FN void references(CTX u32 item, u32 key, surf s) {
    dialect_weight = K(0.0f);
    dialect_entries = KU(0u);
    reference_entries(PASS s, key, 40u);
    put_real(PASS item, FRAME_FIRST + 61, dialect_weight);
    put_u32(PASS item, FRAME_FIRST + 62, dialect_entries);
    reference_entries(PASS s, key, FRAME.rays);
    put_real(PASS item, FRAME_FIRST + 63, dialect_weight);
    put_u32(PASS item, FRAME_FIRST + 64, dialect_entries);
}

/* Slots 65 to 80. */
FN void shades(CTX u32 item, u32 key, surf s) {
    reservoir r = ris_uniform(PASS s, key, KU(KERNEL_LIGHTS), 4);
    v3 c = sample_shade(PASS s, r, light_load(PASS r.light));
    put_v3(PASS item, FRAME_FIRST + 65, c);
    u32 turns = sky_turns(PASS mul3(c, K(1e-3f)));
    put_u32(PASS item, FRAME_FIRST + 68, turns);
    segment ray = sky_ray(PASS s, key, item, K(1e-4f));
    put_v3(PASS item, FRAME_FIRST + 69, ray.d);
    v3 sky = sky_shade(PASS s, ray.d, K(1.0f) / to_real(turns));
    put_v3(PASS item, FRAME_FIRST + 72, sky);
    put_v3(PASS item, FRAME_FIRST + 75,
           sky_behind(PASS shr(rng_bits(key, KU(4600u)), 22), shr(rng_bits(key, KU(4601u)), 23)));
    moments m = moments_add(moments_none(), rng(key, KU(4602u)), K(1.0f));
    m = moments_add(m, rng(key, KU(4603u)), K(2.0f));
    m = moments_add(m, rng(key, KU(4604u)), K(3.0f));
    put_real(PASS item, FRAME_FIRST + 78, m.squares);
    put_real(PASS item, FRAME_FIRST + 79, mean_add(m.mean, rng(key, KU(4605u)), K(0.25f)));
    put_u32(PASS item, FRAME_FIRST + 80, flag_of(colour_finite(mul3(c, K(1e29f)))));
}

/* Slots 91 to 117: the sky's light and the background where a map is around the scene. */
FN void environments(CTX u32 item, u32 key, surf s) {
    v3 d = unit3(any_v3(key, KU(4800u)));
    v3 at = environment_place(d, K(FRAME.environment_turn));
    put_real(PASS item, FRAME_FIRST + 91, at.x);
    put_real(PASS item, FRAME_FIRST + 92, at.y);
    put_v3(PASS item, FRAME_FIRST + 93, environment_direction(at.x, d.z, K(FRAME.environment_turn)));
    put_u32(PASS item, FRAME_FIRST + 96, environment_cell(at.x, KU(777u)));
    v3 radiance = environment_radiance(PASS d);
    put_v3(PASS item, FRAME_FIRST + 97, radiance);
    put_v3(PASS item, FRAME_FIRST + 100,
           environment_draw(PASS rng_bits(key, KU(4810u)), rng(key, KU(4811u)), rng_bits(key, KU(4812u))));
    put_v3(PASS item, FRAME_FIRST + 103, environment_ray(PASS s, key, item));
    put_real(PASS item, FRAME_FIRST + 106, environment_ray_density(PASS s, d, radiance));
    put_v3(PASS item, FRAME_FIRST + 107, environment_backdrop(PASS d));
    dialect_frame.flags = FRAME_ENVIRONMENT | FRAME_MAP_LIGHTS;
    u32 turns = sky_turns(PASS mul3(radiance, K(0.4f)));
    put_u32(PASS item, FRAME_FIRST + 110, turns);
    segment ray = sky_ray(PASS s, key, item, K(1e-4f));
    put_real(PASS item, FRAME_FIRST + 111, ray.d.z);
    put_v3(PASS item, FRAME_FIRST + 112, sky_shade(PASS s, ray.d, K(1.0f) / to_real(turns)));
    put_v3(PASS item, FRAME_FIRST + 115,
           sky_behind(PASS shr(rng_bits(key, KU(4600u)), 22), shr(rng_bits(key, KU(4601u)), 23)));
    put_v3(PASS item, FRAME_FIRST + 118, headlight_shade(s, rng(key, KU(4820u)) * K(900.0f), K(FRAME.sky)));
    dialect_frame.flags = FRAME_BIAS_RAYS | FRAME_EMITTERS;
}

/* Slots 81 to 86. */
FN void triangles_hit(CTX u32 item, u32 key) {
    corners t;
    t.a = any_v3(key, KU(4700u));
    t.b = any_v3(key, KU(4710u));
    t.c = add3(t.b, mul3(any_v3(key, KU(4720u)), K(1e-3f)));
    put_v3(PASS item, FRAME_FIRST + 81, hit_point(t, rng(key, KU(4730u)), rng(key, KU(4731u))));
    put_v3(PASS item, FRAME_FIRST + 84, hit_normal(t));
}

/* Slots 87 to 90. */
FN void emitters(CTX u32 item, u32 key) {
    mask some = rng(key, KU(4800u)) < K(0.5f);
    u32 id = selu(some, scale_u32(rng_bits(key, KU(4801u)), KU(KERNEL_LIGHTS)), KU(NO_LIGHT));
    v3 shown = emitter_shade(PASS id);
    dialect_frame.flags = dialect_frame.flags & ~FRAME_EMITTERS;
    put_v3(PASS item, FRAME_FIRST + 87, sub3(shown, emitter_shade(PASS id)));
    put_u32(PASS item, FRAME_FIRST + 90, flag_of(sees_emitter(id)));
}

CALL void frame_item(CTX u32 item, u32 key, surf s) {
    dialect_frame = dialect_constants(BIAS_BIASED);
    dialect_key = key;
    places(PASS item, key);
    combinations(PASS item, key, s);
    references(PASS item, key, s);
    shades(PASS item, key, s);
    triangles_hit(PASS item, key);
    emitters(PASS item, key);
    environments(PASS item, key, s);
}

#endif
