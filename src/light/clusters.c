#include "light/clusters.h"

#include "light/bound.h"

#include <math.h>

/* Face of the cube that a direction points through; 6 for none. */
static unsigned face(const float n[3]) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabsf(n[k]) > fabsf(n[axis]))
            axis = k;
    return n[axis] == 0 ? 6 : 2u * (unsigned)axis + (n[axis] < 0);
}

/* Key: place in coarse cells, direction, place inside the cell; a cell holds some 16 lights a direction on average. */
static void sort_lights(const noc_light_bound *bounds, noc_light_key *leaves, noc_light_key *scratch, size_t n) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, size = 0;
    float hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fminf(lo[k], bounds[leaves[i].id].p[k]);
            hi[k] = fmaxf(hi[k], bounds[leaves[i].id].p[k]);
        }
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, hi[k] - lo[k]);
    float scale = size > 0 ? 1048575.f / size : 0;
    /* Lights of a city lie near a surface: cells of edge size / 2^b hold n / 4^b of them. */
    int coarse = 0;
    while (coarse < 16 && n >> (2 * coarse) > 4 * NOC_CLUSTER_LIGHTS)
        coarse++;
    int below = 3 * (20 - coarse);
    for (size_t i = 0; i < n; i++) {
        const noc_light_bound *b = &bounds[leaves[i].id];
        uint64_t m = 0;
        for (int k = 0; k < 3; k++)
            m |= noc_spread_bits((uint64_t)((b->p[k] - lo[k]) * scale)) << k;
        leaves[i].key = (m >> below) << (below + 3) | (uint64_t)face(b->n) << below | (m & (((uint64_t)1 << below) - 1));
    }
    noc_sort_keys(leaves, scratch, n);
}

/* Do both face alike enough to share a cone? */
static bool alike(const noc_light_bound *a, const noc_light_bound *b) {
    bool any_a = a->n[0] == 0 && a->n[1] == 0 && a->n[2] == 0, any_b = b->n[0] == 0 && b->n[1] == 0 && b->n[2] == 0;
    if (any_a || any_b)
        return any_a == any_b;
    return a->n[0] * b->n[0] + a->n[1] * b->n[1] + a->n[2] * b->n[2] > 0.7f;
}

static void close_cluster(noc_clusters *c, const noc_light_bound *bounds, uint32_t first, uint32_t end) {
    size_t i = c->count++;
    c->first[i] = first;
    c->first[i + 1] = end;
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, n[3] = { 0 }, power = 0;
    for (uint32_t j = first; j < end; j++) {
        const noc_light_bound *b = &bounds[c->ids[j]];
        c->intensity[j] = b->intensity;
        power += b->intensity;
        for (int k = 0; k < 3; k++) {
            lo[k] = fminf(lo[k], b->p[k]);
            hi[k] = fmaxf(hi[k], b->p[k]);
            n[k] += b->n[k];
        }
    }
    float centre[3], r = 0, len = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), cone = 1;
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5f * (lo[k] + hi[k]);
        n[k] = len > 0 ? n[k] / len : 0;
    }
    for (uint32_t j = first; j < end; j++) {
        const noc_light_bound *b = &bounds[c->ids[j]];
        float d[3] = { b->p[0] - centre[0], b->p[1] - centre[1], b->p[2] - centre[2] };
        r = fmaxf(r, sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + b->radius);
        cone = fminf(cone, b->n[0] * n[0] + b->n[1] * n[1] + b->n[2] * n[2]);
    }
    bool any = !(len > 0);
    cone = any ? -1 : fmaxf(-1, cone - 1e-5f); /* outwards of rounding */
    c->x[i] = centre[0];
    c->y[i] = centre[1];
    c->z[i] = centre[2];
    c->radius[i] = r * 1.0001f;
    c->ax[i] = any ? 0 : n[0];
    c->ay[i] = any ? 0 : n[1];
    c->az[i] = any ? 1 : n[2];
    c->cos_cone[i] = cone;
    c->sin_cone[i] = sqrtf(fmaxf(0, 1 - cone * cone));
    c->power[i] = power;
}

static bool allocate(noc_clusters *c, size_t lights) {
    size_t most = lights + NOC_CLUSTER_PAD; /* never more clusters than lights */
    float **fields[] = { &c->x, &c->y, &c->z, &c->radius, &c->ax, &c->ay, &c->az, &c->cos_cone, &c->sin_cone, &c->power };
    bool ok = true;
    for (size_t i = 0; i < NOC_COUNT(fields); i++)
        ok = (*fields[i] = noc_alloc_large(most, sizeof(float))) && ok;
    ok = (c->first = noc_alloc_large(most + 1, sizeof(uint32_t))) && ok;
    ok = (c->ids = noc_alloc_large(lights, sizeof(uint32_t))) && ok;
    ok = (c->intensity = noc_alloc_large(lights, sizeof(float))) && ok;
    c->bytes = (most * (NOC_COUNT(fields) + 1) + 2 * lights) * 4;
    return ok;
}

noc_clusters *noc_clusters_create(const noc_scene *scene, noc_log *log) {
    size_t n = 0, all = scene->lights.len;
    noc_clusters *c = noc_calloc(1, sizeof(*c));
    noc_light_bound *bounds = noc_alloc_large(all, sizeof(*bounds));
    noc_light_key *leaves = noc_alloc_large(2 * all, sizeof(*leaves));
    if (!bounds || !leaves || !allocate(c, all)) {
        noc_error(log, NOC_ERR_MEMORY, "light clusters: no memory for %zu lights", all);
        noc_clusters_destroy(c);
        c = NULL;
        goto done;
    }
    for (size_t i = 0; i < all; i++) {
        bounds[i] = noc_bound_light(&scene->lights.data[i]);
        if (bounds[i].intensity > 0)
            leaves[n++].id = (uint32_t)i;
    }
    if (n)
        sort_lights(bounds, leaves, leaves + all, n);
    for (size_t i = 0; i < n; i++)
        c->ids[i] = leaves[i].id;
    for (uint32_t first = 0, i = 1; first < n; i++)
        if (i == n || i - first == NOC_CLUSTER_LIGHTS || !alike(&bounds[c->ids[first]], &bounds[c->ids[i]])) {
            close_cluster(c, bounds, first, i);
            first = i;
        }
    c->padded = (c->count + NOC_CLUSTER_PAD - 1) / NOC_CLUSTER_PAD * NOC_CLUSTER_PAD;
done:
    free(bounds);
    free(leaves);
    return c;
}

void noc_clusters_destroy(noc_clusters *c) {
    if (!c)
        return;
    float *fields[] = { c->x, c->y, c->z, c->radius, c->ax, c->ay, c->az, c->cos_cone, c->sin_cone, c->power, c->intensity };
    for (size_t i = 0; i < NOC_COUNT(fields); i++)
        free(fields[i]);
    free(c->first);
    free(c->ids);
    free(c);
}
