/* Light lists with several shadow rays a pixel (core/lists.h, docs/estimator.md): every pixel weighs the entries of its
 * tile's list and shares its rays out over them systematically. ris adds up what they see; restir keeps one of those
 * that are seen as the pixel's own reservoir, and where only frames are reused mixes both. How many rays, and which
 * entries, is steered by what earlier frames have learned of the lights' visibility. */
#include "backend/cpu/cpu.h"

#include "core/random.h"

#include <math.h>
#include <stdlib.h>

enum { CELL_PIXELS = 32, MOST_ASKED_A_TILE = 16 * BLOCK * TILE_BLOCKS * TILE_BLOCKS };
_Static_assert(MOST_ASKED_A_TILE <= UINT16_MAX, "counts of a tile fit");

/* ---- what is believed ---- */

static uint64_t key_of_block(const frame_camera *c, const gblock *g, uint32_t lanes) {
    int l = lanes >> 5 & 1 ? 5 : __builtin_ctz(lanes); /* one in the middle */
    float right = sqrtf(c->right[0] * c->right[0] + c->right[1] * c->right[1] + c->right[2] * c->right[2]);
    float side = CELL_PIXELS * g->depth[l] * 2 * right / c->width;
    const float p[3] = { g->px[l], g->py[l], g->pz[l] }, n[3] = { g->nx[l], g->ny[l], g->nz[l] };
    return noc_cell_key(p, n, (int)lrintf(log2f(NOC_CLAMP(side, 1e-6f, 1e9f))));
}

/* How strongly rays are drawn to a light: the root of its expected square, and something for those thought to be
 * hidden. */
static float pull(float visibility) { return sqrtf(visibility) + 0.1f; }

/* Number of the block's cell among those of the tile. */
static int believe(const stage_run *run, const gblock *g, uint32_t lanes, const light_list *list, tile_rays *t) {
    bool learn = run->frame->plan->learns;
    uint64_t key = learn ? key_of_block(&run->ctx.frame->camera, g, lanes) : 1;
    for (int i = t->cells - 1; i >= 0; i--)
        if (t->cell[i].key == key)
            return i;
    tile_cell *c = &t->cell[t->cells];
    const noc_cell *known = learn ? noc_learned_find(run->s->learned, key) : NULL;
    c->key = key;
    for (uint32_t i = 0; i < list->count; i++) {
        float visibility = noc_cell_visibility(known, list->light[i]);
        c->beliefs.share[i] = list->weight[i] * pull(visibility);
        c->beliefs.expect[i] = list->weight[i] * visibility;
        c->asked[i] = c->seen[i] = 0;
    }
    return t->cells++;
}

/* ---- rays ---- */

/* Rays of a lane: as many as asked for where nothing is known, more where little light is expected to get through, up
 * to twice as many. A hundredth of the picture's brightness is dark enough not to look for more. */
static float ray_count(const stage_run *run, const tile_rays *t, int l, float rounding) {
    const float unknown = NOC_UNKNOWN_LIGHT / pull(NOC_UNKNOWN_LIGHT);
    float rays = (float)run->ctx.frame->shadow_rays, all = t->weighed.all[l];
    if (!(all > 0))
        return 0;
    float mean = rays * unknown * all / (t->weighed.bright[l] + 0.01f * run->s->list_brightness);
    return floorf(NOC_CLAMP(mean, 1.f, 2 * rays) + rounding);
}

/* A block's draws. An entry that was drawn several times, which come one after the other, needs one ray. */
typedef struct block_draws {
    float n[BLOCK];                         /* draws a lane */
    uint8_t entry[MOST_SHADOW_RAYS][BLOCK]; /* ray, lane */
    uint8_t times[MOST_SHADOW_RAYS][BLOCK]; /* drawn so often; 0: no such ray */
} block_draws;

static int join_equals(block_draws *d) {
    int most = 0;
    memset(d->times, 0, sizeof(d->times));
    for (int l = 0; l < BLOCK; l++) {
        int rays = 0;
        for (int k = 0; k < (int)d->n[l]; k++) {
            if (!k || d->entry[k][l] != d->entry[rays - 1][l])
                d->entry[rays++][l] = d->entry[k][l];
            d->times[rays - 1][l]++;
        }
        most = NOC_MAX(most, rays);
    }
    return most;
}

/* Ray k of each lane that has one. */
static void add_rays(stage_run *run, tile_rays *t, const struct core_context *ctx, const gblock *g, int block,
                     const block_draws *from, int k, int x, int y) {
    ray_draw *d = &t->draws[t->count];
    segment_block *s = &t->segments[t->count++];
    const light_list *list = &ctx->at.lists->list;
    float(*counts)[BLOCK] = run->s->b.aovs.made[NOC_AOV_RAYS];
    d->block = block;
    s->valid = 0;
    s->counts = counts ? counts[t->at[block]] : NULL;
    for (int l = 0; l < BLOCK; l++) {
        float times = from->times[k][l];
        int i = d->entry[l] = times > 0 ? from->entry[k][l] : 0;
        s->valid |= (uint32_t)(times > 0) << l;
        s->light[l] = d->r.light[l] = list->light[i];
        d->r.p[l] = t->weighed.weight[i][l] / t->cell[t->cell_of[block]].beliefs.share[i];
        d->r.w[l] =
            times > 0 ? times * t->weighed.all[l] / (from->n[l] * t->weighed.weight[i][l]) * list->weight[i] : 0;
    }
    run->k->list_places(ctx, x, y, d->entry, &d->r);
    run->k->segments(&run->ctx, g, d->r.light, d->r.u, d->r.v, &s->rays);
}

/* The reservoir that stands for the block in views of the candidates: one of the draws, at random. */
static void keep_one(const stage_run *run, tile_rays *t, const block_draws *from, const float pick[BLOCK], int block,
                     int first, rblock *out) {
    for (int l = 0; l < BLOCK; l++) {
        out->u[l] = out->v[l] = 0.5f;
        if (!(from->n[l] > 0))
            continue;
        int k = 0;
        for (float at = NOC_MIN(pick[l] * from->n[l], from->n[l] - 1); at >= from->times[k][l]; k++)
            at -= from->times[k][l];
        const ray_draw *d = &t->draws[t->kept[block][l] = first + k];
        out->light[l] = d->r.light[l];
        out->u[l] = d->r.u[l];
        out->v[l] = d->r.v[l];
        out->w[l] = d->r.w[l] * from->n[l] / from->times[k][l];
        out->p[l] = d->r.p[l];
    }
}

static uint32_t pixel_key(const frame_constants *f, int x, int y, int l) {
    uint32_t pixel = (uint32_t)(y + (l >> 2)) * f->width + (uint32_t)(x + (l & 3));
    return rng_key(f->seed, pixel, f->index);
}

static void draw_block(stage_run *run, tile_rays *t, const struct core_context *ctx, const gblock *g, int block, int x,
                       int y, rblock *out) {
    float start[BLOCK], pick[BLOCK];
    block_draws d;
    int first = t->count;
    for (int l = 0; l < BLOCK; l++) {
        uint32_t key = pixel_key(ctx->frame, x, y, l);
        d.n[l] = ray_count(run, t, l, rng(key, DIM_CANDIDATE + 2));
        start[l] = rng(key, DIM_CANDIDATE + 3);
        pick[l] = rng(key, DIM_CANDIDATE + 4);
    }
    run->k->list_draw((int)ctx->at.lists->list.count, &t->weighed, d.n, start, d.entry);
    for (int k = 0, rays = join_equals(&d); k < rays; k++) {
        t->draws[t->count].rays = rays;
        add_rays(run, t, ctx, g, block, &d, k, x, y);
    }
    keep_one(run, t, &d, pick, block, first, out);
}

/* A list with room to spare holds its lights several times, each time to be looked at in another point: up to a ray's
 * worth, and in all not in fewer points than the pixel's draws would be (a large light close by differs more from place
 * to place than from light to light). */
static void fill_list(const noc_render_params *p, light_list *list) {
    uint32_t once = list->count, room = (uint32_t)NOC_MIN(p->list + p->tail, LIST_ROOM);
    uint32_t wanted = once ? NOC_MAX((uint32_t)p->shadow_rays, (uint32_t)p->draws / once) : 0;
    uint32_t copies = once ? NOC_MIN(room / once, wanted) : 0;
    /* Side by side: rays that are an equal distance apart would find the same light again in each round of all of them.
     */
    for (uint32_t i = once * copies; copies > 1 && i-- > 0;) {
        list->light[i] = list->light[i / copies];
        list->weight[i] = list->weight[i / copies] / (float)copies;
    }
    list->copies = NOC_MAX(copies, 1u);
    list->count = once * list->copies;
}

void noc_cpu_share_candidates(stage_run *run, worker *w, const tile_points *points) {
    struct core_context ctx = run->ctx;
    frame_buffers *b = &run->s->b;
    tile_rays *t = &w->shared;
    ctx.at.lists = &w->lists;
    t->count = t->cells = 0;
    t->bright = 0;
    fill_list(run->frame->params, &w->lists.list);
    for (int n = 0; n < points->count; n++) {
        const gblock *g = points->g[n];
        tile_block at = points->block[n];
        uint32_t lanes = points->lanes[n];
        rblock *r = &b->r[run->stage->target][t->at[n] = at.at];
        b->visible[run->stage->target][at.at] = 0;
        memset(r, 0, sizeof(*r));
        for (int l = 0; l < BLOCK; l++) /* whatever was found: M must not depend on the samples */
            r->m[l] = lanes >> l & 1 ? (float)ctx.frame->draws : 0;
        if (!lanes || !ctx.at.lists->list.count)
            continue;
        t->cell_of[n] = believe(run, g, lanes, &w->lists.list, t);
        run->k->list_weigh(&ctx, g, lanes, at.x, at.y, &t->cell[t->cell_of[n]].beliefs, &t->weighed);
        for (int l = 0; l < BLOCK; l++)
            t->bright += t->weighed.bright[l];
        draw_block(run, t, &ctx, g, n, at.x, at.y, r);
        if (run->frame->params->aovs)
            noc_cpu_aov_candidates(run, w, n, at.at, lanes, r);
    }
}

/* What the rays found goes into the tile's cells, and is handed on to be learned. */
static void note_sightings(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->shared;
    const light_list *list = &w->lists.list;
    size_t item = (size_t)(at.y0 / TILE_BLOCKS) * (size_t)run->s->b.tiles_x + (size_t)(at.x0 / TILE_BLOCKS);
    for (int i = 0; i < t->count; i++) {
        tile_cell *c = &t->cell[t->cell_of[t->draws[i].block]];
        for (uint32_t bits = t->segments[i].valid; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            c->asked[t->draws[i].entry[l]]++;
            c->seen[t->draws[i].entry[l]] += t->segments[i].clear >> l & 1;
        }
    }
    learned_tile *out = &run->s->learned_tiles[item];
    *out = (learned_tile){ (int)(w - run->s->workers), w->sightings.len, 0, t->bright };
    /* they grow with the picture */
    if (!array_reserve(&w->sightings, w->sightings.len + (size_t)t->cells * list->count)) {
        w->no_memory = true;
        return;
    }
    for (int k = 0; k < t->cells; k++)
        for (uint32_t i = 0; i < list->count; i++)
            if (t->cell[k].asked[i])
                w->sightings.data[w->sightings.len++] =
                    (noc_sighting){ t->cell[k].key, list->light[i], t->cell[k].asked[i], t->cell[k].seen[i] };
    out->count = w->sightings.len - out->first;
}

/* One of a block's samples that are seen, by what each adds; its W stands for all of them. first: of the block's draws.
 */
static void resample(const stage_run *run, const tile_rays *t, int first, const float pick[BLOCK], rblock *out) {
    int rays = t->draws[first].rays;
    for (int l = 0; l < BLOCK; l++) {
        float all = 0, sum = 0;
        int kept = -1;
        for (int k = first; k < first + rays; k++)
            all += t->draws[k].r.p[l] * t->draws[k].r.w[l];
        for (int k = first; k < first + rays && !(kept >= 0 && sum > pick[l] * all); k++) {
            float w = t->draws[k].r.p[l] * t->draws[k].r.w[l];
            sum += w;
            kept = w > 0 ? k : kept;
        }
        out->w[l] = 0;
        if (kept < 0)
            continue;
        const rblock *r = &t->draws[kept].r;
        out->light[l] = r->light[l];
        out->u[l] = r->u[l];
        out->v[l] = r->v[l];
        out->p[l] = r->p[l];
        out->w[l] = all / r->p[l];
    }
}

/* The rays of restir's pixels become their own reservoirs, of samples known to be seen. */
void noc_cpu_resample(stage_run *run, worker *w, tile at) {
    const tile_rays *t = &w->shared;
    (void)at;
    for (int i = 0; i < t->count; i += t->draws[i].rays) {
        size_t block = t->at[t->draws[i].block];
        int x = (int)(block % (size_t)run->s->b.blocks_x) * BLOCK_SIDE,
            y = (int)(block / (size_t)run->s->b.blocks_x) * BLOCK_SIDE;
        float pick[BLOCK];
        for (int l = 0; l < BLOCK; l++)
            pick[l] = rng(pixel_key(run->ctx.frame, x, y, l), DIM_CANDIDATE + 5);
        rblock *r = &run->s->b.r[run->stage->target][block];
        resample(run, t, i, pick, r);
        run->s->b.visible[run->stage->target][block] = (uint16_t)lanes_with_sample(r);
    }
}

/* Views: a reservoir that stands for its pixel is empty where its ray was blocked. */
static void blank_hidden(const stage_run *run, const tile_rays *t) {
    rblock *r = run->s->b.r[run->stage->target];
    for (int i = 0; i < t->count; i += t->draws[i].rays)
        for (int l = 0; l < BLOCK; l++)
            if (r[t->at[t->draws[i].block]].w[l] > 0 && !(t->segments[t->kept[t->draws[i].block][l]].clear >> l & 1))
                r[t->at[t->draws[i].block]].w[l] = 0;
}

void noc_cpu_trace_shared(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->shared;
    if (run->ctx.frame->flags & FRAME_FINAL_RAY)
        noc_cpu_trace_occlusion(run->s, w, NOC_RAYS_NOW, t->segments, t->count);
    else
        for (int i = 0; i < t->count; i++)
            t->segments[i].clear = t->segments[i].valid;
    for (int i = 0; i < t->count; i++)
        for (int l = 0; l < BLOCK; l++)
            if (!(t->segments[i].clear >> l & 1))
                t->draws[i].r.w[l] = 0;
    blank_hidden(run, t);
    if (run->frame->plan->learns)
        note_sightings(run, w, at);
}

/* restir: the rays and the reservoir of a pixel are both unbiased, so any mixture of them is whose shares are fixed
 * before either is drawn. M tells how many frames stand behind the reservoir, whatever they found; its sample has the
 * luminance of all of them, but one light's colour. */
static void share_with_reservoirs(const stage_run *run, tile_rays *t, tile at) {
    const float frame = (float)run->ctx.frame->draws;
    for (int n = (at.y1 - at.y0) * (at.x1 - at.x0); n-- > 0;) {
        const rblock *r = &run->s->b.r[run->stage->target][t->at[n]];
        for (int l = 0; l < BLOCK; l++) {
            float past = NOC_MAX(r->m[l] - frame, 0.f);
            t->reused[n][l] = past / (past + 2 * frame);
        }
    }
    for (int i = 0; i < t->count; i++)
        for (int l = 0; l < BLOCK; l++)
            t->draws[i].r.w[l] *= 1 - t->reused[t->draws[i].block][l];
}

void noc_cpu_shade_shared(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->shared;
    if (run->frame->plan->mixes)
        share_with_reservoirs(run, t, at);
    const gblock *g = run->s->b.g[run->frame->gbuffer];
    for (int i = 0; i < t->count; i++) {
        size_t block = t->at[t->draws[i].block];
        if (t->segments[i].clear)
            w->dropped += (uint64_t)__builtin_popcount(
                run->k->shade(&run->ctx, &g[block], &t->draws[i].r, t->segments[i].clear, &run->s->b.colour[block]));
    }
}

/* ---- learning ---- */

noc_status noc_cpu_begin_learning(cpu_view *s, const noc_frame *frame) {
    size_t tiles = (size_t)s->b.tiles_x * s->b.tiles_y;
    if (!frame->plan->learns)
        return NOC_OK;
    if (!s->learned && !(s->learned = noc_learned_create(tiles, s->log)))
        return NOC_ERR_MEMORY;
    if (!s->sightings) {
        s->learned_tiles = noc_alloc_large(tiles, sizeof(*s->learned_tiles));
        s->sightings = s->learned_tiles ? noc_alloc_large(tiles, sizeof(*s->sightings)) : NULL;
        if (!s->sightings) {
            noc_cpu_release_tiles(s);
            return noc_error(s->log, NOC_ERR_MEMORY, "lights: no memory to learn their visibility in %zu tiles", tiles);
        }
    }
    if (s->learned_epoch != frame->epoch) {
        noc_learned_forget(s->learned);
        s->list_brightness = 0;
        s->learned_epoch = frame->epoch;
    }
    for (int i = 0; i < s->worker_count; i++)
        s->workers[i].sightings.len = 0;
    return NOC_OK;
}

void noc_cpu_end_learning(cpu_view *s, const noc_frame *frame) {
    size_t tiles = (size_t)s->b.tiles_x * s->b.tiles_y;
    double bright = 0;
    if (!frame->plan->learns)
        return;
    for (size_t i = 0; i < tiles; i++) {
        const learned_tile *t = &s->learned_tiles[i];
        s->sightings[i] = (noc_sightings){ s->workers[t->worker].sightings.data + t->first, t->count };
        bright += t->bright;
    }
    noc_learned_add(s->learned, s->pool, s->sightings, tiles);
    s->list_brightness = (float)(bright / ((double)s->b.width * s->b.height));
}

void noc_cpu_release_tiles(cpu_view *s) {
    free(s->learned_tiles);
    free(s->sightings);
    for (int i = 0; i < s->worker_count; i++)
        array_free(&s->workers[i].sightings);
    s->sightings = NULL;
    s->learned_tiles = NULL;
}

void noc_cpu_release_learning(cpu_view *s) {
    noc_cpu_release_tiles(s);
    noc_learned_destroy(s->learned);
    s->learned = NULL;
}
