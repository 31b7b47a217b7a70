/* Several city files read at once: for any number of threads the scene, the report, the messages and their order are
 * those of one after the other, and so is what an error, a limit or a caller that cancels leaves. */
#include "../memory.h"
#include "digest.h"
#include "fake_reader.h"

#include <pthread.h>

static const int threads[] = { 1, 2, 3, 8 };

/* What a load told and left. */
typedef struct outcome {
    noc_status status;
    uint64_t sum;
    size_t files;
    int errors;
    char said[6000];
} outcome;

static void note(void *user, noc_log_level level, const char *text) {
    outcome *o = user;
    o->errors += level == NOC_LOG_ERROR;
    size_t n = strlen(o->said);
    snprintf(o->said + n, sizeof(o->said) - n, "%d %s\n", level, text);
}

static outcome load_by(int count, noc_import_params params, size_t path_count, const char *const *paths) {
    outcome o = { 0 };
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_INFO, .message = note, .user = &o });
    noc_scene *scene = noc_scene_create(log);
    noc_report *report = NULL;
    params.threads = count;
    o.status = load_inputs(scene, fakes, paths, path_count, &params, false, &report);
    o.sum = digest_of(scene, report);
    o.files = noc_report_file_count(report);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return o;
}

/* The same for any number of threads; returns it. */
static outcome load_by_all(noc_import_params params, size_t path_count, const char *const *paths) {
    outcome one = load_by(1, params, path_count, paths);
    assert_int_equal(one.errors, one.status && one.status != NOC_ERR_CANCELLED);
    for (size_t t = 1; t < NOC_COUNT(threads); t++)
        for (int again = 0; again < 10; again++) {
            outcome o = load_by(threads[t], params, path_count, paths);
            assert_int_equal(o.status, one.status);
            assert_string_equal(o.said, one.said);
            assert_int_equal(o.files, one.files);
            if (o.sum != one.sum)
                fail_msg("another scene or report by %d threads", threads[t]);
        }
    return one;
}
#define LOAD_BY_ALL(params, ...) load_by_all(params, PATHS(__VA_ARGS__))

/* Each house has colours, a name and a place of its own. */
#define HOUSE_NO(n) HOUSE_AT("house" #n, "67" #n "00", "67" #n "10", "5404000", "5404010")
#define CRS "crs EPSG:25832\n"
#define SWAPPED                                                                                                        \
    "FAKE city\n" CRS "object 0 s 2\npolygon 1 5404050 678000 370 5404050 678010 370 5404060 678010 380\nend\n"
#define EMPTY "FAKE city\n" CRS

static void scenes_are_the_same(void **state) {
    (void)state;
    const char *a = file("a", "FAKE city\n" CRS HOUSE_NO(80) "lamp 678003 5404023 #1\n" HOUSE_NO(81));
    const char *b = file("b", "FAKE city\n" CRS HOUSE_NO(82) HOUSE_NO(80) HOUSE_NO(82) "lamp 678003 5404023 #1\n");
    const char *c = file("c", "FAKE city\ncrs EPSG:4258\nobject 0 far 2\n"
                              "polygon 1 48.76 11.42 370 48.76 11.4201 370 48.76 11.4201 380\n"
                              "polygon 1 nan nan nan nan nan nan nan nan nan\nend\n");
    const char *d = file("d", "FAKE city\n" CRS HOUSE_NO(83) "lamp 1e30 1e30 #7\n" HOUSE_NO(81));
    const char *lamps = file("l", "FAKE lamps\n" CRS "lamp 678005 5404032 #2\nlamp 678003 5404023 #1\n");
    outcome o = LOAD_BY_ALL(DEFAULTS, a, b, c, d, lamps);
    assert_int_equal(o.status, NOC_OK);
    assert_int_equal(o.files, 5);
    o = LOAD_BY_ALL(DEFAULTS, d, c, b, a);
    assert_int_equal(o.status, NOC_OK);
}

/* Files that settle no place leave it to the next; those behind wait for it, whoever is first at it. */
static void place_is_the_first_files(void **state) {
    (void)state;
    const char *empty = file("empty", EMPTY), *none = file("none", EMPTY "object 0 nothing 2\nend\n");
    const char *west = file("west", "FAKE city\n" CRS HOUSE_NO(78));
    const char *east = file("east", "FAKE city\ncrs EPSG:25833\nobject 0 e 2\n"
                                    "polygon 1 237000 5404000 370 237010 5404000 370 237010 5404000 380\nend\n");
    outcome o = LOAD_BY_ALL(DEFAULTS, empty, none, east, west, empty), p = LOAD_BY_ALL(DEFAULTS, none, west, east);
    assert_int_equal(o.status, NOC_OK);
    assert_int_equal(p.status, NOC_OK);
    assert_true(o.sum != p.sum);
    const char *local = file("local", "FAKE city\ncrs\n" HOUSE_NO(10));
    o = LOAD_BY_ALL(DEFAULTS, west, local, east);
    assert_int_equal(o.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(o.said, "names no CRS"));
}

/* What is larger than is held back goes in parts: objects that are told to be repeated after their first, too. */
static void large_objects_wait_their_turn(void **state) {
    (void)state;
    const char *small = file("small", "FAKE city\n" CRS HOUSE_NO(80));
    const char *large = file("large", "FAKE city\n" CRS "object 1 hill 1\nmany 5 678000 5404100 620000\nend\n");
    const char *again =
        file("again", "FAKE city\n" CRS "object 1 hill 1\nmany 5 678000 5404100 620000\nend\n" HOUSE_NO(84));
    noc_import_params params = DEFAULTS;
    params.max_memory = .2; /* 25 MB of parts may wait: less than one of these has */
    outcome one = load_by(1, params, PATHS(small, large, again)), two = load_by(2, params, PATHS(small, large, again));
    assert_int_equal(one.status, NOC_OK);
    assert_int_equal(two.status, NOC_OK);
    assert_string_equal(one.said, two.said);
    assert_true(one.sum == two.sum);
}

/* The first error in the order of the files ends it; what later files would say is not told. */
static void errors_are_the_first_files(void **state) {
    (void)state;
    const char *good = file("good", "FAKE city\n" CRS HOUSE_NO(80));
    const char *late = file("late", "FAKE city\n" CRS HOUSE_NO(81) "fail\n");
    const char *soon = file("soon", "FAKE city\nfail\n");
    const char *swapped = file("swapped", SWAPPED);
    outcome o = LOAD_BY_ALL(DEFAULTS, good, swapped, late, soon);
    assert_int_equal(o.status, NOC_ERR_FORMAT);
    assert_int_equal(o.files, 3);
    assert_non_null(strstr(o.said, "axes exchanged"));
    assert_non_null(strstr(o.said, "late:1: made to fail"));
    o = LOAD_BY_ALL(DEFAULTS, good, soon, swapped, late);
    assert_int_equal(o.files, 2);
    assert_null(strstr(o.said, "axes exchanged"));
    assert_non_null(strstr(o.said, "soon:1: made to fail"));
    o = LOAD_BY_ALL(DEFAULTS, soon, swapped);
    assert_int_equal(o.files, 1);
}

static void limits_are_the_same(void **state) {
    (void)state;
    const char *a = file("a", "FAKE city\n" CRS "object 1 hill 1\nmany 5 678000 5404100 100000\nend\n");
    const char *b = file("b", "FAKE city\n" CRS "object 1 dale 1\nmany 5 678000 5405100 100000\nend\n");
    noc_import_params params = DEFAULTS;
    params.max_memory = .01;
    outcome one = load_by(1, params, PATHS(a, b)), two = load_by(2, params, PATHS(a, b));
    assert_int_equal(one.status, NOC_ERR_MEMORY);
    assert_int_equal(two.status, NOC_ERR_MEMORY);
    assert_non_null(strstr(one.said, "--max-memory"));
    assert_string_equal(one.said, two.said);
    static const int wrong[] = { -1, 1025 };
    for (size_t i = 0; i < NOC_COUNT(wrong); i++) {
        outcome o = load_by(wrong[i], DEFAULTS, PATHS(a, b));
        assert_int_equal(o.status, NOC_ERR_ARGUMENT);
        assert_non_null(strstr(o.said, "threads is "));
        assert_non_null(strstr(o.said, "must be in 0..1024"));
    }
}

/* Before their turn all readers together hold a quarter of what one may. */
static void readers_ahead_share_memory(void **state) {
    (void)state;
    noc_import_params params = DEFAULTS;
    params.max_memory = .2; /* 50 MB ahead: one of these */
    const char *paths[6];
    for (int i = 0; i < 6; i++) {
        char name[2] = { (char)('a' + i), 0 };
        paths[i] = file(name, i % 2 ? "FAKE city\n" CRS HOUSE_NO(80) "hold 40e6\n" HOUSE_NO(81)
                                    : "FAKE city\n" CRS HOUSE_NO(80) "hold 40e6\n");
        FILE *f = fopen(paths[i], "a"); /* no copies of each other */
        fprintf(f, "#%d\n", i);
        fclose(f);
    }
    outcome one = load_by(1, params, 6, paths);
    assert_int_equal(one.status, NOC_OK);
    assert_int_equal(atomic_load(&most_holding), 1);
    outcome eight = load_by(8, params, 6, paths);
    assert_true(eight.sum == one.sum);
    assert_in_range(atomic_load(&most_holding), 1, 2); /* with the one whose turn it is */
}

typedef struct asked {
    pthread_t by;
    int left;
    double last;
} asked;

static bool ask(void *user, const char *what, double done) {
    asked *a = user;
    (void)what;
    assert_true(pthread_equal(pthread_self(), a->by)); /* the thread that loads */
    assert_true(done >= a->last && done <= 1);
    a->last = done;
    return a->left-- != 0;
}

static void cancelled_at_any_time(void **state) {
    (void)state;
    const char *paths[] = { file("a", "FAKE city\n" CRS "slow\n" HOUSE_NO(80) "slow\n"),
                            file("b", "FAKE city\n" CRS "slow\n" HOUSE_NO(81) "slow\n"),
                            file("c", "FAKE city\n" CRS HOUSE_NO(82) "slow\n") };
    bool went_through = false;
    for (int n = 0; n < 200 && !went_through; n++)
        for (size_t t = 0; t < NOC_COUNT(threads); t++) {
            asked a = { pthread_self(), n, 0 };
            noc_import_params params = DEFAULTS;
            params.progress = (noc_progress){ ask, &a };
            outcome o = load_by(threads[t], params, NOC_COUNT(paths), paths);
            assert_int_equal(o.errors, 0);
            assert_true(o.status == NOC_OK || o.status == NOC_ERR_CANCELLED);
            assert_int_equal(o.status == NOC_ERR_CANCELLED, a.left < 0);
            went_through = went_through || (o.status == NOC_OK && t == 0);
        }
    assert_true(went_through);
}

/* Memory that is refused to any thread is one error, or changes nothing. */
static void refused_memory(void **state) {
    (void)state;
    const char *paths[] = { file("a", "FAKE city\n" CRS HOUSE_NO(80) "lamp 678003 5404023 #1\n"),
                            file("b", "FAKE city\n" CRS HOUSE_NO(81) HOUSE_NO(80)),
                            file("c", "FAKE city\n" CRS HOUSE_NO(82) "lamp 678023 5404033 #1\n"), file("d", SWAPPED) };
    outcome whole = load_by(2, DEFAULTS, NOC_COUNT(paths), paths);
    assert_int_equal(whole.status, NOC_OK);
    for (int later = 0; later < 2; later++) {
        size_t refused = 0, fine = 0;
        for (uint64_t n = 1; fine < 20; n++) {
            outcome o = { 0 };
            noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_INFO, .message = note, .user = &o });
            noc_scene *scene = noc_scene_create(log);
            noc_report *report = NULL;
            noc_import_params params = DEFAULTS;
            params.threads = 2;
            noc_refuse_allocation(n, later);
            o.status = load_inputs(scene, fakes, paths, NOC_COUNT(paths), &params, false, &report);
            bool reached = noc_allocations() >= n;
            noc_refuse_allocation(0, false);
            if (o.status == NOC_OK && (digest_of(scene, report) != whole.sum || strcmp(o.said, whole.said)))
                fail_msg("allocation %d refused: another scene, or not all said", (int)n);
            if (o.status != NOC_OK && (o.status != NOC_ERR_MEMORY || o.errors != 1))
                fail_msg("allocation %d refused: status %d, %d errors: %s", (int)n, o.status, o.errors, o.said);
            refused += o.status != NOC_OK;
            fine += !reached;
            noc_report_destroy(report);
            noc_scene_destroy(scene);
            noc_log_destroy(log);
        }
        assert_true(refused > 50);
    }
}

/* What waits holds nothing of the file's reading, which may end before. */
static void copies_hold_their_own(void **state) {
    (void)state;
    char image[] = "brick.png", name[] = "brick", id[] = "house";
    double xyz[9] = { 1, 2, 3, 4, 5, 6, 7, 8, 9 };
    uint32_t indices[3] = { 0, 1, 2 };
    float uv[6] = { 0 };
    surface_look look = { .as = { .name = name, .albedo = { 1, 0, 0 } }, .image = image };
    part_surface surface = { NOC_CLASS_WALL, 3, 1, xyz, indices, uv, &look };
    load_part part = { .kind = PART_OBJECT, .u.object = { .id = id, .surfaces = &surface, .surface_count = 1 } };
    noc_arena arena = { 0 };
    const load_part copy = part_copied(&arena, part);
    memset(image, 'x', sizeof(image) - 1);
    memset(name, 'x', sizeof(name) - 1);
    memset(id, 'x', sizeof(id) - 1);
    memset(xyz, 0, sizeof(xyz));
    memset(indices, 0, sizeof(indices));
    memset(&look, 0, sizeof(look));
    memset(&surface, 0, sizeof(surface));
    const part_surface *s = copy.u.object.surfaces;
    assert_string_equal(copy.u.object.id, "house");
    assert_true(s->vertex_count == 3 && s->xyz[8] == 9 && s->indices[2] == 2 && s->uv && s->uv != uv);
    assert_string_equal(s->look->image, "brick.png");
    assert_string_equal(s->look->as.name, "brick");
    assert_true(s->look->as.albedo[0] == 1);
    arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_are_the_same),           cmocka_unit_test(place_is_the_first_files),
        cmocka_unit_test(large_objects_wait_their_turn), cmocka_unit_test(errors_are_the_first_files),
        cmocka_unit_test(limits_are_the_same),           cmocka_unit_test(readers_ahead_share_memory),
        cmocka_unit_test(cancelled_at_any_time),         cmocka_unit_test(refused_memory),
        cmocka_unit_test(copies_hold_their_own),
    };
    return cmocka_run_group_tests_name("import/at_once", tests, make_folder, remove_folder);
}
