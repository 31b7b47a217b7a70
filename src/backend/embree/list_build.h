/* Building a tile's light list (core/lists.h), included by lists.h. From the top level of the clusters down, the nodes with
 * the highest scores are opened: their 16 children, and in the end the lights of clusters, take their place. The strongest
 * lights are listed; what is left, closed nodes and lights, is what the tail is drawn from. So the work does not grow with
 * the number of lights, only with the number of levels. */
#ifndef NOC_EMBREE_LIST_BUILD_H
#define NOC_EMBREE_LIST_BUILD_H

#include "core/lists.h"

#include <float.h>

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

/* How many of the groups' scores are t or more. t > 0. */
static uint32_t count_over(float (*scores)[16], uint32_t begin, uint32_t end, float t) {
    u32 sum = KU(0u);
    uint32_t lanes[LANES], n = 0;
    for (uint32_t g = begin; g < end; g++)
        for (int l = 0; l < 16; l += LANES)
            sum = sum + selu(rload(scores[g] + l) >= K(t), KU(1u), KU(0u));
    ustore(lanes, sum);
    for (int l = 0; l < LANES; l++)
        n += lanes[l];
    return n;
}

static uint32_t lanes_over(const float *scores, float t) {
    uint32_t bits = 0;
    for (int l = 0; l < 16; l += LANES)
        bits |= mbits(rload(scores + l) >= K(t)) << l;
    return bits;
}

/* Scores are told apart by their exponents and the top two bits of their fractions: 8 to 19 per cent. */
static float score_step(uint32_t step) {
    float x;
    step <<= 21;
    memcpy(&x, &step, sizeof(x));
    return x;
}

/* The `most` largest of the scores above 0, as 16 * group + lane in that order; those that share the last step are taken in
 * order. Returns how many. */
static uint32_t choose(float (*scores)[16], uint32_t begin, uint32_t end, uint32_t most, uint32_t *out) {
    uint32_t low = 1, high = SCORE_STEPS; /* high: the lowest step known to have no more than `most` at or above it */
    while (low < high) {
        uint32_t mid = (low + high) / 2;
        if (count_over(scores, begin, end, score_step(mid)) <= most)
            high = mid;
        else
            low = mid + 1;
    }
    float sure = score_step(high), tie = high > 1 ? score_step(high - 1) : sure;
    uint32_t room = most - count_over(scores, begin, end, sure), n = 0;
    for (uint32_t g = begin; g < end && n < most; g++)
        for (uint32_t over = lanes_over(scores[g], sure), bits = lanes_over(scores[g], tie); bits; bits &= bits - 1) {
            uint32_t lane = (uint32_t)__builtin_ctz(bits);
            if (!(over >> lane & 1)) {
                if (!room)
                    continue;
                room--;
            }
            out[n++] = 16 * g + lane;
        }
    return n;
}

/* In this order whatever the number of lanes. */
static float sum16(const float *x) {
    float a[8];
    for (int i = 0; i < 8; i++)
        a[i] = x[i] + x[i + 8];
    for (int i = 0; i < 4; i++)
        a[i] += a[i + 4];
    return (a[0] + a[2]) + (a[1] + a[3]);
}

/* ---- scores ---- */

static void score_nodes(const noc_cluster_block *c, const tile_bound *t, float *out) {
    cone_bound tile = { splat3(t->c), K(t->radius), splat3(t->axis), K(t->cos_cone), K(t->sin_cone) };
    for (int i = 0; i < 16; i += LANES) {
        cone_bound lights = { V3(rload(c->x + i), rload(c->y + i), rload(c->z + i)), rload(c->radius + i),
                              V3(rload(c->ax + i), rload(c->ay + i), rload(c->az + i)), rload(c->cos_cone + i),
                              rload(c->sin_cone + i) };
        rstore(out + i, cluster_score(tile, lights, rload(c->power + i)) * K(t->reflectance));
    }
}

/* Up to LIST_EXAMPLES of the tile's surfaces. */
typedef struct examples {
    int count;
    surf s[LIST_EXAMPLES];
    real albedo[LIST_EXAMPLES]; /* its luminance */
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
        out->albedo[out->count] = luminance(s.albedo);
        out->s[out->count++] = s;
    }
}

FN real real_of_bits(u32 bits) {
    real x;
    memcpy(&x, &bits, sizeof(x));
    return x;
}

/* A light as its cluster's block has it: a point that faces one way, or every way. */
typedef struct brief_light {
    v3 p, n;
    real intensity;
    mask any; /* faces every way */
} brief_light;

FN real tenth(u32 place, int k) { return to_real(shr(place, 10 * k) & KU(1023u)) - K(512.0f); }

FN brief_light brief_light_load(const noc_light_block *b, int i, v3 centre, real radius) {
    brief_light l;
    u32 place = uload(b->place + i);
    u32 shine = uload(b->shine + i);
    real scale = radius * K(1.0f / 511.0f);
    l.p = add3(centre, mul3(V3(tenth(place, 0), tenth(place, 1), tenth(place, 2)), scale));
    real x = (to_real(shr(shine, 8) & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real y = (to_real(shine & KU(255u)) - K(127.0f)) * K(1.0f / 127.0f);
    real z = K(1.0f) - abs_(x) - abs_(y);
    real fold = max_(K(0.0f) - z, K(0.0f));
    x = x + sel(x < K(0.0f), fold, K(0.0f) - fold);
    y = y + sel(y < K(0.0f), fold, K(0.0f) - fold);
    l.n = mul3(V3(x, y, z), K(1.0f) / sqrt_(x * x + y * y + z * z));
    l.intensity = real_of_bits(shine & KU(0xffff0000u));
    l.any = shr(place, 31) == KU(1u);
    return l;
}

/* What the lights of a cluster give the examples on average, as if each were a point, and a share of the cluster's own
 * score, so that none that could matter elsewhere in the tile is forgotten: the smaller that share, the fewer lights are
 * listed in vain, but the brighter the fireflies of those that should have been (bench/bench_lists). */
static void score_lights(const noc_clusters *c, uint32_t cluster, const examples *e, float score, float *out) {
    const noc_cluster_block *block = &c->level[0][cluster / 16];
    uint32_t lane = cluster % 16;
    v3 centre = V3(K(block->x[lane]), K(block->y[lane]), K(block->z[lane]));
    float least = 0.2f * score / block->power[lane];
    for (int i = 0; i < 16; i += LANES) {
        brief_light l = brief_light_load(&c->lights[cluster], i, centre, K(block->radius[lane]));
        real sum = K(0.0f);
        for (int k = 0; k < e->count; k++) {
            v3 d = sub3(l.p, e->s[k].p);
            real inv = K(1.0f) / sqrt_(max_(dot3(d, d), K(0.01f)));
            d = mul3(d, inv);
            real facing = sel(l.any, K(1.0f), max_(K(0.0f) - dot3(l.n, d), K(0.0f)));
            lobes f = reflect_lobes(e->s[k], d);
            sum = sum + facing * inv * inv * (e->albedo[k] * f.diffuse + f.gloss);
        }
        rstore(out + i, min_(l.intensity * (K(least) + sum * K(1.0f / (float)e->count)), K(1e30f)));
    }
}

/* ---- the list ---- */

/* Groups from the top level down to lights. Returns the first group of lights; *count: all groups. */
static uint32_t open_nodes(const noc_clusters *c, const tile_bound *t, const examples *e, list_scratch *s, uint32_t *count) {
    uint32_t n = 0, begin = 0, picked[NOC_MAX(OPENED_NODES, OPENED_CLUSTERS)];
    int level = c->levels - 1;
    for (size_t b = 0; b < (c->nodes[level] + 15) / 16; b++, n++) {
        s->block[n] = (uint32_t)b;
        s->level[n] = (int8_t)level;
        score_nodes(&c->level[level][b], t, s->scores[n]);
    }
    for (; level >= 0; level--) {
        uint32_t open = choose(s->scores, begin, n, level ? OPENED_NODES : OPENED_CLUSTERS, picked);
        begin = n;
        for (uint32_t i = 0; i < open; i++, n++) {
            uint32_t group = picked[i] / 16, lane = picked[i] % 16, node = 16 * s->block[group] + lane;
            if (level)
                score_nodes(&c->level[level - 1][node], t, s->scores[n]);
            else
                score_lights(c, node, e, s->scores[group][lane], s->scores[n]);
            s->block[n] = node;
            s->level[n] = (int8_t)(level - 1);
            s->scores[group][lane] = 0;
        }
    }
    *count = n;
    return begin;
}

/* Lane that holds the share *t (0..1) of the scores; *t: what is left of it there, as a share of the lane's own. -1 where all
 * are 0. */
static int lane_at(const float *scores, float total, float *t) {
    float sum = 0, goal = *t * total;
    int last = -1;
    for (int l = 0; l < 16; l++) {
        if (!(scores[l] > 0))
            continue;
        last = l;
        if (sum + scores[l] > goal)
            break;
        sum += scores[l];
    }
    if (last >= 0)
        *t = NOC_CLAMP((goal - sum) / scores[last], 0.f, 1.f);
    return last;
}

/* A light below a lane of a group, by the scores on the way down from it; *share: the probability of that. False where
 * nothing there reaches the tile. */
static bool descend(const noc_clusters *c, const tile_bound *t, const examples *e, int level, uint32_t block, int lane,
                    float score, float at, uint32_t *id, float *share) {
    ALIGNED float scores[16];
    *share = 1;
    for (; level >= 0; level--) {
        block = 16 * block + (uint32_t)lane;
        if (level)
            score_nodes(&c->level[level - 1][block], t, scores);
        else
            score_lights(c, block, e, score, scores);
        float total = sum16(scores);
        lane = lane_at(scores, total, &at);
        if (lane < 0)
            return false;
        score = scores[lane];
        *share *= score / total;
    }
    *id = c->lights[block].id[lane];
    return *share > 0;
}

/* `draws` systematic draws over the nodes that stayed closed and the lights that were not listed. */
static void draw_tail(const noc_clusters *c, const tile_bound *t, const examples *e, list_scratch *s, uint32_t groups,
                      int draws, float rotation, light_list *out) {
    double total = 0;
    for (uint32_t g = 0; g < groups; g++)
        total += s->sums[g] = sum16(s->scores[g]);
    if (!(total > 0) || draws <= 0)
        return;
    double step = total / draws, next = step * rotation, sum = 0;
    int drawn = 0;
    draws = NOC_MIN(draws, 2 * LIST_ENTRIES - (int)out->count);
    for (uint32_t g = 0; g < groups && drawn < draws; sum += s->sums[g++])
        for (; next < sum + s->sums[g] && drawn < draws; next += step, drawn++) {
            float at = (float)((next - sum) / s->sums[g]), share;
            int lane = lane_at(s->scores[g], s->sums[g], &at);
            uint32_t id;
            if (lane < 0 || !descend(c, t, e, s->level[g], s->block[g], lane, s->scores[g][lane], at, &id, &share))
                continue;
            out->light[out->count] = id;
            out->weight[out->count++] = (float)(step / ((double)s->scores[g][lane] * share));
        }
}

static void list_build(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                       float choice, float rotation, list_scratch *s, light_list *out) {
    const noc_clusters *c = ctx->clusters;
    const noc_render_params *p = ctx->frame->params;
    tile_bound t = bound_tile(ctx, g, lanes, blocks);
    out->count = 0;
    out->copies = 1;
    if (t.empty || !c->count)
        return;
    examples e;
    take_examples(ctx, g, lanes, blocks, choice, &e);
    uint32_t picked[2 * LIST_ENTRIES], groups, first = open_nodes(c, &t, &e, s, &groups);
    uint32_t list = (uint32_t)NOC_MIN(p->list, LIST_ENTRIES), tail = (uint32_t)NOC_MIN(p->tail, LIST_ENTRIES);
    /* A list without a tail where that holds all lights. */
    if (!count_over(s->scores, 0, first, FLT_MIN) && count_over(s->scores, first, groups, FLT_MIN) <= list + tail)
        list += tail;
    uint32_t listed = choose(s->scores, first, groups, list, picked);
    for (uint32_t i = 0; i < listed; i++) {
        float *score = &s->scores[picked[i] / 16][picked[i] % 16];
        out->light[out->count] = c->lights[s->block[picked[i] / 16]].id[picked[i] % 16];
        out->weight[out->count++] = 1;
        *score = 0;
    }
    draw_tail(c, &t, &e, s, groups, (int)tail, rotation, out);
}

#endif
