/* Many views of one world: from several threads, each with its own size, camera, options and history, while the scene
 * is edited. What they give is what each gives alone. */
#include "render/device.h"
#include "rooms.h"

#include <stdatomic.h>
#include <unistd.h>

enum { VIEWS = 5, FRAMES = 6, LAMPS = 60 };

static noc_scene *street(void) {
    noc_scene *s = noc_scene_create(NULL);
    int grey = matte(s, 0.5f);
    add_floor(s, grey, 0, 0, 0, 20);
    for (int i = -3; i <= 3; i++)
        QUAD(s, grey, 2 * i, 1, 0, 1, 0, 0, 0, 0, 3);
    for (int i = 0; i < LAMPS; i++)
        assert_true(noc_scene_add_light(s, &(noc_light){ .kind = NOC_LIGHT_SPHERE,
                                                         .radius = 0.1,
                                                         .emission = { 90, 80 + i % 9, 60 },
                                                         .position = { i % 10 - 5, i / 10 - 3, 3 } }) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    return s;
}

typedef struct looker {
    noc_device *device;
    const noc_scene *scene;
    noc_render_params params;
    noc_camera camera;
    noc_image *image;
    noc_status status;
    double build_seconds;
} looker;

static void describe(looker *l, int i) {
    static const noc_candidates from[VIEWS] = { NOC_CANDIDATES_LISTS, NOC_CANDIDATES_INFLUENCE, NOC_CANDIDATES_POWER,
                                                NOC_CANDIDATES_LIGHT_BVH, NOC_CANDIDATES_INFLUENCE };
    l->params = measure(50 + 13 * i, 40 + 7 * i, i % 2 ? NOC_METHOD_RESTIR : NOC_METHOD_RIS);
    l->params.candidates = from[i];
    l->params.influence = i == 4 ? 0.5 : 0; /* other volumes than the ones that view 1 asks for */
    l->params.influence_cluster = i == 4 ? 4 : 1;
    l->params.seed = (uint32_t)i + 1;
    l->camera = look(2 + i, -9, 3 + 0.3 * i, 0, 0, 0.5, 60);
}

static void *render_view(void *arg) {
    looker *l = arg;
    noc_view *v = noc_view_create(l->device, l->scene);
    l->status = v ? NOC_OK : NOC_ERR_MEMORY;
    for (int f = 0; f < FRAMES && !l->status; f++)
        l->status = noc_view_render(v, &l->camera, &l->params, NULL);
    l->image = l->status ? NULL : noc_view_image(v);
    noc_frame_stats stats = { 0 };
    noc_view_get_stats(v, &stats);
    l->build_seconds = stats.build_seconds;
    noc_view_destroy(v);
    return NULL;
}

static bool equal(const noc_image *a, const noc_image *b) {
    return a->width == b->width && a->height == b->height &&
           !memcmp(a->rgb, b->rgb, sizeof(float) * 3 * (size_t)a->width * a->height);
}

/* All of them at once on a device of so many threads, each against itself alone. */
static void at_once(const noc_scene *s, int threads) {
    noc_device *device = own_device(threads, NULL);
    noc_view *first = noc_view_create(device, s);
    looker all[VIEWS] = { 0 };
    pthread_t thread[VIEWS];
    assert_non_null(first);
    for (int i = 0; i < VIEWS; i++) {
        all[i] = (looker){ .device = device, .scene = s };
        describe(&all[i], i);
        assert_int_equal(pthread_create(&thread[i], NULL, render_view, &all[i]), 0);
    }
    noc_frame_stats stats;
    noc_view_get_stats(first, &stats);
    for (int i = 0; i < VIEWS; i++) {
        pthread_join(thread[i], NULL);
        assert_int_equal(all[i].status, NOC_OK);
        assert_true(all[i].build_seconds == stats.build_seconds); /* built once: to the last bit of its time */
        noc_image *alone = render(s, &all[i].camera, &all[i].params, FRAMES);
        assert_true(equal(alone, all[i].image));
        noc_image_destroy(alone);
        noc_image_destroy(all[i].image);
    }
    noc_view_destroy(first);
    noc_device_destroy(device);
}

static void views_are_independent(void **state) {
    (void)state;
    noc_scene *s = street();
    at_once(s, 1);
    at_once(s, 3);
    noc_scene_destroy(s);
}

/* A device holds worlds of several scenes, and lets go of each with its last view. */
static void worlds_go_with_their_last_view(void **state) {
    (void)state;
    noc_device *device = own_device(2, NULL);
    for (int round = 0; round < 3; round++) {
        noc_scene *s[2] = { street(), street() };
        noc_view *v[4];
        looker l = { 0 };
        describe(&l, 0);
        for (int i = 0; i < 4; i++) {
            v[i] = noc_view_create(device, s[i % 2]);
            assert_int_equal(noc_view_render(v[i], &l.camera, &l.params, NULL), NOC_OK);
            assert_ptr_equal(noc_view_device(v[i]), device);
        }
        noc_view_destroy(v[0]);
        assert_int_equal(noc_view_render(v[2], &l.camera, &l.params, NULL), NOC_OK);
        for (int i = 1; i < 4; i++)
            noc_view_destroy(v[i]);
        noc_scene_destroy(s[0]);
        noc_scene_destroy(s[1]);
    }
    noc_device_destroy(device);
}

typedef struct editor {
    noc_scene *scene;
    int commits; /* 0: until it is told to stop */
    atomic_bool stop;
    bool failed;
} editor;

/* Each commit dims or brightens every second lamp, and moves on. */
static void *edit(void *arg) {
    editor *e = arg;
    for (int i = 0; (e->commits ? i < e->commits : !e->stop) && !e->failed; i++) {
        float on = i % 2 ? 90 : 5;
        for (int k = 0; k < LAMPS; k += 2)
            e->failed = e->failed || noc_scene_set_emission(e->scene, k, (float[3]){ on, on, on });
        e->failed = e->failed || noc_scene_commit(e->scene);
    }
    return NULL;
}

/* Frames see the scene before a commit, or after it, and never one in the making: of the reference method, which keeps
 * nothing, every frame is one of two. */
static void frames_and_commits_do_not_mix(void **state) {
    (void)state;
    noc_scene *s = street();
    looker l = { .scene = s };
    describe(&l, 0);
    l.params.method = NOC_METHOD_REFERENCE;
    l.params.rays = 16;
    l.params.accumulate = false;
    noc_image *is[2];
    for (int i = 0; i < 2; i++) {
        editor e = { .scene = s, .commits = i + 1 };
        edit(&e);
        assert_false(e.failed);
        is[i] = render(s, &l.camera, &l.params, 1);
    }
    noc_view *v = own_view(s, 2, NULL);
    editor e = { .scene = s };
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, edit, &e), 0);
    int seen[2] = { 0 };
    for (int f = 0; f <= 20 || !seen[0] || !seen[1]; f++) {
        noc_view_reset(v); /* frame 0 again: the same random numbers */
        assert_int_equal(noc_view_render(v, &l.camera, &l.params, NULL), NOC_OK);
        noc_image *image = noc_view_image(v);
        bool dark = equal(image, is[0]), bright = equal(image, is[1]);
        assert_true(dark != bright);
        seen[bright]++;
        noc_image_destroy(image);
    }
    e.stop = true;
    pthread_join(thread, NULL);
    assert_false(e.failed);
    assert_true(seen[0] && seen[1]);
    print_message("# %d dark frames, %d bright ones\n", seen[0], seen[1]);
    close_view(v);
    noc_image_destroy(is[0]);
    noc_image_destroy(is[1]);
    noc_scene_destroy(s);
}

enum { VISITS = 10 };
typedef struct visitor {
    noc_device *device;
    const noc_scene *scene;
    atomic_bool *stop;
    atomic_int made;
    int refused;
} visitor;

/* Comes to look, and goes. */
static void *visit(void *arg) {
    visitor *v = arg;
    while (!*v->stop && !v->refused) {
        noc_view *view = noc_view_create(v->device, v->scene);
        v->refused += !view;
        v->made += view ? 1 : VISITS;
        noc_view_destroy(view);
    }
    return NULL;
}

/* Any thread may make a view while another one commits: ThreadSanitizer sees what it does not wait for. */
static void views_are_made_beside_commits(void **state) {
    enum { VISITORS = 2 };
    (void)state;
    noc_scene *s = street();
    noc_device *device = own_device(2, NULL);
    atomic_bool stop = false;
    visitor all[VISITORS] = { 0 };
    pthread_t thread[VISITORS];
    for (int i = 0; i < VISITORS; i++) {
        all[i].device = device;
        all[i].scene = s;
        all[i].stop = &stop;
        assert_int_equal(pthread_create(&thread[i], NULL, visit, &all[i]), 0);
    }
    editor e = { .scene = s, .commits = 2 };
    while (!e.failed && (all[0].made < VISITS || all[1].made < VISITS)) {
        edit(&e);
        usleep(1000); /* commits that follow each other at once let nobody in */
    }
    stop = true;
    for (int i = 0; i < VISITORS; i++) {
        pthread_join(thread[i], NULL);
        assert_int_equal(all[i].refused, 0);
    }
    assert_false(e.failed);
    noc_device_destroy(device);
    noc_scene_destroy(s);
}

static double bytes_a_pixel(noc_view *v) {
    noc_camera camera = look(0, -8, 3, 0, 0, 1, 60);
    noc_frame_stats stats[2];
    for (int i = 0; i < 2; i++) {
        noc_render_params p = measure(64, 64 << i, NOC_METHOD_IS);
        assert_int_equal(noc_view_render(v, &camera, &p, NULL), NOC_OK);
        noc_view_get_stats(v, &stats[i]);
    }
    return ((double)stats[1].memory_bytes - (double)stats[0].memory_bytes) / (64 * 64);
}

/* Each pixel keeps which instance it sees, once a scene has some. */
static void instances_take_memory(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_view *v = own_view(s, 1, NULL);
    double without = bytes_a_pixel(v);
    noc_mesh mesh = { .vertex_count = 3,
                      .positions = (double[]){ 0, 0, 0, 1, 0, 0, 0, 0, 1 },
                      .triangle_count = 1,
                      .indices = (uint32_t[]){ 0, 1, 2 },
                      .material = 0,
                      .model = noc_scene_add_model(s, "sign") };
    noc_instance sign = { .model = mesh.model, .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
    assert_true(noc_scene_add_mesh(s, &mesh) >= 0 && noc_scene_add_instance(s, &sign) >= 0);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    double with = bytes_a_pixel(v);
    print_message("# %.2f bytes a pixel, %.2f with instances\n", without, with);
    assert_true(with - without == sizeof(uint32_t));
    close_view(v);
    noc_scene_destroy(s);
}

/* A commit that is asked for while the rays of a frame are traced again. */
static struct {
    editor editor;
    pthread_t thread;
    atomic_bool committed;
    bool early; /* it did not wait */
} late;

static void *edit_late(void *arg) {
    edit(&late.editor);
    late.committed = true;
    return arg;
}

static noc_status replay_beside_a_commit(void *view, const noc_progress *progress, noc_trace_floor *floor) {
    assert_int_equal(pthread_create(&late.thread, NULL, edit_late, NULL), 0);
    for (int i = 0; i < 100 && !late.committed; i++)
        usleep(1000);
    late.early = late.committed;
    return noc_backend_embree.replay(view, progress, floor);
}

/* The trace floor's rays are traced through the structure of their frame. */
static void rays_are_replayed_before_a_commit(void **state) {
    (void)state;
    noc_scene *s = street();
    noc_backend backend = noc_backend_embree;
    noc_device *device = own_device(2, NULL);
    backend.replay = replay_beside_a_commit;
    device->backend = &backend;
    noc_view *v = noc_view_create(device, s);
    looker l = { 0 };
    noc_trace_floor floor = { 0 };
    describe(&l, 0);
    late.editor = (editor){ .scene = s, .commits = 1 };
    assert_int_equal(noc_view_trace_floor(v, &l.camera, &l.params, NULL, &floor), NOC_OK);
    pthread_join(late.thread, NULL);
    assert_false(late.early);
    assert_true(late.committed && !late.editor.failed && floor.wall_seconds > 0);
    assert_int_equal(noc_view_render(v, &l.camera, &l.params, NULL), NOC_OK); /* the lock is free again */
    noc_view_destroy(v);
    noc_device_destroy(device);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_are_independent),         cmocka_unit_test(worlds_go_with_their_last_view),
        cmocka_unit_test(frames_and_commits_do_not_mix), cmocka_unit_test(views_are_made_beside_commits),
        cmocka_unit_test(instances_take_memory),         cmocka_unit_test(rays_are_replayed_before_a_commit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
