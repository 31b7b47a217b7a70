/* Temporal and spatial reuse of one block: neighbours' reservoirs are fetched, combined by core/reuse.h, and visibility is
 * traced where the combination needs it.
 *
 * With bias rays a reservoir's target function includes visibility at its own pixel: every reservoir that is reused has
 * either an unoccluded sample or W = 0. Then the neighbours' p_j in the balance heuristic needs one shadow ray from the
 * neighbour; visibility at the receiving pixel need not be in the weights, since a sample that is occluded there counts as
 * nothing whatever its weight. Without bias rays the targets are unshadowed: unbiased without visibility reuse, biased with. */
#include "backend/embree/embree.h"

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
static bool alike(const noc_render_params *p, const gblock *g, int l, const gblock *h, int j) {
    if (h->material[j] == NO_SURFACE)
        return false;
    float cosine = g->nx[l] * h->nx[j] + g->ny[l] * h->ny[j] + g->nz[l] * h->nz[j];
    float off = g->nx[l] * (h->px[j] - g->px[l]) + g->ny[l] * (h->py[j] - g->py[l]) + g->nz[l] * (h->pz[j] - g->pz[l]);
    return cosine >= (float)p->reject_normal && fabsf(off) <= (float)p->reject_depth * g->depth[l];
}

static void clear(neighbour *n) {
    n->lanes = 0;
    memset(&n->r, 0, sizeof(n->r));
}

/* Visibility of a sample at the neighbours: bit l of seen[i]. */
static void trace_at(stage_run *run, worker *w, const neighbour *n, int k, const uint32_t *light, const float *u,
                     const float *v, const combination *c, const uint32_t *wanted, uint32_t *seen) {
    for (int i = 0; i < k; i++) {
        uint32_t lanes = 0;
        for (int l = 0; l < BLOCK; l++)
            lanes |= (uint32_t)(c->p_at[i][l] > 0) << l;
        lanes &= wanted[i] & n[i].lanes;
        if (!lanes)
            continue;
        rayblock rays;
        run->k->segments(&run->ctx, &n[i].g, light, u, v, &rays);
        seen[i] = noc_embree_free(run->s, w, &rays, lanes) | (seen[i] & ~lanes);
    }
}

/* Combines own with k neighbours into *out; *visible: lanes whose sample is known to be seen from this pixel. */
static void combine(stage_run *run, worker *w, const gblock *g, const rblock *own, uint32_t *visible, const neighbour *n,
                    int k, const float eye[3], int x, int y, uint32_t dim, rblock *out) {
    const noc_render_params *p = run->ctx.frame->params;
    const kernels *K = run->k;
    bool rays = noc_uses_bias_rays(p);
    combination c;
    uint32_t seen[MAX_NEIGHBOURS], wanted[MAX_NEIGHBOURS], own_sample = 0;
    for (int l = 0; l < BLOCK; l++)
        own_sample |= (uint32_t)(own->w[l] > 0) << l;
    if (p->bias == NOC_BIAS_PAIRWISE) {
        K->targets(&run->ctx, eye, n, k, own->light, own->u, own->v, &c);
        for (int i = 0; i < k; i++) {
            seen[i] = 0xffff;
            wanted[i] = own_sample;
        }
        if (rays)
            trace_at(run, w, n, k, own->light, own->u, own->v, &c, wanted, seen);
        K->end_pairwise(&run->ctx, g, own, n, k, seen, x, y, dim, &c, out);
    } else {
        K->offer(&run->ctx, g, own, n, k, x, y, dim, &c);
        if (p->bias == NOC_BIAS_MIS) {
            K->targets(&run->ctx, eye, n, k, c.light, c.u, c.v, &c);
            for (int i = 0; i < k; i++) {
                seen[i] = 0xffff;
                wanted[i] = 0; /* the neighbour that the sample came from sees it */
                for (int l = 0; l < BLOCK; l++)
                    wanted[i] |= (uint32_t)(c.w_sum[l] > 0 && c.tag[l] != (float)(i + 1)) << l;
            }
            if (rays)
                trace_at(run, w, n, k, c.light, c.u, c.v, &c, wanted, seen);
            K->end_mis(&c, own, n, k, seen, out);
        } else {
            K->end_biased(&c, out);
        }
    }
    for (int l = 0; l < BLOCK; l++)
        if (c.tag[l] != 0)
            *visible &= ~(1u << l);
}

/* Zeroes samples that are occluded at their own pixel, so that all that are left are known to be visible. */
static void resolve(stage_run *run, worker *w, const gblock *g, rblock *r, uint32_t *visible) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(r->w[l] > 0) << l;
    lanes &= ~*visible;
    if (!lanes)
        return;
    rayblock rays;
    run->k->segments(&run->ctx, g, r->light, r->u, r->v, &rays);
    uint32_t seen = noc_embree_free(run->s, w, &rays, lanes);
    *visible |= seen;
    for (int l = 0; l < BLOCK; l++)
        if (lanes >> l & ~(seen >> l) & 1)
            r->w[l] = 0;
}

void noc_embree_temporal(stage_run *run, worker *w, int bx, int by) {
    const noc_frame *f = run->ctx.frame;
    const noc_render_params *p = f->params;
    frame_buffers *b = &run->s->b;
    size_t at = block_at(b, bx, by);
    const gblock *g = &b->g[f->gbuffer][at];
    uint32_t surfaces = lanes_with_surface(g);
    if (!f->history || !surfaces)
        return;
    ALIGNED float px[BLOCK], py[BLOCK];
    /* Static geometry: a surface was where it is. A moved one would be taken back by its own motion here. */
    uint32_t front = run->k->project(&run->ctx, g, px, py) & surfaces;
    neighbour *n = w->neighbours;
    clear(n);
    float m_max = (float)(p->history * p->draws);
    for (int l = 0; l < BLOCK; l++) {
        if (!(front >> l & 1) || !(px[l] >= 0 && px[l] < (float)b->width && py[l] >= 0 && py[l] < (float)b->height))
            continue;
        int x = NOC_MIN((int)px[l], b->width - 1), y = NOC_MIN((int)py[l], b->height - 1), j = (y & 3) * 4 + (x & 3);
        size_t from = block_at(b, x / BLOCK_SIDE, y / BLOCK_SIDE);
        const gblock *h = &b->g[1 - f->gbuffer][from];
        if (!alike(p, g, l, h, j))
            continue;
        fetch(h, &b->r[run->stage->source][from], j, l, n);
        n->r.m[l] = NOC_MIN(n->r.m[l], m_max);
    }
    if (!n->lanes)
        return;
    rblock *r = &b->r[run->stage->target][at], out;
    uint32_t visible = b->visible[run->stage->target][at];
    combine(run, w, g, r, &visible, n, 1, f->previous.eye, bx * BLOCK_SIDE, by * BLOCK_SIDE, DIM_TEMPORAL, &out);
    if (run->stage->resolve_visibility)
        resolve(run, w, g, &out, &visible);
    *r = out;
    b->visible[run->stage->target][at] = (uint16_t)visible;
}

/* Neighbour places are drawn once a block: pixels next to each other read reservoirs next to each other, and their bias rays
 * are nearly parallel. Each pixel still has its own set of neighbours, chosen without regard to any sample. */
static void neighbour_place(const noc_frame *f, uint32_t key, uint32_t dim, int *dx, int *dy) {
    float radius = (float)f->params->radius * sqrtf(rng(key, dim));
    v3 c = circle(rng(key, dim + 1));
    *dx = (int)lrintf(radius * c.x);
    *dy = (int)lrintf(radius * c.y);
    if (!*dx && !*dy)
        *dx = 1;
}

void noc_embree_spatial(stage_run *run, worker *w, int bx, int by) {
    const noc_frame *f = run->ctx.frame;
    const noc_render_params *p = f->params;
    frame_buffers *b = &run->s->b;
    size_t at = block_at(b, bx, by);
    const gblock *g = &b->g[f->gbuffer][at];
    const rblock *own = &b->r[run->stage->source][at];
    rblock *out = &b->r[run->stage->target][at];
    uint32_t surfaces = lanes_with_surface(g), visible = b->visible[run->stage->source][at];
    int x0 = bx * BLOCK_SIDE, y0 = by * BLOCK_SIDE, k = 0;
    uint32_t dim = DIM_SPATIAL + 64u * (uint32_t)run->stage->round;
    uint32_t key = rng_key(p->seed ^ 0x5bd1e995u, (uint32_t)at, f->index);
    for (int i = 0; surfaces && i < p->neighbours; i++) {
        neighbour *n = &w->neighbours[k];
        int dx, dy;
        neighbour_place(f, key, dim + 3u * (uint32_t)i, &dx, &dy);
        clear(n);
        for (int l = 0; l < BLOCK; l++) {
            int x = x0 + (l & 3) + dx, y = y0 + (l >> 2) + dy;
            if (!(surfaces >> l & 1) || x < 0 || y < 0 || x >= b->width || y >= b->height)
                continue;
            size_t from = block_at(b, x / BLOCK_SIDE, y / BLOCK_SIDE);
            const gblock *h = &b->g[f->gbuffer][from];
            int j = (y & 3) * 4 + (x & 3);
            if (alike(p, g, l, h, j))
                fetch(h, &b->r[run->stage->source][from], j, l, n);
        }
        k += n->lanes != 0;
    }
    if (k) {
        combine(run, w, g, own, &visible, w->neighbours, k, f->camera.eye, x0, y0, dim, out);
        if (run->stage->resolve_visibility)
            resolve(run, w, g, out, &visible);
    } else {
        *out = *own;
    }
    b->visible[run->stage->target][at] = (uint16_t)visible;
}
