/* Views: which buffers they take, what is kept of a complete frame, and how it is read. */
#include "render/frame_views.h"

#include "render/influence_core.h"
#include "core/moments.h"

#include <math.h>

#define BIT NOC_AOV_BIT
enum {
    /* by the passes, so a dropped frame must not touch what is kept */
    GATHERED = BIT(LIGHTS) | BIT(DENSITY) | BIT(RAYS) | BIT(OBJECT) | BIT(CLASS) | BIT(GROUP) | BIT(PLACED) |
               BIT(ILLUMINANCE) | BIT(INFLUENTIAL) | BIT(EXPECTED),
    RESERVOIRS = BIT(LIGHT) | BIT(WEIGHT) | BIT(CONFIDENCE),
    /* what is seen: emitters too */
    SURFACES = BIT(DEPTH) | BIT(NORMAL) | BIT(CLASS) | BIT(OBJECT) | BIT(MOTION),
    EMITTERS = NOC_AOV_BITS_EMITTERS,                   /* kept[INFLUENTIAL] */
    MEANS = BIT(ILLUMINANCE) | BIT(EXPECTED),           /* kept: the mean, and of how many frames */
    SUMS = BIT(GROUP) | BIT(PLACED) | MEANS | EMITTERS, /* over frames: view_sources.c */
    MOMENTS = BIT(VARIANCE) | BIT(ERROR), /* kept[VARIANCE]: sum of squared deviations; kept[ERROR]: mean luminance */
    /* those that are blank where there is no surface to light */
    OF_LIT = ~(BIT(RAYS) | BIT(LUMINANCE) | MOMENTS | SURFACES | SUMS),
};

/* ---- buffers ---- */

/* Buffers that these views take. */
static uint32_t buffers_of(uint32_t aovs) {
    return aovs | (aovs & MOMENTS ? MOMENTS : 0) | (aovs & EMITTERS ? BIT(INFLUENTIAL) : 0);
}

uint32_t noc_views_gathered(uint32_t aovs) { return buffers_of(aovs) & GATHERED; }
bool noc_views_need_reservoirs(uint32_t aovs) { return aovs & RESERVOIRS; }
bool noc_views_need_colour(uint32_t aovs) { return aovs & (MOMENTS | BIT(MOTION)); }
bool noc_views_need_surfaces(uint32_t aovs) { return aovs & (SURFACES | MOMENTS | OF_LIT); }

/* Entries of a block, of the frame being made and of those that are kept: a vector's components one after the other. */
size_t noc_views_made_entries(int aov) { return GATHERED >> aov & 1 ? NOC_MAX(noc_source_entries(aov), (size_t)1) : 0; }
static size_t kept_entries(int aov) {
    switch (aov) {
    case NOC_AOV_INFLUENTIAL_SHARE:
    case NOC_AOV_RUNNER_UP:
    case NOC_AOV_RUNNER_UP_SHARE: return 0;
    case NOC_AOV_LUMINANCE: return 0; /* the picture has it */
    case NOC_AOV_ILLUMINANCE:
    case NOC_AOV_EXPECTED: return 2; /* mean, frames */
    default: return NOC_MAX(noc_views_made_entries(aov), (size_t)noc_aov_components((noc_aov)aov));
    }
}

size_t noc_views_bytes(uint32_t aovs) {
    size_t floats = 0;
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++)
        if (buffers_of(aovs) >> aov & 1)
            floats += noc_views_made_entries(aov) + kept_entries(aov);
    return sizeof(float) * floats;
}

/* Drops those that are not among these bits. */
static void drop_but(noc_views *v, uint32_t aovs) {
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (aovs >> aov & 1)
            continue;
        free(v->made[aov]);
        free(v->kept[aov]);
        v->made[aov] = v->kept[aov] = NULL;
        v->held &= ~(1u << aov);
    }
}

void noc_views_free(noc_views *v) {
    drop_but(v, 0);
    free(v->emitter_labels);
    *v = (noc_views){ 0 };
}

static bool allocate(float (**buffer)[BLOCK], size_t blocks) {
    return !blocks || *buffer || (*buffer = noc_alloc_large(blocks, sizeof(**buffer))) != NULL;
}

float noc_views_start(int aov) { return aov == NOC_AOV_RAYS ? 0 : -1; }

noc_status noc_views_begin(noc_views *v, const noc_scene *scene, const noc_frame_blocks *b, uint32_t aovs,
                           noc_log *log) {
    size_t blocks = (size_t)b->blocks_x * (size_t)b->blocks_y;
    if (aovs & EMITTERS && noc_views_label_emitters(v, scene, log) != NOC_OK)
        return NOC_ERR_MEMORY;
    v->asked = buffers_of(aovs);
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(v->asked >> aov & 1)) {
            free(v->made[aov]);
            v->made[aov] = NULL;
        } else if (!allocate(&v->kept[aov], kept_entries(aov) * blocks) ||
                   !allocate(&v->made[aov], noc_views_made_entries(aov) * blocks)) {
            v->asked = v->held;
            drop_but(v, v->held);
            return noc_error(log, NOC_ERR_MEMORY, "render: no memory for views of %d x %d", b->width, b->height);
        }
        for (size_t i = 0; v->made[aov] && i < noc_views_made_entries(aov) * blocks; i++)
            for (int l = 0; l < BLOCK; l++)
                v->made[aov][i][l] = noc_views_start(aov);
    }
    if (v->asked & BIT(ILLUMINANCE))
        noc_views_find_light_colours(v, scene);
    return NOC_OK;
}

void noc_views_note_triangle(const noc_views *v, const noc_scene *scene, uint32_t triangle, uint32_t instance,
                             size_t block, int lane) {
    float(*objects)[BLOCK] = v->made[NOC_AOV_OBJECT], (*walls)[BLOCK] = v->made[NOC_AOV_CLASS];
    if (objects)
        objects[block][lane] = (float)noc_scene_object_of(scene, triangle, instance);
    noc_wall_verdict verdict = walls ? noc_scene_wall(scene, triangle) : NOC_WALL_UNSEEN;
    if (verdict)
        walls[block][lane] = (float)(NOC_CLASS_COUNT + (int)verdict - 1);
}

/* ---- a complete frame ---- */

static void keep_reservoirs(noc_views *v, size_t block, const rblock *r) {
    for (int l = 0; l < BLOCK; l++) {
        if (v->kept[NOC_AOV_LIGHT])
            v->kept[NOC_AOV_LIGHT][block][l] = r->w[l] > 0 ? (float)r->light[l] : -1;
        if (v->kept[NOC_AOV_WEIGHT])
            v->kept[NOC_AOV_WEIGHT][block][l] = r->w[l];
        if (v->kept[NOC_AOV_CONFIDENCE])
            v->kept[NOC_AOV_CONFIDENCE][block][l] = r->m[l];
    }
}

static void keep_surfaces(const noc_scene *scene, noc_views *v, size_t block, const gblock *g) {
    for (int l = 0; l < BLOCK; l++) {
        bool some = g->material[l] != NO_SURFACE;
        if (v->kept[NOC_AOV_DEPTH])
            v->kept[NOC_AOV_DEPTH][block][l] = some ? g->depth[l] : -1;
        if (v->kept[NOC_AOV_CLASS]) { /* a wall's label was gathered, of the windows in it, too */
            float *label = &v->kept[NOC_AOV_CLASS][block][l];
            noc_class cls = some ? scene->materials.data[g->material[l]].cls : NOC_CLASS_OTHER;
            *label = !some ? -1 : *label >= 0 && cls != NOC_CLASS_WINDOW ? *label : (float)cls;
        }
        for (int k = 0; v->kept[NOC_AOV_NORMAL] && k < 3; k++)
            v->kept[NOC_AOV_NORMAL][3 * block + (size_t)k][l] = some ? (k == 0 ? g->nx : k == 1 ? g->ny : g->nz)[l] : 0;
    }
}

static float luminance_of(const cblock *c, int l) { return luminance(V3(c->rgb[0][l], c->rgb[1][l], c->rgb[2][l])); }

static void add_moments(noc_views *v, size_t block, const cblock *c) {
    float *mean = v->kept[NOC_AOV_ERROR][block], *squares = v->kept[NOC_AOV_VARIANCE][block];
    for (int l = 0; l < BLOCK; l++) {
        float y = luminance_of(c, l);
        moments m = v->frames ? (moments){ mean[l], squares[l] } : moments_none();
        m = moments_add(m, y, (float)(v->frames + 1));
        mean[l] = m.mean;
        squares[l] = m.squares;
    }
}

static const uint32_t *instances_of(const noc_frame_blocks *b, size_t block) {
    return b->instance ? b->instance[block] : NULL;
}

static void keep_motion(noc_views *v, const noc_frame_blocks *b, const noc_frame *frame, size_t block) {
    gblock room;
    const gblock *g = &b->g[block];
    const gblock *then = noc_past_surfaces(b->past, b->scene, b->placings, instances_of(b, block), g, &room);
    uint32_t known = noc_past_known(b->past, b->scene, b->placings, instances_of(b, block));
    camera now = camera_of(frame->constants.camera), past = camera_of(frame->constants.previous);
    float(*kept)[BLOCK] = &v->kept[NOC_AOV_MOTION][3 * block];
    for (int l = 0; l < BLOCK; l++) {
        v3 motion = V3(0, 0, 0);
        if (frame->seen_before && known >> l & 1 && g->material[l] != NO_SURFACE) {
            v3 to = camera_project(past, V3(then->px[l], then->py[l], then->pz[l]));
            v3 from = camera_project(now, V3(g->px[l], g->py[l], g->pz[l]));
            if (to.z > 0)
                motion = V3(to.x - from.x, to.y - from.y, to.z);
        }
        kept[0][l] = motion.x;
        kept[1][l] = motion.y;
        kept[2][l] = motion.z;
    }
}

/* Blank where there is no surface to light. */
static void keep_blanks(noc_views *v, size_t block, const gblock *g) {
    for (int aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(v->asked & OF_LIT & 1u << aov))
            continue;
        for (int l = 0; l < BLOCK; l++)
            if (g->material[l] == NO_SURFACE || g->light[l] != NO_LIGHT)
                v->kept[aov][block][l] = -1;
    }
}

struct keep_run {
    noc_views *v;
    const noc_frame_blocks *b;
    const noc_frame *frame;
    uint32_t fresh; /* views whose sums begin with this frame */
};

static void keep_row(void *arg, size_t row, int index) {
    const struct keep_run *run = arg;
    const noc_frame_blocks *b = run->b;
    noc_views *v = run->v;
    (void)index;
    size_t first = row * (size_t)b->blocks_x;
    for (size_t i = first; i < first + (size_t)b->blocks_x; i++) {
        if (v->asked & RESERVOIRS)
            keep_reservoirs(v, i, &b->r[i]);
        if (v->asked & SURFACES)
            keep_surfaces(b->scene, v, i, &b->g[i]);
        if (v->asked & BIT(MOTION))
            keep_motion(v, b, run->frame, i);
        if (v->asked & MOMENTS)
            add_moments(v, i, &b->colour[i]);
        if (v->asked & SUMS)
            noc_views_keep_sources(v, i, run->fresh);
        if (v->asked & OF_LIT)
            keep_blanks(v, i, &b->g[i]);
    }
}

void noc_views_keep(noc_views *v, const noc_frame_blocks *b, const noc_frame *frame) {
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
    noc_pool_run(b->pool, (size_t)b->blocks_y, keep_row,
                 &(struct keep_run){ v, b, frame, frame->accumulated ? ~v->held : ~0u });
    v->held = v->asked;
    v->frames += (v->asked & MOMENTS) != 0;
}

/* ---- reading ---- */

/* Variance of a frame, or the standard error of the mean; -1: not known. */
static double moments_view(const noc_views *v, const noc_frame_blocks *b, noc_aov aov, size_t at, int l) {
    double n = (double)v->frames, mean = v->kept[NOC_AOV_ERROR][at][l];
    double variance = v->kept[NOC_AOV_VARIANCE][at][l] / (n - 1);
    if (n < 2 || b->emitter[at] >> l & 1 || b->g[at].material[l] == NO_SURFACE || (aov == NOC_AOV_ERROR && !(mean > 0)))
        return -1;
    return aov == NOC_AOV_ERROR ? sqrt(variance / n) / mean : variance;
}

static double number_of(const noc_views *v, const noc_frame_blocks *b, noc_aov aov, size_t at, int l) {
    if (aov == NOC_AOV_LUMINANCE)
        return luminance_of(&b->picture[at], l);
    if (MEANS >> aov & 1)
        return noc_views_mean(v, aov, at, l);
    if ((BIT(GROUP) | BIT(PLACED) | EMITTERS) >> aov & 1)
        return noc_views_source(v, aov, at, l);
    return MOMENTS >> aov & 1 ? moments_view(v, b, aov, at, l) : v->kept[aov][at][l];
}

bool noc_views_read(const noc_views *v, const noc_frame_blocks *b, noc_aov aov, float *value) {
    if (!(v->held >> aov & 1))
        return false;
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
            float out = (float)number_of(v, b, aov, at, l);
            value[to] = isfinite(out) ? out : -1;
        }
    return true;
}
