/* From the passes of a stage to dispatches: see schedule.h. */
#include "backend/vulkan/schedule.h"

#include "core/random.h"

#define R(resource) (1u << VK_RESOURCE_##resource)

typedef struct scheduling {
    const noc_plan *plan;
    const noc_stage *stage;
    const vk_facts *facts;
    vk_step *steps;
    int count;
    noc_pass pass;
} scheduling;

static uint32_t set_bit(int set) { return R(SET) << set; }

static vk_step *add(scheduling *s, vk_shader shader, uint32_t reads, uint32_t writes) {
    vk_step *step = &s->steps[s->count++];
    *step = (vk_step){ .shader = shader,
                       .reads = reads,
                       .writes = writes,
                       .slots = 1,
                       .source = s->stage ? s->stage->source : 0,
                       .target = s->stage ? s->stage->target : 0,
                       .pass = s->pass };
    return step;
}

/* Answers `slots` rays a pixel that the step before has written. */
static void trace(scheduling *s, int slots, bool past) {
    vk_step *step = add(s, VK_SHADER_trace_occlusion, R(RAYS) | R(ANSWERS), R(ANSWERS));
    step->domain = VK_DOMAIN_RAYS;
    step->slots = slots;
    step->past = past;
}

static void primary(scheduling *s) {
    add(s, VK_SHADER_primary_ask, 0, R(RAYS) | R(ANSWERS));
    add(s, VK_SHADER_trace_closest, R(RAYS) | R(ANSWERS), R(HITS))->domain = VK_DOMAIN_RAYS;
    add(s, VK_SHADER_primary_use, R(HITS) | R(RAYS), R(SURFACES));
}

static void emitters(scheduling *s) { add(s, VK_SHADER_emitters, R(SURFACES), R(COLOUR)); }

static void headlight(scheduling *s) { add(s, VK_SHADER_headlight, R(SURFACES) | R(COLOUR), R(COLOUR)); }

int noc_vk_schedule(const noc_plan *plan, const noc_stage *stage, const vk_facts *facts, vk_step *steps) {
    static void (*const passes[NOC_PASS_COUNT])(scheduling *) = {
        [NOC_PASS_PRIMARY] = primary,
        [NOC_PASS_EMITTERS] = emitters,
        [NOC_PASS_HEADLIGHT] = headlight,
    };
    scheduling s = { .plan = plan, .stage = stage, .facts = facts, .steps = steps };
    for (int i = 0; i < stage->count; i++) {
        s.pass = stage->passes[i];
        if (passes[s.pass])
            passes[s.pass](&s);
    }
    return s.count;
}

int noc_vk_schedule_mean(const vk_facts *facts, vk_step *steps) {
    scheduling s = { .facts = facts, .steps = steps, .pass = NOC_PASS_COUNT };
    add(&s, VK_SHADER_mean, R(COLOUR) | R(SURFACES) | R(PICTURE) | R(COVERAGE), R(PICTURE) | R(COVERAGE));
    return s.count;
}

int noc_vk_schedule_slots(const noc_plan *plan, const vk_facts *facts) {
    vk_step steps[VK_STAGE_STEPS];
    int most = 1;
    for (int i = 0; i < plan->count; i++)
        for (int n = noc_vk_schedule(plan, &plan->stages[i], facts, steps); n-- > 0;)
            most = NOC_MAX(most, steps[n].slots);
    return most;
}

void noc_vk_find_wait(vk_hazards *h, vk_step *step) {
    step->wait = ((step->reads | step->writes) & h->written) || (step->writes & h->read);
    if (step->wait)
        *h = (vk_hazards){ 0 };
    h->read |= step->reads;
    h->written |= step->writes;
}
