/* readings: blocks of receivers whose light frames find until it is known well enough. */
#ifndef NOC_MEASURE_READINGS_H
#define NOC_MEASURE_READINGS_H

#include "core/blocks.h"
#include "render/view.h"
#include <nocturne/measure.h>

#define NO_READING UINT32_MAX
enum { BLOCK_PIXELS = 64 }; /* a side of a block's picture: as many receivers as it has pixels */
enum { BLOCK_AREA = BLOCK_PIXELS * BLOCK_PIXELS };

/* Mean and spread of a reading's samples so far (Welford 1962). */
typedef struct tally {
    double mean, squares; /* squares: sum of squared deviations */
    uint32_t samples;
} tally;

/* A block: what is read, by receivers that a frame after the other has at other places. */
typedef struct block {
    int width, height;  /* of its picture: multiples of 16, at most BLOCK_PIXELS */
    uint32_t seed;      /* its own */
    const uint32_t *of; /* of each pixel: the reading that it is a sample of, or NO_READING */
    const bool *counts; /* of each reading: does it count in the mean? NULL: all do */
    size_t count;       /* readings */
    uint32_t frames;    /* that were made of it; set by measure_block */
    tally *tallies;     /* of each; set by measure_block */
    /* Fills the receivers of a frame, one a pixel; material NO_SURFACE: the pixel has none in this frame. *some: one of
     * them has. */
    noc_status (*place)(void *user, uint32_t frame, noc_receiver *receivers, bool *some);
    void *user;
} block;

/* What blocks are measured by. */
typedef struct measuring {
    noc_view *view;
    noc_render_params render;
    noc_measure_params params;
    const noc_progress *progress; /* may be NULL */
    double from, to;              /* of the whole work: this block's share */
    bool whole;                   /* all params.samples are taken: to stop at a small error is to look at samples */
    uint32_t material;            /* of all receivers */
    noc_receiver *receivers;      /* BLOCK_AREA */
    noc_measure_info info;
    NOC_ARRAY(float) errors; /* relative, of readings over `least` */
    double weight, variance; /* of blocks: sum of samples a frame, and of their means' variances times its square */
    double began;
} measuring;

/* Checks the parameters, which may be NULL. What it made is freed by measuring_end, also after an error. */
noc_status measuring_begin(measuring *m, noc_view *view, const noc_measure_params *params,
                           const noc_progress *progress);
void measuring_end(measuring *m, noc_measure_info *info);

noc_status measure_block(measuring *m, block *b);
noc_reading reading_of(const tally *t, uint32_t frames);
/* Counts a reading that is handed out. */
noc_status note_reading(measuring *m, const noc_reading *r);

/* Reports a meter that has no place or faces nowhere. */
noc_status meters_check(const noc_meter *meters, size_t count, noc_log *log);
/* Reads meters that are in order, by samples of that seed. */
noc_status measure_meters(measuring *m, const noc_meter *meters, size_t count, uint32_t seed, noc_reading *readings);

noc_receiver meter_receiver(const measuring *m, const double place[3], const double normal[3]);
/* Number i of a sequence over the unit square whose parts are evenly filled (R2, Roberts 2018), from a start by key. */
void spread_2d(uint32_t key, uint32_t i, double out[2]);
uint32_t mix(uint32_t a, uint32_t b);

#endif
