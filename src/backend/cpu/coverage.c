/* What emitters that are seen directly add to a pixel's mean, apart from the rest. A display needs the two apart: the
 * mean of a lamp and of the wall beside it lies far above white wherever the lamp covers a tenth of the pixel, so edges
 * come out jagged. Few blocks see emitters, so only these have a place. */
#include "backend/cpu/cpu.h"

void noc_cpu_free_coverage(coverage *c) {
    free(c->place);
    array_free(&c->sums);
    *c = (coverage){ 0 };
}

static size_t block_count(const frame_buffers *b) { return (size_t)b->blocks_x * b->blocks_y; }

noc_status noc_cpu_make_coverage(cpu_view *s, const noc_frame *frame) {
    coverage *c = &s->b.coverage;
    size_t blocks = block_count(&s->b), places = 0;
    bool ok = c->place || (c->place = noc_alloc_large(blocks, sizeof(*c->place)));
    for (size_t i = 0; ok && i < blocks; i++)
        places += s->b.emitter[i] || (frame->accumulated && c->place[i]);
    if (ok && array_reserve(&c->sums, places))
        return NOC_OK;
    return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the emitters in a picture of %d x %d", s->b.width,
                     s->b.height);
}

/* Gives places to the blocks that see their first emitter. */
static void give_places(coverage *c, const uint16_t *emitter, size_t blocks) {
    for (size_t i = 0; i < blocks; i++)
        if (emitter[i] && !c->place[i]) {
            c->sums.data[c->sums.len++] = (coverage_sum){ 0 };
            c->place[i] = (uint32_t)c->sums.len;
        }
}

void noc_cpu_keep_coverage(cpu_view *s, const noc_frame *frame) {
    frame_buffers *b = &s->b;
    coverage *c = &b->coverage;
    const gblock *g = b->g[frame->gbuffer];
    size_t blocks = block_count(b);
    if (!frame->accumulated) {
        memset(c->place, 0, blocks * sizeof(*c->place));
        c->sums.len = 0;
    }
    give_places(c, b->emitter, blocks);
    c->frames = frame->accumulated + 1;
    for (size_t i = 0; i < blocks; i++) {
        if (!c->place[i])
            continue;
        coverage_sum *sum = &c->sums.data[c->place[i] - 1];
        for (int l = 0; l < BLOCK; l++) {
            if (g[i].light[l] == NOC_NO_LIGHT)
                continue;
            sum->frames[l]++;
            for (int k = 0; k < 3; k++)
                sum->rgb[k][l] += b->colour[i].rgb[k][l];
        }
    }
}

/* NULL: the block has seen none. */
static const coverage_sum *sum_of(const coverage *c, size_t block) {
    return c->place && c->place[block] ? &c->sums.data[c->place[block] - 1] : NULL;
}

bool noc_cpu_saw_emitter(const frame_buffers *b, size_t block, int lane) {
    const coverage_sum *sum = sum_of(&b->coverage, block);
    return sum && sum->frames[lane];
}

void noc_cpu_read_coverage(const frame_buffers *b, size_t block, int lane, float out[4]) {
    const coverage *c = &b->coverage;
    const coverage_sum *sum = sum_of(c, block);
    memset(out, 0, 4 * sizeof(*out));
    if (!sum)
        return;
    for (int k = 0; k < 3; k++)
        out[k] = sum->rgb[k][lane] / (float)c->frames;
    out[3] = (float)sum->frames[lane] / (float)c->frames;
}
