/* Visibility-aware boxes (Algorithm 4): rays from lights, as long as their reach, and the box around their ends. Surfaces
 * outside it are taken not to see these lights; those that do, through gaps between the rays, have the uniform draws. Unlike
 * in the thesis, volumes that lie close together and shine the same way share a box, and its rays start from their lights in
 * turn: what one window of a facade sees its neighbours see too, so that rays are a few a light. Directions are spread evenly,
 * and the box grows by what may lie between them. */
#include "light/influence_parts.h"

#include "core/random.h"

#include <math.h>

/* Lights that share a box, at most, where they do not share a volume; rays a box; volumes that a thread takes at once. */
enum { GROUP = 16, RAYS = 64, CHUNK = 1024 };

/* Boxes are probed for wider volumes too: points that find no handful ask for them (NOC_INFLUENCE_STEPS). */
static const float wider = 4;

/* A direction of a unit sphere around z: its height, 0 to 1, and its azimuth. */
typedef struct lattice_point {
    float azimuth, height, cos, sin;
} lattice_point;

typedef struct probing {
    const noc_scene *scene;
    const noc_influence_params *params;
    noc_influence *v;
    uint32_t *boxes_before; /* a chunk of volumes: boxes of the chunks before it */
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

/* A point of a light that light leaves in direction d from, clear of the light's own surface. */
static void origin(const noc_light_record *l, const float d[3], float u, float v, float out[3]) {
    float clear = 0.01f;
    for (int k = 0; k < 3; k++) {
        switch (l->kind) {
        case NOC_LIGHT_SPHERE:
        case NOC_LIGHT_POINT: out[k] = l->p[k] + d[k] * (l->radius + clear); break;
        case NOC_LIGHT_DISC: out[k] = l->p[k] + (u - 0.5f) * l->a[k] + (v - 0.5f) * l->b[k] + d[k] * clear; break;
        default: out[k] = l->p[k] + 0.5f * (u * l->a[k] + v * l->b[k]) + 0.25f * (l->a[k] + l->b[k]) + d[k] * clear; break;
        }
    }
}

/* ---- volumes that share a box ---- */

static void facing(const noc_influence_volume *a, float n[3]) {
    float length = sqrtf(a->m[0] * a->m[0] + a->m[1] * a->m[1] + a->m[2] * a->m[2]);
    for (int k = 0; k < 3; k++)
        n[k] = length > 0 ? a->m[k] / length : 0;
}

static uint32_t lights_before(const noc_influence *v, uint32_t volume) { return v->first ? v->first[volume] : volume; }

/* The end of the group that starts with a volume: those that follow it, are about as large, shine the same way, and lie within
 * half of what they reach; so it is for lights that share a volume. */
static uint32_t group_end(const noc_influence *v, uint32_t begin, uint32_t end) {
    const noc_influence_volume *first = &v->volumes[begin];
    float n[3], lo[3], hi[3], most = 0.5f * v->scale * first->root;
    facing(first, n);
    memcpy(lo, first->c, sizeof(lo));
    memcpy(hi, first->c, sizeof(hi));
    uint32_t i = begin + 1;
    for (; i < end && lights_before(v, i + 1) - lights_before(v, begin) <= GROUP; i++) {
        const noc_influence_volume *a = &v->volumes[i];
        float own[3], d2 = 0, apart2 = 0;
        facing(a, own);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], a->c[k]);
            hi[k] = NOC_MAX(hi[k], a->c[k]);
            d2 += (hi[k] - lo[k]) * (hi[k] - lo[k]);
            apart2 += (own[k] - n[k]) * (own[k] - n[k]);
        }
        if (!(d2 <= most * most && apart2 <= 0.25f && a->root <= 1.5f * first->root && first->root <= 1.5f * a->root))
            break;
    }
    return i;
}

static void group_chunk(void *ctx, size_t chunk, int worker) {
    probing *b = ctx;
    noc_influence *v = b->v;
    uint32_t end = (uint32_t)NOC_MIN((chunk + 1) * CHUNK, (size_t)v->volume_count), boxes = 0;
    (void)worker;
    for (uint32_t i = (uint32_t)(chunk * CHUNK), next; i < end; i = next, boxes++)
        for (next = group_end(v, i, end); i < next; i++)
            v->box_of[i] = boxes;
    b->boxes_before[chunk + 1] = boxes;
}

/* ---- boxes ---- */

static void trace(const probing *b, uint32_t begin, uint32_t end, uint32_t key, noc_influence_box *box) {
    const noc_influence *v = b->v;
    uint32_t from = lights_before(v, begin), count = lights_before(v, end) - from;
    float n[3], d[RAYS][3], reach = 0;
    for (uint32_t i = begin; i < end; i++)
        reach = NOC_MAX(reach, v->volumes[i].root * v->reach + v->volumes[i].size);
    facing(&v->volumes[begin], n);
    directions(b->lattice, n, 6.2831853f * rng(key, 0u), d);
    for (uint32_t first = 0; first < RAYS; first += NOC_PROBES) {
        noc_probes probes;
        for (uint32_t i = 0; i < NOC_PROBES; i++) {
            uint32_t ray = first + i;
            float o[3];
            origin(&b->scene->lights.data[v->ids[from + ray % count]], d[ray], rng(key, 1u + 2u * ray), rng(key, 2u + 2u * ray), o);
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

static void probe_chunk(void *ctx, size_t chunk, int worker) {
    const probing *b = ctx;
    noc_influence *v = b->v;
    uint32_t end = (uint32_t)NOC_MIN((chunk + 1) * CHUNK, (size_t)v->volume_count);
    (void)worker;
    for (uint32_t i = (uint32_t)(chunk * CHUNK), next; i < end; i = next) {
        uint32_t local = v->box_of[i], at = b->boxes_before[chunk] + local;
        noc_influence_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
        for (next = i; next < end && v->box_of[next] == local; next++)
            for (int k = 0; k < 3; k++) {
                box.lo[k] = NOC_MIN(box.lo[k], v->volumes[next].c[k] - v->volumes[next].size);
                box.hi[k] = NOC_MAX(box.hi[k], v->volumes[next].c[k] + v->volumes[next].size);
            }
        trace(b, i, next, rng_key(11u, i, 0u), &box);
        for (int k = 0; k < 3; k++) {
            float between = 0.02f * (box.hi[k] - box.lo[k]) + 0.05f;
            box.lo[k] -= between;
            box.hi[k] += between;
        }
        v->boxes[at] = box;
        for (uint32_t k = i; k < next; k++)
            v->box_of[k] = at;
    }
}

bool noc_influence_probe(noc_influence *v, const noc_scene *scene, const noc_influence_params *params) {
    size_t chunks = ((size_t)v->volume_count + CHUNK - 1) / CHUNK;
    probing b = { .scene = scene, .params = params, .v = v };
    b.boxes_before = noc_alloc_large(chunks + 1, sizeof(*b.boxes_before));
    v->box_of = noc_alloc_large((size_t)v->volume_count + 1, sizeof(*v->box_of));
    bool ok = b.boxes_before && v->box_of;
    if (ok) {
        v->reach = v->scale * (params->scale > 0 ? 1 : wider);
        noc_influence_run(params->pool, chunks, group_chunk, &b);
        for (size_t i = 0; i < chunks; i++)
            b.boxes_before[i + 1] += b.boxes_before[i];
        v->box_count = b.boxes_before[chunks];
        v->boxes = noc_alloc_large(v->box_count, sizeof(*v->boxes));
        v->bytes += v->box_count * sizeof(*v->boxes) + ((size_t)v->volume_count + 1) * sizeof(*v->box_of);
        ok = v->boxes != NULL;
    }
    if (ok) {
        make_lattice(b.lattice);
        noc_influence_run(params->pool, chunks, probe_chunk, &b);
    }
    free(b.boxes_before);
    return ok;
}
