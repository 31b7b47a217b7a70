/* What lies at a height that is none: surfaces of roads, lawns and water, and buildings made of outlines, of a model
 * whose coordinates have 0 where a height would be, beside buildings that stand at 40 m. They are told by what stands
 * around them, and laid on it. */
#include "city/city.h"
#include "city/drape.h"
#include "scene/scene.h"

#include <math.h>

#define LEVEL 0.01 /* m between the highest and the lowest corner, and between surfaces at one height */
#define OFF 3.0    /* m that a surface is believed beside a building */
#define STEEP 0.2  /* and more, for each metre to where the city tells its height */
#define NEAR 50.0  /* m to where it does, for a height within that to count as the same */
#define MANY 10    /* surfaces at one height that is not 0 */
#define NEARLY_ALL 0.9
#define LIFT 0.02 /* m over the ground, which is laid under them */
/* m that terrain, and what buildings tell of the ground, may lie off an edge of what is laid; edges
 * from SHORT on are split, and from LONG on always */
#define FLAT 0.01
#define FLAT_BETWEEN 0.25
#define SHORT 1.0
#define LONG 40.0
#define LONG_BETWEEN 200.0
enum { MOST_TRIANGLES = 1000000 }; /* of what is laid of a file */

/* Meshes that are level, or stand on a level foot. */
typedef struct level {
    uint32_t first, end;
    double z;
    bool block;    /* moves as a whole */
    size_t number; /* of an outline */
} level;

/* Triangles that lie on the ground in place of a level mesh's own. */
typedef struct draped {
    uint32_t mesh;
    size_t first, end; /* triangles of the drape */
} draped;

typedef struct levels {
    noc_scene *scene;
    const city_ground *around; /* by buildings alone */
    NOC_ARRAY(level) all;
    drape drape;
    double off; /* that surfaces which are laid now lie above what is around them */
    double z;   /* their height */
    NOC_ARRAY(draped) draped;
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

/* Where what is laid now comes to lie; where nothing tells it moves with the rest. */
static double ground_at(void *user, double x, double y) {
    const levels *l = user;
    double z, distance;
    return told(l, x, y, &z, &distance) ? z : l->z - l->off;
}

/* Splits the surface until it follows the ground. False: it has places in a texture, or is too large for what is left
 * of the budget. */
static bool split(levels *l, uint32_t mesh) {
    const noc_scene *s = l->scene;
    const noc_scene_mesh *m = &s->meshes.data[mesh];
    drape *d = &l->drape;
    size_t corners = d->position.len, indices = d->index.len;
    for (size_t t = m->first_triangle; t < (size_t)m->first_triangle + m->triangle_count && !m->uv; t++) {
        double corner[3][3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                corner[i][k] = (double)vertex(s, s->indices.data[3 * t + (size_t)i])[k];
        if (drape_triangle(d, (const double *const[]){ corner[0], corner[1], corner[2] }, NULL))
            return false;
    }
    if (!m->uv && !drape_is_full(d) && d->index.len > indices) {
        d->no_memory = !array_push(&l->draped, (draped){ mesh, indices / 3, d->index.len / 3 }) || d->no_memory;
        return true;
    }
    d->position.len = corners;
    d->index.len = indices;
    d->waiting.len = 0;
    return false;
}

/* Returns whether it follows the ground between its corners, too. */
static bool lay_surface(levels *l, const level *v) {
    noc_scene *s = l->scene;
    bool follows = split(l, v->first);
    for (size_t k = s->meshes.data[v->first].first_vertex; k < noc_mesh_end_vertex(s, v->first); k++) {
        float *p = s->positions.data + 3 * k;
        p[2] = (float)(ground_at(l, p[0], p[1]) + LIFT);
    }
    return follows;
}

/* The mesh's own triangles become points, and a mesh of its name and material takes their place. */
static bool replace(noc_scene *s, const drape *d, const draped *with, uint32_t *local) {
    const noc_scene_mesh old = s->meshes.data[with->mesh];
    size_t count = with->end - with->first;
    for (size_t i = 0; i < 3 * count; i++)
        local[i] = (uint32_t)i;
    const noc_mesh mesh = { .vertex_count = 3 * count,
                            .positions = d->position.data + 9 * with->first,
                            .triangle_count = count,
                            .indices = local,
                            .material = old.material,
                            .group = old.group,
                            .name = old.name };
    if (noc_scene_add_mesh(s, &mesh) < 0)
        return false;
    s->meshes.data[s->meshes.len - 1].land = old.land;
    for (size_t t = old.first_triangle; t < (size_t)old.first_triangle + old.triangle_count; t++)
        for (size_t i = 1; i < 3; i++)
            s->indices.data[3 * t + i] = s->indices.data[3 * t];
    return true;
}

/* Once all was asked: the scene's ground is made anew for each mesh that is added. */
static noc_status replace_all(levels *l) {
    size_t most = 0;
    bool ok = !l->drape.no_memory;
    for (size_t i = 0; i < l->draped.len; i++)
        most = NOC_MAX(most, l->draped.data[i].end - l->draped.data[i].first);
    uint32_t *local = noc_calloc(3 * most + 1, sizeof(*local));
    for (size_t i = 0; i < l->draped.len && ok && local; i++)
        ok = replace(l->scene, &l->drape, &l->draped.data[i], local);
    free(local);
    if (!ok || !local)
        noc_scene_out_of_memory(l->scene);
    return ok && local ? NOC_OK : NOC_ERR_MEMORY;
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
        moved = true;
        l->off = off;
        for (size_t i = first; i < end; i++) {
            const level *v = &l->all.data[i];
            l->z = v->z;
            bool follows = true;
            if (v->block)
                lay_block(l, v, off);
            else
                follows = lay_surface(l, v);
            tell(user, &(city_laid){ v->number, l->scene->meshes.data[v->first].name, z - zero, off, follows });
        }
    }
    noc_status status = moved ? replace_all(l) : NOC_OK;
    if (!moved || status)
        return status;
    measure(l->scene);
    noc_ground_free(l->scene->ground); /* it knows where they were */
    l->scene->ground = NULL;
    return NOC_OK;
}

static bool has_terrain(const noc_scene *s) {
    for (size_t m = 0; m < s->meshes.len; m++)
        if (class_of(s, m) == NOC_CLASS_TERRAIN && s->meshes.data[m].triangle_count)
            return true;
    return false;
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
        bool terrain = has_terrain(scene);
        l->drape = (drape){ .scene = scene,
                            .height = ground_at,
                            .user = l,
                            .lift = LIFT,
                            .flat = terrain ? FLAT : FLAT_BETWEEN,
                            .shortest = SHORT,
                            .longest = terrain ? LONG : LONG_BETWEEN,
                            .most = MOST_TRIANGLES };
        status = scene->no_memory ? NOC_ERR_MEMORY : lay_levels(l, zero, tell, user);
        if (around)
            city_ground_free(around);
    }
    array_free(&l->all);
    array_free(&l->draped);
    drape_free(&l->drape);
    return status;
}

noc_status city_lay_level_surfaces(noc_scene *scene, size_t first, size_t end, double zero, city_level_fn tell,
                                   void *user) {
    levels l = { .scene = scene };
    return judge(&l, find_levels(&l, first, end), zero, tell, user);
}

/* ---- buildings made of outlines ---- */

static void set_aloft(noc_scene *scene, const city_outline *outlines, size_t count, float aloft) {
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
    set_aloft(scene, outlines, count, 1); /* they tell nothing of the ground until they lie on it */
    noc_status status = judge(&l, find_outlines(&l, outlines, count), zero, tell, user);
    set_aloft(scene, outlines, count, 0);
    return status;
}
