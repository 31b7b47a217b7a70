#include "light/learned.h"

#include "core/learned.h"

#include <math.h>

enum { PROBES = 8, PARTS = 8, MOST_CELLS = 1 << 18, MOST_ASKED = 1024, MOST_ALL = 1 << 20 };

static uint64_t mix(uint64_t x) {
    x ^= x >> 32;
    x *= 0x9fb21c651e98df25u;
    x ^= x >> 28;
    x *= 0xd6e8feb86659fd93u;
    return x ^ x >> 32;
}

uint64_t noc_cell_key(const float p[3], const float n[3], int level) {
    double size = ldexp(1, level);
    float x = fabsf(n[0]), y = fabsf(n[1]), z = fabsf(n[2]);
    int axis = z >= x && z >= y ? 2 : y > x ? 1 : 0;
    uint64_t key = ((uint64_t)level & 127) << 3 | (uint64_t)(2 * axis + (n[axis] < 0));
    for (int k = 0; k < 3; k++) /* moved, for walls and floors like to lie at round numbers */
        key = key << 18 | ((uint64_t)(int64_t)floor(p[k] / size + 0.37) & 0x3ffff);
    return mix(key) | 1;
}

noc_learned *noc_learned_create(size_t tiles, noc_log *log) {
    noc_learned *t = noc_calloc(1, sizeof(*t));
    size_t count = 1024;
    while (count < 4 * tiles && count < MOST_CELLS)
        count *= 2;
    if (t && (t->cells = noc_alloc_large(count, sizeof(*t->cells)))) {
        t->count = count;
        t->bytes = count * sizeof(*t->cells);
        return t;
    }
    noc_error(log, NOC_ERR_MEMORY, "lights: no memory to learn their visibility (%zu MB)",
              count * sizeof(*t->cells) >> 20);
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
    memset(t->cells, 0, t->bytes);
    t->time = 0;
}

/* A key's cell is one of a run of PROBES. */
static noc_cell *run_of(const noc_learned *t, uint64_t key) {
    return t->cells + (key >> 16 & (t->count - 1) & ~(size_t)(PROBES - 1));
}

const noc_cell *noc_learned_find(const noc_learned *t, uint64_t key) {
    const noc_cell *run = run_of(t, key);
    for (int i = 0; i < PROBES; i++)
        if (run[i].key == key)
            return run + i;
    return NULL;
}

static noc_cell *claim(const noc_learned *t, uint64_t key) {
    noc_cell *run = run_of(t, key), *oldest = run;
    for (int i = 0; i < PROBES; i++) {
        if (run[i].key == key)
            return run + i;
        if (run[i].used < oldest->used)
            oldest = run + i;
    }
    memset(oldest, 0, sizeof(*oldest));
    oldest->key = key;
    return oldest;
}

static int set_of(uint32_t light) { return (int)(light * 0x9e3779b9u >> 28) * NOC_CELL_WAYS; }

static int slot_of(const noc_cell *c, uint32_t light) {
    for (int i = set_of(light), end = i + NOC_CELL_WAYS; i < end; i++)
        if (c->light[i] == light && c->asked[i])
            return i;
    return -1;
}

float noc_cell_visibility(const noc_cell *c, uint32_t light) {
    if (!c)
        return LEARNED_UNKNOWN;
    float all = learned_visibility((float)c->asked_all, (float)c->seen_all, LEARNED_UNKNOWN);
    int i = slot_of(c, light);
    return i < 0 ? all : learned_visibility(c->asked[i], c->seen[i], all);
}

static void count_observation(noc_cell *c, const noc_observation *s) {
    if (c->asked_all > MOST_ALL) {
        c->asked_all /= 2;
        c->seen_all /= 2;
    }
    c->asked_all += s->asked;
    c->seen_all += s->seen;
    int at = slot_of(c, s->light);
    if (at < 0) { /* in the place of the light that least is known of */
        at = set_of(s->light);
        for (int i = at + 1, end = at + NOC_CELL_WAYS; i < end; i++)
            if (c->asked[i] < c->asked[at])
                at = i;
        c->light[at] = s->light;
        c->asked[at] = c->seen[at] = 0;
    }
    if (c->asked[at] > MOST_ASKED) { /* what is old counts less and less */
        c->asked[at] /= 2;
        c->seen[at] /= 2;
    }
    c->asked[at] = (uint16_t)(c->asked[at] + s->asked);
    c->seen[at] = (uint16_t)(c->seen[at] + s->seen);
}

struct add_run {
    noc_learned *t;
    const noc_observations *tiles;
    size_t count;
};

/* All observations of one part of the table. */
static void add_part(void *arg, size_t part, int worker) {
    const struct add_run *run = arg;
    noc_learned *t = run->t;
    (void)worker;
    for (size_t tile = 0; tile < run->count; tile++)
        for (size_t i = 0; i < run->tiles[tile].count; i++) {
            const noc_observation *s = run->tiles[tile].data + i;
            if ((size_t)(run_of(t, s->cell) - t->cells) / (t->count / PARTS) != part)
                continue;
            noc_cell *c = claim(t, s->cell);
            c->used = t->time;
            count_observation(c, s);
        }
}

void noc_learned_add(noc_learned *t, noc_pool *pool, const noc_observations *tiles, size_t count) {
    struct add_run run = { t, tiles, count };
    t->time++;
    noc_pool_run(pool, PARTS, add_part, &run);
}
