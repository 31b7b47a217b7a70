/* The reference method's kernel, included by kernels.c: every light is evaluated at every pixel.
 *
 * A light's sample (u, v) is one random place a pixel, light and frame. `rays` entries are laid over the lights'
 * cumulative unshadowed luminance by systematic sampling (thresholds (j + xi) T / n): a light of luminance p gets p n /
 * T entries on average, which makes one entry worth T / (n p). Several entries of one light become one of that many
 * times the weight. With no more lights than rays every light gets its own. Lights are summed in chunks, so that the
 * second walk only evaluates the chunks that hold a threshold. */
#ifndef NOC_CPU_REFERENCE_H
#define NOC_CPU_REFERENCE_H

FN real reference_target(CTX surf s, u32 key, uint32_t i) {
    u32 place = rng_bits(key, KU(DIM_CANDIDATE + i));
    return target(s, light_splat(PASS i), unit_low(place), unit_high(place));
}

/* Entries below the cumulative luminance c: the number of thresholds under it. */
FN u32 entries_below(real c, real per_luminance, real xi, int n) {
    EXACT real t = c * per_luminance - xi + K(1.0f);
    return to_u32(min_(max_(t, K(0.0f)), K(F32(n))));
}

static void put_entries(reference_scratch *e, int l, mask lanes, uint32_t id, real w, int max) {
    float value[LANES];
    rstore(value, w);
    for (uint32_t bits = mbits(lanes); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        uint32_t at = e->count[l + i];
        if (at >= (uint32_t)max)
            continue;
        e->light[at][l + i] = id;
        e->w[at][l + i] = value[i];
        e->count[l + i]++;
    }
}

static void reference_lanes(const struct core_context *ctx, const gblock *g, int x, int y, int l,
                            reference_scratch *e) {
    int n = (int)ctx->frame->rays;
    u32 key = key_of(ctx, x, y, l);
    surf s = surf_load(ctx, g, l, ctx->frame->camera.eye);
    if (ctx->light_count <= (uint32_t)n) {
        for (uint32_t i = 0; i < ctx->light_count; i++)
            put_entries(e, l, reference_target(ctx, s, key, i) > K(0.0f), i, K(1.0f), n);
        return;
    }
    real total = K(0.0f);
    for (uint32_t first = 0, chunk = 0; first < ctx->light_count; first += REFERENCE_CHUNK, chunk++) {
        uint32_t end = NOC_MIN(first + REFERENCE_CHUNK, ctx->light_count);
        real sum = K(0.0f);
        for (uint32_t i = first; i < end; i++)
            sum = sum + reference_target(ctx, s, key, i);
        rstore(e->sums[chunk] + l, sum);
        total = total + sum;
    }
    mask lit = total > K(0.0f);
    real per_luminance = K(F32(n)) / sel(lit, total, K(1.0f));
    real xi = rng(key, KU(DIM_RAYS));
    real before = K(0.0f);
    for (uint32_t first = 0, chunk = 0; first < ctx->light_count; first += REFERENCE_CHUNK, chunk++) {
        real after = before + rload(e->sums[chunk] + l);
        mask holds = entries_below(after, per_luminance, xi, n) != entries_below(before, per_luminance, xi, n);
        if (ANY(and_(lit, holds))) {
            uint32_t end = NOC_MIN(first + REFERENCE_CHUNK, ctx->light_count);
            real sum = K(0.0f);
            u32 had = entries_below(before, per_luminance, xi, n);
            for (uint32_t i = first; i < end; i++) {
                real p = reference_target(ctx, s, key, i);
                sum = sum + p;
                u32 have = entries_below(before + sum, per_luminance, xi, n);
                mask take = and_(and_(lit, p > K(0.0f)), have != had);
                EXACT real w = to_real(have - had) / (per_luminance * sel(take, p, K(1.0f)));
                put_entries(e, l, take, i, w, n);
                had = have;
            }
        }
        before = after;
    }
}

static void reference(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y,
                      reference_scratch *e) {
    memset(e->count, 0, sizeof(e->count));
    for (int l = 0; l < BLOCK; l += LANES)
        if (lanes >> l & ((1u << LANES) - 1))
            reference_lanes(ctx, g, x, y, l, e);
}

static void reference_place(const struct core_context *ctx, int x, int y, rblock *r) {
    for (int l = 0; l < BLOCK; l += LANES) {
        u32 place = rng_bits(key_of(ctx, x, y, l), KU(DIM_CANDIDATE) + uload(r->light + l));
        rstore(r->u + l, unit_low(place));
        rstore(r->v + l, unit_high(place));
    }
}

#endif
