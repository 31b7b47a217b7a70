/* Lux that lamps by the rule give on a straight lit road, by its class, against what EN 13201-2 asks for: P4 5 lx; M4,
 * M3 and M2 .75, 1 and 1.5 cd/m2, which are 11, 14 and 21 lx on a road of class R3 (Q0 .07). */
#include "../own_view.h"
#include "../test.h"

#include "base/base.h"
#include "noc_config.h"
#include <nocturne/influence.h>
#include <nocturne/nocturne.h>

#include <math.h>

#if NOC_HAVE_GDAL

static char folder[] = "/tmp/noc-road-lux-XXXXXX";
#include "../folder.h"

/* Mean over the carriageway, away from the road's ends. width: that of docs/formats.md. */
static double lux_of(const char *highway, double width) {
    char text[700], where[200];
    snprintf(text, sizeof(text),
             "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\",\"properties\":{\"name\":"
             "\"urn:ogc:def:crs:EPSG::25832\"}},\"features\":[{\"type\":\"Feature\",\"properties\":{\"@id\":\"way/1\","
             "\"highway\":\"%s\",\"lit\":\"yes\"},\"geometry\":{\"type\":\"LineString\",\"coordinates\":"
             "[[690000,5330000],[690600,5330000]]}}]}",
             highway);
    double low = 5330000 - width / 2, high = 5330000 + width / 2;
    snprintf(where, sizeof(where), "polygon:POLYGON((690150 %.2f,690450 %.2f,690450 %.2f,690150 %.2f,690150 %.2f))",
             low, low, high, high, low);
    const char *path = write_file("road.json", text);
    noc_import_params params = noc_import_default_params();
    noc_render_params render = noc_render_default_params();
    noc_log *log = noc_log_create(&(noc_log_params){ .level = NOC_LOG_ERROR });
    noc_scene *scene = noc_scene_create(log);
    render.sky = 0;
    params.map_surfaces = NOC_SWITCH_ON;
    params.scene_crs = "EPSG:25832";
    assert_int_equal(noc_scene_load(scene, &path, 1, &params, NULL), NOC_OK);
    noc_view *view = own_view(scene, 0, log);
    noc_region *region = noc_region_find(view, scene, where, NULL, log);
    assert_non_null(region);
    noc_ranking *ranking = noc_ranking_create(view, region, &(noc_ranking_params){ &render, NULL });
    noc_influence_sum sum;
    assert_int_equal(noc_ranking_refine(ranking, &(noc_ranking_target){ .rays = 200000 }, NULL), NOC_OK);
    assert_int_equal(noc_ranking_get(ranking, NULL, 0, NULL, &sum), NOC_OK);
    assert_true(sum.lux.error < .02 * sum.lux.value);
    print_message("# %s: %.1f lx\n", highway, sum.lux.value);
    noc_ranking_destroy(ranking);
    noc_region_destroy(region);
    close_view(view);
    noc_scene_destroy(scene);
    noc_log_destroy(log);
    return sum.lux.value;
}

static void test_lux_by_class(void **state) {
    static const struct {
        const char *highway;
        double width, lux;
    } roads[] = { { "residential", 5.5, 5 }, { "living_street", 5, 5 }, { "tertiary", 6, 11 },
                  { "secondary", 6.5, 14 },  { "primary", 7, 14 },      { "trunk", 7, 21 },
                  { "motorway", 7.5, 21 } };
    for (size_t i = 0; i < NOC_COUNT(roads); i++) {
        double lux = lux_of(roads[i].highway, roads[i].width);
        if (fabs(lux - roads[i].lux) > .15 * roads[i].lux)
            fail_msg("%s: %.2f lx for %g", roads[i].highway, lux, roads[i].lux);
    }
}

static int finish(void **state) { return remove_folder(); }
static int start(void **state) { return mkdtemp(folder) ? 0 : -1; }

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(test_lux_by_class) };
    return cmocka_run_group_tests_name("import/road_lux", tests, start, finish);
}

#else

int main(void) {
    puts("1..0 # SKIP no GDAL");
    return 0;
}

#endif
