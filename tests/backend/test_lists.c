/* Building a tile's light list: over all places that the tail can start from, every light that can reach a surface of
 * the tile has a weight of 1 on average, whatever the scores were; few lights are all listed; and all kernel tables
 * build the same. */
#include "../render/rooms.h"

#include "backend/cpu/kernels.h"
#include "core/random.h"
#include "light/bound.h"

enum { BLOCKS = 16, ROUNDS = 3000 };

static uint32_t state_ = 1;
static uint32_t bits(void) { return state_ = state_ * 1664525u + 1013904223u, state_ >> 4 ^ state_ << 7; }
static uint32_t start_at(double share) { return (uint32_t)(share * 4294967296.0); }
static double real_in(double lo, double hi) { return lo + (hi - lo) * (double)(bits() >> 8 & 0xffff) / 65536; }

/* Lights of every kind, strong and weak, facing every way, over a square of `side` metres; one in seven dark. */
static noc_scene *scene_of(int lights, double side) {
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 10);
    for (int i = 0; i < lights; i++) {
        noc_light l = { .kind = (noc_light_kind)(i % NOC_LIGHT_KIND_COUNT),
                        .position = { real_in(-side, side), real_in(-side, side), real_in(0, 20) },
                        .radius = real_in(0.05, 0.5),
                        .inner_deg = 20,
                        .outer_deg = 90 };
        double power = i % 7 == 3 ? 0 : pow(10, real_in(-1, 3));
        for (int k = 0; k < 3; k++) {
            l.edge_u[k] = real_in(-1, 1);
            l.edge_v[k] = real_in(-1, 1);
            l.direction[k] = real_in(-1, 1);
            l.emission[k] = power * real_in(0.1, 1);
        }
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

typedef struct world {
    noc_scene *scene;
    noc_clusters *clusters;
    noc_render_params params;
    frame_constants frame;
    struct core_context ctx;
    gblock g[BLOCKS];
    const gblock *blocks[BLOCKS];
    uint32_t lanes[BLOCKS];
} world;

/* A tile that sees a patch of ground and a wall in it. */
static void make_world_of(world *w, noc_scene *scene, int list, int tail) {
    memset(w, 0, sizeof(*w));
    w->scene = scene;
    w->clusters = noc_clusters_create(w->scene, NOC_STANDING, NULL, NULL);
    assert_non_null(w->clusters);
    w->params = measure(64, 48, NOC_METHOD_RIS);
    w->params.list = list;
    w->params.tail = tail;
    noc_make_frame_constants(&w->params, 0, false, &w->frame);
    noc_camera c = look(20, 3, 4, 0, 0, 0, 50);
    noc_make_frame_camera(&c, &w->params, 0, &w->frame.camera);
    w->ctx = (struct core_context){ .lights = w->scene->lights.data,
                                    .light_count = (uint32_t)w->scene->lights.len,
                                    .materials = w->scene->material_records.data,
                                    .frame = &w->frame,
                                    .clusters = { w->clusters } };
    for (int b = 0; b < BLOCKS; b++) {
        gblock *g = &w->g[b];
        w->blocks[b] = g;
        for (int l = 0; l < BLOCK; l++) {
            bool wall = b >= 10;
            g->px[l] = (float)(wall ? 3 : real_in(-3, 3));
            g->py[l] = (float)real_in(-3, 3);
            g->pz[l] = (float)(wall ? real_in(0, 4) : 0);
            g->nx[l] = wall ? -1 : 0;
            g->nz[l] = wall ? 0 : 1;
            w->lanes[b] |= (uint32_t)(b % 3 != 2 || l % 4 != 1) << l;
        }
    }
}

static void make_world(world *w, int lights, double side, int list, int tail) {
    make_world_of(w, scene_of(lights, side), list, tail);
}

static void free_world(world *w) {
    noc_clusters_destroy(w->clusters);
    noc_scene_destroy(w->scene);
}

/* Can the light reach a surface of the tile? Looked at without bounds: a few places on it, all surfaces. */
static bool reaches(const world *w, const noc_light_record *r) {
    bool round = r->kind == NOC_LIGHT_SPHERE || r->kind == NOC_LIGHT_POINT;
    double n[3] = { (double)r->a[1] * r->b[2] - (double)r->a[2] * r->b[1],
                    (double)r->a[2] * r->b[0] - (double)r->a[0] * r->b[2],
                    (double)r->a[0] * r->b[1] - (double)r->a[1] * r->b[0] };
    if (!(luma(r->e) > 0))
        return false;
    for (int k = 0; k < 3 && r->kind == NOC_LIGHT_SPOT; k++)
        n[k] = r->a[k];
    for (int b = 0; b < BLOCKS; b++)
        for (int l = 0; l < BLOCK; l++) {
            double d[3] = { r->p[0] - w->g[b].px[l], r->p[1] - w->g[b].py[l], r->p[2] - w->g[b].pz[l] };
            double facing = -(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
            if (w->lanes[b] >> l & 1 && w->g[b].nx[l] * d[0] + w->g[b].nz[l] * d[2] > 0 &&
                (round || r->flags & LIGHT_TWO_SIDED || facing > 0))
                return true;
        }
    return false;
}

/* What lists of many starts hold of each light. A light of the tail has the same weight w in each list that holds it:
 * 1 over the probability of being drawn. */
typedef struct tally {
    uint32_t *times;
    float *weight; /* 0: no list holds it */
} tally;

static tally count_lists(const world *w, uint32_t (*start)(int round)) {
    size_t lights = w->scene->lights.len;
    tally t = { noc_calloc(lights, sizeof(*t.times)), noc_calloc(lights, sizeof(*t.weight)) };
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    assert_true(t.times && t.weight && s);
    for (int i = 0; i < ROUNDS; i++) {
        noc_pick_kernels(NOC_ISA_AUTO)->list_build(&w->ctx, w->blocks, w->lanes, BLOCKS, start(i), s);
        assert_true(s->list.count <= (uint32_t)(w->params.list + w->params.tail));
        for (uint32_t j = 0; j < s->list.count; j++) {
            uint32_t light = s->list.light[j];
            t.times[light]++;
            assert_true(t.weight[light] == 0 || t.weight[light] == s->list.weight[j]);
            t.weight[light] = s->list.weight[j];
        }
    }
    free(s);
    return t;
}

static void free_tally(tally *t) {
    free(t->times);
    free(t->weight);
}

static double mean_weight(const tally *t, int light) { return (double)t->weight[light] * t->times[light] / ROUNDS; }

static uint32_t even_start(int round) { return start_at((round + 0.5) / ROUNDS); }
static uint32_t tile_start(int round) { return tail_start(7, (uint32_t)round, 3); }

/* The tail's draws are evenly spaced, so with the starts evenly spaced too, a light of weight w is met every 1/w-th
 * time to within one: its mean weight is 1 to within w / rounds a way into it. */
static void weights_are_one(int lights, double side, int list, int tail) {
    static world w;
    make_world(&w, lights, side, list, tail);
    tally t = count_lists(&w, even_start);
    int tested = 0, wrong = 0, missed = 0, can = 0;
    double sum = 0, all = 0, drawn = 0;
    for (int i = 0; i < lights; i++) {
        const noc_light_record *r = &w.scene->lights.data[i];
        drawn += t.weight[i] > 0 && t.weight[i] != 1 ? 1 / (double)t.weight[i] : 0;
        if (!reaches(&w, r))
            continue;
        double lux = noc_light_intensity(r) / (100 + r->p[0] * r->p[0] + r->p[1] * r->p[1]); /* about */
        can++;
        all += lux;
        sum += lux * mean_weight(&t, i);
        missed += t.times[i] == 0;
        if ((double)t.weight[i] > 0.1 * ROUNDS || t.times[i] == 0)
            continue; /* met too seldom to say anything of it alone */
        tested++;
        wrong += fabs(mean_weight(&t, i) - 1) > 2 * (double)t.weight[i] / ROUNDS + 1e-3;
    }
    print_message(
        "# %d lights: %d can reach the tile, %d tested one by one, %d wrong, %d never met, mean weight by light "
        "%.4f; probabilities of the tail add up to %.3f\n",
        lights, can, tested, wrong, missed, sum / all, drawn);
    assert_true(tested > 20);
    assert_int_equal(wrong, 0);
    assert_true(fabs(sum / all - 1) < 0.01);
    /* Those that no list holds have less than 1 / ROUNDS each. */
    assert_true(drawn < tail + 1e-3 && drawn > tail - 0.01 * tail - (double)missed / ROUNDS);
    free_tally(&t);
    free_world(&w);
}

/* Starts as frames have them: of n lists a light of probability p is in n p, to within five standard deviations, and
 * all of them together stray as chance has it. */
static void weights_are_one_by_chance(void **state) {
    (void)state;
    static world w;
    make_world(&w, 6000, 60, 16, 64);
    tally t = count_lists(&w, tile_start);
    int tested = 0;
    double worst = 0, squares = 0;
    for (int i = 0; i < 6000; i++) {
        double p = t.weight[i] > 1 ? 1 / (double)t.weight[i] : 0;
        if (ROUNDS * p < 30)
            continue;
        double off = (t.times[i] - ROUNDS * p) / sqrt(ROUNDS * p * (1 - p));
        worst = fmax(worst, fabs(off));
        squares += off * off;
        tested++;
    }
    print_message("# %d lights: %.2f standard deviations at most, %.3f in the mean square\n", tested, worst,
                  squares / tested);
    assert_true(tested > 200);
    assert_true(worst < 5);
    assert_true(fabs(squares / tested - 1) < 0.5);
    free_tally(&t);
    free_world(&w);
}

static void small_scene(void **state) {
    (void)state;
    weights_are_one(300, 15, 16, 16);
}
static void large_scene(void **state) {
    (void)state;
    weights_are_one(6000, 60, 16, 64);
}
static void deep_scene(void **state) {
    (void)state;
    weights_are_one(90000, 400, 0, 128);
}

/* Lux of a light at a surface, as if it were a point, no nearer than its size. */
static double lux_at(const noc_light_record *r, const gblock *g, int l) {
    noc_light_bound b = noc_bound_light(r);
    double d[3] = { b.p[0] - g->px[l], b.p[1] - g->py[l], b.p[2] - g->pz[l] };
    double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], slope = g->nx[l] * d[0] + g->nz[l] * d[2];
    bool any = b.n[0] == 0 && b.n[1] == 0 && b.n[2] == 0;
    double facing = any ? sqrt(d2) : -(b.n[0] * d[0] + b.n[1] * d[1] + b.n[2] * d[2]);
    return b.intensity * fmax(slope, 0) * fmax(facing, 0) / (d2 * fmax(d2, b.radius * b.radius));
}

/* Thousands of lights all around and between the surfaces of the tile, each of which matters most to those beside it:
 * what the lists add up to at a surface is close to the sum of all, at all surfaces. Lists that score lights for the
 * tile as a whole have twenty times this error. */
static void tail_is_quiet(void **state) {
    (void)state;
    enum { STARTS = 24 };
    static world w;
    make_world(&w, 6000, 8, 32, 64);
    for (int b = 0; b < BLOCKS; b++)
        for (int l = 0; l < BLOCK; l++) { /* as a picture's blocks: what is close in it is close */
            w.g[b].py[l] = (float)(b % 4 * 1.5 + l % 4 * 0.375 - 3);
            *(b < 10 ? &w.g[b].px[l] : &w.g[b].pz[l]) = (float)(b / 4 * 1.5 + l / 4 * 0.375 - 3);
        }
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    static double all[BLOCKS][BLOCK];
    double error = 0;
    int surfaces = 0;
    for (int b = 0; b < BLOCKS; b++)
        for (int l = 0; l < BLOCK; l++)
            for (size_t i = 0; i < w.scene->lights.len; i++)
                all[b][l] += lux_at(&w.scene->lights.data[i], &w.g[b], l);
    for (int k = 0; k < STARTS; k++) {
        noc_pick_kernels(NOC_ISA_AUTO)->list_build(&w.ctx, w.blocks, w.lanes, BLOCKS, start_at((k + 0.5) / STARTS), s);
        for (int b = 0; b < BLOCKS; b++)
            for (int l = 0; l < BLOCK; l++) {
                double sum = 0;
                if (!(w.lanes[b] >> l & 1) || !(all[b][l] > 0))
                    continue;
                for (uint32_t j = 0; j < s->list.count; j++)
                    sum += s->list.weight[j] * lux_at(&w.scene->lights.data[s->list.light[j]], &w.g[b], l);
                error += (sum / all[b][l] - 1) * (sum / all[b][l] - 1);
                surfaces++;
            }
    }
    print_message("# mean squared relative error %.4f over %d surfaces\n", error / surfaces, surfaces / STARTS);
    assert_true(error / surfaces < 0.01);
    free(s);
    free_world(&w);
}

static void few_lights_are_listed(void **state) {
    (void)state;
    static world w;
    make_world(&w, 40, 15, 32, 16);
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    noc_pick_kernels(NOC_ISA_AUTO)->list_build(&w.ctx, w.blocks, w.lanes, BLOCKS, start_at(0.9), s);
    int can = 0, listed = 0;
    for (size_t i = 0; i < w.scene->lights.len; i++)
        can += reaches(&w, &w.scene->lights.data[i]);
    for (uint32_t j = 0; j < s->list.count; j++) {
        assert_true(s->list.weight[j] == 1);
        listed += reaches(&w, &w.scene->lights.data[s->list.light[j]]);
    }
    assert_true(can > 10);
    assert_int_equal(listed, can);
    free(s);
    free_world(&w);
}

/* Headlamps all around, whose beams pass by, do not take the places of a tail lamp beside the tile, whose candela are a
 * thousandth of their peak. */
static void narrow_beams_leave_room(void **state) {
    (void)state;
    static world w;
    noc_scene *scene = noc_scene_create(NULL);
    noc_profile *beam = NULL;
    assert_int_equal(noc_profile_builtin(NULL, "low-beam", &beam), NOC_OK);
    int profile = noc_scene_add_profile(scene, beam);
    noc_light tail = { .kind = NOC_LIGHT_DISC,
                       .position = { -4, 0, .8 },
                       .direction = { 1, 0, 0 },
                       .radius = .06,
                       .emission = { 3327, 0, 0 } };
    for (int i = 0; i < 80; i++) {
        double angle = 2 * M_PI * i / 80, ahead = angle + M_PI + (i % 2 ? 1.13 : -1.13); /* 65 degrees past the tile */
        noc_light head = { .kind = NOC_LIGHT_DISC,
                           .position = { 60 * cos(angle), 60 * sin(angle), .7 },
                           .direction = { cos(ahead), sin(ahead), 0 },
                           .c0 = { sin(ahead), -cos(ahead), 0 },
                           .radius = .06,
                           .emission = { 700, 700, 700 },
                           .profile = profile };
        assert_true(noc_scene_add_light(scene, &head) >= 0);
    }
    int beside = noc_scene_add_light(scene, &tail), times = 0;
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    make_world_of(&w, scene, 16, 32);
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    noc_pick_kernels(NOC_ISA_AUTO)->list_build(&w.ctx, w.blocks, w.lanes, BLOCKS, start_at(0.5), s);
    for (uint32_t j = 0; j < s->list.count; j++)
        if (s->list.light[j] == (uint32_t)beside && s->list.weight[j] == 1)
            times++;
    assert_int_equal(times, 1);
    free(s);
    noc_profile_destroy(beam);
    free_world(&w);
}

static void tables_agree(void **state) {
    (void)state;
    static world w;
    make_world(&w, 20000, 200, 24, 40);
    const kernels *all[NOC_MAX_KERNELS];
    int tables = noc_runnable_kernels(all);
    assert_true(tables >= 2);
    list_scratch *want = noc_alloc_large(1, sizeof(*want)), *have = noc_alloc_large(1, sizeof(*have));
    for (int round = 0; round < 50; round++) {
        uint32_t start = bits();
        all[0]->list_build(&w.ctx, w.blocks, w.lanes, BLOCKS, start, want);
        assert_int_equal(want->list.count > 24, 1);
        for (int k = 1; k < tables; k++) {
            all[k]->list_build(&w.ctx, w.blocks, w.lanes, BLOCKS, start, have);
            assert_int_equal(have->list.count, want->list.count);
            assert_memory_equal(have->list.light, want->list.light, want->list.count * sizeof(*want->list.light));
            assert_memory_equal(have->list.weight, want->list.weight, want->list.count * sizeof(*want->list.weight));
        }
    }
    free(want);
    free(have);
    free_world(&w);
}

/* A moon does not share a cluster with the lamps below, whose places would be told to no more than kilometres. */
static void far_lights_stand_alone(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    for (int i = 0; i < 301; i++) {
        noc_light l = { .kind = NOC_LIGHT_POINT,
                        .position = { real_in(-20, 20), real_in(-20, 20), 3 },
                        .emission = { 30, 30, 30 } };
        if (i == 150)
            l = (noc_light){ .kind = NOC_LIGHT_POINT, .position = { 1e5, 0, 1e5 }, .emission = { 5e9, 5e9, 5e9 } };
        assert_true(noc_scene_add_light(s, &l) >= 0);
    }
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_clusters *c = noc_clusters_create(s, NOC_STANDING, NULL, NULL);
    assert_non_null(c);
    for (size_t i = 0; i < c->count; i++)
        assert_true(c->level[0][i / 16].radius[i % 16] < 200);
    noc_clusters_destroy(c);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_scene),
        cmocka_unit_test(large_scene),
        cmocka_unit_test(deep_scene),
        cmocka_unit_test(weights_are_one_by_chance),
        cmocka_unit_test(far_lights_stand_alone),
        cmocka_unit_test(tail_is_quiet),
        cmocka_unit_test(few_lights_are_listed),
        cmocka_unit_test(narrow_beams_leave_room),
        cmocka_unit_test(tables_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
