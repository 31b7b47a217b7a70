/* Regions of objects: their triangles, as they face outwards. */
#include "scene/region_panes.h"

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

/* Triangle t; what lies on the ground faces up, however it is wound. false: it has no area. */
static bool triangle_patch(const noc_scene *s, size_t t, const float *m, noc_patch *patch) {
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
        return false;
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
    *patch = p;
    return true;
}

/* Half of a window that lies in its wall. */
static noc_patch window_patch(const noc_scene *s, const noc_scene_window *w, int half) {
    const noc_light_record *l = &s->lights.data[w->light];
    noc_patch p = { .material = s->facades.data[w->facade - 1].material };
    double n[3], length;
    for (int k = 0; k < 3; k++) {
        p.p[k] = l->p[k] + (half ? l->a[k] + l->b[k] : 0);
        p.u[k] = half ? -l->a[k] : l->a[k];
        p.v[k] = half ? -l->b[k] : l->b[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = (double)l->a[(k + 1) % 3] * (double)l->b[(k + 2) % 3] -
               (double)l->a[(k + 2) % 3] * (double)l->b[(k + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        p.n[k] = (float)(n[k] / fmax(length, 1e-30));
    p.weight = (float)(0.5 * length);
    return p;
}

/* Surfaces that are added. */
typedef struct adding {
    const noc_scene *scene;
    const char *name;    /* of meshes; NULL: any */
    uint32_t classes;    /* 1u << noc_class each */
    region_panes *panes; /* of the object; NULL: none */
    noc_region *to;
    bool found; /* an object of that name */
} adding;

static bool of_object(const adding *a, const noc_scene_mesh *mesh, uint32_t model) {
    return !mesh->removed && mesh->model == model && (!a->name || (mesh->name && strcmp(mesh->name, a->name) == 0));
}

static noc_status add_mesh(adding *a, const noc_scene_mesh *mesh, const float *m) {
    noc_status status = NOC_OK;
    noc_patch p;
    for (uint32_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count && !status; t++) {
        if (!triangle_patch(a->scene, t, m, &p))
            continue;
        if (a->panes && a->scene->materials.data[mesh->material].cls != NOC_CLASS_WINDOW)
            status = region_panes_cut(a->panes, &p, a->to);
        else
            status = array_push(&a->to->patches, p) ? NOC_OK : NOC_ERR_MEMORY;
    }
    return status;
}

/* m: NULL, or of the body that shows the model. */
static noc_status add_meshes(adding *a, uint32_t model, const float *m) {
    const noc_scene *s = a->scene;
    noc_status status = NOC_OK;
    for (size_t i = 0; i < s->meshes.len && !status; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        if (!of_object(a, mesh, model))
            continue;
        a->found = true;
        if (a->classes >> s->materials.data[mesh->material].cls & 1)
            status = add_mesh(a, mesh, m);
    }
    return status;
}

static bool window_of_object(const adding *a, const noc_scene_window *w) {
    const noc_scene *s = a->scene;
    return w->facade && !w->removed && of_object(a, &s->meshes.data[s->facades.data[w->facade - 1].mesh], 0);
}

/* Windows that lie in walls. */
static noc_status add_windows(const adding *a) {
    const noc_scene *s = a->scene;
    bool ok = true;
    for (size_t i = 0; i < s->windows.len && ok && a->classes >> NOC_CLASS_WINDOW & 1; i++)
        for (int half = 0; half < 2 && ok && window_of_object(a, &s->windows.data[i]); half++)
            ok = array_push(&a->to->patches, window_patch(s, &s->windows.data[i], half));
    return ok ? NOC_OK : NOC_ERR_MEMORY;
}

/* Bodies of lamps of that name. */
static noc_status add_bodies(adding *a, const char *id) {
    const noc_scene *s = a->scene;
    noc_status status = NOC_OK;
    adding body_of = { s, NULL, a->classes, NULL, a->to, false };
    for (size_t i = 0; i < s->bodies.len && !status; i++) {
        const noc_scene_body *body = &s->bodies.data[i];
        const char *name = s->light_names.data[body->light];
        float m[12];
        if (!name || strcmp(name, id) != 0)
            continue;
        noc_body_transform(body, m);
        status = add_meshes(&body_of, body->model, m);
    }
    a->found = a->found || body_of.found;
    return status;
}

/* The panes of all its windows. */
static bool find_panes(const adding *a, region_panes *panes) {
    const noc_scene *s = a->scene;
    noc_patch p;
    bool ok = true;
    for (size_t i = 0; i < s->meshes.len && ok; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        if (s->materials.data[mesh->material].cls != NOC_CLASS_WINDOW || !of_object(a, mesh, 0))
            continue;
        for (uint32_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count && ok; t++)
            ok = !triangle_patch(s, t, NULL, &p) || region_panes_add(panes, &p);
    }
    for (size_t i = 0; i < s->windows.len && ok; i++)
        for (int half = 0; half < 2 && ok && window_of_object(a, &s->windows.data[i]); half++) {
            p = window_patch(s, &s->windows.data[i], half);
            ok = region_panes_add(panes, &p);
        }
    region_panes_sort(panes);
    return ok;
}

static noc_status add_object(noc_region *region, const noc_scene *s, const char *id, uint32_t classes, bool *found) {
    region_panes panes = { .counted = classes >> NOC_CLASS_WINDOW & 1 };
    adding a = { s, id, classes, &panes, region, false };
    noc_status status = find_panes(&a, &panes) ? add_meshes(&a, 0, NULL) : NOC_ERR_MEMORY;
    status = status ? status : add_windows(&a);
    status = status ? status : add_bodies(&a, id);
    region_panes_free(&panes);
    *found = a.found;
    return status;
}

noc_status noc_region_add_object(noc_region *region, const noc_scene *s, const char *id, uint32_t classes) {
    if (!region || !s || !id)
        return noc_null(region ? region->log : NULL, __func__);
    bool found = false;
    size_t had = region->patches.len;
    classes = classes ? classes : ~(1u << NOC_CLASS_CLOSURE | 1u << NOC_CLASS_GROUND);
    noc_scene_lock_read(s);
    noc_status status = add_object(region, s, id, classes, &found);
    noc_scene_unlock_read(s);
    if (status) {
        region->patches.len = had;
        return status == NOC_ERR_MEMORY
                   ? noc_no_memory(region->log, "region")
                   : noc_error(
                         region->log, NOC_ERR_ARGUMENT,
                         "region: object \"%.100s\": the windows before its walls cut them into more than %d pieces, "
                         "or overlap too often",
                         id, REGION_PIECES);
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
