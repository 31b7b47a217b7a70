/* The arrays of a scene, and meshes that are added to them. */
#include "scene/scene.h"

#include <math.h>

static void forget_bounds(double lo[3], double hi[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
}

noc_scene *noc_scene_create_arrays(void) {
    noc_scene *scene = noc_calloc(1, sizeof(*scene));
    if (scene) {
        forget_bounds(scene->bounds_min, scene->bounds_max);
        scene->maintenance = 1;
        scene->sources.lock = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
    }
    return scene;
}

noc_scene *noc_scene_create(noc_log *log) {
    noc_scene *scene = noc_scene_create_arrays();
    if (!scene || !(scene->lock = noc_scene_lock_create())) {
        free(scene);
        noc_no_memory(log, "scene");
        return NULL;
    }
    scene->log = log;
    return scene;
}

static void free_model(noc_scene_model *m) {
    array_free(&m->lights);
    array_free(&m->light_names);
}

static void free_slots(noc_slots *s) {
    array_free(&s->free);
    array_free(&s->released);
}

void noc_scene_destroy(noc_scene *scene) {
    if (!scene)
        return;
    if (scene->crs && scene->crs_free)
        scene->crs_free(scene->crs);
    if (scene->given_crs && scene->crs_free)
        scene->crs_free(scene->given_crs);
    free(scene->given_crs_name);
    free(scene->without_crs);
    noc_ground_free(scene->ground);
    noc_environment_free(scene->environment);
    free(scene->crs_name);
    for (size_t i = 0; i < scene->models.len; i++)
        free_model(&scene->models.data[i]);
    for (size_t i = 0; i < scene->instances.len; i++)
        free(scene->instances.data[i].lights);
    array_free(&scene->positions);
    array_free(&scene->indices);
    array_free(&scene->triangle_material);
    array_free(&scene->triangle_light);
    array_free(&scene->meshes);
    array_free(&scene->uv);
    array_free(&scene->materials);
    array_free(&scene->material_records);
    array_free(&scene->material_uses);
    array_free(&scene->material_names);
    array_free(&scene->lights);
    array_free(&scene->light_names);
    array_free(&scene->light_made);
    array_free(&scene->moving);
    array_free(&scene->windows);
    array_free(&scene->triangle_facade);
    array_free(&scene->facades);
    array_free(&scene->facade_cells);
    array_free(&scene->walls);
    array_free(&scene->models);
    array_free(&scene->instances);
    array_free(&scene->bodies);
    array_free(&scene->body_links);
    array_free(&scene->body_cells);
    array_free(&scene->body_kinds);
    array_free(&scene->stops);
    array_free(&scene->routes);
    array_free(&scene->cars);
    array_free(&scene->groups);
    array_free(&scene->profiles);
    array_free(&scene->profile_cells);
    array_free(&scene->texels);
    array_free(&scene->textures);
    array_free(&scene->gaps);
    array_free(&scene->streets);
    array_free(&scene->street_points);
    array_free(&scene->edits);
    free_slots(&scene->light_slots);
    array_free(&scene->dark_slots);
    free_slots(&scene->instance_slots);
    free_slots(&scene->light_materials);
    for (int i = 0; i < NOC_SHAPE_KINDS; i++)
        free_slots(&scene->shapes[i]);
    array_free(&scene->reshapes);
    noc_scene_destroy(scene->reshaped);
    noc_scene_sources_free(&scene->sources);
    arena_free(&scene->names);
    arena_free(&scene->later_names);
    noc_scene_destroy(scene->added);
    noc_scene_lock_destroy(scene->lock);
    noc_free_pages(scene->pages, scene->page_bytes);
    free(scene);
}

noc_status noc_scene_out_of_memory(noc_scene *scene) {
    if (!scene->no_memory)
        noc_error(scene->log, NOC_ERR_MEMORY, "scene: no memory for more than %zu triangles and %zu lights",
                  scene->triangle_light.len, scene->lights.len);
    scene->no_memory = !scene->committed; /* a committed scene stays as it is, and may be edited on */
    return NOC_ERR_MEMORY;
}

noc_scene *noc_scene_adding(noc_scene *scene) {
    if (!scene->committed)
        return scene;
    if (!scene->added && !(scene->added = noc_scene_create_arrays()))
        noc_scene_out_of_memory(scene);
    return scene->added;
}

bool noc_scene_keep_name(noc_scene *scene, const char *name, const char **kept) {
    *kept = arena_strdup(scene->committed ? &scene->later_names : &scene->names, name);
    if (!name || *kept)
        return true;
    noc_scene_out_of_memory(scene);
    return false;
}

noc_scene_model *noc_scene_model_of(const noc_scene *scene, int model) {
    size_t i = (size_t)model - 1, have = scene->models.len;
    if (model < 1 || i >= have + (scene->added ? scene->added->models.len : 0))
        return NULL;
    return i < have ? &scene->models.data[i] : &scene->added->models.data[i - have];
}

bool noc_scene_takes(const noc_scene *scene, int group, int model, char wrong[NOC_FAULT]) {
    if (group < 0 || (size_t)group > scene->groups.len)
        noc_snprintf(wrong, NOC_FAULT, "there is no group %d", group);
    else if (model && !noc_scene_model_of(scene, model))
        noc_snprintf(wrong, NOC_FAULT, "there is no model %d", model);
    else if (model && scene->committed && (size_t)model <= scene->models.len)
        noc_snprintf(wrong, NOC_FAULT, "model %d is committed, and does not change any more", model);
    else
        return true;
    return false;
}

uint32_t noc_slot_next(const noc_slots *slots, size_t have) {
    return slots->taken < slots->free.len ? slots->free.data[slots->free.len - 1 - slots->taken]
                                          : (uint32_t)have + slots->fresh;
}

void noc_slot_take(noc_slots *slots) {
    if (slots->taken < slots->free.len)
        slots->taken++;
    else
        slots->fresh++;
}

double noc_double_area(const float *a, const float *b, const float *c) {
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - a[i];
        v[i] = (double)c[i] - a[i];
    }
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z);
}

static bool finite_position(const double *p) {
    /* local coordinates are kept in floats: 1e7 m is one metre of resolution, and certainly a mistake */
    return fabs(p[0]) < 1e7 && fabs(p[1]) < 1e7 && fabs(p[2]) < 1e7;
}

/* Room for all of a mesh, and for Embree, which reads 16 bytes a vertex. */
bool noc_scene_reserve_mesh(noc_scene *s, const noc_mesh *mesh) {
    size_t triangles = s->triangle_light.len + mesh->triangle_count;
    return array_reserve(&s->positions, s->positions.len + mesh->vertex_count * 3 + 1) &&
           array_reserve(&s->indices, 3 * triangles) && array_reserve(&s->triangle_material, triangles) &&
           array_reserve(&s->triangle_light, triangles) && array_reserve(&s->meshes, s->meshes.len + 1) &&
           (!mesh->uv || array_reserve(&s->uv, s->uv.len + 2 * mesh->vertex_count));
}

static bool takes_mesh(const noc_scene *s, const noc_mesh *mesh, char wrong[NOC_FAULT]) {
    if (mesh->material >= 0 && (size_t)mesh->material < noc_scene_material_count(s))
        return noc_scene_takes(s, mesh->group, mesh->model, wrong);
    noc_snprintf(wrong, NOC_FAULT, "there is no material %d", mesh->material);
    return false;
}

void noc_scene_push_triangles(noc_scene *to, const noc_mesh *mesh, double lo[3], double hi[3]) {
    size_t first_vertex = to->positions.len / 3;
    for (size_t i = 0; i < mesh->vertex_count * 3; i++)
        to->positions.data[to->positions.len++] = (float)mesh->positions[i];
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        bool ok = true;
        for (int i = 0; i < 3; i++)
            ok = ok && v[i] < mesh->vertex_count && finite_position(mesh->positions + 3 * (size_t)v[i]);
        const float *p = to->positions.data + 3 * first_vertex;
        if (!ok || !(noc_double_area(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2]) > 1e-12)) {
            to->triangles_dropped++;
            to->triangles_flat += ok;
            continue;
        }
        for (int i = 0; i < 3; i++) {
            to->indices.data[to->indices.len++] = (uint32_t)first_vertex + v[i];
            for (int k = 0; k < 3; k++) {
                double x = mesh->positions[3 * (size_t)v[i] + k];
                lo[k] = NOC_MIN(lo[k], x);
                hi[k] = NOC_MAX(hi[k], x);
            }
        }
        to->triangle_material.data[to->triangle_material.len++] = (uint32_t)mesh->material;
        to->triangle_light.data[to->triangle_light.len++] = NOC_NO_LIGHT;
    }
}

/* Where the room for them was reserved. */
static void push_uv(noc_scene *to, const noc_mesh *mesh, noc_scene_mesh *made) {
    made->uv = (uint32_t)(to->uv.len / 2) + 1;
    for (size_t i = 0; i < 2 * mesh->vertex_count; i++)
        to->uv.data[to->uv.len++] = fabsf(mesh->uv[i]) <= 1e6f ? mesh->uv[i] : 0;
}

int noc_scene_add_mesh(noc_scene *scene, const noc_mesh *mesh) {
    if (!scene || !mesh || (mesh->vertex_count && !mesh->positions) || (mesh->triangle_count && !mesh->indices)) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    const char *name = mesh->name ? mesh->name : "unnamed", *kept_name;
    char wrong[NOC_FAULT];
    if (scene->no_memory)
        return -1;
    if (!takes_mesh(scene, mesh, wrong)) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "mesh %s: %s", name, wrong);
        return -1;
    }
    noc_scene *to = noc_scene_adding(scene);
    if (!to)
        return -1;
    bool later = to != scene;
    size_t vertices = scene->positions.len / 3 + (later ? to->positions.len / 3 : 0),
           triangles = scene->triangle_light.len + (later ? to->triangle_light.len : 0);
    if (mesh->vertex_count > UINT32_MAX - vertices || mesh->triangle_count > UINT32_MAX - 1 - triangles) {
        noc_error(scene->log, NOC_ERR_UNSUPPORTED, "mesh %s: more than 4294967295 vertices or triangles in a scene",
                  name);
        return -1;
    }
    if (!noc_scene_keep_name(scene, mesh->name, &kept_name))
        return -1;
    if (!noc_scene_reserve_mesh(to, mesh) || !array_reserve(&to->gaps, to->gaps.len + 1)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    noc_scene_mesh made = { .first_triangle = (uint32_t)to->triangle_light.len,
                            .first_vertex = (uint32_t)(to->positions.len / 3),
                            .material = mesh->material,
                            .model = (uint16_t)mesh->model,
                            .group = (uint16_t)mesh->group,
                            .made = later ? (uint32_t)scene->versions.geometry + 1 : 0,
                            .name = kept_name };
    noc_scene_model *model = noc_scene_model_of(scene, mesh->model);
    double nowhere[2][3] = { { 0 } }; /* closures have no bounds, as nobody sees them */
    if (noc_scene_material_at(scene, mesh->material)->cls == NOC_CLASS_CLOSURE)
        noc_scene_push_triangles(to, mesh, nowhere[0], nowhere[1]);
    else if (model)
        noc_scene_push_triangles(to, mesh, model->bounds_min, model->bounds_max);
    else
        noc_scene_push_triangles(to, mesh, to->bounds_min, to->bounds_max);
    made.triangle_count = (uint32_t)(to->triangle_light.len - made.first_triangle);
    if (mesh->uv)
        push_uv(to, mesh, &made);
    to->meshes.data[to->meshes.len++] = made;
    if (model)
        noc_scene_add_gap(to, made.first_triangle, made.triangle_count);
    return (int)(to->meshes.len + (later ? scene->meshes.len : 0)) - 1;
}

bool noc_scene_add_backdrop(noc_scene *scene, const noc_mesh *mesh) {
    if (scene->backdrop_count)
        return false;
    double lo[3], hi[3];
    memcpy(lo, scene->bounds_min, sizeof(lo));
    memcpy(hi, scene->bounds_max, sizeof(hi));
    int index = noc_scene_add_mesh(scene, mesh);
    memcpy(scene->bounds_min, lo, sizeof(lo));
    memcpy(scene->bounds_max, hi, sizeof(hi));
    if (index < 0)
        return false;
    scene->backdrop_first = scene->meshes.data[index].first_triangle;
    scene->backdrop_count = scene->meshes.data[index].triangle_count;
    noc_scene_add_gap(scene, scene->backdrop_first, scene->backdrop_count); /* the mesh reserved it */
    return true;
}

void noc_scene_add_gap(noc_scene *scene, size_t first, size_t count) {
    noc_scene_gap *last = scene->gaps.len ? &scene->gaps.data[scene->gaps.len - 1] : NULL;
    if (!count)
        return;
    if (last && last->end == first)
        last->end += count;
    else
        scene->gaps.data[scene->gaps.len++] = (noc_scene_gap){
            .first = first, .end = first + count, .before = last ? last->before + (last->end - last->first) : 0
        };
}

size_t noc_scene_city_triangle(const noc_scene *scene, size_t i) {
    size_t low = 0, high = scene->gaps.len; /* gaps below low lie before it */
    while (low < high) {
        size_t middle = (low + high) / 2;
        const noc_scene_gap *g = &scene->gaps.data[middle];
        if (g->first - g->before <= i)
            low = middle + 1;
        else
            high = middle;
    }
    const noc_scene_gap *g = low ? &scene->gaps.data[low - 1] : NULL;
    return i + (g ? g->before + (g->end - g->first) : 0);
}

size_t noc_scene_mesh_of(const noc_scene *scene, size_t triangle) {
    size_t low = 0, high = scene->meshes.len;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        *(scene->meshes.data[middle].first_triangle <= triangle ? &low : &high) = middle;
    }
    return low;
}

noc_status noc_scene_set_crs(noc_scene *scene, const char *crs, const double origin[3]) {
    if (!scene)
        return NOC_ERR_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (!origin || !isfinite(origin[k]))
            return noc_error(scene->log, NOC_ERR_ARGUMENT, "scene: the origin must be three finite numbers");
    char *name = noc_strdup(crs);
    if (crs && !name)
        return noc_scene_out_of_memory(scene);
    free(scene->crs_name);
    scene->crs_name = name;
    memcpy(scene->origin, origin, sizeof(scene->origin));
    return NOC_OK;
}
