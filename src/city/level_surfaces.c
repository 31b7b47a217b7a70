/* What lies at a height that is none: surfaces of roads, lawns and water, and buildings made of outlines, of a model
 * whose coordinates have 0 where a height would be, beside buildings that stand at 40 m. They are told by what stands
 * around them, and laid on it. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define LEVEL 0.01 /* m between the highest and the lowest corner, and between surfaces at one height */
#define OFF 3.0    /* m that a surface is believed beside a building */
#define STEEP 0.2  /* and more, for each metre to where the city tells its height */
#define NEAR 50.0  /* m to where it does, for a height within that to count as the same */
#define MANY 10    /* surfaces at one height that is not 0 */
#define NEARLY_ALL 0.9
#define LIFT 0.02 /* m over the ground, which is laid under them */

/* Meshes that are level, or stand on a level foot. */
typedef struct level {
    uint32_t first, end;
    double z;
    bool block;    /* moves as a whole */
    size_t number; /* of an outline */
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
        if (hi - lo <= LEVEL && !array_push(&l->all, (level){ .first = (uint32_t)m, .end = (uint32_t)m + 1, .z = lo }))
            return false;
    }
    return true;
}

static int by_height(const void *a, const void *b) {
    const level *x = a, *y = b;
    return x->z != y->z ? (x->z > y->z) - (x->z < y->z) : (x->first > y->first) - (x->first < y->first);
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

/* What the vertices of levels say of their height. */
typedef struct evidence {
    size_t asked, against;
    double sum; /* of those against, m above their surroundings */
} evidence;

/* A vertex that is far from what tells a height, and off it, says nothing. */
static void weigh(const levels *l, const float *p, evidence *e) {
    double z, distance;
    if (!told(l, p[0], p[1], &z, &distance))
        return;
    double off = p[2] - z, slack = OFF + STEEP * distance;
    bool against = fabs(off) > slack;
    e->asked += against || fabs(off) <= OFF || distance <= NEAR;
    e->against += against;
    e->sum += against ? off : 0;
}

/* Do levels first to end, at one height, lie where nothing around them does? Water alone does not tell: lakes lie
 * level, and below their shores. */
static bool is_none(const levels *l, size_t first, size_t end, double *off) {
    const noc_scene *s = l->scene;
    evidence e = { 0 };
    for (size_t i = first; i < end; i++) {
        const level *v = &l->all.data[i];
        size_t begin = s->meshes.data[v->first].first_vertex, stop = noc_mesh_end_vertex(s, v->end - 1);
        size_t step = v->block ? 1 : (stop - begin) / 64 + 1;
        for (size_t k = begin; k < stop && class_of(s, v->first) != NOC_CLASS_WATER; k += step)
            if (!v->block || vertex(s, k)[2] - v->z <= LEVEL)
                weigh(l, vertex(s, k), &e);
    }
    *off = e.against ? e.sum / (double)e.against : 0;
    return e.against && (double)e.against >= NEARLY_ALL * (double)e.asked && fabs(*off) > OFF;
}

/* A block moves to the lowest ground under its foot. off: what its kind is above its surroundings, where nothing tells.
 */
static void lay_block(const levels *l, const level *v, double off) {
    noc_scene *s = l->scene;
    size_t begin = s->meshes.data[v->first].first_vertex, stop = noc_mesh_end_vertex(s, v->end - 1);
    double lowest = INFINITY, z, distance;
    for (size_t k = begin; k < stop; k++)
        if (vertex(s, k)[2] - v->z <= LEVEL && told(l, vertex(s, k)[0], vertex(s, k)[1], &z, &distance))
            lowest = NOC_MIN(lowest, z);
    float rise = (float)(isfinite(lowest) ? lowest - v->z : -off);
    for (size_t k = begin; k < stop; k++)
        s->positions.data[3 * k + 2] += rise;
}

/* off: what they are above their surroundings; a corner around which nothing tells a height moves by as much. */
static void lay(const levels *l, size_t first, size_t end, double off) {
    noc_scene *s = l->scene;
    for (size_t i = first; i < end; i++) {
        const level *v = &l->all.data[i];
        if (v->block) {
            lay_block(l, v, off);
            continue;
        }
        for (size_t k = s->meshes.data[v->first].first_vertex; k < noc_mesh_end_vertex(s, v->first); k++) {
            float *p = s->positions.data + 3 * k;
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
            tell(user, l->all.data[i].number, l->scene->meshes.data[l->all.data[i].first].name, z - zero, off);
    }
    if (!moved)
        return NOC_OK;
    measure(l->scene);
    noc_ground_free(l->scene->ground); /* it knows where they were */
    l->scene->ground = NULL;
    return NOC_OK;
}

/* Lays what was found, or not, by what else stands there. */
static noc_status judge(levels *l, bool found, double zero, city_level_fn tell, void *user) {
    noc_scene *scene = l->scene;
    noc_status status = NOC_OK;
    if (!found) {
        noc_scene_out_of_memory(scene);
        status = NOC_ERR_MEMORY;
    } else if (l->all.len) {
        city_ground *around = city_ground_of_buildings(scene);
        l->around = around;
        status = scene->no_memory ? NOC_ERR_MEMORY : lay_levels(l, zero, tell, user);
        if (around)
            city_ground_free(around);
    }
    array_free(&l->all);
    return status;
}

noc_status city_lay_level_surfaces(noc_scene *scene, size_t first, size_t end, double zero, city_level_fn tell,
                                   void *user) {
    levels l = { .scene = scene };
    return judge(&l, find_levels(&l, first, end), zero, tell, user);
}

/* ---- buildings made of outlines ---- */

static void set_aloft(noc_scene *scene, const city_outline *outlines, size_t count, bool aloft) {
    for (size_t i = 0; i < count; i++)
        for (size_t m = outlines[i].first; m < outlines[i].end; m++)
            scene->meshes.data[m].aloft = aloft;
}

static bool find_outlines(levels *l, const city_outline *outlines, size_t count) {
    const noc_scene *s = l->scene;
    for (size_t i = 0; i < count; i++) {
        level v = { .first = outlines[i].first, .end = outlines[i].end, .z = INFINITY, .block = true, .number = i };
        for (size_t k = s->meshes.data[v.first].first_vertex; k < noc_mesh_end_vertex(s, v.end - 1); k++)
            v.z = NOC_MIN(v.z, (double)vertex(s, k)[2]);
        if (isfinite(v.z) && !array_push(&l->all, v))
            return false;
    }
    return true;
}

noc_status city_lay_outlines(noc_scene *scene, const city_outline *outlines, size_t count, double zero,
                             city_level_fn tell, void *user) {
    levels l = { .scene = scene };
    set_aloft(scene, outlines, count, true); /* they tell nothing of the ground until they lie on it */
    noc_status status = judge(&l, find_outlines(&l, outlines, count), zero, tell, user);
    set_aloft(scene, outlines, count, false);
    return status;
}
