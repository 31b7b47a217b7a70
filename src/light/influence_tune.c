/* S_r for a scene, after the aim of Algorithm 6: a surface that light reaches finds lights, and not too many. */
#include "light/influence_parts.h"

#include "core/influence.h"

/* Surface points that S_r is found for. Fewer where there are many lights: all points look at all lights. */
enum { EXAMPLES = 512, FEWEST_EXAMPLES = 32, EVERY = 4, MANY = 128 };
static const size_t most_looks = (size_t)1 << 24;

typedef struct example {
    float p[3], n[3];
    float needs;
} example;

typedef struct box {
    float lo[3], hi[3];
} box;

/* Where light can be looked for: around all lights, as far again as a tenth of their spread. */
static box box_of_lights(const noc_influence *v) {
    box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    float size = 0;
    for (uint32_t i = 0; i < v->volume_count; i++)
        for (int k = 0; k < 3; k++) {
            b.lo[k] = NOC_MIN(b.lo[k], v->volumes[i].c[k]);
            b.hi[k] = NOC_MAX(b.hi[k], v->volumes[i].c[k]);
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
static int take_examples(const noc_scene *s, const box *in, int wanted, example *out) {
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
            for (sum += area; goal < wanted && area > 0 && sum > total * ((goal + 0.5) / wanted); goal++) {
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

typedef struct tuning {
    const noc_influence *v;
    example *examples;
} tuning;

/* How many volumes hold an example. */
static uint32_t held_by(const noc_influence *v, v3 p, v3 n, float scale) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < v->volume_count; i++) {
        influence a;
        memcpy(&a, &v->volumes[i], sizeof(a));
        v3 d = sub3(p, a.c);
        float reach = a.root * scale + a.size;
        count += (dot3(d, d) < reach * reach) & (dot3(a.m, d) >= -1) & (dot3(n, d) < a.size);
    }
    return count;
}

/* The S_r that draws best at an example, less where it would find too many. */
static void look_around(void *ctx, size_t item, int worker) {
    const tuning *t = ctx;
    example *e = &t->examples[item];
    (void)worker;
    v3 p = V3(e->p[0], e->p[1], e->p[2]), n = V3(e->n[0], e->n[1], e->n[2]);
    double sum = 0;
    for (uint32_t i = 0; i < t->v->volume_count; i++) {
        influence a;
        memcpy(&a, &t->v->volumes[i], sizeof(a));
        float needs = influence_needs(a, influence_point(p, n));
        sum += needs < INFLUENCE_NEVER ? influence_square(needs) : 0;
    }
    e->needs = sum > 0 ? influence_best((float)sum, (float)t->v->count, EVERY) : INFLUENCE_NEVER;
    if (!(sum > 0))
        return;
    uint32_t held = held_by(t->v, p, n, e->needs);
    if (held > MANY) /* lights lie about in a plane */
        e->needs *= sqrtf((float)MANY / (float)held);
}

static int by_needs(const void *a, const void *b) {
    float x = ((const example *)a)->needs, y = ((const example *)b)->needs;
    return (x > y) - (x < y);
}

/* The median of what is best at the examples that face a light at all. */
float noc_influence_tune(const noc_influence *v, const noc_scene *scene, noc_pool *pool) {
    int wanted = (int)NOC_CLAMP(most_looks / v->volume_count, (size_t)FEWEST_EXAMPLES, (size_t)EXAMPLES), lit = 0;
    example *e = noc_alloc(EXAMPLES * sizeof(*e));
    box in = box_of_lights(v);
    int n = take_examples(scene, &in, wanted, e);
    noc_influence_run(pool, (size_t)n, look_around, &(tuning){ v, e });
    qsort(e, (size_t)n, sizeof(*e), by_needs);
    while (lit < n && e[lit].needs < INFLUENCE_NEVER)
        lit++;
    float scale = lit ? e[lit / 2].needs : 1;
    free(e);
    return NOC_CLAMP(scale, 1e-6f, 1e6f);
}
