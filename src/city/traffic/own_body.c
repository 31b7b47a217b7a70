/* The user's own body of cars: stood on its wheels, turned to where cars go, and given lamps. */
#include "city/city.h"
#include "city/traffic/traffic.h"

#include <ctype.h>
#include <math.h>

#define SHORTEST 1.0 /* m of a car */
#define LONGEST 30.0
#define AXLES 0.58 /* of its length, between its axles: 2.6 m of 4.5 m */
#define APART 0.7  /* of half its width, where lamps are; the width is that over the mirrors */
#define TRIES 8    /* on the rim of a lamp, at which the body is felt for */

/* Heights of lamps, of the car's own; within what UN Regulation 48 allows, 0.5 to 1.2 m and 0.35 to 1.5 m. Ours. */
#define HEAD_HEIGHT(top) NOC_CLAMP(.44 * (top), .5, .8)
#define TAIL_HEIGHT(top) NOC_CLAMP(.55 * (top), .5, .95)

typedef struct extent {
    double lo[3], hi[3];
    bool any;
} extent;

typedef struct own_body {
    const noc_scene *from;
    const char *name;
    double move[12]; /* from the file's coordinates to those of a car, whose x is forward, y left and z up */
    double size[3];
    extent marks[2][2]; /* of what is called a headlamp or a tail lamp; right and left */
} own_body;

static void grow(extent *e, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        e->lo[k] = e->any ? NOC_MIN(e->lo[k], p[k]) : p[k];
        e->hi[k] = e->any ? NOC_MAX(e->hi[k], p[k]) : p[k];
    }
    e->any = true;
}

/* ---- how it stands ---- */

static noc_status stand(own_body *b, noc_log *log, double wanted) {
    extent e = { .any = false };
    for (size_t i = 0; i < b->from->indices.len; i++) {
        double p[3];
        city_body_corner(b->from, i, p);
        grow(&e, p);
    }
    if (!e.any)
        return noc_error(log, NOC_ERR_FORMAT, "%s: the car's body has no triangles", b->name);
    double length = e.hi[1] - e.lo[1], width = e.hi[0] - e.lo[0], scale = wanted > 0 ? wanted / length : 1;
    if (!(length * scale >= SHORTEST && length * scale <= LONGEST)) /* not a number where it has no length */
        return noc_error(log, NOC_ERR_FORMAT,
                         "%s: the car is %.3g m long, and not %g to %g m: --car-length says what it is to be", b->name,
                         length, SHORTEST, LONGEST);
    if (width > length)
        noc_warn(log,
                 "%s: the car is wider (%.3g m) than it is long (%.3g m): its front looks along +z of a glTF, "
                 "or of an OBJ whose y is up",
                 b->name, width * scale, length * scale);
    const double move[12] = { 0,     -scale, 0,     scale * (e.lo[1] + e.hi[1]) / 2,
                              scale, 0,      0,     -scale * (e.lo[0] + e.hi[0]) / 2,
                              0,     0,      scale, -scale * e.lo[2] };
    memcpy(b->move, move, sizeof(move));
    b->size[0] = length * scale;
    b->size[1] = width * scale;
    b->size[2] = (e.hi[2] - e.lo[2]) * scale;
    return NOC_OK;
}

static void corner_of(const own_body *b, size_t i, double out[3]) {
    double p[3];
    city_body_corner(b->from, i, p);
    for (int k = 0; k < 3; k++)
        out[k] = b->move[4 * k] * p[0] + b->move[4 * k + 1] * p[1] + b->move[4 * k + 2] * p[2] + b->move[4 * k + 3];
}

/* ---- where its lamps are ---- */

/* "Head_Light.L" has "headlight" in it. */
static bool is_called(const char *name, const char *const *words) {
    char plain[128];
    size_t n = 0;
    for (; name && *name && n + 1 < sizeof(plain); name++)
        if (isalpha((unsigned char)*name))
            plain[n++] = (char)tolower((unsigned char)*name);
    plain[n] = 0;
    for (; *words; words++)
        if (strstr(plain, *words))
            return true;
    return false;
}

static void find_marks(own_body *b) {
    static const char *const words[2][5] = { { "headlight", "headlamp", "frontlight", "frontlamp", NULL },
                                             { "taillight", "taillamp", "rearlight", "rearlamp", NULL } };
    for (size_t m = 0; m < b->from->meshes.len; m++) {
        const noc_scene_mesh *mesh = &b->from->meshes.data[m];
        for (int rear = 0; rear < 2; rear++) {
            size_t triangles = is_called(mesh->name, words[rear]) ? mesh->triangle_count : 0;
            for (size_t t = 0; t < triangles; t++) {
                double p[3][3];
                for (size_t k = 0; k < 3; k++)
                    corner_of(b, 3 * (mesh->first_triangle + t) + k, p[k]);
                extent *side = &b->marks[rear][p[0][1] + p[1][1] + p[2][1] > 0];
                for (int k = 0; k < 3; k++)
                    grow(side, p[k]);
            }
        }
    }
}

/* How far forward (sign 1) or back (-1) the body goes at so much to the left and so high; beyond it: -INFINITY. */
static double feel(const own_body *b, double y, double z, int sign) {
    double farthest = -INFINITY;
    for (size_t i = 0; i + 2 < b->from->indices.len; i += 3) {
        double p[3][3], w[3], area = 0;
        for (size_t k = 0; k < 3; k++)
            corner_of(b, i + k, p[k]);
        for (int k = 0; k < 3; k++) {
            const double *u = p[(k + 1) % 3], *v = p[(k + 2) % 3];
            w[k] = (u[1] - y) * (v[2] - z) - (v[1] - y) * (u[2] - z);
            area += w[k];
        }
        bool inside = (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) || (w[0] <= 0 && w[1] <= 0 && w[2] <= 0);
        if (inside && area != 0)
            farthest = NOC_MAX(farthest, sign * (w[0] * p[0][0] + w[1] * p[1][0] + w[2] * p[2][0]) / area);
    }
    return farthest;
}

/* On its surface, so far out that no part of the lamp lies within the body. */
static void put_lamp(const own_body *b, int rear, int left, double out[3]) {
    const int sign = rear ? -1 : 1;
    double far = -INFINITY, height = rear ? TAIL_HEIGHT(b->size[2]) : HEAD_HEIGHT(b->size[2]);
    out[1] = (left ? 1 : -1) * APART * b->size[1] / 2;
    out[2] = NOC_MIN(height, b->size[2] / 2);
    for (int i = 0; i <= TRIES; i++) {
        double r = i < TRIES ? TRAFFIC_LAMP_RADIUS : 0, angle = 2 * M_PI * i / TRIES;
        far = NOC_MAX(far, feel(b, out[1] + r * cos(angle), out[2] + r * sin(angle), sign));
    }
    out[0] = sign * (isfinite(far) ? far : b->size[0] / 2);
}

static void place_lamps(const own_body *b, traffic_lamp_places *at) {
    for (int rear = 0; rear < 2; rear++)
        for (int left = 0; left < 2; left++) {
            double *out = rear ? at->tail[left] : at->head[left];
            const extent *own = &b->marks[rear][left], *other = &b->marks[rear][!left];
            const extent *mark = own->any ? own : other; /* what is marked on one side is there on both */
            if (!mark->any) {
                put_lamp(b, rear, left, out);
                continue;
            }
            out[0] = rear ? mark->lo[0] : mark->hi[0];
            out[1] = (mark->lo[1] + mark->hi[1]) / 2 * (own->any ? 1 : -1);
            out[2] = (mark->lo[2] + mark->hi[2]) / 2;
        }
}

/* ---- models ---- */

static noc_status add_model(noc_scene *scene, const own_body *b, const int *materials, traffic_model *made) {
    noc_status status = NOC_OK;
    made->model = noc_scene_add_model(scene, "car");
    if (made->model < 0)
        return scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    for (size_t m = 0; m < b->from->meshes.len && !status; m++) {
        const noc_scene_mesh *mesh = &b->from->meshes.data[m];
        if (mesh->triangle_count)
            status = city_body_mesh(scene, b->from, mesh, made->model, materials[mesh->material], b->move);
    }
    return status;
}

/* Twice, with either kind of headlamps. */
static noc_status add_models(noc_scene *scene, const own_body *b, const noc_traffic_params *params,
                             const int *materials, traffic_models *models) {
    static const double kelvins[] = { TRAFFIC_HALOGEN, TRAFFIC_LED };
    int beam = params->headlamp > 0 ? traffic_beam(scene, params->side) : 1;
    traffic_lamp_places at;
    place_lamps(b, &at);
    noc_status status = beam ? NOC_OK : NOC_ERR_MEMORY;
    for (size_t i = 0; i < NOC_COUNT(kelvins) && !status; i++) {
        traffic_model made = { .share = 1, .axles = AXLES * b->size[0] };
        status = add_model(scene, b, materials, &made);
        if (!status && !traffic_lamps(scene, made.model, &at, params, beam, kelvins[i]))
            status = scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_ARGUMENT;
        if (!status && !array_push(&models->of, made))
            status = noc_scene_out_of_memory(scene);
    }
    return status;
}

noc_status traffic_own_models(noc_scene *scene, const noc_scene *from, const char *name,
                              const noc_traffic_params *params, traffic_models *models) {
    own_body b = { .from = from, .name = name };
    noc_status status = stand(&b, scene->log, params->body_length);
    if (status)
        return status;
    find_marks(&b);
    int *materials = noc_alloc((from->materials.len + 1) * sizeof(*materials));
    if (!materials)
        return noc_scene_out_of_memory(scene);
    for (size_t i = 0; i < from->materials.len && !status; i++) {
        materials[i] = city_body_material(scene, from, (int)i, NOC_CLASS_VEHICLE);
        if (materials[i] < 0)
            status = scene->no_memory ? NOC_ERR_MEMORY : NOC_ERR_UNSUPPORTED;
    }
    status = status ? status : add_models(scene, &b, params, materials, models);
    free(materials);
    return status;
}
