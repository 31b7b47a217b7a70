#include "import/import.h"
#include "scene/scene.h"

bool import_triangles(noc_scene *scene, const noc_mesh *mesh, geo_issues *issues) {
    const char *name = mesh->name ? mesh->name : "unnamed";
    size_t before = scene->triangles_dropped, flat_before = scene->triangles_flat;
    if (noc_scene_add_mesh(scene, mesh) < 0)
        return false;
    size_t flat = scene->triangles_flat - flat_before, others = scene->triangles_dropped - before - flat;
    geo_issues_add(issues, GEO_SPARED, "triangle without area", flat, name);
    geo_issues_add(issues, GEO_SKIPPED, "triangle with a coordinate that is no number or beyond all maps", others,
                   name);
    return true;
}

static noc_status add_material(void *ctx, const noc_material *material, const char *name, const mesh_image *image,
                               int *index) {
    const mesh_scene *to = ctx;
    *index = noc_scene_add_material(to->scene, material);
    if (*index < 0)
        return NOC_ERR_ARGUMENT; /* said by the scene */
    if (name && *name && noc_scene_name_material(to->scene, *index, name))
        return NOC_ERR_MEMORY;
    return image && to->place->image ? to->place->image(to->place->ctx, *index, image) : NOC_OK;
}

static noc_status add_mesh(void *ctx, noc_mesh *mesh, double *positions) {
    const mesh_scene *to = ctx;
    noc_status status = to->place->points(to->place->ctx, positions, mesh->vertex_count);
    if (!status && mesh->triangle_count && !import_triangles(to->scene, mesh, to->issues))
        status = NOC_ERR_UNSUPPORTED;
    return status;
}

mesh_parts mesh_scene_parts(mesh_scene *to) {
    return (mesh_parts){
        .ctx = to, .log = to->scene->log, .issues = to->issues, .material = add_material, .mesh = add_mesh
    };
}
