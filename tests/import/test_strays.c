/* Lamps that lie more than 20 km from all others, where no city tells where lamps are. */
#include "base/base.h"
#include "scene/scene.h"

#include "../told.h"
#include "noc_config.h"

#include <math.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-strays-XXXXXX";
#include "../folder.h"
static noc_log *log_;

/* ---- tables of lamps, by their eastings in UTM 33; northings are 5820000 ---- */

static const char *csv_of(const double *eastings, size_t count) {
    static char text[4000];
    char *end = text + sprintf(text, "id,x,y,lamp_height,lumens,cct,direction\n");
    for (size_t i = 0; i < count; i++)
        end += sprintf(end, "%zu,%.1f,5820000,8,5000,3000,90\n", i, eastings[i]);
    return text;
}

static size_t count_lines(const noc_report *report, const char *reason, char *examples) {
    size_t count = 0;
    const noc_report_file *f = noc_report_get_file(report, 0);
    *examples = 0;
    for (size_t i = 0; f && i < f->line_count; i++)
        if (strstr(f->lines[i].reason, reason)) {
            count += f->lines[i].count;
            strcpy(examples, f->lines[i].examples);
        }
    return count;
}

typedef struct expected {
    size_t lights, left, apart;
    const char *example, *warning;
} expected;

static noc_import_params params_of(void) {
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    p.crs = "EPSG:25833";
    return p;
}

static void expect(const char *path, const noc_import_params *given, const expected *e) {
    noc_import_params p = *given;
    noc_status strict = e->left || e->apart ? NOC_ERR_FORMAT : NOC_OK;
    for (int look = 0; look < 2; look++) {
        noc_scene *s = noc_scene_create(log_);
        noc_report *report = NULL;
        char examples[1000];
        told[0] = 0;
        noc_status status = look ? noc_inspect(log_, path, &p, &report) : noc_scene_load(s, &path, 1, &p, &report);
        if (status || count_lines(report, "lamp of a group more than 20 km from most", examples) != e->apart ||
            count_lines(report, "lamp more than 20 km from all others", examples) != e->left)
            fail_msg("%d: %s", look, told);
        if (e->left && strcmp(examples, e->example))
            fail_msg("%s for %s", examples, e->example);
        if (e->warning ? !strstr(told, e->warning) : *told != 0)
            fail_msg("%s", told);
        if (!look)
            assert_int_equal(s->lights.len, e->lights);
        noc_report_destroy(report);
        noc_scene_destroy(s);
    }
    noc_scene *s = noc_scene_create(log_);
    p.strict = true;
    assert_int_equal(noc_scene_load(s, &path, 1, &p, NULL), strict);
    noc_scene_destroy(s);
}

static void by_distance(void **state) {
    (void)state;
    static const struct {
        double eastings[8];
        size_t count;
        expected e;
    } cases[] = {
        { { 390000, 390030, 390060, 391000 }, 4, { 4, 0, 0, "", NULL } },
        { { 390000, 390030, 390060, 409000 }, 4, { 4, 0, 0, "", NULL } },
        { { 390000, 390030, 390060, 411000 },
          4,
          { 3, 1, 0, "at 411000 5820000", "1 of 4 lamps is more than 20 km from all others, the first by 21 km" } },
        { { 350000, 390000, 390030, 390060, 430000 },
          5,
          { 3, 2, 0, "at 350000 5820000, at 430000 5820000", "2 of 5 lamps are more than 20 km from all others" } },
        /* step by step along a valley */
        { { 390000, 405000, 420000, 435000, 450000, 465000 }, 6, { 6, 0, 0, "", NULL } },
        /* two towns, or one of them in the wrong CRS: nothing tells which */
        { { 390000, 390030, 450000, 450030 },
          4,
          { 4, 0, 2, "",
            "2 of 4 lamps are more than 20 km from the others, the first by 60 km: are they in another CRS" } },
        { { 390000, 450000 }, 2, { 2, 0, 1, "", "1 of 2 lamps is more than 20 km from the others" } },
    };
    noc_import_params p = params_of();
    for (size_t i = 0; i < NOC_COUNT(cases); i++)
        expect(write_file("lamps.csv", csv_of(cases[i].eastings, cases[i].count)), &p, &cases[i].e);
}

#if NOC_HAVE_GDAL
static void of_maps(void **state) {
    (void)state;
#define LAMP(at)                                                                                                       \
    "{\"type\":\"Feature\",\"properties\":{\"highway\":\"street_lamp\",\"height\":\"8\",\"light:lumen\":\"5000\","     \
    "\"light:colour_temperature\":\"3000\",\"direction\":\"90\"},"                                                     \
    "\"geometry\":{\"type\":\"Point\",\"coordinates\":[" at "]}}"
    const expected e = { 3, 1, 0, "at 3.38 52.52",
                         "1 of 4 lamps is more than 20 km from all others, the first by 680 km" };
    noc_import_params p = params_of();
    expect(write_file("lamps.geojson", "{\"type\":\"FeatureCollection\",\"features\":[" LAMP("3.38,52.52") "," LAMP(
                                           "13.38,52.52") "," LAMP("13.3804,52.52") "," LAMP("13.3808,52.52") "]}"),
           &p, &e);
}
#endif

/* A thousand lamps of a town and five that are not: a group is left out where it is rare. */
static void rare_groups(void **state) {
    (void)state;
    const char *path = in_folder("town.csv");
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "id,x,y,lamp_height,lumens,cct\n");
    for (int i = 0; i < 1005; i++)
        fprintf(f, "%d,%d,%d,8,5000,3000\n", i, 390000 + 30 * (i % 32) + (i < 1000 ? 0 : 900000),
                5820000 + 30 * (i / 32));
    assert_int_equal(fclose(f), 0);
    noc_import_params p = params_of();
    const expected e = { 1000, 5, 0,
                         "at 1290240 5820930, at 1290270 5820930, at 1290300 5820930, at 1290330 5820930, at 1290360 "
                         "5820930",
                         "5 of 1005 lamps are more than 20 km from all others, the first by 89" };
    expect(path, &p, &e);
}

/* One row whose longitude and latitude are exchanged is told of as such; one that lies elsewhere is not. */
static void test_exchanged(void **state) {
    static const char *const rows[] = { "51.31,9.53", "20.5,9.53" };
    (void)state;
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        char text[300], examples[1000];
        snprintf(
            text, sizeof(text),
            "id,lon,lat,wattage,lumens\na,9.51,51.31,70,900\nb,9.52,51.31,50,900\nc,%s,50,900\nd,9.54,51.31,50,900\n",
            rows[i]);
        const char *path = write_file("exchanged.csv", text);
        noc_import_params p = noc_import_default_params();
        for (int look = 0; look < 2; look++) {
            noc_scene *s = noc_scene_create(log_);
            noc_report *report = NULL;
            noc_status status = look ? noc_inspect(log_, path, &p, &report) : noc_scene_load(s, &path, 1, &p, &report);
            assert_int_equal(status, NOC_OK);
            assert_int_equal(count_lines(report, "lamp more than 20 km from all others", examples), 1);
            assert_int_equal(count_lines(report, "its coordinates seem exchanged", examples), i == 0);
            noc_report_destroy(report);
            noc_scene_destroy(s);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exchanged),
        cmocka_unit_test(by_distance),
#if NOC_HAVE_GDAL
        cmocka_unit_test(of_maps),
#endif
        cmocka_unit_test(rare_groups),
    };
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(log_);
    return remove_folder() || failed;
}
