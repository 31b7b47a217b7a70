/* Tracks of cars: read from files, they become cars that are where the track is at a time. */
#include "test.h"

#include "import/import.h"
#include "noc_config.h"
#include "import/tracks/tracks.h"
#include "scene/scene.h"
#include <nocturne/nocturne.h>

#include <math.h>
#include <unistd.h>

#define DEGREE_N 111141.0 /* m of a degree of latitude at 45 N, and of longitude; to 1e-3, by GRS 80 */
#define DEGREE_E 78847.0
#define SLOPE 0.05

static char path[] = "/tmp/noc-tracks-XXXXXX";
static noc_log *log_;
static noc_scene *scene;
static noc_report *report;

static void forget(void) {
    noc_report_destroy(report);
    noc_scene_destroy(scene);
    report = NULL;
    scene = NULL;
}

/* A slope of 2 km around 15 E 45 N, the middle of zone 33, that rises to the east; and the file. */
static noc_status load(const noc_import_params *params, const char *text) {
    const double half = 1000, z = SLOPE * half,
                 p[12] = { -half, -half, -z, half, -half, z, half, half, z, -half, half, -z };
    const uint32_t t[6] = { 0, 1, 2, 0, 2, 3 };
    const noc_material terrain = noc_class_material(NOC_CLASS_TERRAIN);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
    forget();
    scene = noc_scene_create(log_);
    assert_int_equal(noc_scene_set_crs(scene, "EPSG:32633", (double[3]){ 500000, 4982950.4, 0 }), NOC_OK);
    noc_mesh mesh = { 4, p, 2, t, noc_scene_add_material(scene, &terrain), 0, 0, "slope" };
    assert_int_equal(noc_scene_add_mesh(scene, &mesh), 0);
    return noc_scene_load(scene, (const char *[]){ path }, 1, params, &report);
}

static void load_well(const char *text) {
    if (load(NULL, text))
        fail_msg("%s", noc_log_last_error(log_));
}

static size_t line(const char *reason) {
    const noc_report_file *f = noc_report_get_file(report, 0);
    for (size_t i = 0; i < f->line_count; i++)
        if (!strcmp(f->lines[i].reason, reason))
            return f->lines[i].count;
    return 0;
}

static const float *at(size_t car, double time) {
    assert_int_equal(noc_scene_set_time(scene, time), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    return scene->instances.data[scene->cars.data[car].instance].transform;
}

/* Within a metre: a car's middle cuts corners, for both its axles are on the track. */
static void assert_place(const float *m, double x, double y) {
    if (hypot(m[3] - x, m[7] - y) > 1)
        fail_msg("the car is at %g %g, not at %g %g", (double)m[3], (double)m[7], x, y);
    assert_true(fabs(m[11] - SLOPE * m[3]) < .02);
}

/* 100 m north in 10 s, stands for 10 s, 100 m east in 5 s; then another segment, 500 m away. */
static const char gpx[] =
    "<?xml version='1.0'?><gpx version='1.1' xmlns='http://www.topografix.com/GPX/1/1'><wpt lat='1' lon='1'/><trk>"
    "<name>a</name><trkseg><trkpt lat='45' lon='15'><time>2026-11-22T22:00:00Z</time></trkpt>"
    "<trkpt lat='45.00089976' lon='15'><ele>7</ele><time>2026-11-22T22:00:10Z</time></trkpt>"
    "<trkpt lat='45.00089976' lon='15'><time>2026-11-22T23:00:20+01:00</time></trkpt>"
    "<trkpt lat='45.00089976' lon='15.0012683'><time>2026-11-22T22:00:25.0Z</time></trkpt></trkseg>"
    "<trkseg><trkpt lat='45' lon='15.0063415'><time>2026-11-22T22:30:00Z</time></trkpt>"
    "<trkpt lat='44.99910024' lon='15.0063415'><time>2026-11-22T22:30:10Z</time></trkpt></trkseg></trk></gpx>";

static void test_gpx(void **state) {
    load_well(gpx);
    noc_scene_info info;
    noc_report_totals totals;
    noc_scene_get_info(scene, &info);
    noc_report_get_totals(report, &totals);
    assert_int_equal(info.cars, 1);
    assert_int_equal(totals.tracks, 1);
    assert_int_equal(totals.cars, 1);
    assert_string_equal(noc_report_get_file(report, 0)->format, "GPX");
    assert_int_equal(info.lights, 4); /* two headlamps, two tail lamps */
    const float *m = at(0, 5);
    assert_place(m, 0, 50);
    assert_true(fabsf(m[0]) < .01f && m[4] > .99f); /* forward is north */
    assert_place(at(0, 15), 0, 100);                /* it stands */
    m = at(0, 22.5);
    assert_place(m, 50, 100);
    assert_true(m[0] > .99f && fabs(m[8] - SLOPE) < .005f && m[10] > .99f); /* east, and up the slope */
    assert_place(at(0, 24.999), 100, 100);
    assert_place(at(0, 25.001), 500, 0); /* at once: nothing lies between */
    assert_place(at(0, 30), 500, -50);
    assert_true(m[4] < -.99f);
    assert_place(at(0, 34.999), 500, -100);
    assert_place(at(0, 35.001), 0, 0); /* and from the beginning */
    assert_place(at(0, -30), 0, 50);
    noc_light_info light;
    at(0, 22.5);
    int headlamp = noc_scene_instance_light(scene, 0, 0), tail = noc_scene_instance_light(scene, 0, 1);
    assert_int_equal(noc_scene_get_light(scene, (size_t)headlamp, &light), NOC_OK);
    assert_true(light.light.direction[0] > .99 && light.centre[0] > 52 && fabs(light.lumens - 700) < 1);
    assert_int_equal(noc_scene_get_light(scene, (size_t)tail, &light), NOC_OK);
    assert_true(light.light.direction[0] < -.99 && light.centre[0] < 48 && light.light.emission[1] == 0);
    assert_int_equal(noc_scene_set_time(scene, NAN), NOC_ERR_ARGUMENT);
}

/* A car that is taken away is not moved any more. */
/* Out of sight they are small, dark and under the ground; they drive on, and come back as they would be now. */
static void test_hidden(void **state) {
    char keys[3][NOC_CONTENT_KEY];
    noc_light_info light;
    load_well(gpx);
    at(0, 30);
    noc_scene_content(scene, keys[0]);
    at(0, 5);
    assert_int_equal(noc_scene_show_cars(scene, false), NOC_OK);
    const float *m = at(0, 30);
    assert_true(fabs(hypot(m[0], m[4]) - .001) < 1e-4);
    assert_true(fabs(m[11] - (SLOPE * m[3] - 2)) < .05);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(noc_scene_get_light(scene, (size_t)noc_scene_instance_light(scene, 0, i), &light), NOC_OK);
        assert_true(light.lumens == 0);
    }
    noc_scene_content(scene, keys[1]);
    assert_string_not_equal(keys[0], keys[1]);
    assert_int_equal(noc_scene_show_cars(scene, true), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    noc_scene_content(scene, keys[2]);
    assert_string_equal(keys[0], keys[2]);
}

static void test_removed(void **state) {
    load_well(gpx);
    assert_int_equal(noc_scene_remove_instance(scene, 0), NOC_OK);
    assert_int_equal(noc_scene_commit(scene), NOC_OK);
    assert_int_equal(noc_scene_set_time(scene, 3), NOC_OK);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_int_equal(info.cars, 0);
}

/* As the thesis has them, in whichever words: `end` parts tracks. */
static void test_points(void **state) {
    load_well("<points><point lat='45' lon='15' end='false'/><point lat='45.001' lon='15' end='true'/>"
              "<p><latitude>45</latitude><longitude> 15.005 </longitude><end>false</end></p>"
              "<p><latitude>45</latitude><longitude>15.006</longitude><end>true</end></p></points>");
    assert_string_equal(noc_report_get_file(report, 0)->format, "track points in XML");
    assert_int_equal(noc_report_get_file(report, 0)->tracks, 2);
    assert_int_equal(scene->cars.len, 2);
    assert_place(at(0, 3.6), 0, 40); /* 40 km/h */
    assert_place(at(1, 3.6), .005 * DEGREE_E + 40, 0);
    assert_place(at(0, 1e-3), 0, 0);
}

static void name_it(noc_import_params *params) {
    *params = noc_import_default_params();
    params->tracks = (noc_texts){ { path }, 1 };
}

/* Two tracks whose rows come by turns; times, or none. */
static void test_table(void **state) {
    noc_import_params params;
    name_it(&params);
    assert_int_equal(load(&params,
                          "Track ID;Time;lon;lat\na;2026-01-01T00:00:00Z;15;45\nb;2026-01-01T00:00:00Z;15.005;45\n"
                          "a;2026-01-01T00:00:10Z;15;45.001\nb;2026-01-01T00:00:20Z;15.005;45.001\n"
                          "b;late;x;45\n"),
                     NOC_OK);
    assert_int_equal(noc_report_get_file(report, 0)->tracks, 2);
    assert_int_equal(line("point of a track without a place"), 1);
    assert_int_equal(scene->cars.len, 2);
    assert_place(at(0, 5), 0, .0005 * DEGREE_N);
    assert_place(at(1, 5), .005 * DEGREE_E, .00025 * DEGREE_N);
    params.crs = "EPSG:32633";
    assert_int_equal(load(&params, "x,y\n500000,4982950.4\n500000,4983050.4\n"), NOC_OK);
    assert_place(at(0, 3.6), 0, 40);
    assert_int_equal(load(&params, "a,b\n1,2\n"), NOC_ERR_FORMAT); /* no coordinates */
    params.crs = NULL;
    params.tracks.count = 0;
    assert_int_equal(load(&params, "Track ID;Time;lon;lat\na;1;15;45\na;2;15;45.001\n"),
                     NOC_ERR_FORMAT); /* nobody says so */
}

#if NOC_HAVE_GDAL
static void test_maps(void **state) {
    noc_import_params params;
    name_it(&params);
    for (int isolate = 0; isolate < 2; isolate++) {
        params.isolate = isolate;
        assert_int_equal(load(&params,
                              "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{"
                              "\"route\":\"7\"},\"geometry\":{\"type\":\"MultiLineString\",\"coordinates\":[[[15,45],"
                              "[15,45.001]],[[15.005,45],[15.005,45.001]]]}}]}"),
                         NOC_OK);
        assert_int_equal(scene->cars.len, 2);
        assert_place(at(1, 3.6), .005 * DEGREE_E, 40);
        assert_int_equal(load(&params,
                              "<osm version='0.6'><node id='1' lat='45' lon='15'/><node id='2' lat='45.001' "
                              "lon='15'/><way id='3'><nd ref='1'/><nd ref='2'/><tag k='highway' v='service'/></way>"
                              "<way id='4'><nd ref='1'/><nd ref='2'/><tag k='railway' v='tram'/></way></osm>"),
                         NOC_OK);
        assert_int_equal(scene->cars.len, 1);
        assert_int_equal(line("line that cars do not drive on"), 1);
        assert_place(at(0, 3.6), 0, 40);
    }
}
#endif

#if NOC_HAVE_GDAL
#define FEATURE(type, properties, coordinates)                                                                         \
    "{\"type\":\"Feature\",\"properties\":{" properties "},\"geometry\":{\"type\":\"" type                             \
    "\",\"coordinates\":" coordinates "}}"
#define COLLECTION(features) "{\"type\":\"FeatureCollection\",\"features\":[" features "]}"
#define LINE "[[15,45],[15,45.001],[15,45.002]]"

/* 0.001 degrees in 10 s, and as much in 20 s, however times are written. */
static void test_timed_lines(void **state) {
    static const char *const ways[] = {
        "\"coordTimes\":[\"2026-11-22T22:00:00Z\",\"2026-11-22T22:00:10Z\",\"2026-11-22T23:00:30+01:00\"]",
        "\"times\":[100,110,130]",
        "\"times\":[100.5,110.5,130.5]",
        "\"times\":[1795392000000,1795392000010,1795392000030]",
        "\"coordinateProperties\":{\"times\":[\"5\",\"15\",\"35\"]}",
    };
    noc_import_params params;
    name_it(&params);
    for (size_t i = 0; i < NOC_COUNT(ways); i++) {
        char text[1000];
        params.isolate = i % 2;
        snprintf(text, sizeof(text), COLLECTION(FEATURE("LineString", "%s", LINE)), ways[i]);
        assert_int_equal(load(&params, text), NOC_OK);
        assert_int_equal(scene->cars.len, 1);
        assert_place(at(0, 5), 0, .0005 * DEGREE_N);
        assert_place(at(0, 20), 0, .0015 * DEGREE_N);
    }
}

/* Segments are parts of one track, and a car jumps from one to the next. */
static void test_timed_parts(void **state) {
    noc_import_params params;
    name_it(&params);
    for (int isolate = 0; isolate < 2; isolate++) {
        params.isolate = isolate;
        assert_int_equal(load(&params, COLLECTION(FEATURE("MultiLineString",
                                                          "\"@id\":\"trip\",\"coordTimes\":[[\"2026-11-22T22:00:00Z\","
                                                          "\"2026-11-22T22:00:10Z\"],[\"2026-11-22T23:00:00Z\","
                                                          "\"2026-11-22T23:00:20Z\"]]",
                                                          "[[[15,45],[15,45.001]],[[15.005,45],[15.005,45.001]]]"))),
                         NOC_OK);
        assert_int_equal(scene->cars.len, 1);
        assert_place(at(0, 5), 0, .0005 * DEGREE_N);
        assert_place(at(0, 20), .005 * DEGREE_E, .0005 * DEGREE_N);
    }
    assert_int_equal(load(&params, COLLECTION(FEATURE("LineString", "\"times\":[1,2]", LINE))), NOC_OK);
    assert_int_equal(line("track with more or fewer times than points, driven at one speed"), 1);
    assert_place(at(0, 3.6), 0, 40);
    assert_int_equal(load(&params, COLLECTION(FEATURE("LineString", "\"times\":\"[[1,2\"", LINE))), NOC_OK);
    assert_place(at(0, 3.6), 0, 40);
    assert_int_equal(load(&params, COLLECTION(FEATURE("LineString", "\"times\":[\"1\",\"late\",\"3\"]", LINE))),
                     NOC_OK);
    assert_int_equal(line("track with times at some of its points alone"), 1);
}

/* Points of two tracks by turns; a waypoint without a time among them. */
static void test_timed_points(void **state) {
    static const char *const times[][2] = { { "\"2026-11-22T22:00:00Z\"", "\"2026-11-22T23:00:10+01:00\"" },
                                            { "1000", "1010" },
                                            { "\"2026/11/22 22:00:00\"", "\"2026/11/22 22:00:10\"" } };
    static const char *const names[] = { "time", "timestamp", "time" };
    noc_import_params params;
    name_it(&params);
    for (size_t i = 0; i < NOC_COUNT(times); i++) {
        char text[2000];
        params.isolate = i % 2;
        snprintf(text, sizeof(text),
                 COLLECTION(FEATURE("Point", "\"track\":\"a\",\"%s\":%s", "[15,45]") "," FEATURE(
                     "Point", "\"track\":\"b\",\"%s\":%s",
                     "[15.005,45]") "," FEATURE("Point", "\"track\":\"a\",\"%s\":%s",
                                                "[15,45.001]") "," FEATURE("Point", "\"track\":\"b\",\"%s\":%s",
                                                                           "[15.005,45.002]")),
                 names[i], times[i][0], names[i], times[i][0], names[i], times[i][1], names[i], times[i][1]);
        assert_int_equal(load(&params, text), NOC_OK);
        assert_int_equal(scene->cars.len, 2);
        assert_place(at(0, 5), 0, .0005 * DEGREE_N);
        assert_place(at(1, 5), .005 * DEGREE_E, .001 * DEGREE_N);
    }
}
#endif

static void test_skipped(void **state) {
    load_well("<gpx><trk><trkseg><trkpt lat='45' lon='15'/></trkseg></trk><rte><rtept lat='45' lon='15'/><rtept "
              "lat='91' lon='15'/><rtept lat='45.00001' lon='15'/></rte><trk><trkseg><trkpt lat='47' lon='15'/><trkpt "
              "lat='47.1' lon='15'/></trkseg></trk></gpx>");
    assert_int_equal(line("track of fewer than two points"), 1);
    assert_int_equal(line("point of a track without a place"), 1);
    assert_int_equal(line("track too short to drive"), 1);
    assert_int_equal(line("track outside of the city"), 1);
    assert_int_equal(scene->cars.len, 0);
}

/* Times that run backwards are not believed; what is faster than a car jumps. */
static void test_times(void **state) {
    load_well("<gpx><trk><trkseg><trkpt lat='45' lon='15'><time>2026-01-01T00:00:09Z</time></trkpt><trkpt lat='45.001' "
              "lon='15'><time>2026-01-01T00:00:00Z</time></trkpt></trkseg></trk></gpx>");
    assert_int_equal(line("track whose times do not go forward, driven at one speed"), 1);
    assert_place(at(0, 3.6), 0, 40);
    load_well(
        "<gpx><trk><trkseg><trkpt lat='45' lon='15'><time>2026-01-01T00:00:00Z</time></trkpt><trkpt lat='45.0005' "
        "lon='15'><time>2026-01-01T00:00:05Z</time></trkpt><trkpt lat='45.005' "
        "lon='15'><time>2026-01-01T00:00:06Z</time></trkpt><trkpt lat='45.0055' "
        "lon='15'><time>2026-01-01T00:00:11Z</time></trkpt></trkseg></trk></gpx>");
    assert_int_equal(line("points of a track too far apart for its times, where a car jumps"), 1);
    assert_place(at(0, 5.001), 0, .005 * DEGREE_N);
    assert_true(track_time("1970-01-02T00:00:01.5Z") == 86401.5 && track_time("2000-03-01T00:00:00") == 951868800);
    assert_true(track_time("1969-12-31T23:00:00-01:00") == 0 && track_time(" 12.5 ") == 12.5);
    assert_true(isnan(track_time("yesterday")) && isnan(track_time("2000-13-01T00:00:00Z")));
}

static void test_switch(void **state) {
    noc_import_params params = noc_import_default_params();
    params.traffic = NOC_SWITCH_OFF;
    assert_int_equal(load(&params, gpx), NOC_OK);
    assert_int_equal(scene->cars.len, 0);
    params.traffic = NOC_SWITCH_AUTO;
    params.cars.time = 22.5;
    params.tracks = (noc_texts){ { path }, 1 }; /* the same file, once */
    assert_int_equal(load(&params, gpx), NOC_OK);
    assert_int_equal(scene->cars.len, 1);
    assert_place(scene->instances.data[0].transform, 50, 100);
    assert_int_equal(load(&params, "<gpx><trk></gpx>"), NOC_ERR_FORMAT);
    assert_int_equal(load(&params, "<!DOCTYPE gpx [<!ENTITY a 'b'>]><gpx>&a;</gpx>"), NOC_ERR_FORMAT);
}

static int start(void **state) {
    log_ = noc_log_create(NULL);
    int fd = mkstemp(path);
    return log_ && fd >= 0 ? close(fd) : -1;
}

static int finish(void **state) {
    forget();
    noc_log_destroy(log_);
    return remove(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gpx),
        cmocka_unit_test(test_removed),
        cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_skipped),
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_switch),
        cmocka_unit_test(test_table),
#if NOC_HAVE_GDAL
        cmocka_unit_test(test_maps),
        cmocka_unit_test(test_timed_lines),
        cmocka_unit_test(test_timed_parts),
        cmocka_unit_test(test_timed_points),
#endif
    };
    return cmocka_run_group_tests(tests, start, finish);
}
