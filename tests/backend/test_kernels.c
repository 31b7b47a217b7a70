/* Every kernel table this machine can run gives the scalar table's bits, on random blocks: surfaces behind and before
 * the lights, missing surfaces, empty reservoirs, rejected neighbours, lights of all kinds. */
#include "../render/rooms.h"

#include "backend/cpu/kernels.h"
#include "core/presample_limits.h"

enum { PROFILE_CELLS = 22, LIGHTS = 77, MATERIALS = 9, ROUNDS = 40 };

static uint32_t state_ = 1;
static uint32_t bits(void) { return state_ = state_ * 1664525u + 1013904223u, state_ >> 4 ^ state_ << 7; }
static float real_in(float lo, float hi) { return lo + (hi - lo) * (float)(bits() >> 8 & 0xffff) / 65536.f; }

typedef struct world {
    ALIGNED noc_light_record lights[LIGHTS];
    ALIGNED float profiles[4 * PROFILE_CELLS];
    noc_material_record materials[MATERIALS];
    noc_render_params params;
    frame_constants frame;
    struct core_context ctx;
} world;

static void make_world(world *w) {
    for (int i = 0; i < LIGHTS; i++) {
        noc_light_record *r = &w->lights[i];
        *r = (noc_light_record){ .kind = (uint32_t)i % NOC_LIGHT_KIND_COUNT,
                                 .flags = (uint32_t)(i % 3 == 0),
                                 .radius = real_in(0.05f, 1) };
        for (int k = 0; k < 3; k++) {
            r->p[k] = real_in(-10, 10);
            r->a[k] = real_in(-1, 1);
            r->b[k] = real_in(-1, 1);
            r->e[k] = real_in(0, 100);
        }
    }
    /* a point, a sphere or a disc in three has one of two profiles: 3 by 4 and 8 by 1 steps */
    const uint32_t heads[2][2] = { { 2, 3u << 16 | 4 }, { 14, 8u << 16 | 1 } };
    for (int i = 0; i < LIGHTS; i++)
        if (w->lights[i].kind % 4 < 2 && i % 3 == 1)
            w->lights[i].flags |= (1u + (uint32_t)(i % 2)) << LIGHT_PROFILE;
    for (int i = 0; i < 4 * PROFILE_CELLS; i++)
        w->profiles[i] = real_in(0, 3);
    for (int p = 0; p < 2; p++) {
        memcpy(w->profiles + 4 * p, heads[p], sizeof(heads[p]));
        w->profiles[4 * p + 2] = p ? 16 : 12;
        w->profiles[4 * p + 3] = p ? 0.5f : 0.25f;
    }
    for (int i = 0; i < MATERIALS; i++)
        w->materials[i] = (noc_material_record){ .albedo = { real_in(0, 1), real_in(0, 1), real_in(0, 1) },
                                                 .f0 = i % 2 ? real_in(0, 0.2f) : 0,
                                                 .alpha = real_in(0.01f, 1) };
    w->params = measure(64, 48, NOC_METHOD_RESTIR);
    w->params.sky = 0.3;
    w->params.rays = 9;
    noc_make_frame_constants(&w->params, bits(), true, &w->frame);
    noc_camera c = look(20, 3, 4, 0, 0, 0, 50), d = look(19, 4, 4, 0, 0, 1, 50);
    noc_make_frame_camera(&c, &w->params, 3, &w->frame.camera);
    noc_make_frame_camera(&d, &w->params, 2, &w->frame.previous);
    w->ctx = (struct core_context){ .frame = &w->frame,
                                    .lights = w->lights,
                                    .profiles = w->profiles,
                                    .light_count = LIGHTS,
                                    .materials = w->materials };
}

static void random_surface(gblock *g) {
    for (int l = 0; l < BLOCK; l++) {
        float n[3] = { real_in(-1, 1), real_in(-1, 1), real_in(-1, 1) };
        float inv = 1 / sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + 1e-6f);
        bool none = bits() % 7 == 0;
        g->px[l] = none ? 0 : real_in(-10, 10);
        g->py[l] = none ? 0 : real_in(-10, 10);
        g->pz[l] = none ? 0 : real_in(-10, 10);
        g->nx[l] = none ? 0 : n[0] * inv;
        g->ny[l] = none ? 0 : n[1] * inv;
        g->nz[l] = none ? 0 : n[2] * inv;
        g->depth[l] = none ? 0 : real_in(1, 30);
        g->material[l] = none ? NO_SURFACE : bits() % MATERIALS;
        g->light[l] = NOC_NO_LIGHT;
    }
}

static void random_reservoirs(rblock *r) {
    for (int l = 0; l < BLOCK; l++) {
        bool empty = bits() % 4 == 0;
        r->light[l] = bits() % LIGHTS;
        r->u[l] = real_in(0, 1);
        r->v[l] = real_in(0, 1);
        r->w[l] = empty ? 0 : real_in(0, 50);
        r->p[l] = empty ? 0 : real_in(0, 5);
        r->m[l] = (float)(bits() % 60);
    }
}

/* Everything the kernels leave behind, for one random world. */
typedef struct trace {
    rblock candidates, combined[NOC_BIAS_COUNT];
    held_block held[NOC_BIAS_COUNT];
    rayblock segments, sky;
    cblock shaded, reference;
    float p_at[NOC_BIAS_COUNT][MAX_NEIGHBOURS][BLOCK];
    uint32_t asked[NOC_BIAS_COUNT][MAX_NEIGHBOURS], visible[NOC_BIAS_COUNT], x[BLOCK], y[BLOCK];
    uint32_t front, entries[BLOCK], dropped;
    neighbour fetched[8];
} trace;

/* A picture of one plane with holes, and what is fetched of it for a block of the plane: whole blocks, between blocks,
 * over the picture's edges and beyond. */
static void fetch_all(const kernels *k, const world *w, trace *t) {
    enum { BLOCKS = 16 * 12 };
    static gblock g[BLOCKS];
    static rblock r[BLOCKS];
    static const int at[8][2] = { { 8, 4 },   { 9, 4 },   { 8, 7 },   { 18, 21 },
                                  { -2, -3 }, { 62, 45 }, { 61, 20 }, { -40, 8 } };
    uint32_t before = state_;
    for (int i = 0; i < BLOCKS; i++) {
        random_surface(&g[i]);
        random_reservoirs(&r[i]);
        for (int l = 0; l < BLOCK; l++) {
            g[i].pz[l] = 0;
            g[i].nx[l] = g[i].ny[l] = 0;
            g[i].nz[l] = g[i].material[l] == NO_SURFACE ? 0 : 1;
            r[i].light[l] = (uint32_t)(i * BLOCK + l);
        }
    }
    for (int i = 0; i < 8; i++) {
        neighbour *n = &t->fetched[i];
        k->neighbours(&w->ctx, g, r, &g[40], 0xfff7, at[i][0], at[i][1], n);
        for (int l = 0; l < BLOCK; l++) {
            int x = at[i][0] + (l & 3), y = at[i][1] + (l >> 2), from = y / 4 * 16 + x / 4,
                lane = (y & 3) * 4 + (x & 3);
            bool on = x >= 0 && y >= 0 && x < 64 && y < 48 && g[from].nz[lane] > 0 && g[40].nz[l] > 0 && l != 3;
            assert_int_equal(n->lanes >> l & 1, on);
            if (on)
                assert_true(n->r.light[l] == (uint32_t)(from * BLOCK + lane) && n->g.px[l] == g[from].px[lane]);
            else if (n->lanes)
                assert_true(n->r.w[l] == 0 && n->r.m[l] == 0);
        }
    }
    state_ = before;
}

static void shade_reference(const kernels *k, const world *w, const gblock *g, trace *t) {
    static float sums[LIGHTS / REFERENCE_CHUNK + 1][BLOCK], weight[1024][BLOCK];
    static uint32_t light[1024][BLOCK];
    reference_scratch e = { sums, light, weight, { 0 } };
    k->reference(&w->ctx, g, 0xffff, 4, 8, &e);
    memcpy(t->entries, e.count, sizeof(e.count));
    for (uint32_t i = 0; i < 16; i++) {
        rblock r = { 0 };
        uint32_t lanes = 0;
        for (int l = 0; l < BLOCK; l++)
            if (i < e.count[l]) {
                lanes |= 1u << l;
                r.light[l] = light[i][l];
                r.w[l] = weight[i][l];
            }
        k->reference_place(&w->ctx, 4, 8, &r);
        t->dropped |= k->shade(&w->ctx, g, &r, lanes, &t->reference);
    }
}

/* Every way to combine, with random answers. */
static void combine_all(const kernels *k, world *w, combining *b, trace *t) {
    for (uint32_t bias = 0; bias < NOC_BIAS_COUNT; bias++) {
        w->frame.bias = bias;
        b->visible = 0xbeef;
        b->eye = bias == BIAS_PAIRWISE ? &w->frame.previous : &w->frame.camera;
        memset(b->p_at, 0, sizeof(b->p_at));
        k->reuse_begin(&w->ctx, b);
        k->reuse_ask(&w->ctx, b);
        k->reuse_end(&w->ctx, b, &t->combined[bias]);
        t->held[bias] = b->held;
        t->visible[bias] = b->visible;
        memcpy(t->p_at[bias], b->p_at, sizeof(b->p_at));
        memcpy(t->asked[bias], b->asked, sizeof(b->asked));
    }
}

static void run_all(const kernels *k, world *w, combining *b, trace *t) {
    const gblock *g = b->g;
    const rblock *own = b->own;
    memset(t, 0, sizeof(*t));
    static presample_row samples[2 * 13];
    static presample_pick1 drawn[13 * BLOCK];
    static float weighed[13][BLOCK];
    for (uint32_t i = 0; i < 2; i++)
        k->presample(&w->ctx, i, 13, false, drawn, samples + (size_t)13 * i);
    uint32_t pixels[BLOCK];
    for (uint32_t l = 0; l < BLOCK; l++)
        pixels[l] = 7 + 3 * l;
    k->presampled(&w->ctx, g, 0xbeef, pixels, 13,
                  samples + (size_t)13 * presample_subset(w->frame.seed, 9, w->frame.index, 2), weighed,
                  &t->candidates);
    fetch_all(k, w, t);
    t->front = k->history_places(&w->ctx, g, t->x, t->y);
    k->segments(&w->ctx, g, own->light, own->u, own->v, &t->segments);
    combine_all(k, w, b, t);
    t->dropped |= k->shade(&w->ctx, g, own, 0x7ffe, &t->shaded);
    uint32_t number[BLOCK];
    float share[BLOCK];
    for (int l = 0; l < BLOCK; l++) {
        number[l] = (uint32_t)l % 3;
        share[l] = l % 2 ? 1 : 0.25f;
    }
    k->sky_rays(&w->ctx, g, 4, 8, number, &t->sky);
    t->dropped |= k->sky_shade(&w->ctx, g, &t->sky, share, 0xffff, &t->shaded);
    k->sky_background(&w->ctx, 0x00f0, 4, 8, &t->shaded);
    shade_reference(k, w, g, t);
}

static void tables_agree(void **state) {
    (void)state;
    const kernels *all[NOC_MAX_KERNELS];
    int tables = noc_runnable_kernels(all), lit = 0;
    assert_true(tables >= 2);
    static combining b;
    static world w;
    static trace want, have;
    for (int round = 0; round < ROUNDS; round++) {
        gblock g;
        rblock own;
        make_world(&w);
        random_surface(&g);
        random_reservoirs(&own);
        b = (combining){ .x = 4, .y = 8, .g = &g, .own = &own, .dim = 64, .k = round % (MAX_NEIGHBOURS + 1) };
        for (int i = 0; i < b.k; i++) {
            neighbour *n = &b.n[i];
            random_surface(&n->g);
            random_reservoirs(&n->r);
            n->lanes = bits() & 0xffff;
            for (int l = 0; l < BLOCK; l++)
                if (!(n->lanes >> l & 1))
                    n->r.m[l] = n->r.w[l] = 0;
            b.unoccluded[i] = bits() & 0xffff;
        }
        run_all(all[0], &w, &b, &want);
        for (int k = 1; k < tables; k++) {
            run_all(all[k], &w, &b, &have);
            if (memcmp(&want, &have, sizeof(want))) {
                size_t at = 0;
                while (((char *)&want)[at] == ((char *)&have)[at])
                    at++;
                fail_msg("%s differs from scalar in round %d at byte %zu", all[k]->name, round, at);
            }
        }
        for (int l = 0; l < BLOCK; l++)
            lit += want.candidates.w[l] > 0 && want.reference.rgb[1][l] > 0;
    }
    assert_true(lit > ROUNDS * 4); /* the blocks were not all dark */
    print_message("# %d tables, the widest %s\n", tables, all[tables - 1]->name);
}

/* Neighbours that random lanes of a block have, some of them none. */
static void random_neighbours(combining *b) {
    for (int i = 0; i < b->k; i++) {
        neighbour *n = &b->n[i];
        random_surface(&n->g);
        random_reservoirs(&n->r);
        n->lanes = bits() % 3 ? bits() & 0xffff : 0;
        b->unoccluded[i] = bits() & 0xffff;
    }
}

/* Keeps the neighbours of these lanes. */
static void keep_lanes(combining *b, uint32_t lanes) {
    for (int i = 0; i < b->k; i++) {
        neighbour *n = &b->n[i];
        n->lanes &= lanes;
        for (int l = 0; l < BLOCK; l++)
            if (!(n->lanes >> l & 1))
                n->r.m[l] = n->r.w[l] = 0;
    }
}

static void assert_same_lane(const rblock *a, const rblock *b, int l) {
    assert_true(a->light[l] == b->light[l] && a->u[l] == b->u[l] && a->v[l] == b->v[l]);
    assert_true(a->w[l] == b->w[l] && a->m[l] == b->m[l] && a->p[l] == b->p[l]);
}

/* Neighbours are numbered by their draw: what a pixel gets does not depend on whether other pixels of its block have
 * them, and a pixel without any keeps its reservoir to the bit. */
static void pixels_do_not_depend_on_their_block(void **state) {
    (void)state;
    const kernels *all[NOC_MAX_KERNELS];
    int tables = noc_runnable_kernels(all), alone = 0;
    static combining whole, one;
    static world w;
    static trace together, apart;
    for (int round = 0; round < ROUNDS; round++) {
        gblock g;
        rblock own;
        make_world(&w);
        random_surface(&g);
        random_reservoirs(&own);
        whole = (combining){ .x = 4, .y = 8, .g = &g, .own = &own, .dim = 64, .k = 1 + round % 6 };
        random_neighbours(&whole);
        keep_lanes(&whole, 0xffff);
        combine_all(all[round % tables], &w, &whole, &together);
        for (int l = 0; l < BLOCK; l++) {
            one = whole;
            keep_lanes(&one, 1u << l);
            combine_all(all[round % tables], &w, &one, &apart);
            float m = 0;
            for (int i = 0; i < one.k; i++)
                m += one.n[i].r.m[l];
            for (int bias = 0; bias < NOC_BIAS_COUNT; bias++) {
                assert_same_lane(&together.combined[bias], &apart.combined[bias], l);
                assert_int_equal(together.visible[bias] >> l & 1, apart.visible[bias] >> l & 1);
                if (m == 0)
                    assert_same_lane(&together.combined[bias], &own, l);
            }
            alone += m == 0;
        }
    }
    assert_true(alone > ROUNDS && alone < ROUNDS * (BLOCK - 1));
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(tables_agree),
                                        cmocka_unit_test(pixels_do_not_depend_on_their_block) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
