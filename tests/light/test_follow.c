/* A light set whose scene is edited: after each commit every picker's pmf sums to 1, bounds hold what they must, and
 * the influence volumes find what volumes that are made anew find, brighter lights, dimmed ones and new ones among
 * them. */
#include "worlds.h"

#include "backend/cpu/kernels.h"
#include "light/bound.h"
#include "light/set.h"

#include "core/alias.h"
#include "core/influence.h"
#include "core/tree.h"

FN tree_pair tree_load(CTX u32 i) {
    tree_pair p;
    memcpy(&p, &ctx->tree->pairs[i], sizeof(p));
    return p;
}

FN alias_slot alias_load(CTX u32 i) {
    alias_slot s;
    memcpy(&s, &ctx->alias->slots[i], sizeof(s));
    return s;
}

/* ---- edits ---- */

enum { LIGHTS = 400, MOVING_STEP = 5 };

static noc_light light_at(uint32_t i, bool moving, float strong) {
    noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                    .moving = moving,
                    .radius = real_in(0.05f, 0.4f),
                    .inner_deg = 20,
                    .outer_deg = 50 };
    for (int k = 0; k < 3; k++) {
        l.position[k] = k == 2 ? real_in(0.5f, 15) : real_in(-50, 50);
        l.edge_u[k] = real_in(-1, 1);
        l.edge_v[k] = real_in(-1, 1);
        l.direction[k] = real_in(-1, 1) - (k == 2 ? 1.2f : 0);
        l.emission[k] = real_in(0.1f, 1) * strong;
    }
    return l;
}

/* step 0: nothing moves. */
static noc_scene *city(uint32_t step) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 50);
    for (uint32_t i = 0; i < LIGHTS; i++) {
        noc_light l = light_at(i, step && i % step == 0, i % 3 == 1 ? 0 : 3);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static bool is(const noc_scene *s, size_t i, int half) {
    return noc_light_half(&s->lights.data[i]) == half && i < LIGHTS;
}
static bool moves(const noc_scene *s, size_t i) { return s->lights.data[i].flags & NOC_LIGHT_MOVES; }

static void move_them(noc_scene *s) {
    for (size_t i = 0; i < s->lights.len; i++)
        if (moves(s, i) && i < LIGHTS) {
            noc_light l = light_at(s->lights.data[i].kind, true, real_in(0, 1) < 0.2f ? 0 : 5);
            assert_int_equal(noc_scene_move_light(s, (int)i, &l), NOC_OK);
        }
}

static void light_all(noc_scene *s, float emission) {
    for (size_t i = 0; i < s->lights.len; i++)
        if (noc_light_half(&s->lights.data[i]) != NOC_HALVES)
            assert_int_equal(noc_scene_set_emission(s, (int)i, (float[3]){ emission, emission, emission }), NOC_OK);
}
static void switch_off(noc_scene *s) { light_all(s, 0); }
static void switch_on(noc_scene *s) { light_all(s, 20); }

/* Some go out, some that were dark shine, and some are a hundred times as bright. */
static void relight(noc_scene *s) {
    for (size_t i = 0; i < s->lights.len; i++)
        if (is(s, i, NOC_STANDING)) {
            float e = i % 4 ? (i % 7 ? 3.f : 300.f) : 0;
            assert_int_equal(noc_scene_set_emission(s, (int)i, (float[3]){ e, e, e }), NOC_OK);
        }
}

static void add_some(noc_scene *s, bool moving, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        noc_light l = light_at(i, moving, 8);
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
}
static void add_moving(noc_scene *s) { add_some(s, true, 60); }
static void add_standing(noc_scene *s) { add_some(s, false, 60); }
static void add_many(noc_scene *s) { add_some(s, false, 1100); } /* so many that they are settled */
static void add_one(noc_scene *s) { add_some(s, false, 1); }
/* Every other one of those that were added and do not move. */
static void remove_added(noc_scene *s) {
    for (size_t i = 0; i < s->lights.len; i += 2)
        if (s->lights.data[i].flags & NOC_LIGHT_LATER)
            assert_int_equal(noc_scene_remove_light(s, (int)i), NOC_OK);
}

static void remove_some(noc_scene *s, int half, size_t step) {
    for (size_t i = 0; i < s->lights.len; i += step)
        if (is(s, i, half))
            assert_int_equal(noc_scene_remove_light(s, (int)i), NOC_OK);
}
static void remove_moving(noc_scene *s) { remove_some(s, NOC_MOVING, 2); }
static void remove_standing(noc_scene *s) { remove_some(s, NOC_STANDING, 3); }
static void nothing_moves(noc_scene *s) {
    for (size_t i = 0; i < s->lights.len; i++)
        if (noc_light_half(&s->lights.data[i]) == NOC_MOVING)
            assert_int_equal(noc_scene_remove_light(s, (int)i), NOC_OK);
}
/* Both halves at once. */
static void all_at_once(noc_scene *s) {
    relight(s);
    move_them(s);
    add_moving(s);
    remove_standing(s);
}

static const struct {
    const char *name;
    void (*edit)(noc_scene *s);
} edits[] = {
    { "moved", move_them },
    { "relit", relight },
    { "moving lights added", add_moving },
    { "moving lights removed", remove_moving },
    { "moved again", move_them },
    { "switched off", switch_off },
    { "switched on", switch_on },
    { "standing lights removed", remove_standing },
    { "standing lights added", add_standing },
    { "all at once", all_at_once },
    { "one added", add_one },
    { "moved once more", move_them },
    { "another added", add_one },
    { "what was added removed", remove_added },
    { "moving lights removed, all", nothing_moves },
    { "standing lights added beside none that moves", add_standing },
    { "standing lights removed again", remove_standing },
    { "so many added that they are settled", add_many },
    { "one added to these", add_one },
    { "moving lights added again", add_moving },
    { "relit again", relight },
};

/* ---- what must hold ---- */

typedef struct asker {
    const noc_scene *scene;
    noc_render_params params;
    frame_constants frame;
    gblock g;
    noc_found found;
} asker;

static struct core_context context(asker *a, const noc_light_sources *from) {
    noc_make_frame_constants(&a->params, 0, false, &a->frame);
    return (struct core_context){ .lights = a->scene->lights.data,
                                  .profiles = a->scene->profile_cells.data,
                                  .light_count = (uint32_t)a->scene->lights.len,
                                  .frame = &a->frame,
                                  .alias = from->alias,
                                  .tree = from->tree,
                                  .influence = from->influence };
}

static float intensity(const noc_scene *s, size_t i) { return noc_light_intensity(&s->lights.data[i]); }

/* Each light is in one cluster, of its half. */
static void lists_hold(asker *a, const noc_light_sources *from) {
    const noc_light_record *lights = a->scene->lights.data;
    uint8_t *seen = noc_calloc(a->scene->lights.len, 1);
    for (int half = 0; half < NOC_HALVES; half++)
        for (size_t i = 0; i < from->clusters[half]->count; i++) {
            const noc_light_block *b = &from->clusters[half]->lights[i];
            for (int j = 0; j < NOC_CLUSTER_LIGHTS && (!j || b->id[j] != b->id[0]); j++) {
                bool gone = noc_light_half(&lights[b->id[j]]) == NOC_HALVES;
                assert_true(gone || noc_light_half(&lights[b->id[j]]) == half);
                assert_int_equal(b->shine[j] >> 16 != 0, intensity(a->scene, b->id[j]) > 0);
                seen[b->id[j]]++;
            }
        }
    for (size_t i = 0; i < a->scene->lights.len; i++)
        assert_true(noc_light_half(&lights[i]) == NOC_HALVES ? seen[i] <= 1 : seen[i] == 1);
    free(seen);
}

static void power_holds(asker *a, const noc_light_sources *from) {
    struct core_context ctx = context(a, from);
    double sum = 0, lit = 0;
    for (uint32_t i = 0; i < a->scene->lights.len; i++) {
        double p = from->alias->count ? alias_pmf(&ctx, i) : 0;
        assert_int_equal(p > 0, intensity(a->scene, i) > 0);
        sum += p;
        lit += intensity(a->scene, i);
    }
    assert_true(fabs(sum - (lit > 0)) < 1e-4);
}

/* A node's sphere holds the lights below it, its power is theirs, and each light is at the end of its own way. A slot
 * whose light is gone has none, or one to a leaf that is dark. */
static void tree_holds(asker *a, const noc_light_sources *from) {
    const noc_tree *t = from->tree;
    struct core_context ctx = context(a, from);
    uint32_t found = 0;
    double all = 0, power = 0;
    for (uint32_t i = 0; i < a->scene->lights.len; i++) {
        noc_light_bound b = noc_bound_light(&a->scene->lights.data[i]);
        uint32_t path = t->paths[i], link = t->root;
        bool gone = noc_light_half(&a->scene->lights.data[i]) == NOC_HALVES;
        assert_true(path != NOC_TREE_NO_PATH || gone);
        if (path == NOC_TREE_NO_PATH)
            continue;
        for (found++; !(link & TREE_LEAF); path >>= 1) {
            const noc_tree_child *n = &t->pairs[link].child[path & 1];
            double d2 = 0;
            for (int k = 0; k < 3; k++)
                d2 += (double)(b.p[k] - n->c[k]) * (b.p[k] - n->c[k]);
            assert_true(gone || sqrt(d2) + b.radius <= n->radius * 1.000001);
            assert_true(n->power >= b.intensity * 0.9999f);
            link = n->link;
            assert_true(!gone || !(link & TREE_LEAF) || n->power == 0);
        }
        assert_int_equal(link & ~TREE_LEAF, i);
        assert_int_equal(path, 0);
        all += b.intensity;
    }
    assert_int_equal(found, t->lights);
    if (!found)
        return;
    for (int k = 0; k < 2; k++)
        power += t->pairs[t->root].child[k].power;
    assert_true(fabs(power - all) <= 1e-4 * all);
    for (int round = 0; round < 5; round++) {
        surf y = random_surf(30);
        double sum = 0;
        for (uint32_t i = 0; i < a->scene->lights.len; i++)
            if (t->paths[i] != NOC_TREE_NO_PATH)
                sum += tree_pmf(&ctx, y.p, y.n, t->root, t->paths[i], t->depth);
        assert_true(fabs(sum - 1) < 1e-4);
    }
}

static void look_from(asker *a, surf y) {
    for (int l = 0; l < BLOCK; l++) {
        float have[6] = { y.p.x + 0.1f * (float)(l % 4), y.p.y, y.p.z, y.n.x, y.n.y, y.n.z };
        float *to[6] = { a->g.px, a->g.py, a->g.pz, a->g.nx, a->g.ny, a->g.nz };
        for (int k = 0; k < 6; k++)
            to[k][l] = have[k];
    }
}

/* A query finds what a walk over all lights finds; and where volumes are neither shared nor cut that is what volumes
 * made for the scene as it is find. */
static uint32_t influence_holds_up(asker *a, const noc_light_sources *from) {
    struct core_context ctx = context(a, from);
    const kernels *all[NOC_MAX_KERNELS];
    const noc_influence *v = from->influence;
    noc_influence *fresh = noc_influence_create(a->scene, &(noc_influence_params){ .scale = v->scale }, NULL);
    bool plain = a->params.influence_cluster <= 1 && a->params.influence_boxes == NOC_INFLUENCE_SPHERE;
    int n = noc_runnable_kernels(all);
    uint32_t total = 0;
    assert_non_null(fresh);
    assert_int_equal(v->count, a->scene->lights.len);
    for (int round = 0; round < 12; round++) {
        look_from(a, random_surf(30));
        all[round % n]->influence_find(&ctx, (const gblock *const[1]){ &a->g }, &(uint32_t){ 0xffff }, 1, &a->found);
        const noc_found_group *group = &a->found.group[a->found.of[0][3]];
        uint32_t count = 0;
        for (uint32_t i = 0; i < v->count; i++) {
            bool held = noc_influence_finds(v, i, &group->query);
            count += held;
            assert_true(!held || intensity(a->scene, i) > 0 || a->params.influence_cluster > 1);
            if (plain)
                assert_int_equal(held, noc_influence_finds(fresh, i, &group->query));
            else if (a->params.influence_boxes == NOC_INFLUENCE_SPHERE && group->query.least == 0)
                assert_true(held || !noc_influence_finds(fresh, i, &group->query)); /* shared ones hold more */
        }
        assert_int_equal(group->count, count);
        total += count;
    }
    noc_influence_destroy(fresh);
    return total;
}

/* Nothing is in the way but what is below the floor. */
static void probe(void *user, noc_probes *r) {
    (void)user;
    for (int i = 0; i < NOC_PROBES; i++)
        r->t[i] = r->o[2][i] > 0 && r->o[2][i] + r->d[2][i] < 0 ? r->o[2][i] / -r->d[2][i] : 1;
}

/* Each picker's structures, all of one set, and the set of another view that asks now and then only. */
static void follows(uint32_t step) {
    noc_scene *s = city(step);
    noc_pool *pool = noc_pool_create(2);
    noc_light_set *set = noc_light_set_create(s, pool, probe, NULL, NULL);
    noc_light_sources from[3] = { 0 };
    static asker a;
    uint32_t all = 0;
    a = (asker){ .scene = s };
    for (size_t e = 0; e <= NOC_COUNT(edits); e++) {
        uint32_t found[3] = { 0 };
        if (e) {
            edits[e - 1].edit(s);
            assert_int_equal(noc_scene_commit(s), NOC_OK);
        }
        for (int i = 0; i < 3; i++) {
            a.params = measure(64, 64, NOC_METHOD_RIS);
            a.params.uniform_every = 4;
            a.params.influence_cluster = i == 1 ? 8 : 1;
            a.params.influence_boxes = i == 2 ? NOC_INFLUENCE_VISIBLE : NOC_INFLUENCE_SPHERE;
            assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_POWER, &a.params, &from[i]), NOC_OK);
            power_holds(&a, &from[i]);
            assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_LISTS, &a.params, &from[i]), NOC_OK);
            lists_hold(&a, &from[i]);
            assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_LIGHT_BVH, &a.params, &from[i]), NOC_OK);
            tree_holds(&a, &from[i]);
            assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &a.params, &from[i]), NOC_OK);
            found[i] = influence_holds_up(&a, &from[i]);
        }
        print_message("# %s: %u, %u, %u found, S_r %.2f\n", e ? edits[e - 1].name : "made", found[0], found[1],
                      found[2], from[0].influence->scale);
        bool dark = e && edits[e - 1].edit == switch_off;
        for (int i = 0; i < 3; i++)
            assert_true(!dark || !found[i]);
        all += found[0] + found[1] + found[2];
    }
    assert_true(all > 1000);
    for (int i = 0; i < 3; i++)
        noc_light_set_release(set, &from[i]);
    noc_found_free(&a.found);
    noc_light_set_destroy(set);
    noc_pool_destroy(pool);
    noc_scene_destroy(s);
}

static void both_halves(void **state) {
    (void)state;
    follows(MOVING_STEP);
}
static void all_move(void **state) {
    (void)state;
    follows(1);
}
static void none_moves(void **state) {
    (void)state;
    follows(0);
}

/* What stands keeps its place: a commit that moves, adds or removes lights, or changes what they emit, leaves the order
 * of the static half as it is, and S_r goes on with the lights. */
static void stands_still(void **state) {
    (void)state;
    noc_scene *s = city(MOVING_STEP);
    noc_light_set *set = noc_light_set_create(s, NULL, NULL, NULL, NULL);
    noc_light_sources from = { 0 };
    noc_render_params p = measure(64, 64, NOC_METHOD_RIS);
    p.influence_cluster = 1;
    assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &p, &from), NOC_OK);
    const noc_influence *v = from.influence;
    uint32_t stand = v->stand, *ids = noc_alloc(stand * sizeof(*ids));
    float scale = v->scale, floor = v->rule.floor;
    memcpy(ids, v->ids, stand * sizeof(*ids));
    void (*const steps[])(
        noc_scene *) = { move_them, add_moving, add_standing, remove_added, relight, remove_standing };
    for (size_t i = 0; i < NOC_COUNT(steps); i++) {
        steps[i](s);
        assert_int_equal(noc_scene_commit(s), NOC_OK);
        assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &p, &from), NOC_OK);
        assert_ptr_equal(from.influence, v);
        assert_memory_equal(ids, v->ids, stand * sizeof(*ids));
        assert_int_equal(v->scale == scale, i < 4);
    }
    scale = v->scale;
    floor = v->rule.floor;
    for (size_t i = 0; i < s->lights.len; i++)
        if (noc_light_half(&s->lights.data[i]) == NOC_STANDING) {
            float e[3];
            for (int k = 0; k < 3; k++)
                e[k] = s->lights.data[i].e[k] / 4;
            assert_int_equal(noc_scene_set_emission(s, (int)i, e), NOC_OK);
        }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &p, &from), NOC_OK);
    assert_true(fabsf(v->scale / scale - 2) < 1e-3f); /* a quarter of the light: twice the metres a root candela */
    assert_true(fabsf(v->rule.floor / floor - 0.25f) < 1e-3f);
    free(ids);
    noc_light_set_release(set, &from);
    noc_light_set_destroy(set);
    noc_scene_destroy(s);
}

/* Volumes that are gone may be followed by others at the same address: who held the former has no say in the latter. */
static void holders_of_what_is_gone(void **state) {
    (void)state;
    noc_scene *s = city(0);
    noc_light_set *set = noc_light_set_create(s, NULL, NULL, NULL, NULL);
    noc_light_sources before = { 0 }, now = { 0 }, others = { 0 };
    noc_render_params p = measure(64, 64, NOC_METHOD_RIS), q = p;
    p.influence_cluster = 1;
    q.influence_cluster = 8;
    assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &p, &before), NOC_OK);
    add_standing(s);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &p, &now), NOC_OK);
    before.influence = now.influence; /* as where memory comes again */
    noc_light_set_release(set, &before);
    size_t held = noc_light_set_bytes(set, NOC_CANDIDATES_INFLUENCE);
    assert_int_equal(noc_light_set_get(set, NOC_CANDIDATES_INFLUENCE, &q, &others), NOC_OK);
    assert_int_equal(noc_light_set_bytes(set, NOC_CANDIDATES_INFLUENCE), held + others.influence->bytes);
    noc_light_set_release(set, &now);
    noc_light_set_release(set, &others);
    noc_light_set_destroy(set);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_halves),
        cmocka_unit_test(all_move),
        cmocka_unit_test(none_moves),
        cmocka_unit_test(stands_still),
        cmocka_unit_test(holders_of_what_is_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
