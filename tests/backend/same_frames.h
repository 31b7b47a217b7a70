/* Frames of the Vulkan backend that have the bits of the CPU's. */
#ifndef NOC_TEST_SAME_FRAMES_H
#define NOC_TEST_SAME_FRAMES_H

#include "vulkan_view.h"

/* Renders a frame on both machines; what is between rays has the same bits in every buffer. */
static inline void expect_same_frame(twins *t, const noc_camera *camera, const noc_render_params *p, const char *name) {
    assert_int_equal(noc_view_render(t->cpu, camera, p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(t->gpu, camera, p, NULL), NOC_OK);
    const frame_buffers *c = &cpu_of(t)->b;
    const vk_picture *g = &gpu_of(t)->b;
    bool chooses =
        p->method != NOC_METHOD_HEADLIGHT && p->method != NOC_METHOD_REFERENCE && noc_cpu_keeps_reservoirs(p);
    int set = cpu_of(t)->shaded_set;
    size_t surfaces = differing(t, c->g[t->cpu->history.gbuffer], &g->surfaces[t->gpu->history.gbuffer], 10);
    size_t reservoirs = chooses ? differing(t, c->r[set], &g->reservoirs[set], 6) : 0;
    size_t colour = differing(t, c->colour, &g->colour, 3), picture = differing(t, c->picture, &g->picture, 3);
    if (surfaces || reservoirs || colour || picture)
        fail_msg("%s, frame %u: words that differ: surfaces %zu, reservoirs %zu, colour %zu, picture %zu", name,
                 t->cpu->history.index, surfaces, reservoirs, colour, picture);
}

static inline void expect_same_bits(twins *t, const noc_camera *camera, const noc_render_params *p, int frames,
                                    const char *name) {
    noc_view_reset(t->cpu);
    noc_view_reset(t->gpu);
    for (int f = 0; f < frames; f++)
        expect_same_frame(t, camera, p, name);
}

/* Of every view that the last frames kept; returns those that say something, bits 1 << aov. */
static inline uint32_t expect_same_views(twins *t, uint32_t aovs, const char *name) {
    uint32_t told = 0;
    for (noc_aov aov = 0; aov < NOC_AOV_COUNT; aov++) {
        if (!(aovs >> aov & 1))
            continue;
        noc_channel *a = noc_view_aov(t->cpu, aov), *b = noc_view_aov(t->gpu, aov);
        assert_true(a && b);
        size_t n = (size_t)a->width * (size_t)a->height * (size_t)a->components, off = 0;
        for (size_t i = 0; i < n; i++) {
            off += memcmp(&a->value[i], &b->value[i], sizeof(float)) != 0;
            told |= (uint32_t)(a->value[i] > 0) << aov;
        }
        if (off)
            fail_msg("%s, frame %u: view %s differs in %zu of %zu numbers", name, t->cpu->history.index,
                     noc_aov_name(aov), off, n);
        noc_channel_destroy(a);
        noc_channel_destroy(b);
    }
    return told;
}

#endif
