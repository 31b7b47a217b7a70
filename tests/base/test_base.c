#include "../test.h"
#include "base/base.h"
#include <stdatomic.h>

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
        array_push(&a, i);
    assert_int_equal(a.len, 1000);
    assert_int_equal(a.data[777], 777);
    array_free(&a);
    noc_map map = { 0 };
    char key[32];
    for (int i = 0; i < 5000; i++) {
        snprintf(key, sizeof(key), "id_%d", i);
        assert_true(map_put(&map, key, (uint64_t)i));
    }
    assert_false(map_put(&map, "id_7", 70));
    uint64_t v = 0;
    assert_true(map_get(&map, "id_4999", &v) && v == 4999);
    assert_true(map_get(&map, "id_7", &v) && v == 70);
    assert_false(map_get(&map, "nothing", &v));
    map_free(&map);
    assert_null(noc_alloc_large(SIZE_MAX / 2, 4));
}

static void count_item(void *ctx, size_t item, int worker) {
    atomic_int *hits = ctx;
    atomic_fetch_add(&hits[item], 1);
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
    noc_info(log, "dropped");
    assert_int_equal(messages, 1);
    noc_log_destroy(log);
    noc_log_destroy(NULL);
    noc_error(NULL, NOC_OK, "nowhere");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers),
        cmocka_unit_test(arrays_and_maps),
        cmocka_unit_test(pool_runs_each_item_once),
        cmocka_unit_test(log_reports_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
