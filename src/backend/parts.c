/* Policy of what is built together: see parts.h. */
#include "backend/parts.h"

#include <math.h>

bool noc_part_has(const noc_scene *scene, const noc_scene_mesh *mesh, uint32_t model) {
    return !mesh->removed && mesh->model == model && !noc_mesh_closes(scene, mesh);
}

void noc_part_count(const noc_scene *scene, uint32_t model, noc_part *part) {
    part->meshes = part->triangles = part->newest = 0;
    for (size_t i = part->first_mesh; i < part->end_mesh; i++) {
        const noc_scene_mesh *m = &scene->meshes.data[i];
        if (!noc_part_has(scene, m, model))
            continue;
        part->meshes++;
        part->newest = NOC_MAX(part->newest, m->made);
        part->triangles += m->triangle_count;
    }
}

size_t noc_parts_plan(const noc_scene *scene, const noc_part *have, size_t count, noc_part *out, bool *keep) {
    size_t n = 0, end = 0;
    for (; n < count; n++) {
        out[n] = have[n];
        noc_part_count(scene, 0, &out[n]);
        keep[n] = out[n].meshes == have[n].meshes && out[n].newest == have[n].newest;
        end = have[n].end_mesh;
    }
    out[n] = (noc_part){ .first_mesh = end, .end_mesh = scene->meshes.len };
    noc_part_count(scene, 0, &out[n]);
    keep[n] = false;
    n += out[n].triangles > 0 || !n;
    for (; n > 1 && 2 * out[n - 1].triangles >= out[n - 2].triangles; n--) {
        out[n - 2].end_mesh = out[n - 1].end_mesh;
        out[n - 2].triangles += out[n - 1].triangles;
        keep[n - 2] = false;
    }
    return n;
}

/* 2^-19 of the largest coordinate, at most 0.1 mm: where a scene is small, so are the gaps in it. Vertices are rounded
 * to 2^-24 of theirs. */
void noc_ray_scale_follow(const noc_scene *s, noc_ray_scale *r) {
    for (size_t mesh = 0; mesh < s->meshes.len; mesh++) {
        const noc_scene_mesh *m = &s->meshes.data[mesh];
        if ((m->first_vertex >= r->vertices || m->made > r->made) && !m->model && !noc_mesh_closes(s, m))
            for (size_t i = 3 * (size_t)m->first_vertex; i < 3 * noc_mesh_end_vertex(s, mesh); i++)
                r->largest = NOC_MAX(r->largest, fabsf(s->positions.data[i]));
    }
    for (size_t i = 0; i < s->instances.len; i++) {
        double box[2][3] = { { 0 } };
        if (s->instances.data[i].model)
            noc_join_instance_bounds(s, &s->instances.data[i], box[0], box[1]);
        for (int k = 0; k < 6; k++)
            r->largest = NOC_MAX(r->largest, fabsf((float)box[k / 3][k % 3]));
    }
    double box[2][3] = { { 0 } };
    noc_join_body_bounds(s, box[0], box[1]);
    for (int k = 0; k < 6; k++)
        r->largest = NOC_MAX(r->largest, fabsf((float)box[k / 3][k % 3]));
    r->vertices = s->positions.len / 3;
    r->made = (uint32_t)s->versions.geometry;
    r->offset = NOC_MIN(r->largest * 0x1p-19f, 1e-4f);
}
