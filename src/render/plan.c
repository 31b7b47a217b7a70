#include "render/plan.h"

#define B(buffer) (1u << NOC_BUFFER_##buffer)

const noc_buffer_row noc_buffers[NOC_BUFFER_COUNT] = {
    [NOC_BUFFER_SURFACES] = { "surfaces", NOC_DOMAIN_PIXEL, NOC_LIVES_ON, 40 },
    [NOC_BUFFER_PREVIOUS] = { "previous surfaces", NOC_DOMAIN_PIXEL, NOC_LIVES_FRAME, 40 },
    [NOC_BUFFER_LIST] = { "light list", NOC_DOMAIN_TILE, NOC_LIVES_TILE, 0 },
    [NOC_BUFFER_SHARED_RAYS] = { "shared rays", NOC_DOMAIN_TILE, NOC_LIVES_TILE, 0 },
    [NOC_BUFFER_RESERVOIRS] = { "reservoirs", NOC_DOMAIN_PIXEL, NOC_LIVES_ON, 24 },
    [NOC_BUFFER_SOURCE] = { "source reservoirs", NOC_DOMAIN_PIXEL, NOC_LIVES_FRAME, 24 },
    [NOC_BUFFER_CACHE] = { "visibility cache", NOC_DOMAIN_VIEW, NOC_LIVES_ON, 0 },
    [NOC_BUFFER_OBSERVATIONS] = { "observations", NOC_DOMAIN_TILE, NOC_LIVES_FRAME, 0 },
    [NOC_BUFFER_COLOUR] = { "colour", NOC_DOMAIN_PIXEL, NOC_LIVES_FRAME, 12 },
    [NOC_BUFFER_PICTURE] = { "picture", NOC_DOMAIN_PIXEL, NOC_LIVES_ON, 12 },
};

#define CANDIDATES(name, list)                                                                                         \
    { "candidates, " name, NOC_DOMAIN_PIXEL, B(SURFACES) | list, B(RESERVOIRS) }

const noc_pass_row noc_passes[NOC_PASS_COUNT] = {
    [NOC_PASS_PRIMARY] = { "primary", NOC_DOMAIN_PIXEL, 0, B(SURFACES), 0, NOC_RAYS_CLOSEST },
    [NOC_PASS_FIND_LIGHTS] = { "find lights", NOC_DOMAIN_TILE, B(SURFACES), B(LIST) },
    [NOC_PASS_BUILD_LIST] = { "build list", NOC_DOMAIN_TILE, B(SURFACES), B(LIST) },
    [NOC_PASS_CANDIDATES_UNIFORM] = CANDIDATES("uniform", 0),
    [NOC_PASS_CANDIDATES_LIST] = CANDIDATES("list", B(LIST)),
    [NOC_PASS_CANDIDATES_POWER] = CANDIDATES("power", 0),
    [NOC_PASS_CANDIDATES_INFLUENCE] = CANDIDATES("influence", B(LIST)),
    [NOC_PASS_CANDIDATES_LIGHT_BVH] = CANDIDATES("light-bvh", 0),
    [NOC_PASS_SEEN_BEFORE] = { "seen before", NOC_DOMAIN_TILE, B(SURFACES) | B(PREVIOUS) | B(SOURCE), B(SHARED_RAYS),
                               B(PREVIOUS) | B(SOURCE) },
    [NOC_PASS_SHARE_RAYS] = { "share rays", NOC_DOMAIN_TILE, B(SURFACES) | B(LIST) | B(CACHE), B(SHARED_RAYS) },
    [NOC_PASS_VISIBILITY] = { "visibility", NOC_DOMAIN_PIXEL, B(SURFACES) | B(RESERVOIRS), B(RESERVOIRS), 0,
                              NOC_RAYS_OCCLUSION },
    [NOC_PASS_TRACE_SHARED] = { "trace shared", NOC_DOMAIN_TILE, B(SHARED_RAYS),
                                B(SHARED_RAYS) | B(RESERVOIRS) | B(OBSERVATIONS), 0, NOC_RAYS_OCCLUSION },
    [NOC_PASS_RESAMPLE] = { "resample", NOC_DOMAIN_PIXEL, B(SHARED_RAYS), B(RESERVOIRS) },
    [NOC_PASS_TEMPORAL] = { "temporal", NOC_DOMAIN_PIXEL, B(SURFACES) | B(PREVIOUS) | B(SOURCE) | B(RESERVOIRS),
                            B(RESERVOIRS), B(PREVIOUS) | B(SOURCE), NOC_RAYS_OCCLUSION },
    [NOC_PASS_SPATIAL] = { "spatial", NOC_DOMAIN_PIXEL, B(SURFACES) | B(SOURCE), B(RESERVOIRS), B(SURFACES) | B(SOURCE),
                           NOC_RAYS_OCCLUSION },
    [NOC_PASS_EMITTERS] = { "emitters", NOC_DOMAIN_PIXEL, B(SURFACES), B(COLOUR) },
    [NOC_PASS_SHADE_SHARED] = { "shade shared", NOC_DOMAIN_TILE,
                                B(SURFACES) | B(SHARED_RAYS) | B(RESERVOIRS) | B(COLOUR), B(COLOUR) },
    [NOC_PASS_SHADE] = { "shade", NOC_DOMAIN_PIXEL, B(SURFACES) | B(RESERVOIRS) | B(COLOUR), B(COLOUR), 0,
                         NOC_RAYS_OCCLUSION },
    [NOC_PASS_SHADE_ALL] = { "shade all lights", NOC_DOMAIN_PIXEL, B(SURFACES) | B(COLOUR), B(COLOUR), 0,
                             NOC_RAYS_OCCLUSION },
    [NOC_PASS_HEADLIGHT] = { "headlight", NOC_DOMAIN_PIXEL, B(SURFACES) | B(COLOUR), B(COLOUR) },
    [NOC_PASS_SKY] = { "sky", NOC_DOMAIN_PIXEL, B(SURFACES) | B(COLOUR), B(COLOUR), 0, NOC_RAYS_OCCLUSION },
};

const char *noc_pass_name(noc_pass pass) { return (unsigned)pass < NOC_PASS_COUNT ? noc_passes[pass].name : "unknown"; }

bool noc_pass_without_lights(noc_pass pass) {
    return pass == NOC_PASS_PRIMARY || pass == NOC_PASS_EMITTERS || pass == NOC_PASS_SKY || pass == NOC_PASS_HEADLIGHT;
}

bool noc_stage_has(const noc_stage *stage, noc_pass pass) {
    for (int i = 0; i < stage->count; i++)
        if (stage->passes[i] == pass)
            return true;
    return false;
}

/* ---- making a plan ---- */

typedef struct maker {
    noc_plan *plan;
    noc_stage next;   /* sets and round of the passes to come */
    uint32_t written; /* in this frame, by passes of the stage at hand; sets of reservoirs as bits from SETS on */
} maker;

enum { SETS = NOC_BUFFER_COUNT };

/* Buffers by their role, as buffers by themselves: two roles may be one set. */
static uint32_t actual(const noc_stage *stage, uint32_t bits) {
    uint32_t out = bits & ~(B(RESERVOIRS) | B(SOURCE));
    if (bits & B(RESERVOIRS))
        out |= 1u << (SETS + stage->target);
    if (bits & B(SOURCE))
        out |= 1u << (SETS + stage->source);
    return out;
}

/* Appends a pass; a stage ends before one that looks at what other tiles have written in it. */
static void add(maker *m, noc_pass pass) {
    noc_plan *plan = m->plan;
    const noc_pass_row *row = &noc_passes[pass];
    if (!plan->count || actual(&m->next, row->others) & m->written) {
        plan->stages[plan->count++] = m->next;
        m->written = 0;
    }
    noc_stage *stage = &plan->stages[plan->count - 1];
    stage->passes[stage->count++] = pass;
    m->written |= actual(&m->next, row->writes);
}

static bool reuses_visibility(const noc_render_params *p) {
    return (p->method == NOC_METHOD_RESTIR || p->method == NOC_METHOD_RIS) && p->visibility_reuse && p->final_ray;
}

bool noc_uses_bias_rays(const noc_render_params *p) {
    return p->method == NOC_METHOD_RESTIR && p->bias != NOC_BIAS_BIASED && p->bias_rays && reuses_visibility(p);
}

/* May the last spatial output feed the next frame? */
static bool feeds_spatial(const noc_render_params *p) {
    return p->bias == NOC_BIAS_PAIRWISE && (noc_uses_bias_rays(p) || !(p->visibility_reuse && p->final_ray));
}

static void add_candidates(maker *m, const noc_render_params *p) {
    static const noc_pass draw[] = {
        [NOC_CANDIDATES_UNIFORM] = NOC_PASS_CANDIDATES_UNIFORM,
        [NOC_CANDIDATES_LISTS] = NOC_PASS_CANDIDATES_LIST,
        [NOC_CANDIDATES_POWER] = NOC_PASS_CANDIDATES_POWER,
        [NOC_CANDIDATES_INFLUENCE] = NOC_PASS_CANDIDATES_INFLUENCE,
        [NOC_CANDIDATES_LIGHT_BVH] = NOC_PASS_CANDIDATES_LIGHT_BVH,
    };
    _Static_assert(NOC_COUNT(draw) == NOC_CANDIDATES_COUNT, "every picker has its pass");
    if (m->plan->candidates == NOC_CANDIDATES_LISTS)
        add(m, NOC_PASS_BUILD_LIST);
    if (m->plan->candidates == NOC_CANDIDATES_INFLUENCE)
        add(m, NOC_PASS_FIND_LIGHTS);
    if (!m->plan->shares_rays) {
        add(m, draw[m->plan->candidates]);
        if (reuses_visibility(p))
            add(m, NOC_PASS_VISIBILITY);
        return;
    }
    if (m->plan->mixes && p->temporal)
        add(m, NOC_PASS_SEEN_BEFORE);
    add(m, NOC_PASS_SHARE_RAYS);
    add(m, NOC_PASS_TRACE_SHARED);
    if (p->method == NOC_METHOD_RESTIR)
        add(m, NOC_PASS_RESAMPLE);
}

static void add_shading(maker *m, const noc_render_params *p, bool sky, bool reused) {
    noc_plan *plan = m->plan;
    add(m, NOC_PASS_EMITTERS);
    if (p->method == NOC_METHOD_HEADLIGHT) {
        add(m, NOC_PASS_HEADLIGHT);
        return;
    }
    if (p->method == NOC_METHOD_REFERENCE)
        add(m, NOC_PASS_SHADE_ALL);
    if (plan->shares_rays && !reused)
        add(m, NOC_PASS_SHADE_SHARED);
    if (plan->draws && (!plan->shares_rays || p->method == NOC_METHOD_RESTIR))
        add(m, NOC_PASS_SHADE);
    if (sky)
        add(m, NOC_PASS_SKY);
}

/* Reservoir sets: `history` is read by the temporal pass only, so it is free to take the first spatial pass's output.
 *
 * What feeds the next frame: the last spatial output where the combination is pairwise and unbiased (measured on the
 * built-in city, 240 x 136: relMSE after 32 frames .24 against .42 with the temporal output, .33 against .57 for frame
 * 32 alone, at the same cost), else the temporal output: biased spatial output fed back compounds its bias, and that of
 * the balance rule, which picks a sample before it weighs it, compounds its outliers (frame 32 alone: .93 against .66).
 * So do counted weights (frame 16 alone: 2.25 against .88), whose paper keeps the temporal output, too.
 */
void noc_plan_make(const noc_render_params *p, bool map, int history_set, bool surfaces, noc_plan *plan) {
    bool restir = p->method == NOC_METHOD_RESTIR, one = p->method == NOC_METHOD_IS;
    int rounds = restir && p->spatial && p->neighbours > 0 ? p->passes : 0;
    bool temporal = restir && p->temporal, feed = temporal && rounds && feeds_spatial(p);
    int history = temporal && history_set > 0 ? history_set : 0, fresh = temporal ? (history + 1) % 2 : 0;
    bool lists = p->candidates == NOC_CANDIDATES_LISTS && (p->method == NOC_METHOD_RIS || restir);
    *plan = (noc_plan){ .next_history = temporal ? fresh : -1,
                        .sets = NOC_MAX(rounds > 1           ? 3
                                        : temporal || rounds ? 2
                                                             : 1,
                                        history + 1),
                        .draws = p->method != NOC_METHOD_REFERENCE && p->method != NOC_METHOD_HEADLIGHT,
                        .candidates = one ? NOC_CANDIDATES_UNIFORM : p->candidates,
                        .candidate_count = one ? 1 : p->draws,
                        .shares_rays = lists && (!restir || reuses_visibility(p)),
                        .previous_lights = temporal && p->bias != NOC_BIAS_BIASED };
    plan->learns = plan->shares_rays && p->learn && p->final_ray;
    plan->mixes = plan->shares_rays && restir && !rounds;
    bool resolve = noc_uses_bias_rays(p);
    maker m = { .plan = plan, .next = { .source = history, .target = fresh, .resolve_visibility = resolve } };
    if (!surfaces)
        add(&m, NOC_PASS_PRIMARY);
    if (plan->draws)
        add_candidates(&m, p);
    if (temporal)
        add(&m, NOC_PASS_TEMPORAL);
    int from = fresh, to = 1 - fresh;
    for (int i = 0; i < rounds; i++) {
        m.next = (noc_stage){
            .source = from, .target = to, .round = i, .resolve_visibility = resolve && (i < rounds - 1 || feed)
        };
        add(&m, NOC_PASS_SPATIAL);
        int next = from == fresh ? 2 : from; /* the temporal output is kept: it may be the next history */
        from = to;
        to = next;
    }
    add_shading(&m, p, p->sky > 0 || map, rounds > 0);
    if (feed)
        plan->next_history = from;
}
