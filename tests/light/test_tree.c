/* The light tree: for a point, the number of draws that a light gets is n times its pmf on average, draw's p is pmf's,
 * the pmf of all lights sum to 1, and f / pmf of many draws lies within 4 standard errors of the sum over all lights;
 * so it is with lights that move, after they were moved, and in every reader of core/. */
#include "worlds.h"

#include "backend/cpu/kernels.h"
#include "light/bound.h"

#include "core/tree.h"

FN tree_pair tree_load(CTX u32 i) {
    tree_pair p;
    memcpy(&p, &ctx->tree->pairs[i], sizeof(p));
    return p;
}

/* ---- a block of points that draws ---- */

enum { MOST = 1024, AT = 5, LANES_ASKED = 0xfff7 };

typedef struct drawer {
    const noc_scene *scene;
    noc_tree *tree;
    const kernels *kernels;
    noc_render_params params;
    frame_constants frame;
    tree_items items[2];
    pick_block picks;
    gblock g;
    surf y[BLOCK]; /* of g */
} drawer;

static void open_drawer(drawer *d, const noc_scene *s, noc_pool *pool) {
    *d = (drawer){ .scene = s,
                   .tree = noc_tree_create(s, pool, NULL),
                   .kernels = noc_pick_kernels(NOC_ISA_AUTO),
                   .params = { .width = 16 } };
    assert_non_null(d->tree);
    assert_true(d->tree->depth <= NOC_TREE_DEPTH);
    for (int i = 0; i < 2; i++) {
        d->items[i].pair = noc_alloc_large(TREE_ITEMS, sizeof(uint32_t));
        d->items[i].what = noc_alloc_large(TREE_ITEMS, sizeof(uint32_t));
        d->items[i].pmf = noc_alloc_large(TREE_ITEMS, sizeof(float));
    }
    d->picks.light = noc_alloc_large(MOST, sizeof(*d->picks.light));
    d->picks.inverse = noc_alloc_large(MOST, sizeof(*d->picks.inverse));
}

static void close_drawer(drawer *d) {
    noc_tree_destroy(d->tree);
    for (int i = 0; i < 2; i++) {
        free(d->items[i].pair);
        free(d->items[i].what);
        free(d->items[i].pmf);
    }
    free(d->picks.light);
    free(d->picks.inverse);
}

static struct core_context context(drawer *d) {
    noc_make_frame_constants(&d->params, 0, false, &d->frame);
    return (struct core_context){ .lights = d->scene->lights.data,
                                  .profiles = d->scene->profile_cells.data,
                                  .light_count = (uint32_t)d->scene->lights.len,
                                  .frame = &d->frame,
                                  .tree = d->tree };
}

/* Lane AT is the point that is asked about, the others lie about. */
static void look_from(drawer *d, surf y) {
    for (int l = 0; l < BLOCK; l++) {
        surf at = d->y[l] = l == AT ? y : random_surf(15);
        d->g.px[l] = at.p.x;
        d->g.py[l] = at.p.y;
        d->g.pz[l] = at.p.z;
        d->g.nx[l] = at.n.x;
        d->g.ny[l] = at.n.y;
        d->g.nz[l] = at.n.z;
    }
}

static void draw(drawer *d, int m) {
    d->params.seed = bits();
    struct core_context ctx = context(d);
    d->kernels->pick_tree(&ctx, &d->g, LANES_ASKED, 0, 0, m, d->items, &d->picks);
}

static double pmf(drawer *d, uint32_t id) {
    struct core_context ctx = context(d);
    uint32_t path = d->tree->paths[id];
    return path == NOC_TREE_NO_PATH ? 0 : tree_pmf(&ctx, d->y[AT].p, d->y[AT].n, d->tree->root, path, d->tree->depth);
}

/* ---- what must hold at a point ---- */

static void draws_are_pmf(drawer *d) {
    static const int sizes[] = { 1, 3, 32, MOST };
    for (int round = 0; round < 40; round++) {
        int m = sizes[round % 4];
        draw(d, m);
        for (int i = 0; i < m; i++) {
            uint32_t id = d->picks.light[i][AT];
            assert_true(id < d->scene->lights.len);
            if (!(d->picks.inverse[i][AT] > 0))
                continue;
            double x = pmf(d, id) * d->picks.inverse[i][AT];
            if (!(fabs(x - 1) < 1e-5))
                fail_msg("light %u of %zu: draw's p is 1/%g, pmf %g", id, d->scene->lights.len, d->picks.inverse[i][AT],
                         pmf(d, id));
        }
    }
}

/* Of sets of m draws, the distance of their mean estimate from the sum, in standard errors. Every lane's estimate
 * counts, as a share of what its surface gets. wrong: share that is added to the pmf of odd lights: a test of the test.
 */
static double distance(drawer *d, int rounds, int m, double wrong) {
    double want[BLOCK] = { 0 }, sum = 0, square = 0;
    int n = 0;
    for (int l = 0; l < BLOCK; l++)
        for (uint32_t i = 0; i < d->scene->lights.len && (LANES_ASKED >> l & 1); i++)
            want[l] += shine(d->scene, d->y[l], i);
    for (int r = 0; r < all_samples(rounds); r++) {
        draw(d, m);
        for (int l = 0; l < BLOCK; l++) {
            double x = 0;
            if (!(want[l] > 0))
                continue;
            for (int i = 0; i < m; i++) {
                uint32_t id = d->picks.light[i][l];
                x += shine(d->scene, d->y[l], id) * d->picks.inverse[i][l] / (1 + (id & 1 ? wrong : 0)) / m / want[l];
            }
            sum += x;
            square += x * x;
            n++;
        }
    }
    double mean = sum / NOC_MAX(n, 1), error = sqrt(fmax(square / NOC_MAX(n, 1) - mean * mean, 0) / NOC_MAX(n, 1));
    return n ? fabs(mean - 1) / fmax(error, 1e-5) : 0;
}

static void check(drawer *d) {
    size_t n = d->scene->lights.len;
    float half = 10 + 2 * sqrtf((float)n);
    for (int surface = 0; surface < 6; surface++) {
        double sum = 0;
        look_from(d, random_surf(surface < 3 ? NOC_MIN(half, 15) : half));
        draws_are_pmf(d);
        for (uint32_t i = 0; i < n; i++)
            sum += pmf(d, i);
        assert_true(fabs(sum - 1) < 1e-4);
        if (surface >= 3)
            continue;
        double z = fmax(distance(d, n > 10000 ? 1200 : 400, 32, 0), distance(d, 1500, 1, 0));
        if (!SANITIZED && !(z < 4.5))
            fail_msg("%zu lights, surface %d: %.1f standard errors from the sum over all lights", n, surface, z);
    }
}

/* pi for a light that faces every way. */
static double angle_from_axis(const noc_tree_child *node, const float n[3]) {
    double a[3] = { tree_unit(node->axis_xy), tree_unit(node->axis_xy >> 16), tree_unit(node->axis_cone) }, cross2 = 0,
           dot = 0;
    if (n[0] == 0 && n[1] == 0 && n[2] == 0)
        return M_PI;
    for (int k = 0; k < 3; k++) {
        double c = a[k] * n[(k + 1) % 3] - a[(k + 1) % 3] * n[k];
        cross2 += c * c;
        dot += a[k] * n[k];
    }
    return atan2(sqrt(cross2), dot);
}

/* A node's sphere and cone hold all lights below it, and its power is theirs; every light is at the end of its own way.
 */
static void check_bounds(const noc_scene *s, const noc_tree *t) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < s->lights.len; i++) {
        noc_light_bound b = noc_bound_light(&s->lights.data[i]);
        uint32_t path = t->paths[i], link = t->root;
        if (path == NOC_TREE_NO_PATH) {
            assert_true(s->lights.data[i].flags & NOC_LIGHT_FREE);
            continue;
        }
        found++;
        for (; !(link & TREE_LEAF); path >>= 1) {
            const noc_tree_child *n = &t->pairs[link].child[path & 1];
            double d2 = 0;
            for (int k = 0; k < 3; k++)
                d2 += (double)(b.p[k] - n->c[k]) * (b.p[k] - n->c[k]);
            assert_true(sqrt(d2) + b.radius <= n->radius * 1.000001);
            assert_true(angle_from_axis(n, b.n) <= 2 * asin((n->axis_cone >> 16) / 65535.) + 1e-6);
            assert_true(n->power >= b.intensity * 0.9999f);
            link = n->link;
        }
        assert_int_equal(link & ~TREE_LEAF, i);
        assert_int_equal(path, 0);
    }
    assert_int_equal(found, t->lights);
}

/* ---- lights that stand ---- */

static void of_all_worlds(void **state) {
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(worlds); i++) {
        noc_scene *s = world(worlds[i].lights, worlds[i].what);
        drawer d;
        open_drawer(&d, s, NULL);
        check_bounds(s, d.tree);
        check(&d);
        close_drawer(&d);
        noc_scene_destroy(s);
    }
}

/* Lights in a row whose distances double, and 1000 in one place beside them: the way down stays within its bits. */
static void of_uneven_lights(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    for (int i = 0; i < 1060; i++) {
        noc_light l = { .kind = NOC_LIGHT_POINT,
                        .position = { i < 60 ? ldexp(1e-6, i / 3) : 0, 0, 3 },
                        .emission = { 1, 1, 1 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    drawer d;
    open_drawer(&d, s, NULL);
    assert_true(d.tree->depth >= 11);
    check_bounds(s, d.tree);
    check(&d);
    close_drawer(&d);
    noc_scene_destroy(s);
}

/* The same tree whatever the number of threads, and the same draws from every instruction set. */
static void is_the_same_for_all(void **state) {
    (void)state;
    noc_scene *s = world(150000, MIXED);
    for (uint32_t i = 0; i < s->lights.len; i += 3)
        s->lights.data[i].flags |= NOC_LIGHT_MOVES;
    drawer d;
    open_drawer(&d, s, NULL);
    for (int threads = 1; threads <= 7; threads += 3) {
        noc_pool *pool = noc_pool_create(threads);
        noc_tree *t = noc_tree_create(s, pool, NULL);
        assert_int_equal(t->lights, d.tree->lights);
        assert_int_equal(t->depth, d.tree->depth);
        assert_memory_equal(t->pairs, d.tree->pairs, (t->lights - 1) * sizeof(*t->pairs));
        assert_memory_equal(t->paths, d.tree->paths, s->lights.len * sizeof(*t->paths));
        noc_tree_destroy(t);
        noc_pool_destroy(pool);
    }
    const kernels *all[NOC_MAX_KERNELS];
    int n = noc_runnable_kernels(all);
    uint32_t ids[64][BLOCK];
    float inverse[64][BLOCK];
    for (int round = 0; round < 50; round++) {
        look_from(&d, random_surf(15));
        uint32_t before = state_;
        for (int k = 0; k < n; k++) {
            state_ = before;
            d.kernels = all[k];
            draw(&d, 64);
            if (!k) {
                memcpy(ids, d.picks.light, sizeof(ids));
                memcpy(inverse, d.picks.inverse, sizeof(inverse));
            }
            assert_memory_equal(ids, d.picks.light, sizeof(ids));
            assert_memory_equal(inverse, d.picks.inverse, sizeof(inverse));
        }
    }
    close_drawer(&d);
    noc_scene_destroy(s);
}

/* The way of each draw alone leads where those that went down together came, with the same bits. */
static void one_way_is_that_of_all(void **state) {
    (void)state;
    static const uint32_t counts[] = { 1, 2, 300, 5000 };
    size_t several = 0;
    for (size_t c = 0; c < NOC_COUNT(counts); c++) {
        noc_scene *s = world(counts[c], MIXED);
        drawer d;
        open_drawer(&d, s, NULL);
        for (int round = 0; round < 20; round++) {
            uint32_t m = round & 1 ? 100 : 7;
            look_from(&d, random_surf(15));
            draw(&d, (int)m);
            struct core_context ctx = context(&d);
            for (uint32_t l = 0; l < BLOCK; l++)
                for (uint32_t i = 0; i < m && (LANES_ASKED >> l & 1); i++) {
                    u32 key = rng_key(d.params.seed, (l >> 2) * (uint32_t)d.params.width + (l & 3), 0);
                    pick p = tree_draw(&ctx, d.y[l].p, d.y[l].n, key, d.tree->root, m, i, d.tree->depth);
                    assert_int_equal(p.light, d.picks.light[i][l]);
                    assert_memory_equal(&p.inverse, &d.picks.inverse[i][l], sizeof(p.inverse));
                    several += i && p.light != d.picks.light[0][l];
                }
        }
        close_drawer(&d);
        noc_scene_destroy(s);
    }
    assert_true(several > 1000);
}

/* Draws are shared out evenly: a light of probability p gets n p of n draws give or take a few, where independent draws
 * would be off by sqrt(n p). */
static void draws_are_stratified(void **state) {
    (void)state;
    noc_scene *s = world(300, MIXED);
    drawer d;
    open_drawer(&d, s, NULL);
    double off = 0, independent = 0;
    for (int round = 0; round < 100; round++) {
        uint32_t count[300] = { 0 };
        look_from(&d, random_surf(15));
        draw(&d, MOST);
        for (int i = 0; i < MOST; i++)
            count[d.picks.light[i][AT]]++;
        for (uint32_t i = 0; i < 300; i++) {
            double p = pmf(&d, i), e = count[i] - MOST * p;
            off += e * e;
            independent += MOST * p * (1 - p);
        }
    }
    print_message("# variance of the numbers of draws: %.3f of that of independent ones\n", off / independent);
    assert_true(off < 0.2 * independent);
    close_drawer(&d);
    noc_scene_destroy(s);
}

/* A pmf that is wrong by a fifth for every other light must not pass. */
static void wrong_pmf_is_seen(void **state) {
    (void)state;
    noc_scene *s = world(50, MIXED);
    drawer d;
    open_drawer(&d, s, NULL);
    look_from(&d, random_surf(5));
    double right = distance(&d, 1500, 32, 0), wrong = distance(&d, 1500, 32, 0.2);
    print_message("# %.1f standard errors, %.1f where the pmf is wrong\n", right, wrong);
    assert_true(SANITIZED || (right < 4.5 && wrong > 6));
    close_drawer(&d);
    noc_scene_destroy(s);
}

/* ---- lights that move ---- */

static void shift(noc_scene *s, uint32_t i, float by) {
    for (int k = 0; k < 3; k++)
        s->lights.data[i].p[k] += real_in(-by, by);
}

/* Every third, all, or the only light moves: a little, for which bounds are refitted, and then far, for which the tree
 * is built anew. */
static void follows_lights(void **state) {
    (void)state;
    static const struct {
        uint32_t lights, step;
        sort what;
    } cases[] = {
        { 1, 1, MIXED },       { 2, 2, MIXED },    { 9, 1, ONE_PLACE }, { 300, 3, MIXED },
        { 300, 3, DARK_ONES }, { 2000, 1, MIXED }, { 20000, 3, MIXED },
    };
    for (size_t c = 0; c < NOC_COUNT(cases); c++) {
        noc_scene *s = world(cases[c].lights, cases[c].what);
        uint32_t moving = 0;
        for (uint32_t i = 0; i < s->lights.len; i += cases[c].step, moving++)
            s->lights.data[i].flags |= NOC_LIGHT_MOVES;
        drawer d;
        open_drawer(&d, s, NULL);
        assert_int_equal(d.tree->moving.count, moving);
        check_bounds(s, d.tree);
        for (int far = 0; far < 2; far++) {
            for (uint32_t i = 0; i < s->lights.len; i += cases[c].step)
                shift(s, i, far ? 60 : 0.5f);
            assert_int_equal(noc_tree_refit(d.tree, s, false, NULL), NOC_OK);
            check_bounds(s, d.tree);
            check(&d);
        }
        close_drawer(&d);
        noc_scene_destroy(s);
    }
}

/* Lights that change places with each other are far from where the tree has put them: it is built anew, and is as good
 * as a new one. A few steps on a street only move its bounds. */
static void is_built_anew_when_bad(void **state) {
    (void)state;
    noc_scene *s = world(3000, MIXED);
    for (uint32_t i = 0; i < 3000; i++)
        s->lights.data[i].flags |= NOC_LIGHT_MOVES;
    noc_tree *t = noc_tree_create(s, NULL, NULL);
    double built = t->built_cost;
    uint32_t *order = noc_alloc(3000 * sizeof(*order));
    memcpy(order, t->order, 3000 * sizeof(*order));
    for (uint32_t i = 0; i < 3000; i++)
        shift(s, i, 0.3f);
    assert_int_equal(noc_tree_refit(t, s, false, NULL), NOC_OK);
    assert_memory_equal(order, t->order, 3000 * sizeof(*order));
    assert_true(t->built_cost == built);
    for (uint32_t i = 0; i < 3000; i++)
        memcpy(s->lights.data[i].p, s->lights.data[i * 1103u % 3000u].p, sizeof(s->lights.data[i].p));
    assert_int_equal(noc_tree_refit(t, s, false, NULL), NOC_OK);
    assert_true(memcmp(order, t->order, 3000 * sizeof(*order)) != 0);
    noc_tree *fresh = noc_tree_create(s, NULL, NULL);
    assert_true(fabs(t->built_cost / fresh->built_cost - 1) < 0.1);
    check_bounds(s, t);
    free(order);
    noc_tree_destroy(fresh);
    noc_tree_destroy(t);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_all_worlds),          cmocka_unit_test(of_uneven_lights),
        cmocka_unit_test(is_the_same_for_all),    cmocka_unit_test(draws_are_stratified),
        cmocka_unit_test(wrong_pmf_is_seen),      cmocka_unit_test(follows_lights),
        cmocka_unit_test(is_built_anew_when_bad), cmocka_unit_test(one_way_is_that_of_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
