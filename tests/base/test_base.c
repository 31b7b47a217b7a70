#include "../test.h"
#include "base/base.h"
#include <sched.h>
#include <stdatomic.h>

/* Bit for bit what strtod says, whichever way the number goes. */
static void test_numbers_of_all_lengths(void **state) {
    static const char *const ends[] = { "", ".", "e-7" };
    uint64_t seed = 1;
    for (int i = 0; i < 200000; i++) {
        char text[64], behind[80];
        size_t n = 0, dot, digits;
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        digits = 1 + (seed >> 33) % 22;
        dot = (seed >> 40) % 24;
        if (seed >> 50 & 3)
            text[n++] = seed >> 51 & 1 ? '-' : '+';
        for (size_t k = 0; k < digits; k++) {
            if (k == dot)
                text[n++] = '.';
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            text[n++] = (char)('0' + (seed >> 60) % 10);
        }
        snprintf(text + n, sizeof(text) - n, "%s", ends[dot < digits ? 2 * ((seed >> 20) % 2) : (seed >> 20) % 3]);
        double expected = strtod(text, NULL), parsed, scanned;
        assert_true(noc_parse_double(text, &parsed));
        int length = snprintf(behind, sizeof(behind), " \t%s 7", text);
        const char *stop = noc_scan_double(behind, behind + length, &scanned);
        assert_ptr_equal(stop, behind + length - 2);
        assert_memory_equal(&parsed, &expected, sizeof(expected));
        assert_memory_equal(&scanned, &expected, sizeof(expected));
        stop = noc_scan_double(text, text + strlen(text), &scanned); /* up to the end */
        assert_ptr_equal(stop, text + strlen(text));
        assert_memory_equal(&scanned, &expected, sizeof(expected));
    }
    double d;
    static const char *const none[] = { ".", "-", "+", "-.", "1.2.3", "1,5", "1a", "--1", "1-" };
    for (size_t i = 0; i < NOC_COUNT(none); i++) {
        assert_false(noc_parse_double(none[i], &d));
        assert_null(noc_scan_double(none[i], none[i] + strlen(none[i]), &d));
    }
}

static void numbers(void **state) {
    double d = 0;
    assert_true(noc_parse_double(" 678031.705 ", &d));
    assert_true(d == 678031.705);
    assert_true(noc_parse_double("-1.5e3", &d));
    assert_true(d == -1500);
    assert_true(noc_parse_double("0.1234567890123456789", &d));
    assert_true(d == 0.1234567890123456789);
    const char *bad[] = { "", " ", "abc", "1,5", "1 2", "nan", "inf", "0x10", "1e999", "-", ".", "1.2.3" };
    for (size_t i = 0; i < NOC_COUNT(bad); i++)
        assert_false(noc_parse_double(bad[i], &d));
    const char *list = "1 2.5\n-3 ", *s = list, *end = list + strlen(list);
    double expected[] = { 1, 2.5, -3 };
    for (int i = 0; i < 3; i++) {
        s = noc_scan_double(s, end, &d);
        assert_non_null(s);
        assert_true(d == expected[i]);
    }
    assert_null(noc_scan_double(s, end, &d));
    long long n = 0;
    assert_true(noc_parse_int("42", &n) && n == 42);
    assert_false(noc_parse_int("4.2", &n));
    assert_false(noc_parse_int("99999999999999999999", &n));
    assert_true(noc_ieq("LED", "led") && !noc_ieq("LED", "LE") && !noc_ieq(NULL, NULL));
}

static void arrays_and_maps(void **state) {
    NOC_ARRAY(int) a = { 0 };
    for (int i = 0; i < 1000; i++)
        assert_true(array_push(&a, i));
    assert_int_equal(a.len, 1000);
    assert_int_equal(a.data[777], 777);
    array_free(&a);
    noc_map map = { 0 };
    bool fresh;
    char key[32];
    for (int i = 0; i < 5000; i++) {
        snprintf(key, sizeof(key), "id_%d", i);
        assert_true(map_put(&map, key, (uint64_t)i, &fresh) && fresh);
    }
    assert_true(map_put(&map, "id_7", 70, &fresh) && !fresh);
    uint64_t v = 0;
    assert_true(map_get(&map, "id_4999", &v) && v == 4999);
    assert_true(map_get(&map, "id_7", &v) && v == 70);
    assert_false(map_get(&map, "nothing", &v));
    map_free(&map);
    assert_null(noc_alloc_large(SIZE_MAX / 2, 4));
}

/* CPython 3.11 and later hash bytes with SipHash-1-3; PYTHONHASHSEED=0 makes the key zero:
 * PYTHONHASHSEED=0 python3 -c 'print(hex(hash(b"abcdefg") & (2**64 - 1)))' */
static void siphash_is_as_published(void **state) {
    static const struct {
        const char *text;
        uint64_t hash;
    } known[] = { { "a", 0x407448d2b89b1813u },
                  { "abcdefg", 0x6db12aae9070f506u },
                  { "abcdefgh", 0x3f7b849c0b8e35eau },
                  { "gml_id_0123456789abcdef", 0xf95c63219c1929d2u } };
    for (size_t i = 0; i < NOC_COUNT(known); i++)
        assert_true(base_siphash(known[i].text, strlen(known[i].text), (uint64_t[2]){ 0, 0 }) == known[i].hash);
    assert_true(base_siphash("a", 1, (uint64_t[2]){ 1, 0 }) != known[0].hash);
    assert_true(base_siphash("a", 1, (uint64_t[2]){ 0, 1 }) != known[0].hash);
}

static uint32_t fnv(uint32_t h, uint32_t block) {
    for (int i = 0; i < 8; i++)
        h = (h ^ ('a' + (block >> 4 * i & 15))) * 16777619u;
    return h;
}

static int by_number(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* 2^16 ids with one FNV-1a hash, which the map had once: 16 blocks, each of which may be either of two that collide
 * (Joux 2004). They must lie as far apart as any others. */
static void colliding_ids_do_not_flood(void **state) {
    enum { BLOCKS = 16, TRIES = 1 << 18 };
    static uint64_t tried[TRIES];
    uint32_t pair[BLOCKS][2], h = 2166136261u;
    for (int b = 0; b < BLOCKS; b++) {
        for (uint32_t i = 0; i < TRIES; i++)
            tried[i] = (uint64_t)fnv(h, i * 2654435761u) << 32 | i * 2654435761u;
        qsort(tried, TRIES, sizeof(*tried), by_number);
        size_t at = 1;
        while (at < TRIES && tried[at] >> 32 != tried[at - 1] >> 32)
            at++;
        assert_true(at < TRIES);
        pair[b][0] = (uint32_t)tried[at - 1];
        pair[b][1] = (uint32_t)tried[at];
        h = (uint32_t)(tried[at] >> 32);
    }
    noc_map map = { 0 };
    for (uint32_t id = 0; id < 1u << BLOCKS; id++) {
        char key[8 * BLOCKS + 1] = { 0 };
        for (int b = 0; b < BLOCKS; b++)
            for (int i = 0; i < 8; i++)
                key[8 * b + i] = (char)('a' + (pair[b][id >> b & 1] >> 4 * i & 15));
        assert_true(map_put(&map, key, id, NULL));
        assert_true(id % 4096 || map_longest_probe(&map) < 1000);
    }
    assert_int_equal(map.len, 1 << BLOCKS);
    assert_true(map_longest_probe(&map) < 1000); /* of 65,535 where all collide */
    map_free(&map);
}

static void count_item(void *ctx, size_t item, int worker) {
    atomic_int *hits = ctx;
    atomic_fetch_add(&hits[item], 1);
}

/* One use of each way to allocate; returns whether all went well. What was there before a refusal must be there still.
 */
static bool allocate_in_all_ways(void) {
    NOC_ARRAY(int) a = { 0 };
    noc_arena arena = { 0 };
    noc_map map = { 0 };
    bool fresh = false, ok = array_push(&a, 7) && array_reserve(&a, 20) && array_append(&a, a.data, 1);
    assert_true(!ok || (a.len == 2 && a.data[1] == 7));
    void *p[] = { noc_alloc(3),        noc_calloc(2, 3),      noc_strdup("text"), noc_strndup("text", 2),
                  noc_format("%d", 5), noc_alloc_large(2, 3), noc_pool_create(1), noc_log_create(NULL) };
    for (size_t i = 0; i < NOC_COUNT(p); i++)
        ok = ok && p[i];
    assert_true(!ok || !strcmp(p[3], "te"));
    char *grown = p[2] ? noc_realloc(p[2], 100) : NULL;
    ok = ok && grown;
    p[2] = grown ? grown : p[2];
    assert_true(!p[2] || !strcmp(p[2], "text"));
    char *texts[] = { arena_strdup(&arena, "a"), arena_strndup(&arena, "ab", 1), arena_format(&arena, "%s", "a"),
                      arena_alloc(&arena, 1 << 17) };
    for (size_t i = 0; i < NOC_COUNT(texts); i++) {
        assert_true(texts[i] || arena.refused);
        assert_true(!texts[i] || i == 3 || !strcmp(texts[i], "a"));
    }
    ok = ok && !arena.refused && map_put(&map, "key", 1, &fresh) && fresh && map_put(&map, "key", 2, &fresh) && !fresh;
    uint64_t value = 0;
    assert_true(!map_get(&map, "key", &value) == !map.len && (!ok || value == 2));
    noc_pool_destroy(p[6]);
    noc_log_destroy(p[7]);
    for (size_t i = 0; i < 6; i++)
        free(p[i]);
    array_free(&a);
    arena_free(&arena);
    map_free(&map);
    return ok;
}

/* Under AddressSanitizer what lies behind an arena's item or a small array is forbidden: make asan. */
#if ADDRESS_SANITIZED
#include <sanitizer/asan_interface.h>
static void memory_has_no_room_to_spare(void **state) {
    (void)state;
    noc_arena arena = { 0 };
    NOC_ARRAY(char) a = { 0 };
    char *first = arena_alloc(&arena, 16), *second = arena_strndup(&arena, "abc", 3);
    assert_true(first && second && array_push(&a, 'a') && array_append(&a, "bc", 2));
    assert_true(!__asan_address_is_poisoned(first + 15) && __asan_address_is_poisoned(first + 16));
    assert_true(!__asan_address_is_poisoned(second + 3) && __asan_address_is_poisoned(second + 4));
    assert_true(!__asan_address_is_poisoned(a.data + 2) && __asan_address_is_poisoned(a.data + 3));
    arena_free(&arena);
    array_free(&a);
}
#else
static void memory_has_no_room_to_spare(void **state) { skip(); }
#endif

/* What a large allocation has is kept up to where it is cut, and beyond it is zero. What cannot be had leaves it. */
static void large_memory_takes_another_size(void **state) {
    uint32_t *a = NULL;
    assert_true(noc_resize_large(&a, 0, 3, sizeof(*a)));
    for (uint32_t i = 0; i < 3; i++)
        a[i] = i + 1;
    assert_true(noc_resize_large(&a, 2, 100, sizeof(*a)));
    assert_int_equal((uintptr_t)a % 64, 0);
    assert_int_equal(a[0], 1);
    assert_int_equal(a[1], 2);
    for (size_t i = 2; i < 100; i++)
        assert_int_equal(a[i], 0);
    assert_true(noc_resize_large(&a, 100, 1, sizeof(*a)));
    assert_int_equal(a[0], 1);
    uint32_t *before = a;
    assert_false(noc_resize_large(&a, 1, SIZE_MAX / 2, sizeof(*a)));
    noc_refuse_allocation(1, false);
    assert_false(noc_resize_large(&a, 1, 1000, sizeof(*a)));
    noc_refuse_allocation(0, false);
    assert_ptr_equal(a, before);
    assert_int_equal(a[0], 1);
    free(a);
}

/* Each allocation refused alone, and with all that follow, is told of; nothing leaks (make asan). */
static void refused_memory_is_told(void **state) {
    noc_refuse_allocation(UINT64_MAX, false);
    assert_true(allocate_in_all_ways());
    uint64_t all = noc_allocations();
    assert_true(all > 15);
    for (int and_later = 0; and_later < 2; and_later++)
        for (uint64_t n = 1; n <= all; n++) {
            noc_refuse_allocation(n, and_later);
            assert_false(allocate_in_all_ways());
            assert_true(noc_allocations() >= n);
        }
    noc_refuse_allocation(0, false);
    assert_true(allocate_in_all_ways());
    assert_int_equal(noc_allocations(), 0);
}

/* A pool does with the threads that it gets. */
static void refused_threads_are_done_without(void **state) {
    noc_refuse_allocation(4, true); /* after its two allocations and one thread */
    noc_pool *pool = noc_pool_create(8);
    noc_refuse_allocation(0, false);
    assert_non_null(pool);
    assert_int_equal(noc_pool_threads(pool), 2);
    static atomic_int hits[100];
    noc_pool_run(pool, NOC_COUNT(hits), count_item, hits);
    for (size_t i = 0; i < NOC_COUNT(hits); i++)
        assert_int_equal(hits[i], 1);
    noc_pool_destroy(pool);
}

static void pool_runs_each_item_once(void **state) {
    noc_pool *pool = noc_pool_create(3);
    static atomic_int hits[1000];
    for (int run = 0; run < 50; run++)
        noc_pool_run(pool, NOC_COUNT(hits), count_item, hits);
    for (size_t i = 0; i < NOC_COUNT(hits); i++)
        assert_int_equal(hits[i], 50);
    noc_pool_destroy(pool);
}

static int messages;
static void keep(void *user, noc_log_level level, const char *text) {
    messages++;
    strcpy(user, text);
}

static void log_reports_once(void **state) {
    char text[1100];
    noc_log *log = noc_log_create(&(noc_log_params){ .message = keep, .user = text, .level = NOC_LOG_WARN });
    assert_int_equal(noc_error(log, NOC_ERR_FORMAT, "%s:%d: bad\x1b[31m", "a.gml", 3), NOC_ERR_FORMAT);
    assert_string_equal(text, "a.gml:3: bad [31m");
    assert_string_equal(noc_log_last_error(log), text);
    char copy[6];
    noc_log_copy_error(log, copy, sizeof(copy));
    assert_string_equal(copy, "a.gml");
    noc_log_copy_error(NULL, copy, sizeof(copy));
    assert_string_equal(copy, "");
    noc_info(log, "dropped");
    assert_int_equal(messages, 1);
    noc_log_destroy(log);
    noc_log_destroy(NULL);
    noc_error(NULL, NOC_OK, "nowhere");
}

/* The host decides what becomes of messages: without its callback nothing is printed. */
static void log_without_a_callback_prints_nothing(void **state) {
    FILE *to = tmpfile();
    int out = dup(1), err = dup(2);
    assert_non_null(to);
    fflush(stdout);
    dup2(fileno(to), 1);
    dup2(fileno(to), 2);
    noc_log *log = noc_log_create(NULL);
    noc_error(log, NOC_ERR_FORMAT, "an error");
    noc_warn(log, "a warning");
    fflush(stdout);
    fflush(stderr);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    fseek(to, 0, SEEK_END);
    assert_int_equal(ftell(to), 0);
    fclose(to);
    assert_string_equal(noc_log_last_error(log), "an error");
    noc_log_destroy(log);
}

/* A process that is bound to one core takes one thread, whatever the machine has. */
static void threads_are_of_the_cores_that_are_ours(void **state) {
    (void)state;
    cpu_set_t all, one;
    int first = 0;
    assert_int_equal(sched_getaffinity(0, sizeof(all), &all), 0);
    assert_int_equal(noc_processors(), CPU_COUNT(&all));
    while (!CPU_ISSET(first, &all))
        first++;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    assert_int_equal(sched_setaffinity(0, sizeof(one), &one), 0);
    noc_pool *pool = noc_pool_create(0);
    int processors = noc_processors(), threads = noc_pool_threads(pool);
    noc_pool_destroy(pool);
    assert_int_equal(sched_setaffinity(0, sizeof(all), &all), 0);
    assert_int_equal(processors, 1);
    assert_int_equal(threads, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_of_all_lengths),
        cmocka_unit_test(numbers),
        cmocka_unit_test(arrays_and_maps),
        cmocka_unit_test(siphash_is_as_published),
        cmocka_unit_test(colliding_ids_do_not_flood),
        cmocka_unit_test(pool_runs_each_item_once),
        cmocka_unit_test(memory_has_no_room_to_spare),
        cmocka_unit_test(large_memory_takes_another_size),
        cmocka_unit_test(refused_memory_is_told),
        cmocka_unit_test(refused_threads_are_done_without),
        cmocka_unit_test(threads_are_of_the_cores_that_are_ours),
        cmocka_unit_test(log_reports_once),
        cmocka_unit_test(log_without_a_callback_prints_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
