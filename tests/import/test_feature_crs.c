/* Files whose features have CRSs, or numbers, of their own: each lamp stands where its own CRS says, and one whose
 * coordinates are no numbers stands nowhere. */
#include "base/base.h"
#include "scene/scene.h"

#include "../told.h"
#include "noc_config.h"

#include <math.h>
#include <unistd.h>

static char folder[] = "/tmp/noc-feature-crs-XXXXXX";
#include "../folder.h"
static noc_log *log_;

#define HEAD                                                                                                           \
    "<?xml version=\"1.0\"?>\n<wfs:FeatureCollection xmlns:wfs=\"http://www.opengis.net/wfs/2.0\" "                    \
    "xmlns:gml=\"http://www.opengis.net/gml/3.2\" xmlns:app=\"http://example.invalid/app\">\n"
#define UTM33 "urn:ogc:def:crs:EPSG::25833"
#define UTM32 "http://www.opengis.net/def/crs/EPSG/0/25832"
#define DEGREES "urn:ogc:def:crs:EPSG::4326"

/* A lamp 8 m high with that in its point. */
static char *lamp(char *end, const char *id, const char *attributes, const char *point) {
    return end + sprintf(end,
                         "<wfs:member><app:lamp gml:id=\"%s\"><app:lamp_height>8</app:lamp_height><app:geom><gml:Point "
                         "%s>%s</gml:Point></app:geom></app:lamp></wfs:member>\n",
                         id, attributes, point);
}

typedef struct loaded {
    noc_scene *scene;
    noc_report *report;
    noc_status status;
} loaded;

static loaded load(const char *name, const char *text, bool strict) {
    loaded l = { .scene = noc_scene_create(log_) };
    noc_import_params p = noc_import_default_params();
    p.windows = NOC_SWITCH_OFF;
    p.strict = strict;
    p.lamp_chosen = ~0u;
    const char *paths[] = { write_file(name, text) };
    told[0] = 0;
    l.status = noc_scene_load(l.scene, paths, 1, &p, &l.report);
    return l;
}

static void done(loaded *l) {
    noc_report_destroy(l->report);
    noc_scene_destroy(l->scene);
}

/* A lamp's light hangs at most 2 m from its foot. */
static void expect_lights(const loaded *l, const double (*places)[2], size_t count) {
    if (l->status || l->scene->lights.len != count)
        fail_msg("%zu lights: %s", l->scene->lights.len, told);
    for (size_t i = 0; i < count; i++) {
        double nearest = INFINITY;
        for (size_t k = 0; k < count; k++) {
            const float *p = l->scene->lights.data[k].p;
            nearest = NOC_MIN(nearest, hypot(p[0] + l->scene->origin[0] - places[i][0],
                                             p[1] + l->scene->origin[1] - places[i][1]));
        }
        if (!(nearest < 2.2))
            fail_msg("no light within 2 m of %.1f %.1f: the nearest is %g m off", places[i][0], places[i][1], nearest);
    }
}

/* How often a reason that has the text is counted; its examples must have the other. */
static size_t counted(const loaded *l, const char *reason, const char *example) {
    size_t count = 0;
    const noc_report_file *f = noc_report_get_file(l->report, 0);
    for (size_t i = 0; f && i < f->line_count; i++)
        if (strstr(f->lines[i].reason, reason) && strstr(f->lines[i].examples, example))
            count += f->lines[i].count;
    return count;
}

/* ---- CRSs ---- */

static const double street[][2] = {
    { 390000, 5820000 }, { 390030, 5820000 }, { 390060, 5820000 }, { 390090, 5820000 }
};

static void a_crs_of_each_point(void **state) {
    (void)state;
    char text[4000], *end = text + sprintf(text, HEAD);
    end = lamp(end, "a", "srsName=\"" UTM33 "\"", "<gml:pos>390000 5820000</gml:pos>");
    end = lamp(end, "b", "srsName=\"" UTM33 "\"", "<gml:pos>390030 5820000</gml:pos>");
    end = lamp(end, "c", "srsName='" UTM32 "'", "<gml:pos>797103.864 5827784.999</gml:pos>");
    end = lamp(end, "d", "gml:id='>' srsName = \"" DEGREES "\"", "<gml:pos>52.5190134712 13.3801376199</gml:pos>");
    sprintf(end, "</wfs:FeatureCollection>\n");
    loaded l = load("each.gml", text, true);
    expect_lights(&l, street, 4);
    assert_string_equal(l.scene->crs_name, "EPSG:25833 (ETRS89 / UTM zone 33N)");
    assert_int_equal(counted(&l, "CRS beside another in one file", "EPSG:25832"), 2);
    const noc_report_file *f = noc_report_get_file(l.report, 0); /* in the first CRS */
    assert_true(f->extent_min[0] == 390000 && f->extent_max[0] == 390030);
    done(&l);
}

/* Envelopes say it of what is in their feature, or in all. */
static void a_crs_of_envelopes(void **state) {
    (void)state;
    char text[4000], *end = text + sprintf(text, HEAD);
    end += sprintf(end, "<!-- srsName=\"" DEGREES "\" --><gml:boundedBy><gml:Envelope srsName=\"" UTM33
                        "\"><gml:lowerCorner>0 0</gml:lowerCorner></gml:Envelope></gml:boundedBy>");
    end = lamp(end, "a", "", "<gml:pos>390000 5820000</gml:pos>");
    end = lamp(end, "b", "", "<gml:coordinates>390030,5820000</gml:coordinates>");
    end += sprintf(end, "<wfs:member><app:lamp><gml:boundedBy><gml:Envelope srsName=\"" DEGREES
                        "\"/></gml:boundedBy><app:lamp_height>8</app:lamp_height><app:geom><gml:Point>"
                        "<gml:pos>52.51900742022 13.3796956697</gml:pos></gml:Point></app:geom></app:lamp>"
                        "</wfs:member>");
    end = lamp(end, "d", "srsName='" UTM32 "'", "<gml:pos>797133.788 5827787.493</gml:pos>");
    sprintf(end, "</wfs:FeatureCollection>\n");
    loaded l = load("envelopes.gml", text, true);
    expect_lights(&l, street, 4);
    done(&l);
}

static void a_crs_that_is_not_known(void **state) {
    (void)state;
    char text[4000], *end = text + sprintf(text, HEAD);
    end = lamp(end, "a", "srsName=\"urn:city:crs:OURS\"", "<gml:pos>390000 5820000</gml:pos>");
    sprintf(end, "</wfs:FeatureCollection>\n");
    loaded l = load("ours.gml", text, false);
    assert_int_equal(l.status, NOC_ERR_FORMAT);
    if (!strstr(told, "ours.gml:3: the CRS \"urn:city:crs:OURS\" is not understood"))
        fail_msg("%s", told);
    done(&l);
    end = text + sprintf(text, HEAD);
    end = lamp(end, "a", "srsName=\"" UTM33 "\"", "<gml:pos>390000 5820000</gml:pos>");
    end = lamp(end, "b", "", "<gml:pos>390030 5820000</gml:pos>");
    end = lamp(end, "c", "srsName=\"" UTM32 "\"", "<gml:pos>797103.864 5827784.999</gml:pos>");
    sprintf(end, "</wfs:FeatureCollection>\n");
    l = load("unnamed.gml", text, false); /* the second one could be in either */
    assert_int_equal(l.scene->lights.len, 2);
    assert_int_equal(counted(&l, "lamp without a CRS, in a file that names several", "b"), 1);
    done(&l);
}

/* GDAL takes all of a GeoJSON in one. */
static void a_crs_of_geojson_features(void **state) {
    (void)state;
#define NAMED(crs) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" crs "\"}}"
#define FEATURE(more, at)                                                                                              \
    "{\"type\":\"Feature\"," more "\"properties\":{\"highway\":\"street_lamp\",\"height\":\"8\",\"crs\":\"EPSG:1\"},"  \
    "\"geometry\":{\"type\":\"Point\",\"coordinates\":[" at "]}}"
    static const struct {
        const char *text, *error; /* NULL: none */
    } cases[] = {
        { "{\"type\":\"FeatureCollection\"," NAMED("EPSG:25833") ",\"features\":[" FEATURE(
              "", "390000,5820000") "," FEATURE(NAMED("EPSG:25832") ",", "797103.864,5827784.999") "]}",
          "feature 2 has the CRS {\"type\":\"name\",\"properties\":{\"name\":\"EPSG:25832\"}} of its own, the file "
          "{\"type\":\"name\",\"properties\":{\"name\":\"EPSG:25833\"}}" },
        { "{\"type\":\"FeatureCollection\",\"features\":[" FEATURE("", "13.38,52.519") "," FEATURE(
              NAMED("EPSG:25832") ",", "797103.864,5827784.999") "]}",
          "feature 2 has the CRS {\"type\":\"name\",\"properties\":{\"name\":\"EPSG:25832\"}} of its own, the file "
          "none" },
        { "{\"type\":\"FeatureCollection\",\"features\":[" FEATURE(
              NAMED("EPSG:25833") ",", "390000,5820000") "," FEATURE("", "390030,5820000") "]," NAMED("EPSG:25833") "}",
          NULL },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        loaded l = load("features.geojson", cases[i].text, false);
        assert_int_equal(l.status, cases[i].error ? NOC_ERR_FORMAT : NOC_OK);
        if (cases[i].error && !strstr(told, cases[i].error))
            fail_msg("%s", told);
        if (!cases[i].error)
            expect_lights(&l, street, 2);
        done(&l);
    }
}

/* ---- coordinates ---- */

static void coordinates_that_are_no_numbers(void **state) {
    (void)state;
    static const struct {
        const char *point, *value;
    } bad[] = {
        { "<gml:pos>390010,5 5820000,5</gml:pos>", "\"390010,5 5820000,5\"" },
        { "<gml:pos>390010.5,5820000.5</gml:pos>", "\"390010.5,5820000.5\"" },
        { "<gml:pos>inf 5820000</gml:pos>", "\"inf 5820000\"" },
        { "<gml:pos>390010 NaN</gml:pos>", "\"390010 NaN\"" },
        { "<gml:pos>390010 1e400</gml:pos>", "\"390010 1e400\"" },
        { "<gml:pos>390010</gml:pos>", "\"390010\"" },
        { "<gml:pos>  </gml:pos>", "\"\"" },
        { "<gml:pos/>", "\"\"" },
        { "<gml:pos>here &amp; there</gml:pos>", "\"here ?amp; there\"" },
        { "<gml:coordinates>390010 5820000x</gml:coordinates>", "\"390010 5820000x\"" },
        { "<gml:coord><gml:X>390010</gml:X><gml:Y>nan</gml:Y></gml:coord>", "\"nan\"" },
    };
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        char text[4000], *end = text + sprintf(text, HEAD);
        end = lamp(end, "a", "srsName=\"" UTM33 "\"", "<gml:pos>\n390000 5820000 0</gml:pos>");
        end = lamp(end, "b", "srsName=\"" UTM33 "\"", bad[i].point);
        end = lamp(end, "c", "srsName=\"" UTM33 "\"",
                   "<gml:coordinates decimal=\",\" cs=\" \" ts=\";\">390030,0 5820000,0</gml:coordinates>");
        sprintf(end, "</wfs:FeatureCollection>\n");
        loaded l = load("numbers.gml", text, false);
        expect_lights(&l, street, 2);
        if (counted(&l, "lamp whose coordinates are not numbers", bad[i].value) != 1)
            fail_msg("%s is not counted", bad[i].value);
        done(&l);
        l = load("numbers.gml", text, true);
        assert_int_equal(l.status, NOC_ERR_FORMAT);
        done(&l);
    }
}

int main(void) {
#if NOC_HAVE_GDAL
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_crs_of_each_point),
        cmocka_unit_test(a_crs_of_envelopes),
        cmocka_unit_test(a_crs_that_is_not_known),
        cmocka_unit_test(a_crs_of_geojson_features),
        cmocka_unit_test(coordinates_that_are_no_numbers),
    };
    assert_non_null(mkdtemp(folder));
    log_ = noc_log_create(&(noc_log_params){ .message = keep, .level = NOC_LOG_WARN });
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    noc_log_destroy(log_);
    return remove_folder() || failed;
#else
    return 77;
#endif
}
