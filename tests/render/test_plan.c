/* Plans of all kinds of frames, held to the tables of passes and buffers. */
#include "../test.h"
#include "each_plan.h"

#include "core/blocks.h"

/* A buffer, or a set of reservoirs in it. */
static uint32_t part(const noc_stage *s, uint32_t bits) {
    uint32_t out = bits & ~(1u << NOC_BUFFER_RESERVOIRS | 1u << NOC_BUFFER_SOURCE);
    if (bits >> NOC_BUFFER_RESERVOIRS & 1)
        out |= 1u << (NOC_BUFFER_COUNT + s->target);
    if (bits >> NOC_BUFFER_SOURCE & 1)
        out |= 1u << (NOC_BUFFER_COUNT + s->source);
    return out;
}

static uint32_t living(noc_lifetime lifetime) {
    uint32_t bits = 0;
    for (int i = 0; i < NOC_BUFFER_COUNT; i++)
        bits |= (uint32_t)(noc_buffers[i].lifetime == lifetime) << i;
    return bits;
}

/* Colour is a sum: whoever comes first sets it, and others add to what is there. */
static uint32_t check_sum(const noc_pass_row *row, uint32_t summed) {
    uint32_t colour = 1u << NOC_BUFFER_COLOUR;
    if (!(row->writes & colour))
        return summed;
    if (!(row->reads & colour) != !summed)
        fail_msg("%s: it %s the frame's colour", row->name, summed ? "replaces" : "adds to nothing in");
    return colour;
}

static void check_stages(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    uint32_t sets = 0, summed = 0, written = 1u << NOC_BUFFER_PREVIOUS | 1u << NOC_BUFFER_CACHE;
    (void)p;
    (void)map;
    assert_in_range(plan->count, 1, NOC_MAX_STAGES);
    assert_int_equal(plan->stages[0].passes[0] == NOC_PASS_PRIMARY, !surfaces);
    written |= (uint32_t)surfaces << NOC_BUFFER_SURFACES;
    if (history >= 0 || plan->next_history >= 0) /* in the first frame nobody looks */
        written |= 1u << (NOC_BUFFER_COUNT + plan->stages[0].source);
    for (int i = 0; i < plan->count; i++) {
        const noc_stage *s = &plan->stages[i];
        uint32_t here = 0, tiles = living(NOC_LIVES_TILE);
        assert_in_range(s->count, 1, sizeof(s->passes) / sizeof(*s->passes));
        for (int k = 0; k < s->count; k++) {
            const noc_pass_row *row = &noc_passes[s->passes[k]];
            uint32_t reads = part(s, row->reads), others = part(s, row->others), writes = part(s, row->writes);
            assert_int_equal(row->others & ~row->reads, 0);
            assert_int_equal(others & here, 0);             /* nobody looks over the fence in a stage */
            assert_int_equal(reads & ~(written | here), 0); /* what is read is there */
            assert_int_equal(reads & tiles & ~here, 0);     /* scratch is from this stage */
            if (row->others && s->passes[k] == NOC_PASS_SPATIAL)
                assert_int_not_equal(s->source, s->target);
            here |= writes;
            summed = check_sum(row, summed);
        }
        for (int later = 0; later < s->count; later++) /* nor does a later pass write what an earlier one looked at */
            for (int k = 0; k < later; k++)
                assert_int_equal(part(s, noc_passes[s->passes[k]].others) &
                                     part(s, noc_passes[s->passes[later]].writes),
                                 0);
        written |= here & ~tiles;
        sets |= written >> NOC_BUFFER_COUNT;
    }
    assert_int_equal(sets >> plan->sets, 0);
    assert_true(written >> NOC_BUFFER_COLOUR & 1);
    assert_true(plan->next_history < plan->sets);
    if (plan->next_history >= 0)
        assert_true(sets >> plan->next_history & 1);
}

static void stages_may_run_tile_by_tile(void **state) {
    (void)state;
    assert_int_equal(each_plan(check_stages), NOC_METHOD_COUNT * NOC_CANDIDATES_COUNT * 3 * 128 * 4 * 4);
}

static void check_shading(const noc_render_params *p, const noc_plan *plan, int history, bool map, bool surfaces) {
    int shades = 0, skies = 0;
    (void)history;
    (void)surfaces;
    for (int i = 0; i < plan->count; i++)
        for (int k = 0; k < plan->stages[i].count; k++) {
            noc_pass pass = plan->stages[i].passes[k];
            shades += pass == NOC_PASS_SHADE || pass == NOC_PASS_SHADE_ALL || pass == NOC_PASS_HEADLIGHT ||
                      (pass == NOC_PASS_SHADE_SHARED && p->method != NOC_METHOD_RESTIR);
            skies += pass == NOC_PASS_SKY;
            if (noc_passes[pass].others && pass == NOC_PASS_SPATIAL)
                assert_int_equal(p->method, NOC_METHOD_RESTIR);
        }
    assert_int_equal(shades, 1);
    assert_int_equal(skies, (p->sky > 0 || map) && p->method != NOC_METHOD_HEADLIGHT);
}

static void light_is_shaded_once(void **state) {
    (void)state;
    each_plan(check_shading);
}

/* A pixel's bytes are those of the blocks that passes work on. */
static void buffers_are_as_large_as_their_records(void **state) {
    static const struct {
        noc_buffer buffer;
        size_t bytes; /* a block */
    } records[] = {
        { NOC_BUFFER_SURFACES, sizeof(gblock) },   { NOC_BUFFER_PREVIOUS, sizeof(gblock) },
        { NOC_BUFFER_RESERVOIRS, sizeof(rblock) }, { NOC_BUFFER_SOURCE, sizeof(rblock) },
        { NOC_BUFFER_COLOUR, sizeof(cblock) },     { NOC_BUFFER_PICTURE, sizeof(cblock) },
    };
    size_t pixels = 0;
    (void)state;
    for (int i = 0; i < NOC_BUFFER_COUNT; i++)
        pixels += noc_buffers[i].domain == NOC_DOMAIN_PIXEL;
    assert_int_equal(pixels, NOC_COUNT(records));
    for (size_t i = 0; i < NOC_COUNT(records); i++)
        assert_int_equal((size_t)noc_buffers[records[i].buffer].bytes * BLOCK, records[i].bytes);
}

static void names_are_told_apart(void **state) {
    (void)state;
    for (int i = 0; i < NOC_PASS_COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(noc_passes[i].name, noc_passes[k].name);
    for (int i = 0; i < NOC_BUFFER_COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(noc_buffers[i].name, noc_buffers[k].name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_may_run_tile_by_tile),
        cmocka_unit_test(light_is_shaded_once),
        cmocka_unit_test(names_are_told_apart),
        cmocka_unit_test(buffers_are_as_large_as_their_records),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
