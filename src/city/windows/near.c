/* Which pieces of wall without a facet lie by another and in a plane: a tree of boxes over where pieces lie and face.
 * Pieces that have a facet are taken out, so that one is not looked at again from each of a facet's others. */
#include "city/windows/parts.h"

#define LEAF 4
#define SLACK 1e-6 /* of coordinates and cosines, and more than doubles lose */

enum { MIDDLE = 0, NORMAL = 3, KEYS = 6 };

typedef struct near_node {
    double lo[3], hi[3];             /* around the pieces */
    double least[KEYS], most[KEYS];  /* of their middles and normals */
    bool thin;                       /* one's own normal tells little */
    uint32_t first, count, live, up; /* of ids; those in it; those still in it; the node over it */
} near_node;

struct near_pieces {
    const wall_piece *pieces;
    double (*keys)[KEYS];
    uint32_t *ids, *leaf; /* leaf: of each piece */
    near_node *nodes;     /* those below node i are 2 i + 1 and 2 i + 2 */
};

static bool is_thin(const wall_piece *p) { return p->thin < 2 * WINDOW_MERGE_MM / 1000; }

static void find_keys(const wall_piece *p, double key[KEYS]) {
    for (int k = 0; k < 3; k++) {
        key[MIDDLE + k] = (p->t.p[0][k] + p->t.p[1][k] + p->t.p[2][k]) / 3;
        key[NORMAL + k] = p->n[k];
    }
}

static near_node node_of(const near_pieces *t, uint32_t first, uint32_t count) {
    near_node n = { .first = first, .count = count, .live = count };
    for (int k = 0; k < KEYS; k++) {
        n.least[k] = INFINITY;
        n.most[k] = -INFINITY;
    }
    memcpy(n.lo, n.least, sizeof(n.lo));
    memcpy(n.hi, n.most, sizeof(n.hi));
    for (uint32_t i = first; i < first + count; i++) {
        const wall_piece *p = &t->pieces[t->ids[i]];
        const double *key = t->keys[t->ids[i]];
        n.thin = n.thin || is_thin(p);
        for (int k = 0; k < 3; k++) {
            n.lo[k] = fmin(n.lo[k], p->lo[k]);
            n.hi[k] = fmax(n.hi[k], p->hi[k]);
        }
        for (int k = 0; k < KEYS; k++) {
            n.least[k] = fmin(n.least[k], key[k]);
            n.most[k] = fmax(n.most[k], key[k]);
        }
    }
    return n;
}

typedef struct key_order {
    const double (*keys)[KEYS];
    int key;
} key_order;

static int compare_keys(const void *a, const void *b, void *user) {
    const key_order *o = user;
    uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
    double x = o->keys[i][o->key], y = o->keys[j][o->key];
    return x != y ? (x > y) - (x < y) : (i > j) - (i < j);
}

/* Normals count as lengths of the node's own size. */
static int widest(const near_node *n) {
    double size = fmax(fmax(n->hi[0] - n->lo[0], n->hi[1] - n->lo[1]), n->hi[2] - n->lo[2]);
    int best = 0;
    double most = -1;
    for (int k = 0; k < KEYS; k++) {
        double width = (n->most[k] - n->least[k]) * (k < NORMAL ? 1 : size);
        if (width > most) {
            most = width;
            best = k;
        }
    }
    return best;
}

static void divide(near_pieces *t, size_t node, uint32_t up, uint32_t first, uint32_t count) {
    t->nodes[node] = node_of(t, first, count);
    t->nodes[node].up = up;
    if (count <= LEAF) {
        for (uint32_t i = first; i < first + count; i++)
            t->leaf[t->ids[i]] = (uint32_t)node;
        return;
    }
    key_order order = { (const double(*)[KEYS])t->keys, widest(&t->nodes[node]) };
    qsort_r(t->ids + first, count, sizeof(*t->ids), compare_keys, &order);
    divide(t, 2 * node + 1, (uint32_t)node, first, count / 2);
    divide(t, 2 * node + 2, (uint32_t)node, first + count / 2, count - count / 2);
}

near_pieces *near_pieces_make(const wall_piece *pieces, size_t count) {
    near_pieces *t = noc_calloc(1, sizeof(*t));
    size_t nodes = 1;
    for (size_t size = count; size > LEAF; size = (size + 1) / 2)
        nodes = 2 * nodes + 1;
    if (!t)
        return NULL;
    *t = (near_pieces){ .pieces = pieces,
                        .keys = noc_alloc(NOC_MAX(count, 1u) * sizeof(*t->keys)),
                        .ids = noc_alloc(NOC_MAX(count, 1u) * sizeof(*t->ids)),
                        .leaf = noc_alloc(NOC_MAX(count, 1u) * sizeof(*t->leaf)),
                        .nodes = noc_calloc(nodes, sizeof(*t->nodes)) };
    if (!t->keys || !t->ids || !t->leaf || !t->nodes) {
        near_pieces_free(t);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        t->ids[i] = (uint32_t)i;
        find_keys(&pieces[i], t->keys[i]);
    }
    divide(t, 0, 0, 0, (uint32_t)count);
    return t;
}

void near_pieces_free(near_pieces *t) {
    if (!t)
        return;
    free(t->keys);
    free(t->ids);
    free(t->leaf);
    free(t->nodes);
    free(t);
}

void near_pieces_take(near_pieces *t, uint32_t piece) {
    uint32_t node = t->leaf[piece];
    t->nodes[node].live--;
    while (node) {
        node = t->nodes[node].up;
        t->nodes[node].live--;
    }
}

/* Can the plane hold a piece of the node, one whose box comes to that of `from`? */
static bool may_hold(const near_node *n, const wall_piece *from, const wall_plane *plane) {
    double off = 0, reach = 0, facing = 0, size = 0;
    if (!n->live)
        return false;
    for (int k = 0; k < 3; k++) {
        if (from->lo[k] - n->hi[k] > WINDOW_MERGE_MM / 1000 || n->lo[k] - from->hi[k] > WINDOW_MERGE_MM / 1000)
            return false;
        off += plane->n[k] * (0.5 * (n->least[k] + n->most[k]) - plane->c[k]);
        reach += fabs(plane->n[k]) * 0.5 * (n->most[k] - n->least[k]);
        size += fabs(n->least[k]) + fabs(n->most[k]) + fabs(plane->c[k]);
        facing += fmax(plane->n[k] * n->least[NORMAL + k], plane->n[k] * n->most[NORMAL + k]);
    }
    double least = n->thin ? 0 : cos(WINDOW_MERGE_DEG * M_PI / 180);
    return facing > least - SLACK && fabs(off) - reach <= WINDOW_MERGE_MM / 1000 + SLACK * size;
}

bool near_pieces_find(const near_pieces *t, const wall_piece *from, const wall_plane *plane, near_found *found,
                      size_t *looks) {
    size_t stack[64], depth = 0;
    found->len = 0;
    stack[depth++] = 0;
    while (depth) {
        size_t at = stack[--depth];
        const near_node *n = &t->nodes[at];
        ++*looks;
        if (!may_hold(n, from, plane))
            continue;
        if (n->count > LEAF) {
            stack[depth++] = 2 * at + 2;
            stack[depth++] = 2 * at + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++)
            if (t->pieces[t->ids[i]].facet == NO_FACET && !array_push(found, t->ids[i]))
                return false;
    }
    *looks += found->len;
    return true;
}
