#include "light/influence.h"

#include "core/influence.h"
#include "light/bound.h"

enum { WIDTH = NOC_INFLUENCE_WIDTH, LEVELS = NOC_INFLUENCE_LEVELS, POINTS = NOC_QUERY_POINTS };

/* ---- hierarchy ---- */

static noc_influence_volume volume_of(const noc_light_record *l) {
    noc_light_bound b = noc_bound_light(l);
    noc_influence_volume v = { .size = b.radius * 1.0001f, .root = b.intensity > 0 ? sqrtf(b.intensity) : 0 };
    memcpy(v.c, b.p, sizeof(v.c));
    memcpy(v.n, b.n, sizeof(v.n));
    return v;
}

/* Keys: size class (a factor of 2 in intensity), then Morton code. */
static void order(noc_influence *v, noc_light_key *keys, size_t n) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, size = 0, most = 0;
    for (size_t i = 0; i < n; i++) {
        const noc_influence_volume *a = &v->volumes[keys[i].id];
        most = NOC_MAX(most, a->root);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], a->c[k]);
            hi[k] = NOC_MAX(hi[k], a->c[k]);
        }
    }
    for (int k = 0; k < 3; k++)
        size = NOC_MAX(size, hi[k] - lo[k]);
    float scale = size > 0 ? 1048575.f / size : 0;
    for (size_t i = 0; i < n; i++) {
        const noc_influence_volume *a = &v->volumes[keys[i].id];
        int smaller = NOC_CLAMP(2 * (ilogbf(most) - ilogbf(a->root)), 0, 15); /* sizes by powers of 2 */
        uint64_t m = (uint64_t)smaller << 60;
        for (int k = 0; k < 3; k++)
            m |= noc_spread_bits((uint64_t)((a->c[k] - lo[k]) * scale)) << k;
        keys[i].key = m & ~0xffffffull; /* 12 bits an axis will do, and sort faster */
    }
    noc_sort_keys(keys, keys + v->count, n);
    for (size_t i = 0; i < n; i++)
        v->ids[i] = keys[i].id;
}

static void set_child(noc_influence_node *node, size_t slot, const float lo[3], const float hi[3], float root) {
    for (int k = 0; k < 3; k++) {
        node->lo[k][slot] = lo[k];
        node->hi[k][slot] = hi[k];
    }
    node->root[slot] = root;
}

static bool build_levels(noc_influence *v, size_t lights) {
    size_t children = lights;
    for (int level = 0; level < LEVELS; level++) {
        size_t nodes = (children + WIDTH - 1) / WIDTH;
        noc_influence_node *to = v->nodes[level] = noc_alloc_large(nodes, sizeof(*to));
        if (!to)
            return false;
        v->bytes += nodes * sizeof(*to);
        v->levels = level + 1;
        for (size_t i = 0; i < children; i++) {
            if (!level) {
                const noc_influence_volume *a = &v->volumes[v->ids[i]];
                set_child(&to[i / WIDTH], i % WIDTH, a->c, a->c, a->root);
                continue;
            }
            const noc_influence_node *from = &v->nodes[level - 1][i];
            float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY }, root = 0;
            for (int s = 0; s < WIDTH && from->root[s] > 0; s++) {
                root = NOC_MAX(root, from->root[s]);
                for (int k = 0; k < 3; k++) {
                    lo[k] = NOC_MIN(lo[k], from->lo[k][s]);
                    hi[k] = NOC_MAX(hi[k], from->hi[k][s]);
                }
            }
            set_child(&to[i / WIDTH], i % WIDTH, lo, hi, root);
        }
        if (nodes == 1)
            return true;
        children = nodes;
    }
    return false; /* 8^12 lights do not fit in memory */
}

/* ---- query ---- */

/* Children of a node that a box comes near enough to. */
static inline uint32_t children_near(const noc_influence_node *n, const float lo[3], const float hi[3], float scale) {
    uint32_t near[WIDTH], bits = 0;
    for (int s = 0; s < WIDTH; s++) {
        float d2 = 0;
        for (int k = 0; k < 3; k++) {
            float below = n->lo[k][s] - hi[k], above = lo[k] - n->hi[k][s];
            float d = below > above ? below : above;
            d = d > 0 ? d : 0;
            d2 += d * d;
        }
        float r = n->root[s] * scale;
        near[s] = (d2 <= r * r) & (n->root[s] > 0);
    }
    for (int s = 0; s < WIDTH; s++)
        bits |= near[s] << s;
    return bits;
}

/* Calls visit for every light near the box until that says stop. Returns whether it was stopped. */
typedef bool visit_fn(void *user, uint32_t light);
static bool walk(const noc_influence *v, const float lo[3], const float hi[3], float scale, visit_fn *visit, void *user) {
    struct { int level; size_t node; } stack[LEVELS * WIDTH];
    int depth = 0;
    scale *= 1.00001f; /* rounding must not lose what the exact test would take */
    if (v->levels)
        stack[depth++].level = v->levels - 1, stack[0].node = 0;
    while (depth) {
        int level = stack[--depth].level;
        size_t node = stack[depth].node;
        uint32_t bits = children_near(&v->nodes[level][node], lo, hi, scale);
        for (; bits; bits &= bits - 1) {
            size_t child = node * WIDTH + (size_t)__builtin_ctz(bits);
            if (level) {
                stack[depth].level = level - 1;
                stack[depth++].node = child;
            } else if (visit(user, v->ids[child])) {
                return true;
            }
        }
    }
    return false;
}

static bool keep_near(void *user, uint32_t light) {
    noc_found *f = user;
    array_push(&f->near, light);
    return false;
}

static influence load(const noc_influence *v, uint32_t light) {
    const noc_influence_volume *a = &v->volumes[light];
    return (influence){ V3(a->c[0], a->c[1], a->c[2]), a->size, V3(a->n[0], a->n[1], a->n[2]), a->root };
}

static bool holds(const noc_influence *v, uint32_t light, const noc_query *q, int l) {
    return influence_holds(load(v, light), V3(q->p[0][l], q->p[1][l], q->p[2][l]), V3(q->n[0][l], q->n[1][l], q->n[2][l]),
                           q->scale);
}

void noc_influence_query(const noc_influence *v, const noc_query *q, noc_found *f) {
    float lo[3] = { INFINITY, INFINITY, INFINITY }, hi[3] = { -INFINITY, -INFINITY, -INFINITY };
    memset(f->count, 0, sizeof(f->count));
    f->near.len = 0;
    for (uint32_t bits = q->lanes; bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        for (int k = 0; k < 3; k++) {
            lo[k] = NOC_MIN(lo[k], q->p[k][l]);
            hi[k] = NOC_MAX(hi[k], q->p[k][l]);
        }
    }
    if (!q->lanes)
        return;
    walk(v, lo, hi, q->scale, keep_near, f);
    array_reserve(&f->ids, f->near.len * POINTS);
    for (size_t i = 0; i < f->near.len; i++) {
        uint32_t id = f->near.data[i], held[POINTS];
        for (int l = 0; l < POINTS; l++)
            held[l] = (q->lanes >> l & 1) & holds(v, id, q, l);
        for (int l = 0; l < POINTS; l++) {
            f->ids.data[f->count[l] * POINTS + (uint32_t)l] = id; /* stays if it is counted */
            f->count[l] += held[l];
        }
    }
}

void noc_found_free(noc_found *f) {
    array_free(&f->near);
    array_free(&f->ids);
}

/* ---- draws ---- */

void noc_influence_draw(const noc_influence *v, const noc_query *q, const noc_found *f, const uint32_t keys[POINTS], int m,
                        int every, uint32_t (*light)[POINTS], float (*inverse)[POINTS]) {
    for (int l = 0; l < POINTS; l++) {
        bool any = f->count[l] > 0;
        float in = 1 / influence_pmf(true, f->count[l], v->count, m, every);
        float out = 1 / influence_pmf(false, f->count[l], v->count, m, every);
        for (int i = 0; i < m; i++) {
            uint32_t bits = rng_bits(keys[l], DIM_CANDIDATE + 3u * (uint32_t)i);
            if (any && i % every) {
                light[i][l] = f->ids.data[scale_u32(bits, f->count[l]) * POINTS + (uint32_t)l];
                inverse[i][l] = in;
            } else {
                light[i][l] = scale_u32(bits, v->count);
                inverse[i][l] = any && holds(v, light[i][l], q, l) ? in : out;
            }
        }
    }
}

float noc_influence_pmf(const noc_influence *v, const noc_query *q, const noc_found *f, int point, int m, int every,
                        uint32_t light) {
    bool held = f->count[point] && holds(v, light, q, point);
    return influence_pmf(held, f->count[point], v->count, m, every);
}

/* ---- S_r ---- */

/* Surface points that S_r is found for, and how many volumes should hold the median one. */
enum { EXAMPLES = 512, HANDFUL = 8 };

typedef struct example {
    float p[3], n[3];
} example;

typedef struct box {
    float lo[3], hi[3];
} box;

/* Where light can be looked for: around all lights, as far again as a tenth of their spread. */
static box box_of_lights(const noc_influence *v, size_t lights) {
    box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    float size = 0;
    for (size_t i = 0; i < lights; i++)
        for (int k = 0; k < 3; k++) {
            b.lo[k] = NOC_MIN(b.lo[k], v->volumes[v->ids[i]].c[k]);
            b.hi[k] = NOC_MAX(b.hi[k], v->volumes[v->ids[i]].c[k]);
            size = NOC_MAX(size, b.hi[k] - b.lo[k]);
        }
    for (int k = 0; k < 3; k++) {
        b.lo[k] -= 10 + 0.1f * size;
        b.hi[k] += 10 + 0.1f * size;
    }
    return b;
}

/* Edges a, b and unit normal n of a triangle from its first corner p; returns its area inside the box, about. Triangles that
 * show a light count as nothing. */
static double triangle(const noc_scene *s, size_t t, const box *in, const float **p, float a[3], float b[3], float n[3]) {
    const float *c[3];
    if (s->triangle_light.len > t && s->triangle_light.data[t] != NOC_NO_LIGHT)
        return 0;
    for (int i = 0; i < 3; i++)
        c[i] = s->positions.data + 3 * (size_t)s->indices.data[3 * t + (size_t)i];
    double share = 1;
    for (int k = 0; k < 3; k++) {
        a[k] = c[1][k] - c[0][k];
        b[k] = c[2][k] - c[0][k];
        float lo = c[0][k] + NOC_MIN(0, NOC_MIN(a[k], b[k])), hi = c[0][k] + NOC_MAX(0, NOC_MAX(a[k], b[k]));
        float inside = NOC_MIN(hi, in->hi[k]) - NOC_MAX(lo, in->lo[k]);
        share *= inside < 0 ? 0 : hi > lo ? inside / (hi - lo) : 1;
    }
    *p = c[0];
    for (int k = 0; k < 3; k++)
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
    for (int k = 0; k < 3 && length > 0; k++)
        n[k] /= (float)length;
    return 0.5 * length * share;
}

/* Points spread evenly over the area of all surfaces in the box: land to the horizon has nothing to say about streets.
 * Returns how many there are. */
static int take_examples(const noc_scene *s, const box *in, example *out) {
    size_t triangles = s->indices.len / 3;
    double total = 0, sum = 0;
    int goal = 0, count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t t = 0; t < triangles; t++) {
            const float *p = NULL;
            float a[3] = { 0 }, b[3] = { 0 };
            example e;
            double area = triangle(s, t, in, &p, a, b, e.n);
            if (!pass) {
                total += area;
                continue;
            }
            for (sum += area; goal < EXAMPLES && area > 0 && sum > total * ((goal + 0.5) / EXAMPLES); goal++) {
                bool inside = false;
                for (uint32_t attempt = 0; attempt < 64 && !inside; attempt++) {
                    uint32_t key = rng_key(7u, (uint32_t)goal, attempt);
                    float u = rng(key, 0), v = rng(key, 1), fold = u + v > 1 ? 1 : 0;
                    inside = true;
                    for (int k = 0; k < 3; k++) {
                        e.p[k] = p[k] + fabsf(fold - u) * a[k] + fabsf(fold - v) * b[k];
                        inside = inside && e.p[k] >= in->lo[k] && e.p[k] <= in->hi[k];
                    }
                }
                if (inside)
                    out[count++] = e;
            }
        }
    return count;
}

typedef struct count_run {
    const noc_influence *v;
    noc_query q;
    int count, enough;
} count_run;

static bool count_light(void *user, uint32_t light) {
    count_run *c = user;
    c->count += holds(c->v, light, &c->q, 0);
    return c->count >= c->enough;
}

/* Does a volume of that scale hold the point at least so many times? */
static bool holds_enough(const noc_influence *v, const example *e, float scale, int enough) {
    count_run c = { .v = v, .q = { { e->p, e->p + 1, e->p + 2 }, { e->n, e->n + 1, e->n + 2 }, 1, scale }, .enough = enough };
    return walk(v, e->p, e->p, scale, count_light, &c);
}

/* Bisection on log2 S_r, until half of the examples that any light can reach are held by a handful of volumes. Where there
 * are not that many lights, the reach of the first is what counts. */
static float find_scale(const noc_influence *v, const noc_scene *scene, size_t lights) {
    example *e = noc_alloc(EXAMPLES * sizeof(*e));
    box in = box_of_lights(v, lights);
    int n = take_examples(scene, &in, e), lit = 0, handful = (int)NOC_MIN(HANDFUL, (lights + 1) / 2);
    const float widest = 1e6f;
    for (int i = 0; i < n; i++)
        if (holds_enough(v, &e[i], widest, handful))
            e[lit++] = e[i];
    float lo = -20, hi = log2f(widest);
    for (int step = 0; step < 16 && lit; step++) {
        float at = 0.5f * (lo + hi);
        int enough = 0;
        for (int i = 0; i < lit; i++)
            enough += holds_enough(v, &e[i], exp2f(at), handful);
        if (2 * enough >= lit)
            hi = at;
        else
            lo = at;
    }
    free(e);
    return lit ? exp2f(hi) : 1;
}

noc_influence *noc_influence_create(const noc_scene *scene, noc_log *log) {
    size_t all = scene->lights.len, n = 0;
    noc_influence *v = noc_calloc(1, sizeof(*v));
    noc_light_key *keys = noc_alloc_large(2 * all + 1, sizeof(*keys));
    v->count = (uint32_t)all;
    v->volumes = noc_alloc_large(all + 1, sizeof(*v->volumes));
    v->ids = noc_alloc_large(all + 1, sizeof(*v->ids));
    v->bytes = (all + 1) * (sizeof(*v->volumes) + sizeof(*v->ids));
    bool ok = keys && v->volumes && v->ids;
    for (size_t i = 0; i < all && ok; i++) {
        v->volumes[i] = volume_of(&scene->lights.data[i]);
        if (v->volumes[i].root > 0)
            keys[n++].id = (uint32_t)i;
    }
    if (ok && n) {
        order(v, keys, n);
        ok = build_levels(v, n);
    }
    free(keys);
    if (!ok) {
        noc_error(log, NOC_ERR_MEMORY, "influence volumes: no memory for %zu lights", all);
        noc_influence_destroy(v);
        return NULL;
    }
    v->scale = n ? find_scale(v, scene, n) : 1;
    return v;
}

void noc_influence_destroy(noc_influence *v) {
    if (!v)
        return;
    for (int i = 0; i < LEVELS; i++)
        free(v->nodes[i]);
    free(v->volumes);
    free(v->ids);
    free(v);
}
