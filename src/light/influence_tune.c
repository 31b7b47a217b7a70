/* S_r for a scene, after the aim of Algorithm 6: a surface that light reaches finds lights, and not too many. */
#include "light/influence_parts.h"

#include "light/bound.h"

#include "core/influence.h"

struct core_context {
    noc_influence_bins *bins;
};
#define RULE_BINS_OF(ctx) (ctx)->bins
#include "light/influence_bins.h"

/* Surface points that S_r is found for, fewer where there are many lights; volumes in a row that are one where they are
 * far away. */
enum { EXAMPLES = 512, FEWEST_EXAMPLES = 64, EVERY = 4, RUN = 64 };
static const size_t most_looks = (size_t)1 << 24;

/* Where lights lie about evenly in a plane, lists of sqrt(b N / u) are best. Ones that are longer by more than that
 * cost more than they are worth: each point looks at all lights that the scene's S_r finds. */
static const float enough = 1.5f;

/* So many of the examples would list weaker lights than the scene's S_r finds. Those are many, and bring little. With a
 * half of the examples frames of four views took longer, and errors moved both ways. */
static const float unserved = 0.7f;

/* Shares of what places face that they see, where no rays can tell. */
static const float usual_seen[NOC_RULE_SHARES] = { 0.1f, 0.3f, 0.5f, 0.7f };

/* The share of what bright places get that is too little to be seen. */
static const float dim = 0.05f;

typedef struct example {
    float p[3], n[3];
    float gets, seen; /* from all lights, lux; share of it that arrives */
    rule_range range;
    noc_influence_bins bins;
} example;

typedef struct box {
    float lo[3], hi[3];
} box;

/* What a run of volumes lies in. */
typedef struct volume_run {
    box centres;
    float root; /* of the mean of their intensities */
} volume_run;

typedef struct tuning {
    noc_influence *v;
    const noc_scene *scene;
    const noc_influence_params *params;
    size_t first, end; /* volumes */
    volume_run *runs;
    size_t run_count;
    example *examples;
} tuning;

static size_t run_begin(const tuning *t, size_t run) { return t->first + run * RUN; }
static size_t run_end(const tuning *t, size_t run) { return NOC_MIN(run_begin(t, run) + RUN, t->end); }

static void bound_run(void *ctx, size_t item, int worker) {
    const tuning *t = ctx;
    volume_run r = { { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } }, 0 };
    (void)worker;
    for (size_t i = run_begin(t, item); i < run_end(t, item); i++) {
        const noc_influence_volume *a = &t->v->volumes[i];
        for (int k = 0; k < 3; k++) {
            r.centres.lo[k] = NOC_MIN(r.centres.lo[k], a->c[k]);
            r.centres.hi[k] = NOC_MAX(r.centres.hi[k], a->c[k]);
        }
        r.root += a->root * a->root;
    }
    r.root = sqrtf(r.root / (float)(run_end(t, item) - run_begin(t, item)));
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

/* Edges a, b and unit normal n of a triangle from its first corner p; returns its area inside the box, about. Triangles
 * that show a light count as nothing. */
static double triangle(const noc_scene *s, size_t t, const box *in, const float **p, float a[3], float b[3],
                       float n[3]) {
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

/* Distance of a run's centre from a point, and the half diagonal of its box. */
static float run_distance(const volume_run *r, const float p[3], float *half) {
    float d2 = 0, h2 = 0;
    for (int k = 0; k < 3; k++) {
        float d = 0.5f * (r->centres.lo[k] + r->centres.hi[k]) - p[k], h = 0.5f * (r->centres.hi[k] - r->centres.lo[k]);
        d2 += d * d;
        h2 += h * h;
    }
    *half = sqrtf(h2);
    return sqrtf(d2);
}

/* What volume k, or all of a run that is far away, gives an example: e lux from each light. Those of a run count as if
 * they were in its middle; of them a quarter of what they give, for which way they face is not looked at. */
typedef struct giving {
    size_t first, end; /* volumes */
    float e;
} giving;

typedef void giving_fn(void *ctx, const giving *g);

static void each_giving(const tuning *t, const example *e, giving_fn *fn, void *ctx) {
    influence_region at = influence_point(V3(e->p[0], e->p[1], e->p[2]), V3(e->n[0], e->n[1], e->n[2]));
    for (size_t i = 0; i < t->run_count; i++) {
        float half, d = run_distance(&t->runs[i], e->p, &half), s = d / t->runs[i].root;
        giving g = { run_begin(t, i), run_end(t, i), 0.25f / (s * s) };
        if (d > 3 * half && half > 0) {
            fn(ctx, &g);
            continue;
        }
        for (size_t k = g.first, end = g.end; k < end; k++) {
            influence a;
            memcpy(&a, &t->v->volumes[k], sizeof(a));
            if (!influence_holds(a, at, 1e18f))
                continue;
            g = (giving){ k, k + 1, influence_gives(a, influence_turn(a), at) };
            if (g.e > 0)
                fn(ctx, &g);
        }
    }
}

static void add_giving(void *ctx, const giving *g) {
    example *e = ctx;
    float lights = (float)(g->end - g->first);
    rule_add(&(struct core_context){ &e->bins }, e->range, lights, g->e);
    e->gets += lights * g->e;
}

/* Rays to lights, in proportion to what they give. */
typedef struct looking {
    const tuning *t;
    const example *e;
    uint32_t key;
    int rays;
    float passed; /* light of those before */
    noc_probes probes;
} looking;

static void aim(looking *look, uint32_t volume) {
    const example *e = look->e;
    const noc_light_record *l = &look->t->scene->lights.data[look->t->v->ids[volume]];
    float d[3], to[3], length = 0, o[3];
    uint32_t i = (uint32_t)look->rays++;
    for (int k = 0; k < 3; k++) {
        d[k] = e->p[k] - look->t->v->volumes[volume].c[k];
        length += d[k] * d[k];
    }
    length = sqrtf(fmaxf(length, 1e-12f));
    for (int k = 0; k < 3; k++) {
        to[k] = e->p[k] + 1e-3f * length * e->n[k];
        d[k] /= length;
    }
    noc_light_leave(l, d, rng(look->key, 1u + 2u * i), rng(look->key, 2u + 2u * i), o);
    for (int k = 0; k < 3; k++) {
        look->probes.o[k][i] = o[k];
        look->probes.d[k][i] = to[k] - o[k];
    }
}

static void aim_at(void *ctx, const giving *g) {
    looking *look = ctx;
    look->passed += (float)(g->end - g->first) * g->e;
    while (look->rays < NOC_PROBES &&
           look->passed >= look->e->gets * ((float)look->rays + rng(look->key, 0u)) / NOC_PROBES)
        aim(look, (uint32_t)(g->first + hash_u32(look->key + (uint32_t)look->rays) % (g->end - g->first)));
}

/* What all lights give an example, and how much of it arrives. */
static void look_around(void *ctx, size_t item, int worker) {
    const tuning *t = ctx;
    example *e = &t->examples[item];
    float most = 0;
    (void)worker;
    for (size_t i = 0; i < t->run_count; i++) {
        float half, d = run_distance(&t->runs[i], e->p, &half);
        most = NOC_MAX(most, (d + half) / t->runs[i].root);
    }
    e->range = rule_begin(&(struct core_context){ &e->bins }, 1 / (most * most));
    e->gets = 0;
    e->seen = usual_seen[item % NOC_RULE_SHARES];
    each_giving(t, e, add_giving, e);
    if (!t->params->probe || !(e->gets > 0))
        return;
    looking look = { .t = t, .e = e, .key = rng_key(13u, (uint32_t)item, 0u) };
    each_giving(t, e, aim_at, &look);
    t->params->probe(t->params->user, &look.probes);
    e->seen = 0;
    for (int i = 0; i < look.rays; i++)
        e->seen += (look.probes.t[i] == 1) / (float)look.rays;
}

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* What the scene's surfaces have in common: what too little light is, and how much of what they face they see, where
 * more than too little arrives. That differs much from place to place, so the rule is told several shares, each of as
 * many places. */
static noc_influence_rule rule_of(const tuning *t, int n) {
    noc_influence_rule rule = { .floor = 0 };
    float gets[EXAMPLES], seen[EXAMPLES];
    int lit = 0, bright = 0;
    memcpy(rule.seen, usual_seen, sizeof(rule.seen));
    for (int i = 0; i < n; i++)
        if (t->examples[i].gets * t->examples[i].seen > 0)
            gets[lit++] = t->examples[i].gets * t->examples[i].seen;
    if (!lit)
        return rule;
    qsort(gets, (size_t)lit, sizeof(*gets), by_size);
    rule.floor = dim * gets[lit * 9 / 10];
    for (int i = 0; i < n; i++) {
        const example *e = &t->examples[i];
        if (e->gets * e->seen > rule.floor)
            seen[bright++] = e->seen;
    }
    qsort(seen, (size_t)bright, sizeof(*seen), by_size);
    for (int k = 0; bright && k < NOC_RULE_SHARES; k++)
        rule.seen[k] = NOC_CLAMP(seen[(2 * k + 1) * bright / (2 * NOC_RULE_SHARES)], 0.05f, 0.95f);
    return rule;
}

/* The S_r at which a volume ends where its light gives as little as most examples list that face more than too little
 * light. */
static float tune(tuning *t, const noc_scene *scene) {
    noc_pool *pool = t->params->pool;
    float least[EXAMPLES];
    int count = 0;
    noc_influence_run(pool, t->run_count, bound_run, t);
    box in = box_of_lights(t);
    int wanted = (int)NOC_CLAMP(most_looks / (t->end - t->first), (size_t)FEWEST_EXAMPLES, (size_t)EXAMPLES);
    int n = take_examples(scene, &in, wanted, t->examples);
    noc_influence_run(pool, (size_t)n, look_around, t);
    t->v->rule = rule_of(t, n);
    float many = enough * sqrtf((float)t->v->count * (EVERY - 1));
    for (int i = 0; i < n; i++) {
        example *e = &t->examples[i];
        const struct core_context ctx = { &e->bins };
        float best = rule_best(&ctx, e->range, rule_of_record(&t->v->rule), (float)t->v->count, EVERY);
        if (e->gets > t->v->rule.floor && best > 0)
            least[count++] = fmaxf(best, rule_limit(&ctx, e->range, many));
    }
    qsort(least, (size_t)count, sizeof(*least), by_size);
    return count ? NOC_CLAMP(1 / sqrtf(least[(int)(unserved * (float)count)]), 1e-6f, 1e6f) : 1;
}

float noc_influence_tune(noc_influence *v, uint32_t first, uint32_t count, const noc_scene *scene,
                         const noc_influence_params *params) {
    tuning t = { .v = v, .scene = scene, .params = params, .first = first, .end = (size_t)first + count };
    t.run_count = ((size_t)count + RUN - 1) / RUN;
    t.runs = noc_alloc_large(t.run_count, sizeof(*t.runs));
    t.examples = noc_alloc_large(EXAMPLES, sizeof(*t.examples));
    float scale = t.runs && t.examples ? tune(&t, scene) : 0;
    free(t.runs);
    free(t.examples);
    return scale;
}
