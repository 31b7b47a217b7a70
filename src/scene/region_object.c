/* Regions of objects: their triangles, as they face outwards. */
#include "scene/region.h"
#include "scene/scene.h"

#include <math.h>

static bool is_ground(noc_class cls) {
    return cls == NOC_CLASS_TERRAIN || cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK || cls == NOC_CLASS_GREEN ||
           cls == NOC_CLASS_WATER || cls == NOC_CLASS_BRIDGE || cls == NOC_CLASS_GROUND;
}

/* Where a corner of triangle t is; m: of the body that shows it, NULL: none does. */
static void corner(const noc_scene *s, size_t t, int i, const float *m, float out[3]) {
    const float *p = s->positions.data + 3 * (size_t)s->indices.data[3 * t + (size_t)i];
    for (int k = 0; k < 3; k++)
        out[k] = m ? m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3] : p[k];
}

/* Triangle t; what lies on the ground faces up, however it is wound. */
static bool add_triangle(const noc_scene *s, size_t t, const float *m, noc_region *to) {
    float a[3], b[3], c[3];
    corner(s, t, 0, m, a);
    corner(s, t, 1, m, b);
    corner(s, t, 2, m, c);
    noc_patch p = { .material = s->triangle_material.data[t] };
    double u[3], w[3], n[3], length;
    for (int k = 0; k < 3; k++) {
        p.p[k] = a[k];
        u[k] = p.u[k] = b[k] - a[k];
        w[k] = p.v[k] = c[k] - a[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 1e-12))
        return true;
    bool turned = n[2] < 0 && is_ground(s->materials.data[p.material].cls);
    for (int k = 0; k < 3; k++)
        p.n[k] = (float)(n[k] / length * (turned ? -1 : 1));
    p.weight = (float)(0.5 * length);
    float at[3][2];
    p.textured = noc_scene_image_corners(s, t, at);
    for (int k = 0; k < 2 && p.textured; k++) {
        p.image[k] = at[0][k];
        p.image_u[k] = at[1][k] - at[0][k];
        p.image_v[k] = at[2][k] - at[0][k];
    }
    return array_push(&to->patches, p);
}

/* Of meshes of that name and model, those of these classes. m: NULL, or of the body that shows the model. */
static bool add_meshes(const noc_scene *s, const char *name, uint32_t model, uint32_t classes, const float *m,
                       noc_region *to, bool *found) {
    bool ok = true;
    for (size_t i = 0; i < s->meshes.len && ok; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        if (mesh->removed || mesh->model != model || (name && (!mesh->name || strcmp(mesh->name, name) != 0)))
            continue;
        *found = true;
        if (classes >> s->materials.data[mesh->material].cls & 1)
            for (uint32_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count && ok; t++)
                ok = add_triangle(s, t, m, to);
    }
    return ok;
}

/* Bodies of lamps of that name. */
static bool add_bodies(const noc_scene *s, const char *id, uint32_t classes, noc_region *to, bool *found) {
    bool ok = true;
    for (size_t i = 0; i < s->bodies.len && ok; i++) {
        const noc_scene_body *body = &s->bodies.data[i];
        const char *name = s->light_names.data[body->light];
        float m[12];
        if (!name || strcmp(name, id) != 0)
            continue;
        noc_body_transform(body, m);
        ok = add_meshes(s, NULL, body->model, classes, m, to, found);
    }
    return ok;
}

noc_status noc_region_add_object(noc_region *region, const noc_scene *s, const char *id, uint32_t classes) {
    if (!region || !s || !id)
        return noc_null(region ? region->log : NULL, __func__);
    bool found = false, ok;
    size_t had = region->patches.len;
    classes = classes ? classes : ~(1u << NOC_CLASS_CLOSURE | 1u << NOC_CLASS_GROUND);
    noc_scene_lock_read(s);
    ok = add_meshes(s, id, 0, classes, NULL, region, &found) && add_bodies(s, id, classes, region, &found);
    noc_scene_unlock_read(s);
    if (!ok) {
        region->patches.len = had;
        return noc_no_memory(region->log, "region");
    }
    if (!found)
        return NOC_ERR_ARGUMENT;
    return region->patches.len > had
               ? NOC_OK
               : noc_error(region->log, NOC_ERR_ARGUMENT, "region: object \"%.100s\" has no such surfaces", id);
}

size_t noc_scene_object_slots(const noc_scene *s) {
    if (!s)
        return 0;
    noc_scene_lock_read(s);
    size_t count = s->meshes.len + s->bodies.len;
    noc_scene_unlock_read(s);
    return count;
}
