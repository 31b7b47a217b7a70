/* core/list_scores.h: how strongly lights could shine on a tile: the tile's surfaces as patches with tight bounds, and
 * scores of nodes and of lights, the root of the mean square over the patches of what they could give there. That is
 * the density with the least variance for the tile's pixels (Cauchy-Schwarz), where scores are exact: a light that is
 * strong in a corner of the tile only is not forgotten, as it is where it counts by its mean, or by a bound of the
 * whole tile.
 *
 * A tile is up to 16 blocks of 4x4 pixels; pixel `place` of a block is at column place & 3, row place >> 2. Nodes and
 * lights are told in light/clusters.h; `part`: of which of its hierarchies (core/list_build.h). */
#ifndef CORE_LIST_SCORES_H
#define CORE_LIST_SCORES_H

#include "core/cones.h"
#include "core/list_groups.h"

/* The surface that a pixel sees. */
struct list_point {
    f3 p;
    f3 n;
    f1 depth;
    u1 material;
};

struct list_material {
    f3 albedo;
    f1 f0;
    f1 alpha;
};

/* Some neighbouring surfaces of a tile. */
struct list_patch {
    f3 c;
    f1 radius;
    f3 axis;
    f1 spread;      /* core/cones.h */
    f1 share;       /* root of its share of the tile's pixels */
    f1 reflectance; /* from lux to cd/m2, about, times share */
    f3 wo;          /* from its centre to the eye */
    f1 gloss;       /* what multiplies the lobe of its first surface, taken for all */
    f1 alpha2;      /* that lobe's alpha^2 */
};

/* Bounds of LANES nodes. */
struct list_node {
    v3 c;
    real radius;
    v3 axis;
    real cos_cone;
    real sin_cone;
    real power;
};

/* Lights of a cluster in brief: noc_light_block. */
struct list_brief {
    u32 place;
    u32 shine;
};

/* A cluster: where its lights are told to be, and what they add up to. */
struct list_cluster {
    f3 c;
    f1 radius;
    f1 power;
};

#ifndef CORE_GLSL
typedef struct list_point list_point;
typedef struct list_material list_material;
typedef struct list_patch list_patch;
typedef struct list_node list_node;
typedef struct list_brief list_brief;
typedef struct list_cluster list_cluster;
#endif

FN u1 tile_pixels(CTX u1 block); /* bits: pixels of the block that see a surface */
FN list_point tile_point(CTX u1 block, u1 place);
FN list_material list_material_load(CTX u1 material);
FN void piece_store(CTX u1 i, u1 pixels); /* piece i: pixels of block i / 2 that make a patch */
FN u1 piece_load(CTX u1 i);
FN void patch_store(CTX u1 i, list_patch t);
FN list_patch patch_load(CTX u1 i);
FN list_node node_load(CTX u1 part, u1 level, u1 block, int l); /* nodes l to l + LANES - 1 of a block of 16 */
FN list_brief brief_load(CTX u1 part, u1 cluster, int l);
FN list_cluster cluster_load(CTX u1 part, u1 cluster);

/* ---- patches ---- */

/* The lobe about the mirrored eye: Fresnel's term and the slope of the view are those of the patch's own normal. */
FN list_patch bound_gloss(list_material m, list_patch t) {
    f1 nv = min1(max1(dot1(t.axis, t.wo), 0.05f), 1.0f);
    f1 away = 1.0f - nv;
    f1 away2 = away * away;
    if (m.f0 > 0.0f) {
        EXACT f1 fresnel = m.f0 + (1.0f - m.f0) * away2 * away2 * away;
        EXACT f1 gloss = fresnel * CORE_INV_PI / (4.0f * nv);
        t.gloss = gloss;
        t.alpha2 = m.alpha * m.alpha;
    }
    return t;
}

/* Sphere, cone of normals and reflectance of some pixels of a block. share: pixels, so far; not yet a factor. */
FN list_patch bound_patch(CTX u1 block, u1 pixels, f3 eye) {
    f3 lo = F3(1e38f, 1e38f, 1e38f);
    f3 hi = F3(-1e38f, -1e38f, -1e38f);
    f3 n = F3(0.0f, 0.0f, 0.0f);
    f1 reflected = 0.0f;
    f1 far = 0.0f;
    f1 cone = 1.0f;
    list_patch t;
    for (u1 bits = pixels; bits != 0u; bits = bits & (bits - 1u)) {
        list_point q = tile_point(PASS block, low_bit(bits));
        f3 albedo = list_material_load(PASS q.material).albedo;
        lo = F3(min1(q.p.x, lo.x), min1(q.p.y, lo.y), min1(q.p.z, lo.z));
        hi = F3(max1(q.p.x, hi.x), max1(q.p.y, hi.y), max1(q.p.z, hi.z));
        n = F3(n.x + q.n.x, n.y + q.n.y, n.z + q.n.z);
        EXACT f1 more = reflected + (0.2126f * albedo.x + 0.7152f * albedo.y + 0.0722f * albedo.z);
        reflected = more;
    }
    EXACT f1 reflectance = CORE_INV_PI * (reflected / F32(bit_count(pixels)) + 0.02f);
    t.reflectance = reflectance;
    EXACT f1 len = sqrt1(dot1(n, n));
    t.c = F3(0.5f * (lo.x + hi.x), 0.5f * (lo.y + hi.y), 0.5f * (lo.z + hi.z));
    t.axis = F3(0.0f, 0.0f, 0.0f);
    if (len > 1e-3f) {
        EXACT f1 ax = n.x / len;
        EXACT f1 ay = n.y / len;
        EXACT f1 az = n.z / len;
        t.axis = F3(ax, ay, az);
    }
    f3 wo = F3(eye.x - t.c.x, eye.y - t.c.y, eye.z - t.c.z);
    EXACT f1 way = sqrt1(dot1(wo, wo)) + 1e-10f;
    EXACT f1 wx = wo.x / way;
    EXACT f1 wy = wo.y / way;
    EXACT f1 wz = wo.z / way;
    t.wo = F3(wx, wy, wz);
    for (u1 bits = pixels; bits != 0u; bits = bits & (bits - 1u)) {
        list_point q = tile_point(PASS block, low_bit(bits));
        f3 d = F3(q.p.x - t.c.x, q.p.y - t.c.y, q.p.z - t.c.z);
        far = max1(dot1(d, d), far);
        cone = min1(dot1(q.n, t.axis), cone);
    }
    cone = cone - 1e-4f;
    EXACT f1 radius = sqrt1(far) * 1.0001f + 1e-4f;
    t.radius = radius;
    t.spread = 2.0f;
    if (cone > 0.0f) {
        EXACT f1 spread = sqrt1(1.0f - cone * cone);
        t.spread = spread;
    }
    t.share = F32(bit_count(pixels));
    t.gloss = 0.0f;
    t.alpha2 = 1.0f;
    return bound_gloss(list_material_load(PASS tile_point(PASS block, low_bit(pixels)).material), t);
}

/* Pixels that lie in front, where a block sees an edge with something far behind; 0: all lie at about one depth. */
FN u1 pixels_in_front(CTX u1 block, u1 pixels) {
    f1 near = 1e38f;
    f1 far = 0.0f;
    u1 front = 0u;
    for (u1 bits = pixels; bits != 0u; bits = bits & (bits - 1u)) {
        f1 d = tile_point(PASS block, low_bit(bits)).depth;
        near = min1(d, near);
        far = max1(d, far);
    }
    if (far > 1.05f * near)
        for (u1 bits = pixels; bits != 0u; bits = bits & (bits - 1u))
            if (tile_point(PASS block, low_bit(bits)).depth < 0.5f * (near + far))
                front = front | 1u << low_bit(bits);
    return front;
}

/* Blocks that follow each other share one patch where they face alike (a cosine of at least) and it is no wider than
 * lamps are high (m, its radius at most): scoring costs by the patch. */
#define PATCH_FACING 0.95f
#define PATCH_RADIUS 1.0f

FN1 f1 distance1(f3 a, f3 b) {
    f3 d = F3(a.x - b.x, a.y - b.y, a.z - b.z);
    EXACT f1 far = sqrt1(dot1(d, d));
    return far;
}

/* Whether two patches may be one. */
FN1 b1 patches_alike(list_patch a, list_patch b) {
    EXACT f1 wide = distance1(a.c, b.c) + a.radius + b.radius;
    return dot1(a.axis, b.axis) >= PATCH_FACING && max1(a.spread, b.spread) <= 0.5f && a.alpha2 == b.alpha2 &&
           wide <= 2.0f * PATCH_RADIUS;
}

/* The sine of the angle between two directions, and a little. */
FN1 f1 sine_between(f3 a, f3 b) {
    EXACT f1 x = a.y * b.z - a.z * b.y;
    EXACT f1 y = a.z * b.x - a.x * b.z;
    EXACT f1 z = a.x * b.y - a.y * b.x;
    EXACT f1 sine = sqrt1(x * x + y * y + z * z) + 1e-4f;
    return sine;
}

FN1 f3 unit1(f3 a) {
    EXACT f1 len = sqrt1(dot1(a, a)) + 1e-10f;
    EXACT f1 x = a.x / len;
    EXACT f1 y = a.y / len;
    EXACT f1 z = a.z / len;
    return F3(x, y, z);
}

FN1 f1 mean1(f1 a, f1 b, f1 share) {
    EXACT f1 x = a + (b - a) * share;
    return x;
}

FN1 f3 mean3(f3 a, f3 b, f1 share) {
    return F3(mean1(a.x, b.x, share), mean1(a.y, b.y, share), mean1(a.z, b.z, share));
}

/* Around two patches that are alike. share: pixels, so far. */
FN1 list_patch join_patches(list_patch a, list_patch b, f3 eye) {
    list_patch t = a;
    EXACT f1 apart = distance1(a.c, b.c) + 1e-10f;
    EXACT f1 radius = max1(max1(0.5f * (apart + a.radius + b.radius), a.radius), b.radius);
    EXACT f1 along = min1(max1((radius - a.radius) / apart, 0.0f), 1.0f);
    EXACT f1 of_b = b.share / (a.share + b.share);
    t.c = mean3(a.c, b.c, along);
    EXACT f1 wide = max1(distance1(a.c, t.c) + a.radius, distance1(b.c, t.c) + b.radius) * 1.0001f;
    t.radius = wide; /* around the centre as it was rounded */
    t.axis = unit1(mean3(a.axis, b.axis, of_b));
    /* sin(a + b) <= sin(a) + sin(b) */
    EXACT f1 spread_a = a.spread + sine_between(t.axis, a.axis);
    EXACT f1 spread_b = b.spread + sine_between(t.axis, b.axis);
    t.spread = max1(spread_a, spread_b);
    t.share = a.share + b.share;
    t.reflectance = mean1(a.reflectance, b.reflectance, of_b);
    t.gloss = mean1(a.gloss, b.gloss, of_b);
    t.wo = unit1(F3(eye.x - t.c.x, eye.y - t.c.y, eye.z - t.c.z));
    return t;
}

/* Stores a patch of so many (its share) of all pixels. */
FN1 void patch_finish(CTX u1 i, list_patch t, f1 all) {
    EXACT f1 share = sqrt1(t.share / all);
    t.share = share;
    t.reflectance = t.reflectance * share;
    t.gloss = t.gloss * share;
    patch_store(PASS i, t);
}

/* Joins the pieces that follow each other and are alike. Returns the number of patches. */
FN1 u1 join_pieces(CTX u1 pieces, f3 eye) {
    u1 all = 0u;
    u1 count = 0u;
    list_patch held; /* the last one, which others may join; none: nothing is held yet */
    b1 none = true;
    for (u1 i = 0u; i < pieces; i++)
        all = all + bit_count(piece_load(PASS i));
    for (u1 i = 0u; i < pieces; i++)
        if (piece_load(PASS i) != 0u) {
            list_patch t = patch_load(PASS i);
            if (!none && patches_alike(held, t)) {
                held = join_patches(held, t, eye);
            } else {
                if (!none) {
                    patch_finish(PASS count, held, F32(all));
                    count++;
                }
                held = t;
                none = false;
            }
        }
    if (!none) {
        patch_finish(PASS count, held, F32(all));
        count++;
    }
    return count;
}

/* Makes the patches of a tile of so many blocks, from two pieces a block. Returns how many. */
CALL u1 make_patches(CTX u1 blocks, f3 eye) {
    EACH_INDEX(b, blocks) {
        u1 pixels = tile_pixels(PASS b);
        u1 front = pixels_in_front(PASS b, pixels);
        for (u1 i = 0u; i < 2u; i++) {
            u1 piece = front;
            if (i == 1u)
                piece = pixels & ~front;
            piece_store(PASS 2u * b + i, piece);
            if (piece != 0u)
                patch_store(PASS 2u * b + i, bound_patch(PASS b, piece, eye));
        }
    }
    SETTLE;
    u1 count = 0u;
    if (FIRST_WORKER)
        count = join_pieces(PASS 2u * blocks, eye);
    return FROM_FIRST(count);
}

FN cone_bound patch_bound(list_patch t) {
    cone_bound b;
    b.c = spread3(t.c);
    b.radius = K(t.radius);
    b.axis = spread3(t.axis);
    b.spread = K(t.spread);
    return b;
}

/* ---- nodes ---- */

/* The root of the sum of squares, but never 0 where a term is not: the squares of what lies a planet away may be. */
FN real root_of_squares(real squares, real sum) { return max_(sqrt_(squares), K(0.01f) * sum); }

/* Scores the nodes of a block into a group. */
CALL void score_nodes(CTX u1 part, u1 level, u1 block, u1 patches, u1 group) {
    EACH16(l) {
        list_node node = node_load(PASS part, level, block, l);
        cone_bound lights;
        lights.c = node.c;
        lights.radius = node.radius;
        lights.axis = node.axis;
        lights.spread = sel(node.cos_cone > K(0.0f), node.sin_cone, K(2.0f));
        real squares = K(0.0f);
        real sum = K(0.0f);
        for (u1 k = 0u; k < patches; k++) {
            list_patch t = patch_load(PASS k);
            real one = cone_score(cone_between(patch_bound(t), lights)) * K(t.reflectance);
            EXACT real more = squares + one * one;
            squares = more;
            sum = sum + one;
        }
        score_store(PASS group, l, min_(node.power * root_of_squares(squares, sum), K(1e30f)));
    }
}

/* ---- lights ---- */

FN real tenth(u32 place, int k) { return to_real(shr(place, 10 * k) & KU(1023u)) - K(512.0f); }

/* Lights as their cluster's block has them, points that face one way, or every way; and how strong they are. */
struct brief_lights {
    cone_bound bound;
    real intensity;
};

#ifndef CORE_GLSL
typedef struct brief_lights brief_lights;
#endif

FN brief_lights brief_unpack(list_brief b, f3 centre, f1 radius) {
    brief_lights l;
    mask any = shr(b.place, 31) == KU(1u);
    real scale = K(radius) * K(1.0f / 511.0f);
    EXACT real px = K(centre.x) + tenth(b.place, 0) * scale;
    EXACT real py = K(centre.y) + tenth(b.place, 1) * scale;
    EXACT real pz = K(centre.z) + tenth(b.place, 2) * scale;
    l.bound.c = V3(px, py, pz);
    l.bound.radius = K(0.0f);
    real x = (to_real(shr(b.shine, 8) & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real y = (to_real(b.shine & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real z = K(1.0f) - abs_(x) - abs_(y);
    real fold = max_(K(0.0f) - z, K(0.0f));
    x = x + sel(x < K(0.0f), fold, K(0.0f) - fold);
    y = y + sel(y < K(0.0f), fold, K(0.0f) - fold);
    v3 axis = V3(x, y, z);
    EXACT real inv = K(1.0f) / sqrt_(dot3(axis, axis));
    l.bound.axis = mul3(axis, inv);
    l.bound.spread = sel(any, K(2.0f), K(0.0f));
    l.intensity = real_of_bits(b.shine & KU(0xffff0000u));
    return l;
}

/* GGX's distribution (Walter 2007, eq. 33, without 1 / pi) at the half vector, as wide as the patch makes it. */
FN real patch_gloss(list_patch t, cone_view w) {
    real reach2 = min_(w.inv2 * K(t.radius * t.radius), K(1.0f));
    EXACT f1 wide = t.alpha2 + 0.25f * t.spread * t.spread;
    EXACT real a2 = min_(K(wide) + K(0.25f) * reach2, K(1.0f));
    v3 h = add3(w.d, spread3(t.wo));
    real h2 = dot3(h, h);
    real nh = dot3(spread3(t.axis), h);
    EXACT real below = h2 + nh * nh * (a2 - K(1.0f));
    EXACT real q = h2 / max_(below, K(1e-10f));
    return K(t.gloss) * (a2 * q * q);
}

/* Scores the lights of a cluster, as points no nearer to a patch than its radius, and a small share of the cluster's
 * own score, for they have a size, and so that none is 0 where the cluster is not. */
CALL void score_lights(CTX u1 part, u1 cluster, u1 patches, f1 score, u1 group) {
    list_cluster of = cluster_load(PASS part, cluster);
    EXACT f1 least = 0.05f * score / of.power;
    EACH16(l) {
        brief_lights lights = brief_unpack(brief_load(PASS part, cluster, l), of.c, of.radius);
        real squares = K(0.0f);
        for (u1 k = 0u; k < patches; k++) {
            list_patch t = patch_load(PASS k);
            cone_view w = cone_between(patch_bound(t), lights.bound);
            real one = cone_cosine(w.slope) * K(t.reflectance);
            if (t.gloss > 0.0f)
                one = one + patch_gloss(t, w);
            one = one * cone_cosine(w.facing) * w.inv2;
            one = sel(or_(w.slope < K(0.0f), w.facing < K(0.0f)), K(0.0f), one);
            EXACT real more = squares + one * one;
            squares = more;
        }
        score_store(PASS group, l, min_(lights.intensity * (K(least) + sqrt_(squares)), K(1e30f)));
    }
}

#endif
