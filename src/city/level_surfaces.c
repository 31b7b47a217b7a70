/* Surfaces that lie level at a height that is none: outlines of roads, lawns and water of a model whose coordinates
 * have 0 where a height would be, beside buildings that stand at 40 m. They are told by what stands around them, and
 * laid on it. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define LEVEL 0.01 /* m between the highest and the lowest corner, and between surfaces at one height */
#define OFF 3.0    /* m that a surface is believed beside a building */
#define STEEP 0.2  /* and more, for each metre to where the city tells its height */
#define MANY 10    /* surfaces at one height that is not 0 */
#define NEARLY_ALL 0.9
#define LIFT 0.02 /* m over the ground, which is laid under them */

/* A mesh that is level. */
typedef struct level {
    uint32_t mesh;
    double z;
} level;

typedef struct levels {
    noc_scene *scene;
    const city_ground *around; /* by buildings alone */
    NOC_ARRAY(level) all;
} levels;

static const float *vertex(const noc_scene *s, size_t i) { return s->positions.data + 3 * i; }

static noc_class class_of(const noc_scene *s, size_t mesh) {
    return s->materials.data[s->meshes.data[mesh].material].cls;
}

static bool may_be_level(const noc_scene *s, size_t mesh) {
    noc_class cls = class_of(s, mesh);
    return cls == NOC_CLASS_ROAD || cls == NOC_CLASS_SIDEWALK || cls == NOC_CLASS_GREEN || cls == NOC_CLASS_WATER ||
           s->meshes.data[mesh].land;
}

static bool find_levels(levels *l, size_t first, size_t end) {
    const noc_scene *s = l->scene;
    for (size_t m = first; m < end; m++) {
        const noc_scene_mesh *mesh = &s->meshes.data[m];
        double lo = INFINITY, hi = -INFINITY;
        if (!may_be_level(s, m) || !noc_mesh_in_city(s, mesh))
            continue;
        for (size_t v = mesh->first_vertex; v < noc_mesh_end_vertex(s, m); v++) {
            lo = NOC_MIN(lo, (double)vertex(s, v)[2]);
            hi = NOC_MAX(hi, (double)vertex(s, v)[2]);
        }
        if (hi - lo <= LEVEL && !array_push(&l->all, (level){ (uint32_t)m, lo }))
            return false;
    }
    return true;
}

static int by_height(const void *a, const void *b) {
    const level *x = a, *y = b;
    return x->z != y->z ? (x->z > y->z) - (x->z < y->z) : (x->mesh > y->mesh) - (x->mesh < y->mesh);
}

/* Height of what stands around a place: terrain, else the feet of buildings. */
static bool told(const levels *l, double x, double y, double *z, double *distance) {
    *distance = 0;
    if (noc_scene_highest(l->scene, 1u << NOC_CLASS_TERRAIN, x, y, z))
        return true;
    if (!l->around)
        return false;
    *z = city_ground_height(l->around, x, y, distance);
    return isfinite(*distance) && isfinite(*z);
}

/* Do surfaces first to end, at one height, lie where nothing around them does? Water alone does not tell: lakes lie
 * level, and below their shores. */
static bool is_none(const levels *l, size_t first, size_t end, double *off) {
    const noc_scene *s = l->scene;
    size_t asked = 0, against = 0;
    double sum = 0;
    for (size_t i = first; i < end; i++) {
        size_t m = l->all.data[i].mesh, begin = s->meshes.data[m].first_vertex, stop = noc_mesh_end_vertex(s, m);
        size_t step = (stop - begin) / 64 + 1;
        for (size_t v = begin; v < stop && class_of(s, m) != NOC_CLASS_WATER; v += step) {
            double z, distance;
            const float *p = vertex(s, v);
            if (!told(l, p[0], p[1], &z, &distance))
                continue;
            asked++;
            if (!(fabs(p[2] - z) > OFF + STEEP * distance))
                continue;
            against++;
            sum += p[2] - z;
        }
    }
    *off = against ? sum / (double)against : 0;
    return against && (double)against >= NEARLY_ALL * (double)asked && fabs(*off) > OFF;
}

/* off: what they are above their surroundings; a corner around which nothing tells a height moves by as much. */
static void lay(const levels *l, size_t first, size_t end, double off) {
    noc_scene *s = l->scene;
    for (size_t i = first; i < end; i++) {
        size_t m = l->all.data[i].mesh;
        for (size_t v = s->meshes.data[m].first_vertex; v < noc_mesh_end_vertex(s, m); v++) {
            float *p = s->positions.data + 3 * v;
            double z, distance;
            bool known = told(l, p[0], p[1], &z, &distance);
            p[2] = (float)((known ? z : p[2] - off) + LIFT);
        }
    }
}

static void measure(noc_scene *s) {
    s->bounds_min[2] = INFINITY;
    s->bounds_max[2] = -INFINITY;
    for (size_t m = 0; m < s->meshes.len; m++)
        for (size_t v = s->meshes.data[m].first_vertex;
             v < noc_mesh_end_vertex(s, m) && noc_mesh_in_city(s, &s->meshes.data[m]); v++) {
            s->bounds_min[2] = NOC_MIN(s->bounds_min[2], (double)vertex(s, v)[2]);
            s->bounds_max[2] = NOC_MAX(s->bounds_max[2], (double)vertex(s, v)[2]);
        }
}

static noc_status lay_levels(levels *l, double zero, city_level_fn tell, void *user) {
    bool moved = false;
    qsort(l->all.data, l->all.len, sizeof(*l->all.data), by_height);
    for (size_t first = 0, end; first < l->all.len; first = end) {
        double z = l->all.data[first].z, off;
        for (end = first + 1; end < l->all.len && l->all.data[end].z - z <= LEVEL;)
            end++;
        bool many = end - first >= MANY && 2 * (end - first) >= l->all.len;
        if (!(fabs(z - zero) <= LEVEL || many) || !is_none(l, first, end, &off))
            continue;
        lay(l, first, end, off);
        moved = true;
        for (size_t i = first; i < end; i++)
            tell(user, l->scene->meshes.data[l->all.data[i].mesh].name, z - zero, off);
    }
    if (!moved)
        return NOC_OK;
    measure(l->scene);
    noc_ground_free(l->scene->ground); /* it knows where they were */
    l->scene->ground = NULL;
    return NOC_OK;
}

noc_status city_lay_level_surfaces(noc_scene *scene, size_t first, size_t end, double zero, city_level_fn tell,
                                   void *user) {
    levels l = { .scene = scene };
    noc_status status = NOC_OK;
    if (!find_levels(&l, first, end)) {
        noc_scene_out_of_memory(scene);
        status = NOC_ERR_MEMORY;
    } else if (l.all.len) {
        city_ground *around = city_ground_of_buildings(scene);
        l.around = around;
        status = scene->no_memory ? NOC_ERR_MEMORY : lay_levels(&l, zero, tell, user);
        if (around)
            city_ground_free(around);
    }
    array_free(&l.all);
    return status;
}
