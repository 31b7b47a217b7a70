/* Point queries of influence volumes. */
#include "light/influence.h"

#include "core/influence.h"

enum { WIDTH = NOC_INFLUENCE_WIDTH, LEVELS = NOC_INFLUENCE_LEVELS };

void noc_influence_destroy(noc_influence *v) {
    if (!v)
        return;
    for (int i = 0; i < LEVELS; i++)
        free(v->nodes[i]);
    free(v->volumes);
    free(v->boxes);
    free(v->box_of);
    free(v->first);
    free(v->ids);
    free(v->volume_of);
    free(v);
}

/* ---- volumes near a box ---- */

noc_near_query noc_near_none(float scale, size_t most) {
    return (noc_near_query){ .lo = { INFINITY, INFINITY, INFINITY }, .hi = { -INFINITY, -INFINITY, -INFINITY }, .back = INFINITY,
                             .scale = scale, .most = most };
}

void noc_near_add(noc_near_query *q, const float *const p[3], const float *const n[3], uint32_t lanes) {
    for (uint32_t bits = lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        bool first = q->lo[0] > q->hi[0], same = true;
        for (int k = 0; k < 3; k++) {
            if (first)
                q->n[k] = n[k][l];
            same = same && fabsf(q->n[k] - n[k][l]) <= 1e-5f;
            q->lo[k] = NOC_MIN(q->lo[k], p[k][l]);
            q->hi[k] = NOC_MAX(q->hi[k], p[k][l]);
        }
        if (!same) {
            memset(q->n, 0, sizeof(q->n));
            q->back = -INFINITY;
        }
        q->back = NOC_MIN(q->back, q->n[0] * p[0][l] + q->n[1] * p[1][l] + q->n[2] * p[2][l]);
    }
}

/* Children of a node that a box comes near enough to, and that are not wholly behind its surfaces. */
static inline uint32_t children_near(const noc_influence_node *n, const noc_near_query *q) {
    uint32_t near[WIDTH], bits = 0;
    for (int s = 0; s < WIDTH; s++) {
        float d2 = 0, front = 0, r = n->root[s] * q->scale;
        for (int k = 0; k < 3; k++) {
            float below = n->lo[k][s] - q->hi[k], above = q->lo[k] - n->hi[k][s];
            float d = below > above ? below : above;
            d = d > 0 ? d : 0;
            d2 += d * d;
            front += q->n[k] * (q->n[k] > 0 ? n->hi[k][s] : n->lo[k][s]);
        }
        /* the normals are the same to 1e-5, and the coordinates have their own precision */
        near[s] = (d2 <= r * r) & (n->root[s] > 0) & (front >= q->back - 0.02f - 1e-4f * r);
    }
    for (int s = 0; s < WIDTH; s++)
        bits |= near[s] << s;
    return bits;
}

static void keep_near(const noc_influence *v, uint32_t volume, noc_near *out) {
    const noc_influence_volume *a = &v->volumes[volume];
    uint32_t lane = (uint32_t)(out->count++ & 15);
    if (!lane) {
        array_reserve(&out->groups, out->groups.len + 1);
        noc_near_group *g = &out->groups.data[out->groups.len++];
        memset(g, 0, sizeof(*g));
        for (int i = 0; i < 16; i++)
            g->size[i] = -INFINITY;
    }
    noc_near_group *g = &out->groups.data[out->groups.len - 1];
    for (int k = 0; k < 3; k++) {
        g->c[k][lane] = a->c[k];
        g->m[k][lane] = a->m[k];
    }
    g->size[lane] = a->size;
    g->root[lane] = a->root;
    g->lights[lane] = v->first ? (float)(v->first[volume + 1] - v->first[volume]) : 1;
    g->volume[lane] = volume;
}

static void near_leaf(const noc_influence *v, const noc_near_query *q, size_t leaf, noc_near *out) {
    size_t end = NOC_MIN((leaf + 1) * WIDTH, (size_t)v->volume_count);
    for (size_t i = leaf * WIDTH; i < end; i++) {
        const noc_influence_volume *a = &v->volumes[i];
        float reach = a->root * q->scale + a->size, d2 = 0;
        for (int k = 0; k < 3; k++) {
            float below = a->c[k] - q->hi[k], above = q->lo[k] - a->c[k], d = below > above ? below : above;
            d = d > 0 ? d : 0;
            d2 += d * d;
        }
        if (d2 <= reach * reach)
            keep_near(v, (uint32_t)i, out);
    }
}

void noc_influence_near(const noc_influence *v, const noc_near_query *asked, noc_near *out) {
    struct { int level; size_t node; } stack[LEVELS * WIDTH];
    int depth = 0;
    noc_near_query q = *asked;
    out->count = out->groups.len = 0;
    out->over = false;
    q.scale *= 1.00001f; /* rounding must not lose what the exact test would take */
    if (!v->levels || q.lo[0] > q.hi[0])
        return;
    stack[depth++].level = v->levels - 1, stack[0].node = 0;
    while (depth) {
        int level = stack[--depth].level;
        size_t node = stack[depth].node;
        for (uint32_t bits = children_near(&v->nodes[level][node], &q); bits; bits &= bits - 1) {
            size_t child = node * WIDTH + (size_t)__builtin_ctz(bits);
            if (level) {
                stack[depth].level = level - 1;
                stack[depth++].node = child;
                continue;
            }
            near_leaf(v, &q, child, out);
            if (out->count > q.most) {
                out->over = true;
                return;
            }
        }
    }
}

const noc_near *noc_around_near(const noc_influence *v, noc_around *a, int rung) {
    if (!(a->asked >> rung & 1)) {
        noc_near_query q = a->query;
        q.scale *= (float)(1 << 2 * rung);
        q.most = rung ? NOC_INFLUENCE_WIDER : q.most;
        noc_influence_near(v, &q, &a->near[rung]);
        a->asked |= 1u << rung;
    }
    return &a->near[rung];
}

void noc_around_free(noc_around *a) {
    for (int i = 0; i < NOC_INFLUENCE_RUNGS; i++)
        array_free(&a->near[i].groups);
}

void noc_found_free(noc_found *f) {
    array_free(&f->ids);
    array_free(&f->near.groups);
    array_free(&f->needs);
}

bool noc_influence_holds(const noc_influence *v, uint32_t light, const noc_near_query *q) {
    influence a;
    uint32_t volume = v->volume_of[light];
    influence_region r = { V3(q->lo[0], q->lo[1], q->lo[2]), V3(q->hi[0], q->hi[1], q->hi[2]), V3(q->n[0], q->n[1], q->n[2]), q->back };
    memcpy(&a, &v->volumes[volume], sizeof(a));
    if (!(influence_needs(a, r) <= q->scale))
        return false;
    if (!v->boxes)
        return true;
    const noc_influence_box *b = &v->boxes[v->box_of[volume]];
    return influence_meets(V3(b->lo[0], b->lo[1], b->lo[2]), V3(b->hi[0], b->hi[1], b->hi[2]), r);
}
