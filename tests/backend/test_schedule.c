/* Dispatches of the Vulkan backend and their barriers, over all plans: a model of a device keeps what each dispatch has
 * written and nobody may see yet. Validation does not see buffers by address, and a software device runs in order, so
 * this is the only test of barriers without a GPU. */
#include "backend/vulkan/schedule.h"

#include "../render/each_plan.h"
#include "../test.h"
#include "render/backend.h"

/* The device: resources with writes, and with reads, that no barrier has come after. */
typedef struct model {
    bool dirty[VK_RESOURCE_COUNT], looked_at[VK_RESOURCE_COUNT];
} model;

/* Runs a step; returns what it gets wrong, VK_RESOURCE_COUNT for nothing. */
static int run_step(model *m, const vk_step *s) {
    if (s->wait)
        *m = (model){ 0 };
    for (int i = 0; i < VK_RESOURCE_COUNT; i++) {
        bool reads = s->reads >> i & 1, writes = s->writes >> i & 1;
        if ((reads || writes) && m->dirty[i])
            return i; /* reads or overwrites what may not be there yet */
        if (writes && m->looked_at[i])
            return i; /* overwrites what may still be read */
    }
    for (int i = 0; i < VK_RESOURCE_COUNT; i++) {
        m->dirty[i] = m->dirty[i] || (s->writes >> i & 1);
        m->looked_at[i] = m->looked_at[i] || (s->reads >> i & 1);
    }
    return VK_RESOURCE_COUNT;
}

static vk_facts facts_for(const noc_render_params *p, bool map, int history, frame_constants *c) {
    noc_make_frame_constants(p, 1, history >= 0, c);
    return (vk_facts){ .constants = c,
                       .history = history >= 0,
                       .sky = p->sky > 0 || map,
                       .lights = 5000,
                       .blocks_x = 80,
                       .blocks_y = 45,
                       .tile_words = noc_vk_tile_words(2),
                       .band_bytes = 64 << 20 };
}

/* All steps of a frame, with their barriers. */
static void schedule(const noc_plan *plan, const vk_facts *facts, vk_steps *steps) {
    vk_hazards hazards = { 0 };
    steps->len = 0;
    for (int i = 0; i < plan->count; i++)
        assert_true(noc_vk_schedule(plan, &plan->stages[i], facts, steps));
    assert_true(noc_vk_schedule_mean(plan, facts, steps));
    for (size_t i = 0; i < steps->len; i++)
        noc_vk_find_wait(&hazards, &steps->data[i]);
}

static vk_steps steps;
static size_t waits, dispatches, plans, noticed, added;

static void check_barriers(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    frame_constants c;
    vk_facts facts = facts_for(p, map, history, &c);
    facts.views = plans % 2; /* what steps gather for views has barriers, too */
    facts.panes = plans / 2 % 2;
    facts.band_bytes = plans / 4 % 8 ? facts.band_bytes : 1 << 20; /* bands of rays, too */
    model m = { 0 };
    (void)surfaces;
    plans++;
    schedule(plan, &facts, &steps);
    for (size_t i = 0; i < steps.len; i++) {
        assert_int_equal(run_step(&m, &steps.data[i]), VK_RESOURCE_COUNT);
        waits += steps.data[i].wait;
    }
    dispatches += steps.len;
}

static void each_step_sees_what_it_reads(void **state) {
    (void)state;
    each_plan(check_barriers);
    print_message("# %zu plans, %zu dispatches, %zu barriers\n", plans, dispatches, waits);
    assert_true(plans > 10000 && waits < dispatches);
}

/* Without any one of its barriers a frame is wrong, and the model says so. */
static void check_each_barrier(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    frame_constants c;
    vk_facts facts = facts_for(p, map, history, &c);
    facts.views = noticed / 16 % 2;
    facts.panes = noticed / 32 % 2;
    facts.band_bytes = noticed / 64 % 16 ? facts.band_bytes : 1 << 20;
    (void)surfaces;
    if (p->passes != 2 || history > 0)
        return;
    schedule(plan, &facts, &steps);
    for (size_t gone = 0; gone < steps.len; gone++) {
        model m = { 0 };
        bool wrong = false;
        if (!steps.data[gone].wait)
            continue;
        steps.data[gone].wait = false;
        for (size_t i = 0; i < steps.len && !wrong; i++)
            wrong = run_step(&m, &steps.data[i]) != VK_RESOURCE_COUNT;
        assert_true(wrong);
        noticed++;
        steps.data[gone].wait = true;
    }
}

static void each_barrier_is_needed(void **state) {
    (void)state;
    each_plan(check_each_barrier);
    assert_true(noticed > 10000);
}

/* Surfaces that let light through add rays to shading, which asks of all its samples, and camera rays meet them by
 * another shader. All else is as without them; so a scene that has none costs nothing for them. */
static void check_panes(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    vk_steps with = { 0 };
    frame_constants c;
    vk_facts facts = facts_for(p, map, history, &c);
    (void)surfaces;
    schedule(plan, &facts, &steps);
    facts.panes = true;
    schedule(plan, &facts, &with);
    size_t k = 0;
    for (size_t i = 0; i < steps.len; i++, k++) {
        vk_step a = steps.data[i], b = with.data[k];
        assert_true(a.shader != VK_SHADER_trace_meeting && a.shader != VK_SHADER_trace_through);
        assert_false((a.reads | a.writes) >> VK_RESOURCE_THROUGH & 1);
        assert_int_equal(b.shader, a.shader == VK_SHADER_trace_closest ? VK_SHADER_trace_meeting : a.shader);
        assert_int_equal(b.reads & ~(1u << VK_RESOURCE_THROUGH), a.reads);
        assert_int_equal(b.writes, a.writes);
        assert_int_equal(b.first, a.first + (a.shader == VK_SHADER_resolve_ask && a.pass == NOC_PASS_SHADE));
        bool shades = a.pass == NOC_PASS_SHADE || a.pass == NOC_PASS_SHADE_ALL || a.pass == NOC_PASS_SKY ||
                      a.pass == NOC_PASS_TRACE_SHARED;
        if (a.shader != VK_SHADER_trace_occlusion || !shades)
            continue;
        k++;
        assert_int_equal(with.data[k].shader, VK_SHADER_trace_through);
        assert_true(with.data[k].slots == a.slots && with.data[k].band == a.band && with.data[k].rows == a.rows);
        added++;
    }
    assert_int_equal(k, with.len);
    array_free(&with);
}

static void panes_add_rays_alone(void **state) {
    (void)state;
    each_plan(check_panes);
    assert_true(added > 1000);
}

/* What a pass of the plan reads and writes, as resources. */
static uint32_t resources(const noc_stage *s, uint32_t buffers) {
    static const uint32_t of[NOC_BUFFER_COUNT] = { [NOC_BUFFER_SURFACES] = 1u << VK_RESOURCE_SURFACES,
                                                   [NOC_BUFFER_PREVIOUS] = 1u << VK_RESOURCE_PREVIOUS,
                                                   [NOC_BUFFER_CACHE] = 1u << VK_RESOURCE_CACHE,
                                                   [NOC_BUFFER_COLOUR] = 1u << VK_RESOURCE_COLOUR,
                                                   [NOC_BUFFER_PICTURE] = 1u << VK_RESOURCE_PICTURE };
    uint32_t out = 0;
    for (int i = 0; i < NOC_BUFFER_COUNT; i++)
        if (buffers >> i & 1)
            out |= i == NOC_BUFFER_RESERVOIRS ? 1u << (VK_RESOURCE_SET + s->target)
                   : i == NOC_BUFFER_SOURCE   ? 1u << (VK_RESOURCE_SET + s->source)
                                              : of[i];
    return out;
}

static void check_tables(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    frame_constants c;
    vk_facts facts = facts_for(p, map, history, &c);
    uint32_t own = 1u << VK_RESOURCE_RAYS | 1u << VK_RESOURCE_ANSWERS | 1u << VK_RESOURCE_THROUGH |
                   1u << VK_RESOURCE_HITS | 1u << VK_RESOURCE_SAMPLES | 1u << VK_RESOURCE_SCRATCH |
                   1u << VK_RESOURCE_OBSERVED | 1u << VK_RESOURCE_BRIGHT;
    (void)surfaces;
    facts.panes = plans++ % 2;
    for (int i = 0; i < plan->count; i++) {
        const noc_stage *s = &plan->stages[i];
        steps.len = 0;
        assert_true(noc_vk_schedule(plan, s, &facts, &steps));
        for (int k = 0; k < s->count; k++) {
            const noc_pass_row *row = &noc_passes[s->passes[k]];
            uint32_t reads = 0, writes = 0;
            for (size_t n = 0; n < steps.len; n++) {
                reads |= steps.data[n].pass == s->passes[k] ? steps.data[n].reads : 0;
                writes |= steps.data[n].pass == s->passes[k] ? steps.data[n].writes : 0;
            }
            if (!reads && !writes && s->passes[k] == NOC_PASS_TEMPORAL && history < 0)
                continue; /* there is nothing to combine with */
            assert_int_equal(writes & ~own, resources(s, row->writes));
            /* a pass reads what the table says, and what it has written itself */
            assert_int_equal(reads & ~own & ~(resources(s, row->reads) | writes), 0);
        }
    }
}

static void steps_do_what_the_plan_says(void **state) {
    (void)state;
    each_plan(check_tables);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_step_sees_what_it_reads),
        cmocka_unit_test(each_barrier_is_needed),
        cmocka_unit_test(panes_add_rays_alone),
        cmocka_unit_test(steps_do_what_the_plan_says),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    array_free(&steps);
    return failed;
}
