/* Bodies of lamps: models that stand upright for good, and show lights of the scene.
 *
 * A city has as many of them as lamps, and few models. So a body is 28 bytes, is never moved, and its lights lie in the
 * scene's arrays like any others. Vertical rays find bodies by a hash of cells, as they do triangles (ground.c). */
#include "scene/scene.h"

#include <math.h>

#define CELL 4.0 /* m */

void noc_body_transform(const noc_scene_body *b, float m[12]) {
    const float rows[12] = { b->facing[0], -b->facing[1], 0, b->p[0], b->facing[1], b->facing[0], 0, b->p[1], 0, 0, 1,
                             b->p[2] };
    memcpy(m, rows, sizeof(rows));
}

void noc_placed_transform(const noc_scene *s, uint32_t instance, float m[12]) {
    if (noc_is_body(instance))
        noc_body_transform(&s->bodies.data[instance - NOC_BODIES], m);
    else
        memcpy(m, s->instances.data[instance].transform, sizeof(s->instances.data->transform));
}

uint32_t noc_placed_light(const noc_scene *s, uint32_t instance, uint32_t light) {
    return noc_is_body(instance) ? s->bodies.data[instance - NOC_BODIES].light + light
                                 : s->instances.data[instance].lights[light];
}

const noc_scene_body *noc_body_of(const noc_scene *s, uint32_t light) {
    size_t low = 0, high = s->bodies.len; /* those before low begin at the light or before it */
    while (low < high) {
        size_t middle = (low + high) / 2;
        *(s->bodies.data[middle].light <= light ? &low : &high) =
            s->bodies.data[middle].light <= light ? middle + 1 : middle;
    }
    const noc_scene_body *b = low ? &s->bodies.data[low - 1] : NULL;
    return b && light - b->light < s->models.data[b->model - 1].shown ? b : NULL;
}

int noc_scene_add_body_model(noc_scene *s, const noc_mesh *mesh, const noc_light *lights, size_t count) {
    uint32_t first = (uint32_t)s->meshes.len;
    int model = noc_scene_add_model(s, "lamp");
    bool ok = model > 0;
    if (ok && mesh) {
        noc_mesh own = *mesh;
        own.model = model;
        ok = noc_scene_add_mesh(s, &own) >= 0;
    }
    for (uint32_t i = 0; ok && i < count; i++) {
        noc_light shape = lights[i];
        shape.model = model;
        shape.name = NULL;
        shape.profile = 0;
        for (int k = 0; k < 3; k++) /* what is seen there is the light's own */
            shape.emission[k] = 1;
        ok = noc_scene_add_shape(s, &shape, i);
    }
    if (!ok)
        return -1;
    noc_scene_model *m = &s->models.data[model - 1];
    m->first_mesh = first;
    m->end_mesh = (uint32_t)s->meshes.len;
    m->shown = (uint32_t)count;
    return model;
}

/* ---- kinds ---- */

static uint64_t hash_of(const void *key, size_t size) {
    return base_siphash(key, size, (uint64_t[]){ base_secret(), size });
}

/* The slot of a kind, or the empty one where it would go. */
static noc_scene_kind *slot_of(const noc_scene *s, uint64_t hash, const void *key, size_t size) {
    size_t mask = s->body_kinds.len - 1;
    for (size_t i = hash & mask;; i = (i + 1) & mask) {
        noc_scene_kind *k = &s->body_kinds.data[i];
        if (!k->model || (k->hash == hash && k->size == size && !memcmp(k->key, key, size)))
            return k;
    }
}

int noc_body_kind(const noc_scene *s, const void *key, size_t size, size_t *kinds) {
    *kinds = s->body_kinds_taken;
    return s->body_kinds.len ? slot_of(s, hash_of(key, size), key, size)->model : 0;
}

/* A table of twice as many slots. */
static bool grow_kinds(noc_scene *s) {
    noc_scene_kind *was = s->body_kinds.data;
    size_t had = s->body_kinds.len, count = NOC_MAX((size_t)64, 2 * had);
    noc_scene_kind *slots = noc_calloc(count, sizeof(*slots));
    if (!slots)
        return false;
    s->body_kinds.data = slots;
    s->body_kinds.len = s->body_kinds.cap = count;
    for (size_t i = 0; i < had; i++)
        if (was[i].model)
            *slot_of(s, was[i].hash, was[i].key, was[i].size) = was[i];
    free(was);
    return true;
}

bool noc_body_kind_add(noc_scene *s, const void *key, size_t size, int model) {
    void *kept = arena_alloc(&s->names, size);
    if (!kept || (2 * s->body_kinds_taken >= s->body_kinds.len && !grow_kinds(s)))
        return noc_scene_out_of_memory(s) == NOC_OK;
    memcpy(kept, key, size);
    uint64_t hash = hash_of(key, size);
    *slot_of(s, hash, key, size) = (noc_scene_kind){ hash, kept, size, model };
    s->body_kinds_taken++;
    return true;
}

/* ---- bounds ---- */

static void place(const float m[12], const float p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (double)m[4 * k] * p[0] + (double)m[4 * k + 1] * p[1] + (double)m[4 * k + 2] * p[2] + m[4 * k + 3];
}

/* How far a model reaches from its upright axis, m. */
static double reach_of(const noc_scene_model *m) {
    double x = fmax(fabs(m->bounds_min[0]), fabs(m->bounds_max[0])),
           y = fmax(fabs(m->bounds_min[1]), fabs(m->bounds_max[1]));
    return hypot(x, y);
}

/* Most bodies lie within what others reach already: then their corners need no look. */
static bool is_within(const noc_scene *s, const noc_scene_body *b, const double lo[3], const double hi[3]) {
    const noc_scene_model *m = &s->models.data[b->model - 1];
    double r = reach_of(m);
    return b->p[0] - r >= lo[0] && b->p[0] + r <= hi[0] && b->p[1] - r >= lo[1] && b->p[1] + r <= hi[1] &&
           b->p[2] + m->bounds_min[2] >= lo[2] && b->p[2] + m->bounds_max[2] <= hi[2];
}

size_t noc_body_vertices(const noc_scene *s, const noc_scene_body *b, size_t *first) {
    const noc_scene_model *m = &s->models.data[b->model - 1];
    *first = m->first_mesh < m->end_mesh ? s->meshes.data[m->first_mesh].first_vertex : 0;
    return m->first_mesh < m->end_mesh ? noc_mesh_end_vertex(s, m->end_mesh - 1) : 0;
}

void noc_body_vertex(const noc_scene *s, const noc_scene_body *b, size_t vertex, float p[3]) {
    float m[12];
    double at[3];
    noc_body_transform(b, m);
    place(m, s->positions.data + 3 * vertex, at);
    for (int k = 0; k < 3; k++)
        p[k] = (float)at[k];
}

static void join_bounds(const noc_scene *s, const noc_scene_body *b, double lo[3], double hi[3]) {
    float p[3];
    if (is_within(s, b, lo, hi))
        return;
    size_t first, end = noc_body_vertices(s, b, &first);
    for (size_t v = first; v < end; v++) {
        noc_body_vertex(s, b, v, p);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], p[k]);
            hi[k] = NOC_MAX(hi[k], p[k]);
        }
    }
}

void noc_join_body_box(const noc_scene_body *b, const noc_scene_model *m, double lo[3], double hi[3]) {
    const double c = b->facing[0], s = b->facing[1];
    double mid[3], half[3];
    for (int k = 0; k < 3; k++) {
        mid[k] = (m->bounds_min[k] + m->bounds_max[k]) / 2;
        half[k] = (m->bounds_max[k] - m->bounds_min[k]) / 2;
    }
    const double at[3] = { c * mid[0] - s * mid[1], s * mid[0] + c * mid[1], mid[2] },
                 by[3] = { fabs(c) * half[0] + fabs(s) * half[1], fabs(s) * half[0] + fabs(c) * half[1], half[2] };
    for (int k = 0; k < 3; k++) {
        lo[k] = NOC_MIN(lo[k], b->p[k] + at[k] - by[k]);
        hi[k] = NOC_MAX(hi[k], b->p[k] + at[k] + by[k]);
    }
}

void noc_join_body_bounds(const noc_scene *s, double lo[3], double hi[3]) {
    for (size_t i = 0; i < s->bodies.len; i++)
        join_bounds(s, &s->bodies.data[i], lo, hi);
}

/* ---- vertical rays ---- */

static size_t bucket_of(const noc_scene *s, int64_t x, int64_t y) {
    uint64_t h = ((uint64_t)x * 0x9e3779b97f4a7c15u + (uint64_t)y * 0xc2b2ae3d27d4eb4fu) ^ base_secret();
    h *= 0xd6e8feb86659fd93u;
    return (h ^ h >> 32) & (s->body_cells.len - 1);
}

static bool file_one(noc_scene *s, size_t i) {
    const noc_scene_body *b = &s->bodies.data[i];
    double box[2][3] = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    int64_t lo[2], hi[2];
    noc_join_body_box(b, &s->models.data[b->model - 1], box[0], box[1]);
    for (int k = 0; k < 2; k++) { /* and what rounding may take from it */
        lo[k] = (int64_t)floor((box[0][k] - 1e-3) / CELL);
        hi[k] = (int64_t)floor((box[1][k] + 1e-3) / CELL);
    }
    for (int64_t y = lo[1]; y <= hi[1]; y++)
        for (int64_t x = lo[0]; x <= hi[0]; x++) {
            uint32_t *cell = &s->body_cells.data[bucket_of(s, x, y)];
            if (!array_push(&s->body_links, (noc_body_link){ (uint32_t)i, *cell }))
                return false;
            *cell = (uint32_t)s->body_links.len;
        }
    return true;
}

/* Twice as many buckets, which are empty. */
static bool make_cells(noc_scene *s) {
    size_t count = NOC_MAX((size_t)1024, s->body_cells.len);
    while (count < s->bodies.len)
        count *= 2;
    if (!array_reserve(&s->body_cells, count))
        return false;
    memset(s->body_cells.data, 0, count * sizeof(*s->body_cells.data));
    s->body_cells.len = count;
    s->body_links.len = 0;
    return true;
}

bool noc_bodies_file(noc_scene *s, size_t first) {
    bool ok = true;
    if (s->body_cells.len < NOC_MAX(s->bodies.len, (size_t)1)) {
        ok = make_cells(s);
        first = 0;
    }
    for (size_t i = first; ok && i < s->bodies.len; i++)
        ok = file_one(s, i);
    return ok;
}

/* Height of a triangle at (x, y) of its model; false where it has none there. */
static bool height_at(const noc_scene *s, size_t t, double x, double y, double *z) {
    const float *p[3];
    double e[3], sum = 0, h = 0;
    for (int i = 0; i < 3; i++)
        p[i] = s->positions.data + 3 * (size_t)s->indices.data[3 * t + (size_t)i];
    for (int i = 0; i < 3; i++) {
        const float *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
        e[i] = ((double)b[0] - a[0]) * (y - a[1]) - ((double)b[1] - a[1]) * (x - a[0]);
        sum += e[i];
        h += e[i] * p[i][2];
    }
    bool inside = (e[0] >= 0 && e[1] >= 0 && e[2] >= 0) || (e[0] <= 0 && e[1] <= 0 && e[2] <= 0);
    *z = h / sum;
    return inside && sum != 0;
}

static bool lift(const noc_scene *s, const noc_scene_body *b, double x, double y, double *z) {
    const noc_scene_model *m = &s->models.data[b->model - 1];
    double dx = x - b->p[0], dy = y - b->p[1], u = b->facing[0] * dx + b->facing[1] * dy,
           v = b->facing[0] * dy - b->facing[1] * dx, h;
    bool lifted = false;
    if (b->p[2] + m->bounds_max[2] <= *z || u < m->bounds_min[0] || u > m->bounds_max[0] || v < m->bounds_min[1] ||
        v > m->bounds_max[1])
        return false;
    for (uint32_t i = m->first_mesh; i < m->end_mesh; i++) {
        const noc_scene_mesh *mesh = &s->meshes.data[i];
        for (size_t t = mesh->first_triangle; t < (size_t)mesh->first_triangle + mesh->triangle_count; t++)
            if (s->triangle_light.data[t] == NOC_NO_LIGHT && height_at(s, t, u, v, &h) && b->p[2] + h > *z) {
                *z = b->p[2] + h;
                lifted = true;
            }
    }
    return lifted;
}

bool noc_bodies_highest(const noc_scene *s, double x, double y, double *z) {
    bool lifted = false;
    if (!s->body_cells.len) /* nor where memory was refused */
        return false;
    uint32_t link = s->body_cells.data[bucket_of(s, (int64_t)floor(x / CELL), (int64_t)floor(y / CELL))];
    for (; link; link = s->body_links.data[link - 1].next)
        lifted |= lift(s, &s->bodies.data[s->body_links.data[link - 1].body], x, y, z);
    return lifted;
}

bool noc_scene_add_body(noc_scene *s, const noc_scene_body *body) {
    if (!array_push(&s->bodies, *body) || !noc_bodies_file(s, s->bodies.len - 1))
        return noc_scene_out_of_memory(s) == NOC_OK;
    s->models.data[body->model - 1].instances++;
    join_bounds(s, body, s->bounds_min, s->bounds_max);
    return true;
}
