/* From the passes of a stage to dispatches: see schedule.h. */
#include "backend/vulkan/schedule.h"

#include "backend/vulkan/influence_memory.h"
#include "backend/vulkan/list_memory.h"
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
    uint32_t first_row, rows; /* of the steps that are added, as in vk_step */
    bool band;
} scheduling;

static uint32_t set_bit(int set) { return R(SET) << set; }

/* Shaders that gather for views. */
static bool gathers(vk_shader shader) {
    static const bool yes[VK_SHADER_COUNT] = {
#define YES(name) [VK_SHADER_##name] = true
        YES(primary_use),     YES(place),         YES(candidates_shared),
        YES(candidates_tree), YES(resolve_ask),   YES(temporal_ask),
        YES(spatial_ask),     YES(emitters),      YES(shade_use),
        YES(reference_ask),   YES(reference_use), YES(sky_ask),
        YES(sky_use),         YES(list_ask),      YES(list_note),
        YES(list_share),      YES(list_sources),  YES(influence_candidates),
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
                     .first_row = s->first_row,
                     .rows = s->rows,
                     .band = s->band,
                     .pass = s->pass };
    if (array_push(s->steps, step))
        return &s->steps->data[s->steps->len - 1];
    s->no_memory = true;
    return &s->lost;
}

/* Answers `slots` rays a pixel that the step before has written. */
static vk_step *trace(scheduling *s, int slots, bool past) {
    vk_step *step = add(s, VK_SHADER_trace_occlusion, R(RAYS) | R(ANSWERS), R(ANSWERS));
    step->domain = VK_DOMAIN_RAYS;
    step->slots = slots;
    step->past = past;
    return step;
}

/* Finds what surfaces let through on the way of rays that the step before has answered. */
static void pass_panes(scheduling *s, int slots) {
    if (!s->facts->panes)
        return;
    vk_step *step = add(s, VK_SHADER_trace_through, R(RAYS) | R(ANSWERS), R(THROUGH));
    step->domain = VK_DOMAIN_RAYS;
    step->slots = slots;
}

/* What shading reads of its rays. */
static uint32_t answers(const scheduling *s) { return R(ANSWERS) | (s->facts->panes ? R(THROUGH) : 0); }

static void primary(scheduling *s) {
    vk_shader shader = s->facts->panes ? VK_SHADER_trace_meeting : VK_SHADER_trace_closest;
    if (s->facts->given) {
        add(s, VK_SHADER_place, 0, R(SURFACES));
        return;
    }
    add(s, VK_SHADER_primary_ask, 0, R(RAYS) | R(ANSWERS));
    add(s, shader, R(RAYS) | R(ANSWERS), R(HITS))->domain = VK_DOMAIN_RAYS;
    add(s, VK_SHADER_primary_use, R(HITS) | R(RAYS), R(SURFACES));
}

/* Candidates that blocks share are drawn once a frame, before the pass that chooses among them. */
static void presample(scheduling *s, noc_pass pass) {
    bool by_power = pass == NOC_PASS_CANDIDATES_POWER;
    s->pass = pass;
    add(s, by_power ? VK_SHADER_presample_power : VK_SHADER_presample_uniform, 0, R(SAMPLES))->domain =
        VK_DOMAIN_SUBSETS;
}

static void candidates_shared(scheduling *s) {
    presample(s, s->pass);
    add(s, VK_SHADER_candidates_shared, R(SURFACES) | R(SAMPLES), set_bit(s->stage->target));
}

static void candidates_tree(scheduling *s) {
    add(s, VK_SHADER_candidates_tree, R(SURFACES), set_bit(s->stage->target));
}

/* Asks of the target's samples: of all, or of those whose visibility is not known. */
static void ask_samples(scheduling *s, bool all) {
    add(s, VK_SHADER_resolve_ask, R(SURFACES) | set_bit(s->stage->target), R(RAYS) | R(ANSWERS))->first = all;
    trace(s, 1, false);
}

static void resolve(scheduling *s) {
    uint32_t target = set_bit(s->stage->target);
    ask_samples(s, false);
    add(s, VK_SHADER_resolve_use, R(ANSWERS) | target, target);
}

/* Rows of blocks whose rays, so many a pixel, have room at once: one ray of each pixel has, in any case. */
static uint32_t ray_rows(const vk_facts *f, int slots) {
    enum { RAY_BYTES = sizeof(rayblock) / BLOCK + 4 + 4 }; /* with its answer and its transmittance */
    size_t row = (size_t)f->blocks_x * BLOCK * (size_t)slots, pixels = (size_t)f->blocks_x * f->blocks_y * BLOCK;
    return (uint32_t)NOC_CLAMP(NOC_MAX(pixels, f->band_bytes / RAY_BYTES) / row, (size_t)1, (size_t)f->blocks_y);
}

/* A pixel's combination with others. */
typedef struct combining {
    vk_shader ask, use;
    uint32_t reads, dimension;
    int rays; /* a pixel; 0: none */
    bool past;
} combining;

static void combine_band(scheduling *s, const combining *c) {
    if (c->rays) {
        vk_step *step = add(s, c->ask, c->reads, R(RAYS) | R(ANSWERS));
        step->dimension = c->dimension;
        trace(s, c->rays, c->past);
    }
    add(s, c->use, c->reads | (c->rays ? R(ANSWERS) : 0), set_bit(s->stage->target))->dimension = c->dimension;
}

/* neighbours: that a pixel has. */
static void combine(scheduling *s, combining c, int neighbours) {
    const frame_constants *frame = s->facts->constants;
    if (frame->flags & FRAME_BIAS_RAYS)
        c.rays = frame->bias == BIAS_PAIRWISE ? 1 : neighbours;
    scheduling all = *s; /* the picture, or a band of it in turn */
    uint32_t end = all.first_row + (all.rows ? all.rows : s->facts->blocks_y);
    uint32_t band = c.rays ? ray_rows(s->facts, c.rays) : end;
    s->band = true;
    for (s->first_row = all.first_row; s->first_row < end; s->first_row += band) {
        s->rows = NOC_MIN(band, end - s->first_row);
        combine_band(s, &c);
    }
    s->first_row = all.first_row;
    s->rows = all.rows;
    s->band = all.band;
    if (s->stage->resolve_visibility)
        resolve(s);
}

static void temporal(scheduling *s) {
    uint32_t reads = R(SURFACES) | R(PREVIOUS) | set_bit(s->stage->source) | set_bit(s->stage->target);
    combining c = { VK_SHADER_temporal_ask, VK_SHADER_temporal_use, reads, DIM_TEMPORAL, 0, s->facts->past };
    if (s->facts->history)
        combine(s, c, 1);
}

static void spatial(scheduling *s) {
    uint32_t reads = R(SURFACES) | set_bit(s->stage->source), dimension = DIM_SPATIAL + 64u * (uint32_t)s->stage->round;
    combining c = { VK_SHADER_spatial_ask, VK_SHADER_spatial_use, reads, dimension, 0, false };
    combine(s, c, (int)s->facts->constants->neighbours);
}

static void emitters(scheduling *s) { add(s, VK_SHADER_emitters, R(SURFACES), R(COLOUR)); }

static void shade(scheduling *s) {
    bool rays = s->facts->constants->flags & FRAME_FINAL_RAY;
    if (rays) {
        ask_samples(s, s->facts->panes); /* how much arrives is not known of any */
        pass_panes(s, 1);
    }
    add(s, VK_SHADER_shade_use, R(SURFACES) | R(COLOUR) | set_bit(s->stage->target) | (rays ? answers(s) : 0),
        R(COLOUR));
}

/* Words of scratch a pixel: luminances of chunks, the number of entries, entries of two words. */
static size_t reference_words(const vk_facts *f) {
    return (f->lights + REFERENCE_CHUNK - 1) / REFERENCE_CHUNK + 1 + 2 * (size_t)f->constants->rays;
}

/* Rows of blocks that are done at once, so that scratch and rays stay bounded. */
static uint32_t band_rows(const vk_facts *f, size_t words) {
    enum { SCRATCH_BYTES = 64 << 20 };
    size_t row = (size_t)f->blocks_x * BLOCK * words * 4, rows = NOC_MIN((size_t)SCRATCH_BYTES, f->band_bytes) / row;
    return (uint32_t)NOC_CLAMP(rows, (size_t)1, (size_t)ray_rows(f, VK_REFERENCE_RAYS));
}

static void reference_rays(scheduling *s, uint32_t first) {
    bool rays = s->facts->constants->flags & FRAME_FINAL_RAY;
    size_t from = s->steps->len;
    if (rays) {
        add(s, VK_SHADER_reference_ask, R(SURFACES) | R(SCRATCH), R(RAYS) | R(ANSWERS));
        trace(s, VK_REFERENCE_RAYS, false);
        pass_panes(s, VK_REFERENCE_RAYS);
    }
    add(s, VK_SHADER_reference_use, R(SURFACES) | R(SCRATCH) | R(COLOUR) | (rays ? answers(s) : 0), R(COLOUR));
    for (size_t i = from; i < s->steps->len; i++)
        s->steps->data[i].first = first;
}

static void shade_all(scheduling *s) {
    const vk_facts *f = s->facts;
    uint32_t chunks = (f->lights + REFERENCE_CHUNK - 1) / REFERENCE_CHUNK, rays = f->constants->rays;
    uint32_t band = band_rows(f, reference_words(f));
    s->band = true;
    for (s->first_row = 0; s->first_row < f->blocks_y; s->first_row += band) {
        s->rows = NOC_MIN(band, f->blocks_y - s->first_row);
        for (uint32_t i = 0; f->lights > rays && i < chunks; i += VK_REFERENCE_CHUNKS)
            add(s, VK_SHADER_reference_sums, R(SURFACES), R(SCRATCH))->first = i;
        add(s, VK_SHADER_reference_entries, R(SURFACES) | R(SCRATCH), R(SCRATCH));
        for (uint32_t i = 0; i < NOC_MIN(rays, f->lights); i += VK_REFERENCE_RAYS)
            reference_rays(s, i);
    }
    s->first_row = s->rows = 0;
    s->band = false;
}

static void headlight(scheduling *s) { add(s, VK_SHADER_headlight, R(SURFACES) | R(COLOUR), R(COLOUR)); }

/* Its rays go one after the other, so that they need no more room than others. */
static void sky(scheduling *s) {
    for (uint32_t i = 0; i < (s->facts->sky ? SKY_RAYS : 1); i++) {
        add(s, VK_SHADER_sky_ask, R(SURFACES) | R(COLOUR) | R(ANSWERS), R(COLOUR) | R(RAYS) | R(ANSWERS))->first = i;
        if (!s->facts->sky)
            return;
        trace(s, 1, false);
        pass_panes(s, 1);
        add(s, VK_SHADER_sky_use, R(SURFACES) | R(COLOUR) | R(RAYS) | answers(s), R(COLOUR));
    }
}

/* ---- lists: their passes go through the picture by bands of tiles ---- */

uint32_t noc_vk_tile_words(int levels) {
    uint32_t groups =
        2 * LIST_ROOTS / 16 + (uint32_t)NOC_MAX(levels - 1, 0) * OPENED_NODES + OPENED_CLUSTERS; /* not more than */
    return TILE_SCORES + NOC_MAX(16 * NOC_MIN(groups, (uint32_t)LIST_GROUPS), (uint32_t)TILE_LATER);
}

/* Rays a pixel at most (core/list_rays.h): twice what it asks for, which is more where SEEN_BEFORE may say so. */
static int list_slots(const noc_plan *plan, const vk_facts *f) {
    uint32_t rays = f->constants->shadow_rays;
    if (!plan->shares_rays)
        return 0;
    return (int)(2 * (plan->mixes ? NOC_MIN(2 * rays, 8u) : rays));
}

/* Words of scratch of a row of tiles. */
static size_t list_row_words(const noc_plan *plan, const vk_facts *f) {
    size_t pixel = PIXEL_RAYS + RAY_WORDS * (size_t)list_slots(plan, f);
    return (size_t)noc_vk_tiles(f->blocks_x) * f->tile_words + (size_t)f->blocks_x * 4 * BLOCK * pixel;
}

static uint32_t list_band(const noc_plan *plan, const vk_facts *f) {
    size_t rays = (size_t)f->blocks_x * 4 * BLOCK * (size_t)list_slots(plan, f);
    size_t row = 4 * list_row_words(plan, f) + rays * (sizeof(rayblock) / BLOCK + 4);
    return 4 * (uint32_t)NOC_CLAMP(f->band_bytes / row, (size_t)1, (size_t)noc_vk_tiles(f->blocks_y));
}

static vk_step *add_list(scheduling *s, vk_shader shader, vk_domain domain, uint32_t reads, uint32_t writes) {
    vk_step *step = add(s, shader, reads | R(SCRATCH), writes);
    step->domain = domain;
    step->band = true;
    return step;
}

static void build_list(scheduling *s) {
    add_list(s, VK_SHADER_list_strongest, VK_DOMAIN_TILES, R(SURFACES), R(SCRATCH));
    add_list(s, VK_SHADER_list_tail, VK_DOMAIN_TILES, 0, R(SCRATCH));
}

static void candidates_list(scheduling *s) {
    uint32_t target = set_bit(s->stage->target);
    add_list(s, VK_SHADER_list_candidates, VK_DOMAIN_PIXELS, R(SURFACES), target);
    if (s->facts->views)
        add_list(s, VK_SHADER_list_note, VK_DOMAIN_PIXELS, R(SURFACES) | target, 0);
}

static void seen_before(scheduling *s) {
    add_list(s, VK_SHADER_list_fresh, VK_DOMAIN_PIXELS, R(SURFACES) | R(PREVIOUS) | set_bit(s->stage->source),
             R(SCRATCH));
}

static void share_rays(scheduling *s) {
    bool learns = s->plan->learns;
    add_list(s, VK_SHADER_list_fill, VK_DOMAIN_TILES, R(SURFACES) | (learns ? R(CACHE) : 0),
             R(SCRATCH) | (learns ? R(OBSERVED) : 0));
    add_list(s, VK_SHADER_list_share, VK_DOMAIN_BLOCKS, R(SURFACES) | (learns ? R(CACHE) : 0),
             R(SCRATCH) | (learns ? R(BRIGHT) : 0));
    add_list(s, VK_SHADER_list_ask, VK_DOMAIN_LAYERS, R(SURFACES), R(SCRATCH) | R(RAYS) | R(ANSWERS))->slots =
        list_slots(s->plan, s->facts);
    if (s->facts->views)
        add_list(s, VK_SHADER_list_note, VK_DOMAIN_PIXELS, R(SURFACES), 0);
}

static void trace_shared(scheduling *s) {
    bool rays = s->facts->constants->flags & FRAME_FINAL_RAY;
    if (rays) {
        s->band = true;
        trace(s, list_slots(s->plan, s->facts), false);
        pass_panes(s, list_slots(s->plan, s->facts));
        s->band = false;
    }
    add_list(s, VK_SHADER_list_use, VK_DOMAIN_PIXELS, rays ? R(ANSWERS) : 0,
             R(SCRATCH) | set_bit(s->stage->target) | (s->plan->learns ? R(OBSERVED) : 0));
}

static void resample(scheduling *s) {
    uint32_t target = set_bit(s->stage->target);
    add_list(s, VK_SHADER_list_resample, VK_DOMAIN_PIXELS, target, target);
}

static void shade_shared(scheduling *s) {
    uint32_t reads = set_bit(s->stage->target) | (s->facts->panes ? R(THROUGH) : 0);
    if (s->facts->views)
        add_list(s, VK_SHADER_list_sources, VK_DOMAIN_PIXELS, reads | R(SURFACES), 0);
    add_list(s, VK_SHADER_list_shade, VK_DOMAIN_PIXELS, reads | R(COLOUR), R(COLOUR));
}

/* ---- influence: bands of tiles, too ---- */

/* Words of scratch of a row of tiles: what its tiles know, their share of the pool, samples, and sums of weights. */
static size_t found_row_words(const noc_plan *plan, const vk_facts *f) {
    size_t samples = (size_t)plan->candidate_count * (CUT_SIXTEENS * DRAW_WORDS + CUT_SIXTEENS * BLOCK);
    return noc_vk_tiles(f->blocks_x) * (FOUND_WORDS + FOUND_POOL + samples);
}

static void find_lights(scheduling *s) {
    add_list(s, VK_SHADER_influence_groups, VK_DOMAIN_TILES, R(SURFACES), R(SCRATCH));
    add_list(s, VK_SHADER_influence_near, VK_DOMAIN_TILES, 0, R(SCRATCH));
    add_list(s, VK_SHADER_influence_look, VK_DOMAIN_TILES, 0, R(SCRATCH));
    add_list(s, VK_SHADER_influence_rule, VK_DOMAIN_TILES, 0, R(SCRATCH));
    add_list(s, VK_SHADER_influence_place, VK_DOMAIN_ONE, 0, R(SCRATCH));
    add_list(s, VK_SHADER_influence_look, VK_DOMAIN_TILES, 0, R(SCRATCH))->first = 1;
}

static void candidates_influence(scheduling *s) {
    add_list(s, VK_SHADER_influence_draw, VK_DOMAIN_TILES, R(SAMPLES), R(SCRATCH));
    add_list(s, VK_SHADER_influence_candidates, VK_DOMAIN_PIXELS, R(SURFACES), R(SCRATCH) | set_bit(s->stage->target));
}

/* ---- stages ---- */

static void schedule_pass(scheduling *s, noc_pass pass) {
    static void (*const passes[NOC_PASS_COUNT])(scheduling *) = {
        [NOC_PASS_PRIMARY] = primary,
        [NOC_PASS_FIND_LIGHTS] = find_lights,
        [NOC_PASS_BUILD_LIST] = build_list,
        [NOC_PASS_CANDIDATES_UNIFORM] = candidates_shared,
        [NOC_PASS_CANDIDATES_LIST] = candidates_list,
        [NOC_PASS_CANDIDATES_POWER] = candidates_shared,
        [NOC_PASS_CANDIDATES_INFLUENCE] = candidates_influence,
        [NOC_PASS_CANDIDATES_LIGHT_BVH] = candidates_tree,
        [NOC_PASS_SEEN_BEFORE] = seen_before,
        [NOC_PASS_SHARE_RAYS] = share_rays,
        [NOC_PASS_VISIBILITY] = resolve,
        [NOC_PASS_TRACE_SHARED] = trace_shared,
        [NOC_PASS_RESAMPLE] = resample,
        [NOC_PASS_TEMPORAL] = temporal,
        [NOC_PASS_SPATIAL] = spatial,
        [NOC_PASS_EMITTERS] = emitters,
        [NOC_PASS_SHADE_SHARED] = shade_shared,
        [NOC_PASS_SHADE] = shade,
        [NOC_PASS_SHADE_ALL] = shade_all,
        [NOC_PASS_HEADLIGHT] = headlight,
        [NOC_PASS_SKY] = sky,
    };
    s->pass = pass;
    if (passes[pass] && (s->facts->lights || noc_pass_without_lights(pass)))
        passes[pass](s);
}

/* Rows of blocks in a band. */
static uint32_t band_of(const noc_plan *plan, const vk_facts *f) {
    if (plan->candidates == NOC_CANDIDATES_LISTS)
        return list_band(plan, f);
    return 4 * (uint32_t)NOC_CLAMP(f->band_bytes / (4 * found_row_words(plan, f)), (size_t)1,
                                   (size_t)noc_vk_tiles(f->blocks_y));
}

/* The passes of a stage from number `first` on that work on what a tile found or what its list became, band by band.
 * Returns the number of the next one. */
static int schedule_bands(scheduling *s, int first) {
    const vk_facts *f = s->facts;
    uint32_t band = band_of(s->plan, f);
    int end = first;
    for (int i = first; i < s->stage->count; i++) {
        noc_pass pass = s->stage->passes[i];
        if (pass == NOC_PASS_CANDIDATES_LIST || pass == NOC_PASS_CANDIDATES_INFLUENCE ||
            pass == NOC_PASS_TRACE_SHARED || pass == NOC_PASS_RESAMPLE || pass == NOC_PASS_SHADE_SHARED)
            end = i + 1;
    }
    if (s->plan->candidates == NOC_CANDIDATES_INFLUENCE && f->lights)
        presample(s, NOC_PASS_CANDIDATES_INFLUENCE);
    for (s->first_row = 0; s->first_row < f->blocks_y; s->first_row += band) {
        s->rows = NOC_MIN(band, f->blocks_y - s->first_row);
        for (int i = first; i < end; i++)
            schedule_pass(s, s->stage->passes[i]);
    }
    s->first_row = s->rows = 0;
    return end;
}

bool noc_vk_schedule(const noc_plan *plan, const noc_stage *stage, const vk_facts *facts, vk_steps *steps) {
    scheduling s = { .plan = plan, .stage = stage, .facts = facts, .steps = steps };
    for (int i = 0; i < stage->count;)
        if (stage->passes[i] == NOC_PASS_BUILD_LIST || stage->passes[i] == NOC_PASS_FIND_LIGHTS)
            i = schedule_bands(&s, i);
        else
            schedule_pass(&s, stage->passes[i++]);
    return !s.no_memory;
}

bool noc_vk_schedule_mean(const noc_plan *plan, const vk_facts *facts, vk_steps *steps) {
    scheduling s = { .facts = facts, .steps = steps, .pass = NOC_PASS_COUNT };
    add(&s, VK_SHADER_mean, R(COLOUR) | R(SURFACES) | R(PICTURE) | R(COVERAGE), R(PICTURE) | R(COVERAGE));
    if (plan->learns && facts->lights) {
        add(&s, VK_SHADER_learn_bright, R(BRIGHT), R(CACHE))->domain = VK_DOMAIN_ONE;
        add(&s, VK_SHADER_learn_sort, R(OBSERVED) | R(CACHE), R(OBSERVED) | R(CACHE))->domain = VK_DOMAIN_ROWS;
        add(&s, VK_SHADER_learn_count, R(OBSERVED) | R(CACHE), R(CACHE))->domain = VK_DOMAIN_RUNS;
    }
    return !s.no_memory;
}

size_t noc_vk_ray_room(const vk_steps *steps, const vk_facts *facts) {
    size_t most = (size_t)facts->blocks_x * facts->blocks_y * BLOCK;
    for (size_t i = 0; i < steps->len; i++)
        most = NOC_MAX(most, noc_vk_step_rays(&steps->data[i], facts->blocks_x, facts->blocks_y));
    return most;
}

size_t noc_vk_scratch_bytes(const noc_plan *plan, const vk_facts *f) {
    size_t words = reference_words(f);
    for (int i = 0; i < plan->count; i++) {
        if (noc_stage_has(&plan->stages[i], NOC_PASS_SHADE_ALL))
            return (size_t)band_rows(f, words) * f->blocks_x * BLOCK * words * 4;
        if (noc_stage_has(&plan->stages[i], NOC_PASS_BUILD_LIST))
            return list_row_words(plan, f) * 4 * (band_of(plan, f) / 4);
        if (noc_stage_has(&plan->stages[i], NOC_PASS_FIND_LIGHTS))
            return 4 * (found_row_words(plan, f) * (band_of(plan, f) / 4) + FOUND_SPARE);
    }
    return 0;
}

void noc_vk_find_wait(vk_hazards *h, vk_step *step) {
    step->wait = ((step->reads | step->writes) & h->written) || (step->writes & h->read);
    if (step->wait)
        *h = (vk_hazards){ 0 };
    h->read |= step->reads;
    h->written |= step->writes;
}
