#include "city/builtin/kit.h"

#include <math.h>

vec3 unit(vec3 a) {
    double l = sqrt(dot(a, a));
    return l > 0 ? scale(a, 1 / l) : a;
}

kit kit_start(noc_scene *scene) {
    kit k = { .scene = scene };
    kit_place(&k, v3(0, 0, 0), 0, 1);
    return k;
}

noc_status kit_finish(kit *k) {
    array_free(&k->xyz);
    array_free(&k->indices);
    /* what failed was reported where it did */
    return k->scene->no_memory ? NOC_ERR_MEMORY : k->failed ? NOC_ERR_ARGUMENT : NOC_OK;
}

int kit_material(kit *k, float r, float g, float b, float f0, float roughness) {
    noc_material m = { .albedo = { r, g, b }, .f0 = f0, .roughness = roughness, .cls = NOC_CLASS_OTHER };
    int index = noc_scene_add_material(k->scene, &m);
    k->failed = k->failed || index < 0;
    return index;
}

void kit_place(kit *k, vec3 at, double turns, double size) {
    double c = turns == 0 ? 1 : town_cos(turns), s = turns == 0 ? 0 : town_sin(turns);
    k->origin = at;
    k->axis[0] = v3(c * size, s * size, 0);
    k->axis[1] = v3(-s * size, c * size, 0);
    k->axis[2] = v3(0, 0, size);
}

void kit_flush(kit *k, int material, const char *name) {
    noc_mesh mesh = { .vertex_count = k->xyz.len / 3,
                      .positions = k->xyz.data,
                      .triangle_count = k->indices.len / 3,
                      .indices = k->indices.data,
                      .material = material,
                      .name = name };
    if (!k->failed && k->indices.len)
        k->failed = noc_scene_add_mesh(k->scene, &mesh) < 0;
    k->xyz.len = k->indices.len = 0;
}

/* ---- surfaces ---- */

static uint32_t vertex(kit *k, vec3 p) {
    vec3 q = add(k->origin, add(scale(k->axis[0], p.x), add(scale(k->axis[1], p.y), scale(k->axis[2], p.z))));
    if (!array_append(&k->xyz, &q.x, 3))
        k->failed = noc_scene_out_of_memory(k->scene);
    return (uint32_t)(k->xyz.len / 3 - 1);
}

/* Two triangles, less those that have no area because corners meet (poles of spheres). */
static void quad(kit *k, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const uint32_t corner[2][3] = { { a, b, c }, { a, c, d } };
    for (int t = 0; t < 2 && !k->failed; t++) {
        vec3 p[3];
        for (int i = 0; i < 3; i++) {
            const double *v = &k->xyz.data[3 * (size_t)corner[t][i]];
            p[i] = v3(v[0], v[1], v[2]);
        }
        vec3 n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
        if (dot(n, n) > 1e-20 && !array_append(&k->indices, corner[t], 3))
            k->failed = noc_scene_out_of_memory(k->scene);
    }
}

void kit_patch(kit *k, int nu, int nv, kit_surface surface, const void *shape) {
    uint32_t first = (uint32_t)(k->xyz.len / 3), row = (uint32_t)nu + 1;
    for (int j = 0; j <= nv; j++)
        for (int i = 0; i <= nu; i++)
            vertex(k, surface(shape, (double)i / nu, (double)j / nv));
    for (uint32_t j = 0; j < (uint32_t)nv; j++)
        for (uint32_t i = 0; i < (uint32_t)nu; i++) {
            uint32_t a = first + j * row + i;
            quad(k, a, a + 1, a + row + 1, a + row);
        }
}

void kit_quad(kit *k, vec3 a, vec3 b, vec3 c, vec3 d) {
    uint32_t first = vertex(k, a);
    vertex(k, b);
    vertex(k, c);
    vertex(k, d);
    quad(k, first, first + 1, first + 2, first + 3);
}

void kit_box(kit *k, vec3 lo, vec3 hi) {
    vec3 p[8];
    for (int i = 0; i < 8; i++)
        p[i] = v3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
    static const int face[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                    { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    for (int i = 0; i < 6; i++)
        kit_quad(k, p[face[i][0]], p[face[i][1]], p[face[i][2]], p[face[i][3]]);
}

static vec3 turned(const void *shape, double u, double v) {
    const kit_lathe *l = shape;
    double at = v * (l->count - 1), q[2];
    int i = NOC_CLAMP((int)at, 0, l->count - 2), before = NOC_MAX(i - 1, 0), after = NOC_MIN(i + 2, l->count - 1);
    double f = at - i;
    for (int c = 0; c < 2; c++) {
        double p0 = l->profile[before][c], p1 = l->profile[i][c], p2 = l->profile[i + 1][c], p3 = l->profile[after][c];
        q[c] = l->smooth
                   ? p1 + 0.5 * f * (p2 - p0 + f * (2 * p0 - 5 * p1 + 4 * p2 - p3 + f * (3 * (p1 - p2) + p3 - p0)))
                   : p1 + f * (p2 - p1);
    }
    double r = NOC_MAX(q[0], 0);
    if (l->flutes)
        r *= 1 - l->depth * 0.5 * (1 - town_cos(u * l->flutes));
    u = u < 1 ? u : 0; /* closed to the last bit */
    return v3(r * town_cos(u), r * town_sin(u), q[1]);
}

void kit_turned(kit *k, int sides, int rings, const kit_lathe *lathe) { kit_patch(k, sides, rings, turned, lathe); }

static vec3 ball(const void *shape, double u, double v) {
    double r = v > 0 && v < 1 ? town_sin(0.5 * v) : 0;
    u = u < 1 ? u : 0;
    return unit(v3(r * town_cos(u), r * town_sin(u), -town_cos(0.5 * v)));
}

void kit_sphere(kit *k, int sides, int rings) { kit_patch(k, sides, rings, ball, NULL); }

static vec3 ring(const void *shape, double u, double v) {
    double tube = *(const double *)shape;
    u = u < 1 ? u : 0;
    v = v < 1 ? v : 0;
    double r = 1 + tube * town_cos(v);
    return v3(r * town_cos(u), r * town_sin(u), tube * town_sin(v));
}

void kit_torus(kit *k, int nu, int nv, double tube) { kit_patch(k, nu, nv, ring, &tube); }

static vec3 knot_axis(const kit_knot *n, double u) {
    double r = 1 + n->ring * town_cos(n->q * u);
    return v3(r * town_cos(n->p * u), r * town_sin(n->p * u), n->ring * town_sin(n->q * u));
}

static vec3 knot(const void *shape, double u, double v) {
    const kit_knot *n = shape;
    u = u < 1 ? u : 0;
    v = v < 1 ? v : 0;
    vec3 p = knot_axis(n, u), t = unit(sub(knot_axis(n, u + 0.002), knot_axis(n, u - 0.002)));
    /* the torus's own normal: never along the knot, and back where it was after one turn */
    vec3 out = v3(town_cos(n->q * u) * town_cos(n->p * u), town_cos(n->q * u) * town_sin(n->p * u), town_sin(n->q * u));
    vec3 a = unit(sub(out, scale(t, dot(out, t)))), b = cross(t, a);
    double r = n->tube * (1 + 0.16 * town_cos(n->lobes * v + n->twist * u)) * (1 + 0.06 * town_sin(n->ribs * u));
    /* against the turn from a to b = t x a, so that du x dv leaves the tube */
    return add(p, add(scale(a, r * town_cos(v)), scale(b, -r * town_sin(v))));
}

void kit_knotted(kit *k, int nu, int nv, const kit_knot *n) { kit_patch(k, nu, nv, knot, n); }

/* ---- lights and cameras ---- */

void kit_light(kit *k, const noc_light *light) { k->failed = k->failed || noc_scene_add_light(k->scene, light) < 0; }

void kit_camera(kit *k, vec3 eye, vec3 target, double fov_deg) {
    noc_camera c = { .eye = { eye.x, eye.y, eye.z },
                     .target = { target.x, target.y, target.z },
                     .up = { 0, 0, 1 },
                     .fov_deg = fov_deg };
    k->failed = k->failed || noc_scene_set_camera(k->scene, &c) != NOC_OK;
}
