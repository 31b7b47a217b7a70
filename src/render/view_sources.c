/* Views that sum light up as it is shaded: illuminance; and where a pixel's light comes from (NOC_AOV_GROUP,
 * NOC_AOV_PLACED, NOC_AOV_INFLUENTIAL and its like): core/sources.h. */
#include "render/frame_views.h"

#include "scene/emitters.h"

/* The slots of a lane: labels, then sums. */
struct core_context {
    float (*place)[BLOCK];
    uint32_t slots;
    int lane;
};

#include "core/measured.h"
#include "core/moments.h"
#include "core/sources.h"

#include <string.h>

FN1 f1 source_label(CTX u1 i) { return ctx->place[i][ctx->lane]; }
FN1 f1 source_sum(CTX u1 i) { return ctx->place[ctx->slots + i][ctx->lane]; }

_Static_assert(NOC_PLACED_OTHER == 0 && NOC_PLACED_MAPPED == 1 && NOC_PLACED_INFERRED == 2,
               "as source_placed has them");
_Static_assert(EMITTER_SLOTS == NOC_AOV_EMITTERS, "as the header says");

size_t noc_source_slots(int aov) {
    return aov == NOC_AOV_GROUP || aov == NOC_AOV_PLACED ? SOURCE_SLOTS
           : aov == NOC_AOV_INFLUENTIAL                  ? EMITTER_SLOTS
                                                         : 0;
}

size_t noc_source_entries(int aov) { return 2 * noc_source_slots(aov) + (aov == NOC_AOV_INFLUENTIAL); }

static void add(float (*place)[BLOCK], size_t slots, int lane, float label, float y) {
    struct core_context of = { place, (uint32_t)slots, lane };
    source_slot s = source_find(&of, of.slots, label);
    place[slots + s.at][lane] = s.sum + y;
    place[s.at][lane] = label;
}

static const noc_aov sources[] = { NOC_AOV_GROUP, NOC_AOV_PLACED, NOC_AOV_INFLUENTIAL };

static float label_of(const noc_views *v, const noc_scene *scene, noc_aov aov, uint32_t light) {
    const noc_light_record *r = &scene->lights.data[light];
    return aov == NOC_AOV_INFLUENTIAL ? v->emitter_labels[light]
           : aov == NOC_AOV_GROUP     ? source_group(r->flags)
                                      : source_placed(r->kind, r->flags);
}

void noc_views_note(const noc_views *v, const noc_scene *scene, const uint32_t *light, const cblock *c, uint32_t lanes,
                    size_t block) {
    for (size_t i = 0; i < NOC_COUNT(sources); i++) {
        noc_aov aov = sources[i];
        for (uint32_t bits = v->made[aov] ? lanes : 0; bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            float y = luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
            if (y > 0)
                add(&v->made[aov][noc_source_entries(aov) * block], noc_source_slots(aov), l,
                    label_of(v, scene, aov, light[l]), y);
        }
    }
}

bool noc_views_note_sources(const noc_views *v) {
    return v->made[NOC_AOV_GROUP] || v->made[NOC_AOV_PLACED] || v->made[NOC_AOV_INFLUENTIAL];
}

void noc_views_note_sky(const noc_views *v, const cblock *c, uint32_t lanes, size_t block) {
    float *sum = v->made[NOC_AOV_INFLUENTIAL][noc_source_entries(NOC_AOV_INFLUENTIAL) * block + 2 * EMITTER_SLOTS];
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        sum[l] = NOC_MAX(sum[l], 0.0f) + luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l]));
    }
}

noc_status noc_views_label_emitters(noc_views *v, const noc_scene *scene, noc_log *log) {
    const noc_scene_versions *now = &scene->versions;
    uint64_t of[2] = { now->lights + 1, now->geometry };
    if (!memcmp(of, v->labelled, sizeof(of)))
        return NOC_OK;
    noc_emitters emitters;
    float *labels = noc_emitters_make(scene, &emitters) ? noc_alloc_large(emitters.lights + 1, sizeof(*labels)) : NULL;
    for (size_t i = 0; labels && i < emitters.lights; i++)
        labels[i] = (float)(emitters.of[i] == NOC_NO_EMITTER ? i : emitters.all.data[emitters.of[i]].first);
    size_t lights = emitters.lights;
    noc_emitters_free(&emitters);
    if (!labels)
        return noc_error(log, NOC_ERR_MEMORY, "render: no memory for the names of %zu lights", scene->lights.len);
    free(v->emitter_labels);
    v->emitter_labels = labels;
    v->emitter_label_count = lights;
    memcpy(v->labelled, of, sizeof(of));
    return NOC_OK;
}

uint32_t noc_views_measured(const float *lux) {
    uint32_t lanes = 0;
    for (int l = 0; l < BLOCK; l++)
        lanes |= (uint32_t)(lux[l] >= 0) << l;
    return lanes;
}

void noc_views_find_light_colours(noc_views *v, const noc_scene *scene) {
    if (v->coloured == scene->versions.commits + 1)
        return;
    v->coloured = scene->versions.commits + 1;
    v->light_colours = 0;
    for (size_t i = 0; i < scene->lights.len; i++) {
        const float *e = scene->lights.data[i].e;
        v->light_colours |= 1u << colour_components(V3(e[0], e[1], e[2]));
    }
    v->light_colours &= ~1u; /* dark ones */
}

static void keep_mean(noc_views *v, noc_aov aov, size_t block, bool fresh) {
    const float *from = v->made[aov][block];
    float *mean = v->kept[aov][2 * block], *frames = v->kept[aov][2 * block + 1];
    for (int l = 0; l < BLOCK; l++) {
        if (fresh)
            mean[l] = frames[l] = 0;
        if (from[l] < 0)
            continue;
        frames[l] += 1;
        mean[l] = mean_add(mean[l], from[l], 1 / frames[l]);
    }
}

/* Adds a frame's sums to those of the frames before. */
static void add_sources(float (*from)[BLOCK], float (*to)[BLOCK], size_t slots, size_t entries) {
    for (size_t i = 0; i < slots; i++)
        for (int l = 0; l < BLOCK; l++)
            if (from[i][l] >= 0)
                add(to, slots, l, from[i][l], from[slots + i][l]);
    for (size_t i = 2 * slots; i < entries; i++)
        for (int l = 0; l < BLOCK; l++)
            if (from[i][l] > 0)
                to[i][l] = NOC_MAX(to[i][l], 0.0f) + from[i][l];
}

void noc_views_keep_sources(noc_views *v, size_t block, uint32_t fresh) {
    static const noc_aov means[] = { NOC_AOV_ILLUMINANCE, NOC_AOV_EXPECTED };
    for (size_t k = 0; k < NOC_COUNT(means); k++)
        if (v->asked >> means[k] & 1)
            keep_mean(v, means[k], block, fresh >> means[k] & 1);
    for (size_t k = 0; k < NOC_COUNT(sources); k++) {
        noc_aov aov = sources[k];
        size_t entries = noc_source_entries(aov);
        if (!(v->asked >> aov & 1))
            continue;
        float(*from)[BLOCK] = &v->made[aov][entries * block], (*to)[BLOCK] = &v->kept[aov][entries * block];
        if (fresh >> aov & 1)
            memcpy(to, from, entries * sizeof(*to));
        else
            add_sources(from, to, noc_source_slots(aov), entries);
    }
}

/* One of the four views of emitters. */
static float emitter_view(const noc_views *v, noc_aov aov, size_t block, int l) {
    float(*place)[BLOCK] = &v->kept[NOC_AOV_INFLUENTIAL][noc_source_entries(NOC_AOV_INFLUENTIAL) * block];
    double all = NOC_MAX(place[2 * EMITTER_SLOTS][l], 0.0f);
    int rank[2] = { -1, -1 };
    for (int i = 0; i < (int)EMITTER_SLOTS && place[i][l] >= 0; i++) {
        float y = place[EMITTER_SLOTS + (unsigned)i][l];
        all += y;
        if (rank[0] < 0 || y > place[(int)EMITTER_SLOTS + rank[0]][l]) {
            rank[1] = rank[0];
            rank[0] = i;
        } else if (rank[1] < 0 || y > place[(int)EMITTER_SLOTS + rank[1]][l]) {
            rank[1] = i;
        }
    }
    int at = rank[aov == NOC_AOV_RUNNER_UP || aov == NOC_AOV_RUNNER_UP_SHARE];
    bool share = aov == NOC_AOV_INFLUENTIAL_SHARE || aov == NOC_AOV_RUNNER_UP_SHARE;
    if (at < 0)
        return share && rank[0] >= 0 ? 0 : -1;
    return share ? (float)(place[(int)EMITTER_SLOTS + at][l] / all) : place[at][l];
}

float noc_views_mean(const noc_views *v, noc_aov aov, size_t block, int l) {
    float(*kept)[BLOCK] = v->kept[aov];
    return kept[2 * block + 1][l] > 0 ? kept[2 * block][l] : -1;
}

float noc_views_source(const noc_views *v, noc_aov aov, size_t block, int l) {
    if (NOC_AOV_BITS_EMITTERS >> aov & 1)
        return emitter_view(v, aov, block, l);
    float(*place)[BLOCK] = &v->kept[aov][2 * SOURCE_SLOTS * block];
    unsigned most = 0;
    for (unsigned i = 1; i < SOURCE_SLOTS; i++)
        if (place[SOURCE_SLOTS + i][l] > place[SOURCE_SLOTS + most][l])
            most = i;
    return place[most][l];
}
