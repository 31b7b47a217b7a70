/* Building a tile's light list (core/lists.h), included by lists.h. From the top level of the clusters down, the nodes
 * with the highest scores are opened: their 16 children, and in the end the lights of clusters, take their place. The
 * strongest lights are listed; what is left, closed nodes and lights, is what the tail is drawn from. So the work does
 * not grow with the number of lights, only with the number of levels. */
#ifndef NOC_CPU_LIST_BUILD_H
#define NOC_CPU_LIST_BUILD_H

#include "backend/cpu/list_scores_tmpl.h"

#include <float.h>

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

/* The `most` largest of the scores above 0, as 16 * group + lane in that order; those that share the last step are
 * taken in order. Returns how many. */
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

/* ---- the list ---- */

/* How many nodes of the lowest level reached are to be opened: all, where they are few, for then their lights may all
 * be listed; else those that hold more than a 3,000th of all scores; never more than `most`. */
static uint32_t worth_opening(list_scratch *s, uint32_t begin, uint32_t end, uint32_t most) {
    float all = 0;
    for (uint32_t g = 0; g < end; g++)
        all += sum16(s->scores[g]);
    if (count_over(s->scores, begin, end, FLT_MIN) <= FEW_NODES)
        return FEW_NODES;
    return NOC_MIN(most, count_over(s->scores, begin, end, NOC_MAX(all * (1.0f / 3000), FLT_MIN)));
}

/* Groups from the top level down to lights. Returns the first group of lights; *count: all groups. */
static uint32_t open_nodes(const noc_clusters *c, const patches *t, list_scratch *s, uint32_t *count) {
    uint32_t n = 0, begin = 0, picked[NOC_MAX(OPENED_NODES, OPENED_CLUSTERS)];
    int level = c->levels - 1;
    for (size_t b = 0; b < (c->nodes[level] + 15) / 16; b++, n++) {
        s->block[n] = (uint32_t)b;
        s->level[n] = (int8_t)level;
        score_nodes(&c->level[level][b], t, s->scores[n]);
    }
    for (; level >= 0; level--) {
        uint32_t open =
            choose(s->scores, begin, n, worth_opening(s, begin, n, level ? OPENED_NODES : OPENED_CLUSTERS), picked);
        begin = n;
        for (uint32_t i = 0; i < open; i++, n++) {
            uint32_t group = picked[i] / 16, lane = picked[i] % 16, node = 16 * s->block[group] + lane;
            if (level)
                score_nodes(&c->level[level - 1][node], t, s->scores[n]);
            else
                score_lights(c, node, t, s->scores[group][lane], s->scores[n]);
            s->block[n] = node;
            s->level[n] = (int8_t)(level - 1);
            s->scores[group][lane] = 0;
        }
    }
    *count = n;
    return begin;
}

/* Lane that holds the share *t (0..1) of the scores; *t: what is left of it there, as a share of the lane's own. -1
 * where all are 0. */
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
static bool descend(const noc_clusters *c, const patches *t, int level, uint32_t block, int lane, float score, float at,
                    uint32_t *id, float *share) {
    ALIGNED float scores[16];
    *share = 1;
    for (; level >= 0; level--) {
        block = 16 * block + (uint32_t)lane;
        if (level)
            score_nodes(&c->level[level - 1][block], t, scores);
        else
            score_lights(c, block, t, score, scores);
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
static void draw_tail(const noc_clusters *c, const patches *t, list_scratch *s, uint32_t groups, int draws,
                      float rotation, light_list *out) {
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
            if (lane < 0 || !descend(c, t, s->level[g], s->block[g], lane, s->scores[g][lane], at, &id, &share))
                continue;
            out->light[out->count] = id;
            out->weight[out->count++] = (float)(step / ((double)s->scores[g][lane] * share));
        }
}

static void list_build(const struct core_context *ctx, const gblock *const *g, const uint32_t *lanes, int blocks,
                       float rotation, list_scratch *s, light_list *out) {
    const noc_clusters *c = ctx->clusters;
    patches t;
    make_patches(ctx, g, lanes, blocks, &t);
    out->count = 0;
    out->copies = 1;
    if (!t.count || !c->count)
        return;
    uint32_t picked[2 * LIST_ENTRIES], groups, first = open_nodes(c, &t, s, &groups);
    uint32_t list = NOC_MIN(ctx->frame->list, (uint32_t)LIST_ENTRIES),
             tail = NOC_MIN(ctx->frame->tail, (uint32_t)LIST_ENTRIES);
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
    draw_tail(c, &t, s, groups, (int)tail, rotation, out);
}

#endif
