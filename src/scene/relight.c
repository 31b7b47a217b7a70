/* Slots of lights: what commit puts into them, changes, and takes out.
 *
 * What stands is dear to make structures of. So lights that are added after the first commit are of the half that is
 * made anew with every change, and those of the standing half that are removed stay there, dark. Once there are many of
 * either the standing half is settled: it takes in what was added, and forgets what went. */
#include "scene/scene.h"

static const noc_light_record free_slot = { .kind = NOC_LIGHT_POINT, .flags = NOC_LIGHT_FREE };

uint32_t noc_light_add_slot(noc_scene *s) {
    s->lights.data[s->lights.len++] = free_slot;
    s->light_names.data[s->light_names.len++] = NULL;
    if (s->scaled)
        s->light_made.data[s->light_made.len++] = (noc_rgb){ { 0, 0, 0 } };
    return (uint32_t)s->lights.len - 1;
}

uint32_t noc_light_take_slot(noc_scene *s) {
    noc_slots *slots = &s->light_slots;
    return slots->taken < slots->free.len ? slots->free.data[slots->free.len - 1 - slots->taken++]
                                          : noc_light_add_slot(s);
}

/* What a group makes of an emission: its own colour of the same luminance, then scaled. */
static void shine_as_group(const noc_scene_group *g, float e[3]) {
    float luminance = 0.2126f * e[0] + 0.7152f * e[1] + 0.0722f * e[2];
    bool coloured = g->colour[0] > 0 || g->colour[1] > 0 || g->colour[2] > 0;
    for (int k = 0; k < 3; k++)
        e[k] = (coloured ? luminance * g->colour[k] : e[k]) * g->scale[k];
}

/* Writes a slot's record: `made`, as its group has it. */
static void write_record(noc_scene *s, uint32_t slot, const noc_light_record *made) {
    noc_light_record *r = &s->lights.data[slot];
    uint32_t group = noc_light_group(made);
    *r = *made;
    if (s->scaled)
        memcpy(s->light_made.data[slot].v, made->e, sizeof(made->e));
    if (group)
        shine_as_group(&s->groups.data[group - 1], r->e);
    noc_range_add(&s->dirty_lights, slot);
}

void noc_light_put(noc_scene *s, uint32_t slot, const noc_light_record *made, const char *name, noc_changes *c) {
    noc_light_record r = *made;
    if (s->committed && !(r.flags & NOC_LIGHT_MOVES)) {
        r.flags |= NOC_LIGHT_LATER;
        s->later++;
    }
    write_record(s, slot, &r);
    s->light_names.data[slot] = name;
    s->lights_inferred += (r.flags & NOC_LIGHT_INFERRED) != 0;
    if (!noc_light_stands(r.flags)) {
        s->moving.data[s->moving.len++] = slot;
        c->moving_came = true;
    }
    c->lights = true;
}

void noc_light_release(noc_scene *s, uint32_t slot, noc_changes *c) {
    uint32_t flags = s->lights.data[slot].flags;
    bool stood = noc_light_stands(flags);
    s->lights_inferred -= (flags & NOC_LIGHT_INFERRED) != 0;
    s->later -= (flags & NOC_LIGHT_LATER) != 0;
    c->standing |= stood;
    c->lights = true;
    write_record(s, slot, &free_slot);
    if (noc_body_of(s, slot)) /* which shows no other light instead */
        return;
    s->light_names.data[slot] = NULL;
    if (stood)
        s->dark_slots.data[s->dark_slots.len++] = slot;
    else
        s->light_slots.released.data[s->light_slots.released.len++] = slot;
}

noc_light_record noc_light_made(const noc_scene *s, uint32_t slot) {
    noc_light_record r = s->lights.data[slot];
    if (s->scaled)
        memcpy(r.e, s->light_made.data[slot].v, sizeof(r.e));
    return r;
}

void noc_light_change(noc_scene *s, uint32_t slot, const noc_light_record *made, noc_changes *c) {
    noc_light_record before = s->lights.data[slot], to = *made, have = noc_light_made(s, slot);
    if (!memcmp(&have, &to, sizeof(to)))
        return;
    write_record(s, slot, &to);
    const noc_light_record *now = &s->lights.data[slot];
    bool spot = now->kind == NOC_LIGHT_SPOT; /* its cones say how much of its intensity leaves it */
    bool power = memcmp(before.e, now->e, sizeof(now->e)) || before.area != now->area || before.flags != now->flags ||
                 (spot && memcmp(before.b, now->b, sizeof(now->b)));
    bool stands = noc_light_stands(now->flags), another = before.flags != now->flags;
    c->lights |= another; /* it shines another way: as another light would */
    c->settled |= another && stands;
    c->emission |= power;
    c->standing |= power && stands;
    c->moved |= memcmp(before.p, now->p, sizeof(now->p)) || memcmp(before.a, now->a, sizeof(now->a)) ||
                memcmp(before.b, now->b, sizeof(now->b)) || before.radius != now->radius;
}

/* Gives each group the last scale and the last colour that were staged for it. Was any of them another one before? */
static bool edit_groups(noc_scene *s) {
    bool any = false;
    for (size_t i = s->edits.len; i-- > 0;) {
        const noc_edit *e = &s->edits.data[i];
        bool scale = e->kind == NOC_EDIT_GROUP;
        if (!scale && e->kind != NOC_EDIT_GROUP_COLOUR)
            continue;
        noc_scene_group *g = &s->groups.data[e->index - 1];
        float *to = scale ? g->scale : g->colour;
        bool *told = scale ? &g->scaled : &g->coloured;
        if (*told)
            continue;
        *told = true;
        g->edited |= memcmp(to, e->rgb, sizeof(e->rgb)) != 0;
        memcpy(to, e->rgb, sizeof(e->rgb));
        any |= g->edited;
    }
    return any;
}

void noc_lights_scale(noc_scene *s, noc_changes *c) {
    bool any = edit_groups(s);
    if (any && !s->scaled)
        for (; s->light_made.len < s->lights.len; s->light_made.len++)
            memcpy(s->light_made.data[s->light_made.len].v, s->lights.data[s->light_made.len].e, sizeof(noc_rgb));
    s->scaled |= any;
    for (uint32_t i = 0; any && i < s->lights.len; i++) {
        uint32_t group = noc_light_group(&s->lights.data[i]);
        if (!group || !s->groups.data[group - 1].edited)
            continue;
        noc_light_record made = noc_light_made(s, i);
        write_record(s, i, &made);
        c->emission = true;
        c->standing |= noc_light_stands(made.flags);
    }
    for (size_t i = 0; i < s->groups.len; i++)
        s->groups.data[i].scaled = s->groups.data[i].coloured = s->groups.data[i].edited = false;
}

static noc_light_record light_of(const noc_scene *s, const noc_scene_mesh *m, size_t t) {
    const uint32_t *v = s->indices.data + 3 * t;
    const float *p = s->positions.data;
    noc_light_record r = noc_triangle_light(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2],
                                            &s->materials.data[m->material]);
    r.flags |= (uint32_t)m->group << NOC_LIGHT_GROUP;
    return r;
}

void noc_mesh_relight(noc_scene *s, const noc_scene_mesh *m, noc_changes *c) {
    bool shines = noc_material_shines(&s->materials.data[m->material]);
    if (m->panes)
        return; /* its windows shine, and are switched by themselves */
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        uint32_t *light = &s->triangle_light.data[t];
        bool lit = *light != NOC_NO_LIGHT;
        if (lit && !(s->lights.data[*light].flags & NOC_LIGHT_OWNED))
            continue; /* it shows a light that was added as one */
        if (!shines) {
            if (lit)
                noc_light_release(s, *light, c);
            *light = NOC_NO_LIGHT;
            continue;
        }
        noc_light_record r = light_of(s, m, t);
        if (lit) {
            r.flags |= s->lights.data[*light].flags & NOC_LIGHT_LATER;
            noc_light_change(s, *light, &r, c);
        } else {
            *light = noc_light_take_slot(s);
            noc_light_put(s, *light, &r, m->name, c);
        }
    }
}

static int by_index(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* So many lights that were added or went are kept beside those that stand: what is made anew with each change stays
 * small, and settling costs each of them no more than these many that stand. */
enum { LEAST_LATER = 1024, SHARE_LATER = 64 };

void noc_lights_settle(noc_scene *s, noc_changes *c) {
    bool many = s->later + s->dark_slots.len > NOC_MAX((size_t)LEAST_LATER, s->lights.len / SHARE_LATER);
    size_t kept = 0;
    c->settled |= s->committed && many;
    for (size_t i = 0; i < s->moving.len; i++) {
        uint32_t slot = s->moving.data[i];
        noc_light_record *r = &s->lights.data[slot];
        if (c->settled && r->flags & NOC_LIGHT_LATER) {
            r->flags &= ~NOC_LIGHT_LATER;
            noc_range_add(&s->dirty_lights, slot);
        }
        if (!noc_light_stands(r->flags))
            s->moving.data[kept++] = slot;
    }
    s->moving.len = kept;
    if (c->moving_came)
        qsort(s->moving.data, kept, sizeof(*s->moving.data), by_index);
    if (!c->settled)
        return;
    for (size_t i = 0; i < s->dark_slots.len; i++)
        s->light_slots.released.data[s->light_slots.released.len++] = s->dark_slots.data[i];
    s->dark_slots.len = s->later = 0;
    c->lights = c->standing = true;
}

void noc_model_relight(noc_scene *s, const noc_scene_mesh *m) {
    noc_scene_model *model = &s->models.data[m->model - 1];
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        uint32_t *light = &s->triangle_light.data[t];
        if (*light != NOC_NO_LIGHT || !noc_material_shines(&s->materials.data[m->material]))
            continue;
        *light = (uint32_t)model->lights.len;
        model->lights.data[model->lights.len++] = light_of(s, m, t);
        model->light_names.data[model->light_names.len++] = m->name;
    }
}
