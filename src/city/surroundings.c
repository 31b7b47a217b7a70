/* What lies beyond the city: land to the horizon, and skirts under walls that stand over a ground of ours. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define HORIZON 9000.0 /* m at least, from the middle */
#define RINGS 9
#define DEEPEST 8.0      /* m a building's lowest walls are extended */
#define DEEP 1.2         /* m those of its walls are that begin higher: more would close doors and passages */
#define STEP 6.0         /* m between the points of a skirt, */
#define STEPS 100e3      /* of all, and */
#define STEPS_A_FOOT 8.0 /* for each foot of a wall: beyond, points are farther apart. Cities have 2 to 4 */
#define INTO 0.15        /* m that skirts reach into the ground */

void city_add_surroundings(noc_scene *scene, const double *rim, size_t count, int material) {
    if (count < 3 || count > 100000)
        return;
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY }, mean = 0, middle[2], least = INFINITY;
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 2; k++) {
            lo[k] = NOC_MIN(lo[k], rim[3 * i + (size_t)k]);
            hi[k] = NOC_MAX(hi[k], rim[3 * i + (size_t)k]);
        }
        mean += rim[3 * i + 2] / (double)count;
    }
    for (int k = 0; k < 2; k++) {
        middle[k] = (lo[k] + hi[k]) / 2;
        least = NOC_MIN(least, (hi[k] - lo[k]) / 2);
    }
    /* rings are the rim, larger; heights go over into their mean */
    double growth = pow(NOC_CLAMP(HORIZON / NOC_MAX(least, 1), 10, 1e4), 1.0 / RINGS);
    double *xyz = noc_alloc((RINGS + 1) * count * 3 * sizeof(*xyz));
    uint32_t *indices = noc_alloc(RINGS * count * 6 * sizeof(*indices));
    size_t t = 0;
    if (!xyz || !indices)
        noc_scene_out_of_memory(scene);
    for (size_t r = 0; xyz && indices && r <= RINGS; r++)
        for (size_t i = 0; i < count; i++) {
            double scale = pow(growth, (double)r), level = NOC_MIN((double)r / 4, 1), *p = xyz + 3 * (r * count + i);
            for (int k = 0; k < 2; k++)
                p[k] = middle[k] + scale * (rim[3 * i + (size_t)k] - middle[k]);
            p[2] = rim[3 * i + 2] + level * level * (3 - 2 * level) * (mean - rim[3 * i + 2]);
            if (r == RINGS)
                continue;
            uint32_t a = (uint32_t)(r * count + i), b = (uint32_t)(r * count + (i + 1) % count), out = (uint32_t)count;
            const uint32_t quad[6] = { a, a + out, b + out, a, b + out, b };
            memcpy(indices + t, quad, sizeof(quad));
            t += 6;
        }
    noc_mesh mesh = { .vertex_count = (RINGS + 1) * count,
                      .positions = xyz,
                      .triangle_count = t / 3,
                      .indices = indices,
                      .material = material,
                      .name = "surroundings" };
    if (xyz && indices)
        noc_scene_add_backdrop(scene, &mesh);
    free(xyz);
    free(indices);
}

/* ---- skirts ---- */

typedef struct skirt {
    NOC_ARRAY(double) xyz;
    NOC_ARRAY(uint32_t) indices;
} skirt;

bool city_wall_foot(const float *a, const float *b, const float *c) {
    double length = hypot((double)b[0] - a[0], (double)b[1] - a[1]), rise = fabs((double)b[2] - a[2]);
    return length > .05 && rise < .3 * length && c[2] > NOC_MAX(a[2], b[2]) + .02;
}

static double steps_of(const float *a, const float *b, double step) {
    return NOC_CLAMP(ceil(hypot((double)b[0] - a[0], (double)b[1] - a[1]) / step), 1, 1000);
}

/* Down from the edge a, b to the terrain, where that lies lower, but not much lower. */
static void add_skirt(noc_scene *scene, skirt *s, const float *a, const float *b, double deepest, double step) {
    double gap = 0;
    int steps = (int)steps_of(a, b, step);
    size_t first = s->xyz.len;
    for (int i = 0; i <= steps; i++) {
        double u = (double)i / steps, p[3], z;
        for (int k = 0; k < 3; k++)
            p[k] = a[k] + u * ((double)b[k] - a[k]);
        if (!noc_scene_highest(scene, 1u << NOC_CLASS_TERRAIN, p[0], p[1], &z) || p[2] - z > deepest) {
            gap = 0;
            break;
        }
        gap = NOC_MAX(gap, p[2] - z);
        double foot[3] = { p[0], p[1], NOC_MIN(z, p[2]) - INTO };
        if (!array_append(&s->xyz, p, 3) || !array_append(&s->xyz, foot, 3)) {
            noc_scene_out_of_memory(scene);
            return;
        }
    }
    if (gap < .005) {
        s->xyz.len = first;
        return;
    }
    for (uint32_t i = 0, v = (uint32_t)(first / 3); i < (uint32_t)steps; i++, v += 2) {
        const uint32_t quad[6] = { v, v + 1, v + 3, v, v + 3, v + 2 };
        if (!array_append(&s->indices, quad, 6))
            noc_scene_out_of_memory(scene);
    }
}

/* The corners of a triangle of which corner i is the first. */
static void corners_from(const noc_scene *scene, const uint32_t *v, size_t i, const float *corner[3]) {
    for (size_t k = 0; k < 3; k++)
        corner[k] = scene->positions.data + 3 * (size_t)v[i - i % 3 + (i + k) % 3];
}

static bool has_feet(const noc_scene *scene, const noc_scene_mesh *mesh) {
    return scene->materials.data[mesh->material].cls == NOC_CLASS_WALL && !(mesh->aloft > 0);
}

/* m between the points: what small files can make of long walls is bounded. */
static double find_step(const noc_scene *scene, size_t first_mesh) {
    double feet = 0, steps = 0;
    for (size_t m = first_mesh; m < scene->meshes.len; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        const uint32_t *v = scene->indices.data + 3 * (size_t)mesh->first_triangle;
        const float *c[3];
        for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count && has_feet(scene, mesh); i++) {
            corners_from(scene, v, i, c);
            if (!city_wall_foot(c[0], c[1], c[2]))
                continue;
            feet++;
            steps += steps_of(c[0], c[1], STEP);
        }
    }
    double wider = steps / (STEPS + STEPS_A_FOOT * feet);
    if (wider > 1)
        noc_warn(scene->log, "foundations: walls are so long that they reach the ground in steps %.1f times as wide",
                 wider);
    return STEP * NOC_MAX(wider, 1);
}

void city_add_skirts(noc_scene *scene, size_t first_mesh) {
    double step = find_step(scene, first_mesh);
    size_t materials = scene->materials.len, meshes = scene->meshes.len;
    skirt *skirts = noc_calloc(materials, sizeof(*skirts));
    if (!skirts) {
        noc_scene_out_of_memory(scene);
        return;
    }
    for (size_t m = first_mesh; m < meshes && !scene->no_memory; m++) {
        const noc_scene_mesh *mesh = &scene->meshes.data[m];
        if (!has_feet(scene, mesh))
            continue;
        const uint32_t *v = scene->indices.data + 3 * (size_t)mesh->first_triangle;
        double lowest = INFINITY;
        for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
            lowest = NOC_MIN(lowest, scene->positions.data[3 * (size_t)v[i] + 2]);
        for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
            const float *corner[3];
            corners_from(scene, v, i, corner);
            if (city_wall_foot(corner[0], corner[1], corner[2]))
                add_skirt(scene, &skirts[mesh->material], corner[0], corner[1],
                          NOC_MIN(corner[0][2], corner[1][2]) < lowest + .1 ? DEEPEST : DEEP, step);
        }
    }
    for (size_t m = 0; m < materials; m++) {
        noc_mesh mesh = { .vertex_count = skirts[m].xyz.len / 3,
                          .positions = skirts[m].xyz.data,
                          .triangle_count = skirts[m].indices.len / 3,
                          .indices = skirts[m].indices.data,
                          .material = (int)m,
                          .name = "foundations" };
        if (mesh.triangle_count)
            noc_scene_add_mesh(scene, &mesh);
        array_free(&skirts[m].xyz);
        array_free(&skirts[m].indices);
    }
    free(skirts);
}
