/* Lights that move: the previous frame's are kept for temporal reuse. */
#include "backend/cpu/cpu.h"

noc_status noc_cpu_prepare_past(cpu_view *s, const noc_plan *plan) {
    size_t n = s->scene->lights.len;
    if (!plan->past_lights || !s->scene->moving.len || s->past_lights ||
        (s->past_lights = noc_alloc_large(n, sizeof(*s->past_lights))))
        return NOC_OK;
    return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the previous frame's %zu lights", n);
}

void noc_cpu_keep_lights(cpu_view *s) {
    const noc_scene *scene = s->scene;
    if (!s->past_lights || (s->past_filled && s->past_moves == scene->versions.commits))
        return;
    if (!s->past_filled)
        memcpy(s->past_lights, scene->lights.data, scene->lights.len * sizeof(*s->past_lights));
    for (size_t i = 0; i < scene->moving.len; i++)
        s->past_lights[scene->moving.data[i]] = scene->lights.data[scene->moving.data[i]];
    s->past_filled = true;
    s->past_moves = scene->versions.commits;
}

struct core_context noc_cpu_past(const cpu_view *s, const struct core_context *now) {
    struct core_context past = *now;
    if (s->past_filled && s->past_moves != s->scene->versions.commits)
        past.lights = s->past_lights;
    return past;
}

size_t noc_cpu_past_bytes(const cpu_view *s) {
    return s->past_lights ? s->scene->lights.len * sizeof(*s->past_lights) : 0;
}
