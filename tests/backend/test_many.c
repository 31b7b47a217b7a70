/* Many shadow rays in one call: through a chequered screen, where what is free is known without tracing anything. */
#include "cpu_view.h"

#include "test.h"

#include <math.h>

enum { CELLS = 12, MOST = 70 };

static cpu_view *chequered(noc_scene **scene) {
    double positions[CELLS * CELLS * 4 * 3];
    uint32_t indices[CELLS * CELLS * 6];
    size_t v = 0, t = 0;
    for (int y = 0; y < CELLS; y++)
        for (int x = y & 1; x < CELLS; x += 2) {
            uint32_t at = (uint32_t)(v / 3);
            for (int k = 0; k < 4; k++) {
                positions[v++] = x + (k & 1);
                positions[v++] = y + (k >> 1);
                positions[v++] = 5;
            }
            memcpy(indices + t, (uint32_t[]){ at, at + 1, at + 3, at, at + 3, at + 2 }, 24);
            t += 6;
        }
    *scene = noc_scene_create(NULL);
    const noc_material grey = { .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1 };
    const noc_mesh mesh = { .vertex_count = v / 3,
                            .positions = positions,
                            .triangle_count = t / 3,
                            .indices = indices,
                            .material = noc_scene_add_material(*scene, &grey) };
    assert_true(noc_scene_add_mesh(*scene, &mesh) >= 0);
    assert_int_equal(noc_scene_commit(*scene), NOC_OK);
    cpu_view *view = open_cpu_view(*scene, 1, NULL);
    assert_non_null(view);
    return view;
}

static uint32_t next(uint32_t *seed) { return *seed = *seed * 1664525u + 1013904223u; }
static float unit(uint32_t *seed) { return (float)(next(seed) >> 8) / 16777216.0f; }

/* Segments from z = 0 to one of `lights` lamps at z = 10, lamp i of them below the screen when i is a multiple of 5.
 * Lanes that pass near an edge are not valid, nor is one in four others. expect: those that the screen leaves free. */
static void make_block(uint32_t *seed, uint32_t lights, shadow_block *b, uint32_t *expect) {
    *b = (shadow_block){ .unoccluded = next(seed) };
    *expect = 0;
    for (int l = 0; l < BLOCK; l++) {
        uint32_t lamp = next(seed) / 7 % lights;
        float to[3] = { 1.5f + (float)(lamp * 7 % 10), 1.5f + (float)(lamp * 3 % 10), lamp % 5 ? 10 : 4 };
        b->light[l] = lamp * 0x01010101u; /* large numbers, too */
        for (int k = 0; k < 3; k++) {
            b->rays.o[k][l] = k == 2 ? 0 : (float)CELLS * unit(seed);
            b->rays.d[k][l] = to[k] - b->rays.o[k][l];
        }
        double x = b->rays.o[0][l] + 0.5 * b->rays.d[0][l], y = b->rays.o[1][l] + 0.5 * b->rays.d[1][l];
        bool near = fabs(x - round(x)) < 1e-3 || fabs(y - round(y)) < 1e-3;
        bool free = lamp % 5 == 0 || ((int)floor(x) + (int)floor(y)) % 2;
        b->valid |= (uint32_t)(!near && next(seed) >> 30) << l;
        *expect |= (uint32_t)free << l;
    }
    *expect &= b->valid;
}

static void known_answers(void **state) {
    (void)state;
    noc_scene *scene;
    cpu_view *s = chequered(&scene);
    worker *w = &s->workers[0];
    static shadow_block blocks[MOST];
    static float counts[MOST][BLOCK];
    uint32_t expect[MOST], seed = 7;
    const int sizes[] = { 1, 2, 7, MANY_BLOCKS, MANY_BLOCKS + 1, MOST };
    const uint32_t lights[] = { 1, 2, 12, 300 };
    for (size_t i = 0; i < NOC_COUNT(sizes) * NOC_COUNT(lights); i++) {
        int n = sizes[i % NOC_COUNT(sizes)];
        uint64_t before = w->rays_shadow, rays = 0, open = 0;
        for (int k = 0; k < n; k++) {
            make_block(&seed, lights[i / NOC_COUNT(sizes)], &blocks[k], &expect[k]);
            memset(counts[k], 0, sizeof(counts[k]));
            blocks[k].counts = k % 3 ? counts[k] : NULL;
            rays += (uint64_t)__builtin_popcount(blocks[k].valid);
            open += (uint64_t)__builtin_popcount(expect[k]);
        }
        assert_true(n < 7 || (open > rays / 4 && open < rays) || lights[i / NOC_COUNT(sizes)] == 1);
        noc_cpu_trace_occlusion(s, w, NOC_RAYS_NOW, blocks, n);
        assert_int_equal(w->rays_shadow - before, rays);
        for (int k = 0; k < n; k++) {
            assert_int_equal(blocks[k].unoccluded, expect[k]);
            for (int l = 0; l < BLOCK; l++)
                assert_true(counts[k][l] == (k % 3 ? (float)(blocks[k].valid >> l & 1) : 0));
        }
    }
    close_cpu_view(s);
    noc_scene_destroy(scene);
}

/* Answers do not depend on which block is where, nor on what the lights are called. */
static void company_does_not_matter(void **state) {
    (void)state;
    noc_scene *scene;
    cpu_view *s = chequered(&scene);
    static shadow_block blocks[MANY_BLOCKS], other[MANY_BLOCKS];
    uint32_t expect, seed = 99;
    for (int k = 0; k < MANY_BLOCKS; k++) {
        make_block(&seed, 12, &blocks[k], &expect);
        blocks[k].valid = 0xffff; /* edges, too */
    }
    for (int k = 0; k < MANY_BLOCKS; k++) {
        other[k] = blocks[MANY_BLOCKS - 1 - k];
        for (int l = 0; l < BLOCK; l++)
            other[k].light[l] = next(&seed) % 3 ? UINT32_MAX : other[k].light[l] ^ 0xabcd;
    }
    noc_cpu_trace_occlusion(s, &s->workers[0], NOC_RAYS_NOW, blocks, MANY_BLOCKS);
    noc_cpu_trace_occlusion(s, &s->workers[0], NOC_RAYS_NOW, other, MANY_BLOCKS);
    for (int k = 0; k < MANY_BLOCKS; k++)
        assert_int_equal(blocks[k].unoccluded, other[MANY_BLOCKS - 1 - k].unoccluded);
    close_cpu_view(s);
    noc_scene_destroy(scene);
}

/* Kept rays are traced again in the calls they came in, also where a run of packets ends within one. */
static void kept_rays(void **state) {
    (void)state;
    noc_scene *scene;
    cpu_view *s = chequered(&scene);
    static shadow_block blocks[MANY_BLOCKS + 3];
    uint32_t expect, seed = 3;
    noc_trace_floor floor = { -1, -1 };
    noc_backend_embree.record(s, true);
    for (int call = 0; call < 3; call++) {
        for (int k = 0; k < MANY_BLOCKS + 3; k++)
            make_block(&seed, 5, &blocks[k], &expect);
        noc_cpu_trace_occlusion(s, &s->workers[0], NOC_RAYS_NOW, blocks, MANY_BLOCKS + 3);
        blocks[0].valid |= 1;
        noc_cpu_trace_occlusion(s, &s->workers[0], NOC_RAYS_NOW, blocks, 1);
    }
    noc_backend_embree.record(s, false);
    assert_int_equal(s->workers[0].record.count, 3 * (MANY_BLOCKS + 4));
    assert_int_equal(noc_backend_embree.replay(s, &floor), NOC_OK);
    assert_true(floor.wall_seconds >= 0 && floor.cpu_seconds >= 0);
    assert_int_equal(s->workers[0].record.count, 0);
    close_cpu_view(s);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_answers),
        cmocka_unit_test(company_does_not_matter),
        cmocka_unit_test(kept_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
