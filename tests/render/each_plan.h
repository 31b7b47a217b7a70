/* Every combination of what decides a frame's plan. */
#ifndef NOC_TEST_EACH_PLAN_H
#define NOC_TEST_EACH_PLAN_H

#include "render/plan.h"

/* Calls back with every combination of what decides a plan. */
static inline int each_plan(void (*check)(const noc_render_params *p, const noc_plan *plan, int history, bool map,
                                          bool surfaces)) {
    int count = 0;
    for (int method = 0; method < NOC_METHOD_COUNT; method++)
        for (int from = 0; from < NOC_CANDIDATES_COUNT; from++)
            for (int bias = 0; bias <= NOC_BIAS_PAIRWISE; bias++)
                for (int bits = 0; bits < 128; bits++)
                    for (int passes = 1; passes <= 4; passes++)
                        for (int history = -1; history <= 2; history++) {
                            noc_render_params p = noc_render_default_params();
                            p.method = (noc_method)method;
                            p.candidates = (noc_candidates)from;
                            p.bias = (noc_bias)bias;
                            p.temporal = bits & 1;
                            p.spatial = bits & 2;
                            p.visibility_reuse = bits & 4;
                            p.final_ray = bits & 8;
                            p.bias_rays = bits & 16;
                            p.sky = bits & 32 ? 0.02 : 0;
                            p.passes = passes;
                            bool map = (bits ^ passes) & 4, surfaces = bits & 64;
                            noc_plan plan;
                            noc_plan_make(&p, map, history, surfaces, &plan);
                            check(&p, &plan, history, map, surfaces);
                            count++;
                        }
    return count;
}

#endif
