/* Areas of maps as surfaces: water, lawns, squares. Their triangles are split until they follow the ground. */
#include "city/city.h"
#include "scene/scene.h"

#include <math.h>

#define SHORT 4.0 /* m: shorter edges are not split */
#define LONG 40.0 /* m: longer ones are */
#define FLAT 0.01 /* m that the ground may lie off the middle of an edge */
enum { MOST_TRIANGLES = 4000000, MOST_PIECES = 20000000, DEEPEST = 24, AT_ONCE = 4096 };

typedef struct corner {
    double xyz[3];
} corner;

typedef struct piece {
    corner c[3];
    int depth;
} piece;

typedef struct layer {
    noc_scene *scene;
    double lift;
    NOC_ARRAY(piece) waiting;
    NOC_ARRAY(double) position;
    NOC_ARRAY(uint32_t) index;
    size_t pieces; /* that were looked at */
    bool no_memory;
} layer;

static bool is_full(const layer *l) { return l->index.len / 3 >= MOST_TRIANGLES || l->pieces >= MOST_PIECES; }

/* Beyond what the scene has there is no ground. */
static bool is_outside(const layer *l, const piece *p) {
    bool outside = false;
    for (int k = 0; k < 2; k++) {
        double lo = fmin(fmin(p->c[0].xyz[k], p->c[1].xyz[k]), p->c[2].xyz[k]);
        double hi = fmax(fmax(p->c[0].xyz[k], p->c[1].xyz[k]), p->c[2].xyz[k]);
        outside = outside || hi < l->scene->bounds_min[k] || lo > l->scene->bounds_max[k];
    }
    return outside;
}

static corner on_ground(const layer *l, double x, double y) {
    double z;
    return (corner){ { x, y, noc_scene_ground(l->scene, x, y, &z) ? z : NAN } };
}

/* An edge is split by what lies between its two ends alone, so that triangles on both sides of it agree. */
static bool splits(const layer *l, const corner *a, const corner *b, corner *middle) {
    const double *from = a->xyz, *to = b->xyz;
    bool turned = from[0] > to[0] || (from[0] == to[0] && from[1] > to[1]); /* the same numbers both ways */
    if (turned) {
        from = b->xyz;
        to = a->xyz;
    }
    double length = hypot(to[0] - from[0], to[1] - from[1]);
    *middle = on_ground(l, (from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
    if (length < SHORT)
        return false;
    double off = middle->xyz[2] - (from[2] + to[2]) / 2;
    return length > LONG || !(fabs(off) < FLAT);
}

static void keep(layer *l, const piece *p) {
    for (int i = 0; i < 3; i++)
        if (!isfinite(p->c[i].xyz[2]))
            return;
    uint32_t first = (uint32_t)(l->position.len / 3);
    for (int i = 0; i < 3; i++) {
        const double at[3] = { p->c[i].xyz[0], p->c[i].xyz[1], p->c[i].xyz[2] + l->lift };
        l->no_memory =
            !array_append(&l->position, at, (size_t)3) || !array_push(&l->index, first + (uint32_t)i) || l->no_memory;
    }
}

/* In two, three or four, as edges split. */
static void take(layer *l, const piece *p) {
    corner m[3];
    bool split[3];
    int count = 0;
    l->pieces++;
    if (is_outside(l, p))
        return;
    for (int i = 0; i < 3; i++)
        count += split[i] = p->depth < DEEPEST && splits(l, &p->c[i], &p->c[(i + 1) % 3], &m[i]);
    if (!count) {
        keep(l, p);
        return;
    }
    int d = p->depth + 1, i = 0;
    piece out[4];
    if (count == 3) {
        out[0] = (piece){ { p->c[0], m[0], m[2] }, d };
        out[1] = (piece){ { p->c[1], m[1], m[0] }, d };
        out[2] = (piece){ { p->c[2], m[2], m[1] }, d };
        out[3] = (piece){ { m[0], m[1], m[2] }, d };
    } else if (count == 2) {
        while (split[i])
            i++; /* the edge that stays */
        const corner *a = &p->c[i], *b = &p->c[(i + 1) % 3], *c = &p->c[(i + 2) % 3], *bc = &m[(i + 1) % 3],
                     *ca = &m[(i + 2) % 3];
        out[0] = (piece){ { *c, *ca, *bc }, d };
        out[1] = (piece){ { *a, *b, *bc }, d };
        out[2] = (piece){ { *a, *bc, *ca }, d };
    } else {
        while (!split[i])
            i++;
        const corner *a = &p->c[i], *b = &p->c[(i + 1) % 3], *c = &p->c[(i + 2) % 3];
        out[0] = (piece){ { *a, m[i], *c }, d };
        out[1] = (piece){ { m[i], *b, *c }, d };
    }
    for (int k = 0; k < count + 1; k++)
        l->no_memory = !array_push(&l->waiting, out[k]) || l->no_memory;
}

/* Facing upwards, whichever way its ring went round. */
static piece piece_of(const layer *l, const geo_triangles *t, size_t triangle) {
    const double *at[3];
    for (size_t k = 0; k < 3; k++)
        at[k] = t->xyz.data + 3 * (size_t)t->indices.data[3 * triangle + k];
    double turn = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    const double *b = turn > 0 ? at[1] : at[2], *c = turn > 0 ? at[2] : at[1];
    return (piece){ { on_ground(l, at[0][0], at[0][1]), on_ground(l, b[0], b[1]), on_ground(l, c[0], c[1]) }, 0 };
}

/* A triangle and all that it is split into. */
static noc_status lay(layer *l, piece p, const noc_progress *progress) {
    take(l, &p);
    while (l->waiting.len && !l->no_memory && !is_full(l)) {
        p = l->waiting.data[--l->waiting.len];
        take(l, &p);
        if (l->pieces % AT_ONCE == 0 && progress && progress->update && !progress->update(progress->user, "areas", 0))
            return NOC_ERR_CANCELLED;
    }
    return l->no_memory ? noc_scene_out_of_memory(l->scene) : NOC_OK;
}

noc_status city_lay_area(noc_scene *scene, const geo_triangles *triangles, noc_class cls, double lift,
                         const noc_progress *progress, size_t *made) {
    layer l = { .scene = scene, .lift = lift };
    noc_status status = NOC_OK;
    for (size_t t = 0; t < triangles->indices.len / 3 && !status && !is_full(&l); t++) {
        if (t % 256 == 0 && progress && progress->update && !progress->update(progress->user, "areas", 0))
            status = NOC_ERR_CANCELLED;
        status = status ? status : lay(&l, piece_of(&l, triangles, t), progress);
    }
    if (!status && is_full(&l))
        noc_warn(scene->log, "areas of maps (%s) are too many or too large: some have no surface", noc_class_name(cls));
    *made = l.index.len / 3;
    if (!status && *made) {
        noc_material m = noc_class_material(cls);
        noc_mesh mesh = { .vertex_count = l.position.len / 3,
                          .positions = l.position.data,
                          .triangle_count = *made,
                          .indices = l.index.data,
                          .material = noc_scene_add_material(scene, &m) };
        if (mesh.material < 0 || noc_scene_add_mesh(scene, &mesh) < 0)
            status = scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT;
    }
    array_free(&l.waiting);
    array_free(&l.position);
    array_free(&l.index);
    return status;
}
