/* Two files that describe the same lamps, half a metre to a few metres apart (rounded coordinates, a map beside an
 * inventory), light the city twice. No rule can tell that of one lamp; of a whole file it can be told, and a person is
 * asked. */
#include "import/load/load.h"

#include <math.h>

#define NEAR                                                                                                           \
    3.0 /* m: how far surveys of one lamp lie apart. Lamps along a street stand ten times as far from each other */
#define ONE_POLE 1.0    /* m: lamps of one file that are nearer are heads of one pole */
#define CELL (2 * NEAR) /* m: cells around a lamp's own hold all that is as near as the rule asks for */
#define FEWEST 3        /* lamps that are evidence */
#define MOST 64         /* lamps of a cell that are looked at */

/* The input of the lamp of another file that is this one, it seems: it is near, and less than half as far as the next
 * lamp of the own file. SIZE_MAX: there is none. */
static size_t twin(const pending_lamp *lamps, const geo_cells *cells, const pending_lamp *p) {
    double own = INFINITY, other = INFINITY;
    size_t found = SIZE_MAX;
    for (int c = 0; c < 9; c++) {
        size_t seen = 0;
        for (uint32_t k = *geo_cells_at(cells, p->lamp.xyz, c); k && seen++ < MOST; k = cells->next[k - 1]) {
            const pending_lamp *q = &lamps[k - 1];
            double d = hypot(q->lamp.xyz[0] - p->lamp.xyz[0], q->lamp.xyz[1] - p->lamp.xyz[1]);
            if (q->input == p->input) {
                own = d > ONE_POLE ? NOC_MIN(own, d) : own;
            } else if (d < other) {
                other = d;
                found = q->input;
            }
        }
    }
    return other <= NEAR && 2 * other < own ? found : SIZE_MAX;
}

/* Lamps [from, to) are those of one input. counts: zeros, one for each input, as they are left. told: the other input +
 * 1 that a warning of an input was about. */
static void judge_file(const importer *im, const geo_cells *cells, size_t from, size_t to, size_t *counts,
                       size_t *told) {
    const pending_lamp *lamps = im->lamps.data;
    size_t self = lamps[from].input, best = 0;
    for (size_t i = from; i < to; i++) {
        size_t of = twin(lamps, cells, &lamps[i]);
        if (of != SIZE_MAX)
            counts[of]++;
    }
    for (size_t i = 1; i < im->input_count; i++)
        best = counts[i] > counts[best] ? i : best;
    if (counts[best] >= FEWEST && 2 * counts[best] >= to - from && told[best] != self + 1) {
        told[self] = best + 1;
        noc_warn(
            im->log,
            "%zu of %zu lamps of %s stand within %g m of a lamp of %s: the same lamps? If so they shine twice: leave "
            "one of the files out",
            counts[best], to - from, im->inputs[self].path, NEAR, im->inputs[best].path);
    }
    memset(counts, 0, im->input_count * sizeof(*counts));
}

noc_status warn_of_doubles(const importer *im) {
    const pending_lamp *lamps = im->lamps.data;
    size_t count = im->lamps.len;
    if (!count || lamps[0].input == lamps[count - 1].input) /* they lie file by file */
        return NOC_OK;
    geo_cells cells;
    size_t *counts = noc_calloc(2 * im->input_count, sizeof(*counts));
    bool kept = geo_cells_create(&cells, count, CELL) && counts;
    for (size_t i = 0; i < count && kept; i++)
        geo_cells_add(&cells, lamps[i].lamp.xyz, i);
    for (size_t from = 0, to; from < count && kept; from = to) {
        for (to = from; to < count && lamps[to].input == lamps[from].input;)
            to++;
        judge_file(im, &cells, from, to, counts, counts + im->input_count);
    }
    geo_cells_free(&cells);
    free(counts);
    return kept ? NOC_OK : noc_no_memory(im->log, "import");
}
