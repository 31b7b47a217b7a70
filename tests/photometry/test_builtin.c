/* Built-in distributions have the shape that is told of them. */
#include "../test.h"

#include <math.h>
#include <nocturne/photometry.h>

static noc_profile_info info_of(const char *name) {
    noc_profile *p = NULL;
    noc_profile_info info;
    assert_int_equal(noc_profile_builtin(NULL, name, &p), NOC_OK);
    noc_profile_get_info(p, &info);
    print_message("# %-10s upward %4.1f%%, forward %4.1f%%, peak %.2f cd/lm at C %g, gamma %g\n", name,
                  100 * info.upward, 100 * noc_profile_flux(p, 0, 180, info.street) / info.lumens,
                  info.peak / info.lumens, info.peak_c, info.peak_gamma);
    noc_profile_destroy(p);
    return info;
}

static void test_shapes(void **state) {
    noc_profile_info cobra = info_of("cobra-head"), post = info_of("post-top"), wall = info_of("wall");
    noc_profile_info flood = info_of("flood"), bollard = info_of("bollard");
    /* full cut-off: nothing upward at all */
    assert_true(cobra.upward == 0 && wall.upward == 0 && flood.upward == 0 && bollard.upward == 0);
    assert_true(post.upward > .08 && post.upward < .25);
    /* along the road, before the post rather than behind it */
    double forward = cobra.forward.low + cobra.forward.medium + cobra.forward.high + cobra.forward.very_high;
    assert_true(cobra.street == 0 && forward > .55 * cobra.lumens && forward < .8 * cobra.lumens);
    double side = fmin(cobra.peak_c, 360 - cobra.peak_c);
    assert_true(side >= 50 && side <= 80 && cobra.peak_gamma >= 55 && cobra.peak_gamma <= 70);
    double behind = wall.back.low + wall.back.medium + wall.back.high + wall.back.very_high;
    assert_true(behind < .2 * wall.lumens);
    assert_true(flood.peak_gamma == 0 && bollard.peak_gamma > 60 && bollard.peak_gamma < 75);
}

static void test_names(void **state) {
    int count = 0;
    for (const char *name; (name = noc_profile_builtin_name(count)); count++) {
        noc_profile *p = NULL;
        assert_int_equal(noc_profile_builtin(NULL, name, &p), NOC_OK);
        noc_profile_destroy(p);
    }
    noc_profile *p = NULL;
    assert_int_equal(count, 5);
    assert_int_equal(noc_profile_builtin(NULL, "candle", &p), NOC_ERR_ARGUMENT);
    assert_null(p);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_shapes), cmocka_unit_test(test_names) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
