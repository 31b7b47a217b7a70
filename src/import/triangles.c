#include "import/import.h"
#include "scene/scene.h"

bool import_triangles(noc_scene *scene, const noc_mesh *mesh, geo_issues *issues) {
    size_t before = scene->triangles_dropped;
    if (noc_scene_add_mesh(scene, mesh) < 0)
        return false;
    for (; before < scene->triangles_dropped; before++)
        geo_issue(issues, false, "triangle without area, or with a coordinate that is no number or beyond all maps", mesh->name ? mesh->name : "unnamed");
    return true;
}
