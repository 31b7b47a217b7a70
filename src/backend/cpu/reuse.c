/* Temporal and spatial reuse of a tile's blocks: neighbours' reservoirs are fetched, combined by core/reuse.h, and
 * visibility is traced where the combination needs it.
 *
 * With bias rays a reservoir's target function includes visibility at its own pixel: every reservoir that is reused has
 * either an unoccluded sample or W = 0. Then the neighbours' p_j in the balance heuristic needs one shadow ray from the
 * neighbour; visibility at the receiving pixel need not be in the weights, since a sample that is occluded there counts
 * as nothing whatever its weight. Without bias rays the targets are unshadowed: unbiased without visibility reuse,
 * biased with. */
#include "backend/cpu/cpu.h"

#include "core/random.h"
#include "core/warp.h"

#include <math.h>

static size_t block_at(const frame_buffers *b, int bx, int by) { return (size_t)by * b->blocks_x + bx; }

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

/* Is the surface of lane j of h like that of lane l of g, seen from about the same distance? */
static bool alike(const frame_constants *p, const gblock *g, int l, const gblock *h, int j) {
    if (h->material[j] == NO_SURFACE)
        return false;
    float cosine = g->nx[l] * h->nx[j] + g->ny[l] * h->ny[j] + g->nz[l] * h->nz[j];
    float off = g->nx[l] * (h->px[j] - g->px[l]) + g->ny[l] * (h->py[j] - g->py[l]) + g->nz[l] * (h->pz[j] - g->pz[l]);
    return cosine >= p->reject_normal && fabsf(off) <= p->reject_depth * g->depth[l];
}

static void clear(neighbour *n) {
    n->lanes = 0;
    memset(&n->r, 0, sizeof(n->r));
}

/* Up to where visibility is needed: offers (not pairwise), and targets at the neighbours. there: the lights that the
 * neighbours' reservoirs were made with. */
static void begin(const stage_run *run, const struct core_context *there, combining *b, const float eye[3],
                  uint32_t dim) {
    const gblock *g = &run->s->b.g[run->frame->gbuffer][b->at];
    uint32_t bias = run->ctx.frame->bias;
    combination *c = &b->c;
    memset(b->asked, 0, sizeof(b->asked));
    memset(b->seen, 0xff, sizeof(b->seen));
    if (bias == BIAS_PAIRWISE) {
        run->k->targets(there, eye, b->n, b->k, b->own->light, b->own->u, b->own->v, c);
        return;
    }
    run->k->offer(&run->ctx, g, b->own, b->n, b->k, b->x, b->y, dim, c);
    if (bias == BIAS_MIS)
        run->k->targets(there, eye, b->n, b->k, c->light, c->u, c->v, c);
}

/* Asks for rays from the neighbours to the canonical samples (pairwise) or to those held (mis). */
static void ask_neighbours(const stage_run *run, const struct core_context *there, worker *w, combining *b) {
    bool pairwise = run->ctx.frame->bias == BIAS_PAIRWISE;
    const combination *c = &b->c;
    for (int i = 0; i < b->k; i++) {
        uint32_t lanes = 0;
        for (int l = 0; l < BLOCK; l++) {
            /* the neighbour that a sample came from sees it */
            bool wanted = pairwise ? b->own->w[l] > 0 : c->w_sum[l] > 0 && c->tag[l] != (float)(i + 1);
            lanes |= (uint32_t)(wanted && c->p_at[i][l] > 0) << l;
        }
        lanes &= b->n[i].lanes;
        if (!lanes)
            continue;
        b->asked[i] = lanes;
        segment_block *s = noc_cpu_gather(run, w, b->at, lanes);
        memcpy(s->light, pairwise ? b->own->light : c->light, sizeof(s->light));
        if (pairwise)
            run->k->segments(there, &b->n[i].g, b->own->light, b->own->u, b->own->v, &s->rays);
        else
            run->k->segments(there, &b->n[i].g, c->light, c->u, c->v, &s->rays);
    }
}

/* From the answers to the new reservoir, in the place of the old one or elsewhere. */
static void end(const stage_run *run, combining *b, uint32_t dim, rblock *to) {
    const gblock *g = &run->s->b.g[run->frame->gbuffer][b->at];
    rblock out;
    switch (run->ctx.frame->bias) {
    case BIAS_PAIRWISE:
        run->k->end_pairwise(&run->ctx, g, b->own, b->n, b->k, b->seen, b->x, b->y, dim, &b->c, &out);
        break;
    case BIAS_MIS: run->k->end_mis(&b->c, b->own, b->n, b->k, b->seen, &out); break;
    case BIAS_BIASED: run->k->end_biased(&b->c, &out); break;
    }
    for (int l = 0; l < BLOCK; l++)
        if (b->c.tag[l] != 0)
            b->visible &= ~(1u << l);
    *to = out;
}

/* Zeroes samples that are occluded at their own pixel, so that all that are left are known to be visible. */
static void resolve(const stage_run *run, worker *w, int count) {
    const gblock *g = run->s->b.g[run->frame->gbuffer];
    rblock *r = run->s->b.r[run->stage->target];
    combining *asked[TILE_BLOCKS * TILE_BLOCKS];
    w->batch.count = 0;
    for (int i = 0; i < count; i++) {
        size_t at = w->combining[i].at;
        uint32_t lanes = lanes_with_sample(&r[at]) & ~w->combining[i].visible;
        if (!lanes)
            continue;
        asked[w->batch.count] = &w->combining[i];
        noc_cpu_gather_segments(run, w, at, lanes, &g[at], r[at].light, r[at].u, r[at].v);
    }
    noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, w->batch.blocks, w->batch.count);
    for (int i = 0; i < w->batch.count; i++) {
        const segment_block *s = &w->batch.blocks[i];
        asked[i]->visible |= s->clear;
        for (int l = 0; l < BLOCK; l++)
            if (s->valid >> l & ~(s->clear >> l) & 1)
                r[asked[i]->at].w[l] = 0;
    }
}

/* Combines the first `count` of w->combining into the stage's target. All rays of a step are traced in company. */
static void combine(stage_run *run, const struct core_context *there, noc_ray_world in, worker *w, int count,
                    const float eye[3], uint32_t dim) {
    frame_buffers *b = &run->s->b;
    bool rays = run->ctx.frame->flags & FRAME_BIAS_RAYS;
    w->batch.count = 0;
    for (int i = 0; i < count; i++) {
        begin(run, there, &w->combining[i], eye, dim);
        if (rays)
            ask_neighbours(run, there, w, &w->combining[i]);
    }
    noc_cpu_trace_occlusion(run->s, w, in, w->batch.blocks, w->batch.count);
    const segment_block *answer = w->batch.blocks;
    for (int i = 0; i < count; i++) {
        combining *c = &w->combining[i];
        for (int k = 0; k < c->k; k++)
            if (c->asked[k])
                c->seen[k] = answer++->clear | ~c->asked[k];
        end(run, c, dim, &b->r[run->stage->target][c->at]);
    }
    if (run->stage->resolve_visibility)
        resolve(run, w, count);
    for (int i = 0; i < count; i++)
        b->visible[run->stage->target][w->combining[i].at] = (uint16_t)w->combining[i].visible;
}

/* What the last frame left where the block's surfaces were; false: nothing. */
static bool fetch_history(const stage_run *run, const tile_block *block, combining *c) {
    const noc_frame *f = run->frame;
    const frame_buffers *b = &run->s->b;
    gblock moved;
    const gblock *g = noc_cpu_taken_back(run->s, block->at, &b->g[f->gbuffer][block->at], &moved);
    uint32_t surfaces = lanes_with_surface(g);
    if (!surfaces)
        return false;
    ALIGNED float px[BLOCK], py[BLOCK];
    uint32_t front = run->k->project(&run->ctx, g, px, py) & surfaces;
    neighbour *n = c->n;
    clear(n);
    for (int l = 0; l < BLOCK; l++) {
        if (!(front >> l & 1) || !(px[l] >= 0 && px[l] < (float)b->width && py[l] >= 0 && py[l] < (float)b->height))
            continue;
        int x = NOC_MIN((int)px[l], b->width - 1), y = NOC_MIN((int)py[l], b->height - 1), j = (y & 3) * 4 + (x & 3);
        size_t from = block_at(b, x / BLOCK_SIDE, y / BLOCK_SIDE);
        const gblock *h = &b->g[1 - f->gbuffer][from];
        if (!alike(run->ctx.frame, g, l, h, j))
            continue;
        fetch(h, &b->r[run->stage->source][from], j, l, n);
        n->r.m[l] = NOC_MIN(n->r.m[l], run->ctx.frame->m_max);
    }
    c->k = 1;
    return n->lanes != 0;
}

void noc_cpu_temporal(stage_run *run, worker *w, tile t) {
    const noc_frame *f = run->frame;
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks), count = 0;
    if (!f->history || run->s->past_lost)
        return;
    for (int i = 0; i < n; i++) {
        combining *c = &w->combining[count];
        if (!fetch_history(run, &blocks[i], c))
            continue;
        c->at = blocks[i].at;
        c->x = blocks[i].x;
        c->y = blocks[i].y;
        c->own = &run->s->b.r[run->stage->target][c->at];
        c->visible = run->s->b.visible[run->stage->target][c->at];
        count++;
    }
    noc_ray_world in;
    struct core_context past = noc_cpu_past(run->s, &run->ctx, &in);
    combine(run, &past, in, w, count, run->ctx.frame->previous.eye, DIM_TEMPORAL);
}

/* Neighbour places are drawn once a block: pixels next to each other read reservoirs next to each other, and their bias
 * rays are nearly parallel. Each pixel still has its own set of neighbours, chosen without regard to any sample. */
static void neighbour_place(const frame_constants *f, uint32_t key, uint32_t dim, int *dx, int *dy) {
    float radius = f->radius * sqrtf(rng(key, dim));
    v3 c = circle(rng(key, dim + 1));
    *dx = (int)lrintf(radius * c.x);
    *dy = (int)lrintf(radius * c.y);
    if (!*dx && !*dy)
        *dx = 1;
}

static void fetch_neighbours(const stage_run *run, const tile_block *block, uint32_t dim, combining *c) {
    const frame_constants *f = run->ctx.frame;
    const frame_buffers *b = &run->s->b;
    const gblock *buffer = b->g[run->frame->gbuffer], *g = &buffer[block->at];
    uint32_t surfaces = lanes_with_surface(g), key = rng_key(f->seed ^ 0x5bd1e995u, (uint32_t)block->at, f->index);
    c->k = 0;
    for (int i = 0; surfaces && i < (int)f->neighbours; i++) {
        neighbour *n = &c->n[c->k];
        int dx, dy;
        neighbour_place(f, key, dim + 3u * (uint32_t)i, &dx, &dy);
        clear(n);
        for (int l = 0; l < BLOCK; l++) {
            int x = block->x + (l & 3) + dx, y = block->y + (l >> 2) + dy;
            if (!(surfaces >> l & 1) || x < 0 || y < 0 || x >= b->width || y >= b->height)
                continue;
            size_t from = block_at(b, x / BLOCK_SIDE, y / BLOCK_SIDE);
            const gblock *h = &buffer[from];
            int j = (y & 3) * 4 + (x & 3);
            if (alike(f, g, l, h, j))
                fetch(h, &b->r[run->stage->source][from], j, l, n);
        }
        c->k += n->lanes != 0;
    }
}

void noc_cpu_spatial(stage_run *run, worker *w, tile t) {
    frame_buffers *b = &run->s->b;
    uint32_t dim = DIM_SPATIAL + 64u * (uint32_t)run->stage->round;
    int source = run->stage->source, target = run->stage->target;
    tile_block blocks[TILE_BLOCKS * TILE_BLOCKS];
    int n = noc_cpu_tile_blocks(run, t, blocks), count = 0;
    for (int i = 0; i < n; i++) {
        combining *c = &w->combining[count];
        size_t at = blocks[i].at;
        fetch_neighbours(run, &blocks[i], dim, c);
        if (!c->k) {
            b->r[target][at] = b->r[source][at];
            b->visible[target][at] = b->visible[source][at];
            continue;
        }
        c->at = at;
        c->x = blocks[i].x;
        c->y = blocks[i].y;
        c->own = &b->r[source][at];
        c->visible = b->visible[source][at];
        count++;
    }
    combine(run, &run->ctx, NOC_RAYS_NOW, w, count, run->ctx.frame->camera.eye, dim);
}
