/* Publishing what is staged: all memory is reserved first, and what follows cannot fail. */
#include "scene/facade.h"

#include <math.h>

/* What a commit needs beyond what is there. */
typedef struct need {
    size_t lights, moving, released_lights, released_instances, gaps;
    bool scales; /* a group is dimmed or coloured */
} need;

typedef struct commit {
    noc_scene *s;
    noc_material *materials; /* as they will be, those to be appended too; the scene's own where none changes */
    size_t first_mesh;       /* of those that have no lights yet */
    noc_changes changes;
} commit;

static const noc_scene nothing;
static const noc_scene *added(const noc_scene *s) { return s->added ? s->added : &nothing; }

static bool changes_materials(const noc_scene *s) {
    for (size_t i = 0; i < s->edits.len; i++)
        if (s->edits.data[i].kind == NOC_EDIT_MATERIAL || s->edits.data[i].kind == NOC_EDIT_CLASS)
            return true;
    return added(s)->materials.len > 0;
}

static void edit_class(noc_material *all, size_t count, const noc_edit *e) {
    for (size_t i = 0; i < count; i++)
        if ((uint32_t)all[i].cls == e->index && !noc_material_of_light(&all[i])) {
            memcpy(all[i].albedo, e->material.albedo, sizeof(all[i].albedo));
            all[i].f0 = e->material.f0;
            all[i].roughness = e->material.roughness;
            all[i].texture = e->material.texture;
        }
}

static bool make_materials(commit *c) {
    const noc_scene *s = c->s, *more = added(s);
    size_t count = s->materials.len + more->materials.len;
    c->materials = s->materials.data;
    if (!count || !changes_materials(s))
        return true;
    if (!(c->materials = noc_calloc(count, sizeof(*c->materials))))
        return false;
    if (s->materials.len)
        memcpy(c->materials, s->materials.data, s->materials.len * sizeof(*c->materials));
    if (more->materials.len)
        memcpy(c->materials + s->materials.len, more->materials.data, more->materials.len * sizeof(*c->materials));
    const noc_edit *last[NOC_CLASS_COUNT] = { 0 }; /* of each class: it overwrites those before it */
    for (size_t i = 0; i < s->edits.len; i++)
        if (s->edits.data[i].kind == NOC_EDIT_CLASS)
            last[s->edits.data[i].index] = &s->edits.data[i];
    for (size_t i = 0; i < s->edits.len; i++) {
        const noc_edit *e = &s->edits.data[i];
        if (e->kind == NOC_EDIT_MATERIAL)
            c->materials[e->index] = e->material;
        else if (e->kind == NOC_EDIT_CLASS && e == last[e->index])
            edit_class(c->materials, count, e);
    }
    return true;
}

/* Does what its meshes emit become another thing? */
static bool emits_anew(const commit *c, int material) {
    if (c->materials == c->s->materials.data || (size_t)material >= c->s->materials.len)
        return false;
    const noc_material *a = &c->s->materials.data[material], *b = &c->materials[material];
    bool shines = noc_material_shines(b);
    return shines != noc_material_shines(a) ||
           (shines && (memcmp(a->emission, b->emission, sizeof(a->emission)) || a->two_sided != b->two_sided));
}

/* Triangles of a mesh of the scene `of` that show no light yet. */
static size_t unlit(const noc_scene *of, const noc_scene_mesh *m) {
    size_t n = 0;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++)
        n += of->triangle_light.data[t] == NOC_NO_LIGHT;
    return n;
}

/* Lights of new meshes: in the world, or in their model, for which room is made here. */
static bool need_mesh_lights(const commit *c, noc_scene *of, size_t first, need *n) {
    for (size_t i = 0; i < of->models.len; i++)
        of->models.data[i].shining = 0;
    for (size_t i = first; i < of->meshes.len; i++) {
        const noc_scene_mesh *m = &of->meshes.data[i];
        noc_scene_model *model = noc_scene_model_of(c->s, m->model);
        size_t lights = noc_material_shines(&c->materials[m->material]) ? unlit(of, m) : 0;
        *(model ? &model->shining : &n->lights) += lights;
    }
    for (size_t i = 0; i < of->models.len; i++) {
        noc_scene_model *m = &of->models.data[i];
        if (m->shining && (!array_reserve(&m->lights, m->lights.len + m->shining) ||
                           !array_reserve(&m->light_names, m->lights.len + m->shining)))
            return false;
    }
    return true;
}

static size_t model_lights(const noc_scene *s, uint32_t model) {
    const noc_scene_model *m = noc_scene_model_of(s, (int)model);
    return m->lights.len + m->shining;
}

static bool need_edit(const noc_scene *s, noc_edit *e, need *n) {
    size_t lights;
    switch (e->kind) {
    case NOC_EDIT_GROUP: n->scales |= e->rgb[0] != 1 || e->rgb[1] != 1 || e->rgb[2] != 1; return true;
    case NOC_EDIT_GROUP_COLOUR: n->scales = true; return true;
    case NOC_EDIT_ADD_LIGHT: n->moving++; return true;
    case NOC_EDIT_REMOVE_LIGHT:
        n->released_lights++;
        n->gaps++;
        return true;
    case NOC_EDIT_REMOVE_MESH:
        n->released_lights += s->meshes.data[e->index].triangle_count;
        n->released_lights += noc_facade_windows(s, &s->meshes.data[e->index]);
        n->gaps++;
        return true;
    case NOC_EDIT_ADD_INSTANCE:
        lights = model_lights(s, e->model);
        n->lights += lights;
        n->moving += lights;
        return (e->lights = noc_calloc(NOC_MAX(lights, 1u), sizeof(*e->lights))) != NULL;
    case NOC_EDIT_REMOVE_INSTANCE:
        n->released_instances++;
        n->released_lights += model_lights(s, e->model);
        return true;
    default: return true;
    }
}

static void need_relit(const commit *c, need *n) {
    const noc_scene *s = c->s;
    for (size_t i = 0; c->materials != s->materials.data && i < c->first_mesh; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->removed || m->model || !emits_anew(c, m->material))
            continue;
        n->lights += unlit(s, m);
        n->released_lights += m->triangle_count - unlit(s, m);
    }
}

/* Lights are 64-byte aligned from the first commit on. There is room for one at least: an array without room is
 * another's (array_borrow). */
static bool reserve_lights(noc_scene *s, size_t count) {
    if (s->committed && count <= (s->lights.cap ? s->lights.cap : s->lights.len))
        return true;
    size_t room = s->committed ? NOC_MAX(count, s->lights.cap + s->lights.cap / 2) : NOC_MAX(count, 1);
    noc_light_record *more = noc_alloc_large(room, sizeof(*more));
    if (!more)
        return false;
    if (s->lights.len)
        memcpy(more, s->lights.data, s->lights.len * sizeof(*more));
    free(s->lights.cap ? s->lights.data : NULL);
    s->lights.data = more;
    s->lights.cap = room;
    return true;
}

static bool reserve_slots(noc_slots *slots, size_t released) {
    return array_reserve(&slots->released, released) && array_reserve(&slots->free, slots->free.len + released);
}

static bool reserve_shapes(noc_scene *s, size_t released) {
    bool ok = true;
    for (int kind = 0; ok && kind < NOC_SHAPE_KINDS; kind++)
        ok = reserve_slots(&s->shapes[kind], released);
    return ok;
}

static bool reserve_arrays(noc_scene *s, const need *n) {
    const noc_scene *more = added(s);
    size_t triangles = s->triangle_light.len + more->triangle_light.len,
           lights = s->lights.len + s->light_slots.fresh + n->lights;
    return array_reserve(&s->positions,
                         s->positions.len + more->positions.len + (more->positions.len > 0)) && /* Embree's */
           array_reserve(&s->indices, 3 * triangles) &&
           array_reserve(&s->triangle_material, triangles) && array_reserve(&s->triangle_light, triangles) &&
           array_reserve(&s->meshes, s->meshes.len + more->meshes.len) &&
           array_reserve(&s->uv, s->uv.len + more->uv.len) &&
           array_reserve(&s->gaps,
                         s->gaps.len + more->gaps.len + n->gaps + (s->reshaped ? s->reshaped->meshes.len : 0)) &&
           array_reserve(&s->materials, s->materials.len + more->materials.len) &&
           array_reserve(&s->material_records, s->materials.len + more->materials.len) &&
           array_reserve(&s->material_uses, s->materials.len + more->materials.len) &&
           array_reserve(&s->models, s->models.len + more->models.len) &&
           array_reserve(&s->instances, s->instances.len + s->instance_slots.fresh) && reserve_lights(s, lights) &&
           array_reserve(&s->light_names, lights) &&
           (!(s->scaled || n->scales) || array_reserve(&s->light_made, lights)) &&
           array_reserve(&s->moving, s->moving.len + n->moving + (s->committed ? n->lights : 0)) &&
           array_reserve(&s->dark_slots, s->dark_slots.len + n->released_lights) &&
           reserve_slots(&s->light_slots, s->dark_slots.len + n->released_lights) &&
           reserve_slots(&s->instance_slots, n->released_instances) && reserve_slots(&s->light_materials, n->gaps) &&
           reserve_shapes(s, n->gaps);
}

static bool reserve(commit *c) {
    noc_scene *s = c->s;
    need n = { 0 };
    bool ok = make_materials(c) && need_mesh_lights(c, s, c->first_mesh, &n) &&
              (!s->added || need_mesh_lights(c, s->added, 0, &n));
    for (size_t i = 0; ok && i < s->edits.len; i++)
        ok = need_edit(s, &s->edits.data[i], &n);
    if (ok)
        need_relit(c, &n);
    ok = ok && reserve_arrays(s, &n);
    for (size_t i = 0; !ok && i < s->edits.len; i++) {
        free(s->edits.data[i].lights);
        s->edits.data[i].lights = NULL;
    }
    return ok;
}

#define APPEND(a, b)                                                                                                   \
    do {                                                                                                               \
        if ((b)->len)                                                                                                  \
            memcpy((a)->data + (a)->len, (b)->data, (b)->len * sizeof(*(b)->data));                                    \
        (a)->len += (b)->len;                                                                                          \
    } while (0)

/* What was added since the last commit, behind what is there. */
static void append(commit *c) {
    noc_scene *s = c->s, *more = s->added;
    if (!more)
        return;
    size_t vertices = s->positions.len / 3, triangles = s->triangle_light.len, index = s->indices.len,
           mesh = s->meshes.len, uv = s->uv.len / 2;
    c->changes.geometry |= more->meshes.len || more->models.len;
    APPEND(&s->positions, &more->positions);
    APPEND(&s->indices, &more->indices);
    APPEND(&s->triangle_material, &more->triangle_material);
    APPEND(&s->triangle_light, &more->triangle_light);
    APPEND(&s->meshes, &more->meshes);
    APPEND(&s->uv, &more->uv);
    APPEND(&s->models, &more->models);
    APPEND(&s->material_uses, &more->material_uses);
    more->models.len = 0; /* they are the scene's now */
    for (; index < s->indices.len; index++)
        s->indices.data[index] += (uint32_t)vertices;
    for (; mesh < s->meshes.len; mesh++) {
        s->meshes.data[mesh].first_triangle += (uint32_t)triangles;
        s->meshes.data[mesh].first_vertex += (uint32_t)vertices;
        s->meshes.data[mesh].uv += s->meshes.data[mesh].uv ? (uint32_t)uv : 0;
    }
    for (size_t i = 0; i < more->gaps.len; i++) {
        const noc_scene_gap *g = &more->gaps.data[i];
        noc_scene_add_gap(s, triangles + g->first, g->end - g->first);
    }
    for (int k = 0; k < 3; k++) {
        s->bounds_min[k] = NOC_MIN(s->bounds_min[k], more->bounds_min[k]);
        s->bounds_max[k] = NOC_MAX(s->bounds_max[k], more->bounds_max[k]);
    }
    s->triangles_dropped += more->triangles_dropped;
    s->triangles_flat += more->triangles_flat;
    noc_scene_destroy(more);
    s->added = NULL;
}

/* Writes the materials as they will be, and lights their meshes. */
static void apply_materials(commit *c, size_t count) {
    noc_scene *s = c->s;
    noc_material *next = c->materials;
    if (next == s->materials.data)
        return;
    for (size_t i = 0; i < c->first_mesh; i++) {
        noc_scene_mesh *m = &s->meshes.data[i];
        if (m->removed || m->model || !emits_anew(c, m->material))
            continue;
        noc_material was = s->materials.data[m->material];
        s->materials.data[m->material] = next[m->material];
        noc_mesh_relight(s, m, &c->changes);
        s->materials.data[m->material] = was; /* other meshes are yet to be told apart */
    }
    for (size_t i = 0; i < count; i++) {
        s->lets_through |= noc_material_lets_through(&next[i]);
        bool fresh = i >= s->materials.len;
        noc_material *have = &s->materials.data[i];
        noc_material_record record = noc_material_record_of(&next[i]);
        if (!fresh && !memcmp(&record, &s->material_records.data[i], sizeof(record)) && have->cls == next[i].cls &&
            have->two_sided == next[i].two_sided && have->texture == next[i].texture &&
            have->transmittance == next[i].transmittance && have->cutout == next[i].cutout)
            continue;
        c->changes.ground_left |= !fresh && (have->cls != next[i].cls || have->cls == NOC_CLASS_LAMP);
        c->changes.materials = true;
        noc_range_add(&s->dirty_materials, i);
        *have = next[i];
        s->material_records.data[i] = record;
    }
    s->materials.len = s->material_records.len = count;
    free(next);
    c->materials = s->materials.data;
}

static void place_instance(commit *c, noc_edit *e) {
    noc_scene *s = c->s;
    noc_scene_model *model = &s->models.data[e->model - 1];
    noc_scene_instance *i = &s->instances.data[e->index];
    *i = (noc_scene_instance){ .model = e->model, .lights = e->lights };
    memcpy(i->transform, e->transform, sizeof(i->transform));
    e->lights = NULL;
    model->instances++;
    c->changes.instances = true;
    for (size_t k = 0; k < model->lights.len; k++) {
        noc_light_record r = noc_light_placed(&model->lights.data[k], i->transform);
        r.flags |= NOC_LIGHT_MOVES | NOC_LIGHT_OWNED;
        i->lights[k] = noc_light_take_slot(s);
        noc_light_put(s, i->lights[k], &r, model->light_names.data[k], &c->changes);
    }
}

static void move_instance(commit *c, const noc_edit *e) {
    noc_scene *s = c->s;
    noc_scene_instance *i = &s->instances.data[e->index];
    if (!i->model || !memcmp(i->transform, e->transform, sizeof(i->transform)))
        return;
    const noc_scene_model *model = &s->models.data[i->model - 1];
    memcpy(i->transform, e->transform, sizeof(i->transform));
    c->changes.instances = true;
    for (size_t k = 0; k < model->lights.len; k++) {
        noc_light_record have = noc_light_made(s, i->lights[k]),
                         r = noc_light_placed(&model->lights.data[k], i->transform);
        r.flags = have.flags;
        memcpy(r.e, have.e, sizeof(r.e));
        noc_light_change(s, i->lights[k], &r, &c->changes);
    }
}

static void remove_instance(commit *c, const noc_edit *e) {
    noc_scene *s = c->s;
    noc_scene_instance *i = &s->instances.data[e->index];
    if (!i->model)
        return;
    noc_scene_model *model = &s->models.data[i->model - 1];
    for (size_t k = 0; k < model->lights.len; k++)
        noc_light_release(s, i->lights[k], &c->changes);
    free(i->lights);
    noc_car_forget(s, e->index);
    *i = (noc_scene_instance){ .model = 0 };
    model->instances--;
    c->changes.instances = true;
    s->instance_slots.released.data[s->instance_slots.released.len++] = e->index;
}

static bool touches_bounds(const noc_scene *s, const noc_scene_mesh *m) {
    for (size_t i = 3 * (size_t)m->first_triangle; i < 3 * ((size_t)m->first_triangle + m->triangle_count); i++)
        for (int k = 0; k < 3; k++) {
            float x = s->positions.data[3 * (size_t)s->indices.data[i] + (size_t)k];
            if (x <= (float)s->bounds_min[k] || x >= (float)s->bounds_max[k])
                return true;
        }
    return false;
}

static void remove_mesh(commit *c, noc_scene_mesh *m) {
    noc_scene *s = c->s;
    if (m->removed)
        return;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        uint32_t light = s->triangle_light.data[t];
        if (light != NOC_NO_LIGHT && s->lights.data[light].flags & NOC_LIGHT_OWNED) {
            noc_light_release(s, light, &c->changes);
            noc_window_forget(s, light);
        }
    }
    noc_facades_remove(s, m, &c->changes);
    m->removed = true;
    noc_material_drop(s, m);
    c->changes.geometry = c->changes.mesh_left = c->changes.ground_left = true;
    if (s->backdrop_count && m->triangle_count && m->first_triangle == s->backdrop_first)
        s->backdrop_count = 0;
    else if (touches_bounds(s, m))
        s->bounds_min[0] = NAN; /* found anew when all are removed */
}

static void apply_edit(commit *c, noc_edit *e) {
    noc_scene *s = c->s;
    bool light = e->kind == NOC_EDIT_EMISSION || e->kind == NOC_EDIT_MOVE_LIGHT || e->kind == NOC_EDIT_REMOVE_LIGHT;
    if (light && s->lights.data[e->index].flags & NOC_LIGHT_FREE)
        return; /* removed by an edit before this one */
    noc_light_record r = light ? noc_light_made(s, e->index) : e->light;
    switch (e->kind) {
    case NOC_EDIT_CLASS:
        s->class_looks[e->index] = e->material;
        s->class_said |= 1u << e->index;
        break;
    case NOC_EDIT_MATERIAL:
    case NOC_EDIT_GROUP:
    case NOC_EDIT_GROUP_COLOUR: break; /* done before */
    case NOC_EDIT_EMISSION:
        memcpy(r.e, e->rgb, sizeof(r.e));
        noc_light_change(s, e->index, &r, &c->changes);
        break;
    case NOC_EDIT_ADD_LIGHT: noc_light_put(s, e->index, &r, e->name, &c->changes); break;
    case NOC_EDIT_MOVE_LIGHT: noc_light_change(s, e->index, &e->light, &c->changes); break;
    case NOC_EDIT_REMOVE_LIGHT:
        c->changes.shape_left = true;
        noc_light_release(s, e->index, &c->changes);
        break;
    case NOC_EDIT_REMOVE_MESH: remove_mesh(c, &s->meshes.data[e->index]); break;
    case NOC_EDIT_ADD_INSTANCE: place_instance(c, e); break;
    case NOC_EDIT_TRANSFORM: move_instance(c, e); break;
    case NOC_EDIT_REMOVE_INSTANCE: remove_instance(c, e); break;
    case NOC_EDIT_WINDOWS: noc_windows_switch(s, &e->windows, &c->changes); break;
    }
}

/* Meshes that show a light which is no more: one look at all of them, however many lights went. */
static void remove_shapes(commit *c) {
    noc_scene *s = c->s;
    for (size_t i = 0; i < s->meshes.len; i++) {
        noc_scene_mesh *m = &s->meshes.data[i];
        uint32_t light = m->triangle_count && !m->model ? s->triangle_light.data[m->first_triangle] : NOC_NO_LIGHT;
        if (!m->removed && light != NOC_NO_LIGHT && s->lights.data[light].flags & NOC_LIGHT_FREE) {
            remove_mesh(c, m);
            noc_shape_release(s, i);
        }
    }
}

static void find_bounds(noc_scene *s) {
    for (int k = 0; k < 3; k++) {
        s->bounds_min[k] = INFINITY;
        s->bounds_max[k] = -INFINITY;
    }
    for (size_t j = 0; j < s->meshes.len; j++) {
        const noc_scene_mesh *m = &s->meshes.data[j];
        size_t first = 3 * (size_t)m->first_triangle, end = first + 3 * (size_t)m->triangle_count;
        for (size_t i = first; noc_mesh_in_city(s, m) && !noc_mesh_closes(s, m) && i < end; i++)
            for (int k = 0; k < 3; k++) {
                double x = s->positions.data[3 * (size_t)s->indices.data[i] + (size_t)k];
                s->bounds_min[k] = NOC_MIN(s->bounds_min[k], x);
                s->bounds_max[k] = NOC_MAX(s->bounds_max[k], x);
            }
    }
    noc_join_body_bounds(s, s->bounds_min, s->bounds_max);
}

static void find_gaps(noc_scene *s) {
    s->gaps.len = 0;
    for (size_t i = 0; i < s->meshes.len; i++)
        if (!noc_mesh_in_city(s, &s->meshes.data[i]))
            noc_scene_add_gap(s, s->meshes.data[i].first_triangle, s->meshes.data[i].triangle_count);
}

static void settle_slots(noc_slots *slots) {
    slots->free.len -= slots->taken;
    APPEND(&slots->free, &slots->released);
    slots->taken = slots->fresh = 0;
    slots->released.len = 0;
}

static void count_versions(noc_scene_versions *v, const noc_changes *c) {
    v->geometry += c->geometry;
    v->instances += c->instances;
    v->materials += c->materials;
    v->lights += c->lights;
    v->moved += c->moved;
    v->emission += c->emission;
    v->standing += c->standing;
    v->settled += c->settled;
    v->commits += c->geometry || c->instances || c->materials || c->lights || c->moved || c->emission;
}

static void settle(commit *c) {
    noc_scene *s = c->s;
    if (c->changes.shape_left)
        remove_shapes(c);
    if (c->changes.lights)
        noc_lights_settle(s, &c->changes);
    if (c->changes.mesh_left)
        find_gaps(s);
    if (isnan(s->bounds_min[0]))
        find_bounds(s);
    if (c->changes.ground_left) {
        noc_ground_free(s->ground);
        s->ground = NULL;
    }
    settle_slots(&s->light_slots);
    settle_slots(&s->instance_slots);
    settle_slots(&s->light_materials);
    for (int kind = 0; kind < NOC_SHAPE_KINDS; kind++)
        settle_slots(&s->shapes[kind]);
    s->edits.len = 0;
    s->later_bytes = s->later_names.bytes;
    if (s->committed) { /* which is written once: others ask it without the lock */
        count_versions(&s->versions, &c->changes);
        return;
    }
    s->first_later = s->meshes.len;
    s->committed = true;
}

static void apply(commit *c) {
    noc_scene *s = c->s;
    size_t materials = noc_scene_material_count(s);
    noc_range lights = s->dirty_lights, changed = s->dirty_materials;
    uint64_t commits = s->versions.commits;
    s->dirty_lights = s->dirty_materials = (noc_range){ 0, 0 };
    append(c);
    for (uint32_t i = 0; i < s->instance_slots.fresh; i++)
        s->instances.data[s->instances.len++] = (noc_scene_instance){ .model = 0 };
    for (uint32_t i = 0; i < s->light_slots.fresh; i++) /* those that were promised come before others */
        noc_light_add_slot(s);
    apply_materials(c, materials);
    noc_shapes_put(s, &c->changes);
    for (size_t i = c->first_mesh; i < s->meshes.len; i++) {
        noc_material_use(s, &s->meshes.data[i]);
        if (s->meshes.data[i].model)
            noc_model_relight(s, &s->meshes.data[i]);
        else
            noc_mesh_relight(s, &s->meshes.data[i], &c->changes);
    }
    noc_lights_scale(s, &c->changes);
    for (size_t i = 0; i < s->edits.len; i++)
        apply_edit(c, &s->edits.data[i]);
    settle(c);
    if (s->versions.commits == commits && commits) { /* nothing has changed: followers have not been told to look */
        s->dirty_lights = lights;
        s->dirty_materials = changed;
    }
}

noc_status noc_scene_commit(noc_scene *scene) {
    if (!scene)
        return NOC_ERR_ARGUMENT;
    if (scene->committed && !scene->edits.len && !scene->added)
        return NOC_OK;
    if (scene->no_memory) /* reported already */
        return NOC_ERR_MEMORY;
    commit c = { .s = scene, .first_mesh = scene->committed ? scene->meshes.len : 0 };
    noc_scene_lock_commit(scene);
    bool done = reserve(&c);
    if (done)
        apply(&c);
    else if (c.materials != scene->materials.data)
        free(c.materials);
    noc_scene_unlock_commit(scene);
    return done ? NOC_OK : noc_scene_out_of_memory(scene);
}
