/* Light lists on the Vulkan device and in the kernels: the lists of all tiles, by work groups of any size and by any
 * instruction set, and whole frames over them, have the same bits. */
#include "vulkan_view.h"

#include "../render/rooms.h"
#include "backend/vulkan/list_memory.h"
#include "core/random.h"

enum { W = 62, H = 45 };

static noc_log *messages; /* of all tests */

static noc_scene *builtin(const char *name, double size, int lights) {
    noc_scene *s = noc_scene_create(messages);
    noc_builtin_params of = noc_builtin_default_params();
    of.city.size = size;
    of.lights = lights;
    assert_int_equal(noc_scene_add_builtin(s, name, &of), NOC_OK);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

static noc_render_params over_lists(noc_method method, int list, int tail) {
    noc_render_params p = noc_render_default_params();
    p.width = W;
    p.height = H;
    p.method = method;
    p.candidates = NOC_CANDIDATES_LISTS;
    p.list = list;
    p.tail = tail;
    p.shadow_rays = 4;
    return p;
}

/* ---- lists ---- */

/* The blocks of a tile in the picture; returns how many. */
static int blocks_of(const cpu_view *v, int gbuffer, int number, const gblock **g, uint32_t *lanes) {
    int n = 0, x0 = number % v->b.tiles_x * TILE_BLOCKS, y0 = number / v->b.tiles_x * TILE_BLOCKS;
    for (int y = y0; y < NOC_MIN(y0 + TILE_BLOCKS, v->b.blocks_y); y++)
        for (int x = x0; x < NOC_MIN(x0 + TILE_BLOCKS, v->b.blocks_x); x++, n++)
            lanes[n] = lanes_with_surface(g[n] = &v->b.g[gbuffer][block_at(&v->b, x, y)]);
    return n;
}

typedef struct list_counts {
    size_t entries, drawn, copies, differ; /* drawn: of tails; copies: lists that have some */
} list_counts;

/* A tile's list by a table of kernels against the device's words of it. */
static void compare_list(const twins *t, const kernels *k, const frame_constants *f, int number, const uint32_t *words,
                         list_scratch *s, list_counts *c) {
    const cpu_view *v = cpu_of(t);
    const gblock *g[TILE_BLOCKS * TILE_BLOCKS];
    uint32_t lanes[TILE_BLOCKS * TILE_BLOCKS];
    struct core_context ctx = { .frame = f,
                                .lights = v->scene->lights.data,
                                .light_count = (uint32_t)v->scene->lights.len,
                                .materials = v->scene->material_records.data,
                                .clusters = { v->sources.clusters[0], v->sources.clusters[1] },
                                .at.lists = s };
    int n = blocks_of(v, t->cpu->history.gbuffer, number, g, lanes);
    k->list_build(&ctx, g, lanes, n, tail_start(f->seed, (u32)number, f->index), s);
    k->list_fill(&ctx);
    c->differ += s->list.count != words[TILE_COUNT];
    c->copies += s->list.copies > 1;
    c->entries += s->list.count;
    for (uint32_t i = 0; i < s->list.count; i++) {
        uint32_t weight;
        memcpy(&weight, &s->list.weight[i], 4);
        c->drawn += s->list.weight[i] > 1;
        c->differ += s->list.light[i] != words[TILE_LIGHT + i] || weight != words[TILE_WEIGHT + i];
    }
}

/* The lists of the frame that both machines have rendered last, by all tables of kernels. */
static list_counts compare_lists(const twins *t, const noc_render_params *p, const noc_camera *camera) {
    const vk_view *gpu = gpu_of(t);
    const cpu_view *cpu = cpu_of(t);
    const kernels *all[NOC_MAX_KERNELS];
    int tables = noc_runnable_kernels(all), tiles = cpu->b.tiles_x * cpu->b.tiles_y;
    size_t words = noc_vk_tile_words(NOC_MAX(cpu->sources.clusters[0] ? cpu->sources.clusters[0]->levels : 0,
                                             cpu->sources.clusters[1] ? cpu->sources.clusters[1]->levels : 0));
    uint32_t *device = noc_alloc_large((size_t)tiles * words, 4);
    list_scratch *s = noc_alloc_large(1, sizeof(*s));
    list_counts c = { 0 };
    frame_constants f;
    assert_true(device && s);
    assert_int_equal(noc_vk_read(gpu->device, &gpu->scratch, 0, device, (size_t)tiles * words * 4), NOC_OK);
    noc_make_frame_constants(p, t->cpu->history.index - 1, false, &f);
    noc_make_frame_camera(camera, p, t->cpu->history.index - 1, &f.camera);
    for (int i = 0; i < tables * tiles; i++)
        compare_list(t, all[i / tiles], &f, i % tiles, device + (size_t)(i % tiles) * words, s, &c);
    print_message("# %zu lights: %zu entries, %zu of tails, %zu differ\n", cpu->scene->lights.len,
                  c.entries / (size_t)tables, c.drawn / (size_t)tables, c.differ);
    free(device);
    free(s);
    return c;
}

/* ---- frames ---- */

static void expect_same_frame(const twins *t, const noc_camera *camera, const noc_render_params *p, const char *name) {
    assert_int_equal(noc_view_render(t->cpu, camera, p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(t->gpu, camera, p, NULL), NOC_OK);
    const frame_buffers *c = &cpu_of(t)->b;
    const vk_picture *g = &gpu_of(t)->b;
    int set = cpu_of(t)->shaded_set;
    size_t reservoirs = noc_cpu_keeps_reservoirs(p) ? differing(t, c->r[set], &g->reservoirs[set], 6) : 0;
    size_t colour = differing(t, c->colour, &g->colour, 3), picture = differing(t, c->picture, &g->picture, 3);
    if (reservoirs || colour || picture)
        fail_msg("%s, frame %u: words that differ: reservoirs %zu, colour %zu, picture %zu", name,
                 t->cpu->history.index, reservoirs, colour, picture);
}

typedef struct sizes {
    uint32_t list, share; /* invocations of work groups; 0: as usual */
    size_t bytes;         /* of a band */
} sizes;

static void open_with(const noc_scene *scene, sizes size, twins *t) {
    open_twins(scene, true, messages, t);
    vk_device *d = gpu_of(t)->device;
    if (size.list) {
        d->constants.list_workers = size.list;
        d->constants.share_workers = size.share;
    }
    if (size.bytes)
        d->band_bytes = size.bytes;
}

/* One frame of a built-in scene and its lists. */
static void compare(const char *name, double size, int lights, int list, int tail, sizes groups) {
    noc_scene *scene = has_vulkan(messages) ? builtin(name, size, lights) : NULL;
    noc_camera camera;
    twins t;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_AERIAL, (double)W / H, &camera), NOC_OK);
    open_with(scene, groups, &t);
    noc_render_params p = over_lists(NOC_METHOD_RIS, list, tail);
    expect_same_frame(&t, &camera, &p, "ris");
    list_counts c = compare_lists(&t, &p, &camera);
    assert_int_equal(c.differ, 0);
    assert_true(c.entries > 1000 && (c.drawn > 100 || c.copies > 10));
    close_twins(&t);
    noc_scene_destroy(scene);
}

static void one_level(void **state) {
    (void)state;
    compare("city", 150, 0, 16, 24, (sizes){ 0 });
}

static void longest_lists(void **state) {
    (void)state;
    compare("city", 150, 0, LIST_ENTRIES, LIST_ENTRIES, (sizes){ 0 });
}

static void two_levels(void **state) {
    (void)state;
    compare("mess", 0, 20000, 64, 64, (sizes){ 0 });
}

static void three_levels(void **state) {
    (void)state;
    compare("mess", 0, 90000, 64, 64, (sizes){ 0 });
}

/* Fewer lights than lists have room for: they hold each of them several times. */
static void copies(void **state) {
    (void)state;
    compare("mess", 0, 30, 64, 96, (sizes){ 0 });
}

/* A missing barrier shows where groups are as large as the lanes that run together, or else. */
static void any_size_of_group(void **state) {
    (void)state;
    compare("mess", 0, 20000, 64, 64, (sizes){ 64, 16, 0 });
    compare("mess", 0, 20000, 64, 64, (sizes){ 128, 32, 0 });
}

/* ---- methods ---- */

static void methods_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        bool temporal, spatial, visibility, learn, final_ray;
    } rows[] = {
        { "ris, without learning", NOC_METHOD_RIS, false, false, true, false, true }, /* first: nothing is there yet */
        { "ris", NOC_METHOD_RIS, false, false, true, true, true },
        { "ris, without rays", NOC_METHOD_RIS, false, false, true, true, false },
        { "restir in time", NOC_METHOD_RESTIR, true, false, true, true, true },
        { "restir", NOC_METHOD_RESTIR, true, true, true, true, true },
        { "restir in space", NOC_METHOD_RESTIR, false, true, true, true, true },
        { "restir, one ray", NOC_METHOD_RESTIR, true, true, false, true, true },
    };
    noc_scene *scene = has_vulkan(messages) ? builtin("city", 200, 0) : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)W / H, &camera), NOC_OK);
    open_with(scene, (sizes){ .bytes = 1 }, &t); /* a row of tiles at a time */
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_render_params p = over_lists(rows[i].method, 24, 40);
        p.temporal = rows[i].temporal;
        p.spatial = rows[i].spatial;
        p.visibility_reuse = rows[i].visibility;
        p.learn = rows[i].learn;
        p.final_ray = rows[i].final_ray;
        noc_view_reset(t.cpu);
        noc_view_reset(t.gpu);
        for (int f = 0; f < 4; f++)
            expect_same_frame(&t, &camera, &p, rows[i].name);
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* What was learned outlives the picture's size: a cache of more cells is filled from the one before. Cells are as wide
 * as so many pixels. */
static void larger_pictures_keep_what_was_learned(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("mess", 0, 300) : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1, &camera), NOC_OK);
    open_with(scene, (sizes){ 0 }, &t);
    for (int size = 48; size <= 272; size += 224) { /* 9 tiles, and more than 256, of pixels as wide */
        camera.fov_deg = 2 * atan(size * 0.0018) * 180 / M_PI;
        noc_render_params p = over_lists(NOC_METHOD_RIS, 16, 16);
        p.width = p.height = size;
        p.shadow_rays = 1;
        uint32_t cells = gpu_of(&t)->learning.cells;
        expect_same_frame(&t, &camera, &p, "before it learns");
        expect_same_frame(&t, &camera, &p, "after it learned");
        assert_true(gpu_of(&t)->learning.cells > cells);
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_level),
        cmocka_unit_test(longest_lists),
        cmocka_unit_test(two_levels),
        cmocka_unit_test(three_levels),
        cmocka_unit_test(copies),
        cmocka_unit_test(any_size_of_group),
        cmocka_unit_test(methods_have_the_same_bits),
        cmocka_unit_test(larger_pictures_keep_what_was_learned),
    };
    messages = noc_log_create(NULL);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
