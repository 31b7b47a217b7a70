/* Pages of a picture's buffers that frames touch: those that they read or write, and no others. */
#include "../render/rooms.h"
#include "cpu_view.h"
#include "render/view.h"

#include <sys/mman.h>
#include <unistd.h>

enum { SIDE = 256, BLOCKS = SIDE / BLOCK_SIDE * (SIDE / BLOCK_SIDE) };

/* Share of the pages that lie in memory. */
static double touched(void *buffer, size_t bytes) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), count = (bytes + page - 1) / page, in = 0;
    unsigned char *there = test_malloc(count);
    assert_int_equal(mincore(buffer, bytes, there), 0);
    for (size_t i = 0; i < count; i++)
        in += there[i] & 1;
    test_free(there);
    return (double)in / (double)count;
}

static void frames_touch_what_they_need(void **state) {
    (void)state;
    noc_scene *s = noc_scene_create(NULL);
    add_floor(s, matte(s, 0.5f), 0, 0, 0, 30);
    point_light(s, 1, 2, 4, 100);
    point_light(s, 9, 2, 4, 100);
    assert_int_equal(noc_scene_commit(s), NOC_OK);
    noc_camera c = look(0, -10, 20, 0, 0, 0, 60);
    noc_view *v = own_view(s, 2, NULL);
    const frame_buffers *b = &((const cpu_view *)v->state)->b;
    noc_render_params p = measure(SIDE, SIDE, NOC_METHOD_RIS);
    p.candidates = NOC_CANDIDATES_LISTS;
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    if (touched(b->g[!v->history.gbuffer], BLOCKS * sizeof(gblock)) == 1) {
        close_view(v);
        noc_scene_destroy(s);
        skip(); /* under AddressSanitizer they are not pages of their own */
    }
    assert_true(touched(b->g[v->history.gbuffer], BLOCKS * sizeof(gblock)) == 1);
    assert_true(touched(b->picture, BLOCKS * sizeof(cblock)) == 1);
    assert_true(touched(b->g[!v->history.gbuffer], BLOCKS * sizeof(gblock)) == 0);
    assert_true(touched(b->r[0], BLOCKS * sizeof(rblock)) == 0);
    p.aovs = NOC_AOV_BIT(WEIGHT); /* which is read from them */
    assert_int_equal(noc_view_render(v, &c, &p, NULL), NOC_OK);
    assert_true(touched(b->r[0], BLOCKS * sizeof(rblock)) == 1);
    noc_channel *weight = noc_view_aov(v, NOC_AOV_WEIGHT);
    assert_non_null(weight);
    assert_true(weight->value[SIDE * SIDE / 2 + SIDE / 2] > 0);
    noc_channel_destroy(weight);
    close_view(v);
    noc_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(frames_touch_what_they_need) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
