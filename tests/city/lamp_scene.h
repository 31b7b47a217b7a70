/* Scenes to stand lamps in: planes and buildings. */
#ifndef NOC_TEST_LAMP_SCENE_H
#define NOC_TEST_LAMP_SCENE_H

#include "../test.h"

#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

static const city_lamp_params defaults = { .height = 6, .lumens = 5000, .kelvin = 3000 };

static inline int material(noc_scene *scene, noc_class cls) {
    noc_material m = noc_class_material(cls);
    return noc_scene_add_material(scene, &m);
}

static inline void add_plane(noc_scene *scene, noc_class cls, double x0, double y0, double x1, double y1, double z,
                             double slope) {
    double xyz[12] = { x0, y0, z + slope * x0, x1, y0, z + slope * x1, x1, y1, z + slope * x1, x0, y1, z + slope * x0 };
    noc_mesh mesh = { .vertex_count = 4,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                      .material = material(scene, cls) };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
}

/* Walls (counter-clockwise from outside) and a flat roof. */
static inline void add_building(noc_scene *scene, double x0, double y0, double x1, double y1, double z0, double z1) {
    double xyz[24] = { x0, y0, z0, x1, y0, z0, x1, y1, z0, x0, y1, z0, x0, y0, z1, x1, y0, z1, x1, y1, z1, x0, y1, z1 };
    uint32_t walls[24];
    for (uint32_t i = 0, n = 0; i < 4; i++) {
        uint32_t a = i, b = (i + 1) % 4, quad[6] = { a, b, b + 4, a, b + 4, a + 4 };
        memcpy(walls + n, quad, sizeof(quad));
        n += 6;
    }
    noc_mesh mesh = { .vertex_count = 8,
                      .positions = xyz,
                      .triangle_count = 8,
                      .indices = walls,
                      .material = material(scene, NOC_CLASS_WALL) };
    assert_true(noc_scene_add_mesh(scene, &mesh) >= 0);
    noc_mesh roof = { .vertex_count = 8,
                      .positions = xyz,
                      .triangle_count = 2,
                      .indices = (uint32_t[]){ 4, 5, 6, 4, 6, 7 },
                      .material = material(scene, NOC_CLASS_ROOF) };
    assert_true(noc_scene_add_mesh(scene, &roof) >= 0);
}

/* Corners of the triangles that a ray meets, of the world and of bodies where they stand: numbered one after the
 * other. *light: the light that it shows, or NOC_NO_LIGHT. false: there are no more. */
static inline bool standing_triangle(const noc_scene *s, size_t number, double v[3][3], uint32_t *light) {
    const noc_scene_body *body = NULL;
    size_t t = SIZE_MAX;
    for (size_t b = 0; b <= s->bodies.len && t == SIZE_MAX; b++)
        for (size_t i = 0; i < s->meshes.len && t == SIZE_MAX; i++) {
            const noc_scene_mesh *m = &s->meshes.data[i];
            body = b ? &s->bodies.data[b - 1] : NULL;
            if (m->model != (body ? body->model : 0))
                continue;
            if (number < m->triangle_count)
                t = m->first_triangle + number;
            number -= m->triangle_count;
        }
    for (int i = 0; i < 3 && t != SIZE_MAX; i++) {
        uint32_t vertex = s->indices.data[3 * t + (size_t)i];
        float p[3];
        memcpy(p, s->positions.data + 3 * (size_t)vertex, sizeof(p));
        if (body)
            noc_body_vertex(s, body, vertex, p);
        for (int k = 0; k < 3; k++)
            v[i][k] = p[k];
    }
    *light = t != SIZE_MAX ? s->triangle_light.data[t] : NOC_NO_LIGHT;
    return t != SIZE_MAX;
}

static inline geo_lamp lamp_at(double x, double y) {
    return (geo_lamp){ .xyz = { x, y, NAN },
                       .height = NAN,
                       .direction = NAN,
                       .lumens = NAN,
                       .watts = NAN,
                       .kelvin = NAN,
                       .rgb = { -1, -1, -1 },
                       .id = "lamp" };
}

#endif
