/* Candidates that blocks share (core/presampled.h), included by kernels_tmpl.c: subsets are filled before a frame, the
 * pixels of each block then choose among those of one. */
#ifndef NOC_CPU_PRESAMPLED_H
#define NOC_CPU_PRESAMPLED_H

#include "core/presampled.h"

FN presample presample_load(CTX int i) {
    const presample_row *p = &ctx->at.samples[i];
    int l = ctx->at.lane;
    return (presample){ V3(rload(p->x[0] + l), rload(p->x[1] + l), rload(p->x[2] + l)),
                        V3(rload(p->normal[0] + l), rload(p->normal[1] + l), rload(p->normal[2] + l)),
                        V3(rload(p->shine[0] + l), rload(p->shine[1] + l), rload(p->shine[2] + l)),
                        rload(p->bare + l),
                        rload(p->sided + l),
                        rload(p->close2 + l),
                        rload(p->radius + l) };
}
FN real presample_inverse(CTX int i) { return rload(ctx->at.samples[i].inverse + ctx->at.lane); }
FN presample_pick presample_pick_load(CTX u32 i) {
    const presample_row *p = ctx->at.samples;
    u32 at = i * KU((uint32_t)(sizeof(*p) / 4)) + KU((uint32_t)ctx->at.lane) + lane_numbers(0);
    return (presample_pick){ word_gather(p->light, at), word_gather(p->place, at), real_gather(p->inverse, at) };
}
FN void weighed_store(CTX int i, real sum) { rstore(ctx->at.weighed[i] + ctx->at.lane, sum); }
FN real weighed_load(CTX int i) { return rload(ctx->at.weighed[i] + ctx->at.lane); }
FN real weighed_at(CTX u32 i) {
    return real_gather(ctx->at.weighed[0] + ctx->at.lane, i * KU(BLOCK) + lane_numbers(0));
}

/* Bit i: the target of sample i is not always evaluated. */
enum { PLAIN_WORDS = MOST_DRAWS * BLOCK / 32 };

/* Draws the samples of a subset in their order; returns how many of them are plain. */
static uint32_t draw_samples(const struct core_context *ctx, u1 key, uint32_t n, bool by_power, presample_pick1 *drawn,
                             uint32_t plain[PLAIN_WORDS]) {
    uint32_t all = 0;
    memset(plain, 0, (n + 31) / 32 * sizeof(*plain));
    for (uint32_t first = 0; first < n; first += LANES) {
        u32 i = KU(first) + lane_numbers(0);
        presample_pick p = by_power ? presample_draw_power(ctx, key, i, n, (u1)ctx->alias->count)
                                    : presample_draw(key, i, n, ctx->light_count);
        uint32_t id[LANES], where[LANES];
        float inverse[LANES];
        ustore(id, p.light);
        ustore(where, p.place);
        rstore(inverse, p.inverse);
        for (int l = 0; l < LANES; l++)
            drawn[first + (uint32_t)l] = (presample_pick1){ id[l], where[l], inverse[l] };
        uint32_t bits = mbits(presample_plain(light_load(ctx, p.light)));
        plain[first / 32] |= bits << first % 32;
        all += (uint32_t)__builtin_popcount(bits);
    }
    return all;
}

/* Puts the samples where they belong in the subset; `all` of them are plain. */
static void part_samples(u1 key, const presample_pick1 *drawn, const uint32_t *plain, uint32_t n, uint32_t all,
                         presample_row *out) {
    for (uint32_t first = 0, sum = 0; first < n; first += LANES) {
        uint32_t bits = plain[first / 32] >> first % 32 & ((1u << LANES) - 1), before[LANES], to[LANES];
        for (int l = 0; l < LANES; l++)
            before[l] = sum + (uint32_t)__builtin_popcount(bits & ((1u << l) - 1));
        sum += (uint32_t)__builtin_popcount(bits);
        u32 i = KU(first) + lane_numbers(0);
        ustore(to, presample_turned(key, presample_rank(mload(bits, 0), i, uload(before), all)));
        for (uint32_t l = 0; l < LANES; l++) {
            presample_row *row = &out[to[l] / BLOCK];
            row->light[to[l] % BLOCK] = drawn[first + l].light;
            row->place[to[l] % BLOCK] = drawn[first + l].place;
            row->inverse[to[l] % BLOCK] = drawn[first + l].inverse;
        }
    }
}

/* What surfaces look at. */
static void brief_samples(const struct core_context *ctx, presample_row *p) {
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 place = uload(p->place + l);
        presample e = presample_of(light_load(ctx, uload(p->light + l)), unit_low(place), unit_high(place));
        const v3 three[3] = { e.x, e.normal, e.shine };
        float(*const to[3])[BLOCK] = { p->x, p->normal, p->shine };
        for (int k = 0; k < 3; k++) {
            rstore(to[k][0] + l, three[k].x);
            rstore(to[k][1] + l, three[k].y);
            rstore(to[k][2] + l, three[k].z);
        }
        rstore(p->bare + l, e.bare);
        rstore(p->sided + l, e.sided);
        rstore(p->close2 + l, e.close2);
        rstore(p->radius + l, e.radius);
    }
}

static void presample_lights(const struct core_context *ctx, uint32_t subset, int m, bool by_power,
                             presample_pick1 *scratch, presample_row *out) {
    u1 key = presample_key(ctx->frame->seed, subset, ctx->frame->index, 0), n = (u1)m * BLOCK;
    uint32_t plain[PLAIN_WORDS];
    uint32_t all = draw_samples(ctx, key, n, by_power, scratch, plain);
    part_samples(key, scratch, plain, n, all, out);
    for (int i = 0; i < m; i++)
        brief_samples(ctx, &out[i]);
}

static void presampled(const struct core_context *frame, const gblock *g, uint32_t lanes, const uint32_t pixels[BLOCK],
                       int m, const presample_row *samples, float (*weighed)[BLOCK], rblock *out) {
    struct core_context c = *frame, *ctx = &c;
    c.at.samples = samples;
    c.at.weighed = weighed;
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        reservoir r = reservoir_empty();
        c.at.lane = l;
        if (ANY(on)) {
            u32 key = rng_key(KU(ctx->frame->seed), uload(pixels + l), KU(ctx->frame->index));
            r = reservoir_sel(on,
                              ris_presampled(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye),
                                             rng(key, KU(DIM_CANDIDATE)), m),
                              r);
        }
        reservoir_store(out, l, r);
    }
}

#endif
