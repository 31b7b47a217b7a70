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

/* Degrees to the right of straight ahead and above the level, and what UN Regulation 112 (class B; Regulation 149 has
 * the same points) allows there, cd. */
static void test_low_beam(void **state) {
    static const struct {
        const char *point;
        double right, up, least, most;
    } points[] = { { "B50L", -3.43, .57, 0, 350 },    { "75R", 1.15, -.57, 10100, 1e9 },
                   { "75L", -3.43, -.57, 0, 10600 },  { "50L", -3.43, -.86, 0, 13200 },
                   { "50R", 1.72, -.86, 10100, 1e9 }, { "50V", 0, -.86, 5100, 1e9 },
                   { "25L", -9, -1.72, 1700, 1e9 },   { "25R", 9, -1.72, 1700, 1e9 },
                   { "zone I", 1.5, -1.8, 0, 17600 }, { "zone IV", -5.15, -1.3, 2500, 1e9 },
                   { "zone III", -6, 1, 0, 625 },     { "zone III", 3, 3, 0, 625 } };
    noc_profile *p = NULL;
    noc_profile_info info;
    assert_int_equal(noc_profile_builtin(NULL, "low-beam", &p), NOC_OK);
    noc_profile_get_info(p, &info);
    for (size_t i = 0; i < sizeof(points) / sizeof(*points); i++) {
        double h = points[i].right * M_PI / 180, v = points[i].up * M_PI / 180;
        double x = cos(v) * sin(h), y = sin(v), z = cos(v) * cos(h), c = atan2(y, x) * 180 / M_PI;
        double cd = noc_profile_intensity(p, c < 0 ? c + 360 : c, acos(z) * 180 / M_PI) * 700 / info.lumens;
        print_message("# %-8s %6.0f cd\n", points[i].point, cd);
        assert_true(cd >= points[i].least && cd <= points[i].most);
    }
    assert_true(info.lumens > 600 && info.lumens < 800);
    noc_profile_destroy(p);
}

static void test_names(void **state) {
    int count = 0;
    for (const char *name; (name = noc_profile_builtin_name(count)); count++) {
        noc_profile *p = NULL;
        assert_int_equal(noc_profile_builtin(NULL, name, &p), NOC_OK);
        noc_profile_destroy(p);
    }
    noc_profile *p = NULL;
    assert_int_equal(count, 6);
    assert_int_equal(noc_profile_builtin(NULL, "candle", &p), NOC_ERR_ARGUMENT);
    assert_null(p);
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_shapes), cmocka_unit_test(test_low_beam),
                                        cmocka_unit_test(test_names) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
