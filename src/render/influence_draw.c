/* The samples of a ranking. A batch goes along a sequence of its own through the region, point by point; at each it
 * draws lights by what they could bring, and sends rays by that, too. What is drawn with probability p counts 1/p, so
 * each batch is an unbiased estimate of what every emitter brings. */
#include "render/influence.h"
#include "render/influence_core.h"

#include <math.h>

enum { MOST = 512, ROOM = MOST + 2 * RANKING_LIST + 2 * RANKING_DRAWS };

#define GOLDEN 0x9e3779b97f4a7c15u /* 2^64 over the golden ratio */
/* Dimensions of random numbers; of a point's key. */
enum { DIM_RANKING_PLACE = 512 };

/* What a ray is to bring where nothing is in its way. */
typedef struct ask {
    uint32_t emitter; /* NOC_NO_EMITTER: the sky */
    float lux, luminance;
    noc_class cls; /* of the surface that asks */
} ask;

/* A place of the region. */
typedef struct place {
    surf y;
    noc_class cls;
    float counts; /* how much of a sample it is: ranking.counts of its class */
} place;

typedef struct drawing {
    noc_ranking *r;
    const noc_asking *by;
    ranking_batch *b;
    struct core_context core;
    uint32_t seed; /* the batch's */
    size_t count;
    noc_sight sights[ROOM];
    ask asks[ROOM];
} drawing;

/* ---- rays ---- */

static void flush(drawing *d) {
    float clear[ROOM];
    ranking_batch *b = d->b;
    if (d->count)
        d->r->view->backend->clear(d->r->view->state, d->sights, d->count, clear);
    b->rays += d->count;
    for (size_t i = 0; i < d->count; i++) {
        const ask *a = &d->asks[i];
        double lux = a->lux * clear[i];
        if (!(clear[i] > 0))
            continue;
        int part = a->emitter == NOC_NO_EMITTER ? RANKING_SKY : (int)d->r->emitters.all.data[a->emitter].kind;
        b->lux[part][a->cls] += lux;
        b->luminance[part == NOC_EMITTER_WINDOW] += a->luminance * clear[i];
        if (part != RANKING_SKY && !noc_sums_add(&b->sums, a->emitter, lux))
            b->refused = true;
    }
    d->count = 0;
}

static void push(drawing *d, segment s, uint32_t towards, ask a) {
    d->sights[d->count] = (noc_sight){ { s.o.x, s.o.y, s.o.z }, { s.d.x, s.d.y, s.d.z }, towards };
    d->asks[d->count++] = a;
}

/* ---- what a light brings ---- */

/* weight: 1 over the probability, or number, of such samples. */
static void look_at(drawing *d, const place *at, uint32_t light_index, float u, float v, float weight) {
    const struct core_context *ctx = &d->core;
    surf y = at->y;
    light l = light_load(ctx, light_index);
    light_sample s = shining_sample(ctx, l, y.p, u, v);
    weight *= at->counts;
    ask a = { d->r->emitters.of[light_index], light_lux(s, y.n) * weight, 0, at->cls };
    if (!(a.lux > 0))
        return;
    if (d->r->seen && dot3(y.n, y.wo) > 0)
        a.luminance = luminance(reflected(y, s)) * weight;
    push(d, shadow_segment(y.p, y.n, l, u, v, d->by->ray_offset), light_index, a);
}

/* A white surface shows over pi what lights it. The sky's rays are drawn for that one, whatever y is made of. */
static void look_up(drawing *d, const place *at, uint32_t key, uint32_t number, float share) {
    const struct core_context *ctx = &d->core;
    surf y = at->y;
    bool map = d->core.frame->flags & FRAME_MAP_LIGHTS;
    if (!map && !(d->core.frame->sky > 0))
        return;
    surf white = y;
    white.albedo = fill3(1);
    white.f0 = 0;
    white.alpha = 1;
    segment way = sky_ray(ctx, white, key, number, d->by->ray_offset);
    v3 c = sky_shade(ctx, white, way.d, share * at->counts);
    ask a = { NOC_NO_EMITTER, luminance(c) * CORE_PI, 0, at->cls };
    if (!(a.lux > 0 && a.lux < 1e30f))
        return;
    v3 wi = mul3(way.d, SKY_REACH_BACK);
    if (d->r->seen && dot3(y.n, y.wo) > 0)
        a.luminance = luminance(tint3(reflect(y, wi), mul3(c, CORE_PI / fmaxf(dot3(y.n, wi), 1e-6f))));
    push(d, way, UINT32_MAX, a);
}

/* ---- places ---- */

/* A place in a triangle for a number in [0, 1): its digits to base 4 choose quarters of quarters, so that numbers that
 * lie evenly make places that do (Basu and Owen 2015, "Low discrepancy constructions in the triangle"). */
static void place_in(double t, double at[2]) {
    double a[2] = { 0, 0 }, b[2] = { 1, 0 }, c[2] = { 0, 1 };
    for (int level = 0; level < 20; level++) {
        t *= 4;
        int digit = NOC_MIN((int)t, 3);
        t -= digit;
        for (int k = 0; k < 2; k++) {
            double ab = (a[k] + b[k]) / 2, bc = (b[k] + c[k]) / 2, ca = (c[k] + a[k]) / 2;
            a[k] = digit == 0 ? bc : digit == 1 ? a[k] : digit == 2 ? ab : ca;
            b[k] = digit == 0 ? ca : digit == 1 ? ab : digit == 2 ? b[k] : bc;
            c[k] = digit == 0 ? ab : digit == 1 ? ca : digit == 2 ? bc : c[k];
        }
    }
    at[0] = (a[0] + b[0] + c[0]) / 3;
    at[1] = (a[1] + b[1] + c[1]) / 3;
}

/* The albedo as the renderer has it: the material's, and its texture's. */
static v3 albedo_at(const struct core_context *ctx, const noc_scene *scene, const noc_patch *patch,
                    const double at[2]) {
    v3 albedo = splat3(scene->material_records.data[patch->material].albedo);
    int texture = scene->materials.data[patch->material].texture;
    if (!patch->textured || !texture)
        return albedo;
    float uv[2];
    for (int k = 0; k < 2; k++)
        uv[k] = (float)(patch->image[k] + at[0] * patch->image_u[k] + at[1] * patch->image_v[k]);
    uint32_t first = scene->textures.data[texture - 1].place;
    return tint3(texture_albedo(ctx, first, uv[0], uv[1], patch->level), albedo);
}

/* The surface at share t of all samples, 0..1. */
static place place_at(const drawing *d, double t) {
    const noc_ranking *r = d->r;
    size_t lo = 0, hi = r->region->patches.len;
    double sample = t * r->before[hi], at[2];
    while (hi - lo > 1) {
        size_t mid = (lo + hi) / 2;
        *(r->before[mid] <= sample ? &lo : &hi) = mid;
    }
    const noc_patch *patch = &r->region->patches.data[lo];
    double part = (sample - r->before[lo]) / (r->before[lo + 1] - r->before[lo]);
    float p[3];
    place_in(NOC_CLAMP(part, 0, 1 - 0x1p-52), at);
    for (int k = 0; k < 3; k++)
        p[k] = (float)(patch->p[k] + at[0] * patch->u[k] + at[1] * patch->v[k]);
    surf s = { .p = splat3(p), .n = splat3(patch->n), .wo = splat3(patch->n) };
    const noc_scene *scene = r->view->scene;
    if (r->seen && patch->material < scene->material_records.len) {
        const noc_material_record *m = &scene->material_records.data[patch->material];
        v3 w = sub3(splat3(r->eye), s.p);
        s.wo = mul3(w, 1 / sqrtf(fmaxf(dot3(w, w), 1e-20f)));
        s.albedo = albedo_at(&d->core, scene, patch, at);
        s.f0 = m->f0;
        s.alpha = m->alpha;
    }
    noc_class cls = noc_patch_class(patch, scene);
    return (place){ s, cls, (float)r->counts[cls] };
}

/* ---- a point of a region ---- */

typedef struct candidate {
    uint32_t light;
    float weight; /* 1 over the draws of it that are expected, times those there were */
    float u, v, lux;
} candidate;

/* All draws of the point go down the tree together (core/tree.h). */
static size_t draw_candidates(const drawing *d, surf y, uint32_t key, candidate *out) {
    struct {
        uint32_t link, count;
        float pmf;
    } way[NOC_TREE_DEPTH + 2];
    const struct core_context *ctx = &d->core;
    size_t n = 0;
    int left = 0;
    way[left].link = d->by->tree->root;
    way[left].count = RANKING_DRAWS;
    way[left++].pmf = 1;
    while (left) {
        left--;
        uint32_t link = way[left].link, count = way[left].count;
        float pmf = way[left].pmf;
        if (link & TREE_LEAF) {
            out[n++] = (candidate){ .light = link & ~TREE_LEAF, .weight = (float)count / (pmf * RANKING_DRAWS) };
            continue;
        }
        tree_step s = tree_go(ctx, y.p, y.n, key, link, count, pmf);
        if (s.to_a) {
            way[left].link = s.link_a;
            way[left].count = s.to_a;
            way[left++].pmf = s.pmf_a;
        }
        if (count > s.to_a) {
            way[left].link = s.link_b;
            way[left].count = count - s.to_a;
            way[left++].pmf = s.pmf_b;
        }
    }
    return n;
}

static size_t all_candidates(const drawing *d, candidate *out) {
    const noc_scene *scene = d->r->view->scene;
    size_t n = 0;
    for (uint32_t i = 0; i < scene->lights.len; i++)
        if (!(scene->lights.data[i].flags & NOC_LIGHT_FREE))
            out[n++] = (candidate){ .light = i, .weight = 1 };
    return n;
}

/* Sends about RANKING_RAYS rays: to whatever is sure of one, and to the others by systematic sampling. */
static void look_around(drawing *d, const place *at, uint32_t key) {
    const struct core_context *ctx = &d->core;
    surf y = at->y;
    candidate c[RANKING_DRAWS];
    bool few = d->r->view->scene->lights.len <= RANKING_DRAWS;
    size_t n = few ? all_candidates(d, c) : d->by->tree->lights ? draw_candidates(d, y, key, c) : 0;
    double all = 0, sum = rng(key, DIM_RAYS);
    for (size_t i = 0; i < n; i++) {
        uint32_t bits = rng_bits(key, DIM_RANKING_PLACE + (uint32_t)i);
        c[i].u = unit_low(bits);
        c[i].v = unit_high(bits);
        c[i].lux = light_lux(shining_sample(ctx, light_load(ctx, c[i].light), y.p, c[i].u, c[i].v), y.n);
        all += c[i].lux * c[i].weight;
    }
    for (size_t i = 0; i < n && all > 0; i++) {
        double expected = RANKING_RAYS * ((double)c[i].lux * c[i].weight / all), before = sum;
        if (!(expected > 0))
            continue;
        if (expected < 1) {
            sum += expected;
            if (floor(sum) == floor(before))
                continue;
        }
        look_at(d, at, c[i].light, c[i].u, c[i].v, (float)(c[i].weight / NOC_MIN(expected, 1)));
    }
    if (d->count >= MOST)
        flush(d);
}

static void draw_region(drawing *d) {
    noc_ranking *r = d->r;
    uint64_t shift = (uint64_t)hash_u32(d->seed) << 32 | hash_u32(d->seed + 0x51ed270bu);
    for (uint64_t i = r->rounds * RANKING_POINTS; i < (r->rounds + 1) * RANKING_POINTS; i++) {
        double t = (double)((shift + i * GOLDEN) >> 11) * 0x1p-53;
        place at = place_at(d, t);
        uint32_t key = rng_key(d->seed, (uint32_t)i, (uint32_t)(i >> 32));
        look_around(d, &at, key);
        look_up(d, &at, key, 0, 1);
        d->b->points[at.cls] += at.counts;
    }
    flush(d);
}

/* ---- a single point ---- */

/* Place `number` of a light's own sequence, whose start is random (Roberts 2018: R2). */
static void turn_place(uint32_t start, uint32_t number, float *u, float *v) {
    *u = unit_low((hash_u32(start) + number * 0xc13fa9a9u) >> 16);
    *v = unit_low((hash_u32(start + 0x68bc21ebu) + number * 0x91e10da5u) >> 16);
}

static void draw_point(drawing *d) {
    noc_ranking *r = d->r;
    const ranking_list *list = &r->list;
    place at = place_at(d, 0.5);
    uint32_t round = (uint32_t)r->rounds, key = rng_key(d->seed, 0, round);
    float u, v;
    for (size_t i = 0; i < list->certain; i++) {
        uint32_t turns = (uint32_t)list->turns.data[i], start = rng_bits(d->seed, DIM_RANKING_PLACE + (uint32_t)i);
        for (uint32_t k = 0; k < turns; k++) {
            turn_place(start, round * turns + k, &u, &v);
            look_at(d, &at, list->lights.data[i].light, u, v, 1 / (float)turns);
        }
    }
    size_t rest = list->lights.len - list->certain, next = 0;
    double all = rest ? list->before.data[rest] : 0, xi = rng(key, DIM_RAYS);
    for (int k = 0; k < list->draws && rest; k++) {
        double t = (k + xi) / list->draws * all;
        while (next + 1 < rest && list->before.data[next + 1] <= t)
            next++;
        const ranking_light *l = &list->lights.data[list->certain + next];
        uint32_t bits = rng_bits(key, DIM_RANKING_PLACE + (uint32_t)k);
        double probability = (list->before.data[next + 1] - list->before.data[next]) / all;
        look_at(d, &at, l->light, unit_low(bits), unit_high(bits), (float)(1 / (probability * list->draws)));
    }
    enum { UP = 8 };
    for (uint32_t k = 0; k < UP; k++)
        look_up(d, &at, rng_key(d->seed, 1, 0), round * UP + k, 1.0f / UP);
    d->b->points[at.cls] += at.counts;
    flush(d);
}

void noc_ranking_draw(noc_ranking *r, const noc_asking *by, int batch) {
    const noc_scene *scene = r->view->scene;
    drawing d = { .r = r,
                  .by = by,
                  .b = &r->batch[batch],
                  .core = { .frame = &r->frame,
                            .lights = scene->lights.data,
                            .profiles = scene->profile_cells.data,
                            .tree = by->tree,
                            .environment = scene->environment,
                            .map_light = by->map_light,
                            .texels = scene->texels.data },
                  .seed = hash_u32(r->params.seed + hash_u32((uint32_t)batch + 0x2545f491u)) };
    if (r->point)
        draw_point(&d);
    else
        draw_region(&d);
}
