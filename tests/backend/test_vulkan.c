/* The Vulkan backend beside the CPU's, on a device that traces rays. */
#include "all_kinds.h"
#include "same_frames.h"

#include <nocturne/nocturne.h>

static noc_log *messages; /* of all tests */

static noc_scene *builtin(const char *name) {
    noc_scene *scene = noc_scene_create(messages);
    noc_builtin_params params = noc_builtin_default_params();
    assert_int_equal(noc_scene_add_builtin(scene, name, &params), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene;
}

static void plans_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        noc_candidates candidates;
        noc_bias bias;
        bool bias_rays, visibility, final_ray;
        int passes;
    } plans[] = {
        { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "is", NOC_METHOD_IS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, power", NOC_METHOD_RIS, NOC_CANDIDATES_POWER, NOC_BIAS_PAIRWISE, true, false, true, 1 },
        { "ris, light-bvh", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, influence", NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, influence, S_r", NOC_METHOD_RIS, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_PAIRWISE, true, false, true, 1 },
        { "pairwise, influence", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "mis, influence, many", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, NOC_BIAS_MIS, true, true, true, 2 },
        { "ris, many", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "ris, no rays", NOC_METHOD_RIS, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, false, 1 },
        { "biased", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_BIASED, true, true, true, 1 },
        { "mis", NOC_METHOD_RESTIR, NOC_CANDIDATES_POWER, NOC_BIAS_MIS, true, true, true, 2 },
        { "mis, no bias rays", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_MIS, false, false, true, 1 },
        { "counted", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_COUNTED, true, true, true, 2 },
        { "counted, no bias rays", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_COUNTED, false, true, true, 1 },
        { "pairwise", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true, 1 },
        { "pairwise, two passes", NOC_METHOD_RESTIR, NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_PAIRWISE, true, true, true, 2 },
        { "pairwise, 20 neighbours", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, true, true, true,
          1 },
        { "pairwise, no bias rays", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE, false, true, true,
          1 },
    };
    noc_scene *scene = has_vulkan(messages) ? builtin("mess") : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 62.0 / 45, &camera), NOC_OK);
    open_twins(scene, true, messages, &t);
    for (size_t i = 0; i < NOC_COUNT(plans); i++) {
        noc_render_params p = noc_render_default_params();
        p.width = 62;
        p.height = 45;
        p.method = plans[i].method;
        p.candidates = plans[i].candidates;
        p.bias = plans[i].bias;
        p.bias_rays = plans[i].bias_rays;
        p.visibility_reuse = plans[i].visibility;
        p.final_ray = plans[i].final_ray;
        p.passes = plans[i].passes;
        p.rays = 20;
        p.draws = strstr(plans[i].name, "many") ? 200 : 32;
        p.influence = strstr(plans[i].name, "S_r") ? 2 : 0;
        p.neighbours = strstr(plans[i].name, "20 neighbours") ? 20 : p.neighbours;
        expect_same_bits(&t, &camera, &p, p.method == NOC_METHOD_REFERENCE ? 1 : 3, plans[i].name);
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* ---- all kinds of things ---- */

static void all_kinds_have_the_same_bits(void **state) {
    int car;
    noc_scene *scene = has_vulkan(messages) ? all_kinds(&car) : NULL;
    noc_camera camera = look(0, -11, 3, 0, 0, 2, 60);
    twins t;
    (void)state;
    if (!scene)
        skip();
    open_twins(scene, true, messages, &t);
    noc_render_params p = all_kinds_params(NOC_METHOD_RESTIR, false);
    expect_same_bits(&t, &camera, &p, 3, "textures, instances, profiles");
    p.gloss = false;
    expect_same_bits(&t, &camera, &p, 2, "without gloss");
    p = all_kinds_params(NOC_METHOD_RIS, false);
    p.candidates = NOC_CANDIDATES_LISTS;
    expect_same_bits(&t, &camera, &p, 3, "lists");
    noc_image *map = bright_map();
    assert_int_equal(noc_scene_set_environment(scene, map), NOC_OK);
    noc_image_destroy(map);
    p = all_kinds_params(NOC_METHOD_RIS, true);
    expect_same_bits(&t, &camera, &p, 2, "a map that lights");
    p.environment_light = false;
    expect_same_bits(&t, &camera, &p, 2, "a map behind everything");
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* Frames while instances move, and lights are switched, moved, added and removed: the past scene's rays, lights and
 * surfaces. */
static void edits_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_bias bias;
        noc_candidates candidates;
    } rows[] = { { "edits, pairwise", NOC_BIAS_PAIRWISE, NOC_CANDIDATES_UNIFORM },
                 { "edits, mis", NOC_BIAS_MIS, NOC_CANDIDATES_UNIFORM },
                 { "edits, counted", NOC_BIAS_COUNTED, NOC_CANDIDATES_UNIFORM },
                 { "edits, lists", NOC_BIAS_PAIRWISE, NOC_CANDIDATES_LISTS },
                 { "edits, influence", NOC_BIAS_PAIRWISE, NOC_CANDIDATES_INFLUENCE } };
    noc_camera camera = look(0, -11, 3, 0, 0, 2, 60);
    (void)state;
    if (!has_vulkan(messages))
        skip();
    for (size_t row = 0; row < NOC_COUNT(rows); row++) {
        int car, added = -1;
        noc_scene *scene = all_kinds(&car);
        twins t;
        open_twins(scene, true, messages, &t);
        noc_render_params p = all_kinds_params(NOC_METHOD_RESTIR, false);
        p.bias = rows[row].bias;
        p.candidates = rows[row].candidates;
        for (int f = 0; f < 9; f++) {
            noc_instance in = { 1, { 1.5, 0, 0, -4 + 0.4 * f, 0, 1.5, 0, -4 + 0.1 * f, 0, 0, 1.5, 0 } };
            noc_light l = crowd_light(70 + f, -3);
            if (f && f != 4)
                assert_int_equal(noc_scene_set_transform(scene, car, in.transform), NOC_OK);
            if (f == 2 || f == 3)
                assert_int_equal(noc_scene_set_emission(scene, 5, (float[3]){ 90.f * (float)f, 10, 10 }), NOC_OK);
            if (f == 5)
                assert_true((added = noc_scene_add_light(scene, &l)) >= 0);
            if (f == 7)
                assert_int_equal(noc_scene_remove_light(scene, added), NOC_OK);
            assert_int_equal(noc_scene_commit(scene), NOC_OK);
            expect_same_frame(&t, &camera, &p, rows[row].name);
        }
        close_twins(&t);
        noc_scene_destroy(scene);
    }
}

/* Models with lights, on a way before the camera. */
static noc_scene *street_of_cars(void) {
    static const noc_scene_stop stops[] = { { 0, { -5, -4, 0 }, 0 },
                                            { 10, { 5, -4, 0 }, 10 },
                                            { 14, { 5, -1, 0 }, 13 } };
    int car;
    noc_scene *scene = all_kinds_open(false, &car);
    int route = noc_scene_add_route(scene, stops, NOC_COUNT(stops));
    assert_true(route >= 0);
    for (int i = 0; i < 5; i++)
        assert_true(noc_scene_add_car(scene, 1, route, 2.5 * i, 2));
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene;
}

/* Cars with their lamps drive, are taken out of sight and come back, as `animate` and the viewer have them. Returns how
 * many pixels saw a car, or another instance. */
static size_t drive(twins *t, noc_scene *scene, const noc_camera *camera, const noc_render_params *p,
                    const char *name) {
    static const double times[] = { 0, 0.25, 0.5, 0.5, 40, 40.25 };
    size_t seen = 0;
    for (size_t f = 0; f < NOC_COUNT(times); f++) {
        if (f)
            assert_int_equal(noc_scene_set_time(scene, times[f]), NOC_OK);
        if (f == 3 || f == 4)
            assert_int_equal(noc_scene_show_cars(scene, f == 4), NOC_OK);
        assert_int_equal(noc_scene_commit(scene), NOC_OK);
        expect_same_frame(t, camera, p, name);
        const frame_buffers *b = &cpu_of(t)->b;
        size_t before = seen;
        for (size_t i = 0; i < (size_t)b->blocks_x * b->blocks_y * BLOCK; i++)
            seen += b->instance[i / BLOCK][i % BLOCK] != NO_INSTANCE;
        assert_true(seen > before);
    }
    return seen;
}

static void cars_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_candidates candidates;
        noc_bias bias;
    } rows[] = { { "cars, pairwise", NOC_CANDIDATES_UNIFORM, NOC_BIAS_PAIRWISE },
                 { "cars, mis, light-bvh", NOC_CANDIDATES_LIGHT_BVH, NOC_BIAS_MIS },
                 { "cars, lists", NOC_CANDIDATES_LISTS, NOC_BIAS_PAIRWISE } };
    (void)state;
    if (!has_vulkan(messages))
        skip();
    for (size_t row = 0; row < NOC_COUNT(rows); row++) {
        noc_scene *scene = street_of_cars();
        noc_scene_info info;
        noc_camera camera = look(0, -11, 3, 0, 0, 2, 60);
        twins t;
        noc_scene_get_info(scene, &info);
        assert_int_equal(info.cars, 5);
        open_twins(scene, true, messages, &t);
        noc_render_params p = all_kinds_params(NOC_METHOD_RESTIR, false);
        p.candidates = rows[row].candidates;
        p.bias = rows[row].bias;
        size_t seen = drive(&t, scene, &camera, &p, rows[row].name);
        print_message("# %s: %zu pixels of cars\n", rows[row].name, seen);
        assert_true(seen > 50);
        close_twins(&t);
        noc_scene_destroy(scene);
    }
}

/* ---- views ---- */

#define AOV(name) (1u << NOC_AOV_##name)
enum {
    OF_RESERVOIRS = AOV(DENSITY) | AOV(LIGHT) | AOV(WEIGHT) | AOV(CONFIDENCE),
    OF_SURFACES = AOV(DEPTH) | AOV(NORMAL) | AOV(CLASS) | AOV(OBJECT) | AOV(MOTION),
    OF_LISTS = AOV(LIGHTS) | AOV(EXPECTED), /* the first of influence, too */
    ALL_VIEWS = ((1u << NOC_AOV_COUNT) - 1) & ~OF_LISTS,
};

/* Rows of the last frame, a plane after the other. */
enum { PLANES = 14 };
static float *rows_of(noc_view *v, size_t n) {
    float *p = noc_calloc(PLANES * n, sizeof(*p));
    assert_non_null(p);
    noc_frame_rows rows = { .rgb = { p, p + n, p + 2 * n },
                            .reflects = { p + 3 * n, p + 4 * n, p + 5 * n },
                            .normal = { p + 6 * n, p + 7 * n, p + 8 * n },
                            .depth = p + 9 * n,
                            .motion = { p + 10 * n, p + 11 * n, p + 12 * n },
                            .what = (uint32_t *)(void *)(p + 13 * n) };
    noc_view_rows(v, &rows);
    return p;
}

static void expect_same_rows(twins *t, const noc_render_params *p, const char *name) {
    size_t n = (size_t)p->width * (size_t)p->height;
    float *a = rows_of(t->cpu, n), *b = rows_of(t->gpu, n);
    if (memcmp(a, b, PLANES * n * sizeof(*a)) != 0)
        fail_msg("%s, frame %u: rows differ", name, t->cpu->history.index);
    free(a);
    free(b);
}

static void views_have_the_same_bits(void **state) {
    static const struct {
        const char *name;
        noc_method method;
        noc_candidates candidates;
        bool map;
        uint32_t without; /* what the plan does not have */
    } rows[] = {
        { "restir", NOC_METHOD_RESTIR, NOC_CANDIDATES_UNIFORM, false, 0 },
        { "ris, power", NOC_METHOD_RIS, NOC_CANDIDATES_POWER, false, 0 },
        { "ris, light-bvh, map", NOC_METHOD_RIS, NOC_CANDIDATES_LIGHT_BVH, true, 0 },
        { "ris, lists", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, 0 },
        { "ris, lists, no rays", NOC_METHOD_RIS, NOC_CANDIDATES_LISTS, false, 0 },
        { "restir, lists", NOC_METHOD_RESTIR, NOC_CANDIDATES_LISTS, false, 0 },
        { "restir, influence", NOC_METHOD_RESTIR, NOC_CANDIDATES_INFLUENCE, false, 0 },
        { "reference", NOC_METHOD_REFERENCE, NOC_CANDIDATES_UNIFORM, false, OF_RESERVOIRS },
        { "headlight", NOC_METHOD_HEADLIGHT, NOC_CANDIDATES_UNIFORM, false, ~(uint32_t)OF_SURFACES },
    };
    noc_camera camera = look(0, -11, 3, 0, 0, 2, 60);
    (void)state;
    if (!has_vulkan(messages))
        skip();
    for (size_t row = 0; row < NOC_COUNT(rows); row++) {
        int car;
        uint32_t told = 0;
        noc_scene *scene = all_kinds(&car);
        noc_image *map = rows[row].map ? bright_map() : NULL;
        twins t;
        if (map)
            assert_int_equal(noc_scene_set_environment(scene, map), NOC_OK);
        noc_image_destroy(map);
        open_twins(scene, true, messages, &t);
        noc_render_params p = all_kinds_params(rows[row].method, rows[row].map);
        p.candidates = rows[row].candidates;
        p.rays = 20;
        p.final_ray = !strstr(rows[row].name, "no rays");
        bool lists = p.candidates == NOC_CANDIDATES_LISTS, finds = lists || p.candidates == NOC_CANDIDATES_INFLUENCE;
        p.aovs = (ALL_VIEWS | (lists ? OF_LISTS : finds ? AOV(LIGHTS) : 0)) & ~rows[row].without;
        for (int f = 0; f < 4; f++) {
            noc_instance in = { 1, { 1.5, 0, 0, -4 + 0.4 * (f / 2), 0, 1.5, 0, -4, 0, 0, 1.5, 0 } };
            if (f == 2)
                assert_int_equal(noc_scene_set_transform(scene, car, in.transform), NOC_OK);
            assert_int_equal(noc_scene_commit(scene), NOC_OK);
            expect_same_frame(&t, &camera, &p, rows[row].name);
            told |= expect_same_views(&t, p.aovs, rows[row].name);
            expect_same_rows(&t, &p, rows[row].name);
        }
        if (p.aovs & ~told)
            fail_msg("%s: views that say nothing: %x", rows[row].name, p.aovs & ~told);
        close_twins(&t);
        noc_scene_destroy(scene);
    }
}

/* Sets all bits of the view's scratch. */
static void fill_scratch(vk_view *v) {
    size_t bytes = (size_t)v->scratch.bytes;
    void *ones = noc_calloc(1, bytes);
    assert_non_null(ones);
    memset(ones, 0xff, bytes);
    assert_int_equal(noc_vk_write(v->device, &v->scratch, 0, ones, bytes), NOC_OK);
    assert_int_equal(noc_vk_wait_idle(v->device), NOC_OK);
    free(ones);
}

/* Over light lists and influence volumes, blocks of sky share work groups with blocks that see the city; scratch holds
 * anything at first. */
static void scratch_may_hold_anything(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("city") : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 2, &camera), NOC_OK);
    open_twins(scene, true, messages, &t);
    noc_render_params p = noc_render_default_params();
    p.width = 64;
    p.height = 32;
    for (int i = 0; i < 2; i++) {
        p.candidates = i ? NOC_CANDIDATES_INFLUENCE : NOC_CANDIDATES_LISTS;
        expect_same_bits(&t, &camera, &p, 1, "scratch as it was");
        fill_scratch(gpu_of(&t));
        expect_same_bits(&t, &camera, &p, 1, "scratch of ones");
    }
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* Walls of a city with their classes; and a picture does not change by the views that are asked for. */
static void pictures_do_not_change_by_views(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("city") : NULL;
    noc_camera camera;
    noc_image *image[2];
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1, &camera), NOC_OK);
    open_twins(scene, true, messages, &t);
    noc_render_params p = all_kinds_params(NOC_METHOD_RESTIR, false);
    for (int i = 0; i < 2; i++) {
        p.aovs = i ? ALL_VIEWS : 0;
        expect_same_bits(&t, &camera, &p, 2, "city");
        image[i] = noc_view_image(t.gpu);
        assert_non_null(image[i]);
    }
    assert_memory_equal(image[0]->rgb, image[1]->rgb, 3 * SIDE * SIDE * sizeof(float));
    assert_int_equal(~expect_same_views(&t, ALL_VIEWS, "city") & (AOV(CLASS) | AOV(OBJECT) | AOV(VARIANCE)), 0);
    p.aovs = 0;
    assert_int_equal(noc_view_render(t.gpu, &camera, &p, NULL), NOC_OK);
    assert_null(noc_view_aov(t.gpu, NOC_AOV_DEPTH)); /* the last frame did not keep it */
    noc_image_destroy(image[0]);
    noc_image_destroy(image[1]);
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* ---- rays ---- */

/* Frames with rays of each machine's own: the pictures agree but for what grazes an edge. */
static void rays_agree(void **state) {
    noc_scene *scene = has_vulkan(messages) ? builtin("mess") : NULL;
    noc_camera camera;
    twins t;
    (void)state;
    if (!scene)
        skip();
    assert_int_equal(noc_scene_camera(scene, NOC_VIEWPOINT_STREET, 1, &camera), NOC_OK);
    open_twins(scene, false, messages, &t);
    noc_render_params p = noc_render_default_params();
    p.width = p.height = 128;
    p.method = NOC_METHOD_RIS;
    p.candidates = NOC_CANDIDATES_UNIFORM;
    assert_int_equal(noc_view_render(t.cpu, &camera, &p, NULL), NOC_OK);
    assert_int_equal(noc_view_render(t.gpu, &camera, &p, NULL), NOC_OK);
    noc_image *a = noc_view_image(t.cpu), *b = noc_view_image(t.gpu);
    double sums[2] = { 0, 0 }, square = 0;
    assert_true(a && b);
    for (int i = 0; i < 3 * 128 * 128; i++) {
        sums[0] += a->rgb[i];
        sums[1] += b->rgb[i];
        square += (a->rgb[i] - b->rgb[i]) * (double)(a->rgb[i] - b->rgb[i]);
    }
    double mean = sums[0] / (3 * 128 * 128);
    print_message("# means differ by %.2g, relative RMSE %.2g\n", sums[1] / sums[0] - 1,
                  sqrt(square / (3 * 128 * 128)) / mean);
    assert_true(fabs(sums[1] / sums[0] - 1) < 1e-3);
    noc_image_destroy(a);
    noc_image_destroy(b);
    close_twins(&t);
    noc_scene_destroy(scene);
}

/* ---- views that render at the same time ---- */

typedef struct {
    noc_view *view;
    noc_camera camera;
    noc_render_params params;
} job;

static void *render_frames(void *user) {
    job *j = user;
    for (int f = 0; f < 4; f++)
        if (noc_view_render(j->view, &j->camera, &j->params, NULL) != NOC_OK)
            return NULL;
    return noc_view_image(j->view);
}

/* Views of one scene in threads of their own have the pictures that each has alone. */
static void views_are_independent(void **state) {
    noc_image *images[4];
    pthread_t threads[2];
    job jobs[2];
    int car;
    (void)state;
    if (!has_vulkan(messages))
        skip();
    noc_device *device = noc_device_create(&(noc_device_params){ .backend = NOC_BACKEND_VULKAN }, messages);
    assert_non_null(device);
    noc_scene *scene = all_kinds(&car);
    for (int i = 0; i < 2; i++) {
        jobs[i] =
            (job){ .camera = look(2 * i, -11, 3, 0, 0, 2, 60), .params = all_kinds_params(NOC_METHOD_RESTIR, false) };
        jobs[i].params.width += 16 * i;
        jobs[i].view = noc_view_create(device, scene);
        images[i] = render_frames(&jobs[i]);
        assert_non_null(images[i]);
        noc_view_reset(jobs[i].view);
    }
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, render_frames, &jobs[i]), 0);
    for (int i = 0; i < 2; i++) {
        void *image;
        pthread_join(threads[i], &image);
        images[2 + i] = image;
        assert_non_null(image);
        assert_memory_equal(images[i]->rgb, images[2 + i]->rgb,
                            3 * sizeof(float) * (size_t)images[i]->width * (size_t)images[i]->height);
        noc_view_destroy(jobs[i].view);
    }
    for (int i = 0; i < 4; i++)
        noc_image_destroy(images[i]);
    noc_scene_destroy(scene);
    noc_device_destroy(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plans_have_the_same_bits),  cmocka_unit_test(all_kinds_have_the_same_bits),
        cmocka_unit_test(views_have_the_same_bits),  cmocka_unit_test(pictures_do_not_change_by_views),
        cmocka_unit_test(scratch_may_hold_anything), cmocka_unit_test(edits_have_the_same_bits),
        cmocka_unit_test(cars_have_the_same_bits),   cmocka_unit_test(rays_agree),
        cmocka_unit_test(views_are_independent),
    };
    messages = noc_log_create(NULL);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(messages);
    return failed;
}
