/* What emitters that are seen directly add to a pixel's mean, apart from the rest. A display needs the two apart: the
 * mean of a lamp and of the wall beside it lies far above white wherever the lamp covers a tenth of the pixel, so edges
 * come out jagged. Few blocks see emitters, so only these have a place. */
#ifndef NOC_EMITTER_COVERAGE_H
#define NOC_EMITTER_COVERAGE_H

#include "base/base.h"
#include "core/blocks.h"

/* Sums over the frames of the mean, of those in which a lane saw an emitter. */
typedef struct noc_coverage_sum {
    float rgb[3][BLOCK];
    uint32_t frames[BLOCK];
} noc_coverage_sum;

/* Zero-initialise. */
typedef struct noc_coverage {
    uint32_t *place; /* [blocks] index + 1 in sums, 0: saw none; NULL: no frame yet */
    uint16_t *seen;  /* [blocks] lanes that saw an emitter in a frame of the mean */
    NOC_ARRAY(noc_coverage_sum) sums;
    uint64_t frames; /* of the mean */
} noc_coverage;

/* Room for a frame. emitter: of each block the lanes that see one; accumulated: frames in the mean before it. False
 * where memory is refused. */
bool noc_coverage_reserve(noc_coverage *c, const uint16_t *emitter, size_t blocks, uint64_t accumulated) NOC_MUST_USE;
/* The frame is complete. */
void noc_coverage_keep(noc_coverage *c, const uint16_t *emitter, const gblock *g, const cblock *colour, size_t blocks,
                       uint64_t accumulated);
void noc_coverage_read(const noc_coverage *c, size_t block, int lane, float out[4]); /* as noc_image.coverage */
bool noc_coverage_saw(const noc_coverage *c, size_t block, int lane); /* an emitter in a frame of the mean */
void noc_coverage_free(noc_coverage *c);

#endif
