/* Light lists (core/lists.h), included by kernels.c: a tile's list is built (list_build.h), then every pixel chooses among its
 * entries. */
#ifndef NOC_EMBREE_LISTS_H
#define NOC_EMBREE_LISTS_H

#include "backend/embree/list_build.h"
#include "core/lists.h"

FN list_entry list_entry_load(CTX int i) {
    list_entry e;
    e.light = KU(ctx->list->light[i]);
    e.weight = K(ctx->list->weight[i]);
    return e;
}

static void list_candidates(const struct core_context *ctx, const gblock *g, uint32_t lanes, int x, int y, rblock *out) {
    for (int l = 0; l < BLOCK; l += LANES) {
        mask on = mload(lanes, l);
        resv r = resv_empty();
        if (ctx->list->count && ANY(on)) {
            resv q = ris_list(ctx, surf_load(ctx, g, l, ctx->frame->camera.eye), key_of(ctx, x, y, l), (int)ctx->list->count);
            r = resv_sel(on, q, r);
        }
        r.m = sel(on, K(F32(ctx->frame->params->draws)), K(0.0f));
        resv_store(out, l, r);
    }
}

#endif
