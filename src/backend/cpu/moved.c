/* What the frame before saw of a scene that is edited: its lights, where its instances stood, what blocked its rays.
 * Temporal reuse asks its reservoirs' targets of that, so that it stays unbiased. */
#include "backend/cpu/cpu.h"

#include <math.h>

static bool same_lights(const noc_scene_versions *a, const noc_scene_versions *b) {
    return a->lights == b->lights && a->moved == b->moved && a->emission == b->emission;
}

/* Scenes whose lights have never changed do without a copy. Where one is changed for the first time, the frame before
 * has left none, and its reservoirs are not reused. */
static bool keeps_lights(const cpu_view *s) {
    const noc_scene_versions *v = &s->scene->versions;
    return s->scene->moving.len || v->lights || v->moved || v->emission;
}

/* Those that the frame before did not have are dark in it. */
static bool make_room(cpu_view *s) {
    size_t room = s->scene->lights.len;
    if (room <= s->past_room)
        return true;
    room += s->past_room ? room / 4 : 0;
    size_t have = s->past_filled ? s->past_room : 0;
    if (!noc_resize_large(&s->previous_lights, have, room, sizeof(*s->previous_lights)))
        return false;
    s->past_room = room;
    return true;
}

noc_status noc_cpu_begin_past(cpu_view *s, const noc_plan *plan) {
    const noc_scene_versions *now = &s->scene->versions, *then = &s->seen;
    s->past_lost = false;
    if (!plan->previous_lights) {
        s->past_filled = false;
        return NOC_OK;
    }
    if (keeps_lights(s) && !make_room(s))
        return noc_error(s->log, NOC_ERR_MEMORY, "render: no memory for the previous frame's %zu lights",
                         s->scene->lights.len);
    s->past_lost = (!same_lights(now, then) && !s->past_filled) || now->materials != then->materials ||
                   (noc_scene_shape(now) != noc_scene_shape(then) && s->world->past != noc_scene_shape(then));
    return NOC_OK;
}

void noc_cpu_keep_past(cpu_view *s) {
    const noc_scene *scene = s->scene;
    noc_scene_versions then = s->seen;
    s->seen = scene->versions;
    if (!s->previous_lights || (s->past_filled && same_lights(&then, &s->seen)))
        return;
    if (s->past_room < scene->lights.len) /* this frame's plan asked for none, and more lights came */
        return;
    bool last = s->past_filled && then.commits + 1 == s->seen.commits; /* that commit wrote these, and no others */
    noc_range r = last ? scene->dirty_lights : (noc_range){ 0, scene->lights.len };
    if (r.first < r.end)
        memcpy(s->previous_lights + r.first, scene->lights.data + r.first,
               (r.end - r.first) * sizeof(*s->previous_lights));
    s->past_filled = true;
}

struct core_context noc_cpu_previous(const cpu_view *s, const struct core_context *now, noc_ray_world *in) {
    struct core_context past = *now;
    if (s->past_filled && !same_lights(&s->seen, &s->scene->versions))
        past.lights = s->previous_lights;
    *in = noc_scene_shape(&s->seen) == noc_scene_shape(&s->scene->versions) ? NOC_RAYS_NOW : NOC_RAYS_PAST;
    return past;
}

size_t noc_cpu_past_bytes(const cpu_view *s) { return s->past_room * sizeof(*s->previous_lights); }

/* v turned by m, or back by it: m is a rotation times a scale, and so is what takes back, by one over the scale. */
static void turn(const float m[12], bool back, const double v[3], double out[3]) {
    double scale = back ? (double)m[0] * m[0] + (double)m[4] * m[4] + (double)m[8] * m[8] : 1;
    for (int k = 0; k < 3; k++)
        out[k] = (back ? m[k] * v[0] + m[4 + k] * v[1] + m[8 + k] * v[2]
                       : m[4 * k] * v[0] + m[4 * k + 1] * v[1] + m[4 * k + 2] * v[2]) /
                 scale;
}

static void take_back(const cpu_place *now, const cpu_place *then, int l, gblock *g) {
    double p[3] = { g->px[l], g->py[l], g->pz[l] }, n[3] = { g->nx[l], g->ny[l], g->nz[l] }, q[3], length = 0;
    for (int k = 0; k < 3; k++)
        p[k] -= now->transform[4 * k + 3];
    turn(now->transform, true, p, q);
    turn(then->transform, false, q, p);
    g->px[l] = (float)(p[0] + then->transform[3]);
    g->py[l] = (float)(p[1] + then->transform[7]);
    g->pz[l] = (float)(p[2] + then->transform[11]);
    turn(now->transform, true, n, q);
    turn(then->transform, false, q, n);
    for (int k = 0; k < 3; k++)
        length += n[k] * n[k];
    length = sqrt(length);
    g->nx[l] = (float)(n[0] / length);
    g->ny[l] = (float)(n[1] / length);
    g->nz[l] = (float)(n[2] / length);
}

/* Was the instance in the scene that the world followed before? */
static bool was_there(const cpu_world *w, uint32_t i) {
    return i < w->places[1].len && w->places[1].data[i].model &&
           w->places[1].data[i].model == w->places[0].data[i].model;
}

const gblock *noc_cpu_taken_back(const cpu_view *s, size_t at, const gblock *g, gblock *moved) {
    const cpu_world *w = s->world;
    if (!s->b.instance || noc_scene_shape(&s->seen) == w->shape)
        return g;
    *moved = *g;
    for (int l = 0; l < BLOCK; l++) {
        uint32_t i = s->b.instance[at][l];
        if (was_there(w, i))
            take_back(&w->places[0].data[i], &w->places[1].data[i], l, moved);
    }
    return moved;
}

uint32_t noc_cpu_known_before(const cpu_view *s, size_t at) {
    const cpu_world *w = s->world;
    uint64_t then = noc_scene_shape(&s->seen);
    uint32_t known = 0;
    if (!s->b.instance || then == w->shape)
        return 0xffff;
    for (int l = 0; l < BLOCK; l++) {
        uint32_t i = s->b.instance[at][l];
        known |= (uint32_t)(i == NO_INSTANCE || (w->past == then && was_there(w, i))) << l;
    }
    return known;
}
