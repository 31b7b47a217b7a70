/* Building a tile's light list (core/lists.h), included by lists.h: the tile's bounds, scores of the clusters, the choice of
 * the strongest lights, and the tail. */
#ifndef NOC_EMBREE_LIST_BUILD_H
#define NOC_EMBREE_LIST_BUILD_H

#include "core/lists.h"

/* ---- bounds ---- */

typedef struct tile_bound {
    float c[3], radius, axis[3], cos_cone, sin_cone;
    float reflectance; /* from lux to cd/m2, about */
    bool empty;
} tile_bound;

/* Sphere and normal cone of all surfaces of a tile. */
static tile_bound bound_tile(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks) {
    tile_bound t = { .empty = true, .cos_cone = 1 };
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, n[3] = { 0 }, far = 0;
    float reflected = 0, hits = 0;
    for (int b = 0; b < blocks; b++)
        for (uint32_t bits = lanes[b]; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            const float p[3] = { g[b]->px[l], g[b]->py[l], g[b]->pz[l] };
            const float *albedo = ctx->materials[g[b]->material[l]].albedo;
            for (int k = 0; k < 3; k++) {
                lo[k] = p[k] < lo[k] ? p[k] : lo[k];
                hi[k] = p[k] > hi[k] ? p[k] : hi[k];
            }
            n[0] += g[b]->nx[l];
            n[1] += g[b]->ny[l];
            n[2] += g[b]->nz[l];
            reflected += 0.2126f * albedo[0] + 0.7152f * albedo[1] + 0.0722f * albedo[2];
            hits++;
        }
    if (!hits)
        return t;
    t.empty = false;
    t.reflectance = CORE_INV_PI * (reflected / hits + 0.02f);
    float len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) {
        t.c[k] = 0.5f * (lo[k] + hi[k]);
        t.axis[k] = len > 1e-3f ? n[k] / len : 0;
    }
    for (int b = 0; b < blocks; b++)
        for (uint32_t bits = lanes[b]; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            float x = g[b]->px[l] - t.c[0], y = g[b]->py[l] - t.c[1], z = g[b]->pz[l] - t.c[2];
            float d2 = x * x + y * y + z * z;
            float c = g[b]->nx[l] * t.axis[0] + g[b]->ny[l] * t.axis[1] + g[b]->nz[l] * t.axis[2];
            far = d2 > far ? d2 : far;
            t.cos_cone = c < t.cos_cone ? c : t.cos_cone;
        }
    t.radius = sqrtf(far) * 1.0001f + 1e-4f;
    t.cos_cone -= 1e-4f;
    if (len <= 1e-3f || t.cos_cone < -1)
        t.cos_cone = -1;
    t.sin_cone = t.cos_cone < 1 ? sqrtf(1 - t.cos_cone * t.cos_cone) : 0;
    return t;
}

/* ---- choosing the largest ---- */

/* Bins by the float's exponent and top two bits of its fraction: 8 to 19 per cent wide. Values are not negative. */
static uint32_t score_bin(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof(bits));
    return bits >> 21;
}

/* Indices of the (about) `most` largest of n values that are above 0; never more than `most`. Returns how many. Those that
 * share the last bin are taken in order. */
static uint32_t pick_largest(const float *x, uint32_t n, uint32_t most, uint16_t bins[SCORE_BINS], uint32_t *out) {
    memset(bins, 0, SCORE_BINS * sizeof(*bins));
    for (uint32_t i = 0; i < n; i++)
        bins[score_bin(x[i])] += bins[score_bin(x[i])] < UINT16_MAX;
    uint32_t above = 0, bin = SCORE_BINS - 1;
    while (bin > 0 && above + bins[bin] <= most)
        above += bins[bin--];
    uint32_t room = most - above, count = 0;
    for (uint32_t i = 0; i < n && count < most; i++) {
        uint32_t b = score_bin(x[i]);
        if (!(x[i] > 0) || b < bin || (b == bin && !room))
            continue;
        room -= b == bin;
        out[count++] = i;
    }
    return count;
}

/* ---- the list ---- */

static void score_clusters(const noc_clusters *c, const tile_bound *t, float *scores) {
    cone_bound tile = { splat3(t->c), K(t->radius), splat3(t->axis), K(t->cos_cone), K(t->sin_cone) };
    for (size_t i = 0; i < c->padded; i += LANES) {
        cone_bound lights = { V3(rload(c->x + i), rload(c->y + i), rload(c->z + i)), rload(c->radius + i),
                              V3(rload(c->ax + i), rload(c->ay + i), rload(c->az + i)), rload(c->cos_cone + i),
                              rload(c->sin_cone + i) };
        rstore(scores + i, cluster_score(tile, lights, rload(c->power + i)) * K(t->reflectance));
    }
}

/* Up to LIST_EXAMPLES of the tile's surfaces. */
typedef struct examples {
    int count;
    surf s[LIST_EXAMPLES];
} examples;

static void take_examples(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                          float choice, examples *out) {
    out->count = 0;
    int used = 0, step = 1;
    for (int b = 0; b < blocks; b++)
        used += lanes[b] != 0;
    while (used > step * LIST_EXAMPLES)
        step++;
    for (int b = 0, i = 0; b < blocks && out->count < LIST_EXAMPLES; b++) {
        if (!lanes[b] || (i++ + (int)(choice * 64)) % step)
            continue;
        uint32_t bits = lanes[b];
        for (int skip = (int)(choice * 1024) % __builtin_popcount(bits); skip > 0; skip--)
            bits &= bits - 1;
        int l = __builtin_ctz(bits);
        const noc_material_record *m = ctx->materials + g[b]->material[l];
        surf s = { .p = { K(g[b]->px[l]), K(g[b]->py[l]), K(g[b]->pz[l]) },
                   .n = { K(g[b]->nx[l]), K(g[b]->ny[l]), K(g[b]->nz[l]) },
                   .albedo = splat3(m->albedo),
                   .f0 = K(m->f0),
                   .alpha = K(m->alpha) };
        v3 d = sub3(splat3(ctx->frame->camera.eye), s.p);
        s.wo = mul3(d, K(1.0f) / sqrt_(max_(dot3(d, d), K(1e-20f))));
        out->s[out->count++] = s;
    }
}

/* Lights of the opened clusters with their scores: their mean target at the examples, and a share of the cluster's bound,
 * so that none that could matter elsewhere in the tile is forgotten. The opened clusters' own scores become 0. */
static uint32_t score_lights(const struct core_context *ctx, const examples *e, list_scratch *s, const uint32_t *opened,
                             uint32_t count) {
    const noc_clusters *c = ctx->clusters;
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cluster = opened[i];
        float bound = 0.08f * s->scores[cluster] / c->power[cluster];
        for (uint32_t j = c->first[cluster]; j < c->first[cluster + 1]; j++, n++) {
            s->light[n] = c->ids[j];
            s->light_scores[n] = bound * c->intensity[j];
        }
        s->scores[cluster] = 0;
    }
    for (uint32_t i = n; i % LANES; i++)
        s->light[i] = s->light[n - 1]; /* whole vectors of lights */
    for (uint32_t i = 0; i < n; i += LANES) {
        light l = light_load(ctx, uload(s->light + i));
        real sum = K(0.0f);
        for (int k = 0; k < e->count; k++)
            sum = sum + target(e->s[k], l, K(0.5f), K(0.25f));
        rstore(s->light_scores + i, rload(s->light_scores + i) + sum * K(1.0f / (float)e->count));
    }
    return n;
}

/* Light of a cluster at the share t (0..1) of its power, and its own share of it. */
static uint32_t light_at(const noc_clusters *c, uint32_t cluster, float t, float *share) {
    float sum = 0, goal = t * c->power[cluster];
    uint32_t last = c->first[cluster + 1] - 1, j = c->first[cluster];
    for (; j < last; j++) {
        sum += c->intensity[j];
        if (sum > goal)
            break;
    }
    *share = c->intensity[j] / c->power[cluster];
    return c->ids[j];
}

/* `draws` systematic draws over the clusters that stayed closed and the lights that were not listed. */
static void draw_tail(const noc_clusters *c, const list_scratch *s, uint32_t lights, int draws, float rotation,
                      light_list *out) {
    double total = 0;
    for (size_t i = 0; i < c->count; i++)
        total += s->scores[i];
    for (uint32_t i = 0; i < lights; i++)
        total += s->light_scores[i];
    if (!(total > 0) || draws <= 0)
        return;
    double step = total / draws, next = step * rotation, sum = 0;
    int drawn = 0;
    for (size_t i = 0; i < c->count + lights && drawn < draws; i++) {
        bool cluster = i < c->count;
        float score = cluster ? s->scores[i] : s->light_scores[i - c->count];
        if (!(score > 0))
            continue;
        for (; next < sum + score && drawn < draws; next += step, drawn++) {
            float share = 1;
            uint32_t id = cluster ? light_at(c, (uint32_t)i, (float)((next - sum) / score), &share) : s->light[i - c->count];
            out->light[out->count] = id;
            out->weight[out->count++] = (float)(step / ((double)score * share));
        }
        sum += score;
    }
}

static void list_build(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                       float choice, float rotation, list_scratch *s, light_list *out) {
    const noc_clusters *c = ctx->clusters;
    const noc_render_params *p = ctx->frame->params;
    tile_bound t = bound_tile(ctx, g, lanes, blocks);
    out->count = 0;
    if (t.empty || !c->count)
        return;
    examples e;
    take_examples(ctx, g, lanes, blocks, choice, &e);
    score_clusters(c, &t, s->scores);
    uint32_t opened[OPENED_CLUSTERS], picked[LIST_ENTRIES];
    uint32_t open = pick_largest(s->scores, (uint32_t)c->count, OPENED_CLUSTERS, s->bins, opened);
    uint32_t lights = score_lights(ctx, &e, s, opened, open);
    uint32_t listed = pick_largest(s->light_scores, lights, (uint32_t)NOC_MIN(p->list, LIST_ENTRIES), s->bins, picked);
    for (uint32_t i = 0; i < listed; i++) {
        out->light[out->count] = s->light[picked[i]];
        out->weight[out->count++] = 1;
        s->light_scores[picked[i]] = 0;
    }
    draw_tail(c, s, lights, NOC_MIN(p->tail, LIST_ENTRIES), rotation, out);
}

#endif
