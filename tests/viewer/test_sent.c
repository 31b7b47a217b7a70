/* What goes to a client: its outbox, which cannot grow, and the pace of moving pictures. */
#include "../test.h"

#include "viewer/outbox.h"
#include "viewer/pace.h"
#include "viewer/wire.h"

static int woken;
static void wake(void *user) {
    (void)user;
    woken++;
}

static char *text_of(int n) {
    char *text = malloc(16);
    snprintf(text, 16, "text %d", n);
    return text;
}

static void picture(outbox *box, int pane, uint32_t number) {
    unsigned char *data = malloc(OUTBOX_ROOM + 4);
    memcpy(data + OUTBOX_ROOM, &number, 4);
    outbox_picture(box, pane, number, data, 4, text_of((int)number));
}

/* The next message is that text, or the picture of that number. */
static void expect_text(outbox *box, int n) {
    outbox_message m;
    char expected[16];
    snprintf(expected, sizeof(expected), "text %d", n);
    assert_true(outbox_take(box, 0, &m) && m.text);
    assert_string_equal((char *)m.data + OUTBOX_ROOM, expected);
    free(m.data);
}

static void expect_picture(outbox *box, uint32_t number, double now) {
    outbox_message m;
    uint32_t found;
    assert_true(outbox_take(box, now, &m) && !m.text && m.size == 4);
    memcpy(&found, m.data + OUTBOX_ROOM, 4);
    assert_int_equal(found, number);
    free(m.data);
}

static void expect_nothing(outbox *box) {
    outbox_message m;
    assert_false(outbox_pending(box));
    assert_false(outbox_take(box, 0, &m));
}

static void test_newest_picture_alone(void **state) {
    (void)state;
    outbox *box = outbox_create(wake, NULL);
    picture(box, 0, 1);
    expect_text(box, 1); /* its figures go before it */
    expect_picture(box, 1, 10);
    for (uint32_t n = 2; n <= 50; n++)
        picture(box, 0, n); /* while the first is on its way */
    expect_nothing(box);
    assert_true(outbox_holds(box, 0));
    assert_true(outbox_waits(box, 0, 13) == 3);
    outbox_shown(box, 0, 49); /* was never sent */
    expect_nothing(box);
    woken = 0;
    outbox_shown(box, 0, 1);
    assert_int_equal(woken, 1);
    expect_text(box, 50);
    expect_picture(box, 50, 11);
    outbox_shown(box, 0, 50);
    assert_true(outbox_waits(box, 0, 99) == 0);
    expect_nothing(box);
    outbox_destroy(box);
}

static void test_panes_take_turns(void **state) {
    (void)state;
    outbox *box = outbox_create(wake, NULL);
    picture(box, 1, 10);
    picture(box, 0, 20);
    expect_text(box, 20);
    picture(box, 1, 11); /* overtakes, but not between a picture and its figures */
    expect_picture(box, 20, 0);
    outbox_shown(box, 0, 20);
    picture(box, 0, 21);
    expect_text(box, 11); /* the other's turn */
    expect_picture(box, 11, 0);
    expect_text(box, 21);
    outbox_destroy(box); /* with what is left */
}

static void test_texts_replace_each_other(void **state) {
    (void)state;
    outbox *box = outbox_create(wake, NULL);
    for (int i = 0; i < 1000; i++) {
        outbox_text(box, OUTBOX_STATE, 0, text_of(i));
        outbox_text(box, OUTBOX_ANSWER, 5, text_of(1000 + i));
    }
    picture(box, 0, 7);
    expect_text(box, 999);
    expect_text(box, 1999);
    expect_text(box, 7);
    assert_false(outbox_broken(box));
    outbox_destroy(box);
}

static void test_too_much_breaks_it(void **state) {
    (void)state;
    outbox *box = outbox_create(wake, NULL);
    for (uint32_t i = 0; i < 64; i++)
        outbox_text(box, OUTBOX_ANSWER, i, text_of((int)i));
    assert_false(outbox_broken(box));
    outbox_text(box, OUTBOX_ANSWER, 64, text_of(64));
    assert_true(outbox_broken(box));
    outbox_destroy(box);
    box = outbox_create(wake, NULL);
    outbox_binary(box, 1, calloc(1, 64), (size_t)50 << 20); /* it is not touched */
    assert_false(outbox_broken(box));
    outbox_binary(box, 2, calloc(1, 64), (size_t)50 << 20);
    assert_true(outbox_broken(box));
    outbox_destroy(box);
    box = outbox_create(wake, NULL);
    outbox_text(box, OUTBOX_STATE, 0, NULL); /* there was no memory for it */
    assert_true(outbox_broken(box));
    outbox_destroy(box);
}

/* ---- pace ---- */

/* Frames of that many seconds for the whole picture: where does it settle, and how often does it change there? */
static int settle(double whole, double budget, int *changes) {
    pace p = { .level = PACE_START };
    for (int i = 0; i < 200; i++) {
        int before = p.level;
        pace_after(&p, whole / (1 << p.level), budget, PACE_LEVELS - 1);
        *changes = i < 100 ? 0 : *changes + (p.level != before);
    }
    return p.level;
}

static void test_resolution_follows_time(void **state) {
    (void)state;
    int changes, last = 0;
    for (double whole = 0.001; whole < 20; whole *= 1.3) {
        int level = settle(whole, 0.05, &changes);
        double seconds = whole / (1 << level);
        assert_int_equal(changes, 0); /* each change would lose reservoirs */
        assert_true(level >= last);
        assert_true(seconds <= 0.05 * 1.4 || level == PACE_LEVELS - 1);
        assert_true(seconds >= 0.05 * 0.4 * 0.99 || level == 0);
        last = level;
    }
    assert_int_equal(last, PACE_LEVELS - 1);
}

static void test_one_slow_frame_is_no_reason(void **state) {
    (void)state;
    pace p = { .level = 3 };
    for (int i = 0; i < 100; i++)
        pace_after(&p, i % 10 ? 0.04 : 0.09, 0.05, 8); /* 0.09: twice the time, now and then */
    assert_int_equal(p.level, 3);
    pace_after(&p, 0.4, 0.05, 8); /* far too long is, at once, and as far down as it takes */
    assert_int_equal(p.level, 6);
    pace_after(&p, 1e300, 0.05, 7);
    assert_int_equal(p.level, 7);
}

static void test_sizes(void **state) {
    (void)state;
    int w, h;
    pace_size(0, 1280, 720, &w, &h);
    assert_true(w == 1280 && h == 720);
    pace_size(2, 1280, 720, &w, &h);
    assert_true(w == 640 && h == 360);
    pace_size(PACE_LEVELS - 1, 100, 8, &w, &h);
    assert_true(w == 16 && h == 8);
}

static void test_no_picture_is_too_coarse(void **state) {
    (void)state;
    for (int width = 40; width < 4000; width += 37)
        for (int count = 1; count <= WIRE_PANES; count++) {
            int w, h, height = width * 9 / 16, level = pace_coarsest(width, height, count);
            pace_size(level, width, height, &w, &h);
            assert_true(level >= 0 && level < PACE_LEVELS);
            assert_true(w * h >= 9500 || level == 0);
            assert_true(w * h >= 38000 || level == 0 || count > 1);
            assert_true(w * h <= 100000 || level == PACE_LEVELS - 1);
        }
}

static void test_rest_is_sent_ever_more_rarely(void **state) {
    (void)state;
    double now = 0;
    int sent = 0;
    for (; now < 600; sent++)
        now += pace_rest(now);
    assert_true(pace_rest(0) <= 0.25 && sent > 60 && sent < 200);
    assert_true(pace_rest(1e9) <= 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_newest_picture_alone),          cmocka_unit_test(test_panes_take_turns),
        cmocka_unit_test(test_texts_replace_each_other),      cmocka_unit_test(test_too_much_breaks_it),
        cmocka_unit_test(test_resolution_follows_time),       cmocka_unit_test(test_one_slow_frame_is_no_reason),
        cmocka_unit_test(test_no_picture_is_too_coarse),      cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_rest_is_sent_ever_more_rarely),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
