/* Views of the light sampling (noc_aov): gathered while a frame is made, kept once it is complete. Nothing here is
 * reached unless a frame asks for it, and nothing here is read by the passes, so a view cannot change the picture. */
#include "backend/cpu/cpu.h"
#include "core/camera.h"
#include "core/moments.h"

#include <math.h>

#define BIT(aov) (1u << NOC_AOV_##aov)
enum {
    /* by the passes, so a dropped frame must not touch what is kept */
    GATHERED = BIT(LIGHTS) | BIT(DENSITY) | BIT(RAYS) | BIT(OBJECT) | BIT(CLASS) | BIT(GROUP) | BIT(PLACED) |
               BIT(ILLUMINANCE) | BIT(INFLUENTIAL),
    RESERVOIRS = BIT(LIGHT) | BIT(WEIGHT) | BIT(CONFIDENCE),
    /* what is seen: emitters too */
    SURFACES = BIT(DEPTH) | BIT(NORMAL) | BIT(CLASS) | BIT(OBJECT) | BIT(MOTION),
    EMITTERS =
        BIT(INFLUENTIAL) | BIT(INFLUENTIAL_SHARE) | BIT(RUNNER_UP) | BIT(RUNNER_UP_SHARE), /* kept[INFLUENTIAL] */
    SUMS = BIT(GROUP) | BIT(PLACED) | BIT(ILLUMINANCE) | EMITTERS,                         /* over frames: sources.c */
    MOMENTS = BIT(VARIANCE) | BIT(ERROR), /* kept[VARIANCE]: sum of squared deviations; kept[ERROR]: mean luminance */
};

/* Buffers that these views take. */
static uint32_t buffers_of(uint32_t aovs) {
    return aovs | (aovs & MOMENTS ? MOMENTS : 0) | (aovs & EMITTERS ? BIT(INFLUENTIAL) : 0);
}

/* Entries of a block, of the frame being made and of those that are kept: a vector's components one after the other. */
static size_t made_entries(int aov) {
    if (!(GATHERED >> aov & 1))
        return 0;
    return NOC_MAX(noc_cpu_source_entries(aov), (size_t)1);
}
static size_t kept_entries(int aov) {
    switch (aov) {
    case NOC_AOV_INFLUENTIAL_SHARE:
    case NOC_AOV_RUNNER_UP:
    case NOC_AOV_RUNNER_UP_SHARE: return 0;
    case NOC_AOV_LUMINANCE: return 0;   /* the picture has it */
    case NOC_AOV_ILLUMINANCE: return 2; /* mean, frames */
    default: return NOC_MAX(made_entries(aov), (size_t)noc_aov_components((noc_aov)aov));
    }
}

size_t noc_cpu_aov_bytes(uint32_t aovs) {
    size_t floats = 0;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (buffers_of(aovs) >> aov & 1)
            floats += made_entries(aov) + kept_entries(aov);
    return sizeof(float) * floats;
}

static void drop(aov_buffers *v, int aov) {
    free(v->made[aov]);
    free(v->kept[aov]);
    v->made[aov] = v->kept[aov] = NULL;
    v->held &= ~(1u << aov);
}

/* Drops those that are not among these bits. */
static void drop_but(aov_buffers *v, uint32_t aovs) {
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (!(aovs >> aov & 1))
            drop(v, aov);
}

void noc_cpu_free_aovs(aov_buffers *v) {
    drop_but(v, 0);
    free(v->emitter_labels);
    *v = (aov_buffers){ 0 };
}

static bool allocate(float (**buffer)[BLOCK], size_t blocks) {
    return !blocks || *buffer || (*buffer = noc_alloc_large(blocks, sizeof(**buffer))) != NULL;
}

noc_status noc_cpu_begin_aovs(cpu_view *s, uint32_t aovs) {
    aov_buffers *v = &s->b.aovs;
    size_t blocks = (size_t)s->b.blocks_x * s->b.blocks_y;
    if (aovs & EMITTERS && noc_cpu_label_emitters(s) != NOC_OK)
        return NOC_ERR_MEMORY;
    v->asked = buffers_of(aovs);
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(v->asked >> aov & 1)) {
            free(v->made[aov]);
            v->made[aov] = NULL;
        } else if (!allocate(&v->kept[aov], kept_entries(aov) * blocks) ||
                   !allocate(&v->made[aov], made_entries(aov) * blocks)) {
            v->asked = v->held;
            drop_but(v, v->held);
            return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for views of %d x %d", s->b.width, s->b.height);
        }
        for (size_t i = 0; v->made[aov] && i < made_entries(aov) * blocks; i++)
            for (int l = 0; l < BLOCK; l++)
                v->made[aov][i][l] = aov == NOC_AOV_RAYS ? 0 : -1;
    }
    if (v->asked & BIT(ILLUMINANCE))
        noc_cpu_find_light_colours(s);
    return NOC_OK;
}

/* How often a light that lane l chose is expected among its candidates. */
static float expected(const stage_run *run, const worker *w, uint32_t light, int l) {
    const noc_plan *p = run->frame->plan;
    if (p->candidates == NOC_CANDIDATES_UNIFORM)
        return (float)p->candidate_count / (float)run->ctx.light_count;
    if (p->candidates == NOC_CANDIDATES_POWER)
        return (float)p->candidate_count / run->ctx.alias->slots[light].inverse;
    if (p->candidates == NOC_CANDIDATES_LISTS) {
        const light_list *list = &w->lists->build.list;
        for (uint32_t i = 0; i < list->count; i++)
            if (list->light[i] == light)
                return 1 / (list->weight[i] * (float)list->copies);
    } else {
        for (int i = 0; i < p->candidate_count; i++)
            if (w->picks->drawn.light[i][l] == light && w->picks->drawn.inverse[i][l] > 0)
                return (float)p->candidate_count / w->picks->drawn.inverse[i][l];
    }
    return -1;
}

void noc_cpu_aov_candidates(const stage_run *run, const worker *w, int i, size_t block, uint32_t lanes,
                            const rblock *r) {
    const aov_buffers *v = &run->s->b.aovs;
    bool lists = run->frame->plan->candidates == NOC_CANDIDATES_LISTS;
    for (int l = 0; l < BLOCK; l++) {
        if (!(lanes >> l & 1))
            continue;
        if (v->made[NOC_AOV_LIGHTS])
            v->made[NOC_AOV_LIGHTS][block][l] = (float)(lists ? w->lists->build.list.count / w->lists->build.list.copies
                                                              : noc_found_count(&w->picks->found, i, l));
        if (v->made[NOC_AOV_DENSITY] && r->w[l] > 0 && run->frame->plan->candidates != NOC_CANDIDATES_INFLUENCE)
            v->made[NOC_AOV_DENSITY][block][l] = expected(run, w, r->light[l], l);
    }
}

static void keep_reservoirs(aov_buffers *v, size_t block, const rblock *r) {
    for (int l = 0; l < BLOCK; l++) {
        if (v->kept[NOC_AOV_LIGHT])
            v->kept[NOC_AOV_LIGHT][block][l] = r->w[l] > 0 ? (float)r->light[l] : -1;
        if (v->kept[NOC_AOV_WEIGHT])
            v->kept[NOC_AOV_WEIGHT][block][l] = r->w[l];
        if (v->kept[NOC_AOV_CONFIDENCE])
            v->kept[NOC_AOV_CONFIDENCE][block][l] = r->m[l];
    }
}

static void keep_surfaces(const noc_scene *scene, aov_buffers *v, size_t block, const gblock *g) {
    for (int l = 0; l < BLOCK; l++) {
        bool some = g->material[l] != NO_SURFACE;
        if (v->kept[NOC_AOV_DEPTH])
            v->kept[NOC_AOV_DEPTH][block][l] = some ? g->depth[l] : -1;
        if (v->kept[NOC_AOV_CLASS]) { /* a wall's label was gathered */
            float *label = &v->kept[NOC_AOV_CLASS][block][l];
            *label = !some ? -1 : *label >= 0 ? *label : (float)scene->materials.data[g->material[l]].cls;
        }
        for (int k = 0; v->kept[NOC_AOV_NORMAL] && k < 3; k++)
            v->kept[NOC_AOV_NORMAL][3 * block + (size_t)k][l] = some ? (k == 0 ? g->nx : k == 1 ? g->ny : g->nz)[l] : 0;
    }
}

static float luminance_of(const cblock *c, int l) { return luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l])); }

static void add_moments(aov_buffers *v, size_t block, const cblock *c) {
    float *mean = v->kept[NOC_AOV_ERROR][block], *squares = v->kept[NOC_AOV_VARIANCE][block];
    for (int l = 0; l < BLOCK; l++) {
        float y = luminance_of(c, l);
        moments m = v->frames ? (moments){ mean[l], squares[l] } : moments_none();
        m = moments_add(m, y, (float)(v->frames + 1));
        mean[l] = m.mean;
        squares[l] = m.squares;
    }
}

/* Before the view's buffers, and what it has seen of the scene, are handed on. */
static void keep_motion(const cpu_view *s, const noc_frame *frame, size_t block, const gblock *g) {
    gblock room;
    const gblock *then = noc_cpu_taken_back(s, block, g, &room);
    uint32_t known = noc_cpu_known_before(s, block);
    camera now = camera_of(frame->constants.camera), past = camera_of(frame->constants.previous);
    for (int l = 0; l < BLOCK; l++) {
        v3 motion = V3(0, 0, 0);
        if (frame->seen_before && known >> l & 1 && g->material[l] != NO_SURFACE) {
            v3 to = camera_project(past, V3(then->px[l], then->py[l], then->pz[l]));
            v3 from = camera_project(now, V3(g->px[l], g->py[l], g->pz[l]));
            if (to.z > 0)
                motion = V3(to.x - from.x, to.y - from.y, to.z);
        }
        float(*kept)[BLOCK] = &s->b.aovs.kept[NOC_AOV_MOTION][3 * block];
        kept[0][l] = motion.x;
        kept[1][l] = motion.y;
        kept[2][l] = motion.z;
    }
}

struct keep_run {
    cpu_view *s;
    const noc_frame *frame;
    uint32_t fresh; /* views whose sums begin with this frame */
};

static void keep_row(void *arg, size_t row, int index) {
    const struct keep_run *run = arg;
    frame_buffers *b = &run->s->b;
    aov_buffers *v = &b->aovs;
    (void)index;
    size_t first = row * (size_t)b->blocks_x;
    for (size_t i = first; i < first + (size_t)b->blocks_x; i++) {
        const gblock *g = &b->g[run->frame->gbuffer][i];
        if (v->asked & RESERVOIRS)
            keep_reservoirs(v, i, &b->r[run->s->shaded_set][i]);
        if (v->asked & SURFACES)
            keep_surfaces(run->s->scene, v, i, g);
        if (v->asked & BIT(MOTION))
            keep_motion(run->s, run->frame, i, g);
        if (v->asked & MOMENTS)
            add_moments(v, i, &b->colour[i]);
        if (v->asked & SUMS)
            noc_cpu_keep_sources(v, i, run->fresh);
        for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
            if (!(v->asked >> aov & 1 & ~((BIT(RAYS) | BIT(LUMINANCE) | MOMENTS | SURFACES | SUMS) >> aov)))
                continue;
            for (int l = 0; l < BLOCK; l++)
                if (g->material[l] == NO_SURFACE || g->light[l] != NOC_NO_LIGHT)
                    v->kept[aov][i][l] = -1;
        }
    }
}

void noc_cpu_keep_aovs(cpu_view *s, const noc_frame *frame) {
    aov_buffers *v = &s->b.aovs;
    drop_but(v, v->asked);
    if (!v->asked)
        return;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (v->asked & GATHERED & ~SUMS & 1u << aov) {
            float(*kept)[BLOCK] = v->kept[aov];
            v->kept[aov] = v->made[aov];
            v->made[aov] = kept;
        }
    if (!frame->accumulated || !(v->held & MOMENTS))
        v->frames = 0;
    noc_pool_run(s->pool, (size_t)s->b.blocks_y, keep_row,
                 &(struct keep_run){ s, frame, frame->accumulated ? ~v->held : ~0u });
    v->held = v->asked;
    v->gbuffer = frame->gbuffer;
    v->frames += (v->asked & MOMENTS) != 0;
}

bool noc_cpu_read_aov(void *state, noc_aov aov, float *value) {
    const frame_buffers *b = &((cpu_view *)state)->b;
    const aov_buffers *v = &b->aovs;
    if (!(v->held >> aov & 1))
        return false;
    double n = (double)v->frames;
    for (int y = 0; y < b->height; y++)
        for (int x = 0; x < b->width; x++) {
            size_t at = (size_t)(y / BLOCK_SIDE) * (size_t)b->blocks_x + (size_t)(x / BLOCK_SIDE);
            int l = (y & 3) * 4 + (x & 3);
            size_t to = (size_t)y * (size_t)b->width + (size_t)x;
            if (noc_aov_components(aov) == 3) {
                for (size_t k = 0; k < 3; k++)
                    value[3 * to + k] = v->kept[aov][3 * at + k][l];
                continue;
            }
            double out = aov == NOC_AOV_LUMINANCE     ? luminance_of(&b->picture[at], l)
                         : aov == NOC_AOV_ILLUMINANCE ? noc_cpu_mean_lux(v, at, l)
                         : EMITTERS >> aov & 1        ? noc_cpu_emitter_view(v, aov, at, l)
                         : aov == NOC_AOV_GROUP || aov == NOC_AOV_PLACED
                             ? noc_cpu_main_source(&v->kept[aov][2 * SOURCE_PLACES * at], l)
                             : v->kept[aov][at][l];
            if (MOMENTS >> aov & 1) {
                double variance = v->kept[NOC_AOV_VARIANCE][at][l] / (n - 1), mean = v->kept[NOC_AOV_ERROR][at][l];
                bool none = n < 2 || noc_cpu_saw_emitter(b, at, l) || b->g[v->gbuffer][at].material[l] == NO_SURFACE ||
                            (aov == NOC_AOV_ERROR && !(mean > 0));
                out = none ? -1 : aov == NOC_AOV_ERROR ? sqrt(variance / n) / mean : variance;
            }
            value[to] = isfinite((float)out) ? (float)out : -1;
        }
    return true;
}
