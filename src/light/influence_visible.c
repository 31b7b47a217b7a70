/* Visibility-aware boxes (Algorithm 4): rays from the lights of a volume, as long as its radius, and the box around their
 * ends. Surfaces outside it are taken not to see these lights; those that do, through gaps between the rays, have the
 * uniform draws. Unlike in the thesis, the rays are spread evenly and the box grows by what may lie between them. */
#include "light/influence_parts.h"

#include "core/random.h"

enum { RAYS = 64, CHUNK = 64 };

/* Boxes are probed for wider volumes too: points that find no handful ask for them (NOC_INFLUENCE_STEPS). */
static const float wider = 4;

typedef struct probing {
    const noc_scene *scene;
    const noc_influence_params *params;
    noc_influence *v;
} probing;

/* Direction i of RAYS on a spherical Fibonacci lattice, turned about z; into the half space of m. */
static void direction(int i, float turn, const float m[3], float out[3]) {
    float z = 1 - (2 * (float)i + 1) / RAYS, r = sqrtf(NOC_MAX(1 - z * z, 0)), a = 2.39996323f * (float)i + turn, cos = 0;
    out[0] = r * cosf(a);
    out[1] = r * sinf(a);
    out[2] = z;
    for (int k = 0; k < 3; k++)
        cos += out[k] * m[k];
    for (int k = 0; k < 3 && cos < 0; k++)
        out[k] = -out[k];
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

static void probe_volume(const probing *b, uint32_t volume) {
    const noc_influence *v = b->v;
    const noc_influence_volume *a = &v->volumes[volume];
    noc_influence_box *box = &v->boxes[volume];
    uint32_t from = v->first ? v->first[volume] : volume, count = v->first ? v->first[volume + 1] - from : 1;
    uint32_t key = rng_key(11u, volume, 0u);
    float reach = a->root * v->reach + a->size, turn = 6.2831853f * rng(key, 0u);
    for (int k = 0; k < 3; k++) {
        box->lo[k] = a->c[k] - a->size;
        box->hi[k] = a->c[k] + a->size;
    }
    for (int first = 0; first < RAYS; first += NOC_PROBES) {
        noc_probes probes;
        for (int i = 0; i < NOC_PROBES; i++) {
            float d[3], o[3];
            uint32_t n = (uint32_t)(first + i);
            direction(first + i, turn, a->m, d);
            origin(&b->scene->lights.data[v->ids[from + n % count]], d, rng(key, 1u + 2u * n), rng(key, 2u + 2u * n), o);
            for (int k = 0; k < 3; k++) {
                probes.o[k][i] = o[k];
                probes.d[k][i] = d[k] * reach;
            }
        }
        b->params->probe(b->params->user, &probes);
        for (int i = 0; i < NOC_PROBES; i++)
            for (int k = 0; k < 3; k++) {
                float end = probes.o[k][i] + probes.t[i] * probes.d[k][i];
                box->lo[k] = NOC_MIN(box->lo[k], end);
                box->hi[k] = NOC_MAX(box->hi[k], end);
            }
    }
    for (int k = 0; k < 3; k++) {
        float between = 0.02f * (box->hi[k] - box->lo[k]) + 0.05f;
        box->lo[k] -= between;
        box->hi[k] += between;
    }
}

static void probe_chunk(void *ctx, size_t item, int worker) {
    const probing *b = ctx;
    (void)worker;
    size_t end = NOC_MIN((item + 1) * CHUNK, (size_t)b->v->volume_count);
    for (size_t i = item * CHUNK; i < end; i++)
        probe_volume(b, (uint32_t)i);
}

bool noc_influence_probe(noc_influence *v, const noc_scene *scene, const noc_influence_params *params) {
    probing b = { scene, params, v };
    v->boxes = noc_alloc_large((size_t)v->volume_count + 1, sizeof(*v->boxes));
    if (!v->boxes)
        return false;
    v->reach = v->scale * (params->scale > 0 ? 1 : wider);
    v->bytes += ((size_t)v->volume_count + 1) * sizeof(*v->boxes);
    noc_influence_run(params->pool, ((size_t)v->volume_count + CHUNK - 1) / CHUNK, probe_chunk, &b);
    return true;
}
