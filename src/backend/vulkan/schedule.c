/* From the passes of a stage to dispatches: see schedule.h. */
#include "backend/vulkan/schedule.h"

#include "core/random.h"

#define R(resource) (1u << VK_RESOURCE_##resource)

typedef struct scheduling {
    const noc_plan *plan;
    const noc_stage *stage;
    const vk_facts *facts;
    vk_steps *steps;
    bool no_memory;
    vk_step lost; /* stands in where memory is refused */
    noc_pass pass;
} scheduling;

static uint32_t set_bit(int set) { return R(SET) << set; }

/* Shaders that gather for views. */
static bool gathers(vk_shader shader) {
    static const bool yes[VK_SHADER_COUNT] = {
#define YES(name) [VK_SHADER_##name] = true
        YES(primary_use),   YES(place),       YES(candidates_shared), YES(candidates_tree), YES(resolve_ask),
        YES(temporal_ask),  YES(spatial_ask), YES(emitters),          YES(shade_use),       YES(reference_ask),
        YES(reference_use), YES(sky_ask),     YES(sky_use),
#undef YES
    };
    return yes[shader];
}

static vk_step *add(scheduling *s, vk_shader shader, uint32_t reads, uint32_t writes) {
    if (s->facts->views && gathers(shader)) {
        reads |= R(VIEWS);
        writes |= R(VIEWS);
    }
    vk_step step = { .shader = shader,
                     .reads = reads,
                     .writes = writes,
                     .slots = 1,
                     .source = s->stage ? s->stage->source : 0,
                     .target = s->stage ? s->stage->target : 0,
                     .pass = s->pass };
    if (array_push(s->steps, step))
        return &s->steps->data[s->steps->len - 1];
    s->no_memory = true;
    return &s->lost;
}

/* Answers `slots` rays a pixel that the step before has written. */
static void trace(scheduling *s, int slots, bool past) {
    vk_step *step = add(s, VK_SHADER_trace_occlusion, R(RAYS) | R(ANSWERS), R(ANSWERS));
    step->domain = VK_DOMAIN_RAYS;
    step->slots = slots;
    step->past = past;
}

static void primary(scheduling *s) {
    if (s->facts->given) {
        add(s, VK_SHADER_place, 0, R(SURFACES));
        return;
    }
    add(s, VK_SHADER_primary_ask, 0, R(RAYS) | R(ANSWERS));
    add(s, VK_SHADER_trace_closest, R(RAYS) | R(ANSWERS), R(HITS))->domain = VK_DOMAIN_RAYS;
    add(s, VK_SHADER_primary_use, R(HITS) | R(RAYS), R(SURFACES));
}

/* Candidates that blocks share are drawn once a frame, before the pass that chooses among them. */
static void candidates_shared(scheduling *s) {
    bool by_power = s->pass == NOC_PASS_CANDIDATES_POWER;
    add(s, by_power ? VK_SHADER_presample_power : VK_SHADER_presample_uniform, 0, R(SAMPLES))->domain =
        VK_DOMAIN_SUBSETS;
    add(s, VK_SHADER_candidates_shared, R(SURFACES) | R(SAMPLES), set_bit(s->stage->target));
}

static void candidates_tree(scheduling *s) {
    add(s, VK_SHADER_candidates_tree, R(SURFACES), set_bit(s->stage->target));
}

/* Asks of the target's samples whose visibility is not known. */
static void ask_samples(scheduling *s) {
    add(s, VK_SHADER_resolve_ask, R(SURFACES) | set_bit(s->stage->target), R(RAYS) | R(ANSWERS));
    trace(s, 1, false);
}

static void resolve(scheduling *s) {
    uint32_t target = set_bit(s->stage->target);
    ask_samples(s);
    add(s, VK_SHADER_resolve_use, R(ANSWERS) | target, target);
}

/* A pixel's combination with `neighbours` others; reads: what it looks at. */
static void combine(scheduling *s, vk_shader ask, vk_shader use, uint32_t reads, uint32_t dimension, int neighbours,
                    bool past) {
    const frame_constants *c = s->facts->constants;
    bool rays = c->flags & FRAME_BIAS_RAYS;
    if (rays) {
        vk_step *step = add(s, ask, reads, R(RAYS) | R(ANSWERS));
        step->dimension = dimension;
        step->slots = c->bias == BIAS_PAIRWISE ? 1 : neighbours;
        trace(s, step->slots, past);
    }
    add(s, use, reads | (rays ? R(ANSWERS) : 0), set_bit(s->stage->target))->dimension = dimension;
    if (s->stage->resolve_visibility)
        resolve(s);
}

static void temporal(scheduling *s) {
    uint32_t reads = R(SURFACES) | R(PREVIOUS) | set_bit(s->stage->source) | set_bit(s->stage->target);
    if (s->facts->history)
        combine(s, VK_SHADER_temporal_ask, VK_SHADER_temporal_use, reads, DIM_TEMPORAL, 1, s->facts->past);
}

static void spatial(scheduling *s) {
    combine(s, VK_SHADER_spatial_ask, VK_SHADER_spatial_use, R(SURFACES) | set_bit(s->stage->source),
            DIM_SPATIAL + 64u * (uint32_t)s->stage->round, (int)s->facts->constants->neighbours, false);
}

static void emitters(scheduling *s) { add(s, VK_SHADER_emitters, R(SURFACES), R(COLOUR)); }

static void shade(scheduling *s) {
    bool rays = s->facts->constants->flags & FRAME_FINAL_RAY;
    if (rays)
        ask_samples(s);
    add(s, VK_SHADER_shade_use, R(SURFACES) | R(COLOUR) | set_bit(s->stage->target) | (rays ? R(ANSWERS) : 0),
        R(COLOUR));
}

/* Words of scratch a pixel: luminances of chunks, the number of entries, entries of two words. */
static size_t reference_words(const vk_facts *f) {
    return (f->lights + REFERENCE_CHUNK - 1) / REFERENCE_CHUNK + 1 + 2 * (size_t)f->constants->rays;
}

/* Rows of blocks that are done at once, so that scratch stays bounded. */
static uint32_t band_rows(const vk_facts *f, size_t words) {
    enum { SCRATCH_BYTES = 64 << 20 };
    size_t row = (size_t)f->blocks_x * BLOCK * words * 4;
    return (uint32_t)NOC_CLAMP(SCRATCH_BYTES / row, (size_t)1, (size_t)f->blocks_y);
}

static void reference_rays(scheduling *s, uint32_t first, uint32_t first_row, uint32_t rows) {
    bool rays = s->facts->constants->flags & FRAME_FINAL_RAY;
    size_t from = s->steps->len;
    if (rays) {
        vk_step *ask = add(s, VK_SHADER_reference_ask, R(SURFACES) | R(SCRATCH), R(RAYS) | R(ANSWERS));
        ask->slots = VK_REFERENCE_RAYS;
        trace(s, VK_REFERENCE_RAYS, false);
    }
    add(s, VK_SHADER_reference_use, R(SURFACES) | R(SCRATCH) | R(COLOUR) | (rays ? R(ANSWERS) : 0), R(COLOUR));
    for (size_t i = from; i < s->steps->len; i++) {
        s->steps->data[i].first = first;
        s->steps->data[i].first_row = first_row;
        s->steps->data[i].rows = rows;
    }
}

static void shade_all(scheduling *s) {
    const vk_facts *f = s->facts;
    uint32_t chunks = (f->lights + REFERENCE_CHUNK - 1) / REFERENCE_CHUNK, rays = f->constants->rays;
    uint32_t band = band_rows(f, reference_words(f));
    for (uint32_t row = 0; row < f->blocks_y; row += band) {
        uint32_t rows = NOC_MIN(band, f->blocks_y - row);
        for (uint32_t i = 0; f->lights > rays && i < chunks; i += VK_REFERENCE_CHUNKS) {
            vk_step *sum = add(s, VK_SHADER_reference_sums, R(SURFACES), R(SCRATCH));
            sum->first = i;
            sum->first_row = row;
            sum->rows = rows;
        }
        vk_step *entries = add(s, VK_SHADER_reference_entries, R(SURFACES) | R(SCRATCH), R(SCRATCH));
        entries->first_row = row;
        entries->rows = rows;
        for (uint32_t i = 0; i < NOC_MIN(rays, f->lights); i += VK_REFERENCE_RAYS)
            reference_rays(s, i, row, rows);
    }
}

static void headlight(scheduling *s) { add(s, VK_SHADER_headlight, R(SURFACES) | R(COLOUR), R(COLOUR)); }

/* Its rays go one after the other, so that they need no more room than others. */
static void sky(scheduling *s) {
    for (uint32_t i = 0; i < (s->facts->sky ? SKY_RAYS : 1); i++) {
        add(s, VK_SHADER_sky_ask, R(SURFACES) | R(COLOUR) | R(ANSWERS), R(COLOUR) | R(RAYS) | R(ANSWERS))->first = i;
        if (!s->facts->sky)
            return;
        trace(s, 1, false);
        add(s, VK_SHADER_sky_use, R(SURFACES) | R(COLOUR) | R(RAYS) | R(ANSWERS), R(COLOUR));
    }
}

bool noc_vk_schedule(const noc_plan *plan, const noc_stage *stage, const vk_facts *facts, vk_steps *steps) {
    static void (*const passes[NOC_PASS_COUNT])(scheduling *) = {
        [NOC_PASS_PRIMARY] = primary,
        [NOC_PASS_CANDIDATES_UNIFORM] = candidates_shared,
        [NOC_PASS_CANDIDATES_POWER] = candidates_shared,
        [NOC_PASS_CANDIDATES_LIGHT_BVH] = candidates_tree,
        [NOC_PASS_VISIBILITY] = resolve,
        [NOC_PASS_TEMPORAL] = temporal,
        [NOC_PASS_SPATIAL] = spatial,
        [NOC_PASS_EMITTERS] = emitters,
        [NOC_PASS_SHADE] = shade,
        [NOC_PASS_SHADE_ALL] = shade_all,
        [NOC_PASS_HEADLIGHT] = headlight,
        [NOC_PASS_SKY] = sky,
    };
    scheduling s = { .plan = plan, .stage = stage, .facts = facts, .steps = steps };
    for (int i = 0; i < stage->count; i++) {
        s.pass = stage->passes[i];
        bool without_lights = s.pass == NOC_PASS_PRIMARY || s.pass == NOC_PASS_EMITTERS || s.pass == NOC_PASS_SKY ||
                              s.pass == NOC_PASS_HEADLIGHT;
        if (passes[s.pass] && (facts->lights || without_lights))
            passes[s.pass](&s);
    }
    return !s.no_memory;
}

bool noc_vk_schedule_mean(const vk_facts *facts, vk_steps *steps) {
    scheduling s = { .facts = facts, .steps = steps, .pass = NOC_PASS_COUNT };
    add(&s, VK_SHADER_mean, R(COLOUR) | R(SURFACES) | R(PICTURE) | R(COVERAGE), R(PICTURE) | R(COVERAGE));
    return !s.no_memory;
}

int noc_vk_slots(const vk_steps *steps) {
    int most = 1;
    for (size_t i = 0; i < steps->len; i++)
        most = NOC_MAX(most, steps->data[i].slots);
    return most;
}

size_t noc_vk_scratch_bytes(const noc_plan *plan, const vk_facts *f) {
    size_t words = reference_words(f);
    for (int i = 0; i < plan->count; i++)
        if (noc_stage_has(&plan->stages[i], NOC_PASS_SHADE_ALL))
            return (size_t)band_rows(f, words) * f->blocks_x * BLOCK * words * 4;
    return 0;
}

void noc_vk_find_wait(vk_hazards *h, vk_step *step) {
    step->wait = ((step->reads | step->writes) & h->written) || (step->writes & h->read);
    if (step->wait)
        *h = (vk_hazards){ 0 };
    h->read |= step->reads;
    h->written |= step->writes;
}
