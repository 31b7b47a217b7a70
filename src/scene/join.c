/* Scenes into one. Meshes, lights and all that stands somewhere are appended, with numbers of the scene that they come
 * to; what follows from them is made in the end. */
#include "scene/facade.h"
#include "scene/join.h"

#include <math.h>

static void move(const noc_joiner *j, const float from[3], float to[3]) {
    for (int k = 0; k < 3; k++)
        to[k] = (float)(from[k] + j->shift[k]);
}

/* ---- what is taken ---- */

static noc_mesh_choice chosen(const noc_joiner *j, size_t mesh) {
    const noc_scene *s = j->from;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    bool backdrop = s->backdrop_count && m->first_triangle == s->backdrop_first && m->triangle_count;
    if (m->model || m->removed || backdrop)
        return NOC_MESH_LEAVE;
    if (!j->choice)
        return NOC_MESH_TAKE;
    uint32_t light = m->triangle_count ? s->triangle_light.data[m->first_triangle] : NOC_NO_LIGHT;
    if (light != NOC_NO_LIGHT && !(s->lights.data[light].flags & NOC_LIGHT_OWNED))
        return j->choice->lights[light] ? NOC_MESH_TAKE : NOC_MESH_LEAVE;
    return (noc_mesh_choice)j->choice->meshes[mesh];
}

enum { LEFT = NOC_JOIN_NONE, TAKEN = 0 };

/* Windows that lie in a wall that is taken. */
static void choose_windows(noc_joiner *j, const noc_scene_mesh *m) {
    const noc_scene *s = j->from;
    const noc_facade_record *last = NULL;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        const noc_facade_record *f = noc_scene_facade_of(s, t);
        if (f == last)
            continue;
        last = f;
        for (size_t i = 0; f && i < (size_t)f->columns * f->rows; i++)
            if (s->facade_cells.data[f->first + i] != NOC_NO_LIGHT)
                j->light[s->facade_cells.data[f->first + i]] = TAKEN;
    }
}

/* Lights that come with what is taken. */
static void choose_lights(noc_joiner *j) {
    const noc_scene *s = j->from;
    for (size_t i = 0; i < s->lights.len; i++) {
        uint32_t flags = s->lights.data[i].flags;
        bool lamp = !(flags & (NOC_LIGHT_OWNED | NOC_LIGHT_FREE));
        j->light[i] = lamp && (!j->choice || j->choice->lights[i]) ? TAKEN : LEFT;
    }
    for (size_t m = 0; m < s->meshes.len; m++)
        for (size_t t = s->meshes.data[m].first_triangle, n = s->meshes.data[m].triangle_count;
             n && j->mesh[m] == NOC_MESH_TAKE; t++, n--)
            if (s->triangle_light.data[t] != NOC_NO_LIGHT)
                j->light[s->triangle_light.data[t]] = TAKEN;
    for (size_t m = 0; m < s->meshes.len; m++)
        if (j->mesh[m] == NOC_MESH_TAKE)
            choose_windows(j, &s->meshes.data[m]);
    for (size_t i = 0; i < s->instances.len; i++)
        for (size_t k = 0; j->instance[i] == TAKEN && k < s->models.data[s->instances.data[i].model - 1].lights.len;
             k++)
            j->light[s->instances.data[i].lights[k]] = TAKEN;
    for (size_t i = 0; i < s->bodies.len; i++) { /* dark ones among them */
        const noc_scene_body *b = &s->bodies.data[i];
        bool taken = !j->choice || j->choice->lights[b->light];
        for (uint32_t k = 0; k < s->models.data[b->model - 1].shown; k++)
            j->light[b->light + k] = taken ? TAKEN : LEFT;
    }
}

static void choose(noc_joiner *j) {
    const noc_scene *s = j->from;
    for (size_t m = 0; m < s->meshes.len; m++)
        j->mesh[m] = chosen(j, m);
    for (size_t i = 0; i < s->instances.len; i++)
        j->instance[i] = s->instances.data[i].model && (!j->choice || j->choice->instances[i]) ? TAKEN : LEFT;
    choose_lights(j);
}

/* ---- lights and windows ---- */

/* Emission before groups scale it is kept where a group does. */
static bool join_made(noc_joiner *j) {
    noc_scene *to = j->to;
    if (!j->from->scaled && !to->scaled)
        return true;
    to->scaled = true;
    if (!array_reserve(&to->light_made, to->lights.len))
        return noc_join_no_memory(j);
    for (size_t i = to->light_made.len; i < to->lights.len; i++)
        memcpy(to->light_made.data[i].v, to->lights.data[i].e, sizeof(to->light_made.data[i].v));
    to->light_made.len = to->lights.len;
    return true;
}

static bool join_light(noc_joiner *j, size_t light) {
    noc_scene *to = j->to;
    noc_light_record r = j->from->lights.data[light];
    const char *name;
    if (to->lights.len >= INT32_MAX - 1)
        return noc_join_too_many(j, "lights");
    j->light[light] = (uint32_t)to->lights.len;
    if (!noc_join_light(j, &r) || !noc_join_name(j, j->from->light_names.data[light], &name))
        return false;
    move(j, r.p, r.p);
    noc_rgb made = { { r.e[0], r.e[1], r.e[2] } };
    if (j->from->scaled)
        made = j->from->light_made.data[light];
    return (array_push(&to->lights, r) && array_push(&to->light_names, name) &&
            (!to->scaled || array_push(&to->light_made, made))) ||
           noc_join_no_memory(j);
}

static bool join_lights(noc_joiner *j) {
    bool ok = join_made(j);
    for (size_t i = 0; ok && i < j->from->lights.len; i++)
        ok = j->light[i] == LEFT || join_light(j, i);
    return ok;
}

static bool join_windows(noc_joiner *j, bool *taken) {
    for (size_t i = 0; i < j->from->windows.len; i++) {
        noc_scene_window w = j->from->windows.data[i];
        bool there = !w.removed && j->light[w.light] != LEFT;
        if (taken)
            taken[i] = there;
        w.light = j->light[w.light];
        w.facade = w.facade ? j->facade[w.facade - 1] : 0;
        if (there && !array_push(&j->to->windows, w))
            return noc_join_no_memory(j);
    }
    return true;
}

/* ---- meshes ---- */

/* A facade with its windows, as part of the mesh that is to come. */
static bool join_facade(noc_joiner *j, size_t facade) {
    noc_scene *to = j->to;
    noc_facade_record f = j->from->facades.data[facade];
    size_t from = f.first, first = to->facade_cells.len, cells = (size_t)f.columns * f.rows;
    f.material = noc_join_material(j, f.material);
    if (f.material == NOC_JOIN_NONE)
        return false;
    if (first + cells >= UINT32_MAX || to->facades.len >= INT32_MAX)
        return noc_join_too_many(j, "facades");
    move(j, f.origin, f.origin);
    f.first = (uint32_t)first;
    f.mesh = (uint32_t)to->meshes.len;
    if (!array_push(&to->facades, f) || !array_reserve(&to->facade_cells, first + cells))
        return noc_join_no_memory(j);
    for (size_t i = from; i < from + cells; i++) {
        uint32_t light = j->from->facade_cells.data[i];
        to->facade_cells.data[to->facade_cells.len++] = light == NOC_NO_LIGHT ? light : j->light[light];
    }
    j->facade[facade] = (uint32_t)to->facades.len;
    return true;
}

/* Verdicts on walls, and their facades, lie as triangles do; those behind the end of either have none. */
static bool join_walls(noc_joiner *j, const noc_scene_mesh *m) {
    noc_scene *to = j->to;
    const noc_scene *s = j->from;
    size_t first = to->triangle_light.len, end = first + m->triangle_count;
    if (m->model || m->first_triangle >= NOC_MAX(s->walls.len, s->triangle_facade.len))
        return true;
    if (!array_reserve(&to->walls, end) || !array_reserve(&to->triangle_facade, end))
        return noc_join_no_memory(j);
    while (to->walls.len < first)
        to->walls.data[to->walls.len++] = NOC_WALL_UNSEEN;
    while (to->triangle_facade.len < first)
        to->triangle_facade.data[to->triangle_facade.len++] = 0;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        uint32_t f = t < s->triangle_facade.len ? s->triangle_facade.data[t] : 0;
        if (f && j->facade[f - 1] == NOC_JOIN_NONE && !join_facade(j, f - 1))
            return false;
        to->triangle_facade.data[to->triangle_facade.len++] = f ? j->facade[f - 1] : 0;
        to->walls.data[to->walls.len++] = (uint8_t)noc_scene_wall(s, t);
    }
    return true;
}

/* Room for a mesh of so many triangles and vertices. */
static bool reserve(noc_joiner *j, size_t triangles, size_t vertices, bool uv) {
    noc_scene *to = j->to;
    size_t all = to->triangle_light.len + triangles;
    if (all >= UINT32_MAX || to->positions.len / 3 + vertices > UINT32_MAX || to->meshes.len >= INT32_MAX)
        return noc_join_too_many(j, "triangles");
    return (array_reserve(&to->positions, to->positions.len + 3 * vertices + 1) && /* Embree's */
            array_reserve(&to->indices, 3 * all) && array_reserve(&to->triangle_material, all) &&
            array_reserve(&to->triangle_light, all) && array_reserve(&to->meshes, to->meshes.len + 1) &&
            (!uv || array_reserve(&to->uv, to->uv.len + 2 * vertices))) ||
           noc_join_no_memory(j);
}

static void widen(noc_scene *to, const float p[3]) {
    for (int k = 0; k < 3; k++) {
        to->bounds_min[k] = NOC_MIN(to->bounds_min[k], (double)p[k]);
        to->bounds_max[k] = NOC_MAX(to->bounds_max[k], (double)p[k]);
    }
}

/* As it is in `to`, with nothing in it yet. */
static bool begin_mesh(noc_joiner *j, const noc_scene_mesh *m, uint32_t model, noc_scene_mesh *made) {
    noc_scene *to = j->to;
    uint32_t material = noc_join_material(j, (uint32_t)m->material);
    *made = (noc_scene_mesh){ .first_triangle = (uint32_t)to->triangle_light.len,
                              .first_vertex = (uint32_t)(to->positions.len / 3),
                              .material = (int)material,
                              .model = (uint16_t)model,
                              .group = (uint16_t)j->group[m->group],
                              .panes = m->panes };
    if (m->uv)
        made->uv = (uint32_t)(to->uv.len / 2) + 1;
    return material != NOC_JOIN_NONE && noc_join_name(j, m->name, &made->name);
}

static void push_triangle(noc_scene *to, const noc_scene_mesh *made, const uint32_t corner[3], uint32_t light) {
    for (int i = 0; i < 3; i++)
        to->indices.data[to->indices.len++] = corner[i];
    to->triangle_material.data[to->triangle_material.len++] = (uint32_t)made->material;
    to->triangle_light.data[to->triangle_light.len++] = light;
}

bool noc_join_mesh(noc_joiner *j, size_t mesh, uint32_t model) {
    noc_scene *to = j->to;
    const noc_scene *s = j->from;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    size_t vertices = noc_mesh_end_vertex(s, mesh) - m->first_vertex;
    noc_scene_mesh made;
    if (!begin_mesh(j, m, model, &made) || !reserve(j, m->triangle_count, vertices, m->uv) || !join_walls(j, m))
        return false;
    made.triangle_count = m->triangle_count;
    for (size_t v = m->first_vertex; v < m->first_vertex + vertices; v++) {
        float *p = to->positions.data + to->positions.len;
        to->positions.len += 3;
        if (model)
            memcpy(p, s->positions.data + 3 * v, 3 * sizeof(*p));
        else
            move(j, s->positions.data + 3 * v, p);
    }
    if (m->uv && vertices)
        memcpy(to->uv.data + to->uv.len, s->uv.data + 2 * (size_t)(m->uv - 1), 2 * vertices * sizeof(float));
    to->uv.len += m->uv ? 2 * vertices : 0;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
        const uint32_t *v = s->indices.data + 3 * t;
        uint32_t light = s->triangle_light.data[t];
        const uint32_t corner[3] = { v[0] - m->first_vertex + made.first_vertex,
                                     v[1] - m->first_vertex + made.first_vertex,
                                     v[2] - m->first_vertex + made.first_vertex };
        push_triangle(to, &made, corner, model || light == NOC_NO_LIGHT ? light : j->light[light]);
        for (int i = 0; !model && !noc_mesh_closes(s, m) && i < 3; i++)
            widen(to, to->positions.data + 3 * (size_t)corner[i]);
    }
    to->meshes.data[to->meshes.len++] = made;
    return true;
}

/* The part of a mesh that is chosen, whose triangles have corners of their own. */
static bool join_cut(noc_joiner *j, size_t mesh) {
    noc_scene *to = j->to;
    const noc_scene_mesh *m = &j->from->meshes.data[mesh];
    const float *xyz, *uv;
    size_t count;
    noc_scene_mesh made;
    if (!j->choice->cut(j->choice->ctx, j->from, mesh, &count, &xyz, &uv))
        return noc_join_no_memory(j);
    if (!count)
        return true;
    if (!begin_mesh(j, m, 0, &made) || !reserve(j, count, 3 * count, m->uv))
        return false;
    made.triangle_count = (uint32_t)count;
    for (size_t t = 0; t < count; t++) {
        uint32_t corner[3];
        for (uint32_t i = 0; i < 3; i++) {
            corner[i] = (uint32_t)(to->positions.len / 3);
            float *p = to->positions.data + to->positions.len;
            to->positions.len += 3;
            move(j, xyz + 9 * t + 3 * i, p);
            if (!noc_mesh_closes(j->from, m))
                widen(to, p);
        }
        push_triangle(to, &made, corner, NOC_NO_LIGHT);
    }
    if (m->uv)
        memcpy(to->uv.data + to->uv.len, uv, 6 * count * sizeof(float));
    to->uv.len += m->uv ? 6 * count : 0;
    to->meshes.data[to->meshes.len++] = made;
    return true;
}

static bool join_meshes(noc_joiner *j) {
    bool ok = true;
    for (size_t i = 0; ok && i < j->from->meshes.len; i++)
        ok = j->mesh[i] == NOC_MESH_CUT ? join_cut(j, i) : j->mesh[i] != NOC_MESH_TAKE || noc_join_mesh(j, i, 0);
    return ok;
}

/* ---- bodies, instances, cars, streets ---- */

static bool join_bodies(noc_joiner *j) {
    noc_scene *to = j->to;
    for (size_t i = 0; i < j->from->bodies.len; i++) {
        noc_scene_body b = j->from->bodies.data[i];
        if (j->light[b.light] == LEFT)
            continue;
        b.model = noc_join_model(j, b.model);
        if (b.model == NOC_JOIN_NONE)
            return false;
        b.light = j->light[b.light];
        move(j, b.p, b.p);
        noc_scene_model *m = &to->models.data[b.model - 1];
        if (to->bodies.len >= INT32_MAX - 1)
            return noc_join_too_many(j, "lamps");
        if (!array_push(&to->bodies, b))
            return noc_join_no_memory(j);
        m->instances++;
        noc_join_body_box(&b, m, to->bounds_min, to->bounds_max);
    }
    return true;
}

static bool join_instance(noc_joiner *j, size_t number) {
    noc_scene *to = j->to;
    const noc_scene_instance *of = &j->from->instances.data[number];
    noc_scene_instance made = { .model = noc_join_model(j, of->model) };
    if (made.model == NOC_JOIN_NONE)
        return false;
    noc_scene_model *m = &to->models.data[made.model - 1];
    memcpy(made.transform, of->transform, sizeof(made.transform));
    for (int k = 0; k < 3; k++)
        made.transform[4 * k + 3] = (float)(of->transform[4 * k + 3] + j->shift[k]);
    if (to->instances.len >= INT32_MAX - 1)
        return noc_join_too_many(j, "instances");
    made.lights = noc_calloc(NOC_MAX(m->lights.len, (size_t)1), sizeof(*made.lights));
    if (!made.lights || !array_push(&to->instances, made)) {
        free(made.lights);
        return noc_join_no_memory(j);
    }
    for (size_t i = 0; i < m->lights.len; i++)
        made.lights[i] = j->light[of->lights[i]];
    m->instances++;
    noc_join_instance_bounds(to, &made, to->bounds_min, to->bounds_max);
    j->instance[number] = (uint32_t)to->instances.len - 1;
    return true;
}

static bool join_route(noc_joiner *j, uint32_t route) {
    noc_scene *to = j->to;
    const noc_scene_route *r = &j->from->routes.data[route];
    size_t first = to->stops.len;
    if (!noc_join_spend(j, &j->stops_left, r->count))
        return false;
    if (!array_append(&to->stops, j->from->stops.data + r->first, r->count) ||
        !array_push(&to->routes, ((noc_scene_route){ first, r->count })))
        return noc_join_no_memory(j);
    for (size_t i = first; i < to->stops.len; i++)
        move(j, to->stops.data[i].p, to->stops.data[i].p);
    j->route[route] = (uint32_t)to->routes.len - 1;
    return true;
}

static bool join_instances(noc_joiner *j) {
    bool ok = true;
    for (size_t i = 0; ok && i < j->from->instances.len; i++)
        ok = j->instance[i] == LEFT || join_instance(j, i);
    for (size_t i = 0; ok && i < j->from->cars.len; i++) {
        noc_scene_car car = j->from->cars.data[i];
        if (j->instance[car.instance] == LEFT)
            continue;
        if (j->route[car.route] == NOC_JOIN_NONE && !join_route(j, car.route))
            return false;
        car.instance = j->instance[car.instance];
        car.route = j->route[car.route];
        ok = array_push(&j->to->cars, car) || noc_join_no_memory(j);
    }
    return ok;
}

static bool join_streets(noc_joiner *j) {
    noc_scene *to = j->to;
    const noc_scene *s = j->from;
    for (size_t i = 0; i < s->streets.len; i++) {
        noc_scene_street street = s->streets.data[i];
        if (j->choice && !j->choice->streets[i])
            continue;
        const float *xy = s->street_points.data + 2 * (size_t)street.first;
        size_t first = to->street_points.len / 2;
        if (first + street.count > UINT32_MAX)
            return noc_join_too_many(j, "streets");
        street.first = (uint32_t)first;
        size_t numbers = 2 * (size_t)street.count;
        if (!noc_join_name(j, street.name, &street.name) || !noc_join_name(j, street.id, &street.id))
            return false;
        if (!array_append(&to->street_points, xy, numbers) || !array_push(&to->streets, street))
            return noc_join_no_memory(j);
        for (size_t k = 2 * first; k < to->street_points.len; k++)
            to->street_points.data[k] = (float)(to->street_points.data[k] + j->shift[k % 2]);
    }
    return true;
}

/* ---- all ---- */

/* Of so many numbers, none of which is known. false: no memory. */
static bool blank(uint32_t **numbers, size_t count) {
    *numbers = noc_alloc((count + 1) * sizeof(**numbers));
    for (size_t i = 0; *numbers && i <= count; i++)
        (*numbers)[i] = NOC_JOIN_NONE;
    return *numbers != NULL;
}

static void forget(noc_joiner *j) {
    uint32_t **of[] = { &j->group, &j->profile, &j->texture,  &j->material,  &j->model,      &j->light,
                        &j->mesh,  &j->route,   &j->instance, &j->next_mesh, &j->model_mesh, &j->facade };
    for (size_t i = 0; i < NOC_COUNT(of); i++) {
        free(*of[i]);
        *of[i] = NULL;
    }
}

static bool begin(noc_joiner *j) {
    const noc_scene *s = j->from;
    bool ok = blank(&j->group, s->groups.len) && blank(&j->profile, s->profiles.len) &&
              blank(&j->texture, s->textures.len) && blank(&j->material, s->materials.len) &&
              blank(&j->model, s->models.len) && blank(&j->light, s->lights.len) && blank(&j->mesh, s->meshes.len) &&
              blank(&j->route, s->routes.len) && blank(&j->instance, s->instances.len) &&
              blank(&j->facade, s->facades.len);
    j->next_mesh = noc_calloc(s->meshes.len + 1, sizeof(*j->next_mesh));
    j->model_mesh = noc_calloc(s->models.len + 1, sizeof(*j->model_mesh));
    if (!ok || !j->next_mesh || !j->model_mesh)
        return noc_join_no_memory(j);
    for (size_t i = s->meshes.len; i--;) { /* so that each chain ascends */
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (!m->model || m->removed)
            continue;
        j->next_mesh[i] = j->model_mesh[m->model];
        j->model_mesh[m->model] = (uint32_t)i + 1;
    }
    j->cells_left = s->profile_cells.len / 4;
    j->texels_left = s->texels.len;
    j->stops_left = s->stops.len;
    j->name_before = j->kept_before = NULL;
    return true;
}

noc_joiner *noc_joiner_create(noc_scene *to) {
    noc_joiner *j = noc_calloc(1, sizeof(*j));
    if (j)
        j->to = to;
    else
        noc_scene_out_of_memory(to);
    return j;
}

noc_status noc_joiner_add(noc_joiner *j, const noc_scene *from, const double shift[3], const noc_choice *choice,
                          const char *name, const char *first, bool *taken) {
    j->from = from;
    j->choice = choice;
    j->name = name;
    j->first = first;
    memcpy(j->shift, shift, sizeof(j->shift));
    if (begin(j))
        j->status = noc_join_groups(j);
    if (!j->status) {
        choose(j);
        if (join_lights(j) && join_meshes(j) && join_windows(j, taken) && join_bodies(j) && join_instances(j))
            join_streets(j);
    }
    forget(j);
    return j->status;
}

/* Lights are 64-byte aligned in a committed scene, and those of the moving half and free slots are listed. */
static bool finish_lights(noc_joiner *j) {
    noc_scene *to = j->to;
    size_t room = NOC_MAX(to->lights.len, (size_t)1);
    noc_light_record *lights = noc_alloc_large(room, sizeof(*lights));
    if (!lights)
        return noc_join_no_memory(j);
    if (to->lights.len)
        memcpy(lights, to->lights.data, to->lights.len * sizeof(*lights));
    size_t count = to->lights.len;
    array_free(&to->lights);
    to->lights.data = lights;
    to->lights.cap = room;
    to->lights.len = count;
    for (uint32_t i = 0; i < count; i++) {
        to->lights_inferred += (lights[i].flags & NOC_LIGHT_INFERRED) != 0;
        if (!noc_light_stands(lights[i].flags) && !array_push(&to->moving, i))
            return noc_join_no_memory(j);
    }
    return true;
}

noc_status noc_joiner_finish(noc_joiner *j) {
    noc_scene *to = j->to;
    to->gaps.len = 0; /* of a backdrop */
    if (!array_reserve(&to->gaps, to->meshes.len + 2) || !finish_lights(j) || !noc_bodies_file(to, 0))
        return noc_scene_out_of_memory(to);
    for (size_t i = 0; i < to->meshes.len; i++) {
        const noc_scene_mesh *m = &to->meshes.data[i];
        if (!noc_mesh_in_city(to, m))
            noc_scene_add_gap(to, m->first_triangle, m->triangle_count);
        noc_material_use(to, m);
    }
    to->first_later = to->meshes.len;
    to->committed = true;
    return NOC_OK;
}

void noc_joiner_destroy(noc_joiner *j) {
    if (!j)
        return;
    forget(j);
    map_free(&j->materials);
    map_free(&j->textures);
    map_free(&j->models);
    free(j);
}
