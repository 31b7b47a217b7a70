/* What the importer makes of inputs: surfaces, lamps, ground, colours, reports, errors. From a fake reader, and on real
 * files. */
#include "fake_reader.h"

#include "noc_config.h"

static void test_city(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("a.city", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:25832 (ETRS89 / UTM zone 32N)");
    /* crs = local + origin, heights as they are */
    assert_true(r.info.origin[0] == rint(r.info.origin[0]) && r.info.origin[2] == 0);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(noc_report_file_count(r.report), 1);
    assert_null(noc_report_get_file(r.report, 1));
    assert_int_equal(f->objects, 1);
    assert_int_equal(f->buildings, 1);
    assert_int_equal(f->lod_used[2], 1);
    assert_int_equal(f->polygons, 4);
    assert_int_equal(f->polygons_by_class[NOC_CLASS_CLOSURE], 1);
    assert_int_equal(f->triangles, 6); /* the closure surface is not rendered */
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_CLOSURE], 0);
    assert_string_equal(f->format, "fake");
    assert_string_equal(f->crs_given, "EPSG:25832");
    assert_close(f->extent_min[0], 678000.5, 1e-6);
    assert_close(f->extent_max[1], 5404010.5, 1e-6);
    assert_close(f->extent_max[2], 380, 0);
    assert_int_equal(f->bytes, strlen(CITY));
    /* a mesh an object and class, named by the object */
    size_t named = 0;
    for (size_t i = 0; i < r.scene->meshes.len; i++)
        named += r.scene->meshes.data[i].name && !strcmp(r.scene->meshes.data[i].name, "house");
    assert_int_equal(named, 3);
    /* the corner is where it was */
    double lo[3] = { INFINITY, INFINITY, INFINITY };
    for (size_t i = 0; i < r.scene->meshes.len; i++) {
        const noc_scene_mesh *m = &r.scene->meshes.data[i];
        for (size_t k = 3 * (size_t)m->first_triangle;
             m->name && k < 3 * (size_t)(m->first_triangle + m->triangle_count); k++)
            for (int c = 0; !strcmp(m->name, "house") && c < 3; c++)
                lo[c] =
                    NOC_MIN(lo[c], (double)r.scene->positions.data[3 * (size_t)r.scene->indices.data[k] + (size_t)c]);
    }
    assert_close(lo[0] + r.info.origin[0], 678000.5, 1e-4);
    assert_close(lo[1] + r.info.origin[1], 5404000.5, 1e-4);
    assert_close(lo[2], 370, 1e-4);
    finish(&r);
}

static void test_lamps(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("far.lamps", NEAR_LAMP "lamp 12.5 48.8\nlamp 999 999\n"), file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    /* the report follows the inputs' order, though the city is read first */
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_true(has_line(f, "lamp more than 2 km outside the city", 1));
    assert_true(has_line(f, "coordinates that have no place in the scene's CRS", 1));
    assert_int_equal(f->lamps, 2);
    assert_int_equal(f->lights, r.info.lights);
    assert_int_equal(r.info.lights_inferred, 0);
    assert_int_equal(r.warnings, 1); /* light that is missing is told by whatever command loads it */
    assert_non_null(strstr(r.last_warning, "far.lamps: 2 of 3 lamps are left out: 1 outside the city, the nearest 7"));
    assert_non_null(strstr(r.last_warning, "1 without a place in it"));
    assert_null(strstr(r.last_warning, "exchanged"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("slip.lamps", NEAR_LAMP "lamp 48.76231 11.42278\n"), file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_non_null(strstr(r.last_warning, "1 of 2 lamps is left out"));
    assert_non_null(strstr(r.last_warning, "; the coordinates of 1 seem exchanged, longitude and latitude"));
    finish(&r);
    noc_report_totals totals;
    noc_report_get_totals(NULL, &totals);
    assert_int_equal(totals.lamps_mapped + totals.lamps_dropped + totals.skipped, 0);
    /* a piece of street and lamps around it: there is a ground under them, and it does not cover the street */
    LOAD(&r, DEFAULTS,
         file("a", "FAKE city\ncrs EPSG:25832\nobject 2 r -1\npolygon 9 678000 5404000 370 678030 5404000 370 "
                   "678030 5404020 370 678000 5404020 370\nend\n"),
         file("l", "FAKE lamps\ncrs EPSG:25832\nlamp 678015 5404010\nlamp 678100 5404080\nlamp 677900 5404010\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights, 3);
    for (size_t i = 0; i < 3; i++) {
        double height;
        assert_true(noc_scene_ground(r.scene, r.scene->lights.data[i].p[0], r.scene->lights.data[i].p[1], &height));
        assert_close(height + r.scene->origin[2], i ? 370 - .02 : 370, 1e-3);
        assert_close(r.scene->lights.data[i].p[2] - height, 6, .03);
    }
    finish(&r);
    /* beside the city, and out of it: drawn, and told (the house ends at 678010.5) */
    for (int far = 0; far < 2; far++) {
        LOAD(&r, DEFAULTS, file("a", CITY),
             file("l", far ? "FAKE lamps\ncrs EPSG:25832\nlamp 679410 5404005\nlamp 679440 5404005\n"
                           : "FAKE lamps\ncrs EPSG:25832\nlamp 678155 5404005\nlamp 679440 5404005\n"));
        assert_int_equal(r.status, NOC_OK);
        assert_int_equal(r.info.lights, 2);
        assert_int_equal(r.warnings, far);
        assert_true(!far ||
                    strstr(r.last_warning, "none of the lamps stands in the city: the nearest is 1.4 km from it"));
        noc_camera camera; /* the views look at the house */
        assert_int_equal(noc_scene_camera(r.scene, NOC_VIEWPOINT_AERIAL, 1.5, &camera), NOC_OK);
        assert_true(hypot(camera.target[0] + r.info.origin[0] - 678005, camera.target[1] + r.info.origin[1] - 5404005) <
                    300);
        finish(&r);
    }
    /* lamps alone make a scene too: nothing they could be outside of */
    LOAD(&r, DEFAULTS, file("l", "FAKE lamps\ncrs EPSG:4326\nlamp 52.5 13.4\nlamp 52.6 13.4\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(r.info.crs, "EPSG:32633 (WGS 84 / UTM zone 33N)");
    assert_true(r.info.lights >= 2);
    double ground, z; /* they light a ground, and all stand on it */
    for (size_t i = 0; i < r.info.lights; i++) {
        const float *at = r.scene->lights.data[i].p;
        assert_true(noc_scene_ground(r.scene, at[0], at[1], &z));
        ground = i ? ground : z;
        assert_close(z, ground, 1e-3);
        assert_close(at[2] - z, 6, 1e-3);
    }
    finish(&r);
}

/* Lamps that are all of no use: an error that tries the other order of axes, unless lamps by a rule were asked for. */
static void test_useless_lamps(void **state) {
    (void)state;
    struct run r;
    static const struct {
        const char *text, *says;
    } cases[] = {
        /* Berlin, 440 km */
        { "crs EPSG:4326\nlamp 52.5 13.4\n", "none of 1 lamp is of use, 1 outside the city, the nearest 4" },
        { "crs OGC:CRS84\nlamp 11.2 11.4\nlamp 48.76231 11.42278\nlamp 48.76240 11.42278\n",
          "3 outside the city, the nearest 4" }, /* in Nigeria and Somalia; the first tells no order */
        { "crs OGC:CRS84\nlamp 11.2 11.4\nlamp 48.76231 11.42278\nlamp 48.76240 11.42278\n",
          "with longitude and latitude exchanged 2 of them fall within the city" },
        { "crs EPSG:25832\nlamp 5404010 nan\nlamp nan nan\n", "2 without a place in it" },
    };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        char text[300];
        snprintf(text, sizeof(text), "FAKE lamps\n%s", cases[i].text);
        for (int infer = NOC_SWITCH_OFF; infer <= NOC_SWITCH_AUTO; infer++) {
            noc_import_params p = DEFAULTS;
            p.infer_lamps = (noc_switch)infer;
            LOAD(&r, p, file("a", CITY), file("useless.lamps", text));
            assert_int_equal(r.status, infer == NOC_SWITCH_ON ? NOC_OK : NOC_ERR_FORMAT);
            noc_report_totals t;
            noc_report_get_totals(r.report, &t);
            assert_int_equal(t.lamps_mapped, 0);
            assert_int_equal(t.lamps_dropped, i == 0 ? 1 : i == 3 ? 2 : 3);
            const noc_report_file *city = noc_report_get_file(r.report, 0), *lamps = noc_report_get_file(r.report, 1);
            assert_int_equal(t.objects, city->objects);
            assert_int_equal(t.buildings, city->buildings);
            assert_int_equal(t.bytes_read, city->bytes_read + lamps->bytes_read);
            assert_true(t.buildings > 0 && t.bytes_read > strlen(text));
            if (infer == NOC_SWITCH_ON) {
                assert_int_equal(r.warnings, 2); /* why, and how many were inferred */
                assert_int_equal(t.lamps_inferred, r.info.lights);
                assert_true(r.info.lights > 0);
            } else {
                const char *said = noc_log_last_error(r.log);
                assert_non_null(strstr(said, "useless.lamps: none of"));
                assert_non_null(strstr(said, cases[i].says));
                assert_int_equal(!strstr(said, "exchanged"), i == 0 || i == 3);
            }
            finish(&r);
        }
    }
    /* one of use is enough */
    LOAD(&r, DEFAULTS, file("a", CITY), file("b", NEAR_LAMP "lamp 52.5 13.4\n"));
    assert_int_equal(r.status, NOC_OK);
    noc_report_totals t;
    noc_report_get_totals(r.report, &t);
    assert_int_equal(t.lamps_mapped, 1);
    assert_int_equal(t.lamps_dropped, 1);
    assert_int_equal(t.skipped, 1);
    finish(&r);
}

/* --strict: what is left out or guessed at ends it, with the causes; what is clean goes through, and so does what loses
 * nothing by its repair, or by being left out. */
static void test_strict(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = DEFAULTS;
    p.strict = true;
    p.lamp_chosen = (1u << NOC_LAMP_DEFAULT_COUNT) - 1;
    LOAD(&r, p, file("a", CITY), file("l", NEAR_LAMP));
    assert_int_equal(r.status, NOC_OK);
    finish(&r);
    p.infer_lamps = NOC_SWITCH_OFF; /* that is another one's matter */
    const char *bad =
        "object 0 bad 1\npolygon 1 678000 5404000 0 678001 5404000 0\npolygon 1 nan nan nan nan nan nan nan nan nan\n"
        "end\n";
    char text[2000];
    snprintf(text, sizeof(text), "%s%s", CITY, bad);
    LOAD(&r, p, file("rough.city", text));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    const char *said = noc_log_last_error(r.log);
    assert_non_null(strstr(said, "left out: 2, guessed at: 0"));
    assert_non_null(strstr(said, "rough.city: 1 x ring with too few points (poly)"));
    assert_non_null(strstr(said, "1 x coordinates that are not finite"));
    finish(&r);
    char other[2000];
    snprintf(other, sizeof(other), "%s%s", CITY,
             "object 0 lossless 1\n"
             "polygon 1 678000 5404000 0 678001 5404000 0 678001 5404000 0 678001 5404001 0\n" /* a point twice */
             "polygon 1 678000 5404000 0 678001 5404000 0 678002 5404000 0\nend\n");           /* no area */
    LOAD(&r, p, file("plain.city", other));
    assert_int_equal(r.status, NOC_OK);
    noc_report_totals totals;
    noc_report_get_totals(r.report, &totals);
    assert_int_equal(totals.skipped, 1);
    assert_int_equal(totals.repaired, 1);
    finish(&r);
    snprintf(other, sizeof(other), "%s%s", CITY,
             "object 0 eight 1\npolygon 1 678000 5404000 0 678001 5404001 0 678001 5404000 0 "
             "678000 5404001 0\nend\n");
    LOAD(&r, p, file("eight.city", other));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "left out: 0, guessed at: 1"));
    assert_non_null(strstr(noc_log_last_error(r.log), "1 x self-intersecting ring"));
    finish(&r);
    LOAD(&r, p, file("a", CITY), file("l", NEAR_LAMP "lamp 52.5 13.4\n"));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(strstr(noc_log_last_error(r.log), "1 x lamp more than 2 km outside the city"));
    finish(&r);
    start(&r);
    load_with(&r, p, true, PATHS(file("rough.city", text))); /* to be looked at, too, and the report is there */
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(noc_report_get_file(r.report, 0)->line_count, 2);
    finish(&r);
}

/* What the defaults stand in for is counted, and strict takes it only where the user said the default. */
static void test_assumed(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = DEFAULTS;
    const char *const lamps = NEAR_LAMP;
    noc_report_totals t;
    LOAD(&r, p, file("a", CITY), file("l", lamps));
    assert_int_equal(r.status, NOC_OK);
    noc_report_get_totals(r.report, &t);
    assert_int_equal(t.lamps_mapped, 1);
    for (int what = 0; what < NOC_LAMP_DEFAULT_COUNT; what++)
        assert_int_equal(t.lamps_assumed[what], what != NOC_LAMP_EFFICACY);
    finish(&r);
    p.strict = true;
    p.lamp_chosen = 1u << NOC_LAMP_HEIGHT | 1u << NOC_LAMP_COLOUR | 1u << NOC_LAMP_DIRECTION;
    LOAD(&r, p, file("a", CITY), file("l", lamps));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    const char *said = noc_log_last_error(r.log);
    assert_non_null(strstr(said, "guessed at: 1; 1 x lamp without flux (--lamp-lumens 5000 takes that)"));
    assert_null(strstr(said, "without height"));
    finish(&r);
    start(&r); /* the same of a file that is looked at */
    load_with(&r, p, true, PATHS(file("l", lamps)));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(noc_report_get_file(r.report, 0)->lamps_assumed[NOC_LAMP_FLUX], 1);
    assert_int_equal(noc_report_get_file(r.report, 0)->lamps_assumed[NOC_LAMP_DIRECTION], 0); /* it stands nowhere */
    finish(&r);
}

/* A strict picture is not lit by lamps that nobody gave or asked for. */
static void test_strict_inferred(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = DEFAULTS;
    p.strict = true;
    LOAD(&r, p, file("a", CITY));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_non_null(
        strstr(noc_log_last_error(r.log), "placed by a rule (--lamps FILE gives some, --infer-lamps takes these"));
    finish(&r);
    p.infer_lamps = NOC_SWITCH_ON;
    LOAD(&r, p, file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_true(r.info.lights_inferred > 0);
    finish(&r);
    p.infer_lamps = NOC_SWITCH_OFF;
    LOAD(&r, p, file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    finish(&r);
}

static void test_inferred_lamps(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS, file("a", CITY));
    assert_int_equal(r.status, NOC_OK);
    assert_true(r.info.lights > 0);
    assert_int_equal(r.info.lights_inferred, r.info.lights);
    assert_non_null(strstr(r.last_warning, "inferred"));
    finish(&r);
    noc_import_params p = DEFAULTS;
    p.infer_lamps = false;
    LOAD(&r, p, file("a", CITY));
    assert_int_equal(r.info.lights, 0);
    assert_int_equal(r.warnings, 1); /* a dark scene is said to be one */
    assert_non_null(strstr(r.last_warning, "nothing in the scene shines"));
    finish(&r);
    /* terrain alone is no place for lamps; that, and nothing at all, is worth a word */
    LOAD(&r, DEFAULTS,
         file("a", "FAKE city\ncrs EPSG:25832\npolygon 8 677900 5403900 370 678100 5403900 370 678000 5404200 370\n"));
    assert_int_equal(r.info.lights, 0);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "nothing in the scene shines"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", "FAKE city\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.warnings, 1);
    assert_non_null(strstr(r.last_warning, "nothing that can be seen"));
    finish(&r);
    /* what shines already, and what is no city, gets none */
    LOAD(&r, DEFAULTS, file("m", "FAKE mesh\n"));
    assert_int_equal(r.status, NOC_OK);
    assert_int_equal(r.info.lights_inferred, 0);
    assert_int_equal(r.info.lights, 1);
    assert_int_equal(r.info.triangles, 1); /* no ground either */
    assert_int_equal(noc_report_get_file(r.report, 0)->lights, 1);
    finish(&r);
}

/* Houses without terrain stand on ground that is laid for them; with terrain they do not. */
static void test_ground(void **state) {
    (void)state;
    struct run r;
    noc_import_params p = DEFAULTS;
    p.infer_lamps = false;
    LOAD(&r, p, file("a", CITY));
    assert_true(r.info.triangles_by_class[NOC_CLASS_TERRAIN] > 0);
    finish(&r);
    LOAD(&r, p,
         file("a", CITY "object 1 dem -1\npolygon 8 677900 5403900 370 678100 5403900 370 678000 5404200 370\nend\n"));
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_TERRAIN], 1);
    finish(&r);
    LOAD(&r, p,
         file("a", CITY
              "object 2 r -1\npolygon 9 677990 5403990 370 678020 5403990 370 678020 5404020 370 677990 5404020 370\n"
              "end\n"));
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_TERRAIN], 0);
    assert_int_equal(r.info.triangles_by_class[NOC_CLASS_ROAD], 2);
    finish(&r);
}

static void test_materials_vary(void **state) {
    (void)state;
    struct run r;
    char text[20000] = "FAKE city\ncrs EPSG:25832\n";
    for (int i = 0; i < 60; i++) {
        char object[300];
        snprintf(object, sizeof(object), "object 0 DEBY_%d 2\npolygon 1 %d 5404000 0 %d 5404000 0 %d 5404000 9\nend\n",
                 4000 + i, 678000 + 20 * i, 678010 + 20 * i, 678010 + 20 * i);
        strcat(text, object);
    }
    LOAD(&r, DEFAULTS, file("a", text));
    bool used[1000] = { false };
    size_t walls = 0;
    for (size_t i = 0; i < r.scene->meshes.len; i++) {
        int m = r.scene->meshes.data[i].material;
        if (r.scene->materials.data[m].cls == NOC_CLASS_WALL && !used[m]) {
            used[m] = true;
            walls++;
        }
    }
    assert_in_range(walls, PALETTE - 2, PALETTE);
    /* the same id has the same colour in every run */
    struct run again;
    LOAD(&again, DEFAULTS, file("a", text));
    for (size_t i = 0; i < 60; i++)
        assert_memory_equal(r.scene->materials.data[r.scene->meshes.data[i].material].albedo,
                            again.scene->materials.data[again.scene->meshes.data[i].material].albedo, sizeof(float[3]));
    finish(&r);
    finish(&again);
}

static void test_errors(void **state) {
    (void)state;
    struct run r;
    char absent[300];
    snprintf(absent, sizeof(absent), "%s/absent", folder);
    /* all inputs are opened before any is read */
    LOAD(&r, DEFAULTS, file("a", CITY), absent);
    assert_int_equal(r.status, NOC_ERR_IO);
    assert_int_equal(reads, 0);
    assert_int_equal(noc_report_file_count(r.report), 0);
    finish(&r);
    LOAD(&r, DEFAULTS, file("a", CITY), file("x", "what is this\n"));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(reads, 0);
    assert_non_null(strstr(noc_log_last_error(r.log), "fake city, fake lamps"));
    finish(&r);
    LOAD(&r, DEFAULTS, file("empty", ""));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    finish(&r);
    LOAD(&r, DEFAULTS, file("m", "FAKE missing\n"));
    assert_int_equal(r.status, NOC_ERR_UNSUPPORTED);
    assert_non_null(strstr(noc_log_last_error(r.log), "this build lacks it"));
    finish(&r);
    /* a reader's error ends it; the report holds what came before */
    LOAD(&r, DEFAULTS, file("f", CITY "fail\n"));
    assert_int_equal(r.status, NOC_ERR_FORMAT);
    assert_int_equal(noc_report_get_file(r.report, 0)->polygons, 4);
    assert_false(r.scene->committed);
    finish(&r);
    noc_import_params bad[] = { DEFAULTS, DEFAULTS, DEFAULTS, DEFAULTS };
    bad[0].lod = 5, bad[1].lamp_height = 0, bad[2].lamp_lumens = NAN, bad[3].lamp_kelvin = 10;
    for (size_t i = 0; i < NOC_COUNT(bad); i++) {
        LOAD(&r, bad[i], file("a", CITY));
        assert_int_equal(r.status, NOC_ERR_ARGUMENT);
        finish(&r);
    }
    start(&r);
    load_with(&r, DEFAULTS, false, 0, NULL);
    assert_int_equal(r.status, NOC_ERR_ARGUMENT);
    finish(&r);
}

static void test_bad_features(void **state) {
    (void)state;
    struct run r;
    LOAD(&r, DEFAULTS,
         file("a", CITY "object 0 bad 1\npolygon 1 678000 5404000 0 678001 5404000 0\n"
                        "polygon 1 nan nan nan nan nan nan nan nan nan\n"
                        "polygon 1 1e9 1e30 0 1e9 1e31 0 1e30 1e30 0\n"
                        "polygon 99 678000 5404000 0 678009 5404000 0 678009 5404009 0\nend\n"));
    assert_int_equal(r.status, NOC_OK);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(f->polygons, 5);
    assert_int_equal(f->polygons_by_class[NOC_CLASS_OTHER], 1);
    assert_true(has_line(f, "ring with too few points", 1));
    assert_true(has_line(f, "coordinates that are not finite", 1));
    assert_int_equal(f->line_count, 3);
    assert_string_equal(f->lines[0].examples, "poly");
    finish(&r);
}

struct watch {
    double last;
    int calls;
    int stop_at;
};

static bool on_progress(void *user, const char *what, double done) {
    struct watch *w = user;
    assert_non_null(what);
    assert_true(done >= w->last && done <= 1);
    w->last = done;
    return ++w->calls != w->stop_at;
}

static void test_progress(void **state) {
    (void)state;
    struct run r;
    struct watch watch = { 0 };
    noc_import_params p = DEFAULTS;
    p.progress = (noc_progress){ on_progress, &watch };
    p.threads = 1; /* several ask as often as they have waited: test_at_once cancels those */
    LOAD(&r, p, file("a", CITY "slow\nslow\n"), file("b", CITY "slow\n"), file("l", NEAR_LAMP "slow\n"));
    assert_int_equal(r.status, NOC_OK);
    int calls = watch.calls;
    assert_true(calls >= 5);
    finish(&r);
    for (int stop = 1; stop <= calls; stop++) { /* wherever it is cancelled, it ends cleanly */
        watch = (struct watch){ .stop_at = stop };
        LOAD(&r, p, file("a", CITY "slow\nslow\n"), file("b", CITY "slow\n"), file("l", NEAR_LAMP "slow\n"));
        assert_int_equal(r.status, NOC_ERR_CANCELLED);
        assert_string_equal(noc_log_last_error(r.scene->log), "import: cancelled");
        assert_int_equal(watch.calls, stop);
        assert_false(r.scene->committed);
        finish(&r);
    }
}

static void test_inspect(void **state) {
    (void)state;
    struct run r;
    start(&r);
    load_with(&r, DEFAULTS, true, PATHS(file("l", "FAKE lamps\ncrs\nlamp 5 6 7\nlamp 8 9\n")));
    assert_int_equal(r.status, NOC_OK);
    const noc_report_file *f = noc_report_get_file(r.report, 0);
    assert_int_equal(f->lamps, 2);
    assert_int_equal(f->lights, 0);
    assert_string_equal(f->crs, "");
    assert_close(f->extent_max[1], 9, 0);
    finish(&r);
    /* a CRS that is not understood is no obstacle to looking */
    start(&r);
    load_with(&r, DEFAULTS, true, PATHS(file("o", "FAKE city\ncrs Local Grid 7\n" HOUSE)));
    assert_int_equal(r.status, NOC_OK);
    assert_string_equal(noc_report_get_file(r.report, 0)->crs_given, "Local Grid 7");
    assert_string_equal(noc_report_get_file(r.report, 0)->crs, "");
    finish(&r);
}

/* Real files through the real table of readers. */
static void test_ingolstadt(void **state) {
    (void)state;
    if (!NOC_HAVE_GDAL) {
        print_message("# skipped: built without GDAL\n");
        skip();
    }
    REQUIRE_SHARED(found, "data/cities/ingolstadt/ingolstadt_lod3_combined.gml.gz");
    char city[4096];
    snprintf(city, sizeof(city), "%s", found);
    REQUIRE_SHARED(lamps, "data/lights/ingolstadt/ingolstadt_street_lamps.geojson");
    noc_scene *scene = noc_scene_create(NULL);
    noc_report *report;
    assert_int_equal(noc_scene_load(scene, (const char *[]){ city, lamps }, 2, NULL, &report), NOC_OK);
    const noc_report_file *f = noc_report_get_file(report, 0), *l = noc_report_get_file(report, 1);
    assert_int_equal(f->buildings, 54);
    assert_int_equal(l->lamps, 40); /* the data's own table says so, and that all lie within 99 m of the model */
    assert_true(l->lights >= 40);
    assert_in_range(f->polygons, 45000, 50696);
    noc_scene_info info;
    noc_scene_get_info(scene, &info);
    assert_int_equal(info.lights_inferred, 0);
    assert_true(info.bounds_max[2] < 440 && info.bounds_min[2] > 350);
    noc_report_destroy(report);
    noc_scene_destroy(scene);
}

static void test_other_cities(void **state) {
    (void)state;
    static const struct {
        const char *path, *crs;
        size_t buildings;
    } cases[] = { { "data/cities/zurich/zurich-lod2-citygml1.gml", "EPSG:21781 (CH1903 / LV03)", 4 },
                  { "data/cities/helsinki/viikintiedepuisto.gml.gz", "EPSG:3879 (ETRS89 / GK25FIN)", 23 },
                  { "data/cities/plateau_osaka/51357309_bldg_6697_op.gml.gz", "EPSG:6668 (JGD2011)", 63 },
                  { "data/cities/nrw/LoD2_32_280_5659_1_NW.gml.gz", "EPSG:25832 (ETRS89 / UTM zone 32N)", 109 } };
    for (size_t i = 0; i < NOC_COUNT(cases); i++) {
        REQUIRE_SHARED(path, cases[i].path);
        noc_report *report;
        assert_int_equal(noc_inspect(NULL, path, NULL, &report), NOC_OK);
        const noc_report_file *f = noc_report_get_file(report, 0);
        assert_string_equal(f->crs, cases[i].crs);
        assert_int_equal(f->buildings, cases[i].buildings);
        noc_report_destroy(report);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_city),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_inferred_lamps),
        cmocka_unit_test(test_useless_lamps),
        cmocka_unit_test(test_strict),
        cmocka_unit_test(test_assumed),
        cmocka_unit_test(test_strict_inferred),
        cmocka_unit_test(test_ground),
        cmocka_unit_test(test_materials_vary),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_bad_features),
        cmocka_unit_test(test_progress),
        cmocka_unit_test(test_inspect),
        cmocka_unit_test(test_ingolstadt),
        cmocka_unit_test(test_other_cities),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
