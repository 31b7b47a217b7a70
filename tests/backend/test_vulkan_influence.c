/* Candidates from influence volumes on the Vulkan device beside those of the CPU: what each pixel finds, and whole
 * frames, have the same bits, by work groups of any size and however many tiles are done at once. Where the pool has no
 * room, it is told, and the picture stays right. */
#include "vulkan_view.h"

#include "../render/rooms.h"
#include "../told.h"
#include "backend/vulkan/influence_memory.h"

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

/* scale: S_r, 0: found. */
static noc_render_params over_volumes(noc_method method, double scale) {
    noc_render_params p = noc_render_default_params();
    p.width = W;
    p.height = H;
    p.method = method;
    p.candidates = NOC_CANDIDATES_INFLUENCE;
    p.influence = scale;
    p.aovs = NOC_AOV_BIT(LIGHTS) | NOC_AOV_BIT(DENSITY);
    return p;
}

/* Numbers of a view that differ; *most: the largest one. */
static size_t differing_numbers(const twins *t, noc_aov aov, float *most) {
    noc_channel *a = noc_view_aov(t->cpu, aov), *b = noc_view_aov(t->gpu, aov);
    assert_true(a && b);
    size_t n = (size_t)a->width * (size_t)a->height, off = 0;
    for (size_t i = 0; i < n; i++) {
        off += memcmp(&a->value[i], &b->value[i], sizeof(float)) != 0;
        *most = NOC_MAX(*most, a->value[i]);
    }
    noc_channel_destroy(a);
    noc_channel_destroy(b);
    return off;
}

/* Renders a frame on both machines. Returns how many lights a pixel found at most. */
static float expect_same_frame(const twins *t, const noc_camera *camera, const noc_render_params *p, const char *name) {
    assert_int_equal(noc_view_render(t->cpu, camera, p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(t->gpu, camera, p, NULL), NOC_OK);
    const frame_buffers *c = &cpu_of(t)->b;
    const vk_picture *g = &gpu_of(t)->b;
    int set = cpu_of(t)->shaded_set;
    float found = 0, density = 0;
    size_t lights = differing_numbers(t, NOC_AOV_LIGHTS, &found);
    size_t densities = differing_numbers(t, NOC_AOV_DENSITY, &density);
    size_t reservoirs = differing(t, c->r[set], &g->reservoirs[set], 6);
    size_t picture = differing(t, c->picture, &g->picture, 3);
    if (lights || densities || reservoirs || picture)
        fail_msg("%s, frame %u: pixels that find other numbers of lights %zu, densities %zu; words that differ: "
                 "reservoirs %zu, picture %zu",
                 name, t->cpu->history.index, lights, densities, reservoirs, picture);
    assert_true(density > 0);
    return found;
}

/* workers: of a work group, 0: as usual; bytes: of a band, 0: as usual. */
static void open_with(const noc_scene *scene, uint32_t workers, size_t bytes, twins *t) {
    open_twins(scene, true, messages, t);
    vk_device *d = gpu_of(t)->device;
    d->constants.list_workers = workers ? workers : d->constants.list_workers;
    d->band_bytes = bytes ? bytes : d->band_bytes;
}

/* A word of each tile of the picture's only band. */
static void read_tiles(const twins *t, uint32_t word, uint32_t *out) {
    const vk_view *v = gpu_of(t);
    uint32_t tiles = noc_vk_tiles(v->b.blocks_x) * noc_vk_tiles(v->b.blocks_y);
    for (uint32_t i = 0; i < tiles; i++)
        assert_int_equal(noc_vk_read(v->device, &v->scratch, 4 * ((VkDeviceSize)i * FOUND_WORDS + word), &out[i],
                                     sizeof(*out)),
                         NOC_OK);
}

/* ---- parameters ---- */

static const struct row {
    const char *name;
    double scale;
    int cluster, every, draws;
    bool boxes, final_ray;
} rows[] = {
    { "as usual", 0, 1, 4, 32, false, true },
    { "S_r of 1 m", 1, 1, 4, 32, false, true },
    { "S_r of 4 m, boxes", 4, 1, 7, 20, true, true },
    { "shared volumes", 0, 8, 4, 32, false, true },
    { "shared volumes, S_r of 1 m, boxes", 1, 16, 3, 9, true, true },
    { "all from all lights", 0, 1, 1, 16, false, true },
    { "many draws", 0, 1, 16, 200, false, false },
};

static void compare(const char *name, double size, int lights, noc_viewpoint from, uint32_t workers, size_t bytes) {
    noc_scene *scene = has_vulkan(messages) ? builtin(name, size, lights) : NULL;
    noc_camera camera;
    twins t;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, from, (double)W / H, &camera), NOC_OK);
    open_with(scene, workers, bytes, &t);
    for (size_t i = 0; i < NOC_COUNT(rows); i++)
        for (int restir = 0; restir < 2; restir++) {
            noc_render_params p = over_volumes(restir ? NOC_METHOD_RESTIR : NOC_METHOD_RIS, rows[i].scale);
            float found = 0;
            p.influence_cluster = rows[i].cluster;
            p.uniform_every = rows[i].every;
            p.draws = rows[i].draws;
            p.influence_boxes = rows[i].boxes ? NOC_INFLUENCE_VISIBLE : NOC_INFLUENCE_SPHERE;
            p.final_ray = rows[i].final_ray;
            noc_view_reset(t.cpu);
            noc_view_reset(t.gpu);
            for (int f = 0; f < 2; f++)
                found = NOC_MAX(found, expect_same_frame(&t, &camera, &p, rows[i].name));
            print_message("# %s, %s: %g lights at most\n", name, rows[i].name, found);
            assert_true(found > 1);
        }
    close_twins(&t);
    noc_scene_destroy(scene);
}

static void in_a_city(void **state) {
    (void)state;
    compare("city", 200, 0, NOC_VIEWPOINT_STREET, 0, 0);
}

static void in_a_mess(void **state) {
    (void)state;
    compare("mess", 0, 20000, NOC_VIEWPOINT_AERIAL, 0, 0);
}

/* A missing barrier shows where groups are as large as the lanes that run together, or else. */
static void any_size_of_group_and_band(void **state) {
    (void)state;
    compare("city", 150, 0, NOC_VIEWPOINT_STREET, 64, 1);
    compare("mess", 0, 3000, NOC_VIEWPOINT_STREET, 128, 1);
}

/* ---- what there is no room for ---- */

/* Tiles that see to the horizon are near more leaves than they have room for: groups look at all of them. */
static void too_many_leaves(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("mess", 0, 90000) : NULL;
    uint32_t leaves[16], all = 0;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)W / H, &camera), NOC_OK);
    open_with(scene, 0, 0, &t);
    noc_render_params p = over_volumes(NOC_METHOD_RIS, 0);
    expect_same_frame(&t, &camera, &p, "90,000 lights");
    read_tiles(&t, FOUND_LEAVES, leaves);
    for (int i = 0; i < 12; i++)
        all += leaves[i] == FOUND_ALL;
    print_message("# %u of 12 tiles\n", all);
    assert_true(all > 0);
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* ---- figures of the last frame ---- */

/* They are the frame's, whatever has been added or removed since. */
static void figures_after_an_edit(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("mess", 0, 50) : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)W / H, &camera), NOC_OK);
    open_with(scene, 0, 0, &t);
    noc_render_params p = over_volumes(NOC_METHOD_RIS, 0);
    int added[3000];
    for (int step = 0; step < 3; step++) {
        noc_light_stats cpu, gpu;
        expect_same_frame(&t, &camera, &p, "before an edit");
        for (size_t i = 0; i < NOC_COUNT(added) && step < 2; i++) {
            noc_light l = { .kind = NOC_LIGHT_POINT, .position = { (double)i, 1, 5 }, .emission = { 1, 1, 1 } };
            if (step)
                assert_int_equal(noc_scene_remove_light(scene, added[i]), NOC_OK);
            else
                assert_true((added[i] = noc_scene_add_light(scene, &l)) >= 0);
        }
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        noc_view_light_stats(t.cpu, &cpu);
        noc_view_light_stats(t.gpu, &gpu);
        print_message("# %llu surfaces, %u and %u lights\n", (unsigned long long)gpu.surfaces, gpu.found_median,
                      gpu.found_99);
        assert_true(gpu.surfaces > 0 && gpu.surfaces <= (uint64_t)W * H);
        assert_true(cpu.surfaces == gpu.surfaces && cpu.found_median == gpu.found_median &&
                    cpu.found_99 == gpu.found_99 && cpu.found_none == gpu.found_none);
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* ---- a pool that is too small ---- */

static double mean_of(noc_view *v) {
    noc_image *image = noc_view_image(v);
    double sum = 0;
    assert_non_null(image);
    size_t n = 3 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < n; i++)
        sum += image->rgb[i];
    noc_image_destroy(image);
    return sum / (double)n;
}

/* Pixels whose lights had no room list nothing, and draw from all n lights; the others list what the CPU's do. Adds
 * up how many there are of both. */
static void check_lists(const twins *t, float m_over_n, size_t *without, size_t *with) {
    noc_channel *a = noc_view_aov(t->cpu, NOC_AOV_LIGHTS), *b = noc_view_aov(t->gpu, NOC_AOV_LIGHTS);
    noc_channel *density = noc_view_aov(t->gpu, NOC_AOV_DENSITY);
    assert_true(a && b && density);
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++) {
        bool lost = b->value[i] == 0 && a->value[i] > 0;
        *without += lost;
        *with += b->value[i] > 0;
        if (!lost)
            assert_memory_equal(&a->value[i], &b->value[i], sizeof(float));
        else if (density->value[i] >= 0)
            assert_float_equal(density->value[i], m_over_n, 1e-5 * m_over_n);
    }
    noc_channel_destroy(a);
    noc_channel_destroy(b);
    noc_channel_destroy(density);
}

/* most: lights that the pool has room for. The picture has the CPU's mean, but for noise. */
static void expect_unbiased(const noc_scene *scene, uint32_t most) {
    enum { FRAMES = 40 };
    size_t without = 0, with = 0;
    double sum = 0, square = 0, mean = 0;
    noc_camera camera;
    twins t;
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, (double)W / H, &camera), NOC_OK);
    open_with(scene, 0, 0, &t);
    gpu_of(&t)->device->pool_most = most;
    told[0] = 0;
    for (int f = 0; f < FRAMES; f++) {
        noc_render_params p = over_volumes(NOC_METHOD_RIS, 0);
        p.seed = (uint32_t)f;
        p.draws = 200;
        noc_view_reset(t.cpu);
        noc_view_reset(t.gpu);
        assert_int_equal(noc_view_render(t.cpu, &camera, &p, NULL), NOC_OK);
        assert_int_equal(noc_view_render(t.gpu, &camera, &p, NULL), NOC_OK);
        check_lists(&t, (float)p.draws / (float)scene->lights.len, &without, &with);
        double cpu = mean_of(t.cpu), d = mean_of(t.gpu) - cpu;
        mean += cpu / FRAMES;
        sum += d / FRAMES;
        square += d * d / FRAMES;
    }
    double error = sqrt(NOC_MAX(square - sum * sum, 0) / (FRAMES - 1));
    print_message("# room for %u lights: %.3g of the lists are lost; means differ by %.2g, standard error %.2g\n", most,
                  (double)without / (double)(without + with), sum / mean, error / mean);
    assert_true(without > 0 && (most > 0) == (with > 0));
    assert_true(error < 0.01 * mean && fabs(sum) < 4 * error);
    assert_non_null(strstr(told, "there is no room for the lights that reach "));
    assert_null(strstr(strstr(told, "no room") + 1, "no room")); /* once */
    close_twins(&t);
}

static void a_pool_without_room_is_told(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("mess", 0, 300) : NULL;
    (void)state;
    if (!scene)
        skip();
    expect_unbiased(scene, 2000);
    expect_unbiased(scene, 0);
    noc_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_a_city),
        cmocka_unit_test(in_a_mess),
        cmocka_unit_test(any_size_of_group_and_band),
        cmocka_unit_test(too_many_leaves),
        cmocka_unit_test(figures_after_an_edit),
        cmocka_unit_test(a_pool_without_room_is_told),
    };
    messages = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
