/* core/list_scores.h: a patch that blocks of pixels share holds all of them, and blocks share one only where they are
 * alike. */
#include "core_test.h"

#include "no_scores.h"

enum { BLOCKS = 16, PIXELS = 16 };

struct core_context {
    list_point at[BLOCKS][PIXELS];
    u1 piece[2 * BLOCKS];
    list_patch patch[2 * BLOCKS];
};

#define MINE ((struct core_context *)(uintptr_t)ctx)
FN u1 tile_pixels(CTX u1 block) { return 0xffff; }
FN list_point tile_point(CTX u1 block, u1 place) { return ctx->at[block][place]; }
FN list_material list_material_load(CTX u1 material) {
    return (list_material){ F3(.5f, .5f, .5f), material ? .05f : 0, .25f };
}
FN void piece_store(CTX u1 i, u1 pixels) { MINE->piece[i] = pixels; }
FN u1 piece_load(CTX u1 i) { return ctx->piece[i]; }
FN void patch_store(CTX u1 i, list_patch t) { MINE->patch[i] = t; }
FN list_patch patch_load(CTX u1 i) { return ctx->patch[i]; }

static const f3 eye = { 0, 0, 0 };

/* A floor 2 m below the eye, a tile of it from x, y on, so wide; tilted by so much for each metre of x beyond 10. */
static void lay_floor(struct core_context *c, float x, float y, float width, float tilt) {
    for (int b = 0; b < BLOCKS; b++)
        for (int k = 0; k < PIXELS; k++) {
            list_point *q = &c->at[b][k];
            float px = x + width * (float)(4 * (b % 4) + k % 4) / 16,
                  py = y + width * (float)(4 * (b / 4) + k / 4) / 16;
            float turn = px > 10 ? tilt * (px - 10) : 0;
            q->p = F3(px, py, -2);
            q->n = F3(sinf(turn), 0, cosf(turn));
            q->depth = sqrtf(px * px + py * py + 4);
            q->material = 0;
        }
}

/* Each pixel lies within a patch that faces its way: what cosines and distances are bounded by. */
static void assert_held(const struct core_context *c, u1 patches) {
    float all = 0;
    for (int b = 0; b < BLOCKS; b++)
        for (int k = 0; k < PIXELS; k++) {
            bool held = false;
            for (u1 i = 0; i < patches; i++) {
                const list_patch *t = &c->patch[i];
                const list_point *q = &c->at[b][k];
                f3 d = F3(q->p.x - t->c.x, q->p.y - t->c.y, q->p.z - t->c.z);
                float cosine = dot1(q->n, t->axis);
                bool faces = t->spread > 1 || (cosine > 0 && sqrtf(fmaxf(1 - cosine * cosine, 0)) <= t->spread);
                held = held || (dot1(d, d) <= t->radius * t->radius && faces);
            }
            assert_true(held);
        }
    for (u1 i = 0; i < patches; i++)
        all += c->patch[i].share * c->patch[i].share;
    assert_true(fabsf(all - 1) < 1e-4f);
}

static void shared(void **state) {
    static struct core_context context;
    struct core_context *ctx = &context;
    (void)state;
    lay_floor(ctx, 20, -1, 1.2f, 0);
    assert_int_equal(make_patches(PASS BLOCKS, eye), 1);
    assert_held(ctx, 1);
    lay_floor(ctx, 9.5f, -1, 1.2f, .2f); /* bent by 7 degrees */
    assert_int_equal(make_patches(PASS BLOCKS, eye), 1);
    assert_held(ctx, 1);
    for (int k = 0; k < PIXELS; k++)
        ctx->at[5][k].material = 1; /* glossy */
    assert_int_equal(make_patches(PASS BLOCKS, eye), 3);
    assert_held(ctx, 3);
}

static void apart(void **state) {
    static struct core_context context;
    struct core_context *ctx = &context;
    (void)state;
    lay_floor(ctx, 9.5f, -1, 1.2f, 2); /* half of it is bent by up to 75 degrees */
    u1 patches = make_patches(PASS BLOCKS, eye);
    assert_true(patches > 4 && patches <= BLOCKS);
    assert_held(ctx, patches);
    lay_floor(ctx, 20, -1, 3, 0); /* wider than a patch may be */
    patches = make_patches(PASS BLOCKS, eye);
    assert_true(patches > 4 && patches < BLOCKS);
    assert_held(ctx, patches);
    for (u1 i = 0; i < patches; i++)
        assert_true(ctx->patch[i].radius < 1.01f * PATCH_RADIUS);
}

/* Whatever is joined: spheres in one another, far from one another, cones of any width. */
static void joined(void **state) {
    dice d = { 77 };
    (void)state;
    for (int i = 0; i < 20000; i++) {
        list_patch of[2] = { 0 };
        for (int k = 0; k < 2; k++) {
            v3 c = random_in_box(&d, 3), n = random_direction(&d);
            if (k) /* so that they face alike */
                n = normalised(add3(mul3(V3(of[0].axis.x, of[0].axis.y, of[0].axis.z), 4), n));
            of[k] = (list_patch){ .c = F3(c.x, c.y, c.z),
                                  .radius = (float)uniform(&d, .01, i % 3 ? 1 : 6),
                                  .axis = F3(n.x, n.y, n.z),
                                  .spread = (float)uniform(&d, .01, .5),
                                  .share = (float)(1 + i % 16) };
        }
        list_patch t = join_patches(of[0], of[1], F3(50, 0, 0));
        for (int k = 0; k < 2; k++) {
            f3 w = F3(of[k].c.x - t.c.x, of[k].c.y - t.c.y, of[k].c.z - t.c.z);
            double angle = acos(fmin((double)dot1(of[k].axis, t.axis), 1)) + asin((double)of[k].spread);
            assert_true((double)sqrtf(dot1(w, w)) + (double)of[k].radius <= (double)t.radius);
            assert_true((double)t.spread >= 1 || sin(angle) <= (double)t.spread);
        }
        assert_true(t.share == of[0].share + of[1].share);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shared),
        cmocka_unit_test(apart),
        cmocka_unit_test(joined),
    };
    return cmocka_run_group_tests_name("core/list_patches", tests, NULL, NULL);
}
