/* Lights and the shapes they show. */
#include "scene/scene.h"

#include <math.h>

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double length(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* Two unit vectors u, v with u x v = n / |n|. */
static void frame(const double n[3], double u[3], double v[3]) {
    double l = length(n), z[3] = { n[0] / l, n[1] / l, n[2] / l };
    double helper[3] = { fabs(z[0]) < 0.5, fabs(z[0]) >= 0.5, 0 };
    cross(helper, z, u);
    l = length(u);
    for (int i = 0; i < 3; i++)
        u[i] /= l;
    cross(z, u, v);
}

static bool all_finite(const double *v, int n) {
    for (int i = 0; i < n; i++)
        if (!(fabs(v[i]) < 1e7))
            return false;
    return true;
}

enum { DISC_SIDES = 24 };

static size_t disc_shape(const noc_light *l, const double u[3], const double v[3], double *xyz, uint32_t *indices) {
    for (int i = 0; i < DISC_SIDES; i++) {
        double t = 2 * M_PI * i / DISC_SIDES;
        for (int k = 0; k < 3; k++)
            xyz[3 * i + k] = l->position[k] + l->radius * (cos(t) * u[k] + sin(t) * v[k]);
    }
    for (uint32_t i = 0; i + 2 < DISC_SIDES; i++) {
        indices[3 * i] = 0;
        indices[3 * i + 1] = i + 1;
        indices[3 * i + 2] = i + 2;
    }
    return DISC_SIDES;
}

enum { SPHERE_RINGS = 8, SPHERE_SIDES = 12 };

/* Inscribed, so that no point of the true sphere lies behind its own shape. */
static size_t sphere_shape(const noc_light *l, double *xyz, uint32_t *indices, size_t *triangles) {
    size_t n = 0, t = 0;
    for (int j = 0; j <= SPHERE_RINGS; j++)
        for (int i = 0; i < SPHERE_SIDES; i++, n++) {
            double theta = M_PI * j / SPHERE_RINGS, phi = 2 * M_PI * i / SPHERE_SIDES;
            xyz[3 * n] = l->position[0] + l->radius * sin(theta) * cos(phi);
            xyz[3 * n + 1] = l->position[1] + l->radius * sin(theta) * sin(phi);
            xyz[3 * n + 2] = l->position[2] + l->radius * cos(theta);
        }
    for (uint32_t j = 0; j < SPHERE_RINGS; j++)
        for (uint32_t i = 0; i < SPHERE_SIDES; i++) {
            uint32_t a = j * SPHERE_SIDES + i, b = j * SPHERE_SIDES + (i + 1) % SPHERE_SIDES;
            uint32_t c = a + SPHERE_SIDES, d = b + SPHERE_SIDES;
            uint32_t quad[6] = { a, c, d, a, d, b };
            for (int k = 0; k < 6; k += 3) {
                if ((k == 3 && j == 0) || (k == 0 && j == SPHERE_RINGS - 1))
                    continue; /* the poles' degenerate halves */
                memcpy(indices + 3 * t++, quad + k, 3 * sizeof(uint32_t));
            }
        }
    *triangles = t;
    return n;
}

/* The material that shows a light: emits, reflects nothing. Lights of one colour share it. */
static int light_material(noc_scene *scene, const noc_light *l) {
    noc_material m = { .roughness = 1, .cls = NOC_CLASS_LAMP, .two_sided = false };
    memcpy(m.emission, l->emission, sizeof(m.emission));
    for (size_t i = scene->materials.len; i-- > 0 && i + 256 > scene->materials.len;) {
        const noc_material *have = &scene->materials.data[i];
        if (have->cls == m.cls && have->albedo[0] == 0 && have->albedo[1] == 0 && have->albedo[2] == 0 && have->f0 == 0 &&
            !have->two_sided && !memcmp(have->emission, m.emission, sizeof(m.emission)))
            return (int)i;
    }
    return noc_scene_add_material(scene, &m);
}

static bool is_round(const noc_light *l) { return l->kind == NOC_LIGHT_SPHERE || l->kind == NOC_LIGHT_DISC; }
static bool is_flat(const noc_light *l) { return l->kind == NOC_LIGHT_TRIANGLE || l->kind == NOC_LIGHT_PARALLELOGRAM; }

/* Of the parallelogram or triangle that the edges span. */
static double flat_area(const noc_light *l) {
    double n[3];
    cross(l->edge_u, l->edge_v, n);
    return length(n) * (l->kind == NOC_LIGHT_TRIANGLE ? 0.5 : 1);
}

/* What is wrong with a light, NULL if nothing. */
static const char *light_fault(const noc_light *l) {
    if ((unsigned)l->kind > NOC_LIGHT_POINT)
        return "unknown kind";
    if (!all_finite(l->position, 3))
        return "its position is not finite, or further than 10 000 km from the origin";
    for (int i = 0; i < 3; i++)
        if (!(l->emission[i] >= 0 && l->emission[i] <= 1e12f))
            return "its emission is negative or not finite";
    if (is_round(l) && !(l->radius >= 1e-4 && l->radius < 1e5))
        return "its radius must be in 0.0001..100000 m";
    if (l->kind == NOC_LIGHT_DISC && !(all_finite(l->direction, 3) && length(l->direction) > 0))
        return "a disc needs a direction";
    if (is_flat(l) && (!all_finite(l->edge_u, 3) || !all_finite(l->edge_v, 3) || !(flat_area(l) > 1e-10)))
        return "its edges span no area";
    return NULL;
}

static noc_light_record record_of(const noc_light *l) {
    noc_light_record r = { .kind = (uint32_t)l->kind,
                           .flags = (l->inferred ? 2u : 0u) | (l->moving ? NOC_LIGHT_MOVES : 0u),
                           .radius = l->kind == NOC_LIGHT_POINT ? 0 : (float)l->radius };
    double u[3] = { 0 }, v[3] = { 0 };
    if (l->kind == NOC_LIGHT_DISC)
        frame(l->direction, u, v);
    if (l->kind == NOC_LIGHT_SPHERE)
        r.area = (float)(4 * M_PI * l->radius * l->radius);
    else if (l->kind == NOC_LIGHT_DISC)
        r.area = (float)(M_PI * l->radius * l->radius);
    else if (is_flat(l))
        r.area = (float)flat_area(l);
    for (int k = 0; k < 3; k++) {
        r.p[k] = (float)l->position[k];
        r.a[k] = (float)(is_flat(l) ? l->edge_u[k] : l->radius * u[k]);
        r.b[k] = (float)(is_flat(l) ? l->edge_v[k] : l->radius * v[k]);
        r.e[k] = l->emission[k];
    }
    return r;
}

static size_t flat_shape(const noc_light *l, double *xyz, uint32_t *indices) {
    bool whole = l->kind == NOC_LIGHT_PARALLELOGRAM;
    for (int k = 0; k < 3; k++) {
        xyz[k] = l->position[k];
        xyz[3 + k] = l->position[k] + l->edge_u[k];
        xyz[6 + k] = l->position[k] + whole * l->edge_u[k] + l->edge_v[k];
        xyz[9 + k] = l->position[k] + l->edge_v[k];
    }
    memcpy(indices, (uint32_t[]){ 0, 1, 2, 0, 2, 3 }, 6 * sizeof(uint32_t));
    return whole ? 4 : 3;
}

/* The mesh that shows the light of this index. */
static bool add_shape(noc_scene *scene, const noc_light *l, uint32_t index) {
    double xyz[3 * (SPHERE_RINGS + 1) * SPHERE_SIDES], u[3], v[3];
    uint32_t indices[3 * 2 * SPHERE_RINGS * SPHERE_SIDES];
    size_t vertices, triangles;
    if (l->kind == NOC_LIGHT_SPHERE) {
        vertices = sphere_shape(l, xyz, indices, &triangles);
    } else if (l->kind == NOC_LIGHT_DISC) {
        frame(l->direction, u, v);
        vertices = disc_shape(l, u, v, xyz, indices);
        triangles = DISC_SIDES - 2;
    } else {
        vertices = flat_shape(l, xyz, indices);
        triangles = vertices - 2;
    }
    int material = light_material(scene, l);
    size_t first = scene->triangle_light.len;
    noc_mesh mesh = { .vertex_count = vertices, .positions = xyz, .triangle_count = triangles, .indices = indices,
                      .material = material, .name = l->name };
    if (material < 0 || noc_scene_add_mesh(scene, &mesh) < 0)
        return false;
    for (size_t t = first; t < scene->triangle_light.len; t++)
        scene->triangle_light.data[t] = index;
    return true;
}

int noc_scene_add_light(noc_scene *scene, const noc_light *l) {
    if (!scene || !l) {
        noc_null(scene ? scene->log : NULL, __func__);
        return -1;
    }
    if (scene->no_memory)
        return -1;
    const char *wrong = scene->committed ? "the scene is committed" : light_fault(l);
    if (wrong) {
        noc_error(scene->log, NOC_ERR_ARGUMENT, "light %s: %s", l->name ? l->name : "unnamed", wrong);
        return -1;
    }
    uint32_t index = (uint32_t)scene->lights.len;
    if (!array_try_reserve(&scene->lights, scene->lights.len + 1) || !array_try_reserve(&scene->light_names, scene->lights.len + 1)) {
        noc_scene_out_of_memory(scene);
        return -1;
    }
    if (l->kind != NOC_LIGHT_POINT && !l->moving && !add_shape(scene, l, index))
        return -1;
    array_push(&scene->lights, record_of(l));
    array_push(&scene->light_names, arena_strdup(&scene->names, l->name));
    if (l->moving)
        array_push(&scene->moving, index);
    scene->lights_inferred += l->inferred;
    return (int)index;
}

noc_status noc_scene_move_light(noc_scene *scene, int index, const noc_light *to) {
    if (!scene || !to)
        return noc_null(scene ? scene->log : NULL, __func__);
    if (!scene->committed)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "light %d: only lights of a committed scene are moved", index);
    if (index < 0 || (size_t)index >= scene->lights.len)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "light %d: the scene has %zu lights", index, scene->lights.len);
    noc_light_record *have = &scene->lights.data[index];
    const char *name = scene->light_names.data[index], *wrong = light_fault(to);
    if (!(have->flags & NOC_LIGHT_MOVES))
        wrong = "it was not made to move";
    else if (have->kind != (uint32_t)to->kind)
        wrong = "a light's kind cannot change";
    if (wrong)
        return noc_error(scene->log, NOC_ERR_ARGUMENT, "light %d (%s): %s", index, name ? name : "unnamed", wrong);
    noc_light_record r = record_of(to);
    r.flags = have->flags;
    if (!memcmp(have, &r, sizeof(r)))
        return NOC_OK;
    scene->power_changes += memcmp(have->e, r.e, sizeof(r.e)) || have->area != r.area;
    scene->moves++;
    *have = r;
    return NOC_OK;
}
