/* What light adds to a block's colour, and to the views that gather it: render/views.h. */
#include "backend/cpu/cpu.h"
#include "backend/cpu/lanes_tmpl.h"
#include "core/measured.h"

/* How often a light that lane l chose is expected among its candidates. */
static float expected(const stage_run *run, const worker *w, uint32_t id, int l) {
    const noc_plan *p = run->frame->plan;
    if (p->candidates == NOC_CANDIDATES_UNIFORM)
        return expected_draws((u1)p->candidate_count, (float)run->ctx.light_count);
    if (p->candidates == NOC_CANDIDATES_POWER)
        return expected_draws((u1)p->candidate_count, run->ctx.alias->slots[id].inverse);
    if (p->candidates == NOC_CANDIDATES_LISTS) {
        const light_list *list = &w->lists->build.list;
        for (uint32_t i = 0; i < list->count; i++)
            if (list->light[i] == id)
                return expected_entries(list->weight[i], list->copies);
    } else {
        for (int i = 0; i < p->candidate_count; i++)
            if (w->picks->drawn.light[i][l] == id && w->picks->drawn.inverse[i][l] > 0)
                return expected_draws((u1)p->candidate_count, w->picks->drawn.inverse[i][l]);
    }
    return -1;
}

void noc_cpu_note_candidates(const stage_run *run, const worker *w, int i, size_t block, uint32_t lanes,
                             const rblock *r) {
    const noc_views *v = &run->s->b.views;
    bool lists = run->frame->plan->candidates == NOC_CANDIDATES_LISTS;
    for (int l = 0; l < BLOCK; l++) {
        if (!(lanes >> l & 1))
            continue;
        if (v->made[NOC_AOV_LIGHTS])
            v->made[NOC_AOV_LIGHTS][block][l] = (float)(lists ? w->lists->build.list.count / w->lists->build.list.copies
                                                              : noc_found_count(&w->picks->found, i, l));
        if (v->made[NOC_AOV_DENSITY] && r->w[l] > 0 && run->frame->plan->candidates != NOC_CANDIDATES_INFLUENCE)
            v->made[NOC_AOV_DENSITY][block][l] = expected(run, w, r->light[l], l);
    }
}

static uint32_t shade(const stage_run *run, const gblock *g, const rblock *r, const cblock *brings, uint32_t lanes,
                      cblock *out) {
    return brings ? run->k->shade_known(brings, r->w, lanes, out) : run->k->shade(&run->ctx, g, r, lanes, out);
}

uint32_t noc_cpu_shade_samples(const stage_run *run, const gblock *g, const rblock *r, const cblock *brings,
                               uint32_t lanes, size_t block) {
    const noc_views *v = &run->s->b.views;
    float(*lux)[BLOCK] = v->made[NOC_AOV_ILLUMINANCE];
    if (lux)
        run->k->samples_lux(&run->ctx, g, r, lanes & noc_views_measured(lux[block]), lux[block]);
    if (noc_views_note_sources(v)) { /* on its own, so that what the samples add is told to the last bit */
        cblock alone = { 0 };
        shade(run, g, r, brings, lanes, &alone);
        noc_views_note(v, run->s->scene, r->light, &alone, lanes, block);
    }
    return shade(run, g, r, brings, lanes, &run->s->b.colour[block]);
}

uint32_t noc_cpu_shade_sky(const stage_run *run, const gblock *g, const rayblock *rays, const float *share,
                           uint32_t lanes, size_t block) {
    const noc_views *v = &run->s->b.views;
    float(*lux)[BLOCK] = v->made[NOC_AOV_ILLUMINANCE];
    if (lux)
        run->k->sky_lux(&run->ctx, g, rays, share, lanes & noc_views_measured(lux[block]), lux[block]);
    if (v->made[NOC_AOV_INFLUENTIAL]) {
        cblock alone = { 0 };
        run->k->sky_shade(&run->ctx, g, rays, share, lanes, &alone);
        noc_views_note_sky(v, &alone, lanes, block);
    }
    return run->k->sky_shade(&run->ctx, g, rays, share, lanes, &run->s->b.colour[block]);
}

void noc_cpu_note_emitters(const stage_run *run, const gblock *g, const cblock *c, size_t block) {
    const noc_views *v = &run->s->b.views;
    float(*lux)[BLOCK] = v->made[NOC_AOV_ILLUMINANCE];
    for (uint32_t bits = lux ? lanes_with_surface(g) & ~run->s->b.emitter[block] : 0; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        surf s = surf_load(&run->ctx, g, l, run->ctx.frame->camera.eye);
        lux[block][l] = lux_measurable(v->light_colours, s.albedo) ? 0 : -1;
    }
    if (noc_views_note_sources(v))
        noc_views_note(v, run->s->scene, g->light, c, run->s->b.emitter[block], block);
}
