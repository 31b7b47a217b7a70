#include "light/learned.h"

#include "core/learned_cells.h"

enum { PARTS = 64, LEAST_CELLS = 1024, MOST_CELLS = 1 << 18 };
_Static_assert(LEAST_CELLS >= PARTS * CELL_RUN, "every part has runs");

struct core_context {
    noc_cell *cells;
};

FN u1 cell_load(CTX u1 cell, u1 word) { return ctx->cells[cell].word[word]; }
FN void cell_store(CTX u1 cell, u1 word, u1 x) { ctx->cells[cell].word[word] = x; }

noc_learned *noc_learned_create(size_t tiles, noc_log *log) {
    noc_learned *t = noc_calloc(1, sizeof(*t));
    if (!t) {
        noc_error(log, NOC_ERR_MEMORY, "lights: no memory to learn their visibility");
        return NULL;
    }
    if (noc_learned_fit(t, tiles, log) == NOC_OK)
        return t;
    free(t);
    return NULL;
}

void noc_learned_destroy(noc_learned *t) {
    if (!t)
        return;
    free(t->cells);
    free(t);
}

void noc_learned_forget(noc_learned *t) {
    memset(t->cells, 0, t->count * sizeof(*t->cells));
    t->time = 0;
}

/* A run's cells go to two runs or more of a table that is larger, and meet no others there: all find room. */
static void move_in(const noc_cell *cell, noc_cell *cells, size_t count) {
    noc_cell *to = cells + cell_run((cell_key){ cell->word[CELL_PLACE], cell->word[CELL_CHECK] }, (uint32_t)count);
    while (to->word[CELL_CHECK])
        to++;
    *to = *cell;
}

size_t noc_learned_cells(size_t tiles) {
    size_t count = LEAST_CELLS;
    while (count < 4 * tiles && count < MOST_CELLS)
        count *= 2;
    return count;
}

noc_status noc_learned_fit(noc_learned *t, size_t tiles, noc_log *log) {
    size_t count = noc_learned_cells(tiles);
    if (count <= t->count)
        return NOC_OK;
    noc_cell *cells = noc_alloc_large(count, sizeof(*cells));
    if (!cells)
        return noc_error(log, NOC_ERR_MEMORY, "lights: no memory to learn their visibility (%zu MB)",
                         count * sizeof(*cells) >> 20);
    for (size_t i = 0; i < t->count; i++)
        if (t->cells[i].word[CELL_CHECK])
            move_in(&t->cells[i], cells, count);
    free(t->cells);
    t->cells = cells;
    t->count = count;
    return NOC_OK;
}

const noc_cell *noc_learned_find(const noc_learned *t, cell_key key) {
    struct core_context ctx = { t->cells };
    uint32_t cell = cell_find(&ctx, key, (uint32_t)t->count);
    return cell == NO_CELL ? NULL : t->cells + cell;
}

float noc_cell_visibility(const noc_cell *c, uint32_t light) {
    struct core_context ctx = { (noc_cell *)c }; /* is read */
    return cell_visibility(&ctx, c ? 0 : NO_CELL, light);
}

struct add_run {
    noc_learned *t;
    noc_cell_observations *part[PARTS]; /* of so many parts of the table, each in the order of tiles */
};

static void add_part(void *arg, size_t part, int worker) {
    const struct add_run *run = arg;
    noc_learned *t = run->t;
    struct core_context ctx = { t->cells };
    (void)worker;
    for (const noc_cell_observations *o = run->part[part]; o; o = o->next) {
        uint32_t cell = cell_claim(&ctx, o->cell, (uint32_t)t->count, t->time);
        for (uint32_t i = 0; i < o->count; i++)
            cell_count(&ctx, cell, o->data[i].light, o->data[i].asked, o->data[i].seen);
    }
}

void noc_learned_add(noc_learned *t, noc_pool *pool, const noc_observations *tiles, size_t count) {
    struct add_run run = { .t = t };
    t->time++;
    for (size_t tile = count; tile-- > 0;) /* the last first: each goes before those that are there */
        for (size_t i = tiles[tile].count; i-- > 0;) {
            noc_cell_observations *o = &tiles[tile].cells[i];
            noc_cell_observations **first = &run.part[cell_run(o->cell, (uint32_t)t->count) / CELL_RUN % PARTS];
            o->next = *first;
            *first = o;
        }
    noc_pool_run(pool, PARTS, add_part, &run);
}
