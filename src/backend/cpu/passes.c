/* One pass over one tile: kernels and rays in turn, block by block. */
#include "backend/cpu/cpu.h"

#include "backend/cpu/lanes_tmpl.h"
#include "core/influence_limits.h"
#include "core/presample_limits.h"
#include "core/shading.h"

int noc_cpu_tile_blocks(const stage_run *run, tile t, tile_block out[TILE_BLOCKS * TILE_BLOCKS]) {
    int n = 0;
    for (int by = t.y0; by < t.y1; by++)
        for (int bx = t.x0; bx < t.x1; bx++)
            out[n++] = (tile_block){ block_at(&run->s->b, bx, by), bx * BLOCK_SIDE, by * BLOCK_SIDE };
    return n;
}

shadow_block *noc_cpu_gather(const stage_run *run, worker *w, size_t at, uint32_t valid) {
    float(*counts)[BLOCK] = run->s->b.views.made[NOC_AOV_RAYS];
    shadow_block *s = &w->batch.blocks[w->batch.count++];
    s->valid = valid;
    s->counts = counts ? counts[at] : NULL;
    return s;
}

void noc_cpu_gather_segments(const stage_run *run, worker *w, size_t at, uint32_t valid, const gblock *g,
                             const uint32_t *id, const float *u, const float *v) {
    shadow_block *s = noc_cpu_gather(run, w, at, valid);
    memcpy(s->light, id, sizeof(s->light));
    run->k->segments(&run->ctx, g, id, u, v, &s->rays);
}

void noc_cpu_resolve(const stage_run *run, worker *w, const size_t *at, int count) {
    const frame_buffers *b = &run->s->b;
    const gblock *g = b->g[run->frame->gbuffer];
    rblock *r = b->r[run->stage->target];
    uint16_t *visible = b->visible[run->stage->target];
    size_t asked[TILE_BLOCKS * TILE_BLOCKS];
    w->batch.count = 0;
    for (int i = 0; i < count; i++) {
        uint32_t lanes = lanes_that_ask(&r[at[i]], visible[at[i]]);
        if (!lanes)
            continue;
        asked[w->batch.count] = at[i];
        noc_cpu_gather_segments(run, w, at[i], lanes, &g[at[i]], r[at[i]].light, r[at[i]].u, r[at[i]].v);
    }
    noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, w->batch.blocks, w->batch.count);
    for (int i = 0; i < w->batch.count; i++) {
        const shadow_block *s = &w->batch.blocks[i];
        block_samples(&r[asked[i]], s->valid & ~s->unoccluded);
        visible[asked[i]] |= (uint16_t)s->unoccluded;
    }
}

static void primary_block(stage_run *run, worker *w, int bx, int by) {
    const frame_buffers *b = &run->s->b;
    const v3 eye = splat3(run->ctx.frame->camera.eye);
    rayblock rays;
    uint32_t chance[BLOCK];
    for (int l = 0; l < BLOCK; l++) {
        ray_store(&rays, l, eye, frame_direction(&run->ctx, lane_x(bx * BLOCK_SIDE, l), lane_y(by * BLOCK_SIDE, l)));
        chance[l] = run->s->scene->lets_through ? key_of(&run->ctx, bx * BLOCK_SIDE, by * BLOCK_SIDE, l) : 0;
    }
    noc_cpu_primary(run, w, &rays, chance, lanes_inside(b, bx, by), block_at(b, bx, by));
}

/* Receivers that are given: no instance shows them. */
static void place_block(const stage_run *run, int bx, int by) {
    const frame_buffers *b = &run->s->b;
    const float *eye = run->ctx.frame->camera.eye;
    size_t at = block_at(b, bx, by);
    gblock *g = &b->g[run->frame->gbuffer][at];
    for (int l = 0; l < BLOCK; l++)
        receiver_store(g, l, receiver_none());
    memset(g->texel, 0, sizeof(g->texel));
    for (int l = 0; b->instance && l < BLOCK; l++)
        b->instance[at][l] = NO_INSTANCE;
    for (uint32_t bits = lanes_inside(b, bx, by); bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits), x = bx * BLOCK_SIDE + (l & 3), y = by * BLOCK_SIDE + (l >> 2);
        const noc_receiver *r = &run->frame->receivers[(size_t)y * (size_t)b->width + (size_t)x];
        receiver_store(g, l, receiver_given(splat3(r->p), splat3(r->n), r->material, splat3(eye)));
    }
}

/* The receivers of a tile, from wherever they come; what follows asks the G-buffer alone. */
static void primary(stage_run *run, worker *w, tile t) {
    for (int by = t.y0; by < t.y1; by++)
        for (int bx = t.x0; bx < t.x1; bx++)
            if (run->frame->receivers)
                place_block(run, bx, by);
            else
                primary_block(run, w, bx, by);
}

/* What the tile's points find among the influence volumes. */
static void find_volumes(stage_run *run, worker *w, const tile_points *p) {
    run->k->influence_find(&run->ctx, p->g, p->lanes, p->count, &w->picks->found);
    w->no_memory = w->no_memory || w->picks->found.no_memory;
    for (int i = 0; i < p->count; i++)
        for (uint32_t bits = p->lanes[i]; bits; bits &= bits - 1)
            w->picks->found_counts[NOC_MIN(noc_found_count(&w->picks->found, i, __builtin_ctz(bits)),
                                           run->s->found_bins - 1)]++;
}

/* What is done for each block once its reservoirs are there. */
static void end_candidates(stage_run *run, worker *w, const tile_points *points, int i) {
    rblock *r = &run->s->b.r[run->stage->target][points->block[i].at];
    if (run->frame->params->aovs)
        noc_cpu_note_candidates(run, w, i, points->block[i].at, points->lanes[i], r);
    run->s->b.visible[run->stage->target][points->block[i].at] = 0;
}

static rblock *target_block(const stage_run *run, tile_block at) { return &run->s->b.r[run->stage->target][at.at]; }

static uint32_t tile_number(const stage_run *run, tile t) {
    return (uint32_t)(t.y0 / TILE_BLOCKS * run->s->b.tiles_x + t.x0 / TILE_BLOCKS);
}

static void gather_points(const stage_run *run, tile t, tile_points *out) {
    out->count = noc_cpu_tile_blocks(run, t, out->block);
    for (int i = 0; i < out->count; i++) {
        out->g[i] = &run->s->b.g[run->frame->gbuffer][out->block[i].at];
        out->lanes[i] = lanes_with_surface(out->g[i]);
    }
}

static void find_lights(stage_run *run, worker *w, tile t) {
    tile_points points;
    gather_points(run, t, &points);
    find_volumes(run, w, &points);
}

static void build_list(stage_run *run, worker *w, tile t) {
    tile_points points;
    gather_points(run, t, &points);
    run->k->list_build(&run->ctx, points.g, points.lanes, points.count,
                       tail_start(run->ctx.frame->seed, tile_number(run, t), run->ctx.frame->index), &w->lists->build);
}

int noc_cpu_shared_draws(const stage_run *run) {
    u1 m = (u1)run->frame->plan->candidate_count;
    if (run->frame->plan->candidates == NOC_CANDIDATES_INFLUENCE)
        m -= influence_listed(m, run->ctx.frame->uniform_every);
    return (int)m;
}

/* Marks the subsets that the frame's blocks have. A small picture has few of them; nearly all are marked where blocks
 * are many, and where influence gives them to sets whose number is not known yet. */
static void mark_subsets(const stage_run *run) {
    cpu_view *s = run->s;
    size_t blocks = (size_t)s->b.blocks_x * s->b.blocks_y;
    bool all = run->frame->plan->candidates == NOC_CANDIDATES_INFLUENCE || blocks > 4 * (size_t)s->subsets;
    memset(s->wanted_subsets, all, s->subsets);
    for (size_t at = 0; at < blocks && !all; at++)
        s->wanted_subsets[presample_subset(run->ctx.frame->seed, (u1)at, run->ctx.frame->index, s->subsets)] = true;
}

static void presample(void *arg, size_t subset, int index) {
    stage_run *run = arg;
    if (!run->s->wanted_subsets[subset])
        return;
    worker *w = &run->s->workers[index];
    noc_candidates from = run->frame->plan->candidates;
    int m = noc_cpu_shared_draws(run);
    double start = noc_wall_seconds();
    run->k->presample(&run->ctx, (uint32_t)subset, m, from == NOC_CANDIDATES_POWER, w->shares->drawn,
                      run->s->samples + subset * (size_t)m);
    if (from == NOC_CANDIDATES_INFLUENCE)
        run->k->influence_volumes(&run->ctx, m, run->s->samples + subset * (size_t)m,
                                  run->s->sample_volumes + subset * (size_t)m);
    w->seconds[from == NOC_CANDIDATES_POWER       ? NOC_PASS_CANDIDATES_POWER
               : from == NOC_CANDIDATES_INFLUENCE ? NOC_PASS_CANDIDATES_INFLUENCE
                                                  : NOC_PASS_CANDIDATES_UNIFORM] += noc_wall_seconds() - start;
}

void noc_cpu_presample(stage_run *run) {
    const noc_plan *plan = run->frame->plan;
    const frame_buffers *b = &run->s->b;
    bool shared = plan->candidates == NOC_CANDIDATES_UNIFORM || plan->candidates == NOC_CANDIDATES_POWER ||
                  plan->candidates == NOC_CANDIDATES_INFLUENCE;
    if (!plan->draws || !shared || !run->ctx.light_count)
        return;
    run->s->subsets = presample_subsets((uint32_t)noc_cpu_shared_draws(run), (uint32_t)(b->blocks_x * b->blocks_y));
    mark_subsets(run);
    noc_pool_run(run->s->pool, run->s->subsets, presample, run);
}

static void candidates_shared(stage_run *run, worker *w, tile t) {
    int m = run->frame->plan->candidate_count;
    tile_points p;
    gather_points(run, t, &p);
    for (int i = 0; i < p.count; i++) {
        uint32_t subset =
            presample_subset(run->ctx.frame->seed, (uint32_t)p.block[i].at, run->ctx.frame->index, run->s->subsets);
        uint32_t pixel[BLOCK];
        noc_cpu_pixels(run, &p.block[i], pixel);
        run->k->presampled(&run->ctx, p.g[i], p.lanes[i], pixel, m, run->s->samples + (size_t)m * subset,
                           w->shares->weighed, target_block(run, p.block[i]));
        end_candidates(run, w, &p, i);
    }
}

static void candidates_list(stage_run *run, worker *w, tile t) {
    struct core_context ctx = run->ctx;
    tile_points p;
    ctx.at.lists = &w->lists->build;
    gather_points(run, t, &p);
    for (int i = 0; i < p.count; i++) {
        run->k->list_candidates(&ctx, p.g[i], p.lanes[i], p.block[i].x, p.block[i].y, target_block(run, p.block[i]));
        end_candidates(run, w, &p, i);
    }
}

static void candidates_light_bvh(stage_run *run, worker *w, tile t) {
    int m = run->frame->plan->candidate_count;
    tile_points p;
    gather_points(run, t, &p);
    for (int i = 0; i < p.count; i++) {
        if (p.lanes[i])
            run->k->pick_tree(&run->ctx, p.g[i], p.lanes[i], p.block[i].x, p.block[i].y, m, w->picks->items,
                              &w->picks->drawn);
        run->k->given(&run->ctx, p.g[i], p.lanes[i], p.block[i].x, p.block[i].y, m, &w->picks->drawn,
                      target_block(run, p.block[i]));
        end_candidates(run, w, &p, i);
    }
}

static void candidates_influence(stage_run *run, worker *w, tile t) {
    tile_points p;
    gather_points(run, t, &p);
    noc_cpu_draw_influence(run, w, &p, tile_number(run, t));
    for (int i = 0; i < p.count; i++)
        end_candidates(run, w, &p, i);
}

static void share_rays(stage_run *run, worker *w, tile t) {
    tile_points points;
    gather_points(run, t, &points);
    noc_cpu_share_candidates(run, w, &points);
}

static void visibility(stage_run *run, worker *w, tile t) {
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    size_t at[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    for (int i = 0; i < n; i++)
        at[i] = blocks[i].at;
    noc_cpu_resolve(run, w, at, n);
}

/* Samples of which only a share counts. */
static const rblock *weaken(const rblock *r, const float share[BLOCK], rblock *out) {
    *out = *r;
    for (int l = 0; l < BLOCK; l++)
        out->w[l] *= share[l];
    return out;
}

/* Emitters seen directly begin the block's colour; seen: the lanes that see one. */
static void show_emitters(const stage_run *run, const gblock *g, uint16_t *seen, cblock *c) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++) {
        v3 e = emitter_shade(&run->ctx, g->light[l]);
        c->rgb[0][l] = e.x;
        c->rgb[1][l] = e.y;
        c->rgb[2][l] = e.z;
        lanes |= lane_bits(sees_emitter(g->light[l])) << l;
    }
    *seen = (uint16_t)lanes;
}

/* Entry i of the lanes that have so many; returns those lanes. */
static uint32_t reference_entry(const reference_scratch *e, uint32_t i, rblock *r) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++) {
        bool on = i < e->count[l];
        lanes |= (uint32_t)on << l;
        r->light[l] = on ? e->light[i][l] : 0;
        r->w[l] = on ? e->w[i][l] : 0;
    }
    return lanes;
}

static uint32_t shade_reference(stage_run *run, worker *w, const gblock *g, const tile_block *block) {
    uint32_t surfaces = lanes_with_surface(g), dropped = 0, most = 0;
    bool rays = run->ctx.frame->flags & FRAME_FINAL_RAY;
    if (!surfaces)
        return 0;
    reference_scratch *e = w->reference;
    run->k->reference(&run->ctx, g, surfaces, block->x, block->y, e);
    for (int l = 0; l < BLOCK; l++)
        most = NOC_MAX(most, e->count[l]);
    for (uint32_t first = 0; first < most; first += MANY_BLOCKS) {
        uint32_t n = NOC_MIN(MANY_BLOCKS, most - first), lanes[MANY_BLOCKS];
        rblock r[MANY_BLOCKS];
        w->batch.count = 0;
        for (uint32_t i = 0; i < n; i++) {
            lanes[i] = reference_entry(e, first + i, &r[i]);
            run->k->reference_place(&run->ctx, block->x, block->y, &r[i]);
            if (rays)
                noc_cpu_gather_segments(run, w, block->at, lanes[i], g, r[i].light, r[i].u, r[i].v);
        }
        noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, w->batch.blocks, w->batch.count);
        float through[MANY_BLOCKS][BLOCK];
        bool weak = rays && noc_cpu_through(run->s, w, w->batch.blocks, w->batch.count, through);
        for (uint32_t i = 0; i < n; i++) {
            rblock part;
            const rblock *shaded = weak ? weaken(&r[i], through[i], &part) : &r[i];
            dropped |=
                noc_cpu_shade_samples(run, g, shaded, NULL, rays ? w->batch.blocks[i].unoccluded : lanes[i], block->at);
        }
    }
    return dropped;
}

/* The samples of a tile's reservoirs: rays to those that are not known to be seen, all at once; to all of them where
 * surfaces let light through, since how much is not known of any. share: what of each pixel's light is its sample's;
 * NULL: all. */
static void shade_samples(stage_run *run, worker *w, const tile_block *blocks, int n, const float (*share)[BLOCK]) {
    frame_buffers *b = &run->s->b;
    const gblock *g = b->g[run->frame->gbuffer];
    const rblock *r = b->r[run->stage->target];
    const uint16_t *visible = run->s->scene->lets_through ? NULL : b->visible[run->stage->target];
    uint32_t lanes[TILE_BLOCKS * TILE_BLOCKS], asked[TILE_BLOCKS * TILE_BLOCKS];
    float through[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
    w->batch.count = 0;
    for (int i = 0; i < n; i++) {
        size_t at = blocks[i].at;
        lanes[i] = lanes_with_sample(&r[at]);
        asked[i] = run->ctx.frame->flags & FRAME_FINAL_RAY ? lanes_that_ask(&r[at], visible ? visible[at] : 0) : 0;
        if (asked[i])
            noc_cpu_gather_segments(run, w, at, asked[i], &g[at], r[at].light, r[at].u, r[at].v);
    }
    noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, w->batch.blocks, w->batch.count);
    bool weak = noc_cpu_through(run->s, w, w->batch.blocks, w->batch.count, through);
    for (int i = 0, answer = 0; i < n; i++) {
        size_t at = blocks[i].at;
        rblock part, mixed;
        const rblock *shaded = &r[at];
        if (asked[i]) {
            lanes[i] = (lanes[i] & ~asked[i]) | w->batch.blocks[answer].unoccluded;
            shaded = weak ? weaken(shaded, through[answer], &part) : shaded;
            answer++;
        }
        if (share)
            shaded = weaken(shaded, share[i], &mixed);
        if (lanes[i])
            w->dropped += (uint64_t)__builtin_popcount(noc_cpu_shade_samples(run, &g[at], shaded, NULL, lanes[i], at));
    }
}

static void emitters(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    const gblock *g = b->g[run->frame->gbuffer];
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    for (int i = 0; i < n; i++) {
        size_t at = blocks[i].at;
        show_emitters(run, &g[at], &b->emitter[at], &b->colour[at]);
        noc_cpu_note_emitters(run, &g[at], &b->colour[at], at);
    }
}

static void shade(stage_run *run, worker *w, tile t) {
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    shade_samples(run, w, blocks, n, run->frame->plan->mixes ? (const float(*)[BLOCK])w->lists->rays.reused : NULL);
}

static void shade_all(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    const gblock *g = b->g[run->frame->gbuffer];
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    for (int i = 0; i < n; i++) {
        size_t at = blocks[i].at;
        w->dropped += (uint64_t)__builtin_popcount(shade_reference(run, w, &g[at], &blocks[i]));
    }
}

/* Surfaces that are no emitter's, and the sky behind all. */
static void headlight(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    const gblock *g = b->g[run->frame->gbuffer];
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    for (int i = 0; i < n; i++) {
        size_t at = blocks[i].at;
        uint32_t surfaces = lanes_with_surface(&g[at]),
                 inside = lanes_inside(b, blocks[i].x / BLOCK_SIDE, blocks[i].y / BLOCK_SIDE);
        run->k->headlight(&run->ctx, &g[at], surfaces, &b->colour[at]);
        run->k->sky_background(&run->ctx, inside & ~surfaces, blocks[i].x, blocks[i].y, &b->colour[at]);
    }
}

static void sky(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    const noc_frame *f = run->frame;
    const gblock *g = b->g[f->gbuffer];
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    uint8_t turns[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
    size_t asked[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks), most = f->params->sky > 0 ? SKY_RAYS : 0;
    if (f->constants.flags & FRAME_MAP_LIGHTS)
        most = SKY_RAYS;
    for (int i = 0; i < n; i++) {
        size_t at = blocks[i].at;
        uint32_t background =
            lanes_inside(b, blocks[i].x / BLOCK_SIDE, blocks[i].y / BLOCK_SIDE) & ~lanes_with_surface(&g[at]);
        for (int l = 0; l < BLOCK; l++) {
            const cblock *c = &b->colour[at];
            turns[i][l] = (uint8_t)sky_turns(&run->ctx, V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
        }
        if (background)
            run->k->sky_background(&run->ctx, background, blocks[i].x, blocks[i].y, &b->colour[at]);
    }
    for (int turn = 0; turn < most; turn++) {
        float share[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
        w->batch.count = 0;
        for (int i = 0; i < n; i++) {
            size_t at = blocks[i].at;
            uint32_t lanes = lanes_with_surface(&g[at]), number[BLOCK];
            for (int l = 0; l < BLOCK; l++) {
                number[l] = run->ctx.frame->index * turns[i][l] + (uint32_t)turn;
                share[w->batch.count][l] = 1.0f / turns[i][l];
                if (turn >= turns[i][l])
                    lanes &= ~(1u << l);
            }
            if (!lanes)
                continue;
            asked[w->batch.count] = at;
            shadow_block *s = noc_cpu_gather(run, w, at, lanes);
            run->k->sky_rays(&run->ctx, &g[at], blocks[i].x, blocks[i].y, number, &s->rays);
            memset(s->light, 0, sizeof(s->light));
        }
        noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, w->batch.blocks, w->batch.count);
        float through[TILE_BLOCKS * TILE_BLOCKS][BLOCK];
        bool weak = noc_cpu_through(run->s, w, w->batch.blocks, w->batch.count, through);
        for (int i = 0; i < w->batch.count; i++) {
            const shadow_block *s = &w->batch.blocks[i];
            size_t at = asked[i];
            for (int l = 0; weak && l < BLOCK; l++)
                share[i][l] *= through[i][l];
            if (s->unoccluded)
                w->dropped +=
                    (uint64_t)__builtin_popcount(noc_cpu_shade_sky(run, &g[at], &s->rays, share[i], s->unoccluded, at));
        }
    }
}

void noc_cpu_pass(stage_run *run, worker *w, noc_pass pass, tile t) {
    static void (*const passes[NOC_PASS_COUNT])(stage_run *, worker *, tile) = {
        [NOC_PASS_PRIMARY] = primary,
        [NOC_PASS_FIND_LIGHTS] = find_lights,
        [NOC_PASS_BUILD_LIST] = build_list,
        [NOC_PASS_CANDIDATES_UNIFORM] = candidates_shared,
        [NOC_PASS_CANDIDATES_LIST] = candidates_list,
        [NOC_PASS_CANDIDATES_POWER] = candidates_shared,
        [NOC_PASS_CANDIDATES_INFLUENCE] = candidates_influence,
        [NOC_PASS_CANDIDATES_LIGHT_BVH] = candidates_light_bvh,
        [NOC_PASS_SEEN_BEFORE] = noc_cpu_seen_before,
        [NOC_PASS_SHARE_RAYS] = share_rays,
        [NOC_PASS_VISIBILITY] = visibility,
        [NOC_PASS_TRACE_SHARED] = noc_cpu_trace_shared,
        [NOC_PASS_RESAMPLE] = noc_cpu_resample,
        [NOC_PASS_TEMPORAL] = noc_cpu_temporal,
        [NOC_PASS_SPATIAL] = noc_cpu_spatial,
        [NOC_PASS_EMITTERS] = emitters,
        [NOC_PASS_SHADE_SHARED] = noc_cpu_shade_shared,
        [NOC_PASS_SHADE] = shade,
        [NOC_PASS_SHADE_ALL] = shade_all,
        [NOC_PASS_HEADLIGHT] = headlight,
        [NOC_PASS_SKY] = sky,
    };
    if (run->ctx.light_count || noc_pass_without_lights(pass))
        passes[pass](run, w, t);
}
