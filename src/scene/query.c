/* What a scene holds, for programs that list, label or pick: lights, objects, and pixels to places and back. */
#include "scene/scene.h"

#include <math.h>

size_t noc_scene_bytes(const noc_scene *s) {
    size_t models = 0;
    for (size_t i = 0; i < s->models.len; i++)
        models += s->models.data[i].lights.cap * sizeof(noc_light_record);
    return s->page_bytes + s->positions.cap * sizeof(float) +
           (s->indices.cap + s->triangle_material.cap + s->triangle_light.cap + s->moving.cap) * sizeof(uint32_t) +
           s->lights.cap * sizeof(noc_light_record) + s->light_names.cap * sizeof(char *) +
           s->light_made.cap * sizeof(noc_rgb) + s->meshes.cap * sizeof(noc_scene_mesh) + s->names.bytes +
           s->later_bytes + models + (s->profile_cells.cap + s->uv.cap) * sizeof(float) +
           s->texels.cap * sizeof(uint32_t) + (s->environment ? s->environment->bytes : 0) +
           s->instances.cap * sizeof(noc_scene_instance) + s->bodies.cap * sizeof(noc_scene_body) +
           s->body_links.cap * sizeof(noc_body_link) + s->body_cells.cap * sizeof(uint32_t) +
           s->stops.cap * sizeof(noc_scene_stop) + s->routes.cap * sizeof(noc_scene_route) +
           s->cars.cap * sizeof(noc_scene_car) + s->windows.cap * sizeof(noc_scene_window) + s->walls.cap +
           (s->triangle_facade.cap + s->facade_cells.cap) * sizeof(uint32_t) +
           s->facades.cap * sizeof(noc_facade_record) + s->material_names.cap * sizeof(char *);
}

static void count_meshes(const noc_scene *scene, noc_scene_info *info) {
    for (size_t i = 0; i < scene->meshes.len; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        if (m->removed)
            continue;
        info->meshes++;
        info->triangles += m->triangle_count;
        if (m->model)
            info->instance_triangles += (size_t)m->triangle_count * scene->models.data[m->model - 1].instances;
        info->vertices += noc_mesh_end_vertex(scene, i) - m->first_vertex;
        const noc_material *material = &scene->materials.data[m->material];
        info->triangles_by_class[material->cls] += m->triangle_count;
        if (noc_material_lets_through(material))
            info->transparent_triangles += m->triangle_count;
    }
}

static void count_windows(const noc_scene *scene, noc_scene_info *info) {
    for (size_t i = 0; i < scene->windows.len; i++) {
        const noc_scene_window *w = &scene->windows.data[i];
        if (w->removed)
            continue;
        const float *e = scene->lights.data[w->light].e;
        info->windows++;
        info->windows_lit += e[0] > 0 || e[1] > 0 || e[2] > 0;
    }
}

static void count_lights(const noc_scene *scene, noc_scene_info *info) {
    info->light_slots = scene->lights.len;
    for (size_t i = 0; i < scene->lights.len; i++)
        if (!(scene->lights.data[i].flags & NOC_LIGHT_FREE)) {
            info->lights++;
            info->lights_by_kind[scene->lights.data[i].kind]++;
        }
}

/* lo..hi of all that stands and of instances; zeros where there is nothing. */
static void find_bounds(const noc_scene *scene, double lo[3], double hi[3]) {
    double all[2][3];
    memcpy(all[0], scene->bounds_min, sizeof(all[0]));
    memcpy(all[1], scene->bounds_max, sizeof(all[1]));
    for (size_t i = 0; i < scene->instances.len; i++)
        if (scene->instances.data[i].model)
            noc_join_instance_bounds(scene, &scene->instances.data[i], all[0], all[1]);
    if (!(all[0][0] <= all[1][0]))
        return;
    memcpy(lo, all[0], sizeof(all[0]));
    memcpy(hi, all[1], sizeof(all[1]));
}

void noc_scene_get_info(const noc_scene *scene, noc_scene_info *info) {
    if (!info)
        return;
    *info = (noc_scene_info){ 0 };
    if (!scene)
        return;
    noc_scene_lock_read(scene);
    *info = (noc_scene_info){ .materials = scene->materials.len,
                              .models = scene->models.len,
                              .textures = scene->textures.len,
                              .texture_bytes = scene->texels.len * sizeof(uint32_t),
                              .lights_inferred = scene->lights_inferred,
                              .triangles_dropped = scene->triangles_dropped,
                              .crs = scene->crs_name ? scene->crs_name : "" };
    for (size_t i = 0; i < scene->instances.len; i++)
        info->instances += scene->instances.data[i].model > 0;
    info->instances += scene->bodies.len;
    info->cars = scene->cars.len;
    info->time = scene->time;
    info->maintenance = scene->maintenance;
    info->given_crs = scene->given_crs_name ? scene->given_crs_name : info->crs;
    memcpy(info->given_origin, scene->given_crs_name ? scene->given_origin : scene->origin, sizeof(info->given_origin));
    memcpy(info->origin, scene->origin, sizeof(info->origin));
    count_meshes(scene, info);
    count_lights(scene, info);
    count_windows(scene, info);
    find_bounds(scene, info->bounds_min, info->bounds_max);
    if (scene->environment) {
        info->environment_width = scene->environment->given;
        info->environment_lux = scene->environment->lux;
    }
    info->memory_bytes = noc_scene_bytes(scene);
    noc_scene_unlock_read(scene);
}

/* As made without a profile. */
static double area_of_round(const noc_light_record *r) {
    double round = r->kind == NOC_LIGHT_SPHERE ? 4 : r->kind == NOC_LIGHT_DISC ? 1 : 0;
    return round * M_PI * r->radius * r->radius;
}

static void describe_light(const noc_scene *scene, size_t index, noc_light_info *info) {
    const noc_light_record *r = &scene->lights.data[index];
    if (r->flags & NOC_LIGHT_FREE) {
        *info = (noc_light_info){ .removed = true };
        return;
    }
    *info = (noc_light_info){ .lumens = noc_light_flux(r),
                              .area = noc_light_has_profile(r) ? area_of_round(r) : r->area,
                              .two_sided = r->flags & NOC_LIGHT_TWO_SIDED && !noc_light_has_profile(r),
                              .lamp = noc_light_is_lamp(r),
                              .light = { .kind = (noc_light_kind)r->kind,
                                         .name = scene->light_names.data[index],
                                         .inferred = (r->flags & NOC_LIGHT_INFERRED) != 0,
                                         .group = (int)noc_light_group(r),
                                         .profile = (int)((r->flags & LIGHT_PROFILE_BITS) >> LIGHT_PROFILE),
                                         .moving = (r->flags & NOC_LIGHT_MOVES) != 0 } };
    bool triangle = r->kind == NOC_LIGHT_TRIANGLE, flat = triangle || r->kind == NOC_LIGHT_PARALLELOGRAM;
    info->light.radius = flat ? 0 : r->radius;
    for (int k = 0; k < 3; k++) {
        info->light.position[k] = r->p[k];
        info->light.emission[k] = r->e[k];
        info->centre[k] = r->p[k] + (flat ? ((double)r->a[k] + r->b[k]) / (triangle ? 3 : 2) : 0);
        info->light.edge_u[k] = flat ? r->a[k] : 0;
        info->light.edge_v[k] = flat ? r->b[k] : 0;
    }
    if (r->kind == NOC_LIGHT_SPOT) {
        double length = sqrt((double)r->a[0] * r->a[0] + (double)r->a[1] * r->a[1] + (double)r->a[2] * r->a[2]);
        for (int k = 0; k < 3; k++)
            info->light.direction[k] = r->a[k] / length;
        info->light.inner_deg = r->b[1] * 180 / M_PI;
        info->light.outer_deg = r->b[2] * 180 / M_PI;
    }
    if (flat || r->kind == NOC_LIGHT_DISC || noc_light_has_profile(r)) {
        double n[3] = { (double)r->a[1] * r->b[2] - (double)r->a[2] * r->b[1],
                        (double)r->a[2] * r->b[0] - (double)r->a[0] * r->b[2],
                        (double)r->a[0] * r->b[1] - (double)r->a[1] * r->b[0] };
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int k = 0; k < 3; k++)
            info->light.direction[k] = length > 0 ? n[k] / length : 0;
    }
    double scale = r->kind == NOC_LIGHT_DISC ? r->radius : 1;
    for (int k = 0; k < 3 && noc_light_has_profile(r); k++)
        info->light.c0[k] = r->a[k] / scale;
}

noc_status noc_scene_get_light(const noc_scene *scene, size_t index, noc_light_info *info) {
    if (!scene || !info)
        return NOC_ERR_ARGUMENT;
    noc_scene_lock_read(scene);
    size_t slots = scene->lights.len;
    if (index < slots)
        describe_light(scene, index, info);
    noc_scene_unlock_read(scene);
    return index < slots ? NOC_OK
                         : noc_error(scene->log, NOC_ERR_ARGUMENT, "light %zu: the scene has %zu lights", index, slots);
}

static bool same_name(const noc_scene_mesh *a, const noc_scene_mesh *b) {
    return a->model == b->model && a->name && b->name && !strcmp(a->name, b->name);
}

/* An object comes as several meshes, one a class and material, one after the other: the first stands for them. */
size_t noc_scene_object_of(const noc_scene *scene, uint32_t triangle, uint32_t instance) {
    if (noc_is_body(instance))
        return scene->meshes.len + (instance - NOC_BODIES);
    size_t mesh = noc_scene_mesh_of(scene, triangle);
    while (mesh && same_name(&scene->meshes.data[mesh], &scene->meshes.data[mesh - 1]))
        mesh--;
    return mesh;
}

const char *noc_scene_object_name(const noc_scene *scene, size_t object) {
    if (!scene)
        return NULL;
    noc_scene_lock_read(scene);
    size_t body = object - scene->meshes.len; /* they come behind the meshes */
    const char *name = object < scene->meshes.len ? scene->meshes.data[object].name
                       : body < scene->bodies.len ? scene->light_names.data[scene->bodies.data[body].light]
                                                  : NULL;
    noc_scene_unlock_read(scene);
    return name;
}

/* A camera's axes in doubles: forward of length 1, right and up as long as half of the picture at distance 1. false: it
 * looks nowhere. */
static bool camera_axes(const noc_camera *c, int width, int height, double axes[3][3]) {
    double *forward = axes[0], *right = axes[1], *up = axes[2], length = 0, side = 0;
    for (int k = 0; k < 3; k++) {
        forward[k] = c->target[k] - c->eye[k];
        length += forward[k] * forward[k];
    }
    if (!(length > 0) || !isfinite(length) || width < 1 || height < 1 || !(c->fov_deg > 0 && c->fov_deg < 180))
        return false;
    for (int k = 0; k < 3; k++)
        forward[k] /= sqrt(length);
    double given = sqrt(c->up[0] * c->up[0] + c->up[1] * c->up[1] + c->up[2] * c->up[2]), helper[3];
    /* as noc_view_render: looking along up, another stands in */
    for (int turn = 0; turn < 2 && !(side > 1e-6 * 1e-6); turn++) {
        bool other = turn == 1;
        for (int k = 0; k < 3; k++)
            helper[k] = other ? k == (fabs(forward[1]) < 0.9 ? 1 : 0) : c->up[k] / given;
        side = 0;
        for (int k = 0; k < 3; k++) {
            right[k] = forward[(k + 1) % 3] * helper[(k + 2) % 3] - forward[(k + 2) % 3] * helper[(k + 1) % 3];
            side += right[k] * right[k];
        }
    }
    if (!(side > 0))
        return false;
    double t = tan(c->fov_deg * M_PI / 360);
    for (int k = 0; k < 3; k++)
        right[k] /= sqrt(side);
    for (int k = 0; k < 3; k++)
        up[k] = t * (right[(k + 1) % 3] * forward[(k + 2) % 3] - right[(k + 2) % 3] * forward[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
        right[k] *= t * width / height;
    return true;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool noc_camera_project(const noc_camera *camera, int width, int height, const double xyz[3], double pixel[2],
                        double *distance) {
    double axes[3][3], to[3];
    if (!camera || !xyz || !pixel || !camera_axes(camera, width, height, axes))
        return false;
    for (int k = 0; k < 3; k++)
        to[k] = xyz[k] - camera->eye[k];
    double along = dot(to, axes[0]);
    if (distance)
        *distance = sqrt(dot(to, to));
    if (!(along > 0))
        return false;
    double x = dot(to, axes[1]) / (along * dot(axes[1], axes[1])),
           y = dot(to, axes[2]) / (along * dot(axes[2], axes[2]));
    pixel[0] = 0.5 * (1 + x) * width;
    pixel[1] = 0.5 * (1 - y) * height;
    return isfinite(pixel[0]) && isfinite(pixel[1]);
}

noc_status noc_camera_ray(const noc_camera *camera, int width, int height, const double pixel[2], noc_ray *ray) {
    double axes[3][3], d[3];
    if (!camera || !pixel || !ray || !camera_axes(camera, width, height, axes))
        return NOC_ERR_ARGUMENT;
    double x = 2 * pixel[0] / width - 1, y = 1 - 2 * pixel[1] / height;
    for (int k = 0; k < 3; k++)
        d[k] = axes[0][k] + x * axes[1][k] + y * axes[2][k];
    *ray = (noc_ray){ .far = INFINITY };
    for (int k = 0; k < 3; k++) {
        ray->origin[k] = camera->eye[k];
        ray->direction[k] = d[k] / sqrt(dot(d, d));
    }
    return NOC_OK;
}

noc_status noc_camera_unproject(const noc_camera *camera, int width, int height, const double pixel[2], double distance,
                                double xyz[3]) {
    noc_ray ray;
    if (!xyz || !isfinite(distance) || noc_camera_ray(camera, width, height, pixel, &ray))
        return NOC_ERR_ARGUMENT;
    for (int k = 0; k < 3; k++)
        xyz[k] = ray.origin[k] + distance * ray.direction[k];
    return NOC_OK;
}
