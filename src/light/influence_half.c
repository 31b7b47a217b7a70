/* The hierarchy over the volumes of one half. */
#include "light/influence_parts.h"

enum { WIDTH = NOC_INFLUENCE_WIDTH, LEVELS = NOC_INFLUENCE_LEVELS, CHUNK = 256 };

static size_t groups(size_t n) { return (n + WIDTH - 1) / WIDTH; }

bool noc_influence_make_half(noc_influence_half *h) {
    size_t total = 0;
    free(h->nodes);
    h->nodes = NULL;
    h->levels = 0;
    if (!h->count)
        return true;
    for (size_t nodes = groups(groups(h->count));; nodes = groups(nodes)) {
        if (h->levels == LEVELS) /* 16^9 lights do not fit in memory */
            return false;
        h->level_at[h->levels++] = (uint32_t)total;
        total += nodes;
        if (nodes == 1)
            break;
    }
    h->nodes = noc_alloc_large(total, sizeof(*h->nodes));
    return h->nodes != NULL;
}

static void grow(float lo[3], float hi[3], const float a[3], const float b[3]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = NOC_MIN(lo[k], a[k]);
        hi[k] = NOC_MAX(hi[k], b[k]);
    }
}

/* A level whose nodes are bounded. */
typedef struct bounding {
    const noc_influence *v;
    const noc_influence_half *h;
    int level;
    size_t below; /* volumes, or nodes of the level below */
} bounding;

/* Box and largest root of what is under child i: its 16 volumes, or the children of a node below. */
static float bound_child(const bounding *b, size_t i, float lo[3], float hi[3]) {
    float root = 0;
    if (!b->level) {
        size_t end = NOC_MIN((i + 1) * WIDTH, b->below);
        for (size_t j = i * WIDTH; j < end; j++) {
            const noc_influence_volume *a = &b->v->volumes[b->h->first + j];
            float from[3] = { a->c[0] - a->size, a->c[1] - a->size, a->c[2] - a->size };
            float to[3] = { a->c[0] + a->size, a->c[1] + a->size, a->c[2] + a->size };
            grow(lo, hi, from, to);
            root = NOC_MAX(root, a->root);
        }
        return root;
    }
    const noc_influence_node *n = &b->h->nodes[b->h->level_at[b->level - 1] + i];
    for (int s = 0; s < WIDTH; s++) { /* those that are not there have a box that holds nothing */
        float from[3] = { n->lo[0][s], n->lo[1][s], n->lo[2][s] }, to[3] = { n->hi[0][s], n->hi[1][s], n->hi[2][s] };
        grow(lo, hi, from, to);
        root = NOC_MAX(root, n->root[s]);
    }
    return root;
}

static void bound_nodes(void *ctx, size_t chunk, int worker) {
    const bounding *b = ctx;
    size_t children = b->level ? b->below : groups(b->below), end = NOC_MIN((chunk + 1) * CHUNK, groups(children));
    (void)worker;
    for (size_t node = chunk * CHUNK; node < end; node++) {
        noc_influence_node *to = &b->h->nodes[b->h->level_at[b->level] + node];
        for (size_t s = 0; s < WIDTH; s++) {
            float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
            size_t child = node * WIDTH + s;
            to->root[s] = child < children ? bound_child(b, child, lo, hi) : 0;
            for (int k = 0; k < 3; k++) {
                to->lo[k][s] = lo[k];
                to->hi[k][s] = hi[k];
            }
        }
    }
}

void noc_influence_bound_half(const noc_influence *v, const noc_influence_half *h, noc_pool *pool) {
    bounding b = { v, h, 0, h->count };
    for (; b.level < h->levels; b.level++) {
        size_t nodes = groups(b.level ? b.below : groups(b.below));
        noc_influence_run(nodes > CHUNK ? pool : NULL, (nodes + CHUNK - 1) / CHUNK, bound_nodes, &b);
        b.below = nodes;
    }
}
