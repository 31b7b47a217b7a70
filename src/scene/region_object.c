/* Regions of objects: their triangles, as they face outwards. */
#include "scene/region.h"
#include "scene/scene.h"

#include <math.h>

static bool is_ground(noc_class cls) {
    return cls == NOC_CLASS_TERRAIN || cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK || cls == NOC_CLASS_GREEN ||
           cls == NOC_CLASS_WATER || cls == NOC_CLASS_BRIDGE || cls == NOC_CLASS_GROUND;
}

/* Triangle t; what lies on the ground faces up, however it is wound. */
static bool add_triangle(const noc_scene *s, size_t t, noc_region *to) {
    const uint32_t *v = s->indices.data + 3 * t;
    const float *a = s->positions.data + 3 * (size_t)v[0], *b = s->positions.data + 3 * (size_t)v[1],
                *c = s->positions.data + 3 * (size_t)v[2];
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

noc_status noc_region_add_object(noc_region *region, const noc_scene *s, const char *id, uint32_t classes) {
    if (!region || !s || !id)
        return noc_null(region ? region->log : NULL, __func__);
    bool found = false, ok = true;
    size_t had = region->patches.len;
    classes = classes ? classes : ~(1u << NOC_CLASS_CLOSURE | 1u << NOC_CLASS_GROUND);
    noc_scene_lock_read(s);
    for (size_t i = 0; i < s->meshes.len && ok; i++) {
        const noc_scene_mesh *m = &s->meshes.data[i];
        if (m->removed || m->model || !m->name || strcmp(m->name, id) != 0)
            continue;
        found = true;
        if (classes >> s->materials.data[m->material].cls & 1)
            for (uint32_t t = m->first_triangle; t < m->first_triangle + m->triangle_count && ok; t++)
                ok = add_triangle(s, t, region);
    }
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
    size_t count = s->meshes.len;
    noc_scene_unlock_read(s);
    return count;
}
