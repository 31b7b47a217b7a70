#include "light/tree_build.h"

#include "core/tree_node.h"

#include <math.h>

enum { BINS = 12, LARGE = 2 * NOC_TREE_CHUNK };

/* ---- chunks ---- */

struct chunk_run {
    uint32_t first, end;
    tree_chunk_fn *fn;
    void *ctx;
};

static void run_chunk(void *arg, size_t chunk, int worker) {
    const struct chunk_run *r = arg;
    uint32_t first = r->first + (uint32_t)chunk * NOC_TREE_CHUNK;
    (void)worker;
    r->fn(r->ctx, chunk, first, NOC_MIN(r->end, first + NOC_TREE_CHUNK));
}

static uint32_t chunk_count(uint32_t n) { return (n + NOC_TREE_CHUNK - 1) / NOC_TREE_CHUNK; }

void noc_tree_chunks(noc_pool *pool, uint32_t first, uint32_t end, tree_chunk_fn *fn, void *ctx) {
    struct chunk_run r = { first, end, fn, ctx };
    size_t n = chunk_count(end - first);
    if (pool && n > 1)
        noc_pool_run(pool, n, run_chunk, &r);
    else
        for (size_t i = 0; i < n; i++)
            run_chunk(&r, i, 0);
}

/* ---- what the heuristic goes by ---- */

/* A box, the sum of the ways the lights face (as if of length 1), the sum of their intensities. Fours, for the
 * compiler. */
typedef struct heap {
    float lo[4], hi[4];
    float sum[4];
    uint32_t count;
} heap;

static const heap empty_heap = {
    { INFINITY, INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY, -INFINITY }, { 0 }, 0
};

static inline void heap_add(heap *h, const tree_light *l) {
    for (int k = 0; k < 4; k++) {
        float below = l->p[k] - l->p[3], above = l->p[k] + l->p[3];
        h->lo[k] = NOC_MIN(h->lo[k], below);
        h->hi[k] = NOC_MAX(h->hi[k], above);
        h->sum[k] += l->n[k];
    }
    h->count++;
}

static inline void heap_join(heap *h, const heap *a) {
    for (int k = 0; k < 4; k++) {
        h->lo[k] = NOC_MIN(h->lo[k], a->lo[k]);
        h->hi[k] = NOC_MAX(h->hi[k], a->hi[k]);
        h->sum[k] += a->sum[k];
    }
    h->count += a->count;
}

static float facing_length(const heap *h) {
    return sqrtf(h->sum[0] * h->sum[0] + h->sum[1] * h->sum[1] + h->sum[2] * h->sum[2]);
}

static float longest_side(const heap *h) {
    float size = 0;
    for (int k = 0; k < 3; k++)
        size = NOC_MAX(size, h->hi[k] - h->lo[k]);
    return size;
}

/* Power times surface area times spread of directions. The spread is judged by the length of the mean direction: 1
 * where all agree, 0 where they cancel out or face every way. Areas are kept from vanishing where lights lie on a line.
 */
static float heap_cost(const heap *h, float least) {
    float d[3];
    for (int k = 0; k < 3; k++)
        d[k] = h->hi[k] - h->lo[k] + least;
    float area = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    return h->sum[3] * area * (2 - facing_length(h) / (float)h->count);
}

static heap heap_of(const tree_light *l, uint32_t first, uint32_t end) {
    heap h = empty_heap;
    for (uint32_t i = first; i < end; i++)
        heap_add(&h, &l[i]);
    return h;
}

/* ---- bounds ---- */

typedef struct bound {
    float c[3], axis[3];
    float radius, chord2; /* longest square distance of a direction from the axis; 4: some light faces every way */
} bound;

static void widen(bound *b, const tree_light *l, uint32_t first, uint32_t end) {
    for (const tree_light *i = l + first; i < l + end; i++) {
        float d2 = 0, chord2 = 0;
        for (int k = 0; k < 3; k++) {
            float d = i->p[k] - b->c[k], a = i->n[k] - b->axis[k];
            d2 += d * d;
            chord2 += a * a;
        }
        float room = b->radius - i->p[3];
        if (!(room >= 0 && d2 <= room * room))
            b->radius = NOC_MAX(b->radius, sqrtf(d2) + i->p[3]);
        bool any = i->n[0] == 0 && i->n[1] == 0 && i->n[2] == 0;
        b->chord2 = any ? 4 : NOC_MAX(b->chord2, chord2);
    }
}

/* Of each chunk of a node. */
struct tree_scratch {
    bound *bounds;
    struct split *parts;
    struct bins *filled;
    uint32_t *left; /* twice as many */
};

struct widen_run {
    const tree_light *lights;
    const bound *start;
    bound *out;
};

static void widen_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct widen_run *r = ctx;
    r->out[chunk] = *r->start;
    widen(&r->out[chunk], r->lights, first, end);
}

static uint32_t quantise(float x) { return (uint32_t)(lrintf(NOC_CLAMP(x, -1, 1) * 32767) + 32767); }

/* Sphere around the box's middle, cone around the mean direction, outwards of their rounding. The cone is the half
 * chord of its half angle, which keeps narrow cones narrow. */
static noc_tree_child bound_lights(const tree_build *build, uint32_t first, uint32_t end, const heap *all) {
    bound b = { .radius = 0 };
    uint32_t axis[3];
    float length = facing_length(all);
    bool some = length > 1e-3f * (float)all->count;
    for (int k = 0; k < 3; k++) {
        b.c[k] = 0.5f * (all->lo[k] + all->hi[k]);
        axis[k] = quantise(some ? all->sum[k] / length : 0);
        b.axis[k] = tree_unit(axis[k]);
    }
    if (end - first > LARGE) {
        bound start = b, *parts = build->scratch->bounds;
        struct widen_run run = { build->lights, &start, parts };
        noc_tree_chunks(build->pool, first, end, widen_chunk, &run);
        for (uint32_t i = 0; i < chunk_count(end - first); i++) {
            b.radius = NOC_MAX(b.radius, parts[i].radius);
            b.chord2 = NOC_MAX(b.chord2, parts[i].chord2);
        }
    } else {
        widen(&b, build->lights, first, end);
    }
    float cone = 0.5f * sqrtf(b.chord2) + 4e-5f;
    if (!some || cone >= 0.999f) {
        axis[0] = axis[1] = axis[2] = quantise(0);
        cone = 1;
    }
    noc_tree_child c = { .radius = b.radius * 1.0001f, .power = all->sum[3] };
    memcpy(c.c, b.c, sizeof(c.c));
    c.axis_xy = axis[0] | axis[1] << 16;
    c.axis_cone = axis[2] | (uint32_t)ceilf(NOC_MIN(cone, 1) * 65535) << 16;
    return c;
}

/* ---- splits ---- */

typedef struct bins {
    heap bin[3][BINS];
} bins;

typedef struct split {
    float lo[4], hi[4], scale[4]; /* of the centres; 0: an axis without extent */
    int bins, axis, edge;
} split;

static inline int bin_of(const split *s, const tree_light *l, int axis) {
    return NOC_CLAMP((int)((l->p[axis] - s->lo[axis]) * s->scale[axis]), 0, s->bins - 1);
}

static void centres(split *s, const tree_light *l, uint32_t first, uint32_t end) {
    for (int k = 0; k < 4; k++) {
        s->lo[k] = INFINITY;
        s->hi[k] = -INFINITY;
    }
    for (uint32_t i = first; i < end; i++)
        for (int k = 0; k < 4; k++) {
            s->lo[k] = NOC_MIN(s->lo[k], l[i].p[k]);
            s->hi[k] = NOC_MAX(s->hi[k], l[i].p[k]);
        }
}

static void fill_bins(const split *s, const tree_light *l, uint32_t first, uint32_t end, bins *b) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < s->bins; i++)
            b->bin[k][i] = empty_heap;
    for (uint32_t i = first; i < end; i++)
        for (int k = 0; k < 3; k++)
            heap_add(&b->bin[k][bin_of(s, &l[i], k)], &l[i]);
}

struct split_run {
    const tree_build *build;
    const split *s;
    split *parts;
    bins *filled;
    uint32_t *left, *right; /* of each chunk: lights on either side, then where they go */
};

static void centres_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct split_run *r = ctx;
    centres(&r->parts[chunk], r->build->lights, first, end);
}

static void bins_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct split_run *r = ctx;
    fill_bins(r->s, r->build->lights, first, end, &r->filled[chunk]);
}

/* Cheapest of the splits between bins on all three axes; s->axis is -1 where all lights lie in one place. */
static void choose_split(split *s, const bins *b, const heap *all) {
    float size = longest_side(all), least = 0.01f * size, best = INFINITY;
    s->axis = -1;
    for (int k = 0; k < 3; k++) {
        if (!(s->scale[k] > 0))
            continue;
        heap sum = empty_heap;
        float above[BINS] = { 0 }, longer = size / (s->hi[k] - s->lo[k]); /* against thin slabs */
        for (int i = s->bins - 1; i > 0; i--) {
            heap_join(&sum, &b->bin[k][i]);
            above[i] = sum.count ? heap_cost(&sum, least) : INFINITY;
        }
        sum = empty_heap;
        for (int i = 0; i < s->bins - 1; i++) {
            heap_join(&sum, &b->bin[k][i]);
            float cost = sum.count ? (heap_cost(&sum, least) + above[i + 1]) * longer : INFINITY;
            if (cost < best) {
                best = cost;
                s->axis = k;
                s->edge = i;
            }
        }
    }
}

static void set_scales(split *s, uint32_t lights) {
    s->bins = lights < 16 ? 4 : BINS;
    for (int k = 0; k < 3; k++) {
        s->scale[k] = s->hi[k] > s->lo[k] ? (float)s->bins / (s->hi[k] - s->lo[k]) : 0;
        if (!(s->scale[k] < 1e30f))
            s->scale[k] = 0;
    }
}

static void split_sides(const split *s, const bins *b, heap side[2]) {
    side[0] = side[1] = empty_heap;
    for (int i = 0; i < s->bins; i++)
        heap_join(&side[i > s->edge], &b->bin[s->axis][i]);
}

/* Lights [first, end) in two; returns how many are on the first side, 0 where all lie in one place. */
static uint32_t split_small(tree_build *b, uint32_t first, uint32_t end, const heap *all, heap side[2]) {
    split s;
    bins filled;
    tree_light *l = b->lights;
    centres(&s, l, first, end);
    set_scales(&s, end - first);
    fill_bins(&s, l, first, end, &filled);
    choose_split(&s, &filled, all);
    if (s.axis < 0)
        return 0;
    split_sides(&s, &filled, side);
    uint32_t i = first, j = end;
    while (i < j) {
        if (bin_of(&s, &l[i], s.axis) <= s.edge) {
            i++;
            continue;
        }
        j--;
        tree_light light = l[i];
        uint32_t id = b->ids[i];
        l[i] = l[j];
        b->ids[i] = b->ids[j];
        l[j] = light;
        b->ids[j] = id;
    }
    return i - first;
}

static void count_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct split_run *r = ctx;
    uint32_t left = 0;
    for (uint32_t i = first; i < end; i++)
        left += bin_of(r->s, &r->build->lights[i], r->s->axis) <= r->s->edge;
    r->left[chunk] = left;
    r->right[chunk] = end - first - left;
}

static void spread_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct split_run *r = ctx;
    const tree_build *b = r->build;
    uint32_t left = r->left[chunk], right = r->right[chunk];
    for (uint32_t i = first; i < end; i++) {
        uint32_t to = bin_of(r->s, &b->lights[i], r->s->axis) <= r->s->edge ? left++ : right++;
        b->spare[to] = b->lights[i];
        b->spare_ids[to] = b->ids[i];
    }
}

static void return_chunk(void *ctx, size_t chunk, uint32_t first, uint32_t end) {
    struct split_run *r = ctx;
    (void)chunk;
    memcpy(r->build->lights + first, r->build->spare + first, (end - first) * sizeof(tree_light));
    memcpy(r->build->ids + first, r->build->spare_ids + first, (end - first) * sizeof(uint32_t));
}

/* The same for many lights, by all threads. */
static uint32_t split_large(tree_build *b, uint32_t first, uint32_t end, const heap *all, heap side[2]) {
    uint32_t chunks = chunk_count(end - first), left = 0;
    struct split_run r = { .build = b };
    r.parts = b->scratch->parts;
    r.filled = b->scratch->filled;
    r.left = b->scratch->left;
    r.right = r.left + chunks;
    noc_tree_chunks(b->pool, first, end, centres_chunk, &r);
    split s = r.parts[0];
    for (uint32_t i = 1; i < chunks; i++)
        for (int k = 0; k < 3; k++) {
            s.lo[k] = NOC_MIN(s.lo[k], r.parts[i].lo[k]);
            s.hi[k] = NOC_MAX(s.hi[k], r.parts[i].hi[k]);
        }
    set_scales(&s, end - first);
    r.s = &s;
    noc_tree_chunks(b->pool, first, end, bins_chunk, &r);
    for (uint32_t i = 1; i < chunks; i++)
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < s.bins; j++)
                heap_join(&r.filled[0].bin[k][j], &r.filled[i].bin[k][j]);
    choose_split(&s, &r.filled[0], all);
    if (s.axis >= 0) {
        split_sides(&s, &r.filled[0], side);
        left = side[0].count;
        noc_tree_chunks(b->pool, first, end, count_chunk, &r);
        for (uint32_t i = 0, at = first, beside = first + left; i < chunks; i++) {
            uint32_t here = r.left[i], there = r.right[i];
            r.left[i] = at;
            r.right[i] = beside;
            at += here;
            beside += there;
        }
        noc_tree_chunks(b->pool, first, end, spread_chunk, &r);
        noc_tree_chunks(b->pool, first, end, return_chunk, &r);
    }
    return left;
}

bool noc_tree_make_scratch(tree_build *b, size_t lights) {
    size_t chunks = chunk_count((uint32_t)lights);
    if (lights <= LARGE)
        return true;
    struct tree_scratch *s = b->scratch = noc_calloc(1, sizeof(*s));
    return s && (s->bounds = noc_alloc_large(chunks, sizeof(*s->bounds))) &&
           (s->parts = noc_alloc_large(chunks, sizeof(*s->parts))) &&
           (s->filled = noc_alloc_large(chunks, sizeof(*s->filled))) &&
           (s->left = noc_alloc_large(2 * chunks, sizeof(*s->left)));
}

void noc_tree_free_scratch(tree_build *b) {
    if (!b->scratch)
        return;
    free(b->scratch->bounds);
    free(b->scratch->parts);
    free(b->scratch->filled);
    free(b->scratch->left);
    free(b->scratch);
    b->scratch = NULL;
}

/* ---- the tree ---- */

noc_tree_child noc_tree_bound_lights(const tree_build *b, uint32_t first, uint32_t end) {
    heap all = heap_of(b->lights, first, end);
    return bound_lights(b, first, end, &all);
}

/* A node of more than one light that is to be split. */
typedef struct task {
    noc_tree_part part;
    heap all;
} task;

static int bits_for(uint32_t lights) { return lights > 1 ? 32 - __builtin_clz(lights - 1) : 0; }

/* Splits a node, evenly where the way down would get too long else, and writes its pair. Returns how many of its
 * children are to be split in turn; *deepest: the longest way to a leaf seen. */
static int split_task(tree_build *b, const task *t, task next[2], int *deepest) {
    const noc_tree_part *p = &t->part;
    uint32_t n = p->count, end = p->first + n, left = 0;
    heap side[2];
    if (n > 2 && p->depth + 1 + bits_for(n - 1) <= NOC_TREE_DEPTH)
        left = (n > LARGE ? split_large : split_small)(b, p->first, end, &t->all, side);
    if (!left || left == n) {
        left = n / 2;
        side[0] = heap_of(b->lights, p->first, p->first + left);
        side[1] = heap_of(b->lights, p->first + left, end);
    }
    noc_tree_pair *pair = &b->tree->pairs[p->base];
    int more = 0;
    for (uint32_t k = 0; k < 2; k++) {
        noc_tree_part c = { .first = k ? p->first + left : p->first,
                            .count = k ? n - left : left,
                            .base = p->base + (k ? left : 1),
                            .path = p->path | k << p->depth,
                            .depth = p->depth + 1 };
        pair->child[k] = bound_lights(b, c.first, c.first + c.count, &side[k]);
        pair->child[k].link = c.base;
        if (c.count > 1) {
            next[more++] = (task){ c, side[k] };
            continue;
        }
        pair->child[k].link = b->ids[c.first] | TREE_LEAF;
        b->tree->paths[b->ids[c.first]] = c.path;
        *deepest = NOC_MAX(*deepest, c.depth);
    }
    return more;
}

/* All that is below a node, by one thread. Returns the longest way. */
static int grow_below(tree_build *b, const task *t) {
    task stack[NOC_TREE_DEPTH + 2], next[2];
    int waiting = 0, deepest = 0;
    for (stack[waiting++] = *t; waiting;) {
        task now = stack[--waiting];
        for (int more = split_task(b, &now, next, &deepest); more--;)
            stack[waiting++] = next[more];
    }
    return deepest;
}

struct grow_run {
    tree_build *build;
    NOC_ARRAY(task) tasks;
    int *deepest;
};

static void grow_task(void *ctx, size_t i, int worker) {
    struct grow_run *r = ctx;
    (void)worker;
    r->deepest[i] = grow_below(r->build, &r->tasks.data[i]);
}

/* Large nodes one after the other, each by all threads; then the rest, a thread each. */
noc_tree_child noc_tree_grow(tree_build *b, const noc_tree_part *part) {
    heap all = heap_of(b->lights, part->first, part->first + part->count);
    noc_tree_child root = bound_lights(b, part->first, part->first + part->count, &all);
    if (part->count == 1) {
        root.link = b->ids[part->first] | TREE_LEAF;
        b->tree->paths[b->ids[part->first]] = part->path;
        b->tree->depth = NOC_MAX(b->tree->depth, part->depth);
        return root;
    }
    root.link = part->base;
    struct grow_run r = { .build = b };
    NOC_ARRAY(task) large = { 0 };
    bool ok = array_push(&large, (task){ *part, all });
    while (ok && large.len) {
        task now = large.data[--large.len], next[2];
        if (now.part.count <= LARGE) {
            ok = array_push(&r.tasks, now);
            continue;
        }
        for (int more = split_task(b, &now, next, &b->tree->depth); ok && more--;)
            ok = array_push(&large, next[more]);
    }
    r.deepest = ok ? noc_calloc(r.tasks.len, sizeof(*r.deepest)) : NULL;
    b->no_memory = b->no_memory || !r.deepest;
    if (b->no_memory)
        r.tasks.len = 0;
    if (b->pool && r.tasks.len > 1)
        noc_pool_run(b->pool, r.tasks.len, grow_task, &r);
    else
        for (size_t i = 0; i < r.tasks.len; i++)
            grow_task(&r, i, 0);
    for (size_t i = 0; i < r.tasks.len; i++)
        b->tree->depth = NOC_MAX(b->tree->depth, r.deepest[i]);
    free(r.deepest);
    array_free(&r.tasks);
    array_free(&large);
    return root;
}

noc_tree_child noc_tree_bound(tree_build *b, const noc_tree_part *part, double *cost) {
    struct {
        uint32_t first, count, base;
    } stack[NOC_TREE_DEPTH + 2];
    heap all = heap_of(b->lights, part->first, part->first + part->count);
    noc_tree_child root = bound_lights(b, part->first, part->first + part->count, &all);
    double whole = heap_cost(&all, 0.01f * longest_side(&all)), sum = 0;
    int waiting = 0;
    root.link = part->count > 1 ? part->base : b->ids[part->first] | TREE_LEAF;
    if (part->count > 1) {
        stack[waiting].first = part->first;
        stack[waiting].count = part->count;
        stack[waiting++].base = part->base;
    }
    while (waiting) {
        uint32_t first = stack[--waiting].first, n = stack[waiting].count, base = stack[waiting].base;
        noc_tree_pair *pair = &b->tree->pairs[base];
        uint32_t second = pair->child[1].link, left = second & TREE_LEAF ? n - 1 : second - base;
        heap side[2] = { heap_of(b->lights, first, first + left), heap_of(b->lights, first + left, first + n) };
        heap both = side[0];
        heap_join(&both, &side[1]);
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t link = pair->child[k].link, from = k ? first + left : first, count = k ? n - left : left;
            sum += heap_cost(&side[k], 0.01f * longest_side(&both));
            pair->child[k] = bound_lights(b, from, from + count, &side[k]);
            pair->child[k].link = link;
            if (count > 1) {
                stack[waiting].first = from;
                stack[waiting].count = count;
                stack[waiting++].base = link;
            }
        }
    }
    *cost = whole > 0 ? sum / whole : 0;
    return root;
}
