/* Every table of kernels that this machine can run gives the bits of the scalar one, on random blocks: also those that
 * noc_pick_kernels would not choose here. */
#include "../test.h"

#include "backend/embree/kernels.h"

#include <math.h>

enum { LIGHTS = 300, MATERIALS = 8, ROUNDS = 400, NEIGHBOURS = 5, RAYS = 24 };

static uint64_t seed;
static uint32_t roll(void) {
    uint64_t z = seed += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)(z >> 32);
}
static float uniform(float from, float to) { return from + (to - from) * ((float)(roll() >> 8) * 0x1p-24f); }
static void random3(float *v, float half) {
    for (int i = 0; i < 3; i++)
        v[i] = uniform(-half, half);
}

static _Alignas(64) noc_light_record lights[LIGHTS];
static noc_material_record materials[MATERIALS];
static noc_render_params params = noc_render_default_params();
static noc_frame frame;
static struct core_context ctx = { lights, LIGHTS, materials, &frame };

static int set_up(void **state) {
    (void)state;
    seed = 1;
    for (int i = 0; i < LIGHTS; i++) {
        noc_light_record *l = &lights[i];
        *l = (noc_light_record){ .kind = roll() % 5, .radius = uniform(0.1f, 1), .flags = roll() & 3, .area = 1 };
        random3(l->p, 20);
        random3(l->e, 0);
        for (int k = 0; k < 3; k++)
            l->e[k] = uniform(0, 1000);
        if (l->kind != NOC_LIGHT_POINT) {
            random3(l->a, 1);
            random3(l->b, 1);
        }
    }
    for (int i = 0; i < MATERIALS; i++)
        materials[i] = (noc_material_record){ .albedo = { uniform(0, 1), uniform(0, 1), uniform(0, 1) },
                                              .f0 = i & 1 ? uniform(0, 1) : 0,
                                              .alpha = uniform(0.0025f, 1) };
    params.width = 640;
    params.height = 360;
    params.rays = RAYS;
    params.sky = 0.05;
    noc_camera camera = noc_camera_default();
    camera.eye[2] = 30;
    camera.target[0] = 5;
    frame = (noc_frame){ .params = &params, .index = 3, .history = true };
    noc_make_frame_camera(&camera, &params, 3, &frame.camera);
    camera.eye[0] = 2;
    noc_make_frame_camera(&camera, &params, 2, &frame.previous);
    return 0;
}

/* Surfaces of either diffuse or any material; a few lanes see the sky. */
static void random_surfaces(gblock *g, uint32_t *lanes) {
    *lanes = 0;
    uint32_t plain = roll() % 2;
    for (int i = 0; i < BLOCK; i++) {
        float n[3], l2;
        do {
            random3(n, 1);
            l2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        } while (l2 < 0.01f);
        bool sky = roll() % 8 == 0;
        float s = sky ? 0 : 1 / sqrtf(l2);
        g->px[i] = uniform(-20, 20);
        g->py[i] = uniform(-20, 20);
        g->pz[i] = uniform(-20, 20);
        g->nx[i] = n[0] * s;
        g->ny[i] = n[1] * s;
        g->nz[i] = n[2] * s;
        g->depth[i] = uniform(1, 50);
        g->material[i] = sky ? NO_SURFACE : plain ? 0 : roll() % MATERIALS;
        g->light[i] = NOC_NO_LIGHT;
        *lanes |= (sky ? 0u : 1u) << i;
    }
}

static void random_reservoirs(rblock *r, uint32_t lanes) {
    for (int i = 0; i < BLOCK; i++) {
        bool on = lanes >> i & 1;
        r->light[i] = roll() % LIGHTS;
        r->u[i] = uniform(0, 1);
        r->v[i] = uniform(0, 1);
        r->w[i] = on && roll() % 4 ? uniform(0, 500) : 0;
        r->m[i] = on ? (float)(roll() % 640) : 0;
        r->p[i] = on && roll() % 4 ? uniform(0, 10) : 0;
    }
}

/* What one table makes of one random block. */
typedef struct results {
    rblock candidates, biased, mis, pairwise, place;
    float x[BLOCK], y[BLOCK];
    uint32_t front, dropped, sky_dropped, count[BLOCK];
    rayblock segments, sky_rays;
    combination offered, paired;
    cblock shaded, sky, background;
    uint32_t entry_light[RAYS][BLOCK];
    float entry_w[RAYS][BLOCK];
} results;

typedef struct input {
    gblock g;
    rblock own;
    neighbour n[NEIGHBOURS];
    uint32_t lanes, visible[NEIGHBOURS];
    int x, y, m;
} input;

static void random_input(input *in) {
    random_surfaces(&in->g, &in->lanes);
    random_reservoirs(&in->own, in->lanes);
    for (int i = 0; i < NEIGHBOURS; i++) {
        uint32_t there;
        random_surfaces(&in->n[i].g, &there);
        in->n[i].lanes = there & in->lanes & roll();
        random_reservoirs(&in->n[i].r, in->n[i].lanes);
        in->visible[i] = roll() & in->n[i].lanes;
    }
    in->x = (int)(roll() % 160) * 4;
    in->y = (int)(roll() % 90) * 4;
    in->m = 1 + (int)(roll() % 33);
}

static void run(const kernels *k, const input *in, results *r) {
    memset(r, 0, sizeof(*r));
    k->candidates(&ctx, &in->g, in->lanes, in->x, in->y, in->m, &r->candidates);
    r->front = k->project(&ctx, &in->g, r->x, r->y);
    k->segments(&ctx, &in->g, in->own.light, in->own.u, in->own.v, &r->segments);
    k->offer(&ctx, &in->g, &in->own, in->n, NEIGHBOURS, in->x, in->y, 64, &r->offered);
    k->targets(&ctx, frame.camera.eye, in->n, NEIGHBOURS, r->offered.light, r->offered.u, r->offered.v, &r->offered);
    k->end_biased(&r->offered, &r->biased);
    k->end_mis(&r->offered, &in->own, in->n, NEIGHBOURS, in->visible, &r->mis);
    k->targets(&ctx, frame.camera.eye, in->n, NEIGHBOURS, in->own.light, in->own.u, in->own.v, &r->paired);
    k->end_pairwise(&ctx, &in->g, &in->own, in->n, NEIGHBOURS, in->visible, in->x, in->y, 64, &r->paired, &r->pairwise);
    r->dropped = k->shade(&ctx, &in->g, &in->own, in->lanes, &r->shaded);
    static float sums[(LIGHTS + REFERENCE_CHUNK - 1) / REFERENCE_CHUNK][BLOCK];
    reference_scratch scratch = { .sums = sums, .light = r->entry_light, .w = r->entry_w };
    k->reference(&ctx, &in->g, in->lanes, in->x, in->y, &scratch);
    memcpy(r->count, scratch.count, sizeof(r->count));
    r->place = in->own;
    k->reference_place(&ctx, in->x, in->y, &r->place);
    k->sky_rays(&ctx, &in->g, in->x, in->y, &r->sky_rays);
    r->sky_dropped = k->sky_shade(&ctx, &in->g, &r->sky_rays, in->lanes, &r->sky);
    k->sky_background(&ctx, ~in->lanes & 0xffff, in->x, in->y, &r->background);
}

#define EXPECT_SAME(field)                                                                                             \
    do {                                                                                                               \
        if (memcmp(&a.field, &b.field, sizeof(a.field)))                                                               \
            fail_msg("%s: round %d: %s differs from scalar C", k->name, round, #field);                                \
    } while (0)

static void compare(const kernels *k) {
    static input in;
    static results a, b;
    int chosen = 0, shaded = 0, entries = 0;
    seed = 2;
    for (int round = 0; round < ROUNDS; round++) {
        random_input(&in);
        run(&noc_kernels_scalar, &in, &a);
        run(k, &in, &b);
        EXPECT_SAME(candidates);
        EXPECT_SAME(front);
        EXPECT_SAME(x);
        EXPECT_SAME(y);
        EXPECT_SAME(segments);
        EXPECT_SAME(offered);
        EXPECT_SAME(biased);
        EXPECT_SAME(mis);
        EXPECT_SAME(paired);
        EXPECT_SAME(pairwise);
        EXPECT_SAME(shaded);
        EXPECT_SAME(dropped);
        EXPECT_SAME(count);
        EXPECT_SAME(entry_light);
        EXPECT_SAME(entry_w);
        EXPECT_SAME(place);
        EXPECT_SAME(sky_rays);
        EXPECT_SAME(sky);
        EXPECT_SAME(sky_dropped);
        EXPECT_SAME(background);
        for (int i = 0; i < BLOCK; i++) {
            chosen += a.candidates.w[i] > 0 && a.pairwise.w[i] > 0 && a.mis.w[i] > 0;
            shaded += a.shaded.rgb[1][i] > 0;
            entries += (int)a.count[i];
        }
    }
    /* the comparison was about something */
    assert_true(chosen > ROUNDS && shaded > ROUNDS && entries > 10 * ROUNDS);
}

static void test_baseline(void **state) { compare(&noc_kernels_baseline); }

#if defined(__x86_64__)
static void test_avx2(void **state) {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2")) {
        print_message("# skipped: this machine has no AVX2\n");
        skip();
    }
    compare(&noc_kernels_avx2);
}

static void test_avx512(void **state) {
    if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq") || !__builtin_cpu_supports("avx512bw") ||
        !__builtin_cpu_supports("avx512vl")) {
        print_message("# skipped: this machine has no AVX-512\n");
        skip();
    }
    compare(&noc_kernels_avx512);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_baseline),
#if defined(__x86_64__)
        cmocka_unit_test(test_avx2),
        cmocka_unit_test(test_avx512),
#endif
    };
    return cmocka_run_group_tests_name("kernels", tests, set_up, NULL);
}
