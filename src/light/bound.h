/* light/bound: what structures over lights need of each: where it is, which way it faces, how strong it is; and an
 * order in which lights that lie close together follow each other. */
#ifndef NOC_LIGHT_BOUND_H
#define NOC_LIGHT_BOUND_H

#include "scene/scene.h"

typedef struct noc_light_bound {
    float p[3], radius; /* sphere around it, shape included */
    float n[3];         /* way it faces; 0: every way */
    float intensity;    /* greatest luminous intensity, cd */
} noc_light_bound;

typedef struct noc_light_key {
    uint64_t key;
    uint32_t id;
} noc_light_key;

noc_light_bound noc_bound_light(const noc_light_record *light);

/* Structures keep lights that stand apart from those that move, or were added of late: what stands costs nothing while
 * the others do. */
enum { NOC_STANDING, NOC_MOVING, NOC_HALVES };
/* The half that a light is in; NOC_HALVES: none, for there is no light in that place. */
static inline int noc_light_half(const noc_light_record *l) {
    if (l->flags & NOC_LIGHT_FREE)
        return NOC_HALVES;
    return noc_light_stands(l->flags) ? NOC_STANDING : NOC_MOVING;
}

/* Greatest luminous intensity of a light, cd: radiance times projected area. */
float noc_light_intensity(const noc_light_record *light);

/* A point of a light, u and v of the unit square, that light leaves in direction d from, clear of the light's own
 * surface. */
void noc_light_leave(const noc_light_record *light, const float d[3], float u, float v, float out[3]);

/* Which of the six sides of a cube a direction goes through; 6: none. */
uint64_t noc_side(const float n[3]);

/* 20 bits to every third: three of them make a Morton code. */
uint64_t noc_spread_bits(uint64_t x);

/* By key, stable, least significant byte first. scratch has n entries. */
void noc_sort_keys(noc_light_key *keys, noc_light_key *scratch, size_t n);

#endif
