/* Emitters that are seen, apart from the mean: see emitter_coverage.h. */
#include "render/emitter_coverage.h"

#include <string.h>

void noc_coverage_free(noc_coverage *c) {
    free(c->place);
    free(c->seen);
    array_free(&c->sums);
    *c = (noc_coverage){ 0 };
}

bool noc_coverage_reserve(noc_coverage *c, const uint16_t *emitter, size_t blocks, uint64_t accumulated) {
    size_t places = 0;
    if ((!c->place && !(c->place = noc_alloc_large(blocks, sizeof(*c->place)))) ||
        (!c->seen && !(c->seen = noc_alloc_large(blocks, sizeof(*c->seen)))))
        return false;
    for (size_t i = 0; i < blocks; i++)
        places += emitter[i] || (accumulated && c->place[i]);
    return array_reserve(&c->sums, places);
}

/* Gives places to the blocks that see their first emitter. */
static void give_places(noc_coverage *c, const uint16_t *emitter, size_t blocks) {
    for (size_t i = 0; i < blocks; i++)
        if (emitter[i] && !c->place[i]) {
            c->sums.data[c->sums.len++] = (noc_coverage_sum){ 0 };
            c->place[i] = (uint32_t)c->sums.len;
        }
}

void noc_coverage_keep(noc_coverage *c, const uint16_t *emitter, const gblock *g, const cblock *colour, size_t blocks,
                       uint64_t accumulated) {
    if (!accumulated) {
        memset(c->place, 0, blocks * sizeof(*c->place));
        memset(c->seen, 0, blocks * sizeof(*c->seen));
        c->sums.len = 0;
    }
    give_places(c, emitter, blocks);
    c->frames = accumulated + 1;
    for (size_t i = 0; i < blocks; i++) {
        if (!c->place[i])
            continue;
        noc_coverage_sum *sum = &c->sums.data[c->place[i] - 1];
        for (int l = 0; l < BLOCK; l++) {
            if (g[i].light[l] == NO_LIGHT)
                continue;
            sum->frames[l]++;
            c->seen[i] |= (uint16_t)(1u << l);
            for (int k = 0; k < 3; k++)
                sum->rgb[k][l] += colour[i].rgb[k][l];
        }
    }
}

bool noc_coverage_saw(const noc_coverage *c, size_t block, int lane) { return c->seen && c->seen[block] >> lane & 1; }

void noc_coverage_read(const noc_coverage *c, size_t block, int lane, float out[4]) {
    memset(out, 0, 4 * sizeof(*out));
    if (!c->place || !c->place[block])
        return;
    const noc_coverage_sum *sum = &c->sums.data[c->place[block] - 1];
    for (int k = 0; k < 3; k++)
        out[k] = sum->rgb[k][lane] / (float)c->frames;
    out[3] = (float)sum->frames[lane] / (float)c->frames;
}
