/* Heights of lamps whose unit nobody wrote: by where lamps hang in their part of the world. */
#include "base/base.h"

#include "../told.h"

#include <math.h>

static char folder[] = "/tmp/noc-lamp-heights-XXXXXX";
#include "../folder.h"
static noc_log *log_;

static const char *table(const char *heading, const char *place, const char *heights) {
    static char text[4000];
    char copy[400], *rest = copy, *height;
    snprintf(copy, sizeof(copy), "%s", heights);
    size_t n = (size_t)snprintf(text, sizeof(text), "id,%s,lamp_type,fixture,%s\n",
                                strchr(place, '.') ? "lon,lat" : "x,y", heading);
    for (int i = 0; (height = strsep(&rest, " ")); i++) {
        bool lantern = *height == 'L';
        n += (size_t)snprintf(text + n, sizeof(text) - n, "a%d,%s%d,LED,%s,%s\n", i, place, i,
                              lantern ? "acorn" : "cobra", height + lantern);
    }
    return write_file("lamps.csv", text);
}

#define OHIO "-83.1,40.1"
#define KASSEL "9.5,51.3"

static void judged(void **state) {
    static const struct {
        const char *heading, *place, *heights, *columns;
        const char *told; /* NULL: nothing */
    } rows[] = {
        { "HEIGHT", OHIO, "25 30 30 14 25 35 30 25", NULL,
          "the median height of a lamp, of 8, is 30 m, which is hardly where street lamps of a land of feet hang: are "
          "heights in feet? Times 0.3048 the median is 9.14 m: --lamp-columns height_ft=HEIGHT says so, and "
          "height_m=HEIGHT that they are metres" },
        { "HEIGHT", OHIO, "25 30", NULL, "Times 0.3048 the median is 9.14 m" },
        { "HEIGHT", OHIO, "25 30 30", "height_ft=HEIGHT", NULL },
        { "HEIGHT", OHIO, "25 30 30", "height_m=HEIGHT", NULL },
        { "HEIGHT", OHIO, "25 30 30", "height=HEIGHT", "height_ft=HEIGHT says so" },
        { "Height (m)", OHIO, "25 30 30", NULL, NULL }, /* it is written */
        { "HEIGHT_FT", OHIO, "25 30 30", NULL, NULL },
        { "HEIGHT", OHIO, "25' 30ft 30m 28", NULL, NULL },
        { "HEIGHT", OHIO, "30", NULL, NULL }, /* one mast */
        { "HEIGHT", OHIO, "7.6 9.1 9.1 10.7 12.2 12.2 15.2", NULL, NULL },
        { "HEIGHT", OHIO, "10 10 10 12 10 12 25 30 10", NULL,
          "the height that nine in ten lamps do not exceed, of 9, is 25 m" },
        { "HEIGHT", OHIO, "9 9 L10 L12 L12", NULL, "the median height of a lantern, of 5, is 12 m" },
        { "HEIGHT", OHIO, "9 9 L4 L5 L4", NULL, NULL },
        { "HEIGHT", OHIO, "800 900 900", NULL, "centimetres? Times 0.01 the median is 9 m: --lamp-columns height_cm=" },
        { "HEIGHT", "174.7,-41.3", "14 14 15 14 16 15", NULL, NULL }, /* no land of feet */
        { "HEIGHT", KASSEL, "14 14 15 14 16 15", NULL, NULL },
        { "HEIGHT", KASSEL, "4 5 6 5 8 30", NULL, NULL },             /* a mast: in feet the others would be low */
        { "HEIGHT", KASSEL, "4 5 6 5 8 8 10 12 9 4 30", NULL, NULL }, /* one high mast in eleven */
        { "HEIGHT", KASSEL, "25 30 30 35", NULL, NULL },              /* too few */
        { "HEIGHT", KASSEL, "25 30 30 35 20", NULL, "are heights in feet?" },
        { "Masthoehe", KASSEL, "45 60 60 50 80", NULL,
          "decimetres? Times 0.1 the median is 6 m: --lamp-columns "
          "height_dm=Masthoehe" },
        { "Masthoehe", KASSEL, "450 600 600 500 800", NULL, "height_cm=Masthoehe says so" },
        { "Masthoehe", KASSEL, "4500 6000 6000 5000 8000", NULL, "height_mm=Masthoehe says so" },
        { "HEIGHT", "1000000,20000", "25 30 30", NULL, "height_ft=HEIGHT says so" }, /* EPSG:2263 is in feet */
    };
    for (size_t i = 0; i < NOC_COUNT(rows); i++) {
        noc_import_params params = noc_import_default_params();
        if (rows[i].columns)
            params.lamp_columns = (noc_texts){ .text = { rows[i].columns }, .count = 1 };
        params.crs = strchr(rows[i].place, '.') ? NULL : "EPSG:2263";
        for (int strict = 0; strict < 2; strict++) {
            noc_report *report;
            params.strict = strict;
            params.lamp_chosen = ~0u; /* what lamps leave out is not asked here */
            *told = 0;
            const char *path = table(rows[i].heading, rows[i].place, rows[i].heights);
            noc_status status = noc_inspect(log_, path, &params, &report);
            if ((rows[i].told ? !strstr(told, rows[i].told) : strstr(told, "hardly") != NULL) ||
                (strict && rows[i].told && (status != NOC_ERR_FORMAT || !strstr(told, "hardly in metres"))))
                fail_msg("%s %s: %d: %s", rows[i].heading, rows[i].heights, status, told);
            noc_report_destroy(report);
        }
    }
}

/* The option that the warning names makes it right: 25 ft. Loading says what inspecting does. */
static void mended(void **state) {
    REQUIRE_SHARED(path, "data/cases3/height_feet_no_unit.geojson");
    for (int mend = 0; mend < 2; mend++) {
        noc_import_params params = noc_import_default_params();
        noc_light_info light;
        noc_report *report;
        if (mend)
            params.lamp_columns = (noc_texts){ .text = { "height_ft=HEIGHT" }, .count = 1 };
        *told = 0;
        params.each_lamp = true;
        noc_scene *scene = noc_scene_create(log_);
        assert_int_equal(noc_scene_load(scene, &path, 1, &params, &report), NOC_OK);
        assert_int_equal(noc_scene_get_light(scene, 0, &light), NOC_OK);
        assert_float_equal(noc_report_get_lamp(report, 0)->height, mend ? 25 * .3048 : 25, .05);
        assert_int_equal(strstr(told, "height_ft=HEIGHT says so") != NULL, !mend);
        noc_report_destroy(report);
        noc_scene_destroy(scene);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = { cmocka_unit_test(judged), cmocka_unit_test(mended) };
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .level = NOC_LOG_WARN, .message = keep });
    int failed = cmocka_run_group_tests_name("import lamp heights", tests, NULL, NULL);
    noc_log_destroy(log_);
    return remove_folder() || failed;
}
