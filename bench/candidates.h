/* One run of the candidate bench, and what it reads. */
#ifndef BENCH_CANDIDATES_H
#define BENCH_CANDIDATES_H

#include <stdint.h>

enum { LAYOUT_SOA, LAYOUT_RECORDS, LAYOUT_COUNT };

typedef struct candidates_job {
    const float *records; /* 16 floats a light, 64-byte aligned */
    const float *soa[16]; /* the same, an array a field */
    uint32_t lights;
    const float *surfaces[13]; /* p n wo albedo f0: an array a field */
    uint32_t surface_count;    /* a multiple of 16 */
    int m;
} candidates_job;

/* Candidates for all surfaces; returns a checksum over every choice and weight. layout: LAYOUT_*. */
typedef uint64_t candidates_fn(const candidates_job *job, int layout);
candidates_fn candidates_scalar, candidates_baseline, candidates_avx2, candidates_avx512;

#endif
