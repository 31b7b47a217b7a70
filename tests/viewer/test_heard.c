/* What strangers send: messages, and the inbox that they wait in. */
#include "../test.h"

#include "viewer/inbox.h"

static char why[128];

static bool reads(const char *text) {
    wire_message m;
    bool read = wire_read(text, strlen(text), &m, why, sizeof(why));
    if (read)
        wire_free(&m);
    return read;
}

static wire_message read_one(const char *text) {
    wire_message m;
    if (!wire_read(text, strlen(text), &m, why, sizeof(why)))
        fail_msg("%s: %s", text, why);
    return m;
}

#define assert_refused(text, reason)                                                                                   \
    do {                                                                                                               \
        assert_false(reads(text));                                                                                     \
        assert_string_equal(why, reason);                                                                              \
    } while (0)

static void test_hello(void **state) {
    (void)state;
    wire_message m = read_one("{\"t\":\"hello\",\"width\":1280,\"height\":720,\"more\":[1]}");
    assert_int_equal(m.kind, WIRE_HELLO);
    assert_int_equal(m.hello.width, 1280);
    assert_int_equal(m.hello.height, 720);
    wire_free(&m);
    assert_refused("{\"t\":\"hello\",\"width\":0,\"height\":720}", "hello: width is no whole number of 1 to 8192");
    assert_refused("{\"t\":\"hello\",\"width\":8193,\"height\":720}", "hello: width is no whole number of 1 to 8192");
    assert_refused("{\"t\":\"hello\",\"width\":10.5,\"height\":720}", "hello: width is no whole number of 1 to 8192");
    assert_refused("{\"t\":\"hello\",\"width\":10}", "hello: height is no whole number of 1 to 8192");
    assert_refused("{\"t\":\"hello\",\"width\":\"10\",\"height\":1}", "hello: width is no whole number of 1 to 8192");
}

static void test_no_messages(void **state) {
    (void)state;
    static const char *const texts[] = { "",
                                         " ",
                                         "null",
                                         "[]",
                                         "3",
                                         "\"hello\"",
                                         "{",
                                         "{\"t\":\"hello\"",
                                         "{}x",
                                         "{\"t\":\"watch\",\"on\":true,\"on\":true}",
                                         "{\"a\":\"\xff\"}",
                                         "{\"t\":\"ask\",\"id\":1e999}",
                                         "{\"a\":\"\\ud800\"}" };
    for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++)
        assert_refused(texts[i], "message: no JSON object");
    assert_refused("{}", "message: t is no kind that is known");
    assert_refused("{\"t\":null}", "message: t is no kind that is known");
    assert_refused("{\"t\":\"helloo\"}", "message: t is no kind that is known");
    assert_refused("{\"t\":\"watch\",\"on\":1}", "watch: on is neither true nor false");
}

static void test_bounds(void **state) {
    (void)state;
    static char text[2 * WIRE_TEXT];
    int n = snprintf(text, sizeof(text), "{\"t\":\"watch\",\"on\":true,\"x\":\"");
    memset(text + n, 'a', WIRE_TEXT);
    strcpy(text + WIRE_TEXT - 2, "\"}");
    assert_int_equal(strlen(text), WIRE_TEXT);
    assert_true(reads(text)); /* the longest */
    strcpy(text + WIRE_TEXT - 2, "a\"}");
    assert_refused(text, "message: longer than 32768 bytes");

    assert_true(reads("{\"t\":\"watch\",\"on\":true,\"x\":[[[[[]]]]]}"));
    assert_refused("{\"t\":\"watch\",\"on\":true,\"x\":[[[[[[]]]]]]}", "message: deeper than 6");
    assert_true(reads("{\"t\":\"watch\",\"on\":true,\"x\":\"[[[[[[[[[[\\\"[[[[[\"}")); /* in a text they are none */

    n = snprintf(text, sizeof(text), "{\"t\":\"set\",\"name\":\"");
    memset(text + n, 'a', 4096);
    strcpy(text + n + 4096, "\",\"value\":\"\"}");
    assert_true(reads(text));
    strcpy(text + n + 4096, "a\",\"value\":\"\"}");
    assert_refused(text, "set: name is no text of at most 4096 bytes");
    assert_false(reads("{\"t\":\"set\",\"name\":\"a\\u0000b\",\"value\":\"\"}")); /* a text would end there */
}

static void test_input(void **state) {
    (void)state;
    wire_message m =
        read_one("{\"t\":\"input\",\"n\":7,\"seconds\":5,\"keys\":[\"forward\",\"slow\"],\"turn\":[0.5,-1],"
                 "\"zoom\":-2,\"at\":[0.25,0.75]}");
    assert_int_equal(m.input.n, 7);
    assert_true(m.input.seconds == 1); /* a page that slept is no second ahead */
    assert_int_equal(m.input.keys, WIRE_FORWARD | WIRE_SLOW);
    assert_true(m.input.turn[0] == 0.5 && m.input.turn[1] == -1 && m.input.pan[0] == 0);
    assert_true(m.input.zoom == -2 && m.input.has_at && m.input.at[1] == 0.75);
    wire_free(&m);
    assert_refused("{\"t\":\"input\"}", "input: n is no whole number of 0 to 1000000000");
    assert_refused("{\"t\":\"input\",\"n\":1,\"keys\":[\"jump\"]}", "input: keys has one that is not known");
    assert_refused("{\"t\":\"input\",\"n\":1,\"keys\":{}}", "input: keys is no list of keys");
    assert_refused("{\"t\":\"input\",\"n\":1,\"turn\":[1]}", "input: turn is no list of 2 numbers of -100 to 100");
    assert_refused("{\"t\":\"input\",\"n\":1,\"turn\":[1,1e300]}",
                   "input: turn is no list of 2 numbers of -100 to 100");
}

static void test_camera(void **state) {
    (void)state;
    wire_message m = read_one("{\"t\":\"camera\",\"name\":\"street\"}");
    assert_string_equal(m.camera.to.name, "street");
    wire_free(&m);
    m = read_one("{\"t\":\"camera\",\"name\":\"x\",\"eye\":[1,2,3],\"target\":[4,5,6],\"fov\":50}");
    assert_null(m.camera.to.name);
    assert_true(m.camera.to.target[2] == 6 && m.camera.to.fov == 50);
    wire_free(&m);
    assert_false(reads("{\"t\":\"camera\"}"));
    assert_false(reads("{\"t\":\"camera\",\"eye\":[1,2,3],\"target\":[1,2,3],\"fov\":50}")); /* looks nowhere */
    assert_false(reads("{\"t\":\"camera\",\"eye\":[1,2,1e8],\"target\":[1,2,3],\"fov\":50}"));
    assert_false(reads("{\"t\":\"camera\",\"eye\":[1,2,3],\"target\":[4,5,6],\"fov\":0}"));
}

static void test_settings(void **state) {
    (void)state;
    wire_message m = read_one("{\"t\":\"set\",\"n\":9,\"name\":\"show\",\"value\":\"depth\"}");
    assert_int_equal(m.set.n, 9);
    assert_int_equal(m.set.pane, -1);
    wire_free(&m);
    m = read_one("{\"t\":\"world\",\"name\":\"hour\",\"value\":\"3\"}");
    assert_int_equal(m.set.n, 0);
    wire_free(&m);
    m = read_one("{\"t\":\"layout\",\"n\":11,\"name\":\"methods\"}");
    assert_int_equal(m.layout.n, 11);
    assert_int_equal(m.layout.name, WIRE_METHODS);
    wire_free(&m);
    assert_refused("{\"t\":\"layout\",\"n\":-1,\"name\":\"single\"}",
                   "layout: n is no whole number of 0 to 1000000000");
    assert_refused("{\"t\":\"set\",\"n\":\"9\",\"name\":\"show\",\"value\":\"depth\"}",
                   "set: n is no whole number of 0 to 1000000000");
}

static void test_questions(void **state) {
    (void)state;
    wire_message m = read_one("{\"t\":\"ask\",\"id\":3,\"what\":\"region\",\"polygon\":[[0,0],[1,0],[0,1]]}");
    assert_int_equal(m.ask.points, 3);
    assert_true(m.ask.point[2][1] == 1);
    wire_free(&m);
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"region\",\"polygon\":[[0,0],[1,0]]}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"region\",\"polygon\":[[0,0],[1,0],[0]]}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"region\"}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"pixel\",\"x\":1.5,\"y\":0}"));
    m = read_one("{\"t\":\"ask\",\"id\":3,\"what\":\"region\",\"street\":\"High Street\"}");
    assert_true(!m.ask.object && !strcmp(m.ask.street, "High Street"));
    wire_free(&m);
    m = read_one("{\"t\":\"ask\",\"id\":3,\"what\":\"find\",\"text\":\"node\"}");
    assert_string_equal(m.ask.text, "node");
    wire_free(&m);
    m = read_one("{\"t\":\"ask\",\"id\":3,\"what\":\"name\",\"at\":[1,2]}");
    assert_true(m.ask.has_at && !m.ask.has_light && m.ask.at[1] == 2);
    wire_free(&m);
    m = read_one("{\"t\":\"jump\",\"n\":1,\"place\":[1,2,3],\"distance\":40}");
    assert_true(m.jump.has_place && m.jump.place[2] == 3 && m.jump.distance == 40);
    wire_free(&m);
    assert_refused("{\"t\":\"ask\",\"id\":3,\"what\":\"find\"}", "ask: text is no text of at most 4096 bytes");
    assert_refused("{\"t\":\"ask\",\"id\":3,\"what\":\"name\"}", "ask: object is no text of at most 4096 bytes");
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"name\",\"at\":[1]}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"name\",\"light\":-1}"));
    assert_false(reads("{\"t\":\"jump\",\"n\":1,\"place\":[1,2]}"));
    assert_false(reads("{\"t\":\"jump\",\"n\":1,\"place\":[1,2,3],\"distance\":0}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"pixel\",\"pane\":6,\"x\":0,\"y\":0}"));
    assert_false(reads("{\"t\":\"ask\",\"id\":3,\"what\":\"align\",\"aspect\":1,\"pairs\":[1,2,3,4]}"));
    assert_false(reads("{\"t\":\"save\",\"id\":3,\"what\":\"csv\"}"));
    assert_false(reads("{\"t\":\"save\",\"id\":3,\"what\":\"recipe\",\"cameras\":[{\"name\":\"street\"}]}"));
}

/* ---- the inbox ---- */

static bool put(inbox *in, const char *text) {
    wire_message m = read_one(text);
    return inbox_put(in, &m);
}

static wire_message get(inbox *in) {
    wire_message *first = inbox_get(in), message = { 0 };
    assert_non_null(first);
    message = *first;
    wire_free(first);
    free(first);
    return message;
}

static void test_inputs_become_one(void **state) {
    (void)state;
    inbox in;
    inbox_init(&in);
    for (int i = 1; i <= 10000; i++) {
        char text[96];
        snprintf(text, sizeof(text), "{\"t\":\"input\",\"n\":%d,\"seconds\":0.01,\"turn\":[0.5,0],\"zoom\":1}", i);
        assert_true(put(&in, text));
    }
    assert_true(put(&in, "{\"t\":\"input\",\"n\":10001,\"seconds\":0.01,\"keys\":[\"up\"]}"));
    wire_message first = get(&in), second = get(&in);
    assert_int_equal(first.input.n, 10000);
    assert_true(first.input.turn[0] == 5000 && first.input.zoom == 10000);
    assert_true(first.input.seconds > 99.9 && first.input.seconds < 100.1);
    assert_int_equal(second.input.n, 10001);
    assert_int_equal(second.input.keys, WIRE_UP);
    assert_null(inbox_get(&in));
    inbox_finish(&in);
}

static void test_the_newest_camera_counts(void **state) {
    (void)state;
    inbox in;
    inbox_init(&in);
    for (int i = 1; i <= 3000; i++) {
        char text[96];
        snprintf(text, sizeof(text), "{\"t\":\"camera\",\"name\":\"c%d\",\"n\":%d}", i, i);
        assert_true(put(&in, text));
    }
    assert_true(put(&in, "{\"t\":\"layout\",\"name\":\"divider\"}"));
    assert_true(put(&in, "{\"t\":\"camera\",\"name\":\"last\"}"));
    wire_message *first = inbox_get(&in);
    assert_string_equal(first->camera.to.name, "c3000");
    assert_int_equal(first->camera.n, 3000);
    wire_free(first);
    free(first);
    assert_int_equal(get(&in).kind, WIRE_LAYOUT);
    assert_int_equal(get(&in).kind, WIRE_CAMERA);
    assert_null(inbox_get(&in));
    inbox_finish(&in);
}

static void test_inbox_is_bounded(void **state) {
    (void)state;
    inbox in;
    inbox_init(&in);
    for (int i = 0; i < INBOX_MOST; i++)
        assert_true(put(&in, "{\"t\":\"set\",\"name\":\"draws\",\"value\":\"4\"}"));
    assert_false(put(&in, "{\"t\":\"set\",\"name\":\"draws\",\"value\":\"4\"}"));
    assert_false(put(&in, "{\"t\":\"input\",\"n\":1}"));
    assert_true(put(&in, "{\"t\":\"ack\",\"pane\":0,\"n\":1}")); /* is not kept */
    assert_true(put(&in, "{\"t\":\"watch\",\"on\":false}"));
    assert_true(inbox_hidden(&in));
    assert_true(put(&in, "{\"t\":\"watch\",\"on\":true}"));
    assert_false(inbox_hidden(&in));
    inbox_finish(&in); /* frees what waits: LeakSanitizer looks */
}

static void test_inbox_wakes(void **state) {
    (void)state;
    inbox in;
    inbox_init(&in);
    unsigned wakes = inbox_wait(&in, 0, 0.001); /* nothing comes */
    inbox_wake(&in);
    assert_int_not_equal(inbox_wait(&in, wakes, 1000), wakes);
    assert_false(inbox_hurries(&in));
    inbox_end(&in);
    inbox_wait(&in, wakes, 1000);
    assert_true(inbox_ended(&in) && inbox_hurries(&in));
    inbox_finish(&in);
}

static void test_heads(void **state) {
    (void)state;
    unsigned char head[WIRE_HEAD];
    wire_write_head(&(wire_head){ .kind = WIRE_IS_PICTURE,
                                  .pane = 2,
                                  .png = true,
                                  .flags = WIRE_MOVES | WIRE_LEGEND,
                                  .number = 0x01020304,
                                  .input = 5,
                                  .width = 1280,
                                  .height = 720,
                                  .frames = 6,
                                  .error = 1.0f,
                                  .seconds = 0.5f,
                                  .name_size = 7 },
                    head);
    static const unsigned char expected[WIRE_HEAD] = { 1, 2, 1, 5, 4, 3, 2,    1,    5, 0, 0, 0,    0, 5, 0xd0, 2,
                                                       6, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 7, 0, 0,    0 };
    assert_memory_equal(head, expected, WIRE_HEAD);
}

static void test_texts(void **state) {
    (void)state;
    char *text = wire_note("error", "a \xff \"b\"");
    assert_string_equal(text, "{\"t\":\"note\",\"level\":\"error\",\"text\":\"a ? \\\"b\\\"\"}");
    free(text);
    assert_null(wire_end(NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hello),
        cmocka_unit_test(test_no_messages),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_input),
        cmocka_unit_test(test_camera),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_questions),
        cmocka_unit_test(test_inputs_become_one),
        cmocka_unit_test(test_the_newest_camera_counts),
        cmocka_unit_test(test_inbox_is_bounded),
        cmocka_unit_test(test_inbox_wakes),
        cmocka_unit_test(test_heads),
        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
