/* Candidates of the light pickers (core/alias.h, core/tree.h, light/influence.h), included by kernels.c: a picking step
 * fills a pick_block, `given` evaluates it. */
#ifndef NOC_CPU_PICKS_H
#define NOC_CPU_PICKS_H

#include "core/alias.h"
#include "core/given.h"

/* Candidate i, while the light of a later one is asked for. Entries up to PICK_AHEAD past the last are there to be
 * read. */
FN pick pick_load(CTX int i) {
    light_prefetch((const float *)ctx->lights, uload(ctx->at.picks->light[i + PICK_AHEAD] + ctx->at.lane));
    pick p;
    p.light = uload(ctx->at.picks->light[i] + ctx->at.lane);
    p.inverse = rload(ctx->at.picks->inverse[i] + ctx->at.lane);
    return p;
}

#include "backend/cpu/tree_draws_tmpl.h"

static void given(const struct core_context *frame, const gblock *g, uint32_t lanes, int x, int y, int m,
                  const pick_block *picks, rblock *out) {
    struct core_context c = *frame;
    const struct core_context *ctx = &c;
    c.at.picks = picks;
    for (int l = 0; l <= BLOCK - LANES; l += LANES) { /* so that gcc 12 sees that the last one fits */
        mask on = mload(lanes, l);
        reservoir r = reservoir_empty();
        c.at.lane = l;
        if (ctx->light_count && ANY(on))
            r = reservoir_sel(on, ris_given(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l), m),
                              r);
        reservoir_store(out, l, r);
    }
}

#endif
