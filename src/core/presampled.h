/* core/presampled.h: candidates that blocks of pixels share, drawn before a frame and kept side by side in memory
 * (after Wyman and Panteleev 2021, "Rearchitecting Spatiotemporal Resampling for Production").
 *
 * A frame has subsets of 16 M samples (light, u, v), each of which its picker drew with a known probability. A block of
 * 4x4 pixels takes one of the subsets at random, and each of its pixels M samples of that, no two the same. So pixels
 * near each other have different candidates, as if each had drawn its own, but for blocks that took the same subset.
 * A subset's samples are stratified over the lights in their order, and a pixel's over the subset: candidate i is one
 * of samples 16 i to 16 i + 15, any of them alike, whatever was drawn, so that sum(f / pmf) / M is unbiased.
 *
 * What chooses among candidates need not be exact: it is the target of a sample's place (flat lights, points) or of the
 * light's middle (spheres), with an inverse root by Newton's step and a glossy lobe without roots (core/list_sketch.h).
 * The target itself takes its place where they differ: from close by, where a sphere crosses the horizon or is wider
 * than the lobe, for spots, and for lights with a profile. The sample that is chosen is evaluated in full, and its W is
 * made of the very weights that chose it. */
#ifndef CORE_PRESAMPLED_H
#define CORE_PRESAMPLED_H

#include "core/alias.h"
#include "core/given.h"
#include "core/list_sketch.h"
#include "core/presample_limits.h"

/* A sample of a light, as surfaces look at it from afar. */
struct presample {
    v3 x;        /* its place, or a sphere's middle */
    v3 normal;   /* of flat lights, the dark side's; as long as the light's area, m2 */
    v3 shine;    /* parts of luminance in cd/m2, by channel; points: cd */
    real bare;   /* instead of area * cosine: points 1, spheres their disc's area, flat lights 0 */
    real sided;  /* the cosine on the dark side counts so often: 0, or -1 where both sides shine */
    real close2; /* m2: nearer than its root the target is asked */
    real radius; /* of spheres, else 0 */
};

/* The sample itself. */
struct presample_pick {
    u32 light;
    u32 place; /* u, v: unit_low, unit_high */
    real inverse;
};

/* What a surface gets of it, about; near: ask the target instead. */
struct presample_steer {
    real p;
    mask near;
};

#ifndef CORE_GLSL
typedef struct presample presample;
typedef struct presample_pick presample_pick;
typedef struct presample_steer presample_steer;
#endif

/* Candidate i of the pixels at hand: the sample in brief, 1 / pmf, and all of it. */
FN presample presample_load(CTX int i);
FN real presample_inverse(CTX int i);
FN presample_pick presample_pick_load(CTX u32 i);
/* Sums of the weights of candidates 0 to i: of ris_presampled alone. */
FN void weighed_store(CTX int i, real sum);
FN real weighed_load(CTX int i);
FN real weighed_at(CTX u32 i);

/* ---- a frame's samples ---- */

/* Bits that choose sample i of n: anywhere in an even share of their own of all numbers, which begin anywhere. */
FN1 u1 presample_share(u1 n) { return 0xffffffffu / n; }
FN u32 presample_bits(u1 key, u32 i, u1 share) {
    return KU(hash_u1(key)) + i * KU(share) + scale_u32(rng_bits(KU(key), KU(3u) * i + KU(1u)), KU(share));
}
FN real presample_choice(u1 key, u32 i) { return rng(KU(key), KU(3u) * i + KU(2u)); } /* for who needs one more */
FN u32 presample_place(u1 key, u32 i) { return rng_bits(KU(key), KU(3u) * i + KU(3u)); }

/* Sample i of n, of `count` lights alike. */
FN presample_pick presample_draw(u1 key, u32 i, u1 n, u1 count) {
    presample_pick k;
    k.light = scale_u32(presample_bits(key, i, presample_share(n)), KU(count));
    k.place = presample_place(key, i);
    k.inverse = K(F32(count));
    return k;
}

/* Sample i of n, by power. slots: of the alias table; 0: no light shines. */
FN presample_pick presample_draw_power(CTX u1 key, u32 i, u1 n, u1 slots) {
    presample_pick k;
    k.light = KU(0u);
    k.place = presample_place(key, i);
    k.inverse = K(0.0f);
    if (slots > 0u) {
        pick p = alias_draw(PASS KU(slots), presample_bits(key, i, presample_share(n)), presample_choice(key, i));
        k.light = p.light;
        k.inverse = p.inverse;
    }
    return k;
}

/* Rank of sample i: those whose target is always evaluated go last, so that they are candidates of the same numbers.
 * plain: presample_plain of its light; before: plain samples among the i before it; all: plain samples of the subset.
 */
FN u32 presample_rank(mask plain, u32 i, u32 before, u1 all) { return selu(plain, before, KU(all) + (i - before)); }

/* Where in its subset the sample of rank i goes, of 16 that are candidates of the same number: one turn for all of the
 * subset. */
FN1 u1 presample_turn(u1 key) { return shr(hash_u1(key ^ 0x5bd1e995u), 28); }
FN u32 presample_turned(u1 key, u32 i) { return (i & KU(0xfffffff0u)) | ((i + KU(presample_turn(key))) & KU(15u)); }
/* Which sample is at that lane of that row of 16. */
FN u32 presample_at(u1 key, u1 row, u32 lane) { return KU(row * 16u) + ((lane - KU(presample_turn(key))) & KU(15u)); }

/* Has it a brief form at all? Else the target is always asked. */
FN mask presample_plain(light l) { return not_(or_(l.kind == KU(LIGHT_SPOT), profile_of(l) != KU(0u))); }

FN presample presample_of(light l, real u, real v) {
    presample e;
    mask disc = l.kind == KU(LIGHT_DISC);
    mask tri = l.kind == KU(LIGHT_TRIANGLE);
    mask sphere = l.kind == KU(LIGHT_SPHERE);
    mask point = is_point(l);
    mask round = or_(sphere, point);
    mask fold = and_(tri, (u + v) > K(1.0f));
    real su = sel(fold, K(1.0f) - u, u);
    real sv = sel(fold, K(1.0f) - v, v);
    if (ANY(disc)) {
        v3 cs = circle(v);
        real r = sqrt_(u);
        su = sel(disc, r * cs.x, su);
        sv = sel(disc, r * cs.y, sv);
    }
    su = sel(round, K(0.0f), su);
    sv = sel(round, K(0.0f), sv);
    EXACT real x = l.p.x + (l.a.x * su + l.b.x * sv);
    EXACT real y = l.p.y + (l.a.y * su + l.b.y * sv);
    EXACT real z = l.p.z + (l.a.z * su + l.b.z * sv);
    e.x = V3(x, y, z);
    real share = sel(round, K(0.0f), sel(disc, K(CORE_PI), sel(tri, K(0.5f), K(1.0f))));
    e.normal = mul3(cross3(l.a, l.b), share);
    EXACT real cut = K(CORE_PI) * l.radius * l.radius;
    e.bare = sel(sphere, cut, sel(point, K(1.0f), K(0.0f)));
    EXACT real red = l.e.x * K(0.2126f);
    EXACT real green = l.e.y * K(0.7152f);
    EXACT real blue = l.e.z * K(0.0722f);
    e.shine = V3(red, green, blue);
    e.sided = sel((l.flags & KU(LIGHT_TWO_SIDED)) != KU(0u), K(-1.0f), K(0.0f));
    v3 off = sub3(e.x, l.p); /* whether a light is close is asked from its corner */
    EXACT real reach = l.radius * sel(disc, K(LIGHT_CLOSE_DISC), K(LIGHT_CLOSE)) + sqrt_(dot3(off, off));
    EXACT real close2 = reach * reach * K(1.0001f);
    close2 = sel(round, K(0.0f), close2);
    e.close2 = sel(presample_plain(l), close2, K(1e37f));
    e.radius = sel(sphere, l.radius, K(0.0f));
    return e;
}

/* ---- a pixel's candidates ---- */

/* Its target, about. 0 only where the target is, or is asked. */
FN presample_steer presample_look(surf s, sketch_surf q, presample e) {
    v3 d = sub3(e.x, s.p);
    EXACT real d2 = max_(dot3(d, d), K(1e-12f));
    real inv = quick_inverse_root(d2);
    EXACT real facing = K(0.0f) - dot3(e.normal, d);
    facing = max_(facing, facing * e.sided);
    real above = dot3(s.n, d);
    presample_steer p;
    p.near = or_(or_(d2 < e.close2, d2 < q.reach * (e.radius * e.radius)), abs_(above) < e.radius);
    EXACT real f = e.shine.x * q.tint.x + e.shine.y * q.tint.y + e.shine.z * q.tint.z;
    if (ANY(q.shiny)) {
        EXACT real better = inv * (K(1.5f) - K(0.5f) * d2 * inv * inv); /* lobes are narrow */
        v3 wi = mul3(d, better);
        real n_wi = above * better;
        real nl = max_(n_wi, K(0.0f));
        real ci = K(1.0f) - nl;
        EXACT real diffuse = f * q.matte * (K(1.0f) - q.k * (ci * ci * ci));
        EXACT real both = diffuse + (e.shine.x + e.shine.y + e.shine.z) * sketch_gloss(s, q, wi, n_wi, nl);
        f = sel(q.shiny, both, f);
    }
    EXACT real inv2 = inv * inv;
    EXACT real got = (facing * inv + e.bare) * (max_(above, K(0.0f)) * inv) * inv2 * f;
    p.p = sel(got > K(0.0f), min_(got, K(1e30f)), K(0.0f));
    return p;
}

/* What chooses candidate i of the pixel: its target, about, over its pmf, added to the weights before. */
FN real presample_sum(CTX surf s, sketch_surf q, real before, int i) {
    presample_steer c = presample_look(s, q, presample_load(PASS i));
    if (SELDOM(ANY(c.near))) {
        presample_pick k = presample_pick_load(PASS KU(U32(i)));
        c.p = sel(c.near, target(PASS s, light_load(PASS k.light), unit_low(k.place), unit_high(k.place)), c.p);
    }
    EXACT real sum = before + c.p * presample_inverse(PASS i);
    return sum;
}

/* The reservoir of candidate `chosen` of m, of which one was chosen by weights of this sum, its own as it was added. */
FN reservoir presample_reservoir(CTX surf s, u32 chosen, real weight, real sum, int m) {
    presample_pick k = presample_pick_load(PASS chosen);
    reservoir r;
    r.light = k.light;
    r.u = unit_low(k.place);
    r.v = unit_high(k.place);
    r.m = K(F32(m));
    r.p = target(PASS s, light_load(PASS r.light), r.u, r.v);
    mask some = and_(weight > K(0.0f), r.p > K(0.0f));
    EXACT real w = sum * k.inverse / (K(F32(m)) * sel(some, weight, K(1.0f)));
    r.w = sel(and_(some, w < K(1e30f)), w, K(0.0f));
    return r;
}

/* Streaming RIS over candidates 0 to m - 1, without the stream: their sums are kept, and one number chooses.
 * W = (1/m) sum(w) / (w(chosen) pmf(chosen)), w what chose, over pmf. xi: in [0, 1). */
FN reservoir ris_presampled(CTX surf s, real xi, int m) {
    sketch_surf q = sketch_surf_of(s);
    real sum = K(0.0f);
    for (int i = 0; i < m; i++) {
        sum = presample_sum(PASS s, q, sum, i);
        weighed_store(PASS i, sum);
    }
    EXACT real goal = xi * sum;
    u32 chosen = KU(0u);
    for (int i = 0; i < m - 1; i++)
        chosen = chosen + selu(weighed_load(PASS i) <= goal, KU(1u), KU(0u));
    real before = sel(chosen > KU(0u), weighed_at(PASS selu(chosen > KU(0u), chosen - KU(1u), KU(0u))), K(0.0f));
    EXACT real weight = weighed_at(PASS chosen) - before; /* as it was chosen, to the bit */
    return presample_reservoir(PASS s, chosen, weight, sum, m);
}

/* The same bits where there is no room for the sums: they are added up again as far as the number that chooses. */
FN reservoir ris_presampled_twice(CTX surf s, real xi, int m) {
    sketch_surf q = sketch_surf_of(s);
    real sum = K(0.0f);
    for (int i = 0; i < m; i++)
        sum = presample_sum(PASS s, q, sum, i);
    EXACT real goal = xi * sum;
    u32 chosen = KU(0u);
    real before = K(0.0f);
    real weight = K(0.0f);
    for (int i = 0; i < m; i++) {
        mask on = or_(KU(U32(i)) == KU(0u), before <= goal);
        if (ANY(on)) {
            real after = presample_sum(PASS s, q, before, i);
            EXACT real w = after - before;
            chosen = selu(on, KU(U32(i)), chosen);
            weight = sel(on, w, weight);
            before = sel(on, after, before);
        }
    }
    return presample_reservoir(PASS s, chosen, weight, sum, m);
}

#endif
