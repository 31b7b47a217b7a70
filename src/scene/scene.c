#include "scene/scene.h"

#include <math.h>
#include <stdio.h>

/* Reflectances: typical values for dry surfaces (CIE 144:2001 for roads; IESNA Lighting Handbook, building materials).
 */
#define CLASSES                                                                                                        \
    CLASS(NOC_CLASS_OTHER, "other", .30f, .30f, .30f, 0, 1)                                                            \
    CLASS(NOC_CLASS_WALL, "wall", .46f, .42f, .36f, 0, 1)                                                              \
    CLASS(NOC_CLASS_ROOF, "roof", .26f, .15f, .11f, .02f, .7f)                                                         \
    CLASS(NOC_CLASS_GROUND, "ground", .20f, .20f, .19f, 0, 1)                                                          \
    CLASS(NOC_CLASS_CLOSURE, "closure", .30f, .30f, .30f, 0, 1)                                                        \
    CLASS(NOC_CLASS_WINDOW, "window", .05f, .06f, .07f, .06f, .15f)                                                    \
    CLASS(NOC_CLASS_DOOR, "door", .20f, .13f, .08f, .04f, .5f)                                                         \
    CLASS(NOC_CLASS_INSTALLATION, "installation", .38f, .36f, .33f, 0, 1)                                              \
    CLASS(NOC_CLASS_TERRAIN, "terrain", .17f, .17f, .14f, 0, 1)                                                        \
    CLASS(NOC_CLASS_ROAD, "road", .09f, .09f, .09f, .04f, .55f)                                                        \
    CLASS(NOC_CLASS_SIDEWALK, "sidewalk", .25f, .24f, .23f, .02f, .8f)                                                 \
    CLASS(NOC_CLASS_GREEN, "green", .08f, .13f, .05f, 0, 1)                                                            \
    CLASS(NOC_CLASS_TREE, "tree", .07f, .12f, .04f, 0, 1)                                                              \
    CLASS(NOC_CLASS_WATER, "water", .02f, .03f, .04f, .02f, .12f)                                                      \
    CLASS(NOC_CLASS_BRIDGE, "bridge", .30f, .29f, .27f, 0, 1)                                                          \
    CLASS(NOC_CLASS_FURNITURE, "furniture", .22f, .22f, .22f, .04f, .5f)                                               \
    CLASS(NOC_CLASS_LAMP, "lamp", .10f, .10f, .10f, .04f, .4f)                                                         \
    CLASS(NOC_CLASS_VEHICLE, "vehicle", .20f, .05f, .05f, .05f, .25f)

#define CLASS(id, text, r, g, b, spec, rough) [id] = text,
const char *const noc_class_names[NOC_CLASS_COUNT] = { CLASSES };
#undef CLASS
#define CLASS(id, text, r, g, b, spec, rough)                                                                          \
    [id] = { .albedo = { r, g, b }, .f0 = spec, .roughness = rough, .cls = id },
static const noc_material class_materials[NOC_CLASS_COUNT] = { CLASSES };
#undef CLASS

const char *noc_class_name(noc_class cls) { return (unsigned)cls < NOC_CLASS_COUNT ? noc_class_names[cls] : "unknown"; }

noc_material noc_class_material(noc_class cls) {
    return class_materials[(unsigned)cls < NOC_CLASS_COUNT ? cls : NOC_CLASS_OTHER];
}

noc_scene *noc_scene_create(noc_log *log) {
    noc_scene *scene = noc_calloc(1, sizeof(*scene));
    if (!scene) {
        noc_no_memory(log, "scene");
        return NULL;
    }
    scene->log = log;
    for (int i = 0; i < 3; i++) {
        scene->bounds_min[i] = INFINITY;
        scene->bounds_max[i] = -INFINITY;
    }
    return scene;
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
    free(scene->crs_name);
    array_free(&scene->positions);
    array_free(&scene->indices);
    array_free(&scene->triangle_material);
    array_free(&scene->triangle_light);
    array_free(&scene->meshes);
    array_free(&scene->materials);
    array_free(&scene->material_records);
    array_free(&scene->lights);
    array_free(&scene->light_names);
    array_free(&scene->moving);
    arena_free(&scene->names);
    free(scene);
}

static bool in_range(float x, float lo, float hi) { return x >= lo && x <= hi; } /* false for NaN */

int noc_scene_add_material(noc_scene *scene, const noc_material *m) {
    if (!scene || !m) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    if (scene->committed) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "material: the scene is committed");
        return -1;
    }
    bool ok = in_range(m->f0, 0, 1) && in_range(m->roughness, 0.05f, 1) && (unsigned)m->cls < NOC_CLASS_COUNT;
    for (int i = 0; i < 3; i++)
        ok = ok && in_range(m->albedo[i], 0, 1) && in_range(m->emission[i], 0, 1e12f);
    if (!ok) {
        noc_error(scene->log, NOC_ERR_ARGUMENT,
                  "material: albedo and f0 must be in 0..1, roughness in 0.05..1, emission finite and not negative");
        return -1;
    }
    noc_material_record r = { .f0 = m->f0, .alpha = m->roughness * m->roughness };
    memcpy(r.albedo, m->albedo, sizeof(r.albedo));
    memcpy(r.emission, m->emission, sizeof(r.emission));
    if (!array_reserve(&scene->materials, scene->materials.len + 1) ||
        !array_reserve(&scene->material_records, scene->materials.len + 1)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    scene->materials.data[scene->materials.len++] = *m;
    scene->material_records.data[scene->material_records.len++] = r;
    return (int)scene->materials.len - 1;
}

/* Twice the area of a triangle of float vertices. */
static double double_area(const float *a, const float *b, const float *c) {
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

noc_status noc_scene_out_of_memory(noc_scene *scene) {
    if (!scene->no_memory)
        noc_error(scene->log, NOC_ERR_MEMORY, "scene: no memory for more than %zu triangles and %zu lights",
                  scene->triangle_light.len, scene->lights.len);
    scene->no_memory = true;
    return NOC_ERR_MEMORY;
}

/* Room for all of a mesh, and for Embree, which reads 16 bytes a vertex. */
static bool reserve_mesh(noc_scene *s, const noc_mesh *mesh) {
    size_t triangles = s->triangle_light.len + mesh->triangle_count;
    return (array_reserve(&s->positions, s->positions.len + mesh->vertex_count * 3 + 1) &&
            array_reserve(&s->indices, 3 * triangles) && array_reserve(&s->triangle_material, triangles) &&
            array_reserve(&s->triangle_light, triangles) && array_reserve(&s->meshes, s->meshes.len + 1)) ||
           noc_scene_out_of_memory(s) == NOC_OK;
}

int noc_scene_add_mesh(noc_scene *scene, const noc_mesh *mesh) {
    if (!scene || !mesh || (mesh->vertex_count && !mesh->positions) || (mesh->triangle_count && !mesh->indices)) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    const char *name = mesh->name ? mesh->name : "unnamed";
    if (scene->no_memory)
        return -1;
    if (scene->committed) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "mesh %s: the scene is committed", name);
        return -1;
    }
    if (mesh->material < 0 || (size_t)mesh->material >= scene->materials.len) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "mesh %s: no material %d", name, mesh->material);
        return -1;
    }
    if ((mesh->vertex_count && !mesh->positions) || (mesh->triangle_count && !mesh->indices)) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "mesh %s: positions or indices are missing", name);
        return -1;
    }
    size_t first_vertex = scene->positions.len / 3, first_triangle = scene->indices.len / 3;
    if (mesh->vertex_count > UINT32_MAX - first_vertex || mesh->triangle_count > UINT32_MAX - 1 - first_triangle) {
        noc_error(scene->log, NOC_ERR_UNSUPPORTED, "mesh %s: more than 4294967295 vertices or triangles in a scene",
                  name);
        return -1;
    }
    char *kept_name = arena_strdup(&scene->names, mesh->name);
    if (mesh->name && !kept_name)
        noc_scene_out_of_memory(scene);
    if (scene->no_memory || !reserve_mesh(scene, mesh))
        return -1;
    for (size_t i = 0; i < mesh->vertex_count * 3; i++)
        scene->positions.data[scene->positions.len++] = (float)mesh->positions[i];
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        bool ok = true;
        for (int i = 0; i < 3; i++)
            ok = ok && v[i] < mesh->vertex_count && finite_position(mesh->positions + 3 * (size_t)v[i]);
        const float *p = scene->positions.data + 3 * first_vertex;
        if (!ok || !(double_area(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1], p + 3 * (size_t)v[2]) > 1e-12)) {
            scene->triangles_dropped++;
            scene->triangles_flat += ok;
            continue;
        }
        for (int i = 0; i < 3; i++) {
            scene->indices.data[scene->indices.len++] = (uint32_t)first_vertex + v[i];
            for (int k = 0; k < 3; k++) {
                double x = mesh->positions[3 * (size_t)v[i] + k];
                scene->bounds_min[k] = NOC_MIN(scene->bounds_min[k], x);
                scene->bounds_max[k] = NOC_MAX(scene->bounds_max[k], x);
            }
        }
        scene->triangle_material.data[scene->triangle_material.len++] = (uint32_t)mesh->material;
        scene->triangle_light.data[scene->triangle_light.len++] = NOC_NO_LIGHT;
    }
    scene->meshes.data[scene->meshes.len++] =
        (noc_scene_mesh){ .first_triangle = (uint32_t)first_triangle,
                          .triangle_count = (uint32_t)(scene->indices.len / 3 - first_triangle),
                          .material = mesh->material,
                          .name = kept_name };
    return (int)scene->meshes.len - 1;
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
    return true;
}

/* Closures are not rendered, so they do not shine either. */
static bool mesh_shines(const noc_scene *scene, const noc_scene_mesh *m) {
    const noc_material *mat = &scene->materials.data[m->material];
    return (mat->emission[0] > 0 || mat->emission[1] > 0 || mat->emission[2] > 0) && mat->cls != NOC_CLASS_CLOSURE;
}

static bool reserve_triangle_lights(noc_scene *scene) {
    size_t lights = scene->lights.len;
    for (size_t i = 0; i < scene->meshes.len; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        for (size_t t = m->first_triangle; mesh_shines(scene, m) && t < (size_t)m->first_triangle + m->triangle_count;
             t++)
            lights += scene->triangle_light.data[t] == NOC_NO_LIGHT;
    }
    return (array_reserve(&scene->lights, lights) && array_reserve(&scene->light_names, lights)) ||
           noc_scene_out_of_memory(scene) == NOC_OK;
}

/* A light a triangle, for every mesh whose material emits and whose triangles do not show a light yet. */
static void make_triangle_lights(noc_scene *scene) {
    for (size_t i = 0; i < scene->meshes.len; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        const noc_material *mat = &scene->materials.data[m->material];
        if (!mesh_shines(scene, m))
            continue;
        for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count; t++) {
            if (scene->triangle_light.data[t] != NOC_NO_LIGHT)
                continue;
            const uint32_t *v = scene->indices.data + 3 * t;
            const float *a = scene->positions.data + 3 * (size_t)v[0], *b = scene->positions.data + 3 * (size_t)v[1],
                        *c = scene->positions.data + 3 * (size_t)v[2];
            noc_light_record r = { .kind = NOC_LIGHT_TRIANGLE, .flags = mat->two_sided };
            for (int k = 0; k < 3; k++) {
                r.p[k] = a[k];
                r.a[k] = b[k] - a[k];
                r.b[k] = c[k] - a[k];
                r.e[k] = mat->emission[k];
            }
            r.area = (float)(0.5 * double_area(a, b, c));
            r.radius = noc_flat_size(&r);
            scene->triangle_light.data[t] = (uint32_t)scene->lights.len;
            scene->lights.data[scene->lights.len++] = r;
            scene->light_names.data[scene->light_names.len++] = m->name;
        }
    }
}

noc_status noc_scene_commit(noc_scene *scene) {
    if (!scene)
        return NOC_ERR_ARGUMENT;
    if (scene->committed)
        return NOC_OK;
    if (scene->no_memory || !reserve_triangle_lights(scene)) /* reported already */
        return NOC_ERR_MEMORY;
    make_triangle_lights(scene);
    noc_light_record *aligned = noc_alloc_large(scene->lights.len, sizeof(*aligned));
    if (!aligned)
        return noc_scene_out_of_memory(scene);
    if (scene->lights.len)
        memcpy(aligned, scene->lights.data, scene->lights.len * sizeof(*aligned));
    free(scene->lights.data);
    scene->lights.data = aligned;
    scene->lights.cap = scene->lights.len;
    scene->committed = true;
    return NOC_OK;
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

size_t noc_scene_bytes(const noc_scene *s) {
    return s->positions.cap * sizeof(float) +
           (s->indices.cap + s->triangle_material.cap + s->triangle_light.cap + s->moving.cap) * sizeof(uint32_t) +
           s->lights.cap * sizeof(noc_light_record) + s->light_names.cap * sizeof(char *) +
           s->meshes.cap * sizeof(noc_scene_mesh) + s->names.bytes;
}

void noc_scene_get_info(const noc_scene *scene, noc_scene_info *info) {
    if (!info)
        return;
    *info = (noc_scene_info){ 0 };
    if (!scene)
        return;
    *info = (noc_scene_info){ .triangles = scene->indices.len / 3,
                              .vertices = scene->positions.len / 3,
                              .meshes = scene->meshes.len,
                              .materials = scene->materials.len,
                              .lights = scene->lights.len,
                              .lights_inferred = scene->lights_inferred,
                              .triangles_dropped = scene->triangles_dropped,
                              .crs = scene->crs_name ? scene->crs_name : "" };
    info->given_crs = scene->given_crs_name ? scene->given_crs_name : info->crs;
    memcpy(info->given_origin, scene->given_crs_name ? scene->given_origin : scene->origin, sizeof(info->given_origin));
    for (size_t i = 0; i < scene->lights.len; i++)
        info->lights_by_kind[scene->lights.data[i].kind]++;
    for (size_t t = 0; t < scene->triangle_material.len; t++)
        info->triangles_by_class[scene->materials.data[scene->triangle_material.data[t]].cls]++;
    memcpy(info->origin, scene->origin, sizeof(info->origin));
    if (scene->indices.len) {
        memcpy(info->bounds_min, scene->bounds_min, sizeof(info->bounds_min));
        memcpy(info->bounds_max, scene->bounds_max, sizeof(info->bounds_max));
    }
    info->memory_bytes = noc_scene_bytes(scene);
}
