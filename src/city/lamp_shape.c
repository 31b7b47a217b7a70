/* Poles, arms and housings: few triangles, because a city has tens of thousands of lamps. */
#include "city/lamp.h"

#include <math.h>

static uint32_t vertex(lamp_shape *s, double x, double y, double z) {
    double p[3] = { x, y, z };
    s->no_memory = !array_append(&s->xyz, p, 3) || s->no_memory;
    return (uint32_t)(s->xyz.len / 3 - 1);
}

static void triangle(lamp_shape *s, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t t[3] = { a, b, c };
    s->no_memory = !array_append(&s->indices, t, 3) || s->no_memory;
}

static void quad(lamp_shape *s, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    triangle(s, a, b, c);
    triangle(s, a, c, d);
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void shape_pole(lamp_shape *s, const double foot[3], double top_z, double foot_radius, double top_radius) {
    enum { SIDES = 6 };
    uint32_t low[SIDES], high[SIDES];
    for (int i = 0; i < SIDES; i++) {
        double c = cos(2 * M_PI * i / SIDES), d = sin(2 * M_PI * i / SIDES);
        low[i] = vertex(s, foot[0] + foot_radius * c, foot[1] + foot_radius * d, foot[2]);
        high[i] = vertex(s, foot[0] + top_radius * c, foot[1] + top_radius * d, top_z);
    }
    for (int i = 0; i < SIDES; i++) {
        int k = (i + 1) % SIDES;
        quad(s, low[i], low[k], high[k], high[i]);
    }
    for (int i = 1; i + 1 < SIDES; i++)
        triangle(s, high[0], high[i], high[i + 1]);
}

void shape_bar(lamp_shape *s, const double from[3], const double to[3], double half_width) {
    double d[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] }, u[3], v[3];
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (!(length > 1e-6))
        return;
    for (int k = 0; k < 3; k++)
        d[k] /= length;
    const double up[3] = { 0, fabs(d[2]) > .9, fabs(d[2]) <= .9 };
    cross(d, up, u);
    length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++)
        u[k] *= half_width / length;
    cross(d, u, v);
    static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    uint32_t a[4], b[4];
    for (int i = 0; i < 4; i++) {
        double o[3];
        for (int k = 0; k < 3; k++)
            o[k] = sign[i][0] * u[k] + sign[i][1] * v[k];
        a[i] = vertex(s, from[0] + o[0], from[1] + o[1], from[2] + o[2]);
        b[i] = vertex(s, to[0] + o[0], to[1] + o[1], to[2] + o[2]);
    }
    for (int i = 0; i < 4; i++) {
        int k = (i + 1) % 4;
        quad(s, a[i], a[k], b[k], b[i]);
    }
}

void shape_housing(lamp_shape *s, const double centre[3], const double look[3], const double along[3],
                   double half_length, double half_width, double depth) {
    double side[3];
    cross(look, along, side);
    static const int sign[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
    uint32_t face[4], back[4];
    for (int i = 0; i < 4; i++) {
        double p[3], q[3];
        for (int k = 0; k < 3; k++) {
            double o = sign[i][0] * half_length * along[k] + sign[i][1] * half_width * side[k];
            p[k] = centre[k] + o;
            q[k] = centre[k] + .7 * o - depth * look[k]; /* narrower at the back */
        }
        face[i] = vertex(s, p[0], p[1], p[2]);
        back[i] = vertex(s, q[0], q[1], q[2]);
    }
    quad(s, face[0], face[1], face[2], face[3]);
    quad(s, back[3], back[2], back[1], back[0]);
    for (int i = 0; i < 4; i++) {
        int k = (i + 1) % 4;
        quad(s, face[k], face[i], back[i], back[k]);
    }
}

int shape_material(noc_scene *scene) {
    noc_material m = noc_class_material(NOC_CLASS_LAMP);
    for (size_t i = 0; i < scene->materials.len; i++) {
        const noc_material *have = &scene->materials.data[i];
        if (have->cls == m.cls && have->f0 == m.f0 && have->roughness == m.roughness &&
            !memcmp(have->albedo, m.albedo, sizeof(m.albedo)) &&
            !memcmp(have->emission, m.emission, sizeof(m.emission)))
            return (int)i;
    }
    return noc_scene_add_material(scene, &m);
}

bool shape_add(lamp_shape *s, noc_scene *scene, const double foot[3], const double facing[2], const char *name) {
    if (s->no_memory)
        noc_scene_out_of_memory(scene);
    if (!s->indices.len)
        return !s->no_memory;
    for (double *p = s->xyz.data; p < s->xyz.data + s->xyz.len; p += 3) {
        double x = p[0], y = p[1];
        p[0] = foot[0] + facing[0] * x - facing[1] * y;
        p[1] = foot[1] + facing[1] * x + facing[0] * y;
        p[2] += foot[2];
    }
    noc_mesh mesh = { .vertex_count = s->xyz.len / 3,
                      .positions = s->xyz.data,
                      .triangle_count = s->indices.len / 3,
                      .indices = s->indices.data,
                      .material = shape_material(scene),
                      .name = name };
    return mesh.material >= 0 && noc_scene_add_mesh(scene, &mesh) >= 0;
}

void shape_free(lamp_shape *s) {
    array_free(&s->xyz);
    array_free(&s->indices);
}
