/* Observations by the shared rays of a frame. Each thread keeps those of its tiles; the visibility cache learns from
 * them when the frame is complete (light/learned.h). */
#include "backend/cpu/cpu.h"

#include "core/list_bright.h"

#include <stdlib.h>

FN f1 block_bright(CTX u1 block) { return ctx->at.bright[block]; }

/* The sum of n numbers, a power of two, in halves. Overwrites them. */
float noc_cpu_sum_in_halves(float *x, int n) {
    for (int half = n / 2; half; half /= 2)
        for (int i = 0; i < half; i++)
            x[i] += x[i + half];
    return x[0];
}

/* What the rays found goes into the tile's cells, and is handed on to be learned. */
void noc_cpu_note_observations(stage_run *run, worker *w, tile at) {
    tile_rays *t = &w->lists->rays;
    const light_list *list = &w->lists->build.list;
    size_t item = (size_t)(at.y0 / TILE_BLOCKS) * (size_t)run->s->b.tiles_x + (size_t)(at.x0 / TILE_BLOCKS);
    for (int i = 0; i < t->count; i++) {
        tile_cell *c = &t->cell[t->cell_of[t->draws[i].block]];
        for (uint32_t bits = t->segments[i].valid; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            c->asked[t->draws[i].entry[l]]++;
            c->seen[t->draws[i].entry[l]] += t->segments[i].unoccluded >> l & 1;
        }
    }
    list_pass *p = w->lists;
    learned_tile *out = &run->s->learned_tiles[item];
    *out = (learned_tile){ (int)(w - run->s->workers), p->observed.len, 0 };
    /* they grow with the picture */
    if (!array_reserve(&p->observed, p->observed.len + (size_t)t->cells) ||
        !array_reserve(&p->observations, p->observations.len + (size_t)t->cells * list->count)) {
        w->no_memory = true;
        return;
    }
    for (int k = 0; k < t->cells; k++) {
        size_t first = p->observations.len;
        for (uint32_t i = 0; i < list->count; i++)
            if (t->cell[k].asked[i])
                p->observations.data[p->observations.len++] =
                    (noc_observation){ list->light[i], t->cell[k].asked[i], t->cell[k].seen[i] };
        if (p->observations.len > first)
            p->observed.data[p->observed.len++] =
                (noc_cell_observations){ .cell = t->cell[k].key, .count = (uint32_t)(p->observations.len - first) };
    }
    out->count = p->observed.len - out->first;
}

noc_status noc_cpu_begin_learning(cpu_view *s, const noc_frame *frame) {
    size_t tiles = (size_t)s->b.tiles_x * s->b.tiles_y;
    if (!frame->plan->learns)
        return NOC_OK;
    if (!s->learned && !(s->learned = noc_learned_create(tiles, s->log)))
        return NOC_ERR_MEMORY;
    if (noc_learned_fit(s->learned, tiles, s->log) != NOC_OK)
        return NOC_ERR_MEMORY;
    if (!s->observations) {
        s->learned_tiles = noc_alloc_large(tiles, sizeof(*s->learned_tiles));
        s->observations = s->learned_tiles ? noc_alloc_large(tiles, sizeof(*s->observations)) : NULL;
        s->block_bright = s->observations ? noc_alloc_large((size_t)s->b.blocks_x * (size_t)s->b.blocks_y, 4) : NULL;
        if (!s->block_bright) {
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
        s->workers[i].lists->observed.len = s->workers[i].lists->observations.len = 0;
    return NOC_OK;
}

/* Where the observations of each cell are, now that their array grows no more. */
static void find_observations(list_pass *p) {
    const noc_observation *at = p->observations.data;
    for (size_t i = 0; i < p->observed.len; at += p->observed.data[i++].count)
        p->observed.data[i].data = at;
}

/* cd/m2. */
static float mean_bright(const cpu_view *s) {
    const struct core_context ctx = { .at.bright = s->block_bright };
    float sum[BRIGHT_COLUMNS];
    for (u1 k = 0; k < BRIGHT_COLUMNS; k++)
        sum[k] = column_bright(&ctx, k, (u1)s->b.blocks_x * (u1)s->b.blocks_y);
    return noc_cpu_sum_in_halves(sum, BRIGHT_COLUMNS) / ((float)s->b.width * (float)s->b.height);
}

void noc_cpu_end_learning(cpu_view *s, const noc_frame *frame) {
    size_t tiles = (size_t)s->b.tiles_x * s->b.tiles_y;
    if (!frame->plan->learns)
        return;
    for (int i = 0; i < s->worker_count; i++)
        find_observations(s->workers[i].lists);
    for (size_t i = 0; i < tiles; i++) {
        const learned_tile *t = &s->learned_tiles[i];
        s->observations[i] = (noc_observations){ s->workers[t->worker].lists->observed.data + t->first, t->count };
    }
    noc_learned_add(s->learned, s->pool, s->observations, tiles);
    s->list_brightness = mean_bright(s);
}

void noc_cpu_release_tiles(cpu_view *s) {
    free(s->learned_tiles);
    free(s->observations);
    free(s->block_bright);
    for (int i = 0; i < s->worker_count; i++)
        if (s->workers[i].lists) {
            array_free(&s->workers[i].lists->observed);
            array_free(&s->workers[i].lists->observations);
        }
    s->observations = NULL;
    s->block_bright = NULL;
    s->learned_tiles = NULL;
}

void noc_cpu_release_learning(cpu_view *s) {
    noc_cpu_release_tiles(s);
    noc_learned_destroy(s->learned);
    s->learned = NULL;
}
