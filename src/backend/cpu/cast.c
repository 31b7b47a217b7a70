/* Rays of whoever picks, measures or walks: nearest hits, with all that is known of what they meet. They leave the view
 * as it is. */
#include "backend/cpu/cpu.h"

#include <math.h>

enum { ALONE = 256 / BLOCK, ITEM = 32 }; /* blocks that the calling thread traces itself; that a thread takes at once */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

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
static void place(const noc_scene *scene, const hitblock *h, int l, double p[3], double n[3]) {
    const uint32_t *corner = scene->indices.data + 3 * (size_t)h->triangle[l];
    double e[3], f[3];
    edges(scene, h->triangle[l], e, f, n);
    for (int k = 0; k < 3; k++)
        p[k] = scene->positions.data[3 * (size_t)corner[0] + (size_t)k] + h->u[l] * e[k] + h->v[l] * f[k];
    if (h->instance[l] != NO_INSTANCE) {
        const float *m = scene->instances.data[h->instance[l]].transform;
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
static void describe_image(const noc_scene *scene, const hitblock *h, int l, noc_hit *out) {
    float at[3][2];
    double u[2], v[2], e[3], f[3], n[3], scale2 = 1;
    if (!noc_scene_image_corners(scene, h->triangle[l], at))
        return;
    for (int k = 0; k < 2; k++) {
        u[k] = (double)at[1][k] - at[0][k];
        v[k] = (double)at[2][k] - at[0][k];
        out->image[k] = at[0][k] + h->u[l] * u[k] + h->v[l] * v[k];
    }
    edges(scene, h->triangle[l], e, f, n);
    if (h->instance[l] != NO_INSTANCE) {
        const float *t = scene->instances.data[h->instance[l]].transform;
        const double m[3] = { t[0], t[4], t[8] };
        scale2 = dot(m, m);
    }
    int texture = scene->materials.data[scene->triangle_material.data[h->triangle[l]]].texture;
    uint32_t size = scene->texels.data[scene->textures.data[texture - 1].place + 2];
    double texels = fabs(u[0] * v[1] - v[0] * u[1]) * (size & 0xffff) * (size >> 16);
    out->texels = sqrt(texels / fmax(scale2 * sqrt(dot(n, n)), 1e-30));
}

static void describe(const noc_scene *scene, const noc_ray *ray, const hitblock *h, int l, noc_hit *out) {
    uint32_t triangle = h->triangle[l], instance = h->instance[l];
    uint32_t material = scene->triangle_material.data[triangle], light = scene->triangle_light.data[triangle];
    double way[3];
    *out = (noc_hit){ .hit = true,
                      .cls = scene->materials.data[material].cls,
                      .material = (int)material,
                      .object = (int)noc_scene_object_of(scene, triangle),
                      .instance = instance != NO_INSTANCE ? (int)instance : -1,
                      .light = -1 };
    place(scene, h, l, out->place, out->normal);
    bool front = out->front = dot(out->normal, ray->direction) < 0;
    for (int k = 0; k < 3; k++) {
        way[k] = out->place[k] - ray->origin[k];
        out->normal[k] *= front ? 1 : -1;
    }
    out->distance = sqrt(dot(way, way));
    describe_image(scene, h, l, out);
    if (light == NOC_NO_LIGHT)
        return;
    out->light = (int)(instance != NO_INSTANCE ? scene->instances.data[instance].lights[light] : light);
    const noc_light_record *r = &scene->lights.data[out->light];
    out->shines = (front || r->flags & LIGHT_TWO_SIDED) && (r->e[0] > 0 || r->e[1] > 0 || r->e[2] > 0);
}

typedef struct casting {
    const cpu_world *world;
    const noc_ray *rays;
    size_t count;
    noc_hit *hits;
} casting;

static void cast_block(const casting *c, size_t first) {
    int count = (int)NOC_MIN((size_t)BLOCK, c->count - first);
    rayblock rays = { 0 };
    hitblock hits;
    float far = 0;
    for (int l = 0; l < count; l++) {
        const noc_ray *ray = &c->rays[first + (size_t)l];
        double length = sqrt(dot(ray->direction, ray->direction));
        for (int k = 0; k < 3; k++) {
            rays.o[k][l] = (float)ray->origin[k];
            rays.d[k][l] = (float)(ray->direction[k] / length);
        }
        far = fmaxf(far, (float)ray->far);
    }
    uint32_t valid = (1u << count) - 1;
    c->world->device->tracer->closest(c->world->rays, NOC_RAYS_NOW, &rays, far, valid, false, NULL, &hits);
    for (int l = 0; l < count; l++) {
        noc_hit *out = &c->hits[first + (size_t)l];
        *out = (noc_hit){ .material = -1, .object = -1, .instance = -1, .light = -1 };
        if (hits.triangle[l] != NO_HIT && hits.t[l] <= c->rays[first + (size_t)l].far)
            describe(c->world->scene, &c->rays[first + (size_t)l], &hits, l, out);
    }
}

static void cast_item(void *ctx, size_t item, int index) {
    const casting *c = ctx;
    size_t end = NOC_MIN(c->count, (item + 1) * ITEM * BLOCK);
    (void)index;
    for (size_t first = item * ITEM * BLOCK; first < end; first += BLOCK)
        cast_block(c, first);
}

noc_status noc_cpu_cast(void *state, const noc_ray *rays, size_t count, noc_hit *hits) {
    cpu_view *s = state;
    noc_status status = noc_cpu_follow(s->world);
    if (status != NOC_OK)
        return status;
    casting c = { s->world, rays, count, hits };
    if (count > ALONE * BLOCK)
        noc_pool_run(s->pool, (count + ITEM * BLOCK - 1) / (ITEM * BLOCK), cast_item, &c);
    else
        for (size_t first = 0; first < count; first += BLOCK)
            cast_block(&c, first);
    return NOC_OK;
}
