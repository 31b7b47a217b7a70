#include "light/alias.h"

#include "light/bound.h"

/* Weights that sum to the number of lights. Lights without emission get 0; the weakest others a millionth of the mean,
 * so that a weak light close by is still found, and 1 / pmf stays a sane number. Returns false where nothing emits. */
static bool weigh(const noc_scene *scene, double *weight) {
    size_t n = scene->lights.len, shining = 0;
    double total = 0, raised = 0;
    for (size_t i = 0; i < n; i++) {
        weight[i] = noc_light_flux(&scene->lights.data[i]);
        weight[i] = weight[i] > 0 ? weight[i] : 0; /* and not a number counts as none */
        total += weight[i];
        shining += weight[i] > 0;
    }
    if (!shining || !(total > 0))
        return false;
    double least = total / (double)shining * 1e-6;
    for (size_t i = 0; i < n; i++) {
        if (weight[i] > 0 && weight[i] < least)
            weight[i] = least;
        raised += weight[i];
    }
    for (size_t i = 0; i < n; i++)
        weight[i] *= (double)n / raised;
    return true;
}

/* Vose's algorithm: a slot that is not full is filled from one that overflows. */
static void fill(noc_alias *a, const double *weight, double *left, uint32_t *stack) {
    uint32_t n = a->count, small = 0, large = n;
    for (uint32_t i = 0; i < n; i++) {
        left[i] = weight[i];
        a->slots[i] = (noc_alias_slot){ .keep = 1, .other = i, .inverse = weight[i] > 0 ? (float)(n / weight[i]) : 0 };
        stack[left[i] < 1 ? small++ : --large] = i; /* small ones from the left, large ones from the right */
    }
    uint32_t fullest = large < n ? stack[large] : 0;
    while (small && large < n) {
        uint32_t s = stack[--small], l = stack[large];
        a->slots[s].keep = (float)left[s];
        a->slots[s].other = l;
        left[l] -= 1 - left[s];
        if (left[l] < 1) {
            large++;
            stack[small++] = l;
        }
    }
    /* Rounding leaves slots that are as good as full. Not those of lights that must never be drawn. */
    while (small) {
        uint32_t s = stack[--small];
        if (weight[s] > 0)
            continue;
        a->slots[s].keep = 0;
        a->slots[s].other = fullest;
    }
    for (uint32_t i = 0; i < n; i++)
        a->slots[i].inverse_other = a->slots[a->slots[i].other].inverse;
}

/* A table with room for n slots, and none yet. */
static noc_alias *make(size_t n) {
    noc_alias *a = noc_calloc(1, sizeof(*a));
    if (a && !(a->slots = noc_alloc_large(n + 1, sizeof(*a->slots)))) {
        free(a);
        return NULL;
    }
    if (a)
        a->bytes = (n + 1) * sizeof(*a->slots);
    return a;
}

noc_alias *noc_alias_create(const noc_scene *scene, noc_log *log) {
    size_t n = scene->lights.len;
    noc_alias *a = make(n);
    double *weight = noc_alloc_large(2 * n + 1, sizeof(*weight));
    uint32_t *stack = noc_alloc_large(n + 1, sizeof(*stack));
    if (!a || !weight || !stack) {
        noc_error(log, NOC_ERR_MEMORY, "alias table: no memory for %zu lights", n);
        noc_alias_destroy(a);
        a = NULL;
    } else if (weigh(scene, weight)) {
        a->count = (uint32_t)n;
        fill(a, weight, weight + n, stack);
    }
    free(weight);
    free(stack);
    return a;
}

noc_alias *noc_alias_of(const double *weight, size_t n, const char *what, noc_log *log) {
    noc_alias *a = make(n);
    double *mean = noc_alloc_large(2 * n + 1, sizeof(*mean)), total = 0;
    uint32_t *stack = noc_alloc_large(n + 1, sizeof(*stack));
    for (size_t i = 0; i < n; i++)
        total += weight[i];
    if (!a || !mean || !stack) {
        noc_error(log, NOC_ERR_MEMORY, "%s: no memory for an alias table of %zu slots", what, n);
        noc_alias_destroy(a);
        a = NULL;
    } else if (total > 0) {
        for (size_t i = 0; i < n; i++)
            mean[i] = weight[i] * ((double)n / total);
        a->count = (uint32_t)n;
        fill(a, mean, mean + n, stack);
    }
    free(mean);
    free(stack);
    return a;
}

void noc_alias_destroy(noc_alias *a) {
    if (!a)
        return;
    free(a->slots);
    free(a);
}
