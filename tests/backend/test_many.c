/* Many shadow rays in one call: through a chequered screen, where what is free is known without tracing anything. */
#include "all_kinds.h"
#include "cpu_view.h"
#include "render/device.h"

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
    assert_int_equal(noc_backend_embree.replay(s, NULL, &floor), NOC_OK);
    assert_true(floor.wall_seconds >= 0 && floor.cpu_seconds >= 0);
    assert_int_equal(s->workers[0].record.count, 0);
    close_cpu_view(s);
    noc_scene_destroy(scene);
}

/* ---- the trace floor of a frame ---- */

/* What a tracer was asked and what it answered: once a frame is rendered, then once its rays are traced again. */
typedef struct traced {
    uint64_t closest, occluded[2], through, answers; /* rays; occluded: in the scene as it is, and as it was */
} traced;

static traced asked;
static const noc_tracer *tracing;

static void counted_closest(void *structure, noc_ray_world in, const rayblock *rays, float far, uint32_t valid,
                            bool coherent, const uint32_t *chance, hitblock *hits) {
    tracing->closest(structure, in, rays, far, valid, coherent, chance, hits);
    asked.closest += (uint64_t)__builtin_popcount(valid);
    for (int l = 0; l < BLOCK; l++)
        asked.answers += (valid >> l & 1) * (uint64_t)(hits->triangle[l] ^ 0x5555);
}

static void counted_occluded(void *structure, noc_ray_world in, shadow_block *blocks, int count) {
    tracing->occluded(structure, in, blocks, count);
    for (int i = 0; i < count; i++) {
        asked.occluded[in == NOC_RAYS_PAST] += (uint64_t)__builtin_popcount(blocks[i].valid);
        asked.answers += (uint64_t)blocks[i].unoccluded << 20;
    }
}

static bool counted_through(void *structure, const shadow_block *blocks, int count, float (*out)[BLOCK]) {
    bool weak = tracing->through(structure, blocks, count, out);
    for (int i = 0; weak && i < count; i++)
        for (int l = 0; l < BLOCK; l++)
            if (blocks[i].unoccluded >> l & 1) {
                asked.through++;
                asked.answers += (uint64_t)(out[i][l] * 1e6f) << 30;
            }
    return weak;
}

static traced of_frame;

static noc_status replay_counted(void *view, const noc_progress *progress, noc_trace_floor *floor) {
    of_frame = asked;
    asked = (traced){ 0 };
    return noc_backend_embree.replay(view, progress, floor);
}

/* A device of one thread whose tracer is counted. */
static noc_device *counted_device(noc_tracer *tracer, noc_backend *backend) {
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 1 }, NULL);
    assert_non_null(device);
    cpu_device *d = device->state;
    tracing = d->tracer;
    *tracer = *tracing;
    tracer->closest = counted_closest;
    tracer->occluded = counted_occluded;
    tracer->through = counted_through;
    d->tracer = tracer;
    *backend = *device->backend;
    backend->replay = replay_counted;
    device->backend = backend;
    return device;
}

/* The car moves, so that bias rays are asked of the scene of the frame before; then one frame's floor. */
static void measure_floor(noc_device *device, noc_scene *scene, int car, const noc_render_params *p) {
    noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };
    const double there[12] = { 1.5, 0, 0, 2, 0, 1.5, 0, -4.5, 0, 0, 1.5, 0 };
    noc_trace_floor floor = { 0 };
    noc_view *v = noc_view_create(device, scene);
    assert_non_null(v);
    assert_int_equal(noc_view_render(v, &camera, p, NULL), NOC_OK);
    assert_int_equal(noc_scene_set_transform(scene, car, there), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    asked = (traced){ 0 };
    assert_int_equal(noc_view_trace_floor(v, &camera, p, NULL, &floor), NOC_OK);
    assert_true(floor.wall_seconds > 0);
    noc_view_destroy(v);
}

/* The rays that are traced again are all of the frame's, with the same answers: those through panes, too. */
static void all_rays_are_traced_again(void **state) {
    static const struct {
        noc_method method;
        noc_candidates candidates;
    } kinds[] = { { NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM },
                  { NOC_METHOD_RIS, NOC_CANDIDATES_LISTS },
                  { NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM } };
    noc_tracer tracer;
    noc_backend backend;
    noc_device *device = counted_device(&tracer, &backend);
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(kinds); i++)
        for (int panes = 0; panes < 2; panes++) {
            int car;
            noc_scene *scene = all_kinds_with(panes, &car);
            noc_render_params p = all_kinds_params(kinds[i].method, false);
            p.candidates = kinds[i].candidates;
            measure_floor(device, scene, car, &p);
            assert_memory_equal(&asked, &of_frame, sizeof(asked));
            assert_true(asked.closest > 0 && asked.occluded[0] > 0 && (asked.through > 0) == panes);
            assert_true((asked.occluded[1] > 0) == (kinds[i].method == NOC_METHOD_RESTIR));
            noc_scene_destroy(scene);
        }
    noc_device_destroy(device);
}

/* Either half can be broken off: *left calls are allowed. */
static bool count_down(void *user, const char *what, double done) {
    int *left = user;
    (void)what;
    assert_true(done >= 0 && done <= 1);
    return (*left)-- > 0;
}

static void a_floor_is_broken_off(void **state) {
    noc_camera camera = { .eye = { 0, -11, 3 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 }, .fov_deg = 60 };
    noc_render_params p = all_kinds_params(NOC_METHOD_RIS, false);
    int car, allowed = 0;
    (void)state;
    noc_scene *scene = all_kinds(&car);
    noc_device *device = noc_device_create(&(noc_device_params){ .threads = 1 }, NULL);
    noc_view *v = noc_view_create(device, scene);
    for (noc_status status = NOC_ERR_CANCELLED; status != NOC_OK; allowed++) {
        noc_trace_floor floor = { -1, -1 };
        int left = allowed;
        status = noc_view_trace_floor(v, &camera, &p, &(noc_progress){ count_down, &left }, &floor);
        assert_true(status == NOC_OK ? left >= 0 : status == NOC_ERR_CANCELLED && left == -1);
        assert_true((floor.wall_seconds >= 0) == (status == NOC_OK));
    }
    assert_true(allowed > 15); /* of 9 tiles, of two stages or more, and of packets */
    noc_view_destroy(v);
    noc_device_destroy(device);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_answers),
        cmocka_unit_test(company_does_not_matter),
        cmocka_unit_test(kept_rays),
        cmocka_unit_test(all_rays_are_traced_again),
        cmocka_unit_test(a_floor_is_broken_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
