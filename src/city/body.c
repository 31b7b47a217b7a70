/* Bodies of the user's: meshes of one scene become meshes of a model in another one. */
#include "city/city.h"
#include "scene/scene.h"

int city_body_material(noc_scene *to, const noc_scene *from, int index, noc_class cls) {
    noc_material material = from->materials.data[index];
    material.cls = cls;
    material.texture = 0;
    memset(material.emission, 0, sizeof(material.emission));
    return noc_scene_add_material(to, &material);
}

void city_body_corner(const noc_scene *s, size_t i, double out[3]) {
    const float *p = &s->positions.data[3 * (size_t)s->indices.data[i]];
    for (int k = 0; k < 3; k++)
        out[k] = p[k];
}

noc_status city_body_mesh(noc_scene *to, const noc_scene *from, const noc_scene_mesh *mesh, int model, int material,
                          const double move[12]) {
    size_t corners = 3 * (size_t)mesh->triangle_count;
    double *xyz = noc_alloc((corners + 1) * 3 * sizeof(*xyz));
    uint32_t *indices = noc_alloc((corners + 1) * sizeof(*indices));
    noc_status status = xyz && indices ? NOC_OK : noc_scene_out_of_memory(to);
    for (size_t i = 0; i < corners && !status; i++) {
        double p[3];
        city_body_corner(from, 3 * (size_t)mesh->first_triangle + i, p);
        indices[i] = (uint32_t)i;
        for (int k = 0; k < 3; k++)
            xyz[3 * i + (size_t)k] =
                move[4 * k] * p[0] + move[4 * k + 1] * p[1] + move[4 * k + 2] * p[2] + move[4 * k + 3];
    }
    const noc_mesh one = { .vertex_count = corners,
                           .positions = xyz,
                           .triangle_count = mesh->triangle_count,
                           .indices = indices,
                           .material = material,
                           .model = model };
    if (!status && (material < 0 || noc_scene_add_mesh(to, &one) < 0))
        status = to->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    free(xyz);
    free(indices);
    return status;
}
