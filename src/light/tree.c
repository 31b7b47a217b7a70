#include "light/tree.h"

#include "light/bound.h"

#include <math.h>

enum { BINS = 12 };

typedef struct build {
    noc_tree *t;
    noc_light_bound *lights; /* reordered as the tree splits them */
    uint32_t *ids;
} build;

/* What the split goes by: a box, the sum of the ways they face (as if of length 1), the sum of their intensities. */
typedef struct heap {
    float lo[3], hi[3], n[3], power;
    uint32_t count;
} heap;

static const heap empty_heap = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, { 0 }, 0, 0 };

static void heap_add(heap *h, const noc_light_bound *b) {
    for (int k = 0; k < 3; k++) {
        h->lo[k] = NOC_MIN(h->lo[k], b->p[k] - b->radius);
        h->hi[k] = NOC_MAX(h->hi[k], b->p[k] + b->radius);
        h->n[k] += b->n[k];
    }
    h->power += b->intensity;
    h->count++;
}

static void heap_join(heap *h, const heap *a) {
    for (int k = 0; k < 3; k++) {
        h->lo[k] = NOC_MIN(h->lo[k], a->lo[k]);
        h->hi[k] = NOC_MAX(h->hi[k], a->hi[k]);
        h->n[k] += a->n[k];
    }
    h->power += a->power;
    h->count += a->count;
}

/* Power times surface area times spread of directions. The spread is judged by the length of the mean direction: 1 where
 * all agree, 0 where they cancel out or face every way. Areas are kept from vanishing where lights lie on a line. */
static float heap_cost(const heap *h, float least) {
    float d[3];
    for (int k = 0; k < 3; k++)
        d[k] = h->hi[k] - h->lo[k] + least;
    float area = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    float mean = sqrtf(h->n[0] * h->n[0] + h->n[1] * h->n[1] + h->n[2] * h->n[2]) / (float)h->count;
    return h->power * area * (2 - mean);
}

static int bin_of(const noc_light_bound *b, int axis, float lo, float scale, int bins) {
    return NOC_CLAMP((int)((b->p[axis] - lo) * scale), 0, bins - 1);
}

/* Cheapest of the splits between bins on all three axes. Returns the number of lights on the first side, 0 where all lie in
 * one place. */
static uint32_t split(build *b, uint32_t first, uint32_t end, const heap *all) {
    noc_light_bound *l = b->lights;
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, best = INFINITY, size = 0;
    for (uint32_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], l[i].p[k]);
            hi[k] = NOC_MAX(hi[k], l[i].p[k]);
        }
    for (int k = 0; k < 3; k++)
        size = NOC_MAX(size, all->hi[k] - all->lo[k]);
    int axis = -1, edge = 0, n_bins = end - first < 16 ? 4 : BINS;
    for (int k = 0; k < 3; k++) {
        if (!(hi[k] > lo[k]))
            continue;
        heap bins[BINS], sum = empty_heap;
        float scale = (float)n_bins / (hi[k] - lo[k]), above[BINS] = { 0 };
        if (!(scale < 1e30f))
            continue;
        for (int i = 0; i < n_bins; i++)
            bins[i] = empty_heap;
        for (uint32_t i = first; i < end; i++)
            heap_add(&bins[bin_of(&l[i], k, lo[k], scale, n_bins)], &l[i]);
        for (int i = n_bins - 1; i > 0; i--) {
            heap_join(&sum, &bins[i]);
            above[i] = sum.count ? heap_cost(&sum, 0.01f * size) : INFINITY;
        }
        sum = empty_heap;
        float longer = size / (hi[k] - lo[k]); /* against thin slabs */
        for (int i = 0; i < n_bins - 1; i++) {
            heap_join(&sum, &bins[i]);
            float cost = sum.count ? (heap_cost(&sum, 0.01f * size) + above[i + 1]) * longer : INFINITY;
            if (cost < best) {
                best = cost;
                axis = k;
                edge = i;
            }
        }
    }
    if (axis < 0)
        return 0;
    float scale = (float)n_bins / (hi[axis] - lo[axis]);
    uint32_t i = first, j = end;
    while (i < j) {
        if (bin_of(&l[i], axis, lo[axis], scale, n_bins) <= edge) {
            i++;
            continue;
        }
        j--;
        noc_light_bound light = l[i];
        uint32_t id = b->ids[i];
        l[i] = l[j];
        b->ids[i] = b->ids[j];
        l[j] = light;
        b->ids[j] = id;
    }
    return i - first;
}

/* Sphere around the box's middle, cone around the mean direction. */
static void bound_node(const build *b, uint32_t first, uint32_t end, const heap *all, noc_tree_node *node) {
    float len = sqrtf(all->n[0] * all->n[0] + all->n[1] * all->n[1] + all->n[2] * all->n[2]), r = 0, cone = 1;
    for (int k = 0; k < 3; k++) {
        node->c[k] = 0.5f * (all->lo[k] + all->hi[k]);
        node->axis[k] = len > 1e-3f ? all->n[k] / len : 0;
    }
    for (uint32_t i = first; i < end; i++) {
        const noc_light_bound *l = &b->lights[i];
        float d[3] = { l->p[0] - node->c[0], l->p[1] - node->c[1], l->p[2] - node->c[2] };
        r = NOC_MAX(r, sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + l->radius);
        bool any = l->n[0] == 0 && l->n[1] == 0 && l->n[2] == 0;
        float c = l->n[0] * node->axis[0] + l->n[1] * node->axis[1] + l->n[2] * node->axis[2];
        cone = NOC_MIN(cone, any ? -1 : c);
    }
    cone = len > 1e-3f && cone > -1 ? NOC_MAX(-1, cone - 1e-5f) : -1; /* outwards of rounding */
    if (cone <= -1) {
        node->axis[0] = node->axis[1] = 0;
        node->axis[2] = 1;
    }
    node->radius = r * 1.0001f;
    node->cos_cone = cone;
    node->sin_cone = sqrtf(NOC_MAX(0, 1 - cone * cone));
    node->power = all->power;
}

static int bits_for(uint32_t lights) { return lights > 1 ? 32 - __builtin_clz(lights - 1) : 0; }

/* Iterative: lights [first, end) become node `at`. Splits are even where the way down would get too long else. */
static void grow(build *b, uint32_t lights) {
    struct { uint32_t first, end, at, path; int depth; } stack[2 * NOC_TREE_DEPTH + 2], w;
    int waiting = 0;
    noc_tree *t = b->t;
    stack[waiting].first = stack[waiting].at = stack[waiting].path = 0;
    stack[waiting].depth = 0;
    stack[waiting++].end = lights;
    t->count = 1;
    while (waiting) {
        w = stack[--waiting];
        heap all = empty_heap;
        noc_tree_node *node = &t->nodes[w.at];
        for (uint32_t i = w.first; i < w.end; i++)
            heap_add(&all, &b->lights[i]);
        bound_node(b, w.first, w.end, &all, node);
        uint32_t n = w.end - w.first, left = 0;
        if (n == 1) {
            node->light = b->ids[w.first];
            t->paths[node->light] = w.path;
            t->depth = NOC_MAX(t->depth, w.depth);
            continue;
        }
        if (n > 2 && w.depth + 1 + bits_for(n - 1) <= NOC_TREE_DEPTH)
            left = split(b, w.first, w.end, &all);
        if (!left || left == n)
            left = n / 2;
        node->child = t->count;
        t->count += 2;
        for (uint32_t side = 0; side < 2; side++) {
            stack[waiting].first = side ? w.first + left : w.first;
            stack[waiting].end = side ? w.end : w.first + left;
            stack[waiting].at = node->child + side;
            stack[waiting].path = w.path | side << w.depth;
            stack[waiting++].depth = w.depth + 1;
        }
    }
}

noc_tree *noc_tree_create(const noc_scene *scene, noc_log *log) {
    size_t all = scene->lights.len;
    uint32_t n = 0;
    noc_tree *t = noc_calloc(1, sizeof(*t));
    build b = { t, noc_alloc_large(all + 1, sizeof(*b.lights)), noc_alloc_large(all + 1, sizeof(*b.ids)) };
    t->nodes = noc_alloc_large(2 * all + 1, sizeof(*t->nodes));
    t->paths = noc_alloc_large(all + 1, sizeof(*t->paths));
    if (!b.lights || !b.ids || !t->nodes || !t->paths) {
        noc_error(log, NOC_ERR_MEMORY, "light tree: no memory for %zu lights", all);
        noc_tree_destroy(t);
        t = NULL;
        goto done;
    }
    t->bytes = (2 * all + 1) * sizeof(*t->nodes) + (all + 1) * sizeof(*t->paths);
    for (size_t i = 0; i < all; i++) {
        b.lights[n] = noc_bound_light(&scene->lights.data[i]);
        b.ids[n] = (uint32_t)i;
        n += b.lights[n].intensity > 0;
    }
    if (n)
        grow(&b, n);
done:
    free(b.lights);
    free(b.ids);
    return t;
}

void noc_tree_destroy(noc_tree *t) {
    if (!t)
        return;
    free(t->nodes);
    free(t->paths);
    free(t);
}
