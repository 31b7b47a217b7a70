/* Real files of shared/data/ies: each is read, and those that were measured make the lumens that they state. */
#include "test.h"

#include <math.h>
#include <nocturne/photometry.h>

static const struct {
    const char *path;
    double lumens, error; /* what it makes, and how far off its own statement that is, NaN: states nothing */
} files[] = {
    { "luxcore/ASA_15M_R2.ies", 9561, 0 },
    { "radiance/examp1.ies", 5297, 0 },
    { "renderpipeline/area_light.ies", 28338, 0 },
    { "renderpipeline/bollard.ies", 2553, 0 },
    { "renderpipeline/medium_scatter.ies", 707, 0 },
    { "renderpipeline/three_lobe_vee.ies", 4302, 0 },
    { "renderpipeline/top_post.ies", 4297, 0 },
    { "renderpipeline/trapezoid.ies", 14429, 0 },
    { "eulumdat-rs/OutdoorRoadway_8988-2022_03_AM01_60W_4000K.ies", 9155, 0 },
    { "eulumdat-rs/ITALO_1_5P5_S05_3.140-3M.IES", 10580, NAN },
    { "eulumdat-rs/road_luminaire.ldt", 27934, -.003 },
    { "eulumdat-rs/projector.ldt", 5158, .021 },
    { "eulumdat-py/sample1.ldt", 1983, 0 },
    { "eulumdat-py/sample2.ldt", 4604, .001 },
    { "eulumdat-py/sample4.ldt", 5544, .001 },
    { "eulumdat-py/sample6.ldt", 1799, 0 },
    { "eulumdat-py/sample10.ldt", 7003, 0 },
    /* made up, and off: */
    { "eulumdat-rs/TILT_TEST_SYNTHETIC.ies", 3227, 2.227 },
    { "eulumdat-rs/wiki-batwing.ldt", 11664, 2.431 },
    { "photometric-viewer/multiple_lamp_sets.ldt", 452, -.095 },
    { "photometric-viewer/relative_photometry_with_multiplier.ies", 1357, 1.714 },
    { "photometric-viewer/no_symmetry.ldt", 3722, 2.722 },
    { "radeonprorender/ies_light_1.ies", 18, NAN },
};

static void test_flux(void **state) {
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++) {
        char path[200];
        snprintf(path, sizeof(path), "data/ies/%s", files[i].path);
        REQUIRE_SHARED(file, path);
        noc_profile *p = NULL;
        noc_profile_info info;
        assert_int_equal(noc_profile_load(NULL, file, &p), NOC_OK);
        noc_profile_get_info(p, &info);
        bool same = isnan(files[i].error) ? isnan(info.flux_error) : fabs(info.flux_error - files[i].error) < .0011;
        if (fabs(info.lumens - files[i].lumens) > .6 || !same)
            fail_msg("%s: %.2f lm, error %.4f", files[i].path, info.lumens, info.flux_error);
        noc_profile_destroy(p);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_flux) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
