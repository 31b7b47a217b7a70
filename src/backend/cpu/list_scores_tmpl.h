/* How strongly lights could shine on a tile, included by list_build.h: the tile's surfaces as patches with tight
 * bounds, and scores of nodes and of lights, the root of the mean square over the patches of what they could give
 * there. That is the density with the least variance for the tile's pixels (Cauchy-Schwarz), where scores are exact: a
 * light that is strong in a corner of the tile only is not forgotten, as it is where it counts by its mean, or by a
 * bound of the whole tile. */
#ifndef NOC_CPU_LIST_SCORES_H
#define NOC_CPU_LIST_SCORES_H

#include "core/lists.h"

/* ---- patches ---- */

/* Some neighbouring surfaces of a tile. */
typedef struct patch {
    float c[3], radius, axis[3], spread; /* core/cones.h */
    float share;                         /* root of its share of the tile's pixels */
    float reflectance;                   /* from lux to cd/m2, about, times share */
    float wo[3];                         /* from its centre to the eye */
    /* what multiplies the lobe of its first surface, taken for all, and that lobe's alpha^2 */
    float gloss, alpha2;
} patch;

typedef struct patches {
    int count;
    patch p[LIST_PATCHES];
} patches;

/* The lobe about the mirrored eye: Fresnel's term and the slope of the view are those of the patch's own normal. */
static void bound_gloss(const noc_material_record *m, patch *t) {
    float nv = t->axis[0] * t->wo[0] + t->axis[1] * t->wo[1] + t->axis[2] * t->wo[2];
    nv = NOC_CLAMP(nv, 0.05f, 1.f);
    float away = 1 - nv, away2 = away * away;
    if (!(m->f0 > 0))
        return;
    t->gloss = (m->f0 + (1 - m->f0) * away2 * away2 * away) * CORE_INV_PI / (4 * nv);
    t->alpha2 = m->alpha * m->alpha;
}

/* Sphere, cone of normals and reflectance of some lanes of a block; not yet times its share. */
static patch bound_patch(const struct core_context *ctx, const gblock *g, uint32_t lanes) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, n[3] = { 0 };
    float reflected = 0, far = 0, cone = 1, d2 = 0;
    patch t = { .alpha2 = 1 };
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        const float p[3] = { g->px[l], g->py[l], g->pz[l] };
        const float *albedo = ctx->materials[g->material[l]].albedo;
        for (int k = 0; k < 3; k++) {
            lo[k] = p[k] < lo[k] ? p[k] : lo[k];
            hi[k] = p[k] > hi[k] ? p[k] : hi[k];
        }
        n[0] += g->nx[l];
        n[1] += g->ny[l];
        n[2] += g->nz[l];
        reflected += 0.2126f * albedo[0] + 0.7152f * albedo[1] + 0.0722f * albedo[2];
    }
    t.reflectance = CORE_INV_PI * (reflected / (float)__builtin_popcount(lanes) + 0.02f);
    float len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) {
        t.c[k] = 0.5f * (lo[k] + hi[k]);
        t.axis[k] = len > 1e-3f ? n[k] / len : 0;
        t.wo[k] = ctx->frame->camera.eye[k] - t.c[k];
        d2 += t.wo[k] * t.wo[k];
    }
    for (int k = 0; k < 3; k++)
        t.wo[k] /= sqrtf(d2) + 1e-10f;
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        float x = g->px[l] - t.c[0], y = g->py[l] - t.c[1], z = g->pz[l] - t.c[2];
        float r2 = x * x + y * y + z * z, c = g->nx[l] * t.axis[0] + g->ny[l] * t.axis[1] + g->nz[l] * t.axis[2];
        far = r2 > far ? r2 : far;
        cone = c < cone ? c : cone;
    }
    cone -= 1e-4f;
    t.radius = sqrtf(far) * 1.0001f + 1e-4f;
    t.spread = cone > 0 ? sqrtf(1 - cone * cone) : 2;
    bound_gloss(ctx->materials + g->material[__builtin_ctz(lanes)], &t);
    return t;
}

/* Lanes that lie in front, where a block sees an edge with something far behind; 0: all lie at about one depth. */
static uint32_t lanes_in_front(const gblock *g, uint32_t lanes) {
    float near = INFINITY, far = 0;
    uint32_t front = 0;
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        float d = g->depth[__builtin_ctz(bits)];
        near = d < near ? d : near;
        far = d > far ? d : far;
    }
    if (far > 1.05f * near)
        for (uint32_t bits = lanes; bits; bits &= bits - 1)
            front |= (uint32_t)(g->depth[__builtin_ctz(bits)] < 0.5f * (near + far)) << __builtin_ctz(bits);
    return front;
}

static void make_patches(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                         patches *out) {
    int all = 0;
    out->count = 0;
    for (int b = 0; b < blocks; b++)
        all += __builtin_popcount(lanes[b]);
    for (int b = 0; b < blocks; b++) {
        uint32_t front = lanes_in_front(g[b], lanes[b]), parts[2] = { front, lanes[b] & ~front };
        for (int i = 0; i < 2; i++) {
            if (!parts[i])
                continue;
            patch *t = &out->p[out->count++];
            *t = bound_patch(ctx, g[b], parts[i]);
            t->share = sqrtf((float)__builtin_popcount(parts[i]) / (float)all);
            t->reflectance *= t->share;
            t->gloss *= t->share;
        }
    }
}

FN cone_bound patch_bound(const patch *t) {
    return (cone_bound){ splat3(t->c), K(t->radius), splat3(t->axis), K(t->spread) };
}

/* ---- nodes ---- */

/* The root of the sum of squares, but never 0 where a term is not: the squares of what lies a planet away may be. */
FN real root_of_squares(real squares, real sum) { return max_(sqrt_(squares), K(0.01f) * sum); }

static void score_nodes(const noc_cluster_block *c, const patches *t, float *out) {
    for (int i = 0; i < 16; i += LANES) {
        real cone = rload(c->cos_cone + i);
        cone_bound lights = { V3(rload(c->x + i), rload(c->y + i), rload(c->z + i)), rload(c->radius + i),
                              V3(rload(c->ax + i), rload(c->ay + i), rload(c->az + i)),
                              sel(cone > K(0.0f), rload(c->sin_cone + i), K(2.0f)) };
        real squares = K(0.0f);
        real sum = K(0.0f);
        for (int k = 0; k < t->count; k++) {
            real one = cone_score(cone_between(patch_bound(&t->p[k]), lights)) * K(t->p[k].reflectance);
            squares = squares + one * one;
            sum = sum + one;
        }
        rstore(out + i, min_(rload(c->power + i) * root_of_squares(squares, sum), K(1e30f)));
    }
}

/* ---- lights ---- */

FN real real_of_bits(u32 bits) {
    real x;
    memcpy(&x, &bits, sizeof(x));
    return x;
}

FN real tenth(u32 place, int k) { return to_real(shr(place, 10 * k) & KU(1023u)) - K(512.0f); }

/* Lights as their cluster's block has them: points that face one way, or every way. */
FN cone_bound brief_lights(const noc_light_block *b, int i, v3 centre, real radius, real *intensity) {
    cone_bound l;
    u32 place = uload(b->place + i);
    u32 shine = uload(b->shine + i);
    mask any = shr(place, 31) == KU(1u);
    l.c = add3(centre, mul3(V3(tenth(place, 0), tenth(place, 1), tenth(place, 2)), radius * K(1.0f / 511.0f)));
    l.radius = K(0.0f);
    real x = (to_real(shr(shine, 8) & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real y = (to_real(shine & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real z = K(1.0f) - abs_(x) - abs_(y);
    real fold = max_(K(0.0f) - z, K(0.0f));
    x = x + sel(x < K(0.0f), fold, K(0.0f) - fold);
    y = y + sel(y < K(0.0f), fold, K(0.0f) - fold);
    l.axis = mul3(V3(x, y, z), K(1.0f) / sqrt_(x * x + y * y + z * z));
    l.spread = sel(any, K(2.0f), K(0.0f));
    *intensity = real_of_bits(shine & KU(0xffff0000u));
    return l;
}

/* GGX's distribution (Walter 2007, eq. 33, without 1 / pi) at the half vector, as wide as the patch makes it. */
FN real patch_gloss(const patch *t, cone_view w) {
    real reach2 = min_(w.inv2 * K(t->radius * t->radius), K(1.0f));
    real a2 = min_(K(t->alpha2 + 0.25f * t->spread * t->spread) + K(0.25f) * reach2, K(1.0f));
    v3 h = add3(w.d, splat3(t->wo));
    real h2 = dot3(h, h);
    real nh = dot3(splat3(t->axis), h);
    real q = h2 / max_(h2 + nh * nh * (a2 - K(1.0f)), K(1e-10f));
    return K(t->gloss) * (a2 * q * q);
}

/* The lights of a cluster as points, no nearer to a patch than its radius, and a small share of the cluster's own
 * score, for they have a size, and so that none is 0 where the cluster is not. */
static void score_lights(const noc_clusters *c, uint32_t cluster, const patches *t, float score, float *out) {
    const noc_cluster_block *block = &c->level[0][cluster / 16];
    uint32_t lane = cluster % 16;
    v3 centre = V3(K(block->x[lane]), K(block->y[lane]), K(block->z[lane]));
    float least = 0.05f * score / block->power[lane];
    for (int i = 0; i < 16; i += LANES) {
        real intensity;
        cone_bound l = brief_lights(&c->lights[cluster], i, centre, K(block->radius[lane]), &intensity);
        real squares = K(0.0f);
        for (int k = 0; k < t->count; k++) {
            const patch *q = &t->p[k];
            cone_view w = cone_between(patch_bound(q), l);
            real one = cone_cosine(w.slope) * K(q->reflectance);
            if (q->gloss > 0)
                one = one + patch_gloss(q, w);
            one = one * cone_cosine(w.facing) * w.inv2;
            one = sel(or_(w.slope < K(0.0f), w.facing < K(0.0f)), K(0.0f), one);
            squares = squares + one * one;
        }
        rstore(out + i, min_(intensity * (K(least) + sqrt_(squares)), K(1e30f)));
    }
}

#endif
