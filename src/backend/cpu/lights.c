/* What the candidates of a view are drawn from, and what is told of it. */
#include "backend/cpu/cpu.h"

/* Told after the frame, when other views may have had the volumes made anew. */
static void note_volumes(cpu_view *s, const noc_plan *plan, const noc_render_params *p) {
    s->told = (noc_light_stats){ .candidates = plan->candidates };
    if (s->sources.influence)
        noc_light_set_note(s->sources.influence, p, &s->told);
}

noc_status noc_cpu_prepare_lights(cpu_view *s, const noc_plan *plan, const noc_render_params *p) {
    s->told = (noc_light_stats){ 0 };
    if (!plan->draws)
        return NOC_OK;
    noc_status status = noc_light_set_get(s->world->lights, plan->candidates, p, &s->sources);
    if (status == NOC_OK)
        note_volumes(s, plan, p);
    return status;
}

void noc_cpu_release_lights(cpu_view *s) {
    noc_light_set_release(s->world->lights, &s->sources);
    free(s->previous_lights);
}

void noc_cpu_forget_found(cpu_view *s) {
    for (int i = 0; i < s->worker_count; i++) {
        worker *w = &s->workers[i];
        if (w->picks && w->picks->found_counts)
            memset(w->picks->found_counts, 0, s->found_bins * sizeof(*w->picks->found_counts));
    }
}

size_t noc_cpu_light_bytes(const cpu_world *world) {
    size_t bytes = 0;
    for (int c = 0; c < NOC_CANDIDATES_COUNT; c++)
        bytes += noc_light_set_bytes(world->lights, (noc_candidates)c);
    return bytes + noc_light_set_map_bytes(world->lights);
}

static size_t scene_bytes(const noc_scene *s) {
    return s->positions.len * sizeof(float) +
           (s->indices.len + s->triangle_material.len + s->triangle_light.len) * sizeof(uint32_t) +
           s->material_records.len * sizeof(noc_material_record) + s->lights.len * sizeof(noc_light_record);
}

/* Surfaces of the frame that found so many lights. */
static uint64_t surfaces_finding(const void *view, uint32_t lights) {
    const cpu_view *s = view;
    uint64_t sum = 0;
    for (int i = 0; i < s->worker_count; i++) {
        const pick_pass *p = s->workers[i].picks;
        sum += p && p->found_counts ? p->found_counts[lights] : 0;
    }
    return sum;
}

void noc_cpu_light_stats(void *view, noc_light_stats *out) {
    cpu_view *s = view;
    *out = s->told;
    out->lights = s->scene->lights.len;
    out->scene_bytes = scene_bytes(s->scene) + noc_cpu_rays_bytes(s->world);
    out->build_seconds = noc_light_set_seconds(s->world->lights, out->candidates);
    out->bytes = noc_light_set_bytes(s->world->lights, out->candidates);
    if (out->candidates == NOC_CANDIDATES_INFLUENCE)
        noc_light_set_note_found(surfaces_finding, s, s->found_bins, out);
}

noc_status noc_cpu_influence(void *view, const noc_render_params *params, const struct noc_influence **volumes) {
    cpu_view *s = view;
    noc_status status = noc_cpu_follow(s->world); /* volumes are looked for by rays */
    if (status == NOC_OK)
        status = noc_light_set_get(s->world->lights, NOC_CANDIDATES_INFLUENCE, params, &s->sources);
    *volumes = s->sources.influence;
    return status;
}
