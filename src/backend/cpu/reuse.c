/* Temporal and spatial reuse of a tile's blocks: neighbours' reservoirs are fetched (core/neighbours.h) and combined
 * (core/combine.h), and visibility is traced where the combination asks for it.
 */
#include "backend/cpu/cpu.h"
#include "backend/cpu/lanes_tmpl.h"
#include "core/list_mix.h"
#include "core/neighbours.h"

/* Lane `from` of a pixel's surface and reservoir into lane `to` of n. Blocks are arrays of BLOCK four-byte values. */
static void fetch(const gblock *g, const rblock *r, int from, int to, neighbour *n) {
    const char *sg = (const char *)g + 4 * from, *sr = (const char *)r + 4 * from;
    char *dg = (char *)&n->g + 4 * to, *dr = (char *)&n->r + 4 * to;
    for (size_t at = 0; at < sizeof(gblock); at += 4 * BLOCK)
        memcpy(dg + at, sg + at, 4);
    for (size_t at = 0; at < sizeof(rblock); at += 4 * BLOCK)
        memcpy(dr + at, sr + at, 4);
    n->lanes |= 1u << to;
}

static void clear(neighbour *n) {
    n->lanes = 0;
    memset(&n->r, 0, sizeof(n->r));
}

/* Gathers the rays from the neighbours that the block asks for. */
static void ask_neighbours(const stage_run *run, const struct core_context *there, worker *w, combining *b) {
    for (int i = 0; i < b->k; i++) {
        if (!b->asked[i])
            continue;
        shadow_block *s = noc_cpu_gather(run, w, b->at, b->asked[i]);
        memcpy(s->light, b->held.light, sizeof(s->light));
        run->k->segments(there, noc_asked_surface(b, i), b->held.light, b->held.u, b->held.v, &s->rays);
    }
}

static void finish(const stage_run *run, combining *c) {
    frame_buffers *b = &run->s->b;
    rblock out; /* the old one may lie where the new one goes */
    run->k->reuse_end(&run->ctx, c, &out);
    b->r[run->stage->target][c->at] = out;
    b->visible[run->stage->target][c->at] = (uint16_t)c->visible;
}

/* Combines the first `count` of w->combining into the stage's target. All rays of a step are traced in company; where
 * there are none, each block is done while it is in the cache. there: the context with the lights that the neighbours'
 * reservoirs were made with. */
static void combine(stage_run *run, const struct core_context *there, noc_ray_world in, worker *w, int count) {
    bool rays = run->ctx.frame->flags & FRAME_BIAS_RAYS;
    w->batch.count = 0;
    for (int i = 0; i < count; i++) {
        combining *c = &w->combining[i];
        run->k->reuse_begin(&run->ctx, c);
        if (run->ctx.frame->bias != BIAS_BIASED)
            run->k->reuse_ask(there, c);
        if (rays) {
            ask_neighbours(run, there, w, c);
            continue;
        }
        memset(c->asked, 0, sizeof(c->asked));
        finish(run, c);
    }
    if (rays) {
        noc_cpu_trace_occlusion(run->s, w, in, w->batch.blocks, w->batch.count);
        const shadow_block *answer = w->batch.blocks;
        for (int i = 0; i < count; i++) {
            combining *c = &w->combining[i];
            for (int k = 0; k < c->k; k++)
                if (c->asked[k])
                    c->unoccluded[k] = answer++->unoccluded;
            finish(run, c);
        }
    }
}

/* Of the tile's blocks, whether or not they have neighbours. */
static void resolve(const stage_run *run, worker *w, const tile_block *blocks, int count) {
    size_t at[TILE_BLOCKS * TILE_BLOCKS];
    for (int i = 0; i < count; i++)
        at[i] = blocks[i].at;
    if (run->stage->resolve_visibility)
        noc_cpu_resolve(run, w, at, count);
}

/* Lane l of n becomes the pixel at (x, y) of these buffers, if its surface is like `here`. */
static void fetch_alike(const stage_run *run, const gblock *g, const rblock *r, receiver here, pixel at, int l,
                        neighbour *n) {
    size_t from = block_at(&run->s->b, (int)at.x / BLOCK_SIDE, (int)at.y / BLOCK_SIDE);
    int lane = (int)((at.y & 3) * 4 + (at.x & 3));
    if (receivers_alike(&run->ctx, here, receiver_load(&g[from], lane)))
        fetch(&g[from], &r[from], lane, l, n);
}

/* What the last frame left where the block's surfaces were; false: nothing. */
static bool fetch_history(const stage_run *run, combining *c) {
    const frame_buffers *b = &run->s->b;
    gblock moved;
    const gblock *g = noc_cpu_taken_back(run->s, c->at, c->g, &moved);
    uint32_t x[BLOCK], y[BLOCK], places = run->k->history_places(&run->ctx, g, x, y);
    if (!places)
        return false;
    const gblock *from = b->g[run->frame->previous_gbuffer];
    const rblock *r = b->r[run->stage->source];
    neighbour *n = c->n;
    int first = __builtin_ctz(places), dx = (int)x[first] - (first & 3), dy = (int)y[first] - (first >> 2);
    bool together = true;
    for (int l = 0; l < BLOCK; l++)
        together =
            together && (!(places >> l & 1) || (x[l] == (uint32_t)(dx + (l & 3)) && y[l] == (uint32_t)(dy + (l >> 2))));
    if (together) {
        run->k->neighbours(&run->ctx, from, r, g, places, dx, dy, n);
    } else {
        clear(n);
        for (uint32_t bits = places; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            fetch_alike(run, from, r, receiver_load(g, l), (pixel){ x[l], y[l], true }, l, n);
        }
    }
    for (int l = 0; l < BLOCK; l++)
        n->r.m[l] = min_(n->r.m[l], run->ctx.frame->m_max);
    c->k = 1;
    return n->lanes != 0;
}

/* A block with its reservoirs in `set`. */
static void start(const stage_run *run, const tile_block *block, int set, combining *c) {
    c->at = block->at;
    c->x = block->x;
    c->y = block->y;
    c->g = &run->s->b.g[run->frame->gbuffer][block->at];
    c->own = &run->s->b.r[set][block->at];
    c->visible = run->s->b.visible[set][block->at];
}

static bool has_history(const stage_run *run) { return run->ctx.frame->flags & FRAME_HISTORY && !run->s->past.lost; }

void noc_cpu_seen_before(stage_run *run, worker *w, tile t) {
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks);
    combining *c = w->combining;
    for (int i = 0; i < n; i++) {
        uint32_t *fresh = &w->lists->rays.fresh[i];
        *fresh = lanes_with_surface(&run->s->b.g[run->frame->gbuffer][blocks[i].at]);
        start(run, &blocks[i], run->stage->target, c);
        if (!has_history(run) || !fetch_history(run, c))
            continue;
        for (int l = 0; l < BLOCK; l++)
            *fresh &= ~(lane_bits(not_(list_is_fresh(c->n->r.m[l], (f1)run->ctx.frame->draws))) << l);
    }
}

void noc_cpu_temporal(stage_run *run, worker *w, tile t) {
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks), count = 0;
    if (!has_history(run))
        return;
    for (int i = 0; i < n; i++) {
        combining *c = &w->combining[count];
        start(run, &blocks[i], run->stage->target, c);
        c->dim = DIM_TEMPORAL;
        c->eye = &run->ctx.frame->previous;
        count += fetch_history(run, c);
    }
    noc_ray_world in;
    struct core_context past = noc_cpu_previous(run->s, &run->ctx, &in);
    combine(run, &past, in, w, count);
    resolve(run, w, blocks, n);
}

/* False: no lane has any neighbour. */
static bool fetch_neighbours(const stage_run *run, combining *c) {
    const gblock *g = run->s->b.g[run->frame->gbuffer];
    const rblock *r = run->s->b.r[run->stage->source];
    uint32_t surfaces = lanes_with_surface(c->g), key = neighbour_key(&run->ctx, (uint32_t)c->x, (uint32_t)c->y);
    uint32_t some = 0;
    c->k = (int)run->ctx.frame->neighbours;
    for (uint32_t i = 0; surfaces && i < run->ctx.frame->neighbours; i++) {
        v3 offset = neighbour_offset(&run->ctx, key, c->dim + DIM_NEIGHBOUR(i));
        run->k->neighbours(&run->ctx, g, r, c->g, surfaces, c->x + (int)offset.x, c->y + (int)offset.y, &c->n[i]);
        some |= c->n[i].lanes;
    }
    return some != 0;
}

void noc_cpu_spatial(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    int source = run->stage->source, target = run->stage->target;
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks), count = 0;
    for (int i = 0; i < n; i++) {
        combining *c = &w->combining[count];
        size_t at = blocks[i].at;
        start(run, &blocks[i], source, c);
        c->dim = DIM_SPATIAL + 64u * (uint32_t)run->stage->round;
        c->eye = &run->ctx.frame->camera;
        if (!fetch_neighbours(run, c)) { /* core/combine.h leaves the reservoirs as they are */
            b->r[target][at] = b->r[source][at];
            b->visible[target][at] = b->visible[source][at];
            continue;
        }
        count++;
    }
    combine(run, &run->ctx, NOC_RAYS_NOW, w, count);
    resolve(run, w, blocks, n);
}
