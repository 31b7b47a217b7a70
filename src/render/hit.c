/* All that is known of what a ray met: noc_hit. */
#include "core/blocks.h"
#include "render/backend.h"
#include "scene/facade.h"

#include <math.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double noc_ray_length(const noc_ray *ray) { return sqrt(dot(ray->direction, ray->direction)); }

/* Edges from the first corner, and their product: twice the area along the normal. */
static void edges(const noc_scene *scene, uint32_t triangle, double e[3], double f[3], double n[3]) {
    const uint32_t *corner = scene->indices.data + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++) {
        double a = scene->positions.data[3 * (size_t)corner[0] + (size_t)k];
        e[k] = scene->positions.data[3 * (size_t)corner[1] + (size_t)k] - a;
        f[k] = scene->positions.data[3 * (size_t)corner[2] + (size_t)k] - a;
    }
    for (int k = 0; k < 3; k++)
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
}

/* Place and unit normal on the triangle, in doubles. */
static void place(const noc_scene *scene, const noc_met *h, double p[3], double n[3]) {
    const uint32_t *corner = scene->indices.data + 3 * (size_t)h->triangle;
    double e[3], f[3];
    edges(scene, h->triangle, e, f, n);
    for (int k = 0; k < 3; k++)
        p[k] = scene->positions.data[3 * (size_t)corner[0] + (size_t)k] + h->u * e[k] + h->v * f[k];
    if (h->instance != NO_INSTANCE) {
        float m[12];
        noc_placed_transform(scene, h->instance, m);
        double q[3] = { p[0], p[1], p[2] }, t[3] = { n[0], n[1], n[2] };
        for (int k = 0; k < 3; k++) {
            p[k] = m[4 * k] * q[0] + m[4 * k + 1] * q[1] + m[4 * k + 2] * q[2] + m[4 * k + 3];
            n[k] = m[4 * k] * t[0] + m[4 * k + 1] * t[1] + m[4 * k + 2] * t[2];
        }
    }
    double length = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++)
        n[k] = length > 0 ? n[k] / length : k == 2;
}

/* Where it lies in its texture's image, and how fine that is there. */
static void describe_image(const noc_scene *scene, const noc_met *h, noc_hit *out) {
    float at[3][2];
    double u[2], v[2], e[3], f[3], n[3], scale2 = 1;
    if (!noc_scene_image_corners(scene, h->triangle, at))
        return;
    for (int k = 0; k < 2; k++) {
        u[k] = (double)at[1][k] - at[0][k];
        v[k] = (double)at[2][k] - at[0][k];
        out->image[k] = at[0][k] + h->u * u[k] + h->v * v[k];
    }
    edges(scene, h->triangle, e, f, n);
    if (h->instance != NO_INSTANCE) {
        float t[12];
        noc_placed_transform(scene, h->instance, t);
        const double m[3] = { t[0], t[4], t[8] };
        scale2 = dot(m, m);
    }
    int texture = scene->materials.data[scene->triangle_material.data[h->triangle]].texture;
    uint32_t size = scene->texels.data[scene->textures.data[texture - 1].place + 2];
    double texels = fabs(u[0] * v[1] - v[0] * u[1]) * (size & 0xffff) * (size >> 16);
    out->texels = sqrt(texels / fmax(scale2 * sqrt(dot(n, n)), 1e-30));
}

void noc_describe_hit(const noc_scene *scene, const noc_ray *ray, const noc_met *h, noc_hit *out) {
    uint32_t triangle = h->triangle, instance = h->instance;
    uint32_t material = scene->triangle_material.data[triangle], light = scene->triangle_light.data[triangle];
    double way[3];
    *out = (noc_hit){ .hit = true,
                      .object = (int)noc_scene_object_of(scene, triangle, instance),
                      .instance = instance < NOC_BODIES ? (int)instance : -1,
                      .light = -1 };
    place(scene, h, out->place, out->normal);
    const noc_facade_record *facade = instance == NO_INSTANCE ? noc_scene_facade_of(scene, triangle) : NULL;
    const float at[3] = { (float)out->place[0], (float)out->place[1], (float)out->place[2] };
    uint32_t window = facade ? noc_facade_light(scene, facade, at) : NOC_NO_LIGHT;
    if (window != NOC_NO_LIGHT) {
        material = facade->material;
        light = window;
    }
    out->cls = scene->materials.data[material].cls;
    out->material = (int)material;
    bool front = out->front = dot(out->normal, ray->direction) < 0;
    for (int k = 0; k < 3; k++) {
        way[k] = out->place[k] - ray->origin[k];
        out->normal[k] *= front ? 1 : -1;
    }
    out->distance = sqrt(dot(way, way));
    if (window == NOC_NO_LIGHT)
        describe_image(scene, h, out);
    if (light == NOC_NO_LIGHT)
        return;
    out->light = (int)(instance != NO_INSTANCE ? noc_placed_light(scene, instance, light) : light);
    const noc_light_record *r = &scene->lights.data[out->light];
    out->shines = (front || r->flags & LIGHT_TWO_SIDED) && (r->e[0] > 0 || r->e[1] > 0 || r->e[2] > 0);
}
