/* Visibility-aware boxes (Algorithm 4): rays from lights, as long as their reach, and the box around their ends.
 * Surfaces outside it are taken not to see these lights; those that do, through gaps between the rays, have the uniform
 * draws. Unlike in the thesis, volumes that lie close together and shine the same way share a box, and its rays start
 * from their lights in turn: what one window of a facade sees its neighbours see too, so that rays are a few a light.
 * Directions are spread evenly, and the box grows by what may lie between them. */
#include "light/influence_parts.h"

#include "core/random.h"
#include "light/bound.h"

#include <math.h>

/* Volumes that share a box, at most; rays a box; volumes that a thread takes at once. */
enum { GROUP = 16, RAYS = 32, CHUNK = 1024 };

/* Volumes are not cut nearer to their lights than that share of S_r: what is missed there is the strongest light
 * (bench/bench_boxes). */
static const float uncut = 0.25f;

/* Rays go beyond the volume by that: the box around the ends of a few ends short of a sphere of their length. */
static const float beyond = 1.25f;

/* A direction of a unit sphere around z: its height, 0 to 1, and its azimuth. */
typedef struct lattice_point {
    float azimuth, height, cos, sin;
} lattice_point;

typedef struct probing {
    const noc_scene *scene;
    const noc_influence_params *params;
    noc_influence *v;
    float lo[3], cells;     /* of Morton codes: corner, cells a metre */
    size_t count;           /* volumes of lights that stand and shine */
    noc_light_key *order;   /* of them, those that lie close together follow each other; then room for as many */
    uint32_t *boxes_before; /* a chunk of the order: boxes of the chunks before it */
    lattice_point lattice[RAYS];
} probing;

/* ---- rays ---- */

static int by_azimuth(const void *a, const void *b) {
    float x = ((const lattice_point *)a)->azimuth, y = ((const lattice_point *)b)->azimuth;
    return (x > y) - (x < y);
}

/* A spherical Fibonacci lattice in the order of azimuths: rays that are traced together go the same way, about. */
static void make_lattice(lattice_point p[RAYS]) {
    for (int i = 0; i < RAYS; i++) {
        float a = fmodf(2.39996323f * (float)i, 6.2831853f);
        p[i] = (lattice_point){ a, ((float)i + 0.5f) / RAYS, cosf(a), sinf(a) };
    }
    qsort(p, RAYS, sizeof(*p), by_azimuth);
}

/* Two axes at right angles to the unit vector n and to each other. */
static void axes(const float n[3], float s[3], float t[3]) {
    int i = fabsf(n[0]) < fabsf(n[1]) ? 1 : 0, j = 2; /* never both 0, for n[1 - i] is not the largest alone */
    float length = sqrtf(n[i] * n[i] + n[j] * n[j]);
    s[1 - i] = 0;
    s[i] = -n[j] / length;
    s[j] = n[i] / length;
    for (int k = 0; k < 3; k++)
        t[k] = n[(k + 1) % 3] * s[(k + 2) % 3] - n[(k + 2) % 3] * s[(k + 1) % 3];
}

/* The lattice in the half space that n points into, turned about it by an angle; all around z where n is 0. */
static void directions(const lattice_point p[RAYS], const float n[3], float turn, float out[RAYS][3]) {
    bool any = n[0] == 0 && n[1] == 0 && n[2] == 0;
    float up[3] = { n[0], n[1], any ? 1 : n[2] }, s[3], t[3], c = cosf(turn), d = sinf(turn);
    axes(up, s, t);
    for (int i = 0; i < RAYS; i++) {
        float z = any ? 2 * p[i].height - 1 : p[i].height, r = sqrtf(NOC_MAX(1 - z * z, 0));
        float x = r * (p[i].cos * c - p[i].sin * d), y = r * (p[i].cos * d + p[i].sin * c);
        for (int k = 0; k < 3; k++)
            out[i][k] = x * s[k] + y * t[k] + z * up[k];
    }
}

/* ---- volumes that share a box ---- */

static void facing(const noc_influence_volume *a, float n[3]) {
    float length = sqrtf(a->m[0] * a->m[0] + a->m[1] * a->m[1] + a->m[2] * a->m[2]);
    for (int k = 0; k < 3; k++)
        n[k] = length > 0 ? a->m[k] / length : 0;
}

/* Side of a cube that they face, Morton code of 15 bits an axis. The volumes' own order has their sizes first, and
 * neighbours of one facade do not follow each other in it. */
static void key_chunk(void *ctx, size_t chunk, int worker) {
    probing *b = ctx;
    size_t end = NOC_MIN((chunk + 1) * CHUNK, b->count);
    (void)worker;
    for (size_t i = chunk * CHUNK; i < end; i++) {
        const noc_influence_volume *a = &b->v->volumes[b->order[i].id];
        uint64_t m = noc_side(a->m) << 45;
        for (int k = 0; k < 3; k++)
            m |= noc_spread_bits((uint64_t)NOC_CLAMP((a->c[k] - b->lo[k]) * b->cells, 0, 32767)) << k;
        b->order[i].key = m;
    }
}

static bool sort_volumes(probing *b) {
    const noc_influence *v = b->v;
    const noc_influence_half *h = &v->half[NOC_STANDING];
    float size = 0, lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    b->order = noc_alloc_large(2 * (size_t)h->count + 1, sizeof(*b->order));
    if (!b->order)
        return false;
    for (uint32_t i = h->first; i < h->first + h->count; i++) {
        const noc_influence_volume *a = &v->volumes[i];
        for (int k = 0; k < 3 && a->root > 0; k++) {
            lo[k] = NOC_MIN(lo[k], a->c[k] - a->size);
            hi[k] = NOC_MAX(hi[k], a->c[k] + a->size);
        }
        if (a->root > 0)
            b->order[b->count++].id = i;
    }
    for (int k = 0; k < 3; k++) {
        b->lo[k] = lo[k];
        size = NOC_MAX(size, hi[k] - lo[k]);
    }
    b->cells = size > 0 ? 32767 / size : 0;
    noc_influence_run(b->params->pool, (b->count + CHUNK - 1) / CHUNK, key_chunk, b);
    if (b->count)
        noc_sort_keys(b->order, b->order + b->count, b->count);
    return true;
}

/* The end of the group that starts with the volume at `begin` of the order: those that follow it, face alike, and lie
 * within half of what the largest reaches; so it is for lights that share a volume. */
static size_t group_end(const probing *b, size_t begin, size_t end) {
    const noc_influence_volume *volumes = b->v->volumes, *first = &volumes[b->order[begin].id];
    float n[3], lo[3], hi[3], root = first->root;
    facing(first, n);
    memcpy(lo, first->c, sizeof(lo));
    memcpy(hi, first->c, sizeof(hi));
    size_t i = begin + 1;
    for (end = NOC_MIN(end, begin + GROUP); i < end; i++) {
        const noc_influence_volume *a = &volumes[b->order[i].id];
        float own[3], d2 = 0, apart2 = 0;
        facing(a, own);
        root = NOC_MAX(root, a->root);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], a->c[k]);
            hi[k] = NOC_MAX(hi[k], a->c[k]);
            d2 += (hi[k] - lo[k]) * (hi[k] - lo[k]);
            apart2 += (own[k] - n[k]) * (own[k] - n[k]);
        }
        float most = 0.5f * b->v->scale * root;
        if (!(d2 <= most * most && apart2 <= 0.25f))
            break;
    }
    return i;
}

static void group_chunk(void *ctx, size_t chunk, int worker) {
    probing *b = ctx;
    size_t end = NOC_MIN((chunk + 1) * CHUNK, b->count);
    uint32_t boxes = 0;
    (void)worker;
    for (size_t i = chunk * CHUNK, next; i < end; i = next, boxes++)
        for (next = group_end(b, i, end); i < next; i++)
            b->v->box_of[b->order[i].id] = boxes; /* of the chunk's */
    b->boxes_before[chunk + 1] = boxes;
}

/* ---- boxes ---- */

/* A light of the group that ray i starts from: those of all volumes in turn. */
static const noc_light_record *light_of(const probing *b, const noc_light_key *group, uint32_t count, uint32_t i) {
    const noc_influence *v = b->v;
    uint32_t volume = group[i % count].id, light = volume;
    if (v->first)
        light = v->first[volume] + i / count % (v->first[volume + 1] - v->first[volume]);
    return &b->scene->lights.data[v->ids[light]];
}

static void trace(const probing *b, const noc_light_key *group, uint32_t count, float reach, noc_influence_box *box) {
    float n[3], d[RAYS][3];
    uint32_t key = rng_key(11u, group->id, 0u);
    facing(&b->v->volumes[group->id], n);
    directions(b->lattice, n, 6.2831853f * rng(key, 0u), d);
    for (uint32_t first = 0; first < RAYS; first += NOC_PROBES) {
        noc_probes probes;
        for (uint32_t i = 0; i < NOC_PROBES; i++) {
            uint32_t ray = first + i;
            float o[3];
            noc_light_leave(light_of(b, group, count, ray), d[ray], rng(key, 1u + 2u * ray), rng(key, 2u + 2u * ray),
                            o);
            for (int k = 0; k < 3; k++) {
                probes.o[k][i] = o[k];
                probes.d[k][i] = d[ray][k] * reach;
            }
        }
        b->params->probe(b->params->user, &probes);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < NOC_PROBES; i++) {
                float to = probes.o[k][i] + probes.t[i] * probes.d[k][i];
                box->lo[k] = NOC_MIN(box->lo[k], to);
                box->hi[k] = NOC_MAX(box->hi[k], to);
            }
    }
}

/* Returns S_r times the largest root. */
static float make_box(const probing *b, const noc_light_key *group, uint32_t count, noc_influence_box *box) {
    float reach = 0, root = 0;
    *box = (noc_influence_box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (uint32_t i = 0; i < count; i++) {
        const noc_influence_volume *a = &b->v->volumes[group[i].id];
        float near = a->root * b->v->scale * uncut + a->size;
        reach = NOC_MAX(reach, a->root * b->v->scale * beyond + a->size);
        root = NOC_MAX(root, a->root);
        for (int k = 0; k < 3; k++) {
            box->lo[k] = NOC_MIN(box->lo[k], a->c[k] - near);
            box->hi[k] = NOC_MAX(box->hi[k], a->c[k] + near);
        }
    }
    trace(b, group, count, reach, box);
    for (int k = 0; k < 3; k++) {
        float between = 0.02f * (box->hi[k] - box->lo[k]) + 0.05f;
        box->lo[k] -= between;
        box->hi[k] += between;
    }
    return b->v->scale * root;
}

static void probe_chunk(void *ctx, size_t chunk, int worker) {
    const probing *b = ctx;
    uint32_t *box_of = b->v->box_of;
    size_t end = NOC_MIN((chunk + 1) * CHUNK, b->count);
    (void)worker;
    for (size_t i = chunk * CHUNK, next; i < end; i = next) {
        uint32_t own = box_of[b->order[i].id], at = b->boxes_before[chunk] + own;
        for (next = i; next < end && box_of[b->order[next].id] == own; next++)
            ;
        b->v->box_reach[at] = make_box(b, &b->order[i], (uint32_t)(next - i), &b->v->boxes[at]);
        for (size_t k = i; k < next; k++)
            box_of[b->order[k].id] = at;
    }
}

/* A box that is everywhere, for volumes that have none: lights that move, and those that are dark now. */
static void add_open_box(noc_influence *v) {
    v->boxes[v->box_count] =
        (noc_influence_box){ { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } };
    v->box_reach[v->box_count] = 0;
    for (uint32_t i = 0; i <= v->volume_count; i++)
        if (i >= v->half[NOC_MOVING].first || !(v->volumes[i].root > 0))
            v->box_of[i] = v->box_count;
}

bool noc_influence_probe(noc_influence *v, const noc_scene *scene, const noc_influence_params *params) {
    probing b = { .scene = scene, .params = params, .v = v };
    free(v->boxes);
    free(v->box_reach);
    free(v->box_of);
    v->boxes = NULL;
    v->box_reach = NULL;
    v->box_of = noc_alloc_large((size_t)v->volume_count + 1, sizeof(*v->box_of));
    bool ok = v->box_of && sort_volumes(&b);
    size_t chunks = (b.count + CHUNK - 1) / CHUNK;
    ok = ok && (b.boxes_before = noc_alloc_large(chunks + 1, sizeof(*b.boxes_before)));
    if (ok) {
        b.boxes_before[0] = 0;
        noc_influence_run(params->pool, chunks, group_chunk, &b);
        for (size_t i = 0; i < chunks; i++)
            b.boxes_before[i + 1] += b.boxes_before[i];
        v->box_count = b.boxes_before[chunks];
        v->boxes = noc_alloc_large((size_t)v->box_count + 1, sizeof(*v->boxes));
        v->box_reach = noc_alloc_large((size_t)v->box_count + 1, sizeof(*v->box_reach));
        ok = v->boxes && v->box_reach;
    }
    if (ok) {
        make_lattice(b.lattice);
        noc_influence_run(params->pool, chunks, probe_chunk, &b);
        add_open_box(v);
    }
    free(b.boxes_before);
    free(b.order);
    return ok;
}
