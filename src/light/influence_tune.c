/* S_r for a scene, after the aim of Algorithm 6: a surface that light reaches finds lights, and not too many. */
#include "light/influence_parts.h"

#include "core/influence.h"

/* Surface points that S_r is found for, fewer where there are many lights, for each might look at all of them; volumes in a row
 * that are passed over together. */
enum { EXAMPLES = 512, FEWEST_EXAMPLES = 64, EVERY = 4, MANY = 128, RUN = 128 };
static const size_t most_looks = (size_t)1 << 24;

/* Runs that could not add that share to what a point has got are passed over. */
static const double negligible = 1e-4;

typedef struct example {
    float p[3], n[3];
    float needs;
} example;

typedef struct box {
    float lo[3], hi[3];
} box;

/* What a run of volumes lies in. */
typedef struct volume_run {
    box centres;
    float size, root; /* largest */
} volume_run;

typedef struct tuning {
    const noc_influence *v;
    volume_run *runs;
    size_t run_count;
    example *examples;
} tuning;

static size_t run_end(const tuning *t, size_t run) { return NOC_MIN((run + 1) * RUN, (size_t)t->v->volume_count); }

static void bound_run(void *ctx, size_t item, int worker) {
    const tuning *t = ctx;
    volume_run r = { { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } }, 0, 0 };
    (void)worker;
    for (size_t i = item * RUN; i < run_end(t, item); i++) {
        const noc_influence_volume *a = &t->v->volumes[i];
        for (int k = 0; k < 3; k++) {
            r.centres.lo[k] = NOC_MIN(r.centres.lo[k], a->c[k]);
            r.centres.hi[k] = NOC_MAX(r.centres.hi[k], a->c[k]);
        }
        r.size = NOC_MAX(r.size, a->size);
        r.root = NOC_MAX(r.root, a->root);
    }
    t->runs[item] = r;
}

/* Where light can be looked for: around all lights, as far again as a tenth of their spread. */
static box box_of_lights(const tuning *t) {
    box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    float size = 0;
    for (size_t i = 0; i < t->run_count; i++)
        for (int k = 0; k < 3; k++) {
            b.lo[k] = NOC_MIN(b.lo[k], t->runs[i].centres.lo[k]);
            b.hi[k] = NOC_MAX(b.hi[k], t->runs[i].centres.hi[k]);
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

/* None of a run's volumes holds a point at less S_r than that. */
static float run_needs(const volume_run *r, const float p[3]) {
    float d2 = 0;
    for (int k = 0; k < 3; k++) {
        float below = r->centres.lo[k] - p[k], above = p[k] - r->centres.hi[k], d = below > above ? below : above;
        d = d > 0 ? d : 0;
        d2 += d * d;
    }
    return (sqrtf(d2) - r->size) / r->root;
}

/* Sum of E^2 of a run's lights at an example. */
static double run_squares(const tuning *t, size_t run, influence_region at) {
    double sum = 0;
    for (size_t i = run * RUN; i < run_end(t, run); i++) {
        influence a;
        memcpy(&a, &t->v->volumes[i], sizeof(a));
        float needs = influence_needs(a, at);
        sum += needs < INFLUENCE_NEVER ? influence_square(needs) : 0;
    }
    return sum;
}

/* Sum of E^2 of all lights at an example, to a hundredth or so: of the run that could give most, and of those that could still
 * add something. What is left out falls with the fourth power of the distance. */
static double squares_at(const tuning *t, const float p[3], influence_region at) {
    size_t nearest = 0;
    float nearest_needs = INFINITY;
    for (size_t i = 0; i < t->run_count; i++) {
        float needs = run_needs(&t->runs[i], p);
        if (needs < nearest_needs) {
            nearest_needs = needs;
            nearest = i;
        }
    }
    double sum = run_squares(t, nearest, at);
    for (size_t i = 0; i < t->run_count; i++)
        if (i != nearest && RUN * (double)influence_square(run_needs(&t->runs[i], p)) > negligible * sum)
            sum += run_squares(t, i, at);
    return sum;
}

/* How many volumes hold an example. */
static uint32_t held_by(const tuning *t, const float p[3], influence_region at, float scale) {
    uint32_t count = 0;
    for (size_t run = 0; run < t->run_count; run++)
        for (size_t i = run * RUN; i < run_end(t, run) && run_needs(&t->runs[run], p) <= scale * 1.00001f; i++) {
            influence a;
            memcpy(&a, &t->v->volumes[i], sizeof(a));
            count += influence_needs(a, at) <= scale;
        }
    return count;
}

/* The S_r that draws best at an example, less where it would find too many. */
static void look_around(void *ctx, size_t item, int worker) {
    const tuning *t = ctx;
    example *e = &t->examples[item];
    (void)worker;
    influence_region at = influence_point(V3(e->p[0], e->p[1], e->p[2]), V3(e->n[0], e->n[1], e->n[2]));
    double sum = squares_at(t, e->p, at);
    e->needs = sum > 0 ? influence_best((float)sum, (float)t->v->count, EVERY) : INFLUENCE_NEVER;
    if (!(sum > 0))
        return;
    uint32_t held = held_by(t, e->p, at, e->needs);
    if (held > MANY) /* lights lie about in a plane */
        e->needs *= sqrtf((float)MANY / (float)held);
}

static int by_needs(const void *a, const void *b) {
    float x = ((const example *)a)->needs, y = ((const example *)b)->needs;
    return (x > y) - (x < y);
}

/* The median of what is best at the examples that face a light at all. */
static float tune(tuning *t, const noc_scene *scene, noc_pool *pool) {
    noc_influence_run(pool, t->run_count, bound_run, t);
    box in = box_of_lights(t);
    int wanted = (int)NOC_CLAMP(most_looks / t->v->volume_count, (size_t)FEWEST_EXAMPLES, (size_t)EXAMPLES);
    int n = take_examples(scene, &in, wanted, t->examples), lit = 0;
    noc_influence_run(pool, (size_t)n, look_around, t);
    qsort(t->examples, (size_t)n, sizeof(*t->examples), by_needs);
    while (lit < n && t->examples[lit].needs < INFLUENCE_NEVER)
        lit++;
    float scale = lit ? t->examples[lit / 2].needs : 1;
    return NOC_CLAMP(scale, 1e-6f, 1e6f);
}

float noc_influence_tune(const noc_influence *v, const noc_scene *scene, noc_pool *pool) {
    tuning t = { .v = v, .run_count = ((size_t)v->volume_count + RUN - 1) / RUN };
    t.runs = noc_alloc_large(t.run_count, sizeof(*t.runs));
    t.examples = noc_alloc_large(EXAMPLES, sizeof(*t.examples));
    float scale = t.runs && t.examples ? tune(&t, scene, pool) : 0;
    free(t.runs);
    free(t.examples);
    return scale;
}
