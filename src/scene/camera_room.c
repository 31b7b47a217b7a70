/* A view from inside, for models that are rooms: seen from outside they are boxes, dark ones.
 *
 * Vertical rays know only what is highest, a ceiling, so the few rays that are needed are tested against every
 * triangle. */
#include "scene/camera.h"

#include <math.h>

enum { GRID = 12, PLACES = 8, FAN = 5 };

#define COVERED 0.9    /* share of the floor, and of the light, that has something above it in a room */
#define MOST_TESTS 2e8 /* rays times triangles: a second or so */

/* Does the light shine into what lies below the ceiling at height z? One let into the ceiling looks down from it, or
 * both ways. */
static bool is_below(const noc_light_record *r, const double p[3], double z, double slack) {
    bool down = r->kind != NOC_LIGHT_TRIANGLE || (r->flags & LIGHT_TWO_SIDED) || r->a[0] * r->b[1] < r->a[1] * r->b[0];
    return z > p[2] + slack || (down && z >= p[2] - slack);
}

/* Is nearly all of the plan covered by something in the upper half of the model, and nearly all light below it? */
static bool is_room(const noc_scene *s, const double lo[3], const double hi[3]) {
    int covered = 0;
    double light = 0, below = 0, z, middle = 0.5 * (lo[2] + hi[2]);
    for (int j = 0; j < GRID; j++)
        for (int i = 0; i < GRID; i++) {
            double x = lo[0] + (i + 0.5) / GRID * (hi[0] - lo[0]), y = lo[1] + (j + 0.5) / GRID * (hi[1] - lo[1]);
            covered += noc_scene_top(s, x, y, &z) && z > middle;
        }
    if (covered < COVERED * GRID * GRID)
        return false;
    size_t stride = s->lights.len / 4096 + 1;
    for (size_t i = 0; i < s->lights.len; i += stride) {
        const noc_light_record *r = &s->lights.data[i];
        double p[3], weight = noc_light_weight(r);
        noc_light_centre(r, p);
        light += weight;
        if (noc_scene_top(s, p[0], p[1], &z) && z > middle && is_below(r, p, z, 1e-3 * (hi[2] - lo[2])))
            below += weight;
    }
    return light > 0 && below >= COVERED * light;
}

/* Distance from `from` along the unit vector d to the nearest triangle, at most `most` (Moeller and Trumbore 1997). */
static double ray_distance(const noc_scene *s, const double from[3], const double d[3], double most) {
    size_t n = noc_scene_city_triangles(s);
    for (size_t i = 0; i < n; i++) {
        const uint32_t *v = &s->indices.data[3 * noc_scene_city_triangle(s, i)];
        const float *a = &s->positions.data[3 * (size_t)v[0]], *b = &s->positions.data[3 * (size_t)v[1]],
                    *c = &s->positions.data[3 * (size_t)v[2]];
        double e[3], f[3], r[3], p[3], q[3];
        for (int k = 0; k < 3; k++)
            e[k] = (double)b[k] - (double)a[k], f[k] = (double)c[k] - (double)a[k], r[k] = from[k] - (double)a[k];
        for (int k = 0; k < 3; k++) {
            int x = (k + 1) % 3, y = (k + 2) % 3;
            p[k] = d[x] * f[y] - d[y] * f[x];
            q[k] = r[x] * e[y] - r[y] * e[x];
        }
        double det = e[0] * p[0] + e[1] * p[1] + e[2] * p[2], u = r[0] * p[0] + r[1] * p[1] + r[2] * p[2];
        double w = d[0] * q[0] + d[1] * q[1] + d[2] * q[2], t = f[0] * q[0] + f[1] * q[1] + f[2] * q[2];
        if (det < 0)
            det = -det, u = -u, w = -w, t = -t;
        if (u >= 0 && w >= 0 && u + w <= det && t > 0 && t < most * det)
            most = t / det;
    }
    return most;
}

/* How much a camera takes in: the mean of how far a fan of rays over its picture gets. Nothing before its nose. */
static double room_seen(const noc_scene *s, const noc_camera *c, double aspect, double most, int fan) {
    double look[3], right[3], up[3], length = 0, sum = 0, nearest = most;
    for (int k = 0; k < 3; k++)
        look[k] = c->target[k] - c->eye[k], length += look[k] * look[k];
    for (int k = 0; k < 3; k++)
        look[k] /= sqrt(length);
    double flat = hypot(look[0], look[1]), t = tan(c->fov_deg * M_PI / 360);
    memcpy(right, (double[3]){ look[1] / flat, -look[0] / flat, 0 }, sizeof(right));
    for (int k = 0; k < 3; k++)
        up[k] = right[(k + 1) % 3] * look[(k + 2) % 3] - right[(k + 2) % 3] * look[(k + 1) % 3];
    for (int j = 0; j < fan; j++)
        for (int i = 0; i < fan; i++) {
            double d[3], x = (2 * (i + 0.5) / fan - 1) * t * aspect, y = (2 * (j + 0.5) / fan - 1) * t,
                         n = sqrt(1 + x * x + y * y);
            for (int k = 0; k < 3; k++)
                d[k] = (look[k] + x * right[k] + y * up[k]) / n;
            double far = ray_distance(s, c->eye, d, most);
            nearest = NOC_MIN(nearest, far);
            sum += far / (fan * fan);
        }
    return sum * NOC_MIN(1, 0.05 + 12 * nearest / most);
}

bool noc_room_camera(const noc_scene *s, const double lo[3], const double hi[3], double aspect, noc_camera *camera) {
    if (!is_room(s, lo, hi))
        return false;
    double size[3], centre[3], best = 0, diagonal = 0;
    for (int k = 0; k < 3; k++) {
        size[k] = hi[k] - lo[k];
        centre[k] = 0.5 * (lo[k] + hi[k]);
        diagonal = hypot(diagonal, size[k]);
    }
    if (!(size[0] > 0 && size[1] > 0 && size[2] > 0))
        return false;
    int fan = (double)noc_scene_city_triangles(s) * PLACES * FAN * FAN > MOST_TESTS ? 2 : FAN;
    for (int i = 0; i < PLACES; i++) { /* from corners and sides, a little above the middle, to the middle */
        noc_camera c = { .up = { 0, 0, 1 }, .fov_deg = 65 };
        double yaw = 2 * M_PI * i / PLACES - 0.75 * M_PI;
        double reach = 0.43 / NOC_MAX(fabs(cos(yaw)), fabs(sin(yaw)));
        memcpy(c.target, (double[3]){ centre[0], centre[1], lo[2] + 0.42 * size[2] }, sizeof(c.target));
        memcpy(c.eye,
               (double[3]){ centre[0] + reach * cos(yaw) * size[0], centre[1] + reach * sin(yaw) * size[1],
                            lo[2] + 0.56 * size[2] },
               sizeof(c.eye));
        double seen = room_seen(s, &c, aspect, diagonal, fan);
        if (seen > best * 1.0001) {
            best = seen;
            *camera = c;
        }
    }
    return best > 0;
}
