/* Views of where a pixel's light comes from (NOC_AOV_GROUP, NOC_AOV_PLACED): what lights add to its colour, summed up
 * by a label of the light. A pixel has a few places for labels. Where there are more labels than places, the one with
 * the least light makes room and leaves its sum to the new one (the Space-Saving summary of Metwally, Agrawal and El
 * Abbadi, 2005), so that whatever brings more than one part in SOURCE_PLACES of the light has a place. */
#include "backend/cpu/cpu.h"
#include "backend/cpu/lanes_tmpl.h"

#include <string.h>

static float label_of(const noc_light_record *r, noc_aov aov) {
    if (aov == NOC_AOV_GROUP)
        return (float)noc_light_group(r);
    return (float)(!noc_light_is_lamp(r)           ? NOC_PLACED_OTHER
                   : r->flags & NOC_LIGHT_INFERRED ? NOC_PLACED_INFERRED
                                                   : NOC_PLACED_MAPPED);
}

/* place: SOURCE_PLACES labels (-1: free) and then their sums, each an array of a block's lanes. */
static void add(float (*place)[BLOCK], int l, float label, float y) {
    int to = 0;
    for (int i = 0; i < SOURCE_PLACES; i++) {
        if (place[i][l] == label || place[i][l] < 0) {
            to = i;
            break;
        }
        if (place[SOURCE_PLACES + i][l] < place[SOURCE_PLACES + to][l])
            to = i;
    }
    float *sum = &place[SOURCE_PLACES + to][l];
    *sum = place[to][l] < 0 ? y : *sum + y;
    place[to][l] = label;
}

/* Light of a block's lanes, by the lights that it is of. */
static void note(const stage_run *run, const uint32_t *id, const cblock *c, uint32_t lanes, size_t block) {
    const aov_buffers *v = &run->s->b.aovs;
    for (noc_aov aov = NOC_AOV_GROUP; aov <= NOC_AOV_PLACED; aov++)
        for (uint32_t bits = v->made[aov] ? lanes : 0; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            float y = luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
            if (y > 0)
                add(&v->made[aov][2 * SOURCE_PLACES * block], l, label_of(&run->s->scene->lights.data[id[l]], aov), y);
        }
}

static bool notes(const stage_run *run) {
    const aov_buffers *v = &run->s->b.aovs;
    return v->made[NOC_AOV_GROUP] || v->made[NOC_AOV_PLACED];
}

uint32_t noc_cpu_shade_samples(const stage_run *run, const gblock *g, const rblock *r, uint32_t lanes, size_t block) {
    if (notes(run)) { /* on its own, so that what the samples add is told to the last bit */
        cblock alone = { 0 };
        run->k->shade(&run->ctx, g, r, lanes, &alone);
        note(run, r->light, &alone, lanes, block);
    }
    return run->k->shade(&run->ctx, g, r, lanes, &run->s->b.colour[block]);
}

void noc_cpu_note_emitters(const stage_run *run, const gblock *g, const cblock *c, size_t block) {
    if (notes(run))
        note(run, g->light, c, run->s->b.emitter[block], block);
}

void noc_cpu_keep_sources(aov_buffers *v, size_t block, uint32_t fresh) {
    for (noc_aov aov = NOC_AOV_GROUP; aov <= NOC_AOV_PLACED; aov++) {
        if (!(v->asked >> aov & 1))
            continue;
        float(*from)[BLOCK] = &v->made[aov][2 * SOURCE_PLACES * block];
        float(*to)[BLOCK] = &v->kept[aov][2 * SOURCE_PLACES * block];
        if (fresh >> aov & 1) {
            memcpy(to, from, 2 * SOURCE_PLACES * sizeof(*to));
            continue;
        }
        for (int i = 0; i < SOURCE_PLACES; i++)
            for (int l = 0; l < BLOCK; l++)
                if (from[i][l] >= 0)
                    add(to, l, from[i][l], from[SOURCE_PLACES + i][l]);
    }
}

float noc_cpu_main_source(float (*place)[BLOCK], int l) {
    int most = 0;
    for (int i = 1; i < SOURCE_PLACES; i++)
        if (place[SOURCE_PLACES + i][l] > place[SOURCE_PLACES + most][l])
            most = i;
    return place[most][l];
}
