/* The tables of render/plan.h, and the plans of the frames that docs/frame.md shows, as JSON for tools/draw-frame.py.
 */
#include "render/plan.h"

#include <stdio.h>

static const char *const lifetimes[] = { "tile", "frame", "on" }, *const domains[] = { "pixel", "tile", "view" },
                         *const rays[] = { "", "nearest hits", "occlusion" };

static void print_bits(const char *name, uint32_t bits) {
    printf(", \"%s\": [", name);
    for (int i = 0, n = 0; i < NOC_BUFFER_COUNT; i++)
        if (bits >> i & 1)
            printf("%s%d", n++ ? ", " : "", i);
    printf("]");
}

static void print_stage(const noc_stage *s) {
    printf("    [");
    for (int i = 0; i < s->count; i++) {
        const noc_pass_row *row = &noc_passes[s->passes[i]];
        printf("%s{ \"name\": \"%s\", \"rays\": \"%s\"", i ? ",\n     " : "", row->name, rays[row->rays]);
        print_bits("reads", row->reads);
        print_bits("writes", row->writes);
        print_bits("others", row->others);
        printf(" }");
    }
    printf("]");
}

static void print_frame(const char *name, const noc_render_params *p) {
    noc_plan plan;
    noc_plan_make(p, false, 0, false, &plan);
    printf("  \"%s\": [\n", name);
    for (int i = 0; i < plan.count; i++) {
        print_stage(&plan.stages[i]);
        printf(i + 1 < plan.count ? ",\n" : "\n");
    }
    printf("  ]");
}

int main(void) {
    noc_render_params lists = noc_render_default_params(), restir = lists;
    restir.method = NOC_METHOD_RESTIR;
    restir.candidates = NOC_CANDIDATES_INFLUENCE;
    printf("{ \"buffers\": [\n");
    for (int i = 0; i < NOC_BUFFER_COUNT; i++)
        printf("  { \"name\": \"%s\", \"domain\": \"%s\", \"lives\": \"%s\", \"bytes\": %d }%s\n", noc_buffers[i].name,
               domains[noc_buffers[i].domain], lifetimes[noc_buffers[i].lifetime], noc_buffers[i].bytes,
               i + 1 < NOC_BUFFER_COUNT ? "," : "");
    printf("], \"frames\": {\n");
    print_frame("lists", &lists);
    printf(",\n");
    print_frame("restir", &restir);
    printf("\n} }\n");
    return 0;
}
