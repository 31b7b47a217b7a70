/* What the frame before saw of a scene that is edited (render/past.h): the copy of its lights, and surfaces taken back
 * to where they were. */
#include "backend/cpu/cpu.h"

/* Lights that the frame before did not have are dark in it. */
static bool make_room(cpu_view *s, size_t room) {
    size_t have = s->past.filled ? s->past.room : 0;
    if (room <= s->past.room)
        return true;
    if (!noc_resize_large(&s->previous_lights, have, room, sizeof(*s->previous_lights)))
        return false;
    s->past.room = room;
    return true;
}

noc_status noc_cpu_begin_past(cpu_view *s, const noc_plan *plan) {
    if (!make_room(s, noc_past_begin(&s->past, s->scene, plan)))
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the previous frame's %zu lights",
                         s->scene->lights.len);
    noc_past_check(&s->past, s->scene, &s->world->placings, plan);
    return NOC_OK;
}

void noc_cpu_keep_past(cpu_view *s) {
    noc_range r = noc_past_keep(&s->past, s->scene);
    if (r.first < r.end)
        memcpy(s->previous_lights + r.first, s->scene->lights.data + r.first,
               (r.end - r.first) * sizeof(*s->previous_lights));
}

struct core_context noc_cpu_previous(const cpu_view *s, const struct core_context *now, noc_ray_world *in) {
    struct core_context past = *now;
    if (noc_past_other_lights(&s->past, s->scene))
        past.lights = s->previous_lights;
    *in = noc_past_other_shape(&s->past, s->scene) ? NOC_RAYS_PAST : NOC_RAYS_NOW;
    return past;
}

size_t noc_cpu_past_bytes(const cpu_view *s) { return s->past.room * sizeof(*s->previous_lights); }

const gblock *noc_cpu_taken_back(const cpu_view *s, size_t at, const gblock *g, gblock *moved) {
    return noc_past_surfaces(&s->past, s->scene, &s->world->placings, s->b.instance ? s->b.instance[at] : NULL, g,
                             moved);
}
