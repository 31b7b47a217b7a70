/* Light lists with several shadow rays a pixel (core/lists.h, docs/estimator.md): every pixel weighs the entries of its
 * tile's list and shares its rays out over them systematically. ris adds up what they see; restir keeps one of those
 * that are seen as the pixel's own reservoir, and where only frames are reused mixes both. How many rays, and which
 * entries, is steered by what earlier frames have learned of the lights' visibility. */
#include "backend/cpu/cpu.h"

#include "backend/cpu/lanes_tmpl.h"
#include "core/learned.h"

enum { MOST_ASKED_A_TILE = 16 * BLOCK * TILE_BLOCKS * TILE_BLOCKS };
_Static_assert(MOST_ASKED_A_TILE <= 1 << 15, "counts of a tile fit");

/* ---- what is expected ---- */

static cell_key key_of_block(const frame_camera *c, const gblock *g, uint32_t lanes) {
    uint32_t l = cell_lane(lanes);
    return cell_key_at(*c, (f3){ g->px[l], g->py[l], g->pz[l] }, (f3){ g->nx[l], g->ny[l], g->nz[l] }, g->depth[l]);
}

/* Number of the block's cell among those of the tile. */
static int find_priors(const stage_run *run, const gblock *g, uint32_t lanes, const light_list *list, tile_rays *t) {
    bool learn = run->frame->plan->learns;
    cell_key key = learn ? key_of_block(&run->ctx.frame->camera, g, lanes) : (cell_key){ 0 };
    for (int i = t->cells - 1; i >= 0; i--)
        if (cell_same(t->cell[i].key, key))
            return i;
    tile_cell *c = &t->cell[t->cells];
    const noc_cell *known = learn ? noc_learned_find(run->s->learned, key) : NULL;
    c->key = key;
    memset(&c->priors, 0, sizeof(c->priors));
    for (uint32_t i = 0, at = 0; i < list->count; i++, at = next_place(at, list->count)) {
        list_prior b = list_prior_of(list->weight[i], noc_cell_visibility(known, list->light[i]));
        c->priors.share[at] = b.share;
        c->priors.expect[at] = b.expect;
        c->asked[i] = c->seen[i] = 0;
    }
    return t->cells++;
}

/* ---- rays ---- */

/* Ray k of each lane that has one. */
static void add_rays(stage_run *run, tile_rays *t, const struct core_context *ctx, int block, int k, int x, int y) {
    ray_draw *d = &t->draws[t->count];
    shadow_block *s = &t->segments[t->count++];
    float(*counts)[BLOCK] = run->s->b.views.made[NOC_AOV_RAYS];
    d->block = block;
    d->rays = t->asked.most;
    s->valid = 0;
    s->counts = counts ? counts[t->at[block]] : NULL;
    run->k->list_ray(ctx, x, y, &t->asked, k, d, &s->rays);
    for (int l = 0; l < BLOCK; l++) {
        s->valid |= (uint32_t)(d->r.w[l] > 0) << l;
        s->light[l] = d->r.light[l];
    }
}

/* The pixel of lane 0 of a block of the picture. */
static tile_block block_in_picture(const stage_run *run, size_t at) {
    size_t wide = (size_t)run->s->b.blocks_x;
    return (tile_block){ at, (int)(at % wide) * BLOCK_SIDE, (int)(at / wide) * BLOCK_SIDE };
}

/* Reservoirs that stand for the pixels of block n, whose rays are from number `first` on; without rays they are empty.
 * M does not depend on what is found. */
static void stand_in(const stage_run *run, worker *w, int n, int first, rblock *r) {
    const tile_rays *t = &w->lists->rays;
    const ray_draw *d = &t->draws[first];
    tile_block b = block_in_picture(run, t->at[n]);
    struct core_context ctx = run->ctx;
    ctx.at.lists = &w->lists->build;
    *r = (rblock){ 0 };
    for (int l = 0; l < BLOCK; l++) {
        r->u[l] = r->v[l] = 0.5f;
        r->m[l] = t->lanes[n] >> l & 1 ? (float)ctx.frame->draws : 0;
    }
    if (first < t->count && d->block == n)
        run->k->list_stand_in(&ctx, b.x, b.y, d, d->rays, t->n[n], r);
}

/* For views of the candidates, before it is known which of them are seen. */
static void show_candidates(const stage_run *run, worker *w, int n, int first) {
    const tile_rays *t = &w->lists->rays;
    rblock shown;
    stand_in(run, w, n, first, &shown);
    noc_cpu_note_candidates(run, w, n, t->at[n], t->lanes[n], &shown);
}

static void show_expected(const stage_run *run, const tile_rays *t, int n) {
    float(*expected)[BLOCK] = run->s->b.views.made[NOC_AOV_EXPECTED];
    for (uint32_t bits = expected ? t->lanes[n] : 0; bits; bits &= bits - 1)
        expected[t->at[n]][__builtin_ctz(bits)] = t->asked.bright[__builtin_ctz(bits)];
}

void noc_cpu_share_candidates(stage_run *run, worker *w, const tile_points *points) {
    struct core_context ctx = run->ctx;
    tile_rays *t = &w->lists->rays;
    ctx.at.lists = &w->lists->build;
    t->count = t->cells = 0;
    bool asks = noc_stage_has(run->stage, NOC_PASS_SEEN_BEFORE), learns = run->frame->plan->learns;
    float brightness = learns ? run->s->list_brightness : 0; /* it is learned, too */
    run->k->list_fill(&ctx);
    for (int n = 0; n < points->count; n++) {
        tile_block at = points->block[n];
        int first = t->count;
        t->at[n] = at.at;
        t->lanes[n] = points->lanes[n];
        if (learns)
            run->s->block_bright[at.at] = 0;
        if (!t->lanes[n] || !ctx.at.lists->list.count)
            continue;
        t->cell_of[n] = find_priors(run, points->g[n], t->lanes[n], &w->lists->build.list, t);
        t->asked.fresh = asks ? t->fresh[n] : 0;
        run->k->list_share(&ctx, points->g[n], t->lanes[n], at.x, at.y, brightness, &t->cell[t->cell_of[n]].priors,
                           &t->asked);
        memcpy(t->n[n], t->asked.n, sizeof(t->n[n]));
        show_expected(run, t, n);
        if (learns) /* which adds them up in their place */
            run->s->block_bright[at.at] = noc_cpu_sum_in_halves(t->asked.bright, BLOCK);
        for (int k = 0; k < t->asked.most; k++)
            add_rays(run, t, &ctx, n, k, at.x, at.y);
        if (run->frame->params->aovs)
            show_candidates(run, w, n, first);
    }
}

/* The rays of restir's pixels become their own reservoirs, of samples known to be seen. */
void noc_cpu_resample(stage_run *run, worker *w, tile at) {
    const tile_rays *t = &w->lists->rays;
    struct core_context ctx = run->ctx;
    ctx.at.lists = &w->lists->build;
    (void)at;
    for (int i = 0; i < t->count; i += t->draws[i].rays) {
        tile_block b = block_in_picture(run, t->at[t->draws[i].block]);
        rblock *r = &run->s->b.r[run->stage->target][b.at];
        run->k->list_resample(&ctx, b.x, b.y, t->draws + i, t->draws[i].rays, r);
        run->s->b.visible[run->stage->target][b.at] = (uint16_t)lanes_with_sample(r);
    }
}

bool noc_cpu_keeps_reservoirs(const noc_render_params *p) {
    return p->method != NOC_METHOD_RIS || p->candidates != NOC_CANDIDATES_LISTS || noc_views_need_reservoirs(p->aovs);
}

void noc_cpu_trace_shared(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->lists->rays;
    if (run->ctx.frame->flags & FRAME_FINAL_RAY)
        noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, t->segments, t->count);
    else
        for (int i = 0; i < t->count; i++)
            t->segments[i].unoccluded = t->segments[i].valid;
    for (int i = 0; i < t->count; i++)
        block_samples(&t->draws[i].r, ~t->segments[i].unoccluded);
    bool kept = noc_cpu_keeps_reservoirs(run->frame->params);
    for (int n = 0, i = 0; kept && n < (at.y1 - at.y0) * (at.x1 - at.x0); n++) {
        stand_in(run, w, n, i, &run->s->b.r[run->stage->target][t->at[n]]);
        run->s->b.visible[run->stage->target][t->at[n]] = 0;
        while (i < t->count && t->draws[i].block == n)
            i++;
    }
    if (run->frame->plan->learns)
        noc_cpu_note_observations(run, w, at);
}

/* restir: a mixture of the rays and the reservoir. */
static void share_with_reservoirs(const stage_run *run, tile_rays *t, tile at) {
    for (int n = (at.y1 - at.y0) * (at.x1 - at.x0); n-- > 0;)
        run->k->list_mix(&run->ctx, run->s->b.r[run->stage->target][t->at[n]].m, t->reused[n]);
    for (int i = 0; i < t->count; i++)
        for (int l = 0; l < BLOCK; l++)
            t->draws[i].r.w[l] *= 1 - t->reused[t->draws[i].block][l];
}

/* Multiplies W of rays that arrived by the transmittance on their way. */
static void weaken_rays(const stage_run *run, worker *w, tile_rays *t) {
    float through[MANY_BLOCKS][BLOCK];
    for (int first = 0; first < t->count; first += MANY_BLOCKS) {
        int n = NOC_MIN(MANY_BLOCKS, t->count - first);
        if (!noc_cpu_through(run->s, w, t->segments + first, n, through))
            return;
        for (int i = 0; i < n * BLOCK; i++)
            t->draws[first + i / BLOCK].r.w[i % BLOCK] *= through[i / BLOCK][i % BLOCK];
    }
}

void noc_cpu_shade_shared(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->lists->rays;
    if (run->frame->plan->mixes)
        share_with_reservoirs(run, t, at);
    const gblock *g = run->s->b.g[run->frame->gbuffer];
    if (run->ctx.frame->flags & FRAME_FINAL_RAY)
        weaken_rays(run, w, t);
    for (int i = 0; i < t->count; i++) {
        size_t block = t->at[t->draws[i].block];
        if (t->segments[i].unoccluded)
            w->dropped +=
                (uint64_t)__builtin_popcount(noc_cpu_shade_samples(run, &g[block], &t->draws[i].r, &t->draws[i].brings,
                                                                   t->segments[i].unoccluded, block));
    }
}
