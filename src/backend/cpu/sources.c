/* Views that sum light up as it is shaded: illuminance; and where a pixel's light comes from (NOC_AOV_GROUP,
 * NOC_AOV_PLACED, NOC_AOV_INFLUENTIAL and its like): what lights add to its colour, summed up by a label of the light.
 * A pixel has a few places for labels. Where there are more labels than places, the one with the least light makes room
 * and leaves its sum to the new one (the Space-Saving summary of Metwally, Agrawal and El Abbadi, 2005), so that
 * whatever brings more than one part in so many of the light has a place, and no sum is too large by more than that. */
#include "backend/cpu/cpu.h"
#include "backend/cpu/lanes_tmpl.h"
#include "core/moments.h"
#include "scene/emitters.h"

#include <string.h>

static float label_of(const noc_light_record *r, noc_aov aov) {
    if (aov == NOC_AOV_GROUP)
        return (float)noc_light_group(r);
    return (float)(!noc_light_is_lamp(r)           ? NOC_PLACED_OTHER
                   : r->flags & NOC_LIGHT_INFERRED ? NOC_PLACED_INFERRED
                                                   : NOC_PLACED_MAPPED);
}

/* place: so many labels (-1: free) and then their sums, each an array of a block's lanes. */
static void add(float (*place)[BLOCK], size_t places, int l, float label, float y) {
    size_t to = 0;
    for (size_t i = 0; i < places; i++) {
        if (place[i][l] == label || place[i][l] < 0) {
            to = i;
            break;
        }
        if (place[places + i][l] < place[places + to][l])
            to = i;
    }
    float *sum = &place[places + to][l];
    *sum = place[to][l] < 0 ? y : *sum + y;
    place[to][l] = label;
}

static const noc_aov sources[] = { NOC_AOV_GROUP, NOC_AOV_PLACED, NOC_AOV_INFLUENTIAL };

/* Light of a block's lanes, by the lights that it is of. */
static void note(const stage_run *run, const uint32_t *id, const cblock *c, uint32_t lanes, size_t block) {
    const aov_buffers *v = &run->s->b.aovs;
    for (size_t i = 0; i < NOC_COUNT(sources); i++) {
        noc_aov aov = sources[i];
        for (uint32_t bits = v->made[aov] ? lanes : 0; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            float y = luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
            if (!(y > 0))
                continue;
            float label = aov == NOC_AOV_INFLUENTIAL ? v->emitter_labels[id[l]]
                                                     : label_of(&run->s->scene->lights.data[id[l]], aov);
            add(&v->made[aov][noc_cpu_source_entries(aov) * block], noc_cpu_source_places(aov), l, label, y);
        }
    }
}

static bool notes(const stage_run *run) {
    const aov_buffers *v = &run->s->b.aovs;
    return v->made[NOC_AOV_GROUP] || v->made[NOC_AOV_PLACED] || v->made[NOC_AOV_INFLUENTIAL];
}

/* The sky's light, beside the emitters'. */
static void note_sky(const stage_run *run, const cblock *c, uint32_t lanes, size_t block) {
    float *sum =
        run->s->b.aovs
            .made[NOC_AOV_INFLUENTIAL][noc_cpu_source_entries(NOC_AOV_INFLUENTIAL) * block + 2 * EMITTER_PLACES];
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        sum[l] = NOC_MAX(sum[l], 0.0f) + luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
    }
}

noc_status noc_cpu_label_emitters(cpu_view *s) {
    aov_buffers *v = &s->b.aovs;
    const noc_scene_versions *now = &s->scene->versions;
    uint64_t of[2] = { now->lights + 1, now->geometry };
    if (!memcmp(of, v->labelled, sizeof(of)))
        return NOC_OK;
    noc_emitters emitters;
    float *labels =
        noc_emitters_make(s->scene, &emitters) ? noc_alloc_large(emitters.lights + 1, sizeof(*labels)) : NULL;
    for (size_t i = 0; labels && i < emitters.lights; i++)
        labels[i] = (float)(emitters.of[i] == NOC_NO_EMITTER ? i : emitters.all.data[emitters.of[i]].first);
    size_t lights = emitters.lights;
    noc_emitters_free(&emitters);
    if (!labels)
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the names of %zu lights", s->scene->lights.len);
    free(v->emitter_labels);
    v->emitter_labels = labels;
    v->emitter_label_count = lights;
    memcpy(v->labelled, of, sizeof(of));
    return NOC_OK;
}

/* Lanes whose illuminance is summed up. */
static uint32_t measured(const float *lux) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(lux[l] >= 0) << l;
    return lanes;
}

static uint32_t shade(const stage_run *run, const gblock *g, const rblock *r, const cblock *brings, uint32_t lanes,
                      cblock *out) {
    return brings ? run->k->shade_known(brings, r->w, lanes, out) : run->k->shade(&run->ctx, g, r, lanes, out);
}

uint32_t noc_cpu_shade_samples(const stage_run *run, const gblock *g, const rblock *r, const cblock *brings,
                               uint32_t lanes, size_t block) {
    float(*lux)[BLOCK] = run->s->b.aovs.made[NOC_AOV_ILLUMINANCE];
    if (lux)
        run->k->samples_lux(&run->ctx, g, r, lanes & measured(lux[block]), lux[block]);
    if (notes(run)) { /* on its own, so that what the samples add is told to the last bit */
        cblock alone = { 0 };
        shade(run, g, r, brings, lanes, &alone);
        note(run, r->light, &alone, lanes, block);
    }
    return shade(run, g, r, brings, lanes, &run->s->b.colour[block]);
}

uint32_t noc_cpu_shade_sky(const stage_run *run, const gblock *g, const rayblock *rays, const float *share,
                           uint32_t lanes, size_t block) {
    float(*lux)[BLOCK] = run->s->b.aovs.made[NOC_AOV_ILLUMINANCE];
    if (lux)
        run->k->sky_lux(&run->ctx, g, rays, share, lanes & measured(lux[block]), lux[block]);
    if (run->s->b.aovs.made[NOC_AOV_INFLUENTIAL]) {
        cblock alone = { 0 };
        run->k->sky_shade(&run->ctx, g, rays, share, lanes, &alone);
        note_sky(run, &alone, lanes, block);
    }
    return run->k->sky_shade(&run->ctx, g, rays, share, lanes, &run->s->b.colour[block]);
}

static uint32_t components_of(float r, float g, float b) {
    return (uint32_t)(r > 0) | (uint32_t)(g > 0) << 1 | (uint32_t)(b > 0) << 2;
}

void noc_cpu_find_light_colours(cpu_view *s) {
    aov_buffers *v = &s->b.aovs;
    if (v->coloured == s->scene->versions.commits + 1)
        return;
    v->coloured = s->scene->versions.commits + 1;
    v->light_colours = 0;
    for (size_t i = 0; i < s->scene->lights.len; i++) {
        const float *e = s->scene->lights.data[i].e;
        v->light_colours |= 1u << components_of(e[0], e[1], e[2]);
    }
    v->light_colours &= ~1u; /* dark ones */
}

/* Where a light has nothing of the colours that a surface reflects diffusely, no candidate of it is ever kept, however
 * much it lights; and what gloss alone keeps says next to nothing. */
static bool may_measure(const stage_run *run, const gblock *g, int l) {
    surf s = surf_load(&run->ctx, g, l, run->ctx.frame->camera.eye);
    uint32_t reflected = components_of(s.albedo.x, s.albedo.y, s.albedo.z);
    for (uint32_t of = 1; of < 8; of++)
        if (run->s->b.aovs.light_colours >> of & 1 && !(of & reflected))
            return false;
    return true;
}

void noc_cpu_note_emitters(const stage_run *run, const gblock *g, const cblock *c, size_t block) {
    float(*lux)[BLOCK] = run->s->b.aovs.made[NOC_AOV_ILLUMINANCE];
    for (uint32_t bits = lux ? lanes_with_surface(g) & ~run->s->b.emitter[block] : 0; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        lux[block][l] = may_measure(run, g, l) ? 0 : -1;
    }
    if (notes(run))
        note(run, g->light, c, run->s->b.emitter[block], block);
}

static void keep_lux(aov_buffers *v, size_t block, bool fresh) {
    const float *from = v->made[NOC_AOV_ILLUMINANCE][block];
    float *mean = v->kept[NOC_AOV_ILLUMINANCE][2 * block], *frames = v->kept[NOC_AOV_ILLUMINANCE][2 * block + 1];
    for (int l = 0; l < BLOCK; l++) {
        if (fresh)
            mean[l] = frames[l] = 0;
        if (from[l] < 0)
            continue;
        frames[l] += 1;
        mean[l] = mean_add(mean[l], from[l], 1 / frames[l]);
    }
}

void noc_cpu_keep_sources(aov_buffers *v, size_t block, uint32_t fresh) {
    if (v->asked >> NOC_AOV_ILLUMINANCE & 1)
        keep_lux(v, block, fresh >> NOC_AOV_ILLUMINANCE & 1);
    for (size_t k = 0; k < NOC_COUNT(sources); k++) {
        noc_aov aov = sources[k];
        size_t places = noc_cpu_source_places(aov), entries = noc_cpu_source_entries(aov);
        if (!(v->asked >> aov & 1))
            continue;
        float(*from)[BLOCK] = &v->made[aov][entries * block], (*to)[BLOCK] = &v->kept[aov][entries * block];
        if (fresh >> aov & 1) {
            memcpy(to, from, entries * sizeof(*to));
            continue;
        }
        for (size_t i = 0; i < places; i++)
            for (int l = 0; l < BLOCK; l++)
                if (from[i][l] >= 0)
                    add(to, places, l, from[i][l], from[places + i][l]);
        for (size_t i = 2 * places; i < entries; i++)
            for (int l = 0; l < BLOCK; l++)
                if (from[i][l] > 0)
                    to[i][l] = NOC_MAX(to[i][l], 0.0f) + from[i][l];
    }
}

float noc_cpu_emitter_view(const aov_buffers *v, noc_aov aov, size_t block, int l) {
    float(*place)[BLOCK] = &v->kept[NOC_AOV_INFLUENTIAL][noc_cpu_source_entries(NOC_AOV_INFLUENTIAL) * block];
    double all = NOC_MAX(place[2 * EMITTER_PLACES][l], 0.0f);
    int rank[2] = { -1, -1 };
    for (int i = 0; i < EMITTER_PLACES && place[i][l] >= 0; i++) {
        float y = place[EMITTER_PLACES + i][l];
        all += y;
        if (rank[0] < 0 || y > place[EMITTER_PLACES + rank[0]][l]) {
            rank[1] = rank[0];
            rank[0] = i;
        } else if (rank[1] < 0 || y > place[EMITTER_PLACES + rank[1]][l]) {
            rank[1] = i;
        }
    }
    int at = rank[aov == NOC_AOV_RUNNER_UP || aov == NOC_AOV_RUNNER_UP_SHARE];
    bool share = aov == NOC_AOV_INFLUENTIAL_SHARE || aov == NOC_AOV_RUNNER_UP_SHARE;
    if (at < 0)
        return share && rank[0] >= 0 ? 0 : -1;
    return share ? (float)(place[EMITTER_PLACES + at][l] / all) : place[at][l];
}

float noc_cpu_mean_lux(const aov_buffers *v, size_t block, int l) {
    float(*kept)[BLOCK] = v->kept[NOC_AOV_ILLUMINANCE];
    return kept[2 * block + 1][l] > 0 ? kept[2 * block][l] : -1;
}

float noc_cpu_main_source(float (*place)[BLOCK], int l) {
    int most = 0;
    for (int i = 1; i < SOURCE_PLACES; i++)
        if (place[SOURCE_PLACES + i][l] > place[SOURCE_PLACES + most][l])
            most = i;
    return place[most][l];
}
