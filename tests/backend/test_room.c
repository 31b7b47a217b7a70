/* Limits of memory, from none to one that is enough: a renderer and its frame are made, or the library says that it had
 * no memory. */
#include "../own_view.h"
#include "../test.h"

#include "base/base.h"

#include <dlfcn.h>
#include <errno.h>
#include <nocturne/import.h>
#include <nocturne/nocturne.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>

#define REQUIRE_LIMITS()                                                                                               \
    if (SANITIZED) {                                                                                                   \
        print_message("# skipped: AddressSanitizer needs address space without end\n");                                \
        skip();                                                                                                        \
    }

#if !SANITIZED
/* Takes the place of the system's for all that is linked: TBB ends the process where it can start no thread. */
static bool no_threads;

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument) {
    int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    *(void **)&real = dlsym(RTLD_NEXT, "pthread_create");
    return no_threads || !real ? EAGAIN : real(thread, attributes, start, argument);
}
#endif

enum { MADE = 40, REFUSED = 41, SILENT = 42, OTHER = 43 };

static void drop(void *user, noc_log_level level, const char *text) {}

static int outcome(noc_status status, const noc_log *log) {
    const char *text = noc_log_last_error(log);
    if (status == NOC_OK)
        return MADE;
    if (status == NOC_ERR_MEMORY)
        return strstr(text, "memory") ? REFUSED : SILENT;
    fprintf(stderr, "# %s\n", text);
    return OTHER;
}

/* Address space of this process, bytes. */
static size_t address_space(void) {
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    assert_non_null(f);
    assert_int_equal(fscanf(f, "%lu", &pages), 1);
    fclose(f);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* What becomes of work in a child that may take so much more than it has. */
static int limited(size_t more, noc_status (*work)(noc_scene *scene, noc_log *log), noc_scene *scene) {
    fflush(stdout);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (!pid) {
        struct rlimit limit = { address_space() + more, address_space() + more }, none = { 0 };
        noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
        setrlimit(RLIMIT_CORE, &none);
        alarm(300); /* one that hangs ends by a signal too */
        _exit(!log || setrlimit(RLIMIT_AS, &limit) ? OTHER : outcome(work(scene, log), log));
    }
    int status = 0;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (!WIFEXITED(status))
        fail_msg("%zu kB more: ended by signal %d", more >> 10, WTERMSIG(status));
    if (WEXITSTATUS(status) != MADE && WEXITSTATUS(status) != REFUSED)
        fail_msg("%zu kB more: exit status %d", more >> 10, WEXITSTATUS(status));
    return WEXITSTATUS(status);
}

/* Every limit from none to `most`, so far apart: refused at first, made where there is more than enough (stacks and
 * arenas of all threads take 70 MB each, or less, as they come to need them). */
static void sweep(size_t most, size_t step, noc_status (*work)(noc_scene *scene, noc_log *log), noc_scene *scene) {
    assert_int_equal(limited(0, work, scene), REFUSED);
    for (size_t more = step; more < most; more += step)
        limited(more, work, scene);
    assert_int_equal(limited((size_t)1 << 30, work, scene), MADE);
}

/* A city, or, quicker, as many triangles in a plane. */
static noc_scene *make(bool city, noc_log *log) {
    enum { SIDE = 100 };
    static const double corners[4][2] = { { 0, 0 }, { 0.9, 0 }, { 0.9, 0.9 }, { 0, 0.9 } };
    noc_scene *scene = noc_scene_create(log);
    noc_builtin_params params = noc_builtin_default_params();
    noc_light lamp = { .kind = NOC_LIGHT_SPHERE, .position = { 50, 50, 5 }, .radius = 0.1, .emission = { 1, 1, 1 } };
    noc_material grey = { .albedo = { 0.5f, 0.5f, 0.5f }, .roughness = 1 };
    params.city.size = 150;
    bool ok = scene && (!city || noc_scene_add_builtin(scene, "city", &params) == NOC_OK) &&
              noc_scene_add_material(scene, &grey) >= 0 && noc_scene_add_light(scene, &lamp) >= 0;
    for (int i = 0; ok && !city && i < SIDE * SIDE; i++) {
        double xyz[12] = { 0 };
        for (int k = 0; k < 4; k++) {
            xyz[3 * k] = i / SIDE + corners[k][0];
            xyz[3 * k + 1] = i % SIDE + corners[k][1];
        }
        ok = noc_scene_add_mesh(scene, &(noc_mesh){ .vertex_count = 4,
                                                    .positions = xyz,
                                                    .triangle_count = 2,
                                                    .indices = (uint32_t[]){ 0, 1, 2, 0, 2, 3 },
                                                    .material = 0 }) >= 0;
    }
    if (ok && noc_scene_commit(scene) == NOC_OK)
        return scene;
    noc_scene_destroy(scene);
    return NULL;
}

static noc_status draw(noc_scene *scene, noc_log *log) {
    noc_render_params p = noc_render_default_params();
    noc_camera camera;
    p.width = 64;
    p.height = 48;
    noc_view *r = own_view(scene, 4, log);
    if (!r)
        return NOC_ERR_MEMORY;
    noc_status status = noc_scene_camera(scene, NOC_VIEWPOINT_OVERVIEW, 4.0 / 3, &camera);
    status = status ? status : noc_view_render(r, &camera, &p, NULL);
    close_view(r);
    return status;
}

/* Finely, as what ends a process in TBB does so between one limit and the next (std::bad_alloc, missing_wait). */
static void test_renderer(void **state) {
    REQUIRE_LIMITS();
    noc_scene *scene = make(false, NULL);
    assert_non_null(scene);
    sweep((size_t)192 << 20, (size_t)3 << 19, draw, scene);
    noc_scene_destroy(scene);
}

/* ulimit -u, which root does not have. */
static void test_no_threads(void **state) {
#if SANITIZED
    print_message("# skipped: sanitizers have a pthread_create of their own\n");
    skip();
#else
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR, .message = drop });
    noc_scene *scene = make(false, NULL);
    assert_non_null(scene);
    no_threads = true;
    noc_status status = draw(scene, log);
    no_threads = false;
    assert_int_equal(status, NOC_ERR_MEMORY);
    assert_non_null(strstr(noc_log_last_error(log), "ulimit -u"));
    assert_int_equal(draw(scene, log), NOC_OK); /* and is as it was */
    noc_scene_destroy(scene);
    noc_log_destroy(log);
#endif
}

static noc_status build_and_draw(noc_scene *none, noc_log *log) {
    noc_scene *scene = make(true, log);
    noc_status status = scene ? draw(scene, log) : NOC_ERR_MEMORY;
    noc_scene_destroy(scene);
    return status;
}

static void test_all(void **state) {
    REQUIRE_LIMITS();
    sweep((size_t)320 << 20, (size_t)20 << 20, build_and_draw, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_renderer), cmocka_unit_test(test_no_threads),
                                        cmocka_unit_test(test_all) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
