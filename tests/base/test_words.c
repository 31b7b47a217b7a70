/* Numbers as people read them, and what people write. */
#include "../test.h"

#include <nocturne/text.h>

static void test_numbers_for_people(void **state) {
    char text[64];
    (void)state;
    assert_string_equal(noc_text_count(text, 0), "0");
    assert_string_equal(noc_text_count(text, 999), "999");
    assert_string_equal(noc_text_count(text, 1234567), "1,234,567");
    assert_string_equal(noc_text_many(text, 1, "light"), "1 light");
    assert_string_equal(noc_text_many(text, 1234, "light"), "1,234 lights");
    assert_string_equal(noc_text_bytes(text, 1), "1 byte");
    assert_string_equal(noc_text_bytes(text, 999499), "999 kB");
    assert_string_equal(noc_text_bytes(text, 4100000), "4.1 MB");
    assert_string_equal(noc_text_seconds(text, 0.424), "0.42 s");
    assert_string_equal(noc_text_seconds(text, 125), "2 min 05 s");
    assert_string_equal(noc_text_seconds(text, 3600), "1 h 00 min");
}

static void test_clean(void **state) {
    char text[10] = "a\tb\x7f";
    (void)state;
    assert_string_equal(noc_text_clean(text, sizeof(text), text), "a b ");
    assert_string_equal(noc_text_clean(text, sizeof(text), "123456789"), "123456789");
    assert_string_equal(noc_text_clean(text, sizeof(text), "1234567890"), "123456...");
}

static void test_nearest(void **state) {
    static const char *const words[] = { "candidates", "list", "tail" };
    (void)state;
    assert_string_equal(noc_text_nearest("candiadtes", words, 3), "candidates"); /* neighbours exchanged */
    assert_string_equal(noc_text_nearest("cand", words, 3), "candidates");       /* only begun */
    assert_string_equal(noc_text_nearest("lists", words, 3), "list");
    assert_null(noc_text_nearest("window", words, 3));
    char other[300] = { 0 }, longer[400] = { 0 };
    memset(other, 'a', sizeof(other) - 1);
    memset(longer, 'b', sizeof(longer) - 1);
    assert_null(noc_text_nearest(other, (const char *[]){ longer }, 1)); /* as far apart as they are long */
}

static void test_what_people_write(void **state) {
    double v[3];
    (void)state;
    assert_true(noc_text_numbers("1.5,-3,2e3", ',', 3, v));
    assert_true(v[0] == 1.5 && v[1] == -3 && v[2] == 2000);
    static const char *const wrong[] = { "1,2",     "1,2,3,4", "1,2,3 ",    " 1,2,3", "1,,3",
                                         "1,2,nan", "0x1,2,3", "1,2,1e999", "" };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_false(noc_text_numbers(wrong[i], ',', 3, v));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_for_people),
        cmocka_unit_test(test_clean),
        cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_what_people_write),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
