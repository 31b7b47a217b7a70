/* Candidates from influence volumes, for the pixels of a tile 16 at a time: those that ask as one take turns with sets
 * of samples that they share (core/influence_draw.h), and what is left of the groups has a set for each 16 pixels. */
#include "backend/cpu/cpu.h"
#include "backend/cpu/lanes_tmpl.h"
#include "core/influence_cut.h"
#include "core/measured.h"
#include "core/presample_limits.h"

_Static_assert((int)CUT_SIXTEENS == TILE_BLOCKS * TILE_BLOCKS && CUT_SIXTEENS <= INFLUENCE_SETS,
               "sets of a tile have numbers of their own");

/* ---- core's bridges: pixels in sixteens ---- */

typedef struct influence_cut {
    const uint32_t *lanes; /* of each block, that see a surface */
    influence_sixteen sixteen[CUT_SIXTEENS];
    uint16_t place[2 + NOC_QUERY_BLOCKS * NOC_QUERY_POINTS];
    uint8_t pixel[NOC_QUERY_BLOCKS * NOC_QUERY_POINTS];
} influence_cut;

FN u1 cut_lanes(CTX u1 block) { return ctx->at.cut->lanes[block]; }
FN u1 cut_group(CTX u1 block, u1 lane) { return ctx->at.volumes->of[block][lane]; }
FN void cut_place_store(CTX u1 group, u1 place) { ctx->at.cut->place[group] = (uint16_t)place; }
FN u1 cut_place(CTX u1 group) { return ctx->at.cut->place[group]; }
FN void cut_pixel_store(CTX u1 place, u1 pixel) { ctx->at.cut->pixel[place] = (uint8_t)pixel; }
FN u1 cut_pixel(CTX u1 place) { return ctx->at.cut->pixel[place]; }
FN void sixteen_store(CTX u1 i, influence_sixteen s) { ctx->at.cut->sixteen[i] = s; }
FN influence_sixteen sixteen_load(CTX u1 i) { return ctx->at.cut->sixteen[i]; }

/* One lane of an array of 16 a value to a lane of another. */
static void copy_lane(void *to, int to_lane, const void *from, int from_lane, size_t bytes) {
    for (size_t i = 0; i < bytes; i += 4 * BLOCK)
        memcpy((char *)to + i + 4 * to_lane, (const char *)from + i + 4 * from_lane, 4);
}

/* The work on one tile. */
typedef struct drawing {
    const stage_run *run;
    worker *w;
    const tile_points *p;
    int m;
    uint32_t number; /* of the tile's first set */
    const influence_cut *cut;
} drawing;

/* Makes the set of this sixteen, which is the first of those that have it. */
static void make_set(const drawing *d, const influence_sixteen *s) {
    const noc_found *found = &d->w->picks->found;
    const uint8_t *pixel = d->cut->pixel + s->first;
    uint32_t number = d->number + s->set;
    uint16_t of[BLOCK] = { 0 };
    for (uint32_t l = 0; l < BLOCK; l++)
        if (s->group != CUT_MIXED)
            of[l] = (uint16_t)s->group;
        else if (l < s->count)
            of[l] = found->of[pixel[l] / BLOCK][pixel[l] % BLOCK];
    const stage_run *run = d->run;
    const frame_constants *f = run->ctx.frame;
    size_t first = (size_t)noc_cpu_shared_draws(run) * presample_subset(f->seed, number, f->index, run->s->subsets);
    run->k->influence_draw(&run->ctx, found, of, number, d->m, run->s->samples + first, run->s->sample_volumes + first,
                           d->w->picks->set);
}

/* How often the light that a lane chose is expected among its candidates. */
static void note_density(const drawing *d, size_t block, int to, int from, const rblock *r) {
    float(*density)[BLOCK] = d->run->s->b.views.made[NOC_AOV_DENSITY];
    const presample_row *set = d->w->picks->set;
    for (int i = 0; density && r->w[from] > 0 && i < d->m; i++)
        if (set[i].light[from] == r->light[from])
            density[block][to] = expected_draws((u1)d->m, set[i].inverse[from]);
}

static void choose(const drawing *d, const influence_sixteen *s) {
    const stage_run *run = d->run;
    const tile_points *p = d->p;
    rblock *target = run->s->b.r[run->stage->target], chosen;
    uint32_t pixel[BLOCK], of_block[BLOCK];
    float(*weighed)[BLOCK] = d->w->shares->weighed;
    if (s->block != CUT_SEVERAL) {
        const tile_block *b = &p->block[s->block];
        noc_cpu_pixels(run, b, pixel);
        run->k->presampled(&run->ctx, p->g[s->block], p->lanes[s->block], pixel, d->m, d->w->picks->set, weighed,
                           &target[b->at]);
        for (int l = 0; l < BLOCK; l++)
            note_density(d, b->at, l, l, &target[b->at]);
        return;
    }
    const uint8_t *from_pixel = d->cut->pixel + s->first;
    int count = (int)s->count;
    gblock g;
    for (int k = 0; k < BLOCK; k++) {
        int from = from_pixel[NOC_MIN(k, count - 1)], l = from % BLOCK;
        copy_lane(&g, k, p->g[from / BLOCK], l, sizeof(g));
        noc_cpu_pixels(run, &p->block[from / BLOCK], of_block);
        pixel[k] = of_block[l];
    }
    run->k->presampled(&run->ctx, &g, (1u << count) - 1, pixel, d->m, d->w->picks->set, weighed, &chosen);
    for (int k = 0; k < count; k++) {
        size_t at = p->block[from_pixel[k] / BLOCK].at;
        copy_lane(&target[at], from_pixel[k] % BLOCK, &chosen, k, sizeof(chosen));
        note_density(d, at, from_pixel[k] % BLOCK, k, &chosen);
    }
}

/* Cuts the tile; returns how many sixteens there are. */
static uint32_t cut(const drawing *d, influence_cut *out) {
    noc_found *found = &d->w->picks->found;
    struct core_context ctx = d->run->ctx;
    if (!ctx.light_count || found->no_memory)
        return 0;
    ctx.at.volumes = found;
    ctx.at.cut = out;
    out->lanes = d->p->lanes;
    uint32_t n = cut_tile(&ctx, (u1)d->p->count, (u1)found->groups);
    cut_sets(&ctx, n);
    return n;
}

/* Pixels that see no surface have no sample. */
static void clear_reservoirs(const drawing *d) {
    rblock none;
    for (int l = 0; l < BLOCK; l++)
        reservoir_store(&none, l, reservoir_empty());
    for (int i = 0; i < d->p->count; i++)
        d->run->s->b.r[d->run->stage->target][d->p->block[i].at] = none;
}

void noc_cpu_draw_influence(const stage_run *run, worker *w, const tile_points *p, uint32_t number) {
    influence_cut pixels;
    const drawing d = { run, w, p, run->frame->plan->candidate_count, number * INFLUENCE_SETS, &pixels };
    clear_reservoirs(&d);
    uint32_t n = cut(&d, &pixels);
    for (uint32_t i = 0, sets = 0; i < n; i++) {
        const influence_sixteen *s = &pixels.sixteen[i];
        if (s->set < sets)
            continue;
        make_set(&d, s);
        sets++;
        for (uint32_t k = i; k < n && pixels.sixteen[k].group == s->group; k++)
            if (pixels.sixteen[k].set == s->set)
                choose(&d, &pixels.sixteen[k]);
    }
}
