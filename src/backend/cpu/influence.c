/* Candidates from influence volumes, for the pixels of a tile 16 at a time: those that ask as one take turns with sets
 * of samples that they share (core/influence_draw.h), and what is left of the groups has a set for each 16 pixels. */
#include "backend/cpu/cpu.h"
#include "core/influence_limits.h"
#include "core/presample_limits.h"

enum { TILE_PIXELS = TILE_BLOCKS * TILE_BLOCKS * BLOCK, MOST_SIXTEENS = 2 * TILE_BLOCKS * TILE_BLOCKS };
_Static_assert(MOST_SIXTEENS <= (int)INFLUENCE_SETS, "sets of a tile have numbers of their own");

/* Up to 16 pixels: a block, or some of several blocks. */
typedef struct sixteen {
    uint16_t group; /* of all of them, or MIXED */
    uint8_t block;  /* or SEVERAL, and then: */
    uint8_t count;
    uint8_t pixel[BLOCK]; /* block * 16 + lane */
} sixteen;
enum { MIXED = 0xffff, SEVERAL = 0xff };

/* The group of all of these lanes, or MIXED. */
static uint16_t group_of(const uint16_t of[BLOCK], uint32_t lanes) {
    uint16_t group = of[__builtin_ctz(lanes)];
    for (; lanes; lanes &= lanes - 1)
        if (of[__builtin_ctz(lanes)] != group)
            return MIXED;
    return group;
}

/* Pixels of blocks whose pixels do not ask as one, by group; returns how many. */
static uint32_t sort_pixels(const noc_found *f, const tile_points *p, uint32_t mixed, uint8_t sorted[TILE_PIXELS]) {
    uint16_t at[NOC_COUNT(f->group) + 1] = { 0 };
    for (uint32_t blocks = mixed; blocks; blocks &= blocks - 1) {
        int i = __builtin_ctz(blocks);
        for (uint32_t bits = p->lanes[i]; bits; bits &= bits - 1)
            at[f->of[i][__builtin_ctz(bits)] + 1]++;
    }
    for (int k = 0; k < f->groups; k++)
        at[k + 1] = (uint16_t)(at[k + 1] + at[k]);
    for (uint32_t blocks = mixed; blocks; blocks &= blocks - 1) {
        int i = __builtin_ctz(blocks);
        for (uint32_t bits = p->lanes[i]; bits; bits &= bits - 1)
            sorted[at[f->of[i][__builtin_ctz(bits)]]++] = (uint8_t)(i * BLOCK + __builtin_ctz(bits));
    }
    return at[f->groups ? f->groups - 1 : 0];
}

/* All pixels of a tile that see a surface, those of a group one after the other; returns how many sixteens. */
static int cut_tile(const noc_found *f, const tile_points *p, sixteen out[MOST_SIXTEENS]) {
    uint8_t sorted[TILE_PIXELS];
    uint32_t mixed = 0;
    int n = 0;
    for (int i = 0; i < p->count; i++) {
        uint16_t group = p->lanes[i] ? group_of(f->of[i], p->lanes[i]) : 0;
        if (group == MIXED)
            mixed |= 1u << i;
        else if (group)
            out[n++] = (sixteen){ .group = group, .block = (uint8_t)i };
    }
    uint32_t left = sort_pixels(f, p, mixed, sorted);
    for (uint32_t first = 0; first < left; first += BLOCK) {
        sixteen *s = &out[n++];
        *s = (sixteen){ .block = SEVERAL, .count = (uint8_t)NOC_MIN(left - first, (uint32_t)BLOCK) };
        memcpy(s->pixel, sorted + first, s->count);
        uint8_t a = s->pixel[0], b = s->pixel[s->count - 1];
        bool one = f->of[a / BLOCK][a % BLOCK] == f->of[b / BLOCK][b % BLOCK];
        s->group = one ? f->of[a / BLOCK][a % BLOCK] : MIXED;
    }
    for (int i = 1; i < n; i++) { /* few, and mostly in order */
        sixteen s = out[i];
        int k = i;
        for (; k > 0 && out[k - 1].group > s.group; k--)
            out[k] = out[k - 1];
        out[k] = s;
    }
    return n;
}

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
    uint32_t number; /* of the tile's next set */
} drawing;

static void make_set(drawing *d, const sixteen *s) {
    const noc_found *found = &d->w->picks->found;
    uint16_t of[BLOCK] = { 0 };
    for (int l = 0; l < BLOCK; l++)
        if (s->group != MIXED)
            of[l] = s->group;
        else if (l < s->count)
            of[l] = found->of[s->pixel[l] / BLOCK][s->pixel[l] % BLOCK];
    const stage_run *run = d->run;
    const frame_constants *f = run->ctx.frame;
    size_t first = (size_t)noc_cpu_shared_draws(run) * presample_subset(f->seed, d->number, f->index, run->s->subsets);
    run->k->influence_draw(&run->ctx, found, of, d->number++, d->m, run->s->samples + first,
                           run->s->sample_volumes + first, d->w->picks->set);
}

/* How often the light that a lane chose is expected among its candidates. */
static void note_density(const drawing *d, size_t block, int to, int from, const rblock *r) {
    float(*density)[BLOCK] = d->run->s->b.views.made[NOC_AOV_DENSITY];
    const presample_row *set = d->w->picks->set;
    for (int i = 0; density && r->w[from] > 0 && i < d->m; i++)
        if (set[i].light[from] == r->light[from])
            density[block][to] = (float)d->m / set[i].inverse[from];
}

static void choose(const drawing *d, const sixteen *s) {
    const stage_run *run = d->run;
    const tile_points *p = d->p;
    rblock *target = run->s->b.r[run->stage->target], chosen;
    uint32_t pixel[BLOCK], of_block[BLOCK];
    float(*weighed)[BLOCK] = d->w->shares->weighed;
    if (s->block != SEVERAL) {
        const tile_block *b = &p->block[s->block];
        noc_cpu_pixels(run, b, pixel);
        run->k->presampled(&run->ctx, p->g[s->block], p->lanes[s->block], pixel, d->m, d->w->picks->set, weighed,
                           &target[b->at]);
        for (int l = 0; l < BLOCK; l++)
            note_density(d, b->at, l, l, &target[b->at]);
        return;
    }
    gblock g;
    for (int k = 0; k < BLOCK; k++) {
        int from = s->pixel[NOC_MIN(k, s->count - 1)], l = from % BLOCK;
        copy_lane(&g, k, p->g[from / BLOCK], l, sizeof(g));
        noc_cpu_pixels(run, &p->block[from / BLOCK], of_block);
        pixel[k] = of_block[l];
    }
    run->k->presampled(&run->ctx, &g, (1u << s->count) - 1, pixel, d->m, d->w->picks->set, weighed, &chosen);
    for (int k = 0; k < s->count; k++) {
        size_t at = p->block[s->pixel[k] / BLOCK].at;
        copy_lane(&target[at], s->pixel[k] % BLOCK, &chosen, k, sizeof(chosen));
        note_density(d, at, s->pixel[k] % BLOCK, k, &chosen);
    }
}

void noc_cpu_draw_influence(const stage_run *run, worker *w, const tile_points *p, uint32_t number) {
    sixteen all[MOST_SIXTEENS];
    drawing d = { run, w, p, run->frame->plan->candidate_count, number * INFLUENCE_SETS };
    for (int i = 0; i < p->count; i++) /* pixels that see no surface */
        memset(&run->s->b.r[run->stage->target][p->block[i].at], 0, sizeof(rblock));
    int n = run->ctx.light_count && !w->picks->found.no_memory ? cut_tile(&w->picks->found, p, all) : 0;
    for (int first = 0, end; first < n; first = end) {
        for (end = first + 1; all[first].group != MIXED && end < n && all[end].group == all[first].group;)
            end++;
        int sets = (int)influence_sets((u1)(end - first));
        for (int k = 0; k < sets; k++) {
            make_set(&d, &all[first + k]);
            for (int i = first + k; i < end; i += sets)
                choose(&d, &all[i]);
        }
    }
}
