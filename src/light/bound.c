#include "light/bound.h"

#include <math.h>

static float luminance(const float e[3]) { return 0.2126f * e[0] + 0.7152f * e[1] + 0.0722f * e[2]; }

float noc_light_intensity(const noc_light_record *l) {
    float y = luminance(l->e);
    if (noc_light_has_profile(l))
        return y * l->area;
    switch (l->kind) {
    case NOC_LIGHT_SPHERE: return y * (float)M_PI * l->radius * l->radius;
    case NOC_LIGHT_POINT:
    case NOC_LIGHT_SPOT: return y;
    default: return y * l->area;
    }
}

noc_light_bound noc_bound_light(const noc_light_record *l) {
    noc_light_bound b = { .intensity = noc_light_intensity(l) };
    memcpy(b.p, l->p, sizeof(b.p));
    bool profile = noc_light_has_profile(l); /* it is two-sided where it sends anything behind its axis */
    if (!profile && (l->kind == NOC_LIGHT_SPHERE || l->kind == NOC_LIGHT_POINT)) {
        b.radius = l->radius;
        return b;
    }
    if (l->kind == NOC_LIGHT_SPOT) { /* its cone is no wider than a flat light's half space */
        double len = sqrt((double)l->a[0] * l->a[0] + (double)l->a[1] * l->a[1] + (double)l->a[2] * l->a[2]);
        for (int k = 0; k < 3; k++)
            b.n[k] = (float)(l->a[k] / len);
        return b;
    }
    if (!(l->flags & LIGHT_TWO_SIDED)) {
        double n[3] = { (double)l->a[1] * l->b[2] - (double)l->a[2] * l->b[1],
                        (double)l->a[2] * l->b[0] - (double)l->a[0] * l->b[2],
                        (double)l->a[0] * l->b[1] - (double)l->a[1] * l->b[0] };
        double len = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int k = 0; k < 3 && len > 0; k++)
            b.n[k] = (float)(n[k] / len);
    }
    if (l->kind == NOC_LIGHT_DISC || profile) {
        b.radius = l->radius;
        return b;
    }
    float share = l->kind == NOC_LIGHT_TRIANGLE ? 1.f / 3 : 0.5f, far = 0;
    for (int k = 0; k < 3; k++)
        b.p[k] = l->p[k] + share * (l->a[k] + l->b[k]);
    for (int corner = 0; corner < 4; corner++) {
        float d2 = 0;
        for (int k = 0; k < 3; k++) {
            float c = l->p[k] + (corner & 1 ? l->a[k] : 0) + (corner & 2 ? l->b[k] : 0) - b.p[k];
            d2 += c * c;
        }
        if (l->kind == NOC_LIGHT_PARALLELOGRAM || corner != 3)
            far = fmaxf(far, d2);
    }
    b.radius = sqrtf(far);
    return b;
}

void noc_light_leave(const noc_light_record *l, const float d[3], float u, float v, float out[3]) {
    float clear = 0.01f;
    for (int k = 0; k < 3; k++) {
        switch (l->kind) {
        case NOC_LIGHT_SPHERE:
        case NOC_LIGHT_POINT:
        case NOC_LIGHT_SPOT: out[k] = l->p[k] + d[k] * (l->radius + clear); break;
        case NOC_LIGHT_DISC: out[k] = l->p[k] + (u - 0.5f) * l->a[k] + (v - 0.5f) * l->b[k] + d[k] * clear; break;
        default:
            out[k] = l->p[k] + 0.5f * (u * l->a[k] + v * l->b[k]) + 0.25f * (l->a[k] + l->b[k]) + d[k] * clear;
            break;
        }
    }
}

uint64_t noc_side(const float n[3]) {
    int axis = 0;
    for (int k = 1; k < 3; k++)
        axis = fabsf(n[k]) > fabsf(n[axis]) ? k : axis;
    return n[axis] == 0 ? 6 : (uint64_t)(2 * axis + (n[axis] < 0));
}

uint64_t noc_spread_bits(uint64_t x) {
    x &= 0xfffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

void noc_sort_keys(noc_light_key *a, noc_light_key *scratch, size_t n) {
    for (int shift = 0; shift < 64; shift += 8) {
        size_t at[257] = { 0 };
        for (size_t i = 0; i < n; i++)
            at[(a[i].key >> shift & 255) + 1]++;
        if (at[(a[0].key >> shift & 255) + 1] == n)
            continue;
        for (int i = 0; i < 256; i++)
            at[i + 1] += at[i];
        for (size_t i = 0; i < n; i++)
            scratch[at[a[i].key >> shift & 255]++] = a[i];
        memcpy(a, scratch, n * sizeof(*a));
    }
}
