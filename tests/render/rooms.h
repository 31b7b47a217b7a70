/* Scenes and pictures for the tests of render and its backends. */
#ifndef NOC_TEST_ROOMS_H
#define NOC_TEST_ROOMS_H

#include "../test.h"
#include "../own_view.h"

#include "base/base.h"
#include "render/backend.h"

#include <math.h>

static inline int matte(noc_scene *s, float albedo) {
    return noc_scene_add_material(s, &(noc_material){ .albedo = { albedo, albedo, albedo }, .roughness = 1 });
}

static inline int grey_of(noc_scene *s, noc_class cls) {
    return noc_scene_add_material(s, &(noc_material){ .albedo = { .5f, .5f, .5f }, .roughness = 1, .cls = cls });
}

/* A parallelogram at p with edges a, b; faces a x b. Of the object of that name, which may be NULL. */
static inline void named_quad(noc_scene *s, int material, const char *name, const double p[3], const double a[3],
                              const double b[3]) {
    double xyz[12];
    for (int k = 0; k < 3; k++) {
        xyz[k] = p[k];
        xyz[3 + k] = p[k] + a[k];
        xyz[6 + k] = p[k] + a[k] + b[k];
        xyz[9 + k] = p[k] + b[k];
    }
    noc_mesh m = { .vertex_count = 4,
                   .positions = xyz,
                   .triangle_count = 2,
                   .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                   .material = material,
                   .name = name };
    assert_true(noc_scene_add_mesh(s, &m) >= 0);
}

static inline void add_quad(noc_scene *s, int material, const double p[3], const double a[3], const double b[3]) {
    named_quad(s, material, NULL, p, a, b);
}

#define QUAD(s, m, px, py, pz, ax, ay, az, bx, by, bz)                                                                 \
    add_quad(s, m, (double[3]){ px, py, pz }, (double[3]){ ax, ay, az }, (double[3]){ bx, by, bz })

/* A horizontal square floor around (x, y) at height z, seen from above. */
static inline void add_floor(noc_scene *s, int material, double x, double y, double z, double half) {
    QUAD(s, material, x - half, y - half, z, 2 * half, 0, 0, 0, 2 * half, 0);
}

static inline noc_camera look(double ex, double ey, double ez, double tx, double ty, double tz, double fov) {
    return (noc_camera){ .eye = { ex, ey, ez }, .target = { tx, ty, tz }, .up = { 0, 0, 1 }, .fov_deg = fov };
}

static inline void point_light(noc_scene *s, double x, double y, double z, float candela) {
    noc_light l = { .kind = NOC_LIGHT_POINT, .position = { x, y, z }, .emission = { candela, candela, candela } };
    assert_true(noc_scene_add_light(s, &l) >= 0);
}

/* The i-th of a crowd of lights of all kinds, before a wall at y = 6. */
static inline noc_light crowd_light(int i, double y) {
    return (noc_light){ .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                        .inner_deg = 30,
                        .outer_deg = 60,
                        .position = { -7 + 0.31 * i, y - 0.2 * (i % 5), 1 + i % 7 },
                        .edge_u = { 0.4, 0, 0 },
                        .edge_v = { 0, 0, 0.7 },
                        .direction = { 0, -1, -0.5 },
                        .radius = 0.1,
                        .emission = { 20.f + (float)i, 25, 10 } };
}

/* Params for measurements: no sky, no jitter. */
static inline noc_render_params measure(int width, int height, noc_method method) {
    noc_render_params p = noc_render_default_params();
    p.width = width;
    p.height = height;
    p.method = method;
    p.sky = 0;
    p.jitter = false;
    return p;
}

static inline double luma(const float *c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/* The picture of `frames` accumulated frames with a fresh renderer. */
static inline noc_image *render(const noc_scene *s, const noc_camera *c, const noc_render_params *p, int frames) {
    noc_view *r = own_view(s, 0, NULL);
    assert_non_null(r);
    for (int i = 0; i < frames; i++)
        assert_int_equal(noc_view_render(r, c, p, NULL), NOC_OK);
    noc_image *image = noc_view_image(r);
    assert_non_null(image);
    close_view(r);
    return image;
}

/* The point of a horizontal plane that a pixel's centre sees. */
static inline void floor_point(const noc_camera *c, const noc_render_params *p, int x, int y, double z, double out[3]) {
    frame_camera f;
    noc_make_frame_camera(c, p, 0, &f);
    double sx = 2 * (x + 0.5) / p->width - 1, sy = 1 - 2 * (y + 0.5) / p->height, d[3];
    for (int k = 0; k < 3; k++)
        d[k] = f.forward[k] + sx * f.right[k] + sy * f.up[k];
    double t = (z - c->eye[2]) / d[2];
    for (int k = 0; k < 3; k++)
        out[k] = c->eye[k] + t * d[k];
}

#endif
